"""A solution of a condensed contact problem: what a formulation found, and how its solver ended."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from bemcontact.arrays import Array, freeze_arrays


class Status(Enum):
    """How a solver ended, in words; `bemcontact.assessment.advice` says what to do."""

    SOLVED = "solved"
    LOCAL_MINIMUM = "a local minimum that is not the contact state"
    ITERATION_LIMIT = "stopped at the iteration limit"
    INFEASIBLE = "no pressure satisfies the constraints, so that there is no contact state"
    UNBOUNDED = "the objective has no lower bound"
    NO_SOLUTION_FOUND = "no solution was found, and no proof that there is none"
    NUMERICAL_FAILURE = "broke down numerically"


@dataclass(frozen=True, kw_only=True)
class Penalty:
    """The μ of QP2, and up to which one QP2 is convex.

    Parameters
    ----------
    value, raw : μ, free of units, and in the user's units, where (1/μ)|K u_n - B p - r|² is added to pᵀJδ
    convexity_limit, convexity_limit_raw : the largest for which QP2 is convex where equilibrium is kept, likewise: zero
        if for none, None if for all
    dimension : of the raw numbers: "p/L²" with the stiffness rows, "1/p" with the compliance rows
    """

    value: float
    raw: float
    convexity_limit: float | None
    convexity_limit_raw: float | None
    dimension: str

    @property
    def convex(self) -> bool:
        """Whether QP2 is convex with this μ where equilibrium is kept, up to round-off of the limit."""
        return self.convexity_limit is None or self.value <= self.convexity_limit * (1 + 1e-9)


@dataclass(frozen=True, kw_only=True)
class LocalSearch:
    """How a local solver came to its end; inertias count positive, zero and negative eigenvalues.

    Parameters
    ----------
    start : what it started from
    phase_one_iterations, phase_two_iterations : to a feasible point, and from there down
    working_set_changes : constraints that entered or left the working set
    inertia : of the Hessian
    reduced_inertia_start, reduced_inertia_end : of the Hessian on what the working set leaves free, in phase two
    weakly_active : active constraints with a multiplier of about zero
    objective : scaled, in the end; its best value is zero with weights that are not negative
    penalty : of QP2, else None
    """

    start: str
    phase_one_iterations: int
    phase_two_iterations: int
    working_set_changes: int
    inertia: tuple[int, int, int]
    reduced_inertia_start: tuple[int, int, int]
    reduced_inertia_end: tuple[int, int, int]
    weakly_active: int
    objective: float
    penalty: Penalty | None = None


@dataclass(frozen=True, kw_only=True)
class Trace:
    """One quantity, iteration by iteration.

    Parameters
    ----------
    quantity : "objective" of the statement that is solved, "infeasibility" of its constraints, or "residual" of the
        contact conditions, as told by the `solve` of the formulation
    first : number of the iteration that ended at the first value; 0 is the start
    values : one for each iteration, finite and free of units
    """

    quantity: str
    first: int
    values: tuple[float, ...]


def traces_in_turn(*parts: tuple[str, Sequence[float]]) -> tuple[Trace, ...]:
    """Number the iterations of quantities (name, values) that followed each other, from 1; without the empty ones."""
    traces: list[Trace] = []
    done = 0
    for quantity, values in parts:
        if len(values):
            traces.append(Trace(quantity=quantity, first=done + 1, values=tuple(map(float, values))))
        done += len(values)
    return tuple(traces)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ContactSolution:
    """What a formulation found; nothing in it is believed until `bemcontact.assessment` has recomputed it.

    Parameters
    ----------
    formulation : name of the statement that was solved
    solver : name of the program that solved it
    status : how it ended
    pressure : (n,) p [p]
    displacement : (n,) u_n [L], the solver's own (it need not satisfy the equations)
    rigid_amplitudes : (k,) a
    iterations : of the solver, as it counts them
    unpolished : (n,) the solver's own p [p], where the active-set step after it was kept; else None
    smallest_eigenvalue : of the scaled Hessian on the equilibrium space, where the formulation looked at it
    search : how a local solver came to its end, if one was used
    history : how the solver got there, in the order in which it happened; the polish adds nothing
    notes : what a person should know
    """

    formulation: str
    solver: str
    status: Status
    pressure: Array
    displacement: Array
    rigid_amplitudes: Array
    iterations: int
    unpolished: Array | None = None
    smallest_eigenvalue: float | None = None
    search: LocalSearch | None = None
    history: tuple[Trace, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Make arrays read-only."""
        freeze_arrays(self)

    @property
    def polished(self) -> bool:
        """Whether the active-set step after the solver improved the result and was kept."""
        return self.unpolished is not None

    def __repr__(self) -> str:
        """One line: formulation, status, size."""
        return f"<ContactSolution by {self.formulation}: {self.status.value}, {len(self.pressure)} contact points>"
