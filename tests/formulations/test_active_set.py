"""The primal-dual iteration: exact where it settles, harmless where it cannot."""

from dataclasses import replace

import numpy as np
import pytest

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.formulations.active_set import (
    ContactBlock,
    first_active_set,
    primal_dual,
    resting_points,
    solve_active_set,
)
from bemcontact.formulations.scaling import ScaledContact, scale


def plain(M: np.ndarray, q: np.ndarray) -> ScaledContact:
    return scale(CondensedContact.from_compliance(M, q))


def test_exact_in_one_step_from_the_right_set():
    problem = plain(np.array([[2.0, 1.0], [0.5, 2.0]]), np.array([-1.0, 3.0]))
    end = primal_dual(problem, np.array([True, False]))
    assert end.steps == 1
    assert end.residual <= 1e-16


def test_a_rigid_body_rests_on_what_is_under_its_load():
    """A disk with the same gap all around falls onto two points beside the line of its load."""
    angles = np.radians(np.arange(5.0, 360.0, 10.0))
    scaled = scale(
        CondensedContact.from_compliance(
            np.eye(36), np.ones(36), rigid_motions=np.column_stack([np.cos(angles), np.sin(angles)]),
            motion_load=np.array([0.0, -1.0]),
        )
    )  # fmt: skip
    assert not first_active_set(scaled).any()
    touching = np.rad2deg(angles[resting_points(scaled)])
    np.testing.assert_allclose(touching, [85.0, 95.0])
    end = primal_dual(scaled, resting_points(scaled))
    assert end.residual <= 1e-15
    assert not resting_points(plain(np.eye(2), np.ones(2))).any()


def test_m_matrix_is_solved_within_n_plus_one_steps():
    """For an M-matrix the iteration from {q < 0} only adds points (Hintermüller, Ito and Kunisch, theorem 3.2)."""
    rng = np.random.default_rng(0)
    n = 30
    M = -rng.uniform(0, 1, (n, n))
    np.fill_diagonal(M, 0)
    M += np.diag(1.1 - M.sum(axis=1))
    problem = plain(M, rng.standard_normal(n))
    end = primal_dual(problem, first_active_set(problem))
    assert end.residual <= 1e-15
    assert end.steps <= n + 1


def test_cycle_ends_with_the_best_point_seen():
    """A P-matrix on which the sets come back: the steps stop, and the point does not pass for a solution."""
    M = np.array([[2, -2, -1, 2, 0], [0, 2, -2, 2, -1], [2, 1, 1, -1, 0], [-2, -2, 1, 2, -3], [3, -3, -2, 3, 2]], float)
    problem = plain(M, np.array([0.0, -2.0, 1.0, 0.0, -2.0]))
    end = primal_dual(problem, first_active_set(problem))
    assert end.steps < 2**5  # the number of sets
    assert end.residual > 1e-3
    assert (end.pressure >= 0).all()


def test_too_few_contacts_for_the_motions():
    """One point cannot hold two motions: the least-squares answer keeps its gap closed and is finite."""
    R = np.array([[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]])
    scaled = scale(
        CondensedContact.from_compliance(np.eye(3), np.ones(3), rigid_motions=R, motion_load=np.array([-1.0, -1.0]))
    )
    p, a = solve_active_set(scaled, np.array([True, False, False]))
    assert np.isfinite(p).all()
    assert np.isfinite(a).all()


def test_coincident_points_share_the_load():
    """Two copies of one point: the equations are singular, and the shortest solution gives each half."""
    M = np.array([[1.0, 1.0], [1.0, 1.0]])
    p, _ = solve_active_set(plain(M, np.array([-1.0, -1.0])), np.array([True, True]))
    assert p[0] == pytest.approx(p[1], rel=1e-14)


@pytest.mark.parametrize("power", [0, 20, 60])
def test_small_weights_make_no_set_singular(power):
    """Weights smaller by powers of two, pressures larger by the same: the same forces, in each digit."""
    rng, n = np.random.default_rng(power), 6
    B, units = rng.standard_normal((n, n)), 2.0 ** -rng.integers(0, power + 1, n)
    whole = ScaledContact(
        compliance=B @ B.T + np.eye(n),
        offset=-np.ones(n),
        rigid_motions=rng.uniform(0.5, 1.0, (n, 1)),
        motion_load=-np.ones(1),
        weights=np.ones(n),
    )
    small = replace(whole, compliance=whole.compliance * units, weights=units)
    (p, a), (of_small, same) = (solve_active_set(contact, np.ones(n, bool)) for contact in (whole, small))
    assert np.array_equal(of_small * units, p)
    assert np.array_equal(same, a)


@pytest.mark.parametrize("power", [0, 20, 60])
def test_units_of_pressures_do_not_decide_whether_a_set_is_singular(power):
    """Two copies of a point among others, or none, with pressures in units that differ by powers of two."""
    rng, n = np.random.default_rng(power), 6
    B, units = rng.standard_normal((n, n)), 2.0 ** -np.linspace(0, power, n).astype(int)
    definite = B @ B.T + np.eye(n)
    double = definite[[0, 1, 2, 3, 4, 4]][:, [0, 1, 2, 3, 4, 4]]
    for compliance, regular in ((definite, True), (double, False)):
        scaled = ScaledContact(
            compliance=compliance * units, offset=-np.ones(n), rigid_motions=np.zeros((n, 0)),
            motion_load=np.zeros(0), weights=np.ones(n),
        )  # fmt: skip
        assert ContactBlock(scaled=scaled, points=np.arange(n)).regular == regular


def test_first_set_of_a_free_body_is_laid_by_least_squares():
    """A parabola on a plane: the weighted mean of x² separates the points that are taken to touch."""
    x = np.linspace(-1, 1, 11)
    scaled = scale(CondensedContact.from_compliance(np.eye(11), x**2, rigid_motions=np.ones(11), motion_load=-1.0))
    np.testing.assert_array_equal(first_active_set(scaled), x**2 <= np.mean(x**2))
