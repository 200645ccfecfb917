"""The page: its numbers are those of report.json, it needs nothing else, and a user's text stays text."""

import copy
import json
import re
from collections.abc import Callable
from typing import Any

import pytest
from mesh_studies import (
    ALL,
    block,
    not_unique,
    of_many_settings,
    on_a_coarse_mesh,
    on_one_mesh,
    on_three_meshes,
    with_infinite_peak,
    without_a_body,
)
from page_reader import ensure_self_contained, read
from tool_problems import BETWEEN, made

from bemcontact.analysis import compare as comparing
from bemcontact.analysis.mesh_study import MeshStudy
from bemcontact.options import ComparisonOptions
from bemcontact.report import formatting
from bemcontact.report.bars import with_bar
from bemcontact.report.figures import figures_of, vector_graphic
from bemcontact.report.figures.page import QUALITY_COLOURS
from bemcontact.report.page import render

SVG = b'<svg xmlns="http://www.w3.org/2000/svg"/>'


def report_of(study: MeshStudy) -> dict[str, Any]:
    """The report as another program reads it from the file."""
    return json.loads(study.to_json())


PICTURES = dict.fromkeys(("problem", "pressure", "gap", "deformed", "history-qp1", "history-qp2-consistent"), SVG)


@pytest.mark.parametrize("study", ALL, ids=lambda study: study.__name__)
def test_the_page_is_whole_and_needs_nothing_else(study: Callable[[], MeshStudy]):
    page = render(report_of(study()), PICTURES, "name: x")
    reader = read(page)
    ensure_self_contained(page, reader)
    pictures = [attrs for tag, attrs in reader.tags if tag == "img"]
    assert len(pictures) == len(PICTURES)
    assert all(picture["alt"] for picture in pictures)


def test_the_page_explains_its_words():
    """Each of them where it is used: in the note below its table."""
    page = render(report_of(on_three_meshes()), PICTURES, "name: x")
    for explained in ("The polish is one exact step", "weights are tributary: each contact point counts with"):
        assert explained in page
    assert ("The pressure as a whole is its root mean square" in page) is ("Pressure as a whole" in page)


def test_the_head_has_peak_contact_and_force():
    study = on_one_mesh()
    answer = study.levels[0].answer.footprint
    head = head_of(report_of(study))[1]
    (interval,) = answer.intervals
    for title, value in (("Contact", interval.length), ("Force on the body(0, ", answer.resultant.force[1])):
        shown = float(re.split(r"[ )]", head.partition(title)[2])[0])
        assert shown == pytest.approx(value, rel=1e-3)


def test_numbers_come_from_the_report_alone():
    """Another peak, difference and eigenvalue in the report are others on the page, and those of the study are gone."""
    report = report_of(on_three_meshes())
    (bar,) = (item for item in report["levels"][-1]["accuracy"]["bars"] if item["quantity"] == "peak")
    assert bar["value"] == report["levels"][-1]["comparison"]["reference"]["answer"]["peak"]["pressure"]
    peak = with_bar(bar["value"], bar["bar"])
    changed = copy.deepcopy(report)
    compared = changed["levels"][-1]["comparison"]
    compared["reference"]["answer"]["peak"]["pressure"] = 77.125
    changed["convergence"]["quantities"][0]["values"][-1] = 77.5
    for item in changed["levels"][-1]["accuracy"]["bars"]:
        if item["quantity"] == "peak":
            item.update(value=77.125, bar=1e-3)
    compared["agreement"] = 0.0125
    compared["matrices"]["condition"] = 4321e5
    before, after = read(render(report, {}, None)).text, read(render(changed, {}, None)).text
    assert peak in before
    assert peak not in after
    for told in ("77.12 ± 0.08", "77.5", "0.013 × the peak", "4.3e+08"):
        assert told not in before
        assert told in after


def test_a_text_of_the_user_stays_text():
    report = report_of(on_one_mesh())
    report["description"] = "<b>bold</b>\nsame paragraph\n\nnext & last"
    reader = read(render(report, {}, "name: </pre><script>alert(1)</script>"))
    assert "block <on> a table & more" in reader.text
    assert "<b>bold</b> same paragraph" in reader.text
    assert "</pre><script>alert(1)</script>" in reader.text
    assert not {"script", "b", "on"} & {tag for tag, _ in reader.tags}


def test_page_has_the_verdict_of_each_contender():
    report = report_of(of_many_settings())
    text = read(render(report, {}, None)).text
    for contender in report["levels"][-1]["comparison"]["contenders"]:
        assert contender["label"] in text
        assert contender["verdict"]["words"][1:] in text


def test_many_contenders_are_counted_at_the_head():
    """QP1 and QP3 with two weights, QP2 with two penalties too: eight, beside a certified direct solution."""
    report = report_of(of_many_settings())
    outcomes = [item["verdict"]["outcome"] for item in report["levels"][-1]["comparison"]["contenders"]]
    head = read(render(report, {}, None)).text.split("Asked")[0]
    assert f"Of 8 settings {outcomes.count('solves it')} find the contact state" in head
    assert f"{outcomes.count('refused')} is refused" in head
    assert "The direct solution is proved to be the only one." in head
    assert "Equations: unique solution proved, but 3 of 8 formulations did not find it." in head
    assert report["verdict"][1:] in read(render(report, {}, None)).text


def test_a_coarser_mesh_that_is_not_certified_is_named():
    report = report_of(on_three_meshes())
    report["certified"] = report["levels"][1]["comparison"]["certified"] = False
    head = read(render(report, {}, None)).text.split("Asked")[0]
    assert "On the coarser mesh (refine 2) some solutions are not proved" in head


def test_sections_without_content_are_left_out():
    alone = read(render(report_of(without_a_body()), {"pressure": SVG}, None)).text
    assert "Mesh convergence" not in alone
    assert "Reference values" not in alone
    assert "Iterations of each solver" not in alone
    assert "The problem as run" not in alone
    whole = read(render(report_of(on_three_meshes()), PICTURES, "name: x")).text
    assert "Mesh convergence" in whole
    assert "Iterations of each solver" in whole
    assert "The problem as run" in whole


@pytest.mark.parametrize(
    ("study", "says"),
    [
        (on_one_mesh, "o other state exists, because"),
        (not_unique, "so another contact state may exist"),
    ],
)
def test_the_certificate_states_whether_the_solution_is_unique(study: Callable[[], MeshStudy], says: str):
    text = read(render(report_of(study()), {}, None)).text
    certificate = text.split("Matrices Run ")[1].split(" Certificate ")[-1].split(" The certificate is about")[0]
    assert says in certificate


def test_references_are_judged_in_their_range_only():
    """Uniform pressure is exact; the contact of Hertz of a radius of 0.01 is a fifth of it wide."""
    report = report_of(on_one_mesh())
    text = read(render(report, {}, None)).text
    held = [score["holds"] for score in report["levels"][0]["scores"] if score["judged"]]
    assert held
    assert all(held)
    shown = len(report["levels"][0]["scores"]) - len(held)
    assert shown
    assert text.count("not judged") >= shown
    assert f"{len(held)} of {len(held)} of those judged hold" in text
    (remark,) = (item["remark"] for item in report["levels"][0]["references"] if item["remark"])
    assert remark[1:] in text


def test_page_has_the_penalty_beside_the_limit_of_convexity():
    """With μ = 1000 it is not: the whole Hessian has negative eigenvalues where the limit lies below."""
    report = report_of(of_many_settings())
    section = render(report, {}, None).split('id="convexity"')[1]
    for contender in report["levels"][0]["comparison"]["contenders"]:
        if contender["formulation"] == "qp2" and contender["weights"] == "tributary":
            told = contender["answer"]["search"]["penalty"]
            row = section.split(f'">{contender["label"]}</th>')[1].split("</tr>")[0]
            assert formatting.number(told["convexity_limit"]) in row
            assert (">yes<" in row) == (told["value"] <= told["convexity_limit"])


def test_the_spec_is_shown_as_it_ran():
    spec = "name: x\nmaterial: {young_modulus: 1}  # 'quoted'\n"
    page = render(report_of(on_one_mesh()), {}, spec)
    assert spec.strip() in "".join(re.findall(r"<pre>(.*?)</pre>", page, re.DOTALL)).replace("&#39;", "'")
    assert block().name in read(page).text


def test_the_page_shows_which_load_cases_act_and_where_the_tools_are():
    """A press of 40 + 0.5 · 20 on a free block, which the body holds up; one half of "more" and none of the other."""
    cases = {name: {"tools": {"press": {"force": {"y": -20}}}} for name in ("more", "most")}
    tools = {"press": {"zones": "press", "point": [1, 1], "force": {"y": -40}}}
    problem = made(BETWEEN, tools=tools, load_cases=cases, combinations={"half": {"more": 0.5}}, case="half")
    page = read(render(report_of(comparing.mesh_study(ComparisonOptions.of(), problem)), {}, None)).text
    assert "The load cases 0.5 more act in addition to the permanent loads." in page
    assert "the body presses on it with (0, 50), moment 0 about (1, 1)" in page


def head_of(report: dict[str, Any]) -> tuple[str, str]:
    """Class of the box at the head of a page, and its text."""
    page = render(report, {}, None)
    (quality,) = re.findall(r'<div class="verdict (\w+)"', page)
    return quality, read(page).text.split(" Problem Solution ")[0]


def with_state(report: dict[str, Any], *, met: bool | None, kind: str) -> dict[str, Any]:
    """The report as if the accuracy of its mesh, and the outcome of the direct solution, were others."""
    level = report["levels"][-1]
    level["accuracy"].update(met=met, reason="nobody looked" if met is None else "")
    compared = level["comparison"]
    if kind != "unique":
        compared["reference"]["certified"] = compared["certified"] = report["certified"] = False
        report["heading"] = "local only" if kind == "local only" else "not solved"
        compared["reference"]["answer"]["certificate"]["kind"] = kind
    return report


@pytest.mark.parametrize("kind", ["unique", "local only", "not a solution"])
@pytest.mark.parametrize("met", [True, False, None])
def test_the_box_is_green_only_if_both_verdicts_hold(met: bool | None, kind: str):
    """Amber if only the equations do; red without them, whatever the mesh."""
    quality, text = head_of(with_state(report_of(on_one_mesh()), met=met, kind=kind))
    expected = "bad" if kind != "unique" else "good" if met else "fair"
    assert quality == expected
    equations, mesh = text.index("Equations: "), text.index("Mesh: ")
    assert equations < mesh
    words = {"unique": "unique solution proved", "local only": "local only", "not a solution": "not solved"}
    assert text[equations:].startswith(f"Equations: {words[kind]}.")
    beginning = {True: "error at most ", False: "not met, error about ", None: "not assessed. Nobody looked."}[met]
    assert text[mesh:].startswith(f"Mesh: {beginning}")


def test_a_coarse_mesh_is_amber_and_its_error_is_stated():
    quality, text = head_of(report_of(on_a_coarse_mesh()))
    assert quality == "fair"
    assert re.search(r"Mesh: not met, error about \d+ % \(asked 1 %\)", text)


def luminance(color: str) -> float:
    """Relative luminance of #rrggbb, as WCAG 2.2 defines it."""
    channels = (int(color[i : i + 2], 16) / 255 for i in (1, 3, 5))
    r, g, b = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def test_the_text_of_each_box_can_be_read_on_its_ground():
    """Green, amber and red, in the light and in the dark; and the colors of titles of pictures on paper."""
    page = render(report_of(on_one_mesh()), {}, None)
    themes = re.findall(r"--good: .*", page)
    assert len(themes) == 2
    for theme in themes:
        colors = dict(re.findall(r"--([\w-]+): (#\w{6})", theme))
        for quality in ("good", "fair", "bad"):
            light, dark = sorted(map(luminance, (colors[quality], colors[f"{quality}-page"])), reverse=True)
            assert (light + 0.05) / (dark + 0.05) >= 4.5, quality
    for quality in ("good", "fair"):
        assert 1.05 / (luminance(QUALITY_COLOURS[quality]) + 0.05) >= 4.5


@pytest.mark.slow
def test_an_infinite_peak_is_nowhere_on_the_page():
    """Neither the largest nodal pressure of any solution nor of any mesh, in any form that a number may have."""
    study = with_infinite_peak()
    report = report_of(study)
    pictures = {name: vector_graphic(figure) for name, figure in figures_of(study).items()}
    page = render(report, pictures, None)
    text = read(page).text + " ".join(str(attrs.get("alt")) for _, attrs in read(page).tags)
    for level in study.levels:
        largest = level.answer.solution.pressure.max()
        assert largest > 50
        for digits in range(3, 6):
            assert f"{largest:.{digits}g}" not in text
    assert "Peak pressureinfinite in foot" in text
    assert "no contact" not in text
    for level in report["levels"]:
        answers = [item["answer"] for item in (*level["comparison"]["contenders"], level["comparison"]["reference"])]
        assert [answer["peak"] for answer in answers] == [None] * len(answers)
    assert [item["name"] for item in report["convergence"]["quantities"] if "peak" in item["name"]] == []


def test_an_infinite_peak_is_not_judged_and_the_reason_is_stated():
    report = report_of(with_infinite_peak())
    (peak, resultant) = report["levels"][-1]["scores"]
    assert (peak["judged"], peak["computed"]) == (False, None)
    assert resultant["judged"]
    assert resultant["holds"]
    text = read(render(report, {}, None)).text
    assert "The peak pressure of foot is infinite, and is not judged" in text
    assert "1 of 1 of those judged hold" in text


def test_errors_of_a_finer_mesh_know_the_infinite_pressure():
    """Found on refine 1; without it the pressure as a whole, whose square is not integrable, would never converge."""
    first, second = (level.answer.accuracy for level in with_infinite_peak().levels)
    assert first.infinite == second.infinite == ("foot",)
    assert second.met
    assert second.worst < 0.01


def test_the_table_of_error_bars_is_that_of_the_report():
    report = report_of(on_three_meshes())
    section = render(report, {}, None).split('<section id="accuracy">')[1].split("</section>")[0]
    bars = report["levels"][-1]["accuracy"]["bars"]
    assert section.count('<tr><th scope="row">') == len(bars)
    assert "They are not proved." in section
