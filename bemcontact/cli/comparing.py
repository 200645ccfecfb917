"""The command compare: formulations side by side, on one mesh or several, as a table and as a page."""

from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.failures import UNCERTIFIED, claim, claim_folder, told, write_json
from bemcontact.cli.options import (
    STANDARD_OUTPUT,
    CaseOption,
    FitOption,
    JsonOption,
    SetOption,
    SpecArgument,
    VariantOption,
    names,
    several,
    with_case,
)
from bemcontact.cli.terminal import show, stages, tell
from bemcontact.files.output import whole_file
from bemcontact.options import FormulationName, Weights

COMPARED = (FormulationName.QP1, FormulationName.QP2, FormulationName.QP3)


def compare(
    spec: SpecArgument,
    formulations: Annotated[
        str, typer.Option(metavar="NAME,…", help=f"What to compare with the direct solution: {', '.join(COMPARED)}.")
    ] = ",".join(COMPARED),
    weights: Annotated[
        str, typer.Option(metavar="NAME,…", help=f"Weights of the objectives: {', '.join(Weights)}.")
    ] = Weights.TRIBUTARY,
    penalty: Annotated[
        str | None, typer.Option(metavar="μ,…", help="qp2: penalties, such as 1e-6,1e-3,1,1e3.", show_default="1")
    ] = None,
    starts: Annotated[
        int | None,
        typer.Option(
            min=1,
            metavar="N",
            help="qp1, qp2: count how many of N random starts end at the solution.",
            show_default=False,
        ),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, metavar="S", help="Other random starts for each S.", show_default="0")
    ] = None,
    refine: Annotated[
        str, typer.Option(metavar="K,…", help="Split each element into K parts; several compare the meshes.")
    ] = "1",
    fit_edges: FitOption = False,
    variant: VariantOption = None,
    case: CaseOption = None,
    overrides: SetOption = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write a page with pictures, and its numbers.", show_default=False),
    ] = None,
    json_file: JsonOption = None,
) -> None:
    """Solve one problem by several formulations, and say whether they agree and which is the solution.

    QP1, QP2 and QP3 stand beside the direct solution of the complementarity problem; objectives, residuals and
    certificates of all are recomputed. The exit status is 0 only if all of them are certified.

    FOLDER gets report.html (one file, pictures inside), report.json, figures/, contact.npz and spec.yaml; a report that
    is there is replaced.

    [bold]Examples[/bold]
      bemcontact compare models/cylinder_on_plane.yaml
      bemcontact compare models/cylinder_on_plane.yaml --out report
      bemcontact compare models/cylinder_on_plane.yaml --refine 1,2,4
      bemcontact compare models/cylinder_on_plane.yaml --weights tributary,consistent,element_length
      bemcontact compare models/cylinder_on_plane.yaml --formulations qp2 --penalty 1e-6,1e-3,1,1e3
      bemcontact compare models/cylinder_on_plane.yaml --starts 100
    """
    overrides = with_case(overrides, case)
    json_claim = None if json_file == STANDARD_OUTPUT else json_file
    with told(spec, overrides, variant, (out, json_claim)), stages() as say:
        claim(spec, {"--json": json_claim})
        claim_folder(spec, "--out", out, json_claim)
        parts = several(refine, "--refine", "whole number", int)
        penalties = None if penalty is None else several(penalty, "--penalty", "number", float)
        say("reading", "")
        from bemcontact import spec as spec_file
        from bemcontact.analysis import compare as comparing
        from bemcontact.formulations.plan import planned_comparison
        from bemcontact.report import study_text

        plan = planned_comparison(names(formulations), names(weights), penalties, starts=starts, seed=seed)
        problem = spec_file.load(spec, overrides or (), variant)
        if fit_edges:
            problem = problem.with_value("mesh.fit_contact_edges", True)
        study = comparing.study(plan, problem, parts, say, overrides or ())
        if out:
            say("report", "")
            from bemcontact.report import folder

            folder.save(study, out, spec_file.as_run(spec, overrides or (), variant))
        if json_file and json_file != STANDARD_OUTPUT:
            with whole_file(json_file) as temporary:
                temporary.write_text(study.to_json() + "\n", encoding="utf-8")
    with told(spec):
        if json_file == STANDARD_OUTPUT:
            write_json(study.to_json())
            if not study.certified:
                tell("not certified: ", study.finest.comparison.verdict)
        else:
            show(study_text.study_summary(study))
    raise typer.Exit(0 if study.certified else UNCERTIFIED)
