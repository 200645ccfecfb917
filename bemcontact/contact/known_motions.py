"""What is known of the amounts of free motions: angles, and the motions whose amount nothing determines."""

from typing import Self

import numpy as np

from bemcontact.arrays import Array, BoolArray, freeze_arrays
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen

TAKES_PART = 1e-9
"""Displacement of a tool in a motion, over the largest one in any, from which the tool takes part in it."""


@frozen
class KnownMotions:
    """What is known of the free motions of a solution.

    Parameters
    ----------
    rotations : (k,) angle of each [rad], zero in a translation, and not a number in a rotation whose amount is not
        known; None if none of them is known
    unknown : names of those whose amount is not known
    tools : (t, 3) whether the displacement of each tool is known along x and y, and its rotation
    """

    rotations: Array | None
    unknown: tuple[str, ...]
    tools: BoolArray

    def __post_init__(self) -> None:
        """Make arrays read-only."""
        freeze_arrays(self)

    @classmethod
    def of(
        cls,
        contact: CondensedContact,
        solution: ContactSolution,
        rotations: Array | None = None,
        held: BoolArray | None = None,
        turning: BoolArray | bool = True,
    ) -> Self:
        """What is known, with the angles (k,) of the boundary behind the contact points if they are computed from it.

        Of the motions that are `turning` (k,) something: the angle of others is zero, whatever their amount is. `held`
        (k,) says which motions something else than slopes and levers as drawn holds: all if it is None. What
        contact leaves open is not known, nor is anything without contact.
        """
        if rotations is None and contact.motion_arms is not None:
            rotations, turning = contact.rotations(solution.rigid_amplitudes), np.isfinite(contact.motion_arms)
        known = np.ones(contact.free_motions, bool) if held is None else held
        known = known & np.array([name not in solution.undetermined for name in contact.motion_names], bool)
        known &= bool(solution.pressure.any())
        moved = abs(contact.tools.amplitudes)
        part = moved > TAKES_PART * moved.max(axis=1, initial=0.0, keepdims=True)
        return cls(
            rotations=None if rotations is None else np.where(known | ~np.asarray(turning), rotations, np.nan),
            unknown=tuple(name for name, is_known in zip(contact.motion_names, known, strict=True) if not is_known),
            tools=~(part & ~known).any(axis=1).reshape(-1, 3),
        )
