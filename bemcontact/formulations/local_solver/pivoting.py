"""Which constraint leaves the working set (pricing), and which one a step meets first (ratio test)."""

from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.formulations.local_solver.progress import PARALLEL, STALLED, Progress
from bemcontact.formulations.local_solver.working_set import TEMPORARY, WorkingSet

INFINITY = float("inf")
FAINT = 1e-14
"""The same as `PARALLEL` on a long step: only rounding is below."""


class Block(NamedTuple):
    """The constraint that ends a step: its number, the side reached (-1 lower, +1 upper, 2 equality), and the step."""

    constraint: int
    side: int
    step: float


def nearest(
    progress: Progress, along: Array, length: float, held: BoolArray, working: WorkingSet | None = None
) -> Block | None:
    """The first constraint met, those held aside, by Harris' two passes; None if the direction meets none.

    The first pass finds the longest step at which nothing is violated beyond its tolerance; the second takes, among the
    constraints met until then, the one that is met most steeply (Harris, Math. Programming 5 (1973) 1-28). When the run
    has stalled: the lowest number among the ties. A constraint in the span of a working set is not met within it.
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


def _first(progress: Progress, along: Array, speed: Array, away: BoolArray) -> Block | None:
    """The first constraint met but for those that are left away."""
    statement, values = progress.statement, progress.values
    # the bound ahead has the quotient that is not negative
    steps = np.maximum((statement.upper - values) / along, (statement.lower - values) / along)
    steps[away] = INFINITY
    late = steps + progress.slack / speed
    furthest = late.item(late.argmin())
    if not furthest < INFINITY:  # nor is there one where the values have overflowed
        return None
    if progress.stalled <= STALLED:
        met = (steps <= furthest).nonzero()[0]
        constraint = met.item(speed[met].argmax())
    else:
        least = steps.item(steps.argmin())
        constraint = int((steps <= least + 1e-13 * max(1.0, least)).argmax())
    return Block(constraint, side_reached(progress, constraint, along), max(steps.item(constraint), 0.0))


def side_reached(progress: Progress, constraint: int, along: Array) -> int:
    """Which bound the movement reaches; 2 for an equality."""
    if progress.statement.equality[constraint]:
        return 2
    return -1 if along.item(constraint) < 0.0 else 1


def wrong_sign(working: WorkingSet, multipliers: Array, zero: float | Array, *, least_index: bool) -> int | None:
    """The place of the constraint to drop; None if all signs are right.

    Parameters
    ----------
    multipliers : (n + r,) array
        As from `WorkingSet.multipliers`.
    zero : float or (n + r,) array
        Size of a multiplier that counts as zero.
    least_index : bool
        Take the constraint of the lowest number among those with a wrong sign (Bland 1977).
    """
    wrong = working.signs * multipliers
    if working.temporary:
        n, ids = working.free.size, working.ids
        of_temporary = np.where(ids == TEMPORARY, np.inf, np.abs(multipliers[n:]))
        wrong[n:] = np.where(ids < 0, of_temporary, wrong[n:])
    if not isinstance(zero, float):
        wrong = np.where(wrong > zero, wrong, -np.inf)
        zero = 0.0
    place = int(wrong.argmax())
    if wrong.item(place) <= zero:
        return None
    if least_index:
        return int(np.where(wrong > zero, working.numbers, working.held.size).argmin())
    return place
