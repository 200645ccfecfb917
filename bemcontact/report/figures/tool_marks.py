"""Tools on the picture of what is asked: arrows of their forces and displacements, and what is told of them."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes

from bemcontact.arrays import Array
from bemcontact.problem import DeflectedContour, Problem
from bemcontact.report.figures.marks import Name, draw_arrows
from bemcontact.report.figures.page import BLUE, GREEN, wrapped
from bemcontact.report.formatting import tool_in_words

REACH = 0.13
"""Length of an arrow over the size of the body."""


def draw_tools(axes: Axes, problem: Problem) -> Iterator[tuple[Array, Name]]:
    """Draw for each tool arrows of its force and of its displacement, by the load case that acts.

    They end at the point of the tool, or else at the middle of its first surface, if they push; they start there if
    they pull.

    Parameters
    ----------
    axes : to draw into
    problem : what is asked

    Yields
    ------
    covered : (k, 2) points that the arrows cover
    name : its name with what happens to it, to be placed beside them
    """
    for tool in problem.tools:
        place, normal = _place(problem, tool)
        action = problem.tool_action(tool)
        covered = [place[None]]
        for components, colour in ((action.position, BLUE), (action.load, GREEN)):
            if not any(components[:2]):
                continue
            arrow = REACH * problem.boundary.size * np.array(components[:2]) / np.linalg.norm(components[:2])
            tail = place - arrow if arrow @ normal > 0 else place
            covered.append(draw_arrows(axes, tail[None], arrow[None], colour))
        told = tool_in_words(action, problem.units).split("; ")
        yield np.concatenate(covered), _name("\n".join([wrapped(tool, 28), *told]), any(action.free), covered[-1])


def _place(problem: Problem, tool: str) -> tuple[Array, Array]:
    """Where the force on a tool is drawn, and the normal of its surface from there into the body."""
    stated = problem.tools[tool]
    zone = problem.contact_zones[stated.zones[0]]
    facing = np.concatenate([problem.edge(name).points(np.linspace(0, 1, 61)) for name in zone.edges])
    middle = facing[len(facing) // 2]
    if isinstance(zone.surface, DeflectedContour):
        foot, normal = middle, np.array(zone.surface.unit_direction)
    else:
        gap, normals = zone.surface.closest(middle[None])
        foot, normal = middle - gap[0] * normals[0], normals[0]
    return (foot if stated.point is None else np.array(stated.point)), normal


def _name(text: str, loaded: bool, covered: Array) -> Name:
    """The text of a tool, around the arrow that is drawn last."""
    angle = np.radians(45 * np.arange(8))
    around = np.column_stack([np.cos(angle), np.sin(angle)])
    return Name(
        text=text,
        colour=GREEN if loaded else BLUE,
        anchors=np.repeat(covered, 8, axis=0),
        directions=np.tile(around, (len(covered), 1)),
    )
