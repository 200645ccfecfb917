"""Each code block of README and pages runs, and prints what the page shows."""

import re
import shlex
import tomllib
from pathlib import Path

import pages
import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CI = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


@pytest.fixture(autouse=True)
def settled(monkeypatch: pytest.MonkeyPatch):
    for variable, value in pages.SETTINGS.items():
        monkeypatch.setenv(variable, value)


@pytest.mark.parametrize("page", pages.pages(), ids=name)
def test_blocks_run_and_print_what_is_shown(page: Path, tmp_path: Path):
    for output in pages.Session(page, tmp_path).run():
        where = f"{name(page)}:{output.first + 1}: {output.source}"
        assert output.agrees, f"{where} prints\n{output.printed}\npython .docs/pages.py {name(page)} writes it"


@pytest.mark.parametrize("page", pages.pages(), ids=name)
def test_commands_that_are_not_run_name_what_exists(page: Path):
    """Blocks of sh install or take long: CI runs each line, or it names an extra, or a file of the repository."""
    extras = set(PROJECT["optional-dependencies"])
    for token in pages.tokens(page):
        for line in token.content.splitlines() if token.info == "sh" else ():
            if line in CI or not line.strip() or line.startswith("#"):
                continue
            words = [word for word in shlex.split(line, comments=True) if not re.match(r"[A-Z_]+=", word)]
            match words:
                case ["pip", "install", *_, what]:
                    found = re.search(r"\[([\w,-]+)\]", what)
                    assert found, line
                    assert set(found[1].split(",")) <= extras, line
                case ["python", "-m", "sphinx", *options]:
                    assert ".docs" in options, line
                case ["python" | "bash", path, *_]:
                    assert (ROOT / path).is_file(), line
                case _:
                    pytest.fail(f"{name(page)}: '{line}' is not run: show it in a block of console, or put it into CI")


def test_the_readme_is_short():
    """The length that the founders ask for."""
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 150


def test_each_page_is_in_a_table_of_contents():
    """Those that lead to it from the index of the site."""
    reached, queue = set(), [pages.DOCS / "index.md"]
    while queue:
        page = queue.pop()
        reached.add(page)
        for token in pages.tokens(page):
            if token.info.startswith("{toctree}"):
                entries = [line.strip() for line in token.content.splitlines()]
                entries = [re.sub(r".*<(.*)>", r"\1", entry) for entry in entries if entry and entry[0] != ":"]
                queue += [(page.parent / f"{entry}.md").resolve() for entry in entries]
    assert reached == {page for page in pages.pages() if page.is_relative_to(pages.DOCS)}


def test_sources_that_the_code_cites_are_listed():
    listed = set(re.findall(r"^- \[\[(\w+)\]\]", (pages.DOCS / "reference" / "literature.md").read_text("utf-8"), re.M))
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "bemcontact").rglob("*.py")]
    sources += [page.read_text(encoding="utf-8") for page in pages.pages()]
    cited = {key for text in sources for key in re.findall(r"\[([A-Z][A-Za-z]{1,5}\d\d)\]", text)}
    assert cited <= listed
    assert "SS92" in cited
