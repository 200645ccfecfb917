"""All pictures of a study, in a size for pages and telephones."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.analysis.study import MeshLevel, Study
from bemcontact.assessment.comparison import Contender
from bemcontact.bem import mesh
from bemcontact.options import Weights
from bemcontact.problem import Problem
from bemcontact.report.figures.comparison import draw_differences, draw_gaps, draw_pressures
from bemcontact.report.figures.course import draw_convergence, draw_history
from bemcontact.report.figures.page import new_page
from bemcontact.report.figures.problem import draw_problem
from bemcontact.report.figures.shape import draw_deformed

WIDTH = 5.2
"""Inches of a picture: its text can be read on a telephone, and two stand side by side on a page."""
WIDE, SLENDER = 9.5, 2.5
"""Inches of the picture of a slender body, and how many times it is wider than high."""
ROUND_OFF = 1e-12
"""Difference of pressures over the peak that is not worth a picture."""


def figures_of(study: Study) -> dict[str, Figure]:
    """Make all pictures of a study.

    Parameters
    ----------
    study : on one mesh or several; the finest is drawn

    Returns
    -------
    dict
        Name -> figure: "problem" and "deformed" (of bodies), "pressure", "gap", "difference" (where there is any),
        "history-qp1" and so on, with the weights if they are not tributary (of what was recorded), "convergence" (of
        several meshes).
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
    """The contenders whose solvers recorded how they got there, by formulation and weights."""
    groups = dict[str, list[Contender]]()
    for item in level.comparison.everyone:
        options = item.found.options
        if item.judged is not None and item.judged.solution.history:
            weights = "" if options.weights is Weights.TRIBUTARY else f"-{options.weights.replace('_', '-')}"
            name = options.formulation.value if options.uses("weights") else "direct"
            groups.setdefault(f"{name}{weights}", []).append(item)
    return groups


def _page(height: float) -> tuple[Figure, Axes]:
    """Make a picture; it is cut to what is drawn when it is written, so that no layout has to be sought."""
    figure = new_page(WIDTH, height)
    figure.set_layout_engine("none")
    return figure, figure.add_subplot()


def plan_of(problem: Problem) -> Figure:
    """Draw geometry, mesh and conditions, with the explanation of the colours below; slender bodies get more room."""
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
