"""The updated factors of the working set against what defines them, after many changes."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bemcontact.formulations.local_solver.factors import Factors, swept
from bemcontact.formulations.local_solver.statement import Statement


def statement(seed, n=12, m=10, *, definite):
    """Random data with unit bounds; rows of length one."""
    rng = np.random.default_rng(seed)
    B, A = rng.standard_normal((n, n)), rng.standard_normal((m, n))
    A = A / np.linalg.norm(A, axis=1)[:, None]
    H = B @ B.T + np.eye(n) if definite else B + B.T
    return Statement(H=H, c=rng.standard_normal(n), A=A, lower=-np.ones(n + m), upper=np.ones(n + m))


def assert_factors(factors):
    """[Y Z] orthogonal, A_Wᵀ = Y T with T triangular, RᵀR = ZᵀHZ, the pending direction outside Z and curved down."""
    data = factors.statement
    Z = factors.Z if factors.pending is None else np.column_stack([factors.Z, factors.pending[0]])
    Q = np.hstack([factors.Y, Z])
    assert_allclose(Q.T @ Q, np.eye(data.c.size), atol=1e-11)
    real = [i for i, constraint in enumerate(factors.ids) if constraint >= 0]
    normals = np.array([data.normal(factors.ids[i]) for i in real]).reshape(-1, data.c.size)
    assert_allclose((factors.Y @ factors.T)[:, real], normals.T, atol=1e-11)
    assert_allclose(factors.T, np.triu(factors.T))
    scale = np.abs(data.H).max()
    assert_allclose(factors.R.T @ factors.R, factors.Z.T @ data.H @ factors.Z, atol=1e-9 * scale)
    assert_allclose(factors.R, np.triu(factors.R))
    if factors.pending is not None:
        assert np.linalg.eigvalsh(Z.T @ data.H @ Z)[0] <= 1e-9 * scale
        d = factors.curvature_direction()
        assert_allclose(factors.Z.T @ data.H @ d, 0.0, atol=1e-9 * scale)


def change_at_random(factors, rng):
    """Drop or add one constraint, by the rules of the method: an addition if a direction is pending."""
    out = np.flatnonzero(factors.sides == 0)
    if factors.pending is not None:
        products = np.array([abs(factors.statement.normal(i) @ factors.curvature_direction()) for i in out])
        factors.add(int(out[np.argmax(products)]), 1)
    elif factors.ids and (rng.random() < 0.5 or factors.Z.shape[1] < 2):
        factors.drop(int(rng.integers(len(factors.ids))))
    else:
        products = np.array([np.linalg.norm(factors.Z.T @ factors.statement.normal(i)) for i in out])
        factors.add(int(rng.choice(out[products > 0.2 * products.max()])), -1)


@pytest.mark.parametrize("definite", [True, False])
@pytest.mark.parametrize("seed", range(5))
def test_two_hundred_updates_keep_the_factors(seed, definite):
    data = statement(seed, definite=definite)
    rng = np.random.default_rng(seed)
    sides = np.zeros(22, dtype=np.int8)
    sides[[0, 3, 5, 13, 15]] = -1
    factors = Factors(data, sides, curved=True)
    assert_factors(factors)
    for _ in range(200):
        change_at_random(factors, rng)
        assert_factors(factors)


def test_the_sweep_turns_a_vector_to_the_last_axis():
    """X = I gives the rotations G themselves: GᵀG = I and Gᵀw = |w| e_last, leading zeros included."""
    for w in ([3.0, 4.0], [0.0, 0.0, 2.0, -1.0], [0.0, -5.0], [1e-9, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0]):
        w = np.array(w)
        G = swept(np.eye(w.size), w)
        assert_allclose(G.T @ G, np.eye(w.size), atol=1e-15)
        assert_allclose(G.T @ w, np.linalg.norm(w) * np.eye(w.size)[-1], atol=1e-15)


def test_dependent_constraints_stay_out_of_the_working_set():
    """Two variables fixed and a row in their span: rank two, so the row is left out."""
    data = Statement(
        H=np.eye(3),
        c=np.zeros(3),
        A=np.array([[0.6, 0.8, 0.0]]),
        lower=np.zeros(4),
        upper=np.array([1.0, 1.0, 1.0, 0.0]),
    )
    factors = Factors(data, np.array([-1, -1, 0, 2], dtype=np.int8), curved=True)
    assert factors.ids == [0, 1]
    assert factors.sides.tolist() == [-1, -1, 0, 0]


def test_a_start_in_a_saddle_fixes_the_nonpositive_directions():
    """diag(1, -1, 0) without constraints: one positive direction is free, two are fixed for a while."""
    data = Statement(
        H=np.diag([1.0, -1.0, 0.0]), c=np.zeros(3), A=np.zeros((0, 3)), lower=np.zeros(3), upper=np.ones(3)
    )
    factors = Factors(data, np.zeros(3, dtype=np.int8), curved=True)
    assert factors.Z.shape == (3, 1)
    assert len(factors.ids) == 2
