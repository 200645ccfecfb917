"""The statements of the contact problem, by name; each one takes a condensed problem and options."""

from collections.abc import Mapping
from importlib import import_module
from typing import Protocol

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.options import FormulationName, SolveOptions


class Formulation(Protocol):
    """One statement of the contact problem together with its solver."""

    def __call__(self, contact: CondensedContact, options: SolveOptions) -> ContactSolution:
        """Solve; not converging is a `Status` of the solution, not an error."""
        ...


def _of(name: FormulationName) -> Formulation:
    """The formulation whose module has its name, which is imported when it first solves."""

    def solve(contact: CondensedContact, options: SolveOptions) -> ContactSolution:
        return import_module(f"{__name__}.{name}").solve(contact, options)

    return solve


FORMULATIONS: Mapping[str, Formulation] = {name: _of(name) for name in FormulationName}
