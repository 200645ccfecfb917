"""Each code block of README and pages runs, and prints what the page shows."""

import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pages
import pytest

from bemcontact.analysis.follow import follow
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.problems import Problem

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
NOTEBOOKS = [f".docs/tutorials/{name}.md" for name in ("parameter_study", "designed_relief", "own_constraints")]
EXTRAS = set(PROJECT["optional-dependencies"])
CI = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


PATHS: dict[tuple[object, ...], ParameterPath] = {}


def followed_once(problem: Problem, key: str, to: float, start: float | None = None) -> ParameterPath:
    """`follow`, but a path that two pages show is found once."""
    asked = (problem.model_dump_json(), key, to, start)
    if asked not in PATHS:
        PATHS[asked] = follow(problem, key, to, start=start)
    return PATHS[asked]


@pytest.fixture(autouse=True)
def settled(monkeypatch: pytest.MonkeyPatch, meshes_found_once: None):
    for variable, value in pages.SETTINGS.items():
        monkeypatch.setenv(variable, value)
    for name in ("bemcontact.follow", "bemcontact.analysis.follow.follow"):
        monkeypatch.setattr(name, followed_once)


@pytest.mark.parametrize(
    "page",
    [pytest.param(page, marks=[pytest.mark.slow] * (name(page) != "README.md")) for page in pages.pages()],
    ids=name,
)
def test_blocks_run_and_print_what_is_shown(page: Path, tmp_path: Path):
    for output in pages.Session(page, tmp_path).run():
        where = f"{name(page)}:{output.first + 1}: {output.source}"
        assert output.agrees, f"{where} prints\n{output.printed}\npython .docs/pages.py {name(page)} writes it"


RUNS: dict[str, bool] = {}


def is_run(command: str, folder: Path) -> bool:
    """Whether a command of bemcontact ends with status 0; one that several pages show is run once."""
    if command not in RUNS:
        RUNS[command] = pages.Session(ROOT / "README.md", folder).command(command)[1] == 0
    return RUNS[command]


def is_sound(command: str, folder: Path) -> bool:
    """Whether a command of a block of sh can work: bemcontact is run, others must name what exists."""
    words = [word for word in shlex.split(command, comments=True) if not re.match(r"[A-Z_]+=", word)]
    match [words[0].rpartition("/")[2], *words[1:]]:
        case ["bemcontact", "reproduce", "--out", _]:
            return True  # its own tests run it
        case ["bemcontact", *_]:
            return is_run(shlex.join(["bemcontact", *words[1:]]), folder)
        case ["python" | "python3", "-m", "venv", _]:
            return True
        case ["python" | "python3", "-m", "sphinx", *options]:
            return ".docs" in options
        case ["pip", "install", *options]:
            project, _, extras = options[-1].rstrip("]").partition("[")
            return project in (".", "bemcontact") and {*filter(None, extras.split(","))} <= EXTRAS
        case ["pytest", *paths]:
            return all((ROOT / path).exists() for path in paths if not path.startswith("-"))
        case ["python" | "python3" | "bash", path, *_] | [path]:
            return (ROOT / path).is_file()
    return False


@pytest.mark.slow
@pytest.mark.parametrize("page", pages.pages(), ids=name)
def test_commands_that_take_long_can_work(page: Path, tmp_path: Path):
    """Blocks of sh install, test or measure; each line is one that CI runs, or its commands are sound."""
    (tmp_path / "models").symlink_to(ROOT / "models")
    for token in pages.tokens(page):
        for line in token.content.splitlines() if token.info == "sh" else ():
            if line in CI or not line.strip() or line.startswith("#"):
                continue
            for command in line.split(" && "):
                assert is_sound(command, tmp_path), f"{name(page)}: '{command}' is not known to work"


def test_a_command_that_cannot_work_is_found(tmp_path: Path):
    (tmp_path / "models").symlink_to(ROOT / "models")
    assert is_sound("OMP_NUM_THREADS=1 python tests/benchmarks/assembly.py 100", tmp_path)
    assert is_sound(".venv/bin/pip install -e '.[vtk,fast]'", tmp_path)
    assert is_sound(".venv/bin/bemcontact check models/gallery/flat_punch.yaml", tmp_path)
    for command in (
        "python nothing.py",
        "pip install '.[nothing]'",
        "pip install x",
        "bemcontact solve x.yaml",
        "ls -l",
    ):
        assert not is_sound(command, tmp_path), command


def test_the_readme_is_short():
    """150 lines at most."""
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 150


def test_each_page_is_in_a_table_of_contents():
    """The pages that can be reached from the index of the site are all pages."""
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


def test_each_picture_is_shown():
    """Those in the folder of pictures, and no others."""
    text = "".join(page.read_text(encoding="utf-8") for page in pages.pages())
    shown = set(re.findall(r"[(\"](?:\S*/)?pictures/([^)\"\s]+)", text))
    assert shown == {picture.name for picture in (pages.DOCS / "pictures").iterdir()}


def test_sources_that_the_code_cites_are_listed():
    listed = set(re.findall(r"^- \[\[(\w+)\]\]", (pages.DOCS / "reference" / "literature.md").read_text("utf-8"), re.M))
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "bemcontact").rglob("*.py")]
    sources += [page.read_text(encoding="utf-8") for page in pages.pages()]
    cited = {key for text in sources for key in re.findall(r"\[([A-Z][A-Za-z]{1,5}\d\d)\]", text)}
    assert cited <= listed
    assert "SS92" in cited


def test_sources_that_are_cited_by_author_and_year_are_listed():
    literature = (pages.DOCS / "reference" / "literature.md").read_text("utf-8").split("\n- ")[1:]
    files = [*(ROOT / "bemcontact").rglob("*.py"), *(ROOT / "models").rglob("*.yaml"), *pages.pages()]
    text = " ".join(" ".join(path.read_text(encoding="utf-8").split()) for path in files)
    cited = {*re.findall(r"\b([A-Z]\w+)(?: and (?:af )?([A-Z]\w+))? \(?((?:19|20)\d\d)\b", text)}
    authors = {entry for entry in cited if entry[0] not in ("In", "Version")}
    missing = [entry for entry in authors if not any(all(word in item for word in entry) for item in literature)]
    assert not missing
    assert ("Bisshopp", "Drucker", "1945") in authors


@pytest.mark.slow
@pytest.mark.parametrize("page", ["README.md", *NOTEBOOKS])
def test_an_editor_finds_no_wrong_type_in_a_script(page: str, tmp_path: Path):
    """The code of README and of each notebook as one script; a notebook shows values that a script would not use."""
    tokens = pages.tokens(ROOT / page)
    cells = [token.content for token in tokens if token.info in ("python", "{code-cell} python")]
    script = tmp_path / "script.py"
    script.write_text("\n".join(cells), encoding="utf-8")
    command = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable, "--level", "error", str(script)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, encoding="utf-8", check=False)
    assert cells
    assert done.returncode == 0, done.stdout
