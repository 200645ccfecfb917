"""Options by keyword: the name of one that does not exist is refused with the one that is meant."""

from collections.abc import Callable, Collection, Iterable
from dataclasses import fields
from difflib import get_close_matches
from functools import wraps
from typing import Any, TypeVar

from bemcontact.errors import OptionError

Options = TypeVar("Options")
Refusal = Callable[[Iterable[str], Collection[str]], None]
"""Refuses those of some names that are not among the known ones."""


def ensure_known_names(names: Iterable[str], known: Collection[str]) -> None:
    """Refuse the name of an option that does not exist; say which is meant, or list those that do."""
    for name in names:
        if name not in known:
            raise unknown_option(name, known, get_close_matches(str(name), [*known], n=1))


def unknown_option(name: object, known: Collection[str], meant: list[str]) -> OptionError:
    """The error of the name of an option that does not exist; `meant` may be empty."""
    words = f"did you mean '{meant[0]}'?" if meant else f"choose from {', '.join(known)}"
    return OptionError(f"there is no option '{name}'; {words}")


def refusing_unknown(refuse: Refusal = ensure_known_names) -> Callable[[type[Options]], type[Options]]:
    """Let the constructor of a dataclass of options refuse unknown keywords by `OptionError`, not by `TypeError`."""

    def decorated(options: type[Options]) -> type[Options]:
        make, known = options.__init__, [item.name for item in fields(options)]  # pyright: ignore[reportArgumentType]

        @wraps(make)
        def checked(self: Options, *values: Any, **given: Any) -> None:
            refuse(given, known)
            make(self, *values, **given)

        options.__init__ = checked
        return options

    return decorated
