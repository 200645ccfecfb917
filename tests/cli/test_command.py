"""Common parts of all commands: refusals, outputs, interrupts, exit statuses."""

import gc
import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from command_line import BLOCK, assert_refused, run

import bemcontact
from bemcontact.analysis import solve as analysis
from bemcontact.cli.command import modules
from bemcontact.errors import NotConvexError, SingularSystemError


@pytest.mark.parametrize("in_program", [True, False])
def test_a_command_works_with_searches_for_garbage(in_program: bool):
    """The program starts without them. Where a command is called from Python, what exists already is left alone."""
    gc.enable()
    frozen = gc.get_freeze_count()
    if in_program:
        gc.disable()
    try:
        with modules():
            assert not gc.isenabled()
        assert gc.isenabled()
        assert (gc.get_freeze_count() > frozen) is in_program
    finally:
        gc.enable()
        gc.unfreeze()


@pytest.mark.parametrize(
    ("command", "given", "meant"),
    [
        ("solve", "--plot", "--figure"), ("solve", "--output", "--out"), ("solve", "--tolerance", "--accuracy"),
        ("solve", "--method", "--formulation"), ("solve", "--mesh", "--refine"), ("solve", "--load_case", "--case"),
        ("study", "--jobs", "--workers"), ("check", "--plot", "--figure"), ("path", "--parameter", "--vary"),
        ("check", "--parameter", "--set"),
    ],
)  # fmt: skip
def test_another_word_for_an_option_is_led_to_it(block: Path, command: str, given: str, meant: str):
    answer = run(command, block, given, "x")
    assert answer.exit_code == 2
    assert re.search(rf"No such option:? '?{given}'?.*{meant}", " ".join(answer.stderr.split()))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["solve", "SPEC", "--vary", "x"], "No such option: --vary; --vary is an option of path, study"),
        (["solve", "SPEC", "--jobs", "2"], "No such option: --jobs; --workers is an option of study"),
        (["check", "SPEC", "--formulation", "qp1"], "--formulation is an option of solve"),
        (["solve", "SPEC", "--units", "mm"], "No such option: --units; it stands in the spec"),
        (["run", "SPEC"], "No such command 'run'. Did you mean 'solve'?"),
        (["validate", "SPEC"], "No such command 'validate'. Did you mean 'check'?"),
        (["sovle", "SPEC"], "No such command 'sovle'. Did you mean 'solve'?"),
    ],
)
def test_what_another_command_has_and_other_words_for_commands_are_named(block: Path, arguments: list[str], words: str):
    answer = run(*(block if argument == "SPEC" else argument for argument in arguments))
    assert answer.exit_code == 2
    assert words in " ".join(answer.stderr.split())


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
@pytest.mark.parametrize("command", ["check", "solve"])
def test_figures_are_written_by_their_ending(block: Path, tmp_path: Path, command: str, ending: str):
    figure = tmp_path / f"figure.{ending}"
    answer = run(command, block, "--figure", figure)
    assert answer.exit_code == 0, answer.stderr
    magic = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}
    assert figure.read_bytes().startswith(magic[ending])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["block.yaml", figure.name]


def test_a_program_that_is_not_convex_ends_with_status_2(block: Path, monkeypatch: pytest.MonkeyPatch):
    def not_convex(*_: object, **__: object) -> None:
        raise NotConvexError("smallest eigenvalue -0.5", smallest_eigenvalue=-0.5)

    monkeypatch.setattr(analysis, "solve_with", not_convex)
    assert_refused(run("solve", block), "smallest eigenvalue -0.5")


def test_a_solver_that_breaks_down_ends_with_status_1(block: Path, monkeypatch: pytest.MonkeyPatch):
    def breaks_down(*_: object, **__: object) -> None:
        raise SingularSystemError("the system is singular")

    monkeypatch.setattr(analysis, "solve_with", breaks_down)
    answer = run("solve", block)
    assert (answer.exit_code, answer.stdout, answer.stderr) == (1, "", "failed: the system is singular\n")


def interrupted(*_: object, **__: object) -> None:
    raise KeyboardInterrupt


def test_an_interrupt_states_that_nothing_was_written(block: Path, monkeypatch: pytest.MonkeyPatch):
    """130 is what shells give to a program that Ctrl-C ended."""
    monkeypatch.setattr(analysis, "solve_with", interrupted)
    old = block.with_name("old.json")
    old.write_text("{}")
    answer = run("solve", block, "--json", old, "--figure", block.with_name("new.svg"))
    assert (answer.exit_code, answer.stdout) == (130, "")
    assert answer.stderr == "interrupted; no file was written\n"
    assert sorted(path.name for path in block.parent.iterdir()) == sorted([block.name, old.name])


def test_an_interrupt_states_what_was_written_already(block: Path, monkeypatch: pytest.MonkeyPatch):
    """The boundary is written before the JSON, and a file that was there is replaced."""
    vtu, answer_file = block.with_name("boundary.vtu"), block.with_name("answer.json")
    vtu.write_text("old")
    monkeypatch.setattr(bemcontact.Result, "to_json", interrupted)
    answer = run("solve", block, "--vtk", vtu, "--json", answer_file)
    assert (answer.exit_code, answer.stderr) == (130, f"interrupted; {vtu} was written\n")
    assert "VTKFile" in vtu.read_text()
    assert not answer_file.exists()


@pytest.mark.slow
def test_an_interrupt_during_the_table_states_the_files(block: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("bemcontact.report.text.result_summary", interrupted)
    vtu, picture = block.with_name("boundary.vtu"), block.with_name("picture.svg")
    for options, written in (
        ((), "no file was written"),
        (("--figure", picture), f"{picture} was written"),
        (("--figure", picture, "--vtk", vtu), f"{picture}, {vtu} were written"),
    ):
        answer = run("solve", block, *options)
        assert (answer.exit_code, answer.output) == (130, f"interrupted; {written}\n")


BROKEN = {
    "wrong key": ("young_modulus", "youngs_modulus", "young_modulus"),
    "wrong type": ("poisson_ratio: 0.3", "poisson_ratio: steel", "poisson_ratio"),
    "duplicate key": ("  poisson_ratio: 0.3\n", "  poisson_ratio: 0.3\n  poisson_ratio: 0.2\n", "poisson_ratio"),
    "open loop": ("start: [40, 0]", "start: [40, 0], end: [40, 19]", "open"),
    "crossing loop": ("start: [40, 20]", "start: [20, -10]", "cross"),
    "clockwise loop": (BLOCK.split("conditions")[0], BLOCK.split("conditions")[0].replace("[40", "[-40"), "order"),
    "unknown edge in a condition": ("  top: {pressure", "  topp: {pressure", "top"),
    "unknown edge in a zone": ("edges: bottom", "edges: botom", "bottom"),
    "contact edge with a load": ("  top: {pressure: 3}", "  bottom: {pressure: 3}", "bottom"),
    "ν too large": ("poisson_ratio: 0.3", "poisson_ratio: 0.6", "0.5"),
    "E zero": ("young_modulus: 210e3", "young_modulus: 0", "young_modulus"),
    "fractional elements": ("elements: 4", "elements: 4.5", "4.5"),
    "pulled off its support": ("pressure: 3", "pressure: -3", "off|away|lift|pull"),
    "held by nothing": ("left: {displacement: {x: 0}}", "left: {traction: {x: 1}}", "h[oe]ld|resist"),
    "empty condition": ("{pressure: 3}", "{}", "the condition is empty"),
    "normal away from the body": ("normal: [0, 1]", "normal: [0, -1]", "normal"),
    "unknown kind": ("kind: plane", "kind: plain", "plane"),
    "infinite number": ("pressure: 3", "pressure: .inf", "finite"),
    "not YAML": ("boundary:\n", "boundary: [\n", "yaml|YAML"),
}  # fmt: skip


@pytest.mark.parametrize(("old", "new", "pattern"), BROKEN.values(), ids=BROKEN)
def test_a_broken_spec_is_one_clear_error(block: Path, old: str, new: str, pattern: str):
    text = BLOCK.replace(old, new, 1)
    assert text != BLOCK
    block.write_text(text, encoding="utf-8")
    assert_refused(run("solve", block), pattern)


@pytest.mark.parametrize("text", ["", "# nothing\n", "- 1\n", "just words\n", "\t- x: y: z\n", "\x00"])
def test_a_file_that_is_no_spec_is_one_clear_error(block: Path, text: str):
    block.write_text(text, encoding="utf-8")
    assert_refused(run("solve", block), "block.yaml")


def test_no_contact_zone_is_one_clear_error(block: Path):
    block.write_text(BLOCK[: BLOCK.index("contact_zones")], encoding="utf-8")
    assert_refused(run("solve", block), "contact_zones|contact zone")


def test_errors_name_file_line_and_column(block: Path):
    block.write_text(BLOCK.replace("210e3", "-1"), encoding="utf-8")
    line = BLOCK[: BLOCK.index("210e3")].count("\n") + 1
    column = len("  young_modulus: ") + 1
    assert_refused(run("check", block), re.escape(f"{block}:{line}:{column}: material.young_modulus: "))


@pytest.mark.parametrize("setting", ["material.young_modulus=-1", "material.young=1", "no equals sign", "a..b=1"])
def test_a_bad_setting_is_one_clear_error(block: Path, setting: str):
    assert_refused(run("solve", block, "--set", setting), "--set")


def test_a_missing_file_is_one_clear_error(tmp_path: Path):
    assert_refused(run("solve", tmp_path / "none.yaml"), "none.yaml")
    assert_refused(run("solve", tmp_path), re.escape(tmp_path.name))


def test_text_of_a_user_is_never_read_as_markup(tmp_path: Path):
    path = tmp_path / "[red]a[bold].yaml"
    path.write_text(BLOCK.replace("kind: plane", "kind: '[/bold]plane'"), encoding="utf-8")
    answer = run("solve", path)
    assert_refused(answer, re.escape("[/bold]plane"))
    assert str(path) in answer.stderr


@pytest.mark.slow
def test_names_of_a_user_are_never_read_as_markup(block: Path):
    block.write_text(BLOCK.replace("block on a table", "'a :smile: $x$ block'").replace("foot", "foot $y_"))
    for command in ("solve", "check"):
        answer = run(command, block, "--figure", block.with_suffix(".png"))
        assert answer.exit_code == 0, answer.stderr
        assert "a :smile: $x$ block" in answer.stdout
        assert "foot $y_" in answer.stdout


OUTPUTS = [
    ("solve", "--figure", "f.png"),
    ("solve", "--json", "f.json"),
    ("condense", "--out", "f.npz"),
    ("check", "--figure", "f.svg"),
]


@pytest.mark.parametrize(("command", "option", "name"), OUTPUTS)
def test_unwritable_files_are_refused_before_any_work(
    block: Path, command: str, option: str, name: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(analysis, "solve_with", None)
    monkeypatch.setattr(analysis, "condense", None)
    assert_refused(run(command, block, option, block.parent / "nowhere" / name), "nowhere")
    (block.parent / name).mkdir()
    assert_refused(run(command, block, option, block.parent / name), "is a directory")
    (block.parent / name).rmdir()
    os.mkfifo(block.parent / name)
    assert_refused(run(command, block, option, block.parent / name), "not a regular file")


def test_an_unknown_figure_format_lists_the_known_ones(block: Path):
    assert_refused(run("solve", block, "--figure", block.with_suffix(".bmp")), r"\.png, \.svg or \.pdf")


def test_no_file_overwrites_another(block: Path):
    assert_refused(run("solve", block, "--json", block), "overwrite the problem file")
    figure = block.with_suffix(".svg")
    assert_refused(run("solve", block, "--json", figure, "--figure", figure), "overwrite the file of --figure")
    assert block.read_text(encoding="utf-8") == BLOCK


@pytest.mark.parametrize("option", [("--refine", "0"), ("--formulation", "qp9"), ("--weights", "x"), ("--nonsense",)])
def test_bad_options_end_with_status_2(block: Path, option: tuple[str, ...]):
    answer = run("solve", block, *option)
    assert answer.exit_code == 2
    assert "Traceback" not in answer.stderr


@pytest.mark.parametrize("command", ["check", "solve", "condense"])
@pytest.mark.parametrize(
    ("old", "new"), [("pressure: 3", "pressure: -3"), ("left: {displacement: {x: 0}}", "left: {traction: {x: 1}}")]
)
def test_errors_found_after_reading_name_the_file(block: Path, command: str, old: str, new: str):
    block.write_text(BLOCK.replace(old, new), encoding="utf-8")
    options = ("--out", block.with_suffix(".npz")) if command == "condense" else ()
    answer = run(command, block, *options)
    assert answer.exit_code == 2
    assert answer.stderr.startswith(f"error: {block}: ")


def test_progress_shows_the_start_and_reaches_the_terminal(block: Path, monkeypatch: pytest.MonkeyPatch):
    said = []

    @contextmanager
    def listening() -> Iterator[Callable[[str, str], None]]:
        yield lambda stage, now: said.append((stage, now))

    monkeypatch.setattr("bemcontact.cli.command.stages", listening)
    run("solve", block, "--formulation", "qp1", "--starts", 3)
    assert said[0] == ("solving", "")
    assert [now for stage, now in said if stage == "solving"] == ["", *(f"start {number} of 3" for number in (2, 3, 3))]
    assert ("mesh", "") in said


@pytest.mark.parametrize(
    ("command", "option", "expected"),
    [
        ("solve", "--formulation", "one of qp1, qp2, qp3, complementarity"),
        ("solve", "--weights", "one of tributary, consistent, element_length"),
        ("solve", "--rows", "one of stiffness, compliance"),
        ("solve", "--equilibrium", "one of constraint, penalty"),
        ("path", "--to", "a number"),
        ("path", "--from", "a number"),
        *((command, "--refine", "a whole number of at least 1") for command in ("solve", "check", "condense", "path")),
        ("solve", "--max-iterations", "a whole number of at least 1"),
        ("solve", "--starts", "a whole number of at least 1"),
        ("solve", "--seed", "a whole number of at least 0"),
        ("compare", "--starts", "a whole number of at least 1"),
        ("compare", "--seed", "a whole number of at least 0"),
    ],
)
@pytest.mark.parametrize("value", ["foo", "", "-7.5e", "1/2", "½", "nan", "inf", "1e999", "1,5", "[bold]"])
def test_a_wrong_value_of_an_option_is_told_what_is_expected(command: str, option: str, expected: str, value: str):
    answer = run(command, "no file", option, value)
    words = re.sub(r"[\s│]+", " ", answer.stderr)
    assert answer.exit_code == 2
    assert f"Invalid value for '{option}': expected {expected}, found '{value}'" in words
    assert "Value error" not in words


@pytest.mark.parametrize("value", ["foo", "", "1/2", "1,5"])
def test_a_penalty_that_is_no_number_is_told_what_is_expected(value: str):
    assert f"expected a number, found '{value}'" in run("solve", "no file", "--penalty", value).stderr


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("5", "between 0 and 1, found '5'; write 0.05 for 5 percent"),
        ("0.5 %", "found '0.5 %'; write 0.005 for 0.5 percent"),
        ("0", "between 0 and 1, found '0'; write 0.01 for 1 percent\n"),
        ("200%", "found '200%'; write 0.01 for 1 percent\n"),
        ("fine", "expected a number, found 'fine'"),
    ],
)
def test_an_accuracy_out_of_range_is_told_what_to_write(value: str, expected: str):
    assert expected in run("solve", "no file", "--accuracy", value, COLUMNS="200").stderr


def test_a_mesh_that_is_too_fine_is_told_by_its_option(block: Path):
    for parts in ("10000", "1000000000000"):
        assert_refused(run("solve", block, "--refine", parts), f"--refine {parts}: ")
