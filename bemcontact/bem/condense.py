"""A body condensed to its contact points: u_n = Δ1 + M p + R a with ℓᵀp = -load, [SS92] (11)-(15), (35)-(38).

Generalised to bodies that contact alone holds: the singular system is bordered by its free rigid motions, and
equilibrium itself is taken exactly, ℓ = J R, load = work of the applied loads in the free motions.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs
from scipy.optimize import nnls

from bemcontact.bem.boundary_values import BoundaryValues, applied_traction, boundary_values
from bemcontact.bem.contact_points import ContactPoints, contact_points
from bemcontact.bem.influence import Block
from bemcontact.bem.mesh import Mesh, along_curve, build
from bemcontact.bem.rigid_motions import RigidMotions, free_rigid_motions
from bemcontact.bem.system import System
from bemcontact.bem.volume_loads import ParticularSolution, particular_solution, true_resultant
from bemcontact.contact import CondensedContact
from bemcontact.errors import ProblemError, SingularSystemError
from bemcontact.gauge import Gauge, fix_gauge
from bemcontact.problem.problem import Problem

Array = NDArray[np.float64]

UNSEEN = 1e-9
"""Largest normal displacement, relative to the motion's own, of a rigid motion that no contact point sees."""
BALANCED = 1e-9
"""Work of a load in a motion, relative to the sum of the magnitudes of all loads, that counts as none."""
SINGULAR = 1e-15
"""Reciprocal condition number below which the system counts as singular."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """A problem on its mesh, before any integral: what is known, where contact may be, how it may move rigidly.

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
        If the loads pull the body off its support, move it in a way that no contact resists, or do not press it on.
    """
    mesh = build(problem)
    values = boundary_values(problem, mesh)
    points = contact_points(problem, mesh, values)
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


def assemble(system: System) -> tuple[Array, Array]:
    """Set up the bordered matrix (in Fortran order, to be factorised in place) and the right sides.

    Parameters
    ----------
    system : System

    Returns
    -------
    matrix : (size, size)
    right : (size, 1 + n)
    """
    unknowns = system.unknowns.size
    matrix = np.zeros((system.size, system.size), order="F")
    transposed = matrix.T
    right = np.zeros((system.size, 1 + len(system.points)), order="F")

    def place(block: Block) -> None:
        for rows in system.rows(block):
            first = 0
            for part in rows.left:
                transposed[first : first + len(part), rows.at] = part
                first += len(part)
            right[rows.at] = rows.right.T

    system.influence.each_block(system.equations.collocation, place)
    matrix[:unknowns, unknowns:] = system.border
    matrix[unknowns:, :unknowns] = system.null_vectors.T
    return matrix, right


def solve(system: System) -> Array:
    """Solve for the loads and for unit pressures: LU in place, then one step of refinement on rows computed anew.

    Parameters
    ----------
    system : System

    Returns
    -------
    (size, 1 + n)

    Raises
    ------
    SingularSystemError
    """
    lange, getrf, gecon, getrs = get_lapack_funcs(("lange", "getrf", "gecon", "getrs"), dtype=float)
    matrix, right = assemble(system)
    norm = lange("1", matrix)
    factors, pivots, info = getrf(matrix, overwrite_a=True)
    reciprocal = gecon(factors, norm)[0] if info == 0 else 0.0
    if reciprocal < SINGULAR:
        raise SingularSystemError(
            "the equations of the body have no unique solution (reciprocal condition number "
            f"{reciprocal:.1e}); look for coincident edges, or elements of very different length side by side"
        )
    response, _ = getrs(factors, pivots, right)
    correction, _ = getrs(factors, pivots, residual(system, response), overwrite_b=True)
    return response + correction


def residual(system: System, response: Array) -> Array:
    """Right sides less matrix times response, (size, 1 + n), from rows computed anew: no second matrix is kept."""
    unknowns = system.unknowns.size
    z, s = response[:unknowns], response[unknowns:]
    result = np.zeros_like(response, order="F")

    def place(block: Block) -> None:
        for rows in system.rows(block):
            first = 0
            for part in rows.left:
                rows.right[:] -= z[first : first + len(part)].T @ part
                first += len(part)
            result[rows.at] = rows.right.T

    system.influence.each_block(system.equations.collocation, place)
    result[:unknowns] -= system.border @ s
    result[unknowns:] = -system.null_vectors.T @ z
    return result
