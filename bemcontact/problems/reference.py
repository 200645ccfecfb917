"""Reference values: closed forms and published values with which the computed contact is compared.

Forces are per thickness, lengths are in the units of the problem. A reference does not act on the body.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, ClassVar, Literal, Self, get_args

from pydantic import AfterValidator, Field, Strict, ValidationInfo, field_validator, model_validator

from bemcontact.errors import Issue
from bemcontact.problems.tagged_union import TaggedUnion
from bemcontact.problems.validation import (
    LARGEST_STATED,
    Flag,
    Name,
    Number,
    Point,
    Positive,
    SpecModel,
    Text,
    invalid,
    validation_error,
)
from bemcontact.problems.wording import exact


def _not_blank(value: str) -> str:
    """Refuse an empty text."""
    if not value.strip():
        raise invalid("the text is empty; write a source")
    return value


NonEmptyText = Annotated[Text, AfterValidator(_not_blank)]
"""A text that is not empty."""


Tolerance = Annotated[float, Strict(), Field(gt=0, lt=1)]
"""A relative difference, such as 0.02 for 2 %."""


class ReferenceBase(SpecModel):
    """Base class of all references."""

    zone: Name | None = None
    """The contact zone for which the reference holds; all zones if left out."""
    case: Name | None = None
    """The load case or combination for which the reference holds; all of them if left out."""
    tolerance: Tolerance | None = None
    """The largest relative difference that counts as agreement, such as 0.02; each kind has a default."""
    reason: Text = ""
    """The reason for the tolerance."""

    @model_validator(mode="after")
    def _reason_of_something(self) -> Self:
        """Refuse a reason without a tolerance."""
        if self.reason and self.tolerance is None:
            raise invalid("reason explains the tolerance, which is missing; give tolerance too")
        return self


class Hertz(ReferenceBase):
    """Hertz theory for line contact of an elastic cylinder with a plane or cylinder, rigid or elastic."""

    example: ClassVar[str] = "{kind: hertz, radius: 10, load: 400}"

    kind: Literal["hertz"] = "hertz"
    """The closed form: hertz."""
    load: Positive
    """The force per thickness on the whole contact, even if only half of it is modeled."""
    radius: Number
    """The radius at the contact of the elastic body, of two that of the first side; negative if the body is concave,
    such as a ring on a pin."""
    surface_radius: Number | None = None
    """The radius of the rigid surface or of the other body, negative if it is concave, such as a groove; left out for a
    plane."""
    center: Point | None = None
    """The middle of the contact [x, y]; if left out, the point with the smallest initial gap."""
    half: Flag = False
    """Whether only half of the contact is modeled, up to a line of symmetry through its middle."""

    @field_validator("radius", "surface_radius")
    @classmethod
    def _is_round(cls, value: float | None) -> float | None:
        """Refuse a radius of 0."""
        if value == 0:
            raise invalid("must not be 0; give a positive radius if convex, a negative one if concave")
        return value

    @field_validator("surface_radius")
    @classmethod
    def _touches_in_a_line(cls, value: float | None, info: ValidationInfo) -> float | None:
        """Refuse a concave surface that is not wider than the convex one."""
        radius = info.data.get("radius")
        if value and radius and not 1 / radius + 1 / value > 0:
            found = f"must be greater than 0, found 1/{radius:g} + 1/{value:g}"
            raise invalid(f"1/radius + 1/surface_radius {found}; make the concave radius the larger one")
        return value

    @model_validator(mode="after")
    def _bulges(self) -> Self:
        """Refuse a concave body on a plane."""
        if self.surface_radius is None and self.radius < 0:
            raise invalid("a concave body (radius < 0) cannot touch a plane in one line; give surface_radius")
        return self


class FlatPunch(ReferenceBase):
    """A rigid punch with a flat face and sharp edges, free to tilt, pressed without friction on a half-plane."""

    kind: Literal["flat_punch"] = "flat_punch"
    """The closed form: flat_punch."""
    load: Positive
    """The force per thickness on the whole punch, even if only half of it is modeled."""
    half_width: Positive
    """The half-width of the punch."""
    center: Point
    """The middle of its face [x, y]."""
    half: Flag = False
    """Whether only half of the punch is modeled, up to a line of symmetry through its middle."""
    eccentricity: Number = 0.0
    """The distance of the load from the middle, positive to the right, or upwards for a vertical face. Beyond
    half_width/2 the other edge of the punch lifts off."""

    @field_validator("eccentricity")
    @classmethod
    def _acts_on_the_punch(cls, value: float, info: ValidationInfo) -> float:
        """Refuse a load outside the punch, and one off the line of symmetry."""
        if value and info.data.get("half"):
            raise invalid("must be 0 if only half of the punch is modeled (half: true)")
        half_width = info.data.get("half_width")
        if half_width is not None and not abs(value) < half_width:
            raise invalid(f"must be between -half_width and half_width = {exact(half_width)}, found {exact(value)}")
        return value


class ShrinkFit(ReferenceBase):
    """A shrink fit: an elastic ring on a rigid pin, or an elastic ring or disk in a rigid bore."""

    kind: Literal["shrink_fit"] = "shrink_fit"
    """The closed form: shrink_fit."""
    rigid: Literal["pin", "bore"] = "pin"
    """The rigid part: pin (inside the ring) or bore (around it)."""
    inner_radius: Annotated[float, Strict(), Field(ge=0, le=LARGEST_STATED)]
    """The inner radius of the undeformed ring; 0 for a disk in a bore."""
    outer_radius: Positive
    """The outer radius of the undeformed ring."""
    interference: Positive
    """The interference: radius of the pin minus inner radius of the ring, or outer radius of the ring minus radius of
    the bore."""

    @field_validator("inner_radius")
    @classmethod
    def _leaves_room(cls, value: float, info: ValidationInfo) -> float:
        """Refuse a pin in a disk without a hole."""
        if value == 0 and info.data.get("rigid") == "pin":
            raise invalid("must be greater than 0 on a pin, found 0; a disk without a hole needs rigid: bore")
        return value

    @field_validator("outer_radius")
    @classmethod
    def _is_a_ring(cls, value: float, info: ValidationInfo) -> float:
        """Refuse a ring without thickness."""
        inner = info.data.get("inner_radius")
        if inner is not None and value <= inner:
            raise invalid(f"must be greater than inner_radius = {exact(inner)}, found {exact(value)}")
        return value


class PinInHole(ReferenceBase):
    """A round pin in the round hole of a large plate, over any angle of contact; either of them may be rigid."""

    example: ClassVar[str] = "{kind: pin_in_hole, load: 540, radius: 10, clearance: 0.02}"

    kind: Literal["pin_in_hole"] = "pin_in_hole"
    """The closed form: pin_in_hole."""
    load: Positive
    """The force per thickness on the whole pin, at its center or spread over its volume, even if only half of it is
    modeled."""
    radius: Positive
    """The radius of the pin."""
    clearance: Positive
    """The radius of the hole minus that of the pin, plus the gap that the contact states."""
    center: Point | None = None
    """The middle of the contact [x, y]; if left out, the point with the smallest initial gap."""
    half: Flag = False
    """Whether only half of the contact is modeled, up to a line of symmetry through its middle."""


class Uniform(ReferenceBase):
    """A uniform pressure, such as under a block between planes."""

    kind: Literal["uniform"] = "uniform"
    """The closed form: uniform."""
    pressure: Positive
    """The pressure at all points of the contact."""


class Crack(ReferenceBase):
    """An elliptical opening in an infinite panel that compression closes; half of it is modeled on a rigid plane."""

    kind: Literal["crack"] = "crack"
    """The closed form: crack."""
    half_length: Positive
    """The half-length of the opening, along the rigid plane."""
    half_height: Positive
    """The half-height of the undeformed opening in its middle."""
    compression: Positive
    """The pressure on the far ends of the panel, normal to the opening."""
    center: Point
    """The center of the opening [x, y]."""
    opening: Literal["ellipse", "slit"] = "ellipse"
    """The model of the opening: ellipse, or slit for a straight edge whose gap is that of the ellipse."""


class ProppedBeam(ReferenceBase):
    """A beam under uniform load on two rigid end supports, with a rigid prop below its middle."""

    kind: Literal["propped_beam"] = "propped_beam"
    """The closed form: propped_beam."""
    support: Literal["prop", "end"]
    """The support whose force is compared: prop, or end for one of the two ends."""
    load: Positive
    """The pressure on the beam between its end supports."""
    span: Positive
    """The distance between the end supports."""
    height: Positive
    """The height of the beam."""
    gap: Annotated[float, Strict(), Field(ge=0, le=LARGEST_STATED)]
    """The gap between the undeformed beam and the prop."""
    half: Flag = False
    """Whether only half of the beam is modeled, up to a line of symmetry through its middle."""


class _PositionedReference(ReferenceBase):
    """Base class of references that give positions on the contact by a coordinate."""

    against: Literal["x", "y", "arc", "angle"] = "x"
    """The coordinate: x, y, arc (length along the boundary from the start of the zone), or angle (in degrees)."""
    center: Point | None = None
    """The center [x, y] of the angles; only with against: angle."""
    zero: Point | None = None
    """The direction [x, y] of angle 0; angles are counterclockwise from it. [1, 0] if left out."""

    @model_validator(mode="after")
    def _angle_and_its_center(self) -> Self:
        """Refuse an angle without a center, and a center without an angle."""
        if self.against == "angle" and self.center is None:
            raise invalid("against: angle needs a center; give center: [x, y]")
        if self.against != "angle" and (self.center or self.zero):
            raise invalid("center and zero are for angles only; leave them out, or write against: angle")
        if self.zero == (0.0, 0.0):
            raise invalid("zero: [0, 0] has no direction; give the direction [x, y] of angle 0")
        return self


class Values(_PositionedReference):
    """Single values from a source."""

    kind: Literal["values"] = "values"
    """The form of the reference: values."""
    source: NonEmptyText
    """The source of the values."""
    peak: Positive | None = None
    """The largest pressure."""
    half_width: Positive | None = None
    """The half-width of the contact: the distance of its farther end from the point with the smallest initial gap,
    along the tangent at that point."""
    contact_length: Positive | None = None
    """The length of the boundary that is in contact."""
    start: Number | None = None
    """The start of contact: its smallest coordinate (see against)."""
    end: Number | None = None
    """The end of contact: its largest coordinate (see against)."""
    resultant: Positive | None = None
    """The magnitude of the force of the rigid surface on the modeled part of the body, per thickness."""

    @model_validator(mode="after")
    def _some_value(self) -> Self:
        """Refuse a reference without a value, and an end before the start."""
        quantities = ("peak", "half_width", "contact_length", "start", "end", "resultant")
        if all(getattr(self, quantity) is None for quantity in quantities):
            raise invalid(f"there is no value; give one or more of {', '.join(quantities)}")
        if self.start is not None and self.end is not None and not self.start < self.end:
            message = f"must be greater than start = {exact(self.start)}, found {exact(self.end)}"
            raise validation_error("values", [Issue(path=("end",), message=message)])
        return self


class Table(_PositionedReference):
    """A pressure curve from a source: points with straight lines between them."""

    kind: Literal["table"] = "table"
    """The form of the reference: table."""
    source: NonEmptyText
    """The source of the values."""
    pressure: Annotated[tuple[Point, ...], Field(min_length=2)]
    """The points of the curve: pairs [position, pressure] in any order."""

    @model_validator(mode="after")
    def _is_a_curve(self) -> Self:
        """Refuse pairs that are not a pressure curve."""
        if issues := list(self._wrong_pairs()):
            raise validation_error("table", issues)
        return self

    def _wrong_pairs(self) -> Iterator[Issue]:
        """Issues of single pairs, then of two pairs at one position."""
        for i, (position, pressure) in enumerate(self.pressure):
            if pressure < 0:
                message = f"a contact pressure must not be negative, found {pressure:g}"
                yield Issue(path=("pressure", i, 1), message=message)
            if self.against == "angle" and abs(position) > 180:
                message = f"an angle must be between -180 and 180 degrees, found {position:g}"
                yield Issue(path=("pressure", i, 0), message=message)
        order = sorted(range(len(self.pressure)), key=lambda i: (self.pressure[i][0], i))
        for before, after in pairwise(order):
            if self.pressure[before][0] == self.pressure[after][0]:
                message = f"the position {self.pressure[after][0]:g} occurs in pressure[{before}] too; keep one"
                yield Issue(path=("pressure", after, 0), message=message)


Reference = Hertz | FlatPunch | ShrinkFit | PinInHole | Uniform | Crack | ProppedBeam | Values | Table
"""A reference of any kind."""
ReferenceSpec = Annotated[Reference, TaggedUnion(what="a reference", members=get_args(Reference))]
"""A reference whose class is chosen by the key `kind`."""
