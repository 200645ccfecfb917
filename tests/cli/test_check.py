"""Commands that solve no contact: check, condense and schema."""

import json
import re
from pathlib import Path

import pytest
from command_line import BLOCK, PRESS, assert_refused, in_one_process, run

import bemcontact
from bemcontact import spec
from bemcontact.analysis import solve as analysis
from bemcontact.contact.condensed_contact import CondensedContact

CONTOUR = """
conditions:
  left: {displacement: {x: 0}}
  top: {pressure: 3}
contact_zones:
  foot:
    edges: bottom
    surface:
      kind: deflected_contour
      conditions: {right: {traction: {x: 1}}}
      direction: [0, 1]
"""


def test_a_contour_that_cannot_be_found_is_located(block: Path):
    """Contact would hold the block, but the contour is computed without contact."""
    text = BLOCK[: BLOCK.index("conditions:")] + CONTOUR
    block.write_text(text, encoding="utf-8")
    answer = run("check", block)
    line = text.splitlines().index("      conditions: {right: {traction: {x: 1}}}") + 1
    assert answer.exit_code == 2
    assert f"block.yaml:{line}:19: contact_zones.foot.surface.conditions: with these" in " ".join(answer.stderr.split())


def test_check_prints_the_facts(block: Path):
    answer = run("check", block, "--set", "boundary.outer[0].elements=5")
    assert answer.exit_code == 0, answer.stderr
    for word in ("bottom", "right", "top", "left", "foot", "plane", "pressure", "translation", "contact"):
        assert word in answer.stdout
    assert "13 elements, 26 nodes, 11 contact points" in answer.stdout  # two nodes for each element
    assert re.search(r"Degrees of freedom +52\b", answer.stdout)
    assert "(0, -120) N/mm" in answer.stdout  # 3 MPa down on 40 mm
    assert max(map(len, answer.stdout.splitlines())) <= 100


@pytest.mark.slow
def test_check_starts_without_solvers(block: Path):
    """It meshes the body and balances its loads, with NumPy alone for a body that is free in one way."""
    scipy = tuple(f"scipy.{name}" for name in ("linalg", "optimize", "sparse", "special", "interpolate"))
    rooms = ("formulations", "assessment", "parametric", "modelling", "reference", "studies", "serialization")
    others = ("bem.system", "bem.condense", "analysis.solve", "contact.condensed_contact")
    slow = (*scipy, "cvxpy", "matplotlib", "threadpoolctl", *(f"bemcontact.{name}" for name in (*rooms, *others)))
    code = f"print([m for m in {slow} if m in sys.modules], file=sys.stderr)"
    commands = [f"check {block} --set boundary.outer[0].elements={n} --set accuracy=0.01" for n in ("4", "null")]
    answer = in_one_process(*commands, code=code)
    assert answer.stdout.count("status 0\n") == len(commands)
    assert answer.stderr == "[]\n"


@pytest.mark.slow
def test_bodies_that_are_free_in_several_ways_start_without_programs():
    """Small programs, and arcs of ellipses, need no part of SciPy of their own."""
    slow = tuple(f"scipy.{name}" for name in ("optimize", "sparse", "special", "interpolate"))
    code = f"print([m for m in {slow} if m in sys.modules], file=sys.stderr)"
    models = Path(bemcontact.__file__).parents[1] / "models"
    checked = ("gallery/roller_in_v_block", "gallery/shrink_fit", "elliptical_crack_closure")
    solved = ("gallery/block_in_corner", "gallery/shrink_fit")
    commands = [f"check {models / name}.yaml" for name in checked] + [f"solve {models / name}.yaml" for name in solved]
    answer = in_one_process(*commands, code=code)
    assert answer.stdout.count("status 0\n") == len(commands)
    assert answer.stderr == "[]\n"


def test_condense_writes_what_solve_reads(block: Path, tmp_path: Path):
    out = tmp_path / "block.npz"
    answer = run("condense", block, "--out", out)
    assert answer.exit_code == 0, answer.stderr
    result = analysis.solve(CondensedContact.load(out))
    assert result.certified
    assert result.solution.pressure == pytest.approx([3.0] * 9, rel=1e-9)


def test_schema_is_json_schema():
    answer = run("schema")
    assert answer.exit_code == 0
    found = json.loads(answer.stdout)
    assert "2020-12" in found["$schema"]
    assert {"material", "boundary", "contact_zones"} <= found["properties"].keys()


def test_a_condensed_problem_is_written_as_npz_only(block: Path):
    assert_refused(run("condense", block, "--out", block.with_suffix(".txt")), r"--out: .*must end in \.npz")


def test_condensed_problem_keeps_its_cases(tmp_path: Path):
    answer = run("condense", PRESS, "--out", tmp_path / "press.npz")
    assert answer.exit_code == 0, answer.stderr
    contact = bemcontact.CondensedContact.load(tmp_path / "press.npz")
    assert contact.cases.names == ("off the middle", "raised")
    found = bemcontact.solve(contact.with_factors({"off the middle": 2}))
    assert found.solution.pressure.max() == pytest.approx(200, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("top: {pressure: 3}", "top: {pressure: -3}"),
        ("top: {pressure: 3}", "top: {displacement: {x: 1}}"),
        ("{displacement: {x: 0}}", "{traction: {x: 1}}"),
        ("top: {pressure: 3}", "topp: {pressure: 3}"),
        ("top: {pressure: 3}", "top: {pressure: true}"),
        ("210e3", "-1"),
        ("poisson_ratio: 0.3", "poisson_ratio: 0.3\n  density: 3"),
        ("name: block on a table", "name: []"),
        ("units: {length: mm, force: N}", "units: 3"),
        ("edges: bottom", "edges: buttom"),
        ("edges: bottom", "edges: top"),
        ("normal: [0, 1]", "normal: [0, -1]"),
        ("kind: plane, point: [0, 0], normal: [0, 1]", "kind: deflected_contour, direction: [0, 1]"),
        ("contact_zones:", "tools: {press: {zones: fot, force: {y: 1}}}\ncontact_zones:"),
        ("contact_zones:", "tools: {press: {zones: foot, force: {y: -1}}}\ncontact_zones:"),
        ("contact_zones:", "load_cases: {up: {conditions: {top: {pressure: -9}}}}\ncontact_zones:"),
        ("contact_zones:", "load_cases: {up: {tools: {it: {force: {y: 1}}}}}\ncase: dwn\ncontact_zones:"),
        ("contact_zones:", "loads: {gravity: 3}\nmesh: {refine: 0}\ncontact_zones:"),
    ],
)
@pytest.mark.parametrize("elements", ["stated", "found"])
def test_check_draws_what_can_be_read_of_a_refused_problem(
    block: Path, tmp_path: Path, old: str, new: str, elements: str
):
    picture, text = tmp_path / "picture.svg", BLOCK.replace(old, new)
    if elements == "found":
        text = re.sub(r", elements: \d|accuracy: null\n", "", text)
    block.write_text(text, encoding="utf-8")
    answer = run("check", block, "--figure", picture)
    assert answer.exit_code == 2
    assert "error: " in answer.stderr
    assert "shows the parts of the problem that could be read" in answer.stderr
    assert "<svg" in picture.read_text(encoding="utf-8")


def test_check_draws_nothing_without_a_sound_boundary(block: Path, tmp_path: Path):
    for old, new in (("start: [40, 0]", "start: [40, 99]"), ("elements: 4", "elements: 4000000"), ("boundary:", "a:")):
        block.write_text(BLOCK.replace(old, new), encoding="utf-8")
        answer = run("check", block, "--figure", tmp_path / "picture.svg")
        assert answer.exit_code == 2
        assert "picture.svg is not written" in " ".join(answer.stderr.split())
        assert not (tmp_path / "picture.svg").exists()


STACK = """
name: stack
units: {length: mm, force: N}
materials: {steel: {young_modulus: 210 GPa, poisson_ratio: 0.3}}
bodies:
  lower:
    material: steel
    boundary:
      outer: [{name: bottom, start: [0, 0]}, {name: right, start: [4 cm, 0]}, {name: top, start: [40, 20]}, {name: left, start: [0, 20]}]
    conditions: {bottom: {fixed: true}}
  upper: {copy_of: lower, shift: [0, 20], conditions: {top: {pressure: 3}, left: {displacement: {x: 0}}}}
  stop:
    rigid: true
    boundary: {outer: [{name: rim, kind: arc, center: [50, 10], radius: 10, angles: [-90, 270]}]}
contacts:
  joint: {between: [upper/bottom, lower/top]}
  beside: {between: [lower/right, stop]}
"""  # noqa: E501


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "drawn", "missing"),
    [
        ("poisson_ratio", "poissonratio", ["joint", "stop"], []),
        ("material: steel", "material: stel", ["joint", "stop"], []),
        ("upper/bottom", "upper/botom", ["stop"], ["joint"]),
        ("lower/top", "lower/right", ["stop"], ["joint"]),
        ("lower, shift", "lowr, shift", ["lower", "stop"], ["joint", "upper"]),
        ("bottom: {fixed: true}", "botom: {fixed: true}", ["joint", "stop"], ["u_x"]),
        ("{pressure: 3}", "{pressure: -3}", ["joint", "stop"], []),
        ("center: [50, 10]", "center: [50]", ["joint"], ["beside"]),
        ("  beside: {between: [lower/right, stop]}\n", "", ["joint"], ["beside"]),
        ("  beside", "  joint 2: {between: [lower/top, upper/bottom]}\n  beside", ["joint"], []),
    ],
)
def test_check_draws_what_can_be_read_of_several_bodies(
    tmp_path: Path, old: str, new: str, drawn: list[str], missing: list[str]
):
    """Bodies with a sound outline, and contacts whose sides are there and opposite to each other."""
    path, picture = tmp_path / "stack.yaml", tmp_path / "picture.svg"
    path.write_text(STACK.replace(old, new, 1), encoding="utf-8")
    answer = run("check", path, "--figure", picture)
    assert answer.exit_code == 2
    assert "shows the parts of the problem that could be read" in answer.stderr
    problem = spec.readable(path.read_text(encoding="utf-8"), "stack.yaml")
    assert problem is not None
    names = [*problem.bodies, *problem.contacts, *(["u_x"] if "lower/bottom" in problem.edge_conditions else [])]
    assert {*drawn} <= {*names}
    assert not {*missing} & {*names}
    assert "<svg" in picture.read_text(encoding="utf-8")
    assert ("rigid surface" in picture.read_text(encoding="utf-8")) == ("stop" in problem.bodies)
