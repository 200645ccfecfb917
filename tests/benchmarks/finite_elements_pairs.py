"""Frictionless contact of two elastic bodies by quadratic triangles; nothing of the package is used.

Plane strain and small displacements. The nodes of both sides are matched: each node of body A is on the normal of a
pair with one of body B. This normal, from B into A, is the mean of those of both boundaries with their moduli as
weights. The unknown of A along it gives way to the one relative to B, on which the contact of one body with a rigid
surface is solved as before.
"""

from dataclasses import dataclass

import numpy as np
from finite_elements_bodies import along_x, rectangle_ray, upwards
from finite_elements_contact import (
    SHAPES,
    Array,
    ElasticBody,
    Field,
    IntArray,
    Place,
    Touch,
    contact_state,
    graded,
    local_axes,
    mapped,
    pressures,
)
from scipy import sparse

MATCHED = 1e-9
"""Distance of a node from the normal of its pair, over the size of its body, that is round-off."""


@dataclass(frozen=True, kw_only=True)
class Side:
    """A body with its loads and the side of it that may touch the other one.

    Parameters
    ----------
    body, load : with its nodal forces
    level : where the side is, as a level(x, y) = 0
    coordinate : of points (x, y), increasing along the side; pairs have the same order on both sides
    """

    body: ElasticBody
    load: Array
    level: Field
    coordinate: Field

    def nodes(self) -> IntArray:
        """Nodes of the side in the order of their coordinate."""
        nodes = np.unique(self.body.sides(self.level))
        return nodes[np.argsort(self.coordinate(*self.body.nodes[nodes].T))]


def press_together(a: Side, b: Side, normal: Place) -> Touch:
    """Press two elastic bodies together.

    Parameters
    ----------
    a, b : bodies with their sides
    normal : unit normal (nx, ny) of the pairs of the nodes (x, y) of A, from B into A

    Returns
    -------
    Contact as body A has it: coordinates, pressure per length, force and displacement are those of A.
    """
    at, there = a.nodes(), b.nodes()
    normals = np.column_stack(normal(*a.body.nodes[at].T))
    gap = gaps(a.body.nodes[at], b.body.nodes[there], normals)
    turned_a, freedom = local_axes(a.body, at, normals)
    turned_b, opposite = local_axes(b.body, there, normals)
    opposite = opposite + a.body.freedoms.size
    stiffness = side_by_side(a.body.stiffness, b.body.stiffness)
    held = np.concatenate([a.body.held_freedoms, b.body.held_freedoms + a.body.freedoms.size])
    if np.isin(np.append(freedom, opposite), held).any():
        raise ValueError("a node of a pair is held along its normal")
    to_pairs = relative(freedom, opposite, len(a.load) + len(b.load))
    turned = side_by_side(turned_a, turned_b).dot(to_pairs)
    u, force = contact_state(stiffness, held, np.append(a.load, b.load), turned, freedom, gap)
    displacement = turned @ u
    sides = a.body.sides(a.level)
    return Touch(
        coordinate=a.coordinate(*a.body.nodes[at].T),
        candidate=np.ones(len(at), bool),
        lengths=a.body.along_sides(at[2 * np.arange(len(sides))[:, None] + np.arange(3)]) @ SHAPES,
        pressure=pressures(a.body.side_mass(sides, at), force),
        gap=gap + u[freedom],
        force=force @ normals,
        nodes=a.body.nodes,
        displacement=displacement[a.body.freedoms].T,
    )


def side_by_side(of_a: sparse.csr_matrix, of_b: sparse.csr_matrix) -> sparse.csr_matrix:
    """Matrix of both bodies, without coupling."""
    return sparse.csr_matrix(sparse.block_diag([of_a, of_b], format="csr"))


def relative(freedom: IntArray, opposite: IntArray, size: int) -> sparse.csr_matrix:
    """T with u = T w, where the unknown of A along a normal is that of w plus the one of B."""
    diagonal = np.arange(size)
    rows, columns = np.append(diagonal, freedom), np.append(diagonal, opposite)
    return sparse.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(size, size))


def gaps(nodes: Array, opposite: Array, normals: Array) -> Array:
    """Gap (n,) [L] between nodes (n, 2) and those opposite, which have to be on their normals (n, 2)."""
    if nodes.shape != opposite.shape:
        raise ValueError(f"{len(nodes)} nodes are opposite to {len(opposite)}")
    between = nodes - opposite
    beside = abs(between[:, 0] * normals[:, 1] - between[:, 1] * normals[:, 0]).max()
    if beside > MATCHED * np.ptp(nodes):
        raise ValueError(f"a node is {beside:.3g} beside the normal of its pair")
    return np.sum(between * normals, axis=1)


PAIR_STEPS = 60
"""Steps to the pair of a point on a circle. Each is closer by the clearance over the radius."""


def common_normal(first: Array, second: Array, share: float) -> Array:
    """Mean unit normal (n, 2) upwards of two circles at angles (n,) from their lowest points, by share of the first."""
    mean = np.array([-share * np.sin(first) - (1 - share) * np.sin(second),
                     share * np.cos(first) + (1 - share) * np.cos(second)])  # fmt: skip
    return (mean / np.hypot(*mean)).T


def on_circle(angle: Array, radius: float, center: float) -> Array:
    """Points (n, 2) of a circle around (0, center) at angles (n,) from its lowest point."""
    return np.column_stack([radius * np.sin(angle), center - radius * np.cos(angle)])


def beside(first: Array, second: Array, pin: tuple[float, float], hole: tuple[float, float], share: float) -> Array:
    """How far (n,) points of a pin at angles (n,) are beside common normals through points of a hole; to the right."""
    normal, between = common_normal(first, second, share), on_circle(first, *pin) - on_circle(second, *hole)
    return normal[:, 1] * between[:, 0] - normal[:, 0] * between[:, 1]


def horizontal(level: float) -> Field:
    return lambda x, y: y - level


def up_to(level: Field, coordinate: Field, end: float) -> Field:
    """A side up to a coordinate."""
    return lambda x, y: np.where(coordinate(x, y) < end + 1e-9 * abs(end), level(x, y), 1.0)


def around(end: float, reach: float) -> list[tuple[float, float, int, float]]:
    """Pieces of a graded side up to where candidates end, small where contact is expected to end to 1.5 %.

    The active set ends at a node, and the end of contact drawn from the gaps is off by a tenth of an element.
    """
    low, high = 0.985 * end, 1.015 * end
    return [(0, 0.85 * end, 14, 0.35), (0.85 * end, low, 10, 0.1), (low, high, 12, 1), (high, reach, 14, 60)]


def depths(end: float, size: float, parts: int) -> Array:
    """Element ends from 0 to 1 below a contact of half-width `end` on a body of this size."""
    near = min(1.5 * end / size, 0.4)
    return graded((0, near, 13, 20), (near, 1, 11, 6), parts=parts)


def quarter_of_cylinder(radius: float, center: float) -> Place:
    """Place of an angle in degrees from the lowest point and a depth, for a quarter with its center at (0, y)."""

    def place(s: Array, t: Array) -> tuple[Array, Array]:
        x, y = radius * np.sin(np.radians(s)), center - radius * np.cos(np.radians(s))
        return x + t * (radius / 2 * s / 90 - x), y + t * (center - y)

    return place


def roller_on_block(
    parts: int, *, radius: float, moduli: tuple[float, float], width: float, height: float, load: float, end: float
) -> Touch:
    """A quarter of a roller under a uniform traction on its horizontal diameter, on half a block; ν = 0.3 in both.

    Parameters
    ----------
    parts : into which elements are cut
    moduli : of roller and block [p]
    width, height : of half the block [L]
    load : on the quarter, per thickness [p L]
    end : expected half-width [L]
    """
    to = float(np.degrees(np.arcsin(end / radius)))
    reach = 2 * to
    angle = graded(*around(to, reach), (reach, 90, 16, 6), parts=parts)
    roller = ElasticBody(
        mesh=mapped(angle, depths(end, radius, parts), quarter_of_cylinder(radius, radius)),
        young_modulus=moduli[0], poisson_ratio=0.3, held=((along_x, 0),),
    )  # fmt: skip
    share, foot = moduli[0] / sum(moduli), radius * np.sin(np.radians(reach))

    def normal(x: Array, y: Array) -> tuple[Array, Array]:
        angle = np.arctan2(x, radius - y)
        return tuple(common_normal(angle, np.zeros_like(angle), share).T)

    def across(s: Array) -> Array:
        x, y = quarter_of_cylinder(radius, radius)(np.minimum(s, reach), np.zeros_like(s))
        nx, ny = normal(x, y)
        inside = x - y * nx / ny
        return inside + (width - inside) * np.maximum(s - reach, 0)

    along = np.append(angle[angle <= reach + 1e-9], reach + graded((0, 1, 14, 40), parts=parts)[1:])
    block = ElasticBody(
        mesh=mapped(along, depths(end, height, parts), lambda s, t: (across(s), -height * t)),
        young_modulus=moduli[1], poisson_ratio=0.3, held=((along_x, 0), (horizontal(-height), 1)),
    )  # fmt: skip
    under = up_to(lambda x, y: np.where(y < radius - 1e-6, np.hypot(x, y - radius) - radius, 1.0), along_x, foot)
    face = up_to(horizontal(0.0), along_x, float(across(np.array([reach]))[0]))
    pushed = roller.traction(horizontal(radius), (0, -load / radius))
    return press_together(
        Side(body=roller, load=pushed, level=under, coordinate=along_x),
        Side(body=block, load=np.zeros(block.freedoms.size), level=face, coordinate=along_x),
        normal,
    )


def from_bottom(center: float) -> Field:
    """Angle in degrees from straight below a center (0, y)."""
    return lambda x, y: np.degrees(np.arctan2(x, center - y))


def pin_in_plate(parts: int, *, clearance: float, load: float, end: float) -> Touch:
    """The lower quarter of a pin under a uniform traction on its horizontal diameter, in half a plate with a hole.

    The pin has the radius 10, its center at (0, -clearance) and E = 210e3; the plate |x|, |y| <= 40 has the radius
    10 + clearance around (0, 0) and E = 70e3, and hangs from its upper edge; ν = 0.3. Coordinates are angles in degrees
    from the lowest point, seen from the center of the hole.

    Parameters
    ----------
    parts : into which elements are cut
    clearance : of the radii [L]
    load : on the quarter, per thickness [p L]
    end : expected half angle in degrees
    """
    hole = 10 + clearance
    reach = min(2 * end, (end + 90) / 2)
    near = with_corner(around(end, reach), 45.0, parts)

    circles, share = ((10.0, -clearance), (hole, 0.0)), 210e3 / (210e3 + 70e3)

    def of_pin(angle: Array) -> Array:
        """Angle at the center of the pin of the pair of what is at an angle at that of the hole, both in degrees."""
        there = np.radians(angle)
        own = there.copy()
        for _ in range(PAIR_STEPS):
            own -= beside(own, there, *circles, share) / 10
        return np.degrees(own)

    last = float(of_pin(np.array([reach]))[0])

    def own(s: Array) -> Array:
        return np.where(
            s <= reach, of_pin(np.minimum(s, reach).ravel()).reshape(s.shape), last + (90 - last) * (s - reach)
        )

    rest = graded((0, 1, 10, 2), parts=parts)[1:]
    quarter, deep = quarter_of_cylinder(10, -clearance), depths(10 * np.radians(end), 10, parts)
    pin = ElasticBody(
        mesh=mapped(np.append(near, reach + rest), deep, lambda s, t: quarter(own(s), t)),
        young_modulus=210e3, poisson_ratio=0.3, held=((along_x, 0),),
    )  # fmt: skip

    def ray(s: Array, t: Array) -> tuple[Array, Array]:
        turn = np.radians(s)
        x, y = hole * np.sin(turn), -hole * np.cos(turn)
        x = np.where(s == 180, 0.0, x)
        out_x, out_y = rectangle_ray(turn - np.pi / 2, 40, 40)
        out_y = np.where(abs(abs(out_y) - 40) < 1e-9, np.copysign(40, out_y), out_y)
        out_x = np.where((s == 180) | (s == 0), 0.0, out_x)
        return x + t * (out_x - x), y + t * (out_y - y)

    far = [(reach, 45.0, 6, 2), (45.0, 135.0, 14, 1)] if reach < 45 else [(reach, 135.0, 12, 2)]
    angle = np.append(near, graded(*far, (135.0, 180.0, 6, 1), parts=parts)[1:])
    plate = ElasticBody(
        mesh=mapped(angle, depths(10 * np.radians(end), 30, parts), ray),
        young_modulus=70e3, poisson_ratio=0.3, held=((along_x, 0), (horizontal(40.0), 1)),
    )  # fmt: skip
    seen = from_bottom(0.0)

    def normal(x: Array, y: Array) -> tuple[Array, Array]:
        own = np.arctan2(x, -clearance - y)
        there = own.copy()
        for _ in range(PAIR_STEPS):
            there += beside(own, there, *circles, share) / hole
        return tuple(common_normal(own, there, share).T)

    return press_together(
        Side(
            body=pin,
            load=pin.traction(horizontal(-clearance), (0, -load / 10)),
            level=up_to(lambda x, y: np.hypot(x, y + clearance) - 10, from_bottom(-clearance), last),
            coordinate=seen,
        ),
        Side(
            body=plate,
            load=np.zeros(plate.freedoms.size),
            level=up_to(lambda x, y: np.hypot(x, y) - hole, seen, reach),
            coordinate=seen,
        ),
        normal,
    )


def with_corner(pieces: list[tuple[float, float, int, float]], corner: float, parts: int) -> Array:
    """Graded element ends where the nearest one of the first mesh, if any is beyond, is moved to a corner."""
    coarse = graded(*pieces)
    if coarse[-1] > corner:
        nearest = np.argmin(abs(coarse[1:-1] - corner)) + 1
        coarse[nearest] = corner
    return np.interp(np.arange((len(coarse) - 1) * parts + 1) / parts, np.arange(len(coarse)), coarse)


def layer_on_block(parts: int, *, pressure: float, end: float) -> Touch:
    """Half a layer of 10 by 1 with E = 1000 on half a block of 10 by 10 with E = 2000; ν = 0.3 in both.

    The layer is pressed from x = 0 to 0.5; `end` is where contact is expected to end.
    """
    reach = 2 * end
    x = graded((0, 0.5, 8, 0.5), (0.5, 0.85 * end, 8, 0.5), *around(end, reach)[1:], (reach, 10, 14, 4), parts=parts)
    layer = ElasticBody(
        mesh=mapped(x, graded((0, 0.5, 10, 3), (0.5, 1, 10, 1 / 3), parts=parts), lambda s, t: (s, t)),
        young_modulus=1e3, poisson_ratio=0.3, held=((along_x, 0),),
    )  # fmt: skip
    base = ElasticBody(
        mesh=mapped(x, depths(end, 10, parts), lambda s, t: (s, -10 * t)),
        young_modulus=2e3, poisson_ratio=0.3, held=((along_x, 0), (horizontal(-10.0), 1)),
    )  # fmt: skip
    face = up_to(horizontal(0.0), along_x, reach)
    pressed = up_to(horizontal(1.0), along_x, 0.5)
    return press_together(
        Side(body=layer, load=layer.traction(pressed, (0, -pressure)), level=face, coordinate=along_x),
        Side(body=base, load=np.zeros(base.freedoms.size), level=face, coordinate=along_x),
        upwards,
    )
