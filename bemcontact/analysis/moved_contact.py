"""Contact beside where its bodies and surfaces are after the motion: how far that is judged, and how it is told."""

from collections.abc import Iterator

import numpy as np

from bemcontact.analysis.displaced_contact import Displaced, displaced
from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.assessment.penetration import Misfit, Penetration, tolerated
from bemcontact.bem.contact_points import ContactPoints
from bemcontact.bem.surface_gaps import SurfaceGaps
from bemcontact.cached import cached_property
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import unseen_ways
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen
from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.problem import Problem

LEAST_ASKED = 0.01
"""Accuracy to which the place is judged, unless a smaller one is asked for. A relative curvature that is off by 2 %
changes the peak of a line contact by half of that (Hertz)."""
NOTED = 0.25
"""Part of this accuracy from which a change is noted: error bars are those of the gaps of the body as it is drawn, and
are mostly a few times smaller than the accuracy."""
WITHHELD = 0.05
"""Change from which a result is not certified: the curvature is off by a tenth."""
UNSEEN = 1e-9
"""Normal displacement of pressed points by a free motion, over the largest one, that is none."""
ALIKE = 0.1
"""Difference of displacements on the boundary, over one of them, up to which the body moves as a whole."""
STILL = 1e-7
"""Motion over the displacement scale of contact that is round-off."""

Judgement = tuple[Penetration | None, tuple[str, ...]]
"""What is so far off that the result is withheld, or else notes."""


def judged_to(problem: Problem) -> float:
    """Accuracy to which the place is judged, also that of the parameter of a state on a path."""
    return min(LEAST_ASKED, problem.asked_accuracy or LEAST_ASKED)


def noted(problem: Problem) -> float:
    """Change of a peak over the largest one, or of a force over itself, from which it is noted."""
    return NOTED * judged_to(problem)


@frozen
class MovedContact:
    """The contact of a solution, and where the motion of this solution takes it.

    Parameters
    ----------
    gaps : between the deformed boundary and the displaced surfaces
    points, contact : before the motion
    solution : with gaps along fixed normals
    """

    gaps: SurfaceGaps
    points: ContactPoints
    contact: CondensedContact
    solution: ContactSolution

    @cached_property
    def moved(self) -> Displaced:
        """The contact points after the motion."""
        return displaced(self.gaps, self.points, self.contact, self.solution)

    @cached_property
    def pressed(self) -> BoolArray:
        """Points (n,) under pressure."""
        return self.contact.pressed(self.solution.pressure, self.solution.displacement)

    @property
    def noted(self) -> float:
        """Change, over the whole, from which it is noted."""
        return noted(self.gaps.problem)

    @property
    def allowed(self) -> float:
        """Distance [L] that is tolerated."""
        return tolerated(self.contact, self.gaps.largest, self.gaps.size)

    def unheld(self) -> Array:
        """Free motions (k, j) that move no point under pressure: an orthonormal basis."""
        return unseen_ways(self.contact.rigid_motions[self.solution.pressure > 0], UNSEEN)

    def contacts(self, pressed: BoolArray) -> Iterator[tuple[int, BoolArray]]:
        """Zone and points (n,) of each unbroken contact, where points are `pressed` (n,)."""
        for run in np.unique(self.contact.run).tolist():
            own = np.flatnonzero(self.contact.run == run)
            stretch = self._stretches(pressed, own)
            for one in np.unique(stretch[pressed[own]]):
                yield int(self.contact.zone[own[0]]), np.isin(np.arange(len(pressed)), own[stretch == one])

    def _stretches(self, pressed: BoolArray, own: IntArray) -> IntArray:
        """Number of the unbroken stretch, pressed or open, of each of the points (k,) of a run."""
        stretch = np.cumsum(np.append(0, np.diff(pressed[own].astype(int)) != 0))
        if np.isfinite(self.contact.run_length[self.contact.run[own[0]]]) and pressed[own[[0, -1]]].all():
            stretch[stretch == stretch[-1]] = 0  # across the seam of a closed run
        return stretch

    def pressed_length(self, i: int) -> float:
        """Length [L] of the unbroken stretch of contact around a pressed point."""
        return next(float(self.contact.weights[own].sum()) for _, own in self.contacts(self.pressed) if own[i])

    def zone(self, i: int) -> str:
        """Name of the zone of a point."""
        return self.contact.zone_names[self.contact.zone[i]]

    def edge(self, i: int) -> str:
        """Name of the edge of a point."""
        element = self.points.element[np.flatnonzero(self.points.point == i)[0]]
        return self.gaps.state.edge_names[self.gaps.state.edge[element]]

    def length(self, value: float) -> str:
        """Write a length [L]."""
        return f"{value:.3g} {self.gaps.problem.units.length}".strip()

    def way(self, motion: Array) -> str:
        """Write a motion (2,) [L]."""
        return self.vector(motion, self.gaps.problem.units.length)

    @staticmethod
    def vector(values: Array, unit: str = "") -> str:
        """Write two numbers, with a unit; what is round-off beside the other is zero."""
        x, y = np.where(abs(values) > 1e-3 * abs(values).max(), values, 0.0) + 0.0
        return f"({x:.4g}, {y:.4g}) {unit}".strip()

    def motion_in(self, within: BoolArray, pressure: Array) -> Array:
        """Motion (2,) [L] of that of some points (n,) whose pressure times motion is largest."""
        weight = np.where(within, pressure, -1.0) * np.hypot(*self.moved.motion.T)
        return self.moved.motion[int(np.argmax(weight))]

    def motion_against(self, zone: str, motion: Array) -> str:
        """Say by how much two bodies, or a body and a rigid surface, move against each other."""
        turns, by = self._still(motion), self.way(motion)
        if isinstance(self.gaps.surfaces[zone], BodySurface):
            return f"both sides of '{zone}' {'turn' if turns else f'move by {by}'} against each other"
        return f"the body {'turns' if turns else f'moves by {by}'} against the surface of '{zone}'"

    def _still(self, motion: Array) -> bool:
        """Whether a motion (2,) [L] is round-off, as that of the only point under pressure on a line of symmetry."""
        return bool(np.hypot(*motion) <= STILL * self.contact.scales.displacement)

    def remedy(self, motion: Array) -> str:
        """What to do about a motion: draw the body there if it moves as a whole."""
        if self._still(motion):
            return "expect an error of this size, or take a program for large displacements"
        displacement = self.gaps.state.displacement.reshape(-1, 2)
        spread = np.hypot(*np.ptp(displacement, axis=0))
        if spread <= ALIKE * np.hypot(*motion):
            one, other = map(self.vector, (motion, -motion))
            return f"draw the body where it touches: move it by {one}, or the surface by {other}"
        return (
            "draw the body near to where it will touch; if it bends as far as that, expect an error of this size, or "
            "take a program for large displacements"
        )

    def judged(self, words: str, *, withheld: bool, i: int, depth: float, allowed: float = 0.0) -> Judgement:
        """A misfit at a contact point, or else a note that error bars do not include it."""
        if not withheld:
            return None, (f"{words}; error bars do not include this",)
        return self.misfit(Misfit.MOVED, f"{words[0].upper()}{words[1:]}.", i, depth, allowed), ()

    def misfit(self, kind: Misfit, words: str, i: int, depth: float, allowed: float = 0.0) -> Penetration:
        """Describe what does not fit at a contact point."""
        x, y = self.contact.points[i].tolist()
        return Penetration(
            kind=kind, depth=depth, allowed=allowed, at=(x, y), edge=self.edge(i), zone=self.zone(i), paired=True,
            words=words,
        )  # fmt: skip
