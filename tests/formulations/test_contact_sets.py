"""Exhaustive truth for few contact points: all contact sets, and all first-order points of QP1 and QP2, by enumeration.

Of a held body with diagonal J > 0 and a P-matrix M every first-order point of QP1, QP2 (any μ) and QP3 is the contact
state; of a free body likewise where sym(JM) is positive definite on the equilibrium space and equilibrium is kept as a
constraint. Both are refuted by a single other point, and each is shown to need what it supposes.
"""

from collections.abc import Callable
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray

from bemcontact import (
    CondensedContact,
    Equilibrium,
    NotConvexError,
    QPStatus,
    RandomStarts,
    Start,
    Status,
    minimize_qp,
    random_starts,
)
from bemcontact.arrays import Array
from bemcontact.contact.multistart import End
from bemcontact.formulations import qp1, qp2, qp3
from bemcontact.formulations.scaling import scaled
from bemcontact.formulations.search import draw_starts
from bemcontact.options import SolveOptions

BoolArray = NDArray[np.bool_]

PENALTIES = (0.1, 1.0, 10.0)
STATEMENTS = [("qp1", 1.0), *(("qp2", penalty) for penalty in PENALTIES)]
REGULAR = 1e11
"""Condition number up to which the equations of a face are solved; generic data have no solution on any other."""
SAME = 1e-9
"""Difference of two points that are one, over the size of the numbers: round-off times a condition number of 1e6."""


def ends(problem: CondensedContact, statement: tuple[str, float]) -> RandomStarts:
    """What 15 random starts of a statement find, unpolished."""
    formulation, penalty = statement
    return random_starts(problem, formulation, count=15, seed=1, penalty=penalty)


def subsets(m: int) -> BoolArray:
    """All of m things, (2ᵐ, m), the empty one first."""
    return (np.arange(2**m)[:, None] >> np.arange(m) & 1).astype(bool)


def complementary_points(matrix: Array, vector: Array, free: int = 0) -> list[Array]:
    """All z >= 0 with w = vector + matrix z >= 0 and z·w = 0, but for the last `free` entries: z free, w = 0."""
    m = len(vector) - free
    faces = np.pad(subsets(m), ((0, 0), (0, free)), constant_values=True)
    systems = np.where(faces[:, :, None], matrix * faces[:, None, :], np.eye(m + free))
    regular = np.linalg.cond(systems) < REGULAR
    z = np.linalg.solve(systems[regular], np.where(faces[regular], -vector, 0.0)[..., None])[..., 0]
    w = vector + z @ matrix.T
    right = np.minimum(z, w)[:, :m].min(axis=1) >= -SAME * (1 + np.abs(z).max(axis=1))
    return distinct(list(z[right]))


def distinct(points: list[Array]) -> list[Array]:
    """Each point once."""
    result: list[Array] = []
    for point in points:
        if not among(point, result):
            result.append(point)
    return result


def among(point: Array, points: list[Array]) -> bool:
    return any(np.abs(point - other).max() <= SAME * (1 + np.abs(other).max()) for other in points)


def contact_states(condensed: CondensedContact) -> list[Array]:
    """The scaled pressures (n,) of all contact states, from all 2ⁿ contact sets, equilibrium included."""
    problem = scaled(condensed)
    n, k = problem.rigid_motions.shape
    system = np.block([[problem.compliance, problem.rigid_motions], [problem.equilibrium.T, np.zeros((k, k))]])
    points = complementary_points(system, np.append(problem.offset, problem.motion_load), free=k)
    return distinct([z[:n] for z in points])


def first_order_points_of_qp1(condensed: CondensedContact) -> list[Array]:
    """The scaled pressures at which min pᵀJ(q + M p), q + M p >= 0, p >= 0 is stationary, of a held body.

    With multipliers λ of the gaps: Jq + (JM + MᵀJ)p - Mᵀλ >= 0 complementary to p, q + M p >= 0 to λ.
    """
    problem = scaled(condensed)
    n, M = condensed.size, problem.compliance
    weighted = problem.weights[:, None] * M
    system = np.block([[weighted + weighted.T, -M.T], [M, np.zeros((n, n))]])
    points = complementary_points(system, np.append(problem.weights * problem.offset, problem.offset))
    return distinct([z[:n] for z in points])


def first_order_points_of_qp2(condensed: CondensedContact, penalty: float) -> list[Array]:
    """The scaled (δ, p) of a held body at which QP2 is stationary: x >= lower complementary to H x + c >= 0."""
    program = qp2.statement(condensed, SolveOptions.of("qp2", penalty=penalty))
    return complementary_points(program.hessian, program.linear + program.hessian @ program.lower)


def is_p_matrix(M: Array) -> bool:
    """Whether all 2ⁿ - 1 principal minors are positive."""
    return all(np.linalg.det(M[np.ix_(rows, rows)]) > 0 for rows in map(np.flatnonzero, subsets(len(M))[1:]))


def curvature(problem: CondensedContact) -> float:
    """Smallest eigenvalue of JM + MᵀJ on the equilibrium space, scaled."""
    held = scaled(problem)
    value = qp3.smallest_eigenvalue(held, np.diag(held.weights))
    assert value is not None
    return value


def definite(rng: np.random.Generator, n: int) -> CondensedContact:
    """An unsymmetric M with sym(JM) positive definite."""
    A, S = rng.standard_normal((2, n, n))
    J = rng.uniform(0.3, 1.5, n)
    M = (A @ A.T / n + 0.05 * np.eye(n) + 0.3 * (S - S.T)) / J[:, None]
    return CondensedContact.from_compliance(M, rng.standard_normal(n), J)


def ring(rng: np.random.Generator, n: int) -> CondensedContact:
    """A P-matrix, and no diagonal D > 0 makes sym(DM) positive definite: I + aC, a > 2, C an odd cycle.

    Its proper principal minors are 1, being triangular up to a permutation, and its determinant is 1 + aⁿ; it has an
    eigenvalue of negative real part. Even n have a triangular coupling to one point more. Positive factors of rows and
    columns, and renumbering, leave a P-matrix one.
    """
    m = n - 1 + n % 2
    M = np.eye(n)
    M[np.arange(m), (np.arange(m) + 1) % m] = rng.uniform(2.2, 4.0, m)
    M[:m, m:] = rng.normal(0, 3, (m, n - m))
    order, rows, columns = rng.permutation(n), *rng.uniform(0.5, 2, (2, n))
    M = rows[:, None] * M[np.ix_(order, order)] * columns
    return CondensedContact.from_compliance(M, rng.standard_normal(n), rng.uniform(0.3, 1.5, n))


def dominated(rng: np.random.Generator, n: int) -> CondensedContact:
    """A P-matrix by dominant diagonals, with columns of sizes from 1 to 100, drawn until sym(JM) is indefinite."""
    while True:
        M = rng.uniform(-1, 1, (n, n))
        np.fill_diagonal(M, 0)
        np.fill_diagonal(M, 1.05 * np.abs(M).sum(axis=1))
        M *= rng.permutation(np.geomspace(1, 100, n))
        problem = CondensedContact.from_compliance(M, rng.standard_normal(n), rng.uniform(0.3, 1.5, n))
        if curvature(problem) < -0.05:
            return problem


def not_p(rng: np.random.Generator, n: int) -> CondensedContact:
    """Some principal minor is negative."""
    while is_p_matrix(M := rng.standard_normal((n, n)) + 0.5 * np.eye(n)):
        pass
    return CondensedContact.from_compliance(M, rng.standard_normal(n), rng.uniform(0.3, 1.5, n))


def free_body(rng: np.random.Generator, n: int, k: int) -> CondensedContact:
    """A body that a plane holds against rising (k = 1) and turning (k = 2), pressed down at some of the points."""
    held = definite(rng, n)
    R = np.column_stack([np.ones(n), np.linspace(-1, 1, n)])[:, :k]
    pressed = rng.uniform(0, 1, n)
    return CondensedContact.from_compliance(
        held.compliance, rng.uniform(0, 1, n), held.weights,
        rigid_motions=R, motion_load=-(held.weights[:, None] * R).T @ pressed,
    )  # fmt: skip


Kind = Callable[[np.random.Generator, int], CondensedContact]
P_KINDS: list[Kind] = [definite, ring, dominated]
named = pytest.mark.parametrize("kind", P_KINDS, ids=lambda kind: kind.__name__)


def scaled_ends(problem: CondensedContact, result: RandomStarts) -> list[tuple[End, Array]]:
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
def test_kinds_are_what_they_say(kind, n):
    """By all principal minors; and `ring` and `dominated` have a negative eigenvalue of sym(JM)."""
    for seed in range(3):
        problem = kind(np.random.default_rng([seed, n]), n)
        assert is_p_matrix(problem.compliance)
        assert curvature(problem) > 0 if kind is definite else curvature(problem) < -0.05
        assert len(contact_states(problem)) == 1


@named
@pytest.mark.parametrize("n", [3, 4, 5])
def test_p_matrices_have_one_first_order_point(kind, n):
    """By exhaustion: among 4ⁿ faces of QP1, and of QP2 for each μ, only the contact state is stationary."""
    for seed in range(3):
        problem = kind(np.random.default_rng([seed, n]), n)
        (truth,) = contact_states(problem)
        gap = scaled(problem).gap(truth, np.zeros(0))
        (p,) = first_order_points_of_qp1(problem)
        assert among(p, [truth])
        for penalty in PENALTIES:
            (x,) = first_order_points_of_qp2(problem, penalty)
            assert among(x, [np.append(gap, truth)])


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
        problem = scaled(condensed)
        if curvature(condensed) > 0:
            solution = qp3.solve(condensed)
            np.testing.assert_allclose(solution.pressure / condensed.scales.pressure, truth, atol=1e-9)
        else:
            with pytest.raises(NotConvexError):
                qp3.solve(condensed)
        weighted = problem.weights[:, None] * problem.compliance
        for start in draw_starts(condensed, 10, seed):
            result = minimize_qp(
                weighted + weighted.T, problem.weights * problem.offset, A=problem.compliance, cl=-problem.offset,
                bl=np.zeros(6), x0=start.pressure / condensed.scales.pressure,
            )  # fmt: skip
            assert result.status is QPStatus.LOCAL_MINIMIZER
            assert among(result.x, [truth])


def judge_end(end: End, p: Array, states: list[Array]) -> bool:
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


@pytest.mark.parametrize("penalty", [1.0, 10.0])
@pytest.mark.parametrize("k", [1, 2])
def test_free_bodies_out_of_equilibrium_have_spurious_ends(k, penalty):
    """Equilibrium penalised: some start leaves the body where no small change helps, and F2 > 0 tells it each time."""
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
    gap = scaled(problem).gap(truth, np.zeros(0))
    assert np.abs(np.maximum(gap, truth)).min() <= SAME
    formulation, penalty = statement
    assert_right(problem, random_starts(problem, formulation, count=60, seed=5, penalty=penalty), truth)


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
    program = qp1.statement(problem, SolveOptions.of("qp1"))
    E, e = program.equations.matrix, program.equations.right
    result = minimize_qp(program.hessian, program.linear, A=E, cl=e, cu=e, bl=program.lower, x0=np.array([-0.5, 0.5]))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert program.value(result.x) == pytest.approx(0, abs=1e-15)
