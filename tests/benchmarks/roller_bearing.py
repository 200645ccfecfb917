"""The shipped roller bearing beside one of its rings, to the same accuracy; and rollers that share a condensation.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python tests/benchmarks/roller_bearing.py

The ring is the outer one of the bearing, into which nine rigid rollers are pressed with forces like those there. Times
are processor seconds. In the second table rollers between rigid rings are condensed with factors of their own and with
shared ones; in the third their loads are beside those of the closed form.
"""

import sys
import time
from pathlib import Path
from unittest import mock

import numpy as np
from rich.console import Console
from rich.table import Table

import bemcontact
from bemcontact.bem import condense as condensing
from bemcontact.bem.discretization import body_of

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from roller_bearings import ROLLERS, bearing, load_shares  # noqa: E402 - it is beside this folder
from several_bodies import stated  # noqa: E402

MODEL = ROOT / "models" / "bodies" / "roller_bearing.yaml"
INTERFERENCE = 0.004
"""Of the rigid rollers with the ring [L]: their forces are between those of the elastic rollers."""
LIMIT = 10.0
"""Times of one ring that a bearing may take."""


def ring() -> bemcontact.Problem:
    """The outer ring of the shipped bearing with nine rigid rollers pressed into it, each into an arc."""
    whole, step = bemcontact.load(MODEL), 360 / ROLLERS
    boundary = whole.bodies["outer"].boundary.model_dump(exclude_unset=True)
    (raceway,) = boundary["holes"][0]
    starts = [-90 + step / 2 - step * i for i in range(ROLLERS)]
    arcs = [{**raceway, "name": f"arc {i}", "angles": [start, start - step]} for i, start in enumerate(starts)]
    centers = [(20 + INTERFERENCE) * np.exp(1j * np.radians(start - step / 2)) for start in starts]
    zones = {
        f"roller {i}": {
            "edges": [f"arc {i}"],
            "surface": {"kind": "circle", "center": [center.real, center.imag], "radius": 5, "body": "outside"},
        }
        for i, center in enumerate(centers)
    }
    return stated(
        name="ring", material=whole.materials["steel"], boundary={**boundary, "holes": [arcs]},
        conditions=whole.bodies["outer"].conditions, contact_zones=zones, accuracy=whole.accuracy,
    )  # fmt: skip


def seconds(problem: bemcontact.Problem) -> tuple[float, bemcontact.Result]:
    """Processor time of a solution, and the solution."""
    begin = time.process_time()
    result = bemcontact.solve(problem)
    return time.process_time() - begin, result


def condensation(problem: bemcontact.Problem) -> float:
    """Least processor time of three condensations of a body on its mesh."""
    body, times = body_of(problem), list[float]()
    for _ in range(3):
        begin = time.process_time()
        condensing.condense(body)
        times.append(time.process_time() - begin)
    return min(times)


def main() -> None:
    """Print all tables; leave with an error if the bearing takes too long."""
    console = Console()
    seconds(ring())  # imports and machine code
    one, of_one = seconds(ring())
    whole, of_whole = seconds(bemcontact.load(MODEL))
    table = Table("", "CPU seconds", "verdict", "error", "forces")
    for name, taken, result in (("one ring", one, of_one), ("bearing", whole, of_whole)):
        forces = np.hypot(*result.contact.resultants(result.solution.pressure).T)
        verdict, error = result.certificate.kind.value, f"{100 * result.accuracy.worst:.2g} %"
        table.add_row(name, f"{taken:.1f}", verdict, error, f"{forces.min():.0f} to {forces.max():.0f}")
    console.print(table, f"The bearing takes {whole / one:.1f} times as long as one ring.")

    table = Table("elements of each arc in contact", "own factors [s]", "shared factors [s]")
    for elements in (16, 32, 64):
        problem = bearing(1e-3, -1e-5, elements)
        with mock.patch.object(
            condensing, "congruent", lambda systems: {i: {i: np.eye(2)} for i in range(len(systems))}
        ):
            own = condensation(problem)
        table.add_row(str(elements), f"{own:.3f}", f"{condensation(problem):.3f}")
    console.print(table)

    table = Table("gap", "roller", "share", "closed form", "difference")
    for gap in (-1e-5, 0.0):
        result = bemcontact.solve(bearing(1e-3, gap))
        forces = np.hypot(*result.contact.resultants(result.solution.pressure).T)
        expected = load_shares(1e-3, gap, 1000 / (1 - 0.3**2))
        for i in range(ROLLERS // 2 + 1):
            own = forces[result.contact.zone_names.index(f"inside {i + 1}")]
            difference = f"{100 * (own - expected[i]) / expected.max():.2f} %"
            table.add_row(f"{gap:g}", str(i + 1), f"{own / 1e-3:.4f}", f"{expected[i] / 1e-3:.4f}", difference)
    console.print(table)
    if whole > LIMIT * one:
        sys.exit(f"the bearing takes more than {LIMIT:g} times as long as one ring")


if __name__ == "__main__":
    main()
