"""Multistart: searches of the local solver from many random starts, one after the other, and where they end."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.multistart import RandomStarts, SearchEnd
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.formulations import FORMULATIONS
from bemcontact.formulations.scaling import contact_residual
from bemcontact.formulations.starts import draw_starts
from bemcontact.options import SolveOptions

SAME = 1e-6
"""Difference of pressures over T, and of displacements over U, relative to their size, below which ends are one."""
NOWHERE = (Status.INFEASIBLE, Status.UNBOUNDED)
"""Ends that are proofs and no points: all of a kind are one, and an objective means nothing there."""

StartsDone = Callable[[int], object]
"""Takes the number of searches done."""


def solve_contact(
    contact: CondensedContact, options: SolveOptions, progress: StartsDone | None = None
) -> tuple[ContactSolution, RandomStarts | None]:
    """Solve by the formulation of the options.

    With a number of starts the solution is that from the first start which led to the best end. All ends come with it.
    """
    solve = FORMULATIONS[options.formulation]
    if options.starts is None:
        return solve(contact, options), None
    searches = multistart(contact, options, progress)
    starts = draw_starts(contact, options.starts, options.seed or 0)
    best = starts[searches.ends[0].first_start]
    return solve(contact, replace(options, start=best, seed=None, starts=None)), searches


def multistart(contact: CondensedContact, options: SolveOptions, progress: StartsDone | None = None) -> RandomStarts:
    """Search from random starts, and sort the ends; there is no polish, which would hide where a search ended.

    `progress` is called after each search with the number of searches done.
    """
    count, seed = options.starts or 1, options.seed or 0
    ends: list[SearchEnd] = []
    for number, start in enumerate(draw_starts(contact, count, seed)):
        one = replace(options, start=start, seed=None, starts=None, polish=False)
        solution = FORMULATIONS[options.formulation](contact, one)
        same = next((i for i, end in enumerate(ends) if _same(contact, end.solution, solution)), None)
        if same is None:
            ends.append(_end(contact, solution, number))
        else:
            least, most = ends[same].iterations
            iterations = min(least, solution.iterations), max(most, solution.iterations)
            ends[same] = replace(ends[same], count=ends[same].count + 1, iterations=iterations)
        if progress:
            progress(number + 1)
    ordered = tuple(sorted(ends, key=lambda end: (end.solution.status is not Status.SOLVED, end.residual)))
    return RandomStarts(formulation=options.formulation, count=count, seed=seed, ends=ordered)


def _end(contact: CondensedContact, solution: ContactSolution, number: int) -> SearchEnd:
    """An end of which this search is the first."""
    known = solution.search is not None and solution.status not in NOWHERE
    return SearchEnd(
        solution=solution,
        count=1,
        first_start=number,
        objective=solution.search.objective if known and solution.search else None,
        residual=contact_residual(contact, solution),
        iterations=(solution.iterations, solution.iterations),
    )


def _same(contact: CondensedContact, one: ContactSolution, other: ContactSolution) -> bool:
    """Whether two searches ended at one point in one way; a body that nothing holds counts as one wherever it is."""
    if one.status is not other.status or one.status in NOWHERE:
        return one.status is other.status
    U, T = contact.scales
    R, ell = contact.rigid_motions, contact.equilibrium
    apart = one.displacement - other.displacement
    apart = apart - R @ np.linalg.solve(ell.T @ R, ell.T @ apart)
    return _near(one.pressure / T, other.pressure / T) and bool(np.abs(apart).max() <= SAME * U)


def _near(one: Array, other: Array) -> bool:
    return bool(np.abs(one - other).max() <= SAME * (1.0 + np.abs(one).max()))
