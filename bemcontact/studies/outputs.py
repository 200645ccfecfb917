"""Outputs of a study: numbers of a result by name, each with its error."""

import re
from collections.abc import Iterator, Sequence
from math import isfinite

import numpy as np

from bemcontact.analysis.result import Result
from bemcontact.assessment.accuracy import ErrorBar
from bemcontact.checks.arguments import texts
from bemcontact.contact.free_motions import angle_of_round_off, turns_a_body
from bemcontact.contact.stress import INSIDE, ON_BOUNDARY, LargestStresses, NoPeak
from bemcontact.errors import OptionError
from bemcontact.frozen import frozen_value
from bemcontact.problems.problem import Problem
from bemcontact.problems.wording import unknown_word
from bemcontact.serialization import Leaf

WHOLE = ("peak", "peak_x", "peak_y", "resultant_x", "resultant_y", "moment", "displacement", "von_mises")
"""Outputs of the whole body."""
OF_ZONES = ("force", "force_x", "force_y", "intervals", "start", "end", "length", "intensity", "max_shear")
"""Outputs of each contact zone, as ``force.foot``; those of a second interval are ``end.foot[1]``."""
OF_INTERVALS = ("start", "end", "length")
"""Those of them that each contact interval has."""
OF_MOVERS = ("motion", "rotation")
"""Outputs of each tool and free motion, as ``motion.press``; ``rotation.block`` has those of a body."""
FREE = ("translation", "rotation")
"""First words of the free motions."""
ROUND_OFF = 1e-9
"""Rotation times coordinates, relative to displacements, that is round-off; also pressure, relative to the peak."""
OF_STRESS = ("von_mises", "max_shear")
"""Outputs that a row has only if one of them was asked for: the search for the largest stresses takes its time."""
ALL_OF = {"resultant": ("resultant_x", "resultant_y")}
"""Name for several outputs -> these."""
LENGTH, PRESSURE, LINE_FORCE, LINE_MOMENT, NUMBER = "length", "stress", "line_force", "line_moment", ""
_FURTHER = re.compile(r"\[[1-9]\d*\]$")
_CENTER = re.compile(r" about \([^()]*\)")  # the middle of a body depends on its mesh, which each member finds
_COMMA = re.compile(r",(?![^()]*\))")  # but none in a direction such as (0, 1)
_QUOTED = re.compile(r"'([^']*)'")
DIMENSIONS = {
    "peak": PRESSURE, "peak_x": LENGTH, "peak_y": LENGTH, "resultant_x": LINE_FORCE, "resultant_y": LINE_FORCE,
    "moment": LINE_MOMENT, "displacement": LENGTH, "force": LINE_FORCE, "force_x": LINE_FORCE, "force_y": LINE_FORCE,
    "intervals": NUMBER, "start": LENGTH, "end": LENGTH, "length": LENGTH, "intensity": NUMBER, "motion": LENGTH,
    "rotation": NUMBER, "von_mises": PRESSURE, "max_shear": PRESSURE,
}  # fmt: skip
"""Output -> attribute of the units that has its label; nothing for numbers, and for intensities [p L^α]."""
USUAL = ("peak", "resultant", "length", "displacement")
"""Outputs that are shown unless others are chosen."""


@frozen_value
class Reading(Leaf):
    """A number of a result with its error."""

    value: float | None
    """Value in the units of the problem; null if there is none, as of an infinite peak."""
    error: float | None = None
    """Estimated error in the unit of the value; null if it is not known."""


def readings(result: Result, *, stresses: bool = False) -> dict[str, Reading]:
    """All outputs of a result, by name; those of stress only if they are asked for."""
    found = dict([*_of_whole(result), *_of_zones(result), *_of_intervals(result), *_of_bars(result)])
    found |= {name: item for name, item in _of_rotations(result) if name not in found}
    found |= dict(_of_stresses(result) if stresses else ())
    return {name: Reading(value=_finite(item.value), error=_finite(item.error)) for name, item in found.items()}


def _finite(number: float | None) -> float | None:
    """A number, or None for one that is not finite."""
    return number if number is not None and isfinite(number) else None


def _of_whole(result: Result) -> Iterator[tuple[str, Reading]]:
    """Peak, resultant and largest displacement."""
    where, accuracy = result.footprint, result.accuracy
    if (peak := where.peak) is not None:
        yield "peak", _reading(peak.pressure, accuracy.peak_bar())
        yield "peak_x", Reading(value=peak.at[0])
        yield "peak_y", Reading(value=peak.at[1])
    else:
        yield "peak", Reading(value=None)
    bars = [bar for bar in accuracy.bars if bar.quantity == "force" and bar.value]
    known = [abs(bar.value or 0.0) * bar.bar for bar in bars if bar.bar is not None]
    error = sum(known) if known and len(known) == len(bars) else None
    for axis, value in zip("xy", where.resultant.force, strict=True):
        yield f"resultant_{axis}", Reading(value=float(value), error=error)
    yield "moment", Reading(value=float(where.resultant.moment))


def _of_zones(result: Result) -> Iterator[tuple[str, Reading]]:
    """Forces of each zone, and its number of contact intervals."""
    bars = {bar.zone: bar for bar in result.accuracy.bars if bar.quantity == "force"}
    sums = result.contact.lengths_by_zone @ np.abs(result.solution.pressure)
    for zone, total in zip(result.contact.zone_names, sums.tolist(), strict=True):
        count = sum(item.zone == zone for item in result.footprint.intervals)
        total = total if count else 0.0
        error = None if zone not in bars else _reading(total, bars[zone].bar).error
        yield f"force.{zone}", Reading(value=total, error=error)
        for axis, value in zip("xy", result.footprint.forces[zone], strict=True):
            yield f"force_{axis}.{zone}", Reading(value=float(value), error=error)
        yield f"intervals.{zone}", Reading(value=float(count))


def _of_intervals(result: Result) -> Iterator[tuple[str, Reading]]:
    """Start, end and length of each contact interval, by arc position on its run."""
    bars = {(bar.quantity, bar.zone, bar.interval): bar for bar in result.accuracy.bars}
    count = dict[str, int]()
    for item in result.footprint.intervals:
        number = count.get(item.zone, 0)
        count[item.zone] = number + 1
        name = f"{item.zone}[{number}]" if number else item.zone
        for quantity, value in (("start", item.start_arc), ("end", item.end_arc), ("length", item.length)):
            bar = bars.get((quantity, item.zone, number))
            error = None if bar is None or bar.bar is None else bar.bar * item.length
            yield f"{quantity}.{name}", Reading(value=float(value), error=error)


def _of_bars(result: Result) -> Iterator[tuple[str, Reading]]:
    """What has a value together with its error bar only."""
    for bar in result.accuracy.bars:
        if bar.quantity == "displacement":
            yield "displacement", _of_bar(bar)
        elif bar.quantity in OF_MOVERS or (bar.quantity == "intensity" and bar.value is not None):
            yield f"{bar.quantity}.{bar.zone or _without_center(bar.mover or '')}", _of_bar(bar)


def _of_rotations(result: Result) -> Iterator[tuple[str, Reading]]:
    """Free rotations of bodies without their errors; zero where one is round-off, which has no error bar.

    There is no value where the amount is not known.
    """
    contact, pressure, angles = result.contact, result.solution.pressure, result.rotations
    if angles is None:
        return
    least = ROUND_OFF * contact.scales.displacement / (float(np.abs(contact.points).max()) or 1.0)
    if result.footprint.intervals:
        pressed = pressure > ROUND_OFF * pressure.max()
        least = max(least, angle_of_round_off(contact.points, contact.normals, pressed))
    for name, angle in zip(contact.motion_names, angles.tolist(), strict=True):
        if turns_a_body(name):
            yield f"rotation.{_without_center(name)}", Reading(value=0.0 if abs(angle) <= least else angle)


def _without_center(mover: str) -> str:
    """Name of a tool or a free motion without the center of a rotation."""
    return _CENTER.sub("", mover)


def _of_stresses(result: Result) -> Iterator[tuple[str, Reading]]:
    """Largest von Mises stress of all bodies, and largest shear stress below each contact."""
    largest = result.largest_stresses()
    peaks = [peak for peak in (largest.inside, largest.boundary) if peak is not None and not grows(largest)]
    highest = {"von_mises": max(peaks, key=lambda peak: peak.value, default=None)}
    for name, peak in {**highest, **{f"max_shear.{zone}": peak for zone, peak in largest.shear.items()}}.items():
        yield name, Reading(value=None) if peak is None else _reading(peak.value, peak.bar)


def grows(largest: LargestStresses) -> bool:
    """Whether von Mises stress has no maximum inside, or along an edge, but grows up to an infinite one."""
    return NoPeak.TO_INFINITE in (largest.missing.get(INSIDE), largest.missing.get(ON_BOUNDARY))


def of_stress(outputs: Sequence[str]) -> bool:
    """Whether some outputs are of stress."""
    return any(name.partition(".")[0] in OF_STRESS for name in outputs)


def _of_bar(bar: ErrorBar) -> Reading:
    """Value and error of an error bar."""
    return Reading(value=None) if bar.value is None else _reading(bar.value, bar.bar)


def _reading(value: float, bar: float | None) -> Reading:
    """A number with a relative error bar."""
    return Reading(value=float(value), error=None if bar is None else float(bar * abs(value)))


def chosen(output: str | Sequence[str] | None, problem: Problem) -> tuple[str, ...]:
    """Check names of outputs, such as ``peak``, ``force`` of all zones or ``force.foot``; the usual ones if None.

    `OptionError` for an unknown output, zone or mover.
    """
    if isinstance(output, str):
        output = [name.strip() for name in _COMMA.split(output)]
    names = _usual(problem) if output is None else texts(output, "output")
    if not names:
        raise OptionError(f"no output is named; there are: {', '.join(_known())}")
    for name in names:
        quantity, point, owner = name.partition(".")
        if quantity not in _known() or (point and quantity not in (*OF_ZONES, *OF_MOVERS)):
            raise OptionError(unknown_word("output", name, _known()))
        if point and quantity in OF_ZONES:
            _ensure_of_zone(quantity, owner, problem)
        elif point and owner.startswith(FREE):
            _ensure_of_bodies(name, owner, problem)
        elif point and owner not in (movers := [*problem.tools, *(part.name for part in problem.parts if part.name)]):
            unknown = unknown_word("tool or body" if problem.several else "tool", owner, movers)
            every = "" if unknown.endswith("?") else f"; {quantity} has a column for each tool and each free motion"
            raise OptionError(f"output {name}: {unknown}{every}")
    return tuple(dict.fromkeys(part for name in names for part in ALL_OF.get(name, (name,))))


def _ensure_of_bodies(name: str, mover: str, problem: Problem) -> None:
    """Refuse an output of a free motion of bodies that the problem does not have."""
    known = [part.name for part in problem.parts]
    for body in _QUOTED.findall(mover) if problem.several else ():
        if body not in (*known, *problem.tools):
            raise OptionError(f"output {name}: {unknown_word('body', body, known)}")


def _ensure_of_zone(quantity: str, owner: str, problem: Problem) -> None:
    """Refuse an output of a zone that the problem does not have, or of an interval where it has one for all of them."""
    zone = _FURTHER.sub("", owner) if quantity in OF_INTERVALS else owner
    if zone in problem.zones:
        return
    if f"{quantity}_{owner}" in OF_ZONES:
        part = f"{quantity}_{owner}"
        raise OptionError(f"output {quantity}.{owner}: write {part}, or {part}.{next(iter(problem.zones))}")
    raise OptionError(f"output {quantity}.{owner}: {unknown_word('contact zone', zone, problem.zones)}")


def _usual(problem: Problem) -> tuple[str, ...]:
    """The usual outputs; of several contacts of bodies the force of each, for their sum acts on no body."""
    apart = problem.several and len(problem.zones) > 1
    return tuple("force" if apart and name == "resultant" else name for name in USUAL)


def _known() -> tuple[str, ...]:
    """All names of outputs without their owners."""
    return (*ALL_OF, *WHOLE, *OF_ZONES, *OF_MOVERS)


def columns_of(outputs: Sequence[str], present: Sequence[str]) -> tuple[str, ...]:
    """Columns of a table: each output, or those of all zones and movers that rows have, in the order of the outputs.

    An output that no row has keeps its own name.
    """
    columns = list[str]()
    for name in outputs:
        own = [item for item in present if item == name or _owned(item, name)]
        columns += own or [name]
    return tuple(dict.fromkeys(columns))


def _owned(column: str, output: str) -> bool:
    """Whether a column is an output of a zone or mover, of a further interval, or of a free motion of a body."""
    (quantity, _, owner), (asked, point, name) = column.partition("."), output.partition(".")
    if not point:
        return quantity == asked
    of_body = quantity == asked and quantity in OF_MOVERS and f"the body '{name}'" in owner
    return of_body or column.startswith(f"{output}[")
