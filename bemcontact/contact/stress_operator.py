"""Stress at points of a body as a linear function of contact pressures and rigid amplitudes: plain arrays."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bemcontact.arrays import Array, real_array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.stress import Stress
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen

SAME = 1e-10
"""Relative difference of arrays that is round-off of two condensations of one mesh."""


@frozen
class StressOperator:
    """σ = S_p p + S_a a + s_0 at k points, with s_0 = Σ_j f_j s_j over the loadings.

    The second axis of all parts counts σxx, σyy, σxy and σzz.
    """

    contact: CondensedContact
    """The condensed body, whose pressures p (n,) [p] and rigid amplitudes a (r,) [L] these are."""
    points: Array
    """Points (k, 2) [L] of the undeformed body."""
    kind: NDArray[np.str_]
    """A `PointKind` for each point: "inside", "boundary" or "corner"."""
    pressure: Array
    """S_p (k, 4, n)."""
    amplitudes: Array
    """S_a (k, 4, r) [p/L]: zero, for free motions are rigid."""
    loads: Array
    """s_j (k, 4, 1 + c) [p] of the permanent loads, then of what each load case adds."""

    def __repr__(self) -> str:
        """One line: the number of points, and the contact."""
        return f"<StressOperator at {len(self.points)} points of {self.contact!r}>"

    @property
    def constant(self) -> Array:
        """s_0 (k, 4) [p] of the loads that act on `contact`."""
        return self.loads @ np.append(1.0, self.contact.cases.factors)

    def at(self, pressure: ArrayLike, amplitudes: ArrayLike | None = None, factors: ArrayLike | None = None) -> Stress:
        """Stress of pressures (n,) [p], rigid amplitudes (r,) [L], zero if None, and factors (c,) of load cases.

        Without factors, the loads are those that act on `contact`.

        Raises
        ------
        ProblemError
            If an array has another length.
        """
        p = real_array(pressure, "pressure", (self.pressure.shape[2],))
        zero = np.zeros(self.amplitudes.shape[2])
        a = zero if amplitudes is None else real_array(amplitudes, "amplitudes", zero.shape)
        acting = self.contact.cases.factors
        f = acting if factors is None else real_array(factors, "factors", acting.shape)
        values = self.pressure @ p + self.amplitudes @ a + self.loads @ np.append(1.0, f)
        return Stress(points=self.points, components=values[:, :3], zz=values[:, 3], kind=self.kind)


def ensure_of(operator: StressOperator, contact: CondensedContact) -> None:
    """Refuse, with a `ProblemError`, a contact that is another body or mesh, or under other loads.

    Factors of load cases and the initial gap may differ, for stress depends on the latter through p alone.
    """
    own, other = operator.contact.at_rest(), contact.at_rest()
    named = {"load cases": (own.cases.names, other.cases.names)}
    arrays = {
        "contact points": (own.points, other.points),
        "compliance": (own.compliance, other.compliance),
        "rigid motions": (own.rigid_motions, other.rigid_motions),
        "permanent loads": (own.free_displacement, other.free_displacement),
        "loads": (own.motion_load, other.motion_load),
        "displacements by load cases": (own.cases.displacement, other.cases.displacement),
    }
    different = [what for what, (one, two) in named.items() if one != two]
    different += [what for what, (one, two) in arrays.items() if not _same(one, two)]
    if different:
        raise ProblemError(
            f"the stress operator belongs to another contact problem: its {different[0]} differ; take the contact "
            "from it, operator.contact, or make it of the same problem"
        )


def _same(one: Array, other: Array) -> bool:
    """Whether arrays are equal to round-off."""
    largest = np.abs(one).max(initial=0.0)
    return one.shape == other.shape and bool(np.abs(one - other).max(initial=0.0) <= SAME * largest)
