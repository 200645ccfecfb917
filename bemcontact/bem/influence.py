"""Influence of displacement and traction on the boundary upon collocation points: rows of F and G in F u = G t, (7).

Rows are computed in blocks of neighbouring points. The far elements of a block share one Gauss rule each; pairs near
to each other get the rule, or the closed form, that the root of their own element map asks for.

Lengths here are dimensionless, over L0 = 2 diameters of the body, which also keeps ln r away from the degenerate
scale; stresses are over the shear modulus.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bemcontact.bem import kernels, quadrature, shape_functions
from bemcontact.bem.kernels import Integrals, RealFields
from bemcontact.bem.mesh import Mesh

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
ComplexArray = NDArray[np.complex128]

ROWS_PER_BLOCK = 64
LARGEST_BLOCK = 400_000
"""Pairs of one block of rows: bounds its memory to about 100 MB."""
CACHE_SIZE = 24_000
"""Kernel evaluations at a time: about ten arrays of them stay in the second-level cache."""
SHARED_RULE_RHO = 4.0
"""Bernstein parameter from which the elements far from a block of points share a rule."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Collocation:
    """Points z at which the displacement equation is written, and where on which elements they lie.

    Parameters
    ----------
    base, offset : (c,) x + iy, over L0: the point is base + offset, base a node. Differences to other nodes of the same
        elements are taken from the base, which keeps their digits where elements are short
    on_point, on_element, on_local : (q,) each: the point lies on that element at that local coordinate ξ0;
        a node between two elements lies on both, at -1 of the one and +1 of the other
    corner : (c,) local coordinate -1 element of a node between two elements, or -1 for other points
    """

    base: ComplexArray
    offset: ComplexArray
    on_point: IntArray
    on_element: IntArray
    on_local: Array
    corner: IntArray

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.base)

    @property
    def points(self) -> ComplexArray:
        """z (c,) as x + iy, over L0."""
        return self.base + self.offset


class Block(NamedTuple):
    """Some rows of F and G: x and y equations of `rows`, by components.

    F_xx, … (R, N) multiply nodal displacement; G_xx, … (R, e, 3) multiply traction times Jacobian at the local nodes
    of the elements that `Influence` was asked for.
    """

    rows: slice
    F_xx: Array
    F_xy: Array
    F_yx: Array
    F_yy: Array
    G_xx: Array
    G_xy: Array
    G_yy: Array


class _Fields(NamedTuple):
    """Integrals of one block in real form: T (4, R, m, 3), U (3, R, e, 3)."""

    T: Array
    U: Array


class _Rule(NamedTuple):
    """A Gauss rule on all elements: N_k (n, 3), weights times N_k (n, 3), ζ and dζ/dξ (m, n)."""

    shapes: Array
    weighted_shapes: Array
    points: ComplexArray
    tangents: ComplexArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Influence:
    """The boundary of a body as a source of displacement at points.

    Parameters
    ----------
    mesh : Mesh
    poisson_ratio : effective one, of plane strain
    traction_elements : (e,) elements whose columns of G are wanted
    """

    mesh: Mesh
    poisson_ratio: float
    traction_elements: IntArray

    @property
    def length(self) -> float:
        """L0 [L], by which lengths are divided."""
        return 2 * self.mesh.size

    @cached_property
    def nodes(self) -> ComplexArray:
        """Nodes (N,) as x + iy, over L0."""
        x = (self.mesh.nodes - self.mesh.center) / self.length
        return x[:, 0] + 1j * x[:, 1]

    @cached_property
    def element_nodes(self) -> ComplexArray:
        """(m, 3) as x + iy, over L0."""
        return self.nodes[self.mesh.elements]

    @cached_property
    def _slot(self) -> IntArray:
        """(m,) place of each element in `traction_elements`, -1 if none."""
        slot = np.full(len(self.mesh.elements), -1)
        slot[self.traction_elements] = np.arange(len(self.traction_elements))
        return slot

    @cached_property
    def _rules(self) -> list["_Rule"]:
        """One for each tier."""
        rules = []
        for order in quadrature.ORDERS:
            xi, weights = quadrature.gauss_legendre(int(order))
            N, dN = shape_functions.values(xi), shape_functions.derivatives(xi)
            rules.append(_Rule(N, weights[:, None] * N, self.element_nodes @ N.T, self.element_nodes @ dN.T))
        return rules

    def blocks(self, collocation: Collocation) -> Iterator[Block]:
        """Rows of F and G for all points, a block at a time.

        Yields
        ------
        Block
        """
        step = max(8, min(ROWS_PER_BLOCK, LARGEST_BLOCK // len(self.mesh.elements)))
        for first in range(0, len(collocation), step):
            rows = slice(first, min(first + step, len(collocation)))
            yield self._combine(rows, self._fields(collocation, rows), collocation)

    def _fields(self, collocation: Collocation, rows: slice) -> _Fields:
        """Integrals between the points of a block and all elements."""
        z = collocation.points[rows]
        m, e = len(self.mesh.elements), len(self.traction_elements)
        fields = _Fields(np.empty((4, len(z), m, 3)), np.empty((3, len(z), e, 3)))
        tiers = quadrature.tier(self._block_rho(z))
        shared = tiers < quadrature.tier(np.array(SHARED_RULE_RHO))
        for tier in np.unique(tiers[shared]):
            for elements, with_U in self._split(np.flatnonzero(shared & (tiers == tier))):
                self._far(fields, z, int(tier), elements, with_U=with_U)
        if not shared.all():
            point, element = (x.ravel() for x in np.meshgrid(np.arange(len(z)), np.flatnonzero(~shared), indexing="ij"))
            self._near(fields, collocation, rows, point, element)
        self._on_elements(fields, collocation, rows)
        return fields

    def _block_rho(self, z: ComplexArray) -> Array:
        """Lower bound (m,) of ρ between each element and any point of the block.

        |z - c0| = |c1 r + c2 r²| bounds |r| from below, and ρ >= |r| + sqrt(|r|² - 1).
        """
        c0, c1, c2 = kernels.element_coefficients(self.element_nodes)
        middle = (z[0] + z[-1]) / 2
        distance = np.maximum(abs(c0 - middle) - abs(z - middle).max(), 0)
        r = 2 * distance / (abs(c1) + np.sqrt(abs(c1) ** 2 + 4 * abs(c2) * distance))
        return np.where(r > 1, r + np.sqrt(np.maximum(r * r - 1, 0)), 1.0)

    def _split(self, elements: IntArray) -> Iterator[tuple[IntArray, bool]]:
        """Elements whose traction is wanted, and the others."""
        wanted = self._slot[elements] >= 0
        for flag in (True, False):
            if (part := elements[wanted == flag]).size:
                yield part, flag

    def _far(self, fields: _Fields, z: ComplexArray, tier: int, elements: IntArray, *, with_U: bool) -> None:
        """Every point of the block with every one of `elements`, by one Gauss rule."""
        rule = self._rules[tier]
        step = max(1, CACHE_SIZE // (len(z) * len(rule.shapes)))
        x, y = z.real[:, None, None].copy(), z.imag[:, None, None].copy()
        for first in range(0, len(elements), step):
            part = elements[first : first + step]
            at, along = rule.points[part], rule.tangents[part]
            result = kernels.regular(
                at.real - x, at.imag - y, along.real.copy(), along.imag.copy(), rule.weighted_shapes, with_U=with_U
            )
            self._store(fields, (slice(None), _as_slice(part)), (slice(None), _as_slice(self._slot[part])), result)

    def _near(
        self, fields: _Fields, collocation: Collocation, rows: slice, point: IntArray, element: IntArray
    ) -> None:
        """Pairs (point, element), each by the rule that its own root asks for."""
        base, offset = collocation.base[rows][point, None], collocation.offset[rows][point, None]
        tau = (self.element_nodes[element] - base) - offset
        off = abs(tau).min(axis=1) > 0
        tau, point, element = tau[off], point[off], element[off]
        root = kernels.nearest_root(tau)
        tiers = quadrature.tier(quadrature.bernstein_parameter(root.r))
        for tier in np.unique(tiers):
            at = np.flatnonzero(tiers == tier)
            if tier < len(quadrature.ORDERS):
                rule = self._rules[tier]
                to, along = tau[at] @ rule.shapes.T, rule.tangents[element[at]]
                result = kernels.regular(
                    to.real, to.imag, along.real, along.imag, rule.weighted_shapes, with_U=True
                )
            else:
                part = kernels.Root(root.r[at], root.minus[at], root.plus[at])
                result = _real(kernels.near_singular(tau[at], part, with_U=True))
            self._store_pairs(fields, point[at], element[at], result)

    def _on_elements(self, fields: _Fields, collocation: Collocation, rows: slice) -> None:
        """Pairs whose point lies on the element."""
        on = (collocation.on_point >= rows.start) & (collocation.on_point < rows.stop)
        element = collocation.on_element[on]
        result = kernels.singular(self.element_nodes[element], collocation.on_local[on], with_U=True)
        self._store_pairs(fields, collocation.on_point[on] - rows.start, element, _real(result))

    def _store_pairs(self, fields: _Fields, point: IntArray, element: IntArray, result: RealFields) -> None:
        slot = self._slot[element]
        wanted = slot >= 0
        if result.log is not None and result.cos is not None and result.sin is not None:
            result = result._replace(log=result.log[wanted], cos=result.cos[wanted], sin=result.sin[wanted])
        self._store(fields, (point, element), (point[wanted], slot[wanted]), result)

    @staticmethod
    def _store(fields: _Fields, at: tuple, at_U: tuple, result: RealFields) -> None:
        for field, values in zip(fields.T, result[:4], strict=True):
            field[at] = values
        if result.log is not None:
            for field, values in zip(fields.U, result[4:], strict=True):
                field[at_U] = values

    def _combine(self, rows: slice, fields: _Fields, collocation: Collocation) -> Block:
        """Collect elements into nodes and put the scalar integrals together to F and G."""
        tangential, normal, cos, sin = map(self._to_nodes, fields.T)
        corner = np.flatnonzero(collocation.corner[rows] >= 0)
        normal[corner, collocation.corner[rows][corner] * 2] += self._corner_angles[collocation.corner[rows][corner]]
        kappa = 3 - 4 * self.poisson_ratio
        c = 1 / (8 * np.pi * (1 - self.poisson_ratio))
        normal *= -c * (kappa + 1)
        tangential *= c * (kappa - 1)
        cos *= 2 * c
        sin *= 2 * c
        log, turn_cos, turn_sin = fields.U
        log *= -c * kappa
        log += c / 2 * shape_functions.INTEGRALS
        turn_cos *= c / 2
        turn_sin *= c / 2
        return Block(
            rows,
            F_xx=normal - cos, F_xy=-tangential - sin, F_yx=tangential - sin, F_yy=normal + cos,
            G_xx=log + turn_cos, G_xy=turn_sin, G_yy=log - turn_cos,
        )  # fmt: skip

    @cached_property
    def _corner_angles(self) -> Array:
        """Minus the interior angle (m,) at the start node of each element."""
        tangents = self.mesh.tangents[..., 0] + 1j * self.mesh.tangents[..., 1]
        return kernels.corner_term(tangents[self.mesh.before, 2], tangents[:, 0]).imag

    def _to_nodes(self, field: Array) -> Array:
        """Sum (R, m, 3) over the elements at each node: (R, N)."""
        result = np.empty((len(field), len(self.nodes)))
        result[:, 0::2] = field[:, :, 0]
        result[:, 1::2] = field[:, :, 1]
        result[:, self.mesh.elements[:, 2]] += field[:, :, 2]
        return result


def _as_slice(index: IntArray) -> IntArray | slice:
    """Use a slice where the indices follow each other, which NumPy copies several times faster."""
    if len(index) and index[-1] - index[0] == len(index) - 1:
        return slice(int(index[0]), int(index[-1]) + 1)
    return index


def _real(integrals: Integrals) -> RealFields:
    A, B, L, M = integrals
    skew = B / 2j
    U = (L, M.real, M.imag) if L is not None and M is not None else (None, None, None)
    return RealFields(A.real, A.imag, skew.real, skew.imag, *U)
