"""What a formulation is: a function from a condensed contact problem to a solution of it."""

from dataclasses import dataclass, fields
from numbers import Integral, Real
from typing import Protocol

import numpy as np

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.errors import OptionError
from bemcontact.options import Equilibrium, Rows, Weights

LEAST_PENALTY, LARGEST_PENALTY = 1e-8, 1e8
"""Beyond, the smaller of QP2's two terms is lost in the round-off of the other: doubles carry 16 digits."""


def ensure_whole(value: object, what: str, least: int) -> None:
    """Refuse what is no whole number of at least `least`; `what` names it in the error."""
    if not isinstance(value, Integral) or isinstance(value, bool) or value < least:
        raise OptionError(f"the {what} must be a whole number of at least {least}; found {value!r}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Start:
    """Where a local solver starts, in the user's units.

    Parameters
    ----------
    pressure : (n,) p [p]
    displacement : (n,) u_n [L]
    label : what it is called in reports
    """

    pressure: Array
    displacement: Array
    label: str = "given point"

    def __post_init__(self) -> None:
        """Refuse what is no pair of equally long vectors of finite numbers; make them read-only."""
        for name in ("pressure", "displacement"):
            try:
                vector = np.array(getattr(self, name), float, ndmin=1)
            except (TypeError, ValueError):
                vector = np.array([np.nan])
            if vector.ndim != 1 or not np.isfinite(vector).all():
                raise OptionError(f"the {name} of a start needs finite numbers, one for each contact point")
            vector.setflags(write=False)
            object.__setattr__(self, name, vector)
        if self.pressure.shape != self.displacement.shape:
            raise OptionError(
                f"a start needs one pressure and one displacement for each contact point; found {self.pressure.size} "
                f"pressures and {self.displacement.size} displacements"
            )

    def ensure_fits(self, size: int) -> None:
        """Refuse a start for another number of contact points."""
        if self.pressure.size != size:
            raise OptionError(
                f"the start has {self.pressure.size} contact points and the problem {size}; give one pressure and one "
                "displacement for each, in the order of the problem's points"
            )


@dataclass(frozen=True, kw_only=True)
class FormulationOptions:
    """How a statement is solved; a formulation refuses an option that it has no use for.

    Parameters
    ----------
    weights : the J of the objective; the complementarity problem has none
    polish : whether the active-set step follows the solver
    max_iterations : limit of the iterations of the local solver, of Clarabel (QP3), or of the pivots of Lemke's method
        (complementarity); None for the solver's own
    penalty : μ of QP2, free of units, 1e-8 to 1e8: a thousandth weighs the equations a thousand times more
    rows : how QP1 and QP2 write the equations
    equilibrium : how QP2 keeps a body with free rigid motions in equilibrium
    start : of QP1 and QP2, or None for the null vector
    """

    weights: Weights = Weights.TRIBUTARY
    polish: bool = True
    max_iterations: int | None = None
    penalty: float = 1.0
    rows: Rows = Rows.STIFFNESS
    equilibrium: Equilibrium = Equilibrium.CONSTRAINT
    start: Start | None = None

    def __post_init__(self) -> None:
        """Refuse a penalty in which one term of QP2 is lost, and a limit that lets nothing be done."""
        is_number = isinstance(self.penalty, Real) and not isinstance(self.penalty, bool)
        if not (is_number and LEAST_PENALTY <= self.penalty <= LARGEST_PENALTY):
            raise OptionError(
                f"the penalty must be a number from {LEAST_PENALTY:g} to {LARGEST_PENALTY:g}; found {self.penalty!r}: "
                "beyond, the work or the equations are lost in the round-off of the other; 1 is the default"
            )
        if self.max_iterations is not None:
            ensure_whole(self.max_iterations, "limit of iterations", 1)

    def ensure_used(self, formulation: str, *used: str) -> None:
        """Refuse options that were set and that a formulation has no use for; `polish` and the limit concern all."""
        for item in fields(self):
            if item.name in ("polish", "max_iterations", *used) or getattr(self, item.name) == item.default:
                continue
            takes = f"; it takes {', '.join(used)}" if used else ""
            raise OptionError(f"{formulation} has no use for the option '{item.name}'{takes}; leave it out")


class Formulation(Protocol):
    """One statement of the contact problem together with its solver."""

    def __call__(self, contact: CondensedContact, options: FormulationOptions) -> ContactSolution:
        """Solve; not converging is a `Status` of the solution, not an error."""
        ...
