"""Every file in models/ states a problem whose solution is certified, and is described."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from bemcontact import cli, spec

MODELS = sorted((Path(__file__).parents[1] / "models").glob("*.yaml"))


def test_there_are_models():
    assert MODELS


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_solution_is_certified(path: Path):
    answer = CliRunner().invoke(cli.app, ["solve", str(path), "--json", "-"])
    assert answer.exit_code == 0, answer.stderr
    assert json.loads(answer.stdout)["certified"] is True


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_model_is_described_and_short(path: Path):
    problem = spec.load(path)
    assert problem.description
    assert problem.units.stress
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 60
