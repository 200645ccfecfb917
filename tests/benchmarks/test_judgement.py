"""The judge of the benchmark of solvers, on programs whose answer is known in closed form."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from judgement import Verdict, active_normals, descends, judge, least_multipliers
from peers import PEERS, Answer, Claim, Peer, run, slsqp
from qp_instance import Instance, compliance_rows, half_plane, qp1, qp2, read, read_folder, stated, status_instances

FREE, QUADRANT = (-np.inf, np.inf), (0, np.inf)
SADDLE = stated("diag(1, -1)", "made here", np.diag([1, -1]), [0, 0], (), FREE)
PRODUCT = stated("-xy", "made here", [[0, -1], [-1, 0]], [0, 0], (), QUADRANT)
SLOPE = ([[1, 1]], [-np.inf], [1])
PROJECTION = stated("½|x - (2, 1)|², x + y <= 1", "made here", np.eye(2), [-2, -1], SLOPE, QUADRANT)
"""The nearest point to (2, 1) of the triangle is its vertex (1, 0), where z = 1 on the slope and 0 on the axis."""


def verdict(instance: Instance, x: list[float]) -> Verdict:
    return judge(instance, np.array(x, float)).verdict


@pytest.mark.parametrize(
    ("instance", "x", "expected"),
    [
        (PROJECTION, [1, 0], Verdict.MINIMISER),
        (PROJECTION, [0.5, 0.5], Verdict.NOT_STATIONARY),
        (PROJECTION, [0, 0], Verdict.NOT_STATIONARY),
        (PROJECTION, [2, 1], Verdict.INFEASIBLE),
        (PROJECTION, [1 + 1e-5, 0], Verdict.INFEASIBLE),
        (PROJECTION, [-1e-5, 0], Verdict.INFEASIBLE),
        (PROJECTION, [np.nan, 0], Verdict.NO_POINT),
        (PROJECTION, [1, 0, 0], Verdict.NO_POINT),
        (SADDLE, [0, 0], Verdict.SADDLE),
        (SADDLE, [0, 1], Verdict.NOT_STATIONARY),
    ],
)
def test_points_of_two_unknowns(instance, x, expected):
    assert verdict(instance, x) is expected


def test_nothing_returned():
    assert judge(PROJECTION, None).verdict is Verdict.NO_POINT


def test_dead_point_of_a_product():
    """Both multipliers at 0 are zero, both edges are flat, and the diagonal of the quadrant descends."""
    assert verdict(PRODUCT, [0, 0]) is Verdict.SADDLE


def test_copositive_is_enough():
    """+xy over the quadrant: indefinite, every multiplier zero, and 0 is the minimum for all that."""
    assert verdict(replace(PRODUCT, H=-PRODUCT.H), [0, 0]) is Verdict.MINIMISER


def test_strong_multiplier_closes_a_direction():
    """The bound 0 is a strict minimum of x - ½x² in spite of the curvature, and of -½x² it is none."""
    bent = stated("x - ½x²", "made here", [[-1]], [1])
    assert verdict(bent, [0]) is Verdict.MINIMISER
    assert verdict(replace(bent, c=np.zeros(1)), [0]) is Verdict.SADDLE


def test_equality_closes_a_direction():
    """½(x² - y²) on y = 0 is convex, on x = 0 concave."""
    on_a_line = replace(SADDLE, A=np.array([[0.0, 3.0]]), cl=np.zeros(1), cu=np.zeros(1))
    assert verdict(on_a_line, [0, 0]) is Verdict.MINIMISER
    assert verdict(replace(on_a_line, A=np.array([[3.0, 0.0]])), [0, 0]) is Verdict.SADDLE


def test_upper_bounds_and_redundant_rows():
    """At the upper corner of a box a linear objective is least, though a row through the corner says the same again."""
    box = stated("-x - y", "made here", np.zeros((2, 2)), [-1, -1], ([[1, 1], [2, 2]], [-np.inf] * 2, [2, 4]), (0, 1))
    assert verdict(box, [1, 1]) is Verdict.MINIMISER
    assert verdict(box, [1, 0]) is Verdict.NOT_STATIONARY


def test_multipliers_of_a_projection():
    """At (1, 0) gradient = (-1, -1) = z (-1, -1) with z = 1 for x + y <= 1, and 0 for y >= 0."""
    x = np.array([1.0, 0.0])
    E, N, distance = active_normals(PROJECTION, x)
    z, left = least_multipliers(PROJECTION.gradient(x), E, N)
    assert len(E) == 0
    np.testing.assert_allclose(N, [[0, 1], [-np.sqrt(0.5), -np.sqrt(0.5)]], atol=1e-15)
    np.testing.assert_allclose(z, [0, np.sqrt(2)], atol=1e-12)
    assert left < 1e-12
    np.testing.assert_allclose(distance, 0, atol=1e-15)


@pytest.mark.parametrize("seed", range(20))
def test_copositivity_of_three_variables(seed):
    """Hadeler's criterion: with a unit diagonal, every h_ij >= -1 and Σ h_ij + √(2 Π (1 + h_ij)) >= -1."""
    a, b, c = np.random.default_rng(seed).uniform(-1.3, 1.0, 3)
    H = np.array([[1, a, b], [a, 1, c], [b, c, 1]])
    product = (1 + a) * (1 + b) * (1 + c)
    copositive = min(a, b, c) >= -1 and a + b + c + 1 + np.sqrt(2 * max(product, 0)) >= 0
    assert descends(H, np.zeros((0, 3)), np.eye(3)) is not copositive


def test_repeated_eigenvalue_inside_the_cone():
    """-½|x|² over the orthant: every direction descends, and no eigenvector that LAPACK picks need lie inside."""
    assert descends(-np.eye(4), np.zeros((0, 4)), np.eye(4))


def test_a_search_cut_short_states_so():
    """Motzkin and Straus: with C a pentagon plus 9 isolated points, 2(A + I) - eeᵀ is copositive on 14 variables."""
    n = 14
    adjacent = np.zeros((n, n))
    for i in range(5):
        adjacent[i, (i + 1) % 5] = adjacent[(i + 1) % 5, i] = 1
    assert descends(2 * (adjacent[:5, :5] + np.eye(5)) - 1, np.zeros((0, 5)), np.eye(5)) is False
    padded = np.eye(n)
    padded[:5, :5] = 2 * (adjacent[:5, :5] + np.eye(5)) - 1
    assert descends(padded, np.zeros((0, n)), np.eye(n)) is None


def test_descent_in_a_large_face():
    """With -1/10 off a unit diagonal, eᵀHe = k (1 - (k - 1)/10) < 0 only where twelve or more of fifteen move."""
    assert descends(1.1 * np.eye(15) - 0.1, np.zeros((0, 15)), np.eye(15))


@pytest.mark.parametrize("instance", list(status_instances()), ids=lambda instance: instance.name)
def test_programs_without_a_minimizer(instance):
    """No point of a grid is called a minimizer."""
    n = instance.c.size
    for x in np.array(np.meshgrid(*[np.linspace(-2, 2, 9)] * n)).reshape(n, -1).T:
        assert judge(instance, x).verdict is not Verdict.MINIMISER


@pytest.mark.parametrize("modulus", [1e3, 2e6])
@pytest.mark.parametrize("statement", [qp1, qp2])
@pytest.mark.parametrize("n", [11, 41])
def test_contact_programs(n, statement, modulus):
    """The quadratic is pᵀJ(ε + u_n) plus the penalty, and the solution of the contact problem is its global minimum."""
    contact = half_plane(n, modulus, seed=3)
    instance = statement(contact, compliance_rows(contact))
    rng = np.random.default_rng(0)
    u, p = rng.standard_normal((2, n))
    residual = u - contact.compliance @ p - contact.free_displacement
    expected = p @ (contact.weights * (contact.initial_gap + u)) + (residual @ residual if statement is qp2 else 0)
    assert instance.objective(np.append(u, p)) == pytest.approx(expected, rel=1e-10)
    judgement = judge(instance, np.concatenate(instance.truth))
    assert judgement.verdict is Verdict.MINIMISER
    assert judgement.is_global
    assert judgement.error == 0
    wrong = np.concatenate([instance.truth[0], 1.5 * instance.truth[1]])
    assert judge(instance, wrong).error == pytest.approx(0.5)


def test_best_known_objective():
    """PROJECTION at (1, 0) is ½ - 2: equal to the best is global, 1e-4 above it is not."""
    x = np.array([1.0, 0.0])
    assert judge(replace(PROJECTION, best=-1.5), x).is_global
    assert not judge(replace(PROJECTION, best=-1.5002), x).is_global
    assert not judge(PROJECTION, x).is_global


def test_instances_from_files(tmp_path):
    """What was written as triplets is read as it was; a file that states something else is passed over."""
    A = PROJECTION.A
    np.savez(
        tmp_path / "a.npz", n=2, m=1, Hi=[0, 1], Hj=[0, 1], Hv=[1.0, 1.0], Ai=[0, 0], Aj=[0, 1], Av=A[0],
        c=PROJECTION.c, cl=PROJECTION.cl, cu=PROJECTION.cu, bl=PROJECTION.bl, bu=PROJECTION.bu, const=2.5, best=1.0,
        name="a", group="made here", status="optimal",
    )  # fmt: skip
    np.savez(tmp_path / "b.npz", M=np.eye(2), q=np.ones(2))
    (found,) = read_folder(tmp_path)
    np.testing.assert_array_equal(found.H, PROJECTION.H)
    np.testing.assert_array_equal(found.A, A)
    assert judge(found, np.array([1.0, 0.0])).is_global
    assert read(tmp_path / "b.npz") is None
    with pytest.raises(SystemExit, match=r"no \.npz file"):
        list(read_folder(Path(tmp_path / "nowhere")))


@pytest.mark.parametrize("peer", [peer for peer in PEERS if peer.installed], ids=lambda peer: peer.name)
def test_peers_that_are_installed(peer):
    """Each finds the point of the triangle nearest to (3, 1), the vertex with multipliers 2 and 1; the judge agrees."""
    instance = replace(PROJECTION, c=np.array([-3.0, -1.0]))
    answer = peer.solve(instance)
    assert answer.claim is Claim.OPTIMAL
    assert judge(instance, answer.x).verdict is Verdict.MINIMISER
    assert answer.x == pytest.approx([1, 0], abs=1e-6)


def raises(instance: Instance) -> Answer:
    raise ArithmeticError(instance.name)


def sleeps(instance: Instance) -> Answer:
    while True:
        pass


def test_peers_that_are_absent_or_fail():
    """No package, an exception and an endless loop are told apart, and none of them stops the benchmark."""
    assert not Peer(name="none", package="no_such_package", solve=slsqp).installed
    failed = run(Peer(name="raises", package="numpy", solve=raises), PROJECTION, limit=20)
    late = run(Peer(name="sleeps", package="numpy", solve=sleeps), PROJECTION, limit=0.5)
    assert (failed.x, failed.claim, failed.says) == (None, Claim.NOTHING, f"ArithmeticError: {PROJECTION.name}")
    assert (late.x, late.claim, late.says) == (None, Claim.NOTHING, "time limit or crash")
    answer = run(PEERS[-1], PROJECTION, limit=20)
    assert answer.x == pytest.approx([1, 0], abs=1e-6)


def test_a_point_off_its_constraint_by_little():
    """An interior point stops at z·s of about its tolerance: at y = s the multiplier 1 of y >= 0 leaves z·s = s."""
    slope = stated("½x² + y", "made here", np.diag([1, 0]), [0, 1])
    assert verdict(slope, [0, 5e-7]) is Verdict.MINIMISER
    assert verdict(slope, [0, 5e-6]) is Verdict.NOT_STATIONARY
    assert verdict(replace(slope, c=np.array([0, 1e-2])), [0, 5e-6]) is Verdict.MINIMISER
