"""How an answer changes as the mesh gets finer: differences, and their order."""

import math
from collections.abc import Sequence
from typing import Literal

import scipy

from bemcontact.assessment.footprint import ContactInterval, Footprint
from bemcontact.frozen import frozen_value
from bemcontact.serialization import Leaf

ORDERS = 0.05, 12.0
"""Orders between which one is looked for."""
ROUND_OFF = 1e-9
"""Change relative to the value below which it is due to round-off and not to the mesh."""


@frozen_value
class Quantity(Leaf):
    """A number on one mesh after the other."""

    name: str
    """Name of the quantity."""
    dimension: Literal["p", "L", "1"]
    """Its unit: pressure, length, or none."""
    values: tuple[float, ...]
    """Value on each mesh, the coarsest first."""
    orders: tuple[float | None, ...]
    """Observed orders: one fewer than values where the limit is known to be zero, otherwise two fewer.

    Null where the values show none: they do not approach a limit steadily, or they have reached it within round-off.
    """
    limit: float | None
    """Limit extrapolated with the last order; null without an order."""


@frozen_value
class Convergence(Leaf):
    """Change of the solution with the mesh."""

    refine: tuple[int, ...]
    """Number of parts into which each element is cut, on each mesh."""
    quantities: tuple[Quantity, ...]
    """Peak pressure, ends of contact, and asymmetry of J M."""
    remark: str
    """Why some quantities cannot be compared, or empty."""


def convergence(refine: Sequence[int], footprints: Sequence[Footprint], asymmetries: Sequence[float]) -> Convergence:
    """Compare the answer on several meshes, each element of which is cut into `refine` parts, ascending.

    The element length goes with the reciprocal. Ends of contact are compared by their arc positions, unless the number
    of intervals changes. The asymmetry of J M is zero in the limit.
    """
    h = [1.0 / parts for parts in refine]
    peaks = [item.peak.pressure for item in footprints if item.peak is not None]
    quantities = [_towards_a_limit("peak pressure", "p", h, peaks)] if len(peaks) == len(h) else []
    stretches = [[interval.zone for interval in item.intervals] for item in footprints]
    remark = ""
    if all(stretch == stretches[0] for stretch in stretches):
        for i, zone in enumerate(stretches[0]):
            place, of = stretches[0][: i + 1].count(zone), stretches[0].count(zone)
            part = f"contact {place} in {zone}, along it" if of > 1 else f"contact in {zone}, along it"
            for name, key in (("start", "start_arc"), ("end", "end_arc")):
                values = _unwound([item.intervals[i] for item in footprints], key)
                quantities.append(_towards_a_limit(f"{name} of {part}", "L", h, values))
    else:
        remark = "the contact intervals are not the same on all meshes, so that their ends cannot be compared"
    quantities.append(_towards_zero("asymmetry of J M", h, asymmetries))
    return Convergence(refine=tuple(refine), quantities=tuple(quantities), remark=remark)


def _unwound(intervals: Sequence[ContactInterval], key: str) -> list[float]:
    """Arc positions on one mesh after the other; on a closed run each is the nearest to the one before."""
    values: list[float] = []
    for interval in intervals:
        value = float(getattr(interval, key))
        if values and math.isfinite(interval.perimeter):
            value += round((values[-1] - value) / interval.perimeter) * interval.perimeter
        values.append(value)
    return values


def _towards_zero(name: str, h: Sequence[float], values: Sequence[float]) -> Quantity:
    """A number that vanishes with the element length: from two meshes log(v/v')/log(h/h')."""
    orders = tuple(
        math.log(values[i] / values[i + 1]) / math.log(h[i] / h[i + 1]) if min(values[i : i + 2]) > ROUND_OFF else None
        for i in range(len(h) - 1)
    )
    falls = orders[-1] is not None and orders[-1] > 0
    return Quantity(name=name, dimension="1", values=tuple(values), orders=orders, limit=0.0 if falls else None)


def _towards_a_limit(name: str, dimension: Literal["p", "L"], h: Sequence[float], values: Sequence[float]) -> Quantity:
    """A number with an unknown limit: from three meshes the q with (v - v')/(v' - v'') = (hᑫ - h'ᑫ)/(h'ᑫ - h''ᑫ)."""
    orders = tuple(_order(h[i : i + 3], values[i : i + 3]) for i in range(len(h) - 2))
    limit = None
    if orders and (q := orders[-1]) is not None:
        coarse, fine = h[-2] ** q, h[-1] ** q
        limit = values[-1] + (values[-1] - values[-2]) * fine / (coarse - fine)
    return Quantity(name=name, dimension=dimension, values=tuple(values), orders=orders, limit=limit)


def _order(h: Sequence[float], values: Sequence[float]) -> float | None:
    """The order shown by three meshes; None if there is none."""
    first, second = values[0] - values[1], values[1] - values[2]
    size = ROUND_OFF * max(map(abs, values))
    if abs(first) <= size or abs(second) <= size:
        return None

    def excess(q: float) -> float:
        return first / second - (h[0] ** q - h[1] ** q) / (h[1] ** q - h[2] ** q)

    if excess(ORDERS[0]) * excess(ORDERS[1]) > 0:
        return None
    return float(scipy.optimize.brentq(excess, *ORDERS))  # pyright: ignore[reportArgumentType]
