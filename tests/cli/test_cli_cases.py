"""The command line with load cases and tools: all of them, one, and mistakes in one."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

import bemcontact
from bemcontact import cli

GALLERY = Path(__file__).parents[2] / "models" / "gallery"
PRESS = GALLERY / "body_between_two_tools.yaml"
CASES = ["off the middle", "raised", "edge of the kern", "off the middle and raised"]


def run(*arguments: object) -> Result:
    return CliRunner().invoke(cli.app, [str(argument) for argument in arguments])


def test_solve_without_case_solves_all():
    answer = run("solve", GALLERY / "roller_in_v_block.yaml")
    assert answer.exit_code == 0, answer.stderr
    assert all(f"\n{case} " in answer.stdout for case in ("still", "down", "aside"))
    assert "all certified" in answer.stdout
    assert "Largest peak" in answer.stdout


def test_solve_with_case_solves_one():
    """100 (1 + 12 e x / 60²) with e = 5: 150 at the edge."""
    answer = run("solve", PRESS, "--case", "off the middle")
    assert answer.exit_code == 0, answer.stderr
    assert "block between a press and a table, off the middle" in answer.stdout
    assert "150 N/mm²" in answer.stdout
    assert "press: moves by (0, -0.017333) mm" in answer.stdout


def test_json_of_all_cases_and_of_one():
    answer = run("solve", PRESS, "--json", "-")
    found = json.loads(answer.stdout)
    assert (found["certified"], [*found["cases"]]) == (True, CASES)
    assert found["worst"] == "edge of the kern"  # 200 at its edge
    one = json.loads(run("solve", PRESS, "--json", "-", "--case", "raised").stdout)
    assert one["pressure"] == pytest.approx(found["cases"]["raised"]["pressure"], rel=1e-12)
    table, press = one["tools"]
    assert (table["name"], press["name"]) == ("table", "press")
    assert table["displacement"] == pytest.approx([0, 0.1])
    assert press["force_of_body"] == pytest.approx([0, 6000], abs=1e-9)


def test_figure_of_all_cases(tmp_path: Path):
    assert run("solve", PRESS, "--figure", tmp_path / "all.png").exit_code == 0
    assert (tmp_path / "all.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("solve", "--case", "raisd"), "--case raisd: case: unknown load case 'raisd'; did you mean 'raised'?"),
        (("compare",), "load_cases: choose the one that acts, with case or --case: off the middle, raised,"),
        (("solve", "--vtk", "it.vtu"), "--vtk writes the boundary of one load case; name it with --case"),
        (
            ("solve", "--set", "tools.press.force.y=1000"),
            "load_cases.off the middle: the load pulls the tool 'press' off what it touches",
        ),
        (("check", "--set", "load_cases.raised.tools.table.force.x=1"), "the tool is held along x; add x: 0"),
    ],
)
def test_mistakes_are_reported_before_any_work(arguments: tuple[str, ...], words: str, tmp_path: Path):
    command, *options = arguments
    options = [str(tmp_path / option) if option.endswith(".vtu") else option for option in options]
    answer = run(command, PRESS, *options)
    assert answer.exit_code == 2
    assert words in " ".join(answer.stderr.split())
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize("command", ["check", "solve"])
def test_a_case_that_contact_cannot_hold_is_located(command: str, tmp_path: Path):
    """The moment of 6000 at 31 mm is beyond the edge of the press, at 30: the line of the load case is told."""
    path = tmp_path / "press.yaml"
    text = (
        PRESS.read_text(encoding="utf-8")
        .replace("moment: -30e3", "moment: -186e3")
        .replace("{off the middle: 2}", "{raised: 1}")
    )
    path.write_text(text, encoding="utf-8")
    line = next(i for i, part in enumerate(text.splitlines(), 1) if "-186e3" in part)
    answer = run(command, path)
    assert answer.exit_code == 2
    assert f"press.yaml:{line}:19: load_cases.off the middle: the load pulls the tool 'press'" in answer.stderr


def test_compare_judges_the_references_of_the_case():
    answer = run("compare", PRESS, "--case", "edge of the kern", "--json", "-")
    assert answer.exit_code == 0, answer.stderr
    (level,) = json.loads(answer.stdout)["levels"]
    assert {score["reference"] for score in level["scores"]} == {"edge of the kern", "press", "table"}
    assert all(score["judged"] and score["holds"] for score in level["scores"])


def test_condensed_problem_keeps_its_cases(tmp_path: Path):
    answer = run("condense", PRESS, "--out", tmp_path / "press.npz")
    assert answer.exit_code == 0, answer.stderr
    contact = bemcontact.CondensedContact.load(tmp_path / "press.npz")
    assert contact.cases.names == ("off the middle", "raised")
    found = bemcontact.solve(contact.with_factors({"off the middle": 2}))
    assert found.solution.pressure.max() == pytest.approx(200, rel=1e-9)
