"""Places where the pressure is infinite: ends of contact that are not free, corners and kinks under pressure."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from bemcontact.adaptivity.corner_wedges import wedge_at, wedges_at
from bemcontact.adaptivity.fields import CaseAnswer, MeshDifference, Solved
from bemcontact.adaptivity.wedge_exponents import (
    BONDED,
    Face,
    Wedges,
    beside_bond,
    contact_face,
    slow_change,
    wedge_exponents,
)
from bemcontact.adaptivity.zone_runs import ZoneRun, contact_beside
from bemcontact.arrays import IntArray
from bemcontact.bem.mesh import CORNER
from bemcontact.frozen import frozen_value
from bemcontact.problems.curves import cross
from bemcontact.problems.nearest_places import surface_corners

GROWING = 1.04, 1.9
"""Growth of the pressure at a place by bisection between which it may be infinite."""
PASSES = 3
"""Number of passes after which growth is looked at."""
LASTING = 0.6
"""Least growth at a place over that of the pass before, both less one."""
FINER = 0.75
"""Largest element at a place over that two passes before."""
HIGH = 1.2
"""Least pressure at a place over the mean pressure of the contact in its zone."""
KINK = 0.25
"""Exponent below which the pressure is infinite like a logarithm, as at a kink of the surface."""
SNAP = 0.05
"""Difference of a measured exponent from one of the wedge there that is taken for this."""
BESIDE = 0.05
"""Part of the contact beside an infinite pressure on which the pressure is not compared."""
FITTED = (0.005, 0.1), (0.02, 0.4)
"""Parts of the contact between which the intensity is fitted: nearer, where elements are short enough, and farther.

On a half-plane p s^α is a polynomial in s; beside other corners it has other powers, and the difference tells them.
"""
SHARP = 1e-4
"""Rounding of a corner over the contact up to which its pressure must be right."""
STRAIGHT = 1e-9
"""Angle of a kink that is none [rad]."""
SAME = 1e-6
"""Distance of two places over the length of their run up to which they are one."""


@frozen_value
class ContactPlace:
    """A place on a run where the pressure may be infinite."""

    run: int
    zone: str
    position: float
    """On the run [L]."""
    end: bool = False
    """Whether contact reaches the end of its zone there."""
    corner: bool = False
    """Whether the boundary has a corner there, or inside the zone the boundary or the surface."""
    bonded: bool = False
    """Whether a bond begins there."""
    kink: float = 0.0
    """Angle by which surface and body, both as drawn, turn away from each other there [rad].

    Beside a face that is held along its normal, or in contact, it is that with the mirror image in this face.
    """


@frozen_value
class Singularity:
    """A place where the pressure is infinite like s^-α."""

    place: ContactPlace
    exponent: float
    """α."""
    exact: bool = True
    """Whether α is that of the elastic wedge there, and not measured."""

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
    exact: bool = False

    def grows(self) -> bool:
        """Whether the pressure grew twice running, and no slower, on smaller elements."""
        if len(self.growth) < PASSES:
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
        one, _ = difference.pair
        for place in _places(difference):
            history = self._history(place, case, SAME * coarse.run(place.run).length)
            history.growth.append(_growth(difference, place))
            elements = elements_at(coarse, coarse.run(place.run), place.position)
            history.element.append(float(coarse.weights[elements].sum(axis=1).min()))
            if place.bonded:
                if len(history.growth) >= PASSES:  # until then elements there are too long for its intensity
                    history.exponent, history.exact = _beside_bond(difference, place), True
                continue
            if history.grows() or (history.exponent is not None and GROWING[0] < history.growth[-1] < GROWING[1]):
                known = exponents_at(coarse, one, coarse.run(place.run), place.position)
                measured = float(np.log2(history.growth[-1]))
                history.exponent, history.exact = _nearest(measured, known) if known else (0.0, True)  # a logarithm
            elif history.exponent is None and _is_logarithmic(difference, place):
                history.exponent, history.exact = 0.0, True
        return tuple(
            Singularity(place=item.place, exponent=item.exponent, exact=item.exact)
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


def recognized(difference: MeshDifference) -> tuple[Singularity, ...]:
    """Infinite pressures that two meshes show: the pressure grows as beside the elastic wedge at the place."""
    coarse, (one, _) = difference.coarse, difference.pair
    found: list[Singularity] = []
    for place in _places(difference):
        if place.bonded:
            if (exponent := _beside_bond(difference, place)) is not None:
                found.append(Singularity(place=place, exponent=exponent))
            continue
        known = exponents_at(coarse, one, coarse.run(place.run), place.position)
        exponent, near = _nearest(float(np.log2(_growth(difference, place))), known)
        if near or _is_logarithmic(difference, place):
            found.append(Singularity(place=place, exponent=exponent if near else 0.0))
    return tuple(found)


def _growth(difference: MeshDifference, place: ContactPlace) -> float:
    """Largest pressure beside a place on the fine mesh over that on the coarse one; 1 where it is not high."""
    coarse, (one, two) = difference.coarse, difference.pair
    elements = elements_at(coarse, coarse.run(place.run), place.position)
    zone = [*coarse.body.problem.zones].index(place.zone)
    low = float(one.pressure[zone, elements].max())
    high = float(two.pressure[zone, np.concatenate([2 * elements, 2 * elements + 1])].max())
    pressed = coarse.weights * (one.pressure[zone] > 0)
    force = float((pressed * one.pressure[zone]).sum())
    return high / low if low * pressed.sum() > HIGH * force > 0 < high else 1.0


def _nearest(measured: float, known: Sequence[float]) -> tuple[float, bool]:
    """The known exponent nearest to a measured one, if it is near; and whether it is."""
    nearest = min(known, key=lambda exponent: abs(exponent - measured), default=np.inf)
    near = abs(nearest - measured) <= SNAP
    return (float(nearest) if near else measured), bool(near)


def exponents_at(solved: Solved, answer: CaseAnswer, run: ZoneRun, position: float) -> tuple[float, ...]:
    """Exponents of infinite pressures at a position of a run, by the angle of the body and what holds its faces."""
    return wedge_exponents(_wedges_at(solved, answer, run, position)[0])


def _beside_bond(difference: MeshDifference, place: ContactPlace) -> float | None:
    """Exponent of the pressure where a bond begins, if it raises the peak beyond the accuracy asked; else None.

    It may be infinite as soon as the materials differ, but it is a small part of the infinite shear of the bond, which
    meshes tell sooner than its growth.
    """
    known = exponents_at(difference.fine, difference.pair[1], difference.fine.run(place.run), place.position)
    return known[0] if known and _is_logarithmic(difference, place) else None


def _is_logarithmic(difference: MeshDifference, place: ContactPlace) -> bool:
    """Whether a corner raises the peak like ln r, or nearly so, beyond the accuracy asked."""
    return _rise(difference, place) > (difference.fine.body.problem.asked_accuracy or 0.0)


def logarithmic_rise(difference: MeshDifference, zone: str) -> float:
    """What corners of the body add to the peak of a zone on the fine mesh, over it, like ln r or nearly so."""
    return max((_rise(difference, place) for place in _places(difference) if place.zone == zone), default=0.0)


def _rise(difference: MeshDifference, place: ContactPlace) -> float:
    """What the wedge and its tractions add to the peak between the fine mesh and a corner that is `SHARP`."""
    fine, answer = difference.fine, difference.pair[1]
    run = fine.run(place.run)
    zone = [*fine.body.problem.zones].index(place.zone)
    elements = elements_at(fine, run, place.position)
    at, peak = float(answer.pressure[zone, elements].max()), float(answer.pressure[zone].max())
    if not at > 0:
        return 0.0
    wedges, loads = _wedges_at(fine, answer, run, place.position)
    _, length = contact_beside(run, answer.stretches[run.number], place.position)
    size = max(float(fine.weights[elements].sum(axis=1).min()) / (length or run.length), SHARP)
    if len(wedges.wedges) > 2:  # no load leaves a state unexcited that so many bodies share
        exponent = max(wedge_exponents(wedges), default=0.0)
        return max(0.0, at / peak * (size / SHARP) ** exponent - 1)
    if place.bonded:
        return max(0.0, (at + _rise_beside_bond(fine, answer, run, place, SHARP * (length or run.length))) / peak - 1)
    straight = all(face.contact for face in wedges.at.faces) and abs(wedges.at.angle - np.pi) < CORNER
    if straight or (place.end and place.kink):
        softest = min(wedge.stiffness for wedge in wedges.wedges)
        slope = _slope(fine, place.kink, fine.mesh.part_of(int(elements[0]))) * softest
        return max(0.0, (at + slope * np.log(size / SHARP)) / peak - 1)
    change = slow_change(wedges, loads)
    if change is None:
        return 0.0
    sharp = max(change.at(face, at, SHARP / size) for face in range(2) if wedges.at.faces[face].contact)
    return max(0.0, sharp / peak - 1)


def _rise_beside_bond(solved: Solved, answer: CaseAnswer, run: ZoneRun, place: ContactPlace, near: float) -> float:
    """What infinite shear of a bond adds to the pressure [p] between the first element of contact and a place near by.

    It is negative where it takes pressure away, so that contact ends before the bond.
    """
    state = beside_bond(_wedges_at(solved, answer, run, place.position)[0])
    if state is None:
        return 0.0
    mesh, elements = solved.mesh, run_elements(solved, run)
    at_start = 2 * place.position < run.length
    own = int(elements[0] if at_start else elements[-1])
    beyond = int(mesh.before[own] if at_start else mesh.elements[own, 2])
    (own_half, half), middle = mesh.lengths[[own, beyond]] / 2, complex(*answer.traction[beyond, 1])
    return state.intensity(middle, float(half)) * (near**-state.exponent - float(own_half) ** -state.exponent)


def _slope(solved: Solved, kink: float, part: int) -> float:
    """Growth of the pressure [p] under a blunt kink with the logarithm of the distance: E* / 2π times the angle.

    Johnson, "Contact Mechanics" (1985), section 5.2: p = (E*/π) cot α arcosh(a/x) under a blunt wedge.
    """
    return solved.body.problem.parts[part].material.contact_modulus * kink / (2 * np.pi)


def _wedges_at(solved: Solved, answer: CaseAnswer, run: ZoneRun, position: float) -> tuple[Wedges, tuple[complex, ...]]:
    """The elastic wedges at a position of a run, of which that on the run is `own`, and the tractions on faces [p]."""
    problem, mesh, elements = solved.body.problem, solved.mesh, run_elements(solved, run)
    at = int(np.argmin(np.abs(run.ends - position))) % (len(elements) if run.closed else len(elements) + 1)
    after = int(elements[at] if at < len(elements) else np.argmax(mesh.before == elements[-1]))
    joints = [*problem.zones, *problem.bonded]
    touching = np.concatenate([answer.pressure[:, :, 1] > 0, np.ones((len(problem.bonded), len(mesh.elements)), bool)])
    wedges, ends = wedges_at(problem, mesh, mesh.across(joints, touching), after, partial(_face, answer))
    loads = (
        complex(*answer.traction[element, local]) for both in ends for element, local in zip(both, (0, 2), strict=True)
    )
    return wedges, tuple(loads)


def _face(answer: CaseAnswer, element: int, direction: float) -> Face:
    """What holds the face of a wedge with an element, from the direction of the boundary there."""
    if answer.presses(element):
        return contact_face(np.exp(1j * (direction - np.pi / 2)))
    if element in answer.condensation.body.bonds.element:
        return BONDED
    x, y = answer.condensation.body.acting.values.traction_unknown[element].tolist()
    return Face(1.0, (x, y))


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
                    after = 2 * at > run.length
                    corner = not end or _corner_of_body(coarse, run, after=after)
                    bonded = end and bool(coarse.body.points.bonded_ends[run.number, int(after)])
                    kink = _kink_at_end(coarse, one, run, after=after) if end and not bonded else 0.0
                    yield ContactPlace(
                        run=run.number, zone=run.zone, position=at, end=end, corner=corner, bonded=bonded, kink=kink
                    )
        kinks = dict(_turns_of_surface(coarse, run))
        for position, turn in zip(run.joints.tolist(), run.turn.tolist(), strict=True):
            same = [at for at in kinks if abs(at - position) <= SAME * run.length]
            turn += max((kinks.pop(at) for at in same), default=0.0)
            if same or abs(turn) > STRAIGHT:
                kinks[position] = turn
        for position, kink in kinks.items():
            if run.closed or 0 < position < run.length:
                yield ContactPlace(run=run.number, zone=run.zone, position=position, corner=True, kink=kink)


def _kink_at_end(solved: Solved, answer: CaseAnswer, run: ZoneRun, *, after: bool) -> float:
    """How surface and body turn away from each other at the end of a run, as of `ContactPlace` [rad].

    Neither face there may turn as it likes. If both would turn the body's corner into a wider one, pressure grows
    there as under a blunt corner: that of the whole, of which the body is half if this corner is a right angle.
    """
    mesh, elements = solved.mesh, run_elements(solved, run)
    start = int(mesh.elements[elements[-1], 2] if after else elements[0])
    angle = wedge_at(solved.body.problem, mesh, start, partial(_face, answer)).angle
    turns = [_turn_of_face(solved, answer, element, at) for element, at in ((int(mesh.before[start]), 2), (start, 0))]
    halves = [part for part in (1, 2) if abs(part * angle - np.pi) < CORNER]
    if turns[0] is None or turns[1] is None or not halves:
        return 0.0
    kink = halves[0] * (turns[0] - turns[1])
    return kink if abs(kink) > STRAIGHT else 0.0


def _turn_of_face(solved: Solved, answer: CaseAnswer, element: int, at: int) -> float | None:
    """Counterclockwise turn [rad] that a rigid surface or prescribed displacements state for an end of an element.

    `at` is its local node there. None for an end that is free to turn, that shear acts on, or on another elastic body.
    """
    mesh, body = solved.mesh, solved.body
    edge = body.problem.edge(mesh.edge_names[mesh.edge[element]])  # elements turn a little beside a curve
    along = edge.directions(mesh.fractions[element, [at]])[0]
    left = np.array([-along[1], along[0]])  # into the body
    if answer.presses(element):
        points = body.points
        there = (points.element == element) & (points.local == at)
        number = points.point[there & (points.node[points.point] == mesh.elements[element, at])]
        if not len(number) or points.opposite.node[number[0]] >= 0:
            return None
        zone = [*body.problem.zones][points.zone[number[0]]]
        moved = answer.condensation.contact.tools.displacement(answer.solution.rigid_amplitudes)
        tools = zip(body.problem.tools.values(), moved.tolist(), strict=True)
        turn = sum(motion[2] for tool, motion in tools if zone in tool.zones)
        return turn + float(np.arcsin(cross(left, points.faces[number[0]])))
    held = body.acting.values.traction_unknown[element]
    if (held.sum() == 1) and abs(left[~held]).max() <= STRAIGHT:
        u = body.acting.values.displacement[mesh.elements[element]] @ left
        slope = (4 * u[1] - 3 * u[at] - u[2 - at]) / mesh.lengths[element]
        return float(np.arctan((1 - at) * slope))
    return None


def _corner_of_body(solved: Solved, run: ZoneRun, *, after: bool) -> bool:
    """Whether the boundary has a corner at the start of a run, or `after` it."""
    mesh, elements = solved.mesh, run_elements(solved, run)
    first = int(elements[-1] if after else mesh.before[elements[0]])
    (x, y), (u, v) = mesh.tangents[first, 2], mesh.tangents[mesh.elements[first, 2], 0]
    return abs(np.arctan2(x * v - y * u, x * u + y * v)) > CORNER


def _turns_of_surface(solved: Solved, run: ZoneRun) -> Iterator[tuple[float, float]]:
    """Position of each corner of the surface on a run, and how the surface turns away from the body there [rad]."""
    surface = solved.body.problem.zones[run.zone].surface
    for edge, start, ends in zip(run.edges, run.joints[:-1], run.breakpoints, strict=True):
        for fraction, turn in surface_corners(edge, surface, at_ends=True):
            if ends[0] <= fraction <= ends[-1]:
                yield float(start + (fraction - ends[0]) * edge.length), turn


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
