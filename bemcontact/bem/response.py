"""The response X of a body to loads and unit pressures, A X = B, of which only the rows that contact needs are solved.

In A Q = P⁻¹ L U the columns of the displacements at contact points come last. Their rows of X follow from the last
block of U and of L⁻¹P B. The whole solution follows for one combination of loads and pressures at a time.

Iterative refinement is made of each load, and of one combination of unit pressures. Only where this one changes by more
than round-off are all pressures refined, and the condition of A is looked at: the change is about round-off times it.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Self

import numpy as np

from bemcontact.arrays import Array, IntArray
from bemcontact.cached import cached_property
from bemcontact.contact.lu import LU
from bemcontact.errors import SingularSystemError
from bemcontact.frozen import frozen

SINGULAR = 1e-15
"""Reciprocal condition number below which the system counts as singular."""
PROBED = 1e-11
"""Relative change of the combination by refinement from which all pressures are refined."""
GOLDEN = 0.6180339887498949
"""Its multiples are spread evenly over the fractions, so that signs which follow them have no period."""


@frozen
class Response:
    """Solutions X (size, c) of A X = B for loads and unit pressures.

    Parameters
    ----------
    lu : factors of A Q
    order : (size,) the column of A that each column of A Q is
    reduced : (size, c) L⁻¹P B
    last : (q, c) the last q rows of Qᵀ X
    """

    lu: LU
    order: IntArray
    reduced: Array
    last: Array

    @classmethod
    def of(
        cls, lu: LU, order: IntArray, count: int, right: Array, loads: int, residual: Callable[[Array, Array], Array]
    ) -> Self:
        """Solve, and refine where it matters; `SingularSystemError` if the equations have no unique solution.

        Parameters
        ----------
        lu, order : as in the class
        count : number q of rows that are solved at once
        right : (size, c) B, with columns for so many `loads`, then for unit pressures
        residual : gives B W - A X W (size, w) from X W (size, w) and W (c, w)
        """
        reduced, signs = lu.forward(right), np.where(np.arange(right.shape[1] - loads) * GOLDEN % 1 < 0.5, 1.0, -1.0)
        probes = np.eye(right.shape[1], loads + 1)
        probes[loads:, loads] = signs

        def correction(weights: Array, solution: Array) -> Array:
            return lu.forward(residual(_ordered(solution, order), weights))

        solution = lu.backward(reduced @ probes)
        step = correction(probes, solution)
        reduced[:, :loads] += step[:, :loads]
        change = np.abs(lu.backward(step[:, loads], count)).max(initial=0.0)
        largest = np.abs(solution[len(order) - count :, loads]).max(initial=0.0)
        if not 0.0 < largest < np.inf or not change <= PROBED * largest:
            if lu.reciprocal_condition < SINGULAR:
                raise SingularSystemError(
                    "the equations of the body have no unique solution (reciprocal condition number "
                    f"{lu.reciprocal_condition:.1e}); look for coincident edges, or for neighboring elements of very "
                    "different length"
                )
            reduced += correction(np.eye(right.shape[1]), lu.backward(reduced))
        return cls(lu=lu, order=order, reduced=reduced, last=lu.backward(reduced, count))

    @property
    def columns(self) -> int:
        """Number c of loads and unit pressures."""
        return self.reduced.shape[1]

    def of_columns(self, some: Sequence[int]) -> Self:
        """The solutions for some of the loads and unit pressures."""
        return replace(self, reduced=self.reduced[:, some], last=self.last[:, some])

    def rows(self, at: IntArray) -> Array:
        """Rows (r, c) of X, which are among those that were solved; `IndexError` for others."""
        return self.last.T.take(self._place[at], axis=1).T

    @cached_property
    def _place(self) -> IntArray:
        """Place (size,) of each row of X among those that were solved; beyond the last one for others."""
        place, unsolved = np.full(len(self.order), len(self.last)), len(self.order) - len(self.last)
        place[self.order[unsolved:]] = np.arange(len(self.last))
        return place

    def combined(self, weights: Array) -> Array:
        """X w (size,) for weights (c,) of loads and pressures."""
        return _ordered(self.lu.backward(self.reduced @ weights), self.order)


def _ordered(solution: Array, order: IntArray) -> Array:
    """Solutions (size, …) of A Q x = b as those of A x = b."""
    result = np.empty_like(solution)
    result[order] = solution
    return result
