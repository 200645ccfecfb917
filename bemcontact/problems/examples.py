"""Examples of values of a type, as YAML has them, for errors about values of another kind."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from bemcontact.errors import KeyPath
from bemcontact.problems.wording import described, shortened


def example_of(kind: Any) -> str:
    """Write a value of a type as YAML."""
    origin, parts = types_in(kind)
    if own := [item.example for item in (*getattr(kind, "__metadata__", ()), origin) if hasattr(item, "example")]:
        return own[0]
    if origin is dict:
        return f"{{NAME: {example_of(parts[1])}}}"
    if origin is tuple and parts[-1] is not ...:
        return f"[{', '.join(map(example_of, parts))}]"
    if origin is tuple:
        entry = example_of(parts[0])
        return f"[{entry}, {entry if entry == 'NAME' else '…'}]"
    if parts:
        return example_of(parts[0])
    return {str: "NAME", float: "0.5", int: "4"}.get(origin, "…")


def types_in(kind: Any) -> tuple[Any, tuple[Any, ...]]:
    """Origin and arguments of a type without its annotations; a type without arguments is its own origin."""
    while get_origin(kind) is Annotated:
        kind = get_args(kind)[0]
    return get_origin(kind) or kind, get_args(kind)


def annotation_of(field: FieldInfo) -> Any:
    """Type of a field with its annotations."""
    return Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation


def annotation_at(cls: type[BaseModel], path: KeyPath) -> Any:
    """Type of the value at a path of a class."""
    if not path or path[0] not in cls.model_fields:
        return None
    kind = annotation_of(cls.model_fields[str(path[0])])
    for _ in path[1:]:
        origin, parts = types_in(kind)
        if origin not in (tuple, dict):
            break
        kind = parts[-1] if origin is dict else parts[0]
    return kind


def homes(root: type[BaseModel], key: str) -> list[str]:
    """Key paths of the mappings that may have a key, from the top of the problem, each by its shortest path."""
    found, waiting, seen = list[str](), [(root, "")], {root}
    for cls, path in waiting:
        if key in cls.model_fields and path not in found:
            found.append(path)
        for name, field in cls.model_fields.items():
            for part, below in _models_in(annotation_of(field), f"{path}.{name}" if path else name):
                if part not in seen:
                    seen.add(part)
                    waiting.append((part, below))
    return found


def _models_in(kind: Any, path: str) -> Iterator[tuple[type[BaseModel], str]]:
    """Mappings that a value of a type may be or contain, with their key paths."""
    origin, parts = types_in(kind)
    if isinstance(origin, type) and issubclass(origin, BaseModel):
        yield origin, path
    elif origin is dict:
        yield from _models_in(parts[1], f"{path}.NAME")
    elif origin is not Literal:
        for part in parts:
            yield from _models_in(part, f"{path}[N]" if origin is tuple else path)


def likely_mapping(cls: type[BaseModel], value: Any) -> str:
    """Write what is probably meant by a value that should be a mapping: components from a list, or the example."""
    keys = [*cls.model_fields]
    components = isinstance(value, list | tuple) and keys[:2] == ["x", "y"] and 0 < len(value) <= len(keys)
    if components and all(isinstance(item, int | float) and not isinstance(item, bool) for item in value):
        return f"{{{', '.join(f'{key}: {item}' for key, item in zip(keys, value, strict=False))}}}"
    return getattr(cls, "example", "{…}")


def text_hint(value: Any) -> str:
    """Say how to write a text that is no text."""
    if isinstance(value, list | tuple) and len(value) == 1 and isinstance(value[0], str):
        return f"; write {shortened(value[0])} without brackets"
    return f"; write '{described(value)}' in quotes" if isinstance(value, int | float) else ""


def list_hint(value: Any) -> str:
    """Say how to write a list of names that stands in braces."""
    if isinstance(value, Mapping) and value and all(item is None for item in value.values()):
        names = ", ".join(map(str, value))
        return f"; write [{shortened(names)}]"
    return ""
