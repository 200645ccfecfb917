"""What a reference expects of the answer, as numbers."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import PlainSerializer, computed_field

from bemcontact.arrays import Array
from bemcontact.problem import Table, Values
from bemcontact.serialization import Flags, Internal, Leaf, Pair


def _known(pressure: Array) -> list[float | None]:
    """The pressures as a list, with None for those that are not numbers."""
    return [float(p) if np.isfinite(p) else None for p in pressure]


@dataclass(frozen=True, kw_only=True, eq=False)
class Expected(Leaf):
    """Values that a reference expects of the answer; null where it says nothing."""

    name: str
    """Name of the reference in the problem."""
    source: str
    """Where the values come from."""
    closed_form: bool
    """Whether it is a formula, and not a list of values."""
    zone: str | None
    """Name of the contact zone that it is about; null for all."""
    pressure: Annotated[Array, PlainSerializer(_known, return_type=list[float | None])]
    """Pressure (n,) at each contact point per undeformed length [p]; null where it is unknown."""
    compared: Flags
    """Whether the pressure at each contact point (n,) is compared: not at singular ends."""
    tolerance: float
    """Relative difference up to which the answer agrees."""
    reason: str
    """Reason for this tolerance."""
    peak: float | None = None
    """Largest pressure [p]."""
    half_width: float | None = None
    """Distance of the farther end of contact from `center`, along the tangent there [L]."""
    center: Pair | None = None
    """Middle (x, y) of the contact [L]."""
    contact_length: float | None = None
    """Length of the boundary in contact [L]."""
    start: float | None = None
    """Smallest coordinate of contact, [L] or degrees."""
    end: float | None = None
    """Largest coordinate of contact, [L] or degrees."""
    along: Internal[Values | Table | None] = None
    """Reference that has the coordinate of `start` and `end`."""
    ends: tuple[Pair, ...] = ()
    """Contact points (x, y) nearest to `start` and `end`, for drawing [L]."""
    resultant: float | None = None
    """Magnitude of the contact force on what is modelled, per thickness [p L]."""
    in_range: bool = True
    """Whether the reference is valid for this problem, so that the answer is judged by it."""
    remark: str = ""
    """Why it is not valid, or empty."""

    @computed_field
    @property
    def against(self) -> str | None:
        """Coordinate of `start` and `end`: x, y, arc, or angle, which is in degrees; null without them."""
        return None if self.along is None else self.along.against
