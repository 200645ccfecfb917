"""The base class of all parts of a problem, the types of their values, and the translation of their errors."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Never, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    Strict,
    ValidationError,
    model_validator,
)
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from bemcontact.checks.arguments import label_fault, shown
from bemcontact.checks.docstrings import attribute_docstrings, docstring
from bemcontact.errors import LINE_BREAKS, Issue, ProblemError, hidden_character
from bemcontact.frozen import frozen_value
from bemcontact.problems.examples import (
    annotation_at,
    annotation_of,
    example_of,
    homes,
    likely_mapping,
    list_hint,
    text_hint,
    types_in,
)
from bemcontact.problems.wording import MANY_WORDS, described, has_unit, near_by, number_hint, unknown_word

LARGEST_STATED = 1e30
"""Largest number in a problem. Its eighth power is still finite, so that products of any four numbers can be squared.
The arrays that are computed from a problem have larger numbers, and a limit of their own: products of three stated
numbers, such as moments p L², are below `bemcontact.checks.arguments.LARGEST_NUMBER`."""


ALL = "all"
"""The word for all edges that can see a surface; a list with this word names an edge."""
UNNAMED_KIND = "line"
"""The kind of an edge that states none."""
INTERNAL = ("example", "root", "other_words", "elsewhere", "inside", "as_spec")
"""Names of each part of a problem that the package alone uses."""


@frozen_value
class KeyIssue(Issue):
    """An issue with the last key of the path, not with the value under it."""


def invalid(message: str) -> PydanticCustomError:
    """Make the error that a validator raises for the value it checks."""
    return PydanticCustomError("issue", "{message}", {"message": message})


def validation_error(title: str, issues: Iterable[Issue]) -> ValidationError:
    """Make the error that a validator raises for several places inside the value it checks."""
    return ValidationError.from_exception_data(title, [_line_error(issue) for issue in issues])


def issues_of(error: ValidationError) -> list[Issue]:
    """List the issues in an error that `SpecModel` has translated."""
    return [_issue(details) for details in error.errors(include_url=False, include_input=False)]


class Fixed(dict[str, Any]):
    """A mapping of a problem, which does not change: what would be put into it has to be checked with the rest."""

    def _refuse(self, *_: object, **__: object) -> Never:
        """Say what to do instead."""
        raise ProblemError(
            "the mappings of a problem do not change; problem.with_value('conditions.top.pressure', 5) makes a problem "
            "with another value, and bemcontact.problem one of a mapping such as problem.to_dict() with more keys"
        )

    __setitem__ = __delitem__ = __ior__ = update = setdefault = pop = popitem = clear = _refuse  # pyright: ignore

    def __reduce__(self) -> tuple[type[Self], tuple[dict[str, Any]]]:
        """Copies and pickles make it of its items, and put none in."""
        return type(self), (dict(self),)


class SpecModel(BaseModel):
    """Base class of all parts of a problem: frozen, strict about types; `ProblemError` lists every issue at once."""

    # Validators of kinds that a file does not have are never made.
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, defer_build=True)
    example: ClassVar[str]
    """A value as YAML has it, for error messages."""
    root: ClassVar[bool] = False
    """Whether this is the whole problem."""
    other_words: ClassVar[Mapping[str, str]] = {}
    """Words that are not keys -> what to write instead."""
    elsewhere: ClassVar[str] = ""
    """Where that is which users look for here, behind the list of the keys that there are."""
    inside: ClassVar[tuple[str, ...]] = ()
    """Names of this part that the package alone uses."""

    def __init_subclass__(cls, **options: Any) -> None:
        """Let the schema of a class have its docstring under ``python -OO`` too."""
        super().__init_subclass__(**options)
        cls.__doc__ = docstring(cls)

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ProblemError(issues_of(error)) from None

    # Pydantic then validates nested parts itself, so that their issues get the full path.
    __init__.__pydantic_base_init__ = True  # pyright: ignore[reportFunctionMemberAccess]

    @model_validator(mode="wrap")
    @classmethod
    def _translate_errors(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Translate the errors of pydantic for the keys of this class; nested parts have translated their own."""
        try:
            part = handler(data)
        except ValidationError as error:
            issues = [*_translated_errors(cls, error), *_below_misspelled(cls, data, handler)]
            nameless = _nameless(cls, data)
            issues = [issue for issue in issues if issue.path[:1] not in [(key,) for key in nameless]]
            issues += [Issue(path=(key,), message=message) for key, message in nameless.items()]
            raise validation_error(cls.__name__, issues) from None
        for key in cls.model_fields:
            if type(value := part.__dict__.get(key)) is dict:
                object.__setattr__(part, key, Fixed(value))
        return part

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse to change a key, and say what to do instead."""
        if name in type(self).model_fields:
            key = name if self.root else f"….{name}"
            raise ProblemError(
                f"a {type(self).__name__} does not change; problem.with_value('{key}', {shown(value)}) makes a problem "
                "with another value"
            )
        super().__setattr__(name, value)

    def to_dict(self) -> dict[str, Any]:
        """Return the keys of a spec that state the same: lists, mappings, numbers and texts, without defaults."""
        return {
            key: _stated(value)
            for key, field in type(self).model_fields.items()
            for value in [getattr(self, key)]
            if (key == "kind" and value != UNNAMED_KIND) or value != field.get_default(call_default_factory=True)
        }

    def as_spec(self) -> Any:
        """Return what a spec has for it: `to_dict`, if there is no shorter form."""
        return self.to_dict()

    def __eq__(self, other: object) -> bool:
        """Whether all keys have equal values; what was computed from them does not count."""
        return type(self) is type(other) and all(
            getattr(self, key) == getattr(other, key) for key in type(self).model_fields
        )

    def __hash__(self) -> int:
        return hash((type(self), *(getattr(self, key) for key in type(self).model_fields)))

    def __dir__(self) -> list[str]:
        """Names that a user may want: keys and methods, none of pydantic and none that the package alone uses."""
        hidden = {*INTERNAL, *self.inside}
        names = (name for name in super().__dir__() if name not in hidden and not name.startswith("_"))
        return sorted(name for name in names if not hasattr(BaseModel, name))


def _stated(value: Any) -> Any:
    """What a spec has for a value; a list of one name is the name, if it is no word of its own."""
    match value:
        case SpecModel():
            return value.as_spec()
        case Mapping():
            return {key: _stated(part) for key, part in value.items()}
        case (str() as name,) if name != ALL:
            return str(name)
        case tuple() | list():
            return [_stated(part) for part in value]
        case str():
            return str(value)
    return value


def _not_huge(value: float) -> float:
    """Refuse numbers whose powers overflow."""
    if abs(value) > LARGEST_STATED:
        raise invalid(f"{value:.3g} is too large to compute with; choose other units")
    return value


def not_tiny(value: float) -> float:
    """Refuse numbers other than 0 whose powers underflow."""
    if 0 < abs(value) < 1 / LARGEST_STATED:
        raise invalid(f"{value:.3g} is too small to compute with; choose other units, or write 0 if it may be 0")
    return value


def _pair(value: Any) -> Any:
    """Refuse a list that is not a pair, before its entries are checked."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        brackets = "; write it in square brackets" if isinstance(value, str) and value.startswith("(") else ""
        raise invalid(f"expected two numbers such as [0.0, 1.5], found {described(value)}{brackets}")
    return value


def _readable(value: str) -> str:
    """Refuse texts with hidden characters, except ends of lines."""
    if hidden := hidden_character(value, LINE_BREAKS):
        raise invalid(f"a text must not contain the hidden character {hidden}; remove it")
    return value


def _one_line(value: str) -> str:
    """Refuse labels of several lines."""
    if fault := label_fault(value):
        raise invalid(fault)
    return value


def _not_blank(value: str) -> str:
    """Refuse empty names."""
    if not value.strip():
        raise invalid("a name must not be empty")
    return value


def _usable_in_paths(value: str) -> str:
    """Refuse names that a key path cannot contain."""
    if bad := sorted(set(value) & set(".[]=")):
        raise invalid(f"a name must not contain {' '.join(bad)}, which key paths use; found {value!r}")
    return value


Finite = Annotated[float, Strict(), AfterValidator(_not_huge)]
"""A finite number, which may be as close to 0 as the round-off of another program leaves it."""
Number = Annotated[Finite, AfterValidator(not_tiny)]
"""A finite number; a text such as '1.5' is refused."""
# Limits come before the function: after it, pydantic would not write them into the JSON Schema as keywords.
Positive = Annotated[float, Strict(), Field(gt=0), AfterValidator(_not_huge), AfterValidator(not_tiny)]
"""A finite number greater than 0."""
Count = Annotated[int, Strict()]
"""A whole number."""
Flag = Annotated[bool, Strict()]
"""True or false."""
Text = Annotated[str, Strict(), AfterValidator(_readable)]
"""A text, of several lines or not; a number is refused."""
Label = Annotated[str, Strict(), AfterValidator(_one_line)]
"""A text of one line, which may be empty."""
Title = Annotated[Label, AfterValidator(_not_blank)]
"""A name that key paths do not contain, such as that of a problem or a reference."""
Name = Annotated[Title, AfterValidator(_usable_in_paths)]
"""A name of an edge, a contact zone, a tool or a load case."""
Point = Annotated[tuple[Finite, Finite], BeforeValidator(_pair)]
"""Coordinates or components (x, y)."""
PositivePair = Annotated[tuple[Positive, Positive], BeforeValidator(_pair)]
"""Two numbers greater than 0."""


def _translated_errors(cls: type[BaseModel], error: ValidationError) -> list[Issue]:
    """Translate the errors of one class; a missing key is not reported together with its misspelling or other word."""
    details = error.errors(include_url=False)
    unknown = {str(item["loc"][-1]) for item in details if item["type"] == "extra_forbidden" and len(item["loc"]) == 1}
    meant = {near_by(key, cls.model_fields) for key in unknown} if len(unknown) <= MANY_WORDS else set[str | None]()
    others = cls.other_words if issubclass(cls, SpecModel) else {}
    meant |= {word for key in unknown for word in re.findall(r"\w+", others.get(key, ""))}
    return [
        _issue(item) if _is_translated(item) else _translated(cls, item)
        for item in details
        if not (item["type"] == "missing" and item["loc"][-1] in meant)
        and not _is_consequence(item)
        and not _is_other_word(item, details)
    ]


def misspelled(cls: type[BaseModel], data: Mapping[str, Any]) -> dict[str, str]:
    """Find unknown keys that are probably misspelled: key in the data -> known key that is not given."""
    others = cls.other_words if issubclass(cls, SpecModel) else ()
    unknown = [key for key in data if isinstance(key, str) and key not in cls.model_fields and key not in others]
    meant = {key: near_by(key, cls.model_fields) for key in unknown} if len(unknown) <= MANY_WORDS else {}
    return {key: word for key, word in meant.items() if word is not None and word not in data}


def _below_misspelled(cls: type[BaseModel], data: Any, handler: ModelWrapValidatorHandler[Any]) -> list[Issue]:
    """List the issues of values under misspelled keys, as if the keys were spelled right."""
    issues = []
    for key, meant in misspelled(cls, data).items() if isinstance(data, Mapping) else ():
        if isinstance(data[key], str) and has_unit(data[key]):
            continue  # units are read under keys that are known
        try:
            handler({meant: data[key]})
        except ValidationError as error:
            below = [issue for issue in _translated_errors(cls, error) if issue.path[:1] == (meant,)]
            issues += [replace(issue, path=(key, *issue.path[1:])) for issue in below]
    return issues


def _is_consequence(details: ErrorDetails) -> bool:
    """Whether a list counts as too short only because some of its entries are wrong."""
    return details["type"] == "too_short" and len(details["input"]) >= details.get("ctx", {})["min_length"]


def _is_other_word(details: ErrorDetails, others: Iterable[ErrorDetails]) -> bool:
    """Whether a word was expected in a place that takes numbers too, of which another error tells."""
    place = details["loc"][:-1]
    return details["type"] == "literal_error" and any(
        other["loc"][:-1] == place and other["type"] != "literal_error" for other in others if place
    )


def _nameless(cls: type[BaseModel], data: Any) -> dict[str, str]:
    """Messages for mappings of names, by key, that have the keys of an entry instead of names."""
    messages = {}
    for key, field in cls.model_fields.items():
        value, (origin, parts) = data.get(key) if isinstance(data, Mapping) else None, types_in(annotation_of(field))
        entry = parts[1] if origin is dict else None
        if not (isinstance(value, Mapping) and value and isinstance(entry, type) and issubclass(entry, SpecModel)):
            continue
        if {*value} <= {*entry.model_fields}:
            wanted = example_of(annotation_of(field))
            messages[key] = f"the names are missing, expected a mapping of names such as {wanted}"
    return messages


def _is_translated(details: ErrorDetails) -> bool:
    return details["type"] in {"issue", "key_issue"}


def _issue(details: ErrorDetails) -> Issue:
    path = details["loc"]
    if path and path[-1] == "[key]":
        return KeyIssue(path=path[:-1], message=details["msg"])
    return (KeyIssue if details["type"] == "key_issue" else Issue)(path=path, message=details["msg"])


def _line_error(issue: Issue) -> InitErrorDetails:
    kind = "key_issue" if isinstance(issue, KeyIssue) else "issue"
    error = PydanticCustomError(kind, "{message}", {"message": issue.message})
    return InitErrorDetails(type=error, loc=issue.path, input=None)


def _translated(cls: type[BaseModel], details: ErrorDetails) -> Issue:
    """Translate one error of pydantic."""
    path = details["loc"]
    if path and path[-1] == "[key]":
        name = str(path[-2])
        return KeyIssue(path=path[:-1], message=f"a name must be a text; write it in quotes: '{name}'")
    if details["type"] == "extra_forbidden":
        return KeyIssue(path=path, message=_unknown_key(cls, str(path[-1])))
    if details["type"] == "missing":
        return Issue(path=path, message=_missing(cls, str(path[-1])))
    if details["type"] == "model_type":
        found = f"such as {likely_mapping(cls, details['input'])}; found {described(details['input'])}"
        return Issue(path=path, message=f"expected a mapping with the keys {', '.join(cls.model_fields)}, {found}")
    message = _wrong_value(details, example_of(annotation_at(cls, path)))
    if details["type"] == "float_type" and len(path) == 1 and not number_hint(details["input"]):
        message += _to_give(cls, str(path[0]))
    return Issue(path=path, message=message)


FEW_HOMES = 2
"""Most places of a key that are named where it stands in a wrong one."""


def _unknown_key(cls: type[BaseModel], key: str) -> str:
    """Say that a mapping has no such key, and where the key belongs or which one was meant."""
    if isinstance(cls, type) and issubclass(cls, SpecModel) and key in cls.other_words:
        return f"unknown key '{key}'; {cls.other_words[key]}"
    tops = [model for model in _descendants(SpecModel) if model.root]
    if "kind" in cls.model_fields and any(_have_one_home(top, [*cls.model_fields, key]) for top in tops):
        known = ", ".join(cls.model_fields)
        return f"unknown key '{key}' for kind: {cls.model_fields['kind'].default}; there are: {known}"
    places = [f"under {place}" if place else "at the top level" for top in tops for place in homes(top, key)]
    if 0 < len(places) <= FEW_HOMES:
        meant = near_by(key, cls.model_fields)
        here = f"did you mean '{meant}'? " if meant else ""
        return f"unknown key '{key}'; {here}'{key}' belongs {' or '.join(places)}"
    text = unknown_word("key", key, cls.model_fields)
    return text + cls.elsewhere if issubclass(cls, SpecModel) and "did you mean" not in text else text


def _have_one_home(top: type[BaseModel], keys: Iterable[str]) -> bool:
    """Whether there is a place that may have each of some keys, if in mappings of several kinds."""
    return bool(set.intersection(*({*homes(top, key)} for key in keys)))


def _descendants(model: type[SpecModel]) -> Iterator[type[SpecModel]]:
    """All classes that are made from a class."""
    for child in model.__subclasses__():
        yield child
        yield from _descendants(child)


def left_out() -> Any:
    """A key that may be left out because others stand in for it, with a value that is never null."""

    def without_default(schema: dict[str, Any]) -> None:
        del schema["default"]

    return Field(default=None, validate_default=False, json_schema_extra=without_default)


def missing_keys(cls: type[BaseModel], data: Any, keys: Sequence[str]) -> Iterator[Issue]:
    """Issues of keys without which a mapping means nothing, though others may stand in for them."""
    if isinstance(data, Mapping):
        meant = misspelled(cls, data).values()
        yield from (
            Issue(path=(key,), message=_missing(cls, key)) for key in keys if key not in data and key not in meant
        )


def _missing(cls: type[BaseModel], key: str) -> str:
    """Say that a key is missing, and what to give for it: its description in the class."""
    return f"missing{_to_give(cls, key)}"


def _to_give(cls: type[BaseModel], key: str) -> str:
    """Say what to give for a key: its description in the class; empty if it has none."""
    text = " ".join(attribute_docstrings(cls).get(key, "").split())
    return f"; give {text[0].lower()}{text[1:].rstrip('.')}" if text else ""


def _wrong_value(details: ErrorDetails, example: str) -> str:
    """Say what was expected and what was found."""
    value, context = details["input"], details.get("ctx", {})
    found = f"found {described(value)}"
    match details["type"]:
        case "float_type" | "float_parsing":
            return f"expected a number, {found}{number_hint(value)}"
        case "finite_number":
            return f"expected a finite number, {found}"
        case "int_type" | "int_from_float" | "int_parsing" | "int_parsing_size":
            return f"expected a whole number, {found}{number_hint(value)}"
        case "bool_type":
            return f"expected true or false, {found}"
        case "string_type":
            return f"expected a text, {found}{text_hint(value)}"
        case "greater_than":
            return f"must be greater than {context['gt']:g}, {found}"
        case "greater_than_equal":
            return f"must be at least {context['ge']:g}, {found}"
        case "less_than":
            return f"must be less than {context['lt']:g}, {found}"
        case "less_than_equal":
            return f"must be at most {context['le']:g}, {found}"
        case "literal_error":
            return f"expected {context['expected']}, {found}"
        case "tuple_type":
            return f"expected a list such as {example}, {found}{list_hint(value)}"
        case "too_short":
            return f"expected at least {context['min_length']} in the list, {found}"
        case "too_long":
            return f"expected at most {context['max_length']} in the list, {found}"
        case "dict_type":
            return f"expected a mapping of names such as {example}, {found}"
    return f"{details['msg'][0].lower()}{details['msg'][1:]}, {found}"
