"""Checks of several bodies against each other: names first, then which parts can meet."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from bemcontact.errors import Issue, KeyPath
from bemcontact.problems.bodies import SEPARATOR, BodySpec, body_in, qualified, unknown_edge
from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.conditions import Loads
from bemcontact.problems.contact_zone import ContactZone, RigidTool
from bemcontact.problems.pin_and_hole import described_sides, pin_and_hole
from bemcontact.problems.reference import Crack, FlatPunch, PinInHole, ProppedBeam, Reference, ShrinkFit
from bemcontact.problems.rigid_surface import DeflectedContour
from bemcontact.problems.stated_bodies import StatedBodies
from bemcontact.problems.validation import KeyIssue
from bemcontact.problems.wording import exact, unknown_word

COINCIDE = 1e-6
"""Distance of bonded edges over the size of the bodies that is round-off of coordinates."""
ACROSS = 1e-3
"""How far an edge may leave a line of symmetry, over its length: users round coordinates."""
SAMPLES = 33
"""Places of an edge where the distance is measured."""


def body_issues(problem: StatedBodies) -> Iterator[Issue]:
    """Issues of the bodies themselves: what belongs to each of them, copies, materials, conditions."""
    for key, given in (
        ("material", problem.material is not None),
        ("boundary", problem.boundary is not None),
        ("conditions", bool(problem.conditions)),
        ("loads", problem.loads != Loads()),
    ):
        if given:
            belong = "belong" if key.endswith("s") else "belongs"
            yield KeyIssue(
                path=(key,), message=f"with several bodies {key} {belong} to each of them: bodies.NAME.{key}"
            )
    for name, body in problem.bodies.items():
        yield from _copy_issues(problem, name, body)
        if isinstance(body.material, str) and body.material not in problem.materials:
            message = unknown_word("material", body.material, problem.materials)
            yield Issue(path=("bodies", name, "material"), message=message)
        original = problem.bodies.get(body.copy_of or name)
        if original is not None and original.boundary is not None:
            edges = [edge.name for edge in original.boundary.edges]
            for edge in body.conditions:
                if edge not in edges:
                    own = edge.removeprefix(name + SEPARATOR)
                    message = unknown_word("edge", edge, edges)
                    if own in edges:
                        message = f"conditions of a body name its edges alone: write '{own}' for '{edge}'"
                    yield KeyIssue(path=("bodies", name, "conditions", edge), message=message)
    if all(body.rigid for body in problem.bodies.values()):
        yield Issue(path=("bodies",), message="all bodies are rigid; at least one has to be elastic")


def symmetry_issues(problem: StatedBodies, data: Any) -> Iterator[Issue]:
    """Issues of lines of symmetry in the data of a valid problem that are no straight edges across their axis."""
    bodies = data.get("bodies") or {} if isinstance(data, Mapping) else {}
    for name, body in [("", data), *bodies.items()]:
        stated = body.get("conditions") if isinstance(body, Mapping) else None
        for own, condition in (stated or {}).items():
            axis = condition.get("symmetry") if isinstance(condition, Mapping) else None
            if axis not in ("x", "y"):
                continue
            edge, other = problem.edge(qualified(name, own)), "y" if axis == "x" else "x"
            wide = np.ptp(edge.points(np.linspace(0, 1, SAMPLES)), axis=0) > ACROSS * edge.length
            if wide["xy".index(axis)]:
                hint = f"write symmetry: {other}"
                if wide["xy".index(other)]:
                    hint = f"an edge that slides along {other} has displacement: {{{axis}: 0}}"
                message = (
                    f"'{own}' is no straight edge along {other}, where the body may go on as its image along {axis}"
                )
                path = ("bodies", name) if name else ()
                yield Issue(path=(*path, "conditions", own, "symmetry"), message=f"{message}; {hint}")


def _copy_issues(problem: StatedBodies, name: str, body: BodySpec) -> Iterator[Issue]:
    """Issues of a copy of another body."""
    if body.copy_of is None:
        return
    path: KeyPath = ("bodies", name, "copy_of")
    originals = [other for other, spec in problem.bodies.items() if spec.copy_of is None]
    if body.copy_of not in problem.bodies:
        yield Issue(path=path, message=unknown_word("body", body.copy_of, originals))
    elif body.copy_of == name:
        yield Issue(path=path, message=f"'{name}' cannot be a copy of itself; name another body, or give its boundary")
    elif body.copy_of not in originals:
        of = problem.bodies[body.copy_of].copy_of
        yield Issue(path=path, message=f"'{body.copy_of}' is a copy itself; name its original '{of}'")
    else:
        original = problem.bodies[body.copy_of]
        for key, its in (("conditions", original.conditions), ("loads", original.loads != Loads())):
            if its and key not in body.model_fields_set:
                what = f"'{body.copy_of}' has {key}, and a copy does not take them over"
                yield Issue(path=path, message=f"{what}; state those of '{name}', or {key}: {{}} if it has none")
        if original.rigid and (body.conditions or body.loads != Loads()):
            yield Issue(
                path=path, message=f"'{body.copy_of}' is rigid, so that its copy has no conditions and no loads"
            )


def contact_issues(problem: StatedBodies, tools: Mapping[str, RigidTool]) -> Iterator[Issue]:
    """Issues of contacts, zones and load cases that name what does not exist, or what cannot touch."""
    if not problem.contacts and not problem.contact_zones:
        message = "nothing touches; give contacts between bodies, such as contacts: {track: {between: [roller, rail]}}"
        yield Issue(path=("contacts",), message=message)
    edges = [edge.name for edge in problem.edges]
    for name, contact in problem.contacts.items():
        path: KeyPath = ("contacts", name)
        if name in problem.contact_zones:
            yield KeyIssue(path=path, message=f"a contact zone has the name '{name}' already; give another name")
        sides = [
            issue
            for number in (0, 1)
            for issue in _side_issues(problem, contact.between[number], (*path, "between"), number)
        ]
        yield from sides
        if not sides:
            yield from _pair_issues(problem, contact.between, (*path, "between"))
    yield from _bond_issues(problem)
    for name, zone in problem.contact_zones.items():
        yield from _contour_issues(problem, name, zone, edges)
        for i, edge in enumerate(zone.edges or ()):
            if edge not in edges:
                yield Issue(path=("contact_zones", name, "edges", i), message=unknown_edge(edge, edges))
            elif edge in problem.edge_conditions:
                message = f"edge '{edge}' has a condition and cannot touch; remove one of the two"
                yield Issue(path=("contact_zones", name, "edges", i), message=message)
    touched = {body_in(side) for contact in problem.contacts.values() for side in contact.between}
    for name in problem.bodies:
        if not problem.is_elastic(name) and name not in touched:
            message = f"no contact names the rigid body '{name}', so that nothing touches it; add one, or remove it"
            yield Issue(path=("bodies", name), message=message)
    yield from _case_issues(problem, edges)
    yield from _tool_issues(problem, tools)


def _contour_issues(problem: StatedBodies, name: str, zone: ContactZone, edges: Sequence[str]) -> Iterator[Issue]:
    """Issues of a contour that is not that of one body, which nothing but its own conditions holds."""
    surface, path = zone.surface, ("contact_zones", name)
    bodies = sorted({edge.partition(SEPARATOR)[0] for edge in zone.edges or ()})
    if not isinstance(surface, DeflectedContour) or not {*(zone.edges or ())} <= {*edges}:
        return
    if len(bodies) > 1:
        message = f"a deflected contour is that of one body, and these edges are of {', '.join(bodies)}; make two zones"
        yield Issue(path=(*path, "edges"), message=message)
        return
    (body,) = bodies
    for bond in problem.bonded:
        if body in (both := problem.sides_of(bond)):
            other = both[both[0] == body]
            message = (
                f"'{body}' is bonded to '{other}', and a deflected contour is that of a body by itself; give points "
                "of the surface as a spline instead"
            )
            yield Issue(path=(*path, "surface"), message=message)
    for edge in surface.conditions:
        if edge not in edges:
            message = unknown_edge(edge, edges)
        elif edge.partition(SEPARATOR)[0] != body:
            message = f"'{edge}' is not an edge of '{body}', whose contour this is; remove its condition"
        else:
            continue
        yield KeyIssue(path=(*path, "surface", "conditions", edge), message=message)


def _bond_issues(problem: StatedBodies) -> Iterator[Issue]:
    """Issues of bonded interfaces that name what does not exist, or what is in contact too."""
    touching = {entry for contact in problem.contacts.values() for side in contact.between for entry in side}
    touching |= {edge for zone in problem.contact_zones.values() for edge in zone.edges or ()}
    seen: set[str] = set()
    for name, between in problem.bonded.items():
        path: KeyPath = ("bonded", name)
        if name in problem.contacts or name in problem.contact_zones:
            yield KeyIssue(path=path, message=f"a contact has the name '{name}' already; give another name")
        sides = [issue for number in (0, 1) for issue in _side_issues(problem, between[number], path, number)]
        yield from sides
        if sides:
            continue
        yield from _pair_issues(problem, between, path)
        for number, side in enumerate(between):
            body = body_in(side)
            if not problem.is_elastic(body):
                message = f"'{body}' is rigid; hold the edges of the other body by a condition instead"
                yield Issue(path=(*path, number), message=message)
            for entry in side:
                if SEPARATOR not in entry:
                    message = f"name the edges of '{entry}' that are bonded, such as {entry}/EDGE"
                    yield Issue(path=(*path, number), message=message)
                elif entry in touching or entry in seen:
                    where = "in contact too" if entry in touching else "bonded twice"
                    yield Issue(
                        path=(*path, number), message=f"edge '{entry}' is {where}; leave it out of one of the two"
                    )
                seen.add(entry)


def _side_issues(problem: StatedBodies, side: Sequence[str], path: KeyPath, number: int) -> Iterator[Issue]:
    """Issues of one side of a contact."""
    bodies = {name.partition(SEPARATOR)[0] for name in side}
    if len(bodies) > 1:
        yield Issue(
            path=(*path, number), message=f"the edges of one side are of one body, found {', '.join(sorted(bodies))}"
        )
        return
    for i, entry in enumerate(side):
        here = (*path, number) if len(side) == 1 else (*path, number, i)
        body, separator, edge = entry.partition(SEPARATOR)
        if body not in problem.bodies:
            spaced = not separator and [name for name in problem.bodies if entry.startswith(f"{name} ")]
            message = unknown_word("body", body, problem.bodies)
            if spaced and (its := entry.removeprefix(spaced[0]).strip()) in _own_edges(problem, spaced[0]):
                message = f"an edge of a body is BODY/EDGE: write '{qualified(spaced[0], its)}' for '{entry}'"
            yield Issue(path=here, message=message)
            return
        own = _own_edges(problem, body)
        if separator and edge not in own:
            yield Issue(path=here, message=unknown_word("edge", entry, [qualified(body, name) for name in own]))
        elif not separator and len(side) > 1:
            yield Issue(
                path=here, message=f"'{entry}' is a whole body; leave the edges of this side out, or name its edges"
            )
        elif separator and edge in problem.bodies[body].conditions:
            what = "be bonded" if path[0] == "bonded" else "touch"
            message = f"edge '{entry}' has a condition and cannot {what}; remove one of the two"
            yield Issue(path=here, message=message)


def _own_edges(problem: StatedBodies, body: str) -> list[str]:
    """Names that the edges of a body have in it."""
    return [edge.name for edge in problem.boundary_of(body).edges]


def _pair_issues(problem: StatedBodies, between: tuple[Sequence[str], Sequence[str]], path: KeyPath) -> Iterator[Issue]:
    """Issues of the two sides of a contact together."""
    first, second = map(body_in, between)
    if not any(map(problem.is_elastic, (first, second))):
        yield Issue(path=path, message=f"'{first}' and '{second}' are both rigid; one of them has to be elastic")
    if both := {*between[0]} & {*between[1]}:
        yield Issue(path=path, message=f"'{min(both)}' is on both sides; contact is between two of them")
    elif first == second and (between[0] == (first,) or between[1] == (second,)):
        yield Issue(path=path, message=f"name the edges of '{first}' on both sides that may touch each other")


def _case_issues(problem: StatedBodies, edges: Sequence[str]) -> Iterator[Issue]:
    """Issues of load cases that name what does not exist."""
    elastic = [part.name for part in problem.parts]
    for name, case in problem.load_cases.items():
        if case.loads != Loads():
            message = f"with several bodies loads belong to each of them: load_cases.{name}.bodies.NAME"
            yield KeyIssue(path=("load_cases", name, "loads"), message=message)
        for body in case.bodies:
            if body not in elastic:
                message = unknown_word("elastic body", body, elastic)
                yield KeyIssue(path=("load_cases", name, "bodies", body), message=message)
        for edge in case.conditions:
            if edge not in edges:
                message = unknown_edge(edge, edges)
                yield KeyIssue(path=("load_cases", name, "conditions", edge), message=message)


def _tool_issues(problem: StatedBodies, tools: Mapping[str, RigidTool]) -> Iterator[Issue]:
    """Issues of tools that would move an elastic body."""
    for name, tool in tools.items():
        for zone in tool.zones:
            if zone in problem.contacts and all(
                problem.is_elastic(body)
                for body in map(body_in, problem.contacts[zone].between)
                if body in problem.bodies
            ):
                message = (
                    f"'{zone}' is a contact of two elastic bodies, and a tool is rigid; move a body by a condition"
                )
                yield Issue(path=("tools", name, "zones"), message=message)


def opposite_issues(problem: StatedBodies) -> Iterator[Issue]:
    """Issues of contacts whose two sides cannot meet, and of meshes that would follow each other in a circle."""
    follows: dict[str, set[str]] = {}
    pairs: dict[frozenset[str], str] = {}
    for name, zone in problem.bonds.items():
        for part in problem.opposite(name):
            follows.setdefault(zone.surface.edges[part.onto].name, set()).add(part.edge)
        away = _distance(problem, name)
        if away is None or away > COINCIDE * problem.size:
            sides = " and ".join(", ".join(side) for side in problem.bonded[name])
            far = "nowhere opposite to each other" if away is None else f"{away:.3g} apart"
            yield Issue(
                path=("bonded", name), message=f"{sides} are {far}; bonded edges coincide: correct their points"
            )
    for name, contact in problem.contacts.items():
        path: KeyPath = ("contacts", name, "between")
        surface, edges = problem.zones[name].surface, problem.edges_of(name)
        if not edges:
            yield Issue(path=path, message="no edge of the first side is turned to the second one and can see it")
        elif isinstance(surface, BodySurface):
            parts = problem.opposite(name)
            if not parts:
                sides = " and ".join(", ".join(side) for side in contact.between)
                message = f"{sides} are nowhere opposite to each other; look at their places and normals"
                yield Issue(path=path, message=message)
            again = False
            for pair in {frozenset((part.edge, surface.edges[part.onto].name)) for part in parts}:
                if (other := pairs.setdefault(pair, name)) != name:
                    again = True
                    message = f"contact of {' and '.join(sorted(pair))} is stated by '{other}' already; remove one"
                    yield Issue(path=path, message=message)
            if again or not surface.elastic:
                continue
            for part in parts:
                follows.setdefault(surface.edges[part.onto].name, set()).add(part.edge)
    if circle := _circle(follows):
        names = ", ".join(f"'{name}'" for name in circle)
        message = f"the meshes of {names} would follow each other in a circle; exchange the sides of one contact"
        yield Issue(path=("contacts",), message=message)


def _distance(problem: StatedBodies, bond: str) -> float | None:
    """Largest distance [L] of bonded edges where they are opposite to each other; None if they are nowhere."""
    surface, away = problem.bonds[bond].surface, list[float]()
    for part in problem.opposite(bond):
        places = problem.edge(part.edge).points(np.linspace(part.low, part.high, SAMPLES))
        away.append(float(np.abs(surface.feet(places).gap).max()))
    return max(away, default=None)


def closed_form_issues(problem: StatedBodies, references: Mapping[str, Reference]) -> Iterator[Issue]:
    """Issues of closed forms of one elastic body that are stated for contact of two, and of pins that are none."""
    for name, reference in references.items():
        zones = [*problem.zones] if reference.zone is None else [reference.zone]
        pairs = [parts for parts in map(problem.touching_parts, zones) if len(parts) > 1]
        if isinstance(reference, FlatPunch | ShrinkFit | Crack | ProppedBeam) and pairs:
            both = " and ".join(f"'{part.name}'" for part in pairs[0])
            message = (
                f"{reference.kind} is a closed form of one elastic body, and {both} are both elastic; state hertz, "
                "pin_in_hole, uniform, values or table, or the zone of a rigid surface"
            )
            yield Issue(path=("reference", name, "kind"), message=message)
        if isinstance(reference, PinInHole) and not pin_and_hole(problem, zones[0], reference):
            radius, clearance = exact(reference.radius), exact(reference.clearance)
            message = (
                f"'{zones[0]}' is no contact of a pin of radius {radius} with a hole that is wider by {clearance}; its "
                f"sides are {described_sides(problem, zones[0])}; correct radius and clearance, or name another zone"
            )
            yield Issue(path=("reference", name, "radius"), message=message)


def _circle(follows: dict[str, set[str]]) -> list[str]:
    """Edges of which each follows the next one, and the last one the first; empty if there are none."""
    left = {name: {*before} for name, before in follows.items()}
    while ready := [name for name, before in left.items() if not before & left.keys()]:
        for name in ready:
            del left[name]
    return sorted(left)
