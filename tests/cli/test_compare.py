"""The command compare: its table, its exit status, its mistakes."""

import json
import re
from pathlib import Path

import pytest
from command_line import PRESS
from jsonschema import validate
from typer.testing import CliRunner, Result

from bemcontact import cli
from bemcontact.analysis import compare as comparing
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.options import ComparisonOptions

SPEC = """\
name: block
units: {length: mm, force: N}
material: {young_modulus: 210e3, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: bottom, start: [0, 0], elements: 3}
    - {name: right, start: [40, 0], elements: 2}
    - {name: top, start: [40, 20], elements: 3}
    - {name: left, start: [0, 20], elements: 2}
conditions:
  left: {displacement: {x: 0}}
  top: {pressure: 3}  # so the contact pressure is 3
contact_zones:
  foot: {edges: bottom, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}
reference:
  uniform: {kind: uniform, pressure: 3}
"""


@pytest.fixture
def block(tmp_path: Path) -> Path:
    path = tmp_path / "block.yaml"
    path.write_text(SPEC, encoding="utf-8")
    return path


def run(*words: object) -> Result:
    return CliRunner().invoke(cli.app, [*map(str, words)], env={"COLUMNS": "100"})


def test_a_table_that_fits_and_a_verdict(block: Path):
    answer = run("compare", block)
    assert answer.exit_code == 0
    assert max(map(len, answer.output.splitlines())) <= 100
    for words in (
        "QP1",
        "QP2",
        "QP3",
        "direct",
        "solves it",
        "Equations      unique solution proved.",
        "Mesh           error at most",
        "uniform",
        "within 1 %",
        "Peak pressure  3",
    ):
        assert words in answer.output, words


def test_several_meshes_weights_and_penalties(block: Path):
    answer = run(
        "compare",
        block,
        "--refine",
        "1,2",
        "--weights",
        "tributary,element_length",
        "--penalty",
        "1e-3,1e3",
        "--starts",
        2,
    )
    assert answer.exit_code in (0, 1)
    assert max(map(len, answer.output.splitlines())) <= 100
    for words in ("refine 1", "refine 2", "asymmetry of J M", "QP2 (element length, μ = 0.001)", "2 of 2"):
        assert words in answer.output, words


def test_json_holds_what_the_schema_states(block: Path, tmp_path: Path):
    written = tmp_path / "compared.json"
    assert run("compare", block, "--formulations", " QP3 ", "--json", written).exit_code == 0
    printed = json.loads(run("compare", block, "--formulations", "qp3", "--json", "-").output)
    stored = json.loads(written.read_text(encoding="utf-8"))
    schema = json.loads(run("schema", "--report").output)
    for report in (printed, stored):
        validate(report, schema)
        assert report["levels"][0]["comparison"]["contenders"][0]["answer"]["peak"]["pressure"] == pytest.approx(3)


def test_comparison_that_is_not_certified_ends_with_status_1(block: Path, monkeypatch: pytest.MonkeyPatch):
    """Instead of the block a problem with a spurious local minimum, as in tests/assessment/test_comparison.py."""
    spurious = CondensedContact.from_compliance([[1.0, 2.0], [1.0, 1.0]], [-1.0, -2.0])
    found = comparing.mesh_study(ComparisonOptions.of(["qp1"]), spurious)
    monkeypatch.setattr(comparing, "mesh_study", lambda *_: found)
    answer = run("compare", block)
    assert answer.exit_code == 1
    assert "Equations      local only." in answer.output
    assert "Mesh           not assessed." in answer.output
    assert "stationary but not the solution" in answer.output
    assert "Not the solution: QP1" in " ".join(answer.output.split())
    told = run("compare", block, "--json", "-")
    assert told.exit_code == 1
    assert "not certified: " in told.stderr
    json.loads(told.stdout)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--formulations", "qp4"), "no formulation 'qp4'"),
        (("--weights", "tributary,,"), "no weights ''"),
        (("--formulations", "complementarity"), "is the reference of every comparison"),
        (("--formulations", "qp1", "--penalty", "1"), "a penalty is an option of qp2"),
        (("--seed", "3"), "a seed goes with random starts"),
        (("--out", "."), "--out . would replace"),
        (("--penalty", "1,x"), "--penalty: expected numbers with commas between, found 'x'"),
        (("--penalty", "0"), "the penalty must be a number"),
        (("--refine", "1,1.5"), "--refine: expected whole numbers with commas between, found '1.5'"),
        (("--refine", "0"), "the refinement must be a whole number of at least 1"),
        (("--refine", "2,2"), "the refinements must be different"),
        (("--json", "block.yaml/x.json"), "--json"),
        (("--set", "nonsense"), "there is no '='"),
        (("--starts", "0"), "'--starts'"),
    ],
)
def test_mistakes_end_with_status_2_and_a_message(
    block: Path, options: tuple, words: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(block.parent)
    answer = run("compare", block, *options)
    assert answer.exit_code == 2
    assert words in answer.stderr
    assert "Traceback" not in answer.output


def test_a_mistake_in_the_spec_is_reported_with_its_line(block: Path):
    block.write_text(SPEC.replace("elements: 3", "elements: -3", 1), encoding="utf-8")
    answer = run("compare", block)
    assert answer.exit_code == 2
    assert "block.yaml:6:" in answer.stderr


def test_compare_judges_the_references_of_the_case():
    answer = run("compare", PRESS, "--variant", "stated mesh", "--case", "edge of the kern", "--json", "-")
    assert answer.exit_code == 0, answer.stderr
    (level,) = json.loads(answer.stdout)["levels"]
    assert {score["reference"] for score in level["scores"]} == {"edge of the kern", "press", "table"}
    assert all(score["judged"] and score["holds"] for score in level["scores"])


@pytest.mark.slow
def test_all_load_cases_are_compared(tmp_path: Path):
    """Each formulation under each load case; one page; --refine needs one case."""
    press = Path(__file__).parents[2] / "models" / "gallery" / "body_between_two_tools.yaml"
    words = (press, "--variant", "stated mesh", "--formulations", "qp3", "--out", tmp_path / "report")
    answer = run("compare", *words)
    assert answer.exit_code == 0, answer.output
    cases = ("off the middle", "raised", "edge of the kern", "off the middle and raised")
    page = (tmp_path / "report" / "report.html").read_text(encoding="utf-8")
    for case in cases:
        assert re.search(rf"^{case} +solves it", answer.output, re.MULTILINE)
        assert case in page
    told = json.loads(run("compare", press, "--variant", "stated mesh", "--formulations", "qp3", "--json", "-").stdout)
    assert [*told["cases"]] == [*cases]
    refused = run("compare", press, "--refine", "1,2")
    assert refused.exit_code == 2
