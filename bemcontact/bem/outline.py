"""Places on the curves of the edges themselves, by the local coordinates of the elements on them."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray, indices
from bemcontact.bem import reference_element
from bemcontact.bem.mesh import Mesh
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen
from bemcontact.problems.body_surface import AnyShape, AnySurface, BodySurface
from bemcontact.problems.curves import Edge
from bemcontact.problems.nearest_places import nearest_places, surface_corners
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import Circle, Plane
from bemcontact.problems.surface_lines import Faces, Polyline, SmoothSurface, Spline

SAMPLES = np.linspace(-1.0, 1.0, 17)
"""Local coordinates at which the boundary is compared with a surface; some are moved, see `Outline.local`."""
NODES = [0, len(SAMPLES) // 2, -1]
"""Which of them are nodes."""
SHAPES = reference_element.values(SAMPLES)
"""Shape functions (17, 3) there."""
STEPS_BACK = 4
"""Steps from a fraction of an edge to the local coordinate: each has more digits, for middle nodes are nearly there."""
KEPT = 8
"""Sets of faces at samples that are kept."""
KEPT_SURFACES = 64
"""Surfaces of which the faces at nodes are kept: those of a problem with many zones."""
ROUGH = 1e-7
"""Difference of the unit normals of two edges below which they meet smoothly."""


OnEdges = tuple[IntArray, Array]
"""Numbers (k,) of the edges of a surface, and fractions (k,) of their lengths."""


class Places(NamedTuple):
    """Places (k, q, 2) [L] on elements, with unit normals (k, q, 2) into the body."""

    points: Array
    inward: Array


@frozen
class Outline:
    """The curves of the edges under the elements of a mesh; places of samples and their faces are computed once."""

    problem: Problem
    mesh: Mesh

    @cached_property
    def edges(self) -> tuple[Edge, ...]:
        """The edges under the mesh, in its order."""
        edges = {edge.name: edge for edge in self.problem.edges}
        return tuple(edges[name] for name in self.mesh.edge_names)

    @cached_property
    def local(self) -> Array:
        """Local coordinates (m, 17) of the samples of each element.

        They are `SAMPLES`, but where the boundary is nearest to a surface the next one is moved there: what is
        narrower than an element would be between them.
        """
        fractions, step = self.mesh.fractions, SAMPLES[-1] / NODES[1]
        local = np.empty((len(fractions), len(SAMPLES)))
        local[:] = SAMPLES
        narrow = [*self._narrow]
        if not narrow:
            return local
        taken = np.zeros_like(local)
        taken[:, NODES] = np.inf
        for number, found in narrow:
            places, own = np.array(found, float), indices(self.mesh.edge == number)
            elements = own[np.minimum(np.searchsorted(fractions[own, 2], places), len(own) - 1)]
            first, _, last = fractions[elements].T
            xi = (2 * (places - first) / (last - first) - 1)[:, None]
            away = np.where(SAMPLES * xi > 0, np.abs(SAMPLES - xi), np.inf)
            for i, element in enumerate(elements):
                distance = away[i] + taken[element]
                if distance[at := distance.argmin()] < 2 * step:
                    local[element, at], taken[element, at] = xi[i, 0], np.inf
        return np.sort(local, axis=1)

    @property
    def _narrow(self) -> Iterator[tuple[int, tuple[float, ...]]]:
        """Numbers of edges, with the fractions of each where a surface may be narrow."""
        zones = [(zone.surface, self.problem.edges_of(name)) for name, zone in self.problem.zones.items()]
        for number, edge in enumerate(self.edges):
            for surface, touching in zones:
                if found := tuple(_narrow_places(edge, surface, paired=edge.name in touching)):
                    yield number, found

    @cached_property
    def _moved_samples(self) -> IntArray:
        """Elements (k,) of which a sample is not where it is in most of them."""
        return indices((self.local != SAMPLES).any(axis=1))

    @cached_property
    def shapes(self) -> Array:
        """Shape functions (m, 17, 3) at the samples."""
        shapes, other = np.empty((*self.local.shape, 3)), self._moved_samples
        shapes[:] = SHAPES
        if len(other):
            shapes[other] = reference_element.values(self.local[other])
        return shapes

    def interpolated(self, values: Array) -> Array:
        """Values (m, 17, 2) at the samples, from those (m, 3, 2) at the nodes of elements: most by one product."""
        other = self._moved_samples
        result = (values.transpose(0, 2, 1).reshape(-1, 3) @ SHAPES.T).reshape(-1, 2, len(SAMPLES)).transpose(0, 2, 1)
        if len(other):
            result[other] = self.shapes[other] @ values[other]
        return result

    @cached_property
    def in_zones(self) -> BoolArray:
        """Which elements each contact zone has, (zones, m)."""
        problem, names = self.problem, self.mesh.edge_names
        zones = [*problem.zones]
        of_edges = [[name in edges for name in names] for edges in map(problem.edges_of, zones)]
        in_zones = np.array(of_edges, bool).reshape(-1, len(names))[:, self.mesh.edge]
        for contact in problem.contacts:
            in_zones[zones.index(contact)] = self._opposite(contact)
        return in_zones

    def _opposite(self, contact: str) -> BoolArray:
        """Which elements (m,) are opposite to the second body of a contact."""
        middles, of_edge = self.mesh.fractions[:, 1], self.mesh.edge
        opposite = np.zeros(len(of_edge), bool)
        for part in self.problem.opposite(contact):
            if part.edge in self.mesh.edge_names:
                own = of_edge == self.mesh.edge_names.index(part.edge)
                opposite |= own & (middles > part.low) & (middles < part.high)
        return opposite

    def elements_at(self, names: Sequence[str], edge: IntArray, fractions: Array) -> tuple[IntArray, Array]:
        """Element (k,) and local coordinate (k,) at fractions (k,) of edges, by their numbers (k,) in `names`."""
        element, mesh = np.zeros(len(edge), int), self.mesh
        for number, name in enumerate(names):
            on = edge == number
            if not on.any():
                continue
            own = indices(mesh.edge == mesh.edge_names.index(name))
            at = np.searchsorted(mesh.fractions[own, 2], fractions[on])
            element[on] = own[np.minimum(at, len(own) - 1)]
        first, middle, last = mesh.fractions[element].T
        xi = 2 * (fractions - first) / (last - first) - 1
        bend = 2 * (middle - (first + last) / 2) / (last - first)
        for _ in range(STEPS_BACK):
            xi = 2 * (fractions - first) / (last - first) - 1 - bend * (1 - xi**2)
        return element, np.clip(xi, -1.0, 1.0)

    def places(self, elements: IntArray, xi: Array) -> Places:
        """Places at the local coordinates ξ (k, q) of elements (k,)."""
        points = self._on_edges(elements, xi, Edge.points)
        return Places(points, -self._on_edges(elements, xi, Edge.normals))

    def _on_edges(self, elements: IntArray, xi: Array, values: Callable[[Edge, Array], Array]) -> Array:
        """Values (k, q, 2) of edges by fractions of their length, at local coordinates ξ (k, q) of elements (k,)."""
        number, (start, middle, end) = self.mesh.edge[elements], self.mesh.fractions[elements].T[..., None]
        along = start + (end - start) * (1 + xi) / 2
        along += (middle - (start + end) / 2) * (1 - xi * xi)  # not zero where an element faces one of another body
        along = np.minimum(np.maximum(along, start), end)
        result = np.empty((*xi.shape, 2))
        changes = (indices(number[1:] != number[:-1]) + 1).tolist()
        for first, last in pairwise([0, *changes, len(number)]) if len(number) else ():  # elements that follow another
            result[first:last] = values(self.edges[number[first]], along[first:last].ravel()).reshape(
                -1, xi.shape[1], 2
            )
        return result

    def sampled(self, elements: IntArray) -> Array:
        """Places (k, 17, 2) [L] of the samples of elements (k,)."""
        return self._at_samples(elements, Edge.points)

    def inward(self, elements: IntArray) -> Array:
        """Unit normals (k, 17, 2) into the body at the samples of elements (k,)."""
        return -self._at_samples(elements, Edge.normals)

    def _at_samples(self, elements: IntArray, values: Callable[[Edge, Array], Array]) -> Array:
        """Values (k, 17, 2) of edges at the samples of elements (k,), found when they are first asked for."""
        if values not in self._known_samples:
            self._known_samples[values] = np.empty((*self.local.shape, 2)), np.zeros(len(self.local), bool)
        found, known = self._known_samples[values]
        new = elements[~known[elements]]
        if len(new):
            found[new], known[new] = self._on_edges(new, self.local[new], values), True
        return found[elements]

    @cached_property
    def _known_samples(self) -> dict[Callable[[Edge, Array], Array], tuple[Array, BoolArray]]:
        """Values at the samples of all elements, and for which elements they are known."""
        return {}

    def held_nodes(self, surface: AnyShape) -> Faces:
        """Faces (N, 3) of a surface that hold all nodes."""
        for of, known in self._held_nodes:
            if of is surface:
                return known
        smooth = isinstance(surface, SmoothSurface)  # one face holds both sides, however the body is turned there
        held = surface.faces(self.mesh.nodes) if smooth else surface.faces(self.mesh.nodes, *self.sides)
        self._held_nodes.appendleft((surface, held))
        return held

    @cached_property
    def _held_nodes(self) -> deque[tuple[AnyShape, Faces]]:
        """Those that were asked for last: contact points have them, and many states on one mesh ask for the same."""
        return deque(maxlen=KEPT_SURFACES)

    def faces(self, surface: AnyShape, elements: IntArray) -> Faces:
        """Faces (k, 17) of a surface that hold the samples of elements (k,).

        At nodes they are those of contact points. Between them each place has the face to which it is turned.
        """
        return self._seen(surface, elements)[0]

    def opposite(self, surface: BodySurface, elements: IntArray) -> tuple[IntArray, Array]:
        """Element and local coordinate (17 k,) of the pairs of the samples of elements (k,) on an elastic body."""
        opposite = self._seen(surface, elements)[1]
        assert opposite is not None
        return self.elements_at([edge.name for edge in surface.edges], *opposite)

    def _seen(self, surface: AnyShape, elements: IntArray) -> tuple[Faces, OnEdges | None]:
        for of, at, known in self._known_faces:
            if of is surface and np.array_equal(at, elements):
                return known
        found = self._faces(surface, elements)
        self._known_faces.appendleft((surface, elements, found))
        return found

    @cached_property
    def _known_faces(self) -> deque[tuple[AnyShape, IntArray, tuple[Faces, OnEdges | None]]]:
        """Those that were asked for last: many states on one mesh ask for the same."""
        return deque(maxlen=KEPT)

    def _faces(self, surface: AnyShape, elements: IntArray) -> tuple[Faces, OnEdges | None]:
        """Faces (k, 17), and the pairs of the samples on an elastic body."""
        points, opposite = self.sampled(elements), None
        flat = points.reshape(-1, 2)
        if isinstance(surface, SmoothSurface):
            gap, normals = surface.held(flat)
            normals = normals.reshape(points.shape)
            return Faces(gap.reshape(points.shape[:-1]), normals, normals), None
        # nodes say where the body lies on a face
        inward, (beside, reach) = np.repeat(self.inward(elements).reshape(-1, 1, 2), 2, axis=1), self.sides
        before, turned, reach = len(reach), np.concatenate([beside, inward]), np.append(reach, np.zeros(len(flat)))
        flat = np.concatenate([self.mesh.nodes, flat])
        if isinstance(surface, BodySurface) and surface.elastic:
            pairs = surface.pairs(flat, turned[:, 0])
            held = surface.faces(flat, turned, reach, pairs)
            opposite = pairs.edge[before:], pairs.fraction[before:]
        else:
            held = surface.faces(flat, turned, reach)
        own = Faces(*(part[before:, 0].reshape(points.shape[:-1] + part.shape[2:]) for part in held))
        for part, at_nodes in zip(own, self.held_nodes(surface), strict=True):
            part[:, NODES] = at_nodes[self.mesh.elements[elements], [2, 0, 0]]
        return own, opposite

    @cached_property
    def sides(self) -> tuple[Array, Array]:
        """Normals (N, 2, 2) into the body before and after each node, and the distance (N,) [L] that is near to it.

        They are those of the edges themselves, and equal where these are smooth up to round-off.
        """
        before, halves, elements = self.mesh.before, self.mesh.halves, np.arange(len(self.mesh.elements))
        inward = -self._on_edges(elements, np.tile(reference_element.NODES, (len(elements), 1)), Edge.normals)
        ends = np.stack([inward[before, 2], inward[:, 0]], axis=1)
        smooth = np.hypot(*(ends[:, 1] - ends[:, 0]).T) < ROUGH
        ends[smooth] = ends[smooth, :1]
        middles = np.repeat(inward[:, 1, None], 2, axis=1)
        near = np.minimum(halves[before, 1], halves[:, 0])
        return np.concatenate([ends, middles]), np.concatenate([near, np.zeros(len(near))])


def _narrow_places(edge: Edge, surface: AnySurface, *, paired: bool) -> Iterable[float]:
    """Fractions of an edge where a surface may be narrow: where it is nearest, or has a corner.

    A spline, for which this takes long, is looked at from the edges alone that are `paired` with it.
    """
    if isinstance(surface, Polyline):
        return (corner.fraction for corner in surface_corners(edge, surface))
    if isinstance(surface, Circle | Plane) or (paired and isinstance(surface, Spline | BodySurface)):
        return nearest_places(edge.curve, surface)
    return ()
