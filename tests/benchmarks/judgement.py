"""Judge a point that a solver returned for a quadratic program, from the point alone.

For a quadratic program the second-order conditions are exact: a first-order point is a local minimizer if and only if
dᵀH d >= 0 on its critical cone {d feasible, (H x + c)·d = 0}. If dᵀH d < 0 there, then also at an eigenvector of H
projected on the span of one of the faces of the cone, inside that face; so a search of the faces decides it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from itertools import combinations, islice

import numpy as np
from numpy.typing import NDArray
from qp_instance import Instance
from scipy.linalg import null_space
from scipy.optimize import linprog, nnls

Array = NDArray[np.float64]

FEASIBLE = 1e-6
"""Violation, over the larger of 1, the bound and the entries of the row."""
STATIONARY = 1e-6
"""Part of the gradient that no multiplier of right sign explains, and multiplier times distance from its constraint,
over the larger of 1, |c| and |H x|."""
NEAR = 1e-4
"""Distance from a constraint, as a violation is measured, within which it may have a multiplier."""
FLAT = 1e-7
"""Curvature below which it counts as none, and multiplier below which it counts as zero, over max|H| and as above."""
GLOBAL = 1e-5
"""Excess over the best known objective, over the larger of 1 and itself."""
FACES = 2000
"""Faces of the critical cone that are searched before the verdict is left open."""


class Verdict(Enum):
    """What a point is."""

    NO_POINT = "no point"
    INFEASIBLE = "infeasible"
    NOT_STATIONARY = "not stationary"
    SADDLE = "descent along a curve of second order"
    OPEN = "second order not decided"
    MINIMISER = "local minimizer"


FIRST_ORDER = (Verdict.SADDLE, Verdict.OPEN, Verdict.MINIMISER)
SECOND_ORDER = (Verdict.OPEN, Verdict.MINIMISER)


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """Measures of a point.

    Parameters
    ----------
    verdict : Verdict
    violation : largest violation of a constraint, scaled as `FEASIBLE` says
    stationarity : scaled as `STATIONARY` says, or nan
    excess : objective less the best known, scaled as `GLOBAL` says, or nan
    error : largest error of a block of x over the largest entry of that block of the truth, or nan
    """

    verdict: Verdict
    violation: float = np.inf
    stationarity: float = np.nan
    excess: float = np.nan
    error: float = np.nan

    @property
    def is_global(self) -> bool:
        """Whether it is a first-order point as low as the best known."""
        return self.verdict in FIRST_ORDER and self.excess <= GLOBAL


def judge(instance: Instance, x: Array | None) -> Judgement:
    """Recompute feasibility, multipliers and curvature at x (n,), or None if the solver returned nothing.

    Done on the dimensionless program where the size of the unknowns is known: pressures of 1e5 beside displacements of
    1e-1 would else make every multiplier of the one negligible beside those of the other.
    """
    if x is None or x.shape != instance.c.shape or not np.isfinite(x).all():
        return Judgement(verdict=Verdict.NO_POINT)
    scaled, y = instance.dimensionless, x / instance.sizes
    violation, stationarity = scaled_violation(scaled, y), np.nan
    verdict = Verdict.INFEASIBLE
    if violation <= FEASIBLE:
        verdict, stationarity = _order(scaled, y)
    excess = (scaled.objective(y) - scaled.best) / max(1.0, abs(scaled.best))
    return Judgement(
        verdict=verdict, violation=violation, stationarity=stationarity, excess=excess,
        error=block_error(instance, x),
    )  # fmt: skip


def block_error(instance: Instance, x: Array) -> float:
    """Worst relative error of a block of x against the only right x, nan if none is known."""
    if not instance.truth:
        return np.nan
    blocks = np.split(x, np.cumsum([len(block) for block in instance.truth])[:-1])
    pairs = zip(blocks, instance.truth, strict=True)
    return max(float(np.abs(block - true).max() / np.abs(true).max()) for block, true in pairs)


def scaled_violation(instance: Instance, x: Array) -> float:
    """Largest violation of a bound or row at x."""
    values, lower, upper, _, size = _constraints(instance, x)
    below = np.where(np.isfinite(lower), lower - values, 0) / _reference(lower, size)
    above = np.where(np.isfinite(upper), values - upper, 0) / _reference(upper, size)
    return float(max(0.0, below.max(initial=0.0), above.max(initial=0.0)))


def active_normals(instance: Instance, x: Array) -> tuple[Array, Array, Array]:
    """Unit normals of the equalities E and of the inequalities N near x, with N d >= 0 feasible, and distances of N."""
    values, lower, upper, normals, size = _constraints(instance, x)
    length = np.linalg.norm(normals, axis=1)
    seen = length > 0
    normals = normals / np.where(seen, length, 1)[:, None]
    off_lower = np.where(np.isfinite(lower), values - lower, np.inf) / _reference(lower, size)
    off_upper = np.where(np.isfinite(upper), upper - values, np.inf) / _reference(upper, size)
    near_lower, near_upper = (seen & (lower < upper) & (off <= NEAR) for off in (off_lower, off_upper))
    near = np.vstack([normals[near_lower], -normals[near_upper]])
    return normals[seen & (lower == upper)], near, np.append(off_lower[near_lower], off_upper[near_upper])


def least_multipliers(gradient: Array, E: Array, N: Array) -> tuple[Array, float]:
    """Multipliers z >= 0 that explain most of gradient = Eᵀy + Nᵀz, and the largest entry of what is left."""
    Z = kernel(E, gradient.size)
    size = np.linalg.norm(Z.T @ gradient)
    if size == 0 or len(N) == 0:
        return np.zeros(len(N)), float(np.abs(Z @ (Z.T @ gradient)).max(initial=0.0))
    along = Z.T @ gradient / size
    z = nnls(Z.T @ N.T, along, maxiter=100 * max(N.shape))[0]
    return size * z, float(size * np.abs(Z @ (along - Z.T @ N.T @ z)).max())


def descends(H: Array, held: Array, weak: Array) -> bool | None:
    """Whether dᵀH d < 0 for some d with held d = 0, weak d >= 0; None if there were too many faces to tell."""
    size = max(np.abs(H).max(initial=0.0), np.finfo(float).tiny)
    n = len(H)
    if _lowest(H / size, kernel(held, n)) >= -FLAT:
        return False
    if _descent_by_closing(H / size, held, weak):
        return True
    for kept in islice(_faces(len(weak)), FACES):
        Z = kernel(np.vstack([held, weak[kept]]), n)
        if _bends_inside(H / size, Z, weak):
            return True
    return False if 2 ** len(weak) <= FACES else None


def kernel(rows: Array, n: int) -> Array:
    """Orthonormal basis (n, k) of {d : rows d = 0}."""
    return null_space(rows, rcond=1e-10) if len(rows) else np.eye(n)


def _order(instance: Instance, x: Array) -> tuple[Verdict, float]:
    """Verdict on a feasible point, and its scaled stationarity."""
    E, N, distance = active_normals(instance, x)
    size = max(1.0, np.abs(instance.c).max(initial=0.0), np.abs(instance.H @ x).max(initial=0.0))
    z, left = least_multipliers(instance.gradient(x), E, N)
    left = max(left, float(np.abs(z * distance).max(initial=0.0)))
    if left > STATIONARY * size:
        return Verdict.NOT_STATIONARY, left / size
    strong = z > FLAT * size
    weak = ~strong & (distance <= FEASIBLE)
    answer = descends(instance.H, np.vstack([E, N[strong]]), N[weak])
    return {True: Verdict.SADDLE, False: Verdict.MINIMISER, None: Verdict.OPEN}[answer], left / size


def _constraints(instance: Instance, x: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Values, lower, upper, normals and sizes of bounds and rows, one below the other."""
    lower, upper = np.append(instance.bl, instance.cl), np.append(instance.bu, instance.cu)
    normals = np.vstack([np.eye(x.size), instance.A])
    return normals @ x, lower, upper, normals, np.maximum(1.0, np.abs(normals).max(axis=1))


def _reference(bound: Array, size: Array) -> Array:
    return np.maximum(size, np.where(np.isfinite(bound), np.abs(bound), 0))


def _lowest(H: Array, Z: Array) -> float:
    return float(np.linalg.eigvalsh(Z.T @ H @ Z)[0]) if Z.shape[1] else 0.0


def _faces(k: int) -> Iterator[list[int]]:
    """The k weak constraints that a face keeps as equations: first all of them, then all but one, all but two, ..."""
    for freed in range(k + 1):
        for free in combinations(range(k), freed):
            yield sorted(set(range(k)) - set(free))


def _descent_by_closing(H: Array, held: Array, weak: Array) -> bool:
    """Whether a direction of negative curvature gets inside the cone by closing what it violates most, one by one."""
    n = len(H)
    starts = np.linalg.eigh(H)[1].T
    for start in np.vstack([starts, -starts]):
        kept, d = held, start
        for _ in range(len(weak) + 1):
            Z = kernel(kept, n)
            d = _lowest_towards(Z.T @ H @ Z, Z.T @ d) @ Z.T
            slopes = weak @ d
            if d @ H @ d >= -FLAT * (d @ d):
                break
            if slopes.min(initial=0.0) >= -1e-9 * np.linalg.norm(d):
                return True
            kept = np.vstack([kept, weak[slopes.argmin()]])
    return False


def _lowest_towards(H: Array, d: Array) -> Array:
    """The direction d after a few steps of the power method on the part of H that bends down, (k,)."""
    size = np.abs(H).sum(axis=1).max(initial=0.0)
    for _ in range(20):
        length = np.linalg.norm(d)
        if length == 0 or size == 0:
            break
        d = d / length - H @ d / (length * size)
    return d


def _bends_inside(H: Array, Z: Array, weak: Array) -> bool:
    """Whether an eigenspace of negative curvature in the span of Z meets {weak d >= 0} in more than the origin."""
    if Z.shape[1] == 0:
        return False
    values, vectors = np.linalg.eigh(Z.T @ H @ Z)
    if values[0] >= -FLAT:
        return False
    ends = np.flatnonzero(np.append(np.diff(values) > FLAT, True)) + 1
    spaces = np.split(Z @ vectors, ends[:-1], axis=1)
    lowest = values[np.append(0, ends[:-1])]
    return any(_meets(weak @ space) for space, value in zip(spaces, lowest, strict=True) if value < -FLAT)


def _meets(rows: Array) -> bool:
    """Whether rows a >= 0 for some a other than null."""
    if len(rows) == 0 or np.linalg.matrix_rank(rows, tol=1e-9) < rows.shape[1]:
        return True
    rows = np.where(np.abs(rows) < 1e-9, 0, rows)
    if rows.shape[1] == 1:
        return bool((rows >= 0).all() or (rows <= 0).all())
    found = linprog(-rows.sum(axis=0), A_ub=-rows, b_ub=np.zeros(len(rows)), bounds=(-1, 1))
    return bool(found.success and -found.fun > 1e-9)
