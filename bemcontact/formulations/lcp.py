"""Linear complementarity problems of any kind, in numbers of natural sizes."""

import numpy as np
import scipy
from numpy.typing import ArrayLike

from bemcontact.arrays import Array, real_array
from bemcontact.contact.solution import Status
from bemcontact.errors import ProblemError
from bemcontact.formulations.complementarity import find_state
from bemcontact.formulations.lemke import basic_solution, equilibrating, holds, holds_row_by_row, lemke
from bemcontact.formulations.scaling import ScaledContact
from bemcontact.frozen import frozen
from bemcontact.threads import one_thread

FAINT = 0.0, 1e-15, 1e-14, 1e-13, 1e-12
"""Parts of the largest variable that are taken for rounding, in turn, until each row holds beside its own terms."""
OF_RIGHT, UNDECIDED = 1e-6, 1e-10
"""Weights of the numbers of q, and of a factor of one, in the choice of natural factors; the numbers of M have one."""


@frozen
class LcpResult:
    """Result of `solve_lcp`; z and w are a solution only with `bemcontact.Status.SOLVED`.

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


@one_thread
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
    search = find_state(contact, None)
    z, status = search.end.pressure * T, search.status
    if status is not Status.INFEASIBLE and not holds(even, right, z):
        path = lemke(even, right)
        z, status = np.maximum(basic_solution(even, right, path.active), 0.0), path.status
    if status is Status.SOLVED:
        points = (np.where(z > part * z.max(initial=0.0), z, 0.0) for part in FAINT)
        held = [point for point in points if holds_row_by_row(even, right, point)]
        z, status = (held[0], status) if held else (z, Status.NO_SOLUTION_FOUND)
    with np.errstate(over="ignore", invalid="ignore"):
        z = factors * z
        w = q + M @ z
    if not (np.isfinite(z).all() and np.isfinite(w).all()):
        raise ProblemError("the solution has numbers that are too large to compute with; scale M or q")
    return LcpResult(z=z, w=w, status=status, iterations=search.iterations, method=search.method)


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
