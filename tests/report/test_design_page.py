"""The page of a designed gap: numbers and table are those of the design, and what is not proved is said."""

import csv
import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from page_reader import ensure_self_contained, read
from results import designed

import bemcontact
from bemcontact import GapDesign, Relief, design_gap
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.report import folder
from bemcontact.report.design_page import design_csv, design_verdicts, render

FLAT_PUNCH = Path(__file__).parents[2] / "models" / "gallery" / "flat_punch.yaml"
BOUNDS = Relief(lower=0, upper=0.01, slope=0.003)


@pytest.fixture(scope="module")
def design() -> GapDesign:
    return design_gap(bemcontact.condense(bemcontact.load(FLAT_PUNCH, variant="stated mesh")), BOUNDS)


def uncoupled() -> GapDesign:
    """Three points that do not feel each other, overlapping by 3, 1, 1: a profile of 1.5 leaves pressures 1.5, 1, 1.

    Another load state has half the overlap.
    """
    contact = CondensedContact.from_compliance(np.eye(3), [-3.0, -1.0, -1.0])
    return design_gap([contact, replace(contact, initial_gap=contact.initial_gap / 2)], Relief(lower=0, upper=1.5))


@pytest.mark.slow
def test_the_folder_has_page_table_numbers_and_pictures(design: GapDesign, tmp_path: Path):
    for _ in range(2):  # the second one replaces the first
        folder.save_design(design, tmp_path / "design", BOUNDS)
    files = {item.relative_to(tmp_path / "design").as_posix() for item in (tmp_path / "design").rglob("*.*")}
    assert files == {"design.html", "design.csv", "design.json", "figures/pressure.svg", "figures/profile.svg"}
    page = (tmp_path / "design" / "design.html").read_text(encoding="utf-8")
    reader = read(page)
    ensure_self_contained(page, reader)
    assert page.count("<img ") == 2
    assert design.to_yaml() in page
    assert all(row in reader.text for row in ("profile00.01 mm", "slope-0.0030.003"))  # cells side by side
    assert json.loads((tmp_path / "design" / "design.json").read_text(encoding="utf-8")) == design.to_dict()


@pytest.mark.slow
def test_the_table_is_the_design(design: GapDesign):
    head, *rows = csv.reader(io.StringIO(design_csv(design)))
    assert head == ["arc", "x", "y", "profile", "pressure_before_1", "pressure_after_1"]
    columns = np.array(rows, float).T
    contact = design.before[0].contact
    wanted = [contact.arc_position, *contact.points.T, design.profile]
    wanted += [design.before[0].pressure, design.after[0].pressure]
    np.testing.assert_array_equal(columns, wanted)


def test_each_load_state_has_a_row_with_its_peaks():
    """Peaks are the overlaps over the compliance of one: 3 and 1.5 without, 1.5 and less with the profile."""
    result = uncoupled()
    page = render(result, {})
    text = read(page).text
    assert "in the worst of 2 load states" in text
    first, second = (page.index(f'<th scope="row">{state}</th>') for state in (1, 2))
    assert ">3</td>" in page[first:second]
    assert ">1.5</td>" in page[first:second]
    assert ">1.5</td>" in page[second:]
    assert len(design_csv(result).partition("\n")[0].split(",")) == 4 + 2 * 2
    assert "Bound on the" not in text


@pytest.mark.slow
def test_a_peak_that_is_infinite_in_theory_is_no_number_of_the_body(design: GapDesign):
    """A flat punch presses infinitely at its edges; of uncoupled points each has its overlap, and the peak is 3."""
    (state,) = design.before
    assert state.infinite
    assert not design.after[0].infinite
    text = read(render(design, {})).text
    assert f"at the contact points; before: infinite in theory, {design.peak_before:.5g} MPa on this mesh" in text
    assert "Without it, it is infinite in theory" in text
    assert " %" not in design.words
    assert not any(item.infinite for item in (*uncoupled().before, *uncoupled().after))
    assert "at the contact points; before: 3, -50.0 %" in read(render(uncoupled(), {})).text
    assert "goes from 3 to 1.5 (-50.0 %)" in uncoupled().words


@pytest.mark.parametrize(("overlap", "infinite"), [((5, 1, 1), True), ((1, 1, 5), True), ((1, 5, 1), False)])
def test_a_peak_is_infinite_only_where_it_rises_steeply_to_an_end(overlap: tuple[int, ...], infinite: bool):
    """Without coupling the pressures are the overlaps."""
    contact = CondensedContact.from_compliance(np.eye(3), -np.array(overlap, float))
    states = design_gap(contact, Relief(lower=0, upper=0.1)).before
    assert [state.infinite for state in states] == [infinite]


def test_what_is_proved_and_what_is_not_is_said(design: GapDesign):
    """The bound of the worst load state, 1.5, is reached without coupling; and a mesh is never assessed."""
    proved = uncoupled()
    assert proved.proved_optimal
    assert [item.quality for item in design_verdicts(proved)] == ["good", "good", "fair"]
    open_one = replace(proved, proved_optimal=False)
    assert "Not proved not proved" in read(render(open_one, {})).text
    wrong = replace(proved, designed=proved.designed + 1.0)
    assert design_verdicts(wrong)[0].quality == "bad"
    assert "not as designed" in read(render(wrong, {})).text
    assert "Not estimated not assessed" in read(render(design, {})).text


def test_a_surface_that_cannot_be_written_is_no_obstacle():
    """The zone goes round, which no spline does."""
    proved = uncoupled()
    ring = replace(proved.before[0].contact, run_length=np.array([3.0]))
    page = read(render(replace(proved, before=(replace(proved.before[0], contact=ring), proved.before[1])), {})).text
    assert "goes round or is in pieces" in page


@pytest.mark.slow
def test_stress_and_its_limit_are_at_the_head():
    """The limit of 95 MPa is kept to a millionth, where it is reached."""
    text = read(render(designed(), {})).text
    assert designed().von_mises == pytest.approx(95, rel=1e-6)
    assert "Von Mises stress95 MPa at most, at the given points, limit 95" in text
    assert "Von Mises stress" not in read(render(uncoupled(), {})).text
