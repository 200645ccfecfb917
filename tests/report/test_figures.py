"""Pictures: everything has its name, nothing covers another name, hatching is on the rigid side, scales are stated."""

import dataclasses
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from bemcontact import analysis
from bemcontact.bem import mesh
from bemcontact.problem import Problem
from bemcontact.report import figures
from bemcontact.report.figures.marks import draw_ground


def line(name: str, start: list[float], elements: int) -> dict:
    return {"name": name, "start": start, "elements": elements}


def block_in_a_corner() -> Problem:
    """A square plate with a hole, pressed into the corner of a floor and a wall that recedes below its middle."""
    hole = {"kind": "arc", "name": "hole", "center": [1, 1], "radius": 0.4, "angles": [360, 0], "elements": 8}
    bottom, right = line("bottom", [0, 0], 4), line("right", [2, 0], 4)
    top, left = line("top", [2, 2], 4), line("left", [0, 2], 4)
    floor = {"kind": "plane", "point": [0, 0], "normal": [0, 2]}
    wall = {"kind": "polyline", "points": [[0, 3], [0, 1.2], [-0.05, 0]]}
    return Problem(
        name="a block, $x$ in a \\corner",
        units={"length": "mm", "force": "N"},
        material={"young_modulus": 1000, "poisson_ratio": 0.3},
        boundary={"outer": [bottom, right, top, left], "holes": [[hole]]},
        conditions={"top": {"pressure": {"constant": 3, "x": 1}}, "right": {"traction": {"x": -2, "y": 0}}},
        loads={"gravity": {"density": 1e-3, "acceleration": [0, -9.81]}},
        contact_zones={"floor": {"edges": "bottom", "surface": floor}, "wall": {"edges": "left", "surface": wall}},
    )  # pyright: ignore


def beam_over_a_circle() -> Problem:
    """A long clamped beam that bends onto a large circle, with a symmetry condition at its end."""
    outer = [line("under", [0, 0], 12), line("end", [50, 0], 2), line("top", [50, 5], 10), line("clamp", [0, 5], 2)]
    surface = {"kind": "circle", "center": [50, -101], "radius": 100, "body": "outside"}
    return Problem(
        name="beam",
        material={"young_modulus": 2e4, "poisson_ratio": 0.29},
        boundary={"outer": outer},
        conditions={
            "clamp": {"displacement": {"x": 0, "y": 0}},
            "end": {"displacement": {"x": 0}},
            "top": {"traction": {"y": -3.6}},
        },
        contact_zones={"drum": {"edges": ["under"], "surface": surface}},
    )  # pyright: ignore


PROBLEMS = {"corner": block_in_a_corner, "beam": beam_over_a_circle}


@pytest.fixture(scope="module", params=PROBLEMS.values(), ids=PROBLEMS)
def problem(request: pytest.FixtureRequest) -> Problem:
    return request.param()


@pytest.fixture(scope="module")
def result(problem: Problem) -> analysis.Result:
    return analysis.solve(problem)


def strokes(axes: Axes) -> Iterator[np.ndarray]:
    for collection in axes.collections:
        if isinstance(collection, LineCollection):
            yield from map(np.asarray, collection.get_segments())


def only_axes(figure: Figure) -> Axes:
    (axes,) = figure.axes
    return axes


def test_each_edge_is_named_and_no_name_covers_another(problem: Problem):
    figure = figures.figure_of_problem(problem, mesh.build(problem))
    axes = only_axes(figure)
    figure.draw_without_rendering()
    assert [text.get_text().split("\n")[0] for text in axes.texts] == [edge.name for edge in problem.boundary.edges]
    boxes = [text.get_window_extent() for text in axes.texts]
    assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])
    assert all(figure.bbox.contains(*box.min) and figure.bbox.contains(*box.max) for box in boxes)
    assert axes.get_aspect() == 1


def test_what_is_prescribed_stands_at_the_edge():
    problem = block_in_a_corner()
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    told = {text.get_text().split("\n")[0]: text.get_text().split("\n")[1:] for text in axes.texts}
    assert told["top"] == ["pressure 3 … 5 N/mm²"]
    assert told["right"] == ["$t_x$ = -2 N/mm²", "$t_y$ = 0"]
    assert told["left"] == ["may touch in wall"]
    assert told["hole"] == []


def test_mesh_passes_through_all_nodes(problem: Problem):
    meshed = mesh.build(problem)
    axes = only_axes(figures.figure_of_problem(problem, meshed))
    elements = [stroke for stroke in strokes(axes) if len(stroke) == 9]
    assert len(elements) == len(meshed.elements)
    for stroke, nodes in zip(elements, meshed.nodes[meshed.elements], strict=True):
        assert stroke[[0, 4, 8]] == pytest.approx(nodes, abs=1e-12 * meshed.size)


def test_ground_is_hatched_on_the_side_away_from_the_normals():
    axes = Figure().add_subplot()
    points, up = np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([[0.0, 1.0], [0.0, 1.0]])
    covered = draw_ground(axes, points, up, 1.0, "black")
    assert covered[:, 1].max() == 0
    assert covered[:, 1].min() == pytest.approx(-0.7)
    assert all(stroke[1, 1] < stroke[0, 1] == 0 for stroke in strokes(axes))


def test_rigid_surfaces_are_drawn_where_they_are():
    problem = beam_over_a_circle()
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    points = np.concatenate([np.column_stack(line.get_data()) for line in axes.lines if line.get_color() == "#7d838c"])
    gap, _ = problem.contact_zones["drum"].surface.closest(points)
    assert gap == pytest.approx(0, abs=1e-12 * 100)


def test_result_page_has_pressure_gap_and_shape(result: analysis.Result):
    pressure, gap, shape = figures.figure_of_result(result).axes
    assert "per undeformed length" in pressure.get_ylabel()
    assert gap.get_ylabel().startswith("gap")
    assert "deformed shape" in shape.get_title(loc="left")
    assert shape.get_aspect() == 1
    drawn = [np.asarray(line.get_ydata()) for line in pressure.lines if len(line.get_xdata()) > 2]
    assert np.sort(np.concatenate(drawn)) == pytest.approx(np.sort(result.solution.pressure))
    drawn = [np.asarray(line.get_ydata()) for line in gap.lines if len(line.get_xdata()) > 2]
    assert np.sort(np.concatenate(drawn)) == pytest.approx(
        np.sort(result.contact.initial_gap + result.solution.displacement),
        abs=1e-9 * result.contact.scales.displacement,
    )


def test_magnified_gap_is_the_gap_times_the_factor():
    """Where the body touches, the deformed outline lies on the drawn ground, whatever the factor."""
    result = analysis.solve(block_in_a_corner())
    assert result.boundary is not None
    axes = Figure().add_subplot()
    figures.draw_deformed(axes, result)
    title = axes.get_title(loc="left")
    factor = float(title.split("× ")[1].split(";")[0])
    shape = np.concatenate(
        [stroke[[0, 4]] for stroke in strokes(axes) if len(stroke) == 9][len(result.boundary.edge) :]
    )
    moved = (result.boundary.points + factor * result.boundary.displacement)[:, :2].reshape(-1, 2)
    assert shape == pytest.approx(moved, abs=1e-12 * 2)
    floor = result.contact.points[:, 1] == 0
    touching = floor & (result.solution.pressure > 0)
    on_bottom = (result.boundary.points[:, :2, 1] == 0).reshape(-1)
    assert touching[result.contact.zone == 0].all()
    assert moved[on_bottom, 1] == pytest.approx(0, abs=1e-9)


def test_the_largest_displacement_is_magnified_to_be_seen(result: analysis.Result):
    """To 2 to 5 % of the size by a factor of 1, 2 or 5 times a power of ten; large displacements stay as they are."""
    assert result.boundary is not None
    for scale in (1e-9, 1e-3, 1.0, 1e3):
        state = dataclasses.replace(result.boundary, displacement=scale * result.boundary.displacement)
        axes = Figure().add_subplot()
        figures.draw_deformed(axes, dataclasses.replace(result, boundary=state))
        title = axes.get_title(loc="left")
        factor = 1.0 if "to scale" in title else float(title.split("× ")[1].split(";")[0])
        size = np.hypot(*np.ptp(state.points.reshape(-1, 2), axis=0))
        seen = factor * np.hypot(*state.displacement.reshape(-1, 2).T).max() / size
        assert factor == 1 or 0.02 <= seen <= 0.05
        assert seen >= 0.02
        assert f"{factor:.0e}"[0] in "125"


def test_result_of_a_condensed_problem_has_no_shape():
    result = analysis.solve(analysis.condense(block_in_a_corner()))
    assert len(figures.figure_of_result(result).axes) == 2
    with pytest.raises(ValueError, match="no boundary"):
        figures.draw_deformed(Figure().add_subplot(), result)


@pytest.mark.parametrize(("ending", "magic"), [(".png", b"\x89PNG"), (".SVG", b"<?xml"), (".pdf", b"%PDF")])
def test_saved_in_the_format_of_the_ending(problem: Problem, tmp_path: Path, ending: str, magic: bytes):
    path = tmp_path / f"figure{ending}"
    figures.save(figures.figure_of_problem(problem, mesh.build(problem)), path)
    assert path.read_bytes().startswith(magic)
    assert [*tmp_path.iterdir()] == [path]


def test_unknown_format_is_refused(tmp_path: Path):
    with pytest.raises(ValueError, match=r"\.png, \.svg, \.pdf"):
        figures.save(Figure(), tmp_path / "figure.gif")
    assert [*tmp_path.iterdir()] == []
