"""What pictures show."""

from enum import StrEnum


class StressMeasure(StrEnum):
    """A stress that pictures show."""

    VON_MISES = "von_mises"
    MAX_SHEAR = "max_shear"
    XX = "xx"
    YY = "yy"
    XY = "xy"
    ZZ = "zz"

    @property
    def words(self) -> str:
        """Its name in words."""
        names = {StressMeasure.VON_MISES: "von Mises stress", StressMeasure.MAX_SHEAR: "largest shear stress"}
        return names.get(self, f"stress σ{self.value}")

    @property
    def signed(self) -> bool:
        """Whether it may be negative."""
        return self not in (StressMeasure.VON_MISES, StressMeasure.MAX_SHEAR)
