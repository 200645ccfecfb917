"""The command schema: what a spec may hold, for editors, and what a report holds, for programs."""

import json
from typing import Annotated

import typer

from bemcontact.cli.failures import refuse, told, write_json


def schema(
    report: Annotated[bool, typer.Option("--report", help="The schema of report.json, which compare writes.")] = False,
    reproduction: Annotated[
        bool, typer.Option("--reproduction", help="The schema of numbers.json, which reproduce writes.")
    ] = False,
) -> None:
    """Print the JSON Schema of a spec, which editors use to check and complete, or that of a report or reproduction.

    [bold]Examples[/bold]
      bemcontact schema > bemcontact.schema.json
      bemcontact schema --report > report.schema.json
      bemcontact schema --reproduction > numbers.schema.json
    """
    with told():
        if report and reproduction:
            refuse("--report and --reproduction are two schemas; ask for one")
        if report:
            from bemcontact.report.schema import report_schema as stated
        elif reproduction:
            from bemcontact.report.reproduction_schema import reproduction_schema as stated
        else:
            from bemcontact.spec import schema as stated
        write_json(json.dumps(stated(), indent=2, ensure_ascii=False))
