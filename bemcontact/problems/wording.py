"""Plain texts for errors: what was found, which word was meant, what to write."""

import re
from collections.abc import Collection, Iterable, Mapping
from difflib import get_close_matches
from math import isfinite

from bemcontact.checks.arguments import LONGEST_NAME

MANY_WORDS = 100
"""Number of known or unknown words from which they are not compared with each other, which would take long."""
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?")
_SPACED = re.compile(r"[-+]?[1-9]\d{0,2}( \d{3})+(\.\d*)?")
_DIGITS_AND_UNIT = re.compile(r"([-+]?\d[\d.]*[, ][\d., ]*\d) *[^\W\d_]\S*")
_PERCENT = re.compile(r"([-+]?\d+(\.\d+)?) ?%")
_FORMULA = re.compile(r"[-+*/^().\d eE]*\d ?[-+*/^][-+*/^().\d eE]*")
_BETWEEN_NAMES = re.compile(r"[,;+&/|]| and ")
_KEY_AND_VALUE = re.compile(r"([^:=]+)[:=].*", flags=re.DOTALL)
_PLAIN_NUMBER = re.compile(r"\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*")
"""A number that YAML reads as one, so that it is a text only in quotes."""
_NUMBER_AND_UNIT = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)? *[^\W\d_][^ ]*")


def near_by(word: str, known: Iterable[str], cutoff: float = 0.6) -> str | None:
    """Return the known word that is closest to a misspelled one; None if none is as similar as `cutoff`, up to 1."""
    lower = {candidate.lower(): candidate for candidate in known}
    if len(lower) > MANY_WORDS or len(word) > LONGEST_NAME:
        return None
    matches = get_close_matches(word.lower(), lower, n=1, cutoff=cutoff)
    return lower[matches[0]] if matches else None


def described(value: object) -> str:
    """Describe a value for an error message: the text 'abc', a list of 3, nothing."""
    match value:
        case None:
            return "nothing"
        case bool():
            return "true" if value else "false"
        case str():
            return "an empty text" if not value else f"the text {shortened(repr(value))}"
        case list() | tuple():
            return f"a list of {len(value)}" if value else "an empty list"
        case Mapping():
            return "a mapping" if value else "an empty mapping"
    try:
        return shortened(str(value))
    except Exception:  # an object of the user may refuse to be written
        return f"an object of type {type(value).__name__}"


def unknown_word(what: str, word: str, known: Iterable[str], key: str = "") -> str:
    """Say that a word is unknown or empty, and name the closest known word, or all of them.

    `key` is that of a list of such words, if the word stands in one.
    """
    known = tuple(known)
    if not word.strip():
        return f"the name of the {what} is empty; {_available(known)}"
    if names := ", ".join(_several(word, known)):
        hint = f"write {key}: [{names}]" if key else f"write one entry for each name: {names}"
    elif (parts := _KEY_AND_VALUE.fullmatch(word)) and parts[1].strip() in known:
        hint = f"write '{parts[1].strip()}: ' with a blank after the colon"
    else:
        meant = near_by(word, known)
        hint = f"did you mean '{meant}'?" if meant else _available(known)
    return f"unknown {what} {shortened(repr(word))}; {hint}"


def _several(word: str, known: Collection[str]) -> list[str]:
    """The names in a word that lists several, with commas or blanks between them; else none."""
    if len(word) > LONGEST_NAME:
        return []
    for parts, enough in ((_BETWEEN_NAMES.split(word), any), (word.split(), all)):
        names = [name for part in parts if (name := part.strip(" \n-()[]{}'\""))]
        if len(names) > 1 and enough(name in known for name in names):
            return names
    return []


def _available(words: tuple[str, ...]) -> str:
    match words:
        case ():
            return "there are none"
        case (word,):
            return f"there is only '{word}'"
    return f"there are: {shortened(', '.join(words), LONGEST_NAME)}"


def number_hint(value: object) -> str:
    """Say how to write the number that a text contains; empty if it contains none."""
    if isinstance(value, list | tuple) and len(value) == 1 and isinstance(value[0], int | float):
        return "; leave the brackets out"
    if not isinstance(value, str):
        return ""
    if percent := _PERCENT.fullmatch(value):
        return f"; write {float(percent[1]) / 100:.12g}"
    if parts := _DIGITS_AND_UNIT.fullmatch(value):
        return number_hint(parts[1])
    if _SPACED.fullmatch(value):
        return f"; write {value.replace(' ', '')} without blanks between thousands"
    if _FORMULA.fullmatch(value) and not is_number(value):
        return "; write the number itself, formulas are not computed"
    if _THOUSANDS.fullmatch(value):
        otherwise = f", or {value.replace(',', '.')} if the comma is the decimal sign" * (value.count(",") == 1)
        return f"; write {value.replace(',', '')} without a comma between thousands{otherwise}"
    if not is_number(value.replace(",", ".", 1)):
        return "; write the number alone, in the units of the file" if has_unit(value) else ""
    if "," in value:
        return "; the decimal sign is a point"
    if _PLAIN_NUMBER.fullmatch(value):
        return "; leave the quotes out"
    number = float(value)  # Python also reads nan, inf, 210_000, and the digits of other scripts
    return f"; write {number:.15g}" if isfinite(number) else f"; {value.strip()} is not a finite number"


def has_unit(text: str) -> bool:
    """Whether a text is a number with a unit."""
    return _NUMBER_AND_UNIT.fullmatch(text) is not None


def is_number(text: str) -> bool:
    """Whether a text is a number as Python reads it."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def exact(value: float) -> str:
    """Write a number with all digits, so that it does not look equal to a limit that it misses."""
    return repr(float(value)).removesuffix(".0")


def shortened(text: str, longest: int = 48) -> str:
    """Cut a long text."""
    return text if len(text) <= longest else f"{text[: longest - 3]}..."
