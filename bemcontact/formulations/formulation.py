"""What a formulation is: a function from a condensed contact problem to a solution of it."""

from dataclasses import dataclass
from typing import Protocol

from bemcontact.contact import CondensedContact, ContactSolution, Weights


@dataclass(frozen=True, kw_only=True)
class FormulationOptions:
    """How a statement is solved.

    Parameters
    ----------
    weights : the J of the objective; the complementarity problem has none and ignores it
    polish : whether the active-set step follows the solver
    max_iterations : limit of the solver's own count, or None for the solver's own limit
    """

    weights: Weights = Weights.TRIBUTARY
    polish: bool = True
    max_iterations: int | None = None


class Formulation(Protocol):
    """One statement of the contact problem together with its solver."""

    def __call__(self, condensed: CondensedContact, options: FormulationOptions) -> ContactSolution:
        """Solve; not converging is a `Status` of the solution, not an error."""
        ...
