"""The picture of the deformed body, magnified so that its displacement can be seen."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from bemcontact.analysis.result import Result
from bemcontact.arrays import Array
from bemcontact.bem.mesh import BoundaryState, element_curves
from bemcontact.report.figures.marks import draw_ground
from bemcontact.report.figures.page import BLACK, BODY, GREY, VERMILION, frame_plan, plain
from bemcontact.report.figures.pieces import pieces_of
from bemcontact.report.formatting import units_of, with_unit

VISIBLE = 0.05
"""Share of the body's size at which the largest displacement can be seen well; smaller ones are magnified."""

NEAR = 0.15
"""Share of the body's size up to which the rigid surface across a gap is shown."""


def draw_deformed(axes: Axes, result: Result) -> None:
    """Draw the boundary before and after, in thick lines where it is in contact, and the rigid surfaces if to scale.

    Displacements are magnified by a factor, which is stated. A rigid surface has none; beside a magnified body it would
    seem penetrated or far away, and so it is left out unless the factor is one.

    Parameters
    ----------
    axes : to draw into; limits and aspect are set
    result : with its `boundary`

    Raises
    ------
    ValueError
        If the result has no boundary, as one of a condensed problem.
    """
    state = result.boundary
    if state is None:
        raise ValueError("the result of a condensed problem has no boundary to draw")
    factor = _magnification(state)
    before = element_curves(state.points, 9)
    after = element_curves(state.points + factor * state.displacement, 9)
    axes.add_collection(LineCollection(list(before), colors=GREY, linewidths=0.9, linestyles="dashed", zorder=2))
    axes.add_collection(LineCollection(list(after), colors=BLACK, linewidths=1.8, zorder=3))
    axes.add_patch(PathPatch(outline_of(state, after), facecolor=BODY, edgecolor="none", zorder=0))
    _draw_touching(axes, result, state, after)
    covered = [before.reshape(-1, 2), after.reshape(-1, 2)]
    size = float(np.hypot(*extent(state)))
    if factor == 1:
        covered += [draw_ground(axes, *ground, 0.025 * size, GREY) for ground in ground_of(result, NEAR * size)]
    unit = units_of(result.contact).length
    frame_plan(axes, np.concatenate(covered), unit)
    largest = with_unit(f"{float(np.hypot(*state.displacement.reshape(-1, 2).T).max()):.3g}", plain(unit))
    scale = "displacements to scale" if factor == 1 else f"displacements × {factor:g}"
    surfaces = "" if factor == 1 else "; rigid surfaces not drawn"
    title = f"deformed shape, {scale} (largest {largest})\nthick: in contact; dashed: undeformed{surfaces}"
    axes.set_title(title, loc="left", fontsize=10)


def _draw_touching(axes: Axes, result: Result, state: BoundaryState, after: Array) -> None:
    """Thicken the halves of elements, drawn as curves (m, 9, 2), whose nodes carry pressure, and dot these nodes."""
    carrying = {tuple(point) for point in result.contact.points[result.touching].tolist()}
    touching = np.array([[tuple(node) in carrying for node in element] for element in state.points.tolist()])
    halves = [*after[touching[:, 0] & touching[:, 1], :5], *after[touching[:, 1] & touching[:, 2], 4:]]
    axes.add_collection(LineCollection(halves, colors=VERMILION, linewidths=3.5, capstyle="round", zorder=4))
    axes.scatter(*after[:, ::4][touching].T, s=10, color=VERMILION, zorder=4)


def extent(state: BoundaryState) -> tuple[float, float]:
    """Width and height of the body."""
    width, height = np.ptp(state.points.reshape(-1, 2), axis=0)
    return float(width), float(height)


def outline_of(state: BoundaryState, curves: Array) -> Path:
    """Join curves (m, c, 2) to one path of closed loops; holes run the other way round and so stay empty."""
    loops = (np.vstack([loop[:, :-1].reshape(-1, 2), loop[:1, 0]]) for loop in loops_of(state, curves))
    return Path.make_compound_path(*(Path(loop, closed=True) for loop in loops))


def loops_of(state: BoundaryState, curves: Array) -> list[Array]:
    """Split curves (m, c, 2) where one loop of elements ends and the next begins."""
    breaks = (state.points[1:, 0] != state.points[:-1, 2]).any(axis=1)
    return np.split(curves, np.flatnonzero(breaks) + 1)


def ground_of(result: Result, near: float) -> Iterator[tuple[Array, Array]]:
    """Stretches (j, 2) of rigid surface, with normals, so near to the deformed body that they can be shown."""
    contact = result.contact
    moved = contact.tools.motions @ (contact.tools.amplitudes @ result.solution.rigid_amplitudes)
    feet = contact.points - (contact.initial_gap + moved)[:, None] * contact.normals
    shown = result.contact.gap(result.solution.pressure, result.solution.rigid_amplitudes) <= near
    for piece in pieces_of(contact):
        for stretch in np.split(piece.index, np.flatnonzero(np.diff(shown[piece.index])) + 1):
            if shown[stretch[0]] and len(stretch) > 1:
                yield feet[stretch], contact.normals[stretch]


def _magnification(state: BoundaryState) -> float:
    """Choose 1, 2 or 5 times a power of ten so that the largest displacement can be seen."""
    largest = float(np.hypot(*state.displacement.reshape(-1, 2).T).max())
    size = float(np.hypot(*extent(state)))
    if largest == 0 or largest >= VISIBLE * size / 2:
        return 1.0
    wanted = VISIBLE * size / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step for step in (1, 2, 5) if step * power <= wanted) * power)
