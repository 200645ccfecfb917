"""The command path: table, folder, numbers, exit statuses."""

import json
import re
from pathlib import Path

import pytest
from messages import assert_states
from typer.testing import CliRunner, Result

from bemcontact import cli
from bemcontact.adaptivity import adapt

MODELS = Path(__file__).parents[2] / "models"
CYLINDER, CANTILEVER = MODELS / "cylinder_on_plane.yaml", MODELS / "cantilever_flat_surface.yaml"
PRESSURE, TRACTION = "conditions.top.pressure", "conditions.top.traction.y"


def run(*arguments: object, variant: str = "stated mesh") -> Result:
    return CliRunner().invoke(cli.app, ["path", *map(str, arguments), "--variant", variant])


def test_table_states_where_points_enter_and_how_the_peak_goes():
    """The cantilever touches with its tip first, at q = 8 E' I/L⁴ of beam theory, 3 % for shear; then its neighbors."""
    answer = run(CANTILEVER, "--vary", TRACTION, "--from", 0, "--to", -3.6)
    assert answer.exit_code == 0, answer.stderr
    assert "conditions.top.traction.y from 0 to -3.6; " in answer.stdout
    first = re.search(r"^ *(-\d\S+) +\d+ at \(50, 0\)", answer.stdout, flags=re.MULTILINE)
    assert first is not None
    load = 8 * 2e4 / (1 - 0.29**2) * (5**3 / 12) / 50**4  # for a gap of 1
    assert float(first[1]) == pytest.approx(-load, rel=0.03)
    assert_states(answer.stdout, "Equations … from 0 to -3.6 … only contact state")
    assert max(map(len, answer.stdout.splitlines())) <= 100
    assert answer.stderr == ""


@pytest.mark.slow
def test_path_that_does_not_arrive_is_stated_and_has_a_status():
    """Suction lifts the cylinder as soon as the pressure is below zero."""
    answer = run(CYLINDER, "--vary", PRESSURE, "--to", -20)
    assert answer.exit_code == 1
    told = " ".join(answer.stdout.split())
    assert_states(told, "Equations … up to 0; … off its support")


@pytest.mark.slow
def test_a_mesh_that_is_too_coarse_has_a_status():
    """Ten thousand times finer than asked for, no mesh of 24 elements is: the path is proved, the mesh is not met."""
    asked = ["--set", "accuracy=1e-6", "--set", "mesh.adapt=false"]
    told = run(CYLINDER, "--vary", PRESSURE, "--from", 40, "--to", 50.625, *asked, variant="paper")
    assert told.exit_code == 1
    assert_states(" ".join(told.stdout.split()), "Equations unique solution proved. … Mesh not met … Mesh not met")
    piped = run(CYLINDER, "--vary", PRESSURE, "--from", 40, "--to", 50.625, *asked, "--json", "-", variant="paper")
    assert piped.exit_code == 1
    assert_states(piped.stderr, "Mesh: not met … At conditions.top.pressure = 40.")


def test_a_mesh_that_is_not_assessed_though_asked_has_a_status(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Too many unknowns with every element in two: nothing is known of errors."""
    monkeypatch.setattr(adapt, "MOST_UNKNOWNS", 100)
    stated = (
        CYLINDER.read_text(encoding="utf-8")
        .partition("\nvariants:")[0]
        .replace("{name: top}", "{name: top, elements: 20}")
        .replace("angles: [-90, 0]}", "angles: [-90, 0], elements: 8}")
        .replace("end: [0, 0]}", "end: [0, 0], elements: 5}")
    )
    (tmp_path / "big.yaml").write_text(stated, encoding="utf-8")
    told = CliRunner().invoke(
        cli.app, ["path", str(tmp_path / "big.yaml"), "--vary", PRESSURE, "--from", "40", "--to", "50"]
    )
    assert told.exit_code == 1
    assert_states(" ".join(told.stdout.split()), "Equations unique solution proved. … Mesh not assessed")


@pytest.mark.slow
def test_folder_gets_picture_table_and_numbers(tmp_path: Path):
    place = tmp_path / "path"
    for _ in range(2):  # the second one replaces the first
        answer = run(CYLINDER, "--vary", PRESSURE, "--to", 45, "--out", place, "--json", tmp_path / "path.json")
        assert answer.exit_code == 0, answer.stderr
    assert {item.name for item in place.iterdir()} == {"path.html", "path.csv", "path.json", "spec.yaml", "figures"}
    pictures = {"problem", "animation", "states", "peak", "force", "moment", "contact-1", "pressure"}
    assert {item.stem for item in (place / "figures").iterdir()} == pictures
    assert (place / "path.json").read_text(encoding="utf-8") == (tmp_path / "path.json").read_text(encoding="utf-8")
    told = json.loads((place / "path.json").read_text(encoding="utf-8"))
    assert (told["key"], told["start"], told["end"], told["certified"]) == (PRESSURE, 50.625, 45.0, True)
    assert len((place / "path.csv").read_text(encoding="utf-8").splitlines()) == 1 + len(told["states"])
    assert "prefers-color-scheme: dark" in (place / "figures" / "peak.svg").read_text(encoding="utf-8")


@pytest.mark.slow
def test_an_animation_is_written_by_the_ending_of_its_name(tmp_path: Path):
    answer = run(CYLINDER, "--vary", PRESSURE, "--to", 45, "--animation", tmp_path / "roller.gif", variant="paper")
    assert answer.exit_code == 0, answer.stderr
    assert (tmp_path / "roller.gif").read_bytes()[:6] == b"GIF89a"


def test_an_animation_with_another_ending_is_refused_before_any_work(tmp_path: Path):
    answer = run(CYLINDER, "--vary", PRESSURE, "--to", 45, "--animation", tmp_path / "roller.mp4")
    assert answer.exit_code == 2
    assert_states(answer.stderr, "error: --animation: … roller.mp4: … must end in .gif or .svg")
    assert not [*tmp_path.iterdir()]


def test_foreign_folder_is_left_alone(tmp_path: Path):
    (tmp_path / "mine.txt").write_text("mine", encoding="utf-8")
    answer = run(CYLINDER, "--vary", PRESSURE, "--to", 20, "--out", tmp_path)
    assert answer.exit_code == 2
    assert "mine.txt, which is not part of a path" in answer.stderr
    assert [item.name for item in tmp_path.iterdir()] == ["mine.txt"]


def test_json_on_standard_output_and_the_reason_beside_it():
    answer = run(CYLINDER, "--vary", PRESSURE, "--to", -20, "--json", "-")
    assert answer.exit_code == 1
    assert json.loads(answer.stdout)["reaches"] == [50.625, 0.0]
    assert_states(answer.stderr, "not certified: Equations: not proved. The path exists up to 0")


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("material.young_modulus", "material.young_modulus: the compliance depends on it; only loads"),
        ("conditions.top.presure", "conditions.top.presure: there is no number to vary"),
        ("conditions.side.pressure", "conditions.side.pressure: there is no number to vary"),
    ],
)
def test_invalid_parameters_are_refused_with_their_place(key: str, words: str):
    answer = run(CYLINDER, "--vary", key, "--to", 10)
    assert answer.exit_code == 2
    assert re.match(r"error: --vary: .*cylinder_on_plane\.yaml:\d+:\d+: ", answer.stderr)
    assert words in answer.stderr


def test_overrides_variants_and_refinement_come_first():
    answer = run(CYLINDER, "--vary", PRESSURE, "--to", 2, "--from", 1, "--set", "material.young_modulus=500",
                 "--refine", 2, "--json", "-", variant="paper")  # fmt: skip
    told = json.loads(answer.stdout)
    assert told["name"] == "cylinder on a plane, paper"
    assert len(told["points"]) == 2 * 2 * 10 + 1  # 10 quadratic elements in the contact zone, cut in two


def test_ends_with_units_are_those_in_the_units_of_the_problem():
    """1 kN/cm² is 10 MPa, and the unit of stress of this problem; a length is no stress."""
    ends = (("--from", "1", "--to", "2e0"), ("--from", "10 MPa", "--to", "2e7Pa"))
    told = [json.loads(run(CYLINDER, "--vary", PRESSURE, *end, "--json", "-", variant="paper").stdout) for end in ends]
    assert [answer["start"] for answer in told] == pytest.approx([1.0, 1.0], rel=1e-12)
    assert [answer["end"] for answer in told] == pytest.approx([2.0, 2.0], rel=1e-12)
    answer = run(CYLINDER, "--vary", PRESSURE, "--to", "5 mm", variant="paper")
    assert answer.exit_code == 2
    assert "conditions.top.pressure: expected a stress such as 210 GPa; found 5 mm" in answer.stderr
