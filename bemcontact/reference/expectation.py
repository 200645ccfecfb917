"""What a reference expects of the answer, as numbers."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bemcontact.arrays import Array
from bemcontact.problem import Table, Values

Point = tuple[float, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class Expected:
    """What a reference expects of the answer; None, and not a number, where it says nothing.

    Parameters
    ----------
    name : of the reference in the spec
    source : where it comes from
    closed_form : whether it is a formula, and not a list of values
    zone : the contact zone that it is about; None for all
    pressure : (n,) at the contact points [p], per undeformed length
    compared : (n,) where a difference of pressure tells something: not at singular ends
    peak : largest pressure [p]
    half_width : distance of the farther end of contact from `center`, along the tangent there [L]
    center : the middle of the contact
    contact_length : length of the boundary in contact [L]
    start, end : smallest and largest coordinate of contact, [L] or degrees
    along : the reference that says which coordinate that is
    ends : the contact points nearest to `start` and `end`, for drawing
    resultant : magnitude of the force on what is modelled [p L]
    tolerance, reason : relative difference up to which the answer agrees, and why
    in_range : whether the reference is valid for this problem, so that a difference can be held against the answer
    remark : why it is not, in a sentence; else empty
    """

    name: str
    source: str
    closed_form: bool
    zone: str | None
    pressure: Array
    compared: NDArray[np.bool_]
    tolerance: float
    reason: str
    peak: float | None = None
    half_width: float | None = None
    center: Point | None = None
    contact_length: float | None = None
    start: float | None = None
    end: float | None = None
    along: Values | Table | None = None
    ends: tuple[Point, ...] = ()
    resultant: float | None = None
    in_range: bool = True
    remark: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Give all of it as numbers, lists and texts, ready for JSON; a pressure of which nothing is said is None."""
        pressure = [float(p) if np.isfinite(p) else None for p in self.pressure]
        return {
            "name": self.name,
            "source": self.source,
            "closed_form": self.closed_form,
            "zone": self.zone,
            "pressure": pressure,
            "compared": self.compared.tolist(),
            "peak": self.peak,
            "half_width": self.half_width,
            "center": None if self.center is None else list(self.center),
            "contact_length": self.contact_length,
            "start": self.start,
            "end": self.end,
            "against": None if self.along is None else self.along.against,
            "ends": [list(point) for point in self.ends],
            "resultant": self.resultant,
            "tolerance": self.tolerance,
            "reason": self.reason,
            "in_range": self.in_range,
            "remark": self.remark,
        }
