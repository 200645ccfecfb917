"""Free motions of the second solution: those that go on by as much again, for nothing holds them.

Where slopes alone see a motion that no load drives, it may go on by an amount that is not known, and that no judgement
needs.
"""

from dataclasses import replace

import numpy as np
import scipy.linalg

from bemcontact.analysis.displaced_contact import turn_of_body
from bemcontact.analysis.moved_contact import Judgement, MovedContact
from bemcontact.arrays import Array, BoolArray
from bemcontact.assessment.penetration import Misfit
from bemcontact.bem.free_motions import FreeMotions
from bemcontact.cached import cached_property
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.formulations import complementarity
from bemcontact.frozen import frozen

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


@frozen
class SecondMotions:
    """Motions from a first solution to a second one.

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
        why = " against the load" if driven[j] else f": {slopes}" if self._push[j] else ""
        words = (
            f"No contact holds the {motion}{why}. Only slopes and "
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

    def without_unknown(self) -> ContactSolution:
        """The second solution that leaves `unknown` motions where the first one has them: no judgement needs them."""
        if not self.unknown.any():
            return self.solution
        contact, R, left = self.contact, self.contact.rigid_motions @ self._modes, ~self.unknown
        amplitudes = np.linalg.solve(self._modes, self.first.solution.rigid_amplitudes)
        held = contact.offset + R[:, self.unknown] @ amplitudes[self.unknown]
        load = (contact.motion_load @ self._modes)[left]
        there = CondensedContact.from_compliance(
            contact.compliance, held, contact.weights, rigid_motions=R[:, left], motion_load=load
        )
        again = complementarity.solve(there, near=self.first.pressed)
        return replace(again, displacement=there.offset + again.displacement - contact.offset)

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
        if self.solution.status is not Status.SOLVED or not contact.free_motions:
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
