"""Places where the pressure is infinite: ends of contact that are not free, corners and kinks under pressure."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from bemcontact.adaptivity.fields import MeshDifference, Solved
from bemcontact.adaptivity.first_sizes import surface_corners
from bemcontact.adaptivity.zone_runs import ZoneRun
from bemcontact.arrays import IntArray

GROWING = 1.04, 1.9
"""Growth of the pressure at a place by bisection between which it may be infinite."""
LASTING = 0.6
"""Least growth at a place over that of the pass before, both less one."""
FINER = 0.75
"""Largest element at a place over that two passes before."""
HIGH = 1.2
"""Least pressure at a place over the mean pressure of the contact in its zone."""
KINK = 0.25
"""Exponent below which the pressure is infinite like a logarithm, as at a kink of the surface."""
KNOWN_EXPONENTS = 1 / 2, 2 / 3
SNAP = 0.03
"""Difference of a measured exponent from a known one that is taken for this."""
BESIDE = 0.05
"""Part of the contact beside an infinite pressure on which the pressure is not compared."""
FITTED = 0.02, 0.4
"""Parts of the contact between which the intensity is fitted."""
SAME = 1e-6
"""Distance of two places over the length of their run up to which they are one."""


@dataclass(frozen=True, kw_only=True)
class ContactPlace:
    """A place on a run where the pressure may be infinite."""

    run: int
    zone: str
    position: float
    """On the run [L]."""
    end: bool = False
    """Whether contact reaches the end of its zone there."""
    corner: bool = False
    """Whether the boundary or the surface has a corner there."""


@dataclass(frozen=True, kw_only=True)
class Singularity:
    """A place where the pressure is infinite like s^-α."""

    place: ContactPlace
    exponent: float
    """α."""

    @property
    def like_a_kink(self) -> bool:
        """Whether the pressure grows as slowly as a logarithm."""
        return self.exponent < KINK


@dataclass(kw_only=True)
class _History:
    """Growth of the pressure at a place by bisection, and the element there, pass by pass."""

    place: ContactPlace
    case: int
    growth: list[float] = field(default_factory=list)
    element: list[float] = field(default_factory=list)
    exponent: float | None = None

    def grows(self) -> bool:
        """Whether the pressure grew twice running, and no slower, on smaller elements."""
        if len(self.growth) < 3:
            return False
        before, now = self.growth[-2:]
        low, high = GROWING
        lasts = low < before < high and low < now < high and now - 1 > LASTING * (before - 1)
        return lasts and self.element[-1] < FINER * self.element[-3]


@dataclass(kw_only=True)
class Watch:
    """Watches the pressure at places from pass to pass; what it has found to be infinite stays so."""

    histories: list[_History] = field(default_factory=list)

    def look(self, difference: MeshDifference) -> tuple[Singularity, ...]:
        """Look at all places of one load case on a mesh; list those where the pressure is infinite."""
        coarse, case = difference.coarse, difference.number
        one, two = difference.pair
        for place in _places(difference):
            history = self._history(place, case, SAME * coarse.runs[place.run].length)
            elements = elements_at(coarse, coarse.runs[place.run], place.position)
            zone = [*coarse.body.problem.contact_zones].index(place.zone)
            low = float(one.pressure[zone, elements].max())
            high = float(two.pressure[zone, np.concatenate([2 * elements, 2 * elements + 1])].max())
            pressed = coarse.weights * (one.pressure[zone] > 0)
            force = float((pressed * one.pressure[zone]).sum())
            history.growth.append(high / low if low * pressed.sum() > HIGH * force > 0 else 1.0)
            history.element.append(float(coarse.weights[elements].sum(axis=1).min()))
            if history.grows() or (history.exponent is not None and GROWING[0] < history.growth[-1] < GROWING[1]):
                history.exponent = _snapped(float(np.log2(history.growth[-1])))
        return tuple(
            Singularity(place=item.place, exponent=item.exponent)
            for item in self.histories
            if item.case == case and item.exponent is not None
        )

    def _history(self, place: ContactPlace, case: int, same: float) -> _History:
        """The history of a place under a load case, a new one if there is none."""
        for item in self.histories:
            if item.case == case and item.place.run == place.run and abs(item.place.position - place.position) <= same:
                return item
        self.histories.append(_History(place=place, case=case))
        return self.histories[-1]


def _snapped(exponent: float) -> float:
    """The known exponent if it is near."""
    nearest = min(KNOWN_EXPONENTS, key=lambda known: abs(known - exponent))
    return nearest if abs(nearest - exponent) <= SNAP else exponent


def _places(difference: MeshDifference) -> Iterator[ContactPlace]:
    """Ends of contact that are not free, and corners of the boundary and of the surface."""
    coarse = difference.coarse
    one, _ = difference.pair
    for run in coarse.runs:
        for item in one.stretches[run.number]:
            for position, free in ((item.start, item.start_free), (item.end, item.end_free)):
                if not free:
                    at = position % run.length if run.closed else position
                    end = not run.closed and min(at, run.length - at) <= 1e-9 * run.length
                    yield ContactPlace(run=run.number, zone=run.zone, position=at, end=end, corner=not end)
        for position, corner in zip(run.joints, run.corner, strict=True):
            if corner and (run.closed or 0 < position < run.length):
                yield ContactPlace(run=run.number, zone=run.zone, position=float(position), corner=True)
        surface = coarse.body.problem.contact_zones[run.zone].surface
        for edge, start in zip(run.edges, run.joints, strict=False):
            for fraction in surface_corners(edge, surface):
                yield ContactPlace(run=run.number, zone=run.zone, position=start + fraction * edge.length, corner=True)


def elements_at(solved: Solved, run: ZoneRun, position: float) -> IntArray:
    """The one or two elements of a run at a position."""
    at = int(np.argmin(np.abs(run.ends - position)))
    first = run_elements(solved, run)
    count = len(first)
    if run.closed:
        return first[[(at - 1) % count, at % count]]
    return first[max(at - 1, 0) : at + 1]


def run_elements(solved: Solved, run: ZoneRun) -> IntArray:
    """Elements of a run in the order of the boundary."""
    return solved.body.points.elements_of_run[run.number]
