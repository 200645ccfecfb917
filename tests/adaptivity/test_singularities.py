"""Infinite pressures are told from finite ones by how they grow from mesh to mesh."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from debonds import PRESSURE, halves

from bemcontact.adaptivity.adapt import meshed
from bemcontact.adaptivity.fields import MeshDifference, solved
from bemcontact.adaptivity.singularities import (
    ContactPlace,
    Singularity,
    Watch,
    _History,
    _nearest,
    _places,
    _slope,
)
from bemcontact.problems import Problem
from bemcontact.spec import load

GALLERY = Path(__file__).parents[2] / "models" / "gallery"
PLACE = ContactPlace(run=0, zone="z", position=0.0)


def history(growth: list[float], element: list[float]) -> _History:
    return _History(place=PLACE, case=0, growth=growth, element=element)


@pytest.mark.parametrize("exponent", [0.25, 1 / 3, 1 / 2, 2 / 3])
def test_a_power_is_found_at_the_third_pass(exponent: float):
    """P ~ s^-α grows by 2^α each time that its element is cut in two."""
    growth = [2**exponent] * 4
    elements = [1 / 2, 1 / 4, 1 / 8, 1 / 16]
    assert not history(growth[:2], elements[:2]).grows()
    assert history(growth[:3], elements[:3]).grows()


@pytest.mark.parametrize("order", [0.5, 1.0, 2.0])
def test_a_smooth_peak_is_not(order: float):
    """With p = p0 (1 - c h^q): what is left to grow falls by 2^q each time, so by more than `LASTING` allows."""
    sizes = [2.0**-k for k in range(9)]
    values = [1 - 0.3 * h**order for h in sizes]
    growth = [after / before for before, after in pairwise(values)]
    for k in range(3, len(growth) + 1):
        grows = history(growth[:k], sizes[1 : k + 1]).grows()
        assert not grows or order < 1  # s^(1/2) is as slow as 0.707 > 0.6 each time, until it grows by less than 4 %
    assert not history(growth, sizes[1:]).grows()


def test_the_same_element_tells_nothing():
    """Growth from a mesh to its halves on elements that no pass made smaller is measured three times, not thrice."""
    assert not history([2**0.5] * 3, [0.1, 0.1, 0.1]).grows()


@pytest.mark.parametrize("growth", [1.0, 1.03, 1.95, 3.0])
def test_growth_out_of_range_is_no_power(growth: float):
    """Below 4 % a pass it is finite for the accuracies asked; twice as much is a peak that no node was near."""
    assert not history([growth] * 3, [0.4, 0.2, 0.1]).grows()


@pytest.mark.parametrize(
    ("measured", "known", "taken"),
    [(0.49, (1 / 2,), 1 / 2), (0.5, (0.48, 0.3), 0.48), (0.4, (1 / 2,), 0.4), (0.6, (), 0.6)],
)
def test_the_exponent_of_the_wedge_is_taken_if_it_is_near(measured: float, known: tuple[float, ...], taken: float):
    assert _nearest(measured, known) == (pytest.approx(taken), taken in known)


def test_a_logarithm_is_like_a_kink():
    assert Singularity(place=PLACE, exponent=0.1).like_a_kink
    assert not Singularity(place=PLACE, exponent=0.5).like_a_kink


def test_histories_are_kept_by_place_and_case():
    watch = Watch()
    first = watch._history(PLACE, 0, 1e-6)
    near = ContactPlace(run=0, zone="z", position=5e-7)
    assert watch._history(near, 0, 1e-6) is first
    assert watch._history(near, 1, 1e-6) is not first
    assert watch._history(ContactPlace(run=1, zone="z", position=0.0), 0, 1e-6) is not first
    assert watch._history(ContactPlace(run=0, zone="z", position=1e-3), 0, 1e-6) is not first


@pytest.mark.parametrize("refine", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_two_meshes_tell_the_infinite_pressure_of_a_punch_on_a_stated_mesh(refine: int):
    """K = P/(π √(2a)) at the edge of a punch of half-width a on a half-plane (Johnson 1985, section 2.8)."""
    punch = load(GALLERY / "flat_punch.yaml", variant="stated mesh").refined(refine)
    (accuracy,) = meshed(punch.model_copy(update={"accuracy": 0.01})).accuracies
    (peak,) = (bar for bar in accuracy.bars if bar.quantity == "peak")
    assert peak.value is None
    (intensity,) = (bar for bar in accuracy.bars if bar.quantity == "intensity")
    assert intensity.value == pytest.approx(2000 / (np.pi * np.sqrt(10)), rel=intensity.bar)
    assert accuracy.met


@pytest.mark.parametrize(
    "name",
    [
        "hertz_small",
        pytest.param("three_zones", marks=pytest.mark.slow),
        pytest.param("beam_on_two_supports", marks=pytest.mark.slow),
    ],
)
def test_no_pressure_of_smooth_contact_is_infinite_on_a_stated_mesh(name: str):
    stated = load(GALLERY / f"{name}.yaml", variant="stated mesh").model_copy(update={"accuracy": 0.01})
    assert not any(accuracy.infinite for accuracy in meshed(stated).accuracies)


def foot(shear: float, ratio: float | None = None) -> Problem:
    """A block on a floor, drawn down its right side, which ends at a corner that is pressed; graded towards it."""
    starts = {"bottom": (0, 0), "right": (60, 0), "top": (60, 30), "left": (0, 30)}
    edges: dict[str, dict[str, object]] = {name: {"name": name, "start": start} for name, start in starts.items()}
    if ratio is not None:
        for name, towards in (("bottom", "end"), ("right", "start")):
            edges[name] |= {"elements": 40, "grading": {"ratio": ratio, "towards": towards}}
        edges["top"]["elements"] = edges["left"]["elements"] = 10
    return Problem(
        name="foot",
        material={"young_modulus": 210e3, "poisson_ratio": 0.3},
        boundary={"outer": [*edges.values()]},
        conditions={"right": {"traction": {"y": -shear}}, "top": {"traction": {"y": -5}},
                    "left": {"displacement": {"x": 0}}},
        contact_zones={"floor": {"edges": "bottom", "surface": {"kind": "plane", "point": (0, 0), "normal": (0, 1)}}},
    )  # pyright: ignore[reportArgumentType] # fmt: skip


def test_a_shear_beside_contact_raises_the_peak_like_a_logarithm():
    """By 4τ/π for each unit of ln h, on meshes whose element h at the corner is shorter and shorter."""
    on_meshes = [solved(foot(0.5, ratio)) for ratio in (1e3, 1e4)]
    one, other = (float(np.log(item.weights.sum(axis=1).min())) for item in on_meshes)
    low, high = (float(item.answers[0].solution.pressure.max()) for item in on_meshes)
    assert (high - low) / (one - other) == pytest.approx(2 / np.pi, rel=0.01)


@pytest.mark.parametrize(
    ("shear", "accuracy", "infinite"), [(0.5, 0.01, True), (0.004, 0.01, False), (0.004, 1e-3, True)]
)
def test_a_logarithm_is_told_or_in_the_error_bar(shear: float, accuracy: float, infinite: bool):
    """What a corner of 1e-4 of the contact would add is over the accuracy, or else in the bar of the peak."""
    (found,) = meshed(foot(shear).model_copy(update={"accuracy": accuracy})).accuracies
    assert found.met
    (peak,) = (bar for bar in found.bars if bar.quantity == "peak")
    assert (peak.value is None) == infinite
    assert peak.bar is None or peak.bar * peak.value >= 4 * shear / np.pi * np.log(10)


def on_polyline(points: list[tuple[float, float]], accuracy: float | None, elements: int | None = None) -> Problem:
    """A block of 40 x 15 between smooth walls, pressed on a polyline below it."""
    corners, wall = {"bottom": (0, 0), "right": (40, 0), "top": (40, 15), "left": (0, 15)}, {"displacement": {"x": 0}}
    return Problem.model_validate({
        "name": "block", "accuracy": accuracy, "material": {"young_modulus": 210e3, "poisson_ratio": 0.3},
        "boundary": {"outer": [{"name": key, "start": at, "elements": elements} for key, at in corners.items()]},
        "conditions": {"top": {"pressure": 20}, "left": wall, "right": wall},
        "contact_zones": {"floor": {"edges": "bottom", "surface": {"kind": "polyline", "points": points}}},
    })  # fmt: skip


def on_a_ridge(turn: float, elements: int) -> float:
    """Pressure at a corner of this angle, pressed on a body with elements of equal lengths."""
    sides = [(0.0, -20 * np.tan(turn / 2)), (20.0, 0.0), (40.0, -20 * np.tan(turn / 2))]
    return float(solved(on_polyline(sides, None, elements)).answers[0].pressure.max())


def test_under_a_blunt_corner_the_pressure_grows_like_the_logarithm():
    """By E*/2π times the angle and ln 2 each time that the elements are cut in two (Johnson 1985, section 5.2)."""
    turn = 5e-4
    first, second, third = (on_a_ridge(turn, count) for count in (30, 60, 120))
    each = _slope(solved(on_polyline([(0, 0), (20, 0), (40, 0)], None, 4)), turn, 0) * np.log(2)
    assert second - first == pytest.approx(each, rel=0.03)
    assert third - second == pytest.approx(each, rel=0.01)


@pytest.mark.parametrize(("facets", "accuracy"), [(100, 0.1), (40, 0.01)])
def test_a_curve_drawn_as_lines_has_infinite_peaks_whatever_is_asked(facets: int, accuracy: float):
    """A mesh that does not resolve facets sees a round surface, with a peak that is finite and of no meaning."""
    angles = np.radians(np.linspace(135, 45, facets + 1))
    circle = np.column_stack([20 + 50 * np.cos(angles), 50 * (np.sin(angles) - 1)])
    (judged,) = meshed(on_polyline([(x, y) for x, y in circle.tolist()], accuracy)).accuracies
    assert judged.infinite == ("floor",)


def on_a_tilt(slope: float, accuracy: float | None, held: dict[str, object], elements: int | None = None) -> Problem:
    """A block of 40 x 25, pressed on a plane that is tilted against it, beside a face that is held or on a wall."""
    corners = {"bottom": (0, 0), "right": (40, 0), "top": (40, 25), "left": (0, 25)}
    plane = {"kind": "plane", "point": (0, 0), "normal": (slope, 1)}
    wall = {"wall": {"edges": "left", "surface": {"kind": "plane", "point": (0, 0), "normal": (1, 0)}}}
    return Problem.model_validate({
        "name": "tilt", "accuracy": accuracy, "material": {"young_modulus": 30e3, "poisson_ratio": 0.07},
        "boundary": {"outer": [{"name": key, "start": at, "elements": elements} for key, at in corners.items()]},
        "conditions": {"top": {"pressure": 36}, "right": {"pressure": 20}, **({"left": held} if held else {})},
        "contact_zones": {"floor": {"edges": "bottom", "surface": plane}, **({} if held else wall)},
    })  # fmt: skip


def test_beside_a_held_face_a_tilt_is_a_corner_of_twice_its_angle():
    """Pressure grows by E*/π times the slope and ln 2 each time that elements are cut in two, as on the whole of it."""
    held, slope = {"displacement": {"x": 0}}, 2e-4
    on_meshes = [float(solved(on_a_tilt(slope, None, held, count)).answers[0].pressure[0].max()) for count in (60, 120)]
    each = _slope(solved(on_a_tilt(0.0, None, held, 4)), 2 * slope, 0) * np.log(2)
    assert on_meshes[1] - on_meshes[0] == pytest.approx(each, rel=0.02)


@pytest.mark.parametrize(
    "surface",
    [
        {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
        {"kind": "circle", "center": [0, -30], "radius": 30, "body": "outside"},
    ],
)
def test_half_of_a_round_body_has_no_kink_on_its_axis(surface: dict[str, object]):
    """Elements turn a little beside a curve, here by a thousandth; the curve meets its axis at a right angle."""
    half = Problem.model_validate({
        "name": "half", "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
        "boundary": {"outer": [
            {"name": "rim", "kind": "arc", "center": [0, 10], "radius": 10, "angles": [-90, 90], "elements": 12},
            {"name": "axis", "elements": 8},
        ]},
        "conditions": {"axis": {"symmetry": "x"}},
        "loads": {"gravity": {"density": 1.0, "acceleration": [0, -0.5]}},
        "contact_zones": {"floor": {"edges": "rim", "surface": surface}},
    })  # fmt: skip
    coarse = solved(half)
    fine = solved(half.with_value("mesh.refine", 2))
    places = [*_places(MeshDifference(coarse=coarse, fine=fine, number=0))]
    assert [place.kink for place in places if place.end] == [0.0]


@pytest.mark.parametrize("held", ["face", "wall", "groove", "turned", "tool"])
@pytest.mark.parametrize(("slope", "accuracy", "infinite"), [(2e-4, 0.05, True), (2e-5, 0.01, True),
                                                            (2e-5, 0.1, False), (-2e-4, 0.01, False)])  # fmt: skip
def test_a_tilt_beside_a_held_face_or_a_wall_is_told_or_in_the_bar(
    held: str, slope: float, accuracy: float, infinite: bool
):
    """Also where displacements that are prescribed turn the face, or the plane, which is drawn level."""
    conditions: dict[str, dict[str, object]] = {
        "face": {"displacement": {"x": 0}},
        "wall": {},
        "groove": {},
        "turned": {"displacement": {"x": {"constant": 0, "y": -slope}}},
        "tool": {"displacement": {"x": 0}},
    }
    drawn = on_a_tilt(0.0 if held in ("turned", "tool") else slope, accuracy, conditions[held])
    turns = {"floor": {"zones": "floor", "point": [0, 0], "displacement": {"x": 0, "y": 0, "rotation": -slope}}}
    groove = {"kind": "polyline", "points": [[0, 30], [0, 0], [60, -60 * slope]]}
    more: dict[str, dict[str, object]] = {
        "tool": {"tools": turns},
        "groove": {"contact_zones": {"floor": {"edges": ["left", "bottom"], "surface": groove}}},
    }  # fmt: skip
    problem = Problem.model_validate({**drawn.to_dict(), **more.get(held, {})})
    (found,) = meshed(problem).accuracies
    assert found.met
    peaks = [bar for bar in found.bars if bar.quantity == "peak" and bar.zone in ("floor", None)]
    assert any(bar.value is None for bar in peaks) == infinite
    if not infinite and slope > 0:
        grows = 30e3 / (1 - 0.07**2) * slope / np.pi * np.log(10)
        assert max(bar.bar * bar.value for bar in peaks) >= grows


HELD = {"top": {"pressure": PRESSURE}}, {"bottom": {"displacement": {"y": 0}}, "left": {"displacement": {"x": 0}}}
"""Conditions of two blocks that are bonded on one half of their common line."""


@pytest.mark.slow
@pytest.mark.parametrize(("modulus", "elements"), [(200.0, None), (5000.0, None), (5000.0, 4)])
def test_pressure_beside_a_bond_of_different_materials_is_infinite(modulus: float, elements: int | None):
    """Like the root, as the shear of the bond: K = |β| times its intensity there, from any mesh.

    For equal ratios of 0.3 Dundurs' β is 0.8/2.8 times (G1 - G2)/(G1 + G2).
    """
    found = meshed(halves("bc", HELD, moduli=(1000.0, modulus), n=elements, accuracy=2e-3 if elements is None else 0.1))
    (accuracy,) = found.accuracies
    (peak,) = (bar for bar in accuracy.bars if bar.quantity == "peak")
    assert peak.value is None
    assert peak.at == (0.0, 0.0)
    assert "where a bond begins" in peak.note
    (intensity,) = (bar for bar in accuracy.bars if bar.quantity == "intensity")
    assert intensity.note == "p = K s^-0.5"
    if intensity.value is None:
        return
    answer = solved(found.problem).answers[0]
    own = answer.state.edge == answer.state.edge_names.index("up/i0")
    s, shear = -answer.state.points[own, 1:2, 0].ravel(), answer.traction[own, 1:2, 0].ravel()
    beside = (s > 0.02) & (s < 0.3)
    assert beside.sum() > 6
    fit = np.polynomial.Polynomial.fit(np.sqrt(s[beside]), shear[beside] * np.sqrt(s[beside]), 3)
    beta = 0.8 / 2.8 * (1000.0 - modulus) / (1000.0 + modulus)
    assert intensity.value == pytest.approx(abs(beta * fit(0.0)), rel=intensity.bar)


@pytest.mark.parametrize("elements", [None, 4])
def test_pressure_beside_a_bond_of_equal_materials_is_finite_whatever_the_shear(elements: int | None):
    """Also where stress of the bond is infinite: mode II has no pressure on its line."""
    sheared = {"top": {"traction": {"x": 1.0, "y": -PRESSURE}}}, HELD[1]
    (accuracy,) = meshed(halves("bc", sheared, n=elements, accuracy=0.02)).accuracies
    assert not accuracy.infinite
    (start,) = (bar for bar in accuracy.bars if bar.quantity == "start")
    assert start.note == "contact reaches the bond"


@pytest.mark.slow
@pytest.mark.parametrize("modulus", [1000.0, 5000.0])
@pytest.mark.parametrize(("kinds", "n"), [("bc", 3), ("bcb", 2), ("cbc", 2)])
def test_error_bars_of_a_debond_against_finer_meshes(kinds: str, n: int, modulus: float):
    """The error of a stated mesh, as elements a quarter as long tell it, is below its bar, and so is that of halves."""
    load = {"top": {"pressure": {"constant": PRESSURE, "x": 1.0}}}, HELD[1]
    problem = halves(kinds, load, moduli=(1000.0, modulus), n=n, accuracy=0.05)
    (coarse,), (middle,), (fine,) = (meshed(problem.refined(refine)).accuracies for refine in (1, 2, 4))
    known = {(bar.quantity, bar.zone): bar.value for bar in fine.bars}
    for bars in (coarse.bars, middle.bars):
        compared = 0
        for bar in bars:
            exact = known.get((bar.quantity, bar.zone))
            if bar.quantity in ("peak", "force", "pressure", "displacement") and None not in (
                bar.bar,
                bar.value,
                exact,
            ):
                assert abs(bar.value - exact) <= bar.bar * abs(bar.value), bar
                compared += 1
        assert compared >= 2
