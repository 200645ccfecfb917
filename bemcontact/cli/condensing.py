"""The command condense: a body reduced to its contact points."""

from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.failures import claim, told
from bemcontact.cli.options import CaseOption, RefineOption, SetOption, SpecArgument, VariantOption, with_case
from bemcontact.cli.terminal import busy, show


def condense(
    spec: SpecArgument,
    out: Annotated[Path, typer.Option(metavar="FILE.npz", help="Where to write.", show_default=False)],
    refine: RefineOption = 1,
    overrides: SetOption = None,
    variant: VariantOption = None,
    case: CaseOption = None,
) -> None:
    """Reduce a body to its contact points and save compliance, gaps and weights as one .npz file.

    Read it with bemcontact.CondensedContact.load(FILE) and hand it to bemcontact.solve.

    [bold]Examples[/bold]
      bemcontact condense models/cylinder_on_plane.yaml --out cylinder.npz
      bemcontact condense models/cylinder_on_plane.yaml --refine 2 --out fine.npz
    """
    overrides = with_case(overrides, case)
    with told(spec, overrides, variant, (out,)), busy("condensing"):
        claim(spec, {"--out": out})
        from bemcontact import spec as spec_file
        from bemcontact.analysis import solve as analysis
        from bemcontact.report import text

        condensed = analysis.condense(spec_file.load(spec, overrides or (), variant).refined(refine))
        condensed.save(out)
    with told(spec):
        show(text.condensed_summary(condensed, out))
