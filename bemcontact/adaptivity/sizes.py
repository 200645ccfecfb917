"""Element sizes along the closed loops of the boundary, and the element ends that follow from them."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from math import ceil
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, IntArray
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen, frozen_value
from bemcontact.problems.curves import Edge

GROWTH = 1.2
"""Largest growth of the element size with the distance along the boundary: neighbors up to 3.3 times as long."""
OUTSIDE = 1.5
"""Ratio of the layers in contact to those outside, beside an end of contact."""
SHORTEST = 5e-4
"""Least element beside an end of contact, over the width of the layers."""
LEAST = 2
"""Least number of elements of an edge."""
ROUNDING = 0.05
"""Part of an element that is not worth an element."""
RESOLUTION = 0.5
"""Largest step of the samples of the size, over the size."""
SAME = 1e-9
"""Relative difference of two lengths below which round-off decides which one is longer."""
NEAREST = 1e-9
"""Least element over its edge: ten times the least that an edge can be divided into."""


class Limit(NamedTuple):
    """A limit of the element size between two positions [L]; beyond them it grows with the distance."""

    low: float
    high: float
    size: float


@frozen_value
class Layers:
    """Elements that grow like w (i/n)³ from an end of contact: n in contact, fewer outside.

    Parameters
    ----------
    position : of the end of contact [L]
    width : w, of the layers [L]
    count : n
    after : whether contact is after the end, in the order of the boundary
    """

    position: float
    width: float
    count: float
    after: bool


def layer_sizes(layers: Sequence[Layers], beyond: Array, growth: float) -> Array:
    """Sizes (k, l) that each of the layers asks for at distances (k, l) from its end of contact, negative before it.

    At the end itself it is that in contact.
    """
    w, n, after = np.array([(item.width, item.count, item.after) for item in layers]).T
    d = np.abs(beyond)
    touching = ((beyond > 0) == (after > 0)) | (d <= SAME * w)
    n = np.where(touching, n, n / OUTSIDE)
    inside = np.maximum.reduce([w / n**3, SHORTEST * w + np.zeros_like(d), 3 / n * np.cbrt(w * np.minimum(d, w) ** 2)])
    return inside + growth * np.maximum(d - w, 0.0)


@frozen
class Loop:
    """A closed loop of edges; positions on it are arc lengths from its start [L].

    Parameters
    ----------
    edges : in their order
    growth : of the element size with the distance along the loop
    """

    edges: tuple[Edge, ...]
    growth: float = GROWTH

    @cached_property
    def joints(self) -> Array:
        """Positions (k + 1,) where the k edges begin and end."""
        return np.concatenate([[0.0], np.cumsum([edge.length for edge in self.edges])])

    @cached_property
    def length(self) -> float:
        """Length of all edges [L]."""
        return float(self.joints[-1])

    @cached_property
    def start_of(self) -> dict[str, float]:
        """Position of the start of each edge by its name."""
        return dict(zip((edge.name for edge in self.edges), self.joints.tolist(), strict=False))

    def forwards(self, positions: Array, starts: Array) -> Array:
        """Distances (k, l) [L] forwards along the loop from starts (l,) to positions (k,), modulo its length."""
        return np.mod(positions[:, None] - starts, self.length)

    def without_idle(self, limits: Array) -> Array:
        """The limits (l, 3) without those that others make idle, the smallest first, of equal ones the first.

        They are idle for any smaller growth too.
        """
        rounded = np.round(np.log(limits[:, 2] / self.length) / SAME)
        order = limits[np.lexsort((limits[:, 0], rounded))]
        others = self._least_of_others(order)
        kept = others > (1 + SAME) * order[:, 2]
        for i in np.flatnonzero(~kept & ~(others < (1 - SAME) * order[:, 2])):
            kept[i] = not self._idle(order[i], order[:i][kept[:i]])
        return order[kept]

    def _least_of_others(self, limits: Array) -> Array:
        """Size (l,) that all other limits allow where a limit of a single position is; of a wider one not known."""
        low, high, size = limits.T
        wide = high > low
        position = np.mod(np.append(low, high[wide]), self.length)
        order = np.argsort(position)
        at, value = position[order], np.append(size, size[wide])[order]
        turns = np.concatenate([at - self.length, at, at + self.length])
        before = np.minimum.accumulate(np.tile(value, 3) - self.growth * turns)
        after = np.minimum.accumulate((np.tile(value, 3) + self.growth * turns)[::-1])[::-1]
        here = np.arange(len(at), 2 * len(at))
        least = np.empty(len(at))
        least[order] = np.minimum(before[here - 1] + self.growth * at, after[here + 1] - self.growth * at)
        least = np.where(wide, np.nan, least[: len(limits)])
        inside = self.forwards(low, low[wide]) <= (high - low)[wide]
        return np.minimum(least, np.where(inside, size[wide], np.inf).min(axis=1, initial=np.inf))

    def _idle(self, limit: Array, others: Array) -> bool:
        """Whether others (l, 3) allow no larger size than a limit (3,) anywhere on it: together they cover it."""
        low, high, size = others.T
        reach = ((1 + SAME) * limit[2] - size) / self.growth
        width, begin = limit[1] - limit[0], np.mod(low - reach - limit[0], self.length)
        begin = np.concatenate([begin, begin - self.length])
        end = begin + np.tile(high - low + 2 * reach, 2)
        own = (begin <= width) & (end >= 0)
        begin, end = begin[own], end[own]
        if not (begin <= 0).any() or end.max() < width:
            return False
        order = begin.argsort()
        far = np.maximum.accumulate(end[order])
        return not np.any((far[:-1] < width) & (begin[order[1:]] > 0) & (begin[order[1:]] > far[:-1]))

    def element_ends(
        self, limits: Array, layers: Sequence[Layers], marks: Iterable[float]
    ) -> dict[str, tuple[float, ...]]:
        """Fractions of the length of each edge where elements end inside it: at the marks, and in equal steps of ∫ds/h.

        Parameters
        ----------
        limits, layers : of the element size h, see `SizeField`
        marks : positions [L] at which elements end besides the joints
        """
        inside = np.mod([*marks], self.length)
        corners = [self._corners(start, stop, inside) for start, stop in pairwise(self.joints)]
        ends: dict[str, tuple[float, ...]] = {}
        for edge, own, sampled in zip(self.edges, corners, self._sampled(corners, limits, layers), strict=True):
            ends[edge.name] = apart((_divided(own, *sampled) - own[0]) / (own[-1] - own[0]))
        return ends

    def _corners(self, start: float, stop: float, marks: Array) -> Array:
        """Positions of the start of an edge, of the marks inside it, and of its end."""
        same = SAME * (stop - start)
        if not len(marks):
            return np.array([start, stop])
        own = np.unique(marks[(marks > start + same) & (marks < stop - same)])
        return np.concatenate([[start], own[np.diff(own, prepend=start) > same], [stop]])

    def _sampled(
        self, corners: Sequence[Array], limits: Array, layers: Sequence[Layers]
    ) -> Iterator[tuple[Array, Array]]:
        """Samples of each edge between its corners, with the sizes there; all edges at once, for few calls."""
        known = np.mod(np.append(limits[:, :2].ravel(), [layer.position for layer in layers]), self.length)
        samples = np.concatenate(
            [np.unique(np.append(own, known[(known > own[0]) & (known < own[-1])])) for own in corners]
        )  # the end of an edge and the start of the next are two samples at one place
        field = SizeField(loop=self, limits=limits, layers=layers)
        size = field.at(samples)
        for _ in range(60):
            step = np.diff(samples)
            coarse = step > (1 + SAME) * RESOLUTION * np.minimum(size[:-1], size[1:])
            if not coarse.any():
                break
            middle = (samples[:-1] + samples[1:])[coarse] / 2
            order = np.append(np.arange(len(samples)), np.flatnonzero(coarse) + 0.5).argsort(kind="stable")
            samples = np.append(samples, middle)[order]
            size = np.append(size, field.at(middle))[order]
        between = (np.searchsorted(samples, self.joints[1:-1], side="right") - 1).tolist()
        for first, last in pairwise([0, *between, len(samples)]):
            yield samples[first:last], size[first:last]


@frozen
class SizeField:
    """The element size along a loop that limits, rows of (l, 3), and layers allow: the least of theirs.

    The size of a limit grows from both of its ends, so that only the nearest of these matter on either side: those from
    which it grows to the least size.
    """

    loop: Loop
    limits: Array
    layers: Sequence[Layers]

    @cached_property
    def _ends(self) -> tuple[Array, Array, IntArray]:
        """Positions (e,) of the ends of limits in their order, their sizes (e,), and the rank of each as they were."""
        low, high, size = self.limits.T
        position = np.mod(np.append(low, high), self.loop.length)
        order = np.argsort(position, kind="stable")
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        return position[order], np.append(size, size)[order], rank

    @cached_property
    def _nearest(self) -> tuple[Array, Array, IntArray, IntArray]:
        """Positions and sizes (3 e,) of the ends on three turns; at each the end before and after that matters there.

        Sizes grow with the distance from the former up to the next end, and with that from the latter.
        """
        at, size, _ = self._ends
        turns = np.concatenate([at - self.loop.length, at, at + self.loop.length])
        size, number = np.tile(size, 3), np.arange(3 * len(at))
        falling, rising = size - self.loop.growth * turns, size + self.loop.growth * turns
        before = np.maximum.accumulate(np.where(falling <= np.minimum.accumulate(falling), number, 0))
        least = np.minimum.accumulate(rising[::-1])[::-1]
        after = np.minimum.accumulate(np.where(rising <= least, number, number[-1])[::-1])[::-1]
        return turns, size, before, after

    @cached_property
    def _covered(self) -> Array:
        """Least size (e,) of the limits that cover all from one end of limits to the next; infinite without any."""
        low, high, size = self.limits.T
        first, last = self._ends[2].reshape(2, -1).tolist()
        covered, order = np.full(2 * len(low), np.inf), np.argsort(-size, kind="stable")
        for i in order[(high > low)[order]].tolist():
            if high[i] - low[i] >= (1 - SAME) * self.loop.length:
                covered[:] = size[i]
            elif first[i] <= last[i]:
                covered[first[i] : last[i]] = size[i]
            else:
                covered[first[i] :] = covered[: last[i]] = size[i]
        return covered

    def at(self, positions: Array) -> Array:
        """Size (k,) [L] at positions (k,)."""
        loop, (ends, _, _), (turns, size, before, after) = self.loop, self._ends, self._nearest
        s = np.mod(positions, loop.length)
        number = np.searchsorted(ends, s, side="right")
        one, two = before[number + len(ends) - 1], after[number + len(ends)]
        grown = np.minimum(size[one] + loop.growth * (s - turns[one]), size[two] + loop.growth * (turns[two] - s))
        least = np.minimum(grown, self._covered[number - 1])
        if self.layers:
            beyond = loop.forwards(positions, np.array([layer.position for layer in self.layers]))
            beyond = np.where(beyond <= loop.length / 2, beyond, beyond - loop.length)
            least = np.minimum(least, layer_sizes(self.layers, beyond, loop.growth).min(axis=1))
        return least


def _divided(corners: Array, samples: Array, size: Array) -> Array:
    """Positions of the element ends inside an edge, in equal steps of ∫ds/h between its corners."""
    count = np.concatenate([[0.0], np.cumsum(np.diff(samples) * (1 / size[:-1] + 1 / size[1:]) / 2)])
    at_corner = np.interp(corners, samples, count)
    least = LEAST if len(corners) == 2 else 1
    pieces = []
    for number, (low, high) in enumerate(pairwise(at_corner)):
        elements = max(ceil(high - low - ROUNDING), least)
        inner = np.interp(np.linspace(low, high, elements + 1)[1:], count, samples)
        inner[-1] = corners[number + 1]
        pieces.append(inner)
    return np.concatenate(pieces)[:-1]


def apart(fractions: Array) -> tuple[float, ...]:
    """Fractions of the length of an edge without those that leave no room for an element."""
    kept = [0.0]
    for fraction in fractions.tolist():
        if fraction - kept[-1] >= NEAREST and 1 - fraction >= NEAREST:
            kept.append(fraction)
    return tuple(kept[1:])
