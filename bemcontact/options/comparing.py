"""The options of a comparison: which formulations are compared with the direct solution, with which weights."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from typing import Any, Unpack, cast

from bemcontact.checks.arguments import shown
from bemcontact.checks.keywords import refusing_unknown
from bemcontact.errors import OptionError
from bemcontact.frozen import frozen_value
from bemcontact.options.declaration import (
    declared,
    documented,
    ensure_known,
    ensure_whole_fields,
    named,
    redeclared,
)
from bemcontact.options.solving import COMPARED, ComparisonKeywords, FormulationName, SolveOptions, Weights, penalty_of


@documented
@refusing_unknown(ensure_known)
@frozen_value
class ComparisonOptions:
    """What is compared with the direct solution: each formulation with all weights, QP2 with all penalties.

    Raises
    ------
    OptionError
        A value occurs twice, is missing, out of range, or of no use.
    """

    formulations: tuple[FormulationName, ...] = declared(
        COMPARED, f"What to compare with the direct solution: {', '.join(COMPARED)}.", metavar="NAME,…"
    )
    weights: tuple[Weights, ...] = declared(
        (Weights.TRIBUTARY,), f"Weights of the objectives: {', '.join(Weights)}.", metavar="NAME,…"
    )
    penalties: tuple[float, ...] | None = declared(
        None, "qp2: penalties, such as 1e-6,1e-3,1,1e3.", metavar="μ,…", shown="1"
    )
    starts: int | None = redeclared(
        SolveOptions, "starts", "qp1, qp2: count how many of N random starts end at the solution."
    )
    seed: int | None = redeclared(SolveOptions, "seed")

    def __post_init__(self) -> None:
        """Read names and numbers, a single one as a list; refuse what is out of range, given twice, or of no use."""
        formulations = tuple(_compared(name) for name in _listed(self.formulations))
        weights = tuple(named(Weights, name, "weights") for name in _listed(self.weights))
        penalties = None if self.penalties is None else tuple(penalty_of(value) for value in _listed(self.penalties))
        for name, value in (("formulations", formulations), ("weights", weights), ("penalties", penalties)):
            object.__setattr__(self, name, value)
        for what in ("formulations", "weights", "penalties"):
            _ensure_different(getattr(self, what), what)
        if FormulationName.COMPLEMENTARITY in self.formulations:
            raise OptionError("complementarity is the reference of every comparison; leave it out of the formulations")
        if FormulationName.QP2 not in self.formulations and self.penalties is not None:
            raise OptionError("a penalty is an option of qp2, which is not among the formulations; add it")
        if self.starts is None and self.seed is not None:
            raise OptionError("a seed goes with random starts; say how many (starts)")
        ensure_whole_fields(self)
        if self.starts is not None and self.formulations == (FormulationName.QP3,):
            raise OptionError("random starts are for qp1 and qp2, which are not among the formulations; add one")
        _ = self.attempts  # SolveOptions checks the penalties

    @classmethod
    def of(
        cls,
        formulations: Sequence[FormulationName | str] | str = COMPARED,
        weights: Sequence[Weights | str] | str = (Weights.TRIBUTARY,),
        penalties: Sequence[float] | float | None = None,
        **options: Unpack[ComparisonKeywords],
    ) -> "ComparisonOptions":
        """Make options; unlike the constructor, it is typed for names as texts and for single items."""
        given = {"formulations": formulations, "weights": weights, "penalties": penalties, **options}
        return cls(**cast(dict[str, Any], given))

    @property
    def attempts(self) -> tuple[SolveOptions, ...]:
        """What is compared with the direct solution, each from the null start."""
        return tuple(
            SolveOptions(formulation=name, weights=weights, penalty=penalty)
            for name, weights in product(self.formulations, self.weights)
            for penalty in ((self.penalties or (1.0,)) if name is FormulationName.QP2 else (1.0,))
        )

    @property
    def has_penalties(self) -> bool:
        """Whether there are several penalties, so that each label needs its own."""
        return len(self.penalties or ()) > 1


def _compared(name: object) -> FormulationName:
    """Read the name of a formulation that can be compared with the direct solution."""
    if not isinstance(name, str) or name not in [*FormulationName]:
        given = f"'{name}'" if isinstance(name, str) else shown(name)
        raise OptionError(f"no formulation {given:.80} to compare; take one of {', '.join(COMPARED)}")
    return FormulationName(name)


def _listed(items: Any) -> Iterable[Any]:
    """The items; a single one, which is no list, as a list."""
    is_list = isinstance(items, Iterable) and not isinstance(items, str | bytes | Mapping)
    return items if is_list and getattr(items, "shape", None) != () else [items]


def _ensure_different(items: Sequence[object] | None, what: str) -> None:
    """Refuse an empty list, and one with equal items."""
    if items is not None and (not items or len({*items}) < len(items)):
        listed = ", ".join(map(str, items)) or "none"
        raise OptionError(f"the {what} must be different from each other, and at least one; found {listed}")
