"""The program as a whole: help, version, encodings, closed pipes, full disks."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer.main
from command_line import BLOCK, in_a_process, in_one_process, run

import bemcontact
from bemcontact import cli, spec


def test_help_answers_without_the_numerical_half():
    slow = "numpy", "scipy", "cvxpy", "matplotlib", "yaml"
    commands = ("", "--help", "solve --help", "--version")
    answer = in_one_process(*commands, code=f"print([m for m in {slow} if m in sys.modules], file=sys.stderr)")
    assert answer.stderr == "[]\n"
    told = answer.stdout.split("status 0\n")
    assert len(told) == len(commands) + 1
    assert all("bemcontact" in text for text in told[:-1])


GROUP: Any = typer.main.get_command(cli.app)
COMMANDS = {"": GROUP, **GROUP.commands}


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("width", [80, 120])
def test_help_of_each_command_has_whole_words_and_lines_of_the_width(command: str, width: int):
    answer = run(*command.split(), "--help", COLUMNS=str(width))
    assert answer.exit_code == 0
    assert max(map(len, answer.stdout.splitlines())) <= width
    text = " ".join(answer.stdout.split())
    texts = [COMMANDS[command].help, *(item.help for item in COMMANDS[command].params)]
    for meant in texts + [item.help.partition("\n")[0] for item in COMMANDS.values() if not command]:
        assert " ".join(meant.replace("\b", "").split()) in text
    for found in ("<bool>", "(null)", "[bold]", "\\["):
        assert found not in answer.stdout


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_each_command_teaches_by_examples(command: str):
    answer = run(*command.split(), "--help")
    assert "Examples\n    bemcontact" in answer.stdout
    assert f"bemcontact {command}" in answer.stdout


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ("SPEC --set material.young_modulus 2e6", "--set material.young_modulus=VALUE"),
        ("--set material.young_modulus 2e6 SPEC", "--set material.young_modulus=VALUE"),
        ("SPEC material.young_modulus=2e6", "--set material.young_modulus=2e6"),
        ("SPEC --refine 1 2", "one value"),
        ("SPEC SPEC", "SPEC"),
    ],
)
@pytest.mark.parametrize("command", ["check", "solve", "compare", "path --vary a --to 1", "condense --out a.npz"])
def test_an_argument_too_many_is_refused_with_what_to_write(block: Path, command: str, arguments: str, told: str):
    answer = run(*f"{command} {arguments}".replace("SPEC", str(block)).split())
    assert answer.exit_code == 2
    assert answer.stderr.startswith("error: ")
    assert told.replace("SPEC", str(block)) in answer.stderr


def test_version_is_stated():
    answer = run("--version")
    assert answer.exit_code == 0
    assert answer.stdout.startswith("bemcontact")


INTERRUPTS_IMPORTS = """
import os, signal, sys
class Finder:
    def find_spec(name, path, target=None):
        if name == "bemcontact.cli":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Finder)
from bemcontact.__main__ import run_program
sys.argv = ["bemcontact", "--version"]
run_program()
"""


@pytest.mark.parametrize(("handler", "status"), [("default_int_handler", -signal.SIGINT), ("SIG_IGN", 0)])
def test_an_interrupt_of_the_imports_is_no_traceback(handler: str, status: int):
    """The program ends as the signal ends programs, which shells call 130; where it is ignored, it stays ignored.

    The handler is set, because the tests may run in the background of a shell, where the signal is ignored.
    """
    program = f"import signal\nsignal.signal(signal.SIGINT, signal.{handler}){INTERRUPTS_IMPORTS}"
    root = str(Path(bemcontact.__file__).parents[1])
    answer = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": root},
    )
    assert (answer.returncode, answer.stderr) == (status, "")


@pytest.mark.slow
def test_a_closed_pipe_is_no_traceback(block: Path):
    root = str(Path(bemcontact.__file__).parents[1])
    program = f"{sys.executable} -c 'from bemcontact.cli import main; main()'"
    for command in (f"solve {block} --json -", "--help"):
        answer = subprocess.run(
            ["bash", "-c", f"{program} {command} | head -c 1"],
            capture_output=True,
            text=True,
            timeout=120,
            check=True,
            env={**os.environ, "PYTHONPATH": root},
        )
        assert answer.stderr == ""


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="there is no device that is always full")
@pytest.mark.parametrize("command", ["solve BLOCK", "solve BLOCK --json -", "schema", "--help"])
def test_a_full_disk_is_one_clear_error(block: Path, command: str):
    with Path("/dev/full").open("w") as full:
        answer = in_a_process(*command.replace("BLOCK", str(block)).split(), stdout=full)
    assert (answer.returncode, answer.stderr) == (2, "error: standard output: No space left on device\n")


@pytest.mark.slow
@pytest.mark.parametrize(("command", "encoding"), [("check", "ascii"), ("solve", "cp1252")])
def test_missing_letters_of_a_terminal_are_replaced(block: Path, command: str, encoding: str):
    block.write_text(BLOCK.replace("block on a table", "блок on a table"), encoding="utf-8")
    answer = in_a_process(command, block, PYTHONIOENCODING=encoding, PYTHONUTF8="0")
    assert (answer.returncode, answer.stderr) == (0, "")
    assert answer.stdout.startswith("???? on a table\n")


@pytest.mark.slow
def test_json_is_utf_8_on_any_terminal(block: Path):
    answer = in_a_process("solve", block, "--json", "-", PYTHONIOENCODING="cp1252", encoding="utf-8")
    assert json.loads(answer.stdout)["name"] == "block on a table"
    schema = in_a_process("schema", PYTHONIOENCODING="cp1252", encoding="utf-8")
    assert json.loads(schema.stdout) == spec.schema()


@pytest.mark.parametrize("command", ["check", "solve"])
def test_no_line_ends_in_blanks(block: Path, command: str):
    lines = run(command, block).stdout.splitlines()
    assert lines == [line.rstrip() for line in lines]


def test_the_program_runs_as_a_module():
    root = str(Path(bemcontact.__file__).parents[1])
    for arguments, status in (("--version",), 0), (("solve", "none.yaml"), 2):
        answer = subprocess.run(
            [sys.executable, "-m", "bemcontact", *arguments],
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
            env={**os.environ, "PYTHONPATH": root},
        )
        assert answer.returncode == status
        assert answer.stdout or answer.stderr


@pytest.mark.slow
def test_no_color_is_respected(block: Path):
    colored = in_a_process("check", block, FORCE_COLOR="1", NO_COLOR="")
    plain = in_a_process("check", block, FORCE_COLOR="1", NO_COLOR="1")
    color = re.compile(r"\x1b\[[0-9;]*3[0-9]")
    assert color.search(colored.stdout)
    assert not color.search(plain.stdout)
