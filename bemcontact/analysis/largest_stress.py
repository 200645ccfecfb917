"""The largest stresses of a body, looked for and not sampled: below each contact, inside, and along its edges.

Starts are points that fill the body, and lie as close as the boundary elements there. From those that are larger than
their neighbors, a search with smaller and smaller steps goes up to a maximum. A maximum inside has lower stress all
around, up to nearly the boundary. On lines of symmetry the body goes on in its mirror image.

A maximum is below a contact if it lies at most 45 degrees beside it: near the ends of a contact it often does.
"""

from collections.abc import Callable, Collection
from typing import NamedTuple, Self

import numpy as np
from scipy.spatial import KDTree

from bemcontact.analysis.body_stress import BodyStress
from bemcontact.analysis.triangulated_body import FilledBody
from bemcontact.arrays import Array, BoolArray, IntArray, magnitudes
from bemcontact.bem import reference_element
from bemcontact.contact.stress import (
    INSIDE,
    ON_BOUNDARY,
    SHEAR_BELOW,
    LargestStresses,
    NoPeak,
    Stress,
    StressPeak,
)
from bemcontact.frozen import frozen

SEARCHES, AGAIN = 8, 0.7
"""Searches at a time, and the part of a maximum from which on other starts may lead to a larger one."""
RISE, TOLD_APART = 1.0, 1e-4
"""Most that a search gains over what its start is above its lowest neighbor, and the relative gain that no error bar
tells from none. The top of a parabola is above the highest of evenly spaced samples by at most a quarter of this."""
STEP, SETTLED, SHORTER, MOST_STEPS = 0.2, 1e-2, 0.3, 30
"""First step over the depth of the start, the last one over the first, their ratio, and the most steps."""
MEET = 0.5
"""Distance of two searches over their shorter step below which they meet."""
SAMPLES = 65
"""Places on an element from which the depth of a point is measured first."""
BESIDE_LINE = 1e-7
"""Least distance from a line of symmetry over the size of the body."""
BESIDE, BESIDE_AT_START = 2**0.5, 1.7
"""Distance from contact over that from the boundary up to which a maximum is below it, and a start."""
SHALLOW, GRAZING = 0.2, 0.05
"""Depth over the length of the element there up to which a maximum is one of the boundary, and a search ends."""
AROUND = np.array([[x, y] for x in (0, -1, 1) for y in (0, -1, 1)], float)
"""A point and those around it, in steps."""
SHIFTED = np.array([[
    next((i for i, place in enumerate(AROUND.tolist()) if place == (moved + other).tolist()), -1) for other in AROUND
] for moved in AROUND])  # fmt: skip
"""Number that a point around the next place has around the last one, from where the search moved there; or -1."""
LEVEL = 1e-9
"""Relative difference of stresses that is round-off."""
RINGS = np.outer([0.5, 0.9], np.exp(2j * np.pi * np.arange(16) / 16)).ravel().view(float).reshape(-1, 2)
"""Points around a maximum, over its depth, at which stress must be lower; beside an infinite stress it is not."""


Measure = Callable[[Stress], Array]


def largest_stresses(body: BodyStress, whole: FilledBody, pressed: BoolArray) -> LargestStresses:
    """Look for the largest stresses; `pressed` (zones, m) are the elements that touch in each zone."""
    problem, mesh = body.field.problem, body.field.mesh
    mirrors = np.zeros(len(mesh.elements), bool)
    for line in body.field.lines:
        mirrors |= line.elements
    missing: dict[str, NoPeak] = {}
    samples = _Samples.of(body, whole)
    if not np.nan_to_num(samples.stress.von_mises).any():
        return _without_stress(problem.zones)

    def inside(label: str, below: BoolArray, surface: BoolArray, measure: Measure) -> StressPeak | None:
        search = _Search(body=body, samples=samples, mirrors=mirrors, below=np.flatnonzero(below), measure=measure)
        peak, why = search.largest(np.flatnonzero(surface))
        missing.update({label: why} if why is not None else {})
        return peak

    zones = {}
    for zone, touching in zip(problem.zones, pressed, strict=True):
        sides = {*problem.edges_of(zone), *problem.opposite_edges(zone)}.intersection(mesh.edge_names)
        if not sides:
            continue
        own = np.isin(mesh.edge, [mesh.edge_names.index(edge) for edge in sides])
        zones[zone] = inside(SHEAR_BELOW.format(zone), touching & own, own, lambda stress: stress.max_shear)
    within = inside(INSIDE, np.full(len(mesh.elements), True), ~mirrors, lambda stress: stress.von_mises)
    free = [mesh.edge_names[i] for i in np.unique(mesh.edge[~mirrors])]
    peaks = ((edge, body.edge_peak(edge, von_mises=True)) for edge in free)
    found = [StressPeak(value=peak.value, point=peak.point, depth=0.0, edge=edge) for edge, peak in peaks if peak]
    if not found:
        missing[ON_BOUNDARY] = NoPeak.TO_INFINITE
    return LargestStresses(
        shear=zones,
        inside=within,
        boundary=max(found, key=lambda peak: peak.value, default=None),
        singular=mesh.nodes[np.flatnonzero(body.singular)],
        missing=missing,
    )


def _without_stress(zones: Collection[str]) -> LargestStresses:
    """The largest stresses of a body that nothing loads: none, and none is infinite."""
    return LargestStresses(
        shear=dict.fromkeys(zones),
        inside=None,
        boundary=None,
        singular=np.zeros((0, 2)),
        missing={
            **dict.fromkeys(map(SHEAR_BELOW.format, zones), NoPeak.NO_CONTACT),
            **dict.fromkeys([INSIDE, ON_BOUNDARY], NoPeak.NO_STRESS),
        },
    )


class _Samples(NamedTuple):
    """Stress at points (k, 2) that fill the body, those on the boundary first.

    Parameters
    ----------
    points : (k, 2) [L]
    pairs : (e, 2) neighbors
    stress : at the points
    element : (b,) boundary element of each point on the boundary
    """

    points: Array
    pairs: IntArray
    stress: Stress
    element: IntArray

    @classmethod
    def of(cls, body: BodyStress, whole: FilledBody) -> Self:
        """The corners of triangles, and the middles of those that do not touch the boundary.

        A maximum that is hardly higher than a ridge beside it may lie between corners that fall towards the ridge.
        """
        inner = whole.triangles[(whole.triangles >= len(whole.element)).all(axis=1)]
        middles = body.stress(whole.at.points[inner].mean(axis=1))
        number = len(whole.at.points) + np.arange(len(inner))
        sides = [whole.triangles[:, [i, j]] for i, j in ((0, 1), (1, 2), (2, 0))]
        both = whole.stress, middles
        stress = Stress(
            points=np.vstack([part.points for part in both]),
            components=np.vstack([part.components for part in both]),
            zz=np.concatenate([part.zz for part in both]),
            kind=np.concatenate([part.kind for part in both]),
        )
        return cls(
            points=stress.points,
            pairs=np.vstack([*sides, *(np.column_stack([number, inner[:, i]]) for i in range(3))]),
            stress=stress,
            element=whole.element,
        )


class _Ends(NamedTuple):
    """Ends (k, 2) of searches, the values (k,) there, and whether all around is inside the body (k,)."""

    points: Array
    values: Array
    inside: BoolArray


@frozen
class _Search:
    """A search for the largest maximum of a stress inside a body.

    Parameters
    ----------
    body : BodyStress
    samples : stress at points that fill the body
    mirrors : (m,) whether an element is on a line of symmetry
    below : elements below which the maximum is
    measure : the stress
    """

    body: BodyStress
    samples: _Samples
    mirrors: BoolArray
    below: IntArray
    measure: Measure

    def largest(self, surface: IntArray) -> tuple[StressPeak | None, NoPeak | None]:
        """The largest maximum with its depth below the elements of a surface, or why there is none."""
        if not len(self.below):
            return None, NoPeak.NO_CONTACT
        start, depth, values, reach = self._starts()
        peak: StressPeak | None = None
        highest: _Ends | None = None
        left = np.arange(len(start))
        while len(left):
            some, left = left[:SEARCHES], left[SEARCHES:]
            ends = self._climb(start[some], STEP * depth[some])
            peak = self._highest(ends, surface, peak)
            if highest is None or ends.values.max() > highest.values.max():
                highest = ends
            if peak is not None:
                larger = (values >= AGAIN * peak.value) & (reach > (1 + TOLD_APART) * peak.value)
                left = left[larger[left]]
        return peak, None if peak is not None else self._why(highest)

    def _highest(self, ends: _Ends, surface: IntArray, peak: StressPeak | None) -> StressPeak | None:
        """The largest of a peak and of those ends of searches that are maxima inside."""
        every, least = np.flatnonzero(~self.mirrors), 0.0 if peak is None else peak.value
        for i in np.argsort(-ends.values):
            point, value = ends.points[i], float(ends.values[i])
            if value <= least:
                break
            depth, element = self._distance(point, every)
            shallow = depth <= SHALLOW * self.body.field.mesh.lengths[every[element]]
            if not ends.inside[i] or shallow or self._distance(point, self.below)[0] > BESIDE * depth:
                continue
            if self._beside_infinite(point):  # the mesh makes maxima there
                continue
            if (self._values(point + depth * RINGS) < (1 - LEVEL) * value).all():
                x, y = point.tolist()
                return StressPeak(value=value, point=(x, y), depth=self._distance(point, surface)[0])
        return peak

    def _why(self, ends: _Ends | None) -> NoPeak:
        """Why no search has ended at a maximum, from where the highest has."""
        if ends is None:
            return NoPeak.TO_BOUNDARY
        beside = self._beside_infinite(ends.points[np.argmax(ends.values)])
        return NoPeak.TO_INFINITE if beside else NoPeak.TO_BOUNDARY

    def _beside_infinite(self, point: Array) -> bool:
        """Whether a point is nearer to an infinite stress than the elements there are long."""
        mesh, singular = self.body.field.mesh, np.flatnonzero(self.body.singular)
        beside = np.maximum(mesh.lengths[singular], mesh.lengths[mesh.before[singular]])
        return bool((np.hypot(*(mesh.nodes[singular] - point).T) <= beside).any())

    def _starts(self) -> tuple[Array, Array, Array, Array]:
        """Points (k, 2) that are larger than their neighbors, the largest first, their depths and values (k,).

        The last array has the values (k,) that a search from there can reach. In a field that is nearly uniform many
        points are larger than their neighbors, by so little that few of them can lead to the largest maximum. There are
        none where stress is the same all over but for round-off.
        """
        points, pairs, stress, element = self.samples
        outer = np.append(~self.mirrors[element], np.zeros(len(points) - len(element), bool))
        values = np.nan_to_num(self.measure(stress), nan=-np.inf)
        if values[np.isfinite(values)].min(initial=np.inf) >= (1 - LEVEL) * values.max():
            return np.zeros((0, 2)), np.zeros(0), np.zeros(0), np.zeros(0)
        lowest = values.copy()
        values = np.where(outer, -np.inf, values)
        around = np.full(len(values), -np.inf)
        for one, other in (pairs.T, pairs[:, ::-1].T):
            np.maximum.at(around, one, values[other])
            np.minimum.at(lowest, one, np.where(np.isfinite(lowest[other]), lowest[other], np.inf))
        mesh, on = self.body.field.mesh, points[: len(element)]
        own = np.vstack([on[np.isin(element, self.below)], mesh.nodes[mesh.elements[self.below, 2]]])
        depth, away = (KDTree(places).query(points)[0] for places in (on[~self.mirrors[element]], own))
        start = np.flatnonzero(
            (away <= BESIDE_AT_START * depth) & (values >= around) & np.isfinite(values) & (depth > 0)
        )
        start = start[np.argsort(-values[start])]
        reach = values[start] + RISE * (values[start] - lowest[start])
        return points[start], depth[start], values[start], reach

    def _climb(self, points: Array, step: Array) -> _Ends:
        """Go up from points (k, 2) with first steps (k,).

        At a point that is larger than those around it, the parabola through them gives the next one. Of searches that
        meet, only the highest one goes on; the value of the others is minus infinity. One that has come to the boundary
        ends there: a maximum so shallow is one of the boundary.
        """
        points, step, least = points.copy(), step.copy(), SETTLED * step
        value, inside = np.zeros(len(points)), np.zeros(len(points), bool)
        live, known = np.arange(len(points)), np.full((len(points), len(AROUND)), np.nan)
        for _ in range(MOST_STEPS):
            around, values = points[live, None] + step[live, None, None] * AROUND, known[live]
            new = np.isnan(values)
            values[new] = self._values(around[new])
            best, rows = values.argmax(axis=1), np.arange(len(live))
            points[live], value[live] = around[rows, best], values[rows, best]
            inside[live] = (best == 0) & np.isfinite(values).all(axis=1)
            at_top = (best == 0) & (step[live] <= least[live])
            top = np.flatnonzero(inside[live])
            further = points[live[top]] + step[live[top], None] * _parabola(values[top])
            gained = self._values(further)
            better = gained > value[live[top]]
            points[live[top[better]]], value[live[top[better]]] = further[better], gained[better]
            seen = (SHIFTED[best] >= 0) & (best > 0)[:, None]
            known[live] = np.where(seen, np.take_along_axis(values, SHIFTED[best], axis=1), np.nan)
            known[live, 0] = value[live]
            step[live] = np.where(best == 0, np.maximum(step[live] * SHORTER, least[live]), step[live])
            met = _met(points, value, step)
            value[met] = -np.inf
            grazes = self._grazes(points[live])
            inside[live[grazes]] = False
            live = live[~at_top & ~grazes & ~met[live]]
            if not len(live):
                break
        return _Ends(self._mirrored(points), value, inside)

    def _grazes(self, points: Array) -> BoolArray:
        """Which points (k, 2) have come to the boundary, but for lines of symmetry."""
        at = self.body.field.locate(self._mirrored(points))
        return (at.distance <= GRAZING * self.body.field.mesh.lengths[at.element]) & ~self.mirrors[at.element]

    def _values(self, points: Array) -> Array:
        """Values (k,) at points (k, 2) inside the body or its mirror images; minus infinity outside."""
        at = self.body.field.locate(self._mirrored(points))
        there = at.inside | (~at.outside & self.mirrors[at.element])
        return np.where(there, np.nan_to_num(self.measure(self.body.at(at)), nan=-np.inf), -np.inf)

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
        away = magnitudes(reference_element.values(xi) @ mesh.nodes[mesh.elements[elements]] - point)
        number, sample = np.unravel_index(away.argmin(), away.shape)
        near = np.linspace(
            max(-1.0, xi[sample - 1] if sample else -1.0), min(1.0, xi[sample] + 2 / (SAMPLES - 1)), SAMPLES
        )
        places = reference_element.values(near) @ mesh.nodes[mesh.elements[elements[number]]]
        return float(np.hypot(*(places - point).T).min()), int(number)


def _met(points: Array, value: Array, step: Array) -> BoolArray:
    """Which of the searches at points (k, 2) are nearer to a higher one than both step."""
    away = np.hypot(*(points[:, None] - points).transpose(2, 0, 1))
    order = np.argsort(np.argsort(-value, kind="stable"))
    return ((away < MEET * np.minimum(step[:, None], step)) & (order < order[:, None])).any(axis=1)


def _parabola(values: Array) -> Array:
    """The place (k, 2), in steps, of the maximum of a parabola near values (k, 9) at `AROUND`, at most one away."""
    fitted = np.linalg.pinv(np.column_stack([np.ones(9), AROUND, AROUND**2 / 2, AROUND.prod(axis=1)])) @ values.T
    _, gx, gy, xx, yy, xy = fitted
    curvature = np.stack([np.stack([xx, xy], axis=1), np.stack([xy, yy], axis=1)], axis=1)
    falls = (xx < 0) & (xx * yy > xy * xy)
    curvature[~falls] = -np.eye(2)
    place = np.linalg.solve(curvature, -np.stack([gx, gy], axis=1)[..., None])[..., 0]
    return np.where(falls[:, None], np.clip(place, -1, 1), 0.0)
