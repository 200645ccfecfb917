"""The page of the paper's problems: one self-contained HTML file, from `Reproduction.to_dict` and pictures alone."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from bemcontact.problem import Units
from bemcontact.report.formatting import number, with_unit
from bemcontact.report.markup import NOTHING, Record, percent, picture, small, statement, template
from bemcontact.report.page import unit_of_score

FORMULATIONS = ("qp1", "qp2", "qp3", "complementarity")
"""In the order of the table of iterations."""
TINY = 1e-4
"""Below this the size of a number is all that matters."""


def render(record: Record, pictures: Mapping[str, bytes]) -> str:
    """Write the page.

    Parameters
    ----------
    record : what `Reproduction.to_dict` gives, or numbers.json holds
    pictures : name -> SVG, the names as of `bemcontact.report.figures.figures_of_reproduction`; some may be missing

    Returns
    -------
    str
        HTML that needs no other file.
    """
    problems = [_contents(item, pictures) for item in record["problems"]]
    counted = [statement(name) for item in record["problems"] for name in item["iterations"]]
    return template("reproduction.html", in_words=_in_words).render(
        record=record, problems=problems, verdict=verdict(record), counted=counted
    )


def verdict(record: Record) -> str:
    """What the whole says, in two sentences.

    Parameters
    ----------
    record : what `Reproduction.to_dict` gives

    Returns
    -------
    str
    """
    problems = record["problems"]
    answers = sum(len(run["solvers"]) for item in problems for run in item["runs"])
    proved = sum(solver["certified"] for item in problems for run in item["runs"] for solver in run["solvers"])
    judged, held = (sum(item[key] for item in problems) for key in ("judged", "held"))
    meshes = sum(len(item["runs"]) for item in problems)
    told = f"{proved} of {answers} answers, by four solvers on {meshes} meshes, are proved to be the solution."
    missed = [item["figure"] for item in problems if not (item["certified"] and item["held"] == item["judged"])]
    where = f" See {', '.join(missed)}." if missed else ""
    return f"{told} {held} of {judged} quantities are within what their references allow.{where}"


def found_in_words(values: Sequence[float]) -> str:
    """Write what was found (k,): a number, from where to where, or that there is nothing to find; round-off briefly."""
    told = (number(value) if abs(value) > TINY else small(value) for value in values)
    return " to ".join(told) or "no contact"


def counts(item: Record) -> Iterator[dict[str, Any]]:
    """Iterations of one problem, those that the paper prints first.

    Parameters
    ----------
    item : a problem of the record

    Yields
    ------
    dict
        label, whether it is printed in the paper, cells: contact points, then one for each of `FORMULATIONS`.
    """
    if item["iterations"]:
        printed = [str(item["iterations"].get(name, NOTHING)) for name in FORMULATIONS]
        yield {"label": "QPSOL, the paper", "printed": True, "cells": [NOTHING, *printed]}
    for run in item["runs"]:
        own = {solver["formulation"]: solver["iterations"] for solver in run["solvers"]}
        told = [NOTHING if own.get(name) is None else str(own[name]) for name in FORMULATIONS]
        yield {"label": run["label"], "printed": False, "cells": [str(run["contact_nodes"]), *told]}


def _contents(item: Record, pictures: Mapping[str, bytes]) -> dict[str, Any]:
    """What the page says of one problem, by the names that the template has for it."""
    anchor, units = item["model"].replace("_", "-"), Units(**item["units"])
    finest = item["runs"][-1]
    peak = finest["peak"]
    return {
        **item,
        "anchor": anchor,
        "contact": with_unit(found_in_words(finest["contact"]), item["coordinate"]["unit"] * bool(peak)),
        "peak": with_unit(number(peak["pressure"]), units.stress) if peak else "no contact",
        "rows": [{**row, "found": [found_in_words(values) for values in row["found"]]} for row in item["statements"]],
        "meshes": [run["label"] for run in item["runs"] if run["variant"] is None],
        "known": [*_known(item, units)],
        "counts": [*counts(item)],
        "told": " ".join(item["description"].split()),
        "pressure": _picture(pictures, f"{anchor}-pressure", f"{item['figure']} of the paper, drawn anew", item),
        "problem": _picture(pictures, f"{anchor}-problem", "The body, its mesh, and the rigid surface", item),
    }


def _in_words(count: int) -> str:
    """Write a small number as a word."""
    words = ("no", "one", "two", "three", "four", "five")
    return words[count] if count < len(words) else str(count)


def _picture(pictures: Mapping[str, bytes], name: str, caption: str, item: Record) -> Any:
    """A picture of a problem, if there is one."""
    return picture(pictures[name], caption, f"{item['name']}: {caption}") if name in pictures else None


def _known(item: Record, units: Units) -> Iterator[dict[str, Any]]:
    """The quantities of the references, with their units."""
    told = {reference["name"]: reference for reference in item["references"]}
    for score in item["scores"]:
        unit = unit_of_score(score["quantity"], told[score["reference"]], units)
        word, colour = ("holds", "good") if score["holds"] else ("does not hold", "bad")
        if not score["judged"]:
            word, colour = "not judged", "fair"
        yield {
            "reference": score["reference"],
            "quantity": f"{score['quantity']} [{unit}]" if unit else score["quantity"],
            "expected": number(score["expected"]),
            "found": [NOTHING if value is None else number(value) for value in score["found"]],
            "difference": percent(score["difference"][-1]),
            "tolerance": percent(score["tolerance"]),
            "verdict": word,
            "colour": colour,
        }
