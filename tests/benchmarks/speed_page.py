"""The page of all benchmarks of speed: what each section measured, as Markdown and as JSON."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pydantic import JsonValue, TypeAdapter
from timing import Spread

Cell = float | int | str | Spread | None
"""None is an empty cell."""

HEAD = """\
# Speed

This command writes this page, and its numbers as JSON:

```sh
python tests/benchmarks/run.py
```

Times are CPU seconds of one thread, unless a table says *wall*. Each time is the least of several. Other work on the
machine changes CPU times too, for it takes room in caches: the machine should be idle.

The speed of a processor varies within seconds or minutes, and not alike for Python and for products of matrices. So
what is compared runs in turns, close to each other: a, b, a, b and so on. A ratio is the median of the ratios of
neighboring turns; it need not be that of the times beside it. Half of the ratios are between their quartiles. A target
is met if both quartiles meet it, and not met if neither does. Otherwise it is *within noise*: this run cannot decide.
"""


@dataclass(frozen=True, kw_only=True)
class Target:
    """A number that was asked for beside the one that was measured.

    Parameters
    ----------
    name : what is measured
    asked : largest number that is good enough, or the least one if `at_least`
    measured : of several turns, or a number without noise; None if it could not be measured
    unit : of both; empty for ratios
    """

    name: str
    asked: float
    measured: Spread | float | None
    unit: str = ""
    at_least: bool = False

    @property
    def quartiles(self) -> tuple[float, ...]:
        """Both quartiles; none of a number without noise."""
        return (self.measured.lower, self.measured.upper) if isinstance(self.measured, Spread) else ()

    @property
    def met(self) -> str:
        """Whether it is good enough beyond noise; empty if it was not measured."""
        if self.measured is None:
            return ""
        values = self.quartiles or (self.measured,)
        good = [value >= self.asked if self.at_least else value <= self.asked for value in values]
        return "yes" if all(good) else "within noise" if any(good) else "**no**"


@dataclass(frozen=True, kw_only=True)
class Table:
    """Numbers in rows.

    Parameters
    ----------
    title : one line, empty for none
    columns : format of the numbers by heading, such as ".2f"
    rows : as many cells each as there are columns
    """

    title: str = ""
    columns: Mapping[str, str]
    rows: Sequence[Sequence[Cell]]


@dataclass(frozen=True, kw_only=True)
class Section:
    """What one benchmark measured.

    Parameters
    ----------
    title : heading
    text : what is measured, and with which settings
    tables, targets : in the order of the page
    raw : other numbers, for JSON only
    """

    title: str
    text: str
    tables: Sequence[Table]
    targets: Sequence[Target] = ()
    raw: Mapping[str, JsonValue] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Settings:
    """What a run is asked for.

    Parameters
    ----------
    quick : fewer and smaller problems
    instances : folder with quadratic programs (.npz) for the local solver, besides those that are made
    earlier : commit that today's code is compared with; by default the last one before the work on speed
    """

    quick: bool = False
    instances: Path | None = None
    earlier: str = "f00bb2f3"


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """How a section ended: with what it measured, or with the reason why it failed."""

    seconds: float
    section: Section | None = None
    failed: str = ""


@dataclass(frozen=True, kw_only=True)
class Run:
    """All sections of a run.

    Parameters
    ----------
    date : when it began
    load : mean number of processes that wanted to run in the minute before
    quick : with fewer and smaller problems
    machine : names and values
    names : of all sections there are
    outcomes : of those that ran, by name
    """

    date: str
    load: float
    quick: bool
    machine: Mapping[str, str]
    names: Sequence[str]
    outcomes: Mapping[str, Outcome]

    @property
    def failed(self) -> list[str]:
        """Names of the sections that failed."""
        return [name for name, outcome in self.outcomes.items() if outcome.failed]


RUN, SECTION = TypeAdapter(Run), TypeAdapter(Section)
"""What reads and writes them as JSON."""


def markdown(run: Run) -> str:
    """The page."""
    return "\n".join([HEAD, *_beginning(run), *_targets(run), *_sections(run)])


def _beginning(run: Run) -> Iterator[str]:
    """Date, machine and failures."""
    took = sum(outcome.seconds for outcome in run.outcomes.values())
    yield f"The run of {run.date} took {took / 60:.1f} minutes. The load of the machine before was {run.load:.1f}.\n"
    if run.quick:
        yield "It was a quick run (`--quick`), with fewer and smaller problems.\n"
    if absent := [name for name in run.names if name not in run.outcomes]:
        yield f"These sections did not run: {', '.join(absent)}.\n"
    if run.failed:
        yield f"**These sections failed: {', '.join(run.failed)}.**\n"
    yield from _rows(("", ""), list(run.machine.items()))


def _targets(run: Run) -> Iterator[str]:
    rows = [
        (
            target.name,
            f"at {'least' if target.at_least else 'most'} {_number(target.asked, target.unit)}",
            "not measured" if target.measured is None else _number(target.measured, target.unit),
            " to ".join(_number(quartile) for quartile in target.quartiles),
            target.met,
        )
        for outcome in run.outcomes.values()
        for target in (outcome.section.targets if outcome.section else ())
    ]
    if rows:
        yield "## Targets\n"
        yield from _rows(("Target", "Asked", "Measured", "Quartiles", "Met"), rows)


def _number(value: Spread | float, unit: str = "") -> str:
    return f"{value:.3g} {unit}".rstrip()


def _sections(run: Run) -> Iterator[str]:
    for name, outcome in run.outcomes.items():
        section = outcome.section
        yield f"## {section.title if section else name}\n"
        if section is None:
            yield f"This section failed after {outcome.seconds:.0f} s:\n\n```text\n{outcome.failed.strip()}\n```\n"
            continue
        yield f"{section.text.strip()}\n"
        for table in section.tables:
            if table.title:
                yield f"**{table.title}**\n"
            formats = table.columns.values()
            rows = [[_cell(*pair) for pair in zip(row, formats, strict=True)] for row in table.rows]
            yield from _rows(tuple(table.columns), rows)


def _cell(value: Cell, form: str) -> str:
    if value is None:
        return ""
    return value if isinstance(value, str) else format(value, form)


def _rows(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """A table of Markdown."""
    yield f"| {' | '.join(heads)} |"
    yield "|" + "---|" * len(heads)
    yield from (f"| {' | '.join(row)} |" for row in rows)
    yield ""
