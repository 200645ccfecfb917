"""Pictures of a comparison: what is drawn is what was found, and equal curves can be told apart."""

from pathlib import Path

import numpy as np
import pytest
from drawings import block_in_a_corner, curves, drawn
from matplotlib.figure import Figure
from mesh_studies import (
    of_many_settings,
    on_one_mesh,
    on_three_meshes,
)

import bemcontact
from bemcontact import spec
from bemcontact.analysis import compare as comparing
from bemcontact.options import ComparisonOptions
from bemcontact.report import figures

GREY = "#7d838c"
GALLERY = Path(__file__).parents[3] / "models" / "gallery"


def test_each_pressure_is_drawn_and_none_hides_another():
    level, axes = on_one_mesh().finest, Figure().add_subplot()
    figures.draw_pressures(axes, level)
    found = curves(axes)
    for contender in level.comparison.everyone:
        assert contender.assessment is not None
        assert drawn(found[contender.label]) == pytest.approx(contender.assessment.solution.pressure)
    widths = [found[label].get_linewidth() for label in ("direct", "QP1", "QP2", "QP3")]
    assert np.diff(widths).max() < -1
    assert len({found[label].get_color() for label in ("direct", "QP1", "QP2", "QP3")}) == 4
    assert "per undeformed length" in axes.get_ylabel()


def test_of_a_narrow_contact_only_what_is_around_it_is_drawn():
    """As far on either side as it is wide; the frame ends with the last point beyond that, and each curve is whole."""
    problem = bemcontact.load(GALLERY / "hertz_small.yaml")
    level, axes = comparing.mesh_study(ComparisonOptions.of(["qp3"]), problem).finest, Figure().add_subplot()
    figures.draw_pressures(axes, level)
    contact = level.answer.contact
    (interval,) = level.answer.footprint.intervals
    shown = np.asarray(curves(axes)["direct"].get_xdata(), float)
    beyond = contact.arc_position[contact.arc_position > 2 * interval.end_arc].min()
    assert shown.max() == beyond < contact.arc_position.max() / 4
    assert drawn(curves(axes)["direct"]).max() == level.answer.footprint.peak.pressure
    assert "only around the contact" in axes.get_xlabel()


def test_references_are_dashed_and_grey_where_they_are_out_of_range():
    level, axes = on_one_mesh().finest, Figure().add_subplot()
    figures.draw_pressures(axes, level)
    found = curves(axes)
    assert drawn(found["theory"]) == pytest.approx(3)
    assert found["theory"].get_color() != GREY
    assert found["Hertz, out of its range"].get_color() == GREY
    assert found["Hertz, out of its range"].is_dashed()


def test_equal_contenders_share_a_curve_and_outliers_are_named():
    """QP1 finds the same with both weights; QP2 with consistent weights and a large penalty has huge pressures."""
    level, axes = of_many_settings().finest, Figure().add_subplot()
    figures.draw_pressures(axes, level)
    labels = [*curves(axes)]
    assert "QP1 and 1 more" in labels
    largest = {
        item.label: item.assessment.solution.pressure.max()
        for item in level.comparison.contenders
        if item.assessment is not None
    }
    wild = max(largest, key=lambda label: largest[label])
    assert largest[wild] > 2 * level.answer.solution.pressure.max()
    assert wild in axes.get_title(loc="left")
    assert axes.get_ylim()[1] < largest[wild]


def test_gaps_are_drawn_beside_the_initial_gap():
    level, axes = on_three_meshes().finest, Figure().add_subplot()
    figures.draw_gaps(axes, level)
    found, contact = curves(axes), level.answer.contact
    assert drawn(found["initial gap"]) == pytest.approx(contact.initial_gap)
    assert drawn(found["QP2"]) == pytest.approx(
        contact.initial_gap + level.answer.solution.displacement, abs=1e-9 * contact.scales.displacement
    )


def test_closed_gaps_are_reported_and_their_round_off_is_not_magnified():
    """A block in a corner under uniform pressure touches both planes with all of its edges."""
    problem = spec.load(
        Path(__file__).parents[3] / "models" / "gallery" / "block_in_corner.yaml", variant="stated mesh"
    )
    level, axes = comparing.mesh_study(ComparisonOptions.of(["qp3"]), problem).finest, Figure().add_subplot()
    figures.draw_gaps(axes, level)
    assert "closed everywhere" in [text.get_text() for text in axes.texts]
    assert axes.get_ylim()[1] == level.answer.contact.scales.displacement


def test_differences_are_relative_to_the_peak():
    level, axes = of_many_settings().finest, Figure().add_subplot()
    figures.draw_differences(axes, level)
    assert axes.get_yscale() == "log"
    found = curves(axes)
    assert "direct" not in found
    for label, line in found.items():
        difference = level.comparison.difference(label)
        assert difference is not None
        assert np.nanmax(drawn(line)) == pytest.approx(difference.largest)


def test_two_zones_are_side_by_side_with_their_own_distances():
    study = comparing.mesh_study(ComparisonOptions.of(["qp3"]), block_in_a_corner())
    axes = Figure().add_subplot()
    figures.draw_pressures(axes, study.finest)
    assert [text.get_text() for text in axes.texts] == ["floor", "wall"]
    floor, wall = (line for line in axes.lines if line.get_color() == "#222222")
    assert np.max(floor.get_xdata()) < np.min(wall.get_xdata())
    assert [label.get_text() for label in axes.get_xticklabels()].count("0") == 2
    pressure = study.finest.answer.solution.pressure
    assert np.concatenate([drawn(floor), drawn(wall)]) == pytest.approx(pressure)
