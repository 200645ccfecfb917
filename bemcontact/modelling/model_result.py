"""The result of a model: arrays, residuals, certificate, and an assessment in sentences."""

from dataclasses import replace
from typing import Any, cast

import cvxpy as cp
import numpy as np

from bemcontact.arrays import Array, freeze_arrays
from bemcontact.assessment.certificate import Certificate, certify
from bemcontact.assessment.residual import Residuals, residuals
from bemcontact.checks.attributes import WithHints
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.errors import ProblemError
from bemcontact.formulations import complementarity
from bemcontact.formulations.clarabel import STATUSES, Answer
from bemcontact.formulations.complementarity import escape_note, polish
from bemcontact.frozen import frozen

SEEN = 1e-5
"""Residual above which the optimum of a model with additions is no contact state: the root of Clarabel's tolerance."""
INACCURATE = "optimal_inaccurate"
NOT_CONTACT = "optimum of your model, not a contact state"


@frozen
class ModelResult(WithHints):
    """The optimum of a contact model, recomputed and assessed; arrays are None where there is no optimum.

    Parameters
    ----------
    status : how the solver ended
    words : the assessment in a sentence or two
    contact_state : whether it is a contact state: to round-off if nothing was added, else to the solver's tolerance
    objective : of everything that was minimized, in the user's units
    pressure : (n,) [p]
    gap : (n,) [L]
    motions : (k,) a
    tool_displacement : (t, 3) x, y [L] and rotation [rad]
    solution : contact solution, polished if nothing was added
    residuals, certificate : recomputed
    """

    status: Status
    words: str
    contact_state: bool = False
    objective: float | None = None
    pressure: Array | None = None
    gap: Array | None = None
    motions: Array | None = None
    tool_displacement: Array | None = None
    solution: ContactSolution | None = None
    residuals: Residuals | None = None
    certificate: Certificate | None = None

    def __post_init__(self) -> None:
        """Make arrays read-only."""
        freeze_arrays(self)

    def __repr__(self) -> str:
        """One line: the words."""
        return f"<ModelResult: {self.words}>"


def read_back(
    contact: CondensedContact,
    problem: cp.Problem,
    pressure: cp.Expression,
    motions: cp.Expression | None,
    answer: Answer | None,
    *,
    added: bool,
) -> ModelResult:
    """Take the arrays out of a solved problem and assess them; `added` if it is more than the contact problem.

    `answer` is that of Clarabel, None if the user solved the problem.

    `ProblemError` if the problem has not been solved, has no pressure of the model, or is not the last one solved.
    """
    if problem.status is None:
        raise ProblemError("the problem has not been solved; solve it first, or let model.solve do both")
    failed = answer is not None and answer.failed
    status = Status.NUMERICAL_FAILURE if failed else STATUSES.get(problem.status, Status.NUMERICAL_FAILURE)
    _ensure_of_the_model(problem, pressure)
    if pressure.value is None:
        return ModelResult(status=status, words=_without_optimum(contact, status, added=added))
    statistics, value = cast(Any, problem.solver_stats), cast(float, problem.value)
    solution = replace(
        solution_at(contact, pressure, motions, str(statistics.solver_name).capitalize()),
        status=status,
        iterations=int(statistics.num_iters or 0),
        notes=_notes(problem, answer),
    )
    if added:
        return replace(judged(contact, solution, added=True), objective=float(value))
    result = judged(contact, polish(contact, solution), added=False)
    return result if answer is None or status is Status.ITERATION_LIMIT else _contact_state(contact, result)


def _contact_state(contact: CondensedContact, result: ModelResult) -> ModelResult:
    """The result, if it is a certified contact state, else that of the direct solver, if that is one; with a note.

    Where the load is small beside the gaps, Clarabel's tolerance of the gaps is large beside the displacements.
    """
    solution, certificate = result.solution, result.certificate
    if solution is None or certificate is None or (certificate.certified and solution.status is Status.SOLVED):
        return result
    note = "Clarabel broke down; its point led to the contact state"
    if not certificate.certified:
        note = "Clarabel's optimum leads to no contact state; that of the direct solver is given"
        solution = replace(complementarity.solve(contact), formulation=solution.formulation)
    better = replace(solution, status=Status.SOLVED, notes=(*solution.notes, note))
    proved = judged(contact, better, added=False)
    return proved if proved.certificate is not None and proved.certificate.certified else result


def _notes(problem: cp.Problem, answer: Answer | None) -> tuple[str, ...]:
    """Say which attempt of Clarabel gave the answer, and whether an answer is inaccurate."""
    if answer is not None:
        return (answer.note,) if answer.note else ()
    return ("the tolerance asked of the solver was not reached",) if problem.status == INACCURATE else ()


def solution_at(
    contact: CondensedContact, pressure: cp.Expression, motions: cp.Expression | None, solver: str
) -> ContactSolution:
    """The present values of a model as a contact solution of the present contact problem."""
    p = np.array(pressure.value, float)
    a = np.zeros(0) if motions is None else np.array(motions.value, float)
    return ContactSolution(
        formulation="model",
        solver=solver,
        status=Status.SOLVED,
        pressure=p,
        displacement=contact.gap(p, a) - contact.initial_gap,
        rigid_amplitudes=a,
        iterations=0,
    )


def judged(contact: CondensedContact, solution: ContactSolution, *, added: bool) -> ModelResult:
    """Assess the optimum of a model; `added` if the model is more than the contact problem."""
    recomputed = residuals(contact, solution)
    certificate = certify(contact, solution, recomputed, SEEN) if added else certify(contact, solution, recomputed)
    gap = contact.initial_gap + solution.displacement
    return ModelResult(
        status=solution.status,
        words=_words(solution, certificate, recomputed, added=added),
        contact_state=not certificate.violation,
        objective=float(contact.weights @ (solution.pressure * gap)),
        pressure=solution.pressure,
        gap=gap,
        motions=solution.rigid_amplitudes,
        tool_displacement=contact.tools.displacement(solution.rigid_amplitudes),
        solution=solution,
        residuals=recomputed,
        certificate=certificate,
    )


def _ensure_of_the_model(problem: cp.Problem, pressure: cp.Expression) -> None:
    """Refuse a problem without the model's pressure, and one whose values another solve has replaced."""
    variable = pressure.variables()[0]
    if variable.id not in {own.id for own in problem.variables()}:
        raise ProblemError("the problem does not contain the pressure of this model; build it from the model's parts")
    solved = None if problem.solution is None else problem.solution.primal_vars.get(variable.id)
    same = solved is None if variable.value is None else solved is not None and np.array_equal(solved, variable.value)
    if not same:
        raise ProblemError("another problem of this model was solved since; take a result out right after its solve")


def _without_optimum(contact: CondensedContact, status: Status, *, added: bool) -> str:
    """Say why there is no optimum."""
    reason = escape_note(contact) if status is Status.INFEASIBLE else None
    if reason is not None:
        return f"There is no contact state: {reason}."
    of_whom = "what was added to the model" if added else "the contact problem"
    match status:
        case Status.INFEASIBLE:
            return f"No pressure satisfies all constraints: {of_whom} cannot be satisfied."
        case Status.UNBOUNDED:
            return f"The objective has no lower bound: {of_whom} decreases it without limit."
        case _:
            return f"No optimum was found: the solver {status.words}."


def _words(solution: ContactSolution, certificate: Certificate, recomputed: Residuals, *, added: bool) -> str:
    """The assessment in words."""
    cut = "" if solution.status is Status.SOLVED else f" The solver {solution.status.words}."
    cut += "".join(f" {note[0].upper()}{note[1:]}." for note in solution.notes) if added else ""
    if certificate.violation and added:
        return f"This is the {NOT_CONTACT}: {certificate.violation}.{cut}"
    if added:
        return (
            "This is a contact state in spite of what was added, within the tolerance of the solver (residual of "
            f"complementarity {recomputed.complementarity:.1e}).{cut}"
        )
    return f"{certificate.words}{cut}"
