"""Error bars, and numbers with their errors, in words, from the JSON of a result."""

from collections.abc import Iterator, Sequence

import numpy as np

from bemcontact.problems import Units
from bemcontact.report.formatting import (
    JsonObject,
    number,
    sentence_case,
    vector,
    with_unit,
    zero_if_negligible,
)

NOTHING = "–"
"""Text for a missing number."""
ROUND_OFF = 1e-9
"""Relative difference that is written as zero."""
QUANTITIES = {
    "peak": "peak pressure", "force": "sum of contact forces", "start": "start of contact", "end": "end of contact",
    "length": "length of contact",
    "pressure": "pressure as a whole", "displacement": "largest displacement",
    "intensity": "intensity of the infinite pressure", "motion": "motion", "rotation": "rotation",
}  # fmt: skip
"""Name of a quantity with an error bar -> the same in words."""
LEAST_SHOWN = 1e-5
"""Least error that is written, relative: smaller ones are written as this one."""
TWO_FIGURES = 3.5
"""Leading figures of an error up to which it keeps two: 0.34, but 0.4; rounding up adds a quarter at most."""
BARS_ARE = (
    "Error bars are estimates, from the change of each quantity when every element is cut in two, or where a note says "
    "so from the difference of two meshes. They are not proved."
)
"""What an error bar is."""


def mesh_in_short(accuracy: JsonObject) -> str:
    """Error of a mesh, for a column of a table: ``0.4 %``, ``not met: 30 %``, ``not assessed``."""
    if accuracy["met"] is None:
        return "not assessed"
    largest = worst_bar(accuracy)
    error = "not known" if largest is not None and largest["bar"] is None else error_percent((largest or {}).get("bar"))
    return error if accuracy["met"] else f"not met: {error}"


def worst_bar(accuracy: JsonObject) -> JsonObject | None:
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


def bar_in_words(bar: JsonObject) -> str:
    """Name a quantity and its zone: ``peak pressure of foot``."""
    return QUANTITIES[bar["quantity"]] + (f" of {bar['zone'] or bar['mover']}" if bar["zone"] or bar["mover"] else "")


def bars_of(record: JsonObject, quantity: str) -> Iterator[JsonObject]:
    """Error bars of a quantity."""
    return (bar for bar in record.get("accuracy", {}).get("bars", ()) if bar["quantity"] == quantity)


def error_of(record: JsonObject, quantity: str, owner: str) -> float | None:
    """Relative error of a quantity of a zone, a tool or a free motion; None if it is not known."""
    return next((bar["bar"] for bar in bars_of(record, quantity) if owner in (bar["zone"], bar["mover"])), None)


def infinite_peaks(record: JsonObject) -> dict[str, str]:
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


def with_error(value: float, error: float, size: float | None = None) -> str:
    """Write a number and its error: 183.3 ± 0.4; the error is rounded up, and the number has no digit beyond it.

    The least error that is written is relative to the `size`, or to the number.
    """
    if not value and not error:
        return number(value)
    (written,), shown, power = _rounded((value,), error, size)
    return f"({written} ± {shown}){_exponent(power)}" if power else f"{written} ± {shown}"


def vector_with_error(components: tuple[float, float], error: float | None, unit: str, scale: float) -> str:
    """Write a vector and its error: (0.090, 16.211) ± 0.014 N/mm; what is negligible beside the scale is zero."""
    x, y = (zero_if_negligible(value, scale) for value in components)
    if error is None or not (x or y):
        return vector((x, y), unit, scale=scale)
    (x_written, y_written), shown, power = _rounded((x, y), error)
    written = f"({x_written}, {y_written}) ± {shown}"
    return with_unit(f"({written}){_exponent(power)}" if power else written, unit)


def _rounded(values: Sequence[float], error: float, size: float | None = None) -> tuple[list[str], str, int]:
    """Numbers and their error over a power of ten: the error rounded up, and no number with a digit beyond it."""
    largest = max(map(abs, values))
    power = int(np.floor(np.log10(max(largest, error))))
    power = 0 if -4 <= power < 6 else power
    error = max(error, LEAST_SHOWN * (largest if size is None else size)) / 10.0**power
    first = int(np.floor(np.log10(error) + ROUND_OFF))
    two_figures = error < TWO_FIGURES * 10.0**first and abs(error / 10.0**first % 1) > ROUND_OFF
    place = first - two_figures
    shown = np.ceil(error / 10.0**place * (1 - ROUND_OFF)) * 10.0**place
    digits = max(0, -place)
    rounded = (round(value / 10.0**power, -place) for value in values)
    return [f"{value:.{digits}f}" if value else "0" for value in rounded], f"{shown:.{digits}f}", power


def error_alone(error: float) -> str:
    """Write an error as it stands behind a number: 0.0008."""
    _, shown, power = _rounded((error,), error)
    return error_alone(10.0 ** (power + 1)) if power and float(shown) == 10 else shown + _exponent(power)


def _exponent(power: int) -> str:
    return f"e{power:+03d}" if power else ""


def accuracy_rows(accuracy: JsonObject, units: Units) -> Iterator[dict[str, str]]:
    """Write each quantity with its error bar, the share of the accuracy asked, and what is noted, for a table."""
    asked, bars = accuracy["asked"], accuracy["bars"]
    lengths = _interval_lengths(bars)
    for bar in bars:
        error = bar["bar"]
        of_end = bar["quantity"] in ("start", "end")
        size = lengths.get((bar["zone"], bar["interval"]), 0.0) if of_end else abs(bar["value"] or 0.0)
        interval = f" {bar['interval'] + 1}" if bar["interval"] is not None and _several(bars, bar) else ""
        over = error is not None and asked and bar["promised"] and error > asked
        share = "not known" if error is None else f"{float(f'{100 * error / (asked or 1.0):.2g}'):g} %"
        yield {
            "quantity": sentence_case(QUANTITIES[bar["quantity"]]) + interval,
            "zone": bar["zone"] or bar["mover"] or NOTHING,
            "value": _bar_value(bar, size, units),
            "share": share if asked and bar["promised"] else NOTHING,
            "color": "bad" if over else "",
            "note": sentence_case(f"{bar['note']} {_at(bar, units)}".strip()),
        }


def _at(bar: JsonObject, units: Units) -> str:
    """Where an error bar belongs to; empty if to no place."""
    return f"at {vector(bar['at'], units.length)}" if bar["at"] else ""


def _bar_value(bar: JsonObject, size: float, units: Units) -> str:
    """Write a quantity and its error relative to a size, with the unit."""
    value, error = bar["value"], bar["bar"]
    if value is None and error is not None:
        return f"± {error_percent(error)}"
    if value is None:
        return "infinite" if bar["quantity"] == "peak" else NOTHING
    return with_unit(with_error(value, error * size, size) if error else number(value), unit_of_bar(bar, units))


def _interval_lengths(bars: Sequence[JsonObject]) -> dict[tuple[str, int], float]:
    """Length of each contact interval, by zone and number, to which the errors of its ends are relative."""
    return {(bar["zone"], bar["interval"]): bar["value"] for bar in bars if bar["quantity"] == "length"}


def _several(bars: Sequence[JsonObject], bar: JsonObject) -> bool:
    """Whether a zone has several contact intervals."""
    return any(other["zone"] == bar["zone"] and (other["interval"] or 0) > 0 for other in bars)


def unit_of_bar(bar: JsonObject, units: Units) -> str:
    """Label of the unit of a quantity with an error bar; K of p = K s^-α has that of p times a length to the α."""
    match bar["quantity"]:
        case "peak" | "pressure":
            return units.stress
        case "force":
            return units.line_force
        case "intensity":
            return f"{units.stress}·{units.length}^{bar['note'].rpartition('s^-')[2]}" if units.stress else ""
        case "rotation":
            return "rad"
    return units.length
