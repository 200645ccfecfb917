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
    assert picture.stat().st_size < (52_000 if name == "contact" else 40_000)
    assert "<dc:date>" not in picture.read_text(encoding="utf-8")


def test_pictures_of_the_page_are_those_of_the_models():
    shown = re.findall(r'<img src="\.\./\.docs/pictures/([^"]*)"', PAGE)
    assert sorted(shown) == sorted(f"{Path(model).stem}.svg" for model in MODELS)


def test_page_is_what_the_command_writes(gallery: ModuleType):
    """The words are the same; an error may differ by a tenth, which two figures do not show better."""
    written = gallery.page()
    assert re.sub(PERCENT, "#", written) == re.sub(PERCENT, "#", PAGE), "run python .docs/gallery.py"
    errors = [[float(error) for error in re.findall(PERCENT, text)] for text in (written, PAGE)]
    assert errors[0] == pytest.approx(errors[1], rel=0.1)


@pytest.mark.parametrize("model", MODELS)
def test_accuracy_is_met_and_so_are_the_references(gallery: ModuleType, model: str):
    """On the mesh that is found, one for all load cases: no edge states elements."""
    path = ROOT / "models" / model
    assert not any(edge.elements for edge in bemcontact.load(path).boundary.edges)
    for answer in gallery.results(path).values():
        assert answer.holds
        assert answer.accuracy.asked <= 0.01
        known = expected(answer.problem, answer.contact)
        scores = score(known, answer.contact, answer.footprint, answer.solution.pressure)
        assert any(item.judged for item in scores)
        assert [item for item in scores if item.judged and not item.holds] == []


def test_picture_is_the_same_each_time(gallery: ModuleType):
    once, again = (next(gallery.pictures()) for _ in range(2))
    assert once == again
