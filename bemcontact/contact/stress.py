"""Stress at points of a body, along its edges and all over it, what is derived from its components, and its peaks."""

from collections.abc import Sequence
from dataclasses import field
from enum import StrEnum
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from bemcontact.arrays import Array, IntArray
from bemcontact.cached import cached_property
from bemcontact.checks.attributes import PLACE, WithHints, Words
from bemcontact.frozen import frozen, frozen_value
from bemcontact.options import StressMeasure


class PointKind(StrEnum):
    """Where in a body a point is."""

    INSIDE = "inside"
    BOUNDARY = "boundary"
    """On the boundary, where it and the conditions on it are smooth."""
    CORNER = "corner"
    """At a corner, or where conditions change: stresses are the mean of those on either side."""
    SINGULAR = "singular"
    """At a corner, an end of contact or a change of conditions where stress is infinite: not a number."""


@frozen_value
class Labels:
    """Labels of the units of stresses and their places, for what is printed; empty if they are not known."""

    length: str = ""
    stress: str = ""


ROUND_OFF = 1e-12
"""Part of the largest stress, or of a coordinate, that is printed as zero."""
PRINTED = 6
"""Most points of which stresses are printed."""


@frozen
class Stress(WithHints):
    """Stress at k points of a body; tension is positive."""

    _called: ClassVar[Words] = {
        "points": PLACE,
        "von_mises": ("mises", "equivalent", "effective", "equivalent_stress", "seqv"),
        "max_shear": ("tresca", "maximum_shear", "shear"),
        "components": ("sigma", "tensor", "xx", "yy", "xy", "sxx", "syy", "sxy", "stress", "stresses"),
        "zz": ("szz", "out_of_plane"),
    }

    points: Array
    """Points (k, 2) [L] of the undeformed body."""
    components: Array
    """σxx, σyy, σxy (k, 3) [p]."""
    zz: Array
    """σzz (k,) [p]: ν (σxx + σyy) - E α ΔT in plane strain, zero in plane stress."""
    kind: NDArray[np.str_]
    """A `PointKind` for each point: "inside", "boundary", "corner", or "singular", where stress is not a number."""
    labels: Labels = field(default_factory=Labels)
    """Labels of units."""

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.points)

    def __repr__(self) -> str:
        """Number of points, the largest stress, and what is singular; then a table of the first points."""
        none = int((self.kind == PointKind.SINGULAR).sum())
        finite = self.von_mises[np.isfinite(self.von_mises)]
        largest = f", von Mises stress up to {_valued(finite.max(), self.labels.stress)}" if finite.size else ""
        head = f"<Stress at {_counted(len(self), 'point')}{largest}{f', {none} of them singular' if none else ''}>"
        length, stress = (f" [{label}]" if label else "" for label in (self.labels.length, self.labels.stress))
        names = (f"x{length}", f"y{length}", f"xx{stress}", "yy", "xy", "zz", "von Mises", "max shear", "kind")
        values = np.column_stack([self.components, self.zz, self.von_mises, self.max_shear])
        values[abs(values) <= ROUND_OFF * np.nanmax(abs(values), initial=0.0)] = 0.0
        numbers = np.column_stack([self.points, values])
        rows = [[*(f"{value:.5g}" for value in row), kind] for row, kind in zip(numbers, self.kind, strict=True)]
        more = [_counted(len(rows) - PRINTED, "more point")] if len(rows) > PRINTED else []
        return "\n".join([head, *(_aligned([names, *rows[:PRINTED]]) if rows else []), *more])

    @cached_property
    def principal(self) -> Array:
        """Principal stresses (k, 3) [p], the largest first, σzz among them."""
        xx, yy, _ = self.components.T
        mean, radius = (xx + yy) / 2, self.in_plane_shear
        return np.sort(np.column_stack([mean + radius, mean - radius, self.zz]), axis=1)[:, ::-1]

    @cached_property
    def in_plane_shear(self) -> Array:
        """Largest shear stress (k,) [p] in the plane: half the difference of the two principal stresses in it."""
        xx, yy, xy = self.components.T
        return np.hypot((xx - yy) / 2, xy)

    def measured(self, measure: StressMeasure) -> Array:
        """The values (k,) [p] of a stress that pictures show."""
        match measure:
            case StressMeasure.VON_MISES:
                return self.von_mises
            case StressMeasure.MAX_SHEAR:
                return self.max_shear
            case StressMeasure.ZZ:
                return self.zz
        return self.components[:, ("xx", "yy", "xy").index(measure.value)]

    @property
    def max_shear(self) -> Array:
        """Largest shear stress (k,) [p] in any direction: (σ1 - σ3)/2 of all three, half of Tresca's stress."""
        return (self.principal[:, 0] - self.principal[:, 2]) / 2

    @cached_property
    def von_mises(self) -> Array:
        """Von Mises's equivalent stress (k,) [p], of σzz too."""
        xx, yy, xy = self.components.T
        zz = self.zz
        return np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy * xy)


@frozen
class EdgeStress(WithHints):
    """Stress along an edge, at the three nodes of each of its m elements; where elements meet, from either side."""

    _called: ClassVar[Words] = {
        "hoop": ("tangential", "stress", "stresses", "components", "sigma"),
        "peak": ("max", "maximum", "max_hoop", "value"),
        "peak_at": PLACE,
        "pressure": ("normal", "traction"),
    }

    edge: str
    """Name of the edge."""
    points: Array
    """Nodes (m, 3, 2) [L]."""
    arc: Array
    """Arc length (m, 3) [L] from the start of the edge."""
    hoop: Array
    """Normal stress along the edge (m, 3) [p]; not a number where it is infinite."""
    pressure: Array
    """Pressure on the body (m, 3) [p]: minus the normal stress across the edge."""
    shear: Array
    """Traction along the edge (m, 3) [p], positive in its direction."""
    von_mises: Array
    """Von Mises's equivalent stress (m, 3) [p]."""
    peak: float | None
    """Hoop stress of the largest magnitude [p], also between nodes; None where it grows up to an infinite one."""
    peak_at: tuple[float, float] | None
    """Its place (x, y) [L]."""
    peak_arc: float | None
    """Arc length [L] from the start of the edge to it."""
    singular: Array
    """Ends of elements (s, 2) [L] where stress is infinite. The peak is away from their elements."""
    labels: Labels = field(default_factory=Labels)
    """Labels of units."""

    def __repr__(self) -> str:
        """One line: edge, elements, peak."""
        peak = "no largest hoop stress"
        if self.peak is not None and self.peak_at is not None:
            peak = f"hoop stress {_valued(self.peak, self.labels.stress)} at {_place(self.peak_at, self.labels.length)}"
        infinite = f", infinite at {_counted(len(self.singular), 'place')}" if len(self.singular) else ""
        return f"<EdgeStress of {self.edge!r}: {_counted(len(self.arc), 'element')}, {peak}{infinite}>"


@frozen
class StressPeak(WithHints):
    """A largest stress and its place."""

    _called: ClassVar[Words] = {"point": PLACE, "value": ("peak", "max", "stress", "pressure")}

    value: float
    """Equivalent stress of von Mises, or largest shear stress [p]."""
    point: tuple[float, float]
    """Place (x, y) [L] in the undeformed body."""
    depth: float
    """Distance from the contact edges of the zone, or from the boundary [L]."""
    edge: str | None = None
    """Name of the edge on which it is; None inside."""
    bar: float | None = None
    """Estimated error, relative to the value; None if it is not known."""
    body: str = ""
    """Name of the body, if there are several."""


class NoPeak(StrEnum):
    """Why there is no largest stress."""

    NO_STRESS = "nothing loads the body: it has no stress"
    NO_CONTACT = "the zone does not touch"
    TO_BOUNDARY = "no maximum inside the body: the largest value is on its boundary"
    TO_INFINITE = "no maximum: the stress grows towards a place where it is infinite"


SHEAR_BELOW, INSIDE, ON_BOUNDARY = "shear below {}", "von Mises, inside", "von Mises, on the boundary"
"""What the largest stresses are of; the first with the name of a zone."""


@frozen
class LargestStresses(WithHints):
    """The largest stresses of a body."""

    shear: dict[str, StressPeak | None]
    """Largest shear stress below the contact of each zone, at a maximum inside the body; None if there is none."""
    inside: StressPeak | None
    """Largest equivalent stress of von Mises at a maximum inside the body or on a line of symmetry; None if there is
    none."""
    boundary: StressPeak | None
    """Largest equivalent stress of von Mises along the edges, but for lines of symmetry, and for edges along which it
    grows up to an infinite one."""
    missing: dict[str, NoPeak]
    """Why there is no largest stress, by the words of its row: shear below each zone, inside and on the boundary."""
    singular: Array
    """Places (s, 2) [L] where stress is infinite: the body has no largest stress if there are any."""
    labels: Labels = field(default_factory=Labels)
    """Labels of units."""

    def __repr__(self) -> str:
        """A line for each stress, with its error and place, or why there is none."""
        below = {SHEAR_BELOW.format(zone): peak for zone, peak in self.shear.items()}
        lines = [
            f"{what}: {self._in_words(peak) if peak else self.missing.get(what, 'none')}"
            for what, peak in {**below, INSIDE: self.inside, ON_BOUNDARY: self.boundary}.items()
        ]
        infinite = f", infinite at {_counted(len(self.singular), 'place')}" if len(self.singular) else ""
        return "\n".join([f"<LargestStresses below {_counted(len(self.shear), 'zone')}{infinite}>", *lines])

    def _in_words(self, peak: StressPeak) -> str:
        """A stress with its error, its place and its depth."""
        length, stress = self.labels.length, self.labels.stress
        bar = "" if peak.bar is None else f" ± {_valued(peak.bar * peak.value, '', 2)}"
        depth = f", {_valued(peak.depth, length)} deep" if peak.depth else ""
        where = (f", edge {peak.edge}" if peak.edge else "") + (f", body {peak.body}" if peak.body else "")
        return f"{_valued(peak.value)}{bar} {stress}".rstrip() + f" at {_place(peak.point, length)}{depth}{where}"


def _valued(value: float, label: str = "", digits: int = 5) -> str:
    """A number with its unit, if this is known."""
    return f"{value:.{digits}g} {label}".rstrip()


def _counted(count: int, noun: str) -> str:
    """A number of things."""
    return f"{count} {noun}{'s' * (count != 1)}"


def _place(point: tuple[float, float], label: str) -> str:
    """A place with its unit, if this is known; what is round-off beside the other coordinate is zero."""
    far = max(map(abs, point))
    x, y = (at if abs(at) > ROUND_OFF * far else 0.0 for at in point)
    return f"({x:.5g}, {y:.5g}) {label}".rstrip()


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a table with columns that end together."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]


@frozen
class TriangulatedBody(WithHints):
    """Displacement and stress on triangles that fill the undeformed body: for pictures and files.

    The values at each point are those of `Result.stress` and `Result.displacement`. Between them they are not exact.
    """

    _called: ClassVar[Words] = {"points": PLACE, "triangles": ("elements", "cells", "faces", "connectivity")}

    points: Array
    """Points (k, 2) [L], those on the boundary first."""
    triangles: IntArray
    """Points (t, 3) of each triangle, counterclockwise."""
    displacement: Array
    """Displacement (k, 2) [L]."""
    stress: Stress
    """Stress at the points; not a number where it is infinite."""
    element: IntArray
    """Boundary element (b,) on which, or at the start of which, each of the first b points lies."""
    body: IntArray
    """Number (t,) of the elastic body that each triangle fills, in the order of the file, from 0."""
