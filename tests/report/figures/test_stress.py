"""Contours of stress: of the values they say, on a scale that what is infinite does not set."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.tri import TriContourSet

import bemcontact
from bemcontact.contact.stress import PointKind
from bemcontact.options import StressMeasure
from bemcontact.report import figures

MODELS = Path(__file__).parents[3] / "models"


def contours(result: bemcontact.Result, measure: StressMeasure, **more) -> tuple[Figure, TriContourSet]:
    figure = Figure()
    axes = figure.add_subplot()
    figures.fill_with_stress(axes, result, measure, **more)
    (drawn,) = [item for item in axes.collections if isinstance(item, TriContourSet)]
    return figure, drawn


@pytest.mark.parametrize("measure", StressMeasure)
def test_scale_covers_all_values_but_those_on_little_area(measure: StressMeasure):
    """The bar names the measure and its unit; signed stresses have zero in the middle."""
    result = bemcontact.solve(bemcontact.load(MODELS / "cylinder_on_plane.yaml"))
    figure, drawn = contours(result, measure)
    values = result.triangulated.stress.measured(measure)
    assert (np.abs(values) <= drawn.levels[-1]).mean() > 0.95
    assert np.abs(values).max() > 0.5 * drawn.levels[-1]
    assert drawn.levels[0] == (pytest.approx(-drawn.levels[-1]) if measure.signed else 0)
    assert figure.axes[1].get_ylabel() == f"{measure.words} [kN/cm²]"


def test_infinite_stress_is_marked_and_sets_no_scale():
    """Below a sharp punch under a mean pressure of 200 MPa, 5 mm wide, on a block of 200 mm: a cross at its edge."""
    result = bemcontact.solve(bemcontact.load(MODELS / "gallery" / "flat_punch.yaml"))
    figure, drawn = contours(result, StressMeasure.VON_MISES, window=np.array([[-5.0, -10.0], [10.0, 5.0]]))
    assert drawn.levels[-1] < 200
    crosses = [line for line in figure.axes[0].lines if line.get_marker() == "x"]
    singular = result.triangulated.points[result.triangulated.stress.kind == PointKind.SINGULAR]
    moved = singular + result.displacement(singular)
    assert np.concatenate([np.asarray(line.get_xydata()) for line in crosses]) == pytest.approx(moved)
    assert not [line for line in figure.axes[0].lines if line.get_marker() == "o"]


def test_the_largest_stress_has_a_ring():
    """At the corner of triangles with the largest value, displaced by the magnification."""
    result = bemcontact.solve(bemcontact.load(MODELS / "bolt_in_plate.yaml"))
    figure, _ = contours(result, StressMeasure.VON_MISES, factor=3.0)
    body = result.triangulated
    at = int(np.argmax(body.stress.von_mises))
    rings = [np.asarray(line.get_xydata())[0] for line in figure.axes[0].lines if line.get_marker() == "o"]
    for ring in rings:
        assert ring == pytest.approx(body.points[at] + 3 * body.displacement[at])
    assert rings


def test_no_place_is_marked_where_stress_is_the_same_all_over():
    """A block in a corner under constant pressures: round-off would choose the place."""
    result = bemcontact.solve(bemcontact.load(MODELS / "gallery" / "block_in_corner.yaml"))
    figure = Figure()
    axes = figure.add_subplot()
    assert figures.fill_with_stress(axes, result, StressMeasure.VON_MISES) == "the stress is the same all over"
    assert not axes.lines


def test_the_largest_stress_is_written_where_colors_end_below_it():
    """Under a roller of half-width 0.03 R it is 0.558 p₀ at Poisson's ratio 0.3 (Johnson 1985), to two digits."""
    result = bemcontact.solve(bemcontact.load(MODELS / "gallery" / "hertz_small.yaml"))
    axes = Figure().add_subplot()
    words = figures.fill_with_stress(axes, result, StressMeasure.VON_MISES)
    largest = float(f"{0.558 * result.peak.pressure:.2g}")
    assert words == f"ring: largest stress, about {largest:g} MPa"
    figures.draw_deformed(axes := Figure().add_subplot(), result, StressMeasure.VON_MISES)
    assert axes.get_title(loc="left").splitlines()[-1] == words
    (drawn,) = [item for item in axes.collections if isinstance(item, TriContourSet)]
    assert drawn.levels[-1] < largest
