"""The constraint that ends a step, in both phases, against the definitions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact.formulations.local_solver.phase_one import _breakpoint
from bemcontact.formulations.local_solver.progress import SearchState
from bemcontact.formulations.local_solver.ratio_test import nearest
from bemcontact.formulations.local_solver.result import QPOptions
from bemcontact.formulations.local_solver.statement import Statement


def at_a_point(seed, *, feasible):
    """A search at a random point, and a direction (n + m,) that meets many bounds nearly at once; some are absent."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 7)), int(rng.integers(0, 6))
    A, x, direction = (rng.integers(-3, 4, shape).astype(float) for shape in ((m, n), n, n))
    values, along = np.append(x, A @ x), np.append(direction, A @ direction)
    steps = rng.integers(0 if feasible else -2, 3, (2, n + m)) + 1e-9 * rng.uniform(-1.0, 1.0, (2, n + m))
    below, above = steps * np.maximum(np.abs(along), 1.0)
    above = np.where(rng.random(n + m) < 0.1, -below, np.maximum(above, -below))
    lower = np.where(rng.random(n + m) < 0.8, values - below, -np.inf)
    upper = np.where(rng.random(n + m) < 0.8, values + above, np.inf)
    statement = Statement(H=np.eye(n), c=np.zeros(n), A=A, lower=lower, upper=upper)
    progress = SearchState(statement=statement, options=QPOptions(), unit=1.0, x=x)
    return progress, along, float(np.linalg.norm(direction))


@settings(max_examples=300)
@given(st.integers(0, 10**9))
def test_a_step_ends_where_the_first_bound_is_met(seed):
    """Harris: of the constraints met before any is violated by more than its tolerance, the one met most steeply."""
    progress, along, length = at_a_point(seed, feasible=True)
    statement, values = progress.statement, progress.values
    held = np.random.default_rng(seed).random(values.size) < 0.2
    ahead = np.where(along > 0.0, statement.upper, statement.lower)
    met = [i for i in range(values.size) if along[i] != 0.0 and not held[i] and np.isfinite(ahead[i])]
    with np.errstate(divide="ignore", invalid="ignore"):  # as the run has it
        block = nearest(progress, along, length, held)
    if not met:
        assert block is None
        return
    assert block is not None
    longest = min((ahead[i] - values[i]) / along[i] + progress.slack[i] / abs(along[i]) for i in met)
    first = [i for i in met if (ahead[i] - values[i]) / along[i] <= longest]
    assert block.constraint in first
    assert abs(along[block.constraint]) == max(abs(along[i]) for i in first)
    step = (ahead[block.constraint] - values[block.constraint]) / along[block.constraint]
    assert block.step == pytest.approx(max(step, 0.0), abs=1e-15)
    assert block.side == (2 if statement.equality[block.constraint] else np.sign(along[block.constraint]))


def test_what_hardly_moves_is_met_on_a_long_step_alone():
    """A component of 1e-12 reaches a bound 1e-9 away after 1000, beyond a step that ends at 1, and not one of 2000."""
    upper = np.array([np.inf, 1e-9])
    statement = Statement(H=np.eye(2), c=np.zeros(2), A=np.zeros((0, 2)), lower=np.full(2, -np.inf), upper=upper)
    progress = SearchState(statement=statement, options=QPOptions(), unit=1.0, x=np.zeros(2))
    along, held = np.array([1.0, 1e-12]), np.zeros(2, dtype=bool)
    with np.errstate(divide="ignore", invalid="ignore"):
        assert nearest(progress, along, 1.0, held, end=1.0) is None
        for block in (nearest(progress, along, 1.0, held, end=2000.0), nearest(progress, along, 1.0, held)):
            assert block is not None
            assert (block.constraint, block.side, block.step) == (1, 1, pytest.approx(1000.0))


@settings(max_examples=300)
@given(st.integers(0, 10**9))
def test_phase_one_steps_to_the_least_sum_of_violations(seed):
    """On a line the sum is convex and piecewise linear, and least at a bound of a violated constraint.

    Satisfied constraints are left out: they end a step by themselves.
    """
    progress, along, length = at_a_point(seed, feasible=False)
    statement, values = progress.statement, progress.values
    signs = np.subtract(values > progress.highest, values < progress.lowest, dtype=float)
    violated = signs != 0.0

    def total(step):
        return float(statement.violation(values + step * along)[violated].sum())

    inner = _breakpoint(progress, signs, along, length)
    if signs @ along >= 0.0:  # the sum does not fall
        return
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = ((np.array([statement.lower, statement.upper]) - values) / along)[:, violated]
    least = min(total(step) for step in steps[np.isfinite(steps) & (steps >= 0.0)])
    assert inner is not None
    assert total(inner.step) == pytest.approx(least, abs=1e-12)
    bounds = statement.lower[inner.constraint], statement.upper[inner.constraint]
    assert violated[inner.constraint]
    assert (values + inner.step * along)[inner.constraint] == pytest.approx(bounds[int(inner.side == 1)])
