"""HTML pages: templates with their filters, embedded pictures, and the page of a mesh study."""

import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from bemcontact.assessment.contender import OF_DIRECT, PREDICATES, Outcome
from bemcontact.errors import escaped_lines
from bemcontact.frozen import frozen_value
from bemcontact.problems import Units
from bemcontact.report.bars import BARS_ARE, NOTHING, accuracy_rows, infinite_peaks, with_bar
from bemcontact.report.contact_words import PenaltyWords, penalty_in_words
from bemcontact.report.facts import (
    contact_intervals,
    facts,
    peak_bar,
    peak_of,
    percent,
    scores_in_words,
    small,
    total_force,
)
from bemcontact.report.formatting import (
    JsonObject,
    number,
    paragraphs,
    plural,
    seconds_in_words,
    sentence_case,
    vector,
    with_unit,
)
from bemcontact.report.verdicts import mesh_study_verdicts, overall

MANY = 5
"""Number of contenders from which the head of the page counts them instead of listing them."""

HISTORY = "history-"
"""Start of the names of the pictures of solvers."""


FORMULATIONS = {"qp1": "QP1", "qp2": "QP2", "qp3": "QP3"}
PLAIN = " !$&'()*+,-./:;=?@_~"
"""What a picture in a page keeps as it is, beside letters and digits: a third shorter than base64."""
WIDE = 500.0
"""Width in points from which a picture gets the whole width of the page."""
NARROW = 385.0
"""Width in points of a picture that fills its place beside another one."""


@frozen_value
class Picture:
    """A picture in the page."""

    source: str
    """The picture as a data URL."""
    alternative: str
    """Text alternative."""
    caption: str
    """The line above it."""
    wide: bool
    """Whether it needs the whole width of the page."""
    share: int
    """Percentage of its place that it fills if all pictures have letters of one size."""


@cache
def template(name: str, **more: Callable[..., Any]) -> Template:
    """Return the template of a page, a file in ``templates``, compiled once; `more` are further filters."""
    environment = Environment(
        loader=PackageLoader("bemcontact.report"),
        autoescape=True,
        finalize=lambda value: escaped_lines(value) if type(value) is str else value,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        number=_number, small=small, percent=percent, seconds=seconds_in_words, vector=vector, unit=with_unit,
        plural=plural, plain=_plain, capital=sentence_case, formulation_name=formulation_name, inertia=_inertia, **more,
    )  # fmt: skip
    return environment.get_template(name)


def picture(svg: bytes, caption: str, alternative: str) -> Picture:
    """Embed an SVG with a caption and a text alternative."""
    dense = re.sub(rb"(?<=>)\s+(?=<)", b"", svg)
    return Picture(
        source=f"data:image/svg+xml,{quote(dense, safe=PLAIN)}",
        alternative=alternative,
        caption=caption,
        wide=_width(svg) > WIDE,
        share=min(100, round(100 * _width(svg) / NARROW)) if 0 < _width(svg) <= WIDE else 100,
    )


def _number(value: float | None) -> str:
    """Write a number with five figures."""
    return NOTHING if value is None else number(value)


def _plain(text: str) -> str:
    """Write a name of the code in words: local_minimum, element_length."""
    return text.replace("_", " ")


def formulation_name(name: str) -> str:
    """Printed name of a formulation."""
    return FORMULATIONS.get(name, name)


def _inertia(inertia: Sequence[int] | None) -> str:
    """Write how many eigenvalues are positive, zero and negative."""
    if inertia is None:
        return NOTHING
    return f"({', '.join(map(str, inertia))})"


def _width(svg: bytes) -> float:
    """Width in points that a picture states; 0 if it states none."""
    stated = re.search(rb'<svg[^>]* width="([\d.]+)pt"', svg)
    return float(stated[1]) if stated else 0.0


def render(report: JsonObject, pictures: Mapping[str, bytes], spec: str | None) -> str:
    """Write the page of a mesh study as HTML that needs no other file.

    `report` is the content of report.json, `pictures` are SVG files by name as of `figures.figures_of`, and `spec` is
    the text of the spec as run. A missing picture is left out.
    """
    contents = _contents(report)
    return template("report.html", quality=_quality).render(
        **contents,
        pictures={name: _picture(name, svg, contents["level"]) for name, svg in pictures.items()},
        histories=[name for name in pictures if name.startswith(HISTORY)],
        spec=spec,
    )


def _contents(report: JsonObject) -> dict[str, Any]:
    """Variables of the template; the finest mesh gives the answer."""
    level = report["levels"][-1]
    compared = level["comparison"]
    contenders, reference = compared["contenders"], compared["reference"]
    units = Units(**report["units"])
    headline = _headline(report, compared)
    verdicts = mesh_study_verdicts(report, headline)
    answer = _record(level)
    return {
        "report": report,
        "level": level,
        "compared": compared,
        "everyone": [*contenders, reference],
        "differences": {item["one"]: item for item in compared["differences"] if item["other"] == reference["label"]},
        "answer": reference["answer"],
        "units": {"p": units.stress, "L": units.length, "1": ""},
        "verdict": headline,
        "verdicts": verdicts,
        "overall": overall(verdicts),
        "peak": peak_of(answer, units) if answer else NOTHING,
        "infinite": infinite_peaks(level),
        "bars": [*accuracy_rows(level["accuracy"], units)],
        "bars_are": BARS_ARE,
        "description": paragraphs(report["description"]),
        "facts": [*facts(answer, units)] if answer else [],
        "touching": [*contact_intervals(answer, units, short=True)] if answer else [],
        "force": total_force(answer, units) if answer else ("", ""),
        "scores": [*scores_in_words(level["scores"], level["references"], units)],
        "certificate": answer["certificate"]["words"] if answer else "There is no direct solution to certify.",
        "penalties": {item["label"]: _penalty(item, units) for item in contenders},
        "acting": " + ".join(
            f"{factor:g} {case}" for case, factor in compared["contact"]["load_factors"].items() if factor
        ),
        "stages": [*dict.fromkeys(stage for item in report["levels"] for stage in item["seconds"])],
    }


def _quality(outcome: str) -> str:
    """Quality of an outcome: good, fair or bad."""
    return Outcome(outcome).quality


def _headline(report: JsonObject, compared: JsonObject) -> str:
    """Verdict of the comparison; of many contenders, the number with each outcome."""
    if len(compared["contenders"]) < MANY:
        return report["verdict"]
    outcomes = Counter(item["verdict"]["outcome"] for item in compared["contenders"])
    counted = (f"{count} {PREDICATES[Outcome(name)][count > 1]}" for name, count in outcomes.items())
    direct = OF_DIRECT[Outcome(compared["reference"]["verdict"]["outcome"])]
    deepest = report["levels"][-1]["penetration"]
    first = "" if deepest is None else f"{deepest['words']} "
    return f"{first}Of {len(compared['contenders'])} settings {', '.join(counted)}. {sentence_case(direct)}."


def _record(level: JsonObject) -> JsonObject | None:
    """The direct solution on a mesh, as the record of a result; None if there is none."""
    compared = level["comparison"]
    answer = compared["reference"]["answer"]
    if answer is None:
        return None
    residuals = {**answer["residuals"], "force_balance": level["force_balance"]}
    of_level = {key: level[key] for key in ("accuracy", "sides")}
    return {**compared["contact"], **answer, **of_level, "residuals": residuals}


def _penalty(contender: JsonObject, units: Units) -> PenaltyWords | None:
    """Penalty of QP2 and up to which one it is convex."""
    search = (contender["answer"] or {}).get("search")
    return penalty_in_words(search["penalty"], units) if search and search["penalty"] else None


def _picture(name: str, svg: bytes, level: JsonObject) -> Picture:
    """A picture with its caption and text alternative."""
    caption = CAPTIONS.get(name)
    if caption is None:
        solver, _, weights = name.removeprefix(HISTORY).partition("-")
        weighted = f" with {weights.replace('-', ' ')} weights" if weights else ""
        caption = f"{formulation_name(solver)}{weighted}" if solver != "direct" else "The direct solver"
    answer = level["comparison"]["reference"]["answer"]
    peak = answer and answer["peak"]
    infinite = name == "pressure" and infinite_peaks(level)
    extent = f"; the peak is {with_bar(peak['pressure'], peak_bar(level))}" if name == "pressure" and peak else ""
    extent = f"; infinite in {', '.join(infinite)}, and cut off" if infinite else extent
    shown = ": objective, infeasibility and residual over the iterations" if name.startswith(HISTORY) else ""
    return picture(svg, caption, f"{caption}{shown}{extent}")


CAPTIONS = {
    "problem": "Each body with its mesh and conditions, and what it may touch",
    "pressure": "Contact pressure of all formulations; where they agree, one curve lies inside the other",
    "gap": "Gap between the body and what it may touch",
    "deformed": "Deformed shape of the direct solution",
    "difference": "Difference of each pressure from the direct solution",
    "convergence": "Distance of each quantity from its limit, mesh by mesh",
}
"""Name of a picture -> its caption."""
