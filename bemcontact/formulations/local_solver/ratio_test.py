"""How far a direction leads to the next constraint."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bemcontact.formulations.local_solver.progress import Progress

Array = NDArray[np.float64]

PARALLEL = 1e-10
"""A normal whose product with the unit direction is below this is parallel to the constraint."""


@dataclass(frozen=True, kw_only=True)
class Block:
    """The constraint that ends a step: its number, the side reached (-1 lower, +1 upper, 2 equality), and the step."""

    constraint: int
    side: int
    step: float


def nearest(progress: Progress, along: Array, length: float, eligible: NDArray[np.bool_]) -> Block | None:
    """The first constraint met among the eligible, by Harris' two passes; None if the direction meets none.

    The first pass finds the longest step at which nothing is violated beyond its tolerance; the second takes, among the
    constraints met until then, the one that is met most steeply (Harris, Math. Programming 5 (1973) 1-28). When the run
    has stalled: the lowest number among the ties.
    """
    statement = progress.statement
    towards = np.where(along < 0.0, statement.lower, statement.upper)
    met = np.flatnonzero(eligible & (np.abs(along) > PARALLEL * length) & np.isfinite(towards))
    if met.size == 0:
        return None
    speed = np.abs(along[met])
    room = np.abs(towards[met] - progress.values[met])
    room[(towards[met] - progress.values[met]) * along[met] < 0.0] = 0.0
    ratios = room / speed
    if progress.least_index:
        chosen = int(np.flatnonzero(ratios <= ratios.min() + 1e-13 * max(1.0, ratios.min()))[0])
    else:
        candidates = ratios <= ((room + progress.slack[met]) / speed).min()
        chosen = int(np.argmax(np.where(candidates, speed, -1.0)))
    constraint = int(met[chosen])
    return Block(constraint=constraint, side=side_reached(progress, constraint, along), step=float(ratios[chosen]))


def side_reached(progress: Progress, constraint: int, along: Array) -> int:
    """Which bound the movement reaches; 2 for an equality."""
    if progress.statement.lower[constraint] == progress.statement.upper[constraint]:
        return 2
    return -1 if along[constraint] < 0.0 else 1
