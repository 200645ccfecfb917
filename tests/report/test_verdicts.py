"""Verdicts on the equations and on the mesh: what is written never states more than what is known."""

from dataclasses import replace

import pytest
from accuracies import accuracy, bar
from markupsafe import escape
from mesh_studies import block

import bemcontact
from bemcontact.analysis.compare import mesh_study
from bemcontact.assessment.accuracy import Accuracy
from bemcontact.assessment.penetration import Misfit, Penetration
from bemcontact.options import ComparisonOptions
from bemcontact.report.bars import mesh_in_short
from bemcontact.report.page import render
from bemcontact.report.path_text import path_verdicts
from bemcontact.report.verdicts import (
    in_short,
    mesh_study_verdicts,
    mesh_verdict,
    overall,
    result_verdicts,
    shortfall,
)


def test_mesh_that_meets_the_accuracy():
    verdict = mesh_verdict(accuracy(bar("peak", 183.3, 0.0041), bar("force", 405.0, 1e-4)))
    assert (verdict.of, verdict.quality) == ("Mesh", "good")
    assert verdict.word == "error at most 0.41 % (asked 1 %)"
    assert "peak pressure of foot" in verdict.words


def test_mesh_that_does_not_meet_the_accuracy():
    met = accuracy(bar("peak", 183.3, 0.3), reason="a finer mesh would have more than 4000 unknowns")
    assert mesh_verdict(met).word == "not met, error about 30 % (asked 1 %)"
    assert mesh_verdict(met).quality == "fair"
    assert "More than 4000".lower() in mesh_verdict(met).words
    unknown = mesh_verdict(accuracy(bar("start", 2.0, None, note="the number of intervals changes", interval=0)))
    assert unknown.word == "not met, error not known (asked 1 %)"
    assert "number of intervals changes" in unknown.words


def test_mesh_that_was_not_assessed_is_never_good():
    """Neither if no accuracy is asked for, nor if errors could not be estimated."""
    for asked in (None, 0.01):
        verdict = mesh_verdict(Accuracy(asked=asked, reason="no errors are estimated").to_dict())
        assert (verdict.quality, verdict.word) == ("fair", "not assessed")
        assert mesh_in_short(Accuracy(asked=asked, reason="x").to_dict()) == "not assessed"


def test_an_answer_is_good_only_if_both_verdicts_are():
    good = mesh_verdict(accuracy(bar("peak", 1.0, 0.001)))
    fair, bad = (
        good._replace(quality="fair", word="not met"),
        good._replace(quality="bad", word="not solved", of="Equations"),
    )
    qualities = [overall(pair) for pair in ((good, good), (good, fair), (fair, fair), (bad, good), (bad, fair))]
    assert qualities == ["good", "fair", "fair", "bad", "bad"]
    assert in_short((bad, fair)) == "equations: not solved; mesh: not met"


def test_results_outside_linear_theory_have_the_same_verdict_everywhere():
    """Terminal, page, picture, JSON, exit status and repr: the equations are solved, and the reason is the verdict."""
    soft = bemcontact.solve(block(material={"young_modulus": 5.0, "poisson_ratio": 0.3}))
    compared = mesh_study(ComparisonOptions.of("qp3"), soft.problem or soft.contact, (1,))
    assert soft.penetration is not None
    reason, word = soft.penetration.words, "outside linear theory"
    page = render(compared.to_dict(), {}, None)
    for verdicts in (result_verdicts(soft), mesh_study_verdicts(compared.to_dict())):
        assert (verdicts[0].quality, verdicts[0].word, overall(verdicts)) == ("fair", word, "fair")
        assert verdicts[0].words.startswith(reason)
    assert (soft.holds, compared.holds, soft.to_dict()["certified"]) == (False, False, False)
    assert soft.to_dict()["penetration"]["kind"] == compared.to_dict()["heading"] == word
    assert shortfall(soft).startswith(f"Equations: {word}. {reason}")
    assert word in repr(soft)
    assert soft.words.startswith(reason)
    assert 'class="verdict fair"' in page
    assert str(escape(reason)) in page


@pytest.mark.parametrize(("start", "to", "reached"), [(3.0, -2.0, (True, False)), (-2.0, 3.0, (False, True))])
def test_of_an_end_that_a_path_does_not_reach_no_mesh_is_judged(start: float, to: float, reached: tuple[bool, bool]):
    """Suction lifts the block: the path ends at zero, and nothing is said of the mesh beyond."""
    path = bemcontact.follow(block(), "conditions.top.pressure", start=start, to=to)
    equations, *meshes = path_verdicts(path)
    assert equations.quality == "bad"
    assert [mesh.word != "not reached" for mesh in meshes] == [*reached]
    (beyond,) = (mesh for mesh in meshes if mesh.word == "not reached")
    assert beyond.quality == "fair"
    assert "The path ends at 0, where errors were not estimated" in beyond.words
    assert "at most" not in beyond.words


@pytest.mark.parametrize(
    ("kind", "at", "led"),
    [(Misfit.OFF, 1.0, True), (Misfit.MOVED, 1.0, True), (Misfit.MOVED, 3.0, False), (Misfit.PENETRATION, 1.0, False)],
)
def test_a_path_whose_body_moves_far_up_to_its_end_leads_to_a_study(kind: Misfit, at: float, led: bool):
    """A path has the gaps of its end, so that states before it may be wrong where the body moves far."""
    path = bemcontact.follow(block(), "conditions.top.pressure", start=1.0, to=3.0)
    misfit = Penetration(
        kind=kind, depth=1.0, allowed=0.0, at=(0.0, 0.0), edge="under", zone="foot", paired=True, words="Off."
    )
    equations, *_ = path_verdicts(replace(path, penetration=misfit, penetrates_at=at))
    assert equations.words.startswith(f"Off. This is at conditions.top.pressure = {at:g}.")
    assert ("a study has those of each value" in equations.words) is led
