"""The command solve: one formulation, one table."""

from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.failures import UNCERTIFIED, claim, told, write_json
from bemcontact.cli.options import (
    STANDARD_OUTPUT,
    CaseOption,
    FigureOption,
    FitOption,
    JsonOption,
    RefineOption,
    SetOption,
    SpecArgument,
    VariantOption,
    with_case,
)
from bemcontact.cli.terminal import busy, show, tell
from bemcontact.errors import OptionError
from bemcontact.files import output
from bemcontact.options import Equilibrium, FormulationName, Rows, StartName, Weights


def solve(
    spec: SpecArgument,
    formulation: Annotated[
        FormulationName, typer.Option(help="Statement of the contact problem.")
    ] = FormulationName.QP3,
    weights: Annotated[
        Weights, typer.Option(help="Weights of the objective; complementarity has none.")
    ] = Weights.TRIBUTARY,
    penalty: Annotated[
        float,
        typer.Option(
            metavar="μ",
            help="qp2: an error of the equations costs its square over μ; a smaller μ enforces them harder.",
        ),
    ] = 1.0,
    rows: Annotated[
        Rows, typer.Option(help="qp1, qp2: equations in terms of pressure or of displacement.")
    ] = Rows.STIFFNESS,
    equilibrium: Annotated[
        Equilibrium, typer.Option(help="qp2, free bodies: exact, or penalised as in the paper.")
    ] = Equilibrium.CONSTRAINT,
    start: Annotated[
        str | None,
        typer.Option(
            metavar="null|random|FILE", help="qp1, qp2: first point; a FILE that --json wrote.", show_default="null"
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(min=0, metavar="S", help="qp1, qp2: random starts, other ones for each S.", show_default="0"),
    ] = None,
    starts: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="qp1, qp2: N random starts; the best end is shown.")
    ] = None,
    max_iterations: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Stop the solver after N iterations.", show_default="its own")
    ] = None,
    refine: RefineOption = 1,
    fit_edges: FitOption = False,
    overrides: SetOption = None,
    variant: VariantOption = None,
    case: CaseOption = None,
    figure: FigureOption = None,
    json_file: JsonOption = None,
    vtk_file: Annotated[
        Path | None,
        typer.Option("--vtk", metavar="FILE", help="Write the boundary; ends in .vtu or .vtk.", show_default=False),
    ] = None,
) -> None:
    """Find the contact pressure, judge it, and say it in a short table.

    Pressures are per UNDEFORMED length. The exit status is 0 only if the solution is certified.

    qp3 is convex, complementarity direct; qp1 and qp2 are left to a local solver.

    Of a spec with load cases all are solved, and all combinations, or the one that --case names.

    [bold]Examples[/bold]
      bemcontact solve models/cylinder_on_plane.yaml
      bemcontact solve models/cylinder_on_plane.yaml --figure contact.png
      bemcontact solve models/cylinder_on_plane.yaml --set material.young_modulus=2e6
      bemcontact solve models/cylinder_on_plane.yaml --fit-edges
      bemcontact solve models/cylinder_on_plane.yaml --json - | jq .peak
      bemcontact solve models/gallery/roller_in_v_block.yaml --case aside
      bemcontact solve models/cylinder_on_plane.yaml --formulation qp1
      bemcontact solve models/cylinder_on_plane.yaml --formulation qp2 --starts 20
    """
    overrides = with_case(overrides, case)
    json_claim = None if json_file == STANDARD_OUTPUT else json_file
    with told(spec, overrides, variant, (figure, vtk_file, json_claim)), busy("solving") as say:
        claim(spec, {"--figure": figure, "--json": json_claim, "--vtk": vtk_file})
        from bemcontact import spec as spec_file
        from bemcontact.analysis import load_cases
        from bemcontact.analysis import solve as analysis
        from bemcontact.formulations import plan as plans
        from bemcontact.formulations import starts as starts_of
        from bemcontact.report import text

        plan = plans.planned(
            formulation,
            weights,
            penalty=penalty,
            rows=rows,
            equilibrium=equilibrium,
            start=start if start is None or start in [*StartName] else starts_of.read_start(start),
            seed=seed,
            starts=starts,
            max_iterations=max_iterations,
        )
        problem = spec_file.load(spec, overrides or (), variant).refined(refine)
        if fit_edges:
            problem = problem.with_value("mesh.fit_contact_edges", True)
        all_cases = bool(problem.load_cases) and problem.case is None
        if all_cases and vtk_file:
            raise OptionError("--vtk writes the boundary of one load case; name it with --case")
        if all_cases:
            found = load_cases.carry_out_cases(plan, problem, lambda stage, _: say(f"solving, {stage}"))
        else:
            found = analysis.carry_out(
                plan, problem, lambda done: say(f"solving, start {min(done + 1, starts or 1)} of {starts}")
            )
        if figure:
            from bemcontact.report import figures

            figures.save(figures.figure_of(found), figure)
        if vtk_file and not isinstance(found, load_cases.CaseResults):
            from bemcontact.report import vtk

            vtk.save(found, vtk_file)
        if json_file and json_file != STANDARD_OUTPUT:
            with output.whole_file(json_file) as temporary:
                temporary.write_text(found.to_json(indent=2) + "\n", encoding="utf-8")
    with told(spec):
        several = isinstance(found, load_cases.CaseResults)
        if json_file == STANDARD_OUTPUT:
            write_json(found.to_json(indent=2))
            if not found.certified:
                tell("not certified: ", text.uncertified(found))
        else:
            show(text.cases_summary(found) if several else text.result_summary(found))
    raise typer.Exit(0 if found.certified else UNCERTIFIED)
