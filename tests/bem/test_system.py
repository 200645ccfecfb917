"""Fields that the elements represent exactly; answers that do not depend on axes and units."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from bodies import MESHES, arc, even, mesh_of, rectangle, solved, system_of, values_of, without_rigid_motion
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact.analysis.solve import solve as solve_problem
from bemcontact.bem.boundary_values import BoundaryValues
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.rigid_motions import RigidMotions, free_rigid_motions
from bemcontact.bem.solution import solve_system
from bemcontact.problems import Problem
from bemcontact.problems.material import Material

MATERIAL = Material(young_modulus=1000, poisson_ratio=0.3)
STRESS = np.array([[3.0, 1.2], [1.2, -2.0]])
STRAIN = (STRESS - 0.3 * np.trace(STRESS) * np.eye(2)) / (2 * MATERIAL.shear_modulus)
"""Plane strain: 2Gε = σ - ν tr(σ) 1."""
GRADIENT = STRAIN + np.array([[0, -0.001], [0.001, 0]])


FIXED = {
    "traction": lambda names: {},
    "displacement": lambda names: dict.fromkeys(names, "xy"),
    "one edge clamped": lambda names: {names[0]: "xy"},
    "clamp beside roller": lambda names: {names[0]: "xy", names[-1]: "x"},
    "rollers": lambda names: {names[0]: "y", names[-1]: "x"},
}


def displacement(points):
    return points @ GRADIENT.T + np.array([0.002, -0.001])


def traction(points, normals):
    return normals @ STRESS


def errors(loops, fixed, gradient_scale=1.0):
    """Relative errors: largest of displacement, and of traction in the mean square along the boundary."""
    mesh = mesh_of(*loops)
    u, t, system = solved(mesh, MATERIAL, values_of(mesh, fixed(mesh.edge_names), displacement, traction))
    du = u - displacement(mesh.nodes)
    du = without_rigid_motion(mesh, du) if len(system.motions) else du
    dt = t - traction(mesh.nodes[mesh.elements], mesh.normals)
    of_stress = np.sqrt(np.sum(mesh.tributary[..., None] * dt**2) / np.sum(mesh.tributary)) / abs(STRESS).max()
    return abs(du).max() / abs(displacement(mesh.nodes)).max(), of_stress


@pytest.mark.parametrize("conditions", FIXED)
@pytest.mark.parametrize("name", MESHES)
def test_constant_stress_is_exact(name, conditions):
    """Interpolating t·J, the method reproduces constant stress on straight and curved elements to round-off."""
    assert max(errors(MESHES[name], FIXED[conditions])) < 1e-12


def on_springs(values: BoundaryValues, u: np.ndarray, mesh: Mesh) -> BoundaryValues:
    """Springs between all axes on elements without a prescribed displacement, and the load that balances them."""
    free = ~values.traction_unknown.any(axis=1)[:, None, None, None]
    one, other = np.random.default_rng(3).normal(size=(2, *mesh.elements.shape, 2))
    spread = np.einsum("...i,...j->...ij", one, one) + np.einsum("...i,...j->...ij", other, other)
    K = np.where(free, 500 * spread, 0.0)
    return replace(values, stiffness=K, traction=values.traction + np.einsum("mkij,mkj->mki", K, u[mesh.elements]))


@pytest.mark.parametrize("by_numba", [False, pytest.param(True, marks=pytest.mark.slow)])
@pytest.mark.parametrize("conditions", ["traction", "one edge clamped", "clamp beside roller", "rollers"])
@pytest.mark.parametrize("name", MESHES)
def test_constant_stress_on_springs_is_exact(name, conditions, by_numba):
    """T = σ n + K u - K u: springs that differ from node to node, also beside nodes with a prescribed displacement."""
    mesh = mesh_of(*MESHES[name])
    exact = displacement(mesh.nodes)
    values = on_springs(values_of(mesh, FIXED[conditions](mesh.edge_names), displacement, traction), exact, mesh)
    motions = free_rigid_motions(mesh, values)
    assert len(motions) == 0 or not values.stiffness.any()
    system = replace(system_of(mesh, MATERIAL, values, motions), by_numba=by_numba)
    u, t = system.fields(solve_system(system).combined(np.ones(1)), system.loadings[0])
    moved = u - exact if not len(motions) else without_rigid_motion(mesh, u - exact)
    assert abs(moved).max() < 1e-11 * abs(exact).max()
    dt = t - traction(mesh.nodes[mesh.elements], mesh.normals)
    assert np.sqrt(np.sum(mesh.tributary[..., None] * dt**2) / np.sum(mesh.tributary)) < 1e-11 * abs(STRESS).max()


@pytest.mark.parametrize("conditions", FIXED)
def test_thin_strip(conditions):
    """2 x 0.01, elements ten times longer than the strip is thick; bending costs (length/thickness)² of round-off."""
    assert max(errors([rectangle(2, 0.01, even(20), even(1))], FIXED[conditions])) < 1e-11


def order(errors: list[float]) -> float:
    """Mean order over all halvings of the element length."""
    return float(np.log2(errors[0] / errors[-1]) / (len(errors) - 1))


def lame_ring(points: np.ndarray, material: Material, a: float, b: float, p: float) -> np.ndarray:
    """Ring a <= r <= b in plane strain under inner pressure p (Timoshenko and Goodier, Theory of Elasticity, § 28)."""
    nu, G = material.poisson_ratio, material.shear_modulus
    r2 = np.sum(points**2, axis=1, keepdims=True)
    return p * a**2 / (b**2 - a**2) / (2 * G) * ((1 - 2 * nu) + b**2 / r2) * points


def test_lame_ring():
    """Nodal displacement on smooth contours is superconvergent of order four; the third halving must show 3.8."""
    material = Material(young_modulus=1000, poisson_ratio=0.3)
    errors = []
    for n in (8, 16, 32, 64):
        mesh = mesh_of([("out", arc((0, 0), 2, 0, 360), even(n))], [("in", arc((0, 0), 1, 360, 0), even(n))])
        inner = (np.hypot(*np.moveaxis(mesh.nodes[mesh.elements], 2, 0)) < 1.5)[..., None]
        values = values_of(mesh, {}, lambda x: 0 * x, lambda x, n, inner=inner: np.where(inner, -n, 0))
        u, _, _ = solved(mesh, material, values)
        exact = lame_ring(mesh.nodes, material, 1, 2, 1)
        errors.append(abs(without_rigid_motion(mesh, u - exact)).max() / abs(exact).max())
    assert order(errors) >= 3.8, errors


def of_potentials(z, potentials, material: Material) -> tuple[np.ndarray, np.ndarray]:
    """Displacement (…, 2) and stress (…, 2, 2) from φ, φ', φ'', ψ, ψ' at z = x + iy (Muskhelishvili 1953, § 32).

    2G (u + iv) = κφ - z conj(φ') - conj(ψ), σxx + σyy = 4 Re φ', σyy - σxx + 2iσxy = 2 (conj(z) φ'' + ψ').
    """
    phi, d_phi, dd_phi, psi, d_psi = potentials(z)
    kappa = 3 - 4 * material.effective_poisson_ratio
    w = (kappa * phi - z * d_phi.conj() - psi.conj()) / (2 * material.shear_modulus)
    total, difference = 4 * d_phi.real, 2 * (z.conj() * dd_phi + d_psi)
    xx, yy, xy = (total - difference.real) / 2, (total + difference.real) / 2, difference.imag / 2
    stress = np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2)
    return np.stack([w.real, w.imag], -1), stress


def complex_points(points: np.ndarray) -> np.ndarray:
    return points[..., 0] + 1j * points[..., 1]


def kirsch(z):
    """What a hole of radius 1 adds to unit tension along x: φ = 1/(2z), ψ = -(1/z - 1/z³)/2."""
    return 1 / (2 * z), -1 / (2 * z**2), 1 / z**3, -(1 / z - 1 / z**3) / 2, (1 / z**2 - 3 / z**4) / 2


def cubic(z):
    return z**3, 3 * z**2, 6 * z, z**2, 2 * z


@pytest.mark.parametrize("state", ["plane_strain", "plane_stress"])
def test_kirsch_hole(state):
    """The unbounded plate outside one hole, with the load that cancels the tension; no rigid motion at infinity."""
    material = Material(young_modulus=1000, poisson_ratio=0.3, state=state)
    errors = []
    for n in (8, 16, 32, 64):
        mesh = mesh_of([("hole", arc((0, 0), 1, 360, 0), even(n))])
        values = values_of(mesh, {}, lambda x: 0 * x, lambda x, n: -n * [1, 0])
        none = RigidMotions(coefficients=np.zeros((0, 3)), center=mesh.center, radius=1)
        system = system_of(mesh, material, values, none)
        u, _ = system.fields(solve_system(system).combined(np.ones(1)), system.loadings[0])
        exact, _ = of_potentials(complex_points(mesh.nodes), kirsch, material)
        errors.append(abs(u - exact).max() / abs(exact).max())
    assert order(errors) >= 3.8, errors


def test_cubic_field_in_a_disc():
    """A field without such symmetry: the Cauchy kernel acts on the cubic remainder of the displacement, order three."""
    material = Material(young_modulus=1000, poisson_ratio=0.3)
    errors = []
    for n in (8, 16, 32, 64):
        mesh = mesh_of([("out", arc((0, 0), 1, 0, 360), even(n))])
        exact, _ = of_potentials(complex_points(mesh.nodes), cubic, material)

        def traction(points, normals):
            return np.einsum("mkij,mkj->mki", of_potentials(complex_points(points), cubic, material)[1], normals)

        u, _, _ = solved(mesh, material, values_of(mesh, {}, lambda x: 0 * x, traction))
        errors.append(abs(without_rigid_motion(mesh, u - exact)).max() / abs(exact).max())
    assert order(errors) >= 3.0, errors


def test_timoshenko_cantilever():
    """Plane stress, L/D = 5, exact displacement at the clamp (Augarde and Deeks 2008): the declared order is three."""
    material = Material(young_modulus=1000, poisson_ratio=0.3, state="plane_stress")
    E, nu, L, D, P = 1000, 0.3, 5.0, 1.0, 1.0
    inertia = D**3 / 12

    def displacement(points):
        x, y = points[:, 0], points[:, 1] - D / 2
        u = P * y / (6 * E * inertia) * ((6 * L - 3 * x) * x + (2 + nu) * (y**2 - D**2 / 4))
        v = -P / (6 * E * inertia) * (3 * nu * y**2 * (L - x) + (4 + 5 * nu) * D**2 * x / 4 + (3 * L - x) * x**2)
        return np.column_stack([u, v])

    def traction(points, normals):
        x, y = points[..., 0], points[..., 1] - D / 2
        xx, xy = P * (L - x) * y / inertia, -P / (2 * inertia) * (D**2 / 4 - y**2)
        return np.stack([xx * normals[..., 0] + xy * normals[..., 1], xy * normals[..., 0]], axis=-1)

    errors = []
    for n in (2, 4, 8, 16):
        mesh = mesh_of(rectangle(L, D, even(5 * n // 2), even(n // 2)))
        u, _, _ = solved(mesh, material, values_of(mesh, {"left": "xy"}, displacement, traction))
        exact = displacement(mesh.nodes)
        errors.append(abs(u - exact).max() / abs(exact).max())
    assert order(errors) >= 3.0, errors


CORNERS = {"foot": (0, 0), "right": (4, 0), "top": (4, 2), "left": (1, 2.5)}
"""Corners of the body, and the edges that begin there; the right one is an arc about (1, 1)."""


def held_body(held, load, turn=0.0, mirrored=False, length=1.0, stress=1.0, shift=(0.0, 0.0)):
    """A body with a hole on a floor, held on some edges or on none, under traction and a load on its volume."""
    c, s, m = np.cos(turn), np.sin(turn), -1.0 if mirrored else 1.0

    def vector(x, y):
        return np.array([c * m * x - s * y, s * m * x + c * y])

    def at(x, y):
        return length * (vector(x, y) + shift)

    names, corners = [*CORNERS], [*CORNERS.values()]
    if mirrored:  # run through the other way
        names, corners = names[::-1], [corners[0], *corners[:0:-1]]
    edges = [
        {"name": name, "start": tuple(at(*corner)), "elements": 3} for name, corner in zip(names, corners, strict=True)
    ]
    next(edge for edge in edges if edge["name"] == "right").update(kind="arc", center=tuple(at(1, 1)))
    first = np.degrees(np.arctan2(*vector(1, 0)[::-1]))
    bore = {"name": "bore", "kind": "arc", "center": tuple(at(2.3, 1.2)), "radius": 0.4 * length, "elements": 8}
    gradient = vector(3, 5) / length
    loads = {
        "gravity": {"density": stress / length, "acceleration": tuple(vector(0.1, -1.0))},
        "centrifugal": {"density": stress / length**2, "angular_velocity": 0.4, "center": tuple(at(2, 3))},
        "temperature": {
            "expansion": 1e-4,
            "change": {"constant": 7 - gradient @ at(0, 0), "x": gradient[0], "y": gradient[1]},
        },
    }
    push = stress * vector(0.1 if held else 0.0, -2.0)
    return Problem.model_validate(
        {
            "name": "turned",
            "material": {"young_modulus": 1000.0 * stress, "poisson_ratio": 0.3},
            "boundary": {"outer": edges, "holes": [[{**bore, "angles": (first + 360, first)}]]},
            "conditions": {
                "top": {"traction": {"x": push[0], "y": push[1]}},
                **{name: {"displacement": {"x": 0.0, "y": 0.0}} for name in held},
            },
            "loads": {load: loads[load]},
            "contact_zones": {
                "floor": {
                    "edges": "foot",
                    "surface": {"kind": "plane", "point": tuple(at(0, -1e-4)), "normal": tuple(vector(0, 1))},
                }
            },
            "mesh": {"adapt": False},
        }
    )


def sizes_of(problem, length, stress):
    """Pressures, and sizes of displacements and tractions, in units without name, sorted."""
    result = solve_problem(problem)
    state = result.boundary
    assert state is not None
    displacement, traction = (
        np.sort(np.hypot(*np.moveaxis(field, 2, 0)).ravel()) for field in (state.displacement, state.traction)
    )
    return np.sort(result.solution.pressure) / stress, displacement / length, traction / stress


@cache
def sizes_as_drawn(held, load):
    return sizes_of(held_body(held, load), 1.0, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize("held", [("left",), ("right",), ("left", "right")])
@pytest.mark.parametrize("load", ["gravity", "centrifugal", "temperature"])
@settings(max_examples=4, deadline=None)
@given(
    turn=st.floats(-3, 3), mirrored=st.booleans(), length=st.sampled_from([1e-3, 1.0, 25.4]),
    stress=st.sampled_from([1.0, 6894.76]), shift=st.tuples(st.floats(-10, 10), st.floats(-10, 10)),
)  # fmt: skip
def test_a_held_body_has_the_same_answer(held, load, turn, mirrored, length, stress, shift):
    """On a coarse mesh too: its errors turn with it. Corners between held and free edges are among the nodes."""
    expected = sizes_as_drawn(held, load)
    found = sizes_of(held_body(held, load, turn, mirrored, length, stress, shift), length, stress)
    assert expected[0].max() > 0
    for one, other in zip(expected, found, strict=True):
        assert other == pytest.approx(one, rel=0, abs=1e-9 * one.max())
