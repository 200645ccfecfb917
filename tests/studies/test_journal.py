"""The journal of a study: what is read back after a kill at any byte."""

from importlib.util import find_spec
from pathlib import Path
from shutil import copyfile

import pytest

from bemcontact.errors import ProblemError
from bemcontact.files.output import whole_folder
from bemcontact.studies.journal import JOURNAL, Journal, alone, is_journal, opened, recorded, state_of
from bemcontact.studies.rows import MemberRow, failed_row, row_from

ROWS = [failed_row(number, {"a": number}, "no") for number in range(3)]


def written(folder: Path) -> bytes:
    with opened(folder) as journal:
        for row in ROWS:
            journal.add(f"key {row.number}", row)
    return (folder / JOURNAL).read_bytes()


def replaced(folder: Path) -> None:
    """Put a folder with a copy of the journal in place, as a run does at its end."""
    with whole_folder(folder) as temporary:
        copyfile(folder / JOURNAL, temporary / JOURNAL)


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
        assert is_journal(path)


def test_a_foreign_file_is_no_journal(tmp_path: Path):
    (tmp_path / JOURNAL).write_text('{"mine": 1}\n', encoding="utf-8")
    assert not is_journal(tmp_path / JOURNAL)
    assert not is_journal(tmp_path / "nothing")


def test_two_runs_do_not_write_to_one_folder(tmp_path: Path):
    place = tmp_path / "study"
    with alone(place, None):
        with pytest.raises(ProblemError, match="another run writes"), alone(place, state_of(place / JOURNAL)):
            pass
        written(place)
    with alone(place, state_of(place / JOURNAL)):
        pass


@pytest.mark.skipif(not find_spec("fcntl"), reason="Windows has no such locks")
def test_a_run_does_not_go_on_from_a_journal_that_another_one_has_changed_since(tmp_path: Path):
    """A run that ends puts a new folder in place; rows for the old one would be lost, and its own be solved twice."""
    place, path = tmp_path / "study", tmp_path / "study" / JOURNAL
    written(place)
    for change in (written, replaced):
        seen = state_of(path)
        change(place)
        with pytest.raises(ProblemError, match="another run has just written"), alone(place, seen):
            pass
        written(place)
    with pytest.raises(ProblemError, match="another run has just written"), alone(place, None):
        pass


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no device that is always full")
def test_a_full_disk_is_told_with_the_name_of_the_journal(tmp_path: Path):
    with open("/dev/full", "ab", buffering=0) as file, pytest.raises(OSError, match=JOURNAL):
        Journal(file, tmp_path / JOURNAL).add("key", ROWS[0])
