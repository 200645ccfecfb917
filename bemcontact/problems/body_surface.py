"""The boundary of a body as the surface that another body touches."""

from collections.abc import Iterable, Sequence
from dataclasses import field, replace
from itertools import chain, permutations
from typing import ClassVar, NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray, magnitudes
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen
from bemcontact.problems.curves import Curve, Edge, Segment, cross, inner
from bemcontact.problems.edge_places import (
    CORNER,
    STEEPEST,
    TIE,
    EdgePlaces,
    NormalWeight,
    bent_joints,
    curvatures,
    nearest_on,
    nearest_points,
    normals_at,
    paired_on,
    places_along,
)
from bemcontact.problems.rigid_surface import RigidSurface, Shape
from bemcontact.problems.surface_lines import (
    Closest,
    Faces,
    between_normals,
    is_tilted,
    pressed_normals,
    ridge_beside,
    sees_ridge,
)
from bemcontact.problems.way import AS_DRAWN, Way

AT_END = 1e-9
"""Sine of the angle between the way to the end of an edge and the normal there from which the end itself is nearest."""
ON_CORNER = 1e-9
"""Distance from a corner over the extent of the points up to which a point is on it."""
ROUND_OFF = 1e-9
"""Difference of two fractions of an edge that is none: places on the normal at an end may be on either side of it.

Likewise a distance over the length of the longest edge.
"""
WIDEST = 2.0
"""Distance of a pair from the nearest place, over that of the point, up to which it is taken: others are elsewhere."""


class Joint(NamedTuple):
    """A corner between two edges of a surface.

    Parameters
    ----------
    point : (2,) [L]
    normals : (2, 2) of both edges there, out of the body
    edges : their numbers in the surface
    """

    point: Array
    normals: Array
    edges: tuple[int, int]

    @property
    def convex(self) -> bool:
        """Whether the body is convex there."""
        return bool(cross(self.normals[0], self.normals[1]) > 0)


class Feet(NamedTuple):
    """Places of a surface that are nearest to points.

    Parameters
    ----------
    edge : (k,) number of the edge
    fraction : (k,) of its length
    points : (k, 2) [L]
    gap : (k,) distance as drawn [L], negative inside the body
    normals : (k, 2) unit vectors out of the body
    corner : (k,) whether it is a corner or an end of the surface, and the point is on the normal of no edge there
    at_corner : (k,) whether it is a corner or an end of the surface, so that other points have it too
    """

    edge: IntArray
    fraction: Array
    points: Array
    gap: Array
    normals: Array
    corner: BoolArray
    at_corner: BoolArray


@frozen
class BodySurface:
    """Some or all edges of a body, as the surface that another body touches.

    Between two elastic bodies, gap and pressure count along a common normal. Where the bodies meet, both are deformed:
    each turns its boundary in proportion to its compliance. So the normal that they come to have is between those of
    both, nearer to that of the stiffer one. It stays the same if the sides are exchanged.

    Parameters
    ----------
    body : its name
    elastic : whether it is elastic
    edges : that may be touched, with their names in the problem
    loops : all loops of the body
    offset : what is added to the gap as drawn [L]
    share : part that the first side has in common normals: its modulus E / (1 - ν²) over the sum of both; 1 or 0 where
        a body with round edges lies on the flat first or second side, along which it may slide
    first : edges of the first side where it has such a part
    first_loops : all loops of that body
    approach : motion of this body that makes it touch them; pairs, or the faces of a rigid body, are those after it
    nearest : fractions of curves where they are nearest to it after a way, as far as they were looked for
    """

    kind: ClassVar[str] = "body"
    body: str
    elastic: bool
    edges: tuple[Edge, ...]
    loops: tuple[tuple[Edge, ...], ...]
    offset: float = 0.0
    share: float = 0.0
    first: tuple[Edge, ...] = ()
    first_loops: tuple[tuple[Edge, ...], ...] = ()
    approach: Way = AS_DRAWN
    nearest: dict[tuple[Curve, Way], tuple[float, ...]] = field(default_factory=dict)

    @cached_property
    def _ends(self) -> tuple[Array, BoolArray]:
        """Sums (e, 2, 2) of the normals at both joints of each edge, and whether (e, 2) each is a corner or an end."""
        sums, corners = [], []
        names = {edge.name for edge in self.edges}
        for edge, before, after in _neighbors(self.loops):
            if edge.name in names:
                own = edge.normals(np.array([0.0, 1.0]))
                others = np.stack([before.normals(np.ones(1))[0], after.normals(np.zeros(1))[0]])
                sums.append(own + others)
                sharp = (abs(cross(own, others)) > CORNER) | (np.sum(own * others, axis=1) < 0)
                corners.append(sharp | np.array([other.name not in names for other in (before, after)]))
        return np.array(sums), np.array(corners)

    @property
    def way(self) -> Way:
        """The `approach` of a rigid body; none of an elastic one, of which pairs alone are after it."""
        return AS_DRAWN if self.elastic else self.approach

    def after(self, approach: Way) -> "BodySurface":
        """The surface after another motion of its body."""
        return replace(self, approach=approach)

    @cached_property
    def other_side(self) -> "BodySurface":
        """The boundary of the first of two elastic bodies, as the surface that this one touches."""
        return BodySurface(body="", elastic=True, edges=self.first, loops=self.first_loops, offset=self.offset)

    def nearest_to(self, points: Array) -> tuple[IntArray, Array]:
        """Number (k,) of the edge that is nearest to points (k, 2) [L], and the fraction (k,) of its length."""
        return nearest_points(self.edges, points)[:2]

    def feet(self, points: Array) -> Feet:
        """Places that are nearest to points (k, 2) [L]."""
        points = np.asarray(points, float)
        number, fraction, foot, normals = nearest_on(self.edges, points)
        offset, (sums, corners) = points - foot, self._ends
        away = np.hypot(*offset.T)
        corner, at_corner = np.zeros((2, len(points)), bool)
        flush = ROUND_OFF * max(edge.length for edge in self.edges)
        for end in (0, 1):
            at_corner |= (abs(fraction - end) <= ROUND_OFF) & corners[number, end]
            at = np.flatnonzero((fraction == end) & corners[number, end])
            if not len(at):
                continue
            tilted = abs(cross(offset[at], normals[at])) > AT_END * away[at]
            at = at[tilted & (away[at] > flush)]
            outward = inner(offset[at], sums[number[at], end])
            behind = outward < -AT_END * away[at]  # straight on from an end is not inside
            behind[behind] = ~self._outside(points[at[behind]])
            side = np.where(behind, -1.0, 1.0)
            normals[at], corner[at] = side[:, None] * offset[at] / away[at, None], True
        return Feet(number, fraction, foot, inner(offset, normals), normals, corner, at_corner)

    def _outside(self, points: Array) -> BoolArray:
        """Whether points (k, 2) are outside the body, for an end of some of its edges does not tell."""
        if not len(points) or len(self.edges) == len(self._whole.edges):
            return np.zeros(len(points), bool)
        return self._whole.feet(points).gap > 0

    @cached_property
    def _whole(self) -> "BodySurface":
        """The surface with all edges of the body."""
        return replace(self, edges=tuple(chain.from_iterable(self.loops)), nearest={})

    def pairs(self, points: Array, inward: Array | None = None) -> Feet:
        """Places that form pairs with points (k, 2) [L] of the first side, and the common normals there.

        `inward` (k, 2) are the normals into the first body, which has two at its corners: those of the nearest edge if
        they are not stated.

        Points are on the common normals of their pairs, so that the forces on both bodies have no moment together.
        Pairs of a rigid body are the nearest places. A point whose pair is too far away has it as a corner, for the end
        of a part may be there up to round-off. One without a pair, or beside the first side, so has the nearest place.
        """
        if not self.first:
            return self.feet(points)
        moved, points = self.approach.step, np.asarray(points, float)
        first, points = nearest_on(self.first, points), points - moved
        own_normals = -first.normals if inward is None else inward
        feet = self.feet(points)
        flush = ROUND_OFF * max(edge.length for edge in (*self.first, *self.edges))
        on_first = magnitudes(points + moved - first.points) <= flush
        start, away = self._facing(points, own_normals, feet)
        at = np.flatnonzero(on_first & (inner(own_normals, start.normals) > 0))
        nearest = EdgePlaces(start.edge[at], start.fraction[at], start.points[at], start.normals[at])
        places, normals, paired = paired_on(self.edges, nearest, points[at], own_normals[at], self._weights)
        at = at[paired]
        gap, beside = inner(points[at] - places.points, normals), places.points - start.points[at]
        near = magnitudes(beside) <= WIDEST * (abs(away[at]) + flush)
        firsts = EdgePlaces(first.edge[at], first.fraction[at], first.points[at], first.normals[at])
        own, other = curvatures(self.first, firsts), curvatures(self.edges, places)
        near &= inner(own_normals[at], places.normals) > STEEPEST + TIE
        # otherwise common normals cross on the way
        near &= (1 + self.share * own * gap > 0) & (1 + (1 - self.share) * other * gap > 0)
        edge, fraction, foot = feet.edge.copy(), feet.fraction.copy(), feet.points.copy()
        edge[at], fraction[at], foot[at] = places.edge, places.fraction, places.points
        common, distance, corner = feet.normals.copy(), feet.gap.copy(), np.ones(len(points), bool)
        common[at], distance[at], corner[at] = normals, gap, ~near
        return Feet(edge, fraction, foot, distance + common @ moved, common, corner, feet.at_corner)

    def _facing(self, points: Array, inward: Array, feet: Feet) -> tuple[EdgePlaces, Array]:
        """Places near to the pairs of points (k, 2), and the distances (k,) as drawn [L].

        They are the feet, but in a concave corner the nearest place may be on the face beside the points: then it is
        the nearest one of those that face the normals `inward` (k, 2) into the body of the points, if there is any.
        """
        edge, fraction, gap, places = feet.edge.copy(), feet.fraction.copy(), feet.gap.copy(), feet.points.copy()
        normals, corner = feet.normals.copy(), feet.corner
        normals[corner] = normals_at(self.edges, edge[corner], fraction[corner])
        astray = np.flatnonzero(inner(inward, normals) <= TIE)
        least = np.full(len(astray), np.inf)
        for number in range(len(self.edges) if len(astray) else 0):
            there = nearest_on(self.edges[number : number + 1], points[astray])
            offset = points[astray] - there.points
            nearer = (np.sum(inward[astray] * there.normals, axis=1) > STEEPEST + TIE) & (np.hypot(*offset.T) < least)
            at, least = astray[nearer], np.where(nearer, np.hypot(*offset.T), least)
            edge[at], fraction[at], places[at] = number, there.fraction[nearer], there.points[nearer]
            normals[at], gap[at] = there.normals[nearer], np.sum(offset * there.normals, axis=1)[nearer]
        return EdgePlaces(edge, fraction, places, normals), gap

    def seen_from(self, edge: Edge) -> Array:
        """Fractions of an edge of the first side inside it, at the pairs of the ends and inner places of all edges.

        A part of it that is opposite to an edge of this body lies between them, however narrow it is. Where an end
        forms no pair, and beside it, so are the nearest places.
        """
        places, moved = places_along(self.edges), self.approach.step
        there = edge.curve.nearest(places.points + moved)
        start = EdgePlaces(np.zeros(len(there), int), there, places.points + moved, places.normals)
        shift, (own, other) = np.array([*self.approach.step, 0.0]), self._weights
        weights = NormalWeight(other.most, other.corners + shift), NormalWeight(own.most, own.corners + shift)
        pairs, _, _ = paired_on((edge,), start, start.points, -places.normals, weights)
        return np.concatenate([there, pairs.fraction])

    @cached_property
    def _weights(self) -> tuple[NormalWeight, NormalWeight]:
        """Weights of the normals of both sides in common ones, the first one moved towards this body as it is drawn."""
        if not self.first:
            return NormalWeight(self.share, np.zeros((0, 3))), NormalWeight(1 - self.share, np.zeros((0, 3)))
        own = bent_joints(self.first, self.edges) - np.array([*self.approach.step, 0.0])
        return NormalWeight(self.share, own), NormalWeight(1 - self.share, bent_joints(self.edges, self.first))

    def beside(self, feet: Feet) -> Array:
        """Normals (k, 2, 2) out of the body on both sides of places that are corners, of others twice their own."""
        normals = np.repeat(feet.normals[:, None], 2, axis=1)
        for i in np.flatnonzero(feet.corner).tolist():
            number, end = feet.edge[i], int(feet.fraction[i] > 0.5)
            own = self.edges[number].normals(np.array([float(end)]))[0]
            normals[i] = own, self._ends[0][number, end] - own
        return normals

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L]; the gap has the offset."""
        feet = self.feet(points)
        return Closest(feet.gap + self.offset, feet.normals)

    def faces(self, points: Array, inward: Array, reach: Array, pairs: Feet | None = None) -> Faces:
        """Find the faces that hold points (k, 2) [L], as of `LineSurface`; `pairs` with them, if these are known.

        A point on a corner of this body has the edge to which each side of it, with normals (k, 2, 2) into its own
        body, is turned. So has a corner of the other body that stands in a concave one, up to the distance `reach`
        (k,) [L]. A convex corner presses on a smooth boundary along its normal, as far as that is between the normals
        of the edges.
        """
        way, displaced = self.way, points
        points, inward = way.back(points), way.turned(inward, -1.0)
        pairs = pairs or self.pairs(points, inward[:, 0])
        gap, normals = (np.repeat(part[:, None], 3, axis=1) for part in (pairs.gap + self.offset, pairs.normals))
        turns = abs(cross(inward[:, 0], inward[:, 1])) > CORNER
        after = self.pairs(points[turns], inward[turns, 1])
        gap[turns, 2], normals[turns, 2] = after.gap + self.offset, after.normals
        held = Faces(gap, normals, normals.copy())
        near = ON_CORNER * max(np.ptp(part) for part in points.T)
        if not self.elastic:
            self._press_on_ridges(points, inward, pairs, held)
        for corner in self.joints:
            joint, own, far = corner.point, corner.normals, 0.0 if corner.convex else reach
            at = np.flatnonzero(np.hypot(*(points - joint).T) <= np.where(turns, np.maximum(far, near), near))
            turned = np.einsum("kai,si->kas", inward[at], own)
            for column, side in ((0, 0), (1, 0), (2, 1)):
                chosen = own[turned[:, side].argmax(axis=1)]
                if corner.convex:
                    chosen = np.where(turns[at, None], chosen, between_normals(inward[at, side], own[:1], own[1:]))
                held.normals[at, column] = held.faces[at, column] = chosen
                held.gap[at, column] = np.sum((points[at] - joint) * chosen, axis=1) + self.offset
        return held.after(way, displaced)

    def _press_on_ridges(self, points: Array, inward: Array, feet: Feet, held: Faces) -> None:
        """Put the normals of the other body beside convex corners of this rigid one, as `Polyline` does.

        So it is at corners between straight edges. Between two elastic bodies such places are no pairs.
        """
        lines = [isinstance(edge.curve, Segment) for edge in self.edges]
        ridges = [item for item in self.joints if item.convex and all(lines[i] for i in item.edges)]
        if not ridges:
            return
        own, straight = pressed_normals(inward, cross(inward[:, 0], inward[:, 1]), held)
        within = np.full((len(points), len(ridges)), -np.inf)
        for number, ridge in enumerate(ridges):
            beside = np.flatnonzero(np.isin(feet.edge, ridge.edges))
            body = own[beside, 1]
            within[beside, number] = np.sum(between_normals(body, ridge.normals[:1], ridge.normals[1:]) * body, axis=1)
        which, smooth = within.argmax(axis=1), straight & np.isfinite(within).any(axis=1)
        offset = points - np.array([ridge.point for ridge in ridges])[which]
        after, before = np.moveaxis(np.array([ridge.normals for ridge in ridges])[which], 1, 0)
        among = smooth & is_tilted(own, held.normals)
        seen = sees_ridge(points, feet.edge, points - offset, own[:, 1], held.normals[:, 1], among)
        for column in range(3):
            there = ridge_beside(offset, own[:, column], held.normals[:, column], before, after, seen)
            held.put(smooth & there.counts, column, there.gap + self.offset, there.normals, there.faces)

    @cached_property
    def continued(self) -> "BodySurface":
        """A surface with also the edges beyond its ends in which the boundary goes on smoothly."""
        names = {edge.name for edge in self.edges}
        more = dict[str, Edge]()
        for edge, _, after in _neighbors(self.loops):
            own, others = edge.normals(np.ones(1))[0], after.normals(np.zeros(1))[0]
            smooth = abs(cross(own, others)) <= CORNER and np.dot(own, others) > 0
            if smooth and (edge.name in names) != (after.name in names):
                beyond = after if edge.name in names else edge
                more[beyond.name] = beyond
        return replace(self, edges=(*self.edges, *more.values()), nearest={}) if more else self

    @cached_property
    def ridges(self) -> Array:
        """Convex corners (j, 2) of the body at ends of the edges of the surface [L]."""
        names = {edge.name for edge in self.edges}
        found = [
            edge.end
            for edge, _, after in _neighbors(self.loops)
            if {edge.name, after.name} & names
            and cross(edge.normals(np.ones(1)), after.normals(np.zeros(1)))[0] > CORNER
        ]
        return np.array(found).reshape(-1, 2)

    def beside_groove(self, points: Array, motion: Array) -> BoolArray:
        """Whether points (...) in concave corners of either body are so near that they may cross to the other face.

        `motion` (...) [L] is how far they move. The other face is at the distance r sin α from a place at r on one of
        them, with the angle α between both.
        """
        beside = np.zeros(motion.shape, bool)
        for corner, (one, other) in self._grooves:
            sine = abs(cross(one, other)) if one @ other < 0 else 1.0
            beside |= sine * magnitudes(points - corner) <= motion
        return beside

    @cached_property
    def _grooves(self) -> list[tuple[Array, Array]]:
        """Concave corners of both sides: point (2,) and normals (2, 2)."""
        grooves = [(joint.point, joint.normals) for joint in self.joints if not joint.convex]
        for before, after in permutations(self.first, 2):
            normals = np.concatenate([before.normals(np.ones(1)), after.normals(np.zeros(1))])
            if before.end == after.start and cross(normals[0], normals[1]) < -CORNER:
                grooves.append((np.array(before.end), normals))
        return grooves

    @cached_property
    def joints(self) -> list[Joint]:
        """Corners between two edges of the surface."""
        numbers, joints = {edge.name: number for number, edge in enumerate(self.edges)}, list[Joint]()
        for edge, _, after in _neighbors(self.loops):
            if edge.name in numbers and after.name in numbers:
                own = np.stack([edge.normals(np.ones(1))[0], after.normals(np.zeros(1))[0]])
                if abs(cross(own[0], own[1])) > CORNER:
                    joints.append(Joint(np.array(edge.end), own, (numbers[edge.name], numbers[after.name])))
        return joints


AnyShape = Shape | BodySurface
"""A surface that has a gap at any point of the plane."""
AnySurface = RigidSurface | BodySurface
"""What a body may touch."""


def _neighbors(loops: Sequence[Sequence[Edge]]) -> Iterable[tuple[Edge, Edge, Edge]]:
    """Each edge with the one before and the one after it."""
    return chain.from_iterable(zip(loop, (loop[-1], *loop[:-1]), (*loop[1:], loop[0]), strict=True) for loop in loops)


@frozen
class BodyZone:
    """Edges of one body that may touch another one, as `ContactZone` has them for a rigid surface."""

    edges: tuple[str, ...]
    surface: BodySurface

    def after(self, approach: Way) -> "BodyZone":
        """The zone after another motion of the body that is touched."""
        return replace(self, surface=self.surface.after(approach))
