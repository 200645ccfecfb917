"""The answer on one mesh: pressure, traction and displacement by element, and the stretches of contact."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bemcontact.adaptivity.mesh_sizes import as_of_one
from bemcontact.adaptivity.zone_runs import SAME, Stretch, ZoneRun, contact_stretches, zone_runs
from bemcontact.arrays import Array, BoolArray, magnitudes
from bemcontact.assessment.footprint import footprint
from bemcontact.bem import reference_element
from bemcontact.bem.body import Body
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.condense import Condensation, boundary_changes, boundary_state, condensed
from bemcontact.bem.contact_points import ContactPoints
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.surface_gaps import surface_gaps
from bemcontact.cached import cached_property
from bemcontact.contact.load_cases import Change
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.errors import SingularSystemError, SolverError
from bemcontact.formulations import complementarity
from bemcontact.formulations.active_set import ContactBlock
from bemcontact.formulations.scaling import scale, scaled_change, unscaled_point
from bemcontact.frozen import frozen
from bemcontact.problems.problem import Problem

SLIT = 1e-3
"""Open length between two stretches of contact, over the shorter of these, that is not taken for an opening."""
ALIKE = 1e-6
"""Relative difference below which two elements change alike: both are bisected, or none."""
PENETRATION = 1e-3
"""Penetration between nodes, over the largest displacement, that a mesh must resolve."""
ROUNDED = 1e-13
"""Penetration over the size of the mesh that is round-off of coordinates, whatever the displacement is."""


@frozen
class CaseAnswer:
    """The contact state under one load case on one mesh.

    Parameters
    ----------
    condensation : with the load case that acts
    solution : of its contact problem
    stretches : stretches of contact by run; two with a slit between them are one
    around : closed runs in contact all around, which have no stretches, for contact has no ends there
    pressure : (zones, m, 3) [p] by zone, element and local node, zero outside the zone
    state : traction and displacement of the boundary
    """

    condensation: Condensation
    solution: ContactSolution
    stretches: Mapping[int, tuple[Stretch, ...]]
    around: frozenset[int]
    pressure: Array
    state: BoundaryState

    @property
    def traction(self) -> Array:
        """Traction (m, 3, 2) [p]."""
        return self.state.traction

    def touching(self, points: ContactPoints) -> BoolArray:
        """Whether points (n,) of another mesh of the problem are where there is contact on this one."""
        inside = np.isin(points.run, [*self.around])
        for run, stretches in self.stretches.items():
            for item in stretches:
                along = (points.arc_position - item.start) % points.run_length[run]  # infinite before an open stretch
                inside |= (points.run == run) & (along <= item.end - item.start)
        return inside

    def presses(self, element: int) -> bool:
        """Whether there is pressure on an element, or on the one of the other body that it faces."""
        if self.pressure[:, element, 1].any():
            return True
        facing = self.condensation.body.points.facing.items()
        return any((self.pressure[zone, of == element, 1] > 0).any() for zone, of in facing)

    @cached_property
    def displacement(self) -> Array:
        """Displacement (m, 3, 2) [L], less its part in the free motions that nothing determines.

        Nothing determines motions that no contact point sees, and none at all where nothing touches.
        """
        body = self.condensation.body
        free = (body.pinned_motions,) if self.pressure.any() else (body.pinned_motions, body.seen)
        return body.without_motions(self.state.displacement, *free)

    @cached_property
    def largest_displacement(self) -> float:
        """Largest magnitude of `displacement` [L]."""
        return float(magnitudes(self.displacement).max())

    def force_vector(self, zone: int) -> Array:
        """Force (2,) of the surface of a zone on the body [p L]."""
        contact = self.condensation.contact
        return (contact.weights_by_zone[zone] * self.solution.pressure) @ contact.normals

    def force_influence(self) -> Iterator[tuple[Array, Array]]:
        """Per zone, the boundary's change (displacement, traction) if the points in contact move out by 1 [L].

        By reciprocity an error on the boundary enters the force of the zone by its work in this change, with the points
        in contact that the answer has: as many as these determine. Rigid motions make the change zero.
        """
        contact, pressure = self.condensation.contact, self.solution.pressure
        block = ContactBlock(scaled=scale(contact), points=np.flatnonzero(pressure > 0))
        still = np.zeros(contact.free_motions)
        moved = [scaled_change(contact, Change(-1.0 * (own > 0), still)) for own in contact.lengths_by_zone]
        try:
            pressures, _, amplitudes = block.solve(*moved)
        except SingularSystemError:
            return
        changes = [unscaled_point(contact, p, a) for p, a in zip(pressures, amplitudes, strict=True)]
        yield from boundary_changes(self.condensation, *map(np.array, zip(*changes, strict=True)))


@frozen
class Solved:
    """One mesh: the contact state under each load case, and the runs of the zones."""

    condensation: Condensation
    runs: tuple[ZoneRun, ...]
    answers: tuple[CaseAnswer, ...]

    @property
    def body(self) -> Body:
        """The body on the mesh."""
        return self.condensation.body

    @property
    def mesh(self) -> Mesh:
        """The mesh."""
        return self.body.mesh

    def run(self, number: int) -> ZoneRun:
        """The run of a number; one without elements is not among `runs`."""
        return next(run for run in self.runs if run.number == number)

    @property
    def degrees_of_freedom(self) -> int:
        """Number of unknowns, two for each node."""
        return self.mesh.degrees_of_freedom

    @property
    def counted_unknowns(self) -> int:
        """Number of unknowns, of several bodies as `as_of_one` counts them."""
        return as_of_one(part.mesh.degrees_of_freedom for part in self.mesh.parts)

    def force(self, answer: CaseAnswer, zone: int) -> float:
        """Force of a zone, the pressure summed up along it [p L]."""
        return float((self.mesh.tributary * answer.pressure[zone]).sum())

    @cached_property
    def in_zone(self) -> BoolArray:
        """Whether each zone has each element (zones, m)."""
        points = self.body.points
        has = np.zeros((len(self.body.problem.zones), len(self.mesh.elements)), bool)
        has[points.zone_of_share, points.element] = True
        return has

    @cached_property
    def weights(self) -> Array:
        """Weights (m, 3) of Gauss-Legendre integration along each element [L]."""
        xi, weights = reference_element.gauss_legendre(3)
        tangents = self.mesh.tangents_at(xi)
        return np.hypot(tangents[..., 0], tangents[..., 1]) * weights


def solved(problem: Problem, near: Solved | None = None) -> Solved:
    """Condense and solve a problem on its mesh, as of `solved_state`; `SolverError` without a contact state."""
    return solved_state(condensed(problem), near)


def solved_state(condensation: Condensation, near: Solved | None = None) -> Solved:
    """Solve a condensed problem, under the case that acts or each one; `SolverError` without a contact state.

    The search for contact starts where it was on a mesh that is `near`, if one is known.
    """
    problem, runs = condensation.body.problem, tuple(zone_runs(condensation.body))
    names = (None,) if problem.case is not None or not problem.load_cases else problem.case_names
    starts = [None] * len(names) if near is None else [it.touching(condensation.body.points) for it in near.answers]
    answers = (_answer(condensation.acting(name), runs, start) for name, start in zip(names, starts, strict=True))
    return Solved(condensation=condensation, runs=runs, answers=tuple(answers))


def _answer(condensation: Condensation, runs: Sequence[ZoneRun], start: BoolArray | None) -> CaseAnswer:
    """Solve the contact problem of one load case."""
    solution = complementarity.solve(condensation.contact, near=start)
    if solution.status is not Status.SOLVED:
        raise SolverError(f"no contact state was found on a mesh: {solution.status.words}")
    state = boundary_state(condensation, solution.pressure, solution.rigid_amplitudes)
    return answer_of(condensation, solution, state, runs)


def answer_of(
    condensation: Condensation, solution: ContactSolution, state: BoundaryState, runs: Sequence[ZoneRun]
) -> CaseAnswer:
    """Order a contact state by elements and by runs of the zones."""
    contact, body = condensation.contact, condensation.body
    intervals = footprint(contact, solution).intervals
    points = body.points
    pressure = np.zeros((len(body.problem.zones), *body.mesh.elements.shape))
    if intervals:  # else what there is of pressure is round-off
        pressure[points.zone_of_share, points.element, points.local] = solution.pressure[points.point]
    return CaseAnswer(
        condensation=condensation,
        solution=solution,
        stretches={run.number: _without_slits(contact_stretches(run, contact, solution, intervals)) for run in runs},
        around=frozenset(item.run for item in intervals if item.length >= (1 - SAME) * item.perimeter),
        pressure=pressure,
        state=state,
    )


def _without_slits(stretches: Iterable[Stretch]) -> tuple[Stretch, ...]:
    """Join stretches of contact between which almost nothing is open."""
    joined: list[Stretch] = []
    for item in stretches:
        if joined:
            last = joined[-1]
            if item.start - last.end <= SLIT * min(item.end - item.start, last.end - last.start):
                joined[-1] = replace(last, end=item.end, end_free=item.end_free, points=last.points + item.points)
                continue
        joined.append(item)
    return tuple(joined)


@frozen
class MeshDifference:
    """What bisecting every element changes: `fine` is on the halves of the elements of `coarse`; one load case.

    Parameters
    ----------
    coarse, fine : one mesh, and the same with every element in two
    number : of the load case
    partly : a mesh between these two, with some elements in two, if it was needed
    """

    coarse: Solved
    fine: Solved
    number: int
    partly: Solved | None = None

    @property
    def pair(self) -> tuple[CaseAnswer, CaseAnswer]:
        """Coarse and fine answer."""
        return self.coarse.answers[self.number], self.fine.answers[self.number]

    @property
    def meshes(self) -> tuple[Solved, ...]:
        """The meshes, from the coarse one to the fine one."""
        return (self.coarse, self.fine) if self.partly is None else (self.coarse, self.partly, self.fine)

    @cached_property
    def pressure(self) -> Array:
        """Change (zones, 2 m, 3) of the pressure at Gauss points of the halves [p]."""
        one, two = self.pair
        return np.stack([_at_gauss(b - halves(a)) for a, b in zip(one.pressure, two.pressure, strict=True)])

    @cached_property
    def energy(self) -> Array:
        """Change (m,) of the energy of each coarse element, h/G ∫|Δt|² + G h ∫|Δu' - ω n|², per thickness [p L²].

        ω is the change of its mean rotation. This is no error of the element: an unloaded arm turns as a whole by the
        errors of elements elsewhere.
        """
        return self._energy(*self._fields, turned=False)

    @property
    def _fields(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Displacement and traction of the coarse and of the fine answer."""
        one, two = self.pair
        return (one.displacement, one.traction), (two.displacement, two.traction)

    @cached_property
    def force_errors(self) -> Array:
        """What the error on each coarse element may change the force of each zone by, (zones, m) per thickness [p L].

        This is the energy of the change of the answer times that of the change of its influence on the force, and no
        sum of signed parts: the error of a corner and that of all other elements may cancel on one pair of meshes, so
        that the force itself changes little.
        """
        errors = np.zeros((len(self.coarse.in_zone), len(self.coarse.mesh.elements)))
        of_answer = self._energy(*self._fields)
        for own, *both in zip(errors, *(answer.force_influence() for answer in self.pair), strict=False):
            own += np.sqrt(of_answer * self._energy(*both))
        return errors

    def _energy(self, one: tuple[Array, Array], two: tuple[Array, Array], *, turned: bool = True) -> Array:
        """`energy` of the difference of two fields (displacement, traction), on the coarse and the fine mesh.

        Mean rotations of elements count where they are `turned`: they do work in other fields.
        """
        mesh, weights = self.fine.mesh, self.fine.weights
        shear = self.fine.body.shear_moduli[:, None]
        length = weights.sum(axis=1)
        traction = _at_gauss(two[1] - halves(one[1]))
        xi, _ = reference_element.gauss_legendre(3)
        slope = reference_element.derivatives(xi) @ (two[0] - halves(one[0]))
        tangents = mesh.tangents_at(xi)
        rate = slope / np.hypot(tangents[..., 0], tangents[..., 1])[..., None]
        if not turned:
            normals = np.stack([tangents[..., 1], -tangents[..., 0]], axis=2)
            normals /= np.hypot(tangents[..., 0], tangents[..., 1])[..., None]
            mean = _by_pairs((weights * np.sum(rate * normals, axis=2)).sum(axis=1)) / _by_pairs(length)
            rate = rate - np.repeat(mean, 2)[:, None, None] * normals
        both = (traction**2).sum(axis=2) / shear + shear * (rate**2).sum(axis=2)
        return _by_pairs(2 * length * (weights * both).sum(axis=1))

    @cached_property
    def pressure_squared(self) -> Array:
        """∫Δp² (zones, m) of each coarse element [p² L]."""
        squares = (self.fine.weights * self.pressure**2).sum(axis=2)
        return squares.reshape(len(squares), -1, 2).sum(axis=2)


def most_of(values: Array, share: float) -> BoolArray:
    """Fewest elements that have a share of the sum, and those that are like the least of them."""
    order = np.sort(values)[::-1]
    total = np.cumsum(order)
    if not len(values) or not total[-1] > 0:
        return np.zeros(len(values), bool)
    last = min(int(np.searchsorted(total, (1 - ALIKE) * share * total[-1])), len(order) - 1)
    return (values >= (1 - ALIKE) * order[last]) & (values > 0)


def norm_squared(solved: Solved, values: Array) -> Array:
    """∫ values² ds (m,) of nodal values (m, 3) on each element."""
    return (solved.weights * _at_gauss(values) ** 2).sum(axis=1)


def halves(values: Array) -> Array:
    """Nodal values (2 m, 3, …) on the halves of elements from those (m, 3, …) on the elements."""
    first = reference_element.values(np.array([-1.0, -0.5, 0.0])) @ values.reshape(len(values), 3, -1)
    second = reference_element.values(np.array([0.0, 0.5, 1.0])) @ values.reshape(len(values), 3, -1)
    return np.stack([first, second], axis=1).reshape(2 * len(values), *values.shape[1:])


def _at_gauss(values: Array) -> Array:
    """Values (m, 3, …) at three Gauss points from those at the nodes."""
    xi, _ = reference_element.gauss_legendre(3)
    return (reference_element.values(xi) @ values.reshape(len(values), 3, -1)).reshape(values.shape)


def _by_pairs(values: Array) -> Array:
    return values.reshape(-1, 2).sum(axis=1)


def penetrations(answer: Solved, case: CaseAnswer) -> Iterator[tuple[int, float]]:
    """Open elements through which a surface passes between the nodes, with the depth [L]."""
    condensation = case.condensation
    gaps = surface_gaps(condensation.body, case.state, condensation.contact, case.solution)
    size = float(magnitudes(case.displacement).max())
    for number, zone in enumerate(answer.body.problem.zones):
        elements = np.flatnonzero(answer.in_zone[number] & ~(case.pressure[number] > 0).any(axis=1))
        if zone in gaps.surfaces and len(elements):
            least = gaps.linear(zone, elements).gap.min(axis=1)
            through = least < -max(PENETRATION * size, ROUNDED * answer.mesh.size)
            yield from zip(elements[through].tolist(), (-least[through]).tolist(), strict=True)
