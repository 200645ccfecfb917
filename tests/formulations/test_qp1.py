"""QP1: its objective, its Hessian on the equations, and its agreement with the other statements."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from contact_problems import in_units, random_contact
from scipy.linalg import null_space

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import Status
from bemcontact.errors import ProblemError
from bemcontact.formulations import FORMULATIONS, complementarity, program, qp1, qp3
from bemcontact.formulations.scaling import scale, scaled_point
from bemcontact.formulations.starts import Start
from bemcontact.options import Rows, SolveOptions, Weights

ROWS = [*Rows]
NOT_POLISHED = SolveOptions.of("qp1", polish=False)


def contact_sets(problem: CondensedContact) -> list[np.ndarray]:
    """The pressures that solve a held problem, by a search of all 2ⁿ contact sets."""
    result = []
    for bits in itertools.product([False, True], repeat=problem.size):
        A = np.flatnonzero(bits)
        p = np.zeros(problem.size)
        p[A] = np.linalg.solve(problem.compliance[np.ix_(A, A)], -problem.offset[A])
        if min(p.min(), problem.gap(p, np.zeros(0)).min()) >= -1e-12:
            result.append(p)
    return result


def in_equilibrium(problem, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A scaled p (n,) with ℓᵀp = -load, of either sign, an a (k,), and δ = q + M p + R a (n,)."""
    R, ell = problem.rigid_motions, problem.equilibrium
    p, a = rng.standard_normal(len(R)), rng.standard_normal(R.shape[1])
    p = p - R @ np.linalg.solve(ell.T @ R, ell.T @ p + problem.motion_load)
    return p, a, problem.gap(p, a)


@pytest.mark.parametrize("rows", ROWS)
@pytest.mark.parametrize("k", [0, 1, 2, 3])
def test_quadratic_is_the_work_of_the_pressure_in_the_gap(k, rows):
    """½ xᵀHx + cᵀx = pᵀJδ = F1, and F1 = F3 with A x = b wherever (12) holds: no factor 1/2 is amiss."""
    rng = np.random.default_rng(k)
    condensed = random_contact(1, 9, k)
    scaled = scale(condensed)
    program = qp1.program_of(condensed, SolveOptions.of("qp1", rows=rows))
    work = qp3.objective(scaled, np.diag(scaled.weights))
    for _ in range(5):
        p, a, gap = in_equilibrium(scaled, rng)
        u_n = gap - condensed.initial_gap / condensed.scales.displacement
        x = np.concatenate([u_n, p, a])[: len(program.lower)]
        quadratic = 0.5 * x @ program.hessian @ x + program.linear @ x
        assert quadratic == pytest.approx(p @ np.diag(scaled.weights) @ gap, rel=1e-11)
        assert program.value(x) == pytest.approx(quadratic, rel=1e-11)
        assert program.value(x) == pytest.approx(work.value(p, a), rel=1e-9)
        np.testing.assert_allclose(program.equations.matrix @ x, program.equations.right, atol=1e-12)


@pytest.mark.parametrize("rows", ROWS)
@pytest.mark.parametrize("k", [0, 1, 2])
def test_hessian_on_the_equations_is_that_of_qp3(k, rows):
    """Along the null space of the equations dδ = M dp + R da with ℓᵀdp = 0, so that dxᵀH dx = dpᵀ(JM + MᵀJᵀ)dp."""
    condensed = random_contact(2, 8, k)
    scaled = scale(condensed)
    program = qp1.program_of(condensed, SolveOptions.of("qp1", rows=rows))
    free = null_space(program.equations.matrix)
    assert free.shape[1] == condensed.size  # n - k pressures in equilibrium and k motions
    p = free[8:16]
    weighted = np.diag(scaled.weights) @ scaled.compliance
    np.testing.assert_allclose(free.T @ program.hessian @ free, p.T @ (weighted + weighted.T) @ p, atol=1e-12)
    assert np.linalg.eigvalsh(free.T @ program.hessian @ free)[0] >= -1e-14  # convex there, by the choice of M


@pytest.mark.parametrize("rows", ROWS)
@pytest.mark.parametrize("k", [0, 1, 2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_all_statements_have_one_solution(seed, k, rows):
    """sym(JM) is positive definite on the equilibrium space: 1e-9 polished; an active set ends at 1e-12 without."""
    problem = random_contact(seed, 12, k)
    direct = complementarity.solve(problem)
    rough = qp1.solve(problem, SolveOptions.of("qp1", rows=rows, polish=False))
    polished = qp1.solve(problem, SolveOptions.of("qp1", rows=rows))
    peak, U = direct.pressure.max(), problem.scales.displacement
    for solution, tolerance in ((rough, 1e-12), (polished, 1e-13), (qp3.solve(problem), 1e-9)):
        assert solution.status is Status.SOLVED
        np.testing.assert_allclose(solution.pressure, direct.pressure, atol=tolerance * peak)
        np.testing.assert_allclose(solution.displacement, direct.displacement, atol=tolerance * U)
        np.testing.assert_allclose(
            scaled_point(problem, direct.pressure, solution.rigid_amplitudes)[1],
            scaled_point(problem, direct.pressure, direct.rigid_amplitudes)[1],
            atol=tolerance * 10,
        )


@pytest.mark.parametrize("k", [0, 1, 2, 3])
@pytest.mark.parametrize("scattered", [False, True])
def test_many_points_are_solved_over_their_gaps(k, scattered):
    """Beyond 250 unknowns the stiffness rows eliminate the pressures: it is the same program, from any start."""
    n = 130
    problem = random_contact(2, n, k)
    direct = complementarity.solve(problem)
    start = "random" if scattered else None
    solution = qp1.solve(problem, SolveOptions.of("qp1", start=start, polish=False))
    search = solution.search
    assert solution.status is Status.SOLVED
    assert search is not None
    np.testing.assert_allclose(solution.pressure, direct.pressure, atol=1e-12 * direct.pressure.max())
    np.testing.assert_allclose(solution.displacement, direct.displacement, atol=1e-12 * problem.scales.displacement)
    assert (solution.pressure == 0.0).sum() == (direct.pressure == 0.0).sum()  # bounds that are held hold exactly
    assert search.inertia == (n, 0, n)  # of the program in displacements and pressures
    assert search.reduced_inertia_end[1:] == (0, 0)
    assert abs(solution.history[-1].values[-1]) < 1e-10  # infeasibility and objective vanish at the contact state


def test_eliminated_pressures_change_no_answer(monkeypatch):
    """What small programs say of a solution, of none, and of a load that nothing holds, over the gaps too."""
    monkeypatch.setattr(program, "WORTH_ELIMINATION", 0)
    test_against_all_contact_sets("qp1", 6, 1)
    test_a_start_at_the_solution_stays_there()
    test_one_point_of_negative_compliance()
    test_infeasible_load_is_named()
    test_iteration_limit_is_named()


@pytest.mark.parametrize("seed", range(3))
def test_rows_that_are_round_off_are_not_said_to_have_no_solution(monkeypatch, seed):
    """Of a compliance of rank 12 with 30 points: contact has a solution, but stiffness rows do not exist."""
    monkeypatch.setattr(program, "WORTH_ELIMINATION", 0)
    B = np.random.default_rng(seed).standard_normal((30, 12))
    problem = CondensedContact.from_compliance(B @ B.T, -B @ B.sum(axis=0))
    assert complementarity.solve(problem).status is Status.SOLVED
    assert qp1.solve(problem, SolveOptions.of("qp1", polish=False)).status is not Status.INFEASIBLE


@pytest.mark.parametrize("k", [0, 2])
@pytest.mark.parametrize(("length", "stress"), [(1e-3, 1e6), (1e3, 1e-6), (0.7, 2.1e11)])
@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
def test_units_do_not_matter(formulation, length, stress, k):
    """The scaled problem is the same but for round-off, which may decide ties on the way but not the pressure."""
    problem = random_contact(5, 12, k)
    other = in_units(problem, length, stress)
    one, two = (FORMULATIONS[formulation](p, SolveOptions.of(formulation, polish=False)) for p in (problem, other))
    np.testing.assert_allclose(two.pressure / stress, one.pressure, atol=1e-12 * one.pressure.max())


@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
@pytest.mark.parametrize("n", [2, 4, 6])
@pytest.mark.parametrize("seed", range(4))
def test_against_all_contact_sets(formulation, n, seed):
    problem = random_contact(seed, n, 0)
    (truth,) = contact_sets(problem)
    solution = FORMULATIONS[formulation](problem, SolveOptions.of(formulation, polish=False))
    assert solution.status is Status.SOLVED
    np.testing.assert_allclose(solution.pressure, truth, atol=1e-11)


def test_the_search_is_reported():
    """[[0, J], [J, 0]] with J > 0 has as many positive as negative eigenvalues; the limit is QP3's eigenvalue."""
    problem = random_contact(3, 10, 1)
    solution = qp1.solve(problem, SolveOptions.of("qp1", rows=Rows.COMPLIANCE))
    search = solution.search
    assert search is not None
    assert search.inertia == (10, 1, 10)
    assert search.start == "null vector"
    assert search.phase_one_iterations + search.phase_two_iterations == solution.iterations > 0
    assert search.penalty is None
    assert search.objective == pytest.approx(0, abs=1e-12)
    assert search.reduced_inertia_end[1:] == (0, 0)
    assert solution.smallest_eigenvalue == pytest.approx(qp3.solve(problem).smallest_eigenvalue, rel=1e-12)


def test_a_start_at_the_solution_stays_there():
    """No step of phase two is needed from the solution itself, in the user's units."""
    problem = random_contact(3, 10, 1)
    direct = complementarity.solve(problem)
    start = Start(pressure=direct.pressure, displacement=direct.displacement)
    solution = qp1.solve(problem, SolveOptions.of("qp1", start=start, polish=False))
    assert solution.search is not None
    assert solution.search.start == "given point"
    np.testing.assert_allclose(solution.pressure, direct.pressure, atol=1e-12)
    assert solution.iterations < qp1.solve(problem, NOT_POLISHED).iterations


def test_one_point_of_negative_compliance():
    """M = -1, q = 1: δ = 1 - p solves at p = 0 and at p = 1; q = -1: δ = -1 - p < 0 for all p >= 0."""
    two = CondensedContact.from_compliance([[-1.0]], [1.0])
    solution = qp1.solve(two)
    assert solution.status is Status.SOLVED
    assert solution.pressure[0] in (pytest.approx(0), pytest.approx(1))
    none = qp1.solve(CondensedContact.from_compliance([[-1.0]], [-1.0]))
    assert none.status is Status.INFEASIBLE
    assert "no contact state exists" in none.notes[0]


def test_infeasible_load_is_named():
    """An upward load on a body that rests on a plane."""
    problem = CondensedContact.from_compliance(np.eye(3), np.zeros(3), rigid_motions=np.ones(3), motion_load=1.0)
    for formulation in ("qp1", "qp2"):
        solution = FORMULATIONS[formulation](problem, SolveOptions.of(formulation))
        assert solution.status is Status.INFEASIBLE
        assert "nothing holds: the motion 1" in solution.notes[0]


def test_iteration_limit_is_named():
    solution = qp1.solve(random_contact(1, 12, 1), SolveOptions.of("qp1", max_iterations=2))
    assert solution.status is Status.ITERATION_LIMIT


def test_consistent_weights_are_left_as_they_are():
    """J with negative entries: the minimum of F3 on QP3's test problem lies below zero, and QP1's with it (F1 = F3)."""
    J = np.array([[4.0, 2.0, -1.0], [2.0, 16.0, 2.0], [-1.0, 2.0, 4.0]]) / 30
    M = np.array([[2.0, 0.0, 1.0], [0.0, 0.5, 0.0], [1.0, 0.0, 2.0]])
    problem = replace(CondensedContact.from_compliance(M, [-1.0, 0.2, 0.6], J.sum(axis=1)), consistent_weights=J)
    solution = qp1.solve(problem, SolveOptions.of("qp1", weights=Weights.CONSISTENT))
    convex = qp3.solve(problem, SolveOptions.of("qp3", weights=Weights.CONSISTENT))
    assert not solution.polished
    work = solution.pressure @ J @ (problem.initial_gap + solution.displacement)
    assert work < -1e-4
    assert work == pytest.approx(convex.pressure @ J @ (problem.initial_gap + convex.displacement), rel=1e-6)


@pytest.mark.parametrize(
    ("formulation", "options", "name"),
    [
        ("qp1", {"penalty": 2.0}, "penalty"),
        ("qp3", {"rows": Rows.COMPLIANCE}, "rows"),
        ("complementarity", {"weights": Weights.CONSISTENT}, "weights"),
        ("qp3", {"start": Start(pressure=np.zeros(3), displacement=np.zeros(3))}, "start"),
    ],
)
def test_options_without_a_meaning_are_refused(formulation, options, name):
    with pytest.raises(ProblemError, match=f"{formulation} has no use for the option '{name}'"):
        FORMULATIONS[formulation](random_contact(0, 3, 0), SolveOptions.of(formulation, **options))
