"""The command check: what is seen in a spec."""

from bemcontact.cli.failures import claim, told
from bemcontact.cli.options import (
    CaseOption,
    FigureOption,
    RefineOption,
    SetOption,
    SpecArgument,
    VariantOption,
    with_case,
)
from bemcontact.cli.terminal import busy, show


def check(
    spec: SpecArgument,
    figure: FigureOption = None,
    refine: RefineOption = 1,
    overrides: SetOption = None,
    variant: VariantOption = None,
    case: CaseOption = None,
) -> None:
    """Validate a spec and say what is seen in it: edges, contact zones, mesh, loads, and what holds the body.

    No contact is solved, but a body that nothing holds, or that its load pulls off its support, is found out; in
    each of its load cases.

    [bold]Examples[/bold]
      bemcontact check models/cylinder_on_plane.yaml
      bemcontact check models/cylinder_on_plane.yaml --figure problem.svg
      bemcontact check models/cylinder_on_plane.yaml --set mesh.refine=2
    """
    overrides = with_case(overrides, case)
    with told(spec, overrides, variant, (figure,)), busy("checking"):
        claim(spec, {"--figure": figure})
        from bemcontact import spec as spec_file
        from bemcontact.analysis.check import check as checked
        from bemcontact.report import text

        problem = checked(spec_file.load(spec, overrides or (), variant).refined(refine))
        if figure:
            from bemcontact.report import figures

            figures.save(figures.figure_of_problem(problem.problem, problem.mesh), figure)
    with told(spec):
        show(text.problem_summary(problem))
