"""What all parts of a problem share: they are frozen, strict about types, and complain in the user's words."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Annotated, Any, Self

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

from bemcontact.errors import Complaint, ProblemError

LARGEST_NUMBER = 1e100
"""Its square is still a floating-point number, so that lengths and areas can be computed."""
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?")


@dataclass(frozen=True, kw_only=True)
class KeyComplaint(Complaint):
    """A complaint about the last key of the path itself, not about what stands there."""


def complain(message: str) -> PydanticCustomError:
    """Make the error that a validator raises about the value it looks at."""
    return PydanticCustomError("complaint", "{message}", {"message": message})


def validation_error(title: str, complaints: Iterable[Complaint]) -> ValidationError:
    """Make the error that a validator raises about several places inside the value it looks at."""
    return ValidationError.from_exception_data(title, [_line_error(complaint) for complaint in complaints])


def complaints_of(error: ValidationError) -> list[Complaint]:
    """Read the complaints back from an error that `Stated` has worded."""
    return [_complaint(details) for details in error.errors(include_url=False, include_input=False)]


def near_by(word: str, known: Iterable[str]) -> str | None:
    """Find the known word that was probably meant, or None."""
    lower = {candidate.lower(): candidate for candidate in known}
    matches = get_close_matches(word.lower(), lower, n=1)
    return lower[matches[0]] if matches else None


def described(value: object) -> str:
    """Say what was found, as its author would: the text 'abc', a list of 3, nothing."""
    match value:
        case None:
            return "nothing"
        case bool():
            return "true" if value else "false"
        case str():
            return "an empty text" if not value else f"the text {_shortened(repr(value))}"
        case list() | tuple():
            return f"a list of {len(value)}" if value else "an empty list"
        case Mapping():
            return "a mapping" if value else "an empty mapping"
    return _shortened(str(value))


class Stated(BaseModel):
    """Base of everything that a user states.

    Raises
    ------
    ProblemError
        If a part is made from something that it cannot be, with one complaint for each mistake.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True)

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ProblemError(complaints_of(error)) from None

    # A part inside a part is then validated as pydantic does it, so that its complaints get their full path.
    __init__.__pydantic_base_init__ = True  # pyright: ignore[reportFunctionMemberAccess]

    @model_validator(mode="wrap")
    @classmethod
    def _complain_in_words(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Translate what pydantic says about the keys of this very class; inner parts have done so already."""
        try:
            return handler(data)
        except ValidationError as error:
            complaints = [*_worded(cls, error), *_below_misspelled(cls, data, handler)]
            raise validation_error(cls.__name__, complaints) from None


def _finite(value: float) -> float:
    """Refuse what cannot be computed with."""
    if abs(value) > LARGEST_NUMBER:
        raise complain(f"{value:.3g} is too large to compute with; choose other units")
    return value


def _pair(value: Any) -> Any:
    """Refuse a list that is not a pair, before its entries are looked at."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise complain(f"expected two numbers such as [0.0, 1.5], found {described(value)}")
    return value


def _usable_name(value: str) -> str:
    """Refuse names that could not stand in a key path."""
    if not value.strip():
        raise complain("a name must not be empty")
    if bad := sorted(set(value) & set(".[]=")):
        raise complain(f"a name must not contain {' '.join(bad)}, which key paths use; found {value!r}")
    return value


Number = Annotated[float, Strict(), AfterValidator(_finite)]
"""A finite number; text that looks like one is refused."""
# Limits stand before the function: behind it, pydantic would not write them into the JSON Schema as its keywords.
Positive = Annotated[float, Strict(), Field(gt=0), AfterValidator(_finite)]
"""A finite number greater than 0."""
Count = Annotated[int, Strict()]
"""A whole number."""
Flag = Annotated[bool, Strict()]
"""True or false."""
Text = Annotated[str, Strict()]
"""Text; a number is refused."""
Name = Annotated[Text, AfterValidator(_usable_name)]
"""The name of an edge or a zone."""
Point = Annotated[tuple[Number, Number], BeforeValidator(_pair)]
"""Coordinates or components (x, y)."""
PositivePair = Annotated[tuple[Positive, Positive], BeforeValidator(_pair)]
"""Two numbers greater than 0."""


def _worded(cls: type[BaseModel], error: ValidationError) -> list[Complaint]:
    """Put the errors of one class into words; a missing key is not reported beside its misspelling."""
    details = error.errors(include_url=False)
    unknown = {str(item["loc"][-1]) for item in details if item["type"] == "extra_forbidden" and len(item["loc"]) == 1}
    meant = {near_by(key, cls.model_fields) for key in unknown}
    return [
        _complaint(item) if _is_worded(item) else _translated(cls, item)
        for item in details
        if not (item["type"] == "missing" and item["loc"][-1] in meant) and not _is_consequence(item)
    ]


def misspelled(cls: type[BaseModel], data: Mapping[str, Any]) -> dict[str, str]:
    """Find unknown keys that probably mean a known one which is not given: found key -> meant key."""
    unknown = [key for key in data if isinstance(key, str) and key not in cls.model_fields]
    meant = {key: near_by(key, cls.model_fields) for key in unknown}
    return {key: word for key, word in meant.items() if word is not None and word not in data}


def _below_misspelled(cls: type[BaseModel], data: Any, handler: ModelWrapValidatorHandler[Any]) -> list[Complaint]:
    """Complain about what stands under misspelled keys too, as if they were spelled right."""
    found = []
    for key, meant in misspelled(cls, data).items() if isinstance(data, Mapping) else ():
        try:
            handler({meant: data[key]})
        except ValidationError as error:
            complaints = [complaint for complaint in _worded(cls, error) if complaint.path[:1] == (meant,)]
            found += [replace(complaint, path=(key, *complaint.path[1:])) for complaint in complaints]
    return found


def _is_consequence(details: ErrorDetails) -> bool:
    """Tell that a list is called too short only because its entries are wrong."""
    return details["type"] == "too_short" and len(details["input"]) >= details.get("ctx", {})["min_length"]


def _is_worded(details: ErrorDetails) -> bool:
    return details["type"] in {"complaint", "key_complaint"}


def _complaint(details: ErrorDetails) -> Complaint:
    kind = KeyComplaint if details["type"] == "key_complaint" else Complaint
    return kind(path=details["loc"], message=details["msg"])


def _line_error(complaint: Complaint) -> InitErrorDetails:
    kind = "key_complaint" if isinstance(complaint, KeyComplaint) else "complaint"
    error = PydanticCustomError(kind, "{message}", {"message": complaint.message})
    return InitErrorDetails(type=error, loc=complaint.path, input=None)


def _translated(cls: type[BaseModel], details: ErrorDetails) -> Complaint:
    """Turn one of pydantic's own errors into a complaint."""
    path = details["loc"]
    if path and path[-1] == "[key]":
        name = str(path[-2])
        return KeyComplaint(path=path[:-1], message=f"a name must be a text; write it in quotes: '{name}'")
    if details["type"] == "extra_forbidden":
        return KeyComplaint(path=path, message=unknown_word("key", str(path[-1]), cls.model_fields))
    if details["type"] == "missing":
        return Complaint(path=path, message=_missing(cls, str(path[-1])))
    if details["type"] == "model_type":
        expected = f"a mapping with the keys {listed(cls.model_fields)}"
        return Complaint(path=path, message=f"expected {expected}; found {described(details['input'])}")
    return Complaint(path=path, message=_wrong_value(details))


def unknown_word(what: str, word: str, known: Iterable[str]) -> str:
    """Say that a word is unknown or empty, which one was probably meant, and which there are."""
    known = tuple(known)
    if not word.strip():
        return f"the name of the {what} is empty; there is: {listed(known)}"
    meant = near_by(word, known)
    hint = f"did you mean '{meant}'?" if meant else f"there is: {listed(known)}"
    return f"unknown {what} {_shortened(repr(word))}; {hint}"


def _missing(cls: type[BaseModel], key: str) -> str:
    """Say that a key is missing, with the description that the class gives of it."""
    text = cls.model_fields[key].description if key in cls.model_fields else None
    return f"missing; give {text[0].lower()}{text[1:].rstrip('.')}" if text else "missing"


def _wrong_value(details: ErrorDetails) -> str:
    """Say what was expected of a value and what was found."""
    found, context = details["input"], details.get("ctx", {})
    was = f"found {described(found)}"
    match details["type"]:
        case "float_type" | "float_parsing":
            return f"expected a number, {was}{number_hint(found)}"
        case "finite_number":
            return f"expected a finite number, {was}"
        case "int_type" | "int_from_float" | "int_parsing" | "int_parsing_size":
            return f"expected a whole number, {was}{number_hint(found)}"
        case "bool_type":
            return f"expected true or false, {was}"
        case "string_type":
            quotes = f"; write '{described(found)}' in quotes" if isinstance(found, int | float) else ""
            return f"expected a text, {was}{quotes}"
        case "greater_than":
            return f"must be greater than {context['gt']:g}, {was}"
        case "greater_than_equal":
            return f"must be at least {context['ge']:g}, {was}"
        case "less_than":
            return f"must be less than {context['lt']:g}, {was}"
        case "less_than_equal":
            return f"must be at most {context['le']:g}, {was}"
        case "literal_error":
            return f"expected {context['expected']}, {was}"
        case "tuple_type":
            return f"expected a list, {was}"
        case "too_short":
            return f"expected at least {context['min_length']} in the list, {was}"
        case "dict_type":
            return f"expected a mapping of names, {was}"
    return f"{details['msg'][0].lower()}{details['msg'][1:]}, {was}"


def number_hint(found: object) -> str:
    """Say how a number in a text is to be written, if it is one; nothing otherwise."""
    if not isinstance(found, str):
        return ""
    if _THOUSANDS.fullmatch(found):
        otherwise = f", or {found.replace(',', '.')} if the comma is the decimal sign" * (found.count(",") == 1)
        return f"; write {found.replace(',', '')} without a comma between thousands{otherwise}"
    try:
        float(found.replace(",", ".", 1))
    except ValueError:
        return ""
    return "; the decimal sign is a point" if "," in found else "; leave the quotes out"


def listed(words: Iterable[str]) -> str:
    """Write words as an enumeration."""
    return ", ".join(words) or "none"


def _shortened(text: str, longest: int = 48) -> str:
    return text if len(text) <= longest else f"{text[: longest - 3]}..."
