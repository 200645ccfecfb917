"""The solution of the linear system of a body: its matrix and right sides are set up, factorized, and refined."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from bemcontact.arrays import Array
from bemcontact.bem.influence import InfluenceRows
from bemcontact.bem.response import Response
from bemcontact.bem.system import System
from bemcontact.contact.lu import LU

LARGEST_COPY = 2.5e8
"""Largest matrix in bytes that is kept beside its factors; of larger ones rows are computed anew for the refinement."""
FEW = 3
"""Columns up to which a product with one after the other takes less time than one with all: for two, half or less."""
POINTS_OF_RESIDUAL = 512
"""Points whose rows machine code computes at a time for the refinement."""

# Once a block of nearly 32 MB was freed, the allocator of glibc keeps up to 64 MB of free memory for the next matrices.
# Else it returns the memory of each mesh, and the faults of new pages are a fifth of a condensation of 600 unknowns.
np.empty(2**25 - 2**14, np.uint8)


def assemble(system: System) -> tuple[Array, Array]:
    """Set up the bordered matrix (size, size), in Fortran order for LU in place, and the right sides (size, s + n)."""
    unknowns = system.unknowns.size
    transposed = np.zeros((system.size + len(system.loadings) + len(system.points), system.size))
    if system.machine_code is None:
        _place_rows(system, transposed)
    else:
        system.machine_code(transposed, system.flat_points(), *system.flat_integrals())
    matrix, right = transposed[: system.size].T, transposed[system.size :].T
    matrix[:unknowns, unknowns:] = system.border
    matrix[unknowns:, :unknowns] = system.null_vectors.T
    return matrix, right


def _place_rows(system: System, transposed: Array) -> None:
    """Write all rows into the transposed system, matrix and right sides one below the other."""

    def place(block: InfluenceRows) -> None:
        for rows in system.rows(block):
            first = 0
            for part in rows.left:
                transposed[first : first + len(part), rows.at] = part
                first += len(part)
            transposed[system.size :, rows.at] = rows.right

    system.influence.each_block(system.equations.collocation, place)


def solve_system(system: System, like: Sequence[System] = ()) -> Response:
    """Solve for loads and unit pressures; `SingularSystemError` if the equations have no unique solution.

    The rows that change the gaps of congruent bodies `like` this one are among those that are solved.
    """
    matrix, right = assemble(system)
    keep = matrix.nbytes <= LARGEST_COPY
    order, count = system.contact_last(like) if keep else (np.arange(system.size), system.size)
    lu = LU.of(matrix.T[order].T if keep else matrix, overwrite=True)
    left = (lambda x, weights: right @ weights - _product(matrix, x)) if keep else partial(residual, system)
    return Response.of(lu, order, count, right, len(system.loadings), left)


def _product(matrix: Array, x: Array) -> Array:
    """A x (size, w) for solutions x (size, w)."""
    if x.shape[1] > FEW:
        return matrix @ x
    return np.array([matrix @ column for column in x.T]).T


def residual(system: System, solution: Array, weights: Array) -> Array:
    """B W - A x (size, w) for solutions x (size, w) and weights W (s + n, w), from rows computed anew.

    No second matrix is kept for it.
    """
    unknowns = system.unknowns.size
    z, s = solution[:unknowns], solution[unknowns:]
    result = np.zeros_like(solution, order="F")

    def place(block: InfluenceRows) -> None:
        for rows in system.rows(block):
            first, left = 0, weights.T @ rows.right
            for part in rows.left:
                left -= z[first : first + len(part)].T @ part
                first += len(part)
            result[rows.at] = left.T

    if system.machine_code is None:
        system.influence.each_block(system.equations.collocation, place)
    else:
        points, integrals = system.flat_points(), system.flat_integrals()
        for first in range(0, len(points.base), POINTS_OF_RESIDUAL):
            at, some = points.part(first, first + POINTS_OF_RESIDUAL)
            transposed = np.zeros((system.size + len(weights), len(at)))
            system.machine_code(transposed, some, *integrals)
            result[at] = transposed[system.size :].T @ weights - transposed[:unknowns].T @ z
    result[:unknowns] -= system.border @ s
    result[unknowns:] = -system.null_vectors.T @ z
    return result
