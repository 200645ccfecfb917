"""Several bodies from spec to result: what the joined equations must give, whatever the bodies are."""

import csv
import io
import math
from typing import Any

import numpy as np
import pytest
from messages import assert_states
from roller_bearings import ROLLERS, bearing, load_shares
from several_bodies import GUIDED, HELD, block, circle, elastic, polygon, problem, rigid, stated

import bemcontact
from bemcontact.adaptivity.mesh_sizes import first_mesh
from bemcontact.bem.discretization import body_of
from bemcontact.report.facts import facts
from bemcontact.report.result_page import render
from bemcontact.report.zones import result_table

FLAT = {"kind": "plane", "point": [0, 2], "normal": [0, -1]}
ROUND = {"kind": "circle", "center": [4, 12], "radius": 10, "body": "outside"}
PRESSED = {"top": {"pressure": 5.0}}


def solved(*args, **contacts):
    return bemcontact.solve(problem(*args, **contacts))


def stack(counts, exchanged=False, x=(0, 3)):
    """Blocks of different moduli, guided on one side, under uniform pressure."""
    bodies, contacts = {}, {}
    for i, elements in enumerate(counts):
        conditions = {**GUIDED, **({"bottom": {"displacement": {"y": 0}}} if i == 0 else {})}
        conditions |= PRESSED if i == len(counts) - 1 else {}
        bodies[f"b{i}"] = elastic(block(x, (i, i + 1), elements), conditions, modulus=1000.0 * (1 + i % 3))
        if i:
            pair = [f"b{i}/bottom", f"b{i - 1}/top"]
            contacts[f"c{i}"] = pair[::-1] if exchanged else pair
    return bodies, contacts


def filleted(slide, exchanged, *, above=500.0):
    """A block with round edges that is pressed on a longer one, and slid along it."""
    low = polygon(bottom=(-9, -3), right=(9, -3), top=(9, 0), left=(-9, 0))
    up = polygon(bottom=(-3, 0), right=(3, 0), top=(3, 3), left=(-3, 3))
    (bottom, *sides), rounded = up["outer"], ({"name": f"fillet {i}", "fillet": 0.4} for i in (1, 2))
    outer = [bottom, next(rounded), *sides, next(rounded)]
    bodies = {
        "up": elastic({"outer": outer}, {"top": {"displacement": {"x": slide, "y": -0.01}}}, above),
        "low": elastic(low, HELD),
    }
    return problem(bodies, 0.05, c=["low", "up"] if exchanged else ["up", "low"])


@pytest.mark.slow
@pytest.mark.parametrize("exchanged", [False, True])
def test_what_slides_along_a_flat_side_presses_as_before(exchanged):
    """A slide changes no gap to a flat side, also not under round edges: the same equations, but for the slide itself.

    The slide is longer than contact reaches around the round edges.
    """
    still, slid = (bemcontact.solve(filleted(slide, exchanged)) for slide in (0.0, 0.03))
    assert slid.certified
    assert len(slid.pressure) == len(still.pressure)
    assert np.abs(slid.pressure - still.pressure).max() <= 1e-9 * still.pressure.max()
    assert not any("against each other" in note for note in slid.notes)


@pytest.mark.parametrize("push", [0.0, 1e-3])
def test_nothing_holds_a_block_with_round_edges_along_a_flat_side(push):
    """Statics: no pressure on a flat side resists a push along it, however far contact reaches around the edges."""
    blocks = filleted(0.0, exchanged=False)
    loads = {"bodies.up.conditions": {"top": {"traction": {"x": push, "y": -1.0}}}}
    if push:
        with pytest.raises(bemcontact.ProblemError, match="translation"):
            bemcontact.solve(blocks.with_values(loads))
    else:
        result = bemcontact.solve(blocks.with_values(loads))
        assert result.certified
        assert any("is held at zero" in note for note in result.notes)


@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize("number", [2, 4])
def test_patch_of_blocks_with_unequal_meshes(number, exchanged):
    bodies, contacts = stack([(3 + i, 2 + i % 2, 7 - i, 1 + i % 3) for i in range(number)], exchanged)
    result = solved(bodies, **contacts)
    assert result.certified
    assert np.abs(result.solution.pressure - 5).max() < 1e-11


@pytest.mark.parametrize("exchanged", [False, True])
def test_blocks_of_equal_width_hold_whichever_is_stated_first(exchanged):
    """The softer one gets wider: its corner passes that of the other one, and nothing penetrates."""
    bodies = {
        "up": elastic(block((-1, 1), (0, 1), (8,) * 4), {"top": {"displacement": {"x": 0, "y": -0.01}}}, 2000.0),
        "low": elastic(block((-1, 1), (-1, 0), (8,) * 4), HELD),
    }
    result = solved(bodies, c=["low", "up"] if exchanged else ["up", "low"])
    assert result.certified
    assert result.penetration is None


def test_a_wide_block_on_a_narrow_one_does_not_penetrate_beyond_the_corner():
    bodies = {
        "up": elastic(block((-2, 2), (0, 1)), {"top": {"displacement": {"x": 0, "y": -0.01}}}, 3000.0),
        "low": elastic(block((-0.5, 0.5), (-1, 0)), HELD),
    }
    result = solved(bodies, 0.03, c=["up", "low"])
    assert result.certified
    assert result.penetration is None


def test_an_arc_does_not_penetrate_beyond_the_corner_of_a_rigid_body():
    arc = [
        {"name": "under", "kind": "arc", "center": [0, 20], "start": [-2, 20 - 396**0.5], "end": [2, 20 - 396**0.5]},
        {"name": "right", "end": [2, 2]},
        {"name": "top", "end": [-2, 2]},
        {"name": "left"},
    ]
    above = elastic({"outer": arc}, {"top": {"pressure": 2.0}}, 150.0)
    result = solved({"up": above, "low": rigid(block((-0.6, 0.6), (-2, 0)))}, 0.05, c=["low", "up"])
    assert result.certified
    assert result.penetration is None


ROOF = polygon(right=(2, 0), under=(-1, -0.3), left=(5, -0.3))


@pytest.mark.parametrize(
    ("outline", "surface"),
    [
        (block((-1, 6), (-1, 0)), {"kind": "plane", "point": [0, 0], "normal": [0, 1]}),
        (ROOF, {"kind": "polyline", "points": [[-1, -0.3], [2, 0], [5, -0.3]]}),
        (
            {"outer": [{"name": "rim", "kind": "arc", "center": [2, -30], "radius": 30, "angles": [0, 360]}]},
            {"kind": "circle", "center": [2, -30], "radius": 30, "body": "outside"},
        ),
    ],
)
@pytest.mark.parametrize("motion", [{"force": {"y": 6.0}}, {"displacement": {"y": 0.01}}])
def test_a_rigid_outline_is_the_surface_with_the_same_shape(outline, surface, motion):
    own = elastic(block((0, 4), (0, 3), (20, 8, 8, 8)), {"top": {"displacement": {"x": 0, "y": 0}}})
    tools = {"ram": {"zones": "z", **motion}}
    many = stated(
        name="outline", bodies={"own": own, "tool": rigid(outline)}, tools=tools, accuracy=None,
        contacts={"z": {"between": ["own/bottom", "tool"]}},
    )  # fmt: skip
    zones = {"z": {"edges": ["bottom"], "surface": surface}}
    one = stated(name="surface", **own, tools=tools, accuracy=None, contact_zones=zones)
    pressures = [bemcontact.solve(item).solution.pressure for item in (many, one)]
    assert np.abs(pressures[0] - pressures[1]).max() < 1e-10 * pressures[1].max()


def roller(start=-90.0, *, modulus=500.0, exchanged=False, turn=0.0, scale=1.0, lift=0.0):
    """A half disk that is pressed on a block, and may be drawn above it."""
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))

    def at(x, y):
        return [scale * (c * x - s * y), scale * (s * x + c * y)]

    y = 4 + lift
    disk = [
        {"name": "under", "kind": "arc", "start": at(-4, y), "end": at(4, y), "center": at(0, y), "elements": 40},
        {"name": "side", "end": at(4, y + 1), "elements": 3},
        {"name": "top", "end": at(-4, y + 1), "elements": 6},
        {"name": "other side", "elements": 3},
    ]
    corners = [(-6, -6), (6, -6), (6, 0), (-6, 0)]
    names = ("bottom", "right", "top", "left")
    base = [
        {"name": name, "start": at(*a), "end": at(*b), "elements": 6}
        for name, a, b in zip(names, corners, [*corners[1:], corners[0]], strict=True)
    ]
    bodies = {
        "disk": elastic({"outer": disk}, {"top": {"pressure": 2.0}}),
        "base": elastic({"outer": base}, HELD, modulus),
    }
    return problem(bodies, c=["base/top", "disk/under"] if exchanged else ["disk/under", "base/top"])


@pytest.mark.parametrize(("turn", "scale"), [(30.0, 1.0), (90.0, 1e3), (217.0, 1e-3)])
def test_turned_bodies_of_other_size_have_the_same_pressures(turn, scale):
    one, other = (bemcontact.solve(item).solution.pressure for item in (roller(), roller(turn=turn, scale=scale)))
    assert np.abs(one - other).max() < 1e-9 * one.max()


@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize("lift", [-1.0, 0.5, 2.0])
def test_how_far_from_each_other_bodies_are_drawn_does_not_matter(lift, exchanged):
    """The load brings them together, and pairs are those of bodies that touch."""
    one, other = (bemcontact.solve(roller(exchanged=exchanged, lift=by)).solution.pressure for by in (0.0, lift))
    assert np.abs(one - other).max() < 1e-9 * one.max()


def test_a_million_times_stiffer_body_is_rigid():
    """The pressure differs by the ratio of the moduli, 1e-6, of itself."""
    stiff = roller(modulus=1e9)
    disk = stiff.bodies["disk"]
    plane = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    alone = stated(
        name="alone", material=disk.material, boundary=disk.boundary, conditions=disk.conditions, accuracy=None,
        contact_zones={"c": {"edges": ["under"], "surface": plane}},
    )  # fmt: skip
    one, other = (bemcontact.solve(item).solution.pressure for item in (stiff, alone))
    assert np.abs(one[one > 0] - other[other > 0]).max() < 1e-6 * other.max()  # pairs end where a side is steep


@pytest.mark.parametrize("pressure", [2.0, 12.0])
def test_twins_are_the_same_as_one_of_them_on_the_plane_of_symmetry(pressure):
    """Their normals are mirror images, so that the common one is that of the plane, however large the contact is."""

    def quarter(sign, order):
        under = {"name": "under", "kind": "arc", "center": [0, 8 * sign], "radius": 8, "elements": 60}
        ways = {
            "under": under | {"angles": [-90, 0] if sign > 0 else [0, 90]},
            "diameter": {"name": "diameter", "end": [0, 8 * sign], "elements": 8},
            "axis": {"name": "axis", "elements": 8},
        }
        if sign < 0:
            ways["axis"]["end"] = ways["diameter"].pop("end")
        loads = {"axis": {"displacement": {"x": 0}}, "diameter": {"pressure": pressure}}
        return elastic({"outer": [ways[name] for name in order]}, loads)

    upper = quarter(1, ("under", "diameter", "axis"))
    twins = problem({"up": upper, "low": quarter(-1, ("under", "axis", "diameter"))}, c=["up/under", "low/under"])
    plane = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    alone = stated(name="alone", **upper, accuracy=None, contact_zones={"c": {"edges": ["under"], "surface": plane}})
    one, other = (bemcontact.solve(item).solution.pressure for item in (twins, alone))
    assert (one > 0).sum() > 4
    assert np.abs(one[one > 0] - other[other > 0]).max() < 1e-10 * other.max()


def cantilever(sign: int) -> dict[str, Any]:
    """A clamped beam under pressure, with a round nose at its tip that reaches y = 0 from above (sign 1) or below."""
    both, nose = ({"ratio": ratio, "towards": towards} for ratio, towards in ((8, "both"), (60, "middle")))
    edges = [
        {"name": "under", "start": (0, 1), "end": (93, 1), "elements": 16, "grading": both},
        {"name": "nose", "start": (93, 1), "end": (107, 1), "elements": 60, "grading": nose},
        {"name": "tip", "start": (107, 1), "end": (107, 11), "elements": 4},
        {"name": "top", "start": (107, 11), "end": (0, 11), "elements": 18},
        {"name": "clamp", "start": (0, 11), "end": (0, 1), "elements": 8},
    ]
    edges[1] |= {"kind": "arc", "center": [100, 25 * sign]}
    if sign < 0:
        edges = [edge | {"start": edge["end"], "end": edge["start"]} for edge in edges[::-1]]
    outer = [edge | {key: [edge[key][0], sign * edge[key][1]] for key in ("start", "end")} for edge in edges]
    return elastic({"outer": outer}, {"clamp": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": 5e-4}})


def test_two_mirrored_cantilevers_are_one_of_them_on_the_plane_between_them():
    """Both bend by the same and turn to opposite sides. The force is 3/8 q l and more, for a load beyond the prop."""
    twins = problem({"up": cantilever(1), "low": cantilever(-1)}, c=["up/nose", "low/nose"])
    surface = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    zones = {"c": {"edges": "nose", "surface": surface}}
    alone = stated(name="alone", **cantilever(1), accuracy=None, contact_zones=zones)
    one, other = map(bemcontact.solve, (twins, alone))
    assert one.certified
    assert other.certified
    assert (other.solution.pressure > 0).sum() > 4
    peak = other.solution.pressure.max()
    assert np.abs(one.solution.pressure - other.solution.pressure).max() < 1e-9 * peak
    assert one.footprint.forces["c"] == pytest.approx(other.footprint.forces["c"], rel=1e-9, abs=1e-12)
    beyond = 7 + 3 / (4 * 100) * 7**2  # force there, and 3 M / 2 l by its moment M
    assert other.footprint.forces["c"][1] == pytest.approx(5e-4 * (3 / 8 * 100 + beyond), rel=0.02)


def test_force_and_moment_of_a_contact_are_those_of_the_loads():
    """The half disk is free but for contact: 16 along the normal, and no moment about its axis of symmetry."""
    result = bemcontact.solve(roller())
    contact, pressure = result.contact, result.solution.pressure
    force = contact.weights * pressure
    total = force @ contact.normals
    moment = np.sum(
        force * (contact.points[:, 0] * contact.normals[:, 1] - contact.points[:, 1] * contact.normals[:, 0])
    )
    assert np.allclose(total, [0, 16], atol=1e-11)
    assert moment == pytest.approx(0, abs=1e-11)


@pytest.mark.parametrize("formulation", ["qp1", "qp2", "qp3", "complementarity"])
def test_all_formulations_give_the_same(formulation):
    spec = roller()
    reference = bemcontact.solve(spec).solution.pressure
    own = bemcontact.solve(spec, formulation=formulation).solution.pressure
    assert np.abs(own - reference).max() < 1e-7 * reference.max()


def test_a_copy_is_what_is_stated_by_hand():
    half = [
        {"name": "under", "kind": "arc", "start": [-4, 4], "end": [4, 4], "center": [0, 4], "elements": 24},
        {"name": "side", "end": [4, 5], "elements": 2},
        {"name": "top", "end": [-4, 5], "elements": 6},
        {"name": "other side", "elements": 2},
    ]
    by_hand = [
        {**edge, **{key: [-edge[key][0], -edge[key][1]] for key in ("start", "end", "center") if key in edge}}
        for edge in half
    ]
    held = {"top": {"displacement": {"x": 0, "y": 0}}}
    up = elastic({"outer": half}, {"top": {"pressure": 2.0}})
    copy = {"copy_of": "up", "rotate": 180, "about": [0, 1], "shift": [0, -2], "conditions": held}
    pressures = [
        solved({"up": up, "low": low}, c=["up/under", "low/under"]).solution.pressure
        for low in (copy, elastic({"outer": by_hand}, held))
    ]
    assert np.abs(pressures[0] - pressures[1]).max() < 1e-11 * pressures[0].max()


@pytest.mark.parametrize("starts", [(37, 124), (190, 211), (0, 0)])
@pytest.mark.parametrize("pair", [["disk/rim", "ring/bore"], ["ring/bore", "disk/rim"]])
def test_press_fit_of_whole_circles(pair, starts):
    """Lamé: p = interference / (c1 + c2), uniform, wherever the circles begin; the mesh gives 1e-4 (fourth order)."""
    bodies = {
        "disk": elastic({"outer": [circle("rim", 5, start=starts[0], elements=24)]}),
        "ring": elastic(
            {
                "outer": [circle("outside", 8, elements=24)],
                "holes": [[circle("bore", 5, start=starts[1], elements=24, hole=True)]],
            },
            modulus=2000.0,
        ),
    }
    pressure = solved(bodies, fit={"between": pair, "gap": -0.01}).solution.pressure
    disk = 5 * 1.3 * 0.4 / 1000
    ring = 5 * 1.3 / 2000 * (0.4 * 25 + 64) / (64 - 25)
    assert np.abs(pressure * (disk + ring) / 0.01 - 1).max() < 1e-4


@pytest.mark.parametrize("scale", [1.0, 1e3])
def test_an_interference_moves_no_body_away(scale):
    """The forces around a disk cancel before and after the motion, in all units of length."""
    plate = {**block((-12 * scale, 12 * scale), (-12 * scale, 12 * scale), (8,) * 4)}
    plate["holes"] = [[circle("bore", 5 * scale, start=38, elements=16, hole=True)]]
    bodies = {
        "disk": elastic({"outer": [circle("rim", 5 * scale, elements=16)]}),
        "plate": elastic(plate, HELD, 2000.0),
    }
    result = solved(bodies, fit={"between": ["disk", "plate/bore"], "gap": -0.01 * scale})
    assert result.certified
    assert result.penetration is None


@pytest.mark.slow
def test_faces_of_a_slot_press_on_each_other_as_on_the_plane_between_them():
    """Two arms, symmetric about y = 1: each has half of the body with a rigid plane as its other half."""
    arms = polygon(
        bottom=(0, 0), tip=(6, 0), **{"low face": (6, 0.8)}, root=(2, 0.8), **{"high face": (2, 1.2)},
        **{"other tip": (6, 1.2)}, top=(6, 2), left=(0, 2),
    )  # fmt: skip
    half = polygon(axis=(0, 1), root=(2, 1), **{"high face": (2, 1.2)}, tip=(6, 1.2), top=(6, 2), left=(0, 2))
    counts = {"low face": 32, "high face": 32, "root": 4, "axis": 8, "left": 8}
    for boundary in (arms, half):
        for edge in boundary["outer"]:
            edge["elements"] = 6 if "tip" in edge["name"] else counts.get(edge["name"], 24)
    next(edge for edge in half["outer"] if edge["name"] == "root")["elements"] = 2
    held = {"left": {"displacement": {"x": 0, "y": 0}}}
    body = elastic(arms, {**held, "top": {"pressure": 1.0}, "bottom": {"pressure": 1.0}})
    closed = solved({"clip": body}, c=["clip/high face", "clip/low face"])
    plane = {"kind": "plane", "point": [0, 1], "normal": [0, 1]}
    alone = bemcontact.solve(
        stated(
            name="half", **elastic(half, {**held, "axis": {"displacement": {"y": 0}}, "top": {"pressure": 1.0}}),
            accuracy=None, contact_zones={"c": {"edges": ["high face"], "surface": plane}},
        )
    )  # fmt: skip
    forces = [float(np.sum(item.contact.weights * item.solution.pressure)) for item in (closed, alone)]
    assert closed.penetration is None
    assert forces[0] == pytest.approx(forces[1], rel=5e-3)


def test_a_path_of_the_gap_between_two_bodies_ends_as_a_solve_does():
    """Pressure is linear in an interference of blocks that stay in contact, and no state on the way penetrates."""
    low = elastic(block((-1, 3), (-1, 0), (8, 4, 8, 4)), HELD)
    up = elastic(block((0, 2), (0, 1), (8, 4, 8, 4)), {"top": {"displacement": {"x": 0, "y": -0.01}}})
    spec = problem({"up": up, "low": low}, face={"between": ["up/bottom", "low/top"], "gap": 0.0})
    path = bemcontact.follow(spec, "contacts.face.gap", -0.001, start=0.0)
    assert path.certified
    end = bemcontact.solve(spec.with_value("contacts.face.gap", -0.001))
    assert np.abs(path.path.at(1.0).pressure - end.solution.pressure).max() < 1e-10 * end.solution.pressure.max()


@pytest.mark.slow
@pytest.mark.parametrize("exchanged", [False, True])
@pytest.mark.parametrize(("modulus", "springs"), [(1e3, False), (1e7, False), (1e3, True)])
def test_nothing_spins_a_disk_without_friction(modulus, springs, exchanged):
    """Between blocks that do not have their middles at its center, and with springs across its bore.

    Common normals miss the center by the share of the other body in the part of the radius that a place is aside. On
    the places of a block the center is where the disk has slid to beside it.
    """
    disk = {"name": "rim", "kind": "arc", "center": [0, 2], "radius": 2, "angles": [90, 450]}
    bore = {"name": "bore", "kind": "arc", "center": [0, 2], "radius": 0.6, "angles": [360, 0]}
    outline = {"outer": [disk], "holes": [[bore]]} if springs else {"outer": [disk]}
    bodies = {
        "disk": elastic(outline, {"bore": {"spring": {"normal": 300.0}}} if springs else {}, modulus=modulus),
        "base": elastic(block((-2, 4), (-3, 0)), HELD, 1500.0),
        "lid": elastic(block((-1, 5), (4, 6)), {"top": {"displacement": {"x": 0, "y": -0.02}}}, 1500.0),
    }
    sides = {"low": ["disk/rim", "base/top"], "high": ["disk/rim", "lid/bottom"]}
    result = solved(bodies, 0.02, **{name: pair[::-1] if exchanged else pair for name, pair in sides.items()})
    assert result.certified
    assert any("rotation counterclockwise about (0, 2)" in note and "held at zero" in note for note in result.notes)
    share = 1500.0 / (1500.0 + modulus)
    for contact in result.footprint.intervals:
        x, y = result.footprint.forces[contact.zone]
        farthest = share * contact.length / 2 * np.hypot(x, y)
        slide = result.problem.zones[contact.zone].surface.approach.x if exchanged else 0.0
        assert abs(result.footprint.moments[contact.zone] + 2 * x - slide * y) < 0.01 * farthest


@pytest.mark.slow
def test_a_body_may_press_on_a_corner_that_is_held():
    """Either side first. Both have the same force and length; the corner of the clamped side takes part."""
    upper = elastic(block((0, 40), (0, 20)), {"top": {"pressure": 30.0}, "right": {"fixed": True}}, 30e3)
    lower = elastic(block((-10, 60), (-20, -2e-4)), {"bottom": {"displacement": {"x": 0, "y": 0.02}}}, 30e3)
    forces, bars = [], []
    for pair in (["up/bottom", "low/top"], ["low/top", "up/bottom"]):
        result = solved({"up": upper, "low": lower}, 0.01, c=pair)
        assert result.certified
        assert result.intervals[0].length == pytest.approx(40, rel=1e-9)
        forces.append(abs(result.footprint.forces["c"][1]))
        bars += [bar.bar for bar in result.accuracy.bars if bar.quantity == "force"]
    assert forces[0] == pytest.approx(forces[1], rel=sum(bars))


@pytest.mark.slow
def test_a_roller_on_a_block_that_hardly_deforms_is_that_on_a_plane():
    """It may spin on both. Normals are those of the block but for the twentieth that holds the roller on it."""
    rim = {"name": "rim", "kind": "arc", "center": [0, 2], "radius": 2, "angles": [90, 450]}
    roller, hard = elastic({"outer": [rim]}, modulus=100.0), elastic(block((-6, 6), (-6, 0)), HELD, 1e8)
    lid = {"lid": {"edges": "roller/rim", "surface": {"kind": "plane", "point": [0, 4], "normal": [0, -1]}}}
    foot = {"foot": {"edges": "roller/rim", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}}
    common = {"name": "roller", "accuracy": 0.003, "tools": {"lid": {"zones": "lid", "force": {"y": -1.0}}}}
    on_plane = bemcontact.solve(stated(bodies={"roller": roller}, contact_zones=lid | foot, **common))
    on_block = bemcontact.solve(
        stated(
            bodies={"roller": roller, "block": hard}, contact_zones=lid,
            contacts={"foot": {"between": ["roller", "block"]}}, **common,
        )
    )  # fmt: skip
    assert on_plane.certified
    assert on_block.certified
    assert on_block.peak.pressure == pytest.approx(on_plane.peak.pressure, rel=0.003)


@pytest.mark.slow
@pytest.mark.parametrize("moduli", [(1e3, 1e3, 1e3), (15400.0, 10400.0, 2200.0), (1200.0, 10300.0, 5500.0)])
def test_a_roller_rests_on_two_others(moduli):
    """No spin is left that something would have to hold. Statics: the upper weight W presses by W/(2 sin 60°) on each.

    The motion of the bodies turns the lines between their centers by about the largest strain. Statics leaves it out.
    """
    centers = {"left": (-1, 1), "right": (1, 1), "upper": (0, 1 + 3**0.5)}
    weight = {"gravity": {"density": 1.0, "acceleration": [0, -1]}}
    bodies = {
        name: elastic({"outer": [{**circle("rim", 1.0), "center": list(center)}]}, {}, modulus, loads=weight)
        for (name, center), modulus in zip(centers.items(), moduli, strict=True)
    }
    walls = {"left": ([-2, 0], [1, 0]), "right": ([2, 0], [-1, 0])}
    zones = {
        name: {"edges": f"{name}/rim", "surface": {"kind": "plane", "point": point, "normal": normal}}
        for name, (point, normal) in walls.items()
    }
    floor = {"edges": ["left/rim", "right/rim"], "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}
    pairs = {"between": ["left", "right"]}, {"between": ["left", "upper"]}, {"between": ["right", "upper"]}
    contacts = dict(zip(("middle", "on left", "on right"), pairs, strict=True))
    result = bemcontact.solve(
        stated(name="trough", bodies=bodies, contacts=contacts, contact_zones={**zones, "floor": floor}, accuracy=0.01)
    )
    assert result.certified
    forces = result.footprint.forces
    strain = 2 * math.pi / min(moduli)
    assert forces["floor"] == pytest.approx((0, 3 * math.pi), abs=1e-9)
    for name in ("on left", "on right"):
        assert np.abs(forces[name]) == pytest.approx([math.pi / 2 / 3**0.5, math.pi / 2], rel=0.003 + 5 * strain)


@pytest.mark.parametrize("way", [0.03, 0.2])
def test_a_body_that_moves_into_another_one_is_found_also_when_it_is_inside(way):
    """A small disk without a stated contact: first it crosses the boundary of the block, then it is behind it."""
    rim = [
        {"name": "low", "kind": "arc", "center": [0, 1.03], "radius": 0.02, "angles": [180, 360]},
        {"name": "high", "kind": "arc", "center": [0, 1.03], "radius": 0.02, "angles": [0, 180]},
    ]
    bodies = {
        "disk": elastic({"outer": rim}, {"high": {"displacement": {"x": 0, "y": -way}}}),
        "block": elastic(block((-1, 1), (0, 1)), HELD),
        "beside": elastic(block((1, 2), (0, 1)), {"right": {"displacement": {"x": -0.001, "y": 0}}}),
    }
    result = bemcontact.solve(problem(bodies, 0.05, c=["beside/left", "block/right"]))
    assert not result.holds
    assert result.penetration is not None
    assert "'disk'" in result.penetration.words
    assert "'block'" in result.penetration.words


def test_many_motions_that_are_held_at_zero_have_one_note():
    """Disks on a block, each of which may spin."""
    disks = {
        f"disk {i}": elastic(
            {"outer": [{"name": "rim", "kind": "arc", "center": [3 * i, 1], "radius": 1, "angles": [0, 360]}]}
        )
        for i in range(4)
    }
    bodies = {
        **disks,
        "base": elastic(block((-2, 11), (-3, 0)), HELD),
        "lid": elastic(block((-2, 11), (2, 4)), {"top": {"displacement": {"x": 0, "y": -0.01}}}),
    }
    contacts = {
        f"{name} {side}": [f"{name}/rim", edge]
        for name in disks
        for side, edge in (("low", "base/top"), ("high", "lid/bottom"))
    }
    (note,) = [note for note in body_of(first_mesh(problem(bodies, 0.05, **contacts))).notes if "at zero" in note]
    assert note.startswith("these move no contact point and have no load, and are held at zero: the rotation")
    assert all(f"'disk {i}'" in note for i in range(4))


@pytest.mark.slow
def test_three_bodies_that_meet_in_one_point():
    """Two blocks side by side on a base: forces are those of the loads, and corners are looked at in pairs."""
    side = {"pressure": 0.3}
    bodies = {
        "a": elastic(block((0, 2), (0, 1)), {"top": {"pressure": 1.0}, "left": side}),
        "b": elastic(block((2, 4), (0, 1)), {"top": {"pressure": 2.0}, "right": side}, 500.0),
        "base": elastic(block((-1, 5), (-2, 0)), HELD),
    }
    result = solved(bodies, 0.05, between=["a", "b"], one=["a", "base"], two=["b", "base"])
    forces = result.contact.resultants(result.solution.pressure)
    assert np.allclose(np.hypot(*forces.T), [0.3, 2.0, 4.0], rtol=1e-9)


@pytest.mark.slow
def test_bodies_that_bulge_into_each_other_below_a_third_are_named():
    """Only they have no contact with each other; the third one has with both."""
    bodies = {
        "a": elastic(block((0, 2), (0, 1)), HELD),
        "b": elastic(block((2, 4), (0, 1)), HELD, 500.0),
        "c": elastic(block((1, 3), (1, 2)), {"top": {"pressure": 1.0}}),
    }
    penetration = solved(bodies, 0.05, one=["c", "a"], two=["c", "b"]).penetration
    assert penetration is not None
    assert "between: [a, b]" in penetration.words or "between: [b, a]" in penetration.words


@pytest.mark.slow
@pytest.mark.parametrize("down", [0.55, 0.6])
def test_an_edge_of_which_a_part_may_touch_is_not_said_to_be_in_no_zone(down):
    """A soft quarter disk comes to lie flat where its gap as drawn is more than 3 % of its size."""
    disk = [{"name": "under", "kind": "arc", "center": [0, 4], "radius": 4, "angles": [-90, 0]},
            {"name": "top", "end": [0, 4]}, {"name": "axis"}]  # fmt: skip
    conditions = {"axis": {"displacement": {"x": 0}}, "top": {"displacement": {"y": -down}}}
    bodies = {"disk": elastic({"outer": disk}, conditions), "base": rigid(block((-1, 9), (-2, 0)))}
    result = solved(bodies, 0.1, c=["disk", "base"])
    assert result.penetration is not None
    notes = [result.penetration.words, *result.notes]
    said = "'disk' penetrates 'base' by …on 'disk/under', beyond the part of this edge that may touch in 'c'"
    remedy = "educe the load, or name edges in between, such as disk/under…0.17 larger…3 % of the size"
    assert_states(next(note for note in notes if "'disk/under'" in note), f"{said}…{remedy}")
    assert_states(next(note for note in notes if "contact reaches" in note), f"goes on smoothly; r{remedy}")
    assert not any("not in" in note or "make the zone longer" in note for note in notes)
    named = solved(bodies, 0.1, c=["disk/under", "base"])
    assert named.certified  # strains are noted, and nothing is inside
    ground = {"edges": "under", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}
    material = {"young_modulus": 1000.0, "poisson_ratio": 0.3}
    one = {"material": material, "boundary": {"outer": disk}, "conditions": conditions, "contact_zones": {"c": ground}}
    plane = bemcontact.solve(stated(name="on a plane", accuracy=0.1, **one))
    (mine, its) = (item.accuracy.bar_of("peak", "c") for item in (named, plane))
    assert mine.value == pytest.approx(its.value, rel=mine.bar + its.bar)


@pytest.mark.slow
def test_a_plane_without_ends_that_another_body_penetrates_may_be_a_rigid_body():
    """The upper block hangs over the lower one and bends down beside it, into the floor of the lower one alone."""
    bodies = {
        "low": elastic(block((0, 4), (0, 0.3))),
        "up": elastic(block((0, 12), (0.3, 1)), {"right": {"displacement": {"x": 0, "y": -0.4}}}),
    }
    plane = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    spec = stated(
        name="a floor", bodies=bodies, accuracy=0.1, contacts={"face": {"between": ["up/bottom", "low/top"]}},
        contact_zones={"floor": {"edges": "low/bottom", "surface": plane}},
    )  # fmt: skip
    result = bemcontact.solve(spec)
    told = [*result.notes, *([] if result.penetration is None else [result.penetration.words])]
    assert_states(
        next(note for note in told if "'up' penetrates" in note),
        "The body 'up' penetrates the surface of 'floor'…no edge in that zone…a body with rigid: true",
    )


def test_a_point_outside_of_a_body_is_told_of_which_one():
    result = bemcontact.solve(roller())
    for body, states in (
        ("disk", "(9, 9) is outside the undeformed body 'disk'…inside the body 'disk' or on its boundary"),
        (None, "(9, 9) is in none of the undeformed bodies"),
    ):
        with pytest.raises(bemcontact.ProblemError) as caught:
            result.stress([[9.0, 9.0]], body=body)
        assert_states(str(caught.value), states)
    assert result.stress([[0.0, 0.0]]).components == pytest.approx(result.stress([[0.0, 0.0]], body="disk").components)
    assert next(iter(result.problem.bodies)) == "disk", "the first one that is stated"


@pytest.mark.parametrize("bonded", [False, True])
def test_a_stress_operator_gives_the_stress_of_each_body(bonded):
    """Of a half disk on a block, whose lower part is another body. The operator is another sum of the same numbers."""
    bodies = dict(roller().bodies)
    if bonded:
        bodies["base"] = elastic(block((-6, 6), (-3, 0), (6, 2, 12, 2)), modulus=500.0)
        bodies["floor"] = elastic(block((-6, 6), (-6, -3), (6, 2, 6, 2)), HELD, 2000.0)
    spec = stated(
        name="operator", bodies=bodies, accuracy=None, contacts={"c": {"between": ["disk/under", "base/top"]}},
        bonded={"glue": ["base/bottom", "floor/top"]} if bonded else {},
    )  # fmt: skip
    result, points = bemcontact.solve(spec), [[0.1, 0.3], [0.2, -0.4], [1.0, -5.0], [-2.0, 3.5]]
    operator = bemcontact.stress_operator(result, points)
    solution, stress = result.solution, result.stress(points)
    found = operator.pressure @ solution.pressure + operator.loads[..., 0]
    wanted = np.column_stack([stress.components, stress.zz])
    assert np.abs(found - wanted).max() < 1e-9 * np.abs(wanted).max()
    below = bemcontact.stress_operator(result, [[0.0, 0.0]], body="base")
    own = result.stress([[0.0, 0.0]], body="base").components
    assert (below.pressure @ solution.pressure + below.loads[..., 0])[:, :3] == pytest.approx(own, rel=1e-9, abs=1e-9)
    with pytest.raises(bemcontact.ProblemError, match="disk"):
        bemcontact.stress_operator(result, points, body="dusk")
    model = bemcontact.model(operator.contact)
    bound = model.stress(operator)
    model.solve()
    assert bound.components.value == pytest.approx(stress.components, rel=1e-6, abs=1e-6 * abs(wanted).max())


@pytest.mark.slow
def test_forces_of_contacts_are_not_summed_over_bodies():
    """A stack under a pressure of 1 on a width of 2: each contact carries 2, on the upper body, and no total is 4."""
    bodies = {
        "top": elastic(block((0, 2), (1, 2)), {"top": {"pressure": 1.0}}),
        "middle": elastic(block((0, 2), (0, 1))),
        "low": elastic(block((0, 2), (-1, 0)), HELD),
    }
    result = solved(bodies, 0.05, one=["top", "middle"], two=["middle", "low"])
    assert result.sides == {"one": ("top", "middle"), "two": ("middle", "low")}
    told = [value for name, value in facts(result.to_dict(), result.problem.units) if name == "Resultant"]
    assert [value.partition(":")[0] for value in told] == ["of one on top", "of two on middle"]
    assert all(": (0, 2.000" in value for value in told)
    page = render(result, {}, None)
    assert "of all surfaces" not in page
    assert "on middle" in page
    assert "normals of the second body" not in page
    rows = list(csv.DictReader(io.StringIO(result_table(result, "largest_stresses.csv"))))
    assert {row["body"] for row in rows if row["value"]} <= {"top", "middle", "low"}
    inside = result.largest_stresses().inside
    assert inside is None or f" in {inside.body}" in page


@pytest.mark.slow
@pytest.mark.parametrize(("load", "gap"), [(1e-3, -1e-5), (1e-3, 0.0)])
def test_load_shares_of_a_bearing_with_rigid_rings(load, gap):
    """All rollers carry with an interference, the lower ones without; the half-width is 2e-4 of the radius.

    The closed form is as good as the square of that. The mesh has about ten elements in contact, whose ends are at
    nodes: forces follow the logarithm of the width, so a tenth of an element in it is 1e-3.
    """
    result = bemcontact.solve(bearing(load, gap))
    forces = np.hypot(*result.contact.resultants(result.solution.pressure).T)
    by_name = dict(zip(result.contact.zone_names, forces.tolist(), strict=True))
    inside, outside = (
        np.array([by_name[f"{side} {i}"] for i in range(1, ROLLERS + 1)]) for side in ("inside", "outside")
    )
    expected = load_shares(load, gap, 1000 / (1 - 0.3**2))
    assert result.certified
    assert np.abs(inside - expected).max() < 2e-3 * expected.max()
    assert np.abs(inside - outside).max() < 1e-9 * expected.max()
    assert any("'roller 1' is reused for 'roller 2', 'roller 3'" in note for note in result.notes)
    assert (inside[expected == 0] == 0).all()


@pytest.mark.parametrize("pair", [["w/top", "d/wide"], ["d/wide", "w/top"]])
def test_an_edge_that_is_not_named_penetrates_whichever_side_is_first(pair):
    """A foot of 0.05, lower than the one that is named; elements of the long edge below it are longer than that."""
    feet = polygon(
        narrow=(-3, 0), one=(-2.95, 0), middle=(-2.95, 0.5), two=(1, 0.5), wide=(1, 0.01), three=(4, 0.01), top=(4, 2),
        four=(-3, 2),
    )  # fmt: skip
    bodies = {
        "d": elastic(feet, {"top": {"displacement": {"x": 0, "y": -0.03}}}),
        "w": elastic(block((-40, 30), (-20, 0)), HELD, 2000.0),
    }
    result = bemcontact.solve(problem(bodies, 0.05, c=pair))
    assert result.penetration is not None
    assert (result.penetration.edge, result.penetration.zone) == ("d/narrow", "c")
    assert 0.5 * 0.03 < result.penetration.depth < 0.03


@pytest.mark.slow
@pytest.mark.parametrize("left", [["roller/rim", "seat/left"], ["seat/left", "roller/rim"]])
@pytest.mark.parametrize("right", [["roller/rim", "seat/right"], ["seat/right", "roller/rim"]])
def test_contacts_of_one_rim_with_two_faces_may_state_their_sides_in_any_order(left, right):
    """A roller in a V of 45 degrees: statics gives the forces on the faces, and each is compared in its own contact."""
    corners = polygon(
        bottom=(-12, -5), east=(12, -5), up=(12, 6), right=(6, 6), left=(0, 0), down=(-6, 6), west=(-12, 6)
    )
    rim = {"name": "rim", "kind": "arc", "center": [0, 4 * math.sqrt(2)], "radius": 4, "angles": [90, 450]}
    weight = {"gravity": {"density": 1, "acceleration": [0, -0.4]}}
    bodies = {
        "roller": elastic({"outer": [rim]}, modulus=5500.0, loads=weight),
        "seat": elastic(corners, {"bottom": {"displacement": {"x": 0, "y": 0}}}, 16000.0),
    }
    result = solved(bodies, 0.02, left=left, right=right)
    assert result.holds
    for name, sign in (("left", 1), ("right", -1)):
        force = np.array(result.footprint.forces[name]) * (1 if result.sides[name][0] == "roller" else -1)
        assert force == pytest.approx(0.2 * math.pi * 16 * np.array([sign, 1]), rel=2e-3)


@pytest.mark.slow
def test_a_narrow_slot_of_one_body_is_certified_as_two_bonded_ones():
    """A slot of 0.0046 of its length that closes at its mouth: half of the body on the plane of symmetry is known."""
    length, tip, radius = 8.0, 3.0, 0.0115
    upper = [
        {"name": "whole", "start": [0, 0], "end": [tip - radius, 0]},
        {"name": "round", "kind": "arc", "center": [tip, 0], "radius": radius, "angles": [180, 90]},
        {"name": "lip", "start": [tip, radius], "end": [length, radius]},
        {"name": "mouth", "end": [length, 2]},
        {"name": "pressed", "end": [6, 2]},
        {"name": "top", "end": [0, 2]},
        {"name": "left", "end": [0, 0]},
    ]
    lower = [
        {"name": "left", "start": [0, 0], "end": [0, -2]},
        {"name": "bottom", "end": [6, -2]},
        {"name": "pressed", "end": [length, -2]},
        {"name": "mouth", "end": [length, -radius]},
        {"name": "lip", "end": [tip, -radius]},
        {"name": "round", "kind": "arc", "center": [tip, 0], "radius": radius, "angles": [270, 180]},
        {"name": "whole", "end": [0, 0]},
    ]
    loads = {"left": {"displacement": {"x": 0, "y": 0}}, "pressed": {"pressure": 2.0}}
    both = {"upper": elastic({"outer": upper}, loads), "lower": elastic({"outer": lower}, loads)}
    cut = bemcontact.solve(
        stated(
            name="cut", bodies=both, bonded={"middle": ["upper/whole", "lower/whole"]},
            contacts={"lips": {"between": ["upper/lip", "lower/lip"]}}, accuracy=0.02,
        )
    )  # fmt: skip
    round_tip = {"name": "round", "kind": "arc", "center": [tip, 0], "radius": radius, "angles": [270, 90]}
    outer = [
        *({**edge, "name": f"low {edge['name']}"} for edge in lower[1:5]),
        round_tip,
        *upper[2:6],
        {"name": "left", "start": [0, 2], "end": [0, -2]},
    ]
    outer[0] = {**outer[0], "start": [0, -2]}
    whole = {"clip": elastic({"outer": outer}, {**loads, "low pressed": {"pressure": 2.0}})}
    slot = solved(whole, 0.02, lips=["clip/lip", "clip/low lip"])
    plane = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    half = bemcontact.solve(
        stated(
            name="half", **elastic({"outer": upper}, {**loads, "whole": {"displacement": {"y": 0}}}), accuracy=0.02,
            contact_zones={"lips": {"edges": ["lip"], "surface": plane}},
        )
    )  # fmt: skip
    assert cut.holds
    assert half.holds
    said = [note for note in slot.notes if "both sides of 'lips' are on the body 'clip'" in note]
    assert len(said) == (not slot.certified)
    assert not any("both sides" in note for note in cut.notes)
    assert cut.forces["lips"][1] > 1
    assert cut.forces["lips"][1] == pytest.approx(half.forces["lips"][1], rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("depth", [0.02, 0.05])
def test_folded_elements_between_feet_of_pads_are_refused_with_what_to_name(depth):
    """Twins with a round pad whose feet are opposite to each other: the pads alone are one of them on a plane."""
    gap, radius = (2 * depth if depth > 0.03 else 0.03), (1 + depth**2) / 2 / depth
    turn = math.degrees(math.asin(1 / radius))
    pad = {"name": "pad", "kind": "arc", "center": [0, gap + radius - depth], "radius": radius}
    edges = [
        {"name": "before", "start": [-4, gap], "end": [-1, gap]},
        {**pad, "angles": [-90 - turn, -90 + turn]},
        {"name": "behind", "start": [1, gap], "end": [4, gap]},
        {"name": "right", "end": [4, gap + 3]},
        {"name": "top", "end": [-4, gap + 3]},
        {"name": "left"},
    ]
    up = elastic({"outer": edges}, {"left": {"displacement": {"x": 0}}, "top": {"pressure": 0.1}})
    own = {"right": {"displacement": {"x": 0}}, "top": {"pressure": 0.1}}
    bodies = {"up": up, "low": {"copy_of": "up", "rotate": 180, "about": [0, 0], "conditions": own}}
    lines = ("before", "pad", "behind")
    with pytest.raises(bemcontact.ProblemError, match="cross each other; name the edges that come to touch"):
        solved(bodies, 0.03, c=[[f"up/{name}" for name in lines], [f"low/{name}" for name in lines]])
    pads = solved(bodies, 0.03, c={"between": ["up/pad", "low/pad"], "gap": -2 * (gap - depth)})
    plane = {"kind": "plane", "point": [0, gap - depth], "normal": [0, 1]}
    zones = {"c": {"edges": ["pad"], "surface": plane}}
    half = bemcontact.solve(stated(name="half", **up, accuracy=0.03, contact_zones=zones))
    assert pads.holds
    assert pads.peak is not None
    assert half.peak is not None
    assert pads.peak.pressure == pytest.approx(half.peak.pressure, rel=0.01)


def by_zone(result):
    """Names of contacts, places and pressures of the shares of all points, in a fixed order, whoever owns a point."""
    assert result.problem is not None
    body = body_of(result.problem)
    points = body.points
    zones = np.array([*result.problem.zones])[points.zone_of_share]
    places = body.mesh.nodes[body.mesh.elements[points.element, points.local]]
    keys = np.round(places, 9) + 0.0
    order = np.lexsort((*keys.T, np.unique(zones, return_inverse=True)[1]))
    return zones[order], keys[order], result.solution.pressure[points.point[order]]


def assert_same_pressures(one, other):
    (zones, places, pressure), (their_zones, their_places, theirs) = by_zone(one), by_zone(other)
    np.testing.assert_array_equal(zones, their_zones)
    np.testing.assert_allclose(places, their_places, atol=1e-8)
    np.testing.assert_allclose(pressure, theirs, rtol=0, atol=1e-8 * pressure.max())


SIDES = {"left": {"pressure": 2.0}, "right": {"pressure": 2.0}}


def on_two(moduli, orders, pressed, n=8):
    """A block on two others that touch each other below its middle, and the contacts with the sides in some order."""
    side = {name: SIDES[name] for name in pressed}
    bodies = {
        "up": elastic(block((-2, 2), (0, 1), (2 * n, 4, n, 4)), {"top": {"pressure": 3.0}, **(SIDES if side else {})}),
        "l": elastic(
            block((-2, 0), (-2, 0), (n, n, n, n)),
            {"bottom": {"displacement": {"y": 0}}, "left": side.get("left", {"displacement": {"x": 0}})},
            moduli[0],
        ),
        "r": elastic(
            block((0, 2), (-2, 0), (n, n, n, n)),
            {"bottom": {"displacement": {"y": 0}}, "right": side.get("right", {"displacement": {"x": 0}})},
            moduli[1],
        ),
    }
    pairs = {"cl": ["up/bottom", "l/top"], "cr": ["up/bottom", "r/top"], "m": ["l/right", "r/left"]}
    return bodies, {name: pairs[name][::order] for name, order in zip(pairs, orders, strict=True)}


ORDERS = [(1, 1, 1), (-1, -1, 1), (1, -1, -1), (-1, 1, 1)]


def on_two_solved(moduli, orders, pressed=()):
    bodies, contacts = on_two(moduli, orders, pressed)
    return solved(bodies, **contacts)


@pytest.mark.parametrize("orders", ORDERS)
def test_a_cut_where_all_presses_changes_nothing(orders):
    """The state of constant stress of an undivided block under a block, at any joint: to round-off on any mesh."""
    result = on_two_solved((1000.0, 1000.0), orders, SIDES)
    assert result.certified
    zones, _, pressure = by_zone(result)
    np.testing.assert_allclose(pressure[zones != "m"], 3.0, rtol=1e-9)
    np.testing.assert_allclose(pressure[zones == "m"], 2.0, rtol=1e-9)


@pytest.mark.parametrize("orders", ORDERS[1:])
def test_a_node_on_two_bodies_has_a_gap_to_each(orders):
    """Bodies of different stiffness below it: it may be off one and press on the other, whichever sides are first."""
    one, other = (on_two_solved((300.0, 3000.0), order) for order in (ORDERS[0], orders))
    assert one.certificate.kind.value == other.certificate.kind.value == "unique"
    assert_same_pressures(one, other)
    zones, places, pressure = by_zone(one)
    soft, stiff = (pressure[(zones == name) & ~places.any(axis=1)] for name in ("cl", "cr"))
    assert len(soft) == len(stiff) == 1
    assert soft[0] < stiff[0]


def halves(orders, floor):
    """Two bonded halves of a block under pressure on a floor."""
    pressed = {"top": {"pressure": 0.5}}
    bodies = {
        "l": elastic(block((-3, 1), (0, 2), (8, 6, 8, 6)), {**pressed, "left": {"displacement": {"x": 0}}}),
        "r": elastic(block((1, 3), (0, 2), (4, 6, 4, 6)), pressed),
        "floor": floor,
    }
    pairs = {"cl": ["l/bottom", "floor/top"], "cr": ["r/bottom", "floor/top"]}
    contacts = {name: {"between": pair[::order]} for (name, pair), order in zip(pairs.items(), orders, strict=True)}
    bonded = {"glue": ["l/right", "r/left"]}
    return bemcontact.solve(stated(name="halves", bodies=bodies, contacts=contacts, bonded=bonded, accuracy=None))


@pytest.mark.parametrize("orders", [(-1, -1), (1, -1)])
def test_bonded_bodies_have_one_point_where_their_joint_meets_another_body(orders):
    """Whichever sides are first: the elements are the same. The compliance is definite, as that of one body is."""
    floor = elastic(block((-5, 5), (-3, 0), (20, 6, 20, 6)), HELD, 500.0)
    one, other = halves((1, 1), floor), halves(orders, floor)
    assert one.certificate.kind.value == other.certificate.kind.value == "unique"
    assert_same_pressures(one, other)
    joint = ~(by_zone(one)[1] - (1, 0)).any(axis=1)
    assert joint.sum() == 2
    assert len({*by_zone(one)[2][joint]}) == 1


@pytest.mark.slow
@pytest.mark.parametrize("surface", [FLAT, ROUND])
def test_bonded_bodies_under_a_loaded_tool_are_one_body(surface):
    """Nothing but contact holds them: the tool, and both bodies together, move freely."""
    floor = {"kind": "plane", "point": [0, -2], "normal": [0, 1]}

    def sunk(top, bottom, **spec):
        zones = {"ram": {"edges": top, "surface": surface}, "floor": {"edges": bottom, "surface": floor}}
        tools = {"ram": {"zones": "ram", "force": {"y": -40.0}}}
        result = bemcontact.solve(stated(name="bonded", contact_zones=zones, tools=tools, accuracy=0.003, **spec))
        assert result.certified
        return result.solution.pressure.max(), result.to_dict()["tools"][0]["displacement"][1]

    halves = {"up": elastic(block((0, 8), (0, 2))), "low": elastic(block((0, 8), (-2, 0)))}
    two = sunk("up/top", "low/bottom", bodies=halves, bonded={"glue": ["up/bottom", "low/top"]})
    np.testing.assert_allclose(two, sunk("top", "bottom", **elastic(block((0, 8), (-2, 2)))), rtol=0.003)


@pytest.mark.slow
def test_springs_are_the_limit_of_a_thin_layer():
    """A bonded layer of E = k t and ν = 0 has the stiffness k across and k/2 along: the rest falls with t."""
    k, own, zone = 100.0, elastic(block((0, 8), (0, 2))), {"surface": {**ROUND, "center": [4, 102], "radius": 100}}

    def sunk(spec, edge):
        tools = {"ram": {"zones": "ram", "force": {"y": -4.0}}}
        zones = {"ram": {"edges": edge, **zone}}
        result = bemcontact.solve(stated(name="layer", contact_zones=zones, tools=tools, accuracy=0.003, **spec))
        assert result.certified
        return np.array([result.to_dict()["tools"][0]["displacement"][1], result.solution.pressure.max()])

    springs = sunk({**own, "conditions": {"bottom": {"spring": {"normal": k, "tangent": k / 2}}}}, "top")
    rest = []
    for t in (0.4, 0.2):
        layer = {**elastic(block((0, 8), (-t, 0)), HELD), "material": {"young_modulus": k * t, "poisson_ratio": 0.0}}
        bodies = {"up": own, "layer": layer}
        rest.append(sunk({"bodies": bodies, "bonded": {"glue": ["up/bottom", "layer/top"]}}, "up/top") / springs - 1)
    rest = np.abs(rest)
    assert (rest[0] < 0.02).all()
    ratios = rest[:-1] / rest[1:]
    assert (ratios > 1.8).all(), rest
    assert (ratios < 2.5).all(), rest


def test_bonded_bodies_on_a_rigid_one_are_one_body():
    result = halves((1, 1), rigid(block((-5, 5), (-3, 0))))
    assert result.certificate.kind.value == "unique"
    np.testing.assert_allclose(result.solution.pressure, 0.5, rtol=1e-9)


def on_two_edges(contacts):
    """A block on another one whose top is two edges."""
    lower = polygon(bottom=(-4, -4), right=(4, -4), t1=(4, 0), t2=(1, 0), left=(-4, 0))
    for edge, elements in zip(lower["outer"], (6, 6, 6, 10, 6), strict=True):
        edge["elements"] = elements
    up = elastic(block((-3, 2), (0, 2), (10, 6, 10, 6)), {"top": {"displacement": {"x": 0, "y": -0.01}}})
    return solved({"up": up, "low": elastic(lower, HELD, 2000.0)}, **contacts)


PARTS = {"c": ["up/bottom", "low/t1"], "e": ["up/bottom", "low/t2"]}


@pytest.mark.parametrize("turned", [{}, {"c": ["low/t1", "up/bottom"]}, {"e": ["low/t2", "up/bottom"]}])
def test_one_contact_is_two_with_the_parts_of_its_edge(turned):
    """The elements are the same, whichever side of each is the first; forces are those on the first side."""
    one = on_two_edges({"whole": {"between": ["up/bottom", ["low/t1", "low/t2"]]}})
    two = on_two_edges(PARTS | turned)
    assert two.certificate.kind.value == "unique"
    assert two.penetration is None
    assert two.contact.size == one.contact.size
    order = [np.lexsort(np.round(result.contact.points.T, 9)) for result in (one, two)]
    np.testing.assert_allclose(
        two.solution.pressure[order[1]],
        one.solution.pressure[order[0]],
        rtol=0,
        atol=1e-8 * one.solution.pressure.max(),
    )
    signs = np.array([-1.0 if name in turned else 1.0 for name in PARTS])
    np.testing.assert_allclose(
        signs @ [two.footprint.forces[name] for name in PARTS], one.footprint.forces["whole"], atol=1e-9
    )
    np.testing.assert_allclose(
        signs @ [two.footprint.moments[name] for name in PARTS], one.footprint.moments["whole"], atol=1e-9
    )


@pytest.mark.slow
def test_free_arms_of_a_thin_layer_are_straight():
    """Statics: nothing bends them. Errors of elements under the load lift their ends, and are to be found."""
    layer = polygon(bottom=(-50, 0), right=(50, 0), east=(50, 1), top=(5, 1), west=(-5, 1), left=(-50, 1))
    bodies = {
        "layer": elastic(layer, {"top": {"pressure": 10.0}}, 2e5),
        "low": elastic(block((-60, 60), (-40, 0)), HELD, 2e5),
    }
    result = solved(bodies, 0.01, c=["layer/bottom", "low/top"])
    assert result.holds
    assert result.boundary is not None
    bottom = result.boundary.edge == result.boundary.edge_names.index("layer/bottom")
    x, lift = result.boundary.points[bottom][:, 1, 0], result.boundary.displacement[bottom][:, 1, 1]
    arm = x > 10
    away = lift[arm] - np.polyval(np.polyfit(x[arm], lift[arm], 1), x[arm])
    assert abs(away).max() < 0.01 * lift.max()


@pytest.mark.slow
@pytest.mark.parametrize("named", [False, True])
@pytest.mark.parametrize("exchanged", [False, True])
def test_rollers_between_plates_that_bend_slide_by_an_amount_that_is_not_known(exchanged, named):
    """No load drives them, and slopes by far less than friction: pressures hold, and balance the load."""
    rim = {"name": "rim", "kind": "arc", "center": [-24, 16], "radius": 16, "angles": [-90, 270]}
    below, above = (block((-60, 64), y) for y in ((-26, 0), (32, 56)))
    bodies = {
        "base": elastic(below, {"bottom": {"displacement": {"y": 0}}, **GUIDED}, 2600.0),
        "r1": elastic({"outer": [rim]}, modulus=26000.0),
        "r2": {"copy_of": "r1", "shift": [48, 0]},
        "upper": elastic(above, {"top": {"pressure": 0.1}, **GUIDED}, 2600.0),
    }
    sides = [(roller, plate) for roller in ("r1", "r2") for plate in ("base/top", "upper/bottom")]
    pairs = [[f"{r}/rim", plate] if named else [r, plate.partition("/")[0]] for r, plate in sides]
    contacts = {f"c{i}": pair[::-1] if exchanged else pair for i, pair in enumerate(pairs)}
    result = solved(bodies, 0.05, **contacts)
    assert result.certified
    if exchanged:  # from the rollers, the deformation of the plates seems to hold them
        assert sum("a little friction holds it" in note for note in result.notes) == 1
    forces = np.abs([result.footprint.forces[f"c{i}"][1] for i in range(4)])
    assert np.allclose(forces[::2], forces[1::2], rtol=1e-6)
    assert forces[0] + forces[2] == pytest.approx(0.1 * 124, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("turned", [{}, {"c": ["w/t1", "d/under"]}])
def test_a_disk_holds_on_a_line_of_two_edges(turned):
    """It slides past the joint, where the surface of neither contact ends for it: the line goes on."""
    disk = {
        "outer": [
            {"name": "under", "kind": "arc", "start": [-3, 3], "end": [3, 3], "center": [0, 3]},
            {"name": "top", "end": [-3, 3]},
        ]
    }
    bodies = {
        "d": elastic(disk, {"top": {"displacement": {"x": 0, "y": -0.05}}}),
        "w": elastic(polygon(bottom=(-4, -4), right=(4, -4), t1=(4, 0), t2=(0.1, 0), left=(-4, 0)), HELD, 2000.0),
    }
    one = solved(bodies, accuracy=0.01, c={"between": ["d/under", ["w/t1", "w/t2"]]})
    two = solved(bodies, accuracy=0.01, **({"c": ["d/under", "w/t1"], "e": ["d/under", "w/t2"]} | turned))
    assert two.holds
    bars = [bar for result in (one, two) for bar in result.accuracy.bars if bar.quantity in ("peak", "force")]
    known = [(bar.quantity, bar.value or 0.0, (bar.value or 0.0) * (bar.bar or 0.0)) for bar in bars]
    allowed = {name: sum(error for quantity, _, error in known if quantity == name) for name in ("peak", "force")}
    assert one.footprint.peak is not None
    assert two.footprint.peak is not None
    assert abs(one.footprint.peak.pressure - two.footprint.peak.pressure) <= allowed["peak"]
    (_, c), (_, e) = (two.footprint.forces[name] for name in "ce")
    assert abs((-c if turned else c) + e - one.footprint.forces["c"][1]) <= allowed["force"]


@pytest.mark.slow
@pytest.mark.parametrize("driven", [True, False])
def test_a_roller_squeezed_without_a_load_is_held_wherever_its_rim_begins(driven):
    """On a coarse mesh the turn about nearly its middle seems to open one gap, and has no bound: no position to refuse.

    Its force, from interference or from a driven body, is that with the rim that begins at an end of contact.
    """
    jaw, forces = rigid(block((-3, 3), (2, 3))), []
    for start in (200, 270):
        rim = {"name": "rim", "kind": "arc", "center": [0, 1], "radius": 1, "angles": [start, start + 360]}
        base = elastic(block((-10, 10), (-10, 0)), {"bottom": {"displacement": {"x": 0, "y": 0.004 * driven}}})
        bodies = {"roller": elastic({"outer": [rim]}), "jaw": jaw, "base": base}
        above = {"between": ["roller", "jaw"], "gap": 0.0 if driven else -0.004}
        result = solved(bodies, 0.01, above=above, below=["roller", "base"])
        assert result.holds
        forces.append(result.footprint.forces["below"][1])
        assert forces[-1] == pytest.approx(-result.footprint.forces["above"][1], rel=1e-9)
    assert forces[0] == pytest.approx(forces[1], rel=0.01)


@pytest.mark.parametrize("kind", ["body", "polyline"])
def test_a_wide_contact_on_a_flat_face_is_that_on_a_plane(kind):
    """A face with corners far away is a plane for a roller, also where the rim is tilted by 14 degrees against it."""
    overlap, rim = 0.3, [{"name": "rim", "kind": "arc", "center": [0, 2.5], "radius": 2.5, "angles": [90, 450]}]
    top = 5 - overlap

    def between(above, below):
        zones = {name: {"edges": "rim", "surface": it} for name, it in (("above", above), ("below", below))}
        material = {"young_modulus": 1000.0, "poisson_ratio": 0.3}
        parts = {"boundary": {"outer": rim}, "contact_zones": zones, "accuracy": 0.01}
        return bemcontact.solve(stated(name="roller", material=material, **parts))

    def plane(y, way):
        return {"kind": "plane", "point": [0, y], "normal": [0, way]}

    planes = between(plane(top, -1), plane(0, 1))
    if kind == "body":
        lid, base = rigid(block((-6, 6), (5, 8))), rigid(block((-6, 6), (-3, 0)))
        above = {"between": ["roller", "lid"], "gap": -overlap}
        bodies = {"roller": elastic({"outer": rim}), "lid": lid, "base": base}
        faces = solved(bodies, 0.01, above=above, below=["roller", "base"])
    else:
        lid = {"kind": "polyline", "points": [[6, 8], [6, top], [-6, top], [-6, 8]]}
        base = {"kind": "polyline", "points": [[-6, -3], [-6, 0], [6, 0], [6, -3]]}
        faces = between(lid, base)
    assert faces.holds
    assert planes.holds
    assert abs(faces.intervals[0].start[0]) > 0.15 * 2.5  # well beyond the tilt of 5.7 degrees from which faces end
    for zone in ("above", "below"):
        assert faces.forces[zone][1] == pytest.approx(planes.forces[zone][1], rel=1e-3)
        (one, other) = (result.accuracy.bar_of("peak", zone) for result in (faces, planes))
        assert one.value == pytest.approx(other.value, rel=one.bar + other.bar)


@pytest.mark.parametrize("exchanged", [False, True])
def test_a_body_moves_with_the_elastic_one_that_it_stays_on(exchanged):
    """Under p = a + b x a block of height h bends exactly: its top sinks by a h / E' and turns by -b h / E'.

    A stiff block moves with it. Contact is closed everywhere, so that no gap changes. A condensed problem does not
    know how bodies turn.
    """
    height, slope, modulus = 4.0, 0.05, 10.0
    load = {"top": {"pressure": {"constant": 1.0, "x": slope}}}
    bodies = {
        "stiff": elastic(block((-2, 2), (0, 3), (2,) * 4), load, 1e6 * modulus),
        "base": elastic(block((-2, 2), (-height, 0), (2,) * 4), {"bottom": {"displacement": {"y": 0}}}, modulus),
    }
    pair = ["stiff/bottom", "base/top"]
    result = solved(bodies, 0.01, seat=pair[::-1] if exchanged else pair)
    (turning,) = (j for j, name in enumerate(result.contact.motion_names) if "rotation" in name)
    assert "'stiff'" in result.contact.motion_names[turning]
    assert result.rotations[turning] == pytest.approx(-slope * height / modulus * (1 - 0.3**2), rel=1e-5)
    assert result.accuracy.bar_of("motion").value == pytest.approx(-height / modulus * (1 - 0.3**2), rel=1e-5)
    told = dict(facts(result.to_dict(), result.units))
    assert f"{-result.rotations[turning]:.3g}" in told["Rotation"]
    assert result.contact.rotations(result.solution.rigid_amplitudes) is None


def test_a_comparison_has_the_rotations_of_elastic_bodies():
    """What turns is seen on the boundary, not at the contact points: they were null in the JSON of a comparison."""
    load = {"top": {"pressure": {"constant": 1.0, "x": 0.05}}}
    bodies = {"stiff": elastic(block((-2, 2), (0, 3), (2,) * 4), load, 1e3), "base": elastic(
        block((-2, 2), (-4, 0), (2,) * 4), HELD, 10.0
    )}  # fmt: skip
    tilted = problem(bodies, None, seat=["stiff/bottom", "base/top"])
    result = bemcontact.solve(tilted)
    (j,) = (j for j, name in enumerate(result.contact.motion_names) if "rotation" in name)
    assert result.rotations[j] < -0.01
    record = bemcontact.compare(tilted, "qp3").to_dict()
    for item in (record["reference"], *record["contenders"]):
        assert item["answer"]["rotations"][j] == pytest.approx(result.rotations[j], rel=1e-6)
        assert item["answer"]["unknown_motions"] == []


def test_the_error_bar_of_a_rotation_is_of_the_angle_that_is_told():
    """Blocks of equal width under an eccentric load, whose foot is held: a bar of 1 % against a mesh for 0.1 %."""
    load = {"top": {"displacement": {"x": 0}, "traction": {"y": {"constant": -1.0, "x": -0.1}}}}
    bodies = {
        "stiff": elastic(block((-2, 2), (0, 3)), load, 1e5),
        "base": elastic(block((-2, 2), (-4, 0)), HELD, 10.0),
    }
    rough, fine = (
        bemcontact.solve(problem(bodies, asked, seat=["stiff/bottom", "base/top"])) for asked in (0.01, 1e-3)
    )
    bars = [result.accuracy.bar_of("rotation") for result in (rough, fine)]
    for result, bar in zip((rough, fine), bars, strict=True):
        assert bar.value == pytest.approx(result.rotations[result.contact.motion_names.index(bar.mover)], rel=1e-9)
    assert abs(bars[0].value - bars[1].value) < sum(bar.bar * abs(bar.value) for bar in bars)
