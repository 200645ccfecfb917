"""Formulations side by side: what is said of them, where it is known what is right."""

import dataclasses
import json

import numpy as np
import pytest
from contact_problems import random_contact

from bemcontact import comparing
from bemcontact.assessment.comparison import Comparison, comparison
from bemcontact.assessment.contender import Found
from bemcontact.assessment.verdict import Outcome
from bemcontact.choices import FormulationName, Setting, Weights
from bemcontact.contact import CondensedContact
from bemcontact.formulations import complementarity, qp1
from bemcontact.solution import Status


def compared(contact: CondensedContact, *found: Found) -> Comparison:
    direct = Found(
        setting=Setting(formulation=FormulationName.COMPLEMENTARITY), solution=complementarity.solve(contact)
    )
    return comparison(contact, direct, found)


def of_qp1(contact: CondensedContact) -> Found:
    setting = Setting(formulation=FormulationName.QP1, weights=Weights.TRIBUTARY)
    return Found(setting=setting, solution=qp1.solve(contact))


def test_those_that_agree_are_certified_together():
    found = comparing.compare(random_contact(2, 8, 1))
    assert found.certified
    assert [item.label for item in found.everyone] == ["QP1", "QP2", "QP3", "direct"]
    assert found.agreement is not None
    assert found.agreement < 1e-12
    assert all(abs(item.objective or 0.0) < 1e-12 for item in found.contenders)
    assert found.reference.objective is None
    assert len(found.differences) == 6
    assert [item.other for item in found.differences[:3]] == ["direct"] * 3
    assert "QP1, QP2 and QP3 agree with the direct solution" in found.verdict


def test_a_spurious_local_minimum_is_not_the_solution():
    """M = [[1, 2], [1, 1]] has determinant -1, q = (-1, -2). The contact state is p = (0, 2), with gaps (3, 0).

    Along p₁ + p₂ = 2, where the second gap is closed, pᵀδ = p₁(3 - p₁): zero at p₁ = 0, 2 at p₁ = 2, and more between;
    beyond (2, 0) it is p₁² - p₁. So p = (2, 0) with pᵀδ = 2 is a local minimum; U T = 2 · 2/3.
    """
    found = comparing.compare(CondensedContact.from_compliance([[1.0, 2.0], [1.0, 1.0]], [-1.0, -2.0]), ["qp1"])
    (spurious,) = found.contenders
    assert spurious.judged is not None
    assert spurious.judged.solution.pressure == pytest.approx([2.0, 0.0])
    assert spurious.judged.solution.status is Status.LOCAL_MINIMUM
    assert spurious.objective == pytest.approx(2 / (2 * 2 / 3))
    assert spurious.verdict.outcome is Outcome.NOT_THE_SOLUTION
    assert "stationary but not the solution: objective 1.50e+00, above the 0" in spurious.verdict.words
    assert found.reference.verdict.outcome is Outcome.SOLVES_PERHAPS_NOT_ALONE
    assert found.reference.judged is not None
    assert found.reference.judged.solution.pressure == pytest.approx([0.0, 2.0])
    assert not found.certified
    assert "not the solution: QP1" in found.verdict


def test_two_contact_states_are_told():
    """M = [[1, 2], [2, 1]], q = (-1, -1): p = (1, 0) and p = (0, 1) both leave gaps (0, 1) and (1, 0)."""
    contact = CondensedContact.from_compliance([[1.0, 2.0], [2.0, 1.0]], [-1.0, -1.0])
    direct = complementarity.solve(contact)
    mirrored = dataclasses.replace(direct, pressure=np.array([1.0, 0.0]), displacement=np.array([1.0, 2.0]))
    other = dataclasses.replace(direct, pressure=np.array([0.0, 1.0]), displacement=np.array([2.0, 1.0]))
    setting = Setting(formulation=FormulationName.QP1, weights=Weights.TRIBUTARY)
    found = comparison(
        contact,
        Found(setting=Setting(formulation=FormulationName.COMPLEMENTARITY), solution=mirrored),
        [Found(setting=setting, solution=other)],
    )
    assert "there is more than one contact state: QP1 and direct differ by 1.0e+00 of the peak" in found.verdict
    assert found.contenders[0].verdict.outcome is Outcome.SOLVES_PERHAPS_NOT_ALONE
    assert not found.certified


def test_nothing_is_believed_from_a_solver():
    """A pressure one thousandth too high is refused, although its solver calls it solved."""
    contact = random_contact(2, 8, 0)
    right = of_qp1(contact)
    assert right.solution is not None
    wrong = dataclasses.replace(
        right, solution=dataclasses.replace(right.solution, pressure=1.001 * right.solution.pressure)
    )
    found = compared(contact, wrong)
    assert found.contenders[0].verdict.outcome is Outcome.NOT_THE_SOLUTION
    assert found.difference("QP1").largest == pytest.approx(0.001, rel=1e-6)  # pyright: ignore
    assert found.difference("QP1").mean_square == pytest.approx(0.001, rel=1e-6)  # pyright: ignore
    assert found.difference("direct") is None


def test_a_formulation_that_refuses_is_told_with_its_reason():
    """sym(M) has the eigenvalue -1: QP3 is not convex and says so; the weights are not to blame."""
    found = comparing.compare(CondensedContact.from_compliance([[1.0, 2.0], [2.0, 1.0]], [-1.0, -1.0]), ["qp3"])
    (refused,) = found.contenders
    assert refused.judged is None
    assert refused.verdict.outcome is Outcome.REFUSED
    assert "not convex" in refused.verdict.words
    assert refused.verdict.reason == ""
    assert found.agreement is None
    assert not found.certified
    assert "refused: QP3" in found.verdict


def test_random_starts_are_counted():
    found = comparing.compare(random_contact(2, 6, 1), ["qp1", "qp3"], starts=7, seed=3)
    first, last = found.contenders
    assert first.found.starts is not None
    assert (first.found.starts.count, first.found.starts.seed, first.found.starts.solved) == (7, 3, 7)
    assert last.found.starts is None


def test_json_is_finite_and_holds_the_answers():
    found = comparing.compare(random_contact(2, 6, 1), penalties=[1e-3, 1e3])
    data = json.loads(found.to_json())
    assert [item["label"] for item in data["contenders"]] == ["QP1", "QP2 (μ = 0.001)", "QP2 (μ = 1000)", "QP3"]
    assert data["contenders"][0]["answer"]["pressure"] == found.contenders[0].judged.solution.pressure.tolist()  # pyright: ignore
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
    found = comparing.compare(CondensedContact.from_compliance(np.eye(3), np.ones(3)))
    assert found.certified
    assert found.agreement == 0.0
