"""From a YAML file to a `Problem`; every complaint names file, line, column and the path of keys."""

import os
from collections.abc import Iterator, Sequence
from typing import Any

import yaml

from bemcontact.errors import Complaint, Path, ProblemError, SpecError
from bemcontact.files.text import place_after, text_of
from bemcontact.problem import Problem
from bemcontact.problem.key_path import existing_path, parsed_path
from bemcontact.problem.validation import described, number_hint
from bemcontact.spec.document import Document, Finding, Mark, Place, one_line_each
from bemcontact.spec.variants import varied
from bemcontact.spec.yaml_1_2 import READERS, TAG, Loader, written

_REQUIRED = ", ".join(key for key, item in Problem.model_fields.items() if item.is_required())
_HINTS = {
    "found character '\\t'": "YAML indents with spaces; replace the tab",
    "mapping values are not allowed": "a colon inside a text needs quotes around the text; else check the indentation",
    "could not find expected ':'": "a key needs a colon and a space after it",
    "expected <block end>": "check the indentation of this line and the lines above",
    "found undefined alias": "an alias *name needs an anchor &name before it",
    "found another document": "put one problem into one file",
    "found unexpected end of stream": "a quote or bracket is not closed",
    "expected ',' or": "a bracket is not closed, or a comma is missing",
}
"""What usually is wrong where the parser says so."""


def load(path: str | os.PathLike[str], overrides: Sequence[str] = (), variant: str | None = None) -> Problem:
    """Read a problem from a YAML file.

    Parameters
    ----------
    path : the file, in UTF-8 (or UTF-16 with a byte order mark)
    overrides : changes such as ``material.young_modulus=2e6``, made before anything is checked
    variant : name of a variant that the file states, to which the changes are made; the problem itself if None

    Returns
    -------
    Problem

    Raises
    ------
    SpecError
        If there is no such file or variant, or it states no problem: a line ``file:line:column: key.path: message``
        for each complaint.
    """
    return loads(text_of(path), os.fspath(path), overrides, variant)


def loads(text: str, name: str = "<string>", overrides: Sequence[str] = (), variant: str | None = None) -> Problem:
    """Read a problem from a text, as `load` does from a file.

    Parameters
    ----------
    text : YAML
    name : what to call the text in complaints
    overrides, variant : as of `load`

    Returns
    -------
    Problem

    Raises
    ------
    SpecError
        A line ``name:line:column: key.path: message`` for each complaint.
    """
    return _stated(_stages(text, name, overrides, variant))


def as_run(path: str | os.PathLike[str], overrides: Sequence[str] = (), variant: str | None = None) -> str:
    """Give the text of a spec with the changes made: the file as it is if there are none, else YAML without comments.

    Parameters
    ----------
    path, overrides, variant : what a problem is read from, by `load`

    Returns
    -------
    str
        `loads` makes the same problem of it.

    Raises
    ------
    SpecError
        There is no such file, or a change cannot be made.
    """
    text = text_of(path)
    if not overrides and variant is None:
        return text
    return written(_stages(text, os.fspath(path), overrides, variant)[-1].data)


def located(
    error: ProblemError, path: str | os.PathLike[str], overrides: Sequence[str] = (), variant: str | None = None
) -> SpecError:
    """Tell where in its file a problem is wrong of which that was found out only after it had been read.

    Parameters
    ----------
    error : what was found
    path, overrides, variant : what the problem was read from, by `load`

    Returns
    -------
    SpecError
        A line ``file:line:column: key.path: message`` for each complaint; ``file: message`` for one about the problem
        as a whole.
    """
    name = os.fspath(path)
    document = _stages(text_of(path), name, overrides, variant)[-1]
    whole = [(Mark(0, 0, name), complaint.message) for complaint in error.complaints if not complaint.path]
    return SpecError(one_line_each([*whole, *(document.located(item) for item in error.complaints if item.path)]))


def schema() -> dict[str, Any]:
    """Make the JSON Schema (draft 2020-12) of a spec, which editors use to complete and check."""
    stated = Problem.model_json_schema()
    for definition in (stated, *stated["$defs"].values()):
        definition["description"] = definition["description"].partition("\n\n")[0]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **stated}


def _stages(text: str, name: str, overrides: Sequence[str], variant: str | None) -> list[Document]:
    """Read a text, and make the changes one after the other; the first is the text alone."""
    stages = [_parsed(text, name)]
    _check_mapping(stages[0], name)
    if variant is not None:
        stages += varied(stages[0], variant)
    for override in overrides:
        stages.append(_overridden(stages[-1], override))
    return stages


def _parsed(text: str, name: str) -> Document:
    """Read YAML into plain data with places; `SpecError` if it is not YAML."""
    try:
        loader = Loader(text)
    except yaml.reader.ReaderError as error:
        place = place_after(text[: error.position], name)
        raise SpecError(f"{place}: the character {chr(error.character)!r} is not allowed in YAML") from None
    try:
        node = loader.get_single_node()
    except yaml.MarkedYAMLError as error:
        raise SpecError(_not_yaml(error, name)) from None
    except RecursionError:
        raise SpecError(f"{name}:1:1: nested too deeply to be read") from None
    except (ValueError, OverflowError) as error:
        mark = _marked(loader.get_mark(), name)
        raise SpecError(f"{mark.text}: not YAML: an escape that means no character ({error})") from None
    if node is None:
        return Document(data=None, places={})
    tree = _Tree(name)
    data = tree.value(node, (), None)
    return Document(data=data, places=tree.places, findings=tuple(tree.findings))


def _marked(mark: yaml.Mark, name: str) -> Mark:
    """Count lines and columns from 1, as editors do."""
    return Mark(mark.line + 1, mark.column + 1, f"{name}:{mark.line + 1}:{mark.column + 1}")


def _not_yaml(error: yaml.MarkedYAMLError, name: str) -> str:
    """Put an error of the parser into a line, with what usually is the cause."""
    mark = error.problem_mark or error.context_mark
    where = _marked(mark, name).text if mark else f"{name}:1:1"
    what = error.problem or error.context or "cannot be read"
    if error.context and error.context_mark:
        what += f", {error.context} from line {error.context_mark.line + 1} on"
    hint = next((hint for words, hint in _HINTS.items() if words in str(error.problem)), "")
    return f"{where}: not YAML: {what}{'; ' * bool(hint)}{hint}"


def _no_key(node: yaml.Node, before: yaml.Node | None) -> str:
    """Refuse a key that is no text; in braces it may be what follows the comma in a number."""
    if not isinstance(node, yaml.ScalarNode):
        return "a key must be a text, found a list or a mapping; write it in quotes"
    if isinstance(before, yaml.ScalarNode) and before.end_mark.index + 1 == node.start_mark.index:
        number = f"{before.value},{node.value}"
        if hint := number_hint(number):
            return f"expected a number, found {number}{hint}"
    return f"a key must be a text, found '{node.value}'; write it in quotes"


class _Tree:
    """Walks through the nodes of a document and gathers places and findings."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.places: dict[Path, Place] = {}
        self.findings: list[Finding] = []
        self._above: list[yaml.Node] = []

    def value(self, node: yaml.Node, path: Path, key: yaml.Node | None) -> Any:
        """Make plain data of a node and all below it."""
        mark = self._mark(node)
        key_mark = self._mark(key) if key else mark
        scalar = isinstance(node, yaml.ScalarNode)
        inline = scalar or (isinstance(node, yaml.CollectionNode) and node.flow_style)
        self.places[path] = Place(value=mark if inline else key_mark, key=key_mark, scalar=scalar)
        if any(node is above for above in self._above):
            self._find(mark, path, "an alias inside its own anchor has no end; write the value out")
            return None
        self._above.append(node)
        try:
            return self._content(node, path)
        finally:
            self._above.pop()

    def _content(self, node: yaml.Node, path: Path) -> Any:
        """Make plain data of what a node contains."""
        match node:
            case yaml.MappingNode(tag=tag) if tag == f"{TAG}map":
                return self._mapping(node, path)
            case yaml.SequenceNode(tag=tag) if tag == f"{TAG}seq":
                return [self.value(entry, (*path, i), None) for i, entry in enumerate(node.value)]
            case yaml.ScalarNode(tag=tag) if tag in READERS:
                try:
                    return READERS[tag](node.value)
                except (ValueError, KeyError):
                    self._find(
                        self._mark(node), path, f"{described(node.value)} is not what its tag says; leave it out"
                    )
                    return None
        message = f"the tag {node.tag.replace(TAG, '!!')} has no meaning here; leave it out"
        self._find(self._mark(node), path, message)
        return None

    def _mapping(self, node: yaml.MappingNode, path: Path) -> dict[str, Any]:
        """Make a dictionary; of equal keys the first counts, and merged ones come last."""
        data: dict[str, Any] = {}
        lines: dict[str, int] = {}
        merged: list[yaml.Node] = []
        for (_, before), (key, value) in zip([(None, None), *node.value], node.value, strict=False):
            mark = self._mark(key)
            if key.tag == f"{TAG}merge":
                merged += value.value if isinstance(value, yaml.SequenceNode) else [value]
            elif key.tag != f"{TAG}str":
                self._find(mark, path, _no_key(key, before))
            elif key.value in data:
                message = f"the key stands twice, first in line {lines[key.value]}; keep one"
                self._find(mark, (*path, key.value), message)
            else:
                data[key.value] = self.value(value, (*path, key.value), key)
                lines[key.value] = mark.line
        return self._with_merged(data, merged, path)

    def _with_merged(self, data: dict[str, Any], merged: list[yaml.Node], path: Path) -> dict[str, Any]:
        """Add the keys that ``<<`` brings along, where they are not given."""
        for node in merged:
            if not isinstance(node, yaml.MappingNode):
                self._find(self._mark(node), path, "<< takes an alias of a mapping, or a list of such")
                continue
            kept = self.places.copy()
            more = self.value(node, path, None)
            self.places |= kept
            data = {**(more or {}), **data}
        return data

    def _mark(self, node: yaml.Node) -> Mark:
        return _marked(node.start_mark, self.name)

    def _find(self, mark: Mark, path: Path, message: str) -> None:
        self.findings.append((mark, str(Complaint(path=path, message=message))))


def _overridden(document: Document, override: str) -> Document:
    """Replace or add one value, as ``key.path=value`` says."""
    start = f"--set {override}"
    keys, equals, text = override.partition("=")
    if not equals:
        raise SpecError(f"{start}: there is no '='; write key.path=value")
    try:
        path = existing_path(document.data, parsed_path(keys.strip()))
    except ProblemError as error:
        raise SpecError("\n".join(f"{start}: {complaint}" for complaint in error.complaints)) from None
    try:
        entry = _parsed(text, start)
    except SpecError as error:
        raise SpecError(f"{start}: {str(error).removeprefix(start).partition(': ')[2]}") from None
    return document.changed(path, entry, Mark(0, 0, f"--case {entry.data}" if path == ("case",) else start))


def _stated(stages: Sequence[Document]) -> Problem:
    """Make the problem of the last stage, or gather all complaints in the order of the text."""
    document = stages[-1]
    try:
        problem = Problem(**document.data)
    except ProblemError:
        raise SpecError(one_line_each([*document.findings, *_found(stages)])) from None
    if document.findings:
        raise SpecError(one_line_each(document.findings))
    return problem


def _found(stages: Sequence[Document]) -> Iterator[Finding]:
    """Place the complaints about the last stage; those that came with an override are complaints about it."""
    blamed: dict[Complaint, Mark | None] = {}
    for document in stages:
        blamed = {complaint: blamed.get(complaint, document.change) for complaint in _complaints(document)}
    for complaint, override in blamed.items():
        place, message = stages[-1].located(complaint)
        yield override or place, message


def _complaints(document: Document) -> tuple[Complaint, ...]:
    """List what is wrong with the problem that a document states."""
    try:
        Problem(**document.data)
    except ProblemError as error:
        return error.complaints
    return ()


def _check_mapping(document: Document, name: str) -> None:
    """Refuse a document that is empty, or no mapping."""
    if isinstance(document.data, dict):
        return
    needs = f"a spec is a mapping with at least {_REQUIRED}"
    if document.findings:
        raise SpecError(one_line_each(document.findings))
    if document.data is None:
        raise SpecError(f"{name}:1:1: there is nothing in it; {needs}")
    raise SpecError(f"{document.places[()].value.text}: {needs}; found {described(document.data)}")
