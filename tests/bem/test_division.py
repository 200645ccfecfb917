"""Elements of two bodies that face each other end at each other's closest points."""

import numpy as np
import pytest
from several_bodies import GUIDED, HELD, block, circle, elastic, problem

from bemcontact.bem.division import divided


def matched(first, second, pair):
    """Places (k, 2) of the nodes of elements that face each other, on both sides."""
    spec = problem({"up": elastic(first), "low": elastic(second, HELD)}, touch=list(pair))
    division = divided(spec)
    near, far = list[np.ndarray](), list[np.ndarray]()
    for facing in division.facing["touch"]:
        near.append(spec.edge(facing.edge).points(division.fractions[facing.edge][facing.element]))
        far.append(spec.edge(facing.onto).points(division.fractions[facing.onto][facing.opposite])[::-1])
    return np.concatenate(near), np.concatenate(far)


@pytest.mark.parametrize("counts", [(4, 7), (9, 2), (1, 1)])
@pytest.mark.parametrize("x", [(0, 3), (-1, 2), (0.5, 2.5), (-2, 7)])
def test_nodes_of_straight_edges_are_opposite_to_each_other(counts, x):
    low = block(x, (-1, 0), (3, 2, counts[1], 2))
    near, far = matched(block((0, 3), (0.25, 1), (counts[0], 2, 3, 2)), low, ("up/bottom", "low/top"))
    assert np.allclose(near - far, [0, 0.25], atol=1e-9)  # a part ends where the sine of an angle is 1e-9
    assert np.ptp(near[:, 0]) == pytest.approx(min(x[1], 3) - max(x[0], 0))


@pytest.mark.parametrize("start", [0.0, 37.0, -90.0, 98.0])
def test_nodes_of_two_circles_are_on_one_radius(start):
    plate = {**block((-9, 9), (-9, 9), (4,) * 4), "holes": [[circle("bore", 5.5, start=120, elements=7, hole=True)]]}
    near, far = matched({"outer": [circle("rim", 5, start=start, elements=16)]}, plate, ("up/rim", "low/bore"))
    assert np.allclose(far, 1.1 * near, atol=1e-11)


def test_the_second_side_has_the_elements_of_the_first():
    bodies = {
        "a": elastic(block((0, 3), (2, 3), (5, 2, 3, 2)), GUIDED),
        "b": elastic(block((0, 3), (1, 2), (2, 2, 3, 2)), GUIDED),
        "c": elastic(block((0, 3), (0, 1), (2, 2, 4, 2)), HELD),
    }
    division = divided(problem(bodies, one=["a/bottom", "b/top"], two=["c/top", "b/bottom"]))
    assert len(division.fractions["b/top"]) == 5
    assert len(division.fractions["b/bottom"]) == 4
