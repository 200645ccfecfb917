"""The command reproduce: the problems of the paper, as a table and as a page."""

from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.failures import UNCERTIFIED, claim, claim_folder, told, write_json
from bemcontact.cli.options import STANDARD_OUTPUT, JsonOption, several
from bemcontact.cli.terminal import show, stages, tell
from bemcontact.files.output import whole_file


def reproduce(
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write a page with pictures, and its numbers.", show_default=False),
    ] = None,
    refine: Annotated[str, typer.Option(metavar="K,…", help="Meshes: each element split into K parts.")] = "1,4",
    json_file: JsonOption = None,
) -> None:
    """Solve the five problems of Simunovic and Saigal 1992, and put what the paper says beside what is found.

    Each is solved by QP1, QP2, QP3 and directly, on the mesh of its file, on finer ones, and on those of the paper. The
    exit status is 0 only if all answers are certified and every reference that can be judged is met.

    FOLDER gets page.html (one file, pictures inside), numbers.json and figures/; an earlier one is replaced.

    [bold]Examples[/bold]
      bemcontact reproduce
      bemcontact reproduce --out paper
      bemcontact reproduce --refine 1,2,4,8 --json numbers.json
    """
    json_claim = None if json_file == STANDARD_OUTPUT else json_file
    with told(outputs=(out, json_claim)), stages() as say:
        claim(None, {"--json": json_claim})
        claim_folder(None, "--out", out, json_claim, "reproduction")
        parts = several(refine, "--refine", "whole number", int)
        say("reading", "")
        from bemcontact.analysis.reproduction import reproduce as carry_out
        from bemcontact.report.reproduction import reproduction_sentence, reproduction_summary

        reproduction = carry_out(parts, say)
        if out:
            say("page", "")
            from bemcontact.report import folder

            folder.save_reproduction(reproduction, out)
        if json_file and json_file != STANDARD_OUTPUT:
            with whole_file(json_file) as temporary:
                temporary.write_text(reproduction.to_json() + "\n", encoding="utf-8")
    with told():
        if json_file == STANDARD_OUTPUT:
            write_json(reproduction.to_json())
            if not reproduction.reproduced:
                tell("not reproduced: ", reproduction_sentence(reproduction.to_dict()))
        else:
            show(reproduction_summary(reproduction.to_dict()))
    raise typer.Exit(0 if reproduction.reproduced else UNCERTIFIED)
