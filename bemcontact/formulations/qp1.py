"""QP1, (27)-(29): the work of the pressure in the gap over displacements and pressures, from a local solver.

    minimize   pᵀJ(ε + u_n)    over u_n, p
    subject to K u_n = B p + r,  ε + u_n >= 0,  p >= 0

Its Hessian [[0, Jᵀ], [J, 0]] is indefinite. On the equations it is that of QP3, so that QP1 is convex on what they
leave free wherever QP3 is. For bodies with free rigid motions K is singular, and the stiffness rows contain
equilibrium.
"""

from dataclasses import replace

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.formulations.program import (
    Program,
    contact_equations,
    equilibrium,
    lower_bounds,
    no_equations,
)
from bemcontact.formulations.qp3 import NEGLIGIBLE, smallest_eigenvalue
from bemcontact.formulations.scaling import scale, scaled_weights
from bemcontact.formulations.search import polished, searched
from bemcontact.options import FormulationName, Rows, SolveOptions, options_of


def program_of(contact: CondensedContact, options: SolveOptions) -> Program:
    """(27)-(29) on the scaled problem, over (u_n, p), or (u_n, p, a) with the compliance rows.

    The compliance rows need ℓᵀp = -load beside them. `ProblemError` if the problem does not carry the weights.
    """
    equations = contact_equations(contact, options.rows)
    size = equations.matrix.shape[1]
    if options.rows is Rows.COMPLIANCE:
        equations = equations.and_also(equilibrium(scale(contact), size))
    return Program(
        weights=scaled_weights(contact, options.weights),
        penalized=no_equations(size),
        penalty=1.0,
        equations=equations.of_unit_size,
        lower=lower_bounds(contact, size),
    )


def solve(contact: CondensedContact, options: SolveOptions | None = None) -> ContactSolution:
    """Find a local minimum of QP1, then polish it unless it is certain not to be the contact state.

    The status is `Status.LOCAL_MINIMUM` at a stationary point that is not the contact state, and
    `Status.NUMERICAL_FAILURE` where QP1 is convex on its equations and has no such point. `smallest_eigenvalue` is that
    of the Hessian on the equations. The history is the sum of infeasibilities, as the solver scales them, and then
    `Program.value`. `ProblemError` if the problem does not carry the weights, or an option has no meaning for QP1.
    """
    options = options_of(FormulationName.QP1, options)
    program = program_of(contact, options)
    eigenvalue = smallest_eigenvalue(scale(contact), scaled_weights(contact, options.weights))
    only = eigenvalue is None or eigenvalue > NEGLIGIBLE
    solution = searched(contact, options, program, only=only)
    return replace(polished(contact, options, solution), smallest_eigenvalue=eigenvalue)
