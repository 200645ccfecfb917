"""CPU seconds of stress and displacement at many points, against those of a solve."""

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import bemcontact
from bemcontact.threads import one_thread

MODELS = Path(__file__).parents[2] / "models"
REPEATS = 5


def seconds(work: Callable[[], object]) -> float:
    """Least CPU time of several runs."""
    times = []
    for _ in range(REPEATS):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return min(times)


@one_thread
def main(count: int) -> None:
    for variant in (None, "stated mesh"):
        problem = bemcontact.load(MODELS / "cylinder_on_plane.yaml", variant=variant)
        result = bemcontact.solve(problem)
        radius, angle = np.random.default_rng(0).uniform([0.01, -np.pi / 2], [7.9, 0], (count, 2)).T
        points = np.column_stack([radius * np.cos(angle), 8 + radius * np.sin(angle)])
        solve = seconds(lambda problem=problem: bemcontact.solve(problem))
        print(f"{result.degrees_of_freedom} unknowns, {variant or 'mesh that is found'}: solve {solve:.3f} s")
        for name, work in (("stress", result.stress), ("displacement", result.displacement)):
            taken = seconds(lambda work=work, points=points: work(points))
            print(f"  {name} at {count} points: {taken:.3f} s, {taken / solve:.1f} solves")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
