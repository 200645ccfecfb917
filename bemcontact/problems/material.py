"""The material of a body."""

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import Field, ValidationInfo, field_validator

from bemcontact.problems.validation import Finite, Positive, SpecModel, invalid
from bemcontact.problems.wording import exact


class Material(SpecModel):
    """An isotropic linear elastic material in plane strain or plane stress."""

    example: ClassVar[str] = "{young_modulus: 210000, poisson_ratio: 0.3}"
    other_words: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(
            ("E", "elastic_modulus", "youngs_modulus", "young", "Young", "modulus"), "Young's modulus is young_modulus"
        ),
        **dict.fromkeys(("nu", "ν"), "Poisson's ratio is poisson_ratio"),
        **dict.fromkeys(("density", "rho"), "the density belongs to the load that needs it: loads.gravity.density"),
        **dict.fromkeys(("plane", "plane_stress", "plane_strain"), "write state: plane_stress, or state: plane_strain"),
        **dict.fromkeys(("friction", "mu"), "contact is without friction; leave it out"),
        **dict.fromkeys(("G", "shear_modulus"), "write young_modulus and poisson_ratio: E = 2 G (1 + ν)"),
        **dict.fromkeys(
            ("alpha", "cte", "CTE", "expansion", "thermal_expansion", "thermal_expansion_coefficient"),
            "thermal expansion belongs to the load: loads.temperature.expansion",
        ),
    }

    young_modulus: Positive
    """The modulus of elasticity E (Young's modulus), in the unit of stress."""
    state: Literal["plane_strain", "plane_stress"] = "plane_strain"
    """The plane state: plane_strain (thick body, the default) or plane_stress (thin sheet)."""
    poisson_ratio: Annotated[Finite, Field(json_schema_extra={"exclusiveMinimum": -1, "maximum": 0.5})]
    """The Poisson ratio ν, for most materials between 0 and 0.5."""

    @field_validator("poisson_ratio")
    @classmethod
    def _in_range(cls, value: float, info: ValidationInfo) -> float:
        """Refuse ν without positive strain energy, and ν = 0.5 in plane strain, which is incompressible."""
        if not -1 < value <= 0.5:
            raise invalid(f"must be greater than -1 and less than 0.5, found {exact(value)}")
        if value == 0.5 and info.data.get("state") == "plane_strain":
            raise invalid("must be less than 0.5 in plane strain, found 0.5; take 0.499, or state: plane_stress")
        return value

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + ν)) [p]."""
        return self.young_modulus / (2 * (1 + self.poisson_ratio))

    @property
    def effective_poisson_ratio(self) -> float:
        """The ν of the plane-strain formulas: ν itself in plane strain, ν / (1 + ν) in plane stress."""
        nu = self.poisson_ratio
        return nu if self.state == "plane_strain" else nu / (1 + nu)

    @property
    def contact_modulus(self) -> float:
        """E* [p] of the body on a rigid one: E / (1 - ν²) in plane strain, E in plane stress, [Joh85] 4.2."""
        return 2 * self.shear_modulus / (1 - self.effective_poisson_ratio)
