"""Checks of the parts of a problem against each other: names first, then the geometry."""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from math import degrees, radians
from typing import Any

import numpy as np

from bemcontact.errors import Issue, KeyPath
from bemcontact.problems.boundary import Boundary, far_issue, size_of_edges
from bemcontact.problems.conditions import Condition
from bemcontact.problems.contact_zone import TOOL_COMPONENTS, ContactZone, RigidTool, ToolAction
from bemcontact.problems.curves import Edge
from bemcontact.problems.geometry import MOST_ELEMENTS, Line
from bemcontact.problems.key_path import RawValue
from bemcontact.problems.load_case import LoadCase
from bemcontact.problems.outlines import MIRRORED
from bemcontact.problems.reference import Hertz, Table, Values
from bemcontact.problems.rigid_surface import Circle, DeflectedContour, Plane, RigidSurface, Shape
from bemcontact.problems.surface_lines import Polyline, Spline
from bemcontact.problems.validation import ALL, KeyIssue
from bemcontact.problems.visibility import turned_to, zone_edges
from bemcontact.problems.wording import unknown_word

LARGEST_TURNING = radians(60)
"""Largest angle by which a quadratic element may turn; beyond it the element deviates visibly from its arc."""

INTO_THE_BODY = "the normal of the rigid surface must point from the surface into the body"
SAMPLES = 128
"""Number of steps along an edge at which the direction of a surface is looked at."""
ALONG = 0.5
"""Cosine of the angle between two normals above which they point the same way."""
PIECE = 200
"""Number of points of an edge that are compared with a surface at the same time."""
PAIRS_KEPT = 64
"""Pairs of an edge and a surface of which the comparison is kept, for problems that have other loads."""


def edge_name_issues(boundary: RawValue, conditions: Iterable[RawValue], zones: RawValue) -> list[Issue]:
    """Issues of conditions and contact zones that name unknown edges, or the same edge.

    Conditions are those of the problem and of its load cases. A deflected contour does not touch anything, so its
    conditions may name the edges of a contact zone.
    """
    names = _edge_names(boundary)
    prescribed = [condition for group in conditions for condition in group.named()]
    issues: list[Issue] = []
    for condition in (*prescribed, *_conditions_of_contours(zones)):
        if names is not None and (name := condition.name) not in names:
            issues.append(KeyIssue(path=condition.path, message=unknown_word("edge", name, names)))
    zone_of: dict[str, str] = {}
    listed: set[tuple[str, str]] = set()
    for zone, member in _edges_of_zones(zones):
        name = member.value
        if names is not None and name not in names:
            issues.append(Issue(path=member.path, message=unknown_word("edge", name, names, "edges")))
        elif (zone, name) in listed:
            message = f"edge '{name}' occurs twice in the zone; list it once"
            issues.append(Issue(path=member.path, message=message))
        listed.add((zone, name))
        zone_of.setdefault(name, zone)
    for condition in prescribed:
        if (name := condition.name) in zone_of:
            message = f"edge '{name}' is in the contact zone '{zone_of[name]}' and can have no condition; remove one"
            issues.append(KeyIssue(path=condition.path, message=message))
    return issues


def _edge_names(boundary: RawValue) -> list[str] | None:
    """Names of all edges; None if one cannot be read, because no name is known to be wrong then."""
    loops = [boundary.below(Boundary, "outer"), *boundary.below(Boundary, "holes").each()]
    names = [edge.below(Line, "name").value for loop in loops for edge in loop.each()]
    readable = all(any(loop.each()) for loop in loops) and all(isinstance(name, str) for name in names)
    if readable and boundary.below(Boundary, "mirror").value is not None:
        names += [f"{name}{MIRRORED}" for name in names]
    return names if readable else None


def _edges_of_zones(zones: RawValue) -> Iterator[tuple[str, RawValue]]:
    """Edge names in all contact zones, each with the name of its zone."""
    for zone in zones.named():
        edges = zone.below(ContactZone, "edges")
        for member in [] if edges.value == ALL else _one_or_more(edges):
            if isinstance(member.value, str):
                yield zone.name, member


def _one_or_more(names: RawValue) -> Iterator[RawValue]:
    """Entries of a list of names; a name alone counts as a list of one."""
    return RawValue(names.path, [names.value]).each() if isinstance(names.value, str) else names.each()


def _conditions_of_contours(zones: RawValue) -> Iterator[RawValue]:
    """Conditions of all deflected contours."""
    for zone in zones.named():
        surface = zone.below(ContactZone, "surface")
        if surface.below(DeflectedContour, "kind").value == "deflected_contour":
            yield from surface.below(DeflectedContour, "conditions").named()


def tool_issues(tools: RawValue, zones: RawValue) -> Iterator[Issue]:
    """Issues of tools that name unknown contact zones, or the same zone."""
    names = [zone.name for zone in zones.named()]
    tool_of: dict[str, str] = {}
    for tool in tools.named():
        members = tool.below(RigidTool, "zones")
        for member in [members] if isinstance(members.value, str) else members.each():
            zone, name = member.value, tool.name
            if names and isinstance(zone, str) and zone not in names:
                yield Issue(path=member.path, message=unknown_word("contact zone", zone, names, "zones"))
            elif isinstance(zone, str) and tool_of.setdefault(zone, name) != name:
                message = f"zone '{zone}' already belongs to the tool '{tool_of[zone]}'; a surface moves with one tool"
                yield Issue(path=member.path, message=message)


def load_case_issues(cases: RawValue, combinations: RawValue, parts: Mapping[str, RawValue]) -> Iterator[Issue]:
    """Issues of load cases that contradict the "conditions" and "tools" of the problem, and of combinations."""
    conditions = {item.name: item.read(Condition) for item in parts["conditions"].named()}
    tools = {item.name: item.read(RigidTool) for item in parts["tools"].named()}
    for case in cases.named():
        for item in case.below(LoadCase, "conditions").named():
            name = item.name
            if name not in conditions or conditions[name] is not None:  # else the one of the problem is wrong
                yield from _condition_issues(item, conditions.get(name))
        for item in case.below(LoadCase, "tools").named():
            name = item.name
            if name not in tools:
                yield KeyIssue(path=item.path, message=unknown_word("tool", name, tools))
            elif (tool := tools[name]) is not None:
                yield from _action_issues(item, tool)
    names = [case.name for case in cases.named()]
    for combination in combinations.named():
        if (name := combination.name) in names:
            message = f"a load case has the name '{name}' already; give the combination another name"
            yield KeyIssue(path=combination.path, message=message)
        for factor in combination.named():
            if (name := factor.name) not in names:
                yield KeyIssue(path=factor.path, message=unknown_word("load case", name, names))


def _condition_issues(item: RawValue, base: Condition | None) -> Iterator[Issue]:
    """Issues of a condition of a load case that would change the supports of the body."""
    condition = item.read(Condition)
    if condition is None:
        return
    if condition.spring is not None:
        message = "a load case cannot add springs; put them into the conditions of the problem"
        yield Issue(path=(*item.path, "spring"), message=message)
    held = base.displacement.given if base else ()
    for axis in condition.displacement.given:
        if axis not in held:
            message = (
                f"a load case cannot hold an edge that the problem leaves free along {axis}; add the displacement 0 "
                f"along {axis} to the conditions of the problem"
            )
            yield Issue(path=(*item.path, "displacement", axis), message=message)
    axes = ("x", "y") if condition.pressure is not None else condition.traction.given
    for axis in sorted({*axes} & {*held}):
        key = ("pressure",) if condition.pressure is not None else ("traction", axis)
        message = f"the problem prescribes the displacement of this edge along {axis}; remove one of the two"
        yield Issue(path=(*item.path, *key), message=message)


def _action_issues(item: RawValue, tool: RigidTool) -> Iterator[Issue]:
    """Issues of an action of a load case that would change how the tool is guided."""
    action = item.read(ToolAction)
    if action is None:
        return
    for (move, force, where), free, moved, loaded in zip(
        TOOL_COMPONENTS, tool.free, action.displaced, action.free, strict=True
    ):
        if moved and free:
            name = "moment" if force == "moment" else "force"
            message = f"the tool is free {where}, because the problem loads it there; give a {name}"
            yield Issue(path=(*item.path, "displacement", move), message=message)
        if loaded and not free:
            message = f"the tool is held {where}; add {force}: 0 to the force of this tool in the problem to free it"
            yield Issue(path=(*item.path, "force", force), message=message)
        if move == "rotation" and moved and tool.point is None:
            message = "a rotation needs a point; give the tool a point: [x, y]"
            yield Issue(path=(*item.path, "displacement", "rotation"), message=message)


def reference_issues(
    references: RawValue, zones: RawValue, cases: Sequence[str], *, several: bool = False
) -> list[Issue]:
    """Issues of references that name an unknown zone or load case, or no zone where there are several.

    `several` says that there are several bodies: the sum of contact forces then acts on none.
    """
    names = [zone.name for zone in zones.named()]
    issues = []
    for reference in references.named():
        zone, case = reference.below(Hertz, "zone"), reference.below(Hertz, "case")
        if isinstance(case.value, str) and case.value not in cases:
            issues.append(Issue(path=case.path, message=unknown_word("load case", case.value, cases)))
        if isinstance(zone.value, str) and names and zone.value not in names:
            issues.append(Issue(path=zone.path, message=unknown_word("contact zone", zone.value, names)))
        elif zone.value is None and len(names) > 1 and _needs_one_zone(reference, several):
            message = f"there are {len(names)} contact zones; give zone: {' or '.join(names)}"
            issues.append(Issue(path=reference.path, message=message))
    return issues


def _needs_one_zone(reference: RawValue, several: bool) -> bool:
    """Whether a reference is about a single contact zone."""
    kind, against = (reference.below(Table, key).value for key in ("kind", "against"))
    half_width, resultant = (reference.below(Values, key).value is not None for key in ("half_width", "resultant"))
    of_one = kind == "values" and (half_width or (resultant and several))
    return kind in ("hertz", "flat_punch", "pin_in_hole", "crack", "propped_beam") or against == "arc" or of_one


def mesh_issues(boundary: Boundary, path: KeyPath, refine: int) -> list[Issue]:
    """Issues of a mesh with too many elements for a dense matrix, or too few for its curves."""
    total = refine * sum(edge.elements or len(edge.ends_at) + 1 for edge in boundary.edges)
    if total > MOST_ELEMENTS:
        at_least = "" if boundary.meshed else "at least "  # an edge without elements gets one or more
        message = f"{at_least}{total} elements are too many for a dense matrix; take at most {MOST_ELEMENTS}"
        return [Issue(path=("mesh", "refine") if refine > 1 else path, message=message)]
    return [
        Issue(path=(*path, *loop_path, i, "elements"), message=_too_few_elements(edge, refine))
        for loop_path, loop in zip(boundary.loop_paths, boundary.loops, strict=True)
        for i, edge in enumerate(loop)
        if edge.elements is not None and edge.turning(refine) > LARGEST_TURNING * (1 + 1e-9)
    ]


def _too_few_elements(edge: Edge, refine: int) -> str:
    """Say by how much one element turns, and how many elements are enough."""
    turning, limit = f"{degrees(edge.turning(refine)):.0f}", f"{degrees(LARGEST_TURNING):.0f}"
    start = f"'{edge.name}' has too few elements: one of them turns by {turning} degrees, more than {limit}"
    stated = edge.elements or 1
    for elements in range(stated + 1, stated + 200):
        if replace(edge, elements=elements).turning(refine) <= LARGEST_TURNING * (1 + 1e-9):
            return f"{start}; give it {elements} elements or more"
    return f"{start}; give it more elements, and grade them towards the bend"


def facing_issues(
    boundary: Sequence[Edge], zones: Mapping[KeyPath, ContactZone], prescribed: Collection[str]
) -> list[Issue]:
    """Issues of rigid surfaces that are too far away or too wide, or whose normal points out of the body there.

    The direction of a deflected contour must not point out of the body at any point of the zone. `prescribed` names
    the edges with conditions.
    """
    edges, size = {edge.name: edge for edge in boundary}, size_of_edges(boundary)
    issues = []
    for path, zone in zones.items():
        members = [edges[name] for name in zone_edges(boundary, zone, prescribed)]
        if far := far_issue((*path, "surface"), [*_lengths(zone.surface)], size):
            issues.append(far)
            continue
        if not members:
            issues.append(Issue(path=(*path, "surface"), message=_nothing_sees(boundary, zone)))
            continue
        if isinstance(zone.surface, DeflectedContour):
            cosine, name = max((_outward(edge, zone.surface), edge.name) for edge in members)
        else:
            shape: Any = zone.surface  # frozen, and so a key
            _, cosine, name = min((*_facing(edge, shape), edge.name) for edge in members)
        if cosine > ALONG:
            issues.append(Issue(path=(*path, "surface"), message=_faces_away(name, zone.surface)))
        elif not any(_turned(edge, zone.surface) for edge in members):
            names = ", ".join(f"'{edge.name}'" for edge in members)
            message = f"{INTO_THE_BODY}, but no place of {names} is turned to it; look at the direction of the surface"
            issues.append(Issue(path=(*path, "surface"), message=message))
    return issues or [*_unseen(boundary, zones, prescribed)]


def _unseen(
    boundary: Sequence[Edge], zones: Mapping[KeyPath, ContactZone], prescribed: Collection[str]
) -> Iterator[Issue]:
    """Issues of surfaces that no edge can touch, and of edges of several zones that turn their backs to one of them."""
    touching = {path: zone_edges(boundary, zone, prescribed) for path, zone in zones.items()}
    count = Counter(name for names in touching.values() for name in names)
    edges = {edge.name: edge for edge in boundary}
    for number, (path, zone) in enumerate(zones.items()):
        for other, its in list(zones.items())[:number]:
            both = {*touching[path]} & {*touching[other]}
            if both and its.surface.model_dump() == zone.surface.model_dump():
                message = (
                    f"the zone '{other[-1]}' has the same surface, and edge '{min(both)}' may touch it there; name "
                    "this edge in one of the two zones"
                )
                yield Issue(path=(*path, "surface"), message=message)
        for i, name in enumerate(zone.edges or ()):
            if count[name] > 1 and not _turned(edges[name], zone.surface):
                message = (
                    f"edge '{name}' is in {count[name]} zones and cannot touch the surface of this one, to which it is "
                    "turned nowhere; remove it from the list"
                )
                yield Issue(path=(*path, "edges", i), message=message)


def _nothing_sees(boundary: Sequence[Edge], zone: ContactZone) -> str:
    """Say why no edge can touch a surface."""
    seeing = zone_edges(boundary, zone, ())
    if not seeing:
        return "no edge of the body is turned to this surface and can see it; look at its position and its direction"
    names = ", ".join(f"'{name}'" for name in seeing)
    return f"only {names} can see this surface, with a condition, and an edge with a condition cannot touch; remove it"


def _turned(edge: Edge, surface: RigidSurface) -> bool:
    """Whether some place of an edge is turned to a surface."""
    if not isinstance(surface, DeflectedContour):
        shape: Any = surface  # frozen, and so a key
        return _turned_to_shape(edge, shape)
    fractions = np.linspace(0, 1, SAMPLES + 1)
    normals = np.tile(surface.unit_direction, (len(fractions), 1))
    return bool(turned_to(-edge.normals(fractions), normals).any())


@lru_cache(maxsize=PAIRS_KEPT)
def _turned_to_shape(edge: Edge, surface: Shape) -> bool:
    """Whether some place of an edge is turned to a surface that is drawn."""
    fractions = np.linspace(0, 1, SAMPLES + 1)
    normals = surface.closest(edge.points(fractions)).normals
    return bool(turned_to(-edge.normals(fractions), normals).any())


def _lengths(surface: RigidSurface) -> Iterator[float]:
    """Coordinates and radii of a surface."""
    match surface:
        case Plane():
            yield from surface.point
        case Circle():
            yield from (*surface.center, surface.radius)
        case Polyline() | Spline():
            for point in surface.points:
                yield from point
        case DeflectedContour():
            yield 0.0


@lru_cache(maxsize=PAIRS_KEPT)
def _facing(edge: Edge, surface: Shape) -> tuple[float, float]:
    """Least distance between edge and surface, and there the cosine between outward normal and surface normal."""
    fractions = np.linspace(0, 1, SAMPLES + 1)
    pieces = [surface.closest(piece) for piece in np.array_split(edge.points(fractions), 1 + len(fractions) // PIECE)]
    gap, normals = (np.concatenate(parts) for parts in zip(*pieces, strict=True))
    cosine = np.einsum("ki,ki->k", normals, edge.normals(fractions))
    closest = np.argmin(np.abs(gap))
    return float(np.abs(gap[closest])), float(cosine[closest])


def _outward(edge: Edge, surface: DeflectedContour) -> float:
    """Largest cosine between an outward normal of the edge and the direction of the contour."""
    return float((edge.normals(np.linspace(0, 1, SAMPLES + 1)) @ surface.unit_direction).max())


def _faces_away(edge: str, surface: RigidSurface) -> str:
    """Say that the surface faces away from the body, and how to turn it."""
    match surface:
        case Plane():
            x, y = surface.normal
            remedy = f"reverse the normal: [{0 - x:g}, {0 - y:g}]"
        case Circle():
            outside = surface.body == "outside"
            where, other = ("beyond this edge", "inside") if outside else ("on the side of the body", "outside")
            remedy = f"with body: {surface.body} the center lies {where}: move it, or is the body {other} the circle?"
        case Polyline() | Spline():
            remedy = "list its points in the opposite order, so that the body is on their left"
        case DeflectedContour():
            x, y = surface.direction
            remedy = f"reverse the direction: [{0 - x:g}, {0 - y:g}], or make the zone smaller"
    return f"{INTO_THE_BODY}, but at '{edge}' it points out of the body; {remedy}"
