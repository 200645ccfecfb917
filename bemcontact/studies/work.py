"""What a worker does: solve some members of a study, condensed together where their matrix is the same."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

from threadpoolctl import threadpool_limits

from bemcontact import threads
from bemcontact.adaptivity.adapt import stated
from bemcontact.adaptivity.mesh_sizes import cut
from bemcontact.analysis.result import Result
from bemcontact.analysis.solve import Prepared, Stopwatch, ensure_acting, solve_prepared, solve_with
from bemcontact.bem.body import Body
from bemcontact.bem.condense import (
    Condensation,
    CondensedTogether,
    Condenser,
    condense_together,
    condensed,
    matrix_of,
)
from bemcontact.bem.discretization import body_of
from bemcontact.errors import BemContactError, ProblemError
from bemcontact.frozen import frozen_value
from bemcontact.options import SolveOptions
from bemcontact.problems.problem import Problem
from bemcontact.studies.plan import StudyPlan
from bemcontact.studies.rows import MemberRow, failed_row, row_of

THREADS = "OMP_NUM_THREADS"


@frozen_value
class Task:
    """Members that one worker solves together.

    Parameters
    ----------
    group : numbers of all members that may be condensed together
    wanted : those of them that are to be solved; the others are condensed too, so that round-off is the same each time
    """

    group: tuple[int, ...]
    wanted: tuple[int, ...]


def tasks_of(plan: StudyPlan, done: Sequence[bool]) -> Iterator[Task]:
    """The tasks of a study; members that are done are not wanted."""
    for group in plan.groups():
        wanted = tuple(number for number in group if not done[number])
        if wanted:
            yield Task(group=tuple(group), wanted=wanted)


def rows_of_task(plan: StudyPlan, task: Task) -> Iterator[MemberRow]:
    """Solve the wanted members of a task; a member that fails is a row with its sentence."""
    members = {number: _member(plan, number) for number in task.group}
    shared = _SharedMatrices({i: item for i, item in members.items() if isinstance(item, Problem)})
    for number in task.wanted:
        values, member = plan.values(number), members[number]
        if not isinstance(member, Problem):
            yield failed_row(number, values, str(member))
            continue
        try:
            yield row_of(number, values, _solved(member, shared.condenser(number)), stresses=plan.stresses)
        except MemoryError:
            yield failed_row(number, values, "there is not enough memory; take fewer elements or fewer workers")
        except BemContactError as error:
            yield failed_row(number, values, str(error))
        except Exception as error:  # one member must not end the study
            yield failed_row(number, values, f"an error of the program, please report it: {error!r}")


@threads.one_thread
def _solved(member: Problem, condenser: Condenser) -> Result:
    """Solve a member on the mesh that it states, or on one that is found."""
    if member.adapts:
        return solve_with(SolveOptions(), member)
    ensure_acting(member)
    watch = Stopwatch()
    with watch.stage("mesh"):
        on_mesh = stated(member, condenser=condenser)
    return solve_prepared(SolveOptions(), Prepared.on_mesh(on_mesh), watch)


def _member(plan: StudyPlan, number: int) -> Problem | ProblemError:
    """The problem of a member, without joints on the mesh that it states, or why its values do not go together."""
    try:
        member = plan.member(number)
        return member if member.adapts else member.without_joints()
    except ProblemError as error:
        return error


@dataclass(frozen=True, eq=False)
class _SharedMatrices:
    """Members of a group by number; those whose matrix is the same are condensed together when one is needed."""

    members: dict[int, Problem]
    _found: dict[int, dict[int, tuple[CondensedTogether, int] | BemContactError]] = field(default_factory=dict)

    def condenser(self, number: int) -> Condenser:
        """Condense a member, also with its elements cut; by itself if its contacts are those after a motion."""
        member = self.members[number]

        def condense(problem: Problem) -> Condensation:
            if problem.zones is not member.zones:
                return condensed(problem)
            refine = problem.mesh.refine
            if refine not in self._found:
                self._found[refine] = dict(self._together(refine))
            found = self._found[refine][number]
            if isinstance(found, BemContactError):
                raise found
            together, place = found
            return together[place]

        return condense

    def _together(self, refine: int) -> Iterator[tuple[int, tuple[CondensedTogether, int] | BemContactError]]:
        """Condense all members with their elements cut into so many parts; or the error of each."""
        alike = dict[object, list[tuple[int, Body]]]()
        for number, member in self.members.items():
            try:
                body = body_of(cut(member, refine))
            except BemContactError as error:
                yield number, error
                continue
            alike.setdefault(matrix_of(body), []).append((number, body))
        for pairs in alike.values():
            numbers, bodies = zip(*pairs, strict=True)
            try:
                together = condense_together(bodies)
            except BemContactError as error:
                yield from ((number, error) for number in numbers)
                continue
            yield from ((number, (together, place)) for place, number in enumerate(numbers))


def take_one_thread() -> None:
    """Let assembly and linear algebra of this process use one thread from now on, for the workers share processors."""
    os.environ[THREADS] = "1"
    threadpool_limits(limits=1)


@contextmanager
def one_thread() -> Iterator[None]:
    """Let assembly and linear algebra use one thread, and as many as before afterwards."""
    before = os.environ.get(THREADS)
    os.environ[THREADS] = "1"
    try:
        with threadpool_limits(limits=1):
            yield
    finally:
        if before is None:
            del os.environ[THREADS]
        else:
            os.environ[THREADS] = before


def rows_on_one_thread(plan: StudyPlan, task: Task) -> list[MemberRow]:
    """Solve a task in a process of somebody else, such as a worker of a cluster."""
    with one_thread():
        return [*rows_of_task(plan, task)]
