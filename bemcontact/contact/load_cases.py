"""Load cases and tools of a condensed body.

Their factors, displacements and forces enter the gap without contact, q = ε + Δ1, and the load in ℓᵀp = -load linearly.
"""

from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from typing import NamedTuple, Self

import numpy as np

from bemcontact.arrays import Array, BoolArray, flag_array, freeze_arrays, read_arrays
from bemcontact.checks.arguments import labels, real_number, visible_texts
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen

BALANCED = 1e-9
"""Work of a load in a motion, relative to the sum of the magnitudes of all loads, that counts as zero."""


class Change(NamedTuple):
    """A direction in which a contact problem changes, per unit of what changes.

    Parameters
    ----------
    offset : (n,) change of the gap without contact, q = ε + Δ1
    motion_load : (k,) change of the load in ℓᵀp = -load
    """

    offset: Array
    motion_load: Array


@frozen
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
        """Refuse arrays of other shapes, and numbers that are not finite; make arrays read-only."""
        c = len(_names(self, "names", "cases.names"))
        shapes = {"displacement": (None, c), "motion_load": (None, c), "position": (None, c), "force": (None, c)}
        read_arrays(self, {**shapes, "factors": (c,)}, "cases.")
        freeze_arrays(self)

    @classmethod
    @lru_cache(maxsize=8)
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

    def fit(self, points: int, motions: int, tools: int) -> bool:
        """Whether they are those of a body with n contact points, k free motions and t tools."""
        parts = self.displacement, self.motion_load, self.position, self.force
        return [*map(len, parts)] == [points, motions, 3 * tools, 3 * tools]


@frozen
class Tools:
    """t tools: rigid surfaces with given displacements, or with given forces and unknown displacements.

    A tool moves by (x, y) and turns by a small angle about its point; the gap at a contact point of its surfaces then
    changes by -n·w. Where a component is free, its amplitude is one of the free motions of the contact problem and its
    force is part of the load. Where it is not free, its displacement is part of the initial gap.

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
    free: BoolArray
    position: Array
    force: Array

    def __post_init__(self) -> None:
        """Refuse arrays of other shapes, and numbers that are not finite; make arrays read-only."""
        t = len(_names(self, "names", "tools.names"))
        read_arrays(self, {"free": (3 * t,)}, "tools.", flag_array)
        shapes = {"point": (t, 2), "motions": (None, 3 * t), "amplitudes": (3 * t, None)}
        read_arrays(self, {**shapes, "position": (3 * t,), "force": (3 * t,)}, "tools.")
        freeze_arrays(self)

    @classmethod
    @lru_cache(maxsize=8)
    def none(cls, points: int, motions: int) -> Self:
        """No tool at all, for n contact points and k free motions."""
        return cls(
            names=(), point=np.zeros((0, 2)), motions=np.zeros((points, 0)), amplitudes=np.zeros((0, motions)),
            free=np.zeros(0, bool), position=np.zeros(0), force=np.zeros(0),
        )  # fmt: skip

    def __len__(self) -> int:
        """Return the number of tools."""
        return len(self.names)

    def fit(self, points: int, motions: int) -> bool:
        """Whether they are those of a body with n contact points and k free motions."""
        return (len(self.motions), self.amplitudes.shape[1]) == (points, motions)

    def displacement(self, rigid_amplitudes: Array) -> Array:
        """Displacements (t, 3) of the tools: x, y [L] and rotation [rad], for amplitudes a (k,)."""
        return (self.position + self.amplitudes @ rigid_amplitudes).reshape(-1, 3)

    @property
    def keys(self) -> tuple[str, ...]:
        """Key paths (3 t) of the components: of the displacement where it is given, of the force where it is free."""
        moves, forces = (
            ("displacement.x", "displacement.y", "displacement.rotation"),
            ("force.x", "force.y", "force.moment"),
        )
        ways = zip(self.free.reshape(-1, 3), self.names, strict=True)
        return tuple(f"tools.{name}.{(forces if free[i] else moves)[i]}" for free, name in ways for i in range(3))


@frozen
class Pinned:
    """j rigid motions of the body and of tools that move no contact point: all loads must balance in them.

    Parameters
    ----------
    motions : j descriptions, "the body against the translation along (1, 0)"
    turns : (j,) whether work in it is a moment [p L²] and not a force [p L]
    load : (j, 1 + c) work of what is permanent on the body, and of each load case
    tools : (3 t, j) motion of the tools
    magnitude : (1 + c,) sum of the magnitudes of what is permanent on the body, and of each load case [p L]
    length : by which a moment is divided to compare it with forces [L]
    """

    motions: tuple[str, ...]
    turns: BoolArray
    load: Array
    tools: Array
    magnitude: Array
    length: float

    def __post_init__(self) -> None:
        """Refuse arrays of other shapes, and numbers that are not finite; make arrays read-only."""
        j = len(_names(self, "motions", "pinned.motions", visible_texts))
        read_arrays(self, {"turns": (j,)}, "pinned.", flag_array)
        read_arrays(self, {"load": (j, None), "tools": (None, j), "magnitude": (None,)}, "pinned.")
        object.__setattr__(self, "length", real_number(self.length, "pinned.length"))
        if not self.length > 0 or (self.magnitude < 0).any():
            raise ProblemError("pinned.length must be positive, and pinned.magnitude not negative")
        freeze_arrays(self)

    @classmethod
    def none(cls, cases: int, tools: int, length: float = 1.0) -> Self:
        """No pinned motion, for c cases and t tools, whose moments are compared with forces by a length [L]."""
        return cls(
            motions=(), turns=np.zeros(0, bool), load=np.zeros((0, 1 + cases)), tools=np.zeros((3 * tools, 0)),
            magnitude=np.zeros(1 + cases), length=length,
        )  # fmt: skip

    def total(self, factors: Array, forces: Array) -> float:
        """Sum of the magnitudes of all loads [p L], for factors (1 + c,) and the terms (3 t, j) of forces on tools.

        Terms that cancel count in full: the round-off that they leave is small beside this sum.
        """
        of_loads = float(self.magnitude @ abs(factors))
        if not forces.size:
            return of_loads
        x, y, moment = forces.T.reshape(-1, 3).T
        return of_loads + float((np.hypot(x, y) + abs(moment) / self.length).sum())

    def violation(self, factors: Array, forces: Array, units: Mapping[str, str] | None = None) -> str | None:
        """Describe a motion that the loads drive and nothing resists; None if the loads balance, as of `total`.

        `units` are the labels of the units of length and force.
        """
        length, force = ((units or {}).get(key, "") for key in ("length", "force"))
        driven = np.atleast_2d(forces.T).sum(axis=0)
        work, total = self.load @ factors + self.tools.T @ driven, self.total(factors, forces)
        for motion, turns, done in zip(self.motions, self.turns, work, strict=True):
            if abs(done) > BALANCED * total * (self.length if turns else 1.0):
                unit = f"{force}·{length}/{length}" if turns else f"{force}/{length}"
                unit = unit if force and length else ""
                size = f"{'moment' if turns else 'resultant'} {done:.6g} {unit}".strip()
                return (
                    f"nothing holds {motion}, and the loads act along it ({size}); prescribe a displacement that holds "
                    "it, or balance the loads"
                )
        return None


def _names(
    instance: object, field: str, what: str, read: Callable[[object, str], tuple[str, ...]] = labels
) -> tuple[str, ...]:
    """Read a field of a frozen dataclass as different texts."""
    given = getattr(instance, field)
    if type(given) is tuple and not given:
        return given
    names = read(given, what)
    if len({*names}) < len(names):
        raise ProblemError(f"{what} must be different from each other; found {', '.join(names)}")
    object.__setattr__(instance, field, names)
    return names
