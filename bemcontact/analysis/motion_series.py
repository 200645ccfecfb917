"""Work that forces gain by the free motions of a solution, and the series of steps that follow from it.

Contact sees gaps along normals as drawn, and forces have the levers that they have there. A disk on two planes may
spin, and its contact stays where it is. But with these normals and levers the disk seems to be held: as it spins, the
places that press move along the rim, and the pressure gains a moment. The moment that the levers gain by the same
motion takes all of it back. So each free motion is compared with what forces gain by it. To first order the true
amplitudes are those of a geometric series, a + T a + T² a + …, with T = C G: G has the work in each free motion that
forces gain by each, and C the amplitudes by which contact answers a load. Where an eigenvalue of T is near to one,
nothing but these normals and levers holds the body. It is about 1e-5 where contact is wide beside displacements.
None of this depends on the axes.
"""

from collections.abc import Iterator
from typing import NamedTuple, Self

import numpy as np
import scipy

from bemcontact.analysis.displaced_contact import centroid, gain_by_turn
from bemcontact.arrays import Array, BoolArray, IntArray, indices, least_squares, magnitudes, scalar_products
from bemcontact.bem.body import Body
from bemcontact.bem.contact_points import SMOOTH
from bemcontact.bem.free_motions import steps_of_surfaces
from bemcontact.bem.surface_gaps import SAME_FACE, SurfaceGaps
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import unseen_ways
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen
from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.curves import cross
from bemcontact.problems.edge_places import curvatures, nearest_on, places_at

UNSEEN = 1e-9
"""Change of gaps under pressure, over the largest one by a free motion, that is none."""
UNRESISTED = 1e-7
"""Motion along a line of force, over the largest one, that is round-off."""
FLAT = 1e-9
"""Curvature times the extent of contact that is round-off of a straight side."""


@frozen
class MotionSeries:
    """Steps by which k free motions go on, with amplitudes over the `sizes`: of motions of size one.

    Parameters
    ----------
    sizes : (k,) largest displacement of a point under pressure by a unit of each motion; one where there is none
    steps : (k, k) T
    along_lines : (p, k) motion of contacts along their lines of force as drawn, see `_Pairs`
    """

    sizes: Array
    steps: Array
    along_lines: Array

    @classmethod
    def of(cls, gaps: SurfaceGaps, body: Body, contact: CondensedContact, solution: ContactSolution) -> Self:
        """That of a solution."""
        if not contact.free_motions or not solution.pressure.any() or _gains_nothing(body, contact):
            return cls.none(contact.free_motions)
        pressed, pairs = indices(solution.pressure > 0), _Pairs.of(gaps, body, contact)
        sizes = pairs.sizes[pressed].max(axis=0)
        sizes[sizes == 0] = 1.0
        gained = _gains(pairs, gaps, body, contact, solution)
        steps = _answers(contact, pressed, gained) / sizes * sizes[:, None]
        return cls(sizes=sizes, steps=steps, along_lines=pairs.along_lines(pressed) / sizes)

    @classmethod
    def none(cls, motions: int) -> Self:
        """That of so many motions that nothing is known of, or by which forces gain nothing."""
        return cls(sizes=np.ones(motions), steps=np.zeros((motions, motions)), along_lines=np.eye(motions))

    @property
    def unresisted(self) -> Array:
        """Orthonormal motions (k, j) that move no contact along its line of force."""
        return unseen_ways(self.along_lines, UNRESISTED)

    def split(self, least: float) -> tuple[Array, Array, Array]:
        """Schur form (k, k) of T, and its orthonormal vectors of eigenvalues from `least` > 0 on, and the others."""
        if not self.steps.any():
            return self.steps, self.steps[:, :0], np.eye(len(self.steps))
        form, ways, count = scipy.linalg.schur(self.steps, sort=lambda real, imaginary=0.0: real >= least)
        return form, ways[:, :count], ways[:, count:]


def _gains_nothing(body: Body, contact: CondensedContact) -> bool:
    """Whether nothing turns, and all sides that may touch are rigid and straight: then G is zero."""
    if np.isfinite(body.seen.arms).any() or (body.points.opposite.node >= 0).any():
        return False
    zones = (contact.normals[contact.zone == number] for number in range(len(contact.zone_names)))
    return all((normals == normals[:1]).all() for normals in zones)


class _Pairs(NamedTuple):
    """Both sides of n contact points in k free motions.

    Parameters
    ----------
    against : (n, 2, k) displacement of the body against the other side
    slide : (n, k) its part along the boundary
    turns : (2, n, k) [rad/L] of the body and of the other side
    places : (2, n, 2) where both are displaced so [L], after the way that contact has followed
    sizes : (n, k) largest displacement of one of both sides
    shapes : of both sides as drawn
    """

    against: Array
    slide: Array
    turns: Array
    places: Array
    sizes: Array
    shapes: "_Shapes"

    @classmethod
    def of(cls, gaps: SurfaceGaps, body: Body, contact: CondensedContact) -> "_Pairs":
        """Both sides of the contact points of a body."""
        seen, points = body.seen, body.points
        at, radius = body.seen_ways, seen.radius
        turn = np.zeros((len(at), len(seen)))
        for number, part in enumerate(body.mesh.parts):
            turn[part.nodes] = seen.coefficients[:, 3 * number + 2] / radius
        has, opposite = points.opposite.node >= 0, points.opposite.node
        own, other = at[points.node], np.where(has[:, None, None], at[opposite], 0.0)
        its_turn = np.where(has[:, None], turn[opposite], 0.0)
        steps, shapes = steps_of_surfaces(body.problem)[contact.zone], _Shapes.of(gaps, body, contact)
        there = np.where(has[:, None], body.mesh.nodes[opposite] + steps, contact.points)
        for number, tool in enumerate(body.problem.tools.values()):
            mine = np.isin(contact.zone, [contact.zone_names.index(zone) for zone in tool.zones])
            x, y, by = seen.tools[3 * number : 3 * number + 3]
            lever = (contact.points - steps - contact.tools.point[number])[mine, :, None]
            other[mine] = np.stack([x - by * lever[:, 1], y + by * lever[:, 0]], axis=1)
            its_turn[mine] = by
        along = np.column_stack([contact.normals[:, 1], -contact.normals[:, 0]])
        return cls(
            against=own - other,
            slide=np.einsum("nx,nxk->nk", along, own - other),
            turns=np.stack([turn[points.node], its_turn]),
            places=np.stack([contact.points, there]),
            sizes=np.maximum(np.hypot(*np.moveaxis(own, 1, 0)), np.hypot(*np.moveaxis(other, 1, 0))),
            shapes=shapes,
        )

    def along_lines(self, pressed: IntArray) -> Array:
        """Part (p, k) of the displacements of points under pressure (p,) against each other along their line of force.

        Between a round side and a flat one pressure acts through the center of the former along the normal of the
        latter, wherever they touch; between two round sides through both centers. So it does no work in a motion
        without such parts, to rounding, although contact as drawn sees slopes. A corner is round, with the radius zero.
        """
        first, second = self.places[:, pressed]
        own, other = self.shapes.centers(pressed)
        flat, its_flat = (np.isinf(center).any(axis=1, keepdims=True) for center in (own, other))
        inward, normals = self.shapes.normals[:, pressed]
        between = np.where(flat | its_flat, 0.0, own) - np.where(flat | its_flat, 0.0, other)
        length = np.copysign(magnitudes(between), scalar_products(between, normals))[:, None]
        between = np.divide(between, length, out=normals.copy(), where=length != 0)
        way = np.where(flat, inward, between)
        place = np.where(flat, np.where(its_flat, first, other), own)
        levers = np.stack([cross(place - start, way) for start in (first, second)])[..., None]
        turned = levers * self.turns[:, pressed]
        return np.einsum("nx,nxk->nk", way, self.against[pressed]) + turned[0] - turned[1]

    def second_changes(self, force: Array) -> Array:
        """Work (k, k) of contact forces (n,) along the normals, by the second derivatives of the gaps of the motions.

        With body 1 as y = κ₁ x²/2 and the other side as y = -κ₂ x²/2 along the normal, and σ the part of body 1 in
        it, pairs stay at the part 1 - σ of a slide D on the other side. So the gap is σ² κ₁ D²/2 + (1 - σ)² κ₂ D²/2
        - σ θ₁ D - (1 - σ) θ₂ D, beside what is linear.
        """
        share, (one, two) = self.shapes.share, self.shapes.curvatures
        turns = share[:, None] * self.turns[0] + (1 - share)[:, None] * self.turns[1]
        bent = self.slide.T @ ((force * (share**2 * one + (1 - share) ** 2 * two))[:, None] * self.slide)
        turned = turns.T @ (force[:, None] * self.slide)
        return bent - turned - turned.T


class _Shapes(NamedTuple):
    """Both sides of n contact points as drawn: the body, and what is opposite.

    Parameters
    ----------
    share : (n,) part of the body in the normals
    feet, normals : (2, n, 2) points of both sides [L], and their unit normals into the body
    curvatures : (2, n) of both sides [1/L], positive where they are convex
    corner : (2, n) whether they are corners
    """

    share: Array
    feet: Array
    normals: Array
    curvatures: Array
    corner: BoolArray

    @classmethod
    def of(cls, gaps: SurfaceGaps, body: Body, contact: CondensedContact) -> "_Shapes":
        """Those of all zones."""
        points, n = contact.points, len(contact.points)
        share, curved, corner = np.zeros(n), np.zeros((2, n)), np.zeros((2, n), bool)
        feet = np.stack([points, points - contact.initial_gap[:, None] * contact.normals])
        normals = np.stack([contact.normals, contact.normals])
        corner[0] = np.isin(body.points.node, indices(abs(body.mesh.turns) > SMOOTH))
        for number, zone in enumerate(contact.zone_names):
            own, surface = indices(contact.zone == number), gaps.surfaces.get(zone)
            edges = [*map(body.problem.edge, body.problem.edges_of(zone))]
            at = nearest_on(edges, points[own])
            normals[0, own], curved[0, own] = -at.normals, curvatures(edges, at)
            if isinstance(surface, BodySurface) and surface.elastic:
                pairs = surface.pairs(points[own])
                there = places_at(surface.edges, pairs.edge, pairs.fraction)
                share[own], corner[1, own], curved[1, own] = (
                    surface.share,
                    pairs.at_corner,
                    curvatures(surface.edges, there),
                )
                feet[1, own], normals[1, own] = there.points + surface.approach.step, there.normals
            elif surface is not None:
                for run in np.unique(contact.run[own]).tolist():
                    at = own[contact.run[own] == run]
                    curved[1, at] = _bend_of_normals(feet[1, at], contact.normals[at])
        return cls(share, feet, normals, curved, corner)

    def centers(self, points: IntArray) -> Array:
        """Centers of curvature (2, p, 2) [L] of both sides at some points (p,), infinite where they are flat."""
        curved, reach = self.curvatures[:, points], np.ptp(self.feet[0], axis=0).max()
        with np.errstate(
            divide="ignore", invalid="ignore"
        ):  # infinite along one axis, and not a number along the other
            radius = np.where(self.corner[:, points], 0.0, 1 / np.where(abs(curved) * reach <= FLAT, 0.0, curved))
            inward = np.array([1.0, -1.0])[:, None, None] * self.normals[:, points]
            return self.feet[:, points] + radius[..., None] * inward


def _bend_of_normals(points: Array, normals: Array) -> Array:
    """Curvature (j,) [1/L] of a rigid surface at points (j, 2) of a run by its normals, positive where it is convex."""
    if len(points) < 2:
        return np.zeros(len(points))
    steps, middle = np.diff(points, axis=0), normals[1:] + normals[:-1]
    along = middle[:, 1] * steps[:, 0] - middle[:, 0] * steps[:, 1]
    turned = -cross(normals[:-1], normals[1:])
    smooth = (scalar_products(normals[:-1], normals[1:]) >= SAME_FACE) & (along != 0)
    bend = np.divide(2 * turned, along, out=np.zeros(len(along)), where=smooth)
    return (np.append(bend[:1], bend) + np.append(bend, bend[-1:])) / 2


def _gains(pairs: _Pairs, gaps: SurfaceGaps, body: Body, contact: CondensedContact, solution: ContactSolution) -> Array:
    """G (k, k): work in each free motion (row) that forces gain by a unit of each (column)."""
    seen, force = body.seen, contact.weights * solution.pressure
    gained = pairs.second_changes(force)
    for number, part in enumerate(body.mesh.parts):
        center, turn = centroid(part.mesh), seen.coefficients[:, 3 * number + 2] / seen.radius
        resultant, moment = gain_by_turn(gaps, body, part, center)
        gained += np.outer(seen.of_body(number).work_of(resultant, moment, about=center), turn)
    for number, dead in enumerate(_levers_on_tools(body, contact, force)):
        gained -= dead * np.outer(seen.tools[3 * number + 2], seen.tools[3 * number + 2])
    return gained


def _levers_on_tools(body: Body, contact: CondensedContact, force: Array) -> Iterator[float]:
    """Σ r·f [p L²] of the contact forces on each tool about its point: its load acts there."""
    steps = steps_of_surfaces(body.problem)[contact.zone]
    for number, tool in enumerate(body.problem.tools.values()):
        own = np.isin(contact.zone, [contact.zone_names.index(zone) for zone in tool.zones])
        lever = (contact.points - steps - contact.tools.point[number])[own]
        yield -float(force[own] @ scalar_products(lever, contact.normals[own]))


def _answers(contact: CondensedContact, pressed: IntArray, loads: Array) -> Array:
    """Amplitudes (k, j) by which contact at the pressed points answers loads (k, j) in the free motions.

    Motions that no pressed point sees have none.
    """
    motions = contact.rigid_motions[pressed]
    sizes = abs(motions).max(axis=0)
    sizes[sizes == 0] = 1.0
    ways, none = np.eye(len(sizes)), unseen_ways(motions / sizes, UNSEEN)
    if none.shape[1]:
        ways = scipy.linalg.null_space(none.T)
    R, J = motions / sizes @ ways, contact.weights[pressed] / contact.weights[pressed].max()
    unit = contact.scales.displacement / contact.scales.pressure
    M, j = contact.compliance[np.ix_(pressed, pressed)] / unit, ways.shape[1]
    rows = np.block([[M, R], [(J[:, None] * R).T, np.zeros((j, j))]])
    right = np.zeros((len(rows), loads.shape[1]))
    right[len(pressed) :] = -ways.T @ (loads / sizes[:, None]) / contact.weights[pressed].max()
    # M x + R a = 0 and Rᵀ J x = -load, for pressures x and amplitudes a in the unit of the compliance
    try:
        found = np.linalg.solve(rows, right)
    except np.linalg.LinAlgError:  # pressures that move no point
        found = least_squares(rows, right)
    return ways @ found[len(pressed) :] * unit / sizes[:, None]
