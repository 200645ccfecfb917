"""QP2: its objective, the penalty and its limits, and equilibrium that is only penalized."""

from dataclasses import replace

import numpy as np
import pytest
from contact_problems import in_units, random_contact, resting
from scipy.linalg import null_space

from bemcontact.analysis.solve import solve as judged
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import Status
from bemcontact.errors import OptionError, ProblemError
from bemcontact.formulations import complementarity, qp2
from bemcontact.formulations.multistart import multistart
from bemcontact.formulations.scaling import contact_residual
from bemcontact.formulations.starts import Start, draw_starts
from bemcontact.options import Equilibrium, Rows, SolveOptions, Weights

PENALIZED = SolveOptions.of("qp2", equilibrium=Equilibrium.PENALTY)


@pytest.mark.parametrize("gap", [0.0, 1.0])
def test_the_least_load_of_all_has_an_answer(gap: float):
    """5e-324, of which the displacement is zero; warnings are errors in tests."""
    contact = CondensedContact.from_compliance(
        [[2.0, 1.0], [1.0, 2.0]], [gap, gap], rigid_motions=[[1.0], [1.0]], motion_load=[-5e-324]
    )
    assert judged(contact, "qp2").certified


@pytest.mark.parametrize("length", [1.0, 0.1])
@pytest.mark.parametrize("stress", [1.0, 1e3])
@pytest.mark.parametrize("k", [0, 2])
def test_objective_in_the_units_of_the_user(k, length, stress):
    """F2 = pᵀJδ + (1/μ)|K u_n - B p - r|² with the raw μ, over U T max J: pins the objective, and what raw means."""
    rng = np.random.default_rng(3)
    one = random_contact(1, 8, k)
    condensed = in_units(one, length, stress)
    U, T = condensed.scales
    options = SolveOptions.of("qp2", penalty=0.3)
    program = qp2.program_of(condensed, options)
    raw = 0.3 * qp2.penalty_scale(condensed, options)
    K, B, r = condensed.stiffness_rows
    for _ in range(4):
        u_n, p = rng.standard_normal((2, 8))
        x, error = np.concatenate([u_n, p]), K @ (u_n * U) - B @ (p * T) - r
        work = (p * T) @ (condensed.weights * (condensed.initial_gap + u_n * U))
        expected = (work + error @ error / raw) / (U * T * condensed.weights.max())
        assert program.value(x) == pytest.approx(expected, rel=1e-10)
        quadratic = 0.5 * x @ program.hessian @ x + program.linear @ x
        constant = program.value(np.zeros(16))  # no pressure, no work: (1/μ)|r|²
        assert quadratic + constant == pytest.approx(program.value(x), rel=1e-9)


@pytest.mark.parametrize("penalty", [1e-2, 1.0, 100.0])
@pytest.mark.parametrize("rows", [*Rows])
@pytest.mark.parametrize("k", [0, 1, 2, 3])
def test_agrees_with_the_direct_solver(k, rows, penalty):
    """The contact state is the only stationary point, whatever μ is; 1e-9 polished, 1e-10 as the solver leaves it."""
    for seed in range(2):
        problem = random_contact(seed, 12, k)
        direct = complementarity.solve(problem)
        peak, U = direct.pressure.max(), problem.scales.displacement
        for polish in (False, True):
            solution = qp2.solve(problem, SolveOptions.of("qp2", rows=rows, penalty=penalty, polish=polish))
            assert solution.status is Status.SOLVED
            np.testing.assert_allclose(solution.pressure, direct.pressure, atol=1e-10 * peak)
            np.testing.assert_allclose(solution.displacement, direct.displacement, atol=1e-10 * U)


@pytest.mark.parametrize("rows", [*Rows])
@pytest.mark.parametrize("k", [0, 1, 2])
def test_limit_of_convexity(k, rows):
    """On the null space of its equations QP2's Hessian is semidefinite a little below the limit, and not above it."""
    problem = random_contact(6, 7, k)
    limit = qp2.convexity_limit(problem, SolveOptions.of("qp2", rows=rows))
    assert limit > 0
    for factor, convex in ((0.999, True), (1.001, False)):
        program = qp2.program_of(problem, SolveOptions.of("qp2", rows=rows, penalty=factor * limit))
        free = null_space(program.equations.matrix) if k else np.eye(len(program.lower))
        values = np.linalg.eigvalsh(free.T @ program.hessian @ free)
        assert (values[0] >= -1e-13 * values[-1]) == convex


def test_the_penalty_and_its_limit_are_reported():
    problem = random_contact(6, 7, 1)
    options = SolveOptions.of("qp2", penalty=0.5)
    search = qp2.solve(problem, options).search
    assert search is not None
    penalty = search.penalty
    assert penalty is not None
    assert penalty.value == 0.5
    assert penalty.raw == 0.5 * qp2.penalty_scale(problem, options)
    assert penalty.convexity_limit == qp2.convexity_limit(problem, options)
    assert penalty.dimension == "p/L²"
    assert penalty.convexity_limit_raw == pytest.approx(penalty.convexity_limit * penalty.raw / 0.5, rel=1e-15)


@pytest.mark.parametrize("penalty", [0.0, -1.0, np.inf, np.nan, 1e-300, 9e-9, 1.1e8, 1e300, "x", None, True])
def test_a_penalty_that_is_none_is_refused(penalty):
    """Beyond 1e±8 less than eight of sixteen digits are left of the smaller term, or of its numbers nothing at all."""
    with pytest.raises(OptionError, match=r"number from 1e-08 to 1e\+08; found .* round-off"):
        SolveOptions.of("qp2", penalty=penalty)


@pytest.mark.parametrize("penalty", [1e-8, 1e8])
@pytest.mark.parametrize("rows", [*Rows])
@pytest.mark.parametrize("k", [0, 1, 2])
def test_the_ends_of_the_range_lead_to_the_contact_state(k, rows, penalty):
    problem = random_contact(2, 12, k)
    direct = complementarity.solve(problem)
    solution = qp2.solve(problem, SolveOptions.of("qp2", rows=rows, penalty=penalty, polish=False))
    assert solution.status is Status.SOLVED
    np.testing.assert_allclose(solution.pressure, direct.pressure, atol=1e-8 * direct.pressure.max())


@pytest.mark.parametrize("k", [0, 1, 2])
def test_all_stationary_points_are_the_contact_state(k):
    """No start and no penalty leads elsewhere, below the limit of convexity or above; the proof heads the module."""
    problem = random_contact(4, 8, k)
    direct = complementarity.solve(problem)
    for penalty in (0.01, 1.0, 1e3):
        for start in draw_starts(problem, 10, seed=1):
            computed = qp2.solve(problem, SolveOptions.of("qp2", penalty=penalty, start=start, polish=False))
            assert computed.status is Status.SOLVED
            np.testing.assert_allclose(computed.pressure, direct.pressure, atol=1e-9 * direct.pressure.max())


def negative_corner() -> CondensedContact:
    """One quadratic element: J = [[4, 2, -1], [2, 16, 2], [-1, 2, 4]]/30."""
    J = np.array([[4.0, 2.0, -1.0], [2.0, 16.0, 2.0], [-1.0, 2.0, 4.0]]) / 30
    M = np.array([[2.0, 0.0, 1.0], [0.0, 0.5, 0.0], [1.0, 0.0, 2.0]])
    return replace(CondensedContact.from_compliance(M, [-1.0, 0.2, 0.6], J.sum(axis=1)), consistent_weights=J)


@pytest.mark.parametrize("rows", [*Rows])
def test_the_ray_of_consistent_weights(rows):
    """Above the limit the ray keeps all bounds and has negative curvature; just below, no pair of points does."""
    problem = negative_corner()
    options = SolveOptions.of("qp2", Weights.CONSISTENT, rows=rows, penalty=1e6)
    ray = qp2.two_point_ray(problem, options)
    assert ray is not None
    assert (ray.direction >= 0).all()
    program = qp2.program_of(problem, options)
    assert ray.direction @ program.hessian @ ray.direction < 0
    below = replace(options, penalty=ray.limit * (1 - 1e-9))
    assert qp2.two_point_ray(problem, below) is None
    hessian = qp2.program_of(problem, below).hessian
    for i, j in np.ndindex(3, 3):
        opened, pressed, mixed = hessian[i, i], hessian[3 + j, 3 + j], hessian[i, 3 + j]
        assert mixed >= -np.sqrt(opened * pressed) * (1 + 1e-12)
    at = replace(options, penalty=ray.limit * (1 + 1e-6))
    curvature = qp2.two_point_ray(problem, at).direction
    assert curvature @ qp2.program_of(problem, at).hessian @ curvature < 0


def test_consistent_weights_above_their_limit_are_refused():
    with pytest.raises(
        ProblemError, match=r"no minimum with consistent weights .* falls without end .* take a penalty"
    ):
        qp2.solve(negative_corner(), SolveOptions.of("qp2", weights=Weights.CONSISTENT, penalty=1e6))


def test_consistent_weights_below_their_limit_miss_the_contact_state():
    """QP2 trades equations for work below zero, in proportion to μ, as the residual shows; nothing is polished."""
    problem = negative_corner()
    residuals = []
    for penalty in (1e-3, 1e-2):
        solution = qp2.solve(problem, SolveOptions.of("qp2", weights=Weights.CONSISTENT, penalty=penalty))
        assert solution.status is Status.LOCAL_MINIMUM
        assert not solution.polished
        assert solution.search.objective < 0
        assert "an objective of 0 certifies nothing" in solution.notes[0]
        residuals.append(contact_residual(problem, solution))
    assert residuals[1] == pytest.approx(10 * residuals[0], rel=0.01)
    computed = multistart(problem, SolveOptions.of("qp2", "consistent", penalty=1e-3, starts=5))
    assert computed.solved == 0


def test_a_lifted_body_is_stationary_but_not_the_solution():
    """Without pressure, far off: Kᵀ times the residual V load is zero, and Jδ is more than the penalty asks of p."""
    problem = resting()
    lifted = Start(pressure=np.zeros(7), displacement=np.full(7, 1e3))
    result = judged(problem, "qp2", equilibrium="penalty", start=lifted)
    solution = result.solution
    assert solution.status is Status.LOCAL_MINIMUM
    assert not solution.pressure.any()
    assert solution.search.objective > 0.1
    assert not result.certified
    assert not solution.polished
    assert any("stationary but not the solution" in note for note in result.notes)
    assert any("lifted off its support" in note for note in result.notes)
    exact = judged(problem, "qp2", start=lifted)
    assert exact.certified
    assert solution.search.penalty.convexity_limit == 0.0


def slender(n: int = 20) -> CondensedContact:
    """A cantilever of unit length and stiffness on a surface that asks for the same pressure at all points."""
    x = np.linspace(0.05, 1.0, n)
    least, most = np.minimum.outer(x, x), np.maximum.outer(x, x)
    M = least**2 * (3 * most - least) / 6
    return CondensedContact.from_compliance(M, -M.sum(axis=1))


def test_compliance_rows_of_a_slender_body_hide_errors_of_pressure():
    """At cond M = 1e7 a tiny objective goes with a wrong pressure; stiffness rows, or the polish, see it.

    Those are right to 1e-8: round-off of 1e-16 times the condition number is 1e-9.
    """
    problem = slender(40)
    assert np.linalg.cond(problem.compliance) > 1e7
    rough = qp2.solve(problem, SolveOptions.of("qp2", rows=Rows.COMPLIANCE, polish=False))
    assert rough.search.objective < 1e-9
    assert np.abs(rough.pressure - 1).max() > 0.1
    stiff = qp2.solve(problem, SolveOptions.of("qp2", polish=False))
    np.testing.assert_allclose(stiff.pressure, 1, atol=1e-8)
    polished = qp2.solve(problem, SolveOptions.of("qp2", rows=Rows.COMPLIANCE))
    assert polished.status is Status.SOLVED
    np.testing.assert_allclose(polished.pressure, 1, atol=1e-8)


@pytest.mark.parametrize("penalty", [1e-8, 1e-4, 1.0, 1e4, 1e8])
def test_no_penalty_costs_digits(penalty):
    """Eight powers of ten to either side: the same pressure unpolished, and the inertia of the exact Hessian.

    With μ small it is that of the equations' square: n positive for the residuals, and of what is left, on the
    equations, M + Mᵀ, which is positive definite. With μ large that of the product pᵀJδ, n positive and n negative.
    """
    problem = slender()
    computed = qp2.solve(problem, SolveOptions.of("qp2", penalty=penalty, polish=False))
    assert computed.status is Status.SOLVED
    np.testing.assert_allclose(computed.pressure, 1, atol=1e-8)
    if penalty <= 1e-8:
        assert computed.search.inertia == (40, 0, 0)
    if penalty >= 1e8:
        assert computed.search.inertia == (20, 0, 20)


def test_stiffness_rows_of_a_slender_body_do_not():
    """A slender body to 1e-8 without a polish; the pressure is known only as well as cond M · eps = 1e-10 allows."""
    solution = qp2.solve(slender(), SolveOptions.of("qp2", polish=False))
    assert solution.status is Status.SOLVED
    np.testing.assert_allclose(solution.pressure, 1, atol=1e-8)


def test_penalized_equilibrium_finds_the_solution_from_near_it():
    problem = resting()
    direct = complementarity.solve(problem)
    start = Start(pressure=direct.pressure * 1.01, displacement=direct.displacement)
    solution = qp2.solve(problem, replace(PENALIZED, start=start, polish=False))
    assert solution.status is Status.SOLVED
    np.testing.assert_allclose(solution.pressure, direct.pressure, atol=1e-10 * direct.pressure.max())


def test_a_note_states_that_penalized_equilibrium_of_a_held_body_has_no_effect():
    solution = qp2.solve(random_contact(0, 5, 0), PENALIZED)
    assert solution.status is Status.SOLVED
    assert "no equilibrium of a free body" in solution.notes[0]


def test_compliance_rows_do_not_contain_equilibrium():
    with pytest.raises(ProblemError, match="stiffness rows only"):
        qp2.solve(resting(), replace(PENALIZED, rows=Rows.COMPLIANCE))
