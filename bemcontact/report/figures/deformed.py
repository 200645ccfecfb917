"""The deformed shape of a body, magnified so that it is seen, with the rigid surfaces moved along."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from bemcontact.analysis.result import Result
from bemcontact.arrays import Array
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.mesh import element_curves
from bemcontact.options import StressMeasure
from bemcontact.report.contact_words import units_of
from bemcontact.report.figures.contact import OVERHANG, body_extent, draw_outlines, framed, outline_of
from bemcontact.report.figures.page import GREY, VERMILION, add_path, frame_plan, plain
from bemcontact.report.figures.stress import fill_with_stress
from bemcontact.report.figures.surfaces import THROUGH, bends, bent, reach_through, surfaces_of
from bemcontact.report.figures.symbols import draw_ground, joined
from bemcontact.report.formatting import with_unit

MAGNIFIED = 0.05
"""Share of the body's size at which the largest displacement can be seen well; smaller ones are magnified."""
NEAR = 0.15
"""Share of the body's size up to which the rigid surface across a gap is shown."""


def draw_deformed(axes: Axes, result: Result, stress: StressMeasure | None = None) -> None:
    """Draw the boundary before and after deformation; thick lines show contact.

    Displacements and gaps to the rigid surfaces are magnified by a stated factor, which is smaller where magnified
    bodies would reach through each other beside a contact. So are small initial gaps and interferences of two bodies,
    so that the bodies meet where they touch: their second body is bent, also as its undeformed outline has it. With a
    `stress` the body is filled with its contours; a ring marks the largest, crosses places where it is infinite.
    `ValueError` for the result of a condensed problem.
    """
    factor = magnification([result])
    state = draw_shape(axes, result, factor)
    marked = "thick: in contact; dashed: undeformed"
    if stress is not None:
        marked = fill_with_stress(axes, result, stress, factor)
    stated = [bar.value for bar in result.accuracy.bars if bar.quantity == "displacement"]  # as the table has it
    most = stated[0] if stated else float(np.hypot(*state.displacement.reshape(-1, 2).T).max())
    largest = "not known" if most is None else with_unit(f"{most:.3g}", plain(units_of(result.contact).length))
    title = f"deformed shape, {in_words(factor, [result])}\nlargest displacement {largest}\n{marked}"
    axes.set_title(title, loc="left", fontsize=10)


def in_words(factor: float, results: Sequence[Result]) -> str:
    """Write what a factor magnifies in the pictures of results."""
    if factor == 1:
        return "displacements to scale"
    also = ", also the initial ones" if any(bends(result, factor) for result in results) else ""
    return f"displacements and gaps × {factor:g}{also}"


def draw_shape(axes: Axes, result: Result, factor: float) -> BoundaryState:
    """Draw the boundary before and after deformation, magnified by a factor, and the surfaces; return the boundary.

    `ValueError` for the result of a condensed problem.
    """
    state, problem = result.boundary, result.problem
    if state is None or problem is None:
        raise ValueError("the result of a condensed problem has no boundary to draw")
    bodies, drawn = np.array([problem.part_of(name) for name in state.edge_names])[state.edge], state.points.copy()
    for body in np.unique(bodies).tolist():
        own = bodies == body
        drawn[own] += bent(result, body, state.points[own].reshape(-1, 2), factor).reshape(-1, 3, 2)
    before = element_curves(drawn, 9)
    after = element_curves(drawn + factor * state.displacement, 9)
    dashed = outline_of(state, before)
    add_path(axes, dashed, facecolor="none", edgecolor=GREY, linewidth=0.9, linestyle="dashed", zorder=2)
    draw_outlines(axes, problem, state, after)
    _draw_touching(axes, result, state, after)
    covered = [before.reshape(-1, 2), after.reshape(-1, 2)]
    size = float(np.hypot(*body_extent(state)))
    surfaces = surfaces_of(result, problem, OVERHANG * size, factor, NEAR * size)
    window = np.array([end(np.concatenate(covered), axis=0) for end in (np.min, np.max)])
    for surface in surfaces:
        ground = draw_ground(axes, surface.points, surface.normals, 0.025 * size, GREY)
        covered.append(framed(ground.covered, surface, window, size))
    frame_plan(axes, np.concatenate(covered), units_of(result.contact).length)
    return state


def _draw_touching(axes: Axes, result: Result, state: BoundaryState, after: Array) -> None:
    """Draw the half elements with pressure at both nodes, of curves (m, 9, 2), as thick lines; other nodes as dots.

    Of two bodies the first one has the line.
    """
    carrying = {tuple(point) for point in result.contact.points[result.touching].tolist()}
    touching = np.array([[tuple(node) in carrying for node in element] for element in state.points.tolist()])
    problem = result.problem
    assert problem is not None
    second = {name for zone in problem.contacts for name in problem.opposite_edges(zone)}
    second -= {name for zone in problem.zones for name in problem.edges_of(zone)}
    touching &= np.array([name not in second for name in state.edge_names])[state.edge][:, None]
    between = touching[:, :-1] & touching[:, 1:]
    halves = joined(np.stack([after[:, :5], after[:, 4:]], axis=1)[between])
    axes.add_collection(LineCollection(halves, colors=VERMILION, linewidths=3.5, capstyle="round", zorder=4))
    alone = touching.copy()
    alone[:, :-1] &= ~between
    alone[:, 1:] &= ~between
    if alone.any():
        axes.scatter(*after[:, ::4][alone].T, s=10, color=VERMILION, zorder=4)


def magnification(results: Sequence[Result]) -> float:
    """Choose the factor that magnifies the displacements of results: the smallest that one of them has alone."""
    moved = ((result, state) for result in results if (state := result.boundary) and state.displacement.any())
    return min((_magnification(result, state) for result, state in moved), default=1.0)


def _magnification(result: Result, state: BoundaryState) -> float:
    """Choose 1, 2 or 5 times a power of ten so that the largest displacement can be seen.

    It is smaller where the magnified body would visibly reach through a surface beside the contact.
    """
    largest = float(np.hypot(*state.displacement.reshape(-1, 2).T).max())
    size = float(np.hypot(*body_extent(state)))
    if largest >= MAGNIFIED * size / 2:
        return 1.0
    wanted = MAGNIFIED * size / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    factors = [step * power / down for down in (1, 10, 100) for step in (5, 2, 1) if step * power / down <= wanted]
    return float(next((f for f in factors if f > 1 and reach_through(result, f) <= THROUGH * size), 1.0))
