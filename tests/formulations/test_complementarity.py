"""The direct solver: against all contact sets, on the classical worst cases, on bodies that contact alone holds."""

import itertools

import numpy as np
import pytest
from contact_problems import in_units, random_contact
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.formulations.complementarity import (
    escape_note,
    polish,
    solve,
    standard_form,
)
from bemcontact.formulations.scaling import scale


def exhaustive(problem: CondensedContact) -> np.ndarray:
    """The pressure that solves the problem, by a search of all 2ⁿ contact sets."""
    M, R, ell, n, k = problem.compliance, problem.rigid_motions, problem.equilibrium, problem.size, problem.free_motions
    right = -np.concatenate([problem.offset, problem.motion_load])
    bordered = np.block([[M, R], [ell.T, np.zeros((k, k))]])
    for size in range(k, n + 1):
        for contact in itertools.combinations(range(n), size):
            rows = [*contact, *range(n, n + k)]
            if not rows:
                if problem.offset.min() >= 0:
                    return np.zeros(n)
                continue
            p_and_a = np.zeros(n + k)
            p_and_a[rows] = np.linalg.solve(bordered[np.ix_(rows, rows)], right[rows])
            gap = problem.gap(p_and_a[:n], p_and_a[n:])
            if min(p_and_a[:n].min(), gap.min()) >= -1e-10:
                return p_and_a[:n]
    raise AssertionError("a strictly monotone problem whose load can be carried has a solution")


def block_in_a_corner(load: tuple[float, float, float]) -> CondensedContact:
    """Nine points on a floor, five on a wall; the load works in (x, y, rotation about the corner)."""
    rng = np.random.default_rng(0)
    floor = np.column_stack([np.linspace(0, 2, 9), np.zeros(9)])
    wall = np.column_stack([np.zeros(5), np.linspace(0, 1, 5)])
    (x, y), nx, ny = np.vstack([floor, wall]).T, np.repeat([0.0, 1.0], [9, 5]), np.repeat([1.0, 0.0], [9, 5])
    A = rng.standard_normal((14, 14))
    return CondensedContact.from_compliance(
        A @ A.T / 14 + 0.1 * np.eye(14),
        0.01 * rng.standard_normal(14),
        rng.uniform(0.5, 1.0, 14),
        rigid_motions=np.column_stack([nx, ny, x * ny - y * nx]),
        motion_load=load,
    )


def assert_solution(problem: CondensedContact, solution: ContactSolution, tolerance: float = 1e-13) -> None:
    """Conditions (16)-(18) and equilibrium, recomputed and divided by U and T."""
    U, T = problem.scales
    p, gap = solution.pressure / T, problem.gap(solution.pressure, solution.rigid_amplitudes) / U
    assert solution.status is Status.SOLVED
    assert (p >= 0).all()
    np.testing.assert_allclose(np.minimum(p, gap), 0, atol=tolerance)
    balance = (problem.equilibrium.T @ solution.pressure + problem.motion_load) / T
    np.testing.assert_allclose(balance, 0, atol=tolerance * np.abs(problem.equilibrium).sum())
    np.testing.assert_allclose(problem.initial_gap + solution.displacement, gap * U, atol=1e-14 * U)


@pytest.mark.parametrize("k", [0, 1, 2, 3])
@pytest.mark.parametrize("n", [4, 5, 6])
@pytest.mark.parametrize("seed", range(4))
def test_against_all_contact_sets(seed, n, k):
    problem = random_contact(seed, n, k)
    solution = solve(problem)
    assert_solution(problem, solution)
    np.testing.assert_allclose(solution.pressure, exhaustive(problem), atol=1e-10 * max(1.0, solution.pressure.max()))


@pytest.mark.parametrize("k", [0, 2])
def test_eight_points_against_all_contact_sets(k):
    problem = random_contact(7, 8, k)
    np.testing.assert_allclose(solve(problem).pressure, exhaustive(problem), atol=1e-10)


def test_one_point():
    """Interference 3 with compliance 2: p = 3/2; clearance: p = 0; on a free body the load itself."""
    assert solve(CondensedContact.from_compliance([[2.0]], [-3.0])).pressure == pytest.approx([1.5])
    assert solve(CondensedContact.from_compliance([[2.0]], [3.0])).pressure == pytest.approx([0.0])
    free = CondensedContact.from_compliance([[2.0]], [3.0], [0.5], rigid_motions=[[1.0]], motion_load=[-4.0])
    solution = solve(free)
    assert solution.pressure == pytest.approx([8.0])
    assert solution.rigid_amplitudes == pytest.approx([-3.0])


def test_all_open_and_all_closed():
    """With p = 0 where no point penetrates, p = -M⁻¹q where that is positive: here M = I + ones, q = -1."""
    M = np.eye(5) + 1.0
    assert (solve(CondensedContact.from_compliance(M, np.ones(5))).pressure == 0).all()
    np.testing.assert_allclose(solve(CondensedContact.from_compliance(M, -np.ones(5))).pressure, 1 / 6, rtol=1e-14)


def test_points_that_just_touch():
    """Points with p = 0 and δ = 0 at once: q = -M p for a p with zeros makes every point degenerate."""
    rng = np.random.default_rng(1)
    problem = random_contact(1, 10, 0)
    p = np.maximum(rng.standard_normal(10), 0)
    degenerate = CondensedContact.from_compliance(problem.compliance, -problem.compliance @ p, problem.weights)
    np.testing.assert_allclose(solve(degenerate).pressure, p, atol=1e-13)


@pytest.mark.parametrize("k", [0, 1])
def test_coincident_points_share_one_pressure(k):
    """A point listed twice with half its weight: the sum of the two forces is that of the single point."""
    single = random_contact(3, 7, k)
    twice = np.append(np.arange(7), 2)
    share = np.ones(8)
    share[[2, 7]] = 0.5
    double = CondensedContact.from_compliance(
        (single.compliance[np.ix_(twice, twice)] * share),
        single.offset[twice],
        single.weights[twice] * share,
        rigid_motions=single.rigid_motions[twice],
        motion_load=single.motion_load,
    )
    one, two = solve(single), solve(double)
    forces = two.pressure * share
    forces[2] += forces[7]
    assert two.status is Status.SOLVED
    np.testing.assert_allclose(forces[:7], one.pressure, atol=1e-11)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 3))
def test_renumbered_problem_has_the_renumbered_solution(seed, k):
    problem = random_contact(seed, 9, k)
    order = np.random.default_rng(seed).permutation(9)
    other = CondensedContact.from_compliance(
        problem.compliance[np.ix_(order, order)],
        problem.offset[order],
        problem.weights[order],
        rigid_motions=problem.rigid_motions[order],
        motion_load=problem.motion_load,
    )
    peak = max(1.0, solve(problem).pressure.max())
    np.testing.assert_allclose(solve(other).pressure, solve(problem).pressure[order], atol=1e-9 * peak)


@pytest.mark.parametrize(("length", "stress"), [(1e-3, 1e6), (1e3, 1e-6), (25.4, 6.894757)])
@pytest.mark.parametrize("k", [0, 1, 3])
def test_units_do_not_matter(length, stress, k):
    problem = random_contact(11, 20, k)
    other = in_units(problem, length, stress)
    one, two = solve(problem), solve(other)
    np.testing.assert_allclose(two.pressure / stress, one.pressure, atol=1e-12 * one.pressure.max())


def half_plane(modulus: float, *, free: bool) -> CondensedContact:
    """A parabola on 101 strips of the logarithmic kernel, pressed into it or by a load."""
    n = 101
    edges = np.linspace(-4, 4, n + 1)
    middle, width = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    primitive = [(s := middle[:, None] - end) * np.log(np.abs(s)) - s for end in (edges[1:], edges[:-1])]
    compliance = 2 / (np.pi * modulus) * (primitive[0] - primitive[1] + np.log(40) * width)
    return CondensedContact.from_compliance(
        compliance,
        middle**2 / 16 - (0 if free else 0.05),
        width,
        rigid_motions=np.ones(n) if free else None,
        motion_load=-0.05 * modulus if free else None,
    )


@pytest.mark.parametrize("modulus", [1e3, 2e6, 2e11])
@pytest.mark.parametrize("free", [False, True])
def test_half_plane_at_any_modulus(modulus, free):
    """Symmetric, in one piece, exact conditions at every modulus, and as many iterations."""
    problem = half_plane(modulus, free=free)
    solution = solve(problem)
    assert_solution(problem, solution, 1e-14)
    p = solution.pressure
    np.testing.assert_allclose(p, p[::-1], atol=1e-12 * p.max())
    assert np.abs(np.diff((p > 0).astype(int))).sum() == 2
    assert solution.iterations == solve(half_plane(1.0, free=free)).iterations


@pytest.mark.parametrize("side_load", [0.0, 1e-17, -1e-17, -0.5])
def test_block_in_a_corner(side_load):
    """Three free motions; without a side load the wall may touch but not press, and forces and moment balance."""
    problem = block_in_a_corner((side_load, -1.0, -1.0))
    solution = solve(problem)
    assert_solution(problem, solution)
    pressing = (problem.weights * solution.pressure)[9:].sum()
    assert pressing == pytest.approx(-side_load, abs=1e-13)


@pytest.mark.parametrize("load", [(0.0, -1.0, -2.0), (0.0, -1.0, 0.0), (0.0, 0.0, 0.0)])
def test_load_on_the_edge_of_what_can_be_carried(load):
    """Over the outermost point (x = 2) or the corner, or no load at all: solved, with the conditions exact."""
    problem = block_in_a_corner(load)
    assert_solution(problem, solve(problem))


@pytest.mark.parametrize(
    ("load", "motion"),
    [
        ((0.0, 1.0, 0.0), "holds: the motion 2"),
        ((1e-3, -1.0, -1.0), "holds: the motion 1"),
        ((0.0, -1.0, -2.5), "motion 3"),
    ],
)
def test_load_that_carries_the_body_away_is_named(load, motion):
    """Lifted; pulled off the wall; tipped about the outermost point: no p >= 0 is in equilibrium."""
    problem = block_in_a_corner(load)
    solution = solve(problem)
    assert solution.status is Status.INFEASIBLE
    assert (solution.pressure == 0).all()
    assert "pulls the body off its support" in solution.notes[0]
    assert motion in solution.notes[0]


def test_note_of_a_supported_body_is_none():
    problem = block_in_a_corner((0.0, -1.0, -1.0))
    assert escape_note(problem) is None


@pytest.mark.parametrize("k", [0, 1, 2, 3])
def test_standard_form_states_the_same(k):
    """For any p in equilibrium and any a, J w = q' + M' z with pressure and gap exchanged on k points."""
    rng = np.random.default_rng(2)
    scaled = scale(random_contact(5, 9, k))
    matrix, vector, exchanged = standard_form(scaled)
    assert exchanged.sum() == k
    R, ell = scaled.rigid_motions, scaled.equilibrium
    p, a = rng.standard_normal(9), rng.standard_normal(k)
    p -= R @ np.linalg.solve(ell.T @ R, ell.T @ p + scaled.motion_load)
    gap = scaled.gap(p, a)
    z, w = np.where(exchanged, gap, p), np.where(exchanged, p, gap)
    np.testing.assert_allclose(vector + matrix @ z, scaled.weights * w, atol=1e-11)


@pytest.mark.parametrize("k", [1, 3])
def test_standard_form_is_monotone(k):
    """Where sym(JM) is positive definite on {ℓᵀp = 0}, sym(M') is positive semidefinite: Lemke ends with an answer."""
    matrix = standard_form(scale(random_contact(6, 12, k)))[0]
    smallest = np.linalg.eigvalsh(matrix + matrix.T)[0]
    assert smallest >= -1e-12 * np.abs(matrix).max()


@pytest.mark.parametrize("k", [0, 2])
def test_polish_makes_a_rough_solution_exact(k):
    """Off by 1e-4 in p, with the displacement that belongs to it: the contact set is right, so one step is exact."""
    rng = np.random.default_rng(3)
    problem = random_contact(8, 15, k)
    exact = solve(problem)
    p = np.maximum(exact.pressure + 1e-4 * rng.uniform(0, 1, 15), 0)
    rough = ContactSolution(
        formulation="test",
        solver="none",
        status=Status.SOLVED,
        pressure=p,
        displacement=exact.displacement,
        rigid_amplitudes=exact.rigid_amplitudes,
        iterations=3,
    )
    better = polish(problem, rough)
    assert better.polished
    assert (better.formulation, better.iterations) == ("test", 3)
    np.testing.assert_allclose(better.pressure, exact.pressure, atol=1e-12)


def test_polish_keeps_what_it_cannot_improve():
    problem = random_contact(9, 10, 1)
    exact = solve(problem)
    assert polish(problem, exact) is exact
