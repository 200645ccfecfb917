"""The command schema: what a spec may hold, for editors."""

import json

from bemcontact.cli.failures import told, write_json


def schema() -> None:
    """Print the JSON Schema of a spec, which editors use to check and complete.

    [bold]Examples[/bold]
      bemcontact schema > bemcontact.schema.json
    """
    with told():
        from bemcontact import spec

        write_json(json.dumps(spec.schema(), indent=2, ensure_ascii=False))
