"""Common parts of all commands: arguments, checks of outputs, progress, results, exit status."""

import gc
import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, NoReturn, get_type_hints

import typer
from typer.core import TyperCommand, TyperGroup

from bemcontact.checks.docstrings import docstring
from bemcontact.checks.memory import ensure_memory
from bemcontact.cli.arguments import STANDARD_STREAM, Source, option
from bemcontact.cli.terminal import (
    RenderableType,
    Report,
    ensure_standard_output,
    show,
    stages,
    standard_output,
    tell,
)
from bemcontact.errors import BemContactError, NotConvexError, OptionError, ProblemError, SpecError, escaped
from bemcontact.files import output
from bemcontact.frozen import frozen_value
from bemcontact.options import MEANT, SolveOptions

UNCERTIFIED, BAD_INPUT, INTERRUPTED = 1, 2, 130
"""Exit statuses other than 0."""
IN_FILE = ("units", "unit", "material", "e")
"""Options that others have for what a spec states."""
COMMANDS = {
    "solve": ("run", "calculate", "compute", "analyze", "start", "execute"),
    "check": ("validate", "verify", "mesh", "show", "info", "lint", "test", "plot", "view", "draw"),
    "study": ("sweep", "vary", "batch"),
    "--help": ("help",),
    "--version": ("version",),
}
"""Command or option -> what others call it."""


class MeaningCommand(TyperCommand):
    """A command that names the option which is meant by another word for it."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse arguments; of an unknown option, name that with the nearest meaning, or the commands that have it."""
        own = {name for parameter in self.params for name in parameter.opts}
        try:
            return super().parse_args(ctx, args)
        except Exception as error:  # the class of the parser's error is not public
            word = str(getattr(error, "option_name", "")).strip("-").lower().replace("_", "-")
            if not hasattr(error, "possibilities"):
                raise
            unknown = f"No such option: {vars(error).get('option_name')}"
            wanted = [option for option, words in MEANT.items() if word in words or option == f"--{word}"]
            others = ctx.parent.command.commands if ctx.parent else {}
            elsewhere = [
                name
                for name, command in others.items()
                if any(option in parameter.opts for parameter in command.params for option in wanted)
            ]
            if meant := [option for option in wanted if option in own]:
                vars(error)["possibilities"] = meant
            elif word in IN_FILE:
                vars(error).update(possibilities=None, message=f"{unknown}; it stands in the spec")
            elif elsewhere:
                which = f"{wanted[0]} is an option of {', '.join(elsewhere)}"
                vars(error).update(possibilities=None, message=f"{unknown}; {which}")
            raise


class MeaningGroup(TyperGroup):
    """The commands, of which that is named which is meant by another word for it."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find a command; of an unknown one, name that with the nearest meaning."""
        try:
            return super().resolve_command(ctx, args)
        except Exception as error:  # likewise
            meant = [name for name, words in COMMANDS.items() if args and args[0].lower() in words]
            if meant and hasattr(error, "message"):
                vars(error)["message"] = f"No such command '{args[0]}'. Did you mean '{meant[0]}'?"
            raise


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
    return docstring(command).replace("\n\nExamples\n", "\n\n\b\nExamples\n")


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


@contextmanager
def modules() -> Iterator[bool]:
    """Read the modules of a command; in the program, garbage is searched for from then on, but not among them.

    Yields whether this process is the program, and not one that calls the command, such as that of a test.
    """
    in_program = not gc.isenabled()
    gc.disable()
    try:
        yield in_program
    finally:
        if in_program:
            gc.freeze()
        gc.enable()


@frozen_value
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
    before = {path: _identity(path) for path in (folder, *files.values()) if path is not None}
    with reported(source, before), stages() as report:
        ensure_memory()
        check_outputs(source, files)
        check_folder(source, folder, files["--json"], kind)
        report(stage, "")
        outcome = work(report)
        if path := files["--json"]:
            with output.whole_file(path) as temporary:
                temporary.write_text(outcome.json() + "\n", encoding="utf-8")
    with reported(source, before):
        if json_file != STANDARD_STREAM:
            show(outcome.summary())
        else:
            write_json(outcome.json())
            if not outcome.holds:
                tell(f"not {outcome.claim}: ", outcome.verdict)
    raise typer.Exit(0 if outcome.holds else UNCERTIFIED)


def check_outputs(source: Source | None, files: Mapping[str, Path | None]) -> None:
    """Refuse files (by option) that cannot be written, or that would overwrite another, before any work is done."""
    taken = {output.real(path): "the problem file itself" for path in _spec_file(source)}
    for name, path in files.items():
        if path is None:
            continue
        try:
            target = output.real(path)
            _ensure_possible(name, path)
            output.ensure_writable(path)
        except (OSError, ValueError, ModuleNotFoundError) as error:
            refuse(escaped(f"{name}: {_reason(error)}"))
        if target in taken:
            refuse(escaped(f"{name} {path} would overwrite {taken[target]}; name another file"))
        taken[target] = f"the file of {name}"


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
    from bemcontact.report.folder_kinds import KINDS, ensure_folder_writable

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
        case "--animation":
            from bemcontact.report import figures

            figures.ensure_known_animation(path)
        case "--vtk":
            from bemcontact.report import vtk

            vtk.ensure_possible(path)
        case "--out" if path.suffix != ".npz":
            raise ValueError(f"{path}: the file name of a condensed problem must end in .npz")


def write_json(text: str) -> None:
    """Write JSON on standard output, in UTF-8 whatever the encoding of the terminal."""
    ensure_standard_output()
    with standard_output():
        typer.echo(text.encode() + b"\n", nl=False)


def refuse(message: str) -> NoReturn:
    """Print an error of the input and end."""
    tell("error: ", message)
    raise typer.Exit(BAD_INPUT)


@contextmanager
def reported(source: Source | None = None, before: Mapping[Path, int | None] | None = None) -> Iterator[None]:
    """Turn each error that is raised on purpose into one text on standard error and an exit status.

    `before` has the identity of each output before the run, so that the text after an interrupt names those that were
    written by then; without it, the text says nothing of them.
    """
    try:
        yield
    except KeyboardInterrupt as interrupt:
        written = [str(path) for path, identity in (before or {}).items() if _identity(path) != identity]
        so_far = f"; {', '.join(written) or 'no file'} {'were' if len(written) > 1 else 'was'} written"
        tell("interrupted", str(interrupt) or ("" if before is None else so_far))
        raise typer.Exit(INTERRUPTED) from None
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
