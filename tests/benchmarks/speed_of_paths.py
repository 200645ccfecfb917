"""Load paths from no load to the full one, against a solve at every breakpoint from scratch."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from speed_cylinder import MESH, MODEL, cylinder
from speed_page import Cell, Section, Settings, Table
from timing import in_turns, ratio

import bemcontact
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.formulations import complementarity
from bemcontact.parametric.path import load_path

OTHERS = ("cantilever_flat_surface", "gallery/three_zones")
REFINE = (1, 4, 8)
"""Of the cylinder."""

TEXT = """\
A load path from no load to the full one is followed by pivoting. At each of its breakpoints the direct solver,
which does not know the breakpoint before, solves the same problem from scratch. The problems are the variants
`stated mesh` of problems 2 and 5 of the paper, the first of them with each element cut into equal parts too, and a
body on three zones. *Difference* is the largest one of the pressures at any breakpoint, over the peak.
"""


def contacts(quick: bool) -> dict[str, CondensedContact]:
    """The problems by name."""
    others = {name: bemcontact.load(MODEL.parent / f"{name}.yaml", variant=MESH) for name in OTHERS}
    problems = {f"cylinder_on_plane, cut into {parts}": cylinder(parts) for parts in REFINE[: 1 if quick else None]}
    return {name: bemcontact.condense(problem) for name, problem in {**others, **problems}.items()}


def row(name: str, contact: CondensedContact) -> list[Cell]:
    """Points, breakpoints, pivots, the largest difference of pressures, times [ms] and their ratio."""
    free = replace(contact, free_displacement=0 * contact.free_displacement, motion_load=0 * contact.motion_load)
    path = load_path(free, contact)
    problems = [path.contact(t) for t in path.parameter]
    found = [complementarity.solve(problem).pressure for problem in problems]
    apart = max(np.abs(one - other).max() for one, other in zip(found, path.pressure, strict=True)) / path.peak.max()
    times = in_turns(
        {
            "path": lambda: load_path(free, contact),
            "direct": lambda: [complementarity.solve(replace(problem)) for problem in problems],
        }
    )
    following, solving = times["path"].cpu, times["direct"].cpu
    counts = [contact.size, len(path.parameter), path.pivots, float(apart)]
    return [name, *counts, 1e3 * min(following), 1e3 * min(solving), ratio(solving, following)]


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Measure all problems."""
    rows = []
    for name, contact in contacts(settings.quick).items():
        say(name)
        rows.append(row(name, contact))
    columns = {"Problem": "", "n": "d", "Breakpoints": "d", "Pivots": "d", "Difference": ".0e", "path, ms": ".1f",
               "direct, ms": ".1f", "direct over path": ".1f"}  # fmt: skip
    return Section(title="Load paths", text=TEXT, tables=[Table(columns=columns, rows=rows)])
