"""Values that the references of a spec expect at the contact points."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Self

import numpy as np
from pydantic import PlainSerializer, computed_field

from bemcontact.arrays import Array, BoolArray
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen
from bemcontact.problems import (
    Crack,
    FlatPunch,
    Hertz,
    Part,
    PinInHole,
    Problem,
    ProppedBeam,
    Reference,
    ShrinkFit,
    Table,
    Uniform,
    Values,
)
from bemcontact.problems.pin_and_hole import EQUAL, Round, pin_and_hole
from bemcontact.reference.closed_forms import (
    BeamOverProp,
    ClosedCrack,
    HertzContact,
    PunchOnHalfPlane,
    ShrunkRing,
)
from bemcontact.reference.pin_in_hole import WIDEST, LoosePin
from bemcontact.reference.positions import LEVEL, Frame, coordinates, in_zone, reach, spacing
from bemcontact.serialization import Flags, Internal, Leaf, Pair

HERTZ_RANGE = 0.1
"""Largest b/R for which Hertz judges a solution; the error of its peak is 0.23 % then."""
MEASURED = 0.4
"""Largest b/R for which the error of the peak is known."""
INTERIOR = 0.9
"""Part of a contact within which pressures are compared: not at edges and tips, which no mesh resolves, nor at the end
of Hertz's curve, where an error of b is magnified by 1 / sqrt(2 (1 - x/b))."""
HALF_PLANE = 10.0
"""Least size of a half-plane, in half-widths of contact; the error of Hertz and punch is 0.5 % then."""
INFINITE_PLATE = 20.0
"""Least size of an infinite plate, in radii of its hole; the error of the peak is up to 1.2 % at a half angle of 70
degrees, as far as the plate is held on one side, and 0.3 % if it is held on two."""
LOOSE = 0.03
"""Largest clearance of a pin over its radius; an angle of contact is off by a quarter of that."""
NEARLY = 0.05
"""Part of a radius within which an outline ends at the center or at the far side of a pin."""
INFINITE_PANEL = 20.0
"""Least size of an infinite panel, in half-lengths a of the crack; the error is 3.4 (a/size)², 0.9 %."""
SLENDER = 10.0
"""Least span of a beam, in heights."""
PRESSING = 0.25
"""Least part of the free sag of a beam that its prop takes back; the error of the sag is divided by it."""

SOURCES: dict[type[Reference], str] = {
    Hertz: "Hertz; Johnson 1985, section 4.2",
    FlatPunch: "rigid punch on a half-plane; Johnson 1985, section 2.8",
    ShrinkFit: "Lamé; Timoshenko and Goodier 1970, article 28",
    PinInHole: "pin in a hole; Persson 1964, Ciavarella and Decuzzi 2001",
    Uniform: "uniform compression",
    Crack: "elliptical opening in an infinite panel, by superposition",
    ProppedBeam: "beam theory with Timoshenko's shear",
}
"""Kind of closed form -> source."""

TOLERANCES: dict[type[Reference], tuple[float, str]] = {
    Hertz: (0.01, "the error of Hertz in its range is up to 0.5 %, the rest is for the mesh"),
    FlatPunch: (0.02, "the error for the smallest body in its range is 0.5 %, the rest is for the mesh"),
    ShrinkFit: (0.01, "exact in the linear theory; the tolerance is for the mesh"),
    PinInHole: (0.02, "the error for the smallest plate in its range is up to 1.2 %, the rest is for the mesh"),
    Uniform: (0.01, "exact in the linear theory; the tolerance is for the mesh"),
    Crack: (0.02, "the error for the smallest panel in its range is 0.9 %, the rest is for the mesh"),
    ProppedBeam: (0.02, "the error of beam theory in its range is up to 1.3 %, the rest is for the mesh"),
    Values: (0.01, "printed values of three digits, and the mesh"),
    Table: (0.05, "points read from a figure have errors of some per cent of its height"),
}
"""Kind -> relative difference that is allowed if the spec states none, and the reason."""


def _known(pressure: Array) -> list[float | None]:
    """The pressures as a list, with None for those that are not numbers."""
    return [float(p) if np.isfinite(p) else None for p in pressure]


@frozen
class Expected(Leaf):
    """Values that a reference expects of the solution; null for quantities without one."""

    name: str
    """Name of the reference in the problem."""
    source: str
    """Source of the values."""
    closed_form: bool
    """Whether it is a formula instead of a list of values."""
    zone: str | None
    """Name of the contact zone; null for all zones."""
    pressure: Annotated[Array, PlainSerializer(_known, return_type=list[float | None])]
    """Pressure (n,) at each contact point per undeformed length [p]; null where it is unknown."""
    compared: Flags
    """Whether the pressure at each contact point (n,) is compared: not at singular ends."""
    tolerance: float
    """Relative difference that is allowed."""
    reason: str
    """Reason for this tolerance."""
    peak: float | None = None
    """Largest pressure [p]."""
    half_width: float | None = None
    """Distance of the farther end of contact from `center`, along the tangent there [L]."""
    center: Pair | None = None
    """Middle (x, y) of the contact [L]."""
    contact_length: float | None = None
    """Length of the boundary in contact [L]."""
    start: float | None = None
    """Smallest coordinate of contact, [L] or degrees."""
    end: float | None = None
    """Largest coordinate of contact, [L] or degrees."""
    along: Internal[Values | Table | None] = None
    """Reference that has the coordinate of `start` and `end`."""
    ends: tuple[Pair, ...] = ()
    """Contact points (x, y) nearest to `start` and `end`, for drawing [L]."""
    resultant: float | None = None
    """Magnitude of the contact force on what is modeled, per thickness [p L]."""
    infinite: bool = False
    """Whether it states a peak, and that of the solution is infinite, so that the solution is not judged by it."""
    in_range: bool = True
    """Whether the reference is valid for this problem, so that the solution is judged by it."""
    remark: str = ""
    """Reason why the reference, or its peak, is not judged; or empty."""

    def without_peak(self, infinite: Sequence[str]) -> Self:
        """Return a copy that says so if it states a peak in a zone whose peak is infinite."""
        own = [name for name in infinite if self.zone in (None, name)]
        if self.peak is None or not own:
            return self
        why = f"the peak pressure of {' and '.join(own)} is infinite, and is not judged"
        return replace(self, infinite=True, remark=f"{self.remark}; {why}" if self.remark else why)

    @computed_field
    @property
    def against(self) -> str | None:
        """Coordinate of `start` and `end`: x, y, arc, or angle, which is in degrees; null without them."""
        return None if self.along is None else self.along.against


def expected(problem: Problem, contact: CondensedContact) -> tuple[Expected, ...]:
    """Evaluate the references of a problem at the contact points of any of its meshes, in the order of the spec.

    References of load cases that do not act are left out. `ProblemError` if the contact points are those of another
    problem.
    """
    if contact.zone_names != tuple(problem.zones):
        raise ProblemError(
            f"the contact points are in the zones {', '.join(contact.zone_names)}, those of the problem are "
            f"{', '.join(problem.zones)}; condense this problem"
        )
    acting = {name: stated for name, stated in problem.reference.items() if stated.case in (None, problem.case)}
    return tuple(_expected(name, stated, problem, contact) for name, stated in acting.items())


def _expected(name: str, stated: Reference, problem: Problem, contact: CondensedContact) -> Expected:
    """Evaluate one reference."""
    tolerance, reason = TOLERANCES[type(stated)]
    if stated.tolerance is not None:
        tolerance, reason = stated.tolerance, stated.reason or "stated in the spec"
    silent = Expected(
        name=name,
        source=stated.source if isinstance(stated, Values | Table) else SOURCES[type(stated)],
        closed_form=not isinstance(stated, Values | Table),
        zone=stated.zone,
        pressure=np.full(contact.size, np.nan),
        compared=np.zeros(contact.size, bool),
        tolerance=tolerance,
        reason=reason,
    )
    match stated:
        case Hertz():
            return _hertz(silent, stated, problem, contact)
        case FlatPunch():
            return _flat_punch(silent, stated, problem, contact)
        case ShrinkFit():
            return _uniform(silent, _shrink_fit(stated, problem), contact)
        case PinInHole():
            return _pin_in_hole(silent, stated, problem, contact)
        case Uniform():
            return _uniform(silent, stated.pressure, contact)
        case Crack():
            return _crack(silent, stated, problem, contact)
        case ProppedBeam():
            return _propped_beam(silent, stated, problem)
        case Values():
            return _values(silent, stated, contact)
        case Table():
            return _table(silent, stated, contact)


def _hertz(silent: Expected, stated: Hertz, problem: Problem, contact: CondensedContact) -> Expected:
    """Hertz, in range up to b/R = 0.1; near the end of contact, a node spacing at least, it is not compared."""
    surface = 0.0 if stated.surface_radius is None else 1 / stated.surface_radius
    parts = problem.touching_parts(stated.zone)
    modulus = 1 / sum(1 / part.material.contact_modulus for part in parts)
    form = HertzContact(load=stated.load, curvature=1 / stated.radius + surface, modulus=modulus)
    frame = Frame.at(contact, stated.zone, stated.center)
    near = np.abs(frame.heights(contact.points)) < abs(stated.radius)
    x = np.where(near, frame.distances(contact.points), np.inf)
    pressure = _within(contact, stated, form.pressure(x))
    steep = np.maximum((1 - INTERIOR) * form.half_width, spacing(contact))
    remark = _beyond_hertz(stated, form, reach(parts, frame))
    return replace(
        silent,
        pressure=pressure,
        compared=np.isfinite(pressure) & (np.abs(np.abs(x) - form.half_width) > steep),
        peak=form.peak,
        half_width=form.half_width,
        center=_point(frame),
        resultant=stated.load / (2 if stated.half else 1),
        in_range=not remark,
        remark=remark,
    )


def _beyond_hertz(stated: Hertz, form: HertzContact, size: float) -> str:
    """Reason why Hertz is out of its range for a body of this size [L]; empty if it is in range."""
    b = form.half_width
    ratio = b / min(abs(stated.radius), abs(stated.surface_radius or np.inf))
    if ratio > HERTZ_RANGE:
        off = f", where the error of its peak is about {100 * form.error(ratio):.2g} %" if ratio <= MEASURED else ""
        return _shown(f"Hertz needs b/R << 1; here b/R = {ratio:.2g}{off}")
    if size < HALF_PLANE * b * (1 - 1e-9):
        return _shown(f"Hertz needs a thick body; here the body ends {size / b:.2g} half-widths away from the contact")
    return ""


def _flat_punch(silent: Expected, stated: FlatPunch, problem: Problem, contact: CondensedContact) -> Expected:
    """The punch away from the ends of contact, in range for a body ten times as large as its half-width."""
    form = PunchOnHalfPlane(load=stated.load, half_width=stated.half_width, eccentricity=stated.eccentricity)
    frame = Frame.at(contact, stated.zone, stated.center)
    x = frame.distances(contact.points)
    pressure = _within(contact, stated, form.pressure(x))
    size = reach(problem.touching_parts(stated.zone), frame) / stated.half_width
    remark = ""
    if size < HALF_PLANE * (1 - 1e-9):
        remark = _shown(f"the punch needs a half-plane; here the body ends {size:.2g} half-widths away from its middle")
    return replace(
        silent,
        pressure=pressure,
        compared=np.isfinite(pressure) & _off_the_ends(form, x),
        half_width=stated.half_width,
        contact_length=2 * form.touching_half_width if form.lifts_off else None,
        center=_point(frame),
        resultant=stated.load / (2 if stated.half else 1),
        in_range=not remark,
        remark=remark,
    )


def _off_the_ends(form: PunchOnHalfPlane, x: Array) -> BoolArray:
    """Whether each position (k,) is away from the ends of contact; positions beyond an edge that lifts off are."""
    away = (x - form.middle) / form.touching_half_width
    if not form.lifts_off:
        return np.abs(away) <= INTERIOR
    away *= np.sign(form.eccentricity)
    return (away <= INTERIOR) & (np.abs(away + 1) >= 1 - INTERIOR)


def _pin_in_hole(silent: Expected, stated: PinInHole, problem: Problem, contact: CondensedContact) -> Expected:
    """The pin, in range in a plate of twenty radii; near the end of contact it is not compared."""
    zone = stated.zone or contact.zone_names[0]
    sides = pin_and_hole(problem, zone, stated)
    assert sides is not None, "checked when the problem was made"
    parts = {part.name: part for part in problem.parts}
    pin, plate = (None if name is None else parts.get(name) for name in (sides.pin, sides.plate))
    here, circle = in_zone(contact, stated.zone), sides.first
    if stated.center is None and np.ptp(contact.initial_gap[here]) < LEVEL * circle.radius:
        return replace(silent, in_range=False, remark="all gaps are equal; give the middle of the contact as center")
    form = LoosePin(
        load=stated.load,
        radius=stated.radius,
        clearance=stated.clearance,
        pin=pin and pin.material,
        plate=plate and plate.material,
    )
    if form.half_angle is None:
        wide = f"the contact is wider than {np.degrees(WIDEST):.0f} degrees to either side"
        return replace(silent, in_range=False, remark=wide)
    scale = form.mean_radius / circle.radius  # the same length of contact on circles of both radii
    middle = Frame.at(contact, stated.zone, stated.center).center
    x, y = (float(way) for way in middle - circle.center)
    end = float(np.degrees(form.half_angle * scale))
    axes = Values(source=silent.source, zone=stated.zone, against="angle", center=circle.center, zero=(x, y), end=end)
    angle = np.radians(coordinates(axes, contact.points, contact.arc_position))
    if not stated.half:
        axes = axes.model_copy(update={"start": -end})
    elif angle[here].mean() < 0:
        axes = axes.model_copy(update={"start": -end, "end": None})
    away = np.abs(np.hypot(*(contact.points - circle.center).T) - circle.radius)
    pressure = np.where(away < EQUAL * circle.radius, form.pressure(angle / scale), np.nan)
    pressure = _within(contact, stated, pressure)
    steep = np.maximum((1 - INTERIOR) * form.half_angle, spacing(contact) / circle.radius)
    remark = _beyond_pin(form, pin, plate, circle, np.array([x, y]))
    return replace(
        _values(silent, axes, contact),
        pressure=pressure,
        compared=np.isfinite(pressure) & (np.abs(np.abs(angle / scale) - form.half_angle) > steep),
        peak=form.peak,
        resultant=float(np.hypot(stated.load / 2, form.spread)) if stated.half else stated.load,
        in_range=not remark,
        remark=remark,
    )


def _beyond_pin(form: LoosePin, pin: Part | None, plate: Part | None, circle: Round, direction: Array) -> str:
    """Reason why a pin is out of its range, with the direction (2,) of its load; empty if it is in range."""
    if form.clearance > LOOSE * form.radius * (1 + 1e-9):
        return _shown(f"the form of a pin needs a small clearance; here it is {form.clearance / form.radius:.2g} radii")
    along = direction / np.hypot(*direction)
    if pin is not None:
        far = (np.vstack([edge.polyline() for edge in pin.loops[0]]) - circle.center) @ -along
        if len(pin.loops) > 1 or far.max() < (1 - NEARLY) * form.radius:
            return _shown("the form of a pin needs a whole and solid one, or half of it beside its line of symmetry")
    if plate is not None:
        across = np.array([-along[1], along[0]])
        outline = (np.vstack([edge.polyline() for edge in plate.loops[0]]) - circle.center) / form.radius
        sides = [float(side) for way in (along, -along, across, -across) if (side := (outline @ way).max()) > NEARLY]
        if min(sides) < INFINITE_PLATE - NEARLY:
            return _shown(f"the pin needs an infinite plate; here it ends {min(sides):.2g} radii away from its center")
    return ""


def _crack(silent: Expected, stated: Crack, problem: Problem, contact: CondensedContact) -> Expected:
    """The closed crack away from its tip, in range for a panel twenty times as large as its half-length."""
    (part,) = problem.touching_parts(stated.zone)
    form = ClosedCrack(
        half_length=stated.half_length,
        half_height=stated.half_height,
        compression=stated.compression,
        modulus=part.material.contact_modulus,
        slit=stated.opening == "slit",
    )
    frame = Frame.at(contact, stated.zone, stated.center)
    if form.pressure_along_plane <= 0:
        return replace(silent, in_range=False, remark="the compression is too small to close the opening to its tip")
    x = frame.distances(contact.points)
    pressure = _within(contact, stated, form.pressure(x))
    size = reach((part,), frame) / stated.half_length
    remark = ""
    if size < INFINITE_PANEL * (1 - 1e-9):
        remark = _shown(f"the crack needs an infinite panel; here it ends {size:.2g} half-lengths away from its middle")
    return replace(
        silent,
        pressure=pressure,
        compared=np.isfinite(pressure) & (np.abs(x) <= INTERIOR * stated.half_length),
        half_width=stated.half_length,
        center=stated.center,
        in_range=not remark,
        remark=remark,
    )


def _propped_beam(silent: Expected, stated: ProppedBeam, problem: Problem) -> Expected:
    """The force of one support, in range for a slender beam that presses well on its prop."""
    (part,) = problem.touching_parts(stated.zone)
    form = BeamOverProp(
        load=stated.load,
        span=stated.span,
        height=stated.height,
        gap=stated.gap,
        modulus=part.material.contact_modulus,
        shear_modulus=part.material.shear_modulus,
    )
    if stated.support == "prop" and not form.prop:
        return replace(silent, in_range=False, remark="the beam does not reach its prop")
    remark = _beyond_beam(stated, form)
    force = form.end if stated.support == "end" else form.prop / (2 if stated.half else 1)
    return replace(silent, resultant=force, in_range=not remark, remark=remark)


def _beyond_beam(stated: ProppedBeam, form: BeamOverProp) -> str:
    """Reason why beam theory is out of its range; empty if it is in range."""
    slenderness = stated.span / stated.height
    if slenderness < SLENDER * (1 - 1e-9):
        return _shown(f"beam theory needs a slender beam; this one is {slenderness:.2g} heights long")
    if 0 < form.sag - stated.gap < PRESSING * form.sag * (1 - 1e-9):
        part = 1 - stated.gap / form.sag
        return _shown(f"the beam presses on its prop by {100 * part:.2g} % of its sag only")
    return ""


def _shrink_fit(stated: ShrinkFit, problem: Problem) -> float:
    """The pressure [p] of Lamé, on the pin or in the bore."""
    (part,) = problem.touching_parts(stated.zone)
    ring = ShrunkRing(
        inner_radius=stated.inner_radius, outer_radius=stated.outer_radius, interference=stated.interference
    )
    return (ring.pressure_on_pin if stated.rigid == "pin" else ring.pressure_in_bore)(part.material)


def _uniform(silent: Expected, value: float, contact: CondensedContact) -> Expected:
    """A uniform pressure at all points of the zone."""
    within = in_zone(contact, silent.zone)
    return replace(silent, pressure=np.where(within, value, np.nan), compared=within, peak=value)


def _values(silent: Expected, stated: Values, contact: CondensedContact) -> Expected:
    """Single values, as they are."""
    center = None if stated.half_width is None else _point(Frame.at(contact, stated.zone, None))
    given = [position for position in (stated.start, stated.end) if position is not None]
    return replace(
        silent,
        peak=stated.peak,
        half_width=stated.half_width,
        center=center,
        contact_length=stated.contact_length,
        start=stated.start,
        end=stated.end,
        along=stated,
        ends=tuple(_nearest(stated, position, contact) for position in given),
        resultant=stated.resultant,
    )


def _table(silent: Expected, stated: Table, contact: CondensedContact) -> Expected:
    """The curve, straight between its points, at contact points within its range."""
    position, value = np.array(sorted(stated.pressure)).T
    here = coordinates(stated, contact.points, contact.arc_position)
    # A node at the very end of the table differs from it by round-off.
    slack = 1e-9 * (position[-1] - position[0])
    inside = (here >= position[0] - slack) & (here <= position[-1] + slack) & in_zone(contact, stated.zone)
    if not inside.any():
        return replace(silent, in_range=False, remark="no contact point lies within the range of the table")
    pressure = np.where(inside, np.interp(here, position, value), np.nan)
    return replace(silent, pressure=pressure, compared=inside, along=stated)


def _within(contact: CondensedContact, stated: Reference, pressure: Array) -> Array:
    """Pressure (n,), not a number in other zones."""
    return np.where(in_zone(contact, stated.zone), pressure, np.nan)


def _nearest(stated: Values, position: float, contact: CondensedContact) -> Pair:
    """The contact point whose coordinate is nearest to a position."""
    index = np.flatnonzero(in_zone(contact, stated.zone))
    here = coordinates(stated, contact.points[index], contact.arc_position[index])
    x, y = contact.points[index[np.argmin(np.abs(here - position))]]
    return float(x), float(y)


def _point(frame: Frame) -> Pair:
    x, y = frame.center
    return float(x), float(y)


def _shown(why: str) -> str:
    """End a remark on a reference that is out of its range."""
    return f"{why}: shown, not judged"
