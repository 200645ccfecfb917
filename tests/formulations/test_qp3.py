"""QP3: its objective, its convexity, and its agreement with the direct solver."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contact_problems import in_units, random_contact

import bemcontact
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import Status
from bemcontact.errors import NotConvexError, OptionError, ProblemError, SolverError
from bemcontact.formulations import clarabel, complementarity, piqp, qp3
from bemcontact.formulations.scaling import scale, scaled_point
from bemcontact.options import SolveOptions, Weights

UNPOLISHED = SolveOptions.of("qp3", polish=False)
GALLERY = Path(__file__).parents[2] / "models" / "gallery"


def balanced(problem, rng: np.random.Generator) -> np.ndarray:
    """A random pressure (n,), of either sign, with ℓᵀp = -load."""
    R, ell = problem.rigid_motions, problem.equilibrium
    p = rng.standard_normal(len(R))
    return p - R @ np.linalg.solve(ell.T @ R, ell.T @ p + problem.motion_load)


@pytest.mark.parametrize("k", [0, 1, 2, 3])
def test_quadratic_equals_the_work_of_the_pressure_in_the_gap(k):
    """F3 = pᵀJδ = F1 wherever (12) holds, for every p in equilibrium and every a: no factor 1/2 is amiss."""
    rng = np.random.default_rng(0)
    scaled = scale(random_contact(1, 9, k))
    J = np.diag(scaled.weights)
    work = qp3.objective(scaled, J)
    for _ in range(5):
        p, a = balanced(scaled, rng), rng.standard_normal(k)
        assert work.value(p, a) == pytest.approx(p @ J @ scaled.gap(p, a), rel=1e-11, abs=1e-12)


def test_quadratic_with_full_weights():
    """For a J that is neither diagonal nor tributary, with J R = ℓ C: here tributary weights plus PᵀXP."""
    rng = np.random.default_rng(2)
    scaled = scale(random_contact(3, 9, 2))
    R, ell = scaled.rigid_motions, scaled.equilibrium
    project = np.eye(9) - R @ np.linalg.solve(ell.T @ R, ell.T)
    A = rng.standard_normal((9, 9))
    J = 2 * np.diag(scaled.weights) + project.T @ (A + A.T) @ project
    work = qp3.objective(scaled, J)
    p, a = balanced(scaled, rng), rng.standard_normal(2)
    assert work.value(p, a) == pytest.approx(p @ J @ scaled.gap(p, a), rel=1e-11)


def test_hessian_is_semidefinite_in_all_directions():
    """Positive on {ℓᵀp = 0} is made enough: PᵀHP has no negative eigenvalue, and k zero ones."""
    scaled = scale(random_contact(4, 10, 2))
    eigenvalues = np.linalg.eigvalsh(qp3.objective(scaled, np.diag(scaled.weights)).hessian)
    assert eigenvalues[0] >= -1e-14
    assert eigenvalues[1] == pytest.approx(0, abs=1e-14)
    assert eigenvalues[2] > 1e-4


@pytest.mark.parametrize("k", [0, 1, 2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_agrees_with_the_direct_solver(seed, k):
    """One problem, one solution (sym(JM) positive definite on the equilibrium space)."""
    problem = random_contact(seed, 12, k)
    direct, rough, polished = (
        complementarity.solve(problem),
        qp3.solve(problem, UNPOLISHED),
        qp3.solve(problem),
    )
    peak = direct.pressure.max()
    assert polished.status is Status.SOLVED
    assert polished.polished
    assert not rough.polished
    np.testing.assert_allclose(rough.pressure, direct.pressure, atol=1e-4 * peak)
    np.testing.assert_allclose(polished.pressure, direct.pressure, atol=1e-9 * peak)
    np.testing.assert_allclose(polished.displacement, direct.displacement, atol=1e-9 * problem.scales.displacement)


@pytest.mark.parametrize("k", [0, 2])
@pytest.mark.parametrize(("length", "stress"), [(1e-3, 1e6), (1e3, 1e-6)])
def test_units_do_not_matter(length, stress, k):
    problem = random_contact(5, 12, k)
    other = in_units(problem, length, stress)
    one, two = qp3.solve(problem), qp3.solve(other)
    np.testing.assert_allclose(two.pressure / stress, one.pressure, atol=1e-12 * one.pressure.max())
    assert two.smallest_eigenvalue == pytest.approx(one.smallest_eigenvalue, rel=1e-9)


def test_eigenvalue_is_that_of_the_hessian_on_the_equilibrium_space():
    """Two points, R = (1, 1): the space is spanned by (1, -1)/√2; M in its gauge is m (1, -1)(1, -1)ᵀ."""
    problem = CondensedContact.from_compliance(
        np.diag([3.0, 1.0]), [1.0, 2.0], rigid_motions=[1.0, 1.0], motion_load=-1
    )
    np.testing.assert_allclose(problem.compliance, [[1.0, -1.0], [-1.0, 1.0]], atol=1e-15)
    expected = 2 * 2 / np.abs(problem.compliance).sum(axis=1).max()
    assert qp3.solve(problem).smallest_eigenvalue == pytest.approx(expected, rel=1e-12)


def test_no_eigenvalue_where_equilibrium_fixes_the_pressure():
    problem = CondensedContact.from_compliance([[1.0]], [1.0], rigid_motions=[1.0], motion_load=-2)
    solution = qp3.solve(problem)
    assert solution.smallest_eigenvalue is None
    np.testing.assert_allclose(solution.pressure, [2.0], rtol=1e-14)


def test_nonconvex_program_is_refused():
    """For M = [[1, 3], [0, 1]] det sym(JM) is 4 - 9/4 with J = diag(1, 4), and 4 - 36 with J = diag(4, 1)."""
    M = [[1.0, 3.0], [0.0, 1.0]]
    problem = replace(
        CondensedContact.from_compliance(M, [-1.0, -1.0], [1.0, 4.0]), element_length_weights=np.array([4.0, 1.0])
    )
    assert qp3.solve(problem).status is Status.SOLVED
    with pytest.raises(
        NotConvexError, match=r"element_length weights: the smallest eigenvalue .* use the tributary"
    ) as e:
        qp3.solve(problem, SolveOptions.of("qp3", weights=Weights.ELEMENT_LENGTH))
    assert e.value.smallest_eigenvalue < 0
    other = CondensedContact.from_compliance(M, [-1.0, -1.0], [4.0, 1.0])
    with pytest.raises(NotConvexError, match=r"not convex with tributary weights: .* refine the mesh"):
        qp3.solve(other)


def test_weights_that_couple_pressure_and_motion_are_refused():
    """Where ZᵀJR is not zero, pᵀJRa makes a saddle, however definite sym(JM) is."""
    problem = replace(random_contact(6, 6, 1), element_length_weights=np.arange(1.0, 7.0))
    with pytest.raises(NotConvexError) as e:
        qp3.solve(problem, SolveOptions.of("qp3", weights=Weights.ELEMENT_LENGTH))
    assert e.value.smallest_eigenvalue < -1e-3


def test_other_weights_have_the_same_solution():
    """Any positive diagonal J for which the program is convex ends at the complementary solution."""
    problem = random_contact(7, 10, 0)
    problem = replace(problem, element_length_weights=problem.weights * np.linspace(1.0, 1.05, 10))
    solution = qp3.solve(problem, SolveOptions.of("qp3", weights=Weights.ELEMENT_LENGTH))
    np.testing.assert_allclose(solution.pressure, complementarity.solve(problem).pressure, atol=1e-12)


def test_consistent_weights_are_left_as_they_are():
    """J with negative entries: its minimum lies below zero, which no complementary point does, and is not polished."""
    J = np.array([[4.0, 2.0, -1.0], [2.0, 16.0, 2.0], [-1.0, 2.0, 4.0]]) / 30
    M = np.array([[2.0, 0.0, 1.0], [0.0, 0.5, 0.0], [1.0, 0.0, 2.0]])
    problem = replace(CondensedContact.from_compliance(M, [-1.0, 0.2, 0.6], J.sum(axis=1)), consistent_weights=J)
    solution = qp3.solve(problem, SolveOptions.of("qp3", weights=Weights.CONSISTENT))
    gap = problem.initial_gap + solution.displacement
    assert solution.status is Status.SOLVED
    assert not solution.polished
    assert solution.pressure @ J @ gap < -1e-4


def test_weights_that_are_not_there():
    with pytest.raises(ProblemError, match="no consistent weights"):
        qp3.solve(random_contact(0, 4, 0), SolveOptions.of("qp3", weights=Weights.CONSISTENT))


def test_infeasible_load_is_named():
    """An upward load on a body that rests on a plane."""
    problem = CondensedContact.from_compliance(np.eye(3), np.zeros(3), rigid_motions=np.ones(3), motion_load=1.0)
    solution = qp3.solve(problem)
    assert solution.status is Status.INFEASIBLE
    assert "nothing holds: the motion 1" in solution.notes[0]


def test_iteration_limit_is_named():
    solution = qp3.solve(random_contact(1, 12, 1), SolveOptions.of("qp3", polish=False, max_iterations=2))
    assert solution.status is Status.ITERATION_LIMIT


def test_failure_of_the_solver_is_ours(monkeypatch):
    """No end of Clarabel leaves a point: all attempts are made, and the error says what to do."""
    monkeypatch.setattr(clarabel, "_judged", lambda *_, **__: ("Unsolved", np.inf))
    with pytest.raises(SolverError, match="Clarabel found no solution of QP3") as e:
        qp3.solve(random_contact(1, 5, 0))
    assert isinstance(e.value.__cause__, SolverError)


def strip(points: int, width: float, least: float) -> CondensedContact:
    """Like a slender strip that two motions leave free: a smooth kernel, whose small eigenvalues are all `least`."""
    x = np.linspace(0, 1, points)
    return CondensedContact.from_compliance(
        np.exp(-(((x[:, None] - x) / width) ** 2)) + least * np.eye(points),
        0.01 * x**2,
        np.full(points, 1 / points),
        rigid_motions=np.column_stack([np.ones(points), x - 0.5]),
        motion_load=[-1.0, 0.05],
    )


@pytest.mark.parametrize("least", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize(("points", "width"), [(30, 0.1), (60, 0.2), (80, 0.2)])
def test_strips_with_small_eigenvalues(points, width, least):
    """The direct solver and QP3 agree where the smallest eigenvalue is as small as that of strips of L/H = 40."""
    problem = strip(points, width, least)
    solution, direct = qp3.solve(problem), complementarity.solve(problem)
    assert solution.status is Status.SOLVED
    assert solution.pressure == pytest.approx(direct.pressure, abs=1e-9 * direct.pressure.max())


@pytest.mark.parametrize("name", ["beam_on_two_supports", "hertz_small", "three_zones"])
def test_the_first_attempt_answers_where_elements_are_graded(name: str):
    """Weights of 1 : 1000 and more: over forces all columns are of one size. Clarabel needs one attempt, and no note.

    At the contact state pᵀJδ is 0. The gap between primal and dual value, which an answer has, bounds it.
    """
    contact = bemcontact.condense(bemcontact.load(GALLERY / f"{name}.yaml"))
    assert contact.weights.max() > 1e3 * contact.weights.min()
    solution, scaled = qp3.solve(contact, UNPOLISHED), scale(contact)
    assert solution.status is Status.SOLVED
    assert solution.notes == ()
    p, a = scaled_point(contact, solution.pressure, solution.rigid_amplitudes)
    work = qp3.objective(scaled, np.diag(scaled.weights))
    size = max(1.0, abs(work.value(p, a) - work.constant))
    assert abs(p @ (scaled.weights * scaled.gap(p, a))) <= clarabel.GOOD * size


@pytest.mark.parametrize("refine", [1, 5])
def test_closed_rings(refine):
    """sym(JM) of a ring with two free motions is semidefinite to round-off; certified on any mesh."""
    ring = bemcontact.condense(bemcontact.load("models/gallery/shrink_fit.yaml", variant="stated mesh").refined(refine))
    assert ring.free_motions == 2
    assert bemcontact.solve(ring, "qp3").certified


def test_the_point_of_a_failed_solver_is_polished_and_the_outcome_says_so(monkeypatch):
    """Clarabel stops after five steps: the active-set steps lead to the contact state from there."""
    monkeypatch.setattr(clarabel, "ATTEMPTS", (clarabel.ClarabelSettings("", {"max_iter": 5}),))
    problem = random_contact(1, 12, 1)
    solution, direct = qp3.solve(problem), complementarity.solve(problem)
    assert solution.status is Status.SOLVED
    assert solution.polished
    assert solution.pressure == pytest.approx(direct.pressure, abs=1e-9 * direct.pressure.max())
    assert "not reached: residual" in solution.notes[0]
    assert "the active-set steps from the point that Clarabel left" in solution.notes[1]
    left = qp3.solve(problem, UNPOLISHED)
    assert left.status is Status.NUMERICAL_FAILURE
    assert np.abs(left.pressure - direct.pressure).max() > 1e-9 * direct.pressure.max()


@pytest.mark.parametrize("name", ["cylinder_on_plane", "cantilever_flat_surface", "gallery/receding_contact"])
def test_piqp_finds_the_same_pressure(name: str):
    """Before the active-set steps the work of the pressure in the gap is nearly zero, its least value.

    This determines pressures at the ends of contact to few digits. After the steps they are those of the direct solver.
    """
    pytest.importorskip("piqp")
    variant = "stated mesh"
    contact = bemcontact.condense(bemcontact.load(f"models/{name}.yaml", variant=variant))
    direct = complementarity.solve(contact).pressure
    raw = qp3.solve(contact, SolveOptions.of("qp3", solver="piqp", polish=False))
    polished = qp3.solve(contact, SolveOptions.of("qp3", solver="piqp"))
    assert (raw.solver, raw.history) == ("PIQP", ())
    work = contact.weights @ (raw.pressure * (contact.initial_gap + raw.displacement))
    assert abs(work) <= 1e-6 * contact.weights @ direct * contact.scales.displacement
    assert polished.pressure == pytest.approx(direct, abs=1e-12 * direct.max())


def test_piqp_proves_nothing():
    """Pulled off its support: no pressure balances the load. Clarabel proves it, PIQP calls it unbounded."""
    pytest.importorskip("piqp")
    pulled = CondensedContact.from_compliance(np.eye(3), np.zeros(3), rigid_motions=np.ones(3), motion_load=1.0)
    assert qp3.solve(pulled, SolveOptions.of("qp3", solver="piqp")).status is Status.NO_SOLUTION_FOUND


def test_a_solver_that_is_not_installed_is_an_error_in_one_sentence(monkeypatch):
    monkeypatch.setattr(piqp, "find_spec", lambda _: None)
    with pytest.raises(OptionError, match=r"piqp is not installed; pip install 'bemcontact\[piqp\]'"):
        qp3.solve(random_contact(1, 9, 0), SolveOptions.of("qp3", solver="piqp"))


def test_clarabel_says_where_it_is_slow(monkeypatch):
    monkeypatch.setattr(qp3, "MANY_POINTS", 9)
    assert qp3.SLOW in qp3.solve(random_contact(1, 9, 0)).notes
    assert qp3.SLOW not in qp3.solve(random_contact(1, 8, 0)).notes
