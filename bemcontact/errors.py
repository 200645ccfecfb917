"""All errors that the package raises: `BemContactError` and its subclasses; and text that is safe to show in them.

An error means that a problem or a request has no answer. A solver that does not converge raises no error: it returns a
`bemcontact.Status`.

Hidden characters are control characters, separators of lines, characters that change the direction of text, and others
that no font draws. In a terminal, a page or a picture they could hide or forge what is shown. The texts of a problem
have none, and `escaped` replaces those in anything else that is shown, such as names of files.
"""

import re
import unicodedata
from collections.abc import Sequence

from bemcontact.frozen import frozen_value

KeyPath = tuple[str | int, ...]
"""Keys and list positions from the top of a spec to a value, such as ``("conditions", "top", "pressure")``."""


@frozen_value
class Issue:
    """One mistake in a problem.

    Parameters
    ----------
    path : keys from the top of the problem to the mistake
    message : what is wrong, what was found, and what to do
    """

    path: KeyPath
    message: str

    def __str__(self) -> str:
        """The key path with dots, then the message, in one line without hidden characters."""
        return shortened_lines(escaped(f"{dotted(self.path)}: {self.message}" if self.path else self.message))


def dotted(path: KeyPath) -> str:
    """Write a key path as in a spec: ``contact_zones.foot.edges[1]``."""
    text = ""
    for key in path:
        text += f"[{key}]" if isinstance(key, int) else f".{key}" if text else key
    return text


class BemContactError(Exception):
    """Base class of all errors that the package raises; its text has no hidden characters besides ends of lines."""

    def __init__(self, message: str = "") -> None:
        super().__init__(shortened_lines(escaped_lines(message)))


class ProblemError(BemContactError):
    """A problem that has no answer: it is contradictory, incomplete, or physically impossible.

    Parameters
    ----------
    issues : Issue, sequence of Issue, or str
        All mistakes that were found, each with its key path.
    """

    def __init__(self, issues: Issue | Sequence[Issue] | str) -> None:
        if isinstance(issues, str):
            issues = Issue(path=(), message=issues)
        self.issues = (issues,) if isinstance(issues, Issue) else tuple(issues)
        super().__init__("\n".join(map(str, self.issues)))


class OptionError(ProblemError):
    """An option of the solution that is unknown, out of range, or not possible for this problem."""


class SpecError(BemContactError):
    """A spec file that cannot be read as a problem; each line of the text starts with ``file:line:column``."""


class SingularSystemError(BemContactError):
    """A linear system of boundary elements has no unique solution."""


class NotConvexError(BemContactError):
    """A quadratic program that must be convex is not; the text gives the smallest eigenvalue."""

    def __init__(self, message: str, *, smallest_eigenvalue: float) -> None:
        self.smallest_eigenvalue = smallest_eigenvalue
        super().__init__(message)


class SolverError(BemContactError):
    """A solver failed without a usable result; its own error, if there is one, is the cause."""


LINE_BREAKS = "\n\t"
"""Hidden characters that a text of several lines may contain."""
KEPT = 600
"""Letters that are kept at both ends of a line of thousands."""
_LONG = re.compile(r"[^\n]{2400,}")
_HIDDEN = re.compile(
    "[\x00-\x1f\x7f-\x9f\xad\u061c\u115f\u1160\u17b4\u17b5\u180e\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\u2800\u3164"
    "\ud800-\udfff\ufeff\uffa0\ufff9-\ufffb\ufffe\uffff\U0001bca0-\U0001bca3\U0001d173-\U0001d17a\U000e0000-\U000e007f]"
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


def shortened_lines(text: str) -> str:
    """Leave out the middle of each line that is too long to be read, as where a key has thousands of letters."""
    return _LONG.sub(lambda match: f"{match[0][:KEPT]} ... {match[0][-KEPT:]}", text)


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
