"""What can go wrong, as types: `BemContactError` and its leaves.

An error means that the question has no answer as asked. A solver that does not converge is no error: it returns a
`bemcontact.Status`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

Path = tuple[str | int, ...]
"""Keys and list positions from the top of a spec to a value, such as ``("conditions", "top", "pressure")``."""


@dataclass(frozen=True, kw_only=True)
class Complaint:
    """One thing that is wrong with a problem: where (path of keys) and what, in a sentence that says the way out."""

    path: Path
    message: str

    def __str__(self) -> str:
        """The key path in dots, then the message."""
        return f"{dotted(self.path)}: {self.message}" if self.path else self.message


def dotted(path: Path) -> str:
    """Write a path of keys as a person does: ``contact_zones.foot.edges[1]``."""
    text = ""
    for key in path:
        text += f"[{key}]" if isinstance(key, int) else f".{key}" if text else key
    return text


class BemContactError(Exception):
    """Base of all errors that the package raises on purpose."""


class ProblemError(BemContactError):
    """A problem that has no answer as stated: contradictory, incomplete, or physically impossible.

    Parameters
    ----------
    complaints : Complaint, sequence of Complaint, or str
        All that was found, each with the path of keys it belongs to.
    """

    def __init__(self, complaints: Complaint | Sequence[Complaint] | str) -> None:
        if isinstance(complaints, str):
            complaints = Complaint(path=(), message=complaints)
        self.complaints = (complaints,) if isinstance(complaints, Complaint) else tuple(complaints)
        super().__init__("\n".join(map(str, self.complaints)))


class OptionError(ProblemError):
    """An option of solving, not the problem, that is wrong: of no meaning, out of range, or not for this problem."""


class SpecError(BemContactError):
    """A spec file that does not state a problem; each line of the text starts with ``file:line:column``."""


class SingularSystemError(BemContactError):
    """A linear system of the boundary-element core has no unique solution."""


class NotConvexError(BemContactError):
    """A quadratic program that must be convex is not; the text states the eigenvalue."""

    def __init__(self, message: str, *, smallest_eigenvalue: float) -> None:
        self.smallest_eigenvalue = smallest_eigenvalue
        super().__init__(message)


class SolverError(BemContactError):
    """A solver gave no answer that could be used; raised from the solver's own error where there is one."""
