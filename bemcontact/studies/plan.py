"""The members of a study: a grid of values, the problem of each member, and its key in the journal."""

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import field
from itertools import islice
from math import prod
from typing import Any, Unpack

from bemcontact.analysis.solve import asked, ensure_kind
from bemcontact.analysis.variation import case_of
from bemcontact.errors import Issue, OptionError, ProblemError
from bemcontact.frozen import frozen
from bemcontact.options import AskingKeywords
from bemcontact.problems.problem import Problem
from bemcontact.problems.wording import unknown_word
from bemcontact.studies.axes import CASE, Axis, as_floats, axes_of, located_in
from bemcontact.version import __version__

ACTING = ("conditions", "loads", "tools", "load_cases", CASE)
"""Parts of a problem on which the matrix does not depend, as long as the same places are held."""
TOGETHER = 16
"""Largest number of members that are condensed together."""


@frozen
class StudyPlan:
    """A problem and the axes of its study; the first axis changes slowest.

    Parameters
    ----------
    problem : without variants, unless they are varied
    axes : one or more
    stresses : whether the largest stresses of members are looked for
    """

    problem: Problem
    axes: tuple[Axis, ...]
    stresses: bool = False
    _variants: dict[str, Problem] = field(default_factory=dict, repr=False)

    def __len__(self) -> int:
        """Return the number of members."""
        return prod(len(axis.values) for axis in self.axes)

    def positions(self, number: int) -> tuple[int, ...]:
        """Position of a member on each axis."""
        found: list[int] = []
        for axis in reversed(self.axes):
            number, position = divmod(number, len(axis.values))
            found.append(position)
        return tuple(reversed(found))

    def values(self, number: int) -> dict[str, Any]:
        """Value on each axis, by the name of the axis."""
        return {
            axis.name: axis.values[position] for axis, position in zip(self.axes, self.positions(number), strict=True)
        }

    def member(self, number: int) -> Problem:
        """The problem of a member; `ProblemError` if its values do not go together."""
        return self.problem_with(self.values(number))

    def problem_with(self, values: Mapping[str, Any]) -> Problem:
        """The problem with a value on some axes; `ProblemError` if it is wrong."""
        problem, changes, factors = self.problem, dict[str, Any](), dict[str, float]()
        for axis in self.axes:
            if axis.name not in values:
                continue
            if axis.of_variants:
                problem = self._variant(values[axis.name])
                continue
            for key in axis.keys:
                case = case_of(self.problem, key)
                (changes if case is None else factors)[key if case is None else case] = values[axis.name]
        problem = problem.with_values(changes) if changes else problem
        return problem.with_factors({**problem.factors(), **factors}) if factors else problem

    def _variant(self, name: str) -> Problem:
        """The problem of a variant, made once."""
        if name not in self._variants:
            self._variants[name] = self.problem.variant(name)
        return self._variants[name]

    def digest(self) -> str:
        """What all members have in common, as a short text: the problem and the version of the program."""
        return hashlib.sha256(f"{__version__}\n{self.problem.model_dump_json()}".encode()).hexdigest()

    def keys(self) -> list[str]:
        """Key of each member in the journal; it depends on problem, values, version and `stresses` alone."""
        digest, written = self.digest(), {axis.name: axis.written for axis in self.axes}
        members = map(self.values, range(len(self)))
        values = (sorted((written[name], as_floats(value)) for name, value in its.items()) for its in members)
        texts = (json.dumps([digest, its, "stresses"] if self.stresses else [digest, its]) for its in values)
        return [hashlib.sha256(text.encode()).hexdigest()[:32] for text in texts]

    @property
    def shares(self) -> tuple[bool, ...]:
        """Whether members that differ on an axis alone may have the same matrix."""
        return tuple(all(_acts(path) for path in axis.paths) for axis in self.axes)

    def groups(self) -> Iterator[list[int]]:
        """Members by number, those together that may be condensed together; alone where a mesh is searched for."""
        if not any(self.shares):
            yield from ([number] for number in range(len(self)))
            return
        together: dict[tuple[int, ...], list[int]] = {}
        for number in range(len(self)):
            apart = zip(self.positions(number), self.shares, strict=True)
            together.setdefault(tuple(position for position, shared in apart if not shared), []).append(number)
        for numbers in together.values():
            rest, most = iter(numbers), TOGETHER if self._has_its_mesh(numbers[0]) else 1
            while group := [*islice(rest, most)]:
                yield group

    def _has_its_mesh(self, number: int) -> bool:
        """Whether the mesh of a member is the one that it states."""
        try:
            return not self.member(number).adapts
        except ProblemError:
            return False

    def ensure_possible(self, first: int = 0, last: int | None = None) -> None:
        """Refuse values that are wrong by themselves: each value of each axis, with the first value of the variants.

        `first` and `last` choose some of them, by number in the order of the axes.
        """
        fixed = {axis.name: axis.values[0] for axis in self.axes if axis.of_variants}
        pairs = ((axis, value) for axis in self.axes for value in axis.values)
        for axis, value in islice(pairs, first, last):
            try:
                self.problem_with({**fixed, axis.name: value})
            except ProblemError as error:
                raise located_in(axis, value, error) from None


def _acts(path: tuple[str | int, ...]) -> bool:
    """Whether a key changes gaps and loads only."""
    return path[0] in ACTING or (path[0] == "contact_zones" and path[2:3] == ("surface",))


def study_plan(problem: Problem, vary: Mapping[Any, Any], **asking: Unpack[AskingKeywords]) -> StudyPlan:
    """Plan a study; each load case is a member by itself where none of them is chosen.

    `ProblemError` if an axis is wrong. Its values are checked by `ensure_possible`, which takes its time.
    """
    ensure_kind(problem, Problem)
    problem = asked(problem, asking)
    axes = axes_of(vary, problem.units)
    if not any(axis.of_variants for axis in axes):
        problem = problem.model_copy(update={"variants": {}})
    elif not problem.variants:
        raise OptionError(Issue(path=("variants",), message="there are no variants to vary"))
    known = {CASE: problem.case_names}
    for axis in axes:
        for name in axis.values if axis.keys[0] in known else ():
            if name not in known[axis.keys[0]]:
                raise OptionError(unknown_word("load case", name, known[axis.keys[0]]))
    varied = {key for axis in axes for key in axis.keys}
    factors = any(case_of(problem, key) for key in varied)
    if problem.load_cases and problem.case is None and CASE not in varied and not factors:
        axes = (*axes, Axis(keys=(CASE,), values=problem.case_names))
    return StudyPlan(problem=problem, axes=axes)
