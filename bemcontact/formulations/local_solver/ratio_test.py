"""The ratio test: the constraint that ends a step and enters the working set."""

from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.formulations.local_solver.progress import PARALLEL, STALLED, SearchState
from bemcontact.formulations.local_solver.statement import INFINITY
from bemcontact.formulations.local_solver.working_set import WorkingSet

FAINT = 1e-14
"""Limit, in place of `PARALLEL`, on a long step."""


class BlockingConstraint(NamedTuple):
    """The constraint that ends a step: its number, the side reached (-1 lower, +1 upper, 2 equality), and the step."""

    constraint: int
    side: int
    step: float


def nearest(
    progress: SearchState, along: Array, length: float, held: BoolArray, working: WorkingSet | None = None
) -> BlockingConstraint | None:
    """The first constraint met by the direction and not held, by Harris' two passes; None if there is none.

    The first pass finds the longest step at which nothing is violated beyond its tolerance; the second takes, among the
    constraints met until then, the one that is met most steeply (Harris, Math. Programming 5 (1973) 1-28). A run that
    has stalled takes the lowest number among the ties. A constraint in the span of a working set is not met within it.
    """
    speed = np.abs(along)
    away = held | (speed <= PARALLEL * length)
    block = _first(progress, along, speed, away)
    if block is None or block.step * length > progress.long:
        nearly_all = held | (speed <= FAINT * length)
        if np.count_nonzero(nearly_all) < np.count_nonzero(away):
            block = _first(progress, along, speed, nearly_all)
            while working is not None and block is not None and working.spans(block.constraint):
                nearly_all[block.constraint] = True  # what moves it is rounding
                block = _first(progress, along, speed, nearly_all)
    return block


def _first(progress: SearchState, along: Array, speed: Array, away: BoolArray) -> BlockingConstraint | None:
    """The first constraint met by the direction and not marked in `away` (n + m,)."""
    statement, values = progress.statement, progress.values
    # the bound ahead has the quotient that is not negative
    steps = np.maximum((statement.upper - values) / along, (statement.lower - values) / along)
    steps[away] = INFINITY
    constraint = int(steps.argmin())
    least = steps.item(constraint)
    if not least < INFINITY:  # nor is there one where the values have overflowed
        return None
    if progress.stalled > STALLED:
        constraint = int((steps <= least + 1e-13 * max(1.0, least)).argmax())
    else:
        late = least + progress.slack.item(constraint) / speed.item(constraint)
        met = (steps <= late).nonzero()[0]
        if met.size > 1:
            met = met[steps[met] <= (steps[met] + progress.slack[met] / speed[met]).min()]
            constraint = met.item(speed[met].argmax())
    return BlockingConstraint(constraint, side_reached(progress, constraint, along), max(steps.item(constraint), 0.0))


def side_reached(progress: SearchState, constraint: int, along: Array) -> int:
    """Bound that the movement reaches: -1, +1, or 2 for an equality."""
    if progress.statement.equality.item(constraint):
        return 2
    return -1 if along.item(constraint) < 0.0 else 1
