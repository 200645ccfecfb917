"""Texts of members of a study that are alike are stated once, and nothing of them is lost."""

from hypothesis import given
from hypothesis import strategies as st

from bemcontact.report.notes_of_members import MEASURED, SHORT, stated_once

LONG = "linear theory is off by about {} % there, and by {} of the length of '{}'; error bars do not include this"
numbers = st.floats(1e-9, 1e9).map(lambda value: f"{value:.2g}")
texts = st.builds(LONG.format, numbers, st.just("0.5"), st.sampled_from(["rim", "foot 2", "zone 1.5 b"]))


@given(
    st.lists(
        st.lists(texts | st.sampled_from(["", "the body touches no surface"]), max_size=3, unique=True), max_size=6
    )
)
def test_each_text_is_in_its_row_or_in_one_note(members: list[list[str]]):
    """A note has as many members as rows have its number, and the numbers of each lie within its ranges."""
    rows, notes = stated_once(members)
    assert len(rows) == len(members)
    for number, (note, count) in enumerate(notes, 1):
        marked = [texts for texts, (_, shared) in zip(members, rows, strict=True) for one in shared if one == number]
        assert len(marked) == count > 1
        assert len(note) > SHORT
    for texts, (own, shared) in zip(members, rows, strict=True):
        assert len(own) + len(shared) == len(texts)
        assert [text for text in texts if text in own] == own
        assert all(text in own for text in texts if len(text) <= SHORT)


def test_a_number_that_differs_is_a_range():
    rows, ((note, count),) = stated_once([[LONG.format(x, "0.5", "rim")] for x in ("12", "3.5", "1e+02")])
    assert rows == [([], [1])] * 3
    assert (note, count) == (LONG.format("3.5 to 1e+02", "0.5", "rim"), 3)


def test_names_and_counts_are_no_measured_numbers():
    for text in ("rim2", "zone 12", "3 times", "level 1.", "'h-0'", "1.2.3"):
        assert MEASURED.sub("", text) == text
    for number in ("0.051", "-2.5", "2.1e-05", "1e+02"):
        assert MEASURED.sub("", f"by {number} mm") == "by  mm"
    assert MEASURED.sub("", "5 %") == " %"
