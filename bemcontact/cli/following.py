"""The command path: contact states between two values of one parameter."""

from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.failures import UNCERTIFIED, claim, claim_folder, told, write_json
from bemcontact.cli.options import (
    STANDARD_OUTPUT,
    CaseOption,
    JsonOption,
    RefineOption,
    SetOption,
    SpecArgument,
    VariantOption,
    with_case,
)
from bemcontact.cli.terminal import busy, show, tell
from bemcontact.files.output import whole_file


def path(
    spec: SpecArgument,
    vary: Annotated[
        str, typer.Option(metavar="KEY.PATH", help="Value to vary, by the same paths as --set.", show_default=False)
    ],
    to: Annotated[float, typer.Option(metavar="VALUE", help="Where the path ends.", show_default=False)],
    start: Annotated[
        float | None,
        typer.Option("--from", metavar="VALUE", help="Where the path begins.", show_default="as in the spec"),
    ] = None,
    refine: RefineOption = 1,
    overrides: SetOption = None,
    variant: VariantOption = None,
    case: CaseOption = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write path.svg, path.csv and path.json.", show_default=False),
    ] = None,
    json_file: JsonOption = None,
) -> None:
    """Follow the contact state from one value of a parameter to another, with each point that enters or leaves.

    Between two breakpoints pressure and gap are linear in the parameter, so that the path is exact: no steps are taken.
    The parameter must enter gaps and loads linearly and nothing else: a pressure, a traction, a prescribed
    displacement, gravity, the position of a rigid surface, the force on a tool, the factor of a load case
    (load_cases.NAME). The exit status is 0 only if the path reaches its end and
    each state on it is proved to be the only one.

    FOLDER gets a picture of peak, resultants and ends of contact over the parameter (path.svg), the same as a table
    with three rows between each two breakpoints (path.csv), and all of it (path.json). An earlier path is replaced.

    [bold]Examples[/bold]
      bemcontact path models/cylinder_on_plane.yaml --vary conditions.top.pressure --from 0 --to 50.625
      bemcontact path models/cantilever_flat_surface.yaml --vary conditions.top.traction.y --from 0 --to -3.6 --out path
      bemcontact path models/gallery/three_zones.yaml --vary conditions.loaded.pressure --to 40 --json - | jq .pivots
    """
    overrides, json_claim = with_case(overrides, case), None if json_file == STANDARD_OUTPUT else json_file
    with told(spec, overrides, variant, (out, json_claim)), busy("following") as say:
        claim(spec, {"--json": json_claim})
        claim_folder(spec, "--out", out, json_claim, "path")
        from bemcontact import spec as spec_file
        from bemcontact.analysis import follow as responses
        from bemcontact.report import text

        problem = spec_file.load(spec, overrides or (), variant).refined(refine)
        found = responses.follow(problem, vary, to, start)
        if out:
            say("drawing")
            from bemcontact.report import folder

            folder.save_path(found, out)
        if json_file and json_file != STANDARD_OUTPUT:
            with whole_file(json_file) as temporary:
                temporary.write_text(found.to_json() + "\n", encoding="utf-8")
    with told(spec):
        if json_file == STANDARD_OUTPUT:
            write_json(found.to_json())
            if not found.certified:
                tell("not certified: ", text.path_sentence(found))
        else:
            show(text.path_summary(found))
    raise typer.Exit(0 if found.certified else UNCERTIFIED)
