"""Contact solved once more with the gaps of the displaced places: what it changes, and what of that is told.

The change is the error of the first solution, to first order.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from bemcontact.analysis.moved_contact import (
    WITHHELD,
    Judgement,
    MovedContact,
    judged_to,
    noted,
)
from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.assessment.footprint import footprint
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.frozen import frozen
from bemcontact.problems.problem import Problem

SMALL_COMPONENT = 0.15
"""Component of the force on a tool over the force from which its change is judged by itself, and not by the force.

What is prescribed does not change; the other component may, by far more than the force as a whole."""
SMALL_CONTACT = 0.08
"""Force of a contact over that of its zone from which it is judged by itself, and not by this part."""
SAME = 1e-9
"""Relative difference of the changes of two forces that is round-off, as of a body and its mirror image."""
ALIKE = 0.1
"""Relative difference of what changes at two contacts up to which the mesh decides it: the first one is named."""


@frozen
class SecondSolution:
    """A second solution beside the first one.

    Parameters
    ----------
    first : the first solution, and where its motion takes contact
    contact, solution : with the gaps and the load of the displaced places
    """

    first: MovedContact
    contact: CondensedContact
    solution: ContactSolution

    @property
    def solved(self) -> bool:
        """Whether there is one."""
        return self.solution.status is Status.SOLVED

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
