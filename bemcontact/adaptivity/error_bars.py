"""Error bars: what bisecting every element changes, floored by the change of the pressure as a whole.

A single quantity may change little by accident, where its error passes through zero; the pressure as a whole does not.
"""

from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from bemcontact.adaptivity.fields import Answer, Difference, Solved, norm_squared
from bemcontact.adaptivity.singularities import BESIDE, FITTED, Singularity, run_elements
from bemcontact.adaptivity.zone_runs import Stretch, ZoneRun
from bemcontact.arrays import Array, BoolArray
from bemcontact.bem import reference_element
from bemcontact.serialization import Leaf
from dataclasses import dataclass

SAFETY = 1.5
"""Error bar over the change."""
PEAK, FORCE, END = 0.5, 0.1, 0.1
"""Least changes of a peak, a force and the ends of contact, over that of the pressure as a whole."""
INTENSITY = 3.0
"""Safety of the intensity of an infinite pressure, before `SAFETY`."""
UNKNOWN_EXPONENT = 0.01
"""Least error of the intensity if its exponent is measured."""

Quantity = Literal["peak", "force", "start", "end", "pressure", "displacement", "intensity"]
"""What an error bar is of."""


@dataclass(frozen=True, kw_only=True)
class ErrorBar(Leaf):
    """A quantity with its estimated error."""

    quantity: Quantity
    """What it is: peak pressure, force on a zone, start or end of a contact interval, the pressure as a whole, largest
    displacement, or intensity of an infinite pressure."""
    zone: str | None
    """Name of the contact zone; null for the displacement."""
    interval: int | None = None
    """Number of the contact interval of a start or an end, from 0 on; null for others."""
    value: float | None
    """Value: pressure [p], force per thickness [p L], position along the run of the zone [L], root of the mean square of
    the pressure [p], displacement [L], or intensity K of p = K s^-α [p L^α]; null if there is none."""
    bar: float | None
    """Estimated error, relative to the value, and of a start or an end to the length of its interval; null if unknown."""
    note: str = ""
    """Why there is no value or no error bar, or what they mean."""

    @property
    def promised(self) -> bool:
        """Whether the accuracy asked for applies to it."""
        return self.quantity != "intensity"


def error_bars(difference: Difference, singularities: Sequence[Singularity]) -> tuple[ErrorBar, ...]:
    """Error bars of all quantities of one load case on the fine mesh."""
    whole = _displacement_change(difference)
    slow = max((item.exponent for item in singularities), default=0.5)
    factor = SAFETY / (2 ** (2 * (1 - slow)) - 1) if slow > 0.5 else SAFETY
    bars: list[ErrorBar] = []
    changes = []
    for number, name in enumerate(difference.fine.body.problem.contact_zones):
        its = [item for item in singularities if item.place.zone == name]
        m = pressure_change(difference, number, its)
        changes.append(m)
        bars += [*_zone_bars(difference, number, name, m, factor, its)]
    largest, change = whole
    m = max((m for m in changes if m is not None), default=0.0)
    bars.append(ErrorBar(quantity="displacement", zone=None, value=largest, bar=factor * max(change, m)))
    return tuple(bars)


def pressure_change(difference: Difference, zone: int, singularities: Sequence[Singularity]) -> float | None:
    """‖Δp‖/‖p‖ of a zone, away from infinite pressures; None without pressure."""
    one, two = difference.pair
    compared = ~near_singularities(difference.fine, two, singularities) & (difference.fine.zone_of == zone)
    norm = norm_squared(difference.fine, two.pressure)[compared].sum()
    if not norm > 0:
        return None
    change = (difference.fine.weights * difference.pressure**2).sum(axis=1)[compared].sum()
    return float(np.sqrt(change / norm))


def near_singularities(solved: Solved, answer: Answer, singularities: Sequence[Singularity]) -> BoolArray:
    """Which elements (m,) are so near to an infinite pressure that their pressure is not compared."""
    near = np.zeros(len(solved.mesh.elements), bool)
    for item in singularities:
        run = solved.runs[item.place.run]
        reach = BESIDE * contact_beside(run, answer.stretches[run.number], item.place.position)[1]
        elements = run_elements(solved, run)
        low, high = run.ends[:-1], run.ends[1:]
        away = [np.maximum(low - at, at - high) for at in _images(run, item.place.position)]
        near[elements[np.min(away, axis=0) < reach * (1 - 1e-9)]] = True
    return near


def _images(run: ZoneRun, position: float) -> list[float]:
    """The position, and on a closed run the same one a turn before and after."""
    return [position, position - run.length, position + run.length] if run.closed else [position]


def contact_beside(run: ZoneRun, stretches: Sequence[Stretch], position: float) -> tuple[int, float]:
    """Side (-1 before, 1 after) and length of the longer contact beside a position of a run; 1 and 0 if there is none."""
    best = (1, 0.0)
    for item in stretches:
        for at in _images(run, position):
            if item.start - 1e-9 * run.length <= at <= item.end + 1e-9 * run.length:
                best = max(best, (-1, at - item.start), (1, item.end - at), key=lambda pair: pair[1])
    return best


def _zone_bars(
    difference: Difference, number: int, name: str, m: float | None, factor: float, its: Sequence[Singularity]
) -> Iterator[ErrorBar]:
    """Error bars of a zone: peak, force, ends of contact, pressure, intensities."""
    coarse, fine = difference.coarse, difference.fine
    one, two = difference.pair
    zones = [solved.zone_of == number for solved in (coarse, fine)]
    if m is None:
        yield ErrorBar(quantity="force", zone=name, value=0.0, bar=None, note="no contact in this zone")
        return
    peaks = [float(answer.pressure[zone].max()) for answer, zone in zip((one, two), zones, strict=True)]
    if its:
        note = "infinite at an end of its zone; make the zone longer" if any(i.place.end for i in its) else "infinite"
        yield ErrorBar(quantity="peak", zone=name, value=None, bar=None, note=note)
    else:
        yield ErrorBar(quantity="peak", zone=name, value=peaks[1], bar=SAFETY * max(_change(*peaks), PEAK * m))
    forces = [
        float((solved.mesh.tributary * answer.pressure)[zone].sum())
        for solved, answer, zone in zip((coarse, fine), (one, two), zones, strict=True)
    ]
    yield ErrorBar(quantity="force", zone=name, value=forces[1], bar=factor * max(_change(*forces), FORCE * m))
    yield from _end_bars(difference, name, m, factor)
    square = norm_squared(fine, two.pressure)[zones[1]].sum() / fine.weights[zones[1]].sum()
    yield ErrorBar(
        quantity="pressure", zone=name, value=float(np.sqrt(square)), bar=factor * m,
        note="away from infinite pressures" if its else "",
    )  # fmt: skip
    for item in its:
        if not item.like_a_kink:
            yield _intensity_bar(difference, item)


def _change(before: float, after: float) -> float:
    """Relative change."""
    return abs(after - before) / abs(after) if after else 0.0


def _end_bars(difference: Difference, name: str, m: float, factor: float) -> Iterator[ErrorBar]:
    """Error bars of the ends of all contact intervals of a zone."""
    one, two = difference.pair
    count = 0
    for run in difference.fine.runs:
        if run.zone != name:
            continue
        stretches, before = two.stretches[run.number], one.stretches[run.number]
        alike = len(stretches) == len(before)
        for i, item in enumerate(stretches):
            length = item.end - item.start
            for which, free in (("start", item.start_free), ("end", item.end_free)):
                position = getattr(item, which)
                if not alike:
                    note = "the number of contact intervals changed when the mesh was bisected"
                    yield ErrorBar(quantity=which, zone=name, interval=count, value=position, bar=None, note=note)
                    continue
                if not free:
                    note = "contact reaches a corner or the end of its zone"
                    yield ErrorBar(quantity=which, zone=name, interval=count, value=position, bar=0.0, note=note)
                    continue
                moved = abs(position - getattr(before[i], which))
                moved = min(moved, abs(run.length - moved)) if run.closed else moved
                change = max(moved / length, END * m, _spacing(run, position) / length)
                yield ErrorBar(quantity=which, zone=name, interval=count, value=position, bar=factor * change)
            count += 1


def _spacing(run: ZoneRun, position: float) -> float:
    """Distance of the nodes of a run at a position [L]."""
    at = position % run.length if run.closed else position
    i = int(np.clip(np.searchsorted(run.ends, at) - 1, 0, len(run.ends) - 2))
    return float(run.ends[i + 1] - run.ends[i]) / 2


def _displacement_change(difference: Difference) -> tuple[float, float]:
    """Largest displacement [L], and its relative change."""
    sizes = [float(np.hypot(*np.moveaxis(answer.displacement, 2, 0)).max()) for answer in difference.pair]
    return sizes[1], _change(*sizes)


def _intensity_bar(difference: Difference, item: Singularity) -> ErrorBar:
    """Error bar of the intensity K of an infinite pressure K s^-α."""
    one, two = difference.pair
    coarse = _intensity(difference.coarse, one, item, 4)
    fine, cubic = _intensity(difference.fine, two, item, 4), _intensity(difference.fine, two, item, 3)
    least = 0.0 if item.exponent in (1 / 2, 2 / 3) else UNKNOWN_EXPONENT
    note = f"p = K s^-{item.exponent:.3g}"
    if coarse is None or fine is None or cubic is None:
        return ErrorBar(quantity="intensity", zone=item.place.zone, value=None, bar=None, note=note)
    change = max(INTENSITY * _change(coarse, fine), _change(cubic, fine), least)
    return ErrorBar(quantity="intensity", zone=item.place.zone, value=fine, bar=SAFETY * change, note=note)


def _intensity(solved: Solved, answer: Answer, item: Singularity, degree: int) -> float | None:
    """K from a polynomial through p s^α at Gauss points beside the place."""
    run = solved.runs[item.place.run]
    side, length = contact_beside(run, answer.stretches[run.number], item.place.position)
    xi, _ = reference_element.gauss_legendre(2)
    pressure = (reference_element.values(xi) @ answer.pressure[run_elements(solved, run), :, None])[..., 0]
    at = (run.ends[:-1, None] + run.ends[1:, None]) / 2 + np.diff(run.ends)[:, None] / 2 * xi
    s: Array = np.min([np.where(side * (at - image) > 0, side * (at - image), np.inf)
                       for image in _images(run, item.place.position)], axis=0)
    low, high = FITTED[0] * length, FITTED[1] * length
    used = (s >= low) & (s <= high) & (pressure > 0)
    if used.sum() < 2 * degree:
        return None
    return float(np.polynomial.Polynomial.fit(s[used], pressure[used] * s[used] ** item.exponent, degree)(0.0))
