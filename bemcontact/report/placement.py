"""Where a label is least in the way."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array


class Box(NamedTuple):
    """A rectangle on the page, in the page's unit of length."""

    left: float
    bottom: float
    right: float
    top: float


def centred(center: Array, size: tuple[float, float]) -> Box:
    """Return the box of this size (width, height) around a centre (2,)."""
    (x, y), (width, height) = center, size
    return Box(x - width / 2, y - height / 2, x + width / 2, y + height / 2)


def overlap(a: Box, b: Box) -> float:
    """Area that two boxes share."""
    width = min(a.right, b.right) - max(a.left, b.left)
    height = min(a.top, b.top) - max(a.bottom, b.bottom)
    return max(width, 0.0) * max(height, 0.0)


def crowd(box: Box, taken: Sequence[Box], ink: Array) -> float:
    """Say how much is covered: the share of the box that others have, plus one for each drawn point (k, 2) in it."""
    area = (box.right - box.left) * (box.top - box.bottom)
    inside = (ink > (box.left, box.bottom)) & (ink < (box.right, box.top))
    return 10 * sum(overlap(box, other) for other in taken) / area + float(inside.all(axis=1).sum())


def least_crowded(centers: Array, size: tuple[float, float], taken: Sequence[Box], ink: Array) -> int:
    """Choose among places for a label.

    Parameters
    ----------
    centers : (c, 2) places, the preferred ones first
    size : width and height of the label
    taken : boxes of other labels
    ink : (k, 2) points of what is drawn

    Returns
    -------
    int
        Index of the first place of those that cover least.
    """
    return int(np.argmin([crowd(centred(center, size), taken, ink) for center in centers]))
