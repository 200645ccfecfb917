"""Seconds spent on each stage of a calculation, told as it goes."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field


@dataclass(kw_only=True)
class Stopwatch:
    """Times stages, and calls `progress` with the name of each as it begins."""

    progress: Callable[[str], object] | None = None
    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time what is inside; a stage that comes again adds to its seconds."""
        self.say(name)
        begin = time.perf_counter()
        yield
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - begin

    def say(self, what: str) -> None:
        """Tell what is going on."""
        if self.progress:
            self.progress(what)
