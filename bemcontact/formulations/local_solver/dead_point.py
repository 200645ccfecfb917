"""Second order at a first-order point: whether xᵀHx >= 0 on the critical cone.

A first-order point of a quadratic programme is a local minimiser exactly if H is copositive on its critical cone
{d : E d = 0, W d >= 0}, E the equalities and the constraints with a nonzero multiplier, W the other active ones
(Majthay, Math. Programming 1 (1971) 359-365; Contesse, Numer. Math. 34 (1980) 331-332). Deciding this is co-NP-hard in
general (Murty and Kabadi 1987), so the search is bounded and may end undecided.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.factorisations import is_definite, orthogonal, unit_rows, unit_sizes
from bemcontact.formulations.local_solver.working_set import DEPENDENT

ZERO = 1e-11
"""A curvature below this counts as none, in units in which the rows of |H| have size one."""
FEW = 100
PROBES = 8
DESCENTS = 30


@dataclass(frozen=True, kw_only=True)
class CriticalCone:
    """{d : d_i = 0 outside `free`, E d = 0, W d >= 0}.

    Parameters
    ----------
    free : (f,) int array
        Variables that no bound with a multiplier fixes.
    equal : (e, f) array
        E, full rank not required.
    weak : (w, f) array
        W, signed so that feasible means >= 0.
    """

    free: NDArray[np.intp]
    equal: Array
    weak: Array


@dataclass(frozen=True, kw_only=True)
class Curvature:
    """What the search found.

    Parameters
    ----------
    copositive : bool or None
        Whether H is copositive on the cone; None if the bound of the search came first.
    direction : (n,) array or None
        A direction of the cone with negative curvature, of length one.
    """

    copositive: bool | None
    direction: Array | None = None


def examine(H: Array, cone: CriticalCone, *, faces: int) -> Curvature:
    """Decide copositivity of H on the cone, within `faces` faces.

    First by a Cholesky factorisation on the null space of E; then by faces, as a lowest direction of the cone lies
    inside one face and is an eigenvector there. If there are many of them, descents from the negative eigenvectors,
    projected onto the cone, come before the rest.
    """
    form = H[cone.free][:, cone.free]
    units = unit_sizes(np.abs(form))
    N = null_space(unit_rows(cone.equal * units)[0], cone.free.size)
    reduced = N.T @ (units[:, None] * form * units) @ N
    if _positive_semidefinite(reduced):
        return Curvature(copositive=True)
    weak = unit_rows(cone.weak * units)[0] @ N
    copositive, found = _search_faces(reduced, weak, min(faces, FEW))
    if copositive is None:
        found = _probe(reduced, weak)
    if copositive is None and found is None:
        copositive, found = _search_faces(reduced, weak, faces)
    if found is None:
        return Curvature(copositive=copositive)
    direction = np.zeros(H.shape[0])
    direction[cone.free] = units * (N @ found)
    return Curvature(copositive=False, direction=direction / np.linalg.norm(direction))


def null_space(rows: Array, n: int) -> Array:
    """An orthonormal basis of {d : rows d = 0}."""
    if rows.shape[0] == 0 or n == 0:
        return np.eye(n)
    return orthogonal(rows, DEPENDENT)[1]


def _positive_semidefinite(matrix: Array) -> bool:
    """Whether no eigenvalue is below -ZERO, by Cholesky of the shifted matrix."""
    return (
        matrix.size == 0
        or is_definite(matrix + ZERO * np.eye(matrix.shape[0]))
        or float(np.linalg.eigvalsh(matrix)[0]) >= -ZERO
    )


def _projected(weak: Array, d: Array) -> Array:
    """The nearest point of {d : W d >= 0}."""
    if weak.shape[0] == 0:
        return d
    try:
        y, _ = nnls(weak.T, -d)
    except RuntimeError:  # SciPy's iteration limit: this start is given up, the faces are still to come
        return np.zeros_like(d)
    return d + weak.T @ y


def _probe(reduced: Array, weak: Array) -> Array | None:
    """Projected descent from a few negative eigenvectors and their mixtures."""
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
            if _falls(reduced, weak, d):
                return d
            d = d - reduced @ d / size
    return None


def _falls(reduced: Array, weak: Array, d: Array) -> bool:
    """Whether the unit direction is in the cone and has negative curvature."""
    return float(d @ reduced @ d) < -ZERO and bool(np.all(weak @ d >= -1e-11))


def _search_faces(reduced: Array, weak: Array, faces: int) -> tuple[bool | None, Array | None]:
    """All faces on whose span the form is not positive semidefinite, until one holds a falling direction."""
    stack: list[tuple[int, ...]] = [()]
    seen = 0
    while stack:
        if seen >= faces:
            return None, None
        face = stack.pop()
        seen += 1
        basis = null_space(weak[list(face)], reduced.shape[0])
        if basis.shape[1] == 0:
            continue
        form = basis.T @ reduced @ basis
        if is_definite(form + ZERO * np.eye(form.shape[0])):
            continue
        eigenvalues, vectors = np.linalg.eigh(form)
        for column in np.flatnonzero(eigenvalues < -ZERO):
            for d in (basis @ vectors[:, column], -(basis @ vectors[:, column])):
                if _falls(reduced, weak, d):
                    return False, d
        if eigenvalues[0] < -ZERO:
            stack += [(*face, i) for i in range(face[-1] + 1 if face else 0, weak.shape[0])]
    return True, None
