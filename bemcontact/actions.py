"""What acts on a condensed body and may change without condensing it anew: load cases, and tools that move.

All of it enters the gap without contact, q = ε + Δ1, and the load in ℓᵀp = -load linearly.
"""

from dataclasses import dataclass
from functools import partial
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

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
    """c load cases, each as it acts by itself, and by how much each of them acts.

    What is permanent acts besides: a state is the permanent one and the sum of factor times case.

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


@dataclass(frozen=True, kw_only=True, eq=False)
class Tools:
    """t tools: rigid surfaces that are displaced, or loaded so that contact must find where they go.

    A tool moves by (x, y) and turns by a small angle about its point; the gap at a contact point of its surfaces then
    changes by -n·w. Where a component is free, its amplitude is one of the free motions of the contact problem and its
    force stands in the load; where it is not, its displacement stands in the initial gap.

    Parameters
    ----------
    names : of the tools
    point : (t, 2) about which each turns, and on which its force acts [L]
    motions : (n, 3 t) -n·w: what a unit displacement x, y and a unit rotation of each tool add to the gap
    amplitudes : (3 t, k) motion of the tools per amplitude a of the free motions
    free : (3 t,) whether a component is free
    position : (3 t,) displacement of the components that are not: x, y [L], rotation [rad], zero for others
    force : (3 t,) on the components that are free: x, y [p L], moment [p L²], zero for others
    """

    names: tuple[str, ...]
    point: Array
    motions: Array
    amplitudes: Array
    free: NDArray[np.bool_]
    position: Array
    force: Array

    def __post_init__(self) -> None:
        """Make arrays read-only."""
        freeze_arrays(self)

    @classmethod
    def none(cls, points: int, motions: int) -> Self:
        """No tool at all, for n contact points and k free motions."""
        return cls(
            names=(), point=np.zeros((0, 2)), motions=np.zeros((points, 0)), amplitudes=np.zeros((0, motions)),
            free=np.zeros(0, bool), position=np.zeros(0), force=np.zeros(0),
        )  # fmt: skip

    def __len__(self) -> int:
        """Return the number of tools."""
        return len(self.names)

    def displacement(self, rigid_amplitudes: Array) -> Array:
        """Where the tools are (t, 3): x, y [L] and rotation [rad], for amplitudes a (k,)."""
        return (self.position + self.amplitudes @ rigid_amplitudes).reshape(-1, 3)

    def reaction(self, contact_forces: Array) -> Array:
        """Force (t, 3) of the body on each tool: x, y [p L] and moment [p L²], from w p at the points (n,) [p L]."""
        return (self.motions.T @ contact_forces).reshape(-1, 3)

    @property
    def keys(self) -> tuple[str, ...]:
        """Key paths (3 t) of the components: of the displacement where it is given, of the force where it is free."""
        moves, forces = (
            ("displacement.x", "displacement.y", "displacement.rotation"),
            ("force.x", "force.y", "force.moment"),
        )
        ways = zip(self.free.reshape(-1, 3), self.names, strict=True)
        return tuple(f"tools.{name}.{(forces if free[i] else moves)[i]}" for free, name in ways for i in range(3))
