"""What the pages state beside their blocks: exact answers of their problems, and lists that have to be complete."""

import math
import re
from pathlib import Path

import pages
import pytest
import yaml
from test_architecture import FOUNDATION, PACKAGE, ROOMS

import bemcontact
from bemcontact.assessment.certificate import HEADINGS, POSITION_OPEN_HEADING, WITHIN_BOUND_HEADING
from bemcontact.assessment.penetration import Misfit


def problem_of(page: str, file: str = "") -> bemcontact.Problem:
    """The first problem of a page, or that which is called by the name of a file."""
    blocks = (token.content for token in pages.tokens(pages.DOCS / page) if token.info == "yaml")
    return bemcontact.loads(next(block for block in blocks if file in block.partition("\n")[0]))


def test_the_block_is_in_uniform_compression():
    result = bemcontact.solve(problem_of("tutorials/block.md"))
    assert result.certified
    assert result.solution.pressure == pytest.approx(3.0, rel=1e-9)
    assert result.footprint.resultant.force == pytest.approx((0.0, 3.0 * 40.0), abs=1e-8)


def test_the_ring_hangs_on_its_pin():
    """What pulls is 25 on half of the outline; force and ends within their error bars."""
    result = bemcontact.solve(problem_of("how-to/body.md", "ring.yaml"))
    assert result.holds
    bars = {bar.quantity: bar.bar for bar in result.accuracy.bars}
    pull = 25 * 20 * math.pi
    assert result.footprint.resultant.force == pytest.approx((0.0, pull), abs=bars["force"] * pull)
    (interval,) = result.footprint.intervals
    within = (bars["start"] + bars["end"]) * (interval.end_arc - interval.start_arc)
    assert interval.start == pytest.approx((-interval.end[0], interval.end[1]), abs=within)
    assert interval.start[1] > 0  # the crown of the pin


def test_the_cam_presses_as_hertz_has_it():
    """Its nose has the radius 8, and b/R is 0.017: Hertz is off by less than 0.1 %; the rest is the error bar."""
    result = bemcontact.solve(problem_of("how-to/body.md", "cam.yaml"))
    assert result.holds
    modulus = 210e3 / (1 - 0.3**2)
    half_width = math.sqrt(4 * 400 * 8 / (math.pi * modulus))
    peak, length = result.accuracy.bar_of("peak"), result.accuracy.bar_of("length")
    assert peak.value == pytest.approx(2 * 400 / (math.pi * half_width), rel=peak.bar + 1e-3)
    assert length.value == pytest.approx(2 * half_width, rel=length.bar + 1e-3)


def test_the_roller_of_the_readme_is_that_of_hertz():
    """Hertz is off by 0.02 % at b/R = 0.015; the rest is for the mesh."""
    block = next(token.content for token in pages.tokens(pages.ROOT / "README.md") if token.info == "yaml")
    assert not any("elements" in edge for edge in yaml.safe_load(block)["boundary"]["outer"])
    footprint = bemcontact.solve(bemcontact.loads(block)).footprint
    b = math.sqrt(4 * 400 * 10 * (1 - 0.3**2) / (math.pi * 210e3))
    assert footprint.peak is not None
    assert footprint.peak.pressure == pytest.approx(2 * 400 / (math.pi * b), rel=2e-3)
    assert footprint.intervals[0].end[0] == pytest.approx(b, rel=1e-3)


README = (pages.ROOT / "README.md").read_text(encoding="utf-8")


def test_the_cylinder_of_the_readme_is_that_of_the_finite_elements():
    """The finite elements are those of the page of validation, which a benchmark computes."""
    text = (pages.DOCS / "validation" / "finite_elements.md").read_text(encoding="utf-8")
    _, _, table = text.partition("| `cylinder_on_plane` | peak |")
    peak, end = (float(re.search(r"\d+\.\d+", row)[0]) for row in table.splitlines()[:2])
    problem = bemcontact.load(pages.ROOT / "models" / "cylinder_on_plane.yaml", variant="stated mesh")
    footprint = bemcontact.solve(problem.refined(4)).footprint
    errors = (footprint.peak.pressure / peak - 1, footprint.intervals[0].end[0] / end - 1)
    stated = re.search(r"peak ([\d.]+) %, end of contact ([\d.]+) %, with `--refine 4`", README)
    assert [100 * abs(error) for error in errors] == pytest.approx([*map(float, stated.groups())], rel=0.1)


def test_the_numbers_of_the_reproduction_are_those_that_it_prints():
    """The page of validation shows the verdict, and its own test compares it with that of today."""
    verdict = " ".join((pages.DOCS / "validation" / "paper.md").read_text(encoding="utf-8").split())
    answers, held, known = re.search(
        r"problems of the paper, (\d+) answers.*, (\d+) of (\d+) references met", README
    ).groups()
    assert f"{answers} of {answers} answers" in verdict
    assert f"{held} of {known} quantities are within" in verdict


def test_the_page_on_quadratic_programs_lists_each_status():
    text = Path(pages.DOCS, "how-to", "quadratic_programs.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `([A-Z_]+)` \|", text, flags=re.MULTILINE) == [s.name for s in bemcontact.QPStatus]


def test_the_page_on_messages_has_a_row_for_each_status():
    text = Path(pages.DOCS, "how-to", "messages.md").read_text(encoding="utf-8").partition("## Statuses")[2]
    rows = re.findall(r"^\| `?(.+?)`? \|", text.partition("## Notes")[0], flags=re.MULTILINE)[1:]
    assert len(rows) == len(bemcontact.Status)


def test_the_page_on_messages_has_a_row_for_each_verdict():
    """What is proved of the equations, and why a solution of them is no answer."""
    text = Path(pages.DOCS, "how-to", "messages.md").read_text(encoding="utf-8").partition("## Statuses")[0]
    rows = set(re.findall(r"^\| `([^`]+)`", text, flags=re.MULTILINE))
    assert {*HEADINGS.values(), POSITION_OPEN_HEADING, WITHIN_BOUND_HEADING, *map(str, Misfit)} <= rows


ARCHITECTURE = (pages.DOCS / "explanation/architecture.md").read_text(encoding="utf-8")


def test_the_page_on_the_architecture_has_the_table_of_the_rooms():
    """The test of the architecture keeps `ROOMS`; rooms inside a room are left out."""
    rows = re.findall(r"^\| `(\w+)` \| [^|]* \| ?([^|]*?) ?\|$", ARCHITECTURE, flags=re.MULTILINE)
    table = {room: set(re.findall(r"`(\w+)`", allowed)) for room, allowed in rows}
    inner = {room for room in ROOMS if "." in room}
    expected = {room: {*allowed} - {*FOUNDATION} - inner for room, allowed in ROOMS.items()}
    assert table == {room: expected[room] for room in ROOMS if room not in (*FOUNDATION, *inner, "__main__")}


def test_the_walks_name_modules_that_exist():
    named = set(re.findall(r"`((?:spec|bem|analysis|contact|formulations)/\w+)`", ARCHITECTURE))
    assert len(named) >= 5
    assert [name for name in named if not (PACKAGE / f"{name}.py").is_file()] == []
