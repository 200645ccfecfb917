"""The command compare."""

from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.arguments import JsonOption, Source, by_option, names, option, several
from bemcontact.cli.command import CommandOutput, modules, run
from bemcontact.cli.terminal import Report
from bemcontact.options import ComparisonOptions

DEFAULT = ComparisonOptions()


def compare(
    source: Source,
    formulations: Annotated[str, option(ComparisonOptions, "formulations")] = ",".join(DEFAULT.formulations),
    weights: Annotated[str, option(ComparisonOptions, "weights")] = ",".join(DEFAULT.weights),
    penalty: Annotated[str | None, option(ComparisonOptions, "penalties")] = None,
    starts: Annotated[int | None, option(ComparisonOptions, "starts")] = DEFAULT.starts,
    seed: Annotated[int | None, option(ComparisonOptions, "seed")] = DEFAULT.seed,
    refine: Annotated[
        str, typer.Option(metavar="K,…", help="Split each element into K parts; several compare the meshes.")
    ] = "1",
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write a page with pictures, and its numbers.", show_default=False),
    ] = None,
    json_file: JsonOption = None,
) -> None:
    """Solve a problem by several formulations, and compare them.

    The table shows whether they agree, and which of them give the solution. QP1, QP2 and QP3 are compared
    with the direct solution of the complementarity problem; objectives, residuals and certificates of all are
    recomputed. The exit status is 0 only if all of them are certified, and the mesh is as accurate as was asked.

    FOLDER gets report.html (one file, pictures inside), report.json, figures/, contact.npz and spec.yaml; an earlier
    report there is replaced.

    Examples
      bemcontact compare models/cylinder_on_plane.yaml
      bemcontact compare models/cylinder_on_plane.yaml --out report
      bemcontact compare models/cylinder_on_plane.yaml --refine 1,2,4
      bemcontact compare models/bolt_in_plate.yaml --weights tributary,consistent
      bemcontact compare models/cylinder_on_plane.yaml --penalty 1e-3,1,1e3
      bemcontact compare models/cylinder_on_plane.yaml --starts 100
    """

    def work(report: Report) -> CommandOutput:
        with modules():
            from bemcontact.analysis import compare as comparing
            from bemcontact.report.comparison_text import mesh_study_summary
            from bemcontact.report.verdicts import mesh_study_verdicts, shortfall_of

        parts = several(refine, "--refine", "whole number", int)
        penalties = None if penalty is None else several(penalty, "--penalty", "number", float)
        given = {"formulations": names(formulations), "weights": names(weights), "penalties": penalties}
        for name, value in given.items():
            with by_option(f"--{'penalty' if name == 'penalties' else name}"):
                ComparisonOptions.of(**{name: value})
        options = ComparisonOptions.of(names(formulations), names(weights), penalties, starts=starts, seed=seed)
        study = comparing.mesh_study(options, source.problem(), parts, report, source.changes)
        if out:
            report("report", "")
            from bemcontact.report import folder

            folder.save(study, out, source.as_run())
        return CommandOutput(
            summary=lambda: mesh_study_summary(study),
            json=study.to_json,
            holds=study.holds is not False,
            verdict=shortfall_of(mesh_study_verdicts(study.to_dict())),
        )

    run("reading", work, source=source, folder=out, json_file=json_file)
