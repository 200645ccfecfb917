"""Phase one: reduce the sum of infeasibilities until there is none, or none can be removed.

A steepest descent in the null space of the working set; constraints that are satisfied stay so, violated ones may pass
through their bounds as long as the sum still falls (breakpoints of a piecewise linear function).
"""

import numpy as np
from numpy.typing import NDArray

from bemcontact.formulations.local_solver.factors import FLAT, TEMPORARY, Factors
from bemcontact.formulations.local_solver.progress import Progress
from bemcontact.formulations.local_solver.ratio_test import Block, nearest, side_reached

Array = NDArray[np.float64]


def reach_feasibility(progress: Progress, sides: NDArray[np.int8]) -> tuple[NDArray[np.int8], Array | None]:
    """Walk to a feasible point.

    Returns
    -------
    sides : (n + m,) int8 array
        Working set at the end.
    certificate : (n + m,) array or None
        Multipliers of infeasibility in scaled units where the sum cannot be reduced; to be verified.
    """
    if not violated_signs(progress).any():
        return sides, None
    factors = Factors(progress.statement, sides, curved=False)
    while not progress.exhausted:
        signs = violated_signs(progress)
        if not signs.any():
            return factors.sides, None
        gradient = progress.statement.transposed(signs)
        direction = -factors.Z @ (factors.Z.T @ gradient)
        dropped = None
        if np.linalg.norm(direction) <= tolerance(progress, signs):
            position, multipliers = wrong_sign(progress, factors, gradient, tolerance(progress, signs))
            if position is None:
                return factors.sides, _certificate(factors, signs, multipliers)
            dropped = factors.drop(position)
            direction = -factors.Z[:, -1] * float(factors.Z[:, -1] @ gradient)
        _step(progress, factors, signs, direction, dropped)
    return factors.sides, None


def violated_signs(progress: Progress) -> Array:
    """+1 above the upper, -1 below the lower bound, 0 within tolerance."""
    statement, values = progress.statement, progress.values
    above = values > statement.upper + progress.slack
    below = values < statement.lower - progress.slack
    return above.astype(float) - below.astype(float)


def tolerance(progress: Progress, signs: Array) -> float:
    """Size of a gradient that is zero."""
    return progress.options.optimality_tolerance * max(1.0, float(np.abs(signs).sum()) ** 0.5)


def wrong_sign(progress: Progress, factors: Factors, gradient: Array, zero: float) -> tuple[int | None, Array]:
    """The place of the constraint to drop, most wrong first (or of least index when stalled), and the multipliers."""
    multipliers = factors.multipliers(gradient)
    ids = np.array(factors.ids, dtype=np.intp)
    sides = factors.sides[np.maximum(ids, 0)]
    wrong = np.where(sides == 2, 0.0, sides * multipliers)
    wrong = np.where(ids == FLAT, np.abs(multipliers), np.where(ids == TEMPORARY, np.inf, wrong))
    if wrong.size == 0 or wrong.max() <= zero:
        return None, multipliers
    if progress.least_index:
        candidates = np.flatnonzero(wrong > zero)
        return int(candidates[np.argmin(ids[candidates])]), multipliers
    return int(np.argmax(wrong)), multipliers


def _certificate(factors: Factors, signs: Array, multipliers: Array) -> Array:
    """Farkas multipliers of a stationary sum: those of the working set, and one of each violated constraint."""
    certificate = -signs
    certificate[np.array(factors.ids, dtype=np.intp)] += multipliers
    return certificate


def _step(progress: Progress, factors: Factors, signs: Array, direction: Array, dropped: int | None) -> None:
    """Move along the direction to the constraint that ends the step and take it into the working set."""
    length = float(np.linalg.norm(direction))
    along = progress.statement.values(direction)
    wall = nearest(progress, along, length, (factors.sides == 0) & (signs == 0.0))
    inner = _breakpoint(progress, signs, along, length)
    block = inner if wall is None or (inner is not None and inner.step <= wall.step) else wall
    if block is None:
        factors.refactor()
        step, added = 0.0, None
    else:
        step, added = block.step, block.constraint
        progress.move(direction, along, step)
        factors.add(block.constraint, block.side)
    progress.write(
        phase=1,
        value=float(progress.statement.violation(progress.values).sum()),
        step=step,
        added=added,
        dropped=dropped,
        working=len(factors.ids),
        nonpositive=0,
    )


def _breakpoint(progress: Progress, signs: Array, along: Array, length: float) -> Block | None:
    """Where the sum of infeasibilities stops falling: the violated constraint that turns the slope."""
    statement = progress.statement
    slope = float(signs @ along)
    towards = np.flatnonzero((signs * along < 0.0) & (np.abs(along) > 1e-10 * length))
    near = np.where(signs > 0.0, statement.upper, statement.lower)
    far = np.where(signs > 0.0, statement.lower, statement.upper)
    speed = np.abs(along[towards])
    steps = np.concatenate(
        [np.abs(near - progress.values)[towards] / speed, np.abs(far - progress.values)[towards] / speed]
    )
    constraints = np.concatenate([towards, towards])
    entering = np.repeat([True, False], towards.size)
    slopes = slope + np.cumsum(np.concatenate([speed, speed])[order := np.argsort(steps, kind="stable")])
    turned = np.flatnonzero(slopes >= -1e-12 * abs(slope))
    if turned.size == 0:
        return None
    at = int(order[turned[0]])
    constraint = int(constraints[at])
    if statement.lower[constraint] == statement.upper[constraint]:
        side = 2
    else:
        onwards = side_reached(progress, constraint, along)
        side = -onwards if entering[at] else onwards
    return Block(constraint=constraint, side=side, step=float(steps[at]))
