"""A system as flat arrays of numbers, which machine code reads (`compiled`); nothing is computed here but places.

All arrays are writable, in C order and of one type each, because machine code is made for the types of its arguments.
Machine code that was kept knows the fields of these classes: a change here needs a change of the file of `compiled`.
"""

from functools import lru_cache
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from bemcontact.arrays import Array, ComplexArray, IntArray
from bemcontact.bem import reference_element
from bemcontact.bem.influence import Collocation, Influence

LARGEST_ORDER = 96
"""Gauss points where no rule of `reference_element.ORDERS` is sufficient for the smooth remainder of a closed form."""


class FlatPoints(NamedTuple):
    """Collocation points as in `Collocation`, with the row (2, c) of each equation, -1 for none.

    The elements on which a point lies, `on_element` and `on_local`, begin at its `on_start` (c + 1,).
    """

    row: IntArray
    base: ComplexArray
    offset: ComplexArray
    corner: IntArray
    on_start: IntArray
    on_element: IntArray
    on_local: Array

    @classmethod
    def of(cls, collocation: Collocation, row: IntArray) -> Self:
        """Points with the rows (c, 2) of their equations."""
        return cls(
            row=_integers(row.T),
            base=_complexes(collocation.base),
            offset=_complexes(collocation.offset),
            corner=_integers(collocation.corner),
            on_start=_integers(collocation.on_point.searchsorted(np.arange(len(collocation) + 1))),
            on_element=_integers(collocation.on_element),
            on_local=_reals(collocation.on_local),
        )

    def part(self, first: int, last: int) -> tuple[IntArray, Self]:
        """The rows (q,) of some points, and these points with their rows numbered from zero, in the same order."""
        there = self.row[:, first:last] >= 0
        row = np.full(there.shape, -1)
        row[there] = np.arange(there.sum())
        return self.row[:, first:last][there], self._replace(
            row=row,
            base=self.base[first:last],
            offset=self.offset[first:last],
            corner=self.corner[first:last],
            on_start=self.on_start[first : last + 1],
        )


class FlatElements(NamedTuple):
    """Elements over L0: their nodes (m, 3), by number and as x + iy; c1 and c2 (m,), and the inner angles (m,)."""

    node: IntArray
    z: ComplexArray
    c1: ComplexArray
    c2: ComplexArray
    angle: Array

    @classmethod
    def of(cls, influence: Influence) -> Self:
        """Elements of a boundary."""
        _, c1, c2 = influence.coefficients
        return cls(
            node=_integers(influence.mesh.elements),
            z=_complexes(influence.element_nodes),
            c1=_complexes(c1),
            c2=_complexes(c2),
            angle=_reals(influence.inner_angles),
        )


class FlatColumns(NamedTuple):
    """Columns of matrix and right sides, in one row, to which an integral goes with a factor.

    displacement : (N, 2) column of F u along each axis, -1 for none
    known : (s, N, 2) factor of F in the right sides
    traction : (s, m, 3, 2) factor of G in the right sides
    first_known : column of the first right side
    start : (3m + 1,) where the columns of each (element, local node) begin in those that follow
    column : (q,) other columns of G t
    x, y : (q,) traction times Jacobian along each axis for a unit of the column
    loaded : (m,) whether G of an element is needed
    """

    displacement: IntArray
    known: Array
    traction: Array
    first_known: int
    start: IntArray
    column: IntArray
    x: Array
    y: Array
    loaded: IntArray

    @classmethod
    def of(
        cls, displacement: IntArray, known: Array, known_traction: Array, first_known: int,
        slot: IntArray, column: IntArray, traction: Array,
    ) -> Self:  # fmt: skip
        """Sort columns (q,) of G with tractions times Jacobian (q, 2) at slots 3 e + k (q,) by slots."""
        m = known_traction.shape[1]
        order = slot.argsort(kind="stable")
        start = slot[order].searchsorted(np.arange(3 * m + 1))
        return cls(
            displacement=_integers(displacement),
            known=_reals(known),
            traction=_reals(known_traction),
            first_known=first_known,
            start=_integers(start),
            column=_integers(column[order]),
            x=_reals(traction[order, 0]),
            y=_reals(traction[order, 1]),
            loaded=_integers((start[3::3] > start[:-1:3]) | known_traction.any(axis=(0, 2, 3))),
        )


class FlatRules(NamedTuple):
    """Gauss rules (r, LARGEST_ORDER) with their numbers of points, and the least ρ of each but the last one.

    shapes : (r, LARGEST_ORDER, 3) shape functions times weights
    rho, rho_of_t : as `SMALLEST_RHO` and `RHO_OF_T` of `reference_element`
    share : ∫ N_k dξ (3,)
    """

    order: IntArray
    xi: Array
    weights: Array
    shapes: Array
    rho: Array
    rho_of_t: Array
    share: Array


@lru_cache(maxsize=1)
def flat_rules() -> FlatRules:
    """The rules of all tiers and the largest one; to be read only."""
    orders = [*reference_element.ORDERS.tolist(), LARGEST_ORDER]
    xi, weights = np.zeros((2, len(orders), LARGEST_ORDER))
    for tier, order in enumerate(orders):
        xi[tier, :order], weights[tier, :order] = reference_element.gauss_legendre(order)
    return FlatRules(
        order=_integers(orders),
        xi=_reals(xi),
        weights=_reals(weights),
        shapes=_reals(reference_element.values(xi) * weights[..., None]),
        rho=_reals(reference_element.SMALLEST_RHO),
        rho_of_t=_reals(reference_element.RHO_OF_T),
        share=_reals(reference_element.INTEGRALS),
    )


def _reals(values: ArrayLike) -> Array:
    return np.array(values, np.float64, order="C")


def _complexes(values: ArrayLike) -> ComplexArray:
    return np.array(values, np.complex128, order="C")


def _integers(values: ArrayLike) -> IntArray:
    return np.array(values, np.int64, order="C")
