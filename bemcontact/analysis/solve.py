"""From a problem to a judged result: condense, solve, assess, recover; here both halves of the house work."""

from collections.abc import Callable
from dataclasses import replace

from bemcontact.adaptivity.fitting import fitted
from bemcontact.adaptivity.mesh_fit import MeshFit
from bemcontact.analysis import diagnostics as remarks
from bemcontact.analysis.result import Result
from bemcontact.analysis.stopwatch import Stopwatch
from bemcontact.assessment.certificate import certify
from bemcontact.assessment.footprint import footprint
from bemcontact.assessment.residual import residuals
from bemcontact.bem.condense import Condensation, body_of
from bemcontact.bem.condense import condense as condense_body
from bemcontact.bem.recovery import boundary_state
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.multistart import RandomStarts
from bemcontact.contact.solution import ContactSolution
from bemcontact.errors import Issue, ProblemError
from bemcontact.formulations import FORMULATIONS, Start
from bemcontact.formulations.formulation import ensure_whole
from bemcontact.formulations.plan import Plan, planned
from bemcontact.formulations.starts import search_from
from bemcontact.options import Equilibrium, FormulationName, Rows, StartName, Weights
from bemcontact.problem.problem import Problem


def condense(problem: Problem) -> CondensedContact:
    """Condense a body to its contact points.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    CondensedContact
        On the fitted mesh if the problem asks for one; its notes tell. Of a problem with load cases of which none acts,
        what is permanent, with the load cases at factor zero.

    Raises
    ------
    ProblemError
        If contact cannot hold the body, or conditions contradict each other.
    SingularSystemError
        If the equations of the body have no unique solution.
    """
    ensure_kind(problem, Problem)
    problem, fit = fitted(problem)
    contact = condense_body(body_of(problem)).contact
    return contact if fit is None else replace(contact, notes=(*fit.notes, *contact.notes))


def ensure_kind(problem: object, *kinds: type) -> None:
    """Refuse what is no problem, a file name above all, with a `ProblemError`."""
    kinds = kinds or (Problem, CondensedContact)
    if not isinstance(problem, kinds):
        names = " or a ".join(kind.__name__ for kind in kinds)
        raise ProblemError(
            f"a {names} is needed, found {type(problem).__name__}; bemcontact.load reads one from a file"
        )


def ensure_acting(problem: Problem | CondensedContact) -> None:
    """Refuse what is no problem, and one with load cases of which none acts, with a `ProblemError`."""
    ensure_kind(problem)
    if isinstance(problem, Problem) and problem.load_cases and problem.case is None:
        message = f"say which one acts, by case or --case: {', '.join(problem.case_names)}; or solve all of them"
        raise ProblemError(Issue(path=("load_cases",), message=message))


def solve(
    problem: Problem | CondensedContact,
    formulation: str = FormulationName.QP3,
    weights: Weights | str = Weights.TRIBUTARY,
    *,
    penalty: float = 1.0,
    rows: Rows | str = Rows.STIFFNESS,
    equilibrium: Equilibrium | str = Equilibrium.CONSTRAINT,
    start: Start | str | None = None,
    seed: int | None = None,
    starts: int | None = None,
    max_iterations: int | None = None,
    progress: Callable[[int], object] | None = None,
) -> Result:
    """Solve a contact problem by one formulation, and judge the answer.

    Parameters
    ----------
    problem : Problem or CondensedContact
    formulation : "qp3" (a convex program, then polished), "complementarity" (the direct solver), or "qp1" and "qp2" (a
        local solver over pressures and displacements, then polished)
    weights : the J of the objective, a `Weights` or its name: "tributary", "consistent" or "element_length"
    penalty : μ of QP2, free of units, from 1e-8 to 1e8
    rows : how QP1 and QP2 write the equations, a `Rows` or its name: "stiffness" or "compliance"
    equilibrium : of QP2, for bodies with free rigid motions: "constraint", or "penalty" as in [SS92]
    start : of QP1 and QP2: "null", "random", or a `Start` with a pressure (n,) [p] and a displacement (n,) [L]; if not
        given, random with `seed` or `starts`, else null
    seed : of random starts, 0 if not given
    starts : how many random starts; the answer is that of the best end, `Result.starts` has all of them
    max_iterations : limit of the iterations of the local solver, of Clarabel (QP3), or of the pivots of Lemke's method
        (complementarity); None for the solver's own
    progress : called after the search from each of several random starts with the number of those done

    Returns
    -------
    Result
        Check `certified`: a solver that fails is a `Status`, not an error.

    Raises
    ------
    OptionError
        A `ProblemError`: a name is unknown, a number out of range, or the formulation has no use for an option.
    ProblemError
        If the problem has no answer.
    NotConvexError
        If the formulation needs a convex program and this is none.
    """
    plan = planned(
        formulation,
        weights,
        penalty=penalty,
        rows=rows,
        equilibrium=equilibrium,
        start=start,
        seed=seed,
        starts=starts,
        max_iterations=max_iterations,
    )
    return carry_out(plan, problem, progress)


def carry_out(
    plan: Plan, problem: Problem | CondensedContact, progress: Callable[[int], object] | None = None
) -> Result:
    """Solve a contact problem as planned, and judge the answer; all else is as of `solve`."""
    watch = Stopwatch()
    problem, fit = fitted_to_contact(problem, watch)
    contact, condensation = condensed(problem, watch)
    with watch.stage("solution"):
        solution, ends = plan.start.search(contact, FORMULATIONS[plan.formulation], plan.options, progress)
    return judged(problem, condensation, contact, solution, plan.options.weights, watch, ends, fit)


def fitted_to_contact(
    problem: Problem | CondensedContact, watch: Stopwatch
) -> tuple[Problem | CondensedContact, MeshFit | None]:
    """Fit the mesh to the ends of contact where the problem asks for it, as `fitting.fitted` does.

    Refuses a problem with load cases of which none acts, with a `ProblemError`.
    """
    ensure_acting(problem)
    if isinstance(problem, CondensedContact) or not problem.mesh.fit_contact_edges:
        return problem, None
    with watch.stage("mesh fit") as say:
        return fitted(problem, say)


def condensed(problem: Problem | CondensedContact, watch: Stopwatch) -> tuple[CondensedContact, Condensation | None]:
    """Condense a problem that is not condensed yet; all else is as of `condense`.

    Returns
    -------
    CondensedContact
    Condensation or None
        What it came from, with the body; None if it was condensed already.
    """
    ensure_kind(problem)
    if isinstance(problem, CondensedContact):
        return problem, None
    with watch.stage("mesh"):
        body = body_of(problem)
    with watch.stage("condensation"):
        condensation = condense_body(body)
    return condensation.contact, condensation


def judged(
    problem: Problem | CondensedContact,
    condensation: Condensation | None,
    contact: CondensedContact,
    solution: ContactSolution,
    weights: Weights,
    watch: Stopwatch,
    ends: RandomStarts | None = None,
    fit: MeshFit | None = None,
) -> Result:
    """Recover the boundary behind a solution, and judge both.

    Parameters
    ----------
    problem, condensation, contact : the problem as it was given, and as `condensed` has it
    solution : of it
    weights : of the objective
    watch : with the stages so far
    ends : of random starts, if several were made
    fit : how the mesh was fitted, if it was

    Returns
    -------
    Result
    """
    boundary = None
    if condensation is not None:
        with watch.stage("recovery"):
            boundary = boundary_state(condensation, solution.pressure, solution.rigid_amplitudes)
    with watch.stage("assessment"):
        judged = residuals(contact, solution, None if boundary is None else boundary.force_balance)
        certificate = certify(contact, solution, judged)
        where = footprint(contact, solution)
        touching = contact.touching(solution.pressure, solution.displacement) & (solution.pressure > 0)
        notes = (
            *(() if fit is None else fit.notes),
            *contact.notes,
            *solution.notes,
            *remarks.of_few_points(contact, touching, where),
        )
        if condensation is not None:
            body = condensation.body
            notes += (*remarks.of_zone_ends(body, touching), *remarks.of_long_neighbours(body, touching))
            notes += (*remarks.of_size(body, where),)
    gap = contact.initial_gap + solution.displacement
    return Result(
        problem=problem if isinstance(problem, Problem) else None,
        contact=contact,
        solution=solution,
        weights=weights,
        objective=float(solution.pressure @ contact.weight_matrix(weights) @ gap),
        residuals=judged,
        certificate=certificate,
        footprint=where,
        boundary=boundary,
        degrees_of_freedom=None if condensation is None else condensation.body.mesh.degrees_of_freedom,
        notes=notes,
        seconds=watch.seconds,
        starts=ends,
        mesh_fit=fit,
    )


def random_starts(
    problem: Problem | CondensedContact,
    formulation: str = FormulationName.QP1,
    weights: Weights | str = Weights.TRIBUTARY,
    *,
    count: int = 100,
    seed: int = 0,
    penalty: float = 1.0,
    rows: Rows | str = Rows.STIFFNESS,
    equilibrium: Equilibrium | str = Equilibrium.CONSTRAINT,
    max_iterations: int | None = None,
    progress: Callable[[int], object] | None = None,
) -> RandomStarts:
    """Solve QP1 or QP2 from random starts and tell which minima were found, and how often; nothing is polished.

    Parameters
    ----------
    problem : Problem or CondensedContact
    formulation : "qp1" or "qp2"
    weights, penalty, rows, equilibrium, max_iterations : as of `solve`
    count, seed : of the starts; the same seed gives the same starts
    progress : called after each search with the number of those done

    Returns
    -------
    RandomStarts

    Raises
    ------
    ProblemError
        As of `solve`.
    """
    ensure_whole(count, "number of starts", 1)
    ensure_whole(seed, "seed", 0)
    plan = planned(
        formulation,
        weights,
        penalty=penalty,
        rows=rows,
        equilibrium=equilibrium,
        start=StartName.RANDOM,
        max_iterations=max_iterations,
    )
    ensure_kind(problem)
    contact = problem if isinstance(problem, CondensedContact) else condense(problem)
    return search_from(contact, FORMULATIONS[plan.formulation], plan.options, count, seed, progress)
