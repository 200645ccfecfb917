"""Notes on the mesh and the load of a result that the certificate does not give."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bemcontact.adaptivity.zone_runs import SAME
from bemcontact.assessment.footprint import Footprint
from bemcontact.bem.body import Body
from bemcontact.bem.contact_points import element_lengths
from bemcontact.bem.mesh import BoundaryState
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.problem.surface_lines import Polyline, Spline

FEW_POINTS = 5
"""Points under pressure below which a contact is not resolved: three make a parabola, two more its ends."""
SMOOTH = 0.2
"""Angle in radians by which the boundary may turn at the end of a zone and still go on smoothly."""
UNBOUNDED = "the pressure there is infinite in theory, and its values at the last nodes depend on the mesh"
"""Note on an end of contact where the stresses are singular."""
LONG_NEIGHBOR = 4.0
"""Length of the element beyond the end of a zone over that inside, above which pressure at that end suffers."""
COARSE = 0.1
"""Accuracy asked for, relative, above which meshes are so coarse that a contact may be missed."""
SMALL_NET_LOAD = 1e-3
"""Net load over the sum of the magnitudes of all loads below which it may be due to rounded numbers in the input."""
LARGE = 0.25
"""Change of the displacement over the length along which it changes, and pressure over Young's modulus, not small.

Linear theory leaves out half the square of this change, here 3 % of the length and an eighth of a strain; a cantilever
whose end has this slope deflects 3 % less than linear theory says (Bisshopp and Drucker 1945)."""
LARGE_STRAIN = 1 / 3
"""Strain at the peak pressure that is not small: in a line contact, where the peak is a quarter of Young's modulus."""
NOTICED = 0.2
"""Part of these strains from which linear theory is noticeably off: by about as much as the strain."""
LARGE_TURN = 0.1
"""Rotation of the whole body in radians from which it is named as the cause."""
LARGE_PART = 0.05
"""Share of the boundary on which displacements may be large: singular corners and tips of slits."""


def diagnostics(
    contact: CondensedContact,
    solution: ContactSolution,
    where: Footprint,
    body: Body | None,
    boundary: BoundaryState | None,
) -> Iterator[str]:
    """Notes on a solution; those on mesh and size need a body, and those on displacements its boundary."""
    touching = contact.pressed(solution.pressure, solution.displacement)
    yield from floating(contact, touching)
    yield from nearly_balanced(contact)
    yield from against_its_force(contact, solution)
    yield from few_points(contact, touching, where)
    if body is not None:
        yield from coarse_answer(body.problem.asked_accuracy)
        yield from reached_zone_ends(body, touching)
        yield from long_neighbors(body, touching)
        yield from beyond_ends(body, touching)
        if boundary is not None:
            yield from large_pressure(body, where, boundary)
    if boundary is not None:
        turns = any("rotation" in name for name in contact.motion_names)
        modulus = None if body is None else body.problem.material.young_modulus
        yield from large_displacements(boundary, turns, modulus)


def coarse_answer(asked: float | None) -> Iterator[str]:
    """Note that an accuracy was asked for with which an answer is only a first look."""
    if asked is not None and asked > COARSE:
        yield (
            f"an accuracy of {100 * asked:.3g} % was asked for: the answer is coarse, and error bars of this size are "
            "rough themselves; for numbers to rely on, ask for 1 %, with accuracy: 0.01 or --accuracy 0.01"
        )


def floating(contact: CondensedContact, touching: NDArray[np.bool_]) -> Iterator[str]:
    """Note that no point carries pressure although a body or tool is held by contact."""
    if contact.free_motions and not touching.any():
        motions, verb = " and the ".join(contact.motion_names), "is" if contact.free_motions == 1 else "are"
        yield (
            f"no contact point carries pressure, so that the {motions} {verb} not determined; if there should be "
            "contact, check the directions of loads and displaced tools"
        )


def nearly_balanced(contact: CondensedContact) -> Iterator[str]:
    """Note that what presses the body onto its support is a small difference of large loads."""
    if 0 < contact.net_load < SMALL_NET_LOAD:
        yield (
            f"the loads nearly balance: what drives the {' and the '.join(contact.motion_names)} is "
            f"{contact.net_load:.1g} of the sum of their magnitudes, and contact carries only that; errors of this "
            "size in the loads change the contact entirely"
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
                f"{inside:.3g}; draw it where it touches, and look at it with check --figure: a spline bulges between "
                "its points"
            )


def few_points(contact: CondensedContact, touching: NDArray[np.bool_], where: Footprint) -> Iterator[str]:
    """Note each interval of contact where too few points carry pressure to resolve it."""
    for interval in where.intervals:
        same = SAME * interval.end_arc
        past_start = (contact.arc_position - interval.start_arc + same) % interval.perimeter
        inside = (contact.run == interval.run) & (past_start <= interval.end_arc - interval.start_arc + 2 * same)
        carrying = int(np.count_nonzero(touching & inside))
        if 0 < carrying < FEW_POINTS:
            start, end = (f"({x:.5g}, {y:.5g})" for x, y in (interval.start, interval.end))
            yield (
                f"pressure acts on only {carrying} contact point{'s' if carrying > 1 else ''} from {start} to {end} in "
                f"{interval.zone}: the mesh is too coarse there to resolve its distribution; shorten the elements"
            )


def reached_zone_ends(body: Body, touching: NDArray[np.bool_]) -> Iterator[str]:
    """Note where contact reaches the end of a zone: the zone is too short, or the pressure is singular.

    On a smooth boundary both are possible. At a corner with a free edge beyond the zone the pressure is bounded if the
    angle is at most a right one: the body and its mirror image in the rigid surface then form no notch (Williams 1952).
    """
    mesh, points, angles = body.mesh, body.points, body.mesh.inner_angles
    in_zone = np.isin(np.arange(len(mesh.elements)), points.element)
    ends = np.flatnonzero(in_zone != in_zone[mesh.before])
    beyond = np.where(in_zone, mesh.before, np.arange(len(in_zone)))
    free = np.all(~body.acting.values.traction_unknown[beyond], axis=1)
    for i in np.flatnonzero(touching & np.isin(points.node, ends)):
        node = points.node[i]
        x, y = mesh.nodes[node]
        reached = f"contact reaches the end of the zone '{_zone(body, i)}' at ({x:.5g}, {y:.5g})"
        if abs(angles[node] - np.pi) < SMOOTH:
            yield (
                f"{reached}, where the boundary goes on smoothly; make the zone longer, unless the rigid surface ends "
                f"there with an edge: then {UNBOUNDED}"
            )
        elif free[node] and angles[node] > np.pi / 2 + SMOOTH:
            yield f"{reached}, a corner of the body of {np.degrees(angles[node]):.0f} degrees; {UNBOUNDED}"


def long_neighbors(body: Body, touching: NDArray[np.bool_]) -> Iterator[str]:
    """Note where contact reaches the end of a zone and the elements beyond it are much longer."""
    mesh, points = body.mesh, body.points
    lengths, in_zone = element_lengths(mesh), np.isin(np.arange(len(mesh.elements)), points.element)
    for i in np.flatnonzero(touching & (points.node < len(mesh.elements))):
        after, before = points.node[i], mesh.before[points.node[i]]
        outside, inside = (before, after) if in_zone[after] else (after, before)
        if not in_zone[outside] and lengths[outside] > LONG_NEIGHBOR * lengths[inside]:
            (x, y), times = mesh.nodes[points.node[i]], lengths[outside] / lengths[inside]
            yield (
                f"pressure acts at ({x:.5g}, {y:.5g}), the end of the zone '{_zone(body, i)}', beyond which an element "
                f"of '{mesh.edge_names[mesh.edge[outside]]}' is {times:.2g} times as long as that in the zone: the "
                "pressure there is less accurate; grade that edge towards the zone"
            )


def beyond_ends(body: Body, touching: NDArray[np.bool_]) -> Iterator[str]:
    """Note contact with the straight continuation of a polyline or a spline beyond its ends."""
    points = body.points
    for number, (name, zone) in enumerate(body.problem.contact_zones.items()):
        if not isinstance(zone.surface, Polyline | Spline):
            continue
        pressed = body.mesh.nodes[points.node[touching & (points.zone == number)]]
        beyond = pressed[zone.surface.beyond_ends(pressed)] if len(pressed) else pressed
        if len(beyond):
            x, y = beyond[0]
            yield (
                f"contact in {name} at ({x:.5g}, {y:.5g}) is with the straight continuation of its {zone.surface.kind} "
                "beyond the last point: the line has no ends; if the surface ends there, add a point that leads away"
            )


def large_pressure(body: Body, where: Footprint, boundary: BoundaryState) -> Iterator[str]:
    """Note a peak pressure that goes with large strains.

    The strain along the normal follows from the pressure and from the strain along the boundary. Shear below the
    surface is measured by the difference of the pressure from the least on the boundary, if that is none of tension: a
    pressure that acts all round shears nothing, however large it is.
    """
    if where.peak is None:
        return
    material, pressure = body.problem.material, where.peak.pressure
    E, nu = material.young_modulus, material.poisson_ratio
    at_peak = (boundary.points == np.array(where.peak.at)).all(axis=2).any(axis=1)
    along, change = (values[:, 2] - values[:, 0] for values in (boundary.points, boundary.displacement))
    length = np.hypot(*along.T)
    tangential = float(((along * change).sum(axis=1) / length**2)[at_peak].mean())
    if material.state == "plane_strain":
        normal = -(pressure * (1 + nu) * (1 - 2 * nu) / E + nu * tangential) / (1 - nu)
    else:
        normal = -(pressure * (1 - nu**2) / E + nu * tangential)
    outward = along[:, ::-1] * (1, -1) / length[:, None]
    least = float(-(boundary.traction.mean(axis=1) * outward).sum(axis=1).max())
    sheared = (pressure - max(least, 0.0)) / E
    strain = max(abs(normal), sheared)
    part = max(sheared / LARGE, abs(normal) / LARGE_STRAIN)
    if part > NOTICED:
        follows = "displacements are not small, so that the linear theory does not hold"
        off = f"linear theory is off by about {100 * strain:.2g} % there; error bars do not include this"
        yield (
            f"the peak pressure is {pressure / E:.2g} times Young's modulus, and strains there are about {strain:.2g}: "
            f"{follows if part > 1 else off}"
        )


def large_displacements(boundary: BoundaryState, turns: bool = True, modulus: float | None = None) -> Iterator[str]:
    """Note strains, slopes or rotations that are not small on a part of the boundary; translations do not count.

    `turns` is whether contact alone holds the body against rotation.
    """
    along, change = (values[:, 2] - values[:, 0] for values in (boundary.points, boundary.displacement))
    length = np.hypot(*along.T)
    gradient = np.hypot(*change.T) / length
    share = length[gradient > LARGE].sum() / length.sum()
    if share > LARGE_PART:
        yield (
            f"displacements are not small: on {100 * share:.0f} % of the boundary they change by more than {LARGE:g} "
            f"of the length along it, by strain or rotation, and up to {gradient.max():.2g}; the linear theory does "
            f"not hold; {_cause(boundary, turns, modulus)}"
        )


def _cause(boundary: BoundaryState, turns: bool, modulus: float | None) -> str:
    """What to do about large displacements: hold a body that turns as a whole, else check the numbers."""
    x, u = (
        values.reshape(-1, 2) - values.reshape(-1, 2).mean(axis=0)
        for values in (boundary.points, boundary.displacement)
    )
    turn = float(np.sum(x[:, 0] * u[:, 1] - x[:, 1] * u[:, 0]) / np.sum(x**2))
    if not turns or abs(turn) <= LARGE_TURN:
        found = "" if modulus is None else f", which is {modulus:.4g}"
        return (
            f"units may be mixed: check loads, lengths and Young's modulus{found}; in mm and N it is in N/mm², "
            "210e3 for steel, and in m and N it is in N/m², 210e9"
        )
    return (
        f"the body turns by {turn:.2g} rad ({np.degrees(turn):.0f} degrees): hold it against rotation by a condition "
        "or by another contact zone, or draw it as it is after most of this rotation"
    )


def _zone(body: Body, point: np.intp) -> str:
    """Name of the zone of a contact point."""
    return list(body.problem.contact_zones)[body.points.zone[point]]
