"""What numbers.json holds, stated once: `reproduction_schema` is its JSON Schema, for programs that read it."""

from typing import Any

from bemcontact.options import FormulationName
from bemcontact.report.answer_schema import Interval, Pair, Peak, Record
from bemcontact.report.schema import Expected, Units


class Coordinate(Record):
    """Over which the paper's figure has the pressure."""

    symbol: str
    """Its letter."""
    unit: str
    """Label of its unit."""


class StatementFound(Record):
    """What the paper says of a quantity, and what is found, run by run: a number, two from where to where, or none."""

    what: str
    """The quantity."""
    said: str
    """By the paper, in words."""
    unit: str
    """Label of the unit of what is found."""
    found: list[list[float]]
    """By runs."""


class ScoreFound(Record):
    """One quantity as a reference expects it and as found, mesh by mesh of the problem as stated."""

    reference: str
    """Name of the reference."""
    quantity: str
    """What is compared."""
    expected: float
    """In the unit of the quantity; 0 where it is itself a difference."""
    tolerance: float
    """Relative difference that the reference allows."""
    judged: bool
    """Whether the difference can be held against the answer."""
    holds: bool
    """Whether it is within the tolerance on all of these meshes."""
    found: list[float | None]
    """In the same unit; null where nothing touches."""
    difference: list[float | None]
    """Relative."""


class Solver(Record):
    """How one formulation ended."""

    label: str
    """What it is called."""
    formulation: FormulationName
    """The statement."""
    certified: bool
    """Whether its answer is proved to be the solution."""
    iterations: int | None
    """As the solver counts them; null if the formulation refused."""


class Run(Record):
    """A problem, or a variant of it, on one mesh; position and pressure go contact point by contact point."""

    label: str
    """What it is called."""
    variant: str | None
    """Its name; null for the problem as stated."""
    description: str
    """Of the variant."""
    refine: int
    """Number of parts into which each stated element is cut."""
    elements: int
    """Number of boundary elements."""
    dof: int | None
    """Unknowns of the boundary elements, two for each node."""
    contact_nodes: int
    """Number of contact points."""
    certified: bool
    """Whether all answers are proved to be the solution."""
    verdict: str
    """What the comparison says, in sentences."""
    agreement: float | None
    """Largest difference of a formulation from the direct solution, over the peak."""
    solvers: list[Solver]
    """The formulations, then the direct solution."""
    position: list[float]
    """The coordinate, in its unit."""
    pressure: list[float]
    """Of the direct solution, per undeformed length [p]."""
    contact: list[float]
    """From where to where there is contact, by the coordinate; empty if there is none."""
    resultant: Pair
    """Force (x, y) of the rigid surfaces on the body, per thickness [p L]."""
    resultant_moment: float
    """Its moment about the origin, anticlockwise, per thickness [p L²]."""
    intervals: list[Interval]
    """Where there is contact; empty if nowhere."""
    peak: Peak | None
    """The largest pressure; null if nothing touches."""
    seconds: float
    """Of all stages."""


class PaperProblem(Record):
    """One problem of the paper; `runs` are the variants, then the meshes of the problem as stated."""

    model: str
    """Name of its file."""
    name: str
    """Of the problem in the file."""
    figure: str
    """Of the paper."""
    description: str
    """As the file has it."""
    units: Units
    """Labels of the units."""
    coordinate: Coordinate
    """Of `position` and `contact`."""
    certified: bool
    """Whether all answers in all runs are proved to be the solution."""
    judged: int
    """Quantities that references can be held against, on all meshes of the problem as stated."""
    held: int
    """How many of them are within what is allowed."""
    statements: list[StatementFound]
    """Of the paper."""
    differs: list[str]
    """Where the paper and this differ, and why."""
    iterations: dict[FormulationName, int]
    """That the paper prints, of QPSOL."""
    references: list[Expected]
    """At the contact points of the finest mesh."""
    scores: list[ScoreFound]
    """How the answers stand beside them."""
    runs: list[Run]
    """Variants, then meshes."""


class Reproduction(Record):
    """The problems of the paper.

    [L] is the unit of length and [p] that of pressure, force over length squared; a number without either has no unit.
    """

    reproduced: bool
    """Whether all is certified and every judged reference is met."""
    refine: list[int]
    """Of the meshes: number of parts into which each stated element is cut."""
    problems: list[PaperProblem]
    """In the order of the paper."""
    versions: dict[str, str]
    """Of bemcontact, Python and the packages used, by name."""
    seconds: float
    """Of all runs."""


def reproduction_schema() -> dict[str, Any]:
    """Make the JSON Schema (draft 2020-12) of numbers.json."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Reproduction.model_json_schema()}
