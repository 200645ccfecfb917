"""The table of load cases, and what check and solve say of tools: the numbers are those of the results."""

import dataclasses
from functools import cache
from io import StringIO

import pytest
from rich.console import Console, RenderableType
from tool_problems import BETWEEN, FREE, FREE_CASES, HELD, HELD_CASES, made

import bemcontact
from bemcontact.analysis.check import check
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.assessment.certificate import CertificateKind
from bemcontact.report import formatting, text

UNITS = {"units": {"length": "mm", "force": "N"}}


@cache
def found() -> CaseResults:
    return bemcontact.solve_cases(made(FREE, **FREE_CASES, **UNITS))


def printed(renderable: RenderableType, width: int = 160) -> str:
    stream = StringIO()
    Console(file=stream, width=width, markup=False, highlight=False).print(renderable)
    return stream.getvalue()


def rows(text: str) -> dict[str, str]:
    """Lines that begin with the name of a case."""
    return {line.split()[0]: line for line in text.splitlines() if line.split() and line.split()[0] in found().results}


def test_each_case_has_a_row_with_its_own_numbers():
    lines = rows(printed(text.cases_summary(found())))
    assert [*lines] == ["wind", "heat", "push", "all"]
    for name, result in found().results.items():
        peak = result.footprint.peak
        assert peak is not None
        assert f"{formatting.number(peak.pressure)} N/mm²" in lines[name]
        assert "certified" in lines[name]


def test_the_worst_case_is_named():
    told = printed(text.cases_summary(found()))
    assert f"in {found().worst}; pressures are per UNDEFORMED length" in told
    assert "all certified." in told


def test_a_note_of_all_cases_is_reported_once_and_one_of_some_with_their_names():
    one = found().results["wind"]
    results = {**found().results, "wind": dataclasses.replace(one, notes=(*one.notes, "the wind turns"))}
    told = printed(text.cases_summary(dataclasses.replace(found(), results=results)))
    assert " ".join(told.split()).count("the body is pinned against it") == 1
    assert "wind: the wind turns" in told


def test_a_case_that_is_not_certified_is_reported_with_the_reason():
    one = found().results["heat"]
    doubtful = dataclasses.replace(one.certificate, kind=CertificateKind.NOT_A_SOLUTION, words="Pressures pull.")
    results = {**found().results, "heat": dataclasses.replace(one, certificate=doubtful)}
    told = printed(text.cases_summary(dataclasses.replace(found(), results=results)))
    assert "NOT certified" in rows(told)["heat"]
    assert "NOT all certified. heat: Pressures pull." in told


def test_of_several_zones_the_force_of_each_is_reported():
    """A press of 40 on a free block above a table: 40 down on top, 40 up below; nothing is left of both."""
    tools = {"press": {"zones": "press", "force": {"y": -40}}}
    problem = made(BETWEEN, tools=tools, load_cases={"more": {"tools": {"press": {"force": {"y": -10}}}}}, **UNITS)
    told = printed(text.result_summary(bemcontact.solve(problem.with_case("more")))).split()
    assert "Resultant (0, 0) N/mm, of the rigid surfaces" in " ".join(told)
    assert "Resultant of table: (0, 50) N/mm Resultant of press: (0, -50) N/mm" in " ".join(told)
    listed = printed(text.cases_summary(bemcontact.solve_cases(problem)))
    assert "table: (0, 50) N/mm" in listed
    assert "press: (0, -50) N/mm" in listed


def test_where_nothing_touches_nothing_is_worst():
    """A table far below a held block, and no load."""
    far = {"table": {"edges": "foot", "surface": {"kind": "plane", "point": [0, -9], "normal": [0, 1]}}}
    case = {"light": {"conditions": {"top": {"pressure": 1e-3}}}}
    none = bemcontact.solve_cases(made(HELD, contact_zones=far, tools={}, load_cases=case))
    told = printed(text.cases_summary(none))
    assert none.worst is None
    assert "nowhere" in told
    assert "Largest peak" not in told


def test_check_shows_tools_cases_and_combinations():
    told = printed(text.problem_summary(check(made(HELD, **HELD_CASES))))
    assert "punch, the surface of punch: loaded by y = -40, moment = 3" in told
    assert "table, the surface of table: displaced by y = 0.002, rotation = 0.001" in told
    assert "wind: changes right, top" in told
    assert "push: changes punch, table" in told
    assert "heat: changes temperature" in told
    assert "all: 1.5 wind + -0.5 heat + 2 settle + 4 spin + 0.7 push" in told
    assert "rotation counterclockwise about (1.5, 1) of the tool 'punch'" in told


def test_check_shows_of_which_case_a_reference_is():
    reference = {"it": {"kind": "uniform", "pressure": 1, "zone": "table", "case": "wind"}}
    told = printed(text.problem_summary(check(made(HELD, **HELD_CASES, reference=reference))))
    assert "it: closed form, uniform, load case 'wind'" in told


def test_solve_shows_where_the_tools_are_and_what_presses_on_them():
    """Nothing holds the block but a table and the punch: 40 and 3 on the punch are held up by -40 and -3."""
    result = bemcontact.solve(made(FREE, **UNITS))
    told = " ".join(printed(text.result_summary(result)).split())
    x, y, turn = result.contact.tools.displacement(result.solution.rigid_amplitudes)[0]
    assert f"punch: moves by {formatting.vector((x, y), 'mm')}, turns by {formatting.number(turn)}" in told
    assert "the body presses on it with (0, 40) N/mm, moment -3 N about (1.5, 1)" in told


@pytest.mark.parametrize("width", [100, 60])
def test_no_line_is_wider_than_the_terminal(width: int):
    lines = printed(text.cases_summary(found()), width).splitlines()
    assert max(map(len, lines)) <= width


def test_check_shows_of_the_case_that_acts_what_it_adds_by_which_factor():
    """all: 1.5 wind - 0.5 heat + 2 settle + 4 spin + 0.7 push; on the punch -40 - 0.7 · 30 and 3 - 0.7 · 4."""
    told = printed(text.problem_summary(check(made(HELD, **HELD_CASES, case="all"))))
    assert told.startswith("held block, all\n")
    assert "pressure 2, t_x = 1 (1.5 wind), t_y = -2 (1.5 wind)" in told
    assert "temperature change 20 … 50 (-0.5 heat)" in told
    assert "punch, the surface of punch: loaded by y = -61, moment = 0.2" in told
    assert "table, the surface of table: displaced by y = 0.004, rotation = 0.00065" in told
