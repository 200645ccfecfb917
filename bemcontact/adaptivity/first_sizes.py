"""Element sizes from the geometry alone: curvature, edges, corners, thickness, and where the surface comes near."""

from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise
from math import pi

import numpy as np

from bemcontact.adaptivity.sizes import Limit, Loop
from bemcontact.arrays import Array, BoolArray
from bemcontact.bem.mesh import CORNER
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen
from bemcontact.problems.body_surface import AnyShape, BodySurface
from bemcontact.problems.curves import Edge
from bemcontact.problems.nearest_places import gaps, nearest_places, surface_corners
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import DeflectedContour

TURN = pi / 6
"""Angle [rad] by which an element may turn."""
PART = 0.5
"""Largest element over its edge."""
WALL = 1 / 3
"""Largest element over the thickness of a wall that is in contact on both of its sides.

Contact on one side shows in the pressure on the other one as a bump that is about as wide as the wall.
"""
OPPOSED = -0.3
"""Cosine of the angle between two outward normals below which two parts of the boundary face each other."""
ACROSS = 0.5
"""Cosine of the largest angle to the inward normal under which a part of the boundary faces another one."""
SAMPLES = 800
"""Samples of the whole boundary."""
MOST_HALVINGS = 40
"""Halvings of the part of an edge with its sharpest bend, in the search for how sharp it is."""
LEAST_SAMPLES = 24
"""Samples of an edge."""
IN_CACHE = 32
"""Samples that are compared with all others at once."""
FLAT = 1e-4
"""Step over the length of an edge by which the curvature of the gap is measured."""
NARROW = 0.01
"""Least element over its edge where a surface comes near."""
AT_CORNER = 0.1
"""Element at a corner of the rigid surface over its edge."""
KEPT = 4
"""Outlines that are kept for other problems with the same one."""


@frozen
class SizedOutline:
    """All loops of all bodies, sampled, with the thickness of the body at each sample.

    Parameters
    ----------
    loops : of the bodies
    bodies : number of the body of each loop
    touching : names of the edges that may be in contact
    """

    loops: tuple[Loop, ...]
    bodies: tuple[int, ...]
    touching: frozenset[str]

    @cached_property
    def _samples(self) -> list[tuple[int, Edge, Array]]:
        """Number of the loop, edge, and fractions of its samples."""
        total = sum(loop.length for loop in self.loops)
        return [
            (number, edge, (np.arange(count) + 0.5) / count)
            for number, loop in enumerate(self.loops)
            for edge in loop.edges
            for count in [max(LEAST_SAMPLES, round(SAMPLES * edge.length / total))]
        ]

    @cached_property
    def positions(self) -> tuple[Array, ...]:
        """Positions of the samples on each loop [L]."""
        return tuple(
            np.concatenate(
                [loop.start_of[edge.name] + at * edge.length for i, edge, at in self._samples if i == number]
            )
            for number, loop in enumerate(self.loops)
        )

    @property
    def thickness(self) -> tuple[Array, ...]:
        """Distance [L] from each sample through the body to the boundary that faces it; infinite without one."""
        return self._walls[0]

    @cached_property
    def _walls(self) -> tuple[tuple[Array, ...], tuple[BoolArray, ...]]:
        """Thickness at each sample, and whether both sides of this wall may be in contact."""
        x, y = np.vstack([edge.points(at) for _, edge, at in self._samples]).T
        normals = np.vstack([edge.normals(at) for _, edge, at in self._samples])
        body = np.repeat([self.bodies[number] for number, _, _ in self._samples], [len(at) for *_, at in self._samples])
        touching = np.repeat(
            [edge.name in self.touching for _, edge, _ in self._samples], [len(at) for *_, at in self._samples]
        )
        least, across = [], []
        for few in range(0, len(x), IN_CACHE):
            rows = slice(few, few + IN_CACHE)
            opposed = normals[rows] @ normals.T < OPPOSED
            there = np.append(np.flatnonzero(opposed.any(axis=0)), 0)
            right, up = x[rows, None] - x[there], y[rows, None] - y[there]
            inward = right * normals[rows, :1] + up * normals[rows, 1:]
            squared = right**2 + up**2
            faces = (inward > 0) & (inward**2 >= ACROSS**2 * squared) & opposed.take(there, axis=1)
            if len({*self.bodies}) > 1:
                faces &= body[rows, None] == body[there]
            np.putmask(squared, ~faces, np.inf)
            across.append(there[np.argmin(squared, axis=1)])
            least.append(np.sqrt(squared.min(axis=1)))
        both = touching & touching[np.concatenate(across)]
        joints = np.cumsum([len(own) for own in self.positions])[:-1]
        return tuple(np.split(np.concatenate(least), joints)), tuple(np.split(both, joints))

    def start_of(self, edge: str) -> tuple[int, float]:
        """Number of the loop that an edge of this name belongs to, and position of its start there [L]."""
        return next((i, loop.start_of[edge]) for i, loop in enumerate(self.loops) if edge in loop.start_of)

    def thickness_at(self, loop: int, position: float) -> float:
        """Thickness [L] at a position of a loop."""
        away = np.abs(self.positions[loop] - position % self.loops[loop].length)
        return float(self.thickness[loop][np.argmin(away)])

    @cached_property
    def limits(self) -> tuple[tuple[Limit, ...], ...]:
        """Limits of the element size along each loop that do not depend on what it touches."""
        return tuple(tuple(self._sizes(number)) for number in range(len(self.loops)))

    def _sizes(self, loop: int) -> Iterator[Limit]:
        """The limits along one loop."""
        own = self.loops[loop]
        for edge, start, stop in zip(own.edges, own.joints[:-1].tolist(), own.joints[1:].tolist(), strict=True):
            yield Limit(low=start, high=stop, size=PART * edge.length)
            yield from _curvature(edge, start)
        thickness, both = self._walls
        sizes, positions = np.where(both[loop], thickness[loop] * WALL, thickness[loop]), self.positions[loop]
        for position, size in np.column_stack([positions, sizes])[np.isfinite(sizes)].tolist():
            yield Limit(low=position, high=position, size=size)
        yield from _least_at_joints(own, positions, thickness[loop])


def sized_outline(problem: Problem) -> SizedOutline:
    """The boundary of a problem, whatever its elements are; problems that differ in loads and gaps share it."""
    loops = [(edges, number) for number, part in enumerate(problem.parts) for edges in part.loops]
    surfaces = [zone.surface for zone in problem.zones.values()]
    touching = {name for zone in problem.zones for name in problem.edges_of(zone)}
    touching |= {edge.name for surface in surfaces if isinstance(surface, BodySurface) for edge in surface.edges}
    return _outline(tuple(edges for edges, _ in loops), tuple(number for _, number in loops), frozenset(touching))


@lru_cache(maxsize=KEPT)
def _outline(loops: tuple[tuple[Edge, ...], ...], bodies: tuple[int, ...], touching: frozenset[str]) -> SizedOutline:
    """The outline of all loops, made once."""
    return SizedOutline(loops=tuple(Loop(edges=edges) for edges in loops), bodies=bodies, touching=touching)


def _curvature(edge: Edge, start: float) -> Iterator[Limit]:
    """Limits by which no element turns by more than `TURN`."""
    at = np.linspace(0, 1, LEAST_SAMPLES + 1)
    angle = edge.curve.tangent_angle(at)
    for _ in range(MOST_HALVINGS):
        bends = np.flatnonzero(np.abs(np.diff(angle)) > TURN)
        if not len(bends):
            break
        at = np.insert(at, bends + 1, (at[bends] + at[bends + 1]) / 2)
        angle = edge.curve.tangent_angle(at)
    for (low, high), turn in zip(pairwise(at.tolist()), np.abs(np.diff(angle)).tolist(), strict=True):
        if turn > 0:
            size = (high - low) * edge.length / turn * TURN
            yield Limit(low=start + low * edge.length, high=start + high * edge.length, size=size)


def _least_at_joints(loop: Loop, positions: Array, thickness: Array) -> Iterator[Limit]:
    """Half of the size at corners."""
    for before, after, position in zip((loop.edges[-1], *loop.edges), loop.edges, loop.joints.tolist(), strict=False):
        turn = after.curve.tangent_angle(np.zeros(1))[0] - before.curve.tangent_angle(np.ones(1))[0]
        if abs((turn + pi) % (2 * pi) - pi) > CORNER:
            away = np.abs(positions - position)
            nearest = np.argsort(np.minimum(away, loop.length - away))[:2]
            size = min(PART * before.length, PART * after.length, *thickness[nearest].tolist()) / 2
            yield Limit(low=position, high=position, size=float(size))


def surface_sizes(problem: Problem, outline: SizedOutline) -> tuple[dict[int, list[Limit]], dict[int, list[float]]]:
    """Limits of the size where surfaces come near, and places where elements must end, both by loop."""
    limits: dict[int, list[Limit]] = {}
    marks: dict[int, list[float]] = {}
    for name, zone in problem.zones.items():
        if isinstance(zone.surface, DeflectedContour):
            continue
        for number, loop in enumerate(outline.loops):
            for edge in loop.edges:
                if edge.name in problem.edges_of(name):
                    start = loop.start_of[edge.name]
                    limits.setdefault(number, []).extend(_near(edge, start, zone.surface))
                    for fraction, _ in surface_corners(edge, zone.surface):
                        place = start + fraction * edge.length
                        marks.setdefault(number, []).append(place)
                        limits[number].append(Limit(low=place, high=place, size=AT_CORNER * edge.length))
    return limits, marks


def _near(edge: Edge, start: float, surface: AnyShape) -> Iterator[Limit]:
    """Limits at each local least of the initial gap: half of the radius of the relative curvature."""
    middle, step = np.array(nearest_places(edge.curve, surface)), FLAT
    three = gaps(edge.curve, surface, middle[:, None] + step * np.array([-1.0, 0.0, 1.0]))
    curvature = (three[:, 0] - 2 * three[:, 1] + three[:, 2]) / (step * edge.length) ** 2
    for place, bend in zip(start + middle * edge.length, curvature, strict=True):
        if bend > 0:
            yield Limit(low=place, high=place, size=float(max(0.5 / bend, NARROW * edge.length)))
