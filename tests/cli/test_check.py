"""Commands that solve no contact: check, condense and schema."""

import json
import re
from pathlib import Path

import pytest
from command_line import BLOCK, PRESS, assert_refused, run

import bemcontact
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
    assert "(0, -120) N/mm" in answer.stdout  # 3 N/mm² down on 40 mm
    assert max(map(len, answer.stdout.splitlines())) <= 100


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
