"""All load cases and combinations of a problem, solved on one condensation and assessed."""

from typing import Unpack

from bemcontact.analysis.result import Result, ResultRecord
from bemcontact.analysis.solve import (
    Prepared,
    Progress,
    Stopwatch,
    asked,
    assessed,
    ensure_kind,
    mesh_of,
    read_options,
)
from bemcontact.assessment.accuracy import together
from bemcontact.errors import ProblemError
from bemcontact.formulations.starts import with_start_read
from bemcontact.frozen import frozen
from bemcontact.options import FormulationName, SolveOptions, SolvingKeywords, Weights
from bemcontact.problems.problem import Problem
from bemcontact.serialization import Record, Recorded
from bemcontact.threads import one_thread
from bemcontact.version import __version__
from bemcontact.views import Tabular


class CasesRecord(Record):
    """Results of all load cases and combinations of a problem."""

    name: str
    """Name of the problem."""
    version: str
    """Version of bemcontact."""
    certified: bool
    """Whether all of them are proved to be the contact state."""
    worst: str | None
    """Name of the load case or combination with the largest peak pressure; null if nothing touches in any, or if a peak
    is infinite."""
    cases: dict[str, ResultRecord]
    """Result by the name of the load case or combination."""
    seconds: dict[str, float]
    """Time of each stage that they share."""


@frozen
class CaseResults(Recorded, Tabular):
    """The results of all load cases and combinations of a problem.

    Parameters
    ----------
    name : of the problem
    results : by the name of the load case or combination
    seconds : spent on each stage that they share
    """

    name: str
    results: dict[str, Result]
    seconds: dict[str, float]

    def __repr__(self) -> str:
        """One line: name, cases, verdict, largest peak."""
        worst = "no contact" if self.worst is None else f"largest peak pressure in '{self.worst}'"
        worst = f"infinite peak pressure in {', '.join(self.infinite)}" if self.infinite else worst
        equations = "unique solutions proved" if self.certified else "NOT all solutions proved"
        accuracies = [result.accuracy for result in self.results.values()]
        mesh = max(accuracies, key=lambda item: (item.met is None, item.worst)).in_short
        return f"<CaseResults of {self.name!r}: {', '.join(self.results)}: {equations}, {mesh}, {worst}>"

    @property
    def certified(self) -> bool:
        """Whether each of them is proved to be the solution."""
        return all(result.certified for result in self.results.values())

    @property
    def holds(self) -> bool | None:
        """Whether each of them is certified, and as accurate as was asked; None if mesh errors are not assessed."""
        return together(result.holds for result in self.results.values())

    @property
    def infinite(self) -> tuple[str, ...]:
        """The cases and combinations with an infinite peak pressure."""
        return tuple(name for name, result in self.results.items() if result.accuracy.infinite)

    @property
    def worst(self) -> str | None:
        """The case or combination with the largest peak pressure; None without contact, or if a peak is infinite."""
        if self.infinite:
            return None
        peaks = {name: item.footprint.peak.pressure for name, item in self.results.items() if item.footprint.peak}
        return max(peaks, key=lambda name: peaks[name], default=None)

    def record(self) -> CasesRecord:
        """Return the record that is written as JSON."""
        return CasesRecord(
            name=self.name,
            version=__version__,
            certified=self.certified,
            worst=self.worst,
            cases={name: result.record() for name, result in self.results.items()},
            seconds=self.seconds,
        )


@one_thread
def solve_cases(
    problem: Problem,
    formulation: FormulationName | str = FormulationName.COMPLEMENTARITY,
    weights: Weights | str = Weights.TRIBUTARY,
    **options: Unpack[SolvingKeywords],
) -> CaseResults:
    """Solve all load cases and combinations of a problem by one formulation; the body is condensed once.

    Parameters
    ----------
    problem : with load cases
    formulation, weights, options : as of `bemcontact.solve`; all cases share one mesh

    Returns
    -------
    CaseResults

    Raises
    ------
    ProblemError
        If the problem states no load case, or one of them has no answer; otherwise as of `bemcontact.solve`.
    """
    read, asking = read_options(formulation, weights, options)
    ensure_kind(problem, Problem)
    return solve_cases_with(read, asked(problem, asking))


@one_thread
def solve_cases_with(options: SolveOptions, problem: Problem, progress: Progress | None = None) -> CaseResults:
    """Solve all load cases and combinations with options, as `solve_cases` does.

    All share one mesh, so that their results can be combined.
    """
    options = with_start_read(options)
    shared, results = Stopwatch(progress=progress), {}
    for name, prepared in prepared_cases(problem, shared).items():
        watch = Stopwatch(progress=progress)
        with watch.stage(name):
            solution, searches = prepared.solve(options)
            results[name] = assessed(prepared, solution, options.weights, watch, searches)
    return CaseResults(name=problem.name, results=results, seconds=shared.seconds)


def prepared_cases(problem: Problem, watch: Stopwatch) -> dict[str, Prepared]:
    """The problem under each load case and combination, condensed on one mesh with its errors under each."""
    ensure_kind(problem, Problem)
    if not problem.load_cases:
        raise ProblemError("the problem states no load cases; bemcontact.solve solves it as it is")
    on_mesh = mesh_of(problem.model_copy(update={"case": None}), watch)
    return {name: Prepared.on_mesh(on_mesh, name) for name in problem.case_names}
