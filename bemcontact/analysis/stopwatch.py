"""Seconds spent on each stage of a calculation, reported while it runs."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

Progress = Callable[[str, str], object]
"""Takes the name of a stage and how far it has come; the latter is empty when the stage begins."""


@dataclass(kw_only=True)
class Stopwatch:
    """Times stages, and reports them while they run."""

    progress: Progress | None = None
    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[Callable[[str], None]]:
        """Time a stage, which may report how far it has come; a stage that comes again adds to its seconds."""
        self._report(name, "")
        begin = time.perf_counter()
        yield lambda now: self._report(name, now)
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - begin

    def _report(self, name: str, now: str) -> None:
        """Report a stage, if somebody listens."""
        if self.progress:
            self.progress(name, now)
