"""Places where the largest pressure acts: several if it is equal within its error, as on both sides of a symmetry."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from bemcontact.arrays import Array, IntArray
from bemcontact.report.formatting import JsonObject

LEVEL = 1e-3
"""Difference from the peak pressure, over that, below which a point counts as one at the peak, whatever its error."""
PRESSED = 1e-9
"""Pressure over the peak above which it counts."""


def level_zones(record: JsonObject, error: float) -> list[str]:
    """Zones with the largest pressure, within an error, at several points and at all that are pressed."""
    pressure, zones, found = np.array(record["pressure"]), np.array(record["zone"]), list[str]()
    peak = pressure.max(initial=0.0)
    for zone in dict.fromkeys(record["zone"]):
        inside = pressure[zones == zone]
        pressed = inside[inside > PRESSED * peak]
        level = len(pressed) > 1 and pressed.min() >= (1 - LEVEL) * pressed.max()
        if level and pressed.max() >= (1 - max(error, LEVEL)) * peak:
            found.append(zone)
    return found


def equal_peaks(record: JsonObject, error: float) -> list[int]:
    """Contact points of the largest pressure and of those that are equal to it within an error, one for each hill.

    Between two hills the pressure falls by more than twice the error.
    """
    pressure, nodes = np.array(record["pressure"]), np.array(record["nodes"])
    error, peak, found = max(error, LEVEL), pressure.max(initial=0.0), list[int]()
    for run in dict.fromkeys(record["run"]):
        own = np.flatnonzero(np.array(record["run"]) == run)
        own = own[np.argsort(np.array(record["arc_position"])[own], kind="stable")]
        if _closes(nodes[own], np.array(record["tributary_lengths"])[own]):
            own = np.roll(own, -int(np.argmin(pressure[own])))
        found += _hills(pressure, own, (1 - error) * peak, (1 - 2 * error) * peak)
    places = {tuple(nodes[i]): i for i in reversed(found)}  # a corner has a point for each zone
    return sorted(places.values())


def _closes(nodes: Array, lengths: Array) -> bool:
    """Whether the first and the last of some points (n, 2) are neighbors, by the lengths (n,) that belong to them."""
    return len(nodes) > 2 and bool(np.hypot(*(nodes[0] - nodes[-1])) <= lengths[0] + lengths[-1])


def _hills(pressure: Array, own: IntArray, high: float, low: float) -> Iterator[int]:
    """The highest point of each hill above `high`; between two of them lies a point below `low`."""
    valleys = np.flatnonzero(pressure[own] < low)
    for begin, end in pairwise([-1, *valleys.tolist(), len(own)]):
        if end > begin + 1:
            top = own[begin + 1 : end][np.argmax(pressure[own[begin + 1 : end]])]
            if pressure[top] >= high:
                yield int(top)
