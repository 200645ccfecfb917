"""Scaling: free of units, and undone without a trace."""

import numpy as np
import pytest

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.formulations.scaling import scale, scaled_point, unscaled


def contact(length: float = 1.0, stress: float = 1.0, k: int = 2) -> CondensedContact:
    """The same physical problem in units of length and stress that are so many times smaller.

    The last free motion is a rotation: its components along the normals are lengths, its load a moment.
    """
    rng = np.random.default_rng(0)
    n = 8
    R = rng.standard_normal((n, k))
    motion = np.ones(k)
    motion[-1:] = length
    return CondensedContact.from_compliance(
        rng.standard_normal((n, n)) * length / stress,
        rng.standard_normal(n) * length,
        rng.uniform(0.5, 1.0, n) * length,
        rigid_motions=R * motion,
        motion_load=rng.standard_normal(k) * stress * length * motion,
    )


@pytest.mark.parametrize("k", [0, 1, 2])
@pytest.mark.parametrize(("length", "stress"), [(1e-3, 1e6), (1e3, 1e-6), (25.4, 6.894757)])
def test_units_leave_no_trace(length, stress, k):
    """Each array is a quotient of quantities of one unit, so that only round-off can differ."""
    one, other = scale(contact(k=k)), scale(contact(length, stress, k))
    for name in ("compliance", "offset", "rigid_motions", "motion_load", "weights", "equilibrium"):
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=1e-12, atol=1e-12)


def test_sizes_are_one():
    scaled = scale(contact())
    assert np.abs(scaled.compliance).sum(axis=1).max() <= 1 + 1e-14
    assert np.abs(scaled.rigid_motions).max(axis=0) == pytest.approx(1.0)
    assert scaled.weights.max() == pytest.approx(1.0)


@pytest.mark.parametrize("k", [0, 2])
def test_there_and_back(k):
    """`unscaled` undoes `scaled_point`, and u_n = Δ1 + M p + R a is the gap of the problem without ε."""
    rng = np.random.default_rng(1)
    problem = contact(1e-2, 1e5, k)
    p, a = rng.standard_normal(problem.size) * problem.scales.pressure, rng.standard_normal(k)
    pressure, displacement, amplitudes = unscaled(problem, *scaled_point(problem, p, a))
    np.testing.assert_allclose(pressure, p, rtol=1e-14)
    np.testing.assert_allclose(amplitudes, a, rtol=1e-14)
    np.testing.assert_allclose(problem.initial_gap + displacement, problem.gap(p, a), rtol=1e-12)


def test_gap_and_equilibrium_are_the_users_over_their_scales():
    rng = np.random.default_rng(2)
    problem = contact(1e-2, 1e5)
    scaled = scale(problem)
    p, a = rng.standard_normal(problem.size) * problem.scales.pressure, rng.standard_normal(2)
    gap = scaled.gap(*scaled_point(problem, p, a)) * problem.scales.displacement
    np.testing.assert_allclose(gap, problem.gap(p, a), rtol=1e-11)
    balance = scaled.equilibrium.T @ (p / problem.scales.pressure) + scaled.motion_load
    users = (problem.equilibrium.T @ p + problem.motion_load) / problem.scales.pressure / problem.weights.max()
    np.testing.assert_allclose(balance * np.abs(problem.rigid_motions).max(axis=0), users, rtol=1e-11)


@pytest.mark.parametrize("k", [0, 1, 2])
def test_one_matrix_has_gaps_and_imbalance(k):
    """The product with the matrix is the gap, then what is missing of equilibrium, which are known by themselves."""
    scaled, rng = scale(contact(k=k)), np.random.default_rng(1)
    p, a = rng.standard_normal(len(scaled.offset)), rng.standard_normal(k)
    both = np.append(scaled.gap(p, a), scaled.imbalance(p))
    np.testing.assert_allclose(scaled.matrix @ np.append(p, a) + scaled.constant, both, rtol=1e-13, atol=1e-13)
    lever = np.abs(scaled.equilibrium).sum(axis=0)
    largest = max(np.abs(np.minimum(p, both[:8])).max(), *np.abs(both[8:] / lever), 0.0)
    assert scaled.residual(p, a) == pytest.approx(largest / (1 + np.abs(p).max() + np.abs(a).sum()), rel=1e-12)
