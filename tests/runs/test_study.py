"""Studies in Python: folder, journal, what is solved again and what is not."""

import csv
import json
import multiprocessing
import signal
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest

import bemcontact
from bemcontact.errors import OptionError
from bemcontact.runs import study as running
from bemcontact.studies.journal import JOURNAL
from bemcontact.studies.work import Task

CYLINDER = bemcontact.load(Path(__file__).parents[2] / "models" / "cylinder_on_plane.yaml", variant="paper")
LOAD, MODULUS = "conditions.top.pressure", "material.young_modulus"
VARIED = {LOAD: [10.0, 20.0, -5.0], MODULUS: [900.0, 1100.0]}


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Numbers of the members that are solved, in turn."""
    numbers, original = list[int](), running.rows_here

    def watched(plan: running.StudyPlan, tasks: Iterator[Task]) -> running.Rows:
        for row in original(plan, tasks):
            numbers.append(row.number)
            yield row

    monkeypatch.setattr(running, "rows_here", watched)
    return numbers


def test_rows_are_those_of_solve_and_a_failure_is_one_of_them():
    study = bemcontact.study(CYLINDER, VARIED, "peak")
    assert [row.values[LOAD] for row in study.rows] == [10.0, 10.0, 20.0, 20.0, -5.0, -5.0]
    for row in study.rows[:4]:
        peak = bemcontact.solve(CYLINDER.with_values(row.values)).footprint.peak
        assert peak is not None
        assert row.outputs["peak"].value == pytest.approx(peak.pressure, rel=1e-9)
    assert study.counts == {"failed": 2, "mesh not assessed": 4}
    assert study.holds is False
    assert repr(study).endswith(f"over {LOAD} (3) × {MODULUS} (2): 6 members, 2 failed, 4 mesh not assessed>")
    assert study._repr_html_().count("<tr>") == 7


@pytest.mark.slow
def test_a_folder_has_the_same_numbers_as_the_study(tmp_path: Path):
    study = bemcontact.study(CYLINDER, VARIED, ["peak", "force"], out=tmp_path / "study")
    names = {path.name for path in (tmp_path / "study").iterdir()}
    assert names == {"study.html", "study.json", "study.csv", "study.parquet", JOURNAL, "figures"}
    told = json.loads((tmp_path / "study" / "study.json").read_text(encoding="utf-8"))
    assert told == json.loads(study.to_json())
    with (tmp_path / "study" / "study.csv").open(encoding="utf-8", newline="") as file:
        rows = [*csv.DictReader(file)]
    table = study.table()
    assert [*rows[0]] == [*table]
    assert [float(row["peak"]) if row["peak"] else None for row in rows] == table["peak"]
    assert "pulls the body off" in rows[-1]["message"]


@pytest.mark.slow
def test_a_wrong_value_is_refused_while_processes_get_ready(tmp_path: Path):
    """No process and no folder is left; right values are solved by the same number of processes."""
    place = tmp_path / "study"
    with pytest.raises(bemcontact.ProblemError, match="young_modulus"):
        bemcontact.study(CYLINDER, {MODULUS: [900.0, -1.0]}, out=place, workers=2)
    assert multiprocessing.active_children() == []
    assert not place.exists()
    first = bemcontact.study(CYLINDER, {MODULUS: [900.0, 1000.0]}, out=place, workers=2)
    assert bemcontact.study(CYLINDER, {MODULUS: [900.0, 1000.0]}, out=place).rows == first.rows


@pytest.mark.slow
def test_a_study_in_a_folder_solves_nothing_twice(tmp_path: Path, solved: list[int]):
    place = tmp_path / "study"
    first = bemcontact.study(CYLINDER, VARIED, ["peak"], out=place)
    assert sorted(solved) == [*range(6)]
    again = bemcontact.study(CYLINDER, VARIED, ["moment"], out=place)  # another output is in the journal too
    assert len(solved) == 6
    assert again.rows == first.rows
    more = bemcontact.study(CYLINDER, {**VARIED, MODULUS: [900.0, 1000.0, 1100.0]}, ["peak"], out=place)
    assert {more.rows[number].values[MODULUS] for number in solved[6:]} == {1000.0}
    assert [row.outputs for row in more.rows if row.values[MODULUS] != 1000.0] == [row.outputs for row in first.rows]
    bemcontact.study(CYLINDER.with_value("material.poisson_ratio", 0.25), VARIED, ["peak"], out=place)
    assert len(solved) == 9 + 6  # of another problem nothing is known


@pytest.mark.slow
def test_members_are_solved_again_for_their_largest_stresses_only(tmp_path: Path, solved: list[int]):
    """A row without stresses does not serve a study of them; one with them serves any other study."""
    vary = {LOAD: [10.0, 20.0]}
    for outputs, again in ((["peak"], 2), (["von_mises"], 2), (["length", "max_shear"], 0), (["peak"], 0)):
        before = len(solved)
        study = bemcontact.study(CYLINDER, vary, outputs, out=tmp_path / "study")
        assert len(solved) - before == again
    assert study.columns == ("peak",)
    fresh = bemcontact.study(CYLINDER, vary, ["max_shear"], out=tmp_path / "fresh")
    assert len(solved) == 6
    assert bemcontact.study(CYLINDER, vary, ["peak"], out=tmp_path / "fresh").rows == fresh.rows
    assert len(solved) == 6


@pytest.mark.slow
def test_a_run_that_is_interrupted_anywhere_goes_on_to_the_same_table(tmp_path: Path, solved: list[int]):
    """An interrupt after each number of rows; at the end every member was solved once."""
    expected = bemcontact.study(CYLINDER, VARIED, ["peak"]).to_csv()
    solved.clear()

    def interrupt(stage: str, now: str) -> None:
        if stage == running.STAGE and " per second" in now:
            raise KeyboardInterrupt

    for _ in range(6):
        with pytest.raises(KeyboardInterrupt):
            bemcontact.study(CYLINDER, VARIED, ["peak"], out=tmp_path / "study", progress=interrupt)
    study = bemcontact.study(CYLINDER, VARIED, ["peak"], out=tmp_path / "study", progress=interrupt)
    assert study.to_csv() == expected
    assert sorted(solved) == [*range(6)]


def test_progress_says_how_far_it_has_come_and_how_long_it_takes(tmp_path: Path):
    said = list[tuple[str, str]]()
    told = {"out": tmp_path / "study", "progress": lambda stage, now: said.append((stage, now))}
    bemcontact.study(CYLINDER, VARIED, ["peak"], **told)
    assert said[0] == ("studying", "0 of 6 members")
    assert said[6][1].startswith("6 of 6 members, ")
    assert said[6][1].endswith(" per second")
    assert said[5][1].endswith(" left")
    assert said[7] == ("report", "")


@pytest.mark.skipif(not hasattr(signal, "SIGPIPE"), reason="Windows has no such signal")
def test_a_worker_that_ends_does_not_end_the_program_by_its_pipe():
    """The command line ends by SIGPIPE where its reader does; while workers are at work it must not."""
    at_work, before = list[object](), signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    try:
        bemcontact.study(CYLINDER, VARIED, progress=lambda *_: at_work.append(signal.getsignal(signal.SIGPIPE)))
        assert {*at_work} == {signal.SIG_IGN}
        assert signal.getsignal(signal.SIGPIPE) is signal.SIG_DFL
    finally:
        signal.signal(signal.SIGPIPE, before)


def test_a_wrong_name_of_an_argument_is_answered_with_the_right_one():
    with pytest.raises(OptionError, match="there is no option 'wrkers'; did you mean 'workers'"):
        bemcontact.study(CYLINDER, VARIED, **{"wrkers": 2})


def test_a_foreign_folder_is_left_alone_before_any_work(tmp_path: Path, solved: list[int]):
    (tmp_path / "mine.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(FileExistsError, match=r"mine\.txt, which is not part of a study"):
        bemcontact.study(CYLINDER, VARIED, out=tmp_path)
    assert solved == []


@pytest.mark.slow
def test_one_process_and_two_find_the_same_table():
    problem = CYLINDER.with_value("accuracy", 0.01)
    one, two = (bemcontact.study(problem, VARIED, workers=workers) for workers in (1, 2))
    assert one.to_csv() == two.to_csv()


@pytest.mark.slow
@pytest.mark.skipif(not find_spec("fcntl"), reason="Windows has no such locks")
def test_another_run_is_kept_out_until_the_page_is_written(tmp_path: Path):
    """It would write its rows to the journal of the folder that is about to be replaced."""
    place, stages = tmp_path / "study", list[str]()

    def enter(stage: str, _: str) -> None:
        stages.append(stage)
        with pytest.raises(bemcontact.ProblemError, match="another run"):
            bemcontact.study(CYLINDER, {LOAD: [30.0]}, out=place)

    bemcontact.study(CYLINDER, {LOAD: [10.0]}, out=place, progress=enter)
    assert {*stages} == {running.STAGE, "report"}
    assert bemcontact.study(CYLINDER, {LOAD: [30.0]}, out=place).holds is None


@pytest.mark.parametrize("workers", [0, -1, 1.5, "2"])
def test_a_number_of_workers_that_is_none_is_refused(workers: int):
    with pytest.raises(bemcontact.ProblemError, match="number of workers"):
        bemcontact.study(CYLINDER, VARIED, workers=workers)
