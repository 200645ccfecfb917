"""Fillets, tangents and mirrored halves, against closed forms of elementary geometry."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bemcontact
from bemcontact.errors import ProblemError
from bemcontact.problems import Boundary


def line(name, start=None, end=None, **others):
    ends = {key: value for key, value in (("start", start), ("end", end)) if value is not None}
    return {"name": name, **ends, **others}


def box(width=10.0, height=6.0, fillets=(None,) * 4):
    """A block with fillets after its bottom, right, top and left edges."""
    edges = [
        line("bottom", [0, 0], [width, 0]), line("right", end=[width, height]), line("top", end=[0, height]),
        line("left"),
    ]  # fmt: skip
    return [item for edge, radius in zip(edges, fillets, strict=True) for item in (edge, {"fillet": radius})
            if item != {"fillet": None}]  # fmt: skip


def turns(boundary):
    """Angles by which the boundary turns at the joints of its outer loop, by the names of both edges."""
    loop = boundary.loops[0]
    found = {}
    for before, after in zip(loop, (*loop[1:], loop[0]), strict=True):
        one, other = before.directions(np.ones(1))[0], after.directions(np.zeros(1))[0]
        found[before.name, after.name] = math.atan2(one[0] * other[1] - one[1] * other[0], one @ other)
    return found


def length(boundary):
    return math.fsum(edge.length for edge in boundary.loops[0])


@given(st.lists(st.floats(0.1, 2.5), min_size=4, max_size=4))
def test_four_fillets_of_a_block(radii):
    """All joints are smooth, and each fillet shortens the outline by (2 - π/2) r."""
    boundary = Boundary(outer=box(fillets=radii))
    assert max(map(abs, turns(boundary).values())) < 1e-12
    assert length(boundary) == pytest.approx(32 - (2 - math.pi / 2) * math.fsum(radii), rel=1e-12)
    assert [edge.name for edge in boundary.edges][1::2] == ["bottom-right", "right-top", "top-left", "left-bottom"]


def test_a_concave_corner_is_filled():
    """Its fillet runs clockwise, and shortens the outline as much."""
    outer = [
        line("a", [0, 0], [10, 0]), line("b", end=[10, 2]), line("c", end=[4, 2]), {"fillet": 1.0, "name": "root"},
        line("d", end=[4, 8]), line("e", end=[0, 8]), line("f"),
    ]  # fmt: skip
    boundary = Boundary(outer=outer)
    (root,) = (edge for edge in boundary.edges if edge.name == "root")
    np.testing.assert_allclose([root.start, root.end], [[5, 2], [4, 3]], atol=1e-12)
    np.testing.assert_allclose(root.points(np.array([0.5]))[0], [5 - math.sqrt(0.5), 3 - math.sqrt(0.5)], atol=1e-12)
    assert turns(boundary)["c", "root"] == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("clockwise", [False, True])
def test_a_fillet_between_an_arc_and_a_line_or_an_arc_touches_both(clockwise):
    """Its center has the distance r from the line, and R - r (or R + r) from the center of the arc."""
    if clockwise:  # a bite out of the right side
        outer = [
            line("bottom", [0, 0], [10, 0]), line("low", end=[10, 3]), {"fillet": 0.5},
            {"name": "bite", "kind": "arc", "center": [10, 5], "end": [10, 7], "clockwise": True}, {"fillet": 0.5},
            line("high", end=[10, 10]), line("top", end=[0, 10]), line("left"),
        ]  # fmt: skip
        away, center, reach = 9.5, (10, 5), 2 + 0.5
    else:
        outer = [
            {"name": "rim", "kind": "arc", "center": [0, 10], "radius": 10, "angles": [-90, 0]}, {"fillet": 0.5},
            line("top", end=[0, 10]), line("axis"),
        ]  # fmt: skip
        away, center, reach = None, (0, 10), 10 - 0.5
    boundary = Boundary(outer=outer)
    for edge in boundary.edges:
        if "-" in edge.name:
            middle = edge.curve.center
            assert math.dist(middle, center) == pytest.approx(reach, rel=1e-12)
            assert abs(middle[0] - away if away else middle[1] - 9.5) < 1e-12
            assert edge.curve.radii == pytest.approx((0.5, 0.5), rel=1e-12)
    smooth = [turn for names, turn in turns(boundary).items() if any("-" in name for name in names)]
    assert max(map(abs, smooth)) < 1e-9


def cam(flank, lift=25.0):
    return [
        {"name": "base", "kind": "arc", "center": [0, 0], "radius": 20},
        {"name": "up", **flank},
        {"name": "nose", "kind": "arc", "center": [0, lift], "radius": 8},
        {"name": "down", **flank},
    ]


@given(st.floats(12.5, 60))
def test_flanks_of_a_cam_are_tangent_to_both_circles(lift):
    """A tangent of two circles has the length √(d² - (R - r)²); and the cam is symmetric."""
    boundary = Boundary(outer=cam({"tangent": "both"}, lift))
    base, up, nose, down = boundary.edges
    assert up.length == pytest.approx(math.sqrt(lift**2 - 144), rel=1e-12)
    assert down.length == pytest.approx(up.length, rel=1e-12)
    assert max(map(abs, turns(boundary).values())) < 1e-9
    assert base.length / 20 + nose.length / 8 == pytest.approx(2 * math.pi, rel=1e-12)


def test_round_flanks_are_tangent_to_both_circles():
    """The center of such a flank has the distances ρ - R and ρ - r from those of the circles."""
    boundary = Boundary(outer=cam({"kind": "arc", "radius": 60, "tangent": "both"}))
    for flank in boundary.edges[1::2]:
        assert math.dist(flank.curve.center, (0, 0)) == pytest.approx(40, rel=1e-12)
        assert math.dist(flank.curve.center, (0, 25)) == pytest.approx(52, rel=1e-12)
        assert flank.curve.radii == pytest.approx((60, 60), rel=1e-12)
    assert max(map(abs, turns(boundary).values())) < 1e-9


@pytest.mark.parametrize(
    "nose", [{"tangent": "start", "end": [10, 6]}, {"tangent": "end"}], ids=lambda nose: nose["tangent"]
)
def test_an_arc_that_goes_on_smoothly_at_one_end_is_determined_by_both_ends(nose):
    outer = [
        line("bottom", [0, 0], [10, 0]),
        {"name": "nose", "kind": "arc", **nose},
        line("top", [10, 6], [0, 6]),
        line("left"),
    ]
    boundary = Boundary(outer=outer)
    assert boundary.edges[1].length == pytest.approx(3 * math.pi, rel=1e-12)
    assert turns(boundary)["bottom", "nose"] == pytest.approx(0, abs=1e-12)


def test_a_line_from_a_point_touches_a_circle():
    """Pythagoras: its length is √(d² - r²)."""
    outer = [
        line("foot", [-10, 0], [10, 0]), line("up", tangent="end"),
        {"name": "top", "kind": "arc", "center": [0, 12], "radius": 4}, line("down", tangent="start"),
    ]  # fmt: skip
    boundary = Boundary(outer=outer)
    assert boundary.edges[1].length == pytest.approx(math.sqrt(100 + 144 - 16), rel=1e-12)
    assert turns(boundary)["up", "top"] == pytest.approx(0, abs=1e-9)


HALF = [
    line("bottom", [0, 0], [5, 0], elements=3, grading={"ratio": 2, "towards": "end"}), line("side", end=[5, 4]),
    {"name": "dome", "kind": "ellipse", "center": [0, 4], "semi_axes": [5, 3], "angles": [0, 90]},
]  # fmt: skip


def test_mirrored_edges_have_conditions_and_contact():
    """Of one body, as of several: half of an outline, and a foot and a pressure on the other half of it."""
    spec = {
        "name": "mirrored",
        "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
        "boundary": {
            "outer": [line("foot", [0, 0], [2, 0]), line("side", end=[2, 1]), line("top", end=[0, 1])],
            "mirror": {"x": 0},
        },
        "conditions": {"top mirrored": {"pressure": 1.0}, "top": {"pressure": 1.0}},
        "contact_zones": {
            "floor": {
                "edges": ["foot", "foot mirrored"], "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
            }
        },
    }  # fmt: skip
    assert bemcontact.problem(spec).edges_of("floor") == ("foot", "foot mirrored")
    spec["conditions"]["roof mirrored"] = {"pressure": 1.0}
    with pytest.raises(ProblemError, match="unknown edge 'roof mirrored'"):
        bemcontact.problem(spec)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_mirrored_half_is_the_whole(axis):
    """Each point of the image is the mirror image of one of the half, and the area is twice as large."""
    half = HALF
    if axis == "y":  # the half above the line y = 1, drawn from right to left
        half = [line("right", [6, 1], [6, 3]), {"name": "round", "kind": "arc", "center": [3, 3], "end": [0, 3]},
                line("left", end=[0, 1])]  # fmt: skip
    place = 0.0 if axis == "x" else 1.0
    hole = [{"name": "eye", "kind": "arc", "center": [2.0, 2.5], "radius": 0.5, "angles": [360, 0]}]
    boundary = Boundary(outer=half, holes=[hole], mirror={axis: place})
    loop, fractions = boundary.loops[0], np.linspace(0, 1, 7)
    for own in loop[: len(half)]:
        (image,) = (edge for edge in loop if edge.name == f"{own.name} mirrored")
        points = own.points(fractions)
        points[:, "xy".index(axis)] = 2 * place - points[:, "xy".index(axis)]
        np.testing.assert_allclose(image.points(fractions[::-1]), points, atol=1e-12)
    assert [edge.name for edge in boundary.edges[-2:]] == ["eye", "eye mirrored"]
    image = boundary.edges[-1]
    center = [2.0, 2.5]
    center["xy".index(axis)] = 2 * place - center["xy".index(axis)]
    assert image.curve.center == pytest.approx(center)
    if axis == "x":
        np.testing.assert_allclose(1 - loop[-1].breakpoints()[::-1], loop[0].breakpoints(), rtol=1e-12)


def test_what_is_stated_is_kept_and_may_be_varied():
    """A mapping and a study have the fillet, not the arc that it became."""
    stated = {
        "name": "block",
        "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
        "boundary": {"outer": box(fillets=(0.5, 0.5, None, None))[:4] + box()[2:]},
        "conditions": {"top": {"pressure": 1.0}, "left": {"symmetry": "x"}},
        "contact_zones": {"foot": {"edges": "bottom", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
    }
    problem = bemcontact.problem(stated)
    assert problem.to_dict()["boundary"]["outer"][1] == {"fillet": 0.5}
    assert bemcontact.loads(bemcontact.dumps(problem)) == problem
    wider = problem.with_value("boundary.outer[1].fillet", 1.0)
    (arc,) = (edge for edge in wider.edges if edge.name == "bottom-right")
    assert arc.length == pytest.approx(math.pi / 2)
    by_hand = bemcontact.problem(
        {**stated, "boundary": {"outer": [edge.to_dict() for edge in problem.boundary.loop_specs[0]]}}
    )
    one, other = (bemcontact.solve(item, accuracy=0.1) for item in (problem, by_hand))
    np.testing.assert_array_equal(one.pressure, other.pressure)


@pytest.mark.parametrize(
    ("boundary", "words"),
    [
        (
            {"outer": box(fillets=(7.0, None, None, None))},
            "outer[1].fillet: the fillet of radius 7 does not fit on 'right'",
        ),
        ({"outer": box(fillets=(4.0, 4.0, None, None))}, "does not fit on 'right'; take a smaller one"),
        ({"outer": [{"fillet": 1}]}, "outer[0]: a fillet rounds the corner between two edges"),
        ({"outer": [*box()[:1], {"fillet": 1}, {"fillet": 1}, *box()[1:]]}, "outer[2]: two fillets follow each other"),
        (
            {"outer": [line("a", [0, 0], [5, 0]), {"fillet": 1}, line("b", end=[10, 0]), *box()[1:]]},
            "outer[1].fillet: 'a' goes on smoothly in 'b'",
        ),
        ({"outer": [{"name": "a", "kind": "arc", "radius": 3}, line("b")]}, "outer[0].center: missing"),
        (
            {"outer": [{"name": "a", "kind": "arc", "center": [0, 0], "radius": 3}, line("b", [3, 0])]},
            "outer[0]: the start of 'a' is not known",
        ),
        (
            {"outer": [{"name": "a", "kind": "arc", "center": [0, 0], "radius": 3}, line("b", [3, 0], [0, 3.1])]},
            "has the distance 3.1 from the center, and its radius is 3",
        ),
        ({"outer": [line("a", [0, 0], tangent="both"), line("b")]}, "outer[0]: with tangent: both the start follows"),
        ({"outer": cam({"tangent": "both"}, 5)}, "outer[1].tangent: no line is tangent to 'base' and 'nose'"),
        ({"outer": cam({"kind": "arc", "radius": 9, "tangent": "both"})}, "no arc of the radius 9 is tangent"),
        ({"outer": cam({"kind": "arc", "tangent": "both"})}, "needs a radius"),
        ({"outer": [line("a", tangent="both"), line("b", [0, 0])]}, "must be an arc with center and radius"),
        ({"outer": HALF[1:], "mirror": {"x": 0}}, "outer[0]: give the start of 'side'"),
        (
            {"outer": [line("a", [1, 0], [5, 0]), *HALF[1:]], "mirror": {"x": 0}},
            "outer[0].start: the start of 'a' is 1 away",
        ),
        (
            {"outer": [*HALF, line("axis", [0, 7], [0, 0])], "mirror": {"x": 0}},
            "outer[3]: 'axis' lies on the mirror line",
        ),
        ({"outer": HALF, "mirror": {"x": 0, "y": 0}}, "mirror: a mirror line is either"),
    ],
)
def test_what_has_no_outline_is_refused_at_its_place(boundary, words):
    with pytest.raises(ProblemError) as refused:
        Boundary(**boundary)
    assert words in str(refused.value)
