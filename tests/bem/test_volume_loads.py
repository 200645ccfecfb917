"""Volume loads against closed forms, and their resultants against area and centroid."""

import numpy as np
import pytest
from bodies import arc, even, mesh_of, rectangle, solved, values_of, without_rigid_motion

from bemcontact.bem.loading import particular_solution
from bemcontact.problem.conditions import Centrifugal, Gravity, Loads, Temperature
from bemcontact.problem.material import Material

STATES = ("plane_strain", "plane_stress")


def nothing(points):
    return 0 * points


def no_traction(points, normals):
    return 0 * points


@pytest.mark.parametrize("state", STATES)
def test_hanging_column(state):
    """Uniaxial stress ρ g y in a column held at its top by just that stress; displacement is quadratic, hence exact.

    u_y = ρ g y²/2 (1 - ν'²)/E' …, written with the plane-strain compliances (1 - ν)/(2G) and -ν/(2G).
    """
    material = Material(young_modulus=1000, poisson_ratio=0.3, state=state)
    nu, G, weight = material.effective_poisson_ratio, material.shear_modulus, 2.0

    def displacement(points):
        x, y = points[:, 0], points[:, 1]
        along, across = weight * (1 - nu) / (2 * G), -weight * nu / (2 * G)
        return np.column_stack([across * x * y, (along * y**2 - across * x**2) / 2])

    def traction(points, normals):
        return np.stack([0 * points[..., 1], weight * points[..., 1] * normals[..., 1]], axis=-1)

    mesh = mesh_of(rectangle(1, 3, even(2), even(4)))
    loads = Loads(gravity=Gravity(density=2, acceleration=(0, -1)))
    u, _, _ = solved(mesh, material, values_of(mesh, {}, displacement, traction), loads)
    difference = without_rigid_motion(mesh, u - displacement(mesh.nodes))
    assert abs(difference).max() < 1e-12 * abs(displacement(mesh.nodes)).max()


@pytest.mark.parametrize("state", STATES)
def test_rotating_disc(state):
    """Solid disc: u_r = ρω²(1-2ν)/(16G(1-ν)) r ((3-2ν) - r²) (Timoshenko and Goodier, § 32), order four."""
    material = Material(young_modulus=1000, poisson_ratio=0.3, state=state)
    nu, G = material.effective_poisson_ratio, material.shear_modulus
    errors = []
    for n in (8, 16, 32):
        mesh = mesh_of([("rim", arc((1, 2), 1, 0, 360), even(n))])
        loads = Loads(centrifugal=Centrifugal(density=3, angular_velocity=2, center=(1, 2)))
        u, _, _ = solved(mesh, material, values_of(mesh, {}, nothing, no_traction), loads)
        exact = 12 * (1 - 2 * nu) / (16 * G * (1 - nu)) * (2 - 2 * nu) * (mesh.nodes - [1, 2])
        errors.append(abs(without_rigid_motion(mesh, u - exact)).max() / abs(exact).max())
    assert np.log2(errors[0] / errors[-1]) / 2 >= 3.8, errors


@pytest.mark.parametrize("state", STATES)
def test_free_body_in_a_linear_temperature_field_has_no_stress(state):
    """Clamped in the stress-free shape u_p the body feels no traction, and free it takes that shape."""
    material = Material(young_modulus=1000, poisson_ratio=0.3, state=state)
    loads = Loads(temperature=Temperature(expansion=1e-3, change={"constant": 20, "x": 3, "y": -5}))
    mesh = mesh_of(rectangle(2, 1, even(4), even(2)))
    shape = particular_solution(loads, material, mesh).displacement
    u, _, _ = solved(mesh, material, values_of(mesh, {}, nothing, no_traction), loads)
    assert abs(without_rigid_motion(mesh, u - shape)).max() < 1e-13 * abs(shape).max()
    values = values_of(mesh, {"left": "xy", "top": "x"}, lambda points: shape, no_traction)
    _, t, _ = solved(mesh, material, values, loads)
    assert abs(t).max() < 1e-11 * material.young_modulus * 1e-3 * 20


@pytest.mark.parametrize("state", STATES)
def test_hindered_expansion(state):
    """Between rollers on all sides: σ = -EαΔT/(1-2ν) in plane strain, -EαΔT/(1-ν) in plane stress."""
    material = Material(young_modulus=1000, poisson_ratio=0.3, state=state)
    loads = Loads(temperature=Temperature(expansion=1e-3, change=7))
    mesh = mesh_of(rectangle(2, 1, even(4), even(2)))
    fixed = {"left": "x", "right": "x", "top": "y", "bottom": "y"}
    _, t, _ = solved(mesh, material, values_of(mesh, fixed, nothing, no_traction), loads)
    pressure = 1000 * 7e-3 / ((1 - 0.6) if state == "plane_strain" else (1 - 0.3))
    expected = -pressure * mesh.normals
    assert abs(t - expected).max() < 1e-11 * pressure


def test_resultants_are_exact():
    """Rectangle 2 x 1 at (1, -3): gravity acts at its centre; centrifugal force is ρω² A (centre - axis)."""
    edges = [
        (name, lambda s, c=c: c(s) + np.array([1, -3]), ends) for name, c, ends in rectangle(2, 1, even(2), even(1))
    ]
    mesh, material = mesh_of(edges), Material(young_modulus=1, poisson_ratio=0)
    gravity = particular_solution(Loads(gravity=Gravity(density=5, acceleration=(3, -2))), material, mesh)
    assert gravity.force == pytest.approx([30, -20], rel=1e-14)
    assert gravity.moment == pytest.approx(2 * -20 - -2.5 * 30, rel=1e-14)
    turning = Loads(centrifugal=Centrifugal(density=5, angular_velocity=2, center=(0.5, 1)))
    centrifugal = particular_solution(turning, material, mesh)
    force = 20 * 2 * np.array([2 - 0.5, -2.5 - 1])
    assert centrifugal.force == pytest.approx(force, rel=1e-14)
    assert centrifugal.moment == pytest.approx(0.5 * force[1] - 1 * force[0], rel=1e-13)
