"""The command study."""

import time
from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.arguments import JsonOption, RefineOption, Source, by_option, reader, with_default
from bemcontact.cli.command import CommandOutput, modules, run
from bemcontact.cli.terminal import Report
from bemcontact.errors import OptionError, ProblemError

GO_ON = "; what is done is kept in {folder}, and the same command goes on from there"
"""Words after an interrupt."""


def study(
    source: Source,
    vary: Annotated[
        list[str],
        typer.Option(
            metavar="KEY=VALUES",
            help="Values of a key as of --set: a:b:n for n values from a to b, or v1,v2,v3. Also variant=NAMES and "
            "case=NAMES. KEY1,KEY2=VALUES gives several keys the same values, and NAME: before the keys names their "
            "column. Several --vary make a grid.",
            show_default=False,
        ),
    ],
    output: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,…",
            help=with_default(
                "Outputs to show: peak, peak_x, peak_y, resultant, moment, displacement; of each zone, or of one as in "
                "force.foot: force, force_x, force_y, start, end, length, intervals, intensity; motion, rotation; "
                "von_mises and, of each zone, max_shear, which take time.",
                "peak,resultant,length,displacement; of several contacts of bodies force in place of resultant",
            ),
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write a page, tables and a journal.", show_default=False),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            parser=reader(int, 1),
            metavar="N",
            help=with_default("Number of processes.", "the number of processors"),
            show_default=False,
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Solve on the Dask cluster of this scheduler (extra dask).", show_default=False
        ),
    ] = None,
    refine: RefineOption = 1,
    json_file: JsonOption = None,
) -> None:
    r"""Solve a problem for all combinations of some values.

    The table has a row for each member: its values, the outputs with their errors, and whether its equations are proved
    and its mesh is as accurate as was asked. A member that fails is a row with the reason. Of a problem with load cases
    all are solved, unless --case or --vary chooses. The exit status is 0 only if all members are certified, and the
    accuracy is met.

    FOLDER gets study.html (a page with pictures), study.csv, study.json, study.parquet (extra parquet), and a journal
    of the members that are done. If a run is interrupted or killed, the same command goes on from there. Members are
    known by the problem and their values: other values add members, and after a change of the problem all are solved
    again.

    Examples
      bemcontact study models/cylinder_on_plane.yaml \
        --vary conditions.top.pressure=10:50:5 --out study
      bemcontact study models/cylinder_on_plane.yaml \
        --vary conditions.top.pressure=10:50:5 \
        --vary material.young_modulus=1000,2000 \
        --output peak,length.foot --out study
      bemcontact study models/cylinder_on_plane.yaml \
        --vary "variant=paper,stated mesh"
    """

    def work(report: Report) -> CommandOutput:
        with modules() as in_program:
            from bemcontact.report.study_page import study_shortfall, study_summary
            from bemcontact.runs.study import study_of_plan
            from bemcontact.studies.axes import written_axes
            from bemcontact.studies.outputs import chosen
            from bemcontact.studies.plan import study_plan
            from bemcontact.threads import processors

        def located(error: ProblemError) -> str:
            return source.located(error) if any(issue.path for issue in error.issues) else str(error)

        def ensure_possible() -> None:
            with by_option("--vary", located=located):
                plan.ensure_possible()

        begin = time.perf_counter()
        with by_option("--vary"):
            axes = written_axes(vary)
        problem = source.problem(refine)
        with by_option("--output"):
            shown = chosen(output, problem)
        with by_option("--vary", located=located):
            plan = study_plan(problem, axes)
        if scheduler is not None and workers is not None:
            raise OptionError("--scheduler and --workers exclude each other: a cluster has its own workers")
        try:
            count = workers or processors()
            done = study_of_plan(
                plan, shown, out, count, scheduler, report, source.as_run(), ensure_possible, in_program=in_program
            )
        except KeyboardInterrupt:
            raise KeyboardInterrupt("" if out is None else GO_ON.format(folder=out)) from None
        seconds = time.perf_counter() - begin
        return CommandOutput(
            summary=lambda: study_summary(done, seconds, None if out is None else str(out)),
            json=done.to_json,
            holds=done.holds is not False,
            verdict=study_shortfall(done),
        )

    run("studying", work, source=source, folder=out, kind="study", json_file=json_file)
