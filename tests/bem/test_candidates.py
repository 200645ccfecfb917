"""Points of contact: one for each face of the surface that holds a node; element lengths along the boundary."""

import itertools

import numpy as np
import pytest
import several_bodies
from bodies import arc, even, mesh_of
from hypothesis import example, given, settings
from hypothesis import strategies as st
from several_bodies import HELD, block, circle, elastic

from bemcontact import problem, solve
from bemcontact.bem.discretization import body_of
from bemcontact.problems import Polyline, Problem
from bemcontact.problems.body_surface import BodySurface

PRESSURE = 3.0
FILLED = {"temperature": {"expansion": 1e-5, "change": (1 - 2 * 0.3) * PRESSURE / 1000.0 / 1e-5}}
"""The heat that gives a body back the size that the pressure takes: E α ΔT = (1 - 2 ν) p in plane strain."""


def outline(angles, radii, elements=2):
    """Corners of a star-shaped body, counterclockwise, and its edges by number."""
    angles = np.cumsum(angles) / np.sum(angles) * 2 * np.pi
    corners = np.column_stack([np.cos(angles), np.sin(angles)]) * np.array(radii)[:, None]
    return [{"name": f"e{i}", "start": tuple(at), "elements": elements} for i, at in enumerate(corners.tolist())]


def problem_of(edges, zones, loaded=PRESSURE, **more):
    """Press a body on all edges that are in no zone; `zones` has edge names and points of a polyline by name."""
    held = {name for names, _ in zones.values() for name in names}
    return Problem(
        name="corners",
        material={"young_modulus": 1000.0, "poisson_ratio": 0.3},  # pyright: ignore[reportArgumentType]
        boundary={"outer": edges},  # pyright: ignore[reportArgumentType]
        conditions={edge["name"]: {"pressure": loaded} for edge in edges if edge["name"] not in held},  # pyright: ignore
        contact_zones={
            name: {"edges": names, "surface": {"kind": "polyline", "points": points}}
            for name, (names, points) in zones.items()
        },  # pyright: ignore[reportArgumentType]
        **more,
    )


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(
    angles=st.lists(st.floats(0.6, 1.4), min_size=6, max_size=6),
    radii=st.lists(st.floats(0.5, 1.5), min_size=6, max_size=6),
    faces=st.integers(1, 3),
    shift=st.tuples(st.floats(-1e-3, 1e-3), st.floats(-1e-3, 1e-3)),
    apart=st.booleans(),
)
@example(angles=[1.0] * 6, radii=[1.0, 0.6, 1.0, 1.0, 1.0, 1.0], faces=2, shift=(0.0, 0.0), apart=False)
@example(angles=[1.0] * 6, radii=[1.0, 0.4, 1.0, 1.0, 1.0, 1.0], faces=3, shift=(1e-3, 2e-3), apart=True)
def test_pressure_of_a_fluid_on_faces_that_fit_the_body(angles, radii, faces, shift, apart):
    """Equal pressure from all sides of a heated body moves nothing: an exact state, at any angle between the faces.

    Faces that the shift moves off the body, or into it, do not change it: the body follows.
    """
    edges = outline(angles, radii)
    names = [f"e{i}" for i in range(faces)]
    points = [tuple(np.add(edges[i]["start"], shift)) for i in range(faces + 1)]
    zones = {name: ((name,), points) for name in names} if apart else {"all": (names, points)}
    problem = problem_of(edges, zones, loads=FILLED, accuracy=None)  # no error bars: the state is exact
    assert len(body_of(problem).points) == sum(2 * 2 + 1 for _ in names)
    result = solve(problem, "complementarity")
    assert result.solution.pressure == pytest.approx(PRESSURE, rel=1e-8)
    assert len(result.footprint.intervals) == faces
    for interval, name in zip(result.footprint.intervals, names, strict=True):
        edge = int(name[1:])
        assert interval.start == pytest.approx(edges[edge]["start"], abs=1e-12)
        assert interval.end == pytest.approx(edges[edge + 1]["start"], abs=1e-12)


@given(st.floats(0.02, 1.4), st.floats(0.02, 1.4), st.floats(-0.3, 0.3), st.floats(0, 0.1), st.floats(-3, 3))
@example(left=1.0, right=1.0, along=2**-24, height=2**-4, turn=0.0)
def test_a_ridge_presses_on_a_smooth_edge_along_the_normal_of_the_body(left, right, along, height, turn):
    """At it and beside it, whatever its flanks, if they fall away from the body: gaps are heights above the surface."""
    flanks = np.array([(-np.cos(left), -np.sin(left)), (0.0, 0.0), (np.cos(right), -np.sin(right))])
    c, s = np.cos(turn), np.sin(turn)
    rotate = np.array([[c, s], [-s, c]])
    line = Polyline(points=tuple(map(tuple, (flanks @ rotate).tolist())))
    inward = np.array([0.0, 1.0]) @ rotate
    place = (np.array([[along, height]]) @ rotate, np.tile(inward, (1, 2, 1)), np.zeros(1))
    gap, normals, _ = line.faces(*place)
    fall = -along * np.tan(left) if along < 0 else along * np.tan(right)
    np.testing.assert_allclose(normals, np.tile(inward, (1, 3, 1)), atol=1e-7)
    np.testing.assert_allclose(gap, height + fall, rtol=1e-7, atol=1e-9)


@given(st.floats(1e-3, 0.09), st.floats(0.1, 3), st.floats(-3, 3))
def test_an_edge_on_a_kinked_floor_has_one_normal_up_to_its_end(slope, along, turn):
    """The gap has no step beside the end of the edge, which would be an infinite pressure there."""
    c, s = np.cos(turn), np.sin(turn)
    rotate = np.array([[c, s], [-s, c]])
    line = Polyline(
        points=tuple(map(tuple, (np.array([(-1.0, 0.0), (0.0, 0.0), (4.0, -4 * slope)]) @ rotate).tolist()))
    )
    sides = np.array([[(0.0, 1.0), (-1.0, 0.0)], [(0.0, 1.0), (0.0, 1.0)]]) @ rotate
    gap, normals, _ = line.faces(np.array([[along, 0.0]] * 2) @ rotate, sides, np.zeros(2))
    np.testing.assert_allclose(normals, np.tile(sides[1, 0], (2, 3, 1)), atol=1e-7)
    np.testing.assert_allclose(gap, along * slope, rtol=1e-7)


@pytest.mark.parametrize("slope", [0.1, 1.0, 20.0])
def test_the_force_of_a_knife_is_normal_to_the_body(slope):
    """Each of two knives takes half the load of a beam, whatever their angle, and nothing along the beam.

    Both zones have all nodes of the edge, but each node only one point: that of the nearer surface.
    """
    corners = {"bottom": (-30, 0), "right": (30, 0), "top": (30, 4), "left": (-30, 4)}
    edges = [{"name": name, "start": at, "elements": 12} for name, at in corners.items()]
    zones = {f"{x}": (("bottom",), [(x - 9, -9 * slope), (x, 0), (x + 9, -9 * slope)]) for x in (-15, 15)}
    result = solve(problem_of(edges, zones, 1e-3, accuracy=None))
    inner = abs(result.contact.points[:, 0]) < 30
    assert np.count_nonzero(inner) == 2 * 12 - 1
    forces = result.contact.resultants(result.solution.pressure)
    np.testing.assert_allclose(forces, [[0.0, 30 * 1e-3]] * 2, atol=1e-12)


@given(st.floats(0.3, 2.8), st.floats(0.0, 0.05), st.floats(0.0, 0.05), st.floats(-3, 3))
def test_a_corner_in_a_groove_has_the_gaps_to_both_faces(angle, first, last, turn):
    """Whichever face is the nearer one, and however acute or blunt the groove is, the body fits it with clearance."""
    c, s = np.cos(turn), np.sin(turn)
    rotate = np.array([[c, s], [-s, c]])
    down, along = np.array([-np.cos(angle), -np.sin(angle)]), np.array([1.0, 0.0])
    line = Polyline(points=tuple(map(tuple, (np.array([-down, [0, 0], along]) @ rotate).tolist())))
    faces = np.array([[np.sin(angle), -np.cos(angle)], [0.0, 1.0]])  # into the body, before and after the corner
    place = np.linalg.solve(faces, [first, last])
    gap, normals, _ = line.faces((place @ rotate)[None], (faces @ rotate)[None], np.zeros(1))
    np.testing.assert_allclose(gap[0, [0, 2]], [first, last], atol=1e-12)
    np.testing.assert_allclose(normals[0, [0, 2]], faces @ rotate, atol=1e-12)


def test_a_corner_that_stands_on_a_third_face_has_three_points():
    """A square in a groove with a beveled corner: its corner is on the bevel, its sides are off the walls.

    Three normals at one node are dependent, so that the compliance is not definite.
    """
    corners = {"bottom": (0, 0), "right": (1, 0), "top": (1, 1), "left": (0, 1)}
    edges = [{"name": name, "start": at, "elements": 2} for name, at in corners.items()]
    bevel = [(-0.02, 5.0), (-0.02, 0.02), (0.02, -0.02), (5.0, -0.02)]
    problem = problem_of(edges, {"groove": (("left", "bottom"), bevel)})
    body = body_of(problem)
    at_corner = np.flatnonzero(body.points.node == 0)
    np.testing.assert_allclose(body.points.gap[at_corner], [0.02, 0.02, 0.0], atol=1e-12)
    result = solve(problem)
    assert not result.certificate.violation
    assert result.footprint.resultant.force == pytest.approx((PRESSURE, PRESSURE), rel=1e-9)
    gaps = result.solution.displacement + result.contact.initial_gap
    assert gaps[at_corner].min() >= -1e-12
    np.testing.assert_allclose(body.points.tributary[at_corner[2]], 2 * 0.5 / 6, rtol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("corner", [0.4, 1.4])
def test_a_tool_and_the_surface_itself_may_be_displaced(corner):
    """The tool's displacement changes the gaps of both faces of a corner as a shift of the surface does."""
    edges = outline([1.0] * 6, [1.0, corner, 1.0, 1.0, 1.0, 1.0])
    points, shift = [edges[i]["start"] for i in range(3)], (2e-3, -1e-3)
    held = {"e4": {"displacement": {"x": 0, "y": 0}}}

    def solved(points, **more):
        data = problem_of(edges, {"faces": (("e0", "e1"), points)}).model_dump(exclude={"variants"})
        return solve(Problem(**{**data, "conditions": held, **more}), "complementarity")

    moved = solved(points, tools={"die": {"zones": "faces", "displacement": dict(zip("xy", shift, strict=True))}})
    shifted = solved([tuple(np.add(point, shift)) for point in points])
    scale = shifted.contact.scales
    np.testing.assert_allclose(moved.contact.initial_gap, shifted.contact.initial_gap, atol=1e-12)
    np.testing.assert_allclose(moved.solution.pressure, shifted.solution.pressure, atol=1e-8 * scale.pressure)


def test_element_lengths_are_arc_lengths():
    """A circle of 64 elements: the parabola is shorter than the arc by less than (angle)^4/480, relative."""
    mesh = mesh_of([("c", arc((0, 0), 2, 0, 360), even(64))])
    exact = 2 * np.pi / 32
    assert abs(mesh.lengths / exact - 1).max() < (2 * np.pi / 64) ** 4 / 480


def rounded(turn, cut, edges, load):
    """A square whose rounded corner lies in the corner of two walls, with its arc in one edge or in several."""
    c, s, degrees = np.cos(turn), np.sin(turn), np.degrees(turn)

    def at(x, y):
        return c * x - s * y, s * x + c * y

    angles = [180 + degrees, *(180 + degrees + 90 * part for part in cut), 270 + degrees]
    each = 12 // (len(angles) - 1)
    arcs = [
        {"name": f"round {i}", "kind": "arc", "center": at(1, 1), "radius": 1, "angles": pair, "elements": each}
        for i, pair in enumerate(itertools.pairwise(angles))
    ]
    sides = {"bottom": (1, 0), "right": (3, 0), "top": (3, 3), "left": (0, 3)}
    walls = {"floor": ((0, 0.0), (0, 1)), "wall": ((0.0, 0), (1, 0))}
    return Problem(
        name="rounded",
        material={"young_modulus": 1000.0, "poisson_ratio": 0.3},  # pyright: ignore[reportArgumentType]
        boundary={"outer": [*arcs, *({"name": k, "start": at(*p), "elements": 3} for k, p in sides.items())]},  # pyright: ignore[reportArgumentType]
        loads={"gravity": {"density": 1, "acceleration": at(*load)}},  # pyright: ignore[reportArgumentType]
        contact_zones={
            name: {"edges": edges[name], "surface": {"kind": "plane", "point": at(*p), "normal": at(*n)}}
            for name, (p, n) in walls.items()
        },  # pyright: ignore[reportArgumentType]
        mesh={"adapt": False},  # pyright: ignore[reportArgumentType]
    )


def by_place(result):
    """Zone, place and pressure of all points under pressure, in a fixed order."""
    contact, pressure = result.contact, result.solution.pressure
    rows = np.column_stack([contact.zone, contact.points, pressure])[pressure > 0]
    return rows[np.lexsort(np.round(rows[:, :3].T, 9))]


@pytest.mark.parametrize("turn", [0.0, 0.4, 2.5])
def test_an_edge_on_two_walls_is_that_edge_cut_into_one_for_each(turn):
    """The same nodes: to round-off the same pressures, whoever names the edges; both states are proved unique."""
    whole = {"floor": ("round 0", "bottom"), "wall": ("round 0", "left")}
    halves = {"floor": ("round 1", "bottom"), "wall": ("round 0", "left")}
    results = [
        solve(rounded(turn, cut, edges, load=(-2, -3)))
        for cut, edges in (([], whole), ([0.5], halves), ([], {"floor": None, "wall": None}))
    ]
    first = by_place(results[0])
    assert {*first[:, 0]} == {0.0, 1.0}
    for result in results:
        assert result.certificate.kind.value == "unique"
        np.testing.assert_allclose(by_place(result), first, rtol=0, atol=1e-9 * first[:, 3].max())
    assert results[2].problem is not None
    assert results[2].problem.edges_of("floor") == whole["floor"]
    np.testing.assert_array_equal(results[2].solution.pressure, results[0].solution.pressure)
    area = 9 - (1 - np.pi / 4)
    c, s = np.cos(turn), np.sin(turn)
    force = results[0].footprint.resultant.force
    assert force == pytest.approx((area * (2 * c - 3 * s), area * (2 * s + 3 * c)), rel=1e-9)


@pytest.mark.parametrize("start", [-90.0, 0.0, 33.0])
def test_a_disk_between_two_plates_has_one_edge(start):
    """Opposite plates: no node is a point of both, for their normals would make the compliance singular."""
    angles = [start, start + 360]
    rim = {"name": "rim", "kind": "arc", "center": [0, 0], "radius": 1, "angles": angles, "elements": 24}
    plates = {"floor": ([0, -1], [0, 1]), "lid": ([0, 0.99], [0, -1])}
    problem = Problem(
        name="disk",
        material={"young_modulus": 1000.0, "poisson_ratio": 0.3},  # pyright: ignore[reportArgumentType]
        boundary={"outer": [rim]},  # pyright: ignore[reportArgumentType]
        contact_zones={
            name: {"surface": {"kind": "plane", "point": p, "normal": n}} for name, (p, n) in plates.items()
        },  # pyright: ignore[reportArgumentType]
        mesh={"adapt": False},  # pyright: ignore[reportArgumentType]
    )  # fmt: skip
    points = body_of(problem).points
    assert np.bincount(points.node).max() == 1
    result = solve(problem)
    contact, pressure = result.contact, result.solution.pressure
    floor, lid = (float(contact.weights[contact.zone == i] @ pressure[contact.zone == i]) for i in (0, 1))
    assert floor == pytest.approx(lid, rel=1e-6)
    assert floor > 0


def sealed(quarter):
    """A rubber block with rounded corners, the edges of which two planes share, squeezed in a groove; its symmetry."""
    if quarter:
        outer = [
            {"name": "middle", "start": (2.5, 3.0)},
            {"name": "right", "start": (5.0, 3.0)},
            {"fillet": 0.5, "name": "right top"},
            {"name": "top", "start": (5.0, 6.0), "end": (2.5, 6.0)},
            {"name": "axis"},
        ]
        planes, conditions = ("right", "top"), {"middle": {"symmetry": "y"}, "axis": {"symmetry": "x"}}
    else:
        corners = {"bottom": (0.0, 0.0), "right": (5.0, 0.0), "top": (5.0, 6.0), "left": (0.0, 6.0)}
        outer = [item for name, start in corners.items()
                 for item in ({"name": name, "start": start}, {"fillet": 0.5, "name": f"after {name}"})]  # fmt: skip
        planes, conditions = ("bottom", "right", "top", "left"), {}
    surfaces = {
        "bottom": ((0.0, 0.0), (0, 1)), "right": ((5.2, 0.0), (-1, 0)), "top": ((0.0, 6.0), (0, -1)),
        "left": ((-0.2, 0.0), (1, 0)),
    }  # fmt: skip
    return problem({
        "name": "seal",
        "material": {"young_modulus": 5.0, "poisson_ratio": 0.48},
        "boundary": {"outer": outer},
        "conditions": conditions,
        "contact_zones": {
            name: {"surface": {"kind": "plane", "point": surfaces[name][0], "normal": surfaces[name][1]}}
            for name in planes
        },
        "tools": {"lid": {"zones": "top", "displacement": {"y": -0.3 if quarter else -0.6}}},
    })  # fmt: skip


@pytest.mark.slow
def test_the_zones_of_one_edge_have_their_own_pressures_at_a_node():
    """The last point of one plane is a node of an element of the other one, whose pressure there is not overwritten.

    Else meshes would seem to differ there however fine they are, and the search would end without an answer.
    """
    whole, quarter = solve(sealed(quarter=False)), solve(sealed(quarter=True))
    assert whole.problem is not None
    points = body_of(whole.problem).points
    shares = np.column_stack([points.zone_of_share, points.element, points.local])
    assert len(np.unique(shares, axis=0)) == len(shares)
    assert whole.accuracy is not None
    assert whole.accuracy.met
    assert quarter.accuracy is not None
    assert quarter.accuracy.met
    error = whole.accuracy.worst + quarter.accuracy.worst
    forces = [{name: np.hypot(*force) for name, force in result.forces.items()} for result in (whole, quarter)]
    assert forces[0]["top"] == pytest.approx(forces[0]["bottom"], rel=1e-6)
    for name in ("top", "right"):
        assert forces[0][name] == pytest.approx(2 * forces[1][name], rel=error)
    assert whole.peak is not None
    assert quarter.peak is not None
    assert whole.peak.pressure == pytest.approx(quarter.peak.pressure, rel=error)


def test_points_of_two_bodies_have_the_faces_of_all_nodes():
    """Faces that are found at the nodes of a contact alone are those that are found at all nodes of both bodies."""
    roller, rail = circle("rim", 2.0, start=-90.0, elements=12), block((-3, 3), (-4, -2), (4, 4, 12, 4))
    weight = {"gravity": {"density": 1e-3, "acceleration": [0, -1]}}
    bodies = {"roller": elastic({"outer": [roller]}, loads=weight), "rail": elastic(rail, HELD)}
    both = several_bodies.problem(bodies, foot=[["roller/rim"], ["rail/top"]])
    body = body_of(both)
    surface, points = both.zones["foot"].surface, body.points
    assert isinstance(surface, BodySurface)
    gap, normals, faces = surface.faces(body.mesh.nodes, *body.outline.sides)
    assert len(points)
    for known, every in ((points.gap, gap), (points.normals, normals), (points.faces, faces)):
        assert known == pytest.approx(every[points.node, 1], abs=1e-15)
