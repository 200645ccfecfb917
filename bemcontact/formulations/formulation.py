"""What a formulation is: a function from a condensed contact problem to a solution of it."""

import math
from dataclasses import dataclass, fields
from typing import Protocol

import numpy as np

from bemcontact.choices import Equilibrium, Rows, Weights
from bemcontact.contact import Array, CondensedContact
from bemcontact.errors import ProblemError
from bemcontact.solution import ContactSolution


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
            vector = np.array(getattr(self, name), float, ndmin=1)
            if vector.ndim != 1 or not np.isfinite(vector).all():
                raise ProblemError(f"the {name} of a start needs finite numbers, one for each contact point")
            vector.setflags(write=False)
            object.__setattr__(self, name, vector)
        if self.pressure.shape != self.displacement.shape:
            raise ProblemError(
                f"a start needs one pressure and one displacement for each contact point; found {self.pressure.size} "
                f"pressures and {self.displacement.size} displacements"
            )

    def ensure_fits(self, size: int) -> None:
        """Refuse a start for another number of contact points."""
        if self.pressure.size != size:
            raise ProblemError(
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
    max_iterations : limit of the solver's own count, or None for the solver's own limit
    penalty : μ of QP2, free of units: a thousandth weighs the equations a thousand times more
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
        """Refuse a penalty that divides by nothing."""
        if not (math.isfinite(self.penalty) and self.penalty > 0):
            raise ProblemError(f"the penalty must be a finite number above zero; found {self.penalty!r}")

    def ensure_used(self, formulation: str, *used: str) -> None:
        """Refuse options that were set and that a formulation has no use for; `polish` and the limit concern all."""
        for item in fields(self):
            if item.name in ("polish", "max_iterations", *used) or getattr(self, item.name) == item.default:
                continue
            takes = f"; it takes {', '.join(used)}" if used else ""
            raise ProblemError(f"{formulation} has no use for the option '{item.name}'{takes}; leave it out")


class Formulation(Protocol):
    """One statement of the contact problem together with its solver."""

    def __call__(self, condensed: CondensedContact, options: FormulationOptions) -> ContactSolution:
        """Solve; not converging is a `Status` of the solution, not an error."""
        ...
