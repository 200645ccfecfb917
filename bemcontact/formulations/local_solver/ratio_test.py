"""How far a direction leads to the next constraint."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bemcontact.formulations.local_solver.progress import Progress
from bemcontact.formulations.local_solver.statement import Array

PARALLEL = 1e-10
"""A normal whose product with the unit direction is below this is parallel to the constraint."""


class Block(NamedTuple):
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
    statement, values = progress.statement, progress.values
    speed = np.abs(along)
    met = eligible & (speed > PARALLEL * length)
    room = np.where(along < 0.0, values - statement.lower, statement.upper - values)
    ratios = np.where(met, (room + progress.slack) / np.maximum(speed, PARALLEL * length), np.inf)
    furthest = ratios[ratios.argmin()]
    if furthest == np.inf:
        return None
    if progress.least_index:
        constraint = _lowest_of_the_first(room, speed, met)
    else:
        constraint = int(np.where(met & (room <= furthest * speed), speed, -1.0).argmax())
    step = max(float(room[constraint]), 0.0) / float(speed[constraint])
    return Block(constraint=constraint, side=side_reached(progress, constraint, along), step=step)


def _lowest_of_the_first(room: Array, speed: Array, met: NDArray[np.bool_]) -> int:
    """The lowest number among the constraints that are met first."""
    among = np.flatnonzero(met)
    ratios = np.maximum(room[among], 0.0) / speed[among]
    least = float(ratios.min())
    return int(among[np.flatnonzero(ratios <= least + 1e-13 * max(1.0, least))[0]])


def side_reached(progress: Progress, constraint: int, along: Array) -> int:
    """Which bound the movement reaches; 2 for an equality."""
    if progress.statement.lower[constraint] == progress.statement.upper[constraint]:
        return 2
    return -1 if along[constraint] < 0.0 else 1
