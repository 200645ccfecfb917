"""The certificate: what it proves, what it refuses, and its error bound against true errors."""

import itertools
import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import typer.main
from contact_problems import in_units, random_contact

from bemcontact import cli
from bemcontact.assessment.certificate import Certificate, CertificateKind, advice, certify
from bemcontact.assessment.residual import residuals
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.formulations import complementarity, qp3
from bemcontact.options import FormulationName


def judged(problem: CondensedContact, solution: ContactSolution) -> Certificate:
    return certify(problem, solution, residuals(problem, solution))


def moved(
    problem: CondensedContact, solution: ContactSolution, pressure: np.ndarray, lift: np.ndarray
) -> ContactSolution:
    """Another point, with the displacement that belongs to it."""
    p, a = solution.pressure + pressure, solution.rigid_amplitudes + lift
    u_n = problem.free_displacement + problem.compliance @ p + problem.rigid_motions @ a
    return replace(solution, pressure=p, rigid_amplitudes=a, displacement=u_n)


@pytest.mark.parametrize("k", [0, 1, 2, 3])
def test_solution_is_certified(k):
    problem = random_contact(0, 8, k)
    certificate = judged(problem, complementarity.solve(problem))
    assert certificate.kind is CertificateKind.UNIQUE
    assert certificate.certified
    assert certificate.relative_error_bound is not None
    assert certificate.relative_error_bound <= 1e-11
    assert "other state exists, because" in certificate.words


@pytest.mark.slow
@pytest.mark.parametrize("k", [0, 1, 2, 3])
@pytest.mark.parametrize("seed", range(5))
def test_error_is_never_above_the_bound(seed, k):
    """Fifty points around the solution, off by 1e-10 to 10 of its size, in and out of equilibrium."""
    rng = np.random.default_rng(seed)
    problem = random_contact(seed, 8, k)
    exact = complementarity.solve(problem)
    peak = exact.pressure.max()
    bounds = 0
    for _ in range(50):
        size = 10.0 ** rng.uniform(-10, 1)
        change = size * peak * rng.standard_normal(problem.size) * rng.integers(0, 2, problem.size)
        other = moved(problem, exact, change, size * rng.standard_normal(k))
        bound = judged(problem, other).error_bound
        if bound is not None:
            bounds += 1
            assert np.abs(other.pressure - exact.pressure).max() <= bound + 1e-14 * peak
    assert bounds >= 40


@pytest.mark.parametrize("seed", range(10))
def test_short_elements_beside_long_ones_hide_nothing(seed):
    """sym(DM) = √D K √D with D from 1e-8 to 1: λ is that of K, which is what is left of it, and the bound holds."""
    rng = np.random.default_rng(seed)
    n = 12
    D, Q = 10.0 ** rng.uniform(-8, 0, n), rng.standard_normal((n, n))
    K = Q @ Q.T + np.eye(n)
    K /= np.sqrt(np.outer(K.diagonal(), K.diagonal()))
    M = K * np.sqrt(D) / np.sqrt(D)[:, None]
    problem = CondensedContact.from_compliance(M, rng.standard_normal(n), D)
    exact = complementarity.solve(problem)
    certificate = judged(problem, exact)
    assert certificate.certified
    assert certificate.smallest_eigenvalue == pytest.approx(np.linalg.eigvalsh(K)[0], rel=1e-9)
    for size in 10.0 ** rng.uniform(-9, 0, 20):
        other = moved(problem, exact, size * exact.pressure * rng.uniform(-1, 1, n), np.zeros(0))
        bound = judged(problem, other).error_bound
        assert bound is not None
        assert np.abs(other.pressure - exact.pressure).max() <= bound


@pytest.mark.parametrize("seed", range(20))
def test_pressure_that_equilibrium_fixes_is_no_obstacle(seed):
    """A tool on a single point, or two: their compliance is round-off in the gauge, and their pressure is known."""
    rng = np.random.default_rng(seed)
    n, k = 6, 1 + seed % 2
    A, D = rng.standard_normal((n, n)), 10.0 ** rng.uniform(-6 * (seed % 3), 0, n)
    R = np.eye(n)[:, rng.permutation(n)[:k]] @ (rng.standard_normal((k, k)) + 2 * np.eye(k))
    load = -(D[:, None] * R).T @ rng.uniform(0.5, 1, n)
    M = (A @ A.T + np.eye(n)) * np.sqrt(D) / np.sqrt(D)[:, None]
    problem = CondensedContact.from_compliance(M, rng.standard_normal(n), D, rigid_motions=R, motion_load=load)
    certificate = judged(problem, complementarity.solve(problem))
    assert certificate.certified
    assert certificate.relative_error_bound is not None
    assert certificate.relative_error_bound < 1e-6


@pytest.mark.parametrize("k", [0, 1])
@pytest.mark.parametrize("seed", range(4))
def test_body_that_turns_easily_is_certified(seed, k):
    """A turn 1e10 to 1e12 times as compliant as the rest, as about a short held edge: the bound holds, and is small."""
    rng, n = np.random.default_rng(seed), 8
    A, lever = rng.standard_normal((n, n)), np.sort(rng.uniform(-1, 1, n))
    J, R = rng.uniform(0.3, 1.5, n), np.ones((n, k))
    local, turn = A @ A.T + np.eye(n), 10.0 ** rng.uniform(10, 12)
    M = (local + turn * np.outer(lever, lever)) * J
    p = np.append(rng.uniform(0.5, 1.5, 3), np.zeros(n - 3))
    load = -(J[:, None] * R).T @ p
    problem = CondensedContact.from_compliance(M, 3 * (p == 0) - M @ p, J, rigid_motions=R, motion_load=load)
    exact, solution = exact_pressure(problem), complementarity.solve(problem)
    certificate = judged(problem, solution)
    assert exact is not None
    assert certificate.certified
    for size in (0.0, 1e-14, 1e-12):
        other = moved(problem, solution, size * rng.standard_normal(n), np.zeros(k))
        bound = judged(problem, other).error_bound
        assert bound is not None
        assert max(abs(Fraction(u) - v) for u, v in zip(other.pressure, exact, strict=True)) <= bound


@pytest.mark.parametrize("seed", range(20))
def test_rounding_of_the_sums_that_are_stored_is_counted(seed):
    """The gap without contact is ε + Δ1: where the body turns easily, what this sum loses is an error of pressures."""
    rng, n = np.random.default_rng(seed), 4
    A, lever, J = rng.standard_normal((n, n)), rng.standard_normal(n), rng.uniform(0.3, 1.5, n)
    M = (A @ A.T + np.eye(n) + 1e12 * np.outer(lever, lever)) * J
    problem = CondensedContact.from_compliance(M, -M @ rng.uniform(0.1, 1.5, n), J)
    apart = rng.uniform(0.3, 2) * rng.standard_normal(n) * np.abs(problem.offset).max()
    problem = replace(problem, initial_gap=problem.offset + apart, free_displacement=-apart)
    solution, exact = complementarity.solve(problem), exact_pressure(problem)
    bound = judged(problem, solution).error_bound
    assert exact is not None
    assert bound is not None
    assert max(abs(Fraction(u) - v) for u, v in zip(solution.pressure.tolist(), exact, strict=True)) <= bound


@pytest.mark.parametrize("seed", range(12))
def test_load_that_no_pressures_carry_is_not_certified(seed):
    """A point carries alone at the edge of what points can carry: without rounding ℓ = J R, the load is beyond it."""
    rng, n, k = np.random.default_rng(seed), 5, 3
    J, R = rng.uniform(0.1, 1, n), rng.standard_normal((n, k))
    p = 1.0 * (np.arange(n) == 0)
    problem = CondensedContact.from_compliance(
        np.eye(n), rng.uniform(0.1, 1, n) * (p == 0) - p, J, rigid_motions=R, motion_load=-(J[:, None] * R).T @ p
    )
    certificate = judged(problem, complementarity.solve(problem))
    assert exact_pressure(problem) is not None or not certificate.certified


@pytest.mark.parametrize("distance", [1e-2, 1e-5, 1e-8, 1e-11])
@pytest.mark.parametrize("seed", range(5))
def test_points_side_by_side_carry_a_moment_to_less_accuracy(seed, distance):
    """Contact on two of four points, or where their gaps tilt the body by round-off on a third one too.

    The pressures are those of exhaustive search in fractions.
    """
    rng = np.random.default_rng(seed)
    x = np.array([0.0, distance, 1.0, 2.0]) + rng.uniform(-1, 1)
    J, p = rng.uniform(0.5, 1.5, 4), np.append(rng.uniform(0.5, 1.5, 2), [0, 0])
    R = np.column_stack([np.ones(4), x])
    problem = CondensedContact.from_compliance(
        np.eye(4), [-p[0], -p[1], 50, 50], J, rigid_motions=R, motion_load=-(J[:, None] * R).T @ p
    )
    exact, solution = exact_pressure(problem), complementarity.solve(problem)
    bound = judged(problem, solution).error_bound
    assert exact is not None
    assert bound is not None
    assert max(abs(Fraction(u) - v) for u, v in zip(solution.pressure.tolist(), exact, strict=True)) <= bound


def solved(rows: list[list[Fraction]]) -> list[Fraction] | None:
    """Solve linear equations, the right side last, without rounding; None if there is no pivot."""
    for i in range(len(rows)):
        pivot = next((row for row in rows[i:] if row[i]), None)
        if pivot is None:
            return None
        rows.remove(pivot)
        unit = [value / pivot[i] for value in pivot]
        rows = [[a - row[i] * b for a, b in zip(row, unit, strict=True)] for row in rows]
        rows.insert(i, unit)
    return [row[-1] for row in rows]


def exact_pressure(problem: CondensedContact) -> list[Fraction] | None:
    """The first contact state of all contact sets, by the numbers of the problem without rounding; None if none is."""

    def exact(values: np.ndarray) -> list[Fraction]:
        return [Fraction(value) for value in values.tolist()]

    (n, k), M, R = problem.rigid_motions.shape, [*map(exact, problem.compliance)], [*map(exact, problem.rigid_motions)]
    q = [a + b for a, b in zip(exact(problem.initial_gap), exact(problem.free_displacement), strict=True)]
    J, load = exact(problem.weights), exact(problem.motion_load)
    for chosen in itertools.chain.from_iterable(itertools.combinations(range(n), m) for m in range(k, n + 1)):
        rows = [[M[i][j] for j in chosen] + R[i] + [-q[i]] for i in chosen]
        rows += [[J[i] * R[i][j] for i in chosen] + [Fraction(0)] * k + [-load[j]] for j in range(k)]
        x = solved(rows)
        if x is None or min(x[: len(chosen)], default=Fraction(0)) < 0:
            continue
        p = dict(zip(chosen, x, strict=False))
        gaps = (
            q[i] + sum(M[i][j] * p[j] for j in chosen) + sum(r * a for r, a in zip(R[i], x[len(chosen) :], strict=True))
            for i in range(n)
        )
        if all(gap >= 0 for i, gap in enumerate(gaps) if i not in p):
            return [p.get(i, Fraction(0)) for i in range(n)]
    return None


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_fewer_points_than_motions_carry_what_round_off_leaves_only_with_others(seed):
    """Two points carry a load in three motions, but for its round-off, which other points must carry.

    Points of the same sign differ from these in the third motion by round-off only, so that they may need large
    pressures. The bound holds for the state without any rounding.
    """
    rng = np.random.default_rng(seed)
    for _ in range(10):
        n, x = 5, rng.uniform(0.1, 1, 5) * [1, 1, 1, -1, -1]
        R = np.column_stack([np.ones(n), x, rng.uniform(0.1, 1) * x + rng.uniform(0.1, 1) * np.sign(x)])
        p = rng.uniform(0.1, 1, n) * (np.arange(n) < 2)
        problem = CondensedContact.from_compliance(
            np.eye(n), rng.uniform(0.1, 1, n) * (p == 0) - p, rigid_motions=R, motion_load=-R.T @ p
        )
        solution, exact = complementarity.solve(problem), exact_pressure(problem)
        bound = judged(problem, solution).error_bound
        if exact is not None and bound is not None:
            assert max(abs(Fraction(u) - v) for u, v in zip(solution.pressure.tolist(), exact, strict=True)) <= bound


@pytest.mark.parametrize("seed", range(10))
def test_point_that_carries_alone_between_others_is_certified(seed):
    """Round-off of the moment tilts the body onto a neighbor on either side, which carries little."""
    rng = np.random.default_rng(seed)
    x, p = np.array([-1.0, 0.0, 1.0]) + rng.uniform(-1, 1), rng.uniform(0.5, 1)
    R, J = np.column_stack([np.ones(3), x]), rng.uniform(0.5, 1.5, 3)
    problem = CondensedContact.from_compliance(
        np.eye(3) / J[:, None], [1.0, -p / J[1], 1.0], J, rigid_motions=R, motion_load=-p * J[1] * R[1]
    )
    solution, exact = complementarity.solve(problem), exact_pressure(problem)
    certificate = judged(problem, solution)
    assert exact is not None
    assert certificate.certified
    assert certificate.error_bound is not None
    error = max(abs(Fraction(u) - v) for u, v in zip(solution.pressure.tolist(), exact, strict=True))
    assert error <= certificate.error_bound < 1e-6


@pytest.mark.parametrize("k", [1, 2])
@pytest.mark.parametrize("size", [0.0, 1e-18, 1e-15])
def test_pressures_of_round_off_carry_nothing(k, size):
    """A free body without load that touches nowhere: pressures of round-off are no state of their own."""
    R = np.column_stack([np.ones(3), [-1.0, 0.3, 1.0]])[:, :k]
    problem = CondensedContact.from_compliance(np.eye(3), [0.5, 1.0, 0.5], rigid_motions=R, motion_load=np.zeros(k))
    solution = moved(problem, complementarity.solve(problem), np.array([size, 0.0, size / 2]), np.ones(k) / 10)
    certificate = judged(problem, solution)
    assert certificate.certified
    assert certificate.error_bound is not None
    assert solution.pressure.max() <= certificate.error_bound < 1e-13


@pytest.mark.parametrize("seed", range(40))
def test_definite_parts_below_the_round_off_of_the_rest_prove_nothing(seed):
    """[[1, b], [4 - b, 1]] with b = 1e16 and more has λ = -1, which a rounded product D M hides."""
    rng = np.random.default_rng(seed)
    b = float(round(rng.uniform(1e16, 3e16)) // 8 * 8)
    M = np.array([[1.0, b], [4 - b, 1.0]])
    assert Fraction(M[0, 1]) + Fraction(M[1, 0]) == 4
    problem = CondensedContact.from_compliance(M, rng.standard_normal(2) - 2)
    assert not judged(problem, complementarity.solve(problem)).certified


@pytest.mark.parametrize("k", [0, 2])
def test_bound_falls_with_the_error(k):
    """It is linear in the error near the solution: a thousandth of the change has about a thousandth of the bound."""
    problem = random_contact(3, 8, k)
    exact = complementarity.solve(problem)
    change = np.where(exact.pressure > 0, 1e-4, 0.0)
    large, small = (judged(problem, moved(problem, exact, s * change, np.zeros(k))).error_bound for s in (1.0, 1e-3))
    assert large is not None
    assert small is not None
    assert 500 < large / small < 2000


def test_body_lifted_off_its_support_is_bounded_too():
    """M = I, R = 1: the right pressure is 1 on the first of 400 points; 1/400 on each, far above the surface, is wrong.

    min(p, δ) is small there, 1/20 by norm, so that (1 + ‖DM‖)/λ = 3 times it is no bound of the error, which is near 1.
    """
    n = 400
    offset = np.append(0.0, np.full(n - 1, 10.0))
    problem = CondensedContact.from_compliance(np.eye(n), offset, rigid_motions=np.ones(n), motion_load=-1.0)
    exact = complementarity.solve(problem)
    np.testing.assert_allclose(exact.pressure, np.eye(n)[0], atol=1e-12)
    lifted = moved(problem, exact, 1 / n - exact.pressure, np.array([100.0]))
    certificate = judged(problem, lifted)
    natural = np.minimum(lifted.pressure, problem.initial_gap + lifted.displacement)
    assert np.linalg.norm(natural) == pytest.approx(1 / 20, rel=1e-9)
    assert certificate.kind is CertificateKind.NOT_A_SOLUTION
    assert certificate.error_bound is not None
    assert certificate.error_bound >= 1 - 1 / n


def test_wrong_pressure_is_no_solution():
    problem = random_contact(1, 8, 1)
    exact = complementarity.solve(problem)
    certificate = judged(problem, replace(exact, pressure=exact.pressure * 1.01))
    assert certificate.kind is CertificateKind.NOT_A_SOLUTION
    assert not certificate.certified
    assert "where 1.0e-10 is allowed" in certificate.words


def test_solution_that_may_not_be_the_only_one():
    """M = [[1, 2], [2, 1]], q = -1: p = (1, 0), (0, 1) and (1/3, 1/3) all solve; the eigenvalue is -1."""
    problem = CondensedContact.from_compliance([[1.0, 2.0], [2.0, 1.0]], [-1.0, -1.0])
    solution = complementarity.solve(problem)
    certificate = judged(problem, solution)
    assert certificate.kind is CertificateKind.LOCAL
    assert not certificate.certified
    assert certificate.error_bound is None
    assert certificate.smallest_eigenvalue == pytest.approx(-1, rel=1e-12)
    assert "another contact state may exist" in certificate.words


def test_eigenvalue_is_taken_on_the_equilibrium_space():
    """The form [[1, 2], [2, 1]] is -1 along (1, -1), all that R = (1, 1) leaves; R = (1, -1) leaves (1, 1), with 3."""
    for motion, sign in ((1.0, -1), (-1.0, 1)):
        problem = CondensedContact.from_compliance(
            [[1.0, 2.0], [2.0, 1.0]], [1.0, 1.0], rigid_motions=[1.0, motion], motion_load=-1.0
        )
        value = judged(problem, complementarity.solve(problem)).smallest_eigenvalue
        assert value is not None
        assert np.sign(value) == sign


def test_equilibrium_alone_fixes_the_pressure():
    """With n = k there is no eigenvalue, and the solution is certified all the same."""
    problem = CondensedContact.from_compliance([[1.0]], [1.0], rigid_motions=[1.0], motion_load=-2.0)
    certificate = judged(problem, complementarity.solve(problem))
    assert certificate.certified
    assert certificate.smallest_eigenvalue is None
    assert certificate.error_bound == pytest.approx(0.0, abs=1e-14)


def test_no_contact_is_certified():
    problem = CondensedContact.from_compliance(np.eye(3), np.ones(3))
    certificate = judged(problem, complementarity.solve(problem))
    assert certificate.certified
    assert certificate.relative_error_bound is None


@pytest.mark.parametrize("k", [1, 2, 3])
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("share", [0.0, 1e-8, 1e-4])
def test_light_and_absent_loads_are_certified(seed, k, share):
    """Gaps are much larger than what the load deforms, and there may be fewer points in contact than free motions."""
    contact = random_contact(seed, 6, k)
    light = replace(contact, motion_load=share * contact.motion_load)
    certificate = judged(light, complementarity.solve(light))
    assert certificate.certified, certificate.words


@pytest.mark.parametrize(("length", "stress"), [(1e-3, 1e6), (1e3, 1e-6)])
def test_units_do_not_matter(length, stress):
    problem = random_contact(2, 8, 1)
    other = in_units(problem, length, stress)
    change = np.full(problem.size, 1e-3)
    lift = np.zeros(1)
    one = judged(problem, moved(problem, complementarity.solve(problem), change, lift))
    two = judged(other, moved(other, complementarity.solve(other), change * stress, lift))
    assert two.smallest_eigenvalue == pytest.approx(one.smallest_eigenvalue, rel=1e-9)
    assert two.relative_error_bound == pytest.approx(one.relative_error_bound, rel=1e-8)


def test_wide_gaps_far_away_hide_nothing():
    """Two points that touch, a third a million times farther: only the right pressure is certified."""
    M = np.array([[2.0, 0.5, 0.1], [0.4, 2.0, 0.1], [0.1, 0.1, 2.0]])
    problem = CondensedContact.from_compliance(M, np.array([-1e-6, -1e-6, 1.0]))
    right = complementarity.solve(problem)
    assert certify(problem, right, residuals(problem, right)).certified
    for factor in (0.0, 0.99, 1.01, 2.0):
        p = factor * right.pressure
        wrong = replace(right, pressure=p, displacement=M @ p)
        assert not certify(problem, wrong, residuals(problem, wrong)).certified


@pytest.mark.parametrize("seed", range(30))
def test_nothing_but_equilibrium_is_certified(seed):
    """As many points as motions, n = k: p = -ℓ⁻ᵀ load, and nothing else is certified."""
    rng = np.random.default_rng(seed)
    R, expected = rng.standard_normal((2, 2)), rng.uniform(0.5, 2, 2)
    M = np.eye(2) + 0.1 * rng.standard_normal((2, 2))
    problem = CondensedContact.from_compliance(M, rng.uniform(-1, 1, 2), rigid_motions=R, motion_load=-R.T @ expected)
    for solver in (complementarity.solve, qp3.solve):
        result = solver(problem)
        assert certify(problem, result, residuals(problem, result)).certified
        assert result.pressure == pytest.approx(expected, rel=1e-9)
    wrong = replace(result, pressure=np.zeros(2))
    assert not certify(problem, wrong, residuals(problem, wrong)).certified


def ended(status: Status, formulation: str) -> ContactSolution:
    none = np.zeros(1)
    return ContactSolution(
        formulation=formulation,
        solver="any",
        status=status,
        pressure=none,
        displacement=none,
        rigid_amplitudes=np.zeros(0),
        iterations=7,
    )


@pytest.mark.parametrize(("status", "formulation"), [*itertools.product(Status, FormulationName)])
def test_advice_can_be_followed(status: Status, formulation: FormulationName):
    """Its options exist, and it never sends a person to the formulation that was used."""
    words = advice(ended(status, formulation))
    solve = typer.main.get_command(cli.app).commands["solve"]  # pyright: ignore[reportAttributeAccessIssue]
    known = {name for parameter in solve.params for name in parameter.opts}
    assert {*re.findall(r"--[a-z-]+", words)} <= known
    assert f"--formulation {formulation}" not in words
    assert words.endswith(".")


def test_advice_goes_by_the_status():
    assert "Raise the limit (--max-iterations; 7 were done)." in advice(ended(Status.ITERATION_LIMIT, "qp3"))
    assert "another start" in advice(ended(Status.ITERATION_LIMIT, "qp1"))
    assert "support" in advice(ended(Status.INFEASIBLE, "qp1"))
    assert "start" not in advice(ended(Status.NUMERICAL_FAILURE, "qp3"))
