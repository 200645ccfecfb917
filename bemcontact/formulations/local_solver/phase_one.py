"""Phase one: reduce the sum of infeasibilities to zero, or to a minimum that proves infeasibility.

A steepest descent in the null space of the working set; constraints that are satisfied stay so, violated ones may pass
through their bounds as long as the sum still falls (breakpoints of a piecewise linear function).
"""

from math import sqrt

import numpy as np

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.factorizations import dot
from bemcontact.formulations.local_solver.progress import SearchState
from bemcontact.formulations.local_solver.ratio_test import BlockingConstraint, nearest, side_reached
from bemcontact.formulations.local_solver.statement import INFINITY, Sides, Statement
from bemcontact.formulations.local_solver.working_set import WorkingSet, wrong_sign


def reach_feasibility(progress: SearchState, sides: Sides, fineness: float) -> tuple[WorkingSet, Array | None]:
    """Find a feasible point, from a working set (n + m,).

    `fineness` is the part of the optimality tolerance that counts; it is less where a certificate was refused before.
    The result is the working set at the end, with all equalities and the null space where the point is feasible, and
    Farkas multipliers (n + m,) in scaled units where the sum cannot be reduced; they are to be verified.
    """
    statement, n = progress.statement, progress.x.size
    if not is_violated(progress):
        return WorkingSet(statement, _and_equalities(statement, sides), sides != 0), None
    working = WorkingSet(statement, _and_equalities(statement, sides), complete=False)
    near = working.onto(progress.x)
    if progress.loses_digits(near):  # equalities are met one by one
        working = WorkingSet(statement, sides, complete=False)
        near = working.onto(progress.x)
    progress.place(near)
    while (violated := dot(signs := _signs_of_others(progress, working), signs)) or progress.drifted:
        if not violated:
            progress.place(working.onto(progress.x))
            continue
        gradient = statement.transposed(signs)
        zero = fineness * progress.options.optimality_tolerance * sqrt(violated)
        multipliers = working.multipliers(gradient)
        reduced = multipliers[:n] * working.free if working.number < n else None
        if reduced is None or dot(reduced, reduced) <= zero**2:
            place = wrong_sign(working, multipliers, zero, least_index=progress.least_index)
            if place is None:
                return working, _certificate(working, signs, multipliers)
            if progress.exhausted:
                return working, None
            dropped, along = working.drop(place)
            direction = -dot(along, gradient) * along
        elif progress.exhausted:
            return working, None
        else:
            dropped, direction = None, working.within(-reduced)
        if not _step(progress, working, signs, direction, dropped):
            return working, _certificate(working, signs, working.multipliers(gradient))
    if working.number == n and working.sharp and not np.count_nonzero(statement.equality > working.held):
        working.null_space = np.zeros((n, 0))  # a vertex needs no null space
        return working, None
    return WorkingSet(statement, _and_equalities(statement, working.sides), working.held), None


def _and_equalities(statement: Statement, sides: Sides) -> Sides:
    """These sides and those of all equalities."""
    sides = sides.copy()
    sides[statement.equality] = 2
    return sides


def is_violated(progress: SearchState) -> bool:
    """Whether the point violates a constraint by more than its tolerance."""
    values = progress.values
    return bool(np.count_nonzero(values > progress.highest) or np.count_nonzero(values < progress.lowest))


def violated_signs(progress: SearchState) -> Array:
    """Sign of the violation of each constraint: +1 above its bounds, -1 below them, 0 if feasible (n + m,)."""
    values = progress.values
    return np.subtract(values > progress.highest, values < progress.lowest, dtype=float)


def _signs_of_others(progress: SearchState, working: WorkingSet) -> Array:
    """`violated_signs`, with zeros for constraints that are held, which satisfy their bounds up to rounding."""
    signs = violated_signs(progress)
    signs[working.held] = 0.0
    return signs


def _certificate(working: WorkingSet, signs: Array, multipliers: Array) -> Array:
    """Farkas multipliers at a stationary sum: those of the working set, and one for each violated constraint."""
    n = working.free.size
    certificate = -signs
    certificate[working.ids] += multipliers[n:]
    certificate[:n] += multipliers[:n] * working.held[:n]
    return certificate


def _step(progress: SearchState, working: WorkingSet, signs: Array, direction: Array, dropped: int | None) -> bool:
    """Move along the direction to the constraint that ends the step, and hold it; False if there is none."""
    length = sqrt(dot(direction, direction))
    along = working.values(direction)
    block = _breakpoint(progress, signs, along, length)
    end = INFINITY if block is None else block.step
    wall = nearest(progress, along, length, working.held | signs.astype(bool), working, end)
    if wall is not None and wall.step < end:
        block = wall
    if block is None:
        return False
    progress.move(along, block.step, length)
    if working.add(block.constraint, block.side) is None:
        return False
    progress.write(1, float(progress.violation.sum()), block.step, block.constraint, dropped, working.number, 0)
    return True


def _breakpoint(progress: SearchState, signs: Array, along: Array, length: float) -> BlockingConstraint | None:
    """The violated constraint at which the sum of infeasibilities stops falling."""
    statement, rising = progress.statement, signs * along
    towards = (rising < -1e-10 * length).nonzero()[0]
    near, speeds = progress.violation[towards], -rising[towards]
    entering = (near / speeds).tolist()
    if not entering:
        return None
    width = statement.upper[towards] - statement.lower[towards]
    steps, falls = entering + ((near + width) / speeds).tolist(), speeds.tolist()
    at, fall = 0, (1.0 - 1e-12) * -dot(signs, along)
    for at in sorted(range(len(steps)), key=steps.__getitem__):
        fall -= falls[at % len(falls)]  # behind a breakpoint the sum falls less
        if fall <= 0.0:
            break
    step = steps[at]
    if fall > 0.0 or step == INFINITY:
        return None
    constraint = towards.item(at % len(falls))
    if statement.equality.item(constraint):
        side = 2
    else:
        onwards = side_reached(progress, constraint, along)
        side = -onwards if at < len(falls) else onwards
    return BlockingConstraint(constraint, side, step)
