"""Ends of the searches of a local solver from many random starts (multistart), and how often each was reached."""

from pydantic import computed_field

from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.frozen import frozen
from bemcontact.options import FormulationName
from bemcontact.serialization import Internal, Leaf, Vector

LISTED = 8
"""Ends that are listed for a person."""


@frozen
class SearchEnd(Leaf):
    """One end that searches from random starts reached."""

    solution: Internal[ContactSolution]
    """Solution of the first search that ended here, not polished."""
    count: int
    """Number of searches that ended here."""
    first_start: int
    """Number of the first start that led here, from 0."""
    objective: float | None
    """Objective of the statement, scaled; 0 at the contact state, null if infeasible or unbounded."""
    residual: float
    """Residual of the contact conditions and equations over the scales: about 1e-10 at the contact state."""
    iterations: tuple[int, int]
    """Least and largest number of iterations of the searches that ended here."""

    @computed_field
    @property
    def status(self) -> Status:
        """How the searches ended."""
        return self.solution.status

    @computed_field
    @property
    def pressure(self) -> Vector:
        """Pressure (n,) of the first search [p]."""
        return self.solution.pressure

    @computed_field
    @property
    def normal_displacement(self) -> Vector:
        """Normal displacement (n,) of the first search [L]."""
        return self.solution.displacement

    def __repr__(self) -> str:
        """The line of `str` in brackets."""
        return f"<SearchEnd: {self}>"

    def __str__(self) -> str:
        """One line: how often, where, in how many iterations."""
        least, most = self.iterations
        where = "" if self.objective is None else f"objective {self.objective:.1e}, residual {self.residual:.1e}, "
        iterations = f"{most} iteration{'s' if most != 1 else ''}" if least == most else f"{least} to {most} iterations"
        return f"{self.count} x {self.status.replace('_', ' ')}, {where}{iterations}"


@frozen
class RandomStarts(Leaf):
    """Searches of a local solver from random starts."""

    formulation: FormulationName
    """Statement that was searched."""
    count: int
    """Number of starts."""
    seed: int
    """Seed of the random numbers."""
    ends: tuple[SearchEnd, ...]
    """Distinct ends, the nearest to the contact state first."""

    @computed_field
    @property
    def solved(self) -> int:
        """Number of searches that ended at a contact state."""
        return sum(end.count for end in self.ends if end.status is Status.SOLVED)

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
        states = sum(end.status is Status.SOLVED for end in self.ends)
        where = "the contact state" if states <= 1 else f"a contact state, of which there are {states}"
        return f"{self.solved} of {self.count} random starts (seed {self.seed}) end at {where}"
