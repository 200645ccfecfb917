"""The search for a mesh: elements that are fitted to the ends of contact, and cut where the answer changes most."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from bemcontact.adaptivity.error_bars import NOTHING, SAFETY, near_singularities
from bemcontact.adaptivity.fields import MeshDifference, Solved, most_of, norm_squared, penetrations, solved
from bemcontact.adaptivity.first_sizes import SizedOutline
from bemcontact.adaptivity.hidden_changes import hiding
from bemcontact.adaptivity.mesh_sizes import ContactEnd, MeshSizes, as_of_one, cut, useful_limits
from bemcontact.adaptivity.singularities import Singularity, Watch, elements_at
from bemcontact.adaptivity.sizes import OUTSIDE, Limit
from bemcontact.adaptivity.zone_runs import ZoneRun, contact_beside
from bemcontact.arrays import Array, IntArray
from bemcontact.problems.problem import Problem

LAYERS = 5.0
"""Layers of elements in contact beside an end of contact, at first."""
SLOWER = 0.8
"""Factor of the growth of the element size from pass to pass.

Halved elements keep the ratio to their neighbors, and with it an error: that of the pressure at a corner in contact.
"""
MORE_LAYERS, MOST_LAYERS = 1.25, 2.0
"""Factors of the layers where the end of contact is what limits, and of those that the accuracy asks for, in a pass."""
BESIDE_JOINT = 4.0
"""Width of the layers beside an end of contact over its distance from a joint: there the pressure changes within it."""
END_SHARE = 0.1
"""Part of the change of the pressure that the layers of an end may have."""
BESIDE_END = 0.25
"""Part of the width of the layers in which the change of pressure belongs to the end."""
NARROW = 1 / 8
"""Element over contact that fewer points feel than one element has."""
REFITS, NARROW_REFITS = 5, 12
"""Largest number of meshes fitted to the ends of contact in one pass, and while contact is narrow."""
ENERGY_SHARE, PRESSURE_SHARE = 0.8, 0.5
"""Parts of the changes of energy and pressure whose elements are bisected."""
TIP, SHORTEST_TIP = 1 / 8, 1e-5
"""Factor of the element at an infinite pressure, and its least length over the contact."""
MOST_TIPS = 10
"""Number of elements that may have most of what hides in a force: those at corners of the body."""
SPOT = 1 / 4
"""Factor of an element under which something penetrates between nodes."""


@dataclass(kw_only=True)
class MeshSearch(MeshSizes):
    """State of the search for a mesh."""

    watch: Watch = field(default_factory=Watch)
    last: Solved | None = None
    """The answer on the mesh before, where the search for contact starts."""

    @classmethod
    def fitted_to(cls, problem: Problem, answer: Solved) -> Self:
        """Begin with the ends of contact that an answer has, of the same outline with contacts at the same places."""
        search = cls.of(problem)
        ends, search.spots = search.ends_of_contact(answer)
        search.layers, search.last = search.with_counts(ends), answer
        return search

    def bisected(self, coarse: Solved) -> Solved:
        """Solve with every element of a mesh in two, under each load case."""
        return self._solve_on(cut(coarse.body.problem, 2))

    def _solve_on(self, mesh: Problem) -> Solved:
        self.last = solved(mesh, self.last)
        return self.last

    def move(self, problem: Problem) -> None:
        """Go on with contacts as they are in another problem; corners of surfaces are opposite to other places."""
        moved = type(self).of(self.problem.on_contacts_of(problem))
        self.problem, self.marks, self.joints, self.facing = moved.problem, moved.marks, moved.joints, moved.facing

    def goes_on_with(self, answer: Solved) -> bool:
        """Take over contacts from an answer on this mesh, if it needs no other one for them; else change nothing.

        Elements of a body that follow those of another one have to be found anew.
        """
        ends, spots = self.ends_of_contact(answer)
        if self.facing or spots or not self._resting(ends) or [*self._between(answer)]:
            return False
        moved = type(self).of(self.problem.on_contacts_of(answer.body.problem))
        if moved.marks != self.marks:
            return False
        self.problem, self.last = moved.problem, answer
        return True

    def halve(self) -> None:
        """Halve all elements."""
        self.sources = [[limit._replace(size=limit.size / 2) for limit in own] for own in self.sources]

    def fitted(self, most: int, tell: Callable[[int], object]) -> Solved:
        """Solve on meshes of up to `most` unknowns, fitted to the ends of contact until these rest; tell unknowns."""
        coarse = self._solve_on(self.mesh())
        for count in range(NARROW_REFITS):
            tell(coarse.degrees_of_freedom)
            ends, spots = self.ends_of_contact(coarse)
            between = [*self._between(coarse)]
            resting = self._resting(ends) and not between
            if resting and not spots:
                return coarse
            if count >= REFITS and not spots and not between:
                return coarse
            self.layers = self.with_counts(ends)
            self.spots = spots
            for number, limit in between:
                self.sources[number].append(limit)
            mesh = self.mesh()
            if as_of_one(4 * sum(edge.elements or 0 for edge in part.edges) for part in mesh.parts) > most:
                return coarse
            coarse = self._solve_on(mesh)
        return coarse

    def ends_of_contact(self, answer: Solved) -> tuple[list[ContactEnd], list[tuple[int, Limit]]]:
        """Ends of contact under all load cases, and contact that is narrower than an element."""
        ends: list[ContactEnd] = []
        narrow: list[tuple[int, Limit]] = []
        for case in answer.answers:
            for run in answer.runs:
                loop, start = self._start(run)
                for item in case.stretches[run.number]:
                    width = item.end - item.start
                    if item.narrow:
                        size = NARROW * (width or run.element_at(item.start))  # a point has no width
                        limit = Limit(low=start + item.start, high=start + item.end, size=size)
                        narrow.append((loop, limit))
                        continue
                    for position, free, after in (
                        (item.start, item.start_free, True), (item.end, item.end_free, False),
                    ):  # fmt: skip
                        if free:
                            at = (start + position) % self.outline.loops[loop].length
                            layer = min(width / 2, self.outline.thickness_at(loop, at))
                            ends.append(ContactEnd(loop=loop, position=at, after=after, width=layer))
        kept: list[ContactEnd] = []
        for end in ends:
            joints = self.joints[end.loop]
            nearest = float(joints[np.argmin(np.abs(joints - end.position))])
            away = abs(nearest - end.position)
            if away < end.width / BESIDE_JOINT:
                end = replace(end, width=max(BESIDE_JOINT * away, end.width / LAYERS**3))
            first = end.width / LAYERS**3
            if away < first / 2:
                end = replace(end, position=nearest)
            if not any(self._same(end, other, first) for other in kept):
                kept.append(end)
        return kept, narrow

    def _start(self, run: ZoneRun) -> tuple[int, float]:
        """Loop of a run, and position of its start there."""
        number, start = self.outline.start_of(run.edges[0].name)
        return number, start + run.breakpoints[0][0] * run.edges[0].length

    def _same(self, end: ContactEnd, other: ContactEnd, near: float) -> bool:
        """Whether two ends of contact are of one kind and nearer than a length."""
        if end.loop != other.loop or end.after != other.after:
            return False
        away = abs(end.position - other.position)
        return min(away, self.outline.loops[end.loop].length - away) <= near

    def with_counts(self, ends: Sequence[ContactEnd]) -> list[tuple[ContactEnd, float]]:
        """Give each end the layers that it had."""
        return [(end, self._count(end)) for end in ends]

    def _count(self, end: ContactEnd) -> float:
        alike = [
            (abs(other.position - end.position), n) for other, n in self.layers if self._same(end, other, end.width)
        ]
        return min(alike)[1] if alike else LAYERS

    def _resting(self, ends: Sequence[ContactEnd]) -> bool:
        """Whether the ends of contact are within the first element of those that the mesh is fitted to.

        More layers than `LAYERS` tell the end, and are not wrong if they are not fitted to it as closely.
        """
        if len(ends) != len(self.layers):
            return False
        for end in ends:
            first = [(other, end.width * (OUTSIDE / min(count, LAYERS)) ** 3) for other, count in self.layers]
            if not any(self._same(end, other, length) for other, length in first):
                return False
        return True

    def _between(self, answer: Solved) -> Iterator[tuple[int, Limit]]:
        """Limits for open elements through which a surface passes between the nodes."""
        for case in answer.answers:
            yield from (self._limit(answer, element, SPOT) for element, _ in penetrations(answer, case))

    def refine(self, differences: Sequence[MeshDifference], singular: Sequence[Sequence[Singularity]]) -> None:
        """Limit the size of elements where bisecting them changes most."""
        coarse, asked = differences[0].coarse, self.problem.asked_accuracy
        assert asked is not None
        wanted = np.zeros(len(coarse.mesh.elements), bool)
        factor = np.full(len(wanted), 0.5)
        for difference, its in zip(differences, singular, strict=True):
            wanted |= most_of(difference.energy, ENERGY_SHARE)
            wanted |= most_of(self._change_of_pressure(difference, its), PRESSURE_SHARE)
            tips = _tips(difference, its)
            for errors in hiding(difference, asked / SAFETY):
                wanted |= most_of(errors, ENERGY_SHARE)
                tips = np.append(tips, np.flatnonzero(errors > errors.sum() / MOST_TIPS))
            wanted[tips], factor[tips] = True, TIP
        for element in np.flatnonzero(wanted):
            number, limit = self._limit(coarse, int(element), float(factor[element]))
            self.sources[number].append(limit)
        self.sources = [useful_limits(*pair) for pair in zip(self.outline.loops, self.sources, strict=True)]
        self.layers = [(end, max(n, min(MOST_LAYERS * n, self._layers_asked()))) for end, n in self.layers]
        self.growth *= SLOWER

    def _layers_asked(self) -> float:
        """Layers with which the distance of nodes at an end of contact allows half of the accuracy asked.

        It is w / 4 (n / `OUTSIDE`)³ outside when elements are cut in two, and contact is at least 2 w long.
        """
        assert self.problem.asked_accuracy is not None
        return OUTSIDE * (SAFETY / 4 / self.problem.asked_accuracy) ** (1 / 3)

    def _change_of_pressure(self, difference: MeshDifference, singular: Sequence[Singularity]) -> Array:
        """Change of the pressure (m,) that elements can mend; where the layers of an end can, they become more.

        None is left where the whole change is round-off, as of a pressure that is uniform: which element has most of
        it must not decide on the mesh.
        """
        coarse, (one, _) = difference.coarse, difference.pair
        change = difference.pressure_squared.copy()
        for zone, own in enumerate(one.pressure):
            square = norm_squared(coarse, own).sum()
            told = change[zone].sum() > NOTHING**2 * square
            change[zone] *= told / (square or 1.0)
        change = change.sum(axis=0)
        change[near_singularities(coarse, one, singular)] = 0.0
        total = change.sum()
        for number, elements in enumerate(self._beside_ends(coarse)):
            if total > 0 and change[elements].sum() > END_SHARE * total:
                end, count = self.layers[number]
                self.layers[number] = end, count * MORE_LAYERS
            change[elements] = 0.0
        return change

    def _limit(self, answer: Solved, element: int, factor: float) -> tuple[int, Limit]:
        """Loop of an element, and the limit there that makes its size smaller by a factor."""
        name = answer.mesh.edge_names[answer.mesh.edge[element]]
        low, _, high = answer.mesh.fractions[element].tolist()
        (number, start), length = self.outline.start_of(name), answer.body.problem.edge(name).length
        return number, Limit(low=start + low * length, high=start + high * length, size=factor * (high - low) * length)

    def _beside_ends(self, answer: Solved) -> list[IntArray]:
        """Elements whose change of pressure belongs to each end of contact."""
        middles, loops = _middles(answer, self.outline)
        return [
            np.flatnonzero(
                (loops == end.loop)
                & (_around(middles - end.position, self.outline.loops[end.loop].length) <= BESIDE_END * end.width)
            )
            for end, _ in self.layers
        ]


def _tips(difference: MeshDifference, singular: Sequence[Singularity]) -> IntArray:
    """Elements at infinite pressures that are not yet as short as they may become."""
    coarse, (one, _) = difference.coarse, difference.pair
    tips = [np.zeros(0, int)]
    for item in singular:
        if not item.like_a_kink:
            run, at = coarse.run(item.place.run), item.place.position
            tip = elements_at(coarse, run, at)
            shortest = SHORTEST_TIP * contact_beside(run, one.stretches[run.number], at)[1]
            tips.append(tip[coarse.weights[tip].sum(axis=1) > shortest])
    return np.concatenate(tips)


def _around(away: Array, length: float) -> Array:
    away = np.mod(np.abs(away), length)
    return np.minimum(away, length - away)


def _middles(answer: Solved, outline: SizedOutline) -> tuple[Array, Array]:
    """Position of the middle of each element on its loop, and the number of the loop."""
    positions, loops = [], []
    for number, loop in enumerate(outline.loops):
        for edge in loop.edges:
            ends = answer.mesh.ends_on(edge.name)
            positions.append(loop.start_of[edge.name] + edge.length * (ends[:-1] + ends[1:]) / 2)
            loops.append(np.full(len(ends) - 1, number))
    return np.concatenate(positions), np.concatenate(loops)
