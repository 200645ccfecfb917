"""Comparison of formulations on one mesh or several."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Unpack, cast

from bemcontact.analysis.held_motions import MovingBody
from bemcontact.analysis.mesh_study import MeshLevel, MeshStudy, Settings
from bemcontact.analysis.motion_series import MotionSeries
from bemcontact.analysis.solve import (
    Prepared,
    Progress,
    Stopwatch,
    asked,
    assessed,
    ensure_acting,
    ensure_kind,
    prepare,
)
from bemcontact.assessment.certificate import Certificate, CertificateKind
from bemcontact.assessment.comparison import Comparison, comparison
from bemcontact.assessment.contender import Attempt
from bemcontact.bem.condense import boundary_state
from bemcontact.bem.surface_gaps import surface_gaps
from bemcontact.checks.arguments import ensure_callable
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.known_motions import KnownMotions
from bemcontact.contact.solution import ContactSolution
from bemcontact.errors import KeyPath, NotConvexError, OptionError, SolverError
from bemcontact.formulations import FORMULATIONS, qp3
from bemcontact.formulations.multistart import multistart
from bemcontact.options import (
    ASKING,
    COMPARED,
    AskingKeywords,
    ComparingKeywords,
    ComparisonKeywords,
    ComparisonOptions,
    FormulationName,
    SolveOptions,
    Weights,
    ensure_known,
    ensure_whole,
)
from bemcontact.problems.key_path import parsed_path
from bemcontact.problems.problem import Problem
from bemcontact.threads import one_thread

HARMLESS = ("name", "description", "mesh", "reference", "case")
"""Keys of a spec that do not change its reference values; a reference says which load case it is of."""
MESHING = ("elements", "grading", "ratio", "towards")
"""Keys of an edge of which that is true."""
COMMENTS = (("tolerance",), ("reason",), ("source",))
"""Keys of a reference that do not change what it says."""


@one_thread
def compare(
    problem: Problem | CondensedContact,
    formulations: Sequence[FormulationName | str] | str = COMPARED,
    weights: Sequence[Weights | str] | str = (Weights.TRIBUTARY,),
    penalties: Sequence[float] | float | None = None,
    *,
    progress: Progress | None = None,
    **options: Unpack[ComparingKeywords],
) -> Comparison:
    """Solve a contact problem by several formulations and compare each with the direct solution.

    Parameters
    ----------
    problem : Problem or CondensedContact
    formulations : of "qp1", "qp2", "qp3"
    weights : of the objectives, each of them with every formulation; `Weights` or their names
    penalties : μ of QP2, one or several
    progress : called with two texts, the name of a stage and how far it has come, which is empty when it begins
    options : starts and seed of random starts of QP1 and QP2, made besides the null start to count how many end at the
        solution; and variant, set, case, accuracy and refine, as of `bemcontact.solve`

    Returns
    -------
    Comparison
        Check `certified`. A formulation that refuses is part of it, with the reason.

    Raises
    ------
    OptionError
        A name is unknown, a number out of range, or there is nothing to compare.
    ProblemError
        The problem has no answer, or does not carry the weights asked for.
    """
    ensure_callable(progress, "progress")
    ensure_known(options, (*ComparisonOptions.__dataclass_fields__, *ASKING, "progress"))
    asking = cast(AskingKeywords, {key: value for key, value in options.items() if key in ASKING})
    others = cast(ComparisonKeywords, {key: value for key, value in options.items() if key not in ASKING})
    read = ComparisonOptions.of(formulations, weights, penalties, **others)
    watch = Stopwatch(progress=progress)
    ensure_kind(problem)
    problem = asked(problem, asking)
    ensure_acting(problem)
    return compared_on(read, prepare(problem, watch, errors=False), watch).comparison


@one_thread
def mesh_study(
    options: ComparisonOptions,
    problem: Problem | CondensedContact,
    refine: Sequence[int] = (1,),
    progress: Progress | None = None,
    changes: Sequence[str] = (),
) -> MeshStudy:
    """Compare formulations, as `compare` does, on one mesh for each number of parts in `refine`.

    A mesh that is found for an accuracy is found once and then refined. Errors are estimated on the finest mesh.
    `changes` are those made to the spec with --set. `OptionError` if `refine` is empty, repeats a number, or refines a
    condensed problem, which has no mesh.
    """
    if not refine or len({*refine}) < len(refine):
        listed = ", ".join(map(str, refine)) or "none"
        raise OptionError(f"the refinements must be different from each other, and at least one; found {listed}")
    if isinstance(problem, CondensedContact) and [*refine] != [1]:
        raise OptionError("a condensed problem has no mesh to refine; refine the problem that it came from")
    for parts in refine:
        ensure_whole(parts, "refinement", 1)
    ensure_acting(problem)
    finding = Stopwatch(progress=progress)
    found = prepare(problem, finding) if isinstance(problem, Problem) and problem.adapts else None
    problem = found.condensation.body.problem if found and found.condensation else problem
    levels = []
    for parts in sorted(map(int, refine)):
        report = progress if len(refine) == 1 or progress is None else _prefixed(progress, f"refine {parts}: ")
        finer = problem.refined(parts) if isinstance(problem, Problem) and parts > 1 else problem
        watch = Stopwatch(progress=report, seconds={} if levels else finding.seconds)
        prepared = found if parts == 1 else None
        if prepared is None:
            singular = found.singular if found else ()
            prepared = prepare(finer, watch, errors=parts == max(refine), singular=singular)
        if found:
            prepared = replace(prepared, accuracy=prepared.accuracy.knowing(found.accuracy))
        level = compared_on(options, prepared, watch)
        levels.append(replace(level, refine=parts, outdated=outdated(problem, changes)))
    return MeshStudy(settings=settings_of(options, changes), levels=tuple(levels))


def settings_of(options: ComparisonOptions, changes: Sequence[str]) -> Settings:
    """Options of a comparison as they act, and the changes made to the spec with --set."""
    return Settings(
        formulations=options.formulations,
        weights=options.weights,
        penalties=tuple(dict.fromkeys(item.penalty for item in options.attempts if item.uses("penalty"))),
        starts=options.starts,
        seed=options.seed or 0,
        changes=tuple(changes),
    )


def outdated(problem: Problem | CondensedContact, changes: Sequence[str]) -> frozenset[str]:
    """Names of the references that still hold values of the problem before changes such as ``case=wind``."""
    paths = [parsed_path(change.partition("=")[0].strip()) for change in changes]
    if isinstance(problem, CondensedContact) or not any(map(_alters, paths)):
        return frozenset()
    renewed = {path[1] for path in paths if path[0] == "reference" and path[2:3] not in COMMENTS and len(path) > 1}
    return frozenset({*problem.reference} - renewed)


def _alters(path: KeyPath) -> bool:
    """Whether a change of the value at a path of keys changes the answer."""
    return path[0] not in HARMLESS and not (path[0] == "boundary" and path[-1] in MESHING)


def _prefixed(progress: Progress, prefix: str) -> Progress:
    """Progress that writes the mesh before the name of each stage."""
    return lambda stage, now: progress(prefix + stage, now)


def compared_on(options: ComparisonOptions, prepared: Prepared, watch: Stopwatch) -> MeshLevel:
    """Compare on one mesh, and assess the direct solution with the boundary behind it."""
    contact = prepared.contact
    reference = _attempted(SolveOptions(formulation=FormulationName.COMPLEMENTARITY), options, contact, watch)
    assert reference.solution is not None  # the direct solver ends with a status, never refuses
    if FormulationName.QP3 in options.formulations:
        with watch.stage("loading cvxpy"):
            qp3.import_cvxpy()
    attempts = [_attempted(attempt, options, contact, watch) for attempt in options.attempts]
    with watch.stage("comparison"):
        motions = partial(_motions, prepared)
        compared = comparison(contact, reference, attempts, infinite=prepared.accuracy.infinite, motions=motions)
    answer = assessed(prepared, reference.solution, Weights.TRIBUTARY, watch)
    return MeshLevel(refine=1, comparison=compared, answer=answer)


def _motions(prepared: Prepared, solution: ContactSolution, certificate: Certificate) -> KnownMotions:
    """What is known of the free motions of a solution, from the boundary behind the contact points if there is one."""
    contact, condensation = prepared.contact, prepared.condensation
    if condensation is None or not contact.free_motions:
        return KnownMotions.of(contact, solution)
    boundary = boundary_state(condensation, solution.pressure, solution.rigid_amplitudes)
    series = MotionSeries.none(contact.free_motions)
    if certificate.kind is not CertificateKind.NOT_A_SOLUTION:
        gaps = surface_gaps(condensation.body, boundary, contact, solution)
        series = MotionSeries.of(gaps, condensation.body, contact, solution)
    return MovingBody.of(condensation, boundary, solution, series).known


def _attempted(
    attempt: SolveOptions, options: ComparisonOptions, contact: CondensedContact, watch: Stopwatch
) -> Attempt:
    """Solve by one formulation, from the null start, and from random ones if that is asked for."""
    label = attempt.label(with_penalty=options.has_penalties)
    before, searches = watch.seconds.get(label, 0.0), None
    try:
        with watch.stage(label):
            solution = FORMULATIONS[attempt.formulation](contact, attempt)
        seconds = watch.seconds[label] - before
        if options.starts is not None and attempt.uses("start"):
            with watch.stage(f"{label}, random starts") as say:
                several = replace(attempt, starts=options.starts, seed=options.seed)
                searches = multistart(contact, several, lambda done: say(f"{done} of {options.starts}"))
    except (NotConvexError, OptionError, SolverError) as error:
        return Attempt(options=attempt, label=label, solution=None, refusal=str(error))
    return Attempt(options=attempt, label=label, solution=solution, seconds=seconds, starts=searches)
