"""The journal of a study: what is read back after a kill at any byte."""

from pathlib import Path

import pytest

from bemcontact.errors import ProblemError
from bemcontact.studies.journal import JOURNAL, is_journal, opened, recorded
from bemcontact.studies.rows import MemberRow, failed_row, row_from

ROWS = [failed_row(number, {"a": number}, "no") for number in range(3)]


def written(folder: Path) -> bytes:
    with opened(folder) as journal:
        for row in ROWS:
            journal.add(f"key {row.number}", row)
    return (folder / JOURNAL).read_bytes()


def read(path: Path) -> list[MemberRow]:
    return [row_from(record, record["number"], record["values"]) for record in recorded(path).values()]


def test_rows_are_read_back_as_they_were(tmp_path: Path):
    written(tmp_path / "study")
    assert read(tmp_path / "study" / JOURNAL) == ROWS


def test_a_row_outlives_its_process_as_soon_as_it_is_added(tmp_path: Path):
    with opened(tmp_path / "study") as journal:
        for count, row in enumerate(ROWS, 1):
            journal.add(f"key {row.number}", row)
            assert read(tmp_path / "study" / JOURNAL) == ROWS[:count]


def test_a_journal_that_is_cut_at_any_byte_has_all_whole_lines_and_goes_on(tmp_path: Path):
    whole = written(tmp_path / "study")
    head = whole.index(b"\n") + 1
    for length in range(0, len(whole) + 1, 7):
        place = tmp_path / f"{length}"
        place.mkdir()
        path = place / JOURNAL
        path.write_bytes(whole[:length])
        complete = max(0, whole[:length].count(b"\n") - 1)
        assert is_journal(path)
        assert read(path) == ROWS[:complete]
        with opened(place) as journal:
            journal.add("key 2", ROWS[2])
        assert read(path) == [*ROWS[: min(complete, 2)], ROWS[2]]
        assert length < head or is_journal(path)


def test_a_foreign_file_is_no_journal(tmp_path: Path):
    (tmp_path / JOURNAL).write_text('{"mine": 1}\n', encoding="utf-8")
    assert not is_journal(tmp_path / JOURNAL)
    assert not is_journal(tmp_path / "nothing")


def test_two_runs_do_not_write_one_journal(tmp_path: Path):
    with opened(tmp_path / "study"), pytest.raises(ProblemError, match="another run"), opened(tmp_path / "study"):
        pass
