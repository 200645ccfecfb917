"""Input and surroundings that could break a terminal, a file or a run: hidden characters, full disks, little memory."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import in_one_process
from rich.text import Text
from typer.testing import CliRunner

import bemcontact
from bemcontact import cli
from bemcontact.cli import terminal
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import LINE_BREAKS, hidden_character
from bemcontact.report import text
from bemcontact.report.figures import figure_of, vector_graphic

MODEL = Path(__file__).parents[2] / "models" / "cylinder_on_plane.yaml"

HOSTILE = "a\x1b[31m\x9b\u202e\u2028\nb"


def in_a_process(*arguments: object, before: str = "", flags: tuple[str, ...] = (), **environment: str):
    """Run the program as a user's shell would, after a command of the shell."""
    program = f'{before} exec "$0" "$@"'
    return subprocess.run(
        ["/bin/bash", "-c", program, sys.executable, *flags, "-m", "bemcontact", *map(str, arguments)],
        capture_output=True, text=True, timeout=120, check=False,
        env={**os.environ, "PYTHONPATH": str(Path(bemcontact.__file__).parents[1]), **environment},
    )  # fmt: skip


@pytest.mark.parametrize("shown", [HOSTILE, "\x00", "\x85", "\ufeff"])
def test_nothing_hidden_reaches_a_stream(shown, capsys):
    terminal.show(Text(shown))
    terminal.tell("error: ", shown)
    streams = capsys.readouterr()
    assert hidden_character(streams.out + streams.err, LINE_BREAKS) is None


def test_names_that_no_spec_could_have_are_escaped_in_every_output(capsys):
    """A condensed problem may be made, or read from a file, without a spec."""
    zone, name = f"foot {HOSTILE}", f"contact {HOSTILE}"
    contact = CondensedContact.from_compliance([[2.0, 1.0], [1.0, 2.0]], [-1.0, -1.0], [1.0, 1.0])
    object.__setattr__(contact, "zone_names", (zone,))
    object.__setattr__(contact, "name", name)
    result = bemcontact.solve(contact)
    terminal.show(text.result_summary(result))
    written = [capsys.readouterr().out, result.to_json(), vector_graphic(figure_of(result)).decode()]
    assert [hidden_character(item, LINE_BREAKS) for item in written] == [None, None, None]


def test_a_wrong_command_line_is_repeated_without_hidden_characters():
    ended = in_one_process("\x1b[31m", "check --\x1b[31m", "check a\x1b[31m.yaml")
    assert ended.stdout == 3 * "status 2\n"
    assert len(ended.stderr.splitlines()) == 3
    assert hidden_character(ended.stderr, LINE_BREAKS) is None


def test_a_spec_is_read_from_standard_input():
    spec = MODEL.read_text(encoding="utf-8")
    good = CliRunner().invoke(cli.app, ["check", "-"], input=spec)
    assert good.exit_code == 0, good.output
    bad = CliRunner().invoke(cli.app, ["check", "-", "--set", "material.poisson_ratio=3"], input=spec)
    assert bad.exit_code == 2
    broken = CliRunner().invoke(cli.app, ["check", "-"], input="a: [")
    assert broken.stderr.startswith("error: standard input:1:5: ")


@pytest.mark.slow
def test_a_file_that_cannot_grow_is_named(tmp_path: Path):
    paths = [tmp_path / name for name in ("a.pdf", "a.png", "a.svg")]
    no_modules = {"PYTHONDONTWRITEBYTECODE": "1"}  # Python would write compiled modules that are cut off, and stay
    commands = [f"check {MODEL} --figure {path}" for path in paths]
    ended = in_one_process(*commands, before="ulimit -f 2;", **no_modules)
    assert ended.stderr == "".join(f"error: {path}: File too large\n" for path in paths)
    assert [*tmp_path.iterdir()] == []


@pytest.mark.slow
def test_help_and_schemas_are_the_same_where_python_removes_docstrings():
    commands = ["--help", "solve --help", "schema", "schema --result", "schema --reproduction"]
    with_them, without = (in_one_process(*commands, flags=flags) for flags in ((), ("-OO",)))
    assert without.stdout == with_them.stdout
    assert without.stdout.count("\nstatus 0\n") == len(commands)
    assert without.stderr == ""


def test_little_memory_is_said_before_any_work():
    ended = in_a_process("check", MODEL, before="ulimit -v 700000;")
    assert ended.returncode == 1
    assert ended.stderr.startswith("failed: there is not enough memory (the limit of the address space")


@pytest.mark.slow
def test_no_warning_of_a_home_that_cannot_be_written(tmp_path: Path):
    figure = tmp_path / "a.png"
    ended = in_a_process("check", MODEL, "--figure", figure, HOME="/proc/x", MPLCONFIGDIR="/proc/x")
    assert ended.returncode == 0
    assert ended.stderr == ""


@pytest.mark.parametrize("status", [0, 1, 2])
def test_an_interrupt_after_the_work_does_not_change_its_status(status):
    """The interpreter takes a moment to end."""
    code = (
        "import sys, time\nfrom bemcontact import cli\ncli.app = lambda: sys.exit(int(sys.argv[1]))\n"
        "try:\n    cli.main()\nfinally:\n    print('done', flush=True)\n    time.sleep(0.5)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code, str(status)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONPATH": str(Path(bemcontact.__file__).parents[1])},
    ) as process:  # fmt: skip
        assert process.stdout is not None
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=30) == status
        assert process.stderr is not None
        assert process.stderr.read() == ""


@pytest.mark.slow
@pytest.mark.parametrize("before", ["ulimit -f 0; exec 2>messages.txt;", "exec 2>&-;"])
@pytest.mark.parametrize("arguments", [("solve", "none.yaml"), ("solve", "--none"), ("schema", "--path", "--cases")])
def test_a_message_that_cannot_be_written_does_not_change_the_status(tmp_path: Path, before: str, arguments):
    ended = in_a_process(*arguments, before=f"cd {tmp_path}; {before}", PYTHONDONTWRITEBYTECODE="1")
    assert ended.returncode == 2


@pytest.mark.parametrize("arguments", ["schema", f"check {MODEL}"])
def test_standard_output_that_is_closed_is_said(arguments: str):
    ended = in_a_process(*arguments.split(), before="exec >&-;")
    assert ended.returncode == 2
    assert ended.stderr.startswith("error: standard output is closed")


@pytest.mark.parametrize("arguments", ["schema", "--help", "solve none.yaml 2>&1", "solve --none 2>&1"])
def test_a_pipe_that_its_reader_closes_ends_the_program(arguments: str):
    """Its status is that of other programs, which the signal SIGPIPE ends."""
    program = f"{sys.executable} -m bemcontact {arguments} | sleep 0; exit ${{PIPESTATUS[0]}}"
    root = str(Path(bemcontact.__file__).parents[1])
    ended = subprocess.run(
        ["bash", "-c", program], capture_output=True, text=True, check=False, env={**os.environ, "PYTHONPATH": root}
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (128 + signal.SIGPIPE, "", "")


def test_a_case_with_any_name_is_found(tmp_path: Path):
    path = tmp_path / "a.yaml"
    spec = MODEL.read_text(encoding="utf-8")
    path.write_text(
        f'{spec}\nload_cases: {{"\N{GRINNING FACE}": {{loads: {{gravity: {{density: 1, acceleration: [0, 0]}}}}}}}}\n'
    )
    assert CliRunner().invoke(cli.app, ["check", str(path), "--case", "\N{GRINNING FACE}"]).exit_code == 0


def test_standard_input_that_is_closed_is_said():
    """With <&- there is no standard input at all."""
    command = f"exec {sys.executable} -m bemcontact check - <&-"
    done = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False)
    assert done.returncode
    assert "standard input is closed" in done.stderr
    assert "Traceback" not in done.stderr
