"""Outlines from lists of points: corners, straight pieces, arcs and smooth curves are recognized."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bemcontact.arrays import Array
from bemcontact.errors import ProblemError
from bemcontact.files.text import text_of
from bemcontact.problems.curves import cross
from bemcontact.problems.wording import is_number

SHARP = 60.0
"""Turn at a point in degrees from which it is a corner."""
CORNER, AGAINST = 20.0, 3.0
"""Turn in degrees from which a point is a corner if its neighbors turn less by a factor."""
LONG = 4.0
"""Length over the median one of a loop from which a piece between two points is a line of its own."""
FIT = 1e-6
"""Distance over the size of the loop up to which points are on a line or a circle."""
FEWEST = 4
"""Number of points from which they may make an arc."""

Edge = dict[str, Any]


def boundary_of_points(path: Path, scale: float) -> dict[str, Any]:
    """The loops of a file with two coordinates in each line, the outer one first.

    Loops are separated by empty lines, in any order and direction. The last point may be the first again. A first line
    without any number is a header.
    """
    loops = [loop * scale for loop in _loops(path)]
    loops = [loop if _area(loop) > 0 else loop[::-1] for loop in loops]
    loops.sort(key=lambda loop: -_area(loop))
    edges = [_edges(loop if number == 0 else loop[::-1]) for number, loop in enumerate(loops)]
    count, several = 0, sum(map(len, edges)) > 1
    for loop in edges:
        for edge in loop:
            count += 1
            edge["name"] = f"edge {count}" if several else "edge"
    outer, *holes = edges
    return {"outer": outer, **({"holes": holes} if holes else {})}


def _loops(path: Path) -> list[Array]:
    """Points (k, 2) of each loop of a file; `ProblemError` with the line of what is no point."""
    loops, lines = [list[tuple[float, float]]()], text_of(path).splitlines()
    for number, line in enumerate(lines, 1):
        words = [word for word in re.split(r"[;\t ]+|,\s*", line.strip()) if word]
        if not words:
            loops.append([])
            continue
        try:
            x, y = map(float, words)
        except ValueError:
            numbers = [word for word in words if is_number(word)]
            if number == 1 and not numbers:
                continue
            message = f"expected two numbers, x and y, with a comma or a blank between; found {line.strip()[:40]!r}"
            message += "; the decimal sign is a point" if "," in line and len(numbers) == len(words) == 4 else ""
            raise ProblemError(f"{path}:{number}: {message}") from None
        if not np.isfinite([x, y]).all():
            raise ProblemError(f"{path}:{number}: expected finite numbers; found {line.strip()[:40]!r}")
        if loops[-1] and loops[-1][-1] == (x, y):
            raise ProblemError(f"{path}:{number}: the point ({x:g}, {y:g}) occurs twice after itself; remove one")
        loops[-1].append((x, y))
    closed = [np.array(loop[:-1] if loop[0] == loop[-1] else loop) for loop in loops if len(loop) > 1]
    for loop in closed:
        if len(loop) < 3:
            raise ProblemError(f"{path}: an outline needs three points; found {len(loop)}")
    if not closed:
        raise ProblemError(f"{path}: there are no points")
    return closed


def _edges(loop: Array) -> list[Edge]:
    """Edges of a loop, without names."""
    stops, size = _stops(loop), float(np.hypot(*np.ptp(loop, axis=0)))
    if not len(stops):
        found = _circle(loop, FIT * size)
        if found is not None:
            return [{"kind": "arc", "center": found[0], "radius": found[1], "angles": _whole_turn(loop, found[0])}]
        return [{"kind": "spline", "points": [*loop.tolist(), loop[0].tolist()]}]
    edges = list[Edge]()
    for first, last in zip(stops, [*stops[1:], stops[0] + len(loop)], strict=True):
        run = loop[np.arange(first, last + 1) % len(loop)]
        edges += _edges_of_run(run, FIT * size)
    return edges


def _edges_of_run(run: Array, near: float) -> list[Edge]:
    """The edge through points between two stops: a line, an arc or a smooth curve; two points have a line."""
    start, end = run[0].tolist(), run[-1].tolist()
    if len(run) == 2 or _off_chord(run) <= near:
        return [{"start": start, "end": end}]
    found = _circle(run, near) if len(run) >= FEWEST else None
    if found is not None:
        left = cross(run[1] - run[0], run[2] - run[1]) > 0
        return [{"kind": "arc", "center": found[0], "start": start, "end": end, "clockwise": not left}]
    if len(run) == 3:
        return [{"start": run[i].tolist(), "end": run[i + 1].tolist()} for i in range(2)]
    directions = _direction(run[:3]), -np.array(_direction(run[:-4:-1]))
    points = {"kind": "spline", "points": run.tolist()}
    return [{**points, "start_direction": directions[0], "end_direction": directions[1].tolist()}]


def _stops(loop: Array) -> list[int]:
    """Numbers of the points at which edges end: corners, and the ends of long straight pieces."""
    pieces = np.roll(loop, -1, axis=0) - loop
    lengths = np.hypot(*pieces.T)
    before = np.roll(pieces, 1, axis=0)
    turn = abs(np.degrees(np.arctan2(cross(before, pieces), np.sum(before * pieces, axis=1))))
    beside = np.maximum(np.roll(turn, 1), np.roll(turn, -1))
    corner = (turn >= SHARP) | ((turn >= CORNER) & (turn > AGAINST * beside))
    long = lengths > LONG * np.median(lengths)
    stop = corner | long | np.roll(long, 1)
    return np.flatnonzero(stop).tolist()


def _off_chord(run: Array) -> float:
    """Largest distance of points from the line through both ends."""
    chord = run[-1] - run[0]
    return float(abs(cross(chord, run - run[0])).max() / max(np.hypot(*chord), 1e-300))


def _circle(points: Array, near: float) -> tuple[list[float], float] | None:
    """Center and radius of the circle on which points are; None if they are not."""
    middle = points.mean(axis=0)
    x = points - middle
    solved, _, rank, _ = np.linalg.lstsq(np.column_stack([2 * x, np.ones(len(x))]), np.sum(x**2, axis=1), rcond=None)
    if rank < 3:
        return None
    center, radius = solved[:2], float(np.sqrt(solved[2] + solved[:2] @ solved[:2]))
    if abs(np.hypot(*(x - center).T) - radius).max() > near:
        return None
    return (center + middle).tolist(), radius


def _whole_turn(loop: Array, center: Sequence[float]) -> list[float]:
    """Angles of a whole circle that begins at the first point."""
    first = float(np.degrees(np.arctan2(*(loop[0] - center)[::-1])))
    return [first, first + (360.0 if _area(loop) > 0 else -360.0)]


def _direction(three: Array) -> list[float]:
    """Direction at the first of three points of the circle through them."""
    one, two = three[1] - three[0], three[2] - three[1]
    direction = one / np.hypot(*one) - two / np.hypot(*two)
    found = one / np.hypot(*one) + direction * np.hypot(*one) / (np.hypot(*one) + np.hypot(*two))
    return found.tolist()


def _area(loop: Array) -> float:
    """Area of a polygon, positive if it runs counterclockwise."""
    return float(np.sum(cross(loop, np.roll(loop, -1, axis=0))) / 2)
