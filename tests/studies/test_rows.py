"""Rows of a study: what is said of a member, and that nothing is lost in JSON."""

import json
from pathlib import Path

import pytest

import bemcontact
from bemcontact.analysis.result import BEYOND
from bemcontact.studies.rows import MemberStatus, row_from, row_of

MODELS = Path(__file__).parents[2] / "models"
CYLINDER = bemcontact.load(MODELS / "cylinder_on_plane.yaml", variant="paper")


def test_a_row_is_the_same_after_json():
    row = row_of(3, {"a": [1.5, "x"], "b": None}, bemcontact.solve(CYLINDER.with_value("accuracy", 0.01)))
    assert row_from(json.loads(row.to_json()), 3, row.values) == row


def test_a_result_that_is_not_certified_says_so():
    """A local solver that is stopped early has numbers that nobody may take for right."""
    result = bemcontact.solve(CYLINDER, "qp2", max_iterations=3, polish=False)
    assert not result.certified
    row = row_of(0, {}, result)
    assert (row.status, row.holds, row.certified) == (MemberStatus.NOT_CERTIFIED, False, False)
    assert row.message == " ".join(result.words.split())


def test_a_row_says_why_it_has_no_peak():
    """Below a flat punch the pressure is infinite at both edges; it is proved all the same."""
    result = bemcontact.solve(bemcontact.load(MODELS / "gallery" / "flat_punch.yaml"), accuracy=0.1)
    row = row_of(0, {}, result)
    assert (row.holds, row.outputs["peak"].value) == (True, None)
    assert row.message == "the peak pressure is infinite in punch"
    row = row_of(0, {}, result, stresses=True)
    assert row.outputs["von_mises"].value is None
    assert row.message == "the peak pressure is infinite in punch"
    assert row.stress == "von Mises stress grows up to an infinite one: it has no largest value"


@pytest.mark.slow
def test_a_row_says_what_its_largest_stress_leaves_out():
    """Where three stops press a body, its sharp corners are elsewhere."""
    row = row_of(0, {}, bemcontact.solve(bemcontact.load(MODELS / "gallery" / "three_zones.yaml")), stresses=True)
    assert row.outputs["von_mises"].value is not None
    assert row.stress == "stress is infinite at corners or edges, von_mises is the largest maximum away from them"


def test_a_row_has_the_notes_on_what_its_error_bars_do_not_include():
    """The hole of the plate bends around its bolt, by what is not small; so says `solve`."""
    model = bemcontact.load(MODELS / "bolt_in_plate.yaml")
    result = bemcontact.solve(model)
    row = row_of(0, {}, result)
    notes = [note for note in result.notes if BEYOND in note]
    assert row.holds
    assert notes
    assert (row.message, row.notes) == ("", tuple(notes))
    assert row_from(json.loads(row.to_json()), 0, {}) == row
    roller = bemcontact.load(MODELS / "gallery" / "hertz_small.yaml")
    assert row_of(0, {}, bemcontact.solve(roller)).notes == ()


def test_a_mesh_that_is_not_assessed_neither_holds_nor_fails():
    row = row_of(0, {}, bemcontact.solve(CYLINDER))
    assert (row.status, row.holds, row.met, row.mesh_error) == (MemberStatus.NOT_ASSESSED, None, None, None)
