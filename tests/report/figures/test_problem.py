"""Pictures: everything has its name, nothing covers another name, hatching is on the rigid side, scales are stated."""

import numpy as np
import pytest
from drawings import (
    beam_over_a_circle,
    block_in_a_corner,
    grey_lines,
    leaves,
    off,
    only_axes,
    roller_in_a_groove,
    strokes,
)
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.path import Path as Outline
from matplotlib.quiver import Quiver
from matplotlib.text import Annotation
from roller_bearings import bearing
from tool_problems import HELD, HELD_CASES, made

from bemcontact.analysis import solve as analysis
from bemcontact.bem import mesh
from bemcontact.problems import DeflectedContour, Problem
from bemcontact.report import figures
from bemcontact.report.figures.page import GREY
from bemcontact.report.figures.problem import draw_tools, fills, polygons_of
from bemcontact.report.figures.symbols import COIL


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


def test_conditions_are_written_at_their_edges():
    problem = block_in_a_corner()
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    told = {text.get_text().split("\n")[0]: text.get_text().split("\n")[1:] for text in axes.texts}
    assert told["top"] == ["pressure 3 … 5 MPa"]
    assert told["right"] == ["$t_x$ = -2 MPa", "$t_y$ = 0"]
    assert told["left"] == ["may touch in wall"]
    assert told["hole"] == []


def test_no_name_stands_on_a_rigid_surface_or_its_hatching():
    """Names of edges in contact stand in the body: behind the floor and the wall they would name these."""
    problem = block_in_a_corner()
    figure = figures.figure_of_problem(problem, mesh.build(problem))
    figure.draw_without_rendering()
    axes = only_axes(figure)
    strokes_drawn = [
        np.asarray(patch.get_path().vertices).reshape(-1, 2, 2)
        for patch in axes.patches
        if to_hex(patch.get_edgecolor()) == GREY
    ]
    hatching = axes.transData.transform(np.linspace(*np.concatenate(strokes_drawn).swapaxes(0, 1), 9).reshape(-1, 2))
    assert len(strokes_drawn) == 2
    for text in axes.texts:
        box = text.get_window_extent()
        assert not ((hatching > box.min) & (hatching < box.max)).all(axis=1).any(), text.get_text()
    for text in axes.texts:
        if "may touch" in text.get_text():
            assert min(text.get_position()) > 0


def test_springs_are_drawn_outside_the_body_with_their_stiffness():
    """Across the edge and along it, eight of each at most, on the outer side of the edge."""
    stiff = {"normal": 50.0, "tangent": 10.0, "x": 2.0}
    problem = block_in_a_corner().with_value("conditions.right", {"spring": stiff})
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    (told,) = [text.get_text().split("\n")[1:] for text in axes.texts if text.get_text().startswith("right")]
    assert told == ["springs across it 50 N/mm³", "springs along it 10 N/mm³", "springs along x 2 N/mm³"]
    coils = [
        line
        for collection in axes.collections
        if isinstance(collection, LineCollection)
        for line in collection.get_segments()
        if len(line) == len(COIL)
    ]
    edge = problem.edge("right")
    right = edge.points(np.array([0.5]))[0, 0]
    across, along = ([line for line in coils if abs(np.ptp(line, axis=0)).argmax() == axis] for axis in (0, 1))
    assert len(coils) == 3 * len(along)
    assert len(across) == 2 * len(along)  # those along x are across this edge too
    assert 2 <= len(along) <= 8
    assert all(line[:, 0].min() > right - 1e-9 * problem.size for line in coils)


def test_mesh_passes_through_all_nodes(problem: Problem):
    meshed = mesh.build(problem)
    axes = only_axes(figures.figure_of_problem(problem, meshed))
    edges = [stroke for stroke in strokes(axes) if len(stroke) % 8 == 1]
    assert sum(len(edge) // 8 for edge in edges) == len(meshed.elements)
    assert off(meshed.nodes[meshed.elements], np.concatenate(edges)) < 1e-12 * meshed.size


def test_rigid_surfaces_are_drawn_where_they_are():
    problem = beam_over_a_circle()
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    points = np.concatenate([np.column_stack(line.get_data()) for line in axes.lines if line.get_color() == "#7d838c"])
    surface = problem.contact_zones["drum"].surface
    assert not isinstance(surface, DeflectedContour)
    gap, _ = surface.closest(points)
    assert gap == pytest.approx(0, abs=1e-12 * 100)


def test_the_normal_of_a_surface_is_drawn_where_the_body_is_nearest():
    """At the top of the circle, which is below the end of the beam."""
    problem = beam_over_a_circle()
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    grey = [item for item in axes.collections if isinstance(item, Quiver) and to_hex(item.get_facecolor()[0]) == GREY]
    (arrow,) = grey
    assert (arrow.X[0], arrow.Y[0]) == pytest.approx((50, -1))
    assert arrow.U[0] == pytest.approx(0, abs=1e-9)
    assert arrow.V[0] > 0


def test_a_body_whose_only_edge_may_touch_two_planes_is_drawn():
    rim = {"name": "rim", "kind": "arc", "center": [0, 0], "radius": 1, "angles": [0, 360], "elements": 12}
    planes = {"floor": ([0, -1], [0, 1]), "wall": ([-1, 0], [1, 0])}
    problem = Problem.model_validate(
        {
            "name": "ball",
            "material": {"young_modulus": 1000.0, "poisson_ratio": 0.3},
            "boundary": {"outer": [rim]},
            "contact_zones": {
                name: {"surface": {"kind": "plane", "point": point, "normal": normal}}
                for name, (point, normal) in planes.items()
            },
        }
    )
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    assert [text.get_text() for text in axes.texts] == ["rim\nmay touch in floor\nmay touch in wall"]


def test_a_deflected_contour_is_drawn_as_far_from_the_edge_as_the_gap_is():
    contour = {"kind": "deflected_contour", "conditions": {"top": {"traction": {"y": -1.2}}}, "direction": [0, 1]}
    problem = beam_over_a_circle().with_value("contact_zones.drum.surface", contour)
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    gap = analysis.condense(problem).initial_gap  # without the clamped node, which does not move
    (ground,) = (line for line in grey_lines(axes) if len(line) == len(gap) + 1)
    assert ground[:, 1] == pytest.approx(np.append(0.0, -gap), abs=1e-12 * 50)


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


def test_names_are_on_their_own_side_of_a_slender_body():
    """A name beyond the far edge of a beam would belong to the wrong one."""
    problem = beam_over_a_circle()
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    heights = {text.get_text().split("\n")[0]: text.get_position()[1] for text in axes.texts}
    assert heights["top"] > 0  # the beam lies between 0 and 5
    assert heights["under"] < 5


def test_tractions_along_an_edge_are_beside_it_in_a_row():
    problem = beam_over_a_circle().model_dump()
    problem["conditions"]["top"] = {"traction": {"x": 2}}
    loaded = Problem(**problem)
    axes = only_axes(figures.figure_of_problem(loaded, mesh.build(loaded)))
    arrows = next(item for item in axes.collections if isinstance(item, Quiver) and np.ravel(item.U).max() > 0)
    tails = np.asarray(arrows.get_offsets())
    assert (tails[:, 1] > 5).all()
    assert np.abs(np.diff(np.sort(tails[:, 0]))).min() > np.ravel(arrows.U).max()


def test_no_text_covers_the_legend():
    """Two tools, the second at the right end, where the legend begins beside the axes."""
    outline = {
        "bottom": {"start": [-30, -20]}, "right": {"start": [30, -20]}, "beside": {"start": [30, 0]},
        "seat": {"start": [18, 0]}, "rest": {"start": [10, 0]}, "left": {"start": [-30, 0]},
    }  # fmt: skip
    problem = Problem.model_validate(
        {
            "name": "block under a roller",
            **UNITS,
            "material": {"young_modulus": 210e3, "poisson_ratio": 0.3},
            "boundary": {"outer": [{"name": name, "elements": 2, **edge} for name, edge in outline.items()]},
            "conditions": {"bottom": {"displacement": {"x": 0, "y": 0}}},
            "contact_zones": {
                "roller": {
                    "edges": "seat",
                    "surface": {"kind": "circle", "center": [14, 10], "radius": 10, "body": "outside"},
                }
            },
            "tools": {"roller": {"zones": "roller", "point": [14, 10], "force": {"y": -100}}},
        }
    )
    figure = figures.figure_of_problem(problem, mesh.build(problem))
    figure.draw_without_rendering()
    axes = only_axes(figure)
    legend = axes.get_legend()
    assert legend is not None
    assert not any(text.get_window_extent().overlaps(legend.get_window_extent()) for text in axes.texts)


UNITS = {"units": {"length": "mm", "force": "N"}}


def rows(axes: Axes) -> list[tuple[np.ndarray, np.ndarray]]:
    """Tails (k, 2) and vectors (k, 2) of each row of arrows."""
    quivers = [item for item in axes.collections if isinstance(item, Quiver)]
    return [(np.asarray(item.XY), np.column_stack([np.asarray(item.U), np.asarray(item.V)])) for item in quivers]


def arrows(axes: Axes) -> list[tuple[np.ndarray, np.ndarray]]:
    """Tail (2,) and vector (2,) of each arrow that stands alone."""
    return [(tails[0], vectors[0]) for tails, vectors in rows(axes) if len(tails) == 1]


def picture(problem: Problem) -> Axes:
    return figures.figure_of_problem(problem, mesh.build(problem)).axes[0]


def test_a_force_ends_at_the_point_of_the_tool_and_a_displacement_too():
    """The punch at (1.5, 1) presses down, the table at (0, 0) is displaced up, both into the body."""
    axes = Figure().add_subplot()
    drawn = [*draw_tools(axes, made(HELD))]
    tips = [np.add(tail, vector) for tail, vector in arrows(axes)]
    assert np.array(tips) == pytest.approx(np.array([[1.5, 1.0], [0.0, 0.0]]))
    assert [vector[0] for _, vector in arrows(axes)] == [0, 0]
    assert len(drawn) == 2


def test_tool_without_a_point_is_drawn_where_its_surface_is_nearest():
    """The round punch (1.6, 7), radius 6, is nearest to the edge y = 1 with its lowest point (1.6, 7 - 6)."""
    axes = Figure().add_subplot()
    tools = {"punch": {"zones": "punch", "displacement": {"y": 0.01}}}
    [(_, name)] = draw_tools(axes, made(HELD, tools=tools))
    [(tail, vector)] = arrows(axes)
    assert tail == pytest.approx(np.array([1.6, 1.0]))
    assert vector[1] > 0
    assert name.text == "punch\ndisplaced by y = 0.01"


def test_tool_has_the_load_of_the_acting_case():
    texts = [text.get_text() for text in picture(made(HELD, **HELD_CASES, **UNITS, case="push")).texts]
    assert "punch\nloaded by y = -70 N/mm,\nmoment = -1 N·mm/mm" in texts


@pytest.mark.slow
def test_the_picture_shows_the_conditions_of_the_case_that_acts():
    axes = picture(made(HELD, **HELD_CASES, **UNITS, case="wind"))
    texts = [text.get_text() for text in axes.texts]
    assert axes.get_title(loc="left") == "held block, wind"
    assert "top\npressure 1.5 MPa (wind)" in texts
    assert "right\npressure 2 MPa\n$t_x$ = 1 MPa (wind)\n$t_y$ = -2 MPa (wind)" in texts


def test_forces_on_an_edge_add_up_in_the_picture():
    """A pressure of 2 and a traction of (1, -2) on the right side are (-1, -2) together."""
    axes = picture(made(HELD, **HELD_CASES, case="wind"))
    [right] = [vectors for tails, vectors in rows(axes) if len(tails) > 1 and tails[:, 0].min() >= 2]
    assert (right[:, 0] < 0).all()
    assert right[:, 1] == pytest.approx(2 * right[:, 0])


def test_names_of_edges_stand_in_no_other_body():
    """The names of a slender body have two lines, for which there is no room in it."""
    problem = leaves()
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    places = {text.get_text().split("\n")[0]: text.get_position() for text in axes.texts}
    assert set(places) == {edge.name for edge in problem.edges}
    assert not any(0 < x < 100 and 0 < y < 4 for name, (x, y) in places.items() if name.startswith("short"))
    assert not any(0 < x < 60 and -4 < y < 0 for name, (x, y) in places.items() if name.startswith("long"))


def test_name_far_from_its_edge_has_a_line_to_it():
    problem = leaves()
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    (text,) = (item for item in axes.texts if item.get_text().startswith("short/top"))
    starts = [np.asarray(line.get_xydata())[0] for line in axes.lines if line.get_color() == text.get_color()]
    assert any(abs(start[1]) < 1e-9 and 0 <= start[0] <= 60 for start in starts)


@pytest.mark.slow
def test_many_bodies_have_their_names_and_edges_where_there_is_room():
    problem = bearing(1.0, 0.0, elements=16)
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    texts = {text.get_text(): text for text in axes.texts}
    for part, loops in zip(problem.parts, polygons_of(problem), strict=True):
        inside = [Outline(loop).contains_point(texts[part.name].get_position()) for loop in loops]
        assert np.logical_xor.reduce(inside)
    boxes = [text.get_window_extent() for text in axes.texts]
    assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])
    assert not any("/" in text for text in texts)


@pytest.mark.slow
def test_of_many_edges_those_that_matter_have_their_names():
    """A comb of 30 teeth on a long bar: the names of its short free edges are left out, and nothing overlaps."""
    teeth = [(x, y) for i in range(30) for x, y in ((50 - i, 1), (49.5 - i, 1), (49.5 - i, 0.5), (49 - i, 0.5))]
    corners = [(0, 0), (200, 0), (200, 100), (100, 100), *teeth]
    data = {
        "name": "comb",
        "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
        "boundary": {"outer": [{"name": f"edge {i}", "start": at, "elements": 1} for i, at in enumerate(corners)]},
        "conditions": {"edge 0": {"displacement": {"x": 0, "y": 0}}, "edge 6": {"pressure": 1}},
        "contact_zones": {
            "foot": {"edges": "edge 4", "surface": {"kind": "plane", "point": (0, 1), "normal": (0, -1)}}
        },
    }
    problem = Problem(**data)  # pyright: ignore[reportArgumentType]
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    names = {text.get_text().split("\n")[0] for text in axes.texts}
    assert names >= {"edge 0", "edge 1", "edge 2", "edge 3", "edge 4", "edge 6"}
    assert len(names) < len(corners) / 2
    boxes = [text.get_window_extent() for text in axes.texts]
    assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])


@pytest.mark.slow
def test_load_cases_that_are_not_drawn_are_named_with_the_option():
    problem = made(HELD, **HELD_CASES)
    title = only_axes(figures.figure_of_problem(problem, mesh.build(problem))).get_title(loc="left")
    assert "--case" in title
    assert all(case in title for case in problem.case_names)
    one = problem.with_case(problem.case_names[0])
    assert "--case" not in only_axes(figures.figure_of_problem(one, mesh.build(one))).get_title(loc="left")


def test_weight_of_one_of_several_bodies_is_drawn_at_it():
    problem = roller_in_a_groove()
    axes = only_axes(figures.figure_of_problem(problem, mesh.build(problem)))
    (weight,) = [item for item in axes.collections if isinstance(item, Quiver) and np.ravel(item.V).min() < 0]
    middle = np.asarray(weight.get_offsets())[0] + np.array([0, weight.V[0] / 2])
    assert middle == pytest.approx([0, 14.142], abs=1e-3)


def test_copies_among_many_bodies_share_a_color():
    colors = dict(zip((part.name for part in bearing(1.0, 0.0, 16).parts), fills(bearing(1.0, 0.0, 16)), strict=True))
    assert len(set(colors.values())) == len({name.split()[0] for name in colors})
    assert len(set(fills(leaves()))) == 2
