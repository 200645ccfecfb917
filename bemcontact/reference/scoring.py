"""Differences between a solution and its references."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.assessment.footprint import ContactInterval, Footprint
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.frozen import frozen_value
from bemcontact.problems import Table, Values
from bemcontact.reference.evaluation import Expected
from bemcontact.reference.positions import LEVEL, Frame, coordinates, in_zone
from bemcontact.serialization import Leaf


@frozen_value
class Score(Leaf):
    """Computed and expected value of one quantity of a reference."""

    reference: str
    """Name of the reference in the problem."""
    quantity: str
    """Name of the quantity, such as peak, half-width, start of contact or pressure (largest difference)."""
    computed: float | None
    """Computed value, [p], [L], [p L] or degrees; null without contact, which has no ends, and for an infinite peak."""
    expected: float
    """Expected value in the same unit; 0 if the quantity is a difference of pressures."""
    difference: float | None
    """Relative difference: over the expected value, over the extent of contact for its ends, and over the largest or
    mean-square expected pressure for differences of pressure."""
    tolerance: float
    """Relative difference that the reference allows."""
    judged: bool
    """Whether the solution is judged by it; false if the reference is out of its range, or the peak is infinite."""
    holds: bool
    """Whether the difference is within the tolerance."""


def score(
    expected: Sequence[Expected], contact: CondensedContact, footprint: Footprint, pressure: Array
) -> tuple[Score, ...]:
    """Compare an answer, its pressure (n,) [p] and footprint, with the values that references expect."""
    return tuple(one for item in expected for one in _scores(item, contact, footprint, np.asarray(pressure, float)))


def _scores(expected: Expected, contact: CondensedContact, footprint: Footprint, pressure: Array) -> Iterator[Score]:
    """Scores of all quantities that one reference gives."""
    here = in_zone(contact, expected.zone)
    intervals = [item for item in footprint.intervals if expected.zone in (None, item.zone)]
    if expected.peak is not None:
        if expected.infinite:
            yield replace(_score(expected, "peak", None, expected.peak, None), judged=False)
        else:
            yield _relative(expected, "peak", float(pressure[here].max()), expected.peak)
    if expected.half_width is not None:
        ends = np.array([end for item in intervals for end in (item.start, item.end)]).reshape(-1, 2)
        distances = np.abs(Frame.at(contact, expected.zone, expected.center).distances(ends))
        yield _relative(expected, "half-width", float(distances.max(initial=0.0)), expected.half_width)
    if expected.contact_length is not None:
        length = sum(item.end_arc - item.start_arc for item in intervals)
        yield _relative(expected, "contact length", length, expected.contact_length)
    yield from _end_scores(expected, contact, intervals, here & (pressure > 0))
    if expected.resultant is not None:
        yield _relative(expected, "resultant", _force(contact, pressure, here), expected.resultant)
    if expected.compared.any():
        yield from _pressure_scores(expected, contact, pressure)


def _relative(expected: Expected, quantity: str, computed: float, value: float) -> Score:
    """A quantity relative to itself."""
    return _score(expected, quantity, computed, value, (computed - value) / value)


def _score(expected: Expected, quantity: str, computed: float | None, value: float, difference: float | None) -> Score:
    return Score(
        reference=expected.name,
        quantity=quantity,
        computed=computed,
        expected=value,
        difference=difference,
        tolerance=expected.tolerance,
        judged=expected.in_range,
        holds=difference is not None and abs(difference) <= expected.tolerance,
    )


def _end_scores(
    expected: Expected, contact: CondensedContact, intervals: Sequence[ContactInterval], touching: BoolArray
) -> Iterator[Score]:
    """Smallest and largest coordinate of contact, relative to its extent."""
    if expected.along is None:
        return
    coordinates_of = [_coordinates_along(expected.along, contact, interval, touching) for interval in intervals]
    here = np.concatenate(coordinates_of) if coordinates_of else np.zeros(0)
    size = 360.0 if expected.along.against == "angle" else float(np.ptp(contact.points, axis=0).max())
    extent = float(np.ptp(here)) if len(here) else 0.0
    for quantity, value, pick in (("start", expected.start, np.min), ("end", expected.end, np.max)):
        if value is None:
            continue
        computed = float(pick(here)) if len(here) else None
        if computed is not None and expected.along.against == "angle":
            computed += 360.0 * round((value - computed) / 360.0)
        difference = (computed - value) / extent if computed is not None and extent > LEVEL * size else None
        yield _score(expected, f"{quantity} of contact", computed, value, difference)


def _coordinates_along(
    along: Values | Table, contact: CondensedContact, interval: ContactInterval, touching: BoolArray
) -> Array:
    """Coordinate (k,) of the contact points of an interval and its ends, an angle without jumps."""
    index = np.flatnonzero(touching & (contact.run == interval.run))
    arc = contact.arc_position[index]
    if np.isfinite(interval.perimeter):
        arc = arc + interval.perimeter * np.ceil((interval.start_arc - arc) / interval.perimeter)
    inside = np.flatnonzero((arc >= interval.start_arc) & (arc <= interval.end_arc))
    inside = inside[np.argsort(arc[inside])]
    points = np.vstack([interval.start, contact.points[index[inside]], interval.end])
    along_interval = coordinates(along, points, np.hstack([interval.start_arc, arc[inside], interval.end_arc]))
    return np.unwrap(along_interval, period=360.0) if along.against == "angle" else along_interval


def _force(contact: CondensedContact, pressure: Array, here: BoolArray) -> float:
    """Magnitude |Σ w p n| [p L] of the force of the rigid surface, over some of the contact points."""
    force = contact.forces(pressure)[here].sum(axis=0)
    return float(np.hypot(*force))


def _pressure_scores(expected: Expected, contact: CondensedContact, pressure: Array) -> Iterator[Score]:
    """Largest difference over the peak of the reference, and √(Σ w (p - e)² / Σ w e²), w the tributary lengths.

    If the reference expects no pressure, the differences are relative to the peak of the answer or the pressure scale.
    """
    known, computed = expected.pressure[expected.compared], pressure[expected.compared]
    weights = contact.weights[expected.compared]
    largest = float(np.abs(computed - known).max())
    own = contact.peak(pressure) or contact.scales.pressure
    peak = expected.peak or float(np.abs(known).max()) or own
    yield _score(expected, "pressure (largest difference)", largest, 0.0, largest / peak)
    off, norm = (float(np.sqrt(weights @ value**2 / weights.sum())) for value in (computed - known, known))
    yield _score(expected, "pressure (mean square)", off, 0.0, off / (norm or own))
