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
    progress: SearchState,
    along: Array,
    length: float,
    held: BoolArray,
    working: WorkingSet | None = None,
    end: float = INFINITY,
) -> BlockingConstraint | None:
    """The first constraint met by the direction and not held, by Harris' two passes; None if there is none.

    The first pass finds the longest step at which nothing is violated beyond its tolerance; the second takes, among the
    constraints met until then, the one that is met most steeply (Harris, Math. Programming 5 (1973) 1-28). A run that
    has stalled takes the lowest number among the ties. A constraint in the span of a working set is not met within it.
    A step that ends at `end` in any case is no longer than that.
    """
    statement, values = progress.statement, progress.values
    # the bound ahead has the quotient that is not negative
    steps = np.maximum((statement.upper - values) / along, (statement.lower - values) / along)
    steps[held] = INFINITY
    block = _first(progress, along, steps, PARALLEL * length)
    if min(end, INFINITY if block is None else block.step) * length > progress.long:
        speed = np.abs(along)
        slow = (speed > FAINT * length) & (speed <= PARALLEL * length)
        if np.count_nonzero(slow > held):
            block = _first(progress, along, steps, FAINT * length)
            while working is not None and block is not None and working.spans(block.constraint):
                steps[block.constraint] = INFINITY  # what moves it is rounding
                block = _first(progress, along, steps, FAINT * length)
    return block


def _first(progress: SearchState, along: Array, steps: Array, faint: float) -> BlockingConstraint | None:
    """The first constraint met, by the `steps` to each (n + m,), of those of which more than `faint` moves."""
    constraint = int(steps.argmin())
    stalled = progress.stalled > STALLED
    if stalled or abs(along.item(constraint)) <= faint:
        steps = np.where(np.abs(along) <= faint, INFINITY, steps)
        constraint = int(steps.argmin())
    least = steps.item(constraint)
    if not least < INFINITY:  # nor is there one where the values have overflowed
        return None
    if stalled:
        constraint = int((steps <= least + 1e-13 * max(1.0, least)).argmax())
    else:
        late = least + progress.slack.item(constraint) / abs(along.item(constraint))
        met = (steps <= late).nonzero()[0]
        if met.size > 1:
            speed = np.abs(along[met])
            speed[speed <= faint] = 0.0  # which is met at no time
            near = steps[met]
            late = near + progress.slack[met] / speed
            speed[near > late.item(late.argmin())] = 0.0
            constraint = met.item(speed.argmax())
    return BlockingConstraint(constraint, side_reached(progress, constraint, along), max(steps.item(constraint), 0.0))


def side_reached(progress: SearchState, constraint: int, along: Array) -> int:
    """Bound that the movement reaches: -1, +1, or 2 for an equality."""
    if progress.statement.equality.item(constraint):
        return 2
    return -1 if along.item(constraint) < 0.0 else 1
