"""What the terminal shows of a comparison on one mesh or several."""

from collections.abc import Iterator

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bemcontact.analysis.study import MeshLevel, Study
from bemcontact.assessment.comparison import Comparison
from bemcontact.problem import Units
from bemcontact.report.facts import facts, scores_in_words
from bemcontact.report.formatting import convexity_in_words, seconds_in_words, sentence_case, units_of
from bemcontact.report.tables import add, add_verdict, list_of_facts, table_of


def study_summary(study: Study) -> RenderableType:
    """List each formulation's verdict on the finest mesh, and how the answer changes from mesh to mesh."""
    level = study.finest
    compared, answer = level.comparison, level.answer
    shown = list_of_facts()
    for name, value in facts(answer.to_dict(), units_of(answer.contact)):
        add(shown, name, value)
    for name, remark in {item.name: item.remark for item in level.expected if item.remark}.items():
        add(shown, name, remark)
    for contender in compared.everyone:
        if not contender.certified:
            add(shown, contender.label, contender.verdict.words)
    reasons = (item.verdict.reason for item in compared.contenders if item.verdict.reason)
    for reason in dict.fromkeys(reasons):
        add(shown, "Reason", reason)
    if study.convergence is not None and study.convergence.remark:
        add(shown, "Meshes", study.convergence.remark)
    for note in answer.notes:
        add(shown, "Note", note)
    words = [sentence_case(compared.verdict), *_uncertified_meshes(study)]
    add_verdict(shown, "certified" if study.certified else compared.heading, study.certified, " ".join(words))
    scores = _score_table(level, units_of(answer.contact))
    tables = [
        _contender_table(compared),
        _curvature_table(compared),
        scores,
        _mesh_table(study),
    ]
    parts = [part for table in tables if table.row_count for part in (table, "")]
    return Group(Text(study.name, "bold"), Text(_compared_how(study), "dim"), "", *parts, shown)


def _uncertified_meshes(study: Study) -> Iterator[str]:
    """Name coarser meshes on which not all is certified."""
    coarser = [f"{level.refine}" for level in study.levels[:-1] if not level.comparison.certified]
    if coarser:
        yield f"On the coarser mesh{'es' * (len(coarser) > 1)} (refine {', '.join(coarser)}) not all is certified."


def _contender_table(compared: Comparison) -> Table:
    """List the formulations, the direct solution last."""
    searched = any(item.attempt.starts for item in compared.contenders)
    table = table_of(
        "", "verdict", "objective", "unpolished", "off direct", "iterations", "seconds", *["starts"] * searched
    )
    for item in compared.everyone:
        difference = compared.difference(item.label)
        solution, starts = item.solution, item.attempt.starts
        cells = [
            item.label,
            item.verdict.outcome,
            "" if item.objective is None else f"{item.objective:.0e}",
            "" if difference is None else f"{difference.unpolished:.0e}",
            "" if difference is None else f"{difference.largest:.0e}",
            "" if solution is None else f"{solution.iterations}",
            "" if solution is None else f"{item.attempt.seconds:.3f}",
        ]
        if searched:
            cells.append("" if starts is None else f"{starts.solved} of {starts.count}")
        table.add_row(*map(Text, cells), style="" if item.certified else "red")
    return table


def _curvature_table(compared: Comparison) -> Table:
    """List how many eigenvalues are positive, zero and negative where a local solver searched."""
    table = table_of("eigenvalues + 0 -", "whole Hessian", "free at start", "free at end", "convex in equilibrium")
    for item in compared.contenders:
        search = item.solution.search if item.solution else None
        if search is None:
            continue
        inertias = (search.inertia, search.reduced_inertia_start, search.reduced_inertia_end)
        written = (" ".join(map(str, inertia)) for inertia in inertias)
        table.add_row(*map(Text, (item.label, *written, convexity_in_words(item))))
    return table


def _score_table(level: MeshLevel, units: Units) -> Table:
    """List the references and the differences from them."""
    table = table_of("reference", "quantity", "found", "expected", "difference", "allowed", "")
    keys = ("reference", "quantity", "found", "expected", "difference", "tolerance", "verdict")
    scores, references = ([item.to_dict() for item in items] for items in (level.scores, level.expected))
    for row in scores_in_words(scores, references, units):
        table.add_row(*(Text(row[key]) for key in keys), style="red" if row["colour"] == "bad" else "")
    return table


def _mesh_table(study: Study) -> Table:
    """List how the answer changes from mesh to mesh, with the last observed order and what it leads to."""
    convergence = study.convergence
    if convergence is None:
        return table_of("")
    table = table_of("mesh", *(f"refine {parts}" for parts in convergence.refine), "order", "limit")
    units = units_of(study.finest.answer.contact)
    labels = {"p": units.stress, "L": units.length, "1": ""}
    for item in convergence.quantities:
        order = item.orders[-1] if item.orders else None
        unit = labels[item.dimension]
        cells = [f"{item.name}, {unit}" if unit else item.name, *(f"{value:.6g}" for value in item.values)]
        cells += ["" if order is None else f"{order:.1f}", "" if item.limit is None else f"{item.limit:.6g}"]
        table.add_row(*map(Text, cells))
    return table


def _compared_how(study: Study) -> str:
    """Say what was compared, on what."""
    level = study.finest
    freedom = (
        "" if level.answer.degrees_of_freedom is None else f"{level.answer.degrees_of_freedom} degrees of freedom, "
    )
    took = seconds_in_words(study.seconds)
    return f"compared with the direct solution; {freedom}{level.answer.contact.size} contact points, {took}"
