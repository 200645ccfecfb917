"""Tables of the contact zones of a result, or of all load cases: in words for pages, and as CSV."""

from collections import Counter
from collections.abc import Callable, Iterator
from itertools import chain, starmap
from typing import Any

import numpy as np

from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.assessment.accuracy import ErrorBar
from bemcontact.contact.stress import INSIDE, ON_BOUNDARY, SHEAR_BELOW
from bemcontact.problems import Units
from bemcontact.report.bars import NOTHING, JsonObject, error_of, infinite_peaks, with_bar, without_digits_beyond
from bemcontact.report.facts import (
    contact_intervals,
    coordinate_size,
    force_errors,
    forces_on_bodies,
    intensities,
    moment_in_words,
    pressed_by,
    resolved_size,
)
from bemcontact.report.formatting import number, vector, with_unit, zero_if_negligible
from bemcontact.report.peak_places import level_zones
from bemcontact.serialization import csv_text

ZONE_COLUMNS = (
    "case", "zone", "intervals", "length", "peak", "peak_error", "peak_x", "peak_y", "force_x", "force_y",
    "force_error", "moment", "body",
)  # fmt: skip
"""Columns of zones.csv."""
INTERVAL_COLUMNS = (
    "case", "zone", "interval", "start_x", "start_y", "end_x", "end_y", "end_error", "length", "length_error", "peak",
    "peak_x", "peak_y", "force_x", "force_y", "moment", "body",
)  # fmt: skip
"""Columns of intervals.csv."""
POINT_COLUMNS = ("case", "zone", "x", "y", "normal_x", "normal_y", "arc", "pressure", "gap", "touching")
"""Columns of points.csv."""
STRESS_COLUMNS = ("case", "edge", "x", "y", "arc", "hoop", "pressure", "shear", "von_mises")
"""Columns of stress.csv."""
FIGURES = 4
"""Figures of a number whose error is not known."""
LARGEST_COLUMNS = ("case", "stress", "of", "value", "error", "x", "y", "depth", "body", "edge", "none")
"""Columns of largest_stresses.csv."""


def by_case(results: Result | CaseResults) -> dict[str, Result]:
    """Results by the name of their load case; a result alone has the name ""."""
    return {"": results} if isinstance(results, Result) else results.results


def zone_rows(record: JsonObject, units: Units) -> Iterator[dict[str, str]]:
    """Write each zone of a record: where it touches, peak, force, moment about (0, 0), intensities.

    The record is the JSON of a result. A zone that does not touch has a dash for its peak and intensity.
    """
    forces, places = forces_on_bodies(record, units), [*contact_intervals(record, units, merged=True)]
    for zone, force in forces.items():
        own = [place for name, place in places if name == zone]
        errors = force_errors(record, zone)
        yield {
            "zone": zone,
            "contact": "; ".join(own) or "nowhere",
            "peak": _peak(record, zone, units) if own else NOTHING,
            "force": force,
            "moment": moment_in_words(record["moments"][zone], sum(errors) if errors else None, record, units),
            "intensity": "; ".join(words for name, words in intensities(record, units) if name == zone) or NOTHING,
        }


def interval_rows(record: JsonObject, units: Units) -> Iterator[dict[str, str]]:
    """Write each interval of the zones that touch at several: its place, and the peak, force and moment there.

    The error of the force of a zone is not that of its intervals, which are written with four figures.
    """
    size, pressed = coordinate_size(record), pressed_by(record)
    count = Counter(interval["zone"] for interval in record["intervals"])
    for interval, (zone, place) in zip(record["intervals"], contact_intervals(record, units), strict=True):
        if count[zone] > 1:
            moment = zero_if_negligible(interval["moment"], pressed * size)
            yield {
                "zone": zone,
                "contact": place,
                "peak": _peak_of_interval(record, interval, units),
                "force": vector(interval["force"], units.line_force, scale=pressed, figures=FIGURES),
                "moment": with_unit(number(moment, FIGURES), units.line_moment),
            }


def _peak_of_interval(record: JsonObject, interval: JsonObject, units: Units) -> str:
    """The largest pressure of an interval and its place; with the error of its zone if it may be the largest there."""
    peak, zone = interval["peak"], interval["zone"]
    if peak is None:
        return "infinite in this zone"
    bar = error_of(record, "peak", zone)
    others = (other["peak"]["pressure"] for other in record["intervals"] if other["zone"] == zone and other["peak"])
    largest = peak["pressure"] >= (1 - (bar or 0.0)) * max(others)
    value = with_bar(peak["pressure"], bar) if largest else without_digits_beyond(peak["pressure"], bar)
    return f"{with_unit(value, units.stress)} at {vector(peak['at'], units.length, scale=resolved_size(record))}"


def _peak(record: JsonObject, zone: str, units: Units) -> str:
    """The largest pressure of a zone with its error and place, or that it is infinite."""
    if zone in infinite_peaks(record):
        return "infinite"
    own = [i for i, name in enumerate(record["zone"]) if name == zone]
    highest = max(own, key=lambda i: record["pressure"][i])
    value = with_bar(record["pressure"][highest], error_of(record, "peak", zone))
    if zone in level_zones(record, 1.0):
        return f"{with_unit(value, units.stress)} all along"
    place = vector(record["nodes"][highest], units.length, scale=resolved_size(record))
    return f"{with_unit(value, units.stress)} at {place}"


def _zone_lines(case: str, result: Result) -> Iterator[list[Any]]:
    """A line for each zone: what it carries, all its intervals of contact together.

    Errors are absolute, in the unit of the number before them; empty where there is no number. The body is the one of
    several on which the force acts.
    """
    contact, pressure = result.contact, result.solution.pressure
    bars = {(bar.quantity, bar.zone, bar.interval): bar for bar in result.accuracy.bars}
    for order, zone in enumerate(contact.zone_names):
        own = np.flatnonzero(contact.zone == order)
        highest = own[int(np.argmax(pressure[own]))]
        infinite, touches = zone in result.accuracy.infinite, bool(pressure[highest] > 0)
        at = contact.points[highest].tolist() if touches and not infinite else ["", ""]
        value = "" if infinite else float(pressure[highest]) if touches else 0.0
        error = "" if infinite else _error(bars.get(("peak", zone, None)))
        lengths = [item.length for item in result.footprint.intervals if item.zone == zone]
        yield [
            case, zone, len(lengths), sum(lengths), value, error, *at, *result.footprint.forces[zone],
            _error(bars.get(("force", zone, None))), result.footprint.moments[zone], _pressed(result, zone),
        ]  # fmt: skip


def _interval_lines(case: str, result: Result) -> Iterator[list[Any]]:
    """A line for each interval of contact: its ends, and what it alone carries.

    Errors are absolute, in the unit of the number before them; empty where they are not known. A peak is empty where
    that of the zone is infinite.
    """
    bars, count = {(bar.quantity, bar.zone, bar.interval): bar for bar in result.accuracy.bars}, Counter[str]()
    for item in result.footprint.intervals:
        order = count[item.zone]
        count[item.zone] += 1
        ends = [bars.get((quantity, item.zone, order)) for quantity in ("start", "end")]
        known = [bar.bar * item.length for bar in ends if bar is not None and bar.bar is not None]
        yield [
            case, item.zone, order, *item.start, *item.end, max(known) if len(known) == len(ends) else "",
            item.length, _error(bars.get(("length", item.zone, order))),
            *(["", "", ""] if item.peak is None else [item.peak.pressure, *item.peak.at]), *item.force, item.moment,
            _pressed(result, item.zone),
        ]  # fmt: skip


def _pressed(result: Result, zone: str) -> str:
    """The body on which the force of a zone acts; empty for an only one."""
    return result.sides.get(zone, ("", ""))[0]


def _error(bar: ErrorBar | None) -> float | str:
    """Absolute error of a quantity; empty if it is not known."""
    return "" if bar is None or bar.bar is None or bar.value is None else abs(bar.value) * bar.bar


def point_lines(case: str, result: Result) -> Iterator[list[Any]]:
    """A line for each contact point, along the boundary: place, normal, pressure, gap, and whether it touches."""
    contact = result.contact
    for run in np.unique(contact.run).tolist():
        for i in contact.points_of_run(run).tolist():
            yield [
                case, contact.zone_names[int(contact.zone[i])],
                *contact.points[i].tolist(), *contact.normals[i].tolist(), float(contact.arc_position[i]),
                float(result.pressure[i]), float(result.gap[i]), int(result.touching[i]),
            ]  # fmt: skip


def _stress_lines(case: str, result: Result) -> Iterator[list[Any]]:
    """A line for each node of each element: stress along the edge, pressure, shear; empty where stress is infinite.

    Where elements meet there is a line for either side.
    """
    for edge, along in result.boundary_stress().items():
        values = [
            part.ravel().tolist() for part in (along.arc, along.hoop, along.pressure, along.shear, along.von_mises)
        ]
        for point, *numbers in zip(along.points.reshape(-1, 2).tolist(), *values, strict=True):
            yield [case, edge, *point, *("" if np.isnan(number) else number for number in numbers)]


def _largest_lines(case: str, result: Result) -> Iterator[list[Any]]:
    """A line for each largest stress, and for each place where stress is infinite, which has no value.

    The error is absolute; empty where it is not known. If there is no largest stress, the last column says why.
    """
    largest = result.largest_stresses()
    peaks = [("max_shear", zone, peak, SHEAR_BELOW.format(zone)) for zone, peak in largest.shear.items()]
    peaks += [("von_mises", "inside", largest.inside, INSIDE), ("von_mises", "boundary", largest.boundary, ON_BOUNDARY)]
    for stress, of, peak, label in peaks:
        if peak is None:
            yield [case, stress, of, *[""] * 7, str(largest.missing[label])]
        else:
            error = "" if peak.bar is None else peak.bar * peak.value
            yield [case, stress, of, peak.value, error, *peak.point, peak.depth, peak.body, peak.edge or "", ""]
    for x, y in largest.singular.tolist():
        yield [case, "von_mises", "infinite", "", "", x, y, *[""] * 4]


TABLES: dict[str, tuple[tuple[str, ...], Callable[[str, Result], Iterator[list[Any]]]]] = {
    "zones.csv": (ZONE_COLUMNS, _zone_lines),
    "intervals.csv": (INTERVAL_COLUMNS, _interval_lines),
    "points.csv": (POINT_COLUMNS, point_lines),
    "stress.csv": (STRESS_COLUMNS, _stress_lines),
    "largest_stresses.csv": (LARGEST_COLUMNS, _largest_lines),
}
"""Name of a file -> columns of its table, and the lines of a result, which begin with the load case."""
OF_STRESS = ("stress.csv", "largest_stresses.csv")
"""Those that need the boundary of the body."""


def result_table(results: Result | CaseResults, name: str) -> str:
    """A table as CSV, by the name of its file."""
    columns, lines = TABLES[name]
    return csv_text(columns, chain.from_iterable(starmap(lines, by_case(results).items())))


def tables_of(results: Result | CaseResults) -> dict[str, str]:
    """All tables as CSV, by the names of their files; of a condensed problem there is none of stress."""
    whole = all(result.boundary is not None for result in by_case(results).values())
    return {name: result_table(results, name) for name in TABLES if whole or name not in OF_STRESS}
