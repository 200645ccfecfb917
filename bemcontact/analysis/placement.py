"""Whether contact is where the body and the surfaces are after they have moved.

Contact sees gaps along fixed normals, ε + n·(u - w). This is exact on a plane, and after the displacement of both sides
that contact has followed. Elsewhere the gap of the displaced places differs from it by squares of what is left. These
are small in linear theory, but not where a body moves far and contact cannot follow. The contact problem is then solved
once more with the gaps of the displaced places; the change of the pressure is the error of the first solution, to first
order. Forces have other directions and levers there too: the normals turn, and a body that moves takes the places of
its forces along.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np

from bemcontact.adaptivity.resting_contacts import motions_of_pairs
from bemcontact.analysis.displaced_contact import Displaced, displaced, load_after, turn_of_body
from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.assessment.footprint import footprint
from bemcontact.assessment.penetration import Misfit, Penetration, tolerated
from bemcontact.bem.body import Body
from bemcontact.bem.contact_points import ContactPoints
from bemcontact.bem.surface_gaps import SurfaceGaps
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import unseen_ways
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.formulations import complementarity
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
SMALL_COMPONENT = 0.15
"""Component of the force on a tool over the force from which its change is judged by itself, and not by the force.

What is prescribed does not change; the other component may, by far more than the force as a whole."""
SMALL_CONTACT = 0.08
"""Force of a contact over that of its zone from which it is judged by itself, and not by this part."""
MOVES_ON = 0.8
"""Part of a motion by which a body moves on in the second solution, from which it is not held: the steps do not end.

They are a geometric series. A body that moves back in the second solution is held."""
NO_SQUARE = 2.0
"""A motion that is so many times the change of the gaps, or the turn of normals and body times the motion of places,
does not come from these, which are of second order."""
UNSEEN = 1e-9
"""Normal displacement of pressed points by a free motion, over the largest one, that is none."""
NO_CHANGE = 1e-7
"""Difference of the gaps, over the displacement scale of contact, that changes nothing."""
SAME = 1e-9
"""Relative difference of the changes of two forces that is round-off, as of a body and its mirror image."""
ALIKE = 0.1
"""Difference of displacements on the boundary, over one of them, up to which the body moves as a whole."""


def placement(
    gaps: SurfaceGaps,
    body: Body,
    contact: CondensedContact,
    solution: ContactSolution,
    nearby: Array | None = None,
    infinite: Collection[str] = (),
) -> tuple[Penetration | None, tuple[str, ...]]:
    """Find pressure off a surface, or pressure that the motion changes too much; note what it changes by less.

    Where the peak is `infinite`, in these zones, forces alone are judged.
    Of a state on a path, `nearby` (2, zones) is the least and the largest peak [p] of each zone a little before and
    after it. A peak between them is that of a parameter a little off: at first touch no peak is sure to any part of it.
    """
    points = body.points
    moved = displaced(gaps, points, contact, solution)
    pressed = contact.pressed(solution.pressure, solution.displacement)
    if not pressed.any():
        return None, ()
    off, beside = _slipped(gaps, points, contact, pressed, moved)
    if len(off):
        farthest = int(off[np.argmax(moved.distance[off])])
        return _off_the_surface(gaps, points, contact, farthest, moved), ()
    overhangs = tuple(_overhangs(gaps, points, contact, beside, pressed, moved))
    moved.change[beside] = 0.0
    load = load_after(gaps, body, contact, solution, moved, noted(gaps.problem))
    ways, push = _unheld(contact, solution), load.copy()  # nothing holds the unseen motions
    push[: len(ways)] = ways @ (ways.T @ load[: len(ways)])
    largest = (contact.weights @ solution.pressure) * abs(contact.rigid_motions).max(axis=0, initial=0.0)
    load = (load - push)[: contact.free_motions]
    load = np.where(abs(load) > NO_CHANGE * largest, load, 0.0)
    misfit, pushed = _slides(gaps, points, body, contact, solution, push)
    if misfit is not None:
        return misfit, overhangs
    overhangs = (*overhangs, *pushed)
    change = max(abs(moved.change).max() / contact.scales.displacement, abs(moved.turn).max())
    if change <= NO_CHANGE and not load.any():
        return None, overhangs
    there = {"initial_gap": contact.initial_gap + moved.change, "motion_load": contact.motion_load + load}
    again = complementarity.solve(replace(contact, **there), near=pressed)
    misfit, turned = _moves_on(gaps, points, contact, solution, again, moved)
    if misfit is None and nearby is None:
        misfit, changed = _forces_changed(gaps, points, contact, solution, again, moved)
        turned = (*turned, *changed)
    if misfit is not None:
        return misfit, (*overhangs, *turned)
    finite = [name for name in contact.zone_names if name not in infinite]
    misfit, said = _changed(gaps, points, contact, solution, again, moved, nearby, finite)
    if misfit is None and nearby is None:
        misfit, others = _pairs_changed(gaps, points, body, contact, solution)
        said = (*said, *others, *_places_changed(gaps, contact, solution, replace(contact, **there), again))
    return misfit, (*overhangs, *turned, *said)


def _unheld(contact: CondensedContact, solution: ContactSolution) -> Array:
    """Free motions (k, j) that move no point under pressure: an orthonormal basis."""
    return unseen_ways(contact.rigid_motions[solution.pressure > 0], UNSEEN)


def _slides(
    gaps: SurfaceGaps, points: ContactPoints, body: Body, contact: CondensedContact, solution: ContactSolution,
    push: Array,
) -> tuple[Penetration | None, tuple[str, ...]]:  # fmt: skip
    """Judge what work forces gain by the motion in free motions that no pressure resists, push (j,)."""
    total, size = float(contact.weights @ solution.pressure), float(np.linalg.norm(push))
    if size < noted(gaps.problem) * total:
        return None, ()
    motion = body.free.combined(push[:, None] / size).describe()[0]
    words = (
        f"no contact holds the {motion}, and the forces push along it after the motion, by {100 * size / total:.2g} % "
        "of the force of contact; prescribe a displacement that holds it"
    )
    least = _judged_to(gaps.problem)
    if size < least * total:
        return None, (f"{words}; error bars do not include this",)
    words = f"{words[0].upper()}{words[1:]}."
    i = int(np.argmax(contact.weights * solution.pressure))
    return _misfit(gaps, points, contact, i, Misfit.MOVED, size / total, least, words), ()


def _pairs_changed(
    gaps: SurfaceGaps, points: ContactPoints, body: Body, contact: CondensedContact, solution: ContactSolution
) -> tuple[Penetration | None, tuple[str, ...]]:
    """Judge how far two elastic bodies move beside the way after which their pairs are formed.

    Load cases share pairs, and a body that moves on and on never is where they are.
    """
    said = list[str]()
    for zone, found in motions_of_pairs(body, contact, solution.pressure, gaps.state.displacement).items():
        surface = gaps.surfaces[zone]
        if not isinstance(surface, BodySurface):
            continue
        motion = surface.approach.step - found.mean
        part = found.change_of_peak(motion)
        if part < noted(gaps.problem):
            continue
        words = (
            f"both sides of '{zone}' move by {_vector(motion, gaps.problem.units.length)} beside the places for which "
            "points opposite to each other were found: others are opposite then, and the peak pressure may be off by "
            f"about {100 * part:.2g} %; draw the body near to where it will touch"
        )
        if part >= WITHHELD:
            own = contact.lengths_by_zone[contact.zone_names.index(zone)]
            i, depth = int(np.argmax(own * solution.pressure)), float(np.hypot(*motion))
            words = f"{words[0].upper()}{words[1:]}."
            return _misfit(gaps, points, contact, i, Misfit.MOVED, depth, 0.0, words), ()
        said.append(f"{words}; error bars do not include this")
    return None, tuple(said)


def noted(problem: Problem) -> float:
    """Change of a peak over the largest one, or of a force over itself, from which it is noted."""
    return NOTED * _judged_to(problem)


def part_of_path(problem: Problem) -> float:
    """Part of a path before and after a state of which any parameter may be meant."""
    return _judged_to(problem)


def _judged_to(problem: Problem) -> float:
    """Accuracy to which the place is judged."""
    return min(LEAST_ASKED, problem.asked_accuracy or LEAST_ASKED)


def _slipped(
    gaps: SurfaceGaps, points: ContactPoints, contact: CondensedContact, pressed: BoolArray, moved: Displaced
) -> tuple[IntArray, IntArray]:
    """Points under pressure opposite to another face: those that are off the surface, and those beside which it is.

    The latter have moved past an end of the surface by less than an element, and by a small part of the length that is
    pressed: the mean pressure is off by that part.
    """
    allowed, off, beside = _allowed(gaps, contact), list[int](), list[int]()
    for i in np.flatnonzero(pressed & moved.other & (moved.change > 0)).tolist():
        around = np.flatnonzero(np.any(points.mesh.elements == points.node[i], axis=1))
        gone = moved.distance[i] > allowed
        past = moved.distance[i] > WITHHELD * _pressed_length(contact, pressed, i)
        gone = gone and (past or gaps.distance(contact.zone_names[contact.zone[i]], around).min() > allowed)
        (off if gone else beside).append(i)
    return np.array(off, int), np.array(beside, int)


def _pressed_length(contact: CondensedContact, pressed: BoolArray, i: int) -> float:
    """Length [L] of the unbroken stretch of contact around a pressed point."""
    own = np.flatnonzero(contact.run == contact.run[i])
    stretch = _stretches(contact, pressed, own)
    return float(contact.weights[own[stretch == stretch[own == i]]].sum())


def _stretches(contact: CondensedContact, pressed: BoolArray, own: IntArray) -> IntArray:
    """Number of the unbroken stretch, pressed or open, of each of the points (k,) of a run."""
    stretch = np.cumsum(np.append(0, np.diff(pressed[own].astype(int)) != 0))
    if np.isfinite(contact.run_length[contact.run[own[0]]]) and pressed[own[[0, -1]]].all():
        stretch[stretch == stretch[-1]] = 0  # across the seam of a closed run
    return stretch


def _overhangs(
    gaps: SurfaceGaps, points: ContactPoints, contact: CondensedContact, beside: IntArray, pressed: BoolArray,
    moved: Displaced,
) -> Iterator[str]:  # fmt: skip
    """Note the points of each zone that have moved farthest past an end, by a noticeable part of the pressed length."""
    farthest = {contact.zone[i]: i for i in beside[np.argsort(moved.distance[beside])].tolist()}
    for i in farthest.values():
        part = moved.distance[i] / _pressed_length(contact, pressed, i)
        if part >= noted(gaps.problem):
            yield (
                f"pressure acts at {_vector(contact.points[i])} on '{_edge(gaps, points, i)}', which has moved past an "
                f"end of the surface of '{contact.zone_names[contact.zone[i]]}', by {100 * part:.2g} % of the length "
                "that is pressed: the pressure there is off by that part; draw the body where it will touch"
            )


def _allowed(gaps: SurfaceGaps, contact: CondensedContact) -> float:
    """Distance [L] that is tolerated."""
    largest = float(np.hypot(*np.moveaxis(gaps.state.displacement, 2, 0)).max())
    return tolerated(contact, largest, gaps.problem.size)


def _off_the_surface(
    gaps: SurfaceGaps, points: ContactPoints, contact: CondensedContact, i: int, moved: Displaced
) -> Penetration:
    """Pressure at a point that is off the surface."""
    unit, zone = gaps.problem.units.length, contact.zone_names[contact.zone[i]]
    words = (
        f"Pressure acts at {_vector(contact.points[i])} on '{_edge(gaps, points, i)}', where there is no surface of "
        f"'{zone}' after the body has moved by {_vector(moved.motion[i], unit)}: it is "
        f"{_length(moved.distance[i], unit)} off. Draw the body where it will touch, correct the motion, or hold the "
        "body by a condition if nothing else holds it in this direction."
    )
    distance, allowed = float(moved.distance[i]), _allowed(gaps, contact)
    return _misfit(gaps, points, contact, i, Misfit.OFF, distance, allowed, words)


def _changed(
    gaps: SurfaceGaps, points: ContactPoints, contact: CondensedContact, solution: ContactSolution,
    again: ContactSolution, moved: Displaced, nearby: Array | None, zones: Sequence[str],
) -> tuple[Penetration | None, tuple[str, ...]]:  # fmt: skip
    """Judge how the peak of each of some zones changes with the gaps and normals of the displaced places."""
    solved = again.status is Status.SOLVED
    own, change = _peak_change(contact, zones, solution, again)
    if solved and abs(change) < noted(gaps.problem):
        return None, ()
    if solved and nearby is not None:
        beyond = _peak_change(contact, zones, solution, again, nearby)
        if abs(beyond[1]) < WITHHELD:
            return None, (_off_by_a_little(contact.zone_names[contact.zone[own][0]], gaps.problem),)
        own, change = beyond
    pressure = np.where(own, np.maximum(solution.pressure, again.pressure if solved else 0.0), -1.0)
    i = int(np.argmax(pressure))
    zone, motion = contact.zone_names[contact.zone[i]], _motion_in(moved, own, pressure)
    effect = (
        f"with the gaps after this motion, the peak pressure there {'rises' if change > 0 else 'falls'} by "
        f"{100 * abs(change):.2g} %{' of the largest' * bool(solution.pressure[own].max() < solution.pressure.max())}"
        if solved
        else "with the gaps after this motion, contact does not hold the body"
    )
    words = (
        f"{_motion_against(gaps, zone, motion)}, which is not small beside their shapes: {effect}; "
        f"{_remedy(gaps, motion)}"
    )
    if solved and abs(change) < WITHHELD:
        return None, (f"{words}; error bars do not include this",)
    words = f"{words[0].upper()}{words[1:]}."
    off, allowed = float(abs(moved.change[own]).max()), 0.0
    return _misfit(gaps, points, contact, i, Misfit.MOVED, off, allowed, words), ()


def _moves_on(
    gaps: SurfaceGaps, points: ContactPoints, contact: CondensedContact, solution: ContactSolution,
    again: ContactSolution, moved: Displaced,
) -> tuple[Penetration | None, tuple[str, ...]]:  # fmt: skip
    """Find a free motion that goes on by as much again where the body has moved to: nothing holds it.

    A flat block slides on a round support, whose normals are tilted beside the place where it touches. It would move
    until the tilt balances the load, but takes the place of contact with it. So does a disc that a couple rolls along
    a plane: it would turn until the lever of the pressure balances the couple. A motion that no load drives, and
    that is small beside every contact, may be noise of the mesh, and places nothing elsewhere. Nor does a motion that
    slopes drive by a small part of the forces, as that of a roller between bodies that bend: it is noted.
    """
    if again.status is not Status.SOLVED or not contact.free_motions:
        return None, ()
    reach = abs(contact.rigid_motions).max(axis=0)
    before = solution.rigid_amplitudes * reach
    unseen = _unheld(contact, solution)  # their amplitudes are a rule's
    change = again.rigid_amplitudes - solution.rigid_amplitudes
    further = (change - unseen @ (unseen.T @ change)) * reach * np.where(before < 0, -1.0, 1.0)
    before = abs(before)
    pressed = np.maximum(solution.pressure, again.pressure) > 0
    turned = abs(moved.turn[pressed]).max() + abs(turn_of_body(gaps))
    square = max(abs(moved.change[pressed]).max(), turned * abs(moved.motion[pressed]).max())
    least = max(NO_SQUARE * square, NO_CHANGE * contact.scales.displacement)
    lengths = contact.lengths_by_zone @ (solution.pressure > 0)
    slight = noted(gaps.problem) * lengths[lengths > 0].min(initial=np.inf)
    noise = (before + further < slight * reach) & (contact.motion_load == 0)
    held = (further < np.maximum(MOVES_ON * before, least)) | noise
    if held.all():
        return None, ()
    j, part = int(np.argmax(np.where(held, 0.0, further))), _push_of_slopes(contact, solution)
    slight_push = part < noted(gaps.problem)
    if (held | slight_push).all():
        words = (
            f"no contact holds the {contact.motion_names[j]}, and no load drives it: slopes push along it by "
            f"{100 * part[j]:.2g} % of the force of contact; its amount is not known, and a little friction holds it"
        )
        return None, (words,)
    j = int(np.argmax(np.where(held | slight_push, 0.0, further)))
    i = int(np.argmax(contact.weights * solution.pressure * abs(contact.rigid_motions[:, j])))
    unit = gaps.problem.units.length
    words = (
        f"No contact holds the {contact.motion_names[j]} against the load. Only slopes and levers as drawn seem to "
        f"hold it, and they move with the body. Along this motion contact moves by {_length(before[j], unit)}, and "
        f"from there on by {_length(further[j], unit)}. Prescribe a displacement that holds the body in this direction."
    )
    return _misfit(gaps, points, contact, i, Misfit.MOVED, float(further[j]), float(least), words), ()


def _push_of_slopes(contact: CondensedContact, solution: ContactSolution) -> Array:
    """Largest part (k,) of the force of a zone that acts along each free motion; infinite for those with a load."""
    work = abs((contact.weights_by_zone * solution.pressure) @ contact.rigid_motions)
    force = (contact.lengths_by_zone @ solution.pressure)[:, None] * abs(contact.rigid_motions).max(axis=0)
    part = np.divide(work, force, out=np.zeros_like(work), where=force > 0).max(axis=0)
    return np.where(contact.motion_load == 0, part, np.inf)


def _forces_changed(
    gaps: SurfaceGaps, points: ContactPoints, contact: CondensedContact, solution: ContactSolution,
    again: ContactSolution, moved: Displaced,
) -> tuple[Penetration | None, tuple[str, ...]]:  # fmt: skip
    """Judge how the force of each contact changes with the gaps and normals of the displaced places.

    The force on a tool that is free along one axis is judged along the other one by that component.
    """
    if again.status is not Status.SOLVED:
        return None, ()  # as is said of the peak
    zones, within = _contacts(contact, solution, again)
    own = contact.weights_by_zone[zones] * within
    was = (own * solution.pressure) @ contact.normals
    is_now = (own * again.pressure) @ (contact.normals + moved.turn)
    of_zone = contact.lengths_by_zone @ solution.pressure
    total = np.maximum(abs(own) @ solution.pressure, SMALL_CONTACT * of_zone[zones])
    change, held = is_now - was, _held_axes(gaps.problem)[zones]
    size = np.where(held & (abs(was) >= SMALL_COMPONENT * total[:, None]), abs(was), total[:, None])
    changed = np.column_stack([np.hypot(*change.T), abs(change)])
    size = np.column_stack([total, size])
    parts = changed / np.where(size > 0, size, np.inf)
    number, axis = np.unravel_index(int(np.argmax(parts >= (1 - SAME) * parts.max())), parts.shape)
    part = float(parts[number, axis])
    if part < noted(gaps.problem):
        return None, ()
    both = abs(own[number]) * np.maximum(solution.pressure, again.pressure)
    i = int(np.argmax(both))
    zone, units = contact.zone_names[zones[number]], gaps.problem.units
    motion = _motion_in(moved, within[number], both)
    gained, whole = _vector(change[number], units.line_force), float(of_zone[zones[number]])
    of = f"along {'xy'[axis - 1]} by {100 * part:.2g} %" if axis else f"{100 * part:.2g} % of it"
    if abs(own[number]) @ solution.pressure < SMALL_CONTACT * whole:
        of = f"{100 * changed[number, 0] / whole:.2g} % of all force there"
    words = (
        f"{_motion_against(gaps, zone, motion)}, which is not small beside their shapes: with the gaps and the "
        "directions of the surfaces where the body then is, the force between them changes by "
        f"{gained}, {of}; {_remedy(gaps, motion)}"
    )
    if part < WITHHELD:
        return None, (f"{words}; error bars do not include this",)
    words = f"{words[0].upper()}{words[1:]}."
    off = float(abs(moved.change[within[number]]).max())
    return _misfit(gaps, points, contact, i, Misfit.MOVED, off, 0.0, words), ()


def _held_axes(problem: Problem) -> BoolArray:
    """Axes (zones, 2) along which the tool of each zone is held, if it is free along the other one."""
    held = np.zeros((len(problem.zones), 2), bool)
    for tool in problem.tools.values():
        free = np.array(tool.free[:2])
        held[[[*problem.zones].index(zone) for zone in tool.zones]] = ~free & free.any()
    return held


def _contacts(
    contact: CondensedContact, solution: ContactSolution, again: ContactSolution
) -> tuple[IntArray, BoolArray]:
    """Zone (c,) and points (c, n) of each unbroken contact of one of two solutions or both; of one alone, the zone.

    What one contact gains another one of its zone may lose, as both walls of a groove do.
    """
    pressed, zones, within = (solution.pressure > 0) | (again.pressure > 0), list[int](), list[BoolArray]()
    for number in range(len(contact.zone_names)):
        own, found = contact.zone == number, list[BoolArray]()
        for run in np.unique(contact.run[own]).tolist():
            at = np.flatnonzero(contact.run == run)
            stretch = _stretches(contact, pressed, at)
            found += [np.isin(np.arange(len(own)), at[stretch == one]) for one in np.unique(stretch[pressed[at]])]
        found = found if len(found) > 1 else [contact.lengths_by_zone[number] != 0]
        zones += [number] * len(found)
        within += found
    return np.array(zones), np.array(within)


def _places_changed(
    gaps: SurfaceGaps, contact: CondensedContact, solution: ContactSolution, there: CondensedContact,
    again: ContactSolution,
) -> Iterator[str]:  # fmt: skip
    """Note the contact whose place changes most, and that whose length does, by a noticeable part of its length."""
    was, is_now = footprint(contact, solution).intervals, footprint(there, again).intervals
    if not was or [item.run for item in was] != [item.run for item in is_now]:
        return
    before, after = (np.array([item.arc for item in intervals]).reshape(-1, 2) for intervals in (was, is_now))
    lengths = np.ptp(before, axis=1), np.ptp(after, axis=1)
    length = np.maximum(*lengths)
    shifts, grown = (
        np.divide(change, length, out=np.zeros(len(was)), where=length > 0)
        for change in (abs(np.mean(after - before, axis=1)), lengths[1] - lengths[0])
    )
    if shifts[number := int(np.argmax(shifts))] >= noted(gaps.problem):
        yield (
            f"with the gaps after the motion of the body, contact of '{was[number].zone}' is elsewhere by "
            f"{100 * shifts[number]:.2g} % of its length, or more; error bars of its ends and of rotations do not "
            "include this"
        )
    if abs(grown[number := int(np.argmax(abs(grown)))]) >= noted(gaps.problem):
        yield (
            f"with the gaps after the motion of the body, contact of '{was[number].zone}' is "
            f"{'longer' if grown[number] > 0 else 'shorter'} by {100 * abs(grown[number]):.2g} %; error bars of its "
            "length and ends do not include this"
        )


def _peak_change(
    contact: CondensedContact, zones: Sequence[str], before: ContactSolution, after: ContactSolution,
    nearby: Array | None = None,
) -> tuple[BoolArray, float]:  # fmt: skip
    """Points (n,) of the contact in one of the zones whose peak changes most, and the change over the largest peak.

    Where the peaks of the zones nearby on a path are known, it is the zone, and the change beyond these.
    """
    of, own = _contacts(contact, before, after)
    if nearby is not None:
        of = np.arange(len(contact.zone_names))
        own = contact.zone == of[:, None]
    was, is_now = (np.where(own, item.pressure, 0.0).max(axis=1, initial=0.0) for item in (before, after))
    changes = (is_now - (was if nearby is None else np.clip(is_now, *nearby))) / before.pressure.max()
    changes[[contact.zone_names[number] not in zones for number in of.tolist()]] = 0.0
    number = int(np.argmax(abs(changes)))
    return own[number], float(changes[number])


def _off_by_a_little(zone: str, problem: Problem) -> str:
    """Say of a state on a path that its peak is that of a parameter a little off, or off by less than is withheld."""
    return (
        f"the body moves far beside its shape: with the gaps after the motion, the peak pressure on the surface of "
        f"'{zone}' changes by {100 * noted(problem):.2g} % or more, but by less than {100 * WITHHELD:.2g} % or than it "
        f"changes within {100 * part_of_path(problem):.2g} % of the path"
    )


def _motion_in(moved: Displaced, within: BoolArray, pressure: Array) -> Array:
    """Motion (2,) [L] of that of some points (n,) whose pressure times motion is largest."""
    weight = np.where(within, pressure, -1.0) * np.hypot(*moved.motion.T)
    return moved.motion[int(np.argmax(weight))]


def _motion_against(gaps: SurfaceGaps, zone: str, motion: Array) -> str:
    """Say by how much two bodies, or a body and a rigid surface, move against each other."""
    by = _vector(motion, gaps.problem.units.length)
    if isinstance(gaps.surfaces[zone], BodySurface):
        return f"both sides of '{zone}' move by {by} against each other"
    return f"the body moves by {by} against the surface of '{zone}'"


def _remedy(gaps: SurfaceGaps, motion: Array) -> str:
    """What to do about a motion: draw the body there if it moves as a whole."""
    displacement = gaps.state.displacement.reshape(-1, 2)
    spread = np.hypot(*np.ptp(displacement, axis=0))
    if spread <= ALIKE * np.hypot(*motion):
        return f"draw the body where it touches: move it by {_vector(motion)}, or the surface by {_vector(-motion)}"
    return (
        "draw the body near to where it will touch; if it bends as far as that, expect an error of this size, or take "
        "a program for large displacements"
    )


def _misfit(
    gaps: SurfaceGaps, points: ContactPoints, contact: CondensedContact, i: int, kind: Misfit,
    depth: float, allowed: float, words: str,
) -> Penetration:  # fmt: skip
    """Describe what does not fit at a contact point."""
    x, y = contact.points[i].tolist()
    zone = contact.zone_names[contact.zone[i]]
    return Penetration(
        kind=kind, depth=depth, allowed=allowed, at=(x, y), edge=_edge(gaps, points, i), zone=zone, paired=True,
        words=words,
    )  # fmt: skip


def _edge(gaps: SurfaceGaps, points: ContactPoints, i: int) -> str:
    """Name of the edge of a contact point."""
    element = points.element[np.flatnonzero(points.point == i)[0]]
    return gaps.state.edge_names[gaps.state.edge[element]]


def _vector(values: Array, unit: str = "") -> str:
    """Write two numbers; what is round-off beside the other is zero."""
    x, y = np.where(abs(values) > 1e-3 * abs(values).max(), values, 0.0) + 0.0
    return f"({x:.4g}, {y:.4g}) {unit}".strip()


def _length(value: float, unit: str) -> str:
    return f"{value:.3g} {unit}".strip()
