"""The command solve: what it prints where, options, starts, load cases, exit statuses."""

import dataclasses
import json
import os
import re
from pathlib import Path

import pytest
from command_line import BLOCK, GALLERY, PRESS, assert_refused, in_one_process, run
from messages import assert_states

from bemcontact import spec
from bemcontact.analysis import solve as analysis
from bemcontact.assessment.certificate import HEADINGS, CertificateKind
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.formulations import FORMULATIONS


def test_solve_prints_a_short_table(block: Path):
    answer = run("solve", block)
    assert answer.exit_code == 0, answer.stderr
    assert answer.stderr == ""
    assert "UNDEFORMED" in answer.stdout.upper()
    assert_states(answer.stdout, "Equations … unique solution proved. … Mesh … not assessed.")
    assert "MPa" in answer.stdout
    assert max(map(len, answer.stdout.splitlines())) <= 100


@pytest.mark.slow
def test_solve_starts_with_the_direct_solver_alone(block: Path):
    """Other formulations, comparisons, references and figures are read where they are asked for."""
    scipy = tuple(f"scipy.{name}" for name in ("optimize", "sparse", "special", "interpolate"))
    packages = ("cvxpy", "clarabel", "matplotlib", "jinja2")
    rooms = tuple(f"bemcontact.{name}" for name in ("modelling", "reference", "studies", "report.figures"))
    solvers = tuple(f"bemcontact.formulations.{name}" for name in ("qp1", "qp2", "qp3", "local_solver.minimize"))
    slow = (*scipy, *packages, *rooms, *solvers, "bemcontact.assessment.comparison", "bemcontact.analysis.mesh_study")
    code = f"print([m for m in {slow} if m in sys.modules], file=sys.stderr)"
    answer = in_one_process(*(f"solve {block} --set accuracy={asked}" for asked in ("null", "0.01")), code=code)
    assert answer.stdout.count("status 0\n") == 2
    assert answer.stderr == "[]\n"


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_json_on_standard_output_is_all_that_is_there(block: Path, formulation: str):
    answer = run("solve", block, "--json", "-", "--formulation", formulation)
    found = json.loads(answer.stdout)
    assert answer.exit_code == 0
    assert answer.stderr == ""
    assert found["certified"] is True
    assert found["formulation"] == formulation
    assert found["pressure"] == pytest.approx([3.0] * 9, rel=1e-9)  # uniform compression
    assert found["resultant"] == pytest.approx([0.0, 120.0], rel=1e-9, abs=1e-9)  # 3 MPa on 40 mm


KEYS = {
    "name", "formulation", "status", "certified", "units", "dof", "contact_nodes", "free_rigid_motions", "nodes",
    "normals", "zone", "pressure", "gap", "normal_displacement", "resultant", "intervals", "peak", "objective",
    "residuals", "certificate", "boundary", "seconds", "version",
}  # fmt: skip


def test_json_file_has_the_documented_keys(block: Path, tmp_path: Path):
    answer = run("solve", block, "--json", tmp_path / "out.json")
    found = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    assert answer.exit_code == 0
    assert_states(answer.stdout, "Equations … unique solution proved. … Mesh … not assessed.")
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
    assert_states(refused.stderr, "--variant course: unknown … 'course' … 'coarse'")


def test_a_result_without_certificate_ends_with_status_1(block: Path, monkeypatch: pytest.MonkeyPatch):
    result = analysis.solve(spec.load(block))
    certificate = dataclasses.replace(
        result.certificate,
        kind=CertificateKind.LOCAL,
        heading=HEADINGS[CertificateKind.LOCAL],
        words="Another may exist.",
    )
    monkeypatch.setattr(analysis, "solve_with", lambda *_, **__: dataclasses.replace(result, certificate=certificate))
    table = run("solve", block)
    assert table.exit_code == 1
    assert_states(table.stdout, "Equations … Another may exist. … Mesh")
    assert "unique solution proved" not in table.stdout
    pure = run("solve", block, "--json", "-")
    assert pure.exit_code == 1
    assert json.loads(pure.stdout)["certified"] is False
    assert_states(pure.stderr, "Equations: … Another may exist. … Mesh: not assessed.")


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
    answer = run("solve", block, "--formulation", "qp1", "--start", start)
    assert_refused(answer, pattern)
    assert answer.stderr.startswith(("error: --start: ", "error: the start has"))


@pytest.mark.parametrize("kind", ["device", "pipe", "bytes", "stream"])
def test_no_problem_is_named_where_a_start_is_read(block: Path, tmp_path: Path, kind: str):
    place = {"device": Path("/dev/zero"), "stream": Path("-")}.get(kind, tmp_path / kind)
    if kind == "pipe":
        os.mkfifo(place)
    if kind == "bytes":
        place.write_bytes(bytes(range(256)))
    answer = run("solve", block, "--formulation", "qp1", "--start", place)
    assert_refused(
        answer, f"error: --start: {place}: .*; name a JSON file that `bemcontact solve --json FILE` has written"
    )
    assert "YAML" not in answer.stderr
    assert "write -" not in answer.stderr


@pytest.mark.parametrize("word", ["rand", "Random", "nul"])
def test_a_start_that_is_misspelled_is_told_its_name(block: Path, monkeypatch: pytest.MonkeyPatch, word: str):
    monkeypatch.chdir(block.parent)
    answer = run("solve", block, "--formulation", "qp1", "--start", word)
    assert answer.exit_code == 2
    assert f"there is no file '{word}'; did you mean {'null' if word == 'nul' else 'random'}?" in answer.stderr
    Path(word).write_text("{}")
    assert "no list 'pressure'" in run("solve", block, "--formulation", "qp1", "--start", word).stderr


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
    """Such options are no mistakes of the file, which is not named."""
    start = block.with_name("start.json")
    start.write_text(json.dumps({"pressure": [0] * 9, "normal_displacement": [0] * 9}), encoding="utf-8")
    answer = run("solve", block, *(option.replace("START", str(start)) for option in options))
    assert_refused(answer, pattern)
    assert str(block) not in answer.stderr


def test_options_are_looked_at_before_the_file(tmp_path: Path):
    assert_refused(run("solve", tmp_path / "none.yaml", "--penalty", "-1"), "the penalty must be a number")


@pytest.mark.slow
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
    assert_states(words, "iteration limit. … --max-iterations; 2 were done … --seed 1")
    assert run("solve", block, "--formulation", "qp1", "--max-iterations", 1000).exit_code == 0
    assert run("solve", block, "--formulation", "qp1", "--max-iterations", 0).exit_code == 2


def test_a_penalty_that_leaves_no_minimum_is_refused(block: Path):
    held = BLOCK.replace("left: {displacement: {x: 0}}", "left: {displacement: {x: 0, y: 0}}")
    block.write_text(held, encoding="utf-8")
    options = ("--formulation", "qp2", "--weights", "consistent", "--penalty", "1e8")
    assert_refused(run("solve", block, *options), "no minimum with consistent weights .* falls without end")


def test_weights_are_stated_to_mean_nothing_to_complementarity():
    assert "complementarity has none" in " ".join(run("solve", "--help").stdout.split())


STATED = "stated mesh"
CASES = ["off the middle", "raised", "edge of the kern", "off the middle and raised"]


@pytest.mark.slow
def test_solve_without_case_solves_all():
    answer = run("solve", GALLERY / "roller_in_v_block.yaml")
    assert answer.exit_code == 0, answer.stderr
    assert all(f"\n{case} " in answer.stdout for case in ("still", "down", "aside"))
    assert_states(answer.stdout, "Equations … unique solution proved … Mesh … error at most … (asked 1 %)")
    assert "Largest peak" in answer.stdout


def test_solve_with_case_solves_one():
    """100 (1 + 12 e x / 60²) with e = 5: 150 at the edge."""
    answer = run("solve", PRESS, "--case", "off the middle")
    assert answer.exit_code == 0, answer.stderr
    assert "block between a press and a table, off the middle" in answer.stdout
    assert_states(answer.stdout, "Peak pressure … 150.0")
    assert "press: moves by (0, -0.01733" in answer.stdout


def test_json_of_all_cases_and_of_one():
    answer = run("solve", PRESS, "--variant", STATED, "--json", "-")
    found = json.loads(answer.stdout)
    assert (found["certified"], [*found["cases"]]) == (True, CASES)
    assert found["worst"] == "edge of the kern"  # 200 at its edge
    one = json.loads(run("solve", PRESS, "--variant", STATED, "--json", "-", "--case", "raised").stdout)
    assert one["pressure"] == pytest.approx(found["cases"]["raised"]["pressure"], rel=1e-12)
    table, press = one["tools"]
    assert (table["name"], press["name"]) == ("table", "press")
    assert table["displacement"] == pytest.approx([0, 0.1])
    assert press["force_of_body"] == pytest.approx([0, 6000], abs=1e-9)


@pytest.mark.slow
def test_figure_of_all_cases(tmp_path: Path):
    assert run("solve", PRESS, "--figure", tmp_path / "all.png").exit_code == 0
    assert (tmp_path / "all.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("solve", "--case", "raisd"), "--case raisd: case: unknown … 'raisd' … 'raised'"),
        (("compare", "--refine", "1,2"), "--refine … one load case; … --case"),
        (("solve", "--vtk", "it.vtu"), "--vtk … one load case; … --case"),
        (
            ("solve", "--set", "tools.press.force.y=1000"),
            "load_cases.off the middle: … 'press' off",
        ),
        (("check", "--set", "load_cases.raised.tools.table.force.x=1"), "the tool is held along x; add x: 0"),
    ],
)
def test_mistakes_are_reported_before_any_work(arguments: tuple[str, ...], words: str, tmp_path: Path):
    command, *options = arguments
    options = [str(tmp_path / option) if option.endswith(".vtu") else option for option in options]
    answer = run(command, PRESS, *options)
    assert answer.exit_code == 2
    assert_states(answer.stderr, words)
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize("command", ["check", "solve"])
def test_a_case_that_contact_cannot_hold_is_located(command: str, tmp_path: Path):
    """The moment of 6000 at 31 mm is beyond the edge of the press, at 30: the line of the load case is told."""
    path = tmp_path / "press.yaml"
    text = (
        PRESS.read_text(encoding="utf-8")
        .replace("moment: -30e3", "moment: -186e3")
        .replace("{off the middle: 2}", "{raised: 1}")
    )
    path.write_text(text, encoding="utf-8")
    line = next(i for i, part in enumerate(text.splitlines(), 1) if "-186e3" in part)
    answer = run(command, path)
    assert answer.exit_code == 2
    assert_states(answer.stderr, f"press.yaml:{line}:19: load_cases.off the middle: … 'press'")


@pytest.mark.slow
def test_out_writes_a_page_with_the_stress_asked_for(block: Path, tmp_path: Path):
    """The page and its tables; a folder with other files is refused before any work, and so is an unknown stress."""
    place = tmp_path / "result"
    answer = run("solve", block, "--out", place, "--stress", "yy")
    assert answer.exit_code == 0, answer.stderr
    assert {path.name for path in place.iterdir()} == {
        "result.html", "result.json", "zones.csv", "intervals.csv", "points.csv", "stress.csv", "largest_stresses.csv",
        "spec.yaml", "figures",
    }  # fmt: skip
    assert "σyy" in (place / "result.html").read_text(encoding="utf-8")
    (place / "notes.txt").write_text("mine", encoding="utf-8")
    assert_refused(run("solve", block, "--out", place), "--out: .*notes.txt, which is not part of a result")
    wrong = run("solve", block, "--stress", "mises")
    assert wrong.exit_code == 2
    assert "expected one of von_mises, max_shear, xx, yy, xy, zz, found 'mises'" in wrong.stderr


@pytest.mark.slow
def test_out_writes_one_page_for_all_load_cases(tmp_path: Path):
    answer = run("solve", PRESS, "--set", "accuracy=null", "--variant", "stated mesh", "--out", tmp_path / "all")
    assert answer.exit_code == 0, answer.stderr
    page = (tmp_path / "all" / "result.html").read_text(encoding="utf-8")
    assert all(case in page for case in ("raised", "edge of the kern", "off the middle and raised"))
