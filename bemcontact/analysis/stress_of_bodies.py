"""Stress and displacement of one state of all elastic bodies of a problem."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Self

import numpy as np

from bemcontact.analysis.body_stress import BodyStress, ensure_in_body, infinite_starts
from bemcontact.analysis.largest_stress import largest_stresses
from bemcontact.analysis.triangulated_body import FilledBody, filled_body, triangulated_body
from bemcontact.arrays import Array, BoolArray, IntArray, magnitudes, real_array
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.mesh import Mesh, build
from bemcontact.bem.outline import Outline
from bemcontact.bem.stress_field import Located, StressField, smooth_starts
from bemcontact.cached import cached_property
from bemcontact.contact.stress import (
    INSIDE,
    ON_BOUNDARY,
    SHEAR_BELOW,
    EdgeStress,
    LargestStresses,
    Stress,
    StressPeak,
    TriangulatedBody,
)
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen
from bemcontact.problems.problem import Problem
from bemcontact.problems.wording import unknown_word
from bemcontact.serialization import Pair


@frozen
class StressOfBodies:
    """The stress of each elastic body, in one state.

    Parameters
    ----------
    bodies : of each elastic body
    pressed : (zones, m) of each, which elements touch in which zone
    """

    bodies: tuple[BodyStress, ...]
    pressed: tuple[BoolArray, ...]

    @classmethod
    def of(cls, problem: Problem, boundary: BoundaryState, pressed: BoolArray, infinite: Sequence[Pair]) -> Self:
        """Read the boundary of a problem on its mesh.

        `pressed` (zones, m) are the elements that touch in each zone. Pressure is known to be infinite at the places
        `infinite`.
        """
        mesh = build(problem)
        touching, places = _on_both_sides(mesh, [*problem.zones], pressed, infinite)
        smooth = smooth_starts(Outline(problem=problem, mesh=mesh))
        singular = infinite_starts(problem, mesh, smooth, touching)
        bodies = [
            BodyStress.of(
                problem, number, part.mesh, boundary.displacement[part.elements], boundary.traction[part.elements],
                smooth[part.elements], singular[part.elements], places,
            )
            for number, part in enumerate(mesh.parts)
        ]  # fmt: skip
        return cls(bodies=tuple(bodies), pressed=tuple(touching[:, part.elements] for part in mesh.parts))

    @property
    def edges(self) -> tuple[str, ...]:
        """Names of all edges."""
        return tuple(edge for body in self.bodies for edge in body.field.mesh.edge_names)

    def along(self, edge: str) -> EdgeStress:
        """Stress along an edge."""
        return next(body for body in self.bodies if edge in body.field.mesh.edge_names).along(edge)

    def stress(self, points: object, name: str | None) -> Stress:
        """Stress at points (k, 2): in a body, or in the first that has the point."""
        placed = self._placed(points, name)
        if len(self.bodies) == 1:
            return self.bodies[0].at(placed[0])
        owner = owners(placed)
        each = [body.at(at) for body, at in zip(self._named(name), placed, strict=True)]
        rows = np.arange(len(owner))
        return Stress(
            points=placed[0].points,
            components=np.stack([item.components for item in each])[owner, rows],
            zz=np.stack([item.zz for item in each])[owner, rows],
            kind=np.stack([item.kind for item in each])[owner, rows],
        )

    def displacement(self, points: object, name: str | None) -> Array:
        """Displacement (k, 2) [L] at points (k, 2), likewise."""
        placed = self._placed(points, name)
        each = [body.field.displacement(at)[..., 0] for body, at in zip(self._named(name), placed, strict=True)]
        return np.stack(each)[owners(placed), np.arange(len(each[0]))]

    def _named(self, name: str | None) -> Sequence[BodyStress]:
        """The body of a name, or all; `ProblemError` if there is none of this name."""
        return [self.bodies[i] for i in numbers_of([body.name for body in self.bodies], name)]

    def _placed(self, points: object, name: str | None) -> list[Located]:
        """Where points are in each body, or in one; `ProblemError` if one is in none."""
        return placed_in([body.field for body in self._named(name)], points)

    @cached_property
    def _filled(self) -> tuple[FilledBody, ...]:
        """Stress on triangles that fill each body."""
        return tuple(map(filled_body, self.bodies))

    @cached_property
    def triangulated(self) -> tuple[TriangulatedBody, ...]:
        """Displacement and stress on triangles that fill each body."""
        return tuple(map(triangulated_body, self.bodies, self._filled, range(len(self.bodies))))

    @cached_property
    def filled(self) -> TriangulatedBody:
        """Displacement and stress on triangles that fill all bodies; points on their boundaries come first."""
        if len(self.bodies) == 1:
            return self.triangulated[0]
        rims, counts = zip(*((len(body.element), len(body.points)) for body in self.triangulated), strict=True)
        first, inside = np.cumsum([0, *rims]), np.cumsum([sum(rims), *np.subtract(counts, rims)])
        new: list[IntArray] = [
            np.append(first[i] + np.arange(rims[i]), inside[i] + np.arange(counts[i] - rims[i]))
            for i in range(len(counts))
        ]
        order = np.argsort(np.concatenate(new))
        elements = np.cumsum([0, *(len(body.field.mesh.elements) for body in self.bodies)])
        stress = [body.stress for body in self.triangulated]
        return TriangulatedBody(
            points=np.concatenate([body.points for body in self.triangulated])[order],
            triangles=np.concatenate([new[i][body.triangles] for i, body in enumerate(self.triangulated)]),
            displacement=np.concatenate([body.displacement for body in self.triangulated])[order],
            stress=Stress(
                points=np.concatenate([item.points for item in stress])[order],
                components=np.concatenate([item.components for item in stress])[order],
                zz=np.concatenate([item.zz for item in stress])[order],
                kind=np.concatenate([item.kind for item in stress])[order],
            ),
            element=np.concatenate([elements[i] + body.element for i, body in enumerate(self.triangulated)]),
            body=np.concatenate([body.body for body in self.triangulated]),
        )

    @cached_property
    def largest(self) -> LargestStresses:
        """The largest stresses of all bodies."""
        each = [
            _with_name(body.name, largest_stresses(body, whole, pressed))
            for body, whole, pressed in zip(self.bodies, self._filled, self.pressed, strict=True)
        ]
        zones = list(dict.fromkeys(zone for item in each for zone in item.shear))
        shear = {zone: _largest([item.shear.get(zone) for item in each]) for zone in zones}
        inside, boundary = _largest([item.inside for item in each]), _largest([item.boundary for item in each])
        found = {SHEAR_BELOW.format(zone): peak for zone, peak in shear.items()}
        found |= {INSIDE: inside, ON_BOUNDARY: boundary}
        return LargestStresses(
            shear=shear,
            inside=inside,
            boundary=boundary,
            singular=_distinct(
                np.concatenate([item.singular for item in each]), SAME_PLACE * self.bodies[0].field.mesh.size
            ),
            missing={label: why for item in each for label, why in item.missing.items() if found[label] is None},
        )


def numbers_of(names: Sequence[str], name: str | None) -> list[int]:
    """Numbers of the elastic bodies of a name, or of all; `ProblemError` if there is none of this name."""
    numbers = [i for i, own in enumerate(names) if name in (None, own)]
    if not numbers:
        raise ProblemError(unknown_word("elastic body", str(name), [own for own in names if own]))
    return numbers


def placed_in(fields: Sequence[StressField], points: object) -> list[Located]:
    """Where points (k, 2) are in each of some bodies; `ProblemError` if one is in none."""
    array = real_array(points, "points", (None, 2))
    placed = [field.locate(array) for field in fields]
    nowhere = np.all([at.outside for at in placed], axis=0)
    if nowhere.any():
        nearest = int(np.argmin([at.distance[np.argmax(nowhere)] for at in placed]))
        ensure_in_body(fields[nearest], placed[nearest]._replace(outside=nowhere), len(fields))
    return placed


def owners(placed: Sequence[Located]) -> IntArray:
    """Number (k,) of the first body that has each point, inside rather than on its boundary."""
    inside, outside = (np.stack([getattr(at, name) for at in placed]) for name in ("inside", "outside"))
    return np.where(inside.any(axis=0), inside.argmax(axis=0), (~outside).argmax(axis=0))


def _on_both_sides(
    mesh: Mesh, zones: Sequence[str], pressed: BoolArray, infinite: Sequence[Pair]
) -> tuple[BoolArray, Array]:
    """Elements (zones, m) that touch, those of the second bodies included, and infinite pressures on both sides."""
    touching, places = pressed.copy(), [np.reshape(np.array(infinite, float), (-1, 2))]
    for name, facing in mesh.facing.items():
        own = np.flatnonzero(facing >= 0)
        if name in zones:
            zone = zones.index(name)
            touching[zone, facing[own[pressed[zone, own]]]] = True
        for local in (0, 2):
            at = mesh.nodes[mesh.elements[own, local]]
            away = magnitudes(at[:, None] - places[0])
            near = (away <= SAME_PLACE * mesh.size).any(axis=1)
            places.append(mesh.nodes[mesh.elements[facing[own[near]], 2 - local]])
    return touching, np.concatenate(places)


def _largest(peaks: Sequence[StressPeak | None]) -> StressPeak | None:
    """The largest of some stresses; None if there is none."""
    return max((peak for peak in peaks if peak is not None), key=lambda peak: peak.value, default=None)


def _distinct(places: Array, same: float) -> Array:
    """Places (k, 2) [L] without those that are the same as one before: of bodies that touch there."""
    away = np.hypot(*np.moveaxis(places[:, None] - places, 2, 0))
    return places[~np.tril(away <= same, -1).any(axis=1)]


def _with_name(body: str, largest: LargestStresses) -> LargestStresses:
    """The largest stresses of a body, with its name."""

    def named(peak: StressPeak | None) -> StressPeak | None:
        return None if peak is None else replace(peak, body=body)

    return replace(
        largest,
        shear={zone: named(peak) for zone, peak in largest.shear.items()},
        inside=named(largest.inside),
        boundary=named(largest.boundary),
    )


SAME_PLACE = 1e-9
"""Distance of a node from a place over the size of the bodies up to which it is there."""
