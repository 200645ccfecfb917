"""The finite elements of the benchmark, where the answer is known in closed form."""

from pathlib import Path

import finite_elements_bodies
import finite_elements_contact
import numpy as np
import pytest
from finite_elements import MODELS, extrapolated
from finite_elements_bodies import (
    along_x,
    bolt_in_plate,
    cantilever_curved_surface,
    cantilever_flat_surface,
    cylinder_on_plane,
    elliptical_crack_closure,
    upwards,
)
from finite_elements_contact import ElasticBody, active_set, graded, mapped, node_at, press

from bemcontact import load as loaded

E, NU = 210.0, 0.3
PLANE_STRAIN = E / (1 - NU**2)


def upper(x, y):
    return y - 1


def lower(x, y):
    return y


def block(*, waves=0.0, held=((along_x, 0),)):
    """The unit square on a few elements; inner lines may be curved."""
    ends = graded((0, 1, 3, 2))

    def place(s, t):
        bubble = waves * np.sin(np.pi * s) * np.sin(np.pi * t)
        return s + bubble, t + bubble

    return ElasticBody(mesh=mapped(ends, ends, place), young_modulus=E, poisson_ratio=NU, held=held)


def on_a_plane(body, load, gap=0.0):
    return press(body, load, lower, along_x, upwards, lambda nodes: np.full(len(nodes), gap))


@pytest.mark.parametrize("module", [finite_elements_bodies, finite_elements_contact])
def test_the_finite_elements_use_nothing_of_the_package(module):
    assert "import bemcontact" not in (source := Path(module.__file__).read_text(encoding="utf-8"))
    assert "from bemcontact" not in source


def test_graded_elements():
    """Sizes 1 : 2 : 4, each cut in two equal parts, then one of size 7."""
    assert graded((0, 7, 3, 4), (7, 14, 1, 1), parts=2) == pytest.approx([0, 0.5, 1, 2, 3, 5, 7, 10.5, 14])


@pytest.mark.parametrize("waves", [0.0, 0.05])
def test_uniform_stress_is_exact(waves):
    """Patch test: u is linear, which elements of any shape contain. ε_x = σ (1 - ν²)/E, ε_y = -ν/(1 - ν) ε_x."""
    body = block(waves=waves, held=((along_x, 0), (lower, 1)))
    u = body.deflection(body.traction(lambda x, y: x - 1, (3, 0)))
    strain = 3 / PLANE_STRAIN
    x, y = body.nodes.T
    assert u == pytest.approx(np.column_stack([strain * x, -NU / (1 - NU) * strain * y]), abs=1e-13)


def test_traction_on_a_curved_side_has_the_force_of_its_projection():
    """A uniform traction (1, 2) on the arc of a quarter disc, of length π/2 up to the 4th power of the size."""
    mesh = mapped(graded((0, np.pi / 2, 8, 1)), graded((0.5, 1, 1, 1)), lambda s, t: (t * np.cos(s), t * np.sin(s)))
    body = ElasticBody(mesh=mesh, young_modulus=E, poisson_ratio=NU)
    load = body.traction(lambda x, y: np.hypot(x, y) - 1, (1, 2))
    assert load[body.freedoms].sum(axis=1) == pytest.approx([np.pi / 2, np.pi], rel=1e-5)


@pytest.mark.parametrize("gap", [0.0, 0.25])
def test_a_free_block_lies_on_a_plane_under_uniform_pressure(gap):
    """Contact alone holds it: p is the load, the block falls through the gap, its top by p (1 - ν²)/E more."""
    body = block(waves=0.05)
    touch = on_a_plane(body, body.traction(upper, (0, -3)), gap)
    assert touch.pressure == pytest.approx(np.full(7, 3.0), rel=1e-11)
    assert touch.pressure_at(np.array([0.0, 0.3, 1.0])) == pytest.approx(3.0, rel=1e-11)
    assert touch.force == pytest.approx([0, 3], abs=1e-12)
    assert touch.ends() == pytest.approx([0, 1])
    assert touch.displacement_at((0, 1)) == pytest.approx([0, -gap - 3 / PLANE_STRAIN], abs=1e-13)


def test_a_ring_shrunk_on_a_rigid_pin():
    """Normals turn with the hole. Lamé: u(a) = (1 + ν) p a/(E (b² - a²)) · ((1 - 2ν) a² + b²) under pressure p on a."""
    inner, outer, interference = 1.0, 2.0, 1e-3
    mesh = mapped(
        graded((0, np.pi / 2, 8, 1)), graded((inner, outer, 8, 2)), lambda s, t: (t * np.cos(s), t * np.sin(s))
    )
    level = {axis: (lambda x, y, axis=axis: np.where((x, y)[axis] < 1e-12, 0.0, 1.0)) for axis in (0, 1)}
    body = ElasticBody(mesh=mesh, young_modulus=E, poisson_ratio=NU, held=((level[0], 0), (level[1], 1)))

    def normal(x, y):
        return np.round(x, 15) / np.hypot(x, y), np.round(y, 15) / np.hypot(x, y)

    touch = press(
        body, np.zeros(body.freedoms.size), lambda x, y: np.hypot(x, y) - inner, lambda x, y: np.arctan2(y, x),
        normal, lambda nodes: np.full(len(nodes), -interference),
    )  # fmt: skip
    p = interference * E * (outer**2 - inner**2) / ((1 + NU) * inner * ((1 - 2 * NU) * inner**2 + outer**2))
    angles = np.linspace(0, np.pi / 2, 7)
    assert touch.pressure_at(angles) == pytest.approx(p, rel=1e-3)  # h⁴ of elements of a fifth of the radius
    assert touch.displacement_at((0, inner)) == pytest.approx([0, interference], abs=1e-12)


def test_hertz():
    """A parabola of radius 1 on a block fifty times as large as the half-width b: what is left of that is (b/1)²."""
    half_width = 0.02
    load = half_width**2 * np.pi * PLANE_STRAIN / 4
    x = graded((0, 0.015, 8, 1), (0.015, 0.025, 12, 1), (0.025, 1, 12, 60))
    mesh = mapped(x, graded((0, 1, 20, 400)), lambda s, t: (s, t))
    body = ElasticBody(mesh=mesh, young_modulus=E, poisson_ratio=NU, held=((along_x, 0),))
    touch = press(
        body, body.traction(upper, (0, -load / 2)), lower, along_x, upwards, lambda nodes: body.nodes[nodes, 0] ** 2 / 2
    )
    at = np.linspace(0, 0.9 * half_width, 10)
    peak = 2 * load / (np.pi * half_width)
    assert touch.force == pytest.approx([0, load / 2], rel=1e-9)
    assert touch.ends() == pytest.approx([0, half_width], rel=2e-3)  # a tenth of a node spacing
    assert touch.pressure_at(at) == pytest.approx(peak * np.sqrt(1 - (at / half_width) ** 2), abs=3e-3 * peak)


def test_the_limit_of_what_goes_with_h_squared():
    """1 + h² on h = 1 and 1/2: 2 and 5/4 tend to 1, from which the latter is 1/4 away."""
    assert extrapolated(np.array(2.0), np.array(1.25)) == (1.0, 0.25)


def test_the_cylinder_of_the_benchmark():
    """Equilibrium holds to round-off; half-width and peak are those of `models/`, found with other meshes and code."""
    touch = cylinder_on_plane(1)
    assert touch.force == pytest.approx([0, 405], rel=1e-9)
    assert touch.ends()[1] == pytest.approx(2.7685, rel=2e-4)
    assert touch.pressure_at(np.zeros(1)) == pytest.approx(183.335, rel=5e-4)


def stated(name):
    """What the file of a problem says that these finite elements gave."""
    return loaded(MODELS / f"{name}.yaml").reference["finite elements"]


@pytest.mark.parametrize("press_together", [bolt_in_plate, elliptical_crack_closure])
def test_tables_in_the_models_are_those_of_the_benchmark(press_together):
    """On the coarsest mesh, 2e-4 of the peak from the limit in the tables; the finest one would take half a minute."""
    at, pressure = np.array(stated(press_together.__name__).pressure).T
    assert press_together(1).pressure_at(at) == pytest.approx(pressure, abs=3e-4 * pressure.max())


@pytest.mark.slow
def test_values_in_the_models_are_those_of_the_benchmark():
    """On the coarsest mesh: starts within 0.001 of degrees and cm, peaks within 1e-4, and what the files round off."""
    start = loaded(MODELS / "bolt_in_plate.yaml").reference["finite elements, start"].start
    assert bolt_in_plate(1).ends()[0] == pytest.approx(start, abs=0.001 + 0.005)
    known, touch = stated("cantilever_flat_surface"), cantilever_flat_surface(1)
    assert touch.ends()[0] == pytest.approx(known.start, abs=0.001 + 0.0005)
    assert touch.pressure_at(np.linspace(43, 46, 301)).max() == pytest.approx(known.peak, abs=0.001 + 0.005)
    touch = cantilever_curved_surface(1)
    peak = touch.pressure_at(np.linspace(10, 30, 401)).max()
    assert peak == pytest.approx(stated("cantilever_curved_surface").peak, abs=0.005)


def test_active_set_finds_the_only_state_of_two_springs():
    """Springs of stiffness 2, pushed by 3 and pulled by 1 over gaps of 1: the first closes with 3 - 2 = 1 left."""
    u, force = active_set(np.diag([2.0, 2.0]), np.array([-3.0, 1.0]), np.ones(2))
    assert u == pytest.approx([-1, 0.5])
    assert force == pytest.approx([1, 0])


def test_a_normal_that_leans_on_a_held_axis_is_refused():
    body = block()
    leaning = np.sqrt(0.5)
    with pytest.raises(ValueError, match="normal along an axis"):
        press(
            body, body.traction(upper, (0, -1)), lower, along_x,
            lambda x, y: (np.full_like(x, leaning), np.full_like(x, leaning)), lambda nodes: np.zeros(len(nodes)),
        )  # fmt: skip


def test_a_place_without_node_is_refused():
    with pytest.raises(ValueError, match="no node at"):
        node_at(np.array([[0.0, 0.0], [1.0, 1.0]]), (0.0, 0.1))
