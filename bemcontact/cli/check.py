"""The commands that solve no contact: check, condense and schema."""

import json
from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.command import FigureOption, Outcome, RefineOption, Source, refuse, reported, run, write_json
from bemcontact.cli.terminal import Report


def check(source: Source, figure: FigureOption = None, refine: RefineOption = 1) -> None:
    """Validate a spec and show what it states: edges, contact zones, mesh, loads, and what holds the body.

    No contact is solved. A body that nothing holds, or that its load pulls off its support, is refused, in each of its
    load cases.

    [bold]Examples[/bold]
      bemcontact check models/cylinder_on_plane.yaml
      bemcontact check models/cylinder_on_plane.yaml --figure problem.svg
      bemcontact check models/cylinder_on_plane.yaml --set mesh.refine=2
    """

    def work(_: Report) -> Outcome:
        from bemcontact.analysis import solve as analysis
        from bemcontact.report import text

        body = analysis.check(source.problem(refine))
        if figure:
            from bemcontact.report import figures

            figures.save(figures.figure_of_problem(body.problem, body.mesh), figure)
        return Outcome(summary=lambda: text.problem_summary(body))

    run("checking", work, source=source, files={"--figure": figure})


def condense(
    source: Source,
    out: Annotated[Path, typer.Option(metavar="FILE.npz", help="Where to write.", show_default=False)],
    refine: RefineOption = 1,
) -> None:
    """Reduce a body to its contact points and save compliance, gaps and weights as one .npz file.

    Read it with bemcontact.CondensedContact.load(FILE) and solve it with bemcontact.solve.

    [bold]Examples[/bold]
      bemcontact condense models/cylinder_on_plane.yaml --out cylinder.npz
      bemcontact condense models/cylinder_on_plane.yaml --refine 2 --out fine.npz
    """

    def work(_: Report) -> Outcome:
        from bemcontact.analysis import solve as analysis
        from bemcontact.report import text

        contact = analysis.condense(source.problem(refine))
        contact.save(out)
        return Outcome(summary=lambda: text.condensed_summary(contact, out))

    run("condensing", work, source=source, files={"--out": out})


def schema(
    report: Annotated[bool, typer.Option("--report", help="The schema of report.json, which compare writes.")] = False,
    reproduction: Annotated[
        bool, typer.Option("--reproduction", help="The schema of numbers.json, which reproduce writes.")
    ] = False,
) -> None:
    """Print the JSON Schema of a spec, which editors use to check and complete, or that of a report or reproduction.

    [bold]Examples[/bold]
      bemcontact schema > bemcontact.schema.json
      bemcontact schema --report > report.schema.json
      bemcontact schema --reproduction > numbers.schema.json
    """
    with reported():
        if report and reproduction:
            refuse("--report and --reproduction are two schemas; ask for one")
        if report:
            from bemcontact.report.schema import report_schema as make
        elif reproduction:
            from bemcontact.report.reproduction_schema import reproduction_schema as make
        else:
            from bemcontact.spec import schema as make
        write_json(json.dumps(make(), indent=2, ensure_ascii=False))
