"""Exhaustive truth for few contact points: all contact sets, and all first-order points of QP1 and QP2, by enumeration.

Of a held body with diagonal J > 0 and a P-matrix M every first-order point of QP1, QP2 (any μ) and QP3 is the contact
state; of a free body likewise where sym(JM) is positive definite on the equilibrium space and equilibrium is kept as a
constraint. Both are refuted by a single other point, and each is shown to need what it supposes.
"""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from contact_problems import resting
from enumeration import (
    PENALTIES,
    SAME,
    STATEMENTS,
    among,
    contact_states,
    curvature,
    definite,
    dominated,
    first_order_points_of_qp1,
    first_order_points_of_qp2,
    free_body,
    is_p_matrix,
    not_p,
    ring,
)

import bemcontact
from bemcontact import NotConvexError, QPStatus, RandomStarts, minimize_qp, random_starts
from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.multistart import SearchEnd
from bemcontact.contact.solution import Status
from bemcontact.errors import OptionError
from bemcontact.formulations import complementarity, qp1, qp2, qp3
from bemcontact.formulations.multistart import multistart
from bemcontact.formulations.scaling import scale
from bemcontact.formulations.starts import Start, draw_starts
from bemcontact.options import Equilibrium, SolveOptions


def ends(problem: CondensedContact, statement: tuple[str, float]) -> RandomStarts:
    """What 15 random starts of a statement find, unpolished."""
    formulation, penalty = statement
    return random_starts(problem, formulation, count=15, seed=1, penalty=penalty)


Kind = Callable[[np.random.Generator, int], CondensedContact]
P_KINDS: list[Kind] = [definite, ring, dominated]
named = pytest.mark.parametrize("kind", P_KINDS, ids=lambda kind: kind.__name__)


def scaled_ends(problem: CondensedContact, result: RandomStarts) -> list[tuple[SearchEnd, Array]]:
    """Each end with its p/T."""
    return [(end, end.solution.pressure / problem.scales.pressure) for end in result.ends]


def assert_right(problem: CondensedContact, result: RandomStarts, truth: Array) -> None:
    """Every search ended at the only contact state, and its status is SOLVED."""
    assert result.solved == result.count
    for end, p in scaled_ends(problem, result):
        assert among(p, [truth])
        assert end.objective <= 1e-12  # round-off squared, times the condition of the rows


@named
@pytest.mark.parametrize("n", [3, 5, 8])
def test_kinds_of_problems_have_their_properties(kind, n):
    """By all principal minors; and `ring` and `dominated` have a negative eigenvalue of sym(JM)."""
    for seed in range(3):
        problem = kind(np.random.default_rng([seed, n]), n)
        assert is_p_matrix(problem.compliance)
        assert (curvature(problem) > 0) is (kind is definite)
        assert len(contact_states(problem)) == 1


@named
@pytest.mark.parametrize("n", [3, 4, 5])
def test_p_matrices_have_one_first_order_point(kind, n):
    """By exhaustion: among 4ⁿ faces of QP1, and of QP2 for each μ, only the contact state is stationary."""
    for seed in range(3):
        problem = kind(np.random.default_rng([seed, n]), n)
        (truth,) = contact_states(problem)
        gap = scale(problem).gap(truth, np.zeros(0))
        (p,) = first_order_points_of_qp1(problem)
        assert among(p, [truth])
        for penalty in PENALTIES:
            (x,) = first_order_points_of_qp2(problem, penalty)
            assert among(x, [np.append(gap, truth)])


@pytest.mark.slow
@named
@pytest.mark.parametrize("statement", STATEMENTS, ids=str)
@pytest.mark.parametrize("n", [3, 8])
def test_p_matrices_have_one_end(kind, statement, n):
    """No random start of QP1 or QP2 ends elsewhere, though their Hessians are indefinite."""
    for seed in range(2):
        problem = kind(np.random.default_rng([seed, n, 1]), n)
        (truth,) = contact_states(problem)
        assert_right(problem, ends(problem, statement), truth)


@named
def test_qp3_of_p_matrices(kind):
    """Convex QP3 is right, another refused; and by the local solver it too has one end, its minimum being 0 there."""
    for seed in range(3):
        condensed = kind(np.random.default_rng([seed, 6, 2]), 6)
        (truth,) = contact_states(condensed)
        scaled = scale(condensed)
        if curvature(condensed) > 0:
            solution = qp3.solve(condensed)
            np.testing.assert_allclose(solution.pressure / condensed.scales.pressure, truth, atol=1e-9)
        else:
            with pytest.raises(NotConvexError):
                qp3.solve(condensed)
        weighted = scaled.weights[:, None] * scaled.compliance
        for start in draw_starts(condensed, 10, seed):
            result = minimize_qp(
                weighted + weighted.T, scaled.weights * scaled.offset, A=scaled.compliance, cl=-scaled.offset,
                bl=np.zeros(6), x0=start.pressure / condensed.scales.pressure,
            )  # fmt: skip
            assert result.status is QPStatus.LOCAL_MINIMIZER
            assert among(result.x, [truth])


def judge_end(end: SearchEnd, p: Array, states: list[Array]) -> bool:
    """Check the status of an end, and return whether it is a contact state."""
    if end.solution.status is Status.INFEASIBLE:  # of QP1 only: no p >= 0 with q + M p >= 0, so no contact state
        assert not states
        return False
    assert end.solution.status in (Status.SOLVED, Status.LOCAL_MINIMUM)
    right = end.solution.status is Status.SOLVED
    assert right == among(p, states)
    if right:
        assert end.objective <= 1e-12
    else:
        assert end.objective > 1e-6
        assert end.residual > 1e-4
    return right


@pytest.mark.slow
@pytest.mark.parametrize("statement", STATEMENTS, ids=str)
def test_ends_of_other_matrices_are_classified_by_their_objective(statement):
    """Objective zero at contact states alone; ends with more are none, are called so, and exist: M has to be P."""
    spurious = 0
    for n, seed in product((2, 3, 5, 8), range(3)):
        problem = not_p(np.random.default_rng([seed, n]), n)
        states = contact_states(problem)
        judged = [judge_end(end, p, states) for end, p in scaled_ends(problem, ends(problem, statement))]
        spurious += judged.count(False) if states else 0
    assert spurious > 0


@pytest.mark.slow
@pytest.mark.parametrize("n", [2, 3, 4])
def test_ends_of_other_matrices_are_first_order_points(n):
    """Whatever QP1 and QP2 end at is in the list of 4ⁿ faces."""
    for seed in range(3):
        problem = not_p(np.random.default_rng([seed, n]), n)
        gap = problem.initial_gap / problem.scales.displacement
        for _, p in scaled_ends(problem, result := ends(problem, STATEMENTS[0])):
            infeasible = result.ends[0].solution.status is Status.INFEASIBLE
            assert infeasible or among(p, first_order_points_of_qp1(problem))
        for statement in STATEMENTS[1:]:
            for end, p in scaled_ends(problem, ends(problem, statement)):
                x = np.append(gap + end.solution.displacement / problem.scales.displacement, p)
                assert among(x, first_order_points_of_qp2(problem, statement[1]))


@pytest.mark.parametrize("statement", STATEMENTS, ids=str)
@pytest.mark.parametrize("k", [1, 2])
def test_free_bodies_in_equilibrium_have_one_end(statement, k):
    """Equilibrium as a constraint, and sym(JM) > 0 on it: any start ends at the only contact state."""
    for seed in range(2):
        problem = free_body(np.random.default_rng([seed, k]), 7, k)
        assert curvature(problem) > 0
        (truth,) = contact_states(problem)
        assert_right(problem, ends(problem, statement), truth)


@pytest.mark.slow
@pytest.mark.parametrize("penalty", [1.0, 10.0])
@pytest.mark.parametrize("k", [1, 2])
def test_free_bodies_out_of_equilibrium_have_spurious_ends(k, penalty):
    """Equilibrium penalized: some start leaves the body where no small change helps, and F2 > 0 tells it each time."""
    spurious = 0
    for seed in range(4):
        problem = free_body(np.random.default_rng([seed, k]), 7, k)
        states = contact_states(problem)
        result = random_starts(problem, "qp2", count=40, seed=1, penalty=penalty, equilibrium="penalty")
        for end, p in scaled_ends(problem, result):
            if not judge_end(end, p, states):
                spurious += end.count
                balance = np.abs(problem.equilibrium.T @ end.solution.pressure + problem.motion_load)
                assert balance.max() > 1e-3 * np.abs(problem.motion_load).max()
    assert spurious > 0


@pytest.mark.parametrize("penalty", PENALTIES)
@pytest.mark.parametrize("k", [1, 2])
def test_a_lifted_body_stays_lifted(k, penalty):
    """Far off its support p = 0, for any μ, and of the load only the part in ℓ is left: F2 = loadᵀ(ℓᵀℓ)⁻¹load/μ.

    That is the least |K u_n - r|², since ℓᵀK = 0 and ℓᵀr = load.
    """
    for seed in range(3):
        problem = free_body(np.random.default_rng([seed, k]), 7, k)
        height = np.full(7, 1e3 * problem.scales.displacement)
        options = SolveOptions.of(
            "qp2", penalty=penalty, equilibrium=Equilibrium.PENALTY, polish=False,
            start=Start(pressure=np.zeros(7), displacement=height),
        )  # fmt: skip
        solution = qp2.solve(problem, options)
        load, ell = problem.motion_load / problem.scales.pressure, problem.equilibrium
        assert solution.status is Status.LOCAL_MINIMUM
        assert not solution.pressure.any()
        assert solution.search is not None
        assert solution.search.objective == pytest.approx(load @ np.linalg.solve(ell.T @ ell, load) / penalty, rel=1e-9)


TRIANGULAR = [
    [1, 0, 0, 0, -3, 3],
    [-1, 1, 1, -3, -3, -1],
    [2, 0, 1, 0, 3, 2],
    [2, 0, 3, 1, -2, -3],
    [0, 0, 0, 0, 1, 1],
    [0, 0, 0, 0, 0, 1],
]
"""A P-matrix: triangular with ones on its diagonal in the order 6, 5, 1, 3, 4, 2."""


@pytest.mark.parametrize("statement", STATEMENTS, ids=str)
@pytest.mark.parametrize("q", [[0, -1, 0, 1, 1, 1], [-1, -1, 0, 0, 0, 0]], ids=str)
def test_points_that_touch_without_pressure(q, statement):
    """Small integers, so that p and δ vanish together and many bounds meet: no cycle, and the same only end."""
    problem = CondensedContact.from_compliance(np.array(TRIANGULAR), q, [2, 2, 2, 1, 2, 2])
    assert is_p_matrix(problem.compliance)
    (truth,) = contact_states(problem)
    gap = scale(problem).gap(truth, np.zeros(0))
    assert np.abs(np.maximum(gap, truth)).min() <= SAME
    formulation, penalty = statement
    assert_right(problem, random_starts(problem, formulation, count=20, seed=5, penalty=penalty), truth)


def test_a_first_order_point_without_a_p_matrix_in_exact_numbers():
    """M = -1, q = J = 1: QP1 is min p(1 - p) on 0 <= p <= 1, stationary at 1/2 with F1 = 1/4; contact states 0, 1."""
    p, q, M = Fraction(1, 2), Fraction(1), Fraction(-1)
    assert q + 2 * M * p == 0
    assert p * (q + M * p) == Fraction(1, 4)
    problem = CondensedContact.from_compliance([[-1.0]], [1.0])
    assert sorted(x.item() for x in contact_states(problem)) == pytest.approx([0, 1])
    assert sorted(x.item() for x in first_order_points_of_qp1(problem)) == pytest.approx([0, 0.5, 1])
    for end, pressure in scaled_ends(problem, random_starts(problem, "qp1", count=10)):
        assert judge_end(end, pressure, contact_states(problem))  # not the maximum at 1/2, even started there
    program = qp1.program_of(problem, SolveOptions.of("qp1"))
    E, e = program.equations.matrix, program.equations.right
    result = minimize_qp(program.hessian, program.linear, A=E, cl=e, cu=e, bl=program.lower, x0=np.array([-0.5, 0.5]))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert program.value(result.x) == pytest.approx(0, abs=1e-15)


P_MATRIX = np.array([[1.0, -3.0, 0.0], [0.0, 1.0, -3.0], [0.0, 0.0, 1.0]])
"""Triangular with positive diagonal, so a P-matrix, but far from positive definite."""


@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
def test_a_strictly_monotone_problem_has_one_end(formulation):
    problem = resting()
    computed = multistart(problem, SolveOptions.of(formulation, starts=25))
    (end,) = computed.ends
    assert (computed.solved, end.count, end.first_start) == (25, 25, 0)
    assert end.residual < 1e-10
    assert end.objective == pytest.approx(0, abs=1e-10)
    direct = complementarity.solve(problem)
    np.testing.assert_allclose(end.solution.pressure, direct.pressure, atol=1e-10 * direct.pressure.max())


def test_penalized_equilibrium_has_a_second_end():
    """The lifted body: one end wherever it is lifted to, F2 > 0, counted apart and put last."""
    computed = multistart(resting(), SolveOptions.of("qp2", equilibrium=Equilibrium.PENALTY, starts=60))
    best, lifted = computed.ends
    assert best.solution.status is Status.SOLVED
    assert lifted.solution.status is Status.LOCAL_MINIMUM
    assert not lifted.solution.pressure.any()
    assert lifted.objective > 0.1
    assert best.count + lifted.count == 60
    assert lifted.count > 0
    assert str(computed).startswith(f"{best.count} of 60 random starts (seed 0) end at the contact state\n")


@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
def test_a_p_matrix_has_one_end(formulation):
    """Every first-order point of QP1 and QP2 is the solution for a P-matrix of any definiteness (row sufficient)."""
    rng = np.random.default_rng(0)
    for _ in range(3):
        problem = CondensedContact.from_compliance(P_MATRIX, rng.standard_normal(3))
        computed = multistart(problem, SolveOptions.of(formulation, starts=15))
        assert [end.solution.status for end in computed.ends] == [Status.SOLVED]
        truth = complementarity.solve(problem).pressure
        np.testing.assert_allclose(computed.ends[0].solution.pressure, truth, atol=1e-9)


def test_a_matrix_that_is_not_p_has_all_its_ends_named():
    """M = [[1, 2], [2, 1]], q = (-1, -1): contact at either point alone or at both; by enumeration, three solutions."""
    M, q = np.array([[1.0, 2.0], [2.0, 1.0]]), np.array([-1.0, -1.0])
    truths = []
    for bits in product([False, True], repeat=2):
        A = np.flatnonzero(bits)
        p = np.zeros(2)
        p[A] = np.linalg.solve(M[np.ix_(A, A)], -q[A])
        if min(p.min(), (q + M @ p).min()) >= 0:
            truths.append(p)
    assert len(truths) == 3
    computed = multistart(CondensedContact.from_compliance(M, q), SolveOptions.of("qp1", starts=40))
    assert len(computed.ends) > 1
    for end in computed.ends:
        assert end.solution.status is Status.SOLVED
        assert any(np.abs(end.solution.pressure - truth).max() < 1e-10 for truth in truths)


def test_the_library_function_and_the_option_agree():
    problem = resting()
    computed = bemcontact.random_starts(problem, "qp2", count=10, seed=2, equilibrium="penalty")
    result = bemcontact.solve(problem, "qp2", equilibrium="penalty", start="random", seed=2, starts=10)
    assert result.certified
    assert result.starts is not None
    assert [end.count for end in result.starts.ends] == [end.count for end in computed.ends]
    data = json.loads(result.to_json())
    assert data["starts"]["solved"] == computed.solved
    assert sum(end["count"] for end in data["starts"]["ends"]) == 10
    assert data["search"]["start"] == f"random point {computed.ends[0].first_start}, seed 2"


@pytest.mark.parametrize(
    ("asked", "pattern"),
    [
        ({"seed": None}, "seed must be a whole number of at least 0; found None"),
        ({"count": 2.5}, "number of starts must be a whole number of at least 1; found 2.5"),
        ({"count": True}, "number of starts"),
        ({"penalty": 1e13, "formulation": "qp2"}, "from 1e-08 to"),
    ],
)
def test_invalid_options_of_random_starts_are_refused(asked, pattern):
    with pytest.raises(OptionError, match=pattern):
        bemcontact.random_starts(resting(), **asked)


def test_a_limit_of_iterations_reaches_every_search():
    computed = bemcontact.random_starts(resting(), "qp1", count=3, max_iterations=1)
    assert {end.solution.status for end in computed.ends} == {Status.ITERATION_LIMIT}
    assert max(end.iterations[1] for end in computed.ends) <= 1
    result = bemcontact.solve(resting(), "qp1", max_iterations=1)
    assert result.solution.status is Status.ITERATION_LIMIT
    assert "--max-iterations; 1 were done" in result.certificate.words


def test_progress_counts_searches():
    done = []
    bemcontact.random_starts(resting(), "qp1", count=4, progress=done.append)
    bemcontact.solve(resting(), "qp1", starts=3, progress=done.append)
    assert done == [1, 2, 3, 4, 1, 2, 3]


def test_all_infeasible_ends_are_one():
    """M = -1, q = -1 has no contact state; where the search saw that means nothing, nor does the objective there."""
    computed = multistart(CondensedContact.from_compliance([[-1.0]], [-1.0]), SolveOptions.of("qp1", starts=12))
    (end,) = computed.ends
    assert (end.count, end.objective, computed.solved) == (12, None, 0)
    assert re.fullmatch(r"12 x infeasible, (\d+ to )?\d+ iterations?", str(end))
    assert json.loads(json.dumps(computed.to_dict(), allow_nan=False))["ends"][0]["objective"] is None


def test_all_unbounded_ends_are_one():
    """On δ = 1 + p both grow along p = (1, 1), where pᵀJδ falls as -2p² for J = [[1, -2], [-2, 1]]."""
    J = np.array([[1.0, -2.0], [-2.0, 1.0]])
    problem = replace(CondensedContact.from_compliance(np.eye(2), [1.0, 1.0]), consistent_weights=J)
    computed = multistart(problem, SolveOptions.of("qp1", "consistent", starts=12))
    assert [end.solution.status for end in computed.ends] == [Status.UNBOUNDED]
    assert computed.ends[0].count == 12


def test_random_starts_are_for_local_solvers():
    with pytest.raises(OptionError, match="no use for the option 'starts'"):
        bemcontact.random_starts(resting(), "qp3")


def test_nothing_is_polished():
    """A polish would turn the lifted body into the solution."""
    computed = multistart(resting(), SolveOptions.of("qp1", polish=True, starts=2))
    assert not any(end.solution.polished for end in computed.ends)
