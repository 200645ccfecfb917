"""The statements of the contact problem, by name; each one takes a condensed problem and options."""

from collections.abc import Mapping

from bemcontact.formulations import complementarity, qp1, qp2, qp3
from bemcontact.formulations.formulation import Equilibrium, Formulation, FormulationOptions, Rows, Start

FORMULATIONS: Mapping[str, Formulation] = {
    "qp1": qp1.solve,
    "qp2": qp2.solve,
    "qp3": qp3.solve,
    "complementarity": complementarity.solve,
}

OPTIONS: Mapping[str, tuple[str, ...]] = {
    "qp1": qp1.OPTIONS,
    "qp2": qp2.OPTIONS,
    "qp3": qp3.OPTIONS,
    "complementarity": (),
}
"""Those of `FormulationOptions` that have a meaning for a statement, beside those that concern all."""

__all__ = ["FORMULATIONS", "OPTIONS", "Equilibrium", "Formulation", "FormulationOptions", "Rows", "Start"]
