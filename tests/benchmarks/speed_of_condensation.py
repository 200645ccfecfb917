"""Assembly and condensation against the factorization of the same matrix, and that against the product of two."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf
from speed_cylinder import assembled_by, codes, cylinder
from speed_page import Section, Settings, Table, Target
from timing import Turns, in_turns, ratio

import bemcontact
from bemcontact.bem.discretization import body_of
from bemcontact.bem.solution import assemble
from bemcontact.bem.system import System

REFINE = (1, 4, 8, 16, 32)
CONDENSATION = {608: 5.0, 1216: 3.5, 2432: 2.8, 4864: 2.3}
ASSEMBLY = {608: 2.0, 1216: 1.0, 2432: 0.45, 4864: 0.25}
"""Largest time with numba over that of the factorization that was asked for, by degrees of freedom."""

TEXT = """\
The cylinder of the paper with each element of its variant `stated mesh` cut into equal parts. N is the number of
degrees of freedom, n that of contact points. *LU* is LAPACK's `getrf` of the matrix of the problem, *GEMM* the
product of the matrix with itself. *Assembly* sets up the matrix and the n + 1 right sides. *Condensation* is the
whole `bemcontact.condense`: contact points, assembly, factorization, solution for all right sides, checks and the
compliance. With numba the compiled code is loaded already.
"""


def system_of(problem: bemcontact.Problem) -> System:
    """The equations of a body."""
    body = body_of(problem)
    return System(
        mesh=body.mesh, material=body.problem.material, points=body.points.unit_pressures[0],
        motions=body.motions[0],
        loadings=body.loadings,
    )  # fmt: skip


def factorize(matrix: NDArray[np.float64]) -> None:
    """LU in a copy."""
    dgetrf(matrix.copy(order="F"), overwrite_a=True)


def assemble_by(code: str, system: System) -> None:
    """Assemble anew, with nothing kept."""
    assemble(replace(system, by_numba=code == "numba"))


def condense_by(code: str, problem: bemcontact.Problem) -> None:
    """The public function."""
    with assembled_by(code):
        bemcontact.condense(problem)


def times_of(problem: bemcontact.Problem, rounds: int) -> tuple[System, dict[str, Turns]]:
    """Times of all actions, next to the factorization."""
    system = system_of(problem)
    matrix = np.asfortranarray(assemble(system)[0])
    actions = {
        "copy": lambda: matrix.copy(order="F"),
        "LU and copy": partial(factorize, matrix),
        "GEMM": lambda: matrix @ matrix,
    }
    for code in codes():
        actions[f"assembly, {code}"] = partial(assemble_by, code, system)
        actions[f"condensation, {code}"] = partial(condense_by, code, problem)
    for action in actions.values():
        action()  # loads and compiles
    return system, in_turns(actions, rounds)


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Measure all sizes."""
    rows, targets, raw = [], [], {}
    names = codes()
    for refine in REFINE[: 2 if settings.quick else None]:
        problem = cylinder(refine)
        say(f"each element cut into {refine}")
        system, times = times_of(problem, 3 if settings.quick else 5)
        size, cpu = system.mesh.degrees_of_freedom, {name: item.cpu for name, item in times.items()}
        lu = [both - copy for both, copy in zip(cpu["LU and copy"], cpu["copy"], strict=True)]
        raw[str(size)] = {**cpu, "LU": lu, "points": len(system.points)}
        product = cpu["GEMM"]
        row = [size, len(system.points), 1e3 * min(lu), ratio(lu, product), 2e-9 * system.size**3 / min(product)]
        for kind in ("assembly", "condensation"):
            for code in names:
                row += [1e3 * min(cpu[f"{kind}, {code}"]), ratio(cpu[f"{kind}, {code}"], lu)]
        rows.append(row)
        for kind, asked in (("assembly", ASSEMBLY), ("condensation", CONDENSATION)):
            if size in asked:
                found = ratio(cpu[f"{kind}, numba"], lu) if "numba" in names else None
                targets.append(Target(name=f"{kind} with numba over LU, N = {size}", asked=asked[size], measured=found))
    columns = {"N": "d", "n": "d", "LU, ms": ".1f", "LU/GEMM": ".2f", "GEMM, Gflop/s": ".0f"}
    for kind in ("assembly", "condensation"):
        for code in names:
            columns |= {f"{kind}, {code}, ms": ".1f", f"{kind}/LU, {code}": ".2f"}
    targets.sort(key=lambda target: target.name.split()[0])
    table = Table(columns=columns, rows=rows)
    return Section(title="Assembly and condensation", text=TEXT, tables=[table], targets=targets, raw=raw)
