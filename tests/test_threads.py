"""How many threads assembly and BLAS take.

BLAS takes one in all that is decorated, and as many as before when it is done.
"""

import os
import subprocess
import sys
import threading

import numpy as np
import pytest

import bemcontact
from bemcontact import threads
from bemcontact.analysis.case_comparisons import compare_cases
from bemcontact.analysis.compare import mesh_study
from bemcontact.threads import WORTH_THREADS, one_thread

REAL = """
import numpy as np
from threadpoolctl import threadpool_info
from bemcontact.threads import one_thread
def threads(): return {item["num_threads"] for item in threadpool_info() if item["user_api"] == "blas"}
before = threads()
with one_thread: inside = threads()
print(before == {2}, inside == {1}, threads() == before)
"""


class Library:
    """A BLAS with two threads, of which the tests see how many are set; in these tests the real one has one."""

    def __init__(self):
        self.threads = [2]

    def get_num_threads(self) -> int:
        return self.threads[-1]

    def set_num_threads(self, threads: int) -> None:
        self.threads.append(threads)


@pytest.fixture(autouse=True)
def library(monkeypatch):
    found = Library()
    monkeypatch.setattr(threads, "_libraries", lambda: [found])
    monkeypatch.setattr(one_thread, "before", [])
    return found


@pytest.fixture
def taken(library):
    return lambda: {library.threads[-1]}


def test_one_thread_until_the_last_is_done(taken):
    with one_thread:
        assert taken() == {1}
        with one_thread:
            assert taken() == {1}
        assert taken() == {1}
    assert taken() == {2}


def test_an_error_restores_them(taken):
    with pytest.raises(ZeroDivisionError), one_thread:
        raise ZeroDivisionError
    assert taken() == {2}


def test_large_factors_take_all_of_them(taken):
    with one_thread.lifted(WORTH_THREADS):
        assert taken() == {2}
    with one_thread:
        with one_thread.lifted(WORTH_THREADS - 1):
            assert taken() == {1}
        with one_thread.lifted(WORTH_THREADS):
            assert taken() == {2}
        assert taken() == {1}
    assert taken() == {2}


def test_threads_of_the_program_share_it(taken):
    """One ends while the other is inside."""
    inside, done = threading.Event(), threading.Event()

    def other():
        with one_thread:
            inside.set()
            done.wait()

    running = threading.Thread(target=other)
    running.start()
    inside.wait()
    with one_thread:
        pass
    assert taken() == {1}
    done.set()
    running.join()
    assert taken() == {2}


@pytest.mark.parametrize(
    "function", [bemcontact.solve, bemcontact.condense, bemcontact.compare, bemcontact.follow, bemcontact.minimize_qp,
                 bemcontact.solve_lcp, bemcontact.solve_cases, bemcontact.load_path, bemcontact.design_gap,
                 bemcontact.random_starts, bemcontact.sensitivities, bemcontact.ContactModel.solve, compare_cases,
                 mesh_study],
)  # fmt: skip
def test_all_that_computes_is_decorated(function):
    assert function.__wrapped__.__name__ == function.__name__


def test_the_real_libraries_are_set_and_restored():
    """Where the variable gives two threads to all libraries, as OpenBLAS, MKL and BLIS have it."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    two = os.environ | dict.fromkeys(names, "2")
    printed = subprocess.run([sys.executable, "-c", REAL], env=two, capture_output=True, text=True, check=True).stdout
    if printed.startswith("False"):
        pytest.skip("the BLAS at hand does not follow these variables, or there is one processor")
    assert printed.split() == ["True"] * 3


def test_solvers_work_inside():
    assert bemcontact.solve_lcp(np.eye(2), [-1.0, -1.0]).z == pytest.approx([1, 1])


@pytest.mark.parametrize(("stated", "expected"), [("1", 1), ("2", 2), ("9", 3), ("", 3), ("many", 3)])
def test_work_is_shared_out_to_as_many_threads_as_the_environment_says(monkeypatch, stated, expected):
    monkeypatch.setenv("OMP_NUM_THREADS", stated)
    monkeypatch.setattr(threads, "processors", lambda: 3)
    met, done = threading.Barrier(expected, timeout=10), []

    def work(items):
        met.wait()  # all threads are at work at one time, or this fails
        done.append(items)

    threads.share_out(work, range(7))
    assert sorted(item for items in done for item in items) == [*range(7)]
    assert len(done) == expected
