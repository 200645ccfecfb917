"""Pictures of a mesh study in a size for pages and telephones, of the iterations, and of convergence with the mesh."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, NullLocator

from bemcontact.analysis.mesh_study import MeshLevel, MeshStudy
from bemcontact.assessment.comparison import Contender
from bemcontact.assessment.convergence import Convergence
from bemcontact.bem import mesh
from bemcontact.contact.solution import Trace
from bemcontact.options import Weights
from bemcontact.problems import Problem
from bemcontact.report.figures.comparison import draw_differences, draw_gaps, draw_pressures
from bemcontact.report.figures.deformed import draw_deformed
from bemcontact.report.figures.page import (
    BLACK,
    COLOURS,
    CYCLE,
    legend_below,
    new_page,
    plain,
    short_label,
    show_decades,
)
from bemcontact.report.figures.problem import draw_problem

WIDTH = 5.2
"""Inches of a picture: its text can be read on a telephone, and two stand side by side on a page."""
WIDE, SLENDER = 9.5, 2.5
"""Inches of the picture of a slender body, and how many times it is wider than high."""
ROUND_OFF = 1e-12
"""Difference of pressures over the peak that is not worth a picture."""


def figures_of(study: MeshStudy) -> dict[str, Figure]:
    """Make all pictures of a mesh study, by name; the finest mesh is drawn.

    Names are "problem" and "deformed" (if a body is known), "pressure", "gap", "difference" (if there is any),
    "history-qp1" and so on, with the weights if they are not tributary (if histories were recorded), and "convergence"
    (of several meshes).
    """
    level, figures = study.finest, dict[str, Figure]()
    if study.problem is not None:
        figures["problem"] = plan_of(study.problem)
    for name, draw in (("pressure", draw_pressures), ("gap", draw_gaps)):
        figures[name], axes = _page(3.9)
        draw(axes, level)
    if level.answer.boundary is not None:
        figures["deformed"], axes = _page(4.2)
        draw_deformed(axes, level.answer)
    if max((item.largest for item in level.comparison.differences), default=0.0) > ROUND_OFF:
        figures["difference"], axes = _page(3.9)
        draw_differences(axes, level)
    for name, contenders in _recorded(level).items():
        figures[f"history-{name}"], axes = _page(3.4)
        draw_history(axes, contenders)
    if study.convergence is not None:
        figures["convergence"], axes = _page(3.9)
        draw_convergence(axes, study.convergence)
    return figures


def _recorded(level: MeshLevel) -> dict[str, list[Contender]]:
    """Contenders with a recorded history, by formulation and weights."""
    groups = dict[str, list[Contender]]()
    for item in level.comparison.everyone:
        options = item.attempt.options
        if item.assessment is not None and item.assessment.solution.history:
            weights = "" if options.weights is Weights.TRIBUTARY else f"-{options.weights.replace('_', '-')}"
            name = options.formulation.value if options.uses("weights") else "direct"
            groups.setdefault(f"{name}{weights}", []).append(item)
    return groups


def _page(height: float) -> tuple[Figure, Axes]:
    """Make a picture without a layout engine; it is cut to its content when it is written."""
    figure = new_page(WIDTH, height)
    figure.set_layout_engine("none")
    return figure, figure.add_subplot()


def plan_of(problem: Problem) -> Figure:
    """Draw geometry, mesh and conditions, with the legend below; slender bodies get a wider picture."""
    built = mesh.build(problem)
    width, height = np.ptp(built.nodes, axis=0)
    figure = new_page(WIDE if width > SLENDER * height else 6.2, 1.6 + float(np.clip(4.8 * height / width, 3.2, 7.0)))
    figure.set_layout_engine("none")
    axes = figure.add_subplot()
    draw_problem(axes, problem, built)
    legend = axes.get_legend()
    assert legend is not None  # edges have roles
    axes.apply_aspect()
    inches = axes.get_position().height * figure.get_figheight()
    axes.legend(
        handles=legend.legend_handles,
        loc="upper center",
        bbox_to_anchor=(0.5, -0.5 / inches),
        ncols=3,
        frameon=False,
        fontsize=9,
    )
    return figure


QUANTITY_DASHES = {"objective": "solid", "infeasibility": "dashed", "residual": "dotted"}

FEW = 30
"""Iterations that are few enough for a dot each."""
BELOW_ZERO = -1e-11
"""An objective below this is not zero to round-off."""


def draw_history(axes: Axes, contenders: Sequence[Contender]) -> None:
    """Draw the magnitude of each recorded quantity over the iterations of contenders of one formulation.

    The objective is zero at the contact state (nearly so with other weights than tributary ones). Markers show where it
    is negative. Contenders without a history are left out.
    """
    recorded = [item for item in contenders if item.assessment is not None and item.assessment.solution.history]
    below_zero = False
    for order, contender in enumerate(recorded):
        alone = COLOURS[contender.attempt.options.formulation] if len(recorded) == 1 else None
        color = alone or CYCLE[order % len(CYCLE)]
        for trace in contender.assessment.solution.history if contender.assessment else ():
            label = trace.quantity if alone else plain(f"{contender.label}: {trace.quantity}")
            below_zero |= _draw_trace(axes, trace, color, label)
    if below_zero:
        axes.scatter([], [], s=16, marker="v", facecolors="white", edgecolors=BLACK, label="objective below zero")
    show_decades(axes)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("iteration")
    axes.set_ylabel("size, free of units")
    legend_below(axes)


def _draw_trace(axes: Axes, trace: Trace, color: str, label: str) -> bool:
    """Draw the magnitude of one quantity; return whether it is an objective with negative values."""
    values = np.array(trace.values)
    iteration = trace.first + np.arange(len(values))
    size = np.where(values != 0, np.abs(values), np.nan)
    mark, dashes = "." if len(values) < FEW else "none", QUANTITY_DASHES[trace.quantity]
    axes.plot(iteration, size, color=color, linestyle=dashes, linewidth=1.4, marker=mark, label=label)
    below = (values < BELOW_ZERO) & (trace.quantity == "objective")
    axes.scatter(iteration[below], size[below], s=16, marker="v", facecolors="white", edgecolors=color, zorder=3)
    return bool(below.any())


def draw_convergence(axes: Axes, convergence: Convergence) -> None:
    """Draw the distance of each quantity from its limit over the refinement, with the observed order."""
    refine = np.array(convergence.refine, float)
    for order, item in enumerate(convergence.quantities):
        if item.limit is None:
            continue
        distance = np.abs(np.array(item.values) - item.limit) / (abs(item.limit) or 1.0)
        distance = np.where(distance > 0, distance, np.nan)
        q = next((q for q in reversed(item.orders) if q is not None), None)
        order_text = "" if q is None else f", order {q:.2g}"
        color = CYCLE[order % len(CYCLE)]
        label = short_label(f"{item.name}{order_text}", 48)
        axes.plot(refine, distance, color=color, marker="o", markersize=5, linewidth=1.5, label=label)
    axes.set_xscale("log")
    show_decades(axes)
    axes.set_xticks(refine, [f"{parts:g}" for parts in refine])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xlabel("parts into which each element is cut")
    axes.set_ylabel("distance from the limit, relative")
    legend_below(axes)
