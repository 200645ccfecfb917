"""Sensitivities to Young's modulus: closed forms, scaling, and differences on one mesh with the same pairs."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from several_bodies import GUIDED, HELD, Spec, block, elastic, stated

import bemcontact
from bemcontact import Problem
from bemcontact.adaptivity import resting_contacts
from bemcontact.analysis.follow import stated_value
from bemcontact.arrays import Array
from bemcontact.bem.discretization import body_of
from bemcontact.errors import ProblemError
from bemcontact.parametric.sensitivity import Sensitivities

MODELS = Path(__file__).parents[2] / "models"
DISK, WALL = "bodies.disk.material.young_modulus", "bodies.wall.material.young_modulus"


def half_disk(elements: int) -> Spec:
    """Lower half of a disk of radius 3, whose lowest place is 0.01 beside the middle between two nodes."""
    under = {"name": "under", "kind": "arc", "start": [-2.8, 3], "end": [3.2, 3], "center": [0.2, 3]}
    return {"outer": [{**under, "elements": elements}, {"name": "top", "end": [-2.8, 3], "elements": 8}]}


def pressed(
    between: tuple[str, str] = ("disk/under", "wall/top"),
    top: Mapping[str, Any] | None = None,
    loads: Mapping[str, Any] | None = None,
) -> Problem:
    """A disk that is pressed on a block of twice the modulus, with a clearance of 0.01."""
    wall = elastic(block((-4, 3), (-4, 0), (8, 8, 30, 8)), HELD, 2000.0, loads=dict(loads or {}))
    move = {"displacement": {"x": 0.01, "y": -0.05}} if top is None else dict(top)
    return stated(
        name="disk on a block", bodies={"disk": elastic(half_disk(30), {"top": move}), "wall": wall}, accuracy=None,
        contacts={"c": {"between": between, "gap": 0.01}},
    )  # fmt: skip


def at_rest(problem: Problem) -> Problem:
    """The problem with contacts after the motion of its bodies."""
    found = bemcontact.solve(problem).problem
    assert found is not None
    return found


def difference(problem: Problem, key: str, value: float, step: float) -> Array:
    """Central difference (n,) of the pressure by a value, with the contacts of a problem."""
    ends = [problem.with_value(key, value + side).on_contacts_of(problem) for side in (step, -step)]
    with patch.object(resting_contacts, "RESTING", np.inf):
        after, before = (bemcontact.solve(end).solution.pressure for end in ends)
    return (after - before) / (2 * step)


def assert_as_differences(problem: Problem, *keys: str) -> None:
    """Rates against problems with the same pairs, solved anew a step of 1e-6 to both sides.

    Curvature leaves 1e-12, and round-off 1e-13 / 1e-6 by the condition of the equations of the body.
    """
    found, resting = bemcontact.sensitivities(problem, keys), at_rest(problem)
    for key in keys:
        value = stated_value(problem, key)
        expected = difference(resting, key, value, 1e-6 * value)
        assert np.abs(found[key].rising.pressure - expected).max() < 1e-5 * np.abs(expected).max()


def relative_sum(problem: Problem, rates: Sensitivities, *keys: str) -> np.ndarray:
    """Sum of x dp/dx over the values of keys."""
    return np.sum([stated_value(problem, key) * rates[key].rising.pressure for key in keys], axis=0)


@pytest.mark.slow
@pytest.mark.parametrize("order", [("disk/under", "wall/top"), ("wall/top", "disk/under")])
@pytest.mark.parametrize("change", [0.0, 10.0])
def test_modulus_of_each_of_two_bodies_against_differences(order: tuple[str, str], change: float):
    """With prescribed displacements, and a temperature, which strains the block by the same at any modulus."""
    loads = {"temperature": {"expansion": 1e-4, "change": change}, "gravity": {"density": 1.0, "acceleration": [0, -9]}}
    assert_as_differences(pressed(order, loads=loads), DISK, WALL)


def test_pressures_go_with_all_moduli_where_displacements_are_prescribed():
    """Without forces, pressures are multiplied as all moduli are: the sum of E dp/dE is p."""
    problem = pressed(loads={"temperature": {"expansion": 1e-4, "change": 10}})
    rates = bemcontact.sensitivities(problem, [DISK, WALL])
    pressure = rates.solution.pressure
    assert np.abs(relative_sum(problem, rates, DISK, WALL) - pressure).max() < 1e-9 * pressure.max()


def test_loads_and_moduli_scale_pressures_together():
    """Pressures are multiplied as all moduli and forces are: the sum of E dp/dE and of f dp/df is p."""
    problem = pressed(top={"displacement": {"x": 0.0}, "traction": {"y": -5.0}})
    force = "bodies.disk.conditions.top.traction.y"
    rates = bemcontact.sensitivities(problem, [DISK, WALL, force])
    pressure = rates.solution.pressure
    assert np.abs(relative_sum(problem, rates, DISK, WALL, force) - pressure).max() < 1e-9 * pressure.max()


def test_one_material_of_two_bodies_is_the_modulus_of_both():
    """The rate of a named material is the sum of those of the bodies that are made of it."""
    apart = pressed(top={"traction": {"y": -5.0}, "displacement": {"x": 0.0}}).with_value(WALL, 1000.0)
    data = apart.model_dump()
    for body in data["bodies"].values():
        body["material"] = "steel"
    named = Problem(**{**data, "materials": {"steel": {"young_modulus": 1000.0, "poisson_ratio": 0.3}}})
    whole = bemcontact.sensitivities(named, ["materials.steel.young_modulus"])["materials.steel.young_modulus"]
    both = bemcontact.sensitivities(apart, [DISK, WALL])
    expected = both[DISK].rising.pressure + both[WALL].rising.pressure
    assert np.abs(whole.rising.pressure - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.slow
def test_hertz():
    """The peak goes with the square root of E*: d ln p / d ln E is 1/6 for the hard and 1/3 for the soft cylinder.

    The accuracy of the peak is 0.001, and b/R is 0.025. Since the end of contact rests at a node, a rate has a larger
    error than the peak: 0.005 is allowed.
    """
    problem = bemcontact.load(MODELS / "bodies" / "two_cylinders.yaml")
    keys = ["materials.hard.young_modulus", "materials.soft.young_modulus"]
    rates = bemcontact.sensitivities(problem, keys)
    peak = rates.solution.pressure.max()
    each = []
    for key in keys:
        rate = rates[key].rising.peak
        assert rate is not None
        each.append(stated_value(problem, key) * rate / peak)
    assert each == pytest.approx([1 / 6, 1 / 3], rel=0.005)


def bonded() -> Problem:
    """A block on a layer that is bonded to its support of another modulus; the block is half as wide."""
    press = {"left": {"displacement": {"x": 0}}, "top": {"pressure": 3}}
    bodies = {
        "up": elastic(block((0, 1), (1, 2), (4, 4, 4, 4)), press, 900.0),
        "layer": elastic(block((0, 2), (0.5, 1), (8, 4, 8, 4)), GUIDED, 300.0),
        "low": elastic(block((0, 2), (-1, 0.5), (8, 4, 8, 4)), {**GUIDED, "bottom": {"displacement": {"y": 0}}}),
    }
    return stated(
        name="layer", bodies=bodies, contacts={"c": {"between": ["up/bottom", "layer/top"]}}, accuracy=None,
        bonded={"glue": [["layer/bottom"], ["low/top"]]},
    )  # fmt: skip


@pytest.mark.slow
def test_modulus_of_each_of_two_bonded_bodies_against_differences():
    """The compliance of a layer and its support is no multiple of 1/E of either."""
    moduli = [f"bodies.{body}.material.young_modulus" for body in ("up", "layer", "low")]
    assert_as_differences(bonded(), *moduli)
    rates = bemcontact.sensitivities(bonded(), moduli)
    largest = max(np.abs(stated_value(bonded(), key) * rates[key].rising.pressure).max() for key in moduli)
    rest = relative_sum(bonded(), rates, *moduli)  # under forces alone, without gaps: zero
    assert np.abs(rest).max() < 1e-8 * largest


@pytest.mark.slow
@pytest.mark.parametrize("held", [{"normal": 3e3, "tangent": 500.0}, {"normal": 3e3}])
def test_modulus_of_a_body_on_springs_and_of_one_beside_it_against_differences(held: Spec):
    """Springs do not become stiffer with the body; temperature strains it by the same, and without a tangent it slides.

    Prescribed displacements hold the disk, and one side of the block where springs let it slide.
    """
    loads = {"temperature": {"expansion": 1e-4, "change": 10}, "gravity": {"density": 0.3, "acceleration": [0, -9]}}
    problem = pressed(loads=loads).with_value("bodies.wall.conditions.bottom", {"spring": held})
    if "tangent" not in held:
        problem = problem.with_value("bodies.wall.conditions.right", {"displacement": {"x": 0.002}})
    assert_as_differences(problem, DISK, WALL)


def test_bodies_moduli_springs_and_displacements_scale_together():
    """Pressures are multiplied as all moduli and springs are: the sum of E dp/dE and of K dp/dK is p.

    Differences give dp/dK.
    """
    spring = "bodies.wall.conditions.bottom.spring.normal"
    problem = pressed().with_value("bodies.wall.conditions.bottom", {"spring": {"normal": 300.0}})
    problem = problem.with_value("bodies.wall.conditions.right", {"displacement": {"x": 0.0}})
    rates = bemcontact.sensitivities(problem, [DISK, WALL])
    of_springs = 300.0 * difference(at_rest(problem), spring, 300.0, 3e-4)
    whole = relative_sum(problem, rates, DISK, WALL) + of_springs
    pressure = rates.solution.pressure
    assert np.abs(whole - pressure).max() < 1e-5 * pressure.max()


def test_modulus_of_bonded_bodies_on_springs_against_differences():
    """The support is on springs, and the layer is bonded to it: bonds and gaps follow both."""
    problem = bonded().with_value("bodies.low.conditions.bottom", {"spring": {"normal": 200.0, "tangent": 30.0}})
    assert_as_differences(problem, *(f"bodies.{body}.material.young_modulus" for body in ("up", "layer", "low")))


def test_modulus_of_one_body_on_springs():
    """A roller that is loaded presses on a beam on an elastic foundation, whose bending follows the springs."""
    beam = bemcontact.load(MODELS / "gallery" / "beam_on_springs.yaml", variant="stated mesh")
    assert_as_differences(beam, "material.young_modulus")


@pytest.fixture(scope="module")
def cylinder() -> Problem:
    return bemcontact.load(MODELS / "cylinder_on_plane.yaml", variant="stated mesh").with_value("accuracy", None)


def test_modulus_of_one_body(cylinder: Problem):
    """Differences in pressures; by statics, no change of the force."""
    assert_as_differences(cylinder, "material.young_modulus")
    rates = bemcontact.sensitivities(cylinder, ["material.young_modulus"])["material.young_modulus"].rising
    np.testing.assert_allclose(rates.resultant, 0, atol=1e-12)


def test_modulus_of_a_body_with_prescribed_displacements(cylinder: Problem):
    """Pushed down by 0.1 instead of loaded: the free displacement is the same at any E, and pressures go with E."""
    pushed = cylinder.with_value("conditions.top", {"displacement": {"y": -0.1}})
    found = bemcontact.sensitivities(pushed, ["material.young_modulus"])
    pressure = found.solution.pressure
    expected = pressure / 1000.0
    np.testing.assert_allclose(
        found["material.young_modulus"].rising.pressure, expected, rtol=0, atol=1e-9 * expected.max()
    )


def test_pairs_are_kept():
    """Normals between both bodies lean to the stiffer one; those of a problem on the pairs of another do not change."""
    problem = pressed()
    stiff = problem.with_value(DISK, 8000.0)
    normals = body_of(problem).points.normals
    assert not np.array_equal(body_of(stiff).points.normals, normals)
    kept = body_of(stiff.on_contacts_of(problem)).points
    np.testing.assert_array_equal(kept.normals, normals)
    other = stiff.with_value("contacts.c.gap", 0.03).on_contacts_of(problem)
    np.testing.assert_allclose(body_of(other).points.gap - kept.gap, 0.02, rtol=1e-12)


def test_surface_that_depends_on_the_modulus_is_refused():
    """A body on its own contour, deflected by loads: with half the modulus it is deflected twice as far."""
    surface = {
        "kind": "deflected_contour", "direction": [0, 1],
        "conditions": {"left": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": 1}},
    }  # fmt: skip
    problem = stated(
        name="contour", material={"young_modulus": 1000, "poisson_ratio": 0.3}, accuracy=None,
        boundary=block((0, 4), (0, 1), (8, 2, 8, 2)),
        conditions={"left": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": 2}},
        contact_zones={"seat": {"edges": "bottom", "surface": surface}},
    )  # fmt: skip
    with pytest.raises(ProblemError, match="the surface that a body touches depends on this modulus"):
        bemcontact.sensitivities(problem, ["material.young_modulus"])
