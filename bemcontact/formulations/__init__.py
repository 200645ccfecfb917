"""The statements of the contact problem, by name; each one takes a condensed problem and options."""

from collections.abc import Mapping

from bemcontact.formulations import complementarity, qp3
from bemcontact.formulations.formulation import Formulation, FormulationOptions

FORMULATIONS: Mapping[str, Formulation] = {
    "qp3": qp3.solve,
    "complementarity": complementarity.solve,
}

__all__ = ["FORMULATIONS", "Formulation", "FormulationOptions"]
