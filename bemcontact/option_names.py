"""Names that the options of the command line take, known without importing the numerical half of the package."""

from enum import StrEnum


class Formulation(StrEnum):
    """Statements of the contact problem that can be solved."""

    QP1 = "qp1"
    QP2 = "qp2"
    QP3 = "qp3"
    COMPLEMENTARITY = "complementarity"


class WeightsOption(StrEnum):
    """Names of `bemcontact.contact.Weights`, known without importing it."""

    TRIBUTARY = "tributary"
    CONSISTENT = "consistent"
    ELEMENT_LENGTH = "element_length"


class RowsOption(StrEnum):
    """Names of `bemcontact.formulations.Rows`."""

    STIFFNESS = "stiffness"
    COMPLIANCE = "compliance"


class EquilibriumOption(StrEnum):
    """Names of `bemcontact.formulations.Equilibrium`."""

    CONSTRAINT = "constraint"
    PENALTY = "penalty"


class StartOption(StrEnum):
    """Starts that need no numbers."""

    NULL = "null"
    RANDOM = "random"
