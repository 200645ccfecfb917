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
    """Hertz is off by 0.03 % at b/R = 0.034; the mesh leaves 0.1 % of peak, half-width and pressure."""
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
    assert difference["pressure (largest difference)"] < 1e-3


@pytest.mark.parametrize("size", [10.0, 20.0])
@pytest.mark.parametrize("parts", [1, 2])
def test_hertz_on_a_body_of_finite_depth_holds(size: float, parts: int):
    found = scores(bemcontact.loads(pillow(size)).refined(parts))
    assert all(item.judged and item.holds for item in found.values())


def test_difference_from_hertz_is_of_second_order_in_half_width_over_depth():
    """A body of twice the depth: a quarter of the difference of the peak, up to a tenth for the mesh."""
    shallow, deep = (
        scores(bemcontact.loads(pillow(size)).refined(2))["Hertz", "peak"].difference for size in (10.0, 20.0)
    )
    assert shallow / deep == pytest.approx(4, rel=0.1)


def test_hertz_at_full_load_is_shown_and_not_judged():
    """Finite elements have 183.335 for 188.19 of Hertz, and 2.7685 for 2.7401; the result agrees with them to 0.1 %."""
    found = scores(bemcontact.load(ROOT / "models" / "cylinder_on_plane.yaml"))
    for (reference, quantity), item in found.items():
        assert item.judged == (reference == "finite elements")
        assert item.holds == (reference == "finite elements" or quantity == "resultant")
    assert found["Hertz", "peak"].difference == pytest.approx(183.335 / 188.19 - 1, abs=1e-3)
    assert found["Hertz", "half-width"].difference == pytest.approx(2.7685 / 2.7401 - 1, abs=1e-3)
    assert abs(found["finite elements", "peak"].difference) < 1e-3
    assert abs(found["finite elements", "half-width"].difference) < 1e-3


def test_a_change_of_units_changes_no_score():
    """Lengths in thousandths and stresses in millionths: differences stay, but for round-off and the solver's 1e-9."""
    here, there = scores(bemcontact.loads(hertz())), scores(bemcontact.loads(hertz(length=1e3, stress=1e-6)))
    for key, item in here.items():
        assert there[key].difference == pytest.approx(item.difference, rel=1e-6, abs=1e-9)
        assert there[key].holds == item.holds
    assert there["Hertz", "half-width"].computed == pytest.approx(1e3 * here["Hertz", "half-width"].computed, rel=1e-8)


def test_punch_on_a_block():
    """The pressure on a block of twenty half-widths is nearer to that on a half-plane than on one of ten."""
    small, large = (scores(bemcontact.loads(punch(size))) for size in (10.0, 20.0))
    for found in (small, large):
        assert all(item.judged and item.holds for item in found.values())
        assert found["punch", "resultant"].difference == pytest.approx(0.0, abs=1e-12)
    for quantity in ("pressure (largest difference)", "pressure (mean square)"):
        assert large["punch", quantity].difference < small["punch", quantity].difference


@pytest.mark.slow
def test_panel_with_a_crack_tends_to_the_infinite_one():
    """Of second order in crack over panel: twice the size has a quarter of the difference, to 5 %."""
    differences = []
    for size in (30.0, 60.0, 120.0):
        found = scores(bemcontact.loads(crack(size)))
        differences.append(found["crack", "pressure (mean square)"].difference)
        assert found["crack", "half-width"].holds
        assert found["crack", "pressure (largest difference)"].judged == (size >= 60)
    assert differences[0] / differences[1] == pytest.approx(4, rel=0.05)
    assert differences[1] / differences[2] == pytest.approx(4, rel=0.05)


@pytest.mark.parametrize("state", ["plane_strain", "plane_stress"])
@pytest.mark.parametrize("rigid", ["pin", "bore"])
def test_shrink_fit(state: str, rigid: str):
    """Lamé is exact; the largest difference falls with the length of the elements, of order one at least."""
    problem = bemcontact.loads(ring(state, rigid))
    coarse, fine = (scores(problem.refined(parts)) for parts in (1, 2))
    assert all(item.judged and item.holds for found in (coarse, fine) for item in found.values())
    key = "fit", "pressure (largest difference)"
    assert fine[key].difference < coarse[key].difference / 2


@pytest.mark.slow
@pytest.mark.parametrize("gap", [0.0, 0.5, 0.75])
def test_propped_beam(gap: float):
    """Beam theory is for slender beams: with 20 heights it is off by less than half of what it is with 10."""
    short, long = (scores(bemcontact.loads(propped_beam(span, gap)).refined(3)) for span in (10.0, 20.0))
    assert all(item.judged and item.holds for found in (short, long) for item in found.values())
    for support in ("prop", "end"):
        assert abs(long[support, "resultant"].difference) < abs(short[support, "resultant"].difference) / 2


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
    nothing = Footprint(
        intervals=(),
        peak=None,
        resultant=Resultant(force=(0.0, 0.0), moment=0.0, line_point=None),
        forces={},
        moments={},
    )
    found = score(expected(problem, contact), contact, nothing, np.zeros(contact.size))
    assert not any(item.holds for item in found)
    ends = [item for item in found if "of contact" in item.quantity]
    assert [(item.computed, item.difference) for item in ends] == [(None, None)] * 2
    assert {item.computed for item in found if item.quantity in ("peak", "contact length", "resultant")} == {0.0}
    json.dumps([item.to_dict() for item in found], allow_nan=False)
