"""Text without hidden characters.

Hidden characters are control characters, separators of lines, characters that change the direction of text, and others
that no font draws. In a terminal, a page or a picture they could hide or forge what is shown. The texts of a problem
have none, and `escaped` replaces those in anything else that is shown, such as names of files.
"""

import re
import unicodedata

LINE_BREAKS = "\n\t"
"""Hidden characters that a text of several lines may contain."""
_HIDDEN = re.compile(
    "[\x00-\x1f\x7f-\x9f\xad\u061c\u180e\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\ud800-\udfff\ufeff\ufff9-\ufffb"
    "\ufffe\uffff\U0001bca0-\U0001bca3\U0001d173-\U0001d17a\U000e0000-\U000e007f]"
)


def hidden_character(text: str, allowed: str = "") -> str | None:
    """Describe the first hidden character of a text that is not allowed, such as U+200E (left-to-right mark)."""
    for match in _HIDDEN.finditer(text):
        if (character := match[0]) not in allowed:
            name = unicodedata.name(character, "").lower()
            return f"U+{ord(character):04X}{f' ({name})' if name else ''}"
    return None


def escaped(text: str, kept: str = "") -> str:
    r"""Replace each hidden character that is not kept by its number, such as \x1b or \u202e."""
    return _HIDDEN.sub(lambda match: match[0] if match[0] in kept else _number(match[0]), text)


def escaped_lines(text: str) -> str:
    """Replace each hidden character, but keep the lines of the text."""
    return escaped(text, LINE_BREAKS)


def escaped_json(text: str) -> str:
    """Replace each hidden character in a JSON text by the escape of JSON, so that the data stay the same."""
    return _HIDDEN.sub(lambda match: match[0] if match[0] in LINE_BREAKS else _units(match[0]), text)


def _number(character: str) -> str:
    """Escape of Python for a character: two, four or eight digits."""
    code = ord(character)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _units(character: str) -> str:
    """Escape of JSON for a character: four digits for each of its units of UTF-16."""
    units = character.encode("utf-16-be", "surrogatepass").hex()
    return "".join(f"\\u{units[i : i + 4]}" for i in range(0, len(units), 4))
