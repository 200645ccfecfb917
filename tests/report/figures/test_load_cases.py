"""Pictures of load cases side by side: bodies, fans, magnification and colors have one scale."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from drawings import off, outlines
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.tri import TriContourSet

import bemcontact
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.contact.stress import PointKind
from bemcontact.options import StressMeasure
from bemcontact.report import figures
from bemcontact.report.figures.deformed import magnification
from bemcontact.report.figures.page import BLACK
from bemcontact.report.figures.pictures import figure_of_contacts, figure_of_stresses
from bemcontact.report.figures.stress import color_scale

GALLERY = Path(__file__).parents[3] / "models" / "gallery"
MODELS = ("body_between_two_tools", "eccentric_punch", "roller_in_v_block")
FAN = "#d55e00"


@cache
def solved(name: str) -> CaseResults:
    return bemcontact.solve_cases(bemcontact.load(GALLERY / f"{name}.yaml").with_value("accuracy", 0.05))


def contours(axes: Axes) -> TriContourSet:
    (drawn,) = [item for item in axes.collections if isinstance(item, TriContourSet)]
    return drawn


def factor_of(figure: Figure) -> float:
    title = figure.get_suptitle().split("\n")[0]
    return 1.0 if title.endswith("displacements to scale") else float(title.split("× ")[1])


def fans(axes: Axes) -> list[np.ndarray]:
    """Corners of the filled fans."""
    filled = [patch for patch in axes.patches if isinstance(patch, Polygon)]
    return [
        patch.get_xy() for patch in filled if patch.get_facecolor()[:3] == pytest.approx((0xD5 / 255, 0x5E / 255, 0))
    ]


@cache
def page_of(draw: Callable[[CaseResults], Figure], name: str) -> Figure:
    """A page that several tests look at, laid out."""
    page = draw(solved(name))
    page.draw_without_rendering()
    return page


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("draw", [figure_of_contacts, figure_of_stresses])
def test_all_panels_have_equal_limits_and_sizes(name: str, draw):
    """So the undeformed body is drawn at one scale and one place; no fan is cut off."""
    figure = page_of(draw, name)
    panels = figure.axes[: len(solved(name).results)]
    assert len({axes.axis() for axes in panels}) == 1
    sizes = np.array([axes.get_window_extent().size for axes in panels])
    assert sizes == pytest.approx(np.tile(sizes[0], (len(panels), 1)), abs=1.0)
    left, right, low, high = panels[0].axis()
    for corners in (corners for axes in panels for corners in fans(axes)):
        assert ((corners >= (left, low)) & (corners <= (right, high))).all()


@pytest.mark.slow
def test_fans_are_as_long_as_their_pressures():
    """Block between a press and a table: the largest pressures are 150, 100, 200 and 150 MPa by statics."""
    figure = page_of(figure_of_contacts, "body_between_two_tools")
    lengths = [max(np.ptp(corners[:, 1]) for corners in fans(axes)) for axes in figure.axes]
    displaced = 0.02 * max(lengths)  # the feet of a fan are displaced
    assert np.array(lengths) / lengths[2] == pytest.approx([0.75, 0.5, 1.0, 0.75], abs=displaced / lengths[2])


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("measure", [StressMeasure.VON_MISES, StressMeasure.YY])
def test_stresses_have_one_panel_a_case_and_one_scale(name: str, measure: StressMeasure):
    """One bar; equal colors of equal stresses; the scale is the largest that a case has alone."""
    cases = solved(name)
    figure = figure_of_stresses(cases, measure)
    *panels, bar = figure.axes
    assert [axes.get_title(loc="left").split("\n")[0] for axes in panels] == [*cases.results]
    assert bar.get_ylabel() == f"{measure.words} [MPa]"
    drawn = [contours(axes) for axes in panels]
    for item in drawn:
        assert list(item.levels) == list(drawn[0].levels)
        assert (item.norm.vmin, item.norm.vmax, item.extend) == (
            drawn[0].norm.vmin,
            drawn[0].norm.vmax,
            drawn[0].extend,
        )
    factor = factor_of(figure)
    alone = [color_scale([result], measure, factor).levels[-1] for result in cases.results.values()]
    assert drawn[0].levels[-1] == max(alone)


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
def test_displacements_have_one_magnification(name: str):
    """It is the smallest that a case has alone, so that no body reaches far through a surface."""
    results = solved(name).results.values()
    figure = page_of(figure_of_stresses, name)
    factor = factor_of(figure)
    assert factor == min(magnification([result]) for result in results)
    for axes, result in zip(figure.axes, results, strict=False):
        assert result.boundary is not None
        moved = result.boundary.points + factor * result.boundary.displacement
        assert off(moved, outlines(axes, BLACK)) < 1e-12 * np.ptp(result.boundary.points)


def test_a_case_without_displacements_sets_no_magnification():
    one = solved("body_between_two_tools").results["raised"]
    assert one.boundary is not None
    still = replace(one, boundary=replace(one.boundary, displacement=np.zeros_like(one.boundary.displacement)))
    assert magnification([still, one]) == magnification([one]) > 1
    assert magnification([still]) == 1


@pytest.mark.slow
def test_each_panel_marks_the_largest_stress_or_those_that_are_infinite():
    """Rings where stress is finite but not the same all over; crosses below the edges of the sharp punch."""
    cases = solved("body_between_two_tools")
    for axes, (name, result) in zip(
        page_of(figure_of_stresses, "body_between_two_tools").axes, cases.results.items(), strict=False
    ):
        rings = [line for line in axes.lines if line.get_marker() == "o"]
        same = name == "raised"  # a constant pressure
        assert bool(rings) != same
        assert ("the same all over" in axes.get_title(loc="left")) == same
        assert ("about" in axes.get_title(loc="left")) != same
        assert not [line for line in axes.lines if line.get_marker() == "x" and len(line.get_xydata())]
        assert not (result.triangulated.stress.kind == PointKind.SINGULAR).any()
    cases = solved("eccentric_punch")
    figure = page_of(figure_of_stresses, "eccentric_punch")
    assert "crosses: infinite stress" in figure.get_suptitle()
    for axes, result in zip(figure.axes, cases.results.values(), strict=False):
        body = result.triangulated
        infinite = body.stress.kind == PointKind.SINGULAR
        (crosses,) = [np.asarray(line.get_xydata()) for line in axes.lines if line.get_marker() == "x"]
        assert crosses == pytest.approx((body.points + factor_of(figure) * body.displacement)[infinite])
        assert not [line for line in axes.lines if line.get_marker() == "o"]


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("draw", [figure_of_contacts, figure_of_stresses, figures.figure_of])
def test_titles_and_labels_lie_in_the_figure_and_apart(name: str, draw):
    figure = page_of(draw, name)
    page = figure.bbox.padded(1.0)
    titles = [axes._left_title for axes in figure.axes if axes.get_title(loc="left")]  # pyright: ignore
    labels = [label for axes in figure.axes for label in (axes.xaxis.label, axes.yaxis.label) if label.get_text()]
    heads = [part._suptitle for part in (figure, *figure.subfigs) if part.get_suptitle()]
    boxes = [text.get_window_extent() for text in (*titles, *labels, *heads)]
    for box in boxes:
        assert page.x0 <= box.x0 and box.x1 <= page.x1  # noqa: PT018
        assert page.y0 <= box.y0 and box.y1 <= page.y1  # noqa: PT018
    assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))


@pytest.mark.slow
def test_the_figure_of_load_cases_shows_the_stress_that_was_asked_for():
    labels = [axes.get_ylabel() for axes in figures.figure_of(solved("eccentric_punch"), StressMeasure.MAX_SHEAR).axes]
    assert labels.count("largest shear stress [MPa]") == 1
