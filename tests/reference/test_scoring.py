"""Answers beside closed forms: how far they are off, what is judged, and that units do not matter."""

import json
from pathlib import Path

import numpy as np
import pytest
from known_answers import BLOCK, crack, hertz, pillow, propped_beam, punch, ring

import bemcontact
from bemcontact.assessment.footprint import Footprint, Resultant
from bemcontact.reference import Score, expected, score

ROOT = Path(__file__).parents[2]


def scores(problem: bemcontact.Problem) -> dict[tuple[str, str], Score]:
    """All scores of a solved problem, by reference and quantity."""
    result = bemcontact.solve(problem)
    assert result.certified
    known = expected(problem, result.contact)
    found = score(known, result.contact, result.footprint, result.solution.pressure)
    assert len({(item.reference, item.quantity) for item in found}) == len(found)
    return {(item.reference, item.quantity): item for item in found}


def test_hertz_at_a_hundredth_of_the_load_is_judged_and_holds():
    """Hertz is off by 0.03 % at b/R = 0.034; the mesh leaves 0.1 % of peak and half-width."""
    found = scores(bemcontact.loads(hertz()))
    assert all(item.judged and item.holds for item in found.values())
    difference = {quantity: abs(item.difference) for (_, quantity), item in found.items()}
    assert set(difference) == {
        "peak",
        "half-width",
        "resultant",
        "pressure (largest difference)",
        "pressure (mean square)",
    }
    assert difference["resultant"] < 1e-12  # equilibrium
    assert difference["peak"] < 1e-3
    assert difference["half-width"] < 1e-3
    assert difference["pressure (mean square)"] < 1e-3
    assert difference["pressure (largest difference)"] < 2e-3


@pytest.mark.parametrize(("size", "off"), [(10.0, 5e-3), (20.0, 1.5e-3)])
@pytest.mark.parametrize("parts", [1, 2])
def test_hertz_on_a_body_of_finite_depth(size: float, off: float, parts: int):
    """0.46 % of the peak and 0.40 % of the half-width at a depth of 10 b, a quarter at 20 b; a finer mesh holds too."""
    found = scores(bemcontact.loads(pillow(size)).refined(parts))
    assert all(item.judged and item.holds for item in found.values())
    assert abs(found["Hertz", "peak"].difference) < off
    assert abs(found["Hertz", "half-width"].difference) < off


def test_hertz_at_full_load_is_shown_and_not_judged():
    """At b/R = 0.34 the peak is 2.6 % lower and the contact 1.0 % wider; what finite elements found holds to 0.1 %."""
    found = scores(bemcontact.load(ROOT / "models" / "cylinder_on_plane.yaml"))
    for (reference, quantity), item in found.items():
        assert item.judged == (reference == "finite elements")
        assert item.holds == (reference == "finite elements" or quantity == "resultant")
    assert found["Hertz", "peak"].difference == pytest.approx(-0.026, abs=1e-3)
    assert found["Hertz", "half-width"].difference == pytest.approx(0.010, abs=1.2e-3)
    assert abs(found["finite elements", "peak"].difference) < 1e-3
    assert abs(found["finite elements", "half-width"].difference) < 1e-3


def test_a_change_of_units_changes_no_score():
    """Lengths in thousandths and stresses in millionths: differences stay, but for round-off and the solver's 1e-9."""
    here, there = scores(bemcontact.loads(hertz())), scores(bemcontact.loads(hertz(length=1e3, stress=1e-6)))
    for key, item in here.items():
        assert there[key].difference == pytest.approx(item.difference, rel=1e-6, abs=1e-9)
        assert there[key].holds == item.holds
    assert there["Hertz", "half-width"].computed == pytest.approx(1e3 * here["Hertz", "half-width"].computed, rel=1e-8)


@pytest.mark.parametrize(("size", "largest"), [(10.0, 6e-3), (20.0, 3e-3)])
def test_punch_on_a_block(size: float, largest: float):
    """The pressure under a punch: the block of ten half-widths leaves 0.5 %, of twenty a quarter of it and the mesh."""
    found = scores(bemcontact.loads(punch(size)))
    assert all(item.judged and item.holds for item in found.values())
    assert found["punch", "pressure (largest difference)"].difference < largest
    assert found["punch", "resultant"].difference == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("size", [30.0, 60.0, 120.0])
def test_panel_with_a_crack_tends_to_the_infinite_one(size: float):
    """Pressure larger by 3.4 (a/size)², to a twentieth of it and 0.1 % of the mesh."""
    found = scores(bemcontact.loads(crack(size)))
    difference = found["crack", "pressure (mean square)"].difference
    assert difference == pytest.approx(3.4 * (3 / size) ** 2, rel=0.05, abs=1e-3)
    assert found["crack", "half-width"].holds
    assert found["crack", "pressure (largest difference)"].judged == (size >= 60)


@pytest.mark.parametrize("state", ["plane_strain", "plane_stress"])
@pytest.mark.parametrize("rigid", ["pin", "bore"])
def test_shrink_fit(state: str, rigid: str):
    """Lamé is exact; twelve quadratic elements on a quarter of the circle leave 0.3 % at their ends."""
    found = scores(bemcontact.loads(ring(state, rigid)))
    assert all(item.judged and item.holds for item in found.values())
    assert found["fit", "pressure (largest difference)"].difference < 3e-3


@pytest.mark.parametrize(("span", "prop", "end"), [(10.0, 8e-3, 1.3e-2), (20.0, 2e-3, 2.1e-3)])
@pytest.mark.parametrize("gap", [0.0, 0.5, 0.75])
def test_propped_beam(span: float, prop: float, end: float, gap: float):
    """Off by as much as the closed form says of itself at 10 and at 20 heights, whatever part of the sag the gap is."""
    found = scores(bemcontact.loads(propped_beam(span, gap)).refined(3))
    assert all(item.judged and item.holds for item in found.values())
    assert abs(found["prop", "resultant"].difference) < prop
    assert abs(found["end", "resultant"].difference) < end


def test_block_between_walls():
    """Uniform compression is exact; the wall is told 4 where 3 is right, and the table up to 4."""
    found = scores(bemcontact.loads(BLOCK))
    wrong = {key for key, item in found.items() if not item.holds}
    assert wrong == {
        ("wall", "peak"),
        ("wall", "pressure (largest difference)"),
        ("wall", "pressure (mean square)"),
        ("table", "pressure (largest difference)"),
        ("table", "pressure (mean square)"),
    }
    assert found["wall", "peak"].difference == pytest.approx(-0.25)
    assert found["values", "contact length"].computed == pytest.approx(2.0)
    assert found["values", "resultant"].computed == pytest.approx(10.0)
    assert found["values", "start of contact"].computed == pytest.approx(0.0, abs=1e-12)
    assert found["values", "end of contact"].computed == pytest.approx(2.0)
    assert found["both", "contact length"].difference == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("coordinate", "end"),
    [("x", 0.274008), ("arc", 0.274062), ("angle, center: [0, 8], zero: [0, -1]", 1.96284)],
)
def test_end_of_contact_in_each_coordinate(coordinate: str, end: float):
    """The b of Hertz, R asin(b/R), and asin(b/R) in degrees; differences are relative to the extent."""
    spec = hertz()
    value = f"reference:\n  end: {{kind: values, source: Hertz, start: 0, end: {end}, against: {coordinate}}}\n"
    found = scores(bemcontact.loads(spec[: spec.index("reference:")] + value))
    assert found["end", "start of contact"].computed == pytest.approx(0.0, abs=1e-12)
    assert found["end", "end of contact"].computed == pytest.approx(end, rel=1e-3)
    assert abs(found["end", "end of contact"].difference) < 1e-3


def test_mean_square_is_that_of_the_tributary_lengths():
    """√(Σ w (p - e)² / Σ w e²) for e = 5 and p = 5 + x on the foot of the block, recomputed."""
    problem = bemcontact.loads(BLOCK)
    contact = bemcontact.condense(problem)
    result = bemcontact.solve(problem)
    pressure = 5.0 + contact.points[:, 0]
    one = expected(problem, contact)[0]
    found = {item.quantity: item for item in score([one], contact, result.footprint, pressure)}
    foot = contact.zone == contact.zone_names.index("foot")
    w, x = contact.weights[foot], contact.points[foot, 0]
    assert found["pressure (mean square)"].difference == pytest.approx(np.sqrt((w @ x**2) / (w.sum() * 25)))
    assert found["pressure (largest difference)"].difference == pytest.approx(2 / 5)
    assert found["pressure (largest difference)"].computed == pytest.approx(2.0)


def test_where_nothing_touches_nothing_holds():
    problem = bemcontact.loads(BLOCK)
    contact = bemcontact.condense(problem)
    nothing = Footprint(intervals=(), peak=None, resultant=Resultant(force=(0.0, 0.0), moment=0.0, line_point=None))
    found = score(expected(problem, contact), contact, nothing, np.zeros(contact.size))
    assert not any(item.holds for item in found)
    ends = [item for item in found if "of contact" in item.quantity]
    assert [(item.computed, item.difference) for item in ends] == [(None, None)] * 2
    assert {item.computed for item in found if item.quantity in ("peak", "contact length", "resultant")} == {0.0}
    json.dumps([item.to_dict() for item in found], allow_nan=False)
