"""How a mesh was fitted to the ends of contact, pass by pass."""

from dataclasses import dataclass

from bemcontact.assessment.footprint import ContactInterval
from bemcontact.serialization import Internal, Leaf


@dataclass(frozen=True, kw_only=True)
class FitPass(Leaf):
    """One mesh on the way to the fitted one."""

    intervals: tuple[ContactInterval, ...]
    """Contact intervals on this mesh."""
    movement: float | None
    """Largest distance of an end of contact from where the mesh is graded to, over the shorter element there.

    Null if the mesh is not graded to these ends of contact, as the first one mostly is not.
    """


@dataclass(frozen=True, kw_only=True)
class MeshFit(Leaf):
    """How a mesh was fitted to the ends of contact."""

    passes: tuple[FitPass, ...]
    """The mesh as it is stated, then each fitted one."""
    kept: int
    """Number of the pass whose mesh was kept; 0 is the mesh as it is stated."""
    settled: bool
    """Whether the ends of contact on it are those that it is fitted to, and no contact is narrower than an element."""
    notes: Internal[tuple[str, ...]]
    """What was done, in words."""
