"""Several processes: the same rows, also after one of them is killed."""

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures.process import ProcessPoolExecutor
from pathlib import Path

import pytest

import bemcontact
from bemcontact.studies import workers
from bemcontact.studies.plan import StudyPlan, study_plan
from bemcontact.studies.rows import MemberRow
from bemcontact.studies.work import tasks_of
from bemcontact.studies.workers import Processes, rows_by_processes, rows_here

MODEL = Path(__file__).parents[2] / "models" / "cylinder_on_plane.yaml"
CYLINDER = bemcontact.load(MODEL, variant="paper").with_value("accuracy", 0.01)
PLAN = study_plan(CYLINDER, {"conditions.top.pressure": [10, 20, 30], "material.young_modulus": [900, 1000, 1100]})


def sorted_by_number(rows: workers.Rows) -> list[MemberRow]:
    return sorted(rows, key=lambda row: row.number)


def here(plan: StudyPlan) -> list[MemberRow]:
    return sorted_by_number(rows_here(plan, tasks_of(plan, [False] * len(plan))))


@pytest.mark.slow
def test_two_processes_find_the_same_rows_though_one_is_killed(monkeypatch: pytest.MonkeyPatch):
    pools = list[ProcessPoolExecutor]()

    original = workers.ProcessPoolExecutor

    def watched(*arguments: object, **options: object) -> ProcessPoolExecutor:
        pools.append(original(*arguments, **options))  # pyright: ignore
        return pools[-1]

    monkeypatch.setattr(workers, "ProcessPoolExecutor", watched)
    rows = list[MemberRow]()
    for row in rows_by_processes(tasks_of(PLAN, [False] * len(PLAN)), Processes(2, PLAN)):
        rows.append(row)
        if len(rows) == 3:
            os.kill(next(iter(pools[0]._processes)), signal.SIGKILL)
    assert sorted(rows, key=lambda item: item.number) == here(PLAN)
    assert len(pools) > 1


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="processes are forked on Linux")
def test_forked_processes_find_the_same_rows_and_which_values_are_possible():
    """In a program of its own, as the command line is: what else this process has started, nobody knows."""
    answer = subprocess.run([sys.executable, "-c", FORKED], capture_output=True, text=True, check=True)
    assert answer.stdout.split() == ["True", "True", "False", "True"]
    assert answer.stderr == ""


FORKED = f"""
import bemcontact
from bemcontact.studies.plan import study_plan
from bemcontact.studies.work import tasks_of
from bemcontact.studies.workers import Processes, rows_by_processes, rows_here, started
cylinder = bemcontact.load({str(MODEL)!r}, variant="paper")
values = [900.0, 1000.0, 1100.0, 1200.0, -1.0]
for last in (4, 5):
    plan = study_plan(cylinder, {{"material.young_modulus": values[:last]}})
    tasks = [*tasks_of(plan, [False] * last)]
    with started(plan, 2, last, in_program=True) as processes:
        print(processes.find_possible())
        rows = rows_by_processes(tasks, processes)
        print(sorted(rows, key=lambda row: row.number) == [*rows_here(plan, tasks)])
"""


INTERRUPTED = """
import _thread, os, signal, sys
from bemcontact.studies.workers import Processes
signal.signal(signal.SIGINT, signal.default_int_handler)
os.register_at_fork(before=_thread.interrupt_main)  # as one that comes between two lines of Python
with Processes(2, None, forked=True) as processes:
    try:
        processes.get_ready()
    except KeyboardInterrupt:
        print("interrupted")
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere processes are not forked")
def test_an_interrupt_is_not_lost_while_processes_are_forked():
    """Python drops what is raised in the hooks of a fork, such as those of `logging`, and prints it."""
    done = subprocess.run([sys.executable, "-c", INTERRUPTED], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("interrupted\n", "")


@pytest.mark.slow
def test_processes_end_when_nobody_wants_more_rows():
    before = set(threading.enumerate())
    found = rows_by_processes(tasks_of(PLAN, [False] * len(PLAN)), Processes(2, PLAN))
    next(found)
    began = time.perf_counter()
    found.close()
    assert time.perf_counter() - began < 20
    assert not {thread for thread in set(threading.enumerate()) - before if thread.name.startswith("ExecutorManager")}


def test_the_number_of_threads_is_as_before_afterwards(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    plan = study_plan(CYLINDER.with_value("accuracy", None), {"conditions.top.pressure": [10]})
    assert len(here(plan)) == 1
    assert os.environ["OMP_NUM_THREADS"] == "7"


WORKER = """
import os
from multiprocessing import Pipe
from threadpoolctl import threadpool_info
from bemcontact.studies.workers import _begin
from bemcontact.threads import WORTH_THREADS, one_thread, workers
ends_with, alive = Pipe(duplex=False)
_begin(None, ends_with, None)
with one_thread, one_thread.lifted(WORTH_THREADS):
    print(workers(), {item["num_threads"] for item in threadpool_info()})
"""


@pytest.mark.slow
def test_a_worker_takes_one_thread_even_for_large_matrices():
    """Where the environment gives two: the workers share the processors."""
    two = os.environ | dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "2")
    answer = subprocess.run([sys.executable, "-c", WORKER], env=two, capture_output=True, text=True, check=True)
    assert answer.stdout.split() == ["1", "{1}"]


@pytest.mark.slow
@pytest.mark.parametrize("by_standard_input", [False, True])
def test_processes_that_cannot_begin_are_an_error_and_no_rows(tmp_path: Path, by_standard_input: bool):
    """They import the script again: one without the line for it calls the study in each, and standard input is gone."""
    script = tmp_path / "script.py"
    script.write_text(
        "import bemcontact\n"
        f"problem = bemcontact.load({str(MODEL)!r}, variant='paper')\n"
        f"bemcontact.study(problem, {{'conditions.top.pressure': [10, 20]}}, out='out', workers=2)\n"
    )
    command = [sys.executable, "-" if by_standard_input else str(script)]
    with script.open() as source:
        ended = subprocess.run(
            command, check=False, cwd=tmp_path, stdin=source, capture_output=True, text=True, timeout=100
        )
    assert ended.returncode == 1
    assert ended.stderr.strip().endswith(f"BemContactError: {workers.NOT_BEGUN}")
    assert not list((tmp_path / "out").glob("study.*"))
    assert (tmp_path / "out" / "members.jsonl").read_text().count("\n") <= 1  # the first line, and no row
