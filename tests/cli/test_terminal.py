"""What a person sees while the program works: something on a terminal once it lasts, nothing elsewhere."""

import time

import pytest

from bemcontact.cli import terminal


@pytest.fixture
def no_patience(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(terminal, "PATIENCE", 0.0)


def worked() -> None:
    with terminal.stages() as report:
        report("solving", "start 2 of 3")
        time.sleep(0.3)  # a thread draws ten times in a second


@pytest.mark.usefixtures("no_patience")
def test_terminal_shows_progress(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setenv("FORCE_COLOR", "1")
    worked()
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "solving, start 2 of 3" in captured.err


@pytest.mark.usefixtures("no_patience")
def test_elsewhere_nothing_is_shown(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    worked()
    assert capsys.readouterr() == ("", "")


def test_short_work_shows_nothing(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setenv("FORCE_COLOR", "1")
    with terminal.stages() as report:
        report("solving", "")
    assert capsys.readouterr() == ("", "")


@pytest.mark.usefixtures("no_patience")
def test_stages_are_listed_one_below_the_other(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setenv("FORCE_COLOR", "1")
    with terminal.stages() as tell:
        tell("mesh", "")
        tell("QP1, random starts", "")
        tell("QP1, random starts", "3 of 20")
        time.sleep(0.3)  # a thread draws ten times in a second
    shown = capsys.readouterr().err
    assert "mesh" in shown
    assert "QP1, random starts, 3 of 20" in shown
    assert "✓" in shown
