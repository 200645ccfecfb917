"""The table of a study: all members with their outputs and verdicts, as columns, CSV, Parquet and JSON."""

import io
import json
from collections import Counter
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from bemcontact.assessment.accuracy import together
from bemcontact.cached import cached_property
from bemcontact.checks.arguments import is_real
from bemcontact.contact.record import UnitsRecord
from bemcontact.frozen import frozen, frozen_value
from bemcontact.problems.units import Units
from bemcontact.serialization import Leaf, Record, Recorded, csv_text
from bemcontact.studies.axes import Axis
from bemcontact.studies.outputs import OF_MOVERS, columns_of
from bemcontact.studies.rows import MemberRow, MemberStatus, in_one_message
from bemcontact.version import __version__
from bemcontact.views import Tabular

LEAST_BLOCK = 1 << 20
"""Bytes of JSON that are read at once, beside those of two lines."""


@frozen_value
class AxisRecord(Leaf):
    """An axis of a study."""

    name: str
    """Name of its column in the table."""
    keys: tuple[str, ...]
    """Keys of the problem that take the same value."""
    values: tuple[Any, ...]
    """Values, one after the other."""


class StudyRecord(Record):
    """A study of parameters: a grid of values, and the outputs and verdicts of each member.

    [L] is the unit of length and [p] that of pressure, force over length squared. A number without either has no unit.
    """

    name: str
    """Name of the problem."""
    version: str
    """Version of bemcontact."""
    holds: bool | None
    """Whether all members hold; null if mesh errors are not assessed."""
    counts: dict[str, int]
    """Number of members by status, in the order of the worst."""
    units: UnitsRecord
    """Labels of the units."""
    axes: list[AxisRecord]
    """What is varied; the first axis changes slowest."""
    columns: tuple[str, ...]
    """Outputs in the table."""
    rows: list[MemberRow]
    """Members in the order of the grid."""


@frozen
class StudyTable(Recorded, Tabular):
    """The rows of a study.

    Parameters
    ----------
    name : of the problem
    units : labels of the units
    axes : what is varied; the first axis changes slowest
    outputs : names of the outputs that are shown
    rows : members in the order of the grid, each with all its outputs
    """

    name: str
    units: Units
    axes: tuple[Axis, ...]
    outputs: tuple[str, ...]
    rows: tuple[MemberRow, ...]

    def __repr__(self) -> str:
        """One line: name, axes, number of members by status."""
        varied = " × ".join(f"{axis.name} ({len(axis.values)})" for axis in self.axes)
        counted = ", ".join(f"{count} {status}" for status, count in self.counts.items())
        return f"<{type(self).__name__} of {self.name!r} over {varied}: {len(self.rows)} members, {counted}>"

    @property
    def holds(self) -> bool | None:
        """Whether all members are certified and as accurate as was asked; None if mesh errors are not assessed."""
        return together(row.holds for row in self.rows)

    @cached_property
    def counts(self) -> dict[str, int]:
        """Number of members by status, the worst first."""
        counted = Counter(row.status for row in self.rows)
        return {str(status): counted[status] for status in reversed(MemberStatus) if counted[status]}

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """Names of the outputs in the table, those of all zones and movers that some member has."""
        present = dict.fromkeys(name for row in self.rows for name in row.outputs)
        return columns_of(self.outputs, [*present])

    def texts(self, row: MemberRow) -> list[str]:
        """What is to be known of a member and the outputs in the table, in sentences; of others nothing is said."""
        unknown = [name for name in self.columns if self.unknown(row, name)]
        words = f"{' and '.join(unknown)} {'is' if len(unknown) == 1 else 'are'} not known" if unknown else ""
        return [*filter(None, (row.message, *row.notes, row.stress if "von_mises" in self.outputs else "", words))]

    @staticmethod
    def unknown(row: MemberRow, column: str) -> bool:
        """Whether the amount of a motion, a rotation or the largest displacement of a member is not known."""
        moved = column.partition(".")[0] in (*OF_MOVERS, "displacement") and column in row.outputs
        return moved and row.outputs[column].value is None

    def table(self) -> dict[str, list[Any]]:
        """Return the table as a list for each column, ready for a data frame.

        Returns
        -------
        dict
            Column -> values of all members, None where there is none: ``member``; each axis by its name; ``status``,
            ``equations``, ``mesh`` and ``mesh_error`` (relative); each output, and its error in the same unit as
            ``peak_error``; ``message``.
        """
        columns: dict[str, list[Any]] = {"member": [row.number for row in self.rows]}
        for axis in self.axes:
            columns[axis.name] = [row.values[axis.name] for row in self.rows]
        columns["status"] = [str(row.status) for row in self.rows]
        columns["equations"] = [row.equations for row in self.rows]
        columns["mesh"] = [_mesh(row) for row in self.rows]
        columns["mesh_error"] = [row.mesh_error for row in self.rows]
        for name in self.columns:
            readings = [row.reading(name) for row in self.rows]
            columns[name] = [item.value for item in readings]
            columns[f"{name}_error"] = [item.error for item in readings]
        columns["message"] = [in_one_message(*self.texts(row)) for row in self.rows]
        return columns

    def to_csv(self) -> str:
        """Write the table as CSV, a line for each member; empty where there is no value."""
        columns = self.table()
        return csv_text(columns, zip(*(map(_cell, column) for column in columns.values()), strict=True))

    def save_parquet(self, path: Path) -> bool:
        """Write the table as Parquet; False without pyarrow, the extra ``parquet``."""
        if find_spec("pyarrow") is None:
            return False
        import pyarrow
        import pyarrow.json
        import pyarrow.parquet

        columns = {name: _of_one_kind(values) for name, values in self.table().items()}
        numbers = {"mesh_error", *self.columns, *(f"{name}_error" for name in self.columns)}
        kinds = {name: "float64" if name in numbers else _kind(values) for name, values in columns.items()}
        schema = pyarrow.schema([(name, pyarrow.type_for_alias(kind)) for name, kind in kinds.items()])
        # through JSON: pyarrow.array would import pandas, which takes as long as all the rest of the folder
        rows = zip(*columns.values(), strict=True)
        lines = [json.dumps(dict(zip(columns, row, strict=True))).encode() + b"\n" for row in rows]
        blocks = pyarrow.json.ReadOptions(block_size=2 * max(map(len, lines)) + LEAST_BLOCK)
        form = pyarrow.json.ParseOptions(explicit_schema=schema)
        table = pyarrow.json.read_json(io.BytesIO(b"".join(lines)), blocks, form)
        pyarrow.parquet.write_table(table, path)
        return True

    def record(self) -> StudyRecord:
        """Return the record that is written as study.json."""
        return StudyRecord(
            name=self.name,
            version=__version__,
            holds=self.holds,
            counts=self.counts,
            units=UnitsRecord(**self.units.model_dump(include={"length", "force"})),
            axes=[AxisRecord(name=axis.name, keys=axis.keys, values=axis.values) for axis in self.axes],
            columns=self.columns,
            rows=list(self.rows),
        )


def _mesh(row: MemberRow) -> str:
    """Verdict on the mesh in a column."""
    if row.status is MemberStatus.FAILED:
        return ""
    return "not assessed" if row.met is None else "met" if row.met else "not met"


def _cell(value: Any) -> str:
    """A value in a cell of CSV."""
    if value is None:
        return ""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _of_one_kind(values: Sequence[Any]) -> Sequence[Any]:
    """Values of a column as numbers, if all are, or else as texts."""
    if all(value is None or is_real(value) for value in values):
        whole = all(isinstance(value, int) for value in values)
        return values if whole else [None if value is None else float(value) for value in values]
    return [None if value is None else _cell(value) for value in values]


def _kind(values: Sequence[Any]) -> str:
    """Name that pyarrow has for the kind of values, which are of one kind or None."""
    first = next((value for value in values if value is not None), None)
    return "null" if first is None else {int: "int64", float: "float64", str: "string"}[type(first)]


def sorted_rows(rows: Mapping[int, MemberRow]) -> tuple[MemberRow, ...]:
    """Rows by number, in the order of the grid."""
    return tuple(rows[number] for number in sorted(rows))
