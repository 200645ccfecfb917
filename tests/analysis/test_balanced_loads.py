"""Loads that balance, and growth within a clearance: no contact, exactly, and sane numbers in any units."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact.analysis.solve import condense, solve
from bemcontact.errors import ProblemError
from bemcontact.problem import Problem
from bemcontact.report.facts import facts
from bemcontact.report.formatting import units_of

RADII = 10.0, 20.0
POWERS = st.sampled_from([-12, -6, 0, 6, 12])
LOADS = ("spin", "bore", "opposing", "heat", "cases")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]\d+)?")


def ring(load: str, gap: float, size: float = 1.0, stress: float = 1.0, elements: int = 8) -> Problem:
    """A ring in a round hole with a clearance; what loads it has no resultant. Lengths and stresses have any unit."""
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
        material={"young_modulus": modulus, "poisson_ratio": 0.3},
        boundary={"outer": rim, "holes": [halves]},
        contact_zones={"wall": {"edges": ["rim"], "surface": wall}},
        **of_load[load],
    )


def growth(load: str) -> np.ndarray:
    """How far the rim moves outwards without contact, at each point; the mean position is fixed by the gauge."""
    return -condense(ring(load, 0.0)).free_displacement


GROWTH = {load: growth(load) for load in LOADS}


@settings(max_examples=15)
@given(load=st.sampled_from(LOADS), excess=st.floats(-9, 0.5), size=POWERS, stress=POWERS, formulation=st.booleans())
def test_growth_within_the_clearance_makes_no_contact(load, excess, size, stress, formulation):
    """A clearance above the largest growth leaves p = 0 as the only solution, whatever the units."""
    gap = float(GROWTH[load].max()) * (1 + 10**excess)
    problem = ring(load, gap * 10.0**size, 10.0**size, 10.0**stress)
    result = solve(problem, "qp3" if formulation else "complementarity")
    assert result.certified
    assert not result.solution.pressure.any()
    assert result.footprint.peak is None
    assert not result.footprint.intervals
    assert not result.touching.any()
    assert result.certificate.error_bound < 1e-9 * result.contact.scales.pressure
    assert result.certificate.relative_error_bound is None
    U = result.contact.scales.displacement
    assert gap * 10.0**size <= U <= 10 * gap * 10.0**size  # no scale is round-off
    texts = dict(facts(result.to_dict(), units_of(result.contact)))
    assert texts["Contact"] == "nowhere"
    assert "Peak pressure" not in texts
    assert texts["Resultant"].startswith("(0, 0)")
    assert result.residuals.force_balance < 1e-12


@settings(max_examples=10)
@given(load=st.sampled_from(("spin", "bore", "heat")), depth=st.floats(-8, -0.5), size=POWERS, stress=POWERS)
def test_growth_beyond_the_clearance_makes_contact(load, depth, size, stress):
    """Below the least growth no position of the ring is free; p is as large as the growth that is prevented."""
    gap = float(GROWTH[load].min()) * (1 - 10**depth)
    result = solve(ring(load, gap * 10.0**size, 10.0**size, 10.0**stress), "complementarity")
    prevented = (GROWTH[load].max() - gap) * 10.0**size
    assert result.certified
    assert result.footprint.peak is not None
    assert result.footprint.intervals
    U, T = result.contact.scales
    assert 0.3 * prevented < U < 3 * prevented
    assert 0.3 * T < result.footprint.peak.pressure < 30 * T


def pipe(traction: float, weight: float, counts: tuple[int, int] = (4, 7)) -> Problem:
    """A pipe on a floor under its weight, both halves of its bore pulled apart; their elements differ in length."""
    arcs = [("a", [180, 0], counts[0]), ("b", [360, 180], counts[1])]
    floor = {"kind": "plane", "point": [0, -2], "normal": [0, 1]}
    gravity = {"density": weight / (3 * np.pi), "acceleration": [0, -1]}
    around = {"kind": "arc", "center": [0, 0]}
    return Problem(
        name="pipe",
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


@pytest.mark.parametrize("weight", [0.0, 1e-11])
def test_balanced_loads_do_not_press_a_body_onto_its_support(weight: float):
    with pytest.raises(ProblemError, match="no load presses it onto its support"):
        solve(pipe(1.0, weight), "complementarity")
