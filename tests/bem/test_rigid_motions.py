"""Rigid motions of one body: their names, and bases of them."""

import numpy as np
import pytest

from bemcontact.bem.boundary_values import BoundaryValues
from bemcontact.bem.mesh import Mesh, elements_of_loops
from bemcontact.bem.rigid_motions import FAR, RigidMotions, all_rigid_motions, echelon, free_rigid_motions, toward


def test_a_motion_is_described_without_warning():
    assert RigidMotions(coefficients=np.eye(3), center=np.array([1.0, 2]), radius=3.0).describe() == (
        "translation along (1, 0)", "translation along (0, 1)", "rotation counterclockwise about (1, 2)",
    )  # fmt: skip


@pytest.mark.parametrize("size", [1e-12, 1.0, 1e9])
def test_directions_have_the_words_of_their_components(size):
    """Both components are named but for half a degree beside an axis: a load against one alone would not suffice."""
    words = ["to the right", "to the right and up", "up", "to the left and up", "to the left", "to the left and down",
             "down", "to the right and down"]  # fmt: skip
    for degrees in (0, 0.5, 1, 45, 89, 89.5):
        for quarter in range(4):
            angle = np.radians(90 * quarter + degrees)
            number = 2 * quarter + (degrees > 0.5) + (degrees > 89)
            assert toward(size * np.array([np.cos(angle), np.sin(angle)])) == words[number % 8]


@pytest.mark.parametrize("far", [0.0, 1.0, 2.9, 3.1, 42.0, -42.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_pole_that_is_far_away_is_said_to_be_nearly_a_translation(far: float, sign: float):
    """With the pole at (1 - 3 far, 2) the middle (1, 2) moves up or down, and any point of the body within a third."""
    motion = RigidMotions(coefficients=sign * np.array([[0.0, far, 1.0]]), center=np.array([1.0, 2]), radius=3.0)
    (told,) = motion.describe()
    sense = "counterclockwise" if sign > 0 else "clockwise"
    turn = f"rotation {sense} about ({1 - 3 * far:.4g}, 2)"
    along = f"translation along (0, {sign * np.sign(far):.0f}) with a small {sense} turn"
    assert told == (along if abs(far) > FAR else turn)
    points = np.array([1.0, 2]) + 3.0 * np.array([[-1, 0], [1, 0], [0, 1]])
    moved, middle = (motion.displacement(at)[..., 0] for at in (points, np.array([[1.0, 2]])))
    if abs(far) > FAR:
        assert np.linalg.norm(moved - middle, axis=1).max() <= abs(far) / FAR


@pytest.mark.parametrize("seed", range(5))
def test_slight_components_of_motions_are_no_pivots(seed):
    """Spins about places a little beside the middles of bodies, and motions of all together: no digit is lost."""
    rng = np.random.default_rng(seed)
    spins = np.zeros((3, 9))
    for body in range(3):
        spins[body, 3 * body : 3 * body + 3] = *rng.uniform(-1, 1, 2) * 10.0 ** rng.integers(-9, -4), 1.0
    together = np.hstack([np.eye(3)[:2]] * 3)
    basis = np.vstack([spins, together])
    turned = np.linalg.qr(rng.standard_normal((5, 5)))[0] @ np.linalg.qr(basis.T)[0].T
    rows = echelon(turned)
    np.testing.assert_allclose(np.linalg.norm(rows, axis=1), 1.0)
    assert np.linalg.svd(rows, compute_uv=False)[-1] > 0.1
    np.testing.assert_allclose(rows @ np.linalg.pinv(basis) @ basis, rows, rtol=0, atol=1e-13)


@pytest.mark.parametrize("seed", range(20))
def test_free_motions_are_null_vectors_of_what_is_given(seed: int):
    """By a singular value decomposition of the displacements that are given, at places that are alike or not."""
    generator = np.random.default_rng(seed)
    angles = np.linspace(0, 2 * np.pi, 13)[:-1]
    nodes = np.round(3 * np.stack([np.cos(angles), np.sin(angles)], axis=1)) + generator.standard_normal(2)
    elements = elements_of_loops(np.array([1, 2, 3, 4, 5, 0]))
    mesh = Mesh(nodes=nodes, elements=elements, edge=np.zeros(6, int), edge_names=("rim",))
    given = np.zeros((12, 2), bool)
    for axis in generator.choice(2, generator.integers(1, 3), replace=False):  # all on a line, or a few
        line = abs(nodes[:, 1 - axis] - nodes[generator.integers(12), 1 - axis]) < 1e-6
        given[:, axis] = line if seed % 2 else generator.random(12) < 0.2
    held = BoundaryValues(
        displacement_given=given, displacement=np.zeros((12, 2)), traction_unknown=np.zeros((6, 2), bool),
        traction=np.zeros((6, 3, 2)), stiffness=np.zeros((6, 3, 2, 2)),
    )  # fmt: skip
    motions = free_rigid_motions(mesh, held)
    every = all_rigid_motions(mesh)
    rows = every.displacement(nodes)[given]
    assert len(motions) == 3 - np.linalg.matrix_rank(rows, tol=1e-9)
    assert np.linalg.norm(rows @ motions.coefficients.T) < 1e-12
    assert np.linalg.matrix_rank(motions.coefficients) == len(motions)
