"""Formulations side by side: what is said of them, where it is known what is right."""

import dataclasses
import json

import numpy as np
import pytest
from contact_problems import random_contact

from bemcontact.analysis import compare as comparing
from bemcontact.assessment.comparison import Comparison, comparison
from bemcontact.assessment.contender import Attempt, Outcome
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import Status
from bemcontact.formulations import complementarity, qp1
from bemcontact.options import FormulationName, SolveOptions


def compared(contact: CondensedContact, *attempts: Attempt) -> Comparison:
    direct = Attempt(
        options=SolveOptions(formulation=FormulationName.COMPLEMENTARITY),
        label="direct",
        solution=complementarity.solve(contact),
    )
    return comparison(contact, direct, attempts)


def of_qp1(contact: CondensedContact) -> Attempt:
    options = SolveOptions(formulation=FormulationName.QP1)
    return Attempt(options=options, label=options.label(), solution=qp1.solve(contact))


def test_those_that_agree_are_certified_together():
    result = comparing.compare(random_contact(2, 8, 1))
    assert result.certified
    assert [item.label for item in result.everyone] == ["QP1", "QP2", "QP3", "direct"]
    assert result.agreement is not None
    assert result.agreement < 1e-12
    assert all(abs(item.objective or 0.0) < 1e-12 for item in result.contenders)
    assert result.reference.objective is None
    assert len(result.differences) == 6
    assert [item.other for item in result.differences[:3]] == ["direct"] * 3
    assert "QP1, QP2 and QP3 agree with the direct solution" in result.verdict


def test_a_spurious_local_minimum_is_not_the_solution():
    """M = [[1, 2], [1, 1]] has determinant -1, q = (-1, -2). The contact state is p = (0, 2), with gaps (3, 0).

    Along p₁ + p₂ = 2, where the second gap is closed, pᵀδ = p₁(3 - p₁): zero at p₁ = 0, 2 at p₁ = 2, and more between;
    beyond (2, 0) it is p₁² - p₁. So p = (2, 0) with pᵀδ = 2 is a local minimum; U T = 2 · 2/3.
    """
    result = comparing.compare(CondensedContact.from_compliance([[1.0, 2.0], [1.0, 1.0]], [-1.0, -2.0]), ["qp1"])
    (spurious,) = result.contenders
    assert spurious.assessment is not None
    assert spurious.assessment.solution.pressure == pytest.approx([2.0, 0.0])
    assert spurious.assessment.solution.status is Status.LOCAL_MINIMUM
    assert spurious.objective == pytest.approx(2 / (2 * 2 / 3))
    assert spurious.verdict.outcome is Outcome.NOT_THE_SOLUTION
    assert (
        "stationary but not the solution: objective 1.50e+00, above the 0 of the contact state"
        in spurious.verdict.words
    )
    assert result.reference.verdict.outcome is Outcome.SOLVES_PERHAPS_NOT_ALONE
    assert result.reference.assessment is not None
    assert result.reference.assessment.solution.pressure == pytest.approx([0.0, 2.0])
    assert not result.certified
    assert "not the solution: QP1" in result.verdict


def test_two_contact_states_are_reported():
    """M = [[1, 2], [2, 1]], q = (-1, -1): p = (1, 0) and p = (0, 1) both leave gaps (0, 1) and (1, 0)."""
    contact = CondensedContact.from_compliance([[1.0, 2.0], [2.0, 1.0]], [-1.0, -1.0])
    direct = complementarity.solve(contact)
    mirrored = dataclasses.replace(direct, pressure=np.array([1.0, 0.0]), displacement=np.array([1.0, 2.0]))
    other = dataclasses.replace(direct, pressure=np.array([0.0, 1.0]), displacement=np.array([2.0, 1.0]))
    options = SolveOptions(formulation=FormulationName.QP1)
    result = comparison(
        contact,
        Attempt(options=SolveOptions(formulation=FormulationName.COMPLEMENTARITY), label="direct", solution=mirrored),
        [Attempt(options=options, label=options.label(), solution=other)],
    )
    assert "QP1 and direct meet all conditions, but differ by 1.0e+00 of the largest pressure" in result.verdict
    assert result.contenders[0].verdict.outcome is Outcome.SOLVES_PERHAPS_NOT_ALONE
    assert not result.certified


def test_nothing_is_believed_from_a_solver():
    """A pressure one thousandth too high is refused, although its solver calls it solved."""
    contact = random_contact(2, 8, 0)
    right = of_qp1(contact)
    assert right.solution is not None
    wrong = dataclasses.replace(
        right, solution=dataclasses.replace(right.solution, pressure=1.001 * right.solution.pressure)
    )
    result = compared(contact, wrong)
    assert result.contenders[0].verdict.outcome is Outcome.NOT_THE_SOLUTION
    assert result.difference("QP1").largest == pytest.approx(0.001, rel=1e-6)  # pyright: ignore
    assert result.difference("QP1").mean_square == pytest.approx(0.001, rel=1e-6)  # pyright: ignore
    assert result.difference("direct") is None


def test_a_refusal_is_reported_with_its_reason():
    """sym(M) has the eigenvalue -1: QP3 is not convex and says so; the weights are not to blame."""
    result = comparing.compare(CondensedContact.from_compliance([[1.0, 2.0], [2.0, 1.0]], [-1.0, -1.0]), ["qp3"])
    (refused,) = result.contenders
    assert refused.assessment is None
    assert refused.verdict.outcome is Outcome.REFUSED
    assert "not convex" in refused.verdict.words
    assert refused.verdict.reason == ""
    assert result.agreement is None
    assert not result.certified
    assert "refused: QP3" in result.verdict


def test_random_starts_are_counted():
    result = comparing.compare(random_contact(2, 6, 1), ["qp1", "qp3"], starts=7, seed=3)
    first, last = result.contenders
    assert first.attempt.starts is not None
    assert (first.attempt.starts.count, first.attempt.starts.seed, first.attempt.starts.solved) == (7, 3, 7)
    assert last.attempt.starts is None


def test_json_is_finite_and_holds_the_answers():
    result = comparing.compare(random_contact(2, 6, 1), penalties=[1e-3, 1e3])
    data = json.loads(result.to_json())
    assert [item["label"] for item in data["contenders"]] == ["QP1", "QP2 (μ = 0.001)", "QP2 (μ = 1000)", "QP3"]
    assert data["contenders"][0]["answer"]["pressure"] == result.contenders[0].assessment.solution.pressure.tolist()  # pyright: ignore
    assert data["matrices"]["condition"] > 1
    assert [item["penalty"] for item in data["contenders"][0]["answer"]["objectives"][0]["qp2"]] == [1e-3, 1e3]


def test_the_table_of_a_notebook_escapes_names():
    contact = dataclasses.replace(random_contact(2, 6, 0), name="<b>bold</b>")
    html = comparing.compare(contact, ["qp1"])._repr_html_()
    assert "&lt;b&gt;bold" in html
    assert "<b>" not in html
    assert html.count("<tr>") == 3  # head, QP1, direct


def test_no_contact_at_all_is_an_answer():
    """All gaps open without pressure: p = 0 is the contact state; differences are over T, as there is no peak."""
    result = comparing.compare(CondensedContact.from_compliance(np.eye(3), np.ones(3)))
    assert result.certified
    assert result.agreement == 0.0


def test_a_direct_solver_that_fails_is_no_contact_state_to_compare_with():
    """Its point is no reference: M p + q = 0 at p = (1/3, 4/3, 2/3) solves the problem, and QP1 finds that."""
    M, q = [[0.0, 0.0, 3.0], [-2.0, -1.0, 3.0], [-2.0, 3.0, -2.0]], [-2.0, 0.0, -2.0]
    result = comparing.compare(CondensedContact.from_compliance(M, q), ["qp1"])
    assert result.reference.verdict.outcome is Outcome.NOT_THE_SOLUTION
    assert result.contenders[0].assessment.solution.pressure == pytest.approx([1 / 3, 4 / 3, 2 / 3])  # pyright: ignore
    assert result.verdict.startswith("the direct solver found no contact state, but QP1 did")
    assert "contact state" not in result.contenders[0].verdict.words
    assert result.difference("QP1") is None
    assert result.agreement is None


def test_round_off_leaves_nearly_singular_problems_open():
    """M = a aᵀ + 3e-14 I: along aᵀv = 0 pressures change by 1e-2, and gaps by 3e-16, which is their last digit."""
    a = np.array([1.0, 1.3, 0.7, 0.3])
    M = np.outer(a, a) + 3e-14 * np.eye(4)
    contact = CondensedContact.from_compliance(M, -M @ np.array([0.3, 0.4, 0.5, 0.6]))
    result = comparing.compare(contact, ["qp1"])
    assert result.reference.verdict.outcome is Outcome.LEFT_OPEN
    assert "round-off leaves open" in result.verdict
    assert not result.certified


def test_a_pressure_of_round_off_is_no_peak():
    """A free body without load that touches nowhere: p = 0 up to 1e-18, which differs from 0 by nothing of T."""
    M = [[2.8, 0.8, -0.3], [0.8, 1.6, -1.0], [-0.3, -1.0, 1.7]]
    motions = {"rigid_motions": [1.0, 1.0, 1.0], "motion_load": [0.0]}
    result = comparing.compare(CondensedContact.from_compliance(M, [-0.2, -0.2, 2.1], **motions))
    assert result.certified
    assert result.agreement < 1e-12  # pyright: ignore


def test_numbers_of_numpy_are_numbers():
    result = comparing.compare(random_contact(1, 5, 0), ["qp2"], penalties=[np.float32(0.5)], starts=np.int64(2))
    json.loads(result.to_json())


def test_labels_distinguish_penalties():
    result = comparing.compare(random_contact(1, 5, 0), ["qp2"], penalties=[1.0, 0.001, 0.0010000001])
    assert [item.label for item in result.contenders] == ["QP2 (μ = 1)", "QP2 (μ = 0.001)", "QP2 (μ = 0.0010000001)"]
    assert len(result.differences) == 6
