"""A problem compared on one mesh or several: all that a report is written from."""

import json
import platform
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from bemcontact.analysis.result import Result
from bemcontact.assessment.comparison import Comparison
from bemcontact.assessment.convergence import Convergence, convergence
from bemcontact.problem.problem import Problem
from bemcontact.reference import Expected, Score, expected, score
from bemcontact.version import __version__

ALTERED = "the problem was changed (--set), but this reference was not: shown, not judged"
"""Remark on a reference of another problem."""
VERSIONS = ("numpy", "scipy", "cvxpy", "clarabel", "matplotlib", "jinja2")
"""Packages whose versions a report states."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MeshLevel:
    """A problem on one mesh.

    Parameters
    ----------
    refine : parts into which each stated element is cut
    comparison : of the formulations
    answer : the direct solution, judged, with the boundary behind it
    outdated : names of references that are of another problem, which was changed without them
    """

    refine: int
    comparison: Comparison
    answer: Result
    outdated: frozenset[str] = frozenset()

    @cached_property
    def expected(self) -> tuple[Expected, ...]:
        """What the references of the problem say at the contact points."""
        problem = self.answer.problem
        found = () if problem is None else expected(problem, self.answer.contact)
        return tuple(_outdated(item) if item.name in self.outdated else item for item in found)

    @cached_property
    def scores(self) -> tuple[Score, ...]:
        """How the answer stands beside the references."""
        answer = self.answer
        return score(self.expected, answer.contact, answer.footprint, answer.solution.pressure)

    def to_dict(self) -> dict[str, Any]:
        """Give all of it as numbers, lists and texts, ready for JSON."""
        answer = self.answer
        return {
            "refine": self.refine,
            "dof": answer.degrees_of_freedom,
            "seconds": answer.seconds,
            "notes": list(answer.notes),
            "force_balance": answer.residuals.force_balance,
            "equilibrium_slack": answer.equilibrium_slack,
            "mesh_fit": None if answer.mesh_fit is None else answer.mesh_fit.to_dict(),
            "comparison": self.comparison.to_dict(),
            "references": [item.to_dict() for item in self.expected],
            "scores": [item.to_dict() for item in self.scores],
        }


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Study:
    """A problem compared on one mesh or several.

    Parameters
    ----------
    settings : what was compared, ready for JSON
    levels : the coarsest mesh first
    """

    settings: dict[str, Any]
    levels: tuple[MeshLevel, ...]

    def __repr__(self) -> str:
        """One line: name, meshes, verdict."""
        return f"<Study of {self.name!r} on {len(self.levels)} meshes: {self.finest.comparison.verdict}>"

    @property
    def finest(self) -> MeshLevel:
        """The level of the finest mesh, which gives the answer."""
        return self.levels[-1]

    @property
    def name(self) -> str:
        """Of the problem."""
        return self.finest.comparison.contact.name

    @property
    def problem(self) -> Problem | None:
        """What was asked, on the finest mesh; None if a condensed problem was."""
        return self.finest.answer.problem

    @property
    def certified(self) -> bool:
        """Whether all contenders on all meshes are proved to be the solution."""
        return all(level.comparison.certified for level in self.levels)

    @cached_property
    def convergence(self) -> Convergence | None:
        """What changes with the mesh; None on a single one."""
        if len(self.levels) == 1:
            return None
        return convergence(
            [level.refine for level in self.levels],
            [level.answer.footprint for level in self.levels],
            [level.comparison.matrices[0].asymmetry for level in self.levels],
        )

    @property
    def seconds(self) -> float:
        """Of all stages on all meshes."""
        return sum(sum(level.answer.seconds.values()) for level in self.levels)

    def to_dict(self) -> dict[str, Any]:
        """Give all of it as numbers, lists and texts, ready for JSON: what stands in report.json."""
        problem = self.problem
        return {
            "name": self.name,
            "description": "" if problem is None else problem.description,
            "certified": self.certified,
            "verdict": self.finest.comparison.verdict,
            "units": {"length": "", "force": "", **self.finest.comparison.contact.units},
            "settings": self.settings,
            "levels": [level.to_dict() for level in self.levels],
            "convergence": None if self.convergence is None else self.convergence.to_dict(),
            "versions": versions(),
            "seconds": self.seconds,
        }

    def to_json(self, indent: int | None = 2) -> str:
        """Write `to_dict` as JSON; every number in it is finite."""
        return json.dumps(self.to_dict(), indent=indent, allow_nan=False, ensure_ascii=False)


def _outdated(expected: Expected) -> Expected:
    """A reference of another problem."""
    remark = f"{expected.remark}; {ALTERED}" if expected.remark else ALTERED
    return replace(expected, in_range=False, remark=remark)


def versions() -> dict[str, str]:
    """Of the package, of Python and of what did the work."""
    found = {"bemcontact": __version__, "python": platform.python_version()}
    for name in VERSIONS:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "unknown"
    return found
