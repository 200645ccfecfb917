"""The command line: what it prints where, exit statuses, files that appear whole or not at all."""

import dataclasses
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

import pytest
from typer.testing import CliRunner, Result

import bemcontact
from bemcontact import cli, spec
from bemcontact.analysis import solve as analysis
from bemcontact.assessment.certificate import CertificateKind
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import NotConvexError, SingularSystemError
from bemcontact.formulations import FORMULATIONS

BLOCK = """\
name: block on a table
units: {length: mm, force: N}
material:
  young_modulus: 210e3
  poisson_ratio: 0.3
boundary:
  outer:
    - {name: bottom, start: [0, 0], elements: 4}
    - {name: right, start: [40, 0], elements: 2}
    - {name: top, start: [40, 20], elements: 4}
    - {name: left, start: [0, 20], elements: 2}
conditions:
  left: {displacement: {x: 0}}
  top: {pressure: 3}
contact_zones:
  foot:
    edges: bottom
    surface: {kind: plane, point: [0, 0], normal: [0, 1]}
"""
"""Its contact pressure is 3 everywhere: uniform compression satisfies all equations."""


@pytest.fixture
def block(tmp_path: Path) -> Path:
    path = tmp_path / "block.yaml"
    path.write_text(BLOCK, encoding="utf-8")
    return path


def run(*arguments: object) -> Result:
    return CliRunner().invoke(cli.app, [str(argument) for argument in arguments])


def in_a_process(
    *arguments: object,
    code: str = "",
    stdout: TextIO | int = subprocess.PIPE,
    encoding: str | None = None,
    **environment: str,
) -> subprocess.CompletedProcess[str]:
    """Run the program as a user's shell would; `code` is run after it."""
    script = f"import sys\nfrom bemcontact.cli import main\ntry:\n    main()\nfinally:\n    {code or 'pass'}"
    root = str(Path(bemcontact.__file__).parents[1])
    return subprocess.run(
        [sys.executable, "-c", script, *map(str, arguments)],
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        encoding=encoding or environment.get("PYTHONIOENCODING"),
        timeout=120,
        check=False,
        env={**os.environ, "PYTHONPATH": root, "OPENBLAS_NUM_THREADS": "1", **environment},
    )


@pytest.mark.parametrize("arguments", [(), ("--help",), ("solve", "--help"), ("--version",)])
def test_help_answers_without_the_numerical_half(arguments: tuple[str, ...]):
    slow = "numpy", "scipy", "cvxpy", "matplotlib", "yaml"
    answer = in_a_process(*arguments, code=f"print([m for m in {slow} if m in sys.modules], file=sys.stderr)")
    assert answer.stderr == "[]\n"
    assert "bemcontact" in answer.stdout


@pytest.mark.parametrize("command", ["check", "solve", "condense", "schema"])
def test_help_of_each_command_teaches_by_examples(command: str):
    answer = run(command, "--help")
    assert answer.exit_code == 0
    assert "Examples" in answer.stdout
    assert f"bemcontact {command}" in answer.stdout


def test_version_is_stated():
    answer = run("--version")
    assert answer.exit_code == 0
    assert answer.stdout.startswith("bemcontact")


def test_solve_states_it_in_a_short_table(block: Path):
    answer = run("solve", block)
    assert answer.exit_code == 0, answer.stderr
    assert answer.stderr == ""
    assert "UNDEFORMED" in answer.stdout.upper()
    assert "certified" in answer.stdout
    assert "N/mm²" in answer.stdout
    assert max(map(len, answer.stdout.splitlines())) <= 100


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_json_on_standard_output_is_all_that_is_there(block: Path, formulation: str):
    answer = run("solve", block, "--json", "-", "--formulation", formulation)
    found = json.loads(answer.stdout)
    assert answer.exit_code == 0
    assert answer.stderr == ""
    assert found["certified"] is True
    assert found["formulation"] == formulation
    assert found["pressure"] == pytest.approx([3.0] * 9, rel=1e-9)  # uniform compression
    assert found["resultant"] == pytest.approx([0.0, 120.0], rel=1e-9, abs=1e-9)  # 3 N/mm² on 40 mm


KEYS = {
    "name", "formulation", "status", "certified", "units", "dof", "contact_nodes", "free_rigid_motions", "nodes",
    "normals", "zone", "pressure", "gap", "normal_displacement", "resultant", "intervals", "peak", "objective",
    "residuals", "certificate", "boundary", "seconds", "version",
}  # fmt: skip


def test_json_file_has_the_documented_keys(block: Path, tmp_path: Path):
    answer = run("solve", block, "--json", tmp_path / "out.json")
    found = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    assert answer.exit_code == 0
    assert "certified" in answer.stdout
    assert found.keys() >= KEYS
    assert {"penetration", "tension", "complementarity", "equilibrium", "force_balance"} <= found["residuals"].keys()
    assert {"points", "displacement", "traction"} <= found["boundary"].keys()
    assert {"pressure", "at"} <= found["peak"].keys()
    assert all({"zone", "start", "end"} <= interval.keys() for interval in found["intervals"])


def test_set_and_refine_change_the_problem(block: Path):
    answer = run("solve", block, "--json", "-", "--refine", 2, "--set", "conditions.top.pressure=6")
    found = json.loads(answer.stdout)
    assert found["pressure"] == pytest.approx([6.0] * 17, rel=1e-9)  # twice the load, twice the elements


def test_a_variant_is_listed_and_taken(block: Path, tmp_path: Path):
    coarse = "\nvariants:\n  coarse: {description: half of the elements, set: {boundary.outer.bottom.elements: 2}}\n"
    block.write_text(BLOCK + coarse, encoding="utf-8")
    assert "coarse: half of the elements" in run("check", block).stdout
    answer = run("solve", block, "--variant", "coarse", "--json", "-")
    assert answer.exit_code == 0
    assert json.loads(answer.stdout)["contact_nodes"] == 5
    assert json.loads(answer.stdout)["name"] == "block on a table, coarse"
    assert run("condense", block, "--variant", "coarse", "--out", tmp_path / "block.npz").exit_code == 0
    assert CondensedContact.load(tmp_path / "block.npz").size == 5
    refused = run("check", block, "--variant", "course")
    assert refused.exit_code == 2
    assert "--variant course: unknown variant 'course'; did you mean 'coarse'?" in refused.stderr


CONTOUR = """
conditions:
  left: {displacement: {x: 0}}
  top: {pressure: 3}
contact_zones:
  foot:
    edges: bottom
    surface:
      kind: deflected_contour
      conditions: {right: {traction: {x: 1}}}
      direction: [0, 1]
"""


def test_a_contour_that_cannot_be_found_is_located(block: Path):
    """Contact would hold the block, but the contour is computed without contact."""
    text = BLOCK[: BLOCK.index("conditions:")] + CONTOUR
    block.write_text(text, encoding="utf-8")
    answer = run("check", block)
    line = text.splitlines().index("      conditions: {right: {traction: {x: 1}}}") + 1
    assert answer.exit_code == 2
    assert f"block.yaml:{line}:19: contact_zones.foot.surface.conditions: with these" in " ".join(answer.stderr.split())


def test_check_states_what_it_sees(block: Path):
    answer = run("check", block, "--set", "boundary.outer[0].elements=5")
    assert answer.exit_code == 0, answer.stderr
    for word in ("bottom", "right", "top", "left", "foot", "plane", "pressure", "translation", "contact"):
        assert word in answer.stdout
    assert "13 elements, 26 nodes, 11 contact points" in answer.stdout  # two nodes for each element
    assert re.search(r"Degrees of freedom +52\b", answer.stdout)
    assert "(0, -120) N/mm" in answer.stdout  # 3 N/mm² down on 40 mm
    assert max(map(len, answer.stdout.splitlines())) <= 100


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
@pytest.mark.parametrize("command", ["check", "solve"])
def test_figures_are_written_by_their_ending(block: Path, tmp_path: Path, command: str, ending: str):
    figure = tmp_path / f"figure.{ending}"
    answer = run(command, block, "--figure", figure)
    assert answer.exit_code == 0, answer.stderr
    magic = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}
    assert figure.read_bytes().startswith(magic[ending])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["block.yaml", figure.name]


def test_condense_writes_what_solve_reads(block: Path, tmp_path: Path):
    out = tmp_path / "block.npz"
    answer = run("condense", block, "--out", out)
    assert answer.exit_code == 0, answer.stderr
    result = analysis.solve(CondensedContact.load(out))
    assert result.certified
    assert result.solution.pressure == pytest.approx([3.0] * 9, rel=1e-9)


def test_schema_is_json_schema():
    answer = run("schema")
    assert answer.exit_code == 0
    found = json.loads(answer.stdout)
    assert "2020-12" in found["$schema"]
    assert {"material", "boundary", "contact_zones"} <= found["properties"].keys()


def test_a_result_without_certificate_ends_with_status_1(block: Path, monkeypatch: pytest.MonkeyPatch):
    result = analysis.solve(spec.load(block))
    certificate = dataclasses.replace(result.certificate, kind=CertificateKind.LOCAL, words="Another may exist.")
    monkeypatch.setattr(analysis, "solve_with", lambda *_, **__: dataclasses.replace(result, certificate=certificate))
    table = run("solve", block)
    assert table.exit_code == 1
    assert "NOT certified. Another may exist." in table.stdout
    pure = run("solve", block, "--json", "-")
    assert pure.exit_code == 1
    assert json.loads(pure.stdout)["certified"] is False
    assert pure.stderr == "not certified: Another may exist.\n"


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
    assert answer.stderr == "interrupted; nothing was written\n"
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


def test_an_interrupt_while_the_answer_is_shown_states_no_more(block: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("bemcontact.report.text.result_summary", interrupted)
    answer = run("solve", block)
    assert (answer.exit_code, answer.output) == (130, "interrupted\n")


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
    "no elements": (", elements: 4}", "}", "elements"),
    "fractional elements": ("elements: 4", "elements: 4.5", "4.5"),
    "pulled off its support": ("pressure: 3", "pressure: -3", "off|away|lift|pull"),
    "held by nothing": ("left: {displacement: {x: 0}}", "left: {traction: {x: 1}}", "h[oe]ld|resist"),
    "empty condition": ("{pressure: 3}", "{}", "the condition is empty"),
    "normal away from the body": ("normal: [0, 1]", "normal: [0, -1]", "normal"),
    "unknown kind": ("kind: plane", "kind: plain", "plane"),
    "infinite number": ("pressure: 3", "pressure: .inf", "finite"),
    "not YAML": ("boundary:\n", "boundary: [\n", "yaml|YAML"),
}  # fmt: skip


def assert_refused(answer: Result, pattern: str) -> None:
    assert answer.exit_code == 2
    assert answer.stdout == ""
    assert "Traceback" not in answer.stderr
    assert len(answer.stderr.splitlines()) == 1, answer.stderr
    assert answer.stderr.startswith("error: ")
    assert re.search(pattern, answer.stderr)


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
def test_a_file_that_cannot_be_written_is_found_out_before_any_work(
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
    assert_refused(run("solve", block, "--json", block), "overwrite the spec")
    figure = block.with_suffix(".svg")
    assert_refused(run("solve", block, "--json", figure, "--figure", figure), "overwrite the file of --figure")
    assert block.read_text(encoding="utf-8") == BLOCK


@pytest.mark.parametrize("option", [("--refine", "0"), ("--formulation", "qp9"), ("--weights", "x"), ("--nonsense",)])
def test_bad_options_end_with_status_2(block: Path, option: tuple[str, ...]):
    answer = run("solve", block, *option)
    assert answer.exit_code == 2
    assert "Traceback" not in answer.stderr


def test_a_closed_pipe_is_no_traceback(block: Path):
    root = str(Path(bemcontact.__file__).parents[1])
    program = f"{sys.executable} -c 'from bemcontact.cli import main; main()'"
    for command in ("schema", f"solve {block} --json -", "--help"):
        answer = subprocess.run(
            ["bash", "-c", f"{program} {command} | head -c 1"],
            capture_output=True,
            text=True,
            timeout=120,
            check=True,
            env={**os.environ, "PYTHONPATH": root},
        )
        assert answer.stderr == ""


@pytest.mark.parametrize("command", ["check BLOCK", "solve BLOCK", "solve BLOCK --json -", "schema"])
def test_a_full_disk_is_one_clear_error(block: Path, command: str):
    with Path("/dev/full").open("w") as full:
        answer = in_a_process(*command.replace("BLOCK", str(block)).split(), stdout=full)
    assert (answer.returncode, answer.stderr) == (2, "error: standard output: No space left on device\n")


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
@pytest.mark.parametrize("command", ["check", "solve"])
def test_a_terminal_that_lacks_letters_gets_the_others(block: Path, command: str, encoding: str):
    block.write_text(BLOCK.replace("block on a table", "блок on a table"), encoding="utf-8")
    answer = in_a_process(command, block, PYTHONIOENCODING=encoding, PYTHONUTF8="0")
    assert (answer.returncode, answer.stderr) == (0, "")
    assert answer.stdout.startswith("???? on a table\n")


def test_json_is_utf_8_whatever_the_terminal_speaks(block: Path):
    answer = in_a_process("solve", block, "--json", "-", PYTHONIOENCODING="cp1252", encoding="utf-8")
    assert json.loads(answer.stdout)["name"] == "block on a table"
    schema = in_a_process("schema", PYTHONIOENCODING="cp1252", encoding="utf-8")
    assert json.loads(schema.stdout) == spec.schema()


@pytest.mark.parametrize("command", ["check", "solve"])
def test_no_line_ends_in_blanks(block: Path, command: str):
    lines = run(command, block).stdout.splitlines()
    assert lines == [line.rstrip() for line in lines]


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


def test_a_condensed_problem_is_written_as_npz_only(block: Path):
    assert_refused(run("condense", block, "--out", block.with_suffix(".txt")), r"--out: .*must end in \.npz")


def test_search_and_starts_are_reported(block: Path):
    """Uniform compression; the block is free to rise, so that a start far off may end lifted if that is let happen."""
    options = ("--formulation", "qp2", "--equilibrium", "penalty", "--start", "random", "--seed", 1, "--starts", 12)
    answer = run("solve", block, *options)
    words = " ".join(answer.stdout.split())
    assert answer.exit_code == 0, answer.stderr
    assert "of 12 random starts (seed 1) end at the contact state" in words
    assert re.search(r"penalty 1 \([\d.e+]+ N/mm⁴\), convex for no penalty", words)
    found = json.loads(run("solve", block, "--json", "-", *options).stdout)
    assert found["pressure"] == pytest.approx([3.0] * 9, rel=1e-9)
    assert found["search"]["penalty"]["value"] == 1
    assert sum(end["count"] for end in found["starts"]["ends"]) == 12


@pytest.mark.parametrize(
    "options",
    [
        ("--formulation", "qp1", "--rows", "compliance"),
        ("--formulation", "qp1", "--start", "random", "--seed", "3"),
        ("--formulation", "qp2", "--penalty", "1e-3"),
        ("--formulation", "qp2", "--rows", "compliance", "--penalty", "10"),
    ],
)
def test_each_option_leads_to_the_same_solution(block: Path, options: tuple[str, ...]):
    found = json.loads(run("solve", block, "--json", "-", *options).stdout)
    assert found["certified"] is True
    assert found["pressure"] == pytest.approx([3.0] * 9, rel=1e-9)


def test_a_search_starts_from_a_file_of_results(block: Path, tmp_path: Path):
    """From the contact state itself nothing has to enter or leave."""
    before = tmp_path / "before.json"
    run("solve", block, "--formulation", "qp1", "--json", before)
    found = json.loads(run("solve", block, "--formulation", "qp1", "--start", before, "--json", "-").stdout)
    assert found["search"]["start"] == "file before.json"
    assert found["iterations"] < json.loads(before.read_text(encoding="utf-8"))["iterations"]
    assert found["pressure"] == pytest.approx([3.0] * 9, rel=1e-9)


@pytest.mark.parametrize(
    ("content", "pattern"),
    [
        (None, "there is no such file"),
        ("{", r":1:2: is no JSON"),
        ("[1, 2]", "no list 'pressure' of numbers"),
        ('{"pressure": [1.0]}', "no list 'normal_displacement'"),
        ('{"pressure": [true], "normal_displacement": [0]}', "no list 'pressure' of numbers"),
        ('{"pressure": [1], "normal_displacement": [0]}', "the start has 1 contact points and the problem 9"),
        ('{"pressure": [1, 2], "normal_displacement": [0]}', "2 pressures and 1 displacements"),
    ],
)
def test_a_file_that_is_no_start_is_refused(block: Path, tmp_path: Path, content: str | None, pattern: str):
    start = tmp_path / "start.json"
    if content is not None:
        start.write_text(content, encoding="utf-8")
    assert_refused(run("solve", block, "--formulation", "qp1", "--start", start), pattern)


@pytest.mark.parametrize(
    ("options", "pattern"),
    [
        (("--penalty", "2"), "complementarity has no use for the option 'penalty'"),
        (("--formulation", "qp1", "--penalty", "2"), "qp1 has no use for the option 'penalty'"),
        (("--formulation", "qp1", "--equilibrium", "penalty"), "no use for the option 'equilibrium'"),
        (("--formulation", "complementarity", "--weights", "consistent"), "no use for the option 'weights'"),
        (("--start", "random"), "complementarity has no use for the option 'start'"),
        (("--starts", "4"), "complementarity has no use for the option 'starts'"),
        (("--formulation", "qp1", "--starts", "4", "--start", "null"), "leave out the other start"),
        (("--formulation", "qp1", "--seed", "4", "--start", "START"), "leave out the other start"),
        (("--formulation", "qp2", "--penalty", "0"), "from 1e-08 to"),
        (("--formulation", "qp2", "--penalty", "nan"), "from 1e-08 to"),
        (("--formulation", "qp2", "--penalty", "1e20", "--json", "-"), "from 1e-08 to"),
        (("--formulation", "qp2", "--rows", "compliance", "--equilibrium", "penalty"), "stiffness rows only"),
    ],
)
def test_options_that_mean_nothing_are_refused(block: Path, options: tuple[str, ...], pattern: str):
    """They are no mistakes of the file, which is not named."""
    start = block.with_name("start.json")
    start.write_text(json.dumps({"pressure": [0] * 9, "normal_displacement": [0] * 9}), encoding="utf-8")
    answer = run("solve", block, *(option.replace("START", str(start)) for option in options))
    assert_refused(answer, pattern)
    assert str(block) not in answer.stderr


def test_options_are_looked_at_before_the_file(tmp_path: Path):
    assert_refused(run("solve", tmp_path / "none.yaml", "--penalty", "-1"), "the penalty must be a number")


@pytest.mark.parametrize("penalty", ["1e-8", "1", "1e8"])
def test_the_ends_of_the_range_of_penalties_are_plain_numbers(block: Path, penalty: str):
    """Warnings are errors here; JSON knows no NaN."""
    figure = block.with_suffix(".svg")
    answer = run("solve", block, "--formulation", "qp2", "--penalty", penalty, "--json", "-", "--figure", figure)
    found = json.loads(answer.stdout, parse_constant=pytest.fail)
    assert answer.exit_code == 0
    assert found["pressure"] == pytest.approx([3.0] * 9, rel=1e-9)


def test_a_number_of_starts_means_random_ones(block: Path):
    words = " ".join(run("solve", block, "--formulation", "qp1", "--starts", 3).stdout.split())
    assert "3 of 3 random starts (seed 0) end at the contact state" in words
    seeded = json.loads(run("solve", block, "--formulation", "qp1", "--seed", 4, "--json", "-").stdout)
    assert seeded["search"]["start"] == "random point 0, seed 4"
    assert seeded["starts"] is None


def test_the_limit_of_iterations_can_be_raised(block: Path):
    short = run("solve", block, "--formulation", "qp1", "--max-iterations", 2)
    assert short.exit_code == 1
    words = " ".join(short.stdout.split())
    assert "The solver: stopped at the iteration limit. " in words
    assert "Raise the limit (--max-iterations; 2 were done), or take another start (--seed 1)." in words
    assert run("solve", block, "--formulation", "qp1", "--max-iterations", 1000).exit_code == 0
    assert run("solve", block, "--formulation", "qp1", "--max-iterations", 0).exit_code == 2


def test_the_program_runs_as_a_module(block: Path):
    root = str(Path(bemcontact.__file__).parents[1])
    for arguments, status in (("--version",), 0), (("check", str(block)), 0), (("solve", "none.yaml"), 2):
        answer = subprocess.run(
            [sys.executable, "-m", "bemcontact", *arguments],
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
            env={**os.environ, "PYTHONPATH": root},
        )
        assert answer.returncode == status
        assert answer.stdout or answer.stderr


def test_progress_shows_the_start_and_reaches_the_terminal(block: Path, monkeypatch: pytest.MonkeyPatch):
    said = []

    @contextmanager
    def listening() -> Iterator[Callable[[str, str], None]]:
        yield lambda stage, now: said.append((stage, now))

    monkeypatch.setattr("bemcontact.cli.command.stages", listening)
    run("solve", block, "--formulation", "qp1", "--starts", 3)
    assert said == [("solving", ""), *(("solving", f"start {number} of 3") for number in (2, 3, 3))]


def test_a_penalty_that_leaves_no_minimum_is_refused(block: Path):
    held = BLOCK.replace("left: {displacement: {x: 0}}", "left: {displacement: {x: 0, y: 0}}")
    block.write_text(held, encoding="utf-8")
    options = ("--formulation", "qp2", "--weights", "consistent", "--penalty", "1e8")
    assert_refused(run("solve", block, *options), "no minimum with consistent weights .* falls without end")


def test_weights_are_stated_to_mean_nothing_to_complementarity():
    assert "complementarity has none" in " ".join(run("solve", "--help").stdout.replace("│", " ").split())


def test_no_color_is_respected(block: Path):
    coloured = in_a_process("check", block, FORCE_COLOR="1", NO_COLOR="")
    plain = in_a_process("check", block, FORCE_COLOR="1", NO_COLOR="1")
    colour = re.compile(r"\x1b\[[0-9;]*3[0-9]")
    assert colour.search(coloured.stdout)
    assert not colour.search(plain.stdout)
