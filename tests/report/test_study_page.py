"""The page and the summary of a study: rows that do not hold are seen, and numbers are those of the table."""

from dataclasses import replace
from io import StringIO

import pytest
from page_reader import ensure_self_contained, read
from rich.console import Console

from bemcontact.problems.units import Units
from bemcontact.report.study_page import (
    render,
    rows_in_short,
    study_shortfall,
    study_summary,
    study_verdicts,
    unit_of_output,
)
from bemcontact.studies.axes import axes_of
from bemcontact.studies.outputs import Reading
from bemcontact.studies.rows import MemberRow, MemberStatus, failed_row
from bemcontact.studies.table import StudyTable


def row(number: int, status: MemberStatus, peak: float | None, message: str = "") -> MemberRow:
    certified = status is not MemberStatus.NOT_CERTIFIED
    return MemberRow(
        number=number, values={"a.b": float(number)}, status=status, equations="", certified=certified,
        met=status is MemberStatus.HOLDS, mesh_error=0.002, message=message,
        outputs={"peak": Reading(value=peak, error=None if peak is None else 0.01 * peak)},
    )  # fmt: skip


def study(*rows: MemberRow) -> StudyTable:
    return StudyTable(
        name="<b>study</b>", units=Units(length="mm", force="N"), axes=axes_of({"a.b": [0.0, 1.0]}, Units()),
        outputs=("peak",), rows=rows,
    )  # fmt: skip


GOOD = row(0, MemberStatus.HOLDS, 100.0)
UNMET = row(1, MemberStatus.NOT_MET, 900.0, "the largest error is 30 %")
OPEN = row(1, MemberStatus.NOT_CERTIFIED, 900.0, "a residual is too large")


@pytest.mark.parametrize(
    ("second", "quality", "words"),
    [
        (row(1, MemberStatus.HOLDS, 200.0), ("good", "good"), "all proved"),
        (UNMET, ("good", "fair"), "not met by 1 of 2"),
        (OPEN, ("bad", "fair"), "1 of 2 not proved"),
        (failed_row(1, {"a.b": 1.0}, "there is no contact"), ("bad", "good"), "is no contact"),
    ],
)
def test_one_member_that_does_not_hold_changes_the_verdict(second: MemberRow, quality: tuple[str, str], words: str):
    both = study(GOOD, second)
    verdicts = study_verdicts(both)
    assert tuple(item.quality for item in verdicts) == quality
    assert words in " ".join(f"{item.word} {item.words}" for item in verdicts)
    if verdicts[1].quality == "good":  # only of members that have a result
        with_result = " that has a result" * (second.status is MemberStatus.FAILED)
        assert verdicts[1].words == f"Each member{with_result} is as accurate as was asked."
    assert (study_shortfall(both) == "") is (quality == ("good", "good"))
    page = read(render(both, {}, None)).text
    assert words in page
    assert str(second.status) in page


def test_the_summary_names_a_member_whose_error_bars_leave_something_out():
    """A peak that is infinite is no such thing. The first of several notes is enough."""
    for notes in (("off; error bars do not include this", "error bars of it do not include this"), ()):
        second = replace(row(1, MemberStatus.HOLDS, 200.0, "infinite"), notes=notes)
        console = Console(width=200, record=True, file=StringIO())
        console.print(study_summary(study(GOOD, second), 1.0))
        note = "Error bars of 1 member leave something out. Member 1 (a.b = 1): Off; error bars do not include this."
        assert (note in " ".join(console.export_text().split())) is bool(notes)
        assert (note in read(render(study(GOOD, second), {}, None)).text) is bool(notes)


def test_a_long_note_of_several_members_is_on_the_page_once():
    """Each row has its number, and texts of its own; the table for programs has the whole note of each member."""
    slender = (
        "a slender part is stretched as it bends: linear theory is off by about {} %; error bars do not include this"
    )
    other = "contact in 'rim' is elsewhere by 0.3 % of its length; error bars do not include this"
    several = study(
        replace(GOOD, notes=(slender.format(2), other)),
        replace(row(1, MemberStatus.HOLDS, 200.0, "infinite"), notes=(slender.format(12),)),
        replace(row(2, MemberStatus.HOLDS, 200.0, "infinite"), notes=(slender.format("3.5"),)),
    )
    page = render(several, {}, None)
    reader = read(page)
    ensure_self_contained(page, reader)
    assert (
        reader.text.count("stretched as it bends") == 2
    )  # below the ranges for the first member, below the table for all
    assert f"{slender.format('2 to 12')[1:]}. (3 members)" in reader.text
    assert reader.text.count("elsewhere by 0.3 % of its length; error bars do not include this. Note 1.") == 1
    assert reader.text.count("Infinite. Note 1.") == 2
    messages = several.table()["message"]
    assert messages == [f"{slender.format(2)}; {other}", *(f"infinite; {slender.format(off)}" for off in ("12", "3.5"))]


def test_numbers_that_do_not_hold_are_in_no_range():
    """The summary has the smallest and largest value of members that hold; the page shows all with their status."""
    for second in (UNMET, OPEN):
        console = Console(width=100, record=True, file=StringIO())
        console.print(study_summary(study(GOOD, second), 1.0))
        words = console.export_text()
        assert "900" not in words
        assert "output of the 1 that holds" in words
        ranges = render(study(GOOD, second), {}, None).partition('id="ranges"')[2].partition("</section>")[0]
        assert "Output of the 1 that holds" in ranges
        assert "100 ± 1 MPa" in ranges
        assert "900" not in ranges


def test_a_rotation_is_in_radians_whatever_the_units_are():
    for column in ("rotation", "rotation.press", "rotation.rotation counterclockwise of the body 'block'"):
        assert unit_of_output(column, Units()) == "rad"
    assert unit_of_output("motion.press", Units(length="mm")) == "mm"


def test_the_page_has_each_number_with_its_error_and_no_markup_of_the_user():
    page = render(study(GOOD, UNMET), {"peak over a.b": b"<svg/>"}, "name: x")
    text = read(page).text
    assert "100 ± 1" in text
    assert "peak [MPa]" in text
    assert "<b>study</b>" not in page
    assert "<b>" not in rows_in_short(study(GOOD))
