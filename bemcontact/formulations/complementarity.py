"""The direct solver: gap = q + M p + R a >= 0, p >= 0, p·gap = 0, ℓᵀp = -load, and the polish of other solvers.

The primal-dual active set comes first, from two starts. Where one cycles, a few pivots of Lemke's method from its best
set follow, and where all of them fail, this method from its own start. Quadratic programs are compared with the direct
solution.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import qr

from bemcontact.arrays import Array, BoolArray, IntArray, nonnegative_residual, norm
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status, Trace, traces_in_turn
from bemcontact.formulations.active_set import (
    ActiveSetEnd,
    ContactBlock,
    first_active_set,
    primal_dual,
    resting_points,
)
from bemcontact.formulations.lemke import lemke
from bemcontact.formulations.open_position import with_chosen_position
from bemcontact.formulations.scaling import ACCEPTED, ScaledContact, scale, scaled_point, unscaled
from bemcontact.frozen import frozen
from bemcontact.options import FormulationName, SolveOptions, options_of

BALANCED = 1e-12
"""Fraction of the load, by its norm, that may remain without support before the load counts as impossible to carry."""
POLISH_STEPS = 10
NEAR_PIVOTS = 100
"""Pivots of Lemke's method from the best set of a cycle. They suffice for a few wrong points, and take about as long as
the cycle."""
NAMED = 1e-9
"""Least share of a motion that a sentence names."""

ACTIVE_SET, LEMKE = "primal-dual active set", "Lemke's method"


def solve(
    contact: CondensedContact, options: SolveOptions | None = None, *, near: BoolArray | None = None
) -> ContactSolution:
    """Solve the complementarity problem (16)-(18) with (35)-(38) directly, without an objective.

    p is exactly zero off the contact set. With `Status.INFEASIBLE` p = 0, and the notes describe the motion in which
    the load pulls the body off. The history is `ScaledContact.residual` after each step of the active set, and as
    "infeasibility" the artificial variable z0 after each pivot of Lemke's method, which `max_iterations` limits.
    The search starts from the contact set (n,) of a problem `near` to it, if that is known.
    `ProblemError` if another option is set.
    """
    options = options_of(FormulationName.COMPLEMENTARITY, options)
    scaled = scale(contact)
    loose = loose_load(scaled)
    if _escapes(scaled, loose):
        return _without_contact(contact, escape_words(contact, loose))
    carried = replace(scaled, motion_load=scaled.motion_load - loose) if loose.any() else scaled
    search = find_state(carried, options.max_iterations, near)
    if search.status is Status.INFEASIBLE:
        note = "Lemke's method ended on a ray, and multipliers prove that no pressure satisfies the conditions"
        empty = _without_contact(contact, note)
        return replace(empty, solver=search.method, iterations=search.iterations, history=search.history)
    p, u_n, a = unscaled(contact, search.end.pressure, search.end.amplitudes)
    solution = ContactSolution(
        formulation=FormulationName.COMPLEMENTARITY,
        solver=search.method,
        status=search.status,
        pressure=p,
        displacement=u_n,
        rigid_amplitudes=a,
        iterations=search.iterations,
        history=search.history,
    )
    return with_chosen_position(contact, solution)


def polish(contact: CondensedContact, solution: ContactSolution) -> ContactSolution:
    """Make an approximate solution exact by a few primal-dual steps from its contact set {p/T > δ/U}.

    `polished` is set if the natural residual got smaller, or is at round-off where the solver had left traces of
    pressure off the contact set. Otherwise the solution is returned as it is. A position that is open is `settled`.
    """
    scaled = scale(contact)
    p, a = scaled_point(contact, solution.pressure, solution.rigid_amplitudes)
    touching = contact.touching(solution.pressure, solution.displacement)
    end = primal_dual(scaled, touching, POLISH_STEPS)
    cleaner = end.residual <= ACCEPTED and solution.pressure[~touching].any()
    if not (cleaner or end.residual < scaled.residual(p, a)):
        return with_chosen_position(contact, solution)
    p, u_n, a = unscaled(contact, end.pressure, end.amplitudes)
    better = replace(solution, pressure=p, displacement=u_n, rigid_amplitudes=a, unpolished=solution.pressure)
    return with_chosen_position(contact, better)


def loose_load(scaled: ScaledContact) -> Array:
    """The part r (k,) of the load that no p >= 0 carries: the least ℓᵀp + load by norm.

    Where it is not zero, it is the motion in which the body leaves: R r >= 0 opens every gap, and the load works on it,
    r·load = r·r > 0 (Farkas).
    """
    ell, load = scaled.equilibrium, scaled.motion_load
    return nonnegative_residual(ell.T, -load) if load.size else load


def escape_note(contact: CondensedContact) -> str | None:
    """Describe the motion in which the load pulls the body off its support; None if the support carries the load."""
    scaled = scale(contact)
    motion = loose_load(scaled)
    return escape_words(contact, motion) if _escapes(scaled, motion) else None


def _escapes(scaled: ScaledContact, loose: Array) -> bool:
    """Whether the part of the load that no pressure carries is more than round-off."""
    return bool(loose.any() and norm(loose) > BALANCED * norm(scaled.motion_load))


def escape_words(contact: CondensedContact, motion: Array) -> str:
    """Describe the motion (k,), dimensionless, in which the load pulls the body off its support."""
    parts = zip(motion / np.abs(motion).max(), contact.motion_names, strict=True)
    moved = [(part, name) for part, name in parts if abs(part) > NAMED]
    terms = ", ".join(f"{part:+.3g} x {name}" for part, name in moved)
    if len(moved) == 1:
        terms = f"the {moved[0][1]}{', backwards' if moved[0][0] < 0 else ''}"
    return f"the load pulls the body off its support, in a motion that nothing holds: {terms}"


def standard_form(scaled: ScaledContact, near: BoolArray | None = None) -> tuple[Array, Array, BoolArray]:
    """The contact problem as w = q' + M' z without free motions, by one principal pivot.

    Choose k points B on which R_B has full rank (QR with pivoting). The block of [[M, R], [ℓᵀ, 0]] on B and the motions
    then is nonsingular whatever M is, so that p_B and a can be expressed by δ_B and p elsewhere. On B pressure and gap
    change places. Rows are weighted by J: Δzᵀ Δw = Δpᵀ JM Δp on the equilibrium space, so that M' inherits
    semidefiniteness from sym(JM) there. The result is M' (n, n), q' (n,) and the mask of B (n,). B may be given as a
    set (n,) `near` to the solution whose block is not singular: then z = 0 is near to it, and few q' are negative.
    """
    M, R, J = scaled.compliance, scaled.rigid_motions, scaled.weights
    n, k = R.shape
    B = _spanning_points(np.sqrt(J)[:, None] * R) if near is None else np.flatnonzero(near)
    b, rest = len(B), np.setdiff1d(np.arange(n), B)
    inside, order = np.append(B, n + np.arange(k)), np.append(B, rest)
    W, h = scaled.matrix, scaled.constant
    given = np.hstack([np.eye(b + k, b), -W[np.ix_(inside, rest)], -h[inside, None]])
    inner = np.linalg.solve(W[np.ix_(inside, inside)], given)
    gap_rest = W[np.ix_(rest, inside)] @ inner + np.hstack([np.zeros((n - b, b)), M[np.ix_(rest, rest)], h[rest, None]])
    rows = np.empty((n, n + 1))
    rows[order] = np.vstack([inner[:b], gap_rest])
    matrix = np.empty((n, n))
    matrix[:, order] = rows[:, :n]
    return J[:, None] * matrix, J * rows[:, n], np.isin(np.arange(n), B)


def _spanning_points(motions: Array) -> IntArray:
    """As many rows as an (n, k) matrix has columns, as independent as the pivoting of QR makes them."""
    k = motions.shape[1]
    return np.array(qr(motions.T, mode="r", pivoting=True)[-1][:k], np.int64) if k else np.zeros(0, np.int64)


@frozen
class FoundState:
    """End of a search: the point, its status, the method that ended it, and the history of both methods."""

    end: ActiveSetEnd
    status: Status
    method: str
    history: tuple[Trace, ...]

    @property
    def iterations(self) -> int:
        """Steps and pivots."""
        return sum(len(trace.values) for trace in self.history)


def find_state(scaled: ScaledContact, pivot_limit: int | None, near: BoolArray | None = None) -> FoundState:
    """Primal-dual active set from two starts; Lemke's method from the best set of a cycle, or from its own start.

    A set (n,) that is `near` is the first start. After Lemke's method comes the active set again from its end.
    """
    ends, traces = list[ActiveSetEnd](), list[tuple[str, tuple[float, ...]]]()

    def found(method: str, active: BoolArray) -> FoundState | None:
        """The state at the end of the active set from a start, if it is one."""
        ends.append(primal_dual(scaled, active))
        traces.append(("residual", ends[-1].residuals))
        if ends[-1].residual > ACCEPTED:
            return None
        return FoundState(end=ends[-1], status=Status.SOLVED, method=method, history=traces_in_turn(*traces))

    def after_pivots(limit: int | None, near: BoolArray | None = None) -> tuple[FoundState | None, Status]:
        """The state at the end of Lemke's method, if it is one, and how this ended."""
        matrix, vector, exchanged = standard_form(scaled, near)
        path = lemke(matrix, vector, limit=limit)
        traces.append(("infeasibility", path.covers))
        return found(LEMKE, path.active ^ exchanged), path.status

    starts = (first_active_set, resting_points) if scaled.motion_load.size else (first_active_set,)
    for start in starts if near is None else (lambda _: near, *starts):
        if state := found(ACTIVE_SET, start(scaled)):
            return state
        best = ends[-1].active
        if best.any() and ContactBlock(scaled=scaled, points=np.flatnonzero(best)).regular:
            state, _ = after_pivots(NEAR_PIVOTS if pivot_limit is None else min(pivot_limit, NEAR_PIVOTS), best)
            if state:
                return state
    state, status = after_pivots(pivot_limit)
    if state:
        return state
    best_end = min(ends, key=lambda end: end.residual)
    return FoundState(
        end=best_end,
        status=Status.NUMERICAL_FAILURE if status is Status.SOLVED else status,
        method=LEMKE,
        history=traces_in_turn(*traces),
    )


def _without_contact(contact: CondensedContact, note: str) -> ContactSolution:
    """The free body, p = 0, for a problem without solution."""
    return ContactSolution(
        formulation=FormulationName.COMPLEMENTARITY,
        solver=ACTIVE_SET,
        status=Status.INFEASIBLE,
        pressure=np.zeros(contact.size),
        displacement=contact.free_displacement,
        rigid_amplitudes=np.zeros(contact.free_motions),
        iterations=0,
        notes=(note,),
    )
