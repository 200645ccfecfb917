"""Random small integer programs in random units: every claim of the local solver judged in exact arithmetic.

    python tests/benchmarks/local_solver_fuzz.py [--cases 1000000] [--first 0] [--degenerate] [--numba] [--keep FILE]

Each seed makes a program of whole numbers, multiplies its rows, columns and objective by powers of ten, and solves it
from a random start. A claim that rounding could have decided is judged with fractions on the whole numbers. Each
minimizer is solved again from itself, and a part of the programs also in the units of the whole numbers. With
--degenerate the programs have a point with many active constraints and few multipliers, at the edge of copositivity.
Seeds of false and of missing answers are written to the file. Set OPENBLAS_NUM_THREADS=1.
"""

import argparse
import time
from collections import Counter
from pathlib import Path

import numpy as np
from exact_judge import Verdict, judge
from integer_program import (
    IntegerProgram,
    Units,
    degenerate_program,
    plain_units,
    random_program,
    random_units,
)
from numpy.typing import NDArray

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.minimize import DEFAULTS, minimize_qp
from bemcontact.formulations.local_solver.result import QPOptions, QPResult, QPStatus

Sides = NDArray[np.int64]
MISSING = (QPStatus.NUMERICAL_FAILURE, QPStatus.UNDECIDED, QPStatus.ITERATION_LIMIT)
ENDS = (QPStatus.LOCAL_MINIMIZER, QPStatus.UNDECIDED)


def case(seed: int, *, degenerate: bool = False) -> tuple[IntegerProgram, Units, Array | None, Sides | None]:
    """A program, its units, a start in the units of the whole numbers or None, and a working set or None."""
    rng = np.random.default_rng(seed)
    program = degenerate_program(rng) if degenerate else random_program(rng)
    units = random_units(program, rng)
    start = rng.integers(-4, 5, program.c.size).astype(float) if rng.random() < 0.5 else None
    working_set = rng.integers(-1, 2, program.lower.size) if rng.random() < 0.2 else None
    return program, units, start, working_set


def solved(
    program: IntegerProgram, units: Units, start: Array | None, working_set: Sides | None, options: QPOptions = DEFAULTS
) -> QPResult:
    """The answer in these units; the start is in those of the whole numbers."""
    x0 = None if start is None else start / units.columns
    return minimize_qp(*program.stated(units), x0=x0, working_set=working_set, options=options)


def outcomes(seed: int, *, degenerate: bool = False, options: QPOptions = DEFAULTS) -> list[str]:
    """What is to be counted of a seed."""
    program, units, start, working_set = case(seed, degenerate=degenerate)
    result = solved(program, units, start, working_set, options)
    verdict = judge(program, units, result)
    counted = [f"status: {result.status}"] if verdict in (Verdict.RIGHT, Verdict.NO_CLAIM) else [f"judge: {verdict}"]
    if result.status in ENDS and seed % 4 < 2:
        sides = result.working_set if seed % 2 else None
        again = minimize_qp(*program.stated(units), x0=result.x, working_set=sides, options=options)
        if again.status is not result.status or again.iterations:
            with_set = "with working set" if seed % 2 else "from x alone"
            counted.append(f"restart {with_set}: {result.status} -> {again.status}{', moves' * (again.iterations > 0)}")
    if seed % 10 == 0:
        plain = solved(program, plain_units(program), start, working_set, options)
        if (of_plain := judge(program, plain_units(program), plain)) not in (Verdict.RIGHT, Verdict.NO_CLAIM):
            counted.append(f"plain: judge: {of_plain}")
        counted.append("plain: solved too")
        if plain.status is not result.status:
            counted.append(f"plain: {plain.status}, scaled: {result.status}")
    return counted


def worth_keeping(name: str) -> bool:
    """Whether the seed is to be looked at."""
    return (not name.startswith("status") and name != "plain: solved too") or any(status in name for status in MISSING)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--cases", type=int, default=1_000_000)
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--degenerate", action="store_true", help="programs with degenerate first-order points")
    parser.add_argument("--numba", action="store_true", help="machine code takes iterations")
    parser.add_argument("--keep", type=Path, help="file for the seeds of false and missing answers")
    given = parser.parse_args()
    options = QPOptions(by_numba=given.numba)
    begin, counts = time.perf_counter(), Counter[str]()
    kept = given.keep.open("w") if given.keep else None
    for seed in range(given.first, given.first + given.cases):
        for name in outcomes(seed, degenerate=given.degenerate, options=options):
            counts[name] += 1
            if kept and worth_keeping(name):
                kept.write(f"{seed} {name}\n")
                kept.flush()
        if (seed + 1 - given.first) % 10_000 == 0:
            print(seed + 1 - given.first, f"{time.perf_counter() - begin:.0f} s", dict(counts), flush=True)
    print(f"{given.cases} cases from seed {given.first} in {time.perf_counter() - begin:.0f} s")
    for name, count in sorted(counts.items()):
        print(f"{count:9d}  {name}")


if __name__ == "__main__":
    main()
