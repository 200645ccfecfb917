"""Outlines from files: drawings of CAD programs in DXF, and lists of points."""

import os
import re
from cmath import phase, rect
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from itertools import pairwise
from math import degrees, pi
from pathlib import Path
from typing import Any

from bemcontact.checks.arguments import file_path, real_number, texts
from bemcontact.errors import Issue, ProblemError
from bemcontact.frozen import frozen_value
from bemcontact.problems.geometry import MOST_POINTS
from bemcontact.problems.units import METERS
from bemcontact.spec.point_list import boundary_of_points

JOINED = 1e-6
"""Distance of two ends over the size of the drawing up to which they are one point: CAD programs round."""
IGNORED = ("TEXT", "MTEXT", "DIMENSION", "POINT", "HATCH", "LEADER", "MULTILEADER", "ATTDEF", "VIEWPORT", "IMAGE")
"""Kinds of entities that are no outline."""
OF_DRAWING = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 13: "µm", 14: "dm"}
"""Number of the unit of a drawing ($INSUNITS) -> its label."""
POINTS = (".csv", ".txt", ".dat")
"""Endings of files with lists of points."""
UNNAMED = "edge"
"""Name of edges on the layer 0, before their numbers."""
SMOOTH = 1e-6
"""Turn in radians where a closed spline begins that is no corner."""
TURN = pi / 90
"""Largest turn in radians between points of a spline: a smooth edge through them has its curvature to 1e-4."""
CHORDS = 32
"""Chords of a curve whose area is summed."""

Edge = dict[str, Any]


@frozen_value
class DrawnPiece:
    """A line, an arc, a piece of an ellipse or a smooth curve of a drawing; points are complex numbers x + iy.

    Parameters
    ----------
    start, end : its ends; equal for a whole circle or ellipse
    layer : name of its layer
    shape : what an edge has besides its name and its ends
    angles : first and last angle of an arc or an ellipse in degrees; None for others
    through : points of a smooth curve from its start to its end; none of others
    directions : of travel at its ends
    """

    start: complex
    end: complex
    layer: str
    shape: Mapping[str, Any]
    angles: tuple[float, float] | None = None
    through: tuple[complex, ...] = ()
    directions: tuple[complex, complex] = (0j, 0j)

    @property
    def closed(self) -> bool:
        """Whether it is a loop by itself."""
        if self.through:
            return self.start == self.end
        return self.angles is not None and abs(abs(self.angles[1] - self.angles[0]) - 360) < 1e-9

    @property
    def turned(self) -> "DrawnPiece":
        """The same piece from its end to its start."""
        angles, (first, last) = None if self.angles is None else (self.angles[1], self.angles[0]), self.directions
        return replace(
            self, start=self.end, end=self.start, angles=angles, through=self.through[::-1], directions=(-last, -first)
        )

    def points(self) -> list[complex]:
        """Points from its start on, without its end."""
        if self.angles is None:
            return [self.start, *self.through[1:-1]]
        (first, last), (x, y) = self.angles, self.shape["center"]
        a, b = self.shape.get("semi_axes") or (self.shape["radius"],) * 2
        turn = rect(1, self.shape.get("rotation", 0.0) * pi / 180)
        steps = (pi / 180 * (first + (last - first) * i / CHORDS) for i in range(CHORDS))
        return [complex(x, y) + turn * complex(a * rect(1, t).real, b * rect(1, t).imag) for t in steps]

    def edge(self, name: str) -> Edge:
        """The edge of a boundary."""
        if self.through:
            points = [_pair(point) for point in (self.start, *self.through[1:-1], self.end)]
            ends = zip(("start_direction", "end_direction"), self.directions, strict=True)
            directions = {} if self.closed else {key: _pair(way) for key, way in ends}
            return {"name": name, **self.shape, "points": points, **directions}
        if self.angles is None:
            return {"name": name, "start": _pair(self.start), "end": _pair(self.end)}
        first, last = self.angles
        if self.shape["kind"] == "arc" and not self.closed:
            ends = {"start": _pair(self.start), "end": _pair(self.end), "clockwise": last < first}
            return {"name": name, "kind": "arc", "center": self.shape["center"], **ends}
        return {"name": name, **self.shape, "angles": [first, last]}


def outline(
    path: str | os.PathLike[str], layer: str | Sequence[str] | None = None, scale: float = 1.0
) -> dict[str, Any]:
    """Read the outline of a body from a drawing in DXF, with the extra ``cad``, or from a list of points.

    Parameters
    ----------
    path : the file; one that ends in .csv, .txt or .dat has a point x, y in each line, and an empty line between loops.
        Corners, straight pieces, arcs and smooth curves are recognized
    layer : name of the only layer of a drawing that is read, or a list of the layers that are; all of them if None
    scale : factor of all coordinates

    Returns
    -------
    dict
        The value of ``boundary`` in a problem: ``outer`` and ``holes``. Edges have the name of their layer, with a
        number if it has several; those of the layer 0, of an only layer, and of points are called edge. Numbers run
        around each loop from its lowest point, and start at the outer one.

    Raises
    ------
    ProblemError
        If there is no such file or layer, or its pieces make no closed loops: the text says where.
    """
    file = file_path(path, "path")
    number = real_number(scale, "scale")
    if number <= 0:
        raise ProblemError(f"scale must be greater than 0; found {number:g}")
    wanted = layer if layer is None or isinstance(layer, str) else texts(layer, "layer")
    if file.suffix.lower() in POINTS:
        return _of_points(file, wanted, number)
    return boundary_of(drawn_pieces(_drawing(file), wanted, number), str(file))


def with_outlines(data: Any, folder: Path) -> Any:
    """The data of a spec with the edges of drawings in place of their files; `ProblemError` at their key paths."""
    if not isinstance(data, Mapping):
        return data
    units, changed, issues = data.get("units"), dict(data), list[Issue]()
    length = units.get("length") if isinstance(units, Mapping) else None
    for path, stated in _boundaries(data):
        try:
            read = _read(stated, folder, length)
        except ProblemError as error:
            issues += [Issue(path=(*path, *(issue.path or ("file",))), message=issue.message) for issue in error.issues]
            continue
        if len(path) == 1:
            changed["boundary"] = read
        else:
            body = {**changed["bodies"][path[1]], "boundary": read}
            changed["bodies"] = {**changed["bodies"], path[1]: body}
    if issues:
        raise ProblemError(issues)
    return changed


def has_outline(data: Any) -> bool:
    """Whether a spec has a drawing."""
    return isinstance(data, Mapping) and any(True for _ in _boundaries(data))


def _boundaries(data: Mapping[Any, Any]) -> Iterator[tuple[tuple[str, ...], Mapping[str, Any]]]:
    """Key paths and values of the boundaries that name a file."""
    bodies = data.get("bodies")
    every: dict[tuple[str, ...], Any] = {("boundary",): data.get("boundary")}
    for name, body in bodies.items() if isinstance(bodies, Mapping) else ():
        if isinstance(body, Mapping):
            every["bodies", str(name), "boundary"] = body.get("boundary")
    for path, stated in every.items():
        if isinstance(stated, Mapping) and isinstance(stated.get("file"), str):
            yield path, stated


def _read(stated: Mapping[str, Any], folder: Path, length: Any) -> dict[str, Any]:
    """The boundary of a drawing, with the other keys that are stated beside the file."""
    others = {key: value for key, value in stated.items() if key not in ("file", "layer", "scale")}
    if "outer" in others:
        raise ProblemError(Issue(path=("outer",), message="the edges are those of the file; leave them out"))
    layer, scale = stated.get("layer"), stated.get("scale")
    if layer is not None and not all(isinstance(one, str) for one in (layer if isinstance(layer, list) else [layer])):
        raise ProblemError(Issue(path=("layer",), message="a layer is a text, or a list of texts; write it in quotes"))
    if scale is not None and (isinstance(scale, bool) or not isinstance(scale, int | float) or scale <= 0):
        raise ProblemError(Issue(path=("scale",), message=f"scale is a number greater than 0; found {scale!r}"))
    if Path(stated["file"]).suffix.lower() in POINTS:
        return {**_of_points(folder / stated["file"], layer, float(scale or 1.0)), **others}
    drawing = _drawing(folder / stated["file"])
    unit = OF_DRAWING.get(int(drawing.header.get("$INSUNITS", 0)))
    if scale is None and unit and isinstance(length, str) and length in METERS and METERS[length] != METERS[unit]:
        message = (
            f"the drawing is in {unit}, and the problem in {length}; give scale: {METERS[unit] / METERS[length]:g}"
        )
        raise ProblemError(Issue(path=("file",), message=message))
    read = boundary_of(drawn_pieces(drawing, layer, float(scale or 1.0)), stated["file"])
    return {**read, **others}


def _of_points(path: Path, layer: str | Sequence[str] | None, scale: float) -> dict[str, Any]:
    """The boundary of a list of points, which has no layers."""
    if layer is not None:
        raise ProblemError(Issue(path=("layer",), message="a list of points has no layers; leave it out"))
    if not path.is_file():
        raise ProblemError(f"{path}: there is no such file")
    return boundary_of_points(path, scale)


def _drawing(path: Path) -> Any:
    """The drawing in a file."""
    if find_spec("ezdxf") is None:
        raise ProblemError("drawings need the extra cad: pip install 'bemcontact[cad]'")
    if not path.is_file():
        raise ProblemError(f"{path}: there is no such file")
    ezdxf = import_module("ezdxf")
    try:
        return ezdxf.readfile(path)
    except (OSError, ezdxf.DXFError, UnicodeDecodeError) as error:
        raise ProblemError(f"{path} is no drawing in DXF: {error}") from None


def drawn_pieces(drawing: Any, layer: str | Sequence[str] | None, scale: float) -> list[DrawnPiece]:
    """The pieces of a drawing, of all layers, of some, or of one, whose name they do not have."""
    entities = [*_entities(drawing.modelspace())]
    layers = [*dict.fromkeys(name for _, name in entities)]
    wanted = layers if layer is None else [layer] if isinstance(layer, str) else layer
    for name in wanted:
        if name not in layers:
            message = f"the drawing has no outline on the layer '{name}'; there are: {', '.join(layers) or 'none'}"
            raise ProblemError(Issue(path=("layer",), message=message))
    pieces = [piece for entity, name in entities if name in wanted for piece in _pieces(entity, name, scale)]
    if not pieces:
        raise ProblemError("the drawing has no lines, arcs, circles, ellipses, splines or polylines")
    return [replace(piece, layer="0") for piece in pieces] if isinstance(layer, str) else pieces


def _entities(entities: Iterable[Any], around: str = "0") -> Iterator[tuple[Any, str]]:
    """Single entities and their layers; in a block the layer 0 is that of the block."""
    for entity in entities:
        kind, layer = entity.dxftype(), around if entity.dxf.layer == "0" else entity.dxf.layer
        if kind in ("LWPOLYLINE", "POLYLINE", "INSERT"):
            yield from _entities(entity.virtual_entities(), layer)
        elif kind not in IGNORED:
            yield entity, layer


def _pieces(entity: Any, layer: str, scale: float) -> Iterator[DrawnPiece]:
    """The pieces of a single entity."""
    kind, dxf = entity.dxftype(), entity.dxf
    if kind == "LINE":
        yield DrawnPiece(start=_point(dxf.start, scale), end=_point(dxf.end, scale), layer=layer, shape={})
        return
    if kind == "SPLINE":
        yield from _spline_pieces(entity, layer, scale)
        return
    if kind not in ("ARC", "CIRCLE", "ELLIPSE"):
        raise ProblemError(
            f"the drawing has an entity {kind} on the layer '{layer}', which is no line, arc, ellipse or spline; "
            "convert it to a polyline with arcs, or name the other layers in layer"
        )
    mirrored = dxf.extrusion.z < 0
    if kind == "ELLIPSE":
        axis, first, last = dxf.major_axis, degrees(dxf.start_param), degrees(dxf.end_param)
        shape = {
            "kind": "ellipse", "center": _pair(_point(dxf.center, scale)),
            "semi_axes": [axis.magnitude * scale, axis.magnitude * dxf.ratio * scale],
            "rotation": degrees(phase(complex(axis.x, axis.y))),
        }  # fmt: skip
        last += 360.0 * (last <= first)
        first, last = (-first, -last) if mirrored else (first, last)
    else:
        center = _point(entity.ocs().to_wcs(dxf.center), scale)
        shape = {"kind": "arc", "center": _pair(center), "radius": dxf.radius * scale}
        first, last = (0.0, 360.0) if kind == "CIRCLE" else (dxf.start_angle, dxf.end_angle)
        last += 360.0 * (last <= first)
        first, last = (180 - first, 180 - last) if mirrored else (first, last)
    piece = DrawnPiece(start=0j, end=0j, layer=layer, shape=shape, angles=(first, last))
    ends = [piece.points()[0], replace(piece, angles=(last, first)).points()[0]]
    yield replace(piece, start=ends[0], end=ends[0] if piece.closed else ends[1])


def _spline_pieces(entity: Any, layer: str, scale: float) -> Iterator[DrawnPiece]:
    """The smooth curves of a spline (NURBS) between its corners, through points of it."""
    curve = entity.construction_tool()
    every = curve.knots()
    begin, end = every[curve.degree], every[curve.count]  # knots beyond belong to no place of the curve
    knots = [knot for knot in every if begin <= knot <= end]
    corners = [knot for knot in dict.fromkeys(knots) if knots.count(knot) >= curve.degree or knot in (begin, end)]
    for first, last in pairwise(corners):
        spans = [*pairwise(dict.fromkeys(knot for knot in knots if first <= knot <= last))]
        until = last - 1e-12 * (last - first) * (last < end)  # the side of a corner that belongs to this curve
        at = [*(start + (stop - start) * i / 4 for start, stop in spans for i in range(4)), until]
        while len(at) <= MOST_POINTS:
            derivatives = [[_point(vector, scale) for vector in pair] for pair in curve.derivatives(at, n=1)]
            if stills := [place for place, way in derivatives if not way]:
                message = f"a spline on the layer '{layer}' has no direction at {_words(stills[0])}; draw it anew"
                raise ProblemError(message)
            turns = (abs(phase(other / one)) for (_, one), (_, other) in pairwise(derivatives))
            between = [(one + other) / 2 for (one, other), turn in zip(pairwise(at), turns, strict=True) if turn > TURN]
            if not between:
                break
            at = sorted([*at, *between])
        else:
            message = f"a spline on the layer '{layer}' needs more than {MOST_POINTS} points; draw it in several parts"
            raise ProblemError(message)
        points, ways = ([pair[i] for pair in derivatives] for i in (0, 1))
        stops = [0, len(at) - 1]
        if abs(points[-1] - points[0]) <= 1e-9 * max(abs(point - points[0]) for point in points):
            points[-1] = points[0]
            if abs(phase(ways[-1] / ways[0])) > SMOOTH:
                stops.insert(1, len(at) // 2)  # one edge that is closed would be smooth at this corner
        for i, j in pairwise(stops):
            yield DrawnPiece(
                start=points[i], end=points[j], layer=layer, shape={"kind": "spline"}, through=tuple(points[i : j + 1]),
                directions=(ways[i], ways[j]),
            )  # fmt: skip


def boundary_of(pieces: Sequence[DrawnPiece], name: str) -> dict[str, Any]:
    """The loops that pieces make: the largest is the outer one, the others are holes."""
    every = [point for piece in pieces for point in piece.points()]
    size = abs(
        complex(
            max(p.real for p in every) - min(p.real for p in every),
            max(p.imag for p in every) - min(p.imag for p in every),
        )
    )
    loops = _chained(pieces, JOINED * size, name)
    loops = sorted((_oriented(loop) for loop in loops), key=lambda loop: -abs(_area(loop)))
    loops = [loop if number == 0 else [piece.turned for piece in reversed(loop)] for number, loop in enumerate(loops)]
    loops = [_from_lowest(loop) for loop in loops]
    counts: dict[str, int] = {}
    for loop in loops:
        for piece in loop:
            counts[_base(piece)] = counts.get(_base(piece), 0) + 1
    used, named = dict[str, int](), list[list[Edge]]()
    for loop in loops:
        named.append([])
        for piece in loop:
            base = _base(piece)
            used[base] = used.get(base, 0) + 1
            named[-1].append(piece.edge(f"{base} {used[base]}" if counts[base] > 1 else base))
    outer, *holes = named
    return {"outer": outer, **({"holes": holes} if holes else {})}


def _chained(pieces: Sequence[DrawnPiece], tolerance: float, name: str) -> list[list[DrawnPiece]]:
    """Loops of pieces that end where the next begins; `ProblemError` with the place of what does not."""
    nodes = list[complex]()
    ends = list[tuple[int, int]]()
    for piece in pieces:
        if abs(piece.end - piece.start) <= tolerance and piece.angles is None and not piece.through:
            raise ProblemError(f"{name} has a line without length at {_words(piece.start)}; remove it")
        ends.append((_node(piece.start, nodes, tolerance), _node(piece.end, nodes, tolerance)))
    _ensure_closed(pieces, ends, nodes, tolerance, name)
    loops = [[piece] for piece in pieces if piece.closed]
    left = {number for number, piece in enumerate(pieces) if not piece.closed}
    while left:
        first = min(left)
        left.discard(first)
        start, at = ends[first]
        loop = [_between(pieces[first], nodes[start], nodes[at])]
        while at != start:
            number = next(i for i in sorted(left) if at in ends[i])
            left.discard(number)
            turned = ends[number][0] != at
            piece = pieces[number].turned if turned else pieces[number]
            here, at = at, ends[number][0 if turned else 1]
            loop.append(_between(piece, nodes[here], nodes[at]))
        loops.append(loop)
    return loops


def _node(point: complex, nodes: list[complex], tolerance: float) -> int:
    """Number of the node at a point; a new one if there is none."""
    for number, node in enumerate(nodes):
        if abs(node - point) <= tolerance:
            return number
    nodes.append(point)
    return len(nodes) - 1


def _ensure_closed(
    pieces: Sequence[DrawnPiece], ends: Sequence[tuple[int, int]], nodes: Sequence[complex], tolerance: float, name: str
) -> None:
    """Refuse open outlines, pieces on each other, and places where more than two pieces meet."""
    issues = list[str]()
    for i, (piece, own) in enumerate(zip(pieces, ends, strict=True)):
        for other, its in zip(pieces[:i], ends[:i], strict=True):
            middle, there = _middle(piece), _middle(other)
            if {*own} == {*its} and abs(middle - there) <= tolerance:
                issues.append(
                    f"two pieces lie on each other at {_words(middle)}; remove one of them{_without(piece, pieces)}"
                )
    joints = {end for piece, pair in zip(pieces, ends, strict=True) if not piece.closed for end in pair}
    for number, node in enumerate(nodes):
        meeting = [piece for piece, pair in zip(pieces, ends, strict=True) for end in pair if end == number]
        if (count := len(meeting)) == 1:
            near = min((nodes[j] for j in joints - {number}), key=lambda other: abs(other - node), default=node)
            issues.append(
                f"the outline is open at {_words(node)}; the nearest other end is {abs(near - node):.3g} away, at "
                f"{_words(near)}: join them, or remove what is no outline{_without(meeting[0], pieces)}"
            )
        elif count > 2 and not issues:
            issues.append(
                f"{count} ends meet at {_words(node)}; an outline has two there: remove lines inside the body"
            )
    if issues:
        raise ProblemError([Issue(path=(), message=f"{name}: {text}") for text in issues[:10]])


def _without(piece: DrawnPiece, pieces: Sequence[DrawnPiece]) -> str:
    """How to read a drawing without the layer of a piece; empty if there is no other layer."""
    others = [layer for layer in dict.fromkeys(other.layer for other in pieces) if layer != piece.layer]
    if not others:
        return ""
    return f", or leave out the layer '{piece.layer}': layer: [{', '.join(map(repr, others))}]"


def _between(piece: DrawnPiece, start: complex, end: complex) -> DrawnPiece:
    """A piece whose ends are nodes."""
    return replace(piece, start=start, end=end)


def _middle(piece: DrawnPiece) -> complex:
    """A point in the middle of a piece."""
    if piece.through:
        return piece.through[len(piece.through) // 2]
    return (piece.start + piece.end) / 2 if piece.angles is None else piece.points()[CHORDS // 2]


def _area(loop: Sequence[DrawnPiece]) -> float:
    """Area of a loop, positive if it runs counterclockwise."""
    points = [point for piece in loop for point in piece.points()]
    pairs = zip(points, [*points[1:], points[0]], strict=True)
    return sum((one.conjugate() * other).imag for one, other in pairs) / 2


def _oriented(loop: list[DrawnPiece]) -> list[DrawnPiece]:
    """A loop counterclockwise."""
    return loop if _area(loop) > 0 else [piece.turned for piece in reversed(loop)]


def _from_lowest(loop: list[DrawnPiece]) -> list[DrawnPiece]:
    """A loop that begins at its lowest corner, the left one of several."""
    first = min(range(len(loop)), key=lambda i: (round(loop[i].start.imag, 9), loop[i].start.real))
    return loop[first:] + loop[:first]


def _base(piece: DrawnPiece) -> str:
    """Name of an edge without its number: that of its layer, without characters that names may not have."""
    return UNNAMED if piece.layer in ("0", "") else re.sub(r"[.\[\]=/]", "-", piece.layer)


def _point(point: Any, scale: float) -> complex:
    return scale * complex(point.x, point.y)


def _pair(point: complex) -> list[float]:
    return [point.real, point.imag]


def _words(point: complex) -> str:
    return f"({point.real:.6g}, {point.imag:.6g})"
