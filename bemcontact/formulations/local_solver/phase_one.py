"""Phase one: reduce the sum of infeasibilities until there is none, or none can be removed.

A steepest descent in the null space of the working set; constraints that are satisfied stay so, violated ones may pass
through their bounds as long as the sum still falls (breakpoints of a piecewise linear function).
"""

from math import sqrt

import numpy as np

from bemcontact.formulations.local_solver.pricing import wrong_sign
from bemcontact.formulations.local_solver.progress import Progress
from bemcontact.formulations.local_solver.ratio_test import Block, nearest, side_reached
from bemcontact.formulations.local_solver.statement import Array, Sides
from bemcontact.formulations.local_solver.working_set import WorkingSet


def reach_feasibility(progress: Progress, sides: Sides, fineness: float) -> tuple[Sides, Array | None]:
    """Walk to a feasible point.

    Parameters
    ----------
    progress : Progress
        The point.
    sides : (n + m,) int8 array
        Working set to begin with.
    fineness : float
        Part of the optimality tolerance that counts; less where a certificate was refused before.

    Returns
    -------
    sides : (n + m,) int8 array
        Working set at the end.
    certificate : (n + m,) array or None
        Multipliers of infeasibility in scaled units where the sum cannot be reduced; to be verified.
    """
    signs = violated_signs(progress)
    if not signs.any():
        return sides, None
    working, n = WorkingSet(progress.statement, sides), progress.x.size
    progress.correct(working.onto(progress.x))
    signs = violated_signs(progress) * ~working.held  # what is held is on its bound, up to rounding
    while violated := signs.dot(signs):
        gradient = progress.statement.transposed(signs)
        zero = fineness * progress.options.optimality_tolerance * sqrt(violated)
        multipliers = working.multipliers(gradient)
        reduced, dropped = multipliers[:n] * working.free, None
        if working.number == n or reduced.dot(reduced) <= zero**2:
            place = wrong_sign(working, multipliers, zero, least_index=progress.least_index)
            if place is None:
                return working.sides, _certificate(working, signs, multipliers)
            if progress.exhausted:
                break
            dropped, along = working.drop(place)
            direction = -float(along.dot(gradient)) * along
        elif progress.exhausted:
            break
        else:
            direction = working.within(-reduced)
        if not _step(progress, working, signs, direction, dropped):
            return working.sides, _certificate(working, signs, working.multipliers(gradient))
        signs = violated_signs(progress) * ~working.held
    return working.sides, None


def violated_signs(progress: Progress) -> Array:
    """+1 above the upper, -1 below the lower bound, 0 within tolerance."""
    values = progress.values
    above = values > progress.highest
    return above.astype(float) - (values < progress.lowest)


def _certificate(working: WorkingSet, signs: Array, multipliers: Array) -> Array:
    """Farkas multipliers of a stationary sum: those of the working set, and one of each violated constraint."""
    n = working.free.size
    certificate = -signs
    certificate[working.ids] += multipliers[n:]
    certificate[:n] += multipliers[:n] * working.held[:n]
    return certificate


def _step(progress: Progress, working: WorkingSet, signs: Array, direction: Array, dropped: int | None) -> bool:
    """Move along the direction to the constraint that ends the step and hold that; whether there is one."""
    length = sqrt(direction.dot(direction))
    along = progress.statement.values(direction)
    wall = nearest(progress, along, length, working.held | (signs != 0.0), working)
    inner = None if wall is not None and wall.step == 0.0 else _breakpoint(progress, signs, along, length)
    block = inner if wall is None or (inner is not None and inner.step <= wall.step) else wall
    if block is None:
        return False
    progress.move(direction, along, block.step, length)
    if working.add(block.constraint, block.side) is None:
        return False
    value = float(progress.statement.violation(progress.values).sum())
    progress.write(1, value, block.step, block.constraint, dropped, working.number, 0)
    return True


def _breakpoint(progress: Progress, signs: Array, along: Array, length: float) -> Block | None:
    """Where the sum of infeasibilities stops falling: the violated constraint that turns the slope."""
    statement = progress.statement
    falling = -signs * along
    towards = (falling > 1e-10 * length).nonzero()[0]
    above, lower, upper = signs[towards] > 0.0, statement.lower[towards], statement.upper[towards]
    values, speed = progress.values[towards], falling[towards]
    near = np.where(above, values - upper, lower - values)
    steps = np.concatenate([near, near + (upper - lower)])
    speeds = np.concatenate([speed, speed])
    steps /= speeds
    order = steps.argsort(kind="stable")
    slope = -float(falling.sum())
    turned = (slope + speeds[order].cumsum() >= 1e-12 * slope).nonzero()[0]
    if turned.size == 0:
        return None
    at = int(order[turned[0]])
    entering = at < towards.size
    constraint = int(towards[at % towards.size])
    if statement.equality[constraint]:
        side = 2
    else:
        onwards = side_reached(progress, constraint, along)
        side = -onwards if entering else onwards
    return Block(constraint=constraint, side=side, step=float(steps[at]))
