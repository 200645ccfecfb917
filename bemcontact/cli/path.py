"""The command path."""

from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.arguments import JsonOption, RefineOption, Source, by_option, read_quantity, with_default
from bemcontact.cli.command import CommandOutput, modules, run
from bemcontact.cli.terminal import Report


def path(
    source: Source,
    vary: Annotated[
        str, typer.Option(metavar="KEY.PATH", help="Value to vary, by the same paths as --set.", show_default=False)
    ],
    to: Annotated[
        float, typer.Option(parser=read_quantity, metavar="VALUE", help="Where the path ends.", show_default=False)
    ],
    start: Annotated[
        float | None,
        typer.Option(
            "--from",
            parser=read_quantity,
            metavar="VALUE",
            help=with_default("Where the path begins.", "as in the spec"),
            show_default=False,
        ),
    ] = None,
    refine: RefineOption = 1,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write path.html, path.csv and path.json.", show_default=False),
    ] = None,
    animation: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write an animation; ends in .gif or .svg.", show_default=False),
    ] = None,
    json_file: JsonOption = None,
) -> None:
    r"""Follow contact from one value of a parameter to another.

    The table lists the points that enter or leave contact. Between two breakpoints pressure and gap are linear in
    the parameter, so the path is exact on its mesh and has no steps. The mesh is made for both ends; each breakpoint
    has its own error bar. Only gaps and loads may depend on the parameter, and only linearly. Examples are a pressure,
    a traction, a prescribed displacement, gravity, the position of a rigid surface, the force on a tool, the factor of
    a load case (load_cases.NAME). The exit status is 0 only if the path reaches its end, each state on it is proved to
    be the only one, and the accuracy asked is met at both ends.

    FOLDER gets a page with an animation of the body, and pictures of peak, forces, moments and ends of contact over
    the parameter (path.html), a table of them with three rows between two breakpoints (path.csv), all results
    (path.json), and the problem as run (spec.yaml). An earlier path is replaced.

    Examples
      bemcontact path models/cylinder_on_plane.yaml \
        --vary conditions.top.pressure --from 0 --to 50.625 --animation roller.gif
      bemcontact path models/cantilever_flat_surface.yaml \
        --vary conditions.top.traction.y --from 0 --to -3.6 --out path
      bemcontact path models/gallery/three_zones.yaml \
        --vary conditions.loaded.pressure --to 40 --json - | jq .pivots
    """

    def work(report: Report) -> CommandOutput:
        with modules():
            from bemcontact.analysis.follow import follow
            from bemcontact.problems.key_path import parsed_path
            from bemcontact.report.path_text import path_summary, path_verdicts
            from bemcontact.report.verdicts import shortfall_of

        problem = source.problem(refine)
        with by_option("--vary"):
            room = parsed_path(vary)[:1]
        with by_option("--vary", room, source.located):  # with the value as stated there is no mistake
            followed = follow(problem, vary, to, start=start)

        def drawn(done: int, of: int) -> None:
            report("drawing", f"frame {done} of {of}")

        if animation:
            from bemcontact.report import figures

            figures.save_animation(followed, animation, drawn)
        if out:
            report("drawing", "")
            from bemcontact.report import folder

            folder.save_path(followed, out, problem, source.as_run(), drawn)
        return CommandOutput(
            summary=lambda: path_summary(followed),
            json=followed.to_json,
            holds=followed.holds is not False,
            verdict=shortfall_of(path_verdicts(followed)),
        )

    run(
        "following", work, source=source, files={"--animation": animation}, folder=out, kind="path", json_file=json_file
    )
