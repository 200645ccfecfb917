"""How much faster a model is solved again through its parameters than made anew.

    python tests/benchmarks/model_resolve.py

Each number is the least of several repetitions, in milliseconds, of a random problem with 100 points and a free motion
whose initial gap changes by a hundredth of its size. "again by cvxpy" is for a model with an addition that is not
active, "again" for one without, which starts from the contact set of the last solution.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import cvxpy as cp
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from contact_problems import random_contact

import bemcontact
from bemcontact.formulations.clarabel import minimize_convex

POINTS = 100
REPETITIONS = 15


def milliseconds(task: Callable[[], object], before: Callable[[], object] = lambda: None) -> float:
    """The least time that a task takes."""
    times = []
    for _ in range(REPETITIONS):
        before()
        start = perf_counter()
        task()
        times.append(perf_counter() - start)
    return 1e3 * min(times)


def main() -> None:
    """Print the times and their ratios."""
    contact = random_contact(3, POINTS, 1)
    model = bemcontact.model(contact)
    added = model.problem(extra_constraints=[model.pressure <= 1e3 * contact.scales.pressure])
    model.solve()
    model.solve(problem=added)
    rng, first = np.random.default_rng(0), contact.initial_gap

    def change() -> None:
        model.initial_gap.value = first + 0.01 * np.abs(first).mean() * rng.standard_normal(POINTS)

    times = {
        "new: model and compilation": milliseconds(lambda: compiled(bemcontact.model(contact).problem())),
        "new: with solution and judgement": milliseconds(lambda: bemcontact.model(contact).solve()),
        "again by cvxpy: data alone": milliseconds(lambda: compiled(added), change),
        "again by cvxpy: with solution": milliseconds(lambda: minimize_convex(added), change),
        "again by cvxpy: and judgement": milliseconds(lambda: model.solve(problem=added), change),
        "again: with solution and judgement": milliseconds(model.solve, change),
    }
    for name, time in times.items():
        print(f"{name:36} {time:8.2f} ms")
    new, data, whole, again = (list(times.values())[i] for i in (0, 2, 1, 5))
    print(f"ratio of compilation {new / data:.1f}, of the whole {whole / again:.1f}")


def compiled(problem: cp.Problem) -> object:
    """The numbers for the solver."""
    return problem.get_problem_data(cp.CLARABEL, solver_opts={})


if __name__ == "__main__":
    main()
