"""Bonded interfaces: pairs of nodes of two elastic bodies that move together, and the tractions that hold them so.

Tractions act in both directions. They follow from loads, contact pressures and rigid motions by the condition that the
displacements of both nodes are equal, before anything else is known of contact: bodies that are bonded are one body.

At a corner of an interface, and where three bodies meet, tractions jump from face to face. There are more faces than
displacements that could tell their tractions. So each face has the traction of the middle node beside it, as contact
has at the begin of a bond, and what holds the nodes there together is added: the same on all faces of two bodies.

The spin of a body without friction is held in the same way. No pressure spins a disk. But common normals, which are
those of the stiffer side more than its own, miss its center by a little, and contact would have to hold this spin.
"""

from collections.abc import Iterator
from typing import NamedTuple, Self

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.bem.boundary_values import BoundaryValues
from bemcontact.bem.contact_points import SMOOTH
from bemcontact.bem.mesh import Mesh, MeshPart
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.frozen import frozen
from bemcontact.problems.problem import Problem


@frozen
class BondedPoints:
    """What does not move, b components in all: one node beside another along an axis, or a body that might spin.

    The spin of a body is its mean displacement around its center. What holds it is traction around this center,
    in proportion to the distance from it.

    Parameters
    ----------
    mesh : Mesh
    count : b
    element, local, component : (q,) the (element, local node) pairs on which a unit traction of each component acts
    tractions : (q, 2) by it there: nodal forces of two bodies are equal and opposite
    node, changed : (r,) nodes that move along with each component
    change : (r, 2) of it by their unit displacements along x and y, in proportion to the nodal forces
    """

    mesh: Mesh
    count: int
    element: IntArray
    local: IntArray
    component: IntArray
    tractions: Array
    node: IntArray
    changed: IntArray
    change: Array

    @classmethod
    def of(cls, problem: Problem, mesh: Mesh, values: BoundaryValues, tied: IntArray) -> Self:
        """List the components of all bonded interfaces, then those of all bodies that might spin.

        There is none along an axis along which conditions hold both nodes. `tied` (N,) is that of `ContactPoints`.
        """
        if not (problem.bonded or problem.spin_centers):
            return cls.none(mesh)
        element, across = bonded_elements(problem, mesh)
        nodes = np.stack([mesh.elements[element], mesh.elements[across, ::-1]], axis=-1)
        both, pair = np.unique(np.sort(nodes).reshape(-1, 2), axis=0, return_inverse=True)
        pair = pair.reshape(nodes.shape[:2])
        low = nodes[..., 0] == both[pair, 0]
        junction, by_others = _junctions(mesh, both, np.bincount(pair[low], minlength=len(both)), tied)
        face, at, local = junction[pair], np.repeat(element, 3), np.tile(np.arange(3), len(element))
        at, local = np.append(at, at[face.ravel()]), np.append(local, local[face.ravel()])
        low, pair = (np.append(np.where(face, of[:, [1]], of), of[face]) for of in (low, pair))
        own, other = (np.bincount(pair[of], mesh.tributary[at, local][of], len(both)) for of in (low, ~low))
        factor = np.where(low, 1.0, -np.divide(own, other, out=np.zeros(len(both)), where=other > 0)[pair])
        held = values.displacement_given[both].all(axis=1) | by_others[:, None]
        point, axis = np.nonzero(~held)
        number, count = np.full((len(both), 2), -1), len(point)
        number[point, axis] = np.arange(count)
        shares = [(at, local, number[pair, side], factor[:, None] * np.eye(2)[side]) for side in (0, 1)]
        each, sign = np.arange(count), np.eye(2)[axis]
        moves = [(both[point, 0], each, sign), (both[point, 1], each, -sign)]
        for traction, motion in _spins(problem, mesh):
            shares.append((*traction[:2], np.full(len(traction[0]), count), traction[2]))
            moves.append((motion[0], np.full(len(motion[0]), count), motion[1]))
            count += 1
        element, local, component, tractions = (np.concatenate(part) for part in zip(*shares, strict=True))
        free = component >= 0
        nodes, changed, change = (np.concatenate(part) for part in zip(*moves, strict=True))
        return cls(
            mesh=mesh, count=count, element=element[free], local=local[free],
            component=component[free], tractions=tractions[free], node=nodes, changed=changed, change=change,
        )  # fmt: skip

    @classmethod
    def none(cls, mesh: Mesh) -> Self:
        """No component, where no bodies are bonded and none might spin."""
        numbers, vectors = np.zeros(0, int), np.zeros((0, 2))
        return cls(
            mesh=mesh, count=0, element=numbers, local=numbers, component=numbers, tractions=vectors, node=numbers,
            changed=numbers, change=vectors,
        )  # fmt: skip

    def __len__(self) -> int:
        """Return the number of components."""
        return self.count

    def added_to(self, pressures: UnitPressures, part: MeshPart, points: int) -> UnitPressures:
        """The unit pressures on the mesh of one body, then its unit tractions, with numbers behind those of points."""
        new = np.full(len(self.mesh.nodes), -1)
        new[part.nodes] = np.arange(len(part.mesh.nodes))
        inside = np.arange(len(self.mesh.elements))[part.elements]
        own = (self.element >= inside[0]) & (self.element <= inside[-1])
        number, column = np.unique(self.component[own], return_inverse=True)
        seen = new[self.node] >= 0
        return UnitPressures(
            number=np.append(pressures.number, points + number),
            element=np.append(pressures.element, self.element[own] - inside[0]),
            local=np.append(pressures.local, self.local[own]),
            pressure=np.append(pressures.pressure, len(pressures) + column),
            traction=np.concatenate([pressures.traction, self.tractions[own]]),
            node=np.append(pressures.node, new[self.node[seen]]),
            gap=np.append(pressures.gap, points + self.changed[seen]),
            change=np.concatenate([pressures.change, self.change[seen]]),
        )


def bonded_elements(problem: Problem, mesh: Mesh) -> tuple[IntArray, IntArray]:
    """Elements (k,) of both sides of all bonds, and those across."""
    facing = [mesh.facing[name] for name in problem.bonded]
    own = np.concatenate([np.flatnonzero(across >= 0) for across in facing] or [np.zeros(0, int)])
    other = np.concatenate([across[across >= 0] for across in facing] or [np.zeros(0, int)])
    return np.append(own, other), np.append(other, own)


def _junctions(mesh: Mesh, both: IntArray, count: IntArray, tied: IntArray) -> tuple[BoolArray, BoolArray]:
    """Whether more faces of bonds meet at pairs (p, 2) of nodes than hold them together, and whether others hold one.

    `count` (p,) is the number of elements beside the first node of each.
    """
    turned = (count > 1) & (abs(mesh.turns[np.minimum(both[:, 0], len(mesh.elements) - 1)]) > SMOOTH)
    group, nodes = tied[both[:, 0]], np.unique(both)
    size, bonds = (np.bincount(tied[at], minlength=len(mesh.nodes)) for at in (nodes, both[:, 0]))
    junction, held_by = np.isin(group, group[turned | (bonds[group] >= size[group])]), np.arange(len(mesh.nodes))
    by_others = np.zeros(len(both), bool)
    for i in np.flatnonzero(junction).tolist():
        one, two = held_by[both[i]]
        by_others[i] = one == two
        held_by[held_by == two] = one
    return junction, by_others


def _spins(problem: Problem, mesh: Mesh) -> Iterator[tuple[tuple[IntArray, IntArray, Array], tuple[IntArray, Array]]]:
    """Traction around the center of each body that might spin, of which no force is left, and its motion.

    They are elements, local nodes and tractions (q, 2); nodes and their parts (r, 2) in the motion.
    """
    centers = problem.spin_centers
    for part, (on_mesh, elements, nodes) in zip(problem.parts, mesh.parts, strict=True):
        if (center := centers.get(part.name)) is not None:
            x, y = (on_mesh.nodes - center).T
            lengths = np.bincount(on_mesh.elements.ravel(), on_mesh.tributary.ravel())
            around = np.column_stack([-y, x]) / np.hypot(x, y).max()
            around -= np.average(around, axis=0, weights=lengths)
            own = np.arange(len(mesh.elements))[elements]
            element, local = np.repeat(own, 3), np.tile(np.arange(3), len(own))
            part_of_all = (lengths / lengths.sum())[:, None]
            yield (
                (element, local, around[on_mesh.elements].reshape(-1, 2)),
                (np.arange(len(mesh.nodes))[nodes], around * part_of_all),
            )


class Bond(NamedTuple):
    """What holds bonded bodies together, linear in contact pressures and loadings.

    Parameters
    ----------
    traction : (b, n), (b, s) tractions [p] by pressures [p], and by each loading
    motion : (3 b', n), (3 b', s) coefficients of rigid motions of all bodies, likewise
    """

    traction: tuple[Array, Array]
    motion: tuple[Array, Array]


def eliminate(
    compliance: Array, displacement: Array, changes: Array, forces: Array, load: Array, motions: Array, points: int
) -> tuple[Array, Array, Bond]:
    """Compliance (n, n) and free displacement (n, s) of contact points of bodies that are bonded, and the bond.

    Parameters
    ----------
    compliance, displacement : (n + b, n + b), (n + b, s) with the components of bonds last
    changes : (n + b, k) by motions that would move bonded bodies apart
    forces : (n + b, k) work of unit pressures and unit tractions in these motions [L]
    load : (k, s) work of the loadings in these motions [p L]
    motions : (3 b', k) coefficients of these motions for all bodies
    points : number n of contact points
    """
    n, k = points, changes.shape[1]
    matrix = np.block([[compliance[n:, n:], changes[n:]], [forces[n:].T, np.zeros((k, k))]])
    right = np.block([[-compliance[n:, :n], -displacement[n:]], [-forces[:n].T, -load]])
    scale = np.abs(compliance[n:]).max(initial=0.0) or 1.0
    rows = np.append(
        np.full(len(compliance) - n, 1 / scale), 1 / (np.abs(forces[n:]).max(axis=0, initial=0.0) + 1e-300)
    )
    columns = np.append(np.ones(len(compliance) - n), np.full(k, scale))
    solved = columns[:, None] * np.linalg.solve(rows[:, None] * matrix * columns, rows[:, None] * right)
    traction, amplitudes = solved[: len(compliance) - n], solved[len(compliance) - n :]
    whole = np.hstack([compliance[:n, :n], displacement[:n]])
    whole = whole + compliance[:n, n:] @ traction + changes[:n] @ amplitudes
    bond = Bond((traction[:, :n], traction[:, n:]), (motions @ amplitudes[:, :n], motions @ amplitudes[:, n:]))
    return whole[:, :n], whole[:, n:], bond


def split_motions(held: Array, apart: Array, least: float) -> tuple[Array, Array]:
    """Motions (k, …) that leave bonded bodies together, and those that do not, from what each changes there (b, k)."""
    if not len(held):
        return held, held
    values, vectors = np.linalg.svd(np.vstack([apart, np.zeros((len(held), len(held)))]), full_matrices=False)[1:]
    together = values <= least * np.sqrt(len(apart))
    return vectors[together] @ held, vectors[~together] @ held
