"""A problem of which one value changes, condensed at some of the values."""

from dataclasses import dataclass, field

from bemcontact.bem.condense import Condensation
from bemcontact.bem.condense import condense as condense_body
from bemcontact.bem.discretization import body_of
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import KeyPath, OptionError, ProblemError
from bemcontact.problems.key_path import parsed_path
from bemcontact.problems.problem import Problem


@dataclass(frozen=True, eq=False)
class Variation:
    """A problem whose mesh is not to be fitted, the key of a value, and what is known by value."""

    problem: Problem
    key: str
    condensed: dict[float, Condensation] = field(default_factory=dict)
    stated: dict[float, Problem] = field(default_factory=dict)

    @property
    def path(self) -> KeyPath:
        """The key as a path."""
        return parsed_path(self.key)

    @property
    def acts_on_contact(self) -> bool:
        """Whether the key is the factor of a load case or a component of a tool, which needs one condensation only."""
        path = self.path
        of_tool = path[0] == "tools" and len(path) == 4 and path[2] in ("displacement", "force")
        return of_tool or case_of(self.problem, self.key) is not None

    def at(self, value: float) -> Problem:
        """The problem with another value, or with another factor of a load case."""
        if value not in self.stated:
            case, problem = case_of(self.problem, self.key), self.problem
            if case is None:
                self.stated[value] = problem.with_value(self.key, value).on_contacts_of(problem)
            else:
                self.stated[value] = problem.with_factors({**problem.factors(), case: value})
        return self.stated[value]

    def attempted(self, value: float) -> CondensedContact | ProblemError:
        """Condense the problem at a value that is allowed; the error where nothing presses the body on its support."""
        varied = self.at(value)
        try:
            self.condensed[value] = condense_body(body_of(varied))
        except ProblemError as error:
            return error
        return self.condensed[value].contact


def case_of(problem: Problem, key: str) -> str | None:
    """The load case whose factor a key path means, as `load_cases.wind` does; None for other paths.

    `OptionError` for the name of a load case alone.
    """
    room, *rest = parsed_path(key)
    if not rest and room in problem.load_cases and room not in Problem.model_fields:
        raise OptionError(f"'{room}' is a load case; vary its factor by load_cases.{room}")
    return str(rest[0]) if room == "load_cases" and len(rest) == 1 and rest[0] in problem.load_cases else None
