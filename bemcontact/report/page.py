"""The page that a study is read on: one self-contained HTML file, from `Study.to_dict` and pictures alone."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

from bemcontact.assessment.contender import OUTCOMES, Outcome
from bemcontact.problem import Units
from bemcontact.report.facts import NOTHING, Record, facts, scores_in_words, small
from bemcontact.report.formatting import number, penalty_unit, sentence_case, with_unit
from bemcontact.report.markup import Picture, picture, statement, template

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
    return template("report.html", quality=_quality).render(
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
    units = Units(**report["units"])
    return {
        "report": report,
        "level": level,
        "compared": compared,
        "everyone": [*contenders, reference],
        "apart": {item["one"]: item for item in compared["differences"] if item["other"] == reference["label"]},
        "answer": reference["answer"],
        "units": {"p": units.stress, "L": units.length, "1": ""},
        "verdict": _headline(report, compared),
        "description": [" ".join(part.split()) for part in report["description"].split("\n\n") if part.strip()],
        "facts": _facts(level, units),
        "scores": [*scores_in_words(level["scores"], level["references"], units)],
        "certificate": _certificate(reference["answer"], units),
        "penalties": {item["label"]: _penalty(item, units) for item in contenders},
        "acting": " + ".join(
            f"{factor:g} {case}" for case, factor in compared["contact"]["load_factors"].items() if factor
        ),
        "uncertified": [item["refine"] for item in report["levels"][:-1] if not item["comparison"]["certified"]],
        "stages": [*dict.fromkeys(stage for item in report["levels"] for stage in item["seconds"])],
    }


def _quality(outcome: str) -> str:
    """How good an outcome is: good, fair or bad."""
    return OUTCOMES[Outcome(outcome)].quality


def _headline(report: Record, compared: Record) -> str:
    """What the report shows; of many contenders, how many of them."""
    if len(compared["contenders"]) < MANY:
        return report["verdict"]
    outcomes = Counter(item["verdict"]["outcome"] for item in compared["contenders"])
    counted = (f"{count} {OUTCOMES[Outcome(name)].predicate[count > 1]}" for name, count in outcomes.items())
    direct = OUTCOMES[Outcome(compared["reference"]["verdict"]["outcome"])].of_direct
    return f"Of {len(compared['contenders'])} settings {', '.join(counted)}. {sentence_case(direct)}."


def _facts(level: Record, units: Units) -> list[tuple[str, str]]:
    """Facts of the direct solution."""
    compared = level["comparison"]
    answer = compared["reference"]["answer"]
    if answer is None:
        return []
    residuals = {**answer["residuals"], "force_balance": level["force_balance"]}
    return [*facts({**compared["contact"], **answer, "residuals": residuals}, units)]


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
    penalty = search and search["penalty"]
    if not penalty:
        return None
    unit = penalty_unit(penalty["dimension"], units)
    limit, value = penalty["convexity_limit"], penalty["value"]
    raw = NOTHING if limit is None else with_unit(number(penalty["convexity_limit_raw"]), unit)
    return {
        "value": f"{number(value)} ({with_unit(number(penalty['raw']), unit)})",
        "limit": "any penalty" if limit is None else "no penalty" if limit == 0 else f"{number(limit)} ({raw})",
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
