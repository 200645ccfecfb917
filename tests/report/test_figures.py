"""Pictures: everything has its name, nothing covers another name, hatching is on the rigid side, scales are stated."""

import dataclasses
from collections.abc import Iterator
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver
from matplotlib.text import Annotation

from bemcontact.analysis import solve as analysis
from bemcontact.bem import mesh
from bemcontact.problem import DeflectedContour, Problem
from bemcontact.report import figures
from bemcontact.report.figures.symbols import draw_ground


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
    names = axes.texts[: len(problem.boundary.edges)]
    assert [text.get_text().split("\n")[0] for text in names] == [edge.name for edge in problem.boundary.edges]
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
    (hatching,) = axes.patches
    hatches = np.asarray(hatching.get_path().vertices).reshape(-1, 2, 2)
    assert len(hatches) == 16  # 0.6 apart on a length of 10
    assert (hatches[:, 1, 1] < 0).all()
    assert (hatches[:, 0, 1] == 0).all()


def test_rigid_surfaces_are_drawn_where_they_are():
    problem = beam_over_a_circle()
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    points = np.concatenate([np.column_stack(line.get_data()) for line in axes.lines if line.get_color() == "#7d838c"])
    surface = problem.contact_zones["drum"].surface
    assert not isinstance(surface, DeflectedContour)
    gap, _ = surface.closest(points)
    assert gap == pytest.approx(0, abs=1e-12 * 100)


def test_a_deflected_contour_is_drawn_as_far_from_the_edge_as_the_gap_is():
    contour = {"kind": "deflected_contour", "conditions": {"top": {"traction": {"y": -1.2}}}, "direction": [0, 1]}
    problem = beam_over_a_circle().with_value("contact_zones.drum.surface", contour)
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    gap = analysis.condense(problem).initial_gap  # without the clamped node, which does not move
    (ground,) = (line for line in grey_lines(axes) if len(line) == len(gap) + 1)
    assert ground[:, 1] == pytest.approx(np.append(0.0, -gap), abs=1e-12 * 50)


def test_result_page_has_contact_pressure_gap_and_shape(result: analysis.Result):
    contact, pressure, gap, shape = figures.figure_of_result(result).axes
    assert contact.get_title(loc="left") == "contact pressure, displacements to scale"
    assert contact.get_aspect() == 1
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


def factor_of(axes: Axes) -> float:
    """Read the stated magnification."""
    title = axes.get_title(loc="left")
    return 1.0 if "displacements to scale" in title else float(title.split("× ")[1].split(" ")[0])


def grey_lines(axes: Axes) -> list[np.ndarray]:
    return [np.column_stack(line.get_data()) for line in axes.lines if line.get_color() == "#7d838c"]


def test_deformed_outline_is_displaced_by_the_stated_factor(result: analysis.Result):
    assert result.boundary is not None
    axes = Figure().add_subplot()
    figures.draw_deformed(axes, result)
    elements = [stroke[::4] for stroke in strokes(axes) if len(stroke) == 9]
    moved = result.boundary.points + factor_of(axes) * result.boundary.displacement
    assert np.array(elements[len(moved) :]) == pytest.approx(moved, abs=1e-12 * 50)


def test_contact_is_marked_on_the_deformed_outline():
    """The whole floor is in contact: each half of its elements is thick, and its nodes are dotted."""
    result = analysis.solve(block_in_a_corner())
    assert result.boundary is not None
    axes = Figure().add_subplot()
    figures.draw_deformed(axes, result)
    halves = [stroke for stroke in strokes(axes) if len(stroke) == 5]
    on_floor = [half for half in halves if np.abs(half[:, 1]).max() < 1e-9]
    assert len(on_floor) == 8  # 4 elements
    assert np.ptp(np.concatenate(on_floor)[:, 0]) > 1.9


def test_rigid_surfaces_stand_only_beside_a_body_to_scale(result: analysis.Result):
    assert result.boundary is not None
    shown = []
    for scale in (1e-3, 1.0, 1e3):
        state = dataclasses.replace(result.boundary, displacement=scale * result.boundary.displacement)
        axes = Figure().add_subplot()
        figures.draw_deformed(axes, dataclasses.replace(result, boundary=state))
        assert bool(grey_lines(axes)) == (factor_of(axes) == 1) != ("not drawn" in axes.get_title(loc="left"))
        assert result.problem is not None
        for line in grey_lines(axes):
            surfaces = [zone.surface for zone in result.problem.contact_zones.values()]
            gaps = [surface.closest(line)[0] for surface in surfaces if not isinstance(surface, DeflectedContour)]
            assert min(np.abs(gap).max() for gap in gaps) < 1e-9 * 100
        shown.append(bool(grey_lines(axes)))
    assert not shown[0]
    assert shown[-1]


def test_round_off_in_the_gap_is_drawn_as_closed():
    problem = block_in_a_corner().model_dump()
    problem["contact_zones"].pop("wall")
    problem["conditions"].pop("right")
    problem["conditions"]["left"] = {"displacement": {"x": 0}}
    problem["conditions"]["top"] = {"pressure": 3}
    problem["loads"] = {}
    problem["boundary"]["holes"] = []
    result = analysis.solve(Problem(**problem))  # uniform compression
    axes = Figure().add_subplot()
    figures.draw_gap(axes, result)
    assert [text.get_text() for text in axes.texts] == ["closed everywhere"]
    assert axes.get_ylim()[1] == result.contact.scales.displacement


def test_volume_loads_are_drawn():
    """An arrow down for the weight, the sense of the rotation, and all in words in the legend."""
    loads = {
        "gravity": {"density": 1e-3, "acceleration": [0, -9.81]},
        "centrifugal": {"density": 1e-3, "angular_velocity": -3, "center": [1, 1]},
        "temperature": {"expansion": 1e-5, "change": 20},
    }
    problem = Problem(**{**block_in_a_corner().model_dump(), "loads": loads})
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    (gravity,) = [text for text in axes.texts if isinstance(text, Annotation)]
    assert gravity.get_text() == "$g$"
    (x0, y0), (x1, y1) = gravity.xyann, gravity.xy
    assert (x1 - x0, np.sign(y1 - y0)) == (pytest.approx(0, abs=1e-9), -1)
    assert any("circlearrowright" in text.get_text() for text in axes.texts)
    legend = axes.get_legend()
    assert legend is not None
    said = [text.get_text() for text in legend.get_texts()]
    assert said[-3:] == ["gravity (0, -9.81)", "rotation -3 about (1, 1)", "temperature change 20"]


def test_names_stand_on_their_own_side_of_a_slender_body():
    """A name beyond the far edge of a beam would belong to the wrong one."""
    problem = beam_over_a_circle()
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    heights = {text.get_text().split("\n")[0]: text.get_position()[1] for text in axes.texts}
    assert heights["top"] > 0  # the beam lies between 0 and 5
    assert heights["under"] < 5


def test_tractions_along_an_edge_stand_beside_it_one_after_the_other():
    problem = beam_over_a_circle().model_dump()
    problem["conditions"]["top"] = {"traction": {"x": 2}}
    loaded = Problem(**problem)
    axes = only_axes(figures.figure_of_problem(loaded, mesh.build(loaded)))
    arrows = next(item for item in axes.collections if isinstance(item, Quiver) and np.ravel(item.U).max() > 0)
    tails = np.asarray(arrows.get_offsets())
    assert (tails[:, 1] > 5).all()
    assert np.abs(np.diff(np.sort(tails[:, 0]))).min() > np.ravel(arrows.U).max()


@pytest.mark.parametrize("name", ["long words " * 60, "x" * 900, "方块"])
def test_long_and_foreign_names_fit(name: str, tmp_path: Path):
    problem = Problem(**{**block_in_a_corner().model_dump(), "name": name})
    figures.save(figures.figure_of_problem(problem, mesh.build(problem)), tmp_path / "problem.png")
    figures.save(figures.figure_of_result(analysis.solve(problem)), tmp_path / "result.png")
    for path in tmp_path.iterdir():
        height, width = matplotlib.image.imread(path).shape[:2]
        assert width < 13 * 160
        assert height < 10 * 160


def test_zones_with_equal_pressures_are_both_seen():
    """The wall's line is thinner than the floor's and dashed; the legend is above the axes."""
    axes = Figure().add_subplot()
    figures.draw_pressure(axes, analysis.solve(block_in_a_corner()))
    first, second = (line for line in axes.lines if len(line.get_xdata()) > 2)
    assert first.get_linewidth() > second.get_linewidth()
    assert (first.get_linestyle(), second.get_linestyle()) == ("-", "--")
    legend = axes.get_legend()
    assert legend is not None
    assert legend.get_window_extent().y0 >= axes.get_window_extent().y1


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_figure_written_twice_is_the_same(tmp_path: Path, ending: str):
    problem = beam_over_a_circle()
    for name in ("a", "b"):
        figures.save(figures.figure_of_problem(problem, mesh.build(problem)), tmp_path / f"{name}.{ending}")
    assert (tmp_path / f"a.{ending}").read_bytes() == (tmp_path / f"b.{ending}").read_bytes()


def test_the_largest_displacement_is_magnified_to_be_seen(result: analysis.Result):
    """To 2 to 5 % of the size by a factor of 1, 2 or 5 times a power of ten; large displacements stay as they are."""
    assert result.boundary is not None
    for scale in (1e-9, 1e-3, 1.0, 1e3):
        state = dataclasses.replace(result.boundary, displacement=scale * result.boundary.displacement)
        axes = Figure().add_subplot()
        figures.draw_deformed(axes, dataclasses.replace(result, boundary=state))
        factor = factor_of(axes)
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
    with pytest.raises(ValueError, match="no boundary"):
        figures.draw_contact(Figure().add_subplot(), result)


@pytest.mark.parametrize(("ending", "magic"), [(".png", b"\x89PNG"), (".SVG", b"<?xml"), (".pdf", b"%PDF")])
def test_saved_in_the_format_of_the_ending(problem: Problem, tmp_path: Path, ending: str, magic: bytes):
    path = tmp_path / f"figure{ending}"
    figures.save(figures.figure_of_problem(problem, mesh.build(problem)), path)
    assert path.read_bytes().startswith(magic)
    assert [*tmp_path.iterdir()] == [path]


def test_unknown_format_is_refused(tmp_path: Path):
    with pytest.raises(ValueError, match=r"\.png, \.svg or \.pdf"):
        figures.save(Figure(), tmp_path / "figure.gif")
    assert [*tmp_path.iterdir()] == []
