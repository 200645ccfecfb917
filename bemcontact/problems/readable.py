"""What can be read of a wrong problem, so that a picture can show it."""

from collections.abc import Mapping
from typing import Any, TypeVar

from bemcontact.problems.bodies import BodyContact, BodySpec
from bemcontact.problems.body_checks import contact_issues, opposite_issues
from bemcontact.problems.boundary import Boundary
from bemcontact.problems.conditions import Condition, Loads
from bemcontact.problems.contact_zone import ContactZone, RigidTool
from bemcontact.problems.cross_checks import mesh_issues
from bemcontact.problems.key_path import RawValue
from bemcontact.problems.load_case import LoadCase
from bemcontact.problems.material import Material
from bemcontact.problems.problem import MeshDensity, Problem
from bemcontact.problems.quantities import with_numbers
from bemcontact.problems.rigid_surface import DeflectedContour
from bemcontact.problems.units import Units
from bemcontact.problems.validation import SpecModel

Part = TypeVar("Part", bound=SpecModel)

NO_MATTER = Material(young_modulus=1.0, poisson_ratio=0.0)
"""What bodies without a readable material are drawn with; no picture of a problem shows it."""


def readable_part(data: Any) -> Problem | None:
    """The parts of a problem that can be read, not checked against each other; None without a sound boundary.

    Parts that name unknown edges, zones or tools are left out, and contacts of bodies that are nowhere opposite to each
    other. Load cases are kept, but none acts if `case` is wrong.
    """
    raw = RawValue((), with_numbers(data)[0])
    if raw.below(Problem, "bodies").value:
        return _of_several(raw)
    boundary = raw.below(Problem, "boundary").read(Boundary)
    mesh = raw.below(Problem, "mesh").read(MeshDensity) or MeshDensity()
    if boundary is None or mesh_issues(boundary, (), mesh.refine):
        return None
    material, edges = raw.below(Problem, "material").read(Material), {edge.name for edge in boundary.edges}
    zones = _kept_zones(raw, edges, contours=material is not None)
    known: dict[str, Any] = {"material": material} if material else {}
    return Problem.model_construct(
        **known,
        **_actions(raw, edges, zones),
        boundary=boundary,
        conditions={name: it for name, it in _entries(raw, "conditions", Condition).items() if name in edges},
        loads=raw.below(Problem, "loads").read(Loads) or Loads(),
        contact_zones=zones,
        mesh=mesh,
    )


def _of_several(raw: RawValue) -> Problem | None:
    """The bodies with a sound boundary, and what joins them; None without an elastic one.

    A contact or a bond is kept if each of its sides is there, and they are opposite to each other.
    """
    mesh = raw.below(Problem, "mesh").read(MeshDensity) or MeshDensity()
    bodies = {item.name: body for item in raw.below(Problem, "bodies").named() if (body := _body(item)) is not None}
    bodies = {
        name: body
        for name, body in bodies.items()
        if (original := bodies.get(body.copy_of or name)) is not None
        and original.boundary is not None
        and not mesh_issues(original.boundary, (), mesh.refine)
    }
    given: dict[str, Any] = {"bodies": bodies, "mesh": mesh}
    alone = Problem.model_construct(**given)
    if not any(map(alone.is_elastic, bodies)):
        return None
    edges = {edge.name for edge in alone.edges}
    zones = _kept_zones(raw, edges, contours=False)
    joined: dict[str, Any] = {
        "contacts": {name: it for name, it in _entries(raw, "contacts", BodyContact).items() if name not in zones},
        "bonded": _bonds(raw),
    }
    for issues in (lambda problem: contact_issues(problem, {}), opposite_issues):
        wrong = {issue.path[:2] for issue in issues(Problem.model_construct(**given, **joined))}
        joined = {
            key: {name: it for name, it in its.items() if not {(key,), (key, name)} & wrong}
            for key, its in joined.items()
        }
    return Problem.model_construct(
        **given, **joined, **_actions(raw, edges, {**zones, **joined["contacts"]}), contact_zones=zones
    )


def _body(raw: RawValue) -> BodySpec | None:
    """What can be read of one of several bodies: its place, and its conditions; None without a sound boundary."""
    if raw.below(BodySpec, "copy_of").value is not None:
        keys = ("copy_of", "shift", "rotate", "about")
        stated = {key: value for key in keys if (value := raw.below(BodySpec, key).value) is not None}
        return RawValue(raw.path, stated).read(BodySpec)
    boundary = raw.below(BodySpec, "boundary").read(Boundary)
    if boundary is None:
        return None
    if raw.below(BodySpec, "rigid").value is True:
        return BodySpec.model_construct(rigid=True, boundary=boundary)
    edges = {edge.name for edge in boundary.edges}
    conditions = {name: it for name, it in _entries(raw, "conditions", Condition, BodySpec).items() if name in edges}
    loads = raw.below(BodySpec, "loads").read(Loads) or Loads()
    return BodySpec.model_construct(material=NO_MATTER, boundary=boundary, conditions=conditions, loads=loads)


def _bonds(raw: RawValue) -> dict[str, Any]:
    """The bonds that can be read, by name: a bond has the two sides of a contact."""
    contacts = {
        item.name: RawValue(item.path, {"between": item.value}).read(BodyContact)
        for item in raw.below(Problem, "bonded").named()
    }
    return {name: contact.between for name, contact in contacts.items() if contact is not None}


def _kept_zones(raw: RawValue, edges: set[str], *, contours: bool) -> dict[str, ContactZone]:
    """The contact zones that can be read and name no other edges, with deflected contours or without."""
    return {
        name: zone
        for name, zone in _entries(raw, "contact_zones", ContactZone).items()
        if edges.issuperset(zone.edges or ()) and (contours or not isinstance(zone.surface, DeflectedContour))
    }


def _actions(raw: RawValue, edges: set[str], zones: Mapping[str, Any]) -> dict[str, Any]:
    """Name and units of a problem, and what acts on it: tools of these zones and load cases on these edges."""
    tools = {name: tool for name, tool in _entries(raw, "tools", RigidTool).items() if zones.keys() >= {*tool.zones}}
    cases = {
        name: case
        for name, case in _entries(raw, "load_cases", LoadCase).items()
        if edges >= case.conditions.keys() and tools.keys() >= case.tools.keys()
    }
    case = raw.below(Problem, "case").value
    return {
        "name": str(raw.below(Problem, "name").value or "problem"),
        "units": raw.below(Problem, "units").read(Units) or Units(),
        "tools": tools,
        "load_cases": cases,
        "case": case if isinstance(case, str) and case in cases else None,
    }


def _entries(raw: RawValue, key: str, model: type[Part], of: type[SpecModel] = Problem) -> dict[str, Part]:
    """The entries under a key of a problem, or of a part of it, that can be read, by name."""
    read = ((item.name, item.read(model)) for item in raw.below(of, key).named())
    return {name: part for name, part in read if part is not None}
