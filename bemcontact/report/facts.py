"""Facts of a result in words, from its JSON, for the terminal and for pages."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from bemcontact.problem import Units
from bemcontact.report.formatting import number, per_thickness, settled, vector, with_unit

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


def facts(record: Record, units: Units) -> Iterator[tuple[str, str]]:
    """List name and value of each fact of a record: contact, peak, resultants, free motions, tools and residuals."""
    size, pressed, moves = size_of(record), pressed_by(record), record["scales"]["displacement"]
    if not record["intervals"]:
        yield "Contact", "nowhere"
    for interval in record["intervals"]:
        yield "Contact", f"{interval['zone']}: {span(interval, size, units)}"
    if peak := record["peak"]:
        yield "Peak pressure", f"{peak_in_words(peak, size, units)}; per UNDEFORMED length"
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


def peak_in_words(peak: Record, size: float, units: Units) -> str:
    """Write the largest pressure, and where it acts."""
    return f"{with_unit(number(peak['pressure']), units.stress)} at {vector(peak['at'], units.length, scale=size)}"


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
