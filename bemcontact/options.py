"""What a person chooses among in stating and solving a problem.

There are no numerics here, so that ``bemcontact --help`` lists the choices at once.
"""

from dataclasses import dataclass
from enum import StrEnum


class FormulationName(StrEnum):
    """Statements of the contact problem that can be solved."""

    QP1 = "qp1"
    QP2 = "qp2"
    QP3 = "qp3"
    COMPLEMENTARITY = "complementarity"


class Weights(StrEnum):
    """How the objective integrates p δ over the contact zone: the J of [SS92] (24)-(26)."""

    TRIBUTARY = "tributary"
    """Diagonal, the length that belongs to each point: Σ w p is the resultant. The default."""
    CONSISTENT = "consistent"
    """∫ h hᵀ ds, (24)-(25): has negative entries, so that objective = 0 certifies nothing."""
    ELEMENT_LENGTH = "element_length"
    """Diagonal, the element length once per node, (26) read word for word: makes QP3 indefinite on uniform meshes."""


class Rows(StrEnum):
    """How the equations K u_n = B p + r, (12), are written in QP1 and QP2."""

    STIFFNESS = "stiffness"
    """p = S (u_n - Δ1) - V load: their residual is an error of pressure. The default."""
    COMPLIANCE = "compliance"
    """u_n = Δ1 + M p + R a with the amplitudes a as free variables: their residual is an error of displacement."""


class Equilibrium(StrEnum):
    """How QP2 keeps a body with free rigid motions in equilibrium."""

    CONSTRAINT = "constraint"
    """ℓᵀp = -load holds exactly. The default."""
    PENALTY = "penalty"
    """Only penalised, with all the rest of (12), as in [SS92]: a body lifted off its support is a stationary point."""


class StartName(StrEnum):
    """Starts of the local solver that need no numbers."""

    NULL = "null"
    """No displacement and no pressure. The default."""
    RANDOM = "random"
    """Points drawn from a seed."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """A statement with its weights and, for QP2, its penalty: one column of a comparison.

    Parameters
    ----------
    formulation : its name
    weights : of its objective, or None if it has none
    penalty : μ of QP2, free of units, else None
    tells_penalty : whether the label tells the penalty even if it is the default, beside others
    """

    formulation: FormulationName
    weights: Weights | None = None
    penalty: float | None = None
    tells_penalty: bool = False

    @property
    def label(self) -> str:
        """What it is called: QP2 (consistent, μ = 0.001); what is the default is left out."""
        if self.weights is None:
            return "direct"
        other = []
        if self.weights is not Weights.TRIBUTARY:
            other.append(self.weights.value.replace("_", " "))
        if self.penalty is not None and (self.tells_penalty or self.penalty != 1.0):
            other.append(f"μ = {self.penalty:.15g}")
        return f"{self.formulation.upper()} ({', '.join(other)})" if other else self.formulation.upper()
