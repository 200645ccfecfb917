"""Who solves the tasks of a study: this process, or several on this machine."""

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
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


def rows_by_processes(plan: StudyPlan, tasks: Iterable[Task], workers: int) -> Rows:
    """Solve tasks by several processes, in any order.

    If a process is ended from outside, its tasks are solved again, each member by itself; a member of which the process
    ends again is a row that failed. If this process ends, however it ends, the others end too.
    """
    waiting = iter(tasks)
    while lost := (yield from _until_broken(plan, waiting, workers)):
        for task in lost:
            for again in (yield from _until_broken(plan, iter([task]), 1)):
                for number in again.wanted:
                    alone = Task(group=(number,), wanted=(number,))
                    if (yield from _until_broken(plan, iter([alone]), 1)):
                        yield failed_row(number, plan.values(number), ENDED)


def _until_broken(plan: StudyPlan, tasks: Iterator[Task], workers: int) -> Generator[MemberRow, None, Sequence[Task]]:
    """Solve tasks until there is none, or a process is ended; return the tasks that were lost with it."""
    context = multiprocessing.get_context("spawn")
    ends_with, alive = context.Pipe(duplex=False)
    pool = ProcessPoolExecutor(workers, context, initializer=_begin, initargs=(ends_with,))
    running = dict[Future[list[MemberRow]], Task]()
    lost = deque[Task]()
    try:
        while True:
            lost.extend(_submitted(pool, plan, tasks, running, AHEAD * workers) if not lost else ())
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
    finally:
        alive.close()  # the processes end, even in the middle of a task
        pool.shutdown(cancel_futures=True)
        ends_with.close()


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
