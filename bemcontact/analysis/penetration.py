"""Whether the deformed body penetrates a rigid surface at any place of its boundary.

Contact conditions hold at contact points. Nothing keeps the body out of a surface between them, or with edges that are
in no zone of it.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np

from bemcontact.analysis.diagnostics import longer
from bemcontact.analysis.linear_theory import Noticed, linear_theory
from bemcontact.analysis.motion_series import MotionSeries
from bemcontact.analysis.moved_contact import judged_to
from bemcontact.analysis.path_states import FollowedPath
from bemcontact.analysis.placement import placement
from bemcontact.analysis.second_order import second_order
from bemcontact.arrays import Array, BoolArray, IntArray, indices, magnitudes
from bemcontact.assessment.footprint import Footprint, footprint
from bemcontact.assessment.penetration import ROUND_OFF, Misfit, Penetration, penetration_in_words, tolerated
from bemcontact.bem.body import Body
from bemcontact.bem.second_side import Inside, deepest_inside
from bemcontact.bem.surface_gaps import FaceEnd, SurfaceGaps, surface_gaps
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.parametric.path import LoadPath
from bemcontact.problems.loops import contains, first_meeting, signed_area, winds_once
from bemcontact.problems.problem import Problem

DETAIL = 1e-4
"""Length over the size of the body of parts of its boundary that may fold: the tip of a notch."""
FIRST_TOUCH = 1e-6
"""Pressure over the largest on a path up to which it is the round-off of a state of first touch: it presses nothing."""


def misfit(
    gaps: SurfaceGaps,
    body: Body,
    contact: CondensedContact,
    solution: ContactSolution,
    where: Footprint,
    infinite: Collection[str],
    series: MotionSeries,
) -> tuple[Penetration | None, tuple[str, ...]]:
    """Find what does not fit, or else displacements that are not small; note the rest.

    `infinite` are the zones whose peak is. Strains that are not small fold the boundary, and those above one tell
    nothing of where the body is.
    """
    deepest, notes = penetration(gaps, body, contact, solution, infinite=infinite, series=series)
    beyond, noticed = linear_theory(body, contact, solution, where, gaps.state)
    if deepest is None and beyond is None and not noticed:  # what strains change that are noted is not told twice
        beyond, noticed = second_order(body, gaps.state, contact.initial_gap)
    if deepest is not None and beyond is not None:
        if deepest.kind in (Misfit.ITSELF, Misfit.EACH_OTHER) or beyond.depth > 1:
            deepest, beyond = beyond, deepest
        return deepest, (*notes, beyond.as_note)
    return deepest or beyond, (*notes, *(item.words for item in noticed))


def penetration(
    gaps: SurfaceGaps,
    body: Body,
    contact: CondensedContact,
    solution: ContactSolution,
    nearby: Array | None = None,
    infinite: Collection[str] = (),
    series: MotionSeries | None = None,
) -> tuple[Penetration | None, tuple[str, ...]]:
    """Find the deepest penetration that is not tolerated, or else contact that is misplaced; note the rest.

    Of a state on a path, `nearby` (2, zones) is the least and the largest peak [p] of each zone a little before and
    after it.
    """
    worst, notes = None, list[str]()
    allowed = tolerated(contact, gaps.largest, gaps.size)
    for zone in gaps.surfaces:
        found, paired = gaps.intrusion(zone), gaps.paired[zone]
        depth = float(found.depth.max())
        if depth > max(allowed, worst.depth if worst else 0.0):
            deepest = indices(found.depth >= (1 - ROUND_OFF) * depth)
            element = int(deepest[np.argmin(paired[deepest])])  # of equal depths that which is easier to understand
            worst = _penetration(gaps, zone, element, found.xi[element], depth, allowed)
        other = None if worst else deepest_inside(gaps, zone)
        if other is not None and other.depth > max(allowed, gaps.second_order(zone)):
            worst = _of_second(gaps, zone, other, allowed)
        notes += _behind(gaps, zone, found.behind)
        notes += () if worst else _excused(gaps, zone, found.excused, found.xi, allowed)
        notes += _ended(gaps, zone, [end for end, hidden in found.ends if hidden > allowed])
    if worst is None or not worst.paired:  # an edge that is not in a zone may be there through the body itself
        worst = _through_itself(gaps, body) or worst
    misplaced, said = (None, ()) if worst else placement(gaps, body, contact, solution, nearby, infinite, series)
    return worst or misplaced, (*notes, *said)


def _through_itself(gaps: SurfaceGaps, body: Body) -> Penetration | None:
    """Find two parts of the displaced boundary that cross: chords of half elements first, then finer ones.

    A thin hole may turn inside out as a whole, and cross nowhere.
    """
    state, mesh = gaps.state, gaps.outline.mesh
    every, after = np.arange(len(mesh.elements)), mesh.elements[:, 2]
    ends = (indices(after[:-1] != every[1:]) + 1).tolist()
    loops = [every[first:last] for first, last in pairwise([0, *ends, len(every)])]
    bodies = [gaps.problem.part_of(mesh.edge_names[mesh.edge[elements[0]]]) for elements in loops]
    problem = gaps.problem
    stated = {frozenset(problem.sides_of(name)) for name in (*problem.contacts, *problem.bonded)}
    stated |= _bonded_at_a_place(body)
    drawn, chords = (
        [values[elements].reshape(-1, 2) for elements in loops]
        for values in (state.points[:, :2], state.points[:, :2] + state.displacement[:, :2])
    )
    outer = [i == 0 or bodies[i] != bodies[i - 1] for i in range(len(loops))]  # a hole runs clockwise
    inverted = [
        (signed_area(other) > 0) is not runs and signed_area(one) * signed_area(other) < 0
        for one, other, runs in zip(drawn, chords, outer, strict=True)
    ]
    if not any(inverted) and _crossing(chords, bodies, stated, gaps) is None:
        return _swallowed(gaps, loops, drawn, chords, bodies, stated)
    places = [gaps.moved(elements) for elements in loops]
    meeting = _crossing([item[:, :-1].reshape(-1, 2) for item in places], bodies, stated, gaps)
    if any(inverted):
        turned = chords[inverted.index(True)]
        meeting = turned[np.hypot(*(turned - drawn[inverted.index(True)]).T).argmax()]
    if meeting is None:
        return None
    elements, near = np.concatenate(loops), np.concatenate(places) - meeting
    distance = magnitudes(near)
    order = elements[np.argsort(distance.min(axis=1))]
    of_edge = [gaps.problem.part_of(name) for name in state.edge_names]
    nearest = [(int(i), of_edge[mesh.edge[i]]) for i in order]
    one, other = next(
        (i, j)
        for number, (j, body) in enumerate(nearest)
        for i, its in nearest[:number]
        if j not in (mesh.before[i], mesh.elements[i, 2]) and frozenset((its, body)) not in stated
    )
    first, second = (gaps.outline.sampled(np.array([i]))[0][distance[elements == i].argmin()] for i in (one, other))
    edges = [state.edge_names[state.edge[i]] for i in (one, other)]
    x, y = first.tolist()
    of = [gaps.problem.part_of(edge) for edge in edges]
    if of[0] != of[1]:
        return Penetration(
            kind=Misfit.EACH_OTHER, depth=float(np.hypot(*(first - second))), allowed=0.0, at=(x, y), edge=edges[0],
            zone="", paired=False,
            words=(
                f"The bodies '{of[0]}' and '{of[1]}' penetrate each other at ({x:.5g}, {y:.5g}), where '{edges[0]}' "
                f"and '{edges[1]}' cross after the motion. No contact between them is stated; add one, such as "
                f"between: [{of[0]}, {of[1]}]."
            ),
        )  # fmt: skip
    who, state = "The body", "Give the body a name under bodies, and state"
    if of[0]:
        who, state = f"The body '{of[0]}'", "State"
    crossing = " and ".join(f"'{edge}'" for edge in edges) if len(set(edges)) > 1 else f"two parts of '{edges[0]}'"
    return Penetration(
        kind=Misfit.ITSELF, depth=float(np.hypot(*(first - second))), allowed=0.0, at=(x, y), edge=edges[0], zone="",
        paired=False,
        words=(
            f"{who} penetrates itself at ({x:.5g}, {y:.5g}), where {crossing} cross after the motion. No contact "
            f"between them is stated: parts that should press on each other pass through. {state} contact between two "
            "of its edges; or reduce the load to that at which they meet; or take half of the body, with a rigid plane "
            "in the middle of the slot, if it is symmetric."
        ),
    )  # fmt: skip


def _bonded_at_a_place(body: Body) -> set[frozenset[str]]:
    """Pairs of bodies that meet in one place where bonds with others hold both, as two of four quarters do."""
    if not body.problem.bonded:
        return set()
    tied, parts = body.points.tied, body.problem.parts
    of_node = np.zeros(len(tied), int)
    for number, part in enumerate(body.mesh.parts):
        of_node[part.nodes] = number
    places = indices(np.bincount(tied) > 2)
    names = ([parts[number].name for number in of_node[tied == place].tolist()] for place in places)
    return {frozenset(pair) for meeting in names for pair in combinations(meeting, 2)}


def _swallowed(
    gaps: SurfaceGaps, loops: Sequence[IntArray], drawn: Sequence[Array], moved: Sequence[Array],
    bodies: Sequence[str], stated: Collection[frozenset[str]],
) -> Penetration | None:  # fmt: skip
    """Find a body that has moved wholly into another one, so that their boundaries cross nowhere."""
    for i, name in enumerate(bodies):
        for other in dict.fromkeys(bodies):
            if other == name or frozenset((name, other)) in stated:
                continue
            own = [number for number, body in enumerate(bodies) if body == other]
            before, after = (sum(contains(lines[j], lines[i][0]) for j in own) % 2 for lines in (drawn, moved))
            if after and not before:
                x, y = drawn[i][0].tolist()
                edge = gaps.outline.mesh.edge_names[gaps.outline.mesh.edge[loops[i][0]]]
                return Penetration(
                    kind=Misfit.EACH_OTHER, depth=float(np.hypot(*(moved[i][0] - drawn[i][0]))), allowed=0.0, at=(x, y),
                    edge=edge, zone="", paired=False,
                    words=(
                        f"The body '{name}' lies inside '{other}' after the motion. No contact between them is stated; "
                        f"add one, such as between: [{name}, {other}]."
                    ),
                )  # fmt: skip
    return None


def _without_details(line: Array, length: float) -> Array:
    """The line (k, 2) with no two points inside one part of this length."""
    steps = magnitudes(line[1:] - line[:-1])
    if steps.min() >= length:
        return line
    along = np.append(0.0, steps.cumsum())
    kept = np.diff(np.floor(along / length), prepend=-1.0) > 0
    kept[-1] = True
    return line[kept]


def _crossing(
    loops: Sequence[Array], bodies: Sequence[str], stated: Collection[frozenset[str]], gaps: SurfaceGaps
) -> Array | None:
    """First point (2,) at which closed lines (k, 2) of bodies cross between which no contact is stated.

    At the tip of a notch strains are not small: neighbors that fold there do not count.
    """
    size = gaps.size
    tolerance = ROUND_OFF * size
    closed = [_without_details(np.concatenate([points, points[:1]]), DETAIL * size) for points in loops]
    for i, line in enumerate(closed):
        for j, other in enumerate(closed[: i + 1]):
            if frozenset((bodies[i], bodies[j])) in stated or (i == j and winds_once(line, 2 * tolerance)):
                continue
            point = first_meeting(line, other, tolerance, itself=i == j)
            if point is not None:
                return point
    return None


def penetration_on_path(
    followed: FollowedPath, *, infinite: Collection[str]
) -> tuple[Penetration | None, float | None, tuple[str, ...]]:
    """Find the deepest penetration at the breakpoints of a path, and the value there; note the rest.

    A state at an end of the path is judged as a solution is. `infinite` are the zones whose peak is; no strain is told
    there.
    """
    varied, path = followed.varied, followed.path
    worst, at, notes = None, None, dict[str, list[float]]()
    last, near, strained = len(path.parameter) - 1, judged_to(varied.problem), dict[str, tuple[Noticed, float]]()
    for i, t in enumerate(path.parameter.tolist()):
        value, solution = followed.value(t), path.breakpoint(i)
        if solution.pressure.max(initial=0.0) <= FIRST_TOUCH * path.pressure.max(initial=0.0):
            solution = replace(solution, pressure=np.zeros_like(solution.pressure))
        condensation, state = followed.state(t, solution)
        body, contact = condensation.body, condensation.contact
        gaps = surface_gaps(body, state, contact, solution)
        nearby = _peaks_within(path, t - near, t + near) if 0 < i < last else None
        found, said = penetration(gaps, body, contact, solution, nearby, infinite)
        beyond, noticed = linear_theory(body, contact, solution, footprint(contact, solution, infinite=infinite), state)
        found = found or beyond
        if found is not None and (worst is None or _order(found) > _order(worst)):
            worst, at = found, value
        for item in noticed:
            strained[item.of] = max(strained.get(item.of, (item, value)), (item, value), key=lambda pair: pair[0].size)
        for note in said:
            notes.setdefault(note, []).append(value)
    notes.update({item.words: [value] for item, value in strained.values()})
    return worst, at, tuple(f"{_where(varied.key, values)}, {note}" for note, values in notes.items())


def _order(found: Penetration) -> tuple[bool, float]:
    """What is worse of two findings on a path."""
    return found.kind.serious, found.depth


def _peaks_within(path: LoadPath, low: float, high: float) -> Array:
    """Least and largest peak (2, zones) of each zone between two t, by the breakpoints between them and the ends.

    Ends beyond those of the path are those of the path.
    """
    ends = [path.at(min(max(t, path.begins_at), path.ends_at)).pressure for t in (low, high)]
    pressure = np.array([*ends, *path.pressure[(low <= path.parameter) & (path.parameter <= high)]])
    own = path.start.zone == np.arange(len(path.zones))[:, None]
    peaks = np.where(own, pressure[:, None, :], 0.0).max(axis=2, initial=0.0)
    return np.array([peaks.min(axis=0), peaks.max(axis=0)])


def _where(key: str, values: Sequence[float]) -> str:
    """Say at which values of a key something holds."""
    ends = dict.fromkeys(f"{value:.6g}" for value in (values[0], values[-1]))
    return f"at {key} = {' to '.join(ends)}"


def _penetration(gaps: SurfaceGaps, zone: str, element: int, xi: float, depth: float, allowed: float) -> Penetration:
    """Describe a penetration."""
    x, y = gaps.outline.places(np.array([element]), np.array([[xi]])).points[0, 0].tolist()
    edge, paired = gaps.state.edge_names[gaps.state.edge[element]], bool(gaps.paired[zone][element])
    how_deep = f"{depth:.3g} {gaps.problem.units.length}".strip()
    return Penetration(
        depth=depth,
        allowed=allowed,
        at=(x, y),
        edge=edge,
        zone=zone,
        paired=paired,
        words=_in_words(gaps.problem, zone, edge, f"by {how_deep} at ({x:.5g}, {y:.5g}) on '{edge}'", paired=paired),
    )


def _of_second(gaps: SurfaceGaps, zone: str, found: Inside, allowed: float) -> Penetration:
    """Describe a penetration of the first body by an edge of the second one."""
    x, y = found.at.tolist()
    how_deep = f"{found.depth:.3g} {gaps.problem.units.length}".strip()
    return Penetration(
        depth=found.depth,
        allowed=allowed,
        at=(x, y),
        edge=found.edge,
        zone=zone,
        paired=False,
        words=_in_words(
            gaps.problem, zone, found.edge, f"by {how_deep} at ({x:.5g}, {y:.5g}) on '{found.edge}'", paired=False
        ),
    )


def _in_words(problem: Problem, zone: str, edge: str, where: str, *, paired: bool) -> str:
    """Say which surface an edge penetrates, why nothing keeps it out, and what to do."""
    body, own = problem.part_of(edge), problem.edges_of(zone)
    divide = "It has a condition, and such an edge cannot touch: divide it, and"  # to name it would be refused
    loaded = edge in problem.edge_conditions
    if zone in problem.contacts:
        first, second = problem.sides_of(zone)
        fact = f"'{body}' penetrates '{second if body == first else first}' {where}"
        if edge in own:
            how = longer(problem, zone)
            advice = f"beyond the part of this edge that may touch in '{zone}'. {how[0].upper()}{how[1:]}."
        else:
            name = f"{divide} name the part without the condition" if loaded else "Name it"
            advice = f"an edge that is not in the contact '{zone}'. {name} in between, with the others of '{body}'."
        return penetration_in_words(fact, advice, paired=paired)
    who = f"The body '{body}'" if body else "The body"
    fact = f"{who} penetrates the surface of '{zone}' {where}"
    ends = "If the surface ends before that place, state it as"
    if body and body not in {problem.part_of(name) for name in own}:
        advice = (
            f"a body that has no edge in that zone. {ends} a body with rigid: true, which ends where it ends. Else add "
            "the edge to the zone."
        )
    else:
        add = (
            f"{divide} add the part without the condition to the zone."
            if loaded
            else "Add the edge to the zone; if it is in another one, divide it, or state both surfaces as one polyline."
        )
        advice = (
            f"an edge that is not in that zone. {add} {ends} a polyline that turns away there"
            f"{', or as a body with rigid: true' if body else ''}."
        )
    return penetration_in_words(fact, advice, paired=paired)


def _excused(gaps: SurfaceGaps, zone: str, depth: Array, xi: Array, allowed: float) -> Iterator[str]:
    """Note a penetration that linear theory can explain."""
    element = int(np.argmax(depth))
    if depth[element] > allowed:
        x, y = gaps.outline.places(np.array([element]), np.array([[xi[element]]])).points[0, 0].tolist()
        edge, inside = (
            gaps.state.edge_names[gaps.state.edge[element]],
            f"{depth[element]:.2g} {gaps.problem.units.length}",
        )
        problem = gaps.problem
        beyond, remedy = f"'{edge}' is not in '{zone}'", "if this edge should touch, add it to the zone"
        if zone in problem.contacts and edge in problem.edges_of(zone):
            beyond, remedy = f"'{edge}' may touch in '{zone}' on a part of it only", longer(problem, zone)
        elif problem.several and zone not in problem.contacts:
            remedy += "; if the surface ends before it, state the surface as a body with rigid: true"
        yield (
            f"{beyond}, and is inside its surface by {inside.strip()} at ({x:.5g}, {y:.5g}): displacements are so "
            f"large that linear theory may be off by this, so it does not count; {remedy}"
        )


def _behind(gaps: SurfaceGaps, zone: str, behind: BoolArray) -> Iterator[str]:
    """Note edges that are behind a surface before anything moves."""
    edges = sorted({gaps.state.edge_names[i] for i in gaps.state.edge[behind]})
    if edges:
        names = ", ".join(f"'{name}'" for name in edges)
        endless = gaps.problem.several and zone not in gaps.problem.contacts
        remedy = "; state the surface as a body with rigid: true, which ends where it ends" * endless
        yield (
            f"part of {names} lies behind the surface of '{zone}' as stated: the surface is taken to end before "
            f"it, and contact there was not looked at{remedy}"
        )


def _ended(gaps: SurfaceGaps, zone: str, ends: Iterable[FaceEnd]) -> Iterator[str]:
    """Note where a surface is taken to end beside an edge that is in no zone, and the body moves to beyond it."""
    for end in ends:
        edge, (x, y) = gaps.state.edge_names[gaps.state.edge[end.element]], end.at.tolist()
        if end.of_zone and not gaps.in_a_zone(end.element):
            yield (
                f"the surface of '{zone}' is taken to end at ({x:.5g}, {y:.5g}), where the zone ends: '{edge}' "
                "lies in it and is in no zone; add it to the zone if the surface goes on"
            )
