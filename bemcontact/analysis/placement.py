"""Whether contact is where the body and the surfaces are after they have moved.

Contact sees gaps along fixed normals, ε + n·(u - w). This is exact on a plane, and after the displacement of both sides
that contact has followed. Elsewhere the gap of the displaced places differs from it by squares of what is left. These
are small in linear theory, but not where a body moves far and contact cannot follow. The contact problem is then solved
once more with the gaps of the displaced places; the change of the pressure is the error of the first solution, to first
order. Forces have other directions and levers there too: the normals turn, and a body that moves takes the places of
its forces along.
"""

from collections.abc import Collection, Iterator
from dataclasses import replace

import numpy as np

from bemcontact.adaptivity.resting_contacts import motion_as_a_whole, motions_of_pairs
from bemcontact.analysis.displaced_contact import load_after, ways_of_contact
from bemcontact.analysis.held_motions import LooseMotions
from bemcontact.analysis.motion_series import MotionSeries
from bemcontact.analysis.moved_contact import (
    WITHHELD,
    Judgement,
    MovedContact,
    judged_to,
)
from bemcontact.analysis.second_solution import SecondSolution
from bemcontact.arrays import Array, IntArray, indices, norm
from bemcontact.assessment.penetration import Misfit, Penetration
from bemcontact.bem.body import Body
from bemcontact.bem.surface_gaps import SurfaceGaps
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.formulations import complementarity
from bemcontact.problems.body_surface import BodySurface

NO_CHANGE = 1e-7
"""Difference of the gaps, over the displacement scale of contact, that changes nothing."""


def placement(
    gaps: SurfaceGaps,
    body: Body,
    contact: CondensedContact,
    solution: ContactSolution,
    nearby: Array | None = None,
    infinite: Collection[str] = (),
    series: MotionSeries | None = None,
) -> Judgement:
    """Find pressure off a surface, or pressure that the motion changes too much; note what it changes by less.

    Where the peak is `infinite`, in these zones, forces alone are judged.
    Of a state on a path, `nearby` (2, zones) is the least and the largest peak [p] of each zone a little before and
    after it. A peak between them is that of a parameter a little off: at first touch no peak is sure to any part of it.
    The `series` of motions is computed if it is not given.
    """
    first = MovedContact(gaps=gaps, points=body.points, contact=contact, solution=solution)
    if not first.pressed.any():
        return None, ()
    off, beside = _slipped(first)
    if len(off):
        return _off_the_surface(first, int(off[np.argmax(first.moved.distance[off])])), ()
    notes, moved = tuple(_overhangs(first, beside)) if len(beside) else (), first.moved
    moved.change[beside] = 0.0
    ways = ways_of_contact(gaps.problem, body, contact)
    load = load_after(gaps, body, contact, solution, moved, ways, first.noted)
    if load.any():
        push, unheld = load.copy(), first.unheld()  # nothing holds the unseen motions
        push[: len(unheld)] = unheld @ (unheld.T @ load[: len(unheld)])
        misfit, said = _slides(first, body, push)
        if misfit is not None:
            return misfit, notes
        notes, load = (*notes, *said), load - push
    largest = (contact.weights @ solution.pressure) * abs(contact.rigid_motions).max(axis=0, initial=0.0)
    load = np.where(abs(load[: contact.free_motions]) > NO_CHANGE * largest, load[: contact.free_motions], 0.0)
    ways = ways[..., : contact.free_motions]
    series = series or MotionSeries.of(gaps, body, contact, solution)
    loose = LooseMotions(first=first, series=series, free=body.seen, ways=ways, gained=load)
    misfit, said = loose.judged()
    notes, change = (*notes, *said), max(abs(moved.change).max() / contact.scales.displacement, abs(moved.turn).max())
    if misfit is not None or (change <= NO_CHANGE and not load.any()):
        return misfit, notes
    there = replace(contact, initial_gap=contact.initial_gap + moved.change, motion_load=contact.motion_load + load)
    held = loose.left_out_of(there)
    again = complementarity.solve(held, near=first.pressed)
    again = replace(again, displacement=held.offset + again.displacement - there.offset)
    second = SecondSolution(first=first, contact=there, solution=again)
    misfit, said = None, ()
    if nearby is None:
        misfit, said = second.forces_changed()
    notes = (*notes, *said)
    if misfit is not None:
        return misfit, notes
    misfit, said = second.peaks_changed([name for name in contact.zone_names if name not in infinite], nearby)
    if misfit is None and nearby is None:
        misfit, others = _pairs_changed(first, body, loose.amplitudes)
        said = (*said, *others, *second.places_changed())
    return misfit, (*notes, *said)


def _slides(first: MovedContact, body: Body, push: Array) -> Judgement:
    """Judge what work forces gain by the motion in free motions that no pressure resists, push (j,)."""
    contact, pressure = first.contact, first.solution.pressure
    total, size = float(contact.weights @ pressure), norm(push)
    if size < first.noted * total:
        return None, ()
    motion, least = body.free.combined(push[:, None] / size).describe()[0], judged_to(first.gaps.problem)
    words = (
        f"no contact holds the {motion}, and the forces push along it after the motion, by {100 * size / total:.2g} % "
        "of the force of contact; prescribe a displacement that holds it"
    )
    i = int(np.argmax(contact.weights * pressure))
    return first.judged(words, withheld=size >= least * total, i=i, depth=size / total, allowed=least)


def _pairs_changed(first: MovedContact, body: Body, unknown: Array) -> Judgement:
    """Judge how far two elastic bodies move beside the way after which their pairs are formed.

    Load cases share pairs, and a body that moves on and on never is where they are. Free motions whose amplitudes (k,)
    are `unknown` are left out.
    """
    gaps, contact, pressure, said = first.gaps, first.contact, first.solution.pressure, list[str]()
    displacement = gaps.state.displacement - (body.seen_ways @ unknown)[body.mesh.elements]
    for zone, found in motions_of_pairs(body, contact, pressure, displacement).items():
        surface = gaps.surfaces[zone]
        if not isinstance(surface, BodySurface):
            continue
        motion = surface.approach.step - found.mean
        part, of_ends = found.change_of_peak(motion), found.change_of_ends(motion_as_a_whole(body, zone, found))
        if max(part, of_ends) < first.noted:
            continue
        effects = (
            f"the peak pressure may be off by about {100 * part:.2g} %" * (part >= first.noted),
            f"contact may be elsewhere by up to {100 * of_ends:.2g} % of its length" * (of_ends >= first.noted),
        )
        words = (
            f"both sides of '{zone}' move by {first.way(motion)} beside the places for which points opposite to each "
            f"other were found: others are opposite then, and {' and '.join(filter(None, effects))}; draw the body "
            "near to where it will touch"
        )
        i = int(np.argmax(contact.lengths_by_zone[contact.zone_names.index(zone)] * pressure))
        misfit, notes = first.judged(words, withheld=part >= WITHHELD, i=i, depth=float(np.hypot(*motion)))
        if misfit is not None:
            return misfit, ()
        said += notes
    return None, tuple(said)


def _slipped(first: MovedContact) -> tuple[IntArray, IntArray]:
    """Points under pressure opposite to another face: those that are off the surface, and those beside which it is.

    The latter have moved past an end of the surface by less than an element, and by a small part of the length that is
    pressed: the mean pressure is off by that part.
    """
    moved, mesh = first.moved, first.points.mesh
    allowed, off, beside = first.allowed, list[int](), list[int]()
    for i in indices(first.pressed & moved.other & (moved.change > 0)).tolist():
        around = indices(np.any(mesh.elements == first.points.node[i], axis=1))
        gone = moved.distance[i] > allowed
        past = moved.distance[i] > WITHHELD * first.pressed_length(i)
        gone = gone and (past or first.gaps.distance(first.zone(i), around).min() > allowed)
        (off if gone else beside).append(i)
    return np.array(off, int), np.array(beside, int)


def _overhangs(first: MovedContact, beside: IntArray) -> Iterator[str]:
    """Note the points of each zone that have moved farthest past an end, by a noticeable part of the pressed length."""
    distance, contact = first.moved.distance, first.contact
    farthest = {contact.zone[i]: i for i in beside[np.argsort(distance[beside])].tolist()}
    for i in farthest.values():
        part = distance[i] / first.pressed_length(i)
        if part >= first.noted:
            yield (
                f"pressure acts at {first.vector(contact.points[i])} on '{first.edge(i)}', which has moved past an end "
                f"of the surface of '{first.zone(i)}', by {100 * part:.2g} % of the length that is pressed: the "
                "pressure there is off by that part; draw the body where it will touch"
            )


def _off_the_surface(first: MovedContact, i: int) -> Penetration:
    """Pressure at a point that is off the surface."""
    moved = first.moved
    words = (
        f"Pressure acts at {first.vector(first.contact.points[i])} on '{first.edge(i)}', where there is no surface of "
        f"'{first.zone(i)}' after the body has moved by {first.way(moved.motion[i])}: it is "
        f"{first.length(moved.distance[i])} off. Draw the body where it will touch, correct the motion, or hold the "
        "body by a condition if nothing else holds it in this direction."
    )
    return first.misfit(Misfit.OFF, words, i, float(moved.distance[i]), first.allowed)
