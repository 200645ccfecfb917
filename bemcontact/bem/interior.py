"""Displacement gradient and displacement inside a body, from the fields on its boundary."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, ComplexArray, IntArray
from bemcontact.bem import gradient_kernels, kernels, reference_element
from bemcontact.bem.boundary_gradient import BoundaryFields, Gradient
from bemcontact.bem.gradient_kernels import GradientIntegrals
from bemcontact.bem.influence import Collocation, Influence, InfluenceRows
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.reference_element import RHO_OF_T
from bemcontact.bem.symmetry import SymmetryLine
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen

PAIRS = 16_000
"""Pairs of a point and an element at a time: about ten arrays of them stay in the second-level cache."""
NEAR_RHO = 4.0
"""Lower bound of the Bernstein parameter below which the root itself is computed."""


class Nearest(NamedTuple):
    """The place on the boundary that is nearest to each point (k,): element, ξ, and the distance over L0.

    The distance is infinite where no element is near compared with its length. Points off the boundary are `inside` if
    it winds around them.
    """

    element: IntArray
    xi: Array
    distance: Array
    inside: BoolArray


@frozen
class Interior:
    """Points inside and around the boundary of a body, for the integrals of `gradient_kernels` over it.

    Parameters
    ----------
    mesh : Mesh
    poisson_ratio : effective one, of plane strain
    lines : lines of symmetry, of which the first along each axis is used
    """

    mesh: Mesh
    poisson_ratio: float
    lines: Sequence[SymmetryLine] = ()

    @cached_property
    def influence(self) -> Influence:
        """The integrals of displacement; its frame, over L0 and from the middle of the body, is that of `z`."""
        return Influence(mesh=self.mesh, poisson_ratio=self.poisson_ratio, traction_elements=np.zeros(0, int))

    def z(self, points: Array) -> ComplexArray:
        """Points (k, 2) [L] as x + iy (k,), over L0."""
        x = (points - self.mesh.center) / self.mesh.reference_length
        return x[:, 0] + 1j * x[:, 1]

    def _blocks(self, count: int) -> Iterator[slice]:
        step = max(1, PAIRS // len(self.mesh.elements))
        yield from (slice(first, min(first + step, count)) for first in range(0, count, step))

    @cached_property
    def _coefficients(self) -> tuple[ComplexArray, Array, Array]:
        """c0 and the magnitudes of c1 and c2 (m,) of the element maps."""
        c0, c1, c2 = kernels.element_coefficients(self.influence.element_nodes)
        return c0, np.asarray(abs(c1), float), np.asarray(abs(c2), float)

    def _least_rho(self, z: ComplexArray) -> Array:
        """A lower bound (k, m) of the Bernstein parameter: |z - c0| = |c1 r + c2 r²| bounds |r| from below."""
        c0, c1, c2 = self._coefficients
        distance = abs(z[:, None] - c0)
        r = 2 * distance / (c1 + np.sqrt(c1**2 + 4 * c2 * distance))
        return r + np.sqrt(np.maximum(r * r - 1, 0))

    def nearest(self, z: ComplexArray) -> Nearest:
        """Look for the nearest place on an element that is near, and for the side of the boundary."""
        nodes = self.influence.element_nodes
        result = Nearest(np.zeros(len(z), int), np.zeros(len(z)), np.full(len(z), np.inf), np.zeros(len(z), bool))
        for block in self._blocks(len(z)):
            point, element = np.nonzero(self._least_rho(z[block]) < NEAR_RHO)
            tau = nodes[element] - z[block][point, None]
            root = kernels.nearest_root(tau)
            xi = np.clip(root.r.real, -1, 1)
            distance = abs(np.sum(reference_element.values(xi) * tau, axis=1))
            order = np.lexsort((distance, point))
            first = order[np.append(True, np.diff(point[order]) > 0)[: len(order)]]
            at = block.start + point[first]
            result.element[at], result.xi[at], result.distance[at] = element[first], xi[first], distance[first]
            angles = np.angle((nodes[:, 2] - z[block][:, None]) * (nodes[:, 0] - z[block][:, None]).conj())
            angles[point, element] = _angles(tau, root)
            result.inside[block] = angles.sum(axis=1) > np.pi
        return result

    def integrals(self, z: ComplexArray) -> GradientIntegrals:
        """J and K (k, m, 3) at points (k,) off the boundary."""
        rho = self._least_rho(z)
        near = np.nonzero(rho < NEAR_RHO)
        tau = self.influence.element_nodes[near[1]] - z[near[0], None]
        root = kernels.nearest_root(tau)
        tiers = reference_element.tier(rho, RHO_OF_T)
        tiers[near] = reference_element.tier(reference_element.bernstein_parameter(root.r), RHO_OF_T)
        nodes, at_z, flat = self.influence.element_nodes, np.repeat(z, rho.shape[1]), tiers.ravel()
        J, K = np.empty((2, rho.size, 3), complex)
        for tier in np.unique(flat):
            if tier < len(RHO_OF_T):
                at = np.flatnonzero(flat == tier)
                some = nodes[at % rho.shape[1]] - at_z[at, None]
                J[at], K[at] = gradient_kernels.far_integrals(some, int(reference_element.ORDERS[tier]))
            else:
                own = tiers[near] == tier
                at = near[0][own] * rho.shape[1] + near[1][own]
                part = kernels.Root(root.r[own], root.minus[own], root.plus[own])
                J[at], K[at] = gradient_kernels.near_integrals(tau[own], part)
        J, K = J.reshape(*rho.shape, 3), K.reshape(*rho.shape, 3)
        return GradientIntegrals(J, K)

    def gradient(self, z: ComplexArray, fields: BoundaryFields) -> Gradient:
        """Gradient (k, q) at points (k,) inside the body.

        The image of u in a line x = const or y = const is ± conj(u), and so the images of a and b are conj(a), conj(b).
        """
        for line in self.used_lines:
            fields = _prescribed(fields, line)
        W, X = fields.densities
        a, b = np.zeros((2, len(z), W.shape[1]), complex)
        c = 1 / (8 * np.pi * (1 - self.poisson_ratio))
        conjugate = W.conj()
        for seen, mirrored in self._images(z):
            for block in self._blocks(len(z)):
                J, K = (part.reshape(len(part), -1) for part in self.integrals(seen[block]))
                S = J @ W
                one = c * ((fields.kappa - 1) * S.real + 1j * (fields.kappa + 1) * S.imag)
                other = c * (J.conj() @ X + K @ conjugate)
                a[block] += one.conj() if mirrored else one
                b[block] += other.conj() if mirrored else other
        return Gradient(a, b)

    @cached_property
    def used_lines(self) -> list[SymmetryLine]:
        """The first line of symmetry along each axis: the image in a second one would have images without end."""
        return [line for i, line in enumerate(self.lines) if line.axis not in [other.axis for other in self.lines[:i]]]

    def _images(self, z: ComplexArray) -> list[tuple[ComplexArray, bool]]:
        """Points (k,) and their images, and whether these are mirrored an odd number of times."""
        result = [(z, False)]
        for line in self.used_lines:
            at = (line.place - self.mesh.center[line.axis]) / self.mesh.reference_length
            result += [(2 * at - x.conj() if line.axis == 0 else 2j * at + x.conj(), not odd) for x, odd in result]
        return result

    def displacement(self, z: ComplexArray, fields: BoundaryFields) -> ComplexArray:
        """Displacement (k, q) over L0 at points (k,) inside the body, by Somigliana's identity."""
        known = 2 * np.moveaxis(np.stack([fields.P.real, fields.P.imag], axis=2), 3, 0)
        influence = Influence(
            mesh=self.mesh, poisson_ratio=self.poisson_ratio, traction_elements=np.zeros(0, int), known=known
        )
        u: ComplexArray = np.empty((len(self.mesh.nodes), fields.D.shape[-1]), complex)
        u[self.mesh.elements] = fields.displacement
        none = np.zeros(0, int)
        points = Collocation(
            base=z, offset=np.zeros_like(z), on_point=none, on_element=none, on_local=np.zeros(0),
            corner=np.full(len(z), -1),
        )  # fmt: skip
        result = np.empty((len(z), u.shape[1]), complex)

        def place(block: InfluenceRows) -> None:
            F = dict(zip(kernels.T_ORDER, block.F, strict=True))
            x, y = (block.known[:, axis].T - F[axis, 0].T @ u.real - F[axis, 1].T @ u.imag for axis in range(2))
            result[block.rows] = x + 1j * y

        if len(z):
            influence.each_block(points, place)
        return result


def _prescribed(fields: BoundaryFields, line: SymmetryLine) -> BoundaryFields:
    """The fields with no more on a line of symmetry than is prescribed: traction along it, displacement across it."""
    P, D = fields.P.copy(), fields.D.copy()
    P[line.elements], D[line.elements] = (
        (1j * P[line.elements].imag, D[line.elements].real)
        if line.axis == 0
        else (P[line.elements].real, 1j * D[line.elements].imag)
    )
    return replace(fields, P=P, D=D)


def _angles(tau: ComplexArray, root: kernels.Root) -> Array:
    """The angle (p,) by which τ turns along each element: ∫ dτ/τ is a logarithm for either root of τ."""
    _, c1, c2 = kernels.element_coefficients(tau)
    curved = abs(c2) > gradient_kernels.STRAIGHT * abs(c1)
    angles = np.angle(root.minus * root.plus.conj())
    second = -c1[curved] / c2[curved] - root.r[curved]
    angles[curved] += np.angle((second - 1) * (second + 1).conj())
    return angles
