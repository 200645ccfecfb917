"""Properties that are computed once, when they are first asked for.

Classes of pydantic need the one of the standard library: they know it by its module.
"""

import functools
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    cached_property = functools.cached_property
else:

    class cached_property(functools.cached_property):  # noqa: N801
        """`functools.cached_property` without a lock, which Python 3.11 still has: it takes longer than most values."""

        def __get__(self, instance: Any, owner: type | None = None) -> Any:
            """Compute the value, and put it where it is found before this property; the property itself of a class."""
            if instance is None:
                return self
            value = instance.__dict__[self.attrname] = self.func(instance)
            return value
