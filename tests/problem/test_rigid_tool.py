"""What a spec may say of rigid surfaces that move, and where and in which words each mistake is refused."""

import pytest

import bemcontact
from bemcontact.errors import ProblemError
from bemcontact.problem import Problem
from bemcontact.problem.rigid_tool import RigidTool

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
def test_each_way_is_read(text: str, displaced: tuple, free: tuple, position: tuple, load: tuple):
    """A component with a force, be it 0, is free; what is left out, is neither."""
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
        "tools.it: both displacement and force are given along x; give one of them only",
    ),
    "both along y": (
        "{zones: head, displacement: {y: 1}, force: {y: 1}}",
        "{zones",
        "tools.it: both displacement and force are given along y; give one of them only",
    ),
    "both in rotation": (
        "{zones: head, point: [0, 0], displacement: {rotation: 1}, force: {moment: 1}}",
        "{zones",
        "tools.it: both displacement and moment are given in rotation; give one of them only",
    ),
    "nothing": ("{zones: head}", "{zones", "tools.it: it states nothing; give a displacement or a force, or leave"),
    "empty force": ("{zones: head, force: {}}", "{zones", "tools.it: it states nothing"),
    "rotation about nothing": (
        "{zones: head, displacement: {rotation: 0.1}}",
        "{zones",
        "tools.it: a rotation is about a point; give point: [x, y]",
    ),
    "moment about nothing": (
        "{zones: head, force: {y: -1, moment: 0}}",
        "{zones",
        "tools.it: a moment is about a point; give point: [x, y]",
    ),
    "no zones": ("{force: {y: -1}}", "{force", "tools.it.zones: missing; give the name of the contact zone, or a list"),
    "no zone": ("{zones: [], force: {y: -1}}", "[]", "tools.it.zones: expected at least 1 in the list"),
    "unknown zone": (
        "{zones: heda, force: {y: -1}}",
        "heda",
        "tools.it.zones: unknown contact zone 'heda'; did you mean 'head'?",
    ),
    "unknown second zone": (
        "{zones: [head, fot], force: {y: -1}}",
        "fot",
        "tools.it.zones[1]: unknown contact zone 'fot'; did you mean 'foot'?",
    ),
    "zone twice": (
        "{zones: [head, head], force: {y: -1}}",
        "[head",
        "tools.it.zones: zone 'head' is listed twice; list it once",
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
def test_each_mistake_is_refused_with_its_place(case: str):
    """The entry stands in line 13 and begins in column 7; the place is that of what is wrong in it."""
    text, wrong, words = REFUSED[case]
    with pytest.raises(bemcontact.SpecError) as caught:
        bemcontact.loads(spec(text), "body.yaml")
    [line] = str(caught.value).splitlines()
    assert line.startswith(f"body.yaml:13:{text.index(wrong) + 7}: tools.it")
    assert words in line


def test_a_zone_moves_with_one_tool():
    text = spec(LOADED) + "  other: {zones: [foot, head], displacement: {y: 1}}\n"
    with pytest.raises(bemcontact.SpecError) as caught:
        bemcontact.loads(text, "body.yaml")
    assert str(caught.value) == (
        "body.yaml:14:25: tools.other.zones[1]: zone 'head' belongs to the tool 'it' already; a surface moves with "
        "one tool"
    )


def test_tools_are_checked_beside_other_mistakes():
    text = spec("{zones: heda, force: {y: -1}}").replace("poisson_ratio: 0.3", "poisson_ratio: 3")
    with pytest.raises(bemcontact.SpecError) as caught:
        bemcontact.loads(text)
    assert [line.split()[1] for line in str(caught.value).splitlines()] == [
        "material.poisson_ratio:",
        "tools.it.zones:",
    ]


def test_python_gets_the_same_words():
    with pytest.raises(ProblemError, match="a moment is about a point"):
        RigidTool(zones="head", force={"moment": 1})  # pyright: ignore
