"""What is prescribed on an edge: a displacement or a traction along each axis, or a pressure along the normal."""

from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from bemcontact.problem.validation import Number, Stated, complain, described

Array = NDArray[np.float64]


class Field(Stated):
    """A quantity over the plane, constant + x X + y Y + xx X² + xy X Y + yy Y²; a number alone is constant."""

    constant: Number = 0.0
    """Value at the origin."""
    x: Number = 0.0
    """Factor of X."""
    y: Number = 0.0
    """Factor of Y."""
    xx: Number = 0.0
    """Factor of X²."""
    xy: Number = 0.0
    """Factor of X Y."""
    yy: Number = 0.0
    """Factor of Y²."""

    @model_validator(mode="before")
    @classmethod
    def _constant_alone(cls, data: Any) -> Any:
        """Read a number as a constant field."""
        if isinstance(data, int | float) and not isinstance(data, bool):
            return {"constant": data}
        if not isinstance(data, Mapping | Field):
            keys = ", ".join(cls.model_fields)
            raise complain(f"expected a number, or a mapping with keys out of {keys}; found {described(data)}")
        if not data if isinstance(data, Mapping) else False:
            raise complain("an empty mapping states nothing; give a number")
        return data

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Allow both forms in the JSON Schema; what it says of keys concerns mappings only."""
        return {**handler.resolve_ref_schema(handler(schema)), "type": ["number", "object"], "minProperties": 1}

    def at(self, points: Array) -> Array:
        """Values (k,) at points (k, 2) [L]."""
        x, y = np.asarray(points, float).T
        return self.constant + self.x * x + self.y * y + self.xx * x * x + self.xy * x * y + self.yy * y * y


class AxisFields(Stated):
    """A field for each axis; an axis that is left out is not prescribed."""

    x: Field | None = None
    """Component along x: a number, or a polynomial in the coordinates."""
    y: Field | None = None
    """Component along y: a number, or a polynomial in the coordinates."""

    @property
    def given(self) -> tuple[str, ...]:
        """The axes that are prescribed."""
        return tuple(axis for axis, field in (("x", self.x), ("y", self.y)) if field is not None)


class Condition(Stated):
    """What is prescribed on an edge; along an axis that it leaves out, the edge is free of traction.

    Raises
    ------
    ProblemError
        If an axis has both displacement and traction, if a pressure has company, or if nothing is stated.
    """

    displacement: AxisFields = AxisFields()
    """Prescribed displacement; a symmetry line has 0 across it."""
    traction: AxisFields = AxisFields()
    """Prescribed force per area, along the axes."""
    pressure: Field | None = None
    """Push along the inward normal; positive in compression."""

    @model_validator(mode="after")
    def _one_statement_per_axis(self) -> Self:
        """Refuse contradictions and emptiness."""
        displacement, traction = self.displacement.given, self.traction.given
        if self.pressure is not None and (displacement or traction):
            company = "displacement" if displacement else "traction"
            raise complain(f"pressure acts on both axes and leaves no room for {company}; give one of them only")
        for axis in displacement:
            if axis in traction:
                raise complain(f"both displacement and traction are given along {axis}; give one of them only")
        if self.pressure is None and not displacement and not traction:
            raise complain("it states nothing; give displacement, traction or pressure, or leave the edge out")
        return self
