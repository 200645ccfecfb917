"""Finite elements of two bodies in contact, where the answer is known in closed form."""

from pathlib import Path

import finite_elements_pairs
import numpy as np
import pytest
import two_bodies
from finite_elements_bodies import along_x, upwards
from finite_elements_contact import ElasticBody, graded, mapped, press
from finite_elements_pairs import Side, gaps, horizontal, press_together, roller_on_block

STIFF, SOFT, NU = 210.0, 70.0, 0.3
LEVEL = {axis: (lambda x, y, axis=axis: np.where((x, y)[axis] < 1e-12, 0.0, 1.0)) for axis in (0, 1)}


def block(low: float, high: float, young_modulus: float, *held, waves: float = 0.05) -> ElasticBody:
    """1 wide, on a few elements whose inner lines are curved."""
    ends = graded((0, 1, 3, 2))

    def place(s, t):
        bubble = waves * np.sin(np.pi * s) * np.sin(np.pi * t)
        return s + bubble, low + (high - low) * (t + bubble)

    mesh = mapped(ends, ends, place)
    return ElasticBody(mesh=mesh, young_modulus=young_modulus, poisson_ratio=NU, held=((along_x, 0), *held))


def unloaded(body: ElasticBody, level, coordinate=along_x) -> Side:
    return Side(body=body, load=np.zeros(body.freedoms.size), level=level, coordinate=coordinate)


def test_the_finite_elements_use_nothing_of_the_package():
    source = Path(finite_elements_pairs.__file__).read_text(encoding="utf-8")
    assert "import bemcontact" not in source
    assert "from bemcontact" not in source


@pytest.mark.parametrize("gap", [0.0, 0.25])
def test_stacked_blocks_carry_uniform_pressure(gap: float):
    """Patch test: the upper one falls through the gap, and its top by p (1 - ν²) (1/E + 2/E') more for heights 1, 2."""
    upper = block(gap, 1 + gap, STIFF)
    lower = block(-2, 0, SOFT, (horizontal(-2.0), 1))
    load = upper.traction(horizontal(1 + gap), (0, -3))
    top = Side(body=upper, load=load, level=horizontal(gap), coordinate=along_x)
    touch = press_together(top, unloaded(lower, horizontal(0.0)), upwards)
    assert touch.pressure == pytest.approx(np.full(7, 3.0), rel=1e-10)
    assert touch.force == pytest.approx([0, 3], abs=1e-11)
    assert touch.gap == pytest.approx(np.zeros(7), abs=1e-14)
    shortening = 3 * (1 - NU**2) * (1 / STIFF + 2 / SOFT)
    assert touch.displacement_at((0, 1 + gap)) == pytest.approx([0, -gap - shortening], abs=1e-12)


def ring(inner: float, outer: float, young_modulus: float) -> ElasticBody:
    """A quarter, held along both axes."""
    mesh = mapped(
        graded((0, np.pi / 2, 8, 1)), graded((inner, outer, 8, 2)), lambda s, t: (t * np.cos(s), t * np.sin(s))
    )
    return ElasticBody(
        mesh=mesh, young_modulus=young_modulus, poisson_ratio=NU, held=((LEVEL[0], 0), (LEVEL[1], 1))
    )  # fmt: skip


def test_a_ring_shrunk_on_a_ring():
    """Normals turn with the hole. Lamé: both take up the interference; h⁴ of elements of a fifth of the radius."""
    a, c, b, interference = 0.5, 1.0, 2.0, 1e-3
    inside, outside = ring(a, c + interference, STIFF), ring(c, b, SOFT)

    def angle(x, y):
        return np.arctan2(y, x)

    def outwards(x, y):
        return -np.round(x, 15) / np.hypot(x, y), -np.round(y, 15) / np.hypot(x, y)

    touch = press_together(
        unloaded(inside, lambda x, y: np.hypot(x, y) - c - interference, angle),
        unloaded(outside, lambda x, y: np.hypot(x, y) - c, angle),
        outwards,
    )
    shrinks = (1 + NU) / STIFF * c / (c**2 - a**2) * ((1 - 2 * NU) * c**2 + a**2)
    grows = (1 + NU) / SOFT * c / (b**2 - c**2) * ((1 - 2 * NU) * c**2 + b**2)
    assert touch.pressure_at(np.linspace(0, np.pi / 2, 7)) == pytest.approx(interference / (shrinks + grows), rel=3e-3)


def test_a_much_stiffer_body_is_a_rigid_surface():
    """A block on one of E' = 1e9 E has the nodal pressures of a block on a rigid plane, over a parabolic gap."""
    ends = graded((0, 0.4, 8, 1), (0.4, 1, 6, 2))
    mesh = mapped(ends, ends, lambda s, t: (s, t + (1 - t) * 0.01 * s**2))
    upper = ElasticBody(mesh=mesh, young_modulus=SOFT, poisson_ratio=NU, held=((along_x, 0),))
    base = mapped(ends, ends, lambda s, t: (s, t - 1))
    lower = ElasticBody(
        mesh=base, young_modulus=SOFT * 1e9, poisson_ratio=NU, held=((along_x, 0), (horizontal(-1.0), 1))
    )
    load = upper.traction(horizontal(1.0), (0, -0.2))

    def under(x, y):
        return y - 0.01 * x**2

    touch = press_together(
        Side(body=upper, load=load, level=under, coordinate=along_x), unloaded(lower, horizontal(0.0)), upwards
    )
    alone = press(upper, load, under, along_x, upwards, lambda nodes: 0.01 * upper.nodes[nodes, 0] ** 2)
    assert 0 < (touch.pressure > 0).sum() < len(touch.pressure)
    assert touch.pressure == pytest.approx(alone.pressure, rel=1e-6)


@pytest.mark.slow
def test_hertz():
    """A cylinder of radius 8 on a block, E = 1000 and 500. What is left goes with (1 - 2ν) b/R, of a b/R = 0.03."""
    half_width = 0.24
    load = np.pi * half_width**2 / (4 * 8 * (1 - NU**2) * 0.003)
    touch = roller_on_block(
        1, radius=8.0, moduli=(1e3, 500.0), width=16.0, height=16.0, load=load / 2, end=half_width
    )  # fmt: skip
    assert touch.force[1] == pytest.approx(load / 2, rel=1e-9)  # normals of a half have a force along x too
    assert touch.ends() == pytest.approx([0, half_width], rel=2e-3)
    assert touch.pressure_at(np.zeros(1)) == pytest.approx(2 * load / np.pi / half_width, rel=2e-3)


def test_nodes_that_do_not_match_are_refused():
    nodes, normals = np.array([[0.0, 1.0], [1.0, 1.0]]), np.array([[0.0, 1.0], [0.0, 1.0]])
    with pytest.raises(ValueError, match="2 nodes are opposite to 1"):
        gaps(nodes, nodes[:1], normals)
    with pytest.raises(ValueError, match="beside the normal of its pair"):
        gaps(nodes, np.array([[0.0, 0.0], [1.1, 0.0]]), normals)


def test_a_pair_that_is_held_is_refused():
    upper, lower = block(0, 1, STIFF, (horizontal(0.0), 1)), block(-2, 0, SOFT, (horizontal(-2.0), 1))
    with pytest.raises(ValueError, match="held along its normal"):
        press_together(unloaded(upper, horizontal(0.0)), unloaded(lower, horizontal(0.0)), upwards)


def test_limits_of_peak_and_end():
    """1 + h² and 1 + h on h = 1, 1/2 and 1/4: both tend to 1, from which the last values are 1/16 and 1/4 away."""
    values = [np.array([1 + h**2, 1 + h]) for h in (1.0, 0.5, 0.25)]
    last, uncertain = two_bodies.limit(values)
    assert last == pytest.approx([1, 1])
    assert uncertain == pytest.approx([1 / 16, 1 / 4])


@pytest.mark.slow
@pytest.mark.parametrize(("name", "load"), [("layer", 0.5), ("pin, 135 N/mm", 135.0)])
def test_both_statements_of_a_problem_are_the_same(name: str, load: float):
    """On the coarsest mesh and with an accuracy of 1e-2; the meshes of the table agree to 1e-4.

    Along the y axis contact alone holds the body on top: its force is the load.
    """
    problem = two_bodies.PROBLEMS[name]
    touch = problem.touch(1)
    assert touch.force[1] == pytest.approx(load, rel=1e-8)
    value, _, _ = two_bodies.of_bemcontact(problem, 1e-2)
    assert value == pytest.approx(two_bodies.peak_and_end(touch), rel=3e-3)
