"""What is known of the answer: closed forms and published values that a spec names, to be compared with what is found.

Forces are per thickness and lengths are in the units of the problem. Nothing here acts on the body.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from bemcontact.errors import Complaint
from bemcontact.problem.closed_form import AnyReference, Crack, FlatPunch, Hertz, ProppedBeam, ShrinkFit, Uniform
from bemcontact.problem.partial import Written
from bemcontact.problem.tagged_union import ByKind
from bemcontact.problem.validation import (
    Number,
    Point,
    Positive,
    Text,
    complain,
    listed,
    unknown_word,
    validation_error,
)


def _not_blank(value: str) -> str:
    """Refuse a text without a word."""
    if not value.strip():
        raise complain("an empty text tells nothing")
    return value


Words = Annotated[Text, AfterValidator(_not_blank)]
"""Text that says something; unlike a `Name`, it may contain dots and brackets."""


class _Along(AnyReference):
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


Reference = Hertz | FlatPunch | ShrinkFit | Uniform | Crack | ProppedBeam | Values | Table
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
            "propped_beam": ProppedBeam,
            "values": Values,
            "table": Table,
        },
    ),
]
"""A reference as it is written; `kind` says which."""


def reference_complaints(references: Written, zones: Written, cases: Sequence[str]) -> list[Complaint]:
    """Check that references mean zones and load cases that there are, and say which zone where there are several.

    Parameters
    ----------
    references, zones : these parts of a problem, right or wrong; what is unreadable in them is passed over
    cases : names of load cases and combinations
    """
    names = [str(zone.path[-1]) for zone in zones.each()]
    complaints = []
    for reference in references.each():
        zone, case = reference.below(Hertz, "zone"), reference.below(Hertz, "case")
        if isinstance(case.value, str) and case.value not in cases:
            complaints.append(Complaint(path=case.path, message=unknown_word("load case", case.value, cases)))
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
    return kind in ("hertz", "flat_punch", "crack", "propped_beam") or against == "arc" or foot
