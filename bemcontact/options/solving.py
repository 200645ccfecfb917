"""The options of solving, each declared once: name, default, range, meaning, and the formulations that take it."""

import os
from collections.abc import Mapping
from enum import StrEnum
from itertools import chain
from typing import Any, Protocol, TypedDict, Unpack, cast, runtime_checkable

from bemcontact.checks.arguments import real_number, shown
from bemcontact.checks.keywords import refusing_unknown
from bemcontact.errors import OptionError, ProblemError
from bemcontact.frozen import frozen_value
from bemcontact.options.asking import AskingKeywords
from bemcontact.options.declaration import STARTS, declared, documented, ensure_known, ensure_whole_fields, named

LEAST_PENALTY, LARGEST_PENALTY = 1e-8, 1e8
"""Outside this range the smaller of QP2's two terms is lost in the round-off of the other."""


class FormulationName(StrEnum):
    """Statements of the contact problem that can be solved."""

    QP1 = "qp1"
    QP2 = "qp2"
    QP3 = "qp3"
    COMPLEMENTARITY = "complementarity"


COMPARED = (FormulationName.QP1, FormulationName.QP2, FormulationName.QP3)
"""Formulations that are compared with the direct solution."""

USES: Mapping[FormulationName, tuple[str, ...]] = {
    FormulationName.QP1: ("weights", "rows", "start", "polish"),
    FormulationName.QP2: ("weights", "penalty", "rows", "equilibrium", "start", "polish"),
    FormulationName.QP3: ("weights", "solver", "polish"),
    FormulationName.COMPLEMENTARITY: (),
}
"""Options that a formulation has a use for, besides those that all take."""
UNUSED = {name: sorted({*chain.from_iterable(USES.values())} - {*used}) for name, used in USES.items()}
"""The others."""


class Weights(StrEnum):
    """How the objective integrates p δ over the contact zone: the J of [SS92] (24)-(26)."""

    TRIBUTARY = "tributary"
    """Diagonal, the length that belongs to each point: Σ w p is the resultant. The default."""
    CONSISTENT = "consistent"
    """∫ h hᵀ ds, (24)-(25): has negative entries, so that objective = 0 certifies nothing."""
    ELEMENT_LENGTH = "element_length"
    """Diagonal, the element length once per node, (26) taken literally: makes QP3 indefinite on uniform meshes."""


class Rows(StrEnum):
    """How the equations K u_n = B p + r, (12), are written in QP1 and QP2."""

    STIFFNESS = "stiffness"
    """p = S (u_n - Δ1) - V load: their residual is an error of pressure. The default."""
    COMPLIANCE = "compliance"
    """u_n = Δ1 + M p + R a with the amplitudes a as free variables: their residual is an error of displacement."""


class Equilibrium(StrEnum):
    """How QP2 keeps a body with free rigid motions in equilibrium."""

    CONSTRAINT = "constraint"
    """ℓᵀp = -load holds exactly. The default."""
    PENALTY = "penalty"
    """Only penalized, with all the rest of (12), as in [SS92]: a body lifted off its support is a stationary point."""


class ConvexSolver(StrEnum):
    """Solvers of QP3."""

    CLARABEL = "clarabel"
    """Interior points with sparse factors. The default."""
    PIQP = "piqp"
    """Interior points with dense factors, of the extra piqp: faster where many points may touch."""


class StartName(StrEnum):
    """Starts of the local solver that need no numbers."""

    NULL = "null"
    """No displacement and no pressure. The default."""
    RANDOM = "random"
    """Points drawn from a seed."""


@runtime_checkable
class GivenStart(Protocol):
    """A start given by numbers: `bemcontact.Start`, which needs NumPy and so is defined elsewhere."""

    @property
    def pressure(self) -> Any:
        """Pressure (n,) [p]."""
        ...

    @property
    def displacement(self) -> Any:
        """Normal displacement (n,) [L]."""
        ...

    @property
    def label(self) -> str:
        """Label in reports."""
        ...


class StatementKeywords(TypedDict, total=False):
    """Types of those fields of `SolveOptions` that state a program, with names as texts."""

    penalty: float
    rows: Rows | str
    equilibrium: Equilibrium | str
    max_iterations: int | None


class ComparisonKeywords(TypedDict, total=False):
    """Types of fields of `ComparisonOptions`."""

    starts: int | None
    seed: int | None


class SolveKeywords(StatementKeywords, ComparisonKeywords, total=False):
    """Types of fields of `SolveOptions`, with names as texts."""

    start: GivenStart | os.PathLike[str] | StartName | str | None
    solver: ConvexSolver | str
    polish: bool


class SolvingKeywords(SolveKeywords, AskingKeywords, total=False):
    """Keywords of `bemcontact.solve`: how it is solved, and what is asked."""


class SearchKeywords(StatementKeywords, AskingKeywords, total=False):
    """Keywords of `bemcontact.random_starts`."""


class ComparingKeywords(ComparisonKeywords, AskingKeywords, total=False):
    """Keywords of `bemcontact.compare`."""


@documented
@refusing_unknown(ensure_known)
@frozen_value
class SolveOptions:
    """How a contact problem is solved.

    The options check themselves; a name may be given as its text.

    Raises
    ------
    OptionError
        A `ProblemError`: a name is unknown, a number out of range, or the formulation has no use for an option.
    """

    formulation: FormulationName = declared(
        FormulationName.COMPLEMENTARITY,
        "Statement of the contact problem: complementarity (direct solver), qp3 (convex program), or qp1 and qp2 "
        "(local solver over pressures and displacements).",
        noun="formulation",
    )
    weights: Weights = declared(
        Weights.TRIBUTARY, "Weights of the objective; complementarity has none.", noun="weights"
    )
    penalty: float = declared(
        1.0,
        f"qp2: an error of the equations costs its square over μ, a number without unit from {LEAST_PENALTY:g} to "
        f"{LARGEST_PENALTY:g}; a smaller μ makes this error smaller.",
        metavar="μ",
    )
    rows: Rows = declared(
        Rows.STIFFNESS, "qp1, qp2: equations in terms of pressure (stiffness) or of displacement.", noun="rows"
    )
    equilibrium: Equilibrium = declared(
        Equilibrium.CONSTRAINT,
        "qp2, bodies with free rigid motions: exact (constraint), or penalized as in the paper.",
        noun="ways of equilibrium",
    )
    start: GivenStart | os.PathLike[str] | StartName | None = declared(
        None,
        "qp1, qp2: first point of the solver; a FILE is one that --json wrote. With a seed or a number of starts the "
        "first point is random.",
        metavar="null|random|FILE",
        shown="null",
    )
    seed: int | None = declared(
        None, "qp1, qp2: seed of random starts; the same seed gives the same starts.", metavar="S", least=0, shown="0"
    )
    starts: int | None = declared(
        None,
        "qp1, qp2: search from N random starts; the result is the best of them.",
        noun=STARTS,
        metavar="N",
        least=1,
        shown=False,
    )
    max_iterations: int | None = declared(
        None,
        "Stop the solver after N iterations (complementarity: after N pivots of Lemke's method).",
        noun="limit of iterations",
        metavar="N",
        least=1,
        shown="that of the solver",
    )
    solver: ConvexSolver = declared(
        ConvexSolver.CLARABEL,
        "qp3: solver of the convex program; piqp is faster for many contact points, and needs the extra piqp.",
        noun="solver",
    )
    polish: bool = declared(
        True, "qp1, qp2, qp3: make the result of the solver exact by a few steps of an active-set method."
    )

    def __post_init__(self) -> None:
        """Read names that were given as texts; refuse what is unknown, out of range, or of no use."""
        for item in self.__dataclass_fields__.values():
            value, kind = getattr(self, item.name), type(item.default)
            if isinstance(item.default, StrEnum) and type(value) is not kind:
                object.__setattr__(self, item.name, named(kind, value, item.metadata["noun"]))
        if isinstance(self.start, str) and self.start in [*StartName]:
            object.__setattr__(self, "start", StartName(self.start))
        object.__setattr__(self, "penalty", penalty_of(self.penalty))
        ensure_whole_fields(self)
        if not isinstance(self.polish, bool):
            raise OptionError(f"polish must be True or False; found {shown(self.polish)}")
        if not (self.start is None or isinstance(self.start, StartName | os.PathLike | GivenStart)):
            given = shown(self.start) if isinstance(self.start, str) else f"of type {type(self.start).__name__}"
            raise OptionError(f"there is no start {given}; take {', '.join(StartName)}, or a Start of your own")
        if not self.is_random and not (self.seed is None and self.starts is None):
            raise OptionError("a seed or a number of starts needs random starts; leave out the other start")
        self._ensure_used()

    @classmethod
    def of(
        cls,
        formulation: FormulationName | str = FormulationName.COMPLEMENTARITY,
        weights: Weights | str = Weights.TRIBUTARY,
        **options: Unpack[SolveKeywords],
    ) -> "SolveOptions":
        """Make options; unlike the constructor, it is typed for names as texts."""
        return cls(**cast(dict[str, Any], {"formulation": formulation, "weights": weights, **options}))

    @property
    def is_random(self) -> bool:
        """Whether the starts are random: by their name, by a seed or by their number."""
        if self.start is None:
            return not (self.seed is None and self.starts is None)
        return self.start == StartName.RANDOM

    def uses(self, option: str) -> bool:
        """Whether the formulation has a use for an option."""
        return option in USES[self.formulation]

    def label(self, *, with_penalty: bool = False) -> str:
        """Label in a comparison, such as QP2 (consistent, μ = 0.001), without defaults.

        Parameters
        ----------
        with_penalty : whether the label has the penalty even if it is the default
        """
        if not self.uses("weights"):
            return "direct"
        other = []
        if self.weights is not Weights.TRIBUTARY:
            other.append(self.weights.value.replace("_", " "))
        if self.uses("penalty") and (with_penalty or self.penalty != 1.0):
            other.append(f"μ = {self.penalty:.15g}")
        return f"{self.formulation.upper()} ({', '.join(other)})" if other else self.formulation.upper()

    def _ensure_used(self) -> None:
        """Refuse an option that was set and that the formulation has no use for."""
        used = USES[self.formulation]
        takes = f"it takes {', '.join(used)}; " if used else ""
        for option in UNUSED[self.formulation]:
            default, value = getattr(SolveOptions, option), getattr(self, option)
            is_set = self.is_random or value not in (None, StartName.NULL) if option == "start" else value != default
            if is_set:
                stated = [name for name in ("starts", "seed") if option == "start" and getattr(self, name) is not None]
                given = stated[0] if stated else option
                owners = ", ".join(name for name, names in USES.items() if option in names)
                raise OptionError(
                    f"{self.formulation} has no use for the option '{given}'; {takes}leave it out, or name a "
                    f"formulation that takes it: {owners}"
                )


def options_of(formulation: FormulationName, options: SolveOptions | None) -> SolveOptions:
    """Options for a formulation: its defaults if none are given; those of another are refused."""
    if options is None:
        return SolveOptions(formulation=formulation)
    if options.formulation is not formulation:
        raise OptionError(f"these are options of {options.formulation}, not of {formulation}")
    return options


def penalty_of(value: object) -> float:
    """Read a penalty, a number of any kind in its range."""
    try:
        number = real_number(value, "the penalty")
    except ProblemError:
        number = 0.0
    if not LEAST_PENALTY <= number <= LARGEST_PENALTY:
        raise OptionError(
            f"the penalty must be a number from {LEAST_PENALTY:g} to {LARGEST_PENALTY:g}; found {shown(value)}: "
            "outside this range the work or the equations are lost in the round-off of the other; 1 is the default"
        )
    return number
