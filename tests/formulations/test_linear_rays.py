"""Rays of random linear programs: they are found exactly where the program was made to have one."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csc_array

from bemcontact.formulations.linear_rays import infeasible_ray, unbounded_ray


def program(seed: int) -> tuple[dict, np.ndarray, np.ndarray]:
    """A x + s = b, s >= 0 below three equations, with an optimum that is drawn: x, and z >= 0 with c = -Aᵀz."""
    rng = np.random.default_rng(seed)
    n, equations, inequalities = 6, 3, 9
    A, x = rng.standard_normal((equations + inequalities, n)), rng.standard_normal(n)
    slack = np.append(np.zeros(equations), rng.uniform(0.1, 1.0, inequalities))
    z = np.append(rng.standard_normal(equations), rng.uniform(0.1, 1.0, inequalities))
    dims = SimpleNamespace(zero=equations, nonneg=inequalities)
    return {"A": csc_array(A), "b": A @ x + slack, "c": -A.T @ z, "dims": dims}, x, z


@settings(max_examples=30)
@given(seed=st.integers(0, 10**6))
def test_a_program_with_an_optimum_has_no_ray(seed):
    data, _, _ = program(seed)
    assert infeasible_ray(data) is None
    assert unbounded_ray(data) is None


@settings(max_examples=30)
@given(seed=st.integers(0, 10**6))
def test_farkas_multipliers(seed):
    """A row that is minus a positive sum of others, with a limit below what they leave, has multipliers z."""
    data, _, z = program(seed)
    A, b = data["A"].toarray(), data["b"]
    more = {"A": csc_array(np.vstack([A, -z @ A])), "b": np.append(b, -z @ b - 0.1)}
    ray = infeasible_ray(data | more | {"dims": SimpleNamespace(zero=3, nonneg=10)})
    assert (ray.z[3:] >= 0).all()
    np.testing.assert_allclose(more["A"].T @ ray.z, 0.0, atol=1e-9)
    assert more["b"] @ ray.z < -1e-3


@settings(max_examples=30)
@given(seed=st.integers(0, 10**6))
def test_directions_of_descent(seed):
    """A variable that is in no equation, that relaxes inequalities and has a negative cost, may grow without limit."""
    data, _, _ = program(seed)
    column = np.append(np.zeros(3), -np.random.default_rng(seed).random(9))
    more = {"A": csc_array(np.column_stack([data["A"].toarray(), column])), "c": np.append(data["c"], -1.0)}
    ray = unbounded_ray(data | more)
    moved = more["A"] @ ray.x
    np.testing.assert_allclose(moved[:3], 0.0, atol=1e-9)
    assert (moved[3:] <= 1e-9).all()
    assert more["c"] @ ray.x < -0.5
    curved = csc_array(np.diag(np.append(np.zeros(6), 1.0)))
    assert unbounded_ray(data | more | {"P": curved}) is None


def test_without_costs_and_limits_there_is_nothing_to_find():
    data, _, _ = program(0)
    none = data | {"b": 0.0 * data["b"], "c": 0.0 * data["c"]}
    assert infeasible_ray(none) is None
    assert unbounded_ray(none) is None


@pytest.mark.parametrize("rows", [2, 5])
def test_rows_of_other_cones_take_no_part(rows):
    """Their multipliers are zero, and a direction leaves them unchanged."""
    data, _, _ = program(1)
    A = np.vstack([data["A"].toarray(), np.ones((rows, 6))])
    data |= {"A": csc_array(A), "b": np.append(data["b"] - np.append(np.zeros(3), np.full(9, 99.0)), np.zeros(rows))}
    data["b"][3:5], A[4] = [-1.0, -1.0], -A[3]
    ray = infeasible_ray(data | {"A": csc_array(A)})
    assert not ray.z[12:].any()
    assert data["b"] @ ray.z < 0
