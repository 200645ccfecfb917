"""Random starts of the local solver, and what is found from many of them: which ends, and how often each."""

import json
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from bemcontact.choices import StartName
from bemcontact.contact import Array, CondensedContact
from bemcontact.errors import OptionError, SpecError
from bemcontact.formulations.formulation import Formulation, FormulationOptions, Start, ensure_whole
from bemcontact.formulations.program import contact_residual
from bemcontact.solution import ContactSolution, Status
from bemcontact.text_file import text_of

SPREAD = 2.0
"""Largest random pressure over T, and size of a random displacement over U."""
SAME = 1e-6
"""Difference of pressures over T, and of displacements over U, relative to their size, below which ends are one."""
LISTED = 8
"""Ends that are listed for a person."""
NOWHERE = (Status.INFEASIBLE, Status.UNBOUNDED)
"""Ends that are proofs and no points: all of a kind are one, and an objective means nothing there."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class End:
    """Where searches ended.

    Parameters
    ----------
    solution : of the first search that ended here, not polished
    count : how many did
    first_start : number of the first start that led here, from 0
    objective : scaled, of the statement itself; zero at the contact state; None if infeasible or unbounded
    residual : of the contact conditions and equations, relative to the scales; it tells the contact state
    iterations : least and most of those who did
    """

    solution: ContactSolution
    count: int
    first_start: int
    objective: float | None
    residual: float
    iterations: tuple[int, int]

    def __repr__(self) -> str:
        """The line of `str` in brackets."""
        return f"<End: {self}>"

    def __str__(self) -> str:
        """One line: how often, where, in how many iterations."""
        least, most = self.iterations
        where = "" if self.objective is None else f"objective {self.objective:.1e}, residual {self.residual:.1e}, "
        iterations = f"{most} iteration{'s' if most != 1 else ''}" if least == most else f"{least} to {most} iterations"
        return f"{self.count} x {self.solution.status.name.lower().replace('_', ' ')}, {where}{iterations}"

    def to_dict(self) -> dict[str, Any]:
        """Give it as numbers and texts, ready for JSON."""
        numbers = ("count", "first_start", "objective", "residual")
        return {
            "status": self.solution.status.name.lower(),
            **{name: getattr(self, name) for name in numbers},
            "iterations": list(self.iterations),
            "pressure": self.solution.pressure.tolist(),
            "normal_displacement": self.solution.displacement.tolist(),
        }


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RandomStarts:
    """What was found from random starts.

    Parameters
    ----------
    formulation : name of the statement
    count, seed : of the starts
    ends : the nearest to the contact state first
    """

    formulation: str
    count: int
    seed: int
    ends: tuple[End, ...]

    @property
    def solved(self) -> int:
        """How many searches ended at a contact state."""
        return sum(end.count for end in self.ends if end.solution.status is Status.SOLVED)

    def __repr__(self) -> str:
        """One line: formulation, how many ended where they should."""
        return f"<RandomStarts of {self.formulation}: {self._head}, {len(self.ends)} distinct>"

    def __str__(self) -> str:
        """One line for each of the first ends: how often, where."""
        lines = [self._head, *map(str, self.ends[:LISTED])]
        if more := self.ends[LISTED:]:
            lines.append(f"and {len(more)} more ends, of {sum(end.count for end in more)} starts")
        return "\n".join(lines)

    @property
    def _head(self) -> str:
        return f"{self.solved} of {self.count} random starts (seed {self.seed}) end at the contact state"

    def to_dict(self) -> dict[str, Any]:
        """Give it as numbers, lists and texts, ready for JSON."""
        return {
            "formulation": str(self.formulation),
            "count": self.count,
            "seed": self.seed,
            "solved": self.solved,
            "ends": [end.to_dict() for end in self.ends],
        }


def random_points(condensed: CondensedContact, count: int, seed: int = 0) -> tuple[Start, ...]:
    """Draw starts: pressures even in [0, 2T], displacements normal with deviation 2U, the body moved likewise.

    Parameters
    ----------
    condensed : CondensedContact
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
    U, T = condensed.scales
    motions = condensed.rigid_motions / np.abs(condensed.rigid_motions).max(axis=0, initial=0.0)
    points = []
    for number in range(count):
        pressure = rng.uniform(0.0, SPREAD, condensed.size)
        displacement = SPREAD * (rng.standard_normal(condensed.size) + motions @ rng.standard_normal(motions.shape[1]))
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
        condensed: CondensedContact,
        solve: Formulation,
        options: FormulationOptions,
        progress: Callable[[int], object] | None = None,
    ) -> tuple[ContactSolution, RandomStarts | None]:
        """Solve from the start; of several random ones from the first that led to the best end, with all the ends."""
        if isinstance(self.start, Start):
            return solve(condensed, replace(options, start=self.start)), None
        if not self.is_random:
            return solve(condensed, options), None
        points = random_points(condensed, self.count or 1, self.seed or 0)
        if self.count is None:
            return solve(condensed, replace(options, start=points[0])), None
        found = search_from(condensed, solve, options, self.count, self.seed or 0, progress)
        return solve(condensed, replace(options, start=points[found.ends[0].first_start])), found


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
    condensed: CondensedContact,
    solve: Formulation,
    options: FormulationOptions | None = None,
    count: int = 100,
    seed: int = 0,
    progress: Callable[[int], object] | None = None,
) -> RandomStarts:
    """Solve a statement from random starts, without polish, and sort the ends.

    Parameters
    ----------
    condensed : CondensedContact
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
    for number, start in enumerate(random_points(condensed, count, seed)):
        found = solve(condensed, replace(options, start=start))
        name = found.formulation
        same = next((i for i, end in enumerate(ends) if _same(condensed, end.solution, found)), None)
        if same is None:
            ends.append(_end(condensed, found, number))
        else:
            least, most = ends[same].iterations
            iterations = min(least, found.iterations), max(most, found.iterations)
            ends[same] = replace(ends[same], count=ends[same].count + 1, iterations=iterations)
        if progress:
            progress(number + 1)
    ordered = tuple(sorted(ends, key=lambda end: (end.solution.status is not Status.SOLVED, end.residual)))
    return RandomStarts(formulation=name, count=count, seed=seed, ends=ordered)


def _end(condensed: CondensedContact, found: ContactSolution, number: int) -> End:
    """The first search that ended here."""
    if found.search is None:
        raise OptionError(f"{found.formulation} has no start to choose; take qp1 or qp2")
    return End(
        solution=found,
        count=1,
        first_start=number,
        objective=None if found.status in NOWHERE else found.search.objective,
        residual=contact_residual(condensed, found),
        iterations=(found.iterations, found.iterations),
    )


def _same(condensed: CondensedContact, one: ContactSolution, other: ContactSolution) -> bool:
    """Whether two searches ended at one point in one way; a body that nothing holds counts as one wherever it is."""
    if one.status is not other.status or one.status in NOWHERE:
        return one.status is other.status
    U, T = condensed.scales
    R, ell = condensed.rigid_motions, condensed.equilibrium
    apart = one.displacement - other.displacement
    apart = apart - R @ np.linalg.solve(ell.T @ R, ell.T @ apart)
    return _near(one.pressure / T, other.pressure / T) and bool(np.abs(apart).max() <= SAME * U)


def _near(one: Array, other: Array) -> bool:
    return bool(np.abs(one - other).max() <= SAME * (1.0 + np.abs(one).max()))
