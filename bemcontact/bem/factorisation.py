"""The bordered system of a body set up, factorised and solved."""

from functools import partial

import numpy as np

from bemcontact.arrays import Array
from bemcontact.bem.influence import Block
from bemcontact.bem.system import System
from bemcontact.contact.lu import LU
from bemcontact.errors import SingularSystemError

SINGULAR = 1e-15
"""Reciprocal condition number below which the system counts as singular."""


def assemble(system: System) -> tuple[Array, Array]:
    """Set up the bordered matrix (in Fortran order, to be factorised in place) and the right sides.

    Parameters
    ----------
    system : System

    Returns
    -------
    matrix : (size, size)
    right : (size, s + n)
    """
    unknowns = system.unknowns.size
    matrix = np.zeros((system.size, system.size), order="F")
    transposed = matrix.T
    right = np.zeros((system.size, len(system.loadings) + len(system.points)), order="F")

    def place(block: Block) -> None:
        for rows in system.rows(block):
            first = 0
            for part in rows.left:
                transposed[first : first + len(part), rows.at] = part
                first += len(part)
            right[rows.at] = rows.right.T

    system.influence.each_block(system.equations.collocation, place)
    matrix[:unknowns, unknowns:] = system.border
    matrix[unknowns:, :unknowns] = system.null_vectors.T
    return matrix, right


def solve(system: System) -> Array:
    """Solve for the loads and for unit pressures: LU in place, then one step of refinement on rows computed anew.

    Parameters
    ----------
    system : System

    Returns
    -------
    (size, s + n)

    Raises
    ------
    SingularSystemError
    """
    matrix, right = assemble(system)
    lu = LU.of(matrix, overwrite=True)
    if lu.reciprocal_condition < SINGULAR:
        raise SingularSystemError(
            "the equations of the body have no unique solution (reciprocal condition number "
            f"{lu.reciprocal_condition:.1e}); look for coincident edges, or for neighboring elements of very different "
            "length"
        )
    return lu.solve(right, partial(residual, system))


def residual(system: System, response: Array) -> Array:
    """Right sides less matrix times response, (size, s + n), from rows computed anew: no second matrix is kept."""
    unknowns = system.unknowns.size
    z, s = response[:unknowns], response[unknowns:]
    result = np.zeros_like(response, order="F")

    def place(block: Block) -> None:
        for rows in system.rows(block):
            first = 0
            for part in rows.left:
                rows.right[:] -= z[first : first + len(part)].T @ part
                first += len(part)
            result[rows.at] = rows.right.T

    system.influence.each_block(system.equations.collocation, place)
    result[:unknowns] -= system.border @ s
    result[unknowns:] = -system.null_vectors.T @ z
    return result
