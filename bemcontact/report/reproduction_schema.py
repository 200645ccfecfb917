"""What numbers.json holds, stated once: `reproduction_schema` is its JSON Schema, for programs that read it."""

from typing import Any

from bemcontact.choices import FormulationName
from bemcontact.report.schema import Expected, Interval, Pair, Peak, Record, Units


class Coordinate(Record):
    """Over which the paper's figure has the pressure."""

    symbol: str
    unit: str


class StatementFound(Record):
    """What the paper says of a quantity, and what is found, run by run: a number, two from where to where, or none."""

    what: str
    said: str
    unit: str
    found: list[list[float]]


class ScoreFound(Record):
    """One quantity as a reference expects it and as found, mesh by mesh of the problem as stated."""

    reference: str
    quantity: str
    expected: float
    tolerance: float
    judged: bool
    holds: bool
    """On all of these meshes."""
    found: list[float | None]
    difference: list[float | None]
    """Relative."""


class Solver(Record):
    """How one formulation ended; `iterations` is null if it refused."""

    label: str
    formulation: FormulationName
    certified: bool
    iterations: int | None


class Run(Record):
    """A problem, or a variant of it, on one mesh; position and pressure go contact point by contact point."""

    label: str
    variant: str | None
    description: str
    """Of the variant."""
    refine: int
    elements: int
    dof: int | None
    contact_nodes: int
    certified: bool
    verdict: str
    agreement: float | None
    """Largest difference of a formulation from the direct solution, over the peak."""
    solvers: list[Solver]
    position: list[float]
    """The coordinate."""
    pressure: list[float]
    """Of the direct solution, per undeformed length."""
    contact: list[float]
    """From where to where there is contact, by the coordinate; empty if there is none."""
    resultant: Pair
    resultant_moment: float
    intervals: list[Interval]
    peak: Peak | None
    seconds: float


class PaperProblem(Record):
    """One problem of the paper; `runs` are the variants, then the meshes of the problem as stated."""

    model: str
    name: str
    figure: str
    description: str
    units: Units
    coordinate: Coordinate
    certified: bool
    judged: int
    """Quantities that references can be held against, on all meshes of the problem as stated."""
    held: int
    """How many of them are within what is allowed."""
    statements: list[StatementFound]
    differs: list[str]
    """Where the paper and this differ, and why."""
    iterations: dict[FormulationName, int]
    """That the paper prints, of QPSOL."""
    references: list[Expected]
    """At the contact points of the finest mesh."""
    scores: list[ScoreFound]
    runs: list[Run]


class Reproduction(Record):
    """The problems of the paper; `reproduced` if all is certified and every judged reference is met."""

    reproduced: bool
    refine: list[int]
    problems: list[PaperProblem]
    versions: dict[str, str]
    seconds: float


def reproduction_schema() -> dict[str, Any]:
    """Make the JSON Schema (draft 2020-12) of numbers.json."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Reproduction.model_json_schema()}
