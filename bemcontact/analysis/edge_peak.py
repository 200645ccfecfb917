"""The largest of values along an edge that may grow without bound towards some of its places."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from bemcontact.arrays import Array, BoolArray

SAMPLES, STEPS = 17, 4
"""Places on an element among which the largest value is looked for, and how often between smaller bounds."""
DIP = 0.1
"""Part by which values fall from an infinite one on before they rise to a maximum of their own."""
NOT_TRUSTED = 3
"""Number of elements beside an infinite value whose values are too rough to show whether they grow towards it."""
ALIKE = 1e-9
"""Relative difference of values that is round-off."""


def largest_along(values: Callable[[Array], Array], infinite: BoolArray) -> tuple[float, float] | None:
    """Find the value of the largest magnitude along an edge of m elements, away from where values are infinite.

    Parameters
    ----------
    values : gives the values (k,) at places (k,) along the edge; element i is from i to i + 1
    infinite : (m + 1,) whether values are infinite at the ends of the elements

    Returns
    -------
    tuple or None
        The place and the value. None if values grow up to an infinite one from all places.
    """
    marks = np.unique(np.append(np.flatnonzero(infinite), [0, len(infinite) - 1]))
    found = [_largest_between(values, infinite, int(low), int(high)) for low, high in pairwise(marks)]
    there = [item for item in found if item is not None]
    return max(there, key=lambda item: abs(item[1]), default=None)


def _largest_between(
    values: Callable[[Array], Array], infinite: BoolArray, low: int, high: int
) -> tuple[float, float] | None:
    """As `largest_along`, between two places without an infinite value between them."""
    first, last = low + int(infinite[low]), high - int(infinite[high])
    if first >= last:
        return None
    at = (np.arange(first, last)[:, None] + np.linspace(0, 1, SAMPLES)).ravel()
    sampled = abs(values(np.clip(at, first, last)))
    there = np.full(len(at), True)
    if infinite[low]:
        there &= _apart(sampled)
    if infinite[high]:
        there &= _apart(sampled[::-1])[::-1]
    if not there.any():
        return None
    highest = np.flatnonzero(there & (sampled >= (1 - ALIKE) * sampled[there].max()))[0]
    place, width = at[highest], 1 / (SAMPLES - 1)
    best = place, sampled[highest]
    for _ in range(STEPS):
        near = np.linspace(max(first, place - width), min(last, place + width), 2 * SAMPLES - 1)
        close = values(near)
        place, width = near[np.argmax(abs(close))], near[1] - near[0]
        best = place, close[np.argmax(abs(close))]
    return float(best[0]), float(best[1])


def _apart(sampled: Array) -> BoolArray:
    """Which magnitudes are no part of a growth towards the start: they follow a dip, or all before are smaller."""
    begin, there = NOT_TRUSTED * SAMPLES, np.full(len(sampled), False)
    trusted, before = sampled[begin:], np.maximum.accumulate(sampled)[begin:]
    there[begin:] = trusted * (1 - DIP) > np.minimum.accumulate(trusted, axis=0)
    there[begin:] |= trusted >= (1 - ALIKE) * before
    return there
