"""A problem before it is solved: its mesh, its loads, and what holds the body."""

from collections.abc import Iterator, Mapping

import numpy as np

from bemcontact.adaptivity.mesh_sizes import first_mesh
from bemcontact.analysis.spline_bulges import bulging
from bemcontact.arrays import Array
from bemcontact.bem.body import Body
from bemcontact.bem.discretization import body_of, deflections
from bemcontact.bem.mesh import Mesh, build
from bemcontact.bem.support import each_case, ensure_held, idle_motion
from bemcontact.errors import ProblemError, SingularSystemError
from bemcontact.frozen import frozen
from bemcontact.problems import DeflectedContour, Problem
from bemcontact.problems.boundary import size_of_edges
from bemcontact.problems.nearest_places import nearest_places, surface_corners

BULGE = 1e-5
"""Bulge of a spline over the size of the body that is noted: displacements of stiff bodies are not much larger."""

INTERFERENCE = 0.01
"""Overlap of two bodies over the size of the smaller one that is noted: a strain that is hardly small."""


@frozen
class CheckedProblem:
    """A problem on its mesh, whose loads leave the body in place in each load case."""

    problem: Problem
    """The problem."""
    mesh: Mesh
    """Boundary elements."""
    gaps: dict[str, Array]
    """Initial gap of the contact points of each contact zone [L]."""
    smallest_gaps: dict[str, float]
    """Smallest initial gap of each contact zone, on the curves of its edges [L]."""
    free_motions: int
    """Number of rigid motions of all bodies that the conditions leave free."""
    held_by_bonds: int
    """Number of these that would move bonded bodies apart."""
    held_by_contact: tuple[str, ...]
    """Descriptions of the free motions of body and tools that contact holds."""
    total_load: tuple[float, float]
    """Resultant (x, y) of all loads on the body, without reactions, per thickness [p L]."""
    load_magnitude: float
    """Sum of the magnitudes of all loads [p L]."""
    notes: tuple[str, ...]
    """Notes on the problem and its mesh."""


def check(problem: Problem) -> CheckedProblem:
    """Mesh a problem and list what holds the body; `ProblemError` if the load of any case pulls it off its supports."""
    body = body_of(first_mesh(problem) if problem.adapts else problem)
    for acting in each_case(body):
        ensure_held(acting)
    x, y = body.acting.true_force
    smallest = {name: _smallest_gap(body, i) for i, name in enumerate(body.problem.zones)}
    return CheckedProblem(
        problem=body.problem,
        mesh=body.mesh,
        gaps={name: body.points.gap[body.points.zone == i] for i, name in enumerate(body.problem.zones)},
        smallest_gaps=smallest,
        free_motions=sum(map(len, body.motions)),
        held_by_bonds=len(body.apart) - len(body.spins),
        held_by_contact=tuple(body.seen.describe()),
        total_load=(float(x), float(y)),
        load_magnitude=float(body.pinned.total(body.factors, body.forces)),
        notes=(
            *body.notes,
            *_interference(body.problem, smallest),
            *_idle(body),
            *bulging(body, BULGE * body.problem.size),
        ),
    )


def _interference(problem: Problem, smallest_gaps: Mapping[str, float]) -> Iterator[str]:
    """Note contacts of bodies that are drawn far into each other."""
    for name, contact in problem.contacts.items():
        depth, both = -smallest_gaps[name], problem.sides_of(name)
        sizes = {body: size_of_edges(problem.boundary_of(body).edges) for body in both}
        smaller = min(both, key=sizes.__getitem__)
        if depth < INTERFERENCE * sizes[smaller]:
            continue
        how = f"with gap: {contact.gap:g}" if contact.gap else "as they are drawn"
        yield (
            f"'{both[0]}' and '{both[1]}' overlap by {depth:.3g} {problem.units.length}".rstrip()
            + f" in '{name}' {how}, {100 * depth / sizes[smaller]:.2g} % of the size of '{smaller}': this is an "
            "interference, which presses them apart, and far more than of a usual fit; if none is meant, move one of "
            "them" + ", or correct gap" * bool(contact.gap)
        )


def _idle(body: Body) -> Iterator[str]:
    """Note a motion that no load works in."""
    if (idle := idle_motion(body)) is not None:
        yield f"the loads do no work in the {idle}, which only opens gaps: it is not determined"


def _smallest_gap(body: Body, zone: int) -> float:
    """Smallest initial gap [L] of a zone at contact points and between them, on the curves of its elements."""
    problem, points, mesh = body.problem, body.points, body.mesh
    name, surface = [*problem.zones][zone], [*problem.zones.values()][zone].surface
    least = float(points.gap[points.zone == zone].min())
    if isinstance(surface, DeflectedContour):
        return least
    own = np.unique(points.element[points.zone_of_share == zone])
    for edge in map(problem.edge, problem.edges_of(name)):
        ends, first = mesh.ends_on(edge.name), np.argmax(mesh.edge == mesh.edge_names.index(edge.name))
        corners = (corner.fraction for corner in surface_corners(edge, surface))
        nearest = [*nearest_places(edge.curve, surface), *corners]
        if inside := [at for at in nearest if first + np.searchsorted(ends, at) - 1 in own]:
            least = float(surface.closest(edge.points(np.array(inside))).gap.min(initial=least))
    return least


def drawable(problem: Problem) -> tuple[Problem, Mesh]:
    """A problem that may be refused and its mesh, for a picture; without contours that cannot be computed."""
    problem = first_mesh(problem) if problem.adapts else problem
    mesh = build(problem)
    try:
        contours(problem, mesh)
    except (ProblemError, SingularSystemError):
        kept = {k: zone for k, zone in problem.zones.items() if not isinstance(zone.surface, DeflectedContour)}
        tools = {name: tool for name, tool in problem.tools.items() if kept.keys() >= {*tool.zones}}
        problem = problem.model_copy(update={"contact_zones": kept, "tools": tools, "load_cases": {}, "case": None})
    return problem, mesh


def contours(problem: Problem, mesh: Mesh) -> dict[str, tuple[Array, Array]]:
    """Deflected contours: zone -> points (N, 2) [L] of the surface opposite to all nodes, and unit normals (N, 2)."""
    surfaces = {}
    for name, displacement in deflections(problem, mesh).items():
        surface = problem.zones[name].surface
        assert isinstance(surface, DeflectedContour)
        gap, normals = surface.behind(displacement)
        surfaces[name] = mesh.nodes - gap[:, None] * normals, normals
    return surfaces
