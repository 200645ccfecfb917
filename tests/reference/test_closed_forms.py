"""Each closed form against the equation that it solves, evaluated in another way."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from bemcontact.problems import Material
from bemcontact.reference.closed_forms import (
    BeamOverProp,
    ClosedCrack,
    HertzContact,
    PunchOnHalfPlane,
    ShrunkRing,
)

STATES = ("plane_strain", "plane_stress")


def material(state: str = "plane_strain") -> Material:
    return Material(young_modulus=1000, poisson_ratio=0.3, state=state)


def slope(pressure, half_width: float, x: float, modulus: float) -> float:
    """du/dx of a half-plane, (2 / πE*) ⨍ p(s) / (x - s) ds ([Joh85] 2.25), with s = b cos θ and p(x) taken out.

    For |x| < b, ⨍ dθ / (x - b cos θ) = 0, so that the singular part of p sin θ at x drops out.
    """

    def smooth(theta: float) -> float:
        s = half_width * np.cos(theta)
        return float(pressure(np.array([s]))[0]) * half_width * np.sin(theta)

    own = np.arccos(x / half_width)

    def integrand(theta: float) -> float:
        s = half_width * np.cos(theta)
        return (smooth(theta) - smooth(own)) / (x - s)

    value, _ = quad(integrand, 1e-9, pi - 1e-9, points=[own], epsabs=1e-10, epsrel=1e-10)
    return 2 / (pi * modulus) * value


def test_contact_modulus_is_that_of_the_plane_state():
    assert material().contact_modulus == pytest.approx(1000 / (1 - 0.09), rel=1e-14)
    assert material("plane_stress").contact_modulus == pytest.approx(1000, rel=1e-14)


def test_hertz_has_the_numbers_of_the_cylinder():
    """Half-width 2.7401 and peak 188.19, as examples of the formula for the cylinder of [SS92]."""
    form = HertzContact(load=810, curvature=1 / 8, modulus=material().contact_modulus)
    assert form.half_width == pytest.approx(2.7401, abs=5e-5)
    assert form.peak == pytest.approx(188.19, abs=5e-3)


def test_hertz_carries_its_load_and_bends_to_the_curvature():
    form = HertzContact(load=7.0, curvature=1 / 3 - 1 / 11, modulus=900.0)
    carried, _ = quad(lambda x: form.pressure(np.array([x]))[0], -form.half_width, form.half_width)
    assert carried == pytest.approx(7.0, rel=1e-8)
    for x in (-0.7, 0.1, 0.5):
        x *= form.half_width
        assert slope(form.pressure, form.half_width, x, 900.0) == pytest.approx(form.curvature * x, rel=1e-6)
    assert form.pressure(np.array([form.half_width, 2 * form.half_width, np.inf])) == pytest.approx(0.0, abs=1e-7)


ECCENTRICITIES = [0.0, 0.4, -1.0, 1.2, -1.7]
"""Of a punch of half-width 2, whose edge lifts off beyond 1."""


def seen_from_the_middle(form: PunchOnHalfPlane):
    return lambda y: form.pressure(y + form.middle)


@pytest.mark.parametrize("eccentricity", ECCENTRICITIES)
def test_punch_carries_load_and_moment_and_leaves_a_straight_face(eccentricity: float):
    """With x = a cos θ both integrals are smooth; a face that turns as a whole has the same slope everywhere."""
    form = PunchOnHalfPlane(load=7.0, half_width=2.0, eccentricity=eccentricity)
    theta, h = (np.arange(64) + 0.5) * pi / 64, form.touching_half_width
    x = form.middle + h * np.cos(theta)
    carried = form.pressure(x) * h * np.sin(theta) * pi / 64
    assert carried.sum() == pytest.approx(7.0, rel=1e-13)
    assert carried @ x == pytest.approx(7.0 * eccentricity, rel=1e-12, abs=1e-12)
    assert form.pressure(x).min() >= 0
    slopes = [slope(seen_from_the_middle(form), h, y * h, 900.0) for y in (-0.65, 0.1, 0.55)]
    assert np.abs(slopes) == pytest.approx(abs(form.tilt(900.0)), abs=1e-8)
    assert np.sign(form.tilt(900.0)) == np.sign(eccentricity)


@pytest.mark.parametrize("eccentricity", [1.2, 1.5, 1.99, -1.3])
def test_open_part_is_clear_of_the_half_plane(eccentricity: float):
    """Outside, the slope of the surface is an ordinary integral; what the tilted face rises above it grows outwards."""
    form = PunchOnHalfPlane(load=7.0, half_width=2.0, eccentricity=eccentricity)
    side, h = np.sign(eccentricity), form.touching_half_width
    assert (form.middle - side * h) * side == pytest.approx(4 * abs(eccentricity) - 3 * 2.0)
    assert (form.middle + side * h) * side == pytest.approx(2.0)
    touches = seen_from_the_middle(form)

    def surface_slope(y: float) -> float:
        """Along the direction of the load, y from the middle of what touches."""
        found, _ = quad(
            lambda t: touches(side * np.array([h * np.cos(t)]))[0] * h * np.sin(t) / (y - h * np.cos(t)), 0, pi
        )
        return 2 / (pi * 900.0) * found

    face = -abs(form.tilt(900.0))
    for y in (1.05, 1.5, 3.0):
        assert surface_slope(-y * h) > face
    assert surface_slope(-1.0001 * h) == pytest.approx(face, rel=0.03)
    assert form.pressure(np.array([form.middle - side * 1.01 * h])) == [0.0]
    assert form.pressure(np.array([form.middle - side * h])) == pytest.approx([0.0], abs=1e-12)


def test_punch_about_to_lift_off_is_one_form_from_both_sides():
    """At e = a/2 the pressure of the far edge is 0, tilt and pressure go on continuously."""
    before, after = (
        PunchOnHalfPlane(load=7.0, half_width=2.0, eccentricity=e) for e in (1.0 * (1 - 1e-9), 1.0 * (1 + 1e-9))
    )
    x = np.linspace(-1.9, 1.9, 20)
    assert before.pressure(x) == pytest.approx(after.pressure(x), rel=1e-7)
    assert before.tilt(900.0) == pytest.approx(after.tilt(900.0), rel=1e-8)
    assert (before.lifts_off, after.lifts_off) == (False, True)
    assert PunchOnHalfPlane(load=7.0, half_width=2.0, eccentricity=1.0).tilt(900.0) == pytest.approx(
        2 * 7.0 / (pi * 900.0 * 2.0)
    )


def test_punch_states_nothing_at_its_edges_and_zero_beyond():
    pressure = PunchOnHalfPlane(load=7.0, half_width=2.0).pressure(np.array([-2.0, 0.0, 2.0, 2.1]))
    assert np.isnan(pressure).tolist() == [True, False, True, False]
    assert pressure[[1, 3]] == pytest.approx([7.0 / (2 * pi), 0.0])


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize(("rigid", "inner", "outer"), [("pin", 1.0, 1.7), ("bore", 1.0, 1.7), ("bore", 0.0, 1.7)])
def test_lame_solves_the_equation_of_a_ring(state: str, rigid: str, inner: float, outer: float):
    """Solve u'' + u'/r - u/r² = 0 from the free face (a disc: u = r near its center), scaled to u = δ at the other."""
    E, nu = 1000.0, 0.3
    if state == "plane_strain":
        E, nu = E / (1 - nu**2), nu / (1 - nu)

    def sigma_r(r: float, u: float, du: float) -> float:
        return E / (1 - nu**2) * (du + nu * u / r)

    begin, finish = (outer, inner) if rigid == "pin" else (inner or 1e-3, outer)
    start = (1.0, -nu / begin) if inner else (begin, 1.0)
    found = solve_ivp(
        lambda r, y: (y[1], y[0] / r**2 - y[1] / r), (begin, finish), start, rtol=1e-12, atol=1e-14, method="DOP853"
    )
    u, du = found.y[:, -1]
    inwards = 0.01 if rigid == "pin" else -0.01
    pressure = -sigma_r(finish, u, du) * inwards / u
    form = ShrunkRing(inner_radius=inner, outer_radius=outer, interference=0.01)
    told = (form.pressure_on_pin if rigid == "pin" else form.pressure_in_bore)(material(state))
    assert told == pytest.approx(pressure, rel=1e-8)


def test_crack_has_the_pressure_of_the_paper():
    """[q (2a + c) - c E'] / 2a for the opening of [SS92]: 23.805."""
    form = ClosedCrack(half_length=3, half_height=0.3, compression=75, modulus=material().contact_modulus)
    assert form.pressure_along_plane == pytest.approx(23.805, abs=5e-4)


@pytest.mark.parametrize("slit", [False, True])
def test_crack_carries_its_pressure_per_length_of_the_plane(slit: bool):
    """∫ p ds = t a over a quarter of the ellipse, x = a sin φ: ds/dφ = sqrt(a² cos² φ + c² sin² φ)."""
    a, c = 3.0, 0.3
    form = ClosedCrack(half_length=a, half_height=c, compression=75, modulus=1000 / 0.91, slit=slit)

    def carried(angle: float) -> float:
        speed = np.hypot(a * np.cos(angle), 0.0 if slit else c * np.sin(angle))
        return float(form.pressure(np.array([a * np.sin(angle)]))[0]) * speed

    assert quad(carried, 0, pi / 2 - 1e-5)[0] == pytest.approx(form.pressure_along_plane * a, rel=1e-8)
    assert np.isnan(form.pressure(np.array([a, 1.1 * a]))).all()


def test_flat_opening_is_a_slit():
    """With c << a both forms close alike, the modulus being so large that the clearance counts."""
    ellipse, slit = (
        ClosedCrack(half_length=3, half_height=3e-6, compression=75, modulus=1e8, slit=slit) for slit in (False, True)
    )
    assert ellipse.pressure_along_plane == pytest.approx(slit.pressure_along_plane, rel=2e-6)
    assert 0 < slit.pressure_along_plane < 75


def beam(gap: float, *, height: float = 2.0, shear_modulus: float = 400.0) -> BeamOverProp:
    return BeamOverProp(load=0.3, span=30.0, height=height, gap=gap, modulus=1000.0, shear_modulus=shear_modulus)


@pytest.mark.parametrize("part", [0.0, 0.3, 0.999, 1.0, 1.7])
def test_beam_bends_down_to_its_prop(part: float):
    """From the end force alone: slope φ = ∫ M/EI up to the middle, where it is 0, and w = ∫ φ + V/κGh. w is the gap."""
    sag = beam(0.0).sag
    form = beam(part * sag)
    assert 2 * form.end + form.prop == pytest.approx(0.3 * 30, rel=1e-14)
    assert (form.prop > 0) == (part < 1)

    def shear(x: float) -> float:
        return (form.end - 0.3 * x) / (5 / 6 * 400 * 2)

    def slope(x: float) -> float:
        return quad(lambda s: (form.end * s - 0.3 * s**2 / 2) / (1000 * 2**3 / 12), x, 15)[0]

    sunk = quad(lambda x: slope(x) + shear(x), 0, 15)[0]
    assert sunk == pytest.approx(min(part, 1.0) * sag, rel=1e-10, abs=1e-10 * sag)


def test_stiff_prop_of_a_thin_beam_takes_five_eighths():
    """The textbook's 1.25 q L of two spans L, and 3/8 q L at the ends, where shear does not count."""
    form = beam(0.0, height=0.01)
    assert form.prop == pytest.approx(5 / 8 * 0.3 * 30, rel=1e-5)
    assert form.end == pytest.approx(3 / 16 * 0.3 * 30, rel=1e-5)


def test_prop_of_a_beam_that_only_shears_takes_half():
    """Without bending each span hangs between its ends like a string: half of its load to either."""
    assert beam(0.0, shear_modulus=1e-6).prop == pytest.approx(0.3 * 30 / 2, rel=1e-6)
