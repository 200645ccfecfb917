"""A pin in a hole: the closed form of Persson, Michell's series of both bodies, Hertz, and solved problems."""

from math import degrees, log, pi, radians, sqrt, tan

import numpy as np
import pytest
from known_answers import pin_in_hole
from messages import assert_one_mistake, assert_states

import bemcontact
from bemcontact.problems import Material
from bemcontact.reference import Expected, Score, expected, score
from bemcontact.reference.closed_forms import HertzContact
from bemcontact.reference.pin_in_hole import LoosePin


def material(modulus: float = 1000.0, nu: float = 0.3, state: str = "plane_strain") -> Material:
    return Material(young_modulus=modulus, poisson_ratio=nu, state=state)


def loose(load: float, pin: Material | None, plate: Material | None, clearance: float = 0.001) -> LoosePin:
    return LoosePin(load=load, radius=1.0, clearance=clearance, pin=pin, plate=plate)


PAIRS = {
    "equal": (material(), material()),
    "steel in aluminum": (material(3000), material()),
    "sheets": (material(1000, 0.3, "plane_stress"), material(2000, 0.45, "plane_stress")),
    "rigid pin": (None, material(1000, 0.0)),
    "rigid plate": (material(1000, 0.1), None),
}


@pytest.mark.parametrize("load", [1e-4, 0.01, 0.14, 1.5, 20.0])
@pytest.mark.parametrize("state", ["plane_strain", "plane_stress"])
def test_equal_materials_have_the_closed_form_of_persson(load: float, state: str):
    """[CD01]: pressure, and 4c/AQ = E* c/Q = (2 - log(b² + 1) - 2b⁴) / (π b² (b² + 1)) for α = β = 0."""
    form = loose(load, material(state=state), material(state=state))
    assert form.half_angle is not None
    b = tan(form.half_angle / 2)
    r2, modulus = 1 + b**2, material(state=state).contact_modulus
    assert (2 - log(r2) - 2 * b**4) / (pi * b**2 * r2) == pytest.approx(modulus * 0.001 / load, rel=1e-12)
    y = b * np.linspace(0, 0.99, 12)
    w, r = np.sqrt(b**2 - y**2), sqrt(r2)
    pressure = 2 * w / (pi * r * (1 + y**2)) + np.log((r + w) / (r - w)) / (2 * pi * b**2 * r2)
    found = form.pressure(2 * np.arctan(y)) * form.mean_radius / load
    assert found == pytest.approx(pressure, rel=1e-10)
    assert form.pressure(-2 * np.arctan(y)) == pytest.approx(form.pressure(2 * np.arctan(y)), rel=1e-14)


def places(form: LoosePin, number: int) -> tuple[np.ndarray, np.ndarray]:
    """Angles θ = ε sin t and their weights: in t, pressure times weight is smooth and periodic."""
    end, turn = form.half_angle or 0.0, ((np.arange(number) + 0.5) / number - 0.5) * pi
    return end * np.sin(turn), end * np.cos(turn) * pi / number


def displacement(form: LoosePin, angle: np.ndarray, terms: int = 3000) -> np.ndarray:
    """Radial displacement (k,) of the pin minus that of the plate, without rigid motions, by Michell's series.

    From potentials A z^(n+1) and B z^(n-1) of the pin, and of the plate with -n for n, free of shear on the circle.
    """
    theta, length = places(form, 3000)
    weighted, total = form.pressure(theta) * length, np.zeros(len(angle))
    for n in [0, *range(2, terms)]:
        harmonic = weighted @ np.cos(n * theta) / (pi if n else 2 * pi)
        total -= harmonic * (_softness(form.pin, n, 1) + _softness(form.plate, n, -1)) * np.cos(n * angle)
    return form.mean_radius * total


def _softness(body: Material | None, n: int, way: int) -> float:
    """Inward displacement of a disk (way 1), or outward one of a hole (-1), of radius 1 by the pressure cos nθ."""
    if body is None:
        return 0.0
    G, kappa = body.shear_modulus, 3 - 4 * body.effective_poisson_ratio
    if n == 0:
        return (kappa - 1) / (4 * G) if way == 1 else 1 / (2 * G)
    return (kappa / (n + way) + 1 / (n - way)) / (4 * G)


@pytest.mark.slow
@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("load", [0.03, 0.3, 2.0])
def test_where_both_touch_they_move_by_clearance_and_a_rigid_motion(pair: str, load: float):
    """The rest of the series, from 3000 terms on, is below 1e-5 of the clearance. The pressure has the load."""
    form = loose(load, *PAIRS[pair])
    assert form.half_angle is not None
    angle = np.linspace(0, 0.95, 14) * form.half_angle
    moved = displacement(form, angle)
    clearance, _ = np.linalg.lstsq(np.column_stack([angle**0, np.cos(angle)]), moved, rcond=None)[0]
    motion = moved - form.clearance  # is proportional to cos θ
    assert motion / np.cos(angle) == pytest.approx(np.full(14, motion[0]), abs=2e-5 * form.clearance)
    assert clearance == pytest.approx(form.clearance, rel=2e-3)  # both parts are alike over a narrow contact
    theta, length = places(form, 200)
    force = form.pressure(theta) * length * form.mean_radius
    assert force @ np.cos(theta) == pytest.approx(load, rel=1e-12)
    assert force @ abs(np.sin(theta)) / 2 == pytest.approx(form.spread, rel=1e-3)


@pytest.mark.parametrize("pair", PAIRS)
def test_narrow_contact_is_that_of_hertz(pair: str):
    """With ε the difference goes to 0: of second order for equal materials, of first order for others."""
    modulus = 1 / sum(1 / body.contact_modulus for body in PAIRS[pair] if body)
    for load in (1e-5, 1e-7):
        form = loose(load, *PAIRS[pair])
        hertz = HertzContact(load=load, curvature=1 - 1 / 1.001, modulus=modulus)
        assert form.half_angle is not None
        assert form.peak == pytest.approx(hertz.peak, rel=form.half_angle)
        assert form.half_angle * form.mean_radius == pytest.approx(hertz.half_width, rel=form.half_angle)
        assert form.pressure(np.array([-1, 1]) * form.half_angle * 1.01).tolist() == [0, 0]


def test_rigid_bodies_are_the_limit_of_stiff_ones():
    for pair in ((None, material()), (material(), None)):
        rigid = loose(0.3, *pair)
        stiff = loose(0.3, *(body or material(1e12) for body in pair))
        assert (stiff.half_angle, stiff.peak) == pytest.approx((rigid.half_angle, rigid.peak), rel=1e-8)


def test_contact_that_may_extend_all_around():
    """Equal materials touch over less than 85 degrees, whatever the load; an incompressible pin does not stop there."""
    heavy = loose(1e9, material(), material())
    assert heavy.half_angle is not None
    b2 = tan(heavy.half_angle / 2) ** 2
    assert 2 - log(1 + b2) - 2 * b2**2 == pytest.approx(0, abs=1e-8)
    assert degrees(heavy.half_angle) < 85
    soft = loose(1e9, material(1000, 0.49999), None)
    assert soft.half_angle is None
    assert np.isnan(soft.pressure(np.zeros(2))).all()


LOADS = {10: (0.0133653, 0.0065680), 30: (0.138339, 0.0668879), 70: (2.25172, 1.20904)}
"""Half angle in degrees, and loads for it with a plate of equal modulus and of a third of it."""


def solved(spec: str) -> tuple[bemcontact.Result, dict[str, Score]]:
    result = bemcontact.solve(bemcontact.loads(spec))
    assert result.certified
    known = expected(result.problem, result.contact)
    found = score(known, result.contact, result.footprint, result.solution.pressure)
    return result, {item.quantity: item for item in found}


@pytest.mark.slow
@pytest.mark.parametrize("half_angle", LOADS)
@pytest.mark.parametrize("plate", [1000.0, 1000 / 3])
def test_solved_pins_have_the_peak_and_the_angle(half_angle: int, plate: float):
    """Up to error bars and the size of the plate, which is 20 radii: 1.4 / 20², less at smaller angles."""
    load = LOADS[half_angle][plate < 1000]
    result, found = solved(pin_in_hole(load, plate=plate))
    assert found["end of contact"].expected == pytest.approx(half_angle, rel=1e-2)
    assert all(item.judged and item.holds for item in found.values())
    bars = {bar.quantity: bar.bar or 0.0 for bar in result.accuracy.bars}
    size = 1.4 / 20**2
    assert abs(found["peak"].difference) < bars["peak"] + size
    assert abs(found["end of contact"].difference) < bars["length"] + size
    assert found["resultant"].difference == pytest.approx(0, abs=2e-3)


@pytest.mark.slow
def test_a_plate_of_finite_size_is_off_in_the_second_order():
    """Half the size has four times the difference, up to error bars of the mesh and terms of higher order."""
    small, large = (solved(pin_in_hole(LOADS[70][0], size))[1]["peak"].difference for size in (6.0, 12.0))
    assert small / large == pytest.approx(4, rel=0.25)


def only(spec: str, *overrides: str) -> Expected:
    """The reference of a spec with few elements."""
    problem = bemcontact.loads(spec.replace("accuracy: 3e-3", "accuracy: 0.3"), set=overrides)
    [one] = expected(problem, bemcontact.condense(problem))
    return one


def test_values_of_half_a_pin():
    one = only(pin_in_hole(LOADS[30][0]))
    form = loose(LOADS[30][0], material(), material())
    assert one.in_range
    assert one.peak == form.peak
    assert one.end == pytest.approx(30.01, abs=0.01)
    assert (one.start, one.against) == (None, "angle")
    assert one.resultant == pytest.approx(np.hypot(LOADS[30][0] / 2, form.spread))
    assert np.nanmax(one.pressure) == pytest.approx(form.peak, rel=1e-12)
    whole = only(pin_in_hole(LOADS[30][0]), "reference.pin.half=false")
    assert (whole.start, whole.end, whole.resultant) == (-one.end, one.end, LOADS[30][0])


def test_values_on_the_side_of_the_hole():
    """With the sides exchanged it is the same but for the angle, which is that of a wider circle."""
    spec = pin_in_hole(LOADS[30][0])
    one, other = only(spec), only(spec.replace("[pin/rim, plate/hole]", "[plate/hole, pin/rim]"))
    assert other.in_range
    assert other.peak == one.peak
    assert one.end is not None
    assert other.end == pytest.approx(one.end / 1.001, rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "remark"),
    [
        ("20.0", "19.0", "infinite plate; … 19 radii away"),
        ("angles: [-90, 90]}", "angles: [-90, 0]}\n        - {name: diameter, end: [0, -0.001]}", "whole and solid"),
    ],
)
def test_out_of_range_is_shown_and_not_judged(old: str, new: str, remark: str):
    one = only(pin_in_hole(LOADS[30][0]).replace(old, new))
    assert not one.in_range
    assert_states(one.remark, remark)
    assert one.remark.endswith("shown, not judged")


def test_a_wide_clearance_is_out_of_range():
    spec = pin_in_hole(LOADS[30][0]).replace("1.001", "1.04").replace("-0.001", "-0.04")
    one = only(spec.replace("clearance: 0.001", "clearance: 0.04"))
    assert_states(one.remark, "small clearance; … 0.04 radii: shown, not judged")


@pytest.mark.slow
def test_a_pin_in_the_middle_of_its_hole_needs_the_middle_of_contact():
    """All gaps are equal then, which is another rigid motion of the pin only."""
    spec = pin_in_hole(LOADS[30][0]).replace("center: [0, -0.001]", "center: [0, 0]")
    one = only(spec)
    assert (one.in_range, one.peak) == (False, None)
    assert_states(one.remark, "all gaps are equal; … center")
    assert only(spec, "reference.pin.center=[0, -1]").end == pytest.approx(30.01, abs=0.01)


def test_a_clearance_may_be_a_gap_that_is_stated():
    spec = pin_in_hole(LOADS[30][0]).replace("1.001", "1.0").replace("-0.001", "0")
    spec = spec.replace("plate/hole]}", "plate/hole], gap: 0.001}")
    assert only(spec, "reference.pin.center=[0, -1]").end == pytest.approx(30.01, abs=0.03)


def test_contact_all_around_has_no_values():
    spec = pin_in_hole(1e5).replace("poisson_ratio: 0.3", "poisson_ratio: 0.4999", 1).replace("1000.0", "1e12")
    one = only(spec)
    assert (one.in_range, one.peak) == (False, None)
    assert_states(one.remark, "wider than 150 degrees")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("radius: 1, clearance", "radius: 2, clearance", "no contact of a pin of radius 2"),
        ("clearance: 0.001", "clearance: 0.002", "wider by 0.002; … a pin of radius 1, and a hole of radius 1.001"),
        ("plate/hole]", "plate/hole], gap: 0.1", "a hole of radius 1.001, with the gap 0.1"),
    ],
)
def test_another_pin_is_refused_at_its_radius(old: str, new: str, words: str):
    spec = pin_in_hole(0.1).replace(old, new)
    line = next(i for i, text in enumerate(spec.splitlines(), 1) if "kind: pin_in_hole" in text)
    column = spec.splitlines()[line - 1].index("radius: ") + len("radius: ") + 1
    assert_one_mistake(spec, f"{line}:{column}: reference.pin.radius", words)


RIGID = """
name: rigid pin
material: {young_modulus: 1000, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: bottom, start: [-20, -20], end: [20, -20], elements: 4}
    - {name: right, end: [20, 20], elements: 4}
    - {name: top, end: [-20, 20], elements: 4}
    - {name: left, elements: 4}
  holes: [[{name: hole, kind: arc, center: [0, 0], radius: 1.001, angles: [-90, -450], elements: 16}]]
conditions: {left: {displacement: {x: 0, y: 0}}, right: {displacement: {x: 0, y: 0}}}
contact_zones:
  bearing: {edges: hole, surface: {kind: circle, center: [0, -0.001], radius: 1, body: outside}}
tools: {pin: {zones: bearing, force: {y: -0.1}}}
reference:
  pin: {kind: pin_in_hole, load: 0.1, radius: 1, clearance: 0.001}
"""


def test_a_rigid_pin():
    form = loose(0.1, None, material())
    one = only(RIGID)
    assert one.in_range
    assert one.peak == form.peak
    assert one.start == pytest.approx(-degrees(form.half_angle or 0) / sqrt(1.001))
    mistake = "16:47: reference.pin.radius", "a hole of radius 1.001, and a pin of radius 0.9; correct"
    assert_one_mistake(RIGID.replace("radius: 1, body", "radius: 0.9, body"), *mistake)


def test_radians_are_degrees_of_the_file():
    """The half angle in the docstring of `known_answers.pin_in_hole`."""
    assert loose(0.138339, material(), material()).half_angle == pytest.approx(radians(30), rel=1e-4)
