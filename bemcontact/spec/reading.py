"""Problems from YAML files; each error message gives file, line, column and key path."""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from bemcontact.checks.arguments import shown, text_of_argument, texts
from bemcontact.checks.described_schema import DescribedSchema
from bemcontact.errors import Issue, KeyPath, ProblemError, SpecError, escaped
from bemcontact.files.text import place_after, text_of
from bemcontact.problems import Problem, Variant
from bemcontact.problems.key_path import RawValue, existing_path, parsed_path
from bemcontact.problems.problem import OF_ONE_BODY
from bemcontact.problems.readable import readable_part
from bemcontact.problems.wording import described, number_hint, unknown_word
from bemcontact.spec.document import Document, LocatedMessage, Mark, Place, error_text
from bemcontact.spec.outline_file import has_outline, with_outlines
from bemcontact.spec.yaml_1_2 import (
    LONGEST_KEY,
    MOST_CHARACTERS,
    MOST_KEYS,
    READERS,
    TAG,
    Budget,
    Loader,
    Refused,
    to_yaml,
)

Changes = Sequence[str] | Mapping[str, object]
"""Changes as texts ``key=value``, or values by key."""
_REQUIRED = ", ".join(["name", *OF_ONE_BODY])
_HINTS = {
    "found character '\\t'": "YAML indents with spaces; replace the tab",
    "mapping values are not allowed": "write key: value with a blank after the colon, and several in one line in "
    "braces, {a: 1, b: 2}; put a text that contains a colon in quotes, or check the indentation",
    "could not find expected ':'": "a key needs a colon and a space after it",
    "expected <block end>": "check the indentation of this line and the lines above; nothing may follow "
    "a closing bracket, not even a unit",
    "found undefined alias": "an alias *name needs an anchor &name before it",
    "found another document": "put one problem into one file",
    "found unexpected end of stream": "a quote or bracket is not closed",
    "expected ',' or": "a bracket is not closed, or a comma is missing",
}
"""Usual cause of each error of the parser."""


def load(path: str | os.PathLike[str], set: Changes = (), variant: str | None = None) -> Problem:
    """Read a problem from a YAML file.

    Parameters
    ----------
    path : the file, in UTF-8 (or UTF-16 with a byte order mark)
    set : changes such as ``material.young_modulus=2e6``, or a mapping of keys to values, made before the problem is
        checked
    variant : name of a variant in the file, to which the changes are made; the problem itself if None

    Returns
    -------
    Problem

    Raises
    ------
    SpecError
        If there is no such file or variant, or it contains mistakes: a line ``file:line:column: key.path: message``
        for each mistake.
    """
    if not isinstance(path, str | os.PathLike) or not isinstance(os.fspath(path), str):
        hint = "bemcontact.loads reads a text, and bemcontact.problem takes a mapping"
        raise SpecError(f"load needs the path of a file; found {shown(path)}; {hint}")
    if "\n" in os.fspath(path) and not os.path.exists(path):
        raise SpecError(
            f"load needs the path of a file; found a text of several lines, {shown(path)}; bemcontact.loads reads the "
            "text of a problem"
        )
    return loads(text_of(path), os.fspath(path), set, variant)


def loads(text: str, name: str = "<string>", set: Changes = (), variant: str | None = None) -> Problem:
    """Read a problem from a YAML text, see `load`.

    Parameters
    ----------
    text : YAML
    name : name of the text in error messages
    set, variant : see `load`

    Returns
    -------
    Problem

    Raises
    ------
    SpecError
        If the text contains mistakes: a line ``name:line:column: key.path: message`` for each mistake.
    """
    return _problem(_stages(text, name, set, variant))


def as_run(text: str, name: str, overrides: Changes = (), variant: str | None = None) -> str:
    """Text of a spec after its changes, from which `loads` reads the same problem as from this text with the changes.

    Without changes it is the text itself, else YAML without comments; edges of drawings are written out. `SpecError` if
    a change cannot be made.
    """
    document = _stages(text, name, overrides, variant)[-1]
    if has_outline(document.data):  # whose file is not beside the new one
        return to_yaml(with_outlines(document.data, document.folder))
    return to_yaml(document.data) if overrides or variant is not None else text


def located(
    error: ProblemError, text: str, name: str, overrides: Changes = (), variant: str | None = None
) -> SpecError:
    """Error with the place in the text of each issue of a problem that had been read with these arguments.

    Each line is ``file:line:column: key.path: message``, or ``file: message`` if the issue has no key path.
    """
    document = _stages(text, name, overrides, variant)[-1]
    whole = [(Mark(0, 0, name), issue.message) for issue in error.issues if not issue.path]
    return SpecError(error_text([*whole, *(document.located(item) for item in error.issues if item.path)]))


def readable(text: str, name: str, overrides: Changes = (), variant: str | None = None) -> Problem | None:
    """What can be read of a spec that may have mistakes, unchecked, for a picture; None without a sound boundary."""
    try:
        document = _stages(text, name, overrides, variant)[-1]
        return readable_part(with_outlines(document.data, document.folder))
    except (SpecError, ProblemError):
        return None


def written_value(text: str, name: str) -> Any:
    """Read one value in YAML, as an override has it behind its equals sign; `SpecError` if it is none."""
    document = _parsed(text, name)
    if document.messages:
        raise SpecError(error_text(document.messages))
    return document.data


def schema() -> dict[str, Any]:
    """Describe a problem file, for completion and checks in editors.

    Returns
    -------
    dict
        JSON Schema (draft 2020-12), of texts, numbers, lists and mappings.
    """
    properties = Problem.model_json_schema(schema_generator=DescribedSchema)
    for definition in (properties, *properties["$defs"].values()):
        if "description" in definition:
            definition["description"] = definition["description"].partition("\n\n")[0]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **properties}


def _stages(text: str, name: str, overrides: Changes, variant: str | None) -> list[Document]:
    """Documents of a text: without changes, then after each change."""
    name = escaped(name if isinstance(name, str) else shown(name))
    try:
        text_of_argument(text, "what loads reads")
        if isinstance(overrides, Mapping):
            overrides = [f"{key}={json.dumps(value, default=_plain)}" for key, value in overrides.items()]
        overrides = texts(overrides, "set, such as ['material.young_modulus=2e6'],")
        text_of_argument("" if variant is None else variant, "the name of a variant")
    except ProblemError as error:
        raise SpecError(f"{name}: {error}") from None
    stages = [replace(_parsed(text, name), folder=Path(name).parent)]
    _check_mapping(stages[0], name)
    if variant is not None:
        stages += _varied(stages[0], variant)
    for override in overrides:
        stages.append(_overridden(stages[-1], override))
    return stages


def _plain(value: object) -> object:
    """A number or an array of NumPy as Python's own."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise ProblemError(f"an override cannot have the value {shown(value)}; give a number, a text, a list or a mapping")


def _parsed(text: str, name: str) -> Document:
    """Parse YAML; `SpecError` if the text is not YAML, or too large."""
    if len(text) > MOST_CHARACTERS:
        raise SpecError(f"{name}:1:1: the text has {len(text)} characters; a problem has at most {MOST_CHARACTERS}")
    try:
        loader = Loader(text)
    except yaml.reader.ReaderError as error:
        place = place_after(text[: error.position], name)
        raise SpecError(f"{place}: the character {chr(error.character)!r} is not allowed in YAML") from None
    try:
        node = loader.get_single_node()
    except Refused as error:
        raise _refused(error, name) from None
    except yaml.MarkedYAMLError as error:
        if key := _long_key(error, loader, text):
            raise SpecError(
                f"{_marked(key, name).text}: a key has at most {LONGEST_KEY} characters; shorten it"
            ) from None
        raise SpecError(_not_yaml(error, name)) from None
    except (ValueError, OverflowError) as error:
        mark = _marked(loader.get_mark(), name)
        raise SpecError(f"{mark.text}: not YAML: an escape sequence is no character ({error})") from None
    if node is None:
        return Document(data=None, places={})
    tree = _Tree(name)
    try:
        data = tree.value(node, (), None)
    except Refused as error:
        raise _refused(error, name) from None
    return Document(data=data, places=tree.places, messages=tuple(tree.messages), unread=tuple(tree.unread))


def _long_key(error: yaml.MarkedYAMLError, loader: Loader, text: str) -> yaml.Mark | None:
    """Where a key begins of which the colon, at the place of the error, comes too late; None for another error."""
    key, colon = loader.long_key, error.problem_mark
    if not (key and colon and key.line == colon.line and text[key.index] not in "[{&*!"):
        return None
    return key if text[colon.index : colon.index + 1] == ":" or "expected ':'" in str(error.problem) else None


def _marked(mark: yaml.Mark, name: str) -> Mark:
    """Place of a mark, with lines and columns from 1."""
    return Mark(mark.line + 1, mark.column + 1, f"{name}:{mark.line + 1}:{mark.column + 1}")


def _refused(error: Refused, name: str) -> SpecError:
    """Error of YAML that is not read, with its place."""
    assert error.problem_mark is not None  # as the class has it
    return SpecError(f"{_marked(error.problem_mark, name).text}: {error.problem}")


def _not_yaml(error: yaml.MarkedYAMLError, name: str) -> str:
    """Error message of the parser with its usual cause."""
    mark = error.problem_mark or error.context_mark
    where = _marked(mark, name).text if mark else f"{name}:1:1"
    what = error.problem or error.context or "cannot be read"
    if error.context and error.context_mark:
        what += f", {error.context} that starts in line {error.context_mark.line + 1}"
    hint = next((hint for words, hint in _HINTS.items() if words in str(error.problem)), "")
    return f"{where}: not YAML: {what}{'; ' * bool(hint)}{hint}"


def _no_key(node: yaml.Node, before: yaml.Node | None) -> str:
    """Message for a key that is not a text; in braces it may be the part of a number after a comma."""
    if isinstance(node, yaml.SequenceNode):
        return "a key must be a text, found a list; write one entry for each name"
    if not isinstance(node, yaml.ScalarNode):
        return "a key must be a text, found a mapping; write a text that begins with a brace in quotes"
    if isinstance(before, yaml.ScalarNode) and before.tag != f"{TAG}str" and node.tag != f"{TAG}str":
        if before.end_mark.index + 1 != node.start_mark.index:
            return f"a list stands in brackets; write [{before.value}, {node.value}]"
        number = f"{before.value},{node.value}"
        if hint := number_hint(number):
            return f"expected a number, found {number}{hint}"
    return f"a key must be a text, found '{node.value}'; write it in quotes"


class _Tree:
    """Conversion of YAML nodes into data; collects places and error messages."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.places: dict[KeyPath, Place] = {}
        self.messages: list[LocatedMessage] = []
        self.unread: list[KeyPath] = []
        self._above: list[yaml.Node] = []
        self._budget = Budget()

    def value(self, node: yaml.Node, path: KeyPath, key: yaml.Node | None) -> Any:
        """Data of a node."""
        mark = self._mark(node)
        key_mark = self._mark(key) if key else mark
        scalar = isinstance(node, yaml.ScalarNode)
        inline = scalar or (isinstance(node, yaml.CollectionNode) and node.flow_style)
        self.places[path] = Place(value=mark if inline else key_mark, key=key_mark, scalar=scalar)
        with self._inside(node, path) as new:
            if new:
                return self._content(node, path)
            self.unread.append(path)
            return None

    def _content(self, node: yaml.Node, path: KeyPath) -> Any:
        """Data of the content of a node."""
        match node:
            case yaml.MappingNode(tag=tag) if tag == f"{TAG}map":
                return self._mapping(node, path)
            case yaml.SequenceNode(tag=tag) if tag == f"{TAG}seq":
                return [self.value(entry, (*path, i), None) for i, entry in enumerate(node.value)]
            case yaml.ScalarNode(tag=tag) if tag in READERS:
                try:
                    return READERS[tag](node.value)
                except (ValueError, KeyError):
                    return self._not_read(node, path, f"{described(node.value)} does not fit its tag; remove the tag")
        return self._not_read(node, path, f"the tag {node.tag.replace(TAG, '!!')} is not supported; remove it")

    def _mapping(self, node: yaml.MappingNode, path: KeyPath) -> dict[str, Any]:
        """Data of a mapping; repeated keys are an error, merged keys come last."""
        data: dict[str, Any] = {}
        self._add_entries(node, data, path)
        return data

    def _add_entries(self, node: yaml.MappingNode, data: dict[str, Any], path: KeyPath) -> None:
        """Add the entries of a mapping that the data do not have, then those of the mappings merged by ``<<``."""
        lines: dict[str, int] = {}
        merged: list[yaml.Node] = []
        for (_, before), (key, value) in zip([(None, None), *node.value], node.value, strict=False):
            mark = self._mark(key)
            self._budget.spend(len(self._above), key.start_mark)
            if len(data) >= MOST_KEYS:
                raise Refused(f"the mapping has more than {MOST_KEYS} keys; leave some out", key.start_mark)
            if key.tag == f"{TAG}merge":
                merged += value.value if isinstance(value, yaml.SequenceNode) else [value]
            elif key.tag != f"{TAG}str":
                self._find(mark, path, _no_key(key, before))
            elif key.value in lines:
                message = f"the key occurs twice, first in line {lines[key.value]}; keep one"
                self._find(mark, (*path, key.value), message)
            else:
                lines[key.value] = mark.line
                if key.value not in data:
                    data[key.value] = self.value(value, (*path, key.value), key)
        for other in merged:
            self._merge(other, data, path)

    def _merge(self, node: yaml.Node, data: dict[str, Any], path: KeyPath) -> None:
        """Add the entries of a merged mapping that the data do not have."""
        if not isinstance(node, yaml.MappingNode):
            self._find(self._mark(node), path, "<< needs an alias of a mapping, or a list of such aliases")
            return
        with self._inside(node, path) as new:
            if new:
                self._add_entries(node, data, path)

    @contextmanager
    def _inside(self, node: yaml.Node, path: KeyPath) -> Iterator[bool]:
        """Go into a node; False if it is inside itself, which is an error."""
        new = not any(node is above for above in self._above)
        if not new:
            message = "the alias is inside its own anchor; write the value instead of the alias"
            self._find(self._mark(node), path, message)
        self._above.append(node)
        try:
            self._budget.spend(len(self._above), node.start_mark)
            yield new
        finally:
            self._above.pop()

    def _mark(self, node: yaml.Node) -> Mark:
        return _marked(node.start_mark, self.name)

    def _not_read(self, node: yaml.Node, path: KeyPath, message: str) -> None:
        """Note that a value is not read; what else is wrong with it then is not worth a line."""
        self.unread.append(path)
        self._find(self._mark(node), path, message)

    def _find(self, mark: Mark, path: KeyPath, message: str) -> None:
        self.messages.append((mark, str(Issue(path=path, message=message))))


def _overridden(document: Document, override: str) -> Document:
    """Document after an override ``key.path=value``."""
    start = f"override {escaped(override)}"
    keys, equals, text = override.partition("=")
    if not equals:
        raise SpecError(f"{start}: there is no '='; write key.path=value")
    try:
        path = existing_path(document.data, parsed_path(keys.strip()))
    except ProblemError as error:
        raise SpecError("\n".join(f"{start}: {issue}" for issue in error.issues)) from None
    try:
        entry = _parsed(text, start)
    except SpecError as error:
        raise SpecError(f"{start}: {str(error).removeprefix(start).partition(': ')[2]}") from None
    return document.changed(path, entry, Mark(-1, 0, start))  # before all lines


def _varied(document: Document, name: str) -> Iterator[Document]:
    """Documents after each value of a variant, see `Problem.variant`; none if the variant itself is wrong.

    `SpecError` if there is no such variant, or if one of its keys leads nowhere.
    """
    variants = {item.name: item for item in RawValue((), document.data).below(Problem, "variants").named()}
    if name not in variants:
        raise SpecError(f"variant {name or repr(name)}: {unknown_word('variant', name, variants)}")
    variant = variants[name].read(Variant)
    if variant is None:
        return
    path = variants[name].path
    data = {key: value for key, value in document.data.items() if key != "variants"}
    if isinstance(title := data.get("name"), str):
        data["name"] = f"{title}, {name}"
    try:
        paths = variant.paths(data)
    except ProblemError as error:
        messages = [document.located(replace(item, path=(*path, *item.path))) for item in error.issues]
        raise SpecError(error_text(messages)) from None
    stage = replace(document, data=data)
    for key, target in paths.items():
        here = (*path, "set", key)
        stage = stage.changed(target, document.below(here), document.places[here].value)
        yield stage


def _problem(stages: Sequence[Document]) -> Problem:
    """Problem of the last document; `SpecError` with all issues in the order of the text."""
    document = stages[-1]
    try:
        problem = Problem(**with_outlines(document.data, document.folder))
    except ProblemError:
        raise SpecError(error_text([*document.messages, *_located_issues(stages)])) from None
    if document.messages:
        raise SpecError(error_text(document.messages))
    return problem


def _located_issues(stages: Sequence[Document]) -> Iterator[LocatedMessage]:
    """Issues of the last document with their places; the place of a new issue is the override that caused it."""
    blamed: dict[Issue, Mark | None] = {}
    for document in stages:
        blamed = {issue: blamed.get(issue, document.change) for issue in _issues(document)}
    for issue, override in blamed.items():
        if not any(issue.path[: len(path)] == path for path in stages[-1].unread):
            place, message = stages[-1].located(issue)
            yield override or place, message


def _issues(document: Document) -> tuple[Issue, ...]:
    """Issues of the problem in a document."""
    try:
        Problem(**with_outlines(document.data, document.folder))
    except ProblemError as error:
        return error.issues
    return ()


def _check_mapping(document: Document, name: str) -> None:
    """Refuse a document that is empty or not a mapping."""
    if isinstance(document.data, dict):
        return
    needs = f"a spec is a mapping with at least {_REQUIRED}"
    if document.messages:
        raise SpecError(error_text(document.messages))
    if document.data is None:
        raise SpecError(f"{name}:1:1: the file is empty; {needs}")
    a_path = isinstance(document.data, str) and document.data.endswith((".yaml", ".yml"))
    hint = "; bemcontact.load reads a file" * a_path
    raise SpecError(f"{document.places[()].value.text}: {needs}; found {described(document.data)}{hint}")
