"""Error bars: what bisecting every element changes, floored by the change of the pressure as a whole.

A single quantity may change little by accident, where its error passes through zero; the pressure as a whole does not.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from bemcontact.adaptivity.fields import CaseAnswer, MeshDifference, Solved, norm_squared, penetrations
from bemcontact.adaptivity.hidden_changes import hidden_change, hidden_displacement
from bemcontact.adaptivity.singularities import BESIDE, FITTED, Singularity, logarithmic_rise, run_elements
from bemcontact.adaptivity.zone_runs import ZoneRun, contact_beside, images
from bemcontact.arrays import Array, BoolArray, IntArray, magnitudes
from bemcontact.assessment.accuracy import ErrorBar
from bemcontact.bem import reference_element
from bemcontact.bem.body_motions import amounts
from bemcontact.contact.free_motions import angle_of_round_off

SAFETY = 1.5
"""Error bar over the change."""
PEAK, FORCE, END = 1.0, 0.25, 0.1
"""Least changes of a peak, a force and the ends of contact, over that of the pressure as a whole."""
INTENSITY, INTENSITY_FLOOR = 3.0, 5.0
"""Factors of the change of the intensity of an infinite pressure, and of that of the pressure, before `SAFETY`."""
UNKNOWN_EXPONENT = 0.01
"""Least error of the intensity if its exponent is measured."""
NOTHING = 1e-9
"""Motion or difference over the largest displacement, or of the pressure over itself, that is round-off."""

LEAST_POINTS = 5
"""Points in contact in an interval, those of two elements, below which bisecting elements does not tell the error."""
MOST_PLACES = 3
"""Number of places of an infinite pressure that are named besides the first."""
COMES_OR_GOES = "contact in {} comes or goes when every element is bisected"
"""Note on a zone that is under pressure on one of two meshes only."""
CHANGES = "the number of contact intervals changes when every element is bisected"
"""Note on an end of contact that one of two meshes does not have."""
TIP_ELEMENTS = 2
"""Number of elements beside an infinite pressure that its intensity is not fitted to."""


def error_bars(
    difference: MeshDifference, singularities: Sequence[Singularity], *, of_fine: bool = True, searched: bool = False
) -> tuple[ErrorBar, ...]:
    """Error bars of all quantities of one load case on the fine mesh, or on the coarse one.

    The error on the coarse mesh is at most the change, plus the error on the fine one. Where a mesh that was not
    `searched` for this state does not resolve contact in one place, none of its error bars is known: forces and
    displacements depend on all places. Then the note says what the change alone would give.
    """
    bars = tuple(_bars(difference, singularities, of_fine))
    if searched or not (note := why_unresolved(difference, of_fine=of_fine)):
        return bars
    return tuple(replace(item, bar=None, note=item.note or _with_change(note, item.bar)) for item in bars)


def _with_change(note: str, bar: float | None) -> str:
    """Why an error is not known, and what would follow from the change of a number."""
    return f"{note}; by the change when every element is bisected it is about {100 * bar:.2g} %" if bar else note


def why_unresolved(difference: MeshDifference, *, of_fine: bool) -> str:
    """Why bisecting elements does not tell the error of the fine mesh, or of the coarse one; empty if it does."""
    one, two = difference.pair
    reported = two if of_fine else one
    for run in difference.coarse.runs:
        for item in reported.stretches[run.number]:
            if item.points < LEAST_POINTS:
                return f"too few points in contact to estimate it ({item.points} in an interval of {run.zone})"
    names = [*difference.coarse.body.problem.zones]
    for number, name in enumerate(names):
        if one.pressure[number].any() != two.pressure[number].any():
            return COMES_OR_GOES.format(name)
    for solved, answer in ((difference.coarse, one), (difference.fine, two)):
        if next(penetrations(solved, answer), None):
            return "a surface passes between the nodes"
    return ""


def _bars(difference: MeshDifference, singularities: Sequence[Singularity], of_fine: bool) -> Iterator[ErrorBar]:
    """Error bars as if the coarse mesh resolved contact."""
    slow = max((item.exponent for item in singularities), default=0.5)
    estimate = _Estimate(difference, SAFETY / (2 ** (2 * (1 - slow)) - 1) if slow > 0.5 else SAFETY, of_fine)
    changes = [0.0]
    for number, name in enumerate(difference.fine.body.problem.zones):
        its = [item for item in singularities if item.place.zone == name]
        m = pressure_change(difference, number, its)
        if m is None:
            solved, answer = estimate.reported
            force = solved.force(answer, number)
            note = "" if force > 0 else "no contact in this zone"  # on the other mesh alone, see `why_unresolved`
            yield ErrorBar(quantity="force", zone=name, value=force, bar=None, note=note)
            continue
        hidden = hidden_change(difference, number)
        m = max(m, hidden)
        changes.append(m)
        yield from _zone_bars(estimate, number, name, m, hidden, its)
    changes.append(hidden_displacement(difference))
    sizes = [answer.largest_displacement for answer in difference.pair]
    softest = min(part.material.young_modulus for part in difference.fine.body.problem.parts)
    strain = float(estimate.reported[1].pressure.max(initial=0.0)) / softest
    if max(sizes) <= NOTHING * strain * difference.fine.mesh.size:  # a body that is pressed and cannot move
        yield ErrorBar(quantity="displacement", zone=None, value=0.0, bar=0.0)
        return
    bar = estimate.bar(max(_change(*sizes), *changes))
    at = _farthest(*estimate.reported)
    yield ErrorBar(quantity="displacement", zone=None, value=estimate.value(*sizes), bar=bar, at=at)
    yield from _motion_bars(estimate, max(changes), max(sizes))


@dataclass(frozen=True, eq=False)
class _Estimate:
    """Which of two meshes the answer is taken from, and the error bar that follows from their difference."""

    difference: MeshDifference
    factor: float
    of_fine: bool

    def value(self, coarse: float, fine: float) -> float:
        """The value that is reported."""
        return fine if self.of_fine else coarse

    def bar(self, change: float, *, smooth: bool = False) -> float:
        """Error bar for a relative change; `smooth` tells that singularities elsewhere do not slow its convergence."""
        return (SAFETY if smooth else self.factor) * change + (0.0 if self.of_fine else change)

    @property
    def reported(self) -> tuple[Solved, CaseAnswer]:
        """Mesh and answer that are reported."""
        one, two = self.difference.pair
        return (self.difference.fine, two) if self.of_fine else (self.difference.coarse, one)


def _farthest(solved: Solved, answer: CaseAnswer) -> tuple[float, float] | None:
    """Node that is displaced most; None if there are several of this kind, or if none is."""
    moved = magnitudes(answer.displacement)
    nodes = np.unique(solved.mesh.nodes[solved.mesh.elements[moved >= (1 - NOTHING) * moved.max()]], axis=0)
    return solved.mesh.place(nodes[0]) if len(nodes) == 1 else None


def _place(solved: Solved, singularity: Singularity) -> tuple[float, float]:
    """Place of an infinite pressure [L]."""
    return solved.mesh.place(solved.run(singularity.place.run).point(singularity.place.position))


def _motion_bars(estimate: _Estimate, m: float, largest: float) -> Iterator[ErrorBar]:
    """Error bars of the free motions of the body, and of the places and rotations of tools that are free to move.

    Of what is round-off beside the largest displacement [L] there is none.
    """
    size, answer = estimate.difference.fine.mesh.size, estimate.reported[1]
    if not all(answer.pressure.any() for answer in estimate.difference.pair):
        return  # nothing determines them
    contact, p = answer.condensation.contact, answer.solution.pressure
    least = angle_of_round_off(contact.points, contact.normals, p > 0)
    undetermined = {name for item in estimate.difference.pair for name in item.solution.undetermined}
    for one, two in zip(*map(motions, estimate.difference.pair), strict=True):
        if any(name in (one.mover, two.mover) or name.endswith(f" of the tool '{one.mover}'") for name in undetermined):
            continue  # chosen by a rule
        mover = two.mover if estimate.of_fine else one.mover  # a center may differ by the error of the mesh
        value = estimate.value(one.size, two.size)
        turns = one.quantity == "rotation"
        if abs(value) * (size if turns else 1.0) > NOTHING * largest and not (turns and abs(value) <= least):
            change = float(np.linalg.norm(two.amount - one.amount)) / abs(value)
            noise = m * largest / (abs(value) * (size if turns else 1.0))  # a motion this small is that of the mesh
            bar = estimate.bar(max(change, m, noise if noise > 1.0 else 0.0))
            yield ErrorBar(quantity=one.quantity, zone=None, mover=mover, value=value, bar=bar)


class _Motion(NamedTuple):
    """An amplitude or an angle, or the displacement of the point of a tool."""

    quantity: Literal["motion", "rotation"]
    mover: str
    amount: Array

    @property
    def size(self) -> float:
        """The number, or the length of the displacement."""
        return float(self.amount[0] if len(self.amount) == 1 else np.hypot(*self.amount))


def motions(answer: CaseAnswer) -> Iterator[_Motion]:
    """Motions along the free ways of the body, and of tools that are free."""
    contact, amplitudes = answer.condensation.contact, answer.solution.rigid_amplitudes
    body = answer.condensation.body
    amount = amounts(body, amplitudes, answer.state.displacement)
    for j, name in enumerate(contact.motion_names):
        if " of the tool " in name:
            continue  # reported with the tool
        yield _Motion("rotation" if np.isfinite(body.seen.arms[j]) else "motion", name, amount[j : j + 1])
    moved = contact.tools.displacement(amplitudes)
    for name, place, free in zip(contact.tools.names, moved, contact.tools.free.reshape(-1, 3), strict=True):
        if free[:2].any():
            yield _Motion("motion", name, place[:2])
        if free[2]:
            yield _Motion("rotation", name, place[2:])


def pressure_change(difference: MeshDifference, zone: int, singularities: Sequence[Singularity]) -> float | None:
    """‖Δp‖/‖p‖ of a zone, away from infinite pressures if there is pressure away from them; None without pressure."""
    _, two = difference.pair
    norm = norm_squared(difference.fine, two.pressure[zone])
    if not norm.sum() > 0:
        return None
    change = (difference.fine.weights * difference.pressure[zone] ** 2).sum(axis=1)
    compared = ~near_singularities(difference.fine, two, singularities)
    if not norm[compared].sum() > 0:
        compared[:] = True
    return float(np.sqrt(change[compared].sum() / norm[compared].sum()))


def near_singularities(solved: Solved, answer: CaseAnswer, singularities: Sequence[Singularity]) -> BoolArray:
    """Which elements (m,) are so near to an infinite pressure that their pressure is not compared."""
    near = np.zeros(len(solved.mesh.elements), bool)
    for item in singularities:
        run = solved.run(item.place.run)
        reach = BESIDE * contact_beside(run, answer.stretches[run.number], item.place.position)[1]
        elements = run_elements(solved, run)
        low, high = run.ends[:-1], run.ends[1:]
        away = [np.maximum(low - at, at - high) for at in images(run, item.place.position)]
        near[elements[np.min(away, axis=0) < reach * (1 - 1e-9)]] = True
    return near


def _zone_bars(
    estimate: _Estimate, number: int, name: str, m: float, hidden: float, its: Sequence[Singularity]
) -> Iterator[ErrorBar]:
    """Error bars of a zone under pressure: peak, force, ends of contact, pressure, intensities."""
    both = [*zip((estimate.difference.coarse, estimate.difference.fine), estimate.difference.pair, strict=True)]
    peaks = [float(answer.pressure[number].max()) for _, answer in both]
    if its:
        places = [_place(estimate.difference.fine, item) for item in its]
        at = max(zip(its, places, strict=True), key=lambda pair: pair[0].exponent)[1]
        others = [f"({x:.5g}, {y:.5g})" for x, y in places if (x, y) != at]
        more = (
            f"; also at {', '.join(others)}" if len(others) <= MOST_PLACES else f"; also at {len(others)} other places"
        )
        yield ErrorBar(
            quantity="peak", zone=name, value=None, bar=None, at=at, note=_infinite(its) + more * bool(others)
        )
    else:
        bar = estimate.bar(max(_change(*peaks), PEAK * m), smooth=True) + logarithmic_rise(estimate.difference, name)
        yield ErrorBar(quantity="peak", zone=name, value=estimate.value(*peaks), bar=bar)
    forces = [solved.force(answer, number) for solved, answer in both]
    turned = float(np.linalg.norm(both[1][1].force_vector(number) - both[0][1].force_vector(number))) / forces[1]
    bar = estimate.bar(max(_change(*forces), turned, FORCE * m, hidden))
    yield ErrorBar(quantity="force", zone=name, value=estimate.value(*forces), bar=bar)
    yield from _end_bars(estimate, name, m)
    solved, answer = estimate.reported
    problem = solved.body.problem
    length = sum(problem.edge(edge).length for edge in problem.edges_of(name))  # of which contact may see a part
    square = norm_squared(solved, answer.pressure[number]).sum() / length
    value, note = (None, "away from infinite pressures") if its else (float(np.sqrt(square)), "")
    yield ErrorBar(quantity="pressure", zone=name, value=value, bar=estimate.bar(m), note=note)
    for item in its:
        if not item.like_a_kink:
            yield _intensity_bar(estimate.difference, item, m)


def _infinite(its: Sequence[Singularity]) -> str:
    """Say why a peak is infinite."""
    if any(item.place.bonded for item in its):
        return "infinite where a bond begins, because of different materials or a corner of the interface there"
    if any(item.place.end and not item.place.corner and not item.like_a_kink for item in its):
        return "infinite where contact reaches the end of its zone: a corner of the surface, or else a zone too short"
    if any(item.exponent == 0 for item in its):
        return (
            "infinite like a logarithm, or nearly so: at a kink of the surface or the body (draw a curve as arcs or a "
            "spline, not as lines), or at a corner because of its angle, a shear load beside the contact, or a surface "
            "at an angle to the edge"
        )
    if any(item.place.end for item in its):
        return "infinite where contact reaches a corner of the body"
    return (
        "infinite at a corner or a kink of the body or the surface; where it should be smooth, draw an arc or a fillet"
    )


def _change(before: float, after: float) -> float:
    """Relative change."""
    return abs(after - before) / abs(after) if after else 0.0


def _end_bars(estimate: _Estimate, name: str, m: float) -> Iterator[ErrorBar]:
    """Error bars of the ends of all contact intervals of a zone, and of their lengths: both ends together."""
    one, two = estimate.difference.pair
    solved, answer = estimate.reported
    count = 0
    for run in solved.runs:
        if run.zone != name:
            continue
        if run.number in answer.around:
            on_both = run.number in one.around and run.number in two.around
            yield ErrorBar(
                quantity="length", zone=name, interval=count, value=run.length, bar=0.0 if on_both else None,
                note="contact all around has no ends: this is the length of the edges" if on_both else CHANGES,
            )  # fmt: skip
            count += 1
        before, after = one.stretches[run.number], two.stretches[run.number]
        for i, item in enumerate(answer.stretches[run.number]):
            ends: tuple[tuple[Literal["start", "end"], bool], ...]
            ends = ("start", item.start_free), ("end", item.end_free)
            length, errors, note = item.end - item.start, list[float | None](), ""
            for which, free in ends:
                position = float(getattr(item, which))
                bonded = solved.body.points.bonded_ends[run.number, int(which == "end")]
                at_bond = bonded and position == (run.length if which == "end" else 0.0)
                bar, note = 0.0, "contact reaches " + ("the bond" if at_bond else "a corner or the end of its zone")
                if len(before) != len(after):
                    bar, note = None, CHANGES
                elif free:
                    moved = abs(getattr(after[i], which) - getattr(before[i], which))
                    moved = min(moved, abs(run.length - moved)) if run.closed else moved
                    change = max(moved / length, END * m)
                    bar = max(estimate.bar(change), estimate.factor * run.element_at(position) / 2 / length)
                    note = ""
                errors.append(bar)
                at = solved.mesh.place(run.point(position))
                yield ErrorBar(quantity=which, zone=name, interval=count, value=position, bar=bar, at=at, note=note)
            both = None if None in errors else sum(filter(None, errors))
            why = note if both is None else ""
            yield ErrorBar(quantity="length", zone=name, interval=count, value=float(length), bar=both, note=why)
            count += 1


def _intensity_bar(difference: MeshDifference, item: Singularity, m: float) -> ErrorBar:
    """Error bar of the intensity K of an infinite pressure K s^-α."""
    least = 0.0 if item.exact else UNKNOWN_EXPONENT
    note = f"p = K s^-{item.exponent:.4g}"
    bar = ErrorBar(
        quantity="intensity", zone=item.place.zone, value=None, bar=None, note=note,
        at=_place(difference.fine, item),
    )  # fmt: skip
    fits = [fit for part in FITTED if (fit := _fitted(difference, item, part))]
    if not fits:
        return bar
    value, change = min(fits, key=lambda fit: fit[1])
    change = max(change, INTENSITY_FLOOR * m, least, *(_change(other, value) for other, _ in fits))
    return replace(bar, value=value, bar=SAFETY * change)


def _fitted(difference: MeshDifference, item: Singularity, part: tuple[float, float]) -> tuple[float, float] | None:
    """K on a part of the contact, and its relative change from mesh to mesh and by the degree; None without points."""
    one, two = difference.pair
    coarse = _intensity(difference.coarse, one, item, 4, part)
    fine, cubic = (_intensity(difference.fine, two, item, degree, part) for degree in (4, 3))
    if coarse is None or fine is None or cubic is None:
        return None
    return fine, max(INTENSITY * _change(coarse, fine), _change(cubic, fine))


def elements_beside(run: ZoneRun, position: float) -> IntArray:
    """Places in a run of the two elements on either side of a position, which do not follow an infinite pressure."""
    at, count = int(np.argmin(np.abs(run.ends - position))), len(run.ends) - 1
    near = np.arange(at - TIP_ELEMENTS, at + TIP_ELEMENTS)
    return near % count if run.closed else near[(near >= 0) & (near < count)]


def _intensity(
    solved: Solved, answer: CaseAnswer, item: Singularity, degree: int, part: tuple[float, float]
) -> float | None:
    """K from a polynomial through p s^α at Gauss points beside the place."""
    run = solved.run(item.place.run)
    side, length = contact_beside(run, answer.stretches[run.number], item.place.position)
    xi, _ = reference_element.gauss_legendre(2)
    own = answer.pressure[[*solved.body.problem.zones].index(run.zone)]
    pressure = (reference_element.values(xi) @ own[run_elements(solved, run), :, None])[..., 0]
    at = (run.ends[:-1, None] + run.ends[1:, None]) / 2 + np.diff(run.ends)[:, None] / 2 * xi
    s: Array = np.min(
        [np.where(side * (at - image) > 0, side * (at - image), np.inf) for image in images(run, item.place.position)],
        axis=0,
    )
    beside = s[elements_beside(run, item.place.position)]
    beside = float(beside[np.isfinite(beside)].max(initial=0.0))
    low, high = max(part[0] * length, beside), part[1] * length
    used = (s > low) & (s <= high) & (pressure > 0)
    if used.sum() < 2 * degree:
        return None
    along = np.sqrt(s[used]) if item.place.bonded else s[used]  # beside a bond λ is a multiple of 1/2
    return float(np.polynomial.Polynomial.fit(along, pressure[used] * s[used] ** item.exponent, degree)(0.0))
