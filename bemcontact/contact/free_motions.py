"""Algebra of the free rigid motions: scales, equilibrium ℓᵀp = -load with ℓ = J R, the gauge, the stiffness rows."""

from typing import NamedTuple

import numpy as np
import scipy

from bemcontact.arrays import Array, BoolArray, least_squares, nonnegative_residual, real_array, short_svd
from bemcontact.cached import cached_property
from bemcontact.errors import ProblemError, SingularSystemError
from bemcontact.frozen import frozen

INTERFERENCE = 1e-6
"""Fraction of the largest gap from which there is interference: the accuracy of a linear program."""
ROUND_OFF = 1e-12
"""Fraction of the terms of a gap from which there is interference of a body that is held: less has just closed."""

COORDINATES = 4 * float(np.finfo(float).eps)
"""Round-off of a gap over the largest coordinate of a contact point."""
COMPUTABLE = 1e-75, 1e75
"""Sizes of compliance, displacement and pressure of which products and squares are neither zero nor infinite."""
UNSEEN = 1e-9
"""Lever over the extent of contact up to which points see no turn."""
TURNS = "rotation "
"""First word of a free rotation; one about a far center is a translation with a small turn."""


class ContactScales(NamedTuple):
    """Typical displacement U [L] and pressure T [p] of a contact problem, by which residuals are divided."""

    displacement: float
    pressure: float


def typical_scales(
    compliance: Array, offset: Array, terms: Array, rigid_motions: Array, balancing_pressure: Array
) -> ContactScales:
    """Scales with U = ‖M‖∞ T: the larger of those of the load and of the interference.

    From M (n, n) [L/p], the gap without contact q (n,) [L], the magnitudes (n,) [L] of all that is added up in it, R
    (n, k) and the balancing pressure (n,) [p] of the load. `ProblemError` if their products could not be computed.
    """
    norm = float(np.abs(compliance).sum(axis=1).max(initial=0.0))
    _ensure_computable("the compliance", norm)
    pressure = float(np.abs(balancing_pressure).max(initial=0.0))
    displacement = _larger(norm * pressure, offset, terms, rigid_motions)
    displacement = displacement or float(np.maximum(terms, np.abs(offset)).max(initial=0.0)) or 1.0
    scales = ContactScales(displacement, displacement / norm if norm > 0 else pressure or 1.0)
    _ensure_computable("the displacement", scales.displacement)
    _ensure_computable("the pressure", scales.pressure)
    return scales


def _ensure_computable(what: str, size: float) -> None:
    """Refuse a typical number whose square or cube is zero or infinite."""
    if size != 0.0 and not COMPUTABLE[0] <= size <= COMPUTABLE[1]:
        much = "large" if size > 1.0 else "small"
        raise ProblemError(
            f"{what} of this contact problem is about {size:.3g}, which is too {much} to compute with; choose other "
            "units of length and force"
        )


def _larger(displacement: float, offset: Array, terms: Array, rigid_motions: Array) -> float:
    """The larger of a displacement [L] and the interference, without a program where a motion shows which it is."""
    if -offset.min(initial=0.0) <= displacement:  # without any motion
        return displacement
    if rigid_motions.shape[1] > 1 and displacement > 0:
        fitted = offset - rigid_motions @ least_squares(rigid_motions, offset)
        if -fitted.min(initial=0.0) <= displacement:
            return displacement
    return max(displacement, _interference(offset, terms, rigid_motions))


def _interference(offset: Array, terms: Array, rigid_motions: Array) -> float:
    """Least s >= 0 [L] with q + R a >= -s for some a, by a linear program; zero where it is round-off.

    Along one motion it is decided by one point, or by two that the motion opens and closes. Nothing is gained by moving
    where the rows of R of the points with the least gap balance each other.
    """
    n, k = rigid_motions.shape
    q = np.where(np.abs(offset) > ROUND_OFF * terms, offset, 0.0)
    widest = float(np.abs(q).max(initial=0.0))
    if k == 0 or not (q < 0).any():
        return -float(q.min(initial=0.0))
    if k == 1:
        (opens, closes), r = ((rigid_motions[:, 0] * side > 0 for side in (1, -1)), np.abs(rigid_motions[:, 0]))
        both = np.add.outer(q[opens] / r[opens], q[closes] / r[closes])
        least = min((both / np.add.outer(1 / r[opens], 1 / r[closes])).min(initial=0.0), q[r == 0].min(initial=0.0))
        return -float(least) if -least > INTERFERENCE * widest else 0.0
    columns = np.column_stack([rigid_motions, np.ones(n)])
    worst = q <= (1.0 - ROUND_OFF) * q.min()
    if not (np.abs(nonnegative_residual(columns[worst].T, np.eye(k + 1)[k])) > ROUND_OFF).any():
        return -float(q.min())
    cost, bounds = np.append(np.zeros(k), 1.0), [(None, None)] * k + [(0, None)]
    optimum = scipy.optimize.linprog(cost, A_ub=-columns, b_ub=q / widest, bounds=bounds)
    return widest * optimum.fun if optimum.success and optimum.fun > INTERFERENCE else 0.0


def turns_a_body(motion: str) -> bool:
    """Whether a free motion, by its name, is the rotation of a body."""
    return motion.startswith(TURNS) and " of the tool " not in motion


def angle_of_round_off(points: Array, normals: Array, pressed: BoolArray) -> float:
    """Angle [rad] of a body or tool that is round-off of the gaps at pressed points; 0 where these see no turn.

    From points (n, 2) [L] and normals (n, 2). A turn changes gaps by the angle times the levers of the normals. What
    translations change as well does not count; a gap has the round-off of the coordinates.
    """
    at, n = points[pressed] - points[pressed].mean(axis=0), normals[pressed]
    levers = at[:, 0] * n[:, 1] - at[:, 1] * n[:, 0]
    lever = float(np.abs(levers - n @ least_squares(n, levers)).max())
    return COORDINATES * float(np.abs(points).max()) / lever if lever > UNSEEN * float(np.abs(at).max()) else 0.0


def unseen_ways(changes: Array, part: float) -> Array:
    """Orthonormal combinations (k, j) of motions that change nothing, from what each changes (n, k).

    Singular values up to a part of the largest one are zeros.
    """
    values, vectors = short_svd(changes)
    return vectors[values <= part * values[:1]].T


@frozen
class MotionAlgebra:
    """Free rigid motions of n contact points, with the equilibrium ℓᵀp = -load.

    With P = I - R (ℓᵀR)⁻¹ ℓᵀ and the balancing pressure p0 every p in equilibrium is P p + p0.

    Parameters
    ----------
    rigid_motions : (n, k) R, of full column rank
    weights : (n,) tributary J
    motion_load : (k,) load, or (k, s) for s loadings
    """

    rigid_motions: Array
    weights: Array
    motion_load: Array

    @cached_property
    def equilibrium(self) -> Array:
        """ℓ = J R (n, k) with the tributary weights: equilibrium is ℓᵀp = -load."""
        return self.weights[:, None] * self.rigid_motions

    @property
    def equilibrium_space(self) -> Array:
        """Z (n, n - k), an orthonormal basis of {p : ℓᵀp = 0}."""
        return np.linalg.qr(self.equilibrium, mode="complete")[0][:, self.rigid_motions.shape[1] :]

    @property
    def projector(self) -> Array:
        """P = I - R (ℓᵀR)⁻¹ ℓᵀ (n, n)."""
        return np.eye(len(self.weights)) - self.rigid_motions @ self.nearest

    @cached_property
    def nearest(self) -> Array:
        """(ℓᵀR)⁻¹ ℓᵀ (k, n), which gives the amplitudes of `amplitudes_of`."""
        return self._inverse @ self.equilibrium.T

    def amplitudes_of(self, displacement: Array) -> Array:
        """(ℓᵀR)⁻¹ ℓᵀu (k,): the a with which R a is nearest to u (n,) in the least squares of the weights."""
        return self._inverse @ (self.equilibrium.T @ _rows(displacement, "displacement", len(self.weights)))

    def balancing(self, load: Array) -> Array:
        """p0 = -R (ℓᵀR)⁻¹ load (n,): the pressure of least weighted square with ℓᵀp = -load, of either sign."""
        return -self.rigid_motions @ (self._inverse @ _rows(load, "load", self.rigid_motions.shape[1]))

    @cached_property
    def _inverse(self) -> Array:
        """(ℓᵀR)⁻¹ (k, k); `SingularSystemError` if the motions are singular to working precision."""
        moments = self.equilibrium.T @ self.rigid_motions
        if moments.size == 1 and moments[0, 0] != 0.0:
            return 1 / moments
        try:
            return np.asarray(np.linalg.inv(moments), float)
        except np.linalg.LinAlgError:
            raise SingularSystemError(
                "the free motions are not independent of each other to working precision; give rigid_motions columns "
                "of similar size that differ"
            ) from None

    @cached_property
    def balancing_pressure(self) -> Array:
        """p0 (n,) of the load itself."""
        return self.balancing(self.motion_load)

    def imbalance(self, pressure: Array) -> Array:
        """ℓᵀp + load (k,), which is zero in equilibrium."""
        return self.equilibrium.T @ _rows(pressure, "pressure", len(self.weights)) + self.motion_load


def _rows(values: Array, what: str, count: int) -> Array:
    """Read an array of so many rows, which a solver that failed may have left infinite."""
    array = real_array(values, what, finite=False)
    if array.shape[:1] != (count,):
        raise ProblemError(f"{what} has shape {array.shape} where {count} rows are needed")
    return array


class Gauge(NamedTuple):
    """Compliance and free displacement in the fixed gauge, and the shift (k,), (k, n) of the amplitudes.

    For s loadings at once, the free displacement is (n, s), and the shift by the load (k, s).

    u_n = Δ1 + M p + R a holds before and after for every p in equilibrium, with
    ``a_before = a_after - shift_load - shift_pressure @ p``.
    """

    compliance: Array
    free_displacement: Array
    shift_load: Array
    shift_pressure: Array


def fix_gauge(motions: MotionAlgebra, compliance: Array, free_displacement: Array) -> Gauge:
    """Remove from M (n, n) [L/p] and Δ1 (n,) or (n, s) [L] what depends on how free motions were held while solving.

    With P and p0 of `MotionAlgebra`: M' = P M P and Δ1' = P (Δ1 + M p0).
    """
    M, R, inverse, ell = compliance, motions.rigid_motions, motions._inverse, motions.equilibrium.T
    n, k = R.shape
    shift, moved = inverse @ (ell @ M), free_displacement + M @ motions.balancing_pressure
    reduced = M - R @ shift
    return Gauge(
        compliance=reduced - (reduced @ R) @ motions.nearest if n > k else np.zeros((n, n)),
        free_displacement=moved - R @ (inverse @ (ell @ moved)) if n > k else np.zeros_like(moved),
        shift_load=inverse @ (ell @ free_displacement),
        shift_pressure=shift,
    )


class StiffnessRows(NamedTuple):
    """K u_n = B p + r, [SS92] (12), as contact stiffness rows: K (n, n) [p/L], B (n, n) [1], r (n,) [p]."""

    K: Array
    B: Array
    r: Array


def stiffness_rows(
    motions: MotionAlgebra, compliance: Array, free_displacement: Array, scales: ContactScales
) -> StiffnessRows:
    """K u_n = B p + r, (12), with K = S, B = I, r = S Δ1 + V load; [S, V] the top of [[M, R], [ℓᵀ, 0]]⁻¹.

    From M (n, n) [L/p] and Δ1 (n,) [L]; `SingularSystemError` if the matrix has no inverse.
    """
    R, ell = motions.rigid_motions, motions.equilibrium
    n, k = R.shape
    U, T = scales
    row_scale = np.abs(ell).max(axis=0, initial=0.0)
    bordered = np.zeros((n + k, n + k))
    bordered[:n, :n], bordered[:n, n:], bordered[n:, :n] = compliance * (T / U), R, (ell / row_scale).T
    try:
        inverse = np.linalg.inv(bordered.T).T.astype(float)  # accurate as a left inverse, which is how K is used
    except np.linalg.LinAlgError:
        raise SingularSystemError(
            "the compliance is singular: some change of pressure moves no contact point, so that pressures are "
            "not unique; give each contact point a compliance of its own"
        ) from None
    S, V = inverse[:n, :n] * (T / U), inverse[:n, n:] / row_scale
    return StiffnessRows(S, np.eye(n), S @ free_displacement + V @ motions.motion_load)
