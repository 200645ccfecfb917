"""The page that a study is read on: one self-contained HTML file, from `Study.to_dict` and pictures alone."""

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from bemcontact.problem import Units
from bemcontact.report.formatting import number, per_thickness, settled, vector, with_unit
from bemcontact.report.markup import NOTHING, Picture, Record, percent, picture, small, statement, template

OUTCOMES = {
    "solves it": "good",
    "solves it, perhaps not alone": "fair",
    "left open by round-off": "fair",
    "not the solution": "bad",
    "refused": "bad",
}
"""Outcome of a verdict -> how it is coloured."""

VERBS = {
    "solves it": ("{} finds the contact state", "{} find the contact state"),
    "solves it, perhaps not alone": ("{} finds a contact state", "{} find a contact state"),
    "left open by round-off": ("{} is left open", "{} are left open"),
    "not the solution": ("{} ends elsewhere", "{} end elsewhere"),
    "refused": ("{} is refused", "{} are refused"),
}
"""Outcome -> what is said of one, and of several."""
DIRECT = {
    "solves it": "is certified, and there is no other",
    "solves it, perhaps not alone": "meets all conditions, but they may have other solutions",
    "left open by round-off": "is left open by round-off",
    "not the solution": "is none",
}
"""Outcome of the direct solution -> what is said of it."""

MANY = 5
"""Contenders from which on they are counted and no longer listed at the head of the page."""

HISTORY = "history-"
"""What the names of the pictures of solvers begin with."""


def render(report: Record, pictures: Mapping[str, bytes], spec: str | None) -> str:
    """Write the page.

    Parameters
    ----------
    report : what `Study.to_dict` gives, or report.json holds
    pictures : name -> SVG, the names as of `bemcontact.report.figures.figures_of`; sections go without missing ones
    spec : text of the spec as run, if there is one

    Returns
    -------
    str
        HTML that needs no other file.
    """
    contents = _contents(report)
    return template("report.html", outcome=OUTCOMES.get).render(
        **contents,
        pictures={name: _picture(name, svg, contents["level"]) for name, svg in pictures.items()},
        courses=[name for name in pictures if name.startswith(HISTORY)],
        spec=spec,
    )


def _contents(report: Record) -> dict[str, Any]:
    """What the page says, by the names that the template has for it; the finest mesh gives the answer."""
    level = report["levels"][-1]
    compared = level["comparison"]
    contenders, reference = compared["contenders"], compared["reference"]
    units = Units(length=report["units"].get("length", ""), force=report["units"].get("force", ""))
    return {
        "report": report,
        "level": level,
        "compared": compared,
        "everyone": [*contenders, reference],
        "apart": {item["one"]: item for item in compared["differences"] if item["other"] == reference["label"]},
        "answer": reference["answer"],
        "units": {"p": units.stress, "L": units.length, "1": "", "force": per_thickness(units)},
        "verdict": _verdict(report, compared),
        "description": [" ".join(part.split()) for part in report["description"].split("\n\n") if part.strip()],
        "facts": [*_facts(level, units)],
        "scores": [*_scores(level, units)],
        "certificate": _certificate(reference["answer"], units),
        "penalties": {item["label"]: _penalty(item, units) for item in contenders},
        "acting": " + ".join(
            f"{factor:g} {case}" for case, factor in compared["contact"]["load_factors"].items() if factor
        ),
        "uncertified": [item["refine"] for item in report["levels"][:-1] if not item["comparison"]["certified"]],
        "stages": [*dict.fromkeys(stage for item in report["levels"] for stage in item["seconds"])],
    }


def _verdict(report: Record, compared: Record) -> str:
    """What the report says; of many contenders, how many of them."""
    if len(compared["contenders"]) < MANY:
        return report["verdict"]
    outcomes = Counter(item["verdict"]["outcome"] for item in compared["contenders"])
    direct = compared["reference"]["verdict"]["outcome"]
    told = ", ".join(f"{VERBS[outcome][count > 1].format(count)}" for outcome, count in outcomes.items())
    return f"Of {len(compared['contenders'])} settings {told}. The direct solution {DIRECT[direct]}."


def _facts(level: Record, units: Units) -> Iterator[tuple[str, str]]:
    """What the direct solution says, as what and how much."""
    compared = level["comparison"]
    contact, answer = compared["contact"], compared["reference"]["answer"]
    if answer is None:
        return
    size = max((abs(x) for point in contact["nodes"] for x in point), default=0.0)
    pressed = sum(w * abs(p) for w, p in zip(contact["tributary_lengths"], answer["pressure"], strict=True))
    peak = answer["peak"]
    if peak is None:
        yield "Contact", "nowhere"
    else:
        at = vector(peak["at"], units.length, scale=size)
        yield "Peak pressure", f"{with_unit(number(peak['pressure']), units.stress)} at {at}, per undeformed length"
    for item in answer["intervals"]:
        start, end = vector(item["start"], scale=size), vector(item["end"], units.length, scale=size)
        where = f"at the point {end} alone" if item["start"] == item["end"] else f"from {start} to {end}"
        yield f"Contact in {item['zone']}", where
    force = vector(answer["resultant"], per_thickness(units), scale=pressed)
    yield "Resultant", f"{force}, of the rigid surfaces on the body"
    moment = settled(answer["resultant_moment"], pressed * size)
    yield "Its moment about (0, 0)", with_unit(number(moment), units.force)
    for name, amplitude in zip(contact["motion_names"], answer["rigid_amplitudes"], strict=True):
        yield f"Free {name}", with_unit(number(amplitude), units.length if name.startswith("translation") else "")
    for tool in answer["tools"]:
        moved = vector(tool["displacement"], units.length, scale=contact["scales"]["displacement"])
        force = vector(tool["force_of_body"], per_thickness(units), scale=pressed)
        moment = with_unit(number(settled(tool["moment_of_body"], pressed * size)), units.force)
        turned = number(settled(tool["rotation"] * size, contact["scales"]["displacement"]) / (size or 1.0))
        about = vector(tool["point"], scale=size)
        yield (
            f"Tool {tool['name']}",
            f"moves by {moved}, turns by {turned}; the body presses on it with {force}, moment {moment} about {about}",
        )
    if level["force_balance"] is not None:
        yield "Force balance of the whole body", f"{small(level['force_balance'])} of the forces on it"


def _scores(level: Record, units: Units) -> Iterator[dict[str, str]]:
    """The answer beside the references, each number with its unit."""
    told = {item["name"]: item for item in level["references"]}
    for item in level["scores"]:
        quantity, reference = item["quantity"], told[item["reference"]]
        unit = unit_of_score(quantity, reference, units)
        verdict, colour = ("holds", "good") if item["holds"] else ("does not hold", "bad")
        if not item["judged"]:
            verdict, colour = "not judged", "fair"
        yield {
            "reference": item["reference"],
            "quantity": quantity,
            "found": NOTHING if item["found"] is None else with_unit(number(item["found"]), unit),
            "expected": with_unit(number(item["expected"]), unit),
            "difference": percent(item["difference"]),
            "tolerance": percent(item["tolerance"]),
            "verdict": verdict,
            "colour": colour,
        }


def unit_of_score(quantity: str, reference: Record, units: Units) -> str:
    """Label of the unit of a quantity, as of `Score`, of which a reference speaks."""
    if quantity == "resultant":
        return per_thickness(units)
    if quantity == "peak" or quantity.startswith("pressure"):
        return units.stress
    angle = reference["against"] == "angle" and quantity.endswith("of contact")
    return "°" if angle else units.length


def _certificate(answer: Record | None, units: Units) -> str:
    """What is proved of the direct solution, in two sentences for an engineer."""
    if answer is None:
        return "The direct solver has no answer. So there is nothing to certify."
    proved, left = answer["certificate"], answer["residuals"]
    eigenvalue, kind = proved["smallest_eigenvalue"], proved["kind"]
    if kind == "not a solution":
        return f"{proved['words']} So this is not an answer to rely on."
    names = ("penetration", "tension", "complementarity", "equilibrium")
    holds = (
        "The pressure was put back into the equations of the body: it presses nowhere into a rigid surface, pulls at "
        "none, keeps the body in equilibrium, and is zero wherever there is a gap, and no more than "
        f"{small(max(left[name] for name in names))} of its scale is left of any of these conditions."
    )
    if kind == "left open by round-off":
        return f"{holds} But in floating-point numbers this pressure cannot be told from others that are far from it."
    if kind != "unique":
        return (
            f"{holds} But a second contact state cannot be ruled out, because the smallest eigenvalue of the "
            f"compliance ({small(eigenvalue)}) is not positive, so that this is proved to be a solution, but not "
            "the only one."
        )
    why = (
        "Equilibrium alone fixes the pressure, so that there is no other"
        if eigenvalue is None
        else "Two different contact states would differ by a pressure that stores no elastic energy, and none does "
        f"here (the smallest eigenvalue of the compliance is {small(eigenvalue)}, and positive), so that there is no "
        "other"
    )
    return f"{holds} {why}{_bound(proved['error_bound'], answer['peak'], units)}."


def _bound(bound: float | None, peak: Record | None, units: Units) -> str:
    """How far round-off may have moved the pressure."""
    if bound is None or peak is None:
        return ""
    size = with_unit(small(bound), units.stress)
    return f", and round-off moves no pressure by more than {size}, {small(bound / peak['pressure'])} of the peak"


def _penalty(contender: Record, units: Units) -> dict[str, str] | None:
    """The penalty of QP2, free of units and in the user's, up to where QP2 is convex, and whether it is there."""
    search = (contender["answer"] or {}).get("search")
    told = search and search["penalty"]
    if not told:
        return None
    unit = f"{units.force}/{units.length}⁴" if told["dimension"] == "p/L²" else f"{units.length}²/{units.force}"
    unit = unit if units.force and units.length else ""
    limit, value = told["convexity_limit"], told["value"]
    written = NOTHING if limit is None else f"{number(limit)} ({with_unit(number(told['convexity_limit_raw']), unit)})"
    return {
        "value": f"{number(value)} ({with_unit(number(told['raw']), unit)})",
        "limit": "any penalty" if limit is None else "no penalty" if limit == 0 else written,
    }


def _picture(name: str, svg: bytes, level: Record) -> Picture:
    """A picture with what it shows, in words."""
    caption = CAPTIONS.get(name)
    if caption is None:
        solver, _, weights = name.removeprefix(HISTORY).partition("-")
        weighted = f" with {weights.replace('-', ' ')} weights" if weights else ""
        caption = f"{statement(solver)}{weighted}" if solver != "direct" else "The direct solver"
    answer = level["comparison"]["reference"]["answer"]
    peak = answer and answer["peak"]
    extent = f"; the peak is {number(peak['pressure'])}" if name == "pressure" and peak else ""
    course = ": course of the search, iteration by iteration" if name.startswith(HISTORY) else ""
    return picture(svg, caption, f"{caption}{course}{extent}")


CAPTIONS = {
    "problem": "The body with its mesh, what is prescribed on it, and the rigid surfaces that it may touch",
    "pressure": "Contact pressure of all formulations, one inside the other where they agree",
    "gap": "Gap between the body and the rigid surfaces",
    "deformed": "Deformed shape, by the direct solution",
    "difference": "How far each pressure is from the direct solution",
    "convergence": "What is left of each quantity, mesh by mesh",
}
"""Name of a picture -> the line below it."""
