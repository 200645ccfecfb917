"""Notes on the mesh and the load of a result that the certificate does not give."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from bemcontact.adaptivity.zone_runs import SAME
from bemcontact.analysis.spline_bulges import bulging
from bemcontact.arrays import indices, norm, short_svd
from bemcontact.assessment.footprint import ContactInterval, Footprint
from bemcontact.bem.body import Body
from bemcontact.bem.mesh import CORNER
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import unseen_ways
from bemcontact.contact.solution import ContactSolution
from bemcontact.problems.problem import Problem
from bemcontact.problems.stated_bodies import REACH
from bemcontact.problems.surface_lines import Polyline, Spline

FEW_POINTS = 5
"""Points under pressure below which a contact is not resolved: three make a parabola, two more its ends."""
UNBOUNDED = "the pressure there is infinite in theory, and its values at the last nodes depend on the mesh"
"""Note on an end of contact where the stresses are singular."""
LONG_NEIGHBOR = 4.0
"""Length of the element beyond the end of a zone over that inside, above which pressure at that end suffers."""
COARSE = 0.1
"""Accuracy asked for, relative, above which meshes are so coarse that a contact may be missed."""
SMALL_NET_LOAD = 1e-3
"""Net load over the sum of the magnitudes of all loads below which it may be due to rounded numbers in the input."""
BULGE = 0.1
"""Bulge of a spline over the largest normal displacement of contact points that is noted."""
FAR = 10.0
"""Distance of a bulge from contact points over that displacement up to which it may matter."""
MANY_INTERVALS = 3
"""Number of intervals of a zone with few points up to which each has a note of its own."""
MOVED_OUT = 20.0
"""Depth of a surface in the body over the deformation of the body, from which it was hardly meant as interference."""
LEVEL = 1e-9
"""Slope up to which a surface does not hold a body along it at all."""
SLOPE = 0.05
"""Largest slope of normals beside a translation that hardly hold a body along it."""
OF_A_FIT = 10.0
"""Contact forces over the load that they carry, from which most of them balance each other."""


def diagnostics(
    contact: CondensedContact,
    solution: ContactSolution,
    where: Footprint,
    body: Body | None,
    *,
    met: bool = False,
) -> Iterator[str]:
    """Notes on a solution; those on the mesh need a body. `met` says that error bars are as small as was asked."""
    touching = contact.pressed(solution.pressure, solution.displacement)
    yield from floating(contact, touching)
    yield from nearly_balanced(contact, solution)
    yield from against_its_force(contact, solution)
    yield from drawn_inside(contact, solution)
    yield from few_points(contact, touching, where)
    if body is not None:
        yield from coarse_answer(body.problem.asked_accuracy)
        yield from hardly_held(body, contact, touching, solution.undetermined)
        yield from reached_zone_ends(body, touching)
        if not met:
            yield from long_neighbors(body, touching)
        yield from beyond_ends(body, touching)
        displacement = float(abs(solution.displacement).max(initial=0.0))
        yield from bulging(body, BULGE * displacement, FAR * displacement)


def coarse_answer(asked: float | None) -> Iterator[str]:
    """Note that an accuracy was asked for with which an answer is only a first look."""
    if asked is not None and asked > COARSE:
        yield (
            f"an accuracy of {100 * asked:.3g} % was asked for: the answer is coarse, and error bars of this size are "
            "rough themselves; for numbers to rely on, ask for 1 %, with accuracy: 0.01 or --accuracy 0.01"
        )


def sides_of_one_body(problem: Problem) -> Iterator[str]:
    """Note of an answer that is not certified that both sides of a contact are on one body, and may be on two.

    In a narrow slot the equations of opposite places are nearly the same, as on the faces of a crack: its opening has
    an error of the mesh of the whole body, and the compliance may not be positive definite. Those of two bodies differ.
    """
    for contact in problem.contacts:
        body, other = problem.sides_of(contact)
        if body == other:
            yield (
                f"both sides of '{contact}' are on the body '{body}': across a narrow slot, equations of opposite "
                "places are nearly the same, and finer elements help little; cut the body along the line of the slot "
                f"in two under bodies, with bonded edges where it is whole, and state '{contact}' between them"
            )


def floating(contact: CondensedContact, touching: NDArray[np.bool_]) -> Iterator[str]:
    """Note that no point carries pressure although a body or tool is held by contact."""
    if contact.free_motions and not touching.any():
        motions, verb = " and the ".join(contact.motion_names), "is" if contact.free_motions == 1 else "are"
        yield (
            f"no contact point carries pressure, so that the {motions} {verb} not determined; if there should be "
            "contact, check the directions of loads and displaced tools"
        )


def nearly_balanced(contact: CondensedContact, solution: ContactSolution) -> Iterator[str]:
    """Note that what presses the body onto its support is a small difference of large loads.

    Pressure of a fit, by interference or heat, balances itself and does not depend on this difference.
    """
    net_load = contact.net_load
    if not 0 < net_load < SMALL_NET_LOAD:
        return
    carried = np.abs(contact.equilibrium).T @ solution.pressure
    if np.any(carried <= OF_A_FIT * np.abs(contact.motion_load)):
        yield (
            f"the loads nearly balance: the net load along the {' and the '.join(contact.motion_names)} is "
            f"{net_load:.1g} of the sum of their magnitudes, and contact carries only that; errors of this "
            "size in the loads change the contact entirely"
        )


def hardly_held(
    body: Body, contact: CondensedContact, touching: NDArray[np.bool_], undetermined: Sequence[str]
) -> Iterator[str]:
    """Note a translation of the body alone that nothing holds but small slopes of surfaces within the contact.

    One without any slope has another note if motions are `undetermined`.
    """
    motions = body.seen.coefficients  # (k, 3 + 3 t): x, y and turn of the body, then of tools
    if not touching.any() or not (ways := unseen_ways(motions[:, 2:].T, LEVEL)).size:
        return
    moved, changes = motions.T @ ways, contact.rigid_motions[touching] @ ways  # pure translations of the body
    if moved.shape[1] > 1:
        moved, sizes = np.linalg.qr(moved)
        changes = np.linalg.solve(sizes.T, changes.T).T.astype(float)
        least = short_svd(changes)[1][-1:].T  # the translation that changes gaps least
        moved, changes = moved @ least, changes @ least
    slope = float(np.abs(changes).max() / norm(moved[:, 0]))
    if slope <= SLOPE and not (slope <= LEVEL and undetermined):
        direction = moved[:2, 0] / np.linalg.norm(moved)
        x, y = np.round(np.copysign(1.0, direction[np.argmax(abs(direction))]) * direction, 2) + 0.0
        yield (
            f"only slopes of the surfaces where they touch, of at most {slope:.2g}, hold the body against the "
            f"translation along ({x:g}, {y:g}): a load along it of this part of the contact force may move it far"
        )


def against_its_force(contact: CondensedContact, solution: ContactSolution) -> Iterator[str]:
    """Note a tool that moves against its force, because its surface is drawn inside the body."""
    tools = contact.tools
    moved = tools.displacement(solution.rigid_amplitudes)
    force, motions = tools.force.reshape(-1, 3), tools.motions.reshape(len(contact.points), -1, 3)
    for i, name in enumerate(tools.names):
        own = np.any(motions[:, i], axis=1)
        inside = -float(contact.initial_gap[own].min(initial=0.0))
        if moved[i] @ force[i] < 0 and inside > 0:
            yield (
                f"the tool '{name}' moves against its force, because its surface is drawn inside the body, by "
                f"{inside:.3g} {contact.units.get('length', '')}".rstrip()
                + "; draw it where it touches, and look at it with check --figure: a spline bulges between "
                "its points"
            )


def drawn_inside(contact: CondensedContact, solution: ContactSolution) -> Iterator[str]:
    """Note a surface that is drawn so far inside a free body that the body does not deform by it, but moves out."""
    if not contact.free_motions or not solution.pressure.any():
        return
    deepest = int(np.argmin(np.where(solution.pressure > 0, contact.initial_gap, np.inf)))
    depth = -float(contact.initial_gap[deepest])
    if depth <= 0:
        return
    elastic = solution.displacement - contact.rigid_motions @ solution.rigid_amplitudes
    if depth > MOVED_OUT * float(abs(elastic).max()):
        (x, y), name = contact.points[deepest].tolist(), contact.zone_names[contact.zone[deepest]]
        yield (
            f"the surface of '{name}' is drawn {depth:.3g} {contact.units.get('length', '')}".rstrip()
            + f" inside the body at ({x:.5g}, {y:.5g}), and the body moves out of it, since nothing else holds it; if "
            "an interference was meant, hold the body, or else draw the surface where it touches"
        )


def few_points(contact: CondensedContact, touching: NDArray[np.bool_], where: Footprint) -> Iterator[str]:
    """Note each interval of contact where too few points carry pressure to resolve it; together if there are many."""
    few = dict[str, list[tuple[ContactInterval, int]]]()
    for interval in where.intervals:
        carrying = int(np.count_nonzero(touching & points_in(contact, interval)))
        if 0 < carrying < FEW_POINTS:
            few.setdefault(interval.zone, []).append((interval, carrying))
    for zone, found in few.items():
        if len(found) > MANY_INTERVALS:
            (x, y), (u, v) = found[0][0].start, found[-1][0].end
            yield (
                f"pressure acts on fewer than {FEW_POINTS} contact points in each of {len(found)} intervals of {zone}, "
                f"from ({x:.5g}, {y:.5g}) to ({u:.5g}, {v:.5g}): the mesh is too coarse there to resolve its "
                "distribution; shorten the elements, or round a corner that presses"
            )
            continue
        for interval, carrying in found:
            start, end = (f"({x:.5g}, {y:.5g})" for x, y in (interval.start, interval.end))
            yield (
                f"pressure acts on only {carrying} contact point{'s' if carrying > 1 else ''} from {start} to {end} in "
                f"{interval.zone}: the mesh is too coarse there to resolve its distribution; shorten the elements"
            )


def points_in(contact: CondensedContact, interval: ContactInterval) -> NDArray[np.bool_]:
    """Which contact points (n,) are in an interval."""
    same = SAME * interval.end_arc
    past_start = (contact.arc_position - interval.start_arc + same) % interval.perimeter
    return (contact.run == interval.run) & (past_start <= interval.end_arc - interval.start_arc + 2 * same)


def reached_zone_ends(body: Body, touching: NDArray[np.bool_]) -> Iterator[str]:
    """Note where contact reaches the end of a zone: the zone is too short, or the pressure is singular.

    On a smooth boundary both are possible. At a corner with a free edge beyond the zone the pressure is bounded if the
    angle is at most a right one: the body and its mirror image in the rigid surface then form no notch (Williams 1952).
    A zone that ends opposite to a corner of the other body ends as that body does. It does not end at a bond with a
    body beside it that has a zone there, too.
    """
    mesh, points, in_zone = body.mesh, body.points, body.points.in_zone
    ends = np.zeros(len(mesh.nodes), bool)
    ends[: len(in_zone)] = in_zone != in_zone[mesh.before]
    for i in indices(touching & ends[points.node]).tolist():
        node, other, angles = points.node[i], points.opposite.node[i], mesh.inner_angles
        smooth = abs(angles[node] - np.pi) < CORNER
        if not smooth and (
            angles[node] <= np.pi / 2 + CORNER
            or body.acting.values.traction_unknown[mesh.before[node] if in_zone[node] else node].any()
        ):
            continue
        if other >= 0 and abs(angles[other] - np.pi) >= CORNER:
            continue
        if (points.tied[mesh.elements[in_zone]] == points.tied[node]).any(axis=1).sum() > 1:
            continue
        x, y = mesh.place(mesh.nodes[node])
        reached = f"contact reaches the end of the zone '{_zone(body, i)}' at ({x:.5g}, {y:.5g})"
        if smooth:
            zone = _zone(body, i)
            if np.isfinite(body.problem.reach_of(zone)):
                yield f"{reached}, where the boundary goes on smoothly; {longer(body.problem, zone)}"
                continue
            yield (
                f"{reached}, where the boundary goes on smoothly; {longer(body.problem, zone)}, unless the surface "
                f"ends there with an edge: then {UNBOUNDED}"
            )
        else:
            yield f"{reached}, a corner of the body of {np.degrees(angles[node]):.0f} degrees; {UNBOUNDED}"


def longer(problem: Problem, zone: str) -> str:
    """Say how more of a boundary may touch in a zone."""
    if zone not in problem.contacts:
        return "make the zone longer"
    if not np.isfinite(problem.reach_of(zone)):
        return "add to between the edges that follow there on either body"
    first, second = problem.contacts[zone].between
    edges = [*first, *second], [*problem.edges_of(zone), *problem.opposite_edges(zone)]
    named = ", ".join(name for name in dict.fromkeys(edges[1]) if name not in edges[0])
    return (
        f"reduce the load, or name edges in between, such as {named}: whole bodies may touch where gaps as drawn are "
        f"up to {problem.reach_of(zone):.3g} {problem.units.length}".rstrip()
        + " larger than at the nearest place, or than zero, "
        f"{100 * REACH:.2g} % of the size of the smaller one"
    )


def long_neighbors(body: Body, touching: NDArray[np.bool_]) -> Iterator[str]:
    """Note where contact reaches the end of a zone and the elements beyond it are much longer."""
    mesh, points, in_zone = body.mesh, body.points, body.points.in_zone
    ends = indices(touching & (points.node < len(mesh.elements)))
    after, before = points.node[ends], mesh.before[points.node[ends]]
    for i in ends[~(in_zone[after] & in_zone[before])].tolist():
        after, before, lengths = points.node[i], mesh.before[points.node[i]], mesh.lengths
        outside, inside = (before, after) if in_zone[after] else (after, before)
        if not in_zone[outside] and lengths[outside] > LONG_NEIGHBOR * lengths[inside]:
            (x, y), times = mesh.place(mesh.nodes[points.node[i]]), lengths[outside] / lengths[inside]
            yield (
                f"pressure acts at ({x:.5g}, {y:.5g}), the end of the zone '{_zone(body, i)}', beyond which an element "
                f"of '{mesh.edge_names[mesh.edge[outside]]}' is {times:.2g} times as long as that in the zone: the "
                "pressure there is less accurate; grade that edge towards the zone"
            )


def beyond_ends(body: Body, touching: NDArray[np.bool_]) -> Iterator[str]:
    """Note contact with the straight continuation of a polyline or a spline beyond its ends."""
    points = body.points
    for number, (name, zone) in enumerate(body.problem.zones.items()):
        if not isinstance(zone.surface, Polyline | Spline):
            continue
        pressed = body.mesh.nodes[points.node[touching & (points.zone == number)]]
        beyond = pressed[zone.surface.beyond_ends(zone.surface.way.back(pressed))] if len(pressed) else pressed
        if len(beyond):
            x, y = body.mesh.place(beyond[0])
            yield (
                f"contact in {name} at ({x:.5g}, {y:.5g}) is with the straight continuation of its {zone.surface.kind} "
                "beyond its first or last point: the line has no ends; if the surface ends there, add a point that "
                "leads away"
            )


def _zone(body: Body, point: int) -> str:
    """Name of the zone of a contact point."""
    return list(body.problem.zones)[body.points.zone[point]]
