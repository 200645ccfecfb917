"""Places on the curves of the edges themselves, by the local coordinates of the elements on them."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, IntArray
from bemcontact.bem.mesh import Mesh, build
from bemcontact.problem.curves import Edge
from bemcontact.problem.nearest_places import nearest_places, surface_corners
from bemcontact.problem.problem import Problem
from bemcontact.problem.rigid_surface import Circle, Plane, RigidSurface
from bemcontact.problem.surface_lines import Polyline, Spline

SAMPLES = np.linspace(-1.0, 1.0, 17)
"""Local coordinates at which the boundary is compared with a surface; some are moved, see `Outline.local`."""
NODES = [0, len(SAMPLES) // 2, -1]
"""Which of them are nodes."""


class Places(NamedTuple):
    """Places (k, q, 2) [L] on elements, with unit normals (k, q, 2) into the body."""

    points: Array
    inward: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Outline:
    """The curves of the edges under the elements of a mesh; the places of samples are computed once."""

    problem: Problem
    samples: dict[int, tuple[Array, Array]] = field(default_factory=dict)

    @cached_property
    def mesh(self) -> Mesh:
        """The elements."""
        return build(self.problem)

    @cached_property
    def _elements(self) -> tuple[IntArray, Array]:
        """Number (m,) of the edge of each element, and the fractions (m, 2) of the edge at its ends."""
        ends = [edge.breakpoints(self.problem.mesh.refine) for edge in self.problem.boundary.edges]
        number = np.repeat(np.arange(len(ends)), [len(item) - 1 for item in ends])
        return number, np.concatenate([np.column_stack([item[:-1], item[1:]]) for item in ends])

    @cached_property
    def local(self) -> Array:
        """Local coordinates (m, 17) of the samples of each element.

        They are `SAMPLES`, but where the boundary is nearest to a surface the next one is moved there: what is
        narrower than an element would be between them.
        """
        of_edge, fractions = self._elements
        local, free = np.tile(SAMPLES, (len(of_edge), 1)), np.ones((len(of_edge), len(SAMPLES)), bool)
        free[:, NODES] = False
        for number, edge in enumerate(self.problem.boundary.edges):
            own = np.flatnonzero(of_edge == number)
            for name, zone in self.problem.contact_zones.items():
                for place in _narrow_places(edge, zone.surface, paired=edge.name in self.problem.edges_of(name)):
                    element = own[min(int(np.searchsorted(fractions[own, 1], place)), len(own) - 1)]
                    first, last = fractions[element]
                    xi = 2 * (place - first) / (last - first) - 1
                    away = np.where(free[element] & (SAMPLES * xi > 0), np.abs(SAMPLES - xi), np.inf)
                    if away.min() < 2 * SAMPLES[-1] / NODES[1]:
                        local[element, away.argmin()], free[element, away.argmin()] = xi, False
        return np.sort(local, axis=1)

    def places(self, elements: IntArray, xi: Array) -> Places:
        """Places at the local coordinates ξ (k, q) of elements (k,)."""
        of_edge, fractions = self._elements
        points, inward = np.empty((*xi.shape, 2)), np.empty((*xi.shape, 2))
        first, last = fractions[elements].T[..., None]
        along = first + (last - first) * (1 + xi) / 2
        for number in np.unique(of_edge[elements]):
            edge, on = self.problem.boundary.edges[number], of_edge[elements] == number
            flat = along[on].ravel()
            points[on] = edge.points(flat).reshape(-1, xi.shape[1], 2)
            inward[on] = -edge.normals(flat).reshape(-1, xi.shape[1], 2)
        return Places(points, inward)

    def sampled(self, elements: IntArray) -> Places:
        """Places at the samples of elements (k,)."""
        if not len(elements):
            return Places(*np.zeros((2, 0, len(SAMPLES), 2)))
        missing = np.array([i for i in elements.tolist() if i not in self.samples], int)
        if len(missing):
            new = self.places(missing, self.local[missing])
            self.samples.update(zip(missing.tolist(), zip(*new, strict=True), strict=True))
        points, inward = zip(*(self.samples[i] for i in elements.tolist()), strict=True)
        return Places(np.array(points), np.array(inward))


def _narrow_places(edge: Edge, surface: RigidSurface, *, paired: bool) -> Iterable[float]:
    """Fractions of an edge where a surface may be narrow: where it is nearest, or has a corner.

    A spline, for which this takes long, is looked at from the edges alone that are `paired` with it.
    """
    if isinstance(surface, Polyline):
        return (corner.fraction for corner in surface_corners(edge, surface))
    if isinstance(surface, Circle | Plane) or (paired and isinstance(surface, Spline)):
        return nearest_places(edge.curve, surface)
    return ()
