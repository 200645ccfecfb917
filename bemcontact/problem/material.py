"""The elastic material: isotropic, linear, plane."""

from typing import Annotated, Literal

from pydantic import Field, ValidationInfo, field_validator

from bemcontact.problem.validation import Number, Positive, Stated, complain


class Material(Stated):
    """An isotropic linear elastic material in plane strain or plane stress.

    Raises
    ------
    ProblemError
        If E <= 0, or ν is outside the range for which the plane body has a unique equilibrium.
    """

    young_modulus: Positive
    """The modulus of elasticity E (Young's modulus), in the unit of stress."""
    state: Literal["plane_strain", "plane_stress"] = "plane_strain"
    """The plane state: plane_strain (thick body, the default) or plane_stress (thin sheet)."""
    poisson_ratio: Annotated[Number, Field(json_schema_extra={"exclusiveMinimum": -1, "maximum": 0.5})]
    """The ratio ν of Poisson, for almost all materials from 0 to less than 0.5."""

    @field_validator("poisson_ratio")
    @classmethod
    def _in_range(cls, value: float, info: ValidationInfo) -> float:
        """Refuse ν beyond positive energy, and ν = 0.5 in plane strain, where the volume could not change."""
        if not -1 < value <= 0.5:
            raise complain(f"must be greater than -1 and less than 0.5, found {value:g}")
        if value == 0.5 and info.data.get("state") == "plane_strain":
            raise complain("must be less than 0.5 in plane strain, found 0.5; take 0.499, or state: plane_stress")
        return value

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + ν)) [p]."""
        return self.young_modulus / (2 * (1 + self.poisson_ratio))

    @property
    def effective_poisson_ratio(self) -> float:
        """The ν of the plane-strain formulas: ν itself, in plane stress ν / (1 + ν)."""
        nu = self.poisson_ratio
        return nu if self.state == "plane_strain" else nu / (1 + nu)
