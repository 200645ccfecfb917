"""Phase two: from a feasible point to a stationary one, the reduced Hessian never with two non-positive eigenvalues.

Gill, Murray, Saunders and Wright, SIAM Review 33 (1991) 1-36; Gill and Wong, Math. Prog. Comp. 7 (2015) 71-112.
"""

from dataclasses import dataclass
from enum import Enum, auto
from math import sqrt

import numpy as np

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.pivoting import Block, nearest, wrong_sign
from bemcontact.formulations.local_solver.progress import Progress
from bemcontact.formulations.local_solver.reduced_hessian import ReducedHessian
from bemcontact.formulations.local_solver.working_set import FLAT, TEMPORARY, WorkingSet


class Ending(Enum):
    """Why phase two stopped."""

    STATIONARY = auto()
    UNBOUNDED = auto()
    LIMIT = auto()
    INACCURATE = auto()


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """How phase two stopped; the ray if the objective seems to fall without end."""

    ending: Ending
    ray: Array | None = None


class Descent:
    """Phase two from a feasible point.

    Parameters
    ----------
    progress : Progress
        The point; it is put on the bounds of the working set.
    working : WorkingSet
        The constraints held.

    Attributes
    ----------
    hessian : ReducedHessian
        The Hessian on what they leave free.
    value : float
        The scaled objective.
    dropped : int or None
        The constraint released for the next step.
    changed : bool
        Whether the working set has changed since the last whole Newton step.
    broken : bool
        Whether a constraint ended a step that by its normal cannot: the factors have lost too many digits.
    whole, idle : int
        Whole Newton steps in a row; releases since the last step.
    multipliers, zero : (n + r,) and (n,) arrays
        At a stationary end: those of the working set, and the size of each component of the gradient that is zero.
    """

    def __init__(self, progress: Progress, working: WorkingSet) -> None:
        self.progress = progress
        self.dropped: int | None = None
        self.changed = self.broken = False
        self.whole = self.idle = 0
        self._refused: set[int] = set()
        self.multipliers = self.zero = progress.x[:0]
        self.working = working
        self.hessian = ReducedHessian(progress.statement, working.null_space)
        for direction in self.hessian.left_over.T:
            working.fix(direction, TEMPORARY)
        progress.correct(working.onto(progress.x))
        progress.forget()
        self.value = progress.objective

    def run(self) -> Outcome:
        """Walk until no constraint can be dropped with profit, or for ever."""
        progress, working, hessian = self.progress, self.working, self.hessian
        while not self.broken:
            if hessian.pending is None and self._settled():
                newton, place = self._next(working.multipliers(progress.gradient))
                if not newton:
                    if place is None:
                        return Outcome(ending=Ending.STATIONARY)
                    if self.idle > 2 * working.number + 10:  # multipliers are noise: releases lead nowhere
                        return Outcome(ending=Ending.INACCURATE)
                    self._release(place)
            if progress.exhausted:
                return Outcome(ending=Ending.LIMIT)
            if hessian.pending is None:
                self._newton_step()
            elif (outcome := self._follow_curvature(hessian.pending)) is not None:
                return outcome
        return Outcome(ending=Ending.INACCURATE)

    def _settled(self) -> bool:
        """Whether there is no Newton step to take, as far as that can be seen without multipliers."""
        return not self.changed or self.hessian.is_stationary(self.progress.gradient, 0.1 * self.progress.zero)

    def _release(self, place: int) -> None:
        """Drop a constraint; its direction joins the null space."""
        self.dropped, direction = self.working.drop(place)
        self.hessian.enter(direction)
        self.progress.changes += self.dropped < 0
        self.changed, self.whole, self.idle = True, 0, self.idle + 1

    def _next(self, multipliers: Array) -> tuple[bool, int | None]:
        """Whether to take a Newton step; else the place of a constraint to drop, if there is one.

        First by one tolerance for all, which is quick; where that finds nothing, each component by its own, at the
        refined point. A whole Newton step ends at a stationary point: what a third one leaves over is rounding.
        """
        progress, working = self.progress, self.working
        n, least = working.free.size, progress.least_index
        loose = self.whole < 3 and working.number < n
        if loose:
            reduced = multipliers[:n] * working.free
            if reduced.dot(reduced) > (0.1 * progress.zero) ** 2:
                return True, None
        place = wrong_sign(working, self._allowed(multipliers), progress.zero, least_index=least)
        if place is not None:
            return False, place
        self._refine()
        multipliers, zero = self.multipliers, self.zero
        if loose and (np.abs(multipliers[:n] * working.free) > zero).any():
            return True, None
        zeros = np.concatenate([zero, zero.dot(np.abs(working.N))])
        return False, wrong_sign(working, self._allowed(multipliers), zeros, least_index=least)

    def _refine(self) -> None:
        """Solve the equations of the working set from the data, twice."""
        progress, working, hessian, x = self.progress, self.working, self.hessian, self.progress.x
        for _ in range(2 if hessian.size else 1):
            x = working.onto(x)
            if hessian.size:
                x = x + hessian.newton(progress.statement.H.dot(x) + progress.statement.c)
        progress.correct(x)
        self.multipliers = working.multipliers(progress.gradient, refined=True)
        self.zero = progress.fine_zero(self.multipliers[x.size :], working.W, working.N)

    def _allowed(self, multipliers: Array) -> Array:
        """Without those of refused constraints."""
        if not self._refused:
            return multipliers
        return np.where(np.isin(self.working.numbers, list(self._refused)), 0.0, multipliers)

    def _newton_step(self) -> None:
        """Towards the minimizer on the working set, as far as the constraints allow."""
        progress, working = self.progress, self.working
        direction = self.hessian.newton(progress.gradient)
        along = progress.statement.values(direction)
        slope, length = float(progress.gradient.dot(direction)), sqrt(direction.dot(direction))
        block = nearest(progress, along, length, working.held, working)
        if block is None or block.step > 1.0:
            self.changed, self.whole = False, self.whole + 1
            self._advance(along, length, 1.0, 0.5 * slope, None)
        else:
            step = block.step
            self._advance(along, length, step, step * (1.0 - 0.5 * step) * slope, block)

    def _follow_curvature(self, direction: Array) -> Outcome | None:
        """Along the direction of non-positive curvature downhill to the next constraint; None if phase two goes on."""
        progress, working = self.progress, self.working
        slope, curvature = float(progress.gradient.dot(direction)), self.hessian.curvature
        level = abs(slope) <= progress.zero and abs(slope) <= self._fine_slope(direction)
        if level and curvature == 0.0:
            working.fix(direction, FLAT)
            self.hessian.leave(direction)
            return None
        if slope > 0.0:
            direction, slope = -direction, -slope
        along = progress.statement.values(direction)
        block = nearest(progress, along, 1.0, working.held, working)
        if level and block is not None:
            back = nearest(progress, -along, 1.0, working.held, working)
            if back is None or _change(back, -slope, curvature) < _change(block, slope, curvature):
                direction, along, slope, block = -direction, -along, -slope, back
        if block is None:
            return Outcome(ending=Ending.UNBOUNDED, ray=direction)
        self._advance(along, 1.0, block.step, _change(block, slope, curvature), block)
        return None

    def _refuse(self, block: Block | None, step: float) -> None:
        """A constraint that stops the step of its own release has no multiplier to speak of until the point moves."""
        if step > 0.0:
            self._refused.clear()
        elif block is not None and block.constraint == self.dropped:
            self._refused.add(block.constraint)

    def _fine_slope(self, direction: Array) -> float:
        """The slope along a direction that counts as zero."""
        working = self.working
        of_rows = working.multipliers(self.progress.gradient)[direction.size :]
        return self.progress.level(direction, self.progress.fine_zero(of_rows, working.W, working.N))

    def _advance(self, along: Array, length: float, step: float, change: float, block: Block | None) -> None:
        """Take the step, by which the objective changes, and the constraint that ended it."""
        progress, working, hessian = self.progress, self.working, self.hessian
        nonpositive, added = int(hessian.pending is not None), None
        progress.move(along, step, length)
        progress.look()
        if self._refused or step <= 0.0:
            self._refuse(block, step)
        if block is not None:
            self.changed, self.whole, added = True, 0, block.constraint
            normal = working.add(added, block.side)
            if normal is None:
                self.broken = True
            else:
                hessian.leave(normal)
                if hessian.size and added < normal.size:
                    hessian.clear(added)
        self.value += change
        progress.write(2, self.value / progress.unit, step, added, self.dropped, working.number, nonpositive)
        self.dropped, self.idle = None, 0


def _change(block: Block, slope: float, curvature: float) -> float:
    """Of the objective, from here to where the step ends."""
    return block.step * (slope + 0.5 * block.step * curvature)
