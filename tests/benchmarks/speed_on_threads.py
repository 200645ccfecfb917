"""Condensation with one thread of BLAS and with two: CPU time and time of the clock."""

import os
from collections.abc import Callable

import numpy as np
from speed_cylinder import codes, cylinder
from speed_of_condensation import condense_by, factorize, system_of
from speed_page import Cell, Section, Settings, Table
from threadpoolctl import threadpool_info, threadpool_limits
from timing import Turns, in_turns, ratio

from bemcontact.bem.solution import assemble

REFINE = (8, 16, 32)
THREADS = (1, 2)

TEXT = """\
The same problems as for condensation, with one thread of BLAS and with two. The *wall* time is that of the clock.
It says something only if nothing else runs on the machine. The program itself lets BLAS take several threads for
factorizations and substitutions that would take half a second or more on one, from about 3000 unknowns on.
"""


def limited(threads: int, action: Callable[[], object]) -> Callable[[], object]:
    """An action with so many threads of BLAS."""

    def run() -> None:
        with threadpool_limits(threads, user_api="blas"):
            action()

    return run


def ensure_threads(count: int) -> None:
    """Raise an error if BLAS cannot take so many threads here."""
    if (os.cpu_count() or 1) < count:
        raise RuntimeError(f"this machine has fewer than {count} processors")
    np.ones((2, 2)) @ np.ones((2, 2))
    with threadpool_limits(count, user_api="blas"):
        taken = {item["num_threads"] for item in threadpool_info() if item["user_api"] == "blas"}
    if taken != {count}:
        raise RuntimeError(f"BLAS takes {taken} threads, not {count}")


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Measure all sizes."""
    ensure_threads(max(THREADS))
    code, rows, raw = codes()[-1], [], {}
    for refine in (4,) if settings.quick else REFINE:
        say(f"each element cut into {refine}")
        problem = cylinder(refine)
        system = system_of(problem)
        matrix = np.asfortranarray(assemble(system)[0])
        actions = {"GEMM": lambda matrix=matrix: matrix @ matrix, "LU": lambda matrix=matrix: factorize(matrix),
                   f"condensation, {code}": lambda problem=problem: condense_by(code, problem)}  # fmt: skip
        times = in_turns(
            {(name, count): limited(count, action) for name, action in actions.items() for count in THREADS},
            3 if settings.quick else 5,
        )
        size = system.mesh.degrees_of_freedom
        rows += [[size, name, *_compared(times[name, 1], times[name, 2])] for name in actions]
        raw[str(size)] = {f"{name}, {count} threads": vars(item) for (name, count), item in times.items()}
    columns = {"N": "d", "": "", "CPU, 1 thread, ms": ".0f", "CPU, 2 threads, ms": ".0f", "wall, 1 thread, ms": ".0f",
               "wall, 2 threads, ms": ".0f", "wall, 1 over 2": ".2f"}  # fmt: skip
    return Section(title="Two threads", text=TEXT, tables=[Table(columns=columns, rows=rows)], raw=raw)


def _compared(one: Turns, two: Turns) -> list[Cell]:
    return [*(1e3 * min(times) for times in (one.cpu, two.cpu, one.wall, two.wall)), ratio(one.wall, two.wall)]
