"""Tools and the load case that acts on the picture of what is asked."""

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver
from tool_problems import HELD, HELD_CASES, made

from bemcontact.bem import mesh
from bemcontact.problem import Problem
from bemcontact.report import figures
from bemcontact.report.figures.problem import draw_tools

UNITS = {"units": {"length": "mm", "force": "N"}}


def rows(axes: Axes) -> list[tuple[np.ndarray, np.ndarray]]:
    """Tails (k, 2) and vectors (k, 2) of each row of arrows."""
    quivers = [item for item in axes.collections if isinstance(item, Quiver)]
    return [(np.asarray(item.XY), np.column_stack([np.asarray(item.U), np.asarray(item.V)])) for item in quivers]


def arrows(axes: Axes) -> list[tuple[np.ndarray, np.ndarray]]:
    """Tail (2,) and vector (2,) of each arrow that stands alone."""
    return [(tails[0], vectors[0]) for tails, vectors in rows(axes) if len(tails) == 1]


def picture(problem: Problem) -> Axes:
    return figures.figure_of_problem(problem, mesh.build(problem)).axes[0]


def test_a_force_ends_at_the_point_of_the_tool_and_a_displacement_too():
    """The punch at (1.5, 1) presses down, the table at (0, 0) is displaced up, both into the body."""
    axes = Figure().add_subplot()
    drawn = [*draw_tools(axes, made(HELD))]
    tips = [np.add(tail, vector) for tail, vector in arrows(axes)]
    assert np.array(tips) == pytest.approx(np.array([[1.5, 1.0], [0.0, 0.0]]))
    assert [vector[0] for _, vector in arrows(axes)] == [0, 0]
    assert len(drawn) == 2


def test_a_tool_without_a_point_is_drawn_at_the_middle_of_its_surface_and_a_pull_starts_there():
    """The round punch (1.6, 7), radius 6, is nearest to the middle (1.5, 1) of the edge at 7 - 6 = 1."""
    axes = Figure().add_subplot()
    tools = {"punch": {"zones": "punch", "displacement": {"y": 0.01}}}
    [(_, name)] = draw_tools(axes, made(HELD, tools=tools))
    [(tail, vector)] = arrows(axes)
    direction = np.array([1.5 - 1.6, 1 - 7]) / np.hypot(0.1, 6)
    assert tail == pytest.approx(np.array([1.6, 7]) + 6 * direction)
    assert vector[1] > 0
    assert name.text == "punch\ndisplaced by y = 0.01"


def test_what_is_reported_of_a_tool_is_of_the_case_that_acts():
    texts = [text.get_text() for text in picture(made(HELD, **HELD_CASES, **UNITS, case="push")).texts]
    assert "punch\nloaded by y = -70 N/mm, moment = -1 N" in texts


def test_the_picture_shows_the_conditions_of_the_case_that_acts():
    axes = picture(made(HELD, **HELD_CASES, **UNITS, case="wind"))
    texts = [text.get_text() for text in axes.texts]
    assert axes.get_title(loc="left") == "held block, wind"
    assert "top\npressure 1.5 N/mm² (wind)" in texts
    assert "right\npressure 2 N/mm²\n$t_x$ = 1 N/mm² (wind)\n$t_y$ = -2 N/mm² (wind)" in texts


def test_forces_on_an_edge_add_up_in_the_picture():
    """A pressure of 2 and a traction of (1, -2) on the right side are (-1, -2) together."""
    axes = picture(made(HELD, **HELD_CASES, case="wind"))
    [right] = [vectors for tails, vectors in rows(axes) if len(tails) > 1 and tails[:, 0].min() >= 2]
    assert (right[:, 0] < 0).all()
    assert right[:, 1] == pytest.approx(2 * right[:, 0])
