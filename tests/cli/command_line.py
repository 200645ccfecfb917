"""The program as a user runs it, a problem whose contact pressure is known, and what a refusal looks like."""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import TextIO

from typer.testing import CliRunner, Result

import bemcontact
from bemcontact import cli

GALLERY = Path(__file__).parents[2] / "models" / "gallery"
PRESS = GALLERY / "body_between_two_tools.yaml"
BLOCK = """\
name: block on a table
units: {length: mm, force: N}
material:
  young_modulus: 210e3
  poisson_ratio: 0.3
boundary:
  outer:
    - {name: bottom, start: [0, 0], elements: 4}
    - {name: right, start: [40, 0], elements: 2}
    - {name: top, start: [40, 20], elements: 4}
    - {name: left, start: [0, 20], elements: 2}
accuracy: null
conditions:
  left: {displacement: {x: 0}}
  top: {pressure: 3}
contact_zones:
  foot:
    edges: bottom
    surface: {kind: plane, point: [0, 0], normal: [0, 1]}
"""
"""Its contact pressure is 3 everywhere: uniform compression satisfies all equations."""


def run(*arguments: object, **environment: str) -> Result:
    return CliRunner(env=environment).invoke(cli.app, [str(argument) for argument in arguments])


def in_a_process(
    *arguments: object,
    code: str = "",
    stdout: TextIO | int = subprocess.PIPE,
    encoding: str | None = None,
    **environment: str,
) -> subprocess.CompletedProcess[str]:
    """Run the program as a user's shell would; `code` is run after it."""
    script = f"import sys\nfrom bemcontact.cli import main\ntry:\n    main()\nfinally:\n    {code or 'pass'}"
    root = str(Path(bemcontact.__file__).parents[1])
    return subprocess.run(
        [sys.executable, "-c", script, *map(str, arguments)],
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        encoding=encoding or environment.get("PYTHONIOENCODING"),
        timeout=120,
        check=False,
        env={**os.environ, "PYTHONPATH": root, "OPENBLAS_NUM_THREADS": "1", **environment},
    )


EACH_COMMAND = """
import sys
from bemcontact import cli
for command in sys.argv[1:]:
    sys.argv = ["bemcontact", *command.split()]
    try:
        cli.main()
    except SystemExit as end:
        print(f"status {end.code}")
"""


def in_one_process(
    *commands: str, code: str = "", before: str = "", flags: tuple[str, ...] = (), **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run commands one after the other, each followed by its status, and then `code`.

    The start of a process takes longer than most commands. `before` is a command of the shell, and `flags` are those of
    Python.
    """
    root = str(Path(bemcontact.__file__).parents[1])
    program = ["/bin/bash", "-c", f'{before} exec "$0" "$@"', sys.executable, *flags, "-c", EACH_COMMAND + code]
    return subprocess.run(
        [*program, *commands],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env={**os.environ, "PYTHONPATH": root, "OPENBLAS_NUM_THREADS": "1", **environment},
    )


def assert_refused(answer: Result, pattern: str) -> None:
    assert answer.exit_code == 2
    assert answer.stdout == ""
    assert "Traceback" not in answer.stderr
    assert len(answer.stderr.splitlines()) == 1, answer.stderr
    assert answer.stderr.startswith("error: ")
    assert re.search(pattern, answer.stderr)
