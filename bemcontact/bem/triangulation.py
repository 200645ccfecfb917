"""Triangles that fill the body, for pictures and files of what happens inside; nothing is computed with them."""

import numpy as np
from scipy.spatial import Delaunay, KDTree

from bemcontact.arrays import Array, BoolArray, IntArray, magnitudes
from bemcontact.bem import reference_element
from bemcontact.bem.mesh import Mesh
from bemcontact.frozen import frozen

PIECES = 2
"""Pieces into which each element is cut at first."""
GROWTH = 0.25
"""Growth of the triangles with the distance from the boundary."""
LARGEST = 1 / 20
"""Largest size of a triangle over the diameter of the body."""
CLEAR = 0.45
"""Least distance of an inner point from the boundary over the size of its cell."""
ROUNDS = 12
"""Largest number of times that pieces of the boundary are halved until triangles have them as sides."""
FLAT = 1e-6
"""Height of a triangle over its longest side below which it is left out: its corners lie on one straight edge."""


@frozen
class Triangulation:
    """Triangles that fill the body; the first b points lie on the boundary.

    Parameters
    ----------
    points : (k, 2) [L]
    triangles : (t, 3) points, counterclockwise
    element, xi : (b,) boundary element and local coordinate of each point on the boundary
    """

    points: Array
    triangles: IntArray
    element: IntArray
    xi: Array


@frozen
class _Pieces:
    """Pieces of boundary: element (b,), local coordinates (b, 2) of both ends, and the piece (b,) that follows."""

    mesh: Mesh
    element: IntArray
    ends: Array
    after: IntArray

    @property
    def points(self) -> Array:
        """First points (b, 2) of the pieces."""
        return points_on(self.mesh, self.element, self.ends[:, 0])

    def halved(self, wanted: BoolArray) -> "_Pieces":
        """Cut the wanted pieces (b,) in two."""
        halves, middle = np.flatnonzero(wanted), self.ends[wanted].mean(axis=1)
        ends, after = self.ends.copy(), self.after.copy()
        second = np.column_stack([middle, ends[halves, 1]])
        ends[halves, 1] = middle
        after[halves] = len(ends) + np.arange(len(halves))
        return _Pieces(
            mesh=self.mesh,
            element=np.append(self.element, self.element[halves]),
            ends=np.vstack([ends, second]),
            after=np.append(after, self.after[halves]),
        )


def triangulation(mesh: Mesh) -> Triangulation:
    """Fill the body with triangles that are as small as the elements at the boundary, and grow away from it.

    The sides on the boundary are pieces of elements. A piece that is no side of a Delaunay triangle is halved until it
    is, as in Ruppert's refinement (J. Algorithms 18 (1995) 548-585). Points that are as close as round-off to another
    one are in no triangle, and their pieces are not halved.
    """
    m = len(mesh.elements)
    follows = np.empty(m, int)
    follows[mesh.before] = np.arange(m)
    ends = np.linspace(-1.0, 1.0, PIECES + 1)
    number = PIECES * np.arange(m)[:, None] + np.arange(PIECES)
    pieces = _Pieces(
        mesh=mesh,
        element=np.repeat(np.arange(m), PIECES),
        ends=np.tile(np.column_stack([ends[:-1], ends[1:]]), (m, 1)),
        after=np.column_stack([number[:, 1:], PIECES * follows]).ravel(),
    )
    rim, points, triangles, merged = _delaunay(pieces)
    for _ in range(ROUNDS):
        missing = ~(_are_sides(triangles, pieces.after) | merged | merged[pieces.after])
        if not missing.any():
            break
        pieces = pieces.halved(missing)
        rim, points, triangles, merged = _delaunay(pieces)
    corners = points[triangles]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    doubled = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    longest = magnitudes(corners - np.roll(corners, 1, axis=1)).max(axis=1)
    triangles = np.where(doubled[:, None] < 0, triangles[:, ::-1], triangles)
    kept = (abs(doubled) > FLAT * longest**2) & within(corners.mean(axis=1), rim, rim[pieces.after])
    return Triangulation(points=points, triangles=triangles[kept], element=pieces.element, xi=pieces.ends[:, 0])


def _delaunay(pieces: _Pieces) -> tuple[Array, Array, IntArray, BoolArray]:
    """Points (b, 2) of the pieces, all points (k, 2), Delaunay triangles (t, 3), and which (b,) are in none."""
    rim = pieces.points
    points = np.vstack([rim, _inner_points(pieces, rim)])
    triangles = Delaunay(points - pieces.mesh.center).simplices.astype(int)
    return rim, points, triangles, ~np.isin(np.arange(len(rim)), triangles)


def points_on(mesh: Mesh, element: IntArray, xi: Array) -> Array:
    """Points (k, 2) [L] at local coordinates ξ (k,) of elements (k,)."""
    shapes = reference_element.values(xi)
    middle = mesh.nodes[mesh.elements[element, 1]]
    return middle + np.einsum("ki,kij->kj", shapes, mesh.nodes[mesh.elements[element]] - middle[:, None])


def within(points: Array, starts: Array, ends: Array) -> BoolArray:
    """Whether points (k, 2) are inside a polygon of sides (b, 2) to (b, 2): a ray to the right crosses it oddly."""
    inside = np.zeros(len(points), bool)
    for block in np.array_split(np.arange(len(points)), max(1, len(points) * len(starts) // 10**6)):
        x, y = points[block, 0, None], points[block, 1, None]
        crosses = (starts[:, 1] > y) != (ends[:, 1] > y)
        with np.errstate(divide="ignore", invalid="ignore"):  # sides along the ray do not cross it
            at = starts[:, 0] + (y - starts[:, 1]) / (ends[:, 1] - starts[:, 1]) * (ends[:, 0] - starts[:, 0])
        inside[block] = np.count_nonzero(crosses & (x < at), axis=1) % 2 == 1
    return inside


def _inner_points(pieces: _Pieces, rim: Array) -> Array:
    """Middles (k, 2) of the cells of a quadtree that are inside, and as large as the boundary near them allows."""
    lengths = np.hypot(*(rim[pieces.after] - rim).T)
    middles = (rim + rim[pieces.after]) / 2
    tree = KDTree(middles)
    low, high = rim.min(axis=0), rim.max(axis=0)
    size, kept = float((high - low).max()), list[Array]()
    cells = ((low + high) / 2)[None]
    largest = LARGEST * float(np.hypot(*(high - low)))
    while len(cells):
        distance, nearest = tree.query(cells)
        small = size <= np.minimum(lengths[nearest] + GROWTH * distance, largest)
        fits = small & (distance > CLEAR * size + lengths[nearest] / 4)
        if fits.any():
            kept.append(cells[fits][within(cells[fits], rim, rim[pieces.after])])
        split = cells[~small & ~((distance > size + lengths[nearest]) & ~within(cells, rim, rim[pieces.after]))]
        size /= 2
        steps = size / 2 * np.array([(-1, -1), (1, -1), (-1, 1), (1, 1)])
        cells = (split[:, None] + steps).reshape(-1, 2)
    return np.concatenate(kept) if kept else np.empty((0, 2))


def _are_sides(triangles: IntArray, after: IntArray) -> BoolArray:
    """Whether a triangle has the side from each point (b,) of the boundary to the next one."""
    sides = np.sort(np.concatenate([triangles[:, :2], triangles[:, 1:], triangles[:, ::2]]), axis=1)
    wanted = np.sort(np.column_stack([np.arange(len(after)), after]), axis=1)
    count = int(triangles.max()) + 1
    return np.isin(wanted[:, 0] * count + wanted[:, 1], sides[:, 0] * count + sides[:, 1])
