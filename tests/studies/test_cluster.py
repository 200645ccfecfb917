"""A Dask cluster on this machine: the same rows, also after one of its workers is killed."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import bemcontact
from bemcontact.errors import BemContactError, ProblemError
from bemcontact.studies import cluster
from bemcontact.studies.cluster import connected, rows_by_dask
from bemcontact.studies.plan import study_plan
from bemcontact.studies.rows import MemberRow
from bemcontact.studies.work import tasks_of
from bemcontact.studies.workers import rows_here

MODELS = Path(__file__).parents[2] / "models"
CYLINDER = bemcontact.load(MODELS / "cylinder_on_plane.yaml", variant="paper").with_value("accuracy", 0.01)
VARIED = {"conditions.top.pressure": [10, 20, 30], "material.young_modulus": [900, 1000, 1100, 1200]}
PLAN = study_plan(CYLINDER, VARIED)


def ignored(_: str) -> None:
    """Takes what is said."""


@contextmanager
def cluster_of(folder: Path) -> Iterator[tuple[str, Callable[[str], subprocess.Popen[bytes]]]]:
    """A scheduler: its address, and a function that starts a worker process of a name."""
    root = str(Path(bemcontact.__file__).parents[1])
    environment = {**os.environ, "PYTHONPATH": root, "OMP_NUM_THREADS": "1"}
    run = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    file = folder / "scheduler.json"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment, "cwd": folder}
    scheduler = ["--scheduler-file", str(file)]
    started = [subprocess.Popen([*run, *scheduler, "--port", "0", "--no-dashboard", "--host", "127.0.0.1"], **quiet)]
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", *scheduler, "--nthreads", "1", "--no-nanny"]
    try:
        deadline = time.monotonic() + 60
        while not file.is_file() and time.monotonic() < deadline:
            time.sleep(0.1)

        def start(name: str) -> subprocess.Popen[bytes]:
            started.append(subprocess.Popen([*worker, "--no-dashboard", "--name", name], **quiet))
            return started[-1]

        yield json.loads(file.read_text(encoding="utf-8"))["address"], start
    finally:
        for process in reversed(started):
            process.kill()
            process.wait()


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_cluster_finds_the_same_rows_though_a_worker_is_killed(tmp_path: Path):
    expected = sorted(rows_here(PLAN, tasks_of(PLAN, [False] * len(PLAN))), key=lambda row: row.number)
    rows = list[MemberRow]()
    with cluster_of(tmp_path) as (address, start), connected(address) as client:
        workers = [start(name) for name in ("a", "b")]
        for row in rows_by_dask(PLAN, tasks_of(PLAN, [False] * len(PLAN)), client, ignored):
            rows.append(row)
            if len(rows) == 3:
                workers[0].send_signal(signal.SIGKILL)
    assert sorted(rows, key=lambda row: row.number) == expected


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_results_that_are_lost_with_their_workers_are_computed_again(tmp_path: Path):
    """All workers end when the last results are done and not yet read; then there is a new one."""
    rows = list[MemberRow]()
    with cluster_of(tmp_path) as (address, start), connected(address) as client:
        workers = [start(name) for name in ("a", "b")]

        def wait_for(status: str) -> None:
            deadline = time.monotonic() + 60
            while {future.status for future in client.futures.values()} != {status} and time.monotonic() < deadline:
                time.sleep(0.01)
            assert {future.status for future in client.futures.values()} == {status}

        for row in rows_by_dask(PLAN, tasks_of(PLAN, [False] * len(PLAN)), client, ignored):
            rows.append(row)
            if len(rows) == 1:
                wait_for("finished")
                for worker in workers:
                    worker.kill()
                wait_for("lost")
                start("c")
    assert sorted(row.number for row in rows) == [*range(len(PLAN))]
    assert {row.holds for row in rows} == {True}


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_scheduler_that_ends_is_an_error_that_says_so(tmp_path: Path):
    """What was done is kept by the journal; the client would say that a pool of connections is closed."""
    with cluster_of(tmp_path) as (address, start), connected(address) as client:
        start("a")
        rows = rows_by_dask(PLAN, tasks_of(PLAN, [False] * len(PLAN)), client, ignored)
        next(rows)
        os.kill(client.run_on_scheduler(os.getpid), signal.SIGKILL)
        with pytest.raises(BemContactError, match="connection to the Dask scheduler is lost"):
            list(rows)


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_study_says_that_it_waits_for_workers_and_goes_on_when_there_is_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """A scheduler without workers was waited for without a word. The first worker is started when this is said."""
    monkeypatch.setattr(cluster, "SILENCE", 0.2)
    said = list[str]()
    with cluster_of(tmp_path) as (address, start):

        def progress(_: str, now: str) -> None:
            if "waits" in now and not any("waits" in line for line in said):
                start("late")
            said.append(now)

        found = bemcontact.study(CYLINDER, {"conditions.top.pressure": [10, 20]}, scheduler=address, progress=progress)
    words = f"waits for workers of the Dask scheduler; start one with 'dask worker {address}'"
    assert said.index(words) == 1
    assert said[0] == "0 of 2 members"
    assert said[-1].startswith("2 of 2 members")
    assert found.counts == {"holds": 2}


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_scheduler_that_does_not_answer_is_an_error_and_leaves_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(cluster, "PATIENCE", 1)
    folder = tmp_path / "study"
    with pytest.raises(ProblemError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9"):
        bemcontact.study(CYLINDER, VARIED, scheduler="tcp://127.0.0.1:9", out=folder)
    assert not folder.exists()


def test_without_dask_the_extra_is_named(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(cluster, "find_spec", lambda _: None)
    with pytest.raises(ProblemError, match=r"pip install 'bemcontact\[dask\]'"):
        bemcontact.study(CYLINDER, VARIED, scheduler="tcp://127.0.0.1:9")
