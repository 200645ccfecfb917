"""Remarks on a result: few points under a contact, long elements beyond its end."""

import pytest
from contact_meshes import cylinder, ring, table

import bemcontact

FEW, LONG = "pressure acts on", "pressure acts at"


def notes(problem: bemcontact.Problem, start: str) -> list[str]:
    """Those of the mesh as stated that begin so."""
    result = bemcontact.solve(problem.with_value("mesh.fit_contact_edges", False), "complementarity")
    return [note for note in result.notes if note.startswith(start)]


def test_few_points_are_told_of_each_contact():
    """Two feet with a few points each, enough of them together; on finer elements there are enough on each."""
    told = notes(table(), FEW)
    assert len(told) == 2
    assert all(
        "contact points only from (" in note and "in feet: the mesh is too coarse there" in note for note in told
    )
    assert notes(table().refined(4), FEW) == []


def test_points_across_the_seam_are_of_one_contact():
    """Contact over half of a pin, with the seam in the middle of it."""
    assert notes(ring(90), FEW) == []


@pytest.mark.parametrize(("elements", "told"), [(2, True), (24, False)])
def test_long_elements_beyond_a_pressed_corner_are_told(elements, told):
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
