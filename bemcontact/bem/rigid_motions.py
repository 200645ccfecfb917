"""Rigid motions of one body, those that no condition prevents, and their names."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from bemcontact.arrays import Array
from bemcontact.bem.boundary_values import BoundaryValues
from bemcontact.bem.contact_points import ContactPoints
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.unit_pressures import UnitPressures

HELD = 1e-9
"""Singular value, relative to one, below which the prescribed displacements do not hold a motion."""

UNSPRUNG = 1e-12
"""Stiffness in one direction, relative to that across it, that is round-off."""

SLIGHT = 1e-3
"""Component of a motion over all of it that does not name it."""
SIDEWAYS = 0.01
"""Component of a unit vector from which it is named."""

FAR = 3.0
"""Distance of a pole from the middle, over half the size of the body, from which points move nearly alike: their
motions differ by no more than a third from that of the middle."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RigidMotions:
    """k rigid motions u(x) = (a - c y', b + c x'), (x', y') = (x - center)/radius.

    Parameters
    ----------
    coefficients : (k, 3) a, b, c of each motion, free of unit
    center : (2,) point about which c turns [L]
    radius : [L]
    """

    coefficients: Array
    center: Array
    radius: float

    def __len__(self) -> int:
        """Return the number of motions."""
        return len(self.coefficients)

    def displacement(self, points: Array) -> Array:
        """Displacement (..., 2, k) of each motion at points (..., 2) [L]."""
        x = (points - self.center) / self.radius
        a, b, c = self.coefficients.T
        return np.stack([a - c * x[..., 1:], b + c * x[..., :1]], axis=-2)

    def along_normals(self, points: ContactPoints) -> Array:
        """R (n, k): the motions of contact points along the rigid normals."""
        return np.einsum("nx,nxk->nk", points.normals, self.displacement(points.mesh.nodes[points.node]))

    def gap_changes(self, pressures: UnitPressures, mesh: Mesh, points: int) -> Array:
        """R (n, k): the changes of all gaps by the motions of a body with this mesh."""
        changes = np.zeros((points, len(self)))
        moved = np.einsum("rx,rxk->rk", pressures.change, self.displacement(mesh.nodes[pressures.node]))
        np.add.at(changes, pressures.gap, moved)
        return changes

    def work(self, points: Array, forces: Array) -> Array:
        """Work (k,) of forces (..., 2) at points (..., 2) in each motion."""
        return np.tensordot(forces, self.displacement(points), axes=forces.ndim)

    def work_of(self, force: Array, moment: float, about: ArrayLike = (0.0, 0.0)) -> Array:
        """Work (k,) of a force (2,) and a moment about a point (2,), the origin if none is given, in each motion."""
        x, y = self.center - np.asarray(about)
        about_center = moment - (x * force[1] - y * force[0])
        return self.coefficients @ np.append(force, about_center / self.radius)

    def describe(self) -> tuple[str, ...]:
        """Describe each motion: its direction, or the point about which it turns."""
        return tuple(map(self.described, self.coefficients))

    def described(self, coefficients: Array, half: float | None = None) -> str:
        """Describe the motion with these coefficients (3,), which are not all zero; of a body with half this size [L].

        The size of the body is twice the radius if none is given.
        """
        a, b, c = np.where(abs(coefficients) > 1e-9 * abs(coefficients).max(), coefficients, 0.0)
        if c == 0:
            length = np.hypot(a, b)
            return f"translation along ({a / length:.4g}, {b / length:.4g})"
        pole = self.center + self.radius / c * np.array([-b, a])
        x, y = np.where(abs(pole) > 1e-5 * self.radius, pole, 0.0)  # the middle of the nodes depends on the mesh
        sense = "counterclockwise" if c > 0 else "clockwise"
        way = np.hypot(a, b)
        if way <= FAR * abs(c) * (1.0 if half is None else half / self.radius):
            return f"rotation {sense} about ({x:.4g}, {y:.4g})"
        return f"translation along ({a / way:.4g}, {b / way:.4g}) with a small {sense} turn"


def toward(direction: Array) -> str:
    """Say where a direction (2,) points in a picture, x to the right and y up: to one or two sides."""
    x, y = np.where(abs(direction) > SIDEWAYS * np.hypot(*direction), direction, 0.0)
    sides = ("to the right" if x > 0 else "to the left") if x else "", ("up" if y > 0 else "down") if y else ""
    return " and ".join(filter(None, sides))


def all_rigid_motions(mesh: Mesh) -> RigidMotions:
    """Both translations, and the rotation about the middle of the body."""
    return RigidMotions(coefficients=np.eye(3), center=mesh.center, radius=mesh.size / 2)


def free_rigid_motions(mesh: Mesh, held: BoundaryValues, radius: float | None = None) -> RigidMotions:
    """Find the rigid motions that move no prescribed displacement component and no spring; translations come first.

    The radius is that of the mesh if none is given.
    """
    every = all_rigid_motions(mesh) if radius is None else replace(all_rigid_motions(mesh), radius=radius)
    rows = np.vstack([every.displacement(mesh.nodes)[held.displacement_given], _stretched(every, mesh, held.stiffness)])
    values, vectors = short_svd(rows)
    free = values <= HELD * max(1.0, values[0])
    return RigidMotions(coefficients=echelon(vectors[free]), center=every.center, radius=every.radius)


def _stretched(motions: RigidMotions, mesh: Mesh, stiffness: Array) -> Array:
    """Displacement (r, k) along each direction in which a place has springs, however stiff they are."""
    places = stiffness.any(axis=(2, 3))
    if not places.any():
        return np.zeros((0, len(motions)))
    size, ways = np.linalg.eigh(stiffness[places])  # (q, 2), (q, 2, 2) with the directions in columns
    along = np.einsum("qxi,qxk->qik", ways, motions.displacement(mesh.nodes[mesh.elements[places]]))
    return along[size > UNSPRUNG * size[:, 1:]]


def echelon(basis: Array) -> Array:
    """Row echelon form of a basis (k, components), each row of unit length: translations along the axes come first.

    A component that is `SLIGHT` in all rows that are left is no pivot: division by it would lose digits. A ring that
    spins about its middle has such a translation, for the middle of its nodes is beside it.
    """
    rows = basis.copy()
    row = 0
    for column in range(basis.shape[1]):
        if row == len(rows):
            break
        parts = abs(rows[row:, column]) / np.linalg.norm(rows[row:], axis=1)
        pivot = row + int(parts.argmax())
        if parts.max() < SLIGHT:
            continue
        rows[[row, pivot]] = rows[[pivot, row]]
        rows[row] /= rows[row, column]
        others = np.arange(len(rows)) != row
        rows[others] -= np.outer(rows[others, column], rows[row])
        row += 1
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def short_svd(matrix: Array) -> tuple[Array, Array]:
    """Singular values (k,), zeros included, and right singular vectors (k, k) of a matrix (n, k)."""
    k = matrix.shape[1]
    if k == 0:
        return np.zeros(0), np.zeros((0, 0))
    return np.linalg.svd(np.vstack([matrix, np.zeros((k, k))]), full_matrices=False)[1:]
