"""Positions of contact points: distance from the middle of contact, and coordinates that references use."""

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.problems import Part, Table, Values
from bemcontact.serialization import Pair

LEVEL = 1e-9
"""Distance over the size of the contact below which two positions are equal."""


def in_zone(contact: CondensedContact, zone: str | None) -> BoolArray:
    """Whether each contact point (n,) belongs to a zone; all do if no zone is named."""
    if zone is None:
        return np.ones(contact.size, bool)
    return contact.zone == contact.zone_names.index(zone)


class Frame(NamedTuple):
    """The middle of a contact, the direction along it, to the right or upwards, and the one into the body."""

    center: Array
    along: Array
    inward: Array

    @classmethod
    def at(cls, contact: CondensedContact, zone: str | None, center: Pair | None) -> Self:
        """Put the frame at a center, or where the initial gap is smallest."""
        index = np.flatnonzero(in_zone(contact, zone))
        middle = np.array(foot(contact, zone) if center is None else center)
        nearest = index[np.argmin(np.hypot(*(contact.points[index] - middle).T))]
        x, y = contact.normals[nearest]
        sign = -1.0 if y < -LEVEL or (abs(y) <= LEVEL and x > 0) else 1.0
        return cls(middle, sign * np.array([y, -x]), contact.normals[nearest])

    def distances(self, points: Array) -> Array:
        """Signed distance (k,) [L] of points (k, 2) from the middle, along the contact."""
        return (points - self.center) @ self.along

    def heights(self, points: Array) -> Array:
        """Signed distance (k,) [L] of points (k, 2) from the tangent in the middle, into the body."""
        return (points - self.center) @ self.inward


def foot(contact: CondensedContact, zone: str | None) -> Pair:
    """Point with the smallest initial gap of a zone: the vertex of the parabola around the lowest point.

    At the end of a run it is the lowest point itself; of several equally low points it is the middle.
    """
    index = np.flatnonzero(in_zone(contact, zone))
    gap, size = contact.initial_gap[index], np.ptp(contact.points[index], axis=0).max()
    lowest = index[gap <= gap.min() + LEVEL * size]
    x, y = contact.points[lowest].mean(axis=0)
    run = index[contact.run[index] == contact.run[lowest[0]]]
    arc = contact.arc_position[run] - contact.arc_position[lowest[0]]
    perimeter = contact.run_length[contact.run[lowest[0]]]
    if np.isfinite(perimeter):
        arc = (arc + perimeter / 2) % perimeter - perimeter / 2
    run, arc = run[np.argsort(arc)], np.sort(arc)
    place = int(np.flatnonzero(run == lowest[0])[0])
    if len(lowest) == 1 and 0 < place < len(run) - 1:
        three = slice(place - 1, place + 2)
        bend, slope, _ = np.polyfit(arc[three], contact.initial_gap[run[three]], 2)
        vertex = -slope / (2 * bend)
        x, y = np.array([vertex**2, vertex, 1.0]) @ np.polyfit(arc[three], contact.points[run[three]], 2)
    return float(x), float(y)


def coordinates(stated: Values | Table, points: Array, arc: Array) -> Array:
    """The coordinate (k,) that a reference uses, [L] or degrees, of points (k, 2) at arc positions (k,)."""
    match stated.against:
        case "x":
            return points[:, 0]
        case "y":
            return points[:, 1]
        case "arc":
            return arc
    center, zero = np.array(stated.center), np.array(stated.zero or (1.0, 0.0))
    offset = points - center
    turned = zero[0] * offset[:, 1] - zero[1] * offset[:, 0]
    return np.degrees(np.arctan2(turned, offset @ zero))


def spacing(contact: CondensedContact) -> Array:
    """Arc length (n,) [L] from each contact point to the farther of its neighbors in the run."""
    order = contact.in_order(np.arange(contact.size))
    step = np.diff(contact.arc_position[order])
    step[np.diff(contact.run[order]) != 0] = 0.0
    farther = np.empty(contact.size)
    farther[order] = np.maximum(np.append(step, 0.0), np.append(0.0, step))
    return farther


def reach(parts: Sequence[Part], frame: Frame) -> float:
    """Least extent [L] of bodies from the middle of a contact: to the left, to the right, and away from the other one.

    Parameters
    ----------
    parts : the body into which `frame` is directed, then the other one if it is elastic
    frame : in the middle of the contact

    A side without material is beyond a line of symmetry and does not count. Holes are ignored.
    """
    least = np.inf
    for part, way in zip(parts, (1.0, -1.0), strict=False):
        outline = np.concatenate([edge.polyline() for edge in part.loops[0]])
        along, away = frame.distances(outline), way * frame.heights(outline)
        sides = [float(side) for side in (along.max(), -along.min()) if side > LEVEL * part.boundary.size]
        least = min([least, *sides, float(away.max())])
    return least
