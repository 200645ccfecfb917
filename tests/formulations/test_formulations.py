"""The history of a solver: each value is that of the point the solver has when it is stopped there."""

import subprocess
import sys
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from contact_problems import in_units, random_contact

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status, Trace, traces_in_turn
from bemcontact.errors import OptionError
from bemcontact.formulations import FORMULATIONS, clarabel, complementarity, qp1, qp2, qp3
from bemcontact.formulations.complementarity import ACCEPTED
from bemcontact.formulations.scaling import scale, scaled_point
from bemcontact.formulations.starts import draw_starts
from bemcontact.options import USES, FormulationName, SolveOptions

N = 9
LOCAL = [
    (qp1, SolveOptions.of("qp1", polish=False)),
    (qp2, SolveOptions.of("qp2", polish=False)),
    (qp2, SolveOptions.of("qp2", polish=False, penalty=0.03)),
]
CYCLE = CondensedContact.from_compliance(
    [[2, -2, -1, 2, 0], [0, 2, -2, 2, -1], [2, 1, 1, -1, 0], [-2, -2, 1, 2, -3], [3, -3, -2, 3, 2]],
    [0.0, -2.0, 1.0, 0.0, -2.0],
)
"""A P-matrix on which the active sets come back, so that Lemke's method follows."""


def counted(solution: ContactSolution) -> list[int]:
    """Numbers of the iterations to which values belong, trace after trace."""
    return [trace.first + i for trace in solution.history for i in range(len(trace.values))]


def of(solution: ContactSolution, quantity: str) -> Array:
    """The values of the one trace of a quantity, none if there is no such."""
    (values,) = [trace.values for trace in solution.history if trace.quantity == quantity] or [()]
    return np.array(values)


def test_quantities_in_turn_are_numbered_on():
    """Two values, none, then one: iterations 1 and 2, and 3."""
    assert traces_in_turn(("a", [4, 2]), ("b", ()), ("c", [1.0])) == (
        Trace(quantity="a", first=1, values=(4.0, 2.0)),
        Trace(quantity="c", first=3, values=(1.0,)),
    )


@pytest.mark.parametrize("k", [0, 1, 2])
@pytest.mark.parametrize(("formulation", "options"), LOCAL)
def test_local_search_goes_down(formulation, options, k):
    """One value for each iteration; infeasibility falls to what each of 5n constraints may keep, the objective to 0.

    They do so but for the round-off of the largest value.
    """
    problem = random_contact(2, N, k)
    for start in draw_starts(problem, 3):
        result = formulation.solve(problem, replace(options, start=start))
        assert result.status is Status.SOLVED
        assert counted(result) == [*range(1, result.iterations + 1)]
        infeasibility, objective = of(result, "infeasibility"), of(result, "objective")
        assert len(infeasibility) == result.search.phase_one_iterations
        assert len(objective) == result.search.phase_two_iterations
        for values in (infeasibility, objective):
            assert (np.diff(values) <= 1e-14 * (1 + values.max(initial=0.0))).all()
        assert (infeasibility[-1:] <= 1e-9 * 5 * N).all()
        assert (np.abs(objective[-1:]) <= 1e-14 * (1 + objective.max(initial=0.0))).all()


@pytest.mark.parametrize("k", [0, 2])
@pytest.mark.parametrize(("formulation", "options"), LOCAL)
def test_objective_of_a_local_search_is_that_of_the_program(formulation, options, k):
    """Stopped after any iteration of phase two: `Program.value` of that point, whose best is 0, without a constant."""
    problem = random_contact(3, N, k)
    starts = draw_starts(problem, 5)
    solutions = [formulation.solve(problem, replace(options, start=start)) for start in starts]
    start, whole = next(pair for pair in zip(starts, solutions, strict=True) if of(pair[1], "objective").size)
    program = formulation.program_of(problem, options)
    U, T = problem.scales
    largest = of(whole, "objective").max()
    for limit in range(whole.search.phase_one_iterations + 1, whole.iterations + 1):
        stopped = formulation.solve(problem, replace(options, start=start, max_iterations=limit))
        values = of(stopped, "objective")
        np.testing.assert_array_equal(values, of(whole, "objective")[: len(values)])
        x = np.concatenate([stopped.displacement / U, stopped.pressure / T])
        terms = abs(x) @ abs(program.hessian) @ abs(x) / 2 + abs(program.linear) @ abs(x)
        rounding = len(x) * np.finfo(float).eps * terms
        assert values[-1] == pytest.approx(program.value(x), abs=1e-14 * (1 + largest) + rounding)
        assert stopped.iterations == limit


def test_infeasible_program_has_no_objective():
    """A gap of -1 - p: no pressure takes the penetration away, and phase two never begins."""
    result = qp1.solve(CondensedContact.from_compliance([[-1.0]], [-1.0]))
    assert result.status is Status.INFEASIBLE
    assert len(of(result, "infeasibility")) == result.iterations
    assert (of(result, "infeasibility") > 0.1).all()
    assert not of(result, "objective").size


@pytest.mark.parametrize("k", [0, 1, 3])
def test_objective_of_qp3_is_that_of_the_point(k):
    """Clarabel stopped after any iteration: the start and each iteration have a value, the free body's constant in it.

    No constraint is violated by more than the reported residual, relative to its terms. Where cvxpy has cut off a
    negative pressure, the point is another one.
    """
    problem = random_contact(4, N, k)
    scaled = scale(problem)
    work = qp3.objective(scaled, np.diag(scaled.weights))
    whole = qp3.solve(problem, SolveOptions.of("qp3", polish=False))
    assert counted(whole) == 2 * [*range(whole.iterations + 1)]
    for limit in range(1, whole.iterations + 1):
        stopped = qp3.solve(problem, SolveOptions.of("qp3", polish=False, max_iterations=limit))
        values, record = of(stopped, "objective"), of(stopped, "infeasibility")
        np.testing.assert_array_equal(values, of(whole, "objective")[: limit + 1])
        p, a = scaled_point(problem, stopped.pressure, stopped.rigid_amplitudes)
        if p.all():
            assert values[-1] == pytest.approx(work.value(p, a), rel=1e-12, abs=1e-14 * (1 + p @ p))
        gap, balance = scaled.gap(p, a), np.abs(scaled.equilibrium.T @ p + scaled.motion_load)
        terms = max(1.0, sum(map(np.linalg.norm, (p, a, gap, scaled.offset, scaled.motion_load))))
        assert max(-p.min(), -gap.min(), balance.max(initial=0.0)) <= (record[-1] + 1e-15) * terms
    assert of(whole, "objective")[-1] == pytest.approx(0, abs=1e-10)
    assert of(whole, "infeasibility")[-1] <= clarabel.GOOD


@pytest.mark.parametrize("k", [0, 2])
def test_units_of_wide_gaps_are_taken_back(k):
    """One gap of 1e7 drowns the pressures in one scaling; whichever attempt answers, the objective is the point's.

    Up to the negative pressures that cvxpy cuts off, 1e-9 of the widest gap at most.
    """
    problem = random_contact(5, N, k)
    problem = replace(problem, initial_gap=problem.initial_gap + 1e7 * np.eye(N)[0])
    scaled = scale(problem)
    work = qp3.objective(scaled, np.diag(scaled.weights))
    result = qp3.solve(problem, SolveOptions.of("qp3", polish=False))
    assert counted(result) == 2 * [*range(result.iterations + 1)]
    p, a = scaled_point(problem, result.pressure, result.rigid_amplitudes)
    assert of(result, "objective")[-1] == pytest.approx(work.value(p, a), rel=1e-6, abs=1e-9 * scaled.offset.max())
    assert result.status is Status.SOLVED


@pytest.mark.parametrize("k", [0, 1, 3])
def test_residual_of_the_active_set_ends_at_that_of_the_solution(k):
    problem = random_contact(6, 15, k)
    result = complementarity.solve(problem)
    (trace,) = result.history
    assert (trace.quantity, trace.first, len(trace.values)) == ("residual", 1, result.iterations)
    assert trace.values[-1] <= ACCEPTED < trace.values[0]
    p, a = scaled_point(problem, result.pressure, result.rigid_amplitudes)
    assert scale(problem).residual(p, a) == pytest.approx(trace.values[-1], abs=1e-15)


def test_lemke_takes_over_in_the_history():
    """Active set, pivots down to z0 = 0, and one step from there, numbered on."""
    result = complementarity.solve(CYCLE)
    first, path, last = result.history
    assert [trace.quantity for trace in result.history] == ["residual", "infeasibility", "residual"]
    assert counted(result) == [*range(1, result.iterations + 1)]
    assert min(first.values) > ACCEPTED
    assert path.values[-1] == 0.0
    assert len(last.values) == 1
    assert last.values[0] <= ACCEPTED


def test_few_pivots_after_a_cycle():
    """Beside the five points of the cycle 400 stand alone and are right at once: no pivot is spent on them."""
    alone = np.where(np.arange(400) % 2, -1.0, 1.0)
    n = CYCLE.size
    compliance = np.eye(n + 400)
    compliance[:n, :n] = CYCLE.compliance
    result = complementarity.solve(CondensedContact.from_compliance(compliance, np.append(CYCLE.offset, alone)))
    assert result.status is Status.SOLVED
    assert len(of(result, "infeasibility")) <= 2 * n
    np.testing.assert_allclose(result.pressure, np.append(complementarity.solve(CYCLE).pressure, alone < 0), atol=1e-14)


def test_the_ray_of_lemke_is_reported():
    """With M = -1, q = -1 z0 enters at 1/2, which is 1 over |M| + |q|, and stays there: a ray is no pivot.

    Pressure and gap may be exchanged in it, so that Lemke's method ends so from the set of the cycle too.
    """
    result = complementarity.solve(CondensedContact.from_compliance([[-1.0]], [-1.0]))
    assert result.status is Status.INFEASIBLE
    assert counted(result) == [*range(1, result.iterations + 1)]
    assert [trace.values for trace in result.history if trace.quantity == "infeasibility"] == [(0.5,), (0.5,)]


@pytest.mark.parametrize("name", FORMULATIONS)
@pytest.mark.parametrize(("length", "stress"), [(1e-3, 1e6), (25.4, 1e-4)])
def test_units_do_not_matter(name, length, stress):
    """All numbers are free of units, so that only round-off differs; 1e-9 leaves it six digits to grow."""
    for problem in (random_contact(7, N, 1), *([CYCLE] if name == FormulationName.COMPLEMENTARITY else [])):
        options = SolveOptions.of(name, polish=name == FormulationName.COMPLEMENTARITY)
        one, two = (FORMULATIONS[name](p, options).history for p in (problem, in_units(problem, length, stress)))
        assert [(trace.quantity, trace.first) for trace in one] == [(trace.quantity, trace.first) for trace in two]
        for ours, theirs in zip(one, two, strict=True):
            np.testing.assert_allclose(theirs.values, ours.values, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", ["qp1", "qp2", "qp3"])
def test_polish_adds_nothing(name):
    problem = random_contact(8, N, 1)
    polished, plain = (FORMULATIONS[name](problem, SolveOptions.of(name, polish=polish)) for polish in (True, False))
    assert polished.polished
    assert polished.history == plain.history


def test_every_name_has_a_formulation_and_its_options():
    assert [*FORMULATIONS] == [*USES] == [*FormulationName]


@pytest.mark.parametrize("name", FORMULATIONS)
def test_every_formulation_solves_and_bears_its_name(name):
    """One point with interference 3 and compliance 2: p = 3/2."""
    solution = FORMULATIONS[name](CondensedContact.from_compliance([[2.0]], [-3.0]), SolveOptions.of(name))
    assert solution.formulation == name
    assert solution.status is Status.SOLVED
    np.testing.assert_allclose(solution.pressure, [1.5], rtol=1e-14)


@pytest.mark.parametrize("limit", [0, -1, 2.5, "many", True])
def test_a_limit_of_iterations_that_is_no_whole_number_above_zero_is_refused(limit):
    with pytest.raises(OptionError, match="limit of iterations must be a whole number of at least 1"):
        SolveOptions(max_iterations=limit)


def test_the_repr_of_a_solution_is_one_line():
    solution = FORMULATIONS["qp1"](CondensedContact.from_compliance([[2.0]], [-3.0]), SolveOptions.of("qp1"))
    assert repr(solution) == "<ContactSolution by qp1: solved, 1 contact points>"


def test_options_do_not_change():
    with pytest.raises(FrozenInstanceError):
        SolveOptions().polish = False  # pyright: ignore[reportAttributeAccessIssue]


def test_importing_the_formulations_does_not_import_cvxpy():
    """Half a second that only QP3 has to pay."""
    code = "import sys, bemcontact.formulations; sys.exit('cvxpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
