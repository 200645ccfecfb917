"""Rigid motions of the body: which of them the conditions leave free, and how to say them in words."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bemcontact.arrays import Array, BoolArray
from bemcontact.bem.mesh import Mesh

HELD = 1e-9
"""Singular value, relative to one, below which a prescribed displacement does not hold a motion."""


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

    def work(self, points: Array, forces: Array) -> Array:
        """Work (k,) of forces (..., 2) at points (..., 2) in each motion."""
        return np.tensordot(forces, self.displacement(points), axes=forces.ndim)

    def work_of(self, force: Array, moment: float, about: ArrayLike = (0.0, 0.0)) -> Array:
        """Work (k,) of a force (2,) and a moment about a point (2,), the origin if none is given, in each motion."""
        x, y = self.center - np.asarray(about)
        about_center = moment - (x * force[1] - y * force[0])
        return self.coefficients @ np.append(force, about_center / self.radius)

    def describe(self) -> tuple[str, ...]:
        """Say each motion in words: its direction, or the point about which it turns."""
        return tuple(map(self.described, self.coefficients))

    def described(self, coefficients: Array) -> str:
        """Say the motion with such coefficients (3,), which are not all zero, in words."""
        a, b, c = np.where(abs(coefficients) > 1e-9 * abs(coefficients).max(), coefficients, 0.0)
        if c == 0:
            length = np.hypot(a, b)
            return f"translation along ({a / length:.4g}, {b / length:.4g})"
        pole = self.center + self.radius / c * np.array([-b, a])
        x, y = np.where(abs(pole) > 1e-9 * self.radius, pole, 0.0)
        sense = "anticlockwise" if c > 0 else "clockwise"
        return f"rotation {sense} about ({x:.4g}, {y:.4g})"


def all_rigid_motions(mesh: Mesh) -> RigidMotions:
    """Both translations, and the rotation about the middle of the body."""
    return RigidMotions(coefficients=np.eye(3), center=mesh.center, radius=mesh.size / 2)


def free_rigid_motions(mesh: Mesh, prescribed: BoolArray) -> RigidMotions:
    """Find the rigid motions that leave every prescribed displacement component at rest.

    Parameters
    ----------
    mesh : Mesh
    prescribed : (N, 2) whether the displacement of a node along an axis is prescribed

    Returns
    -------
    RigidMotions
        Translations first where there are any.
    """
    every = all_rigid_motions(mesh)
    rows = every.displacement(mesh.nodes)[prescribed]
    _, values, vectors = np.linalg.svd(np.vstack([rows, np.zeros((3, 3))]))
    free = values <= HELD * max(1.0, values[0])
    return RigidMotions(coefficients=echelon(vectors[free]), center=every.center, radius=every.radius)


def echelon(basis: Array) -> Array:
    """Row echelon form of a basis (k, components), each row of unit length: translations along the axes come first."""
    rows = basis.copy()
    row = 0
    for column in range(basis.shape[1]):
        if row == len(rows):
            break
        pivot = row + int(abs(rows[row:, column]).argmax())
        if abs(rows[pivot, column]) < 1e-9:
            continue
        rows[[row, pivot]] = rows[[pivot, row]]
        rows[row] /= rows[row, column]
        others = np.arange(len(rows)) != row
        rows[others] -= np.outer(rows[others, column], rows[row])
        row += 1
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)
