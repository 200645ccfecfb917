"""Times of actions in turns, so that other work on the machine disturbs their ratios little."""

import statistics
import time
from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass
from typing import TypeVar

Key = TypeVar("Key", bound=Hashable)

BRIEF = 1.0
"""Seconds that all rounds together take at least, if there are not too many of them."""
MOST_ROUNDS = 25
AT_ONCE, MOST_AT_ONCE = 0.05, 3
"""A brief action runs again within its turn until it has taken this long [s], at most so often, to fill the caches."""


@dataclass(frozen=True, kw_only=True)
class Seconds:
    """Least processor time of this process, and least time of the clock, of several runs of an action."""

    cpu: float
    wall: float


def seconds_of(action: Callable[[], object]) -> Seconds:
    """Run an action once."""
    cpu, wall = time.process_time(), time.perf_counter()
    action()
    return Seconds(cpu=time.process_time() - cpu, wall=time.perf_counter() - wall)


def in_turns(actions: Mapping[Key, Callable[[], object]], rounds: int = 3) -> dict[Key, Seconds]:
    """Run all actions one after the other in each round, and take the least times; brief actions get more rounds."""
    taken: dict[Key, list[Seconds]] = {name: [] for name in actions}
    begin = time.perf_counter()
    for number in range(1, MOST_ROUNDS + 1):
        for name, action in actions.items():
            taken[name] += one_turn(action)
        if number >= rounds and time.perf_counter() - begin >= BRIEF:
            break
    return {name: least(runs) for name, runs in taken.items()}


def one_turn(action: Callable[[], object]) -> list[Seconds]:
    """Run an action, and a brief one a few times."""
    runs = [seconds_of(action)]
    while len(runs) < MOST_AT_ONCE and sum(run.wall for run in runs) < AT_ONCE:
        runs.append(seconds_of(action))
    return runs


def least(runs: Iterable[Seconds]) -> Seconds:
    """Least of each of the two times."""
    runs = list(runs)
    return Seconds(cpu=min(run.cpu for run in runs), wall=min(run.wall for run in runs))


def best_of(action: Callable[[], object], rounds: int = 3) -> float:
    """Shortest of a few runs, in seconds of the clock."""
    return min(seconds_of(action).wall for _ in range(rounds))


def geometric_mean(ratios: Iterable[float]) -> float | None:
    """Geometric mean of positive numbers; None if there are none."""
    ratios = list(ratios)
    return statistics.geometric_mean(ratios) if ratios else None
