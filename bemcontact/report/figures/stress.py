"""Stress all over the body, as filled contours in the pictures of it."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation, TriContourSet

from bemcontact.analysis.result import Result
from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.contact.stress import PointKind, TriangulatedBody
from bemcontact.frozen import frozen_value
from bemcontact.options import StressMeasure
from bemcontact.report.contact_words import units_of
from bemcontact.report.figures.page import BLACK, PowerInLabel, labeled, plain
from bemcontact.report.figures.problem import polygons_of
from bemcontact.report.figures.surfaces import bent
from bemcontact.report.formatting import number, with_unit

BESIDE = 0.1
"""Distance from an infinite stress over the size of what is shown within which no value sets the scale."""
UNSEEN = 0.003
"""Share of the area that is shown on which stress may be beyond the scale."""
UNIFORM = 1e-6
"""Relative difference of stresses that is round-off."""
SAME, LARGEST = "the stress is the same all over", "ring: largest stress"
FIGURES = 2
"""Digits of the largest stress that samples of it give."""
LEVELS = 10
"""About as many levels of color."""
COLOURS, BOTH_SIGNS = "viridis", "RdBu_r"
"""Color maps of equivalent stresses, and of components, whose zero is white."""


def fill_with_stress(
    axes: Axes,
    result: Result,
    measure: StressMeasure,
    factor: float = 1.0,
    window: Array | None = None,
) -> str:
    """Fill the deformed body with contours of a stress; mark the largest and infinite ones.

    Displacements are magnified by the factor. The colors are for what is inside the `window`, two corners (2, 2).
    Their scale is for all values but those on a small part of the area, and beside places where stress is infinite.
    The words that are returned say what is marked, and how large the largest is: colors end below it.
    """
    scale = color_scale([result], measure, factor, window)
    drawn, words, largest = fill_body(axes, result, scale, factor, window)
    add_bar([axes], drawn, result, scale)
    return f"{words}, {largest}" if largest else words


@frozen_value
class ColorScale:
    """Colors of a stress: between levels (l,), and those of stress beyond them."""

    measure: StressMeasure
    levels: Array
    extend: Literal["neither", "both", "max"]


def color_scale(
    results: Sequence[Result], measure: StressMeasure, factor: float = 1.0, window: Array | None = None
) -> ColorScale:
    """Choose the colors of a stress for bodies side by side; arguments are as of `fill_with_stress`."""
    size, most = 0.0, 0.0
    for result in results:
        body, points, values, shown, infinite = _stresses(result, measure, factor, window)
        extent = float(np.hypot(*np.ptp(points if window is None else window, axis=0)))
        counts = shown & ~infinite & ~_beside(points, points[infinite], BESIDE * extent)
        counts = counts if counts.any() else shown & ~infinite
        size = max(size, _seen(points, body.triangles, np.where(counts, np.abs(values), 0.0)))
        most = np.inf if infinite.any() else max(most, float(values.max()))
    size = size or 1.0
    low = -size if measure.signed else 0.0
    levels = np.asarray(MaxNLocator(LEVELS, steps=[1, 2, 2.5, 5, 10]).tick_values(low, size))
    extend = "both" if measure.signed else "max" if most > levels[-1] else "neither"
    return ColorScale(measure=measure, levels=levels, extend=extend)


def fill_body(
    axes: Axes, result: Result, scale: ColorScale, factor: float = 1.0, window: Array | None = None
) -> tuple[TriContourSet, str, str]:
    """Fill and mark the body as `fill_with_stress` does, in given colors.

    Return the contours, what is marked, and the largest stress in words if it is marked.
    """
    body, points, values, shown, infinite = _stresses(result, scale.measure, factor, window)
    triangles = Triangulation(points[:, 0], points[:, 1], body.triangles)
    drawn = axes.tricontourf(
        triangles, np.where(infinite, 2.0 * scale.levels[-1], values), levels=scale.levels, extend=scale.extend,
        cmap=BOTH_SIGNS if scale.measure.signed else COLOURS, zorder=0,
    )  # fmt: skip
    drawn.set(edgecolor="face", linewidth=0.3)  # or the page is seen between two colors
    finite = shown & ~infinite
    words = _mark(axes, points[finite], np.abs(values[finite]), points[infinite & shown])
    if words != LARGEST:
        return drawn, words, ""
    largest = float(values[finite][np.abs(values[finite]).argmax()])
    rounded = number(float(f"{largest:.{FIGURES}g}"))  # of samples, which may be a little below the largest
    return drawn, words, f"about {with_unit(rounded, plain(units_of(result.contact).stress))}"


def _stresses(
    result: Result, measure: StressMeasure, factor: float, window: Array | None
) -> tuple[TriangulatedBody, Array, Array, BoolArray, BoolArray]:
    """Triangles, displaced corners (k, 2), stress (k,) there, which of them are shown, and where it is infinite."""
    body = result.triangulated
    points = body.points + factor * body.displacement + _bending(result, body, factor)
    values = body.stress.measured(measure)
    shown = np.ones(len(points), bool)
    if window is not None:
        shown = np.all((points >= window[0]) & (points <= window[1]), axis=1)
    return body, points, values, shown, body.stress.kind == PointKind.SINGULAR


def _bending(result: Result, body: TriangulatedBody, factor: float) -> Array:
    """Displacement (k, 2) that magnifies initial gaps at the points of the bodies, see `bent`."""
    problem, state, moves = result.problem, result.boundary, np.zeros_like(body.points)
    if problem is None or state is None or factor == 1 or not problem.contacts:
        return moves
    rim = np.array([problem.part_of(name) for name in state.edge_names])[state.edge[body.element]]
    for part, loops in zip(problem.parts, polygons_of(problem), strict=True):
        inside = np.logical_xor.reduce([Path(loop).contains_points(body.points) for loop in loops])
        own = np.append(rim == part.name, inside[len(rim) :])
        moves[own] = bent(result, part.name, body.points[own], factor)
    return moves


def _seen(points: Array, triangles: IntArray, sizes: Array) -> float:
    """The size of a stress that is exceeded on a part of the area too small to be seen."""
    (ax, ay), (bx, by), (cx, cy) = points[triangles].transpose(1, 2, 0)
    area = np.abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
    mean = sizes[triangles].mean(axis=1)
    order = np.argsort(mean)
    within = area[order] * (mean[order] > 0)
    beyond = np.searchsorted(np.cumsum(within), (1 - UNSEEN) * within.sum())
    return float(sizes[triangles[order[: beyond + 1]]].max(initial=0.0))


def _beside(points: Array, places: Array, distance: float) -> BoolArray:
    """Which points (k, 2) are nearer to one of the places (s, 2)."""
    if not len(places):
        return np.zeros(len(points), bool)
    return np.hypot(*(points[:, None] - places).transpose(2, 0, 1)).min(axis=1) < distance


def _mark(axes: Axes, points: Array, sizes: Array, infinite: Array) -> str:
    """Mark infinite stress by crosses; if there is none, the largest by a ring, unless stress is the same all over."""
    words = "crosses: infinite stress"
    if not len(infinite):
        at = int(np.argmax(sizes))
        if np.ptp(sizes) <= UNIFORM * sizes[at]:
            return SAME
        words = LARGEST
        for color, width, order in (("white", 2.6, 5), (BLACK, 1.2, 6)):
            axes.plot(
                *points[at], marker="o", markersize=8, markerfacecolor="none", markeredgecolor=color,
                markeredgewidth=width, zorder=order,
            )  # fmt: skip
    axes.plot(*infinite.T, linestyle="none", marker="x", markersize=7, markeredgewidth=1.8, color=BLACK, zorder=6)
    return words


def add_bar(places: Sequence[Axes], drawn: TriContourSet, result: Result, scale: ColorScale) -> None:
    """Add the scale of colors beside axes; it is that of all of them."""
    figure = places[0].get_figure(root=False)
    assert figure is not None
    bar = figure.colorbar(drawn, ax=[*places], fraction=0.045, pad=0.02, shrink=0.9, format=PowerInLabel())
    bar.set_label(labeled(scale.measure.words, units_of(result.contact).stress), fontsize=9)
    bar.ax.tick_params(labelsize=8.5)
    bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue]
