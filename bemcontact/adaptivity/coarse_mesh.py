"""Error bars of a stated mesh that is too coarse to tell its own errors: how far it is from a mesh that was found.

The error is at most the difference of the two answers and the error of the second one, which its error bars tell.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bemcontact.adaptivity.error_bars import motions
from bemcontact.adaptivity.fields import CaseAnswer, Solved
from bemcontact.adaptivity.singularities import run_elements
from bemcontact.adaptivity.zone_runs import ZoneRun
from bemcontact.arrays import Array
from bemcontact.assessment.accuracy import ErrorBar
from bemcontact.bem import reference_element
from bemcontact.frozen import frozen

FOUND = "by the difference from a mesh that was found: this one is too coarse to tell its own error"
"""Note on such an error bar."""
OTHER = "on a mesh that was found, contact is in other zones, or in another number of intervals"
"""Note where the two meshes cannot be compared."""
GAUSS_POINTS = 3
"""Points of integration between two element ends, for the square of a difference of quadratic pressures."""


@frozen
class CoarseMesh:
    """A stated mesh beside one that was found for the same problem, under one load case.

    Parameters
    ----------
    own, finer : the stated mesh and the other one
    number : of the load case
    known : error bars of the other mesh
    """

    own: Solved
    finer: Solved
    number: int
    known: Sequence[ErrorBar]

    @property
    def pair(self) -> tuple[CaseAnswer, CaseAnswer]:
        """The answers on both meshes."""
        return self.own.answers[self.number], self.finer.answers[self.number]

    def bars(self, stated: Sequence[ErrorBar]) -> tuple[ErrorBar, ...]:
        """The entries of the stated mesh with error bars, of which none is known if contact is not alike on both."""
        one, two = ((_contact(answer), answer.around) for answer in self.pair)
        if one != two:
            return tuple(unknown(item, OTHER) for item in stated)
        there = {_of(item): item for item in self.known}
        return tuple(self._with_bar(item, there[_of(item)]) if _of(item) in there else item for item in stated)

    def _with_bar(self, item: ErrorBar, other: ErrorBar) -> ErrorBar:
        """An entry with the error bar that follows from its like on the other mesh; as it is if none does."""
        if item.quantity == "intensity":
            return item
        if item.quantity == "peak" and other.value is None:
            return other
        if item.value is None or other.value is None or other.bar is None:
            return item
        size, scale = abs(item.value), abs(other.value)
        away = abs(other.value - item.value)
        match item.quantity:
            case "start" | "end":
                run, size, scale = self._interval(item)
                away = min(away, abs(run.length - away)) if run.closed else away
            case "force":
                number = [*self.own.body.problem.zones].index(str(item.zone))
                one, two = (answer.force_vector(number) for answer in self.pair)
                away = max(away, float(np.linalg.norm(two - one)))
            case "pressure":
                away, size, scale = self._pressures(str(item.zone))
            case "motion" | "rotation":
                away = self._moved_apart(item)
        size = min(size, scale)  # so that it holds relative to the true value too
        return replace(item, bar=(away + other.bar * scale) / size, note=FOUND) if size > 0 else item

    def _interval(self, item: ErrorBar) -> tuple[ZoneRun, float, float]:
        """The run of a contact interval, and its length on both meshes [L]."""
        number = item.interval or 0
        for run in self.own.runs:
            if run.zone != item.zone:
                continue
            count = run.number in self.pair[0].around
            for one, two in zip(*(answer.stretches[run.number] for answer in self.pair), strict=True):
                if count == number:
                    return run, one.end - one.start, two.end - two.start
                count += 1
            number -= count
        raise AssertionError(item)

    def _pressures(self, zone: str) -> tuple[float, float, float]:
        """Norms of the difference of the pressures on a zone, and of both [p L^1/2]."""
        sums = np.zeros(3)
        for run in (run for run in self.own.runs if run.zone == zone):
            other = self.finer.run(run.number)
            ends = np.union1d(run.ends, other.ends)
            xi, weights = reference_element.gauss_legendre(GAUSS_POINTS)
            half = np.diff(ends)[:, None] / 2
            at, weights = (ends[:-1, None] + half + half * xi).ravel(), (half * weights).ravel()
            one, two = self._pressure_at(0, run, at), self._pressure_at(1, other, at)
            sums += weights @ np.stack([one - two, one, two], axis=1) ** 2
        return tuple(np.sqrt(sums).tolist())

    def _pressure_at(self, which: int, run: ZoneRun, at: Array) -> Array:
        """Pressure on the stated mesh or the other one at positions of a run [p]."""
        solved = (self.own, self.finer)[which]
        own = self.pair[which].pressure[[*solved.body.problem.zones].index(run.zone)]
        element = np.clip(np.searchsorted(run.ends, at) - 1, 0, len(run.ends) - 2)
        low, high = run.ends[element], run.ends[element + 1]
        shapes = reference_element.values((2 * at - low - high) / (high - low))
        return (shapes * own[run_elements(solved, run)[element]]).sum(axis=1)

    def _moved_apart(self, item: ErrorBar) -> float:
        """Distance of the motions of an entry on both meshes."""
        one, two = (
            next(each.amount for each in motions(answer) if (each.quantity, each.mover) == (item.quantity, item.mover))
            for answer in self.pair
        )
        return float(np.linalg.norm(two - one))


def unknown(item: ErrorBar, why: str) -> ErrorBar:
    """An entry whose error is not known, with the reason unless it had one."""
    return replace(item, bar=None, note=item.note if item.bar is None else why)


def _contact(answer: CaseAnswer) -> tuple[list[bool], dict[int, int]]:
    """Which zones are under pressure, and the number of stretches of contact on each run."""
    counts = {run: len(its) for run, its in answer.stretches.items()}
    return [bool(own.any()) for own in answer.pressure], counts


def _of(item: ErrorBar) -> tuple[str, str | None, str | None, int | None]:
    """What an error bar is of."""
    return item.quantity, item.zone, item.mover, item.interval
