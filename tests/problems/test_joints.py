"""Edges that go on in the next one without any change are one edge, wherever they were cut."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bemcontact
from bemcontact.problems import Problem

PLANE = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
CORNERS = [(0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (0.0, 20.0)]


def plate(cuts: list[list[float]], hole: list[float], begin: int = 0, first: float = 90.0, **more) -> Problem:
    """A plate with a hole: each side cut at shares of its length, the circle at angles; the loop begins at an edge.

    The circle begins at an angle `first` of its own; at 90 degrees it is farthest from the foot.
    """
    outer = [
        {"name": f"{number}.{i}".replace(".", "-"), "start": [x0 + share * (x1 - x0), y0 + share * (y1 - y0)]}
        for number, ((x0, y0), (x1, y1)) in enumerate(zip(CORNERS, CORNERS[1:] + CORNERS[:1], strict=True))
        for i, share in enumerate([0.0, *sorted(cuts[number])])
    ]
    angles = [0.0, *sorted(hole, reverse=True), -360.0]
    circle = [
        {"name": f"hole {i}", "kind": "arc", "center": [20, 12], "radius": 3, "angles": [first + a, first + b]}
        for i, (a, b) in enumerate(pairwise(angles))
    ]
    names = [[edge["name"] for edge in outer if edge["name"].startswith(f"{side}-")] for side in range(4)]
    data: dict = {
        "name": "plate", "material": {"young_modulus": 210e3, "poisson_ratio": 0.3},
        "boundary": {"outer": outer[begin:] + outer[:begin], "holes": [circle]},
        "conditions": {name: {"pressure": 10} for name in names[2]},
        "contact_zones": {"foot": {"edges": names[0], "surface": PLANE}},
    }  # fmt: skip
    return Problem(**{**data, **more})


shares = st.lists(st.floats(0.01, 0.99).map(lambda x: round(x, 3)), max_size=3, unique=True)


@pytest.mark.slow
@given(st.tuples(shares, shares, shares, shares), st.lists(st.integers(-359, -1), max_size=3, unique=True), st.data())
def test_cuts_are_undone(cuts: tuple[list[float], ...], hole: list[int], data: st.DataObject):
    """Four sides and one circle are left, of the same length and conditions; and nothing more can be undone."""
    begin, first = data.draw(st.integers(0, 3 + sum(map(len, cuts)))), data.draw(st.sampled_from([90.0, 0.0, -37.5]))
    problem = plate([*cuts], [float(angle) for angle in hole], begin, first)
    whole = problem.without_joints()
    lengths = [[edge.length for edge in loop] for loop in whole.boundary.loops]
    assert sorted(lengths[0]) == pytest.approx([20, 20, 40, 40])
    assert lengths[1] == pytest.approx([6 * np.pi])
    assert [whole.edge(name).length for name in whole.conditions] == [pytest.approx(40)]
    (foot,) = whole.edges_of("foot")
    assert [y for _, y in (whole.edge(foot).start, whole.edge(foot).end)] == [0, 0]
    assert whole.without_joints() is whole
    assert whole.edge(whole.boundary.holes[0][0].name).start == pytest.approx((20, 15), abs=1e-6)
    assert {part for edge in whole.boundary.edges for part in edge.name.split(" + ")} == {
        edge.name for edge in problem.boundary.edges
    }


@pytest.mark.parametrize(
    "more",
    [
        {"conditions": {"2-0": {"pressure": 10}, "2-1": {"pressure": 11}}},
        {"conditions": {}, "load_cases": {"half": {"conditions": {"2-0": {"pressure": 10}}}}},
        {"contact_zones": {"foot": {"edges": "0-0", "surface": PLANE}, "top": {
            "edges": "2-0", "surface": {"kind": "plane", "point": [0, 20], "normal": [0, -1]}}}},
    ],
)  # fmt: skip
def test_what_changes_at_a_joint_keeps_it(more: dict):
    problem = plate([[], [], [0.5], []], [], **{"conditions": {}, **more})
    assert [edge.name for edge in problem.without_joints().boundary.edges] == [
        edge.name for edge in problem.boundary.edges
    ]


@pytest.mark.parametrize("places", [{"elements": 4}, {"ends_at": [0.5]}])
def test_stated_elements_keep_a_joint(places: dict):
    problem = plate([[0.5], [], [], []], [])
    ((key, value),) = places.items()
    problem = problem.with_value(f"boundary.outer.0-1.{key}", value)
    assert problem.without_joints() is problem


def test_arcs_between_points_and_of_ellipses_become_one():
    """A lens of an arc in three parts, the last one on another circle, and an ellipse in two."""
    ellipse = {"kind": "ellipse", "center": [0, 5], "semi_axes": [8, 5]}
    for outer, left in (
        ([{"name": "a", "kind": "arc", "center": [0, 0], "start": [-5, 0], "end": [0, -5]},
          {"name": "b", "kind": "arc", "center": [0, 0], "end": [4, -3]}, {"name": "c", "end": [-5, 0]}],
         ["a + b", "c"]),
        ([{"name": "a", "kind": "arc", "center": [0, 0], "start": [-5, 0], "end": [0, -5]},
          {"name": "b", "kind": "arc", "center": [0, 0], "end": [5, 0]},
          {"name": "c", "kind": "arc", "center": [0, 0], "end": [-5, 0]}], ["a + b + c"]),
        ([{"name": "a", **ellipse, "angles": [-180, -30]}, {"name": "b", **ellipse, "angles": [-30, 0]},
          {"name": "c", "end": [-8, 5]}], ["a + b", "c"]),
    ):  # fmt: skip
        data: dict = {
            "name": "round", "material": {"young_modulus": 1.0, "poisson_ratio": 0.3}, "boundary": {"outer": outer},
            "contact_zones": {"foot": {"edges": ["a", "b"], "surface": {**PLANE, "point": [0, -9]}}},
        }  # fmt: skip
        problem = Problem(**data)
        if len(left) == 1:
            problem = problem.with_value("contact_zones.foot.edges", ["a", "b", "c"])
        whole = problem.without_joints()
        assert [edge.name for edge in whole.boundary.edges] == left
        perimeters = (sum(edge.length for edge in each.boundary.edges) for each in (whole, problem))
        assert next(perimeters) == pytest.approx(next(perimeters), rel=1e-12)


def test_edges_cut_otherwise_have_the_same_bars():
    """Within the contact and beside it, on the hole, and where the loop begins."""
    circle = {"kind": "circle", "center": [20, -300], "radius": 300, "body": "outside"}
    bars = []
    cut = [[0.3, 0.52], [0.5], [0.9], [0.1]]
    for cuts, hole, begin, first in (([[], [], [], []], [], 0, 90.0), (cut, [-100.0, -200.0], 2, 17.0)):
        problem = plate(cuts, hole, begin, first)
        zone = {"foot": {"edges": problem.contact_zones["foot"].edges, "surface": circle}}
        result = bemcontact.solve(Problem(**{**problem.model_dump(), "contact_zones": zone}))
        bars.append([(bar.quantity, bar.value, bar.bar) for bar in result.accuracy.bars])
    for (what, value, error), (other, same, again) in zip(*bars, strict=True):
        assert what == other
        assert value == pytest.approx(same, rel=1e-6)
        assert error == pytest.approx(again, rel=1e-6, abs=1e-12)


V_BLOCK = [{"kind": "plane", "point": [x, -8], "normal": [-x, 8]} for x in (-6, 6)]
BORE = [{"kind": "circle", "center": [0, 3], "radius": 13.1, "body": "inside"}]


def bars_of(outer: list[dict], surfaces: list[dict], aside: float) -> np.ndarray:
    """Values and error bars of a body under its weight, all edges of which may touch all surfaces."""
    data: dict = {
        "name": "round", "material": {"young_modulus": 1e3, "poisson_ratio": 0.3}, "boundary": {"outer": outer},
        "loads": {"gravity": {"density": 1, "acceleration": [aside, -1]}},
        "contact_zones": {f"zone {i}": {"surface": surface} for i, surface in enumerate(surfaces)},
    }  # fmt: skip
    bars = bemcontact.solve(Problem(**data)).accuracy.bars
    return np.array([(bar.value, bar.bar) for bar in bars if bar.bar is not None], float)


@pytest.mark.slow
@pytest.mark.parametrize(("surfaces", "aside"), [(V_BLOCK, 0.3), (V_BLOCK, 0.0), (BORE, 0.0)])
@pytest.mark.parametrize("kind", [{"kind": "arc", "radius": 10}, {"kind": "ellipse", "semi_axes": [10, 9.5]}])
def test_a_closed_edge_has_the_same_bars_wherever_it_begins(surfaces: list[dict], aside: float, kind: dict):
    """A roller in a V, or in a bore: one edge from the right, or three from elsewhere."""
    rim = {**kind, "center": [0, 0]}
    whole = bars_of([{"name": "rim", **rim, "angles": [0, 360]}], surfaces, aside)
    parts = [{"name": f"{i}", **rim, "angles": [*ends]} for i, ends in enumerate(pairwise([-97, 10, 140, 263]))]
    np.testing.assert_allclose(bars_of(parts, surfaces, aside), whole, rtol=1e-6, atol=1e-9)


def test_many_parts_and_taken_names_are_no_mistake():
    """A side in 300 parts has a short name; where the name of a joined edge is taken, edges stay as they are."""
    many = plate([[], [], (np.arange(1, 300) / 300).tolist(), []], [])
    whole = many.without_joints()
    assert len(whole.boundary.outer) == 4
    assert max(len(edge.name) for edge in whole.boundary.edges) < 40
    data = plate([[0.5], [], [], []], []).model_dump()
    outer = [{**edge, "name": "0-0 + 0-1"} if edge["name"] == "1-0" else edge for edge in data["boundary"]["outer"]]
    taken = Problem(**{**data, "boundary": {**data["boundary"], "outer": outer}})
    assert taken.without_joints() is taken


def test_a_deflected_contour_keeps_its_edges():
    """Its conditions name edges as they are stated."""
    conditions = {"2-0": {"pressure": 5}, "2-1": {"pressure": 5}}
    surface = {"kind": "deflected_contour", "direction": [0, 1], "conditions": conditions}
    problem = plate([[], [], [0.5], []], [], contact_zones={"foot": {"edges": "0-0", "surface": surface}})
    assert problem.without_joints() is problem


def test_a_ring_begins_on_one_side_inside_and_outside():
    """Both sides are equally far from the planes above and below; the hole follows the rim, wherever it is cut."""
    planes = {
        "below": {"edges": "rim", "surface": {"kind": "plane", "point": [0, -10], "normal": [0, 1]}},
        "above": {"edges": "rim", "surface": {"kind": "plane", "point": [0, 10], "normal": [0, -1]}},
    }
    for begin in (0.0, 17.0, 163.7, -91.0):
        circle = {"kind": "arc", "center": [0, 0]}
        ring = Problem(
            name="ring", material={"young_modulus": 1.0, "poisson_ratio": 0.3}, contact_zones=planes,
            boundary={"outer": [{"name": "rim", **circle, "radius": 10, "angles": [20, 380]}],
                      "holes": [[{"name": "bore", **circle, "radius": 6, "angles": [begin, begin - 360]}]]},
        )  # fmt: skip  # pyright: ignore[reportArgumentType]
        rim, bore = ring.without_joints().boundary.edges
        assert rim.start == pytest.approx((10, 0), abs=1e-9)
        assert bore.start == pytest.approx((6, 0), abs=1e-9)
        assert bore.length == pytest.approx(12 * np.pi)


@pytest.mark.slow
@pytest.mark.parametrize("begin", [0.0, 17.3, -100.0])
def test_a_rim_that_is_equally_far_over_a_stretch_begins_on_it(begin: float):
    """In a bore around the same center the gap is 0.01; the floor below, at a gap of 0.002, is nearer at the bottom."""
    bore = {"kind": "circle", "center": [0, 0], "radius": 10.01, "body": "inside"}
    floor = {"kind": "plane", "point": [0, -10.002], "normal": [0, 1]}
    rim = {"name": "rim", "kind": "arc", "center": [0, 0], "radius": 10, "angles": [begin, begin + 360]}
    roller = Problem(
        name="roller", material={"young_modulus": 1.0, "poisson_ratio": 0.3}, boundary={"outer": [rim]},
        contact_zones={"bore": {"edges": "rim", "surface": bore}, "floor": {"edges": "rim", "surface": floor}},
    )  # fmt: skip  # pyright: ignore[reportArgumentType]
    x, y = roller.without_joints().boundary.edges[0].start
    assert np.hypot(x, y) == pytest.approx(10)
    assert y + 10.002 >= 0.01 - 1e-8
