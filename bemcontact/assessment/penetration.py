"""Penetration of a rigid surface by the deformed boundary, anywhere on it: how much is tolerated, and what is said."""

from dataclasses import dataclass
from enum import StrEnum

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.serialization import Leaf, Pair

TOLERATED = 0.01
"""Depth that the discretization may have, over the displacement."""
ROUND_OFF = 1e-9
"""Depth over the size of the body that is round-off."""


class Misfit(StrEnum):
    """How the deformed boundary does not fit a rigid surface."""

    PENETRATION = "penetration"
    OFF = "pressure off the surface"
    MOVED = "large motion"


@dataclass(frozen=True, kw_only=True)
class Penetration(Leaf):
    """Where the deformed boundary does not fit a rigid surface, beyond what the discretization explains.

    It penetrates the surface, or pressure acts where the displacements take the body off the surface, or the
    displacements change the gap so much that the pressure is wrong.
    """

    kind: Misfit = Misfit.PENETRATION
    """What does not fit: penetration, pressure off the surface, or a large motion."""
    depth: float
    """Depth of the penetration, distance from the surface, or largest change of the gap by the motion [L]."""
    allowed: float
    """Depth or distance that is tolerated: a hundredth of the displacement; of a large motion zero [L]."""
    at: Pair
    """Undeformed place (x, y) [L]."""
    edge: str
    """Name of the edge."""
    zone: str
    """Name of the contact zone of the surface."""
    paired: bool
    """Whether the edge belongs to that zone."""
    words: str
    """What is wrong, and what to do, in sentences."""


def tolerated(contact: CondensedContact, largest: float, size: float) -> float:
    """Depth [L] that is tolerated, from the largest displacement of the boundary and the size of the body [L].

    The displacement is the scale U of contact, or the largest one if that is smaller.
    """
    return max(TOLERATED * min(contact.scales.displacement, largest), ROUND_OFF * size)


def penetration_in_words(depth: str, place: str, zone: str, *, paired: bool) -> str:
    """What is wrong, and what to do, from a depth and a place in words."""
    fact = f"The body penetrates the rigid surface of '{zone}' by {depth} at {place}"
    if paired:
        return (
            f"{fact}, between contact points, on another face of it, or where a condition holds the body. Shorten the "
            "elements there (--refine 2), or correct the condition."
        )
    return (
        f"{fact}, an edge that is not in that zone. Add the edge to the zone; if it is in another one, divide it, or "
        "state both surfaces as one polyline. If the surface ends before that place, state it as a polyline that turns "
        "away there."
    )
