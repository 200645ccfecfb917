"""Phase two: from a feasible point to a stationary one, the reduced Hessian never with two non-positive eigenvalues.

Gill, Murray, Saunders and Wright, SIAM Review 33 (1991) 1-36; Gill and Wong, Math. Prog. Comp. 7 (2015) 71-112.
"""

from dataclasses import dataclass
from enum import Enum, auto

import numpy as np
from numpy.typing import NDArray

from bemcontact.formulations.local_solver.factors import Factors
from bemcontact.formulations.local_solver.phase_one import wrong_sign
from bemcontact.formulations.local_solver.progress import Progress
from bemcontact.formulations.local_solver.ratio_test import Block, nearest

Array = NDArray[np.float64]


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


def zero_gradient(progress: Progress) -> float:
    """Size of a gradient or multiplier that counts as zero: relative to the terms that make it up."""
    product = progress.statement.H @ progress.x
    size = max(float(np.abs(product).max(initial=0.0)), float(np.abs(progress.statement.c).max(initial=0.0)))
    return progress.options.optimality_tolerance * max(size, 1e-3)


def descend(progress: Progress, factors: Factors) -> Outcome:
    """Walk until no constraint can be dropped with profit, or for ever."""
    dropped: int | None = None
    repeated = idle = moved = 0
    while not progress.exhausted:
        gradient = progress.statement.gradient(progress.x)
        zero = zero_gradient(progress)
        if factors.pending is not None:
            outcome = _follow_curvature(progress, factors, gradient, zero, dropped)
            dropped = None
            if outcome is not None:
                return outcome
            continue
        if np.abs(factors.Z.T @ gradient).max(initial=0.0) > 0.1 * zero:
            full = _newton_step(progress, factors, gradient, dropped)
            dropped = None
            repeated = repeated + 1 if full else 0
            if repeated > 3:  # a whole Newton step ends at a stationary point, unless the factors have drifted
                return Outcome(ending=Ending.INACCURATE)
            continue
        repeated = 0
        idle, moved = (idle + 1 if progress.iterations[1] == moved else 0), progress.iterations[1]
        position, _ = wrong_sign(progress, factors, gradient, zero)
        if position is None:
            return Outcome(ending=Ending.STATIONARY)
        if idle > 2 * len(factors.ids) + 10:  # constraints come and go without a step: multipliers are noise
            return Outcome(ending=Ending.INACCURATE)
        dropped = factors.drop(position)
        progress.changes += dropped < 0
    return Outcome(ending=Ending.LIMIT)


def _newton_step(progress: Progress, factors: Factors, gradient: Array, dropped: int | None) -> bool:
    """Towards the minimiser on the working set, as far as the constraints allow; whether all the way."""
    direction = factors.newton(gradient)
    along = progress.statement.values(direction)
    block = nearest(progress, along, float(np.linalg.norm(direction)), factors.sides == 0)
    if block is not None and block.step > 1.0:
        block = None
    _advance(progress, factors, direction, along, 1.0 if block is None else block.step, block, dropped)
    return block is None


def _follow_curvature(
    progress: Progress, factors: Factors, gradient: Array, zero: float, dropped: int | None
) -> Outcome | None:
    """Along the direction of non-positive curvature downhill to the next constraint; None if the walk goes on."""
    direction = factors.curvature_direction()
    slope = float(gradient @ direction)
    curvature = float(direction @ progress.statement.H @ direction)
    curved = curvature < -factors.curvature_tolerance
    if abs(slope) <= zero and not curved:
        factors.fix_pending()
        return None
    signs = [-np.sign(slope)] if abs(slope) > zero else [1.0, -1.0]
    best: tuple[float, Array, Array, Block] | None = None
    for sign in signs:
        d = sign * direction
        along = progress.statement.values(d)
        block = nearest(progress, along, 1.0, factors.sides == 0)
        if block is None:
            return Outcome(ending=Ending.UNBOUNDED, ray=d)
        change = block.step * sign * slope + 0.5 * block.step**2 * curvature
        if best is None or change < best[0]:
            best = (change, d, along, block)
    assert best is not None
    _, d, along, block = best
    _advance(progress, factors, d, along, block.step, block, dropped)
    return None


def _advance(
    progress: Progress,
    factors: Factors,
    direction: Array,
    along: Array,
    step: float,
    block: Block | None,
    dropped: int | None,
) -> None:
    """Take the step, and the constraint that ended it."""
    nonpositive = int(factors.pending is not None)
    progress.move(direction, along, step)
    if block is not None:
        factors.add(block.constraint, block.side)
    progress.write(
        phase=2,
        value=progress.statement.objective(progress.x),
        step=step,
        added=None if block is None else block.constraint,
        dropped=dropped,
        working=len(factors.ids),
        nonpositive=nonpositive,
    )
