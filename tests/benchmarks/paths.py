"""Load paths from no load to the full one, against solving at every breakpoint from scratch.

    OPENBLAS_NUM_THREADS=1 python tests/benchmarks/paths.py [REFINE ...]

Problems 2 and 5 of Simunovic and Saigal 1992, a body on three zones, and the first of them with each element cut into
so many parts, 9 if none are given. "Direct" is the primal-dual active set, which is not told of the breakpoint before.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from timing import best_of

import bemcontact
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.formulations import complementarity
from bemcontact.parametric.path import load_path

MODELS = Path(__file__).parents[2] / "models"
NAMES = ("cylinder_on_plane", "cantilever_flat_surface", "gallery/three_zones")
FINE = 9


def row(contact: CondensedContact) -> str:
    """Points, breakpoints, pivots, the worst residual, the largest difference of pressures, seconds and their ratio."""
    free = replace(contact, free_displacement=0 * contact.free_displacement, motion_load=0 * contact.motion_load)
    path = load_path(free, contact)
    problems = [path.contact(t) for t in path.parameter]
    found = [complementarity.solve(problem).pressure for problem in problems]
    apart = max(np.abs(one - other).max() for one, other in zip(found, path.pressure, strict=True)) / path.peak.max()
    following = best_of(lambda: load_path(free, contact))
    solving = best_of(lambda: [complementarity.solve(replace(problem)) for problem in problems])
    return (
        f"{contact.name[:28]:28}  {contact.size:6}  {len(path.parameter):11}  {path.pivots:6}  {path.residual:8.0e}  "
        f"{apart:7.0e}  {following:8.4f}  {solving:8.4f}  {solving / following:5.1f}"
    )


def main(refine: list[int]) -> None:
    """Print a table."""
    heads = ("points", "breakpoints", "pivots", "residual", "apart", "path, s", "direct, s", "ratio")
    print(f"{'':28}  " + "  ".join(heads))
    for name in NAMES:
        print(row(bemcontact.condense(bemcontact.load(MODELS / f"{name}.yaml", variant="stated mesh"))))
    for parts in refine or [FINE]:
        print(
            row(bemcontact.condense(bemcontact.load(MODELS / f"{NAMES[0]}.yaml", variant="stated mesh").refined(parts)))
        )


if __name__ == "__main__":
    main([int(argument) for argument in sys.argv[1:]])
