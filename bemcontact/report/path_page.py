"""The page of a load path: what was varied, pictures over the parameter, breakpoints, what to rely on."""

from collections.abc import Iterator, Mapping
from typing import Any

from bemcontact.analysis.result import BEYOND
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.problems import Problem, Units
from bemcontact.report.bars import BARS_ARE, with_bar
from bemcontact.report.contact_words import units_of
from bemcontact.report.formatting import (
    number,
    problem_in_words,
    sentence_case,
    vector,
    with_unit,
    zero_if_negligible,
    zone_surfaces,
)
from bemcontact.report.page import Picture, picture, template
from bemcontact.report.path_text import breakpoint_words, path_verdicts
from bemcontact.report.verdicts import NOT_LOOKED_AT, overall
from bemcontact.version import __version__

MOST_ROWS = 500
"""Largest number of breakpoints on a page; path.csv has all."""
CAPTIONS = {
    "problem": "What was asked, at the end of the path",
    "animation": "The path: the body to scale, with the pressure on its contact, above the peak pressure; if that is "
    "infinite, above the forces",
    "states": "The body to scale, with the pressure on its contact, at four values from start to end of the path",
    "peak": "Peak pressure; dots are breakpoints, hollow ones have an error larger than asked, or not known",
    "force": "Force of each contact on the body",
    "moment": "Moment of each contact on the body, about (0, 0); errors of moments are not estimated",
    "pressure": "Pressure along the contact zones at eight values, from the start of the path to its end",
}
"""Name of a picture -> its caption."""

ENDS = "where the body touches; dots are breakpoints, and waves between them come from the mesh"
"""Caption of the picture of a zone."""


def render(path: ParameterPath, pictures: Mapping[str, bytes], problem: Problem | None, spec: str | None) -> str:
    """Write the page of a path as HTML that needs no other file.

    `pictures` are SVG files by name as of `figures.figures_of_path`. The page describes the problem and has its spec
    where they are given.
    """
    verdicts, units = [*path_verdicts(path)], units_of(path.contact)
    return template("path.html").render(
        name=path.name,
        version=__version__,
        verdicts=verdicts,
        overall=overall(verdicts),
        headline=[*_headline(path, units)],
        key=path.key,
        start=number(path.start),
        end=number(path.end),
        description=problem_in_words(problem) if problem else [],
        surfaces=zone_surfaces(problem) if problem else [],
        pictures={name: _picture(name, svg, path, problem) for name, svg in pictures.items()},
        zones=path.zones,
        units=units,
        rows=[*_rows(path)],
        count=len(path.breakpoints),
        assessed=bool(path.start_accuracy.bars or path.end_accuracy.bars),
        bars_are=BARS_ARE,
        not_looked_at=NOT_LOOKED_AT,
        notes=[f"{sentence_case(note)}." for note in path.notes],
        notes_beyond=any(BEYOND in note for note in path.notes),
        spec=spec,
    )


def _headline(path: ParameterPath, units: Units) -> Iterator[tuple[str, str, str]]:
    """Name, value and remark of the numbers at the head of the page."""
    yield "Varied", f"{number(path.start)} to {number(path.end)}", path.key
    yield "Breakpoints", f"{len(path.breakpoints)}", f"{path.pivots} points enter or leave"
    if path.infinite:
        yield "Peak pressure", "infinite", f"in {', '.join(path.infinite)}"
    elif path.pressed:
        highest = max(path.pressed, key=lambda state: state.peak or 0.0)
        value = with_unit(with_bar(highest.peak or 0.0, highest.peak_bar), units.stress)
        unknown = ", error not known" if highest.peak_bar is None else ""
        yield "Largest peak pressure", value, f"at {number(highest.value)}{unknown}"


def _rows(path: ParameterPath) -> Iterator[dict[str, Any]]:
    """Words, force of each zone, and quality of the peak at each breakpoint."""
    coarse = {*map(id, path.coarse)}
    largest = max(abs(part) for state in path.states for force in state.resultant for part in force)
    for state in path.breakpoints[:MOST_ROWS]:
        yield {
            "words": breakpoint_words(path, state),
            "forces": [
                vector((zero_if_negligible(x, largest), zero_if_negligible(y, largest))) for x, y in state.resultant
            ],
            "quality": "fair" if id(state) in coarse else "",
        }


def _picture(name: str, svg: bytes, path: ParameterPath, problem: Problem | None) -> Picture:
    """A picture with its caption and text alternative."""
    kind, _, order = name.partition("-")
    caption = CAPTIONS[kind] if kind in CAPTIONS else f"{path.zones[int(order) - 1]}: {ENDS}"
    if name == "problem" and problem is not None and problem.adapts:
        caption += "; the elements are those from which the search for a mesh begins"
    if kind in ("force", "contact"):
        assessed = any(state.bars for state in path.states)
        caption += "; bars are errors at breakpoints" if assessed else "; errors are not known"
    return picture(svg, caption, f"{path.name}. {caption}.")
