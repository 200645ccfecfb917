"""The page in a real browser: nothing complains, all is drawn, fits, and can be read in the light and in the dark."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from chromium import executable, opened, started
from playwright.sync_api import Browser
from reproductions import on_base_meshes
from results import designed, followed

from bemcontact.problems.units import Units
from bemcontact.report import folder, study_page
from bemcontact.studies.axes import axes_of
from bemcontact.studies.outputs import Reading
from bemcontact.studies.rows import MemberRow, MemberStatus
from bemcontact.studies.table import StudyTable

pytestmark = pytest.mark.skipif(executable() is None, reason="there is no Chromium on this machine")

STUDIES = ("meshes", "settings", "infinite")
RESULTS = ("roller", "punch", "cases")
PAGES = {"path": (folder.save_path, followed, "path.html"), "design": (folder.save_design, designed, "design.html")}
PAPER = "paper"
"""The page of the paper's problems, beside those of mesh studies, results, paths and designs."""

ON_PAPER = 673
"""Width of a page of A4 without its margins of 16 mm, in pixels of CSS."""

PICTURES = """
Promise.all([...document.images].map(image => image.decode().then(() => image.naturalWidth * image.width)))
"""

WIDTHS = """
(() => {
  const inner = element => element.closest(".scroll, pre");
  const wide = [...document.body.querySelectorAll("*")].filter(
    element => !inner(element) && element.getBoundingClientRect().right > innerWidth + 0.5);
  return [innerWidth, document.documentElement.scrollWidth, wide.map(element => element.outerHTML.slice(0, 80))];
})()
"""

CUT_CELLS = """
(() => {
  const cells = [...document.querySelectorAll(".cards td")];
  cells.forEach(cell => { cell.textContent = "(-0.06, -1200.00) ± 0.23 N/mm"; });
  return [cells.length, cells.filter(cell => cell.scrollWidth > cell.clientWidth + 1).length];
})()
"""

# Text is judged against the nearest background that is painted, by the formula of WCAG 2.2.
CONTRASTS = """
(() => {
  const channels = color => color.match(/[\\d.]+/g).map(Number);
  const linear = value => value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  const luminance = color => {
    const [r, g, b] = channels(color).slice(0, 3).map(value => linear(value / 255));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const painted = element => {
    for (let node = element; node; node = node.parentElement) {
      const color = getComputedStyle(node).backgroundColor;
      if (!(channels(color).length === 4 && channels(color)[3] === 0)) return color;
    }
    throw new Error("nothing is painted behind " + element.outerHTML.slice(0, 80));
  };
  document.querySelectorAll("details").forEach(details => { details.open = true; });
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const ratios = [];
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement;
    if (!walker.currentNode.data.trim() || !element.getClientRects().length) continue;
    const light = [getComputedStyle(element).color, painted(element)].map(luminance).sort((a, b) => b - a);
    ratios.push([(light[0] + 0.05) / (light[1] + 0.05), element.outerHTML.slice(0, 80)]);
  }
  return ratios;
})()
"""

# The mean lightness of what is opaque in a picture drawn by itself.
LIGHTNESS = """
(async () => {
  const image = document.querySelector("img");
  await image.decode();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
  const pen = canvas.getContext("2d");
  pen.drawImage(image, 0, 0);
  const data = pen.getImageData(0, 0, canvas.width, canvas.height).data;
  let sum = 0, count = 0;
  for (let i = 0; i < data.length; i += 4)
    if (data[i + 3] > 200) { sum += (data[i] + data[i + 1] + data[i + 2]) / 765; count += 1; }
  return [sum / count, data[3]];
})()
"""


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    with started() as browser:
        yield browser


@pytest.fixture(scope="module", params=[*STUDIES, *RESULTS, *PAGES, PAPER])
def report(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, written: Callable[[str], Path]
) -> Path:
    if request.param in RESULTS:
        return written(request.param) / "result.html"
    if request.param in STUDIES:
        return written(request.param) / "report.html"
    place = tmp_path_factory.mktemp("reports") / request.param
    if request.param == PAPER:
        folder.save_reproduction(on_base_meshes(), place)
        return place / "page.html"
    save, content, page = PAGES[request.param]
    save(content(), place)
    return place / page


@pytest.mark.slow
@pytest.mark.parametrize(("width", "dark"), [(380, True), (1200, False)], ids=["narrow and dark", "wide and light"])
def test_the_page_is_drawn_whole_and_fits(chromium: Browser, report: Path, width: int, dark: bool):
    with opened(chromium, report, width=width, dark=dark) as (page, complaints):
        sizes = page.evaluate(PICTURES)
        assert len(sizes) == len([*(report.parent / "figures").iterdir()])
        assert min(sizes) > 0
        assert page.evaluate(WIDTHS) == [width, width, []]
        contrasts = page.evaluate(CONTRASTS)
        assert len(contrasts) > 50
        assert min(contrasts)[0] >= 4.5, min(contrasts)
        background = page.evaluate("getComputedStyle(document.body).backgroundColor")
        assert background == ("rgb(22, 25, 29)" if dark else "rgb(255, 255, 255)")
        assert page.evaluate(WIDTHS) == [width, width, []]  # with all details open
    assert complaints == []


@pytest.mark.slow
@pytest.mark.parametrize("report", [PAPER], indirect=True)
def test_a_picture_is_transparent_and_its_ink_follows_the_page(chromium: Browser, report: Path):
    seen = []
    for dark in (False, True):
        with opened(chromium, report, width=1200, dark=dark) as (page, _):
            seen.append(page.evaluate(LIGHTNESS))
    (light, corner), (dark, other_corner) = seen
    assert corner == other_corner == 0
    assert dark != pytest.approx(light, abs=0.02)


@pytest.mark.parametrize("report", ["path"], indirect=True)
@pytest.mark.slow
def test_an_animation_is_stopped_by_its_box_and_on_paper_and_where_motion_is_not_wanted(
    chromium: Browser, report: Path
):
    shown = "['.moving', '.still'].map(name => [...document.querySelectorAll(name)].map(it => it.checkVisibility()))"
    with opened(chromium, report, width=1200) as (page, complaints):
        assert page.evaluate(shown) == [[True, True], [False, False]]
        page.get_by_label("show four states").check()
        assert page.evaluate(shown) == [[False, False], [True, True]]
        page.get_by_label("show four states").uncheck()
        page.emulate_media(media="print")
        assert page.evaluate(shown) == [[False, False], [True, True]]
        page.emulate_media(media="screen", reduced_motion="reduce")
        assert page.evaluate(shown) == [[False, False], [True, True]]
    assert complaints == []


@pytest.mark.slow
def test_a_long_number_is_not_cut_on_a_telephone(chromium: Browser, written: Callable[[str], Path]):
    """A force with its error and its unit is wider than what its label leaves of a card."""
    with opened(chromium, written("cases") / "result.html", width=380) as (page, _):
        cells, cut = page.evaluate(CUT_CELLS)
    assert cells > 10
    assert cut == 0


@pytest.mark.slow
def test_a_long_note_of_a_study_makes_no_tall_row_and_the_table_fits_on_paper(chromium: Browser, tmp_path: Path):
    """Six columns leave no room for a note of 30 words; it had a column of one word, and paper cut it off."""
    outputs = tuple(f"output_{number}" for number in range(5))  # as many as are shown by default
    one = MemberRow(
        number=0, values={"conditions.top.pressure": 10.0}, status=MemberStatus.HOLDS, equations="", certified=True,
        met=True, mesh_error=0.002, message="a note of many words " * 6,
        outputs={name: Reading(value=100.0, error=0.1) for name in outputs},
    )  # fmt: skip
    axes = axes_of({"conditions.top.pressure": [10.0]}, Units())
    study = StudyTable(name="study", units=Units(length="mm", force="N"), axes=axes, outputs=outputs, rows=(one,))
    place = tmp_path / "study.html"
    place.write_text(study_page.render(study, {}, None), encoding="utf-8")
    with opened(chromium, place, width=1200) as (page, _):
        assert page.evaluate("document.querySelector('.members tbody tr').clientHeight") < 120
        page.set_viewport_size({"width": ON_PAPER, "height": 900})
        page.emulate_media(media="print")
        assert page.evaluate("document.documentElement.scrollWidth") == ON_PAPER


@pytest.mark.slow
def test_errors_in_the_browser_are_noticed(chromium: Browser, tmp_path: Path):
    """A page with a script that fails and a picture that is missing: without this the test above proves nothing."""
    bad = tmp_path / "bad.html"
    bad.write_text(
        "<!DOCTYPE html><img src=none.png><script>console.warn('a warning'); nothing()</script>", encoding="utf-8"
    )
    with opened(chromium, bad, width=380) as (_, complaints):
        pass
    for expected in ("a warning", "nothing is not defined", "none.png: net::ERR_FILE_NOT_FOUND"):
        assert any(expected in complaint for complaint in complaints)
