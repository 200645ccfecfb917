"""Outlines from points: what is recognized in them, against the shapes that they are of."""

import math

import numpy as np
import pytest

import bemcontact
from bemcontact.errors import ProblemError, SpecError
from bemcontact.problems import Boundary


def written(tmp_path, *loops, header="x,y", separator=","):
    lines = [header] if header else []
    for number, loop in enumerate(loops):
        lines += [""] * (number > 0)
        lines += [f"{x:.12g}{separator}{y:.12g}" for x, y in loop]
    file = tmp_path / "points.csv"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file


def kinds(boundary):
    return [edge.to_dict().get("kind", "line") for loop in boundary.loop_specs for edge in loop]


def arc(center, radius, first, last, count):
    angles = np.radians(np.linspace(first, last, count))
    return [(center[0] + radius * math.cos(a), center[1] + radius * math.sin(a)) for a in angles]


@pytest.mark.parametrize(("header", "separator"), [("x,y", ","), (None, " "), ("X;Y", ";"), (None, ", ")])
def test_corners_of_a_polygon_are_recognized_whichever_way_it_runs(tmp_path, header, separator):
    """A block with points in between on its sides, clockwise: four lines, counterclockwise."""
    points = [(0, 0), (0, 3), (0, 6), (5, 6), (10, 6), (10, 2), (10, 0), (4, 0), (0, 0)]
    boundary = Boundary(**bemcontact.outline(written(tmp_path, points, header=header, separator=separator)))
    assert kinds(boundary) == ["line"] * 4
    assert sorted(edge.length for edge in boundary.edges) == pytest.approx([6, 6, 10, 10])
    assert {edge.name for edge in boundary.edges} == {f"edge {i}" for i in (1, 2, 3, 4)}


def test_arcs_and_lines_of_a_slot_and_a_round_hole_are_recognized(tmp_path):
    slot = [*arc((30, 5), 5, -90, 90, 25), *arc((0, 5), 5, 90, 270, 25)]
    hole = arc((15, 5), 2, 0, 337.5, 16)
    boundary = Boundary(**bemcontact.outline(written(tmp_path, hole, slot)))
    assert sorted(kinds(boundary)) == ["arc", "arc", "arc", "line", "line"]
    assert math.fsum(edge.length for edge in boundary.loops[0]) == pytest.approx(60 + 10 * math.pi, rel=1e-9)
    assert boundary.loops[1][0].length == pytest.approx(4 * math.pi, rel=1e-9)


def test_a_smooth_curve_between_corners_is_a_spline(tmp_path):
    """Half of an ellipse on a flat side: its length is that of the ellipse to 1e-4, and both corners stay sharp."""
    angles = np.linspace(0, math.pi, 33)
    points = [(8 * math.cos(a), 5 * math.sin(a)) for a in angles]
    boundary = Boundary(**bemcontact.outline(written(tmp_path, points)))
    assert sorted(kinds(boundary)) == ["line", "spline"]
    angle = np.linspace(0, math.pi, 200001)
    length = np.trapezoid(np.hypot(8 * np.sin(angle), 5 * np.cos(angle)), angle)
    (curve,) = (edge for edge in boundary.edges if edge.length > 17)
    assert curve.length == pytest.approx(length, rel=1e-4)


def test_a_closed_smooth_curve_is_one_edge(tmp_path):
    angles = np.linspace(0, 2 * math.pi, 40, endpoint=False)
    points = [(8 * math.cos(a), 5 * math.sin(a)) for a in angles]
    boundary = Boundary(**bemcontact.outline(written(tmp_path, points), scale=0.1))
    assert kinds(boundary) == ["spline"]
    (edge,) = boundary.edges
    assert edge.name == "edge"
    assert edge.directions(np.zeros(1))[0] == pytest.approx(edge.directions(np.ones(1))[0])


def test_a_list_of_points_is_solved_from_a_problem_file(tmp_path):
    """A block under uniform pressure, whose pressure is that everywhere."""
    written(tmp_path, [(0, 0), (10, 0), (10, 6), (0, 6)])
    spec = tmp_path / "block.yaml"
    text = """
    name: block
    material: {young_modulus: 1000, poisson_ratio: 0.3}
    boundary: {file: points.csv}
    conditions: {edge 3: {pressure: 2}, edge 4: {symmetry: x}}
    contact_zones: {foot: {edges: edge 1, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}}
    """
    spec.write_text(text, encoding="utf-8")
    result = bemcontact.solve(bemcontact.load(spec))
    np.testing.assert_allclose(result.pressure, 2.0, rtol=1e-9)
    spec.write_text(text.replace("points.csv", "points.csv, layer: a"), encoding="utf-8")
    with pytest.raises(SpecError, match=r"boundary\.layer: a list of points has no layers"):
        bemcontact.load(spec)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x,y\n0,0\n1,a\n", "points.csv:3: expected two numbers"),
        ("0,0\n1,0,2\n", "points.csv:2: expected two numbers"),
        ("0,0\n1,0\n1,0\n0,1\n", "points.csv:3: the point (1, 0) occurs twice"),
        ("0,O\n1,0\n0,1\n", "points.csv:1: expected two numbers"),
        ("0,0;0,5\n1,0;0,5\n", "points.csv:1: expected two numbers, x and y, with a comma or a blank between; found "),
        ("0,0;0,5\n1,0;0,5\n", "; the decimal sign is a point"),
        ("0,0\n1,inf\n", "points.csv:2: expected finite numbers"),
        ("0,0\n1,0\n0,0\n", "an outline needs three points; found 2"),
        ("x,y\n", "there are no points"),
    ],
)
def test_broken_lists_are_refused_with_the_line(tmp_path, text, words):
    (tmp_path / "points.csv").write_text(text, encoding="utf-8")
    with pytest.raises(ProblemError) as refused:
        bemcontact.outline(tmp_path / "points.csv")
    assert words in str(refused.value)
