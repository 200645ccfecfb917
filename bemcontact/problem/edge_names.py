"""Names of edges: those that there are, and the conditions and contact zones that refer to them."""

from collections.abc import Iterable, Iterator

from bemcontact.errors import Complaint
from bemcontact.problem.boundary import Boundary
from bemcontact.problem.contact_zone import ContactZone
from bemcontact.problem.geometry import Line
from bemcontact.problem.partial import Written
from bemcontact.problem.rigid_surface import DeflectedContour
from bemcontact.problem.validation import KeyComplaint, unknown_word


def name_complaints(boundary: Written, conditions: Iterable[Written], zones: Written) -> list[Complaint]:
    """Check that conditions and contact zones refer to edges that there are, and share none.

    Where a contour is deflected nothing touches, so that the edges of a zone may have conditions there.

    Parameters
    ----------
    boundary, zones : these parts of a problem, right or wrong; what is unreadable in them is passed over
    conditions : those of the problem and of its load cases, likewise
    """
    names = _names(boundary)
    stated = [condition for some in conditions for condition in some.each()]
    complaints: list[Complaint] = []
    for condition in (*stated, *_conditions_of_contours(zones)):
        if names is not None and (name := str(condition.path[-1])) not in names:
            complaints.append(KeyComplaint(path=condition.path, message=unknown_word("edge", name, names)))
    zone_of: dict[str, str] = {}
    for zone, member in _members(zones):
        name = member.value
        if names is not None and name not in names:
            complaints.append(Complaint(path=member.path, message=unknown_word("edge", name, names)))
        elif name in zone_of:
            complaints.append(Complaint(path=member.path, message=_twice(name, zone_of[name], zone)))
        zone_of.setdefault(name, zone)
    for condition in stated:
        if (name := str(condition.path[-1])) in zone_of:
            message = f"edge '{name}' is in the contact zone '{zone_of[name]}' and can carry no condition; remove one"
            complaints.append(KeyComplaint(path=condition.path, message=message))
    return complaints


def _names(boundary: Written) -> list[str] | None:
    """Read the names of all edges; None if one cannot be read, so that no name can be called unknown."""
    loops = [boundary.below(Boundary, "outer"), *boundary.below(Boundary, "holes").each()]
    names = [edge.below(Line, "name").value for loop in loops for edge in loop.each()]
    readable = all(any(loop.each()) for loop in loops) and all(isinstance(name, str) for name in names)
    return names if readable else None


def _members(zones: Written) -> Iterator[tuple[str, Written]]:
    """List the edge names in each contact zone, with the name of the zone."""
    for zone in zones.each():
        edges = zone.below(ContactZone, "edges")
        if isinstance(edges.value, str):
            edges = Written(edges.path, [edges.value])
        for member in edges.each():
            if isinstance(member.value, str):
                yield str(zone.path[-1]), member


def _conditions_of_contours(zones: Written) -> Iterator[Written]:
    """List the conditions under which contours are deflected."""
    for zone in zones.each():
        surface = zone.below(ContactZone, "surface")
        if surface.below(DeflectedContour, "kind").value == "deflected_contour":
            yield from surface.below(DeflectedContour, "conditions").each()


def _twice(edge: str, first: str, second: str) -> str:
    if first == second:
        return f"edge '{edge}' is listed twice in the zone; list it once"
    return f"edge '{edge}' is in the contact zone '{first}' already; an edge can touch one surface only"
