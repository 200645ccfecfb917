"""Where stress is infinite at bonds: at free edges of unlike bodies, at tips of debonds, at corners of inclusions."""

import numpy as np
import pytest
from several_bodies import block, elastic, polygon, stated

import bemcontact

ROLLERS = {"bottom": {"displacement": {"y": 0}}, "left": {"displacement": {"x": 0}}}
SIDE = {"left": {"displacement": {"x": 0}}}


def infinite_places(bodies, bonded, pressed, top):
    """Places where stress is infinite, without repetition; a rigid circle presses into an edge at the height `top`."""
    surface = {"kind": "circle", "center": [0.7, top + 1 - 1e-4], "radius": 1, "body": "outside"}
    zones = {"foot": {"edges": [pressed], "surface": surface}}
    result = bemcontact.solve(stated(name="bonded", bodies=bodies, bonded=bonded, contact_zones=zones), accuracy=0.1)
    return {tuple(place) for edge in result.boundary_stress().values() for place in edge.singular.round(9).tolist()}


def layers(moduli, heats=(0.0, 0.0)):
    """The places for two layers on each other, held by rollers at the bottom and on the left."""
    outlines, holds = [block((0, 4), (y, y + 1)) for y in (0, 1)], (ROLLERS, SIDE)
    bodies = {name: elastic(*each) for name, *each in zip("ab", outlines, holds, moduli, strict=True)}
    for body, heat in zip(bodies.values(), heats, strict=True):
        body["loads"] = {"temperature": {"expansion": 1e-6, "change": heat}}
    return infinite_places(bodies, {"glue": ["a/top", "b/bottom"]}, "b/top", 2)


@pytest.mark.parametrize(("moduli", "infinite"), [((200, 20), True), ((20, 200), True), ((100, 100), False)])
def test_stress_at_the_free_edge_of_a_bond(moduli, infinite):
    """As Bogy's criterion says, for α (α - 2 β) > 0. On the line of symmetry the bond goes on: it is finite there."""
    assert layers(moduli) == ({(4.0, 1.0)} if infinite else set())


@pytest.mark.slow
@pytest.mark.parametrize(("heats", "infinite"), [((0, 5), True), ((5, 5), False)])
def test_unlike_heat_of_equal_materials_makes_stress_grow_like_a_logarithm_at_the_free_edge(heats, infinite):
    """A strip that would be longer, in a half-plane, has a jump of tension at its ends: shear like ln r beside them."""
    assert layers((100, 100), heats) == ({(4.0, 1.0)} if infinite else set())


@pytest.mark.slow
@pytest.mark.parametrize("moduli", [(100, 100), (100, 300)])
def test_stress_at_the_tip_of_a_debond(moduli):
    """It is r^-1/2, also where the edges of the bond and of the debond go on in each other, or are one."""
    below = polygon(bottom=(0, 0), right=(4, 0), crack=(4, 1), top=(1.5, 1), left=(0, 1))
    over = polygon(crack=(1.5, 1), right=(4, 1.5), top=(4, 2), left=(0, 2), bottom=(0, 1))
    for second in (block((0, 1.5), (1, 2)), over):
        bodies = {"a": elastic(below, ROLLERS, moduli[0]), "b": elastic(second, SIDE, moduli[1])}
        assert infinite_places(bodies, {"glue": ["a/top", "b/bottom"]}, "b/top", 2) == {(1.5, 1.0)}


def test_stress_at_the_end_of_a_narrow_body_on_a_wide_one():
    """The bond ends inside an edge of the wide one, at a reentrant corner of both."""
    bodies = {"a": elastic(block((0, 4), (0, 1)), ROLLERS), "b": elastic(block((0, 1.5), (1, 2)), SIDE)}
    assert infinite_places(bodies, {"glue": ["a/top", "b/bottom"]}, "b/top", 2) == {(1.5, 1.0)}


@pytest.mark.slow
@pytest.mark.parametrize(("modulus", "infinite"), [(100, False), (1000, True)])
def test_stress_at_the_corner_of_an_inclusion(modulus, infinite):
    """In the middle of a quarter of a plate; a corner of an equal material is none."""
    around = polygon(bottom=(1, 0), right=(3, 0), top=(3, 3), left=(0, 3), over=(0, 1), beside=(1, 1))
    inside = polygon(bottom=(0, 0), side=(1, 0), top=(1, 1), left=(0, 1))
    bodies = {"plate": elastic(around, ROLLERS, 100), "core": elastic(inside, ROLLERS, modulus)}
    bonded = {"beside": ["plate/beside", "core/side"], "over": ["plate/over", "core/top"]}
    assert infinite_places(bodies, bonded, "plate/top", 3) == ({(1.0, 1.0)} if infinite else set())


@pytest.mark.slow
def test_a_corner_on_an_elastic_block_makes_stress_infinite_in_both():
    """A right angle on a half-plane of its material has λ = 0.77, by contact (Dundurs and Lee 1972)."""
    bodies = {
        "a": elastic(block((0, 4), (0, 2)), ROLLERS),
        "b": elastic(block((0, 1), (2, 3)), {**SIDE, "top": {"pressure": 1}}),
    }
    problem = stated(name="seat", bodies=bodies, contacts={"c": {"between": ["b/bottom", "a/top"]}})
    result = bemcontact.solve(problem, accuracy=0.1)
    np.testing.assert_allclose(result.largest_stresses().singular, [(1, 2)])
    for edge in ("a/top", "b/bottom"):
        assert {tuple(place) for place in result.boundary_stress()[edge].singular.round(9).tolist()} == {(1.0, 2.0)}


@pytest.mark.slow
def test_bars_away_from_an_infinite_stress_are_those_of_the_place():
    """The largest stress on the bond is below the middle of the contact; the coarser mesh does not trust it there."""
    outlines = [block((0, 4), (y, y + 1)) for y in (0, 1)]
    bodies = {
        "a": elastic(outlines[0], {"bottom": {"displacement": {"y": 0}}}, 200),
        "b": elastic(outlines[1], {}, 20),
    }
    surface = {"kind": "circle", "center": [2, 12], "radius": 10, "body": "outside"}
    spec = {"contact_zones": {"press": {"edges": ["b/top"], "surface": surface}}}
    tools = {"roll": {"zones": ["press"], "force": {"y": -1}}}
    problem = stated(name="layers", bodies=bodies, bonded={"glue": ["a/top", "b/bottom"]}, tools=tools, **spec)
    peaks = [bemcontact.solve(problem, accuracy=accuracy).largest_stresses().boundary for accuracy in (0.01, 0.001)]
    assert all(peak.point == pytest.approx((2, 1), abs=0.02) for peak in peaks)
    assert peaks[0].bar < 0.05
    assert peaks[0].value == pytest.approx(peaks[1].value, rel=peaks[0].bar + peaks[1].bar)
