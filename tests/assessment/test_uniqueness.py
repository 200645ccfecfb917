"""Uniqueness without definiteness, against all contact states by exhaustive search."""

from dataclasses import replace
from itertools import combinations, product

import numpy as np
import pytest

from bemcontact.analysis.solve import solve
from bemcontact.assessment.certificate import CertificateKind, certify
from bemcontact.assessment.residual import residuals
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.formulations import complementarity
from bemcontact.problems import Problem

N = 5
"""Contact points of a random problem."""


def slightly_indefinite(rng: np.random.Generator) -> CondensedContact:
    """Five points and one free motion; sym(JM) has a negative eigenvalue with a wide eigenvector; gaps are wide."""
    n, J = N, rng.uniform(0.5, 1.5, N)
    ell = J / np.linalg.norm(J)
    Q = np.linalg.qr(np.column_stack([ell, rng.standard_normal((n, n - 1))]))[0][:, 1:]
    values = np.append(-(10 ** rng.uniform(-3, -0.3)), rng.uniform(0.1, 2, n - 2))
    skew = rng.standard_normal((n, n)) * 10 ** rng.uniform(-3, 0)
    M = (Q @ np.diag(values) @ Q.T + skew - skew.T) / J[:, None]
    q = np.abs(rng.standard_normal(n)) * 10 ** rng.uniform(-1, 1.5) * (rng.uniform(size=n) > 0.3)
    return CondensedContact.from_compliance(M, q, J, rigid_motions=np.ones(n), motion_load=[-1.0])


def all_states(contact: CondensedContact) -> list[np.ndarray]:
    """Pressures of all contact states with nonsingular contact sets."""
    M, R, ell, q = contact.compliance, contact.rigid_motions, contact.equilibrium, contact.offset
    n, k = R.shape
    found: list[np.ndarray] = []
    for m in range(k, n + 1):
        sets = [*combinations(range(n), m)]
        A = np.array(sets, int).reshape(len(sets), m)
        matrix = np.zeros((len(A), m + k, m + k))
        matrix[:, :m, :m] = M[A[:, :, None], A[:, None, :]]
        matrix[:, :m, m:] = R[A]
        matrix[:, m:, :m] = np.swapaxes(ell[A], 1, 2)
        regular = abs(np.linalg.det(matrix)) >= 1e-12
        A, load = A[regular], np.broadcast_to(contact.motion_load, (regular.sum(), k))
        x = np.linalg.solve(matrix[regular], -np.hstack([q[A], load])[:, :, None])[:, :, 0]
        p = np.zeros((len(A), n))
        np.put_along_axis(p, A, x[:, :m], axis=1)
        gap = q + p @ M.T + x[:, m:] @ R.T
        for state in p[(p.min(axis=1) >= -1e-9) & (gap.min(axis=1) >= -1e-9)]:
            if all(abs(state - other).max() > 1e-7 for other in found):
                found.append(state)
    return found


def certificate_of(contact: CondensedContact, solution: ContactSolution):
    return certify(contact, solution, residuals(contact, solution))


@pytest.mark.slow
def test_only_lonely_states_are_certified_and_the_bound_holds():
    """Of random indefinite problems some are certified: each has one state, and none that has two is certified.

    The bound holds for a pressure that is off by a known amount.
    """
    rng = np.random.default_rng(5)
    certified = several = 0
    for _ in range(60):
        contact = slightly_indefinite(rng)
        solution = complementarity.solve(contact)
        certificate = certificate_of(contact, solution)
        states = all_states(contact)
        assert certificate.smallest_eigenvalue is not None
        assert certificate.smallest_eigenvalue < 0
        several += len(states) > 1
        if not certificate.certified:
            continue
        certified += 1
        assert len(states) == 1
        assert "although the compliance is not positive definite" in certificate.words
        assert certificate.heading == "unique within the error bound"
        assert "no other state" not in certificate.words.lower()
        assert certificate.error_bound is not None
        assert abs(solution.pressure - states[0]).max() <= certificate.error_bound + 1e-12
        wrong = solution.pressure * (1 + 1e-6 * rng.standard_normal(N))
        moved = contact.gap(wrong, solution.rigid_amplitudes) - contact.initial_gap
        bound = certificate_of(contact, replace(solution, pressure=wrong, displacement=moved)).error_bound
        assert bound is None or abs(wrong - states[0]).max() <= bound
    assert certified > 5
    assert several > 0


def several_surfaces_at_a_node(rng: np.random.Generator) -> CondensedContact:
    """Two or three nodes in contact, which are points of one to three far surfaces too, with compliances nearly alike.

    The more these differ, and the less far the surfaces are, the more contact states there are.
    """
    m, n = (nodes := int(rng.integers(2, 4))), nodes + int(rng.integers(1, 4))
    node = np.append(np.arange(m), rng.integers(0, m, n - m))
    A, J = rng.standard_normal((m, m)), 10 ** rng.uniform(-1, 0, m)
    M = ((A @ A.T + np.eye(m)) / J[:, None])[np.ix_(node, node)]
    M = M + 10 ** rng.uniform(-6, 0.3) * rng.standard_normal((n, n))
    R, weights = np.column_stack([np.ones(n), node])[:, : rng.integers(1, 3)], J[node] * rng.uniform(0.5, 1.5, n)
    load = -(weights[:, None] * R)[:m].T @ rng.uniform(0, 1, m)
    far = 10 ** rng.uniform(-2, 3.5) * rng.uniform(0.3, 2, n)
    q = np.where(np.arange(n) < m, rng.uniform(0, 1, n) * (rng.uniform(size=n) < 0.5), far)
    return CondensedContact.from_compliance(M, q, weights, rigid_motions=R, motion_load=load)


def nearly_definite(rng: np.random.Generator) -> CondensedContact:
    """Compliances of which the symmetric part is definite but for a little, in other weights too."""
    n, k = int(rng.integers(3, 7)), int(rng.integers(0, 3))
    A, S, J = rng.standard_normal((n, n)), rng.standard_normal((n, n)), 10 ** rng.uniform(-0.3, 0.3, n)
    less = 10 ** rng.uniform(-2, 0) * rng.integers(0, 2)
    M = A @ A.T / n + 10 ** rng.uniform(-3, 0.3) * (S - S.T) - less * np.eye(n)
    M = M / (J * 10 ** rng.uniform(-0.2, 0.2, n))[:, None]
    R = np.column_stack([np.ones(n), np.arange(n) / n])[:, :k]
    load = -(J[:, None] * R).T @ np.maximum(rng.standard_normal(n), 0.0)
    return CondensedContact.from_compliance(M, rng.standard_normal(n), J, rigid_motions=R, motion_load=load)


def far_surfaces(rng: np.random.Generator) -> CondensedContact:
    """Points with any compliance, of which only those are in contact that are held against a definite one."""
    m, n, k = int(rng.integers(2, 4)), int(rng.integers(4, 8)), int(rng.integers(0, 3))
    A, J = rng.standard_normal((n, n)), 10 ** rng.uniform(-1, 0, n)
    M = A @ A.T / n + rng.uniform(0, 1) * (np.arange(n) < m) * np.eye(n) + rng.uniform(0, 0.5) * A
    R = np.column_stack([np.ones(n), np.arange(n) % m])[:, :k]
    load = -(J[:, None] * R)[:m].T @ rng.uniform(0, 1, m)
    q = np.where(np.arange(n) < m, -rng.uniform(0, 1, n), 10 ** rng.uniform(-1, 3) * rng.uniform(0.3, 2, n))
    return CondensedContact.from_compliance(M / J[:, None], q, J, rigid_motions=R, motion_load=load)


PROOFS = {
    "points_that_may_touch": lambda state: np.ones(len(state.pressure), bool),
    "effective_eigenvalue": lambda _: None,
    "near_bound": lambda _: np.inf,
    "reweighted_bound": lambda _: np.inf,
}
"""Proofs without a definite compliance, and what each gives where it proves nothing."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("proof", "problem", "count", "least"),
    [
        ("points_that_may_touch", far_surfaces, 400, (25, 3)),
        ("near_bound", several_surfaces_at_a_node, 150, (6, 1)),
        ("reweighted_bound", nearly_definite, 750, (50, 3)),
    ],
)
def test_each_proof_alone_proves_lonely_states_only(monkeypatch, proof, problem, count, least):
    """Each certified problem has one state, and the bound holds for all states. Pressures are off by a known amount."""
    for other, nothing in PROOFS.items():
        if other != proof:
            monkeypatch.setattr(f"bemcontact.assessment.certificate.{other}", nothing)
    rng = np.random.default_rng(5)
    certified = several = 0
    for _ in range(count):
        contact = problem(rng)
        solution = complementarity.solve(contact)
        certificate = certificate_of(contact, solution)
        if (certificate.smallest_eigenvalue or 1.0) > 0 or certificate.violation:
            continue
        states = all_states(contact)
        several += len(states) > 1
        if len(states) > 1:
            assert certificate.kind is CertificateKind.LOCAL
        certified += certificate.certified
        assert len(states) == 1 or not certificate.certified
        wrong = solution.pressure * (1 + 10 ** rng.uniform(-9, -2) * rng.standard_normal(contact.size))
        moved = contact.gap(wrong, solution.rigid_amplitudes) - contact.initial_gap
        bound = certificate_of(contact, replace(solution, pressure=wrong, displacement=moved)).error_bound
        assert bound is None or max(abs(wrong - state).max() for state in states) <= bound
    assert certified >= least[0]
    assert several >= least[1]


@pytest.mark.slow
@pytest.mark.parametrize(("length", "elements"), [(500, 40), (800, 60), (1000, 60), (1500, 120)])
def test_long_contact_of_a_slender_beam_is_certified(length: int, elements: int):
    """Under its weight on a floor, with one end pulled up: contact is half as long as the beam and longer."""
    edges = [("bottom", (0, 0), elements), ("right", (length, 0), 2), ("top", (length, 10), elements),
             ("left", (0, 10), 2)]  # fmt: skip
    problem = Problem(
        name="beam", accuracy=None, material={"young_modulus": 210e3, "poisson_ratio": 0.3},
        boundary={"outer": [{"name": name, "start": start, "elements": m} for name, start, m in edges]},
        conditions={"left": {"displacement": {"x": 0}}, "right": {"traction": {"y": 0.01}}},
        loads={"gravity": {"density": 7.8e-9, "acceleration": [0, -9810]}},
        contact_zones={"floor": {"edges": ["bottom"], "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
    )  # fmt: skip
    certificate = solve(problem, "complementarity").certificate
    assert certificate.certified
    assert (certificate.smallest_eigenvalue or 0) < 0


def beam(ratio: int, push: float, parts: int = 1) -> Problem:
    """A beam on a floor, pressed in its middle; its length is `ratio` times its height."""
    L, half = float(ratio), push / 2
    edges = [
        ("bottom", (0, 0), ratio), ("right", (L, 0), 2), ("t1", (L, 1), 0.5 * ratio - half),
        ("push", (L / 2 + half, 1), push), ("t2", (L / 2 - half, 1), 0.5 * ratio - half), ("left", (0, 1), 2),
    ]  # fmt: skip
    return Problem(
        name="beam",
        accuracy=None,
        material={"young_modulus": 1e4, "poisson_ratio": 0.3},
        boundary={
            "outer": [{"name": n, "start": start, "elements": max(1, round(m)) * parts} for n, start, m in edges]
        },
        conditions={"push": {"pressure": 1}},
        contact_zones={"floor": {"edges": ["bottom"], "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
    )


@pytest.mark.parametrize("ratio", [20, 50, 100])
def test_slender_beam_is_certified_although_its_compliance_is_not_definite(ratio: int):
    """The ends rise, and contact is as long as under an endless strip, which does not depend on the length."""
    result = solve(beam(ratio, 8), "complementarity")
    (interval,) = result.footprint.intervals
    short = solve(beam(20, 8), "complementarity").footprint
    assert result.certified
    assert (result.certificate.smallest_eigenvalue > 0) is (ratio < 100)
    assert interval.end_arc - interval.start_arc == pytest.approx(
        short.intervals[0].end_arc - short.intervals[0].start_arc, abs=0.05
    )
    assert result.footprint.peak.pressure == pytest.approx(short.peak.pressure, rel=1e-3)


@pytest.mark.slow
def test_contact_recedes_point_by_point_on_a_very_slender_beam():
    """175 steps of the active set: no fragments of contact are left where the ends rise."""
    result = solve(beam(200, 20), "complementarity")
    (interval,) = result.footprint.intervals
    assert interval.start_arc == pytest.approx(200 - interval.end_arc, abs=1e-6)
    assert 20 < interval.end_arc - interval.start_arc < 22.4  # a strip recedes 1.008 heights beyond the load at most
    assert result.certificate.kind in (CertificateKind.LOCAL, CertificateKind.UNIQUE)
    assert not result.certificate.violation


def on_three_rods(edges: dict[str, list[str]], pressure: float) -> Problem:
    """A beam on three rods, the middle one a little lower; each third of its underside is an edge."""
    names = {"left": (0, 0), "middle": (4, 0), "right": (8, 0)}
    sides = {"end": (12, 0), "top": (12, 2), "start": (0, 2)}
    return Problem(
        name="beam on three rods",
        material={"young_modulus": 1e3, "poisson_ratio": 0.3},
        boundary={
            "outer": [
                {"name": name, "start": at, "elements": 24 if name in names else 8}
                for name, at in {**names, **sides}.items()
            ]
        },
        conditions={"top": {"pressure": pressure}},
        contact_zones={
            name: {
                "edges": edges[name],
                "surface": {"kind": "circle", "center": (x, -2 - low), "radius": 2, "body": "outside"},
            }
            for name, x, low in (("left", 2, 0), ("middle", 6, 0.01), ("right", 10, 0))
        },
        accuracy=None,
    )


@pytest.mark.parametrize("pressure", [2.0, 10.0])
def test_three_surfaces_at_each_node_are_no_obstacle_where_contact_holds_the_body(pressure: float):
    """Pressures on three surfaces at one node can cancel: the compliance is singular. The state is that of one each."""
    names = ["left", "middle", "right"]
    one = solve(on_three_rods({name: [name] for name in names}, pressure))
    three = solve(on_three_rods(dict.fromkeys(names, names), pressure))
    assert one.certified
    assert three.certified
    assert three.certificate.smallest_eigenvalue == pytest.approx(0.0, abs=1e-9)
    assert three.certificate.heading == "unique within the error bound"
    assert "any exact solution" in three.certificate.words
    assert three.footprint.peak.pressure == pytest.approx(one.footprint.peak.pressure, rel=1e-9)


def held_with_two_normals_at_each_node(rng: np.random.Generator) -> CondensedContact:
    """Three nodes of a held body, each opposite to two surfaces whose normals may be nearly the same."""
    A = rng.standard_normal((6, 6))
    angle = rng.uniform(-0.5, 0.5, (3, 1)) + np.hstack([np.zeros((3, 1)), rng.choice([1e-7, 0.3], (3, 1))])
    normals = np.stack([np.sin(angle), np.cos(angle)], axis=-1)
    rows = np.zeros((6, 6))
    for node, surface in product(range(3), range(2)):
        rows[2 * node + surface, 2 * node : 2 * node + 2] = normals[node, surface]
    q = rng.standard_normal((3, 1)) + np.hstack([np.zeros((3, 1)), rng.choice([1e-3, 0.5, 3.0], (3, 1))])
    return CondensedContact.from_compliance(rows @ (A @ A.T + 0.1 * np.eye(6)) @ rows.T, q.ravel())


@pytest.mark.slow
def test_two_surfaces_at_each_node_of_a_held_body():
    """The pressure of one state is not certified if another has the same node pressed by the other surface.

    The gaps of the two differ: without them pressures could be shared in any way.
    """
    rng = np.random.default_rng(8)
    certified = singular = 0
    for _ in range(75):
        contact = held_with_two_normals_at_each_node(rng)
        solution = complementarity.solve(contact)
        certificate = certificate_of(contact, solution)
        states = all_states(contact)
        if not certificate.certified:
            continue
        certified += 1
        singular += np.linalg.eigvalsh(contact.compliance)[0] < 1e-12
        assert certificate.error_bound is not None
        assert all(abs(solution.pressure - state).max() <= certificate.error_bound + 1e-9 for state in states)
    assert certified > 30
    assert singular > 20


@pytest.mark.slow
def test_three_rods_under_one_edge_are_certified():
    """Each node of the edge is a point of all three rods, and most of these points no state can press on."""
    rods = {
        f"rod {i}": {
            "edges": "bottom",
            "surface": {"kind": "circle", "center": [x, -4 - gap], "radius": 4, "body": "outside"},
        }
        for i, (x, gap) in enumerate([(10, 0.0), (52, 0.01), (90, 0.0)])
    }
    corners = [("bottom", (0, 0)), ("right", (100, 0)), ("top", (100, 10)), ("left", (0, 10))]
    problem = Problem(
        name="beam", accuracy=0.03, material={"young_modulus": 210e3, "poisson_ratio": 0.3},
        boundary={"outer": [{"name": name, "start": start} for name, start in corners]},
        conditions={"left": {"displacement": {"x": 0}}, "top": {"pressure": 6}}, contact_zones=rods,
    )  # fmt: skip  # pyright: ignore[reportArgumentType]
    result = solve(problem)
    assert (result.certificate.smallest_eigenvalue or 0.0) < 0
    assert result.certified
    assert result.holds
