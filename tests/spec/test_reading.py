"""Spec files, and the place and text of the error for each mistake."""

import copy
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import schemas
import yaml
from messages import assert_each_states, assert_states

import bemcontact.spec
from bemcontact.errors import Issue, ProblemError, SpecError, dotted

MODEL = Path(__file__).parents[2] / "models" / "cylinder_on_plane.yaml"
SPEC = """\
name: block on a plane
units: {length: cm, force: kN}
material:
  young_modulus: 1e3
  poisson_ratio: .3
boundary:
  outer:
    - name: bottom
      start: [0, 0]
      elements: 4
    - name: right
      start: [2, 0]
      elements: 2
    - name: top
      start: [2, 1]
      end: [0, 1]
      elements: 4
      grading: {ratio: 3, towards: both}
    - {name: left, elements: 2}
  holes:
    - - {name: bore, kind: arc, center: [1, 0.5], radius: 0.25, angles: [360, 0], elements: 8}
conditions:
  top: {pressure: 5}
  left: {displacement: {x: 0}}
contact_zones:
  foot:
    edges: bottom
    surface: {kind: plane, point: [0, 0], normal: [0, 1]}
"""


@dataclass(frozen=True)
class Broken:
    """One mistake in the good spec: what to replace, and what the only line of the error must say."""

    old: str
    new: str
    place: str
    key_path: str
    words: tuple[str, ...]


BROKEN = {
    "wrong key": Broken("poisson_ratio: .3", "poison: .3", "5:3", "material.poison", ("unknown key", "poisson_ratio")),
    "key of nothing known": Broken(
        "units: {length: cm,", "units: {mass: t,", "2:9", "units.mass", ("unknown key 'mass'", "length, force")
    ),
    "near-by key at the top": Broken(
        "contact_zones:", "contact_zone:", "25:1", "contact_zone", ("did you mean 'contact_zones'",)
    ),
    "wrong type": Broken(
        "young_modulus: 1e3", "young_modulus: steel", "4:18", "material.young_modulus", ("a number", "'steel'")
    ),
    "number in quotes": Broken(
        "young_modulus: 1e3",
        "young_modulus: '1e3'",
        "4:18",
        "material.young_modulus",
        ("'1e3'", "leave the quotes out"),
    ),
    "number with its unit": Broken(
        "young_modulus: 1e3",
        "young_modulus: 210 GPA",
        "4:18",
        "material.young_modulus",
        ("unknown unit 'GPA'", "did you mean GPa?"),
    ),
    "decimal comma": Broken(
        "poisson_ratio: .3",
        "poisson_ratio: 0,3",
        "5:18",
        "material.poisson_ratio",
        ("'0,3'", "decimal sign is a point"),
    ),
    "comma between thousands": Broken(
        "young_modulus: 1e3",
        "young_modulus: 1,210,000",
        "4:18",
        "material.young_modulus",
        ("write 1210000 without a comma between thousands",),
    ),
    "comma between thousands, or decimal comma": Broken(
        "young_modulus: 1e3",
        "young_modulus: 210,000",
        "4:18",
        "material.young_modulus",
        ("write 210000 without a comma", "or 210.000 if the comma is the decimal sign"),
    ),
    "comma between thousands in braces": Broken(
        "top: {pressure: 5}", "top: {pressure: 5,000}", "23:21", "conditions.top", ("found 5,000; write 5000 without",)
    ),
    "decimal comma in braces": Broken(
        "top: {pressure: 5}", "top: {pressure: 0,5}", "23:21", "conditions.top", ("found 0,5; the decimal sign",)
    ),
    "true as a number": Broken(
        "young_modulus: 1e3", "young_modulus: true", "4:18", "material.young_modulus", ("a number", "found true")
    ),
    "NaN": Broken("young_modulus: 1e3", "young_modulus: .nan", "4:18", "material.young_modulus", ("finite", "nan")),
    "overflow": Broken("young_modulus: 1e3", "young_modulus: 1e999", "4:18", "material.young_modulus", ("finite",)),
    "too large to square": Broken(
        "young_modulus: 1e3", "young_modulus: 1e200", "4:18", "material.young_modulus", ("too large", "other units")
    ),
    "thousands of digits": Broken(
        "young_modulus: 1e3", "young_modulus: " + 5000 * "9", "4:18", "material.young_modulus", ("finite",)
    ),
    "E = 0": Broken(
        "young_modulus: 1e3", "young_modulus: 0", "4:18", "material.young_modulus", ("greater than 0", "found 0")
    ),
    "nu = 0.6": Broken(
        "poisson_ratio: .3", "poisson_ratio: 0.6", "5:18", "material.poisson_ratio", ("less than 0.5", "found 0.6")
    ),
    "nu = 0.5 in plane strain": Broken(
        "poisson_ratio: .3", "poisson_ratio: 0.5", "5:18", "material.poisson_ratio", ("plane strain", "0.499")
    ),
    "no plane state": Broken(
        "poisson_ratio: .3",
        "poisson_ratio: .3\n  state: plane",
        "6:10",
        "material.state",
        ("'plane_strain' or 'plane_stress'", "found the text 'plane'"),
    ),
    "missing required key": Broken(
        "  young_modulus: 1e3\n", "", "3:1", "material.young_modulus", ("missing", "modulus of elasticity")
    ),
    "missing part": Broken(
        "material:\n  young_modulus: 1e3\n  poisson_ratio: .3\n", "", "1:1", "material", ("missing", "young_modulus")
    ),
    "part without content": Broken(
        "material:\n  young_modulus: 1e3\n  poisson_ratio: .3\n",
        "material:\n",
        "3:10",
        "material",
        ("expected a mapping", "poisson_ratio", "found nothing"),
    ),
    "duplicate key": Broken(
        "  poisson_ratio: .3",
        "  poisson_ratio: .3\n  young_modulus: 2",
        "6:3",
        "material.young_modulus",
        ("occurs twice", "first in line 4"),
    ),
    "key that is no text": Broken("  top: {pressure", "  3: {pressure", "23:3", "conditions", ("'3'", "in quotes")),
    "name that is no text": Broken(
        "name: left", "name: 7", "19:14", "boundary.outer[3].name", ("expected a text", "found 7", "'7' in quotes")
    ),
    "edge that is no text": Broken(
        "edges: bottom", "edges: 1", "27:12", "contact_zones.foot.edges", ("found 1", "write '1' in quotes")
    ),
    "name that no key path can hold": Broken(
        "name: bore", "name: bore.1", "21:16", "boundary.holes[0][0].name", ("must not contain .", "'bore.1'")
    ),
    "angles in radians": Broken(
        "angles: [360, 0]", "angles: [6.2832, 0]", "21:73", "boundary.holes[0][0].angles", ("open", "are in degrees")
    ),
    "open loop": Broken(
        "{name: left, elements: 2}",
        "{name: more, start: [0, 1], end: [0, 0.75], elements: 1}\n    - {name: left, start: [0, 0.5], elements: 2}",
        "20:27",
        "boundary.outer[4].start",
        ("open", "'left' starts at (0, 0.5)", "'more' before it ends at (0, 0.75), 0.25 away", "leave the start out"),
    ),
    "unknown joint": Broken(
        "      start: [2, 0]\n", "", "11:7", "boundary.outer[1]", ("start of 'right'", "end of 'bottom'", "give one")
    ),
    "crossing loop": Broken(
        "{name: left, elements: 2}",
        "{name: more, start: [0, 1], end: [1, -0.5], elements: 1}\n    - {name: left, elements: 2}",
        "19:7",
        "boundary.outer[3]",
        ("'more' crosses or touches 'bottom'", "at (0.666667, 0)"),
    ),
    "hole through the outside": Broken(
        "radius: 0.25", "radius: 0.75", "21:9", "boundary.holes[0][0]", ("'bore' crosses or touches 'bottom'",)
    ),
    "hole outside": Broken(
        "center: [1, 0.5]", "center: [5, 0.5]", "21:7", "boundary.holes[0]", ("outside the outer loop",)
    ),
    "orientation wrong": Broken(
        "angles: [360, 0]",
        "angles: [0, 360]",
        "21:73",
        "boundary.holes[0][0].angles",
        ("must run clockwise", "exchange"),
    ),
    "zero elements": Broken(
        "{name: left, elements: 2}",
        "{name: left, elements: 0}",
        "19:30",
        "boundary.outer[3].elements",
        ("at least 1", "found 0"),
    ),
    "half an element": Broken(
        "{name: left, elements: 2}",
        "{name: left, elements: 2.5}",
        "19:30",
        "boundary.outer[3].elements",
        ("a whole number", "found 2.5"),
    ),
    "too few elements for a circle": Broken(
        "elements: 8", "elements: 5", "21:93", "boundary.holes[0][0].elements", ("72 degrees", "give it 6 elements")
    ),
    "wrong list length": Broken(
        "end: [0, 1]", "end: [0, 1, 0]", "16:12", "boundary.outer[2].end", ("two numbers", "a list of 3")
    ),
    "wrong entry of a list": Broken(
        "end: [0, 1]", "end: [0, one]", "16:16", "boundary.outer[2].end[1]", ("a number", "'one'")
    ),
    "unknown kind": Broken(
        "kind: arc", "kind: ark", "21:28", "boundary.holes[0][0].kind", ("unknown kind 'ark'", "did you mean 'arc'")
    ),
    "kind forgotten": Broken("kind: arc, ", "", "21:9", "boundary.holes[0][0].kind", ("missing", "needs kind: arc")),
    "kind of surface forgotten": Broken(
        "kind: plane, ", "", "28:14", "contact_zones.foot.surface.kind", ("missing", "plane, circle, polyline")
    ),
    "grading less than 1": Broken(
        "ratio: 3", "ratio: 0.3", "18:24", "boundary.outer[2].grading.ratio", ("at least 1", "found 0.3")
    ),
    "grading towards nothing": Broken(
        "towards: both",
        "towards: left",
        "18:36",
        "boundary.outer[2].grading.towards",
        ("start, end, both, middle, a fraction of the length, or a point", "'left'"),
    ),
    "grading towards an end by number": Broken(
        "towards: both", "towards: 1.0", "18:36", "boundary.outer[2].grading.towards", ("between 0 and 1", "found 1")
    ),
    "grading towards a point elsewhere": Broken(
        "towards: both", "towards: [1, 1.1]", "18:36", "boundary.outer[2].grading.towards", ("0.1 away from 'top'",)
    ),
    "element end beside the edge": Broken(
        "{name: left, elements: 2}",
        "{name: left, elements: 2, ends_at: [[0.5, 0.5]]}",
        "19:43",
        "boundary.outer[3].ends_at[0]",
        ("the point (0.5, 0.5) is 0.5 away from 'left'",),
    ),
    "element end at the end of the edge": Broken(
        "{name: left, elements: 2}",
        "{name: left, elements: 2, ends_at: [[0, 1]]}",
        "19:43",
        "boundary.outer[3].ends_at[0]",
        ("ends here already",),
    ),
    "element end twice": Broken(
        "{name: left, elements: 2}",
        "{name: left, elements: 4, ends_at: [0.5, [0, 0.5]]}",
        "19:48",
        "boundary.outer[3].ends_at[1]",
        ("ends here already",),
    ),
    "element ends too near to each other": Broken(
        "{name: left, elements: 2}",
        "{name: left, elements: 4, ends_at: [0.5, 0.50000000001]}",
        "19:48",
        "boundary.outer[3].ends_at[1]",
        ("an element of 'left' ends 1e-11 away", "too near"),
    ),
    "element end too near to the end of the edge": Broken(
        "{name: left, elements: 2}",
        "{name: left, elements: 4, ends_at: [[0, 0.99999999999]]}",
        "19:43",
        "boundary.outer[3].ends_at[0]",
        ("ends 1e-11 away", "leave this place out"),
    ),
    "element end in words": Broken(
        "{name: left, elements: 2}",
        "{name: left, elements: 2, ends_at: [middle]}",
        "19:43",
        "boundary.outer[3].ends_at[0]",
        ("a fraction of the length such as 0.4, or a point", "'middle'"),
    ),
    "more element ends than elements": Broken(
        "{name: left, elements: 2}",
        "{name: left, elements: 2, ends_at: [0.2, 0.4]}",
        "19:30",
        "boundary.outer[3].elements",
        ("at least 3 elements", "found 2"),
    ),
    "search for a mesh that is no yes or no": Broken(
        "name: block on a plane",
        "name: block on a plane\nmesh: {adapt: 3}",
        "2:15",
        "mesh.adapt",
        ("true or false", "found 3"),
    ),
    "name twice": Broken(
        "name: bore", "name: right", "21:16", "boundary.holes[0][0].name", ("outer[1] has the name 'right' too",)
    ),
    "unknown edge in a condition": Broken(
        "  top: {pressure", "  tap: {pressure", "23:3", "conditions.tap", ("unknown edge 'tap'", "did you mean 'top'")
    ),
    "unknown edge in a zone": Broken(
        "edges: bottom",
        "edges: [floor]",
        "27:13",
        "contact_zones.foot.edges[0]",
        ("unknown edge 'floor'", "bottom, right"),
    ),
    "contact edge with a load": Broken(
        "  left: {displacement: {x: 0}}",
        "  left: {displacement: {x: 0}}\n  bottom: {pressure: 1}",
        "25:3",
        "conditions.bottom",
        ("contact zone 'foot'", "no condition"),
    ),
    "edge in two zones with one surface": Broken(
        "contact_zones:\n",
        "contact_zones:\n  wall: {edges: bottom, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}\n",
        "29:14",
        "contact_zones.foot.surface",
        ("zone 'wall' has the same surface", "'bottom'"),
    ),
    "no contact zone": Broken(
        SPEC[SPEC.index("contact_zones:") :],
        "contact_zones: {}\n",
        "25:16",
        "contact_zones",
        ("there is no contact zone",),
    ),
    "no contact zones at all": Broken(
        SPEC[SPEC.index("contact_zones:") :], "", "1:1", "contact_zones", ("missing", "contact zones by name")
    ),
    "normal out of the body": Broken(
        "normal: [0, 1]",
        "normal: [0, -1]",
        "28:14",
        "contact_zones.foot.surface",
        ("must point from the surface into the body", "'bottom'", "[0, 1]"),
    ),
    "normal without direction": Broken(
        "normal: [0, 1]", "normal: [0, 0]", "28:14", "contact_zones.foot.surface", ("no direction",)
    ),
    "two statements on an axis": Broken(
        "left: {displacement: {x: 0}}",
        "left: {displacement: {x: 0}, traction: {x: 1}}",
        "24:9",
        "conditions.left",
        ("displacement and traction", "along x"),
    ),
    "pressure with company": Broken(
        "top: {pressure: 5}",
        "top: {pressure: 5, displacement: {x: 0}}",
        "23:8",
        "conditions.top",
        ("pressure", "one of"),
    ),
    "empty condition": Broken("top: {pressure: 5}", "top: {}", "23:8", "conditions.top", ("the condition is empty",)),
    "field that is no number": Broken(
        "pressure: 5", "pressure: [5]", "23:19", "conditions.top.pressure", ("a number, or a mapping", "a list of 1")
    ),
    "too many elements": Broken(
        "conditions:", "mesh: {refine: 1000}\nconditions:", "22:16", "mesh.refine", ("20000 elements", "at most 10000")
    ),
    "infinite alias": Broken(
        "top: {pressure: 5}", "top: &own {pressure: 5, traction: *own}", "23:8", "conditions.top.traction", ("alias",)
    ),
}


def error_lines(text, overrides=()):
    with pytest.raises(SpecError) as caught:
        bemcontact.spec.loads(text, "block.yaml", overrides)
    return str(caught.value).splitlines()


def test_valid_spec_is_read():
    problem = bemcontact.spec.loads(SPEC)
    assert problem.name == "block on a plane"
    assert problem.units.stress == "kN/cm²"
    assert [edge.name for edge in problem.boundary.edges] == ["bottom", "right", "top", "left", "bore"]
    assert problem.contact_zones["foot"].edges == ("bottom",)
    top, left = problem.conditions["top"], problem.conditions["left"]
    assert top.pressure is not None
    assert top.pressure.constant == 5
    assert left.displacement.given == ("x",)


@pytest.mark.parametrize("broken", [pytest.param(case, id=name) for name, case in BROKEN.items()])
def test_one_mistake_makes_one_line_with_its_place(broken):
    assert SPEC.count(broken.old) == 1
    lines = error_lines(SPEC.replace(broken.old, broken.new))
    if "alias" in broken.words:
        lines = [line for line in lines if "alias" in line]
    assert len(lines) == 1, lines
    assert lines[0].startswith(f"block.yaml:{broken.place}: {broken.key_path}: "), lines[0]
    for word in broken.words:
        assert word in lines[0]


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("", "1:1", "the file is empty"),
        ("# only a comment\n", "1:1", "the file is empty"),
        ("---\n", "1:1", "the file is empty"),
        ("- name: block\n", "1:1", "found a list of 1"),
        ("block\n", "1:1", "found the text 'block'"),
        ("name: [a, b\n", "2:1", "a bracket is not closed"),
        ("name: 'a\n", "2:1", "a quote or bracket is not closed"),
        ("name: block: on a plane\n", "1:12", "in quotes"),
        ("material:\n\tyoung_modulus: 1\n", "2:1", "replace the tab"),
        ("material:\n    young_modulus: 1\n  poisson_ratio: 0\n", "3:3", "check the indentation"),
        ("name: *block\n", "1:7", "needs an anchor"),
        ("name: a\n--- \nname: b\n", "2:1", "one problem into one file"),
        ("name: a\0b\n", "1:8", "'\\x00' is not allowed"),
        ('name: "\\UFFFFFFFF"\n', "1:10", "no character"),
        ("[" * 5000, "1:65", "nested more than 64 deep"),
        ("!!python/object/apply:os.getcwd []\n", "1:1", "the tag !!python/object/apply:os.getcwd"),
    ],
)
def test_text_that_is_no_yaml_mapping_is_refused_at_its_place(text, place, words):
    lines = error_lines(text)
    assert len(lines) == 1
    assert lines[0].startswith(f"block.yaml:{place}: ")
    assert words in lines[0]


@pytest.mark.parametrize(
    ("tagged", "every"),
    [("!!binary cQ==", 1), ("!!set {a}", 7), ("!other 1", 7), ("!!int x", 7), ("!!timestamp 2001-01-01", 7)],
)
def test_a_value_that_is_not_read_gets_one_line(tagged, every):
    """The value is not judged a second time, as if nothing stood there: at all places, or at each seventh."""

    def places(data, path=()):
        yield path
        for key, value in data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ():
            yield from places(value, (*path, key))

    data = yaml.safe_load(SPEC)
    for path in [*places(data)][1::every]:
        changed = copy.deepcopy(data)
        below = changed
        for key in path[:-1]:
            below = below[key]
        below[path[-1]] = "SENTINEL"
        lines = error_lines(yaml.dump(changed, sort_keys=False).replace("SENTINEL", tagged))
        own = [line for line in lines if f" {dotted(path)}: " in line]
        assert len(own) == 1
        assert "tag" in own[0]


def test_all_mistakes_of_a_file_are_reported_in_order():
    text = SPEC
    for name in ("wrong type", "nu = 0.6", "zero elements", "unknown edge in a zone", "field that is no number"):
        text = text.replace(BROKEN[name].old, BROKEN[name].new)
    assert [line.split(": ")[:2] for line in error_lines(text)] == [
        ["block.yaml:4:18", "material.young_modulus"],
        ["block.yaml:5:18", "material.poisson_ratio"],
        ["block.yaml:19:30", "boundary.outer[3].elements"],
        ["block.yaml:23:19", "conditions.top.pressure"],
        ["block.yaml:27:13", "contact_zones.foot.edges[0]"],
    ]


def test_unknown_edge_is_reported_together_with_mistakes_in_keys():
    text = SPEC.replace("edges: bottom", "edges: botom").replace("poisson_ratio: .3", "poison_ratio: .3")
    text = text.replace("kind: plane, point", "kind: plane, pont").replace("boundary:", "boundry:")
    text = text.replace("{name: left, elements: 2}", "{name: left, elments: 2}")
    facts = [
        "block.yaml:5:3: material.poison_ratio: unknown … 'poison_ratio' … 'poisson_ratio'",
        "block.yaml:6:1: boundry: unknown … 'boundry' … 'boundary'",
        "block.yaml:19:20: boundry.outer[3].elments: unknown … 'elments' … 'elements'",
        "block.yaml:27:12: contact_zones.foot.edges: unknown … 'botom' … 'bottom'",
        "block.yaml:28:28: contact_zones.foot.surface.pont: unknown … 'pont' … 'point'",
    ]
    assert_each_states(error_lines(text), facts)


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("2e6", 2e6),
        ("1E3", 1e3),
        (".5", 0.5),
        ("5.", 5.0),
        ("+12", 12.0),
        ("010", 10.0),
        ("0x10", 16.0),
        ("1e-3", 1e-3),
    ],
)
def test_numbers_are_those_of_yaml_1_2(written, value):
    problem = bemcontact.spec.loads(SPEC.replace("young_modulus: 1e3", f"young_modulus: {written}"))
    assert problem.material.young_modulus == value


@pytest.mark.parametrize("word", ["no", "yes", "on", "off", "n", "2024-01-31", "12:30", "1_000"])
def test_texts_that_yaml_1_1_converts_stay_texts(word):
    assert bemcontact.spec.loads(SPEC.replace("block on a plane", word)).name == word


def test_anchors_and_merged_mappings_are_read():
    text = SPEC.replace("top: {pressure: 5}", "top: &load {pressure: 5}\n  right: {<<: *load}")
    problem = bemcontact.spec.loads(text)
    assert problem.conditions["right"] == problem.conditions["top"]


@pytest.mark.parametrize(
    ("override", "found"),
    [
        ("material.young_modulus=2e6", lambda problem: problem.material.young_modulus == 2e6),
        ("boundary.outer[2].elements=9", lambda problem: problem.edge("top").elements == 9),
        ("boundary.outer.top.elements=9", lambda problem: problem.edge("top").elements == 9),
        ("mesh.refine=3", lambda problem: problem.mesh.refine == 3),
        ("conditions.top={traction: {y: -2}}", lambda problem: problem.conditions["top"].traction.given == ("y",)),
        ("loads.gravity={density: 1, acceleration: [0, -10]}", lambda problem: problem.loads.gravity.density == 1),
        ("description=a = b", lambda problem: problem.description == "a = b"),
    ],
)
def test_override_replaces_one_value(override, found):
    assert found(bemcontact.spec.loads(SPEC, set=[override]))


def test_later_override_wins():
    problem = bemcontact.spec.loads(SPEC, set=["material.young_modulus=2", "material.young_modulus=3"])
    assert problem.material.young_modulus == 3


def test_changes_may_be_a_mapping_of_values_by_key():
    """A key and its value say the same as the text `key=value`, also as numbers of NumPy."""
    values = {"material.young_modulus": np.float64(2e6), "material.poisson_ratio": 0.25, "description": "a: b"}
    texts = ["material.young_modulus=2e6", "material.poisson_ratio=0.25", "description='a: b'"]
    assert bemcontact.loads(SPEC, set=values) == bemcontact.loads(SPEC, set=texts)
    with pytest.raises(SpecError, match="an override cannot have the value"):
        bemcontact.loads(SPEC, set={"description": object()})


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("material.poisson_ratio=0.6", "material.poisson_ratio: … less than 0.5, found 0.6"),
        ("material.poisson=0.2", "material.poisson: unknown … 'poisson' … 'poisson_ratio'"),
        ("material.young_modulus", "there is no '='; write key.path=value"),
        ("=3", "'' is not a key path"),
        ("a..b=3", "'a..b' is not a key path"),
        ("boundary.outer[9].elements=3", "boundary.outer: … no entry [9] … 4"),
        ("boundary.outer.tip.elements=3", "boundary.outer: unknown … 'tip' … 'top'"),
        ("name.first=3", "name: … no entry first … 'block on a plane'"),
        ("material.young_modulus=[1", "not YAML: "),
        ("conditions.top={pressure: 1, pressure: 2}", "the key occurs twice"),
        ("conditions.topp.pressure=3", "conditions.topp: unknown … 'topp' … 'top'"),
        ("conditions.top.pressure=", "conditions.top: the condition is empty"),
        ("conditions.left.traction.x=1", "conditions.left: … displacement … traction … along x"),
        ("contact_zones.foot.edges=top", "conditions.top: … 'top' … contact zone 'foot'"),
        ("contact_zones.fot.edges=top", "contact_zones: … adds no contact zone: … 'fot' … 'foot'"),
        ("tools.press.force.y=1", "tools: … adds no tool: unknown tool 'press'; there are none"),
    ],
)
def test_mistake_in_an_override_points_to_it(override, words):
    lines = error_lines(SPEC, [override])
    assert len(lines) == 1
    assert lines[0].startswith(f"override {override}: ")
    assert_states(lines[0], words)


def test_only_new_issues_are_attributed_to_an_override():
    text = SPEC.replace("young_modulus: 1e3", "young_modulus: 0")
    lines = error_lines(text, ["mesh.refine=2", "conditions.top.pressure=", "material.poisson_ratio=0.2"])
    assert [line.split(": ")[:2] for line in lines] == [
        ["override conditions.top.pressure=", "conditions.top"],
        ["block.yaml:4:18", "material.young_modulus"],
    ]


def test_later_issues_are_located_in_the_file(tmp_path):
    path = tmp_path / "block.yaml"
    path.write_text(SPEC, encoding="utf-8")
    issues = [
        Issue(path=("conditions", "left", "displacement", "x"), message="conflicts with its neighbor"),
        Issue(path=("conditions", "right"), message="conflicts too"),
        Issue(path=(), message="nothing holds the body"),
    ]
    error = bemcontact.spec.located(
        ProblemError(issues), path.read_text(), str(path), ["conditions.right={pressure: 1}"]
    )
    assert str(error).splitlines() == [
        "override conditions.right={pressure: 1}: conditions.right: conflicts too",
        f"{path}: nothing holds the body",
        f"{path}:24:28: conditions.left.displacement.x: conflicts with its neighbor",
    ]


VARIED = f"""{SPEC}variants:
  fine:
    set:
      boundary.outer.bottom.elements: 12
      material.poisson_ratio: 0.25
  steep: {{set: {{"conditions.top.pressure": {{constant: 5, x: 1}}}}}}
"""


def test_variant_is_set_before_the_overrides():
    problem = bemcontact.spec.loads(VARIED, set=["boundary.outer.top.elements=7"], variant="fine")
    assert [edge.elements for edge in problem.boundary.edges] == [12, 2, 7, 2, 8]
    assert (problem.name, problem.variants) == ("block on a plane, fine", {})
    overridden = bemcontact.spec.loads(VARIED, set=["material.poisson_ratio=0.1"], variant="fine")
    assert overridden.material.poisson_ratio == 0.1
    assert bemcontact.spec.loads(VARIED).edge("bottom").elements == 4


@pytest.mark.parametrize("variant", ["fine", "steep"])
def test_variant_of_the_file_equals_that_of_the_problem(variant, tmp_path):
    path = tmp_path / "block.yaml"
    path.write_text(VARIED, encoding="utf-8")
    problem = bemcontact.spec.load(path, variant=variant)
    assert problem == bemcontact.spec.load(path).variant(variant)
    assert bemcontact.spec.loads(bemcontact.spec.as_run(path.read_text(), str(path), variant=variant)) == problem
    assert bemcontact.spec.loads(
        bemcontact.spec.as_run(path.read_text(), str(path), ["mesh.refine=2"], variant)
    ) == problem.refined(2)


@pytest.mark.parametrize(
    ("old", "new", "variant", "line"),
    [
        ("ratio: 0.25", "ratio: 0.7", None, "block.yaml:33:31: variants.fine.set.material.poisson_ratio: with this"),
        ("ratio: 0.25", "ratio: 0.7", "fine", "block.yaml:33:31: material.poisson_ratio: … greater than -1"),
        ("outer.bottom", "outer.bot", None, "block.yaml:32:36: variants.fine.set.boundary.outer.bot.elements: "),
        ("outer.bottom", "outer.bot", "fine", "block.yaml:32:36: variants.fine.set.boundary.outer.bot.elements: "),
        ("    set:", "    sat:", "fine", "block.yaml:31:5: variants.fine.sat: unknown … 'sat' … 'set'"),
        ("", "", "fime", "variant fime: unknown … 'fime' … 'fine'"),
        ("", "", "", "variant '': … empty; … fine, steep"),
    ],
)
def test_mistakes_in_variants_are_located(old, new, variant, line):
    text = VARIED.replace(old, new, 1)
    with pytest.raises(SpecError) as caught:
        bemcontact.spec.loads(text, "block.yaml", variant=variant)
    (found,) = str(caught.value).splitlines()
    assert_states(found, line)


def test_later_issues_of_a_variant_are_located_in_it(tmp_path):
    path = tmp_path / "block.yaml"
    path.write_text(VARIED, encoding="utf-8")
    error = ProblemError(Issue(path=("conditions", "top", "pressure"), message="pulls the body off"))
    located = bemcontact.spec.located(error, path.read_text(), str(path), variant="steep")
    assert str(located) == f"{path}:34:44: conditions.top.pressure: pulls the body off"


def test_common_encodings_are_read(tmp_path):
    for encoding in ("utf-8", "utf-8-sig", "utf-16"):
        for newline in ("\n", "\r\n"):
            path = tmp_path / "block.yaml"
            path.write_bytes(SPEC.replace("block on", "Größe auf").replace("\n", newline).encode(encoding))
            assert bemcontact.spec.load(path).name == "Größe auf a plane"


def test_file_in_another_encoding_is_refused_at_its_byte(tmp_path):
    path = tmp_path / "latin.yaml"
    path.write_bytes("units: {}\nname: Größe\n".encode("latin-1"))
    with pytest.raises(SpecError) as caught:
        bemcontact.spec.load(path)
    assert_states(str(caught.value), f"{path}:2:9: … 0xf6 … save the file as UTF-8")


def test_binary_file_is_refused(tmp_path):
    path = tmp_path / "picture.png"
    path.write_bytes(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR")
    with pytest.raises(SpecError) as caught:
        bemcontact.spec.load(path)
    assert str(caught.value).startswith(f"{path}: this is not a text file")


def test_missing_file_is_refused_with_the_name_of_a_similar_one(tmp_path):
    (tmp_path / "block.yaml").write_text(SPEC, encoding="utf-8")
    with pytest.raises(SpecError, match=r"blok\.yaml: there is no such file; did you mean .*block\.yaml\?"):
        bemcontact.spec.load(tmp_path / "blok.yaml")
    with pytest.raises(SpecError, match="there is no directory"):
        bemcontact.spec.load(tmp_path / "nowhere" / "block.yaml")


def test_a_text_where_a_file_is_needed_and_the_reverse_name_the_other_function():
    with pytest.raises(SpecError, match=r"load needs the path of a file; found a text .*; bemcontact\.loads reads"):
        bemcontact.spec.load("name: block\nunits: {length: mm}\n" * 100)
    with pytest.raises(SpecError, match=r"found the text 'block\.yaml'; bemcontact\.load reads a file"):
        bemcontact.spec.loads("block.yaml")


def test_directory_is_refused(tmp_path):
    with pytest.raises(SpecError, match="is a directory"):
        bemcontact.spec.load(tmp_path)


def test_schema_describes_the_keys_and_both_forms_of_a_field():
    schema = bemcontact.spec.schema()
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert schema["required"] == ["name"]
    assert [set(one["required"]) for one in schema["anyOf"]] == [{"material", "boundary", "contact_zones"}, {"bodies"}]
    assert schema["$defs"]["Field"]["type"] == ["number", "object"]
    assert all(item["description"] for item in schema["properties"].values())
    json.dumps(schema)


def schema_errors(text):
    """Path and message of each JSON Schema error for a spec."""
    errors = schemas.of_spec().iter_errors(yaml.load(text, yaml.SafeLoader))
    return [(dotted(tuple(error.absolute_path)), error.message) for error in errors]


def keys_within(data):
    """All keys of nested mappings and lists."""
    for value in data.values() if isinstance(data, dict) else data if isinstance(data, list) else ():
        yield from keys_within(value)
    if isinstance(data, dict):
        yield from data


def test_limits_are_keywords_of_json_schema_and_not_of_pydantic():
    assert {"gt", "ge", "lt", "le"}.isdisjoint(keys_within(bemcontact.spec.schema()))


def test_schema_accepts_valid_specs():
    assert schema_errors(SPEC.replace("1e3", "1.0e+3")) == []
    assert schema_errors(VARIED.replace("1e3", "1.0e+3")) == []
    assert schema_errors(MODEL.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("path", sorted(MODEL.parent.glob("*.yaml")), ids=lambda path: path.stem)
def test_schema_accepts_the_models(path):
    """RawValue anew, for YAML 1.1 takes 2e6 for a text."""
    assert schema_errors(bemcontact.spec.as_run(path.read_text(), str(path), ["mesh.refine=1"])) == []


CONTOUR = "{kind: deflected_contour, direction: [0, 1], conditions: {top: {pressure: 2}}}"


@pytest.mark.parametrize("nothing", ["{}", "{traction: {}}"])
def test_empty_condition_of_a_contour_is_refused_at_its_place(nothing):
    """The error says how to remove the load of the problem, because an edge that is left out keeps it."""
    contour = CONTOUR.replace("{pressure: 2}", nothing)
    text = SPEC.replace("{kind: plane, point: [0, 0], normal: [0, 1]}", contour)
    (line,) = (number for number, found in enumerate(text.splitlines(), 1) if "deflected_contour" in found)
    column = text.splitlines()[line - 1].index(nothing) + 1
    with pytest.raises(SpecError) as caught:
        bemcontact.spec.loads(text, "block.yaml")
    (found,) = str(caught.value).splitlines()
    assert found.startswith(
        f"block.yaml:{line}:{column}: contact_zones.foot.surface.conditions.top: the condition is empty"
    )
    assert "give traction: {x: 0, y: 0}" in found
    bemcontact.spec.loads(text.replace(nothing, "{traction: {x: 0, y: 0}}"))


@pytest.mark.parametrize(
    ("old", "new", "path", "message"),
    [
        ("direction: [0, 1], ", "", "contact_zones.foot.surface", "'direction' is a required property"),
        ("pressure: 2", "presure: 2", "contact_zones.foot.surface.conditions.top", "('presure' was unexpected)"),
        ("conditions: {top: {pressure: 2}}", "conditions: 2", "contact_zones.foot.surface.conditions", "not of type"),
        ("set: {mesh.refine: 2}", "set: {}", "variants.fine.set", "{} should be non-empty"),
        ("set: {mesh.refine: 2}", "sets: {}", "variants.fine", "'set' is a required property"),
    ],
)
def test_schema_knows_contours_and_variants(old, new, path, message):
    text = SPEC.replace("{kind: plane, point: [0, 0], normal: [0, 1]}", CONTOUR).replace("1e3", "1.0e+3")
    text += "variants: {fine: {set: {mesh.refine: 2}}}\n"
    assert schema_errors(text) == []
    assert (path, True) in [(found, message in words) for found, words in schema_errors(text.replace(old, new))]


@pytest.mark.parametrize(
    ("old", "new", "path", "message"),
    [
        ("1e3", "-210.0e+3", "material.young_modulus", "-210000.0 is less than or equal to the minimum of 0"),
        ("poisson_ratio: .3", "poisson_ratio: 0.6", "material.poisson_ratio", "greater than the maximum of 0.5"),
        ("ratio: 3", "ratio: 0.3", "boundary.outer[2].grading", "is not valid"),
        ("towards: both", "towards: left", "boundary.outer[2].grading", "is not valid"),
        ("towards: both", "towards: 1.5", "boundary.outer[2].grading", "is not valid"),
        (
            "{name: left, elements: 2}",
            "{name: left, elements: 2, ends_at: [1.5]}",
            "boundary.outer[3].ends_at[0]",
            "1.5 is greater than or equal to the maximum of 1",
        ),
        ("elements: 8}", "elements: 0}", "boundary.holes[0][0].elements", "0 is not valid under any of the given"),
        ("radius: 0.25", "radius: 0.25, knots: 2", "boundary.holes[0][0]", "('knots' was unexpected)"),
        (
            "kind: arc",
            "kind: ark",
            "boundary.holes[0][0].kind",
            "'ark' is not one of ['line', 'arc', 'ellipse', 'spline', 'fillet']",
        ),
        ("kind: plane, ", "", "contact_zones.foot.surface", "'kind' is a required property"),
        ("normal: [0, 1]", "normal: 1", "contact_zones.foot.surface.normal", "1 is not of type 'array'"),
        ("edges: bottom", "edges: []", "contact_zones.foot.edges", "[] should be non-empty"),
        (SPEC[SPEC.index("contact_zones:") :], "contact_zones: {}\n", "contact_zones", "{} should be non-empty"),
    ],
)
def test_schema_reports_invalid_values(old, new, path, message):
    assert SPEC.count(old) == 1
    [(found, words)] = schema_errors(SPEC.replace(old, new).replace(": 1e3", ": 1.0e+3"))
    assert found == path
    assert message in words


def test_model_of_the_paper_is_short():
    """Geometry, load and references; no elements. The mesh of the paper is a variant."""
    stated, _, _ = MODEL.read_text(encoding="utf-8").partition("\nvariants:")
    problem = bemcontact.spec.load(MODEL)
    assert len(stated.splitlines()) <= 30
    assert not any(edge.elements for edge in problem.boundary.edges)
    assert "2.7685" in problem.description
    assert "183.335" in problem.description


@pytest.mark.parametrize("place", ["0.25", "[1.5, 1]"])
def test_elements_end_at_a_fraction_or_a_point(place):
    """The top runs from (2, 1) to (0, 1), so that (1.5, 1) is a quarter of its length from its start."""
    stated = bemcontact.spec.loads(SPEC.replace("towards: both}", f"towards: both}}\n      ends_at: [{place}]"))
    graded = bemcontact.spec.loads(SPEC.replace("towards: both", f"towards: {place}"))
    for problem in (stated, graded):
        assert problem.edge("top").breakpoints()[1] == 0.25
        assert schema_errors(SPEC.replace("towards: both", f"towards: {place}").replace("1e3", "1.0e+3")) == []


@pytest.mark.parametrize(("angle", "fraction"), [(337.5, 1 / 16), (90, 0.75), (0.01, 1 - 0.01 / 360)])
def test_elements_end_at_a_point_of_an_arc(angle, fraction):
    """The bore runs clockwise from 360 degrees."""
    x, y = 1 + 0.25 * math.cos(math.radians(angle)), 0.5 + 0.25 * math.sin(math.radians(angle))
    problem = bemcontact.spec.loads(SPEC.replace("elements: 8}", f"elements: 16, ends_at: [[{x!r}, {y!r}]]}}"))
    assert np.abs(problem.edge("bore").breakpoints() - fraction).min() <= 1e-14
