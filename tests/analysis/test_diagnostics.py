"""Remarks on a result: contact up to the end of a zone, few points under a contact, long elements beyond its end."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from contact_meshes import cylinder, ring, table
from scipy.optimize import brentq
from tool_problems import BETWEEN, made

import bemcontact
from bemcontact.analysis.diagnostics import LARGE, LARGE_PART, large_displacements
from bemcontact.analysis.result import Result
from bemcontact.bem.mesh import BoundaryState
from bemcontact.problem import Problem

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
    (note,) = bemcontact.solve(bemcontact.load(FOLDER / "flat_punch.yaml")).notes
    assert "(5, 0), where the boundary goes on smoothly; make the zone longer, unless the rigid surface ends" in note
    assert "infinite in theory" in note


def notes(problem: bemcontact.Problem, start: str) -> list[str]:
    """Notes of a result on the mesh as stated that begin with a text."""
    result = bemcontact.solve(problem.with_value("mesh.fit_contact_edges", False), "complementarity")
    return [note for note in result.notes if note.startswith(start)]


def test_few_points_are_reported_of_each_contact():
    """Two feet with a few points each, enough of them together; on finer elements there are enough on each."""
    told = notes(table(), FEW)
    assert len(told) == 2
    assert all(" contact points from (" in note and "in feet: the mesh is too coarse there" in note for note in told)
    assert notes(table().refined(4), FEW) == []


def test_points_across_the_seam_are_of_one_contact():
    """Contact over half of a pin, with the seam in the middle of it."""
    assert notes(ring(90), FEW) == []


@pytest.mark.parametrize(("elements", "told"), [(2, True), (24, False)])
def test_long_elements_beyond_a_pressed_corner_are_reported(elements, told):
    """On the axis: the peak is off by a third beside the long ones, and the fit cures it by halving them."""
    stated = cylinder(24, load=0.01).with_value("boundary.outer.axis.grading.ratio", 1)
    coarse = stated.with_value("boundary.outer.axis.elements", elements)
    found = notes(coarse, LONG)
    assert bool(found) is told
    if told:
        assert found[0].startswith(
            "pressure acts at (0, 0), the end of the zone 'foot', beyond which an element of 'axis'"
        )
        assert found[0].endswith("grade that edge towards the zone")
    fitted = bemcontact.solve(coarse, "complementarity")
    assert not [note for note in fitted.notes if note.startswith(LONG)]
    assert fitted.footprint.peak.pressure == pytest.approx(18.819, rel=3e-3)  # Hertz


def test_a_body_that_nothing_presses_floats_and_a_note_states_so():
    """A block between a floor and a plate that moves away: contact could hold it, but carries no pressure."""
    moves_away = {"press": {"zones": "press", "displacement": {"y": 0.1}}}
    result = bemcontact.solve(
        made(BETWEEN, tools=moves_away, load_cases={}, combinations={}, conditions={"left": {"displacement": {"x": 0}}})
    )
    assert result.footprint.intervals == ()
    assert any("contact does not determine the translation along (0, 1)" in note for note in result.notes)


def affine(gradient: np.ndarray, unit: float = 1.0, share: float = 1.0) -> list[str]:
    """Notes on the displacement A x of a square of 4 x 25 elements, on a share of its boundary."""
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]) * unit
    ends = np.concatenate([a + np.linspace(0, 1, 26)[:-1, None] * (b - a) for a, b in pairwise(corners)])
    after = np.roll(ends, -1, axis=0)
    points = np.stack([ends, (ends + after) / 2, after], axis=1)
    moved = points @ gradient.T + unit
    moved[int(share * 100) :] = 0.0
    state = BoundaryState(
        points=points, displacement=moved, traction=moved, edge=np.zeros(100, int), edge_names=("all",),
        force_balance=0.0, equilibrium_slack=0.0,
    )  # fmt: skip
    return [*large_displacements(state)]


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("shape", [((0, -1), (1, 0)), ((1, 0), (0, 1)), ((0, 1), (0, 0))])
def test_large_rotations_strains_and_shears_are_noted_and_translations_are_not(shape: tuple, unit: float):
    """The displacement A x changes by |A t| of the length along a side in the direction t."""
    assert affine(np.array(shape) * LARGE * 0.99, unit) == []
    (note,) = affine(np.array(shape) * LARGE * 1.01, unit)
    assert f"on {50 if shape[1] == (0, 0) else 100} % of the boundary" in note


def test_a_few_elements_with_large_displacements_are_not_noted():
    assert affine(np.eye(2), share=LARGE_PART - 0.01) == []
    assert affine(np.eye(2), share=LARGE_PART + 0.01) != []


@pytest.mark.parametrize(("load", "notes"), [(0.24, 0), (0.26, 2)])
def test_a_block_under_a_large_pressure_has_notes(load: float, notes: int):
    """Uniaxial stress: the strain of the sides, a third of the boundary, is the pressure over Young's modulus."""
    edges = [{"name": name, "start": start, "elements": 4} for name, start in
             (("bottom", [0, 0]), ("right", [2, 0]), ("top", [2, 1]), ("left", [0, 1]))]  # fmt: skip
    problem = Problem(
        name="block",
        material={"young_modulus": 7.0, "poisson_ratio": 0.3, "state": "plane_stress"},
        boundary={"outer": edges},
        conditions={"left": {"displacement": {"x": 0}}, "top": {"pressure": 7 * load}},
        contact_zones={"foot": {"edges": "bottom", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
    )
    found = [note for note in bemcontact.solve(problem, "complementarity").notes if "not small" in note]
    assert len(found) == notes
