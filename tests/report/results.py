"""Results for tests of pages, tables and folders: of one load, of load cases, infinite, condensed."""

from functools import cache
from pathlib import Path

from mesh_studies import punch, roller
from tool_problems import FREE, FREE_CASES, made

import bemcontact
from bemcontact import GapDesign, ParameterPath
from bemcontact.analysis.case_comparisons import CaseComparisons, compare_cases
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.options import ComparisonOptions

MODELS = Path(__file__).parents[2] / "models"
LINK = bemcontact.load(MODELS / "gallery" / "three_zones.yaml", variant="stated mesh")


@cache
def rolled() -> Result:
    """A roller on a plane, with error bars."""
    return bemcontact.solve(roller(mesh={"adapt": True}, accuracy=0.05))


@cache
def punched() -> Result:
    """A block under a sharp punch: the pressure at its edge is infinite."""
    return bemcontact.solve(punch())


@cache
def condensed() -> Result:
    """A result without a body."""
    return bemcontact.solve(rolled().contact)


@cache
def cases() -> CaseResults:
    """A block between tools under load cases."""
    return bemcontact.solve_cases(made(FREE, **FREE_CASES))


@cache
def followed() -> ParameterPath:
    """A roller on a plane that is pressed more and more."""
    return bemcontact.follow(roller(), "conditions.top.pressure", 1.0, start=0.0)


@cache
def designed() -> GapDesign:
    """A relief of a flat punch, with a limit of stress that it reaches."""
    problem = bemcontact.load(MODELS / "gallery" / "flat_punch.yaml", variant="stated mesh")
    operator = bemcontact.stress_operator(problem, [[2.0, -2.0]])
    bounds = bemcontact.Relief(lower=0, upper=0.01, slope=0.003)
    return bemcontact.design_gap(operator.contact, bounds, stress=operator, von_mises=95)


@cache
def compared_cases() -> CaseComparisons:
    """The block between tools, by QP3 and directly."""
    return compare_cases(ComparisonOptions.of(["qp3"]), made(FREE, **FREE_CASES))


@cache
def linked() -> ParameterPath:
    """The link on three surfaces, from no load to its load."""
    return bemcontact.follow(LINK, "conditions.loaded.pressure", 20, start=0)


EACH = {"roller": rolled, "punch": punched, "condensed": condensed, "cases": cases}
SPEC = "name: <x>  # " + "long " * 60
"""The text of a problem, to be shown on a page."""
