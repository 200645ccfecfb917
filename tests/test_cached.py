"""Properties that are computed once."""

import functools
from dataclasses import dataclass, field, replace

from bemcontact.cached import cached_property


@dataclass(frozen=True, eq=False)
class Counted:
    """An object that counts how often its property is computed."""

    calls: list[int] = field(default_factory=list)

    @cached_property
    def value(self) -> int:
        """A number of calls."""
        self.calls.append(1)
        return len(self.calls)


def test_a_property_is_computed_when_it_is_first_asked_for_and_never_again():
    one = Counted()
    assert not one.calls
    assert (one.value, one.value, vars(one)["value"]) == (1, 1, 1)
    assert replace(one).value == 2  # a copy computes its own
    assert isinstance(Counted.value, functools.cached_property)
    assert Counted.value.__doc__ == "A number of calls."
