"""Unit pressures on the mesh of one body, and the displacements that change gaps."""

from dataclasses import replace
from typing import Self

import numpy as np

from bemcontact.arrays import Array, IntArray
from bemcontact.frozen import frozen


@frozen
class UnitPressures:
    """Where unit pressures act on the mesh of one body, and where their displacement counts.

    Parameters
    ----------
    number : (c,) of each pressure among all contact points
    element, local, pressure : (q,) the (element, local node) pairs that carry each of these pressures
    traction : (q, 2) there
    node : (r,) nodes whose displacement changes a gap
    gap : (r,) number of the point of this gap
    change : (r, 2) of the gap by unit displacements along x and y
    """

    number: IntArray
    element: IntArray
    local: IntArray
    pressure: IntArray
    traction: Array
    node: IntArray
    gap: IntArray
    change: Array

    @classmethod
    def none(cls) -> Self:
        """No pressures, for a body that touches nothing."""
        numbers, vectors = np.zeros(0, int), np.zeros((0, 2))
        return cls(
            number=numbers, element=numbers, local=numbers, pressure=numbers, traction=vectors, node=numbers,
            gap=numbers, change=vectors,
        )  # fmt: skip

    def __len__(self) -> int:
        """Return the number of pressures."""
        return len(self.number)

    def turned(self, turn: Array) -> Self:
        """Return these pressures on a body that is turned by a rotation (2, 2), x @ turn."""
        return replace(self, traction=self.traction @ turn, change=self.change @ turn)
