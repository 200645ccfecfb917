"""Facts of a result in words, from its JSON, for the terminal and for pages."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from bemcontact.assessment.accuracy import bar_of_largest
from bemcontact.contact.free_motions import TURNS, angle_of_round_off, turns_a_body
from bemcontact.problems import Units
from bemcontact.report.bars import (
    NOTHING,
    ROUND_OFF,
    JsonObject,
    bars_of,
    error_alone,
    error_of,
    error_percent,
    infinite_peaks,
    unit_of_bar,
    vector_with_error,
    with_bar,
    without_digits_beyond,
)
from bemcontact.report.formatting import (
    NEGLIGIBLE,
    number,
    vector,
    with_unit,
    zero_if_negligible,
)
from bemcontact.report.peak_places import LEVEL, equal_peaks, level_zones

RESIDUALS = ("penetration", "tension", "complementarity", "equilibrium", "force_balance")
"""Residuals that are listed."""
QUALITIES = {"holds": "good", "does not hold": "bad", "not judged": "fair"}
"""Verdict on a quantity of a reference -> quality."""
PLAIN = 0.01, 1000.0
"""Range of numbers that are written without a power of ten."""
MOST_PLACES = 3
"""Number of places of the largest pressure, and of translations without an amount, that are named."""
UNRESOLVED = 1e-3
"""Share of the length of contact below which no place in it is resolved."""
MOST_FIGURES = 10
"""Figures of the ends of a contact far from the origin; five tell all others apart."""
MOVES = "translation "
"""First word of a free translation."""
NOT_KNOWN = "not known; only slopes and levers as drawn hold it, which move with the body"
"""Words for the angle of a body that turns on and on."""
UNKNOWN_AMOUNT = "an amount that is not known"
"""Words for a motion of a tool that nothing determines."""
TRANSLATIONS = "translation along (1, 0)", "translation along (0, 1)"
"""Names of the free motions of a body that only contact holds."""


def peak_of(record: JsonObject, units: Units) -> str:
    """The largest pressure with its error in a few words: a number, ``infinite``, or ``no contact``."""
    if infinite_peaks(record):
        return "infinite"
    if peak := record["peak"]:
        return with_unit(with_bar(peak["pressure"], peak_bar(record)), units.stress) + _unknown_error(record)
    return "no contact"


def _unknown_error(record: JsonObject) -> str:
    """Words behind a largest pressure whose error was looked for and is not known; else nothing."""
    sought = record.get("accuracy", {}).get("met") is False
    return "; error not known" * (sought and peak_bar(record) is None)


def peak_bar(record: JsonObject) -> float | None:
    """Error of the largest pressure, of whatever zone it is; None if the error of one zone is not known."""
    bars = [item for item in bars_of(record, "peak") if item["value"] is not None]
    return bar_of_largest([(item["value"], item["bar"]) for item in bars])


def _peaks(record: JsonObject, units: Units) -> Iterator[tuple[str, str]]:
    """Write the largest pressure; where that of a zone is infinite, each zone by itself."""
    infinite = infinite_peaks(record)
    if not infinite and (peak := record["peak"]):
        value, place = with_unit(with_bar(peak["pressure"], peak_bar(record)), units.stress), peak_place(record, units)
        at = "" if place.startswith("all along") else "at "
        equal = f", equal within {error_percent(max(peak_bar(record) or 0.0, LEVEL))}"
        equal *= len(_peak_places(record, units)) > 1
        words = f"{value} {at}{place}{equal}{_unknown_error(record)}"
        yield "Peak pressure", f"{words}; per UNDEFORMED length"
        for zone in dict.fromkeys(interval["zone"] for interval in record["intervals"]):
            largest = max(p for p, of in zip(record["pressure"], record["zone"], strict=True) if of == zone)
            if largest < (1 - max(peak_bar(record) or 0.0, LEVEL)) * peak["pressure"]:  # else it is named above
                value = with_unit(with_bar(largest, error_of(record, "peak", zone)), units.stress)
                yield "Peak pressure", f"of {zone}: {value}"
    if infinite:
        for bar in bars_of(record, "peak"):
            yield "Peak pressure", f"of {bar['zone']}: {_peak_of_zone(bar, record, units)}"


def _peak_of_zone(bar: JsonObject, record: JsonObject, units: Units) -> str:
    """Write the largest pressure of a zone with its error, or where and why it is infinite."""
    if bar["value"] is not None:
        return with_unit(with_bar(bar["value"], bar["bar"]), units.stress)
    place = bar["at"] and vector(bar["at"], units.length, scale=coordinate_size(record))
    return f"infinite at {place}: {bar['note'].removeprefix('infinite ')}" if place else bar["note"]


def facts(record: JsonObject, units: Units) -> Iterator[tuple[str, str]]:
    """List name and value of each fact of a record: contact, peak, resultants, free motions, tools and residuals."""
    size, pressed, moves = coordinate_size(record), pressed_by(record), record["scales"]["displacement"]
    if not record["intervals"]:
        held = "" if record["motion_names"] else ", and the supports alone hold the body"
        yield "Contact", f"nowhere: nothing presses on the body{held}{_gap_left(record, units)}"
    for (zone, place), count in Counter(contact_intervals(record, units, merged=True)).items():
        yield "Contact", f"{zone}: {place}" + (f", {count} times" if count > 1 else "")
    for zone in dict.fromkeys(record["zone"]):
        if record["intervals"] and zone not in [interval["zone"] for interval in record["intervals"]]:
            yield "Contact", f"{zone}: nowhere"
    yield from _peaks(record, units)
    yield from (("Intensity", f"of {zone}: {words}") for zone, words in intensities(record, units))
    for bar in bars_of(record, "displacement"):
        place = bar["at"] and f", at {vector(bar['at'], units.length, scale=size)}"
        largest = f"{largest_displacement(bar, units)} at most{place or ''}"
        yield "Displacement", bar["note"] if bar["value"] is None else largest
    forces, sides = zone_forces(record, units), record["sides"]
    if not sides:
        force, error = _force(record["resultant"], record, None, units), sum(force_errors(record)) or None
        moment = moment_in_words(record["resultant_moment"], error, record, units)
        yield "Resultant", f"{force}, of the rigid surfaces on the body; moment {moment} about (0, 0)"
    for zone, written in forces.items() if len(forces) > 1 or sides else ():
        yield "Resultant", f"of {zone}{f' on {sides[zone][0]}' if sides else ''}: {written}"
    yield from rotations(record)
    if record["intervals"] and (unknown := _unknown_translations(record)):
        more = f" and {len(unknown) - MOST_PLACES} more" * (len(unknown) > MOST_PLACES)
        words = NOT_KNOWN if len(unknown) == 1 else NOT_KNOWN.replace("hold it", "hold them")
        yield "Translation", f"{', '.join(unknown[:MOST_PLACES])}{more}: {words}"
    for tool in record["tools"]:
        yield "Tool", _tool(record, tool, size, pressed, moves, units)
    residuals = ((name, record["residuals"][name]) for name in RESIDUALS)
    written = (f"{name.replace('_', ' ')} {value + 0.0:.1e}" for name, value in residuals if value is not None)
    yield "Residuals", ", ".join(written)


def intensities(record: JsonObject, units: Units) -> Iterator[tuple[str, str]]:
    """Zone of each infinite pressure whose intensity K is known, and K with its law and place."""
    for bar in bars_of(record, "intensity"):
        if bar["value"] is not None:
            value = with_unit(with_bar(bar["value"], bar["bar"]), unit_of_bar(bar, units))
            place = vector(bar["at"], units.length, scale=coordinate_size(record))
            yield bar["zone"], f"K = {value} in {bar['note']} at {place}"


def moment_in_words(moment: float, error: float | None, record: JsonObject, units: Units) -> str:
    """Write a moment with the digits that an error of the force leaves, whose lever may be the largest coordinate."""
    size = coordinate_size(record)
    moment = zero_if_negligible(moment, pressed_by(record) * size)
    known = size * error / abs(moment) if moment and error is not None else None
    return with_unit(without_digits_beyond(moment, known), units.line_moment)


def largest_displacement(bar: JsonObject, units: Units) -> str:
    """Write the largest displacement from its error bar, or that it is not known."""
    return "not known" if bar["value"] is None else with_unit(with_bar(bar["value"], bar["bar"]), units.length)


def rotations(record: JsonObject) -> Iterator[tuple[str, str]]:
    """Name and angle of each free rotation of a body."""
    for j, name in enumerate(record["motion_names"]):
        if turns_a_body(name):
            yield "Rotation", f"{_in_sense(name, record, j).removeprefix(TURNS)}{_angle(record, j)}"


def _unknown_translations(record: JsonObject) -> list[str]:
    """Those of bodies whose amount is not known, although contact holds them as drawn."""
    names = (name for name in record["unknown_motions"] if name not in record["undetermined"])
    return [name.removeprefix(MOVES) for name in names if name.startswith(MOVES) and " of the tool " not in name]


def rotations_of_cases(records: Mapping[str, JsonObject]) -> Iterator[tuple[str, str]]:
    """Load case and angle of each free rotation of a body; of one that is the same in all, no case is named."""
    told = [(case, words) for case, record in records.items() for _, words in rotations(record)]
    count = Counter(words for _, words in told)
    for case, words in told:
        if count[words] < len(records) or len(records) == 1:
            yield case, words
    yield from (("", words) for words, times in count.items() if times == len(records) > 1)


def _gap_left(record: JsonObject, units: Units) -> str:
    """Write the smallest gap where nothing touches, of which a wrong load or place of a surface is seen."""
    if not record["gap"]:
        return ""
    i = int(np.argmin(record["gap"]))
    place = vector(record["nodes"][i], units.length, scale=coordinate_size(record))
    gap = with_unit(number(zero_if_negligible(record["gap"][i], coordinate_size(record))), units.length)
    return f"; the smallest gap left is {gap}, at {place} in {record['zone'][i]}"


def contact_intervals(
    record: JsonObject, units: Units, *, short: bool = False, merged: bool = False
) -> Iterator[tuple[str, str]]:
    """Zone and place of each interval of contact, with its errors; the length in place of a `short` one.

    If they are to be `merged`, of several that do not differ in their coordinates the place alone is written.
    """
    size = coordinate_size(record)
    alike = Counter(_written_ends(interval, size, units) for interval in record["intervals"])
    for interval, (error, bar) in zip(record["intervals"], _interval_errors(record), strict=True):
        first, last = interval["arc"]
        ends = _written_ends(interval, size, units)
        if merged and ends[1] == ends[2] and alike[ends] > 1 and last > first:
            yield interval["zone"], f"narrow, at {ends[2]}"
            continue
        length = with_unit(with_bar(last - first, bar or None), units.length)
        place = length if short else _span(interval, length, size, units)
        yield interval["zone"], place + (f", ends ± {with_unit(error_alone(error), units.length)}" if error else "")


def _written_ends(interval: JsonObject, size: float, units: Units) -> tuple[str, str, str]:
    """Zone of an interval, and its ends as they are written."""
    start, end = (vector(interval[name], units.length, scale=size) for name in ("start", "end"))
    return interval["zone"], start, end


def _interval_errors(record: JsonObject) -> Iterator[tuple[float | None, float | None]]:
    """Largest error of the ends of each contact interval [L], and relative error of its length; None if not known.

    Contact all around has no ends.
    """
    bars = [bar for quantity in ("start", "end", "length") for bar in bars_of(record, quantity)]
    count: Counter[str] = Counter()
    for interval in record["intervals"]:
        zone, (first, last) = interval["zone"], interval["arc"]
        own = [bar["bar"] for bar in bars if (bar["zone"], bar["interval"]) == (zone, count[zone])]
        count[zone] += 1
        yield (None, None) if not own or None in own else (max(own[:-1], default=0.0) * (last - first), own[-1])


def _angle(record: JsonObject, motion: int) -> str:
    """Angle of a free rotation in its sense, or why it is not known; nothing where its unit is not known."""
    name = record["motion_names"][motion]
    if not record["intervals"] or name in record["undetermined"]:
        return ": not determined"
    if name in record["unknown_motions"]:
        return f": {NOT_KNOWN}"
    if record["rotations"] is None:
        return ""
    if _stays(record, motion):
        return ": 0"
    angle = abs(record["rotations"][motion])
    return f": {with_unit(with_bar(angle, error_of(record, 'rotation', name)), 'rad')}"


def _stays(record: JsonObject, motion: int) -> bool:
    """Whether a free motion is zero but for round-off."""
    angle = abs(record["rotations"][motion])
    moved = zero_if_negligible(angle * coordinate_size(record), record["scales"]["displacement"])
    return not moved or angle <= _least_angle(record)


def _least_angle(record: JsonObject) -> float:
    """Angle [rad] up to which a rotation is round-off."""
    pressure = np.array(record["pressure"])
    pressed = pressure > NEGLIGIBLE * pressure.max()
    return angle_of_round_off(np.array(record["nodes"]), np.array(record["normals"]), pressed) if pressed.any() else 0.0


def _in_sense(name: str, record: JsonObject, motion: int) -> str:
    """Name of a free motion, with the sense in which it turns; without one where the amount is not known."""
    angles = record["rotations"]
    if name in record["unknown_motions"]:
        return re.sub(r"(counter)?clockwise ", "", name)
    if angles is None or not angles[motion] < 0 or _stays(record, motion):
        return name
    return re.sub(r"(counter)?clockwise", lambda sense: "clockwise" if sense[1] else "counterclockwise", name)


def _tool(record: JsonObject, tool: JsonObject, size: float, pressed: float, moves: float, units: Units) -> str:
    """Displacement of a tool, and the force and moment of the body on it."""
    moved, turned = UNKNOWN_AMOUNT, UNKNOWN_AMOUNT
    if tool["displacement"] is not None:
        bar = error_of(record, "motion", tool["name"])
        error = None if bar is None else bar * float(np.hypot(*tool["displacement"]))
        moved = vector_with_error(tool["displacement"], error, units.length, moves)
    if tool["rotation"] is not None:
        turn = zero_if_negligible(tool["rotation"] * size, moves) / (size or 1.0)
        turn = turn if not tool["free"][2] or abs(turn) > _least_angle(record) else 0.0
        turned = with_unit(with_bar(turn, error_of(record, "rotation", tool["name"])), "rad")
    components = zip(tool["force_of_body"], tool["free"][:2], strict=True)
    is_load = all(free or not zero_if_negligible(component, pressed) for component, free in components)
    errors = [force_errors(record, zone) for zone in tool["zones"]]
    error = None if is_load or [] in errors else sum(map(sum, errors))
    force = vector_with_error(tool["force_of_body"], error or None, units.line_force, pressed)
    moment = moment_in_words(tool["moment_of_body"], None if tool["free"][2] else error or None, record, units)
    about = vector(tool["point"])
    return (
        f"{tool['name']}: moves by {moved}, turns by {turned}; the body presses on it with {force}, moment {moment} "
        f"about {about}"
    )


def coordinate_size(record: JsonObject) -> float:
    """Largest coordinate of a contact point [L], the scale of round-off in coordinates."""
    return max((abs(x) for point in record["nodes"] for x in point), default=0.0)


def pressed_by(record: JsonObject) -> float:
    """Sum of the magnitudes of all contact forces [p L], the scale of round-off in forces; infinity without contact."""
    if not record["intervals"]:
        return np.inf
    return sum(w * abs(p) for w, p in zip(record["tributary_lengths"], record["pressure"], strict=True))


def peak_place(record: JsonObject, units: Units) -> str:
    """Write where the largest pressure acts, if any."""
    places = _peak_places(record, units)
    return " and ".join(filter(None, (", ".join(places[:-1]), *places[-1:])))


def _peak_places(record: JsonObject, units: Units) -> list[str]:
    """Places where the largest pressure acts, if any; what is small beside the shortest contact is zero.

    All places are named where it is equal within its error. Where the pressure is the same at all points of contact of
    a zone, the place would be that of round-off. An infinite pressure has one place in each zone.
    """
    error, several, scale = peak_bar(record) or 0.0, len({*record["zone"]}) > 1, resolved_size(record)
    if infinite_peaks(record):
        at = [bar["at"] for bar in bars_of(record, "peak") if bar["value"] is None and bar["at"]]
        places = [vector(place, units.length, scale=scale) for place in at]
    elif not record["peak"]:
        return []
    else:
        level = level_zones(record, error)
        places = [f"all along {zone if several else 'the contact'}" for zone in level]
        for i in equal_peaks(record, error):
            if record["zone"][i] not in level:
                places.append(vector(record["nodes"][i], units.length, scale=scale))
    places = [*dict.fromkeys(places)]
    if len(places) > MOST_PLACES:
        places = [*places[: MOST_PLACES - 1], f"{len(places) - MOST_PLACES + 1} more places"]
    return places


def resolved_size(record: JsonObject) -> float:
    """Size [L] beside which a coordinate of a place in contact is round-off, or small beside the shortest contact."""
    lengths = [last - first for first, last in (interval["arc"] for interval in record["intervals"]) if last > first]
    return max(coordinate_size(record), UNRESOLVED * min(lengths, default=0.0) / NEGLIGIBLE)


def _span(interval: JsonObject, along: str, size: float, units: Units) -> str:
    """Ends and length of an interval of contact, which is written as `along`."""
    first, last = interval["arc"]
    length = last - first
    far = max(map(abs, (*interval["start"], *interval["end"])))
    figures = 5 if length == 0 else int(np.clip(np.ceil(np.log10(max(far / length, 1.0))) + 2, 5, MOST_FIGURES))
    start = vector(interval["start"], scale=size, figures=figures)
    end = vector(interval["end"], units.length, scale=size, figures=figures)
    if length == 0:
        return f"at the point {end} alone"
    all_round = np.allclose(interval["start"], interval["end"], rtol=0, atol=ROUND_OFF * length)
    return f"all round, {along}" if all_round else f"{start} to {end}, {along} long"


def zone_forces(record: JsonObject, units: Units) -> dict[str, str]:
    """Write the force of each contact on the body with its error: ``{"foot": "(0, 3.00) ± 0.02 N/mm"}``."""
    return {zone: _force(force, record, zone, units) for zone, force in record["forces"].items()}


def forces_on_bodies(record: JsonObject, units: Units) -> dict[str, str]:
    """Write the force of each contact, with the body on which it acts if there are several."""
    sides = record["sides"]
    return {
        zone: f"{force} on {sides[zone][0]}" if sides else force for zone, force in zone_forces(record, units).items()
    }


def total_force(record: JsonObject, units: Units) -> tuple[str, str]:
    """Name and write the force of all rigid surfaces on the body; of several bodies, the largest force of a contact.

    Forces of contacts between several bodies act on different ones: their sum means nothing.
    """
    if not record["sides"]:
        return "Force on the body", _force(record["resultant"], record, None, units)
    zone = max(record["forces"], key=lambda name: float(np.hypot(*record["forces"][name])))
    return f"Force of {zone} on {record['sides'][zone][0]}", _force(record["forces"][zone], record, zone, units)


def _force(components: tuple[float, float], record: JsonObject, zone: str | None, units: Units) -> str:
    """Write a force with the error of that of a zone, or of all zones if none is named.

    The resultant on a body that nothing else holds is that of its loads: it has no error.
    """
    unit, pressed = units.line_force, pressed_by(record)
    if zone is None and {*TRANSLATIONS} <= {*record["motion_names"]}:
        return vector(components, unit, scale=pressed)
    errors = force_errors(record, zone)
    return vector_with_error(components, sum(errors) if errors else None, unit, pressed)


def force_errors(record: JsonObject, zone: str | None = None) -> list[float]:
    """Errors of the force of a zone, or of all that press [p L]; none if one of them is not known."""
    bars = [bar for bar in bars_of(record, "force") if zone in (bar["zone"], None) and bar["value"]]
    known = [abs(bar["value"]) * bar["bar"] for bar in bars if bar["bar"] is not None]
    return known if len(known) == len(bars) else []


def scores_in_words(
    scores: Sequence[JsonObject], references: Sequence[JsonObject], units: Units
) -> Iterator[dict[str, str]]:
    """Write each computed quantity, the expected value and the verdict."""
    by_name = {item["name"]: item for item in references}
    for score in scores:
        unit = _unit_of(score["quantity"], by_name[score["reference"]], units)
        verdict = score_verdict(score)
        yield {
            "reference": score["reference"],
            "quantity": score["quantity"],
            "unit": unit,
            "computed": NOTHING if score["computed"] is None else with_unit(number(score["computed"]), unit),
            "expected": with_unit(number(score["expected"]), unit),
            "difference": percent(score["difference"]),
            "tolerance": f"{100 * score['tolerance']:.3g} %",
            "verdict": verdict,
            "color": QUALITIES[verdict],
        }


def score_verdict(score: JsonObject) -> str:
    """Whether a quantity is within the tolerance of its reference, in words."""
    return "not judged" if not score["judged"] else "holds" if score["holds"] else "does not hold"


def _unit_of(quantity: str, reference: JsonObject, units: Units) -> str:
    """Label of the unit of a quantity of a reference."""
    if quantity == "resultant":
        return units.line_force
    if quantity == "peak" or quantity.startswith("pressure"):
        return units.stress
    angle = reference["against"] == "angle" and quantity.endswith("of contact")
    return "°" if angle else units.length


def small(value: float | None) -> str:
    """Write two figures of a number whose size is all that matters."""
    if not value:
        return NOTHING if value is None else "0"
    return f"{value:.2g}" if PLAIN[0] <= abs(value) < PLAIN[1] else f"{value:.1e}"


def percent(value: float | None) -> str:
    """Write a relative number with three figures; round-off is zero."""
    if value is None:
        return NOTHING
    return f"{100 * value:.3g} %" if abs(value) > ROUND_OFF else "0 %"
