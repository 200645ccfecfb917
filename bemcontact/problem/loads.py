"""Loads that act on the volume of the body."""

from typing import Self

from pydantic import model_validator

from bemcontact.problem.conditions import Field
from bemcontact.problem.validation import Number, Point, Positive, Stated, complain


class Gravity(Stated):
    """Weight: the body force density · acceleration."""

    density: Positive
    """Mass per volume."""
    acceleration: Point
    """Acceleration of gravity [gx, gy], such as [0, -9.81]."""


class Centrifugal(Stated):
    """The body force density · angular_velocity² · (x - center) of a body that rotates steadily."""

    density: Positive
    """Mass per volume."""
    angular_velocity: Number
    """Angular velocity in radians per time."""
    center: Point = (0.0, 0.0)
    """The axis of rotation [x, y]."""


class Temperature(Stated):
    """Thermal strain expansion · change in all directions.

    Raises
    ------
    ProblemError
        If the change is not linear in the coordinates.
    """

    expansion: Number
    """Coefficient of thermal expansion, per degree."""
    change: Field
    """Change of temperature in degrees: a number, or a polynomial of constant, x and y."""

    @model_validator(mode="after")
    def _linear(self) -> Self:
        """Refuse a field for which the thermal displacement has no simple closed form."""
        change = self.change
        if excess := [term for term in ("xx", "xy", "yy") if getattr(change, term) != 0]:
            raise complain(f"change of temperature may have constant, x and y only; leave out {', '.join(excess)}")
        return self


class Loads(Stated):
    """All volume loads; they add up."""

    gravity: Gravity | None = None
    """Weight of the body."""
    centrifugal: Centrifugal | None = None
    """Steady rotation."""
    temperature: Temperature | None = None
    """Change of temperature."""
