"""QP1, QP2, QP3 and the direct solver against the number of contact points, and the comparison of all of them."""

import importlib.util
import subprocess
import sys
from collections.abc import Callable
from functools import partial

from speed_cylinder import MESH, MODEL, cylinder
from speed_page import Section, Settings, Table, Target
from timing import Spread, children_time, in_turns

import bemcontact

REFINE = (1, 2, 4, 8)
COMPARED = 8
LARGEST_COMPARISON = 8.0
"""Seconds of `compare` with elements cut into `COMPARED` that were asked for."""

TEXT = """\
The cylinder of the paper, its variant `stated mesh` cut into equal parts, is condensed before. `bemcontact.solve`
of the condensed problem is timed, with its checks. QP1 and QP2 are solved by the local solver from the null vector,
QP3 by Clarabel and, if installed, by PIQP. All results are certified, or the section fails.

The last table is the command `compare` with all its work: start, condensation, QP1, QP2, QP3, checks.
"""


def ways() -> dict[str, dict]:
    """Arguments of `solve` by heading."""
    listed = {
        "direct": {"formulation": "complementarity"},
        "QP1": {"formulation": "qp1"},
        "QP2": {"formulation": "qp2"},
        "QP3, Clarabel": {"formulation": "qp3", "solver": "clarabel"},
    }
    if importlib.util.find_spec("piqp"):
        listed["QP3, PIQP"] = {"formulation": "qp3", "solver": "piqp"}
    return listed


def certified(contact: bemcontact.CondensedContact, way: dict) -> int | None:
    """Iterations of a solve, whose result has to be certified."""
    result = bemcontact.solve(contact, **way)
    if not result.certified:
        raise RuntimeError(f"{way} with {len(contact.points)} contact points is not certified: {result!r}")
    return result.solution.iterations


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Measure all sizes."""
    rows, iterations, raw = [], [], {}
    for refine in REFINE[: 2 if settings.quick else None]:
        contact = bemcontact.condense(cylinder(refine))
        n = len(contact.points)
        say(f"{n} contact points")
        counts = [certified(contact, way) for way in ways().values()]
        times = in_turns(
            {name: partial(certified, contact, way) for name, way in ways().items()}, 1 if settings.quick else 2
        )
        rows.append([n, *(1e3 * min(item.cpu) for item in times.values())])
        iterations.append([n, *counts])
        raw[str(n)] = {name: vars(item) for name, item in times.items()}
    say("compare")
    parts = 2 if settings.quick else COMPARED
    command = [sys.executable, "-m", "bemcontact", "compare", str(MODEL), "--variant", MESH, "--refine", str(parts)]
    action = partial(subprocess.run, command, check=True, capture_output=True)
    taken = in_turns({"compare": action}, 1 if settings.quick else 3, children_time)["compare"]
    raw["compare"] = vars(taken)
    whole = Table(
        title=f"The command `compare` with elements cut into {parts}",
        columns={"CPU, s": ".2f", "wall, s": ".2f"},
        rows=[[min(taken.cpu), min(taken.wall)]],
    )
    tables = [
        Table(title="CPU time, ms", columns={"n": "d", **dict.fromkeys(ways(), ".1f")}, rows=rows),
        Table(title="Iterations", columns={"n": "d", **dict.fromkeys(ways(), "d")}, rows=iterations),
        whole,
    ]
    name = f"`compare` of the cylinder, elements cut into {parts}, wall"
    wall = Spread.of(taken.wall)
    targets = [] if settings.quick else [Target(name=name, asked=LARGEST_COMPARISON, measured=wall, unit="s")]
    return Section(title="Formulations", text=TEXT, tables=tables, targets=targets, raw=raw)
