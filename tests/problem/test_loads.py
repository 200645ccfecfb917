"""Volume loads: what is refused."""

import pytest

from bemcontact.errors import ProblemError
from bemcontact.problem import Centrifugal, Field, Gravity, Loads, Temperature


def test_loads_are_absent_unless_given():
    assert Loads() == Loads(gravity=None, centrifugal=None, temperature=None)
    assert Centrifugal(density=1, angular_velocity=2).center == (0, 0)


def test_density_is_positive():
    with pytest.raises(ProblemError, match=r"gravity\.density: must be greater than 0, found 0"):
        Loads(gravity={"density": 0, "acceleration": [0, -9.81]})
    with pytest.raises(ProblemError, match="acceleration: expected two numbers"):
        Gravity(density=1, acceleration=-9.81)


def test_temperature_is_linear_in_the_coordinates():
    change = Field(constant=20, x=1, y=-1)
    assert Temperature(expansion=1e-5, change=change).change == change
    with pytest.raises(ProblemError, match="may have constant, x and y only; leave out xx, yy"):
        Temperature(expansion=1e-5, change=Field(xx=1, yy=1))
