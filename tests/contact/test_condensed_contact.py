"""The condensed problem: its file, its gauge, its stiffness rows, and its errors."""

from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest
from contact_problems import in_units, random_contact

import bemcontact
from bemcontact.contact.condensed_contact import CondensedContact, computed_contact
from bemcontact.contact.free_motions import MotionAlgebra, fix_gauge
from bemcontact.contact.load_cases import LoadCases, Pinned, Tools
from bemcontact.errors import ProblemError, SingularSystemError
from bemcontact.formulations import complementarity
from bemcontact.formulations.starts import Start
from bemcontact.options import Weights


def beam(n: int) -> CondensedContact:
    """Clamped Euler beam of unit length and stiffness, [SS92] problem 5 in shape: cond M is 6e5 at n = 20."""
    x = np.linspace(1 / n, 1, n)
    near, far = np.minimum.outer(x, x), np.maximum.outer(x, x)
    weights = np.full(n, 1 / n)
    return CondensedContact.from_compliance(near**2 * (3 * far - near) / 6 * weights, 0.1 - x**2, weights)


def test_every_field_is_read_back_from_a_file(tmp_path):
    def compare(before, after):
        assert type(after) is type(before)
        if isinstance(before, np.ndarray):
            assert before.dtype == after.dtype
            np.testing.assert_array_equal(after, before)
        elif is_dataclass(before):
            for item in fields(before):
                compare(getattr(before, item.name), getattr(after, item.name))
        else:
            assert after == before

    problem = random_contact(0, 12, 2)
    problem.save(tmp_path / "problem.npz")
    compare(problem, CondensedContact.load(tmp_path / "problem.npz"))


def test_failed_save_leaves_no_file(tmp_path, monkeypatch):
    def full_disk(*_, **__):
        raise OSError("no space left")

    monkeypatch.setattr(np, "savez", full_disk)
    with pytest.raises(OSError, match="no space left"):
        random_contact(0, 12, 2).save(tmp_path / "problem.npz")
    assert not list(tmp_path.iterdir())


def test_load_refuses_other_files(tmp_path):
    (tmp_path / "text.npz").write_text("not an archive")
    with pytest.raises(ProblemError, match=r"text\.npz: not an \.npz file"):
        CondensedContact.load(tmp_path / "text.npz")
    np.savez(tmp_path / "other.npz", x=np.ones(3))
    with pytest.raises(ProblemError, match="not a condensed contact problem of format"):
        CondensedContact.load(tmp_path / "other.npz")
    np.savez(tmp_path / "old.npz", format=np.array("bemcontact.condensed.4"))
    with pytest.raises(ProblemError, match=r"of format \S+, but of format 'bemcontact.condensed.4'; condense"):
        CondensedContact.load(tmp_path / "old.npz")


def test_arrays_are_read_only():
    with pytest.raises(ValueError, match="read-only"):
        random_contact(0, 12, 2).compliance[0, 0] = 1.0


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"initial_gap": np.ones(3)}, r"initial_gap has shape \(3,\) where \(12,\) is needed"),
        ({"initial_gap": np.full(12, np.nan)}, "initial_gap has entries that are not finite"),
        ({"motion_arms": np.zeros(2)}, "motion_arms must be positive, and infinite for a translation"),
        ({"motion_arms": np.ones(3)}, r"motion_arms has shape \(3,\) where \(2,\) is needed"),
        ({"weights": np.zeros(12)}, "weights must be positive; the smallest is 0"),
        ({"zone_weights": np.zeros((1, 12))}, "the magnitudes of zone_weights must add up to the weights"),
    ],
)
def test_arrays_that_state_no_problem_are_refused(changes, text):
    with pytest.raises(ProblemError, match=text):
        replace(random_contact(0, 12, 2), **changes)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"compliance": np.full((12, 12), np.nan)}, "compliance has entries that are not finite"),
        ({"motion_load": np.array([1e200, 0.0])}, "motion_load has entries that are too large to compute with"),
        ({"rigid_motions": np.ones((12, 2))}, "rigid_motions needs independent columns"),
        ({"rigid_motions": np.ones((0, 2))}, "a contact problem needs at least one contact point"),
    ],
)
def test_numbers_that_a_body_may_be_the_reason_of_are_refused(changes, text):
    stated = {item.name: getattr(random_contact(0, 12, 2), item.name) for item in fields(CondensedContact)}
    assert not computed_contact(**stated | {"weights": np.ones(12)}).weights.flags.writeable
    with pytest.raises(ProblemError, match=text):
        computed_contact(**stated | changes)


HIDDEN, PLAIN = "a\x1b[31m", CondensedContact.from_compliance([[1.0]], [-1.0])


@pytest.mark.parametrize(
    "made",
    [
        lambda: CondensedContact.from_compliance([[1.0]], [-1.0], name=HIDDEN),
        lambda: CondensedContact.from_compliance([[1.0]], [-1.0], name="two\nlines"),
        lambda: CondensedContact.from_compliance([[1.0]], [-1.0], name="a" * 1001),
        lambda: replace(PLAIN, zone_names=(HIDDEN,)),
        lambda: replace(PLAIN, units={"length": HIDDEN}),
        lambda: replace(PLAIN, notes=(HIDDEN,)),
        lambda: replace(PLAIN, tools=replace(Tools.none(1, 0), names=(HIDDEN,))),
        lambda: replace(PLAIN, cases=replace(LoadCases.none(1, 0, 0), names=(HIDDEN,))),
        lambda: replace(PLAIN, pinned=replace(Pinned.none(0, 0), motions=(HIDDEN,))),
        lambda: Start(pressure=[0.0], displacement=[0.0], label=HIDDEN),
    ],
)
def test_names_follow_the_rule_of_specs(made):
    """No hidden characters, and one line of at most 1000 characters, but for notes, which are longer texts."""
    with pytest.raises(ProblemError, match=r"U\+00(1B|0A); remove it|at most 1000 characters, found 1001"):
        made()


def test_missing_weights_are_refused():
    with pytest.raises(ProblemError, match="no consistent weights"):
        random_contact(0, 12, 2).weight_matrix(Weights.CONSISTENT)


@pytest.mark.parametrize("k", [1, 2, 3])
def test_gauge_identities(k):
    """P is a projector with P R = 0 and ℓᵀP = 0, so that M'R = 0, ℓᵀM' = 0, ℓᵀΔ1' = 0, and M'p0 = 0."""
    problem = random_contact(1, 12, k)
    M, R, ell = problem.compliance, problem.rigid_motions, problem.equilibrium
    np.testing.assert_allclose(M @ R, 0, atol=1e-13)
    np.testing.assert_allclose(ell.T @ M, 0, atol=1e-13)
    np.testing.assert_allclose(ell.T @ problem.free_displacement, 0, atol=1e-13)
    np.testing.assert_allclose(M @ problem.balancing_pressure, 0, atol=1e-13)
    np.testing.assert_allclose(ell.T @ problem.balancing_pressure, -problem.motion_load, atol=1e-13)


def test_gauge_keeps_the_displacement_of_every_balanced_pressure():
    """Δ1 + M p + R a is the same before and after, with the stated shift of the amplitudes."""
    rng = np.random.default_rng(2)
    n, k = 9, 2
    M, R, J = rng.standard_normal((n, n)), rng.standard_normal((n, k)), rng.uniform(0.5, 1, n)
    free, load, a = rng.standard_normal(n), rng.standard_normal(k), rng.standard_normal(k)
    gauge = fix_gauge(MotionAlgebra(rigid_motions=R, weights=J, motion_load=load), M, free)
    ell = J[:, None] * R
    p = rng.standard_normal(n)
    p -= R @ np.linalg.solve(ell.T @ R, ell.T @ p + load)
    before = free + M @ p + R @ (a - gauge.shift_load - gauge.shift_pressure @ p)
    np.testing.assert_allclose(gauge.free_displacement + gauge.compliance @ p + R @ a, before, atol=1e-12)


def test_gauge_does_not_depend_on_the_support():
    """M + R Xᵀ + Y ℓᵀ with Δ1 + R b + Y load has the same gap for every balanced p, so the fixed gauge is the same."""
    rng = np.random.default_rng(3)
    n, k = 9, 3
    M, R, J = rng.standard_normal((n, n)), rng.standard_normal((n, k)), rng.uniform(0.5, 1, n)
    X, Y = rng.standard_normal((2, n, k))
    free, load, b = rng.standard_normal(n), rng.standard_normal(k), rng.standard_normal(k)
    ell = J[:, None] * R
    motions = MotionAlgebra(rigid_motions=R, weights=J, motion_load=load)
    one = fix_gauge(motions, M, free)
    other = fix_gauge(motions, M + R @ X.T + Y @ ell.T, free + R @ b + Y @ load)
    np.testing.assert_allclose(other.compliance, one.compliance, atol=1e-12)
    np.testing.assert_allclose(other.free_displacement, one.free_displacement, atol=1e-12)


@pytest.mark.parametrize("k", [1, 2, 3])
def test_solution_does_not_depend_on_the_gauge(k):
    """A problem with another bordering has the same pressure and the same gap."""
    rng = np.random.default_rng(4)
    problem = random_contact(5, 12, k)
    R, ell = problem.rigid_motions, problem.equilibrium
    X, Y = rng.standard_normal((2, problem.size, k))
    other = CondensedContact.from_compliance(
        problem.compliance + R @ X.T + Y @ ell.T,
        problem.offset + R @ rng.standard_normal(k) + Y @ problem.motion_load,
        problem.weights,
        rigid_motions=R,
        motion_load=problem.motion_load,
    )
    one, two = complementarity.solve(problem), complementarity.solve(other)
    np.testing.assert_allclose(two.pressure, one.pressure, atol=1e-11)
    np.testing.assert_allclose(
        other.gap(two.pressure, two.rigid_amplitudes), problem.gap(one.pressure, one.rigid_amplitudes), atol=1e-11
    )


@pytest.mark.parametrize("k", [0, 1, 2, 3])
def test_stiffness_rows_return_the_pressure(k):
    """K u_n - r = S(u_n - Δ1) - V load = p for u_n = Δ1 + M p + R a and any p in equilibrium, (12)."""
    rng = np.random.default_rng(6)
    problem = random_contact(7, 12, k)
    R, ell = problem.rigid_motions, problem.equilibrium
    p, a = rng.standard_normal(problem.size), rng.standard_normal(k)
    p -= R @ np.linalg.solve(ell.T @ R, ell.T @ p + problem.motion_load)
    K, B, r = problem.stiffness_rows
    u_n = problem.free_displacement + problem.compliance @ p + R @ a
    np.testing.assert_allclose(K @ u_n - r, B @ p, atol=1e-10)


@pytest.mark.parametrize("k", [1, 2, 3])
def test_stiffness_rows_contain_equilibrium(k):
    """ℓᵀS = 0 and ℓᵀV = I, so that ℓᵀ(K u_n - p - r) = -load - ℓᵀp whatever u_n is."""
    rng = np.random.default_rng(8)
    problem = random_contact(9, 12, k)
    p, u_n = rng.standard_normal((2, problem.size))
    K, B, r = problem.stiffness_rows
    ell = problem.equilibrium
    np.testing.assert_allclose(ell.T @ (K @ u_n - B @ p - r), -problem.motion_load - ell.T @ p, atol=1e-10)


def test_stiffness_rows_of_a_slender_beam():
    """K must be accurate as a left inverse of M, |K M - I| of the size n eps cond: K M p is compared with p."""
    problem = beam(20)
    M = problem.compliance
    error = np.abs(problem.stiffness_rows.K @ M - np.eye(problem.size)).sum(axis=1).max()
    assert error <= problem.size * np.finfo(float).eps * np.linalg.cond(M)


@pytest.mark.parametrize(("length", "stress"), [(1e-3, 1e6), (1e3, 1e-6)])
def test_scales_follow_the_units(length, stress):
    """U is a length and T a pressure: they change with the units exactly as the data do."""
    problem = random_contact(10, 12, 2)
    other = in_units(problem, length, stress)
    assert other.scales.displacement == pytest.approx(problem.scales.displacement * length, rel=1e-12)
    assert other.scales.pressure == pytest.approx(problem.scales.pressure * stress, rel=1e-12)


def test_problem_of_zeros_has_scales():
    """Zero gap and zero compliance cause no division by zero."""
    assert CondensedContact.from_compliance(np.zeros((2, 2)), np.zeros(2)).scales == (1.0, 1.0)


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ({"compliance": np.eye(3), "offset": [1, 2]}, "compliance needs"),
        ({"compliance": np.eye(2), "offset": [1, 2], "weights": [1]}, "weights"),
        (
            {"compliance": np.eye(2), "offset": [1, 2], "rigid_motions": [[1], [1]], "motion_load": [1, 2]},
            "motion_load",
        ),
        ({"compliance": np.eye(2), "offset": [1, 2], "rigid_motions": [[0], [0]], "motion_load": [1]}, "independent"),
        ({"compliance": np.eye(2), "offset": [1, 2], "weights": [1, -1]}, "positive"),
        ({"compliance": np.eye(2), "offset": [1, np.nan]}, "finite"),
    ],
)
def test_numbers_that_state_no_problem_are_refused(numbers, words):
    with pytest.raises(ProblemError, match=words):
        CondensedContact.from_compliance(**numbers)


@pytest.mark.parametrize("compliance", [[[1.0, 1.0], [1.0, 1.0]], [[0.0, 0.0], [0.0, 0.0]]])
def test_a_singular_compliance_is_an_error_in_words(compliance: list):
    contact = CondensedContact.from_compliance(compliance, [-1.0, -1.0])
    for ask in (bemcontact.solve, bemcontact.compare):
        with pytest.raises(SingularSystemError, match="the compliance is singular"):
            ask(contact)
