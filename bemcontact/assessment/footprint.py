"""Where the bodies touch: intervals of contact, the peak pressure, the resultant."""

import math
from collections.abc import Collection
from dataclasses import fields
from itertools import pairwise
from typing import ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import computed_field

from bemcontact.arrays import Array, IntArray, indices, magnitudes
from bemcontact.checks.attributes import PEAK, PLACE, ByName, WithHints, Words
from bemcontact.contact.condensed_contact import PEAK as LEAST_PEAK
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.load_cases import BALANCED
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen, frozen_value
from bemcontact.serialization import Internal, Leaf, Pair, Record

OPEN_NODES = 3
EQUAL = 1e-9
"""Difference from the largest pressure, over that, which is round-off: the peak is at the first point of those."""


@frozen_value
class Peak(Leaf):
    """The largest pressure, and where it acts."""

    _called: ClassVar[Words] = {"at": PLACE, "pressure": PEAK}

    pressure: float
    """Nodal pressure per undeformed length [p]."""
    at: Pair
    """Contact point (x, y) [L]; the first of them where the pressure is the same at several."""


@frozen_value
class ContactInterval(Leaf):
    """One unbroken stretch of contact along the boundary."""

    _home = "footprint.intervals"
    _called: ClassVar[Words] = {
        "start and end": ("ends", *PLACE),
        "length": ("width", "half_width", "contact_length", "contact_width", "contact_area", "size"),
        "force": ("resultant",),
        "peak": PEAK,
    }

    zone: str
    """Name of the contact zone."""
    start: Pair
    """First end (x, y) in the order of the boundary [L]."""
    end: Pair
    """Last end (x, y) in the order of the boundary [L]."""
    force: Pair
    """Force (x, y) on the body of the pressure on this stretch alone, Σ w p n, per thickness [p L]."""
    moment: float
    """Moment of this force about the origin, counterclockwise, per thickness [p L²]."""
    peak: Peak | None
    """Largest pressure on this stretch; null if that of its zone is infinite."""
    start_arc: Internal[float]
    """Arc position of the first end on the run [L]."""
    end_arc: Internal[float]
    """Arc position of the last end on the run [L]; it goes on counting across the seam of a closed run."""
    run: Internal[int] = 0
    """Number of the unbroken piece of boundary."""
    perimeter: Internal[float] = float("inf")
    """Perimeter of that piece if it closes on itself, otherwise infinity [L]."""

    def __repr__(self) -> str:
        """All fields; the perimeter only of a boundary that closes on itself."""
        shown = (item.name for item in fields(self) if item.name != "perimeter" or math.isfinite(self.perimeter))
        return f"{type(self).__name__}({', '.join(f'{name}={getattr(self, name)!r}' for name in shown)})"

    @computed_field
    @property
    def arc(self) -> Pair:
        """Arc positions of both ends on the piece of boundary [L]; across its seam they go on counting."""
        return self.start_arc, self.end_arc

    @property
    def length(self) -> float:
        """Length along the boundary [L]."""
        return self.end_arc - self.start_arc


@frozen_value
class Resultant(WithHints):
    """Force of the rigid surfaces on the body; of several bodies the sum over all contacts, which acts on no body."""

    _called: ClassVar[Words] = {
        "force": ("value", "x", "y", "forces", "total_force", "contact_force"),
        "moment": ("torque",),
        "line_point": PLACE,
    }

    force: Pair
    """Force (x, y), Σ w p n, per thickness [p L]."""
    moment: float
    """Its moment about the origin, counterclockwise, per thickness [p L²]."""
    line_point: Pair | None
    """Point of the line of action that is nearest to the origin [L]; None if the contact forces balance each other."""


@frozen_value
class Footprint(WithHints):
    """Where the body touches, and how hard."""

    intervals: tuple[ContactInterval, ...]
    """Contact intervals, zone by zone, in the order of the boundary; empty without contact."""
    peak: Peak | None
    """Largest pressure; None without contact, or if it is infinite."""
    resultant: Resultant
    """Resultant of the contact pressure."""
    forces: dict[str, Pair]
    """Force (x, y) in each zone on the body, the first one of a contact of two, Σ w p n, per thickness [p L]."""
    moments: dict[str, float]
    """Moment of each of these forces about the origin, counterclockwise, per thickness [p L²]."""


class FootprintRecord(Record):
    """Where the body touches, and how hard."""

    resultant: Pair
    """Force (x, y) of the rigid surfaces on the body, per thickness [p L]; of several bodies, as of `Resultant`."""
    resultant_moment: float
    """Its moment about the origin, counterclockwise, per thickness [p L²]."""
    forces: dict[str, Pair]
    """Force (x, y) in each zone on the body, the first one of a contact of two, per thickness [p L]."""
    moments: dict[str, float]
    """Moment of each of these forces about the origin, counterclockwise, per thickness [p L²]."""
    intervals: tuple[ContactInterval, ...]
    """Contact intervals, zone by zone; empty without contact."""
    peak: Peak | None
    """Largest pressure; null without contact, or if it is infinite."""


def footprint_record(footprint: Footprint) -> FootprintRecord:
    """Describe a footprint."""
    return FootprintRecord(
        resultant=footprint.resultant.force,
        resultant_moment=footprint.resultant.moment,
        forces=footprint.forces,
        moments=footprint.moments,
        intervals=footprint.intervals,
        peak=footprint.peak,
    )


def footprint(contact: CondensedContact, solution: ContactSolution, *, infinite: Collection[str] = ()) -> Footprint:
    """Find contact intervals, peak and resultant of a solution of any formulation.

    A point touches if p/T > δ/U. The end of an interval is read off the gap, which grows like s^(3/2) beyond it: the
    zero of the line through δ^(2/3) at the first three open points, as long as the gap grows, kept between the last
    point in contact and the first open one. With two open points the line goes through both; with one the end is put
    half-way. Contact up to the end of a run ends at its last point, or at the node beyond it that a condition holds on
    the rigid surface. There is no peak if that of a zone is known to be infinite.
    """
    carried = _LoadOnPoints.of(contact, solution.pressure, infinite)
    forces = ((x, y) for x, y in contact.resultants(solution.pressure).tolist())
    moments = contact.moments(solution.pressure).tolist()
    return Footprint(
        intervals=tuple(
            interval
            for zone, path in _paths(contact, solution)
            for interval in _intervals(path, contact.zone_names[zone], carried)
        ),
        peak=None if infinite else carried.largest(np.arange(contact.size)),
        resultant=_resultant(carried),
        forces=ByName("contact", dict(zip(contact.zone_names, forces, strict=True))),
        moments=ByName("contact", dict(zip(contact.zone_names, moments, strict=True))),
    )


def end_rates(
    contact: CondensedContact, solution: ContactSolution, gap_rate: Array
) -> tuple[tuple[float | None, float | None], ...]:
    """How fast the ends of contact move along the boundary, as `footprint` reads them off the gap.

    `gap_rate` (n,) is the derivative of the gap per unit of something; it is not a number at points that are about to
    enter or leave contact. For each interval the result has the derivatives of `start_arc` and `end_arc`: zero where an
    end is kept at a point, None beside a point that is about to enter or leave contact.
    """
    return tuple(pair for _, path in _paths(contact, solution) for pair in _rates(path, gap_rate[path.index]))


def resting_ends(contact: CondensedContact, solution: ContactSolution) -> tuple[Pair, ...]:
    """Ends of contact that `footprint` keeps at a point, although open points follow: their rates are zero.

    There the line through the gaps of the open points would end beyond the two points between which contact ends.
    """
    resting = []
    for _, path in _paths(contact, solution):
        for ends in () if path.closed else _stretches(path):
            for last, step in zip(ends, (-1, +1), strict=True):
                position = _end(path, last, step)
                if len(_opened(path, last, step)) > 1 and position in (path.arc[last], path.arc[last + step]):
                    resting.append(_at(path, position))
    return tuple(resting)


class _LoadOnPoints(NamedTuple):
    """Pressure (n,), forces (n, 2) and their moments (n,) at contact points; stretches of contact carry parts."""

    contact: CondensedContact
    pressure: Array
    forces: Array
    moments: Array
    infinite: Collection[str]

    @classmethod
    def of(cls, contact: CondensedContact, pressure: Array, infinite: Collection[str]) -> Self:
        """Those of a pressure; there is no peak in the zones where it is infinite."""
        forces, (x, y) = contact.forces(pressure), contact.points.T
        return cls(contact, pressure, forces, x * forces[:, 1] - y * forces[:, 0], infinite)

    def by(self, index: IntArray, zone: str) -> tuple[Pair, float, Peak | None]:
        """Force, moment and peak of some points of a zone."""
        (fx, fy), moment = self.forces[index].sum(axis=0).tolist(), float(self.moments[index].sum())
        return (fx, fy), moment, None if zone in self.infinite else self.largest(index)

    def largest(self, index: IntArray) -> Peak | None:
        """The largest pressure of some points; None if it is round-off."""
        if not len(index):
            return None
        own, pressure = self.pressure[index], float(self.pressure[index].max())
        x, y = self.contact.points[index[np.argmax(own >= (1 - EQUAL) * pressure)]].tolist()
        return Peak(pressure=pressure, at=(x, y)) if pressure > LEAST_PEAK * self.contact.scales.pressure else None


@frozen
class _Path:
    """The points of one run in order, gap cut off below zero; a closed run three times over.

    Only intervals that begin at one of the points `first` to `last` - 1 belong to the run itself.
    """

    arc: Array
    points: Array
    gap: Array
    touching: NDArray[np.bool_]
    first: int
    last: int
    run: int
    perimeter: float
    held_arc: Array
    held_points: Array
    index: IntArray

    @property
    def closed(self) -> bool:
        """Whether there is contact all around a closed run."""
        return self.first > 0 and bool(self.touching.all())


def _paths(contact: CondensedContact, solution: ContactSolution) -> list[tuple[int, _Path]]:
    """All runs, each with the number of its zone."""
    gap = contact.initial_gap + solution.displacement
    touching = contact.pressed(solution.pressure, solution.displacement)
    pieces = sorted(set(zip(contact.zone.tolist(), contact.run.tolist(), strict=True)))
    return [(zone, _path(contact, zone, run, gap, touching)) for zone, run in pieces]


def _path(contact: CondensedContact, zone: int, run: int, gap: Array, touching: NDArray[np.bool_]) -> _Path:
    """Gather the points of a run."""
    index = indices((contact.zone == zone) & (contact.run == run))
    perimeter, m = float(contact.run_length[run]), len(index)
    around, turns, first = index, 0.0, 0
    if np.isfinite(perimeter):
        around, turns, first = np.tile(index, 3), np.repeat([-perimeter, 0.0, perimeter], m), m
    return _Path(
        arc=contact.arc_position[around] + turns,
        points=contact.points[around],
        gap=np.maximum(gap[around], 0.0),
        touching=touching[around],
        first=first,
        last=first + m,
        run=run,
        perimeter=perimeter,
        held_arc=np.full(2, np.nan) if contact.held_arc is None else contact.held_arc[run],
        held_points=np.zeros((2, 2)) if contact.held_points is None else contact.held_points[run],
        index=around,
    )


def _stretches(path: _Path) -> list[tuple[int, int]]:
    """First and last point of each unbroken stretch of contact of a run that does not touch all around."""
    touching = path.touching
    changes = (indices(touching[1:] != touching[:-1]) + 1).tolist()
    stretches = [*pairwise([0, *changes, len(touching)])][int(not touching[0]) :: 2]
    return [(begin, after - 1) for begin, after in stretches if path.first <= begin < path.last]


def _intervals(path: _Path, zone: str, carried: _LoadOnPoints) -> list[ContactInterval]:
    """The stretches of contact of a run; a closed run in contact all around is one, from its first point."""
    if path.closed:
        once = path.index[path.first : path.last]
        return [_interval(path, zone, (path.arc[path.first], path.arc[path.last]), carried.by(once, zone))]
    return [
        _interval(
            path, zone, (_end(path, begin, -1), _end(path, finish, +1)),
            carried.by(path.index[begin : finish + 1], zone),
        )
        for begin, finish in _stretches(path)
    ]  # fmt: skip


def _rates(path: _Path, rate: Array) -> list[tuple[float | None, float | None]]:
    """Derivatives of the ends of `_intervals`."""
    if path.closed:
        return [(0.0, 0.0)]
    return [(_end_rate(path, rate, begin, -1), _end_rate(path, rate, finish, +1)) for begin, finish in _stretches(path)]


def _interval(path: _Path, zone: str, ends: Pair, carries: tuple[Pair, float, Peak | None]) -> ContactInterval:
    """An interval from its arc positions, and what it carries."""
    (start, end), (force, moment, peak) = ends, carries
    return ContactInterval(
        zone=zone,
        start=_at(path, start),
        end=_at(path, end),
        force=force,
        moment=moment,
        peak=peak,
        start_arc=float(start),
        end_arc=float(end),
        run=path.run,
        perimeter=path.perimeter,
    )


def _opened(path: _Path, last: int, step: int) -> list[int]:
    """The first open points beyond the point `last`, walking by `step`, as long as the gap grows."""
    opened: list[int] = []
    for i in range(last + step, last + (OPEN_NODES + 1) * step, step):
        if not 0 <= i < len(path.arc) or path.touching[i] or (opened and path.gap[i] <= path.gap[opened[-1]]):
            break
        opened.append(i)
    return opened


def _end(path: _Path, last: int, step: int) -> float:
    """Arc position of the end of contact beyond the point `last`, walking by `step`."""
    opened = _opened(path, last, step)
    if not opened:
        beyond = last + step in (-1, len(path.arc))
        held = path.held_arc[0 if step < 0 else 1]
        return held if beyond and np.isfinite(held) else path.arc[last]
    at, nearest = float(path.arc[last]), float(path.arc[opened[0]])
    if len(opened) == 1:
        return (at + nearest) / 2
    slope, value = _line(path.arc[opened] - at, path.gap[opened] ** (2 / 3))
    if slope == 0.0:  # the gap grows by rounding alone
        return (at + nearest) / 2
    return min(max(at - value / slope, min(at, nearest)), max(at, nearest))


def _line(x: Array, y: Array) -> tuple[float, float]:
    """Slope, and value at zero, of the line of least squares through two or more points x (k,), y (k,)."""
    middle, level = math.fsum(x) / len(x), math.fsum(y) / len(x)
    away = x - middle
    slope = float(away @ (y - level) / (away @ away))
    return slope, level - slope * middle


def _end_rate(path: _Path, rate: Array, last: int, step: int) -> float | None:
    """Derivative of `_end` by the chain rule; zero where the end is kept at a place, None where there is none."""
    opened = _opened(path, last, step)
    if np.isnan(rate[[last, *opened]]).any():
        return None
    if len(opened) < 2:
        return 0.0
    arc, gap = path.arc[opened] - path.arc[last], path.gap[opened]
    slope, value = _line(arc, gap ** (2 / 3))
    slope_rate, value_rate = _line(arc, 2 / 3 * gap ** (-1 / 3) * rate[opened])
    free = slope != 0.0 and 0 < -value / slope / arc[0] < 1
    return float((value * slope_rate / slope - value_rate) / slope) if free else 0.0


def _at(path: _Path, position: float) -> Pair:
    """The point at an arc position: a held end, or by the parabola through the three nearest points in order."""
    position = float(position)
    if position in (held := path.held_arc.tolist()):
        x, y = path.held_points[held.index(position)].tolist()
        return x, y
    count = min(3, len(path.arc))
    start = min(max(int(np.abs(path.arc - position).argmin()) - 1, 0), len(path.arc) - count)
    arc, points = path.arc[start : start + count].tolist(), path.points[start : start + count]
    x = y = 0.0
    for own, (own_x, own_y) in zip(arc, points.tolist(), strict=True):
        share = 1.0
        for other in arc:
            if other != own:
                share *= (position - other) / (own - other)
        x, y = x + share * own_x, y + share * own_y
    return x, y


def _resultant(carried: _LoadOnPoints) -> Resultant:
    """Force Σ w p n, its moment, and its line of action."""
    (fx, fy), moment = carried.forces.sum(axis=0).tolist(), float(carried.moments.sum())
    square = fx**2 + fy**2
    acts = square > (BALANCED * magnitudes(carried.forces).sum()) ** 2  # else the force, and so its line, is round-off
    line_point = (moment * fy / square, -moment * fx / square) if acts else None
    return Resultant(force=(fx, fy), moment=moment, line_point=line_point)
