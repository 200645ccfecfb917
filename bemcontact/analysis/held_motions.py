"""Free motions that only slopes and levers as drawn hold: how far a body moves along them is not known.

Contact sees gaps along normals as drawn, and forces have the levers that they have there. A disk on two planes may
spin, and its contact stays where it is. But with these normals and levers the disk seems to be held: as it spins, the
places that press move along the rim, and the pressure gains a moment. The moment that the levers gain by the same
motion takes all of it back. So each free motion is compared with what forces gain by it. To first order the true
amplitudes are those of a geometric series, a + T a + T² a + …, with T = C G: G has the work in each free motion that
forces gain by each, and C the amplitudes by which contact answers a load. Where an eigenvalue of T is near to one,
nothing but these normals and levers holds the body. It is about 1e-5 where contact is wide beside displacements.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np
import scipy

from bemcontact.analysis.displaced_contact import centroid, gain_by_turn
from bemcontact.analysis.moved_contact import noted
from bemcontact.arrays import (
    Array,
    BoolArray,
    IntArray,
    indices,
    least_squares,
    magnitudes,
    norm,
    row_norms,
    scalar_products,
)
from bemcontact.assessment.accuracy import Accuracy, ErrorBar
from bemcontact.bem.body import Body
from bemcontact.bem.body_motions import amounts
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.condense import Condensation
from bemcontact.bem.free_motions import steps_of_surfaces
from bemcontact.bem.surface_gaps import SAME_FACE, SurfaceGaps, surface_gaps
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import unseen_ways
from bemcontact.contact.known_motions import KnownMotions
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen
from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.curves import cross
from bemcontact.problems.edge_places import curvatures, nearest_on, places_at

MOVES_ON = 0.5
"""Eigenvalue of T from which the series adds as much as the first motion, or more, so that its amount is not known."""
TAKES_PART = 0.01
"""Part of a motion in one whose amount is not known from which its own is not known.

Nor is it if as much again of the latter changes it by a part that is noted."""
NOT_KNOWN = "not known: only slopes and levers as drawn hold it, which move with the body"
"""Note on a motion without an amount."""
UNSEEN = 1e-9
"""Change of gaps under pressure, over the largest one by a free motion, that is none."""


@frozen
class MovingBody:
    """Free motions of a solution, with the boundary behind the contact points.

    Parameters
    ----------
    body, contact : that move
    known : what is known of their amounts, as of `body_motions.amounts`
    errors : (k,) of the amounts [rad] or [L], because normals and levers are those as drawn; zero where not known
    unsure : part of the largest displacement [L] by motions whose amount is not known
    """

    body: Body
    contact: CondensedContact
    known: KnownMotions
    errors: Array
    unsure: float

    @classmethod
    def of(
        cls, condensation: Condensation, boundary: BoundaryState, solution: ContactSolution, *, solved: bool = True
    ) -> Self:
        """The motions of a solution; of what is no solution, not `solved`, nothing is judged."""
        body, contact = condensation.body, condensation.contact
        k = contact.free_motions
        held = HeldMotions(np.ones(k, bool), np.zeros(k), np.zeros((k, k)))
        if solved and k and solution.pressure.any() and not _gains_nothing(body, contact):
            held = held_motions(surface_gaps(body, boundary, contact, solution), body, contact, solution)
        amplitudes, moved = solution.rigid_amplitudes, boundary.displacement
        found, arms = amounts(body, amplitudes, moved), np.where(turns(body), body.seen.arms, 1.0)
        known = KnownMotions.of(contact, solution, np.where(turns(body), found, 0.0), held.held)
        most = np.unravel_index(magnitudes(moved).argmax(), moved.shape[:2])
        ways = body.seen.displacement(body.mesh)[body.mesh.elements[most]]
        unsure = abs(norm(moved[most]) - norm(moved[most] - ways @ held.unheld @ (found * arms)))
        return cls(body=body, contact=contact, known=known, errors=held.errors / arms, unsure=unsure)

    def judged(self, accuracy: Accuracy) -> Accuracy:
        """Accuracy without error bars of what is not known, and with the errors of slopes and levers in the others."""
        return replace(accuracy, bars=tuple(map(self._judged, accuracy.bars)))

    def _judged(self, bar: ErrorBar) -> ErrorBar:
        """An error bar, if it is of a motion, or of the largest displacement."""
        if bar.quantity == "displacement" and bar.bar is not None and bar.value is not None:
            if self.unsure <= bar.bar * bar.value:
                return bar
            moving = " and the ".join(self.known.unknown)
            amount = "amount is" if len(self.known.unknown) == 1 else "amounts are"
            why = f"not known: it has a part of the {moving}, whose {amount} not known"
            return replace(bar, value=None, bar=None, at=None, note=why)
        if bar.quantity not in ("motion", "rotation") or bar.value is None or bar.bar is None:
            return bar
        known, error = self._of_mover(bar)
        if not known:
            return replace(bar, value=None, bar=None, note=NOT_KNOWN)
        part = error / abs(bar.value)
        return replace(bar, bar=bar.bar + part) if part >= noted(self.body.problem) else bar

    def _of_mover(self, bar: ErrorBar) -> tuple[bool, float]:
        """Whether the amount of a motion or a rotation is known, and its error [L] or [rad]."""
        names, tools = self.contact.motion_names, self.contact.tools
        if bar.mover in names:
            return bar.mover not in self.known.unknown, float(self.errors[names.index(bar.mover)])
        number = tools.names.index(str(bar.mover))
        ways = slice(0, 2) if bar.quantity == "motion" else slice(2, 3)
        moved = abs(tools.amplitudes[3 * number : 3 * number + 3][ways])
        amplitudes = self.errors * np.where(turns(self.body), self.body.seen.arms, 1.0)
        return bool(self.known.tools[number, ways].all()), float(norm(moved @ amplitudes))


def turns(body: Body) -> BoolArray:
    """Which free motions (k,) turn something."""
    return np.isfinite(body.seen.arms)


class HeldMotions(NamedTuple):
    """What holds k free motions.

    Parameters
    ----------
    held : (k,) whether it is more than slopes and levers as drawn
    errors : (k,) [L] of the amplitudes, because slopes and levers are those as drawn; zero where nothing else holds
    unheld : (k, k) part of amplitudes along the ways that nothing else holds
    """

    held: BoolArray
    errors: Array
    unheld: Array


def held_motions(gaps: SurfaceGaps, body: Body, contact: CondensedContact, solution: ContactSolution) -> HeldMotions:
    """Find the free motions that something holds beside slopes and levers as drawn, and their errors by these."""
    pressed = indices(solution.pressure > 0)
    pairs = _Pairs.of(gaps, body, contact)
    sizes = pairs.sizes[pressed].max(axis=0)
    sizes[sizes == 0] = 1.0
    gained = _gains(pairs, gaps, body, contact, solution)
    series = _answers(contact, pressed, gained) / sizes * sizes[:, None]  # T of motions of size one
    form, ways, count = scipy.linalg.schur(series, sort=lambda real, imaginary=0.0: real >= MOVES_ON)
    free, others, known = ways[:, :count], ways[:, count:], form[count:, count:]
    mixed = scipy.linalg.solve_sylvester(form[:count, :count], -known, form[:count, count:]) if count else form[:0]
    unheld = free @ (free.T + mixed @ others.T) if count else np.zeros_like(series)
    amplitudes = solution.rigid_amplitudes * sizes
    most = np.maximum(noted(body.problem) * abs(amplitudes), UNSEEN * abs(amplitudes).max())
    held = (row_norms(free) <= TAKES_PART) & (abs(unheld @ amplitudes) <= most)
    first = others.T @ amplitudes
    further = np.linalg.solve(np.eye(len(known)) - known, known @ first)
    errors = np.where(held, abs(others @ further) / sizes, 0.0)
    return HeldMotions(held, errors, unheld / sizes[:, None] * sizes)


def _gains_nothing(body: Body, contact: CondensedContact) -> bool:
    """Whether nothing turns, and all sides that may touch are rigid and straight: then G is zero."""
    if turns(body).any() or (body.points.opposite.node >= 0).any():
        return False
    zones = (contact.normals[contact.zone == number] for number in range(len(contact.zone_names)))
    return all((normals == normals[:1]).all() for normals in zones)


class _Pairs(NamedTuple):
    """Both sides of n contact points in k free motions.

    Parameters
    ----------
    slide : (n, k) of the body against the other side, along the boundary
    turns : (2, n, k) [rad/L] of the body and of the other side
    share : (n,) part of the body in the normals
    curvature : (n,) [1/L] by which a slide changes the gap: half of this times its square
    sizes : (n, k) largest displacement of one of both sides
    """

    slide: Array
    turns: Array
    share: Array
    curvature: Array
    sizes: Array

    @classmethod
    def of(cls, gaps: SurfaceGaps, body: Body, contact: CondensedContact) -> "_Pairs":
        """Both sides of the contact points of a body."""
        seen, points = body.seen, body.points
        at, radius = seen.displacement(body.mesh), seen.radius
        turn = np.zeros((len(at), len(seen)))
        for number, part in enumerate(body.mesh.parts):
            turn[part.nodes] = seen.coefficients[:, 3 * number + 2] / radius
        own, other = (
            at[points.node],
            np.where((points.opposite.node >= 0)[:, None, None], at[points.opposite.node], 0.0),
        )
        its_turn = np.where((points.opposite.node >= 0)[:, None], turn[points.opposite.node], 0.0)
        steps = steps_of_surfaces(body.problem)[contact.zone]
        for number, tool in enumerate(body.problem.tools.values()):
            mine = np.isin(contact.zone, [contact.zone_names.index(zone) for zone in tool.zones])
            x, y, by = seen.tools[3 * number : 3 * number + 3]
            lever = (contact.points - steps - contact.tools.point[number])[mine, :, None]
            other[mine] = np.stack([x - by * lever[:, 1], y + by * lever[:, 0]], axis=1)
            its_turn[mine] = by
        along = np.column_stack([contact.normals[:, 1], -contact.normals[:, 0]])
        share, curvature = _shapes(gaps, body, contact)
        return cls(
            slide=np.einsum("nx,nxk->nk", along, own - other),
            turns=np.stack([turn[points.node], its_turn]),
            share=share,
            curvature=curvature,
            sizes=np.maximum(np.hypot(*np.moveaxis(own, 1, 0)), np.hypot(*np.moveaxis(other, 1, 0))),
        )

    def second_changes(self, force: Array) -> Array:
        """Work (k, k) of contact forces (n,) along the normals, by the second derivatives of the gaps of the motions.

        With body 1 as y = κ₁ x²/2 and the other side as y = -κ₂ x²/2 along the normal, and σ the part of body 1 in
        it, pairs stay at the part 1 - σ of a slide D on the other side. So the gap is σ² κ₁ D²/2 + (1 - σ)² κ₂ D²/2
        - σ θ₁ D - (1 - σ) θ₂ D, beside what is linear.
        """
        turns = self.share[:, None] * self.turns[0] + (1 - self.share[:, None]) * self.turns[1]
        bent = self.slide.T @ ((force * self.curvature)[:, None] * self.slide)
        turned = turns.T @ (force[:, None] * self.slide)
        return bent - turned - turned.T


def _shapes(gaps: SurfaceGaps, body: Body, contact: CondensedContact) -> tuple[Array, Array]:
    """Part σ (n,) of the body in the normals, and σ² κ₁ + (1 - σ)² κ₂ (n,) [1/L]."""
    share, curvature = np.zeros(len(contact.points)), np.zeros(len(contact.points))
    for number, zone in enumerate(contact.zone_names):
        own, surface = indices(contact.zone == number), gaps.surfaces.get(zone)
        if isinstance(surface, BodySurface) and surface.elastic:
            part, feet = surface.share, surface.pairs(contact.points[own])
            one = curvatures(surface.first, nearest_on(surface.first, contact.points[own]))
            two = curvatures(surface.edges, places_at(surface.edges, feet.edge, feet.fraction))
            share[own], curvature[own] = part, part**2 * one + (1 - part) ** 2 * two
        elif surface is not None:
            for run in np.unique(contact.run[own]).tolist():
                at = own[contact.run[own] == run]
                curvature[at] = _bend_of_normals(contact.points[at], contact.normals[at])
    return share, curvature


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
