"""The commands that solve no contact: check, condense and schema."""

import json
from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.arguments import FigureOption, RefineOption, Source
from bemcontact.cli.command import CommandOutput, modules, refuse, reported, run, write_json
from bemcontact.cli.terminal import Report, tell
from bemcontact.errors import ProblemError, SingularSystemError, SpecError


def check(source: Source, figure: FigureOption = None, refine: RefineOption = 1) -> None:
    """Check a spec, and show its zones, mesh, loads and supports.

    No contact is solved. It is an error if nothing holds the body, or if the load of any load case pulls it off its
    supports. --figure then shows the parts of the problem that could be read.

    Examples
      bemcontact check models/cylinder_on_plane.yaml
      bemcontact check models/cylinder_on_plane.yaml --figure problem.svg
      bemcontact check models/cylinder_on_plane.yaml --set mesh.refine=2
    """

    def work(_: Report) -> CommandOutput:
        with modules():
            from bemcontact.analysis.check import check as checked
            from bemcontact.report.problem_text import problem_summary

        try:
            body = checked(source.problem(refine))
        except (SpecError, ProblemError, SingularSystemError):
            if figure:
                draw_refused(source, figure)
            raise
        if figure:
            from bemcontact.report import figures

            figures.save(figures.figure_of_problem(body.problem, body.mesh), figure)
        return CommandOutput(summary=lambda: problem_summary(body))

    run("checking", work, source=source, files={"--figure": figure})


def draw_refused(source: Source, figure: Path) -> None:
    """Draw what can be read of a problem that is refused, and say where; the bodies with a sound boundary."""
    from bemcontact.analysis.check import drawable
    from bemcontact.report import figures

    if problem := source.readable():
        note = "REFUSED: parts with mistakes may be missing here"
        figures.save(figures.figure_of_problem(*drawable(problem), note), figure)
        tell("note: ", f"{figure} shows the parts of the problem that could be read", "bold")
    else:
        why = "a refused problem is drawn if the outline of an elastic body is sound"
        tell("note: ", f"{figure} is not written: {why}", "bold")


def condense(
    source: Source,
    out: Annotated[Path, typer.Option(metavar="FILE.npz", help="Where to write.", show_default=False)],
    refine: RefineOption = 1,
) -> None:
    """Reduce a body to its contact points, and save them.

    The file has compliance, gaps and weights. Read it with bemcontact.CondensedContact.load(FILE) and solve it with
    bemcontact.solve.

    Examples
      bemcontact condense models/cylinder_on_plane.yaml --out cylinder.npz
      bemcontact condense models/cylinder_on_plane.yaml --refine 2 --out fine.npz
    """

    def work(_: Report) -> CommandOutput:
        with modules():
            from bemcontact.analysis import solve as analysis
            from bemcontact.report import text

        contact = analysis.condense(source.problem(refine))
        contact.save(out)
        return CommandOutput(summary=lambda: text.condensed_summary(contact, out))

    run("condensing", work, source=source, files={"--out": out})


def schema(
    result: Annotated[bool, typer.Option("--result", help="The schema of the JSON that solve writes.")] = False,
    cases: Annotated[
        bool, typer.Option("--cases", help="The schema of the JSON that solve writes of all load cases.")
    ] = False,
    path: Annotated[bool, typer.Option("--path", help="The schema of the JSON that path writes.")] = False,
    study: Annotated[bool, typer.Option("--study", help="The schema of study.json, which study writes.")] = False,
    report: Annotated[bool, typer.Option("--report", help="The schema of report.json, which compare writes.")] = False,
    case_report: Annotated[
        bool, typer.Option("--case-report", help="The schema of report.json, which compare writes of all load cases.")
    ] = False,
    reproduction: Annotated[
        bool, typer.Option("--reproduction", help="The schema of numbers.json, which reproduce writes.")
    ] = False,
) -> None:
    """Print the JSON Schema of a spec or of a result.

    Editors complete and check a spec by it.

    Examples
      bemcontact schema > bemcontact.schema.json
      bemcontact schema --result > result.schema.json
      bemcontact schema --report > report.schema.json
    """
    with reported():
        options = {
            "result": result,
            "cases": cases,
            "path": path,
            "study": study,
            "report": report,
            "case_report": case_report,
            "reproduction": reproduction,
        }
        kinds = [kind for kind, wanted in options.items() if wanted]
        if len(kinds) > 1:
            chosen = " and ".join(f"--{kind.replace('_', '-')}" for kind in kinds)
            refuse(f"{chosen} are different schemas; choose one")
        if kinds:
            from bemcontact.report.schema import schema as schema_of_result

            printed = schema_of_result(kinds[0])
        else:
            from bemcontact.spec import schema as schema_of_spec

            printed = schema_of_spec()
        write_json(json.dumps(printed, indent=2, ensure_ascii=False))
