"""Which side of a contact is a round pin, and which one the round hole around it."""

from collections.abc import Iterable
from typing import NamedTuple

from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.curves import CircularArc, Edge, Pair
from bemcontact.problems.reference import PinInHole
from bemcontact.problems.rigid_surface import Circle
from bemcontact.problems.stated_bodies import StatedBodies
from bemcontact.problems.wording import exact

EQUAL = 1e-6
"""Relative difference of two radii, and of a clearance, that is round-off of what is stated."""


class Round(NamedTuple):
    """A circle on one side of a contact.

    Parameters
    ----------
    center : [L]
    radius : [L]
    solid : whether the body is inside it, which makes it a pin
    """

    center: Pair
    radius: float
    solid: bool


class PinAndHole(NamedTuple):
    """Both circles of a contact, and the bodies that they belong to.

    Parameters
    ----------
    first : circle of the side that has the contact points
    pin, plate : names of the bodies, '' of the only one; None of a rigid surface
    """

    first: Round
    pin: str | None
    plate: str | None


def pin_and_hole(problem: StatedBodies, zone: str, stated: PinInHole) -> PinAndHole | None:
    """The pin and the hole of a zone that have the radius and the clearance of a reference; None if there are none."""
    first, second, gap = _sides(problem, zone)
    own, touched = problem.touching_bodies(zone)
    other_body = touched if zone in problem.contacts else None
    for one in first:
        for other in second:
            pin, hole = (one, other) if one.solid else (other, one)
            away = abs(hole.radius - pin.radius + gap - stated.clearance)
            fits = abs(pin.radius - stated.radius) < EQUAL * stated.radius
            if one.solid != other.solid and fits and away < EQUAL * (stated.clearance + EQUAL * stated.radius):
                return PinAndHole(one, *((own, other_body) if one.solid else (other_body, own)))
    return None


def described_sides(problem: StatedBodies, zone: str) -> str:
    """Say what both sides of a zone are."""
    first, second, gap = _sides(problem, zone)
    words = [" or ".join(dict.fromkeys(map(_described, side))) or "no circle" for side in (first, second)]
    return f"{words[0]}, and {words[1]}" + (f", with the gap {exact(gap)}" if gap else "")


def _described(circle: Round) -> str:
    return f"a {'pin' if circle.solid else 'hole'} of radius {exact(circle.radius)}"


def _sides(problem: StatedBodies, zone: str) -> tuple[list[Round], list[Round], float]:
    """Circles on both sides of a zone, and the gap [L] that is added to the one as drawn."""
    first = _rounds(map(problem.edge, problem.edges_of(zone)))
    surface = problem.zones[zone].surface
    if isinstance(surface, BodySurface):
        return first, _rounds(surface.edges), surface.offset
    second = [Round(surface.center, surface.radius, surface.body == "outside")] if isinstance(surface, Circle) else []
    return first, second, 0.0


def _rounds(edges: Iterable[Edge]) -> list[Round]:
    """Circles of edges that are arcs; bodies are on the left of their edges."""
    arcs = [edge.curve for edge in edges if isinstance(edge.curve, CircularArc)]
    return [Round(arc.center, sum(arc.radii) / 2, arc.sweep > 0) for arc in arcs]
