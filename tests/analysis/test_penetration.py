"""Penetration of rigid surfaces where there are no contact points: depth, place, and what is tolerated."""

from contextlib import nullcontext

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bemcontact import follow, solve, solve_cases
from bemcontact.analysis.compare import mesh_study
from bemcontact.assessment.penetration import ROUND_OFF, TOLERATED, Misfit
from bemcontact.bem.discretization import body_of
from bemcontact.bem.surface_gaps import FLUSH, NODES, surface_gaps
from bemcontact.errors import ProblemError
from bemcontact.options import ComparisonOptions
from bemcontact.problems import Problem

E, NU, SIDE = 1000.0, 0.3, 10.0
TURNS = st.integers(0, 628).map(lambda hundredths: hundredths / 100)


def seal(*, pressure=40.0, gap=0.02, edges=("bottom",), elements=3, turn=0.0, size=1.0, split=0.5, **more):
    """A square block between a line of symmetry and the wall of a groove, pressed from above; turned and scaled."""
    c, s = np.cos(turn), np.sin(turn)

    def at(x, y):
        return (size * (c * x - s * y), size * (s * x + c * y))

    corners = {
        "bottom": (0, 0),
        "right": (SIDE, 0),
        "upper": (SIDE, split * SIDE),
        "top": (SIDE, SIDE),
        "left": (0, SIDE),
    }
    outer = [{"name": name, "start": at(*corner), "elements": elements} for name, corner in corners.items()]
    held = {"surface": {"kind": "plane", "point": at(0, 0), "normal": (c, s)}, "edges": "left"}
    groove = {"kind": "polyline", "points": [at(-5, 0), at(SIDE + gap, 0), at(SIDE + gap, 2 * SIDE)]}
    data = {
        "name": "seal",
        "accuracy": None,
        "material": {"young_modulus": E, "poisson_ratio": NU},
        "boundary": {"outer": outer},
        "conditions": {"top": {"pressure": pressure}},
        "contact_zones": {"symmetry": held, "groove": {"edges": edges, "surface": groove}},
    }
    return Problem(**{**data, **more})  # pyright: ignore[reportArgumentType]


def bulge(pressure):
    """Displacement of the free side of a block under uniform pressure, plane strain."""
    return NU * (1 + NU) * pressure * SIDE / E


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(st.floats(1, 400), st.floats(0.0005, 0.3), st.floats(0, 6.28), st.sampled_from([1e-3, 1.0, 1e3]))
@example(40.0, 0.02, 0.0, 1.0)
@example(400.0, 0.3, 0.0, 1.0)
def test_depth_of_a_block_that_bulges_into_a_wall(pressure, gap, turn, size):
    """The free side bulges uniformly, in any direction and unit: the depth is the bulge less the gap."""
    problem = seal(pressure=pressure, gap=gap, turn=turn, size=size)
    c, s = np.cos(turn), np.sin(turn)
    press = {**problem.model_dump()["conditions"], "upper": {"pressure": 1e-3}, "right": {"pressure": 1e-3}}
    result = solve(problem.with_value("conditions", press), "complementarity")
    free = bulge(pressure) - (1 - NU**2) * 1e-3 * SIDE / E
    depth, allowed = free - gap, 0.01 * np.hypot(free, (1 - NU**2) * pressure * SIDE / E)
    spread = np.hypot(free, bulge(pressure) / NU)
    second = min(spread / SIDE, 0.05) * spread  # more than the squares over the diagonal
    if depth > allowed + second:
        assert not result.certified
        assert result.certificate.certified
        assert result.penetration is not None
        assert result.penetration.depth == pytest.approx(depth * size, rel=1e-6)
        assert result.penetration.edge in ("right", "upper")
        assert not result.penetration.paired
        x, y = result.penetration.at
        assert c * x + s * y == pytest.approx(SIDE * size, rel=1e-9)
    elif result.penetration is None and depth > allowed:
        assert any("inside its surface" in note for note in result.notes)
    elif depth < 0:
        assert result.certified
        assert result.penetration is None


@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize("kind", ["groove of a zone", "groove of a body"])
def test_an_edge_with_a_condition_is_not_advised_to_touch(kind: str, loaded: bool):
    """A problem that names such an edge as one that may touch is refused: the advice is to divide the edge."""
    press = {"top": {"pressure": 40.0}, **{name: {"pressure": 1e-3} for name in ("right", "upper") if loaded}}

    def problem(*touching: str):
        if kind == "groove of a zone":
            return seal(conditions=press, edges=touching)
        data = seal(conditions=press).to_dict()
        parts = {key: data.pop(key) for key in ("material", "boundary", "conditions")}
        corners = [(-5, 0), (-5, -1), (SIDE + 1, -1), (SIDE + 1, 20), (SIDE + 0.02, 20), (SIDE + 0.02, 0)]
        around = [{"name": f"side {i}", "start": corner} for i, corner in enumerate(corners)]
        data["bodies"] = {"block": parts, "groove": {"rigid": True, "boundary": {"outer": around}}}
        data["contact_zones"] = {"symmetry": {**data["contact_zones"]["symmetry"], "edges": "block/left"}}
        data["contacts"] = {"groove": {"between": [[f"block/{edge}" for edge in touching], "groove"]}}
        return Problem(**data)

    found = solve(problem("bottom"), "complementarity").penetration
    assert found is not None
    assert ("divide it, and" in found.words and "the part without the condition" in found.words) == loaded
    assert ("Name it in between" in found.words or "Add the edge to the zone" in found.words) != loaded
    with pytest.raises(ProblemError, match=r"cannot touch|can have no condition") if loaded else nullcontext():
        problem("bottom", found.edge.removeprefix("block/"))


@pytest.mark.parametrize("edges", [("bottom", "right", "upper"), ("bottom", "right")])
def test_an_edge_that_belongs_to_the_zone_is_held(edges):
    """With the whole side in the zone the wall holds it; with half of it, the other half is in the wall still."""
    result = solve(seal(edges=edges))
    whole = len(edges) == 3
    assert result.certified is whole
    if not whole:
        assert result.penetration is not None
        assert result.penetration.edge == "upper"


@pytest.mark.parametrize("kind", ["polyline", "spline"])
def test_a_bump_between_two_nodes_is_found(kind):
    """The nodes stand on the floor, under uniform pressure, and do not see the bump; finer ones beside its top do.

    One of 17 places of an element is moved to where the floor is nearest. The top of the polyline is sharp, and contact
    counts gaps along the normal of the block there: what remains is what the block moves along the slope.
    """
    points = [(-1.0, 0.0), (5.2, 0.0), (5.6, 0.1), (6.0, 0.0), (11.0, 0.0)]
    zones = {"floor": {"edges": "bottom", "surface": {"kind": kind, "points": points}}}
    zones["symmetry"] = seal().contact_zones["symmetry"]
    problem = seal(elements=4, pressure=5.0, contact_zones=zones)
    result = solve(problem)
    assert result.certificate.certified
    assert not result.certified
    assert result.penetration is not None
    assert result.penetration.paired
    assert result.penetration.edge == "bottom"
    moved = result.displacement([result.penetration.at])[0, 0] if kind == "spline" else 0.0  # a polyline stays
    at = (5.6 - moved, 0.0)
    assert result.penetration.at == pytest.approx(at, abs=1e-3)  # a spline has its top beside its point
    if kind == "polyline":
        assert result.solution.pressure[result.contact.zone == 0] == pytest.approx(5.0, rel=1e-9)
        away = bulge(5.0) * 5.6 / SIDE
        assert (0.1 - away / 4) * np.cos(np.arctan(1 / 4)) <= result.penetration.depth <= 0.1 * (1 + ROUND_OFF)
    beside = problem.with_value("boundary.outer.bottom.ends_at", [0.52, 0.56, 0.6])
    seen, coarser = solve(beside.refined(8)), solve(beside.refined(2))
    assert seen.penetration is not None
    if kind == "spline":
        assert seen.penetration.kind is Misfit.MOVED  # the block bulges along the bump, whose normals turn
    else:
        assert seen.penetration.kind is Misfit.PENETRATION
        assert seen.boundary is not None
        beside = abs(seen.boundary.points - (5.6, 0.0)).max(axis=-1) < 0.4
        along = abs(seen.boundary.displacement[beside, 0]).max()
        assert seen.penetration.depth <= along * np.sin(np.arctan(1 / 4))
        assert coarser.penetration.depth < result.penetration.depth / 10


def test_load_cases_compare_and_paths_say_it():
    problem = seal(pressure=0.5, load_cases={"small": {"conditions": {"top": {"pressure": 1}}},
                               "large": {"conditions": {"top": {"pressure": 40}}}})  # fmt: skip
    cases = solve_cases(problem)
    assert [item.certified for item in cases.results.values()] == [True, False]
    assert not cases.certified
    compared = mesh_study(ComparisonOptions.of("qp3", "tributary", None), problem.with_case("large"), (1, 2))
    assert compared.finest.comparison.certified
    assert not compared.certified
    assert compared.heading == "penetrates a surface"
    assert "penetrates" in compared.verdict
    record = compared.to_dict()
    assert record["certified"] is False
    assert record["levels"][0]["penetration"]["edge"] in ("right", "upper")


@pytest.mark.parametrize(
    ("key", "start", "end", "pressure"),
    [
        ("conditions.top.pressure", 0.5, 40.0, 40.0),
        ("load_cases.more", 0.0, 2.0, 40.0),
        ("load_cases.more", 0.1, 0.4, 8.0),
    ],
)
def test_the_end_of_a_path_penetrates_as_the_solution_there(key, start, end, pressure):
    problem = seal(pressure=0.5, gap=0.05, load_cases={"more": {"conditions": {"top": {"pressure": 19.75}}}},
                   combinations={"none": {"more": 0}}, case="none")  # fmt: skip
    path = follow(problem, key, end, start=start)
    there = solve(problem.with_value(key, end) if "top" in key else problem.with_factors({"more": end}))
    assert path.certified == there.certified
    if bulge(pressure) > 0.06:
        assert path.penetration is not None
        assert there.penetration is not None
        assert path.penetrates_at == end
        assert path.penetration.depth == pytest.approx(there.penetration.depth, rel=1e-9)


@pytest.mark.parametrize("elements", [2, 3, 5, 8, 20])
@pytest.mark.parametrize("up", [1, -1])
@pytest.mark.parametrize("kind", ["circle", "polyline"])
def test_an_edge_in_no_zone_that_crosses_a_surface_is_judged_at_the_crossing_on_each_mesh(kind: str, up: int, elements):
    """The top of a block moves up by γ x, and is crossed by a surface at x = 9 last.

    Beside the crossing places are outside before anything moves, as near to it as one likes. They move into the surface
    by γ x times the component of its normal; down they move out of it.
    """
    slope = 1e-3
    surface, normal = {
        "circle": ({"kind": "circle", "center": (7.8, 11.6), "radius": 2.0, "body": "outside"}, 0.8),
        "polyline": ({"kind": "polyline", "points": [(13, 13), (7, 8.5), (11 / 3, 11), (-9, 11)]}, 0.8),
    }[kind]
    moved = {"displacement": {"x": 0, "y": {"x": up * slope}}}
    outer = [{"name": name, "start": start, "elements": n} for name, start, n in
             (("bottom", (0, 0), 2), ("right", (10, 0), 2), ("top", (10, 10), elements), ("lid", (3, 10), 2),
              ("left", (0, 10), 2))]  # fmt: skip
    data = {
        "name": "crossed",
        "accuracy": None,
        "material": {"young_modulus": E, "poisson_ratio": NU},
        "boundary": {"outer": outer},
        "conditions": {"bottom": moved, "top": moved},
        "contact_zones": {"side": {"edges": "lid", "surface": surface}},
    }
    result = solve(Problem(**data))  # pyright: ignore[reportArgumentType]
    assert any("part of 'top' lies behind the surface of 'side'" in note for note in result.notes)
    if up < 0:
        assert result.penetration is None
        return
    assert result.penetration is not None
    assert result.penetration.kind is Misfit.PENETRATION
    assert result.penetration.depth == pytest.approx(9 * slope * normal, rel=9 * slope)  # over the radius
    assert result.penetration.at == pytest.approx((9, 10), abs=1e-6)


@pytest.mark.parametrize("elements", [3, 4, 5, 16])
def test_what_lies_behind_a_surface_is_noted_and_what_is_flush_is_left_out(elements: int):
    """The floor as a plane goes on below the body; a block with a foot reaches behind it.

    The side of the foot crosses the floor, and moves along itself: whether a node is there does not matter.
    """
    outer = [(0, 0), (4, 0), (4, -2), (8, -2), (8, 6), (0, 6)]
    names = ["sole", "step", "under", "right", "top", "left"]
    data = {
        "name": "foot",
        "material": {"young_modulus": E, "poisson_ratio": NU},
        "boundary": {
            "outer": [{"name": n, "start": at, "elements": elements} for n, at in zip(names, outer, strict=True)]
        },
        "conditions": {"top": {"pressure": 1}, "left": {"displacement": {"x": 0, "y": 0}}},
        "contact_zones": {"floor": {"edges": "sole", "surface": {"kind": "plane", "point": (0, 0), "normal": (0, 1)}}},
    }
    result = solve(Problem(**data))  # pyright: ignore[reportArgumentType]
    assert result.certified
    (note,) = [note for note in result.notes if "behind the surface of 'floor'" in note]
    assert "'right', 'step', 'under'" in note


def test_a_rigid_body_is_advised_where_a_surface_has_no_end():
    """A plane below a body with a foot goes on behind the foot; the side of another body is one already."""
    foot = [(0, 0), (4, 0), (4, -2), (8, -2), (8, 6), (0, 6)]
    names = ["sole", "step", "under", "right", "top", "left"]
    bodies = {
        "foot": {
            "material": {"young_modulus": E, "poisson_ratio": NU},
            "boundary": {"outer": [{"name": n, "start": at, "elements": 3} for n, at in zip(names, foot, strict=True)]},
            "conditions": {"top": {"pressure": 1}, "left": {"displacement": {"x": 0, "y": 0}}},
        },
        "plate": {
            "material": {"young_modulus": E, "poisson_ratio": NU},
            "boundary": {"outer": [{"name": n, "start": at, "elements": 3} for n, at in
                                   (("top", (4, 0)), ("left", (0, 0)), ("base", (0, -4)), ("right", (4, -4)))]},
            "conditions": {"base": {"displacement": {"x": 0, "y": 0}}},
        },
    }  # fmt: skip
    plane = {"kind": "plane", "point": (0, 0), "normal": (0, 1)}
    stated = [
        {"contact_zones": {"floor": {"edges": "foot/sole", "surface": plane}}},
        {"contacts": {"floor": {"between": ["foot/sole", "plate/top"]}}},
    ]
    for more, advised in zip(stated, (True, False), strict=True):
        result = solve(Problem(name="foot", accuracy=None, bodies=bodies, **more))  # pyright: ignore[reportArgumentType]
        (note,) = [note for note in result.notes if "behind the surface of 'floor'" in note]
        assert ("a body with rigid: true" in note) is advised


def block(corners, zones, conditions, *, elements=3, **more):
    """A polygon with the edges 0, 1, ... and these zones, each as edges and surface."""
    outer = [{"name": str(i), "start": tuple(at), "elements": elements} for i, at in enumerate(corners)]
    stated = {name: {"edges": edges, "surface": surface} for name, (edges, surface) in zones.items()}
    data = {
        "name": "block",
        "accuracy": None,
        "material": {"young_modulus": E, "poisson_ratio": NU},
        "boundary": {"outer": outer},
    }
    return Problem(**data, conditions=conditions, contact_zones=stated, **more)  # pyright: ignore[reportArgumentType]


def groove(wall):
    """A floor and a wall."""
    return {"kind": "polyline", "points": [(-50, 0), (wall, 0), (wall, 20)]}


@settings(max_examples=12, deadline=None)
@given(st.floats(0.01, 5), st.floats(-0.1, 0.3))
@example(1.0, 0.05)
@example(3.0, 0.2)
def test_a_tool_carries_a_body_into_a_wall(travel, past):
    """Translations are exact in linear theory, so the depth is the way less the gap, however long the way is."""
    gap, plane = travel * (1 - past), {"kind": "plane", "point": (0, 0), "normal": (1, 0)}
    tool = {"press": {"zones": "press", "point": (0, 5), "displacement": {"x": travel, "y": 0, "rotation": 0}}}
    corners = [(0, 0), (SIDE, 0), (SIDE, SIDE), (0, SIDE)]
    zones = {"floor": ("0", groove(SIDE + gap)), "press": ("3", plane)}
    result = solve(block(corners, zones, {"2": {"pressure": 1.0}, "1": {"pressure": 1.0}}, tools=tool))
    strain = (NU * (1 + NU) - (1 - NU**2)) * SIDE / E  # plane strain, unit pressure on top and on the free side
    depth = travel + strain - gap
    assert result.certificate.certified
    if depth > 0.001:  # strains of 0.001 of the size 14 and their squares explain less
        assert result.penetration is not None
        assert result.penetration.depth == pytest.approx(depth, rel=1e-6)
        assert result.penetration.edge == "1"
    elif depth < 0:
        assert result.certified


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(
    st.one_of(st.just(0.0), st.tuples(st.sampled_from([-1, 1]), st.floats(-9, -1.1)).map(lambda x: x[0] * 10 ** x[1])),
    st.floats(0.3, 1.0),
    st.floats(0, 6.28),
)
@example(0.0, 0.5, 0.0)
@example(1e-5, 0.5, 0.0)
@example(-1e-5, 0.5, 0.0)
@example(-0.05, 0.5, 0.0)
def test_a_side_that_fits_another_face_of_the_surface_penetrates_it(gap, cut, turn):
    """A snug fit, also with interference, is no end of the surface: the depth is that of the side, less the gap."""
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([(c, s), (-s, c)])
    corners = np.array([(0, 0), (SIDE - cut, 0), (SIDE, cut), (SIDE, SIDE), (0, SIDE)]) @ turned
    line = {"kind": "polyline", "points": (np.array(groove(SIDE + gap)["points"]) @ turned).tolist()}
    held = {"kind": "plane", "point": (0, 0), "normal": turned[0].tolist()}
    result = solve(block(corners, {"groove": ("0", line), "held": ("4", held)}, {"3": {"pressure": 40.0}}))
    assert result.boundary is not None
    side = result.boundary.edge == 2
    moved = (result.boundary.displacement[side] @ turned[0]).max() - gap
    assert result.penetration is not None
    assert moved > result.penetration.allowed
    assert result.penetration.depth == pytest.approx(moved, rel=0.02)  # a node may be less deep than its neighborhood
    assert not any("taken to end" in note or "lies behind" in note for note in result.notes)


@pytest.mark.slow
@settings(max_examples=8, deadline=None)
@given(st.one_of(st.just(0.0), st.floats(-9, -3).map(lambda power: 10**power)), st.integers(0, 3))
@example(0.0, 0)
@example(1e-5, 0)
def test_a_pin_that_fits_its_hole_does_not_end_at_its_zone(gap, quarter):
    """A plate on a pin that touches one quarter of the bore; the rim beside it comes down on the pin."""
    corners = [(-4, -4), (4, -4), (4, 4), (-4, 4)]
    pin = {"kind": "circle", "center": (0, 0), "radius": 1 - gap, "body": "outside"}
    arcs = [{"name": f"arc {i}", "kind": "arc", "center": (0, 0), "radius": 1, "angles": (-90 * i, -90 * (i + 1)),
             "elements": 4} for i in range(4)]  # fmt: skip
    fixed = {"0": {"displacement": {"x": 0, "y": 0}}, "2": {"pressure": 20.0}}
    outer = [{"name": str(i), "start": at, "elements": 4} for i, at in enumerate(corners)]
    data = {"name": "plate", "material": {"young_modulus": E, "poisson_ratio": NU}, "conditions": fixed}
    data |= {"boundary": {"outer": outer, "holes": [arcs]}}
    data |= {"contact_zones": {"pin": {"edges": f"arc {quarter}", "surface": pin}}}
    result = solve(Problem(**data))
    assert result.penetration is not None
    assert result.boundary is not None
    nodes = (result.boundary.points + result.boundary.displacement)[result.boundary.edge >= 4]
    assert result.penetration.depth >= (1 - gap - np.hypot(*nodes.reshape(-1, 2).T)).max() * (1 - 1e-9)
    assert not any("taken to end" in note for note in result.notes)


@pytest.mark.parametrize(("beyond", "ended"), [(0.0, True), (1e-4, False)])
def test_a_straight_face_may_end_where_its_zone_ends(beyond, ended):
    """Half of the sole is on the floor; the other half sinks below the floor, and so does the foot beyond a notch.

    A foot that does not continue the sole directly, and one beyond a notch alone, is in the floor.
    """
    corners = [(0, 0), (5, 0), (7, beyond), (7, 1), (8, 1), (8, 0.001), (SIDE, 0.001), (SIDE, SIDE), (0, SIDE)]
    floor = {"kind": "plane", "point": (0, 0), "normal": (0, 1)}
    result = solve(block(corners, {"floor": ("0", floor)}, {"7": {"pressure": 5.0}, "8": {"displacement": {"x": 0}}}))
    notes = [note for note in result.notes if "taken to end at (5, 0)" in note]
    assert result.certificate.certified
    assert result.certified is ended
    assert len(notes) == ended
    assert all("'1' lies in it" in note and "'floor'" in note for note in notes)


@pytest.mark.slow
@settings(max_examples=15, deadline=None)
@given(
    st.one_of(st.just(0.0), st.floats(-9, -4).map(lambda power: 10**power)),
    st.tuples(st.floats(1, 4), st.floats(6, 8)),
    TURNS,
    st.sampled_from(["one zone", "two zones", "plane beyond", "polyline beyond"]),
)
@example(0.0, (3.0, 6.0), 0.0, "one zone")
@example(0.0, (3.0, 6.0), 1.0, "two zones")
@example(0.0, (3.0, 6.0), 0.0, "polyline beyond")
def test_a_surface_does_not_end_where_it_goes_on(gap, between, turn, kind):
    """A sole with a shallow notch, or none: its material sinks into the floor beside the zone or between two edges.

    The deepest node of the notch is known from the displacements. Only a plane may end where its zone ends, and a floor
    of two zones, two pads, between them.
    """
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([(c, s), (-s, c)])
    (left, right), beyond = between, "beyond" in kind
    sole = [(0, 0), (right, 0), (SIDE, gap)] if beyond else [(0, 0), (left, 0), ((left + right) / 2, gap), (right, 0)]
    corners = [*sole, *([] if beyond else [(SIDE, 0)]), (SIDE, SIDE), (0, SIDE)]
    points = (np.array([(-1, 0), (SIDE + 1, 0)]) @ turned).tolist()
    plane = {"kind": "plane", "point": (0, 0), "normal": turned[1].tolist()}
    floor = plane if kind != "polyline beyond" else {"kind": "polyline", "points": points}
    own = ["0"] if beyond else ["0", "3"]
    zones = {"floor": (own, floor)} if kind != "two zones" else {f"zone {name}": (name, floor) for name in own}
    zones["wall"] = (str(len(corners) - 1), {"kind": "plane", "point": (0, 0), "normal": turned[0].tolist()})
    loads = {str(len(corners) - 2): {"pressure": 20.0}}
    result = solve(block((np.array(corners) @ turned).tolist(), zones, loads, elements=4))
    assert result.boundary is not None
    notch = np.isin(result.boundary.edge, [1] if beyond else [1, 2])
    depth = -((result.boundary.points + result.boundary.displacement)[notch] @ turned[1]).min()
    assert depth > TOLERATED * min(result.contact.scales.displacement, bulge(20.0))
    if kind in ("plane beyond", "two zones") and gap <= FLUSH * result.problem.boundary.size:
        assert result.penetration is None or result.penetration.kind is Misfit.MOVED  # a block that tips may slide
        assert sum("taken to end" in note for note in result.notes) >= 1
    else:
        assert result.penetration is not None
        assert result.penetration.depth == pytest.approx(depth, rel=0.02)  # a node may be less deep than beside it
        assert result.penetration.edge in ("1", "2")


@pytest.mark.slow
@pytest.mark.parametrize(
    "side", [[[-60, -5], [-60, 0], [-40, 0], [-40, -5]], [[-60, -5], [-60, 0], [-40, 0], [-39, -5]]]
)
@pytest.mark.parametrize("zones", [("a", "c"), (["a", "b"], ["b", "c"])])
def test_a_sole_may_sag_beside_the_corner_of_a_pad(side, zones):
    """Places beside the corner of a pad slide over it by less than they sag: theory does not tell where they are."""
    other = [[-x, y] for x, y in side[::-1]]
    outline = [(-60, 0), (-40, 0), (40, 0), (60, 0), (60, 20), (-60, 20)]
    data = {
        "name": "sole", "material": {"young_modulus": 210e3, "poisson_ratio": 0.3}, "accuracy": 0.05,
        "boundary": {"outer": [{"name": n, "start": at} for n, at in zip("abcdef", outline, strict=True)]},
        "conditions": {"e": {"pressure": 20.0}},
        "contact_zones": {n: {"edges": edges, "surface": {"kind": "polyline", "points": points}}
                          for n, edges, points in zip(("left", "right"), zones, (side, other), strict=True)},
    }  # fmt: skip
    result = solve(Problem(**data))
    assert result.penetration is None
    assert result.footprint.resultant.force[1] == pytest.approx(20.0 * 120)


@settings(max_examples=8, deadline=None)
@given(st.floats(-4, -0.3), TURNS, st.booleans())
@example(-1.0, 0.0, True)
@example(-1.0, 0.0, False)
def test_interference_that_is_drawn_is_as_one_that_a_tool_makes(power, turn, both):
    """A flat punch on the middle of the top, or one on both sides: the same pressure, verdict, depth and note."""
    d, c, s = 10**power, np.cos(turn), np.sin(turn)
    turned = np.array([(c, s), (-s, c)])
    corners = (np.array([(0, 0), (SIDE, 0), (SIDE, SIDE), (7, SIDE), (3, SIDE), (0, SIDE)]) @ turned).tolist()
    edges = ("2", "4") if both else "3"
    results = []
    for drawn, moved in ((d, 0.0), (0.0, d)):
        point = (np.array([0, SIDE - drawn]) @ turned).tolist()
        zones = {"punch": (edges, {"kind": "plane", "point": point, "normal": (-turned[1]).tolist()})}
        x, y = (-moved * turned[1]).tolist()
        tools = {"press": {"zones": "punch", "point": (0, 0), "displacement": {"x": x, "y": y}}} if moved else {}
        results.append(solve(block(corners, zones, {"0": {"displacement": {"x": 0, "y": 0}}}, tools=tools)))
    drawn, displaced = results
    assert drawn.solution.pressure == pytest.approx(displaced.solution.pressure, rel=1e-8)
    assert drawn.certified is displaced.certified is not both
    ended = [[note.split(" at ")[0] for note in item.notes if "taken to end" in note] for item in results]
    assert ended[0] == ended[1]
    if both:  # between two edges of one zone the surface goes on
        assert drawn.penetration.depth == pytest.approx(displaced.penetration.depth, rel=1e-6)


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(st.floats(4, 9), st.integers(2, 9), st.floats(5, 40), TURNS)
@example(6.0, 2, 40.0, 0.0)
def test_the_corner_of_a_table_between_two_nodes_is_found(end, elements, pressure, turn):
    """The sole hangs over the table: what of it is above the table must not be below it, at any place of an element.

    Its depth is computed anew. Tolerated is what `body.md` says: of the gap that nodes above the table have an eighth.
    """
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([(c, s), (-s, c)])
    corners = (np.array([(0, 0), (SIDE, 0), (SIDE, SIDE), (0, SIDE)]) @ turned).tolist()
    line = (np.array([(-50, 0), (end, 0), (end, -50)]) @ turned).tolist()
    zones = {"table": ("0", {"kind": "polyline", "points": line})}
    zones["wall"] = ("3", {"kind": "plane", "point": (0, 0), "normal": turned[0].tolist()})
    result = solve(block(corners, zones, {"2": {"pressure": pressure}, "1": {"pressure": 30.0}}, elements=elements))
    assert result.boundary is not None
    sole, xi = result.boundary.edge == 0, np.linspace(-1, 1, 33)
    shapes = np.column_stack([xi * (xi - 1) / 2, 1 - xi**2, xi * (xi + 1) / 2])
    moved = (result.boundary.points + result.boundary.displacement)[sole] @ turned.T
    x, y = np.moveaxis(shapes @ moved, 2, 0)
    depth = np.where(x < end, np.minimum(-y, end - x), 0.0).max()  # the nearer one of both faces
    largest = np.hypot(*np.moveaxis(result.boundary.displacement, 2, 0)).max()
    dip = np.where(moved[..., 0] < end, moved[..., 1], 0.0).max() / 8
    second = np.ptp(result.boundary.displacement.reshape(-1, 2), axis=0) @ np.ones(2)
    if depth > 0.01 * largest + max(dip, 0.0) + second**2 / SIDE:
        assert not result.certified


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(
    st.floats(0.8, 2.0), st.floats(3, 6), st.floats(1.5, 3), st.sampled_from([0.0, 3.5e-4, 1e-3]), st.floats(0.05, 0.2)
)
@example(0.9745682, 4.219531, 2.864938, 3.5e-4, 0.1865)
def test_zones_on_one_surface_are_as_one_zone(angle, width, height, off, share):
    """The contact points of one zone and of one zone for each edge are the same, and so are the verdicts."""
    corners = [(0, 0), (width, 0), (width + height / np.tan(angle), height), (12, height), (12, 9), (0, 9)]
    surface = {"kind": "polyline", "points": (np.array(corners[:4]) + off).tolist()}
    left = 0.8 * (1 - height / 9) + share  # more than balances the right side, so that the riser is pressed
    loads = {edge: {"pressure": 0.1765 * p} for edge, p in (("4", 1.0), ("3", 0.8), ("5", left))}
    one = solve(block(corners, {"all": (("0", "1", "2"), surface)}, loads, elements=2))
    three = solve(block(corners, {f"zone {i}": (str(i), surface) for i in range(3)}, loads, elements=2))
    assert np.sort(one.solution.pressure) == pytest.approx(np.sort(three.solution.pressure), rel=1e-9)
    assert one.certified is three.certified


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=8, max_size=8), st.floats(-12, -6))
@example([0.3, -0.5, 0.6, 0.8, -0.2, -0.7, 0.1, 0.4], -8)
@example([0.3, -0.5, -0.6, -0.8, -0.2, -0.7, 0.1, 0.4], -8)
def test_nodes_have_the_faces_of_contact_points(shift, power):
    """A surface beside the corner of the body by round-off has the verdict of one at the corner, and the same gaps."""
    corners = [(0, 0), (5, 0), (5, 2), (12, 2), (12, 9), (0, 9)]
    line = np.array(corners[:4]) + 12 * 10**power * np.reshape(shift, (4, 2))
    zone = {"step": (("0", "1", "2"), {"kind": "polyline", "points": line.tolist()})}
    result = solve(block(corners, zone, {"4": {"pressure": 1.0}, "3": {"pressure": 1.0}, "5": {"pressure": 0.9}}))
    assert result.certified
    assert result.problem is not None
    assert result.boundary is not None
    gaps = surface_gaps(body_of(result.problem), result.boundary, result.contact, result.solution)
    seen = gaps.linear("step", np.flatnonzero(gaps.paired["step"]))
    delta = result.contact.initial_gap + result.solution.displacement
    for normals, gap in zip(seen.normals[:, NODES].reshape(-1, 2), seen.gap[:, NODES].ravel(), strict=True):
        alike = (np.hypot(*(result.contact.normals - normals).T) < 1e-9) & (abs(delta - gap) < 1e-9)
        assert alike.any()


def test_a_spot_where_no_node_touches_is_seen_however_far_the_nodes_are():
    """A strip of three long elements bends on a small circle between two nodes: what dips is no contact's own error.

    Beam theory: the tip of a strip held at one end sinks by q L⁴/8EI, more than the gap of the circle.
    """
    E, L, h, q = 210e3, 100.0, 4.0, 0.5
    drop = q * L**4 / (8 * E * h**3 / 12)
    corners = {"under": [0, 0], "end": [L, 0], "top": [L, h], "wall": [0, h]}
    problem = Problem(
        name="strip", accuracy=None, material={"young_modulus": E, "poisson_ratio": 0.0},
        boundary={"outer": [{"name": name, "start": at, "elements": 3} for name, at in corners.items()]},
        conditions={"wall": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": q}},
        contact_zones={"stop": {"edges": "under", "surface": {
            "kind": "circle", "center": [0.92 * L, -5.0 - drop / 4], "radius": 5.0, "body": "outside"}}},
    )  # pyright: ignore  # fmt: skip
    result = solve(problem)
    assert not result.solution.pressure.any()
    assert not result.certified
    assert result.penetration is not None
    assert result.penetration.zone == "stop"


@pytest.mark.slow
@settings(max_examples=8, deadline=None)
@given(st.floats(0.2, 0.8), st.floats(0.2, 3.0), st.floats(0, 6.28), st.sampled_from([1e-3, 1.0, 1e3]))
@example(0.5, 0.97, 0.0, 1.0)
@example(0.5, 1.03, 0.0, 1.0)
@example(0.5, 150.0, 0.0, 1.0)
def test_a_slot_that_closes_is_found(low, share, turn, size):
    """The mouth of a fork closes by what its prongs, which are thick beams, bend; the load is a share of that.

    The body is linear: at the share one the gap at the mouth is zero. Where a prong goes through the other one and the
    floor, the floor is not named: strains are not small.
    """
    c, s = np.cos(turn), np.sin(turn)
    rotate = size * np.array([[c, s], [-s, c]])
    drawn = 0.05
    corners = np.array([(0, 0), (10, 0), (10, 4), (3, 4), (3, 4 + drawn), (10, 4 + drawn), (10, 8), (0, 8)])
    prong = 3 + 7 * low

    def fork(pressure):
        corners_of = np.insert(corners, 7, [(prong, 8)], axis=0) @ rotate
        zones = {"floor": ("0", {"kind": "plane", "point": (0, 0), "normal": rotate[1].tolist()})}
        return solve(block(corners_of.tolist(), zones, {"6": {"pressure": pressure}}, elements=4))

    def mouth(result):
        points = result.boundary.points + result.boundary.displacement
        upper, lower = (points[result.boundary.edge == edge] for edge in (4, 2))
        return float((upper[-1, 2] - lower[0, 0]) @ rotate[1]) / size**2

    closing = drawn - mouth(fork(1e-3))
    result = fork(share * 1e-3 * drawn / closing)
    assert mouth(result) == pytest.approx(drawn * (1 - share), abs=1e-6 * drawn)
    kind = None if result.penetration is None else result.penetration.kind
    expected = Misfit.ITSELF if share < 10 else Misfit.NOT_SMALL
    assert (kind is expected) is (share > 1)
    assert share < 1 or not result.certified


@pytest.mark.parametrize("share", [0.85, 1.25])
@pytest.mark.parametrize("thin", [1e-2, 1e-4])
def test_a_thin_hole_that_turns_inside_out_is_found(share, thin):
    """An elliptical hole stays an ellipse, and its sides meet everywhere at once, at p = E' b / 2a (Inglis 1913)."""
    E, a, half = 210e3, 1.0, 10.0
    corners = {"bottom": (-half, -half), "right": (half, -half), "top": (half, half), "left": (-half, half)}
    hole = {"name": "hole", "kind": "ellipse", "center": (0, 0), "semi_axes": (a, thin * a), "angles": (0, -360)}
    problem = Problem(
        name="plate", accuracy=0.05, material={"young_modulus": E, "poisson_ratio": 0.3},
        boundary={"outer": [{"name": name, "start": at} for name, at in corners.items()], "holes": [[hole]]},
        conditions={"top": {"pressure": share * E / (1 - 0.3**2) * thin / 2}},
        contact_zones={"floor": {"edges": "bottom", "surface": {
            "kind": "plane", "point": (0, -half), "normal": (0, 1)}}},
    )  # pyright: ignore  # fmt: skip
    result = solve(problem)
    kind = None if result.penetration is None else result.penetration.kind
    assert kind is (Misfit.ITSELF if share > 1 else None)
    assert result.certified is (share < 1)


@pytest.mark.parametrize(("travel", "start"), [(0.008, 0.0), (0.02, 0.0), (0.02, -20.0)])
def test_a_body_that_passes_into_another_one_without_a_contact_is_found(travel: float, start: float):
    """A block is moved by a known way along its floor, towards a post 0.01 beside it or far before it."""
    corners = {"bottom": (start, 0), "right": (start + 10, 0), "top": (start + 10, 10), "left": (start, 10)}
    post = {"bottom": (10.01, 2), "right": (20, 2), "top": (20, 8), "left": (10.01, 8)}
    problem = Problem(
        name="block and post", materials={"steel": {"young_modulus": 210e3, "poisson_ratio": 0.3}},
        bodies={
            "block": {
                "material": "steel",
                "boundary": {"outer": [{"name": name, "start": at} for name, at in corners.items()]},
                "conditions": {"left": {"displacement": {"x": travel}}, "top": {"pressure": 10}},
            },
            "post": {
                "material": "steel", "boundary": {"outer": [{"name": name, "start": at} for name, at in post.items()]},
                "conditions": {"right": {"fixed": True}},
            },
        },
        contact_zones={"floor": {"edges": "block/bottom", "surface": {
            "kind": "plane", "point": (0, 0), "normal": (0, 1)}}},
    )  # pyright: ignore  # fmt: skip
    result = solve(problem)
    if travel < 0.01 or start < 0:
        assert result.certified
        return
    assert result.penetration.kind is Misfit.EACH_OTHER
    assert not result.certified
    for word in ("'block'", "'post'", "No contact between them is stated"):
        assert word in result.penetration.words


def test_a_punch_that_turns_ends_where_its_zone_does():
    """Its face turns with it and would cut into the edges beside its zone, which lie in the face as it is drawn."""
    corners = {"bottom": (-20, -20), "right": (20, -20), "beside": (20, 0), "face": (5, 0), "other": (-5, 0),
               "left": (-20, 0)}  # fmt: skip
    stated = Problem(
        name="punch that turns",
        material={"young_modulus": 1000, "poisson_ratio": 0.3},
        boundary={"outer": [{"name": name, "start": at, "elements": 8} for name, at in corners.items()]},
        conditions={"bottom": {"displacement": {"x": 0.1, "y": 0}}},
        contact_zones={"face": {"edges": "face", "surface": {"kind": "plane", "point": (0, 0), "normal": (0, -1)}}},
        tools={"punch": {"zones": "face", "point": (0, 0), "force": {"y": -100, "moment": 200}}},
        accuracy=None,
    )  # pyright: ignore[reportArgumentType]
    result = solve(stated)
    assert result.certified
    turn = result.contact.tools.displacement(result.solution.rigid_amplitudes)[0, 2]
    assert turn > 1e-3  # at the end of the block the face would be 1 % of this deep in it
    assert [note for note in result.notes if "is taken to end at (-5, 0)" in note]  # on the side that goes down
