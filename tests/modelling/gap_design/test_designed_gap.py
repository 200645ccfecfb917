"""A design written out: as words, as JSON, as a rigid surface in a spec, and solved there."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from textwrap import indent

import numpy as np
import pytest
from contact_problems import random_contact

import bemcontact
from bemcontact import GapDesign, Relief, design_gap, spec
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import ProblemError
from bemcontact.problems import Polyline, Problem, Spline

PUNCH = (Path(__file__).parents[3] / "models" / "gallery" / "flat_punch.yaml").read_text(encoding="utf-8")
LOAD = "{pressure: 5}"
PLANE = "    surface: {kind: plane, point: [0, 0], normal: [0, -1]}\n"


def spec_of(load: float, surface: str = PLANE) -> str:
    """The punch of the gallery under a part of its load, on another surface."""
    assert PLANE in PUNCH
    assert LOAD in PUNCH
    return PUNCH.replace(LOAD, f"{{pressure: {5 * load}}}").replace(PLANE, surface)


def read(text: str) -> Problem:
    return spec.loads(text, variant="stated mesh")


@cache
def relieved_punch(load: float) -> GapDesign:
    """All bounds in proportion to the load, so that the design is."""
    relief = Relief(lower=0, upper=0.01 * load, slope=0.004 * load, curvature=0.004 * load)
    return design_gap(bemcontact.condense(read(spec_of(load))), relief)


def through_the_chain(load: float, kind: str) -> CondensedContact:
    """The designed surface as text in a spec, read and condensed."""
    return bemcontact.condense(read(spec_of(load, indent(relieved_punch(load).to_yaml(kind), "    "))))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["spline", "polyline"])
def test_surface_is_at_the_designed_gap(kind):
    """The nearest point is not farther than the foot straight below, and by a tilt θ nearer by 1 - cos θ at most.

    That is 4e-3 for the bound on the slope, or 8e-6 of the gap; twice that where the tilt changes on the way.
    """
    design, surface = relieved_punch(1.0), relieved_punch(1.0).surface(kind)
    assert isinstance(surface, Spline if kind == "spline" else Polyline)
    contact = design.after[0].contact
    gap, normals = surface.closest(contact.points)
    np.testing.assert_allclose(gap, contact.initial_gap, atol=2 * 8e-6 * contact.initial_gap.max())
    assert np.arccos(np.clip((normals * contact.normals).sum(axis=1), -1, 1)).max() <= 1.1 * 0.004
    read, inward = through_the_chain(1.0, kind), np.repeat(contact.normals[:, None], 2, axis=1)
    held = surface.faces(contact.points, inward, np.zeros(len(gap)))
    np.testing.assert_allclose(read.initial_gap, held.gap[:, 0], rtol=0, atol=1e-14 * gap.max())


@pytest.mark.slow
def test_whole_chain_differs_by_the_tilt_of_the_normals():
    """Solved on the written surface, the pressure is the designed one but for what the tilted normals do.

    That is of the first order in the slope and of the second in the load: a tenth of the load divides the relative
    difference by ten. At a hundredth, with slopes up to 4e-5, it is below a thousandth of the peak.
    """
    differences = []
    for load in (1.0, 0.1, 0.01):
        design = relieved_punch(load)
        assert design.verified
        result = bemcontact.solve(through_the_chain(load, "spline"), "complementarity")
        assert result.certified
        pressure = design.after[0].pressure
        differences.append(np.abs(result.solution.pressure - pressure).max() / pressure.max())
    assert differences[0] / differences[1] == pytest.approx(10, rel=0.2)
    assert differences[1] / differences[2] == pytest.approx(10, rel=0.2)
    assert differences[2] <= 1e-3


@pytest.mark.slow
def test_words_and_numbers():
    design = relieved_punch(1.0)
    without = f"Without it, it is infinite in theory, as at a sharp edge, and {design.peak_before:.5g} on this mesh."
    assert without in design.words
    assert "another profile does better is not proved" in design.words
    assert "certified" in design.words
    record = json.loads(design.to_json())
    assert record["profile"] == design.profile[design.points].tolist()
    assert record["after"][0]["peak"]["pressure"] == design.peak
    assert record["verified"] is True
    assert record["lower_bound"] <= record["value"] < record["value_before"]
    assert repr(design).startswith(f"<GapDesign on 'punch': peak {design.peak_before:.6g} -> ")


@pytest.mark.slow
def test_a_roller_cut_at_its_line_of_symmetry_has_no_infinite_peak():
    """Its pressure is Hertz's, which is finite; of two points in contact on a coarse mesh the first is on the line."""
    arc = {"name": "rim", "kind": "arc", "center": [0, 8], "radius": 8, "angles": [-90, 0], "elements": 8}
    outer = [arc, {"name": "top", "end": [0, 8], "elements": 4}, {"name": "axis", "elements": 4}]
    plane = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    roller = bemcontact.problem(
        {
            "name": "roller",
            "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
            "boundary": {"outer": outer},
            "conditions": {"axis": {"displacement": {"x": 0}}, "top": {"pressure": 1}},
            "contact_zones": {"rim": {"edges": "rim", "surface": plane}},
            "accuracy": None,
        }
    )
    design = design_gap(bemcontact.condense(roller), Relief(lower=0, upper=0.001))
    assert np.count_nonzero(design.before[0].pressure) <= 2
    assert design.before[0].pressure.argmax() == 0
    assert not design.before[0].infinite
    assert "infinite in theory" not in design.words


def test_a_pressure_that_is_not_as_designed_is_reported():
    """A pressure off by a hundredth of the peak, as a broken solver would compute it."""
    design = relieved_punch(1.0)
    wrong = replace(design, designed=design.designed + 0.01 * design.peak)
    assert not wrong.verified
    assert wrong.difference == pytest.approx(0.01, rel=1e-6)
    assert "are not as designed: pressures differ by 1e-02" in wrong.words
    same = replace(design, designed=np.array([state.pressure for state in design.after]))
    assert "certified: pressures are the same." in same.words


@pytest.mark.slow
def test_numbers_in_yaml_have_a_point_before_the_exponent():
    """YAML 1.1 reads 1e-05 as text; all digits are there."""
    design = relieved_punch(0.01)
    lines = design.to_yaml("polyline").splitlines()[3:]
    assert any("e-" in line for line in lines)
    assert not [line for line in lines if "e-" in line and "." not in line.replace("0.0", "")]
    import_points = spec.loads(spec_of(1.0, indent(design.to_yaml("polyline"), "    "))).contact_zones["punch"].surface
    assert import_points.points == design.surface("polyline").points


def test_surfaces_that_cannot_be_written_are_refused():
    design = relieved_punch(1.0)
    with pytest.raises(ProblemError, match="no surface of kind 'circle' to write; there are: spline, polyline"):
        design.surface("circle")
    steep = design_gap(random_contact(0, 5, 0), Relief(lower=(0, 0, 0, 0, 0), upper=0.1))
    assert steep.surface().kind == "spline"
    halves = replace(random_contact(0, 5, 0), run=np.array([0, 0, 1, 1, 1]), run_length=np.full(2, np.inf))
    with pytest.raises(ProblemError, match="goes round or is in pieces, which no spline does; divide the zone"):
        design_gap(halves, Relief(lower=0, upper=0.1)).surface()


def test_a_roller_crowned_by_the_closed_form():
    """The contour of a half-plane under uniform pressure as a spline in a spec: that pressure, away from the edges.

    Johnson's (2.30a) with 20 MPa on a = 5 mm. Its slope is infinite at the edge, where no spline follows it; within
    0.9 a the pressure is uniform to 0.1 %, which the block of 40 half-widths leaves open.
    """
    a, pressure = 5.0, 20.0
    x = a * np.sin(np.linspace(-np.pi / 2, np.pi / 2, 49))
    sides = [(1 + sign * x / a) * np.log(np.maximum(1 + sign * x / a, 1e-300)) for sign in (1, -1)]
    crown = 2 * pressure * a * (1 - 0.3**2) / (np.pi * 210e3) * sum(sides)
    points = ", ".join(f"[{at:.12f}, {height:.12f}]" for at, height in zip(x[::-1], crown[::-1], strict=True))
    surface = f"    surface: {{kind: spline, points: [{points}]}}\n"
    result = bemcontact.solve(read(spec_of(0.1, surface)))
    assert result.certified
    inside = abs(result.contact.points[:, 0]) < 0.9 * a
    np.testing.assert_allclose(result.solution.pressure[inside], pressure, rtol=1e-3)
