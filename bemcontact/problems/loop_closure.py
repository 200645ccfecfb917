"""Open loops of edges, and the change that would close them: edges turned round, another arc, another order."""

from collections.abc import Iterator, Sequence
from itertools import pairwise, product
from math import atan2, degrees, dist, hypot, pi
from typing import Any

from bemcontact.errors import Issue, KeyPath
from bemcontact.problems.geometry import AnyEdge, Arc, Line, SplineEdge
from bemcontact.problems.validation import Point

JOINT_TOLERANCE = 1e-9
"""Distance of two edge ends, relative to the size of the body, up to which they are one point."""

Loop = Sequence[AnyEdge]


def gap_issues(path: KeyPath, loop: Loop, size: float) -> Iterator[Issue]:
    """Issues of the gaps of a loop; edges that run the wrong way round are named instead of their gaps."""
    gaps = _gaps(loop, size)
    if not gaps:
        return
    turned = _turned(loop, size)
    if 0 < 2 * len(turned) <= len(loop):
        for i, text in turned.items():
            gap = next((j for j in (i, (i + 1) % len(loop)) if j in gaps), gaps[0])
            message = f"the loop is open: {_where(loop, gap)}; '{loop[i].name}' runs the wrong way round: give {text}"
            yield Issue(path=(*path, i, *_start_key(loop[i])), message=message)
        return
    arcs = _other_arcs_of(loop, gaps, size)
    if 0 < len(arcs) < len(gaps):
        for i, text in arcs.items():
            where = " and ".join(_where(loop, gap) for gap in (i, (i + 1) % len(loop)) if gap in gaps)
            closes = "which closes the loop" if len(arcs) == 1 else "which closes the loop with the other changes"
            message = f"the loop is open: {where}; give '{loop[i].name}' {text}, {closes}"
            message += _hint_of_radians(loop, i)
            yield Issue(path=(*path, i, text.partition(":")[0]), message=message)
        return
    changes = " and ".join(f"'{loop[i].name}' {text}" for i, text in arcs.items())
    hint = f"; or give {changes}, which closes the loop" if arcs else _hint_of_order(loop, size)
    for i in gaps:
        message = f"the loop is open: {_where(loop, i)}; {_remedy(loop, i)}{hint}{_hint_of_radians(loop, i)}"
        yield Issue(path=(*path, i, *_start_key(loop[i])), message=message)


def other_way_round(edge: AnyEdge) -> tuple[AnyEdge, str] | None:
    """The arc with the same ends on the other side of its center, and how to write it; None for other edges."""
    if isinstance(edge, Line | SplineEdge):
        return None
    if edge.angles is None:
        return _with(edge, clockwise=not edge.clockwise)
    first, last = edge.angles
    return None if abs(last - first) == 360 else _with(edge, angles=(first, last + (360 if last < first else -360)))


def _gaps(loop: Loop, size: float) -> list[int]:
    """Positions of the edges that do not start where the edge before ends."""
    return [i for i, edge in enumerate(loop) if not _joins(loop[i - 1].own_ends()[1], edge.own_ends()[0], size)]


def _joins(end: Point | None, start: Point | None, size: float) -> bool:
    """Whether two ends are one point; one that is left out fits any other."""
    if end is None or start is None:
        return not (end is None and start is None)
    return dist(end, start) <= JOINT_TOLERANCE * size


def _turned(loop: Loop, size: float) -> dict[int, str]:
    """The fewest edges that, turned round, close the loop, and how to write each; empty if nothing does."""
    # a shortest path around the loop: each edge as it is or, if both its ends are given, turned round
    choices = [(edge, *([] if None in edge.own_ends() else [_reversed(edge)[0]])) for edge in loop]
    best: tuple[int, ...] | None = None
    for first in range(len(choices[0])):
        paths: dict[int, tuple[int, ...]] = {first: (first,)}
        for before, here in pairwise(choices):
            paths = _longer(paths, before, here, size)
        for last, way in paths.items():
            closed = _joins(choices[-1][last].own_ends()[1], choices[0][first].own_ends()[0], size)
            if closed and (best is None or sum(way) < sum(best)):
                best = way
    return {i: _reversed(loop[i])[1] for i, turned in enumerate(best or ()) if turned}


def _longer(paths: dict[int, tuple[int, ...]], before: Loop, here: Loop, size: float) -> dict[int, tuple[int, ...]]:
    """Extend the path with the fewest turned edges to each choice of the next edge that joins it."""
    longer: dict[int, tuple[int, ...]] = {}
    for (last, path), (choice, edge) in product(paths.items(), enumerate(here)):
        joined = _joins(before[last].own_ends()[1], edge.own_ends()[0], size)
        if joined and (choice not in longer or sum(path) + choice < sum(longer[choice])):
            longer[choice] = (*path, choice)
    return longer


def _reversed(edge: AnyEdge) -> tuple[AnyEdge, str]:
    """An edge with its ends exchanged, and how to write it; an arc without angles still turns the same way."""
    if isinstance(edge, SplineEdge):
        return edge.model_copy(update={"points": edge.points[::-1]}), "its points in the other order"
    if isinstance(edge, Line) or edge.angles is None:
        return _with(edge, start=edge.end, end=edge.start)
    return _with(edge, angles=edge.angles[::-1])


def _with(edge: AnyEdge, **values: Any) -> tuple[AnyEdge, str]:
    """An edge with other values, and how to write them."""
    return edge.model_copy(update=values), ", ".join(f"{key}: {_yaml(value)}" for key, value in values.items())


def _yaml(value: Any) -> str:
    """Write a number, a flag or a point as in a spec."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(_yaml, value))}]"
    return str(value).lower() if isinstance(value, bool) else f"{value:.12g}"


def _other_arcs_of(loop: Loop, gaps: Sequence[int], size: float) -> dict[int, str]:
    """Arcs with the other radius, center or angles that close the loop, by position; empty if none do."""
    changed, texts = [*loop], dict[int, str]()
    for i in dict.fromkeys(j % len(loop) for gap in gaps for j in (gap, gap - 1)):
        edge, ends = loop[i], (loop[i - 1].own_ends()[1], loop[(i + 1) % len(loop)].own_ends()[0])
        for other, text in _other_arcs(edge, *ends) if isinstance(edge, Arc) else ():
            start, end = other.own_ends()
            if _joins(ends[0], start, size) and _joins(end, ends[1], size):
                changed[i] = other
                texts[i] = text
                break
    return {} if _gaps(changed, size) else texts


def _other_arcs(arc: Arc, start: Point | None, end: Point | None) -> Iterator[tuple[AnyEdge, str]]:
    """Arcs with angles that may join two points, one of which may be unknown, and how to write them."""
    if arc.angles is None or (start is None and end is None):
        return
    (x, y), (first, last) = arc.center, arc.angles
    radii = [hypot(px - x, py - y) for px, py in filter(None, (start, end))]
    yield _with(arc, radius=_rounded(radii[0], radii[0]))
    if start is None or end is None:
        return
    near = (_near(degrees(atan2(py - y, px - x)), angle) for (px, py), angle in ((start, first), (end, last)))
    angles = tuple(_rounded(angle, 360) for angle in near)
    if angles[0] != angles[1]:  # an arc of no length joins its neighbors too
        yield _with(arc, angles=angles)
    if own := arc.own_ends()[0]:
        size = radii[0] + hypot(x, y)
        yield _with(
            arc, center=tuple(_rounded(a + b - c, size) for a, b, c in zip(arc.center, start, own, strict=True))
        )


def _near(angle: float, other: float) -> float:
    """The angle in degrees plus full turns, nearest to another one."""
    return angle + 360 * round((other - angle) / 360)


def _rounded(value: float, scale: float) -> float:
    """A number as it is written, without the round-off that is negligible beside a scale."""
    return 0.0 if abs(value) < 1e-12 * scale else float(f"{value:.12g}")


def _hint_of_order(loop: Loop, size: float) -> str:
    """Say in which other order, with which edges turned round, the loop closes; empty if there is none."""
    if any(None in edge.own_ends() for edge in loop):
        return ""
    chain, rest, turned = [loop[0]], [*loop[1:]], list[str]()
    while rest:
        following = [(edge, edge) for edge in rest] + [(edge, _reversed(edge)[0]) for edge in rest]
        joined = next(
            (pair for pair in following if _joins(chain[-1].own_ends()[1], pair[1].own_ends()[0], size)), None
        )
        if joined is None:
            return ""
        rest.remove(joined[0])
        chain.append(joined[1])
        turned += [f"'{joined[0].name}'"] * (joined[0] is not joined[1])
    around = f" with {' and '.join(turned)} turned round" if turned else ""
    names = ", ".join(f"'{edge.name}'" for edge in chain)
    return "" if _gaps(chain, size) else f"; or list the edges in the order {names}{around}, which closes the loop"


def _where(loop: Loop, i: int) -> str:
    """Describe the gap between an edge and the previous one."""
    edge, before = loop[i], loop[i - 1]
    start, end = edge.own_ends()[0], before.own_ends()[1]
    assert start is not None
    assert end is not None
    return (
        f"'{edge.name}' starts at {_coordinates(start)}, but '{before.name}' before it ends at {_coordinates(end)}, "
        f"{dist(start, end):.6g} away"
    )


def _remedy(loop: Loop, i: int) -> str:
    """Say how to join an edge to the previous one."""
    edge, before = loop[i], loop[i - 1]
    if edge.has_coordinates():
        return "leave the start out to join them"
    return f"leave the end of '{before.name}' out to join them" if before.has_coordinates() else "correct one of them"


def _hint_of_radians(loop: Loop, i: int) -> str:
    """Name the edges beside a gap whose angles may be in radians: they are at most a full turn (rounded) then."""
    angles = {
        edge.name: None if isinstance(edge, Line | SplineEdge) else edge.angles for edge in (loop[i - 1], loop[i])
    }
    suspects = [f"'{name}'" for name, given in angles.items() if given and max(map(abs, given)) <= 2.01 * pi]
    return f"; angles are in degrees, but those of {' and '.join(suspects)} may be in radians" if suspects else ""


def _start_key(edge: AnyEdge) -> KeyPath:
    """Key that gives the start of an edge."""
    return ("start",) if edge.has_coordinates() else ("angles",)


def _coordinates(point: Point) -> str:
    return f"({point[0]:.9g}, {point[1]:.9g})"
