"""The largest stresses of a body, looked for and not sampled: below each contact, inside, and along its edges.

Starts are points that fill the body, and lie as close as the boundary elements there. From those that are larger than
their neighbors, a search with smaller and smaller steps goes up to a maximum. A maximum inside has lower stress all
around. On lines of symmetry the body goes on in its mirror image.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from bemcontact.analysis.body_stress import BodyStress
from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.bem import reference_element
from bemcontact.contact.stress import LargestStresses, Stress, StressPeak, TriangulatedBody

RISE, SEARCHES = 0.3, 24
"""Part of the largest stress at a point from which on a search begins at others, and the searches at a time."""
STEP, SETTLED, SHORTER, MOST_STEPS = 0.2, 1e-2, 0.3, 30
"""First step over the depth of the start, the last one over the first, their ratio, and the most steps."""
SAMPLES = 65
"""Places on an element from which the depth of a point is measured first."""
ALIKE = 1e-9
"""Relative difference of distances that is round-off."""
BESIDE_LINE = 1e-7
"""Least distance from a line of symmetry over the size of the body."""
SHALLOW = 0.2
"""Depth over the length of the element there up to which a maximum is one of the boundary."""
AROUND = np.array([[x, y] for x in (0, -1, 1) for y in (0, -1, 1)], float)
"""A point and those around it, in steps."""
RINGS = np.outer([0.5, 0.9], np.exp(2j * np.pi * np.arange(16) / 16)).ravel().view(float).reshape(-1, 2)
"""Points around a maximum, over its depth, at which stress must be lower; beside an infinite stress it is not."""


Measure = Callable[[Stress], Array]


def largest_stresses(body: BodyStress, whole: TriangulatedBody, pressed: BoolArray) -> LargestStresses:
    """Look for the largest stresses; `pressed` (m,) are the elements that touch."""
    problem, mesh = body.field.problem, body.field.mesh
    mirrors = np.zeros(len(mesh.elements), bool)
    for line in body.field.lines:
        mirrors |= line.elements
    search = _Search(body=body, whole=whole, mirrors=mirrors)
    zones = {}
    for zone in problem.zones:
        sides = (*problem.edges_of(zone), *problem.opposite_edges(zone))
        edges = [mesh.edge_names.index(edge) for edge in sides if edge in mesh.edge_names]
        if not edges:
            continue
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
    """A search for maxima of stress inside a body.

    Parameters
    ----------
    body : BodyStress
    whole : stress at points that fill the body
    mirrors : (m,) whether an element is on a line of symmetry
    """

    body: BodyStress
    whole: TriangulatedBody
    mirrors: BoolArray

    def largest(self, elements: IntArray, measure: Measure, surface: IntArray) -> StressPeak | None:
        """The largest maximum inside that is found from points below some elements, with its depth below others."""
        start, depth = self._starts(elements, measure)
        for first in range(0, len(start), SEARCHES):
            some = slice(first, first + SEARCHES)
            peak = self._highest(*self._climb(start[some], STEP * depth[some], measure), measure, surface)
            if peak is not None:
                return peak
        return None

    def _highest(
        self, at: Array, value: Array, inside: BoolArray, measure: Measure, surface: IntArray
    ) -> StressPeak | None:
        """The largest of the ends of searches that is a maximum inside; the first three are of `_climb`."""
        every = np.flatnonzero(~self.mirrors)
        for i in np.argsort(-np.where(inside, value, -np.inf))[: int(inside.sum())]:
            depth, element = self._distance(at[i], every)
            ring = self._values(at[i] + depth * RINGS, measure)
            if depth > SHALLOW * self.body.field.mesh.lengths[every[element]] and (ring < value[i]).all():
                x, y = at[i].tolist()
                return StressPeak(value=float(value[i]), point=(x, y), depth=self._distance(at[i], surface)[0])
        return None

    def _starts(self, elements: IntArray, measure: Measure) -> tuple[Array, Array]:
        """Points (k, 2) below some elements that are larger than their neighbors, and their depths (k,).

        The largest is the first. A point as near to another element too is below both.
        """
        whole, rim, mesh = self.whole, len(self.whole.element), self.body.field.mesh
        outer = np.append(~self.mirrors[whole.element], np.zeros(len(whole.points) - rim, bool))
        values = np.where(outer, -np.inf, np.nan_to_num(measure(whole.stress), nan=-np.inf))
        around = np.full(len(values), -np.inf)
        for one, other in ((0, 1), (1, 2), (2, 0)):
            ends = whole.triangles[:, one], whole.triangles[:, other]
            np.maximum.at(around, ends[0], values[ends[1]])
            np.maximum.at(around, ends[1], values[ends[0]])
        sides = np.flatnonzero(~self.mirrors[whole.element])
        own = np.vstack([whole.points[:rim][np.isin(whole.element, elements)], mesh.nodes[mesh.elements[elements, 2]]])
        depth, away = (KDTree(points).query(whole.points)[0] for points in (whole.points[sides], own))
        below = away <= (1 + ALIKE) * depth
        start = np.flatnonzero(below & (values >= around) & np.isfinite(values) & (depth > 0))
        start = start[values[start] > RISE * values[start].max(initial=0.0)]
        start = start[np.argsort(-values[start])]
        return whole.points[start], depth[start]

    def _climb(self, points: Array, step: Array, measure: Measure) -> tuple[Array, Array, BoolArray]:
        """Go up from points (k, 2); the last ones, their values (k,), and whether all around is inside the body.

        At a point that is larger than those around it, the parabola through them gives the next one.
        """
        least, rows = SETTLED * step, np.arange(len(points))
        value, inside = np.zeros(len(points)), np.zeros(len(points), bool)
        for _ in range(MOST_STEPS):
            around = points[:, None] + step[:, None, None] * AROUND
            values = self._values(around.reshape(-1, 2), measure).reshape(len(points), -1)
            best = values.argmax(axis=1)
            points, value = around[rows, best], values[rows, best]
            inside = (best == 0) & np.isfinite(values).all(axis=1)
            if ((step <= least) & (best == 0)).all():
                break
            top = np.flatnonzero(inside)
            further = points[top] + step[top, None] * _parabola(values[top])
            gained = self._values(further, measure)
            better = gained > value[top]
            points[top[better]], value[top[better]] = further[better], gained[better]
            step = np.where(best == 0, np.maximum(step * SHORTER, least), step)
        return self._mirrored(points), value, inside

    def _values(self, points: Array, measure: Measure) -> Array:
        """Values (k,) at points (k, 2) inside the body or its mirror images; minus infinity outside."""
        at = self.body.field.locate(self._mirrored(points))
        there = at.inside | (~at.outside & self.mirrors[at.element])
        return np.where(there, np.nan_to_num(measure(self.body.at(at)), nan=-np.inf), -np.inf)

    def _mirrored(self, points: Array) -> Array:
        """Points (k, 2), those beyond lines of symmetry in their mirror image, and none on such a line.

        The stress on a boundary has other errors than that inside, which would draw the search there.
        """
        result, beside = points.copy(), BESIDE_LINE * self.body.field.mesh.size
        for line in self.body.field.lines:
            away = line.beyond(result)
            result[:, line.axis] -= line.outward * (away + np.maximum(np.abs(away), beside))
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


def _parabola(values: Array) -> Array:
    """The place (k, 2), in steps, of the maximum of a parabola near values (k, 9) at `AROUND`, at most one away."""
    fitted = np.linalg.pinv(np.column_stack([np.ones(9), AROUND, AROUND**2 / 2, AROUND.prod(axis=1)])) @ values.T
    _, gx, gy, xx, yy, xy = fitted
    curvature = np.stack([np.stack([xx, xy], axis=1), np.stack([xy, yy], axis=1)], axis=1)
    falls = (xx < 0) & (xx * yy > xy * xy)
    curvature[~falls] = -np.eye(2)
    place = np.linalg.solve(curvature, -np.stack([gx, gy], axis=1)[..., None])[..., 0]
    return np.where(falls[:, None], np.clip(place, -1, 1), 0.0)
