"""Bonded interfaces: pairs of nodes of two elastic bodies that move together, and the tractions that hold them so.

Tractions act in both directions. They follow from loads, contact pressures and rigid motions by the condition that the
displacements of both nodes are equal, before anything else is known of contact: bodies that are bonded are one body.
"""

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from bemcontact.arrays import Array, IntArray
from bemcontact.bem.mesh import BoundaryValues, Mesh, MeshPart
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.problems.problem import Problem


@dataclass(frozen=True, kw_only=True, eq=False)
class BondedPoints:
    """Directions of pairs of nodes, b in all, along which they move together.

    Parameters
    ----------
    mesh : Mesh
    node, other : (b,) nodes of the first and the second body
    axis : (b,) 0 for x, 1 for y
    weights : (b,) tributary length of the first node [L]
    element, local, direction : (q,) the (element, local node) pairs of both bodies on which a unit traction acts
    factor : (q,) of it there: nodal forces of both bodies are equal and opposite
    """

    mesh: Mesh
    node: IntArray
    other: IntArray
    axis: IntArray
    weights: Array
    element: IntArray
    local: IntArray
    direction: IntArray
    factor: Array

    @classmethod
    def of(cls, problem: Problem, mesh: Mesh, values: BoundaryValues) -> Self:
        """List the pairs of all bonded interfaces; none along an axis along which conditions hold both nodes."""
        facing = [mesh.facing[name] for name in problem.bonded]
        elements = np.concatenate([np.flatnonzero(own >= 0) for own in facing] or [np.zeros(0, int)])
        across = np.concatenate([own[own >= 0] for own in facing] or [np.zeros(0, int)])
        first, local = mesh.elements[elements], np.tile(np.arange(3), (len(elements), 1))
        node, pair = np.unique(first, return_inverse=True)
        pair, share = pair.reshape(-1), np.repeat(np.arange(len(elements)), 3)
        own, opposite = (elements[share], local.ravel()), (across[share], 2 - local.ravel())
        lengths = [np.bincount(pair, mesh.tributary[at], len(node)).astype(float) for at in (own, opposite)]
        other = np.zeros(len(node), int)
        other[pair] = mesh.elements[opposite]
        held = values.displacement_given[node] & values.displacement_given[other]
        point, axis = np.nonzero(~held)
        number = np.full((len(node), 2), -1)
        number[point, axis] = np.arange(len(point))
        ratio = lengths[0] / lengths[1]
        shares = [
            (at[0][free], at[1][free], number[pair[free], side], factor[free])
            for side in (0, 1)
            for free in (number[pair, side] >= 0,)
            for at, factor in ((own, np.ones(len(pair))), (opposite, -ratio[pair]))
        ]
        element, at, direction, factor = (np.concatenate(part) for part in zip(*shares, strict=True))
        return cls(
            mesh=mesh, node=node[point], other=other[point], axis=axis, weights=lengths[0][point], element=element,
            local=at, direction=direction, factor=factor,
        )  # fmt: skip

    def __len__(self) -> int:
        """Return the number of directions."""
        return len(self.node)

    @property
    def tractions(self) -> Array:
        """Traction (q, 2) by a unit of it."""
        return self.factor[:, None] * np.eye(2)[self.axis[self.direction]]

    def added_to(self, pressures: UnitPressures, part: MeshPart, points: int) -> UnitPressures:
        """The unit pressures on the mesh of one body, then its unit tractions, with numbers behind those of points."""
        new = np.full(len(self.mesh.nodes), -1)
        new[part.nodes] = np.arange(len(part.mesh.nodes))
        inside = np.arange(len(self.mesh.elements))[part.elements]
        own = (self.element >= inside[0]) & (self.element <= inside[-1])
        number, column = np.unique(self.direction[own], return_inverse=True)
        each, sign = np.arange(len(self)), np.eye(2)[self.axis]
        node, gap = np.concatenate([self.node, self.other]), np.concatenate([each, each])
        change, seen = np.concatenate([sign, -sign]), new[node] >= 0
        return UnitPressures(
            number=np.append(pressures.number, points + number),
            element=np.append(pressures.element, self.element[own] - inside[0]),
            local=np.append(pressures.local, self.local[own]),
            pressure=np.append(pressures.pressure, len(pressures) + column),
            traction=np.concatenate([pressures.traction, self.tractions[own]]),
            node=np.append(pressures.node, new[node[seen]]),
            gap=np.append(pressures.gap, points + gap[seen]),
            change=np.concatenate([pressures.change, change[seen]]),
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
    compliance, displacement : (n + b, n + b), (n + b, s) with the bonded directions last
    changes : (n + b, k) by motions that would move bonded bodies apart
    forces : (n + b, k) work of unit pressures and unit tractions in these motions [L]
    load : (k, s) work of the loadings in these motions [p L]
    motions : (3 b', k) coefficients of these motions for all bodies
    points : number n of contact points
    """
    n, k = points, changes.shape[1]
    matrix = np.block([[compliance[n:, n:], changes[n:]], [forces[n:].T, np.zeros((k, k))]])
    right = np.block([[-compliance[n:, :n], -displacement[n:]], [-forces[:n].T, -load]])
    scale = np.abs(compliance[n:, n:]).max(initial=0.0) or 1.0
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
    if not len(apart) or not len(held):
        return held, held[:0]
    values, vectors = np.linalg.svd(np.vstack([apart, np.zeros((len(held), len(held)))]), full_matrices=False)[1:]
    together = values <= least * np.sqrt(len(apart))
    return vectors[together] @ held, vectors[~together] @ held
