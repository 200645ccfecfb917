"""A mesh that nobody makes: solve, bisect, compare, and refine until the error bars are below the accuracy asked."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from bemcontact.adaptivity.error_bars import contact_beside, error_bars, near_singularities
from bemcontact.adaptivity.fields import Answer, Difference, Solved, norm_squared, solved
from bemcontact.adaptivity.first_sizes import Outline, outline, surface_sizes
from bemcontact.adaptivity.singularities import Singularity, Watch, elements_at
from bemcontact.adaptivity.sizes import Layers, Limit, Loop
from bemcontact.adaptivity.zone_runs import ZoneRun
from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.assessment.accuracy import Accuracy
from bemcontact.bem import reference_element
from bemcontact.bem.body import body_of
from bemcontact.bem.condense import Condensation, condense
from bemcontact.errors import ProblemError, SingularSystemError, SolverError
from bemcontact.problem.problem import Problem
from bemcontact.problem.rigid_surface import DeflectedContour

LAYERS = 5.0
"""Layers of elements in contact beside an end of contact, at first."""
MORE_LAYERS = 1.25
"""Factor of the layers where the end of contact is what limits."""
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
BETWEEN = 17
"""Points of an open element where the gap is looked at."""
PENETRATION = 1e-3
"""Penetration between nodes, over the largest displacement, that a mesh must resolve."""
SPOT = 1 / 4
"""Factor of an element under which something penetrates between nodes."""
NONE_ASKED = "no accuracy is asked for, and errors are not estimated"
NOT_ESTIMATED = "the errors of this mesh were not estimated"
ALIKE = 1e-6
"""Relative difference below which two elements change alike: both are bisected, or none."""
MOST_PASSES = 14
MOST_FAILURES = 3
"""Number of first meshes that may have no contact state."""
MOST_UNKNOWNS = 4000
"""Largest number of unknowns of the finer mesh."""


@dataclass(frozen=True, kw_only=True)
class _End:
    """An end of contact on a loop."""

    loop: int
    position: float
    after: bool
    width: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Meshed:
    """A problem on the mesh that was found for it or stated, condensed, with the accuracy under each load case."""

    problem: Problem
    condensation: Condensation
    accuracies: tuple[Accuracy, ...]
    singular: tuple[tuple[Singularity, ...], ...] = ()
    """Infinite pressures that the search recognized, under each load case; empty for a stated mesh."""

    @property
    def worst(self) -> float:
        """Largest error bar under any load case."""
        return max(item.worst for item in self.accuracies)

    def because(self, reason: str) -> "Meshed":
        """The same, with the reason why no better accuracy was reached."""
        return replace(self, accuracies=tuple(replace(item, reason=reason) for item in self.accuracies))


@dataclass(kw_only=True)
class _Search:
    """State of the search for a mesh."""

    problem: Problem
    outline: Outline
    sources: list[list[Limit]]
    marks: list[list[float]]
    layers: list[tuple[_End, float]] = field(default_factory=list)
    spots: list[tuple[int, Limit]] = field(default_factory=list)
    watch: Watch = field(default_factory=Watch)
    solves: list[int] = field(default_factory=list)

    def mesh(self, refine: int) -> Problem:
        """The problem with elements as the sources ask, cut into equal parts."""
        ends: dict[str, tuple[float, ...]] = {}
        for number, loop in enumerate(self.outline.loops):
            own = [(end, count) for end, count in self.layers if end.loop == number]
            layers = [Layers(position=e.position, width=e.width, count=n, after=e.after) for e, n in own]
            narrow = [limit for at, limit in self.spots if at == number]
            marks = [*self.marks[number], *(end.position for end, _ in own)]
            ends |= loop.element_ends(np.array([*self.sources[number], *narrow]), layers, marks)
        return _cut(self.problem.with_element_ends(ends), refine)

    def solve(self, refine: int) -> Solved:
        answer = solved(self.mesh(refine))
        self.solves.append(answer.degrees_of_freedom)
        return answer

    def halve(self) -> None:
        """Halve all elements."""
        self.sources = [[limit._replace(size=limit.size / 2) for limit in own] for own in self.sources]

    def fitted(self) -> Solved:
        """Solve on meshes fitted to the ends of contact until these rest."""
        coarse = self.solve(1)
        for count in range(NARROW_REFITS):
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
            coarse = self.solve(1)
        return coarse

    def ends_of_contact(self, answer: Solved) -> tuple[list[_End], list[tuple[int, Limit]]]:
        """Ends of contact under all load cases, and contact that is narrower than an element."""
        ends: list[_End] = []
        narrow: list[tuple[int, Limit]] = []
        for case in answer.answers:
            for run in answer.runs:
                loop, start = self._start(run)
                for item in case.stretches[run.number]:
                    width = item.end - item.start
                    if item.narrow:
                        limit = Limit(low=start + item.start, high=start + item.end, size=NARROW * width)
                        narrow.append((loop, limit))
                        continue
                    for position, free, after in (
                        (item.start, item.start_free, True), (item.end, item.end_free, False),
                    ):  # fmt: skip
                        if free:
                            at = (start + position) % self.outline.loops[loop].length
                            layer = min(width / 2, self.outline.thickness_at(loop, at))
                            ends.append(_End(loop=loop, position=at, after=after, width=layer))
        kept: list[_End] = []
        for end in ends:
            first = end.width / LAYERS**3
            joints = self.outline.loops[end.loop].joints
            nearest = float(joints[np.argmin(np.abs(joints - end.position))])
            if abs(nearest - end.position) < first / 2:
                end = replace(end, position=nearest)
            if not any(self._same(end, other, first) for other in kept):
                kept.append(end)
        return kept, narrow

    def _start(self, run: ZoneRun) -> tuple[int, float]:
        """Loop of a run, and position of its start there."""
        for number, loop in enumerate(self.outline.loops):
            if run.edges[0].name in loop.start_of:
                return number, loop.start_of[run.edges[0].name]
        raise AssertionError(run.edges[0].name)

    def _same(self, end: _End, other: _End, near: float) -> bool:
        """Whether two ends of contact are of one kind and nearer than a length."""
        if end.loop != other.loop or end.after != other.after:
            return False
        away = abs(end.position - other.position)
        return min(away, self.outline.loops[end.loop].length - away) <= near

    def with_counts(self, ends: Sequence[_End]) -> list[tuple[_End, float]]:
        """Give each end the layers that it had."""
        return [(end, self._count(end)) for end in ends]

    def _count(self, end: _End) -> float:
        alike = [
            (abs(other.position - end.position), n) for other, n in self.layers if self._same(end, other, end.width)
        ]
        return min(alike)[1] if alike else LAYERS

    def _resting(self, ends: Sequence[_End]) -> bool:
        """Whether the ends of contact are within the first element of those that the mesh is fitted to."""
        if len(ends) != len(self.layers):
            return False
        for end in ends:
            near = [n for other, n in self.layers if self._same(end, other, end.width * (n / 1.5) ** -3)]
            if not near:
                return False
        return True

    def _between(self, answer: Solved) -> Iterator[tuple[int, Limit]]:
        """Limits for open elements through which a surface passes between the nodes."""
        for case in answer.answers:
            for element, _ in penetrations(answer, case):
                name = answer.mesh.edge_names[answer.mesh.edge[element]]
                for number, loop in enumerate(self.outline.loops):
                    if name in loop.start_of:
                        low, high = _stretch(answer, element)
                        start, length = loop.start_of[name], answer.body.problem.edge(name).length
                        size = SPOT * (high - low) * length
                        yield number, Limit(low=start + low * length, high=start + high * length, size=size)

    def refine(self, differences: Sequence[Difference], singular: Sequence[Sequence[Singularity]]) -> bool:
        """Limit the size of elements where bisecting them changes most; whether the mesh will grow."""
        coarse = differences[0].coarse
        m = len(coarse.mesh.elements)
        wanted = np.zeros(m, bool)
        factor = np.full(m, 0.5)
        for difference, its in zip(differences, singular, strict=True):
            one, _ = difference.pair
            wanted |= _largest(difference.energy, ENERGY_SHARE)
            change = difference.pressure_squared.copy()
            for zone, own in enumerate(one.pressure):
                change[zone] /= norm_squared(coarse, own).sum() or 1.0
            change = change.sum(axis=0)
            change[near_singularities(coarse, one, its)] = 0.0
            total = change.sum()
            beside = self._beside_ends(coarse)
            for number, elements in enumerate(beside):
                if total > 0 and change[elements].sum() > END_SHARE * total:
                    end, count = self.layers[number]
                    self.layers[number] = end, count * MORE_LAYERS
                change[elements] = 0.0
            wanted |= _largest(change, PRESSURE_SHARE)
            for item in its:
                if not item.like_a_kink:
                    run, at = coarse.runs[item.place.run], item.place.position
                    tip = elements_at(coarse, run, at)
                    shortest = SHORTEST_TIP * contact_beside(run, one.stretches[run.number], at)[1]
                    tip = tip[coarse.weights[tip].sum(axis=1) > shortest]
                    wanted[tip], factor[tip] = True, TIP
        for element in np.flatnonzero(wanted):
            self._limit(coarse, int(element), float(factor[element]))
        self.sources = [_useful(*pair) for pair in zip(self.outline.loops, self.sources, strict=True)]
        return bool(wanted.any())

    def _limit(self, answer: Solved, element: int, factor: float) -> None:
        """Limit the size where an element is."""
        name = answer.mesh.edge_names[answer.mesh.edge[element]]
        low, high = _stretch(answer, element)
        length = answer.body.problem.edge(name).length
        for number, loop in enumerate(self.outline.loops):
            if name in loop.start_of:
                start = loop.start_of[name]
                size = factor * (high - low) * length
                self.sources[number].append(Limit(low=start + low * length, high=start + high * length, size=size))

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


def _useful(loop: Loop, limits: Sequence[Limit]) -> list[Limit]:
    """The limits without those that others make idle."""
    return [Limit(*row) for row in loop.without_idle(np.array(limits)).tolist()]


def _cut(problem: Problem, refine: int) -> Problem:
    mesh = problem.mesh.model_copy(update={"refine": refine})
    return problem.model_copy(update={"mesh": mesh})


def _around(away: Array, length: float) -> Array:
    away = np.mod(np.abs(away), length)
    return np.minimum(away, length - away)


def _stretch(answer: Solved, element: int) -> tuple[float, float]:
    """Fractions of its edge where an element begins and ends."""
    mesh = answer.mesh
    first = int(np.flatnonzero(mesh.edge == mesh.edge[element])[0])
    edge = answer.body.problem.edge(mesh.edge_names[mesh.edge[element]])
    ends = edge.breakpoints(answer.body.problem.mesh.refine)
    return float(ends[element - first]), float(ends[element - first + 1])


def _middles(answer: Solved, outline: Outline) -> tuple[Array, Array]:
    """Position of the middle of each element on its loop, and the number of the loop."""
    positions, loops = [], []
    for number, loop in enumerate(outline.loops):
        for edge in loop.edges:
            ends = answer.body.problem.edge(edge.name).breakpoints(answer.body.problem.mesh.refine)
            positions.append(loop.start_of[edge.name] + edge.length * (ends[:-1] + ends[1:]) / 2)
            loops.append(np.full(len(ends) - 1, number))
    return np.concatenate(positions), np.concatenate(loops)


def _largest(values: Array, share: float) -> BoolArray:
    """Fewest elements that have a share of the sum, and those that are like the least of them."""
    order = np.sort(values)[::-1]
    total = np.cumsum(order)
    if not len(values) or not total[-1] > 0:
        return np.zeros(len(values), bool)
    last = min(int(np.searchsorted(total, (1 - ALIKE) * share * total[-1])), len(order) - 1)
    return (values >= (1 - ALIKE) * order[last]) & (values > 0)


def penetrations(answer: Solved, case: Answer) -> Iterator[tuple[int, float]]:
    """Open elements through which a surface passes between the nodes, with the depth [L]."""
    body, points = answer.body, answer.body.points
    contact = case.condensation.contact
    total = contact.initial_gap + case.solution.displacement
    own = np.zeros_like(case.pressure)
    own[points.zone[points.point], points.element, points.local] = total[points.point]
    size = float(np.hypot(*np.moveaxis(case.displacement, 2, 0)).max())
    xi = np.linspace(-1, 1, BETWEEN)[1:-1]
    shapes = reference_element.values(xi)
    nodes = answer.mesh.nodes[answer.mesh.elements]
    for number, zone in enumerate(body.problem.contact_zones.values()):
        if isinstance(zone.surface, DeflectedContour):
            continue
        elements = np.flatnonzero(answer.in_zone[number] & ~(case.pressure[number] > 0).any(axis=1))
        if not len(elements):
            continue
        at_nodes = zone.surface.closest(nodes[elements].reshape(-1, 2)).gap.reshape(-1, 3)
        moved = own[number, elements] - at_nodes
        inside = zone.surface.closest((shapes @ nodes[elements]).reshape(-1, 2)).gap.reshape(len(elements), -1)
        gap = inside + moved @ shapes.T
        for element, least in zip(elements.tolist(), gap.min(axis=1).tolist(), strict=True):
            if least < -PENETRATION * size:
                yield element, -least


def meshed(
    problem: Problem,
    progress: Callable[[str], object] | None = None,
    *,
    errors: bool = True,
    singular: Sequence[Sequence[Singularity]] = (),
) -> Meshed:
    """Condense a problem on the mesh that it states, or on one that is found for the accuracy asked.

    The errors of a stated mesh are estimated, unless no accuracy is asked for or `errors` is false. `singular` are
    infinite pressures under each load case that the search for another mesh of the problem recognized.

    Raises
    ------
    ProblemError
        If the problem has no answer.
    SingularSystemError
        If the equations of the body have no unique solution.
    """
    progress = progress or (lambda _: None)
    if problem.adapts:
        return _found(problem, progress)
    asked, refine = problem.asked_accuracy, problem.mesh.refine
    if asked is None or not errors:
        return _unsolved(problem, asked, NONE_ASKED if asked is None else NOT_ESTIMATED)
    progress("mesh as stated")
    try:
        coarse = solved(problem)
    except SolverError as error:
        return _unsolved(problem, asked, str(error))
    try:
        unknowns = 2 * coarse.degrees_of_freedom
        if unknowns > MOST_UNKNOWNS:
            raise ProblemError(f"with every element in two the mesh has {unknowns} unknowns, more than {MOST_UNKNOWNS}")
        progress("every element in two")
        fine = solved(_cut(problem, 2 * refine))
        bars = [
            error_bars(Difference(coarse=coarse, fine=fine, number=i), its, of_fine=False)
            for i, its in enumerate(singular or [()] * len(fine.answers))
        ]
        accuracies = [Accuracy.of(asked, 1, its) for its in bars]
    except (ProblemError, SingularSystemError, SolverError) as error:
        accuracies = [Accuracy(asked=asked, reason=str(error).splitlines()[0])] * len(coarse.answers)
    return Meshed(problem=problem, condensation=coarse.condensation, accuracies=tuple(accuracies))


def first_mesh(problem: Problem) -> Problem:
    """The problem on the first mesh, from the geometry alone and the elements that are stated."""
    return _search(problem).mesh(1)


def _found(problem: Problem, progress: Callable[[str], object]) -> Meshed:
    """Find a mesh on which all error bars are below the accuracy asked, and solve on it."""
    asked = problem.asked_accuracy
    assert asked is not None
    search = _search(problem)
    best: Meshed | None = None
    reason = f"no better mesh was found in {MOST_PASSES} passes"
    for number in range(1, MOST_PASSES + 1):
        try:
            coarse = search.fitted()
            if 2 * coarse.degrees_of_freedom > MOST_UNKNOWNS:
                reason = f"a finer mesh would have more than {MOST_UNKNOWNS} unknowns"
                break
            fine = search.solve(2)
        except SolverError as error:
            reason = str(error)
            if best is not None or number > MOST_FAILURES:
                break
            search.halve()
            continue
        except (ProblemError, SingularSystemError) as error:
            if best is None:
                raise
            reason = str(error).splitlines()[0]
            break
        differences = [Difference(coarse=coarse, fine=fine, number=i) for i in range(len(fine.answers))]
        singular = [search.watch.look(item) for item in differences]
        bars = [error_bars(item, its) for item, its in zip(differences, singular, strict=True)]
        now = Meshed(
            problem=fine.body.problem,
            condensation=fine.condensation,
            accuracies=tuple(Accuracy.of(asked, number, its) for its in bars),
            singular=tuple(map(tuple, singular)),
        )
        progress(f"pass {number}, {fine.degrees_of_freedom} unknowns, error at most {100 * now.worst:.2g} %")
        best = now if best is None or now.worst <= best.worst else best
        if all(item.met for item in best.accuracies):
            return best
        search.layers = search.with_counts(search.ends_of_contact(fine)[0])
        search.refine(differences, singular)
    return _unsolved(search.mesh(1), asked, reason) if best is None else best.because(reason)


def _unsolved(problem: Problem, asked: float | None, reason: str) -> Meshed:
    """A problem on a mesh whose errors were not estimated, for a reason."""
    count = 1 if problem.case is not None else max(1, len(problem.case_names))
    accuracies = (Accuracy(asked=asked, reason=reason),) * count
    return Meshed(problem=problem, condensation=condense(body_of(problem)), accuracies=accuracies)


def _search(problem: Problem) -> _Search:
    """Begin with sizes from the geometry, the surfaces, and the elements that are stated."""
    shape = outline(problem)
    near, corners = surface_sizes(problem, shape)
    limits: list[list[Limit]] = []
    marks: list[list[float]] = []
    for number, loop in enumerate(shape.loops):
        own, ends = [*shape.sizes(number), *near.get(number, [])], [*corners.get(number, [])]
        for edge in loop.edges:
            start, length = loop.start_of[edge.name], edge.length
            ends += [start + place * length for place in edge.ends_at]
            if edge.elements is not None:
                at = start + length * edge.breakpoints(problem.mesh.refine)
                own += [Limit(low=low, high=high, size=high - low) for low, high in pairwise(at.tolist())]
        limits.append(_useful(loop, own))
        marks.append(ends)
    kept = problem.model_copy(update={"accuracy": problem.asked_accuracy})  # a mesh that is found asks for it as before
    return _Search(problem=kept, outline=shape, sources=limits, marks=marks)
