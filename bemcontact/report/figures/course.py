"""The pictures of what happened in turn: solvers iteration by iteration, the answer mesh by mesh."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator

from bemcontact.assessment.comparison import Contender
from bemcontact.assessment.convergence import Convergence
from bemcontact.contact.solution import Trace
from bemcontact.options import FormulationName
from bemcontact.report.figures.page import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, plain, shortened

COLOURS = {
    FormulationName.QP1: VERMILION,
    FormulationName.QP2: BLUE,
    FormulationName.QP3: BLACK,
    FormulationName.COMPLEMENTARITY: GREY,
}
CYCLE = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)
QUANTITY_DASHES = {"objective": "solid", "infeasibility": "dashed", "residual": "dotted"}

FEW = 30
"""Iterations that are few enough for a dot each."""
BELOW_ZERO = -1e-11
"""An objective below this is not zero to round-off."""


def draw_history(axes: Axes, contenders: Sequence[Contender]) -> None:
    """Draw the size of what each solver recorded, iteration by iteration.

    The objective is zero at the contact state, so its size is the distance from there (with weights that are not
    tributary nearly so); where it is below zero it is marked.

    Parameters
    ----------
    axes : to draw into
    contenders : of one formulation; those without a history are left out
    """
    told = [item for item in contenders if item.judged is not None and item.judged.solution.history]
    below_zero = False
    for order, contender in enumerate(told):
        alone = COLOURS[contender.found.options.formulation] if len(told) == 1 else None
        colour = alone or CYCLE[order % len(CYCLE)]
        for trace in contender.judged.solution.history if contender.judged else ():
            label = trace.quantity if alone else plain(f"{contender.label}: {trace.quantity}")
            below_zero |= _draw_trace(axes, trace, colour, label)
    if below_zero:
        axes.scatter([], [], s=16, marker="v", facecolors="white", edgecolors=BLACK, label="objective below zero")
    show_decades(axes)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("iteration")
    axes.set_ylabel("size, free of units")
    legend_below(axes)


def _draw_trace(axes: Axes, trace: Trace, colour: str, label: str) -> bool:
    """Draw the size of one quantity, with marks where an objective is below zero; tell whether it is."""
    values = np.array(trace.values)
    iteration = trace.first + np.arange(len(values))
    size = np.where(values != 0, np.abs(values), np.nan)
    mark, dashes = "." if len(values) < FEW else "none", QUANTITY_DASHES[trace.quantity]
    axes.plot(iteration, size, color=colour, linestyle=dashes, linewidth=1.4, marker=mark, label=label)
    below = (values < BELOW_ZERO) & (trace.quantity == "objective")
    axes.scatter(iteration[below], size[below], s=16, marker="v", facecolors="white", edgecolors=colour, zorder=3)
    return bool(below.any())


def draw_convergence(axes: Axes, convergence: Convergence) -> None:
    """Draw how far each quantity that shows an order is from its limit, over the refinement, with that order."""
    refine = np.array(convergence.refine, float)
    for order, item in enumerate(convergence.quantities):
        if item.limit is None:
            continue
        distance = np.abs(np.array(item.values) - item.limit) / (abs(item.limit) or 1.0)
        distance = np.where(distance > 0, distance, np.nan)
        q = next((q for q in reversed(item.orders) if q is not None), None)
        told = "" if q is None else f", order {q:.2g}"
        colour = CYCLE[order % len(CYCLE)]
        label = shortened(f"{item.name}{told}", 48)
        axes.plot(refine, distance, color=colour, marker="o", markersize=5, linewidth=1.5, label=label)
    axes.set_xscale("log")
    show_decades(axes)
    axes.set_xticks(refine, [f"{parts:g}" for parts in refine])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xlabel("parts into which each element is cut")
    axes.set_ylabel("distance from the limit, relative")
    legend_below(axes)


def show_decades(axes: Axes) -> None:
    """Make the vertical axis logarithmic, with a few decades in plain letters, which are drawn fast.

    Where all that is drawn is zero, that is said instead.
    """
    if not any((np.asarray(line.get_ydata(), float) > 0).any() for line in axes.lines):
        axes.text(0.5, 0.5, "zero, to the last digit", transform=axes.transAxes, ha="center", color=BLACK)
        return
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0e}"))


def legend_below(axes: Axes) -> None:
    """Put the legend below the axes, where nothing is covered."""
    axes.spines[["top", "right"]].set_visible(False)
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        columns = 3 if max(map(len, labels)) < 14 else 2 if max(map(len, labels)) < 30 else 1
        axes.legend(loc="upper center", bbox_to_anchor=(0.45, -0.2), ncols=columns, frameon=False, fontsize=8.5)
