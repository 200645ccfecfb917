"""Words and tables: the numbers in them are those of the result, and a user's text stays what it is."""

import dataclasses
from io import StringIO

import numpy as np
import pytest
from rich.console import Console, RenderableType

from bemcontact import analysis
from bemcontact.assessment.certificate import CertificateKind
from bemcontact.bem.condense import body_of
from bemcontact.contact import Status
from bemcontact.problem import Circle, Field, Plane, Polyline, Problem, Units
from bemcontact.report import text


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
    return analysis.solve(block())


def printed(renderable: RenderableType, width: int = 100) -> str:
    stream = StringIO()
    Console(file=stream, width=width, markup=False, highlight=False).print(renderable)
    return stream.getvalue()


def test_numbers_and_vectors():
    assert text.number(183.3349) == "183.33"
    assert text.number(-0.0) == "0"
    assert text.number(2e-7) == "2e-07"
    assert text.vector((1.0, -1e-15)) == "(1, 0)"
    assert text.vector((0.0, 0.0), "mm") == "(0, 0) mm"
    assert text.with_unit("3", "") == "3"
    assert text.with_unit("0", "mm") == "0"


def test_fields_are_said_by_their_values_on_the_edge():
    bottom = block().edge("bottom")  # from x = 0 to 40
    assert text.field_on(Field(constant=2.5), bottom, "mm") == "2.5 mm"
    assert text.field_on(Field(constant=1, x=0.5), bottom) == "1 … 21"
    assert text.field_on(Field(constant=0), bottom, "mm") == "0"


def test_surfaces_in_words():
    plane = Plane(kind="plane", point=(0, 0), normal=(0, 5))
    assert text.surface_in_words(plane) == "plane through (0, 0), normal (0, 1)"
    circle = Circle(kind="circle", center=(1, 2), radius=3, body="inside")
    assert text.surface_in_words(circle) == "circle about (1, 2), radius 3, body inside"
    polyline = Polyline(kind="polyline", points=((0, 0), (1, 0), (2, 1)))
    assert text.surface_in_words(polyline) == "polyline of 3 points from (0, 0) to (2, 1)"


def test_unit_labels():
    assert text.per_thickness(Units(length="mm", force="N")) == "N/mm"
    assert text.per_thickness(Units(length="mm")) == ""


def test_problem_summary_says_what_is_there():
    lines = printed(text.problem_summary(body_of(block()))).splitlines()
    facts = {line[:20].strip(): line[20:].strip() for line in lines if line[18:20] == "  "}
    assert facts["Material"] == "E = 2.1e+05 N/mm², ν = 0.3, plane strain"
    assert facts["Mesh"] == "8 elements, 16 nodes, 5 contact points"
    assert facts["Degrees of freedom"] == "32"
    assert facts["Total load"] == "(0, -120) N/mm, reactions not counted"  # 3 N/mm² on 40 mm
    assert facts["Held by contact"] == "translation along (0, 1)"
    assert any(line.split() == ["left", "line", "20", "mm", "2", "u_x", "=", "0"] for line in lines)
    assert any(line.split() == ["right", "line", "20", "mm", "2", "free"] for line in lines)


def test_result_summary_says_what_was_found(result: analysis.Result):
    answer = printed(text.result_summary(result))
    assert "foot: (0, 0) to (40, 0) mm, 40 mm long" in answer
    assert "3 N/mm² at" in answer
    assert "per UNDEFORMED length" in answer
    assert "(0, 120) N/mm, of the rigid surfaces on the body" in answer
    assert "certified" in answer
    assert "NOT certified" not in answer
    assert result.certificate.words.split(".")[0] in " ".join(answer.split())


def test_a_result_that_is_not_certified_says_so(result: analysis.Result):
    certificate = dataclasses.replace(result.certificate, kind=CertificateKind.LOCAL, words="Another may exist.")
    solution = dataclasses.replace(result.solution, status=Status.ITERATION_LIMIT)
    doubtful = dataclasses.replace(result, certificate=certificate, solution=solution)
    assert text.verdict(doubtful) == f"The solver: {Status.ITERATION_LIMIT.value}. Another may exist."
    assert "NOT certified" in printed(text.result_summary(doubtful))


def test_a_contact_of_few_points_is_called_coarse(result: analysis.Result):
    pressure = np.where(np.arange(result.contact.size) < 2, result.solution.pressure, 0.0)
    solution = dataclasses.replace(result.solution, pressure=pressure)
    coarse = printed(text.result_summary(dataclasses.replace(result, solution=solution)))
    assert "only 2 contact points carry pressure" in coarse
    assert "only" not in printed(text.result_summary(result)).split("Verdict")[0]


def test_no_contact_is_said(result: analysis.Result):
    footprint = dataclasses.replace(result.footprint, intervals=(), peak=None)
    answer = printed(text.result_summary(dataclasses.replace(result, footprint=footprint)))
    assert "nowhere" in answer
    assert "Peak" not in answer


@pytest.mark.parametrize("width", [60, 100, 200])
def test_tables_keep_within_the_width_and_100_columns(result: analysis.Result, width: int):
    for renderable in (text.result_summary(result), text.problem_summary(body_of(block()))):
        assert max(map(len, printed(renderable, width).splitlines())) <= min(width, 100)


def test_markup_in_a_name_stays_text(result: analysis.Result):
    name = "a [red]block[/red] [/b]"
    renamed = dataclasses.replace(result, contact=dataclasses.replace(result.contact, name=name, notes=("[/i] note",)))
    answer = printed(text.result_summary(renamed))
    assert name in answer
    assert "[/i] note" in answer
