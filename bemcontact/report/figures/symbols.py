"""Lines, hatched ground, rollers, arrows, and names placed where they cover least."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Polygon
from matplotlib.path import Path
from matplotlib.transforms import Bbox

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.frozen import frozen_value
from bemcontact.report.figures.page import add_path

SYMBOL_REACH = 18.0
"""Half the length of a symbolic arrow, in pixels of the page."""
COIL = np.column_stack([
    [0, 0.12, 0.2, 0.36, 0.52, 0.68, 0.76, 0.88], [0, 0, 0.22, -0.22, 0.22, -0.22, 0, 0]
])  # fmt: skip
"""A spring from its end on the body to 0.88 of its length, where its ground is: along and across it."""
SHALLOW = 0.1
"""Largest depth of hatching over the extent of a line that turns back."""


class Box(NamedTuple):
    """A rectangle on the page, in the page's unit of length."""

    left: float
    bottom: float
    right: float
    top: float


INSET = 5.0
"""Distance of the end of a line inside the border of a name, in pixels of the page."""
FAR = 30.0
"""Distance of a name from its anchor, in pixels of the page, from which a line leads to it."""
STEP = 8.0
"""Distance, in pixels of the page, within which places count as equally near."""
SHARES = np.linspace(0.05, 1.0, 20)
"""Shares of the way from an anchor to a name at which it must not be in another body."""
IN_BODY, LOST, IN_OTHER, ON_HATCHING, BLOCKED = 60.0, 120.0, 150.0, 200.0, 1000.0
"""What a place in a body adds to its distance, in pixels of the page, one behind a rigid line or beyond another name,
one in another body, one on hatching, and one beyond another body."""
NEXT_BEST = 60.0
"""Distance over the least one up to which a place may be chosen, in pixels of the page."""
CROSSED = 20
"""Number of drawn points from which free space is better than a place across the outline of a body."""
ON_LINE = 4.0
"""Distance before an anchor, in pixels of the page, at which the way to its name begins."""
FREE_PLACES = 12
"""Number of nearest places in free space that are compared for a name."""
COVERED = 1000.0
"""Weight of the share of a label that another one covers, against one drawn point."""
BACKING = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6}
"""What is behind a name that covers something, so that it can be read."""


def centered(center: Array, size: tuple[float, float]) -> Box:
    """Return the box of this size (width, height) around a center (2,)."""
    (x, y), (width, height) = center, size
    return Box(x - width / 2, y - height / 2, x + width / 2, y + height / 2)


def overlap(a: Box, b: Box) -> float:
    """Area that two boxes share."""
    width = min(a.right, b.right) - max(a.left, b.left)
    height = min(a.top, b.top) - max(a.bottom, b.bottom)
    return max(width, 0.0) * max(height, 0.0)


def crowd(box: Box, taken: Sequence[Box], ink: Array) -> float:
    """Measure what a box covers: the share covered by other boxes, plus one for each drawn point (k, 2) in it."""
    area = (box.right - box.left) * (box.top - box.bottom)
    inside = (ink > (box.left, box.bottom)) & (ink < (box.right, box.top))
    return COVERED * sum(overlap(box, other) for other in taken) / area + float(inside.all(axis=1).sum())


def least_crowded(centers: Array, size: tuple[float, float], taken: Sequence[Box], ink: Array) -> int:
    """Index of the first of the centers (c, 2) at which a label covers least of other labels and of ink (k, 2)."""
    ink = ink[np.argsort(ink[:, 0])]
    low, high = (np.searchsorted(ink[:, 0], centers[:, 0] + side * size[0] / 2) for side in (-1, 1))
    columns = zip(centers, low.tolist(), high.tolist(), strict=True)
    return int(np.argmin([crowd(centered(at, size), taken, ink[first:last]) for at, first, last in columns]))


@frozen_value
class Name:
    """A text, mathematics between dollars, to be placed near one of the anchors (c, 2), in its direction (c, 2).

    One with a number of a body stands in another one only where there is no other place near it. One that is optional
    is left out where there is no room. It names what has the points `named` (k, 2), by default the anchors. Where there
    is no room near it, it may stand on what it names, a closed polygon `area` (k, 2), if it fits.
    """

    text: str
    color: str
    anchors: Array
    directions: Array
    body: int | None = None
    optional: bool = False
    named: Array | None = None
    area: Array | None = None


def joined(curves: Array) -> list[Array]:
    """Lines (j, 2) through curves (m, c, 2), each as long as curves begin where the one before them ends."""
    breaks = (curves[1:, 0] != curves[:-1, -1]).any(axis=1)
    runs = np.split(curves, np.flatnonzero(breaks) + 1) if len(curves) else []
    return [np.concatenate([run[0, :1], run[:, 1:].reshape(-1, 2)]) for run in runs]


class Ground(NamedTuple):
    """A rigid line as it is drawn: strokes of hatching from roots (k, 2) on it to tips (k, 2) on its rigid side."""

    roots: Array
    tips: Array

    @property
    def covered(self) -> Array:
        """Points (2 k, 2) of what the drawing covers."""
        return np.concatenate([self.roots, self.tips])


def covered_by(items: Sequence[Ground | Array]) -> list[Array]:
    """Points (k, 2) that each of some drawn things covers."""
    return [item.covered if isinstance(item, Ground) else item for item in items]


def draw_ground(axes: Axes, points: Array, normals: Array, depth: float, color: str) -> Ground:
    """Draw a rigid line (k, 2) and hatching of a depth on the side away from its unit normals (k, 2).

    On a small circle the hatching is less deep, and no spiral.
    """
    s = np.concatenate([[0.0], np.hypot(*np.diff(points, axis=0).T).cumsum()])
    if np.hypot(*(points[-1] - points[0])) < s[-1] / 2:
        depth = min(depth, SHALLOW * float(np.hypot(*np.ptp(points, axis=0))))
    at = np.linspace(0, s[-1], max(int(s[-1] / (0.6 * depth)), 3))
    roots = np.column_stack([np.interp(at, s, points[:, i]) for i in (0, 1)])
    inward = -np.column_stack([np.interp(at, s, normals[:, i]) for i in (0, 1)])
    tips = roots + 0.7 * depth * (inward + inward[:, ::-1] * (1, -1))
    strokes = Path(np.stack([roots, tips], axis=1).reshape(-1, 2), len(roots) * [Path.MOVETO, Path.LINETO])
    add_path(axes, strokes, facecolor="none", edgecolor=color, linewidth=0.7, zorder=1)
    axes.plot(*points.T, color=color, linewidth=1.3, zorder=1)
    return Ground(roots, tips)


def draw_rollers(axes: Axes, points: Array, away: Array, size: float, color: str) -> Array:
    """Draw triangles with tips at the points (k, 2), bases on the side `away` (k, 2); return what they cover."""
    across = away[:, ::-1]
    base, behind = points + size * away, points + 1.35 * size * away
    for triangle in np.stack([points, base + 0.6 * size * across, base - 0.6 * size * across], axis=1):
        axes.add_patch(Polygon(triangle, facecolor="white", edgecolor=color, linewidth=1.0, zorder=2))
    lines = np.stack([behind - 0.75 * size * across, behind + 0.75 * size * across], axis=1)
    axes.add_collection(LineCollection(list(lines), colors=color, linewidths=1.0, zorder=2))
    return np.concatenate([base, behind])


def draw_springs(axes: Axes, points: Array, away: Array, size: float, color: str) -> Array:
    """Draw springs from the points (k, 2) along unit vectors `away` (k, 2) to ground; return what they cover."""
    across = np.column_stack([-away[:, 1], away[:, 0]])
    coils = points[:, None] + size * (COIL[:, :1] * away[:, None] + COIL[:, 1:] * across[:, None])
    ground = coils[:, -1:] + size * np.array([[-0.35], [0.35]]) * across[:, None]
    lines = [*coils, *ground]
    axes.add_collection(LineCollection(lines, colors=color, linewidths=1.0, zorder=2))
    return np.concatenate(lines)


def draw_arrows(axes: Axes, tails: Array, vectors: Array, color: str) -> Array:
    """Draw arrows (k, 2) from their tails (k, 2); return what they cover."""
    axes.quiver(
        *tails.T, *vectors.T, angles="xy", scale_units="xy", scale=1, color=color, width=0.0028, headwidth=5, zorder=5
    )
    return np.concatenate([tails + share * vectors for share in np.linspace(0, 1, 31)])


def place_names(
    axes: Axes,
    names: Sequence[Name],
    drawn: Array,
    bodies: Sequence[Sequence[Array]],
    grounds: Sequence[Ground] = (),
) -> list[Box]:
    """Write names in order where they cover least, on their own side of the closed polygons (j, 2) of each body.

    Where there is room elsewhere they stand on no hatching, and not behind the rigid line that is before their anchor.
    `drawn` are points (k, 2) of the drawing. The limits of the axes must be set, and the page be settled. Names keep
    off a legend and the labels of the axes. A thin line leads to one that stands far from its anchor. Return the boxes
    of what is taken.
    """
    to_page, frame = axes.transData, _room(axes)
    ink = to_page.transform(drawn)
    walls = [[Path(to_page.transform(loop)) for loop in loops] for loops in bodies]
    rigid = [Ground(to_page.transform(it.roots), to_page.transform(it.tips)) for it in grounds]
    beside = [axes.xaxis.label, axes.yaxis.label, axes.get_legend()]
    taken = [Box(*item.get_window_extent().extents) for item in beside if item is not None]
    for name in names:
        text = axes.text(0, 0, name.text, color=name.color, fontsize=9, ha="center", va="center", zorder=6)
        text.set_in_layout(False)  # or the next layout would move what it was placed beside
        extent = text.get_window_extent()
        size = (extent.width + 10, extent.height + 4)
        area = None if name.area is None else to_page.transform(name.area)
        chosen = _place(name, size, to_page.transform(name.anchors), frame, taken, ink, walls, rigid, area)
        if chosen is None:
            text.remove()
            continue
        taken.append(centered(chosen, size))
        if crowd(taken[-1], [], ink):
            text.set_bbox(BACKING)
        text.set_position(_to_data(axes, chosen))
        named = to_page.transform(name.anchors if name.named is None else name.named)
        ends = _line_ends(named, chosen, size)
        at = int(np.argmin(np.hypot(*(ends - named).T)))
        anchor, end = named[at], ends[at]
        on_it = area is not None and bool(Path(area).contains_points(chosen[None])[0])
        if name.directions.any() and np.hypot(*(end - anchor)) > FAR and not on_it:
            line = np.array([_to_data(axes, point) for point in (anchor, end)])
            axes.plot(*line.T, color=name.color, linewidth=0.7, alpha=0.7, zorder=5, scalex=False, scaley=False)
            ink = np.concatenate([ink, anchor + np.linspace(0, 1, 100)[:, None] * (end - anchor)])
    return taken


def _place(
    name: Name,
    size: tuple[float, float],
    anchors: Array,
    frame: Bbox,
    taken: Sequence[Box],
    ink: Array,
    walls: Sequence[Sequence[Path]],
    grounds: Sequence[Ground],
    area: Array | None,
) -> Array | None:
    """Center (2,) of a name on the page: beside its anchor, on its area, in free space, else across other names.

    None if it is optional and there is no room.
    """
    anchors, centers = _places(anchors, name.directions, size)
    away = np.hypot(*(_line_ends(anchors, centers, size) - anchors).T)
    nearest_first = np.argsort(np.round(away / STEP), kind="stable")  # of wide texts, those to the side are nearer
    anchors, centers = anchors[nearest_first], centers[nearest_first]
    lines = [wall for loops in walls for wall in loops]

    def least(centers: Array) -> Array:
        return centers[least_crowded(centers, size, taken, ink)]

    def free(centers: Array) -> BoolArray:
        low, high, boxes = *_corners(centers, size), np.reshape(taken, (-1, 4))
        apart = np.any((low[:, None] >= boxes[:, 2:]) | (high[:, None] <= boxes[:, :2]), axis=2)
        return np.all(apart, axis=1)

    def lost(anchors: Array, centers: Array) -> BoolArray:
        ends = _line_ends(anchors, centers, size)
        behind = _behind(grounds, anchors, centers) | _behind(grounds, anchors, ends)
        return behind | _leads_through(taken, anchors, ends)

    held = _holds(frame, centers, size)
    side = held.copy()
    side[held] = _on_side(walls, anchors[held], centers[held], name.body)
    room = side & free(centers)
    room[room] = ~lost(anchors[room], centers[room])
    beside = room.copy()
    room[room] = ~_hatched(grounds, centers[room], size)
    if name.optional:
        room &= (np.abs(centers - anchors) - np.array(size) / 2).max(axis=1) < FAR
    room[room] = ~_crossed(lines, centers[room], size)
    on_area = np.zeros((0, 2)) if area is None else _within(area, size)
    on_area = on_area[free(on_area)]
    if room.any():
        center = least(centers[room])
        if not len(on_area) or np.hypot(*(_line_ends(anchors, center, size) - anchors).T).min() <= FAR:
            return center
    if name.optional:
        return None
    if len(on_area):
        return on_area[0]
    if name.body is None and beside.any():
        center = least(centers[beside])
        if crowd(centered(center, size), [], ink) < CROSSED:  # it may stand on a little of what is drawn
            return center
    grid = _grid(frame, size)
    others = [loops for body, loops in enumerate(walls) if body != name.body]
    grid = grid[free(grid)]
    grid = grid[~_crossed(lines, grid, size)]
    distances = np.hypot(*(grid[:, None] - anchors).transpose(2, 0, 1)).min(axis=1, initial=np.inf)
    nearest = anchors[_nearest_anchor(anchors, grid, size)]
    distances += IN_BODY * _inside(walls, grid).any(axis=0) + LOST * lost(nearest, grid)
    distances += ON_HATCHING * _hatched(grounds, grid, size) + IN_OTHER * _inside(others, grid).any(axis=0)
    if name.body is not None:  # a line through another body would seem to lead to that
        ways = nearest + SHARES[:, None, None] * (grid - nearest)
        distances += BLOCKED * _inside(others, ways.reshape(-1, 2)).any(axis=0).reshape(ways.shape[:2]).any(axis=0)
    if len(grid):
        near = np.argsort(distances, kind="stable")[:FREE_PLACES]
        return least(grid[near[distances[near] < distances[near[0]] + NEXT_BEST]])
    for admissible in (side, held):
        if admissible.any():
            return least(centers[admissible])
    return least(centers)


def place_arrow(axes: Axes, symbol: str, vector: Array, drawn: Array, taken: Sequence[Box]) -> None:
    """Draw an arrow of fixed length along a vector (2,), with its symbol at the tail, where it covers least.

    The page must be settled.
    """
    reach = SYMBOL_REACH * vector / np.hypot(*vector)
    size = (2 * abs(float(reach[0])) + 22, 2 * abs(float(reach[1])) + 22)
    centers = _grid(axes.get_window_extent(), size)
    center = centers[least_crowded(centers, size, taken, axes.transData.transform(drawn))]
    axes.annotate(
        symbol,
        xy=_to_data(axes, center + reach),
        xytext=_to_data(axes, center - reach),
        arrowprops={"arrowstyle": "-|>", "color": "black", "linewidth": 1.4},
        ha="center",
        va="center",
        zorder=6,
    )


def _room(axes: Axes) -> Bbox:
    """Where names may stand on the page: what the layout gives to the axes, but for sides with ticks or a title."""
    own, whole = axes.get_window_extent(), axes.get_position(original=True).transformed(axes.figure.transSubfigure)
    corner, titled = own if axes.axison else whole, axes.get_title("left") or axes.get_title()
    return Bbox([[corner.x0, corner.y0], [max(own.x1, whole.x1), own.y1 if titled else max(own.y1, whole.y1)]])


def _to_data(axes: Axes, place: Array) -> tuple[float, float]:
    """Coordinates of a place on the page."""
    x, y = axes.transData.inverted().transform(place)
    return float(x), float(y)


def _grid(frame: Bbox, size: tuple[float, float]) -> Array:
    """Centres (c, 2) all over a frame, those near its middle first."""
    low, high = frame.min + np.array(size) / 2, frame.max - np.array(size) / 2
    shares = np.stack(np.meshgrid(np.linspace(0, 1, 25), np.linspace(0, 1, 15)), axis=-1).reshape(-1, 2)
    nearest_first = np.argsort(np.hypot(*(shares - 0.5).T), kind="stable")
    return (low + shares * (high - low))[nearest_first]


def _places(anchors: Array, directions: Array, size: tuple[float, float]) -> tuple[Array, Array]:
    """Anchors (c, 2), and centers (c, 2) for a text of this size beside them: near ones first, then those aside."""
    if not directions.any():
        return anchors, anchors
    across = directions[:, ::-1] * (-1, 1)
    reach, aside = (np.abs(way) @ np.array(size) / 2 for way in (directions, across))
    centers = [
        anchors + (reach + distance)[:, None] * directions + (side * (aside + 8.0))[:, None] * across
        for side in (0, -1, 1)
        for distance in (8.0, 16.0, 30.0, 50.0, 75.0)
    ]
    return np.tile(anchors, (len(centers), 1)), np.concatenate(centers)


def _corners(centers: Array, size: tuple[float, float]) -> tuple[Array, Array]:
    """Lower left and upper right corners (c, 2) of a text of this size at each center (c, 2)."""
    half = np.array(size) / 2
    return centers - half, centers + half


def _holds(frame: Bbox, centers: Array, size: tuple[float, float]) -> BoolArray:
    """Whether each text lies inside a frame."""
    low, high = _corners(centers, size)
    return np.all((low > frame.min) & (high < frame.max), axis=1)


def _within(area: Array, size: tuple[float, float]) -> Array:
    """Centers (c, 2) at which a text of this size is inside a polygon (k, 2), those near its middle first."""
    if (np.ptp(area, axis=0) < size).any():
        return np.zeros((0, 2))
    centers = _grid(Bbox([area.min(axis=0), area.max(axis=0)]), size)
    corners = centers[:, None] + np.array(size) / 2 * [[-1, -1], [1, -1], [1, 1], [-1, 1]]
    return centers[Path(area).contains_points(corners.reshape(-1, 2)).reshape(-1, 4).all(axis=1)]


def _crossed(walls: Sequence[Path], centers: Array, size: tuple[float, float]) -> BoolArray:
    """Whether a wall goes through a text of this size at each center (c, 2)."""
    crossed, (low, high) = np.zeros(len(centers), bool), _corners(centers, size)
    for wall in walls:
        points = np.asarray(wall.vertices)
        near = ~crossed & ((low <= points.max(axis=0)) & (high >= points.min(axis=0))).all(axis=1)
        boxes = map(Bbox, np.stack([low[near], high[near]], axis=1))
        crossed[near] = [wall.intersects_bbox(box, filled=False) for box in boxes]
    return crossed


def _line_ends(anchors: Array, centers: Array, size: tuple[float, float]) -> Array:
    """Where the line from each anchor (c, 2) to a text of this size at each center (c, 2) ends."""
    half = np.array(size) / 2 - INSET
    return np.clip(anchors, centers - half, centers + half)


def _nearest_anchor(anchors: Array, centers: Array, size: tuple[float, float]) -> IntArray:
    """Number (c,) of the anchor (a, 2) that is nearest to a text of this size at each center (c, 2)."""
    half = np.array(size) / 2 - INSET
    away = np.maximum(np.abs(centers[:, None] - anchors) - half, 0.0)
    return np.hypot(away[..., 0], away[..., 1]).argmin(axis=1)


def _leads_through(taken: Sequence[Box], anchors: Array, ends: Array) -> BoolArray:
    """Whether a line from each anchor (c, 2) to its end (c, 2), if one is drawn, goes through another name."""
    way = anchors + SHARES[:, None, None] * (ends - anchors)
    through = np.zeros(len(ends), bool)
    for box in taken:
        through |= ((way > box[:2]) & (way < box[2:])).all(axis=2).any(axis=0)
    return through & (np.hypot(*(ends - anchors).T) > FAR)


def _hatched(grounds: Sequence[Ground], centers: Array, size: tuple[float, float]) -> BoolArray:
    """Whether a text of this size at each center (c, 2) stands on a rigid line or on its hatching."""
    zigzags = [Path(np.stack([it.roots, it.tips, it.roots], axis=1).reshape(-1, 2)) for it in grounds]
    return _crossed(zigzags, centers, size)


def _behind(grounds: Sequence[Ground], anchors: Array, centers: Array) -> BoolArray:
    """Whether the way from each anchor (c, 2) to its center (c, 2) goes through a rigid line to its rigid side.

    An anchor may be on the line, so a way begins a little before it.
    """
    behind, way = np.zeros(len(centers), bool), centers - anchors
    length = np.hypot(*way.T)[:, None]
    start = anchors - ON_LINE * way / np.where(length > 0, length, 1.0)
    way = centers - start
    for roots, tips in grounds:
        piece, away = np.diff(roots, axis=0), (tips - roots)[:-1]
        into = away + away[:, ::-1] * (-1, 1)  # strokes are turned by 45 degrees
        offset = roots[:-1] - start[:, None]
        cross = _cross(way[:, None], piece)
        with np.errstate(divide="ignore", invalid="ignore"):
            along, across = _cross(offset, piece) / cross, _cross(offset, way[:, None]) / cross
        through = (along >= 0) & (along <= 1) & (across >= 0) & (across <= 1) & (way @ into.T > 0)
        behind |= through.any(axis=1) & (length[:, 0] > 0)
    return behind


def _cross(a: Array, b: Array) -> Array:
    """Component of the cross product of vectors (..., 2) across the plane."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _inside(walls: Sequence[Sequence[Path]], points: Array) -> BoolArray:
    """Whether each body holds points (k, 2), one row (k,) a body."""
    rows = [np.logical_xor.reduce([wall.contains_points(points) for wall in loops]) for loops in walls]
    return np.array(rows, bool).reshape(len(walls), len(points))


def _on_side(walls: Sequence[Sequence[Path]], anchors: Array, centers: Array, body: int | None) -> BoolArray:
    """Whether the way from each anchor (c, 2) to its place (c, 2) stays inside or outside of each body.

    That of a name of a `body` goes through no other one.
    """
    way = anchors + SHARES[:, None, None] * (centers - anchors)
    inside: BoolArray = _inside(walls, way.reshape(-1, 2)).reshape(len(walls), *way.shape[:2])
    stays = (inside == inside[:, :1]).all(axis=(0, 1))
    return stays if body is None else stays & ~np.delete(inside, body, axis=0).any(axis=(0, 1))
