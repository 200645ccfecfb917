"""The sizes that a mesh is made from: those of the geometry, of stated elements, and those that a search adds."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import pairwise
from typing import Self

import numpy as np

from bemcontact.adaptivity.facing_sizes import FacingStretch, ends_of_parts, facing_stretches
from bemcontact.adaptivity.first_sizes import SizedOutline, sized_outline, surface_sizes
from bemcontact.adaptivity.sizes import GROWTH, SAME, Layers, Limit, Loop
from bemcontact.arrays import Array
from bemcontact.errors import Issue, ProblemError
from bemcontact.frozen import frozen_value
from bemcontact.problems.geometry import MOST_ELEMENTS
from bemcontact.problems.problem import Problem

MOST_UNKNOWNS = 4000
"""Largest number of unknowns of the finer mesh, of several bodies as `as_of_one` counts them."""
UNKNOWNS = 4
"""Unknowns of an element: two displacements at each of two nodes, for the third is that of the next element."""
LOOPS_KEPT = 16
"""Loops whose first sizes and first elements are kept for other problems with the same ones."""


def as_of_one(unknowns: Iterable[int]) -> int:
    """Unknowns of one body whose equations take as long as those of several bodies, each with so many."""
    return round(sum(count**3 for count in unknowns) ** (1 / 3))


@frozen_value
class ContactEnd:
    """An end of contact on a loop."""

    loop: int
    position: float
    after: bool
    width: float


@dataclass(kw_only=True)
class MeshSizes:
    """Sizes of elements along the boundary of a problem, and the mesh that follows from them."""

    problem: Problem
    outline: SizedOutline
    sources: list[list[Limit]]
    marks: list[list[float]]
    joints: list[Array]
    """Positions where edges of each loop begin or end, or parts of these that another body faces."""
    facing: list[FacingStretch] = field(default_factory=list)
    layers: list[tuple[ContactEnd, float]] = field(default_factory=list)
    spots: list[tuple[int, Limit]] = field(default_factory=list)
    growth: float = GROWTH

    @classmethod
    def of(cls, problem: Problem) -> Self:
        """Begin with the geometry, the surfaces, and stated elements; `ProblemError` if these alone are too many."""
        stated = sum(edge.elements or 0 for edge in problem.edges)
        if (most := MOST_UNKNOWNS // UNKNOWNS) < stated:
            message = (
                f"{stated} elements are stated, and a mesh that is found has at most {most}; state fewer, or elements "
                "on all edges and no accuracy, so that the mesh is taken as it is"
            )
            raise ProblemError(Issue(path=("boundary",), message=message))
        shape = sized_outline(problem)
        near, corners = surface_sizes(problem, shape)
        limits: list[list[Limit]] = []
        marks: list[list[float]] = []
        for number, loop in enumerate(shape.loops):
            own, ends = [*shape.limits[number], *near.get(number, [])], [*corners.get(number, [])]
            for edge in loop.edges:
                start, length = loop.start_of[edge.name], edge.length
                ends += [start + place * length for place in edge.ends_at]
                ends += [start + stop for stop in problem.load_stops(edge)]
                if edge.elements is not None:
                    at = start + length * edge.breakpoints(problem.mesh.refine)
                    own += [Limit(low=low, high=high, size=high - low) for low, high in pairwise(at.tolist())]
            limits.append([*_first_limits(loop, tuple(own))])
            marks.append(ends)
        facing = facing_stretches(problem, shape.loops)
        joints = [loop.joints for loop in shape.loops]
        for number, places in ends_of_parts(problem, shape.loops):
            marks[number] += places
            joints[number] = np.append(joints[number], places)
        for item in facing:
            marks[item.onto] += item.opposite_ends
        for loop, own, ends in zip(shape.loops, limits, marks, strict=True):
            own += between_marks(loop, ends)
        # A mesh that is found asks for the accuracy as before.
        kept = problem.model_copy(update={"accuracy": problem.asked_accuracy})
        return cls(problem=kept, outline=shape, sources=limits, marks=marks, joints=joints, facing=facing)

    def mesh(self) -> Problem:
        """The problem with elements as the sources ask."""
        ends = self._ends()
        if (total := sum(len(own) + 1 for own in ends.values())) > MOST_ELEMENTS:
            needed = f"a mesh of this body needs {total} elements, more than {MOST_ELEMENTS}"
            message = f"{needed}: it is too slender, or has too small parts; check its coordinates, or state elements"
            raise ProblemError(Issue(path=("boundary",), message=message))
        return cut(self.problem.with_element_ends(ends), 1)

    def _ends(self) -> dict[str, tuple[float, ...]]:
        """Fractions of the length of each edge where elements end inside it.

        Where two bodies face each other, the first has the sizes of both, and the second takes over its elements.
        """
        limits = [
            [*own, *(limit for at, limit in self.spots if at == number)] for number, own in enumerate(self.sources)
        ]
        for item in reversed(self.facing):
            limits[item.loop] += item.sizes_of_first(limits[item.onto])
        ends: dict[str, tuple[float, ...]] = {}
        for number in range(len(self.outline.loops)):
            ends.update(self._ends_on(number, limits[number]))
        for item in self.facing:
            loop = self.outline.loops[item.loop]
            limits[item.onto] += item.sizes_of_second(loop, ends[item.edge])
            ends.update(self._ends_on(item.onto, limits[item.onto]))
        return ends

    def _ends_on(self, number: int, limits: Sequence[Limit]) -> Mapping[str, tuple[float, ...]]:
        """The same on the edges of one loop."""
        own = [(end, count) for end, count in self.layers if end.loop == number]
        layers = [Layers(position=e.position, width=e.width, count=n, after=e.after) for e, n in own]
        marks = [*self.marks[number], *(end.position for end, _ in own)]
        if not layers:
            return _first_ends(self.outline.loops[number], self.growth, tuple(limits), tuple(marks))
        sized = replace(self.outline.loops[number], growth=self.growth)
        return sized.element_ends(np.array(limits), layers, marks)


def first_mesh(problem: Problem) -> Problem:
    """The problem on the first mesh, from the geometry alone and the elements that are stated."""
    return MeshSizes.of(problem).mesh()


def between_marks(loop: Loop, marks: Sequence[float]) -> Iterator[Limit]:
    """Limits by which elements grow from places that are close to each other, where an element has to end at each."""
    places = np.unique(np.append(np.mod(marks, loop.length), loop.joints))
    apart = np.diff(places)
    for low, size in zip(places[:-1][apart > SAME * loop.length], apart[apart > SAME * loop.length], strict=True):
        yield Limit(low=float(low), high=float(low + size), size=float(size))


@lru_cache(maxsize=LOOPS_KEPT)
def _first_limits(loop: Loop, limits: tuple[Limit, ...]) -> tuple[Limit, ...]:
    """`useful_limits` before a search, found once for problems that differ in loads, such as members of a study."""
    return tuple(useful_limits(loop, limits))


@lru_cache(maxsize=LOOPS_KEPT)
def _first_ends(
    loop: Loop, growth: float, limits: tuple[Limit, ...], marks: tuple[float, ...]
) -> Mapping[str, tuple[float, ...]]:
    """`Loop.element_ends` where no end of contact is known yet, found once for problems that differ in loads."""
    return replace(loop, growth=growth).element_ends(np.array(limits), [], marks)


def useful_limits(loop: Loop, limits: Sequence[Limit]) -> list[Limit]:
    """The limits without those that others make idle."""
    return [Limit(*row) for row in loop.without_idle(np.array(limits)).tolist()]


def cut(problem: Problem, refine: int) -> Problem:
    """The problem with each element of its mesh cut into equal parts."""
    mesh = problem.mesh.model_copy(update={"refine": refine})
    return problem.model_copy(update={"mesh": mesh})
