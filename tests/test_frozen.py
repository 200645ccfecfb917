"""Classes by `frozen` and `frozen_value` do what those of `dataclasses.dataclass` do, the reference of all tests."""

import copy
import inspect
import pickle
from dataclasses import FrozenInstanceError, asdict, dataclass, field, fields, is_dataclass, replace
from typing import Any

import numpy as np
import pytest

from bemcontact.frozen import frozen, frozen_value


@frozen_value
class Spring:
    """A value."""

    stiffness: float
    name: str = "spring"
    places: list[float] = field(default_factory=list, compare=False)
    secret: int = field(default=0, repr=False)


@dataclass(frozen=True, kw_only=True)
class Reference:
    """The same by the standard library."""

    stiffness: float
    name: str = "spring"
    places: list[float] = field(default_factory=list, compare=False)
    secret: int = field(default=0, repr=False)


@frozen
class Damped(Spring):
    """A value with one more field, and a value that is made of others."""

    damping: float

    def __post_init__(self) -> None:
        if self.damping < 0:
            raise ValueError("negative")


@frozen
class Row:
    """An object with an array."""

    values: "np.ndarray[Any, Any]"


class Named:
    """A base with a representation of its own."""

    def __repr__(self) -> str:
        return "named"


@frozen
class Shown(Named):
    """It is shown as its base says."""

    value: int


GIVEN: list[dict[str, Any]] = [
    {"stiffness": 2.0},
    {"stiffness": 2.0, "places": [1.0]},
    {"secret": 3, "name": "other", "stiffness": 1.0},
]


@pytest.mark.parametrize("given", GIVEN)
def test_values_are_those_of_a_dataclass_in_the_order_of_the_fields(given: dict[str, Any]) -> None:
    made, expected = Spring(**given), Reference(**given)
    assert [*vars(made).items()] == [*vars(expected).items()]
    assert asdict(made) == asdict(expected)  # type: ignore[call-overload]
    assert repr(made) == repr(expected).replace("Reference", "Spring")


@pytest.mark.parametrize("given", [{}, {"name": "x"}, {"stiffness": 1.0, "stifness": 2.0}, {"x": 1}])
def test_wrong_fields_are_named(given: dict[str, Any]) -> None:
    with pytest.raises(TypeError):
        Reference(**given)
    wrong = next((name for name in given if name not in {"stiffness", "name"}), "stiffness")
    with pytest.raises(TypeError, match=rf"Spring\.__init__\(\) got .* keyword argument '{wrong}'"):
        Spring(**given)


def test_positions_are_refused() -> None:
    with pytest.raises(TypeError, match="positional"):
        Spring(1.0)  # type: ignore[misc]


def test_a_default_that_is_made_is_made_each_time() -> None:
    assert Spring(stiffness=1.0).places is not Spring(stiffness=1.0).places


@pytest.mark.parametrize("name", ["stiffness", "other"])
def test_nothing_changes(name: str) -> None:
    made = Spring(stiffness=1.0)
    with pytest.raises(FrozenInstanceError, match=f"Spring is frozen: '{name}' cannot change"):
        setattr(made, name, 2.0)
    with pytest.raises(FrozenInstanceError, match=f"Spring is frozen: '{name}' cannot change"):
        delattr(made, name)
    assert made == Spring(stiffness=1.0)


def test_objects_are_equal_as_asked() -> None:
    one, other = Spring(stiffness=1.0), Spring(stiffness=1.0, places=[2.0])
    assert one == other
    assert hash(one) == hash(other)
    assert one != Spring(stiffness=1.0, secret=1)
    assert one != Reference(stiffness=1.0)
    row = Row(values=np.ones(2))
    assert row == row
    assert row != Row(values=row.values)
    assert {row: 1}[row] == 1


def test_copies_and_pickles() -> None:
    made = Damped(stiffness=1.0, damping=0.1, places=[1.0])
    for again in (copy.copy(made), copy.deepcopy(made), pickle.loads(pickle.dumps(made)), replace(made)):
        assert vars(again) == vars(made)
        assert type(again) is Damped
    assert replace(made, name="n").name == "n"
    with pytest.raises(ValueError, match="negative"):
        replace(made, damping=-1.0)


def test_fields_and_signature_are_those_of_a_dataclass() -> None:
    assert is_dataclass(Spring)
    assert [item.name for item in fields(Damped)] == [
        *(item.name for item in fields(Reference)),
        "damping",
    ]
    made, expected = (inspect.signature(kind).parameters for kind in (Spring, Reference))
    assert [*made] == [*expected]
    for name, parameter in made.items():
        assert (parameter.kind, parameter.annotation) == (expected[name].kind, expected[name].annotation)
        assert (parameter.default is inspect.Parameter.empty) == (expected[name].default is inspect.Parameter.empty)
    assert made["name"].default == "spring"


def test_a_base_keeps_its_representation() -> None:
    assert repr(Shown(value=1)) == "named"
    assert repr(Damped(stiffness=1.0, damping=0.0)).startswith("Damped(stiffness=1.0, name='spring'")
