"""Time of assembly, by NumPy and by numba if installed, against the LU of the same matrix, and the memory of it.

    python tests/benchmarks/assembly.py [DEGREES_OF_FREEDOM ...]

The bodies are discs on a plane, with a tenth of the elements in the contact zone.
"""

import dataclasses
import sys
import tracemalloc

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf
from timing import best_of

from bemcontact.bem.discretization import body_of
from bemcontact.bem.solution import assemble
from bemcontact.bem.system import System, machine_code
from bemcontact.problems.problem import Problem

Array = NDArray[np.float64]


def half_disc(degrees_of_freedom: int) -> Problem:
    """Pressed by a pressure on its flat top: tractions matter on the top and in the zone only."""
    elements = degrees_of_freedom // 4
    contact, top = max(1, elements // 10), elements // 3
    arc = {"kind": "arc", "center": [0, 1], "radius": 1}
    edges = [
        {**arc, "name": "foot", "angles": [-108, -72], "elements": contact},
        {**arc, "name": "right", "angles": [-72, 0], "elements": (elements - contact - top) // 2},
        {"name": "top", "elements": top},
        {**arc, "name": "left", "angles": [-180, -108], "elements": (elements - contact - top + 1) // 2},
    ]
    return on_a_plane("pressed on its top", edges, conditions={"top": {"pressure": 1}})


def disc(degrees_of_freedom: int) -> Problem:
    """Pressed by its weight, so that tractions matter everywhere."""
    elements = degrees_of_freedom // 4
    contact = max(1, elements // 10)
    arc = {"kind": "arc", "center": [0, 1], "radius": 1}
    edges = [
        {**arc, "name": "foot", "angles": [-108, -72], "elements": contact},
        {**arc, "name": "rest", "angles": [-72, 252], "elements": elements - contact},
    ]
    return on_a_plane("pressed by its weight", edges, loads={"gravity": {"density": 1, "acceleration": [0, -1]}})


def on_a_plane(name: str, edges: list, **actions: dict) -> Problem:
    return Problem(
        name=name,
        material={"young_modulus": 1000, "poisson_ratio": 0.3},
        boundary={"outer": edges},
        contact_zones={"foot": {"edges": ["foot"], "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
        **actions,
    )


def system_of(problem: Problem) -> System:
    body = body_of(problem)
    return System(
        mesh=body.mesh, material=body.problem.material, points=body.points.unit_pressures[0],
        motions=body.motions[0],
        loadings=body.loadings,
    )  # fmt: skip


def factorization(matrix: Array) -> tuple[float, float]:
    """Seconds of the LU and of the product of a matrix with itself."""
    copy = best_of(lambda: matrix.copy(order="F"))
    lu = best_of(lambda: dgetrf(matrix.copy(order="F"), overwrite_a=True)) - copy
    return lu, best_of(lambda: matrix @ matrix)


def report(problem: Problem) -> None:
    system = system_of(problem)
    size = system.size
    lu, gemm = factorization(assemble(system)[0])
    print(
        f"{problem.name:22s} N = {size:6d}  LU {lu:7.3f} s  LU/GEMM {lu / gemm:5.2f}"
        f"  GEMM {2e-9 * size**3 / gemm:5.0f} Gflop/s"
    )
    for by_numba in (False, True) if machine_code() else (False,):
        report_assembly(dataclasses.replace(system, by_numba=by_numba), "numba" if by_numba else "NumPy", lu)


def report_assembly(system: System, name: str, lu: float) -> None:
    assemble(system)  # compiles
    assembly = best_of(lambda: assemble(system))
    tracemalloc.start()
    assemble(system)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    own = 8 * system.size * (system.size + 1 + len(system.points))
    print(
        f"    by {name}  assembly {assembly:7.3f} s  assembly/LU {assembly / lu:5.2f}"
        f"  memory/(matrix and right sides) {peak / own:5.2f}"
    )


if __name__ == "__main__":
    for size in map(int, sys.argv[1:] or ["1000", "2500", "5000"]):
        report(half_disc(size))
        report(disc(size))
