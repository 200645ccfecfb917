"""Checks of claims from the data: first and second order, and rays. No factorization of a run is used.

A first-order point of a quadratic program is a local minimizer exactly if H is copositive on its critical cone
{d : E d = 0, W d >= 0}, E the equalities and the constraints with a nonzero multiplier, W the other active ones
(Majthay, Math. Programming 1 (1971) 359-365; Contesse, Numer. Math. 34 (1980) 331-332). To decide this is co-NP-hard in
general (Murty and Kabadi 1987), so the search is bounded and may end undecided.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy
from numpy.typing import NDArray

from bemcontact.arrays import Array, BoolArray, fine_remainders
from bemcontact.formulations.local_solver.factorizations import is_definite, orthogonal, unit_rows, unit_sizes
from bemcontact.formulations.local_solver.progress import SearchState
from bemcontact.formulations.local_solver.statement import EPS, Statement, largest
from bemcontact.formulations.local_solver.working_set import DEPENDENT
from bemcontact.frozen import frozen_value

ZERO = 1e-11
"""A curvature below -ZERO is negative, in units in which the rows of |H| have size one."""
ROUNDING = 1e-14
"""A curvature above -ROUNDING max(10, n) is not negative. Between the two limits it stays undecided."""
IN_CONE = 1e-11
"""A unit direction whose product with an inward normal is above -IN_CONE is in the cone."""
OF_RAY = (1e-13, 1e-12, 1e-11, 1e-10)
"""Sizes of the components of a ray that may be rounding, relative to the largest; tried one after the other."""
SADDLE = 1e-4
"""Part of its terms from which H d of a flat direction d says that directions beside it fall."""
REFINEMENTS = 2
"""Number of corrections of a ray."""
FEW = 100
PROBES = 8
DESCENTS = 30


@frozen_value
class CriticalCone:
    """{d : d_i = 0 outside `free`, E d = 0, W d >= 0}.

    Parameters
    ----------
    free : (f,) variables that no bound with a multiplier fixes
    equal : (e, f) E, full rank not required
    weak : (w, f) W, signed so that feasible means >= 0
    """

    free: NDArray[np.intp]
    equal: Array
    weak: Array


@frozen_value
class Curvature:
    """Whether H is copositive on the cone, and if not, a unit direction (n,) of the cone with negative curvature.

    `copositive` is None if the search reached its limit, or if rounding could decide.
    """

    copositive: bool | None
    direction: Array | None = None


def examine(H: Array, cone: CriticalCone, *, faces: int) -> Curvature:
    """Decide copositivity of H on the cone, within `faces` faces.

    A Cholesky factorization on the null space of E decides most cases. Otherwise faces are examined: a direction of
    least curvature lies inside a face and is an eigenvector there. After the first faces, projected descents from
    negative eigenvectors are tried before the other faces.
    """
    form = H[cone.free][:, cone.free]
    units = _units(np.abs(form), np.abs(np.vstack([cone.equal, cone.weak])))
    N, lost = null_space(unit_rows(cone.equal * units)[0], cone.free.size)
    reduced = N.T @ (units[:, None] * form * units) @ N
    if _positive_semidefinite(reduced):
        return Curvature(copositive=True)
    weak, length = unit_rows(unit_rows(cone.weak * units)[0] @ N)
    seen = length > lost  # others are combinations of the rows that are held
    weak, lost = weak[seen], max(lost, _rounding_of_rows(length[seen], cone.free.size))
    copositive, falling = _search_faces(reduced, weak, lost, min(faces, FEW))
    if copositive is None:
        falling = _probe(reduced, weak, lost)
    if copositive is None and falling is None:
        copositive, falling = _search_faces(reduced, weak, lost, faces)
    if falling is None:
        return Curvature(copositive=copositive)
    direction = np.zeros(H.shape[0])
    direction[cone.free] = units * (N @ falling)
    return Curvature(copositive=False, direction=direction / np.linalg.norm(direction))


def _units(form: Array, rows: Array) -> Array:
    """Factors of variables by which the rows of |H| have size one, or those of the constraints where |H| has none."""
    units, flat = unit_sizes(form), ~form.any(axis=0)
    curved = np.maximum.reduce(rows * units * ~flat, axis=1, initial=0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        balanced = np.where(rows > 0.0, curved[:, None] / rows, 0.0).max(axis=0, initial=0.0)
    return np.where(flat & (balanced > 0.0), balanced, units)


def null_space(rows: Array, n: int) -> tuple[Array, float]:
    """An orthonormal basis of {d : rows d = 0}, and its rounding, which is large where rows are nearly dependent."""
    if rows.shape[0] == 0 or n == 0:
        return np.eye(n), IN_CONE
    _, basis, triangle, _ = orthogonal(rows, DEPENDENT)
    return basis, max(IN_CONE, _rounding_of_rows(np.abs(triangle.diagonal()), n))


def _rounding_of_rows(length: Array, n: int) -> float:
    """Rounding of a unit direction (n,) that meets unit rows of which only this length is not in the span of others."""
    return 10.0 * n * EPS / length.min(initial=1.0)


def _positive_semidefinite(matrix: Array) -> bool:
    """Whether no eigenvalue is negative by more than rounding, by Cholesky of the shifted matrix."""
    return (
        matrix.size == 0
        or is_definite(matrix + _rounding(matrix) * np.eye(matrix.shape[0]))
        or float(np.linalg.eigvalsh(matrix)[0]) >= -_rounding(matrix)
    )


def _rounding(matrix: Array) -> float:
    """Bound of the rounding in an eigenvalue of a matrix with rows of size one."""
    return ROUNDING * max(10, matrix.shape[0])


def _projected(weak: Array, d: Array) -> Array:
    """The nearest point of {d : W d >= 0}."""
    if weak.shape[0] == 0:
        return d
    try:
        y, _ = scipy.optimize.nnls(weak.T, -d)
    except RuntimeError:  # SciPy's iteration limit: this start is given up, the faces are still to come
        return np.zeros_like(d)
    return d + weak.T @ y


def _probe(reduced: Array, weak: Array, lost: float) -> Array | None:
    """Find a falling direction by projected descents from negative eigenvectors and random sums of them."""
    eigenvalues, vectors = np.linalg.eigh(reduced)
    size = float(np.abs(eigenvalues).max())
    negative = vectors[:, eigenvalues < -ZERO]
    shown = negative[:, :PROBES]
    mixed = negative @ np.random.default_rng(0).standard_normal((negative.shape[1], PROBES))
    for start in np.hstack([shown, -shown, mixed]).T:
        d = start
        for _ in range(DESCENTS):
            d = _projected(weak, d)
            length = float(np.linalg.norm(d))
            if length < 1e-9:
                break
            d = d / length
            if _falls(reduced, weak, d, lost):
                return d
            d = d - reduced @ d / size
    return None


def _falls(reduced: Array, weak: Array, d: Array, lost: float) -> bool:
    """Whether the unit direction is in the cone, up to rounding, and has negative curvature."""
    return float(d @ reduced @ d) < -max(ZERO, _of_curvature(lost)) and bool(np.all(weak @ d >= -lost))


def _of_curvature(lost: float) -> float:
    """Rounding of a curvature in units in which the rows of |H| have size one, from that of the direction."""
    return 2.0 * lost if lost > IN_CONE else 0.0


def _search_faces(reduced: Array, weak: Array, lost: float, faces: int) -> tuple[bool | None, Array | None]:
    """Examine faces on whose span the form is not positive semidefinite, until one contains a falling direction."""
    stack: list[tuple[int, ...]] = [()]
    seen, settled = 0, True
    while stack:
        if seen >= faces:
            return None, None
        face = stack.pop()
        seen += 1
        basis, more = null_space(weak[list(face)], reduced.shape[0])
        if basis.shape[1] == 0:
            continue
        form = basis.T @ reduced @ basis
        if _positive_semidefinite(form):
            continue
        eigenvalues, vectors = np.linalg.eigh(form)
        for column in np.flatnonzero(eigenvalues < -ZERO):
            for d in (basis @ vectors[:, column], -(basis @ vectors[:, column])):
                if _falls(reduced, weak, d, max(lost, more)):
                    return False, d
        settled = settled and eigenvalues[0] < -max(ZERO, _of_curvature(max(lost, more)))
        stack += [(*face, i) for i in range(face[-1] + 1 if face else 0, weak.shape[0])]
    return True if settled else None, None


WEAK = 10.0
"""A multiplier is strong if it exceeds its zero by this factor."""
DOUBT, DOUBT_OF_ROUGH = 0.03, 0.003
"""A multiplier of the wrong sign is more than likely rounding if it exceeds its zero by this factor.

The second is for multipliers with a zero above that of the gradient, as nearly dependent rows have.
"""
MOST_ROUNDING = 1e-6
"""Part of the terms of the gradient, multipliers left out, up to which rounding of these is allowed."""
SEEN = 3e-14
"""Part of its terms from which a multiplier is more than the rounding of the point as it is."""


@frozen_value
class FirstOrder:
    """First-order conditions at a point, in scaled units.

    Parameters
    ----------
    holds : whether the point is feasible and stationary, with multipliers of the right sign on active constraints
    strong, weak : (n + m,) active constraints: equalities and those with a multiplier, and the others
    sides : (n + m,) bound that each active constraint is at (2: equality)
    size : (n + m,) absolute multipliers
    doubtful : whether the cone was reduced by a decision that rounding could change
    """

    holds: bool
    strong: BoolArray
    weak: BoolArray
    sides: NDArray[np.int8]
    size: Array
    doubtful: bool = False

    def cone(self, statement: Statement) -> CriticalCone:
        """The critical cone, with inward normals."""
        n = statement.c.size
        free, weak = (~self.strong[:n]).nonzero()[0], self.weak.nonzero()[0]
        inwards = np.where(self.sides[weak] == 1, -1.0, 1.0)
        equal = statement.A[self.strong[n:]][:, free]
        # what a row of one entry holds would be large beside the curvatures of the others
        while (single := np.count_nonzero(equal, axis=1) <= 1).any():
            held = equal[single].any(axis=0)
            free, equal = free[~held], equal[~single][:, ~held]
        fixed, rows = weak[weak < n], weak[weak >= n] - n
        normals = np.zeros((weak.size, free.size))
        normals[: fixed.size] = fixed[:, None] == free
        normals[fixed.size :] = statement.A[rows][:, free]
        return CriticalCone(free=free, equal=equal, weak=inwards[:, None] * normals)

    def stricter(self, along: Array, blocking: int) -> "FirstOrder":
        """Doubtful conditions of a smaller cone, without a direction on which the objective does not clearly fall.

        Small multipliers that make the objective rise are taken as strong. If there are none, the constraint that
        blocks the step is taken as active.
        """
        leaving = self.weak & (self.sides * along < 0.0) & (self.size > 0.0)
        sides, weak = self.sides.copy(), self.weak & ~leaving
        if not leaving.any():
            reached = -1 if along[blocking] < 0.0 else 1
            leaving[blocking], weak[blocking] = weak[blocking], not weak[blocking]
            sides[blocking] = reached
        return replace(self, strong=self.strong | leaving, weak=weak, sides=sides, doubtful=True)


def first_order(
    progress: SearchState, working: BoolArray, multipliers: Array, zeros: Array, terms: Callable[[], Array]
) -> FirstOrder:
    """Recompute the first-order conditions at the point; a multiplier below its entry of `zeros` (n + m,) is zero.

    `terms` returns the sizes (n + m,) of what multipliers are made of; it is called if a sign is wrong. A multiplier of
    the wrong sign that is zero only because points far away had a large rounding is doubtful. A constraint that is not
    in the `working` set is active if its bound is as near as rounding.
    """
    statement, n = progress.statement, progress.x.size
    values = progress.exact_values
    slack, sharp, size = 2.0 * progress.slack, progress.sharp, np.abs(multipliers)
    violation, rest = statement.violation(values), np.abs(progress.gradient - statement.transposed(multipliers))
    feasible = not np.count_nonzero(violation) or _all(violation <= progress.allowed(sharp))
    stationary = largest(rest) <= 2.0 * progress.zero
    if not stationary:
        rounding = 4.0 * EPS * (size[:n] + size[n:].dot(statement.absolute[2]))
        own = progress.terms(size[:0], statement.A[:0])  # multipliers of which more is rounding say nothing
        rounding = np.minimum(rounding, np.maximum(MOST_ROUNDING * own, progress.zero))
        stationary = _all(rest <= 2.0 * progress.zero + rounding)
    below, above = statement.distances(values)
    sides = statement.sides_within(below, above, slack)
    held = sides != 0
    thin = np.maximum(below, above) <= sharp
    if np.count_nonzero(thin):  # rounding decides which bound is reached
        thin &= ~statement.equality & (multipliers != 0.0)
        sides[thin] = np.where(multipliers[thin] > 0.0, -1, 1)
    wrong = np.where(held, sides * multipliers, size)
    wrong[statement.equality] = 0.0
    if statement.A.size:
        held[n:] &= np.logical_or.reduce(statement.A, axis=1)  # a row of zeros holds nothing
    strong = held & (statement.equality | (size > WEAK * zeros))
    active = working | (np.minimum(below, above) <= sharp)
    right, doubtful = True, False
    if np.count_nonzero(wrong > 0.0):
        tolerated = 2.0 * zeros
        tolerated[n:] = np.maximum(tolerated[n:], 2.0 * progress.zero)
        right = _all(wrong <= tolerated)
        likely = np.where(zeros > progress.zero, DOUBT_OF_ROUGH, DOUBT)
        doubtful = bool(np.count_nonzero(wrong > np.fmin(likely * zeros, SEEN * terms())))
    return FirstOrder(
        holds=feasible and stationary and right,
        strong=strong,
        weak=held & ~strong & active,
        sides=sides,
        size=size,
        doubtful=doubtful,
    )


def _all(hold: BoolArray) -> bool:
    """Whether all conditions hold."""
    return np.count_nonzero(hold) == hold.size


def cleaned_ray(progress: SearchState, ray: Array) -> Array | None:
    """The ray without rounding, if it is a recession direction on which the objective is unbounded; else None."""
    if (progress.values < progress.lowest).any() or (progress.values > progress.highest).any():
        return None
    size = np.abs(ray) / largest(ray)
    for rounding in OF_RAY:  # what is left is judged from the data, whatever was taken away
        d = np.where(size > rounding, ray, 0.0)
        d = _refined_ray(progress.statement, d / np.linalg.norm(d))
        if _stays(progress.statement, d) and _has_no_end(progress, d):
            return d
    return None


def _refined_ray(statement: Statement, d: Array) -> Array:
    """The ray after steps by which it keeps, to the last digit, rows of A and H along which it seems not to move."""
    bounded = np.isfinite(statement.lower) | np.isfinite(statement.upper)
    n, size = d.size, np.abs(d)
    kept = bounded[n:] & (np.abs(statement.A @ d) <= 1e-10 * (statement.absolute[2] @ size))
    flat = np.abs(statement.H @ d) <= 1e-10 * (statement.absolute[0] @ size)
    rows, free = np.vstack([statement.A[kept], statement.H[flat]]), (size > 1e-10) | ~bounded[:n]
    for _ in range(REFINEMENTS if rows.any() else 0):
        d = d.copy()
        d[free] += np.linalg.lstsq(rows[:, free], _exact_rest(rows, d))[0]
    d = np.where(np.abs(d) > EPS, d, 0.0)
    return d / np.linalg.norm(d)


def _exact_rest(matrix: Array, d: Array) -> Array:
    """The product of a matrix and a direction, with the other sign, as of numbers with twice the digits."""
    return fine_remainders(np.zeros(len(matrix)), matrix, d)


def _stays(statement: Statement, d: Array) -> bool:
    """Whether the unit direction leaves no constraint, variables exactly, rows up to the rounding of their entries."""
    along = np.concatenate([d, -_exact_rest(statement.A, d)])
    rounding = max(10, d.size) * EPS * (statement.absolute[2] @ np.abs(d))
    within = np.concatenate([np.zeros(d.size), rounding])
    falls = np.isfinite(statement.lower) & (along < -within)
    rises = np.isfinite(statement.upper) & (along > within)
    return not (falls.any() or rises.any())


def _has_no_end(progress: SearchState, d: Array) -> bool:
    """Whether the objective falls without end on the unit direction."""
    statement = progress.statement
    bent = -_exact_rest(statement.H, d)
    rounding = max(10, d.size) * EPS * (statement.absolute[0] @ np.abs(d))
    bent = np.zeros_like(bent) if (np.abs(bent) <= rounding).all() else bent  # as of a matrix that is a product
    curvature, slope, lost = float(d @ bent), float(progress.gradient @ d), _rounding_of_ray(statement, d)
    zero = max(100.0 * EPS * float(np.abs(d) @ np.abs(bent)), 2.0 * lost * float(np.abs(bent).sum()))
    if largest(bent) > SADDLE * largest(statement.absolute[0] @ np.abs(d)):  # as a semidefinite H never has it
        zero = max(zero, statement.rounding(d))
    no_rows = statement.A[:0]
    terms = progress.terms(d[:0], no_rows)
    level = progress.level(d, progress.fine_zero(terms, no_rows, no_rows.T, 0.0 * d))
    level = max(level, lost * float(np.abs(progress.gradient).sum()))
    return curvature < -zero or (curvature <= zero and slope < -level)


def _rounding_of_ray(statement: Statement, d: Array) -> float:
    """Rounding of a unit direction that keeps the constraints along which it does not move, where this is large."""
    bounded = np.isfinite(statement.lower) | np.isfinite(statement.upper)
    n, along = d.size, statement.values(d)
    free = ((d != 0.0) | ~bounded[:n]).nonzero()[0]
    kept = bounded[n:] & (np.abs(along[n:]) <= 1e-10 * (statement.absolute[2] @ np.abs(d)))
    lost = null_space(unit_rows(statement.A[kept][:, free])[0], free.size)[1]
    return lost if lost > IN_CONE else 0.0
