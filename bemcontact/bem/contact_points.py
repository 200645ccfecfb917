"""The contact points of a mesh: pairs (zone, node) with their gaps, normals and weights."""

from collections.abc import Mapping
from dataclasses import field
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray, indices, magnitudes
from bemcontact.bem import reference_element
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen

ALIKE = 1e-9
"""Difference of two normals, or of two gaps over the size of the body, at one node that counts as none."""
SMOOTH = 0.05
"""Sine of the angle between elements below which the boundary is smooth: quadratic elements on a curve kink a bit."""
CONSISTENT_ORDER = 12
"""Gauss points for the consistent weights."""


class Opposite(NamedTuple):
    """The other elastic body at contact points.

    Parameters
    ----------
    node : (n,) its node at each point; -1 where the surface is rigid
    share : (q,) shares of points whose element faces one of the other body
    element, local : (q,) the (element, local node) pair that this share faces
    traction : (q, 2) there by a unit pressure: the nodal forces of both bodies are equal and opposite
    """

    node: IntArray
    share: IntArray
    element: IntArray
    local: IntArray
    traction: Array


class HeldNodes(NamedTuple):
    """Nodes (h,) that prescribed displacements hold along the normal of the surface: zone, normals (h, 2), ε [L]."""

    zone: IntArray
    node: IntArray
    normals: Array
    gap: Array


@frozen
class ContactPoints:
    """Candidates for contact, zone by zone, run by run, along the boundary.

    A node is no candidate if a condition prescribes its motion along the normal, and that of the other body if this is
    elastic; its pressure is zero. Contact may continue smoothly beyond such a node, as at the tip of a closed slit. The
    end node then has the pressure of the middle node of the element, whose tributary length includes that of the end
    node.

    So it is where a bond begins. The gap of this node is zero whatever the pressure is, so that it would be no unknown
    of a complementarity problem with one solution. The traction of the bond is another one, on its own elements: beside
    a debond it is infinite, with shear alone if the debond is closed.

    So it is where bonded bodies of other materials or heat touch a third one side by side: pressure jumps there.

    Parameters
    ----------
    mesh : Mesh
    node : (n,) node of each point
    zone : (n,) number of its zone
    run : (n,) number of the unbroken piece of boundary it is on
    arc_position : (n,) arc length along that piece [L]
    run_length : (runs,) perimeter of a piece that closes on itself, else infinity [L]
    normals : (n, 2) of the rigid surface, into the body; common ones of two elastic bodies, into the first
    faces : (n, 2) normals of the faces of the surface, as in `Faces`
    gap : (n,) ε [L]
    element, local, point : (q,) the (element, local node) pairs that carry the pressure of each point
    sense : (q,) -1 where this pair belongs to a contact that states the two bodies the other way round, else 1
    held_arc : (runs, 2) arc position of the first and the last node of a piece if a condition holds it on the rigid
        surface, else not a number [L]
    held_points : (runs, 2, 2) these nodes [L]
    tied : (N,) for each node the least of all that bonds make move with it
    bonded_ends : (runs, 2) whether a bond begins at the first and the last node of a piece
    elements_of_run : elements of each piece in order; none for a corner of the body that stands on a face by itself
    zone_of_run : number of the zone of each piece
    held : nodes of the zones that are no points
    facing : (m,) by number of the zone, element of the other elastic body opposite to each element, else -1
    """

    mesh: Mesh
    node: IntArray
    zone: IntArray
    run: IntArray
    arc_position: Array
    run_length: Array
    normals: Array
    faces: Array
    gap: Array
    element: IntArray
    local: IntArray
    point: IntArray
    sense: Array
    held_arc: Array
    held_points: Array
    tied: IntArray
    bonded_ends: BoolArray
    elements_of_run: tuple[IntArray, ...] = ()
    zone_of_run: tuple[int, ...] = ()
    held: HeldNodes | None = None
    facing: Mapping[int, IntArray] = field(default_factory=dict)

    @cached_property
    def opposite(self) -> Opposite:
        """The other elastic body at the points.

        What contacts with equal sides share of a point has one pressure on each body, also across two bonded ones.
        """
        node = np.full(len(self), -1)
        if not self.facing:
            none = np.zeros(0, int)
            return Opposite(node, none, none, none, np.zeros((0, 2)))
        facing = np.full(len(self.point), -1)
        for zone, elements in self.facing.items():
            own = self.zone_of_share == zone
            facing[own] = elements[self.element[own]]
        share = indices(facing >= 0)
        element, local, point = facing[share], 2 - self.local[share], self.point[share]
        turned = (self.sense < 0).astype(int)
        own = self.mesh.elements[self.element[share], self.local[share]]
        straight = (turned[share] == 0) & (self.tied[own] == self.tied[self.node[point]])
        node[point[straight]] = self.mesh.elements[element, local][straight]
        lengths, opposite = np.zeros((2, 2, len(self)))
        np.add.at(lengths, (turned, self.point), self.mesh.tributary[self.element, self.local])
        np.add.at(opposite, (turned[share], point), self.mesh.tributary[element, local])
        factor = self.sense[share] * (lengths / np.where(opposite, opposite, 1.0))[turned[share], point]
        return Opposite(node, share, element, local, -factor[:, None] * self.normals[point])

    @property
    def tractions(self) -> Array:
        """Traction (q, 2) by a unit pressure on each share."""
        return self.sense[:, None] * self.normals[self.point]

    @cached_property
    def moved(self) -> tuple[IntArray, IntArray, Array]:
        """Nodes (r,) whose displacement changes a gap, numbers (r,) of the points, and the change (r, 2) by it.

        Bonded nodes that share a point count in proportion to the forces on them: then pressure and gap do the same
        work in any motion, also in one that would part them.
        """
        other, node, gap, change = self.opposite, self.node, np.arange(len(self)), self.normals
        has = indices(other.node >= 0)
        if len(has):
            node, gap = np.concatenate([node, other.node[has]]), np.concatenate([gap, has])
            change = np.concatenate([change, -change[has]])
        if (self.tied == np.arange(len(self.tied))).all():  # nothing is bonded
            return node, gap, change
        element, local = np.append(self.element, other.element), np.append(self.local, other.local)
        point, at = np.append(self.point, self.point[other.share]), self.mesh.elements[element, local]
        far = np.where(other.node >= 0, other.node, self.node)
        sides = np.column_stack([self.node, far])[point]
        bonded = (at[:, None] != sides).all(axis=1) & (self.tied[at][:, None] == self.tied[sides]).any(axis=1)
        if not bonded.any():
            return node, gap, change
        shared = np.zeros(len(self), bool)
        shared[point[bonded]] = True
        forces = self.mesh.tributary[element, local, None] * np.concatenate([self.tractions, other.traction])
        own, still = shared[point], ~shared[gap]
        return (
            np.append(node[still], at[own]),
            np.append(gap[still], point[own]),
            np.concatenate([change[still], forces[own] / self.tributary[point[own], None]]),
        )

    @cached_property
    def unit_pressures(self) -> tuple[UnitPressures, ...]:
        """Unit pressures on the mesh of each of the bodies."""
        element, local, point, traction = self.element, self.local, self.point, self.tractions
        (node, gap, change), other = self.moved, self.opposite
        if len(other.share):
            element, local = np.concatenate([element, other.element]), np.concatenate([local, other.local])
            point, traction = np.append(point, point[other.share]), np.concatenate([traction, other.traction])
        of_parts = list[UnitPressures]()
        for part in self.mesh.parts:
            first, last, _ = part.elements.indices(len(self.mesh.elements))
            own = seen = slice(None)
            new, pressed = node, np.zeros(len(self), bool)
            if not isinstance(part.nodes, slice):
                number = np.full(len(self.mesh.nodes), -1)
                number[part.nodes] = np.arange(len(part.mesh.nodes))
                new = number[node]
                own, seen = indices((element >= first) & (element < last)), indices(new >= 0)
            pressed[point[own]] = True
            of_parts.append(
                UnitPressures(
                    number=indices(pressed), element=element[own] - first, local=local[own],
                    pressure=(pressed.cumsum() - 1)[point[own]], traction=traction[own], node=new[seen],
                    gap=gap[seen], change=change[seen],
                )
            )  # fmt: skip
        return tuple(of_parts)

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.node)

    @cached_property
    def in_zone(self) -> BoolArray:
        """Whether each element (m,) carries the pressure of a point."""
        in_zone = np.zeros(len(self.mesh.elements), bool)
        in_zone[self.element] = True
        return in_zone

    @cached_property
    def zone_of_share(self) -> IntArray:
        """Number of the zone of each share of a point, an (element, local node) pair: that of its element.

        A node between two zones on one face is a point of the first of them, and acts on the elements of both. The
        last node that is turned to the surface of a zone acts on the element beyond, which may be one of another zone
        that has a point at this node too.
        """
        zones = self.zone[self.point]
        if not self.zone.any():
            return zones
        has = np.zeros((self.zone.max() + 1, len(self.mesh.elements), 3), bool)
        has[zones, self.element, self.local] = True
        middle = has[:, self.element, 1]
        other = middle.argmax(axis=0)
        own = middle[zones, np.arange(len(zones))] | ~middle.any(axis=0) | has[other, self.element, self.local]
        return np.where(own, zones, other)

    def tributary_by_zone(self, zones: int) -> Array:
        """(zones, n) [L]: the parts of the tributary lengths in each zone, negative with the sides exchanged."""
        signed = self.sense * self.mesh.tributary[self.element, self.local]
        place = self.zone_of_share * len(self) + self.point
        return np.bincount(place, signed, zones * len(self)).astype(float).reshape(zones, -1)

    @cached_property
    def tributary(self) -> Array:
        """(n,) [L]: Σ over elements of (1/3, 4/3, 1/3) |dx/dξ|."""
        return np.bincount(self.point, self.mesh.tributary[self.element, self.local], len(self)).astype(float)

    @cached_property
    def element_length(self) -> Array:
        """(n,) [L]: length of the element, the mean of the two where a node has two; [SS92] (26) taken literally."""
        lengths = self.mesh.lengths[self.element]
        return np.bincount(self.point, lengths, len(self)) / np.bincount(self.point, minlength=len(self))

    @cached_property
    def consistent(self) -> Array:
        """(n, n) [L]: Σ over elements of ∫ h hᵀ |dx/dξ| dξ, [SS92] (24)-(25)."""
        one_more, (slopes, products) = len(self) + 1, _consistent_rule()
        owner = np.full((self.zone.max(initial=0) + 1, len(self.mesh.elements), 3), len(self))  # else one too many
        owner[self.zone_of_share, self.element, self.local] = self.point
        of_zone, element = np.nonzero((owner < len(self)).any(axis=2))
        i = owner[of_zone, element]
        nodes = self.mesh.nodes[self.mesh.elements[element]]
        local = magnitudes(slopes @ (nodes - nodes[:, 1:2])) @ products
        place = i[:, :, None] * one_more + i[:, None]
        sums = np.bincount(place.ravel(), local.ravel(), one_more**2).astype(float)
        return sums.reshape(one_more, -1)[:-1, :-1]


@lru_cache(maxsize=1)
def _consistent_rule() -> tuple[Array, Array]:
    """For the consistent weights, at Gauss points: dN_k/dξ (q, 3), and N_k N_l times the weights (q, 9)."""
    xi, weights = reference_element.gauss_legendre(CONSISTENT_ORDER)
    N = reference_element.values(xi)
    return reference_element.derivatives(xi), (N[:, :, None] * N[:, None] * weights[:, None, None]).reshape(-1, 9)
