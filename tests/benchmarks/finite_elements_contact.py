"""Plane strain and frictionless contact with a rigid surface by quadratic triangles; nothing of the package is used.

Small displacements, gaps and normals of the undeformed body. The body is condensed to the displacements of its
candidate nodes along the normals of the rigid surface; then an active set on gaps and nodal forces is solved.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.interpolate import CubicSpline
from scipy.sparse.linalg import SuperLU, splu
from skfem import Basis, ElementTriP2, ElementVector, MeshTri, MeshTri2, asm
from skfem.models.elasticity import lame_parameters, linear_elasticity

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Place = Callable[[Array, Array], Sequence[Array]]
Field = Callable[[Array, Array], Array]

ORDER = 6
"""Of the quadrature: 4 for straight elements, the rest for the curved ones."""
GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(5)
SHAPES = np.column_stack([GAUSS * (GAUSS - 1) / 2, 1 - GAUSS**2, GAUSS * (GAUSS + 1) / 2])
SLOPES = np.column_stack([GAUSS - 0.5, -2 * GAUSS, GAUSS + 0.5])
"""Of the nodes of a side, at its Gauss points."""
ON_SIDE = 1e-9
CHANGES = 60
"""Of the active set, before it counts as failed; ten are usual."""
OPEN_NODES = slice(1, 6)
"""Open nodes through which the gap is drawn to its zero; the first one is nearest to the singular edge of contact."""


def graded(*pieces: tuple[float, float, int, float], parts: int = 1) -> Array:
    """Element ends on a line.

    Parameters
    ----------
    pieces : (start, end, elements, size of the last element over the first), one after the other
    parts : each element is cut into so many equal ones
    """
    ends = [np.array([pieces[0][0]])]
    for start, end, elements, growth in pieces:
        sizes = growth ** np.linspace(0, 1, elements)
        coarse = np.append(0, np.cumsum(sizes)) / sizes.sum()
        fine = np.interp(np.arange(1, elements * parts + 1) / parts, np.arange(elements + 1), coarse)
        ends.append(start + (end - start) * fine)
    return np.concatenate(ends)


def mapped(s: Array, t: Array, place: Place) -> MeshTri2:
    """Quadratic triangles on a grid of two parameters, each node at its place (x, y)."""
    return curved(MeshTri.init_tensor(s, t), place)


def locally_refined(s: Array, t: Array, place: Place, length: Field) -> MeshTri2:
    """Quadratic triangles whose sides are no longer than a length(x, y) wanted around their middle.

    The triangles of a coarse grid of two parameters are bisected, and their neighbors with them.
    """
    flat, marked = MeshTri.init_tensor(s, t), np.zeros(1)
    while len(marked):
        ends = np.array(place(*flat.p))[:, flat.facets]
        too_long = np.hypot(*(ends[:, 0] - ends[:, 1])) > length(*ends.mean(axis=1))
        marked = np.flatnonzero(too_long[flat.t2f].any(axis=0))
        flat = flat.refined(marked) if len(marked) else flat
    return curved(flat, place)


def curved(flat: MeshTri, place: Place) -> MeshTri2:
    """Quadratic triangles with each node of a mesh of two parameters at its place (x, y)."""
    middles = flat.p[:, flat.facets].mean(axis=1)
    return MeshTri2(np.array(place(*np.hstack([flat.p, middles]))), flat.t)


@dataclass(frozen=True, kw_only=True, eq=False)
class ElasticBody:
    """A body in plane strain.

    Parameters
    ----------
    mesh : its triangles
    young_modulus : [p]
    poisson_ratio
    held : (level, axis): displacement along the axis is zero on the nodes where level(x, y) = 0
    order : of the quadrature
    """

    mesh: MeshTri2
    young_modulus: float
    poisson_ratio: float
    held: tuple[tuple[Field, int], ...] = ()
    order: int = ORDER

    @cached_property
    def basis(self) -> Basis:
        """The space of the displacement."""
        return Basis(self.mesh, ElementVector(ElementTriP2()), intorder=self.order)

    @cached_property
    def stiffness(self) -> sparse.csr_matrix:
        """K."""
        form = linear_elasticity(*lame_parameters(self.young_modulus, self.poisson_ratio))
        return asm(form, self.basis).tocsr()

    @cached_property
    def freedoms(self) -> IntArray:
        """The unknowns (2, n) that are displacement along x and y of each node."""
        return np.hstack([np.asarray(self.basis.nodal_dofs), np.asarray(self.basis.facet_dofs)])

    @cached_property
    def nodes(self) -> Array:
        """Their places (n, 2) [L]."""
        return self.basis.doflocs[:, self.freedoms[0]].T

    @cached_property
    def held_freedoms(self) -> IntArray:
        """Unknowns that are zero."""
        held = [self.freedoms[axis, np.unique(self.sides(level))] for level, axis in self.held]
        return np.concatenate([np.zeros(0, int), *held])

    def sides(self, level: Field) -> IntArray:
        """Nodes (m, 3), the middle one in between, of the sides on the boundary where level(x, y) = 0."""
        outer = self.mesh.boundary_facets()
        ends = np.asarray(self.mesh.facets)[:, outer]
        on = (abs(level(*self.mesh.p)) < ON_SIDE)[ends].all(axis=0)
        return np.column_stack([ends[0], self.mesh.nvertices + outer, ends[1]])[on]

    def along_sides(self, sides: IntArray) -> Array:
        """Length (m, q) [L] that belongs to each Gauss point of sides (m, 3)."""
        tangents = np.einsum("qi,mix->mqx", SLOPES, self.nodes[sides])
        return WEIGHTS * np.hypot(tangents[..., 0], tangents[..., 1])

    def traction(self, level: Field, value: Sequence[float]) -> Array:
        """Nodal forces of a uniform traction (2,) [p] on a side."""
        sides, load = self.sides(level), np.zeros(self.freedoms.size)
        lengths = self.along_sides(sides) @ SHAPES
        for axis in (0, 1):
            np.add.at(load, self.freedoms[axis, sides], value[axis] * lengths)
        return load

    def side_mass(self, sides: IntArray, nodes: IntArray) -> Array:
        """∫ N_i N_j ds [L] of the nodes (n,) of sides (m, 3)."""
        place = np.zeros(len(self.nodes), int)
        place[nodes] = np.arange(len(nodes))
        mass, row = np.zeros((len(nodes), len(nodes))), place[sides]
        np.add.at(
            mass,
            (row[:, :, None], row[:, None, :]),
            np.einsum("mq,qi,qj->mij", self.along_sides(sides), SHAPES, SHAPES),
        )
        return mass

    def deflection(self, load: Array) -> Array:
        """Displacement (n, 2) [L] under nodal forces without contact."""
        inner = np.setdiff1d(np.arange(len(load)), self.held_freedoms)
        u = np.zeros(len(load))
        u[inner] = factorized(self.stiffness[inner][:, inner]).solve(load[inner])
        return u[self.freedoms].T


def factorized(matrix: sparse.csr_matrix) -> SuperLU:
    """LU of a symmetric positive definite matrix."""
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


@dataclass(frozen=True, kw_only=True, eq=False)
class Touch:
    """Contact on one mesh. The n nodes of the candidate side are in the order of their coordinate.

    Parameters
    ----------
    coordinate : (n,) along the candidate side
    candidate : (n,) whether the node may come off: held ones may not
    lengths : ((n - 1) / 2, 3) ∫ N_i ds [L] of the nodes of each side of a triangle
    pressure : (n,) per undeformed length [p]; zero at held nodes
    gap : (n,) [L]
    force : (2,) of the rigid surface on the body [p L]
    nodes, displacement : (N, 2) of the whole body [L]
    """

    coordinate: Array
    candidate: NDArray[np.bool_]
    lengths: Array
    pressure: Array
    gap: Array
    force: Array
    nodes: Array
    displacement: Array

    def pressure_at(self, coordinate: Array) -> Array:
        """Pressure (k,) [p], as the slope of the force on the side up to there.

        Nodal pressures alternate between corners and middles of triangles; the force over whole sides does not.
        """
        ends, sides = self.coordinate[::2], 2 * np.arange(len(self.lengths))[:, None] + np.arange(3)
        force = np.append(0, np.cumsum(np.sum(self.lengths * self.pressure[sides], axis=1)))
        length = np.append(0, np.cumsum(np.sum(self.lengths, axis=1)))
        return CubicSpline(ends, force)(coordinate, 1) / CubicSpline(ends, length)(coordinate, 1)

    def ends(self) -> Array:
        """Both ends of contact in the coordinate: the zero of gap^(2/3), straight beyond it, or a side's end."""
        touching = np.flatnonzero(self.pressure > 0)
        return np.array([self._end(touching[0], -1), self._end(touching[-1], 1)])

    def _end(self, last: int, step: int) -> float:
        """End of contact beyond the last node that touches."""
        beyond = np.arange(last + step, len(self.gap) if step > 0 else -1, step)
        opened = beyond[self.candidate[beyond]][OPEN_NODES]
        if len(opened) < 2:
            return float(self.coordinate[-1 if step > 0 else 0])
        slope, value = np.polyfit(self.coordinate[opened], np.maximum(self.gap[opened], 0) ** (2 / 3), 1)
        return float(-value / slope)

    def displacement_at(self, point: Sequence[float]) -> Array:
        """Displacement (2,) of a node [L]."""
        return self.displacement[node_at(self.nodes, point)]


def node_at(nodes: Array, point: Sequence[float]) -> int:
    """The node of (n, 2) at a point; it has to be there."""
    distance = np.hypot(*(nodes - np.array(point)).T)
    nearest = int(np.argmin(distance))
    if distance[nearest] > 1e-6 * np.ptp(nodes):
        raise ValueError(f"no node at {tuple(point)}; the nearest is {distance[nearest]:.3g} away")
    return nearest


def press(
    body: ElasticBody, load: Array, side: Field, coordinate: Field, normal: Place, gap: Callable[[IntArray], Array]
) -> Touch:
    """Press a body on a rigid frictionless surface.

    Parameters
    ----------
    body, load : with its nodal forces
    side : where the candidate side is, as a level(x, y) = 0
    coordinate : of points (x, y), increasing along the side
    normal : unit normal (nx, ny) of the rigid surface at points (x, y), from the surface into the body
    gap : initial gap [L] of nodes, by their numbers
    """
    sides = body.sides(side)
    nodes = np.unique(sides)
    along = coordinate(*body.nodes[nodes].T)
    order = np.argsort(along)
    nodes, along = nodes[order], along[order]
    normals = np.column_stack(normal(*body.nodes[nodes].T))
    turned, freedom = local_axes(body, nodes, normals)
    candidate = ~np.isin(freedom, body.held_freedoms)
    epsilon = gap(nodes)
    u, force = contact_state(body.stiffness, body.held_freedoms, load, turned, freedom[candidate], epsilon[candidate])
    nodal = np.zeros(len(nodes))
    nodal[candidate] = force
    displacement = (turned @ u)[body.freedoms].T
    return Touch(
        coordinate=along,
        candidate=candidate,
        lengths=body.along_sides(nodes[2 * np.arange(len(sides))[:, None] + np.arange(3)]) @ SHAPES,
        pressure=pressures(body.side_mass(sides, nodes), nodal),
        gap=epsilon + np.sum(normals * displacement[nodes], axis=1),
        force=nodal @ normals,
        nodes=body.nodes,
        displacement=displacement,
    )


def local_axes(body: ElasticBody, nodes: IntArray, normals: Array) -> tuple[sparse.csr_matrix, IntArray]:
    """Turn the unknowns of nodes: displacement along the normal takes the place of the axis that is nearest to it.

    Returns
    -------
    Q : u = Q u', orthogonal
    freedom : (n,) the unknown of u' along each normal
    """
    axis = np.argmax(abs(normals), axis=1)
    freedom, other = body.freedoms[axis, nodes], body.freedoms[1 - axis, nodes]
    held = np.isin(freedom, body.held_freedoms) | np.isin(other, body.held_freedoms)
    if held.any() and abs(normals[held]).max(axis=1).min() < 1 - 1e-12:
        raise ValueError("a held node of the candidate side needs a normal along an axis")
    x, y = body.freedoms[:, nodes]
    columns = np.concatenate([freedom, other, freedom, other])
    values = np.concatenate([normals[:, 0], -normals[:, 1], normals[:, 1], normals[:, 0]])
    size = body.freedoms.size
    rest = np.setdiff1d(np.arange(size), np.concatenate([x, y]))
    rows = np.concatenate([x, x, y, y, rest])
    entries = (np.append(values, np.ones(len(rest))), (rows, np.append(columns, rest)))
    return sparse.csr_matrix(entries, shape=(size, size)), freedom


def contact_state(
    stiffness: sparse.csr_matrix, held: IntArray, load: Array, turned: sparse.csr_matrix, freedom: IntArray, gap: Array
) -> tuple[Array, Array]:
    """Displacement u' of all unknowns, of which some are held, and forces along the normals of the candidates.

    S u_n = g + force is what is left of K' u' = f' when all unknowns but those along the normals are eliminated.
    """
    stiffness, f = (turned.T @ stiffness @ turned).tocsr(), turned.T @ load
    inner = np.setdiff1d(np.arange(len(f)), np.concatenate([held, freedom]))
    lu, coupling = factorized(stiffness[inner][:, inner]), stiffness[freedom][:, inner]
    S = stiffness[freedom][:, freedom].toarray() - coupling @ lu.solve(coupling.T.toarray())
    g = f[freedom] - coupling @ lu.solve(f[inner])
    normal_displacement, force = active_set(S, g, gap)
    u = np.zeros(len(f))
    u[freedom] = normal_displacement
    u[inner] = lu.solve(f[inner] - coupling.T @ normal_displacement)
    return u, force


def active_set(S: Array, g: Array, gap: Array) -> tuple[Array, Array]:
    """Find u and force = S u - g with gap + u >= 0, force >= 0, and one of them zero at each node."""
    active = np.ones(len(g), bool)
    for _ in range(CHANGES):
        u = -gap.copy()
        free = np.flatnonzero(~active)
        u[free] = np.linalg.solve(S[np.ix_(free, free)], g[free] + S[np.ix_(free, active)] @ gap[active])
        force = S @ u - g
        force[free] = 0.0
        now = force > np.diag(S) * np.where(active, 0.0, gap + u)
        if (now == active).all():
            return u, force
        active = now
    raise RuntimeError(f"the active set still changes after {CHANGES} steps")


def pressures(mass: Array, force: Array) -> Array:
    """Pressure p = Σ p_i N_i over the nodes that touch, with ∫ p N_i ds = force_i."""
    touching = np.flatnonzero(force > 0)
    p = np.zeros(len(force))
    p[touching] = np.linalg.solve(mass[np.ix_(touching, touching)], force[touching])
    return p
