"""Bodies that are drawn elsewhere than where they come to touch have the answer of those that are drawn there."""

import re
from pathlib import Path

import numpy as np
import pytest
import scipy
from known_answers import pin_in_hole
from several_bodies import HELD, block, circle, elastic, polygon, problem, rigid

import bemcontact
from bemcontact.adaptivity import resting_contacts
from bemcontact.adaptivity.resting_contacts import RESTING
from bemcontact.problems import Material
from bemcontact.reference.pin_in_hole import LoosePin

MODELS = Path(__file__).parents[2] / "models"
CLEARANCE = 0.02
LOAD = 20 * 0.138339  # half angle 30 degrees, which depends on load over clearance


def drawn(height: float) -> bemcontact.Problem:
    """Half of a pin with the clearance, drawn above or below the center of its hole."""
    spec = pin_in_hole(LOAD).replace("[0, -0.001]", f"[0, {height}]").replace("1.001", str(1 + CLEARANCE))
    return bemcontact.loads(spec.replace("clearance: 0.001", f"clearance: {CLEARANCE}"))


@pytest.mark.parametrize("height", [-1.0, 0.0, 1.0])
def test_a_pin_may_be_drawn_anywhere_along_its_load(height: float):
    """The closed form has no drawn place; 1.4 / 20² is for the size of the plate, as in `test_pin_in_hole`.

    With the pairs of the pin in the middle, the peak would be off by half the clearance over the radius, 1 %.
    """
    steel = Material(young_modulus=1000, poisson_ratio=0.3)
    form = LoosePin(load=LOAD, radius=1.0, clearance=CLEARANCE, pin=steel, plate=steel)
    result = bemcontact.solve(drawn(height * CLEARANCE))
    assert result.certified
    assert result.footprint.peak
    bars = {bar.quantity: bar.bar or 0.0 for bar in result.accuracy.bars}
    assert result.footprint.peak.pressure == pytest.approx(form.peak, rel=bars["peak"] + 1.4 / 20**2)


def in_hole(x: float, y: float, hole: float, load: tuple[float, float] = (0, -1.0)) -> bemcontact.Problem:
    """A heavy pin of radius 1 in the hole of a plate, drawn with its center at (x, y)."""
    rim = {"name": "rim", "kind": "arc", "center": [x, y], "radius": 1, "angles": [90, 450]}
    weight = {"loads": {"gravity": {"density": 1.0, "acceleration": [*load]}}}
    plate = {**block((-4, 4), (-4, 4)), "holes": [[circle("bore", hole, start=90, hole=True)]]}
    bodies = {"pin": elastic({"outer": [rim]}, **weight), "plate": elastic(plate, HELD)}
    return problem(bodies, 0.01, c=["pin/rim", "plate/bore"])


@pytest.mark.slow
@pytest.mark.parametrize("way", [(-1, 0), (0, 0), (0.6, 0.8)])
@pytest.mark.parametrize("clearance", [0.02, 0.1])
def test_a_pin_may_be_drawn_at_any_side_of_its_hole(way: tuple[float, float], clearance: float):
    """It comes to lie at the bottom. A peak rests to a twentieth of the accuracy asked, in both."""
    x, y = clearance * np.array(way)
    drawn_there, elsewhere = (
        bemcontact.solve(in_hole(*at, 1 + clearance)) for at in ((0.0, -clearance), (float(x), float(y)))
    )
    bars = sum(bar.bar or 0.0 for it in (drawn_there, elsewhere) for bar in it.accuracy.bars if bar.quantity == "peak")
    peaks = [it.footprint.peak.pressure for it in (drawn_there, elsewhere) if it.footprint.peak]
    assert peaks[1] == pytest.approx(peaks[0], rel=2 * RESTING * 0.01 + bars)
    assert elsewhere.holds


@pytest.mark.slow
@pytest.mark.parametrize("clearance", [1e-3, 1e-5, 1e-8])
def test_joints_that_are_nearly_opposite_to_each_other(clearance: float):
    """Elements that end at both are short, and grow from there: else the compliance is not definite any more.

    The first element of a pin is opposite to the last one of its hole over the clearance.
    """
    result = bemcontact.solve(in_hole(-clearance, 0, 1 + clearance, load=(-1.0, 0)))
    assert result.holds
    assert result.certificate.smallest_eigenvalue
    assert result.certificate.smallest_eigenvalue > 0.01


@pytest.mark.slow
def test_a_path_has_the_pairs_of_its_end():
    """So its end is the answer to the problem there."""
    spec = in_hole(0, 0, 1.02)
    followed = bemcontact.follow(spec, "bodies.pin.loads.gravity.density", 1.0, start=0.8)
    result = bemcontact.solve(spec)
    assert result.footprint.peak
    bars = sum(it.bar or 0.0 for it in result.accuracy.bars if it.quantity == "peak")
    assert followed.path.at(1.0).pressure.max() == pytest.approx(result.footprint.peak.pressure, rel=2 * bars)
    assert followed.holds


@pytest.mark.parametrize(("clearance", "holds"), [(0.03, True), (0.12, False)])
def test_load_cases_that_share_their_pairs_say_what_that_changes(clearance: float, holds: bool):
    """A peak is off by half the clearance over the radius: 1.5 % is noted, and from 5 % on the result is withheld.

    The change by a second solution, which takes the deformation along, says the same.
    """
    lighter, heavier = (
        {"bodies": {"pin": {"gravity": {"density": density, "acceleration": [0, -1]}}}} for density in (0.1, 0.2)
    )
    spec = in_hole(0, 0, 1 + clearance).with_value("load_cases", {"lighter": lighter, "heavier": heavier})
    for result in bemcontact.solve_cases(spec).results.values():
        assert result.holds is holds
        told = [*result.notes, result.penetration.words if result.penetration else ""]
        words = (
            "points opposite to each other were found",
            "with the gaps after this motion, the peak pressure there falls",
        )
        assert any(item in text for item in words for text in told)


def rounded_punch(slide=0.0, *, drawn=0.0):
    """A rigid punch with a flat face of 2 and edges rounded by 0.5 on a block, that its bottom slides along it."""
    block = {"bottom": (-5, -5), "right": (5, -5), "top": (5, 0), "left": (-5, 0)}
    punch = [
        {"name": "face", "start": (-1 + drawn, 0), "end": (1 + drawn, 0)},
        {"name": "right edge", "kind": "arc", "center": (1 + drawn, 0.5), "end": (1.5 + drawn, 0.5)},
        {"name": "right side", "end": (1.5 + drawn, 2)},
        {"name": "back", "end": (-1.5 + drawn, 2)},
        {"name": "left side", "end": (-1.5 + drawn, 0.5)},
        {"name": "left edge", "kind": "arc", "center": (-1 + drawn, 0.5), "end": (-1 + drawn, 0)},
    ]
    return bemcontact.problem({
        "name": "rounded punch",
        "bodies": {
            "block": {
                "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
                "boundary": {"outer": [{"name": name, "start": at} for name, at in block.items()]},
                "conditions": {"bottom": {"displacement": {"x": slide, "y": 0}}},
            },
            "punch": {"rigid": True, "boundary": {"outer": punch}},
        },
        "contacts": {"press": {"between": ["block/top", "punch"]}},
        "tools": {"ram": {"zones": "press", "force": {"y": -10}}},
        "accuracy": 0.02,
    })  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("slide", [-0.01, 0.2])
def test_a_block_that_slides_under_a_punch_is_that_under_a_punch_drawn_there(slide):
    """Where the face goes over into its edges the curvature jumps: gaps as drawn would have a false corner there."""
    slid, there = bemcontact.solve(rounded_punch(slide)), bemcontact.solve(rounded_punch(drawn=-slide))
    for result in (slid, there):
        assert result.certified
        assert result.accuracy.met
    bars = [bar.bar for result in (slid, there) for bar in result.accuracy.bars if bar.quantity == "peak"]
    assert slid.peak.pressure == pytest.approx(there.peak.pressure, rel=sum(bars))
    assert slid.intervals[0].length == pytest.approx(there.intervals[0].length, rel=0.005)
    assert slid.intervals[0].start[0] == pytest.approx(there.intervals[0].start[0], abs=0.005)


@pytest.mark.parametrize("place", [(0.0, 5.0), (3.0, 6.0), (-2.0, 9.0)])
def test_a_roller_may_be_drawn_anywhere_above_a_block(place):
    """A tool takes it to one place and presses it on: where it was drawn does not matter."""
    x, _ = place
    block = {"bottom": (-12, -8), "right": (12, -8), "top": (12, 0), "left": (-12, 0)}
    result = bemcontact.solve(
        bemcontact.problem({
            "name": "roller",
            "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
            "boundary": {"outer": [{"name": name, "start": at} for name, at in block.items()]},
            "conditions": {"bottom": {"fixed": True}},
            "contact_zones": {"top": {"edges": "top", "surface": {
                "kind": "circle", "center": place, "radius": 5, "body": "outside"}}},
            "tools": {"roller": {"zones": "top", "force": {"y": -10}, "displacement": {"x": 1.0 - x}}},
        })
    )  # fmt: skip
    assert result.certified
    assert result.forces["top"] == pytest.approx((0, -10), abs=0.025)
    start, end = result.intervals[0].start, result.intervals[0].end
    assert (start[0] + end[0]) / 2 == pytest.approx(1.0, abs=0.005)
    hertz = np.sqrt(10 * 1000 / 0.91 / np.pi / 5)
    assert result.peak.pressure == pytest.approx(hertz, rel=0.02)  # the block is finite: b/h is 0.04


@pytest.mark.slow
def test_a_spline_that_moves_away_from_where_it_is_drawn_has_its_ends_with_it():
    """Drawn 13 beside the place where it presses, which is beyond its end as drawn; the same as drawn there."""
    block = {"bottom": (-20, -10), "right": (20, -10), "top": (20, 0), "left": (-20, 0)}
    profile = np.array([[5, 4], [4, 2], [2, 0.4], [0, 0], [-2, 0.4], [-4, 2], [-5, 4]])

    def solved(x: float, y: float) -> bemcontact.Result:
        surface = {"kind": "spline", "points": (profile + np.array([4 - x, y])).tolist()}
        return bemcontact.solve(
            bemcontact.problem({
                "name": "cam",
                "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
                "boundary": {"outer": [{"name": name, "start": at} for name, at in block.items()]},
                "conditions": {"bottom": {"fixed": True}},
                "contact_zones": {"top": {"edges": "top", "surface": surface}},
                "tools": {"cam": {"zones": "top", "force": {"y": -10}, "displacement": {"x": x}}},
            })
        )  # fmt: skip

    moved, there = solved(13.0, 2.0), solved(0.0, 0.0)
    assert moved.certified
    assert not any("continuation" in note for note in moved.notes)
    bars = [bar.bar for result in (moved, there) for bar in result.accuracy.bars if bar.quantity == "peak"]
    assert moved.peak.pressure == pytest.approx(there.peak.pressure, rel=sum(bars))
    assert moved.intervals[0].length == pytest.approx(there.intervals[0].length, rel=0.005)


@pytest.mark.slow
def test_each_load_case_has_surfaces_where_it_moves_them():
    """A shaft in a bush, pressed down, aside and both ways: each is that of a shaft drawn where it comes to lie.

    The bush is alike in all directions, so that the first two have one peak, by Lamé's symmetry and no other number.
    """
    cases = {"down": {"y": -100}, "aside": {"x": 100}}
    spec: dict[str, object] = {
        "name": "bush",
        "accuracy": 0.02,
        "material": {"young_modulus": 2000, "poisson_ratio": 0.3},
        "boundary": {
            "outer": [{"name": "outside", "kind": "arc", "center": [0, 0], "radius": 20, "angles": [-90, 270]}],
            "holes": [[{"name": "bore", "kind": "arc", "center": [0, 0], "radius": 12, "angles": [270, -90]}]],
        },
        "conditions": {"outside": {"fixed": True}},
        "tools": {"shaft": {"zones": "seat", "force": {"x": 0, "y": 0}}},
        "load_cases": {name: {"tools": {"shaft": {"force": force}}} for name, force in cases.items()},
        "combinations": {"both": {"down": 1, "aside": 0.5}},
    }

    def seat(x: float, y: float) -> dict[str, object]:
        surface = {"kind": "circle", "center": [x, y], "radius": 11, "body": "outside"}
        return {"contact_zones": {"seat": {"edges": "bore", "surface": surface}}}

    shared = bemcontact.solve_cases(bemcontact.problem({**spec, **seat(0, 0)}))
    assert shared.holds
    peaks = {name: result.peak.pressure for name, result in shared.results.items() if result.peak is not None}
    for name, (x, y) in {"down": (0, -1), "aside": (1, 0), "both": (0.5 / 1.25**0.5, -1 / 1.25**0.5)}.items():
        assert not any("against the surface" in note for note in shared.results[name].notes)
        there = bemcontact.solve(bemcontact.problem({**spec, **seat(x, y)}), case=name)
        bars = [shared.results[name].accuracy.peak_bar(), there.accuracy.peak_bar()]
        assert there.peak is not None
        assert peaks[name] == pytest.approx(there.peak.pressure, rel=sum(bar or 0 for bar in bars))
    assert peaks["down"] == pytest.approx(peaks["aside"], rel=0.01)


def turned_roller(x: float, **roller: object) -> bemcontact.Result:
    """A rigid roller of radius 5 above a block, drawn at x, that a tool displaces to x = 0 and turns about its axis."""
    block = {"bottom": (-12, -8), "right": (12, -8), "top": (12, 0), "left": (-12, 0)}
    return bemcontact.solve(
        bemcontact.problem({
            "name": "roller that turns",
            "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
            "boundary": {"outer": [{"name": name, "start": at} for name, at in block.items()]},
            "conditions": {"bottom": {"fixed": True}},
            "contact_zones": {"top": {"edges": "top", "surface": {
                "kind": "circle", "center": (x, 5), "radius": 5, "body": "outside"}}},
            "tools": {"roller": {"zones": "top", "point": (x, 5), **roller}},
            "accuracy": 0.02,
        })
    )  # fmt: skip


@pytest.mark.parametrize(("x", "rotation"), [(0.0, 0.002), (0.0, 0.05), (-1.0, 0.002), (-1.0, 0.05)])
def test_a_roller_that_turns_about_its_axis_is_the_same(x: float, rotation: float):
    """So the turn changes nothing, wherever the roller is drawn; its lever is that of the place where it presses."""
    turns, rests = (turned_roller(x, displacement={"x": -x, "y": -0.024, "rotation": turn}) for turn in (rotation, 0.0))
    assert turns.holds
    assert turns.forces["top"] == pytest.approx(rests.forces["top"], abs=1e-3)
    assert turns.peak
    assert rests.peak
    assert turns.peak.pressure == pytest.approx(rests.peak.pressure, rel=1e-3)


@pytest.mark.parametrize("x", [0.1, 1.0, -3.0])
def test_a_roller_that_is_free_to_turn_presses_straight_down(x: float):
    """A moment of 0 about its axis says that the force passes through the axis: it has no component along the block."""
    result = turned_roller(x, displacement={"x": -x}, force={"y": -10, "moment": 0})
    assert result.holds
    assert result.forces["top"] == pytest.approx((0, -10), abs=0.025)


@pytest.mark.slow
@pytest.mark.parametrize(("drawn", "height"), [(1.0, 3.0), (0.0, 3.0), (0.5, 3.0), (0.0, 0.0)])
@pytest.mark.parametrize("kind", ["plane", "circle"])
def test_a_tool_rolls_on_a_dome_to_where_the_force_passes_through_its_point(kind: str, drawn: float, height: float):
    """The point comes to x = 1 at a height h over a dome of radius R: normals through it are at x = 1 / (1 + h / R).

    There the dome has the slope x / R, and so has the force.
    """
    radius, half = 50.0, 10.0
    low = np.sqrt(radius**2 - half**2) - radius
    surfaces = {
        "plane": {"kind": "plane", "point": [drawn, 0], "normal": [0, -1]},
        "circle": {"kind": "circle", "center": [drawn, 1000], "radius": 1000, "body": "outside"},
    }
    result = bemcontact.solve(
        bemcontact.problem({
            "name": "dome",
            "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
            "boundary": {"outer": [
                {"name": "bottom", "start": [-half, low - 10]},
                {"name": "right", "start": [half, low - 10]},
                {"name": "top", "kind": "arc", "center": [0, -radius], "start": [half, low], "end": [-half, low]},
                {"name": "left", "start": [-half, low]},
            ]},
            "conditions": {"bottom": {"fixed": True}},
            "contact_zones": {"top": {"edges": "top", "surface": surfaces[kind]}},
            "tools": {"tool": {
                "zones": "top", "point": [drawn, height], "displacement": {"x": 1 - drawn},
                "force": {"y": -10, "moment": 0}}},
            "accuracy": 0.02,
        })
    )  # fmt: skip
    assert result.holds
    at = 1 / (1 + height / radius)
    ends = [end[0] for end in (result.intervals[0].start, result.intervals[0].end)]
    assert sum(ends) / 2 == pytest.approx(at, abs=0.01)
    assert result.forces["top"] == pytest.approx((-10 * at / radius, -10), abs=0.025)


def nose_on_a_block(slide: float, sides: list[str], *, drawn: float = 0.0) -> bemcontact.Result:
    """A round nose of radius 2 that is pressed on a block by 0.05, and slides along it."""
    nose = [
        {"name": "round", "kind": "arc", "center": [drawn, 2], "start": [drawn - 1.2, 0.4], "end": [drawn + 1.2, 0.4]},
        {"name": "right", "end": [drawn + 1.2, 4]},
        {"name": "top", "end": [drawn - 1.2, 4]},
        {"name": "left"},
    ]
    bodies = {
        "nose": elastic({"outer": nose}, {"top": {"displacement": {"x": slide, "y": -0.05}}}),
        "block": elastic(block((-7, 7), (-3, 0)), {"bottom": {"fixed": True}}),
    }
    return bemcontact.solve(problem(bodies, 0.03, c=sides))


@pytest.mark.parametrize(
    "sides", [["nose/round", "block/top"], pytest.param(["block/top", "nose/round"], marks=pytest.mark.slow)]
)
def test_a_nose_that_slides_along_a_flat_block_presses_straight_down(sides: list[str]):
    """As if it were drawn there, whichever side is the first: normals of pairs turn as a round second side slides."""
    slid, there = nose_on_a_block(0.1, sides), nose_on_a_block(0.0, sides, drawn=0.1)
    for result in (slid, there):
        assert result.holds
        assert abs(result.forces["c"][0]) < 0.0025 * abs(result.forces["c"][1])
    bars = sum(bar.bar or 0.0 for result in (slid, there) for bar in result.accuracy.bars if bar.quantity == "force")
    assert slid.forces["c"][1] == pytest.approx(there.forces["c"][1], rel=bars)


@pytest.mark.slow
def test_contacts_that_move_together_may_press_alone():
    """A nose of two edges, each with a contact, slides along a block: as drawn one of them presses, then both alike."""
    low = {"bottom": (-10, -8), "right": (10, -8), "top": (10, 0), "left": (-10, 0)}

    def nose(x: float) -> bemcontact.Result:
        quarter = {"kind": "arc", "center": (x, 5)}
        bodies = {
            "low": {
                "material": {"young_modulus": 2000, "poisson_ratio": 0.3},
                "boundary": {"outer": [{"name": name, "start": at} for name, at in low.items()]},
                "conditions": {"bottom": {"fixed": True}},
            },
            "up": {
                "material": {"young_modulus": 2000, "poisson_ratio": 0.3},
                "boundary": {"outer": [
                    {"name": "right nose", **quarter, "start": (x, 0), "end": (x + 5, 5)},
                    {"name": "top", "end": (x - 5, 5)},
                    {"name": "left nose", **quarter, "end": (x, 0)},
                ]},
                "conditions": {"top": {"displacement": {"x": -x, "y": -0.02}}},
            },
        }  # fmt: skip
        contacts = {side: {"between": [f"up/{side} nose", "low/top"]} for side in ("right", "left")}
        spec = {"name": "nose", "bodies": bodies, "contacts": contacts, "accuracy": 0.05}
        return bemcontact.solve(bemcontact.problem(spec))

    slid, there = nose(-1.0), nose(0.0)
    assert slid.holds
    assert slid.forces["right"][1] == pytest.approx(slid.forces["left"][1], rel=0.005)
    assert slid.forces["right"] == pytest.approx(there.forces["right"], abs=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("place", [(0.0, 0.0), (0.3, 0.1), (-0.3, 0.2), (0.1, -0.1)])
def test_a_roller_may_be_drawn_beside_its_seat(place: tuple[float, float]):
    """Two round bars hold it by forces along the lines through the centers: statics. It rolls in by many steps."""
    radius, bars = 2.0, {"left": (-35.0, 3.0), "right": (20.0, 8.0)}
    angles = {name: np.radians(degrees) for name, (degrees, _) in bars.items()}
    normals = {name: np.array([-np.sin(angle), np.cos(angle)]) for name, angle in angles.items()}
    zones = {
        name: {"edges": "rim", "surface": {
            "kind": "circle", "center": (-normals[name] * (radius + bar)).tolist(), "radius": bar, "body": "outside"}}
        for name, (_, bar) in bars.items()
    }  # fmt: skip
    result = bemcontact.solve(
        bemcontact.problem({
            "name": "roller in a seat",
            "material": {"young_modulus": 2e4, "poisson_ratio": 0.3},
            "boundary": {"outer": [
                {"name": "rim", "kind": "arc", "center": place, "radius": radius, "angles": [90, 450]}]},
            "loads": {"gravity": {"density": 1.0, "acceleration": [0, -1]}},
            "contact_zones": zones,
            "accuracy": 0.02,
        })
    )  # fmt: skip
    assert result.holds
    weight = np.pi * radius**2
    sizes = np.linalg.solve(np.column_stack([*normals.values()]), [0, weight])
    for (name, normal), size in zip(normals.items(), sizes, strict=True):
        assert result.forces[name] == pytest.approx(size * normal, abs=0.003 * weight)


@pytest.mark.slow
def test_ends_of_contact_do_not_go_along_with_a_slide(monkeypatch: pytest.MonkeyPatch):
    """A round nose slides over a flat beam by 2 % of the length of contact, and the contact stays below the nose.

    Ends of contact differ by their bars from those of pairs that rest to a thousandth of their length.
    """
    cantilevers = bemcontact.load(MODELS / "bodies" / "two_cantilevers.yaml")
    found = bemcontact.solve(cantilevers)
    monkeypatch.setattr(resting_contacts, "RESTING", 1e-3)
    at_rest = bemcontact.solve(cantilevers, accuracy=0.003)
    assert not any("elsewhere by" in note for note in found.notes)
    own, its = ({bar.quantity: bar for bar in it.accuracy.bars} for it in (found, at_rest))
    length = its["length"].value
    for end in ("start", "end"):
        allowed = own[end].bar + its[end].bar
        assert own[end].value == pytest.approx(its[end].value, rel=0, abs=allowed * length)


def test_contacts_with_faces_that_meet_in_a_corner_rest_as_those_with_faces_apart():
    """A roller slides down each face of a V, and the mean of both slides is neither of them.

    Contact is far from the corner of the V: it is elsewhere by less than its error bars where a short edge cuts the
    corner off. Ends were off by two hundredths of the length of contact.
    """

    def ends(**bottom):
        seat = polygon(bottom=(-12, -5), east=(12, -5), up=(12, 6), right=(6, 6), **bottom, down=(-6, 6), west=(-12, 6))
        rim = {"name": "rim", "kind": "arc", "center": [0, 4 * 2**0.5], "radius": 4, "angles": [90, 450]}
        weight = {"gravity": {"density": 1, "acceleration": [0, -2.0]}}
        bodies = {
            "roller": elastic({"outer": [rim]}, modulus=5500.0, loads=weight),
            "seat": elastic(seat, HELD, 5500.0),
        }
        result = bemcontact.solve(
            problem(bodies, 0.01, **{side: ["roller/rim", f"seat/{side}"] for side in ("left", "right")})
        )
        bars = [result.accuracy.bar_of(end, side) for side in ("left", "right") for end in ("start", "end")]
        lengths = np.repeat([result.accuracy.bar_of("length", side).value for side in ("left", "right")], 2)
        return np.array([bar.at for bar in bars]), np.array([bar.bar for bar in bars]) * lengths

    (whole, one), (cut, other) = ends(left=(0, 0)), ends(foot=(0.1, 0.1), left=(-0.1, 0.1))
    assert (np.hypot(*(whole - cut).T) < one + other).all()


def test_load_cases_note_how_far_contact_is_from_where_it_would_be_alone():
    """Load cases share the pairs of bodies as drawn. Alone, cantilevers are paired where they have slid to.

    Their contact is as long, so that no note says that it is shorter: ends move by whole elements, pressure does not.
    """
    problem = bemcontact.load(MODELS / "bodies" / "two_cantilevers.yaml")
    pressed = {"conditions": {"upper/pressed": {"pressure": 0.1}}}
    spec = problem.to_dict() | {"load_cases": {"heavy": pressed}}
    del spec["bodies"]["upper"]["conditions"]["pressed"], spec["reference"]
    result = bemcontact.solve_cases(bemcontact.problem(spec)).results["heavy"]
    alone = bemcontact.solve(problem)
    (here,), (there,) = result.intervals, alone.intervals
    off = abs(np.mean(here.arc) - np.mean(there.arc)) / there.length
    assert off > 0.01
    assert here.length == pytest.approx(there.length, rel=2e-3)
    told = [float(found[1]) for note in result.notes if (found := re.search(r"elsewhere by up to ([\d.e+-]+) %", note))]
    assert len(told) == 1
    assert off <= told[0] / 100 <= 3 * off
    assert not any("shorter" in note for note in result.notes)


ROLLER, STEEL, DOWN = 10.0, 210e3, 0.01


def under_a_plate(
    rotation: float, *, axes: float = 0.0, unit: float = 1.0, swap: bool = False, post: bool = False
) -> bemcontact.Result:
    """A free roller on a rigid table, under a rigid plate that comes down by `DOWN` and turns about its middle.

    All is turned by an angle [deg], and lengths are in a `unit`; the plate may press on a post that is held, too.
    """
    cosine, sine = np.cos(np.radians(axes)), np.sin(np.radians(axes))

    def at(x: float, y: float) -> list[float]:
        return [unit * (cosine * x - sine * y), unit * (sine * x + cosine * y)]

    def box(left: float, right: float, low: float, high: float) -> dict[str, object]:
        return polygon(bottom=at(left, low), right=at(right, low), top=at(right, high), left=at(left, high))

    modulus, (x, y) = STEEL / unit**2, at(0, -DOWN)
    bodies = {
        "table": rigid(box(-40, 40, -30, -ROLLER)),
        "roller": elastic({"outer": [circle("rim", unit * ROLLER)]}, modulus=modulus),
        "plate": rigid(box(-40, 40, ROLLER, 30)),
    }
    contacts = {"low": ["roller/rim", "table/top"], "high": ["roller/rim", "plate/bottom"]}
    if post:
        bodies["post"] = elastic(box(-30, -20, -ROLLER, ROLLER), {"bottom": {"fixed": True}}, modulus)
        contacts["post"] = ["post/top", "plate/bottom"]
    return bemcontact.solve(
        bemcontact.problem({
            "name": "roller under a plate",
            "bodies": bodies,
            "contacts": {name: {"between": pair[::-1] if swap else pair} for name, pair in contacts.items()},
            "tools": {"plate": {
                "zones": [*contacts][1:], "point": at(0, ROLLER), "displacement": {"x": x, "y": y, "rotation": rotation}
            }},
        })
    )  # fmt: skip


def peak_of_squeezed_roller() -> float:
    """Peak pressure on a roller between plates that approach by `DOWN` = 2 P (2 ln(4 R / a) - 1) / π E'.

    The contacts are those of Hertz: a² = 4 P R / π E' and p0 = 2 P / π a (Johnson 1985, section 5.6).
    """
    modulus = STEEL / (1 - 0.3**2)

    def half_width(force: float) -> float:
        return float(np.sqrt(4 * force * ROLLER / np.pi / modulus))

    def too_far(force: float) -> float:
        return 2 * force / np.pi / modulus * (2 * np.log(4 * ROLLER / half_width(force)) - 1) - DOWN

    force = scipy.optimize.brentq(too_far, 1.0, 1e4)
    return 2 * force / np.pi / half_width(force)


@pytest.mark.parametrize(
    "view",
    [{}, {"axes": 0.3}, {"axes": 2}, {"axes": 5, "swap": True}, {"axes": 27}, {"axes": 90}, {"unit": 1 / 25.4}],
    ids=str,
)
@pytest.mark.parametrize("rotation", [0.0, 1e-4, -1e-3, 1e-3])
def test_a_roller_under_a_plate_that_turns_is_squeezed_in_all_axes(rotation: float, view: dict[str, float]):
    """A circle does not see a turn: the roller takes half of it, and both contacts are those of plates in parallel.

    Contact does not follow the turn: there is no pressure between a table and a plate that is not parallel to it until
    the roller has left the place between them. So the roller is held along the table, as a little friction does.
    """
    result = under_a_plate(rotation, **view)
    assert result.holds
    for zone in ("low", "high"):
        bar = result.accuracy.bar_of("peak", zone)
        assert bar.value is not None
        assert bar.value * view.get("unit", 1.0) ** 2 == pytest.approx(peak_of_squeezed_roller(), rel=bar.bar)
    assert any("moves no contact point and has no load: it is held at zero" in note for note in result.notes)
    assert not any("no contact point carries pressure" in note for note in result.notes)


@pytest.mark.parametrize("axes", [0, 27])
def test_a_plate_that_pushes_a_roller_out_by_the_accuracy_asked_has_no_certified_answer(axes: float):
    """At 0.01 it pushes along the table by one part in a hundred of its force, which is what was asked for."""
    assert not under_a_plate(0.01, axes=axes).certified


@pytest.mark.parametrize("axes", [0, 27])
def test_a_roller_is_squeezed_beside_a_post_that_goes_on_to_press(axes: float):
    """Contact that is followed would leave the pressure on the post, and none on the roller beside it."""
    result = under_a_plate(1e-3, axes=axes, post=True)
    assert np.hypot(*result.forces["post"]) > 0
    bar = result.accuracy.bar_of("peak", "high")
    assert bar.value == pytest.approx(peak_of_squeezed_roller(), rel=bar.bar)
