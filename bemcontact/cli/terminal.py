"""Output on a terminal: renderables, one-line messages, and progress."""

import os
import re
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console, RenderableType
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.segment import Segments
from rich.text import Text

from bemcontact.errors import escaped, escaped_lines

PATIENCE = 1.0
"""Seconds of work before progress is shown."""

Report = Callable[[str, str], None]
"""Takes the name of a stage, which ends the stage before it, and how far it has come."""


def show(renderable: RenderableType) -> None:
    """Print on standard output without hidden characters; into a file or pipe, without blanks at the ends of lines."""
    ensure_standard_output()
    console = Console(highlight=False, markup=False, emoji=False)
    rendered = (part._replace(text=escaped_lines(part.text)) for part in console.render(renderable))
    visible = Segments([part for part in rendered if not part.control])
    with standard_output():
        if console.is_terminal:
            console.print(visible)
            return
        with console.capture() as captured:
            console.print(visible)
        print(re.sub(r" +$", "", captured.get(), flags=re.MULTILINE), end="", flush=True)


def ensure_standard_output() -> None:
    """Raise `OSError` if the shell has closed standard output, as with ``>&-``."""
    if sys.stdout is None:
        raise OSError("standard output is closed; leave it open")


@contextmanager
def standard_output() -> Iterator[None]:
    """Let errors of writing name standard output."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, error.filename or "standard output") from error


def tell(head: str, message: str, style: str = "bold red") -> None:
    """Print a message on standard error, without markup and without folding, so that paths stay whole.

    If it cannot be written, nothing is left to say it on, and the exit status stays what it is.
    """
    text = Text.assemble((head, style), escaped_lines(message))
    try:
        Console(stderr=True, highlight=False, markup=False, emoji=False).print(text, soft_wrap=True)
    except OSError:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 (Python writes to it until the end)


@contextmanager
def stages() -> Iterator[Report]:
    """Show a line for each stage with the time it took, on a terminal and only once it lasts."""
    with _patient_progress() as progress:
        names: list[str] = []

        def report(stage: str, now: str) -> None:
            if names[-1:] != [stage]:
                for task in progress.task_ids[-1:]:
                    progress.update(task, total=1, completed=1)
                progress.add_task(stage, total=None)
                names.append(stage)
            progress.update(progress.task_ids[-1], description=escaped(f"{stage}, {now}" if now else stage))

        yield report


@contextmanager
def _patient_progress() -> Iterator[Progress]:
    """Progress that is shown only after a while, only on a terminal, and erased at the end."""
    console = Console(stderr=True)
    columns = (SpinnerColumn(finished_text="✓"), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
    progress = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
    timer = threading.Timer(PATIENCE, progress.start)
    timer.daemon = True
    timer.start()
    try:
        yield progress
    finally:
        timer.cancel()
        timer.join()
        if progress.live.is_started:
            progress.stop()
