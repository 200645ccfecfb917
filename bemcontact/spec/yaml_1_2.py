"""Reading and writing YAML 1.2: ``2e6`` is a number, ``no`` and ``on`` are texts."""

import re
from collections.abc import Callable
from typing import Any

import yaml

MOST_CHARACTERS = 1_000_000
"""Largest length of a text: it is read within a few seconds."""
MOST_VALUES = 30_000
"""Largest number of keys and values in a text."""
MOST_KEYS = 1000
"""Largest number of keys in one mapping."""
DEEPEST = 64
"""Largest depth of lists and mappings in each other; a problem needs about ten."""
LONGEST_KEY = 1024
"""Largest number of characters of a key in YAML, with its quotes."""
TAG = "tag:yaml.org,2002:"
PLAIN_SCALARS = {
    f"{TAG}null": re.compile(r"~|null|Null|NULL|"),
    f"{TAG}bool": re.compile(r"true|True|TRUE|false|False|FALSE"),
    f"{TAG}int": re.compile(r"[-+]?[0-9]{1,300}|0o[0-7]{1,300}|0x[0-9a-fA-F]{1,200}"),
    f"{TAG}float": re.compile(
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)"
    ),
    f"{TAG}merge": re.compile("<<"),
}


def _whole(text: str) -> int:
    """Read a whole number; `ValueError` for one that is beyond all numbers."""
    number = int(text, {"0o": 8, "0x": 16}.get(text[:2], 10))
    if abs(number) > 10**300:
        raise ValueError
    return number


READERS: dict[str, Callable[[str], Any]] = {
    f"{TAG}str": str,
    f"{TAG}null": lambda _: None,
    f"{TAG}bool": lambda text: {"true": True, "false": False}[text.lower()],
    f"{TAG}int": _whole,
    f"{TAG}float": lambda text: float(re.sub(r"\.(?=inf|nan)", "", text.lower())),
}


def _tag(kind: type[yaml.Node], value: Any, implicit: Any, otherwise: Callable[..., str]) -> str:
    """Tag of a node without a tag: there are no sexagesimals, dates, underscores, yes and no."""
    if kind is yaml.ScalarNode and implicit[0]:
        return next((tag for tag, pattern in PLAIN_SCALARS.items() if pattern.fullmatch(value)), f"{TAG}str")
    return otherwise(kind, value, implicit)


class Refused(yaml.MarkedYAMLError):
    """YAML that is not read although it is valid, with its place."""

    def __init__(self, problem: str, mark: yaml.Mark) -> None:
        super().__init__(problem=problem, problem_mark=mark)


class Budget:
    """How much of a text may still be read; aliases count as often as they are used."""

    def __init__(self) -> None:
        self._values = 0

    def spend(self, depth: int, mark: yaml.Mark) -> None:
        """Count a value at a depth; `Refused` if it is one too many, or too deep."""
        self._values += 1
        if self._values > MOST_VALUES:
            raise Refused(f"the text has more than {MOST_VALUES} keys and values, with those of aliases", mark)
        if depth > DEEPEST:
            raise Refused(f"lists and mappings are nested more than {DEEPEST} deep; close or remove brackets", mark)


class Loader(yaml.SafeLoader):
    """The parser of PyYAML with the plain scalars of YAML 1.2, for texts of limited size and depth."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._budget, self._depth = Budget(), 0
        self.long_key: yaml.Mark | None = None
        """Where the last text begins that is too long for a key."""

    def save_possible_simple_key(self) -> None:
        """Note where a text begins that may be a key."""
        self.long_key = None
        super().save_possible_simple_key()

    def stale_possible_simple_keys(self) -> None:
        """Give up the search for the colon after a text that is too long for a key."""
        for key in self.possible_simple_keys.values():
            if key.line == self.line and self.index - key.index > LONGEST_KEY:
                self.long_key = key.mark
        super().stale_possible_simple_keys()

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Read a value, and the values in it."""
        self._depth += 1
        self._budget.spend(self._depth, self.peek_event().start_mark)
        try:
            return super().compose_node(parent, index)
        finally:
            self._depth -= 1

    def compose_scalar_node(self, anchor: Any) -> yaml.ScalarNode:
        """Read a text; two halves of a character, as JSON escapes it, become the character."""
        node = super().compose_scalar_node(anchor)
        if not node.value.isascii():
            try:
                node.value = node.value.encode("utf-16", "surrogatepass").decode("utf-16")
            except UnicodeDecodeError:
                message = "an escape sequence is half of a character; write the character itself"
                raise Refused(message, node.start_mark) from None
        return node

    def resolve(self, kind: type[yaml.Node], value: Any, implicit: Any) -> str:
        """Tag of a node without a tag."""
        return _tag(kind, value, implicit, super().resolve)


class _Dumper(yaml.SafeDumper):
    """The writer of PyYAML with the plain scalars of YAML 1.2, so that `Loader` reads the same data."""

    def resolve(self, kind: type[yaml.Node], value: Any, implicit: Any) -> str:
        """Tag with which `Loader` reads a node."""
        return _tag(kind, value, implicit, super().resolve)

    def represent_text(self, data: str) -> yaml.ScalarNode:
        """Write a text of several lines as a block."""
        return self.represent_scalar(f"{TAG}str", data, style="|" if "\n" in data else None)

    def ignore_aliases(self, data: Any) -> bool:
        """Write no aliases."""
        return True


_Dumper.add_representer(str, _Dumper.represent_text)


def to_yaml(data: Any) -> str:
    """Data as YAML, with the innermost lists and mappings on one line."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, default_flow_style=None, width=110)
