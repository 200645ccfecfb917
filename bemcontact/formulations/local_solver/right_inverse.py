"""The shortest right inverse of the rows of a working set, on the variables that are free.

Rows of fixed variables are zero. In large programs they are not stored.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.factorizations import add_rank_one, dot
from bemcontact.formulations.local_solver.statement import INFINITY, largest

LARGE = 250
"""Number of variables from which rows of fixed variables are not stored."""
ROOM = 32
"""Rows by which the storage grows."""


class RightInverse:
    """N (n, r) with W N = I, changed in place; products with it are O(n r).

    Parameters
    ----------
    n : number of variables
    free : (f,) variables that are not fixed
    columns : (f, r) N on them
    """

    def __init__(self, n: int, free: NDArray[np.intp], columns: Array) -> None:
        self._n, self._packed, r = n, n > LARGE, columns.shape[1]
        self._released: Array | None = None
        self._bound = INFINITY
        if self._packed:
            self._slots, self._slot = np.zeros(n, dtype=np.intp), np.zeros(n, dtype=np.intp)
            self._slots[: free.size], self._slot[free] = free, np.arange(free.size)
            self._filled, room = free.size, min(n, free.size + ROOM)
            self._stored = np.zeros((room, n), order="F")
            self._stored[: free.size, :r] = columns
        else:
            self._stored = np.zeros((n, n), order="F")
            if r:
                self._stored[free, :r] = columns
        self._resize(r)

    def _resize(self, size: int) -> None:
        """Set the view on the leading columns."""
        self.size, self._columns = size, self._stored[:, :size]

    def _pack(self, vector: Array) -> Array:
        """A vector (n,) on the rows that are stored."""
        if not self._packed:
            return vector
        packed = vector[self._slots[: self._stored.shape[0]]]
        packed[self._filled :] = 0.0
        return packed

    def _spread(self, packed: Array) -> Array:
        """A vector (n,) from that on the rows that are stored."""
        if not self._packed:
            return packed
        vector = np.zeros(self._n)
        vector[self._slots[: self._filled]] = packed[: self._filled]
        return vector

    def _settle(self) -> Array:
        """The columns, after the change that waits for the direction released last."""
        if self._released is not None:
            direction, self._released = self._pack(self._released), None
            self._subtract(direction, direction.dot(self._columns))
        return self._columns

    def _subtract(self, column: Array, row: Array) -> None:
        """Subtract column rowᵀ."""
        add_rank_one(self._columns, -1.0, column, row)
        if row.size:  # lengths bound the largest entries
            self._bound += sqrt(dot(column, column) * dot(row, row))

    @property
    def whole(self) -> Array:
        """N (n, r)."""
        columns = self._settle()
        if not self._packed:
            return columns
        whole = np.zeros((self._n, self.size), order="F")
        whole[self._slots[: self._filled]] = columns[: self._filled]
        return whole

    @property
    def largest(self) -> float:
        """The largest entry."""
        return largest(self._settle().T)  # row-major

    def is_below(self, limit: float) -> bool:
        """Whether all entries are smaller than a limit."""
        if self._bound >= limit:
            self._bound = self.largest
        return self._bound < limit

    def times(self, vector: Array) -> Array:
        """N v (n,)."""
        if self._released is not None:
            self._settle()
        product = self._columns.dot(vector)
        return self._spread(product) if self._packed else product

    def sizes_times(self, sizes: Array) -> Array:
        """|N| v (n,)."""
        return self._spread(np.abs(self._settle()).dot(sizes))

    def against(self, vector: Array) -> Array:
        """Nᵀ g (r,)."""
        if self._released is not None:
            self._settle()
        return (self._pack(vector) if self._packed else vector).dot(self._columns)

    def row(self, variable: int) -> Array:
        """The row of a free variable (r,), as a new array."""
        return self._settle()[self._slot[variable] if self._packed else variable].copy()

    def column(self, place: int) -> Array:
        """A column (n,), as a new array."""
        column = self._settle()[:, place]
        return self._spread(column) if self._packed else column.copy()

    def subtract(self, column: Array, row: Array) -> None:
        """Subtract column rowᵀ, (n,) and (r,)."""
        self._settle()
        self._subtract(self._pack(column) if self._packed else column, row)

    def released(self, direction: Array) -> None:
        """Note that a unit direction, which changes no row, has become free; N is still to be made orthogonal to it."""
        self._settle()
        self._released = direction

    def exchanged(self, normal: Array, variable: int | None) -> tuple[float, Array] | None:
        """The component of the direction released last along a normal, and the direction; None if there is none."""
        if self._released is None:
            return None
        direction = self._released
        return dot(direction, normal) if variable is None else direction.item(variable), direction

    def exchange(self, normal: Array, variable: int | None, inverse: Array) -> None:
        """Hold a normal where only the direction released last is free: one change of N instead of two."""
        self._released = None
        along = self.row(variable) if variable is not None else self.against(normal)
        self._subtract(self._pack(inverse), along)

    def append(self, column: Array) -> None:
        """Append a column (n,)."""
        self._settle()
        self._bound = max(self._bound, sqrt(dot(column, column)))
        self._stored[:, self.size] = self._pack(column)
        self._resize(self.size + 1)

    def forget(self, place: int) -> None:
        """Replace a column by the last one."""
        self._settle()
        self._stored[:, place] = self._stored[:, self.size - 1]
        self._resize(self.size - 1)

    def fix(self, variable: int) -> None:
        """Set the row of a variable to zero."""
        if not self._packed:
            self._columns[variable] = 0.0
            return
        slot, last = self._slot[variable], self._filled - 1
        self._columns[slot] = self._columns[last]
        self._columns[last] = 0.0
        moved = self._slots[last]
        self._slots[slot], self._slot[moved], self._filled = moved, slot, last

    def free(self, variable: int) -> None:
        """Let a variable with a row of zeros be free."""
        if not self._packed:
            return
        self._settle()
        room = self._stored.shape[0]
        if self._filled == room:
            stored = np.zeros((min(self._n, room + max(ROOM, room // 4)), self._n), order="F")
            stored[:room, : self.size] = self._columns
            self._stored = stored
            self._resize(self.size)
        self._slots[self._filled], self._slot[variable] = variable, self._filled
        self._filled += 1

    def renew(self, free: NDArray[np.intp], order: NDArray[np.intp], columns: Array) -> None:
        """Replace N by new columns (f, r) on the free variables, in the order given."""
        self._released, self._bound = None, INFINITY
        self._columns[:] = 0.0
        self._columns[np.ix_(self._slot[free] if self._packed else free, order)] = columns
