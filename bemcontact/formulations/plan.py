"""How a problem is to be solved, put together from names and numbers and checked before there is a problem."""

from dataclasses import dataclass
from enum import Enum
from typing import TypeVar

from bemcontact.choices import Equilibrium, FormulationName, Rows, Weights
from bemcontact.errors import OptionError
from bemcontact.formulations import OPTIONS, FormulationOptions, Start
from bemcontact.formulations.starts import StartChoice

Name = TypeVar("Name", bound=Enum)


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


def _named(kind: type[Name], name: Name | str, what: str) -> Name:
    """Read a name of a kind."""
    try:
        return kind(name)
    except ValueError:
        raise OptionError(f"no {what} '{name}'; take one of {', '.join(item.value for item in kind)}") from None
