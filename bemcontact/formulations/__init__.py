"""The statements of the contact problem, by name; each one takes a condensed problem and options."""

from collections.abc import Mapping
from typing import Protocol

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.formulations import complementarity, qp1, qp2, qp3
from bemcontact.options import FormulationName, SolveOptions


class Formulation(Protocol):
    """One statement of the contact problem together with its solver."""

    def __call__(self, contact: CondensedContact, options: SolveOptions) -> ContactSolution:
        """Solve; not converging is a `Status` of the solution, not an error."""
        ...


FORMULATIONS: Mapping[str, Formulation] = {
    FormulationName.QP1: qp1.solve,
    FormulationName.QP2: qp2.solve,
    FormulationName.QP3: qp3.solve,
    FormulationName.COMPLEMENTARITY: complementarity.solve,
}
