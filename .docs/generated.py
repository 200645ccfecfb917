"""Parts of the reference that are made from the program at each build, in the place of a line in a page.

A page states the place by ``<!-- generated: WHAT [WORDS] -->``, where WHAT is a key of `PARTS`.
"""

import enum
import inspect
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, get_args

import typer
import typer.main
from docutils import nodes
from pydantic import BaseModel
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.util.typing import stringify_annotation
from typer.testing import CliRunner

import bemcontact
from bemcontact import cli
from bemcontact.problems.validation import INTERNAL, SpecModel

ROOT = Path(__file__).parents[1]
MARK = re.compile(r"^<!-- generated: (\w+)(.*) -->$", flags=re.MULTILINE)
COMMANDS = typer.main.get_command(cli.app)
FOREIGN = "BaseModel, tuple, object"
"""Classes of other packages whose members are not those of ours."""
INNER = "__init__, model_config, model_post_init"
"""Members of classes that no reader needs."""


def commands() -> str:
    """Describe each command, its arguments and its options."""
    return "\n".join([_options("bemcontact", COMMANDS), *map(_command, COMMANDS.commands, COMMANDS.commands.values())])


def _command(name: str, command: Any) -> str:
    """Describe one command: its help, with the examples as a block, and its options."""
    text, _, examples = command.help.partition("\n\n\b\nExamples\n")
    arguments = [_usage(parameter) for parameter in command.params if parameter.param_type_name == "argument"]
    usage = " ".join(["bemcontact", name, *arguments, "[OPTIONS]"])
    shown = f"```text\n{inspect.cleandoc(examples)}\n```\n" if examples else ""
    return f"(command-{name})=\n## {name}\n\n```text\n{usage}\n```\n\n{text}\n\n{shown}\n{_options(name, command)}"


def _usage(parameter: Any) -> str:
    """Say how an argument or option is written; an argument by its name alone."""
    written = parameter.get_help_record(typer.Context(COMMANDS))[0]
    return written.split()[0] if parameter.param_type_name == "argument" else written


def _options(name: str, command: Any) -> str:
    """List the arguments and options of a command, each with an anchor such as ``solve-penalty``."""
    entries = []
    for parameter in command.params:
        about = " ".join(parameter.get_help_record(typer.Context(command))[1].split())
        entries.append(f"[`{_usage(parameter)}`]{{#{name}-{parameter.opts[0].strip('-')}}}\n: {_escaped(about)}\n")
    return "\n".join(entries)


def spec() -> str:
    """Describe each key of a spec, from its JSON Schema: the body and surfaces first, references last."""
    described = "\n".join(_described(_schema(), "yaml", level=2))
    sections = re.findall(r"\((yaml-[\w-]+)\)=\n+#+ (.*)", described)
    return "\n".join((", ".join(f"[{title}](#{key})" for key, title in sections) + ".", "", described))


def json_files() -> str:
    """Describe each key of each JSON file that has a schema, of which the command ``schema`` has one option each."""
    parts = []
    for parameter in COMMANDS.commands["schema"].params:
        option = parameter.opts[0]
        about = parameter.get_help_record(typer.Context(COMMANDS))[1]
        key = f"json-{option.strip('-')}"
        parts.append(f"({key})=\n## `schema {option}`\n\n{about}\n")
        parts.extend(_described(_schema(option), key, level=3))
    return "\n".join(parts)


def _schema(*options: str) -> dict[str, Any]:
    """Take a JSON Schema from the command line, as a user would."""
    return json.loads(CliRunner().invoke(cli.app, ["schema", *options], catch_exceptions=False).stdout)


def _described(schema: dict[str, Any], prefix: str, level: int) -> Iterator[str]:
    """Describe the objects of a schema: the file itself, then in the order in which one meets them."""
    places: dict[str, list[str]] = {}
    queue = [("", schema, ())]
    while queue:
        path, node, above = queue.pop(0)
        for name, place in _references(node, path):
            if name in above:
                continue  # an object within one of its own kind
            definition = schema["$defs"][name]
            if "properties" in definition:
                places.setdefault(name, []).append(place)
                if len(places[name]) == 1:
                    queue.append((place, definition, (*above, name)))
    yield _object("The file", schema, schema, f"{prefix}-file", [], prefix, level)
    for name, where in sorted(places.items(), key=lambda place: place[1][0].startswith("reference")):
        definition = schema["$defs"][name]
        kind = definition["properties"].get("kind", {}).get("const")
        title = _title(name) + (f", `kind: {kind}`" if kind else "")
        yield _object(title, definition, schema, f"{prefix}-{name.lower()}", where, prefix, level)


def _references(node: Any, path: str) -> Iterator[tuple[str, str]]:
    """Find the objects that a node refers to, each with its path of keys."""
    if isinstance(node, list):
        for item in node:
            yield from _references(item, path)
    elif isinstance(node, dict):
        if "$ref" in node:
            yield node["$ref"].rpartition("/")[2], path
        for key, value in node.get("properties", {}).items():
            yield from _references(value, f"{path}.{key}".strip("."))
        yield from _references(node.get("additionalProperties"), f"{path}.NAME".strip("."))
        yield from _references(node.get("items"), f"{path}[]")
        for word in ("anyOf", "oneOf", "allOf", "then", "prefixItems"):
            yield from _references(node.get(word), path)


def _object(
    title: str, node: dict[str, Any], schema: dict[str, Any], key: str, where: list[str], prefix: str, level: int
) -> str:
    """Describe one object: what it is, where it stands, and its keys."""
    lines = [f"({key})=", f"{'#' * level} {title}", "", _escaped(node.get("description", "")), ""]
    if where:
        lines += ["Stands at " + ", ".join(f"`{place}`" for place in dict.fromkeys(where)) + ".", ""]
    for name, value in node["properties"].items():
        about = [_value(value, schema, prefix)]
        if "default" in value and value["default"] not in (None, "", [], {}) and not isinstance(value["default"], dict):
            about.append(f"default `{_plain(value['default'])}`")
        elif name in node.get("required", ()) and prefix == "yaml":
            about.append("required")
        text = _escaped(value.get("description", ""))
        lines += [f"[`{name}`]{{#{key}-{name}}}", f": *{'; '.join(about)}.* {text}", ""]
    return "\n".join(lines)


def _value(node: Any, schema: dict[str, Any], prefix: str) -> str:
    """Say in words which values a node of a schema admits."""
    if "$ref" in node:
        name = node["$ref"].rpartition("/")[2]
        definition = schema["$defs"][name]
        if "properties" not in definition:
            return _value(definition, schema, prefix)
        return f"[{_title(name)}](#{prefix}-{name.lower()})"
    if "const" in node:
        return f"`{_plain(node['const'])}`"
    if "enum" in node:
        return _either([f"`{_plain(value)}`" for value in node["enum"]])
    for word in ("anyOf", "oneOf", "allOf"):
        if word in node:
            options = [option.get("then", option) for option in node[word]]
            if prefix == "yaml":
                options = [option for option in options if option != {"type": "null"}]  # that is, left out
            texts = [_value(option, schema, prefix) for option in options]
            return _either(list(dict.fromkeys(texts)))
    return _simple(node, schema, prefix)


def _simple(node: dict[str, Any], schema: dict[str, Any], prefix: str) -> str:
    """Say in words which values a node with a type, or several types, admits."""
    types = node.get("type", "anything")
    if isinstance(types, list):
        return _either([_simple({**node, "type": one}, schema, prefix) for one in types])
    if types == "array":
        if "prefixItems" in node:
            return "[" + ", ".join(_value(item, schema, prefix) for item in node["prefixItems"]) + "]"
        count = f" {node['minItems']}" if node.get("minItems") == node.get("maxItems", -1) else ""
        items = _value(node.get("items", {}), schema, prefix)
        return f"list of{count} " + re.sub(r"^(number|integer|text|list)\b", r"\1s", items)
    if types == "object":
        values = node.get("additionalProperties")
        return "mapping of names" + (f" to {_value(values, schema, prefix)}" if isinstance(values, dict) else "")
    if types in ("number", "integer"):
        return types + _bounds(node)
    return {"string": "text", "boolean": "true or false"}.get(types, types)


def _bounds(node: dict[str, Any]) -> str:
    """Say which numbers are admitted."""
    words = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
    bounds = [f"{sign} {node[word]:g}" for word, sign in words.items() if word in node]
    return " " + " and ".join(bounds) if bounds else ""


def _either(texts: list[str]) -> str:
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} or {texts[-1]}"


def _plain(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _title(name: str) -> str:
    """Turn the name of a class into words: FlatPunch, Flat punch; UnitsRecord, Units."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name.removesuffix("Record")).capitalize()


def _escaped(text: str) -> str:
    """Keep Markdown from reading marks in a text of the program."""
    return re.sub(r"([*<>|\\])", r"\\\1", text)


def public() -> set[str]:
    """Give the public names that are documented."""
    return {name for name in bemcontact.__all__ if not name.startswith("_")}


def names(words: str) -> str:
    """Document public names from their docstrings."""
    return "\n".join(_documented(f"bemcontact.{name}", getattr(bemcontact, name)) for name in words.split())


def parts() -> str:
    """Document the objects that public ones hold or give, and those that these hold in turn, by name."""
    known = [getattr(bemcontact, name) for name in bemcontact.__all__]
    queue = [value for value in known if inspect.isroutine(value) or _is_class(value)]
    held: list[type] = []
    while queue:
        for part in _held(queue.pop(0)):
            if part.__module__.startswith("bemcontact.") and part not in (*known, *held):
                held.append(part)
                queue.append(part)
    held.sort(key=lambda part: part.__name__)
    return "\n".join(_documented(f"{part.__module__}.{part.__name__}", part) for part in held)


def _is_class(value: object) -> bool:
    """Whether this is a class that the reference of keys does not describe."""
    return isinstance(value, type) and not issubclass(value, BaseModel)


def _held(value: type | Callable[..., Any]) -> Iterator[type]:
    """Find the classes in the types of fields and properties of a class, and in what it or a function gives."""
    if not isinstance(value, type):
        yield from filter(_is_class, _classes([inspect.get_annotations(value).get("return")]))
        return
    public = {name: item for name, item in vars(value).items() if not name.startswith("_")}
    getters = [getattr(item, "fget", getattr(item, "func", None)) for item in public.values()]
    hints = [*inspect.get_annotations(value).values()]
    yield from _classes(hints + [inspect.get_annotations(getter).get("return") for getter in getters if getter])
    for method in filter(inspect.isfunction, public.values()):
        yield from _held(method)


def _classes(hints: list[Any]) -> Iterator[type]:
    """Find the classes in types."""
    while hints:
        hint = hints.pop(0)
        hints.extend(get_args(hint))
        if isinstance(hint, type):
            yield hint


def _documented(path: str, value: object) -> str:
    """Document one name."""
    if not isinstance(value, type):
        directive, options = "autofunction", []
    elif issubclass(value, Exception):
        directive, options = "autoexception", []
    elif issubclass(value, enum.Enum):
        directive, options = "autoclass", [":members:", ":undoc-members:"]
    else:
        hidden = ", ".join([INNER, *(INTERNAL + value.inside if issubclass(value, SpecModel) else ())])
        directive, options = "autoclass", [":members:", f":inherited-members: {FOREIGN}", f":exclude-members: {hidden}"]
    return "\n   ".join([f"```{{eval-rst}}\n.. {directive}:: {path}", *options]) + "\n```\n"


def gallery() -> str:
    """Show the page of the models, with its paths as from the folder of the site."""
    text = (ROOT / "models" / "README.md").read_text(encoding="utf-8")
    return re.sub(r"\]\(([^)]*\.yaml)\)", r"](../models/\1)", text).replace('src="../.docs/', 'src="')


PARTS = {"commands": commands, "spec": spec, "json": json_files, "names": names, "parts": parts, "gallery": gallery}


def fill(app: Sphinx, page: str, source: list[str]) -> None:
    """Put the parts into a page as it is read."""
    if page == "reference/python":
        listed = {name for what, words in MARK.findall(source[0]) if what == "names" for name in words.split()}
        if wrong := listed ^ public():
            raise ExtensionError(f"{page}: public names without a place, or places without one: {', '.join(wrong)}")
    source[0] = MARK.sub(lambda found: PARTS[found[1]](*filter(None, [found[2].strip()])), source[0])


def tidy(app: Sphinx, what: str, name: str, value: object, options: object, lines: list[str]) -> None:
    """Give a docstring the form that napoleon reads: a parameter's text under its name, no mark of a substitution."""
    if what in ("attribute", "property"):
        lines[0] = f": {lines[0]}"  # nothing before the first colon, which napoleon takes for the type
    section, tidied = "", []
    for i, line in enumerate(lines):
        if i + 1 < len(lines) and re.fullmatch("-{3,}", lines[i + 1]):
            section = line
        entry = re.fullmatch(r"(\w[\w, ]*) : (.*)", line)
        if section in ("Parameters", "Attributes") and entry:
            below = lines[i + 1] if i + 1 < len(lines) else ""
            stop = "." if re.match(r"    [A-Z0-9\[]", below) else ""
            tidied += [f"{entry[1]}{_annotation(value, entry[1])}", f"    {entry[2]}{stop}"]
        elif section == "Returns" and line in bemcontact.__all__:
            tidied.append(f":class:`~bemcontact.{line}`")
        else:
            tidied.append(line)
    lines[:] = [re.sub(r"(?<![`\\])\|", r"\|", line) for line in tidied]


def _annotation(value: object, field: str) -> str:
    """Say of which type a field of a class is, and its default; docstrings of functions say it themselves."""
    annotation = getattr(value, "__annotations__", {}).get(field) if isinstance(value, type) else None
    if annotation is None:
        return ""
    text = stringify_annotation(annotation, "smart")
    default = getattr(value, field, None)  # where a dataclass keeps it
    is_plain = isinstance(default, bool | int | float | str) and default != ""
    return f" : {'array' if 'ndarray' in text else text}" + (f", default {default}" if is_plain else "")


def dash(app: Sphinx, doctree: nodes.document) -> None:
    """Set a dash between the name of a parameter and its text; smart quotes, which are off, would."""
    for text in [text for text in doctree.findall(nodes.Text) if text.startswith(" -- ")]:
        text.parent.replace(text, nodes.Text(f" – {text[4:]}"))


def setup(app: Sphinx) -> dict[str, bool]:
    """Register what is called when a page is read and when a docstring is."""
    app.connect("source-read", fill)
    app.connect("autodoc-process-docstring", tidy, priority=100)  # before napoleon
    app.connect("doctree-read", dash)
    return {"parallel_read_safe": True}
