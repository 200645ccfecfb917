"""The direct solver: gap = q + M p + R a >= 0, p >= 0, p·gap = 0, ℓᵀp = -load, and the polish of other solvers.

Primal-dual active set first, Lemke's method behind it. The quadratic programs are compared with it.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import qr
from scipy.optimize import nnls

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status, Trace, traces_in_turn
from bemcontact.errors import ProblemError
from bemcontact.formulations.active_set import ActiveSetEnd, first_active_set, primal_dual
from bemcontact.formulations.lemke import lemke
from bemcontact.formulations.scaling import ScaledContact, scaled, scaled_point, unscaled
from bemcontact.options import FormulationName, SolveOptions, options_of

ACCEPTED = 1e-11
"""Value of `ScaledContact.residual` up to which a point is a solution: a little above round-off."""
BALANCED = 1e-12
"""Fraction of the load, by its norm, that may remain without support before the load counts as impossible to carry."""
POLISH_STEPS = 10
NAMED = 1e-9
"""Least share of a motion that a sentence names."""

ACTIVE_SET, LEMKE = "primal-dual active set", "Lemke's method"


@dataclass(frozen=True, kw_only=True, eq=False)
class LcpResult:
    """Result of `solve_lcp`; z and w are a solution only with `Status.SOLVED`.

    Parameters
    ----------
    z, w : (n,) with z >= 0 and w = q + M z
    status : INFEASIBLE is said only with a certificate of Farkas in hand
    iterations : steps of the active set plus pivots
    method : the one that ended the search
    """

    z: Array
    w: Array
    status: Status
    iterations: int
    method: str


def solve_lcp(M: ArrayLike, q: ArrayLike) -> LcpResult:
    """Solve a linear complementarity problem: z >= 0, w = q + M z >= 0, z·w = 0.

    Parameters
    ----------
    M : (n, n), neither symmetric nor definite of necessity; if it is row sufficient, there is always an answer
    q : (n,)

    Returns
    -------
    LcpResult

    Raises
    ------
    ProblemError
        Shapes that do not fit, or entries that are not finite numbers.
    """
    M, q = np.array(M, float, ndmin=2), np.array(q, float, ndmin=1)
    n = len(q)
    if M.shape != (n, n) or not (np.isfinite(M).all() and np.isfinite(q).all()):
        raise ProblemError(f"M (n, n) and q (n,) of finite numbers are needed; found shapes {M.shape} and {q.shape}")
    U = float(np.abs(q).max(initial=0.0)) or 1.0
    T = U / (float(np.abs(M).sum(axis=1).max(initial=0.0)) or 1.0)
    contact = ScaledContact(
        compliance=M * (T / U),
        offset=q / U,
        rigid_motions=np.zeros((n, 0)),
        motion_load=np.zeros(0),
        weights=np.ones(n),
    )
    search = _search(contact, None)
    z = search.end.pressure * T
    return LcpResult(z=z, w=q + M @ z, status=search.status, iterations=search.iterations, method=search.method)


def solve(contact: CondensedContact, options: SolveOptions | None = None) -> ContactSolution:
    """Solve the complementarity problem (16)-(18) with (35)-(38) directly, without an objective.

    Parameters
    ----------
    options : `max_iterations` limits the pivots of Lemke's method; the rest has no meaning here and must not be set

    Returns
    -------
    ContactSolution
        p is exactly zero off the contact set. With `Status.INFEASIBLE` p = 0, and the notes say in which motion the
        load carries the body away. Its history is `ScaledContact.residual` after each step of the active set, and
        as "infeasibility" the artificial variable z0 after each pivot of Lemke's method.

    Raises
    ------
    ProblemError
        An option has no meaning here, such as weights.
    """
    options = options_of(FormulationName.COMPLEMENTARITY, options)
    if note := escape_note(contact):
        return _without_contact(contact, note)
    body = scaled(contact)
    carried = replace(body, motion_load=body.motion_load - loose_load(body))
    search = _search(carried, options.max_iterations)
    if search.status is Status.INFEASIBLE:
        note = "the path of pivots ended on a ray that proves that no pressure will do"
        empty = _without_contact(contact, note)
        return replace(empty, solver=search.method, iterations=search.iterations, history=search.history)
    p, u_n, a = unscaled(contact, search.end.pressure, search.end.amplitudes)
    return ContactSolution(
        formulation=FormulationName.COMPLEMENTARITY,
        solver=search.method,
        status=search.status,
        pressure=p,
        displacement=u_n,
        rigid_amplitudes=a,
        iterations=search.iterations,
        history=search.history,
    )


def polish(contact: CondensedContact, solution: ContactSolution) -> ContactSolution:
    """Make an approximate solution exact by a few primal-dual steps from its contact set {p/T > δ/U}.

    Parameters
    ----------
    solution : of any formulation

    Returns
    -------
    ContactSolution
        With `polished` set if the natural residual got smaller, or is at round-off where the solver had left traces of
        pressure off the contact set. Else `solution` itself.
    """
    body = scaled(contact)
    p, a = scaled_point(contact, solution.pressure, solution.rigid_amplitudes)
    touching = contact.touching(solution.pressure, solution.displacement)
    end = primal_dual(body, touching, POLISH_STEPS)
    cleaner = end.residual <= ACCEPTED and solution.pressure[~touching].any()
    if not (cleaner or end.residual < body.residual(p, a)):
        return solution
    p, u_n, a = unscaled(contact, end.pressure, end.amplitudes)
    return replace(solution, pressure=p, displacement=u_n, rigid_amplitudes=a, unpolished=solution.pressure)


def loose_load(contact: ScaledContact) -> Array:
    """The part r (k,) of the load that no p >= 0 carries: the least ℓᵀp + load by norm.

    Where it is not zero, it is the motion in which the body leaves: R r >= 0 opens every gap, and the load works on it,
    r·load = r·r > 0 (Farkas).
    """
    ell, load = contact.equilibrium, contact.motion_load
    return ell.T @ nnls(ell.T, -load)[0] + load if load.size else load


def escape_note(contact: CondensedContact) -> str | None:
    """Describe the motion in which the load carries the body off its support; None if the support carries the load."""
    body = scaled(contact)
    motion = loose_load(body)
    if np.linalg.norm(motion) <= BALANCED * np.linalg.norm(body.motion_load):
        return None
    return escape_words(contact, motion)


def escape_words(contact: CondensedContact, motion: Array) -> str:
    """Describe the motion (k,), dimensionless, in which the load carries the body off its support."""
    parts = zip(motion / np.abs(motion).max(), contact.motion_names, strict=True)
    terms = ", ".join(f"{part:+.3g} x {name}" for part, name in parts if abs(part) > NAMED)
    return f"the load carries the body off its support, in a motion that no contact resists: {terms}"


def standard_form(contact: ScaledContact) -> tuple[Array, Array, BoolArray]:
    """The contact problem as w = q' + M' z without free motions, by one principal pivot.

    Choose k points B on which R_B has full rank (QR with pivoting). The block of [[M, R], [ℓᵀ, 0]] on B and the motions
    then is nonsingular whatever M is, so that p_B and a can be expressed by δ_B and p elsewhere. On B pressure and gap
    change places. Rows are weighted by J: Δzᵀ Δw = Δpᵀ JM Δp on the equilibrium space, so that M' inherits
    semidefiniteness from sym(JM) there.

    Returns
    -------
    matrix : (n, n) M'
    vector : (n,) q'
    exchanged : (n,) True on B: z is the gap and w the pressure there
    """
    M, R, ell, J = contact.compliance, contact.rigid_motions, contact.equilibrium, contact.weights
    n, k = R.shape
    B = _spanning_points(np.sqrt(J)[:, None] * R)
    rest = np.setdiff1d(np.arange(n), B)
    inside, order = np.append(B, n + np.arange(k)), np.append(B, rest)
    W = np.block([[M, R], [ell.T, np.zeros((k, k))]])
    h = np.append(contact.offset, contact.motion_load)
    given = np.hstack([np.eye(2 * k, k), -W[np.ix_(inside, rest)], -h[inside, None]])
    inner = np.linalg.solve(W[np.ix_(inside, inside)], given)
    gap_rest = W[np.ix_(rest, inside)] @ inner + np.hstack([np.zeros((n - k, k)), M[np.ix_(rest, rest)], h[rest, None]])
    rows = np.empty((n, n + 1))
    rows[order] = np.vstack([inner[:k], gap_rest])
    matrix = np.empty((n, n))
    matrix[:, order] = rows[:, :n]
    return J[:, None] * matrix, J * rows[:, n], np.isin(np.arange(n), B)


def _spanning_points(motions: Array) -> IntArray:
    """As many rows as an (n, k) matrix has columns, as independent as the pivoting of QR makes them."""
    k = motions.shape[1]
    return np.array(qr(motions.T, mode="r", pivoting=True)[-1][:k], np.int64) if k else np.zeros(0, np.int64)


@dataclass(frozen=True, kw_only=True, eq=False)
class _SearchEnd:
    """End of a search: the point, its status, the method that ended it, and the history of both methods."""

    end: ActiveSetEnd
    status: Status
    method: str
    history: tuple[Trace, ...]

    @property
    def iterations(self) -> int:
        """Steps and pivots."""
        return sum(len(trace.values) for trace in self.history)


def _search(contact: ScaledContact, pivot_limit: int | None) -> _SearchEnd:
    """Primal-dual active set; if it cycles, Lemke's method, and the active set again from its end."""
    first = primal_dual(contact, first_active_set(contact))
    if first.residual <= ACCEPTED:
        history = traces_in_turn(("residual", first.residuals))
        return _SearchEnd(end=first, status=Status.SOLVED, method=ACTIVE_SET, history=history)
    matrix, vector, exchanged = standard_form(contact)
    path = lemke(matrix, vector, limit=pivot_limit)
    second = primal_dual(contact, path.active ^ exchanged, POLISH_STEPS)
    history = traces_in_turn(
        ("residual", first.residuals), ("infeasibility", path.covers), ("residual", second.residuals)
    )
    if second.residual <= ACCEPTED:
        return _SearchEnd(end=second, status=Status.SOLVED, method=LEMKE, history=history)
    status = Status.NUMERICAL_FAILURE if path.status is Status.SOLVED else path.status
    best = min(first, second, key=lambda end: end.residual)
    return _SearchEnd(end=best, status=status, method=LEMKE, history=history)


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
