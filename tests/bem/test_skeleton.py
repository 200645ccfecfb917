"""Few points that represent a block, against the kernels."""

import numpy as np
import pytest
from bodies import arc, even, mesh_of, rectangle, values_of

from bemcontact.bem import influence
from bemcontact.bem.influence import Influence
from bemcontact.bem.reference_element import TOLERANCE
from bemcontact.bem.skeleton import RATIO, disc, skeleton
from bemcontact.bem.system import number_unknowns, place_equations

EIGHTH = np.exp(1j * np.linspace(0, np.pi / 4, 160))
BLOCKS = {
    "straight": np.linspace(0, 1, 160) * (3 + 4j),
    "graded": np.geomspace(1e-4, 1, 160) + 0j,
    "arc": EIGHTH,
    "corner": np.concatenate([np.linspace(1, 0, 80), 1j * np.linspace(0, 1, 81)[1:]]),
    "two sides of a strip": np.concatenate([np.linspace(0, 1, 80), np.linspace(1, 0, 80) + 0.1j]),
    "scattered": np.random.default_rng(5).uniform(-1, 1, (160, 2)) @ [1, 1j],
    "fewer than it takes": EIGHTH[:8],
    "one": np.array([2 - 1j]),
}


def kernels_at(z, zeta):
    """1/τ, conj(τ)/τ², conj(τ)/τ, ln|τ| and their parts for sources ζ, in the size of the block."""
    _, radius = disc(z)
    size = radius or 1.0
    tau = (zeta[:, None] - z) / size
    functions = np.stack([1 / tau, tau.conj() / tau**2, tau.conj() / tau, np.log(abs(tau)) + 0j])
    return np.stack([functions.real, functions.imag]).reshape(-1, len(z))


@pytest.mark.parametrize("name", BLOCKS)
@pytest.mark.parametrize("ratio", [RATIO, 0.1, 1e-3])
def test_far_influence_at_all_points_follows_from_a_few(name, ratio):
    """To the tolerance with which a few functions span the kernels, amplified by the weights: 1 + Σ|w|."""
    z = BLOCKS[name]
    middle, radius = disc(z)
    zeta = middle + (radius or 1.0) / ratio * np.exp(2j * np.pi * np.arange(50) / 50)
    exact = kernels_at(z, zeta)
    few = skeleton(z)
    amplified = 1 + abs(few.weights).sum(axis=0)
    assert (abs(exact[:, few.at] @ few.weights - exact) <= amplified * TOLERANCE * abs(exact).max()).all()


@pytest.mark.parametrize("name", BLOCKS)
def test_chosen_points_have_unit_weights(name):
    few = skeleton(BLOCKS[name])
    assert (few.weights[:, few.at] == np.eye(len(few.at))).all()


@pytest.mark.parametrize(("name", "most"), [("straight", 40), ("graded", 40), ("arc", 40), ("corner", 80)])
def test_few_points_are_enough_on_a_boundary(name, most):
    """A function with Bernstein parameter 2 / RATIO needs 24 terms for 1e-14; a corner has two such pieces."""
    assert len(skeleton(BLOCKS[name]).at) <= most


@pytest.mark.parametrize("size", [1e-6, 3.7, 1e6])
def test_skeleton_does_not_depend_on_units_up_to_round_off(size):
    few, there = skeleton(EIGHTH), skeleton(size * EIGHTH)
    assert abs(len(few.at) - len(there.at)) <= 2


@pytest.mark.parametrize("points", [16, 64, 160])
@pytest.mark.parametrize(
    "loops",
    [
        [[("c", arc((0, 0), 1, 0, 360), even(300))]],
        [rectangle(2, 0.1, even(150), even(10))],
        [rectangle(2, 1, np.geomspace(1e-3, 1, 80), even(60)), [("hole", arc((1, 0.5), 0.3, 360, 0), even(60))]],
    ],
    ids=["circle", "strip", "graded plate with a hole"],
)
@pytest.mark.parametrize("first", [0, 40, 150])
def test_blocks_with_a_skeleton_agree_with_separate_pairs(loops, first, points, monkeypatch):
    """Entries of order one agree to the tolerance of one integral."""
    mesh = mesh_of(*loops)
    source = Influence(mesh=mesh, poisson_ratio=0.3, traction_elements=np.arange(0, len(mesh.elements), 2))
    values = values_of(mesh, {}, lambda at: 0 * at, lambda at, normals: 0 * normals)
    collocation = place_equations(mesh, number_unknowns(mesh, values), source.nodes).collocation
    rows = slice(first, first + points)
    block = source.block(collocation, rows)
    monkeypatch.setattr(influence, "RATIO", 0.0)
    pairs = source.block(collocation, rows)
    assert abs(block.F - pairs.F).max() <= TOLERANCE
    assert abs(block.G - pairs.G).max() <= TOLERANCE


@pytest.mark.parametrize("ratio", [1e6, 1e9])
def test_short_elements_keep_their_digits(ratio):
    """F u = 0 for translations, with the same accuracy in a block of the shortest elements as elsewhere."""
    half = np.geomspace(1, ratio, 25)
    ends = np.append(0, np.cumsum(np.concatenate([half, half[::-1]]))) / (2 * half.sum())
    mesh = mesh_of(rectangle(2, 1, ends, ends))
    source = Influence(mesh=mesh, poisson_ratio=0.3, traction_elements=np.zeros(0, int))
    values = values_of(mesh, {}, lambda at: 0 * at, lambda at, normals: 0 * normals)
    collocation = place_equations(mesh, number_unknowns(mesh, values), source.nodes).collocation
    for first in range(0, len(collocation), 16):
        block = source.block(collocation, slice(first, min(first + 16, len(collocation))))
        assert abs(block.F.sum(axis=1)).max() < 1e-14


def test_the_sum_over_known_tractions_is_that_of_their_columns():
    """The sum is linear, for far and near elements, with tractions on some, with columns on others, and with both."""
    mesh = mesh_of([("c", arc((0, 0), 1, 0, 360), even(300))])
    known = np.random.default_rng(1).standard_normal((2, 300, 3, 2))
    known[:, 50:150] = 0
    columns = Influence(mesh=mesh, poisson_ratio=0.3, traction_elements=np.arange(300))
    summed = Influence(mesh=mesh, poisson_ratio=0.3, traction_elements=np.arange(20, 80), known=known)
    values = values_of(mesh, {}, lambda at: 0 * at, lambda at, normals: 0 * normals)
    collocation = place_equations(mesh, number_unknowns(mesh, values), columns.nodes).collocation
    all_of_them, block = (one.block(collocation, slice(40, 200)) for one in (columns, summed))
    xx, yy, xy = all_of_them.G
    pairs = known.transpose(0, 3, 2, 1)
    expected = np.array(
        [(np.tensordot(x, xx) + np.tensordot(y, xy), np.tensordot(x, xy) + np.tensordot(y, yy)) for x, y in pairs]
    )
    assert abs(block.G - all_of_them.G[:, :, 20:80]).max() <= 1e-14
    assert abs(block.known - expected).max() <= 1e-13 * abs(expected).max()
