"""Contact solved once more with the gaps of the displaced places: what it changes, and what of that is told.

The change is the error of the first solution, to first order.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg

from bemcontact.analysis.displaced_contact import turn_of_body
from bemcontact.analysis.moved_contact import (
    WITHHELD,
    Judgement,
    MovedContact,
    judged_to,
    noted,
)
from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.assessment.footprint import footprint
from bemcontact.assessment.penetration import Misfit
from bemcontact.bem.free_motions import FreeMotions
from bemcontact.cached import cached_property
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.formulations import complementarity
from bemcontact.problems.problem import Problem

SMALL_COMPONENT = 0.15
"""Component of the force on a tool over the force from which its change is judged by itself, and not by the force.

What is prescribed does not change; the other component may, by far more than the force as a whole."""
SMALL_CONTACT = 0.08
"""Force of a contact over that of its zone from which it is judged by itself, and not by this part."""
LINKED = 0.1
"""Part of the normals along which contact sees two motions, from which they may be seen along the same ones."""
SLOPE = 0.5
"""Part of a motion that contact sees along its normals, up to which slopes see it."""
ALONE = 1e3
"""Condition number up to which motions of the points under pressure are not nearly the same."""
NAMED = 0.01
"""Least share of a free motion that a sentence names."""
MOVES_ON = 0.8
"""Part of a motion by which a body moves on in the second solution, from which it is not held: the steps do not end.

They are a geometric series. A body that moves back in the second solution is held."""
NO_SQUARE = 2.0
"""A motion that is so many times the change of the gaps, or the turn of normals and body times the motion of places,
does not come from these, which are of second order."""
NO_CHANGE = 1e-7
"""Difference of the gaps, over the displacement scale of contact, that changes nothing."""
SAME = 1e-9
"""Relative difference of the changes of two forces that is round-off, as of a body and its mirror image."""
ALIKE = 0.1
"""Relative difference of what changes at two contacts up to which the mesh decides it: the first one is named."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SecondSolution:
    """A second solution beside the first one.

    Parameters
    ----------
    first : the first solution, and where its motion takes contact
    contact, solution : with the gaps and the load of the displaced places
    free : the k free motions of contact
    ways : (n, 2, k) motion of the contact points against their surfaces in each of them
    """

    first: MovedContact
    contact: CondensedContact
    solution: ContactSolution
    free: FreeMotions
    ways: Array

    @property
    def solved(self) -> bool:
        """Whether there is one."""
        return self.solution.status is Status.SOLVED

    def moves_on(self) -> Judgement:
        """Find a free motion that goes on by as much again where the body has moved to: nothing holds it.

        A flat block slides on a round support, whose normals are tilted beside the place where it touches. It would
        move until the tilt balances the load, but takes the place of contact with it. So does a disc that a couple
        rolls along a plane: it would turn until the lever of the pressure balances the couple. A motion that slopes
        drive by a small part of the forces, as that of a roller between bodies that bend, is noted: see `unknown`.
        """
        first, goes_on, driven = self.first, self._goes_on, self._driven
        if not goes_on.any():
            return None, ()
        j = int(np.argmax(np.where(goes_on & ~self.unknown, abs(self._change), -1.0)))
        if self.unknown[goes_on].all():
            j = int(np.argmax(np.where(goes_on, self._push, -1.0)))
        mode = self._modes[:, j, None]
        motion = self.free.combined(np.where(abs(mode) < NAMED * abs(mode).max(), 0.0, mode)).describe()[0]
        slopes = f"slopes push along it by {100 * self._push[j]:.2g} % of the force of contact"
        if self.unknown[j]:
            words = (
                f"no contact holds the {motion}, and no load drives it: {slopes}; its amount is not known, and a "
                "little friction holds it"
            )
            return None, (words,)
        before, further = abs(float(self._before[j])), abs(float(self._change[j]))
        seen = abs(first.contact.rigid_motions @ self._modes[:, j])
        i = int(np.argmax(first.contact.weights * first.solution.pressure * seen))
        words = (
            f"No contact holds the {motion}{' against the load' if driven[j] else f': {slopes}'}. Only slopes and "
            "levers as drawn seem to hold it, and they move with the body. Along this motion contact moves by "
            f"{first.length(before)}, and from there on by {first.length(further)}. Prescribe a displacement that "
            "holds the body in this direction."
        )
        return first.misfit(Misfit.MOVED, words, i, further, self._least), ()

    @property
    def unknown_amplitudes(self) -> Array:
        """Amplitudes (k,) of the `unknown` motions in the first solution, without those of others."""
        return self._modes @ np.where(self.unknown, self._before, 0.0)

    @property
    def unknown(self) -> BoolArray:
        """Motions (k,) that go on, and that a little friction holds, at an amount that is not known.

        No load drives them, contact sees them by slopes only, and these push by a part of its force that is not noted.
        """
        return self._goes_on & self._by_slopes & ~self._driven & (self._push < self.first.noted)

    def without_unknown(self) -> "SecondSolution":
        """The second solution that leaves `unknown` motions where the first one has them: no judgement needs them."""
        if not self.unknown.any():
            return self
        contact, R, left = self.contact, self.contact.rigid_motions @ self._modes, ~self.unknown
        amplitudes = np.linalg.solve(self._modes, self.first.solution.rigid_amplitudes)
        held = contact.offset + R[:, self.unknown] @ amplitudes[self.unknown]
        load = (contact.motion_load @ self._modes)[left]
        there = CondensedContact.from_compliance(
            contact.compliance, held, contact.weights, rigid_motions=R[:, left], motion_load=load
        )
        again = complementarity.solve(there, near=self.first.pressed)
        return replace(self, solution=replace(again, displacement=there.offset + again.displacement - contact.offset))

    @cached_property
    def _modes(self) -> Array:
        """Combinations (k, k) of the free motions that are judged, one a column.

        Where contact sees two motions that no load drives along the same normals, as both translations of a roller
        between inclined planes, nothing may hold a combination. These are along and across the normals.
        """
        force, found = self.first.contact.weights * self.first.solution.pressure, np.eye(self.ways.shape[2])
        R, loose = self.first.contact.rigid_motions, self.first.contact.motion_load == 0
        seen, whole = (R.T * force) @ R, np.einsum("n,nxj,nxk->jk", force, self.ways, self.ways)
        sizes = np.sqrt(np.outer(np.diag(seen), np.diag(seen)))
        linked = (abs(seen) > LINKED * sizes) & np.outer(loose, loose) | found.astype(bool)
        for group in np.unique(np.linalg.matrix_power(linked, len(found)), axis=0):
            own = np.ix_(group, group)
            if group.sum() > 1 and np.linalg.cond(whole[own]) < ALONE:
                modes = scipy.linalg.eigh(seen[own], whole[own])[1]
                sign = np.copysign(np.hypot.reduce(modes), modes[abs(modes).argmax(axis=0), range(len(modes))])
                found[own] = modes / sign
        return found

    @property
    def _driven(self) -> BoolArray:
        """Whether a load acts along each motion (k,)."""
        return (self.first.contact.motion_load @ self._modes) != 0

    @cached_property
    def _goes_on(self) -> BoolArray:
        """Motions (k,) that go on by as much again.

        A body that moves back is held, unless slopes alone see the motion and it is by more than it has moved. One that
        no load drives, and that is small beside every contact, may be noise of the mesh, and places nothing elsewhere.
        """
        first, contact = self.first, self.first.contact
        if not self.solved or not contact.free_motions:
            return np.zeros(contact.free_motions, bool)
        before, change = self._before, self._change
        lengths = contact.lengths_by_zone @ (first.solution.pressure > 0)
        slight = first.noted * lengths[lengths > 0].min(initial=np.inf)
        noise = (abs(before) + abs(change) < slight) & ~self._driven
        back = (before * change < 0) & (~self._by_slopes | (abs(change) <= abs(before)))
        reach = abs(contact.rigid_motions @ self._modes).max(axis=0)
        return (abs(change) >= MOVES_ON * abs(before)) & (reach * abs(change) >= self._least) & ~back & ~noise

    @cached_property
    def _by_slopes(self) -> BoolArray:
        """Motions (k,) that contact sees by slopes only."""
        force, modes = self.first.contact.weights * self.first.solution.pressure, self._modes
        seen, whole = (self.first.contact.rigid_motions @ modes) ** 2, ((self.ways @ modes) ** 2).sum(axis=1)
        return force @ seen < SLOPE**2 * (force @ whole)

    @property
    def _least(self) -> float:
        """Change of gaps [L] by a free motion up to which it may come from squares of displacements."""
        first, moved = self.first, self.first.moved
        pressed = np.maximum(first.solution.pressure, self.solution.pressure) > 0
        turned = abs(moved.turn[pressed]).max() + abs(turn_of_body(first.gaps))
        square = max(abs(moved.change[pressed]).max(), turned * abs(moved.motion[pressed]).max())
        return max(NO_SQUARE * square, NO_CHANGE * first.contact.scales.displacement)

    @cached_property
    def _before(self) -> Array:
        """Amplitudes (k,) of the first solution; if slopes alone see them, those nearest to how both sides move.

        The former are those of gaps, in which a bend of a body may be larger than a motion that hardly changes them.
        """
        force, ways = self.first.contact.weights * self.first.solution.pressure, self.ways @ self._modes
        work, whole = np.einsum("n,nx,nxk->k", force, self.first.moved.motion, ways), force @ (ways**2).sum(axis=1)
        amplitudes = np.linalg.solve(self._modes, self.first.solution.rigid_amplitudes).astype(float)
        return np.divide(work, whole, out=amplitudes, where=self._by_slopes)

    @cached_property
    def _change(self) -> Array:
        """What the second solution adds to the amplitudes (k,), but for motions whose amplitudes are a rule's."""
        change, unseen = self.solution.rigid_amplitudes - self.first.solution.rigid_amplitudes, self.first.unheld()
        return np.linalg.solve(self._modes, change - unseen @ (unseen.T @ change)).astype(float)

    @cached_property
    def _push(self) -> Array:
        """Force along each motion (k,) at the displaced places, over the force of all contacts that move in it.

        The force is the work of `load_after`. So this is the coefficient of friction that holds the body there.
        """
        first = self.first
        work = abs((self.contact.motion_load - first.contact.motion_load) @ self._modes)
        most = (first.contact.weights * first.solution.pressure) @ np.linalg.norm(self.ways @ self._modes, axis=1)
        return np.divide(work, most, out=np.zeros_like(work), where=most > 0)

    def forces_changed(self) -> Judgement:
        """Judge how the force of each contact changes with the gaps and normals of the displaced places.

        The force on a tool that is free along one axis is judged along the other one by that component.
        """
        if not self.solved:
            return None, ()  # as is said of the peak
        first, contact, moved = self.first, self.first.contact, self.first.moved
        zones, within = self._contacts()
        own, before, after = contact.weights_by_zone[zones] * within, first.solution.pressure, self.solution.pressure
        was = (own * before) @ contact.normals
        is_now = (own * after) @ (contact.normals + moved.turn)
        of_zone = contact.lengths_by_zone @ before
        total = np.maximum(abs(own) @ before, SMALL_CONTACT * of_zone[zones])
        change, held = is_now - was, _held_axes(first.gaps.problem)[zones]
        size = np.where(held & (abs(was) >= SMALL_COMPONENT * total[:, None]), abs(was), total[:, None])
        changed = np.column_stack([np.hypot(*change.T), abs(change)])
        size = np.column_stack([total, size])
        parts = changed / np.where(size > 0, size, np.inf)
        number, axis = np.unravel_index(int(np.argmax(parts >= (1 - SAME) * parts.max())), parts.shape)
        part = float(parts[number, axis])
        if part < first.noted:
            return None, ()
        both = abs(own[number]) * np.maximum(before, after)
        zone, units = contact.zone_names[zones[number]], first.gaps.problem.units
        motion = first.motion_in(within[number], both)
        gained, whole = first.vector(change[number], units.line_force), float(of_zone[zones[number]])
        of = f"along {'xy'[axis - 1]} by {100 * part:.2g} %" if axis else f"{100 * part:.2g} % of it"
        if abs(own[number]) @ before < SMALL_CONTACT * whole:
            of = f"{100 * changed[number, 0] / whole:.2g} % of all force there"
        words = (
            f"{first.motion_against(zone, motion)}, which is not small beside their shapes: with the gaps and the "
            "directions of the surfaces where the body then is, the force between them changes by "
            f"{gained}, {of}; {first.remedy(motion)}"
        )
        off = float(abs(moved.change[within[number]]).max())
        return first.judged(words, withheld=part >= WITHHELD, i=int(np.argmax(both)), depth=off)

    def peaks_changed(self, zones: Sequence[str], nearby: Array | None) -> Judgement:
        """Judge how the peak of each of some zones changes with the gaps and normals of the displaced places.

        `nearby` (2, zones) is as of `placement`.
        """
        first, contact, before = self.first, self.first.contact, self.first.solution.pressure
        own, change = self._peak_change(zones)
        if self.solved and abs(change) < first.noted:
            return None, ()
        if self.solved and nearby is not None:
            beyond = self._peak_change(zones, nearby)
            if abs(beyond[1]) < WITHHELD:
                return None, (_off_by_a_little(contact.zone_names[contact.zone[own][0]], first.gaps.problem),)
            own, change = beyond
        pressure = np.where(own, np.maximum(before, self.solution.pressure if self.solved else 0.0), -1.0)
        i = int(np.argmax(pressure))
        motion = first.motion_in(own, pressure)
        effect = (
            f"with the gaps after this motion, the peak pressure there {'rises' if change > 0 else 'falls'} by "
            f"{100 * abs(change):.2g} %{' of the largest' * bool(before[own].max() < before.max())}"
            if self.solved
            else "with the gaps after this motion, contact does not hold the body"
        )
        words = (
            f"{first.motion_against(first.zone(i), motion)}, which is not small beside their shapes: {effect}; "
            f"{first.remedy(motion)}"
        )
        off = float(abs(first.moved.change[own]).max())
        return first.judged(words, withheld=not self.solved or abs(change) >= WITHHELD, i=i, depth=off)

    def places_changed(self) -> Iterator[str]:
        """Note the contact whose place changes most, and that whose length does, by a noticeable part of its length.

        Ends that move do so by whole elements. The middle of the pressure and its spread do not.
        """
        was = footprint(self.first.contact, self.first.solution).intervals
        is_now = footprint(self.contact, self.solution).intervals
        if not was or [item.run for item in was] != [item.run for item in is_now]:
            return
        before, after = (np.array([item.arc for item in intervals]).reshape(-1, 2) for intervals in (was, is_now))
        longer = np.maximum(np.ptp(before, axis=1), np.ptp(after, axis=1))
        shifts, grown = np.zeros((2, len(was)))
        for i in np.flatnonzero((before != after).any(axis=1) & (longer > 0)):
            both = np.stack([before[i], after[i]])
            middles, spreads = self._within(was[i].run, both[:, 0].min(), both[:, 1].max())
            if spreads.all():
                shifts[i], grown[i] = abs(middles[1] - middles[0]) / longer[i], spreads[1] / spreads[0] - 1
        if shifts[number := int(np.argmax(shifts >= (1 - ALIKE) * shifts.max()))] >= self.first.noted:
            yield (
                f"with the gaps after the motion of the body, contact of '{was[number].zone}' is elsewhere by "
                f"{100 * shifts[number]:.2g} % of its length, or more; error bars of its ends, "
                "and of translations and rotations, do not include this"
            )
        if abs(grown[number := int(np.argmax(abs(grown) >= (1 - ALIKE) * abs(grown).max()))]) >= self.first.noted:
            yield (
                f"with the gaps after the motion of the body, contact of '{was[number].zone}' is "
                f"{'longer' if grown[number] > 0 else 'shorter'} by {100 * abs(grown[number]):.2g} %; error bars of "
                "its length and ends do not include this"
            )

    def _within(self, run: int, start: float, end: float) -> tuple[Array, Array]:
        """Middle (2,) of the pressure of both solutions between two arc positions, and its root mean square (2,) [L].

        The former is from the first position, the latter from the middle. Both are zero without pressure.
        """
        contact = self.first.contact
        along = (contact.arc_position - start) % contact.run_length[contact.run]  # infinite before an open stretch
        own = (contact.run == run) & (along <= end - start)
        pressures = np.stack([self.first.solution.pressure, self.solution.pressure])[:, own]
        force, along = contact.weights[own] * pressures, along[own]
        total = np.maximum(force.sum(axis=1), np.finfo(float).tiny)
        middles = force @ along / total
        return middles, np.sqrt((force * (along - middles[:, None]) ** 2).sum(axis=1) / total)

    def _contacts(self) -> tuple[IntArray, BoolArray]:
        """Zone (c,) and points (c, n) of each unbroken contact of one of both solutions; of one alone, the zone.

        What one contact gains another one of its zone may lose, as both walls of a groove do.
        """
        contact, zones, within = self.first.contact, list[int](), list[BoolArray]()
        every = [*self.first.contacts((self.first.solution.pressure > 0) | (self.solution.pressure > 0))]
        for number in range(len(contact.zone_names)):
            found = [own for zone, own in every if zone == number]
            found = found if len(found) > 1 else [contact.lengths_by_zone[number] != 0]
            zones += [number] * len(found)
            within += found
        return np.array(zones), np.array(within)

    def _peak_change(self, zones: Sequence[str], nearby: Array | None = None) -> tuple[BoolArray, float]:
        """Points (n,) of the contact in one of the zones whose peak changes most, and its change over the largest peak.

        Where the peaks of the zones nearby on a path are known, it is the zone, and the change beyond these.
        """
        contact, before = self.first.contact, self.first.solution
        of, own = self._contacts()
        if nearby is not None:
            of = np.arange(len(contact.zone_names))
            own = contact.zone == of[:, None]
        was, is_now = (np.where(own, item.pressure, 0.0).max(axis=1, initial=0.0) for item in (before, self.solution))
        changes = (is_now - (was if nearby is None else np.clip(is_now, *nearby))) / before.pressure.max()
        changes[[contact.zone_names[number] not in zones for number in of.tolist()]] = 0.0
        number = int(np.argmax(abs(changes)))
        return own[number], float(changes[number])


def _held_axes(problem: Problem) -> BoolArray:
    """Axes (zones, 2) along which the tool of each zone is held, if it is free along the other one."""
    held = np.zeros((len(problem.zones), 2), bool)
    for tool in problem.tools.values():
        free = np.array(tool.free[:2])
        held[[[*problem.zones].index(zone) for zone in tool.zones]] = ~free & free.any()
    return held


def _off_by_a_little(zone: str, problem: Problem) -> str:
    """Say of a state on a path that its peak is that of a parameter a little off, or off by less than is withheld."""
    return (
        f"the body moves far beside its shape: with the gaps after the motion, the peak pressure on the surface of "
        f"'{zone}' changes by {100 * noted(problem):.2g} % or more, but by less than {100 * WITHHELD:.2g} % or than it "
        f"changes within {100 * judged_to(problem):.2g} % of the path"
    )
