"""Gaps between the deformed boundary and the rigid surfaces, at any place of its elements.

An edge need not belong to the zone of a surface. Places are on the curves of the edges themselves; the displacement is
that of the elements.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.bem import reference_element
from bemcontact.bem.mesh import BoundaryState
from bemcontact.bem.outline import SAMPLES, Outline, Places
from bemcontact.problem.problem import Problem
from bemcontact.problem.rigid_surface import DeflectedContour, Shape
from bemcontact.problem.surface_lines import Closest

NODES = [0, len(SAMPLES) // 2, -1]
"""Which of them are nodes."""
CHUNK = 8192
"""Number of places whose distance from a surface is computed at a time."""
FLUSH = 1e-6
"""Distance of an undeformed place from a surface, over the size of the body, up to which it lies in the surface."""
SAME_FACE = 0.98
"""Cosine of the angle between two normals of a surface up to which they belong to the same face."""
DIP = 1 / 8
"""Largest dip of a quadratic below zero between three nodes, over the largest of its values there, if none is below."""


class Intrusion(NamedTuple):
    """How deep elements are in a surface.

    Parameters
    ----------
    depth : (m,) [L], negative outside, minus infinity for an element that was not compared
    xi : (m,) local coordinate where an element is deepest
    behind : (m,) whether a place of an element that is not of the zone is behind the surface before anything moves
    sunk : (m,) how deep an element that is not of the zone sinks in where it lies in the surface [L], zero for others
    """

    depth: Array
    xi: Array
    behind: BoolArray
    sunk: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class SurfaceGaps:
    """The deformed boundary of a body and its rigid surfaces.

    Parameters
    ----------
    problem : whose surfaces they are
    outline : its edges
    state : displacement of the boundary
    tools : displacement (3,) of each tool by name: x, y [L] and rotation [rad] about its point
    """

    problem: Problem
    outline: Outline
    state: BoundaryState
    tools: Mapping[str, Array]

    @property
    def surfaces(self) -> dict[str, Shape]:
        """Rigid surfaces by zone; a deflected contour has no gap at other places than the nodes of its own zone."""
        zones = self.problem.contact_zones.items()
        return {name: zone.surface for name, zone in zones if not isinstance(zone.surface, DeflectedContour)}

    def paired(self, zone: str) -> BoolArray:
        """Whether each element (m,) belongs to a zone."""
        names = self.problem.contact_zones[zone].edges
        return np.isin(self.state.edge, [self.state.edge_names.index(name) for name in names])

    def linear(self, zone: str, at: Places, displacement: Array) -> Closest:
        """Gap (k, q) [L] as contact sees it, ε + n·(u - w), with the normals n of the undeformed body."""
        flat = at.points.reshape(-1, 2)
        inward = np.repeat(at.inward.reshape(-1, 1, 2), 2, axis=1)
        faces = self.surfaces[zone].faces(flat, inward, np.zeros(len(flat)))
        normals = faces.normals[:, 0].reshape(at.points.shape)
        moved = np.sum(normals * (displacement - self.tool_motion(zone, at.points)), axis=-1)
        return Closest(faces.gap[:, 0].reshape(at.points.shape[:-1]) + moved, normals)

    def exact(self, zone: str, moved: Array) -> Closest:
        """Distance (...) [L] of displaced places (..., 2) from the displaced surface, and the normals there."""
        return self.undeformed(zone, moved - self.tool_motion(zone, moved))

    def undeformed(self, zone: str, points: Array) -> Closest:
        """Distance (...) [L] of points (..., 2) from the undisplaced surface, and the normals there."""
        surface, flat = self.surfaces[zone], points.reshape(-1, 2)
        parts = [surface.closest(flat[i : i + CHUNK]) for i in range(0, max(len(flat), 1), CHUNK)]
        gap, normals = (np.concatenate(part) for part in zip(*parts, strict=True))
        return Closest(gap.reshape(points.shape[:-1]), normals.reshape(points.shape))

    def tool_motion(self, zone: str, points: Array) -> Array:
        """Displacement (..., 2) [L] of a surface at points (..., 2): that of its tool."""
        for name, tool in self.problem.tools.items():
            if zone in tool.zones:
                x, y, turn = self.tools[name]
                offset = points - np.array(tool.point or (0.0, 0.0))
                return np.stack([x - turn * offset[..., 1], y + turn * offset[..., 0]], axis=-1)
        return np.zeros_like(points)

    def distance(self, zone: str, elements: IntArray) -> Array:
        """Distance (k, q) [L] of displaced places of elements (k,) from the displaced surface."""
        return self.exact(zone, self.outline.sampled(elements).points + self._displacement(elements)).gap

    def intrusion(self, zone: str) -> Intrusion:
        """How deep each element is in the surface of a zone, beyond what interpolation between its nodes explains.

        In elements of the zone this is the gap as contact sees it; where another face of the surface is nearer to the
        displaced place than the face that holds it, it is the distance, as for all other elements. A place of these
        that is in the surface or behind it before anything moves does not count: the surface is taken to end there,
        also opposite to places beyond.
        """
        paired, near = self.paired(zone), self._near(zone)
        m, ended = len(paired), self._ends(zone, paired, near)
        depth, xi, behind, sunk = np.full(m, -np.inf), np.zeros(m), np.zeros(m, bool), np.zeros(m)
        for elements, own in ((np.flatnonzero(paired), True), (np.flatnonzero(~paired & near), False)):
            if not len(elements):
                continue
            at, displacement = self.outline.sampled(elements), self._displacement(elements)
            if own:
                depths = self._depth_in_own(zone, at, displacement)
            else:
                depths, behind[elements], sunk[elements] = self._depth_in_other(zone, at, displacement, ended)
            deepest = depths.argmax(axis=1)
            depth[elements], xi[elements] = depths[np.arange(len(elements)), deepest], SAMPLES[deepest]
        return Intrusion(depth, xi, behind, sunk)

    def _depth_in_own(self, zone: str, at: Places, displacement: Array) -> Array:
        """Depth (k, q) [L] of elements of the zone."""
        here, there = self.linear(zone, at, displacement), self.exact(zone, at.points + displacement)
        dip = DIP * np.maximum(here.gap[:, NODES], 0.0).max(axis=1)
        other = np.sum(here.normals * there.normals, axis=-1) < SAME_FACE
        beyond = other & (-there.gap > self._second_order(zone, at, displacement))
        return np.maximum(-here.gap - dip[:, None], np.where(beyond, -there.gap, -np.inf))

    def _depth_in_other(
        self, zone: str, at: Places, displacement: Array, ended: Callable[[Array], BoolArray]
    ) -> tuple[Array, BoolArray, Array]:
        """Depth (k, q) [L] of elements not of the zone; which (k,) are behind it; how deep (k,) flush ones sink in."""
        flush = FLUSH * self.problem.boundary.size
        (before, normals), after = self.undeformed(zone, at.points), self.exact(zone, at.points + displacement).gap
        inside = -after > self._second_order(zone, at, displacement)
        sunk = np.where(inside & (abs(before) <= flush), -after, 0.0).max(axis=1)
        beyond = (before > flush) & inside
        beyond &= ~ended(at.points - before[..., None] * normals)
        behind: BoolArray = np.any(before < -flush, axis=1)
        return np.where(beyond, -after, -np.inf), behind, sunk

    def _ends(self, zone: str, paired: BoolArray, near: BoolArray) -> Callable[[Array], BoolArray]:
        """Whether places (..., 2) of a surface are nearer to an edge that lies in it than to the edges of its zone."""
        others = self.outline.sampled(np.flatnonzero(~paired & near)).points.reshape(-1, 2)
        lying = others[np.abs(self.undeformed(zone, others).gap) <= FLUSH * self.problem.boundary.size]
        own = self.outline.sampled(np.flatnonzero(paired)).points.reshape(-1, 2)
        lying = lying[KDTree(own).query(lying)[0] > FLUSH * self.problem.boundary.size]
        if not len(lying):
            return lambda feet: np.zeros(feet.shape[:-1], bool)
        return lambda feet: KDTree(lying).query(feet)[0] < KDTree(own).query(feet)[0]

    def _displacement(self, elements: IntArray) -> Array:
        """Displacement (k, q, 2) [L] at `SAMPLES` of elements (k,)."""
        return reference_element.values(SAMPLES) @ self.state.displacement[elements]

    def _second_order(self, zone: str, at: Places, displacement: Array) -> Array:
        """Depth (k, q) [L] by which linear theory may be off: squares of displacements over the size of the body."""
        squares = displacement**2 + self.tool_motion(zone, at.points) ** 2
        return np.sum(squares, axis=-1) / self.problem.boundary.size

    def _near(self, zone: str) -> BoolArray:
        """Whether each element (m,) may touch a surface: a distance changes by no more than the way."""
        near = np.zeros(len(self.state.points), bool)
        for moved, gap in (
            (self.state.points, self.undeformed),
            (self.state.points + self.state.displacement, self.exact),
        ):
            length = np.hypot(*np.moveaxis(np.diff(moved, axis=1), 2, 0)).sum(axis=1)
            near |= gap(zone, moved[:, 1]).gap <= length
        return near
