"""Members of a study on a cluster, by Dask."""

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any

from bemcontact.errors import BemContactError, OptionError, escaped
from bemcontact.studies.plan import StudyPlan
from bemcontact.studies.rows import failed_row
from bemcontact.studies.work import Task, rows_on_one_thread
from bemcontact.studies.workers import AHEAD, ENDED, Rows

PATIENCE = 20
"""Seconds to wait for the scheduler."""
SILENCE = 3.0
"""Seconds without a result after which it is looked whether there are workers."""
POLL = 0.02
"""Seconds between looks for a result."""


def ensure_dask() -> None:
    """Refuse a scheduler without the extra that a cluster needs."""
    if find_spec("distributed") is None:
        raise OptionError("a scheduler needs dask.distributed, which is not installed; pip install 'bemcontact[dask]'")


@contextmanager
def connected(scheduler: str | None) -> Iterator[Any]:
    """A client of the Dask scheduler at an address; None without an address.

    `OptionError` if there is no scheduler at the address.
    """
    if scheduler is None:
        yield None
        return
    ensure_dask()
    with _client(scheduler) as client:
        yield client


def rows_by_dask(plan: StudyPlan, tasks: Iterable[Task], client: Any, say: Callable[[str], object]) -> Rows:
    """Solve tasks on the workers of a Dask cluster, in any order; the tasks of a worker that ends go to the others.

    While there is no worker, `say` is called with a text that says so.
    """
    import distributed

    waiting, own = iter(tasks), dict[str, Task]()
    finished = distributed.as_completed(loop=client.loop, raise_errors=False)

    def hand_on() -> None:
        most = AHEAD * max(1, sum(client.nthreads().values()))
        while len(own) < most and (task := next(waiting, None)) is not None:
            future = client.submit(rows_on_one_thread, plan, task, pure=False)
            own[future.key] = task
            finished.add(future)

    try:
        hand_on()
        while (future := _next(finished, client, say)) is not None:
            if future.status == "lost":  # a worker that has ended had the result: others compute it again
                finished.add(future)
                continue
            task = own.pop(future.key)
            yield from _rows(plan, task, future)
            future.release()
            hand_on()
    except (distributed.CancelledError, OSError):
        raise BemContactError("the connection to the Dask scheduler is lost; what was done is kept") from None


def _next(finished: Any, client: Any, say: Callable[[str], object]) -> Any:
    """Wait for a task that has ended, and say if there is no worker for some time; None if all have ended before."""
    address, begin = client.scheduler.address, time.monotonic()
    while not (finished.has_ready() or finished.is_empty()):
        time.sleep(POLL)
        if time.monotonic() - begin >= SILENCE:
            if _has_no_worker(client):
                say(f"waits for workers of the Dask scheduler; start one with 'dask worker {address}'")
            begin = time.monotonic()
    return next(finished, None)


def _has_no_worker(client: Any) -> bool:
    """Whether the scheduler of a client has no worker; a connection that is lost ends the tasks by itself."""
    try:
        return not client.nthreads()
    except OSError:
        return False


def _rows(plan: StudyPlan, task: Task, future: Any) -> Rows:
    """Rows of a task that has ended; that of which several workers have ended is tried no more."""
    import distributed

    try:
        rows = future.result()
    except distributed.KilledWorker:
        rows = [failed_row(number, plan.values(number), ENDED) for number in task.wanted]
    except Exception as error:
        if future.status != "error" and isinstance(error, distributed.CancelledError | OSError):
            raise  # this was the connection, and no task
        raise BemContactError(f"the cluster could not solve the study: {escaped(repr(error))}") from error
    yield from rows


def _client(scheduler: str) -> Any:
    """A client of a scheduler; `OptionError` if nobody answers."""
    import distributed

    try:
        return distributed.Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError, AssertionError) as error:  # one of them for each kind of wrong address
        reason = escaped(str(error)) or type(error).__name__
        raise OptionError(
            f"no Dask scheduler answers at {escaped(scheduler)} ({reason}); start one with 'dask scheduler'"
        ) from None
