"""Phase two: from a feasible point to a stationary one, the reduced Hessian never with two non-positive eigenvalues.

The reduced Hessian is that on the null space of the working set. A conjugate basis Z of this space is kept, and at most
one direction d of no positive curvature, which is called pending:

    Zᵀ H Z = I,   Zᵀ H d = 0,   dᵀ H d <= 0.

Any rotation of the columns of Z keeps this, so that a reflection lets a constraint enter. A direction that becomes free
is made conjugate to the others. No other direction is let in while one is pending (Gill, Murray, Saunders and Wright,
SIAM Review 33 (1991) 1-36; Gill and Wong, Math. Prog. Comp. 7 (2015) 71-112).
"""

from enum import Enum, auto
from functools import lru_cache
from math import sqrt

import numpy as np

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.factorizations import add_rank_one, dot, over_triangle, pivoted_cholesky
from bemcontact.formulations.local_solver.optimality import SEEN
from bemcontact.formulations.local_solver.progress import FINE, SearchState
from bemcontact.formulations.local_solver.ratio_test import BlockingConstraint, nearest
from bemcontact.formulations.local_solver.statement import EPS, Statement, largest
from bemcontact.formulations.local_solver.steepest_edge import SteepestEdge
from bemcontact.formulations.local_solver.working_set import FLAT, TEMPORARY, WorkingSet, wrong_sign
from bemcontact.frozen import frozen_value

REFINEMENTS = 4
"""Largest number of steps of refinement."""
ROUNDED = 4.0 * EPS / SEEN
"""Size of a component that is zero in truth, over the numbers whose rounding it is."""
CLEAR = 1e3
"""A multiplier of the wrong sign is released without refinement if it exceeds the zero of all by this factor."""
SHRINKS, CONJUGATE = 0.25, 0.1
"""A whole Newton step after another one has at most the first part of its slope, unless Z is worn: entries of ZᵀHZ then
differ from those of the identity by more than the second number."""
WORTH_EDGES = 250
"""Number of variables from which iterations saved by steepest-edge pricing are worth its time."""


class ReducedHessian:
    """A conjugate basis of the null space, changed in place by `enter` and `leave`.

    Attributes
    ----------
    Z : (n, k) conjugate basis
    left_over : (n, t) orthonormal directions of the start in which the Hessian is not positive definite; to be fixed
    pending : (n,) unit direction of no positive curvature, or None
    curvature : dᵀHd of the pending direction; exactly zero where it is rounding
    """

    def __init__(self, statement: Statement, null_space: Array) -> None:
        n, k = null_space.shape
        self.statement = statement
        self._top = largest(statement.absolute[0])
        self._columns = np.zeros((n, n), order="F")
        self.left_over = null_space[:, :0]
        self._resize(0)
        self.pending: Array | None = None
        self.curvature = 0.0
        if k:
            reduced = _on_basis(statement.H, null_space)
            zero = 10.0 * max(10, n) * EPS * self._top
            factor, order, rank = pivoted_cholesky(reduced, zero)
            ordered = null_space[:, order]
            self.left_over = ordered[:, rank:]
            self._resize(rank)
            self.Z[:] = over_triangle(ordered[:, :rank], factor, transposed=False)

    def _resize(self, size: int) -> None:
        """Set the view on the leading columns."""
        self.size, self.Z, self._last_slopes = size, self._columns[:, :size], None

    def slopes(self, gradient: Array) -> Array:
        """Products Zᵀg (k,), computed once for a gradient."""
        if self._last_slopes is None or self._last_slopes[0] is not gradient:
            self._last_slopes = gradient, gradient.dot(self.Z)
        return self._last_slopes[1]

    def newton(self, gradient: Array) -> Array:
        """Newton step -Z Zᵀg to the minimizer on the working set."""
        return -self.Z.dot(self.slopes(gradient))

    def is_stationary(self, gradient: Array, zero: float) -> bool:
        """Whether the reduced gradient is surely below `zero`, by the bound |gᵀZ|² |H|."""
        if self.size == 0:
            return True
        slopes = self.slopes(gradient)
        return dot(slopes, slopes) * self._top * gradient.size <= zero**2

    def is_conjugate(self) -> bool:
        """Whether ZᵀHZ = I up to what Newton steps bear: O(n k²)."""
        product = self.Z.T.dot(self.statement.bent(self.Z))
        product.reshape(-1)[:: self.size + 1] -= 1.0
        return largest(product) <= CONJUGATE

    def enter(self, direction: Array) -> None:
        """Add a unit direction to the null space, to Z or as the pending one: O(n²)."""
        d, statement, Z = direction, self.statement, self.Z
        product = statement.bent(d)
        curvature = dot(d, product)
        length = 1.0
        for _ in range(2 if self.size else 0):
            d = d - Z.dot(product.dot(Z))
            product = statement.bent(d)
            before, curvature = curvature, dot(d, product)
            if abs(curvature) > 0.01 * abs(before):
                break  # no digits were lost that a second pass would restore
        if self.size:
            length = dot(d, d)
        clear = curvature == 0.0 or abs(curvature) > 1e-8 * self._top * length
        rounding = 0.0 if clear else self.statement.rounding(d)
        if curvature > rounding:
            self._columns[:, self.size] = d / sqrt(curvature)
            self._resize(self.size + 1)
        else:
            self.pending = d if length == 1.0 else d / sqrt(length)
            self.curvature = curvature / length if curvature < -rounding else 0.0

    def leave(self, normal: Array, variable: int | None = None) -> Array | None:
        """Remove the part of the null space along the normal of a constraint that enters the working set: O(n²).

        The normal may be that of a variable. The result is the direction (n,) by which the span of Z is reduced, if
        nothing else has changed.
        """
        pending, self.pending = self.pending, None
        if self.size == 0:
            return None
        if self.size == 1 and pending is None:
            self._resize(0)
            return self._columns[:, 0]
        along = normal.dot(self.Z) if variable is None else self.Z[variable].copy()
        length = sqrt(dot(along, along))
        if length == 0.0:
            return None
        last = self._reflect(along, length)
        if pending is None:
            return last
        rest = length * pending - dot(normal, pending) * last
        self.enter(rest / sqrt(dot(rest, rest)))
        return None

    def _reflect(self, along: Array, length: float) -> Array:
        """Reflect Z so that the normal is orthogonal to all columns but the last; remove and return that column."""
        sign = -1.0 if along[-1] > 0.0 else 1.0
        along[-1] -= sign * length
        add_rank_one(self.Z, -2.0 / dot(along, along), self.Z.dot(along), along)
        self._resize(self.size - 1)
        return sign * self._columns[:, self.size]

    def rounding(self, direction: Array) -> Array:
        """Rounding of each component of a direction that was made conjugate to Z (n,)."""
        size, Z = np.abs(direction), np.abs(self.Z)
        return EPS * (size + Z.dot(self.statement.curved(size).dot(Z)))

    def clear(self, variable: int) -> None:
        """Set the component of a fixed variable to zero in all directions."""
        self.Z[variable], self._last_slopes = 0.0, None
        if self.pending is not None:
            self.pending[variable] = 0.0


class Ending(Enum):
    """Why phase two stopped."""

    STATIONARY = auto()
    UNBOUNDED = auto()
    LIMIT = auto()
    INACCURATE = auto()


@frozen_value
class PhaseTwoEnd:
    """How phase two stopped, and a ray (n,) if the objective seems to be unbounded."""

    ending: Ending
    ray: Array | None = None


class Descent:
    """Phase two from a feasible point, which is put on the bounds of the working set.

    Attributes
    ----------
    hessian : Hessian on what the constraints leave free
    value : scaled objective
    dropped : the constraint released for the next step, or None
    changed : whether the working set has changed since the last whole Newton step
    broken, worn : whether the factors have lost too many digits: a constraint ended a step that by its normal cannot,
        or Z is no longer conjugate
    whole, idle : number of consecutive full Newton steps; number of releases since the last step
    multipliers, zeros : (n + r,) at a stationary end: multipliers of the working set, and the size of each that counts
        as zero; those of the variables are components of the gradient
    """

    def __init__(self, progress: SearchState, working: WorkingSet) -> None:
        self.progress = progress
        self.dropped: int | None = None
        self.changed = self.broken = self.worn = False
        self.whole = self.idle = 0
        self._moved = self._fall = 0.0
        self._known: tuple[Array, Array, Array, Array] | None = None
        self._refused: set[int] = set()
        self._edges: SteepestEdge | None = None
        self._by_edges = progress.x.size > WORTH_EDGES
        self.multipliers = self.zeros = self._refinement = progress.x[:0]
        self.working = working
        self.hessian = ReducedHessian(progress.statement, working.null_space)
        for direction in self.hessian.left_over.T:
            working.fix(direction, TEMPORARY)
        near = working.onto(progress.x)
        if progress.lines or np.count_nonzero(near != progress.x):  # else it is the start, which has been placed
            progress.place(near)
            progress.forget()
        self.value = progress.objective

    def run(self) -> PhaseTwoEnd:
        """Iterate until no release of a constraint reduces the objective, or until another ending."""
        progress, working, hessian = self.progress, self.working, self.hessian
        while not (self.broken or self.worn):
            if hessian.pending is None and self._settled():
                newton, place = self._next(working.multipliers(progress.gradient))
                if not newton:
                    noise = self.idle > 2 * working.number + 10  # of the multipliers: releases lead nowhere
                    if place is None or noise:
                        return PhaseTwoEnd(ending=Ending.STATIONARY)
                    self._release(place)
            if progress.exhausted:
                return PhaseTwoEnd(ending=Ending.LIMIT)
            if hessian.pending is None:
                self._newton_step()
            elif (outcome := self._follow_curvature(hessian.pending)) is not None:
                return outcome
        return PhaseTwoEnd(ending=Ending.INACCURATE)

    def _settled(self) -> bool:
        """Whether no Newton step is needed, by a test without multipliers."""
        return not self.changed or self.hessian.is_stationary(self.progress.gradient, 0.1 * self.progress.zero)

    def _release(self, place: int) -> None:
        """Drop a constraint and add its direction to the null space."""
        self.dropped, direction = self.working.drop(place)
        self.hessian.enter(direction)
        self.progress.changes += self.dropped < 0
        self.changed, self.whole, self.idle = True, 0, self.idle + 1
        if self.hessian.pending is not None:  # curvatures say nothing where the form is not definite
            self._edges, self._by_edges = None, False
        elif self._edges and not self._edges.follow_release(self.dropped, self.hessian.Z[:, -1]):
            self._edges = None

    def _next(self, multipliers: Array) -> tuple[bool, int | None]:
        """Whether to take a Newton step, and if not, the place of a constraint to drop, if there is one."""
        # A quick test uses one tolerance for all components, the next the terms of each. If both find nothing clear,
        # the point is refined, and each component has its own tolerance. After three full Newton steps the remaining
        # reduced gradient is rounding.
        progress, working, hessian = self.progress, self.working, self.hessian
        n, least = working.free.size, progress.least_index
        loose = self.whole < 3 and working.number < n
        reduced = multipliers[:n] * working.free
        square = dot(reduced, reduced)
        if loose:
            large = square > (0.1 * progress.zero) ** 2 and square > (10.0 * EPS * largest(multipliers[n:])) ** 2
            if large and not self._rests(hessian.newton(progress.gradient)):
                return True, None
        place = self._clearly_wrong(self._allowed(multipliers))
        if place is None:
            place = self._wrong_by_own_terms(multipliers, sqrt(square))
        if place is not None:
            return False, place
        self._refine()
        multipliers, zeros = self.multipliers, self.zeros
        large = loose and np.count_nonzero(np.abs(multipliers[:n] * working.free) > zeros[:n])
        if large and not self._rests(hessian.newton(progress.gradient)):
            return True, None
        place = wrong_sign(working, self._allowed(multipliers), zeros, least_index=least)
        if place is None and self._sharpened():
            place = wrong_sign(working, self._allowed(multipliers), zeros, least_index=least)
        return False, place

    def _clearly_wrong(self, multipliers: Array) -> int | None:
        """The place of a constraint whose multiplier has a wrong sign beyond all rounding."""
        # N carries the rounding of the gradient to multipliers
        working, zero, n = self.working, self.progress.zero, self.working.free.size
        least, inverse = self.progress.least_index, working.inverse
        place = wrong_sign(working, multipliers, CLEAR * zero, least_index=least)
        if place is None or not working.size or (place >= n and working.ids[place - n] == TEMPORARY):
            return place
        if not inverse.is_below(abs(multipliers.item(place)) / zero):
            return None
        if not self._by_edges or working.temporary or least:
            return place
        curvatures = self._curvatures()
        edge = wrong_sign(working, multipliers, CLEAR * zero, least_index=False, curvatures=curvatures)
        if edge is None or inverse.is_below(abs(multipliers.item(edge)) / zero):
            return edge
        above = max(CLEAR, inverse.largest) * zero
        return wrong_sign(working, multipliers, above, least_index=False, curvatures=curvatures)

    def _wrong_by_own_terms(self, multipliers: Array, reduced: float) -> int | None:
        """As `_clearly_wrong`, with a zero for each multiplier: its terms may be far smaller than those of others.

        `reduced` is the length of the reduced gradient. What N makes of the rounding of the gradient is sampled, its
        own rounding is seen from a refinement.
        """
        progress, working = self.progress, self.working
        n, least = working.free.size, progress.least_index
        if wrong_sign(working, self._allowed(multipliers), reduced, least_index=False) is None:
            return None
        refined = working.refined(multipliers)
        terms = progress.terms_so_far(np.abs(working.of_all(refined)[n:]))
        zeros = 100.0 * EPS * np.maximum(*(np.abs(working.multipliers(terms * phase)) for phase in _phases(n).T))
        zeros[:n] = np.maximum(zeros[:n], max(FINE * progress.tolerance, 100.0 * EPS) * terms)
        zeros = np.maximum(CLEAR * np.maximum(zeros, np.abs(refined - multipliers)), reduced)
        curvatures = self._curvatures() if self._by_edges and not working.temporary and not least else None
        return wrong_sign(working, self._allowed(refined), zeros, least_index=least, curvatures=curvatures)

    def _curvatures(self) -> Array:
        """The curvatures of the edges of the working set (n + r,)."""
        if self._edges is None:
            self._edges = SteepestEdge(self.progress.statement, self.working, self.hessian.Z)
        return self._edges.curvatures

    def _rests(self, step: Array) -> bool:
        """Whether a step from the start is no more than rounding, since the start is an answer of this solver."""
        progress, working = self.progress, self.working
        if progress.lines:
            return False
        terms = progress.terms(working.multipliers(progress.gradient)[step.size :], working.W)
        rounding = 10.0 * EPS * np.maximum(np.abs(progress.x), self._reach(terms))
        return np.count_nonzero(np.abs(step) > np.maximum(rounding, self._moved)) == 0

    def _refine(self) -> None:
        """Solve the equations of the working set again from the data, by two steps of refinement, or a few more."""
        progress, working, hessian, x = self.progress, self.working, self.hessian, self.progress.x
        self._moved = 0.0
        for _ in range(REFINEMENTS if hessian.size else 1):
            x = working.onto(x)
            if hessian.size:
                step = hessian.newton(working.reduced(progress.statement.bent(x) + progress.statement.c))
                x, self._moved = x + step, largest(step)
                if self._moved <= 1e-14 * max(1.0, largest(x)):
                    break
        progress.place(x)
        once = working.multipliers(progress.gradient, refined=True)
        self.multipliers = working.refined(once)
        self._refinement = np.abs(self.multipliers - once)
        self.zeros = self._fine_zero() + self._refinement

    def _sharpened(self) -> bool:
        """Compute `zeros` of fixed variables with wrong signs from the directions that release them.

        Nearly dependent rows have multipliers with large rounding, but along these directions much of it cancels.
        """
        working, n = self.working, self.progress.x.size
        excess = working.signs[:n] * self.multipliers[:n]
        if working.size == 0 or excess.item(excess.argmax()) <= 0.0:
            return False
        terms, reach = self._terms_and_reach()
        fine = max(FINE * self.progress.options.optimality_tolerance, 100.0 * EPS) * terms
        wrong = (excess > fine).nonzero()[0]
        if wrong.size == 0:
            return False
        released = working.N.dot(working.W[:, wrong])
        released[wrong, np.arange(wrong.size)] -= 1.0
        lost = 100.0 * self.progress.lost(terms, reach).dot(np.abs(released))
        self.zeros[wrong] = np.minimum(self.zeros[wrong], np.maximum(fine[wrong], lost) + self._refinement[wrong])
        return True

    def _allowed(self, multipliers: Array) -> Array:
        """Multipliers (n + r,) with zeros for refused constraints."""
        if not self._refused:
            return multipliers
        return np.where(np.isin(self.working.numbers, list(self._refused)), 0.0, multipliers)

    def _newton_step(self) -> None:
        """Step towards the minimizer on the working set, as far as the constraints allow."""
        progress, working = self.progress, self.working
        direction = self.hessian.newton(progress.gradient)
        along = working.values(direction)
        slope, length = dot(progress.gradient, direction), sqrt(dot(direction, direction))
        block = nearest(progress, along, length, working.held, working)
        if block is None or block.step > 1.0:
            self.worn = self.whole > 0 and slope < SHRINKS * self._fall and not self.hessian.is_conjugate()
            if self.worn:
                return
            self.changed, self.whole, self._fall = False, self.whole + 1, slope
            if self._rests(direction):
                return
            self._advance(along, length, 1.0, 0.5 * slope, None)
        else:
            step = block.step
            self._advance(along, length, step, step * (1.0 - 0.5 * step) * slope, block)

    def _follow_curvature(self, direction: Array) -> PhaseTwoEnd | None:
        """Step along the pending direction downhill to the next constraint; None if phase two goes on."""
        progress = self.progress
        slope, curvature = dot(progress.gradient, direction), self.hessian.curvature
        level = abs(slope) <= progress.zero and abs(slope) <= self._fine_slope(direction)
        if level and curvature == 0.0:
            self.working.fix(direction, FLAT)
            self.hessian.leave(direction)
            return None
        if slope > 0.0:
            direction, slope = -direction, -slope
        along = self.working.values(direction)
        block = self._met(direction, along)
        if level and block is not None:
            back = self._met(direction, -along)
            if back is None or _change(back, -slope, curvature) < _change(block, slope, curvature):
                direction, along, slope, block = -direction, -along, -slope, back
        if block is None:
            return PhaseTwoEnd(ending=Ending.UNBOUNDED, ray=direction)
        self._advance(along, 1.0, block.step, _change(block, slope, curvature), block)
        return None

    def _met(self, direction: Array, along: Array) -> BlockingConstraint | None:
        """The constraint met along the pending direction; a far one only if more than rounding of this moves it."""
        progress, working = self.progress, self.working
        block = nearest(progress, along, 1.0, working.held, working)
        if block is None or block.step <= progress.long:
            return block
        rounding = self.hessian.rounding(direction)
        speed = np.concatenate([rounding, progress.statement.absolute[2].dot(rounding)])
        return nearest(progress, along, 1.0, working.held | (np.abs(along) <= speed), working)

    def _refuse(self, block: BlockingConstraint | None, step: float) -> None:
        """Refuse a constraint that blocks the step of its own release, until the point moves."""
        if step > 0.0:
            self._refused.clear()
        elif block is not None and block.constraint == self.dropped:
            self._refused.add(block.constraint)

    def _fine_slope(self, direction: Array) -> float:
        """The slope along a direction of the null space that counts as zero."""
        n, working, progress = direction.size, self.working, self.progress
        terms = progress.terms(working.multipliers(progress.gradient)[n:], working.W)
        no_rows = working.W[:0]  # errors of their multipliers do not change this slope
        return progress.level(direction, progress.fine_zero(terms, no_rows, no_rows.T, self._reach(terms)))

    @property
    def sizes(self) -> Array:
        """Sum of the terms of each component of the gradient and of each multiplier of rows (n + r,).

        A component that is zero in truth is what rounding leaves of multipliers and of the point.
        """
        progress, working = self.progress, self.working
        terms, reach = self._terms_and_reach()
        of_rows = terms.dot(np.abs(working.N))
        rounded = of_rows.dot(np.abs(working.W)) + progress.statement.curved(reach)
        return np.concatenate([np.maximum(terms, ROUNDED * rounded), of_rows])

    def _fine_zero(self) -> Array:
        """Size of each component of the gradient and of each multiplier of rows that counts as zero (n + r,)."""
        terms, reach = self._terms_and_reach()
        return self.progress.fine_zero(terms, self.working.W, self.working.N, reach)

    def _terms_and_reach(self) -> tuple[Array, Array]:
        """Sizes of the terms of the gradient with the multipliers (n,), and `_reach`; once for a point."""
        progress = self.progress
        if self._known is None or self._known[0] is not progress.x or self._known[1] is not self.multipliers:
            terms = progress.terms(self.multipliers[progress.x.size :], self.working.W)
            self._known = progress.x, self.multipliers, terms, self._reach(terms)
        return self._known[2:]

    def _reach(self, terms: Array) -> Array:
        """Size of the numbers whose rounding each component of the point has (n,), estimated by a sample.

        `terms` (n,) are those of the gradient.
        """
        # A Newton step has the rounding of the gradient. Each row is satisfied up to the rounding of its terms, on the
        # way to the point too. A change of the rows moves the point by N and by a Newton step. Terms and rows change
        # with irregular phases, since with signs the movements by several rows of whole numbers can cancel.
        working, hessian, size = self.working, self.hessian, self.progress.traveled
        Z, moved = hessian.Z, np.zeros((size.size, 2))
        if working.size:
            moved = working.N.dot(np.abs(working.W).dot(size)[:, None] * _phases(working.size))
            if hessian.size:
                moved -= Z.dot(Z.T.dot(self.progress.statement.bent(moved)))
        if hessian.size:
            moved = np.hypot(moved, Z.dot(Z.T.dot(terms[:, None] * _phases(size.size))))
        return np.hypot(moved[:, 0], moved[:, 1])

    def _advance(
        self, along: Array, length: float, step: float, change: float, block: BlockingConstraint | None
    ) -> None:
        """Take a step that changes the objective by `change`, and add the constraint that blocks it."""
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
                removed = hessian.leave(normal, added if added < normal.size else None)
                if self._edges and removed is not None:
                    self._edges.follow_entry(removed)
                else:
                    self._edges = None
                if hessian.size and added < normal.size:
                    hessian.clear(added)
        self.value += change
        progress.write(2, self.value / progress.unit, step, added, self.dropped, working.number, nonpositive)
        self.dropped, self.idle = None, 0


def _on_basis(H: Array, basis: Array) -> Array:
    """The form H on a basis (n, k); entries of H where the basis has unit vectors of variables."""
    if np.count_nonzero(basis) == basis.shape[1] == basis.sum():
        variables = basis.argmax(axis=0)
        return H[variables[:, None], variables]
    return basis.T @ H @ basis


@lru_cache(maxsize=64)
def _phases(count: int) -> Array:
    """Cosines and sines (count, 2) of irregular angles."""
    angles = np.square(np.arange(count, dtype=float))
    return np.array([np.cos(angles), np.sin(angles)]).T


def _change(block: BlockingConstraint, slope: float, curvature: float) -> float:
    """Change of the objective up to the end of the step."""
    return block.step * (slope + 0.5 * block.step * curvature)
