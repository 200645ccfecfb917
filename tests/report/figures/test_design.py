"""The picture of a design: what is drawn are the pressures and the profile, with units, and what runs out is told."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import bemcontact
from bemcontact import GapDesign, Relief, design_gap, spec
from bemcontact.bem import mesh
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.report import figures

FLAT_PUNCH = Path(__file__).parents[3] / "models" / "gallery" / "flat_punch.yaml"


@pytest.fixture(scope="module")
def design() -> GapDesign:
    contact = bemcontact.condense(spec.load(FLAT_PUNCH, variant="stated mesh"))
    return design_gap(contact, Relief(lower=0, upper=0.01, slope=0.003))


@pytest.mark.slow
def test_curves_are_those_of_the_design(design: GapDesign, tmp_path: Path):
    figure = figures.figure_of_design(design)
    above, below = figure.axes
    arc = design.before[0].contact.arc_position
    curves = [design.before[0].pressure, design.after[0].pressure]
    for line, values in zip(above.lines, curves, strict=True):
        np.testing.assert_array_equal(line.get_xydata(), np.column_stack([arc, values]))
    np.testing.assert_array_equal(below.lines[0].get_ydata(), design.profile)
    assert above.get_ylabel() == "pressure [MPa]"
    assert below.get_ylabel() == "profile [mm]"
    assert below.get_xlabel() == "distance along the contact zone [mm]"
    assert above.get_title() == "flat punch on a large block, stated mesh: peak on punch"
    legend = above.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["without", "with profile"]
    figures.save(figure, tmp_path / "design.png")
    assert (tmp_path / "design.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_a_singular_pressure_runs_out_of_the_picture_and_is_reported(design: GapDesign):
    """Without the profile the peak is infinite but for the mesh: the axis ends far below it."""
    above = figures.figure_of_design(design).axes[0]
    assert design.peak < above.get_ylim()[1] < design.peak_before / 2
    said = f"infinite in theory without,\n{design.peak_before:.4g} on this mesh"
    assert [text.get_text() for text in above.texts] == [said]


def test_the_designed_surface_is_drawn_on_the_plan(design: GapDesign):
    """The spline goes through its points and on straight, its hatching on the side away from the body."""
    problem = spec.load(FLAT_PUNCH, variant="stated mesh").with_value(
        "contact_zones.punch.surface", design.surface("spline").model_dump()
    )
    axes = figures.figure_of_problem(problem, mesh.build(problem)).axes[0]
    points = np.array(design.surface("spline").points)
    lines = [np.asarray(line.get_xydata()) for line in axes.lines]
    drawn = next(line for line in lines if len(line) > 16 * len(points))
    nearest = [np.hypot(*(drawn - point).T).min() for point in points]
    assert max(nearest) <= np.hypot(*np.diff(points, axis=0).T).max() / 16
    assert np.ptp(drawn[:, 0]) > np.ptp(points[:, 0])
    hatching = np.concatenate([np.asarray(patch.get_path().vertices) for patch in axes.patches])
    assert hatching[:, 1].max() > points[:, 1].max() + 1  # the block is below


@pytest.mark.slow
def test_each_load_state_has_its_color():
    contact = CondensedContact.from_compliance(np.eye(3), [-3.0, -1.0, -1.0])
    two = design_gap([contact, replace(contact, initial_gap=contact.initial_gap / 2)], Relief(lower=0, upper=1.5))
    lines = figures.figure_of_design(two).axes[0].lines
    assert [line.get_label() for line in lines] == [
        "without, state 1", "with profile, state 1", "without, state 2", "with profile, state 2"
    ]  # fmt: skip
    assert lines[0].get_color() == lines[1].get_color() != lines[2].get_color()
