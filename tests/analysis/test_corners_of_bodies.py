"""Corners of bodies in contact: beside notches, and where they slide along the other body; either side first."""

import math
import re

import numpy as np
import pytest
from several_bodies import GUIDED, HELD, block, elastic, polygon, problem, rigid

import bemcontact

LOAD, WIDTH = 1.0, 4.4


def wedge_in_notch(angle, base, order, accuracy=0.05):
    """A wedge that fills a notch in the upper side of a base; it stands out of it, and is pressed down."""
    t = math.tan(math.radians(angle))
    notch = polygon(
        bottom=(-6, -6), right=(6, -6), shoulder=(6, 0), face=(2, 0), other=(0, -2 * t), left_shoulder=(-2, 0),
        left=(-6, 0),
    )  # fmt: skip
    edges = {"face": (0, -2 * t), "side": (2.2, 0.2 * t), "top": (2.2, 2), "left": (-2.2, 2), "other": (-2.2, 0.2 * t)}
    wedge = elastic(polygon(**edges), {"top": {"pressure": LOAD}}, 2000.0)
    return problem({"wedge": wedge, "base": base(notch)}, accuracy, c=list(order))


def held(boundary):
    return elastic(boundary, HELD)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("angle", "base", "order"),
    [
        (45.0, rigid, ("wedge", "base")),
        (60.0, rigid, ("wedge", "base")),
        (60.0, held, ("wedge", "base")),
        (62.0, held, ("wedge", "base")),
        (62.0, held, ("base", "wedge")),
    ],
)
def test_a_wedge_fills_its_notch(angle, base, order):
    """The faces coincide, so that they touch up to the corners of the notch, and the force is the load."""
    result = bemcontact.solve(wedge_in_notch(angle, base, order))
    assert result.certified
    assert abs(abs(result.footprint.forces["c"][1]) - LOAD * WIDTH) < 1e-9 * LOAD * WIDTH
    face = 2 / math.cos(math.radians(angle))
    assert [item.length for item in result.footprint.intervals] == pytest.approx([face, face], rel=1e-6)


def half_disk(order, accuracy=0.05):
    """A half disk that is pressed on the edge of a block."""
    disk = {
        "outer": [
            {"name": "under", "kind": "arc", "start": [-2.7, 3], "end": [3.3, 3], "center": [0.3, 3]},
            {"name": "top", "end": [-2.7, 3]},
        ]
    }
    bodies = {
        "disk": elastic(disk, {"top": {"displacement": {"x": 0, "y": -0.05}}}),
        "block": elastic(block((-4, 0.1), (-4, 0)), HELD, 2000.0),
    }
    return problem(bodies, accuracy, c=order)


def cantilevers(order, accuracy=0.05):
    """The lower corner of the tip of a cantilever bends down to another one, and slides along it."""
    held_left = {"left": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": 0.02}}
    bodies = {
        "up": elastic(block((0, 6), (1.02, 2.02)), held_left),
        "low": elastic(block((3, 10), (0, 1)), {"right": {"displacement": {"x": 0, "y": 0}}}),
    }
    return problem(bodies, accuracy, c=order)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stated", "sides"), [(half_disk, ["disk/under", "block/top"]), (cantilevers, ["up/bottom", "low/top"])]
)
def test_a_corner_slides_along_the_other_body_whichever_side_is_first(stated, sides):
    """Forces on both sides are opposite, and those of the two statements are those of the same problem."""
    one, other = (bemcontact.solve(stated(order)) for order in (sides, sides[::-1]))
    assert one.certified
    assert other.certified
    force = one.footprint.forces["c"][1]
    assert abs(force + other.footprint.forces["c"][1]) < 1e-3 * force


@pytest.mark.parametrize("order", [["up", "low"], ["low", "up"]])
def test_a_block_that_slides_off_one_of_the_same_width_does_not_hold(order):
    """Each of the two ends of contact is past a corner of one of the blocks: contact is shorter than computed."""
    bodies = {
        "up": elastic(block((0, 2), (0, 1)), {"top": {"displacement": {"x": 0.2, "y": -0.01}}}, 1000.0),
        "low": elastic(block((0, 2), (-1, 0)), HELD, 800.0),
    }
    result = bemcontact.solve(problem(bodies, 0.05, c=order))
    assert not result.holds
    assert result.penetration is not None
    assert "no surface" in result.penetration.words


@pytest.mark.slow
@pytest.mark.parametrize("pressure", [1.0, 20.0])
def test_a_hook_reaches_around_a_block(pressure: float):
    """Beside the corner of the hook, the side of the block faces the finger, though the face above is nearer.

    So both orders have the same pairs, and the same forces but for the meshes: each is sure to its error bar.
    """
    finger = polygon(
        under=(0, 0), inner=(4.01, 0), tip=(4.01, -3), outer=(5.01, -3), top=(5.01, 2), left=(0, 2)
    )  # fmt: skip
    bodies = {
        "hook": elastic(finger, {**GUIDED, "top": {"pressure": pressure}}),
        "block": elastic(block((0, 4), (-4, 0)), {**GUIDED, "bottom": {"displacement": {"y": 0}}}),
    }
    one, other = (bemcontact.solve(problem(bodies, 0.01, c=pair)) for pair in (["hook", "block"], ["block", "hook"]))
    assert one.holds
    assert other.holds
    assert np.negative(one.footprint.forces["c"]) == pytest.approx(other.footprint.forces["c"], rel=1e-3, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("x", "y"), [(0.01, 0.01), (0.05, 0.02)])
def test_a_block_is_drawn_apart_from_both_faces_of_a_step(x: float, y: float):
    """It has come to touch both, so that the forces are those of a block that is drawn there: its loads."""
    step = polygon(bottom=(-4, -4), right=(6, -4), tread=(6, 0), riser=(0, 0), upper=(0, 3), left=(-4, 3))
    at = block((x, 4 + x), (y, 2 + y))
    pushed = elastic(at, {"top": {"pressure": 1.0}, "right": {"pressure": 1.0}})
    for order in (["block", "step"], ["step", "block"]):
        result = bemcontact.solve(problem({"block": pushed, "step": held(step)}, 0.05, c=order))
        assert result.holds
        assert np.abs(result.footprint.forces["c"]) == pytest.approx([2, 4], rel=1e-12)


@pytest.mark.slow
def test_a_tee_is_pulled_up_in_its_slot():
    """The corners of the slot stand in those of the tee, whose shoulders hold it, whichever body is the first."""
    slot = polygon(
        bottom=(-6, -6), right=(6, -6), shoulder=(6, 0), neck=(1.1, 0), under=(1.1, -1), side=(3.1, -1),
        floor=(3.1, -3), other_side=(-3.1, -3), other_under=(-3.1, -1), other_neck=(-1.1, -1), other=(-1.1, 0),
        left=(-6, 0),
    )  # fmt: skip
    tee = polygon(
        bottom=(-3, -3), side=(3, -3), shoulder=(3, -1), neck=(1, -1), top=(1, 2), other_neck=(-1, 2),
        other_shoulder=(-1, -1), other_side=(-3, -1),
    )  # fmt: skip
    bodies = {"tee": elastic(tee, {"top": {"traction": {"y": 5.0}}}), "slot": held(slot)}
    for order in (["tee", "slot"], ["slot", "tee"]):
        result = bemcontact.solve(problem(bodies, 0.05, c=order))
        assert result.holds
        assert np.abs(result.footprint.forces["c"]) == pytest.approx([0, 10], abs=1e-9)


@pytest.mark.slow
def test_a_key_with_clearance_is_pushed_to_one_side():
    """Both orders have the pressed side, up to the corner of the key beside that of its way."""
    way = polygon(
        bottom=(-5, -5), right=(5, -5), shoulder=(5, 0), wall=(1.05, 0), floor=(1.05, -1), other_wall=(-1.05, -1),
        other=(-1.05, 0), left=(-5, 0),
    )  # fmt: skip
    key = elastic(block((-1, 1), (-1, 1)), {"top": {"traction": {"x": 1.0, "y": -2.0}}})
    for order in (["key", "way"], ["way", "key"]):
        result = bemcontact.solve(problem({"key": key, "way": held(way)}, 0.05, c=order))
        assert result.holds
        assert np.abs(result.footprint.forces["c"]) == pytest.approx([2, 4], rel=1e-9)


@pytest.mark.slow
def test_a_corner_rises_along_the_wall_of_a_way_that_a_key_fills():
    """A couple tilts the key: its lower corner rises off the floor and presses on the wall, which ends at the floor.

    The wall reaches below the corner then, and the end of pressure has moved with the corner: nothing is misplaced,
    whichever body is the first. At its upper end the wall ends with a corner, and so does the pressure. The other lower
    corner, which carries less than a hundredth, gains half of that: a note says so.
    """
    way = polygon(
        bottom=(-5, -5), right=(5, -5), shoulder=(5, 0), wall=(1, 0), floor=(1, -1), other_wall=(-1, -1),
        other=(-1, 0), left=(-5, 0),
    )  # fmt: skip
    key = elastic(block((-1, 1), (-1, 1)), {"top": {"traction": {"x": 1.0, "y": -2.0}}})
    for order in (["key", "way"], ["way", "key"]):
        result = bemcontact.solve(problem({"key": key, "way": held(way)}, 0.05, c=order))
        assert result.holds
        (told,) = re.findall(r", ([\d.]+) % of all force there", " ".join(result.notes))
        assert 0.2 < float(told) < 0.6
        assert np.abs(result.footprint.forces["c"]) == pytest.approx([2, 4], rel=1e-9)
