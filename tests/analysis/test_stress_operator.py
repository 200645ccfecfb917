"""Stress as a linear function of contact pressures: equal to that of results, additive over load cases."""

from pathlib import Path

import numpy as np
import pytest
from tool_problems import FREE, FREE_CASES, made

import bemcontact
from bemcontact import ProblemError, stress_operator
from bemcontact.problems.conditions import Temperature

MODELS = Path(__file__).parents[2] / "models"


def places(result: bemcontact.Result, count: int = 40) -> np.ndarray:
    """Points inside, and all middles of elements."""
    nodes = result.boundary.points
    rng = np.random.default_rng(3)
    points = rng.uniform(nodes.min((0, 1)), nodes.max((0, 1)), (count, 2))
    at = result._stresses.bodies[0].field.locate(points)
    return np.vstack([points[at.inside], nodes[:, 1]])


@pytest.mark.parametrize(
    "name", ["cylinder_on_plane", "cantilever_curved_surface", "bolt_in_plate", "gallery/hertz_small"]
)
def test_it_gives_the_stress_of_the_result(name: str):
    """To round-off times the condition of the solution; also for a body that contact alone holds."""
    result = bemcontact.solve(bemcontact.load(MODELS / f"{name}.yaml").with_value("accuracy", 0.02))
    points = places(result)
    operator, stress = stress_operator(result, points), result.stress(points)
    found = operator.at(result.solution.pressure, result.solution.rigid_amplitudes)
    largest = abs(stress.components).max()
    assert abs(found.components - stress.components).max() < 1e-10 * largest
    assert abs(found.zz - stress.zz).max() < 1e-10 * largest
    assert (found.kind == stress.kind).all()
    by_hand = operator.pressure @ result.solution.pressure + operator.constant
    assert abs(by_hand[:, :3] - stress.components).max() < 1e-10 * largest
    assert not operator.amplitudes.any()
    difference = operator.contact.compliance - result.contact.compliance
    assert abs(difference).max() < 1e-13 * abs(result.contact.compliance).max()


@pytest.mark.slow
def test_round_off_on_short_elements():
    """Along the boundary digits of displacement are lost: its round-off over the length of an element is a strain.

    The shortest element is 3e-7 of the beam, which moves by a thousand times more than the element is long.
    """
    result = bemcontact.solve(bemcontact.load(MODELS / "gallery" / "beam_on_two_supports.yaml"))
    points, mesh = places(result), result._stresses.bodies[0].field.mesh
    found = stress_operator(result, points).at(result.solution.pressure, result.solution.rigid_amplitudes)
    difference = abs(found.components - result.stress(points).components).max(axis=1)
    inside = found.kind == "inside"
    assert inside.sum() > 10
    assert difference[inside].max() < 1e-12 * abs(found.components).max()
    moved = abs(result.boundary.displacement).max()
    strain = np.finfo(float).eps * moved / mesh.lengths.min()
    assert difference.max() < 8 * strain * 2 * result.problem.material.shear_modulus


def test_loads_of_cases_add_up():
    """The constants of each case are those of the permanent loads and of the case, with its factor."""
    results = bemcontact.solve_cases(made(FREE, **FREE_CASES).with_value("accuracy", None))
    for result in results.results.values():
        points = places(result, 10)
        operator, stress = stress_operator(result, points), result.stress(points)
        found = operator.at(result.solution.pressure)
        assert abs(found.components - stress.components).max() < 1e-10 * abs(stress.components).max()
        assert operator.constant == pytest.approx(operator.loads @ [1, *result.contact.cases.factors])
        assert repr(operator) == f"<StressOperator at {len(points)} points of {result.contact!r}>"  # no arrays


def test_heat_and_weight_are_constants():
    """Volume loads are parts of the constants."""
    base = bemcontact.load(MODELS / "cylinder_on_plane.yaml", variant="stated mesh")
    heat = Temperature(expansion=1e-5, change={"constant": 3, "x": 0.1})
    warm = base.model_copy(update={"loads": base.loads.model_copy(update={"temperature": heat})})
    result = bemcontact.solve(warm)
    points = places(result, 10)
    found = stress_operator(warm, points).at(result.solution.pressure)
    assert abs(found.components - result.stress(points).components).max() < 1e-10 * abs(found.components).max()
    assert abs(found.zz - result.stress(points).zz).max() < 1e-10 * abs(found.zz).max()


def test_refusals():
    """Points outside, points where stress may be infinite, and what has no body."""
    problem = bemcontact.load(MODELS / "cantilever_flat_surface.yaml").with_value("accuracy", 0.05)
    with pytest.raises(ProblemError, match=r"points\[1\].*outside"):
        stress_operator(problem, [[1, 1], [-1, 0]])
    with pytest.raises(ProblemError, match=r"points\[0\].*infinite"):
        stress_operator(problem, [[0, 0], [1, 1]])
    contact = bemcontact.condense(problem)
    with pytest.raises(ProblemError, match="Problem"):
        stress_operator(contact, [[1, 1]])
    with pytest.raises(ProblemError, match="condensed"):
        stress_operator(bemcontact.solve(contact), [[1, 1]])
    operator = stress_operator(problem, [[1, 1]])
    with pytest.raises(ProblemError, match="pressure"):
        operator.at([1.0])
