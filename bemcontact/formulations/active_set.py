"""Primal-dual active set for the contact problem, and the equations of contact on given points.

The method guesses which points touch, solves linear equations, and corrects the guess. It is Newton's method on
min(p, δ) = 0 (Hintermüller, Ito and Kunisch, SIAM J. Optim. 13(3), 2002, 865-888). It is exact when it stops, after a
handful of steps on contact problems, but it may cycle.
"""

import numpy as np
import scipy

from bemcontact.arrays import Array, BoolArray, IntArray, exact_remainders, powers_of_two
from bemcontact.cached import cached_property
from bemcontact.contact.load_cases import Change
from bemcontact.contact.lu import LU
from bemcontact.errors import SingularSystemError
from bemcontact.formulations.scaling import ScaledContact
from bemcontact.frozen import frozen

EPS = float(np.finfo(float).eps)
ESTIMATED = 100.0
"""Factor by which the estimate of a condition may be too small."""
STEP_LIMIT = 100
"""Steps allowed beyond one for each point: on slender bodies contact recedes by a point or two in a step."""
LEAST_SQUARES = 2
"""Least-squares solutions, each of what the ones before it leave."""
SETTLED = 1e-14
"""Residual of `ScaledContact.residual` that no further step can lower."""


@frozen
class ContactBlock:
    """The equations of contact: δ = 0 on points A, p = 0 elsewhere, ℓᵀp = -load; factorized once.

    The matrix is [[M, R], [ℓᵀ, 0]] on A and all motions, unsymmetric and indefinite. The `points` A are ascending
    indices.
    """

    scaled: ScaledContact
    points: IntArray

    @property
    def touching(self) -> BoolArray:
        """True on A, (n,)."""
        mask = np.zeros(len(self.scaled.offset), bool)
        mask[self.points] = True
        return mask

    @cached_property
    def matrix(self) -> Array:
        """The matrix, with |A| + k rows and columns."""
        return self.scaled.matrix.take(self.unknowns, axis=0).take(self.unknowns, axis=1)

    @cached_property
    def unknowns(self) -> IntArray:
        """Pressures on A and all amplitudes, as numbers (|A| + k,) of rows and columns of `ScaledContact.matrix`."""
        n, k = self.scaled.rigid_motions.shape
        return np.concatenate([self.points, np.arange(n, n + k)])

    @cached_property
    def _columns(self) -> Array:
        """M on A (n, |A|): gaps per pressure."""
        return self.scaled.compliance[:, self.points]

    @cached_property
    def _lu(self) -> LU:
        """The factors of the matrix; `SingularSystemError` if it is singular to working precision."""
        lu, m = LU.of(self.matrix), len(self.matrix)
        # Columns of similar size have a condition that is 2 m times as large at most.
        doubtful = lu.reciprocal_condition < ESTIMATED * 2 * m * m * EPS
        if doubtful and self._equilibrated().reciprocal_condition < m * EPS:
            raise SingularSystemError(
                "the points in contact do not determine their pressures and the position of the body: the equations of "
                "contact are singular"
            )
        return lu

    def _equilibrated(self) -> LU:
        """The factors with columns over powers of two near their sizes: small weights make no matrix singular.

        Division by these changes no digit of the factors, and no pivot.
        """
        return LU.of(self.matrix / powers_of_two(np.abs(self.matrix).max(axis=0)))

    @property
    def regular(self) -> bool:
        """Whether the points determine their pressures and the position of the body."""
        try:
            return not self._lu.singular
        except SingularSystemError:
            return False

    def inverse(self, right: Array) -> Array:
        """Solve for right sides (|A| + k,) or (|A| + k, m), with one step of iterative refinement."""
        if not right.size:
            return right
        return self._lu.solve(right, lambda x: right - self.matrix @ x)

    def solve(self, *given: Change) -> tuple[Array, Array, Array]:
        """Solve for m offsets with their loads: p (m, n), zero off A, of either sign; δ (m, n), zero on A; a (m, k)."""
        A = self.points
        offset = np.array([change.offset for change in given])
        load = np.array([change.motion_load for change in given])
        x = self.inverse(-np.hstack([offset[:, A], load]).T).T
        pressure, amplitudes = np.zeros_like(offset), x[:, len(A) :]
        pressure[:, A] = x[:, : len(A)]
        gap = offset + pressure[:, A] @ self._columns.T + amplitudes @ self.scaled.rigid_motions.T
        gap[:, A] = 0.0
        return pressure, gap, amplitudes


@frozen
class ActiveSetEnd:
    """The best point: p >= 0 (n,), a (k,), its set (n,), and the relative residual after each step."""

    pressure: Array
    amplitudes: Array
    active: BoolArray
    residuals: tuple[float, ...]

    @property
    def residual(self) -> float:
        """Residual of the best point."""
        return min(self.residuals)

    @property
    def steps(self) -> int:
        """Number of steps."""
        return len(self.residuals)


def first_active_set(scaled: ScaledContact) -> BoolArray:
    """Points (n,) that penetrate without pressure, {q < 0}; of a free body once its gaps have no part along a motion.

    For a free body q is replaced by P q, P = I - R(ℓᵀR)⁻¹ℓᵀ: the body lies as close as can be in the least squares of
    the weights.
    """
    R = scaled.rigid_motions
    if not R.shape[1]:
        return scaled.offset < 0
    return scaled.offset <= R @ scaled.amplitudes_of(scaled.offset)


def resting_points(scaled: ScaledContact) -> BoolArray:
    """Points (n,) on which the body would come to rest if it were rigid: where its loads have done the most work.

    There are as many as it has free motions, or fewer; none where no pressure carries its load. A round body with free
    motions may have equal gaps all around, so that only its load says where it touches.
    """
    R = scaled.rigid_motions
    if not R.shape[1]:
        return np.zeros(len(R), bool)
    work = scipy.optimize.linprog(-scaled.motion_load, A_ub=-R, b_ub=scaled.offset, bounds=(None, None))
    return work.ineqlin.marginals < 0 if work.success else np.zeros(len(R), bool)


def primal_dual(scaled: ScaledContact, active: BoolArray, limit: int | None = None) -> ActiveSetEnd:
    """Iterate from an active set (n,) until nothing changes, a set comes back, or the limit of steps is reached.

    Each step solves `solve_active_set`, then releases the points in tension and adds the points that penetrate. Only
    the residual of the best point says whether it is a solution.
    """
    points: list[tuple[Array, Array, BoolArray]] = []
    residuals: list[float] = []
    visited: set[bytes] = set()
    limit = STEP_LIMIT + len(active) if limit is None else limit
    while len(points) < limit and active.tobytes() not in visited:
        visited.add(active.tobytes())
        p, a = solve_active_set(scaled, active)
        points.append((np.maximum(p, 0.0), a, active))
        residuals.append(scaled.residual(*points[-1][:2]))
        if residuals[-1] <= SETTLED:
            break
        active = np.where(active, p > 0, scaled.gap(p, a) < 0)
    pressure, amplitudes, best = points[residuals.index(min(residuals))]
    return ActiveSetEnd(pressure=pressure, amplitudes=amplitudes, active=best, residuals=tuple(residuals))


def solve_active_set(scaled: ScaledContact, active: BoolArray) -> tuple[Array, Array]:
    """Solve δ = 0 on the active set (n,), p = 0 off it, and ℓᵀp = -load for p (n,), of either sign, and a (k,).

    The amplitudes are the shortest least-squares solution if the set holds the body too little or too often. It is
    refined: a light load must not drown in the rounding of gaps.
    """
    block = ContactBlock(scaled=scaled, points=active.nonzero()[0])
    right = -scaled.constant[block.unknowns]
    try:
        unknowns = block.inverse(right)
    except SingularSystemError:
        unknowns = np.zeros_like(right)
        for _ in range(LEAST_SQUARES):
            unknowns += np.linalg.lstsq(block.matrix, exact_remainders(right, block.matrix, unknowns))[0]
    pressure = np.zeros(len(active))
    pressure[block.points] = unknowns[: len(block.points)]
    return pressure, unknowns[len(block.points) :]
