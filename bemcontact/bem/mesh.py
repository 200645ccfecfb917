"""The boundary of the bodies in quadratic elements."""

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray, indices, magnitudes, scalar_products
from bemcontact.bem import reference_element
from bemcontact.bem.division import Facing, divided
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen
from bemcontact.problems.conditions import Along
from bemcontact.problems.curves import Edge
from bemcontact.problems.problem import Problem

ARC_ORDER = 12
"""Gauss points for the arc length of half an element."""
CURVE_ORDER = 16
"""Gauss points for each element's piece of the curve itself."""
ROUND_OFF = 1e-9
"""Coordinate over the size of a mesh that is round-off."""
CORNER = 0.2
"""Angle [rad], or its sine, by which the boundary turns from which it has a corner."""


@frozen
class Mesh:
    """Elements with three nodes on closed loops; the body is on the left.

    Node e is the start and node m + e the middle of element e: N = 2m.
    Displacement belongs to a node; traction to an (element, local node) pair, so that it may jump.

    Parameters
    ----------
    nodes : (N, 2) [L]
    elements : (m, 3) nodes [start, middle, end] of each element, loop by loop
    edge : (m,) index into `edge_names`
    edge_names : names of the edges
    fractions : (m, 3) of the length of its edge at the nodes of each element; none of a mesh without a problem
    edge_lengths : length of each edge [L]; likewise
    part : (m,) number of the elastic body of each element, ascending; none for an only body
    facing : (m,) by contact of two elastic bodies, element of the second body opposite to each of the first, else -1
    """

    nodes: Array
    elements: IntArray
    edge: IntArray
    edge_names: tuple[str, ...]
    fractions: Array = dataclasses.field(default_factory=lambda: np.zeros((0, 3)))
    edge_lengths: tuple[float, ...] = ()
    part: IntArray = dataclasses.field(default_factory=lambda: np.zeros(0, int))
    facing: Mapping[str, IntArray] = dataclasses.field(default_factory=dict)

    def ends_on(self, edge: str) -> Array:
        """Fractions (e + 1,) of the length of an edge at the ends of its elements."""
        own = self.fractions[self.edge == self.edge_names.index(edge)]
        return np.append(own[:, 0], own[-1, 2])

    @property
    def degrees_of_freedom(self) -> int:
        """Number of unknowns, two for each node."""
        return 2 * len(self.nodes)

    @cached_property
    def parts(self) -> tuple["MeshPart", ...]:
        """The mesh of each elastic body."""
        if not self.part.any():
            return (MeshPart(self, slice(None), slice(None)),)
        return tuple(self._part(number) for number in range(self.part[-1] + 1))

    def part_of(self, element: int) -> int:
        """Number of the elastic body of an element."""
        return int(self.part[element]) if len(self.part) else 0

    def across(self, contacts: Iterable[str], touching: BoolArray | None = None) -> IntArray:
        """Element (m,) on the other side of contacts or bonds, from either side, else -1.

        Only those elements of the first sides that are `touching` (k, m) in each contact, if stated.
        """
        across = np.full(len(self.elements), -1)
        for number, facing in enumerate(self.facing.get(contact) for contact in contacts):
            if facing is not None:
                on = facing >= 0 if touching is None else (facing >= 0) & touching[number]
                across[facing[on]], across[on] = indices(on), facing[on]
        return across

    def ends_of_joints(self, across: IntArray) -> BoolArray:
        """Whether the other side of a bond begins, ends or changes its body where each element (m,) starts."""
        before = across[self.before]
        goes_on = (across >= 0) & (before >= 0) & (self.elements[across, 2] == before)
        return ~goes_on & ((across >= 0) | (before >= 0))

    def _part(self, number: int) -> "MeshPart":
        """The mesh of one elastic body, whose elements follow one another."""
        first, last = np.searchsorted(self.part, [number, number + 1]).tolist()
        m, elements = len(self.elements), slice(first, last)
        nodes = np.concatenate([np.arange(first, last), m + np.arange(first, last)])
        new = np.full(2 * m, -1)
        new[nodes] = np.arange(len(nodes))
        own = np.unique(self.edge[elements])
        mesh = Mesh(
            nodes=self.nodes[nodes],
            elements=new[self.elements[elements]],
            edge=np.searchsorted(own, self.edge[elements]),
            edge_names=tuple(self.edge_names[i] for i in own),
            fractions=self.fractions[elements],
            edge_lengths=tuple(self.edge_lengths[i] for i in own) if self.edge_lengths else (),
        )
        return MeshPart(mesh, elements, nodes)

    def nodes_of(self, elements: IntArray) -> IntArray:
        """Nodes (k,) of some elements, ascending."""
        own = np.zeros(len(self.nodes), bool)
        own[self.elements[elements]] = True
        return indices(own)

    @cached_property
    def before(self) -> IntArray:
        """(m,) the element that ends where each element starts."""
        before = np.empty(len(self.elements), int)
        before[self.elements[:, 2]] = np.arange(len(self.elements))
        return before

    @cached_property
    def _box(self) -> tuple[Array, Array]:
        """Least and largest coordinates (2,) of the nodes [L]."""
        return self.nodes.min(axis=0), self.nodes.max(axis=0)

    @cached_property
    def center(self) -> Array:
        """Middle (2,) of the bounding box [L]."""
        low, high = self._box
        return (low + high) / 2

    @cached_property
    def size(self) -> float:
        """Diameter of the bounding box [L]."""
        low, high = self._box
        return float(np.hypot(*(high - low)))

    def place(self, point: Sequence[float] | Array) -> tuple[float, float]:
        """Return a point as (x, y) [L] for a sentence, with zero for what is round-off beside the size of the mesh."""
        x, y = (float(value) if abs(value) > ROUND_OFF * self.size else 0.0 for value in point)
        return x, y

    @cached_property
    def centroid(self) -> Array:
        """Mean (2,) of the boundary [L]. It turns with the body, as the middle of a bounding box does not."""
        first, weights = self.nodes[0], np.repeat(self.tributary[..., None], 2, axis=2)
        moments = (self.nodes[self.elements] - first) * weights
        return first + moments.sum(axis=(0, 1)) / weights.sum(axis=(0, 1))

    @cached_property
    def reference_length(self) -> float:
        """L0 [L], over which the lengths in the integral equations are dimensionless: four times the largest radius.

        Where displacements are prescribed, discrete forces balance up to an error of discretization, and the constant
        ln L0 times this error enters the answer. So L0 must not depend on how the body is turned.
        """
        return 4 * float(magnitudes(self.nodes - self.centroid).max())

    @cached_property
    def tangents(self) -> Array:
        """dx/dξ (m, 3, 2) [L] at each (element, local node)."""
        return self._tangents(reference_element.DERIVATIVES_AT_NODES)

    @cached_property
    def jacobians(self) -> Array:
        """|dx/dξ| (m, 3) [L] at each (element, local node)."""
        return np.hypot(self.tangents[..., 0], self.tangents[..., 1])

    @cached_property
    def normals(self) -> Array:
        """Unit normals (m, 3, 2) out of the body at each (element, local node)."""
        normals = self.tangents[..., ::-1] / self.jacobians[..., None]
        normals[..., 1] *= -1
        return normals

    @cached_property
    def turns(self) -> Array:
        """Sine (m,) of the angle by which the boundary turns to the right where each element starts."""
        return scalar_products(self.normals[self.before, 2], self.tangents[:, 0]) / self.jacobians[:, 0]

    @cached_property
    def inner_angles(self) -> Array:
        """Angle (m,) [rad] inside the body where each element starts: π where the boundary is smooth."""
        directions = np.angle(self.tangents[..., 0] + 1j * self.tangents[..., 1])
        return np.mod(directions[self.before, 2] + np.pi - directions[:, 0], 2 * np.pi)

    @cached_property
    def tributary(self) -> Array:
        """Length (m, 3) [L] that belongs to each (element, local node): (1/3, 4/3, 1/3) |dx/dξ|."""
        return reference_element.INTEGRALS * self.jacobians

    @cached_property
    def halves(self) -> Array:
        """Arc length (m, 2) [L] of the first and the second half of each element."""
        derivatives, weights = reference_element.half_rule(ARC_ORDER)
        tangents = self._tangents(derivatives)
        return np.hypot(tangents[..., 0], tangents[..., 1]).reshape(-1, 2, ARC_ORDER) @ weights / 2

    @property
    def lengths(self) -> Array:
        """Arc length (m,) [L] of each element."""
        return self.halves.sum(axis=1)

    def tangents_at(self, xi: Array) -> Array:
        """dx/dξ (m, q, 2) [L] at the local coordinates ξ (q,) of each element."""
        return self._tangents(reference_element.derivatives(xi))

    def _tangents(self, derivatives: Array) -> Array:
        """dx/dξ (m, q, 2) [L], from the derivatives (q, 3) of the shape functions."""
        x_and_y = self.nodes.T[:, self.elements]  # one after the other, as BLAS multiplies them
        steps = x_and_y - x_and_y[..., 1:2]  # which keeps the digits of short elements
        return (steps @ derivatives.T).transpose(1, 2, 0)


class MeshPart(NamedTuple):
    """The mesh of one elastic body, with its elements and nodes in the whole mesh."""

    mesh: Mesh
    elements: slice
    nodes: slice | IntArray

    @property
    def whole(self) -> bool:
        """Whether this is the whole mesh."""
        return self.elements == slice(None)


def build(problem: Problem) -> Mesh:
    """Divide every edge into its elements.

    Middle nodes halve the arc length of an element, or of that of the other body which it faces.
    """
    division, parts = divided(problem), problem.parts
    loops = [loop for part in parts for loop in part.loops]
    edges = [edge for loop in loops for edge in loop]
    fractions = [division.fractions[edge.name] for edge in edges]
    counts, names = [*map(len, fractions)], [edge.name for edge in edges]
    part_of_edge = [number for number, part in enumerate(parts) for loop in part.loops for _ in loop]
    m, first_of = sum(counts), dict(zip(names, accumulate(counts, initial=0), strict=False))
    nodes = np.empty((2, m, 2))
    for edge, own, first in zip(edges, fractions, first_of.values(), strict=True):
        nodes[:, first : first + len(own)] = edge.curve.at(own[:, :2].T.ravel()).reshape(2, -1, 2)
        nodes[0, first] = edge.start
    after = np.arange(1, m + 1)
    for loop in loops:
        last = loop[-1].name
        after[first_of[last] + len(division.fractions[last]) - 1] = first_of[loop[0].name]
    return Mesh(
        nodes=nodes.reshape(-1, 2),
        elements=elements_of_loops(after),
        edge=np.arange(len(edges)).repeat(counts),
        edge_names=tuple(names),
        fractions=np.concatenate(fractions),
        edge_lengths=tuple(edge.length for edge in edges),
        part=np.array(part_of_edge).repeat(counts),
        facing={contact: _facing(pairs, first_of, m) for contact, pairs in division.facing.items()},
    )


def _facing(pairs: Iterable[Facing], first_of: Mapping[str, int], elements: int) -> IntArray:
    """Element (m,) of the second body of a contact opposite to each of the first, else -1.

    `first_of` has the number of the first element of each edge.
    """
    facing = np.full(elements, -1)
    for edge, element, onto, opposite in pairs:
        facing[first_of[edge] + element] = first_of[onto] + opposite
    return facing


def element_curves(values: Array, count: int) -> Array:
    """Values (m, count, 2) at equally spaced points of each element, from those (m, 3, 2) at its nodes."""
    return reference_element.values(np.linspace(-1, 1, count)) @ values


def along_curve(edge: Edge) -> tuple[Array, Array, Array, Along]:
    """Gauss points (q, 2) [L], outward normals (q, 2) and arc lengths (q,) [L] of an edge itself, not of its elements.

    Their places along the edge come last.

    The points are many enough for integrals to round-off.
    """
    ends = edge.breakpoints(1)
    xi, weights = reference_element.gauss_legendre(CURVE_ORDER)
    middles, halves, length = (ends[:-1] + ends[1:]) / 2, (ends[1:] - ends[:-1]) / 2, edge.length
    fractions = (middles[:, None] + halves[:, None] * xi).ravel()
    along = fractions * length
    lengths = (halves[:, None] * weights).ravel() * length
    return edge.curve.at(fractions), edge.normals(fractions), lengths, Along(along, along, length)


def elements_of_loops(after: IntArray) -> IntArray:
    """Nodes (m, 3) of each element, from the element (m,) after each."""
    m = len(after)
    elements = np.empty((m, 3), int)
    elements[:, 0], elements[:, 1], elements[:, 2] = np.arange(m), np.arange(m, 2 * m), after
    return elements


def runs(mesh: Mesh, in_zone: BoolArray) -> Iterator[tuple[IntArray, bool]]:
    """Unbroken pieces of a zone: their elements in order, and whether the piece closes on itself."""
    after, left = mesh.elements[:, 2].tolist(), in_zone.tolist()
    for start in (*indices(in_zone & ~in_zone[mesh.before]).tolist(), *indices(in_zone).tolist()):
        if not left[start]:
            continue
        run, element = [], start
        while left[element]:
            left[element] = False
            run.append(element)
            element = after[element]
        yield np.array(run), element == start
