"""What is known of the answer: closed forms and published values that a spec names, to be compared with what is found.

Forces are per thickness and lengths are in the units of the problem. Nothing here acts on the body.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, Strict, ValidationInfo, field_validator, model_validator

from bemcontact.errors import Complaint
from bemcontact.problem.kinds import ByKind
from bemcontact.problem.stated import (
    Flag,
    Name,
    Number,
    Point,
    Positive,
    Stated,
    Text,
    complain,
    listed,
    unknown_word,
    validation_error,
)
from bemcontact.problem.written import Written


def _not_blank(value: str) -> str:
    """Refuse a text without a word."""
    if not value.strip():
        raise complain("an empty text tells nothing")
    return value


Words = Annotated[Text, AfterValidator(_not_blank)]
"""Text that says something; unlike a `Name`, it may contain dots and brackets."""
Tolerance = Annotated[float, Strict(), Field(gt=0, lt=1)]
"""A relative difference, 0.02 for two per cent."""


class _Reference(Stated):
    """What every reference states."""

    zone: Name | None = None
    """The contact zone that is meant; all zones if left out."""
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


class Hertz(_Reference):
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


class FlatPunch(_Reference):
    """A rigid punch with a flat face and sharp edges, pressed without friction on a half-plane.

    Raises
    ------
    ProblemError
        If the load acts so far out that an edge of the punch lifts off.
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
    """How far from the middle the load acts, positive to the right (upwards along a vertical face)."""

    @field_validator("eccentricity")
    @classmethod
    def _presses_everywhere(cls, value: float, info: ValidationInfo) -> float:
        """Refuse a load that tilts the punch off the plane, and one off the line of symmetry."""
        if value and info.data.get("half"):
            raise complain("must be 0 where only one half is modelled (half: true)")
        half_width = info.data.get("half_width")
        if half_width is not None and abs(value) > half_width / 2:
            raise complain(f"must be at most half_width/2 = {half_width / 2:g} either way, found {value:g}")
        return value


class ShrinkFit(_Reference):
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


class Uniform(_Reference):
    """The same pressure everywhere, as under a block between planes."""

    kind: Literal["uniform"] = "uniform"
    """The closed form: uniform."""
    pressure: Positive
    """The pressure."""


class Crack(_Reference):
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


class _Along(_Reference):
    """A reference that names places of the contact by a coordinate."""

    against: Literal["x", "y", "arc", "angle"] = "x"
    """The coordinate: x, y, arc (length along the boundary from where the zone begins), or angle (in degrees)."""
    center: Point | None = None
    """Where the angles are measured: the centre [x, y]; only with against: angle."""
    zero: Point | None = None
    """The direction [x, y] of angle 0, from which angles count anticlockwise; [1, 0] if left out."""

    @model_validator(mode="after")
    def _angle_and_its_center(self) -> Self:
        """Refuse an angle without centre, and a centre without angle."""
        if self.against == "angle" and self.center is None:
            raise complain("angles are measured around a centre; give center: [x, y]")
        if self.against != "angle" and (self.center or self.zero):
            raise complain("center and zero belong to angles; leave them out, or write against: angle")
        if self.zero == (0.0, 0.0):
            raise complain("zero: [0, 0] has no direction; let it point to where the angle is 0")
        return self


class Values(_Along):
    """Single values that somebody found.

    Raises
    ------
    ProblemError
        If there is no value.
    """

    kind: Literal["values"] = "values"
    """The form of the reference: values."""
    source: Words
    """Where the values come from."""
    peak: Positive | None = None
    """The largest pressure."""
    half_width: Positive | None = None
    """Distance of the farther end of contact from where the initial gap is smallest, along the tangent there."""
    contact_length: Positive | None = None
    """Length of the boundary that is in contact."""
    start: Number | None = None
    """The smallest coordinate (see against) at which there is contact."""
    end: Number | None = None
    """The largest coordinate (see against) at which there is contact."""
    resultant: Positive | None = None
    """Magnitude of the force of the rigid surface on what is modelled, per thickness."""

    @model_validator(mode="after")
    def _some_value(self) -> Self:
        """Refuse a reference that says nothing, and ends in the wrong order."""
        quantities = ("peak", "half_width", "contact_length", "start", "end", "resultant")
        if all(getattr(self, quantity) is None for quantity in quantities):
            raise complain(f"it states no value; give one or more of {listed(quantities)}")
        if self.start is not None and self.end is not None and not self.start < self.end:
            message = f"must be greater than start = {self.start:g}, found {self.end:g}"
            raise validation_error("values", [Complaint(path=("end",), message=message)])
        return self


class Table(_Along):
    """A curve of pressure that somebody found, as points between which it is straight; beyond them it says nothing.

    Raises
    ------
    ProblemError
        If a position stands twice, a pressure is negative, or an angle beyond half a turn.
    """

    kind: Literal["table"] = "table"
    """The form of the reference: table."""
    source: Words
    """Where the values come from."""
    pressure: Annotated[tuple[Point, ...], Field(min_length=2)]
    """Pairs [position, pressure] in any order."""

    @model_validator(mode="after")
    def _is_a_curve(self) -> Self:
        """Refuse pairs that are no curve of pressure."""
        if complaints := list(self._wrong_pairs()):
            raise validation_error("table", complaints)
        return self

    def _wrong_pairs(self) -> Iterator[Complaint]:
        """Complain about single pairs, then about two at one position."""
        for i, (position, pressure) in enumerate(self.pressure):
            if pressure < 0:
                message = f"a contact pressure is not negative, found {pressure:g}"
                yield Complaint(path=("pressure", i, 1), message=message)
            if self.against == "angle" and abs(position) > 180:
                message = f"angles go from -180 to 180 degrees, found {position:g}"
                yield Complaint(path=("pressure", i, 0), message=message)
        order = sorted(range(len(self.pressure)), key=lambda i: (self.pressure[i][0], i))
        for before, after in pairwise(order):
            if self.pressure[before][0] == self.pressure[after][0]:
                message = f"the position {self.pressure[after][0]:g} stands in pressure[{before}] too; keep one"
                yield Complaint(path=("pressure", after, 0), message=message)


Reference = Hertz | FlatPunch | ShrinkFit | Uniform | Crack | Values | Table
"""Anything that is known of the answer."""
StatedReference = Annotated[
    Reference,
    ByKind(
        what="a reference",
        kinds={
            "hertz": Hertz,
            "flat_punch": FlatPunch,
            "shrink_fit": ShrinkFit,
            "uniform": Uniform,
            "crack": Crack,
            "values": Values,
            "table": Table,
        },
    ),
]
"""A reference as it is written; `kind` says which."""


def reference_complaints(references: Written, zones: Written) -> list[Complaint]:
    """Check that references mean contact zones that there are, and say which one where there are several.

    Parameters
    ----------
    references, zones : these parts of a problem, right or wrong; what is unreadable in them is passed over
    """
    names = [str(zone.path[-1]) for zone in zones.each()]
    complaints = []
    for reference in references.each():
        zone = reference.below(Hertz, "zone")
        if isinstance(zone.value, str) and names and zone.value not in names:
            complaints.append(Complaint(path=zone.path, message=unknown_word("contact zone", zone.value, names)))
        elif zone.value is None and len(names) > 1 and _needs_one_zone(reference):
            message = f"there are {len(names)} contact zones; say which one is meant, zone: {' or '.join(names)}"
            complaints.append(Complaint(path=reference.path, message=message))
    return complaints


def _needs_one_zone(reference: Written) -> bool:
    """Tell that a reference makes no sense of several contacts at once."""
    kind, against = (reference.below(Table, key).value for key in ("kind", "against"))
    foot = reference.below(Values, "half_width").value is not None and kind == "values"
    return kind in ("hertz", "flat_punch", "crack") or against == "arc" or foot
