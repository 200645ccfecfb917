"""Reading and writing YAML 1.2: ``2e6`` is a number, ``no`` and ``on`` are texts."""

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
    """Tag of a node without a tag: there are no sexagesimals, dates, underscores, yes and no."""
    if kind is yaml.ScalarNode and implicit[0]:
        return next((tag for tag, pattern in PLAIN_SCALARS.items() if pattern.fullmatch(value)), f"{TAG}str")
    return otherwise(kind, value, implicit)


class Loader(yaml.SafeLoader):
    """The parser of PyYAML with the plain scalars of YAML 1.2."""

    def resolve(self, kind: type[yaml.Node], value: Any, implicit: Any) -> str:
        """Tag of a node without a tag."""
        return _tag(kind, value, implicit, super().resolve)


class _Dumper(yaml.SafeDumper):
    """The writer of PyYAML with the plain scalars of YAML 1.2, so that `Loader` reads the same data."""

    def resolve(self, kind: type[yaml.Node], value: Any, implicit: Any) -> str:
        """Tag with which `Loader` reads a node."""
        return _tag(kind, value, implicit, super().resolve)

    def ignore_aliases(self, data: Any) -> bool:
        """Write no aliases."""
        return True


def to_yaml(data: Any) -> str:
    """Data as YAML, with the innermost lists and mappings on one line."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, default_flow_style=None, width=110)
