"""The boundary in quadratic elements."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bemcontact.arrays import Array, IntArray
from bemcontact.bem import reference_element
from bemcontact.problem.curves import Edge
from bemcontact.problem.problem import Problem

CURVE_ORDER = 16
"""Gauss points for each element's piece of the curve itself."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Mesh:
    """Three-noded elements on closed loops, the body on the left of each element's direction.

    Node e is the start and node m + e the middle of element e: N = 2m.
    Displacement belongs to a node; traction to an (element, local node) pair, so that it may jump.

    Parameters
    ----------
    nodes : (N, 2) [L]
    elements : (m, 3) nodes [start, middle, end] of each element, loop by loop
    edge : (m,) index into `edge_names`
    edge_names : names of the edges
    """

    nodes: Array
    elements: IntArray
    edge: IntArray
    edge_names: tuple[str, ...]

    @property
    def degrees_of_freedom(self) -> int:
        """Number of unknowns, two for each node."""
        return 2 * len(self.nodes)

    @property
    def before(self) -> IntArray:
        """(m,) the element that ends where each element starts."""
        before = np.empty(len(self.elements), int)
        before[self.elements[:, 2]] = np.arange(len(self.elements))
        return before

    @cached_property
    def center(self) -> Array:
        """Middle (2,) of the bounding box [L]."""
        return (self.nodes.min(axis=0) + self.nodes.max(axis=0)) / 2

    @cached_property
    def size(self) -> float:
        """Diameter of the bounding box [L]."""
        return float(np.hypot(*np.ptp(self.nodes, axis=0)))

    @property
    def reference_length(self) -> float:
        """L0 = 2 diameters [L], over which the lengths in the integral equations are dimensionless."""
        return 2 * self.size

    @cached_property
    def tangents(self) -> Array:
        """dx/dξ (m, 3, 2) [L] at each (element, local node)."""
        return self.tangents_at(reference_element.NODES)

    @cached_property
    def jacobians(self) -> Array:
        """|dx/dξ| (m, 3) [L] at each (element, local node)."""
        return np.hypot(self.tangents[..., 0], self.tangents[..., 1])

    @cached_property
    def normals(self) -> Array:
        """Unit normals (m, 3, 2) out of the body at each (element, local node)."""
        rotated = np.stack([self.tangents[..., 1], -self.tangents[..., 0]], axis=-1)
        return rotated / self.jacobians[..., None]

    @property
    def turns(self) -> Array:
        """Sine (m,) of the angle by which the boundary turns to the right where each element starts."""
        return np.sum(self.normals[self.before, 2] * self.tangents[:, 0], axis=1) / self.jacobians[:, 0]

    @cached_property
    def inner_angles(self) -> Array:
        """Angle (m,) [rad] inside the body where each element starts: π where the boundary is smooth."""
        directions = np.angle(self.tangents[..., 0] + 1j * self.tangents[..., 1])
        return np.mod(directions[self.before, 2] + np.pi - directions[:, 0], 2 * np.pi)

    @cached_property
    def tributary(self) -> Array:
        """Length (m, 3) [L] that belongs to each (element, local node): (1/3, 4/3, 1/3) |dx/dξ|."""
        return reference_element.INTEGRALS * self.jacobians

    def tangents_at(self, xi: Array) -> Array:
        """dx/dξ (m, q, 2) [L] at the local coordinates ξ (q,) of each element."""
        return np.einsum("gk,mkx->mgx", reference_element.derivatives(xi), self.nodes[self.elements])


def build(problem: Problem) -> Mesh:
    """Divide every edge into its elements; middle nodes halve the arc length of an element."""
    starts, middles, after, edge_of = [], [], [], []
    for loop in problem.boundary.loops:
        first = len(edge_of)
        for edge in loop:
            ends = edge.breakpoints(problem.mesh.refine)
            starts.append(edge.points(ends[:-1]))
            middles.append(edge.points((ends[:-1] + ends[1:]) / 2))
            edge_of += [edge.name] * (len(ends) - 1)
        after += [*range(first + 1, len(edge_of)), first]
    return connected(np.vstack(starts), np.vstack(middles), np.array(after), edge_of)


def along_curve(edge: Edge) -> tuple[Array, Array, Array]:
    """Gauss points of an edge itself, not of its elements, many enough for integrals to round-off.

    Returns
    -------
    points : (q, 2) [L]
    normals : (q, 2) out of the body
    lengths : (q,) arc length that belongs to each point [L]
    """
    ends = edge.breakpoints(1)
    xi, weights = reference_element.gauss_legendre(CURVE_ORDER)
    fractions = ((ends[:-1, None] + ends[1:, None]) / 2 + np.diff(ends)[:, None] / 2 * xi).ravel()
    lengths = (np.diff(ends)[:, None] / 2 * weights).ravel() * edge.length
    return edge.points(fractions), edge.normals(fractions), lengths


def connected(starts: Array, middles: Array, after: IntArray, edge_of: Sequence[str]) -> Mesh:
    """Make a mesh from its elements.

    Parameters
    ----------
    starts, middles : (m, 2) start and middle node of each element [L]
    after : (m,) the element that begins where each element ends
    edge_of : m names of edges
    """
    m = len(starts)
    names = tuple(dict.fromkeys(edge_of))
    return Mesh(
        nodes=np.vstack([starts, middles]),
        elements=np.column_stack([np.arange(m), m + np.arange(m), after]),
        edge=np.array([names.index(name) for name in edge_of]),
        edge_names=names,
    )
