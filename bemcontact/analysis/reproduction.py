"""The paper's problems, shipped with the package and solved again, and quantities to compare with its statements."""

from collections.abc import Callable, Mapping, Sequence
from importlib.resources import files

import numpy as np

from bemcontact import spec
from bemcontact.analysis import compare as comparing
from bemcontact.analysis.mesh_study import LevelRecord, MeshLevel, MeshStudy, versions
from bemcontact.analysis.solve import Progress
from bemcontact.arrays import Array
from bemcontact.contact.record import UnitsRecord
from bemcontact.errors import SpecError
from bemcontact.frozen import frozen
from bemcontact.options import ComparisonOptions, FormulationName
from bemcontact.problems import Problem, Table, Units, Values
from bemcontact.reference.paper import PROBLEMS, PaperProblem, PaperQuantity, PaperStatement
from bemcontact.reference.positions import coordinates
from bemcontact.serialization import Record, Recorded, Vector
from bemcontact.threads import one_thread

FOLDER = "models"
"""Stands in the installed package, and beside the package in a source tree."""
Reading = tuple[float, ...]
"""One number, the smallest and the largest of several, or none."""
STATED_MESH = "stated mesh"
"""The variant of each problem with a mesh that is refined; the problem itself states none."""
LEVEL = 1e-9
"""Part of an extent, or of a scale, below which a difference is round-off."""


class StatementRecord(Record):
    """A statement of the paper on a quantity, and the same quantity as computed here."""

    what: str
    """The quantity."""
    statement: str
    """The paper's statement, in words."""
    unit: str
    """Label of the unit of the computed values."""
    computed: list[Reading]
    """Value of each run: a number, the smallest and the largest, or none."""


class RunRecord(Record):
    """A problem of the paper, or a variant of it, on one mesh."""

    label: str
    """Name of the mesh."""
    variant: str | None
    """Name of the variant; null for the problem as stated."""
    description: str
    """Description of the variant."""
    position: Vector
    """Coordinate of each contact point, in its unit."""
    contact: Reading
    """Smallest and largest coordinate of contact, in its unit; empty without contact."""
    level: LevelRecord
    """The comparison on this mesh, as in report.json."""


class PaperRecord(Record):
    """A problem of the paper: its statements, and the runs that they are compared with."""

    model: str
    """Name of the file in models."""
    name: str
    """Name of the problem in the file."""
    figure: str
    """Figure of the paper."""
    description: str
    """Description in the file."""
    units: UnitsRecord
    """Labels of the units."""
    coordinate: str
    """Symbol of the coordinate of the paper's figure."""
    coordinate_unit: str
    """Label of its unit."""
    certified: bool
    """Whether all solutions of all runs are proved to be the contact state."""
    judged: int
    """Number of quantities that are judged by references, on all meshes of the problem as stated."""
    held: int
    """Number of these quantities that are within what the references allow."""
    statements: list[StatementRecord]
    """Statements of the paper."""
    differs: tuple[str, ...]
    """Differences between the paper and these results, with the reasons."""
    iterations: dict[FormulationName, int]
    """Iterations of QPSOL that the paper prints."""
    runs: list[RunRecord]
    """Variants, then the meshes of the problem as stated, the coarsest first."""


class ReproductionRecord(Record):
    """The problems of the paper, solved again.

    [L] is the unit of length and [p] that of pressure, force over length squared. A number without either has no unit.
    """

    reproduced: bool
    """Whether all solutions are certified and agree with every reference in its range."""
    refine: tuple[int, ...]
    """Number of parts into which each element is cut, on each mesh of a problem as stated."""
    problems: list[PaperRecord]
    """Problems in the order of the paper."""
    versions: dict[str, str]
    """Versions of bemcontact, Python and the packages used, by name."""
    seconds: float
    """Time of all runs."""


@frozen
class Run:
    """A problem of the paper on one mesh."""

    label: str
    """Name of the mesh."""
    variant: str | None
    """Name of the variant; None for the problem as stated."""
    level: MeshLevel
    """The comparison on this mesh."""


@frozen
class PaperStudy:
    """A problem of the paper: a mesh study of the problem as stated, and one of each variant."""

    paper: PaperProblem
    """The paper's statements."""
    study: MeshStudy
    """The problem as its file states it, on all meshes."""
    variants: Mapping[str, MeshStudy]
    """Mesh studies of the variants by name; references are for the problem as stated and do not judge them."""

    @property
    def problem(self) -> Problem:
        """The problem on the finest mesh."""
        assert self.study.problem is not None  # a file states each
        return self.study.problem

    @property
    def meshes(self) -> tuple[Run, ...]:
        """Runs of the problem as stated, the coarsest mesh first."""
        return tuple(Run(label=_mesh_name(level.refine), variant=None, level=level) for level in self.study.levels)

    @property
    def variant_runs(self) -> tuple[Run, ...]:
        """Runs of the variants."""
        labels = self.paper.variants
        return tuple(Run(label=labels[name], variant=name, level=it.finest) for name, it in self.variants.items())

    @property
    def runs(self) -> tuple[Run, ...]:
        """Runs of the variants, then of the problem as stated."""
        return (*self.variant_runs, *self.meshes)

    @property
    def axis(self) -> Values | Table:
        """The reference that has the coordinate of the paper's figure."""
        return along(self.problem)

    @property
    def coordinate_unit(self) -> str:
        """Label of the unit of the coordinate."""
        return "°" if self.axis.against == "angle" else self.problem.units.length

    @property
    def certified(self) -> bool:
        """Whether all formulations on all meshes are proved to be the contact state."""
        return all(study.certified for study in (self.study, *self.variants.values()))

    @property
    def judged(self) -> tuple[bool, ...]:
        """Whether each quantity of each reference that is in its range holds, mesh by mesh."""
        return tuple(score.holds for level in self.study.levels for score in level.scores if score.judged)

    @property
    def reproduced(self) -> bool:
        """Whether all is certified and every judged reference holds."""
        return self.certified and all(self.judged)

    def record(self) -> PaperRecord:
        """Return the record that is written as JSON."""
        problem, paper, axis, runs = self.problem, self.paper, self.axis, self.runs
        return PaperRecord(
            model=paper.model,
            name=problem.name,
            figure=paper.figure,
            description=problem.description,
            units=UnitsRecord(**problem.units.model_dump()),
            coordinate=paper.symbol,
            coordinate_unit=self.coordinate_unit,
            certified=self.certified,
            judged=len(self.judged),
            held=sum(self.judged),
            statements=[
                StatementRecord(
                    what=item.what,
                    statement=item.says,
                    unit=unit_of(item, axis, problem.units),
                    computed=[reading(item, run.level, axis) for run in runs],
                )
                for item in paper.statements
            ],
            differs=paper.differs,
            iterations=dict(paper.iterations),
            runs=[
                RunRecord(
                    label=run.label,
                    variant=run.variant,
                    description="" if run.variant is None else problem.variants[run.variant].description,
                    position=positions(run.level, axis),
                    contact=contact_extent(run.level, axis),
                    level=run.level.record(),
                )
                for run in runs
            ],
        )


@frozen
class Reproduction(Recorded):
    """The problems of the paper, solved again."""

    problems: tuple[PaperStudy, ...]
    """Problems in the order of the paper."""

    def __repr__(self) -> str:
        """One line: how many of them are reproduced."""
        done = sum(item.reproduced for item in self.problems)
        return f"<Reproduction of {len(self.problems)} problems: {done} certified, with all references met>"

    @property
    def reproduced(self) -> bool:
        """Whether all is certified and every judged reference holds."""
        return all(item.reproduced for item in self.problems)

    def record(self) -> ReproductionRecord:
        """Return the record that is written as numbers.json."""
        studies = [study for item in self.problems for study in (item.study, *item.variants.values())]
        return ReproductionRecord(
            reproduced=self.reproduced,
            refine=tuple(level.refine for level in self.problems[0].study.levels),
            problems=[item.record() for item in self.problems],
            versions=versions(),
            seconds=sum(study.seconds for study in studies),
        )


@one_thread
def reproduce(
    refine: Sequence[int] = (1, 4), progress: Progress | None = None, problems: Sequence[PaperProblem] = PROBLEMS
) -> Reproduction:
    """Solve the problems of the paper, with each element cut into `refine` parts, and their variants.

    Variants are not refined. `OptionError` as of `bemcontact.analysis.compare.mesh_study`.
    """
    plan = ComparisonOptions()
    studies = []
    for order, paper in enumerate(problems, 1):
        name = f"problem {order} of {len(problems)}, {paper.model.replace('_', ' ')}"
        studies.append(_paper_mesh_study(plan, paper, refine, _below(progress, name)))
    return Reproduction(problems=tuple(studies))


def _paper_mesh_study(
    plan: ComparisonOptions, paper: PaperProblem, refine: Sequence[int], progress: Progress
) -> PaperStudy:
    """Solve one problem, as stated on all meshes and with its variants."""
    return PaperStudy(
        paper=paper,
        study=comparing.mesh_study(plan, _problem(paper, None), refine, progress),
        variants={name: comparing.mesh_study(plan, _problem(paper, name), (1,), progress) for name in paper.variants},
    )


def _below(progress: Progress | None, name: str) -> Progress:
    """Report each stage of a problem as progress of the problem."""
    return lambda stage, now: progress(name, f"{stage}, {now}" if now else stage) if progress else None


def _problem(paper: PaperProblem, variant: str | None) -> Problem:
    """Read a variant of a problem, or the problem on its stated mesh; references and refinement judge its errors."""
    text, name = shipped_model(paper.model), f"models/{paper.model}.yaml"
    problem = spec.loads(text, name)
    stated = spec.loads(text, name, variant=STATED_MESH if variant is None else variant)
    return stated.model_copy(update={"variants": problem.variants} | ({} if variant else {"name": problem.name}))


def shipped_model(name: str) -> str:
    """YAML text of a shipped problem such as ``cylinder_on_plane``; `SpecError` if there is none of this name."""
    package = files("bemcontact")
    for folder in (package.joinpath(FOLDER), package.joinpath("..", FOLDER)):
        file = folder.joinpath(f"{name}.yaml")
        if file.is_file():
            return file.read_text(encoding="utf-8")
    raise SpecError(f"models/{name}.yaml is not where bemcontact is installed; install the package anew")


def _mesh_name(parts: int) -> str:
    """Name a mesh of the problem as stated."""
    return "base mesh" if parts == 1 else f"{parts} times finer"


def along(problem: Problem) -> Values | Table:
    """Return the first reference of a problem that has a coordinate; `ValueError` if none has."""
    for reference in problem.reference.values():
        if isinstance(reference, Values | Table):
            return reference
    raise ValueError(f"{problem.name}: no reference is a list of values or a table, so that it has no coordinate")


def positions(level: MeshLevel, axis: Values | Table) -> Array:
    """Coordinate (n,) of the contact points [L], or in degrees."""
    contact = level.answer.contact
    return coordinates(axis, contact.points, contact.arc_position)


def contact_extent(level: MeshLevel, axis: Values | Table) -> Reading:
    """Smallest and largest coordinate of the ends of contact [L], or in degrees; empty without contact."""
    intervals = level.answer.footprint.intervals
    if not intervals:
        return ()
    ends = np.array([end for item in intervals for end in (item.start, item.end)])
    arcs = np.array([arc for item in intervals for arc in (item.start_arc, item.end_arc)])
    here = coordinates(axis, ends, arcs)
    low, high = float(here.min()), float(here.max())
    return (0.0 if abs(low) <= LEVEL * abs(high) else low, high)


def reading(statement: PaperStatement, level: MeshLevel, axis: Values | Table) -> Reading:
    """Quantity of a statement in a comparison; empty where it does not exist, such as the ends of no contact."""
    return READERS[statement.quantity](statement, level, axis)


def unit_of(statement: PaperStatement, axis: Values | Table, units: Units) -> str:
    """Label of the unit of the quantity of a statement."""
    match statement.quantity:
        case PaperQuantity.PRESSURE | PaperQuantity.PEAK:
            return units.stress
        case PaperQuantity.FORCE:
            return units.line_force
        case PaperQuantity.CONTACT if axis.against == "angle":
            return "°"
        case PaperQuantity.CONTACT | PaperQuantity.LEAST_GAP:
            return units.length
    return ""


def _pressure(statement: PaperStatement, level: MeshLevel, axis: Values | Table) -> Reading:
    """Smallest and largest pressure in a range; one number for one point."""
    here, pressure = positions(level, axis), level.answer.solution.pressure
    if statement.between is not None:
        slack = LEVEL * float(np.ptp(here))
        low, high = statement.between
        pressure = pressure[(here >= low - slack) & (here <= high + slack)]
    ends = (float(pressure.min()), float(pressure.max())) if len(pressure) else ()
    return ends[: len(pressure)]


def _peak(_: PaperStatement, level: MeshLevel, axis: Values | Table) -> Reading:
    peak = level.answer.footprint.peak
    return () if peak is None else (peak.pressure,)


def _open_points(_: PaperStatement, level: MeshLevel, axis: Values | Table) -> Reading:
    return (float(np.count_nonzero(~level.answer.touching)),)


def _least_gap(_: PaperStatement, level: MeshLevel, axis: Values | Table) -> Reading:
    """The smallest gap; round-off is zero."""
    contact = level.answer.contact
    gap = float((contact.initial_gap + level.answer.solution.displacement).min())
    return (0.0 if abs(gap) <= LEVEL * contact.scales.displacement else gap,)


def _force(statement: PaperStatement, level: MeshLevel, axis: Values | Table) -> Reading:
    return (abs(float(np.dot(level.answer.footprint.resultant.force, statement.direction))),)


def _difference(_: PaperStatement, level: MeshLevel, axis: Values | Table) -> Reading:
    compared = level.comparison
    differences = [item.unpolished for item in compared.differences if item.other == compared.reference.label]
    return (max(differences),) if differences else ()


READERS: dict[PaperQuantity, Callable[[PaperStatement, MeshLevel, Values | Table], Reading]] = {
    PaperQuantity.PRESSURE: _pressure,
    PaperQuantity.PEAK: _peak,
    PaperQuantity.CONTACT: lambda _, level, axis: contact_extent(level, axis),
    PaperQuantity.OPEN_POINTS: _open_points,
    PaperQuantity.LEAST_GAP: _least_gap,
    PaperQuantity.FORCE: _force,
    PaperQuantity.DIFFERENCE: _difference,
}
"""Quantity -> function that computes it."""
