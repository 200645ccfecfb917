"""A problem on its mesh, before it is condensed: loadings, contact points, and the motions that contact holds."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from bemcontact.arrays import Array, BoolArray, indices
from bemcontact.bem.bonds import BondedPoints
from bemcontact.bem.contact_points import ContactPoints
from bemcontact.bem.free_motions import UNSEEN, FreeMotions, PlacedTools, steps_of_surfaces
from bemcontact.bem.loading import Loading, combined
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.outline import Outline
from bemcontact.bem.rigid_motions import RigidMotions
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.cached import cached_property
from bemcontact.contact.free_motions import MotionAlgebra
from bemcontact.contact.load_cases import BALANCED, Pinned
from bemcontact.frozen import frozen
from bemcontact.problems.bodies import Part
from bemcontact.problems.body_surface import BodyZone
from bemcontact.problems.material import Material
from bemcontact.problems.problem import Problem
from bemcontact.problems.visibility import zone_edges
from bemcontact.problems.way import Way

WEDGE = 0.02
"""Part of a rigid normal along which conditions leave a point free, up to which the point slides into a wedge."""
MANY = 3
"""Motions held at zero up to which each has a note of its own."""
ROUND_OFF = 1e-14
"""Normal displacement, over that of the motion, of a point that does not see it."""
OF_ALL_CASES = (
    "unit_pressures", "shear_moduli", "seen_ways", "pinned_motions", "pinned", "seen_motion", "seen_load",
    "with_bodies",
)  # fmt: skip
"""Properties of a body that do not depend on the load case that acts."""


@frozen
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

    def under(self, problem: Problem) -> "Body":
        """The body of a problem that differs in the load case that acts alone; what is found for all cases is kept."""
        body = replace(self, problem=problem)
        vars(body).update({name: value for name, value in vars(self).items() if name in OF_ALL_CASES})
        return body

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
        return self.problem.parts[self.mesh.part_of(element)].material

    @cached_property
    def free(self) -> FreeMotions:
        """All free motions of body and tools: those seen, then those unseen."""
        if not len(self.unseen):
            return self.seen
        return self.seen.with_coefficients(np.concatenate([self.seen.coefficients, self.unseen.coefficients]))

    @cached_property
    def seen_ways(self) -> Array:
        """Displacement (N, 2, k) of all nodes in each of the motions seen."""
        return self.seen.displacement(self.mesh)

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
        work = np.array([loading.true_work(self.mesh, motions) for loading in self.loadings]).T
        total = self.pinned.magnitude
        if self.tools.names:
            work += motions.tools.T @ self.tools.force
            x, y, moment = np.moveaxis(self.tools.force.reshape(-1, 3, len(self.loadings)), 1, 0)
            total = total + (np.hypot(x, y) + abs(moment) / self.pinned.length).sum(axis=0)
        return np.where(abs(work) > BALANCED * total, work, 0.0)

    @cached_property
    def spins(self) -> FreeMotions:
        """Rotations of bodies about their centers that no pressure drives."""
        centers = self.problem.spin_centers
        return self.seen.rotations([centers.get(part.name) for part in self.problem.parts])

    @cached_property
    def pinned_motions(self) -> FreeMotions:
        """The motions that nothing determines: those that change no gap, and spins."""
        if not (self.problem.spin_centers and len(self.spins)):
            return self.unseen
        return self.unseen.with_coefficients(np.concatenate([self.unseen.coefficients, self.spins.coefficients]))

    def without_motions(self, displacement: Array, *free: FreeMotions) -> Array:
        """Displacement (m, 3, 2) [L] of the boundary less its part in free motions, in least squares."""
        motions = np.concatenate([each.displacement(self.mesh)[self.mesh.elements] for each in free], axis=-1)
        if not motions.shape[-1]:
            return displacement
        root = np.sqrt(self.mesh.tributary)[..., None]
        columns = (root[..., None] * motions).reshape(-1, motions.shape[-1])
        return displacement - motions @ np.linalg.lstsq(columns, (root * displacement).ravel(), rcond=None)[0]

    @cached_property
    def pinned(self) -> Pinned:
        """These motions, with loads on the exact curves: the mesh does not affect their balance."""
        motions = self.pinned_motions.in_user_units()
        return Pinned(
            motions=tuple(f"{motions.who(j)} against the {motions.way(j)}" for j in range(len(motions))),
            turns=np.array([motions.turns(j) for j in range(len(motions))], bool),
            load=np.stack([item.true_work(self.mesh, motions) for item in self.loadings], axis=1)
            if len(motions)
            else np.zeros((0, len(self.loadings))),
            tools=motions.tools,
            magnitude=np.array([item.magnitude(self.mesh) for item in self.loadings]),
            length=motions.radius,
        )

    @cached_property
    def forces(self) -> Array:
        """Terms (3 t, 1 + c) of the forces on the tools, a column for each loading."""
        return self.tools.force * self.factors

    @cached_property
    def held_gaps(self) -> Array:
        """Gap (h,) [L] at each of `ContactPoints.held` under the loads that act; infinite beside a free tool."""
        held, mesh = self.points.held, self.mesh
        if held is None or not len(held.node):
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
        R = self.seen.gap_changes
        return np.where(abs(R) > ROUND_OFF, R, 0.0)

    @cached_property
    def seen_load(self) -> Array:
        """Work (k, 1 + c) of each loading in the seen motions, as of `motion_load`."""
        return self.motion_load(self.seen)

    @cached_property
    def with_bodies(self) -> BoolArray:
        """Whether an elastic body takes part in each of the seen motions (k,)."""
        return np.asarray(self.seen.of_bodies.any(axis=1))

    @property
    def algebra(self) -> MotionAlgebra:
        """The seen motions that elastic bodies take part in."""
        own = self.with_bodies
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

    @property
    def notes(self) -> tuple[str, ...]:
        """Decisions that a user should know."""
        ways, parts = self.pinned_motions.describe(), self.problem.parts
        at_zero = [f"the {way} moves no contact point and has no load: it is held at zero" for way in ways]
        if len(ways) > MANY:
            at_zero = [f"these move no contact point and have no load, and are held at zero: the {', the '.join(ways)}"]
        stated = dict.fromkeys(
            doubt
            for part in parts
            for doubt in self.problem.units.doubts(part.material.young_modulus, part.material.poisson_ratio)
        )
        return (
            *_left_out(self.problem),
            *_mixed_states(parts),
            *self._wedges(),
            *at_zero,
            *self.problem.units.misspelled(),
            *stated,
        )

    def _wedges(self) -> Iterator[str]:
        """Note contact points that conditions hold nearly along the rigid normal, and that slide into a wedge.

        Opposite to another elastic body pressure is bounded, for that one gives way.
        """
        points = self.points
        given = self.loadings[0].values.displacement_given[points.node]
        if not given.any():
            return
        free = np.where(given, 0.0, points.normals)
        part = np.hypot(*free.T)
        for i in indices((part < WEDGE) & (points.opposite.node < 0)).tolist():
            x, y = self.mesh.nodes[points.node[i]].tolist()
            zone = [*self.problem.zones][points.zone[i]]
            yield (
                f"({x:.5g}, {y:.5g}) is held nearly along the normal of the surface of '{zone}', but for "
                f"{np.degrees(np.arcsin(part[i])):.2g} degrees: it slides into a wedge, where pressure has no bound; "
                "hold it along the normal, or let the surface be level there and draw the body curved instead"
            )


def _mixed_states(parts: Sequence[Part]) -> Iterator[str]:
    """Note bodies in plane stress beside others in plane strain."""
    states: dict[str, list[str]] = {}
    for part in parts:
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
        if isinstance(zone, BodyZone) or zone.edges is not None:
            continue
        touching = problem.edges_of(name)
        others = [edge for edge in zone_edges(problem.edges, zone, ()) if edge not in touching]
        if others:
            names, it = ", ".join(f"'{edge}'" for edge in others), "it has" if len(others) == 1 else "they have"
            yield f"{names} can see the surface of '{name}' and may not touch it, because {it} a condition"
