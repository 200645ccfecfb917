"""The figures of the paper drawn again: pressure over the paper's coordinate beside reference values."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.analysis.reproduction import PaperStudy, Reproduction, Run, positions
from bemcontact.problems import Table
from bemcontact.reference import Expected
from bemcontact.report.figures.mesh_study import WIDTH, plan_of
from bemcontact.report.figures.page import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    VERMILION,
    labeled,
    legend_below,
    name_axis,
    new_page,
)
from bemcontact.report.formatting import number

MESHES = (BLUE, VERMILION, GREEN)
"""Colors of the meshes of the problem as stated, the coarsest first."""
MARKERS = ("s", "D", "^")
"""Markers of the variants."""
SINGLE = ("dotted", (0, (5, 2)), (0, (6, 1.5, 1.5, 1.5)), (0, (9, 2)))
"""Line styles of single values of references."""
ABOVE = 1.12
"""Height of the frame over the largest pressure in it."""
WINDOW_HEIGHT = 2.6
"""Inches that the narrow axis of a figure takes."""


def figures_of_reproduction(reproduction: Reproduction) -> dict[str, Figure]:
    """Make the pictures MODEL-pressure, the figure of the paper, and MODEL-problem, with - for _ in MODEL."""
    figures = dict[str, Figure]()
    for item in reproduction.problems:
        name = item.paper.model.replace("_", "-")
        figures[f"{name}-problem"] = plan_of(item.problem)
        figures[f"{name}-pressure"] = _figure_of(item)
    return figures


def _figure_of(item: PaperStudy) -> Figure:
    """Draw the pressure, and below it the pressure in the frame of the paper's figure if that is a narrow one."""
    window = WINDOW_HEIGHT if item.paper.frame else 0.0
    figure = new_page(WIDTH + 0.6, 3.9 + window)
    figure.set_layout_engine("none")
    grid = figure.add_gridspec(2 if window else 1, 1, height_ratios=[3.9, window] if window else [1.0], hspace=0.16)
    axes = figure.add_subplot(grid[0])
    draw_against(axes, item)
    lowest = axes
    if item.paper.frame:
        lowest = figure.add_subplot(grid[1], sharex=axes)
        draw_against(lowest, item)
        lowest.set_ylim(*item.paper.frame)
        lowest.set_title(f"the axis of the paper's {item.paper.figure}", loc="left", fontsize=9, color=BLACK)
        lowest.ticklabel_format(axis="y", useOffset=False)
        axes.tick_params(labelbottom=False)
        axes.set_xlabel("")
        axes.spines[["top", "right"]].set_visible(False)
    legend_below(lowest)
    return figure


def draw_against(axes: Axes, item: PaperStudy) -> None:
    """Draw pressure over the paper's coordinate: variants as markers, meshes as lines, references in purple or gray."""
    for order, run in enumerate(run for run in item.variant_runs if run.level.answer.footprint.intervals):
        axes.plot(
            *_curve(run, item), linestyle="none", marker=MARKERS[order % len(MARKERS)], markersize=5.5,
            markerfacecolor="none", markeredgecolor=(GREEN, ORANGE)[order % 2], label=run.label, zorder=3,
        )  # fmt: skip
    for order, run in enumerate(item.meshes):
        last = order == len(item.meshes) - 1
        axes.plot(
            *_curve(run, item), color=MESHES[order % len(MESHES)], linewidth=1.3 if last else 2.6,
            marker="" if last and order else ".", label=run.label, zorder=2.2 + 0.1 * order,
        )  # fmt: skip
    singles = 0
    for known in item.meshes[-1].level.expected:
        singles = _draw_reference(axes, known, item, singles)
    units = item.problem.units
    name_axis(axes.xaxis, labeled(item.paper.symbol, item.coordinate_unit))
    name_axis(axes.yaxis, labeled("pressure", units.stress) + "\nper undeformed length")
    axes.axhline(0, color=GREY, linewidth=0.8, zorder=1)
    axes.set_ylim(bottom=0, top=ABOVE * max(float(np.nanmax(line.get_ydata())) for line in axes.lines))  # pyright: ignore


def _curve(run: Run, item: PaperStudy) -> tuple[np.ndarray, np.ndarray]:
    """Coordinate (n,) and pressure (n,) of the direct solution, in order."""
    here = positions(run.level, item.axis)
    order = np.argsort(here, kind="stable")
    return here[order], run.level.answer.solution.pressure[order]


def _draw_reference(axes: Axes, known: Expected, item: PaperStudy, singles: int) -> int:
    """Draw a reference: a curve, points, or lines at single values; return how many lines there are so far."""
    color, beyond = (PURPLE, "") if known.in_range else (GREY, ", out of its range")
    stated = item.problem.reference[known.name]
    if isinstance(stated, Table):
        position, value = np.array(sorted(stated.pressure)).T
        axes.plot(
            position, value, color=color, linewidth=1.0, linestyle=(0, (2.5, 2)), marker="D", markersize=3.5,
            label=f"{known.name}{beyond}", zorder=3.5,
        )  # fmt: skip
    elif known.closed_form:
        here = positions(item.meshes[-1].level, item.axis)
        order = np.argsort(here, kind="stable")
        label = f"{known.name}{beyond}"
        axes.plot(here[order], known.pressure[order], color=color, linewidth=1.4, linestyle=(0, (2.5, 2)), label=label)
    else:
        single_values = ((known.peak, "peak", axes.axhline), (known.start, "start", axes.axvline))
        for value, what, draw in single_values:
            if value is not None:
                label = f"{known.name}: {what} {number(value)}"
                draw(value, color=color, linewidth=1.3, linestyle=SINGLE[singles % len(SINGLE)], label=label)
                singles += 1
    return singles
