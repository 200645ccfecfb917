"""From a problem to its body on a mesh: elements, loadings, contact points and free motions."""

from bemcontact.arrays import Array
from bemcontact.bem.body import Body
from bemcontact.bem.bonds import BondedPoints
from bemcontact.bem.candidates import contact_points
from bemcontact.bem.free_motions import BODY, free_motions, placed_tools
from bemcontact.bem.loading import case_loadings, permanent_loading
from bemcontact.bem.mesh import Mesh, build
from bemcontact.bem.outline import Outline
from bemcontact.bem.rigid_motions import free_rigid_motions
from bemcontact.bem.support import ensure_held
from bemcontact.checks.memory import ensure_memory
from bemcontact.errors import Issue, ProblemError
from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import Circle, DeflectedContour

TURNED = {
    "plane": "its normal points to the body",
    "circle": "the body is 'outside' or 'inside'",
    "polyline": "the body is on the left of its points",
    "spline": "the body is on the left of its points",
}
"""How each kind of surface is turned to the body."""

PRESSED_IN = 0.1
"""Interference over the size of a body up to which a disk is pressed into a hole, not drawn at a wrong place."""

BEHIND = 1e-9
"""Distance over the size of a body that is round-off, where the body lies behind a surface and touches it."""
FEW = 8
"""Number of nodes of which one is before a surface nearly always."""
MATRICES = 3
"""Number of full matrices of all degrees of freedom that are in memory at the same time."""


def _ensure_before_surfaces(problem: Problem, mesh: Mesh) -> None:
    """Refuse a rigid surface that has the whole body behind it, except a hole that a disk is pressed into.

    A tool may be there before it is displaced.
    """
    with_tools = {zone for tool in problem.tools.values() for zone in tool.zones}
    some = mesh.nodes[:: max(len(mesh.nodes) // FEW, 1)]
    for name, zone in problem.zones.items():
        if isinstance(zone.surface, DeflectedContour | BodySurface) or name in with_tools:
            continue
        if zone.surface.closest(some).gap.max() > BEHIND * mesh.size:
            continue
        gap = zone.surface.closest(mesh.nodes).gap
        pressed_in = isinstance(zone.surface, Circle) and -gap.min() < PRESSED_IN * mesh.size
        if gap.max() <= BEHIND * mesh.size and gap.min() < -BEHIND * mesh.size and not pressed_in:
            depth = f"{-gap.min():.3g} {problem.units.length}".strip()
            message = (
                f"the whole body lies behind this surface, up to {depth} deep; move the surface, or turn it to the "
                f"body: {TURNED[zone.surface.kind]}"
            )
            raise ProblemError(Issue(path=("contact_zones", name, "surface"), message=message))


def body_of(problem: Problem) -> Body:
    """Mesh a problem, spread its conditions over the mesh, and check whether contact can hold the body.

    `ProblemError` if the whole body is behind a surface; if the loads that act pull the body off its support, move it
    in a way that nothing holds, or do not press it on; or if the conditions of a deflected contour do not hold the
    body. A problem with load cases of which none acts is meshed without this check.
    """
    mesh = build(problem)
    outline = Outline(problem=problem, mesh=mesh)
    ensure_memory(MATRICES * 8 * mesh.degrees_of_freedom**2)
    _ensure_before_surfaces(problem, mesh)
    permanent, cases = permanent_loading(problem, mesh), case_loadings(problem, mesh)
    added = [loading.values for loading in cases]
    points = contact_points(outline, permanent.values, deflections(problem, mesh), added)
    tools = placed_tools(problem, points)
    motions = tuple(free_rigid_motions(part.mesh, permanent.values.of_part(part), mesh.size / 2) for part in mesh.parts)
    names = tuple(f"the body '{part.name}'" for part in problem.parts) if problem.several else (BODY,)
    bonds = BondedPoints.of(problem, mesh, permanent.values, points.tied)
    seen, unseen, apart = free_motions(points, motions, tools, names, bonds)
    body = Body(
        problem=problem, mesh=mesh, outline=outline, points=points, loadings=(permanent, *cases), tools=tools,
        motions=motions, seen=seen, unseen=unseen, bonds=bonds, apart=apart,
    )  # fmt: skip
    if problem.case is not None or not problem.load_cases:
        ensure_held(body)
    return body


def deflections(problem: Problem, mesh: Mesh) -> dict[str, Array]:
    """Displacement (N, 2) [L] of the nodes by contact zone, for each zone whose surface is a deflected contour.

    `ProblemError` if the conditions of a contour contradict each other, or leave the body free to move.
    """
    surfaces = {name: zone.surface for name, zone in problem.zones.items()}
    contours = {name: surface for name, surface in surfaces.items() if isinstance(surface, DeflectedContour)}
    if not contours:
        return {}
    from bemcontact.bem.deflected_contours import deflection

    return {name: deflection(problem, mesh, name, surface) for name, surface in contours.items()}
