"""The largest stresses of a body, looked for and not sampled: below each contact, inside, and along its edges.

Starts are points below the boundary, at depths that grow from a part of the element there to the size of the body. From
those that are larger than their neighbors, a search with smaller and smaller steps goes up to a maximum. A maximum
inside has lower stress all around. On lines of symmetry the body goes on in its mirror image.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bemcontact.analysis.body_stress import BodyStress
from bemcontact.analysis.stress import Stress
from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.bem import reference_element
from bemcontact.checks.attributes import PLACE, WithHints, Words

FIRST, GROWTH = 0.3, 1.35
"""Least depth of a start over the length of the element, and the ratio of two depths."""
SEARCHES = 24
"""Number of starts, those with the largest stress first."""
STEP, SETTLED, MOST_STEPS = 0.2, 1e-4, 60
"""First step over the depth of the start, the last one over the first, and the most steps."""
SAMPLES = 65
"""Places on an element from which the depth of a point is measured first."""
SHALLOW = 0.2
"""Depth over the length of the element there up to which a maximum is one of the boundary."""
AROUND = np.array([[x, y] for x in (0, -1, 1) for y in (0, -1, 1)], float)
"""A point and those around it, in steps."""
RINGS = np.outer([0.5, 0.9], np.exp(2j * np.pi * np.arange(16) / 16)).ravel().view(float).reshape(-1, 2)
"""Points around a maximum, over its depth, at which stress must be lower; beside an infinite stress it is not."""


@dataclass(frozen=True, kw_only=True, eq=False)
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


@dataclass(frozen=True, kw_only=True, eq=False)
class LargestStresses(WithHints):
    """The largest stresses of a body."""

    shear: dict[str, StressPeak | None]
    """Largest shear stress below the contact of each zone, at a maximum inside the body; None if there is none: without
    contact, or if it grows up to the boundary."""
    inside: StressPeak | None
    """Largest equivalent stress of von Mises at a maximum inside the body or on a line of symmetry; None if there is
    none."""
    boundary: StressPeak | None
    """Largest equivalent stress of von Mises along the edges, but for lines of symmetry, and for edges along which it
    grows up to an infinite one."""
    singular: Array
    """Places (s, 2) [L] where stress is infinite: the body has no largest stress if there are any."""


Measure = Callable[[Stress], Array]


def largest_stresses(body: BodyStress, pressed: BoolArray) -> LargestStresses:
    """Look for the largest stresses; `pressed` (m,) are the elements that touch."""
    search = _Search.of(body)
    problem, mesh = body.field.problem, body.field.mesh
    zones = {}
    for zone in problem.contact_zones:
        edges = [mesh.edge_names.index(edge) for edge in problem.edges_of(zone)]
        own = np.flatnonzero(pressed & np.isin(mesh.edge, edges))
        zones[zone] = search.largest(own, lambda stress: stress.max_shear, np.flatnonzero(np.isin(mesh.edge, edges)))
    every = np.arange(len(mesh.elements))
    free = [mesh.edge_names[i] for i in np.unique(mesh.edge[~search.mirrors])]
    peaks = ((edge, body.edge_peak(edge, von_mises=True)) for edge in free)
    found = [StressPeak(value=peak.value, point=peak.point, depth=0.0, edge=edge) for edge, peak in peaks if peak]
    return LargestStresses(
        shear=zones,
        inside=search.largest(every, lambda stress: stress.von_mises, np.flatnonzero(~search.mirrors)),
        boundary=max(found, key=lambda peak: peak.value, default=None),
        singular=mesh.nodes[np.flatnonzero(body.singular)],
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Search:
    """Starts below the boundary, and the stress there.

    Parameters
    ----------
    body : BodyStress
    mirrors : (m,) whether an element is on a line of symmetry
    length : (m,) of the elements [L]
    points, depth : (2m, d, 2), (2m, d) of the starts below the start and the middle of each element
    stress : at the starts one after the other; not a number outside the body
    """

    body: BodyStress
    mirrors: BoolArray
    length: Array
    points: Array
    depth: Array
    stress: Stress

    @classmethod
    def of(cls, body: BodyStress) -> "_Search":
        """Place the starts."""
        mesh = body.field.mesh
        length = mesh.lengths
        count = int(np.ceil(np.log(mesh.size / (FIRST * length.min())) / np.log(GROWTH)))
        depth = np.repeat(FIRST * length[:, None] * GROWTH ** np.arange(count), 2, axis=0)
        nodes, inward = mesh.nodes[mesh.elements[:, :2]].reshape(-1, 2), -mesh.normals[:, :2].reshape(-1, 2)
        points = nodes[:, None] + depth[..., None] * inward[:, None]
        stress = body.at(body.field.locate(points.reshape(-1, 2)))
        return cls(body=body, mirrors=_mirrors(body), length=length, points=points, depth=depth, stress=stress)

    def largest(self, elements: IntArray, measure: Measure, surface: IntArray) -> StressPeak | None:
        """The largest maximum inside that a search from below some elements finds, with its depth below others."""
        if not len(elements):
            return None
        values = np.nan_to_num(measure(self.stress), nan=-np.inf).reshape(self.depth.shape)
        line, level = np.nonzero(
            self._peaks(values) & np.repeat(np.isin(np.arange(len(values) // 2), elements), 2)[:, None]
        )
        order = np.argsort(-values[line, level])[:SEARCHES]
        if not len(order):
            return None
        points, step = self.points[line[order], level[order]], STEP * self.depth[line[order], level[order]]
        at, value, inside = self._climb(points, step, measure)
        every = np.flatnonzero(~self.mirrors)
        for i in np.argsort(-np.where(inside, value, -np.inf))[: int(inside.sum())]:
            depth, element = self._distance(at[i], every)
            ring = self._values(at[i] + depth * RINGS, measure)
            if depth > SHALLOW * self.length[every[element]] and (ring < value[i]).all():
                x, y = at[i].tolist()
                return StressPeak(value=float(value[i]), point=(x, y), depth=self._distance(at[i], surface)[0])
        return None

    def _peaks(self, values: Array) -> BoolArray:
        """Whether each start (2m, d) is not lower than those at the next depths and beside it along the boundary."""
        mesh = self.body.field.mesh
        m = len(mesh.elements)
        before = np.column_stack([2 * mesh.before + 1, 2 * np.arange(m)]).ravel()
        after = np.column_stack([2 * np.arange(m) + 1, 2 * mesh.elements[:, 2]]).ravel()
        low = np.full((len(values), 1), -np.inf)
        neighbors = values[before], values[after], np.hstack([low, values[:, :-1]]), np.hstack([values[:, 1:], low])
        return np.all([values >= other for other in neighbors], axis=0) & np.isfinite(values)

    def _climb(self, points: Array, step: Array, measure: Measure) -> tuple[Array, Array, BoolArray]:
        """Go up from points (k, 2); the last ones, their values (k,), and whether all around is inside the body."""
        least, rows = SETTLED * step, np.arange(len(points))
        value, inside = np.zeros(len(points)), np.zeros(len(points), bool)
        for _ in range(MOST_STEPS):
            around = points[:, None] + step[:, None, None] * AROUND
            values = self._values(around.reshape(-1, 2), measure).reshape(len(points), -1)
            best = values.argmax(axis=1)
            points, value = around[rows, best], values[rows, best]
            inside = (best == 0) & np.isfinite(values).all(axis=1)
            if (step <= least).all():
                break
            step = np.where(best == 0, np.maximum(step / 2, least), step)
        return self._mirrored(points), value, inside

    def _values(self, points: Array, measure: Measure) -> Array:
        """Values (k,) at points (k, 2) inside the body or its mirror images; minus infinity outside."""
        at = self.body.field.locate(self._mirrored(points))
        there = at.inside | (~at.outside & self.mirrors[at.element])
        return np.where(there, np.nan_to_num(measure(self.body.at(at)), nan=-np.inf), -np.inf)

    def _mirrored(self, points: Array) -> Array:
        """Points (k, 2), those beyond lines of symmetry in their mirror image."""
        mesh, result = self.body.field.mesh, points.copy()
        for edge in np.unique(mesh.edge[self.mirrors]):
            first = int(np.argmax(mesh.edge == edge))
            origin, normal = mesh.nodes[mesh.elements[first, 0]], mesh.normals[first, 1]
            result -= 2 * np.maximum((result - origin) @ normal, 0.0)[:, None] * normal
        return result

    def _distance(self, point: Array, elements: IntArray) -> tuple[float, int]:
        """Distance [L] of a point from the nearest of some elements, and its number among them."""
        mesh, xi = self.body.field.mesh, np.linspace(-1, 1, SAMPLES)
        away = np.hypot(*np.moveaxis(reference_element.values(xi) @ mesh.nodes[mesh.elements[elements]] - point, 2, 0))
        number, sample = np.unravel_index(away.argmin(), away.shape)
        near = np.linspace(
            max(-1.0, xi[sample - 1] if sample else -1.0), min(1.0, xi[sample] + 2 / (SAMPLES - 1)), SAMPLES
        )
        places = reference_element.values(near) @ mesh.nodes[mesh.elements[elements[number]]]
        return float(np.hypot(*(places - point).T).min()), int(number)


def _mirrors(body: BodyStress) -> BoolArray:
    """Whether each element (m,) is on a straight edge that is held across alone, as a line of symmetry is."""
    problem, mesh = body.field.problem, body.field.mesh
    result = np.zeros(len(mesh.elements), bool)
    for number, name in enumerate(mesh.edge_names):
        condition, own = problem.conditions.get(name), mesh.edge == number
        if condition is None or len(condition.displacement.given) != 1 or condition.traction.given:
            continue
        across = mesh.normals[own][..., "xy".index(condition.displacement.given[0])]
        result[own] = bool((abs(abs(across) - 1) < 1e-12).all())
    return result
