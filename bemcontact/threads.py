"""How many threads share the work: those of all processors for assembly, and one for BLAS but for large matrices.

Products of vectors and small matrices are what contact problems mostly need. Several threads of BLAS wait for each
other in every one of them. On idle processors that makes a solver a few times slower, and on busy ones it may be thirty
times.
"""

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, ContextDecorator, contextmanager, nullcontext
from functools import lru_cache
from typing import TypeVar

import scipy.linalg  # noqa: F401 - loads the BLAS of SciPy
from threadpoolctl import LibController, ThreadpoolController

Item = TypeVar("Item")

WORTH_THREADS = 1e10
"""Products of two numbers from which several threads share the work on a matrix: those of a factorization of size 3100.

Less work takes less than half a second on one thread. Two threads nearly halve that on idle processors. On busy ones
they wait for each other, and take up to three times as long; for more work they lose nothing there.
"""
UNCHANGED = nullcontext()
"""Context in which BLAS takes as many threads as it does."""


def processors() -> int:
    """Number of processors that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def workers() -> int:
    """Number of threads for assembly: that of processors, or fewer if the environment says so by OMP_NUM_THREADS."""
    stated = os.environ.get("OMP_NUM_THREADS", "").strip()
    return min(processors(), max(1, int(stated))) if stated.isdecimal() else processors()


def share_out(work: Callable[[Sequence[Item]], object], items: Sequence[Item]) -> None:
    """Let `work` do all items, some in each of several threads; with one worker or one item, in this thread."""
    count = min(len(items), workers()) if len(items) > 1 else 1
    if count == 1:
        work(items)
        return
    with ThreadPoolExecutor(count) as pool:
        for _ in pool.map(work, [items[first::count] for first in range(count)]):
            pass


@lru_cache(maxsize=1)
def _libraries() -> list[LibController]:
    """The BLAS libraries of NumPy and SciPy, which must be loaded to be found."""
    return ThreadpoolController().select(user_api="blas").lib_controllers


class _OneThread(ContextDecorator):
    """BLAS takes one thread until the last of those that asked for it is done, in whatever thread they are."""

    def __init__(self):
        self.lock, self.users = threading.Lock(), 0
        self.before: list[tuple[LibController, int]] = []

    def __enter__(self) -> None:
        with self.lock:
            if not self.users:
                self.before = [(library, library.get_num_threads() or 1) for library in _libraries()]
                self._set(1)
            self.users += 1

    def __exit__(self, *_: object) -> None:
        with self.lock:
            self.users -= 1
            if not self.users:
                self._set(None)

    def _set(self, threads: int | None) -> None:
        """Let each library that had several threads take so many; None: as many as before."""
        for library, before in self.before:
            if before > 1:
                library.set_num_threads(threads or before)

    def lifted(self, products: float) -> AbstractContextManager[None]:
        """As many threads as before, for so many products of two numbers if these are worth it."""
        return self._many_threads() if products >= WORTH_THREADS else UNCHANGED

    @contextmanager
    def _many_threads(self) -> Iterator[None]:
        """As many threads as before."""
        with self.lock:
            if self.users:
                self._set(None)
        try:
            yield
        finally:
            with self.lock:
                if self.users:
                    self._set(1)


one_thread = _OneThread()
"""Decorator and context in which BLAS takes one thread."""
