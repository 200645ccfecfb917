"""Where contact reaches the end of a zone: what the note says, and that the pressure there is as it says."""

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import bemcontact
from bemcontact.problem import Problem
from bemcontact.result import Result

FOLDER = Path(__file__).parents[1] / "models" / "gallery"


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


def at_the_corner(result: Result) -> float:
    """The pressure at (20, 0)."""
    return float(result.solution.pressure[np.argmax(result.contact.points[:, 0])])


@pytest.mark.parametrize("angle", [110, 120, 135])
def test_at_an_obtuse_corner_the_pressure_is_unbounded_as_the_note_says(angle: float):
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


def test_on_a_smooth_boundary_both_readings_are_told():
    """That of a zone too short, and that of a punch, whose pressure is infinite at its edge."""
    (note,) = bemcontact.solve(bemcontact.load(FOLDER / "flat_punch.yaml")).notes
    assert "(5, 0), where the boundary goes on smoothly; make the zone longer, unless the rigid surface ends" in note
    assert "infinite in theory" in note
