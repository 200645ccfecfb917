"""The current point of a run, with its tolerances, the number of iterations, and the log."""

from dataclasses import dataclass, field
from math import sqrt

import numpy as np

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.factorizations import dot
from bemcontact.formulations.local_solver.result import LogLine, QPOptions
from bemcontact.formulations.local_solver.statement import EPS, Statement, largest

FINE = 1e-3
"""Factor of the optimality tolerance where each component is compared with its own terms."""

NEAR = 2e-3
"""Part of the tolerance of a constraint that may be rounding of a point of which the gradient is known to `FINE`."""

PARALLEL = 1e-10
"""A unit direction whose product with a normal is below this does not meet the constraint, except on a long step."""

OWN, OF_TERMS = 1e-7, 1e-3
"""Largest violation of a constraint at a claim, relative to its own bound or to a part of its terms."""

FINER = 1e-2
"""Factor of tolerances of phase one and of constraints after each claim that failed."""

LOST = EPS
"""A component that was never larger than this, relative to the point or to one, is the rounding of directions."""

WORN = 16.0
"""Size of a component before, relative to now or to one, from which its rounding counts."""

DRIFT = 100.0
"""A point may have lost so many times the rounding of the farthest point on the way to it."""

MANY = 100
"""Largest number of points that are stored before `traveled` is updated."""

STALLED = 100
"""Number of steps of length zero in sequence after which least-index rules are used, which never cycle (Bland 1977)."""


@dataclass(kw_only=True)
class SearchState:
    """The current point of a run and its counters; both phases change it.

    Parameters
    ----------
    unit : scaled objective over that of the data
    long : length of a step on which the products that count as none may violate a constraint
    farthest : distance from zero beyond which rounding is more than a small part of a tolerance
    x, values, gradient : the point (n,), [x; A x] (n + m,), and H x + c (n,)
    slack : (n + m,) tolerance of each constraint: relative to its smaller bound, and no less than the rounding of A x
    lowest, highest : (n + m,) bounds with their tolerances added
    by_numba : whether machine code took iterations
    far : no less than the largest distance from zero so far
    zero : size of a gradient or multiplier that counts as zero: relative to its terms
    """

    statement: Statement
    options: QPOptions
    unit: float
    x: Array
    values: Array = field(init=False)
    gradient: Array = field(init=False)
    zero: float = field(init=False)
    far: float = field(init=False)
    slack: Array = field(init=False)
    lowest: Array = field(init=False)
    highest: Array = field(init=False)
    limit: int = field(init=False)
    long: float = field(init=False)
    changes: int = 0
    stalled: int = 0
    by_numba: bool = False
    lines: list[LogLine] = field(default_factory=list)
    _usual: tuple[Array, Array, Array] | None = field(init=False, repr=False)

    def __post_init__(self) -> None:
        statement, options = self.statement, self.options
        feasible, chosen = float(options.feasibility_tolerance), options.max_iterations
        self._part, self.least_terms = 1.0 / self.x.size, max(statement.slope, 1e-3)
        self.tolerance, self.rounding = float(options.optimality_tolerance), 100.0 * EPS * statement.row_sum
        self.long, self.farthest = feasible / PARALLEL, feasible / (DRIFT * EPS)
        self._slack = feasible * np.maximum(1.0, statement.bound_size)
        self._least_slack, self._usual = feasible, None
        self.limit = 1000 + 20 * statement.lower.size if chosen is None else int(chosen)
        self._traveled, self._passed, self._seen, self.far = np.zeros(self.x.size), [], None, 0.0
        self._measured, self._violation = None, self._traveled
        self.place(self.x)

    @property
    def traveled(self) -> Array:
        """Largest absolute value of each component so far (n,); it bounds the rounding of the component."""
        if self._passed:
            self._take_in()
        return self._traveled

    def _take_in(self) -> None:
        """Update `traveled` with the stored points."""
        passed = np.abs(np.array(self._passed))
        self._traveled = np.maximum(self._traveled, np.maximum.reduce(passed))
        self._passed.clear()

    def forget(self) -> None:
        """Reset `traveled` and `far` after the point was computed anew from the data."""
        size = np.maximum(np.abs(self.x), 1.0)
        self._traveled = np.minimum(self.traveled, size)
        self.far = min(self.far, sqrt(dot(size, size)))
        self.zero = max(self.tolerance * self._terms, self.rounding * self.far)

    @property
    def exact_values(self) -> Array:
        """[x; A x] of the point, not of steps to it (n + m,)."""
        return self.statement.values(self.x) if self._steps else self.values

    @property
    def violation(self) -> Array:
        """`Statement.violation` of the values, computed once for a point."""
        if self._measured is not self.values:
            self._measured, self._violation = self.values, self.statement.violation(self.values)
        return self._violation

    @property
    def worn(self) -> bool:
        """Whether the point is much nearer than others before it, whose rounding counts."""
        if self.far <= WORN:
            return False
        return bool(np.count_nonzero(self.traveled > WORN * np.maximum(np.abs(self.x), 1.0)))

    @property
    def drifted(self) -> bool:
        """Whether steps from far away may have left more than a small part of a tolerance since `place`."""
        return self._steps and self.far > self.farthest

    def loses_digits(self, x: Array) -> bool:
        """Whether rounding of this point or of one before it is more than a small part of a tolerance."""
        return max(self.far, sqrt(dot(x, x))) > self.farthest

    @property
    def sharp(self) -> Array:
        """Distance of each constraint from its bound that may be rounding (n + m,)."""
        return np.maximum(NEAR * self._slack, 100.0 * EPS * self._terms_of_values())

    def allowed(self, sharp: Array) -> Array:
        """Violation of each constraint that a claim may leave (n + m,): a small part of its own terms, or `sharp`."""
        own = OWN * np.maximum(self.statement.bound_size, OF_TERMS * self._terms_of_values())
        return np.minimum(2.0 * self.slack, np.maximum(own, sharp))

    def _terms_of_values(self) -> Array:
        """Sum of the sizes of the terms of each value (n + m,)."""
        return self._placed if not self._steps else self.statement.terms(np.abs(self.x))

    def tighten(self) -> None:
        """Reduce the tolerance of the constraints, after a claim failed."""
        self._slack, self._least_slack, self._usual = FINER * self._slack, FINER * self._least_slack, None
        self.place(self.x)

    @property
    def objective(self) -> float:
        """cᵀx + xᵀHx/2."""
        return 0.5 * dot(self.x, self.gradient + self.statement.c)

    def terms(self, of_rows: Array, rows: Array) -> Array:
        """Sum of the sizes of the terms of each component of the gradient (n,), multipliers of the rows included.

        A component that is zero in truth is rounding of the points before it, and counts with its size.
        """
        terms = self.statement.curved(np.maximum(np.abs(self.x), EPS * self.traveled)) + self.statement.absolute[1]
        return terms + np.abs(of_rows).dot(np.abs(rows)) if of_rows.size else terms

    def fine_zero(self, terms: Array, rows: Array, inverse: Array, reach: Array) -> Array:
        """Size of each component of the gradient that counts as zero, then of each multiplier of rows (n + r,).

        The variables may differ in size by many orders, so each component has its own tolerance, relative to its own
        terms. Rounding in one component changes the multipliers of the rows (r, n) by their right inverse (n, r), and
        so other components.
        """
        lost, fine = self.lost(terms, reach), FINE * self.options.optimality_tolerance * terms
        if not rows.size:
            return np.maximum(fine, 100.0 * lost)
        N = np.abs(inverse)
        of_rows = lost.dot(N)
        lost += of_rows.dot(np.abs(rows))
        return np.maximum(np.concatenate([fine, fine.dot(N)]), 100.0 * np.concatenate([lost, of_rows]))

    def lost(self, terms: Array, reach: Array) -> Array:
        """Rounding of each component of the gradient (n,) if the point has that of numbers of the size `reach` (n,)."""
        return EPS * np.maximum(terms, self.statement.curved(np.maximum(self._rounded, reach)))

    @property
    def _rounded(self) -> Array:
        """Size of the numbers whose rounding each component has (n,): faint components have no digit."""
        size = self.traveled
        return np.where(size <= LOST * max(self.far, 1.0), size / EPS, size)

    def terms_so_far(self, of_rows: Array) -> Array:
        """Largest sum of the terms of each component of the gradient (n,) so far, which bounds its rounding.

        Terms of multipliers of rows, of the sizes `of_rows` (m,), are included.
        """
        _, linear, rows = self.statement.absolute
        return self.statement.curved(self._rounded) + linear + of_rows.dot(rows)

    def level(self, direction: Array, zero: Array) -> float:
        """Size of a slope along a direction that counts as zero, from that of each component of the gradient (n,)."""
        size = np.abs(direction)
        rounding = 10.0 * EPS * largest(direction) * float(np.abs(self.gradient).dot(size > 0.0))
        return float(size.dot(zero)) + rounding

    @property
    def exhausted(self) -> bool:
        """Whether no iteration is left."""
        return len(self.lines) >= self.limit

    @property
    def least_index(self) -> bool:
        """Whether the run has stalled at a degenerate vertex, so that Bland's rules decide."""
        return self.stalled > STALLED

    def place(self, x: Array) -> None:
        """Move to a point, and compute values, slacks and gradient there."""
        self.x, self.values, self._steps = x, self.statement.values(x), False
        size = np.abs(x)
        self._traveled = np.maximum(self.traveled, size)
        self.far = max(self.far, sqrt(dot(x, x)))
        self._placed = self.statement.terms(size)
        self._allow()
        self._evaluate()

    def _allow(self) -> None:
        """Set the slacks, and the bounds with them; they are the usual ones where rounding is smaller."""
        small = 10.0 * EPS * self._placed.item(self._placed.argmax()) <= self._least_slack
        if self._usual is not None and small:
            self.slack, self.lowest, self.highest = self._usual
            return
        lower, upper = self.statement.lower, self.statement.upper
        self.slack = np.maximum(self._slack, 10.0 * EPS * self._placed)
        self.lowest, self.highest = lower - self.slack, upper + self.slack
        if small:
            self._usual = self.slack, self.lowest, self.highest

    def move(self, along: Array, step: float, length: float) -> None:
        """Take a step; `along` is [d; A d], `length` that of the direction. The gradient waits for `look`."""
        self.stalled = 0 if step * length > 1e-11 else self.stalled + 1
        if step > 0.0:
            self._steps = True
            self.far += step * length
            self.values = self.values + (along if step == 1.0 else step * along)
            self.x = self.values[: self.x.size]

    def look(self) -> None:
        """Compute the gradient at the point, unless it is known."""
        if self._seen is self.x:
            return
        self._passed.append(self.x)
        if len(self._passed) > MANY:
            self._take_in()
        self._evaluate()

    def _evaluate(self) -> None:
        """Compute the gradient, and what counts as zero beside its terms."""
        product = self.statement.bent(self.x)
        self._seen, self.gradient = self.x, product + self.statement.c
        self._terms = max(sqrt(dot(product, product) * self._part), self.least_terms)
        self.zero = max(self.tolerance * self._terms, self.rounding * self.far)

    def take_over(self, x: Array, log: Array, first: int) -> None:
        """Go on from a point that machine code has reached; the first of its iterations are of phase one.

        Its `log` (6, count) has values and steps, then the constraints that entered and left (negative for none), and
        the rest of each line.
        """
        log[0, first:] /= self.unit
        (values, steps), whole = log[:2].tolist(), log[2:].astype(int).tolist()
        entered, left = ([None if number < 0 else number for number in numbers] for numbers in whole[:2])
        count, begin = len(values), len(self.lines)
        phases, numbers = [1] * first + [2] * (count - first), range(begin + 1, begin + 1 + count)
        self.lines += map(LogLine._make, zip(phases, numbers, values, steps, entered, left, *whole[2:], strict=True))
        self.changes += 2 * count - entered.count(None) - left.count(None)
        if self.options.log is not None:
            for line in self.lines[begin:]:
                self.options.log(line)
        self.stalled, self.by_numba = 0, True
        self.place(x)

    def write(
        self,
        phase: int,
        value: float,
        step: float,
        added: int | None,
        dropped: int | None,
        working: int,
        nonpositive: int,
    ) -> None:
        """Count the iteration and log it, as a `LogLine`."""
        self.changes += (added is not None) + (dropped is not None)
        real = None if dropped is None or dropped < 0 else dropped
        line = LogLine(phase, len(self.lines) + 1, value, step, added, real, working, nonpositive)
        self.lines.append(line)
        if self.options.log is not None:
            self.options.log(line)
