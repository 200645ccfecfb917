"""Closed loops: joints that are left out, sizes, and loops that do not enclose a body."""

from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from messages import assert_states

from bemcontact.errors import ProblemError
from bemcontact.problems import Arc, Boundary, EllipseArc, Line


def square(side=2.0, **changes):
    """Four lines whose ends are left out."""
    corners = {"bottom": (0, 0), "right": (side, 0), "top": (side, side), "left": (0, side)}
    return [Line(name=name, start=start, elements=2, **changes.get(name, {})) for name, start in corners.items()]


def circle(name="bore", center=(1.0, 1.0), radius=0.5, angles=(360, 0)):
    return Arc(name=name, center=center, radius=radius, angles=angles, elements=8)


def issues(**loops):
    with pytest.raises(ProblemError) as caught:
        Boundary(**loops)
    return [str(issue) for issue in caught.value.issues]


def test_missing_ends_are_taken_from_the_neighbors():
    for edge, following in zip(loop := Boundary(outer=square()).loops[0], (*loop[1:], loop[0]), strict=True):
        assert edge.end == following.start
        assert edge.length == 2


def test_a_line_between_arcs_needs_no_coordinates():
    arcs = [Arc(name=name, center=(x, 0), radius=1, angles=a, elements=4) for name, x, a in
            (("right", 2, (-90, 90)), ("left", 0, (90, 270)))]  # fmt: skip
    lines = [Line(name=name, elements=3) for name in ("top", "bottom")]
    boundary = Boundary(outer=[arcs[0], lines[0], arcs[1], lines[1]])
    assert [edge.length for edge in boundary.edges] == pytest.approx([pi, 2, pi, 2], rel=1e-15)
    assert (boundary.edges[1].start, boundary.edges[1].end) == ((2, 1), (0, 1))
    assert boundary.size == pytest.approx(sqrt(4**2 + 2**2), rel=1e-4)


def test_given_coordinates_take_precedence_over_computed_ones():
    arc = Arc(name="arc", center=(0, 0), radius=1, angles=(0, 30), elements=2)
    tip = (sqrt(3) / 2, 0.5)
    boundary = Boundary(
        outer=[arc, Line(name="radius", start=tip, end=(0, 0), elements=1), Line(name="axis", elements=1)]
    )
    assert boundary.edges[0].end == tip
    assert tuple(boundary.edges[0].points(np.array([1.0]))[0]) == tip


def test_arc_without_angles_runs_in_the_given_direction():
    lines = [Line(name="in", start=(0, 1), end=(0, 0), elements=1), Line(name="out", end=(1, 0), elements=1)]
    quarter = Boundary(outer=[*lines, Arc(name="arc", center=(0, 0), elements=2)])
    assert quarter.edges[2].length == pytest.approx(pi / 2, rel=1e-15)
    corner = [Line(name="low", start=(1, 0), end=(2, 0)), Line(name="far", end=(0, 2)), Line(name="up", end=(0, 1))]
    notch = Boundary(outer=[*corner, Arc(name="arc", center=(0, 0), clockwise=True, elements=2)])
    assert notch.edges[3].length == pytest.approx(pi / 2, rel=1e-15)
    assert np.hypot(*notch.edges[3].points(np.array([0.3]))[0]) == pytest.approx(1, rel=1e-15)


def test_body_with_round_and_elliptic_holes():
    ellipse = EllipseArc(name="slot", center=(3, 3), semi_axes=(0.5, 0.2), angles=(360, 0), rotation=30, elements=12)
    boundary = Boundary(outer=square(4.0), holes=[[circle()], [ellipse]])
    assert [len(loop) for loop in boundary.loops] == [4, 1, 1]
    assert boundary.edges[4].length == pytest.approx(pi, rel=1e-15)
    assert boundary.size == pytest.approx(4 * sqrt(2))


@given(st.floats(0.01, 0.99), st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(1e-6, 1e6))
def test_checks_do_not_depend_on_place_or_unit(radius, x, y, scale):
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * scale + (scale * x, scale * y)
    outer = [Line(name=f"side {i}", start=tuple(corner), elements=2) for i, corner in enumerate(corners.tolist())]
    bore = circle(center=(scale * x, scale * y), radius=scale * radius)
    assert Boundary(outer=outer, holes=[[bore]]).size == pytest.approx(scale * sqrt(8), rel=1e-9)


def test_error_of_an_open_loop_gives_both_points_and_the_distance():
    lines = square()
    lines[0] = Line(name="bottom", start=(0, 0), end=(1.5, 0), elements=2)
    (issue,) = issues(outer=lines)
    assert issue.startswith("outer[1].start: the loop is open: ")
    for part in ("'right' starts at (2, 0)", "ends at (1.5, 0)", "0.5 away", "leave the start out"):
        assert part in issue


def test_all_gaps_are_reported_with_the_end_to_leave_out():
    arc = Arc(name="arc", center=(0, 0), radius=1, angles=(0, 90), elements=2)
    lines = [Line(name="down", start=(0, 0.9), end=(0, 0), elements=1), Line(name="along", end=(0.8, 0), elements=1)]
    first, second = issues(outer=[arc, *lines])
    assert first.startswith("outer[0].angles: the loop is open: 'arc' starts at (1, 0), but 'along'")
    assert "leave the end of 'along' out" in first
    assert second.startswith("outer[1].start: the loop is open: 'down' starts at (0, 0.9), but 'arc'")


def test_error_of_an_open_loop_suspects_angles_in_radians():
    lines = [Line(name="down", start=(0, 1), end=(0, 0), elements=1), Line(name="along", end=(1, 0), elements=1)]
    arc = Arc(name="arc", center=(0, 0), radius=1, angles=(0, 1.5708), elements=2)
    [issue] = issues(outer=[arc, *lines])
    assert issue.endswith("; angles are in degrees, but those of 'arc' may be in radians")
    full = issues(outer=square(), holes=[[circle(angles=(6.2832, 0))]])
    assert full[0].endswith("those of 'bore' may be in radians")
    degrees = arc.model_copy(update={"angles": (0, 80)})
    assert "radians" not in issues(outer=[degrees, *lines])[0]


def test_gap_within_round_off_is_closed():
    lines = square()
    lines[0] = Line(name="bottom", start=(0, 0), end=(2 + 1e-10, 0), elements=2)
    boundary = Boundary(outer=lines)
    assert boundary.edges[0].end == boundary.edges[1].start


def test_error_of_a_missing_joint_names_both_edges():
    lines = square()
    lines[1] = Line(name="right", elements=1)
    (issue,) = issues(outer=lines)
    assert_states(issue, "outer[1]: … start of 'right' … end of 'bottom' … missing; give one")


@pytest.mark.parametrize(
    ("edge", "words"),
    [
        (Line(name="dot", start=(0, 0), end=(0, 0), elements=1), "outer[0]: 'dot' has no length"),
        (
            Arc(name="dot", center=(1, 0), start=(0, 0), end=(0, 0), elements=8),
            "for a full circle give radius and angles",
        ),
        (
            Arc(name="egg", center=(0.5, 0), start=(0, 0), end=(1.1, 0), elements=8),
            "'egg' is not a circular arc: … start … 0.5 … end 0.6",
        ),
    ],
)
def test_degenerate_edges_are_refused(edge, words):
    rest = [Line(name="rise", end=(0, 1), elements=1), Line(name="fall", elements=1)]
    assert_states(issues(outer=[edge, *rest])[0], words)


def test_error_of_a_crossing_names_both_edges_and_the_point():
    corners = [(0, 0), (2, 0), (0, 2), (2, 2)]
    lines = [Line(name=f"side {i}", start=corner, elements=1) for i, corner in enumerate(corners)]
    (issue,) = issues(outer=lines)
    assert issue.startswith("outer[3]: 'side 3' crosses or touches 'side 1' at (1, 1); neighbors may meet")


def test_loop_that_touches_itself_in_a_corner_is_refused():
    corners = [(0, 0), (2, 0), (1, 1), (2, 2), (0, 2), (1, 1)]
    lines = [Line(name=f"side {i}", start=corner, elements=1) for i, corner in enumerate(corners)]
    assert any("at (1, 1)" in line for line in issues(outer=lines))


def test_edge_that_folds_back_on_its_neighbor_is_refused():
    corners = [(0, 0), (2, 0), (2, 2), (2, 1), (0, 1)]
    lines = [Line(name=f"side {i}", start=corner, elements=1) for i, corner in enumerate(corners)]
    assert_states(issues(outer=lines)[0], "'side 2' crosses or touches 'side 1' at (2, 1.5)")


def test_hole_that_crosses_the_outer_loop_or_another_hole_is_refused():
    (issue,) = issues(outer=square(), holes=[[circle(center=(2, 1))]])
    assert_states(issue, "'bore' crosses or touches … at … ; loops must not meet")
    holes = [[circle()], [circle(name="other", center=(1.2, 1.0))]]
    assert_states(
        issues(outer=square(), holes=holes)[0],
        "holes[1][0]: 'other' crosses or touches 'bore' at … ; loops must not meet",
    )
    touching = [[circle(center=(0.6, 1), radius=0.4)], [circle(name="other", center=(1.4, 1), radius=0.4)]]
    (issue,) = issues(outer=square(), holes=touching)
    assert_states(issue, "holes[1][0]: 'other' crosses or touches 'bore' at … ; loops must not meet")


def test_all_loops_with_the_wrong_orientation_are_reported():
    backwards = [
        Line(name=name, start=start, elements=1)
        for name, start in (("left", (0, 0)), ("top", (0, 2)), ("right", (2, 2)), ("bottom", (2, 0)))
    ]
    outer, hole = issues(outer=backwards, holes=[[circle(angles=(0, 360))]])
    assert_states(outer, "outer: … must run counterclockwise, but runs clockwise; list its edges … opposite order")
    assert_states(hole, "holes[0][0].angles: … must run clockwise, but runs counterclockwise; exchange its two angles")


def test_holes_are_inside_the_body():
    assert "outside the outer loop" in issues(outer=square(), holes=[[circle(center=(5, 5))]])[0]
    inner = circle(name="inner", radius=0.25)
    assert "'inner' is inside the hole of 'bore'" in issues(outer=square(), holes=[[circle()], [inner]])[0]


def test_edge_names_are_unique():
    hole = circle(name="top")
    (issue,) = issues(outer=square(), holes=[[hole]])
    assert issue.startswith("holes[0][0].name: the edge outer[2] has the name 'top' too")


def test_loop_without_edges_is_refused():
    (issue,) = issues(outer=[])
    assert_states(issue, "outer: … at least 1 … found an empty list")


@given(st.floats(0.3, 3.0), st.floats(0, 360), st.sampled_from([0.0, 1e-8, -1e-3, -0.5]), st.booleans())
def test_neighbors_meet_at_an_angle(radius, direction, angle, is_hole):
    """A sickle between an arc and a line from its end back along the tangent, or at an angle to it, as body or hole."""
    theta = np.deg2rad(direction + 90)
    end = radius * np.array([np.cos(theta), np.sin(theta)])
    back = theta - pi / 2 - angle  # the direction of the line from the end of the arc
    tip = tuple((end + 2 * radius * np.array([np.cos(back), np.sin(back)])).tolist())
    if is_hole:
        arc = Arc(name="arc", center=(0, 0), radius=radius, angles=(direction, direction + 90))
        corners = {"south": (-20, -20), "east": (20, -20), "north": (20, 20), "west": (-20, 20)}
        loops = {"outer": [Line(name=name, start=corner) for name, corner in corners.items()]}
        loops["holes"] = [[arc, Line(name="line", end=tip), Line(name="close")]]
    else:
        arc = Arc(name="arc", center=(0, 0), radius=radius, angles=(direction + 90, direction))
        loops = {"outer": [Line(name="close", end=tip), Line(name="line"), arc]}
    if angle < -1e-6:
        assert len(Boundary(**loops).edges) == (7 if is_hole else 3)
        return
    (issue,) = issues(**loops)
    names = "'arc' and 'line'" if is_hole else "'line' and 'arc'"
    assert_states(issue, f"{names} meet at an angle of 0 at (…; make the corner wider")


def test_smooth_joints_are_allowed():
    """A stadium: lines go on in arcs without a corner."""
    right, left = (Arc(name=n, center=(x, 0), radius=1, angles=(a, a + 180)) for n, x, a in
                   (("right", 2, -90), ("left", 0, 90)))  # fmt: skip
    Boundary(outer=[Line(name="bottom"), right, Line(name="top"), left])
