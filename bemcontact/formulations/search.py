"""The local solver on QP1 and QP2: its search for a minimum, and whether the end is the contact state."""

from dataclasses import replace
from itertools import groupby

import numpy as np

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, LocalSearch, Penalty, Status, Trace, traces_in_turn
from bemcontact.formulations.complementarity import escape_note, polish
from bemcontact.formulations.local_solver.result import QPResult, QPStatus
from bemcontact.formulations.program import Program, minimize_program
from bemcontact.formulations.scaling import contact_residual, scaled_point
from bemcontact.formulations.starts import Start, start_of
from bemcontact.options import SolveOptions, Weights

SOLUTION = 1e-8
"""Residual up to which the end of a search counts as the contact state: searches that go well leave 1e-10 and less."""
ZERO = 1e-6
"""Scaled objective that a solver's tolerance may leave where the best value is 0: large errors may hide behind it."""
STATIONARY = "stationary but not the solution, with an objective of {:.1e} (scaled) and not 0"
NEAR = "not the solution, but its objective, {:.1e} (scaled), is 0 within the tolerance of the solver"
LOST = "not the solution, although round-off makes it look stationary, with an objective of {:.1e} (scaled) and not 0"
BIASED = (
    "not the solution, with an objective of {:.1e} (scaled): consistent weights have negative entries, so that the "
    "least objective lies below 0 and off the solution, and an objective of 0 certifies nothing"
)
"""Descriptions of points where a search ended, with their objectives."""
POLISHED = (Status.SOLVED, Status.NO_SOLUTION_FOUND, Status.NUMERICAL_FAILURE)
"""Ends from which the polish is tried."""
NO_CONTACT_STATE = (
    "equations and bounds contradict each other: no pressure p >= 0 leaves a gap >= 0 at all contact points, so that "
    "no contact state exists, whatever the formulation"
)
BY_NUMBA = (
    "the local solver's iterations were taken by machine code (numba): without it, the last digits may differ, and "
    "another local minimum may be found"
)
SOLVER = "inertia-controlling active set"
QUANTITIES = {1: "infeasibility", 2: "objective"}
"""What each phase of the solver reduces."""
STATUSES = {
    QPStatus.LOCAL_MINIMIZER: Status.SOLVED,
    QPStatus.UNDECIDED: Status.SOLVED,
    QPStatus.UNBOUNDED: Status.UNBOUNDED,
    QPStatus.INFEASIBLE: Status.INFEASIBLE,
    QPStatus.ITERATION_LIMIT: Status.ITERATION_LIMIT,
    QPStatus.NUMERICAL_FAILURE: Status.NUMERICAL_FAILURE,
}


def start_vector(contact: CondensedContact, start: Start | None, size: int) -> Array:
    """A start as x of `size` entries: u_n/U, p/T, and the amplitudes that fit them best; None is the null vector."""
    x = np.zeros(size)
    if start is None:
        return x
    n = contact.size
    p, a = scaled_point(contact, start.pressure, amplitudes(contact, start.pressure, start.displacement))
    x[:n], x[n : 2 * n] = start.displacement / contact.scales.displacement, p
    x[2 * n :] = a[: size - 2 * n]
    return x


def amplitudes(contact: CondensedContact, pressure: Array, displacement: Array) -> Array:
    """The a (k,) with which u_n = Δ1 + M p + R a comes closest, in the least squares of the weights."""
    return contact.amplitudes_of(displacement - contact.free_displacement - contact.compliance @ pressure)


def searched(
    contact: CondensedContact,
    options: SolveOptions,
    program: Program,
    *,
    only: bool,
    penalty: Penalty | None = None,
) -> ContactSolution:
    """Solve a program and assess its end by its residual, not by the status of the solver.

    With weights that are not negative the least value is zero, attained at the contact state alone. An end elsewhere is
    a local minimum, or due to round-off if there is none (`only`). The displacement of the solution is the
    solver's own u_n. The penalty is reported with the search.
    """
    start = start_of(contact, options)
    result = minimize_program(program, start_vector(contact, start, len(program.linear)), options.max_iterations)
    solution = _solution(contact, options.formulation, result, _search(start, program, result, penalty))
    residual, objective = contact_residual(contact, solution), program.value(result.x)
    if solution.status is not Status.SOLVED or residual <= SOLUTION:
        return solution
    if options.weights is Weights.CONSISTENT:
        status, what = Status.LOCAL_MINIMUM, BIASED
    elif objective * max(1.0, program.penalty) <= ZERO:  # times μ it is the residual of the equations, squared
        status, what = Status.NO_SOLUTION_FOUND, NEAR
    else:
        status, what = (Status.NUMERICAL_FAILURE, LOST) if only else (Status.LOCAL_MINIMUM, STATIONARY)
    note = (
        f"{options.formulation.upper()} ended at a point where contact conditions and equations are violated by "
        f"{residual:.1e} of their scales; it is {what.format(objective)}"
    )
    return replace(solution, status=status, notes=(*solution.notes, note))


def polished(contact: CondensedContact, options: SolveOptions, solution: ContactSolution) -> ContactSolution:
    """Polish a solution where that is asked for and useful; an end that round-off has spoilt may become the solution.

    These are left as they are: a true minimum elsewhere, a search that was cut short or proved that there is no
    solution, and a solution with consistent weights.
    """
    if not options.polish or options.weights is Weights.CONSISTENT or solution.status not in POLISHED:
        return solution
    better = polish(contact, solution)
    if solution.status is Status.SOLVED or contact_residual(contact, better) > SOLUTION:
        return better
    return replace(better, status=Status.SOLVED, notes=(*better.notes, "the polish led from there to the solution"))


def ray_in_words(contact: CondensedContact, ray: Array) -> str:
    """Name the contact points whose pressure or displacement grows most along a ray (N,)."""
    n = contact.size
    displacement, pressure = ray[:n], ray[n : 2 * n]
    terms = []
    for name, part in (("pressure", pressure), ("normal displacement", displacement)):
        if (i := int(np.argmax(np.abs(part)))) < n and part[i]:
            x, y = contact.points[i]
            terms.append(f"{name} {'grows' if part[i] > 0 else 'falls'} at contact point {i} ({x:.5g}, {y:.5g})")
    return " while ".join(terms) or "the body moves rigidly"


def _search(start: Start | None, program: Program, result: QPResult, penalty: Penalty | None) -> LocalSearch:
    """The report of a search."""
    return LocalSearch(
        start="null vector" if start is None else start.label,
        phase_one_iterations=result.phase_one_iterations,
        phase_two_iterations=result.phase_two_iterations,
        working_set_changes=result.working_set_changes,
        inertia=program.inertia,
        reduced_inertia_start=result.reduced_inertia_start,
        reduced_inertia_end=result.reduced_inertia_end,
        weakly_active=len(result.weakly_active),
        objective=program.value(result.x),
        penalty=penalty,
    )


def _solution(contact: CondensedContact, formulation: str, result: QPResult, search: LocalSearch) -> ContactSolution:
    """The end of the solver in the user's units."""
    n = contact.size
    U, T = contact.scales
    notes = []
    if result.status is QPStatus.UNDECIDED:
        notes.append("the local solver left open whether its end is a minimum: zero multipliers hide directions")
    if result.status is QPStatus.UNBOUNDED and result.ray is not None:
        notes.append(f"the objective falls without end along a ray: {ray_in_words(contact, result.ray)}")
    if result.status is QPStatus.INFEASIBLE:
        notes.append(escape_note(contact) or NO_CONTACT_STATE)
    if result.by_numba:
        notes.append(BY_NUMBA)
    u_n, p = result.x[:n] * U, result.x[n : 2 * n] * T
    return ContactSolution(
        formulation=formulation,
        solver=SOLVER,
        status=STATUSES[result.status],
        pressure=p,
        displacement=u_n,
        rigid_amplitudes=amplitudes(contact, p, u_n),
        iterations=result.iterations,
        search=search,
        history=_history(result),
        notes=tuple(notes),
    )


def _history(result: QPResult) -> tuple[Trace, ...]:
    """Sum of infeasibilities after each iteration of phase one, `Program.value` after each of phase two."""
    # The program is stated without a constant, so that the objective of the solver is that value. The solver goes back
    # to phase one where round-off has violated a constraint.
    phases = groupby(result.log, key=lambda line: line.phase)
    return traces_in_turn(*((QUANTITIES[phase], [line.value for line in lines]) for phase, lines in phases))
