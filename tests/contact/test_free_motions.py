"""Algebra of the free motions by its identities, the order of points, forces by hand."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import MotionAlgebra, angle_of_round_off, typical_scales
from bemcontact.errors import ProblemError, SingularSystemError


@pytest.fixture(params=[0, 1, 3])
def motions(request: pytest.FixtureRequest) -> MotionAlgebra:
    rng, n, k = np.random.default_rng(7), 8, request.param
    return MotionAlgebra(
        rigid_motions=rng.standard_normal((n, k)), weights=rng.uniform(0.5, 1, n), motion_load=rng.standard_normal(k)
    )


def test_projector_removes_the_motions(motions: MotionAlgebra):
    """P² = P, P R = 0 and ℓᵀP = 0; P keeps the equilibrium space, whose basis Z is orthonormal."""
    P, Z, ell = motions.projector, motions.equilibrium_space, motions.equilibrium
    np.testing.assert_allclose(P @ P, P, atol=1e-13)
    np.testing.assert_allclose(P @ motions.rigid_motions, 0, atol=1e-13)
    np.testing.assert_allclose(ell.T @ P, 0, atol=1e-13)
    np.testing.assert_allclose(ell.T @ Z, 0, atol=1e-13)
    np.testing.assert_allclose(P @ Z, Z, atol=1e-13)
    np.testing.assert_allclose(Z.T @ Z, np.eye(Z.shape[1]), atol=1e-13)


def test_balancing_pressure_is_in_equilibrium(motions: MotionAlgebra):
    """Also with any pressure P p added."""
    p = motions.projector @ np.arange(8.0) + motions.balancing_pressure
    np.testing.assert_allclose(motions.imbalance(motions.balancing_pressure), 0, atol=1e-13)
    np.testing.assert_allclose(motions.imbalance(p), 0, atol=1e-12)


def test_amplitudes_of_a_motion_are_its_own(motions: MotionAlgebra):
    a = np.arange(1.0, 1 + len(motions.motion_load))
    np.testing.assert_allclose(motions.amplitudes_of(motions.rigid_motions @ a), a, rtol=1e-12)


@pytest.mark.parametrize("method", ["imbalance", "balancing", "amplitudes_of"])
@pytest.mark.parametrize(
    "given",
    [None, 1.0, "x", [1, [2, 3]], {"a": 1}, 10**400, np.ones(5), np.ma.masked_array(np.ones(8), np.arange(8) < 1)],
    ids=["None", "number", "text", "ragged", "mapping", "large", "size", "masked"],
)
def test_what_is_no_array_of_the_size_is_refused(method: str, given: object, motions: MotionAlgebra):
    with pytest.raises(ProblemError, match=r"pressure|load|displacement"):
        getattr(motions, method)(given)


@pytest.mark.parametrize("pressure", [0.0, 0.3, 3.0])
@pytest.mark.parametrize("disk", [False, True])
@pytest.mark.parametrize("seed", range(10))
def test_scale_is_the_larger_of_load_and_interference(pressure: float, disk: bool, seed: int):
    """Interference by a linear program in amplitudes and s: least s >= 0 with q + R a + s >= 0.

    Normals of a disk that is pressed into a hole balance each other, so that it is as deep as drawn.
    """
    rng, n = np.random.default_rng(seed), 12
    angle = 2 * np.pi * np.arange(n) / n
    R = np.column_stack([np.cos(angle), np.sin(angle)]) if disk else rng.standard_normal((n, 1 + seed % 3))
    q = np.full(n, -0.4) if disk else rng.standard_normal(n) - 0.5
    k = R.shape[1]
    program = scipy.optimize.linprog(
        np.eye(k + 1)[k], A_ub=-np.column_stack([R, np.ones(n)]), b_ub=q, bounds=[*[(None, None)] * k, (0, None)]
    )
    scales = typical_scales(np.eye(n), q, np.abs(q), R, np.full(n, pressure))
    expected = max(pressure, program.fun)
    assert scales.displacement == pytest.approx(expected if expected > 1e-6 else np.abs(q).max(), rel=1e-6)


def test_forces_and_order_of_points():
    """Four points in two zones and three runs; Σ w p n of each zone by hand."""
    contact = replace(
        CondensedContact.from_compliance(np.eye(4), np.zeros(4), [1.0, 1.0, 1.0, 2.0]),
        zone_names=("floor", "wall"),
        zone=np.array([0, 0, 0, 1]),
        run=np.array([2, 2, 0, 1]),
        run_length=np.full(3, np.inf),
        arc_position=np.array([1.0, 3.0, 5.0, 0.0]),
        normals=np.array([[0.0, 1.0], [0.0, 1.0], [0.0, 1.0], [1.0, 0.0]]),
    )
    pressure = np.array([4.0, 1.0, 3.0, 2.0])
    np.testing.assert_array_equal(contact.resultants(pressure), [[0.0, 8.0], [4.0, 0.0]])
    np.testing.assert_array_equal(contact.resultants(np.stack([pressure, 2 * pressure]))[1], [[0.0, 16.0], [8.0, 0.0]])
    assert contact.in_order(np.array([3, 1, 0, 2])).tolist() == [2, 3, 0, 1]
    assert contact.points_of_run(2).tolist() == [0, 1]


def test_motions_that_underflow_are_said_to_be_singular():
    """Squares of 1e-200 vanish, although the columns are independent."""
    motions = MotionAlgebra(rigid_motions=np.full((3, 1), 1e-200), weights=np.ones(3), motion_load=np.ones(1))
    with pytest.raises(SingularSystemError, match="working precision"):
        motions.balancing(np.ones(1))


@pytest.mark.parametrize(("size", "center"), [(1.0, 0.0), (1e-6, 3.0), (1e6, -2.0)])
def test_an_angle_is_round_off_up_to_that_of_coordinates_over_the_half_width(size: float, center: float):
    """Pressed points on a line see a turn by their distance from its middle, points on a circle see none."""
    x = size * np.linspace(-1.0, 1.0, 7)
    points = np.column_stack([center * size + x, 0 * x])
    up = np.tile([0.0, 1.0], (7, 1))
    pressed = np.abs(x) < 0.5 * size
    least = angle_of_round_off(points, up, pressed)
    half = float(x[pressed].max())
    assert least == pytest.approx(4 * np.finfo(float).eps * np.abs(points).max() / half)
    angles = np.linspace(0.0, 2.0, 7)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    assert angle_of_round_off(size * (circle + center), circle, np.ones(7, bool)) == 0.0
