"""A comparison on one mesh or several, the content of a report."""

import platform
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version

from bemcontact.analysis.result import Result
from bemcontact.assessment.accuracy import Accuracy, together
from bemcontact.assessment.comparison import Comparison, ComparisonRecord
from bemcontact.assessment.convergence import Convergence, convergence
from bemcontact.assessment.penetration import Penetration
from bemcontact.cached import cached_property
from bemcontact.contact.record import UnitsRecord, units_record
from bemcontact.frozen import frozen
from bemcontact.options import FormulationName, Weights
from bemcontact.problems.problem import Problem
from bemcontact.reference import Expected, Score, expected, score
from bemcontact.serialization import Record, Recorded
from bemcontact.version import __version__

ALTERED = "the problem was changed (--set), but this reference was not: shown, not judged"
"""Remark on a reference that belongs to the problem before it was changed."""
VERSIONS = ("numpy", "scipy", "cvxpy", "clarabel", "matplotlib", "jinja2")
"""Packages whose versions a report states."""


class Settings(Record):
    """Options of a comparison as they act, with penalties and seed filled in, and the changes to the problem."""

    formulations: tuple[FormulationName, ...]
    """Formulations beside the direct solution."""
    weights: tuple[Weights, ...]
    """Weights of the objectives."""
    penalties: tuple[float, ...]
    """Penalties μ of QP2, free of units."""
    starts: int | None
    """Number of random starts of QP1 and QP2, beside the null start."""
    seed: int
    """Seed of the random starts."""
    changes: tuple[str, ...]
    """Changes made to the problem with --set."""


class LevelRecord(Record):
    """The comparison on one mesh; JSON has what belongs to the direct solution beside it."""

    refine: int
    """Number of parts into which each element is cut."""
    dof: int | None
    """Number of unknowns of the boundary elements, two for each node; null for a condensed problem."""
    seconds: dict[str, float]
    """Time of each stage."""
    notes: tuple[str, ...]
    """Notes on the answer and its mesh."""
    sides: dict[str, tuple[str, str]]
    """The bodies of each contact, first the one on which its force acts; the second is '' for a rigid surface. Empty
    if an only body touches rigid surfaces."""
    force_balance: float | None
    """Resultant of all forces on the body over their sum, from the recovered tractions; null without a boundary."""
    equilibrium_slack: float | None
    """Imbalance of the discrete equations relative to the loads; null without a boundary."""
    accuracy: Accuracy
    """Accuracy of the mesh: error bars, and whether they are as small as was asked."""
    penetration: Penetration | None
    """Deepest penetration of the boundary that is not tolerated; null if there is none, or for a condensed problem."""
    comparison: ComparisonRecord
    """The formulations side by side."""
    references: tuple[Expected, ...]
    """Values that the references of the problem expect at these contact points."""
    scores: tuple[Score, ...]
    """Differences between the direct solution and the references."""


class MeshStudyRecord(Record):
    """A problem compared on one mesh or several; JSON has the verdict before the numbers of each mesh.

    [L] is the unit of length and [p] that of pressure, force over length squared. A number without either has no unit.
    """

    name: str
    """Name of the problem."""
    description: str
    """Description as the problem has it."""
    certified: bool
    """Whether all solutions on all meshes are proved to be the contact state, and the body penetrates no surface."""
    heading: str
    """What is proved of the solution of the equations, in a few words."""
    verdict: str
    """Result of the comparison on the finest mesh, in sentences."""
    units: UnitsRecord
    """Labels of the units."""
    settings: Settings
    """Formulations, weights, penalties and starts that are compared."""
    levels: list[LevelRecord]
    """Comparison on each mesh, the coarsest first."""
    convergence: Convergence | None
    """Change of the solution with the mesh; null on a single one."""
    versions: dict[str, str]
    """Versions of bemcontact, Python and the packages used, by name."""
    seconds: float
    """Time of all stages on all meshes."""


@frozen
class MeshLevel:
    """A problem on one mesh."""

    refine: int
    """Number of parts into which each element is cut."""
    comparison: Comparison
    """The formulations side by side."""
    answer: Result
    """The direct solution, with the boundary behind it."""
    outdated: frozenset[str] = frozenset()
    """Names of references that belong to the problem before it was changed."""

    @cached_property
    def expected(self) -> tuple[Expected, ...]:
        """Values that the references of the problem expect at the contact points."""
        problem = self.answer.problem
        items = () if problem is None else expected(problem, self.answer.contact)
        items = (_outdated(item) if item.name in self.outdated else item for item in items)
        return tuple(item.without_peak(self.answer.accuracy.infinite) for item in items)

    @cached_property
    def scores(self) -> tuple[Score, ...]:
        """Differences between the direct solution and the references."""
        answer = self.answer
        return score(self.expected, answer.contact, answer.footprint, answer.solution.pressure)

    @property
    def certified(self) -> bool:
        """Whether all solutions are proved to be the contact state, and the body penetrates no rigid surface."""
        return self.comparison.certified and self.answer.penetration is None

    def record(self) -> LevelRecord:
        """Return the record that is written as JSON."""
        answer = self.answer
        return LevelRecord(
            refine=self.refine,
            dof=answer.degrees_of_freedom,
            seconds=answer.seconds,
            notes=answer.notes,
            sides=answer.sides,
            force_balance=answer.residuals.force_balance,
            equilibrium_slack=answer.equilibrium_slack,
            accuracy=answer.accuracy,
            penetration=answer.penetration,
            comparison=self.comparison.record(),
            references=self.expected,
            scores=self.scores,
        )


@frozen
class MeshStudy(Recorded):
    """A problem compared on one mesh or several."""

    settings: Settings
    """Formulations, weights, penalties and starts that are compared."""
    levels: tuple[MeshLevel, ...]
    """Comparison on each mesh, the coarsest first."""

    def __repr__(self) -> str:
        """One line: name, meshes, verdict."""
        return f"<MeshStudy of {self.name!r} on {len(self.levels)} meshes: {self.verdict}>"

    @property
    def finest(self) -> MeshLevel:
        """The level of the finest mesh, which gives the answer."""
        return self.levels[-1]

    @property
    def name(self) -> str:
        """Name of the problem."""
        return self.finest.comparison.contact.name

    @property
    def problem(self) -> Problem | None:
        """The problem on the finest mesh; None if a condensed problem was given."""
        return self.finest.answer.problem

    @property
    def certified(self) -> bool:
        """Whether all solutions on all meshes are proved to be the contact state, which penetrates no surface."""
        return all(level.certified for level in self.levels)

    @property
    def heading(self) -> str:
        """What is proved of the solution of the equations, in a few words."""
        deepest = self.finest.answer.penetration
        return self.finest.comparison.heading if deepest is None else str(deepest.kind)

    @property
    def verdict(self) -> str:
        """What the comparison on the finest mesh shows, in sentences."""
        deepest, shown = self.finest.answer.penetration, self.finest.comparison.verdict
        return shown if deepest is None else deepest.before(shown)

    @property
    def holds(self) -> bool | None:
        """Whether all solutions are certified, and the finest mesh is as accurate as was asked.

        None if they are certified, and mesh errors are not assessed.
        """
        return together((self.certified, self.finest.answer.accuracy.holds))

    @cached_property
    def convergence(self) -> Convergence | None:
        """Change of the solution with the mesh; None on a single one."""
        if len(self.levels) == 1:
            return None
        return convergence(
            [level.refine for level in self.levels],
            [level.answer.footprint for level in self.levels],
            [level.comparison.matrices[0].asymmetry for level in self.levels],
        )

    @property
    def seconds(self) -> float:
        """Time of all stages on all meshes [s]."""
        return sum(sum(level.answer.seconds.values()) for level in self.levels)

    def record(self) -> MeshStudyRecord:
        """Return the record that is written as report.json."""
        problem = self.problem
        return MeshStudyRecord(
            name=self.name,
            description="" if problem is None else problem.description,
            certified=self.certified,
            heading=self.heading,
            verdict=self.verdict,
            units=units_record(self.finest.comparison.contact),
            settings=self.settings,
            levels=[level.record() for level in self.levels],
            convergence=self.convergence,
            versions=versions(),
            seconds=self.seconds,
        )


def _outdated(expected: Expected) -> Expected:
    """A reference that belongs to the problem before it was changed."""
    remark = f"{expected.remark}; {ALTERED}" if expected.remark else ALTERED
    return replace(expected, in_range=False, remark=remark)


def versions() -> dict[str, str]:
    """Versions of bemcontact, Python and the packages of `VERSIONS`, by name."""
    numbers = {"bemcontact": __version__, "python": platform.python_version()}
    for name in VERSIONS:
        try:
            numbers[name] = version(name)
        except PackageNotFoundError:
            numbers[name] = "unknown"
    return numbers
