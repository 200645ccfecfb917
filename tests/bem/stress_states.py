"""Fields of stress in closed form, for tests of stress inside bodies and on their boundaries."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bemcontact.bem import reference_element
from bemcontact.bem.boundary_gradient import BoundaryFields
from bemcontact.bem.interior import Interior
from bemcontact.bem.mesh import Mesh
from bemcontact.problems.material import Material


class State(NamedTuple):
    """A field by the potentials of Kolosov: φ, φ', φ'', ψ, ψ'."""

    phi: Callable
    phi_1: Callable
    phi_2: Callable
    psi: Callable
    psi_1: Callable

    def displacement(self, points: np.ndarray, material: Material) -> np.ndarray:
        """2G (u + iv) = κ φ - z conj φ' - conj ψ."""
        z, kappa = points[..., 0] + 1j * points[..., 1], 3 - 4 * material.effective_poisson_ratio
        w = kappa * self.phi(z) - z * np.conj(self.phi_1(z)) - np.conj(self.psi(z))
        return np.stack([w.real, w.imag], axis=-1) / (2 * material.shear_modulus)

    def stress(self, points: np.ndarray) -> np.ndarray:
        """σxx + σyy = 4 Re φ', σyy - σxx + 2i σxy = 2 (conj z φ'' + ψ')."""
        z = points[..., 0] + 1j * points[..., 1]
        mean, difference = 2 * self.phi_1(z).real, np.conj(z) * self.phi_2(z) + self.psi_1(z)
        return np.stack([mean - difference.real, mean + difference.real, difference.imag], axis=-1)

    def traction(self, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """On normals (…, 2)."""
        xx, yy, xy = np.moveaxis(self.stress(points), -1, 0)
        x, y = np.moveaxis(normals, -1, 0)
        return np.stack([xx * x + xy * y, xy * x + yy * y], axis=-1)


CONSTANT = State(
    lambda z: (0.7 + 0.4j) * z + 2 - 1j, lambda z: 0.7 + 0.4j + 0 * z, np.zeros_like,
    lambda z: (0.3 - 0.8j) * z, lambda z: 0.3 - 0.8j + 0 * z,
)  # fmt: skip
"""Constant stress, with a turn and a shift."""
SMOOTH = State(
    lambda z: np.exp(1.3j * z + 0.2), lambda z: 1.3j * np.exp(1.3j * z + 0.2), lambda z: -1.69 * np.exp(1.3j * z + 0.2),
    lambda z: np.sin(1.1 * z), lambda z: 1.1 * np.cos(1.1 * z),
)  # fmt: skip
"""A field that no polynomial is."""


def fields_of(
    mesh: Mesh, material: Material, displacement: np.ndarray, traction: np.ndarray, smooth: np.ndarray | None = None
) -> BoundaryFields:
    """Fields of one state; by default edges are smooth, and their ends are not."""
    if smooth is None:
        smooth = mesh.edge == mesh.edge[mesh.before]
    return BoundaryFields.of(mesh, material, displacement[..., None], traction[..., None], smooth)


def exact_fields(mesh: Mesh, material: Material, state: State, smooth: np.ndarray | None = None) -> BoundaryFields:
    """Fields of a state in closed form on a mesh."""
    at = mesh.nodes[mesh.elements]
    return fields_of(mesh, material, state.displacement(mesh.nodes, material), state.traction(at, mesh.normals), smooth)


def below(mesh: Mesh, local: float, depth: float) -> np.ndarray:
    """Points (m, 2) below each element at a local coordinate, a depth in lengths of the element."""
    at = np.array([local])
    place = (reference_element.values(at) @ mesh.nodes[mesh.elements])[:, 0]
    slope = mesh.tangents_at(at)[:, 0]
    inward = np.column_stack([-slope[:, 1], slope[:, 0]]) / np.hypot(*slope.T)[:, None]
    return place + 2 * depth * mesh.jacobians[:, 1, None] * inward


def stress_at(points: np.ndarray, mesh: Mesh, material: Material, fields: BoundaryFields) -> np.ndarray:
    """σxx, σyy, σxy (k, 3) inside."""
    interior = Interior(mesh=mesh, poisson_ratio=material.effective_poisson_ratio)
    return interior.gradient(interior.z(points), fields).stress(material)[..., 0].T
