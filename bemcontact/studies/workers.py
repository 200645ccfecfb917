"""Who solves the tasks of a study: this process, or several on this machine."""

import multiprocessing
import os
import signal
import sys
import threading
import warnings
from collections import deque
from collections.abc import Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, contextmanager, suppress
from contextvars import ContextVar
from multiprocessing.connection import Connection

from bemcontact.errors import BemContactError, ProblemError
from bemcontact.interrupts import interrupts
from bemcontact.studies.plan import StudyPlan
from bemcontact.studies.rows import MemberRow, failed_row
from bemcontact.studies.work import Task, one_thread, rows_of_task, take_one_thread

AHEAD = 2
"""Tasks that wait for each worker."""
PARTS = 4
"""Parts of the values of a study that each worker checks."""
ENDED = "the process that solved it was ended, perhaps because there was not enough memory"
"""Sentence of a member whose process does not survive it."""
NOT_BEGUN = (
    "the processes of the study end before they begin to work. Each of them imports the script that starts them: it "
    "must be a file, and call the study below the line if __name__ == '__main__'. Otherwise take workers=1"
)
"""Sentence of a study whose processes cannot begin."""

_PLAN = ContextVar[StudyPlan]("plan")
"""In a worker process: the plan of its tasks, which are small without it, however many members there are."""

Rows = Generator[MemberRow, None, None]


@contextmanager
def broken_pipes_are_errors() -> Iterator[None]:
    """Let a pipe or socket whose reader has ended raise an error, where it would end this process by SIGPIPE.

    The command line ends by SIGPIPE as other programs do. A worker that was killed must not end it.
    """
    if not hasattr(signal, "SIGPIPE") or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGPIPE, before)


def rows_here(plan: StudyPlan, tasks: Iterable[Task]) -> Rows:
    """Solve tasks in this process, one after the other."""
    with one_thread():
        for task in tasks:
            yield from rows_of_task(plan, task)


class Processes(AbstractContextManager["Processes"]):
    """Some processes for the tasks of a plan, that take one thread each, and end with this one, however it ends.

    A forked process has all modules already. It also has all locks as they are, and would wait for ever for one that
    another thread holds. So the program alone forks: its other thread shows progress, which a worker does not.
    """

    def __init__(self, count: int, plan: StudyPlan, *, forked: bool = False):
        context = multiprocessing.get_context("fork" if forked else "spawn")
        self.count, self.plan, self.forked = count, plan, forked
        self._ends_with, self._alive = context.Pipe(duplex=False)
        inherited = self._alive if forked else None
        begin = (plan, self._ends_with, inherited)
        self.pool = ProcessPoolExecutor(count, context, initializer=_begin, initargs=begin)
        self._first: list[Future[int]] = []

    def get_ready(self) -> None:
        """Start the processes, which read their modules if need be; otherwise each starts with its first task."""
        with interrupts(), suppress(BrokenProcessPool), warnings.catch_warnings():  # the first task will find out
            warnings.filterwarnings("ignore", ".* is multi-threaded", DeprecationWarning)  # BLAS knows how to fork
            for _ in range(self.count):
                self._first.append(self.pool.submit(os.getpid))

    @property
    def begun(self) -> bool:
        """Whether one of the processes that get ready has begun to work."""
        return any(first.done() and first.exception() is None for first in self._first)

    def find_possible(self) -> bool:
        """Whether forked processes find all values of the plan possible; False too if one of them ends."""
        if not self.forked:  # the values are checked before they are ready
            return False
        values = sum(len(axis.values) for axis in self.plan.axes)
        ends = [values * part // (PARTS * self.count) for part in range(PARTS * self.count + 1)]
        try:
            return all(self.pool.map(_possible, ends, ends[1:]))
        except BrokenProcessPool:
            return False

    def __exit__(self, *_: object) -> None:
        self._alive.close()  # the processes end, even in the middle of a task
        self.pool.shutdown(cancel_futures=True)
        self._ends_with.close()


@contextmanager
def started(plan: StudyPlan, workers: int, tasks: int, *, in_program: bool) -> Iterator[Processes | None]:
    """Processes for so many tasks of a plan that get ready at once; None for one worker, which is this process.

    `in_program` says that this process is the program. There they are forked on Linux, where its libraries allow it.
    """
    if workers == 1:
        yield None
        return
    forked = in_program and sys.platform == "linux"
    with broken_pipes_are_errors(), Processes(min(workers, max(tasks, 1)), plan, forked=forked) as processes:
        if tasks:
            processes.get_ready()
        yield processes


def rows_by_processes(tasks: Iterable[Task], processes: Processes) -> Rows:
    """Solve tasks by several processes, in any order.

    If a process is ended from outside, its tasks are solved again, each member by itself; a member of which the process
    ends again is a row that failed. `BemContactError` if no process can begin.
    """
    waiting, count, plan = iter(tasks), processes.count, processes.plan
    while lost := (yield from _until_broken(waiting, processes)):
        for task in lost:
            for again in (yield from _by_one(task, plan)):
                for number in again.wanted:
                    alone = Task(group=(number,), wanted=(number,))
                    if (yield from _by_one(alone, plan)):
                        yield failed_row(number, plan.values(number), ENDED)
        processes = Processes(count, plan)


def _by_one(task: Task, plan: StudyPlan) -> Generator[MemberRow, None, Sequence[Task]]:
    """Solve a task by a process of its own; return it if the process is ended, `BemContactError` if it cannot begin."""
    process = Processes(1, plan)
    process.get_ready()
    lost = yield from _until_broken(iter([task]), process)
    if lost and not process.begun:
        raise BemContactError(NOT_BEGUN)
    return lost


def _until_broken(tasks: Iterator[Task], processes: Processes) -> Generator[MemberRow, None, Sequence[Task]]:
    """Solve tasks until there is none, or a process is ended; return the tasks that were lost with it."""
    running = dict[Future[list[MemberRow]], Task]()
    lost = deque[Task]()
    with processes:
        while True:
            most = AHEAD * processes.count
            lost.extend(_submitted(processes.pool, tasks, running, most) if not lost else ())
            if not running:
                return lost
            finished, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in finished:
                task = running.pop(future)
                try:
                    rows = future.result()
                except BrokenProcessPool:
                    lost.append(task)
                    continue
                yield from rows


def _submitted(
    pool: ProcessPoolExecutor, tasks: Iterator[Task], running: dict[Future[list[MemberRow]], Task], most: int
) -> Iterator[Task]:
    """Hand on tasks until so many are running; yield the one that could not be handed on, if a process was ended."""
    while len(running) < most and (task := next(tasks, None)) is not None:
        try:
            running[pool.submit(_rows, task)] = task
        except BrokenProcessPool:
            yield task
            return


def _begin(plan: StudyPlan, ends_with: Connection, inherited: Connection | None) -> None:
    """Set up a worker process: it takes one thread, and ends with the one that started it, for which interrupts are.

    A forked one has inherited the end of the pipe that only that process may have open, and a display of progress.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if inherited is not None:
        inherited.close()
        sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__
    threading.Thread(target=_end_with, args=(ends_with,), daemon=True).start()
    take_one_thread()
    _PLAN.set(plan)


def _possible(first: int, last: int) -> bool:
    """Whether some values of the plan are possible, in a worker process."""
    try:
        _PLAN.get().ensure_possible(first, last)
    except ProblemError:
        return False
    return True


def _rows(task: Task) -> list[MemberRow]:
    """Solve a task of the plan in a worker process."""
    return [*rows_of_task(_PLAN.get(), task)]


def _end_with(ends_with: Connection) -> None:
    """Wait until the other end of a pipe is closed, and end this process at once."""
    try:
        ends_with.recv()
    except (EOFError, OSError):
        os._exit(1)
