"""Influence of displacement and traction on the boundary upon collocation points: rows of F and G in F u = G t, (7).

Rows are computed in blocks of neighbouring points. The far elements of a block share one Gauss rule each; pairs near
to each other get the rule, or the closed form, that the root of their own element map asks for.

Lengths here are dimensionless, over L0 = 2 diameters of the body, which also keeps ln r away from the degenerate
scale; stresses are over the shear modulus.
"""

import itertools
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bemcontact.bem import kernels, quadrature
from bemcontact.bem.kernels import Components, GaussRule
from bemcontact.bem.mesh import Mesh

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
ComplexArray = NDArray[np.complex128]

ROWS_PER_BLOCK = 64
LARGEST_BLOCK = 400_000
"""Pairs of one block of rows: bounds its memory to about 100 MB."""
CACHE_SIZE = 16_000
"""Kernel evaluations at a time: about ten arrays of them stay in the second-level cache."""
SHARED_RULE_RHO = 4.0
"""Bernstein parameter from which the elements that are far from a block of points share a rule."""


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
        """The points z (c,) as x + iy, over L0."""
        return self.base + self.offset


@dataclass(frozen=True, kw_only=True, eq=False)
class Block:
    """Some rows of F and G: the x and y equations of the R collocation points `rows`, which the last axis counts.

    Parameters
    ----------
    rows : which points
    F : (4, N, R) by components in the order of `kernels.T_ORDER`; multiplies displacement at the nodes
    G : (3, 3, e, R) by components in the order of `kernels.U_ORDER`; multiplies traction times Jacobian at the three
        local nodes of the elements that `Influence` was asked for
    """

    rows: slice
    F: Array
    G: Array


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
    def _factors(self) -> kernels.Factors:
        return kernels.factors(self.poisson_ratio)

    @cached_property
    def _rules(self) -> list[tuple[GaussRule, ComplexArray, ComplexArray]]:
        """For each tier: the rule, ζ (n, m) and dζ/dξ (n, m) at its Gauss points."""
        rules = []
        for order in quadrature.ORDERS:
            rule = kernels.gauss_rule(int(order), self._factors)
            rules.append((rule, rule.shapes.T @ self.element_nodes.T, rule.derivatives.T @ self.element_nodes.T))
        return rules

    def each_block(self, collocation: Collocation, use: Callable[[Block], None]) -> None:
        """Compute rows of F and G for all points and hand them on, block by block, on all processors.

        Parameters
        ----------
        collocation : Collocation
        use : called once for each block, from several threads and in any order; must not keep the block
        """
        step = max(8, min(ROWS_PER_BLOCK, LARGEST_BLOCK // len(self.mesh.elements)))
        blocks = [slice(first, min(first + step, len(collocation))) for first in range(0, len(collocation), step)]
        if len(blocks) <= 2:
            for rows in blocks:
                use(self.block(collocation, rows))
            return
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            for _ in pool.map(lambda rows: use(self.block(collocation, rows)), blocks):
                pass

    def block(self, collocation: Collocation, rows: slice) -> Block:
        """Rows of F and G for the points `rows`.

        Parameters
        ----------
        collocation : Collocation
        rows : neighbouring points

        Returns
        -------
        Block
        """
        z = collocation.points[rows]
        block = Block(
            rows=rows,
            F=np.zeros((4, len(self.nodes), len(z))),
            G=np.empty((3, 3, len(self.traction_elements), len(z))),
        )
        tiers, far = self._far_tiers(z)
        for run in self._runs(np.where(far, tiers, -1)):
            if far[run.start]:
                self._far(block, z, int(tiers[run.start]), run)
        point, element = (x.ravel() for x in np.meshgrid(np.arange(len(z)), np.flatnonzero(~far), indexing="ij"))
        self._near(block, collocation, point, element)
        self._on_elements(block, collocation)
        self._turn_corners(block, collocation)
        return block

    def _runs(self, kind: IntArray) -> Iterator[slice]:
        """Successive elements of one kind which all have a place in `traction_elements`, or all have none."""
        key = np.column_stack([kind, self._slot >= 0])
        ends = np.flatnonzero((np.diff(key, axis=0) != 0).any(axis=1)) + 1
        for first, last in itertools.pairwise([0, *ends.tolist(), len(kind)]):
            yield slice(first, last)

    def _far_tiers(self, z: ComplexArray) -> tuple[IntArray, NDArray[np.bool_]]:
        """The rule (m,) that each element may share for all points of a block, and whether it is far from the block.

        |z - c0| = |c1 r + c2 r²| bounds |r| from below, and ρ >= |r| + sqrt(|r|² - 1).
        """
        c0, c1, c2 = kernels.element_coefficients(self.element_nodes)
        middle = (z[0] + z[-1]) / 2
        radius = abs(z - middle).max()
        distance = np.maximum(abs(c0 - middle) - radius, 0)
        r = 2 * distance / (abs(c1) + np.sqrt(abs(c1) ** 2 + 4 * abs(c2) * distance))
        rho = np.where(r > 1, r + np.sqrt(np.maximum(r * r - 1, 0)), 1.0)
        return quadrature.tier(rho), (rho > SHARED_RULE_RHO) & (distance > radius)

    def _far(self, block: Block, z: ComplexArray, tier: int, run: slice) -> None:
        """Every point of the block with every element of a run, by one Gauss rule, a cacheful at a time."""
        rule, zeta, tangent = self._rules[tier]
        middle, m = (z[0] + z[-1]) / 2, len(self.mesh.elements)
        step = max(1, CACHE_SIZE // (len(z) * len(zeta)))
        for first in range(run.start, run.stop, step):
            part = slice(first, min(first + step, run.stop))
            integrands = kernels.block_numerators(zeta[:, part] - middle, tangent[:, part], z - middle)
            result = kernels.regular(integrands, rule, self._factors, with_U=bool(self._slot[first] >= 0))
            ends = _successive(self.mesh.elements[part, 2])
            for F, T in zip(block.F, result.T, strict=True):
                F[part] += T[0]
                F[m + part.start : m + part.stop] = T[1]
                F[ends] += T[2]
            if result.U is not None:
                slot = int(self._slot[first])
                block.G[:, :, slot : slot + part.stop - part.start] = result.U

    def _near(self, block: Block, collocation: Collocation, point: IntArray, element: IntArray) -> None:
        """Pairs (point, element), each by the rule that its own root asks for."""
        apart = ~self._pairs_on_elements(block, collocation, point, element)
        point, element = point[apart], element[apart]
        base, offset = (x[block.rows][point, None] for x in (collocation.base, collocation.offset))
        tau = (self.element_nodes[element] - base) - offset
        root = kernels.nearest_root(tau)
        tiers = quadrature.tier(quadrature.bernstein_parameter(root.r))
        for tier in np.unique(tiers):
            at = np.flatnonzero(tiers == tier)
            if tier < len(quadrature.ORDERS):
                rule, _, tangent = self._rules[tier]
                integrands = kernels.numerators(rule.shapes.T @ tau[at].T, tangent[:, element[at]])
                result = kernels.regular(integrands, rule, self._factors, with_U=True)
            else:
                part = kernels.Root(root.r[at], root.minus[at], root.plus[at])
                result = kernels.components(kernels.near_singular(tau[at], part), self._factors)
            self._add_pairs(block, point[at], element[at], result)

    def _pairs_on_elements(
        self, block: Block, collocation: Collocation, point: IntArray, element: IntArray
    ) -> NDArray[np.bool_]:
        """Which pairs have their point on their element."""
        on = _within(collocation.on_point, block.rows)
        count = len(self.mesh.elements)
        known = (collocation.on_point[on] - block.rows.start) * count + collocation.on_element[on]
        return np.isin(point * count + element, known)

    def _on_elements(self, block: Block, collocation: Collocation) -> None:
        """Pairs whose point lies on the element."""
        on = np.flatnonzero(_within(collocation.on_point, block.rows))
        element, local = collocation.on_element[on], collocation.on_local[on]
        integrals = kernels.singular(self.element_nodes[element], local)
        for some in (local == 1, local != 1):  # the two elements at a node add to the same entry
            part = kernels.components(integrals.only(some), self._factors)
            self._add_pairs(block, collocation.on_point[on[some]] - block.rows.start, element[some], part)

    def _turn_corners(self, block: Block, collocation: Collocation) -> None:
        """The free term at nodes between two elements."""
        corner = collocation.corner[block.rows]
        row = np.flatnonzero(corner >= 0)
        for diagonal in range(2):
            block.F[diagonal, corner[row], row] += self._factors.normal * self._corner_angles[corner[row]]

    def _add_pairs(self, block: Block, point: IntArray, element: IntArray, result: Components) -> None:
        """Add the integrals of pairs, no two of which share both point and element."""
        for F, T in zip(block.F, result.T, strict=True):
            for k in range(3):
                F[self.mesh.elements[element, k], point] += T[k]
        slot = self._slot[element]
        wanted = slot >= 0
        if result.U is not None:
            block.G[:, :, slot[wanted], point[wanted]] = result.U[..., wanted]

    @cached_property
    def _corner_angles(self) -> Array:
        """Minus the interior angle (m,) at the start node of each element."""
        tangents = self.mesh.tangents[..., 0] + 1j * self.mesh.tangents[..., 1]
        return kernels.corner_term(tangents[self.mesh.before, 2], tangents[:, 0]).imag


def _within(index: IntArray, rows: slice) -> NDArray[np.bool_]:
    return (index >= rows.start) & (index < rows.stop)


def _successive(index: IntArray) -> IntArray | slice:
    """A slice where indices follow each other, which NumPy adds several times faster."""
    if (np.diff(index) == 1).all():
        return slice(int(index[0]), int(index[-1]) + 1)
    return index
