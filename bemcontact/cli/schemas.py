"""The command schema: what a spec may hold, for editors, and what a report holds, for programs."""

import json
from typing import Annotated

import typer

from bemcontact.cli.failures import told, write_json


def schema(
    report: Annotated[bool, typer.Option("--report", help="The schema of report.json, which compare writes.")] = False,
) -> None:
    """Print the JSON Schema of a spec, which editors use to check and complete, or that of a report.

    [bold]Examples[/bold]
      bemcontact schema > bemcontact.schema.json
      bemcontact schema --report > report.schema.json
    """
    with told():
        if report:
            from bemcontact.report.schema import report_schema as stated
        else:
            from bemcontact.spec import schema as stated
        write_json(json.dumps(stated(), indent=2, ensure_ascii=False))
