"""The page of a study of parameters, its summary in the terminal, and its rows in a notebook."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from html import escape
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from bemcontact.errors import escaped_lines
from bemcontact.problems.units import Units
from bemcontact.report.bars import NOTHING, error_percent, with_error
from bemcontact.report.formatting import number, plural, seconds_in_words, sentence_case, with_unit
from bemcontact.report.notes_of_members import stated_once
from bemcontact.report.page import picture, template
from bemcontact.report.tables import add, list_of_facts, table_of
from bemcontact.report.text import add_verdict
from bemcontact.report.verdicts import Verdict
from bemcontact.studies.outputs import DIMENSIONS, Reading
from bemcontact.studies.rows import MemberRow, MemberStatus
from bemcontact.studies.table import StudyTable

MOST_ROWS = 2000
"""Largest number of rows on a page; the tables beside it have all."""
MOST_NAMED = 5
"""Members that do not hold, and that are named in the terminal."""
IN_SHORT = 10
"""Rows in a notebook."""
QUALITY = {
    MemberStatus.HOLDS: "good",
    MemberStatus.NOT_ASSESSED: "fair",
    MemberStatus.NOT_MET: "fair",
    MemberStatus.NOT_CERTIFIED: "bad",
    MemberStatus.FAILED: "bad",
}
"""Status of a member -> quality."""
ERRORS = (
    "Numbers after ± are estimated errors, from the change of each number when every element is cut in two. They are "
    "not proved."
)
UNKNOWN = "not known"
"""Text for the amount of a motion that nothing determines."""


def study_verdicts(study: StudyTable) -> tuple[Verdict, Verdict]:
    """Verdicts on the equations and on the meshes of all members together."""
    total, rows = len(study.rows), study.rows
    bad = sum(not row.certified for row in rows)
    word = "all proved" if not bad else f"{bad} of {total} not proved"
    words = "Each member has a unique solution that is proved."
    if bad:
        words = _sentence(next(row for row in rows if not row.certified))
    equations = Verdict("Equations", "bad" if bad else "good", word, words)
    done = [row for row in rows if row.status is not MemberStatus.FAILED]
    return equations, _mesh_verdict(done, "Each member" if len(done) == total else "Each member that has a result")


def _mesh_verdict(rows: list[MemberRow], each: str) -> Verdict:
    """Verdict on the meshes of the members that have a result, and how all of them are called."""
    unmet = [row for row in rows if row.met is False]
    unknown = [row for row in rows if row.met is None]
    if unmet:
        return Verdict("Mesh", "fair", f"not met by {len(unmet)} of {len(rows)}", _sentence(unmet[0]))
    if unknown:
        word = "not assessed" if len(unknown) == len(rows) else f"not assessed for {len(unknown)} of {len(rows)}"
        return Verdict("Mesh", "fair", word, "No accuracy is asked for, or errors were not estimated.")
    worst = max((row.mesh_error or 0.0 for row in rows), default=0.0)
    word = f"error at most {error_percent(worst)}" if rows else "no member has a result"
    return Verdict("Mesh", "good" if rows else "bad", word, f"{each} is as accurate as was asked." if rows else "")


def _left_out(study: StudyTable) -> str:
    """Of how many members error bars do not include something, and the first note on it; empty if there are none."""
    beyond = [row for row in study.rows if row.holds is not False and row.notes]
    if not beyond:
        return ""
    first = replace(beyond[0], message=beyond[0].notes[0])
    return f"Error bars of {len(beyond)} {plural('member', len(beyond))} leave something out. {_sentence(first)}"


def _sentence(row: MemberRow) -> str:
    """What is wrong with a member, in a sentence that names it."""
    text = sentence_case(row.message or f"{row.status}")
    return f"Member {row.number} ({values_in_words(row)}): {text}{'' if text.endswith('.') else '.'}"


def values_in_words(row: MemberRow) -> str:
    """The values of a member: ``conditions.top.pressure = 10, variant = fine``."""
    return ", ".join(f"{key} = {value_in_words(value)}" for key, value in row.values.items())


def value_in_words(value: Any) -> str:
    """A value on an axis."""
    match value:
        case float():
            return f"{value:.10g}"
        case list():
            return f"[{', '.join(map(value_in_words, value))}]"
        case dict():
            return f"{{{', '.join(f'{key}: {value_in_words(item)}' for key, item in value.items())}}}"
    return str(value)


def unit_of_output(column: str, units: Units) -> str:
    """Label of the unit of an output; empty for numbers and where a label is missing."""
    quantity = column.partition(".")[0]
    if quantity == "rotation":
        return "rad"
    attribute = DIMENSIONS.get(quantity, "")
    return getattr(units, attribute) if attribute else ""


def reading_in_words(reading: Reading) -> str:
    """A number with its error; a dash where there is none."""
    if reading.value is None:
        return NOTHING
    return with_error(reading.value, reading.error) if reading.error else number(reading.value)


def render(study: StudyTable, pictures: Mapping[str, bytes], spec: str | None) -> str:
    """Write the page of a study as HTML that needs no other file; `pictures` are SVG files by their captions."""
    verdicts = study_verdicts(study)
    texts, notes = stated_once([[*map(sentence_case, study.texts(row))] for row in study.rows[:MOST_ROWS]])
    return template("study.html").render(
        study=study,
        version=study.record().version,
        verdicts=verdicts,
        overall=_overall(study),
        counts=[(status, count, QUALITY[MemberStatus(status)]) for status, count in study.counts.items()],
        axes=[
            (axis.name, axis.keys if axis.keys != (axis.name,) else (), *_extent(axis.values)) for axis in study.axes
        ],
        ranged=sentence_case(_ranged(study)),
        left_out=_left_out(study),
        ranges=[(name, *_range_of(study, name)) for name in study.columns],
        columns=[(name, unit_of_output(name, study.units)) for name in study.columns],
        rows=[*zip(_cells(study, MOST_ROWS), texts, strict=True)],
        notes=notes,
        most=MOST_ROWS,
        pictures=[
            picture(svg, caption, f"{caption}, with error bars; members that do not hold are marked")
            for caption, svg in pictures.items()
        ],
        errors=ERRORS,
        spec=spec,
    )


def _overall(study: StudyTable) -> str:
    """Quality of the worst member."""
    qualities = {QUALITY[row.status] for row in study.rows}
    return next((quality for quality in ("bad", "fair", "good") if quality in qualities), "bad")


def _extent(values: tuple[Any, ...]) -> tuple[int, str]:
    """Number of values on an axis, and which they are."""
    words = [*map(value_in_words, values)]
    return len(words), ", ".join(words) if len(words) <= 12 else f"{', '.join(words[:3])}, …, {words[-1]}"


def _cells(study: StudyTable, most: int) -> Iterator[dict[str, Any]]:
    """Cells of each row."""
    for row in study.rows[:most]:
        yield {
            "number": row.number,
            "values": [value_in_words(value) for value in row.values.values()],
            "status": str(row.status),
            "quality": QUALITY[row.status],
            "mesh": NOTHING if row.mesh_error is None else error_percent(row.mesh_error),
            "outputs": [
                UNKNOWN if study.unknown(row, name) else reading_in_words(row.reading(name)) for name in study.columns
            ],
        }


def study_summary(study: StudyTable, seconds: float, place: str | None = None) -> RenderableType:
    """List axes, the range of each output, the members that do not hold, and the verdicts."""
    axes = table_of("varied", "values")
    for axis in study.axes:
        count, words = _extent(axis.values)
        axes.add_row(*map(Text, (axis.name, f"{count}: {words}")))
    outputs = table_of(_ranged(study), "smallest", "at", "largest", "at ")
    for name in study.columns:
        outputs.add_row(*map(Text, (name, *_range_of(study, name))))
    shown = list_of_facts()
    for status, count in study.counts.items():
        add(shown, sentence_case(status), f"{count} {plural('member', count)}")
    verdicts = study_verdicts(study)
    short = [row for row in study.rows if row.holds is False]
    for row in short[:MOST_NAMED]:
        if not any(_sentence(row) in verdict.words for verdict in verdicts):
            add(shown, "Note", _sentence(row))
    if len(short) > MOST_NAMED:
        add(shown, "Note", f"{len(short) - MOST_NAMED} further members do not hold; the table has the reason of each")
    if left_out := _left_out(study):
        add(shown, "Note", left_out)
    if place is not None:
        add(shown, "Written", place)
    for verdict in verdicts:
        add_verdict(shown, verdict)
    how = f"{len(study.rows)} {plural('member', len(study.rows))}, {seconds_in_words(seconds)}"
    return Group(Text(study.name, "bold"), Text(how, "dim"), "", axes, "", outputs, "", shown)


def _ranged(study: StudyTable) -> str:
    """Head of a column of outputs beside their ranges: of how many members these are."""
    holding = sum(row.holds is not False for row in study.rows)
    return "output" if holding == len(study.rows) else f"output of the {holding} that hold{'s' * (holding == 1)}"


def _range_of(study: StudyTable, column: str) -> tuple[str, str, str, str]:
    """Smallest and largest value of an output among the members that hold, each with its member."""
    unit = unit_of_output(column, study.units)
    rows = [row for row in study.rows if row.holds is not False and row.reading(column).value is not None]
    if not rows:
        word = UNKNOWN if any(study.unknown(row, column) for row in study.rows) else NOTHING
        return word, "", word, ""
    values = [float(f"{row.reading(column).value:.9g}") for row in rows]  # of equal ones the first, not by round-off
    ends = (rows[values.index(pick(values))] for pick in (min, max))
    (low, at_low), (high, at_high) = (
        (with_unit(reading_in_words(row.reading(column)), unit), f"member {row.number}") for row in ends
    )
    return low, at_low, high, at_high


def rows_in_short(study: StudyTable) -> str:
    """The line of `repr` and the first rows as an HTML table, for a notebook."""
    names = [axis.name for axis in study.axes]
    head = "".join(f"<th>{_html(name)}</th>" for name in (*names, "status", *study.columns))
    rows = ((*item["values"], item["status"], *item["outputs"]) for item in _cells(study, IN_SHORT))
    body = "".join("<tr>" + "".join(f"<td>{_html(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<p>{_html(repr(study))}</p><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _html(text: str) -> str:
    """Text in HTML without hidden characters."""
    return escape(escaped_lines(text))


def study_shortfall(study: StudyTable) -> str:
    """Why a study does not hold."""
    return "; ".join(f"{item.of}: {item.word}. {item.words}" for item in study_verdicts(study) if not item.good)
