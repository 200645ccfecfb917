"""Outlines from drawings that the library of a CAD program writes; areas and lengths in closed form."""

import math

import ezdxf
import numpy as np
import pytest
from ezdxf.math import BSpline, fit_points_to_cad_cv, rational_bspline_from_arc

import bemcontact
from bemcontact.errors import ProblemError, SpecError
from bemcontact.problems import Boundary


def drawing(tmp_path, draw, units=4, name="part.dxf"):
    """A file with what `draw` adds to its model space."""
    document = ezdxf.new(units=units)
    draw(document.modelspace())
    document.saveas(tmp_path / name)
    return tmp_path / name


def bracket(space):
    """A block 40 x 20 with a round corner of radius 5 and a hole; pieces in any order and direction."""
    on_layer = {"layer": "foot"}
    space.add_line((40, 0), (0, 0), dxfattribs=on_layer)
    space.add_line((0, 20), (0, 0))
    space.add_arc((35, 15), 5, 0, 90)
    space.add_line((40, 0), (40, 15 + 1e-7))
    space.add_line((0, 20), (35, 20), dxfattribs={"layer": "top"})
    space.add_circle((20, 10), 4, dxfattribs={"layer": "bore"})
    space.add_text("not a part of it")
    space.add_mtext("nor this").set_location((3, 3))


AREA = 40 * 20 - (1 - math.pi / 4) * 25 - 16 * math.pi


def area(boundary):
    """Area inside the loops, by Gauss points of high order on each edge."""
    x, weights = np.polynomial.legendre.leggauss(200)
    total = 0.0
    for edge in boundary.edges:
        fractions = (x + 1) / 2
        points, normals = edge.points(fractions), edge.normals(fractions)
        total += edge.length / 2 * (weights @ np.sum(points * normals, axis=1)) / 2
    return total


def test_a_drawing_is_an_outline_with_names_of_its_layers(tmp_path):
    boundary = Boundary(**bemcontact.outline(drawing(tmp_path, bracket)))
    assert area(boundary) == pytest.approx(AREA, rel=1e-8)
    assert [edge.name for edge in boundary.edges] == ["foot", "edge 1", "edge 2", "top", "edge 3", "bore"]
    assert boundary.edges[0].start == (0, 0)
    assert math.fsum(edge.length for edge in boundary.loops[0]) == pytest.approx(120 - 10 + 2.5 * math.pi, rel=1e-8)


def test_polylines_with_arcs_blocks_and_mirrored_arcs_are_read(tmp_path):
    """A slot of two half circles, in a block that is inserted at (100, 0), around an ellipse."""

    def draw(space):
        slot = space.doc.blocks.new("SLOT")
        slot.add_lwpolyline([(0, 0, 0), (30, 0, 1), (30, 10, 0), (0, 10, 1)], format="xyb", close=True)
        space.add_blockref("SLOT", (100, 0))
        space.add_ellipse((115, 5), (6, 0), 0.5, 0, 2 * math.pi)

    boundary = Boundary(**bemcontact.outline(drawing(tmp_path, draw)))
    assert area(boundary) == pytest.approx(300 + 25 * math.pi - 18 * math.pi, rel=1e-9)

    def lens(space):
        space.add_arc((0, 0), 5, 0, 180)
        space.add_arc((0, 0), 5, 0, 180, dxfattribs={"extrusion": (0, 0, -1)})  # seen from behind, the same half
        space.add_line((5, 0), (-5, 0))

    with pytest.raises(ProblemError, match=r"two pieces lie on each other at \(.*5\)"):
        bemcontact.outline(drawing(tmp_path, lens))


def kinds(boundary):
    return [edge.kind for loop in (boundary.outer, *boundary.holes) for edge in loop]


def test_splines_are_smooth_edges_through_points_of_them(tmp_path):
    """A quarter of a circle as a rational spline of degree two, and a spline with a corner, which makes two edges."""

    def draw(space):
        quarter = rational_bspline_from_arc((0, 0), 5, 0, 90)
        for ends in (((0, 5), (0, 0)), ((0, 0), (5, 0))):
            space.add_line(*ends)
        space.add_spline().apply_construction_tool(quarter)

    boundary = Boundary(**bemcontact.outline(drawing(tmp_path, draw)))
    (edge,) = [edge for edge, kind in zip(boundary.edges, kinds(boundary), strict=True) if kind == "spline"]
    points, normals = edge.points(np.linspace(0, 1, 401)), edge.normals(np.linspace(0, 1, 401))
    step = np.pi / 90  # of the angle between points; a cubic spline is h⁴ 5/384 off a unit circle, its slope h³/24
    assert np.abs(np.hypot(*points.T) - 5).max() < 5 * step**4 * 5 / 384
    assert np.abs(normals - points / 5).max() < step**3 / 24
    assert edge.length == pytest.approx(2.5 * math.pi, rel=1e-6)

    def two_parabolas(space):
        curve = BSpline([(0, 0), (1, 2), (2, 0), (3, 2), (4, 0)], order=3, knots=[0, 0, 0, 1, 1, 2, 2, 2])
        space.add_spline().apply_construction_tool(curve)
        space.add_line((0, 0), (0, -1))
        space.add_line((0, -1), (4, -1))
        space.add_line((4, -1), (4, 0))

    boundary = Boundary(**bemcontact.outline(drawing(tmp_path, two_parabolas)))
    assert sorted(kinds(boundary)) == ["line"] * 3 + ["spline"] * 2
    assert area(boundary) == pytest.approx(4 + 2 * 4 / 3, rel=1e-7)


def test_a_closed_spline_is_a_hole_by_itself(tmp_path):
    """A circle as a rational spline, whose quarters meet in double knots, and one through fitted points."""

    def draw(space):
        space.add_lwpolyline([(-9, -9), (9, -9), (9, 9), (-9, 9)], close=True)
        space.add_spline().apply_construction_tool(rational_bspline_from_arc((0, 0), 5, 0, 360))
        angles = np.linspace(0, 2 * np.pi, 25)[:-1]
        around = [(7 + np.cos(a), 7 + np.sin(a)) for a in angles]
        space.add_spline().apply_construction_tool(fit_points_to_cad_cv([*around, around[0]]))

    boundary = Boundary(**bemcontact.outline(drawing(tmp_path, draw)))
    assert len(boundary.loops) == 3
    assert area(boundary) == pytest.approx(18 * 18 - 25 * np.pi - np.pi, rel=1e-4)


def test_a_spline_without_clamped_ends_is_its_part_between_the_inner_knots(tmp_path):
    """Closed, uniform, of degree three, through (P + 4 Q + R)/6 at knots: its radius is least between them."""
    angles = np.linspace(0, 2 * np.pi, 13)[:-1]
    corners = 5 * np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])

    def draw(space):
        space.add_spline().set_closed(corners, degree=3)

    boundary = Boundary(**bemcontact.outline(drawing(tmp_path, draw)))
    (edge,) = boundary.edges
    least = 5 * (46 * np.cos(np.pi / 12) + 2 * np.cos(np.pi / 4)) / 48
    largest = 5 * (4 + 2 * np.cos(np.pi / 6)) / 6
    radii = np.hypot(*edge.points(np.linspace(0, 1, 12 * 8 + 1)).T)
    assert radii.max() == pytest.approx(max(least, largest), rel=1e-6)
    assert radii.min() == pytest.approx(min(least, largest), rel=1e-6)


def test_a_closed_spline_keeps_a_corner_where_it_begins(tmp_path):
    """A drop: a closed smooth edge would round its tip."""

    def draw(space):
        space.add_spline().apply_construction_tool(BSpline([(0, 0), (6, -5), (6, 5), (0, 0)], order=4))

    boundary = Boundary(**bemcontact.outline(drawing(tmp_path, draw)))
    assert kinds(boundary) == ["spline", "spline"]
    joints = [[edge.directions(np.array([at]))[0] for at in (0.0, 1.0)] for edge in boundary.edges]
    cosines = [one[1] @ other[0] for one, other in zip(joints, joints[::-1], strict=True)]
    assert sorted(cosines) == pytest.approx([(25 - 36) / 61, 1], abs=1e-6)  # at the tip, and at the other joint
    assert area(boundary) == pytest.approx(3 / 20 * 60, rel=1e-7)  # 3/20 P1 x P2


def test_a_layer_and_a_scale_are_chosen(tmp_path):
    def draw(space):
        bracket(space)
        space.add_lwpolyline([(50, 0), (60, 0), (60, 10)], close=True, dxfattribs={"layer": "other"})

    file = drawing(tmp_path, draw)
    boundary = Boundary(**bemcontact.outline(file, layer="other", scale=0.1))
    assert area(boundary) == pytest.approx(0.5, rel=1e-12)
    assert [edge.name for edge in boundary.edges] == ["edge 1", "edge 2", "edge 3"]
    with pytest.raises(ProblemError, match="no outline on the layer 'inner'; there are: foot, 0, top, bore, other"):
        bemcontact.outline(file, layer="inner")


def test_a_list_of_layers_leaves_out_what_is_no_outline_and_keeps_the_names(tmp_path):
    """A center line of any kind may be on another layer; without the list the message says how to leave it out."""

    def draw(space):
        bracket(space)
        space.add_line((-5, 10), (45, 10), dxfattribs={"layer": "center"})

    file = drawing(tmp_path, draw)
    boundary = Boundary(**bemcontact.outline(file, layer=["foot", "0", "top", "bore"]))
    assert boundary == Boundary(**bemcontact.outline(drawing(tmp_path, bracket, name="bare.dxf")))
    with pytest.raises(ProblemError, match=r"open at \(-5, 10\).*'center': layer: \['foot', '0', 'top', 'bore'\]"):
        bemcontact.outline(file)
    with pytest.raises(ProblemError, match="no outline on the layer 'inner'"):
        bemcontact.outline(file, layer=["foot", "inner"])
    (tmp_path / "a.yaml").write_text(SPEC % ("mm", ", layer: [foot, '0', top, bore]"), encoding="utf-8")
    assert bemcontact.load(tmp_path / "a.yaml").boundary == boundary

    def draw_without_end(space):
        bracket(space)
        space.add_xline((0, 10), (1, 0), dxfattribs={"layer": "center"})

    file = drawing(tmp_path, draw_without_end)
    assert Boundary(**bemcontact.outline(file, layer=["foot", "0", "top", "bore"])) == boundary
    with pytest.raises(ProblemError, match=r"XLINE on the layer 'center'.*name the other layers in layer"):
        bemcontact.outline(file)


def test_what_a_block_has_on_layer_0_is_on_the_layer_of_the_block(tmp_path):
    """So CAD programs show it. A part of a block on a layer of its own stays there."""

    def draw(space):
        half = space.doc.blocks.new("HALF")
        half.add_lwpolyline([(0, 0), (4, 0), (4, 3)])
        half.add_line((4, 3), (0, 3), dxfattribs={"layer": "top"})
        for side in (1, -1):
            space.add_blockref("HALF", (0, 0), dxfattribs={"layer": "wall", "xscale": side})

    boundary = Boundary(**bemcontact.outline(drawing(tmp_path, draw)))
    assert area(boundary) == pytest.approx(8 * 3, rel=1e-12)
    assert sorted(edge.name for edge in boundary.edges) == ["top 1", "top 2", *(f"wall {i}" for i in range(1, 5))]


SPEC = """
name: bracket
units: {length: %s, force: N}
material: {young_modulus: 210e3, poisson_ratio: 0.3}
boundary: {file: part.dxf%s}
conditions: {top: {force: {y: -700}}, edge 3: {symmetry: x}}
contact_zones: {foot: {edges: foot, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}}
accuracy: 0.05
"""


def test_a_part_is_solved_without_any_coordinate_typed(tmp_path):
    """From drawing to a certified pressure, whose resultant is the load; the page has the edges written out."""
    drawing(tmp_path, bracket)
    spec = tmp_path / "bracket.yaml"
    spec.write_text(SPEC % ("mm", ""), encoding="utf-8")
    problem = bemcontact.load(spec)
    result = bemcontact.solve(problem)
    assert result.holds
    assert result.forces["foot"][1] == pytest.approx(700, rel=1e-9)
    as_run = bemcontact.spec.as_run(spec.read_text(encoding="utf-8"), str(spec))
    assert bemcontact.loads(as_run) == problem


@pytest.mark.parametrize(
    ("length", "others", "place", "words"),
    [
        ("m", "", "5:18", "the drawing is in mm, and the problem in m; give scale: 0.001"),
        ("mm", ", layer: none", "5:35", "no outline on the layer 'none'"),
        ("mm", ", layer: [foot, 0]", "5:35", "a layer is a text, or a list of texts; write it in quotes"),
        ("mm", ", scale: -1", "5:35", "scale is a number greater than 0"),
        ("mm", ", outer: []", "5:35", "the edges are those of the file"),
    ],
)
def test_mistakes_beside_a_drawing_have_their_places(tmp_path, length, others, place, words):
    drawing(tmp_path, bracket)
    (tmp_path / "a.yaml").write_text(SPEC % (length, others), encoding="utf-8")
    with pytest.raises(SpecError) as refused:
        bemcontact.load(tmp_path / "a.yaml")
    assert f"a.yaml:{place}: boundary." in str(refused.value)
    assert words in str(refused.value)


def box(*pieces):
    def draw(space):
        for start, end in pieces:
            space.add_line(start, end)

    return draw


SIDES = (((0, 0), (4, 0)), ((4, 0), (4, 3)), ((4, 3), (0, 3)), ((0, 3), (0, 0)))


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (
            box(*SIDES[:3], ((0, 3), (0, 0.01))),
            "the outline is open at (0, 0); the nearest other end is 0.01 away, at (0, 0.01)",
        ),
        (box(*SIDES, SIDES[1]), "two pieces lie on each other at (4, 1.5); remove one of them"),
        (
            lambda space: [box(*SIDES)(space), *(space.add_circle((2, 1.5), 1) for _ in range(2))],
            "two pieces lie on each other at (1, 1.5)",
        ),
        (
            lambda space: [box(*SIDES)(space), space.add_circle((9, 9), 1)],
            "outside the outer loop; move it inside, or make it one of the bodies",
        ),
        (box(*SIDES, ((0, 0), (4, 3))), "3 ends meet at (0, 0)"),
        (box(*SIDES, ((2, 2), (2, 2))), "a line without length at (2, 2)"),
        (box(((0, 0), (4, 0)), ((4, 0), (0, 3)), ((0, 3), (4, 3)), ((4, 3), (0, 0))), "cross"),
        (lambda space: space.add_text("nothing"), "has no lines, arcs, circles"),
        (
            lambda space: space.add_spline().apply_construction_tool(BSpline([(0, 0), (0, 0), (1, 1), (2, 0)])),
            "no direction at (0, 0)",
        ),
        (lambda space: space.add_3dface([(0, 0), (1, 1), (2, 0)]), "an entity 3DFACE on the layer '0'"),
    ],
)
def test_broken_outlines_are_refused_with_the_place(tmp_path, draw, words):
    with pytest.raises(ProblemError) as refused:
        Boundary(**bemcontact.outline(drawing(tmp_path, draw)))
    assert words in str(refused.value)


def test_files_that_are_no_drawings_and_a_missing_extra_are_named(tmp_path, monkeypatch):
    with pytest.raises(ProblemError, match="there is no such file"):
        bemcontact.outline(tmp_path / "none.dxf")
    (tmp_path / "text.dxf").write_text("hello", encoding="utf-8")
    with pytest.raises(ProblemError, match="is no drawing in DXF"):
        bemcontact.outline(tmp_path / "text.dxf")
    with pytest.raises(ProblemError, match="scale must be greater than 0"):
        bemcontact.outline(tmp_path / "text.dxf", scale=-1.0)
    monkeypatch.setattr("bemcontact.spec.outline_file.find_spec", lambda name: None)
    with pytest.raises(ProblemError, match=r"bemcontact\[cad\]"):
        bemcontact.outline(tmp_path / "text.dxf")
    with pytest.raises(ProblemError, match=r"boundary\.file: a drawing is read with a problem file"):
        bemcontact.problem({"boundary": {"file": "part.dxf"}})
