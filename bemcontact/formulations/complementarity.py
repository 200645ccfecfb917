"""The direct solver: gap = q + M p + R a >= 0, p >= 0, p·gap = 0, ℓᵀp = -load, and the polish of other solvers.

The primal-dual active set comes first, from two starts. Where both cycle, Lemke's complementary pivoting follows
(Cottle, Pang and Stone, "The Linear Complementarity Problem", 1992, section 4.4, with the lexicographic rule of section
4.9, which makes it finite). For a row sufficient M its path ends at a solution or proves that there is none. The
quadratic programs are compared with the direct solution.
"""

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import ArrayLike
from scipy.linalg import qr

from bemcontact.arrays import Array, BoolArray, IntArray, powers_of_two, real_array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status, Trace, traces_in_turn
from bemcontact.errors import ProblemError
from bemcontact.formulations.active_set import ActiveSetEnd, first_active_set, primal_dual, resting_points
from bemcontact.formulations.local_solver.infeasibility import proof_of_infeasibility
from bemcontact.formulations.open_position import with_chosen_position
from bemcontact.formulations.scaling import ACCEPTED, ScaledContact, scale, scaled_point, unscaled
from bemcontact.options import FormulationName, SolveOptions, options_of

PIVOT = 1e-11
TIE = 1e-12
VANISHED = 1e-13
VERIFIED, LEAST = 1e-10, 1e-4
"""Part of the terms of a number that may be rounding; part of the largest variable that any variable counts with."""
FAINT = 1e-15
"""Part of the largest variable that may be rounding of it."""
REFRESH = 50
"""Pivots after which the inverse of the basis is computed anew, against the growth of round-off."""
BALANCED = 1e-12
"""Fraction of the load, by its norm, that may remain without support before the load counts as impossible to carry."""
POLISH_STEPS = 10
EQUILIBRATIONS = 10
OF_RIGHT, UNDECIDED = 1e-6, 1e-10
"""Weights of the numbers of q, and of a factor of one, in the choice of natural factors; the numbers of M have one."""
NAMED = 1e-9
"""Least share of a motion that a sentence names."""

ACTIVE_SET, LEMKE = "primal-dual active set", "Lemke's method"


@dataclass(frozen=True, kw_only=True, eq=False)
class LemkeEnd:
    """How the path of pivots ended: its status, where z is basic (n,), and z0 after each pivot (`covers`).

    The status is SOLVED, INFEASIBLE (proved by a ray), ITERATION_LIMIT, or NO_SOLUTION_FOUND (no proof).
    """

    status: Status
    active: BoolArray
    covers: tuple[float, ...]

    @property
    def pivots(self) -> int:
        """Number of pivots."""
        return len(self.covers)


def lemke(M: Array, q: Array, covering: Array | None = None, limit: int | None = None) -> LemkeEnd:
    """Follow the solutions of w = q + M z + d z0 from a large z0 down to z0 = 0.

    Solve for the values of the basic variables anew: that is more accurate than the pivots are. Rows and columns are
    scaled alike until the largest number of each is near one, for short elements make numbers of M that are smaller
    than the round-off of others; q is scaled to one.

    Parameters
    ----------
    M, q : (n, n) and (n,)
    covering : (n,) d > 0. The default, row sums of |M| plus max|q| once scaled, takes two pivots for the families of
        Murty and of Fathi; d = (1, 2, 4, ...) takes 2ⁿ for Murty's.
    limit : of pivots, default 1000 + 50 n
    """
    n = len(q)
    if (q >= 0).all():
        return LemkeEnd(status=Status.SOLVED, active=np.zeros(n, bool), covers=())
    factors = equilibrating(M)
    M, q = factors[:, None] * M * factors, factors * q
    unit = float(powers_of_two(np.abs(q).max()))
    q = q / unit
    d = np.abs(M).sum(axis=1) + np.abs(q).max() if covering is None else factors * covering
    limit = 1000 + 50 * n if limit is None else limit
    basis, covers = _Basis(M, q, d), []
    entering, column, row = basis.cover, -d, basis.leaving_row(d)
    while row is not None and len(covers) < limit:
        left = basis.exchange(row, entering, column)
        covers.append(unit * basis.cover_value)
        if left == basis.cover:
            status = Status.SOLVED if _is_solution(M, q, basis.active) else Status.NO_SOLUTION_FOUND
            return LemkeEnd(status=status, active=basis.active, covers=tuple(covers))
        entering = left + n if left < n else left - n
        column = basis.column(entering)
        row = basis.leaving_row(column)
    status = Status.ITERATION_LIMIT if row is not None else _end_of_ray(M, q, basis, entering, column)
    return LemkeEnd(status=status, active=basis.active, covers=tuple(covers))


def equilibrating(M: Array) -> Array:
    """Powers of two (n,), for rows and columns alike, by which the largest number of each becomes one, nearly.

    D. Ruiz, "A scaling algorithm to equilibrate both rows and columns norms in matrices", RAL-TR-2001-034.
    """
    size, factors = np.abs(M), np.ones(len(M))
    for _ in range(EQUILIBRATIONS):
        equal = factors[:, None] * size * factors
        largest = np.maximum(equal.max(axis=0, initial=0.0), equal.max(axis=1, initial=0.0))
        factors /= np.sqrt(np.where(largest > 0, largest, 1.0))
    return powers_of_two(factors)


def holds(M: Array, q: Array, z: Array) -> bool:
    """Whether z (n,) solves the problem up to rounding: each number beside the terms it is made of.

    Where w is not zero, z has to be too small to matter in any row. A z that is small beside others has their rounding,
    so that units of variables should be even.
    """
    size = np.abs(z)
    known = np.where(size > 0, np.maximum(size, LEAST * size.max(initial=0.0)), 0.0)
    terms = VERIFIED * (np.abs(M) @ known + np.abs(q))
    w = q + M @ z
    faint = (np.abs(M) * size <= terms[:, None]).all(axis=0)
    return bool((w >= -terms).all() and ((z >= 0) | faint).all() and ((w <= terms) | faint).all())


def _holds_row_by_row(M: Array, q: Array, z: Array) -> bool:
    """Whether z >= 0 (n,) solves the problem, each w held against its own terms alone."""
    terms, w = VERIFIED * (np.abs(M) @ z + np.abs(q)), q + M @ z
    return bool((w >= -terms).all() and (w <= terms)[z > 0].all())


def basic_solution(M: Array, q: Array, active: BoolArray) -> Array:
    """The z (n,) with w = q + M z = 0 where `active` and z = 0 elsewhere; the shortest one where there are several."""
    z = np.zeros(len(q))
    z[active] = -np.linalg.lstsq(M[np.ix_(active, active)], q[active], rcond=None)[0]
    return z


def _is_solution(M: Array, q: Array, active: BoolArray) -> bool:
    """Whether the values of a basis solve the problem."""
    return holds(M, q, basic_solution(M, q, active))


class _Basis:
    """The dictionary w - M z - d z0 = q for one set of basic variables: 0..n-1 are w, n..2n-1 are z, 2n is z0."""

    def __init__(self, M: Array, q: Array, d: Array) -> None:
        self.cover = 2 * len(q)
        self.vectors = np.vstack([np.eye(len(q)), -M.T, -d])
        self.right = q
        self.basic = np.arange(len(q))
        self.inverse = np.eye(len(q))
        self.values = q.copy()
        self.age = 0

    @property
    def active(self) -> BoolArray:
        """(n,) True where z is basic."""
        active = np.zeros(self.cover + 1, bool)
        active[self.basic] = True
        return active[len(self.right) : self.cover]

    @property
    def cover_value(self) -> float:
        """z0, which is zero where it is not basic."""
        return float(self.values[self.basic == self.cover].sum())

    def column(self, variable: int) -> Array:
        """Decrease of each basic variable per increase of this one, (n,)."""
        return self.inverse @ self.vectors[variable]

    def leaving_row(self, column: Array) -> int | None:
        """The basic variable that first falls to zero, lexicographically; z0 where it is among the first."""
        rows = np.flatnonzero(column > PIVOT * max(1.0, np.abs(column).max()))
        if not rows.size:
            return None
        for values in (self.values, *self.inverse.T):
            ratios = values[rows] / column[rows]
            rows = rows[ratios <= ratios.min() + TIE]
            for row in rows[self.basic[rows] == self.cover]:
                return int(row)
            if rows.size == 1:
                break
        return int(rows[0])

    def exchange(self, row: int, entering: int, column: Array) -> int:
        """Pivot, and return the variable that left."""
        left = int(self.basic[row])
        self.basic[row] = entering
        self.age += 1
        for array in (self.inverse, self.values):
            pivot_row = array[row] / column[row]
            array -= np.multiply.outer(column, pivot_row)
            array[row] = pivot_row
        if self.age % REFRESH == 0:
            with suppress(np.linalg.LinAlgError):  # then the updated inverse has to serve
                self.inverse = np.linalg.inv(self.vectors[self.basic].T)
                self.values = self.inverse @ self.right
        return left


def _end_of_ray(M: Array, q: Array, basis: _Basis, entering: int, column: Array) -> Status:
    """Infeasible, if the direction y >= 0 of z along which nothing falls proves it, or another one."""
    if basis.cover_value <= VANISHED and _is_solution(M, q, basis.active):
        return Status.SOLVED
    direction = np.zeros(basis.cover + 1)
    direction[basis.basic] = -column
    direction[entering] = 1.0
    y = np.maximum(direction[len(q) : basis.cover], 0.0)
    infeasible = excludes(M, q, y) or excludes(M, q, _separating(M, q))
    return Status.INFEASIBLE if infeasible else Status.NO_SOLUTION_FOUND


def _separating(M: Array, q: Array) -> Array:
    """The y (n,) with 0 <= y <= 1 and Mᵀy <= 0 for which qᵀy is least, by a linear program.

    The direction in which Lemke's method ends is one for semidefinite M, and not for such M with other weights on rows.
    """
    found = scipy.optimize.linprog(q / np.abs(q).max(), A_ub=M.T, b_ub=np.zeros(len(q)), bounds=(0.0, 1.0))
    return found.x if found.status == 0 else np.zeros(len(q))


def excludes(M: Array, q: Array, y: Array) -> bool:
    """Whether y >= 0 (n,) proves that no z >= 0 has w >= 0: Mᵀy <= 0 and qᵀy < 0 (Farkas)."""
    none = np.full(2 * len(q), np.inf)
    return proof_of_infeasibility(M, np.concatenate([0.0 * q, -q]), none, y, 0.0 * q) is not None


def _natural_factors(M: Array, q: Array) -> Array:
    """Powers of two (n,), for rows and columns alike, by which the sum of squares of all logarithms is least.

    So units do not matter (Curtis and Reid, J. Inst. Math. Appl. 10 (1972) 118-124). No number counts as rounding.
    Where M leaves factors open, as of a skew matrix, the numbers of q are made even.
    """
    size = np.maximum(np.abs(M), np.abs(M.T))
    present, given = (size > 0).astype(float), (q != 0).astype(float)
    of_rows = np.log2(size, where=size > 0, out=np.zeros_like(size)).sum(axis=1)
    of_right = np.log2(np.abs(q), where=q != 0, out=np.zeros_like(q))
    share = given / max(1.0, given.sum())
    normal = present + np.diag(present.sum(axis=1) + UNDECIDED * max(1, len(M)))
    normal += OF_RIGHT * (np.diag(given) - np.outer(given, share))
    right = -of_rows - OF_RIGHT * (of_right - given * (share @ of_right))
    return np.exp2(np.rint(scipy.linalg.solve(normal, right, assume_a="pos")))


@dataclass(frozen=True, kw_only=True, eq=False)
class LcpResult:
    """Result of `solve_lcp`; z and w are a solution only with `Status.SOLVED`.

    Parameters
    ----------
    z, w : (n,) with z >= 0 and w = q + M z
    status : INFEASIBLE only with a certificate of Farkas
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
    M : (n, n), of any kind; there is always an answer if it is row sufficient
    q : (n,)

    Returns
    -------
    LcpResult
        Check its `status`. Infeasible means that no z >= 0 has w >= 0, for entries of M that differ from these by no
        more than one unit in the last place of each.

    Raises
    ------
    ProblemError
        Shapes that do not fit, or entries that are not finite numbers.
    """
    M, q = np.atleast_2d(real_array(M, "M")), np.atleast_1d(real_array(q, "q"))
    n = q.size
    if (M.shape, q.shape) != ((n, n), (n,)) and (n or M.size):
        raise ProblemError(f"M (n, n) and q (n,) of finite numbers are needed; found shapes {M.shape} and {q.shape}")
    factors = _natural_factors(M, q)  # else a row of small numbers could be violated within the round-off of others
    factors *= equilibrating(factors[:, None] * M * factors)
    even, right = factors[:, None] * M * factors, factors * q
    U = float(np.abs(right).max(initial=0.0)) or 1.0
    T = U / (float(np.abs(even).sum(axis=1).max(initial=0.0)) or 1.0)
    contact = ScaledContact(
        compliance=even * (T / U),
        offset=right / U,
        rigid_motions=np.zeros((n, 0)),
        motion_load=np.zeros(0),
        weights=np.ones(n),
    )
    search = _search(contact, None)
    z, status = search.end.pressure * T, search.status
    if status is not Status.INFEASIBLE and not holds(even, right, z):
        path = lemke(even, right)
        z, status = np.maximum(basic_solution(even, right, path.active), 0.0), path.status
    if status is Status.SOLVED:
        clean = np.where(z > FAINT * z.max(initial=0.0), z, 0.0)  # small numbers may be the rounding of others
        held = [point for point in (z, clean) if _holds_row_by_row(even, right, point)]
        z, status = (held[0], status) if held else (z, Status.NO_SOLUTION_FOUND)
    with np.errstate(over="ignore", invalid="ignore"):
        z = factors * z
        w = q + M @ z
    if not (np.isfinite(z).all() and np.isfinite(w).all()):
        raise ProblemError("the solution has numbers that are too large to compute with; scale M or q")
    return LcpResult(z=z, w=w, status=status, iterations=search.iterations, method=search.method)


def solve(contact: CondensedContact, options: SolveOptions | None = None) -> ContactSolution:
    """Solve the complementarity problem (16)-(18) with (35)-(38) directly, without an objective.

    p is exactly zero off the contact set. With `Status.INFEASIBLE` p = 0, and the notes describe the motion in which
    the load pulls the body off. The history is `ScaledContact.residual` after each step of the active set, and as
    "infeasibility" the artificial variable z0 after each pivot of Lemke's method, which `max_iterations` limits.
    `ProblemError` if another option is set.
    """
    options = options_of(FormulationName.COMPLEMENTARITY, options)
    if note := escape_note(contact):
        return _without_contact(contact, note)
    scaled = scale(contact)
    carried = replace(scaled, motion_load=scaled.motion_load - loose_load(scaled))
    search = _search(carried, options.max_iterations)
    if search.status is Status.INFEASIBLE:
        note = "Lemke's method ended on a ray, which proves that no pressure satisfies the conditions"
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
    return ell.T @ scipy.optimize.nnls(ell.T, -load)[0] + load if load.size else load


def escape_note(contact: CondensedContact) -> str | None:
    """Describe the motion in which the load pulls the body off its support; None if the support carries the load."""
    scaled = scale(contact)
    motion = loose_load(scaled)
    if np.linalg.norm(motion) <= BALANCED * np.linalg.norm(scaled.motion_load):
        return None
    return escape_words(contact, motion)


def escape_words(contact: CondensedContact, motion: Array) -> str:
    """Describe the motion (k,), dimensionless, in which the load pulls the body off its support."""
    parts = zip(motion / np.abs(motion).max(), contact.motion_names, strict=True)
    moved = [(part, name) for part, name in parts if abs(part) > NAMED]
    terms = ", ".join(f"{part:+.3g} x {name}" for part, name in moved)
    if len(moved) == 1:
        terms = f"the {moved[0][1]}{', backwards' if moved[0][0] < 0 else ''}"
    return f"the load pulls the body off its support, in a motion that nothing holds: {terms}"


def standard_form(scaled: ScaledContact) -> tuple[Array, Array, BoolArray]:
    """The contact problem as w = q' + M' z without free motions, by one principal pivot.

    Choose k points B on which R_B has full rank (QR with pivoting). The block of [[M, R], [ℓᵀ, 0]] on B and the motions
    then is nonsingular whatever M is, so that p_B and a can be expressed by δ_B and p elsewhere. On B pressure and gap
    change places. Rows are weighted by J: Δzᵀ Δw = Δpᵀ JM Δp on the equilibrium space, so that M' inherits
    semidefiniteness from sym(JM) there. The result is M' (n, n), q' (n,) and the mask of B (n,).
    """
    M, R, ell, J = scaled.compliance, scaled.rigid_motions, scaled.equilibrium, scaled.weights
    n, k = R.shape
    B = _spanning_points(np.sqrt(J)[:, None] * R)
    rest = np.setdiff1d(np.arange(n), B)
    inside, order = np.append(B, n + np.arange(k)), np.append(B, rest)
    W = np.block([[M, R], [ell.T, np.zeros((k, k))]])
    h = np.append(scaled.offset, scaled.motion_load)
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


def _search(scaled: ScaledContact, pivot_limit: int | None) -> _SearchEnd:
    """Primal-dual active set from two starts; if it cycles, Lemke's method, and the active set again from its end."""
    ends = list[ActiveSetEnd]()
    for start in (first_active_set, resting_points) if scaled.motion_load.size else (first_active_set,):
        ends.append(primal_dual(scaled, start(scaled)))
        if ends[-1].residual <= ACCEPTED:
            history = traces_in_turn(*(("residual", end.residuals) for end in ends))
            return _SearchEnd(end=ends[-1], status=Status.SOLVED, method=ACTIVE_SET, history=history)
    matrix, vector, exchanged = standard_form(scaled)
    path = lemke(matrix, vector, limit=pivot_limit)
    last = primal_dual(scaled, path.active ^ exchanged)
    history = traces_in_turn(
        *(("residual", end.residuals) for end in ends), ("infeasibility", path.covers), ("residual", last.residuals)
    )
    if last.residual <= ACCEPTED:
        return _SearchEnd(end=last, status=Status.SOLVED, method=LEMKE, history=history)
    status = Status.NUMERICAL_FAILURE if path.status is Status.SOLVED else path.status
    best = min(*ends, last, key=lambda end: end.residual)
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
