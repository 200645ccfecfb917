"""A body condensed to its contact points: u_n = Δ1 + M p + R a with ℓᵀp = -load, [SS92] (11)-(15), (35)-(38).

Generalised to bodies that contact alone holds: the singular system is bordered by its free rigid motions, and
equilibrium itself is taken exactly, ℓ = J R, load = work of the applied loads in the free motions.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from bemcontact.bem.boundary_values import BoundaryValues, applied_traction, boundary_values
from bemcontact.bem.contact_points import ContactPoints, contact_points
from bemcontact.bem.deflection import deflections
from bemcontact.bem.factorisation import solve
from bemcontact.bem.mesh import Mesh, along_curve, build
from bemcontact.bem.rigid_motions import RigidMotions, free_rigid_motions
from bemcontact.bem.system import System
from bemcontact.bem.volume_loads import ParticularSolution, particular_solution, true_resultant
from bemcontact.contact import CondensedContact
from bemcontact.errors import ProblemError
from bemcontact.gauge import Gauge, fix_gauge
from bemcontact.problem.problem import Problem

Array = NDArray[np.float64]

UNSEEN = 1e-9
"""Largest normal displacement, relative to the motion's own, of a rigid motion that no contact point sees."""
BALANCED = 1e-9
"""Work of a load in a motion, relative to the sum of the magnitudes of all loads, that counts as none."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """A problem on its mesh, before it is condensed: what is known, where contact may be, how it may move rigidly.

    Parameters
    ----------
    problem, mesh, values, points, particular : the stages up to here
    motions : all rigid motions that the conditions leave free
    seen : those of them, or combinations, that move contact points along the rigid normals
    unseen : the others, that no contact point sees
    """

    problem: Problem
    mesh: Mesh
    values: BoundaryValues
    points: ContactPoints
    particular: ParticularSolution
    motions: RigidMotions
    seen: RigidMotions
    unseen: RigidMotions

    @cached_property
    def forces(self) -> Array:
        """What the prescribed tractions do at each (element, local node), (m, 3, 2) [p L]."""
        return self.mesh.tributary[..., None] * self.values.traction

    def motion_load(self, motions: RigidMotions) -> Array:
        """Work (k,) of the applied loads in rigid motions [p L], with tributary weights as in all of equilibrium."""
        work = motions.work(self.mesh.nodes[self.mesh.elements], self.forces)
        return work + motions.work_of(self.particular.force, self.particular.moment)

    def true_motion_load(self, motions: RigidMotions) -> Array:
        """The same (k,) on the curves themselves, to round-off: whether loads balance is no matter of the mesh."""
        work = motions.work_of(*true_resultant(self.problem))
        for edge in self.problem.boundary.edges:
            if edge.name in self.problem.conditions:
                points, normals, lengths = along_curve(edge)
                tractions = applied_traction(self.problem.conditions[edge.name], points, normals)
                work = work + motions.work(points, lengths[:, None] * tractions)
        return work

    @cached_property
    def load_magnitude(self) -> float:
        """Sum of the magnitudes of all loads [p L]."""
        return float(np.hypot(self.forces[..., 0], self.forces[..., 1]).sum() + self.particular.magnitude)

    def normal_motion(self, motions: RigidMotions) -> Array:
        """R (n, k): rigid motions seen along the rigid normals at the contact points."""
        return _along_normals(self.points, motions)

    @property
    def notes(self) -> tuple[str, ...]:
        """What was decided and should be known."""
        return tuple(
            f"the {motion} is seen by no contact point and loaded by nothing: the body is pinned against it"
            for motion in self.unseen.describe()
        )


def body_of(problem: Problem) -> Body:
    """Mesh a problem, spread its conditions, and find out whether contact can hold it.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    Body

    Raises
    ------
    ProblemError
        If the loads pull the body off its support, move it in a way that no contact resists, or do not press it on;
        or if the conditions of a deflected contour do not hold the body.
    """
    mesh = build(problem)
    values = boundary_values(problem, mesh)
    points = contact_points(problem, mesh, values, deflections(problem, mesh))
    motions = free_rigid_motions(mesh, values.displacement_given)
    seen, unseen = _split_by_contact(points, motions)
    body = Body(
        problem=problem, mesh=mesh, values=values, points=points, motions=motions, seen=seen, unseen=unseen,
        particular=particular_solution(problem.loads, problem.material, mesh),
    )  # fmt: skip
    _check_unseen(body)
    _check_support(body)
    return body


def _along_normals(points: ContactPoints, motions: RigidMotions) -> Array:
    return np.einsum("nx,nxk->nk", points.normals, motions.displacement(points.mesh.nodes[points.node]))


def _split_by_contact(points: ContactPoints, motions: RigidMotions) -> tuple[RigidMotions, RigidMotions]:
    """Separate motions that contact points see from those that none sees."""
    R = _along_normals(points, motions)
    _, values, vectors = np.linalg.svd(np.vstack([R, np.zeros((len(motions), len(motions)))]))
    unseen = values <= UNSEEN * np.sqrt(len(points))
    return motions.combined(vectors[~unseen].T).reduced(), motions.combined(vectors[unseen].T).reduced()


def _check_unseen(body: Body) -> None:
    """Refuse a load that works on a motion which no contact sees."""
    work = body.true_motion_load(body.unseen)
    for motion, done in zip(body.unseen.describe(), work, strict=True):
        if abs(done) > BALANCED * body.load_magnitude:
            raise ProblemError(
                f"nothing holds the body against the {motion}, and the loads act along it (resultant {done:.6g}); "
                "prescribe a displacement that holds it, or balance the loads"
            )


def _check_support(body: Body) -> None:
    """Refuse loads that no pressure p >= 0 can balance, and bodies that nothing presses on."""
    if len(body.seen) == 0:
        return
    R, load = body.normal_motion(body.seen), body.motion_load(body.seen)
    R = np.where(abs(R) > UNSEEN, R, 0.0)
    if abs(load).max() <= BALANCED * body.load_magnitude:
        if not _can_clamp(R):
            words = " and the ".join(body.seen.describe())
            raise ProblemError(
                f"only contact holds the body against the {words}, but no load presses it onto its support, "
                "so that its position is not determined; apply a load, or prescribe a displacement"
            )
        return
    forces, residual = nnls(R.T, -load / abs(load).max())
    if residual > BALANCED:
        pull = body.seen.combined((R.T @ forces + load / abs(load).max())[:, None])
        raise ProblemError(
            f"the load pulls the body off its support: it drives the {pull.describe()[0]}, which no contact resists; "
            "turn the load around, or prescribe a displacement that holds the body"
        )


def _can_clamp(R: Array) -> bool:
    """Whether some forces f >= 0 at points that see a motion balance each other, as in a body between two walls."""
    sees = R.any(axis=1)
    columns = np.vstack([R[sees].T, np.ones(np.count_nonzero(sees))])
    _, residual = nnls(columns, np.append(np.zeros(R.shape[1]), 1.0))
    return residual <= BALANCED


@dataclass(frozen=True, kw_only=True, eq=False)
class Condensation:
    """A condensed body, and what it takes to find the whole boundary again from a pressure.

    Parameters
    ----------
    body : Body
    system : System
    response : (unknowns + border, 1 + n) solution for the loads alone and for unit pressures, dimensionless
    contact : CondensedContact
    gauge : Gauge
    """

    body: Body
    system: System
    response: Array
    contact: CondensedContact
    gauge: Gauge


def condense(body: Body) -> Condensation:
    """Eliminate everything but the contact points.

    Parameters
    ----------
    body : Body

    Returns
    -------
    Condensation

    Raises
    ------
    SingularSystemError
        If the equations of the body have no unique solution in floating-point arithmetic.
    """
    system = System(
        mesh=body.mesh, material=body.problem.material, values=body.values, points=body.points,
        particular=body.particular, motions=body.motions,
    )  # fmt: skip
    response = solve(system)
    points = body.points
    observed = _observe(system, response)
    prescribed = np.sum(points.normals * body.values.displacement[points.node], axis=1)
    gauge = fix_gauge(
        compliance=observed[:, 1:] * (system.length / system.stress),
        free_displacement=observed[:, 0] * system.length + prescribed,
        rigid_motions=body.normal_motion(body.seen),
        weights=points.tributary,
        motion_load=body.motion_load(body.seen),
    )
    contact = CondensedContact(
        name=body.problem.name,
        zone_names=tuple(body.problem.contact_zones),
        units={"length": body.problem.units.length, "force": body.problem.units.force},
        notes=body.notes,
        motion_names=body.seen.describe(),
        points=body.mesh.nodes[points.node],
        normals=points.normals,
        zone=points.zone,
        run=points.run,
        arc_position=points.arc_position,
        run_length=points.run_length,
        compliance=gauge.compliance,
        free_displacement=gauge.free_displacement,
        rigid_motions=body.normal_motion(body.seen),
        motion_load=body.motion_load(body.seen),
        initial_gap=points.gap,
        weights=points.tributary,
        consistent_weights=points.consistent,
        element_length_weights=points.element_length,
        held_arc=points.held_arc,
        held_points=points.held_points,
    )
    return Condensation(body=body, system=system, response=response, contact=contact, gauge=gauge)


def _observe(system: System, response: Array) -> Array:
    """Normal displacement (n, 1 + n) at the contact points due to the unknowns, over L0."""
    points = system.points
    result = np.zeros((len(points), response.shape[1]))
    for normal, column in zip(points.normals.T, system.unknowns.displacement[points.node].T, strict=True):
        free = column >= 0
        result[free] += normal[free, None] * response[column[free]]
    return result
