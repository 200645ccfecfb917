"""Time of assembly against the LU of the same matrix, in one run, and the memory that both take.

    python tests/benchmarks/assembly.py [DEGREES_OF_FREEDOM ...]

The body is a disc on a plane, pressed by its weight, with a tenth of the arc as contact zone.
"""

import sys
import time
import tracemalloc

import numpy as np
from scipy.linalg import lapack

from bemcontact.bem.condense import assemble, body_of
from bemcontact.bem.system import System
from bemcontact.problem.problem import Problem

REPEATS = 3


def disc(degrees_of_freedom: int) -> Problem:
    elements = degrees_of_freedom // 4
    arc = {"kind": "arc", "center": [0, 1], "radius": 1}
    contact = max(1, elements // 10)
    return Problem(
        name="disc",
        material={"young_modulus": 1000, "poisson_ratio": 0.3},
        boundary={
            "outer": [
                {**arc, "name": "foot", "angles": [-108, -72], "elements": contact},
                {**arc, "name": "rest", "angles": [-72, 252], "elements": elements - contact},
            ]
        },
        loads={"gravity": {"density": 1, "acceleration": [0, -1]}},
        contact_zones={"foot": {"edges": ["foot"], "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
    )


def best_of(action, repeats: int = REPEATS) -> tuple[float, object]:
    seconds, result = [], None
    for _ in range(repeats):
        result = None
        begin = time.perf_counter()
        result = action()
        seconds.append(time.perf_counter() - begin)
    return min(seconds), result


def report(degrees_of_freedom: int) -> None:
    body = body_of(disc(degrees_of_freedom))
    system = System(
        mesh=body.mesh, material=body.problem.material, values=body.values, points=body.points,
        particular=body.particular, motions=body.motions,
    )  # fmt: skip
    assembly, (matrix, _) = best_of(lambda: assemble(system))
    lu, _ = best_of(lambda: lapack.dgetrf(matrix.copy(order="F"), overwrite_a=True))
    copy, _ = best_of(lambda: matrix.copy(order="F"))
    lu -= copy
    gemm, _ = best_of(lambda: matrix @ matrix)
    rate = 2 * len(matrix) ** 3 / gemm / 1e9
    del matrix
    tracemalloc.start()
    assemble(system)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    own = 8 * system.size * (system.size + 1 + len(system.points))
    print(
        f"N = {system.size:6d}  assembly {assembly:7.3f} s  LU {lu:7.3f} s  assembly/LU {assembly / lu:5.2f}  "
        f"LU/GEMM time {lu / gemm:5.2f}  GEMM {rate:5.0f} Gflop/s  memory/(matrix and right sides) {peak / own:5.2f}"
    )


if __name__ == "__main__":
    for size in map(int, sys.argv[1:] or ["1000", "2500", "5000"]):
        report(size)
