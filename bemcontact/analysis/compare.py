"""From a problem to formulations side by side, on one mesh or several."""

import time
from collections.abc import Sequence
from dataclasses import replace

from bemcontact.adaptivity.mesh_fit import MeshFit
from bemcontact.analysis.solve import condensed, fitted_to_contact, judged
from bemcontact.analysis.stopwatch import Progress, Stopwatch
from bemcontact.analysis.study import MeshLevel, Settings, Study
from bemcontact.assessment.comparison import Comparison, comparison
from bemcontact.assessment.contender import Attempt
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import NotConvexError, OptionError, Path, SolverError
from bemcontact.formulations import FORMULATIONS, OPTIONS, qp3
from bemcontact.formulations.formulation import ensure_whole
from bemcontact.formulations.plan import COMPARED, ComparisonPlan, Plan, planned_comparison
from bemcontact.formulations.starts import search_from
from bemcontact.options import FormulationName, Setting, Weights
from bemcontact.problem.key_path import parsed_path
from bemcontact.problem.problem import Problem

HARMLESS = ("name", "description", "mesh", "reference", "case")
"""Keys of a spec that may change without changing the answers that are known; a reference says of which case it is."""
MESHING = ("elements", "grading", "ratio", "towards")
"""Keys of an edge of which that is true."""
COMMENTS = (("tolerance",), ("reason",), ("source",))
"""Keys of a reference that do not change what it says."""


def compare(
    problem: Problem | CondensedContact,
    formulations: Sequence[str] = COMPARED,
    weights: Sequence[Weights | str] = (Weights.TRIBUTARY,),
    penalties: Sequence[float] | None = None,
    *,
    starts: int | None = None,
    seed: int | None = None,
    progress: Progress | None = None,
) -> Comparison:
    """Solve a contact problem by several formulations and put them side by side; the direct solution is the reference.

    Parameters
    ----------
    problem : Problem or CondensedContact
    formulations : of "qp1", "qp2", "qp3"
    weights : of the objectives, each of them with every formulation; `Weights` or their names
    penalties : μ of QP2, free of units, from 1e-8 to 1e8; 1 if not given
    starts : how many random starts of QP1 and QP2 to make beside the null start, to count how many end at the solution
    seed : of these, 0 if not given
    progress : called with two texts, the name of a stage and how far it has come, which is empty as it begins

    Returns
    -------
    Comparison
        Check `certified`. A formulation that refuses is part of it, with the reason.

    Raises
    ------
    OptionError
        A name is unknown, a number out of range, or nothing is left to compare.
    ProblemError
        The problem has no answer, or does not carry the weights asked for.
    """
    plan = planned_comparison(formulations, weights, penalties, starts=starts, seed=seed)
    watch = Stopwatch(progress=progress)
    problem, fit = fitted_to_contact(problem, watch)
    return _side_by_side(plan, problem, watch, fit).comparison


def study(
    plan: ComparisonPlan,
    problem: Problem | CondensedContact,
    refine: Sequence[int] = (1,),
    progress: Progress | None = None,
    changes: Sequence[str] = (),
) -> Study:
    """Compare as planned on one mesh or several, each with all elements cut into so many parts; else as `compare`.

    A mesh that is to be fitted to the ends of contact is fitted once, and then cut.

    Parameters
    ----------
    plan : what to compare
    problem : Problem or CondensedContact
    refine : parts into which the elements are cut, for each mesh
    progress : called with the name of each stage as it begins, and how far it has come
    changes : made to the problem since it was written down, such as ``material.young_modulus=2e6``

    Raises
    ------
    OptionError
        No mesh, one that is there twice, or a refinement of a condensed problem, which has no mesh.
    """
    if not refine or len({*refine}) < len(refine):
        told = ", ".join(map(str, refine)) or "none"
        raise OptionError(f"the refinements must be different from each other, and at least one; found {told}")
    if isinstance(problem, CondensedContact) and [*refine] != [1]:
        raise OptionError("a condensed problem has no mesh to refine; refine the problem that it came from")
    for parts in refine:
        ensure_whole(parts, "refinement", 1)
    fitting = Stopwatch(progress=progress)
    problem, fit = fitted_to_contact(problem, fitting)
    levels = []
    for parts in sorted(map(int, refine)):
        tell = progress if len(refine) == 1 or progress is None else _prefixed(progress, f"refine {parts}: ")
        finer = problem.refined(parts) if isinstance(problem, Problem) and parts > 1 else problem
        watch = Stopwatch(progress=tell, seconds={} if levels else fitting.seconds)
        level = _side_by_side(plan, finer, watch, fit)
        levels.append(replace(level, refine=parts, outdated=outdated(problem, changes)))
    return Study(settings=Settings(**plan.to_dict(), changes=tuple(changes)), levels=tuple(levels))


def outdated(problem: Problem | CondensedContact, changes: Sequence[str]) -> frozenset[str]:
    """Name the references of a problem that were left as they are by changes which alter the answer.

    Parameters
    ----------
    problem : with its references
    changes : such as ``material.young_modulus=2e6``

    Returns
    -------
    frozenset of str
    """
    paths = [parsed_path(change.partition("=")[0].strip()) for change in changes]
    if isinstance(problem, CondensedContact) or not any(map(_alters, paths)):
        return frozenset()
    renewed = {path[1] for path in paths if path[0] == "reference" and path[2:3] not in COMMENTS and len(path) > 1}
    return frozenset({*problem.reference} - renewed)


def _alters(path: Path) -> bool:
    """Whether a change of the value at a path of keys changes the answer that is sought."""
    return path[0] not in HARMLESS and not (path[0] == "boundary" and path[-1] in MESHING)


def _prefixed(progress: Progress, prefix: str) -> Progress:
    """Tell what is going on with the mesh before it."""
    return lambda stage, now: progress(prefix + stage, now)


def _side_by_side(
    plan: ComparisonPlan, problem: Problem | CondensedContact, watch: Stopwatch, fit: MeshFit | None
) -> MeshLevel:
    """Compare on one mesh, and judge the direct solution with the boundary behind it."""
    contact, condensation = condensed(problem, watch)
    reference = _attempt(Setting(formulation=FormulationName.COMPLEMENTARITY), plan.reference, plan, contact, watch)
    assert reference.solution is not None  # the direct solver ends with a status, never refuses
    if any(setting.formulation == FormulationName.QP3 for setting, _ in plan.contenders):
        with watch.stage("loading cvxpy"):
            qp3.load()
    found = [_attempt(setting, item, plan, contact, watch) for setting, item in plan.contenders]
    with watch.stage("comparison"):
        compared = comparison(contact, reference, found)
    answer = judged(problem, condensation, contact, reference.solution, Weights.TRIBUTARY, watch, fit=fit)
    return MeshLevel(refine=1, comparison=compared, answer=answer)


def _attempt(
    setting: Setting, plan: Plan, whole: ComparisonPlan, contact: CondensedContact, watch: Stopwatch
) -> Attempt:
    """Solve by one formulation, from the null start and from random ones if they are asked for."""
    statement, label = FORMULATIONS[plan.formulation], setting.label
    begin, ends = time.perf_counter(), None
    try:
        with watch.stage(label):
            solution = statement(contact, plan.options)
        seconds = time.perf_counter() - begin
        if whole.starts is not None and "start" in OPTIONS[plan.formulation]:
            with watch.stage(f"{label}, random starts") as say:
                ends = search_from(
                    contact,
                    statement,
                    plan.options,
                    whole.starts,
                    whole.seed,
                    lambda done: say(f"{done} of {whole.starts}"),
                )
    except (NotConvexError, OptionError, SolverError) as error:
        return Attempt(setting=setting, solution=None, refusal=str(error))
    return Attempt(setting=setting, solution=solution, seconds=seconds, starts=ends)
