"""Text in the terminal on a comparison; see `bemcontact.report.text`."""

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bemcontact.analysis.case_comparisons import CaseComparisons
from bemcontact.analysis.mesh_study import MeshLevel, MeshStudy
from bemcontact.assessment.comparison import Comparison
from bemcontact.assessment.contender import Contender
from bemcontact.problems import Units
from bemcontact.report.contact_words import penalty_in_words, units_of
from bemcontact.report.facts import facts, scores_in_words
from bemcontact.report.formatting import seconds_in_words
from bemcontact.report.tables import add, list_of_facts, table_of
from bemcontact.report.text import add_verdict, cases_summary
from bemcontact.report.verdicts import mesh_study_verdicts, shortfall

CONTENDERS = (
    "objective: 0 at the contact state. difference: of the pressure from the direct solution, over the peak; "
    "unpolished: the same before the last exact step."
)
CURVATURE = (
    "Numbers of positive, zero and negative eigenvalues: of the whole Hessian, and reduced to what may change where "
    "the search starts and where it ends. convex in equilibrium: where forces balance, each minimum is the least of "
    "all; μ is the penalty of QP2."
)
"""What the columns of the tables of a comparison mean, below them."""


def mesh_study_summary(study: MeshStudy) -> RenderableType:
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
    for verdict in mesh_study_verdicts(study.to_dict()):
        add_verdict(shown, verdict)
    tables = {
        _contender_table(compared): CONTENDERS,
        _curvature_table(compared): CURVATURE,
        _score_table(level, units_of(answer.contact)): "",
        _mesh_table(study): "",
    }
    shown_tables = ((table, words) for table, words in tables.items() if table.row_count)
    parts = [part for table, words in shown_tables for part in (table, *([Text(words, "dim")] * bool(words)), "")]
    return Group(Text(study.name, "bold"), Text(_compared_how(study), "dim"), "", *parts, shown)


def _contender_table(compared: Comparison) -> Table:
    """List the formulations, the direct solution last."""
    searched = any(item.attempt.starts for item in compared.contenders)
    table = table_of(
        "", "verdict", "objective", "unpolished", "difference", "iterations", "seconds", *["starts"] * searched
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
    table = table_of("eigenvalues", "whole Hessian", "reduced, start", "reduced, end", "convex in equilibrium")
    for item in compared.contenders:
        search = item.solution.search if item.solution else None
        if search is None:
            continue
        inertias = (search.inertia, search.reduced_inertia_start, search.reduced_inertia_end)
        written = (" ".join(map(str, inertia)) for inertia in inertias)
        table.add_row(*map(Text, (item.label, *written, _convexity(item))))
    return table


def _convexity(contender: Contender) -> str:
    """Whether a program is convex subject to its equations and equilibrium, and up to which penalty."""
    search = None if contender.solution is None else contender.solution.search
    convex = "yes" if contender.convex else "no"
    if search is None or search.penalty is None:
        return convex
    return f"{convex}, {penalty_in_words(search.penalty.to_dict(), Units()).limit}"


def _score_table(level: MeshLevel, units: Units) -> Table:
    """List the references and the differences from them."""
    table = table_of("reference", "quantity", "computed", "expected", "difference", "")
    scores, references = ([item.to_dict() for item in items] for items in (level.scores, level.expected))
    judged = {"holds": "within", "does not hold": "MORE THAN"}
    for row in scores_in_words(scores, references, units):
        expected = row["expected"].removesuffix(f" {row['unit']}")
        verdict = f"{judged[row['verdict']]} {row['tolerance']}" if row["verdict"] in judged else row["verdict"]
        cells = (row["reference"], row["quantity"], row["computed"], expected, row["difference"], verdict)
        table.add_row(*map(Text, cells), style="red" if row["color"] == "bad" else "")
    return table


def _mesh_table(study: MeshStudy) -> Table:
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


def _compared_how(study: MeshStudy) -> str:
    """Size and time of a comparison."""
    level = study.finest
    freedom = (
        "" if level.answer.degrees_of_freedom is None else f"{level.answer.degrees_of_freedom} degrees of freedom, "
    )
    took = seconds_in_words(study.seconds)
    return f"compared with the direct solution; {freedom}{level.answer.contact.size} contact points, {took}"


DIFFERENCE = "difference: of the pressures from the direct solution, over the largest"
"""What a column of the table of comparisons means."""


def case_comparisons_summary(comparisons: CaseComparisons) -> RenderableType:
    """List the verdict on each formulation under each load case, then the direct solutions of all."""
    labels = [item.label for item in next(iter(comparisons.levels.values())).comparison.contenders]
    table = table_of("load case", *labels, "difference", right=frozenset({"difference"}))
    for name, level in comparisons.levels.items():
        compared = level.comparison
        outcomes = [item.verdict.outcome for item in compared.contenders]
        apart = "" if compared.agreement is None else f"{compared.agreement:.0e}"
        table.add_row(*map(Text, (name, *outcomes, apart)), style="" if level.certified else "red")
    return Group(table, Text(DIFFERENCE, "dim"), "", cases_summary(comparisons.answers))


def case_comparisons_shortfall(comparisons: CaseComparisons) -> str:
    """Why comparisons under load cases do not hold: formulations that fall short, then direct solutions that do."""
    failing = (
        f"{name}: {level.comparison.verdict}" for name, level in comparisons.levels.items() if not level.certified
    )
    return " ".join((*failing, *filter(None, [shortfall(comparisons.answers)])))
