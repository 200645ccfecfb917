"""Contacts after the motion of their sides, as of a pin that is drawn elsewhere in its hole than it comes to lie.

Pairs of two elastic bodies are first those of bodies that touch as drawn, and the faces of rigid surfaces are where
they are drawn. Where the solution moves both sides beside this, other places are opposite to each other: gaps and
normals along a curved boundary are off by the motion over its radius, and by more where its curvature jumps. So pairs
and faces are found once more after the motion, until they rest.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from bemcontact.adaptivity.fields import CaseAnswer, Solved, solved_state
from bemcontact.arrays import Array, BoolArray
from bemcontact.bem.body import Body
from bemcontact.bem.condense import Condenser
from bemcontact.bem.contact_points import ALIKE
from bemcontact.bem.surface_gaps import surface_gaps
from bemcontact.bem.symmetry import symmetry_lines
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import ProblemError, SingularSystemError, SolverError
from bemcontact.problems.approach import moved_together
from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.curves import Segment, cross
from bemcontact.problems.edge_places import curvatures, nearest_on, places_at
from bemcontact.problems.nearest_places import surface_corners
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import DeflectedContour, Plane
from bemcontact.problems.surface_lines import Faces, LineSurface, Polyline
from bemcontact.problems.way import Way

RESTING = 0.05
"""Part of the accuracy by which the peak pressure may change with the pairs."""
MATTERS = 0.25
"""The same part from which another mesh is made, although the accuracy is met: it would be noted."""
LEAST_ASKED = 0.01
"""Accuracy that is meant, unless a smaller one is asked for."""
AS_A_WHOLE = 2.0
"""Motion over its differences within contact from which bodies move as a whole: it is 1 in the contact of Hertz."""
JUMPS = 10.0
"""How much more a peak may change where the curvature of an outline jumps: there the gap as drawn has a corner."""
ROUND_OFF = 1e-9
"""Distance of two lines of symmetry over the size of the bodies, up to which they are one; motion that is none."""
Curved = LineSurface | BodySurface
"""A rigid surface that may be curved."""
OF_SEMI_ELLIPSE = 4.0
"""Length of a semi-elliptic pressure over the root mean square of the distances from its middle."""
MOST_STEPS = 12
"""Steps in which the pairs have to come to rest."""
SLOWEST = 0.5
"""Largest ratio of two changes of the pairs: a body that nothing holds moves on and on."""


def with_resting_contacts(answer: Solved, condenser: Condenser) -> Solved:
    """The answer with contacts after the motion of their sides; as it is if these rest already, or never come to rest.

    Load cases that share a mesh share its pairs of elastic bodies, so these stay as they are.
    """
    found, last = answer, np.inf
    for _ in range(MOST_STEPS):
        problem, change = after_motion(found)
        if not change:
            return found
        if change > SLOWEST * last:
            break
        last = change
        try:
            found = solved_state(condenser(problem))
        except (ProblemError, SingularSystemError, SolverError):
            break
        if _lets_go(answer, found):
            break
    return answer


def _lets_go(before: Solved, after: Solved) -> bool:
    """Whether a free body or tool that is pressed before contact follows it is not pressed afterwards, in any case.

    A plate that turns by a given angle squeezes a roller out: with normals after the turn there is no pressure until
    the roller has moved by its own size. That is no state near the one as drawn.
    """
    return any((_pressed(one) & ~_pressed(two)).any() for one, two in zip(before.answers, after.answers, strict=True))


def _pressed(case: CaseAnswer) -> BoolArray:
    """Which bodies and tools are free to move, and are pressed."""
    body, contact, solution = case.condensation.body, case.condensation.contact, case.solution
    at = contact.pressed(solution.pressure, solution.displacement)
    moved = body.seen.unit_changes[at].any(axis=0) & body.free.coefficients.any(axis=0)
    return np.any(moved.reshape(-1, 3), axis=1)


def may_move(problem: Problem) -> bool:
    """Whether the problem has contacts that change with a motion; load cases share pairs of elastic bodies."""
    return bool(_curved(problem) or (_pairs(problem) and not has_cases(problem)))


def matters(problem: Problem, change: float) -> bool:
    """Whether a change of the peak with the pairs would be noted."""
    return change > MATTERS * _judged_to(problem)


def _judged_to(problem: Problem) -> float:
    return min(LEAST_ASKED, problem.asked_accuracy or LEAST_ASKED)


def _pairs(problem: Problem) -> dict[str, BodySurface]:
    """Surfaces of elastic bodies that others touch, by name of the contact."""
    surfaces = {name: zone.surface for name, zone in problem.zones.items()}
    return {name: it for name, it in surfaces.items() if isinstance(it, BodySurface) and it.first}


def _curved(problem: Problem) -> dict[str, Curved]:
    """Rigid surfaces that are curved or may turn, by name of the zone: along a straight one nothing else changes.

    Not those with a corner that presses on an edge: an element ends there, which does not follow it.
    """
    surfaces = {name: zone.surface for name, zone in problem.zones.items()}
    turning = {zone for tool in problem.tools.values() for zone in tool.zones if tool.free[2] or tool.position[2]}
    curved = {name: it for name, it in surfaces.items() if not isinstance(it, DeflectedContour | Polyline)}
    return {
        name: it
        for name, it in curved.items()
        if not (isinstance(it, BodySurface) and it.elastic)
        and (name in turning or not _is_straight(it))
        and not any(True for edge in map(problem.edge, problem.edges_of(name)) for _ in surface_corners(edge, it))
    }


def _is_straight(surface: Curved) -> bool:
    """Whether a rigid surface has straight faces only."""
    edges = surface.edges if isinstance(surface, BodySurface) else ()
    return isinstance(surface, Plane) or (bool(edges) and all(isinstance(edge.curve, Segment) for edge in edges))


def after_motion(answer: Solved) -> tuple[Problem, float]:
    """The problem with contacts after the motion of their sides, and the largest part by which that may change a peak.

    Followed are the components that are large beside the differences within contact: others are deformations, as all
    motion across a line of symmetry is. Rigid surfaces turn with their tools.
    """
    problem, change = answer.body.problem, 0.0
    least, shared = RESTING * _judged_to(problem), has_cases(problem)
    for name, case in zip(problem.case_names if shared else (None,), answer.answers, strict=True):
        found = [*(() if shared else _ways_of_pairs(answer.body, case)), *_ways_of_rigid(case)]
        largest = max((of_peak for _, _, of_peak in found), default=0.0)
        if largest > least:
            ways = {zone: way for zone, way, of_peak in found if of_peak > 0}
            problem, change = problem.after_motions(ways, name), max(change, largest)
    return problem, change


def has_cases(problem: Problem) -> bool:
    """Whether the problem has load cases on one mesh."""
    return bool(problem.load_cases) and problem.case is None


def _ways_of_pairs(body: Body, case: CaseAnswer) -> Iterator[tuple[str, Way, float]]:
    """For each contact of two elastic bodies, where the second one is beside the first, and what that may change.

    A peak is off as of `PairMotion.change_of_peak`, ends of contact as of `change_of_ends`. As one side slides along
    the other, common normals turn by the larger curvature at most, and gaps are off by half of the turn times the
    slide: a peak is off by these as of `_ways_of_rigid`.
    """
    contact = case.condensation.contact
    moved = motions_of_pairs(body, contact, case.solution.pressure, case.displacement)
    for name, motion in moved.items():
        surface, step = _pairs(body.problem)[name], motion_as_a_whole(body, name, motion)
        x, y = (surface.approach.step + step).tolist()
        turn = abs(float(motion.turns @ step))
        off = turn * float(np.hypot(*step)) / contact.scales.displacement / 2
        yield name, Way(x, y), max(turn / 2, off / 2, motion.change_of_peak(step), motion.change_of_ends(step))


def _ways_of_rigid(case: CaseAnswer) -> Iterator[tuple[str, Way, float]]:
    """For each curved rigid surface, where it is beside the body, and what that may change.

    A peak is off by about half of what gaps are off beside the displacement scale of contact, or normals are. On a tool
    that is free to turn, it is also off by what the lever of the force is off beside the length that is pressed.
    """
    body, contact, solution = case.condensation.body, case.condensation.contact, case.solution
    names = [*body.problem.zones]
    gaps, displacement = surface_gaps(body, case.state, contact, solution), np.zeros((len(body.mesh.nodes), 2))
    displacement[body.mesh.elements] = case.displacement
    scale, (inward, reach) = contact.scales.displacement, body.outline.sides
    touched = contact.initial_gap + solution.displacement <= scale
    for surfaces in _going_on(body, _curved(body.problem)):
        own = np.isin(contact.zone, [names.index(name) for name in surfaces])
        beside = np.flatnonzero(touched & own)
        at, force = body.points.node[beside], (contact.weights * solution.pressure)[beside]
        if not force.any():
            continue
        places, tool = body.mesh.nodes[at], gaps.way_of_tool(next(iter(surfaces)))
        spin, steps = tool._replace(x=0.0, y=0.0), tool.step - displacement[at]
        motion = steps + spin.motion_of(places - steps)
        mean, step = (force @ item / force.sum() for item in (motion, steps))
        spread = np.sqrt(force @ (motion - mean) ** 2 / force.sum())
        still = abs(motion).min(axis=0) <= ROUND_OFF * abs(motion).max()  # as at a line of symmetry
        x, y = (step - np.where(still | (abs(mean) <= AS_A_WHOLE * spread), mean, 0.0)).tolist()
        way, part = spin._replace(x=x, y=y), 0.0
        for name, surface in surfaces.items():
            mine, found, moments = contact.zone[beside] == names.index(name), list[Faces](), list[float]()
            if not force[mine].any():
                continue
            there, moved = places[mine], steps[mine]
            for item in (surface, surface.after(way)):
                faces = item.faces(there, inward[at[mine]], reach[at[mine]])
                motion = moved + spin.motion_of(there - item.way.step)
                found.append(faces._replace(gap=faces.gap - np.einsum("ksx,kx->ks", faces.normals, motion)))
                moments.append(float(force[mine] @ cross(there - item.way.step - tool.about, faces.normals[:, 1])))
            now, after = found
            off = float(abs(after.gap - now.gap).max()) / scale
            turned = 0.0 if _is_straight(surface) else float(np.hypot(*(after.normals - now.normals).T).max())
            part = max(part, max(off, turned) / 2 * (JUMPS if isinstance(surface, BodySurface) else 1.0))
            if any(tool.free[2] for tool in body.problem.tools.values() if name in tool.zones):
                lever = abs(moments[1] - moments[0]) / force[mine].sum()
                part = max(part, lever / contact.weights[beside][mine & (force > 0)].sum())
        yield from ((name, way, part) for name in surfaces)


def _going_on(body: Body, surfaces: Mapping[str, Curved]) -> Iterator[dict[str, Curved]]:
    """Rigid surfaces of zones, those together that go on in one another at a node: it is one place of one surface."""
    mesh, tied, (inward, reach) = body.mesh, body.points.tied, body.outline.sides
    tool_of = {zone: name for name, tool in body.problem.tools.items() for zone in tool.zones}
    names, left = [*body.problem.zones], dict(surfaces)
    nodes = {name: np.unique(mesh.elements[body.outline.in_zones[names.index(name)]]) for name in left}

    def go_on(one: str, two: str) -> bool:
        common, i, j = np.intersect1d(tied[nodes[one]], tied[nodes[two]], return_indices=True)
        if not len(common) or tool_of.get(one) != tool_of.get(two):
            return False
        first, second = (
            surfaces[name].faces(mesh.nodes[at], inward[at], reach[at])
            for name, at in ((one, nodes[one][i]), (two, nodes[two][j]))
        )
        beside = np.hypot(*(first.normals - second.normals)[:, 1].T), abs(first.gap - second.gap)[:, 1] / mesh.size
        return bool(np.any(np.maximum(*beside) <= ALIKE))

    while left:
        group = [next(iter(left))]
        for one in group:
            group += [two for two in left if two not in group and go_on(one, two)]
        yield {name: left.pop(name) for name in group}


def motion_as_a_whole(body: Body, contact: str, motion: "PairMotion") -> Array:
    """Motion (2,) [L] of a contact of two elastic bodies beside the one that its pairs follow, without deformations."""
    step = motion.mean - _pairs(body.problem)[contact].approach.step
    step[abs(step) <= AS_A_WHOLE * motion.spread] = 0.0
    step[_axes_of_symmetry(body, contact)] = 0.0
    return step


def _axes_of_symmetry(body: Body, contact: str) -> list[int]:
    """Axes 0 and 1 across which both bodies of a contact end at one line of symmetry."""
    names = [part.name for part in body.problem.parts]
    of_bodies = [
        {(line.axis, line.outward): line.place for line in symmetry_lines(body.problem, body.mesh.parts[number].mesh)}
        for number in map(names.index, body.problem.touching_bodies(contact))
    ]
    one, other = of_bodies[0], of_bodies[-1]
    same = ROUND_OFF * body.mesh.size
    return [axis for (axis, out), at in one.items() if abs(other.get((axis, out), np.inf) - at) <= same]


class PairMotion(NamedTuple):
    """Motion of the second of two elastic bodies beside the first one, where there is pressure.

    Parameters
    ----------
    mean : (2,) displacement less the stated gap [L]
    spread : (2,) root mean square of its differences from the mean [L]
    bends : (2, 2) vectors [1/L] along and across the normal at the peak, as long as the curvature that counts
    turns : (2,) vector [1/L] across the normal at the peak, as long as the turn of common normals by a slide may be
    slides : (2,) vector [1/L] across the normal at the peak, one over the length of contact, unless both sides are flat
    """

    mean: Array
    spread: Array
    bends: Array
    turns: Array
    slides: Array

    def change_of_peak(self, step: Array) -> float:
        """Part by which a peak is off if pairs are off by a motion (2,) [L].

        Along a curved boundary the distances of pairs are off by the motion over its radius, and a peak by about half
        of this: measured with pins that are drawn beside where they come to lie.
        """
        return float(np.hypot(*(self.bends @ step))) / 2

    def change_of_ends(self, step: Array) -> float:
        """Part of the length of contact by which its ends are off, at most, if pairs are off by a motion (2,) [L].

        Contact stays where both sides are nearest. With pairs as drawn it moves with a curved side by a part of the
        slide, which depends on both curvatures.
        """
        return abs(float(self.slides @ step))


def motions_of_pairs(
    body: Body, contact: CondensedContact, pressure: Array, displacement: Array
) -> dict[str, PairMotion]:
    """Motions by name of each contact of two elastic bodies with pressure (n,) [p], from displacement (m, 3, 2) [L]."""
    touching, names, at = _pairs(body.problem), [*body.problem.zones], np.zeros((len(body.mesh.nodes), 2))
    at[body.mesh.elements] = displacement
    other = body.points.opposite.node
    motion = np.where((other < 0)[:, None], 0.0, at[other] - at[body.points.node])
    gaps = np.array([touching[name].offset if name in touching else 0.0 for name in names])
    motion -= gaps[contact.zone, None] * contact.normals
    found = dict[str, PairMotion]()
    for signs in moved_together(touching, body.problem.bonded_groups, smooth=True):
        own, sign = [names.index(name) for name in signs], np.array([*signs.values()])
        signed = sign[:, None] * contact.weights_by_zone[own] * pressure
        force = abs(signed).sum()
        if force > 0:
            mean = (signed @ motion).sum(axis=0) / force
            squares = (np.sign(signed)[..., None] * motion - mean) ** 2
            spread = np.sqrt(np.einsum("kn,knd->d", abs(signed), squares) / force)
            share = abs(signed).sum(axis=0) / force
            peak, away = int(share.argmax()), contact.points - share @ contact.points
            length = max(OF_SEMI_ELLIPSE * float(np.sqrt(share @ away**2).max()), float(contact.weights[peak]))
            found |= {
                name: PairMotion(each * mean, spread, *_bends(touching[name], contact.points[peak, None], length))
                for name, each in signs.items()
            }
    return found


def _bends(surface: BodySurface, point: Array, length: float) -> tuple[Array, Array, Array]:
    """Vectors (2, 2), (2,) and (2,) [1/L] at a point (1, 2) of contact of a length [L], as of `PairMotion`.

    Along the normal the curvatures of both sides count in proportion to their part in common normals. Across it the
    smaller one counts: what slides along a flat side keeps its distances.
    """
    place, pair = nearest_on(surface.first, point), surface.pairs(point)
    other = places_at(surface.edges, pair.edge, pair.fraction)
    own, its = abs(curvatures(surface.first, place)[0]), abs(curvatures(surface.edges, other)[0])
    x, y = pair.normals[0]
    both = surface.share * own + (1 - surface.share) * its
    along, across = np.array([x, y]), np.array([-y, x])
    return np.array([both * along, min(own, its) * across]), max(own, its) * across, bool(own + its) / length * across
