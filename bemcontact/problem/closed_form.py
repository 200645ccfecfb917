"""References that are closed forms: what a spec states of them."""

from typing import Annotated, Literal, Self

from pydantic import Field, Strict, ValidationInfo, field_validator, model_validator

from bemcontact.problem.validation import Flag, Name, Number, Point, Positive, Stated, Text, complain

Tolerance = Annotated[float, Strict(), Field(gt=0, lt=1)]
"""A relative difference, 0.02 for two per cent."""


class AnyReference(Stated):
    """What every reference states."""

    zone: Name | None = None
    """The contact zone that is meant; all zones if left out."""
    case: Name | None = None
    """The load case or combination of which it is known, and judged only where that acts; any if left out."""
    tolerance: Tolerance | None = None
    """Relative difference up to which the answer agrees, such as 0.02; a default of the kind if left out."""
    reason: Text = ""
    """Why the tolerance is what it is."""

    @model_validator(mode="after")
    def _reason_of_something(self) -> Self:
        """Refuse a reason for a tolerance that is not given."""
        if self.reason and self.tolerance is None:
            raise complain("a reason without a tolerance explains nothing; give tolerance too")
        return self


class Hertz(AnyReference):
    """Line contact of an elastic cylinder with a rigid plane or cylinder, as Hertz has it.

    Raises
    ------
    ProblemError
        If a radius is zero, or the surfaces curve so that they do not touch in one line.
    """

    kind: Literal["hertz"] = "hertz"
    """The closed form: hertz."""
    load: Positive
    """Force per thickness over the whole contact, also where only one half of it is modelled."""
    radius: Number
    """Radius of the elastic body where it touches; negative where it is hollow, as the bore of a ring on a pin."""
    surface_radius: Number | None = None
    """Radius of the rigid surface, negative where it is hollow, as a groove; left out for a plane."""
    center: Point | None = None
    """The middle of the contact [x, y]; where the initial gap is smallest if left out."""
    half: Flag = False
    """Whether only one half of the contact is modelled, up to a line of symmetry through its middle."""

    @field_validator("radius", "surface_radius")
    @classmethod
    def _is_round(cls, value: float | None) -> float | None:
        """Refuse a radius of nothing."""
        if value == 0:
            raise complain("must not be 0: positive where it bulges, negative where it is hollow")
        return value

    @field_validator("surface_radius")
    @classmethod
    def _touches_in_a_line(cls, value: float | None, info: ValidationInfo) -> float | None:
        """Refuse a rigid surface that the body cannot touch in one line."""
        radius = info.data.get("radius")
        if value and radius and not 1 / radius + 1 / value > 0:
            found = f"must be greater than 0, found 1/{radius:g} + 1/{value:g}"
            raise complain(f"1/radius + 1/surface_radius {found}; a hollow is wider than what lies in it")
        return value

    @model_validator(mode="after")
    def _bulges(self) -> Self:
        """Refuse a hollow body on a plane."""
        if self.surface_radius is None and self.radius < 0:
            raise complain("a hollow body (radius < 0) needs the surface_radius of what lies in it")
        return self


class FlatPunch(AnyReference):
    """A rigid punch with a flat face and sharp edges, free to tilt, pressed without friction on a half-plane.

    Raises
    ------
    ProblemError
        If the load acts beyond an edge of the punch, or off the middle where one half is modelled.
    """

    kind: Literal["flat_punch"] = "flat_punch"
    """The closed form: flat_punch."""
    load: Positive
    """Force per thickness over the whole punch, also where only one half of it is modelled."""
    half_width: Positive
    """Half the width of the punch."""
    center: Point
    """The middle of its face [x, y]."""
    half: Flag = False
    """Whether only one half of the punch is modelled, up to a line of symmetry through its middle."""
    eccentricity: Number = 0.0
    """How far from the middle the load acts, positive to the right (upwards along a vertical face); beyond
    half_width/2 the other edge lifts off."""

    @field_validator("eccentricity")
    @classmethod
    def _acts_on_the_punch(cls, value: float, info: ValidationInfo) -> float:
        """Refuse a load beyond the edges, and one off the line of symmetry."""
        if value and info.data.get("half"):
            raise complain("must be 0 where only one half is modelled (half: true)")
        half_width = info.data.get("half_width")
        if half_width is not None and not abs(value) < half_width:
            raise complain(f"must be less than half_width = {half_width:g} either way, found {value:g}")
        return value


class ShrinkFit(AnyReference):
    """An elastic ring forced on a rigid pin, or a ring or disc forced into a rigid bore.

    Raises
    ------
    ProblemError
        If the radii do not make a ring.
    """

    kind: Literal["shrink_fit"] = "shrink_fit"
    """The closed form: shrink_fit."""
    rigid: Literal["pin", "bore"] = "pin"
    """What is rigid: the pin inside the ring, or the bore around it."""
    inner_radius: Annotated[float, Strict(), Field(ge=0, le=1e100)]
    """Inner radius of the ring before it is forced on; 0 for a disc in a bore."""
    outer_radius: Positive
    """Outer radius of the ring before it is forced on."""
    interference: Positive
    """By how much the radius of the pin is larger, or that of the bore smaller, than that of the ring."""

    @field_validator("inner_radius")
    @classmethod
    def _leaves_room(cls, value: float, info: ValidationInfo) -> float:
        """Refuse a pin in a disc without a hole."""
        if value == 0 and info.data.get("rigid") == "pin":
            raise complain("must be greater than 0 on a pin; a disc without a hole needs rigid: bore")
        return value

    @field_validator("outer_radius")
    @classmethod
    def _is_a_ring(cls, value: float, info: ValidationInfo) -> float:
        """Refuse a ring without wall."""
        inner = info.data.get("inner_radius")
        if inner is not None and value <= inner:
            raise complain(f"must be greater than inner_radius = {inner:g}, found {value:g}")
        return value


class Uniform(AnyReference):
    """The same pressure everywhere, as under a block between planes."""

    kind: Literal["uniform"] = "uniform"
    """The closed form: uniform."""
    pressure: Positive
    """The pressure."""


class Crack(AnyReference):
    """An elliptical opening in a wide panel, closed by compression across it; half of the panel on a rigid plane."""

    kind: Literal["crack"] = "crack"
    """The closed form: crack."""
    half_length: Positive
    """Half the length of the opening, along the rigid plane."""
    half_height: Positive
    """Half the height of the opening in its middle, before it closes."""
    compression: Positive
    """Pressure on the far ends of the panel, across the opening."""
    center: Point
    """The centre of the opening [x, y]."""
    opening: Literal["ellipse", "slit"] = "ellipse"
    """How it is modelled: ellipse, or slit for a straight edge with the gap of the ellipse."""


class ProppedBeam(AnyReference):
    """A beam on two end supports, evenly loaded, that may sink onto a prop in its middle; all supports rigid."""

    kind: Literal["propped_beam"] = "propped_beam"
    """The closed form: propped_beam."""
    support: Literal["prop", "end"]
    """Whose force is meant: that of the prop, or of one of the ends."""
    load: Positive
    """Pressure on the beam between its ends."""
    span: Positive
    """From end support to end support."""
    height: Positive
    """Height of the beam."""
    gap: Annotated[float, Strict(), Field(ge=0, le=1e100)]
    """How far the middle of the straight beam is above the prop."""
    half: Flag = False
    """Whether only one half of the beam is modelled, up to a line of symmetry through its middle."""
