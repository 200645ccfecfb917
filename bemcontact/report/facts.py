"""Facts of a result in words, from its JSON, for the terminal and for pages."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from bemcontact.problem import Units
from bemcontact.report.formatting import (
    NEGLIGIBLE,
    number,
    per_thickness,
    sentence_case,
    vector,
    with_unit,
    zero_if_negligible,
)

Record = Mapping[str, Any]
"""A JSON object of a result."""
RESIDUALS = ("penetration", "tension", "complementarity", "equilibrium", "force_balance")
"""Residuals that are listed."""
QUALITIES = {"holds": "good", "does not hold": "bad", "not judged": "fair"}
"""Verdict on a quantity of a reference -> quality."""
NOTHING = "–"
"""Text for a missing number."""
PLAIN = 0.01, 1000.0
"""Range of numbers that are written without a power of ten."""
ROUND_OFF = 1e-9
"""Relative difference that is written as zero."""
UNRESOLVED = 1e-3
"""Share of the length of contact below which no place in it is resolved."""


QUANTITIES = {
    "peak": "peak pressure", "force": "sum of contact forces", "start": "start of contact", "end": "end of contact",
    "pressure": "pressure as a whole", "displacement": "largest displacement",
    "intensity": "intensity of the infinite pressure", "motion": "motion", "rotation": "rotation",
}  # fmt: skip
"""Name of a quantity with an error bar -> the same in words."""
LEAST_SHOWN = 1e-5
"""Least error that is written, relative: smaller ones are written as this one."""
BARS_ARE = (
    "Error bars are estimates, from the change of each quantity when every element is cut in two. They are not proved."
)
"""What an error bar is."""


def mesh_in_short(accuracy: Record) -> str:
    """Error of a mesh, for a column of a table: ``0.4 %``, ``not met: 30 %``, ``not assessed``."""
    if accuracy["met"] is None:
        return "not assessed"
    largest = worst_bar(accuracy)
    error = "not known" if largest is not None and largest["bar"] is None else error_percent((largest or {}).get("bar"))
    return error if accuracy["met"] else f"not met: {error}"


def worst_bar(accuracy: Record) -> Record | None:
    """The largest error bar of those to which the accuracy applies, an unknown one first; None if there is none.

    The first of those that are too small to be written, so that round-off does not choose.
    """
    judged = [bar for bar in accuracy["bars"] if bar["promised"]]
    return max(judged, key=lambda bar: np.inf if bar["bar"] is None else max(bar["bar"], LEAST_SHOWN), default=None)


def error_percent(error: float | None) -> str:
    """A relative error in per cent, rounded up to two figures: 0.41 %."""
    error = max(error or 0.0, LEAST_SHOWN)
    power = 10.0 ** (np.floor(np.log10(100 * error)) - 1)
    return f"{power * np.ceil(100 * error / power * (1 - ROUND_OFF)):.3g} %"


def bar_in_words(bar: Record) -> str:
    """Name a quantity and its zone: ``peak pressure of foot``."""
    return QUANTITIES[bar["quantity"]] + (f" of {bar['zone'] or bar['mover']}" if bar["zone"] or bar["mover"] else "")


def bars_of(record: Record, quantity: str) -> Iterator[Record]:
    """Error bars of a quantity."""
    return (bar for bar in record.get("accuracy", {}).get("bars", ()) if bar["quantity"] == quantity)


def infinite_peaks(record: Record) -> dict[str, str]:
    """Zones whose peak pressure is infinite, with the reason."""
    return {bar["zone"]: bar["note"] for bar in bars_of(record, "peak") if bar["value"] is None}


def with_bar(value: float, bar: float | None) -> str:
    """Write a number and its relative error: 183.3 ± 0.4."""
    return number(value) if bar is None or not value else with_error(value, abs(value) * bar)


def without_digits_beyond(value: float, bar: float | None) -> str:
    """Write a number alone, with the digits that a relative error leaves: 183.3."""
    if bar is None or not value:
        return number(value)
    (written,), _, power = _rounded((value,), abs(value) * bar)
    return f"{written}{_exponent(power)}"


def with_error(value: float, error: float) -> str:
    """Write a number and its error: 183.3 ± 0.4; the error is rounded up, and the number has no digit beyond it."""
    if not value and not error:
        return number(value)
    (written,), shown, power = _rounded((value,), error)
    return f"({written} ± {shown}){_exponent(power)}" if power else f"{written} ± {shown}"


def _rounded(values: Sequence[float], error: float) -> tuple[list[str], str, int]:
    """Numbers and their error over a power of ten: the error rounded up, and no number with a digit beyond it."""
    largest = max(map(abs, values))
    power = int(np.floor(np.log10(largest))) if largest else 0
    power = 0 if -4 <= power < 6 else power
    error = max(error, LEAST_SHOWN * largest) / 10.0**power
    first = int(np.floor(np.log10(error) + ROUND_OFF))
    place = first - 1 if error < 2 * 10.0**first else first  # 0.14 keeps two figures, 0.4 one
    shown = np.ceil(error / 10.0**place * (1 - ROUND_OFF)) * 10.0**place
    digits = max(0, -place)
    rounded = (round(value / 10.0**power, -place) for value in values)
    return [f"{value:.{digits}f}" if value else "0" for value in rounded], f"{shown:.{digits}f}", power


def _exponent(power: int) -> str:
    return f"e{power:+03d}" if power else ""


def accuracy_rows(accuracy: Record, units: Units) -> Iterator[dict[str, str]]:
    """Write each quantity with its error bar, the share of the accuracy asked, and what is noted, for a table."""
    asked, bars = accuracy["asked"], accuracy["bars"]
    lengths = _interval_lengths(bars)
    for bar in bars:
        error = bar["bar"]
        size = abs(bar["value"] or 0.0) if bar["interval"] is None else lengths.get((bar["zone"], bar["interval"]), 0.0)
        interval = f" {bar['interval'] + 1}" if bar["interval"] is not None and _several(bars, bar) else ""
        over = error is not None and asked and bar["promised"] and error > asked
        share = "not known" if error is None else f"{100 * error / (asked or 1.0):.2g} %"
        yield {
            "quantity": sentence_case(QUANTITIES[bar["quantity"]]) + interval,
            "zone": bar["zone"] or bar["mover"] or NOTHING,
            "value": _bar_value(bar, size, units),
            "share": share if asked and bar["promised"] else NOTHING,
            "colour": "bad" if over else "",
            "note": bar["note"] if bar["quantity"] == "intensity" else sentence_case(bar["note"]),
        }


def _bar_value(bar: Record, size: float, units: Units) -> str:
    """Write a quantity and its error relative to a size, with the unit."""
    value, error = bar["value"], bar["bar"]
    if value is None and error is not None:
        return f"± {error_percent(error)}"
    if value is None:
        return "infinite" if bar["quantity"] == "peak" else NOTHING
    return with_unit(with_error(value, error * size) if error else number(value), _unit_of_bar(bar, units))


def _interval_lengths(bars: Sequence[Record]) -> dict[tuple[str, int], float]:
    """Length of each contact interval, by zone and number, to which the errors of its ends are relative."""
    ends = {(bar["quantity"], bar["zone"], bar["interval"]): bar["value"] for bar in bars}
    return {
        (zone, i): abs(ends["end", zone, i] - value)
        for (quantity, zone, i), value in ends.items()
        if quantity == "start" and ("end", zone, i) in ends
    }


def _several(bars: Sequence[Record], bar: Record) -> bool:
    """Whether a zone has several contact intervals."""
    return any(other["zone"] == bar["zone"] and (other["interval"] or 0) > 0 for other in bars)


def _unit_of_bar(bar: Record, units: Units) -> str:
    """Label of the unit of a quantity with an error bar; K of p = K s^-α has that of p times a length to the α."""
    match bar["quantity"]:
        case "peak" | "pressure":
            return units.stress
        case "force":
            return per_thickness(units)
        case "intensity":
            return f"{units.stress}·{units.length}^{bar['note'].rpartition('s^-')[2]}" if units.stress else ""
        case "rotation":
            return "rad"
    return units.length


def peak_of(record: Record, units: Units) -> str:
    """The largest pressure with its error in a few words: a number, ``infinite``, or ``no contact``."""
    if infinite_peaks(record):
        return "infinite"
    if peak := record["peak"]:
        return with_unit(with_bar(peak["pressure"], peak_bar(record)), units.stress) + _unknown_error(record)
    return "no contact"


def _unknown_error(record: Record) -> str:
    """Words behind a largest pressure whose error was looked for and is not known; else nothing."""
    sought = record.get("accuracy", {}).get("met") is False
    return "; error not known" * (sought and peak_bar(record) is None)


def peak_bar(record: Record) -> float | None:
    """Error of the largest pressure of all zones."""
    bars = [item for item in bars_of(record, "peak") if item["value"] is not None]
    return max(bars, key=lambda item: item["value"], default={"bar": None})["bar"]


def _peaks(record: Record, units: Units) -> Iterator[tuple[str, str]]:
    """Write the largest pressure; where that of a zone is infinite, each zone by itself."""
    infinite = infinite_peaks(record)
    if not infinite and (peak := record["peak"]):
        value = with_unit(with_bar(peak["pressure"], peak_bar(record)), units.stress)
        words = f"{value} at {peak_place(record, units)}{_unknown_error(record)}"
        yield "Peak pressure", f"{words}; per UNDEFORMED length"
    if infinite:
        for bar in bars_of(record, "peak"):
            written = (
                bar["note"] if bar["value"] is None else with_unit(with_bar(bar["value"], bar["bar"]), units.stress)
            )
            yield "Peak pressure", f"of {bar['zone']}: {written}"


def facts(record: Record, units: Units) -> Iterator[tuple[str, str]]:
    """List name and value of each fact of a record: contact, peak, resultants, free motions, tools and residuals."""
    size, pressed, moves = coordinate_size(record), pressed_by(record), record["scales"]["displacement"]
    if not record["intervals"]:
        held = "" if record["motion_names"] else ", and the supports alone hold the body"
        yield "Contact", f"nowhere: the body presses on no rigid surface{held}"
    for interval, error in zip(record["intervals"], _end_errors(record), strict=False):
        ends = f", ends ± {with_unit(small(error), units.length)}" if error else ""
        yield "Contact", f"{interval['zone']}: {span(interval, size, units)}{ends}"
    for zone in dict.fromkeys(record["zone"]):
        if record["intervals"] and zone not in [interval["zone"] for interval in record["intervals"]]:
            yield "Contact", f"{zone}: nowhere"
    yield from _peaks(record, units)
    for bar in bars_of(record, "intensity"):
        if bar["value"] is not None:
            value = with_unit(with_bar(bar["value"], bar["bar"]), _unit_of_bar(bar, units))
            yield "Intensity", f"of {bar['zone']}: K = {value} in {bar['note']}"
    for bar in bars_of(record, "displacement"):
        yield "Displacement", f"{with_unit(with_bar(bar['value'], bar['bar']), units.length)} at most"
    force = _force(record["resultant"], record, None, units)
    moment = with_unit(number(zero_if_negligible(record["resultant_moment"], pressed * size)), units.force)
    yield "Resultant", f"{force}, of the rigid surfaces on the body; moment {moment} about (0, 0)"
    forces = zone_forces(record, units)
    for zone, written in forces.items() if len(forces) > 1 else ():
        yield "Resultant", f"of {zone}: {written}"
    for j, name in enumerate(record["motion_names"]):
        if " of the tool " not in name:  # the line of a tool tells where it is
            yield "Free motion", f"{_in_sense(name, record, j)}{_amount(record, j, units)}"
    for tool in record["tools"]:
        yield "Tool", _tool(record, tool, size, pressed, moves, units)
    residuals = ((name, record["residuals"][name]) for name in RESIDUALS)
    written = (f"{name.replace('_', ' ')} {value + 0.0:.1e}" for name, value in residuals if value is not None)
    yield "Residuals", ", ".join(written)


def _end_errors(record: Record) -> Iterator[float | None]:
    """Largest error of the ends of each contact interval [L]; None if it is not known."""
    bars = [*bars_of(record, "start"), *bars_of(record, "end")]
    count: Counter[str] = Counter()
    for interval in record["intervals"]:
        zone, (first, last) = interval["zone"], interval["arc"]
        own = [bar["bar"] for bar in bars if (bar["zone"], bar["interval"]) == (zone, count[zone])]
        count[zone] += 1
        yield None if not own or None in own else max(own) * (last - first)


def _amount(record: Record, motion: int, units: Units) -> str:
    """How far the body moves along a free motion: a length, or an angle; nothing where the unit is not known."""
    moved, angles = record["rigid_amplitudes"][motion], record["rotations"]
    if not zero_if_negligible(moved, record["scales"]["displacement"]):
        return ": 0"
    if angles is None:
        return ""
    angle = angles[motion]
    bar = _bar_of_motion(record, "rotation" if angle else "motion", record["motion_names"][motion])
    unit = "rad" if angle else units.length
    return f": {with_unit(with_bar(abs(angle) if angle else moved, bar), unit)}"


def _bar_of_motion(record: Record, quantity: str, mover: str) -> float | None:
    """Error bar of a motion or a rotation; None if it is not known."""
    return next((bar["bar"] for bar in bars_of(record, quantity) if bar["mover"] == mover), None)


def _in_sense(name: str, record: Record, motion: int) -> str:
    """Name of a free motion, with the sense in which it turns."""
    angles = record["rotations"]
    if angles is None or not angles[motion] < 0:
        return name
    return re.sub(r"(counter)?clockwise", lambda sense: "clockwise" if sense[1] else "counterclockwise", name)


def _tool(record: Record, tool: Record, size: float, pressed: float, moves: float, units: Units) -> str:
    """Displacement of a tool, and the force and moment of the body on it."""
    bar = _bar_of_motion(record, "motion", tool["name"])
    error = None if bar is None else bar * float(np.hypot(*tool["displacement"]))
    moved = _with_error(tool["displacement"], error, units.length, moves)
    turn = zero_if_negligible(tool["rotation"] * size, moves) / (size or 1.0)
    turned = with_unit(with_bar(turn, _bar_of_motion(record, "rotation", tool["name"])), "rad")
    force = vector(tool["force_of_body"], per_thickness(units), scale=pressed)
    moment = with_unit(number(zero_if_negligible(tool["moment_of_body"], pressed * size)), units.force)
    about = vector(tool["point"])
    return (
        f"{tool['name']}: moves by {moved}, turns by {turned}; the body presses on it with {force}, moment {moment} "
        f"about {about}"
    )


def coordinate_size(record: Record) -> float:
    """Largest coordinate of a contact point [L], the scale of round-off in coordinates."""
    return max((abs(x) for point in record["nodes"] for x in point), default=0.0)


def pressed_by(record: Record) -> float:
    """Sum of the magnitudes of all contact forces [p L], the scale of round-off in forces; infinity without contact."""
    if not record["intervals"]:
        return np.inf
    return sum(w * abs(p) for w, p in zip(record["tributary_lengths"], record["pressure"], strict=True))


def peak_place(record: Record, units: Units) -> str:
    """Write where the largest pressure acts, if any; what is small beside the shortest contact is zero."""
    if not record["peak"]:
        return ""
    lengths = [last - first for first, last in (interval["arc"] for interval in record["intervals"]) if last > first]
    unresolved = UNRESOLVED * min(lengths, default=0.0) / NEGLIGIBLE
    return vector(record["peak"]["at"], units.length, scale=max(coordinate_size(record), unresolved))


def span(interval: Record, size: float, units: Units) -> str:
    """Ends and length of an interval of contact."""
    first, last = interval["arc"]
    length = last - first
    start, end = vector(interval["start"], scale=size), vector(interval["end"], units.length, scale=size)
    if length == 0:
        return f"at the point {end} alone"
    along = with_unit(number(length), units.length)
    all_round = np.allclose(interval["start"], interval["end"], rtol=0, atol=ROUND_OFF * length)
    return f"all round, {along}" if all_round else f"{start} to {end}, {along} long"


def zone_forces(record: Record, units: Units) -> dict[str, str]:
    """Write the force of each rigid surface on the body with its error: ``{"foot": "(0, 3.00) ± 0.02 N/mm"}``."""
    forces = np.multiply(record["tributary_lengths"], record["pressure"])[:, None] * np.array(record["normals"])
    zones = np.array(record["zone"])
    return {
        zone: _force(forces[zones == zone].sum(axis=0).tolist(), record, zone, units)
        for zone in dict.fromkeys(record["zone"])
    }


def _force(components: tuple[float, float], record: Record, zone: str | None, units: Units) -> str:
    """Write a force with the error of that of a zone; that of the only zone if none is named."""
    unit, pressed = per_thickness(units), pressed_by(record)
    bars = [bar for bar in bars_of(record, "force") if zone in (bar["zone"], None)]
    errors = [abs(bar["value"]) * bar["bar"] for bar in bars if bar["value"] and bar["bar"] is not None]
    return _with_error(components, errors[0] if len(errors) == len(bars) == 1 else None, unit, pressed)


def _with_error(components: tuple[float, float], error: float | None, unit: str, scale: float) -> str:
    """Write a vector and its error: (0.090, 16.211) ± 0.014 N/mm; what is negligible beside the scale is zero."""
    x, y = (zero_if_negligible(value, scale) for value in components)
    if error is None or not (x or y):
        return vector((x, y), unit, scale=scale)
    (x_written, y_written), shown, power = _rounded((x, y), error)
    written = f"({x_written}, {y_written}) ± {shown}"
    return with_unit(f"({written}){_exponent(power)}" if power else written, unit)


def scores_in_words(scores: Sequence[Record], references: Sequence[Record], units: Units) -> Iterator[dict[str, str]]:
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
            "colour": QUALITIES[verdict],
        }


def score_verdict(score: Record) -> str:
    """Whether a quantity is within the tolerance of its reference, in words."""
    return "not judged" if not score["judged"] else "holds" if score["holds"] else "does not hold"


def _unit_of(quantity: str, reference: Record, units: Units) -> str:
    """Label of the unit of a quantity of a reference."""
    if quantity == "resultant":
        return per_thickness(units)
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
