"""The displacement gradient on the boundary, from traction and the change of displacement along it.

In complex notation, with a = ∂u/∂z, b = ∂u/∂z̄, the unit tangent e and κ = 3 - 4ν, traction t and u' = du/ds give

    w = conj(e) (u' + i t / 2G)      Re a = (κ-1)/(κ+1) Re w      Im a = Im w      b = e (u' - a e)

Quadratic displacement has a derivative along the boundary of second order only, which jumps at element ends; where
traction is sought, it jumps there too. A jump would be a logarithmic peak of the stress inside. Where boundary and
conditions go on smoothly over an end, the derivative there is that of the polynomial through the five nodes of both
elements, in arc length, and the gradient is the mean of those with the tractions on either side. At the other ends it
is that of five nodes on one side. Values at middle nodes change with those at ends so that the change of displacement
over an element, and the force on it, stay as they are. Fields of constant gradient stay exact, also on curved elements.

A cubic derivative that keeps the displacement of middle nodes too was tried. It is better for Kirsch's hole, whose
displacement has no error of collocation, and worse elsewhere: this error changes its sign from node to node.

Lengths are over L0, and stresses over the shear modulus, as in `influence`.
"""

from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np

from bemcontact.arrays import Array, BoolArray, ComplexArray, IntArray
from bemcontact.bem import reference_element
from bemcontact.bem.mesh import Mesh
from bemcontact.frozen import frozen
from bemcontact.problems.material import Material

STARTS, ENDS = 0, 2
"""Local nodes at which an element starts and ends."""
SHORTER = 0.25
"""Least length of the second element over the first one of five nodes on one side, whose weights are large below it."""


class Gradient(NamedTuple):
    """Displacement gradient: a = ∂u/∂z and b = ∂u/∂z̄ of the displacement u + iv, of any shape."""

    a: ComplexArray
    b: ComplexArray

    def stress(self, material: Material) -> Array:
        """σxx, σyy, σxy [p] by Hooke's law, in a new first axis: (3, …)."""
        G, nu = material.shear_modulus, material.effective_poisson_ratio
        mean, difference = 2 * G / (1 - 2 * nu) * self.a.real, 2 * G * self.b
        return np.stack([mean + difference.real, mean - difference.real, difference.imag])


@frozen
class BoundaryFields:
    """Displacement, its derivative, and traction on the boundary, of q states at a time.

    Parameters
    ----------
    slopes : (m, 3) dx/dξ over L0
    kappa : 3 - 4ν of plane strain
    displacement : (m, 3, q) at the local nodes, over L0
    P : (m, 3, q) traction times Jacobian over 2G and L0
    D : (m, 3, q) du/dξ over L0
    """

    slopes: ComplexArray
    kappa: float
    displacement: ComplexArray
    P: ComplexArray
    D: ComplexArray

    @classmethod
    def of(cls, mesh: Mesh, material: Material, displacement: Array, traction: Array, smooth: BoolArray) -> Self:
        """Read displacements (N, 2, q) [L] and tractions (m, 3, 2, q) [p].

        `smooth` (m,) says whether boundary and conditions go on smoothly where an element starts.
        """
        length = mesh.reference_length
        u = (displacement[:, 0] + 1j * displacement[:, 1])[mesh.elements] / length
        t = (traction[:, :, 0] + 1j * traction[:, :, 1]) / material.shear_modulus
        tangents = mesh.tangents / length
        nodal = reference_element.derivatives(reference_element.NODES)
        raw = cls(
            slopes=tangents[..., 0] + 1j * tangents[..., 1],
            kappa=3 - 4 * material.effective_poisson_ratio,
            displacement=u,
            P=t * (mesh.jacobians / length / 2)[..., None],
            D=np.einsum("kl,mlq->mkq", nodal, u - u[:, 1:2]),
        )
        nodes = (mesh.nodes[:, 0] + 1j * mesh.nodes[:, 1]) / length
        return raw._smoothed(_Stencils.of(mesh, smooth), nodes[mesh.elements])

    def _smoothed(self, ends: "_Stencils", nodes: ComplexArray) -> Self:
        """The fields with the gradient at element ends as the module says."""
        element, local = ends.element, ends.local
        slope = self.slopes[element, local, None]
        dx, du = ends.derivative(nodes)[:, None], ends.derivative(self.displacement)
        own = _gradient(dx / abs(dx), du / abs(dx), slope / abs(slope), self.P[element, local] / abs(slope), self.kappa)
        a, b = ((part + part[ends.partner]) / 2 for part in own)
        normal = -1j * slope
        D, P = self.D.copy(), self.P.copy()
        ends.replace(D, a * slope + b * slope.conj())
        ends.replace(P, 2 / (self.kappa - 1) * a.real * normal + b * normal.conj())
        return replace(self, D=D, P=P)

    @property
    def densities(self) -> tuple[ComplexArray, ComplexArray]:
        """W = P - iD and κP + iD (3m, q), which the integrals of `gradient_kernels` multiply."""
        shape = (-1, self.D.shape[-1])
        return (self.P - 1j * self.D).reshape(shape), (self.kappa * self.P + 1j * self.D).reshape(shape)

    def gradient(self, element: IntArray, xi: Array) -> Gradient:
        """Gradient (k, q) at local coordinates ξ (k,) of elements (k,), from that side at an element end."""
        shapes = reference_element.values(xi)
        slope = np.sum(shapes * self.slopes[element], axis=1)[:, None]
        D, P = (np.einsum("kl,klq->kq", shapes, part[element]) for part in (self.D, self.P))
        e = slope / abs(slope)
        return _gradient(e, D / abs(slope), e, P / abs(slope), self.kappa)


def _gradient(
    e: ComplexArray, du_ds: ComplexArray, f: ComplexArray, half_traction: ComplexArray, kappa: float
) -> Gradient:
    """The gradient from du/ds along the unit vector e, and the traction over 2G on the normal -i f.

    With f = e it is that of the module; f may differ from e a bit where two curved elements meet.
    """
    turn = e / f
    w = e.conj() * (du_ds + 1j * half_traction / turn)
    mean = 2 * w.real / (kappa - 1 + 2 * (turn * turn).real)  # 2 Re a / (κ - 1)
    a = (kappa - 1) / 2 * mean + 1j * (w.imag + (turn * turn).imag * mean)
    return Gradient(a, e * (du_ds - a * e))


class _Stencils(NamedTuple):
    """Element ends (s,) whose gradient follows from four nodes beside them.

    Parameters
    ----------
    element, local : (s,) of each end
    partner : (s,) number of the end of the other element at the same node, or its own number
    beside : (s, 4) the nodes, as 3 times an element plus a local node
    weights : (s, 4) of the differences to them in the derivative by arc length over L0
    """

    element: IntArray
    local: IntArray
    partner: IntArray
    beside: IntArray
    weights: Array

    @classmethod
    def of(cls, mesh: Mesh, smooth: BoolArray) -> Self:
        """List the ends where two elements go on smoothly, and those where the boundary does so on one side."""
        halves, before, after = mesh.halves / mesh.reference_length, mesh.before, mesh.elements[:, 2]
        joined = np.flatnonzero(smooth)
        length = halves.sum(axis=1)
        start = np.flatnonzero(~smooth & smooth[after] & (length[after] > SHORTER * length))
        end = np.flatnonzero(smooth & ~smooth[after] & (length[before] > SHORTER * length))

        def forth(element: IntArray, arc: Array) -> tuple[IntArray, Array]:
            at = np.stack([3 * element + 1, 3 * element + 2], axis=1)
            return at, np.stack([arc + halves[element, 0], arc + length[element]], axis=1)

        def back(element: IntArray, arc: Array) -> tuple[IntArray, Array]:
            at = np.stack([3 * element + 1, 3 * element], axis=1)
            return at, -np.stack([arc + halves[element, 1], arc + length[element]], axis=1)

        here = np.zeros(len(joined)), np.zeros(len(start)), np.zeros(len(end))
        over = back(before[joined], here[0]), forth(joined, here[0])
        ahead = forth(start, here[1]), forth(after[start], length[start])
        behind = back(end, here[2]), back(before[end], length[end])
        beside, arc = (
            np.vstack([np.hstack([one[i], other[i]]) for one, other in (over, over, ahead, behind)]) for i in (0, 1)
        )
        count, number = len(joined), np.arange(len(arc))
        number[: 2 * count] = np.roll(number[: 2 * count], count)
        return cls(
            element=np.concatenate([before[joined], joined, start, end]),
            local=np.repeat([ENDS, STARTS, STARTS, ENDS], [count, count, len(start), len(end)]),
            partner=number,
            beside=np.asarray(beside, np.int64),
            weights=_derivative_weights(np.asarray(arc, float)),
        )

    def derivative(self, values: ComplexArray) -> ComplexArray:
        """Derivative by arc length at the ends (s, …), of values (m, 3, …) at the local nodes."""
        beside = values.reshape(-1, *values.shape[2:])[self.beside]
        return np.einsum("sj,sj...->s...", self.weights, beside - values[self.element, self.local][:, None])

    def replace(self, values: ComplexArray, by: ComplexArray) -> None:
        """Replace values (m, 3, q) at the ends by others (s, q), with the same integral over every element."""
        change = by - values[self.element, self.local]
        values[self.element, self.local] = by
        np.subtract.at(values[:, 1], self.element, change / 4)


def _derivative_weights(x: Array) -> Array:
    """Weights (s, 4) of f(x_j) - f(0) in the derivative at 0 of the polynomial through 0 and four x_j (s, 4)."""
    weights = np.empty_like(x)
    for j in range(4):
        others = np.delete(x, j, axis=1)
        weights[:, j] = np.prod(-others / (x[:, j : j + 1] - others), axis=1) / x[:, j]
    return weights
