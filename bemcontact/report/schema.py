"""What report.json holds, stated once: `report_schema` is its JSON Schema, for programs that read it.

Units as in `answer_schema`.
"""

from typing import Any, Literal

from bemcontact.options import FormulationName, Weights
from bemcontact.report.answer_schema import Interval, Pair, Record
from bemcontact.report.comparison_schema import Comparison


class Units(Record):
    """Labels of the units that all numbers are in; nothing is converted."""

    length: str
    """Unit of length [L]; empty if it is not stated."""
    force: str
    """Unit of force; pressure [p] is force over length squared."""


class Settings(Record):
    """What was compared."""

    formulations: list[FormulationName]
    """Beside the direct solution."""
    weights: list[Weights]
    """Of the objectives."""
    penalties: list[float]
    """μ of QP2, free of units."""
    starts: int | None
    """Random starts of QP1 and QP2, beside the null start."""
    seed: int
    """Of the random starts."""
    changes: list[str]
    """Made to the spec with --set."""


class Expected(Record):
    """What a reference says; null where it says nothing."""

    name: str
    """Of the reference in the spec."""
    source: str
    """Where it comes from."""
    closed_form: bool
    """Whether it is a formula, and not a list of values."""
    zone: str | None
    """The contact zone that it is about; null for all."""
    pressure: list[float | None]
    """At each contact point, per undeformed length [p]."""
    compared: list[bool]
    """At each contact point, whether a difference of pressure tells something: not at singular ends."""
    tolerance: float
    """Relative difference up to which the answer agrees."""
    reason: str
    """Why that much."""
    peak: float | None
    """Largest pressure [p]."""
    half_width: float | None
    """Distance of the farther end of contact from `center`, along the tangent there [L]."""
    center: Pair | None
    """Middle (x, y) of the contact [L]."""
    contact_length: float | None
    """Length of the boundary in contact [L]."""
    start: float | None
    """Smallest coordinate of contact, [L] or degrees."""
    end: float | None
    """Largest coordinate of contact, [L] or degrees."""
    against: str | None
    """The coordinate of start and end: x, y, arc, or angle, which is in degrees."""
    ends: list[Pair]
    """The contact points (x, y) nearest to start and end [L]."""
    resultant: float | None
    """Magnitude of the force on what is modelled, per thickness [p L]."""
    in_range: bool
    """Whether the reference is valid for this problem, so that a difference can be held against the answer."""
    remark: str
    """Why it is not; else empty."""


class Score(Record):
    """One quantity as found and as a reference expects it."""

    reference: str
    """Name of the reference."""
    quantity: str
    """What is compared."""
    found: float | None
    """In the unit of the quantity, [p], [L], [p L] or degrees; null where nothing touches."""
    expected: float
    """In the same unit; 0 where the quantity is itself a difference."""
    difference: float | None
    """Relative: over the quantity expected, the extent of contact for its ends, the pressure for its differences."""
    tolerance: float
    """Relative difference that the reference allows."""
    judged: bool
    """Whether the difference can be held against the answer."""
    holds: bool
    """Whether it is within the tolerance."""


class FitPass(Record):
    """A mesh on the way to one fitted to the ends of contact; how far these are from where it is graded to."""

    movement: float | None
    """Distance of an end of contact from where the mesh is graded to, over the shorter element there, or null."""
    intervals: list[Interval]
    """Contact as found on this mesh."""


class MeshFit(Record):
    """How the mesh was fitted to the ends of contact."""

    settled: bool
    """Whether the ends of contact are those that the mesh is fitted to."""
    kept: int
    """Number of the pass whose mesh was kept; 0 is the mesh as stated."""
    passes: list[FitPass]
    """The mesh as stated, then each fitted one."""


class Level(Record):
    """The comparison on one mesh."""

    refine: int
    """Number of parts into which each stated element is cut."""
    dof: int | None
    """Unknowns of the boundary elements, two for each node; null if no boundary stands behind the contact points."""
    seconds: dict[str, float]
    """By stage."""
    notes: list[str]
    """What should be known of the answer and its mesh."""
    force_balance: float | None
    """Resultant of all forces on the body over their sum, from the recovered tractions; null without a boundary."""
    equilibrium_slack: float | None
    """How far the discrete equations are from equilibrium, relative to the loads; null without a boundary."""
    mesh_fit: MeshFit | None
    """How the mesh was fitted, if that was asked for."""
    comparison: Comparison
    """The formulations side by side."""
    references: list[Expected]
    """What the references of the spec say at these contact points."""
    scores: list[Score]
    """How the direct solution stands beside them."""


class Quantity(Record):
    """A number on one mesh after the other."""

    name: str
    """What it is."""
    dimension: Literal["p", "L", "1"]
    """Its unit: pressure, length, or none."""
    values: list[float]
    """The coarsest mesh first."""
    orders: list[float | None]
    """Observed between the meshes; null where the values do not steadily approach a limit."""
    limit: float | None
    """To which the last order leads; null without an order."""


class Convergence(Record):
    """What changes with the mesh."""

    refine: list[int]
    """Number of parts into which each stated element is cut, on each mesh."""
    quantities: list[Quantity]
    """Peak, ends of contact, and asymmetry of J M."""
    remark: str
    """What cannot be told; else empty."""


class Report(Record):
    """A problem compared on one mesh or several.

    [L] is the unit of length and [p] that of pressure, force over length squared; a number without either has no unit.
    """

    name: str
    """Of the problem."""
    description: str
    """As the spec has it."""
    certified: bool
    """Whether all answers on all meshes are proved to be the solution."""
    verdict: str
    """What the finest mesh says, in sentences."""
    units: Units
    """Labels of the units."""
    settings: Settings
    """Formulations, weights, penalties and starts."""
    levels: list[Level]
    """The coarsest mesh first."""
    convergence: Convergence | None
    """What changes with the mesh; null on a single one."""
    versions: dict[str, str]
    """Of bemcontact, Python and the packages used, by name."""
    seconds: float
    """Of all stages on all meshes."""


def report_schema() -> dict[str, Any]:
    """Make the JSON Schema (draft 2020-12) of report.json."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Report.model_json_schema()}
