"""The travelling point: where it is, what it may still spend, and what it has written down."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bemcontact.formulations.local_solver.result import LogLine, QPOptions
from bemcontact.formulations.local_solver.statement import Statement

Array = NDArray[np.float64]

STALLED = 30
"""Steps of length zero in a row after which least-index rules take over, which cannot cycle (Bland 1977)."""


@dataclass(kw_only=True)
class Progress:
    """The point of one run, with its counters; both phases move it.

    Parameters
    ----------
    statement : Statement
        The scaled problem.
    options : QPOptions
        Tolerances, limit and log.
    x, values : arrays
        The point and [x; A x].
    """

    statement: Statement
    options: QPOptions
    x: Array
    values: Array = field(init=False)
    slack: Array = field(init=False)
    limit: int = field(init=False)
    iterations: list[int] = field(default_factory=lambda: [0, 0])
    changes: int = 0
    stalled: int = 0
    lines: list[LogLine] = field(default_factory=list)

    def __post_init__(self) -> None:
        lower, upper = self.statement.lower, self.statement.upper
        size = np.maximum(
            np.where(np.isfinite(lower), np.abs(lower), 0.0), np.where(np.isfinite(upper), np.abs(upper), 0.0)
        )
        self.slack = self.options.feasibility_tolerance * np.maximum(1.0, size)
        chosen = self.options.max_iterations
        self.limit = 1000 + 20 * lower.size if chosen is None else chosen
        self.values = self.statement.values(self.x)

    @property
    def exhausted(self) -> bool:
        """Whether no iteration is left."""
        return sum(self.iterations) >= self.limit

    @property
    def least_index(self) -> bool:
        """Whether the run has stalled at a degenerate vertex, so that Bland's rules decide."""
        return self.stalled > STALLED

    def place(self, x: Array) -> None:
        """Move without a step: after a correction."""
        self.x, self.values = x, self.statement.values(x)

    def move(self, direction: Array, along: Array, step: float) -> None:
        """Take a step; `along` is [d; A d]."""
        moved = step * float(np.abs(direction).max(initial=0.0))
        self.stalled = 0 if moved > 1e-11 * max(1.0, float(np.abs(self.x).max(initial=0.0))) else self.stalled + 1
        self.x = self.x + step * direction
        self.values = self.values + step * along

    def write(
        self,
        *,
        phase: int,
        value: float,
        step: float,
        added: int | None,
        dropped: int | None,
        working: int,
        nonpositive: int,
    ) -> None:
        """Count the iteration and log it."""
        self.iterations[phase - 1] += 1
        self.changes += (added is not None) + (dropped is not None)
        line = LogLine(
            phase=phase,
            iteration=sum(self.iterations),
            value=value,
            step=step,
            added=added,
            dropped=None if dropped is None or dropped < 0 else dropped,
            working=working,
            nonpositive=nonpositive,
        )
        self.lines.append(line)
        if self.options.log is not None:
            self.options.log(line)
