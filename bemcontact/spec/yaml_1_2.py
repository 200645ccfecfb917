"""YAML as its version 1.2 has it, to read and to write: ``2e6`` is a number, ``no`` and ``on`` are texts."""

import re
from collections.abc import Callable
from typing import Any

import yaml

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
READERS: dict[str, Callable[[str], Any]] = {
    f"{TAG}str": str,
    f"{TAG}null": lambda _: None,
    f"{TAG}bool": lambda text: {"true": True, "false": False}[text.lower()],
    f"{TAG}int": lambda text: int(text, {"0o": 8, "0x": 16}.get(text[:2], 10)),
    f"{TAG}float": lambda text: float(re.sub(r"\.(?=inf|nan)", "", text.lower())),
}


def _tag(kind: type[yaml.Node], value: Any, implicit: Any, otherwise: Callable[..., str]) -> str:
    """Say which tag a node has that bears none: no sexagesimals, dates, underscores, yes and no."""
    if kind is yaml.ScalarNode and implicit[0]:
        return next((tag for tag, pattern in PLAIN_SCALARS.items() if pattern.fullmatch(value)), f"{TAG}str")
    return otherwise(kind, value, implicit)


class Loader(yaml.SafeLoader):
    """PyYAML's parser with the plain scalars of YAML 1.2."""

    def resolve(self, kind: type[yaml.Node], value: Any, implicit: Any) -> str:
        """Say which tag a node has that bears none."""
        return _tag(kind, value, implicit, super().resolve)


class _Dumper(yaml.SafeDumper):
    """PyYAML's writer with the same, so that what it writes is read as what it was."""

    def resolve(self, kind: type[yaml.Node], value: Any, implicit: Any) -> str:
        """Say which tag a node will be read with."""
        return _tag(kind, value, implicit, super().resolve)

    def ignore_aliases(self, data: Any) -> bool:
        """Write everything out."""
        return True


def written(data: Any) -> str:
    """Write plain data as YAML, the innermost lists and mappings on one line."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, default_flow_style=None, width=110)
