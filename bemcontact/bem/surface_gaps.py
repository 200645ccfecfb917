"""Gaps between the deformed boundary and what it may touch, at any place of its elements.

An edge need not belong to the zone of a surface. Places are on the curves of the edges themselves; the displacement is
that of the elements.
"""

from collections.abc import Iterator, Sequence
from itertools import permutations
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray, indices, magnitudes, scalar_products
from bemcontact.bem import reference_element
from bemcontact.bem.body import Body
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.contact_points import ALIKE, SMOOTH
from bemcontact.bem.displaced_surfaces import DisplacedSurfaces
from bemcontact.bem.outline import NODES
from bemcontact.cached import cached_property
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen
from bemcontact.problems.body_surface import AnyShape, BodySurface
from bemcontact.problems.curves import cross
from bemcontact.problems.surface_lines import Closest, Faces, Polyline, Spline
from bemcontact.problems.way import AS_DRAWN

FLUSH = 1e-6
"""Distance of an undeformed place from a surface, over the size of the body, up to which it lies in the surface; and
difference of two unit normals up to which a surface is straight."""
SNUG = 0.01
"""Depth over the size of the body up to which it may be drawn inside a surface and fit it with interference: the strain
that small displacements may have. What is drawn deeper reaches behind the end of the surface."""
TURNED = 0.7
"""Cosine of the angle between the normals of body and surface up to which a place is turned to the surface."""
DIRECTIONS = np.stack([np.cos(angles := np.linspace(0.0, np.pi, 32, endpoint=False)), np.sin(angles)])
"""Directions (2, 32) in which the spread of displacements is measured."""
SAME_FACE = 0.98
"""Cosine of the angle between two normals of a surface up to which they belong to the same face."""
LARGEST_PART = 0.05
"""Part of a displacement that is excused as an error of linear theory, at most: that of a rotation by a tenth."""
BESIDE = 2.0
"""Distance from a crossing, over the motion, up to which a place on an edge that is not turned to the surface moves
into it because the edge crosses it: the angle between them is at least 45 degrees, and the root of two is enough."""
HALVINGS = 40
"""Halvings of the part of an element in which it crosses a surface."""
LITTLE = 1e-3
"""Motion over the size of the body up to which it is not told on which side of a corner a place comes to lie."""
MOST_BETWEEN = 1.25
"""Displacement between the nodes of an element over the largest one at them, at most: |N_1| + |N_2| + |N_3|."""
TOUCHES = 1e-6
"""Gap of a node, over the largest one of its element, up to which it touches: pressure keeps such nodes at zero."""


class FaceEnd(NamedTuple):
    """Where a straight face of a surface is taken to end: an edge beside the zone goes on in it and is not paired.

    A face has not ended where its own line has points further on, nor where it comes back under another edge of the
    zone; unless the edge beside the zone is in a zone of its own, or that other edge is: then there are two pads.

    Parameters
    ----------
    element : the first element beyond
    at : (2,) end of the zone [L]
    along : (2,) unit vector from there to the places beyond
    normal : (2,) of the face
    reach : length along which it is taken to have ended [L]: up to the next edge of the zone, or the end of the face
    of_zone : whether the zone itself ends there, not another one with the same face
    """

    element: int
    at: Array
    along: Array
    normal: Array
    reach: float
    of_zone: bool


class Crossing(NamedTuple):
    """Where an edge that is in no zone of a surface crosses it before anything moves.

    Places as near to it as one likes are outside then, and move into the surface if it does. So it is compared itself
    where the edge is turned to the surface: the mesh does not decide how near a sample is. Where the edge is not, as
    the side of a leg that reaches behind a floor, nothing is pressed there: the surface ends before it.

    Parameters
    ----------
    sample : row and column of the last sample outside
    local : local coordinate
    place : (2,) [L]
    depth : [L] after the motion
    turned : whether the edge is turned to the surface
    """

    sample: tuple[int, int]
    local: float
    place: Array
    depth: float
    turned: bool


class Intrusion(NamedTuple):
    """How deep elements are in a surface.

    Parameters
    ----------
    depth : (m,) [L], negative outside, minus infinity for an element that was not compared
    xi : (m,) local coordinate where an element is deepest
    behind : (m,) whether a place of an element that is not of the zone is behind the surface before anything moves, and
        does not fit it with interference
    excused : (m,) depth [L] that is no more than linear theory may be off, and is not in `depth`, likewise
    ends : where the surface is taken to end, with the depth [L] that places beyond would have in it if it went on
    """

    depth: Array
    xi: Array
    behind: BoolArray
    excused: Array
    ends: tuple[tuple[FaceEnd, float], ...]


@frozen
class SurfaceGaps(DisplacedSurfaces):
    """The deformed boundary of a body beside the displaced surfaces; parameters are those of these."""

    @cached_property
    def held(self) -> dict[str, Faces]:
        """Faces that hold the nodes (m, 3) of elements, by zone, as in contact."""
        return {name: self._holding(surface) for name, surface in self.surfaces.items()}

    def _holding(self, surface: AnyShape) -> Faces:
        """Faces of a surface that hold the nodes (m, 3) of elements."""
        elements = self.outline.mesh.elements
        return Faces(*(part[elements, [2, 0, 0]] for part in self.outline.held_nodes(surface)))

    @cached_property
    def paired(self) -> dict[str, BoolArray]:
        """By zone, whether each element (m,) belongs to it, or to another zone with the same face there and tool."""
        tools = {name: tool for tool, stated in self.problem.tools.items() for name in stated.zones}
        in_zones, names = self.outline.in_zones, [*self.problem.zones]
        paired = {name: in_zones[names.index(name)].copy() for name in self.surfaces}
        for zone, name in permutations(self.surfaces, 2):
            if tools.get(name) == tools.get(zone):
                own, held = self.held[zone], self.held[name]
                apart = magnitudes(held.normals - own.normals) > ALIKE
                apart |= abs(held.gap - own.gap) > ALIKE * self.size
                paired[zone] |= in_zones[names.index(name)] & ~apart.any(axis=1)
        return paired

    def linear(self, zone: str, elements: IntArray) -> Faces:
        """Gap (k, q) [L] of elements (k,) as contact sees it, ε + n·(u - w), with the normals n of contact."""
        surface, outline, moved = self.surfaces[zone], self.outline, self._displacement[elements]
        held = outline.faces(surface, elements)
        if isinstance(surface, BodySurface) and surface.elastic:
            moved = moved - self.motion_at(*outline.opposite(surface, elements)).reshape(moved.shape)
        elif self.way_of_tool(zone) != AS_DRAWN:
            moved = moved - self.tool_motion(zone, outline.sampled(elements))
        return held._replace(gap=held.gap + scalar_products(held.normals, moved))

    def _against(self, zone: str, elements: IntArray) -> Array:
        """Displacement (k, q, 2) [L] of elements (k,) beside that of the surface, where they come to touch it."""
        surface, places = self.surfaces[zone], self.outline.sampled(elements)
        way = surface.approach.step if isinstance(surface, BodySurface) and surface.elastic else np.zeros(2)
        return self._displacement[elements] - self.tool_motion(zone, places - way)

    def distance(self, zone: str, elements: IntArray) -> Array:
        """Distance (k, q) [L] of displaced places of elements (k,) from the displaced surface."""
        return self.exact(zone, self.moved(elements)).gap

    def moved(self, elements: IntArray) -> Array:
        """Displaced places (k, q, 2) [L] of elements (k,)."""
        return self.outline.sampled(elements) + self._displacement[elements]

    def intrusion(self, zone: str) -> Intrusion:
        """How deep each element is in the surface of a zone, beyond what interpolation between its nodes explains.

        In elements of the zone this is the gap as contact sees it; where another face of the surface is nearer to the
        displaced place than the face that holds it, it is the distance, as for all other elements. A place of these
        that is behind the surface before anything moves does not count unless it fits it with interference, nor does
        one opposite to which the surface is taken to have ended.
        """
        paired = self.paired[zone]
        m, ends = len(paired), self._ends(zone, paired)
        depth, xi, behind, hidden = np.full(m, -np.inf), np.zeros(m), np.zeros(m, bool), [-np.inf] * len(ends)
        of_zone, others = indices(paired), self.near(zone, indices(~paired & self._may_meet(zone)))
        elements, own = np.concatenate([of_zone, others]), len(of_zone)
        moved, local = self.moved(elements), self.outline.local[elements]
        there = self.exact(zone, moved[:own] if isinstance(self.surfaces[zone], BodySurface) else moved)
        depths = np.empty(local.shape)
        depths[:own] = self._depth_in_own(zone, of_zone, Closest(there.gap[:own], there.normals[:own]))
        if len(others):
            found = self._depth_in_other(zone, others, there.gap[own:], ends)
            depths[own:], behind[others], hidden, local[own:] = found
            if (depths[own:] > 0).any():
                depths[own:][self._beside_corner(zone, others)] = -np.inf
        deepest = np.arange(len(elements)), depths.argmax(axis=1)
        depth[elements], xi[elements] = depths[deepest], local[deepest]
        excused = ~paired & (depth > 0)
        excused = excused & (depth <= self.second_order(zone)) if excused.any() else excused
        return Intrusion(
            depth=np.where(excused, -np.inf, depth), xi=xi, behind=behind, excused=np.where(excused, depth, -np.inf),
            ends=tuple(zip(ends, hidden, strict=True)),
        )  # fmt: skip

    def _depth_in_own(self, zone: str, elements: IntArray, there: Closest) -> Array:
        """Depth (k, q) [L] of elements (k,) of the zone, `there` after the motion."""
        here = self.linear(zone, elements)
        nodes = np.maximum(here.gap[:, None, NODES], 0.0)
        # where no node touches, what dips was not seen, and is no contact
        touching = nodes.min(axis=2) <= TOUCHES * nodes.max(axis=2)
        shapes = self.outline.shapes[elements]
        if isinstance(self.surfaces[zone], Polyline):
            shapes = shapes * (np.einsum("kqi,kni->kqn", here.faces, here.faces[:, NODES]) > SAME_FACE)
        dip = np.maximum(-(shapes @ nodes.transpose(0, 2, 1))[..., 0], 0.0) * touching
        depth, beyond = -here.gap - dip, scalar_products(here.faces, there.normals) < SAME_FACE
        if beyond.any() and (beyond := beyond & (-there.gap > self.second_order(zone))).any():
            beyond &= ~(self._beside_corner(zone, elements) | self._beside_own_corner(zone, elements))
            depth = np.maximum(depth, np.where(beyond, -there.gap, -np.inf))
        return depth

    def _beside_corner(self, zone: str, elements: IntArray) -> BoolArray:
        """Whether places (k, q) of elements (k,) are nearer to a corner of a surface than they move, which is little.

        Linear theory leaves open on which side of the corner they come to lie: at a tip, where strains are infinite,
        places move against each other by more than their distance from it. Those beside a convex corner of a body,
        where pairs end, slide along the end however far they move; `placement` judges this.
        """
        places, surface = self.outline.sampled(elements), self.surfaces[zone]
        beside = np.zeros(places.shape[:-1], bool)
        if not isinstance(surface, Polyline | BodySurface):
            return beside
        moved = magnitudes(self._against(zone, elements))
        for corner in surface.points if isinstance(surface, Polyline) else surface.ridges:
            beside |= magnitudes(places - corner) <= moved
        if isinstance(surface, Polyline):
            return beside & (moved <= LITTLE * self.size)
        return beside | self.beside_groove(zone, places, moved)

    def _beside_own_corner(self, zone: str, elements: IntArray) -> BoolArray:
        """Whether places (k, q) are nearer than they move to a convex corner of their body inside the zone.

        There they are judged on the other face.
        """
        mesh, paired, places = self.outline.mesh, self.paired[zone], self.outline.sampled(elements)
        corners, beside = paired & paired[mesh.before] & (mesh.turns < -SMOOTH), np.zeros(places.shape[:-1], bool)
        if not corners.any():
            return beside
        moved = magnitudes(self._against(zone, elements))
        for corner in indices(corners):
            beside |= magnitudes(places - mesh.nodes[corner]) <= moved
        return beside

    def beside_groove(self, zone: str, places: Array, moved: Array) -> BoolArray:
        """Whether a little motion (...) [L] takes places (...) in a concave corner of a body to its other face."""
        surface = self.surfaces[zone]
        if not isinstance(surface, BodySurface):
            return np.zeros(moved.shape, bool)
        return (moved <= LITTLE * self.size) & surface.beside_groove(places, moved)

    def _depth_in_other(
        self, zone: str, elements: IntArray, after: Array, ends: Sequence[FaceEnd]
    ) -> tuple[Array, BoolArray, list[float], Array]:
        """Depth (k, q) [L] of elements (k,) not of the zone at local coordinates (k, q).

        Also whether each is behind, and the depth beyond each end; the local coordinates come last. `after` (k, q) [L]
        is the distance from the surface after the motion; that from a body is found here, from the one before.
        """
        flush, places, surface = FLUSH * self.size, self.outline.sampled(elements), self.surfaces[zone]
        before, normals = self.undeformed(zone, places)
        outside, turned = np.ones((2, *before.shape), bool)
        behind, crossings = np.zeros(len(elements), bool), ()
        if (before < -flush).any():
            turned = scalar_products(self.outline.inward(elements), normals) > TURNED
            snug, mesh = self._fits(zone, elements, before, turned)[:, None], self.outline.mesh
            behind = np.any((before < -flush) & ~snug, axis=1)
            here = self._mask(elements[behind])
            crosses = (here | here[mesh.before] | here[mesh.elements[:, 2]])[elements, None]
            outside = (before > flush) | snug | (~crosses & (before >= -flush))
            crossings = self._crossings(zone, elements, np.where(snug, np.inf, before), crosses, flush)
        if isinstance(surface, BodySurface):  # linear: beside an end of contact places slide along it
            against = self._against(zone, elements)
            after = before + scalar_products(self._normals_beside_end(zone, places, against, normals), against)
            if (after < 0).any():
                outside &= ~self._slides(zone, surface, places)
        depth, local = np.where(outside, -after, -np.inf), self.outline.local[elements]
        for crossing in crossings:
            if crossing.turned:
                depth[crossing.sample] = max(depth[crossing.sample], crossing.depth)
                local[crossing.sample] = crossing.local
            else:
                away = magnitudes(places - crossing.place)
                moved = magnitudes(self._against(zone, elements))
                depth[~turned & (away <= BESIDE * moved)] = -np.inf
        if not ends:
            return depth, behind, [], local
        ended = [_opposite(end, places - before[..., None] * normals, normals, flush) for end in ends]
        sure = depth > self.second_order(zone)
        hidden = [float(np.max(depth, initial=-np.inf, where=beyond & sure)) for beyond in ended]
        return np.where(np.any(ended, axis=0), -np.inf, depth), behind, hidden, local

    def _normals_beside_end(self, zone: str, places: Array, motion: Array, normals: Array) -> Array:
        """Normals (k, q, 2) along which places beside the zone move into another elastic body.

        Where the zone ends at a corner, places that are nearer to it than they slide have the normal of contact at the
        corner: along another one the gap of the corner itself would not be zero when it touches.
        """
        surface, paired, mesh = self.surfaces[zone], self.paired[zone], self.outline.mesh
        if not (isinstance(surface, BodySurface) and surface.elastic):
            return normals
        result = normals.copy()
        for last, neighbor in ((2, mesh.elements[:, 2]), (0, mesh.before)):
            for own in indices(paired & ~paired[neighbor]).tolist():
                corner = self.state.points[own, last]
                normal = self.outline.held_nodes(surface).normals[mesh.elements[own, last], 2 - last]
                slides = abs(cross(normal, motion))
                result[magnitudes(places - corner) <= slides] = normal
        return result

    def _slides(self, zone: str, surface: BodySurface, places: Array) -> BoolArray:
        """Whether a corner is nearest to places (k, q, 2), and pairs that end there are compared in their place.

        Its distance would count along the boundary, which slides. A corner of an elastic body has a node of its own.
        """
        feet = surface.feet(places.reshape(-1, 2))
        beside = feet.at_corner
        if not surface.elastic and beside.any():
            nodes = self.state.points[self.paired[zone]].reshape(-1, 2)
            paired = surface.feet(nodes).points
            corners, which = np.unique(feet.points[beside], axis=0, return_inverse=True)
            away = magnitudes(corners[:, None] - paired).min(axis=1, initial=np.inf)
            beside[beside] = (away <= FLUSH * self.size)[which.ravel()]
        return beside.reshape(places.shape[:-1])

    def _crossings(
        self, zone: str, elements: IntArray, before: Array, crosses: BoolArray, flush: float
    ) -> Iterator[Crossing]:
        """Where edges cross the surface, on elements (k,), by the last sample outside.

        `before` (k, q) is the distance [L] of the samples from the undisplaced surface, and `crosses` (k, 1) whether an
        element or its neighbor is behind it.
        """
        local = self.outline.local[elements]
        for step in (1, -1) if crosses.any() else ():
            beyond = np.roll(before, -step, axis=1)
            beyond[:, -1 if step > 0 else 0] = np.inf
            for row, column in np.argwhere(crosses & (before > flush) & (beyond <= flush)).tolist():
                element, outside, inside = elements[[row]], local[row, column], local[row, column + step]
                for _ in range(HALVINGS):
                    middle = (outside + inside) / 2
                    place = self.outline.places(element, np.array([[middle]])).points
                    outside, inside = (middle, inside) if self.undeformed(zone, place).gap > 0 else (outside, middle)
                at = self.outline.places(element, np.array([[outside]]))
                motion = reference_element.values(np.array([outside])) @ self.state.displacement[element]
                turned = np.sum(at.inward * self.undeformed(zone, at.points).normals) > TURNED
                depth = -float(self.exact(zone, at.points + motion).gap[0, 0])
                yield Crossing((row, column), float(outside), at.points[0, 0], depth, bool(turned))

    def _fits(self, zone: str, elements: IntArray, before: Array, turned: BoolArray) -> BoolArray:
        """Whether each element (k,) is on a stretch that fits the surface with interference.

        Such a stretch lies behind the surface. It is nowhere deep and faces it somewhere, or it begins at an edge of
        the zone. `before` (k, q) is the distance [L] of places from the surface, and `turned` (k, q) says whether they
        face it.
        """
        size, mesh, paired = self.size, self.outline.mesh, self.paired[zone]
        inside = before < -FLUSH * size
        behind = elements[inside.any(axis=1)]
        deep = self._marked(elements[(before < -SNUG * size).any(axis=1)], behind)
        faces = self._marked(elements[(inside & turned).any(axis=1)], behind)
        beside = (inside[:, 0] & paired[mesh.before[elements]]) | (inside[:, -1] & paired[mesh.elements[elements, 2]])
        return ((faces & ~deep) | self._marked(elements[beside], behind))[elements]

    def _marked(self, marked: IntArray, over: IntArray) -> BoolArray:
        """Mark (m,) all elements of the unbroken stretches of some elements in which one is marked."""
        mesh, found, allowed = self.outline.mesh, self._mask(marked), self._mask(over)
        while (more := allowed & ~found & (found[mesh.before] | found[mesh.elements[:, 2]])).any():
            found |= more
        return found

    def _mask(self, elements: IntArray) -> BoolArray:
        """Which of all elements (m,) these are."""
        mask = np.zeros(len(self.outline.mesh.elements), bool)
        mask[elements] = True
        return mask

    def _ends(self, zone: str, paired: BoolArray) -> list[FaceEnd]:
        """Where the surface is taken to end: its straight face as drawn goes on along the edge beyond the zone."""
        mesh, ends, surface = self.outline.mesh, list[FaceEnd](), self.surfaces[zone]
        elastic = isinstance(surface, BodySurface) and surface.elastic
        as_drawn = elastic or surface.way == AS_DRAWN
        drawn = self.outline.held_nodes(surface if as_drawn else surface.after(AS_DRAWN))
        for last, neighbor in ((2, mesh.elements[:, 2]), (0, mesh.before)):
            for own in indices(paired & ~paired[neighbor]).tolist():
                beyond, at, held = (
                    int(neighbor[own]),
                    self.state.points[own, last],
                    (mesh.elements[own, last], 2 - last),
                )
                normal = drawn.normals[held]
                if self._lies_in_face(zone, np.array([own, beyond]), at, normal):
                    along = self.state.points[beyond, last] - at
                    along = along / np.hypot(*along)
                    foot = at - drawn.gap[held] * normal
                    ahead = min(map(float, self._ahead(zone, paired, foot, along, normal)), default=np.inf)
                    apart = self._between_zones(zone, paired, own, neighbor, normal)
                    if ahead == np.inf or apart or self.in_a_zone(beyond):
                        ends.append(FaceEnd(beyond, foot, along, normal, ahead, zone in self._zones_of(own)))
        return ends

    def _between_zones(self, zone: str, paired: BoolArray, own: int, neighbor: IntArray, normal: Array) -> bool:
        """Whether the boundary goes on straight from the last element of a zone to an edge of another one: two pads."""
        run, element = list[int](), int(neighbor[own])
        while not paired[element]:
            run.append(element)
            element = int(neighbor[element])
        apart = self._zones_of(own).isdisjoint(self._zones_of(element))
        return apart and self._lies_in_face(zone, np.array(run), self.state.points[own, 1], normal)

    def _zones_of(self, element: int) -> set[str]:
        """Names of the zones that the edge of an element is in."""
        edge = self.state.edge_names[self.state.edge[element]]
        return {zone for zone in self.problem.zones if edge in self.problem.edges_of(zone)}

    def in_a_zone(self, element: int) -> bool:
        """Whether the edge of an element is in any zone."""
        return bool(self._zones_of(element))

    def _lies_in_face(self, zone: str, elements: IntArray, at: Array, normal: Array) -> bool:
        """Whether elements (k,) are on the line through a point (2,) with the normal (2,) of the face.

        The line is the straight face itself, or is drawn inside it: then they fit with interference.
        """
        flush = FLUSH * self.size
        if np.abs((self.state.points[elements] - at) @ normal).max() > 2 * flush:
            return False  # nodes are among the samples, up to round-off
        places = self.outline.sampled(elements)
        gap, normals = self.undeformed(zone, places)
        straight = np.abs(normals - normal)[:, 1:-1].max() <= FLUSH  # at its ends there may be a corner of the surface
        return bool(straight and gap.max() <= flush and np.abs((places - at) @ normal).max() <= flush)

    def _ahead(self, zone: str, paired: BoolArray, at: Array, along: Array, normal: Array) -> Iterator[float]:
        """Distances [L] from an end of the zone to its next edges on the same line, and to points of the surface."""
        flush, surface = FLUSH * self.size, self.surfaces[zone]
        of_zone = self.outline.sampled(indices(paired)).reshape(-1, 2)
        gap, normals = self.undeformed(zone, of_zone)
        points = (of_zone - gap[:, None] * normals)[gap <= flush]
        if isinstance(surface, Polyline | Spline):
            points = np.concatenate([points, np.array(surface.points)])
        there = points[np.abs((points - at) @ normal) <= flush]
        distances = (there - at) @ along
        yield from distances[distances > flush]

    @cached_property
    def _displacement(self) -> Array:
        """Displacement (m, q, 2) [L] at the samples of all elements."""
        return self.outline.interpolated(self.state.displacement)

    @cached_property
    def largest(self) -> float:
        """Largest displacement of a node [L]."""
        return float(magnitudes(self.state.displacement).max())

    @cached_property
    def _spread(self) -> float:
        """Largest difference of the displacements of two places [L]: translations do not count."""
        return float(np.ptp(self.state.displacement.reshape(-1, 2) @ DIRECTIONS, axis=0).max())

    def second_order(self, zone: str) -> float:
        """Depth [L] by which linear theory may be off: (difference of displacements)² over the size of the body.

        It is a part of that difference, and no more than `LARGEST_PART`: what is deeper can be seen.
        """
        # only rotations and strains cause differences; translations are exact in linear theory
        size = self.size
        turns = [abs(self.tools[name][2]) for name, tool in self.problem.tools.items() if zone in tool.zones]
        return float(
            sum(min(moved / size, LARGEST_PART) * moved for moved in (self._spread, *(turn * size for turn in turns)))
        )

    def _may_meet(self, zone: str) -> BoolArray:
        """Whether each element (m,) is compared with a surface: of a contact of two bodies those of the first alone.

        Where both sides are on one body, the edges of the first side alone. Elements that are bonded to the second body
        move with it, and those that face this surface in another contact of both bodies are compared there.
        """
        mesh, surface = self.outline.mesh, self.surfaces[zone]
        if not isinstance(surface, BodySurface):
            return np.ones(len(mesh.elements), bool)
        edges = self.problem.edges_of(zone)
        first = self.problem.part_of(edges[0])
        if first == surface.body:
            return np.isin(mesh.edge_names, edges)[mesh.edge]
        of_first = np.array([self.problem.part_of(name) == first for name in mesh.edge_names])
        return of_first[mesh.edge] & ~self._bonded_to(surface.body) & ~self._faces_elsewhere(zone, surface)

    def _faces_elsewhere(self, zone: str, surface: BodySurface) -> BoolArray:
        """Whether each element (m,) faces an edge of this surface in another contact of both bodies, on either side."""
        mesh, problem = self.outline.mesh, self.problem
        of_surface = np.isin(mesh.edge_names, [edge.name for edge in surface.edges])[mesh.edge]
        elsewhere = np.zeros(len(mesh.elements), bool)
        for contact in problem.contacts:
            if contact != zone and {*problem.sides_of(contact)} == {*problem.sides_of(zone)}:
                across = mesh.across([contact])
                elsewhere |= (across >= 0) & of_surface[across]
        return elsewhere

    def _bonded_to(self, body: str) -> BoolArray:
        """Whether each element (m,) is bonded to a body."""
        mesh = self.outline.mesh
        bonded = np.zeros(len(mesh.elements), bool)
        for bond in self.problem.bonded:
            if body in (sides := self.problem.sides_of(bond)):
                facing, own = mesh.facing[bond], indices(mesh.facing[bond] >= 0)
                bonded[own if sides[1] == body else facing[own]] = True
        return bonded

    def near(self, zone: str, elements: IntArray) -> IntArray:
        """Those of elements (k,) that may touch a surface: no place is farther from their middle than their length.

        Both as drawn and after the motion. The gap changes by no more than places move beside the surface.
        """
        if not len(elements):
            return elements
        drawn, surface = self.state.points[elements], self.surfaces[zone]
        moved = drawn + self.state.displacement[elements]
        length, after = (magnitudes(places[:, 1:] - places[:, :-1]).sum(axis=1) for places in (drawn, moved))
        gap = self.undeformed(zone, drawn[:, 1]).gap
        near = gap <= length
        if isinstance(surface, BodySurface):
            gap = gap if surface.continued is surface else surface.continued.closest(drawn[:, 1]).gap
        shift = magnitudes(self.way_of_tool(zone).back(moved[:, 1]) - drawn[:, 1])
        if isinstance(surface, BodySurface) and surface.elastic:
            shift += MOST_BETWEEN * self.largest
        unsure = indices(~near & (gap <= after + shift))
        if len(unsure):
            near[unsure] = self.exact(zone, moved[unsure, 1]).gap <= after[unsure]
        return elements[near]


def surface_gaps(body: Body, state: BoundaryState, contact: CondensedContact, solution: ContactSolution) -> SurfaceGaps:
    """Compare the deformed boundary of a solution with the surfaces, where its tools have moved them."""
    moved = contact.tools.displacement(solution.rigid_amplitudes)
    tools = dict(zip(contact.tools.names, moved, strict=True))
    return SurfaceGaps(problem=body.problem, outline=body.outline, state=state, tools=tools)


def _opposite(end: FaceEnd, feet: Array, normals: Array, flush: float) -> BoolArray:
    """Whether feet (..., 2) [L] on a surface with normals (..., 2) are beyond the end of the surface."""
    offset = feet - end.at
    along = offset @ end.along
    on = (np.abs(offset @ end.normal) <= flush) & (np.abs(normals - end.normal).max(axis=-1) <= FLUSH)
    return on & (along >= -flush) & (along <= end.reach + flush)
