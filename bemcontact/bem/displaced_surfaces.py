"""Surfaces that bodies may touch, after tools and elastic bodies have displaced them."""

from collections.abc import Mapping

import numpy as np

from bemcontact.arrays import Array, IntArray
from bemcontact.bem import reference_element
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.outline import Outline
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen
from bemcontact.problems.body_surface import AnyShape, BodySurface
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import DeflectedContour
from bemcontact.problems.surface_lines import Closest
from bemcontact.problems.way import AS_DRAWN, Way

CHUNK = 8192
"""Number of places whose distance from a surface is computed at a time."""


@frozen
class DisplacedSurfaces:
    """The surfaces of a problem by zone, with their displacement.

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

    @cached_property
    def surfaces(self) -> dict[str, AnyShape]:
        """Surfaces by zone; a deflected contour has no gap at other places than the nodes of its own zone."""
        zones = self.problem.zones.items()
        return {name: zone.surface for name, zone in zones if not isinstance(zone.surface, DeflectedContour)}

    @cached_property
    def size(self) -> float:
        """Size of the problem [L]."""
        return self.problem.size

    def exact(self, zone: str, moved: Array) -> Closest:
        """Distance (...) [L] of displaced places (..., 2) from the displaced surface, and the normals there.

        The place of an elastic body that is nearest then is that to which its motion there leads back. What slides past
        an end of the surface is opposite to the edge in which the boundary goes on smoothly.
        """
        surface = self.surfaces[zone]
        surface = surface.continued if isinstance(surface, BodySurface) else surface
        if isinstance(surface, BodySurface) and surface.elastic:
            motion = self._motion_of_body(surface, moved)
            return _closest(surface, moved - self._motion_of_body(surface, moved - motion))
        way = self.way_of_tool(zone)
        gap, normals = _closest(surface, way.back(moved))
        return Closest(gap, way.turned(normals))

    def from_other_side(self, zone: str, moved: Array) -> Closest:
        """Distance (k,) [L] of displaced places (k, 2) of the second elastic body from the displaced first one.

        The normals are those there after the motion, into the first body.
        """
        surface = self.surfaces[zone]
        assert isinstance(surface, BodySurface)
        first = surface.other_side
        motion = self._motion_of_body(first, moved)
        places = moved - self._motion_of_body(first, moved - motion)
        gap, normals = first.closest(places)
        return Closest(gap, -(normals + self.turn_of(first, places, normals)))

    def undeformed(self, zone: str, points: Array) -> Closest:
        """Distance (...) [L] of points (..., 2) from the undisplaced surface, and the normals there."""
        return _closest(self.surfaces[zone], points)

    def tool_motion(self, zone: str, points: Array) -> Array:
        """Displacement (..., 2) [L] of a surface at points (..., 2): that of its tool, or of the other elastic body.

        Of the latter at the nearest places.
        """
        surface = self.surfaces[zone]
        if isinstance(surface, BodySurface) and surface.elastic:
            return self._motion_of_body(surface, points)
        way = self.way_of_tool(zone)
        return np.zeros_like(points) if way == AS_DRAWN else way.motion_of(points - surface.way.step)

    def way_of_tool(self, zone: str) -> Way:
        """Motion of the tool of a zone; none of a surface that is no tool."""
        for name, tool in self.problem.tools.items():
            if zone in tool.zones:
                x, y, turn = self.tools[name].tolist()
                return Way(x, y, turn, tool.point or (0.0, 0.0))
        return AS_DRAWN

    def _motion_of_body(self, surface: BodySurface, points: Array) -> Array:
        """Displacement (..., 2) [L] of an elastic body at places opposite to points (..., 2)."""
        edges = [edge.name for edge in surface.edges]
        places = self.outline.elements_at(edges, *surface.nearest_to(points.reshape(-1, 2)))
        return self.motion_at(*places).reshape(points.shape)

    def motion_at(self, element: IntArray, xi: Array) -> Array:
        """Displacement (k, 2) [L] at local coordinates (k,) of elements (k,)."""
        return np.einsum("ki,kix->kx", reference_element.values(xi), self.state.displacement[element])

    def turn_of(self, surface: BodySurface, points: Array, normals: Array) -> Array:
        """Change (k, 2) of normals (k, 2) of an elastic body at points (k, 2) [L], as it deforms."""
        edges = [edge.name for edge in surface.edges]
        element, xi = self.outline.elements_at(edges, *surface.nearest_to(points))
        shapes = reference_element.derivatives(xi)
        along, change = (
            np.einsum("ki,kix->kx", shapes, values[element]) for values in (self.state.points, self.state.displacement)
        )
        slope = np.sum(change * normals, axis=1) / np.sum(along**2, axis=1)
        return -slope[:, None] * along


def _closest(surface: AnyShape, points: Array) -> Closest:
    """Distance (...) [L] of points (..., 2) from a surface, and the normals there."""
    flat = points.reshape(-1, 2)
    if len(flat) <= CHUNK:
        gap, normals = surface.closest(flat)
    else:
        parts = [surface.closest(flat[i : i + CHUNK]) for i in range(0, len(flat), CHUNK)]
        gap, normals = (np.concatenate(part) for part in zip(*parts, strict=True))
    return Closest(gap.reshape(points.shape[:-1]), normals.reshape(points.shape))
