"""References in a spec, and the place and text of the error for each mistake."""

import re
from pathlib import Path
from typing import get_args

import pytest
import schemas
import yaml
from messages import assert_one_mistake
from pydantic import TypeAdapter

import bemcontact
from bemcontact.problems import Crack, FlatPunch, Hertz, Problem, ProppedBeam, ShrinkFit, Table, Uniform, Values
from bemcontact.problems.reference import Reference, ReferenceSpec

BODY = """\
name: block on a plane
material: {young_modulus: 1000, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: bottom, start: [0, 0], elements: 2}
    - {name: right, start: [2, 0], elements: 2}
    - {name: top, start: [2, 1], elements: 2}
    - {name: left, start: [0, 1], elements: 2}
conditions: {top: {pressure: 5}}
contact_zones:
  foot: {edges: bottom, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}
"""
WALL = "  wall: {edges: left, surface: {kind: plane, point: [0, 0], normal: [1, 0]}}\n"
GOOD = {
    "Hertz": ("{kind: hertz, load: 810, radius: 8}", Hertz),
    "Hertz in a groove": ("{kind: hertz, load: 8, radius: 8, surface_radius: -10, center: [1, 0], half: true}", Hertz),
    "ring on a pin": ("{kind: hertz, load: 8, radius: -8, surface_radius: 7.9, zone: foot}", Hertz),
    "punch": ("{kind: flat_punch, load: 8, half_width: 1, center: [1, 0], eccentricity: -0.5}", FlatPunch),
    "ring": ("{kind: shrink_fit, inner_radius: 1, outer_radius: 2, interference: 0.01}", ShrinkFit),
    "disc": ("{kind: shrink_fit, rigid: bore, inner_radius: 0, outer_radius: 2, interference: 0.01}", ShrinkFit),
    "block": ("{kind: uniform, pressure: 5, tolerance: 0.001, reason: patch test}", Uniform),
    "crack": ("{kind: crack, half_length: 3, half_height: 0.3, compression: 75, center: [0, 0]}", Crack),
    "beam": ("{kind: propped_beam, support: prop, load: 1, span: 20, height: 1, gap: 0}", ProppedBeam),
    "finite elements": ("{kind: values, source: own computation, peak: 183.335, start: -1, end: 1}", Values),
    "[SS92], Fig. 4": ("{kind: table, source: figure, zone: foot, pressure: [[1, 170], [0, 183]]}", Table),
    "angles": (
        "{kind: table, source: s, against: angle, center: [0, 0], zero: [0, 1], pressure: [[0, 1], [90, 2]]}",
        Table,
    ),
}


def spec(reference: str, more_zones: str = "", name: str = "it") -> str:
    return f"{BODY}{more_zones}reference:\n  {name}: {reference}\n"


@pytest.mark.parametrize("name", GOOD)
def test_each_kind_is_read(name: str):
    text, kind = GOOD[name]
    problem = bemcontact.loads(spec(text, name=f"'{name}'"))
    assert isinstance(problem.reference[name], kind)
    assert Problem(**problem.model_dump()) == problem
    assert problem.refined(2).reference == problem.reference


def test_a_spec_may_have_no_reference():
    assert bemcontact.loads(BODY).reference == {}


REFUSED = {
    "no kind": ("{load: 810}", "{load: 810}", "kind: missing; … hertz, flat_punch,"),
    "unknown kind": (
        "{kind: herz, load: 1}",
        "herz, load: 1}",
        "reference.it.kind: unknown … 'herz' … 'hertz'?",
    ),
    "no mapping": ("183", "183", "reference.it: … a mapping … found 183"),
    "unknown key": (
        "{kind: hertz, load: 1, radius: 1, halve: true}",
        "halve: true}",
        "reference.it.halve: unknown … 'halve' … 'half'",
    ),
    "no load": (
        "{kind: hertz, radius: 1}",
        "{kind: hertz, ra",
        "reference.it.load: missing; … force per thickness",
    ),
    "load as a text": (
        "{kind: hertz, load: '1', radius: 1}",
        "'1', radius: 1}",
        "reference.it.load: expected a number, found the text",
    ),
    "pull": (
        "{kind: hertz, load: -1, radius: 1}",
        "-1, radius: 1}",
        "reference.it.load: … greater than 0, found -1",
    ),
    "no radius": (
        "{kind: hertz, load: 1, radius: 0}",
        "0}",
        "reference.it.radius: must not be 0",
    ),
    "hollow on a plane": (
        "{kind: hertz, load: 1, radius: -8}",
        "{kind: hertz, lo",
        "give surface_radius",
    ),
    "tight groove": (
        "{kind: hertz, load: 1, radius: 8, surface_radius: -8}",
        "-8}",
        "reference.it.surface_radius: … greater than 0, found 1/8 + 1/-8",
    ),
    "flat surface": (
        "{kind: hertz, load: 1, radius: 8, surface_radius: 0}",
        "0}",
        "reference.it.surface_radius: must not be 0",
    ),
    "beside the punch": (
        "{kind: flat_punch, load: 1, half_width: 2, center: [0, 0], eccentricity: -2}",
        "-2}",
        "reference.it.eccentricity: … half_width = 2, found -2",
    ),
    "of no case": (
        "{kind: uniform, pressure: 1, case: wind}",
        "wind}",
        "reference.it.case: unknown … 'wind'",
    ),
    "half and eccentric": (
        "{kind: flat_punch, load: 1, half_width: 2, center: [0, 0], eccentricity: 1, half: true}",
        "1, half: true}",
        "reference.it.eccentricity: must be 0",
    ),
    "no wall": (
        "{kind: shrink_fit, inner_radius: 2, outer_radius: 2, interference: 1}",
        "2, interference:",
        "reference.it.outer_radius: … greater than inner_radius = 2, found 2",
    ),
    "pin in a disc": (
        "{kind: shrink_fit, inner_radius: 0, outer_radius: 2, interference: 1}",
        "0, outer_radius:",
        "reference.it.inner_radius: … greater than 0",
    ),
    "unknown support": (
        "{kind: propped_beam, support: middle, load: 1, span: 20, height: 1, gap: 0}",
        "middle, load",
        "reference.it.support: … 'prop' or 'end', found … 'middle'",
    ),
    "prop above the beam": (
        "{kind: propped_beam, support: prop, load: 1, span: 20, height: 1, gap: -1}",
        "-1}",
        "reference.it.gap: … at least 0, found -1",
    ),
    "tight pin": (
        "{kind: pin_in_hole, load: 1, radius: 1, clearance: 0}",
        "0}",
        "reference.it.clearance: … greater than 0, found 0",
    ),
    "no pin": (
        "{kind: pin_in_hole, load: 1, radius: 1, clearance: 0.01}",
        "1, clearance",
        "reference.it.radius: 'foot' is no contact of a pin of radius 1 with … no circle, and no circle; correct",
    ),
    "per cent": (
        "{kind: uniform, pressure: 5, tolerance: 2}",
        "2}",
        "reference.it.tolerance: … less than 1, found 2",
    ),
    "reason for nothing": (
        "{kind: uniform, pressure: 5, reason: digits}",
        "{kind: uniform,",
        "give tolerance",
    ),
    "no value": (
        "{kind: values, source: s}",
        "{kind: values, s",
        "give one or more of peak, half_width",
    ),
    "no source": (
        "{kind: values, peak: 3}",
        "{kind: values, p",
        "reference.it.source: missing",
    ),
    "blank source": (
        "{kind: values, source: ' ', peak: 3}",
        "' ', peak: 3}",
        "reference.it.source: the text is empty",
    ),
    "end before start": (
        "{kind: values, source: s, start: 3, end: 2}",
        "2}",
        "reference.it.end: … greater than start = 3, found 2",
    ),
    "angle without center": (
        "{kind: values, source: s, start: 3, against: angle}",
        "{kind: values, s",
        "give center: [x, y]",
    ),
    "center without angle": (
        "{kind: values, source: s, start: 3, center: [0, 0]}",
        "{kind: values, s",
        "write against: angle",
    ),
    "no direction": (
        "{kind: values, source: s, start: 3, against: angle, center: [0, 0], zero: [0, 0]}",
        "{kind: values, s",
        "has no direction",
    ),
    "position twice": (
        "{kind: table, source: s, pressure: [[1, 3], [0, 2], [1, 4]]}",
        "1, 4]]}",
        "reference.it.pressure[2][0]: … position 1 … pressure[0]",
    ),
    "one point": ("{kind: table, source: s, pressure: [[1, 3]]}", "[[1, 3]]}", "expected at least 2 in the list"),
    "pull in a table": (
        "{kind: table, source: s, pressure: [[1, 3], [0, -2]]}",
        "-2]]}",
        "reference.it.pressure[1][1]: … negative, found -2",
    ),
    "no pair": (
        "{kind: table, source: s, pressure: [[1, 3], [0]]}",
        "[0]]}",
        "reference.it.pressure[1]: … two numbers",
    ),
    "angle beyond half a turn": (
        "{kind: table, source: s, against: angle, center: [0, 0], pressure: [[0, 1], [270, 2]]}",
        "270, 2]]}",
        "reference.it.pressure[1][0]: … -180 and 180 degrees, found 270",
    ),
    "unknown zone": (
        "{kind: uniform, pressure: 5, zone: fot}",
        "fot}",
        "reference.it.zone: unknown … 'fot' … 'foot'?",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_each_mistake_is_reported_at_its_place(case: str):
    """The entry starts in line 13, column 7; the error gives the place of the wrong value in it."""
    text, wrong, words = REFUSED[case]
    assert_one_mistake(spec(text), f"13:{text.index(wrong) + 7}: reference.it", words)


@pytest.mark.parametrize(
    "text",
    [
        "{kind: hertz, load: 1, radius: 1}",
        "{kind: flat_punch, load: 1, half_width: 2, center: [0, 0]}",
        "{kind: crack, half_length: 3, half_height: 0.3, compression: 75, center: [0, 0]}",
        "{kind: propped_beam, support: prop, load: 1, span: 20, height: 1, gap: 0}",
        "{kind: values, source: s, half_width: 2}",
        "{kind: table, source: s, against: arc, pressure: [[0, 1], [1, 1]]}",
    ],
)
def test_reference_names_one_of_several_zones(text: str):
    with pytest.raises(
        bemcontact.SpecError, match=r"reference\.it: there are 2 contact zones; give zone: foot or wall"
    ):
        bemcontact.loads(spec(text, WALL))
    bemcontact.loads(spec(text.replace("}", ", zone: wall}"), WALL))


def test_a_resultant_of_several_bodies_names_one_of_their_contacts():
    """The sum of forces on a stack is that of no body; with the sides of one contact exchanged it would be zero."""
    stack = bemcontact.load(Path(__file__).parents[2] / "models" / "bodies" / "stack_of_three.yaml").to_dict()
    stated = {"kind": "values", "source": "weight", "resultant": 150.0}
    found = r"reference\.it: there are 2 contact zones; give zone: upper joint or lower joint"
    with pytest.raises(bemcontact.ProblemError, match=found):
        bemcontact.problem({**stack, "reference": {"it": stated}})
    bemcontact.problem({**stack, "reference": {"it": {**stated, "zone": "upper joint"}}})
    one_body = spec("{kind: values, source: weight, resultant: 10}", WALL)
    assert bemcontact.loads(one_body).reference["it"].zone is None


def test_pin_names_one_of_several_zones():
    text = spec("{kind: pin_in_hole, load: 1, radius: 1, clearance: 0.01}", WALL)
    with pytest.raises(
        bemcontact.SpecError, match=r"reference\.it: there are 2 contact zones; give zone: foot or wall"
    ):
        bemcontact.loads(text)


def test_reference_without_a_zone_is_for_all_zones():
    bemcontact.loads(spec("{kind: uniform, pressure: 5}", WALL))
    bemcontact.loads(spec("{kind: values, source: s, peak: 5}", WALL))


def test_name_is_not_empty():
    with pytest.raises(bemcontact.SpecError, match="must not be empty"):
        bemcontact.loads(spec("{kind: uniform, pressure: 5}", name="' '"))


def test_references_are_checked_together_with_other_mistakes():
    text = spec("{kind: uniform, pressure: 5, zone: fot}").replace("poisson_ratio: 0.3", "poisson_ratio: 3")
    with pytest.raises(bemcontact.SpecError) as caught:
        bemcontact.loads(text)
    assert [line.split()[1] for line in str(caught.value).splitlines()] == [
        "material.poisson_ratio:",
        "reference.it.zone:",
    ]


def test_value_of_a_reference_can_be_set():
    problem = bemcontact.loads(spec("{kind: hertz, load: 810, radius: 8}"), set=["reference.it.load=8.1"])
    assert problem.reference["it"].load == 8.1
    assert problem.with_value("reference.it.load", 3).reference["it"].load == 3


def schema_errors(text: str) -> list[str]:
    """Error messages of JSON Schema for a spec."""
    return [error.message for error in schemas.of_spec().iter_errors(yaml.load(text, yaml.SafeLoader))]


@pytest.mark.parametrize("name", GOOD)
def test_schema_accepts_valid_references(name: str):
    assert schema_errors(spec(GOOD[name][0], name=f"'{name}'")) == []


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ("no kind", "'kind' is a required property"),
        ("unknown kind", "'herz' is not one of ['hertz', 'flat_punch'"),
        ("unknown key", "'halve' was unexpected"),
        ("no load", "'load' is a required property"),
        ("pull", "-1 is less than or equal to the minimum of 0"),
        ("per cent", "2 is not valid under any of the given schemas"),
        ("no source", "'source' is a required property"),
        ("one point", "is too short"),
        ("no pair", "is too short"),
        ("no mapping", "183 is not of type 'object'"),
    ],
)
def test_schema_rejects_invalid_references(case: str, words: str):
    first, *_ = schema_errors(spec(REFUSED[case][0]))
    assert words in first


def test_the_examples_of_the_page_on_references_are_read():
    page = (Path(__file__).parents[2] / ".docs/how-to/reference_values.md").read_text(encoding="utf-8")
    examples = re.findall(r"^\| `(\w+)` \| `(\{kind: .*?\})` \|", page, flags=re.MULTILINE)
    read = TypeAdapter(ReferenceSpec).validate_python
    references = [read(yaml.load(example, yaml.SafeLoader)) for _, example in examples]
    assert [reference.kind for reference in references] == [kind for kind, _ in examples]
    assert {type(reference) for reference in references} == {*get_args(Reference)}
