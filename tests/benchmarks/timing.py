"""Times of actions in turns, and ratios of neighboring turns: other work and a slower processor change both alike."""

import importlib
import statistics
import time
from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Self, TypeVar

Key = TypeVar("Key", bound=Hashable)

BRIEF = 1.0
"""Seconds that all rounds together take at least, if there are not too many of them."""
MOST_ROUNDS = 25
AT_ONCE, MOST_AT_ONCE = 0.05, 3
"""A brief action runs again within its turn until it has taken this long [s], at most so often, to fill the caches."""


@dataclass(frozen=True, kw_only=True)
class Spread:
    """Median of several values, and the quartiles, between which half of them are. It is formatted as its median."""

    median: float
    lower: float
    upper: float

    def __format__(self, form: str) -> str:
        return format(self.median, form)

    @classmethod
    def of(cls, values: Iterable[float]) -> Self:
        """That of at least one value."""
        values = list(values)
        some = values if len(values) > 1 else 2 * values
        lower, median, upper = statistics.quantiles(some, n=4, method="inclusive")
        return cls(median=median, lower=lower, upper=upper)


def ratio(ones: Iterable[float], others: Iterable[float]) -> Spread:
    """Of the ratios of neighboring turns: those of the same round."""
    return Spread.of(one / other for one, other in zip(ones, others, strict=True))


@dataclass(frozen=True, kw_only=True)
class Turns:
    """Times of all turns of an action [s]: of the processor, and of the clock."""

    cpu: list[float] = field(default_factory=list)
    wall: list[float] = field(default_factory=list)


def own_time() -> float:
    """Processor time of this process [s]."""
    return time.process_time()


def children_time() -> float:
    """Processor time of the processes that this one has started and waited for [s]."""
    resource = importlib.import_module("resource")  # Windows has none
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def in_turns(
    actions: Mapping[Key, Callable[[], object]], rounds: int = 5, processor_time: Callable[[], float] = own_time
) -> dict[Key, Turns]:
    """Run all actions one after the other in each round; brief actions get more rounds."""
    turns = {name: Turns() for name in actions}
    begin = time.perf_counter()
    for number in range(1, MOST_ROUNDS + 1):
        for name, action in actions.items():
            cpu, wall = one_turn(action, processor_time)
            turns[name].cpu.append(cpu)
            turns[name].wall.append(wall)
        if number >= rounds and time.perf_counter() - begin >= BRIEF:
            break
    return turns


def one_turn(action: Callable[[], object], processor_time: Callable[[], float] = own_time) -> tuple[float, float]:
    """Run an action, a brief one a few times; the least processor time, and the least time of the clock."""
    runs: list[tuple[float, float]] = []
    while not runs or (len(runs) < MOST_AT_ONCE and sum(wall for _, wall in runs) < AT_ONCE):
        cpu, wall = processor_time(), time.perf_counter()
        action()
        runs.append((processor_time() - cpu, time.perf_counter() - wall))
    return min(cpu for cpu, _ in runs), min(wall for _, wall in runs)


def best_of(action: Callable[[], object], rounds: int = 3) -> float:
    """Shortest of a few runs, in seconds of the clock."""
    return min(in_turns({"": action}, rounds)[""].wall)
