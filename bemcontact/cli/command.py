"""Common parts of all commands: arguments, checks of outputs, progress, results, exit status."""

import inspect
import json
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass
from enum import StrEnum
from functools import cached_property, wraps
from math import isfinite
from pathlib import Path
from typing import Annotated, Any, NoReturn, TypeVar, get_type_hints

import typer

from bemcontact.checks.memory import ensure_memory
from bemcontact.cli.terminal import RenderableType, Report, show, stages, standard_output, tell
from bemcontact.errors import BemContactError, NotConvexError, OptionError, ProblemError, SpecError, escaped
from bemcontact.files import output
from bemcontact.options import ComparisonOptions, SolveOptions, StartName

Number = TypeVar("Number", int, float)

UNCERTIFIED, BAD_INPUT, INTERRUPTED = 1, 2, 130
"""Exit statuses other than 0."""
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
PERCENT = re.compile(r"\s*(\d+(\.\d*)?|\.\d+)\s*%?\s*")


def read_accuracy(text: Any) -> float:
    """Read a relative accuracy; one in percent is refused with what to write."""
    if isinstance(text, str) and (percent := PERCENT.fullmatch(text)):
        value = float(percent[1])
        if 0 < value < 1 and "%" not in text:
            return value
        if 0 < value < 100:
            raise typer.BadParameter(
                f"expected a relative accuracy between 0 and 1, found '{text.strip()[:40]}'; "
                f"write {value / 100:.12g} for {value:.12g} %"
            )
    value = read_number(text)
    if not 0 < value < 1:
        raise typer.BadParameter(
            f"expected a relative accuracy between 0 and 1, such as 0.01 for 1 %, found '{str(text)[:40]}'"
        )
    return value


FigureOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Draw a picture; FILE ends in .png, .svg or .pdf.", show_default=False),
]
JsonOption = Annotated[
    Path | None,
    typer.Option("--json", metavar="FILE", help="Write all results; - for standard output.", show_default=False),
]


@dataclass(frozen=True, kw_only=True)
class Source:
    """The spec that a command reads, with the changes made to it on the command line."""

    spec: Annotated[
        Path,
        typer.Argument(metavar="SPEC", help="Problem to read, a YAML file; - for standard input.", show_default=False),
    ]
    overrides: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY.PATH=VALUE",
            help="Replace one value of the spec, stated or at its default, before it is checked; repeatable. "
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
        options = {"case": self.case, "accuracy": self.accuracy}
        stated = [f"{key}={json.dumps(value)}" for key, value in options.items() if value is not None]
        return [*(self.overrides or ()), *stated]

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

        problem = spec.loads(self.text, self.name, self.changes, self.variant)
        try:
            return problem.refined(refine)
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

        return str(spec.located(error, self.text, self.name, self.changes, self.variant))


def option(kind: type[SolveOptions | ComparisonOptions], name: str) -> Any:
    """An option of the command line as `SolveOptions` or `ComparisonOptions` declares it."""
    item = next(item for item in fields(kind) if item.name == name)
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
    return StartName(text) if text in [*StartName] else Path(text)


def flattened(command: Callable[..., None]) -> Callable[..., None]:
    """Replace each parameter of a command that is a dataclass by the fields of it, which typer can read."""
    hints = get_type_hints(command, include_extras=True)
    groups = {name: kind for name, kind in hints.items() if isinstance(kind, type) and is_dataclass(kind)}
    parameters = list[inspect.Parameter]()
    for parameter in inspect.signature(command).parameters.values():
        if kind := groups.get(parameter.name):
            parameters.extend(_parameters_of(kind))
        else:
            parameters.append(parameter.replace(kind=parameter.KEYWORD_ONLY, annotation=hints[parameter.name]))

    @wraps(command)
    def run(context: typer.Context, **given: Any) -> None:
        with reported():
            for name, kind in groups.items():
                given[name] = kind(**{item.name: given.pop(item.name) for item in fields(kind)})
            _refuse_extra(context.args, context.command_path)
        command(**given)

    parameters.append(inspect.Parameter("context", inspect.Parameter.KEYWORD_ONLY, annotation=typer.Context))
    run.__signature__ = inspect.Signature(parameters)  # pyright: ignore[reportAttributeAccessIssue]
    run.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return run


def _refuse_extra(arguments: Sequence[str], command: str) -> None:
    """Refuse arguments that no parameter takes."""
    for argument in arguments[:1]:
        hint = f"write --set {argument}" if "=" in argument else f"an option has one value, see {command} --help"
        raise OptionError(escaped(f"the argument '{argument}' is not expected; {hint}"))


def help_of(command: Callable[..., None]) -> str:
    """Help of a command, from its docstring; the lines of its examples are not folded."""
    return inspect.cleandoc(command.__doc__ or "").replace("\n\nExamples\n", "\n\n\b\nExamples\n")


def _parameters_of(group: Any) -> Iterator[inspect.Parameter]:
    """The parameters that stand for the fields of a dataclass."""
    hints = get_type_hints(group, include_extras=True)
    for item in fields(group):
        annotation = hints[item.name]
        if group is SolveOptions:
            read = Any if item.name == "start" else annotation  # by a parser
            annotation = Annotated[read, option(group, item.name)]
        default = {} if item.default is item.default_factory else {"default": item.default}
        yield inspect.Parameter(item.name, inspect.Parameter.KEYWORD_ONLY, annotation=annotation, **default)


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


@dataclass(frozen=True, kw_only=True)
class CommandOutput:
    """Output of a command: table, JSON, exit status, and the reason of a status that is not 0."""

    summary: Callable[[], RenderableType]
    json: Callable[[], str] = str
    holds: bool = True
    verdict: str = ""
    claim: str = "certified"


def run(
    stage: str,
    work: Callable[[Report], CommandOutput],
    *,
    source: Source | None = None,
    files: Mapping[str, Path | None] | None = None,
    folder: Path | None = None,
    kind: str = "report",
    json_file: Path | None = None,
) -> NoReturn:
    """Run a command: check outputs, do the work with progress, write and print results, exit with the status."""
    files = {**(files or {}), "--json": None if json_file == STANDARD_STREAM else json_file}
    with reported(source, (folder, *files.values())), stages() as report:
        ensure_memory()
        check_outputs(source, files)
        check_folder(source, folder, files["--json"], kind)
        report(stage, "")
        outcome = work(report)
        if path := files["--json"]:
            with output.whole_file(path) as temporary:
                temporary.write_text(outcome.json() + "\n", encoding="utf-8")
    with reported(source):
        if json_file != STANDARD_STREAM:
            show(outcome.summary())
        else:
            write_json(outcome.json())
            if not outcome.holds:
                tell(f"not {outcome.claim}: ", outcome.verdict)
    raise typer.Exit(0 if outcome.holds else UNCERTIFIED)


def check_outputs(source: Source | None, files: Mapping[str, Path | None]) -> None:
    """Refuse files (by option) that cannot be written, or that would overwrite another, before any work is done."""
    taken = {output.real(path): "the spec itself" for path in _spec_file(source)}
    for option, path in files.items():
        if path is None:
            continue
        try:
            target = output.real(path)
            _ensure_possible(option, path)
            output.ensure_writable(path)
        except (OSError, ValueError, ModuleNotFoundError) as error:
            refuse(escaped(f"{option}: {_reason(error)}"))
        if target in taken:
            refuse(escaped(f"{option} {path} would overwrite {taken[target]}; name another file"))
        taken[target] = f"the file of {option}"


def _spec_file(source: Source | None) -> list[Path]:
    """The file of a spec, if there is one."""
    return [] if source is None or source.spec == STANDARD_STREAM else [source.spec]


def _reason(error: Exception) -> str:
    """Text of an error; of one by the system, the file and what is wrong, without its number."""
    if isinstance(error, OSError) and error.errno and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return str(error)


def check_folder(source: Source | None, folder: Path | None, json_file: Path | None, kind: str) -> None:
    """Refuse a folder that cannot be written, or that would replace the spec or the file of --json."""
    if folder is None:
        return
    from bemcontact.report.folder import KINDS, ensure_folder_writable

    try:
        target = output.real(folder)
        for path in (*_spec_file(source), *([] if json_file is None else [json_file])):
            if target in (output.real(path), *output.real(path).parents):
                refuse(escaped(f"--out {folder} would replace {path}; name another folder"))
        ensure_folder_writable(folder, KINDS[kind])
    except OSError as error:
        refuse(escaped(f"--out: {_reason(error)}"))


def _ensure_possible(option: str, path: Path) -> None:
    """Refuse names of files that cannot be written in the format of an option."""
    match option:
        case "--figure":
            from bemcontact.report import figures

            figures.ensure_known_format(path)
        case "--vtk":
            from bemcontact.report import vtk

            vtk.ensure_possible(path)
        case "--out" if path.suffix != ".npz":
            raise ValueError(f"{path}: the file name of a condensed problem must end in .npz")


def write_json(text: str) -> None:
    """Write JSON on standard output, in UTF-8 whatever the encoding of the terminal."""
    with standard_output():
        typer.echo(text.encode() + b"\n", nl=False)


def refuse(message: str) -> NoReturn:
    """Print an error of the input and end."""
    tell("error: ", message)
    raise typer.Exit(BAD_INPUT)


@contextmanager
def reported(source: Source | None = None, outputs: Sequence[Path | None] | None = None) -> Iterator[None]:
    """Turn each error that is raised on purpose into one text on standard error and an exit status.

    After an interrupt the text names the outputs written by then; with outputs None it says nothing of them.
    """
    before = {path: _identity(path) for path in outputs or () if path is not None}
    try:
        yield
    except KeyboardInterrupt:
        written = [str(path) for path, identity in before.items() if _identity(path) != identity]
        so_far = f"; {', '.join(written) or 'nothing'} was written" if outputs is not None else ""
        tell("interrupted", so_far)
        raise typer.Exit(INTERRUPTED) from None
    except BrokenPipeError:
        raise
    except (SpecError, OptionError, NotConvexError) as error:
        refuse(str(error))
    except ProblemError as error:
        refuse(str(error) if source is None else source.located(error))
    except OSError as error:
        refuse(escaped(_reason(error)))
    except BemContactError as error:
        tell("failed: ", str(error))
        raise typer.Exit(UNCERTIFIED) from error
    except MemoryError as error:
        reason = f" ({error})" if error.args else ""
        tell("failed: ", f"there is not enough memory{reason}; take fewer elements, or raise the limit")
        raise typer.Exit(UNCERTIFIED) from error


def _identity(path: Path) -> int | None:
    """Inode of a file or folder, which is another one after it was replaced as a whole; None if there is none."""
    try:
        return path.stat().st_ino
    except OSError:
        return None
