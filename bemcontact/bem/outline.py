"""Places on the curves of the edges themselves, by the local coordinates of the elements on them."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, IntArray
from bemcontact.bem.mesh import Mesh, build
from bemcontact.problem.problem import Problem

SAMPLES = np.linspace(-1.0, 1.0, 17)
"""Local coordinates at which the boundary is compared with a surface."""


class Places(NamedTuple):
    """Places (k, q, 2) [L] on elements, with unit normals (k, q, 2) into the body."""

    points: Array
    inward: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Outline:
    """The curves of the edges under the elements of a mesh; places at `SAMPLES` are computed once."""

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
        """Places at `SAMPLES` of elements (k,)."""
        if not len(elements):
            return Places(*np.zeros((2, 0, len(SAMPLES), 2)))
        missing = np.array([i for i in elements.tolist() if i not in self.samples], int)
        if len(missing):
            new = self.places(missing, np.tile(SAMPLES, (len(missing), 1)))
            self.samples.update(zip(missing.tolist(), zip(*new, strict=True), strict=True))
        points, inward = zip(*(self.samples[i] for i in elements.tolist()), strict=True)
        return Places(np.array(points), np.array(inward))
