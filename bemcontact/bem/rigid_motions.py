"""Rigid motions of one body, those that no condition prevents, and their names."""

from functools import partial
from itertools import compress
from math import hypot

import numpy as np
from numpy.typing import ArrayLike

from bemcontact.arrays import Array, BoolArray, row_norms, short_svd, successive
from bemcontact.bem.boundary_values import BoundaryValues
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.frozen import frozen

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


@frozen
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
        displacement = np.empty((*points.shape, len(self)))
        displacement[..., 0, :] = a - c * x[..., 1:]
        displacement[..., 1, :] = b + c * x[..., :1]
        return displacement

    def gap_changes(self, pressures: UnitPressures, mesh: Mesh, points: int) -> Array:
        """R (n, k): the changes of all gaps by the motions of a body with this mesh."""
        return self.unit_changes(pressures, mesh, points) @ self.coefficients.T

    def unit_changes(self, pressures: UnitPressures, mesh: Mesh, points: int) -> Array:
        """Changes (n, 3) of all gaps by the motions with a, b or c of one, the other two zero, of a body."""
        x, y = ((mesh.nodes[pressures.node] - self.center) / self.radius).T
        along_x, along_y = pressures.change.T
        moved = np.array([along_x, along_y, along_y * x - along_x * y]).T
        changes, at = np.zeros((points, 3)), successive(pressures.gap)
        if isinstance(at, slice):
            changes[at] = moved
        else:
            np.add.at(changes, at, moved)
        return changes

    def work_of(self, force: Array, moment: float, about: ArrayLike = (0.0, 0.0)) -> Array:
        """Work (k,) of a force (2,) and a moment about a point (2,), the origin if none is given, in each motion."""
        x, y = self.center - np.asarray(about)
        about_center = moment - (x * force[1] - y * force[0])
        return self.coefficients @ np.array([force[0], force[1], about_center / self.radius])

    def describe(self) -> tuple[str, ...]:
        """Describe each motion: its direction, or the point about which it turns."""
        return tuple(map(self.described, self.coefficients))

    def described(self, coefficients: Array, half: float | None = None) -> str:
        """Describe the motion with these coefficients (3,), which are not all zero; of a body with half this size [L].

        The size of the body is twice the radius if none is given.
        """
        stated = coefficients.tolist()
        least = 1e-9 * max(map(abs, stated))
        a, b, c = (part if abs(part) > least else 0.0 for part in stated)
        way = hypot(a, b)
        if c == 0:
            return f"translation along ({a / way:.4g}, {b / way:.4g})"
        x, y = self.center.tolist()
        pole = x - self.radius / c * b, y + self.radius / c * a
        least = 1e-5 * self.radius  # the middle of the nodes depends on the mesh
        x, y = (at if abs(at) > least else 0.0 for at in pole)
        sense = "counterclockwise" if c > 0 else "clockwise"
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
    center, radius = mesh.center, mesh.size / 2 if radius is None else radius
    free = _unheld(held.displacement_given, (mesh.nodes - center) / radius)
    motions_of = partial(RigidMotions, center=center, radius=radius)
    if held.stiffness.any():
        values, vectors = short_svd(_stretched(motions_of(coefficients=np.eye(3)), mesh, held.stiffness) @ free.T)
        free = vectors[values <= HELD * max([1.0, *values[:1]])] @ free
    return motions_of(coefficients=np.eye(3) if len(free) == 3 else echelon(free))


def _unheld(given: BoolArray, places: Array) -> Array:
    """Motions (k, 3) without the displacement components (N, 2) that are given at places (N, 2), over the radius.

    A body turns if all given components of x have one y, and those of y one x: about this place.
    """
    of_x, of_y = places[given[:, 0], 1], places[given[:, 1], 0]
    levers = (lever if len(lever) else np.zeros(1) for lever in (of_x, of_y))
    (bottom, top), (left, right) = ((float(lever.min()), float(lever.max())) for lever in levers)
    motions = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), ((bottom + top) / 2, -(left + right) / 2, 1.0)
    free = not len(of_x), not len(of_y), max(top - bottom, right - left) <= HELD
    return np.array([*compress(motions, free)]).reshape(-1, 3)


def _stretched(motions: RigidMotions, mesh: Mesh, stiffness: Array) -> Array:
    """Displacement (r, k) along each direction in which a place has springs, however stiff they are."""
    places = stiffness.any(axis=(2, 3))
    size, ways = np.linalg.eigh(stiffness[places])  # (q, 2), (q, 2, 2) with the directions in columns
    along = np.einsum("qxi,qxk->qik", ways, motions.displacement(mesh.nodes[mesh.elements[places]]))
    return along[size > UNSPRUNG * size[:, 1:]]


def echelon(basis: Array) -> Array:
    """Row echelon form of a basis (k, components), each row of unit length: translations along the axes come first.

    A component that is `SLIGHT` in all rows that are left is no pivot: division by it would lose digits. A ring that
    spins about its middle has such a translation, for the middle of its nodes is beside it.
    """
    if not len(basis):
        return basis
    rows, size = basis.copy(), row_norms(basis)
    if len(rows) < 2:
        first = (abs(rows) >= SLIGHT * size[:, None]).argmax(axis=1)
        return rows / np.copysign(size, rows[np.arange(len(rows)), first])[:, None]
    row = 0
    for column in range(basis.shape[1]):
        if row == len(rows):
            break
        left = rows[row:]
        parts = abs(left[:, column]) / size[row:]
        pivot = int(parts.argmax())
        if parts[pivot] < SLIGHT:
            continue
        if pivot:
            left[[0, pivot]] = left[[pivot, 0]]
        rows[row] /= rows[row, column]
        factors = rows[:, column].copy()
        factors[row] = 0.0
        rows -= factors[:, None] * rows[row]
        size = row_norms(rows)
        row += 1
    return rows / size[:, None]
