"""The equations of contact on some points, factorised once: δ = 0 there, p = 0 elsewhere, ℓᵀp = -load."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import get_lapack_funcs

from bemcontact.arrays import Array, IntArray
from bemcontact.contact.load_cases import Change
from bemcontact.errors import SingularSystemError
from bemcontact.formulations.active_set import BoolArray
from bemcontact.formulations.scaling import ScaledContact

EPS = float(np.finfo(float).eps)


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactBlock:
    """[[M, R], [ℓᵀ, 0]] on the points A and all motions; the matrix is unsymmetric and indefinite.

    Parameters
    ----------
    problem : ScaledContact
    points : A, indices of points, ascending
    """

    problem: ScaledContact
    points: IntArray

    @property
    def touching(self) -> BoolArray:
        """(n,) True on A."""
        mask = np.zeros(len(self.problem.offset), bool)
        mask[self.points] = True
        return mask

    @cached_property
    def matrix(self) -> Array:
        """The block itself, with |A| + k rows and columns."""
        A, k = self.points, self.problem.rigid_motions.shape[1]
        M, R, ell = self.problem.compliance[np.ix_(A, A)], self.problem.rigid_motions[A], self.problem.equilibrium[A]
        return np.block([[M, R], [ell.T, np.zeros((k, k))]])

    @cached_property
    def _columns(self) -> Array:
        """M on A (n, |A|): gaps per pressure."""
        return self.problem.compliance[:, self.points]

    @cached_property
    def _factors(self) -> tuple[Array, IntArray]:
        """LU with pivots; `SingularSystemError` where there is none to working precision."""
        factorise, condition = get_lapack_funcs(("getrf", "gecon"), (self.matrix,))
        lu, pivots, singular = factorise(self.matrix)
        if singular or condition(lu, np.abs(self.matrix).sum(axis=0).max())[0] < len(lu) * EPS:
            raise SingularSystemError(
                "the points in contact do not determine their pressures and the position of the body: the equations of "
                "contact are singular"
            )
        return lu, pivots

    def inverse(self, right: Array) -> Array:
        """Solve for the right sides (|A| + k, m), with one step of iterative refinement."""
        if not right.size:
            return right
        lu, pivots = self._factors
        (substitute,) = get_lapack_funcs(("getrs",), (lu,))
        x = substitute(lu, pivots, right)[0]
        return x + substitute(lu, pivots, right - self.matrix @ x)[0]

    def solve(self, *given: Change) -> tuple[Array, Array, Array]:
        """Solve the equations of contact for several offsets and loads.

        Parameters
        ----------
        given : m offsets with their loads, free of units

        Returns
        -------
        pressure : (m, n), zero off A, of either sign
        gap : (m, n), zero on A
        amplitudes : (m, k)
        """
        problem, A = self.problem, self.points
        offset = np.array([change.offset for change in given])
        load = np.array([change.motion_load for change in given])
        x = self.inverse(-np.hstack([offset[:, A], load]).T).T
        pressure, amplitudes = np.zeros_like(offset), x[:, len(A) :]
        pressure[:, A] = x[:, : len(A)]
        gap = offset + pressure[:, A] @ self._columns.T + amplitudes @ problem.rigid_motions.T
        gap[:, A] = 0.0
        return pressure, gap, amplitudes
