"""A rigid surface that is the deflected contour of the same body: its gap, its loads, and contact on it."""

import re

import numpy as np
import pytest
from several_bodies import elastic, stated

from bemcontact.analysis.solve import condense, solve
from bemcontact.bem.discretization import body_of
from bemcontact.errors import ProblemError
from bemcontact.problems import Problem

HELD = {"displacement": {"x": 0, "y": 0}}
CONTOUR = ("contact_zones", "seat", "surface")


def contour(conditions, **more):
    return {"kind": "deflected_contour", "conditions": conditions, "direction": [0, 1], **more}


def bar(surface, conditions, width=2.0, height=1.0, modulus=1000.0, ratio=0.0, zones=None, **more):
    """A rectangle on four edges, with Poisson's ratio 0, so that stress along y moves nothing along x."""
    return Problem(
        name="bar",
        material={"young_modulus": modulus, "poisson_ratio": ratio},
        boundary={
            "outer": [
                {"name": "bottom", "start": [0, 0], "elements": 6},
                {"name": "right", "start": [width, 0], "elements": 3},
                {"name": "top", "start": [width, height], "elements": 5},
                {"name": "left", "start": [0, height], "elements": 3},
            ]
        },
        conditions=conditions,
        contact_zones={"seat": {"edges": "bottom", "surface": surface}, **(zones or {})},
        **more,
    )  # pyright: ignore


def lowered(by):
    return {"displacement": {"x": 0, "y": -by}}


def test_bar_that_is_pressed_below_its_contour():
    """The contour is lower by 0.01, the bar by 0.03: it is shortened by 0.02 of its height 1, p = 1000 · 0.02."""
    result = solve(bar(contour({"top": lowered(0.01)}), {"top": lowered(0.03)}))
    assert result.certified
    assert result.contact.initial_gap == pytest.approx(np.full(13, 0.01), rel=1e-12)
    assert result.contact.normals == pytest.approx(np.tile([0.0, 1.0], (13, 1)))
    assert result.solution.pressure == pytest.approx(np.full(13, 20.0), rel=1e-10)


def test_contour_keeps_conditions_that_it_does_not_replace():
    """The top is held for both; a pull of 5 on the bottom lengthens the bar by 5/1000 of its height."""
    gap = body_of(bar(contour({"bottom": {"pressure": -5}}), {"top": HELD})).points.gap
    assert gap == pytest.approx(np.full(13, 0.005), rel=1e-11)


def test_contour_of_a_body_on_springs():
    """A stiff body sinks into its springs by the load of the contour over their stiffness: 3 · 2 / (40 · 2).

    Collocation on this mesh leaves a thousandth of the force.
    """
    sides = {side: {"spring": {"tangent": 40.0, "normal": 10.0}} for side in ("right", "left")}
    gap = body_of(bar(contour({"top": {"pressure": 3}}), sides, modulus=1e9)).points.gap
    assert gap == pytest.approx(np.full(13, 0.075), rel=2e-3)


def test_volume_loads_of_the_problem_do_not_deflect_the_contour():
    """A hanging bar is lengthened by ρ g h²/2E = 0.03 by its weight; the weight in the problem does not act."""
    weight = {"gravity": {"density": 6, "acceleration": [0, -10]}}
    hanging = body_of(bar(contour({}, loads=weight), {"top": HELD}))
    assert hanging.points.gap == pytest.approx(np.full(13, 0.03), rel=1e-3)  # weight is quadratic along the sides
    heavy = bar(contour({"top": lowered(0.01)}), {"top": HELD}, loads=weight)
    assert body_of(heavy).points.gap == pytest.approx(np.full(13, 0.01), rel=1e-12)


def test_pressure_is_the_sum_of_the_loads_of_the_contour_and_of_the_problem():
    """By superposition: a pull of -3 - 2x shapes it, lowering the top by 0.01 between walls adds D · 0.01 everywhere.

    D = E (1 - ν) / ((1 + ν) (1 - 2ν)), the modulus of a bar that cannot widen. The mesh has the sum exactly.
    """
    walls = {"right": {"displacement": {"x": 0}}, "left": {"displacement": {"x": 0}}}
    bent = contour({"bottom": {"pressure": {"constant": -3, "x": -2}}, "top": lowered(0)})
    result = solve(bar(bent, {**walls, "top": lowered(0.01)}, ratio=0.3))
    x = result.contact.points[:, 0]
    assert result.certified
    assert np.ptp(result.contact.initial_gap) > 1e-3  # the contour is bent
    assert result.solution.pressure == pytest.approx(1000 * 0.7 / (1.3 * 0.4) * 0.01 - 3 - 2 * x, rel=1e-9)


def test_result_does_not_depend_on_the_units():
    """In mm and N instead of m and kN: lengths 1e3, stresses 1e-3, the same contact."""
    conditions = {"left": HELD, "top": {"traction": {"y": -4}}}
    in_m = bar(contour({"top": {"traction": {"y": -1}}}), conditions, width=6.0)
    conditions = {"left": HELD, "top": {"traction": {"y": -4e-3}}}
    in_mm = bar(contour({"top": {"traction": {"y": -1e-3}}}), conditions, width=6e3, height=1e3, modulus=1.0)
    first, second = condense(in_m), condense(in_mm)
    assert second.initial_gap == pytest.approx(1e3 * first.initial_gap, rel=1e-9)
    pressure = solve(first).solution.pressure
    assert solve(second).solution.pressure * 1e3 == pytest.approx(pressure, abs=1e-8 * abs(pressure).max())


def test_only_the_direction_of_the_gap_matters_and_not_its_length():
    conditions, other = {"left": HELD, "top": {"traction": {"y": -4}}}, {"top": {"traction": {"y": -1, "x": 3}}}
    straight, steep, slanted, other_way = (
        body_of(bar({**contour(other), "direction": direction}, conditions)).points
        for direction in ([0, 1], [0, 7.5], [-3, 4], [3, 4])
    )
    assert steep.gap == pytest.approx(straight.gap, rel=1e-14)
    assert slanted.normals[0] == pytest.approx([-0.6, 0.8])
    assert slanted.gap + other_way.gap == pytest.approx(2 * 0.8 * straight.gap, abs=1e-12 * abs(straight.gap).max())
    assert abs(slanted.gap - other_way.gap).max() > 1e-6 * abs(straight.gap).max()  # u has a part along x


def test_other_zones_may_have_other_surfaces():
    """A wall beside the bar keeps its own gap. The contour is computed without it."""
    wall = {"edges": "right", "surface": {"kind": "plane", "point": [2.25, 0], "normal": [-1, 0]}}
    body = body_of(bar(contour({"top": lowered(0.01)}), {"top": HELD}, zones={"wall": wall}))
    assert body.points.gap[body.points.zone == 0] == pytest.approx(np.full(13, 0.01), rel=1e-12)
    assert body.points.gap[body.points.zone == 1] == pytest.approx(np.full(6, 0.25), rel=1e-12)  # one end is held


def test_contour_is_computed_on_the_mesh_of_the_problem():
    """Bending of a clamped bar: a finer mesh has a gap at every node too; at the free end the order is one at least."""
    problem = bar(contour({"top": {"traction": {"y": -1}}}), {"left": HELD, "top": {"traction": {"y": -2}}}, width=6.0)
    meshes = [body_of(problem.refined(parts)).points for parts in (1, 2, 4)]
    assert [len(points) for points in meshes] == [12, 24, 48]  # two nodes for each element; the clamped one is none
    first, second, third = (points.gap[-1] for points in meshes)
    assert abs(second - third) < abs(first - second) / 2


def test_body_of_a_contour_must_be_held_without_contact():
    """Contact holds the body in the solution, but nothing holds it for the contour."""
    with pytest.raises(
        ProblemError, match=r"against the translation along \(0, 1\).*prescribe displacements"
    ) as caught:
        body_of(bar(contour({"top": {"pressure": 1}}), {"top": {"pressure": 3}, "left": {"displacement": {"x": 0}}}))
    assert caught.value.issues[0].path == (*CONTOUR, "conditions")


@pytest.mark.parametrize(
    ("own", "kept", "path"),
    [
        ({"top": lowered(0.01)}, {"left": HELD, "top": HELD}, ("conditions", "left")),
        ({"left": HELD}, {"left": lowered(0.01), "top": lowered(0.01)}, (*CONTOUR, "conditions", "left")),
    ],
)
def test_contradictions_are_reported_where_they_are_stated(own, kept, path):
    """The error names the second edge at the corner, with its condition of the problem or of the contour."""
    with pytest.raises(ProblemError, match="different displacements") as caught:
        body_of(bar(contour(own), kept))
    assert {issue.path[: len(path)] for issue in caught.value.issues} == {path}


def test_a_contour_of_one_of_several_bodies_is_that_of_the_body_by_itself():
    """A bar on it, of the same elements where they meet, presses the bar onto its contour and does not deflect that."""
    own, kept = {"top": {"pressure": 0.1}}, {"left": HELD}
    alone = bar(contour(own), kept)
    assert alone.boundary is not None
    edges = alone.boundary.model_dump(exclude_unset=True)["outer"]
    raised = [{**edge, "start": [edge["start"][0], edge["start"][1] + 1.0]} for edge in edges]
    raised[0]["elements"] = edges[2]["elements"]
    several = stated(
        name="bars",
        bodies={
            "over": elastic({"outer": raised}, {"top": {"pressure": 0.4}, "left": HELD}),
            "bar": {"material": alone.material, "boundary": {"outer": edges}, "conditions": kept},
        },
        contacts={"face": {"between": ["over/bottom", "bar/top"]}},
        contact_zones={"seat": {"edges": "bar/bottom", "surface": contour({"bar/top": own["top"]})}},
        accuracy=None,
    )
    one, both = body_of(alone).points, body_of(several).points
    assert one.gap.max() > 1e-4
    of_seat = both.zone == [*several.zones].index("seat")
    assert both.gap[of_seat] == pytest.approx(one.gap, rel=1e-12)
    result = solve(several)
    assert result.certified
    assert np.isfinite(result.stress(np.array([[1.0, 0.5], [1.0, 1.5]])).von_mises).all()


def clamped(depth, **more):
    """A block on a plane, whose left side is clamped; the plane is that much above the lower corner of this side."""
    plane = {"kind": "plane", "point": [0, depth], "normal": [0, 1]}
    return bar(plane, {"left": HELD, "top": {"pressure": 5}}, **more)


def lowered_tool(by):
    return {"tools": {"anvil": {"zones": ["seat"], "displacement": {"y": by}}}}


@pytest.mark.parametrize(
    ("depth", "more"),
    [
        (0.01, {}),
        (-0.02, lowered_tool(0.03)),
        (0.0, {"load_cases": {"on": {"tools": {"anvil": {"displacement": {"y": 0.01}}}}}, **lowered_tool(0.0)}),
    ],
)
def test_a_surface_inside_the_body_where_it_is_held_is_refused(depth, more):
    """The displacement would jump there, and with it the pressure beside it is that of E/r: its force has no bound."""
    with pytest.raises(ProblemError, match=r"at \(0, 0\), this surface is 0\.01 inside it"):
        solve_each(clamped(depth, **more))


def solve_each(problem):
    for case in problem.case_names or (None,):
        solve(problem if case is None else problem.with_case(case))


@pytest.mark.parametrize(
    ("depth", "more"), [(0.0, {}), (-0.01, {}), (1e-7, {}), (0.01, lowered_tool(-0.01)), (0.01, {"free": True})]
)
def test_a_surface_that_reaches_no_held_place_is_not(depth, more):
    """A tool may be moved away, and one that is free to move makes room itself."""
    if more.pop("free", False):
        more = {"tools": {"anvil": {"zones": ["seat"], "force": {"y": 1.0}}}}
    body_of(clamped(depth, **more))


def test_a_tool_that_is_pressed_onto_a_held_place_penetrates_it():
    """It moves until the points beside that place carry its force."""
    tool = {"tools": {"anvil": {"zones": ["seat"], "force": {"y": 30.0}}}}
    result = solve(clamped(0.0, **tool))
    assert result.penetration is not None
    assert result.penetration.at == pytest.approx((0.0, 0.0))
    assert not result.holds


def test_a_point_that_is_held_nearly_along_the_normal_slides_into_a_wedge():
    """Held along x beside a surface whose normal is 0.57 degrees off x; on one 5.7 degrees off it is no wedge."""
    for slope, told in ((0.01, True), (0.1, False)):
        wall = {"left": {"edges": "left", "surface": {"kind": "plane", "point": [0, 0], "normal": [1, slope]}}}
        floor = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
        held = bar(floor, {"top": {"displacement": {"x": 0}, "traction": {"y": -1}}}, zones=wall)
        notes = [note for note in body_of(held).notes if "slides into a wedge" in note]
        assert bool(notes) is told
        assert not told or "but for 0.57 degrees" in notes[0]


def test_a_point_that_is_held_beside_an_elastic_body_slides_into_no_wedge():
    """Both ends of the nose of a cam are held, and the block may come up to them."""
    nose = {"name": "nose", "kind": "arc", "start": [-0.6, 0.2], "end": [0.6, 0.2], "center": [0, 1], "elements": 8}
    disk = elastic({"outer": [nose, {"name": "top", "end": [-0.6, 0.2], "elements": 4}]}, {"top": HELD})
    corners = {"bottom": [-3, -1], "right": [3, -1], "top": [3, 0], "left": [-3, 0]}
    low = elastic({"outer": [{"name": k, "start": at, "elements": 8} for k, at in corners.items()]}, {"bottom": HELD})
    both = stated(name="both", bodies={"disk": disk, "low": low}, contacts={"c": {"between": ["disk/nose", "low/top"]}})
    assert not [note for note in body_of(both).notes if "wedge" in note]


def roller_in_bore(center, load):
    """A roller of radius 8 in a bore of radius 10 about the origin, under its weight."""
    rim = {"name": "rim", "kind": "arc", "center": center, "radius": 8, "angles": [90, 450]}
    bore = {"kind": "circle", "center": [0, 0], "radius": 10, "body": "inside"}
    return stated(
        name="roller in a bore",
        material={"young_modulus": 2e5, "poisson_ratio": 0.3},
        boundary={"outer": [rim]},
        loads={"gravity": {"density": 1.0, "acceleration": load}},
        contact_zones={"bore": {"edges": ["rim"], "surface": bore}},
    )


@pytest.mark.parametrize(
    ("center", "load"), [((1.0, -(3.0**0.5)), (0.0, -0.5)), ((0.3, -1.1), (0.3, -0.4)), ((1, -1), (-0.13, -0.8))]
)
def test_a_roller_off_its_load_line_is_told_where_it_rests_in_its_bore(center, load):
    """Statics: at rest its load goes through both middles. It is as far from the middle of the bore as it is drawn."""
    with pytest.raises(ProblemError, match="slides around the bore") as refused:
        solve(roller_in_bore(center, load))
    moved = re.search(r"moved by \((\S+), (\S+)\)$", str(refused.value))
    assert moved
    there = np.array(center) + [float(number) for number in moved.groups()]
    np.testing.assert_allclose(there, np.hypot(*center) * np.array(load) / np.hypot(*load), atol=1e-9)
    assert solve(roller_in_bore(there.tolist(), load)).certified
