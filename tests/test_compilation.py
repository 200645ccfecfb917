"""Compilation by numba is a stage of its own, whatever stage it is in; machine code that is kept is none."""

import importlib.util
import os
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import numba
import pytest

from bemcontact import compilation
from bemcontact.analysis.solve import COMPILATION, Stopwatch
from bemcontact.errors import BemContactError

CYLINDER = Path(__file__).parents[1] / "models" / "cylinder_on_plane.yaml"
SOURCE = """
from bemcontact.compilation import compiled


@compiled(inner=True)
def twice(x):
    return 2 * x


@compiled()
def four_times(x):
    return twice(twice(x))
"""


@pytest.fixture
def four_times(tmp_path, monkeypatch):
    """A compiled function that calls another one; each call loads it as a process does that knows what was kept."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    (tmp_path / "doubled.py").write_text(SOURCE, encoding="utf-8")

    def load():
        spec = importlib.util.spec_from_file_location("doubled", tmp_path / "doubled.py")
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, "doubled", module)
        spec.loader.exec_module(module)
        return module.four_times

    return load


def in_a_stage(function):
    """Stages that were reported while a function ran in a stage, and their seconds."""
    reported = []
    watch = Stopwatch(progress=lambda name, now: reported.append((name, now)))
    with watch.stage("work"):
        assert function(3) == 12
    return reported, watch.seconds


def test_the_first_call_compiles_once_in_a_stage_of_its_own(four_times):
    """One stage, though two functions are compiled; then the stage that waited goes on."""
    function = four_times()
    reported, seconds = in_a_stage(function)
    assert reported == [("work", ""), (COMPILATION, ""), (COMPILATION, "by numba, once"), ("work", "")]
    assert seconds.keys() == {"work", COMPILATION}
    assert in_a_stage(function)[0] == [("work", "")]


def test_machine_code_that_is_kept_is_no_stage(four_times):
    in_a_stage(four_times())
    assert in_a_stage(four_times())[0] == [("work", "")]


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("part", [0.0, 0.5, 0.95])
def test_machine_code_that_was_cut_off_is_compiled_again(four_times, tmp_path, ending, part):
    """Index and code, of the inner function too; afterwards what is kept is whole."""
    in_a_stage(four_times())
    files = list(tmp_path.rglob(f"*.{ending}"))
    assert len(files) == 2
    for file in files:
        whole = file.read_bytes()
        file.write_bytes(whole[: int(part * len(whole))])
    assert COMPILATION in in_a_stage(four_times())[1]
    assert in_a_stage(four_times())[0] == [("work", "")]


def test_machine_code_that_can_be_neither_read_nor_replaced_is_an_error(four_times, tmp_path, monkeypatch):
    """The error names the folder to delete."""
    in_a_stage(four_times())
    for file in tmp_path.rglob("*.nbc"):
        file.write_bytes(b"")
    function = four_times()

    def refuse():
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(function._cache, "flush", refuse)
    with pytest.raises(BemContactError, match=r"Permission denied\); delete this folder") as caught:
        function(3)
    assert str(caught.value).startswith(f"{function.stats.cache_path}: ")


def test_compilation_where_nobody_watches(four_times):
    assert four_times()(3) == 12


def test_a_watch_that_fails_ends_and_is_watched_no_longer(four_times):
    """What progress raises comes out of the call, and the next compilation is reported again."""

    @contextmanager
    def failing():
        raise KeyError("progress")
        yield

    with pytest.raises(KeyError), compilation.watched(failing):
        four_times()(3)
    assert COMPILATION in in_a_stage(four_times())[1]


def test_stages_within_others_are_counted_once(monkeypatch):
    """A clock that goes on by one at each look: the sum of all stages is the time from the first look to the last."""
    looks = []
    monkeypatch.setattr("time.perf_counter", lambda: looks.append(None) or float(len(looks)))
    watch = Stopwatch()
    with watch.stage("outer"):
        for name in ("inner", "other", "inner"):
            with watch.stage(name):
                pass
    assert watch.seconds == {"inner": 2.0, "other": 1.0, "outer": 4.0}
    assert sum(watch.seconds.values()) == len(looks) - 1


SOLVED = """
import numba
import bemcontact
problem = bemcontact.load({model!r}, variant="stated mesh")
print(*bemcontact.solve(problem.refined(6)).seconds)
print(*bemcontact.solve(problem, formulation="qp1").seconds)
"""


@pytest.mark.slow
def test_the_first_solve_of_a_machine_says_what_compiled(tmp_path):
    """Assembly in two threads compiles once, and so does the local solver; another process finds all of it."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path), "OMP_NUM_THREADS": "2"}
    command = [sys.executable, "-c", SOLVED.format(model=str(CYLINDER))]
    first, second = (
        subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout.split("\n")[:2]
        for _ in range(2)
    )
    stages = ["mesh", "solution", "recovery", "assessment"]
    assert [line.split() for line in first] == [[COMPILATION, *stages], ["mesh", COMPILATION, *stages[1:]]]
    assert [line.split() for line in second] == [stages, stages]
