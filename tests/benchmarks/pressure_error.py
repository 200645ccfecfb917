"""Pressures along a contact zone as functions of a coordinate x, and their difference in the L2 norm."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PARTS = 8
"""Of each piece between two breaks, where pressures may fall to zero like a root."""
GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(8)


@dataclass(frozen=True, kw_only=True, eq=False)
class Pressure:
    """A pressure that is smooth between its breaks and zero outside of them.

    Parameters
    ----------
    breaks : (k,) [L], ascending
    value : of coordinates (q,) [L] between the breaks, (q,) [p]
    """

    breaks: Array
    value: Callable[[Array], Array]

    def __call__(self, x: Array) -> Array:
        """Pressure (q,) [p]."""
        inside = (x >= self.breaks[0]) & (x <= self.breaks[-1])
        values = np.zeros_like(x)
        values[inside] = self.value(x[inside])
        return values

    def cut(self, end: float) -> "Pressure":
        """The same up to an end of contact, nowhere below zero, and zero beyond."""
        inner = self.breaks[self.breaks < end]
        return Pressure(
            breaks=np.append(inner, min(end, self.breaks[-1])), value=lambda x: np.maximum(self.value(x), 0)
        )


def by_elements(x: Array, nodal: Array) -> Pressure:
    """Pressure from values (m, 3) at the nodes x (m, 3) of quadratic elements in line; x and p share the shapes."""
    start, middle, end = x.T
    bend, half = (start + end) / 2 - middle, (end - start) / 2

    def value(at: Array) -> Array:
        i = np.clip(np.searchsorted(start, at, side="right") - 1, 0, len(x) - 1)
        a, b, c = bend[i], half[i], middle[i] - at
        xi = -2 * c / (b + np.sqrt(np.maximum(b * b - 4 * a * c, 0)))
        shapes = np.column_stack([xi * (xi - 1) / 2, 1 - xi * xi, xi * (xi + 1) / 2])
        return np.sum(shapes * nodal[i], axis=1)

    return Pressure(breaks=np.append(start, end[-1]), value=value)


def relative_error(pressure: Pressure, right: Pressure, rate: Callable[[Array], Array]) -> float:
    """|pressure - right| / |right| in the L2 norm over the arc length, whose rate ds/dx is a function of x."""
    breaks = np.unique(np.concatenate([pressure.breaks, right.breaks]))
    parts = np.arange(PARTS) / PARTS
    starts = np.append((breaks[:-1, None] + np.diff(breaks)[:, None] * parts).ravel(), breaks[-1])
    half = np.diff(starts)[:, None] / 2
    x = (starts[:-1, None] + half * (1 + GAUSS)).ravel()
    weights = (half * WEIGHTS).ravel() * rate(x)
    off, size = weights @ (pressure(x) - right(x)) ** 2, weights @ right(x) ** 2
    return float(np.sqrt(off / size))
