"""Conditions on the edges of the body (displacement, traction, pressure) and loads on its volume."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import AfterValidator, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from bemcontact.arrays import Array
from bemcontact.problems.validation import Number, Point, Positive, SpecModel, invalid, not_tiny
from bemcontact.problems.wording import described, number_hint


class Field(SpecModel):
    """A constant number, or a polynomial in the coordinates: constant + x X + y Y + xx X² + xy X Y + yy Y²."""

    example: ClassVar[str] = "{constant: 3, x: 0.5}"

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

    def at(self, points: Array) -> Array:
        """Values (k,) at points (k, 2) [L]."""
        x, y = np.asarray(points, float).T
        return self.constant + self.x * x + self.y * y + self.xx * x * x + self.xy * x * y + self.yy * y * y


class AxisFields(SpecModel):
    """A component along each axis; an axis that is left out is not prescribed."""

    example: ClassVar[str] = "{x: 0}"

    x: Field | None = None
    """The component along x: a number, or a polynomial in the coordinates."""
    y: Field | None = None
    """The component along y: a number, or a polynomial in the coordinates."""

    @property
    def given(self) -> tuple[str, ...]:
        """The axes that are prescribed."""
        return tuple(axis for axis, field in (("x", self.x), ("y", self.y)) if field is not None)


class Condition(SpecModel):
    """The condition on an edge. Along an axis without a condition, the edge is free of traction."""

    example: ClassVar[str] = "{displacement: {x: 0}}"
    other_words: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("force", "forces", "load", "loads"),
        "an edge takes traction: {x: …, y: …}, which is force per area; divide the force per thickness by the length "
        "of the edge",
    )

    displacement: AxisFields = AxisFields()
    """The prescribed displacement. A symmetry line has displacement 0 along its normal."""
    traction: AxisFields = AxisFields()
    """The prescribed force per area along x and y."""
    pressure: Field | None = None
    """The prescribed pressure on the edge, positive in compression."""

    @model_validator(mode="after")
    def _one_value_per_axis(self) -> Self:
        """Refuse contradictions, and a condition without a value."""
        displacement, traction = self.displacement.given, self.traction.given
        if self.pressure is not None and (displacement or traction):
            other = "displacement" if displacement else "traction"
            raise invalid(f"pressure acts along both axes, so {other} cannot be given too; give only one of them")
        for axis in displacement:
            if axis in traction:
                raise invalid(f"both displacement and traction are given along {axis}; give only one of them")
        if self.pressure is None and not displacement and not traction:
            raise invalid("the condition is empty; give displacement, traction or pressure, or leave the edge out")
        return self

    @property
    def presses(self) -> bool:
        """Whether it prescribes pressure or traction."""
        return self.pressure is not None or bool(self.traction.given)


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
        ("rpm", "speed", "omega"), "write angular_velocity, in radians per time: 2 π/60 of the turns per minute"
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
        if excess := [term for term in ("xx", "xy", "yy") if getattr(change, term) != 0]:
            raise invalid(f"a change of temperature may have constant, x and y only; leave out {', '.join(excess)}")
        return self


class Loads(SpecModel):
    """The loads on the volume of the body; they are added."""

    example: ClassVar[str] = "{temperature: {expansion: 1.2e-5, change: 50}}"
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
