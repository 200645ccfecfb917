"""The command compare."""

from pathlib import Path
from typing import Annotated, Any

import typer

from bemcontact.cli.arguments import JsonOption, Source, by_option, names, option, several
from bemcontact.cli.command import CommandOutput, modules, run
from bemcontact.cli.terminal import Report
from bemcontact.errors import OptionError
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

    If a spec has load cases, all of them and all combinations are compared, on one mesh; --case selects one.

    FOLDER gets report.html (one file, pictures inside), report.json, figures/ and spec.yaml, and contact.npz, or of
    load cases zones.csv, intervals.csv and points.csv; an earlier report there is replaced.

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
        problem = source.problem()
        if problem.load_cases and problem.case is None:
            return _cases(source, options, problem, parts, out, report)
        study = comparing.mesh_study(options, problem, parts, report, source.changes)
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


def _cases(
    source: Source, options: ComparisonOptions, problem: Any, refine: list[int], out: Path | None, report: Report
) -> CommandOutput:
    """Compare formulations under all load cases."""
    from bemcontact.analysis.case_comparisons import compare_cases
    from bemcontact.report import comparison_text

    if len(refine) > 1:
        raise OptionError("--refine compares the meshes of one load case; name it with --case")
    comparisons = compare_cases(options, problem.refined(*refine), report, tuple(source.changes))
    if out:
        report("report", "")
        from bemcontact.report import folder

        folder.save_cases(comparisons, out, source.as_run())
    return CommandOutput(
        summary=lambda: comparison_text.case_comparisons_summary(comparisons),
        json=comparisons.to_json,
        holds=comparisons.holds is not False,
        verdict=comparison_text.case_comparisons_shortfall(comparisons),
    )
