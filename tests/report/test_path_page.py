"""The page of a path: its table is the breakpoints, what is unsure is marked, and it needs no other file."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from mesh_studies import punch
from page_reader import ensure_self_contained, read
from results import LINK, linked

import bemcontact
from bemcontact.assessment.accuracy import Accuracy, ErrorBar
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.report import folder
from bemcontact.report.formatting import number, vector
from bemcontact.report.path_page import render
from bemcontact.report.path_text import breakpoint_words

GALLERY = Path(__file__).parents[2] / "models" / "gallery"


@pytest.fixture(scope="module")
def link() -> ParameterPath:
    return linked()


def rows_of(page: str) -> list[list[str]]:
    """Texts of the cells of each row of the table of breakpoints."""
    table = page[page.index('<section id="breakpoints">') :]
    rows = re.findall(r"<tr>(.*?)</tr>", table, flags=re.DOTALL)[1:]
    return [[re.sub(r"<[^>]*>", "", cell) for cell in re.findall(r"<t[hd].*?</t[hd]>", row)] for row in rows]


def test_the_table_is_the_breakpoints(link: ParameterPath):
    rows = rows_of(render(link, {}, None, None))
    assert len(rows) == len(link.breakpoints)
    for row, state in zip(rows, link.breakpoints, strict=True):
        assert row[0] == number(state.value)
        words = breakpoint_words(link, state)
        assert row[1:6] == [words.peak, words.place, str(len(state.touching)), words.enter, words.leave]
    assert rows[-1][6] == vector(link.states[-1].resultant[0])
    assert rows[0][6:] == ["(0, 0)"] * 3  # nothing presses


def contents(place: Path) -> dict[str, bytes]:
    return {item.relative_to(place).as_posix(): item.read_bytes() for item in place.rglob("*") if item.is_file()}


@pytest.mark.slow
def test_the_page_needs_no_other_file_and_an_earlier_one_is_replaced(link: ParameterPath, tmp_path: Path):
    """What is written a second time is the same."""
    folder.save_path(link, tmp_path / "path", LINK, "name: <x>\n")
    page = (tmp_path / "path" / "path.html").read_text(encoding="utf-8")
    reader = read(page)
    ensure_self_contained(page, reader)
    assert page.count("<img ") == len([*(tmp_path / "path" / "figures").iterdir()]) == 7 + len(link.zones)
    assert "conditions.loaded.pressure goes from 0 to 20." in reader.text
    assert "&lt;x&gt;" in page
    assert "circle about" in reader.text
    assert "Proved unique solution proved" in reader.text
    assert "Not looked at" in reader.text
    before = contents(tmp_path / "path")
    folder.save_path(link, tmp_path / "path")
    again = contents(tmp_path / "path")
    assert before.keys() - again.keys() == {"spec.yaml", "figures/problem.svg"}
    assert len(again) == 3 + 6 + len(link.zones)  # page, table, numbers; pictures
    for name in again.keys() - {"path.html"}:  # which no longer shows the problem
        assert again[name] == before[name], name
    assert render(link, {}, LINK, "name: x") == render(link, {}, LINK, "name: x")
    (tmp_path / "path" / "figures" / "mine.svg").touch()
    with pytest.raises(FileExistsError, match=r"mine\.svg, which is not part of a path"):
        folder.save_path(link, tmp_path / "path")


def test_peaks_whose_error_is_too_large_are_marked(link: ParameterPath):
    """The error asked is 1 %, and it is 100 % at each breakpoint; where nothing touches there is no peak."""
    bar = ErrorBar(quantity="peak", zone="drum", value=1.0, bar=1.0)
    accuracy = Accuracy(asked=0.01, met=True, bars=(replace(bar, bar=0.0),))
    coarse = replace(
        link, start_accuracy=accuracy, end_accuracy=accuracy, breakpoint_bars=((bar,),) * len(link.breakpoints)
    )
    page = render(coarse, {}, None, None)
    table = page[page.index('<section id="breakpoints">') : page.index('<section id="reliance">')]
    assert table.count('class="badge fair"') == len(coarse.coarse) > 0
    assert "Estimated too coarse between the ends" in read(page).text


@pytest.mark.slow
def test_an_infinite_peak_is_stated():
    path = bemcontact.follow(punch(), "conditions.top.pressure", 1.0)
    page = render(path, {}, None, None)
    assert {row[1] for row in rows_of(page)} == {"infinite"}
    assert "Peak pressureinfinite in foot" in read(page).text


def test_the_place_of_a_peak_is_zero_where_it_is_small_beside_the_contact():
    """Beside the lowest point of a roller of radius R the place is x²/2R high; a point that enters is in full."""
    path = bemcontact.follow(
        bemcontact.load(GALLERY / "hertz_small.yaml"), "conditions.top.pressure", 100, accuracy=0.1
    )
    x, y = path.contact.points[1].tolist()
    last = path.breakpoints[-1]
    length = path.contact.weights[[*last.touching]].sum()
    assert 0 < y < 1e-3 * length < x
    words = breakpoint_words(path, replace(last, at=1, entered=(1,)))
    assert (words.place, words.enter) == (vector((x, 0.0)), f"1 at {vector((x, y))}")
