"""The boundary as a file for viewers, read back by meshio."""

import re
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest
from typer.testing import CliRunner

from bemcontact import cli, spec
from bemcontact.analysis import solve as analysis
from bemcontact.errors import ProblemError
from bemcontact.problems import Problem
from bemcontact.report import vtk

BLOCK = """\
name: block in a corner
material: {young_modulus: 1000, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: bottom, start: [0, 0], elements: 4}
    - {name: right, start: [2, 0], elements: 3}
    - {name: top, start: [2, 2], elements: 4}
    - {name: left, start: [0, 2], elements: 3}
conditions:
  top: {pressure: 3}
  right: {pressure: 2}
contact_zones:
  floor: {edges: bottom, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}
  wall: {edges: left, surface: {kind: plane, point: [0, 0], normal: [1, 0]}}
"""
"""Pressures of 3 on the floor and 2 on the wall satisfy all equations: its stress is constant."""
EDGES = np.repeat([0, 1, 2, 3], [4, 3, 4, 3])
BONDED = """\
name: bonded strips
bodies:
  hard:
    material: {young_modulus: 1000, poisson_ratio: 0.3, state: plane_stress}
    boundary:
      outer:
        - {name: bottom, start: [0, 0], elements: 4}
        - {name: right, start: [2, 0], elements: 2}
        - {name: top, start: [2, 1], elements: 4}
        - {name: left, start: [0, 1], elements: 2}
    conditions: {bottom: {displacement: {y: 0}}, left: {displacement: {x: 0}}, right: {displacement: {x: 0.002}}}
  soft:
    material: {young_modulus: 200, poisson_ratio: 0.4, state: plane_stress}
    boundary:
      outer:
        - {name: bottom, start: [0, 1], elements: 4}
        - {name: right, start: [2, 1], elements: 2}
        - {name: top, start: [2, 2], elements: 4}
        - {name: left, start: [0, 2], elements: 2}
    conditions: {left: {displacement: {x: 0}}, right: {displacement: {x: 0.002}}}
bonded: {glue: [soft/bottom, hard/top]}
contact_zones: {lid: {edges: soft/top, surface: {kind: plane, point: [0, 3], normal: [0, -1]}}}
"""
"""Both are stretched by 0.001, and each is free across: its stress is E times this, along the strips only."""


@pytest.fixture
def block(tmp_path: Path) -> Path:
    path = tmp_path / "block.yaml"
    path.write_text(BLOCK, encoding="utf-8")
    return path


def problem() -> Problem:
    return spec.loads(BLOCK)


def solve(*arguments: object):
    return CliRunner().invoke(cli.app, ["solve", *map(str, arguments)])


@pytest.mark.parametrize("ending", [".vtu", ".vtk", ".VTU"])
def test_the_file_holds_the_boundary_element_by_element(tmp_path: Path, ending: str):
    result = analysis.solve(problem())
    vtk.save(result, tmp_path / f"block{ending}")
    assert [path.name for path in tmp_path.iterdir()] == [f"block{ending}"]
    found = meshio.read(tmp_path / f"block{ending}", ending[1:].lower())
    assert [cells.type for cells in found.cells] == ["line3", "triangle"]
    start_end_middle = [0, 2, 1]  # the order of VTK's quadratic edge
    at = found.cells[0].data
    assert sorted(at.ravel()) == [*range(3 * len(EDGES))]  # no point belongs to two elements
    assert (found.cell_data["edge"][0] == EDGES).all()
    boundary = result.boundary
    assert boundary is not None
    vectors = {"displacement": boundary.displacement, "traction": boundary.traction}
    for values, expected in [
        (found.points, boundary.points),
        *((found.point_data[name], field) for name, field in vectors.items()),
    ]:
        assert (values[at][..., :2] == expected[:, start_end_middle]).all()
        assert (values[:, 2] == 0).all()


def test_the_inside_has_the_constant_stress_of_the_block(tmp_path: Path):
    """σ = diag(-2, -3), σzz = ν (σxx + σyy) = -1.5; the triangles fill the block, and move as ε and its corner say."""
    vtk.save(analysis.solve(problem()), tmp_path / "block.vtu")
    found = meshio.read(tmp_path / "block.vtu")
    triangles = found.cells[1].data
    a, b, c = np.moveaxis(found.points[triangles, :2], 1, 0)
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(4)
    assert (found.cell_data["edge"][1] == -1).all()
    expected = {
        "stress_xx": -2.0, "stress_yy": -3.0, "stress_xy": 0.0, "stress_zz": -1.5, "max_shear": 0.75,
        "von_mises": np.sqrt(((2 - 3) ** 2 + (3 - 1.5) ** 2 + (1.5 - 2) ** 2) / 2),
    }  # fmt: skip
    for name, value in expected.items():
        assert found.point_data[name] == pytest.approx(np.full(len(found.points), value), abs=1e-8)
    inside = np.unique(triangles)
    stretch = np.array([-2 + 0.3 * 3 + 0.3 * 1.5, -3 + 0.3 * 2 + 0.3 * 1.5]) / 1000
    assert found.point_data["displacement"][inside, :2] == pytest.approx(found.points[inside, :2] * stretch, abs=1e-10)


def test_each_of_two_bonded_bodies_has_its_own_stress(tmp_path: Path):
    """Lines and triangles of each body, those at the bond too, have its stress E ε, and its number."""
    vtk.save(analysis.solve(spec.loads(BONDED)), tmp_path / "strips.vtu")
    found = meshio.read(tmp_path / "strips.vtu")
    assert (found.cell_data["body"][0] == np.repeat([0, 1], 12)).all()
    for cells, bodies in zip(found.cells, found.cell_data["body"], strict=True):
        for number, stress in enumerate([1.0, 0.2]):
            own = np.unique(cells.data[bodies == number])
            heights = found.points[own, 1]
            assert (heights.min(), heights.max()) == (number, number + 1)
            for name in ("stress_xx", "von_mises"):
                assert found.point_data[name][own] == pytest.approx(np.full(len(own), stress), abs=1e-8)


def test_pressure_and_gap_are_on_the_elements_of_their_zone(tmp_path: Path):
    """The node in the corner is in both zones, and has the pressure of each; nodes off the zones have no gap."""
    vtk.save(analysis.solve(problem()), tmp_path / "block.vtu")
    found = meshio.read(tmp_path / "block.vtu")
    pressure, gap = (found.point_data[name][found.cells[0].data] for name in ("pressure", "gap"))
    expected = np.array([3.0, 0, 0, 2])[EDGES][:, None]
    assert pressure == pytest.approx(np.broadcast_to(expected, pressure.shape), rel=1e-8)
    in_contact = np.isin(EDGES, [0, 3])
    assert abs(gap[in_contact]).max() < 1e-9
    assert np.isnan(gap[~in_contact]).all()


def test_tractions_jump_at_the_end_of_a_zone(tmp_path: Path):
    """The corner of floor and right edge: 3 upwards on the one side, 2 to the left on the other."""
    vtk.save(analysis.solve(problem()), tmp_path / "block.vtu")
    found = meshio.read(tmp_path / "block.vtu")
    here = np.flatnonzero((found.points[:, :2] == [2, 0]).all(axis=1))
    here = here[np.isin(here, found.cells[0].data)]
    assert np.sort(found.point_data["traction"][here, :2], axis=0) == pytest.approx(
        np.array([[-2.0, 0.0], [0.0, 3.0]]), rel=1e-8, abs=1e-8
    )


def test_a_condensed_problem_has_no_boundary(tmp_path: Path):
    result = analysis.solve(analysis.condense(problem()))
    with pytest.raises(ProblemError, match="no boundary"):
        vtk.save(result, tmp_path / "block.vtu")
    assert [*tmp_path.iterdir()] == []


def test_the_command_line_writes_it(block: Path):
    answer = solve(block, "--vtk", block.with_suffix(".vtu"))
    assert answer.exit_code == 0, answer.stderr
    assert len(meshio.read(block.with_suffix(".vtu")).cells[0].data) == len(EDGES)
    assert sorted(path.name for path in block.parent.iterdir()) == ["block.vtu", "block.yaml"]


def test_invalid_outputs_are_refused_before_any_work(block: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(analysis, "solve_with", None)
    answers = {
        r"--vtk: .*\.vtu or \.vtk": solve(block, "--vtk", block.with_suffix(".stl")),
        "--vtk: .*there is no directory": solve(block, "--vtk", block.parent / "none" / "a.vtu"),
        "overwrite the file of --vtk": solve(
            block, "--json", block.with_suffix(".vtu"), "--vtk", block.with_suffix(".vtu")
        ),
    }
    monkeypatch.setitem(sys.modules, "meshio", None)
    answers[r"--vtk: .*pip install 'bemcontact\[vtk\]'"] = solve(block, "--vtk", block.with_suffix(".vtu"))
    for pattern, answer in answers.items():
        assert (answer.exit_code, answer.stdout) == (2, "")
        assert re.fullmatch(rf"error: .*{pattern}.*\n", answer.stderr)
    assert [path.name for path in block.parent.iterdir()] == ["block.yaml"]
