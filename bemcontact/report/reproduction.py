"""The page and the table of the paper's problems, from `Reproduction.to_dict` and pictures alone."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bemcontact.assessment.certificate import HEADINGS, CertificateKind
from bemcontact.problems import Units
from bemcontact.report.bars import NOTHING
from bemcontact.report.facts import QUALITIES, peak_of, score_verdict, scores_in_words, small
from bemcontact.report.formatting import JsonObject, number, seconds_in_words, sentence_case, with_unit
from bemcontact.report.page import formulation_name, picture, template
from bemcontact.report.tables import list_of_facts, table_of
from bemcontact.report.text import add_verdict
from bemcontact.report.verdicts import Verdict, mesh_verdict

FORMULATIONS = ("qp1", "qp2", "qp3", "complementarity")
"""Columns of the table of iterations."""
MESHES = (
    "The meshes are those of the paper and of the files, and parts of them. Their errors are not estimated: references "
    "and refinement judge them."
)
"""What is known of the errors of the meshes."""
SOME_OPEN = "some solutions are not proved"
TINY = 1e-4
"""Smaller numbers are written with two figures."""


def render(record: JsonObject, pictures: Mapping[str, bytes]) -> str:
    """Write the page of the paper's problems as HTML that needs no other file.

    `record` is the content of numbers.json, and `pictures` are SVG files by name as of
    `figures.figures_of_reproduction`.
    """
    problems = [_contents(item, pictures) for item in record["problems"]]
    counted = [formulation_name(name) for item in record["problems"] for name in item["iterations"]]
    return template("reproduction.html", in_words=_in_words).render(
        record=record,
        problems=problems,
        verdict=reproduction_sentence(record),
        verdicts=reproduction_verdicts(record),
        counted=counted,
    )


def reproduction_summary(record: JsonObject) -> RenderableType:
    """List the paper's statements, the computed quantities on each mesh, and the certificates."""
    parts = list[RenderableType]()
    for item in record["problems"]:
        proved = HEADINGS[CertificateKind.UNIQUE] if item["certified"] else SOME_OPEN
        held = f"{item['held']} of {item['judged']} reference quantities hold"
        title = Text.assemble((sentence_case(item["name"]), "bold"), f" ({item['figure']}): ")
        parts += [
            title.append(f"{proved}, {held}", "green" if _reproduced(item) else "red"),
            _statement_table(item),
            "",
        ]
    word = "reproduced" if record["reproduced"] else "NOT reproduced"
    took = f"All runs took {seconds_in_words(record['seconds'])}."
    quality = "good" if record["reproduced"] else "bad"
    shown = list_of_facts()
    add_verdict(shown, Verdict("Verdict", quality, word, f"{reproduction_sentence(record)} {took}"))
    for verdict in reproduction_verdicts(record):
        add_verdict(shown, verdict)
    return Group(*parts, _iteration_table(record), "", shown)


def reproduction_verdicts(record: JsonObject) -> tuple[Verdict, Verdict]:
    """Verdicts on the equations of all runs, and on their meshes."""
    levels = [run["level"] for item in record["problems"] for run in item["runs"]]
    proved = sum(item["certified"] for item in record["problems"])
    word = HEADINGS[CertificateKind.UNIQUE] if proved == len(record["problems"]) else SOME_OPEN
    count = f"{len(levels)} runs of {len(record['problems'])} problems"
    equations = Verdict("Equations", "good" if proved == len(record["problems"]) else "bad", word, f"In {count}.")
    return equations, mesh_verdict(levels[-1]["accuracy"])._replace(words=MESHES)


def reproduction_sentence(record: JsonObject) -> str:
    """Result of the reproduction in two sentences."""
    problems = record["problems"]
    runs = [run for item in problems for run in item["runs"]]
    certified = [solver["certified"] for run in runs for solver in _solvers(run)]
    judged, held = (sum(item[key] for item in problems) for key in ("judged", "held"))
    missed = [item["figure"] for item in problems if not _reproduced(item)]
    where = f" See {', '.join(missed)}." if missed else ""
    return (
        f"{sum(certified)} of {len(certified)} answers, by four solvers on {len(runs)} meshes, are proved to be the "
        f"solution. {held} of {judged} quantities are within what their references allow.{where}"
    )


def _reproduced(item: JsonObject) -> bool:
    """Whether a problem is certified and meets its references."""
    return item["certified"] and item["held"] == item["judged"]


def _solvers(run: JsonObject) -> list[JsonObject]:
    """The formulations of a run, then the direct solution."""
    compared = run["level"]["comparison"]
    return [*compared["contenders"], compared["reference"]]


def _statement_table(item: JsonObject) -> Table:
    """List the paper's statements and the computed values."""
    labels = [run["label"] for run in item["runs"]]
    table = table_of("", "the paper", *labels, right=frozenset(labels))
    for row in item["statements"]:
        table.add_row(
            *map(Text, (_quantity(row["what"], row["unit"]), row["statement"], *map(_values, row["computed"])))
        )
    return table


def _iteration_table(record: JsonObject) -> Table:
    """List how many iterations each solver took."""
    columns = ("iterations", "mesh", "points", "QP1", "QP2", "QP3", "direct")
    table = table_of(*columns, right=frozenset(columns[2:]))
    for item in record["problems"]:
        for order, row in enumerate(_counts(item)):
            name = "" if order else sentence_case(item["name"])
            table.add_row(*map(Text, (name, row["label"], *row["cells"])), style="bold" if row["printed"] else "")
    return table


def _quantity(name: str, unit: str) -> str:
    """A quantity with its unit."""
    return f"{name} [{unit}]" if unit else name


def _values(values: Sequence[float]) -> str:
    """Write a number, or the smallest and the largest; round-off with two figures."""
    return " to ".join(number(value) if abs(value) > TINY else small(value) for value in values) or "no contact"


def _counts(item: JsonObject) -> Iterator[dict[str, Any]]:
    """Iterations of one problem, those that the paper prints first, by the names in the template."""
    if item["iterations"]:
        printed = [str(item["iterations"].get(name, NOTHING)) for name in FORMULATIONS]
        yield {"label": "QPSOL, the paper", "printed": True, "cells": [NOTHING, *printed]}
    for run in item["runs"]:
        counts = {it["formulation"]: it["answer"]["iterations"] for it in _solvers(run) if it["answer"]}
        cells = [str(counts.get(name, NOTHING)) for name in FORMULATIONS]
        size = run["level"]["comparison"]["contact"]["contact_nodes"]
        yield {"label": run["label"], "printed": False, "cells": [str(size), *cells]}


def _contents(item: JsonObject, pictures: Mapping[str, bytes]) -> dict[str, Any]:
    """Variables of the template for one problem."""
    anchor, units = item["model"].replace("_", "-"), Units(**item["units"])
    finest = item["runs"][-1]
    compared = finest["level"]["comparison"]
    answer = compared["reference"]["answer"]
    meshes = [run for run in item["runs"] if run["variant"] is None]
    return {
        **item,
        "anchor": anchor,
        "contact": with_unit(_values(finest["contact"]), item["coordinate_unit"] * bool(answer["intervals"])),
        "peak": peak_of({**compared["contact"], **answer, **finest["level"]}, units),
        "points": compared["contact"]["contact_nodes"],
        "rows": [{**row, "computed": [_values(values) for values in row["computed"]]} for row in item["statements"]],
        "meshes": [run["label"] for run in meshes],
        "references": finest["level"]["references"],
        "scores": [*_scores([run["level"] for run in meshes], units)],
        "counts": [*_counts(item)],
        "description": " ".join(item["description"].split()),
        "pressure": _picture(pictures, f"{anchor}-pressure", f"{item['figure']} of the paper, drawn again", item),
        "problem": _picture(pictures, f"{anchor}-problem", "The body, its mesh, and the rigid surface", item),
    }


def _in_words(count: int) -> str:
    """Write a number up to five as a word."""
    words = ("no", "one", "two", "three", "four", "five")
    return words[count] if count < len(words) else str(count)


def _picture(pictures: Mapping[str, bytes], name: str, caption: str, item: JsonObject) -> Any:
    """A picture of a problem, if there is one."""
    return picture(pictures[name], caption, f"{item['name']}: {caption}") if name in pictures else None


def _scores(levels: list[JsonObject], units: Units) -> Iterator[dict[str, Any]]:
    """Quantities of the references on all meshes; differences are those of the finest mesh."""
    finest = levels[-1]
    rows = scores_in_words(finest["scores"], finest["references"], units)
    for row, scores in zip(rows, zip(*(level["scores"] for level in levels), strict=True), strict=True):
        word = score_verdict({"judged": scores[-1]["judged"], "holds": all(score["holds"] for score in scores)})
        yield {
            **row,
            "quantity": _quantity(row["quantity"], row["unit"]),
            "expected": number(scores[-1]["expected"]),
            "computed": [NOTHING if score["computed"] is None else number(score["computed"]) for score in scores],
            "verdict": word,
            "color": QUALITIES[word],
        }
