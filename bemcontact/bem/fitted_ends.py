"""Element ends of a contact zone that crowd cubically towards the ends of contact."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, radians

import numpy as np
from numpy.typing import NDArray

from bemcontact.bem.zone_runs import SAME, ZoneRun
from bemcontact.problem.element_ends import cubic_ends, moved_onto

Array = NDArray[np.float64]

CONTACT_SHARE = 2.0
"""Elements on the side of a contact edge that is in contact, to those on the open side, where this is no longer."""
SHORTEST = 5e-4
"""Least element, over the shortest side in contact: shorter ones gain little, and cost digits of the certificate."""
LEAST = 2
"""Elements on each side of a contact edge."""
CLOSE = 1e-2
"""Distance from the end of a run, or from a joint, over its mean element length, that is not resolved by elements."""
LONGEST, TURNING = 6.0, radians(30)
"""Length over the mean length in the run, and turning, that elements keep below where there are enough of them."""
GENTLE = 4.0
"""Ratio of the lengths of neighbouring elements where a run ends that is avoided if it can be."""


@dataclass(frozen=True, kw_only=True)
class Touched:
    """A stretch of contact on a run.

    Parameters
    ----------
    start, end : positions [L]; on a closed run the end may lie beyond its length
    start_free, end_free : whether contact ends there by itself, and not at the end of the run or at a corner
    """

    start: float
    end: float
    start_free: bool
    end_free: bool


@dataclass(frozen=True, kw_only=True)
class _Part:
    """What lies between two marks: ends of contact, of the run, corners; free ones are graded to."""

    low: float
    high: float
    touched: bool
    low_free: bool
    high_free: bool
    share: float = 0.0
    count: int = 0

    @property
    def width(self) -> float:
        return self.high - self.low

    @property
    def sides(self) -> int:
        """Number of contact edges that it is graded to."""
        return self.low_free + self.high_free

    @property
    def reach(self) -> float:
        """Length that is graded to one contact edge."""
        return self.width / max(self.sides, 1)


def resolved(run: ZoneRun, touched: Sequence[Touched]) -> tuple[Touched, ...]:
    """Move contact edges that are all but at a joint, or at an end of the run, onto it."""
    close = CLOSE * run.length / (len(run.ends) - 1)

    def settle(position: float, free: bool) -> tuple[float, bool]:
        turns = run.length * np.floor(position / run.length) if run.closed else 0.0
        joint = float(run.joints[np.argmin(np.abs(run.joints - (position - turns)))])
        if abs(joint - (position - turns)) > close:
            return position, free
        return joint + turns, free and (run.closed or 0.0 < joint < run.length)

    moved = []
    for item in touched:
        (start, start_free), (end, end_free) = settle(item.start, item.start_free), settle(item.end, item.end_free)
        if end > start:
            moved.append(Touched(start=start, end=end, start_free=start_free, end_free=end_free))
    return tuple(moved)


def fitted_ends(run: ZoneRun, touched: Sequence[Touched]) -> Array | None:
    """Positions of element ends, as many as there are, at a ± b (i/n)³ around each end of contact a.

    b is the distance to the next mark: an end of the run, a corner at which contact ends, or the middle between two
    ends of contact. Elements are shared out between corners where contact ends, so that each side of an end of contact
    gets two in contact for one outside. Joints of edges stay element ends, the nearest being moved onto them.

    Parameters
    ----------
    run : with its present element ends
    touched : stretches of contact, `resolved`, in order, at least one

    Returns
    -------
    (m + 1,) [L], or None if there are too few elements
    """
    parts = _parts(run, touched)
    ends = [np.array([parts[0].low])]
    for block in _blocks(parts):
        counted = _counted(run, _shared(block))
        if counted is None:
            return None
        shortest = SHORTEST * min((part.reach for part in counted if part.touched and part.sides), default=0.0)
        ends += [_graded(run, part, shortest)[1:] for part in counted]
    positions = np.concatenate(ends)
    if not run.closed:
        return positions
    wrapped = np.sort(np.mod(positions[:-1], run.length))
    wrapped = wrapped[(wrapped > SAME * run.length) & (wrapped < (1 - SAME) * run.length)]
    return np.concatenate([[0.0], wrapped, [run.length]])


def _parts(run: ZoneRun, touched: Sequence[Touched]) -> list[_Part]:
    """Contact and what is open between, in order; a closed run all round, from where nothing is graded to if it can."""
    marks = [mark for item in touched for mark in ((item.start, item.start_free), (item.end, item.end_free))]
    begin = False
    if run.closed:
        first = next((number for number, (_, free) in enumerate(marks) if not free), 0)
        begin = first % 2 == 0
        marks = [*marks[first:], *((position + run.length, free) for position, free in marks[: first + 1])]
        turns = run.length * np.floor(marks[0][0] / run.length)
        marks = [(position - turns, free) for position, free in marks]
    else:
        marks = [(0.0, False), *marks, (run.length, False)]
    return [
        _Part(low=low, high=high, touched=(number % 2 == 0) == begin, low_free=low_free, high_free=high_free)
        for number, ((low, low_free), (high, high_free)) in enumerate(pairwise(marks))
        if high - low > SAME * run.length
    ]


def _blocks(parts: Sequence[_Part]) -> list[list[_Part]]:
    """Parts between marks that are not graded to, which share their elements."""
    blocks: list[list[_Part]] = []
    for part in parts:
        if blocks and part.low_free:
            blocks[-1].append(part)
        else:
            blocks.append([part])
    return blocks


def _shared(block: Sequence[_Part]) -> list[_Part]:
    """Give each part its share of the elements.

    That of an open side grows with the cube root of its length over that of the side in contact, so that cubic grading
    makes its shortest element at most `CONTACT_SHARE`³ times as long as that across the contact edge: the compliance
    of collocation loses its definiteness where elements of very different lengths meet under pressure.
    """
    shares = [CONTACT_SHARE * part.sides if part.touched else 0.0 for part in block]
    for (i, one), (j, other) in pairwise(enumerate(block)):
        (k, side), beside = ((i, one), other) if other.touched else ((j, other), one)
        shares[k] += max(1.0, (side.reach / beside.reach) ** (1 / 3))
    return [replace(part, share=share) for part, share in zip(block, shares, strict=True)]


def _counted(run: ZoneRun, block: Sequence[_Part]) -> list[_Part] | None:
    """Share the elements of a block out, each to the part that has the fewest for its share; None if they are too few.

    Parts that are alike, as by symmetry, get one each or none.
    """
    if not block[0].sides:
        return [*block]
    whole = block[0].low_free  # all round a closed run
    left = len(run.ends) - 1 if whole else 1 + len(_inside(run.ends, run, block[0].low, block[-1].high))
    least = [max(LEAST * part.sides, 1 + len(_inside(run.joints, run, part.low, part.high))) for part in block]
    for slack in (1.0, 1.5, 2.0, np.inf):
        counts = [max(count, _fine_enough(run, part, slack)) for count, part in zip(least, block, strict=True)]
        if sum(counts) <= left:
            break
    else:
        return None
    left -= sum(counts)
    rivals = list(range(len(block)))
    while left:
        claim = [block[i].share / (counts[i] + 0.5) * (1 + 1e-6 * block[i].width / run.length) for i in rivals]
        first = [i for i, own in zip(rivals, claim, strict=True) if own >= max(claim) * (1 - 1e-12)]
        if len(first) > left and len(rivals) > len(first):
            rivals = [i for i in rivals if i not in first]
            continue
        for i in first[:left]:
            counts[i] += 1
        left -= len(first[:left])
    return [replace(part, count=count) for part, count in zip(block, counts, strict=True)]


def _fine_enough(run: ZoneRun, part: _Part, slack: float) -> int:
    """Number of elements of which the longest, 3 b/n of a side, keeps below so many times `LONGEST` and `TURNING`."""
    bend = max(edge.turning_per_length for edge in run.edges)
    longest = min(LONGEST * run.length / (len(run.ends) - 1), TURNING / bend if bend > 0 else np.inf)
    return part.sides * ceil(3 * part.reach / (slack * longest))


def _graded(run: ZoneRun, part: _Part, shortest: float) -> Array:
    """Element ends of a part, from its low to its high end; as they are where contact ends on neither side."""
    low, high = part.low, part.high
    if not part.sides:
        return np.array([low, *_inside(run.ends, run, low, high), high])
    ends = cubic_ends(part.count, both=part.sides == 2, shortest=shortest / part.width)
    if part.low_free:
        if part.high == run.length and not part.high_free:
            ends = _gentle(ends, run.neighbours[1] / part.width)
        positions = low + part.width * ends
    else:
        if part.low == 0.0 and not run.closed:
            ends = _gentle(ends, run.neighbours[0] / part.width)
        positions = high - part.width * ends[::-1]
    positions[0], positions[-1] = low, high
    return moved_onto(positions, _inside(run.joints, run, low, high))


def _gentle(ends: Array, neighbour: float) -> Array:
    """Shorten the last elements if the next one beyond is much shorter, at the cost of the others.

    Where these would have to become twice as long, nothing is changed: the zone has too few elements for it.
    """
    lengths = np.diff(ends)
    limits = neighbour * GENTLE ** np.arange(len(lengths), 0, -1.0)
    long = np.zeros(len(lengths), bool)
    factor = 1.0
    while (beyond := (lengths * factor > limits) & ~long).any():
        long |= beyond
        room = 1.0 - limits[long].sum()
        factor = room / lengths[~long].sum() if not long.all() else np.inf
        if not 0 < factor <= 2:
            return ends
    eased = np.concatenate([[0.0], np.cumsum(np.where(long, limits, lengths * factor))])
    eased[-1] = 1.0
    return eased


def _inside(positions: Array, run: ZoneRun, low: float, high: float) -> list[float]:
    """Positions between two others, also beyond the seam of a closed run."""
    all_round = np.concatenate([positions, positions[1:] + run.length]) if run.closed else positions
    same = SAME * run.length
    return all_round[(all_round > low + same) & (all_round < high - same)].tolist()
