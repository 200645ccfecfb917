"""Formulations compared under all load cases and combinations of a problem, on one mesh."""

from bemcontact.analysis.compare import compared_on, settings_of
from bemcontact.analysis.load_cases import CaseResults, prepared_cases
from bemcontact.analysis.mesh_study import LevelRecord, MeshLevel, Settings, versions
from bemcontact.analysis.solve import Progress, Stopwatch
from bemcontact.assessment.accuracy import together
from bemcontact.cached import cached_property
from bemcontact.contact.record import UnitsRecord, units_record
from bemcontact.frozen import frozen
from bemcontact.options import ComparisonOptions
from bemcontact.problems.problem import Problem
from bemcontact.serialization import Record, Recorded
from bemcontact.threads import one_thread


class CaseComparisonsRecord(Record):
    """Formulations compared under all load cases and combinations of a problem."""

    name: str
    """Name of the problem."""
    certified: bool
    """Whether all solutions under all load cases are proved to be the contact state."""
    units: UnitsRecord
    """Labels of the units."""
    settings: Settings
    """Formulations, weights, penalties and starts that are compared."""
    cases: dict[str, LevelRecord]
    """Comparison by the name of the load case or combination."""
    versions: dict[str, str]
    """Versions of bemcontact, Python and the packages used, by name."""
    seconds: float
    """Time of all stages."""


@frozen
class CaseComparisons(Recorded):
    """Formulations compared under all load cases and combinations of a problem, on one mesh.

    Parameters
    ----------
    settings : formulations, weights, penalties and starts that are compared
    levels : the comparison by the name of the load case or combination
    answers : the direct solutions of all
    """

    settings: Settings
    levels: dict[str, MeshLevel]
    answers: CaseResults

    def __repr__(self) -> str:
        """One line: name, cases, whether all formulations agree."""
        agree = "all certified" if self.certified else "NOT all certified"
        return f"<CaseComparisons of {self.answers.name!r}: {', '.join(self.levels)}: {agree}>"

    @property
    def certified(self) -> bool:
        """Whether all solutions under all load cases are proved to be the contact state."""
        return all(level.certified for level in self.levels.values())

    @property
    def holds(self) -> bool | None:
        """Whether all are certified, and the mesh is as accurate as was asked; None if errors are not assessed."""
        return together((self.certified, self.answers.holds))

    @cached_property
    def seconds(self) -> float:
        """Time of all stages [s]."""
        own = (sum(level.answer.seconds.values()) for level in self.levels.values())
        return sum(self.answers.seconds.values()) + sum(own)

    def record(self) -> CaseComparisonsRecord:
        """Return the record that is written as JSON."""
        return CaseComparisonsRecord(
            name=self.answers.name,
            certified=self.certified,
            units=units_record(next(iter(self.levels.values())).comparison.contact),
            settings=self.settings,
            cases={name: level.record() for name, level in self.levels.items()},
            versions=versions(),
            seconds=self.seconds,
        )


@one_thread
def compare_cases(
    options: ComparisonOptions, problem: Problem, progress: Progress | None = None, changes: tuple[str, ...] = ()
) -> CaseComparisons:
    """Compare formulations under all load cases and combinations; all share one mesh.

    `changes` are those made to the spec with --set. `ProblemError` as of `solve_cases`.
    """
    shared = Stopwatch(progress=progress)
    levels = {}
    for name, prepared in prepared_cases(problem, shared).items():
        watch = Stopwatch(progress=None if progress is None else _under(name, progress))
        levels[name] = compared_on(options, prepared, watch)
    answers = CaseResults(
        name=problem.name,
        results={name: level.answer for name, level in levels.items()},
        seconds=shared.seconds,
    )
    return CaseComparisons(settings=settings_of(options, changes), levels=levels, answers=answers)


def _under(name: str, progress: Progress) -> Progress:
    """Progress that writes the load case before the name of each stage."""
    return lambda stage, now: progress(f"{name}: {stage}", now)
