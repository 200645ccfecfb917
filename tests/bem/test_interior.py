"""Stress and displacement inside a body: patch test, rigid motions, orders of convergence, equilibrium."""

from itertools import pairwise

import numpy as np
import pytest
from bodies import MESHES, arc, even, mesh_of, rectangle, solved, values_of
from stress_states import CONSTANT, SMOOTH, below, exact_fields, fields_of, stress_at

from bemcontact.bem.interior import Interior
from bemcontact.bem.mesh import Mesh
from bemcontact.problems.material import Material

MATERIAL = Material(young_modulus=3.0, poisson_ratio=0.3)
DEPTHS = [0.1, 1e-3, 1e-6, 1e-8]


def inside(points: np.ndarray, mesh: Mesh) -> np.ndarray:
    interior = Interior(mesh=mesh, poisson_ratio=0.3)
    return interior.nearest(interior.z(points)).inside


def off_boundary(points: np.ndarray, mesh: Mesh) -> np.ndarray:
    """Those of some points that are inside and have no other part of the boundary on them."""
    interior = Interior(mesh=mesh, poisson_ratio=0.3)
    found = interior.nearest(interior.z(points))
    return points[found.inside & (found.distance > 1e-13)]


@pytest.mark.parametrize("depth", DEPTHS)
@pytest.mark.parametrize("name", MESHES)
def test_constant_stress_at_any_depth(name: str, depth: float):
    """Patch test below middles, ends and the rest of elements: exact up to round-off of u over the shortest element."""
    mesh = mesh_of(*MESHES[name])
    fields = exact_fields(mesh, MATERIAL, CONSTANT)
    points = off_boundary(np.vstack([below(mesh, local, depth) for local in (-1, -0.999, -0.5, 0, 0.7, 1)]), mesh)
    assert len(points) > 4 * len(mesh.elements)
    true = CONSTANT.stress(points)
    assert abs(stress_at(points, mesh, MATERIAL, fields) - true).max() < 1e-10 * abs(true).max()
    interior = Interior(mesh=mesh, poisson_ratio=MATERIAL.effective_poisson_ratio)
    u = interior.displacement(interior.z(points), fields)[:, 0] * mesh.reference_length
    expected = CONSTANT.displacement(points, MATERIAL)
    assert abs(np.column_stack([u.real, u.imag]) - expected).max() < 1e-13 * abs(expected).max()


@pytest.mark.parametrize("depth", DEPTHS)
def test_constant_stress_in_corners(depth: float):
    """Along the bisectors of the four corners of a rectangle, on a mesh with lengths 1:35."""
    mesh = mesh_of(*MESHES["rectangle, lengths 1:35"])
    center, corners = np.array([1, 0.5]), np.array([[0, 0], [2, 0], [2, 1], [0, 1]], float)
    points = corners + depth * 2 / 144 * np.sign(center - corners)
    error = stress_at(points, mesh, MATERIAL, exact_fields(mesh, MATERIAL, CONSTANT)) - CONSTANT.stress(points)
    assert abs(error).max() < 1e-10


def test_constant_stress_of_a_nearly_incompressible_body():
    """No digits are lost to the bulk modulus, a million times the shear modulus."""
    material = Material(young_modulus=3.0, poisson_ratio=0.4999995)
    mesh = mesh_of(*MESHES["plate with a hole"])
    points = off_boundary(np.vstack([below(mesh, local, d) for local in (-1, 0.3) for d in DEPTHS]), mesh)
    error = stress_at(points, mesh, material, exact_fields(mesh, material, CONSTANT)) - CONSTANT.stress(points)
    assert abs(error).max() < 1e-10


def test_constant_stress_of_a_solution():
    """What the system solves for on a plate with a hole, not what is prescribed, is exact inside too."""
    mesh = mesh_of(rectangle(2, 1, even(6), even(4)), [("hole", arc((1, 0.5), 0.3, 360, 0), even(8))])
    values = values_of(mesh, {"left": "xy"}, lambda x: CONSTANT.displacement(x, MATERIAL), CONSTANT.traction)
    u, t, _ = solved(mesh, MATERIAL, values)
    points = off_boundary(np.vstack([below(mesh, local, d) for local in (-1, 0.3) for d in DEPTHS]), mesh)
    error = stress_at(points, mesh, MATERIAL, fields_of(mesh, MATERIAL, u, t)) - CONSTANT.stress(points)
    assert abs(error).max() < 1e-10


def test_rigid_motions_have_no_stress():
    """A shift has none at all where nodes shift alike; a turn has none but for round-off."""
    mesh = mesh_of(*MESHES["plate with a hole"])
    points = off_boundary(np.vstack([below(mesh, local, 1e-6) for local in (-1, 0.3)]), mesh)
    none = np.zeros((len(mesh.elements), 3, 2))
    shift = fields_of(mesh, MATERIAL, np.tile([3.0, -7.0], (len(mesh.nodes), 1)), none)
    assert not stress_at(points, mesh, MATERIAL, shift).any()
    turn = fields_of(mesh, MATERIAL, np.column_stack([-mesh.nodes[:, 1], mesh.nodes[:, 0]]), none)
    assert abs(stress_at(points, mesh, MATERIAL, turn)).max() < 1e-10 * MATERIAL.young_modulus


@pytest.mark.parametrize("name", MESHES)
def test_side_of_the_boundary(name: str):
    """Points beside every element: 1e-6 of its length on either side."""
    mesh = mesh_of(*MESHES[name])
    for local in (-0.9, 0, 0.5):
        assert inside(below(mesh, local, 1e-6), mesh).all()
        assert not inside(below(mesh, local, -1e-6), mesh).any()


def ellipse(count: int) -> Mesh:
    return mesh_of(
        [("e", lambda s: np.column_stack([np.cos(2 * np.pi * s), 0.5 * np.sin(2 * np.pi * s)]), even(count))]
    )


def errors(mesh: Mesh, fixed: dict, depth: float) -> float:
    """Largest error of the stress at a depth, below middles and ends of elements that do not end in corners."""
    values = values_of(mesh, fixed, lambda x: SMOOTH.displacement(x, MATERIAL), SMOOTH.traction)
    u, t, _ = solved(mesh, MATERIAL, values)
    fields = fields_of(mesh, MATERIAL, u, t)
    smooth = mesh.edge == mesh.edge[mesh.before]
    points = np.vstack([below(mesh, -1, depth)[smooth], below(mesh, 0, depth), below(mesh, 0.577, depth)])
    return abs(stress_at(points, mesh, MATERIAL, fields) - SMOOTH.stress(points)).max()


@pytest.mark.parametrize("depth", [0.3, 1e-2, 1e-6])
def test_order_below_a_smooth_free_boundary(depth: float):
    """Order three at any depth in lengths of the element, ends of elements included: no logarithmic peak there."""
    coarse, fine = (errors(ellipse(count), {}, depth) for count in (16, 64))
    assert np.log2(coarse / fine) / 2 > 2.8


@pytest.mark.parametrize("depth", [0.3, 1e-2, 1e-6])
def test_order_where_displacement_is_prescribed(depth: float):
    """Order two, that of unknown tractions, and no logarithmic peak either."""
    coarse, fine = (errors(ellipse(count), {"e": "xy"}, depth) for count in (16, 64))
    assert np.log2(coarse / fine) / 2 > 1.9


@pytest.mark.parametrize("depth", [0.3, 1e-2, 1e-6])
@pytest.mark.parametrize("fixed", [{}, {"bottom": "xy"}, dict.fromkeys(("bottom", "right", "top", "left"), "xy")])
def test_order_in_a_body_with_corners(fixed: dict, depth: float):
    """Order two, that of the displacement near corners."""
    meshes = [mesh_of(rectangle(1, 1, even(count), even(count))) for count in (8, 16, 32)]
    found = [errors(mesh, fixed, depth) for mesh in meshes]
    assert all(np.log2(coarse / fine) > 1.8 for coarse, fine in pairwise(found))


def test_order_far_from_the_boundary():
    """Order three at least at a fixed place inside."""
    place = np.array([[0.31, 0.17]])
    found = []
    for count in (16, 32, 64):
        mesh = ellipse(count)
        u, t, _ = solved(mesh, MATERIAL, values_of(mesh, {}, np.zeros_like, SMOOTH.traction))
        found.append(
            abs(stress_at(place, mesh, MATERIAL, fields_of(mesh, MATERIAL, u, t)) - SMOOTH.stress(place)).max()
        )
    assert np.log2(found[0] / found[2]) / 2 > 2.8


def test_stress_is_in_equilibrium_and_that_of_the_displacement():
    """With the derivative of displacement as it is, both integrals are one field, whatever is on the boundary.

    Differences over 2e-4 of the size have an error of their square, 1e-7.
    """
    mesh = ellipse(8)
    rng = np.random.default_rng(1)
    u, t = rng.normal(size=(len(mesh.nodes), 2)), rng.normal(size=(len(mesh.elements), 3, 2))
    fields = fields_of(mesh, MATERIAL, u, t, np.zeros(len(mesh.elements), bool))
    interior = Interior(mesh=mesh, poisson_ratio=MATERIAL.effective_poisson_ratio)
    points, h = np.array([[0.1, 0.2], [-0.4, 0.1], [0.6, -0.1]]), 1e-4
    steps = [points + sign * h * axis for axis in np.eye(2) for sign in (1, -1)]

    def change(values: list[np.ndarray]) -> list[np.ndarray]:
        return [(values[0] - values[1]) / (2 * h), (values[2] - values[3]) / (2 * h)]

    du_dx, du_dy = change([interior.displacement(interior.z(x), fields)[:, 0] * mesh.reference_length for x in steps])
    gradient = interior.gradient(interior.z(points), fields)
    assert abs((du_dx - 1j * du_dy) / 2 - gradient.a[:, 0]).max() < 1e-6 * abs(gradient.a).max()
    assert abs((du_dx + 1j * du_dy) / 2 - gradient.b[:, 0]).max() < 1e-6 * abs(gradient.b).max()
    by_x, by_y = change([stress_at(x, mesh, MATERIAL, fields) for x in steps])
    divergence = np.stack([by_x[:, 0] + by_y[:, 2], by_x[:, 2] + by_y[:, 1]])
    assert abs(divergence).max() < 1e-6 * max(abs(by_x).max(), abs(by_y).max())


@pytest.mark.parametrize("depth", [1e-8, 1e-3, 0.1, 1.0, 5.0])
def test_lame_ring(depth: float):
    """Inner pressure: below middles and ends of elements on the hole, order 2.8 at least; 64 elements: 5e-5."""
    a, b, p = 1.0, 2.0, 3.0
    k, found = p * a**2 / (b**2 - a**2), []
    for count in (16, 32, 64):
        mesh = mesh_of([("out", arc((0, 0), b, 0, 360), even(count))], [("in", arc((0, 0), a, 360, 0), even(count))])
        on_hole = np.isclose(np.hypot(*np.moveaxis(mesh.nodes[mesh.elements], 2, 0)), a)[..., None]
        u, t, _ = solved(
            mesh, MATERIAL, values_of(mesh, {}, np.zeros_like, lambda x, n, on=on_hole: np.where(on, -p * n, 0))
        )
        fields = fields_of(mesh, MATERIAL, u, t, np.ones(len(mesh.elements), bool))
        own = mesh.edge == mesh.edge_names.index("in")
        points = np.vstack([below(mesh, local, depth)[own] for local in (-1, -0.5, 0)])
        r, angle = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0])
        xx, yy, xy = stress_at(points, mesh, MATERIAL, fields).T
        c, s = np.cos(angle), np.sin(angle)
        radial, hoop = xx * c * c + yy * s * s + 2 * xy * c * s, xx * s * s + yy * c * c - 2 * xy * c * s
        error = np.array([radial - k * (1 - b**2 / r**2), hoop - k * (1 + b**2 / r**2)])
        found.append(abs(error).max())
    assert found[2] < 5e-5 * p
    assert np.log2(found[0] / found[2]) / 2 > 2.8


def kirsch(points: np.ndarray) -> np.ndarray:
    """A plate under tension 1 along x with a hole of radius 1 (Timoshenko and Goodier, art. 35)."""
    r, angle = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0])
    q, c2, s2 = 1 / r**2, np.cos(2 * angle), np.sin(2 * angle)
    radial = (1 - q) / 2 + (1 - 4 * q + 3 * q * q) / 2 * c2
    hoop, shear = (1 + q) / 2 - (1 + 3 * q * q) / 2 * c2, -(1 + 2 * q - 3 * q * q) / 2 * s2
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([
        radial * c * c + hoop * s * s - 2 * shear * c * s,
        radial * s * s + hoop * c * c + 2 * shear * c * s,
        (radial - hoop) * c * s + shear * (c * c - s * s),
    ])  # fmt: skip


def test_kirsch():
    """64 elements on the hole, the stress of the infinite plate at ten radii: 1e-4 from the edge outwards."""
    mesh = mesh_of([("out", arc((0, 0), 10, 0, 360), even(64))], [("hole", arc((0, 0), 1, 360, 0), even(64))])
    on_hole = np.isclose(np.hypot(*np.moveaxis(mesh.nodes[mesh.elements], 2, 0)), 1)[..., None]

    def traction(x: np.ndarray, n: np.ndarray) -> np.ndarray:
        xx, yy, xy = np.moveaxis(kirsch(x.reshape(-1, 2)).reshape(*x.shape[:-1], 3), -1, 0)
        t = np.stack([xx * n[..., 0] + xy * n[..., 1], xy * n[..., 0] + yy * n[..., 1]], axis=-1)
        return np.where(on_hole, 0.0, t)

    u, t, _ = solved(mesh, MATERIAL, values_of(mesh, {}, np.zeros_like, traction))
    fields = fields_of(mesh, MATERIAL, u, t)
    own = np.flatnonzero(mesh.edge == mesh.edge_names.index("hole"))
    for depth in (1e-8, 1e-4, 1e-2, 0.1, 1.0, 5.0):
        points = np.vstack([below(mesh, local, depth)[own] for local in (-1, -0.6, 0)])
        assert abs(stress_at(points, mesh, MATERIAL, fields) - kirsch(points)).max() < 1e-4
    for local in (-1.0, -0.6, 0.0):
        found = fields.gradient(own, np.full(len(own), local)).stress(MATERIAL)[..., 0].T
        assert abs(found - kirsch(below(mesh, local, 0)[own])).max() < 1e-4


@pytest.mark.parametrize("turn", [0.0, 0.7])
@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_units_and_axes(scale: float, turn: float):
    """Other units of length and force, a turned and shifted body: the same stress in its axes."""
    mesh, points = ellipse(12), np.array([[0.1, 0.2], [0.3, 0.4], [0.99, 0.001]])
    u, t = SMOOTH.displacement(mesh.nodes, MATERIAL), SMOOTH.traction(mesh.nodes[mesh.elements], mesh.normals)
    before = stress_at(points, mesh, MATERIAL, fields_of(mesh, MATERIAL, u, t))
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    moved = Mesh(
        nodes=scale * (mesh.nodes @ rotation.T + [3, -2]),
        elements=mesh.elements,
        edge=mesh.edge,
        edge_names=mesh.edge_names,
    )
    stiff = MATERIAL.model_copy(update={"young_modulus": 7 * MATERIAL.young_modulus})
    fields = fields_of(moved, stiff, scale * u @ rotation.T, 7 * t @ rotation.T)
    xx, yy, xy = stress_at(scale * (points @ rotation.T + [3, -2]), moved, stiff, fields).T / 7
    tensor = rotation.T @ np.array([[xx, xy], [xy, yy]]).transpose(2, 0, 1) @ rotation
    found = np.column_stack([tensor[:, 0, 0], tensor[:, 1, 1], tensor[:, 0, 1]])
    assert abs(found - before).max() < 1e-11 * abs(before).max()


def test_mirror_image():
    """σxx and σyy are those of the mirror image, σxy has the other sign."""
    mesh, points = ellipse(12), np.array([[0.1, 0.2], [0.3, 0.4], [0.99, 0.001]])
    u, t = SMOOTH.displacement(mesh.nodes, MATERIAL), SMOOTH.traction(mesh.nodes[mesh.elements], mesh.normals)
    before = stress_at(points, mesh, MATERIAL, fields_of(mesh, MATERIAL, u, t))
    sign = np.array([-1, 1])
    image = Mesh(nodes=mesh.nodes * sign, elements=mesh.elements[:, ::-1], edge=mesh.edge, edge_names=mesh.edge_names)
    order = np.argsort(image.elements[:, 0])
    image = Mesh(nodes=image.nodes, elements=image.elements[order], edge=mesh.edge, edge_names=mesh.edge_names)
    after = stress_at(points * sign, image, MATERIAL, fields_of(image, MATERIAL, u * sign, t[order, ::-1] * sign))
    assert abs(after * [1, 1, -1] - before).max() < 1e-12 * abs(before).max()
