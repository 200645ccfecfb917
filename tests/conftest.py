"""Every run of the tests tries the same random examples, so that a failure is the change's and not the day's.

Tests run side by side, one on each core; what NumPy calls must not take the cores from one another.
"""

import gc
import os
import sys
from typing import Any

for threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(threads, "1")  # before the first import of NumPy

os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # the many processes that tests start compile each module once
sys.dont_write_bytecode = False  # and the next run need not compile the tests again

import pytest  # noqa: E402
from hypothesis import settings  # noqa: E402

settings.register_profile("repeatable", derandomize=True, deadline=None, max_examples=50)
settings.register_profile("thorough", deadline=None, max_examples=2000)  # by hand: pytest --hypothesis-profile=thorough
settings.load_profile("repeatable")


SLOW = 5.0
"""Seconds of a test that should have the marker slow: five times that of the marker, for a busy machine."""


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """The thousands of tests stay to the end: no time is spent on a search for garbage among them, now or later."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(20_000, 20, 20)  # the rest of the garbage is searched for less often, too
        gc.enable()


@pytest.fixture(autouse=True, scope="session")
def numpy_by_default():
    """Results do not depend on whether a test before has imported numba."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("bemcontact.compilation.numba_is_imported", lambda: False)
        yield


MOST_MESHES = 8
"""Meshes that are kept, with their factorizations."""
FOUND: dict[tuple[str, int], Any] = {}


@pytest.fixture
def meshes_found_once(monkeypatch: pytest.MonkeyPatch):
    """A mesh that tests find for the same problem is found by the first of them: for tests of what is done with it."""
    from bemcontact.adaptivity import adapt

    original = adapt._found

    def found(problem: Any, progress: Any, passes: int = adapt.MOST_PASSES) -> Any:
        asked = (repr((problem.model_dump_json(), problem.case)), passes)
        if asked not in FOUND:
            if len(FOUND) == MOST_MESHES:
                del FOUND[next(iter(FOUND))]
            FOUND[asked] = original(problem, progress, passes)
        return FOUND[asked]

    monkeypatch.setattr(adapt, "_found", found)


def pytest_terminal_summary(terminalreporter):
    """Name the tests that take long and are not marked; they do not fail."""
    for report in [report for group in terminalreporter.stats.values() for report in group]:
        if getattr(report, "duration", 0.0) > SLOW and "slow" not in report.keywords:
            line = f"{report.nodeid}: {report.when} took {report.duration:.0f} s; mark it slow, or make it faster"
            terminalreporter.write_line(line, yellow=True)
