"""Influence of displacement and traction on the boundary at collocation points: rows of F and G in F u = G t, (7).

Rows are computed in blocks of neighboring points. The influence of far elements on a block follows from their influence
on a few of its points (`skeleton`), with one Gauss rule for each element. For near pairs, the root of the element map
decides between a Gauss rule and the closed form.

Lengths are divided by the `reference_length` L0 of the mesh, which also keeps ln r away from the degenerate scale.
Stresses are divided by the shear modulus.
"""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bemcontact.arrays import Array, BoolArray, ComplexArray, IntArray, successive
from bemcontact.bem import kernels, reference_element
from bemcontact.bem.kernels import GaussRule
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.skeleton import RATIO, disc, skeleton
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen
from bemcontact.threads import one_thread, share_out

ROWS_PER_BLOCK = 160
LARGEST_BLOCK = 400_000
"""Pairs of one block of rows: bounds its memory to about 100 MB."""
CACHE_SIZE = 24_000
"""Kernel evaluations at a time: about ten arrays of them stay in the second-level cache."""
WORTH_A_RULE = 1_700
"""Kernel evaluations that take as long as the steps of one more rule."""
SHARED_RULE_RHO = 4.0
"""Bernstein parameter from which the elements that are far from a block of points share a rule."""


@frozen
class Collocation:
    """Points z at which the displacement equation is written, and their places on elements.

    Parameters
    ----------
    base, offset : (c,) x + iy, over L0: the point is base + offset, base a node. Differences to other nodes of the same
        elements are taken from the base, which keeps their digits where elements are short
    on_point, on_element, on_local : (q,) each, by ascending points: the point lies on that element at that local
        coordinate ξ0; a node between two elements lies on both, at -1 of the one and +1 of the other
    corner : (c,) element that starts at a node between two elements, or -1 for other points
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


@frozen
class InfluenceRows:
    """Some rows of F and G: the x and y equations of the R collocation points `rows`, which the last axis counts.

    Parameters
    ----------
    rows : numbers of the points
    F : (4, N, R) by components in the order of `kernels.T_ORDER`; multiplies displacement at the nodes
    G : (3, 3, e, R) by components in the order of `kernels.U_ORDER`; multiplies traction times Jacobian at the three
        local nodes of the elements that `Influence` was asked for
    known : (s, 2, R) displacement along x and y due to each of the known tractions of `Influence`
    """

    rows: slice
    F: Array
    G: Array
    known: Array


class _Space(NamedTuple):
    """Memory for F and G of a block, reused for the next one, because new memory costs as much as filling it."""

    F: Array
    G: Array


@frozen
class Influence:
    """The boundary of a body as a source of displacement at collocation points.

    Parameters
    ----------
    mesh : Mesh
    poisson_ratio : effective one, of plane strain
    traction_elements : (e,) elements whose columns of G are wanted, ascending
    known : (s, m, 3, 2) tractions times Jacobian of each of which only the sum G t is wanted
    """

    mesh: Mesh
    poisson_ratio: float
    traction_elements: IntArray
    known: Array = field(default_factory=lambda: np.zeros((0, 0, 3, 2)))

    @cached_property
    def nodes(self) -> ComplexArray:
        """Nodes (N,) as x + iy, over L0."""
        x = (self.mesh.nodes - self.mesh.center) / self.mesh.reference_length
        return x[:, 0] + 1j * x[:, 1]

    @cached_property
    def element_nodes(self) -> ComplexArray:
        """(m, 3) as x + iy, over L0."""
        return self.nodes[self.mesh.elements]

    @cached_property
    def coefficients(self) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """c0, c1, c2 (m,) of ζ = c0 + c1 ξ + c2 ξ² on the elements."""
        return kernels.element_coefficients(self.element_nodes)

    @cached_property
    def inner_angles(self) -> Array:
        """Angle (m,) inside the body where each element starts, of the nodes as they are here, rounded.

        A different rounding of an angle between short elements would act as a turn of all displacements there.
        """
        _, c1, c2 = self.coefficients
        return np.mod(np.angle(-(c1 + 2 * c2)[self.mesh.before] / (c1 - 2 * c2)), 2 * np.pi)

    @cached_property
    def _known(self) -> Array:
        """`known` as (s, 2, 3, m)."""
        return self.known.transpose(0, 3, 2, 1) if len(self.known) else np.zeros((0, 2, 3, len(self.mesh.elements)))

    @cached_property
    def _loaded(self) -> IntArray:
        """Elements whose U is needed, for a column or for the sum, ascending."""
        loaded: BoolArray = np.any(self._known, axis=(0, 1, 2))
        loaded[self.traction_elements] = True
        return np.flatnonzero(loaded)

    @cached_property
    def _slot(self) -> IntArray:
        """(m,) place of each element in `_loaded`, -1 if none."""
        return _places(self._loaded, len(self.mesh.elements))

    @cached_property
    def _column(self) -> IntArray:
        """(m,) place of each element in `traction_elements`, -1 if none."""
        return _places(self.traction_elements, len(self.mesh.elements))

    @cached_property
    def factors(self) -> kernels.Factors:
        """Factors of the integrals."""
        return kernels.factors(self.poisson_ratio)

    @cached_property
    def _rules(self) -> list[GaussRule]:
        """The rule of each tier."""
        return [kernels.gauss_rule(int(order), self.factors) for order in reference_element.ORDERS]

    @cached_property
    def _from_middle(self) -> ComplexArray:
        """Nodes (m, 3) of each element, counted from its middle."""
        return self.element_nodes - self.element_nodes[:, 1:2]

    def each_block(self, collocation: Collocation, use: Callable[[InfluenceRows], None]) -> None:
        """Compute rows of F and G for all points and pass them to `use`, block by block, in several threads.

        `use` is called from other threads and in any order; it must not keep the block. BLAS uses one thread meanwhile,
        because several threads are slower for products as small as these.
        """
        step = max(8, min(ROWS_PER_BLOCK, LARGEST_BLOCK // len(self.mesh.elements)))
        blocks = [slice(first, min(first + step, len(collocation))) for first in range(0, len(collocation), step)]
        if len(blocks) == 1:
            use(self.block(collocation, blocks[0]))
            return

        def work(some: Sequence[slice]) -> None:
            space = self._space(step)
            for rows in some:
                use(self._block(collocation, rows, space))

        with one_thread:
            share_out(work, blocks)

    def block(self, collocation: Collocation, rows: slice) -> InfluenceRows:
        """Rows of F and G for neighboring points."""
        return self._block(collocation, rows, self._space(rows.stop - rows.start))

    def _space(self, size: int) -> _Space:
        return _Space(np.empty(4 * len(self.nodes) * size), np.empty(9 * len(self.traction_elements) * size))

    def _block(self, collocation: Collocation, rows: slice, space: _Space) -> InfluenceRows:
        """Rows of F and G in given memory, which the result keeps."""
        origin = collocation.base[rows.start]  # the digits of short elements are in differences to nodes of their own
        z = (collocation.base[rows] - origin) + collocation.offset[rows]
        nodes = self.element_nodes - origin
        tiers = self._far_tiers(z, nodes)
        block = self._far(rows, z, nodes, tiers, space)
        self._near(block, collocation, np.flatnonzero(tiers < 0))
        self._turn_corners(block, collocation)
        return block

    def _runs(self, kind: IntArray) -> Iterator[slice]:
        """Successive elements of one kind which all have a place in `traction_elements`, or all have none."""
        key = np.column_stack([kind, self._slot >= 0])
        ends = np.flatnonzero((np.diff(key, axis=0) != 0).any(axis=1)) + 1
        for first, last in itertools.pairwise([0, *ends.tolist(), len(kind)]):
            yield slice(first, last)

    def _far_tiers(self, z: ComplexArray, nodes: ComplexArray) -> IntArray:
        """The rule (m,) that each element far from a block shares for all of its points; -1 for others."""
        # |z - c0| = |c1 r + c2 r²| bounds |r| from below, and ρ >= |r| + sqrt(|r|² - 1)
        c0, c1, c2 = kernels.element_coefficients(nodes)
        middle, radius = disc(z)
        c1, c2 = abs(c1), abs(c2)
        distance = np.maximum(abs(c0 - middle) - radius, 0)
        r = 2 * distance / (c1 + np.sqrt(c1**2 + 4 * c2 * distance))
        rho = np.where(r > 1, r + np.sqrt(np.maximum(r * r - 1, 0)), 1.0)
        far = np.flatnonzero((rho > SHARED_RULE_RHO) & (radius <= RATIO * (abs(c0 - middle) - c1 - c2)))
        tiers, rho = np.full(len(nodes), -1), rho[far]
        if len(far):
            of_tractions = reference_element.tier(rho, reference_element.RHO_OF_T)
            tiers[far] = np.where(self._slot[far] >= 0, reference_element.tier(rho), of_tractions)
        return tiers

    def _far(self, rows: slice, z: ComplexArray, nodes: ComplexArray, tiers: IntArray, space: _Space) -> InfluenceRows:
        """A block with the influence of far elements on its points, by one Gauss rule each; tier -1 leaves one out."""
        columns = len(self.traction_elements)
        if (tiers < 0).all():
            return self._zero(rows, len(z), columns)
        few = skeleton(z)
        part = self._zero(rows, len(few.at), len(self._loaded))
        for run in self._runs(tiers):
            if tiers[run.start] >= 0:
                self._far_by_products(part, z[few.at], nodes[run], int(tiers[run.start]), run)
        return InfluenceRows(
            rows=rows,
            F=few.extend(part.F, space.F),
            G=few.extend(part.G[:, :, self._slot[self.traction_elements]], space.G),
            known=_sums(self._known[..., self._loaded], part.G) @ few.weights,
        )

    def _zero(self, rows: slice, points: int, columns: int) -> InfluenceRows:
        """A block of zeros for a number of points, with G for a number of elements."""
        F, G = np.zeros((4, len(self.nodes), points)), np.zeros((3, 3, columns, points))
        return InfluenceRows(rows=rows, F=F, G=G, known=np.zeros((len(self.known), 2, points)))

    def _far_by_products(
        self, block: InfluenceRows, z: ComplexArray, nodes: ComplexArray, tier: int, run: slice
    ) -> None:
        """Every point with every element of a run by products of matrices, in parts that fit into the cache."""
        rule, (middle, _) = self._rules[tier], disc(z)
        zeta = rule.shapes.T @ (nodes - middle).T
        with_U = bool(self._slot[run.start] >= 0)
        polynomials = kernels.numerator_polynomials(zeta, rule.derivatives.T @ self._from_middle[run].T)
        powers = kernels.point_powers(z - middle)
        step = max(1, CACHE_SIZE // (len(z) * len(zeta)))
        for first in range(0, run.stop - run.start, step):
            some = polynomials[..., first : first + step]
            integrands = (some.reshape(6, -1).T @ powers).reshape(*some.shape[1:], len(z))
            part = slice(run.start + first, run.start + first + some.shape[-1])
            result = kernels.regular(integrands, rule, with_U=with_U)
            self._add_to_rows(block, part, result.T)
            if result.U is not None:
                block.G[:, :, successive(self._slot[part])] = result.U

    def _near(self, block: InfluenceRows, collocation: Collocation, element: IntArray) -> None:
        """Every point of the block with some elements, each pair by the rule for its own root."""
        pairs = self._pairs(collocation, block.rows, element)
        tiers = self._near_tiers(pairs, element)
        on_element, on = self._on_elements(block, collocation, element)
        tiers[on_element] = -1
        near = np.flatnonzero(tiers == len(reference_element.ORDERS))
        tiers[near] = -1
        tau = (pairs[:, 0, near] + 1j * pairs[:, 1, near]).T
        beside = kernels.beside_element(tau, kernels.nearest_root(tau))
        singular = np.concatenate([on_element, near])
        order = np.argsort(tiers, kind="stable")  # so that the pairs of a rule follow each other
        order[: len(singular)] = singular
        ends = np.bincount(tiers + 1, minlength=len(reference_element.ORDERS) + 1).cumsum().tolist()
        nodes = pairs.take(order, axis=2)
        parts = [kernels.components(kernels.with_root_split_off(on.and_those(beside)), self.factors)]
        for rule, (first, last) in zip(self._rules, itertools.pairwise(ends), strict=True):
            step = CACHE_SIZE // rule.shapes.shape[1]
            for begin in range(first, last, step):
                some = nodes[..., begin : min(begin + step, last)]
                parts.append(kernels.regular(kernels.numerators(some, rule), rule, with_U=True))
        place, shape = np.empty_like(order), (len(element), -1)
        place[order] = np.arange(len(order))
        T, U = (np.concatenate(part, axis=2).take(place, axis=2) for part in zip(*parts, strict=True))
        T, U = T.reshape(4, 3, *shape), U.reshape(3, 3, *shape)
        self._add_to_rows(block, element, T)
        column = self._column[element]
        wanted, known = column >= 0, self._known[..., element]
        block.G[:, :, column[wanted]] = U[:, :, wanted]
        if known.any():
            np.add(block.known, _sums(known, U), out=block.known)

    def _pairs(self, collocation: Collocation, rows: slice, element: IntArray) -> Array:
        """τ = ζ - z (3, 2, e R) at the nodes of elements, for each of them and each point; real and imaginary parts."""
        base, offset = (_real_parts(z[rows])[:, None] for z in (collocation.base, collocation.offset))
        nodes = _real_parts(self.element_nodes[element].T)[:, :, :, None]
        return ((nodes - base[:, None]) - offset[:, None]).transpose(1, 0, 2, 3).reshape(3, 2, -1)

    def _near_tiers(self, pairs: Array, element: IntArray) -> NDArray[np.int8]:
        """The rule for the root of each pair; where a rule has few of them, a larger one that others need."""
        _, c1, c2 = (part[element, None] for part in self.coefficients)
        middle = (pairs[1, 0] + 1j * pairs[1, 1]).reshape(len(element), -1)
        rho = reference_element.bernstein_parameter(kernels.root_from_middle(middle, c1, c2))
        tiers = reference_element.tier(rho.ravel())
        return _shared_rules(np.bincount(tiers, minlength=len(reference_element.ORDERS) + 1))[tiers]

    def _on_elements(
        self, block: InfluenceRows, collocation: Collocation, element: IntArray
    ) -> tuple[IntArray, kernels.Singular]:
        """Pairs whose point lies on the element: their places among all of (element, point)."""
        point = collocation.on_point
        on = np.flatnonzero((point >= block.rows.start) & (point < block.rows.stop))
        their, local = collocation.on_element[on], collocation.on_local[on]
        row = point[on] - block.rows.start
        at = np.searchsorted(element, their) * block.F.shape[-1] + row
        return at, kernels.on_element(self.element_nodes[their], local)

    def _add_to_rows(self, block: InfluenceRows, element: IntArray | slice, T: Array) -> None:
        """Add the integrals of T over some elements (4, 3, e, R)."""
        start, middle, end = self.mesh.elements[element].T
        block.F[:, successive(start)] += T[:, 0]
        block.F[:, successive(middle)] = T[:, 1]
        block.F[:, successive(end)] += T[:, 2]

    def _turn_corners(self, block: InfluenceRows, collocation: Collocation) -> None:
        """The free term at nodes between two elements: -i times the interior angle."""
        corner = collocation.corner[block.rows]
        row = np.flatnonzero(corner >= 0)
        at, turn = corner[row], self.factors.normal * -self.inner_angles[corner[row]]
        block.F[0, at, row] += turn
        block.F[1, at, row] += turn


def _places(of: IntArray, count: int) -> IntArray:
    """Place of each of `count` items in a list of some of them, -1 if it is not there."""
    places = np.full(count, -1)
    places[of] = np.arange(len(of))
    return places


def _shared_rules(pairs: IntArray) -> NDArray[np.int8]:
    """The rule that the pairs (r + 1,) of each rule, and the last ones of none, take; of a type that is sorted fast."""
    orders, taken, few, waiting = reference_element.ORDERS, np.arange(len(pairs), dtype=np.int8), list[int](), 0
    needed = np.flatnonzero(pairs[:-1]).tolist()
    for rule, larger in itertools.zip_longest(needed, needed[1:]):
        few.append(rule)
        waiting += int(pairs[rule])
        if larger is None or waiting * (orders[larger] - orders[rule]) >= WORTH_A_RULE:
            taken[few] = rule
            few, waiting = [], 0
    return taken


def _real_parts(z: ComplexArray) -> Array:
    """Real and imaginary parts (2, …) of complex numbers."""
    return np.stack([z.real, z.imag])


def _sums(traction: Array, U: Array) -> Array:
    """G t (s, 2, R) of tractions times Jacobian (s, 2, 3, e), with U (3, 3, e, R)."""
    x, y = np.moveaxis(traction.reshape(len(traction), 2, 3 * traction.shape[-1]), 1, 0)
    xx, yy, xy = U.reshape(3, x.shape[-1], U.shape[-1])
    return np.stack([x @ xx + y @ xy, x @ xy + y @ yy], axis=1)
