"""The command solve."""

from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.arguments import FigureOption, JsonOption, RefineOption, Source, by_option, reader
from bemcontact.cli.command import CommandOutput, modules, run
from bemcontact.cli.terminal import Report
from bemcontact.errors import OptionError
from bemcontact.options import SolveOptions, StressMeasure


def solve(
    source: Source,
    options: SolveOptions,
    refine: RefineOption = 1,
    figure: FigureOption = None,
    json_file: JsonOption = None,
    vtk_file: Annotated[
        Path | None,
        typer.Option(
            "--vtk", metavar="FILE", help="Write boundary and inside; ends in .vtu or .vtk.", show_default=False
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write a page with pictures, and tables.", show_default=False),
    ] = None,
    stress: Annotated[
        StressMeasure,
        typer.Option(
            parser=reader(StressMeasure), metavar=f"<{'|'.join(StressMeasure)}>", help="Stress that pictures show."
        ),
    ] = StressMeasure.VON_MISES,
) -> None:
    r"""Compute the contact pressure, assess it, and print a table.

    Pressures are per UNDEFORMED length. If the spec states no elements, the program finds a mesh, and each number has
    an error bar. The accuracy is 1 % unless the spec or --accuracy gives another. A mesh that is stated on all edges,
    without an accuracy, is taken as it is, and its errors are estimated and compared with 1 %. With accuracy: null in
    the spec, errors are not assessed. The exit status is 0 only if the solution of the equations is certified, and the
    accuracy is met.

    FOLDER gets result.html (one page with pictures, to read and to send on), zones.csv, intervals.csv (each stretch of
    contact), points.csv, stress.csv (along the edges), largest_stresses.csv, result.json, figures/ and spec.yaml; an
    earlier result there is replaced.

    If a spec has load cases, all of them and all combinations are solved; --case selects one.

    Examples
      bemcontact solve models/cylinder_on_plane.yaml
      bemcontact solve models/cylinder_on_plane.yaml --out roller
      bemcontact solve models/cylinder_on_plane.yaml --figure contact.png
      bemcontact solve models/cylinder_on_plane.yaml \
        --figure shear.png --stress max_shear
      bemcontact solve models/bolt_in_plate.yaml --set material.young_modulus=2e6
      bemcontact solve models/cylinder_on_plane.yaml --accuracy 0.001
      bemcontact solve models/cylinder_on_plane.yaml --json - | jq .peak
      bemcontact solve models/gallery/roller_in_v_block.yaml --case aside
      bemcontact solve models/cylinder_on_plane.yaml --formulation qp1
      bemcontact solve models/cylinder_on_plane.yaml --formulation qp2 --starts 20
    """

    def work(report: Report) -> CommandOutput:
        with modules():
            from bemcontact.analysis import load_cases
            from bemcontact.analysis import solve as analysis
            from bemcontact.report import text
            from bemcontact.report.verdicts import shortfall

        def draw(results: analysis.Result | load_cases.CaseResults) -> None:
            if figure:
                from bemcontact.report import figures

                figures.save(figures.figure_of(results, stress), figure)
            if out:
                report("report", "")
                from bemcontact.report import folder

                folder.save_result(results, out, source.as_run(), stress)

        problem = source.problem(refine)
        with by_option("--start"):
            read = analysis.with_start_read(options)
        if problem.load_cases and problem.case is None:
            if vtk_file:
                raise OptionError("--vtk writes the boundary of one load case; name it with --case")
            results = load_cases.solve_cases_with(read, problem, report)
            draw(results)
            return CommandOutput(
                summary=lambda: text.cases_summary(results),
                json=results.to_json,
                holds=results.holds is not False,
                verdict=shortfall(results),
            )
        several = options.starts or 1
        result = analysis.solve_with(
            read, problem, lambda done: report("solving", f"start {min(done + 1, several)} of {several}"), report
        )
        draw(result)
        if vtk_file:
            from bemcontact.report import vtk

            vtk.save(result, vtk_file)
        return CommandOutput(
            summary=lambda: text.result_summary(result),
            json=result.to_json,
            holds=result.holds is not False,
            verdict=shortfall(result),
        )

    run(
        "solving",
        work,
        source=source,
        files={"--figure": figure, "--vtk": vtk_file},
        folder=out,
        kind="result",
        json_file=json_file,
    )
