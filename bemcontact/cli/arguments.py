"""Arguments of the commands: what is said of them, and how they are read."""

import json
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from enum import StrEnum
from math import isfinite
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer

from bemcontact.cached import cached_property
from bemcontact.errors import KeyPath, OptionError, ProblemError, SpecError, escaped
from bemcontact.frozen import frozen_value
from bemcontact.options import EXPECTED_ACCURACY, ComparisonOptions, SolveOptions, StartName

Number = TypeVar("Number", int, float)

STANDARD_STREAM = Path("-")
"""The file name that means standard input or output."""


def reader(kind: type[Any], least: int | None = None, *, finite: bool = True) -> Callable[[Any], Any]:
    """A parser of an option that says in plain words what it expects."""

    def read(text: Any) -> Any:
        try:
            value = kind(text.strip() if isinstance(text, str) else text)
        except (ValueError, OverflowError):
            value = None
        if value is None or (least is not None and value < least) or (kind is float and finite and not isfinite(value)):
            hint = "; the decimal sign is a point" if kind is float and re.fullmatch(r"[-+]?\d+,\d+", text) else ""
            raise typer.BadParameter(f"expected {_expected(kind, least)}, found '{text[:40]}'{hint}")
        return value

    return read


def _expected(kind: type[Any], least: int | None) -> str:
    """Name the values that an option takes."""
    if issubclass(kind, StrEnum):
        return f"one of {', '.join(kind)}"
    return "a number" if kind is float else f"a whole number{'' if least is None else f' of at least {least}'}"


def with_default(meaning: str, default: str) -> str:
    """Help of an option whose default is no value but words."""
    return f"{meaning}  [default: {default}]"


RefineOption = Annotated[
    int, typer.Option(parser=reader(int, 1), metavar="K", help="Split each element into K equal parts.")
]
read_number = reader(float)


def read_quantity(text: Any) -> float | str:
    """Read a number; one with a unit stays a text."""
    from bemcontact.problems.quantities import QUANTITY

    return text if isinstance(text, str) and QUANTITY.fullmatch(text) else read_number(text)


def read_accuracy(text: Any) -> float:
    """Read a relative accuracy; one in percent is refused with what to write."""
    written = str(text).strip()
    value = read_number(written.removesuffix("%"))
    if 0 < value < 1 and "%" not in written:
        return value
    percent = value if 0 < value < 100 else 1
    hint = f"write {percent / 100:.12g} for {percent:.12g} percent"
    raise typer.BadParameter(f"{EXPECTED_ACCURACY}, found '{written[:40]}'; {hint}")


FigureOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Draw a picture; FILE ends in .png, .svg or .pdf.", show_default=False),
]
JsonOption = Annotated[
    Path | None,
    typer.Option("--json", metavar="FILE", help="Write all results; - for standard output.", show_default=False),
]


@frozen_value
class Source:
    """The spec that a command reads, with the changes made to it on the command line."""

    spec: Annotated[
        Path,
        typer.Argument(
            metavar="SPEC", help="Problem file to read, in YAML (a spec); - for standard input.", show_default=False
        ),
    ]
    overrides: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY.PATH=VALUE",
            help="Replace one value of the spec before it is checked. It may be given several times. "
            "It adds no zone, tool or load case.",
            show_default=False,
        ),
    ] = None
    variant: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Take a variant of the spec; check lists them. --set changes the variant.",
            show_default=False,
        ),
    ] = None
    case: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Apply one load case or combination of the spec; check lists them.",
            show_default=False,
        ),
    ] = None

    accuracy: Annotated[
        float | None,
        typer.Option(
            metavar="X",
            parser=read_accuracy,
            help=with_default(
                "Find a mesh on which no error bar is larger than X, relative: 0.003 is 0.3 percent.", "as in the spec"
            ),
            show_default=False,
        ),
    ] = None

    def __post_init__(self) -> None:
        """Refuse a change without its value, which would be taken for another argument."""
        for setting in self.overrides or ():
            if "=" not in setting:
                raise OptionError(f"--set {escaped(setting)}: there is no '='; write --set {escaped(setting)}=VALUE")

    @property
    def changes(self) -> list[str]:
        """All changes as --set writes them."""
        return [change for change, _ in self._options_of_changes()]

    def _options_of_changes(self) -> Iterator[tuple[str, str]]:
        """Each change, and the option that made it."""
        yield from ((setting, f"--set {setting}") for setting in self.overrides or ())
        for key, value in (("case", self.case), ("accuracy", self.accuracy)):
            if value is not None:
                yield f"{key}={json.dumps(value)}", f"--{key} {value}"

    def _in_options(self, error: SpecError) -> SpecError:
        """An error whose lines name options where those of a library call name a variant or an override."""
        lines = str(error).split("\n")
        pairs = [(f"override {escaped(change)}: ", option) for change, option in self._options_of_changes()]
        variant = f"variant {self.variant or repr(self.variant)}"
        for said, option in (*pairs, (f"{variant}: ", f"--{variant}")):
            lines = [f"{option}: {line.removeprefix(said)}" if line.startswith(said) else line for line in lines]
        return SpecError("\n".join(lines))

    @property
    def name(self) -> str:
        """Name of the spec in messages."""
        return "standard input" if self.spec == STANDARD_STREAM else str(self.spec)

    @cached_property
    def text(self) -> str:
        """Text of the spec, read once."""
        from bemcontact.files.text import MOST_BYTES, decoded, text_of

        if self.spec == STANDARD_STREAM:
            if sys.stdin is None:  # the shell has closed it, as with <&-
                raise SpecError("standard input is closed; name a file, or send the spec to standard input")
            return decoded(sys.stdin.buffer.read(MOST_BYTES + 1), self.name)
        return text_of(self.spec)

    def problem(self, refine: int = 1):  # its type costs the time of importing it
        """Read the problem, with each element split."""
        from bemcontact import spec

        try:
            return spec.loads(self.text, self.name, self.changes, self.variant).refined(refine)
        except SpecError as error:
            raise self._in_options(error) from None
        except ProblemError as error:
            raise OptionError(f"--refine {refine}: {'; '.join(issue.message for issue in error.issues)}") from None

    def readable(self):
        """What can be read of a problem that is refused, for a picture; None without a sound boundary."""
        from bemcontact import spec

        return spec.readable(self.text, self.name, self.changes, self.variant)

    def as_run(self) -> str:
        """The spec with all changes, as YAML."""
        from bemcontact import spec

        return spec.as_run(self.text, self.name, self.changes, self.variant)

    def located(self, error: ProblemError) -> str:
        """The text of an error with file, line and column."""
        from bemcontact import spec

        return str(self._in_options(spec.located(error, self.text, self.name, self.changes, self.variant)))


def option(kind: type[SolveOptions | ComparisonOptions], name: str) -> Any:
    """An option of the command line as `SolveOptions` or `ComparisonOptions` declares it."""
    item = kind.__dataclass_fields__[name]
    about, default = item.metadata, item.default
    parser, metavar = None, about["metavar"]
    if name == "start":
        parser = _start
    elif about["least"] is not None:
        parser = reader(int, about["least"])
    elif isinstance(default, StrEnum):
        parser, metavar = reader(type(default)), f"<{'|'.join(type(default))}>"
    elif isinstance(default, float):
        parser = reader(float, finite=False)  # the options state the range
    meaning, shown = about["meaning"], about["shown"]
    if isinstance(shown, str):
        meaning, shown = with_default(meaning, shown), False
    return typer.Option(metavar=metavar, help=meaning, show_default=shown, parser=parser)


def _start(text: str) -> StartName | Path:
    """Read --start: a name, or else a file."""
    if not text.strip():
        raise typer.BadParameter(f"expected {', '.join(StartName)} or the name of a file, found nothing")
    if text in [*StartName]:
        return StartName(text)
    path = Path(text)
    meant = get_close_matches(text.lower(), [*StartName], n=1)
    if meant and path.name == text and not path.suffix and not path.exists():
        raise typer.BadParameter(f"there is no file '{text}'; did you mean {meant[0]}?")
    return path


@contextmanager
def by_option(option: str, room: KeyPath | None = None, located: Callable[[Any], str] = str) -> Iterator[None]:
    """Let errors of an argument begin with its option; with a room, only those about this key of a problem."""
    try:
        yield
    except (ProblemError, SpecError) as error:
        issues = error.issues if isinstance(error, ProblemError) else ()
        if room is not None and any(issue.path[:1] != room for issue in issues):
            raise
        raise OptionError(f"{option}: {located(error)}") from None


def names(text: str) -> list[str]:
    """Read names with commas between them, in any case."""
    return [item.strip().lower() for item in text.split(",")]


def several(text: str, option: str, kind: str, read: Callable[[str], Number]) -> list[Number]:
    """Read numbers with commas between them; `OptionError` says which one is not of the kind."""
    numbers = []
    for item in text.split(","):
        try:
            numbers.append(read(item))
        except ValueError:
            message = f"{option}: expected {kind}s with commas between, found '{item.strip()}'"
            raise OptionError(message) from None
    return numbers
