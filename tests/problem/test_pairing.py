"""Which parts of edges are opposite to each other."""

import numpy as np
import pytest
from several_bodies import block, circle, elastic, polygon, problem, rigid

from bemcontact.problem.body_surface import BodySurface
from bemcontact.problem.pairing import blunt_corner


def parts(first, second, pair=("up/bottom", "low/top")):
    spec = problem({"up": elastic(first), "low": second}, accuracy=0.01, touch=list(pair))
    return [(part.edge, part.low, part.high) for part in spec.opposite("touch")]


@pytest.mark.parametrize(
    ("x", "low", "high"),
    [((0, 4), 0.0, 1.0), ((1, 3), 0.25, 0.75), ((-1, 5), 0.0, 1.0), ((2, 6), 0.5, 1.0), ((-4, 1), 0.0, 0.25)],
)
def test_parts_end_where_the_other_edge_ends(x, low, high):
    """The first edge is from 0 to 4. Its closest points beyond the ends of the other one would be corners."""
    [(edge, begin, end)] = parts(block((0, 4), (0, 1)), elastic(block(x, (-1, 0))))
    assert (edge, begin, end) == ("up/bottom", pytest.approx(low, abs=1e-9), pytest.approx(high, abs=1e-9))


def test_a_slot_in_the_other_body_leaves_two_parts():
    legs = polygon(
        bottom=(0, -3), right=(4, -3), top=(4, 0), inner=(3, 0), floor=(3, -2), wall=(1, -2), **{"other top": (1, 0)},
        left=(0, 0),
    )  # fmt: skip
    found = parts(block((0, 4), (0, 1)), elastic(legs), ("up/bottom", "low"))
    assert np.allclose([part[1:] for part in found], [(0, 0.25), (0.75, 1)])


@pytest.mark.parametrize("start", [0.0, 37.0, -90.0])
def test_all_of_a_circle_is_opposite_to_a_bore_wherever_both_begin(start):
    plate = {**block((-9, 9), (-9, 9)), "holes": [[circle("bore", 5.1, start=120, hole=True)]]}
    found = parts({"outer": [circle("rim", 5, start=start)]}, elastic(plate), ("up/rim", "low/bore"))
    assert sum(high - low for _, low, high in found) == pytest.approx(1.0, abs=1e-9)


def test_a_blunt_corner_of_a_rigid_body_is_within_one_part():
    roof = polygon(left=(1, 0), under=(-2, -0.3), right=(4, -0.3))
    ends = [end for part in parts(block((0, 2), (0.1, 1)), rigid(roof), ("up/bottom", "low")) for end in part[1:]]
    assert min(ends) == 0
    assert max(ends) == 1


def test_the_corner_of_an_elastic_body_across_a_gap_is_found():
    spec = problem(
        {"up": elastic(block((0, 2), (0.1, 1))), "low": rigid(polygon(left=(1, 0), under=(-2, -0.3), right=(4, -0.3)))},
        accuracy=0.01,
        touch=["up/bottom", "low"],
    )
    surface = spec.zones["touch"].surface
    assert isinstance(surface, BodySurface)
    corner = blunt_corner([spec.edge("up/bottom")], surface)
    assert corner is not None
    assert np.allclose(corner, (1, 0))
