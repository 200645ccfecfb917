"""Load cases of a condensed body, and directions in which it changes.

Both enter the gap without contact, q = ε + Δ1, and the load in ℓᵀp = -load linearly.
"""

from dataclasses import dataclass
from functools import partial
from typing import NamedTuple, Self

import numpy as np

from bemcontact.arrays import Array, freeze_arrays


class Change(NamedTuple):
    """A direction in which a contact problem changes, per unit of what changes.

    Parameters
    ----------
    offset : (n,) change of the gap without contact, q = ε + Δ1
    motion_load : (k,) change of the load in ℓᵀp = -load
    """

    offset: Array
    motion_load: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadCases:
    """c load cases, each as it acts alone, and their factors.

    A state is the permanent one plus the sum of factor times case.

    Parameters
    ----------
    names : of the cases
    displacement : (n, c) Δ1 of each case [L]
    motion_load : (k, c) work of its loads on the body in the free motions of the body, zero in those of tools
    position : (3 t, c) displacement that it adds to the tools: x, y [L], rotation [rad], tool by tool
    force : (3 t, c) force that it adds to the tools: x, y [p L], moment [p L²], likewise
    factors : (c,) in effect
    """

    names: tuple[str, ...]
    displacement: Array
    motion_load: Array
    position: Array
    force: Array
    factors: Array

    def __post_init__(self) -> None:
        """Make arrays read-only."""
        freeze_arrays(self)

    @classmethod
    def none(cls, points: int, motions: int, tools: int) -> Self:
        """No case at all, for n contact points, k free motions and t tools."""
        of = partial(np.zeros, dtype=float)
        return cls(
            names=(), displacement=of((points, 0)), motion_load=of((motions, 0)), position=of((3 * tools, 0)),
            force=of((3 * tools, 0)), factors=of(0),
        )  # fmt: skip

    def __len__(self) -> int:
        """Return the number of cases."""
        return len(self.names)
