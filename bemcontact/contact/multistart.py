"""Where the searches of a local solver from many random starts ended: which ends, and how often each."""

from dataclasses import dataclass
from typing import Any

from bemcontact.contact.solution import ContactSolution, Status

LISTED = 8
"""Ends that are listed for a person."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class End:
    """Where searches ended.

    Parameters
    ----------
    solution : of the first search that ended here, not polished
    count : how many did
    first_start : number of the first start that led here, from 0
    objective : scaled, of the statement itself; zero at the contact state; None if infeasible or unbounded
    residual : of the contact conditions and equations, relative to the scales; it tells the contact state
    iterations : least and most of those who did
    """

    solution: ContactSolution
    count: int
    first_start: int
    objective: float | None
    residual: float
    iterations: tuple[int, int]

    def __repr__(self) -> str:
        """The line of `str` in brackets."""
        return f"<End: {self}>"

    def __str__(self) -> str:
        """One line: how often, where, in how many iterations."""
        least, most = self.iterations
        where = "" if self.objective is None else f"objective {self.objective:.1e}, residual {self.residual:.1e}, "
        iterations = f"{most} iteration{'s' if most != 1 else ''}" if least == most else f"{least} to {most} iterations"
        return f"{self.count} x {self.solution.status.name.lower().replace('_', ' ')}, {where}{iterations}"

    def to_dict(self) -> dict[str, Any]:
        """Give it as numbers and texts, ready for JSON."""
        numbers = ("count", "first_start", "objective", "residual")
        return {
            "status": self.solution.status.name.lower(),
            **{name: getattr(self, name) for name in numbers},
            "iterations": list(self.iterations),
            "pressure": self.solution.pressure.tolist(),
            "normal_displacement": self.solution.displacement.tolist(),
        }


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RandomStarts:
    """What was found from random starts.

    Parameters
    ----------
    formulation : name of the statement
    count, seed : of the starts
    ends : the nearest to the contact state first
    """

    formulation: str
    count: int
    seed: int
    ends: tuple[End, ...]

    @property
    def solved(self) -> int:
        """How many searches ended at a contact state."""
        return sum(end.count for end in self.ends if end.solution.status is Status.SOLVED)

    def __repr__(self) -> str:
        """One line: formulation, how many ended where they should."""
        return f"<RandomStarts of {self.formulation}: {self._head}, {len(self.ends)} distinct>"

    def __str__(self) -> str:
        """One line for each of the first ends: how often, where."""
        lines = [self._head, *map(str, self.ends[:LISTED])]
        if more := self.ends[LISTED:]:
            lines.append(f"and {len(more)} more ends, of {sum(end.count for end in more)} starts")
        return "\n".join(lines)

    @property
    def _head(self) -> str:
        states = sum(end.solution.status is Status.SOLVED for end in self.ends)
        where = "the contact state" if states <= 1 else f"a contact state, of which there are {states}"
        return f"{self.solved} of {self.count} random starts (seed {self.seed}) end at {where}"

    def to_dict(self) -> dict[str, Any]:
        """Give it as numbers, lists and texts, ready for JSON."""
        return {
            "formulation": str(self.formulation),
            "count": self.count,
            "seed": self.seed,
            "solved": self.solved,
            "ends": [end.to_dict() for end in self.ends],
        }
