"""What report.json holds of the formulations side by side on one mesh; units as in `answer_schema`."""

from typing import Annotated

from pydantic import Field

from bemcontact.assessment.verdict import Outcome
from bemcontact.options import FormulationName, Weights
from bemcontact.report.answer_schema import Answer, Pair, Record, Starts

OutcomeName = Annotated[str, Field(json_schema_extra={"enum": [outcome.value for outcome in Outcome]})]


class Scales(Record):
    """By which residuals and objectives are divided."""

    displacement: float
    """Typical displacement U [L]."""
    pressure: float
    """Typical pressure T [p]."""


class Contact(Record):
    """The contact points of the condensed problem; lists go point by point."""

    contact_nodes: int
    """Number of contact points."""
    free_rigid_motions: int
    """Number of rigid motions that contact alone holds."""
    motion_names: list[str]
    """What they are."""
    motion_load: list[float]
    """Work of the loads in each of them, for a motion of unit displacement, per thickness [p L]."""
    nodes: list[Pair]
    """Undeformed place (x, y) [L]."""
    normals: list[Pair]
    """Unit normal of the rigid surface, into the body."""
    zone: list[str]
    """Name of the contact zone."""
    run: list[int]
    """Number of the unbroken piece of boundary."""
    arc_position: list[float]
    """Arc length along that piece [L]."""
    tributary_lengths: list[float]
    """Length that belongs to the point [L]: Σ length · pressure · normal is the resultant."""
    initial_gap: list[float]
    """Distance from the rigid surface along its normal before anything deforms; negative if inside [L]."""
    load_factors: dict[str, float]
    """By how much each load case acts; empty if there are none."""
    scales: Scales
    """Typical displacement and pressure."""


class Verdict(Record):
    """What an answer is worth, and why."""

    outcome: OutcomeName
    """In a few words, always the same."""
    words: str
    """A sentence that says why."""
    reason: str
    """The deeper reason where the weights are to blame; else empty."""


class Contender(Record):
    """One formulation with its weights and penalty."""

    label: str
    """What it is called in the report."""
    formulation: FormulationName
    """The statement."""
    weights: Weights | None
    """Of its objective; null for complementarity, which has none."""
    penalty: float | None
    """μ of QP2, free of units; else null."""
    certified: bool
    """Whether the answer is proved to be the solution, and the only one."""
    verdict: Verdict
    """What the answer is worth."""
    objective: float | None
    """Of its own statement, scaled."""
    convex: bool | None
    """Whether the program is convex on what equations and equilibrium leave free."""
    seconds: float
    """That the solver took."""
    starts: Starts | None
    """Random starts, if they were asked for."""
    answer: Answer | None
    """What was found; null if the formulation refused."""


class Difference(Record):
    """Of the pressures of two contenders."""

    one: str
    """Label of the first."""
    other: str
    """Label of the second."""
    largest: float
    """Over the peak of the direct solution."""
    mean_square: float
    """Over that of the direct solution."""
    unpolished: float
    """As `largest`, of what the first's solver found before its polish, from the polished other."""


class Weighted(Record):
    """J M with one J, scaled; eigenvalues of its symmetric part on the equilibrium space."""

    weights: Weights
    """Which J."""
    negative_weights: int
    """Entries of J below 0; with any of them an objective of 0 certifies nothing."""
    asymmetry: float
    """Of J M, relative; 0 for the continuum, so that it tells of the mesh."""
    smallest_eigenvalue: float | None
    """Null where equilibrium alone fixes the pressure, as for the largest."""
    largest_eigenvalue: float | None
    """QP3 is convex only if both are not negative."""
    saddle: bool
    """Whether the objective of QP3 is a saddle in pressure and rigid motion."""
    convex: bool
    """Whether QP3 with these weights is convex, up to round-off."""


class Matrices(Record):
    """Numbers of the condensed matrices."""

    condition: float
    """In the 2-norm, of the scaled matrix that is inverted for the stiffness rows."""
    weighted: list[Weighted]
    """For each of the weights that are compared, the tributary ones first."""


class Comparison(Record):
    """Formulations side by side on one mesh."""

    name: str
    """Of the problem."""
    version: str
    """Of bemcontact."""
    certified: bool
    """Whether the direct solution and all contenders are proved to be the solution."""
    heading: str
    """What is certified, in a few words."""
    verdict: str
    """What the comparison says, in sentences."""
    agreement: float | None
    """Largest difference of those that meet all conditions from the direct solution, over the peak."""
    contact: Contact
    """The contact points."""
    contenders: list[Contender]
    """The formulations, in the order asked."""
    reference: Contender
    """The direct solution of the complementarity problem."""
    differences: list[Difference]
    """Of all pairs, those with the direct solution first."""
    matrices: Matrices
    """What decides which formulations are convex."""
