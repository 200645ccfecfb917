"""Elements of two bodies that face each other end at each other's closest points."""

import numpy as np
import pytest
from several_bodies import GUIDED, HELD, block, circle, elastic, polygon, problem

from bemcontact.adaptivity.mesh_sizes import first_mesh
from bemcontact.bem.division import divided
from bemcontact.errors import ProblemError


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


@pytest.mark.parametrize("slide", [1e-8, 2e-10, 5e-11, 1e-13])
@pytest.mark.parametrize("pair", [("up/bottom", "low/top"), ("low/top", "up/bottom")])
def test_a_block_that_is_drawn_beside_another_by_round_off_has_elements_that_can_be_stated(slide, pair):
    """Ends of opposite parts that are as near to a corner as typed coordinates are it; those farther away are not."""
    bodies = {
        "up": elastic(block((slide, 2 + slide), (0, 1)), GUIDED), "low": elastic(block((0, 2), (-1, 0)), HELD)
    }  # fmt: skip
    mesh = first_mesh(problem(bodies, accuracy=0.01, c=list(pair)))
    fractions = divided(mesh).fractions
    ends = {name: [*own[1:, 0].tolist()] for name, own in fractions.items()}
    assert mesh.with_element_ends(ends).edge(pair[0]).ends_at == tuple(ends[pair[0]])
    shortest = np.diff([0, *ends[pair[1]], 1]).min()
    assert (shortest == pytest.approx(slide / 2, rel=0.1)) if slide > 2e-9 else (shortest > 1e-3)


@pytest.mark.parametrize("slide", [0.0, 2e-10, 5e-11])
def test_parts_of_two_contacts_that_end_beside_each_other_share_an_element_end(slide):
    """A block on two others, between which a slot is drawn that is round-off."""
    bodies = {
        "up": elastic(block((-3, 3), (0, 1)), GUIDED),
        "left": elastic(block((-2, 0), (-2, 0)), HELD),
        "right": elastic(block((slide, 2), (-2, 0)), HELD),
    }
    mesh = first_mesh(problem(bodies, accuracy=0.01, one=["up", "left/top"], two=["up", "right/top"]))
    (fractions,) = (own for name, own in divided(mesh).fractions.items() if name == "up/bottom")
    assert np.diff(fractions[:, 0]).min() > 1e-3
    assert abs(fractions[:, 0] - 0.5).min() < 1e-10


def test_elements_that_are_round_off_of_the_edge_that_follows_them_are_refused():
    """An edge of 7e-8, whose elements the edge of 70 cannot have."""
    peg = polygon(foot=(0, 0), right=(7e-8, 0), top=(1, 1), left=(0, 1))
    peg["outer"][0] |= {"elements": 100, "grading": {"ratio": 1000, "towards": "start"}}
    bodies = {"peg": elastic(peg), "low": elastic(block((-40, 30), (-20, 0)), HELD)}
    with pytest.raises(ProblemError, match="elements of 'peg/foot' are too short beside the length of 'low/top'"):
        divided(first_mesh(problem(bodies, accuracy=0.01, c=["peg/foot", "low/top"])))


def test_far_sides_of_two_rims_on_one_part_of_an_edge_are_left_out():
    """Two named rims beside each other: pairs 50 degrees aside are half a radius away, and those of both overlap."""
    rims = {
        name: elastic({"outer": [{**circle("rim", 1.0), "center": [x, 1.0]}]}, modulus=1e5)
        for name, x in (("one", -1.2), ("two", 1.2))
    }
    bodies = {**rims, "low": elastic(block((-6, 6), (-3, 0)), HELD)}
    named = problem(bodies, accuracy=0.01, a=["one/rim", "low/top"], b=["two/rim", "low/top"])
    whole = problem(bodies, accuracy=0.01, a=["one", "low"], b=["two", "low"])
    one, other = (divided(first_mesh(stated)).fractions for stated in (named, whole))
    assert all(np.allclose(one[name], other[name]) for name in one)
