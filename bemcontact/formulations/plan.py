"""How a problem is to be solved, put together from names and numbers and checked before there is a problem."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import product
from numbers import Real
from typing import Any, TypeVar

from bemcontact.errors import OptionError
from bemcontact.formulations import OPTIONS, FormulationOptions, Start
from bemcontact.formulations.formulation import ensure_whole
from bemcontact.formulations.starts import StartChoice
from bemcontact.options import Equilibrium, FormulationName, Rows, Setting, Weights

Name = TypeVar("Name", bound=Enum)
Item = TypeVar("Item")

COMPARED = (FormulationName.QP1, FormulationName.QP2, FormulationName.QP3)
"""What is compared with the direct solution."""


@dataclass(frozen=True, kw_only=True)
class Plan:
    """A formulation with its options and where it starts.

    Parameters
    ----------
    formulation : a key of `FORMULATIONS`
    options : of the formulation, which has a use for each that is set
    start : where its solver starts
    """

    formulation: str
    options: FormulationOptions
    start: StartChoice


def planned(
    formulation: str = FormulationName.QP3,
    weights: Weights | str = Weights.TRIBUTARY,
    *,
    penalty: float = 1.0,
    rows: Rows | str = Rows.STIFFNESS,
    equilibrium: Equilibrium | str = Equilibrium.CONSTRAINT,
    start: Start | str | None = None,
    seed: int | None = None,
    starts: int | None = None,
    max_iterations: int | None = None,
) -> Plan:
    """Read the options of `bemcontact.solve`.

    Parameters
    ----------
    formulation, weights, penalty, rows, equilibrium, start, seed, starts, max_iterations : as of `bemcontact.solve`

    Returns
    -------
    Plan

    Raises
    ------
    OptionError
        A name is unknown, a number out of range, or the formulation has no use for an option.
    """
    name = _named(FormulationName, formulation, "formulation")
    options = FormulationOptions(
        weights=_named(Weights, weights, "weights"),
        penalty=penalty,
        rows=_named(Rows, rows, "rows"),
        equilibrium=_named(Equilibrium, equilibrium, "ways of equilibrium"),
        max_iterations=max_iterations,
    )
    options.ensure_used(name, *OPTIONS[name])
    choice = StartChoice(start=start, seed=seed, count=starts)
    choice.ensure_used(name, "start" in OPTIONS[name])
    return Plan(formulation=name, options=options, start=choice)


@dataclass(frozen=True, kw_only=True)
class ComparisonPlan:
    """What is to be compared.

    Parameters
    ----------
    reference : the direct solution
    contenders : what is compared with it, each with its plan
    starts : how many random starts of QP1 and QP2 are to be made beside the null start, or None
    seed : of these
    """

    reference: Plan
    contenders: tuple[tuple[Setting, Plan], ...]
    starts: int | None
    seed: int

    def to_dict(self) -> dict[str, Any]:
        """Give it as numbers, lists and texts, ready for JSON."""
        settings = [setting for setting, _ in self.contenders]
        return {
            "formulations": [*dict.fromkeys(setting.formulation.value for setting in settings)],
            "weights": [*dict.fromkeys(setting.weights.value for setting in settings if setting.weights is not None)],
            "penalties": [*dict.fromkeys(setting.penalty for setting in settings if setting.penalty is not None)],
            "starts": self.starts,
            "seed": self.seed,
        }


def planned_comparison(
    formulations: Sequence[str] = COMPARED,
    weights: Sequence[Weights | str] = (Weights.TRIBUTARY,),
    penalties: Sequence[float] | None = None,
    *,
    starts: int | None = None,
    seed: int | None = None,
) -> ComparisonPlan:
    """Read the options of `bemcontact.compare`.

    Parameters
    ----------
    formulations, weights, penalties, starts, seed : as of `bemcontact.compare`

    Returns
    -------
    ComparisonPlan

    Raises
    ------
    OptionError
        A name is unknown, a number out of range, something is there twice or not at all, or is of no use.
    """
    names = _several(formulations, "formulations", _compared)
    kinds = _several(weights, "weights", lambda name: _named(Weights, name, "weights"))
    values = _several((1.0,) if penalties is None else penalties, "penalties", _as_float)
    if FormulationName.COMPLEMENTARITY in names:
        raise OptionError("complementarity is the reference of every comparison; leave it out of the formulations")
    if FormulationName.QP2 not in names and penalties is not None:
        raise OptionError("a penalty is an option of qp2, which is not among the formulations; add it")
    if starts is None and seed is not None:
        raise OptionError("a seed goes with random starts; say how many (starts)")
    if starts is not None:
        ensure_whole(starts, "number of starts", 1)
        if names == (FormulationName.QP3,):
            raise OptionError("random starts are for qp1 and qp2, which are not among the formulations; add one")
    if seed is not None:
        ensure_whole(seed, "seed", 0)
    settings = [
        Setting(formulation=name, weights=kind, penalty=value, tells_penalty=len(values) > 1)
        for name, kind in product(names, kinds)
        for value in (values if name == FormulationName.QP2 else (None,))
    ]
    return ComparisonPlan(
        reference=planned(FormulationName.COMPLEMENTARITY),
        contenders=tuple((setting, _plan_of(setting)) for setting in settings),
        starts=None if starts is None else int(starts),
        seed=0 if seed is None else int(seed),
    )


def _compared(name: str) -> FormulationName:
    """Read the name of a formulation that can be compared with the direct solution."""
    if name not in [*FormulationName]:
        raise OptionError(f"no formulation '{name}' to compare; take one of {', '.join(COMPARED)}")
    return FormulationName(name)


def _as_float(value: object) -> Any:
    """A number of any kind as a float; what is none is refused by `FormulationOptions`."""
    return float(value) if isinstance(value, Real) else value


def _plan_of(setting: Setting) -> Plan:
    """How a column of a comparison is solved."""
    penalty = 1.0 if setting.penalty is None else setting.penalty
    weights = Weights.TRIBUTARY if setting.weights is None else setting.weights
    return planned(setting.formulation, weights, penalty=penalty)


def _several(items: Sequence[Any], what: str, read: Callable[[Any], Item]) -> tuple[Item, ...]:
    """Read a list in which nothing is twice; one alone stands for a list of it."""
    listed = [items] if isinstance(items, str | Real) else [*items]
    found = tuple(map(read, listed))
    if not found or len({*found}) < len(found):
        told = ", ".join(map(str, listed)) or "none"
        raise OptionError(f"the {what} must be different from each other, and at least one; found {told}")
    return found


def _named(kind: type[Name], name: Name | str, what: str) -> Name:
    """Read a name of a kind."""
    try:
        return kind(name)
    except ValueError:
        raise OptionError(f"no {what} '{name}'; take one of {', '.join(item.value for item in kind)}") from None
