"""Outlines as plain edges: corners that are rounded, edges that are tangent to their neighbors, and mirrored halves.

Points and directions are complex numbers x + iy. The signed radius of an arc is positive if it runs counterclockwise,
so that its center is on the left.
"""

from collections.abc import Iterator, Sequence
from math import isfinite, sqrt
from typing import Any

import numpy as np

from bemcontact.errors import Issue, KeyPath
from bemcontact.problems.curves import Curve
from bemcontact.problems.geometry import (
    AnyEdge,
    Arc,
    EllipseArc,
    Fillet,
    Grading,
    Line,
    Mirror,
    Place,
    SplineEdge,
    StatedEdge,
)
from bemcontact.problems.validation import Point

SMOOTH = 1e-9
"""Sine of the angle between two edges up to which they go on smoothly."""
ON_LINE = 1e-9
"""Distance of a point from the mirror line, over the size of the outline, up to which it is on it."""
MIRRORED = " mirrored"
"""What is added to the names of mirrored edges."""


class OutlineError(Exception):
    """An outline that cannot be written out; `issue` has the key path relative to its loop."""

    def __init__(self, number: int, message: str, key: str | None = None) -> None:
        super().__init__(message)
        self.issue = Issue(path=(number,) if key is None else (number, key), message=message)


def plain_loop(loop: Sequence[StatedEdge]) -> tuple[AnyEdge, ...]:
    """A loop of lines and arcs whose ends are stated, or follow from their neighbors; `OutlineError` if they do not."""
    if not any(isinstance(edge, Fillet) or _to_be_found(edge) for edge in loop):
        return tuple(edge for edge in loop if not isinstance(edge, Fillet))
    places = [i for i, edge in enumerate(loop) if not isinstance(edge, Fillet)]
    edges = [edge for edge in loop if not isinstance(edge, Fillet)]
    if not edges:
        raise OutlineError(0, "a fillet rounds the corner between two edges; give the edges")
    edges = _with_tangents(edges, places)
    rounded = dict[int, tuple[int, Fillet]]()
    for i, edge in enumerate(loop):
        if isinstance(edge, Fillet):
            if isinstance(loop[i - 1], Fillet):
                raise OutlineError(i, "two fillets follow each other; a fillet stands between two edges")
            rounded[places.index(i - 1 if i else len(loop) - 1)] = i, edge
    if not rounded:
        return tuple(edges)
    if len(edges) < 2:
        raise OutlineError(next(iter(rounded.values()))[0], "a fillet needs two edges between which it stands")
    return _with_fillets(edges, places, rounded)


def _to_be_found(edge: StatedEdge) -> bool:
    """Whether ends of an edge follow from what its neighbors are tangent to."""
    return isinstance(edge, Line | Arc) and (edge.tangent is not None or (isinstance(edge, Arc) and edge.is_round))


def _with_tangents(edges: list[AnyEdge], places: Sequence[int]) -> list[AnyEdge]:
    """Edges with the ends at which they are tangent to their neighbors."""
    edges, count = [*edges], len(edges)
    for i, edge in enumerate(edges):  # between two circles
        if not isinstance(edge, Line | Arc) or edge.tangent is None:
            continue
        if isinstance(edge, Line):
            edges[i] = _tangent_line(edge, edges[i - 1], edges[(i + 1) % count], places[i])
        elif edge.tangent == "both":
            edges[i] = _tangent_arc(edge, edges[i - 1], edges[(i + 1) % count], places[i])
    for i, edge in enumerate(edges):  # circles take the ends of their neighbors
        if isinstance(edge, Arc) and edge.is_round:
            start, end = edges[i - 1].own_ends()[1], edges[(i + 1) % count].own_ends()[0]
            edges[i] = _between(edge, edge.start or start, edge.end or end, places[i])
    for i, edge in enumerate(edges):
        if isinstance(edge, Arc) and edge.tangent in ("start", "end"):
            edges[i] = _smooth_arc(edge, edges, i, places[i])
    return edges


def _circle(edge: AnyEdge, number: int, of: str) -> tuple[complex, float]:
    """Center and signed radius of a neighbor to which an edge is tangent."""
    if not isinstance(edge, Arc) or edge.center is None or edge.radius is None:
        message = f"'{of}' is tangent to '{edge.name}', which must be an arc with center and radius; give these"
        raise OutlineError(number, message, "tangent")
    clockwise = edge.clockwise if edge.angles is None else edge.angles[1] < edge.angles[0]
    return complex(*edge.center), -edge.radius if clockwise else edge.radius


def _tangent_line(edge: Line, before: AnyEdge, after: AnyEdge, number: int) -> Line:
    """A line that touches the circle before it, after it, or both; a stated end is a circle without radius."""
    first, last = (edge.start or before.own_ends()[1]), (edge.end or after.own_ends()[0])
    ends = []
    for side, point, beside in (("start", first, before), ("end", last, after)):
        if edge.tangent in (side, "both"):
            ends.append(_circle(beside, number, edge.name))
        elif point is None:
            raise OutlineError(number, f"the {side} of '{edge.name}' is missing; give it, or tangent: both")
        else:
            ends.append((complex(*point), 0.0))
    (c1, r1), (c2, r2) = ends
    apart = abs(c2 - c1)
    if apart <= abs(r2 - r1):
        message = f"no line is tangent to '{before.name}' and '{after.name}': one circle is inside the other"
        raise OutlineError(number, f"{message}; correct center or radius", "tangent")
    along, part = (c2 - c1) / apart, (r2 - r1) / apart
    normal = part * along + sqrt(1 - part * part) * 1j * along
    return edge.model_copy(update={"start": _pair(c1 - r1 * normal), "end": _pair(c2 - r2 * normal), "tangent": None})


def _tangent_arc(edge: Arc, before: AnyEdge, after: AnyEdge, number: int) -> Arc:
    """An arc of a stated radius that touches two circles; of two such arcs the shorter one."""
    (c1, r1), (c2, r2) = _circle(before, number, edge.name), _circle(after, number, edge.name)
    assert edge.radius is not None, "an arc that is tangent at both ends has one"
    r3 = -edge.radius if edge.clockwise else edge.radius
    found = []
    for center in _meeting(c1, abs(r3 - r1), c2, abs(r3 - r2)):
        if r3 in (r1, r2):
            break
        start, end = ((r * center - r3 * c) / (r - r3) for c, r in ((c1, r1), (c2, r2)))
        sweep = float(np.angle((end - center) / (start - center))) % (2 * np.pi)
        found.append((sweep if r3 > 0 else 2 * np.pi - sweep, center, start, end))
    if not found:
        message = f"no arc of the radius {edge.radius:g} is tangent to '{before.name}' and '{after.name}'"
        raise OutlineError(number, f"{message}; take another radius, or turn clockwise around", "radius")
    _, center, start, end = min(found, key=lambda item: item[0])
    update = {"center": _pair(center), "radius": None, "start": _pair(start), "end": _pair(end), "tangent": None}
    return edge.model_copy(update=update)


def _between(edge: Arc, start: Point | None, end: Point | None, number: int) -> Arc:
    """A circle whose neighbors touch it, as an arc between their ends."""
    assert edge.center is not None
    assert edge.radius is not None
    for side, point in (("start", start), ("end", end)):
        if point is None:
            message = f"the {side} of '{edge.name}' is not known; give angles, the {side}, or a neighbor with tangent"
            raise OutlineError(number, message)
        away = abs(complex(*point) - complex(*edge.center))
        if abs(away - edge.radius) > 1e-6 * edge.radius:
            message = (
                f"the {side} of '{edge.name}', ({point[0]:.6g}, {point[1]:.6g}), has the distance {away:.6g} from the "
                f"center, and its radius is {edge.radius:.6g}; correct one of them"
            )
            raise OutlineError(number, message)
    return edge.model_copy(update={"radius": None, "start": start, "end": end})


def _smooth_arc(edge: Arc, edges: Sequence[AnyEdge], i: int, number: int) -> Arc:
    """An arc between two points that goes on smoothly from the edge before it, or into the edge after it."""
    count = len(edges)
    before, after = edges[i - 1], edges[(i + 1) % count]
    start, end = edge.start or before.own_ends()[1], edge.end or after.own_ends()[0]
    if start is None or end is None:
        side = "start" if start is None else "end"
        raise OutlineError(number, f"the {side} of '{edge.name}' is missing; give it")
    at_start = edge.tangent == "start"
    beside = before if at_start else after
    curve = _curve(
        edges, (i - 1) % count if at_start else (i + 1) % count, {"end": start} if at_start else {"start": end}
    )
    if curve is None:
        raise OutlineError(number, f"the direction of '{beside.name}' is not known; give both its ends", "tangent")
    direction = np.exp(1j * curve.tangent_angle(np.array([1.0 if at_start else 0.0]))[0])
    here, there = (complex(*point) for point in ((start, end) if at_start else (end, start)))
    left = 1j * direction * (1 if at_start else -1)
    offset = there - here
    twice = 2 * (offset * left.conjugate()).real
    if abs(twice) <= SMOOTH * abs(offset):
        raise OutlineError(
            number, f"the ends of '{edge.name}' lie in line with '{beside.name}'; take a line", "tangent"
        )
    radius = abs(offset) ** 2 / twice
    clockwise = bool(radius < 0) == at_start
    update = {
        "center": _pair(here + radius * left),
        "start": start,
        "end": end,
        "clockwise": clockwise,
        "tangent": None,
    }
    return edge.model_copy(update=update)


def _curve(edges: Sequence[AnyEdge], i: int, known: dict[str, Point] | None = None) -> Curve | None:
    """Curve of an edge between its own ends, those of its neighbors, or known ones; None if one is missing."""
    known, edge, count = known or {}, edges[i], len(edges)
    start, end = edge.own_ends()
    start = known.get("start") or start or edges[i - 1].own_ends()[1]
    end = known.get("end") or end or edges[(i + 1) % count].own_ends()[0]
    return None if start is None or end is None else edge.curve(start, end)


def _with_fillets(
    edges: Sequence[AnyEdge], places: Sequence[int], rounded: dict[int, tuple[int, Fillet]]
) -> tuple[AnyEdge, ...]:
    """Edges that end where fillets begin, and the fillets between them as arcs, each after the edge before it."""
    count, curves = len(edges), list[Curve]()
    for i, edge in enumerate(edges):
        curve = _curve(edges, i)
        if curve is None:
            raise OutlineError(places[i], f"an end of '{edge.name}' is missing; give the corner that is rounded")
        curves.append(curve)
    ends, arcs = [[0.0, 1.0] for _ in edges], dict[int, Arc]()
    for i, (number, fillet) in rounded.items():
        j = (i + 1) % count
        arc, first, last = _fillet(fillet, (edges[i], edges[j]), (curves[i], curves[j]), number)
        arcs[i], ends[i][1], ends[j][0] = arc, first, last
    found = list[tuple[int, AnyEdge]]()
    for i, (edge, (low, high)) in enumerate(zip(edges, ends, strict=True)):
        if not low < high:
            number, fillet = rounded.get(i) or rounded[(i - 1) % count]
            message = f"the fillet of radius {fillet.fillet:g} does not fit on '{edge.name}'; take a smaller one"
            raise OutlineError(number, message, "fillet")
        found.append((places[i], _part(edge, curves[i], low, high)))
        if i in arcs:
            found.append((rounded[i][0], arcs[i]))
    return tuple(edge for _, edge in sorted(found, key=lambda item: item[0]))


def _fillet(
    fillet: Fillet, edges: tuple[AnyEdge, AnyEdge], curves: tuple[Curve, Curve], number: int
) -> tuple[Arc, float, float]:
    """A fillet as an arc, and the fractions of the length where the edge before it ends and that after it begins."""
    radius, (before, after) = fillet.fillet, edges
    corner = complex(*curves[0].at(np.array([1.0]))[0])
    directions = [
        np.exp(1j * curve.tangent_angle(np.array([at]))[0]) for curve, at in zip(curves, (1.0, 0.0), strict=True)
    ]
    turn = (directions[0].conjugate() * directions[1]).imag
    if abs(turn) <= SMOOTH:
        raise OutlineError(
            number, f"'{before.name}' goes on smoothly in '{after.name}'; there is no corner to round", "fillet"
        )
    side = 1.0 if turn > 0 else -1.0
    lines = []
    for edge, curve, direction in zip(edges, curves, directions, strict=True):
        if isinstance(edge, Line):
            lines.append((corner + side * radius * 1j * direction, complex(direction), None))
        elif isinstance(edge, Arc):
            center, own = complex(*edge.center), abs(corner - complex(*edge.center))
            signed = own if curve.tangent_angle(np.array([1.0]))[0] > curve.tangent_angle(np.array([0.0]))[0] else -own
            offset = signed - side * radius
            if offset * signed <= 0:
                raise OutlineError(number, f"a fillet of radius {radius:g} is too large for '{edge.name}'", "fillet")
            lines.append((center, 0j, abs(offset)))
        else:
            raise OutlineError(
                number, f"'{edge.name}' is an ellipse or a spline; only lines and arcs have fillets", "fillet"
            )
    centers = [*_crossings(*lines)]
    if not centers:
        raise OutlineError(
            number, f"no circle of radius {radius:g} touches '{before.name}' and '{after.name}'", "fillet"
        )
    center = min(centers, key=lambda point: abs(point - corner))
    touch = list[complex]()
    for edge, direction in zip(edges, directions, strict=True):
        if isinstance(edge, Arc):
            middle = complex(*edge.center)
            touch.append(middle + (center - middle) / abs(center - middle) * abs(corner - middle))
        else:
            touch.append(center - side * radius * 1j * complex(direction))
    fractions = [curve.fraction_at(_pair(point)) for curve, point in zip(curves, touch, strict=True)]
    arc = Arc(
        name=fillet.name or f"{before.name}-{after.name}", center=_pair(center), start=_pair(touch[0]),
        end=_pair(touch[1]), clockwise=side < 0, elements=fillet.elements, grading=fillet.grading,
        ends_at=fillet.ends_at,
    )  # fmt: skip
    return arc, fractions[0], fractions[1]


def _crossings(
    one: tuple[complex, complex, float | None], other: tuple[complex, complex, float | None]
) -> Iterator[complex]:
    """Common points of two lines (point, direction, None) or circles (center, 0, radius)."""
    if one[2] is not None and other[2] is not None:
        yield from _meeting(one[0], one[2], other[0], other[2])
    elif one[2] is None and other[2] is None:
        across = (one[1].conjugate() * other[1]).imag
        yield one[0] + one[1] * ((other[0] - one[0]).conjugate() * other[1]).imag / across
    else:
        (point, direction, _), (center, _, radius) = (one, other) if one[2] is None else (other, one)
        assert radius is not None
        foot = point + direction * ((center - point) * direction.conjugate()).real
        rest = radius**2 - abs(center - foot) ** 2
        if rest >= 0:
            yield from (foot + direction * sqrt(rest) * sign for sign in (1, -1))


def _meeting(c1: complex, r1: float, c2: complex, r2: float) -> Iterator[complex]:
    """Common points of two circles."""
    apart = abs(c2 - c1)
    if not apart or not isfinite(apart):
        return
    along = (r1**2 - r2**2 + apart**2) / (2 * apart)
    rest = r1**2 - along**2
    if rest >= -((1e-12 * max(r1, r2)) ** 2):
        direction = (c2 - c1) / apart
        yield from (c1 + direction * (along + 1j * sign * sqrt(max(rest, 0.0))) for sign in (1, -1))


def _part(edge: AnyEdge, curve: Curve, low: float, high: float) -> AnyEdge:
    """An edge between two fractions of its length, with both ends."""
    if (low, high) == (0.0, 1.0) and not isinstance(edge, Line):
        return edge
    if isinstance(edge, Arc) and edge.angles is not None:
        first, last = edge.angles
        angles = (first + low * (last - first), first + high * (last - first))
        return edge.model_copy(update={"angles": angles})
    start, end = (_pair(complex(*point)) for point in curve.at(np.array([low, high])))
    return edge.model_copy(update={"start": start, "end": end})


def _pair(point: complex) -> Point:
    return float(point.real), float(point.imag)


def mirrored_loop(loop: Sequence[AnyEdge], mirror: Mirror) -> tuple[AnyEdge, ...]:
    """An open half of a loop and its mirror image; `OutlineError` if its ends are not on the mirror line."""
    first, last = loop[0].own_ends()[0], loop[-1].own_ends()[1]
    points = [complex(*point) for edge in loop for point in edge.own_ends() if point is not None]
    size = max((abs(point - points[0]) for point in points), default=0.0)
    for number, side, point in ((0, "start", first), (len(loop) - 1, "end", last)):
        name = loop[number].name
        if point is None:
            raise OutlineError(
                number, f"give the {side} of '{name}': the half outline begins and ends on the mirror line"
            )
        if mirror.distance(point) > ON_LINE * size:
            message = f"the {side} of '{name}' is {mirror.distance(point):.3g} away from the mirror line {mirror.words}"
            raise OutlineError(number, f"{message}; the half outline begins and ends on it", side)
    for number, edge in enumerate(loop):
        ends = [point for point in edge.own_ends() if point is not None]
        if (
            isinstance(edge, Line)
            and len(ends) == 2
            and all(mirror.distance(point) <= ON_LINE * size for point in ends)
        ):
            raise OutlineError(number, f"'{edge.name}' lies on the mirror line, inside the whole body; leave it out")
    return (*loop, *mirror_image(loop, mirror))


def mirror_image(loop: Sequence[AnyEdge], mirror: Mirror) -> tuple[AnyEdge, ...]:
    """The mirror image of edges, in the order in which the body is on their left."""
    return tuple(_image(edge, mirror) for edge in reversed(loop))


def _image(edge: AnyEdge, mirror: Mirror) -> AnyEdge:
    """The mirror image of an edge, which runs the other way."""
    changes: dict[str, Any] = {"name": f"{edge.name}{MIRRORED}"}
    if isinstance(edge, SplineEdge):
        changes["points"] = tuple(map(mirror.image, reversed(edge.points)))
        for key, direction in (("start_direction", edge.end_direction), ("end_direction", edge.start_direction)):
            changes[key] = None if direction is None else mirror.direction(direction)
    if isinstance(edge, Line | Arc):
        changes["start"], changes["end"] = (None if at is None else mirror.image(at) for at in (edge.end, edge.start))
    if isinstance(edge, Arc | EllipseArc):
        changes["center"] = mirror.image(edge.center)
        if edge.angles is not None:
            turn = 180.0 if mirror.x is not None else 0.0
            changes["angles"] = (turn - edge.angles[1], turn - edge.angles[0])
        if not isinstance(edge, Arc):
            changes["rotation"] = -edge.rotation
    changes["ends_at"] = tuple(_other_place(place, mirror) for place in reversed(edge.ends_at))
    if edge.grading is not None:
        towards = edge.grading.towards
        other = {"start": "end", "end": "start"}
        towards = other.get(towards, towards) if isinstance(towards, str) else _other_place(towards, mirror)
        changes["grading"] = Grading.model_construct(ratio=edge.grading.ratio, towards=towards)
    return edge.model_copy(update=changes)


def _other_place(place: Place, mirror: Mirror) -> Place:
    """A place on the mirror image: a fraction from its other end, or a point."""
    return mirror.image(place) if isinstance(place, tuple) else 1 - place


def issue_at(error: OutlineError, path: KeyPath) -> Issue:
    """The issue of an outline that cannot be written out, below the path of its loop."""
    return Issue(path=(*path, *error.issue.path), message=error.issue.message)
