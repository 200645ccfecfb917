"""What the runner of the pages accepts and what it refuses: a check that accepts anything would check nothing."""

from pathlib import Path

import pages
import pytest
import yaml

SOLVED = """block on a table
qp3 by Clarabel, polished; 96 degrees of freedom, 17 contact points, 0.53 s

Peak pressure  3.3939 MPa at (40, 0) mm
Residuals      penetration 1.1e-16, tension 0.0e+00
Verdict        certified."""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("0.53 s", "12.1 s"),
        ("3.3939", "3.3938"),
        ("(40, 0)", "(40, -3e-17)"),
        ("(40, 0)", "(39.99999, 0)"),
        ("1.1e-16", "4.0e-17"),
        ("0.0e+00", "2.2e-16"),
        ("Peak pressure  3", "Peak pressure 3"),
    ],
)
def test_what_differs_from_machine_to_machine_agrees(old: str, new: str):
    assert pages.agrees(SOLVED, SOLVED.replace(old, new))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("3.3939", "3.3936"),
        ("3.3939", "-3.3939"),
        ("17 contact", "18 contact"),
        ("96", "97"),
        ("qp3", "qp2"),
        ("1.1e-16", "1.1e-6"),
        ("0.0e+00", "1.0e-06"),
        ("certified", "local only"),
        ("MPa", "N/m²"),
        ("Verdict        certified.", ""),
        ("block on a table\n", ""),
    ],
)
def test_what_matters_does_not_agree(old: str, new: str):
    assert not pages.agrees(SOLVED, SOLVED.replace(old, new))
    assert not pages.agrees(SOLVED.replace(old, new), SOLVED)


def test_a_cut_stands_for_lines_that_are_left_out():
    cut = "block on a table\n...\nPeak pressure  3.3939 MPa at (40, 0) mm\n..."
    assert pages.agrees(cut, SOLVED)
    assert not pages.agrees(cut.replace("3.3939", "3.4"), SOLVED)
    assert not pages.agrees("Peak pressure  3.3939 MPa at (40, 0) mm\n...", SOLVED)  # not at the head
    assert not pages.agrees("...\nblock on a table", SOLVED)  # not at the tail


def test_seconds_in_a_column_are_not_compared():
    shown = "        iterations  seconds\nQP1             31    0.004\nQP3             10    0.010\n\nafter  0.500"
    assert pages.agrees(shown, shown.replace("0.004", "1.234"))
    assert not pages.agrees(shown, shown.replace("31", "32"))
    assert not pages.agrees(shown, shown.replace("0.500", "0.600"))


def test_an_output_that_is_written_anew_keeps_its_cuts():
    shown = "block on a table\n...\nPeak pressure  4 MPa at (20, 0) mm\n...\nVerdict        local only."
    new = pages.refreshed(shown, SOLVED)
    lines = SOLVED.splitlines()
    assert new.splitlines() == [lines[0], "...", lines[3], "...", lines[5]]
    assert pages.agrees(new, SOLVED)


def test_keys_are_added_to_a_problem_as_they_are_written():
    """A mapping is joined, a list and a number are replaced; 2e6 and no stay as they are written."""
    text = "a: {x: 2e6, y: [1, 2]}\nb: no\n"
    joined = pages.added(text, "# added to it\na: {y: [3], z: 0.1}\nc: 210e3\n")
    assert yaml.load(joined, yaml.BaseLoader) == {
        "a": {"x": "2e6", "y": ["3"], "z": "0.1"}, "b": "no", "c": "210e3"
    }  # fmt: skip
    assert "'" not in joined  # no quotes: numbers are still numbers


REFUSED = {
    "a problem without a name of its file": ("```yaml\na: 1\n```", "first line of a problem"),
    "a command that fails": ("```console\n$ false\n```", "status 1 at the end"),
    "a command that fails before another": ("```console\n$ false\n$ true\n```", "status 1 before 'true'"),
    "a console without a prompt": ("```console\ntrue\n```", r"has to be '\$ COMMAND'"),
    "an output of nothing": ("```text\n3\n```", "a block of text here is not run"),
    "an indented block": ("    print(3)", "an indented block is not run"),
    "no language": ("```\n3\n```", "a block of no language here is not run"),
    "a mentioned option that does not exist": (
        "Take `bemcontact solve --nothing`.",
        "'bemcontact solve --nothing' is no",
    ),
    "a mentioned command that does not exist": ("| a | `bemcontact nothing` |", "'bemcontact nothing' is no command"),
    "a mentioned problem that does not exist": ("`bemcontact check no.yaml`", "there is no no.yaml for"),
    "a language that nothing runs": ("```ruby\n3\n```", "a block of ruby here is not run"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_block_that_is_wrong_is_refused_with_its_line(case: str, tmp_path: Path):
    block, words = REFUSED[case]
    page = tmp_path / "page.md"
    page.write_text(f"# Page\n\n{block}\n", encoding="utf-8")
    with pytest.raises(pages.PageError, match=f"page.md:3: .*{words}"):
        list(pages.Session(page, tmp_path).run())


def test_a_page_is_one_session(tmp_path: Path):
    """Names, files and the status of a command go on to the next block; a block in a list is one."""
    page = tmp_path / "page.md"
    page.write_text(
        "- ```python\n  from pathlib import Path\n  x = Path('x').write_text('four')\n  ```\n\n"
        "```python\nprint(x)\n```\n\n```text\n4\n```\n\n"
        "```console\n$ cat x\nfive\n$ cat \\\n  nothing > y\n$ echo $?\n1\n$ cat y\n```\n",
        encoding="utf-8",
    )
    outputs = list(pages.Session(page, tmp_path).run())
    printed = ["4\n", "four", "cat: nothing: No such file or directory\n", "1\n", ""]
    assert [output.printed for output in outputs] == printed
    assert [output.agrees for output in outputs] == [True, False, True, True, True]


def test_a_page_can_use_the_problems_of_another(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(pages, "DOCS", tmp_path)
    model = (pages.ROOT / "models" / "gallery" / "flat_punch.yaml").read_text(encoding="utf-8")
    (tmp_path / "other.md").write_text(f"```yaml\n# punch.yaml\n{model}\n```\n", encoding="utf-8")
    page = tmp_path / "page.md"
    page.write_text("<!-- uses: other.md -->\n\n```console\n$ ls\nmodels\npunch.yaml\n```\n", encoding="utf-8")
    folder = tmp_path / "run"
    folder.mkdir()
    assert [output.agrees for output in pages.Session(page, folder).run()] == [True]


def test_a_page_is_written_anew_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Only what is shown and differs is written: an output that is not shown stays away, one that agrees as it is."""
    page = tmp_path / "page.md"
    shown = (
        "- ```python\n  print(2)\n  ```\n\n  ```text\n{}  ```\n\n"
        "```console\n$ echo 1.00\n1.0\n$ echo 5 > a.svg; cat a.svg\n```\n"
    )
    page.write_text(shown.format("") + "\n![a](pictures/a.svg)\n", encoding="utf-8")
    pages.refresh(page)
    assert page.read_text(encoding="utf-8") == shown.format("  2\n") + "\n![a](pictures/a.svg)\n"
    assert (tmp_path / "pictures" / "a.svg").read_text(encoding="utf-8") == "5\n"
    assert len(capsys.readouterr().out.splitlines()) == 2
    pages.refresh(page)
    assert capsys.readouterr().out == ""
