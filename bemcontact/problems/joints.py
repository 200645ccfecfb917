"""Joints between edges that change nothing: neither the curve, nor the conditions, nor the zones."""

from collections.abc import Callable, Sequence
from math import copysign, degrees, dist, fsum, pi

import numpy as np

from bemcontact.arrays import Array
from bemcontact.problems.curves import CircularArc, Curve, Edge, EllipticArc, Segment, cross
from bemcontact.problems.geometry import AnyEdge, Arc, EllipseArc, Line, SplineEdge
from bemcontact.problems.rigid_surface import Shape
from bemcontact.problems.validation import Point

FULL_TURN = 360.0
MOST_NAMED = 4
"""Number of edges that are all named in the name of one in their place."""
SAMPLES, ZOOM, ZOOMS = 256, 16, 11
"""Places of a closed curve that are compared at first; finer ones on each side of a place; times that is repeated."""
EXACT = 2.0**-36
"""Angle [degrees] of which a beginning is a multiple, so that no digit of a full turn from there is lost."""
TURNED = 1e-5
"""Angle [degrees] by which a closed curve need not begin elsewhere."""
SAME = 1e-9
"""Angle [rad], or difference over a radius, up to which a curve goes on in the next edge: round-off of coordinates."""


def without_joints(
    loop: Sequence[AnyEdge],
    edges: Sequence[Edge],
    alike: Callable[[str, str], bool],
    surfaces: Sequence[Shape],
    near: Point | None = None,
) -> list[tuple[AnyEdge, tuple[str, ...]]]:
    """Edges of a loop, where those that go on in the next one are one edge, each with the names of its parts.

    Edges with elements, or with places where elements end, stay as they are. A circle or an ellipse keeps one joint,
    where it is farthest from all rigid surfaces.

    Parameters
    ----------
    loop : edges as they are stated
    edges : the same with both ends
    alike : whether the edges of two names have the same conditions and zones
    surfaces : all rigid surfaces; none if one of them is not known yet
    near : of places that are equally far a circle begins at the one nearest to this; else to where it is stated to
    """
    pairs = [*zip(loop, edges, strict=True)]
    joints = [not _goes_on(pairs[i - 1], pair, alike) for i, pair in enumerate(pairs)]
    joints[0] |= not any(joints)
    first = joints.index(True)
    groups: list[list[tuple[AnyEdge, Edge]]] = []
    for pair, joint in zip(pairs[first:] + pairs[:first], joints[first:] + joints[:first], strict=True):
        if joint:
            groups.append([])
        groups[-1].append(pair)
    parts = [tuple(edge.name for edge, _ in group) for group in groups]
    if len(groups) == 1 and surfaces and _is_free(*pairs):
        return [(_beginning_far(_as_one(groups[0]), surfaces, near), parts[0])]
    return [*zip(map(_as_one, groups), parts, strict=True)]


def _goes_on(before: tuple[AnyEdge, Edge], after: tuple[AnyEdge, Edge], alike: Callable[[str, str], bool]) -> bool:
    """Whether an edge, stated and with both ends, goes on in the next one."""
    return (
        _is_free(before, after)
        and _same_curve(before[1].curve, after[1].curve)
        and alike(before[0].name, after[0].name)
    )


def _is_free(*edges: tuple[AnyEdge, Edge]) -> bool:
    """Whether the elements of edges, stated and with both ends, may end anywhere."""
    return all(edge.elements is None and not edge.places for edge, _ in edges)


def _same_curve(one: Curve, other: Curve) -> bool:
    """Whether a curve goes on in another one that begins at its end."""
    match one, other:
        case Segment(), Segment():
            way, further = np.subtract(one.end, one.start), np.subtract(other.end, other.start)
            return bool(abs(cross(way, further)) <= SAME * (way @ further))
        case (CircularArc(), CircularArc()) | (EllipticArc(), EllipticArc()):
            near = SAME * max(one.radii)
            turns = [curve.rotation for curve in (one, other) if isinstance(curve, EllipticArc)]
            alike = dist(one.center, other.center) <= near and dist(one.radii, other.radii) <= near
            return alike and turns[:1] == turns[1:] and one.sweep * other.sweep > 0
    return False


def _beginning_far(edge: AnyEdge, surfaces: Sequence[Shape], near: Point | None) -> AnyEdge:
    """A circle or an ellipse that begins where it is farthest from the surfaces; of such places at the nearest one."""
    if isinstance(edge, Line | SplineEdge) or edge.angles is None:
        return edge
    first, last = edge.angles

    def beginning_at(turned: float) -> Arc | EllipseArc:
        start = round((first + turned) / EXACT) * EXACT
        return edge.model_copy(update={"angles": (start, start + copysign(FULL_TURN, last - first))})

    def points_at(turned: Array) -> Array:
        return np.array([beginning_at(angle).own_ends()[0] for angle in turned.ravel().tolist()])

    def gaps_at(turned: Array) -> Array:
        return np.min([surface.closest(points_at(turned)).gap for surface in surfaces], axis=0).reshape(turned.shape)

    turned = FULL_TURN * np.arange(SAMPLES) / SAMPLES
    gap = gaps_at(turned)
    size = float(max(edge.semi_axes)) if isinstance(edge, EllipseArc) else edge.radius or 0.0
    if np.ptp(gap) <= SAME * size:
        return edge
    tops = turned[(gap >= np.roll(gap, 1)) & (gap >= np.roll(gap, -1))]
    for zoom in range(ZOOMS):
        around = tops[:, None] + FULL_TURN / SAMPLES * np.linspace(-1.0, 1.0, 2 * ZOOM + 1) / ZOOM**zoom
        tops = around[np.arange(len(tops)), gaps_at(around).argmax(axis=1)]
    gap, step = gaps_at(tops), FULL_TURN / SAMPLES / ZOOM
    before, after = gaps_at(tops - step), gaps_at(tops + step)
    bend = (
        2 * gap - before - after
    )  # the top of a parabola, for places where the gap is largest have half of the digits
    tops = tops + np.where(bend > SAME * size, step * (after - before) / (2 * np.maximum(bend, SAME * size)), 0.0)
    highest = (tops[gap >= gap.max() - SAME * size] + FULL_TURN / 2) % FULL_TURN - FULL_TURN / 2
    away = np.abs(highest) if near is None else np.hypot(*(points_at(highest) - near).T)
    nearest = float(highest[away.argmin()])
    return edge if abs(nearest) <= TURNED else beginning_at(nearest)


def _as_one(group: Sequence[tuple[AnyEdge, Edge]]) -> AnyEdge:
    """One edge in place of several that go on in each other."""
    (stated, first), (_, last) = group[0], group[-1]
    if len(group) == 1:
        return stated
    parts = [edge.name for edge, _ in group]
    name = " + ".join(parts if len(parts) <= MOST_NAMED else (parts[0], "…", parts[-1]))
    if isinstance(stated, Line):
        return Line(name=name, start=first.start, end=last.end)
    angles = [edge.angles for edge, _ in group if isinstance(edge, Arc | EllipseArc) and edge.angles is not None]
    if len(angles) == len(group):
        whole = (angles[0][0], angles[0][0] + fsum(end - start for start, end in angles))
        return stated.model_copy(update={"name": name, "angles": whole})
    curves = [edge.curve for _, edge in group if isinstance(edge.curve, CircularArc)]
    sweep = fsum(curve.sweep for curve in curves)
    if abs(sweep) < (1 - SAME) * 2 * pi:
        return Arc(name=name, center=curves[0].center, start=first.start, end=last.end, clockwise=sweep < 0)
    start = degrees(curves[0].start_angle)
    angles = (start, start + (FULL_TURN if sweep > 0 else -FULL_TURN))
    return Arc(name=name, center=curves[0].center, radius=curves[0].radii[0], angles=angles)
