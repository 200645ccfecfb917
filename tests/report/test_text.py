"""Words and tables: the numbers in them are those of the result, and a user's text stays what it is."""

import dataclasses
import re
from functools import cache
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mesh_studies import on_one_mesh
from messages import assert_states
from rich.console import Console, RenderableType
from several_bodies import HELD as LOW
from several_bodies import block as several_block
from several_bodies import elastic
from tool_problems import BETWEEN, FREE, FREE_CASES, HELD, HELD_CASES, made, not_met

import bemcontact
from bemcontact.analysis import solve as analysis
from bemcontact.analysis.check import check
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.assessment.certificate import HEADINGS, CertificateKind
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import LocalSearch, Penalty, Status
from bemcontact.problems import Problem, Units
from bemcontact.report import comparison_text, contact_words, formatting, problem_text, text
from bemcontact.report.contact_words import units_of
from bemcontact.report.facts import facts, zone_forces
from bemcontact.report.verdicts import shortfall

GALLERY = Path(__file__).parents[2] / "models" / "gallery"


def block() -> Problem:
    """A block on a table under uniform pressure 3: so is its contact pressure; its height is free."""
    corners = {"bottom": [0, 0], "right": [40, 0], "top": [40, 20], "left": [0, 20]}
    return Problem(
        name="block",
        units={"length": "mm", "force": "N"},
        material={"young_modulus": 210e3, "poisson_ratio": 0.3},
        boundary={"outer": [{"name": key, "start": start, "elements": 2} for key, start in corners.items()]},
        conditions={"left": {"displacement": {"x": 0}}, "top": {"pressure": 3}},
        contact_zones={"foot": {"edges": "bottom", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
    )  # pyright: ignore


@pytest.fixture(scope="module")
def result() -> analysis.Result:
    return analysis.solve(block().with_value("accuracy", 0.01).with_value("mesh.adapt", False))


def printed(renderable: RenderableType, width: int = 100) -> str:
    stream = StringIO()
    Console(file=stream, width=width, markup=False, highlight=False).print(renderable)
    return stream.getvalue()


def test_problem_summary_states_the_facts():
    lines = printed(problem_text.problem_summary(check(block()))).splitlines()
    facts = {line[:20].strip(): line[20:].strip() for line in lines if line[18:20] == "  "}
    assert facts["Material"] == "E = 210000 MPa, Poisson's ratio 0.3, plane strain"
    assert facts["Mesh"] == "8 elements, 16 nodes, 5 contact points"
    assert facts["Degrees of freedom"] == "32"
    assert facts["Total load"] == "(0, -120) N/mm, without reactions"  # 3 MPa on 40 mm
    assert facts["Held by contact"] == "translation along (0, 1)"
    assert any(line.split() == ["left", "line", "20", "mm", "2", "u_x", "=", "0"] for line in lines)
    assert any(line.split() == ["right", "line", "20", "mm", "2", "free"] for line in lines)


def whole_roller(*, bonded: bool) -> Problem:
    """A roller on a glued block, both whole: the roller is free in three ways. Or it has a flat side that is bonded."""
    corners = {"bottom": (-9, -5), "right": (9, -5), "top": (9, 0), "left": (-9, 0)}
    rim = {"name": "rim", "kind": "arc", "center": (0, 5), "radius": 5, "angles": (-90, 270)}
    cap = {"flat": (-9, 0), "side": (9, 0), "roof": (9, 3), "back": (-9, 3)}
    own = [{"name": name, "start": at} for name, at in cap.items()] if bonded else [rim]
    steel = {"young_modulus": 210e3, "poisson_ratio": 0.3}
    plane = {"edges": "roller/roof", "surface": {"kind": "plane", "point": (0, 3.1), "normal": (0, -1)}}
    more = {"bonded": {"glue": ("roller/flat", "block/top")}, "contact_zones": {"lid": plane}}
    return Problem(
        name="roller", accuracy=0.05,
        bodies={
            "block": {
                "material": steel, "boundary": {"outer": [{"name": name, "start": at} for name, at in corners.items()]},
                "conditions": {"bottom": {"fixed": True}},
            },
            "roller": {
                "material": steel, "boundary": {"outer": own},
                "loads": {"gravity": {"density": 1e-3, "acceleration": (0, -1)}},
            },
        },
        **(more if bonded else {"contacts": {"track": {"between": ("roller", "block")}}}),
    )  # pyright: ignore  # fmt: skip


def test_what_holds_several_bodies_is_told():
    """The block is held in all ways and the roller in none; contact holds two of them, and nothing spins it.

    Of a bonded body the bond holds all three.
    """
    lines = printed(problem_text.problem_summary(check(whole_roller(bonded=False)))).splitlines()
    held = [line.strip().split(maxsplit=3) for line in lines if line.startswith("Held by")]
    assert held[0] == ["Held", "by", "conditions", "all rigid motions except those below"]
    assert [line[2] for line in held[1:]] == ["contact", "contact"]
    facts = printed(problem_text.problem_summary(check(whole_roller(bonded=True))))
    assert "Held by bonds       3 rigid motions of bonded bodies" in facts
    assert "Held by contact" not in facts


def test_result_summary_states_the_facts(result: analysis.Result):
    answer = printed(text.result_summary(result))
    assert "foot: (0, 0) to (40, 0) mm, 40 mm long" in answer
    assert "3.00000 ± 0.00003 MPa all along the contact" in answer
    assert "per UNDEFORMED length" in answer
    assert "(0, 120.0000) ± 0.0012 N/mm, of the rigid surfaces on the body" in answer
    assert "Equations      unique solution proved." in answer
    assert "Mesh           error at most 0.001 % (asked 1 %)." in answer
    assert "certified" not in answer
    assert result.certificate.words.split(".")[0] in " ".join(answer.split())


def test_a_result_that_is_not_certified_states_so(result: analysis.Result):
    certificate = dataclasses.replace(
        result.certificate,
        kind=CertificateKind.LOCAL,
        heading=HEADINGS[CertificateKind.LOCAL],
        words="Another may exist.",
    )
    solution = dataclasses.replace(result.solution, status=Status.ITERATION_LIMIT)
    doubtful = dataclasses.replace(result, certificate=certificate, solution=solution)
    assert_states(shortfall(doubtful), f"Equations: local only … {Status.ITERATION_LIMIT.words} … Another may exist.")
    assert "Equations      local only." in printed(text.result_summary(doubtful))


def test_loads_that_deflect_a_contour_are_reported():
    zone = {"edges": ["bottom"], "surface": {"kind": "deflected_contour", "direction": [0, 1], "conditions": {
        "top": {"displacement": {"x": 0, "y": -0.25}}, "right": {"traction": {"x": 3}},
    }}}  # fmt: skip
    answer = printed(problem_text.problem_summary(check(block().with_value("contact_zones.foot", zone))))
    assert "own contour, deflected; gap along (0, 1)" in answer
    assert "of foot, deflected by top u_x = 0, u_y = -0.25 mm; right t_x = 3 MPa" in answer


def test_all_notes_of_a_result_are_printed(result: analysis.Result):
    noted = dataclasses.replace(result, notes=("the first thing", "the second thing"))
    notes = [line.split(maxsplit=1)[1] for line in printed(text.result_summary(noted)).splitlines() if "Note" in line]
    assert [note.strip() for note in notes] == ["the first thing", "the second thing"]


SEARCH = LocalSearch(
    start="null vector",
    phase_one_iterations=1,
    phase_two_iterations=135,
    working_set_changes=152,
    inertia=(89, 0, 1),
    reduced_inertia_start=(3, 0, 1),
    reduced_inertia_end=(0, 0, 0),
    weakly_active=0,
    objective=0.0,
)
PENALTY = Penalty(value=1.0, raw=833.41, convexity_limit=13.007, convexity_limit_raw=10840.0, dimension="p/L²")


def test_a_search_is_reported_with_both_phases_and_all_inertias(result: analysis.Result):
    words = contact_words.search_in_words(SEARCH, result.contact)
    assert_states(words, "null vector: 136 iterations … 1 … 135 … 152 changes … whole Hessian: 89 positive, 1 negative")
    assert_states(words, "reduced Hessian: 3 positive, 1 negative at the feasible point, none at the end")


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({}, "penalty 1 (833.41 N/mm⁴), … up to 13.007 (10840 N/mm⁴)"),
        ({"dimension": "1/p"}, "penalty 1 (833.41 mm²/N), … up to 13.007 (10840 mm²/N)"),
        (
            {"convexity_limit": None, "convexity_limit_raw": None},
            "penalty 1 (833.41 N/mm⁴), … for every penalty",
        ),
        ({"convexity_limit": 0.0, "convexity_limit_raw": 0.0}, "penalty 1 (833.41 N/mm⁴), convex for no penalty"),
    ],
)
def test_a_penalty_is_reported_in_units(result: analysis.Result, changes: dict, sentence: str):
    """(1/μ) p² is p L² for the stiffness rows, so that μ is force over L⁴; (1/μ) L² for the others, L² over force."""
    search = dataclasses.replace(SEARCH, penalty=dataclasses.replace(PENALTY, **changes))
    assert_states(contact_words.search_in_words(search, result.contact), sentence)


def test_a_penalty_of_a_held_body_without_units(result: analysis.Result):
    held = CondensedContact.from_compliance([[2.0]], [-3.0])
    told = contact_words.search_in_words(dataclasses.replace(SEARCH, penalty=PENALTY), held)
    raw = "in the units of the problem"
    assert told.endswith(f"; penalty 1 (833.41 {raw}), convex up to 13.007 (10840 {raw})")


def test_contact_at_one_point_and_all_round_is_stated_so(result: analysis.Result):
    """An interval that ends where it starts, and has a length, goes all round."""
    (interval,) = result.footprint.intervals
    point = dataclasses.replace(interval, start=interval.end, start_arc=interval.end_arc)
    at_point = dataclasses.replace(result, footprint=dataclasses.replace(result.footprint, intervals=(point,)))
    assert "foot: at the point (40, 0) mm alone" in printed(text.result_summary(at_point))
    closed = dataclasses.replace(interval, end=interval.start)
    around = dataclasses.replace(result, footprint=dataclasses.replace(result.footprint, intervals=(closed,)))
    assert "foot: all round, 40 mm" in printed(text.result_summary(around))


def test_round_off_in_a_resultant_is_zero(result: analysis.Result):
    """A resultant of 1e-13 is nothing beside the 120 N/mm that press."""
    resultant = dataclasses.replace(result.footprint.resultant, force=(1e-13, -2e-13))
    balanced = dataclasses.replace(result, footprint=dataclasses.replace(result.footprint, resultant=resultant))
    assert "(0, 0) N/mm, of the rigid surfaces" in printed(text.result_summary(balanced))


def test_each_number_of_the_certificate_is_stated_once(result: analysis.Result):
    answer = " ".join(printed(text.result_summary(result)).split())
    assert answer.count("eigenvalue") == 1
    assert answer.count("of the peak from") == 1


@pytest.mark.parametrize(("seconds", "written"), [(0.04, "0.04 s"), (9.94, "9.9 s"), (104.0, "104 s")])
def test_seconds_have_no_exponent(result: analysis.Result, seconds: float, written: str):
    assert printed(text.result_summary(dataclasses.replace(result, seconds={"all": seconds}))).count(written) == 1


def test_volume_loads_are_listed():
    gravity, spin = {"density": 1, "acceleration": [0, -9.81]}, {"density": 1, "angular_velocity": 5, "center": [1, 30]}
    heat = {"expansion": 1e-5, "change": {"constant": 20, "y": 0.5}}  # y from 0 to 20
    loads = {"gravity": gravity, "centrifugal": spin, "temperature": heat}
    problem = Problem(**{**block().model_dump(), "loads": loads})
    lines = [
        "gravity (0, -9.81), density 1",
        "rotation 5 about (1, 30), density 1",
        "temperature change 20 … 30, expansion 1e-05",
    ]
    assert [*formatting.volume_loads(problem)] == lines
    answer = printed(problem_text.problem_summary(check(problem)))
    assert all(line in answer for line in lines)


def test_no_contact_is_stated(result: analysis.Result):
    footprint = dataclasses.replace(result.footprint, intervals=(), peak=None)
    answer = printed(text.result_summary(dataclasses.replace(result, footprint=footprint)))
    assert "nowhere" in answer
    assert "Peak" not in answer


@pytest.mark.parametrize("width", [60, 100, 200])
def test_tables_keep_within_the_width_and_100_columns(result: analysis.Result, width: int):
    for renderable in (text.result_summary(result), problem_text.problem_summary(check(block()))):
        assert max(map(len, printed(renderable, width).splitlines())) <= min(width, 100)


def test_markup_in_a_name_stays_text(result: analysis.Result):
    name = "a [red]block[/red] [/b]"
    renamed = dataclasses.replace(result, contact=dataclasses.replace(result.contact, name=name), notes=("[/i] note",))
    answer = printed(text.result_summary(renamed))
    assert name in answer
    assert "[/i] note" in answer


UNITS = {"units": {"length": "mm", "force": "N"}}


@cache
def all_cases() -> CaseResults:
    return not_met(bemcontact.solve_cases(made(FREE, **FREE_CASES, **UNITS)))


def shown(renderable: RenderableType, width: int = 160) -> str:
    stream = StringIO()
    Console(file=stream, width=width, markup=False, highlight=False).print(renderable)
    return stream.getvalue()


def rows_of(text: str) -> dict[str, str]:
    """First lines that begin with the name of a case: those of the upper table."""
    lines = [line for line in text.splitlines() if line.split() and line.split()[0] in all_cases().results]
    return {line.split()[0]: line for line in reversed(lines)}


def test_each_case_has_a_row_with_its_own_numbers():
    lines = rows_of(shown(text.cases_summary(all_cases())))
    assert {*lines} == {"wind", "heat", "push", "all"}
    for name, result in all_cases().results.items():
        peak = result.footprint.peak
        assert peak is not None
        value, bar = lines[name].split(" MPa")[0].rsplit("  ", 1)[-1].split(" ± ")
        assert abs(float(value) - peak.pressure) <= float(bar)
        assert "  not met: " in lines[name]


@pytest.mark.parametrize("model", ["hertz_small", "three_zones"])
def test_each_case_has_the_errors_of_its_ends_of_contact(model):
    """The same text as the table of one case; where there are several zones, without places."""
    one = bemcontact.solve(bemcontact.load(GALLERY / f"{model}.yaml").with_value("accuracy", 0.1))
    told = shown(text.cases_summary(CaseResults(name="two", results={"a": one, "b": one}, seconds={})), 300)
    contact = [value for name, value in facts(one.to_dict(), units_of(one.contact)) if name == "Contact"]
    ends = [value.partition(", ends ")[2] for value in contact]
    assert any(ends)
    for value, error in zip(contact, ends, strict=True):
        place = value.partition(": ")[2] if len(one.contact.zone_names) == 1 else f"ends {error}"
        assert told.count(place) >= 2


def test_each_case_has_its_own_rotations():
    """Of a block that presses tilt; one that is the same in all cases is told once, as a note is."""
    raised = bemcontact.load(GALLERY / "body_between_two_tools.yaml")
    results = bemcontact.solve_cases(raised)
    told = " ".join(shown(text.cases_summary(results), 400).split())
    for name, result in results.results.items():
        (angle,) = (words for of, words in facts(result.to_dict(), units_of(result.contact)) if of == "Rotation")
        assert f"Rotation {name}: {angle}" in told
    one = bemcontact.solve(raised, case="raised")
    told = shown(text.cases_summary(CaseResults(name="two", results={"a": one, "b": one}, seconds={})), 400)
    (angle,) = (words for of, words in facts(one.to_dict(), units_of(one.contact)) if of == "Rotation")
    assert told.count(angle) == 1


@pytest.mark.parametrize("radius", [10.0, 1e-3])
@pytest.mark.parametrize("center", [0.0, 1000.0])
@pytest.mark.parametrize("pressed_by", ["gravity", "tool"])
def test_a_symmetric_roller_has_no_angle(radius: float, center: float, pressed_by: str):
    """It may roll on the plane by any angle, and no number is printed. A plate on its top is held by its levers.

    The angle of that is zero by symmetry, and round-off of coordinates in numbers, of either sense: it is printed as 0.
    """
    plane = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    load: dict = {"loads": {"gravity": {"density": 0.01, "acceleration": [0, -1]}}}
    zones = {"rim": {"edges": "rim", "surface": plane}}
    if pressed_by == "tool":
        zones["top"] = {"edges": "top", "surface": {"kind": "plane", "point": [0, 2 * radius], "normal": [0, -1]}}
        load = {"tools": {"top": {"zones": "top", "point": [center, 2 * radius], "force": {"y": -radius, "moment": 0}}}}
    arcs = {"rim": [180, 360], "top": [0, 180]}
    roller = Problem(
        name="roller", material={"young_modulus": 210e3, "poisson_ratio": 0.3}, contact_zones=zones, accuracy=0.05,
        boundary={"outer": [{"name": name, "kind": "arc", "center": [center, radius], "radius": radius, "angles": at}
                            for name, at in arcs.items()]}, **load,
    )  # pyright: ignore  # fmt: skip
    result = bemcontact.solve(roller)
    listed = [value for name, value in facts(result.to_dict(), Units()) if name in ("Rotation", "Tool")]
    assert ": not known; only slopes and levers as drawn" in listed[0]
    assert "clockwise" not in listed[0]
    turns = [text.partition("turns by ")[2].partition(";")[0] for text in listed[1:]]
    assert turns == ["0"] * (pressed_by == "tool")
    assert not [bar for bar in result.accuracy.bars if bar.quantity == "rotation"]


def test_the_forces_of_load_cases_of_several_bodies_are_those_on_a_named_one():
    """No body is "the body" there; of one body it is."""
    bodies = {
        "up": elastic(several_block((0, 2), (0, 1), (2,) * 4)),
        "low": elastic(several_block((0, 2), (-1, 0)), LOW),
    }
    spec = Problem(
        name="two", bodies=bodies, contacts={"face": {"between": ["up/bottom", "low/top"]}}, accuracy=0.1,
        load_cases={name: {"conditions": {"up/top": {"pressure": p}}} for name, p in (("one", 1), ("two", 2))},
    )  # pyright: ignore  # fmt: skip
    lines = shown(text.cases_summary(bemcontact.solve_cases(spec))).splitlines()
    assert not any("force on the body" in line for line in lines)
    assert sum("(0, 2.00" in line and " on up" in line for line in lines) == 1
    assert sum("(0, 4.00" in line and " on up" in line for line in lines) == 1
    assert "force on the body" in shown(text.cases_summary(all_cases()))


def test_the_worst_case_is_named():
    told = shown(text.cases_summary(all_cases()))
    assert_states(told, f"in {all_cases().worst}; … UNDEFORMED length")
    whole = {name: dataclasses.replace(it, penetration=None) for name, it in all_cases().results.items()}
    told = shown(text.cases_summary(dataclasses.replace(all_cases(), results=whole)))
    assert "unique solution proved. In every load case." in told


def test_a_note_of_all_cases_is_reported_once_and_one_of_some_with_their_names():
    one = all_cases().results["wind"]
    results = {**all_cases().results, "wind": dataclasses.replace(one, notes=(*one.notes, "the wind turns"))}
    told = shown(text.cases_summary(dataclasses.replace(all_cases(), results=results)))
    assert " ".join(told.split()).count("it is held at zero") == 1
    assert "wind: the wind turns" in told


def test_a_case_that_is_not_certified_is_reported_with_the_reason():
    one = all_cases().results["heat"]
    doubtful = dataclasses.replace(
        one.certificate,
        kind=CertificateKind.NOT_A_SOLUTION,
        heading=HEADINGS[CertificateKind.NOT_A_SOLUTION],
        words="Pressures pull.",
    )
    results = {**all_cases().results, "heat": dataclasses.replace(one, certificate=doubtful, penetration=None)}
    told = shown(text.cases_summary(dataclasses.replace(all_cases(), results=results)))
    assert " not solved " in rows_of(told)["heat"]
    assert "heat: Pressures pull." in " ".join(told.split())


def test_of_several_zones_the_force_of_each_is_reported():
    """A press of 40 on a free block above a table: 40 down on top, 40 up below; nothing is left of both."""
    tools = {"press": {"zones": "press", "force": {"y": -40}}}
    problem = made(BETWEEN, tools=tools, load_cases={"more": {"tools": {"press": {"force": {"y": -10}}}}}, **UNITS)
    told = shown(text.result_summary(bemcontact.solve(problem.with_case("more")))).split()
    assert "Resultant (0, 0) N/mm, of the rigid surfaces" in " ".join(told)
    assert "Resultant of table: (0, 50) N/mm Resultant of press: (0, -50) N/mm" in " ".join(told)
    listed = " ".join(shown(text.cases_summary(bemcontact.solve_cases(problem))).split())
    assert_states(listed, "more table (0, 50) N/mm … press (0, -50) N/mm")


@given(st.floats(1e-3, 0.3), st.floats(-1e5, 1e5), st.floats(1e-3, 1e5))
def test_a_force_has_no_digit_beyond_its_error(bar: float, x: float, y: float):
    """The error that is written is not smaller than the bar, and twice it at most; the force is within half a digit."""
    record = {
        "forces": {"foot": (x, y)}, "intervals": [{"zone": "foot"}], "tributary_lengths": [1.0],
        "pressure": [np.hypot(x, y)],
        "accuracy": {"bars": [{"quantity": "force", "zone": "foot", "value": np.hypot(x, y), "bar": bar}]},
    }  # fmt: skip
    written = zone_forces(record, Units())["foot"]
    x_written, y_written, error = map(float, re.findall(r"-?[\d.]+(?:e-\d+)?", written.split(")e")[0]))
    power = 10.0 ** int(written.rpartition(")e")[2] or 0) if ")e" in written else 1.0
    size = np.hypot(x, y)
    assert bar * size * (1 - 1e-6) <= error * power <= 2 * bar * size
    assert max(abs(x_written * power - x), abs(y_written * power - y)) <= 0.5001 * error * power


def test_without_contact_no_case_is_the_worst():
    """A table far below a held block, and no load."""
    far = {"table": {"edges": "foot", "surface": {"kind": "plane", "point": [0, -9], "normal": [0, 1]}}}
    case = {"light": {"conditions": {"top": {"pressure": 1e-3}}}}
    none = bemcontact.solve_cases(made(HELD, contact_zones=far, tools={}, load_cases=case))
    told = shown(text.cases_summary(none))
    assert none.worst is None
    assert "nowhere" in told
    assert "Largest peak" not in told


def test_check_shows_tools_cases_and_combinations():
    told = shown(problem_text.problem_summary(check(made(HELD, **HELD_CASES))))
    assert "punch, the surface of punch: loaded by y = -40, moment = 3" in told
    assert "table, the surface of table: displaced by y = 0.002, rotation = 0.001" in told
    assert "wind: changes right, top" in told
    assert "push: changes punch, table" in told
    assert "heat: changes temperature" in told
    assert "all: 1.5 wind + -0.5 heat + 2 settle + 4 spin + 0.7 push" in told
    assert "rotation counterclockwise about (1.5, 1) of the tool 'punch'" in told


def test_check_shows_the_case_of_a_reference():
    reference = {"it": {"kind": "uniform", "pressure": 1, "zone": "table", "case": "wind"}}
    told = shown(problem_text.problem_summary(check(made(HELD, **HELD_CASES, reference=reference))))
    assert "it: closed form, uniform, load case 'wind'" in told


def test_solve_shows_where_the_tools_are_and_what_presses_on_them():
    """Nothing holds the block but a table and the punch: 40 and 3 on the punch are held up by -40 and -3."""
    result = bemcontact.solve(made(FREE, **UNITS))
    told = " ".join(shown(text.result_summary(result)).split())
    x, y, turn = result.contact.tools.displacement(result.solution.rigid_amplitudes)[0]
    assert f"punch: moves by {formatting.vector((x, y), 'mm')}, turns by {formatting.number(turn)} rad" in told
    assert "the body presses on it with (0, 40) N/mm, moment -3 N·mm/mm about (1.5, 1)" in told


@pytest.mark.parametrize("width", [100, 60])
def test_no_line_is_wider_than_the_terminal(width: int):
    lines = shown(text.cases_summary(all_cases()), width).splitlines()
    assert max(map(len, lines)) <= width


def test_check_shows_the_factors_of_the_acting_case():
    """all: 1.5 wind - 0.5 heat + 2 settle + 4 spin + 0.7 push; on the punch -40 - 0.7 · 30 and 3 - 0.7 · 4."""
    told = shown(problem_text.problem_summary(check(made(HELD, **HELD_CASES, case="all"))))
    assert told.startswith("held block, all\n")
    assert "pressure 2, t_x = 1 (1.5 wind), t_y = -2 (1.5 wind)" in told
    assert "temperature change 20 … 50, expansion 1e-05 (-0.5 heat)" in told
    assert "punch, the surface of punch: loaded by y = -61, moment = 0.2" in told
    assert "table, the surface of table: displaced by y = 0.004, rotation = 0.00065" in told


def test_the_words_of_the_tables_of_a_comparison_are_explained_below_them():
    """Each column whose name is no plain word."""
    told = " ".join(printed(comparison_text.mesh_study_summary(on_one_mesh())).split())
    for word in (
        "objective:",
        "difference:",
        "unpolished:",
        "Hessian, and reduced to",
        "convex in equilibrium:",
        "μ is",
    ):
        assert word in told
