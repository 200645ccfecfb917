"""The statements of the contact problem, by name; each one takes a condensed problem and options."""

from collections.abc import Mapping

from bemcontact.formulations import complementarity, qp1, qp2, qp3
from bemcontact.formulations.formulation import Formulation, FormulationOptions, Start
from bemcontact.options import FormulationName

FORMULATIONS: Mapping[str, Formulation] = {
    FormulationName.QP1: qp1.solve,
    FormulationName.QP2: qp2.solve,
    FormulationName.QP3: qp3.solve,
    FormulationName.COMPLEMENTARITY: complementarity.solve,
}

OPTIONS: Mapping[str, tuple[str, ...]] = {
    FormulationName.QP1: qp1.OPTIONS,
    FormulationName.QP2: qp2.OPTIONS,
    FormulationName.QP3: qp3.OPTIONS,
    FormulationName.COMPLEMENTARITY: (),
}
"""Those of `FormulationOptions` that have a meaning for a statement, beside those that concern all."""

__all__ = ["FORMULATIONS", "OPTIONS", "Formulation", "FormulationOptions", "Start"]
