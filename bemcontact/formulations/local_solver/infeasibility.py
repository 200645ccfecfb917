"""Proofs that linear constraints have no feasible point, by multipliers (Farkas), to the last digit of the data.

Rows that are nearly parallel meet far away: their multipliers leave no more of each other than rounding, and would seem
to prove that they do not meet at all. What they may leave is what a change of each entry of a row by one unit in its
last place makes up for. So a proof says that entries this near have no feasible point (Oettli and Prager, Numer. Math.
6 (1964) 405-409).
"""

import numpy as np

from bemcontact.arrays import Array, fine_remainders

FEIGNED = 1e3
"""What is left of a variable counts with so many times the size of the nearest point, or of one."""
SMALL = 1e-11
"""Part of the largest multiplier up to which a multiplier is zero."""
REFINEMENTS = 8
CORRECTED = 0.1
"""Largest part of a multiplier that corrections may change: rows that meet in a point leave nothing of any."""
EPS = float(np.finfo(float).eps)
ULP = 0.9 * EPS
"""Change of an entry over the entry: a unit in its last place is between a half and one EPS of it."""


def proof_of_infeasibility(A: Array, lower: Array, upper: Array, multipliers: Array, near: Array) -> Array | None:
    """Multipliers y of [I; A] which prove that no x has lower <= [x; A x] <= upper, from those of A; or None.

    They prove it if [I; A]ᵀy = 0, and y lower (y > 0) plus y upper (y < 0) is positive. They are refined to twice the
    digits. What they leave then at a variable without a bound counts with the size that the variable may have.

    Parameters
    ----------
    A : (m, n) scaled so that entries and x have sizes of about one
    lower, upper : (n + m,) of the variables, then of the rows; infinite where there is none
    multipliers : (m,) up to rounding
    near : (n,) the point that comes nearest to the bounds

    Returns
    -------
    Array or None
        y (n + m,)
    """
    n, size = A.shape[1], FEIGNED * np.maximum(np.abs(near), 1.0)
    used = np.abs(multipliers) > SMALL * np.abs(multipliers).max(initial=0.0)
    y = multipliers[used]
    bounds = np.where(y > 0.0, lower[n:][used], upper[n:][used])
    if not np.isfinite(bounds).all():
        return None
    rows = np.column_stack([A[used], bounds]).T  # the last one gives the sum
    fine, change, free = np.zeros_like(y), np.zeros_like(y), np.zeros(n + 1, bool)
    rest, limits = np.zeros(n + 1), np.zeros(n)
    for _ in range(REFINEMENTS + 1):
        fine += change
        rest = fine_remainders(np.zeros(n + 1), np.hstack([rows, rows]), np.concatenate([y, fine]))
        limits = np.where(rest[:n] > 0.0, lower[:n], upper[:n])
        free[:n] |= np.abs(limits) > size
        change = y * np.linalg.lstsq(rows[free] * y, rest[free])[0]
    free = free[:n]
    of_variables = np.where(free, 0.0, rest[:n])
    held = of_variables * np.where(free, 0.0, limits)
    lost = np.abs(rest[:n][free]) @ size[free] + 4.0 * EPS * (np.abs(held).sum() + np.abs(y) @ np.abs(bounds))
    of_entries = ULP * (np.abs(y) @ np.abs(A[used]))
    far = (np.abs(rest[:n]) > of_entries)[free].any() or (np.abs(fine) > CORRECTED * np.abs(y)).any()
    if far or held.sum() - rest[n] <= lost:
        return None
    proof = np.zeros(lower.size)
    proof[:n], proof[n:][used] = of_variables, y + fine
    return proof
