"""Stress in models: that of results and of `Stress`, in any units; the price of a bound."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import cvxpy as cp
import numpy as np
import pytest
from contact_problems import resting
from modelling.tool_contact import tool_contact
from tool_problems import FREE, FREE_CASES, made

import bemcontact
from bemcontact import ProblemError, StressOperator
from bemcontact.formulations import complementarity
from bemcontact.modelling.parameters import value_of

GALLERY = Path(__file__).parents[2] / "models" / "gallery"
POINTS = [[0.3, -2.0], [2.0, -3.0], [4.0, -1.0]]


@cache
def operator(name: str = "eccentric_punch") -> StressOperator:
    problem = bemcontact.load(GALLERY / f"{name}.yaml", variant="stated mesh").with_case("off the middle")
    return bemcontact.stress_operator(problem, POINTS)


def test_it_is_the_stress_of_the_result_for_any_factors_of_load_cases():
    """Linear in pressures and factors: expressions and `Result.stress` are the same sum."""
    problem = made(FREE, **FREE_CASES).with_value("accuracy", None)
    results = bemcontact.solve_cases(problem).results
    first = next(iter(results.values()))
    assert first.boundary is not None
    points = first.boundary.points[3:9, 1]
    of_body = bemcontact.stress_operator(first, points)
    model = bemcontact.model(of_body.contact)
    stress = model.stress(of_body)
    assert model.case_factors is not None
    for result in results.values():
        model.case_factors.value = result.contact.cases.factors
        assert model.solve().contact_state
        expected = result.stress(points)
        largest = abs(expected.components).max()
        assert abs(value_of(stress.components) - expected.components).max() < 1e-9 * largest
        assert abs(value_of(stress.zz) - expected.zz).max() < 1e-9 * largest
        for name in ("von_mises", "max_shear", "in_plane_shear"):
            assert abs(getattr(stress, name).value - getattr(expected, name)).max() < 1e-9 * largest, name


def test_measures_are_convex_and_equal_those_of_stress():
    """At random pressures of either sign, so that σzz is the largest, the middle and the smallest principal stress."""
    model = bemcontact.model(operator().contact)
    stress = model.stress(operator())
    assert stress.components.is_affine()
    assert stress.zz.is_affine()
    assert model.motions is not None
    model.motions.variables()[0].value = np.zeros(2)
    rng = np.random.default_rng(0)
    for _ in range(20):
        model.pressure.variables()[0].value = rng.standard_normal(operator().contact.size)
        expected = operator().at(value_of(model.pressure))
        for name in ("von_mises", "max_shear", "in_plane_shear"):
            measure = getattr(stress, name)
            assert measure.is_convex()
            assert measure.value == pytest.approx(getattr(expected, name), rel=1e-10)


def largest_factor(limit: float) -> tuple[float, float, np.ndarray]:
    """The largest factor of the tool's load under a limit of stress, its price, and the pressure; fixed contact set.

    The punch has no gap without load, so the contact set is the same for all factors.
    """
    contact = operator().contact
    model = bemcontact.model(contact)
    state = model.solve()
    assert state.solution is not None
    closed = contact.touching(state.solution.pressure, state.solution.displacement)
    factor = cp.Variable()
    bound = model.stress(operator()).von_mises <= limit
    balance = contact.equilibrium.T @ model.pressure + factor * contact.motion_load == 0
    fixed = [model.gap[closed] == 0, model.gap[~closed] >= 0, model.pressure[closed] >= 0, model.pressure[~closed] == 0]
    fixed = [part for part in fixed if part.size]
    model.solve(problem=cp.Problem(cp.Maximize(factor), [balance, bound, *fixed]))
    return value_of(factor).item(), float(np.asarray(bound.dual_value, float).sum()), value_of(model.pressure)


def test_the_price_of_a_bound_is_the_derivative_of_the_largest_load():
    """Against a difference quotient of two limits; and the pressure is that of the contact problem with the load."""
    limit, step = 250.0, 1.0
    factor, price, pressure = largest_factor(limit)
    quotient = (largest_factor(limit + step)[0] - largest_factor(limit - step)[0]) / (2 * step)
    assert price == pytest.approx(quotient, rel=1e-5)
    contact = operator().contact
    solved = complementarity.solve(replace(contact, motion_load=factor * contact.motion_load)).pressure
    assert abs(solved - pressure).max() < 1e-5 * solved.max()
    assert operator().at(solved).von_mises.max() == pytest.approx(limit, rel=1e-5)


def test_a_bound_in_a_model_is_kept():
    """The optimum is no contact state then, and the result says so."""
    model = bemcontact.model(operator().contact)
    free = model.solve()
    assert free.pressure is not None
    limit = 0.9 * operator().at(free.pressure).von_mises.max()
    bounded = model.solve(extra_constraints=[model.stress(operator()).von_mises <= limit])
    assert not bounded.contact_state
    assert bounded.pressure is not None
    assert operator().at(bounded.pressure).von_mises.max() == pytest.approx(limit, rel=1e-6)


def test_an_operator_of_another_problem_is_refused():
    """The error says where to take the contact from."""
    other = resting()
    with pytest.raises(ProblemError, match=r"another contact problem.*operator\.contact"):
        bemcontact.model(other).stress(operator())
    with pytest.raises(ProblemError, match="stress_operator"):
        bemcontact.model(operator().contact).stress(POINTS)  # pyright: ignore[reportArgumentType]


def in_units(length: float, stress: float) -> StressOperator:
    """Random linear stress of a body with load cases, in units that make its numbers larger by these factors."""
    contact, rng = tool_contact(units=(length, stress)), np.random.default_rng(4)
    n, k, c = contact.size, contact.free_motions, len(contact.cases)
    return StressOperator(
        contact=contact,
        points=np.zeros((3, 2)),
        kind=np.full(3, "inside"),
        pressure=rng.standard_normal((3, 4, n)),
        amplitudes=np.zeros((3, 4, k)),
        loads=0.1 * stress * rng.standard_normal((3, 4, 1 + c)),
    )


@pytest.mark.slow
@pytest.mark.parametrize(("length", "stress"), [(1e-9, 1e6), (1e6, 1.0)])
def test_units_do_not_matter(length: float, stress: float):
    """A bound in a model and a design under a limit: to the tolerance of the solver."""
    bounded, designed = [], []
    for L, S in ((1.0, 1.0), (length, stress)):
        of_body = in_units(L, S)
        model = bemcontact.model(of_body.contact)
        free = model.solve()
        assert free.pressure is not None
        limit = 0.95 * float(of_body.at(free.pressure).von_mises.max())
        pressure = model.solve(extra_constraints=[model.stress(of_body).von_mises <= limit]).pressure
        assert pressure is not None
        bounded.append(pressure / S)
        relief = bemcontact.Relief(lower=0, upper=0.2 * L, slope=0.5)
        designed.append(bemcontact.design_gap(of_body.contact, relief, goal="von_mises", stress=of_body).value / S)
    np.testing.assert_allclose(bounded[1], bounded[0], atol=1e-6 * bounded[0].max())
    assert designed[1] == pytest.approx(designed[0], rel=1e-6)
