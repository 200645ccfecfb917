"""The linear system of a body: F u = G t with the conditions, for the unknowns only, [SS92] (9)-(10).

The unknowns are the displacements that no condition prescribes, and the tractions at prescribed displacements. Contact
pressures and prescribed values are on the right: A z = b + Σ_i p_i b_i. Displacement is not rotated at contact nodes.
The normal displacement is computed from it, u_n = n·u, the inverse of (8), so that a node may belong to two zones.

In this module lengths are divided by L0 and stresses by the shear modulus (see `influence`).
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from importlib import import_module
from typing import NamedTuple

import numpy as np

from bemcontact import compilation
from bemcontact.arrays import Array, BoolArray, ComplexArray, IntArray, indices
from bemcontact.bem import kernels, reference_element
from bemcontact.bem.boundary_values import BoundaryValues
from bemcontact.bem.flat import FlatColumns, FlatElements, FlatPoints, FlatRules, flat_rules
from bemcontact.bem.influence import Collocation, Influence, InfluenceRows
from bemcontact.bem.loading import Loading
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.rigid_motions import RigidMotions
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen
from bemcontact.problems.material import Material

AXES = np.eye(2)
"""Unit tractions along x and y."""
OFFSET = 2 / 3
"""|ξ| of the collocation points inside the two elements at a node where both prescribe the displacement."""
WORTH_COMPILING = 3000
"""Degrees of freedom from which numba is imported if installed: for fewer, its import takes longer than it saves."""
BY_NUMBA = "the equations were set up by machine code (numba): without it, the last digits may differ"
STRAIGHT = 1e-8
"""Sine of the angle between two elements below which traction is continuous between them."""


MachineCode = Callable[[Array, FlatPoints, FlatElements, FlatColumns, FlatRules, kernels.Factors], None]
"""A function with the parameters of `compiled.add_all`."""


@lru_cache(maxsize=1)
def machine_code() -> MachineCode | None:
    """`compiled.add_all`, or None without numba.

    Its first call compiles it, which takes seconds once; the machine code is kept for later processes.
    """
    try:
        return import_module("bemcontact.bem.compiled").add_all  # it imports numba
    except ImportError:
        return None


@frozen
class Unknowns:
    """Columns of the system: x displacements, y displacements, then tractions.

    Traction is continuous where an edge continues straight. It may jump where two edges meet, and where two curved
    elements meet, because the normal of the quadratic elements jumps there.

    Parameters
    ----------
    displacement : (N, 2) column, -1 where prescribed
    traction : (m, 3, 2) column, -1 where given
    size : number of columns
    """

    displacement: IntArray
    traction: IntArray
    size: int


def number_unknowns(mesh: Mesh, values: BoundaryValues) -> Unknowns:
    """Number the columns of the unknowns."""
    free = ~values.displacement_given
    displacement = np.full(free.shape, -1)
    traction, count = np.full((*mesh.elements.shape, 2), -1), int(np.count_nonzero(free))
    displacement.T[free.T] = np.arange(count)
    if not values.traction_unknown.any():
        return Unknowns(displacement=displacement, traction=traction, size=count)
    slot, smooth = np.arange(3 * len(mesh.elements)).reshape(-1, 3), _continues_straight(mesh)
    slot[smooth, 0] = slot[mesh.before[smooth], 2]
    for axis, sought in enumerate(values.traction_unknown.T):
        used, places = np.zeros(slot.size, bool), slot[sought]
        used[places] = True
        number = used.cumsum()
        traction[sought, :, axis] = count - 1 + number[places]
        count += int(number[-1])
    return Unknowns(displacement=displacement, traction=traction, size=count)


def _continues_straight(mesh: Mesh) -> BoolArray:
    """Whether each element (m,) continues the one before it on the same edge, in the same direction."""
    return (mesh.edge == mesh.edge[mesh.before]) & (abs(mesh.turns) < STRAIGHT)


@frozen
class SystemEquations:
    """Rows of the system: x equations of the collocation points, then y equations.

    Parameters
    ----------
    collocation : Collocation
    row : (c, 2) row of the equation of each point along each axis, -1 for none
    """

    collocation: Collocation
    row: IntArray


def place_equations(mesh: Mesh, unknowns: Unknowns, nodes: ComplexArray) -> SystemEquations:
    """Put collocation points at the nodes (N,), or inside both elements where a node has two unknown tractions.

    A node has one equation along each axis for its one unknown there. Where two elements meet with an unknown traction
    each along an axis, the equation along that axis is written at ξ = 2/3 of the element before and at ξ = -2/3 of
    the element after instead.
    """
    m, before, element = len(mesh.elements), mesh.before, np.arange(len(mesh.elements))
    ends, starts = unknowns.traction[before, 2], unknowns.traction[:, 0]
    double = (ends >= 0) & (starts >= 0) & (ends != starts)  # (m, 2), at the start node of each element
    # along the boundary, as blocks of rows want it: the start node of each element, which the one before has too, and
    # its middle node
    at_nodes, on_point = np.arange(2 * m).reshape(2, m).T.ravel(), np.repeat(2 * element, 3)
    on_point[2::3] += 1
    on_element, local = np.array([element, before, element]).T.ravel(), np.empty((m, 3))
    local[:] = -1.0, 1.0, 0.0
    on_local, corner, active = local.ravel(), np.where(at_nodes < m, at_nodes, -1), np.ones((2 * m, 2), bool)
    active[::2] = ~double
    base, offset = nodes[at_nodes], np.zeros(2 * m, complex)
    if double.any():
        split, kept = indices(double[:, 0] | double[:, 1]), active[:, 0] | active[:, 1]
        inside, local = np.array([before[split], split]).T.ravel(), np.tile([OFFSET, -OFFSET], len(split))
        at, on, number = np.repeat(nodes[split], 2), kept[on_point], kept.cumsum() - 1
        away = np.sum(reference_element.values(local) * (nodes[mesh.elements[inside]] - at[:, None]), axis=1)
        base, offset = np.append(base[kept], at), np.append(offset[kept], away)
        corner = np.append(corner[kept], np.full(len(inside), -1))
        active = np.concatenate([active[kept], np.repeat(double[split], 2, axis=0)])
        on_point = np.append(number[on_point[on]], np.count_nonzero(kept) + np.arange(len(inside)))
        on_element, on_local = np.append(on_element[on], inside), np.append(on_local[on], local)
    row = np.full(active.shape, -1)
    row.T[active.T] = np.arange(np.count_nonzero(active))
    collocation = Collocation(
        base=base, offset=offset, on_point=on_point, on_element=on_element, on_local=on_local, corner=corner
    )
    return SystemEquations(collocation=collocation, row=row)


class _Carried(NamedTuple):
    """Columns of G that belong to some unknowns: sums of rows of G transposed with factors.

    Each part has every column once at most: rows of G transposed, columns, and factors (q, 1) along both axes.
    """

    columns: int
    parts: Sequence[tuple[IntArray, IntArray, Array, Array]]

    def times(self, G: Sequence[Array]) -> Array:
        """Columns of the unknowns (…, q) from G transposed (3e, q) along both axes."""
        parts = [(column, x * G[0][rows] + y * G[1][rows]) for rows, column, x, y in self.parts]
        if parts and len(parts[0][0]) == self.columns:  # each column once, in order
            (_, result), *parts = parts
        else:
            result = np.zeros((self.columns, G[0].shape[1]))
        for column, its in parts:
            result[column] += its
        return result


class SystemRows(NamedTuple):
    """Some rows of the system, transposed: pieces (…, q) of A one below the other, and the b and b_i (s + n, q)."""

    at: slice
    left: list[Array]
    right: Array


@frozen
class System:
    """The equations of a body, A z + W s = b + Σ_i p_i b_i and Vᵀ z = 0.

    V are the k rigid motions that the conditions leave free, right null vectors of A; W the same motions at the
    collocation points. The slack s measures by how much the discrete equations and equilibrium disagree; it vanishes
    as the mesh is refined.

    Parameters
    ----------
    mesh, material, motions : of the body
    points : its unit pressures
    loadings : s loadings, each with a right side; they prescribe displacement and traction at the same places
    by_numba : whether machine code of numba, if installed, assembles the system; if None, it does if that is faster
    """

    mesh: Mesh
    material: Material
    points: UnitPressures
    motions: RigidMotions
    loadings: Sequence[Loading]
    by_numba: bool | None = None

    @property
    def values(self) -> BoundaryValues:
        """Prescribed values on the boundary."""
        return self.loadings[0].values

    def turned(self, turn: Array, first: "System") -> "System":
        """The equations in the frame of a congruent first body, into which (2, 2), x @ turn, turns loads and points."""
        loadings = [loading.turned(turn) for loading in self.loadings]
        return replace(first, points=self.points.turned(turn), loadings=loadings)

    @cached_property
    def influence(self) -> Influence:
        """The integrals, with columns of G for unknown tractions and pressures and the sum for known ones."""
        needed: BoolArray = np.asarray(self.values.traction_unknown.any(axis=1))
        needed[self.points.element] = True
        needed[self._sprung] = True
        jacobians = self.mesh.jacobians / self.length
        return Influence(
            mesh=self.mesh,
            poisson_ratio=self.material.effective_poisson_ratio,
            traction_elements=indices(needed),
            known=self._known_traction * jacobians[..., None],
        )

    @cached_property
    def machine_code(self) -> MachineCode | None:
        """The compiled function that assembles the system, if there is one and it is wanted."""
        wanted = self.by_numba
        if wanted is None:
            wanted = compilation.numba_is_imported() or self.mesh.degrees_of_freedom >= WORTH_COMPILING
        return machine_code() if wanted else None

    @property
    def notes(self) -> tuple[str, ...]:
        """What a user should know about how the system was assembled."""
        return () if self.machine_code is None else (BY_NUMBA,)

    @cached_property
    def unknowns(self) -> Unknowns:
        """The columns."""
        return number_unknowns(self.mesh, self.values)

    @cached_property
    def equations(self) -> SystemEquations:
        """The rows."""
        return place_equations(self.mesh, self.unknowns, self.influence.nodes)

    @property
    def size(self) -> int:
        """Number of rows and columns, those of the border included."""
        return self.unknowns.size + len(self.motions)

    @property
    def length(self) -> float:
        """L0 [L]."""
        return self.mesh.reference_length

    @property
    def stress(self) -> float:
        """The shear modulus [p]."""
        return self.material.shear_modulus

    @cached_property
    def _known_traction(self) -> Array:
        """Factor of G on the right (s, m, 3, 2): prescribed traction less that of the particular solution.

        Springs add to it at nodes with prescribed displacement.
        """
        known = np.array([item.values.traction - item.particular.traction for item in self.loadings])
        if len(self._sprung):
            at_nodes = [item.values.displacement[self.mesh.elements] for item in self.loadings]
            known += np.stack([*map(self.values.spring_traction, at_nodes)])
        return known / self.stress

    @cached_property
    def _known_displacement(self) -> Array:
        """Factor of F on the right (s, N, 2), with the sign that it has on the left."""
        given = [item.values.displacement - item.particular.displacement for item in self.loadings]
        return np.array(given) / self.length

    @cached_property
    def _jacobians(self) -> Array:
        """|dx/dξ| (e, 3) on the elements of `influence.traction_elements`, over L0."""
        return self.mesh.jacobians[self.influence.traction_elements] / self.length

    @cached_property
    def _unit_tractions(self) -> _Carried:
        """Traction times Jacobian for unit unknown tractions."""
        first = int((self.unknowns.displacement >= 0).sum())
        columns = self.unknowns.traction[self.influence.traction_elements] - first
        element, local, axis = np.nonzero(columns >= 0)
        return self._carried(element, local, columns[element, local, axis], AXES[axis], self.unknowns.size - first)

    @cached_property
    def _sprung(self) -> IntArray:
        """Elements with springs, ascending."""
        sprung: BoolArray = np.asarray(self.values.stiffness.reshape(-1, 12).any(axis=1))
        return indices(sprung)

    @cached_property
    def _springs(self) -> tuple[IntArray, IntArray, IntArray, Array]:
        """Elements, local nodes and columns (q,) of displacements with springs, and minus the tractions (q, 2) by each.

        None of these displacements is prescribed.
        """
        sprung = self._sprung
        if not len(sprung):
            return sprung, sprung, sprung, np.zeros((0, 2))
        K = self.values.stiffness[sprung] * (self.length / self.stress)
        columns = self.unknowns.displacement[self.mesh.elements[sprung]]
        number, local, axis = np.nonzero(K.any(axis=2) & (columns >= 0))
        return sprung[number], local, columns[number, local, axis], K[number, local, :, axis]

    @cached_property
    def _unit_displacements(self) -> _Carried:
        """Minus the traction of springs times Jacobian for unit displacements."""
        number, local, column, factors = self._springs
        element = np.searchsorted(self.influence.traction_elements, number)
        count = int((self.unknowns.displacement >= 0).sum())
        return self._carried(element, local, column, factors, count)

    @cached_property
    def _unit_pressures(self) -> _Carried:
        """Traction times Jacobian for unit pressures."""
        points = self.points
        element = np.searchsorted(self.influence.traction_elements, points.element)
        return self._carried(element, points.local, points.pressure, points.traction, len(points))

    def _carried(self, element: IntArray, local: IntArray, column: IntArray, factors: Array, columns: int) -> _Carried:
        """Jacobian times factors (q, 2) at (element, local node) pairs (q,) of columns (q,); several may be at one."""
        values = self._jacobians[element, local, None] * factors
        order = np.argsort(column, kind="stable")
        begins = np.searchsorted(column[order], column[order])
        number = np.arange(len(order)) - begins  # of a place among those of the same column
        rows, parts = local * len(self._jacobians) + element, []
        for some in (order[number == i] for i in range(number.max(initial=-1) + 1)):
            parts.append((rows[some], column[some], values[some, :1], values[some, 1:]))
        return _Carried(columns, parts)

    def rows(self, block: InfluenceRows) -> Iterator[SystemRows]:
        """Turn rows of F and G into rows of the system: the x equations of the block, then its y equations."""
        F = dict(zip(kernels.T_ORDER, block.F, strict=True))
        G = dict(zip(kernels.U_ORDER, block.G.reshape(3, -1, block.G.shape[-1]), strict=True))
        for axis in range(2):
            f, g = [F[axis, 0], F[axis, 1]], [G[0, axis], G[axis, 1]]
            index = self.equations.row[block.rows, axis]
            used = index >= 0
            if not used.any():
                continue
            if not used.all():
                f, g = ([part[:, used] for part in parts] for parts in (f, g))
            first = int(index[used][0])
            yield SystemRows(
                slice(first, first + int(used.sum())),
                [*self._left(f, g)],
                self._right(f, g, block.known[:, axis, used]),
            )

    def _left(self, F: Sequence[Array], G: Sequence[Array]) -> Iterator[Array]:
        """Columns of the unknowns: x displacements, y displacements, tractions."""
        first, springs = 0, None
        if len(self._sprung):
            springs = self._unit_displacements.times(G)
        for part, column in zip(F, self.unknowns.displacement.T, strict=True):
            free = column >= 0
            own = part if free.all() else part[free]
            yield own if springs is None else own + springs[first : first + len(own)]
            first += len(own)
        if self.values.traction_unknown.any():
            yield -self._unit_tractions.times(G)

    def _right(self, F: Sequence[Array], G: Sequence[Array], known: Array) -> Array:
        """The right sides b of each loading, and b_i (s + n, q); known tractions do `known` (s, q)."""
        u = self._known_displacement
        b = known - (u[..., 0] @ F[0] + u[..., 1] @ F[1]) if u.any() else known
        return np.concatenate([b, self._unit_pressures.times(G)])

    def flat_points(self) -> FlatPoints:
        """Collocation points with their rows, as machine code wants them."""
        return FlatPoints.of(self.equations.collocation, self.equations.row)

    def flat_integrals(self) -> tuple[FlatElements, FlatColumns, FlatRules, kernels.Factors]:
        """What machine code integrates, where it goes, and how."""
        return FlatElements.of(self.influence), self._flat_columns(), flat_rules(), self.influence.factors

    def _flat_columns(self) -> FlatColumns:
        """Columns of the matrix, then of the right sides."""
        jacobians = (self.mesh.jacobians / self.length)[..., None]
        sought, axis = np.nonzero((self.unknowns.traction >= 0).reshape(-1, 2))
        points = self.points
        element, local, displaced, springs = self._springs
        pressed = points.traction * jacobians[points.element, points.local]
        return FlatColumns.of(
            displacement=self.unknowns.displacement,
            known=-self._known_displacement,
            known_traction=self.influence.known,
            first_known=self.size,
            slot=np.concatenate([sought, 3 * points.element + points.local, 3 * element + local]),
            column=np.concatenate(
                [
                    self.unknowns.traction.reshape(-1, 2)[sought, axis],
                    self.size + len(self.loadings) + points.pressure,
                    displaced,
                ]
            ),
            traction=np.concatenate(
                [
                    -AXES[axis] * jacobians.reshape(-1, 1)[sought],
                    pressed,
                    springs * jacobians[element, local],
                ]
            ),
        )

    @cached_property
    def null_vectors(self) -> Array:
        """V (unknowns, k): the free motions as columns of unknowns."""
        V = np.zeros((self.unknowns.size, len(self.motions)))
        used = self.unknowns.displacement >= 0
        V[self.unknowns.displacement[used]] = self.motions.displacement(self.mesh.nodes)[used]
        return V

    @cached_property
    def border(self) -> Array:
        """W (unknowns, k): the free motions at the collocation points, as rows of equations."""
        points = self.equations.collocation.points * self.length
        at = points.view(float).reshape(-1, 2) + self.mesh.center
        W = np.zeros((self.unknowns.size, len(self.motions)))
        used = self.equations.row >= 0
        W[self.equations.row[used]] = self.motions.displacement(at)[used]
        return W

    def contact_last(self, like: Sequence["System"] = ()) -> tuple[IntArray, int]:
        """All columns (size,), those of the border and of displacements that change a gap last; how many these are.

        Also those that change a gap of congruent bodies, which have these equations too.
        """
        wanted = np.zeros(self.size, bool)
        wanted[self.unknowns.size :] = True
        for points in (self.points, *(other.points for other in like)):
            columns = self.unknowns.displacement[points.node]
            wanted[columns[(columns >= 0) & (points.change != 0)]] = True
        last = indices(wanted)
        return np.concatenate([indices(~wanted), last]), len(last)

    def fields(self, z: Array, loading: Loading | None) -> tuple[Array, Array]:
        """Displacement (N, 2) [L] and traction (m, 3, 2) [p] of unknowns z and all prescribed ones, less pressures.

        Without a loading, all prescribed ones are zero.
        """
        if loading is None:
            displacement, traction = np.zeros((len(self.mesh.nodes), 2)), np.zeros((len(self.mesh.elements), 3, 2))
        else:
            displacement, traction = loading.values.displacement.copy(), loading.values.traction.copy()
        sought = self.unknowns.displacement >= 0
        displacement[sought] = z[self.unknowns.displacement[sought]] * self.length
        if len(self._sprung):
            traction += self.values.spring_traction(displacement[self.mesh.elements])
        sought = self.unknowns.traction >= 0
        traction[sought] = z[self.unknowns.traction[sought]] * self.stress
        return displacement, traction
