"""The marks that engineers draw: hatched ground, rollers, arrows, names."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Polygon
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

from bemcontact.report.placement import Box, centred, least_crowded

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Name:
    """A text, mathematics between dollars, to be placed near one of the anchors (c, 2), in its direction (c, 2)."""

    text: str
    colour: str
    anchors: Array
    directions: Array


def draw_ground(axes: Axes, points: Array, normals: Array, depth: float, colour: str) -> Array:
    """Draw a rigid line and the hatching on the side away from its normals.

    Parameters
    ----------
    axes : to draw into
    points : (k, 2) of the line, in order
    normals : (k, 2) unit normals, from the ground into the body
    depth : of the hatching
    colour : of line and hatching

    Returns
    -------
    (k, 2) array
        What the drawing covers.
    """
    s = np.concatenate([[0.0], np.hypot(*np.diff(points, axis=0).T).cumsum()])
    at = np.linspace(0, s[-1], max(int(s[-1] / (0.6 * depth)), 3))
    roots = np.column_stack([np.interp(at, s, points[:, i]) for i in (0, 1)])
    inward = -np.column_stack([np.interp(at, s, normals[:, i]) for i in (0, 1)])
    tips = roots + 0.7 * depth * (inward + inward[:, ::-1] * (1, -1))
    strokes = list(np.stack([roots, tips], axis=1))
    axes.add_collection(LineCollection(strokes, colors=colour, linewidths=0.7, zorder=1))
    axes.plot(*points.T, color=colour, linewidth=1.3, zorder=1)
    return np.concatenate([roots, tips])


def draw_rollers(axes: Axes, points: Array, away: Array, size: float, colour: str) -> Array:
    """Draw triangles with tips at the points (k, 2), bases on the side `away` (k, 2); return what they cover."""
    across = away[:, ::-1]
    base, behind = points + size * away, points + 1.35 * size * away
    for triangle in np.stack([points, base + 0.6 * size * across, base - 0.6 * size * across], axis=1):
        axes.add_patch(Polygon(triangle, facecolor="white", edgecolor=colour, linewidth=1.0, zorder=2))
    lines = np.stack([behind - 0.75 * size * across, behind + 0.75 * size * across], axis=1)
    axes.add_collection(LineCollection(list(lines), colors=colour, linewidths=1.0, zorder=2))
    return np.concatenate([base, behind])


def draw_arrows(axes: Axes, tails: Array, vectors: Array, colour: str) -> Array:
    """Draw arrows (k, 2) from their tails (k, 2); return what they cover."""
    axes.quiver(
        *tails.T, *vectors.T, angles="xy", scale_units="xy", scale=1, color=colour, width=0.0028, headwidth=5, zorder=5
    )
    return np.concatenate([tails + share * vectors for share in (0.0, 0.35, 0.7, 1.0)])


def place_names(axes: Axes, names: Sequence[Name], drawn: Array) -> None:
    """Write names where they cover least of each other and of what is drawn (k, 2).

    The limits and the place of the axes on the page must be settled before.
    """
    page = axes.get_figure(root=True)
    if page is not None:
        page.draw_without_rendering()
    to_page = axes.transData
    ink = to_page.transform(drawn)
    taken: list[Box] = []
    frame = axes.get_window_extent()
    for name in names:
        text = axes.text(0, 0, name.text, color=name.colour, fontsize=9, ha="center", va="center", zorder=6)
        extent = text.get_window_extent()
        size = (extent.width + 4, extent.height + 2)
        centers = _places(to_page.transform(name.anchors), name.directions, size)
        inside = centers[_holds(frame, centers, size)]
        centers = inside if len(inside) else centers
        chosen = centers[least_crowded(centers, size, taken, ink)]
        taken.append(centred(chosen, size))
        x, y = to_page.inverted().transform(chosen)
        text.set_position((float(x), float(y)))


def _places(anchors: Array, directions: Array, size: tuple[float, float]) -> Array:
    """Centres (c, 2) for a text of this size beside each anchor, near ones first."""
    reach = np.abs(directions) @ np.array(size) / 2
    distances = (8.0, 16.0, 30.0, 50.0, 75.0)
    return np.concatenate([anchors + (reach + distance)[:, None] * directions for distance in distances])


def _holds(frame: Bbox, centers: Array, size: tuple[float, float]) -> NDArray[np.bool_]:
    """Tell which texts lie inside a frame."""
    half = np.array(size) / 2
    return np.all((centers - half > frame.min) & (centers + half < frame.max), axis=1)
