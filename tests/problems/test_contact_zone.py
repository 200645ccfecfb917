"""Tools in a spec, and the place and text of the error for each mistake."""

import pytest
from messages import assert_one_mistake

import bemcontact
from bemcontact.errors import ProblemError
from bemcontact.problems import Problem
from bemcontact.problems.contact_zone import RigidTool

BODY = """\
name: block between planes
material: {young_modulus: 1000, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: bottom, start: [0, 0], elements: 2}
    - {name: right, start: [2, 0], elements: 2}
    - {name: top, start: [2, 1], elements: 2}
    - {name: left, start: [0, 1], elements: 2}
contact_zones:
  foot: {edges: bottom, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}
  head: {edges: top, surface: {kind: plane, point: [0, 1], normal: [0, -1]}}
"""


def spec(tool: str, name: str = "it") -> str:
    return f"{BODY}tools:\n  {name}: {tool}\n"


DISPLACED = "{zones: head, point: [1, 1], displacement: {x: 1, y: -2, rotation: 0.1}}"
LOADED = "{zones: [head], point: [1, 1], force: {x: 3, y: -4, moment: 5}}"
MIXED = "{zones: [foot, head], displacement: {x: 0.5}, force: {y: -4}}"


@pytest.mark.parametrize(
    ("text", "displaced", "free", "position", "load"),
    [
        (DISPLACED, (True, True, True), (False, False, False), (1, -2, 0.1), (0, 0, 0)),
        (LOADED, (False, False, False), (True, True, True), (0, 0, 0), (3, -4, 5)),
        (MIXED, (True, False, False), (False, True, False), (0.5, 0, 0), (0, -4, 0)),
        ("{zones: head, force: {y: 0}}", (False,) * 3, (False, True, False), (0, 0, 0), (0, 0, 0)),
    ],
)
def test_each_tool_is_read(text: str, displaced: tuple, free: tuple, position: tuple, load: tuple):
    """A component with a force, even with force 0, is free; a missing component is neither free nor displaced."""
    problem = bemcontact.loads(spec(text))
    tool = problem.tools["it"]
    assert (tool.displaced, tool.free, tool.position, tool.load) == (displaced, free, position, load)
    assert Problem(**problem.model_dump()) == problem


def test_values_of_tools_can_be_set():
    problem = bemcontact.loads(spec(LOADED))
    assert problem.with_value("tools.it.force.y", -9).tools["it"].load == (3, -9, 5)
    assert problem.with_value("tools.it.point", [0, 1]).tools["it"].point == (0, 1)
    with pytest.raises(ProblemError, match=r"tools\.it: both displacement and force are given along y"):
        problem.with_value("tools.it.displacement.y", 1)


def test_a_variant_sets_values_of_tools():
    text = spec(LOADED) + "variants:\n  hard: {set: {tools.it.force.y: -400}}\n"
    assert bemcontact.loads(text).variant("hard").tools["it"].load == (3, -400, 5)
    with pytest.raises(bemcontact.SpecError, match=r"variants\.hard"):
        bemcontact.loads(text.replace("tools.it.force.y: -400", "tools.it.force.z: 1"))


REFUSED = {
    "both along x": (
        "{zones: head, displacement: {x: 1}, force: {x: 1}}",
        "{zones",
        "tools.it: … displacement … force … along x; give only one",
    ),
    "both along y": (
        "{zones: head, displacement: {y: 1}, force: {y: 1}}",
        "{zones",
        "tools.it: … displacement … force … along y; give only one",
    ),
    "both in rotation": (
        "{zones: head, point: [0, 0], displacement: {rotation: 1}, force: {moment: 1}}",
        "{zones",
        "tools.it: … displacement … moment … rotation; give only one",
    ),
    "nothing": ("{zones: head}", "{zones", "tools.it: … no displacement … no force"),
    "empty force": ("{zones: head, force: {}}", "{zones", "tools.it: … no displacement … no force"),
    "rotation without a point": (
        "{zones: head, displacement: {rotation: 0.1}}",
        "{zones",
        "tools.it: a rotation … give point: [x, y]",
    ),
    "moment without a point": (
        "{zones: head, force: {y: -1, moment: 0}}",
        "{zones",
        "tools.it: a moment … give point: [x, y]",
    ),
    "no zones": ("{force: {y: -1}}", "{force", "tools.it.zones: missing; give … contact zone"),
    "no zone": ("{zones: [], force: {y: -1}}", "[]", "tools.it.zones: expected at least 1 in the list"),
    "unknown zone": (
        "{zones: heda, force: {y: -1}}",
        "heda",
        "tools.it.zones: unknown … 'heda' … 'head'?",
    ),
    "unknown second zone": (
        "{zones: [head, fot], force: {y: -1}}",
        "fot",
        "tools.it.zones[1]: unknown … 'fot' … 'foot'?",
    ),
    "zone twice": (
        "{zones: [head, head], force: {y: -1}}",
        "[head",
        "tools.it.zones: … 'head' … twice",
    ),
    "unknown key": (
        "{zones: head, force: {z: -1}}",
        "z: -1",
        "tools.it.force.z: unknown key 'z'",
    ),
    "moment of a displacement": (
        "{zones: head, point: [0, 0], displacement: {moment: 1}}",
        "moment: 1",
        "tools.it.displacement.moment: unknown key 'moment'",
    ),
    "text for a number": (
        "{zones: head, force: {y: '1'}}",
        "'1'",
        "tools.it.force.y: expected a number, found the text",
    ),
    "infinite": ("{zones: head, force: {y: .inf}}", ".inf", "tools.it.force.y: "),
}


@pytest.mark.parametrize("case", REFUSED)
def test_each_mistake_is_reported_at_its_place(case: str):
    """The entry starts in line 13, column 7; the error gives the place of the wrong value in it."""
    text, wrong, words = REFUSED[case]
    assert_one_mistake(spec(text), f"13:{text.index(wrong) + 7}: tools.it", words)


def test_a_zone_moves_with_one_tool():
    text = spec(LOADED) + "  other: {zones: [foot, head], displacement: {y: 1}}\n"
    with pytest.raises(bemcontact.SpecError) as caught:
        bemcontact.loads(text, "body.yaml")
    assert str(caught.value).startswith(
        "body.yaml:14:25: tools.other.zones[1]: zone 'head' already belongs to the tool 'it'"
    )


def test_tools_are_checked_together_with_other_mistakes():
    text = spec("{zones: heda, force: {y: -1}}").replace("poisson_ratio: 0.3", "poisson_ratio: 3")
    with pytest.raises(bemcontact.SpecError) as caught:
        bemcontact.loads(text)
    assert [line.split()[1] for line in str(caught.value).splitlines()] == [
        "material.poisson_ratio:",
        "tools.it.zones:",
    ]


def test_tool_made_in_python_has_the_same_error():
    with pytest.raises(ProblemError, match="a moment needs a point"):
        RigidTool(zones="head", force={"moment": 1})  # pyright: ignore
