"""Results for tests of pages, tables and folders: of one load, of load cases, infinite, condensed."""

from functools import cache

from mesh_studies import punch, roller
from tool_problems import FREE, FREE_CASES, made

import bemcontact
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result


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


EACH = {"roller": rolled, "punch": punched, "condensed": condensed, "cases": cases}
