"""The page of a result: whole, with its numbers, and what is proved, estimated and not looked at apart."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from mesh_studies import block, punch
from page_reader import ensure_self_contained, read
from results import EACH, cases, condensed, punched, rolled
from tool_problems import FREE, FREE_CASES, made

import bemcontact
from bemcontact.analysis.case_comparisons import compare_cases
from bemcontact.assessment.accuracy import Accuracy
from bemcontact.assessment.certificate import HEADINGS, CertificateKind
from bemcontact.options import ComparisonOptions, StressMeasure
from bemcontact.report.bars import NOTHING
from bemcontact.report.contact_words import units_of
from bemcontact.report.facts import facts, peak_of, total_force
from bemcontact.report.figures import load_cases, pictures_of, vector_graphic
from bemcontact.report.result_page import NOT_LOOKED_AT, render
from bemcontact.report.zones import zone_rows

GALLERY = Path(__file__).parents[2] / "models" / "gallery"


def together(text: str) -> str:
    """A text without blanks: cells of a table have none between them."""
    return text.replace(" ", "")


@pytest.mark.slow
@pytest.mark.parametrize("name", EACH)
def test_the_page_is_whole_and_needs_nothing_else(name: str):
    results = EACH[name]()
    pictures = {key: vector_graphic(figure) for key, figure in pictures_of(results).items()}
    page = render(results, pictures, "name: <x>")
    reader = read(page)
    ensure_self_contained(page, reader)
    shown = [attrs for tag, attrs in reader.tags if tag == "img"]
    assert len(shown) == len(pictures)
    assert all(picture["alt"] for picture in shown)
    assert "name: <x>" in reader.text


def test_the_head_has_the_answer_with_its_errors():
    """Peak, force, contact and displacement as in the terminal, before the verdicts."""
    record, units = rolled().to_dict(), units_of(rolled().contact)
    text = read(render(rolled(), {}, None)).text
    head = text[: text.index("Equations:")]
    assert peak_of(record, units) in head
    assert total_force(record, units)[1] in head
    assert "± " in head[head.index("Largest displacement") :]


@pytest.mark.parametrize("name", EACH)
def test_each_zone_has_its_row(name: str):
    results = EACH[name]()
    text = read(render(results, {}, None)).text
    for result in cases().results.values() if name == "cases" else [results]:
        for row in zone_rows(result.to_dict(), units_of(result.contact)):
            for words in (words for words in row.values() if words != NOTHING):
                assert together(words) in together(text)


def test_proved_estimated_and_not_looked_at_are_apart():
    """What is not certified is not called proved, and what was not assessed not estimated."""
    sure = read(render(rolled(), {}, None)).text
    assert "Proved unique solution proved" in sure
    assert "Estimated error at most" in sure
    assert f"Not looked at {NOT_LOOKED_AT}" in sure
    certificate = replace(rolled().certificate, kind=CertificateKind.LOCAL, heading=HEADINGS[CertificateKind.LOCAL])
    doubtful = replace(rolled(), certificate=certificate, accuracy=Accuracy(asked=None, reason="nobody asked"))
    text = read(render(doubtful, {}, None)).text
    assert "Not proved local only" in text or f"Not proved {certificate.heading}" in text
    assert "Not estimated not assessed" in text


def test_stress_that_is_infinite_is_told_before_its_picture_is_believed():
    text = read(render(punched(), {}, None)).text
    assert together("von Mises, at corners and edges infinite at (2, 0)") in together(text)
    assert "error bar, from the stress on another mesh" in text
    assert 'id="stress"' not in render(condensed(), {}, None)


@pytest.mark.slow
def test_the_page_of_load_cases_has_one_picture_of_their_stress_before_its_table():
    """With the stress that was asked for in its caption, and the load cases in its text alternative."""
    drawn = {name: vector_graphic(it) for name, it in pictures_of(cases(), StressMeasure.MAX_SHEAR).items()}
    page = render(cases(), drawn, None, stress=StressMeasure.MAX_SHEAR)
    stress = page[page.index('<section id="stress">') : page.index('<section id="zones">')]
    before_table = stress[: stress.index("<table")]
    assert before_table.count("<img") == stress.count("<img") == 1
    assert "Largest shear stress on the deformed shape in each load case" in before_table
    assert f'alt="{cases().name}: {", ".join(cases().results)}. Largest shear' in before_table
    assert page.count("on the deformed shape in each load case") == 2  # caption and text alternative


def test_the_picture_of_the_problem_says_whose_loads_it_shows():
    """The first of the load cases: each has its own loads, and a picture shows one of them."""
    first = next(iter(cases().results))
    text = read(render(cases(), {"problem": b"<svg/>"}, None)).text
    assert f"; with the loads of {first}" in text
    assert "with the loads of" not in read(render(rolled(), {"problem": b"<svg/>"}, None)).text


def test_an_infinite_pressure_has_its_place_in_the_head_and_under_load_cases():
    """The edge of the punch is at (2, 0)."""
    alone = {"loads": {"temperature": {"expansion": 1e-5, "change": 0}}}
    head = together(read(render(punched(), {}, None)).text).split("Equations:")[0]
    assert "infiniteat(2,0)mm" in head
    both = bemcontact.solve_cases(punch(load_cases={"alone": alone}))
    assert "infinitealone(2,0)mm" in together(read(render(both, {}, None)).text)


def test_what_was_asked_has_what_each_load_case_adds():
    """Conditions, loads on the volume and tools of each load case, and the factors of a combination, as stated."""
    case = {
        "hot": {"loads": {"temperature": {"expansion": 1e-5, "change": 20}}},
        "pressed": {"conditions": {"top": {"pressure": 2}}},
    }
    both = {"both": {"hot": 1.5, "pressed": 1}}
    text = read(render(bemcontact.solve_cases(block(load_cases=case, combinations=both)), {}, None)).text
    asked = together(text)
    assert "Loadcasehotadds:temperaturechange20,expansion1e-05." in asked
    assert "Loadcasepressedadds:toppressure2" in asked
    assert "Combinationboth:1.5hot+1pressed." in asked
    assert "Onthevolume" not in asked  # the permanent loads alone are those of the problem


def test_load_cases_have_the_largest_of_all():
    """The largest peak of each zone, and in which load case."""
    text = read(render(cases(), {}, None)).text
    assert text.startswith(f"{cases().name}: contact")
    for number, zone in enumerate(next(iter(cases().results.values())).contact.zone_names):
        own = {
            name: result.solution.pressure[result.contact.zone == number].max()
            for name, result in cases().results.items()
        }
        most = max(own, key=own.__getitem__)
        assert f"{zone}{own[most]:.5g}{most}(" in together(text[text.index("Largest of all load cases") :])


def test_each_load_case_has_its_own_rotation():
    results = bemcontact.solve_cases(bemcontact.load(GALLERY / "body_between_two_tools.yaml"))
    told = together(read(render(results, {}, None)).text).partition("Rotationsofbodiesthatcontactholds")[2]
    for name, result in results.results.items():
        (angle,) = (words for of, words in facts(result.to_dict(), units_of(result.contact)) if of == "Rotation")
        assert together(f"{name}{angle}") in told


def test_a_level_pressure_has_no_place_under_load_cases():
    """Uniform pressure on a block: the place would be that of round-off."""
    case = {"pressed": {"conditions": {"top": {"pressure": 2}}}}
    text = read(render(bemcontact.solve_cases(block(load_cases=case)), {}, None)).text
    assert "pressedallalongthecontact" in together(text[text.index("Largest of all load cases") :])


@pytest.mark.slow
def test_formulations_are_compared_under_each_load_case():
    """The page says of each whether it solves the problem; the head says what the answer is first."""
    compared = compare_cases(ComparisonOptions.of(["qp3"]), made(FREE, **FREE_CASES))
    text = together(read(render(compared.answers, {}, None, compared)).text)
    for case, level in compared.levels.items():
        (contender,) = level.comparison.contenders
        assert f"{case}QP3{together(contender.verdict.outcome)}" in text
    assert text.index("LoadcaseEquations") < text.index("LoadcaseFormulation")


def test_the_head_has_the_force_of_each_zone_and_the_largest_stress():
    """The forces of a press and a table cancel, so that their sum says nothing: 6000 N/mm each, by statics."""
    problem = bemcontact.load(GALLERY / "body_between_two_tools.yaml").with_case("raised")
    text = read(render(bemcontact.solve(problem), {}, None)).text
    head = text[: text.index("Equations:")]
    assert re.search(r"Force of table ?6000\.0*( ± \S+)? N/mm", head)
    assert re.search(r"Force of press ?6000\.0*( ± \S+)? N/mm", head)
    assert re.search(r"Largest von Mises stress ?88\.8\d* ± ", head)  # 100 MPa and ν of it across
    assert "the same all over the body" in text
    assert "shear below table" not in text
    assert "Material: E = 210000 MPa, Poisson's ratio 0.3, plane strain." in text
    punch_head = read(render(punched(), {}, None)).text.split("Equations:")[0]
    boundary = punched().largest_stresses().boundary
    assert boundary is not None
    assert re.search(
        rf"stressinfinite at corners or edges; largest maximum away from them {boundary.value:.2f}", punch_head
    )


def test_the_head_says_that_notes_go_beyond_the_error_bars():
    result = replace(rolled(), notes=("strains are not small; error bars do not include this",))
    head, _, rest = render(result, {}, None).partition("<main>")
    assert 'Error bars do not include everything:</strong> see <a href="#notes">the note</a>' in head
    assert '<h3 id="notes">' in rest
    assert "#notes" not in render(replace(rolled(), notes=()), {}, None)


def test_the_head_of_load_cases_has_the_largest_pressure_of_all():
    results = cases().results
    most = max(results, key=lambda name: results[name].solution.pressure.max())
    head = read(render(cases(), {}, None)).text.partition("What was asked")[0]
    peak = peak_of(results[most].to_dict(), units_of(results[most].contact))
    assert f"Largest pressure{peak} under {most}" in head
    assert f"Load cases{len(results)}" in head


def test_numbers_that_are_not_to_be_relied_on_come_after_the_verdict():
    assert not cases().certified
    for results, first in ((rolled(), "Peak pressure"), (cases(), "Equations:")):
        head = read(render(results, {}, None)).text.partition("What was asked")[0]
        places = {
            words: head.index(words) for words in ("Equations:", "Peak pressure", "Largest pressure") if words in head
        }
        assert min(places, key=lambda words: places[words]) == first


def test_shares_larger_than_the_accuracy_asked_are_marked():
    """Of an answer that is accurate enough none is; asked for half of the error that is known, the largest ones are."""
    result = rolled()
    assert 'data-label="Share of the accuracy asked"><span class="badge bad">' not in render(result, {}, None)
    asked = result.accuracy.worst / 2
    unmet = replace(result, accuracy=replace(result.accuracy, asked=asked))
    over = [bar for bar in unmet.accuracy.bars if bar.promised and bar.bar is not None and bar.bar > asked]
    page = render(unmet, {}, None)
    assert 0 < page.count('data-label="Share of the accuracy asked"><span class="badge bad">') == len(over)
    assert '<span class="badge bad">200 %</span>' in page


def test_a_caption_counts_the_load_cases_that_are_drawn(monkeypatch: pytest.MonkeyPatch):
    """Of many load cases only those with the largest forces have pictures, and the alternative names only these."""
    monkeypatch.setattr(load_cases, "MOST", 1)
    (shown,) = load_cases.shown_cases(cases())
    page = render(cases(), {"contacts": b"<svg/>", "pressure-1": b"<svg/>"}, None)
    some = f"the 1 of {len(cases().results)} load cases with the largest forces"
    assert f"Where the body touches in {some}" in page
    assert f'alt="{cases().name}: {shown}. Where' in page
    assert f'alt="{cases().name}: {", ".join(cases().results)}. ' in page  # all have their pressures drawn


def test_letters_of_all_pictures_have_one_size():
    """A picture that is half as wide as others fills half of its place."""
    (share,) = re.findall(
        r'<img style="width: (\d+)%"',
        render(rolled(), {"contact": b'<svg width="192.5pt"/>', "gap-1": b"<svg/>"}, None),
    )
    assert int(share) == 50


def test_stresses_that_are_missing_for_one_reason_have_one_row():
    """Between two tools, bending and compression have no largest stress inside, nor shear below one of them."""
    missing = [result.largest_stresses().missing for result in cases().results.values()]
    assert max(map(len, missing)) > 1
    page = render(cases(), {}, None)
    for reasons in missing:
        for why in {*reasons.values()}:
            labels = "; ".join(label for label in reasons if reasons[label] == why)
            assert f">{labels}</td>" in page
    assert page.count('data-label="Value">none</td>') == sum(len({*reasons.values()}) for reasons in missing)
