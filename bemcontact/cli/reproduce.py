"""The command reproduce."""

from pathlib import Path
from typing import Annotated

import typer

from bemcontact.cli.arguments import JsonOption, several
from bemcontact.cli.command import CommandOutput, modules, run
from bemcontact.cli.terminal import Report


def reproduce(
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write a page with pictures, and its numbers.", show_default=False),
    ] = None,
    refine: Annotated[str, typer.Option(metavar="K,…", help="Meshes: each element split into K parts.")] = "1,4",
    json_file: JsonOption = None,
) -> None:
    """Solve the five problems of the paper, and compare with it.

    The paper is Simunovic and Saigal 1992. Each problem is solved by QP1, QP2, QP3 and directly, on the
    mesh of its file, on finer meshes, and on those of the paper.
    The exit status is 0 only if all results are certified and agree with every reference value that can be judged.

    FOLDER gets page.html (one file, pictures inside), numbers.json and figures/; an earlier one is replaced.

    Examples
      bemcontact reproduce
      bemcontact reproduce --out paper
      bemcontact reproduce --refine 1,2,4,8 --json numbers.json
    """

    def work(report: Report) -> CommandOutput:
        with modules():
            from bemcontact.analysis import reproduction as analysis
            from bemcontact.report.reproduction import reproduction_sentence, reproduction_summary

        reproduction = analysis.reproduce(several(refine, "--refine", "whole number", int), report)
        if out:
            report("page", "")
            from bemcontact.report import folder

            folder.save_reproduction(reproduction, out)
        record = reproduction.to_dict()
        return CommandOutput(
            summary=lambda: reproduction_summary(record),
            json=reproduction.to_json,
            holds=reproduction.reproduced,
            verdict=reproduction_sentence(record),
            claim="reproduced",
        )

    run("reading", work, folder=out, kind="reproduction", json_file=json_file)
