"""A body condensed to its contact points: u_n = Δ1 + M p + R a with ℓᵀp = -load, [SS92] (11)-(15), (35)-(38).

The method also covers bodies that are held by contact. Their free rigid motions border the singular system, and
equilibrium is exact: ℓ = J R, and the load is the work of the applied loads in the free motions.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest

import numpy as np

from bemcontact.arrays import Array
from bemcontact.bem.body import Body, body_of, ensure_held
from bemcontact.bem.mesh import BoundaryState
from bemcontact.bem.response import Response
from bemcontact.bem.rigid_motions import all_rigid_motions
from bemcontact.bem.solution import solve_system
from bemcontact.bem.system import System
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import Gauge, MotionAlgebra, fix_gauge
from bemcontact.contact.load_cases import LoadCases, Tools
from bemcontact.problem.problem import Problem


@dataclass(frozen=True, kw_only=True, eq=False)
class Condensation:
    """A condensed body, with the response from which the whole boundary follows for a pressure.

    Parameters
    ----------
    body : Body
    system : System
    response : solutions for each loading alone, of which there are 1 + c, and for unit pressures, dimensionless
    contact : CondensedContact
    gauge : Gauge
    """

    body: Body
    system: System
    response: Response
    contact: CondensedContact
    gauge: Gauge

    def acting(self, case: str | None = None) -> "Condensation":
        """The body under the load case or combination that acts, or another one; `ProblemError` as of `body_of`."""
        problem = self.body.problem if case is None else self.body.problem.with_case(case)
        if problem.case is None:
            return self
        body = replace(self.body, problem=problem)
        ensure_held(body)
        contact = self.contact.with_factors(problem.factors())
        named = replace(contact, name=problem.title, notes=(*body.notes, *self.system.notes))
        return replace(self, body=body, contact=named)

    @property
    def factors(self) -> Array:
        """Factors of the loadings (1 + c,)."""
        return np.append(1.0, self.contact.cases.factors)


Condenser = Callable[[Problem], Condensation]
"""Condenses a problem on the mesh that it states."""


def condensed(problem: Problem) -> Condensation:
    """Condense a problem on the mesh that it states; errors as of `body_of` and `condense`."""
    return condense(body_of(problem))


def condense(body: Body) -> Condensation:
    """Eliminate everything but the contact points; `SingularSystemError` if the equations have no unique solution."""
    return condense_together([body])[0]


@dataclass(frozen=True, kw_only=True, eq=False)
class CondensedTogether:
    """Bodies that differ in gaps, loads and tools only, condensed by one factorization of their common matrix.

    Parameters
    ----------
    bodies : with equal `matrix_of`
    system : with the loadings of all of them
    response : solutions for each of these loadings and for unit pressures, dimensionless
    """

    bodies: Sequence[Body]
    system: System
    response: Response

    def __getitem__(self, number: int) -> Condensation:
        """Return one of the condensed bodies."""
        body = self.bodies[number]
        if len(self.bodies) == 1:
            return _condensation(body, self.system, self.response)
        start, loads = sum(len(other.loadings) for other in self.bodies[:number]), len(self.system.loadings)
        own = [*range(start, start + len(body.loadings)), *range(loads, self.response.columns)]
        system = replace(self.system, mesh=body.mesh, points=body.points, motions=body.motions, loadings=body.loadings)
        return _condensation(body, system, self.response.of_columns(own))


def condense_together(bodies: Sequence[Body]) -> CondensedTogether:
    """Condense bodies whose `matrix_of` is equal; `SingularSystemError` if the equations have no unique solution."""
    first = bodies[0]
    system = System(
        mesh=first.mesh, material=first.problem.material, points=first.points, motions=first.motions,
        loadings=[loading for body in bodies for loading in body.loadings],
    )  # fmt: skip
    return CondensedTogether(bodies=bodies, system=system, response=solve_system(system))


def matrix_of(body: Body) -> tuple[object, ...]:
    """What the matrix of a body and its unit pressures depend on; equal for bodies that can be condensed together."""
    values, points = body.loadings[0].values, body.points
    arrays = (
        body.mesh.nodes, body.mesh.elements, body.mesh.edge, values.displacement_given, values.traction_unknown,
        points.node, points.normals, points.element, points.local, points.point,
    )  # fmt: skip
    return (body.problem.material.model_dump_json(), *((array.shape, array.tobytes()) for array in arrays))


def _condensation(body: Body, system: System, response: Response) -> Condensation:
    """The condensed body, from the response to its loadings and unit pressures."""
    points, tools, s = body.points, body.tools, len(body.loadings)
    observed = _observe(system, response)
    prescribed = [np.sum(points.normals * item.values.displacement[points.node], axis=1) for item in body.loadings]
    R, load = body.seen_motion, body.seen_load
    own = np.any(body.seen.body.coefficients, axis=1)
    gauge = fix_gauge(
        MotionAlgebra(rigid_motions=R[:, own], weights=points.tributary, motion_load=load[own]),
        compliance=observed[:, s:] * (system.length / system.stress),
        free_displacement=observed[:, :s] * system.length + np.column_stack(prescribed),
    )
    on_body = np.where(own[:, None], load, 0.0)
    contact = CondensedContact(
        name=body.problem.name,
        zone_names=tuple(body.problem.contact_zones),
        units={"length": body.problem.units.length, "force": body.problem.units.force},
        notes=(*body.notes, *system.notes),
        motion_names=body.seen.describe(),
        motion_arms=body.seen.arms,
        points=body.mesh.nodes[points.node],
        normals=points.normals,
        zone=points.zone,
        run=points.run,
        arc_position=points.arc_position,
        run_length=points.run_length,
        compliance=gauge.compliance,
        free_displacement=gauge.free_displacement[:, 0],
        rigid_motions=R,
        motion_load=load[:, 0],
        initial_gap=points.gap + tools.motions @ tools.position[:, 0],
        weights=points.tributary,
        zone_weights=points.tributary_by_zone(len(body.problem.contact_zones)),
        consistent_weights=points.consistent,
        element_length_weights=points.element_length,
        held_arc=points.held_arc,
        held_points=points.held_points,
        tools=Tools(
            names=tools.names,
            point=tools.point,
            motions=tools.motions,
            amplitudes=body.seen.tools,
            free=tools.free,
            position=tools.position[:, 0],
            force=tools.force[:, 0],
        ),
        pinned=body.pinned,
        cases=LoadCases(
            names=tuple(body.problem.load_cases),
            displacement=gauge.free_displacement[:, 1:],
            motion_load=on_body[:, 1:],
            position=tools.position[:, 1:],
            force=tools.force[:, 1:],
            factors=np.zeros(s - 1),
        ),
    )
    return Condensation(body=body, system=system, response=response, contact=contact, gauge=gauge).acting()


def _observe(system: System, response: Response) -> Array:
    """Normal displacement (n, s + n) over L0 at the contact points due to the unknowns."""
    points = system.points
    result = np.zeros((response.columns, len(points)))
    for normal, column in zip(points.normals.T, system.unknowns.displacement[points.node].T, strict=True):
        free = np.flatnonzero(column >= 0) if column.min() < 0 else slice(None)
        result[:, free] += normal[free] * response.rows(column[free]).T
    return result.T


def boundary_state(condensation: Condensation, pressure: Array, rigid_amplitudes: Array) -> BoundaryState:
    """Recover the boundary from pressure (n,) [p] and rigid amplitudes (k,) [L] of a contact solution."""
    mesh = condensation.body.mesh
    displacement, traction = _boundary(condensation, pressure, rigid_amplitudes, condensation.factors)
    return BoundaryState(
        points=mesh.nodes[mesh.elements],
        displacement=displacement,
        traction=traction,
        edge=mesh.edge,
        edge_names=mesh.edge_names,
        force_balance=_force_balance(condensation, traction),
        equilibrium_slack=_slack(condensation, pressure),
    )


def boundary_change(condensation: Condensation, pressure: Array, rigid_amplitudes: Array) -> tuple[Array, Array]:
    """Displacement (m, 3, 2) [L] and traction (m, 3, 2) [p] of a pressure (n,) and amplitudes (k,) without loads."""
    return _boundary(condensation, pressure, rigid_amplitudes, np.zeros_like(condensation.factors))


def boundary_columns(condensation: Condensation) -> tuple[Array, Array]:
    """Displacement (N, 2, 1 + c + n) [L] and traction (m, 3, 2, …) [p] of each loading and each unit pressure alone.

    Their sum with factors and pressures is the state of the boundary but for a rigid motion of the body.
    """
    system, loadings, points = condensation.system, condensation.body.loadings, condensation.body.points
    scale = np.append(np.ones(len(loadings)), np.full(len(points), 1 / system.stress))
    z = condensation.response.combined(np.diag(scale)).T
    states = [system.fields(own, loading) for own, loading in zip_longest(z, loadings)]
    displacement, traction = (np.stack(parts, axis=-1) for parts in zip(*states, strict=True))
    for axis, normal in enumerate(points.normals.T):
        column = len(loadings) + points.point
        np.add.at(traction[:, :, axis], (points.element, points.local, column), normal[points.point])
    return displacement, traction


def _boundary(
    condensation: Condensation, pressure: Array, rigid_amplitudes: Array, factors: Array
) -> tuple[Array, Array]:
    """Displacement and traction of a pressure, of amplitudes, and of the loadings by these factors, if any."""
    body, system, gauge = condensation.body, condensation.system, condensation.gauge
    z = condensation.response.combined(np.append(factors, pressure / system.stress))
    amplitudes = rigid_amplitudes.copy()
    amplitudes[: len(gauge.shift_load)] -= gauge.shift_load @ factors + gauge.shift_pressure @ pressure
    displacement, traction = system.fields(z, body.acting if factors.any() else None)
    displacement += body.seen.body.displacement(body.mesh.nodes) @ amplitudes
    points = body.points
    np.add.at(traction, (points.element, points.local), pressure[points.point, None] * points.normals[points.point])
    return displacement[body.mesh.elements], traction


def _force_balance(condensation: Condensation, traction: Array) -> float:
    """Resultant force and moment of loads, on the exact curves, and reactions, over the sum of the magnitudes."""
    body = condensation.body
    mesh, acting, every = body.mesh, body.acting, all_rigid_motions(body.mesh)
    forces = mesh.tributary[..., None] * traction
    resultant = every.work(mesh.nodes[mesh.elements], forces - acting.forces(mesh)) + acting.true_work(mesh, every)
    magnitude = np.hypot(forces[..., 0], forces[..., 1]).sum() + acting.particular.magnitude
    return float(abs(resultant).max() / magnitude) if magnitude > 0 else 0.0


def _slack(condensation: Condensation, pressure: Array) -> float:
    """Border unknowns of the solution, over the sum of the magnitudes that each load and pressure contributes."""
    scaled = np.append(condensation.factors, pressure / condensation.system.stress)
    system = condensation.system
    slack = condensation.response.rows(np.arange(system.unknowns.size, system.size))
    if len(slack) == 0:
        return 0.0
    total = abs(slack) @ abs(scaled)
    return float(abs(slack @ scaled).max() / total.max()) if total.max() > 0 else 0.0
