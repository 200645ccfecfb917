"""What report.json holds, stated once: `report_schema` is its JSON Schema, for programs that read it."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from bemcontact.assessment.certificate import CertificateKind
from bemcontact.assessment.verdict import Outcome
from bemcontact.choices import FormulationName, Weights
from bemcontact.solution import Status

Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
Inertia = Annotated[list[int], Field(min_length=3, max_length=3)]
StatusName = Annotated[str, Field(json_schema_extra={"enum": [status.name.lower() for status in Status]})]
OutcomeName = Annotated[str, Field(json_schema_extra={"enum": [outcome.value for outcome in Outcome]})]
KindName = Annotated[str, Field(json_schema_extra={"enum": [kind.value for kind in CertificateKind]})]


class Record(BaseModel):
    """What stands between braces: all keys, and no others."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)


class Units(Record):
    """Labels of the units; numbers are never converted."""

    length: str
    force: str


class Settings(Record):
    """What was compared."""

    formulations: list[FormulationName]
    weights: list[Weights]
    penalties: list[float]
    """μ of QP2, free of units."""
    starts: int | None
    """Random starts of QP1 and QP2, beside the null start."""
    seed: int
    changes: list[str]
    """Made to the spec with --set."""


class Scales(Record):
    """By which residuals and objectives are divided."""

    displacement: float
    pressure: float


class Contact(Record):
    """The contact points of the condensed problem; lists go point by point."""

    contact_nodes: int
    free_rigid_motions: int
    motion_names: list[str]
    motion_load: list[float]
    nodes: list[Pair]
    normals: list[Pair]
    zone: list[str]
    run: list[int]
    """Number of the unbroken piece of boundary."""
    arc_position: list[float]
    """Arc length along that piece."""
    tributary_lengths: list[float]
    initial_gap: list[float]
    scales: Scales


class Penalty(Record):
    """μ of QP2, free of units and raw, and up to which QP2 is convex; null if for every μ."""

    value: float
    raw: float
    convexity_limit: float | None
    convexity_limit_raw: float | None
    dimension: Literal["p/L²", "1/p"]


class Search(Record):
    """How a local solver came to its end; inertias are numbers of positive, zero and negative eigenvalues."""

    start: str
    phase_one_iterations: int
    phase_two_iterations: int
    working_set_changes: int
    inertia: Inertia
    reduced_inertia_start: Inertia
    reduced_inertia_end: Inertia
    weakly_active: int
    objective: float
    penalty: Penalty | None


class Trace(Record):
    """One quantity, iteration by iteration."""

    quantity: str
    first: int
    values: list[float]


class AtPenalty(Record):
    """The objective of QP2 with one penalty."""

    penalty: float
    value: float


class Objectives(Record):
    """One solution under every statement, scaled; all are zero at the contact state with positive diagonal weights."""

    weights: Weights
    qp1: float
    qp2: list[AtPenalty]
    qp3: float


class Residuals(Record):
    """What is left of the conditions, free of units."""

    penetration: float
    tension: float
    complementarity: float
    work: float
    equilibrium: float
    stiffness_rows: float
    balance: float
    force_balance: float | None


class Certificate(Record):
    """What has been proved; the error bound is a pressure."""

    kind: KindName
    smallest_eigenvalue: float | None
    error_bound: float | None
    words: str


class Interval(Record):
    """One unbroken stretch of contact."""

    zone: str
    start: Pair
    end: Pair
    arc: Pair
    """Arc positions of both on the piece of boundary."""


class Peak(Record):
    """The largest pressure, and where."""

    pressure: float
    at: Pair


class Answer(Record):
    """What a formulation found, and what was recomputed of it."""

    solver: str
    status: StatusName
    pressure: list[float]
    gap: list[float]
    normal_displacement: list[float]
    rigid_amplitudes: list[float]
    iterations: int
    polished: bool
    search: Search | None
    history: list[Trace]
    convexity: float | None
    """Smallest eigenvalue of the scaled Hessian of QP3 on the equilibrium space, where the solver looked at it."""
    notes: list[str]
    objectives: list[Objectives]
    residuals: Residuals
    certificate: Certificate
    resultant: Pair
    resultant_moment: float
    intervals: list[Interval]
    peak: Peak | None


class End(Record):
    """Where searches from random starts ended."""

    status: StatusName
    count: int
    first_start: int
    objective: float | None
    residual: float
    iterations: Annotated[list[int], Field(min_length=2, max_length=2)]
    pressure: list[float]
    normal_displacement: list[float]


class Starts(Record):
    """Random starts, and how many ended at the contact state."""

    formulation: FormulationName
    count: int
    seed: int
    solved: int
    ends: list[End]


class Verdict(Record):
    """What an answer is worth, why, and where the weights are to blame the deeper reason."""

    outcome: OutcomeName
    words: str
    reason: str


class Contender(Record):
    """One formulation with its weights and penalty; `answer` is null if it refused."""

    label: str
    formulation: FormulationName
    weights: Weights | None
    penalty: float | None
    certified: bool
    verdict: Verdict
    objective: float | None
    """Of its own statement, scaled."""
    convex: bool | None
    """On what equations and equilibrium leave free."""
    seconds: float
    starts: Starts | None
    answer: Answer | None


class Difference(Record):
    """Of two pressures."""

    one: str
    other: str
    largest: float
    """Over the peak of the direct solution."""
    mean_square: float
    """Over that of the direct solution."""
    unpolished: float
    """As `largest`, of what the first's solver found before its polish, from the polished other."""


class Weighted(Record):
    """J M with one J, scaled; eigenvalues of its symmetric part on the equilibrium space."""

    weights: Weights
    negative_weights: int
    asymmetry: float
    smallest_eigenvalue: float | None
    largest_eigenvalue: float | None
    saddle: bool
    convex: bool


class Matrices(Record):
    """Numbers of the condensed matrices."""

    condition: float
    weighted: list[Weighted]


class Comparison(Record):
    """Formulations side by side on one mesh."""

    name: str
    version: str
    certified: bool
    heading: str
    """What is certified, in a few words."""
    verdict: str
    agreement: float | None
    """Largest difference of those that meet all conditions from the direct solution, over the peak."""
    contact: Contact
    contenders: list[Contender]
    reference: Contender
    """The direct solution of the complementarity problem."""
    differences: list[Difference]
    matrices: Matrices


class Expected(Record):
    """What a reference says; null where it says nothing."""

    name: str
    source: str
    closed_form: bool
    zone: str | None
    pressure: list[float | None]
    compared: list[bool]
    tolerance: float
    reason: str
    peak: float | None
    half_width: float | None
    center: Pair | None
    contact_length: float | None
    start: float | None
    end: float | None
    against: str | None
    """The coordinate of start and end."""
    ends: list[Pair]
    resultant: float | None
    in_range: bool
    remark: str


class Score(Record):
    """One quantity as found and as a reference expects it; the difference is relative."""

    reference: str
    quantity: str
    found: float | None
    expected: float
    difference: float | None
    tolerance: float
    judged: bool
    holds: bool


class FitPass(Record):
    """A mesh on the way to one fitted to the ends of contact; how far these are from where it is graded to."""

    movement: float | None
    intervals: list[Interval]


class MeshFit(Record):
    """How the mesh was fitted to the ends of contact: the mesh as stated, then each fitted one."""

    settled: bool
    kept: int
    passes: list[FitPass]


class Level(Record):
    """The comparison on one mesh, each stated element cut into `refine` parts."""

    refine: int
    dof: int | None
    seconds: dict[str, float]
    notes: list[str]
    force_balance: float | None
    equilibrium_slack: float | None
    mesh_fit: MeshFit | None
    comparison: Comparison
    references: list[Expected]
    scores: list[Score]


class Quantity(Record):
    """A number on one mesh after the other, with the orders observed between them and the limit they lead to."""

    name: str
    dimension: Literal["p", "L", "1"]
    values: list[float]
    orders: list[float | None]
    limit: float | None


class Convergence(Record):
    """What changes with the mesh."""

    refine: list[int]
    quantities: list[Quantity]
    remark: str


class Report(Record):
    """A problem compared on one mesh or several, the coarsest first."""

    name: str
    description: str
    certified: bool
    verdict: str
    units: Units
    settings: Settings
    levels: list[Level]
    convergence: Convergence | None
    versions: dict[str, str]
    seconds: float


def report_schema() -> dict[str, Any]:
    """Make the JSON Schema (draft 2020-12) of report.json."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Report.model_json_schema()}
