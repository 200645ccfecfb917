"""Contact of bodies that move far before they are held: where they touch, and what is said where they cannot follow.

Rigid surfaces follow the motion; what is said where they stay is tested by keeping them where they are drawn.
"""

import re
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import Phase, example, given, settings
from hypothesis import strategies as st

from bemcontact import follow, problem, solve
from bemcontact.adaptivity import resting_contacts
from bemcontact.adaptivity.resting_contacts import RESTING
from bemcontact.analysis.moved_contact import LEAST_ASKED, NOTED, WITHHELD
from bemcontact.assessment.penetration import Misfit
from bemcontact.problems import Problem

R = 10.0
SAID = NOTED * LEAST_ASKED
"""Change that is noted where no accuracy is asked for."""
TURNS = st.sampled_from([0.0, 33.0, 140.0])
QUICK = [Phase.explicit, Phase.generate]
"""Examples are not made smaller: each takes half a second."""
STEEL = {"young_modulus": 210e3, "poisson_ratio": 0.3}


def shaft(clearance, *, sinks=0.0, turn=270.0, size=1.0):
    """A shaft in a bore, pressed in a direction; it is drawn above the bottom, and sinks so far before it is held."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    center = (sinks - clearance) * c * size, (sinks - clearance) * s * size
    names = {"low": (-4, 4, 24), "east": (4, 90, 16), "upper": (90, 270, 8), "west": (270, 356, 16)}
    graded = {"east": {"ratio": 8, "towards": "start"}, "west": {"ratio": 8, "towards": "end"}}
    arcs = [
        {"name": name, "kind": "arc", "center": (0, 0), "radius": R * size, "angles": (turn + a, turn + b),
         "elements": elements, **({"grading": graded[name]} if name in graded else {})}
        for name, (a, b, elements) in names.items()
    ]  # fmt: skip
    surface = {"kind": "circle", "center": center, "radius": (R + clearance) * size, "body": "inside"}
    data = {
        "name": "shaft",
        "material": STEEL,
        "boundary": {"outer": arcs},
        "loads": {"gravity": {"density": 1 / size, "acceleration": (0.3 * c, 0.3 * s)}},
        "contact_zones": {"bore": {"edges": ["low"], "surface": surface}},
    }
    return Problem(**data)  # pyright: ignore[reportArgumentType]


def as_drawn(stated):
    """The result of a problem whose surfaces follow no motion, as if no change of a peak were worth it."""
    with patch.object(resting_contacts, "RESTING", np.inf):
        return solve(stated)


def stated_change(result):
    """The change of the peak that a note or the verdict states, and whether the result is withheld."""
    texts = [*result.notes, *([result.penetration.words] if result.penetration else [])]
    found = [re.search(r"(rises|falls) by ([\d.e-]+) %", text) for text in texts]
    changes = [float(item[2]) / (100 if item[1] == "rises" else -100) for item in found if item]
    assert len(changes) <= 1
    return changes[0] if changes else 0.0


@pytest.mark.slow
@settings(max_examples=6, deadline=None, phases=QUICK)
@given(st.floats(0.15, 4), st.floats(0, 360), st.sampled_from([1e-3, 1.0, 1e3]))
@example(2.0, 270.0, 1.0)
def test_the_change_of_a_peak_is_that_of_hertz(clearance, turn, size):
    """Drawn concentric, the gap c (1 - cos φ) has the relative radius R²/c; it is R (R + c)/c when it touches."""
    result = as_drawn(shaft(clearance, sinks=clearance, turn=turn, size=size))
    expected = np.sqrt(R / (R + clearance)) - 1
    change = stated_change(result)
    nodes = R * size * np.radians(8) / 48
    of_mesh = (nodes / (np.ptp(result.footprint.intervals[0].arc) / 2)) ** 2 / 2
    written = 0.005 if abs(change) >= 0.1 else 0.0005  # two digits
    if abs(expected) > SAID + 0.005:
        assert change == pytest.approx(expected, abs=of_mesh + written)
    if abs(abs(expected) - WITHHELD) > 0.005:
        assert result.certified == (abs(expected) < WITHHELD)
    assert result.certificate.certified
    if not result.certified:
        assert result.penetration is not None
        assert result.penetration.kind is Misfit.MOVED


@pytest.mark.slow
@settings(max_examples=6, deadline=None, phases=QUICK)
@given(st.floats(0.15, 4), st.floats(0, 360), st.floats(0.1, 1), st.sampled_from([1e-3, 1.0, 1e3]))
@example(2.0, 270.0, 1.0, 1.0)
def test_a_shaft_may_be_drawn_anywhere_above_its_bore(clearance, turn, part, size):
    """It sinks until it touches: the pressure is that of the shaft that is drawn there."""
    there, drawn = (solve(shaft(clearance, sinks=sinks, turn=turn, size=size)) for sinks in (0, part * clearance))
    assert drawn.certified
    assert stated_change(drawn) == 0.0
    assert drawn.peak.pressure == pytest.approx(there.peak.pressure, rel=2 * RESTING * LEAST_ASKED)


@pytest.mark.slow
@settings(max_examples=2, deadline=None, phases=QUICK)
@given(st.floats(0.01, 0.5), st.sampled_from([1e-3, 3e-3, None]))
@example(0.1, 1e-3)
def test_the_accuracy_asked_is_the_change_that_is_noted(clearance, asked):
    """The error bars are those of the gaps as drawn: what the motion changes beyond the accuracy must be said.

    With a load like the clearance the width of the contact, √(load R²/clearance), is the same.
    """
    problem = shaft(clearance, sinks=clearance).with_value("loads.gravity.density", clearance)
    problem = problem.model_copy(update={"accuracy": asked})
    result, least = as_drawn(problem), NOTED * (asked or LEAST_ASKED)
    expected = np.sqrt(R / (R + clearance)) - 1
    if abs(expected) > 1.3 * least:
        assert stated_change(result) == pytest.approx(expected, rel=0.25)
        assert any("error bars" in note for note in result.notes)
    elif abs(expected) < 0.7 * least:
        assert stated_change(result) == 0.0


@pytest.mark.parametrize("clearance", [0.2, 2.0])
def test_the_body_drawn_where_it_touches_has_no_note(clearance):
    result = solve(shaft(clearance))
    assert result.certified
    assert stated_change(result) == 0.0


def test_the_remedy_of_the_message_is_one():
    """Moved as the verdict says, the body is certified, and the peak is what the verdict announced."""
    drawn, moved = as_drawn(shaft(2.0, sinks=2.0)), as_drawn(shaft(2.0))
    assert drawn.penetration.words.startswith("The body moves by (0, -2) against the surface of 'bore', which is")
    ratio = moved.footprint.peak.pressure / drawn.footprint.peak.pressure
    assert ratio - 1 == pytest.approx(stated_change(drawn), abs=0.005)


def block(slide, size=1.0, elements=8):
    """A block on a table that ends 5 from the block, pushed sideways."""
    corners = {"bottom": (0, 0), "right": (20, 0), "top": (20, 20), "left": (0, 20)}
    outer = [{"name": name, "start": (x * size, y * size), "elements": elements} for name, (x, y) in corners.items()]
    line = [(-20 * size, 0), (25 * size, 0), (25 * size, -50 * size)]
    data = {
        "name": "block",
        "material": STEEL,
        "boundary": {"outer": outer},
        "conditions": {"left": {"displacement": {"x": slide * size}}, "top": {"pressure": 1}},
        "contact_zones": {"foot": {"edges": "bottom", "surface": {"kind": "polyline", "points": line}}},
    }
    return Problem(**data)  # pyright: ignore[reportArgumentType]


@pytest.mark.slow
@settings(max_examples=14, deadline=None, phases=QUICK)
@given(
    st.one_of(st.floats(0.01, 40), st.floats(4.9, 6.5)), st.sampled_from([1e-3, 1.0, 1e3]), st.sampled_from([2, 8, 15])
)
@example(30.0, 1.0, 8)
@example(6.2, 1.0, 2)
@example(5.5, 1.0, 8)
def test_pressure_where_no_surface_is_left_is_not_certified(slide, size, elements):
    """The leading corner passes the end of the table, on any mesh: the part of the sole that has no table is known."""
    result = solve(block(slide, size, elements))
    beyond = 20 + slide - 25
    noted = sum("past an end of the surface" in note for note in result.notes)
    if beyond > 1.01 * WITHHELD * 20:
        assert not result.certified
        assert result.penetration.kind is Misfit.OFF
        assert result.penetration.depth == pytest.approx(beyond * size, rel=1e-3)
        assert "no surface" in result.penetration.words
    elif 1.05 * SAID * 20 < beyond < 0.99 * WITHHELD * 20 and beyond < 20 / elements:
        assert result.certified
        assert noted == 1
    elif beyond < 0.95 * SAID * 20:
        assert result.certified
        assert not noted


@pytest.mark.slow
def test_a_path_has_surfaces_where_they_are_touched_at_its_end():
    """The shaft sinks by its gap whatever its weight is: it is certified all along, with the peak of Hertz, like √."""
    path = follow(shaft(2.0, sinks=2.0), "loads.gravity.density", 2.0)
    assert path.certified
    peaks = path.path.pressure.max(axis=1)
    assert peaks[-1] == pytest.approx(
        solve(shaft(2.0).with_value("loads.gravity.density", 2.0)).peak.pressure, rel=5e-4
    )


@pytest.mark.slow
def test_a_path_whose_end_is_elsewhere_says_it():
    """A roller slides by half of its radius over a block; at the begin its normals are those of the end."""
    path = follow(roller_moved_aside(0.0), "tools.roller.displacement.x", 1.5)
    assert not path.certified
    assert path.penetration is not None
    assert path.penetration.kind in (Misfit.MOVED, Misfit.OFF)


def test_a_corner_of_the_surface_under_a_smooth_edge_is_no_alarm():
    """A node on a corner moves along it by less than an element; the peak there belongs to the mesh anyway."""
    corners = {"bottom": (-10, 0), "right": (10, 0), "top": (10, 10), "left": (-10, 10)}
    outer = [{"name": name, "start": corner, "elements": 16} for name, corner in corners.items()]
    line = [(-3.75, -20), (-3.75, 0), (3.75, 0), (3.75, -20)]  # a corner between two nodes would dig into the element
    data = {
        "name": "pad",
        "material": STEEL,
        "boundary": {"outer": outer},
        "conditions": {"left": {"displacement": {"x": 0}}, "top": {"pressure": 300}, "right": {"pressure": -500}},
        "contact_zones": {"pad": {"edges": "bottom", "surface": {"kind": "polyline", "points": line}}},
    }
    result = solve(Problem(**data))  # pyright: ignore[reportArgumentType]
    assert result.penetration is None


def strip(distance, size=1.0, radius=3.0):
    """A cantilever above a round stop, on a mesh that is found: elements are short at the ends of contact."""
    corners = {"bottom": (0, 0), "tip": (20, 0), "top": (20, 2), "wall": (0, 2)}
    outer = [{"name": name, "start": (x * size, y * size)} for name, (x, y) in corners.items()]
    center = (17.0 * size, -(distance + radius) * size)
    data = {
        "name": "strip",
        "material": STEEL,
        "boundary": {"outer": outer},
        "conditions": {"wall": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": 10.0}},
        "contact_zones": {"stop": {"edges": "bottom", "surface": {
            "kind": "circle", "center": center, "radius": radius * size, "body": "outside"}}},
        "accuracy": 0.03,
    }  # fmt: skip
    return Problem(**data)  # pyright: ignore[reportArgumentType]


@pytest.mark.slow
@settings(max_examples=2, deadline=None, phases=QUICK)
@given(st.floats(0.02, 0.2), st.sampled_from([1e-3, 1.0, 1e3]))
@example(0.1, 1.0)
def test_a_path_through_first_touch_is_proved(distance, size):
    """The peak rises from zero like a root: at first touch the gaps after the motion change it by more than itself.

    Each state is that of a solve, and the end of the path is certified if and only if the solution there is.
    """
    problem = solve(strip(distance, size)).problem.model_copy(update={"accuracy": None})
    path = follow(problem, "conditions.top.pressure", 10.0, start=0.0)
    last = solve(problem)
    assert last.certified
    assert path.certified
    assert path.residual < 1e-12
    assert not path.path.pressure[0].any()
    assert path.path.pressure[-1] == pytest.approx(last.solution.pressure, abs=1e-9 * last.footprint.peak.pressure)


@pytest.mark.slow
@settings(max_examples=2, deadline=None, phases=QUICK)
@given(st.floats(0.3, 4))
@example(3.0)
def test_a_path_has_the_curvature_of_its_end(clearance):
    """The shaft sinks by its gap under any weight: each state has the peak of the shaft that is drawn at the bottom."""
    paths = [
        follow(shaft(clearance, sinks=sinks), "loads.gravity.density", 1.0, start=0.1) for sinks in (clearance, 0.0)
    ]
    assert all(path.certified for path in paths)
    for t in (0.0, 0.5, 1.0):
        drawn, there = (path.path.at(t).pressure.max() for path in paths)
        assert drawn == pytest.approx(there, rel=2 * RESTING * LEAST_ASKED)


def on_two_supports(push, radius, sole, *, size=1.0):
    """A block on two round supports that is pushed aside; its sole is a line, or has the grooves of two circles."""
    names = {"sole": (0, 0), "right": (60, 0), "top": (60, 20), "left": (0, 20)}
    outer = [{"name": name, "start": (x * size, y * size)} for name, (x, y) in names.items()]
    if sole == "grooved":
        half = np.degrees(np.arcsin(5 / 12))
        rise = 12 * np.cos(np.radians(half))
        groove = {"kind": "arc", "radius": 12 * size, "angles": (90 + half, 90 - half)}
        first, second = ({**groove, "name": f"groove{x}", "center": (x * size, -rise * size)} for x in (10, 50))
        flat = [{"name": f"flat{x}", "start": (x * size, 0)} for x in (0, 15, 55)]
        outer[:1] = [flat[0], first, flat[1], second, flat[2]]
    depth = (12 - 12 * np.cos(np.arcsin(5 / 12))) if sole == "grooved" else 0.0
    zones = {
        f"at {x}": {
            "edges": f"groove{x}" if sole == "grooved" else "sole",
            "surface": {
                "kind": "circle", "center": (x * size, (depth - radius) * size), "radius": radius * size,
                "body": "outside",
            },
        }
        for x in (10, 50)
    }  # fmt: skip
    return Problem(
        name="block on two supports",
        material=STEEL,
        boundary={"outer": outer},
        conditions={"top": {"traction": {"x": 5 * push, "y": -5}}},
        contact_zones=zones,
    )  # pyright: ignore[reportArgumentType]


@pytest.mark.slow
@settings(max_examples=4, deadline=None, phases=QUICK)
@given(st.floats(-5, -2), st.floats(3, 11.9), st.sampled_from([-1, 1]), st.sampled_from([1e-3, 1e3]))
@example(np.log10(0.008), 10.0, 1, 1.0)
def test_a_flat_block_slides_on_round_supports(power, radius, sense, size):
    """Contact acts along the normal of the sole: nothing balances a push along it, however small."""
    result = solve(on_two_supports(sense * 10**power, radius, "flat", size=size))
    assert not result.certified
    assert result.penetration is not None
    assert "translation along (1, 0)" in result.penetration.words


@pytest.mark.slow
@settings(max_examples=3, deadline=None, phases=QUICK)
@given(st.floats(-5, -2), st.floats(9, 11.5))
@example(-2.0, 11.5)
def test_grooves_hold_a_block_on_round_supports(power, radius):
    """The block moves until the normals are inclined as the load is: by the difference of the radii times that."""
    result = solve(on_two_supports(10**power, radius, "grooved"))
    assert result.certified
    assert result.footprint.resultant.force[0] == pytest.approx(-300 * 10**power, rel=1e-9)


def disc_on_planes(couple, slopes, *, turn=0.0, size=1.0, low=1.0, bore=0.0):
    """A disc under its weight and a couple, which is so many times weight and height, on planes of these slopes.

    An ellipse that is so many times as `low` as wide instead, or with a bore under a pressure, which turns with it.
    """

    def at(angle, radius=R * size):
        return radius * np.cos(np.radians(angle + turn)), radius * np.sin(np.radians(angle + turn))

    angles = {"right": (300, 360), "upper right": (0, 90), "upper left": (90, 180), "left": (180, 240)}
    angles["bottom"] = (240, 300)
    shape = (
        {"kind": "arc", "radius": R * size}
        if low == 1
        else {"kind": "ellipse", "semi_axes": (R * size, low * R * size)}
    )
    arcs = [
        {"name": name, "center": (0, 0), **shape, "angles": (a + turn, b + turn)} for name, (a, b) in angles.items()
    ]
    hole = {"name": "bore", "kind": "arc", "center": (0, 0), "radius": 0.4 * R * size, "angles": (0, -360)}
    up = np.array(at(90, 1.0)) * couple * np.pi / 2 * R * low
    zones = {
        f"plane {slope}": {
            "edges": "bottom",
            "surface": {
                "kind": "plane", "point": at(270 + slope, low * R * size), "normal": at(90 + slope, 1.0)},
        }
        for slope in slopes
    }  # fmt: skip
    loads = {name: sense * up for name, sense in (("upper right", 1), ("upper left", -1))}
    return Problem(
        name="disc",
        material=STEEL,
        boundary={"outer": arcs, **({"holes": [[hole]]} if bore else {})},
        conditions={
            **{name: {"traction": {"x": load[0], "y": load[1]}} for name, load in loads.items()},
            **({"bore": {"pressure": bore}} if bore else {}),
        },
        loads={"gravity": {"density": 1 / size, "acceleration": at(270, 1.0)}},
        contact_zones=zones,
    )  # pyright: ignore[reportArgumentType]


@pytest.mark.slow
@settings(max_examples=3, deadline=None, phases=QUICK)
@given(st.floats(-5, -2), st.sampled_from([(0,), (-25, 25)]), TURNS, st.sampled_from([1e-3, 1e3]),
       st.sampled_from([0.0, 10.0, 40.0]))  # fmt: skip
@example(-3.0, (0,), 0.0, 1.0, 0.0)
@example(-3.0, (-25, 25), 0.0, 1.0, 0.0)
@example(-2.0, (0,), 0.0, 1.0, R / (2 * 0.4**2))
def test_a_couple_rolls_a_disc_on_and_on(power, slopes, turn, size, bore):
    """All normals meet in the middle of a disc, wherever it has turned to: no pressure has a moment about it.

    As drawn, pressure beside the place of contact has a lever, so that the equations balance the couple. A pressure in
    a bore would have the moment of the weight if it kept its direction.
    """
    for sense in (-1, 1):
        result = solve(disc_on_planes(sense * 10**power, slopes, turn=turn, size=size, bore=bore))
        assert result.certificate.certified
        assert not result.certified
        assert result.penetration is not None
        assert "rotation" in result.penetration.words


@pytest.mark.parametrize("low", [0.4, 0.55, 0.65])
def test_a_rocker_is_held_and_its_place_is_said(low):
    """The radius of its sole is R/low, the height of its centroid low R: the former is larger, so that it is held.

    Contact moves from the middle by the lever of the couple as drawn. In the second solution the weight adds low² of
    it.
    """
    result = solve(disc_on_planes(0.01, (0,), low=low))
    assert result.certified
    (told,) = (float(found[1]) for note in result.notes if (found := re.search(r"elsewhere by ([\d.e+-]+) %", note)))
    touching = result.footprint.intervals[0]
    lever = abs(touching.start[0] + touching.end[0]) / 2
    assert told / 100 == pytest.approx(low**2 * lever / np.ptp(touching.arc), rel=0.05)


@pytest.mark.parametrize("slopes", [(0,), (-25, 25)])
def test_a_disc_without_a_couple_rests(slopes):
    assert solve(disc_on_planes(0.0, slopes)).certified


def flat_tool_on_a_dome(moment, height, **along):
    """A dome of radius R below a flat tool with a moment and a pivot so high above its face; and R."""
    rise, R = 10.0, np.hypot(10, 10)
    dome = {"name": "dome", "kind": "arc", "center": (0, -rise), "radius": R, "angles": (45, 135)}
    flat = {"kind": "plane", "point": (0, R - rise), "normal": (0, -1)}
    lines = [
        {"name": name, "start": at} for name, at in {"base": (-10, -8), "right": (10, -8), "left": (-10, 0)}.items()
    ]
    problem = Problem(
        name="flat tool on a dome",
        material=STEEL,
        boundary={"outer": [*lines[:2], dome, lines[2]]},
        conditions={"base": {"displacement": {"x": 0, "y": 0}}},
        contact_zones={"top": {"edges": "dome", "surface": flat}},
        tools={"flat": {
            "zones": "top", "point": (0, R - rise + height * R), "force": {"y": -500, "moment": moment},
            **along}},
        accuracy=0.03,
    )  # pyright: ignore[reportArgumentType] # fmt: skip
    return problem, R


@pytest.mark.parametrize("moment", [100.0, 300.0])
def test_a_flat_tool_that_rolls_on_a_dome_is_held(moment):
    """It turns by M/(F (R + h)) until it touches beside the top; it is lifted by a square of that, which is no motion.

    Contact is where the dome is as steep as the tool, at R times the angle, and the force on the tool is normal to it.
    So both have a lever about the pivot, which is h above the face.
    """
    problem, R = flat_tool_on_a_dome(moment, 1 / 7, displacement={"x": 0})
    result = solve(problem)
    angle = result.contact.tools.displacement(result.solution.rigid_amplitudes)[0, 2]
    assert angle == pytest.approx(moment / (500 * R * (1 + 1 / 7)), rel=0.003)
    assert result.holds
    touching = result.footprint.intervals[0]
    middle = (touching.start[0] + touching.end[0]) / 2
    assert middle == pytest.approx(-R * angle, rel=0.01)
    assert not any("elsewhere" in note for note in result.notes)


@pytest.mark.parametrize(("moment", "certified"), [(10.0, True), (40.0, True), (300.0, False)])
def test_a_flat_tool_that_may_slide_off_a_dome_is_told(moment, certified):
    """It turns by the angle M/(F R), and its force pushes it along by this part of it, which nothing holds."""
    problem, R = flat_tool_on_a_dome(moment, 0.0, force={"x": 0, "y": -500, "moment": moment})
    result = solve(problem)
    texts = [*result.notes, *([result.penetration.words] if result.penetration else [])]
    told = [
        float(found[1]) / 100
        for text in texts
        if (found := re.search(r"push along it after the motion, by ([\d.e-]+) %", text))
    ]
    angle = moment / (500 * R)
    assert told == ([] if angle < SAID else [pytest.approx(angle, rel=0.05)])
    assert result.certified is certified


def roller_moved_aside(share):
    """A roller of radius 3 that rises into a wide block, and moves aside by a share of its radius."""
    edges = [("bottom", -6, 0), ("right", 6, 0), ("top", 6, 6), ("left", -6, 6)]
    return Problem(
        name="roller moved aside",
        material=STEEL,
        boundary={"outer": [{"name": name, "start": (x, y)} for name, x, y in edges]},
        conditions={"top": {"displacement": {"x": 0, "y": 0}}},
        contact_zones={"roll": {"edges": "bottom", "surface": {
            "kind": "circle", "center": (0, -3), "radius": 3, "body": "outside"}}},
        tools={"roller": {
            "zones": "roll", "point": (0, -3), "displacement": {"x": 3 * share}, "force": {"y": 200}}},
    )  # pyright: ignore[reportArgumentType] # fmt: skip


@pytest.mark.parametrize("share", [0.02, -0.5, 1.0])
def test_a_roller_presses_straight_up_where_it_has_moved_to(share):
    """On a wide block it makes no difference to the pressure where it is, up to the sides of the block."""
    result, middle = solve(roller_moved_aside(share)), solve(roller_moved_aside(0.0))
    assert result.certified
    assert not [note for note in result.notes if "moves by" in note]
    assert abs(result.footprint.forces["roll"][0]) < 200 * SAID
    touching = result.footprint.intervals[0]
    assert (touching.start[0] + touching.end[0]) / 2 == pytest.approx(3 * share, abs=0.01 * np.ptp(touching.arc))
    if abs(share) < 0.1:
        assert result.peak.pressure == pytest.approx(middle.peak.pressure, rel=0.01)


@pytest.mark.parametrize("share", [0.004, -0.02, 0.09])
def test_a_force_turns_with_the_normal_of_the_place_that_the_body_moves_to(share):
    """A roller that moves aside by d presses straight up there; its normals turn by d/R."""
    result = as_drawn(roller_moved_aside(share))
    texts = [*result.notes, *([result.penetration.words] if result.penetration else [])]
    told = [float(found[1]) / 100 for text in texts if (found := re.search(r"force .*, ([\d.e-]+) % of it;", text))]
    assert told == ([] if abs(share) < SAID else [pytest.approx(abs(share), abs=0.05 * abs(share) + 0.0005)])
    assert result.certified == (abs(share) < WITHHELD)


def rack(away: float) -> Problem:
    """A roller is pushed against the flank of a tooth, 3 in 10: without friction it presses down by 0.3 of its push."""
    tooth = {"base": (-5, 0), "flank": (5, 0), "tip": (2, 10), "back": (-2, 10)}
    normal = np.array([10.0, 3.0]) / np.hypot(10, 3)
    center = np.array([3.5, 5.0]) + 5 * normal + np.array([away, 0.0])
    return Problem(
        name="rack",
        material=STEEL,
        boundary={"outer": [{"name": name, "start": at} for name, at in tooth.items()]},
        conditions={"base": {"displacement": {"x": 0, "y": 0}}},
        contact_zones={"roller": {"edges": "flank", "surface": {
            "kind": "circle", "center": tuple(center), "radius": 5, "body": "outside"}}},
        tools={"roller": {"zones": "roller", "point": tuple(center), "force": {"x": -300}}},
    )  # pyright: ignore[reportArgumentType] # fmt: skip


@pytest.mark.parametrize("away", [0.75, 0.2, 0.01])
def test_a_roller_may_be_drawn_away_from_a_tooth(away: float):
    """Statics say the force, and Hertz the peak, wherever it comes from."""
    result = solve(rack(away))
    assert result.certified
    x, y = result.footprint.forces["roller"]
    assert (x, y) == pytest.approx((-300, -90), rel=2 * SAID)
    modulus = 210e3 / 0.91
    assert result.peak.pressure == pytest.approx(np.sqrt(np.hypot(x, y) * modulus / np.pi / 5), rel=0.02)


@pytest.mark.parametrize(("away", "certified"), [(0.75, False), (0.2, True), (0.01, True)])
def test_the_component_that_a_tool_does_not_prescribe_is_judged_by_itself(away: float, certified: bool):
    """Drawn away from the flank, the contact is beside the place that is touched first, and its normal is off."""
    result = as_drawn(rack(away))
    assert result.certified is certified
    error = abs(result.footprint.forces["roller"][1] + 90)
    texts = [*result.notes, *([result.penetration.words] if result.penetration else [])]
    told = [float(found[1]) / 100 for text in texts if (found := re.search(r", along y by ([\d.e-]+) %;", text))]
    assert told == ([pytest.approx(error / 90, rel=0.35)] if away > 0.1 else [])


@pytest.mark.parametrize("turn", [0.0, 8.7, 61.0, 135.0])
def test_the_change_of_a_force_is_the_same_in_other_axes(turn: float):
    """A block that slides under a round tool finds normals turned and gaps grown, and the force changes.

    All is turned by an angle, so that one axis may lie nearly across the force: axes do not matter.
    """
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    turned = np.array([[c, s], [-s, c]])
    bottom, right, top, left, center, (x, y) = (
        np.array([(-12, -8), (12, -8), (12, 0), (-12, 0), (0, 5), (0.05, 0.02)]) @ turned
    ).tolist()
    corners = {"bottom": bottom, "right": right, "top": top, "left": left}
    result = as_drawn(
        Problem(
            name="block that slides under a tool",
            material={"young_modulus": 1000, "poisson_ratio": 0.3},
            boundary={"outer": [{"name": name, "start": at} for name, at in corners.items()]},
            conditions={"bottom": {"displacement": {"x": x, "y": y}}},
            contact_zones={"tool": {"edges": "top", "surface": {
                "kind": "circle", "center": center, "radius": 5, "body": "outside"}}},
            accuracy=0.05,
        )  # pyright: ignore[reportArgumentType]
    )  # fmt: skip
    (x, y, told) = re.findall(r"changes by \(([^,]*), ([^)]*)\), ([\d.e-]+) % of it;", " ".join(result.notes))[0]
    force = np.hypot(*result.footprint.forces["tool"])
    change = np.array([float(x), float(y)]) @ turned.T / force  # back in the axes of the block
    assert change[0] == pytest.approx(0.05 / 5, rel=0.02)  # by the turn of the normals, d/R
    assert float(told) / 100 == pytest.approx(np.hypot(*change), abs=0.0005)


def test_an_infinite_peak_does_not_withhold_the_certificate():
    """A flat punch with slopes of 0.02 beside it, a half of 2: its force is P = E* φ sqrt(a² - b²), a/R and φ small.

    The kinks move against the block by 1e-3 of the punch, and with them the nodes where the peak is infinite.
    """
    block = {"bottom": (-100, -100), "right": (100, -100), "top": (100, 0), "left": (-100, 0)}
    surface = {"kind": "polyline", "points": [(50, 0.96), (2, 0), (-2, 0), (-50, 0.96)]}
    problem = Problem(
        name="taper",
        material=STEEL,
        boundary={"outer": [{"name": name, "start": at} for name, at in block.items()]},
        conditions={"bottom": {"displacement": {"x": 0, "y": 0}}},
        contact_zones={"punch": {"edges": "top", "surface": surface}},
        tools={"punch": {"zones": "punch", "point": (0, 0), "force": {"y": -2000}}},
    )  # pyright: ignore[reportArgumentType] # fmt: skip
    result = solve(problem)
    assert result.accuracy.infinite == ("punch",)
    assert result.certified
    (interval,) = result.footprint.intervals
    half = np.hypot(2000 / (210e3 / 0.91 * 0.02), 2.0)
    assert np.ptp(interval.arc) / 2 == pytest.approx(half, rel=0.01)


@pytest.mark.slow
def test_a_small_force_is_judged_by_itself_and_by_statics():
    """A block slides on two round supports to a wall, which must hold all of the side load when they press straight up.

    Where it is drawn, the normals of the supports hold a part: half a per cent of their forces, a third of the wall's.
    The load keeps its direction, as a pressure does not, which turns with the block.
    """
    corners = {"low": (-20, 0), "right": (20, 0), "top right": (20, 10), "load": (15, 10), "top": (13, 10)}
    zones = {
        name: {"edges": edge, "surface": {"kind": "circle", "center": center, "radius": radius, "body": "outside"}}
        for name, edge, center, radius in (
            ("left support", "low", (-15, -20), 20), ("right support", "low", (15, -20), 20),
            ("wall", "right", (70.1, 5), 50),
        )
    }  # fmt: skip
    stated = Problem(
        name="block that slides to a wall",
        material=STEEL,
        boundary={"outer": [{"name": k, "start": at} for k, at in {**corners, "left": (-20, 10)}.items()]},
        conditions={"load": {"traction": {"y": -500}}, "left": {"traction": {"x": 2}}},
        contact_zones=zones,
        accuracy=0.03,
    )  # pyright: ignore[reportArgumentType]
    followed, result = solve(stated), as_drawn(stated)
    assert followed.certified
    bent = 500 * 30**2 / (16 * 210e3 * 10**3 / 12)  # slope of a beam, by which its supports press aside
    assert -followed.contact.resultants(followed.solution.pressure)[2, 0] == pytest.approx(20, abs=500 * bent / 2)
    assert result.penetration is not None
    assert result.penetration.kind is Misfit.MOVED
    (told,) = re.findall(r"against the surface of 'wall', .*, ([\d.e-]+) % of it;", result.penetration.words)
    wall = -result.contact.resultants(result.solution.pressure)[2, 0]
    assert float(told) / 100 == pytest.approx((20 - wall) / wall, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(("radius", "load"), [(68.83, 312.9), (68.44, 1100.8)])
def test_a_roller_in_a_trough_is_held_whatever_the_noise_of_its_mesh(radius, load):
    """Motions of millionths of the contact are none. The half, which symmetry holds, has the same peak."""
    angles = {"whole": ([-90, 270], [], {}), "half": ([-90, 90], [{"name": "axis"}], {"axis": {"symmetry": "x"}})}
    peaks = []
    for part, (own, axis, conditions) in angles.items():
        rim = {"name": "rim", "kind": "arc", "center": [0, 0], "radius": 10, "angles": own}
        trough = {"kind": "circle", "center": [0, radius - 10], "radius": radius, "body": "inside"}
        plate = {"kind": "plane", "point": [0, 10], "normal": [0, -1]}
        spec = {
            "name": "trough",
            "material": {"young_modulus": 210e3, "poisson_ratio": 0.3},
            "boundary": {"outer": [rim, *axis]},
            "conditions": conditions,
            "contact_zones": {
                "trough": {"edges": "rim", "surface": trough}, "plate": {"edges": "rim", "surface": plate}
            },
            "tools": {"plate": {"zones": "plate", "force": {"y": -load if part == "whole" else -load / 2}}},
        }  # fmt: skip
        result = solve(problem(spec))
        assert result.certified
        bars = [bar.bar for bar in result.accuracy.bars if bar.quantity == "peak"]
        peaks.append((result.peak.pressure, max(bars)))
    (whole, more), (half, less) = peaks
    assert whole == pytest.approx(half, rel=more + less)


@pytest.mark.slow
@pytest.mark.parametrize("density", [0.024, 0.16])
def test_a_soft_roller_that_may_spin_has_the_normals_of_a_stiff_body(density):
    """So has half of both, which cannot spin. With its own normals it would have a contact shorter by 1 and 3 %."""

    def solved(angles, edges, left, roller, block):
        rim = {"name": "rim", "kind": "arc", "center": [0, 0], "radius": 8, "angles": angles}
        corners = {"bottom": (left, -24), "right": (24, -24), "top": (24, -8), "left": (left, -8)}
        spec = {
            "name": "roller",
            "materials": {
                "soft": {"young_modulus": 500.0, "poisson_ratio": 0.0},
                "stiff": {"young_modulus": 1e6, "poisson_ratio": 0.3},
            },
            "bodies": {
                "roller": {
                    "material": "soft",
                    "boundary": {"outer": [rim, *edges]},
                    "conditions": roller,
                    "loads": {"gravity": {"density": density, "acceleration": [0, -1]}},
                },
                "block": {
                    "material": "stiff",
                    "boundary": {"outer": [{"name": name, "start": at} for name, at in corners.items()]},
                    "conditions": {"bottom": {"fixed": True}, **block},
                },
            },
            "contacts": {"foot": {"between": ["roller", "block"]}},
            "accuracy": 0.003,
        }  # fmt: skip
        return solve(problem(spec))

    symmetry = {"symmetry": "x"}
    whole = solved([-90, 270], [], -24, {}, {})
    half = solved([-90, 90], [{"name": "axis"}], 0, {"axis": symmetry}, {"left": symmetry})
    assert whole.certified
    assert 2 * half.intervals[0].length == pytest.approx(whole.intervals[0].length, rel=0.003)
    assert half.peak.pressure == pytest.approx(whole.peak.pressure, rel=0.003)


@pytest.mark.slow
@pytest.mark.parametrize("squeeze", [0.05, 0.5])
def test_a_free_ring_in_a_groove_presses_on_its_walls_as_half_of_it_does(squeeze):
    """The squeeze moves its middle down along both walls, by as much as their contacts are long.

    With normals of its own the walls would have twice the force. A twentieth of that is left, which a note tells.
    """
    gap = 0.2 * squeeze + (0.0 if squeeze > 0.1 else -0.004)
    wall, symmetry = 2.5 + gap, {"symmetry": "x"}

    def solved(left, angles, axis, held):
        inner = [] if left == 0 else [(-wall, 0), (-wall, 4), (left, 4)]
        housing = [(left, -5), (8, -5), (8, 4), (wall, 4), (wall, 0), *([(0, 0)] if left == 0 else inner)]
        lid = [(left, 5), (8, 5), (8, 9), (left, 9)]
        rim = {"name": "rim", "kind": "arc", "center": [0, 2.5], "radius": 2.5, "angles": angles}
        seal = problem({
            "name": "seal",
            "materials": {
                "steel": {"young_modulus": 210e3, "poisson_ratio": 0.3},
                "rubber": {"young_modulus": 6.0, "poisson_ratio": 0.49},
            },
            "bodies": {
                "housing": {
                    "material": "steel",
                    "boundary": {"outer": [{"name": f"h{i}", "start": at} for i, at in enumerate(housing)]},
                    "conditions": {"h0": {"fixed": True}, **({"h5": symmetry} if held else {})},
                },
                "ring": {
                    "material": "rubber", "boundary": {"outer": [rim, *axis]},
                    "conditions": {"axis": symmetry} if held else {},
                },
                "lid": {
                    "material": "steel",
                    "boundary": {"outer": [{"name": f"l{i}", "start": at} for i, at in enumerate(lid)]},
                    "conditions": {
                        "l2": {"displacement": {"x": 0, "y": -squeeze}}, **({"l3": symmetry} if held else {})
                    },
                },
            },
            "contacts": {"groove": {"between": ["ring", "housing"]}, "lid": {"between": ["ring", "lid"]}},
        })  # fmt: skip
        result = solve(seal)
        assert result.certified
        groove = [item.force for item in result.intervals if item.zone == "groove"]
        return result, max(abs(x) for x, _ in groove), max(y for _, y in groove)

    whole, on_wall, on_floor = solved(-8, [-90, 270], [], held=False)
    _, half_on_wall, half_on_floor = solved(0, [-90, 90], [{"name": "axis"}], held=True)
    assert on_floor == pytest.approx(2 * half_on_floor, rel=0.005)
    assert on_wall == pytest.approx(half_on_wall, rel=0.05)
    if squeeze > 0.1:
        assert any("both sides of 'groove' move by" in note for note in whole.notes)


def test_sides_that_do_not_move_against_each_other_are_said_to_turn():
    """By symmetry the only point under pressure moves with the block, up to round-off; the normals beside it turn."""
    arc = {"name": "under", "kind": "arc", "center": [0, 8], "radius": 8, "angles": [-90, 0]}
    quarter = [arc, {"name": "top", "end": [0, 8]}, {"name": "axis"}]
    corners = {"bottom": (0, -16), "right": (16, -16), "top": (16, 0), "axis": (0, 0)}
    block = [{"name": name, "start": corner} for name, corner in corners.items()]
    on_axis = {"axis": {"displacement": {"x": 0}}}
    held = {**on_axis, "bottom": {"displacement": {"y": 0}}}
    bodies = {
        name: {
            "material": {"young_modulus": modulus, "poisson_ratio": 0.3},
            "boundary": {"outer": [{**edge, "elements": 6} for edge in edges]},
            "conditions": conditions,
        }
        for name, modulus, edges, conditions in (
            ("roller", 1000, quarter, {**on_axis, "top": {"pressure": 1}}),
            ("block", 500, block, held),
        )
    }
    contacts = {"track": {"between": ["roller/under", "block/top"]}}
    result = solve(problem({"name": "pair", "bodies": bodies, "contacts": contacts, "accuracy": None}))
    assert np.count_nonzero(result.pressure) == 1
    (note,) = [note for note in result.notes if "force between them changes" in note]
    assert note.startswith("both sides of 'track' turn against each other")
    assert "draw the body" not in note
