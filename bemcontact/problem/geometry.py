"""Edges as they are written: a line, an arc of a circle or of an ellipse, with its number of elements."""

from math import atan2, hypot, isfinite, pi, radians
from typing import Annotated, Any, Literal, Self

from pydantic import Field, PlainValidator, Strict, WithJsonSchema, model_validator

from bemcontact.errors import Path
from bemcontact.problem.curves import CircularArc, Curve, EllipticArc, Segment, unit_vector
from bemcontact.problem.tagged_union import ByKind
from bemcontact.problem.validation import (
    Count,
    Flag,
    Name,
    Number,
    Point,
    Positive,
    PositivePair,
    Stated,
    complain,
    described,
)

MOST_ELEMENTS = 10_000
"""On one boundary; the dense matrix of so many quadratic elements takes 13 gigabytes."""


SIDES = ("start", "end", "both", "middle")
"""Words for where the short elements of an edge are."""


def _place(value: Any) -> float | Point:
    """Read a place on an edge, a fraction of its length or a point."""
    numbers = value if isinstance(value, list | tuple) else [value]
    if not all(isinstance(number, int | float) and not isinstance(number, bool) for number in numbers):
        raise complain(f"expected a fraction of the length such as 0.4, or a point [x, y]; found {described(value)}")
    if isinstance(value, list | tuple):
        if len(value) != 2 or not all(map(isfinite, value)):
            raise complain(f"a point has two coordinates such as [0.0, 1.5]; found {described(value)}")
        return float(value[0]), float(value[1])
    if not 0 < value < 1:
        raise complain(f"a fraction of the length lies between 0 and 1, where the edge itself ends; found {value:g}")
    return float(value)


def _towards(value: Any) -> str | float | Point:
    """Read where the short elements are."""
    if isinstance(value, str):
        if value not in SIDES:
            words = f"{', '.join(SIDES)}, a fraction of the length, or a point [x, y]"
            raise complain(f"expected one of {words}; found {described(value)}")
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
"""Where the short elements are."""


class Grading(Stated):
    """Element lengths in geometric progression along an edge."""

    ratio: Annotated[float, Strict(), Field(ge=1, le=1e6)]
    """The ratio of the longest element to the shortest, such as 4."""
    towards: Towards
    """Where the short elements are: start, end, both, middle, or a place at which elements then end: a fraction of the
    length of the edge, or a point [x, y] on it."""


class _StatedEdge(Stated):
    """What every edge states, whatever its shape."""

    name: Name
    """The name of the edge, by which conditions and contact zones refer to it."""
    elements: Annotated[Count, Field(ge=1, le=MOST_ELEMENTS)]
    """The number of boundary elements along the edge, such as elements: 8."""
    grading: Grading | None = None
    """Grading of the element lengths; equal lengths if left out."""
    ends_at: tuple[Place, ...] = ()
    """Places at which elements must end: fractions of the length of the edge, or points [x, y] on it. The nearest
    element ends are moved there, the others in proportion."""

    @property
    def places(self) -> tuple[tuple[Path, Place], ...]:
        """All places at which elements must end, each with its path of keys."""
        stated: list[tuple[Path, Place]] = [(("ends_at", i), place) for i, place in enumerate(self.ends_at)]
        if self.grading is not None and not isinstance(self.grading.towards, str):
            stated.append((("grading", "towards"), self.grading.towards))
        return tuple(stated)


class Line(_StatedEdge):
    """A straight edge. An end that is left out is where the neighbouring edge begins or ends."""

    kind: Literal["line"] = "line"
    """The shape of the edge: line, arc, or ellipse."""
    start: Point | None = None
    """The first point [x, y]."""
    end: Point | None = None
    """The last point [x, y]."""

    def own_ends(self) -> tuple[Point | None, Point | None]:
        """Both ends as far as this edge knows them by itself."""
        return self.start, self.end

    def states_points(self) -> bool:
        """Tell that the ends are written as coordinates, and not computed from angles."""
        return True

    def curve(self, start: Point, end: Point) -> Curve:
        """Make the curve between two points."""
        return Segment(start=start, end=end)


class Arc(_StatedEdge):
    """A circular edge: a centre, and either radius and angles, or start, end and the sense of rotation."""

    kind: Literal["arc"] = "arc"
    """The shape of the edge: line, arc, or ellipse."""
    center: Point
    """The centre [x, y]."""
    radius: Positive | None = None
    """The radius, together with angles."""
    angles: Point | None = None
    """Polar angles [first, last] in degrees; anticlockwise if the last is the larger."""
    start: Point | None = None
    """The first point [x, y], if the arc is given by its ends; left out, it is where the edge before ends."""
    end: Point | None = None
    """The last point [x, y], if the arc is given by its ends; left out, it is where the next edge begins."""
    clockwise: Flag = False
    """Whether an arc given by its ends runs clockwise."""

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        """Refuse a mixture of the two forms."""
        by_angles, by_points = "radius and angles", "start, end and clockwise"
        if (self.radius is None) != (self.angles is None):
            given, missing = ("angles", "radius") if self.radius is None else ("radius", "angles")
            raise complain(f"an arc with {given} needs {missing} too; or give {by_points} instead")
        if self.angles is not None:
            if self.start is not None or self.end is not None or self.clockwise:
                raise complain(f"give either {by_angles}, or {by_points}, not both")
            _check_sweep(self.angles)
        return self

    def own_ends(self) -> tuple[Point | None, Point | None]:
        """Both ends as far as this edge knows them by itself."""
        if self.radius is None or self.angles is None:
            return self.start, self.end
        first, last = (_moved(self.center, self.radius, unit_vector(angle)) for angle in self.angles)
        return first, last

    def states_points(self) -> bool:
        """Tell whether the ends are written as coordinates."""
        return self.angles is None

    def curve(self, start: Point, end: Point) -> Curve:
        """Make the curve; an arc that is given by its ends takes them from here."""
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


class EllipseArc(_StatedEdge):
    """A piece of an ellipse: center + rotated (a cos t, b sin t)."""

    kind: Literal["ellipse"] = "ellipse"
    """The shape of the edge: line, arc, or ellipse."""
    center: Point
    """The centre [x, y]."""
    semi_axes: PositivePair
    """The half-lengths [a, b] of the axes."""
    angles: Point
    """Eccentric angles t [first, last] in degrees; anticlockwise if the last is the larger."""
    rotation: Number = 0.0
    """Angle in degrees from the x axis to the axis a."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        """Refuse more than a full turn."""
        _check_sweep(self.angles)
        return self

    def own_ends(self) -> tuple[Point | None, Point | None]:
        """Both ends, from the angles."""
        (a, b), (c, s) = self.semi_axes, unit_vector(self.rotation)
        ends = []
        for x, y in map(unit_vector, self.angles):
            ends.append((self.center[0] + c * a * x - s * b * y, self.center[1] + s * a * x + c * b * y))
        return ends[0], ends[1]

    def states_points(self) -> bool:
        """Tell that the ends are computed from angles."""
        return False

    def curve(self, start: Point, end: Point) -> Curve:
        """Make the curve; its ends follow from the angles."""
        first, last = map(radians, self.angles)
        return EllipticArc(
            center=self.center,
            semi_axes=self.semi_axes,
            rotation=radians(self.rotation),
            start_angle=first,
            sweep=last - first,
        )


def _check_sweep(angles: Point) -> None:
    """Refuse an arc of no length, or of more than a full turn."""
    sweep = abs(angles[1] - angles[0])
    if not 0 < sweep <= 360:
        raise complain(f"angles must differ by more than 0 and at most 360 degrees; found {list(angles)}")


def _moved(center: Point, distance: float, direction: Point) -> Point:
    return center[0] + distance * direction[0], center[1] + distance * direction[1]


AnyEdge = Line | Arc | EllipseArc
"""An edge of any shape."""
StatedEdge = Annotated[
    AnyEdge, ByKind(what="an edge", kinds={"line": Line, "arc": Arc, "ellipse": EllipseArc}, default="line")
]
"""An edge as it is written; `kind` says which."""
StatedLoop = Annotated[tuple[StatedEdge, ...], Field(min_length=1)]
"""Edges in order, each of which begins where the one before ends, the last closing the loop."""
