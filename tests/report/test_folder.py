"""The folder of a report: complete, replaced as a whole, and never at the cost of foreign files."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mesh_studies import block, on_one_mesh, without_a_body
from reproductions import of_the_cylinder, with_coarse_mesh_judged
from results import EACH, SPEC, compared_cases, condensed

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.report import folder


def files(place: Path) -> set[str]:
    return {path.relative_to(place).as_posix() for path in place.rglob("*") if path.is_file()}


@pytest.mark.slow
def test_all_files_of_a_report_are_written(written: Callable[[str], Path]):
    study, place = on_one_mesh(), written("block")
    assert files(place) >= {"report.html", "report.json", "contact.npz", "spec.yaml", "figures/pressure.svg"}
    assert json.loads((place / "report.json").read_text(encoding="utf-8")) == json.loads(study.to_json())
    assert (place / "spec.yaml").read_text(encoding="utf-8") == SPEC
    matrices = CondensedContact.load(place / "contact.npz")
    assert np.array_equal(matrices.compliance, study.finest.comparison.contact.compliance)
    page = (place / "report.html").read_text(encoding="utf-8")
    assert page.count("<img ") == len([*(place / "figures").iterdir()])
    assert [*place.parent.iterdir()] == [place]
    assert "block &lt;on&gt; a table &amp; more" in page
    assert block().name not in page


@pytest.mark.slow
def test_a_study_written_twice_is_the_same(written: Callable[[str], Path], tmp_path: Path):
    folder.save(on_one_mesh(), tmp_path / "again", SPEC)
    assert files(tmp_path / "again") == files(written("block"))
    for name in files(tmp_path / "again") - {"contact.npz"}:  # its archive has dates
        assert (tmp_path / "again" / name).read_bytes() == (written("block") / name).read_bytes()


@pytest.mark.slow
def test_an_earlier_report_is_replaced_with_all_its_files(written: Callable[[str], Path], tmp_path: Path):
    shutil.copytree(written("meshes"), tmp_path / "report")
    assert files(tmp_path / "report") >= {"spec.yaml", "figures/problem.svg", "figures/convergence.svg"}
    folder.save(without_a_body(), tmp_path / "report")
    left = files(tmp_path / "report")
    assert not left & {"spec.yaml", "figures/problem.svg", "figures/convergence.svg"}
    assert "report.html" in left


def test_a_new_and_an_empty_folder_are_fine(tmp_path: Path):
    (tmp_path / "empty").mkdir()
    folder.ensure_folder_writable(tmp_path / "empty")
    folder.ensure_folder_writable(tmp_path / "new")
    assert [*tmp_path.iterdir()] == [tmp_path / "empty"]


@pytest.mark.slow
def test_foreign_files_are_never_lost(tmp_path: Path):
    report = tmp_path / "report"
    folder.save(without_a_body(), report)
    for name in ("notes.txt", "figures/photo.jpg", ".hidden"):
        (report / name).touch()
        with pytest.raises(FileExistsError, match=rf"holds .*{name}.*name a new"):
            folder.save(without_a_body(), report)
        (report / name).unlink()
    (report / "figures" / "deep.svg").mkdir()
    with pytest.raises(FileExistsError, match=r"holds .*deep\.svg"):
        folder.ensure_folder_writable(report)


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"levels": []}', "\udcff"])
def test_folder_with_a_foreign_report_is_refused(tmp_path: Path, content: str):
    (tmp_path / "report.json").write_text(content, encoding="utf-8", errors="surrogateescape")
    with pytest.raises(FileExistsError, match=r"has no report\.json of bemcontact"):
        folder.ensure_folder_writable(tmp_path)
    (tmp_path / "report.json").rename(tmp_path / "report.html")
    with pytest.raises(FileExistsError, match=r"has no report\.json of bemcontact"):
        folder.ensure_folder_writable(tmp_path)


@pytest.mark.slow
def test_a_reproduction_is_replaced_as_a_whole(tmp_path: Path):
    place = tmp_path / "paper"
    for paper in (with_coarse_mesh_judged(), of_the_cylinder()):
        folder.save_reproduction(paper, place)
        models = [item.paper.model.replace("_", "-") for item in paper.problems]
        pictures = {f"figures/{model}-{what}.svg" for model in models for what in ("problem", "pressure")}
        assert files(place) == {"page.html", "numbers.json", *pictures}
        assert json.loads((place / "numbers.json").read_text(encoding="utf-8")) == json.loads(paper.to_json())
    assert [*tmp_path.iterdir()] == [place]


@pytest.mark.slow
def test_folders_of_two_kinds_do_not_replace_each_other(tmp_path: Path):
    folder.save_reproduction(of_the_cylinder(), tmp_path / "paper")
    folder.save(without_a_body(), tmp_path / "report")
    with pytest.raises(FileExistsError, match=r"which is not part of a reproduction; name a new"):
        folder.save_reproduction(of_the_cylinder(), tmp_path / "report")
    with pytest.raises(FileExistsError, match=r"which is not part of a report; name a new"):
        folder.save(without_a_body(), tmp_path / "paper")
    (tmp_path / "paper" / "numbers.json").write_text("{}", encoding="utf-8")
    with pytest.raises(FileExistsError, match=r"no numbers\.json of bemcontact.*with an earlier reproduction"):
        folder.save_reproduction(of_the_cylinder(), tmp_path / "paper")


def test_file_of_the_name_of_the_folder_is_refused(tmp_path: Path):
    (tmp_path / "report").touch()
    with pytest.raises(OSError, match="is a file; name a folder"):
        folder.ensure_folder_writable(tmp_path / "report")


KILLED = """
import json, os, random, signal, sys, time
from pathlib import Path
from mesh_studies import without_a_body
from bemcontact.report import folder

place, chance, seen = Path(sys.argv[1]), random.Random(0), set()
study = without_a_body()
folder.figures.figures_of = lambda study: dict.fromkeys(("pressure", "gap"))
folder.figures.vector_graphics = lambda pictures: dict.fromkeys(pictures, b"<svg/>")
folder.save(study, place, "warm")
begin = time.monotonic()
folder.save(study, place, "first")
longest = 2 * (time.monotonic() - begin)
names = {path.relative_to(place).as_posix() for path in place.rglob("*")}
for kill in range(60):
    if kill >= int(sys.argv[2]) and len(seen) > 1:
        break
    child = os.fork()
    if not child:
        for run in range(10**6):
            folder.save(study, place, f"{kill} {run}")
    time.sleep(chance.uniform(0, longest * (1 + kill / 4)))  # a loaded machine takes longer than the first time
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    spec = (place / "spec.yaml").read_text()
    assert {path.relative_to(place).as_posix() for path in place.rglob("*")} == names
    assert json.loads((place / "report.json").read_text())["name"] == study.name
    page = (place / "report.html").read_text()
    assert f"<pre>{spec}</pre>" in page and page.endswith("</html>"), spec
    seen.add(spec)
print(len(seen))
"""


@pytest.mark.slow
def test_a_killed_run_leaves_the_old_report_or_the_new_one(tmp_path: Path):
    """Killed at random moments of endless saving, each time page, numbers and spec are of one and the same run.

    Pictures are drawn before anything is written. They are made up here, so that more moments are in the writing.
    """
    paths = os.pathsep.join([str(Path(__file__).parent), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run(
        [sys.executable, "-c", KILLED, str(tmp_path / "report"), "10"],
        env={**os.environ, "PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 1


@pytest.mark.slow
@pytest.mark.parametrize("name", EACH)
def test_all_files_of_a_result_are_written(name: str, written: Callable[[str], Path], tmp_path: Path):
    """Page, numbers, tables and pictures; a later result replaces it, and a report does not."""
    results, place = EACH[name](), tmp_path / "result"
    shutil.copytree(written(name), place)
    stress = {"stress.csv", "largest_stresses.csv"} if name != "condensed" else set()
    assert files(place) >= {"result.html", "result.json", "zones.csv", "points.csv", "spec.yaml", *stress}
    assert json.loads((place / "result.json").read_text(encoding="utf-8")) == json.loads(results.to_json())
    page = (place / "result.html").read_text(encoding="utf-8")
    assert page.count("<img ") == len([*(place / "figures").iterdir()])
    folder.save_result(condensed(), place)
    assert not files(place) & {"stress.csv", "largest_stresses.csv", "spec.yaml", "figures/problem.svg"}
    with pytest.raises(FileExistsError, match="not part of a report"):
        folder.save(on_one_mesh(), place)


@pytest.mark.slow
def test_comparisons_under_load_cases_are_a_report(tmp_path: Path):
    """It may replace that of one load case, and the other way round."""
    folder.save(without_a_body(), tmp_path / "report")
    folder.save_cases(compared_cases(), tmp_path / "report", "name: x\n")
    assert files(tmp_path / "report") >= {"report.html", "report.json", "zones.csv", "stress.csv", "spec.yaml"}
    assert "contact.npz" not in files(tmp_path / "report")
    folder.save(without_a_body(), tmp_path / "report")
    assert "zones.csv" not in files(tmp_path / "report")
