"""What report.json holds of what one formulation found; fields say what they mean, with [L] and [p] for units.

[L] is the unit of length and [p] that of pressure, force over length squared; a number without either has no unit.
"""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from bemcontact.assessment.certificate import CertificateKind
from bemcontact.contact.solution import Status
from bemcontact.options import FormulationName, Weights

Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
Inertia = Annotated[list[int], Field(min_length=3, max_length=3)]
StatusName = Annotated[str, Field(json_schema_extra={"enum": [status.name.lower() for status in Status]})]
KindName = Annotated[str, Field(json_schema_extra={"enum": [kind.value for kind in CertificateKind]})]


class Record(BaseModel):
    """What stands between braces: all keys, and no others."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)


class Penalty(Record):
    """μ of QP2, and up to which QP2 is convex; a limit is null if QP2 is convex for every μ."""

    value: float
    """μ, free of units: an error of the equations costs its square over μ."""
    raw: float
    """μ in the unit `dimension`."""
    convexity_limit: float | None
    """Largest μ for which QP2 is convex where equilibrium is kept, free of units; 0 if for none."""
    convexity_limit_raw: float | None
    """The same in the unit `dimension`."""
    dimension: Literal["p/L²", "1/p"]
    """Unit of the raw numbers, which depends on the equations that are penalised."""


class Search(Record):
    """How a local solver came to its end; inertias are numbers of positive, zero and negative eigenvalues."""

    start: str
    """What it started from."""
    phase_one_iterations: int
    """Up to a feasible point."""
    phase_two_iterations: int
    """From there down the objective."""
    working_set_changes: int
    """Constraints that entered or left the working set."""
    inertia: Inertia
    """Of the Hessian."""
    reduced_inertia_start: Inertia
    """Of the Hessian on what the working set leaves free, where phase two began."""
    reduced_inertia_end: Inertia
    """The same where it ended."""
    weakly_active: int
    """Active constraints with a multiplier of about zero."""
    objective: float
    """In the end, scaled; 0 at the contact state, and nowhere less with weights that are not negative."""
    penalty: Penalty | None
    """Of QP2; else null."""


class Trace(Record):
    """One quantity, iteration by iteration, free of units."""

    quantity: str
    """What it is: objective, infeasibility of the constraints, or residual of the contact conditions."""
    first: int
    """Number of the iteration that ended at the first value; 0 is the start."""
    values: list[float]
    """One for each iteration."""


class AtPenalty(Record):
    """The objective of QP2 with one penalty."""

    penalty: float
    """μ, free of units."""
    value: float
    """The objective, scaled."""


class Objectives(Record):
    """One solution under every statement, scaled; all are zero at the contact state with positive diagonal weights."""

    weights: Weights
    """The J in all of them."""
    qp1: float
    """pᵀJδ with the gap δ of the solver's own displacements."""
    qp2: list[AtPenalty]
    """The same with the penalised error of the equations, for each μ."""
    qp3: float
    """pᵀJδ with the gap δ that the equations give for these pressures."""


class Residuals(Record):
    """What is left of the conditions, recomputed, over the scales of displacement U and pressure T."""

    penetration: float
    """Largest depth by which a point penetrates, over U."""
    tension: float
    """Largest negative pressure, over T."""
    complementarity: float
    """Largest |min(p/T, δ/U)| of a point."""
    work: float
    """pᵀJδ over U T max J, with the tributary lengths J; 0 at the solution."""
    equilibrium: float
    """Largest error of u = Δ + M p + R a, for the best rigid motions, over U."""
    stiffness_rows: float
    """Largest error of the same equations solved for pressure, over T."""
    balance: float
    """Error of mean pressure in the free rigid motions, over T."""
    force_balance: float | None
    """Resultant of all forces on the body over their sum; null where no boundary was recovered."""


class Certificate(Record):
    """What has been proved of the answer from its pressures and displacements alone, without believing the solver."""

    kind: KindName
    """What is proved."""
    smallest_eigenvalue: float | None
    """Of the symmetric part of the weighted compliance, scaled; the pressure is unique if it is greater than 0."""
    error_bound: float | None
    """No pressure differs from that of the solution by more [p]; null if nothing can be said."""
    words: str
    """The same in two or three sentences."""


class Interval(Record):
    """One unbroken stretch of contact."""

    zone: str
    """Name of the contact zone."""
    start: Pair
    """Its first end (x, y) in the order of the boundary [L]."""
    end: Pair
    """Its last end (x, y) [L]."""
    arc: Pair
    """Arc positions of both on the piece of boundary [L]."""


class Peak(Record):
    """The largest pressure, and where."""

    pressure: float
    """Per undeformed length [p]."""
    at: Pair
    """The contact point (x, y) [L]."""


class Tool(Record):
    """A rigid surface that moves: where it is in the solution, and what the body presses on it with."""

    name: str
    """Its name in the spec."""
    point: Pair
    """About which it turns, and about which moments are (x, y) [L]."""
    displacement: Pair
    """Of that point along x and y [L]."""
    rotation: float
    """Anticlockwise, in radians."""
    force_of_body: Pair
    """Force of the body on the tool, per thickness [p L]."""
    moment_of_body: float
    """Moment of that force about the point, per thickness [p L²]."""
    free: Annotated[list[bool], Field(min_length=3, max_length=3)]
    """Whether the tool is free to move along x, along y and to rotate, as it is loaded there."""


class Answer(Record):
    """What a formulation found, and what was recomputed of it; lists go contact point by contact point."""

    solver: str
    """The program that solved it."""
    status: StatusName
    """How the solver ended; no verdict on the answer."""
    pressure: list[float]
    """Normal traction per undeformed length, positive in compression [p]."""
    gap: list[float]
    """Initial gap plus normal displacement [L]."""
    normal_displacement: list[float]
    """Along the rigid normal, away from the surface, where a loaded tool has moved to [L]; the solver's own."""
    rigid_amplitudes: list[float]
    """How far the body, then the tools, move along each free rigid motion [L]."""
    iterations: int
    """As the solver counts them."""
    polished: bool
    """Whether an exact step on the contact set found took the place of the solver's own pressures."""
    search: Search | None
    """Of a local solver; else null."""
    history: list[Trace]
    """How the solver got there."""
    convexity: float | None
    """Smallest eigenvalue of the scaled Hessian of QP3 on the equilibrium space, where the solver looked at it."""
    tools: list[Tool]
    """Rigid surfaces that are displaced or loaded; empty if all are fixed."""
    notes: list[str]
    """What should be known of the solution."""
    objectives: list[Objectives]
    """For each of the weights that are compared."""
    residuals: Residuals
    """What is left of the conditions."""
    certificate: Certificate
    """What is proved."""
    resultant: Pair
    """Force (x, y) of the rigid surfaces on the body, per thickness [p L]."""
    resultant_moment: float
    """Its moment about the origin, anticlockwise, per thickness [p L²]."""
    intervals: list[Interval]
    """Where there is contact; empty if nowhere."""
    peak: Peak | None
    """The largest pressure; null if nothing touches."""


class End(Record):
    """Where searches from random starts ended."""

    status: StatusName
    """How they ended."""
    count: int
    """How many ended here."""
    first_start: int
    """Number of the first start that did, from 0."""
    objective: float | None
    """Scaled; 0 at the contact state, null if infeasible or unbounded."""
    residual: float
    """Of contact conditions and equations, free of units: about 1e-10 at the contact state."""
    iterations: Annotated[list[int], Field(min_length=2, max_length=2)]
    """Least and most of those who ended here."""
    pressure: list[float]
    """Of the first, point by point [p]."""
    normal_displacement: list[float]
    """Of the first, point by point [L]."""


class Starts(Record):
    """Random starts, and how many ended at the contact state."""

    formulation: FormulationName
    """That was searched."""
    count: int
    """Of the starts."""
    seed: int
    """Of the random numbers."""
    solved: int
    """How many searches ended at the contact state."""
    ends: list[End]
    """The nearest to the contact state first."""
