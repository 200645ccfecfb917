"""The way of bodies to where they touch as drawn."""

import pytest
from several_bodies import block, circle, elastic, polygon, problem

from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.way import AS_DRAWN


@pytest.mark.parametrize("sides", [("up/bottom", "low/rim"), ("low/rim", "up/bottom")])
def test_a_body_approaches_where_it_is_nearest(sides):
    """A block 0.3 above a disk of radius 7; the displacement is that of the second side."""
    disk = {"name": "rim", "kind": "arc", "center": [0, -7], "radius": 7, "angles": [0, 360]}
    spec = problem({"up": elastic(block((-2, 2), (0.3, 1))), "low": elastic({"outer": [disk]})}, 0.01, c=list(sides))
    onto = spec.zones["c"].surface
    assert isinstance(onto, BodySurface)
    assert onto.approach.step == pytest.approx((0, 0.3 if sides[0] == "up/bottom" else -0.3), abs=1e-7)


def test_a_wedge_approaches_both_flanks_of_its_notch():
    """Lifted by 0.5 out of a right-angled notch: a displacement along the normal of one flank would miss the other."""
    notch = polygon(bottom=(-3, -3), right=(3, -3), top=(3, 2), flank=(2, 2), **{"other flank": (0, 0)}, left=(-2, 2),
                    side=(-3, 2))  # fmt: skip
    wedge = polygon(one=(0, 0.5), lid=(1, 1.5), two=(-1, 1.5))
    spec = problem(
        {"up": elastic(wedge), "low": elastic(notch)}, 0.01, c=[["up/one", "up/two"], ["low/flank", "low/other flank"]]
    )
    onto = spec.zones["c"].surface
    assert isinstance(onto, BodySurface)
    assert onto.approach.step == pytest.approx((0, 0.5), abs=1e-9)


def test_a_pin_in_the_middle_of_its_hole_approaches_no_side():
    plate = {**block((-9, 9), (-9, 9)), "holes": [[circle("bore", 5.1, hole=True)]]}
    spec = problem(
        {"pin": elastic({"outer": [circle("rim", 5)]}), "plate": elastic(plate)}, 0.01, c=["pin/rim", "plate/bore"]
    )
    onto = spec.zones["c"].surface
    assert isinstance(onto, BodySurface)
    assert onto.approach == AS_DRAWN
