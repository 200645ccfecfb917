"""Facts of a result in words, from its JSON, for the terminal and for pages."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from bemcontact.problem import Units
from bemcontact.report.formatting import number, per_thickness, sentence_case, settled, vector, with_unit

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


QUANTITIES = {
    "peak": "peak pressure", "force": "force", "start": "start of contact", "end": "end of contact",
    "pressure": "pressure", "displacement": "largest displacement", "intensity": "intensity",
}  # fmt: skip
"""Name of a quantity with an error bar -> the same in words."""


class Verdict(NamedTuple):
    """A verdict on the equations or on the mesh: whether it is good, in a word, and in sentences."""

    of: str
    good: bool
    word: str
    words: str


def equations_verdict(certificate: Record, words: str, penetration: Record | None = None) -> Verdict:
    """Verdict on the solution of the equations on the mesh, with its sentences, and on what penetrates a surface."""
    if penetration is not None:
        return Verdict(
            "Equations", False, "penetrates a surface", f"{penetration['words']} At the contact points: {words}"
        )
    kind: str = certificate["kind"]
    word = {"unique": "unique solution proved", "not a solution": "not solved"}.get(kind, kind)
    return Verdict("Equations", kind == "unique", word, words)


def mesh_verdict(accuracy: Record) -> Verdict:
    """Verdict on the errors of the mesh."""
    asked, reason = accuracy["asked"], accuracy["reason"]
    if accuracy["met"] is None:
        return Verdict("Mesh", asked is None, "not assessed", f"{sentence_case(reason)}.")
    largest = worst_bar(accuracy)
    error = "no error bar" if largest is None else f"{100 * (largest['bar'] or 0):.2g} %"
    where = "" if largest is None else f" of the {bar_in_words(largest)}"
    if accuracy["met"]:
        return Verdict(
            "Mesh", True, f"error at most {error}", f"Asked: {100 * asked:.3g} %. The largest error bar is that{where}."
        )
    estimate = f"error about {error}{where}"
    if largest is not None and largest["bar"] is None:
        estimate = f"the error{where} is not known: {largest['note']}"
    remedy = f"; {reason}" if reason else "; leave elements out, or give --accuracy, and a mesh is found"
    return Verdict("Mesh", False, "not met", f"Asked: {100 * asked:.3g} %; {estimate}{remedy}.")


def worst_bar(accuracy: Record) -> Record | None:
    """The largest error bar of those to which the accuracy applies, an unknown one first; None if there is none."""
    judged = [bar for bar in accuracy["bars"] if bar["quantity"] != "intensity"]
    judged = [bar for bar in judged if bar["bar"] is not None or (bar["value"] and bar["quantity"] != "force")]
    return max(judged, key=lambda bar: np.inf if bar["bar"] is None else bar["bar"], default=None)


def bar_in_words(bar: Record) -> str:
    """Name a quantity and its zone: ``peak pressure of foot``."""
    return QUANTITIES[bar["quantity"]] + (f" of {bar['zone']}" if bar["zone"] else "")


def bars_of(record: Record, quantity: str) -> Iterator[Record]:
    """Error bars of a quantity."""
    return (bar for bar in record.get("accuracy", {}).get("bars", ()) if bar["quantity"] == quantity)


def with_bar(value: float, bar: float | None) -> str:
    """Write a number and its error: 183.3 ± 0.4; the number has the digits that the error leaves."""
    if not bar or not value:
        return number(value)
    error = abs(value) * bar
    digits = max(0, min(12, -int(np.floor(np.log10(error)))))
    if 1e-3 <= abs(value) < 1e6 and digits <= 6 and error < abs(value):
        return f"{value:.{digits}f} ± {error:.{digits}f}"
    return f"{number(value)} ± {error:.1g}"


def facts(record: Record, units: Units) -> Iterator[tuple[str, str]]:
    """List name and value of each fact of a record: contact, peak, resultants, free motions, tools and residuals."""
    size, pressed, moves = size_of(record), pressed_by(record), record["scales"]["displacement"]
    if not record["intervals"]:
        yield "Contact", "nowhere"
    for interval, error in zip(record["intervals"], _end_errors(record), strict=False):
        ends = f", ends ± {with_unit(small(error), units.length)}" if error else ""
        yield "Contact", f"{interval['zone']}: {span(interval, size, units)}{ends}"
    if peak := record["peak"]:
        bar = next((item["bar"] for item in bars_of(record, "peak") if item["value"] == peak["pressure"]), None)
        yield "Peak pressure", f"{peak_in_words(peak, size, units, bar)}; per UNDEFORMED length"
    for bar in bars_of(record, "peak"):
        if bar["value"] is None:
            yield "Peak pressure", f"of {bar['zone']}: {bar['note']}"
    for bar in bars_of(record, "intensity"):
        if bar["value"] is not None:
            yield "Intensity", f"of {bar['zone']}: K = {with_bar(bar['value'], bar['bar'])} in {bar['note']}"
    for bar in bars_of(record, "displacement"):
        yield "Displacement", f"{with_unit(with_bar(bar['value'], bar['bar']), units.length)} at most"
    force = vector(record["resultant"], per_thickness(units), scale=pressed)
    moment = with_unit(number(settled(record["resultant_moment"], pressed * size)), units.force)
    yield "Resultant", f"{force}, of the rigid surfaces on the body; moment {moment} about (0, 0)"
    for zone in zone_forces(record, units):
        yield "Resultant", f"of {zone}"
    for name, amplitude in zip(record["motion_names"], record["rigid_amplitudes"], strict=True):
        if " of the tool " in name:
            continue  # its line tells where it is
        # the amplitude of a rotation is a displacement [L] at a distance that no reader knows
        moved = f": {with_unit(number(settled(amplitude, moves)), units.length)}" * name.startswith("translation")
        yield "Free motion", f"{name}{moved}"
    for tool in record["tools"]:
        yield "Tool", _tool(tool, size, pressed, moves, units)
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


def _tool(tool: Record, size: float, pressed: float, moves: float, units: Units) -> str:
    """Displacement of a tool, and the force and moment of the body on it."""
    moved = vector(tool["displacement"], units.length, scale=moves)
    turned = number(settled(tool["rotation"] * size, moves) / (size or 1.0))
    force = vector(tool["force_of_body"], per_thickness(units), scale=pressed)
    moment = with_unit(number(settled(tool["moment_of_body"], pressed * size)), units.force)
    about = vector(tool["point"])
    return (
        f"{tool['name']}: moves by {moved}, turns by {turned}; the body presses on it with {force}, moment {moment} "
        f"about {about}"
    )


def size_of(record: Record) -> float:
    """Largest coordinate of a contact point [L], the scale of round-off in coordinates."""
    return max((abs(x) for point in record["nodes"] for x in point), default=0.0)


def pressed_by(record: Record) -> float:
    """Sum of the magnitudes of all contact forces [p L], the scale of round-off in forces; infinity if none is more."""
    if not record["peak"]:
        return np.inf
    return sum(w * abs(p) for w, p in zip(record["tributary_lengths"], record["pressure"], strict=True))


def peak_in_words(peak: Record, size: float, units: Units, bar: float | None = None) -> str:
    """Write the largest pressure, its error, and where it acts."""
    value = with_unit(with_bar(peak["pressure"], bar), units.stress)
    return f"{value} at {vector(peak['at'], units.length, scale=size)}"


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


def zone_forces(record: Record, units: Units) -> Iterator[str]:
    """Write the force of each rigid surface on the body, where there are several: ``foot: (0, 3) N/mm``."""
    zones = [*dict.fromkeys(record["zone"])]
    if len(zones) < 2:
        return
    forces = np.multiply(record["tributary_lengths"], record["pressure"])[:, None] * np.array(record["normals"])
    scale = float(np.abs(forces).sum())
    for zone in zones:
        x, y = forces[np.array(record["zone"]) == zone].sum(axis=0).tolist()
        yield f"{zone}: {vector((x, y), per_thickness(units), scale=scale)}"


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
