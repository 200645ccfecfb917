"""Edges as the user gives them: lines, circular arcs and elliptic arcs, each with its number of elements."""

from collections.abc import Mapping
from itertools import pairwise
from math import atan2, hypot, pi, radians
from typing import Annotated, Any, ClassVar, Literal, Self, get_args

from pydantic import Field, PlainValidator, Strict, WithJsonSchema, model_validator

from bemcontact.errors import Issue, KeyPath
from bemcontact.problems.curves import CircularArc, Curve, EllipticArc, Segment, unit_vector
from bemcontact.problems.spline_curve import SplineCurve
from bemcontact.problems.tagged_union import TaggedUnion
from bemcontact.problems.validation import (
    LARGEST_STATED,
    Count,
    Flag,
    Name,
    Number,
    Point,
    Positive,
    PositivePair,
    SpecModel,
    invalid,
    left_out,
    validation_error,
)
from bemcontact.problems.wording import described

MOST_ELEMENTS = 10_000
"""Largest number of elements of a problem; its dense matrix takes 13 gigabytes."""
MOST_POINTS = 1000
"""Largest number of points of a spline."""
MOST_ENDS = 100
"""Largest number of places where elements of an edge must end that does not state its elements."""

WHOLE_TURN = 360 * (1 + 1e-12)
"""Largest difference of two angles in degrees: that of a turned circle is a whole turn up to round-off."""
SIDES = ("start", "end", "both", "middle")
"""Names of the places of the short elements of an edge."""


def _place(value: Any) -> float | Point:
    """Validate a place on an edge: a fraction of its length or a point."""
    numbers = value if isinstance(value, list | tuple) else [value]
    if not all(isinstance(number, int | float) and not isinstance(number, bool) for number in numbers):
        raise invalid(f"expected a fraction of the length such as 0.4, or a point [x, y]; found {described(value)}")
    if isinstance(value, list | tuple):
        if len(value) != 2 or not all(abs(number) <= LARGEST_STATED for number in value):
            raise invalid(f"expected two coordinates such as [0.0, 1.5]; found {described(value)}")
        return float(value[0]), float(value[1])
    if not 0 < value < 1:
        raise invalid(f"a fraction of the length must be between 0 and 1, found {described(value)}")
    return float(value)


def _towards(value: Any) -> str | float | Point:
    """Validate the place of the short elements."""
    if isinstance(value, str):
        if value not in SIDES:
            expected = f"{', '.join(SIDES)}, a fraction of the length, or a point [x, y]"
            raise invalid(f"expected {expected}; found {described(value)}")
        return value
    return _place(value)


_PLACE_SCHEMA: dict[str, Any] = {
    "type": ["number", "array"],
    "exclusiveMinimum": 0,
    "exclusiveMaximum": 1,
    "items": {"type": "number"},
    "minItems": 2,
    "maxItems": 2,
}
Place = Annotated[float | Point, PlainValidator(_place), WithJsonSchema(_PLACE_SCHEMA)]
"""A place on an edge: a fraction of its length from its start, or a point (x, y)."""
Towards = Annotated[
    str | float | Point,
    PlainValidator(_towards),
    WithJsonSchema({"anyOf": [{"enum": [*SIDES]}, _PLACE_SCHEMA]}),
]
"""The place of the short elements."""


class Grading(SpecModel):
    """Element lengths in geometric progression along an edge."""

    example: ClassVar[str] = "{ratio: 4, towards: end}"

    ratio: Annotated[float, Strict(), Field(ge=1, le=1e6)]
    """The ratio of the longest element to the shortest, such as 4."""
    towards: Towards
    """The place of the short elements: start, end, both, middle, a fraction of the length of the edge, or a point
    [x, y] on it. An element ends at a fraction or point."""


class _EdgeBase(SpecModel):
    """Base class of all edges."""

    other_words: ClassVar[Mapping[str, str]] = {
        "chamfer": "a chamfer is a line of its own: {name: …, start: [x, y]}",
        **dict.fromkeys(("diameter", "d"), "write radius, half of the diameter"),
        "r": "write radius",
        "start_tangent": "write start_direction",
        "end_tangent": "write end_direction",
        **dict.fromkeys(("from", "p1", "first"), "write start"),
        **dict.fromkeys(("to", "p2", "last"), "write end"),
    }

    name: Name
    """The name of the edge, by which conditions and contact zones refer to it."""
    elements: Annotated[Count, Field(ge=1, le=MOST_ELEMENTS)] | None = None
    """The number of boundary elements along the edge, such as elements: 8. Best left out: a mesh is then found for the
    accuracy asked."""
    grading: Grading | None = None
    """The grading of the stated elements; equal lengths if left out."""
    ends_at: tuple[Place, ...] = ()
    """The places where elements must end: fractions of the length of the edge, or points [x, y] on it. The nearest
    element ends move to these places, and the others in proportion. At most 100, unless elements are stated."""

    @model_validator(mode="after")
    def _graded_elements(self) -> Self:
        """Refuse a grading, and very many ends, of elements that are not stated."""
        if self.elements is None and self.grading is not None:
            raise invalid("grading needs elements; give a number of elements, or leave grading out")
        if self.elements is None and len(self.ends_at) > MOST_ENDS:
            given = f"ends_at has {len(self.ends_at)} places, more than {MOST_ENDS}"
            raise invalid(f"{given}; leave places out, or give the number of elements of the edge too")
        return self

    def has_coordinates(self) -> bool:
        """Whether the ends are given by coordinates, not by angles."""
        return getattr(self, "angles", None) is None

    @property
    def places(self) -> tuple[tuple[KeyPath, Place], ...]:
        """All places where elements must end, each with its key path."""
        places: list[tuple[KeyPath, Place]] = [(("ends_at", i), place) for i, place in enumerate(self.ends_at)]
        if self.grading is not None and not isinstance(self.grading.towards, str):
            places.append((("grading", "towards"), self.grading.towards))
        return tuple(places)


Tangent = Literal["start", "end", "both"]
"""The end of an edge, or both, at which it goes on smoothly from the neighboring edge."""


class Line(_EdgeBase):
    """A straight edge. An end that is left out is taken from the neighboring edge."""

    example: ClassVar[str] = "{name: bottom, start: [0, 0]}"

    kind: Literal["line"] = "line"
    """The shape of the edge: line, arc, ellipse, or spline."""
    start: Point | None = None
    """The first point [x, y]; if left out, the end of the previous edge."""
    end: Point | None = None
    """The last point [x, y]; if left out, the start of the next edge."""
    tangent: Tangent | None = None
    """The end at which the line touches the neighboring arc, which has center and radius: start, end or both. The point
    there follows from it, also the end of the arc."""

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        """Refuse a stated end that follows from a tangent."""
        for side in ("start", "end"):
            if self.tangent in (side, "both") and getattr(self, side) is not None:
                raise invalid(f"with tangent: {self.tangent} the {side} follows from the neighboring arc; leave it out")
        return self

    def own_ends(self) -> tuple[Point | None, Point | None]:
        """Both ends; None for an end that is left out."""
        return self.start, self.end

    def curve(self, start: Point, end: Point) -> Curve:
        """The line between two points."""
        return Segment(start=start, end=end)


class Arc(_EdgeBase):
    """A circular edge: center, radius and angles, or center, start, end and direction."""

    example: ClassVar[str] = "{name: rim, kind: arc, center: [0, 5], radius: 5, angles: [-90, 0]}"

    kind: Literal["arc"] = "arc"
    """The shape of the edge: line, arc, ellipse, or spline."""
    center: Point = left_out()
    """The center [x, y]."""
    radius: Positive | None = None
    """The radius, with angles; with the center alone if neighboring edges are tangent; or of an arc that touches both
    neighbors."""
    angles: Point | None = None
    """The polar angles [first, last] in degrees; counterclockwise if the last angle is the larger one."""
    start: Point | None = None
    """The first point [x, y] of an arc without angles; if left out, the end of the previous edge."""
    end: Point | None = None
    """The last point [x, y] of an arc without angles; if left out, the start of the next edge."""
    clockwise: Flag = False
    """Whether an arc without angles runs clockwise."""
    tangent: Tangent | None = None
    """The end at which an arc without center goes on smoothly: start or end, with both its ends known; or both, between
    two arcs with center and radius, with a radius of its own."""

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        """Refuse a mixture of angles and ends."""
        by_angles, by_points = "radius and angles", "start, end and clockwise"
        if self.tangent is not None:
            self._ensure_tangent(self.tangent)
            return self
        if self.center is None:
            raise validation_error("Arc", [Issue(path=("center",), message="missing; give the center [x, y]")])
        if self.is_round:
            return self
        if (self.radius is None) != (self.angles is None):
            given, missing = ("angles", "radius") if self.radius is None else ("radius", "angles")
            raise invalid(f"an arc with {given} needs {missing} too; give both, or {by_points} instead")
        if self.angles is not None:
            if self.start is not None or self.end is not None or self.clockwise:
                raise invalid(f"an arc has either {by_angles}, or {by_points}, not both; remove one form")
            _check_sweep(self.angles)
        return self

    def _ensure_tangent(self, tangent: Tangent) -> None:
        """Refuse what a tangent leaves no room for, and what it needs."""
        if self.center is not None or self.angles is not None:
            raise invalid("an arc with tangent has no center and no angles, which follow from it; leave them out")
        if tangent == "both":
            if self.radius is None:
                raise invalid("an arc that is tangent to both neighbors needs a radius")
            if self.start is not None or self.end is not None:
                raise invalid("with tangent: both the ends follow from the neighboring arcs; leave start and end out")
        elif self.radius is not None or self.clockwise:
            raise invalid(f"with tangent: {tangent} radius and direction follow from both ends; leave them out")

    @property
    def is_round(self) -> bool:
        """Whether it is stated by center and radius alone: its ends follow from its neighbors."""
        return self.center is not None and self.radius is not None and self.angles is None

    def own_ends(self) -> tuple[Point | None, Point | None]:
        """Both ends; None for an end that is left out."""
        if self.radius is None or self.angles is None:
            return self.start, self.end
        first, last = (_moved(self.center, self.radius, unit_vector(angle)) for angle in self.angles)
        return first, last

    def curve(self, start: Point, end: Point) -> Curve:
        """The arc by its angles, or between two points."""
        if self.radius is not None and self.angles is not None:
            first, last = map(radians, self.angles)
            return CircularArc(
                center=self.center, radii=(self.radius, self.radius), start_angle=first, sweep=last - first
            )
        (x, y), (x0, y0), (x1, y1) = self.center, start, end
        first, last = atan2(y0 - y, x0 - x), atan2(y1 - y, x1 - x)
        sweep = -((first - last) % (2 * pi)) if self.clockwise else (last - first) % (2 * pi)
        radii = hypot(x0 - x, y0 - y), hypot(x1 - x, y1 - y)
        return CircularArc(center=self.center, radii=radii, start_angle=first, sweep=sweep)


class EllipseArc(_EdgeBase):
    """An elliptic edge: center + rotated (a cos t, b sin t)."""

    example: ClassVar[str] = "{name: rim, kind: ellipse, center: [0, 5], semi_axes: [8, 5], angles: [-90, 0]}"

    kind: Literal["ellipse"] = "ellipse"
    """The shape of the edge: line, arc, ellipse, or spline."""
    center: Point
    """The center [x, y]."""
    semi_axes: PositivePair
    """The semi-axes [a, b]."""
    angles: Point
    """The eccentric angles t [first, last] in degrees; counterclockwise if the last angle is the larger one."""
    rotation: Number = 0.0
    """The angle in degrees from the x axis to the axis a."""

    @model_validator(mode="after")
    def _at_most_one_turn(self) -> Self:
        """Refuse more than a full turn."""
        _check_sweep(self.angles)
        return self

    def own_ends(self) -> tuple[Point | None, Point | None]:
        """Both ends, computed from the angles."""
        (a, b), (c, s) = self.semi_axes, unit_vector(self.rotation)
        ends = []
        for x, y in map(unit_vector, self.angles):
            ends.append((self.center[0] + c * a * x - s * b * y, self.center[1] + s * a * x + c * b * y))
        return ends[0], ends[1]

    def curve(self, start: Point, end: Point) -> Curve:
        """The elliptic arc; its ends follow from the angles."""
        first, last = map(radians, self.angles)
        return EllipticArc(
            center=self.center,
            semi_axes=self.semi_axes,
            rotation=radians(self.rotation),
            start_angle=first,
            sweep=last - first,
        )


class SplineEdge(_EdgeBase):
    """A smooth edge through points: cubic splines of the length along the chords. Closed, it is a loop of its own."""

    example: ClassVar[str] = "{name: profile, kind: spline, points: [[0, 0], [5, 1], [10, 0]]}"

    kind: Literal["spline"] = "spline"
    """The shape of the edge: line, arc, ellipse, or spline."""
    points: Annotated[tuple[Point, ...], Field(min_length=3, max_length=MOST_POINTS)]
    """The points [x, y] in order, with both ends; if the last is the first, the edge is a whole loop."""
    start_direction: Point | None = None
    """The direction of travel [x, y] at the start; if left out, the curvature is zero there."""
    end_direction: Point | None = None
    """The direction of travel [x, y] at the end; likewise."""

    @model_validator(mode="after")
    def _runs(self) -> Self:
        """Refuse equal points after each other, and directions that are none."""
        for i, (one, other) in enumerate(pairwise(self.points)):
            if one == other:
                issue = Issue(path=("points", i + 1), message="the point occurs twice; remove one")
                raise validation_error("Spline", [issue])
        for key in ("start_direction", "end_direction"):
            if getattr(self, key) == (0.0, 0.0):
                raise validation_error("Spline", [Issue(path=(key,), message="a direction must not be [0, 0]")])
        if self.points[0] == self.points[-1] and len(self.points) < 4:
            raise invalid("a closed spline needs at least three different points")
        return self

    def own_ends(self) -> tuple[Point | None, Point | None]:
        """Both ends."""
        return self.points[0], self.points[-1]

    def curve(self, start: Point, end: Point) -> Curve:
        """The curve through all points."""
        return SplineCurve(
            points=(start, *self.points[1:-1], end), start_direction=self.start_direction,
            end_direction=self.end_direction,
        )  # fmt: skip


class Fillet(_EdgeBase):
    """A rounded corner between the edges before and after it: an arc that is tangent to both, which it shortens."""

    example: ClassVar[str] = "{fillet: 2}"
    other_words: ClassVar[Mapping[str, str]] = {
        "radius": "the radius is the value of fillet: {fillet: 2}",
        **dict.fromkeys(
            ("start", "end", "points", "center", "angles", "tangent"),
            "a fillet has no place of its own: {fillet: 2} stands between the two edges that it joins",
        ),
    }

    kind: Literal["fillet"] = "fillet"
    """The shape of the edge: a fillet has the key fillet."""
    name: Name | None = None  # pyright: ignore[reportIncompatibleVariableOverride]
    """The name of the edge; if left out, those of both neighbors with a hyphen."""
    fillet: Positive
    """The radius."""

    def as_spec(self) -> Any:
        """Return its keys; the key fillet tells the kind."""
        return {key: value for key, value in self.to_dict().items() if key != "kind"}


class Mirror(SpecModel):
    """The line on which half an outline is mirrored: x = value, or y = value."""

    example: ClassVar[str] = "{x: 0}"

    x: Number | None = None
    """The place of a line parallel to the y axis."""
    y: Number | None = None
    """The place of a line parallel to the x axis."""

    @model_validator(mode="after")
    def _one_line(self) -> Self:
        """Refuse two lines, and none."""
        if (self.x is None) == (self.y is None):
            raise invalid("a mirror line is either {x: …} or {y: …}; give one of them")
        return self

    def image(self, point: Point) -> Point:
        """The mirror image of a point."""
        x, y = point
        return (x if self.x is None else 2 * self.x - x, y if self.y is None else 2 * self.y - y)

    def direction(self, vector: Point) -> Point:
        """The direction of travel of the image, which runs the other way."""
        x, y = vector
        return (x, -y) if self.x is not None else (-x, y)

    def distance(self, point: Point) -> float:
        """Distance [L] of a point from the line."""
        return abs(point[0] - self.x) if self.x is not None else abs(point[1] - (self.y or 0.0))

    @property
    def words(self) -> str:
        """The line as a formula."""
        return f"x = {self.x:g}" if self.x is not None else f"y = {self.y:g}"


def _check_sweep(angles: Point) -> None:
    """Refuse an arc without length, or of more than a full turn."""
    sweep = abs(angles[1] - angles[0])
    if not 0 < sweep <= WHOLE_TURN:
        raise invalid(f"angles must differ by more than 0 and at most 360 degrees; found {list(angles)}")


def _moved(center: Point, distance: float, direction: Point) -> Point:
    return center[0] + distance * direction[0], center[1] + distance * direction[1]


AnyEdge = Line | Arc | EllipseArc | SplineEdge
"""An edge of any shape."""
StatedEdge = AnyEdge | Fillet
"""An edge as a user states it."""
OTHER_KINDS = {
    "circle": "a full circle is kind: arc with center, radius and angles: [0, 360], and a hole has angles: [360, 0]",
    "polyline": "give each straight piece as an edge of its own, with a name and its start",
    **dict.fromkeys(("curve", "nurbs", "bezier"), "a smooth edge through points is kind: spline"),
}
"""Words that are no kinds of edges -> what to write instead."""
EdgeSpec = Annotated[
    StatedEdge,
    TaggedUnion(
        what="an edge", members=get_args(StatedEdge), default="line", other_kinds=OTHER_KINDS, own_keys=("fillet",)
    ),
]
"""An edge whose class is chosen by the key `kind`."""
LoopSpec = Annotated[tuple[EdgeSpec, ...], Field(min_length=1)]
"""Edges in order: each edge starts at the end of the previous one, and the last one closes the loop."""
