"""The command study: table, folder, exit statuses, interrupts."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from command_line import in_one_process, run
from messages import assert_states

import bemcontact
from bemcontact.studies.journal import JOURNAL

CYLINDER = Path(__file__).parents[2] / "models" / "cylinder_on_plane.yaml"
PAPER = ("--variant", "paper", "--workers", 1)
LOADS = ("--vary", "conditions.top.pressure=10:30:3")


def test_the_table_has_the_numbers_of_solve(tmp_path: Path):
    answer = run("study", CYLINDER, *LOADS, *PAPER, "--output", "peak,force.foot", "--json", tmp_path / "a.json")
    assert answer.exit_code == 0, answer.stderr
    told = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    alone = run("solve", CYLINDER, "--variant", "paper", "--set", "conditions.top.pressure=20", "--json", "-")
    peak = json.loads(alone.stdout)["peak"]["pressure"]
    assert told["rows"][1]["outputs"]["peak"]["value"] == pytest.approx(peak, rel=1e-9)
    assert told["columns"] == ["peak", "force.foot"]
    assert_states(" ".join(answer.stdout.split()), "Equations all proved. … Mesh not assessed.")


def test_the_status_is_that_of_the_worst_member():
    """A pull has no contact state; its row says so, and the others are solved."""
    answer = run("study", CYLINDER, "--vary", "conditions.top.pressure=-10,20", *PAPER)
    assert answer.exit_code == 1
    assert_states(" ".join(answer.stdout.split()), "Failed 1 member … 1 of 2 not proved … pulls the body off")
    piped = run("study", CYLINDER, "--vary", "conditions.top.pressure=-10,20", *PAPER, "--json", "-")
    assert piped.exit_code == 1
    assert json.loads(piped.stdout)["counts"] == {"failed": 1, "mesh not assessed": 1}
    assert_states(piped.stderr, "not certified: Equations: 1 of 2 not proved")


def test_a_mesh_that_is_not_met_has_a_status():
    asked = ("--set", "mesh.adapt=false", "--accuracy", "1e-6")
    answer = run("study", CYLINDER, *LOADS, *PAPER, *asked)
    assert answer.exit_code == 1
    assert_states(" ".join(answer.stdout.split()), "Mesh not met 3 members … Mesh not met by 3 of 3")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--vary", "conditions.top.presure=1,2"), r"--vary: .*yaml:\d+:\d+: .*did you mean 'pressure'"),
        (("--vary", "conditions.top.pressure=1:2"), "--vary: .*expected a:b:n"),
        (("--vary", "conditions.top.pressure"), "--vary: .*no '='"),
        (("--vary", "conditions.top.pressure=1,x"), "--vary: .*expected a number"),
        (("--vary", "material.young_modulus=1,-1"), "--vary: .*young_modulus"),
        ((*LOADS, "--output", "peek"), "--output: unknown output 'peek'; did you mean 'peak'"),
        ((*LOADS, "--workers", "0"), "--workers.*at least 1"),
        ((*LOADS, "--scheduler", "tcp://127.0.0.1:9"), "exclude each other"),
    ],
)
def test_wrong_arguments_are_refused_before_any_work(arguments: tuple[str, ...], says: str):
    answer = run("study", CYLINDER, *PAPER, *arguments)
    assert answer.exit_code == 2
    assert re.search(says, " ".join(answer.stderr.split())), answer.stderr
    assert "Traceback" not in answer.stderr


def test_variants_can_be_varied():
    answer = run("study", CYLINDER, "--vary", "variant=paper,stated mesh", "--workers", 1, "--json", "-")
    assert answer.exit_code == 0, answer.stderr
    assert [row["values"]["variant"] for row in json.loads(answer.stdout)["rows"]] == ["paper", "stated mesh"]


@pytest.mark.slow
def test_a_folder_gets_page_tables_and_journal(tmp_path: Path):
    place = tmp_path / "study"
    for _ in range(2):  # the second one has all from the journal
        answer = run("study", CYLINDER, *LOADS, *PAPER, "--out", place)
        assert answer.exit_code == 0, answer.stderr
    names = {"study.html", "study.json", "study.csv", "study.parquet", "spec.yaml", JOURNAL, "figures"}
    assert {item.name for item in place.iterdir()} == names
    assert len((place / JOURNAL).read_text(encoding="utf-8").splitlines()) == 1 + 3


@pytest.mark.slow
def test_check_and_help_import_nothing_of_studies():
    """Nor does solve: a study's packages are for studies."""
    slow = ("distributed", "dask", "pyarrow", "bemcontact.studies.work", "bemcontact.runs.study")
    code = f"print([m for m in {slow} if m in sys.modules], file=sys.stderr)"
    commands = ("--help", f"check {CYLINDER}", "study --help", f"solve {CYLINDER} --variant paper")
    answer = in_one_process(*commands, code=code)
    assert answer.stdout.count("\nstatus 0\n") == len(commands)
    assert answer.stderr == "[]\n"


@pytest.mark.slow
def test_a_folder_is_checked_without_what_draws(tmp_path: Path):
    """So a wrong one is refused at once, and workers need not wait until all that draws is read."""
    (tmp_path / "other.txt").write_text("mine", encoding="utf-8")
    answer = in_one_process(
        f"study {CYLINDER} --vary conditions.top.pressure=20 --out {tmp_path}",
        f"solve {CYLINDER} --out {tmp_path}",
        code="print('matplotlib' in sys.modules, file=sys.stderr)",
    )
    assert answer.stdout == "status 2\n" * 2
    assert answer.stderr.splitlines()[-1] == "False"


@pytest.mark.slow
def test_a_folder_is_written_without_pandas(tmp_path: Path):
    """To import it takes as long as to write the folder."""
    answer = in_one_process(
        f"study {CYLINDER} --vary conditions.top.pressure=20,30 --workers 1 --out {tmp_path / 'study'}",
        code="print('pandas' in sys.modules, file=sys.stderr)",
    )
    assert (answer.stderr, (tmp_path / "study" / "study.parquet").is_file()) == ("False\n", True)


def started(*arguments: object) -> subprocess.Popen[str]:
    root = str(Path(bemcontact.__file__).parents[1])
    handled = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    program = f"{handled}\nfrom bemcontact.__main__ import run_program; run_program()"
    return subprocess.Popen(
        [sys.executable, "-c", program, *map(str, arguments)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": root, "OMP_NUM_THREADS": "1"},
    )


@pytest.mark.slow
@pytest.mark.parametrize("how", ["SIGINT", "SIGKILL"])
def test_a_run_that_is_ended_says_how_to_go_on_if_it_can_and_nothing_is_lost(tmp_path: Path, how: str):
    """Its workers end with it: what it wrote to is read to its end. Those that are forked might keep its pipes open."""
    many = ("study", CYLINDER, "--vary", "material.young_modulus=900:1100:20", "--workers", 2, "--out")
    place = tmp_path / "study"
    process = started(*many, place)
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not (place / JOURNAL).is_file():
        time.sleep(0.05)
    while time.monotonic() < deadline and (place / JOURNAL).read_bytes().count(b"\n") < 4:
        time.sleep(0.05)
    process.send_signal(signal.Signals[how])
    _, said = process.communicate(timeout=60)
    if how == "SIGINT":
        assert process.returncode == 130
        assert said == f"interrupted; what is done is kept in {place}, and the same command goes on from there\n"
    kept = (place / JOURNAL).read_bytes()
    process = started(*many, place)
    _, said = process.communicate(timeout=120)
    assert (process.returncode, said) == (0, "")
    lines = (place / JOURNAL).read_bytes()
    assert lines.startswith(kept)
    keys = [json.loads(line)["key"] for line in lines.splitlines()[1:]]
    assert len(keys) == len({*keys}) == 20
