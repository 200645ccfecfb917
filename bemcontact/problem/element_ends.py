"""Element ends on an edge, as fractions of its length."""

from collections.abc import Sequence
from itertools import pairwise
from math import fsum, log

import numpy as np

from bemcontact.arrays import Array


def graded_ends(elements: int, ratio: float, towards: str | float, places: Sequence[float] = ()) -> Array:
    """Element ends (elements + 1,) from 0 to 1 with lengths from `graded_lengths`, some of them at given places.

    The nearest free end moves to each place, and the others move in proportion. Places ascend, are inside (0, 1), and
    are fewer than the elements. A place `towards` which elements are graded is one of the ends.
    """
    ends = np.concatenate([[0.0], np.cumsum(graded_lengths(elements, ratio, towards))])
    ends[-1] = 1.0
    fixed = [*places] if isinstance(towards, str) else sorted({*places, towards})
    return moved_onto(ends, fixed)


def graded_lengths(elements: int, ratio: float, towards: str | float) -> Array:
    """Lengths (elements,) with sum 1 in geometric progression, longest : shortest = ratio.

    Parameters
    ----------
    elements : number of elements, at least 1; at least 2 for a place
    ratio : ratio of the longest length to the shortest. On both sides of a place, lengths grow by the same factor; the
        side with more elements has this ratio
    towards : place of the short elements: "start", "end", "both", "middle", or a fraction inside (0, 1)
    """
    if not isinstance(towards, str):
        return _lengths_about(elements, ratio, towards)
    step = np.arange(elements)
    if towards == "end":
        step = step[::-1]
    if towards in ("both", "middle"):
        step = np.minimum(step, step[::-1])
    if towards == "middle":
        step = step.max() - step
    lengths = ratio ** (step / max(step.max(), 1))
    return lengths / fsum(lengths)


def _lengths_about(elements: int, ratio: float, place: float) -> Array:
    """Lengths (elements,) that shrink towards a place; the two elements at the place have about the same length."""

    def sides(before: int) -> tuple[Array, Array]:
        growth = ratio ** (1 / max(before - 1, elements - before - 1, 1))
        left, right = growth ** np.arange(before)[::-1], growth ** np.arange(elements - before)
        return left * (place / fsum(left)), right * ((1 - place) / fsum(right))

    def mismatch(before: int) -> float:
        left, right = sides(before)
        return abs(log(left[-1] / right[0]))

    return np.concatenate(sides(min(range(1, elements), key=mismatch)))


def cubic_ends(elements: int, *, both: bool, shortest: float = 0.0) -> Array:
    """Element ends (elements + 1,) from 0 to 1 at the cubes of equal steps, dense at 0, or at both ends.

    Parameters
    ----------
    elements : number of elements, at least 1
    both : whether the ends are dense at 0 and at 1
    shortest : smallest length; if cubes give shorter lengths, a linear term is mixed in
    """
    step = np.arange(elements + 1) / elements
    if not both:
        return _cubed(step, elements, shortest)
    half = _cubed(2 * step[: elements // 2 + 1], elements / 2, 2 * shortest) / 2
    return np.concatenate([half, 1 - half[: (elements + 1) // 2][::-1]])


def _cubed(step: Array, count: float, shortest: float) -> Array:
    """(1 - e) s³ + e s for steps s, with the smallest e >= 0 for which the first length is long enough."""
    even = max(0.0, shortest - count**-3) / (1 / count - count**-3) if count > 1 else 0.0
    return (1 - even) * step**3 + even * step


def moved_onto(ends: Array, places: Sequence[float]) -> Array:
    """Move ascending element ends (m + 1,) so that some are exactly at given places, and the others in proportion.

    The first and the last end stay. Places ascend, are between them, and are fewer than m.
    """
    if not places:
        return ends
    last = len(ends) - 1
    chosen = [0, *(_nearest(ends, places) if len(places) < last - 1 else range(1, last)), last]
    onto = [ends[0], *places, ends[-1]]
    moved = [
        low + (ends[i:j] - ends[i]) * ((high - low) / (ends[j] - ends[i]))
        for (i, j), (low, high) in zip(pairwise(chosen), pairwise(onto), strict=True)
    ]
    return np.append(np.concatenate(moved), ends[-1])


def _nearest(ends: Array, places: Sequence[float]) -> list[int]:
    """Index of a different end for each place, in order, with the smallest sum of squared distances."""
    inner = np.arange(1, len(ends) - 1)
    total, before = np.zeros(len(inner)), []
    for number, place in enumerate(places):
        if number:  # the best end for the previous place among the earlier ends
            least = np.minimum.accumulate(total)
            cheapest = np.maximum.accumulate(np.where(total == least, inner, 0))
            before.append(np.append(0, cheapest[:-1]))
            total = np.append(np.inf, least[:-1])
        total = total + (ends[inner] - place) ** 2
    chosen = [int(inner[np.argmin(total)])]
    for earlier in reversed(before):
        chosen.append(int(earlier[chosen[-1] - 1]))
    return chosen[::-1]
