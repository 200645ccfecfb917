"""The command schema: what a problem may hold, for editors, and what results hold, for programs."""

import json
from typing import Annotated

import typer

from bemcontact.cli.failures import refuse, told, write_json


def schema(
    result: Annotated[bool, typer.Option("--result", help="The schema of the JSON that solve writes.")] = False,
    cases: Annotated[
        bool, typer.Option("--cases", help="The schema of the JSON that solve writes of all load cases.")
    ] = False,
    path: Annotated[bool, typer.Option("--path", help="The schema of the JSON that path writes.")] = False,
    report: Annotated[bool, typer.Option("--report", help="The schema of report.json, which compare writes.")] = False,
    reproduction: Annotated[
        bool, typer.Option("--reproduction", help="The schema of numbers.json, which reproduce writes.")
    ] = False,
) -> None:
    """Print the JSON Schema of a problem, which editors use to check and complete, or that of a result.

    [bold]Examples[/bold]
      bemcontact schema > bemcontact.schema.json
      bemcontact schema --result > result.schema.json
      bemcontact schema --report > report.schema.json
    """
    with told():
        asked = {"result": result, "cases": cases, "path": path, "report": report, "reproduction": reproduction}
        kinds = [kind for kind, wanted in asked.items() if wanted]
        if len(kinds) > 1:
            refuse(f"{' and '.join(f'--{kind}' for kind in kinds)} are two schemas or more; ask for one")
        if kinds:
            from bemcontact.report.schema import schema as schema_of

            stated = schema_of(kinds[0])
        else:
            from bemcontact.spec import schema as schema_of_problem

            stated = schema_of_problem()
        write_json(json.dumps(stated, indent=2, ensure_ascii=False))
