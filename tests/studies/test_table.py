"""The table of a study as columns, CSV and Parquet."""

import csv
import io
from dataclasses import replace
from pathlib import Path

import pyarrow.parquet
import pytest

from bemcontact.problems.units import Units
from bemcontact.studies import table
from bemcontact.studies.axes import axes_of
from bemcontact.studies.outputs import Reading
from bemcontact.studies.rows import MemberRow, MemberStatus, failed_row
from bemcontact.studies.table import StudyTable


def row(number: int, value: object, **outputs: Reading) -> MemberRow:
    return MemberRow(
        number=number, values={"a": value}, status=MemberStatus.HOLDS, equations="unique solution proved",
        certified=True, met=True, mesh_error=0.01, message="", outputs=outputs,
    )  # fmt: skip


MIXED = StudyTable(
    name="mixed",
    units=Units(length="mm", force="N"),
    axes=axes_of({"a": [1.5, "x, y", [1, 2]]}, Units()),
    outputs=("peak",),
    rows=(
        row(0, 1.5, peak=Reading(value=3.0, error=0.1)),
        failed_row(1, {"a": "x, y"}, 'no "contact"\nstate'),
        row(2, [1, 2], peak=Reading(value=None)),
    ),
)


def test_csv_is_the_table():
    lines = [*csv.reader(io.StringIO(MIXED.to_csv()))]
    head = "member a status equations mesh mesh_error peak peak_error message"
    assert lines[0] == head.split()
    assert lines[1] == ["0", "1.5", "holds", "unique solution proved", "met", "0.01", "3.0", "0.1", ""]
    assert lines[2] == ["1", "x, y", "failed", "", "", "", "", "", 'no "contact" state']
    assert lines[3][1] == "[1, 2]"
    assert lines[3][6:8] == ["", ""]


def test_parquet_is_the_table(tmp_path: Path):
    assert MIXED.save_parquet(tmp_path / "a.parquet")
    written = pyarrow.parquet.read_table(tmp_path / "a.parquet")
    kinds = [str(written.schema.field(name).type) for name in ("member", "a", "mesh_error", "peak")]
    assert kinds == ["int64", "string", "double", "double"]
    read, columns = written.to_pydict(), MIXED.table()
    assert read.pop("a") == ["1.5", "x, y", "[1, 2]"]
    columns.pop("a")
    assert read == columns


def test_without_pyarrow_there_is_no_parquet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(table, "find_spec", lambda _: None)
    assert not MIXED.save_parquet(tmp_path / "a.parquet")
    assert [*tmp_path.iterdir()] == []


def test_the_worst_status_counts_first():
    assert MIXED.counts == {"failed": 1, "holds": 2}
    assert MIXED.holds is False
    assert MIXED.record().to_dict()["counts"] == MIXED.counts


def test_only_what_concerns_the_outputs_of_the_table_is_said():
    """A journal keeps what a run with von_mises has found; a table of peaks has no word about infinite stress."""
    found = replace(row(0, 1.5, peak=Reading(value=3.0), von_mises=Reading(value=5.0)), stress="stress is infinite")
    unknown = dict.fromkeys(("rotation.wheel", "displacement"), Reading(value=None))
    moved = row(1, 2.5, peak=Reading(value=3.0), **unknown)
    tables = {
        outputs: StudyTable(
            name="s", units=Units(), axes=axes_of({"a": [1.5, 2.5]}, Units()), outputs=outputs, rows=(found, moved)
        ).table()
        for outputs in (("peak",), ("von_mises",), ("peak", "rotation"), ("displacement",))
    }
    assert tables["peak",]["message"] == ["", ""]
    assert tables["von_mises",]["message"] == ["stress is infinite", ""]
    last = tables["peak", "rotation"]
    assert last["message"] == ["", "rotation.wheel is not known"]
    assert tables["displacement",]["message"] == ["", "displacement is not known"]
    assert last["rotation.wheel"] == last["rotation.wheel_error"] == [None, None]
