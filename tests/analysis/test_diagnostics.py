"""Remarks on a result: contact up to the end of a zone, few points under a contact, long elements beyond its end.

Loads that balance, and growth within a clearance: no contact, exactly, and sane numbers in any units.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from contact_meshes import cylinder, ring, table
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from tool_problems import BETWEEN, made

import bemcontact
from bemcontact.analysis.check import check
from bemcontact.analysis.result import Result
from bemcontact.analysis.solve import condense, solve
from bemcontact.errors import ProblemError
from bemcontact.problems import Problem
from bemcontact.problems.surface_lines import Spline
from bemcontact.report.contact_words import units_of
from bemcontact.report.facts import facts

FEW, LONG = "pressure acts on", "pressure acts at"
FOLDER = Path(__file__).parents[2] / "models" / "gallery"


def block(angle: float, refine: int = 1, right: dict[str, object] | None = None) -> Result:
    """A block 20 high pressed on a plane, its right side leaning by an inner angle in degrees at (20, 0)."""
    fine = {"elements": 8, "grading": {"ratio": 50, "towards": "end"}}
    edges = [
        {"name": "bottom", "start": [0, 0], **fine},
        {"name": "right", "start": [20, 0], **fine, "grading": {"ratio": 50, "towards": "start"}},
        {"name": "top", "start": [20 + 20 * np.tan(np.radians(angle - 90)), 20], "elements": 4},
        {"name": "left", "start": [0, 20], "elements": 3},
    ]
    problem = Problem(
        name="block",
        material={"young_modulus": 210e3, "poisson_ratio": 0.3},
        boundary={"outer": edges},
        conditions={"left": {"displacement": {"x": 0}}, "top": {"pressure": 3}, **({"right": right} if right else {})},
        contact_zones={"foot": {"edges": "bottom", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
    )
    return bemcontact.solve(problem.refined(refine))


@pytest.mark.parametrize("depth", [-1.0, -1e-7, 0.0, 1.0])
def test_a_surface_drawn_inside_a_free_body_is_noted(depth: float):
    """A block 20 high under 3 MPa is compressed by about 2.6e-4: 1 is far more, 1e-7 is not."""
    held = block(90.0).problem
    assert held is not None
    lifted = held.with_value("contact_zones.foot.surface.point", [0, -depth])
    result = bemcontact.solve(lifted)
    assert ("is drawn 1 inside the body" in " ".join(result.notes)) == (depth == -1.0)
    assert result.footprint.peak.pressure == pytest.approx(3.0)


def test_a_flat_side_on_knife_edges_is_not_hardly_held_but_not_at_all():
    """The normal of a flat side on an edge is that of the side: no slope holds it, and one note says so."""
    edges = {"left": [[5, -20], [20, 0], [35, -20]], "right": [[65, -20], [80, 0], [95, -20]]}
    data: dict = {
        "name": "beam on two edges", "material": {"young_modulus": 210e3, "poisson_ratio": 0.3}, "accuracy": None,
        "boundary": {"outer": [
            {"name": "bottom", "start": [0, 0], "elements": 20}, {"name": "end", "start": [100, 0], "elements": 2},
            {"name": "top", "start": [100, 10], "elements": 20}, {"name": "begin", "start": [0, 10], "elements": 2},
        ]},
        "conditions": {"top": {"pressure": 0.01}},
        "contact_zones": {name: {"edges": "bottom", "surface": {"kind": "polyline", "points": points}}
                          for name, points in edges.items()},
    }  # fmt: skip
    notes = " ".join(bemcontact.solve(Problem(**data)).notes)
    assert "not determined: the translation along (1, 0)" in notes
    assert "only slopes" not in notes


@pytest.mark.slow
@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0])
def test_a_flat_side_on_round_supports_is_hardly_held_along_it(angle: float):
    """Circles at half the span: at the contact places, s from their tops, normals have the slopes s / R."""
    turn = np.array(
        [
            [np.cos(np.radians(angle)), np.sin(np.radians(angle))],
            [-np.sin(np.radians(angle)), np.cos(np.radians(angle))],
        ]
    )
    corners = [[-100, 0], [100, 0], [100, 20], [20, 20], [-20, 20], [-100, 20]]
    names = ["bottom", "right", "top right", "loaded", "top left", "left"]
    circles = {side: (np.array([x, -10]) @ turn).tolist() for side, x in {"low": -80, "high": 80}.items()}
    problem = Problem(
        name="bar",
        material={"young_modulus": 210e3, "poisson_ratio": 0.3},
        boundary={
            "outer": [
                {"name": n, "start": (np.array(at) @ turn).tolist()} for n, at in zip(names, corners, strict=True)
            ]
        },
        conditions={"loaded": {"pressure": 2}},
        contact_zones={
            side: {"edges": "bottom", "surface": {"kind": "circle", "center": center, "radius": 10, "body": "outside"}}
            for side, center in circles.items()
        },
    )
    result = bemcontact.solve(problem)
    (note,) = (note for note in result.notes if "only slopes" in note)
    x, y = np.round(turn[0], 2) + 0.0
    ends = [
        abs((np.array(at) @ turn.T)[0]) - 80 for item in result.footprint.intervals for at in (item.start, item.end)
    ]
    slope = float(note.partition("at most ")[2].partition(",")[0])
    assert f"translation along ({x:g}, {y:g}):" in note
    assert slope == pytest.approx(max(np.abs(ends)) / 10, rel=0.1)  # two figures, and the last node in contact
    assert result.certified


def at_the_corner(result: Result) -> float:
    """The pressure at (20, 0)."""
    return float(result.solution.pressure[np.argmax(result.contact.points[:, 0])])


@pytest.mark.parametrize("angle", [110, 120, 135])
def test_at_an_obtuse_corner_the_pressure_is_unbounded_as_the_note_states(angle: float):
    """Williams 1952, wedge of twice the angle α: p ~ r^(λ - 1), sin 2λα + λ sin 2α = 0; h/2 raises p by 2^(1 - λ).

    To 1 %, for the second term of the wedge, which is smaller by a power of the shortest element, 0.003 of the block.
    """
    results = [block(angle, refine) for refine in (1, 2)]
    double = 2 * np.radians(angle)
    exponent = brentq(lambda power: np.sin(power * double) + power * np.sin(double), 0.4, 0.999) - 1
    once, twice = map(at_the_corner, results)
    assert np.log2(twice / once) == pytest.approx(-exponent, rel=0.01)
    for result in results:
        (note,) = result.notes
        assert f"the end of the zone 'foot' at (20, 0), a corner of the body of {angle} degrees" in note
        assert "infinite in theory" in note
        assert "longer" not in note


def test_at_a_right_angle_the_pressure_is_bounded_and_there_is_no_note():
    """Uniform compression is the solution."""
    result = block(90)
    assert at_the_corner(result) == pytest.approx(3, rel=1e-10)
    assert result.notes == ()


def test_at_an_acute_corner_contact_opens_or_there_is_no_note():
    """The wedge of twice the angle has no notch."""
    assert block(70).notes == ()


def test_a_corner_that_is_held_beyond_the_zone_is_another_one():
    """The wedge of the note is free on its other face; with displacements prescribed there, nothing is said."""
    assert block(120, right={"displacement": {"x": 0}}).notes == ()


def test_on_a_smooth_boundary_both_readings_are_reported():
    """That of a zone too short, and that of a punch, whose pressure is infinite at its edge."""
    (note,) = notes(bemcontact.load(FOLDER / "flat_punch.yaml"), "contact reaches")
    assert "(5, 0), where the boundary goes on smoothly; make the zone longer, unless the surface ends" in note
    assert "infinite in theory" in note


def notes(problem: bemcontact.Problem, start: str) -> list[str]:
    """Notes of a result on the mesh as stated that begin with a text."""
    result = bemcontact.solve(problem, "complementarity")
    return [note for note in result.notes if note.startswith(start)]


@pytest.mark.slow
def test_few_points_are_reported_of_each_contact():
    """Two feet with a few points each, enough of them together; on finer elements there are enough on each."""
    told = notes(table(), FEW)
    assert len(told) == 2
    assert all(" contact points from (" in note and "in feet: the mesh is too coarse there" in note for note in told)
    assert notes(table().refined(4), FEW) == []


def test_points_across_the_seam_are_of_one_contact():
    """Contact over half of a pin, with the seam in the middle of it."""
    assert notes(ring(90), FEW) == []


@pytest.mark.slow
@pytest.mark.parametrize(("elements", "told"), [(2, True), (24, False)])
def test_long_elements_beyond_a_pressed_corner_are_reported(elements, told):
    """On the axis: the peak is off by a third beside the long ones, and a mesh that is found has none."""
    stated = cylinder(24, load=0.01).with_value("boundary.outer.axis.grading.ratio", 1)
    coarse = stated.with_value("boundary.outer.axis.elements", elements)
    found = notes(coarse, LONG)
    assert bool(found) is told
    if told:
        assert found[0].startswith(
            "pressure acts at (0, 0), the end of the zone 'foot', beyond which an element of 'axis'"
        )
        assert found[0].endswith("grade that edge towards the zone")
    found_mesh = bemcontact.solve(coarse.with_value("accuracy", 3e-3))
    assert found_mesh.accuracy.met
    assert not [note for note in found_mesh.notes if note.startswith(LONG)]
    assert found_mesh.footprint.peak.pressure == pytest.approx(18.819, rel=3e-3)  # Hertz


def test_a_body_that_nothing_presses_floats_and_a_note_states_so():
    """A block between a floor and a plate that moves away: contact could hold it, but carries no pressure."""
    moves_away = {"press": {"zones": "press", "displacement": {"y": 0.1}}}
    result = bemcontact.solve(
        made(BETWEEN, tools=moves_away, load_cases={}, combinations={}, conditions={"left": {"displacement": {"x": 0}}})
    )
    assert result.footprint.intervals == ()
    assert any("so that the translation along (0, 1) is not determined" in note for note in result.notes)


RADII = 10.0, 20.0
POWERS = st.sampled_from([-12, -6, 0, 6, 12])
LOADS = ("spin", "bore", "opposing", "heat", "cases")


def loose_ring(load: str, gap: float, size: float = 1.0, stress: float = 1.0, elements: int = 8) -> Problem:
    """A ring in a round hole with a clearance; what loads it has no resultant. Lengths and stresses have any unit.

    Its mesh is not judged: the statements are on this mesh.
    """
    inner, outer = (radius * size for radius in RADII)
    modulus = 2e5 * stress
    rim = [{"name": "rim", "kind": "arc", "center": [0, 0], "radius": outer, "angles": [0, 360], "elements": elements}]
    halves = [
        {"name": name, "kind": "arc", "center": [0, 0], "radius": inner, "angles": angles, "elements": elements // 2}
        for name, angles in (("upper", [180, 0]), ("lower", [360, 180]))
    ]
    spin = {"density": 1e-3 * stress / size**2, "angular_velocity": 30, "center": [0, 0]}
    up, down = {"traction": {"y": 100 * stress}}, {"traction": {"y": -100 * stress}}
    pressed = {"pressure": 100 * stress}
    of_load = {
        "spin": {"loads": {"centrifugal": spin}},
        "bore": {"conditions": {"upper": pressed, "lower": pressed}},
        "opposing": {"conditions": {"upper": up, "lower": down}},
        "heat": {"loads": {"temperature": {"expansion": 1e-5, "change": 50}}},
        "cases": {
            "load_cases": {"one": {"conditions": {"upper": up}}, "other": {"conditions": {"lower": down}}},
            "combinations": {"both": {"one": 1, "other": 1}},
            "case": "both",
        },
    }
    wall = {"kind": "circle", "center": [0, 0], "radius": outer + gap, "body": "inside"}
    return Problem(
        name="ring",
        accuracy=None,
        material={"young_modulus": modulus, "poisson_ratio": 0.3},
        boundary={"outer": rim, "holes": [halves]},
        contact_zones={"wall": {"edges": ["rim"], "surface": wall}},
        **of_load[load],
    )


@cache
def growth(load: str) -> np.ndarray:
    """How far the rim moves outwards without contact, at each point; the mean position is fixed by the gauge."""
    return -condense(loose_ring(load, 0.0)).free_displacement


@cache
def terms(load: str) -> float:
    """Largest sum of the magnitudes of the displacements that load cases, or all loads together, add up to growth."""
    contact = condense(loose_ring(load, 0.0))
    parts = contact.cases.displacement if len(contact.cases) else contact.free_displacement[:, None]
    return float(abs(parts).sum(axis=1).max())


@settings(max_examples=15)
@given(load=st.sampled_from(LOADS), excess=st.floats(-9, 0.5), size=POWERS, stress=POWERS, formulation=st.booleans())
def test_growth_within_the_clearance_makes_no_contact(load, excess, size, stress, formulation):
    """A clearance above the largest growth leaves p = 0 as the only solution, whatever the units."""
    assume(load != "spin" or abs(stress - 2 * size) < 30)  # the density, which is bounded like each stated number
    gap = float(growth(load).max()) * (1 + 10**excess)
    problem = loose_ring(load, gap * 10.0**size, 10.0**size, 10.0**stress)
    result = solve(problem, "qp3" if formulation else "complementarity")
    assert result.certified
    assert not result.solution.pressure.any()
    assert result.footprint.peak is None
    assert not result.footprint.intervals
    assert not result.touching.any()
    assert result.certificate.error_bound < 1e-9 * result.contact.scales.pressure
    assert result.certificate.relative_error_bound is None
    U = result.contact.scales.displacement
    assert pytest.approx((gap + terms(load)) * 10.0**size, rel=1e-9) == U  # no scale is round-off
    texts = dict(facts(result.to_dict(), units_of(result.contact)))
    assert texts["Contact"].startswith("nowhere")
    assert texts.get("Rotation", ": not determined").endswith(": not determined")
    assert "position not determined" in result.certificate.heading
    assert "Peak pressure" not in texts
    assert texts["Resultant"].startswith("(0, 0)")
    assert result.residuals.force_balance < 1e-12


@settings(max_examples=10)
@given(load=st.sampled_from(("spin", "bore", "heat")), depth=st.floats(-8, -0.5), size=POWERS, stress=POWERS)
def test_growth_beyond_the_clearance_makes_contact(load, depth, size, stress):
    """Below the least growth no position of the ring is free; U is the least interference of all positions.

    It is the largest where the ring is not moved, at most. A translation does not change the mean growth, so that it is
    no less than what the wall prevents of this. M p takes it all away: ‖M‖∞ max p >= U = ‖M‖∞ T.
    """
    assume(load != "spin" or abs(stress - 2 * size) < 30)
    gap = float(growth(load).min()) * (1 - 10**depth)
    result = solve(loose_ring(load, gap * 10.0**size, 10.0**size, 10.0**stress), "complementarity")
    least, most = ((moved - gap) * 10.0**size for moved in (growth(load).min(), growth(load).max()))
    assert result.certified
    assert result.footprint.peak is not None
    assert result.footprint.intervals
    U, T = result.contact.scales
    round_off = 1e-6 * most + 1e-12 * gap * 10.0**size  # of the linear program, and of the growth
    assert least - round_off <= U <= most + round_off
    assert result.footprint.peak.pressure >= T * (1 - round_off / U)


def pipe(traction: float, weight: float, counts: tuple[int, int] = (4, 7)) -> Problem:
    """A pipe on a floor under its weight, both halves of its bore pulled apart; their elements differ in length."""
    arcs = [("a", [180, 0], counts[0]), ("b", [360, 180], counts[1])]
    floor = {"kind": "plane", "point": [0, -2], "normal": [0, 1]}
    gravity = {"density": weight / (3 * np.pi), "acceleration": [0, -1]}
    around = {"kind": "arc", "center": [0, 0]}
    return Problem(
        name="pipe",
        accuracy=None,
        material={"young_modulus": 1e4, "poisson_ratio": 0.3},
        boundary={
            "outer": [
                {"name": "sole", **around, "radius": 2, "angles": [225, 315], "elements": 8},
                {"name": "back", **around, "radius": 2, "angles": [-45, 225], "elements": 8},
            ],
            "holes": [[{"name": n, **around, "radius": 1, "angles": angles, "elements": k} for n, angles, k in arcs]],
        },
        conditions={"a": {"traction": {"y": traction}}, "b": {"traction": {"y": -traction}}},
        loads={"gravity": gravity} if weight else {},
        contact_zones={"floor": {"edges": ["sole"], "surface": floor}},
    )


@settings(max_examples=10)
@given(share=st.floats(-7, 0), counts=st.tuples(st.integers(3, 8), st.integers(3, 8)))
def test_residue_of_the_mesh_is_no_load(share: float, counts: tuple[int, int]):
    """The tractions balance on the circle, and so the floor carries the weight alone, on any mesh."""
    weight = 10**share
    result = solve(pipe(1.0, weight, counts), "complementarity")
    x, y = result.footprint.resultant.force
    assert result.certified
    assert y == pytest.approx(weight, abs=1e-9)
    assert abs(x) < 1e-9
    assert result.residuals.force_balance < 1e-9
    net = weight / (2 * np.pi + weight)
    assert result.contact.net_load == pytest.approx(net, rel=0.01)
    assert any("nearly balance" in note for note in result.notes) is (net < 1e-3)


def test_a_fit_does_not_depend_on_what_nearly_balances():
    """A ring on a pin, pressed from outside a little more from above: the fit carries it, and nothing hangs on it."""
    ring = bemcontact.load(FOLDER / "shrink_fit.yaml", variant="stated mesh")
    result = solve(ring.with_value("conditions.rim", {"pressure": {"constant": 20, "y": 1e-4}}), "complementarity")
    assert 0 < result.contact.net_load < 1e-3
    assert not any("nearly balance" in note for note in result.notes)


@pytest.mark.parametrize("weight", [0.0, 1e-11])
def test_balanced_loads_do_not_press_a_body_onto_its_support(weight: float):
    with pytest.raises(ProblemError, match="no load presses it onto its support"):
        solve(pipe(1.0, weight), "complementarity")


@pytest.mark.parametrize(("asked", "noted"), [(0.3, True), (0.100001, True), (0.1, False), (0.01, False)])
def test_an_accuracy_above_a_tenth_is_noted(asked: float, noted: bool):
    """By the problem, or by the argument; the note has the number and what to ask for."""
    problem = bemcontact.load(Path(__file__).parents[2] / "models" / "gallery" / "hertz_small.yaml")
    for notes in (
        bemcontact.solve(problem.with_value("accuracy", asked)).notes,
        bemcontact.solve(problem, accuracy=asked).notes,
    ):
        told = [note for note in notes if "accuracy of" in note]
        assert len(told) == noted
        assert all(f"{100 * asked:.3g} %" in note and "--accuracy 0.01" in note for note in told)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("flat", "noted"), [([-10, 30, 60, 95, 102], True), ([*range(-10, 98, 2), 98, 99, 99.5], False)]
)
def test_a_spline_that_swings_out_beside_a_bend_is_noted(flat: list[float], noted: bool):
    """A table that is flat up to a ramp: few points far apart let it bulge where the block stands, many do not."""
    points = [(float(x), 0.0) for x in flat if x < 100] + [(100.0, 0.0), (110.0, -1.0), (120.0, -2.0)]
    problem = Problem(
        name="block on a table",
        material={"young_modulus": 210e3, "poisson_ratio": 0.3},
        boundary={"outer": [{"name": k, "start": at} for k, at in
                            {"foot": (20, 0), "right": (80, 0), "top": (80, 40), "left": (20, 40)}.items()]},
        conditions={"top": {"pressure": 3}},
        contact_zones={"table": {"edges": "foot", "surface": {"kind": "spline", "points": points}}},
    )  # fmt: skip
    assert any("the spline of 'table' bulges by" in note for note in check(problem).notes)
    assert any("the spline of 'table' bulges by" in note for note in bemcontact.solve(problem).notes) is noted


def test_no_curve_of_even_points_bulges():
    """Points on arcs, an ellipse and a parabola: the curve leaves its chords as arcs do."""
    for count in (5, 9, 33):
        angle = np.linspace(0, np.pi, count)
        for x, y in ((20 * np.cos(angle), 20 * np.sin(angle)), (20 * np.cos(angle), 8 * np.sin(angle)),
                     (angle, 0.1 * angle**2)):  # fmt: skip
            excess, _ = Spline(points=tuple(zip(x.tolist(), y.tolist(), strict=True))).bulges
            assert excess.max() <= 0
