"""Which constraint of the working set is to go: the one whose multiplier has the wrong sign most of all."""

import numpy as np

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.working_set import TEMPORARY, WorkingSet


def wrong_sign(working: WorkingSet, multipliers: Array, zero: float | Array, *, least_index: bool) -> int | None:
    """The place of the constraint to drop; None if all signs are right.

    Parameters
    ----------
    multipliers : (n + r,) array
        As from `WorkingSet.multipliers`.
    zero : float or (n + r,) array
        Size of a multiplier that counts as zero.
    least_index : bool
        Take the constraint of the lowest number among those with a wrong sign (Bland 1977).
    """
    wrong = working.signs * multipliers
    if working.temporary:
        n, ids = working.free.size, working.ids
        of_temporary = np.where(ids == TEMPORARY, np.inf, np.abs(multipliers[n:]))
        wrong[n:] = np.where(ids < 0, of_temporary, wrong[n:])
    if not isinstance(zero, float):
        wrong = np.where(wrong > zero, wrong, -np.inf)
        zero = 0.0
    place = int(wrong.argmax())
    if wrong.item(place) <= zero:
        return None
    if least_index:
        return int(np.where(wrong > zero, working.numbers, working.held.size).argmin())
    return place
