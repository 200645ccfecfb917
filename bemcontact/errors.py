"""All errors that the package raises: `BemContactError` and its subclasses.

An error means that a problem or a request has no answer. A solver that does not converge raises no error: it returns a
`bemcontact.Status`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from bemcontact.plain_text import escaped, escaped_lines

KeyPath = tuple[str | int, ...]
"""Keys and list positions from the top of a spec to a value, such as ``("conditions", "top", "pressure")``."""


@dataclass(frozen=True, kw_only=True)
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
        return escaped(f"{dotted(self.path)}: {self.message}" if self.path else self.message)


def dotted(path: KeyPath) -> str:
    """Write a key path as in a spec: ``contact_zones.foot.edges[1]``."""
    text = ""
    for key in path:
        text += f"[{key}]" if isinstance(key, int) else f".{key}" if text else key
    return text


class BemContactError(Exception):
    """Base class of all errors that the package raises; its text has no hidden characters besides ends of lines."""

    def __init__(self, message: str = "") -> None:
        super().__init__(escaped_lines(message))


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
