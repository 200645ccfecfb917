"""The page of all benchmarks of speed: it renders, and a section that fails is told and loses no other."""

import importlib
import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import local_solver
import numpy as np
import pytest
import run
import speed_cylinder
import speed_of_paths
import speed_over_earlier
import timing
from peers import Answer, Claim, Peer
from qp_instance import stated
from run import SECTIONS, before, outcome, write
from speed_page import RUN, SECTION, Outcome, Run, Section, Settings, Table, Target, markdown
from timing import MOST_AT_ONCE, Spread, children_time, in_turns, ratio

import bemcontact
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
        Target(name="in turns", asked=2.0, measured=Spread(median=1.9, lower=1.85, upper=2.0)),
        Target(name="slow", asked=2.0, measured=Spread(median=2.5, lower=2.01, upper=3.0), unit="s"),
        Target(name="noisy", asked=2.0, measured=Spread(median=1.9, lower=1.8, upper=2.1)),
        Target(name="noisily faster", asked=2.0, at_least=True, measured=Spread(median=2.1, lower=1.9, upper=2.2)),
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
    assert "| over LU | at most 2 | 1.5 |  | yes |" in page
    assert "| time | at most 8 s | 9.88 s |  | **no** |" in page
    assert "| faster | at least 1.8 | 1.9 |  | yes |" in page
    assert "| unknown | at most 1 | not measured |  |  |" in page
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
    assert run.arguments_of(Settings(earlier="abc")) == ["--earlier", "abc"]
    given = ["--quick", "--instances", str(tmp_path), "--earlier", "abc"]
    assert run.arguments_of(Settings(quick=True, instances=tmp_path, earlier="abc")) == given


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
    assert {file.name for file in tmp_path.iterdir()} == {"speed_before.json", "speed_before.md"}
    (tmp_path / "speed.json").write_text("{}")
    assert before(tmp_path / "speed.json", run_with()) == {}


def test_each_section_has_its_module():
    folder = run.Path(run.__file__).parent
    assert all((folder / f"{module}.py").is_file() for module in SECTIONS.values())


def test_a_target_is_met_beyond_noise_if_both_quartiles_are_on_its_side():
    """Yes and no each need both; the target itself is good enough."""
    page = lines(markdown(run_with(solve=Outcome(seconds=60.0, section=GOOD))))
    assert "| in turns | at most 2 | 1.9 | 1.85 to 2 | yes |" in page
    assert "| slow | at most 2 s | 2.5 s | 2.01 to 3 | **no** |" in page
    assert "| noisy | at most 2 | 1.9 | 1.8 to 2.1 | within noise |" in page
    assert "| noisily faster | at least 2 | 2.1 | 1.9 to 2.2 | within noise |" in page


@pytest.mark.parametrize(
    ("values", "lower", "median", "upper"),
    [([3], 3, 3, 3), ([1, 2], 1.25, 1.5, 1.75), ([9, 1, 5, 3, 7], 3, 5, 7)],
    ids=["one", "two", "five"],
)
def test_median_and_quartiles(values, lower, median, upper):
    """Of 1, 3, 5, 7, 9 they are the second, third and fourth; of two values they are between them."""
    assert Spread.of(values) == Spread(median=median, lower=lower, upper=upper)


def test_ratios_are_of_neighboring_turns():
    """An action that takes twice as long as the other one does so in a slow round too; the ratio of leasts is 2.4."""
    slow = np.array([1.0, 1.0, 1.6, 1.7, 1.0])
    turns = 2.0 * slow, slow * [1.0, 1.0, 1.0, 1.0, 2.0 / 2.4]
    assert ratio(*turns).median == 2.0
    assert min(turns[0]) / min(turns[1]) == pytest.approx(2.4)


def test_actions_run_in_turns():
    """In each round each action runs, brief ones a few times; the order of the rounds is kept."""
    done = []
    turns = in_turns({name: lambda name=name: done.append(name) for name in "ab"}, 2)
    assert done[: 2 * MOST_AT_ONCE] == ["a"] * MOST_AT_ONCE + ["b"] * MOST_AT_ONCE
    assert set(turns) == {"a", "b"}
    rounds = len(done) // (2 * MOST_AT_ONCE)
    assert all(len(times) == rounds for turn in turns.values() for times in (turn.cpu, turn.wall))


def test_a_turn_of_a_brief_action_is_its_least_time(monkeypatch):
    """A clock of three runs of 3, 2 and 4 ms."""
    looks = iter([0, 3, 3, 5, 5, 9])
    monkeypatch.setattr(timing.time, "perf_counter", lambda: 0.0)
    assert timing.one_turn(lambda: None, lambda: 1e-3 * next(looks)) == (pytest.approx(2e-3), 0.0)


@pytest.mark.skipif(sys.platform == "win32", reason="no times of children")
def test_the_time_of_children_is_that_of_processes():
    """A process that takes 0.2 s of its own adds as much and its start, and none to the time of this one."""
    busy = "import time\nwhile time.process_time() < 0.2: pass"
    before = children_time()
    subprocess.run(script(busy), check=True)
    assert children_time() - before >= 0.2


def test_our_time_over_that_of_a_solver():
    """Geometric means over what both solved: √(2 · 8) = 4 in the first round, √(4 · 9) = 6 in the second."""
    ours = np.array([[2.0, 8.0, 1.0], [4.0, 9.0, 1.0], [1.0, 1.0, 1.0]])
    theirs = np.array([[1.0, 1.0, np.nan], [1.0, 1.0, np.nan]])
    spread = local_solver.ratio(ours, theirs)
    assert (spread.lower, spread.median, spread.upper) == pytest.approx((4.5, 5.0, 5.5))
    assert local_solver.ratio(ours, np.full((2, 3), np.nan)) is None


@pytest.mark.skipif(sys.platform == "win32", reason="processes do not fork")
def test_a_series_has_times_of_what_was_solved(capfd):
    """It is called once before that; not again with what it does not solve. What it prints appears nowhere."""
    solved = []

    def solve(instance):
        os.write(1, b"a banner")
        solved.append(instance.name)
        return Answer(x=None if instance.name == "bad" else np.zeros(1), claim=Claim.OPTIMAL)

    peer = Peer(name="zero", package="numpy", solve=solve)
    instances = [stated(name, "made here", [[1]], [0]) for name in ("good", "bad")]
    [taken] = local_solver.series([peer], [local_solver.trials(peer, instances, 20.0)], rounds=3)
    assert taken.shape == (3, 2)
    assert (taken[:, 0] >= 0).all()
    assert np.isnan(taken[:, 1]).all()
    assert solved == ["good"] * (1 + 3)
    assert capfd.readouterr().out == ""


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


@pytest.mark.slow
def test_a_worker_has_the_code_of_its_folder(tmp_path):
    """It writes the compliance that this process finds, and adds up its time; what is not there is an error."""
    with speed_over_earlier.Worker(speed_over_earlier.ROOT, "NumPy") as worker:
        worker("condense", 1, tmp_path / "values.npy")
        assert 0 < worker.spent < 60
    with speed_cylinder.assembled_by("NumPy"):
        contact = bemcontact.condense(speed_cylinder.cylinder(1))
    np.testing.assert_array_equal(np.load(tmp_path / "values.npy"), contact.compliance)
    assert bemcontact.solve(speed_cylinder.cylinder(1)).degrees_of_freedom == speed_over_earlier.UNKNOWNS
    with speed_over_earlier.Worker(tmp_path, "NumPy") as worker, pytest.raises(RuntimeError, match="cannot solve"):
        worker("solve", 1)
