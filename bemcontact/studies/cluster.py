"""Members of a study on a cluster, by Dask."""

from collections.abc import Iterable
from importlib.util import find_spec
from typing import Any

from bemcontact.errors import BemContactError, OptionError, escaped
from bemcontact.studies.plan import StudyPlan
from bemcontact.studies.rows import failed_row
from bemcontact.studies.work import Task, rows_on_one_thread
from bemcontact.studies.workers import AHEAD, ENDED, Rows

PATIENCE = 20
"""Seconds to wait for the scheduler."""


def ensure_dask() -> None:
    """Refuse a scheduler without the extra that a cluster needs."""
    if find_spec("distributed") is None:
        raise OptionError("a scheduler needs dask.distributed, which is not installed; pip install 'bemcontact[dask]'")


def rows_by_dask(plan: StudyPlan, tasks: Iterable[Task], scheduler: str) -> Rows:
    """Solve tasks on the workers of a Dask cluster, in any order; the tasks of a worker that ends go to the others.

    `OptionError` if there is no scheduler at the address.
    """
    ensure_dask()
    import distributed

    with _client(scheduler) as client:
        waiting, own = iter(tasks), dict[str, Task]()
        finished = distributed.as_completed(loop=client.loop, raise_errors=False)

        def hand_on() -> None:
            most = AHEAD * max(1, sum(client.nthreads().values()))
            while len(own) < most and (task := next(waiting, None)) is not None:
                future = client.submit(rows_on_one_thread, plan, task, pure=False)
                own[future.key] = task
                finished.add(future)

        hand_on()
        for future in finished:
            task = own.pop(future.key)
            yield from _rows(plan, task, future)
            future.release()
            hand_on()


def _rows(plan: StudyPlan, task: Task, future: Any) -> Rows:
    """Rows of a task that has ended; that of which several workers have ended is tried no more."""
    import distributed

    if future.status in ("cancelled", "lost"):
        raise BemContactError("the connection to the Dask scheduler is lost; what was done is kept")
    error = future.exception() if future.status != "finished" else None
    if error is None:
        yield from future.result()
        return
    if not isinstance(error, distributed.KilledWorker):
        raise BemContactError(f"the cluster could not solve the study: {escaped(repr(error))}")
    yield from (failed_row(number, plan.values(number), ENDED) for number in task.wanted)


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
