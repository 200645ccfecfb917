"""The problems of the paper, carried out: all that the page and the table are written from."""

import json
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

from bemcontact.analysis.findings import along, extent, found, positions, unit_of
from bemcontact.analysis.paper import PaperProblem
from bemcontact.analysis.study import MeshLevel, versions
from bemcontact.problem import Problem, Table, Values


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """A problem on one mesh.

    Parameters
    ----------
    label : what it is called
    variant : of the file, or None if it is the problem as stated
    description : of the variant, as the file has it
    level : what came of it
    """

    label: str
    variant: str | None
    description: str = ""
    level: MeshLevel

    def to_dict(self, axis: Values | Table) -> dict[str, Any]:
        """Give all of it as numbers, lists and texts, ready for JSON."""
        level, compared = self.level, self.level.comparison
        problem = level.answer.problem
        assert problem is not None  # nothing condensed is reproduced
        return {
            "label": self.label,
            "variant": self.variant,
            "description": self.description,
            "refine": level.refine,
            "elements": sum(edge.elements for edge in problem.boundary.edges) * problem.mesh.refine,
            "dof": level.answer.degrees_of_freedom,
            "contact_nodes": level.answer.contact.size,
            "certified": compared.certified,
            "verdict": compared.verdict,
            "agreement": compared.agreement,
            "solvers": [
                {
                    "label": item.label,
                    "formulation": item.found.options.formulation.value,
                    "certified": item.certified,
                    "iterations": None if item.judged is None else item.judged.solution.iterations,
                }
                for item in compared.everyone
            ],
            "position": positions(level, axis).tolist(),
            "pressure": level.answer.solution.pressure.tolist(),
            "contact": list(extent(level, axis)),
            **level.answer.footprint.to_dict(),
            "seconds": sum(level.answer.seconds.values()),
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Reproduced:
    """One problem of the paper on all its meshes.

    Parameters
    ----------
    paper : what the paper says
    problem : as its file states it
    variants : of the file, which are certified but not held against references: those are for the problem as stated
    meshes : the problem as stated, the coarsest first
    """

    paper: PaperProblem
    problem: Problem
    variants: tuple[Run, ...]
    meshes: tuple[Run, ...]

    @property
    def runs(self) -> tuple[Run, ...]:
        """All of them, in the order of the page."""
        return (*self.variants, *self.meshes)

    @property
    def axis(self) -> Values | Table:
        """The coordinate of the figure."""
        return along(self.problem)

    @property
    def certified(self) -> bool:
        """Whether all formulations on all meshes are proved to be the solution."""
        return all(run.level.comparison.certified for run in self.runs)

    @property
    def judged(self) -> tuple[bool, ...]:
        """Of each quantity of each reference that can be held against an answer, whether it holds, mesh by mesh."""
        return tuple(score.holds for run in self.meshes for score in run.level.scores if score.judged)

    @property
    def reproduced(self) -> bool:
        """Whether all is certified and every judged reference holds."""
        return self.certified and all(self.judged)

    def to_dict(self) -> dict[str, Any]:
        """Give all of it as numbers, lists and texts, ready for JSON."""
        problem, paper, axis = self.problem, self.paper, self.axis
        unit = "°" if axis.against == "angle" else problem.units.length
        return {
            "model": paper.model,
            "name": problem.name,
            "figure": paper.figure,
            "description": problem.description,
            "units": problem.units.model_dump(),
            "coordinate": {"symbol": paper.symbol, "unit": unit},
            "certified": self.certified,
            "judged": len(self.judged),
            "held": sum(self.judged),
            "statements": [
                {
                    "what": item.what,
                    "said": item.said,
                    "unit": unit_of(item, axis, problem.units),
                    "found": [list(found(item, run.level, axis)) for run in self.runs],
                }
                for item in paper.statements
            ],
            "differs": list(paper.differs),
            "iterations": {name.value: count for name, count in paper.iterations.items()},
            "references": [item.to_dict() for item in self.meshes[-1].level.expected],
            "scores": self._scores(),
            "runs": [run.to_dict(axis) for run in self.runs],
        }

    def _scores(self) -> list[dict[str, Any]]:
        """Each quantity of each reference, with what was found mesh by mesh."""
        by_mesh = zip(*(run.level.scores for run in self.meshes), strict=True)
        return [
            {
                **{key: value for key, value in asdict(scores[-1]).items() if key not in ("found", "difference")},
                "found": [item.found for item in scores],
                "difference": [item.difference for item in scores],
                "holds": all(item.holds for item in scores),
            }
            for scores in by_mesh
        ]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Reproduction:
    """The problems of the paper, carried out.

    Parameters
    ----------
    problems : in the order of the paper
    refine : parts into which the elements were cut, mesh by mesh
    """

    problems: tuple[Reproduced, ...]
    refine: tuple[int, ...]

    def __repr__(self) -> str:
        """One line: how many of them are reproduced."""
        done = sum(item.reproduced for item in self.problems)
        return f"<Reproduction of {len(self.problems)} problems: {done} certified, with all references met>"

    @property
    def reproduced(self) -> bool:
        """Whether all is certified and every judged reference holds."""
        return all(item.reproduced for item in self.problems)

    @cached_property
    def _record(self) -> dict[str, Any]:
        return {
            "reproduced": self.reproduced,
            "refine": list(self.refine),
            "problems": [item.to_dict() for item in self.problems],
            "versions": versions(),
            "seconds": sum(sum(run.level.answer.seconds.values()) for item in self.problems for run in item.runs),
        }

    def to_dict(self) -> dict[str, Any]:
        """Give all of it as numbers, lists and texts, ready for JSON: what stands in numbers.json."""
        return self._record

    def to_json(self, indent: int | None = 2) -> str:
        """Write `to_dict` as JSON; every number in it is finite."""
        return json.dumps(self.to_dict(), indent=indent, allow_nan=False, ensure_ascii=False)
