"""Why the solution of the equations is not that of contact: what is tolerated, and what is said.

The deformed boundary may penetrate a rigid surface, itself or another body anywhere, or displacements are not small.
"""

from enum import StrEnum

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.frozen import frozen_value
from bemcontact.serialization import Leaf, Pair

TOLERATED = 0.01
"""Depth that the discretization may have, over the displacement."""
ROUND_OFF = 1e-9
"""Depth over the size of the body that is round-off."""


class Misfit(StrEnum):
    """Why a solution of the equations is no answer, in the words of the verdict."""

    PENETRATION = "penetrates a surface"
    ITSELF = "penetrates itself"
    EACH_OTHER = "penetrates another body"
    OFF = "pressure off the surface"
    MOVED = "large motion"
    NOT_SMALL = "outside linear theory"

    @property
    def serious(self) -> bool:
        """Whether the solution contradicts contact; outside linear theory it is one, of a theory that is too rough."""
        return self is not Misfit.NOT_SMALL


@frozen_value
class Penetration(Leaf):
    """Where the deformed boundary does not fit a rigid surface, beyond what the discretization explains.

    It penetrates the surface, itself or another body, or pressure acts where the displacements take the body off the
    surface, or the displacements change the gap so much that the pressure is wrong. Or displacements are not small, so
    that linear theory does not hold.
    """

    kind: Misfit = Misfit.PENETRATION
    """What is wrong, in the words of the verdict: a penetration of a surface, of the body itself or of another body,
    pressure off the surface, a large motion, or displacements that are not small."""
    depth: float
    """Depth of the penetration, distance from the surface, or largest change of the gap by the motion [L]; of a body
    that penetrates itself or another one the distance of the two places before they met [L]; outside linear theory the
    largest strain, change of the displacement over the length, error of a slender part, or load over the critical one,
    a number."""
    allowed: float
    """Depth or distance that is tolerated: a hundredth of the displacement; zero of a large motion, and of a body that
    penetrates itself or another one [L]. Outside linear theory the least number that is not small."""
    at: Pair
    """Undeformed place (x, y) [L]."""
    edge: str
    """Name of the edge."""
    zone: str
    """Name of the contact zone of the surface; empty where there is none."""
    paired: bool
    """Whether the edge belongs to that zone."""
    words: str
    """What is wrong, and what to do, in sentences."""

    def before(self, words: str) -> str:
        """The words, then what holds of the equations."""
        return f"{self.words} At the contact points: {words}"

    @property
    def as_note(self) -> str:
        """The words as a note, beside another verdict."""
        return self.words[0].lower() + self.words[1:].removesuffix(".")


def tolerated(contact: CondensedContact, largest: float, size: float) -> float:
    """Depth [L] that is tolerated, from the largest displacement of the boundary and the size of the body [L].

    The displacement is the scale U of contact, or the largest one if that is smaller.
    """
    return max(TOLERATED * min(contact.scales.displacement, largest), ROUND_OFF * size)


def penetration_in_words(fact: str, advice: str = "", *, paired: bool) -> str:
    """What is wrong, and what to do, from what penetrates what by how much and where, and why it may."""
    if paired:
        return (
            f"{fact}, between contact points, on another face of it, or where a condition holds the body. Shorten the "
            "elements there (--refine 2), or correct the condition."
        )
    return f"{fact}, {advice}"
