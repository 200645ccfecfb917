"""What a person sees on a terminal: renderables, one-line messages, and what is going on."""

import re
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console, RenderableType
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.text import Text

PATIENCE = 1.0
"""Seconds of work after which a person is told what is going on."""


def show(renderable: RenderableType) -> None:
    """Print for a person on standard output; into a file or a pipe, without blanks at the ends of lines."""
    console = Console(highlight=False, markup=False, emoji=False)
    if console.is_terminal:
        console.print(renderable)
        return
    with console.capture() as captured:
        console.print(renderable)
    print(re.sub(r" +$", "", captured.get(), flags=re.MULTILINE), end="", flush=True)


def tell(head: str, message: str, style: str = "bold red") -> None:
    """Say one thing on standard error: never markup, never folded, so that paths stay whole."""
    printable = "".join(c if c.isprintable() or c == "\n" else "\N{REPLACEMENT CHARACTER}" for c in message)
    Console(stderr=True, highlight=False, markup=False, emoji=False).print(
        Text.assemble((head, style), printable), soft_wrap=True
    )


@contextmanager
def busy(what: str) -> Iterator[Callable[[str], None]]:
    """Show what is going on and for how long, on a terminal and only once it lasts.

    Parameters
    ----------
    what : in a word or two

    Yields
    ------
    callable
        Takes what is going on now.
    """
    with _patient_progress() as progress:
        task = progress.add_task(what, total=None)
        yield lambda now: progress.update(task, description=now)


@contextmanager
def stages() -> Iterator[Callable[[str, str], None]]:
    """Show a line for each stage with the time it took, on a terminal and only once it lasts.

    Yields
    ------
    callable
        Takes the name of a stage, which ends the one before, and how far it has come.
    """
    with _patient_progress() as progress:
        names: list[str] = []

        def tell(stage: str, now: str) -> None:
            if names[-1:] != [stage]:
                for task in progress.task_ids[-1:]:
                    progress.update(task, total=1, completed=1)
                progress.add_task(stage, total=None)
                names.append(stage)
            progress.update(progress.task_ids[-1], description=f"{stage}, {now}" if now else stage)

        yield tell


@contextmanager
def _patient_progress() -> Iterator[Progress]:
    """Show progress only after a while, and only on a terminal; it leaves nothing behind."""
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
