"""Rigid surfaces: gap and unit normal, which points from the surface into the body."""

from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, Self, get_args

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from bemcontact.arrays import Array
from bemcontact.problems.conditions import Condition, Loads
from bemcontact.problems.surface_lines import Closest, Polyline, SmoothSurface, Spline, unit_vectors
from bemcontact.problems.tagged_union import TaggedUnion
from bemcontact.problems.validation import Name, Point, Positive, SpecModel, invalid


class Plane(SmoothSurface):
    """An infinite straight surface."""

    example: ClassVar[str] = "{kind: plane, point: [0, 0], normal: [0, 1]}"

    kind: Literal["plane"] = "plane"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    point: Point
    """Any point [x, y] of the surface."""
    normal: Point
    """The direction [x, y] from the surface into the body, of any length."""

    @model_validator(mode="after")
    def _directed(self) -> Self:
        """Refuse a zero normal."""
        if not np.hypot(*self.normal) > 0:
            raise invalid("the normal [0, 0] has no direction; give the direction from the surface into the body")
        return self

    @property
    def unit_normal(self) -> Point:
        """The normal with length 1."""
        return _of_length_one(self.normal)

    @cached_property
    def _frame(self) -> tuple[Array, Array]:
        """The point (2,) and the unit normal (2,) as arrays."""
        return np.array(self.point), np.array(self.unit_normal)

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L]."""
        point, normal = self._frame
        offset = np.asarray(points, float) - point
        return Closest(offset @ normal, normal[None].repeat(len(offset), axis=0))


class Circle(SmoothSurface):
    """A rigid disk with the body outside, or a rigid hole with the body inside."""

    kind: Literal["circle"] = "circle"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    center: Point
    """The center [x, y]."""
    radius: Positive
    """The radius."""
    body: Literal["outside", "inside"]
    """The side of the circle with the body: outside or inside."""

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L]."""
        offset = np.asarray(points, float) - np.array(self.center)
        side = 1.0 if self.body == "outside" else -1.0
        return Closest(side * (np.hypot(*offset.T) - self.radius), side * unit_vectors(offset, np.array([0.0, 1.0])))


def _not_empty(value: Any) -> Any:
    """Refuse an empty condition of a contour, which may be meant to remove a load."""
    if isinstance(value, Mapping) and all(part == {} for part in value.values()):
        raise invalid(
            "the condition is empty; give traction: {x: 0, y: 0} to remove the load of the problem, or leave the edge "
            "out to keep it"
        )
    return value


OtherCondition = Annotated[Condition, BeforeValidator(_not_empty)]
"""A condition that replaces that of the problem."""


class DeflectedContour(SpecModel):
    """The contour of the body itself, deflected by other loads without contact.

    The initial gap of a material point is its displacement against a fixed direction d: ε = -u·d, where u is the
    displacement under the other loads. These are the conditions of the problem, with those given here in place of the
    conditions of the same edges, and the volume loads given here. The volume loads of the problem do not act.
    """

    kind: Literal["deflected_contour"] = "deflected_contour"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    conditions: Annotated[dict[Name, OtherCondition], Field(default_factory=dict)]
    """The conditions that replace those of the problem, by edge name; other edges keep their conditions."""
    loads: Loads = Loads()
    """The loads on the volume that deflect the contour. The volume loads of the problem do not act on it."""
    direction: Point
    """The direction [x, y] in which the gap is measured, from the surface into the body, of any length."""

    @model_validator(mode="after")
    def _deflected(self) -> Self:
        """Refuse a zero direction, and a contour without loads of its own."""
        if not np.hypot(*self.direction) > 0:
            raise invalid("the direction [0, 0] has no direction; give the direction from the surface into the body")
        if not self.conditions and self.loads == Loads():
            raise invalid("the contour has no loads of its own; give conditions or loads that deflect it")
        return self

    @property
    def unit_direction(self) -> Point:
        """The direction with length 1."""
        return _of_length_one(self.direction)

    def behind(self, displacement: Array) -> Closest:
        """Gap and normal at points whose displacement (k, 2) [L] under the other loads is given."""
        direction = np.array(self.unit_direction)
        return Closest(-(displacement @ direction), np.tile(direction, (len(displacement), 1)))


def _of_length_one(vector: Point) -> Point:
    length = float(np.hypot(*vector))
    return vector[0] / length, vector[1] / length


Shape = Plane | Circle | Polyline | Spline
"""A rigid surface that has a gap at any point of the plane."""
RigidSurface = Shape | DeflectedContour
"""The surface that the body may touch."""
OTHER_KINDS = {
    "line": "a straight surface is kind: plane, with a point and its normal into the body",
    "arc": "a round surface is kind: circle, with center, radius and the side of the body",
}
"""Words that are no kinds of rigid surfaces -> what to write instead."""
SurfaceSpec = Annotated[
    RigidSurface, TaggedUnion(what="a rigid surface", members=get_args(RigidSurface), other_kinds=OTHER_KINDS)
]
"""A rigid surface whose class is chosen by the key `kind`."""
