"""The page of all benchmarks of speed: it renders, and a section that fails is told and loses no other."""

import importlib
import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import run
import speed_of_paths
from run import SECTIONS, before, outcome, write
from speed_page import RUN, SECTION, Outcome, Run, Section, Settings, Table, Target, markdown
from timing import MOST_AT_ONCE, geometric_mean, in_turns

from bemcontact.contact.condensed_contact import CondensedContact

GOOD = Section(
    title="A title",
    text="What is measured.",
    tables=[
        Table(title="Times", columns={"n": "d", "CPU, ms": ".1f", "": ""}, rows=[[3, 1.25, "quick"], [4, None, ""]]),
    ],
    targets=[
        Target(name="over LU", asked=2.0, measured=1.5),
        Target(name="time", asked=8.0, measured=9.876, unit="s"),
        Target(name="faster", asked=1.8, measured=1.9, at_least=True),
        Target(name="unknown", asked=1.0, measured=None),
    ],
    raw={"3": {"cpu": 0.00125}},
)


def run_with(**outcomes):
    names = ["solve", "studies"]
    return Run(date="", load=0.25, quick=False, machine={"Processor": "abacus"}, names=names, outcomes=outcomes)


def lines(text):
    return [line for line in text.splitlines() if line.startswith("|")]


def test_the_page_has_targets_and_tables():
    page = lines(markdown(run_with(solve=Outcome(seconds=60.0, section=GOOD))))
    assert "| Processor | abacus |" in page
    assert "| over LU | at most 2 | 1.5 | yes |" in page
    assert "| time | at most 8 s | 9.88 s | **no** |" in page
    assert "| faster | at least 1.8 | 1.9 | yes |" in page
    assert "| unknown | at most 1 | not measured |  |" in page
    assert page[-4:] == ["| n | CPU, ms |  |", "|---|---|---|", "| 3 | 1.2 | quick |", "| 4 |  |  |"]


def test_a_section_that_failed_is_told():
    page = markdown(run_with(solve=Outcome(seconds=60.0, section=GOOD), studies=Outcome(seconds=3.0, failed="no disk")))
    assert "sections failed: studies" in page
    assert "no disk" in page
    assert "A title" in page


def test_a_section_that_did_not_run_is_told():
    page = markdown(run_with(solve=Outcome(seconds=60.0, section=GOOD)))
    assert "did not run: studies" in page


def test_the_settings_reach_the_process_of_a_section(tmp_path):
    assert run.arguments_of(Settings()) == []
    assert run.arguments_of(Settings(quick=True, instances=tmp_path)) == ["--quick", "--instances", str(tmp_path)]


def test_a_row_that_does_not_fit_its_columns_is_an_error():
    bad = Section(title="", text="", tables=[Table(columns={"a": "", "b": ""}, rows=[["x"]])])
    with pytest.raises(ValueError, match="zip"):
        markdown(run_with(solve=Outcome(seconds=0.0, section=bad)))


def test_json_gives_the_same_run_again():
    whole = run_with(solve=Outcome(seconds=60.0, section=GOOD))
    again = RUN.validate_json(RUN.dump_json(whole))
    assert markdown(again) == markdown(whole)
    assert json.loads(RUN.dump_json(whole))["outcomes"]["solve"]["section"]["raw"] == {"3": {"cpu": 0.00125}}


def script(text):
    return [sys.executable, "-c", text]


def test_a_process_that_writes_a_section(tmp_path):
    into = tmp_path / "section"
    into.write_bytes(SECTION.dump_json(GOOD))
    assert outcome(script("pass"), into).section is not None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("raise ValueError('wrong number')", "wrong number"),
        ("import os; os._exit(7)", "exit status 7"),
        ("pass", "no section was written"),
    ],
)
def test_a_process_that_fails_says_why(text, words, tmp_path):
    done = outcome(script(text), tmp_path / "section")
    assert done.section is None
    assert words in done.failed


def test_a_process_that_takes_too_long_is_ended(tmp_path):
    done = outcome(script("import time; time.sleep(60)"), tmp_path / "section", limit=0.5)
    assert "limit of 0.5 s" in done.failed
    assert done.seconds < 30


def test_a_failure_loses_no_other_section(tmp_path, monkeypatch):
    """The second section ends with an error; the page is complete, and the third one ran."""
    ends = iter(
        [Outcome(seconds=1.0, section=GOOD), Outcome(seconds=1.0, failed="broken"), Outcome(seconds=1.0, section=GOOD)]
    )
    monkeypatch.setattr(run, "outcome", lambda command, into: next(ends))
    done = run.run_all(["threads", "solve", "studies"], tmp_path, Settings(quick=True))
    assert done.failed == ["solve"]
    assert RUN.validate_json((tmp_path / "speed.json").read_bytes()).failed == ["solve"]
    assert "broken" in (tmp_path / "speed.md").read_text(encoding="utf-8")


def test_an_interrupt_ends_the_run_and_keeps_the_page(tmp_path, monkeypatch):
    ends = iter([Outcome(seconds=1.0, section=GOOD), Outcome(seconds=1.0, failed=run.INTERRUPTED)])
    monkeypatch.setattr(run, "outcome", lambda command, into: next(ends))
    done = run.run_all(["threads", "solve", "studies"], tmp_path, Settings(quick=True))
    assert list(done.outcomes) == ["threads", "solve"]
    assert (tmp_path / "speed.md").is_file()


def test_other_sections_are_kept_from_the_same_machine_only(tmp_path):
    whole = run_with(solve=Outcome(seconds=60.0, section=GOOD))
    write(tmp_path, whole)
    other = replace(run_with(), machine={"Processor": "slide rule"})
    assert before(tmp_path / "speed.json", run_with()).keys() == {"solve"}
    assert before(tmp_path / "speed.json", other) == {}
    (tmp_path / "speed.json").write_text("{}")
    assert before(tmp_path / "speed.json", run_with()) == {}


def test_each_section_has_its_module():
    folder = run.Path(run.__file__).parent
    assert all((folder / f"{module}.py").is_file() for module in SECTIONS.values())


def test_the_geometric_mean_of_ratios():
    """√(2 · 8) = 4; of none there is no mean."""
    assert geometric_mean([2.0, 8.0]) == pytest.approx(4.0)
    assert geometric_mean([]) is None


def test_actions_run_in_turns():
    """In each round each action runs, brief ones a few times; the order of the rounds is kept."""
    done = []
    times = in_turns({name: lambda name=name: done.append(name) for name in "ab"}, 2)
    assert done[: 2 * MOST_AT_ONCE] == ["a"] * MOST_AT_ONCE + ["b"] * MOST_AT_ONCE
    assert set(times) == {"a", "b"}


@pytest.mark.slow
def test_a_path_is_compared_with_a_solve_at_each_breakpoint():
    """Two springs of compliance 1 that close at loads 1 and 3: breakpoints at 0, 1/4, 3/4 and the end of the load 4."""
    springs = CondensedContact.from_compliance(np.eye(2), [1.0, 3.0])
    contact = replace(springs, free_displacement=np.array([-4.0, -4.0]))
    _, points, breakpoints, _, apart, *_ = speed_of_paths.row("springs", contact)
    assert (points, breakpoints) == (2, 4)
    assert apart < 1e-14


@pytest.mark.parametrize("path", sorted(Path(__file__).parent.glob("[!t]*.py")), ids=lambda path: path.stem)
def test_each_benchmark_finds_what_it_imports(path: Path):
    """They are run by hand: without this a name that was moved would be missed."""
    importlib.import_module(path.stem)
