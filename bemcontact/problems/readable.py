"""What can be read of a wrong problem, so that a picture can show it."""

from typing import Any, TypeVar

from bemcontact.problems.boundary import Boundary
from bemcontact.problems.conditions import Condition, Loads
from bemcontact.problems.contact_zone import ContactZone, RigidTool
from bemcontact.problems.cross_checks import mesh_issues
from bemcontact.problems.key_path import RawValue
from bemcontact.problems.load_case import LoadCase
from bemcontact.problems.material import Material
from bemcontact.problems.problem import MeshDensity, Problem
from bemcontact.problems.rigid_surface import DeflectedContour
from bemcontact.problems.units import Units
from bemcontact.problems.validation import SpecModel

Part = TypeVar("Part", bound=SpecModel)


def readable_part(data: Any) -> Problem | None:
    """The parts of a problem that can be read, not checked against each other; None without a sound boundary.

    Parts that name unknown edges, zones or tools are left out. Load cases are kept, but none acts if `case` is wrong.
    """
    raw = RawValue((), data)
    boundary = raw.below(Problem, "boundary").read(Boundary)
    mesh = raw.below(Problem, "mesh").read(MeshDensity) or MeshDensity()
    if boundary is None or mesh_issues(boundary, (), mesh.refine):
        return None
    material, edges = raw.below(Problem, "material").read(Material), {edge.name for edge in boundary.edges}
    zones = {
        name: zone
        for name, zone in _entries(raw, "contact_zones", ContactZone).items()
        if edges.issuperset(zone.edges or ()) and (material or not isinstance(zone.surface, DeflectedContour))
    }
    tools = {name: tool for name, tool in _entries(raw, "tools", RigidTool).items() if zones.keys() >= {*tool.zones}}
    cases = {
        name: case
        for name, case in _entries(raw, "load_cases", LoadCase).items()
        if edges >= case.conditions.keys() and tools.keys() >= case.tools.keys()
    }
    case = raw.below(Problem, "case").value
    known: dict[str, Any] = {"material": material} if material else {}
    return Problem.model_construct(
        **known,
        name=str(raw.below(Problem, "name").value or "problem"),
        units=raw.below(Problem, "units").read(Units) or Units(),
        boundary=boundary,
        conditions={name: it for name, it in _entries(raw, "conditions", Condition).items() if name in edges},
        loads=raw.below(Problem, "loads").read(Loads) or Loads(),
        contact_zones=zones,
        tools=tools,
        load_cases=cases,
        case=case if isinstance(case, str) and case in cases else None,
        mesh=mesh,
    )


def _entries(raw: RawValue, key: str, model: type[Part]) -> dict[str, Part]:
    """The entries under a key of a problem that can be read, by name."""
    read = ((item.name, item.read(model)) for item in raw.below(Problem, key).named())
    return {name: part for name, part in read if part is not None}
