"""Element sizes where two elastic bodies face each other: the first has those of both, the second follows the first."""

from collections.abc import Iterator, Sequence

import numpy as np

from bemcontact.adaptivity.sizes import Limit, Loop
from bemcontact.arrays import Array
from bemcontact.bem.division import feet, in_order, matched_parts
from bemcontact.frozen import frozen
from bemcontact.problems.problem import Problem

SAMPLES = 513
"""Places of a stretch between which the opposite ones are interpolated."""


@frozen
class FacingStretch:
    """A stretch of the boundary of one body opposite to one of another body.

    Parameters
    ----------
    edge : of the first body
    loop, onto : numbers of the loops of the first and the second body
    places, opposite : positions (k,) on them [L], of which the latter descend
    """

    edge: str
    loop: int
    onto: int
    places: Array
    opposite: Array

    @property
    def opposite_ends(self) -> list[float]:
        """Positions of both ends on the second loop."""
        return self.opposite[[0, -1]].tolist()

    def sizes_of_first(self, limits: Sequence[Limit]) -> list[Limit]:
        """Limits on the first loop opposite to those (low, high, size) on the second one."""
        (last, first), found = self.opposite_ends, list[Limit]()
        for low, high, size in limits:
            if low <= last and high >= first:
                onto = [min(high, last), max(low, first)]
                begin, end = np.interp(onto, self.opposite[::-1], self.places[::-1]).tolist()
                found.append(Limit(low=begin, high=end, size=size))
        return found

    def sizes_of_second(self, loop: Loop, ends: Sequence[float]) -> list[Limit]:
        """Limits on the second loop that are the lengths of the elements of the first one, from the ends of these."""
        start, length = loop.start_of[self.edge], next(edge.length for edge in loop.edges if edge.name == self.edge)
        at = start + length * np.array([0.0, *ends, 1.0])
        same = 1e-9 * length
        at = at[(at >= self.places[0] - same) & (at <= self.places[-1] + same)]
        there = np.interp(at, self.places, self.opposite)
        return [
            Limit(low=low, high=high, size=high - low)
            for high, low in zip(there[:-1].tolist(), there[1:].tolist(), strict=True)
            if high > low
        ]


def ends_of_parts(problem: Problem, loops: Sequence[Loop]) -> Iterator[tuple[int, list[float]]]:
    """Number of the loop and positions on it where a part ends that is opposite to another body, elastic or rigid."""
    for contact in (*problem.contacts, *problem.bonded):
        for part in problem.opposite(contact):
            for number, loop in enumerate(loops):
                if part.edge in loop.start_of:
                    length = problem.edge(part.edge).length
                    yield number, [loop.start_of[part.edge] + at * length for at in (part.low, part.high)]


def facing_stretches(problem: Problem, loops: Sequence[Loop]) -> list[FacingStretch]:
    """Stretches of all contacts of two elastic bodies; each follows those whose elements it takes over."""
    matched, edges = [*matched_parts(problem)], {edge.name: edge for edge in problem.edges}
    if not matched:
        return []
    loop_of = {name: number for number, loop in enumerate(loops) for name in loop.start_of}
    order = in_order(edges, matched)
    found = []
    for item in sorted(matched, key=lambda item: order.index(item.onto)):
        name, onto = item.part.edge, item.onto
        at = np.linspace(item.part.low, item.part.high, SAMPLES)
        there = feet(item, edges[name], at)
        first, second = loops[loop_of[name]], loops[loop_of[onto]]
        found.append(
            FacingStretch(
                edge=name,
                loop=loop_of[name],
                onto=loop_of[onto],
                places=first.start_of[name] + edges[name].length * at,
                opposite=second.start_of[onto] + edges[onto].length * there,
            )
        )
    return found
