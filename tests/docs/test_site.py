"""The site is built without a warning: pages, links between them, anchors, notebooks, docstrings."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pages
import pytest

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site as built from this tree, warnings as errors."""
    folder = tmp_path_factory.mktemp("site")
    build = subprocess.run(
        [
            sys.executable,
            "-m",
            "sphinx",
            "-W",
            "--keep-going",
            "-q",
            "-D",
            "html_theme=basic",
            "-d",
            folder / "doctrees",
            ".docs",
            folder / "html",
        ],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])},
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert build.returncode == 0, build.stderr
    return folder / "html"


def test_each_page_is_built(site: Path):
    built = {page.relative_to(site).with_suffix("") for page in site.rglob("*.html")}
    assert {p.relative_to(pages.DOCS).with_suffix("") for p in pages.pages() if p.is_relative_to(pages.DOCS)} <= built


def test_the_reference_has_what_classes_inherit(site: Path):
    """Pictures, tables and JSON are those of base classes; what the package alone uses is left out."""
    page = (site / "reference" / "python.html").read_text(encoding="utf-8")
    shown = {*re.findall(r'id="bemcontact\.([\w.]+)"', page)}
    assert {"Result.plot", "Result.to_frame", "Result.to_json", "Study.table", "CondensedContact.equilibrium"} <= shown
    assert {"Problem.with_value", "Problem.plot", "Problem.contact_zones", "LargestStresses.inside"} <= shown
    assert not {"Problem.without_joints", "Problem.as_spec", "Problem.model_dump", "Result.count"} & shown


def test_links_between_files_lead_somewhere(site: Path):
    """Those of the site are followed by Sphinx; these are in files that stand outside of it, such as the README."""
    for page in pages.pages():
        if page.is_relative_to(pages.DOCS):
            continue
        text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
        targets = re.findall(r"\]\(([^)\s]+)\)|(?:src|href)=\"([^\"]+)\"", text)
        for target in ("".join(pair) for pair in targets):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            file = (page.parent / path).resolve() if path else page
            assert file.exists(), f"{page}: {target}"
            if anchor and file.is_relative_to(pages.DOCS):
                html = site / file.relative_to(pages.DOCS).with_suffix(".html")
                assert f'id="{anchor}"' in html.read_text(encoding="utf-8"), f"{page}: {target}"
            elif anchor:
                headings = re.findall(r"^#+ (.*)", file.read_text(encoding="utf-8"), flags=re.MULTILINE)
                anchors = [re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings]
                assert anchor in anchors, f"{page}: {target}"
