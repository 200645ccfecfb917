"""How a mesh was fitted to the ends of contact, pass by pass."""

from dataclasses import dataclass
from typing import Any

from bemcontact.assessment.footprint import ContactInterval


@dataclass(frozen=True, kw_only=True)
class FitPass:
    """One mesh on the way.

    Parameters
    ----------
    intervals : of contact, as found on this mesh
    movement : largest distance of an end of contact from where the mesh is graded to, over the shorter element there;
        None if it is not graded to these ends of contact, as the first one mostly is not
    """

    intervals: tuple[ContactInterval, ...]
    movement: float | None


@dataclass(frozen=True, kw_only=True)
class MeshFit:
    """How a mesh was fitted.

    Parameters
    ----------
    passes : the mesh as it was stated, then each fitted one
    kept : number of the pass whose mesh was kept; 0 is the mesh as it was stated
    settled : whether the ends of contact found on it are those that it is fitted to, and no contact is narrower than an
        element
    notes : what was done, in words
    """

    passes: tuple[FitPass, ...]
    kept: int
    settled: bool
    notes: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Give it as numbers, lists and texts, ready for JSON."""
        return {
            "settled": self.settled,
            "kept": self.kept,
            "passes": [
                {"movement": item.movement, "intervals": [interval.to_dict() for interval in item.intervals]}
                for item in self.passes
            ],
        }
