"""A problem on its mesh, before it is condensed: loadings, contact points, and the motions that contact holds."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bemcontact.arrays import Array, BoolArray, nonnegative_residual
from bemcontact.bem.bonds import BondedPoints
from bemcontact.bem.candidates import contact_points
from bemcontact.bem.contact_points import ContactPoints
from bemcontact.bem.free_motions import (
    BODY,
    UNSEEN,
    FreeMotions,
    PlacedTools,
    free_motions,
    placed_tools,
    steps_of_surfaces,
)
from bemcontact.bem.loading import Loading, case_loadings, combined, permanent_loading
from bemcontact.bem.mesh import Mesh, build
from bemcontact.bem.outline import Outline
from bemcontact.bem.rigid_motions import RigidMotions, free_rigid_motions, toward
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.checks.memory import ensure_memory
from bemcontact.contact.free_motions import MotionAlgebra
from bemcontact.contact.load_cases import BALANCED, Pinned
from bemcontact.errors import Issue, ProblemError
from bemcontact.problems.body_surface import BodySurface, BodyZone
from bemcontact.problems.curves import CircularArc
from bemcontact.problems.material import Material
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import Circle, DeflectedContour
from bemcontact.problems.visibility import zone_edges
from bemcontact.problems.way import Way

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
HELD_INSIDE = 1e-6
"""Depth over the size of a body up to which it is drawn as held in a surface: that of coordinates with six digits."""
MATRICES = 3
"""Number of full matrices of all degrees of freedom that are in memory at the same time."""
WEDGE = 0.02
"""Part of a rigid normal along which conditions leave a point free, up to which the point slides into a wedge."""
MANY = 3
"""Motions held at zero up to which each has a note of its own."""
ROUND_OFF = 1e-14
"""Normal displacement, over that of the motion, of a point that does not see it."""
IDLE = 1e-3
"""Least normal displacement, over that of the motion, of a motion that opens gaps. As a roller turns about nearly its
middle, gaps on a coarse mesh seem to open, by less."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """A problem on its mesh, before it is condensed: boundary values, contact points, rigid motions.

    Parameters
    ----------
    problem, mesh, points : the problem, its mesh and its contact points
    outline : the curves under the elements, as drawn
    loadings : 1 + c, the permanent loading, then the addition of each load case
    tools : rigid surfaces that move
    motions : of each elastic body, all rigid motions that the conditions leave free
    seen : motions of bodies and tools, and combinations, that move contact points along the rigid normals
    unseen : the other free motions, which change no gap
    bonds : nodes of bonded bodies, which seen and unseen motions leave together, and bodies that these do not spin
    apart : motions of elastic bodies that would not
    """

    problem: Problem
    mesh: Mesh
    outline: Outline
    points: ContactPoints
    loadings: tuple[Loading, ...]
    tools: PlacedTools
    motions: tuple[RigidMotions, ...]
    seen: FreeMotions
    unseen: FreeMotions
    bonds: BondedPoints
    apart: FreeMotions

    @cached_property
    def unit_pressures(self) -> tuple[UnitPressures, ...]:
        """Unit pressures of contact points and unit tractions of bonds on the mesh of each of the bodies."""
        if not len(self.bonds):
            return self.points.unit_pressures
        pairs = zip(self.points.unit_pressures, self.mesh.parts, strict=True)
        return tuple(self.bonds.added_to(own, part, len(self.points)) for own, part in pairs)

    def all_changes(self, motions: FreeMotions) -> Array:
        """Changes (n + b, k) of gaps and bonds by free motions."""
        count = len(self.points) + len(self.bonds)
        changes = np.zeros((count, len(motions)))
        for number, part in enumerate(self.mesh.parts):
            changes += motions.of_body(number).gap_changes(self.unit_pressures[number], part.mesh, count)
        return changes

    def all_work(self, motions: FreeMotions) -> Array:
        """Work (n + b, k) of unit pressures and unit tractions of bonds in free motions, over that amplitude [L]."""
        work = np.zeros((len(self.points) + len(self.bonds), len(motions)))
        for number, part in enumerate(self.mesh.parts):
            pressures, mesh = self.unit_pressures[number], part.mesh
            at = pressures.element, pressures.local
            moved = motions.of_body(number).displacement(mesh.nodes[mesh.elements[at]])
            forces = mesh.tributary[at][:, None] * pressures.traction
            np.add.at(work, pressures.number[pressures.pressure], np.einsum("qx,qxk->qk", forces, moved))
        return work

    @cached_property
    def shear_moduli(self) -> Array:
        """Shear modulus (m,) [p] of the body of each element."""
        moduli = [part.material.shear_modulus for part in self.problem.parts]
        return np.repeat(moduli, [len(part.mesh.elements) for part in self.mesh.parts])

    def material_at(self, node: int) -> Material:
        """Material of the elastic body with a node."""
        element = node if node < len(self.mesh.elements) else node - len(self.mesh.elements)
        return self.problem.parts[self.part_of(element)].material

    def part_of(self, element: int) -> int:
        """Number of the elastic body of an element."""
        return int(self.mesh.part[element]) if len(self.mesh.parts) > 1 else 0

    @cached_property
    def free(self) -> FreeMotions:
        """All free motions of body and tools: those seen, then those unseen."""
        return replace(self.seen, coefficients=np.vstack([self.seen.coefficients, self.unseen.coefficients]))

    @cached_property
    def factors(self) -> Array:
        """Factors of the loadings (1 + c,)."""
        named = self.problem.factors()
        return np.array([1.0, *(named.get(case, 0.0) for case in self.problem.load_cases)])

    @cached_property
    def acting(self) -> Loading:
        """The loading that acts on the body."""
        return combined(self.loadings, self.factors.tolist())

    def motion_load(self, motions: FreeMotions) -> Array:
        """Work (k, 1 + c) of each loading, forces on tools included, in free motions [p L]; zero where they balance.

        It is that on the exact curves: the mesh does not decide whether large loads balance.
        """
        on_body = np.column_stack([loading.true_work(self.mesh, motions) for loading in self.loadings])
        work = on_body + motions.tools.T @ self.tools.force
        unit = np.eye(len(self.loadings))
        total = [self.pinned.total(alone, self.tools.force * alone) for alone in unit]
        return np.where(abs(work) > BALANCED * np.array(total), work, 0.0)

    @cached_property
    def spins(self) -> FreeMotions:
        """Rotations of bodies about their centers that no pressure drives."""
        centers = self.problem.spin_centers
        return self.seen.rotations([centers.get(part.name) for part in self.problem.parts])

    @cached_property
    def pinned_motions(self) -> FreeMotions:
        """The motions that nothing determines: those that change no gap, and spins."""
        return replace(self.unseen, coefficients=np.vstack([self.unseen.coefficients, self.spins.coefficients]))

    @cached_property
    def pinned(self) -> Pinned:
        """These motions, with loads on the exact curves: the mesh does not affect their balance."""
        motions = self.pinned_motions.in_user_units()
        return Pinned(
            motions=tuple(f"{motions.who(j)} against the {motions.way(j)}" for j in range(len(motions))),
            turns=np.array([motions.turns(j) for j in range(len(motions))], bool),
            load=np.column_stack([item.true_work(self.mesh, motions) for item in self.loadings]),
            tools=motions.tools,
            magnitude=np.array([item.magnitude(self.mesh) for item in self.loadings]),
            length=motions.radius,
        )

    @cached_property
    def forces(self) -> Array:
        """Terms (3 t, 1 + c) of the forces on the tools, a column for each loading."""
        return self.tools.force * self.factors

    def normal_motion(self, motions: FreeMotions) -> Array:
        """R (n, k): change of the gaps in free motions."""
        changes = self.tools.motions @ motions.tools
        for number, part in enumerate(self.mesh.parts):
            pressures = self.points.unit_pressures[number]
            changes += motions.of_body(number).gap_changes(pressures, part.mesh, len(self.points))
        return changes

    @cached_property
    def held_gaps(self) -> Array:
        """Gap (h,) [L] at each of `ContactPoints.held` under the loads that act; infinite beside a free tool."""
        held, mesh = self.points.held, self.mesh
        if held is None:
            return np.zeros(0)
        position = self.tools.position @ self.factors
        places = mesh.nodes[held.node] - steps_of_surfaces(self.problem)[held.zone]
        gap = held.gap + np.sum(held.normals * self.acting.values.displacement[held.node], axis=1)
        for number, tool in enumerate(self.problem.tools.values()):
            own = np.isin(held.zone, [[*self.problem.zones].index(zone) for zone in tool.zones])
            x, y, turn = position[3 * number : 3 * number + 3].tolist()
            moved = Way(x, y, turn, tool.point or (0.0, 0.0)).motion_of(places)
            gap -= np.where(own, np.sum(held.normals * moved, axis=1), 0.0)
            gap[own & any(tool.free)] = np.inf
        return gap

    @cached_property
    def seen_motion(self) -> Array:
        """R (n, k): change of the gaps in the seen motions, without round-off."""
        R = self.normal_motion(self.seen)
        return np.where(abs(R) > ROUND_OFF, R, 0.0)

    @cached_property
    def seen_load(self) -> Array:
        """Work (k, 1 + c) of each loading in the seen motions, as of `motion_load`."""
        return self.motion_load(self.seen)

    @property
    def algebra(self) -> MotionAlgebra:
        """The seen motions that elastic bodies take part in."""
        own = np.any(self.seen.of_bodies, axis=1)
        return MotionAlgebra(
            rigid_motions=self.seen_motion[:, own], weights=self.points.tributary, motion_load=self.seen_load[own]
        )

    @cached_property
    def relative_load(self) -> tuple[Array, Array]:
        """R (n, k) without round-off, and the load (k,) that acts in the seen motions, relative to the largest."""
        R, load = self.seen_motion, self.seen_load @ self.factors
        largest = abs(load).max(initial=0.0)
        none = largest <= BALANCED * self.pinned.total(self.factors, self.forces)
        return np.where(abs(R) > UNSEEN, R, 0.0), np.zeros_like(load) if none else load / largest

    @cached_property
    def idle_motion(self) -> str | None:
        """A motion that opens gaps and closes none, and in which the loads do no work; None if there is none.

        Its amplitude is not determined. Among the motions a with R a >= 0 in which the loads do no work, it is the one
        nearest to Rᵀ1, which opens all gaps.
        """
        R, load = self.relative_load
        if not load.size or (load.size == 1 and load.any()):
            return None
        workless = np.linalg.svd(load[None, :])[2][1:].T if load.any() else np.eye(load.size)
        rates = R @ workless
        rates[abs(rates) <= UNSEEN] = 0.0
        part, opened = _opening(rates)
        return self.seen.combined((workless @ part)[:, None]).describe()[0] if opened.any() else None

    @property
    def notes(self) -> tuple[str, ...]:
        """Decisions that a user should know."""
        ways = self.pinned_motions.describe()
        at_zero = [f"the {way} moves no contact point and has no load: it is held at zero" for way in ways]
        if len(ways) > MANY:
            at_zero = [f"these move no contact point and have no load, and are held at zero: the {', the '.join(ways)}"]
        materials = [part.material for part in self.problem.parts]
        stated = dict.fromkeys(
            doubt
            for material in materials
            for doubt in self.problem.units.doubts(material.young_modulus, material.poisson_ratio)
        )
        return (*_left_out(self.problem), *_mixed_states(self.problem), *self._wedges(), *at_zero, *stated)

    def _wedges(self) -> Iterator[str]:
        """Note contact points that conditions hold nearly along the rigid normal, and that slide into a wedge.

        Opposite to another elastic body pressure is bounded, for that one gives way.
        """
        points = self.points
        free = np.where(self.loadings[0].values.displacement_given[points.node], 0.0, points.normals)
        part = np.hypot(*free.T)
        for i in np.flatnonzero((part < WEDGE) & (points.opposite.node < 0)).tolist():
            x, y = self.mesh.nodes[points.node[i]].tolist()
            zone = [*self.problem.zones][points.zone[i]]
            yield (
                f"({x:.5g}, {y:.5g}) is held nearly along the normal of the surface of '{zone}', but for "
                f"{np.degrees(np.arcsin(part[i])):.2g} degrees: it slides into a wedge, where pressure has no bound; "
                "hold it along the normal, or let the surface be level there and draw the body curved instead"
            )


def _ensure_before_surfaces(problem: Problem, mesh: Mesh) -> None:
    """Refuse a rigid surface that has the whole body behind it, except a hole that a disk is pressed into.

    A tool may be there before it is displaced.
    """
    with_tools = {zone for tool in problem.tools.values() for zone in tool.zones}
    for name, zone in problem.zones.items():
        if isinstance(zone.surface, DeflectedContour | BodySurface) or name in with_tools:
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


def _mixed_states(problem: Problem) -> Iterator[str]:
    """Note bodies in plane stress beside others in plane strain."""
    states: dict[str, list[str]] = {}
    for part in problem.parts:
        states.setdefault(part.material.state.replace("_", " "), []).append(f"'{part.name}'")
    if len(states) > 1:
        which = ", and ".join(f"{', '.join(names)} in {state}" for state, names in states.items())
        yield (
            f"two plane states are mixed: {which}; pressures and forces are per thickness, and all bodies count as "
            "equally thick, but those in plane stress are free to become thicker or thinner and those in plane strain "
            "are not; give bodies that are equally thick the same state"
        )


def _left_out(problem: Problem) -> Iterator[str]:
    """Note edges with conditions that can see the surface of a zone that names no edges."""
    for name, zone in problem.zones.items():
        touching = problem.edges_of(name)
        if isinstance(zone, BodyZone):
            continue
        others = [edge for edge in zone_edges(problem.edges, zone, ()) if edge not in touching]
        if others:
            names, it = ", ".join(f"'{edge}'" for edge in others), "it has" if len(others) == 1 else "they have"
            yield f"{names} can see the surface of '{name}' and may not touch it, because {it} a condition"


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


def each_case(body: Body) -> Iterator[Body]:
    """The body under each load case and combination where none of them acts yet; else nothing."""
    if body.problem.case is None:
        yield from (replace(body, problem=body.problem.with_case(name)) for name in body.problem.case_names)


def ensure_held(body: Body) -> None:
    """Refuse loads that contact cannot hold, with the `ProblemError` of `body_of`."""
    try:
        if violation := body.pinned.violation(body.factors, body.forces, body.problem.units.model_dump()):
            raise ProblemError(violation + _rest_in_bore(body))
        _ensure_room_where_held(body)
        _check_support(body)
    except ProblemError as error:
        case = body.problem.case
        if case is None:
            raise
        path = ("load_cases" if case in body.problem.load_cases else "combinations", case)
        raise ProblemError(Issue(path=path, message=str(error))) from None


def _rest_in_bore(body: Body) -> str:
    """Say where a round body has to be drawn in a round bore so that its load goes through the middle of the bore."""
    problem, unit = body.problem, replace(body.seen, coefficients=np.eye(body.seen.coefficients.shape[1]))
    bores = [zone.surface for zone in problem.zones.values()]
    rims = [problem.edge(name).curve for zone in problem.zones for name in problem.edges_of(zone)]
    if problem.several or problem.tools or not all(isinstance(it, Circle) and it.body == "inside" for it in bores):
        return ""
    middles = (
        {it.center for it in bores if isinstance(it, Circle)},
        {it.center for it in rims if isinstance(it, CircularArc)},
    )
    if not all(isinstance(it, CircularArc) for it in rims) or any(len(it) > 1 for it in middles):
        return ""
    (bore,), (rim,) = np.array(list(middles[0])), np.array(list(middles[1]))
    force = body.motion_load(unit)[:2] @ body.factors
    moment = body.motion_load(unit.rotations([tuple(rim.tolist())]))[0] @ body.factors
    if not force.any() or abs(moment) > BALANCED * problem.size * np.hypot(*force):
        return ""
    x, y = bore + np.hypot(*(rim - bore)) * force / np.hypot(*force) - rim
    return (
        f"; it slides around the bore until its load goes through the middle of the bore: draw it there, moved by "
        f"({x:.12g}, {y:.12g})"
    )


def _ensure_room_where_held(body: Body) -> None:
    """Refuse a surface that lies inside the body where conditions hold it: pressure there would have no bound."""
    held, problem = body.points.held, body.problem
    if held is None:
        return
    gap = body.held_gaps
    if (depth := -gap.min(initial=0.0)) > HELD_INSIDE * body.mesh.size:
        worst = int(gap.argmin())
        x, y = body.mesh.nodes[held.node[worst]]
        inside = f"{depth:.3g} {problem.units.length}".strip()
        message = (
            f"where conditions hold the body, at ({x:.5g}, {y:.5g}), this surface is {inside} inside it: no pressure "
            "makes room there; move the surface, or hold the body elsewhere, or end the contact edge before this place"
        )
        zone = [*problem.zones][held.zone[worst]]
        raise ProblemError(Issue(path=("contact_zones", zone, "surface"), message=message))


def _check_support(body: Body) -> None:
    """Refuse loads that no pressure p >= 0 can balance, and a body that no load presses on."""
    R, load = body.relative_load
    pull = nonnegative_residual(R.T, -load)
    if np.linalg.norm(pull) > BALANCED:
        raise ProblemError(_pull(body, body.seen.combined(pull[:, None])))
    unloaded = load.size and not load.any()
    if unloaded and (_may_leave(R) or (body.idle_motion is not None and not _may_be_squeezed(body))):
        raise ProblemError(
            f"contact holds {_against(body.seen)}, but no load presses it onto its support, so that its position "
            "is not determined; apply a load, or prescribe a displacement"
        )


def _may_be_squeezed(body: Body) -> bool:
    """Whether a load, a displacement, a tool or a surface inside the body is stated: what may press without a load."""
    values, particular = body.acting.values, body.acting.particular
    stated = any(part.any() for part in (values.displacement, values.traction, particular.displacement))
    return stated or bool(body.problem.tools) or bool(body.points.gap.min() < -UNSEEN * body.mesh.size)


def _may_leave(rates: Array) -> bool:
    """Whether motions with these changes (n, k) of gaps open all of them and close none."""
    while len(rates):
        opened = _opening(rates)[1]
        if not opened.any():
            return False
        rates = rates[~opened]  # enough of this motion makes up for what others close of these
    return True


def _opening(rates: Array) -> tuple[Array, BoolArray]:
    """The motion (k,) of those with rates (n, k) that closes no gap and is nearest to ratesᵀ1; which (n,) it opens.

    It is a residual of nonnegative least squares (Moreau).
    """
    part = nonnegative_residual(rates.T, -rates.sum(axis=0))
    part /= max(np.linalg.norm(part), UNSEEN)
    size = abs(part).max(initial=0.0)
    return part, (rates @ part > IDLE * size) & (size > UNSEEN)


def _pull(body: Body, pull: FreeMotions) -> str:
    """Say in which motion the loads pull the body or a tool off, and what to add against it."""
    who, way, direction = pull.who(0), pull.way(0), pull.direction(0)
    many = pull.several(0)
    off = "its support" if who == BODY else "what they touch" if many else "what it touches"
    load, against = "", "against this motion"
    if direction is not None:
        resultant = (body.motion_load(pull.along(0)) @ body.factors + 0.0).tolist()
        load, against = " of ({:.4g}, {:.4g})".format(*resultant), toward(-direction)
        load += f" {body.problem.units.line_force}".rstrip()
        way = f"{way}, {toward(direction)}"
    return (
        f"the load{load} pulls {who} off {off}: it drives the {way}, which nothing holds; add a load {against} that "
        f"presses {who} on, or turn the load around or move it, or prescribe a displacement that holds "
        f"{who if who == BODY else 'them' if many else 'it'}"
    )


def _against(motions: FreeMotions) -> str:
    """Describe who is free to move, and how: the body against one motion and another, and a tool against a third."""
    ways: dict[str, list[str]] = {}
    for j in range(len(motions)):
        ways.setdefault(motions.who(j), []).append(f"the {motions.way(j)}")
    return ", and ".join(f"{who} against {' and '.join(way)}" for who, way in ways.items())


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
