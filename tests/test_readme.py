"""What the README shows is run: its spec, its library call, its commands, and its test command in CI."""

import math
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import bemcontact
from bemcontact import cli

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def shown(language: str) -> list[str]:
    """Fenced blocks of one language."""
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def chapter(language: str) -> list[str]:
    """The same of the chapter on what may be composed."""
    text = README.partition("\n## Loads, tools and models to compose\n")[2].partition("\n## ")[0]
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


@pytest.fixture
def block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    spec = shown("yaml")[0]
    path = tmp_path / "block.yaml"
    path.write_text(spec, encoding="utf-8")
    (tmp_path / "punch.yaml").write_text(chapter("yaml")[0], encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return path


def test_the_spec_has_the_answer_that_is_told(block: Path):
    result = bemcontact.solve(bemcontact.load(block))
    assert result.certified
    assert result.solution.pressure == pytest.approx(3.0, rel=1e-9)  # uniform compression
    assert result.footprint.resultant.force == pytest.approx((0.0, 3.0 * 40.0), abs=1e-8)


def test_the_ring_hangs_on_its_pin():
    """What pulls is 25 on half of the outline, which is quadratic elements of the circle."""
    result = bemcontact.solve(bemcontact.loads(shown("yaml")[1]))
    assert result.certified
    force_x, force_y = result.footprint.resultant.force
    assert force_x == pytest.approx(0.0, abs=1e-6)
    assert force_y == pytest.approx(25 * 20 * math.pi, rel=1e-5)
    (interval,) = result.footprint.intervals
    assert interval.start == pytest.approx((-interval.end[0], interval.end[1]), rel=1e-6)  # the crown of the pin
    assert interval.start[1] > 0


def test_all_keys_of_the_json_are_listed(block: Path):
    rows = re.findall(r"^\| (`.*?`) \|", README[README.index("## JSON") :], flags=re.MULTILINE)
    listed = {key for row in rows for key in re.findall(r"`(\w+)`", row)}
    keys = bemcontact.solve(bemcontact.load(block)).to_dict().keys()
    assert keys <= listed


def test_the_library_call_runs(block: Path, capsys: pytest.CaptureFixture[str]):
    exec(compile(shown("python")[0], "README.md", "exec"), {})
    peak, force, *pressures = capsys.readouterr().out.split("\n")
    assert float(peak) == pytest.approx(3.0, rel=1e-9)
    assert "120" in force or "119.99" in force
    assert [float(number) for number in re.findall(r"[\d.]+", " ".join(pressures))] == pytest.approx([3.0] * 17)


def test_the_comparison_runs(block: Path, capsys: pytest.CaptureFixture[str]):
    problem = bemcontact.load(block)
    exec(compile(shown("python")[1], "README.md", "exec"), {"bemcontact": bemcontact, "problem": problem})
    verdict, *rows = capsys.readouterr().out.splitlines()
    assert "agree with the direct solution" in verdict
    labels = ["QP1 ", "QP2 (μ = 0.1) ", "QP2 (μ = 10) ", "QP3 ", "direct "]
    assert [row.partition("solves it")[0] for row in rows] == labels


def test_the_quadratic_programme_prints_what_is_told(capsys: pytest.CaptureFixture[str]):
    """x² - 2x is least at 1; y - y² on [-1, 1/2] at -1: -1 - 2 = -3. The warm start has one step to do."""
    call, names = shown("python")[2], {}
    exec(compile(call, "README.md", "exec"), names)
    first, *log = capsys.readouterr().out.splitlines()
    assert first == re.search(r"print\(found\)  # (.*)", call).group(1)
    assert log == [*map(str, names["again"].log)]
    assert len(log) == 1
    statuses = re.findall(r"^\| `([A-Z_]+)` \|", README, flags=re.MULTILINE)
    assert statuses == [status.name for status in bemcontact.QPStatus]


def test_the_starts_that_are_told_have_these_fields():
    """The lines on starts, on a body of one contact point with interference 3 and compliance 2."""
    (lines,) = re.findall(r"^    start = bemcontact.*?(?=\n\n)", README, flags=re.MULTILINE | re.DOTALL)
    problem = bemcontact.CondensedContact.from_compliance([[2.0]], [-3.0])
    names = {"bemcontact": bemcontact, "problem": problem, "np": np, "n": 1}
    for line in lines.splitlines():
        exec(line.strip(), names)
    assert names["result"].solution.search.start == "given point"
    assert names["result"].solution.search.penalty.value == 0.1


@pytest.mark.slow
def test_the_chapter_on_composing_prints_what_is_told(block: Path, capsys: pytest.CaptureFixture[str]):
    """Each `print` line ends with what it prints, or how that begins."""
    calls, names = chapter("python"), {}
    assert len(calls) == 5
    for call in calls:
        exec(compile(call, "README.md", "exec"), names)
        told = re.findall(r"print\(.*\)  # (.*)", call)
        printed = capsys.readouterr().out.splitlines()
        assert len(printed) == len(told) > 0
        assert all(line.startswith(start) for line, start in zip(printed, told, strict=True)), (printed, told)


@pytest.mark.slow
def test_the_commands_run(block: Path):
    commands = re.findall(r"^    (bemcontact .*?)(?: {2,}.*)?$", README, flags=re.MULTILINE)
    assert len(commands) >= 6
    for command in commands:
        words = shlex.split(command.split("|")[0].split(">")[0])[1:]
        answer = CliRunner().invoke(cli.app, words)
        assert answer.exit_code == 0, (command, answer.stderr)


def test_shell_commands_name_what_exists():
    solve, test = (command.strip() for command in shown("sh"))
    assert (ROOT / re.search(r"models/\S+", solve)[0]).is_file()
    assert 'bemcontact = "bemcontact.cli:main"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert f"\n{test}\n" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


def test_references_that_the_code_cites_are_listed():
    listed = set(re.findall(r"^- \[(\w+)\]", README, flags=re.MULTILINE))
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "bemcontact").rglob("*.py")]
    cited = {key for text in sources for key in re.findall(r"\[([A-Z][A-Za-z]{1,5}\d\d)\]", text)}
    assert cited <= listed
    assert "SS92" in cited
