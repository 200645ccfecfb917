"""Pictures as SVG: their colors on light and dark pages, and their paths, which have the points that are seen."""

import re
from itertools import pairwise

import matplotlib.colors
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure
from mesh_studies import on_one_mesh

from bemcontact.report import figures
from bemcontact.report.figures.page import BODIES
from bemcontact.report.figures.svg import UNSEEN, needed


def test_every_color_has_contrast_on_paper_and_in_the_dark():
    """Lines and text against white and the dark page, 3 to 1 as WCAG asks of graphics; fills are only fills."""
    text = figures.vector_graphic(figures.figures_of(on_one_mesh())["pressure"]).decode()
    dark = dict(re.findall(r'\[style\*="stroke: (#\w{6})"\] \{ stroke: (#\w{6})', text))
    page = dark.pop("#ffffff")
    for fill in BODIES:
        dark.pop(fill)
    assert len(dark) == 8
    for there in dark.values():
        assert contrast(there, page) > 4.5
    strokes = {color for color in re.findall(r"stroke: (#\w{6})", text.split("</style>")[1]) if color != "#ffffff"}
    for here in strokes - {"#cc79a7"}:  # of a reference, which is dashed
        assert contrast(here, "#ffffff") > 3


def contrast(one: str, other: str) -> float:
    """Ratio of relative luminances, WCAG 2.2."""

    def luminance(color: str) -> float:
        rgb = np.array(matplotlib.colors.to_rgb(color))
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        return float(linear @ (0.2126, 0.7152, 0.0722))

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.slow
def test_a_picture_has_no_background_and_paths_are_rounded():
    text = figures.vector_graphic(figures.figures_of(on_one_mesh())["gap"]).decode()
    (patch,) = re.findall(r'<g id="patch_1">\s*<path[^>]*style="([^"]*)"', text)
    assert "fill: none" in patch
    assert not re.search(r' d="[^"]*\d\.\d{3}', text)
    assert "screen and (prefers-color-scheme: dark)" in text


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(-50, 50), st.integers(-50, 50)), min_size=1, max_size=40))
def test_points_that_are_left_out_are_beside_the_line(places: list[tuple[int, int]]):
    """Each one is as near as stated to the stretch between its neighbors that are kept."""
    points = np.array(places)
    kept = np.flatnonzero(needed(points))
    assert kept[0] == 0
    assert kept[-1] == len(points) - 1
    for first, last in pairwise(kept):
        stretch = points[first] + np.linspace(0, 1, 2001)[:, None] * (points[last] - points[first])
        for point in points[first:last]:
            assert np.hypot(*(stretch - point).T).min() <= UNSEEN + 0.1


def test_a_line_of_many_points_is_written_with_few_and_ends_where_it_did():
    """A circle in 2000 steps: a chord with a sagitta of 0.04 pt of a radius of 100 pt spans 2 √(2 · 0.04 / 100)."""
    figure = Figure(figsize=(4, 4))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.axis("off")
    axes.set(xlim=(-144, 144), ylim=(-144, 144))
    turn = np.linspace(0, 2 * np.pi, 2001)
    axes.fill(100 * np.cos(turn), 100 * np.sin(turn), color="#d55e00")
    written = figures.vector_graphic(figure).decode()
    (path,) = re.findall(r'd="M([^"]*)z" [^>]*style="fill: #d55e00', written)
    steps = np.array(re.findall(r"-?(?:\d+\.?\d*|\.\d+)", path), float).reshape(-1, 2)
    points = np.cumsum(steps, axis=0)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    assert np.hypot(*(points - middle).T) == pytest.approx(100, abs=0.02)
    assert points[-1] == pytest.approx(points[0], abs=0.015)
    least = 2 * np.pi / (2 * np.sqrt(2 * 0.04 / 100))
    assert least < len(points) < 3 * least
