"""Element ends of a contact zone that crowd cubically towards the ends of contact."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil

import numpy as np

from bemcontact.adaptivity.zone_runs import SAME, Stretch, ZoneRun
from bemcontact.arrays import Array
from bemcontact.problem.curves import cubic_ends, moved_onto

CONTACT_SHARE = 2.0
"""Ratio of the elements on the contact side of a contact edge to those on the open side, if this is no longer."""
SHORTEST = 5e-4
"""Least element over the shortest side in contact: shorter ones gain little and cost digits of the certificate."""
SHORTEST_OF_RUN = 1e-6
"""Least element over the length of the run: element ends that are nearer to each other are refused."""
LEAST_IN_CONTACT, LEAST_OPEN = 4, 3
"""Least numbers of elements beside a contact edge: with three in contact, its place alternates between passes."""
CLOSE = 1e-2
"""Distance from the end of a run, or from a joint, that is not resolved by elements, over the mean length of these, or
over the contact that ends there if it is shorter."""
GENTLE = 2.0
"""Length of the element beside a run over that of the one at its end, up to which it is left."""
GROWTH = 1.5
"""Length of an element over that of its neighbor nearer to an end of contact that counts as grading towards it."""


@dataclass(frozen=True, kw_only=True)
class _Part:
    """A part between two marks (ends of contact, ends of the run, corners); elements are graded towards free ones."""

    low: float
    high: float
    in_contact: bool
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


def resolved(run: ZoneRun, stretches: Sequence[Stretch]) -> tuple[Stretch, ...]:
    """Move contact edges that are very near to a joint, or to an end of the run, onto it."""

    def settle(position: float, free: bool, width: float) -> tuple[float, bool]:
        close = CLOSE * min(run.length / (len(run.ends) - 1), width)
        turns = run.length * np.floor(position / run.length) if run.closed else 0.0
        joint = float(run.joints[np.argmin(np.abs(run.joints - (position - turns)))])
        if abs(joint - (position - turns)) > close:
            return position, free
        return joint + turns, free and (run.closed or 0.0 < joint < run.length)

    moved = []
    for item in stretches:
        width = item.end - item.start
        start, start_free = settle(item.start, item.start_free, width)
        end, end_free = settle(item.end, item.end_free, width)
        if end > start:
            moved.append(replace(item, start=start, end=end, start_free=start_free, end_free=end_free))
    return tuple(moved)


def fitted_ends(run: ZoneRun, stretches: Sequence[Stretch]) -> Array:
    """Positions (m + 1,) [L] of element ends, at a ± b (i/n)³ around each end of contact a.

    b is the distance to the next mark: an end of the run, a corner at which contact ends, or the middle between two
    ends of contact. The stretches are `resolved`, in order, at least one. The number of elements is the stated one: two
    in contact for one outside, or more where the open side is longer. Some are added if there would be fewer than
    `LEAST_IN_CONTACT` and `LEAST_OPEN` beside an end of contact. Cubic elements grow up to three times as long as equal
    ones. Where they would be longer than stated, elements are as stated, so that a run gets about half as many again.
    Joints of edges stay element ends: the nearest ends are moved onto them.
    """
    blocks = _blocks(_parts(run, stretches))
    pieces = _evened([_divided(run, block) for block in blocks], around=run.closed and not blocks[0][0].low_free)
    positions = np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])
    if not run.closed:
        return positions
    wrapped = np.sort(np.mod(positions[:-1], run.length))
    wrapped = wrapped[(wrapped > SAME * run.length) & (wrapped < (1 - SAME) * run.length)]
    return np.concatenate([[0.0], wrapped, [run.length]])


def _divided(run: ZoneRun, block: Sequence[_Part]) -> Array:
    """Element ends of the parts of a block."""
    counted = _counted(run, _shared(block))
    narrowest = min((part.reach for part in counted if part.in_contact and part.sides), default=0.0)
    shortest = max(SHORTEST * narrowest, SHORTEST_OF_RUN * run.length)
    ends = [_graded(run, part, shortest) for part in counted]
    return np.concatenate([ends[0], *(positions[1:] for positions in ends[1:])])


def _evened(pieces: Sequence[Array], *, around: bool) -> list[Array]:
    """Halve long elements that meet short ones across a corner at which contact ends; around, the last the first."""
    evened = [*pieces]
    for i, j in pairwise([*range(len(pieces)), *([0] * around)]):
        before, after = np.diff(evened[i])[-1], np.diff(evened[j])[0]
        evened[i] = halved(evened[i], after, -1)
        evened[j] = halved(evened[j], before, 0)
    return evened


def movement(run: ZoneRun, stretches: Sequence[Stretch], fitted_to: Sequence[Stretch] | None) -> float | None:
    """Largest distance of a free end of contact from where the mesh is graded to, over the shorter element there.

    The mesh is graded to the ends of the stretches `fitted_to`. If these are None, it is graded to an element end from
    which the lengths of elements grow by `GROWTH` or more to either side. None if the mesh is graded to another number
    of ends.
    """
    ends = _free_ends(stretches)
    if fitted_to is None:
        marks = [mark for end in ends if (mark := _crowded(run, end)) is not None]
    else:
        marks = _free_ends(fitted_to)
    if len(marks) != len(ends):
        return None
    largest = 0.0
    for end, mark in zip(ends, marks, strict=True):
        _, lengths = _beside(run, mark)
        largest = max(largest, float(abs(_along(run, mark, end)) / min(lengths[1:3])))
    return largest


def halved(ends: Array, neighbor: float, at: int) -> Array:
    """Halve the first (at = 0) or last (-1) element until it is at most `GENTLE` times as long as its neighbor beyond.

    The element ends (m + 1,) ascend; the result has k more of them.
    """
    ends = ends if at == 0 else ends[::-1]
    while abs(ends[1] - ends[0]) > GENTLE * neighbor * (1 + 1e-9):
        ends = np.insert(ends, 1, (ends[0] + ends[1]) / 2)
    return ends if at == 0 else ends[::-1]


def half_way(run: ZoneRun, one: Sequence[Stretch], other: Sequence[Stretch]) -> tuple[Stretch, ...]:
    """Mean of two lists of stretches; the second list if they differ in number or in the kind of their ends."""
    kinds = [[(item.start_free, item.end_free) for item in lot] for lot in (one, other)]
    if kinds[0] != kinds[1]:
        return tuple(other)
    return tuple(
        replace(b, start=b.start + _along(run, b.start, a.start) / 2, end=b.end + _along(run, b.end, a.end) / 2)
        for a, b in zip(one, other, strict=True)
    )


def _free_ends(stretches: Sequence[Stretch]) -> list[float]:
    """Positions of the free ends of contact."""
    marks = [mark for item in stretches for mark in ((item.start, item.start_free), (item.end, item.end_free))]
    return [position for position, free in marks if free]


def _along(run: ZoneRun, start: float, end: Array | float) -> Array:
    """Distance from one position to others, the shorter way round if the run is closed."""
    way = np.asarray(end) - start
    return way - run.length * np.round(way / run.length) if run.closed else way


def _beside(run: ZoneRun, position: float) -> tuple[float, Array]:
    """The nearest element end, and the lengths of the two elements before and after it; 0 where there is none."""
    i = int(np.argmin(np.abs(_along(run, position, run.ends))))
    lengths = np.diff(run.ends)
    around = np.concatenate([lengths[-2:], lengths, lengths[:2]]) if run.closed else np.pad(lengths, 2)
    return float(run.ends[i]), around[i : i + 4]


def _crowded(run: ZoneRun, position: float) -> float | None:
    """The nearest element end, if elements crowd to it."""
    end, (farther, before, after, beyond) = _beside(run, position)
    return end if farther >= GROWTH * before > 0 and beyond >= GROWTH * after > 0 else None


def _parts(run: ZoneRun, stretches: Sequence[Stretch]) -> list[_Part]:
    """Contact and what is open between, in order; a closed run all round, from where nothing is graded to if it can."""
    marks = [mark for item in stretches for mark in ((item.start, item.start_free), (item.end, item.end_free))]
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
        _Part(low=low, high=high, in_contact=(number % 2 == 0) == begin, low_free=low_free, high_free=high_free)
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
    shares = [CONTACT_SHARE * part.sides if part.in_contact else 0.0 for part in block]
    around = [*enumerate(block)]
    if block[0].low_free:  # all round a closed run: the last part is beside the first
        around.append(around[0])
    for (i, one), (j, other) in pairwise(around):
        (k, side), beside = ((i, one), other) if other.in_contact else ((j, other), one)
        shares[k] += max(1.0, (side.reach / beside.reach) ** (1 / 3))
    return [replace(part, share=share) for part, share in zip(block, shares, strict=True)]


def _counted(run: ZoneRun, block: Sequence[_Part]) -> list[_Part]:
    """Share the elements of a block out, each to the part that has the fewest for its share; more if they are too few.

    Parts that are alike, as by symmetry, get one each or none.
    """
    if not block[0].sides:
        return [*block]
    whole = block[0].low_free  # all round a closed run
    stated = len(run.ends) - 1 if whole else 1 + len(_inside(run.ends, run, block[0].low, block[-1].high))
    least = [(LEAST_IN_CONTACT if part.in_contact else LEAST_OPEN) * part.sides for part in block]
    pieces = [1 + len(_inside(run.joints, run, part.low, part.high)) for part in block]
    counts = [max(pair) for pair in zip(least, pieces, strict=True)]
    fair = ceil(LEAST_IN_CONTACT / CONTACT_SHARE * sum(part.share for part in block))  # enough outside for these
    left = max(max(stated, fair) - sum(counts), 0)
    rivals = list(range(len(block)))
    while left:
        need = [block[i].share / (counts[i] + 0.5) * (1 + 1e-6 * block[i].width / run.length) for i in rivals]
        first = [i for i, own in zip(rivals, need, strict=True) if own >= max(need) * (1 - 1e-12)]
        if len(first) > left and len(rivals) > len(first):
            rivals = [i for i in rivals if i not in first]
            continue
        for i in first[:left]:
            counts[i] += 1
        left -= len(first[:left])
    return [replace(part, count=count) for part, count in zip(block, counts, strict=True)]


def _graded(run: ZoneRun, part: _Part, shortest: float) -> Array:
    """Element ends of a part, from its low to its high end; as they are where contact ends on neither side."""
    low, high = part.low, part.high
    if not part.sides:
        return np.array([low, *_inside(run.ends, run, low, high), high])
    ends = cubic_ends(part.count, both=part.sides == 2, shortest=shortest / part.width)
    positions = low + part.width * ends if part.low_free else high - part.width * ends[::-1]
    positions[0], positions[-1] = low, high
    return _kept_short(run, moved_onto(positions, _inside(run.joints, run, low, high)))


def _kept_short(run: ZoneRun, ends: Array) -> Array:
    """Go back to elements as stated, or shorter in proportion, from the first to the last that is longer than these."""
    stated = np.concatenate([run.ends, run.ends[1:] + run.length]) if run.closed else run.ends
    count = np.arange(len(stated))
    number = np.interp(ends, stated, count)
    long = np.flatnonzero(np.diff(number) > 1 + 1e-9)
    if not long.size:
        return ends
    first, last = long[0], long[-1] + 1
    joints = _inside(run.joints, run, float(ends[first]), float(ends[last]))
    marks = [number[first], *np.interp(joints, stated, count), number[last]]
    between = [
        np.interp(np.linspace(low, high, ceil((high - low) * (1 - 1e-9)) + 1)[:-1], count, stated)
        for low, high in pairwise(marks)
    ]
    return np.concatenate([ends[:first], *between, ends[last:]])


def _inside(positions: Array, run: ZoneRun, low: float, high: float) -> list[float]:
    """Positions between two others, also beyond the seam of a closed run."""
    all_round = np.concatenate([positions, positions[1:] + run.length]) if run.closed else positions
    same = SAME * run.length
    return all_round[(all_round > low + same) & (all_round < high - same)].tolist()
