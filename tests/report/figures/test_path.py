"""The picture of a load path shows what the path is."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from mesh_studies import punch
from results import linked

import bemcontact
from bemcontact.assessment.accuracy import Accuracy, ErrorBar
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.report import figures
from bemcontact.report.path_text import path_sentence

MODELS = Path(__file__).parents[3] / "models"


@pytest.fixture(scope="module")
def link() -> ParameterPath:
    return linked()


@pytest.fixture(scope="module")
def page(link: ParameterPath) -> Figure:
    return figures.figure_of_path(link)


@pytest.fixture(scope="module")
def pictures(link: ParameterPath) -> dict[str, Figure]:
    return figures.figures_of_path(link)


@pytest.mark.slow
def test_page_has_a_picture_of_each_zone(page: Figure):
    labels = [axes.get_ylabel() for axes in page.axes]
    assert labels == ["peak pressure [MPa]", "resultant [N/mm]", *(f"distance along {zone} [mm]" for zone in
                      ("drum", "table", "wall"))]  # fmt: skip
    assert page.axes[-1].get_xlabel() == "conditions.loaded.pressure"


def test_lines_are_the_states(link: ParameterPath, page: Figure):
    line, dots, *_ = page.axes[0].lines
    np.testing.assert_array_equal(line.get_xydata(), [(state.value, state.peak) for state in link.states])
    np.testing.assert_array_equal(dots.get_xydata(), [(state.value, state.peak) for state in link.breakpoints])
    drum = page.axes[1].lines[0]
    assert np.asarray(drum.get_ydata())[-1] == pytest.approx(250, rel=1e-3)  # statics, 0.1 % for the bent link
    start, start_dots, end, end_dots = page.axes[2].lines[-4:]
    assert len(start_dots.get_xydata()) == len(end_dots.get_xydata()) > 2
    interval = link.states[-1].footprint.intervals[0]
    assert np.asarray(start.get_ydata())[-1] == interval.start_arc
    assert np.asarray(end.get_ydata())[-1] == interval.end_arc


def test_verdict_is_a_sentence(link: ParameterPath):
    assert path_sentence(link).startswith("Each state from 0 to 20 is proved to be the only contact state.")


@pytest.mark.slow
def test_a_path_that_is_too_coarse_between_its_ends_is_drawn(link: ParameterPath):
    """A bar of 1 at one breakpoint makes it too coarse there: the verdict is the last line of the title."""
    bar = ErrorBar(quantity="peak", zone="drum", value=1.0, bar=1.0)
    accuracy = Accuracy(asked=0.01, met=True, bars=(replace(bar, bar=0.0),))
    coarse = replace(
        link, start_accuracy=accuracy, end_accuracy=accuracy, breakpoint_bars=((bar,),) * len(link.breakpoints)
    )
    title = figures.figure_of_path(coarse).axes[0].get_title()
    assert coarse.coarse
    assert title.endswith("mesh: too coarse between the ends")
    unknown = replace(coarse, breakpoint_bars=())
    assert figures.figure_of_path(unknown).axes[0].get_title().endswith("mesh: not assessed between the ends")


def test_errors_of_forces_and_ends_are_bars(link: ParameterPath):
    """A bar of a force is relative to it, one of an end to the length of its interval."""
    last = link.states[-1]
    ((start,), (end,)), force = last.ends("table"), float(np.hypot(*last.resultant[1]))
    bars = (
        ErrorBar(quantity="force", zone="table", value=force, bar=0.02),
        ErrorBar(quantity="start", zone="table", interval=0, value=start, bar=0.03),
        ErrorBar(quantity="end", zone="table", interval=0, value=end, bar=0.05),
        ErrorBar(quantity="end", zone="drum", interval=0, value=end, bar=None),
    )
    known = replace(link, breakpoint_bars=(*((),) * (len(link.breakpoints) - 1), bars))
    drawn = []
    for draw in (figures.draw_resultants, lambda axes, path: figures.draw_interval_ends(axes, path, "table")):
        axes = Figure().add_subplot()
        draw(axes, known)
        drawn.append([bar for it in axes.collections if isinstance(it, LineCollection) for bar in it.get_segments()])
    length = end - start
    np.testing.assert_allclose(drawn[0], [[(20, 0.98 * force), (20, 1.02 * force)]])
    expected = [[(20, y - error * length), (20, y + error * length)] for y, error in ((start, 0.03), (end, 0.05))]
    np.testing.assert_allclose(drawn[1], expected)


def test_accuracies_of_both_ends_are_in_the_title(page: Figure):
    title = page.axes[0].get_title()
    assert "unique solution proved" in title
    assert all(f"at {value}: " in title for value in (0, 20))


@pytest.mark.slow
def test_an_infinite_peak_is_not_drawn():
    path = bemcontact.follow(punch(), "conditions.top.pressure", 1.0)
    peaks, forces, _ = figures.figure_of_path(path).axes
    assert not peaks.lines
    assert "infinite in foot" in [text.get_text() for text in peaks.texts]
    assert np.asarray(forces.lines[0].get_ydata())[[0, -1]] == pytest.approx([30, 10])  # statics
    assert path.start_accuracy.met
    assert path.end_accuracy.met


@pytest.mark.slow
def test_the_start_of_a_path_is_at_the_left_though_its_value_falls():
    problem = bemcontact.load(MODELS / "gallery" / "three_zones.yaml", variant="stated mesh")
    unloaded = bemcontact.follow(problem, "conditions.loaded.pressure", 10, start=20)
    for name, figure in figures.figures_of_path(unloaded).items():
        if name != "pressure":
            left, right = figure.axes[0].get_xlim()
            assert left > 20 > 10 > right


def test_moments_are_those_of_the_states(link: ParameterPath, pictures: dict[str, Figure]):
    """Curves equal data; that the moments are those of the forces is tested with the path."""
    lines = pictures["moment"].axes[0].lines[::2]
    for order, line in enumerate(lines):
        moments = np.array([state.moments[order] for state in link.states])
        np.testing.assert_allclose(line.get_ydata(), moments, rtol=0, atol=1e-12 * np.abs(moments).max())


def test_panels_are_states_of_the_path(link: ParameterPath, pictures: dict[str, Figure]):
    """The first and the last panel are the ends; all have one scale, the largest pressure in it."""
    panels = pictures["pressure"].axes
    first, last = (link.path.pressure[i] for i in (0, -1))
    for axes, pressure in ((panels[0], first), (panels[-1], last)):
        drawn = np.concatenate([np.asarray(line.get_ydata()) for line in axes.lines])
        np.testing.assert_allclose(np.sort(drawn), np.sort(pressure), atol=1e-12 * last.max())
    assert len({axes.get_ylim() for axes in panels}) == 1
    assert panels[0].get_ylim()[1] > last.max()
    assert [panels[0].get_title(loc="left"), panels[-1].get_title(loc="left")] == ["at 0", "at 20"]


def test_breakpoints_with_too_large_an_error_are_hollow(link: ParameterPath):
    """The error asked is 1 %: of bars of 100 % and of 0.1 % at every other breakpoint, the first ones are hollow."""
    bars = [ErrorBar(quantity="peak", zone="drum", value=1.0, bar=bar) for bar in (1.0, 0.001)]
    accuracy = Accuracy(asked=0.01, met=True, bars=(bars[1],))
    known = tuple((bars[i % 2],) for i in range(len(link.breakpoints)))
    coarse = replace(link, start_accuracy=accuracy, end_accuracy=accuracy, breakpoint_bars=known)
    axes = figures.figures_of_path(coarse)["peak"].axes[0]
    ranges, hollow = axes.collections
    assert isinstance(ranges, LineCollection)
    wanted = [state for i, state in enumerate(coarse.breakpoints) if not i % 2 and state in coarse.pressed]
    np.testing.assert_array_equal(hollow.get_offsets(), [(state.value, state.peak) for state in wanted])
    assert len(ranges.get_segments()) == len(coarse.pressed)


@pytest.mark.slow
def test_panels_have_one_scale_unless_both_ends_are_hidden_in_it(link: ParameterPath):
    """A beam first touches with its tip, under a pressure 30 times the last one: each panel has its own scale."""
    beam = bemcontact.load(MODELS / "cantilever_flat_surface.yaml", variant="stated mesh")
    for path, alike in ((link, True), (bemcontact.follow(beam, "conditions.top.traction.y", -3.6, start=0), False)):
        figure = figures.figures_of_path(path)["pressure"]
        tops = [axes.get_ylim()[1] for axes in figure.axes]
        assert (len({*tops}) == 1) == alike
        for axes, top in zip(figure.axes, tops, strict=True):
            assert max(float(np.max(line.get_ydata())) for line in axes.lines) <= top
        assert ("scale of its own" in str(figure.get_supylabel())) != alike


def test_round_off_is_drawn_as_zero():
    """The forces of a pin on a ring that is shrunk on it cancel."""
    ring = bemcontact.load(MODELS / "gallery" / "shrink_fit.yaml", variant="stated mesh")
    path = bemcontact.follow(ring, "contact_zones.pin.surface.radius", 10.02, start=10.005)
    for draw in (figures.draw_resultants, figures.draw_moments):
        axes = Figure().add_subplot()
        draw(axes, path)
        assert not np.asarray(axes.lines[0].get_ydata()).any()
