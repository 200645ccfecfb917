"""What can go wrong on purpose: one text on standard error, and an exit status."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

import typer

from bemcontact.cli.terminal import tell
from bemcontact.errors import BemContactError, NotConvexError, OptionError, ProblemError, SpecError
from bemcontact.files import output

UNCERTIFIED, BAD_INPUT, INTERRUPTED = 1, 2, 130


def claim(spec: Path | None, outputs: Mapping[str, Path | None]) -> None:
    """Refuse files (by option) that cannot be written, or that would overwrite another, before any work is done."""
    claimed = {} if spec is None else {spec.resolve(): "the spec itself"}
    for option, path in outputs.items():
        if path is None:
            continue
        if path.resolve() in claimed:
            refuse(f"{option} {path} would overwrite {claimed[path.resolve()]}; name another file")
        claimed[path.resolve()] = f"the file of {option}"
        try:
            _ensure_possible(option, path)
            output.ensure_writable(path)
        except (OSError, ValueError, ModuleNotFoundError) as error:
            refuse(f"{option}: {error}")


def claim_folder(
    spec: Path | None, option: str, folder: Path | None, beside: Path | None, kind: str = "report"
) -> None:
    """Likewise for the folder of a report, or another kind, with the spec and another file outside of it."""
    if folder is None:
        return
    for path in (spec, beside):
        if path is not None and folder.resolve() in (path.resolve(), *path.resolve().parents):
            refuse(f"{option} {folder} would replace {path}; name another folder")
    from bemcontact.report.folder import KINDS, ensure_folder_writable

    try:
        ensure_folder_writable(folder, KINDS[kind])
    except OSError as error:
        refuse(f"{option}: {error}")


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
            raise ValueError(f"{path}: a condensed problem is written as .npz; end the file name in it")


def write_json(text: str) -> None:
    """Write JSON on standard output, which is UTF-8 whatever the terminal speaks."""
    typer.echo(text.encode() + b"\n", nl=False)


def refuse(message: str) -> NoReturn:
    """Say what is wrong with the input and end."""
    tell("error: ", message)
    raise typer.Exit(BAD_INPUT)


@contextmanager
def told(
    spec: Path | None = None,
    overrides: Sequence[str] | None = None,
    variant: str | None = None,
    outputs: Sequence[Path | None] | None = None,
) -> Iterator[None]:
    """Turn all that can go wrong on purpose into one text on standard error, about a spec, and an exit status.

    An interrupt is told with what has been written by then of the outputs; with None there is nothing to say of them.
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
        if spec is None:
            refuse(str(error))
        from bemcontact import spec as spec_file

        refuse(str(spec_file.located(error, spec, overrides or (), variant)))
    except OSError as error:
        where = error.filename or ("standard output" if error.errno else "")
        refuse(f"{where}: {error.strerror}" if where else str(error))
    except BemContactError as error:
        tell("failed: ", str(error))
        raise typer.Exit(UNCERTIFIED) from error
    except MemoryError as error:
        tell("failed: ", "not enough memory for so many elements; take a smaller --refine")
        raise typer.Exit(UNCERTIFIED) from error


def _identity(path: Path) -> int | None:
    """Tell a file or folder from one that takes its place: they appear whole, under a number of their own."""
    try:
        return path.stat().st_ino
    except OSError:
        return None
