"""Conditions on the edges of the body (displacement, traction, pressure) and loads on its volume."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from bemcontact.arrays import Array
from bemcontact.problems.validation import Flag, Number, Point, Positive, SpecModel, invalid, not_tiny
from bemcontact.problems.wording import described, number_hint

SPRING = "write spring: {normal: 50}, the force per area for a displacement of one"
"""What to write for springs on an edge."""


def _ascending(table: tuple[Point, ...]) -> tuple[Point, ...]:
    """Refuse a table whose distances do not ascend, and more than two values at one distance."""
    distances = [distance for distance, _ in table]
    if distances and (len(distances) < 2 or distances[0] < 0):
        raise invalid("a table has two or more pairs [distance from the start of the edge, value], as [[0, 5], [3, 0]]")
    for before, after in pairwise(distances):
        if after < before:
            raise invalid(f"distances from the start of the edge must ascend; {after:g} stands after {before:g}")
    for distance in {*distances}:
        if distances.count(distance) > 2:
            raise invalid(f"there are more than two values at the distance {distance:g}; two make a jump")
    return table


class Field(SpecModel):
    """A constant number, or a polynomial in the coordinates: constant + x X + y Y + xx X² + xy X Y + yy Y².

    The load on an edge may have a table of values along it too, which is added.
    """

    example: ClassVar[str] = "{constant: 3, x: 0.5}"
    other_words: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("table", "points", "values"),
        "a table of distance from the start of the edge and value is along: [[0, 10], [5, 20]]",
    )

    constant: Number = 0.0
    """The value at the origin."""
    x: Number = 0.0
    """The factor of X."""
    y: Number = 0.0
    """The factor of Y."""
    xx: Number = 0.0
    """The factor of X²."""
    xy: Number = 0.0
    """The factor of X Y."""
    yy: Number = 0.0
    """The factor of Y²."""
    along: Annotated[tuple[Point, ...], AfterValidator(_ascending)] = ()
    """Of a load: pairs [distance from the start of the edge, value], between which the value is linear, and beyond
    which it is 0. Two pairs at one distance make a jump."""

    @model_validator(mode="before")
    @classmethod
    def _constant_alone(cls, data: Any) -> Any:
        """Read a number as a constant field."""
        if isinstance(data, int | float) and not isinstance(data, bool):
            return {"constant": data}
        if not isinstance(data, Mapping | Field):
            keys = ", ".join(cls.model_fields)
            found = f"{described(data)}{number_hint(data)}"
            raise invalid(f"expected a number, or a mapping with some of the keys {keys}; found {found}")
        if isinstance(data, Mapping) and not data:
            raise invalid("the mapping is empty; give a number")
        return data

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Allow a number or a mapping in the JSON Schema."""
        return {**handler.resolve_ref_schema(handler(schema)), "type": ["number", "object"], "minProperties": 1}

    def as_spec(self) -> Any:
        """Return the number that a constant field is, else a mapping."""
        return self.to_dict() if {*self.to_dict()} - {"constant"} else self.constant

    def at(self, points: Array, along: "Along | None" = None) -> Array:
        """Values (k,) at points (k, 2) [L]; of a table at their places along the edge."""
        x, y = np.asarray(points, float).T
        value = np.full(len(x), self.constant)
        if self.x or self.y:
            value += self.x * x + self.y * y
        if self.xx or self.xy or self.yy:
            value += self.xx * x * x + self.xy * x * y + self.yy * y * y
        return value if not self.along else value + _in_table(self.along, along)


class Along(NamedTuple):
    """Places along an edge.

    Parameters
    ----------
    distance : (k,) from its start [L]
    within : (k,) distance of another place in the same piece of it, which tells on which side of a jump a place is [L]
    length : of the edge [L]
    """

    distance: Array
    within: Array
    length: float


def _in_table(table: Sequence[Point], along: Along | None) -> Array:
    """Values (k,) of a table that is linear between its pairs, and zero beyond them."""
    assert along is not None, "only loads on edges have tables"
    at, value = np.array(table).T
    piece = np.searchsorted(at, along.within, side="right") - 1
    inside = (piece >= 0) & (piece < len(at) - 1)
    piece = np.clip(piece, 0, len(at) - 2)
    length = np.diff(at)[piece]
    slope = np.diff(value)[piece] / np.where(length > 0, length, 1.0)
    return np.where(inside, value[piece] + slope * (along.distance - at[piece]), 0.0)


class EdgeForce(SpecModel):
    """A force on an edge, spread evenly over a part of it or all of it."""

    example: ClassVar[str] = "{y: -400, width: 2, at: 10}"
    other_words: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(
            ("position", "point", "place", "location", "distance", "center"),
            "write at: 10, the distance of its middle from the start of the edge",
        ),
        "normal": "a force has components x and y; across the edge acts pressure: 20",
        "moment": "a couple is two forces: [{y: 10, width: 1, at: 5}, {y: -10, width: 1, at: 15}]",
    }

    x: Number = 0.0
    """The component along x, per thickness."""
    y: Number = 0.0
    """The component along y, per thickness."""
    width: Positive | None = None
    """The length of edge over which it is spread; all of the edge if left out."""
    at: Number | None = None
    """The distance along the edge from its start to the middle of this part; the middle of the edge if left out."""

    @model_validator(mode="after")
    def _placed(self) -> Self:
        """Refuse a place of what is spread over the whole edge, and no force."""
        if self.at is not None and self.width is None:
            raise invalid("a force at a place needs a width, for no body can bear it at a point; give its width")
        if not self.x and not self.y:
            raise invalid("the force is zero; give x or y, or leave it out")
        return self

    def part(self, length: float) -> tuple[float, float]:
        """Distances from the start of an edge of this length [L] between which it acts."""
        width = length if self.width is None else self.width
        middle = length / 2 if self.at is None else self.at
        return middle - width / 2, middle + width / 2

    def traction(self, along: Along) -> Array:
        """Traction (k, 2) [p] at places along the edge."""
        first, last = self.part(along.length)
        inside = (along.within >= first) & (along.within <= last)
        return np.where(inside[..., None], np.array([self.x, self.y]) / (last - first), 0.0)


def _forces(value: Any) -> Any:
    """Read one force as a list of it."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        raise invalid(f"a force has a direction; write {{y: {value:g}}}, or x")
    return [value] if isinstance(value, Mapping | EdgeForce) else value


class AxisFields(SpecModel):
    """A component along each axis; an axis that is left out is not prescribed."""

    example: ClassVar[str] = "{x: 0}"
    other_words: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("along", "constant"), "the axis comes first: {y: {along: [[0, 10], [5, 20]]}}"),
        **dict.fromkeys(("normal", "tangent"), "components are along x and y; across the edge acts pressure: 20"),
    }

    x: Field | None = None
    """The component along x: a number, or a polynomial in the coordinates."""
    y: Field | None = None
    """The component along y: a number, or a polynomial in the coordinates."""

    @property
    def given(self) -> tuple[str, ...]:
        """The axes that are prescribed."""
        return tuple(axis for axis, field in (("x", self.x), ("y", self.y)) if field is not None)


class Springs(SpecModel):
    """Springs between an edge and a fixed place, spread evenly over it: an elastic foundation (Winkler).

    Stiffness is force per area and displacement. Those that are given are added.
    """

    example: ClassVar[str] = "{normal: 50}"
    other_words: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("stiffness", "k", "kn"), "write normal: 50 for springs across the edge, or tangent, x or y"),
        **dict.fromkeys(("tangential", "shear", "kt"), "write tangent"),
    }

    normal: Positive | None = None
    """The stiffness across the edge: force per area for a displacement of one. The springs pull as well as push."""
    tangent: Positive | None = None
    """The stiffness along the edge."""
    x: Positive | None = None
    """The stiffness along x."""
    y: Positive | None = None
    """The stiffness along y."""

    @model_validator(mode="before")
    @classmethod
    def _number(cls, data: Any) -> Any:
        """Refuse a stiffness without a direction."""
        if isinstance(data, int | float) and not isinstance(data, bool):
            raise invalid(f"a spring has a direction; write {{normal: {data:g}}}, or tangent, x or y")
        return data

    @model_validator(mode="after")
    def _not_empty(self) -> Self:
        """Refuse springs without a stiffness."""
        if not self.given:
            raise invalid("the springs have no stiffness; give normal, tangent, x or y, or leave them out")
        return self

    @property
    def given(self) -> tuple[str, ...]:
        """The directions in which there are springs."""
        return tuple(way for way in ("normal", "tangent", "x", "y") if getattr(self, way) is not None)

    def matrices(self, normals: Array) -> Array:
        """Stiffness (…, 2, 2) [p/L] at places with unit normals (…, 2)."""
        n, t = normals, np.stack([-normals[..., 1], normals[..., 0]], axis=-1)
        across, along = (np.einsum("...i,...j->...ij", way, way) for way in (n, t))
        return (self.normal or 0.0) * across + (self.tangent or 0.0) * along + np.diag([self.x or 0.0, self.y or 0.0])


class Condition(SpecModel):
    """The condition on an edge. Along an axis without a condition, the edge is free of traction."""

    example: ClassVar[str] = "{displacement: {x: 0}}"
    other_words: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(
            ("forces", "load", "loads", "point_load", "line_load"),
            "a force per thickness on the edge is force: {x: …, y: …, width: …, at: …}, a force per area traction",
        ),
        **dict.fromkeys(
            ("roller", "slider", "guided", "guide"),
            "an edge that slides along x has displacement: {y: 0}, one that slides along y displacement: {x: 0}; a "
            "roller that presses is a contact zone with surface: {kind: circle, …}",
        ),
        **dict.fromkeys(("clamped", "clamp", "encastre", "support", "hold", "held"), "write fixed: true"),
        **dict.fromkeys(("hinge", "pin", "pinned"), "hold a short edge by fixed: true; no point can bear a force"),
        **dict.fromkeys(("springs", "foundation", "stiffness", "winkler", "bedding"), SPRING),
        **dict.fromkeys(
            ("x", "y", "ux", "uy", "u", "u_x", "u_y", "fixed_x", "fixed_y", "bc", "type"),
            "what holds an edge is displacement: {x: 0}, fixed: true or symmetry: x",
        ),
        **dict.fromkeys(
            ("moment", "bending_moment", "torque"),
            "a moment is a traction that changes along the edge, or a pair of forces; on a tool it stands under force",
        ),
        "free": "an edge without a condition is free; leave it out",
    }

    displacement: AxisFields = AxisFields()
    """The prescribed displacement. A symmetry line has displacement 0 along its normal."""
    traction: AxisFields = AxisFields()
    """The prescribed force per area along x and y."""
    pressure: Field | None = None
    """The prescribed pressure on the edge, positive in compression."""
    force: Annotated[tuple[EdgeForce, ...], BeforeValidator(_forces)] = ()
    """The force per thickness on the edge or on a part of it: one, or a list of them, which are added."""
    spring: Springs | None = None
    """The springs between the edge and a fixed place, an elastic foundation."""
    fixed: Flag | None = None
    """Short for displacement: {x: 0, y: 0}."""
    symmetry: Literal["x", "y"] | None = None
    """The axis along which the body continues as its mirror image: short for displacement 0 along it. The edge is a
    straight one across this axis."""

    @model_validator(mode="before")
    @classmethod
    def _written_out(cls, data: Any) -> Any:
        """Write fixed and symmetry as the displacements that they stand for."""
        if not isinstance(data, Mapping):
            return data
        if data.get("fixed") is False:
            raise invalid("fixed: false says nothing; leave it out")
        held = {"x": 0.0, "y": 0.0} if data.get("fixed") is True else {}
        if data.get("symmetry") in ("x", "y"):
            held[str(data["symmetry"])] = 0.0
        given = data.get("displacement", {})
        if not held or not isinstance(given, Mapping | AxisFields):
            return data
        own = {axis: getattr(given, axis) for axis in given.given} if isinstance(given, AxisFields) else given
        for axis in held:
            if own.get(axis) is not None:
                word = "fixed" if data.get("fixed") else "symmetry"
                raise invalid(f"{word} is displacement 0 along {axis}, and displacement.{axis} is given too; leave one")
        others = {key: value for key, value in data.items() if key not in ("fixed", "symmetry")}
        return {**others, "displacement": {**own, **held}}

    @model_validator(mode="after")
    def _one_value_per_axis(self) -> Self:
        """Refuse contradictions, and a condition without a value."""
        displacement, traction = self.displacement.given, self.traction.given
        for axis in displacement:
            if any(getattr(force, axis) for force in self.force):
                raise invalid(f"both displacement and force are given along {axis}; give only one of them")
        if any(field.along for field in (self.displacement.x, self.displacement.y) if field is not None):
            raise invalid("along is for loads; a displacement is a number or a polynomial in the coordinates")
        if self.pressure is not None and (displacement or traction):
            other = "displacement" if displacement else "traction"
            raise invalid(f"pressure acts along both axes, so {other} cannot be given too; give only one of them")
        for axis in displacement:
            if axis in traction:
                raise invalid(f"both displacement and traction are given along {axis}; give only one of them")
        if clash := self._against_springs(displacement):
            raise invalid(clash)
        if not (displacement or self.presses or self.spring):
            raise invalid(
                "the condition is empty; give displacement, traction, pressure, force or spring, or leave the edge out"
            )
        return self

    def _against_springs(self, displacement: Sequence[str]) -> str:
        """What to change if there are springs where displacement is prescribed along some axes."""
        if self.spring is None or not displacement:
            return ""
        for way in self.spring.given:
            if way in displacement:
                return f"both displacement and spring are given along {way}; give only one of them"
            if way in ("normal", "tangent"):
                return (
                    f"spring.{way} needs an edge without a prescribed displacement; write spring: {{x: …}} or {{y: …}}"
                )
        return ""

    @property
    def holds(self) -> bool:
        """Whether it prescribes a displacement, or has springs."""
        return bool(self.displacement.given) or self.spring is not None

    @property
    def presses(self) -> bool:
        """Whether it prescribes pressure, traction or force."""
        return self.pressure is not None or bool(self.traction.given) or bool(self.force)

    @property
    def varies_along(self) -> bool:
        """Whether it depends on the distance from the start of the edge, or on its length."""
        return bool(self.force) or any(field.along for field in self._loads)

    @property
    def _loads(self) -> list[Field]:
        """Fields of pressure and traction."""
        return [field for field in (self.pressure, self.traction.x, self.traction.y) if field is not None]

    def stops(self, length: float) -> list[float]:
        """Distances [L] from the start of an edge of this length at which loads jump or kink."""
        tables = (distance for field in self._loads for distance, _ in field.along)
        parts = (distance for force in self.force for distance in force.part(length))
        return sorted({*tables, *parts})


def _not_tiny(vector: Point) -> Point:
    """Refuse vectors other than 0 that are too short to compute with."""
    not_tiny(max(map(abs, vector)))
    return vector


class Gravity(SpecModel):
    """Weight: the body force density · acceleration."""

    example: ClassVar[str] = "{density: 7.85e-9, acceleration: [0, -9810]}"

    density: Positive
    """The mass per volume."""
    acceleration: Annotated[Point, AfterValidator(_not_tiny)]
    """The acceleration of gravity [gx, gy], such as [0, -9.81]."""


class Centrifugal(SpecModel):
    """Steady rotation: the body force density · angular_velocity² · (x - center)."""

    example: ClassVar[str] = "{density: 7.85e-9, angular_velocity: 300}"
    other_words: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("rpm", "speed", "omega"),
        "write angular_velocity, in radians per time: 2 π/60 of the turns per minute, or with its unit, 3000 rpm",
    )

    density: Positive
    """The mass per volume."""
    angular_velocity: Number
    """The angular velocity in radians per time."""
    center: Point = (0.0, 0.0)
    """The axis of rotation [x, y]."""


class Temperature(SpecModel):
    """Thermal expansion: the strain expansion · change in all directions."""

    example: ClassVar[str] = "{expansion: 1.2e-5, change: 50}"

    expansion: Number
    """The coefficient of thermal expansion, per degree."""
    change: Field
    """The change of temperature in degrees: a number, or a polynomial with the keys constant, x and y."""

    @model_validator(mode="after")
    def _linear(self) -> Self:
        """Refuse a change for which the thermal displacement has no simple closed form."""
        change = self.change
        if change.along:
            raise invalid("along is for loads on edges; a change of temperature may have constant, x and y only")
        if excess := [term for term in ("xx", "xy", "yy") if getattr(change, term) != 0]:
            raise invalid(f"a change of temperature may have constant, x and y only; leave out {', '.join(excess)}")
        return self


class Loads(SpecModel):
    """The loads on the volume of the body; they are added."""

    example: ClassVar[str] = "{temperature: {expansion: 1.2e-5, change: 50}}"
    elsewhere: ClassVar[str] = "; loads on edges are in conditions"
    other_words: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("rotation", "rotating", "spin", "speed", "angular_velocity"),
        "a body that rotates steadily has centrifugal: {density: 7.85e-9, angular_velocity: 300}, in radians per time",
    )

    gravity: Gravity | None = None
    """The weight of the body."""
    centrifugal: Centrifugal | None = None
    """The centrifugal load of steady rotation."""
    temperature: Temperature | None = None
    """A change of temperature."""

    @property
    def given(self) -> bool:
        """Whether there is one of them."""
        return not (self.gravity is None and self.centrifugal is None and self.temperature is None)
