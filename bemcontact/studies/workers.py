"""Who solves the tasks of a study: this process, or several on this machine."""

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, contextmanager, suppress
from multiprocessing.connection import Connection

from bemcontact.studies.plan import StudyPlan
from bemcontact.studies.rows import MemberRow, failed_row
from bemcontact.studies.work import Task, listed_rows, one_thread, rows_of_task, take_one_thread

AHEAD = 2
"""Tasks that wait for each worker."""
ENDED = "the process that solved it was ended, perhaps because there was not enough memory"
"""Sentence of a member whose process does not survive it."""

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
    """Some processes that take one thread each, and end with this one, however it ends."""

    def __init__(self, count: int):
        context = multiprocessing.get_context("spawn")
        self.count = count
        self._ends_with, self._alive = context.Pipe(duplex=False)
        self.pool = ProcessPoolExecutor(count, context, initializer=_begin, initargs=(self._ends_with,))

    def get_ready(self) -> None:
        """Start the processes, which read their modules; otherwise each starts with its first task."""
        with suppress(BrokenProcessPool):  # the first task will find out
            for _ in range(self.count):
                self.pool.submit(os.getpid)

    def __exit__(self, *_: object) -> None:
        self._alive.close()  # the processes end, even in the middle of a task
        self.pool.shutdown(cancel_futures=True)
        self._ends_with.close()


@contextmanager
def started(workers: int, tasks: int) -> Iterator[Processes | None]:
    """Processes for so many tasks that get ready at once; None for one worker, which is this process."""
    if workers == 1:
        yield None
        return
    with broken_pipes_are_errors(), Processes(min(workers, max(tasks, 1))) as processes:
        if tasks:
            processes.get_ready()
        yield processes


def rows_by_processes(plan: StudyPlan, tasks: Iterable[Task], processes: Processes) -> Rows:
    """Solve tasks by several processes, in any order.

    If a process is ended from outside, its tasks are solved again, each member by itself; a member of which the process
    ends again is a row that failed.
    """
    waiting, count = iter(tasks), processes.count
    while lost := (yield from _until_broken(plan, waiting, processes)):
        for task in lost:
            for again in (yield from _until_broken(plan, iter([task]), Processes(1))):
                for number in again.wanted:
                    alone = Task(group=(number,), wanted=(number,))
                    if (yield from _until_broken(plan, iter([alone]), Processes(1))):
                        yield failed_row(number, plan.values(number), ENDED)
        processes = Processes(count)


def _until_broken(
    plan: StudyPlan, tasks: Iterator[Task], processes: Processes
) -> Generator[MemberRow, None, Sequence[Task]]:
    """Solve tasks until there is none, or a process is ended; return the tasks that were lost with it."""
    running = dict[Future[list[MemberRow]], Task]()
    lost = deque[Task]()
    with processes:
        while True:
            most = AHEAD * processes.count
            lost.extend(_submitted(processes.pool, plan, tasks, running, most) if not lost else ())
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
    pool: ProcessPoolExecutor,
    plan: StudyPlan,
    tasks: Iterator[Task],
    running: dict[Future[list[MemberRow]], Task],
    most: int,
) -> Iterator[Task]:
    """Hand on tasks until so many are running; yield the one that could not be handed on, if a process was ended."""
    while len(running) < most and (task := next(tasks, None)) is not None:
        try:
            running[pool.submit(listed_rows, plan, task)] = task
        except BrokenProcessPool:
            yield task
            return


def _begin(ends_with: Connection) -> None:
    """Set up a worker process: it takes one thread, and ends with the one that started it, for which interrupts are."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(ends_with,), daemon=True).start()
    take_one_thread()


def _end_with(ends_with: Connection) -> None:
    """Wait until the other end of a pipe is closed, and end this process at once."""
    try:
        ends_with.recv()
    except (EOFError, OSError):
        os._exit(1)
