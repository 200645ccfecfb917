"""A body condensed to its contact points: u_n = Δ1 + M p + R a with ℓᵀp = -load, [SS92] (11)-(15), (35)-(38).

The method also covers bodies that are held by contact. Their free rigid motions border the singular system, and
equilibrium is exact: ℓ = J R, and the load is the work of the applied loads in the free motions.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import zip_longest

import numpy as np

from bemcontact.arrays import Array, IntArray, indices, magnitudes, scalar_products, successive
from bemcontact.bem.body import Body
from bemcontact.bem.body_motions import known_arms
from bemcontact.bem.bonds import Bond, eliminate
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.congruence import congruent
from bemcontact.bem.discretization import body_of
from bemcontact.bem.loading import Loading, combined
from bemcontact.bem.mesh import MeshPart
from bemcontact.bem.response import Response
from bemcontact.bem.rigid_motions import all_rigid_motions
from bemcontact.bem.solution import solve_system
from bemcontact.bem.support import ensure_held
from bemcontact.bem.system import System
from bemcontact.contact.condensed_contact import CondensedContact, computed_contact
from bemcontact.contact.free_motions import Gauge, fix_gauge
from bemcontact.contact.load_cases import LoadCases, Tools
from bemcontact.frozen import frozen
from bemcontact.problems.curves import cross
from bemcontact.problems.problem import Problem


@frozen
class CondensedPart:
    """One elastic body, condensed by itself, or by the factors of a body that it is congruent to.

    Parameters
    ----------
    mesh : of the body, with its place in the whole mesh
    system : its equations, in the frame of that body
    response : solutions for each loading alone, of which there are 1 + c, and for its unit pressures, dimensionless
    like : number of the body whose factors it has
    turn : (2, 2) rotation x @ turn of vectors into the frame of that body
    """

    mesh: MeshPart
    system: System
    response: Response
    like: int
    turn: Array

    def states(self, pressures: Array, factors: Array) -> Array:
        """Solutions (size, w) of its equations for pressures and bond tractions (w, n + b) [p], and factors (1 + c,).

        The factors are those of loadings, which act beside each of the pressures.
        """
        own = pressures[:, self.system.points.number].T / self.system.stress
        return self.response.combined(np.concatenate([np.tile(factors[:, None], len(pressures)), own]))

    def fields(self, z: Array, loading: Loading | None) -> tuple[Array, Array]:
        """Displacement (N, 2) [L] and traction (m, 3, 2) [p] as of `System.fields`, as the body is turned."""
        displacement, traction = self.system.fields(z, loading)
        return displacement @ self.turn.T, traction @ self.turn.T


@frozen
class Condensation:
    """Condensed bodies, with the responses from which the whole boundary follows for a pressure.

    Parameters
    ----------
    body : Body
    parts : the elastic bodies, each condensed by itself
    contact : CondensedContact
    gauge : Gauge
    bond : what holds bonded bodies together, if there are any
    """

    body: Body
    parts: tuple[CondensedPart, ...]
    contact: CondensedContact
    gauge: Gauge
    bond: Bond | None = None

    def acting(self, case: str | None = None) -> "Condensation":
        """The body under the load case or combination that acts, or another one; `ProblemError` as of `body_of`.

        It is condensed once more if rigid surfaces are elsewhere beside it than here.
        """
        problem = self.body.problem if case is None else self.body.problem.with_case(case)
        if problem.case is None:
            return self
        if problem.zones is not self.body.problem.zones:
            moved = condensed(problem)
            if np.array_equal(moved.contact.points, self.contact.points):  # else they could not be compared
                return moved
        body = self.body.under(problem)
        ensure_held(body)
        contact = self.contact.with_factors(problem.factors())
        named = replace(contact, name=problem.title, notes=_notes(body, self.parts))
        return replace(self, body=body, contact=named)

    @property
    def factors(self) -> Array:
        """Factors of the loadings (1 + c,)."""
        return np.concatenate([[1.0], self.contact.cases.factors])


Condenser = Callable[[Problem], Condensation]
"""Condenses a problem on the mesh that it states."""


def condensed(problem: Problem) -> Condensation:
    """Condense a problem on the mesh that it states; errors as of `body_of` and `condense`."""
    return condense(body_of(problem))


def condense(body: Body) -> Condensation:
    """Eliminate everything but the contact points; `SingularSystemError` if the equations have no unique solution."""
    return condense_together([body])[0]


@frozen
class CondensedTogether:
    """Bodies that differ in gaps, loads and tools only, condensed by one factorization of their common matrix.

    Parameters
    ----------
    bodies : with equal `matrix_of`
    parts : with the loadings of all of them
    """

    bodies: Sequence[Body]
    parts: tuple[CondensedPart, ...]

    def __getitem__(self, number: int) -> Condensation:
        """Return one of the condensed bodies."""
        body = self.bodies[number]
        if len(self.bodies) == 1:
            return _condensation(body, self.parts)
        start, count = sum(len(other.loadings) for other in self.bodies[:number]), len(body.loadings)
        loads = sum(len(other.loadings) for other in self.bodies)
        parts = []
        for part, pressures in zip(self.parts, body.unit_pressures, strict=True):
            own = [*range(start, start + count), *range(loads, part.response.columns)]
            system = replace(
                part.system,
                points=pressures.turned(part.turn),
                loadings=part.system.loadings[start : start + count],
            )
            parts.append(replace(part, system=system, response=part.response.of_columns(own)))
        return _condensation(body, tuple(parts))


def condense_together(bodies: Sequence[Body]) -> CondensedTogether:
    """Condense bodies whose `matrix_of` is equal; `SingularSystemError` if the equations have no unique solution."""
    first = bodies[0]
    loadings = [loading for body in bodies for loading in body.loadings]
    systems = [
        System(
            mesh=on_mesh.mesh, material=stated.material, points=pressures, motions=motions,
            loadings=[loading.of_part(on_mesh) for loading in loadings],
        )
        for stated, on_mesh, motions, pressures in zip(
            first.problem.parts, first.mesh.parts, first.motions, first.unit_pressures, strict=True
        )
    ]  # fmt: skip
    parts: dict[int, CondensedPart] = {}
    for like, turns in congruent(systems).items():
        own, others = systems[like], [(number, turn) for number, turn in turns.items() if number != like]
        members = [own, *(systems[number].turned(turn, own) for number, turn in others)]
        every = [loading for system in members for loading in system.loadings]
        response = solve_system(replace(own, loadings=every), members[1:]) if others else solve_system(own)
        for i, (number, system) in enumerate(zip(turns, members, strict=True)):
            columns = [*range(i * len(loadings), (i + 1) * len(loadings)), *range(len(every), response.columns)]
            parts[number] = CondensedPart(
                mesh=first.mesh.parts[number], system=system, like=like, turn=turns[number],
                response=response.of_columns(columns) if others else response,
            )  # fmt: skip
    return CondensedTogether(bodies=bodies, parts=tuple(parts[number] for number in sorted(parts)))


def matrix_of(body: Body) -> tuple[object, ...]:
    """What the matrix of a body and its unit pressures depend on; equal for bodies that can be condensed together."""
    values, points, bonds = body.loadings[0].values, body.points, body.bonds
    arrays = (
        body.mesh.nodes, body.mesh.elements, body.mesh.edge, body.mesh.part, values.displacement_given,
        values.traction_unknown, values.stiffness, points.node, points.normals, points.element, points.local,
        points.point, points.sense, points.opposite.traction, *points.moved, bonds.component, bonds.tractions,
    )  # fmt: skip
    materials = [part.material.model_dump_json() for part in body.problem.parts]
    return (*materials, *((array.shape, array.tobytes()) for array in arrays))


def _notes(body: Body, parts: Sequence[CondensedPart]) -> tuple[str, ...]:
    """Decisions that a user should know."""
    reused = list[str]()
    if shared := sorted({part.like for number, part in enumerate(parts) if part.like != number}):
        names = [part.name for part in body.problem.parts]
        for number in shared:
            others = [name for name, part in zip(names, parts, strict=True) if part.like == number][1:]
            listed = ", ".join(f"'{name}'" for name in others)
            reused.append(f"the condensation of the body '{names[number]}' is reused for {listed}, of equal mesh")
    return (*body.notes, *reused, *dict.fromkeys(note for part in parts for note in part.system.notes))


def _condensation(body: Body, parts: tuple[CondensedPart, ...]) -> Condensation:
    """The condensed bodies, from the responses to their loadings and unit pressures."""
    points, tools, bond = body.points, body.tools, None
    zones, cases = tuple(body.problem.zones), tuple(body.problem.load_cases)
    compliance, free_displacement = observed(body, parts)
    if len(body.bonds):
        compliance, free_displacement, bond = eliminate(
            compliance,
            free_displacement,
            body.all_changes(body.apart),
            body.all_work(body.apart),
            body.motion_load(body.apart),
            body.apart.of_bodies.T,
            len(points),
        )
    R, load = body.seen_motion, body.seen_load
    (n, k), t = R.shape, len(tools.names)
    gauge = fix_gauge(body.algebra, compliance=compliance, free_displacement=free_displacement)
    contact = computed_contact(
        name=body.problem.name,
        zone_names=zones,
        units={"length": body.problem.units.length, "force": body.problem.units.force},
        notes=_notes(body, parts),
        motion_names=body.seen.describe(),
        motion_arms=known_arms(body),
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
        initial_gap=points.gap + tools.motions @ tools.position[:, 0] if t else points.gap,
        weights=points.tributary,
        zone_weights=points.tributary_by_zone(len(zones)),
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
        )
        if t
        else Tools.none(n, k),
        pinned=body.pinned,
        cases=LoadCases(
            names=cases,
            displacement=gauge.free_displacement[:, 1:],
            motion_load=np.where(body.with_bodies[:, None], load, 0.0)[:, 1:],
            position=tools.position[:, 1:],
            force=tools.force[:, 1:],
            factors=np.zeros(len(cases)),
        )
        if cases
        else LoadCases.none(n, k, t),
    )
    return Condensation(body=body, parts=parts, contact=contact, gauge=gauge, bond=bond).acting()


def observed(body: Body, parts: Sequence[CondensedPart], loadings: int | None = None) -> tuple[Array, Array]:
    """What bodies do to all gaps and bonds: by unit pressures (n + b, n + b) [L/p], by each loading (n + b, s) [L].

    The number s of their `loadings` is that of the body unless it is given.
    """
    count = len(body.points) + len(body.bonds)
    compliance = np.zeros((count, count))
    free_displacement = np.zeros((count, len(body.loadings) if loadings is None else loadings))
    for part in parts:
        _observe(part, compliance, free_displacement)
    return compliance, free_displacement


def _observe(part: CondensedPart, compliance: Array, free_displacement: Array) -> None:
    """Add what a body does to all gaps: by unit pressures (n, n) [L/p], and by each loading (n, s) [L]."""
    system, response = part.system, part.response
    points, s = system.points, len(system.loadings)
    result = np.zeros((response.columns, len(points.gap)))
    for change, column in zip(points.change.T, system.unknowns.displacement[points.node].T, strict=True):
        seen = (column >= 0) & (change != 0)
        if seen.any():
            free = slice(None) if seen.all() else indices(seen)
            result[:, free] += change[free] * response.rows(column[free]).T
    moved, added = result[:s].T * system.length, result[s:].T * (system.length / system.stress)
    for own, item in zip(moved.T, system.loadings, strict=True):
        if item.values.displacement.any():
            own += scalar_products(points.change, item.values.displacement[points.node])
    gaps, numbers = successive(points.gap), successive(points.number)
    if isinstance(gaps, slice) and isinstance(numbers, slice):
        free_displacement[gaps] += moved
        compliance[gaps, numbers] += added
    else:
        np.add.at(free_displacement, points.gap, moved)
        np.add.at(compliance, (points.gap[:, None], points.number), added)


def boundary_state(condensation: Condensation, pressure: Array, rigid_amplitudes: Array) -> BoundaryState:
    """Recover the boundary from pressure (n,) [p] and rigid amplitudes (k,) [L] of a contact solution."""
    mesh = condensation.body.mesh
    ((displacement, traction),) = _boundaries(
        condensation, pressure[None], rigid_amplitudes[None], condensation.factors
    )
    return BoundaryState(
        points=mesh.nodes[mesh.elements],
        displacement=displacement,
        traction=traction,
        edge=mesh.edge,
        edge_names=mesh.edge_names,
        force_balance=_force_balance(condensation, traction),
        equilibrium_slack=_slack(condensation, pressure),
    )


def boundary_changes(
    condensation: Condensation, pressures: Array, rigid_amplitudes: Array
) -> Iterator[tuple[Array, Array]]:
    """Displacement (m, 3, 2) [L] and traction (m, 3, 2) [p] of each of pressures (w, n) and amplitudes (w, k) alone."""
    yield from _boundaries(condensation, pressures, rigid_amplitudes, np.zeros_like(condensation.factors))


def boundary_columns(condensation: Condensation) -> tuple[Array, Array]:
    """Displacement (N, 2, 1 + c + n) [L] and traction (m, 3, 2, …) [p] of each loading and each unit pressure alone.

    Their sum with factors and pressures is the state of the boundary but for rigid motions of the bodies.
    """
    body, loads = condensation.body, len(condensation.body.loadings)
    columns, mesh = loads + len(body.points) + len(body.bonds), body.mesh
    displacement, traction = np.zeros((*mesh.nodes.shape, columns)), np.zeros((*mesh.elements.shape, 2, columns))
    for part in condensation.parts:
        system, number = part.system, np.append(np.arange(loads), loads + part.system.points.number)
        scale = np.append(np.ones(loads), np.full(len(system.points), 1 / system.stress))
        z = part.response.combined(np.diag(scale)).T
        for own, loading, column in zip_longest(z, system.loadings, number.tolist()):
            u, t = part.fields(own, loading)
            displacement[part.mesh.nodes, :, column], traction[part.mesh.elements, :, :, column] = u, t
    for element, local, point, vectors in _pressed(body):
        for axis in (0, 1):
            np.add.at(traction[:, :, axis], (element, local, loads + point), vectors[:, axis])
    if condensation.bond is None:
        return displacement, traction
    by_pressure, by_loading = condensation.bond.traction
    held, count = np.hstack([by_loading, by_pressure]), loads + len(body.points)
    u, t = (values[..., :count] + values[..., count:] @ held for values in (displacement, traction))
    return u, t


def _pressed(body: Body) -> Iterator[tuple[IntArray, IntArray, IntArray, Array]]:
    """(Element, local node) pairs (q,), points (q,) whose pressure they carry, and traction (q, 2) by a unit of it.

    First those of the bodies that touch, then those of the other elastic bodies, then those of bonds, if any.
    """
    points, bonds = body.points, body.bonds
    other = points.opposite
    yield points.element, points.local, points.point, points.tractions
    if len(other.share):
        yield other.element, other.local, points.point[other.share], other.traction
    if len(bonds):
        yield bonds.element, bonds.local, len(points) + bonds.component, bonds.tractions


def _boundaries(
    condensation: Condensation, pressures: Array, rigid_amplitudes: Array, factors: Array
) -> Iterator[tuple[Array, Array]]:
    """Displacement and traction of each of pressures (w, n) and amplitudes (w, k), with loadings by these factors."""
    body, gauge = condensation.body, condensation.gauge
    amplitudes = rigid_amplitudes.copy()
    amplitudes[:, : len(gauge.shift_load)] -= gauge.shift_load @ factors + pressures @ gauge.shift_pressure.T
    moved = np.zeros((len(pressures), 0))
    if condensation.bond is not None:
        held, moved = (pressures @ part[0].T + part[1] @ factors for part in condensation.bond)
        pressures = np.hstack([pressures, held])
    states = [part.states(pressures, factors).T for part in condensation.parts]
    for pressure, amplitude, step, *own in zip(pressures, amplitudes, moved, *states, strict=True):
        displacement, traction = np.zeros_like(body.mesh.nodes), np.zeros((*body.mesh.elements.shape, 2))
        if condensation.bond is not None:
            displacement += replace(
                body.seen, coefficients=np.append(step, np.zeros(3 * len(body.tools.names)))[None]
            ).displacement(body.mesh)[..., 0]
        for part, z in zip(condensation.parts, own, strict=True):
            acting = combined(part.system.loadings, factors.tolist()) if factors.any() else None
            u, t = part.fields(z, acting)
            displacement[part.mesh.nodes] += u
            traction[part.mesh.elements] = t
        displacement += body.seen_ways @ amplitude
        for element, local, point, vectors in _pressed(body):
            at, by_point = 3 * element + local, pressure[point]
            for axis in (0, 1):
                traction[..., axis] += np.bincount(at, by_point * vectors[:, axis], 3 * len(traction)).reshape(-1, 3)
        yield displacement[body.mesh.elements], traction


def _force_balance(condensation: Condensation, traction: Array) -> float:
    """Resultant force and moment of loads, on the exact curves, and reactions, over the sum of the magnitudes.

    Of several bodies it is the largest.
    """
    body, largest = condensation.body, 0.0
    mesh, acting = body.mesh, body.acting
    for number, part in enumerate(mesh.parts):
        own, length = part.mesh, part.mesh.tributary[..., None]
        forces, loads = length * traction[part.elements], length * acting.values.traction[part.elements]
        reactions = forces - loads
        force = reactions.sum(axis=(0, 1)) + acting.true_forces[number]
        moment = float(cross(own.nodes[own.elements] - mesh.center, reactions).sum() + acting.true_moments[number])
        resultant = all_rigid_motions(own).work_of(force, moment, about=mesh.center)
        magnitude = magnitudes(forces).sum() + acting.particular.magnitude
        largest = max(largest, float(abs(resultant).max() / magnitude) if magnitude > 0 else 0.0)
    return largest


def _slack(condensation: Condensation, pressure: Array) -> float:
    """Border unknowns of the solution, over the sum of the magnitudes that each load and pressure contributes."""
    if condensation.bond is not None:
        pressure = np.append(
            pressure, condensation.bond.traction[0] @ pressure + condensation.bond.traction[1] @ condensation.factors
        )
    return max(_slack_of(part, pressure, condensation.factors) for part in condensation.parts)


def _slack_of(part: CondensedPart, pressure: Array, factors: Array) -> float:
    """The same of one body."""
    system = part.system
    scaled = np.concatenate([factors, pressure[system.points.number] / system.stress])
    slack = part.response.rows(np.arange(system.unknowns.size, system.size))
    if len(slack) == 0:
        return 0.0
    total = abs(slack) @ abs(scaled)
    return float(abs(slack @ scaled).max() / total.max()) if total.max() > 0 else 0.0
