"""The command reproduce: its table, its files, its exit status, its mistakes."""

import json
from pathlib import Path

import pytest
from jsonschema import validate
from reproductions import of_the_cylinder, on_base_meshes, with_coarse_mesh_judged
from typer.testing import CliRunner, Result

from bemcontact import cli
from bemcontact.analysis import reproduction as analysis


def run(*words: object) -> Result:
    return CliRunner().invoke(cli.app, [*map(str, words)], env={"COLUMNS": "100"})


@pytest.mark.slow
def test_it_runs_from_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    answer = run("reproduce", "--refine", "1", "--json", "-")
    assert answer.exit_code == 0, answer.stderr
    printed = json.loads(answer.stdout)
    validate(printed, json.loads(run("schema", "--reproduction").stdout))
    assert [item["model"] for item in printed["problems"]] == [item.paper.model for item in on_base_meshes().problems]
    for told, known in zip(printed["problems"], on_base_meshes().to_dict()["problems"], strict=True):
        assert told["statements"] == known["statements"]
    assert [*tmp_path.iterdir()] == []


@pytest.mark.slow
def test_a_table_a_page_and_its_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Of one problem on its base mesh, whatever is asked for."""
    monkeypatch.setattr(analysis, "reproduce", lambda *_: of_the_cylinder())
    place, numbers = tmp_path / "paper", tmp_path / "n.json"
    answer = run("reproduce", "--out", place, "--json", numbers)
    assert answer.exit_code == 0
    assert "reproduced. " in answer.stdout
    assert {path.name for path in place.iterdir()} == {"page.html", "numbers.json", "figures"}
    assert numbers.read_text(encoding="utf-8") == (place / "numbers.json").read_text(encoding="utf-8")


@pytest.mark.slow
def test_reproduction_that_fails_ends_with_status_1(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(analysis, "reproduce", lambda *_: with_coarse_mesh_judged())
    answer = run("reproduce")
    assert answer.exit_code == 1
    assert "NOT reproduced" in answer.stdout
    told = run("reproduce", "--json", "-")
    assert told.exit_code == 1
    assert "not reproduced: " in told.stderr
    assert json.loads(told.stdout)["reproduced"] is False


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--refine", "1,x"), "--refine: expected whole numbers with commas between, found 'x'"),
        (("--refine", "0"), "the refinement must be a whole number of at least 1"),
        (("--refine", "2,2"), "the refinements must be different"),
        (("--out", "full"), "which is not part of a reproduction; name a new"),
        (("--out", "full/report.json/paper"), "is a file, and can hold no folder"),
        (("--out", "full", "--json", "full/n.json"), "--out full would replace full/n.json"),
        (("--json", "none/x.json"), "--json"),
    ],
)
def test_mistakes_end_with_status_2_and_a_message(
    tmp_path: Path, options: tuple, words: str, monkeypatch: pytest.MonkeyPatch
):
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "report.json").touch()
    monkeypatch.chdir(tmp_path)
    answer = run("reproduce", *options)
    assert answer.exit_code == 2
    assert words in answer.stderr
    assert "Traceback" not in answer.output
    assert [path.name for path in tmp_path.iterdir()] == ["full"]


def test_two_schemas_at_once_are_refused():
    answer = run("schema", "--report", "--reproduction")
    assert answer.exit_code == 2
    assert "choose one" in answer.stderr
