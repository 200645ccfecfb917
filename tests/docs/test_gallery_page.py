"""The gallery shows every shipped problem, with the errors that its answer has today, and each picture exists."""

import importlib.util
import re
from pathlib import Path
from types import ModuleType
from xml.etree import ElementTree

import pytest

import bemcontact
from bemcontact.reference import expected, score

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "models" / "README.md").read_text(encoding="utf-8")
MODELS = sorted(path.relative_to(ROOT / "models").as_posix() for path in (ROOT / "models").rglob("*.yaml"))
LONG = {"bodies/roller_bearing.yaml"}
"""Eleven bodies without a reference: they are solved for their picture only, which is larger, and not in tests."""
PERCENT = r"\d[\d.e+-]*(?= %)"


@pytest.fixture(scope="module")
def gallery() -> ModuleType:
    """The command that writes the page."""
    spec = importlib.util.spec_from_file_location("gallery", ROOT / ".docs" / "gallery.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_each_problem_has_its_row():
    assert sorted(re.findall(r"^\| <img .*\]\(([^)]*\.yaml)\)", PAGE, flags=re.MULTILINE)) == MODELS


@pytest.mark.parametrize("name", ["contact", *(Path(model).stem for model in MODELS)])
def test_each_picture_is_there_and_small(name: str):
    picture = ROOT / ".docs" / "pictures" / f"{name}.svg"
    assert ElementTree.parse(picture).getroot().tag == "{http://www.w3.org/2000/svg}svg"
    size = 52_000 if name == "contact" else 80_000 if f"bodies/{name}.yaml" in LONG else 40_000
    assert picture.stat().st_size < size
    assert "<dc:date>" not in picture.read_text(encoding="utf-8")


def test_pictures_of_the_page_are_those_of_the_models():
    shown = re.findall(r'<img src="\.\./\.docs/pictures/([^"]*)"', PAGE)
    assert sorted(shown) == sorted(f"{Path(model).stem}.svg" for model in MODELS)


@pytest.mark.slow
def test_page_is_what_the_command_writes(gallery: ModuleType):
    agree(gallery.page(), PAGE)


@pytest.mark.slow
@pytest.mark.parametrize("page", ["README.md", ".docs/validation/closed_forms.md"])
def test_tables_of_errors_are_what_the_command_writes(gallery: ModuleType, page: str):
    text = (ROOT / page).read_text(encoding="utf-8")
    agree(gallery.filled(text), text)


def agree(written: str, page: str):
    """The words are the same; an error may differ by a tenth, which two figures do not show better."""
    assert re.sub(PERCENT, "#", written) == re.sub(PERCENT, "#", page), "run python .docs/gallery.py"
    errors = [[float(error) for error in re.findall(PERCENT, text)] for text in (written, page)]
    assert errors[0] == pytest.approx(errors[1], rel=0.1)


def test_a_table_of_errors_is_filled_in(gallery: ModuleType):
    """In rows that name a model, and in those below it; nowhere else."""
    text = "peak 9 %\n| `shrink_fit` | peak | 9 % | 9 % |\n| | pressure | round-off | 9 |\n| other | peak | 9 % | 9 |\n"
    command = "`bemcontact compare models/gallery/shrink_fit.yaml`"
    filled = gallery.filled(f"{text}| ring | peak 9 %, up to 0.9 | {command} |\n")
    error = r"0\.003\d %"
    below = rf"\| \| pressure \| {error} \| 0\.01 % \|\n\| other \| peak \| 9 % \| 9 \|"
    in_one_cell = rf"\| ring \| peak {error}, up to 0\.9 \| {re.escape(command)} \|"
    row = rf"\| `shrink_fit` \| peak \| {error} \| 0\.01 % \|"
    assert re.fullmatch(rf"peak 9 %\n{row}\n{below}\n{in_one_cell}\n", filled)
    with pytest.raises(ValueError, match="shrink_fit has no error of half-width"):
        gallery.filled("| `shrink_fit` | half-width | 9 % | 9 % |")


@pytest.mark.slow
@pytest.mark.parametrize("model", [model for model in MODELS if model not in LONG])
def test_accuracy_is_met_and_so_are_the_references(gallery: ModuleType, model: str):
    """On the mesh that is found, one for all load cases: no edge states elements."""
    path = ROOT / "models" / model
    problem = bemcontact.load(path)
    assert not any(edge.elements for part in problem.parts for edge in part.edges)
    for answer in gallery.results(path).values():
        assert answer.holds
        assert answer.accuracy.asked <= 0.01
        known = expected(answer.problem, answer.contact)
        scores = score(known, answer.contact, answer.footprint, answer.solution.pressure)
        assert any(item.judged for item in scores)
        assert [item for item in scores if item.judged and not item.holds] == []


@pytest.mark.slow
def test_picture_is_the_same_each_time(gallery: ModuleType):
    once, again = (next(gallery.pictures()) for _ in range(2))
    assert once == again
