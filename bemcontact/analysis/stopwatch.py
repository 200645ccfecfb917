"""Seconds spent on each stage of a calculation, told as it goes."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

Progress = Callable[[str, str], object]
"""Takes the name of a stage, and how far it has come; that is empty as it begins."""


@dataclass(kw_only=True)
class Stopwatch:
    """Times stages, and tells of them as they go."""

    progress: Progress | None = None
    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[Callable[[str], None]]:
        """Time what is inside, which may tell how far it has come; a stage that comes again adds to its seconds."""
        self._tell(name, "")
        begin = time.perf_counter()
        yield lambda now: self._tell(name, now)
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - begin

    def _tell(self, name: str, now: str) -> None:
        """Call who wants to know."""
        if self.progress:
            self.progress(name, now)
