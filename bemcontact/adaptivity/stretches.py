"""The stretches of contact on a run of a zone, as a mesh is to be fitted to them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from bemcontact.adaptivity.fitted_ends import Touched
from bemcontact.adaptivity.zone_runs import SAME, ZoneRun
from bemcontact.arrays import Array, BoolArray
from bemcontact.assessment.footprint import ContactInterval
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution

POINTS_OF_ELEMENT = 3


@dataclass(frozen=True, kw_only=True)
class Stretch:
    """A stretch of contact.

    Parameters
    ----------
    touched : its ends on the run
    narrow : whether fewer points touch than one element has, which does not tell where contact ends
    """

    touched: Touched
    narrow: bool


def stretches(
    run: ZoneRun, contact: CondensedContact, solution: ContactSolution, intervals: Sequence[ContactInterval]
) -> Iterator[Stretch]:
    """List the stretches of contact on a run.

    An end is free unless contact goes on to the last point of the run or to a corner. A single point stands for a
    stretch that reaches half-way to the points beside it, so that a mesh fitted to that shows more of them.

    Parameters
    ----------
    run : on the mesh of the condensed problem
    contact, solution : the condensed problem and its solution
    intervals : of contact, of all runs
    """
    arcs, touching = _points(run, contact, solution)
    same = SAME * run.arc[-1]
    for interval in intervals:
        if interval.run != run.number or (run.closed and interval.end_arc - interval.start_arc >= run.arc[-1] - same):
            continue
        inside = np.flatnonzero(touching & (arcs >= interval.start_arc - same) & (arcs <= interval.end_arc + same))
        first, last = int(inside[0]), int(inside[-1])
        start_arc, end_arc = interval.start_arc, interval.end_arc
        if first == last:
            start_arc = min(start_arc, (arcs[first] + arcs[max(first - 1, 0)]) / 2)
            end_arc = max(end_arc, (arcs[last] + arcs[min(last + 1, len(arcs) - 1)]) / 2)
        corners = first < last  # a single point at a corner says nothing of either side of it
        start, start_free = _end(run, start_arc, arcs[first], 0.0 if first == 0 else None, corners)
        end, end_free = _end(run, end_arc, arcs[last], run.length if last == len(arcs) - 1 else None, corners)
        touched = Touched(start=start, end=end, start_free=start_free, end_free=end_free)
        yield Stretch(touched=touched, narrow=last - first < POINTS_OF_ELEMENT - 1)


def _points(run: ZoneRun, contact: CondensedContact, solution: ContactSolution) -> tuple[Array, BoolArray]:
    """Arc lengths of the points of a run in order, and which of them touch; of a closed run all several times over."""
    own = contact.points_of_run(run.number)
    touching = contact.touching(solution.pressure, solution.displacement) & (solution.pressure > 0)
    arcs, touching = contact.arc_position[own], touching[own]
    if not run.closed:
        return arcs, touching
    turns = run.arc[-1] * np.array([-1, 0, 1, 2])
    return (turns[:, None] + arcs).ravel(), np.tile(touching, len(turns))


def _end(run: ZoneRun, arc: float, outermost: float, limit: float | None, at_corners: bool) -> tuple[float, bool]:
    """Position of an end of contact, and whether it is free, from the outermost point that touches."""
    if limit is not None and not run.closed:
        return limit, False
    position = run.position(outermost)
    corners = run.joints[run.corner]
    turned = position % run.length if run.closed else position
    if at_corners and corners.size and np.abs(corners - turned).min() <= SAME * 100 * run.length:
        return position, False
    return run.position(arc), True
