"""Starts of the local solver: random, chosen by a person, read from a file, and many searches one after the other."""

import json
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.multistart import End, RandomStarts
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.errors import OptionError, SpecError
from bemcontact.files.text import text_of
from bemcontact.formulations.formulation import Formulation, FormulationOptions, Start, ensure_whole
from bemcontact.formulations.search import contact_residual
from bemcontact.options import FormulationName, StartName

SPREAD = 2.0
"""Largest random pressure over T, and size of a random displacement over U."""
SAME = 1e-6
"""Difference of pressures over T, and of displacements over U, relative to their size, below which ends are one."""
NOWHERE = (Status.INFEASIBLE, Status.UNBOUNDED)
"""Ends that are proofs and no points: all of a kind are one, and an objective means nothing there."""


def random_points(contact: CondensedContact, count: int, seed: int = 0) -> tuple[Start, ...]:
    """Draw starts: pressures even in [0, 2T], displacements normal with deviation 2U, the body moved likewise.

    Parameters
    ----------
    contact : CondensedContact
    count : how many, at least 1
    seed : the same seed gives the same starts, in any units, and fewer starts are the first of more

    Returns
    -------
    tuple of Start

    Raises
    ------
    OptionError
        A count below 1, a negative seed, or numbers that are not whole.
    """
    ensure_whole(count, "number of starts", 1)
    ensure_whole(seed, "seed", 0)
    rng = np.random.default_rng(seed)
    U, T = contact.scales
    motions = contact.rigid_motions / np.abs(contact.rigid_motions).max(axis=0, initial=0.0)
    points = []
    for number in range(count):
        pressure = rng.uniform(0.0, SPREAD, contact.size)
        displacement = SPREAD * (rng.standard_normal(contact.size) + motions @ rng.standard_normal(motions.shape[1]))
        label = f"random point {number}, seed {seed}"
        points.append(Start(pressure=pressure * T, displacement=displacement * U, label=label))
    return tuple(points)


@dataclass(frozen=True, kw_only=True)
class StartChoice:
    """Which start a person asked for, checked before there is a problem to fit it.

    Parameters
    ----------
    start : a `StartName` or its value, or a `Start`; None for random ones if there is a seed or a count, else null
    seed, count : of random starts, None for 0 and 1
    """

    start: Start | str | None = None
    seed: int | None = None
    count: int | None = None

    def __post_init__(self) -> None:
        """Refuse an unknown start, and a seed or a count beside a start that is not random."""
        named = isinstance(self.start, str) and self.start in [*StartName]
        if not (self.start is None or named or isinstance(self.start, Start)):
            found = f"'{self.start}'" if isinstance(self.start, str) else f"of type {type(self.start).__name__}"
            raise OptionError(f"there is no start {found}; take {', '.join(StartName)}, or a Start of your own")
        if self.count is not None:
            ensure_whole(self.count, "number of starts", 1)
        if self.seed is not None:
            ensure_whole(self.seed, "seed", 0)
        if not self.is_random and not (self.seed is None and self.count is None):
            raise OptionError("a seed or a number of starts goes with random starts; leave out the other start")

    @property
    def is_random(self) -> bool:
        """Whether random starts were asked for, by their name or by a seed or a count."""
        if self.start is None:
            return not (self.seed is None and self.count is None)
        return self.start == StartName.RANDOM

    def ensure_used(self, formulation: str, used: bool) -> None:
        """Refuse a start for a formulation whose solver chooses its own."""
        if not used and (self.is_random or isinstance(self.start, Start)):
            raise OptionError(
                f"{formulation} has no use for the option 'start', its solver finds its own; leave it out"
            )

    def search(
        self,
        contact: CondensedContact,
        solve: Formulation,
        options: FormulationOptions,
        progress: Callable[[int], object] | None = None,
    ) -> tuple[ContactSolution, RandomStarts | None]:
        """Solve from the start; of several random ones from the first that led to the best end, with all the ends."""
        if isinstance(self.start, Start):
            return solve(contact, replace(options, start=self.start)), None
        if not self.is_random:
            return solve(contact, options), None
        points = random_points(contact, self.count or 1, self.seed or 0)
        if self.count is None:
            return solve(contact, replace(options, start=points[0])), None
        found = search_from(contact, solve, options, self.count, self.seed or 0, progress)
        return solve(contact, replace(options, start=points[found.ends[0].first_start])), found


def read_start(path: str | os.PathLike[str]) -> Start:
    """Read where a solver is to start from a file of results, as `bemcontact solve --json` writes it.

    Parameters
    ----------
    path : a JSON file with the lists `pressure` and `normal_displacement`, one number for each contact point

    Returns
    -------
    Start

    Raises
    ------
    SpecError
        There is no such file, it is no JSON, or a list is missing or holds other things than numbers.
    """
    name, text = Path(path).name, text_of(path)
    try:
        found = json.loads(text)
    except json.JSONDecodeError as error:
        raise SpecError(
            f"{path}:{error.lineno}:{error.colno}: is no JSON ({error.msg}); name a file of results"
        ) from None
    lists = []
    for key in ("pressure", "normal_displacement"):
        values = found.get(key) if isinstance(found, dict) else None
        if not isinstance(values, list) or not all(type(value) in (int, float) for value in values):
            raise SpecError(
                f"{path}: has no list '{key}' of numbers, one for each contact point; name a file that "
                "`bemcontact solve --json FILE` has written"
            )
        lists.append(values)
    return Start(pressure=np.array(lists[0], float), displacement=np.array(lists[1], float), label=f"file {name}")


def search_from(
    contact: CondensedContact,
    solve: Formulation,
    options: FormulationOptions | None = None,
    count: int = 100,
    seed: int = 0,
    progress: Callable[[int], object] | None = None,
) -> RandomStarts:
    """Solve a statement from random starts, without polish, and sort the ends.

    Parameters
    ----------
    contact : CondensedContact
    solve : `qp1.solve` or `qp2.solve`
    options : of the statement; its start is replaced, and nothing is polished, which would hide where a search ended
    count, seed : of `random_points`
    progress : called after each search with the number of searches done

    Returns
    -------
    RandomStarts

    Raises
    ------
    OptionError
        As `solve` and `random_points`.
    """
    options = replace(options or FormulationOptions(), polish=False)
    ends: list[End] = []
    name = ""
    for number, start in enumerate(random_points(contact, count, seed)):
        found = solve(contact, replace(options, start=start))
        name = found.formulation
        same = next((i for i, end in enumerate(ends) if _same(contact, end.solution, found)), None)
        if same is None:
            ends.append(_end(contact, found, number))
        else:
            least, most = ends[same].iterations
            iterations = min(least, found.iterations), max(most, found.iterations)
            ends[same] = replace(ends[same], count=ends[same].count + 1, iterations=iterations)
        if progress:
            progress(number + 1)
    ordered = tuple(sorted(ends, key=lambda end: (end.solution.status is not Status.SOLVED, end.residual)))
    return RandomStarts(formulation=FormulationName(name), count=count, seed=seed, ends=ordered)


def _end(contact: CondensedContact, found: ContactSolution, number: int) -> End:
    """The first search that ended here."""
    if found.search is None:
        raise OptionError(f"{found.formulation} has no start to choose; take qp1 or qp2")
    return End(
        solution=found,
        count=1,
        first_start=number,
        objective=None if found.status in NOWHERE else found.search.objective,
        residual=contact_residual(contact, found),
        iterations=(found.iterations, found.iterations),
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
