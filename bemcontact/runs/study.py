"""Studies of parameters: a grid of values, solved by several workers, kept in a folder."""

import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, nullcontext
from dataclasses import replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, Unpack

from bemcontact.analysis.solve import Progress
from bemcontact.checks.arguments import ensure_callable, file_path, text_of_argument, whole_number
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen
from bemcontact.options import ASKING, AskingKeywords, ensure_known
from bemcontact.problems.problem import Problem
from bemcontact.report.folder_kinds import STUDY, ensure_folder_writable
from bemcontact.studies.cluster import connected, ensure_dask, rows_by_dask
from bemcontact.studies.journal import JOURNAL, Journal, alone, opened, recorded, state_of
from bemcontact.studies.outputs import chosen, of_stress
from bemcontact.studies.plan import StudyPlan, study_plan
from bemcontact.studies.rows import MemberRow, row_from
from bemcontact.studies.table import StudyTable, sorted_rows
from bemcontact.studies.work import Task, tasks_of
from bemcontact.studies.workers import (
    Processes,
    Rows,
    broken_pipes_are_errors,
    rows_by_processes,
    rows_here,
    started,
)

MOST_WORKERS = 1000
"""Largest number of processes; more members at once need a cluster."""
STAGE = "studying"
"""Name of the stage in progress."""


@frozen
class Study(StudyTable):
    """A study of parameters: a row for each member, with its outputs, their errors and its verdicts.

    Parameters
    ----------
    name : of the problem
    units : labels of the units
    axes : what is varied; the first axis changes slowest
    outputs : names of the outputs that are shown
    rows : members in the order of the grid; `table` has them as columns
    """

    def save(self, folder: str | Path, spec: str | None = None) -> None:
        """Write the study into a folder: page, tables, pictures.

        Parameters
        ----------
        folder : a new one, or one with an earlier study, which is replaced
        spec : text of the problem as run, for the page, if there is one

        Raises
        ------
        OSError
            If the folder cannot be written, or holds other files.
        """
        from bemcontact.report.folder import save_study

        save_study(self, file_path(folder, "folder"), spec)


def study(
    problem: Problem,
    vary: Mapping[Any, Sequence[Any]],
    output: str | Sequence[str] | None = None,
    *,
    out: str | Path | None = None,
    workers: int = 1,
    scheduler: str | None = None,
    progress: Progress | None = None,
    **asking: Unpack[AskingKeywords],
) -> Study:
    """Solve a problem for all combinations of some values, with one row for each.

    A member that fails, or that is not certified or not accurate enough, is a row that says so. Members whose mesh is
    stated, and which differ in loads, gaps and tools only, are condensed together.

    Parameters
    ----------
    problem : Problem
    vary : lists of values by key, such as ``{"conditions.top.pressure": [10, 20]}``. Keys are those of
        `Problem.with_value`; "variant"; "case" for load cases; "load_cases.wind" for the factor of one. A tuple of
        keys, or keys with commas between them, take the same values. "radius: KEY1,KEY2" names the column of the table.
        Of a problem with load cases all are solved, unless one is chosen.
    output : names of outputs, such as "peak", "resultant", "force", "length.foot", in a list or with commas in a text;
        each row keeps all of them, and the largest stresses "von_mises" and "max_shear" if one of these is named
    out : folder for tables, page and pictures, and for a journal from which a run that ended early goes on
    workers : number of processes; 1 solves in this process. With more, a script needs the line
        ``if __name__ == "__main__":``, because each process imports it.
    scheduler : address of a Dask scheduler, on whose workers the members are solved; needs the extra ``dask``
    progress : called with two texts, the name of the stage and how far it has come
    asking : variant, set, case, accuracy and refine, as of `bemcontact.solve`; a mesh is found for each member

    Returns
    -------
    Study
        Check `holds`.

    Raises
    ------
    ProblemError
        If a key, a value or an output is wrong by itself. This is found before anything is solved.
    BemContactError
        If the processes cannot begin to work, as those of a script without that line, or the cluster is lost.
    OSError
        If the folder cannot be written, or holds other files.
    """
    ensure_callable(progress, "progress")
    ensure_known(asking, ("output", "out", "workers", "scheduler", "progress", *ASKING))
    plan = study_plan(problem, vary, **asking)
    shown = chosen(output, problem)
    place = None if out is None else file_path(out, "out")
    if scheduler is not None:
        text_of_argument(scheduler, "scheduler")
    return study_of_plan(plan, shown, place, workers, scheduler, progress)


def study_of_plan(
    plan: StudyPlan,
    outputs: tuple[str, ...],
    folder: Path | None,
    workers: int,
    scheduler: str | None,
    progress: Progress | None,
    spec: str | None = None,
    ensure_possible: Callable[[], None] | None = None,
    *,
    in_program: bool = False,
) -> Study:
    """Solve the members of a plan that the journal of the folder does not have, and write the folder.

    Errors as of `study`; `spec` is the text of the problem as run. `ensure_possible` checks the values, as the method
    of the plan does, while processes get ready. `in_program` is that of `started`.
    """
    workers = whole_number(workers, "number of workers", 1, MOST_WORKERS)
    if scheduler is not None:
        ensure_dask()
    if folder is not None:
        ensure_folder_writable(folder, STUDY)
    plan = replace(plan, stresses=of_stress(outputs))
    seen = None if folder is None else state_of(folder / JOURNAL)
    rows = _recorded(plan, folder)
    tasks = [*tasks_of(plan, [number in rows for number in range(len(plan))])]
    with started(plan, 1 if scheduler else workers, len(tasks), in_program=in_program) as processes:
        if processes is None or not processes.find_possible():
            (ensure_possible or plan.ensure_possible)()
        if folder is not None and (processes or scheduler):  # what writes the folder is read while others solve
            threading.Thread(target=import_module, args=["bemcontact.report.folder"]).start()
        with connected(scheduler) as client, nullcontext() if folder is None else alone(folder, seen):
            rows = _computed(plan, folder, rows, _solved(plan, tasks, processes, client, progress), progress)
            problem = plan.problem
            done = Study(name=problem.title, units=problem.units, axes=plan.axes, outputs=outputs, rows=rows)
            if folder is not None:
                _report(progress, "report", "")
                done.save(folder, spec)
    return done


def _solved(
    plan: StudyPlan, tasks: Sequence[Task], processes: Processes | None, client: Any, progress: Progress | None
) -> Rows:
    """Rows of tasks as they are solved: on the cluster of a client, by processes, or here."""
    if client is not None:
        return rows_by_dask(plan, tasks, client, partial(_report, progress, STAGE))
    return rows_here(plan, tasks) if processes is None else rows_by_processes(tasks, processes)


def _recorded(plan: StudyPlan, folder: Path | None) -> dict[int, MemberRow]:
    """Rows of members in the journal of a folder, by number; one with more outputs than are asked for is used too."""
    kept = {} if folder is None else recorded(folder / JOURNAL)
    pairs = zip(plan.keys(), replace(plan, stresses=True).keys(), strict=True) if kept else ()
    found = {i: key for i, pair in enumerate(pairs) for key in pair if key in kept}
    return {i: row_from(kept[key], i, plan.values(i)) for i, key in found.items()}


def _computed(
    plan: StudyPlan, folder: Path | None, known: Mapping[int, MemberRow], new: Rows, progress: Progress | None
) -> tuple[MemberRow, ...]:
    """Rows of all members: those that are known, and new ones as they are solved, which the journal gets."""
    rows, keys = dict(known), plan.keys()
    with broken_pipes_are_errors(), _journal(folder) as journal:
        pace = _Pace(total=len(plan), before=len(rows), progress=progress)
        pace.say(len(rows))
        with closing(new):
            for row in new:
                rows[row.number] = row
                if journal is not None:
                    journal.add(keys[row.number], row)
                pace.say(len(rows))
    if len(rows) < len(plan):
        raise ProblemError(f"{len(plan) - len(rows)} members were not solved; run the study again")
    return sorted_rows(rows)


@contextmanager
def _journal(folder: Path | None) -> Iterator[Journal | None]:
    """The journal in a folder; None without a folder."""
    with nullcontext() if folder is None else opened(folder) as journal:
        yield journal


class _Pace:
    """How far a study has come, how fast it goes, and how long it will take."""

    def __init__(self, total: int, before: int, progress: Progress | None) -> None:
        self._total, self._before, self._progress = total, before, progress
        self._begin = time.perf_counter()

    def say(self, done: int) -> None:
        """Report the number of members that are done."""
        passed = time.perf_counter() - self._begin
        words = f"{done} of {self._total} members"
        if done > self._before and passed > 0:
            rate = (done - self._before) / passed
            words += f", {rate:.2g} per second"
            if done < self._total:
                words += f", about {_duration((self._total - done) / rate)} left"
        elif self._before:
            words += ", from the journal"
        _report(self._progress, STAGE, words)


def _duration(seconds: float) -> str:
    """Write a duration: 12 s, 3 min, 2.5 h."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"


def _report(progress: Progress | None, stage: str, now: str) -> None:
    """Report a stage, if somebody listens."""
    if progress is not None:
        progress(stage, now)
