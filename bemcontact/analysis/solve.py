"""From a problem to an assessed result: condense, solve, recover and assess, with the time of each stage."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Self, TypeVar, Unpack, cast

from bemcontact import compilation
from bemcontact.adaptivity.adapt import Meshed, meshed
from bemcontact.adaptivity.singularities import Singularity
from bemcontact.analysis.diagnostics import diagnostics, sides_of_one_body
from bemcontact.analysis.held_motions import MovingBody
from bemcontact.analysis.motion_series import MotionSeries
from bemcontact.analysis.penetration import misfit
from bemcontact.analysis.result import Result
from bemcontact.assessment.accuracy import NO_MESH, Accuracy
from bemcontact.assessment.certificate import CertificateKind, certify
from bemcontact.assessment.footprint import footprint
from bemcontact.assessment.residual import residuals
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.condense import Condensation, boundary_state
from bemcontact.bem.surface_gaps import surface_gaps
from bemcontact.checks.arguments import ensure_callable, shown
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.known_motions import KnownMotions
from bemcontact.contact.multistart import RandomStarts
from bemcontact.contact.solution import ContactSolution
from bemcontact.errors import Issue, ProblemError
from bemcontact.formulations.multistart import multistart, solve_contact
from bemcontact.formulations.starts import with_start_read
from bemcontact.frozen import frozen
from bemcontact.options import (
    ASKING,
    STARTS,
    AskingKeywords,
    FormulationName,
    SearchKeywords,
    SolveKeywords,
    SolveOptions,
    SolvingKeywords,
    StartName,
    StatementKeywords,
    Weights,
    ensure_known,
    ensure_whole,
)
from bemcontact.problems.problem import Problem
from bemcontact.threads import one_thread

Progress = Callable[[str, str], object]
"""Takes the name of a stage and how far it has come; the latter is empty when the stage begins."""
NOT_ASKED: dict[str, object] = {"accuracy": "stated", "refine": 1}
"""Values of keywords that ask for nothing; of the others it is None."""


COMPILATION = "compilation"
"""Name of the stage in which numba compiles, which is within another one."""


@dataclass(kw_only=True)
class Stopwatch:
    """Times stages, and reports them while they run."""

    progress: Progress | None = None
    seconds: dict[str, float] = field(default_factory=dict)
    """Of each stage without those within it: the sum is the time of all."""

    @contextmanager
    def stage(self, name: str) -> Iterator[Callable[[str], None]]:
        """Time a stage, which may report how far it has come; a stage that comes again adds to its seconds."""
        self._report(name, "")
        begin = time.perf_counter() - sum(self.seconds.values())
        with compilation.watched(lambda: self._compilation(name)):
            yield lambda now: self._report(name, now)
        own = time.perf_counter() - begin - sum(self.seconds.values())
        self.seconds[name] = self.seconds.get(name, 0.0) + own

    @contextmanager
    def _compilation(self, within: str) -> Iterator[None]:
        """Time a compilation as a stage of its own, and go back to the stage that waits for it."""
        with self.stage(COMPILATION) as say:
            say("by numba, once")
            yield
        self._report(within, "")

    def _report(self, name: str, now: str) -> None:
        """Report a stage, if somebody listens."""
        if self.progress:
            self.progress(name, now)


@one_thread
def condense(problem: Problem, **asking: Unpack[AskingKeywords]) -> CondensedContact:
    """Condense a body to its contact points.

    Parameters
    ----------
    problem : Problem
    asking : variant, set, case, accuracy and refine, as of `bemcontact.solve`; the accuracy None means the stated mesh

    Returns
    -------
    CondensedContact
        On the mesh that the problem states, or on one that is found for its accuracy. If the problem has load cases
        and none of them acts, the permanent loads act, and each load case has the factor zero.

    Raises
    ------
    ProblemError
        If contact cannot hold the body, or conditions contradict each other.
    SingularSystemError
        If the equations of the body have no unique solution.
    """
    ensure_kind(problem, Problem)
    return meshed(asked(problem, asking).without_joints(), errors=False).condensation.contact


def ensure_kind(problem: object, *kinds: type) -> None:
    """Refuse what is no problem, a file name above all, with a `ProblemError`."""
    kinds = kinds or (Problem, CondensedContact)
    if not isinstance(problem, kinds):
        names = " or a ".join(kind.__name__ for kind in kinds)
        hint = "bemcontact.load reads one from a file"
        hint = "bemcontact.problem makes one from it" if isinstance(problem, Mapping) else hint
        raise ProblemError(f"a {names} is needed, found {shown(problem)}; {hint}")


Stated = TypeVar("Stated", Problem, CondensedContact, Problem | CondensedContact)


def asked(problem: Stated, asking: AskingKeywords) -> Stated:
    """The problem as it is asked for: another variant, other values, one load case, another accuracy, a finer mesh.

    `OptionError` for an unknown keyword, and `ProblemError` for a condensed problem, in which all of that is decided.
    """
    ensure_known(asking, ASKING)
    given = {key: value for key, value in asking.items() if not _asks_nothing(key, value)}
    if not isinstance(problem, Problem):
        for key, value in given.items():
            message = f"{key} is {shown(value)}, but a condensed problem has its body, loads and mesh; give the Problem"
            raise ProblemError(message)
        return problem
    if "variant" in given:
        problem = problem.variant(cast(str, asking.get("variant")))
    if "set" in given:
        problem = problem.with_values(asking.get("set") or {})
    if "case" in given:
        problem = problem.with_case(cast(str, asking.get("case")))
    if "accuracy" in given and given["accuracy"] is not problem.accuracy:
        problem = problem.with_value("accuracy", given["accuracy"])
    return problem.refined(asking.get("refine", 1))


def _asks_nothing(key: str, value: object) -> bool:
    """Whether a value is that of a keyword which is left out."""
    default = NOT_ASKED.get(key)
    return value is default or (type(value) is type(default) and value == default)


def ensure_acting(problem: Problem | CondensedContact) -> None:
    """Refuse what is no problem, and one with load cases of which none acts, with a `ProblemError`."""
    ensure_kind(problem)
    if isinstance(problem, Problem) and problem.load_cases and problem.case is None:
        message = (
            f"choose the one that acts as case (in Python by with_case): {', '.join(problem.case_names)}; "
            "or solve all of them"
        )
        raise ProblemError(Issue(path=("load_cases",), message=message))


@one_thread
def solve(
    problem: Problem | CondensedContact,
    formulation: FormulationName | str = FormulationName.COMPLEMENTARITY,
    weights: Weights | str = Weights.TRIBUTARY,
    *,
    progress: Callable[[int], object] | None = None,
    **options: Unpack[SolvingKeywords],
) -> Result:
    """Solve a contact problem by one formulation, and assess the result.

    Parameters
    ----------
    problem : Problem or CondensedContact
    formulation : "complementarity", the direct solver, or "qp3", "qp1" or "qp2"
    weights : of the objective of QP1, QP2 and QP3, a `Weights` or its name
    progress : called after the search from each of several random starts with the number of those done
    options : named as the options of the command. How it is solved: penalty, rows, equilibrium, start, seed, starts,
        max_iterations, solver, polish; `bemcontact.SolveOptions` says what each means, and its default. What is asked,
        in place of what the problem states: variant, its name; set, values by key path as of `Problem.with_values`;
        case, the name of the load case or combination that acts; accuracy, relative, to which a mesh is found (None:
        nothing is said about errors); refine, the number of equal parts into which each element is cut

    Returns
    -------
    Result
        Check `holds`: whether it is certified and as accurate as was asked; of a condensed problem `certified`, since
        nothing is known of its mesh. A solver that fails is a `Status`, not an error.

    Raises
    ------
    OptionError
        A `ProblemError`: a name is unknown, a number out of range, or the formulation has no use for an option.
    ProblemError
        If the problem has no answer.
    NotConvexError
        If the formulation needs a convex program and this is none.
    SingularSystemError
        If the equations of a body have no unique solution.
    SolverError
        If the solver of QP3 breaks down, and leaves no point.
    """
    ensure_callable(progress, "progress")
    read, asking = read_options(formulation, weights, options, "progress")
    ensure_kind(problem)
    return solve_with(read, asked(problem, asking), progress)


def read_options(
    formulation: FormulationName | str, weights: Weights | str, options: SolvingKeywords, *own: str
) -> tuple[SolveOptions, AskingKeywords]:
    """Options of a solution, and what is asked; `OptionError` as of `SolveOptions`, with `own` names of the caller."""
    ensure_known(options, (*SolveOptions.__dataclass_fields__, *ASKING, *own))
    asking = {key: value for key, value in options.items() if key in ASKING}
    others = {key: value for key, value in options.items() if key not in ASKING}
    return SolveOptions.of(formulation, weights, **cast(SolveKeywords, others)), cast(AskingKeywords, asking)


@one_thread
def solve_with(
    options: SolveOptions,
    problem: Problem | CondensedContact,
    progress: Callable[[int], object] | None = None,
    on_mesh: Progress | None = None,
) -> Result:
    """Solve a contact problem with options, and assess the result, as `solve` does.

    `on_mesh` is called with each stage and how far it has come.
    """
    options, watch = with_start_read(options), Stopwatch(progress=on_mesh)
    ensure_acting(problem)
    return solve_prepared(options, prepare(problem, watch), watch, progress)


@one_thread
def solve_prepared(
    options: SolveOptions, prepared: "Prepared", watch: Stopwatch, progress: Callable[[int], object] | None = None
) -> Result:
    """Solve a problem that is condensed, with options of which the start is read, and assess the result."""
    with watch.stage("solution"):
        solution, searches = prepared.solve(options, progress)
    return assessed(prepared, solution, options.weights, watch, searches)


@frozen
class Prepared:
    """A condensed problem, ready to be solved under one load case."""

    contact: CondensedContact
    condensation: Condensation | None = None
    """None for a problem that was given condensed."""
    accuracy: Accuracy = NO_MESH
    """Accuracy of the mesh."""
    singular: tuple[tuple[Singularity, ...], ...] = ()
    """Infinite pressures that the search for the mesh recognized."""
    answer: ContactSolution | None = None
    """Solution of the direct solver, if that was needed for the accuracy."""

    @classmethod
    def on_mesh(cls, found: Meshed, case: str | None = None) -> Self:
        """A problem on its mesh, under the only load case or that which acts, or under one of those that share it."""
        number = 0 if case is None else found.problem.case_names.index(case)
        answer = found.answers[number] if found.answers else None
        if answer is not None:
            condensation = answer.condensation
        else:
            condensation = found.condensation if case is None else found.condensation.acting(case)
        return cls(
            contact=condensation.contact,
            condensation=condensation,
            accuracy=found.accuracies[number],
            singular=found.singular,
            answer=None if answer is None else answer.solution,
        )

    def solve(
        self, options: SolveOptions, progress: Callable[[int], object] | None = None
    ) -> tuple[ContactSolution, RandomStarts | None]:
        """Solve as of `solve_contact`; the direct solver need not solve once more what it has solved."""
        if self.answer is not None and options == SolveOptions():
            return self.answer, None
        return solve_contact(self.contact, options, progress)


def prepare(
    problem: Problem | CondensedContact,
    watch: Stopwatch,
    *,
    errors: bool = True,
    singular: Sequence[Sequence[Singularity]] = (),
) -> Prepared:
    """Condense a problem on its mesh or on one that is found, and estimate the errors of a stated mesh if wanted."""
    ensure_kind(problem)
    if isinstance(problem, CondensedContact):
        return Prepared(contact=problem)
    return Prepared.on_mesh(mesh_of(problem, watch, errors=errors, singular=singular))


def mesh_of(
    problem: Problem, watch: Stopwatch, *, errors: bool = True, singular: Sequence[Sequence[Singularity]] = ()
) -> Meshed:
    """Condense a problem on its mesh or on one that is found, with the accuracy under each load case."""
    with watch.stage("mesh") as say:
        return meshed(problem.without_joints(), say, errors=errors, singular=singular)


def assessed(
    prepared: Prepared,
    solution: ContactSolution,
    weights: Weights,
    watch: Stopwatch,
    searches: RandomStarts | None = None,
    boundary: BoundaryState | None = None,
) -> Result:
    """Recover the boundary of a solution of a prepared problem, unless it is given, and assess both."""
    contact, condensation, accuracy = prepared.contact, prepared.condensation, prepared.accuracy
    if condensation is not None and boundary is None:
        with watch.stage("recovery"):
            boundary = boundary_state(condensation, solution.pressure, solution.rigid_amplitudes)
    with watch.stage("assessment"):
        recomputed = residuals(contact, solution, None if boundary is None else boundary.force_balance)
        certificate = certify(contact, solution, recomputed)
        where, deepest, said = footprint(contact, solution, infinite=prepared.accuracy.infinite), None, ()
        series = MotionSeries.none(contact.free_motions)
        if certificate.kind is not CertificateKind.NOT_A_SOLUTION:
            if boundary is not None and condensation is not None:
                gaps = surface_gaps(condensation.body, boundary, contact, solution)
                series = MotionSeries.of(gaps, condensation.body, contact, solution)
                infinite = prepared.accuracy.infinite
                deepest, said = misfit(gaps, condensation.body, contact, solution, where, infinite, series)
            body = None if condensation is None else condensation.body
            said += tuple(diagnostics(contact, solution, where, body, met=prepared.accuracy.met is True))
        if boundary is not None and condensation is not None:
            moving = MovingBody.of(condensation, boundary, solution, series)
            motions, accuracy = moving.known, moving.judged(accuracy)
        else:
            motions = KnownMotions.of(contact, solution)
        if condensation is not None and not certificate.certified:
            said += tuple(sides_of_one_body(condensation.body.problem))
        notes = (*contact.notes, *solution.notes, *said)
    gap, pressure = contact.initial_gap + solution.displacement, solution.pressure
    by_point = weights is Weights.TRIBUTARY
    weighted = pressure * contact.weights if by_point else pressure @ contact.weight_matrix(weights)
    return Result(
        problem=None if condensation is None else condensation.body.problem,
        contact=contact,
        solution=solution,
        weights=weights,
        objective=float(weighted @ gap),
        residuals=recomputed,
        certificate=certificate,
        footprint=where,
        penetration=deepest,
        boundary=boundary,
        known_motions=motions,
        degrees_of_freedom=None if condensation is None else condensation.body.mesh.degrees_of_freedom,
        notes=notes,
        seconds=watch.seconds,
        starts=searches,
        accuracy=accuracy,
    )


@one_thread
def random_starts(
    problem: Problem | CondensedContact,
    formulation: FormulationName | str = FormulationName.QP1,
    weights: Weights | str = Weights.TRIBUTARY,
    *,
    count: int = 100,
    seed: int = 0,
    progress: Callable[[int], object] | None = None,
    **options: Unpack[SearchKeywords],
) -> RandomStarts:
    """Solve QP1 or QP2 from random starts, and count how often each minimum is found; nothing is polished.

    Parameters
    ----------
    problem : Problem or CondensedContact
    formulation : "qp1" or "qp2"
    weights : of the objective, a `Weights` or its name
    count, seed : of the starts; the same seed gives the same starts
    progress : called after each search with the number of those done
    options : penalty, rows, equilibrium, max_iterations; `bemcontact.SolveOptions` says what each means. And variant,
        set, case, accuracy and refine, as of `bemcontact.solve`

    Returns
    -------
    RandomStarts

    Raises
    ------
    ProblemError
        As of `solve`.
    """
    ensure_callable(progress, "progress")
    own = ("formulation", "weights", "count", "seed", "progress")
    ensure_known(options, (*StatementKeywords.__annotations__, *ASKING, *own))
    ensure_whole(count, STARTS, 1)
    ensure_whole(seed, "seed", 0)
    random: SolvingKeywords = {**options, "start": StartName.RANDOM, "starts": count, "seed": seed}
    read, asking = read_options(formulation, weights, random)
    ensure_kind(problem)
    problem = asked(problem, asking)
    contact = problem if isinstance(problem, CondensedContact) else condense(problem)
    return multistart(contact, read, progress)
