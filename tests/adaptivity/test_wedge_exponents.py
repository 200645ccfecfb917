"""Exponents at corners against the characteristic equations of Williams, and in limits."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq, root

from bemcontact.adaptivity.wedge_exponents import (
    BONDED,
    FREE,
    Face,
    Wedge,
    Wedges,
    beside_bond,
    contact_face,
    slow_change,
    stress_is_infinite,
    wedge_exponents,
)

FIXED = Face(1.0, (True, True))
ANGLES, RATIOS = st.floats(0.2, 2 * pi - 0.05), st.floats(-0.9, 0.49)
NEAR = 1e-9
"""Accuracy of a simple root: what is left of the smallest singular value over its slope."""


def single(start, angle, faces, ratio):
    """One wedge."""
    return Wedges((Wedge(start, angle, faces, ratio),))


def faces(start, angle):
    """Both faces in contact; the normals point out of the body."""
    return contact_face(np.exp(1j * (start - pi / 2))), contact_face(np.exp(1j * (start + angle + pi / 2)))


@settings(max_examples=25, deadline=None)
@given(ANGLES, st.floats(-pi, pi), RATIOS)
def test_contact_beside_a_free_face_mirrors_the_wedge(angle, start, ratio):
    """Of the wedge 2 ω the symmetric states: sin 2λω + λ sin 2ω = 0 (Williams 1952), for any ν and any direction."""
    first, last = faces(start, angle)
    found = wedge_exponents(single(start, angle, (first, FREE), ratio))
    assert found == pytest.approx(wedge_exponents(single(start, angle, (FREE, last), ratio)), abs=NEAR)

    def equation(power):
        return np.sin(2 * power * angle) + power * np.sin(2 * angle)

    powers = np.linspace(0.02, 0.98, 4000)
    signs = np.sign(equation(powers))
    assert len(found) >= np.count_nonzero(signs[1:] != signs[:-1])
    for exponent in found:
        assert abs(equation(1 - exponent)) < NEAR * 2 * angle


@settings(max_examples=15, deadline=None)
@given(st.floats(pi / 2 + 0.05, 2 * pi - 0.05), RATIOS)
def test_contact_on_both_faces(angle, ratio):
    """Sin (λ ± 1) ω = 0: λ = |1 - π m / ω|, of which all below one are states with pressure."""
    expected = {abs(1 - m * pi / angle) for m in range(1, 5)}
    found = wedge_exponents(single(0.0, angle, faces(0.0, angle), ratio))
    expected = sorted(power for power in expected if 0.02 < power < 0.98)
    distinct = [power for i, power in enumerate(expected) if i == 0 or power - expected[i - 1] > 0.03]
    for power in distinct:
        assert min(abs(1 - exponent - power) for exponent in found) < 0.03
    for exponent in found:
        assert abs(np.sin((2 - exponent) * angle) * np.sin(exponent * angle)) < 1e-7


@settings(max_examples=10, deadline=None)
@given(ANGLES, st.floats(0.0, 0.45))
def test_contact_beside_a_fixed_face_mirrors_the_wedge(angle, ratio):
    """κ sin 2λω = λ sin 2ω with κ = 3 - 4 ν: the symmetric states of a wedge 2 ω with both faces fixed."""
    first, _ = faces(0.0, angle)
    for exponent in wedge_exponents(single(0.0, angle, (first, FIXED), ratio)):
        power = 1 - exponent
        left = (3 - 4 * ratio) * np.sin(2 * power * angle)
        assert min(abs(left - power * np.sin(2 * angle)), abs(left + power * np.sin(2 * angle))) < 1e-7


def test_limits():
    """A half-plane has 1/2, a quarter none, a crack face 3/4, and nothing without contact."""
    half, quarter, full = ((faces(0.0, angle)[0], FREE) for angle in (pi, pi / 2, 2 * pi))
    assert wedge_exponents(single(0.0, pi, half, 0.3)) == pytest.approx((1 / 2,), abs=NEAR)
    assert wedge_exponents(single(0.0, pi / 2, quarter, 0.3)) == ()
    assert wedge_exponents(single(0.0, 2 * pi, full, 0.3))[0] == pytest.approx(3 / 4, abs=NEAR)
    assert wedge_exponents(single(0.0, 3 * pi / 2, (faces(0.0, 3 * pi / 2)[0], FREE), 0.3))[0] == pytest.approx(
        2 / 3, abs=NEAR
    )
    assert wedge_exponents(single(0.0, pi, (FREE, FREE), 0.3)) == ()


@settings(max_examples=15, deadline=None)
@given(st.floats(-pi, pi), RATIOS, st.floats(-2, 2), st.floats(-2, 2))
def test_shear_beside_contact_at_a_right_angle_raises_the_pressure_like_a_logarithm(start, ratio, shear, normal):
    """In its mirror the contact is the axis below a half-plane with shear ±τ to both sides, a step of 2τ.

    A tangential force Q has σ_xx = -2Q x³/(π r⁴) (Flamant), whose integral over the step is (4τ/π) ln y.
    """
    first, _ = faces(start, pi / 2)
    along = np.exp(1j * (start + pi / 2))  # of the free face, from the tip
    _, slopes, rate = slow_change(
        single(start, pi / 2, (first, FREE), ratio), (0j, complex((shear + 1j * normal) * along))
    )
    assert rate == pytest.approx(0, abs=1e-9)
    assert slopes == pytest.approx((4 * shear / pi, 0.0), abs=1e-7)


def test_nothing_changes_slowly_at_other_angles():
    for angle in (pi / 3, 2 * pi / 3, pi):
        assert slow_change(single(0.0, angle, (faces(0.0, angle)[0], FREE), 0.3), (0j, 1 + 1j)) is None


@settings(max_examples=15, deadline=None)
@given(st.floats(-5, 5).filter(lambda degrees: abs(degrees) > 0.01), RATIOS, st.floats(-2, 2))
def test_near_a_right_angle_the_pressure_is_a_constant_and_a_slow_power(degrees, ratio, shear):
    """The power is that of Williams; the constant of no load is zero, and without the power nothing changes."""
    angle = pi / 2 + np.radians(degrees)
    wedge = single(0.0, angle, (faces(0.0, angle)[0], FREE), ratio)
    change = slow_change(wedge, (0j, complex(shear * np.exp(1j * angle))))
    power = 1 + change.rate
    assert np.sin(2 * power * angle) + power * np.sin(2 * angle) == pytest.approx(0, abs=1e-8)
    assert change.at(0, change.constants[0], 1e-4) == pytest.approx(change.constants[0])
    assert slow_change(wedge, (0j, 0j)).at(0, 10.0, 1e-4) == pytest.approx(10.0 * 1e-4**change.rate, rel=1e-9)
    # close to the right angle, the change over a distance is that of the logarithm
    if abs(degrees) < 0.1 and abs(shear) > 0.1:
        slope = slow_change(
            single(0.0, pi / 2, (faces(0.0, pi / 2)[0], FREE), ratio), (0j, complex(shear * 1j))
        ).slopes[0]
        assert change.at(0, 0.0, 0.5) == pytest.approx(slope * np.log(0.5), rel=0.01)


def settlement(power, angle, ratio, shear_modulus):
    """u_θ of a face of a wedge, over r^λ, where the pressure is r^(λ-1) on it: Airy's functions r^(λ+1) F(θ)."""
    above, below = power + 1, power - 1
    values = np.array([
        [np.cos(above * at), np.sin(above * at), np.cos(below * at), np.sin(below * at)] for at in (0, angle)
    ])  # fmt: skip
    slopes = np.array([
        [sign * power * part(power * at) for power in (above, below) for sign, part in ((-1, np.sin), (1, np.cos))]
        for at in (0, angle)
    ])  # fmt: skip
    a = np.linalg.solve(np.vstack([values, slopes]), [-1 / (power * above), 0, 0, 0])
    return (-above * a[1] - (power + 3 - 4 * ratio) * a[3]) / (2 * shear_modulus)


@pytest.mark.parametrize("degrees", [89.5, 90.0, 90.2])
@pytest.mark.parametrize("stiffness", [30.0, 70.0, 1000.0])
def test_a_corner_on_an_elastic_plane_has_a_slow_power_however_close_to_one(degrees, stiffness):
    """Beside it λ = 1 is a root too, as both bodies may turn together; between rigid and elastic they come together."""
    angle, ratio = np.radians(degrees), 0.3
    powers = 1 - np.geomspace(1e-5, 0.2, 500)
    both = np.array([settlement(at, angle, ratio, 1.0) + settlement(at, pi, ratio, stiffness) for at in powers])
    turns = np.flatnonzero((both[1:] * both[:-1] < 0) & (abs(both[1:] - both[:-1]) < np.median(abs(both))))
    above = Wedge(0.0, angle, (contact_face(-1j), FREE), ratio)
    below = Wedge(-pi, pi, (FREE, contact_face(1j)), ratio, stiffness)
    change = slow_change(Wedges((below, above), own=1), (0j, 0j, 0j, 0j))
    if not len(turns):  # the pressure falls towards the corner
        assert change is None or change.rate > 0
        return
    (turn,) = turns.tolist()
    power = brentq(
        lambda at: settlement(at, angle, ratio, 1.0) + settlement(at, pi, ratio, stiffness),
        powers[turn], powers[turn + 1], xtol=1e-13,
    )  # fmt: skip
    assert change is not None
    assert change.rate == pytest.approx(power - 1, rel=1e-6)
    assert change.at(0, 1.0, 1e-3) == pytest.approx(1e-3 ** (power - 1), rel=1e-6)


def tip_of_bond(turn, ratios, stiffness, after):
    """Wedges at the tip of a closed debond on a line at an angle, with the bond after it on the first one or before."""
    normal = np.exp(1j * (turn - pi / 2))
    first, second = contact_face(normal), contact_face(-normal)
    own, across = ((BONDED, first), (second, BONDED)) if after else ((first, BONDED), (BONDED, second))
    wedges = Wedge(turn, pi, own, ratios[0]), Wedge(turn - pi, pi, across, ratios[1], stiffness)
    return Wedges(wedges, closed=True)


@settings(max_examples=25, deadline=None)
@given(st.floats(-pi, pi), st.tuples(st.floats(0.0, 0.49), st.floats(0.0, 0.49)), st.floats(0.01, 100.0), st.booleans())
def test_pressure_beside_a_bond_is_a_part_of_the_shear_on_it(turn, ratios, stiffness, after):
    """λ = 1/2, with |β| for the intensity of the pressure over that of the shear (Comninou 1977).

    A density b of slip on a common line has the stresses τ = (C/π) ∫ b(ξ)/(x - ξ) dξ and σ_y = β C b(x) there. On the
    closed debond τ = 0, and b = K/(C sqrt(s)) for K/sqrt(s) of shear before it.
    """
    kappa = 3 - 4 * np.array(ratios)
    beta = ((kappa[1] - 1) - stiffness * (kappa[0] - 1)) / ((kappa[1] + 1) + stiffness * (kappa[0] + 1))
    if abs(beta) < 1e-3:
        return
    tip = tip_of_bond(turn, ratios, stiffness, after)
    assert wedge_exponents(tip) == pytest.approx((0.5,), abs=NEAR)
    state = beside_bond(tip)
    assert state is not None
    assert abs(state.pressure) / abs(state.traction) == pytest.approx(abs(beta), rel=1e-6)
    assert abs((state.traction * np.exp(-1j * turn)).imag) < 1e-6 * abs(state.traction)  # shear alone
    assert state.intensity(state.traction / 2, 4.0) == pytest.approx(state.pressure)


@pytest.mark.parametrize("after", [False, True])
def test_pressure_beside_a_bond_of_equal_materials_is_finite(after):
    """The shear of mode II has no pressure on the line of the crack."""
    assert wedge_exponents(tip_of_bond(0.3, (0.3, 0.3), 1.0, after)) == ()
    assert beside_bond(tip_of_bond(0.3, (0.3, 0.3), 1.0, after)) is None


def test_equal_wedges_that_are_bonded_are_one():
    """Beside contact with a rigid plane on one face: the wedge of both angles, with a free face."""
    for one, other in ((1.0, 1.3), (pi / 2, pi / 2), (0.4, 2.4)):
        level = contact_face(-1j)
        wedges = Wedge(0.0, one, (level, BONDED), 0.3), Wedge(one, other, (BONDED, FREE), 0.3)
        found = wedge_exponents(Wedges(wedges))
        assert found == pytest.approx(wedge_exponents(single(0.0, one + other, (level, FREE), 0.3)), abs=1e-7)


ROLLERS = Face(1.0, (False, True)), Face(1.0, (True, False))

LEVEL = contact_face(1j)


@pytest.mark.parametrize(
    ("angle", "faces", "infinite"),
    [
        (np.pi / 2, (FREE, FREE), False),
        (np.pi, (FREE, FREE), False),
        (3 * np.pi / 2, (FREE, FREE), True),
        (2 * np.pi, (FREE, FREE), True),
        (np.pi, (LEVEL, FREE), True),
        (np.pi / 2, (LEVEL, FREE), False),
        (np.pi / 2, ROLLERS, False),
        (np.pi / 4, (FIXED, FREE), False),
        (np.pi / 2, (FIXED, FREE), True),
        (np.pi, (FREE, FIXED), True),
        (np.pi / 2, (FIXED, FIXED), False),
        (3 * np.pi / 2, (FIXED, FIXED), True),
    ],
)
def test_infinite_stress(angle: float, faces: tuple[Face, Face], infinite: bool):
    """Corners of Williams (1952): reentrant ones, ends of contact and of clamps; lines of symmetry are no corners."""
    assert stress_is_infinite(single(0.0, angle, faces, 0.3)) is infinite


@pytest.mark.parametrize(("degrees", "poisson_ratio"), [(90, 0.0), (60, 0.25), (120, 0.25)])
def test_round_off_of_an_angle_makes_no_stress_infinite(degrees: float, poisson_ratio: float):
    """At a clamp λ = 1 where sin²ω = 1 - ν: on either side of 90 and 60 degrees stress is finite. At 120 it is not."""
    for change in (-1e-12, -1e-15, 0, 1e-15, 1e-12):
        assert stress_is_infinite(single(0.7, np.radians(degrees) + change, (FIXED, FREE), poisson_ratio)) is (
            degrees == 120
        )


@pytest.mark.parametrize("poisson_ratio", [0.3, 0.45])
def test_least_angle_of_an_infinite_stress_at_a_clamp(poisson_ratio: float):
    """Williams' equation sin²(λω) = (κ+1)²/4κ - λ² sin²ω/κ has λ = 1 at the angle from which stress is infinite."""
    kappa = 3 - 4 * poisson_ratio
    least = brentq(lambda w: np.sin(w) ** 2 * (1 + 1 / kappa) - (kappa + 1) ** 2 / 4 / kappa, 0, np.pi / 2)
    for change, infinite in ((-1e-3, False), (1e-3, True)):
        assert stress_is_infinite(single(0.0, least + change, (FIXED, FREE), poisson_ratio)) is infinite


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.1, 0.45])
@pytest.mark.parametrize("degrees", [55, 65, 80, 95, 98, 105, 130, 300])
def test_stress_at_a_clamp_is_infinite_where_the_equation_of_williams_has_a_complex_root(degrees, poisson_ratio):
    """The same equation: with ν = 0 no λ is below one up to 100 degrees, and from 97 on the least one is complex."""
    kappa, angle = 3 - 4 * poisson_ratio, np.radians(degrees)

    def both(power):
        at = power[0] + 1j * power[1]
        value = np.sin(at * angle) ** 2 - (kappa + 1) ** 2 / 4 / kappa + at**2 * np.sin(angle) ** 2 / kappa
        return value.real, value.imag

    starts = [(a, b) for a in np.linspace(0.1, 1.3, 13) for b in (0.0, 0.1, 0.3, 0.6)]
    roots = [root(both, start, tol=1e-12) for start in starts]
    least = min(found.x[0] for found in roots if found.success and found.x[0] > 1e-3)
    assert abs(least - 1) > 1e-3
    assert stress_is_infinite(single(0.0, angle, (FIXED, FREE), poisson_ratio)) is bool(least < 1)


@settings(max_examples=25, deadline=None)
@given(st.floats(-pi, pi), st.tuples(st.floats(0.0, 0.49), st.floats(0.0, 0.49)), st.floats(0.02, 50.0))
def test_stress_at_the_free_edge_of_a_bond(turn, ratios, stiffness):
    """Two quarter planes on each other: α (α - 2 β) > 0 with Dundurs' parameters (Bogy 1971)."""
    kappa = 3 - 4 * np.array(ratios)
    total = (kappa[1] + 1) + stiffness * (kappa[0] + 1)
    alpha = ((kappa[1] + 1) - stiffness * (kappa[0] + 1)) / total
    beta = ((kappa[1] - 1) - stiffness * (kappa[0] - 1)) / total
    if abs(alpha * (alpha - 2 * beta)) < 0.01:
        return
    wedges = (
        Wedge(turn, pi / 2, (FREE, BONDED), ratios[0]),
        Wedge(turn + pi / 2, pi / 2, (BONDED, FREE), ratios[1], stiffness),
    )
    assert stress_is_infinite(Wedges(wedges)) is bool(alpha * (alpha - 2 * beta) > 0)


@settings(max_examples=15, deadline=None)
@given(st.floats(-pi, pi), st.tuples(st.floats(0.0, 0.49), st.floats(0.0, 0.49)), st.floats(0.02, 50.0))
def test_stress_on_a_straight_bond_is_finite_and_at_the_tip_of_an_open_crack_on_it_infinite(turn, ratios, stiffness):
    """Two half-planes: there is nothing at a point of a bond, and λ = 1/2 ± iε at the tip (Williams 1959)."""
    closed = Wedge(turn, pi, (BONDED, BONDED), ratios[0]), Wedge(turn + pi, pi, (BONDED, BONDED), ratios[1], stiffness)
    assert not stress_is_infinite(Wedges(closed, closed=True))
    cracked = Wedge(turn, pi, (FREE, BONDED), ratios[0]), Wedge(turn + pi, pi, (BONDED, FREE), ratios[1], stiffness)
    assert stress_is_infinite(Wedges(cracked))


@settings(max_examples=25, deadline=None)
@given(
    st.floats(-pi, pi), st.tuples(st.floats(-0.5, 0.49), st.floats(-0.5, 0.49)), st.floats(-5, 5),
    st.sampled_from([0.0, 1e-9, -1e-9, 1e-6, -1e-6]),
)  # fmt: skip
def test_where_uniform_stress_is_a_state_none_is_infinite(turn, ratios, decades, off):
    """In any direction, with round-off of angles: flat surfaces and contacts, right angles flush or in corners."""
    stiffness, (below, above) = 10.0**decades, (contact_face(np.exp(1j * (turn + way * pi / 2))) for way in (-1, 1))
    wall = contact_face(np.exp(1j * turn))
    flat = Wedge(turn, pi, (below, below), ratios[0]), Wedge(turn + pi, pi, (above, above), ratios[1], stiffness)
    flush = (
        Wedge(turn - pi / 2, pi / 2 + off, (FREE, above), ratios[0]),
        Wedge(turn, pi / 2 - off, (below, FREE), ratios[1], stiffness),
    )
    beside_axis = (
        Wedge(turn - pi / 2, pi / 2, (wall, BONDED), ratios[0]),
        Wedge(turn, pi / 2, (BONDED, wall), ratios[1], stiffness),
    )
    for wedges in (
        single(turn, pi + off, (FREE, FREE), ratios[0]),
        single(turn, pi / 2 + off, (below, FREE), ratios[0]),
        single(turn, pi / 2 + off, (below, wall), ratios[0]),
        Wedges(flat, closed=True),
        Wedges(flush),
        Wedges(beside_axis),
    ):
        assert not stress_is_infinite(wedges)


def test_stress_at_a_corner_of_an_inclusion():
    """None of equal materials, cut as one likes; a rigid one in the limit is that of a wedge with clamped faces."""
    cuts = [Wedge(at, angle, (BONDED, BONDED), 0.3) for at, angle in ((0.0, 1.0), (1.0, 2.0), (3.0, 2 * pi - 3))]
    assert not stress_is_infinite(Wedges(tuple(cuts), closed=True))
    for angle in (pi / 2, 2.0):
        outside = Wedge(0.0, 2 * pi - angle, (BONDED, BONDED), 0.3)
        inside = Wedge(2 * pi - angle, angle, (BONDED, BONDED), 0.3, 1e6)
        assert stress_is_infinite(Wedges((outside, inside), closed=True))


@settings(max_examples=10, deadline=None)
@given(st.floats(0.3, 1.2), st.floats(0.3, 1.2), st.floats(0.3, 1.2), st.floats(0.1, 10.0))
def test_a_cut_through_one_of_two_wedges_changes_no_exponent(one, two, three, stiffness):
    """On a rigid plane, with equal materials beside the cut: three wedges are two."""
    first = Wedge(0.0, one, (contact_face(-1j), BONDED), 0.3)
    second = Wedge(one, two, (BONDED, BONDED), 0.2, stiffness)
    third = Wedge(one + two, three, (BONDED, FREE), 0.2, stiffness)
    whole = Wedge(one, two + three, (BONDED, FREE), 0.2, stiffness)
    assert wedge_exponents(Wedges((first, second, third))) == pytest.approx(
        wedge_exponents(Wedges((first, whole))), abs=1e-7
    )
    assert stress_is_infinite(Wedges((first, second, third))) is stress_is_infinite(Wedges((first, whole)))
