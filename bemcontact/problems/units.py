"""Labels of units, and what is known of numbers where the labels are those of known units."""

from collections.abc import Iterator, Mapping
from math import isclose
from typing import ClassVar

from bemcontact.problems.validation import Label, SpecModel
from bemcontact.problems.wording import near_by

METERS = {
    "m": 1.0, "dm": 1e-1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "nm": 1e-9, "km": 1e3,
    "in": 0.0254, "inch": 0.0254, "ft": 0.3048,
}  # fmt: skip
"""Label of a unit of length -> the unit in meters."""
NEWTONS = {
    "N": 1.0, "kN": 1e3, "MN": 1e6, "GN": 1e9, "mN": 1e-3, "uN": 1e-6, "µN": 1e-6, "μN": 1e-6, "nN": 1e-9, "daN": 10.0,
    "kgf": 9.80665, "kp": 9.80665, "lbf": 4.4482216152605, "lb": 4.4482216152605, "kip": 4448.2216152605,
    "klbf": 4448.2216152605,
}  # fmt: skip
"""Label of a unit of force -> the unit in newtons."""
NAMED = {1.0: "Pa", 1e3: "kPa", 1e6: "MPa", 1e9: "GPa"}
"""Unit of stress in pascals -> its name."""
ALIKE = 0.75
"""Similarity from which a label is taken for a misspelled one: labels are free, and short ones are alike."""
STIFFEST, DIAMOND = 2e12, 1.2e12
"""Young's modulus [Pa] above which there is no solid, and that of diamond, which is the largest of a bulk solid."""
SOFTEST = 1e3
"""Young's modulus [Pa] below which a body keeps no shape: with the density of water and 10 cm of height it is ρ g h."""
METAL_IN_MM = (4e4, 4.5e5), (0.2, 0.36)
"""Young's moduli [N/mm²] and Poisson's ratios of metals; foam may have such a modulus in Pa."""
STEEL = 2.1e11
"""Young's modulus of steel [Pa]."""
DERIVED = "units has only length and force; pressures, stresses and moduli are in force/length², such as N/mm² or MPa"
"""What to write for the label of a unit that follows from others."""


class Units(SpecModel):
    """Labels of the units of all numbers. Numbers are not converted; values with units are, such as 210 GPa."""

    example: ClassVar[str] = "{length: mm, force: N}"
    other_words: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("pressure", "stress", "modulus", "young_modulus", "traction", "moment", "density"), DERIVED
    )

    length: Label = ""
    """The label of the unit of length, such as mm."""
    force: Label = ""
    """The label of the unit of force, such as kN."""

    @property
    def stress(self) -> str:
        """The label of the unit of stress, such as MPa or kN/cm²; empty if a label is missing."""
        named = next((name for size, name in NAMED.items() if self.pascals and isclose(self.pascals, size)), None)
        return named or (f"{self.force}/{self.length}²" if self.force and self.length else "")

    @property
    def foundation(self) -> str:
        """The label of the unit of stiffness of a foundation, such as N/mm³; empty if a label is missing."""
        return f"{self.force}/{self.length}³" if self.force and self.length else ""

    @property
    def line_force(self) -> str:
        """The label of the unit of force per thickness, such as kN/mm; empty if a label is missing."""
        return f"{self.force}/{self.length}" if self.force and self.length else ""

    @property
    def line_moment(self) -> str:
        """The label of the unit of moment per thickness, such as kN·mm/mm; empty if a label is missing."""
        return f"{self.force}·{self.length}/{self.length}" if self.force and self.length else ""

    @property
    def pascals(self) -> float | None:
        """The unit of stress in pascals; None if a label is not one of ``METERS`` and ``NEWTONS``."""
        length, force = METERS.get(self.length.strip()), NEWTONS.get(self.force.strip())
        return None if length is None or force is None else force / length**2

    def misspelled(self) -> Iterator[str]:
        """Note a label that is nearly that of a known unit; nothing is said of other labels."""
        for key, label, known in (("length", self.length.strip(), METERS), ("force", self.force.strip(), NEWTONS)):
            near = None if label in known else near_by(label, known, ALIKE)
            if near is not None:
                meant = " or ".join(f"'{unit}'" for unit in known if unit.lower() == near.lower())
                yield (
                    f"units.{key}: '{label}' is not a known unit; did you mean {meant}? "
                    "Only in known units is Young's modulus checked"
                )

    def doubts(self, young_modulus: float, poisson_ratio: float) -> Iterator[str]:
        """Note a Young's modulus that no solid has, or the number of a metal in other units.

        Nothing is said where units are not known.
        """
        unit = self.pascals
        found = 0.0 if unit is None else young_modulus * unit
        numbers = zip((young_modulus, poisson_ratio), METAL_IN_MM, strict=True)
        of_metal = unit == 1.0 and all(low <= x <= high for x, (low, high) in numbers)
        if unit is None or (SOFTEST <= found <= STIFFEST and not of_metal):
            return
        stiffer, softer = f"stiffer than diamond ({DIAMOND:g} Pa)", "softer than a body that keeps its shape"
        than = "softer than rubber" if of_metal else stiffer if found > STIFFEST else softer
        stated = f" ({young_modulus:g} {self.stress})" if self.stress != "Pa" else ""
        yield (
            f"Young's modulus is {found:.3g} Pa{stated}, {than}: check it, and the labels of the units; in "
            f"{self.stress} steel has {STEEL / unit:.3g}"
        )
