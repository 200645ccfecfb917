"""Bodies condensed to their contact points: free rigid motions, equilibrium, gauge, refusals."""

import numpy as np
import pytest

from bemcontact.analysis.solve import solve
from bemcontact.bem.condense import boundary_state, condense
from bemcontact.bem.discretization import body_of
from bemcontact.bem.support import idle_motion
from bemcontact.errors import ProblemError
from bemcontact.problems import Problem

PLANE = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
CIRCLE = {"kind": "arc", "center": [0, 0]}
WALL = {"kind": "plane", "point": [0, 0], "normal": [1, 0]}


def rectangle(width, height, along, across):
    return [
        {"name": "bottom", "start": [0, 0], "end": [width, 0], "elements": along},
        {"name": "right", "elements": across, "start": [width, 0], "end": [width, height]},
        {"name": "top", "elements": along, "start": [width, height], "end": [0, height]},
        {"name": "left", "elements": across, "start": [0, height], "end": [0, 0]},
    ]


def problem(edges, zones, **more):
    return Problem(
        name="test",
        material=more.pop("material", {"young_modulus": 1000, "poisson_ratio": 0.3}),
        boundary={"outer": edges},
        contact_zones={name: {"edges": edge, "surface": surface} for name, (edge, surface) in zones.items()},
        **more,
    )


def block(conditions, zones=None, width=2.0, height=1.0, along=6, across=4, **more):
    return problem(
        rectangle(width, height, along, across), zones or {"base": (["bottom"], PLANE)}, conditions=conditions, **more
    )


def moment_of(result, about=(0.0, 0.0)):
    contact, pressure = result.contact, result.solution.pressure
    forces = (contact.weights * pressure)[:, None] * contact.normals
    x, y = (contact.points - np.array(about)).T
    return float(np.sum(x * forces[:, 1] - y * forces[:, 0]))


@pytest.mark.parametrize(
    ("conditions", "zones", "seen", "unseen", "idle"),
    [
        ({"left": {"displacement": {"x": 0, "y": 0}}}, None, 0, 0, 0),
        ({"left": {"displacement": {"x": 0}}, "top": {"pressure": 1}}, None, 1, 0, 0),
        ({"top": {"displacement": {"x": 0}}, "right": {"traction": {"y": -1}}}, None, 2, 0, 1),
        ({"top": {"pressure": 1}}, None, 2, 1, 0),
        ({"top": {"pressure": 1}}, {"base": (["bottom"], PLANE), "side": (["left"], WALL)}, 3, 0, 1),
    ],
)
def test_free_motions_are_counted(conditions, zones, seen, unseen, idle):
    """Number of the three motions that no displacement prevents, and of those that one or two planes see.

    A load right above the corner lets the body tilt about it without work, and one along a wall lets it slide off.
    """
    body = body_of(block(conditions, zones, **({"width": 0.2} if "right" in conditions else {})))
    assert (len(body.seen), len(body.unseen)) == (seen, unseen)
    condensed = condense(body).contact
    assert condensed.free_motions == seen
    assert len(condensed.notes) == unseen
    assert (idle_motion(body) is not None) == idle


@pytest.mark.slow
@pytest.mark.parametrize("formulation", ["complementarity", "qp1", "qp2", "qp3"])
@pytest.mark.parametrize(("gap", "turn"), [(0.1, 0.0), (0.0, 0.0), (-0.2, 0.0), (0.1, 0.7)])
def test_a_block_is_squeezed_beside_a_wall(gap, turn, formulation):
    """Free along the lid: p = E / (1 - ν²) times the squeeze over the height, wherever the wall is drawn.

    Where normals are no exact numbers, round-off is no load along the lid that the wall would have to hold.
    """

    def turned(x, y):
        return [np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y]

    planes = {"bottom": ((0, 0), (0, 1)), "top": ((0, 1), (0, -1)), "left": ((-gap, 0), (1, 0))}
    zones = {
        edge: ([edge], {"kind": "plane", "point": turned(*point), "normal": turned(*normal)})
        for edge, (point, normal) in planes.items()
    }
    edges = [
        {key: turned(*value) if key in ("start", "end") else value for key, value in edge.items()}
        for edge in rectangle(2.0, 1.0, 6, 4)
    ]
    x, y = turned(0.0, -0.01)
    tools = {"lid": {"zones": "top", "displacement": {"x": x, "y": y}}}
    result = solve(problem(edges, zones, tools=tools), formulation)
    assert result.certified
    p, wall = result.solution.pressure, result.contact.zone == [*zones].index("left")
    assert p[~wall] == pytest.approx(1000 / (1 - 0.3**2) * 0.01, rel=1e-6 if formulation == "qp3" else 1e-9)
    assert p[wall] == pytest.approx(0.0, abs=1e-6)
    (name,) = result.solution.undetermined
    assert name == f"translation along ({np.cos(turn):.4g}, {np.sin(turn):.4g})"


def test_a_block_that_nothing_squeezes_or_loads_has_no_position():
    """All contact ends when it is moved off, also where a surface is drawn inside it; or nothing squeezes it."""
    corner = {"base": (["bottom"], PLANE), "wall": (["left"], {**WALL, "point": (0.1, 0)})}
    lid = {"kind": "plane", "point": (0, 1), "normal": (0, -1)}
    for zones in (None, corner, {"base": (["bottom"], PLANE), "wall": (["left"], WALL), "lid": (["top"], lid)}):
        with pytest.raises(ProblemError, match="no load presses it"):
            body_of(block({}, zones))
    hot = {"temperature": {"expansion": 1e-5, "change": 100}}
    body_of(block({}, {"base": (["bottom"], PLANE), "wall": (["left"], WALL), "lid": (["top"], lid)}, loads=hot))


@pytest.mark.parametrize("axes", [0.0, 0.005, 0.5, np.pi / 2])
@pytest.mark.parametrize("slope", [0.0, 1e-8, -1e-6, 1e-4, 1e-3, 1e-2])
def test_a_block_that_a_lid_squeezes_out_is_refused_at_any_slope(slope, axes):
    """Along the base to the wider side it leaves all that it may touch, so that no pressure balances itself on it."""

    def at(x, y):
        return [np.cos(axes) * x - np.sin(axes) * y, np.sin(axes) * x + np.cos(axes) * y]

    edges = [
        {key: at(*value) if key in ("start", "end") else value for key, value in edge.items()}
        for edge in rectangle(2.0, 1.0, 6, 4)
    ]
    zones = {
        "base": (["bottom"], {"kind": "plane", "point": [0, 0], "normal": at(0, 1)}),
        "lid": (["top"], {"kind": "plane", "point": at(1, 1), "normal": at(-slope, -1)}),
    }
    x, y = at(0.0, -0.01)
    pressed = problem(edges, zones, tools={"lid": {"zones": "lid", "displacement": {"x": x, "y": y}}})
    if not slope:
        assert solve(pressed).peak.pressure == pytest.approx(1000 / (1 - 0.3**2) * 0.01)
        return
    with pytest.raises(ProblemError, match="no load presses it"):
        body_of(pressed)


def test_uniform_pressure_on_a_block_is_exact():
    """Constant stress: p = 10 at every point, also if only contact holds the body."""
    for conditions in ({"top": {"pressure": 10}}, {"top": {"pressure": 10}, "left": {"displacement": {"x": 0}}}):
        result = solve(block(conditions))
        assert result.certified
        assert result.solution.pressure == pytest.approx(np.full(13, 10.0), rel=1e-11)


def test_block_in_a_corner_of_two_planes():
    """Two points at the corner node; loads (-3, -10) per length with their moments are carried exactly."""
    zones = {"base": (["bottom"], PLANE), "wall": (["left"], WALL)}
    conditions = {"top": {"pressure": 10}, "right": {"pressure": {"constant": 1, "y": 4}}}
    result = solve(block(conditions, zones))
    contact = result.contact
    at_corner = np.flatnonzero(np.hypot(*contact.points.T) == 0)
    assert result.certified
    assert len(at_corner) == 2
    assert set(contact.zone[at_corner]) == {0, 1}
    # pressure 10 on a width of 2; 1 + 4y on a height of 1: force 3, moment ∫ y (1 + 4y) dy = 1/2 + 4/3
    assert result.footprint.resultant.force == pytest.approx([3, 20], rel=1e-9)
    assert moment_of(result) == pytest.approx(20 * 1 - (1 / 2 + 4 / 3), rel=1e-9)
    assert result.residuals.force_balance < 1e-12  # no tractions but loads and contact


@pytest.mark.parametrize("formulation", ["qp3", "complementarity"])
def test_block_on_a_plane_under_downward_load_on_three_free_motions(formulation):
    """A load off the middle: force and moment exact to 1e-9, sliding held at zero with a note, the wall not touched."""
    conditions = {"top": {"pressure": {"constant": 5, "x": 4}}}  # ∫ = 18, ∫ x = 10 + 32/3
    zones = {"base": (["bottom"], PLANE), "wall": (["left"], WALL)}
    for where in (None, zones):
        result = solve(block(conditions, where), formulation)
        assert result.certified
        assert result.footprint.resultant.force == pytest.approx([0, 18], abs=18e-9)
        assert moment_of(result) == pytest.approx(10 + 32 / 3, rel=1e-9)
    assert "held at zero" in solve(block(conditions)).contact.notes[0]


def test_polygon_on_a_plane_under_its_weight():
    """A trapezoid: the resultant is its weight 1.5 x 2, through its center of area at x = 7/9."""
    edges = [
        {"name": "bottom", "start": [0, 0], "end": [2, 0], "elements": 8},
        {"name": "slope", "start": [2, 0], "end": [1, 1], "elements": 4},
        {"name": "top", "elements": 3},
        {"name": "left", "start": [0, 1], "end": [0, 0], "elements": 3},
    ]
    load = {"gravity": {"density": 2, "acceleration": [0, -1]}}
    result = solve(problem(edges, {"base": (["bottom"], PLANE)}, loads=load))
    assert result.certified
    assert "translation along (1, 0)" in result.contact.notes[0]
    assert result.footprint.resultant.force == pytest.approx([0, 3], abs=3e-9)
    assert moment_of(result) == pytest.approx(3 * 7 / 9, rel=1e-9)


def test_node_whose_normal_motion_is_prescribed_is_no_candidate():
    """The clamped end of a contact edge carries no pressure; a symmetry line across the plane leaves its node."""
    clamped = body_of(block({"left": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": 1}}))
    assert not (np.hypot(*clamped.mesh.nodes[clamped.points.node].T) == 0).any()
    symmetric = body_of(block({"left": {"displacement": {"x": 0}}, "top": {"pressure": 1}}))
    assert (np.hypot(*symmetric.mesh.nodes[symmetric.points.node].T) == 0).any()


def partly_held(beyond, surface=PLANE, mirrored=False, slope=0.0, graded=1.0):
    """A block 2 x 1 under pressure 10 whose bottom may touch on one half and has a condition on the other."""
    names = ["foot", "beyond"] if not mirrored else ["beyond", "foot"]
    zone = {"name": names[0], "start": [0, 0], "elements": 4, "grading": {"ratio": graded, "towards": "end"}}
    edges = [zone, {"name": names[1], "start": [1, 0], "elements": 4}, *rectangle(2, 1, 4, 3)[1:]]
    edges[2]["start"] = [2, slope]
    conditions = {"top": {"pressure": 10}, "left": {"displacement": {"x": 0}}, "beyond": beyond}
    return body_of(problem(edges, {"foot": ("foot", surface)}, conditions=conditions))


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("graded", [1, 20])
def test_contact_that_continues_beyond_a_held_node(mirrored, graded):
    """The half that may touch is beside a held half: its pressure is 10 up to their common node."""
    body = partly_held({"displacement": {"y": 0}}, mirrored=mirrored, graded=graded)
    result = solve(condense(body).contact)
    assert result.certified
    assert len(body.points) == 8  # not the held node
    assert body.points.tributary.sum() == pytest.approx(1, rel=1e-13)
    assert body.points.consistent.sum() == pytest.approx(1, rel=1e-13)
    assert result.solution.pressure == pytest.approx(np.full(8, 10.0), rel=1e-10)
    assert result.footprint.resultant.force == pytest.approx([0, 10], abs=1e-9)
    assert solve(body.problem).residuals.force_balance < 1e-12


@pytest.mark.parametrize(
    "body",
    [
        partly_held(
            {"displacement": {"y": 0}}, surface={**PLANE, "point": [0, -0.01]}
        ),  # a step: the gap is open there
        partly_held({"displacement": {"y": 0}}, slope=0.2),  # a corner of 11 degrees
        partly_held({"displacement": {"y": 0.01}}),  # held above the plane
    ],
)
def test_contact_that_ends_at_a_held_node(body):
    """The pressure beyond the node is unknown; it is zero at the node."""
    assert len(body.points) == 8
    assert body.points.tributary.sum() == pytest.approx(1 - 1 / 4 / 6, rel=1e-13)


def test_contact_beside_an_edge_that_is_held_along_itself_has_its_end_node():
    assert len(partly_held({"displacement": {"x": 0}}).points) == 9


def test_weights_integrate_pressure():
    """Σ w = Σ J = length; tributary shares (1, 4, 2, 4, 1)/6 and the consistent matrix of two unit elements."""
    points = body_of(block({"left": {"displacement": {"x": 0}}, "top": {"pressure": 1}}, along=2)).points
    assert points.tributary == pytest.approx(np.array([1, 4, 2, 4, 1]) / 6, rel=1e-14)
    assert points.consistent.sum() == pytest.approx(2, rel=1e-14)
    element = np.array([[4, 2, -1], [2, 16, 2], [-1, 2, 4]]) / 30
    assert points.consistent[:3, :2] == pytest.approx(element[:, :2], rel=1e-13)
    assert points.element_length == pytest.approx(np.ones(5), rel=1e-14)


def test_recovered_boundary_agrees_with_the_condensed_equation():
    """n·u at the contact points is u_n in any gauge, with three, two, one and no free motions."""
    cases = [
        block({"top": {"pressure": {"constant": 5, "x": 4}}}, {"b": (["bottom"], PLANE), "w": (["left"], WALL)}),
        block({"top": {"pressure": {"constant": 5, "x": 4}}}),
        block({"top": {"pressure": {"constant": 5, "x": 4}}, "left": {"displacement": {"x": 0}}}),
        block({"top": {"pressure": 5}, "left": {"displacement": {"x": 0, "y": 0.01}}}),
    ]
    for case in cases:
        condensation = condense(body_of(case))
        solution = solve(condensation.contact).solution
        state = boundary_state(condensation, solution.pressure, solution.rigid_amplitudes)
        points = condensation.body.points
        seen = np.sum(points.normals[points.point] * state.displacement[points.element, points.local], axis=1)
        assert abs(seen - solution.displacement[points.point]).max() < 1e-12 * condensation.contact.scales.displacement


def test_contact_determines_the_position_of_a_free_body():
    """Uniform pressure 10, free to slide: v = -10 y (1-ν²)/E and u = 10 x ν(1+ν)/E, rigid amplitudes included."""
    result = solve(block({"top": {"pressure": 10}, "left": {"displacement": {"x": 0}}}))
    assert result.boundary is not None
    x, y = np.moveaxis(result.boundary.points, -1, 0)
    expected = np.stack([10 * x * 0.3 * 1.3 / 1000, -10 * y * (1 - 0.09) / 1000], axis=-1)
    assert abs(result.boundary.displacement - expected).max() < 1e-12 * abs(expected).max()


CORNER = {"base": (["bottom"], PLANE), "side": (["left"], WALL)}
SIDES = {"to the right": (1, 0), "to the left": (-1, 0), "up": (0, 1), "down": (0, -1)}


def drawn(x: float, y: float):
    """A block in a corner of two walls, with a weight of any direction in its middle."""
    return block({}, CORNER, loads={"gravity": {"density": 1.0, "acceleration": [x, y]}})


@pytest.mark.parametrize("degrees", range(0, 360, 15))
def test_what_is_missing_is_named_by_its_side(degrees):
    """The walls hold what goes down and to the left. A load twice as large on the side that is named suffices."""
    x, y = np.round([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))], 12)
    if x <= 0 and y <= 0 and (x, y) != (0, 0):
        body_of(drawn(x, y))
        return
    with pytest.raises(ProblemError) as refused:
        body_of(drawn(x, y))
    text = str(refused.value)
    assert f"the load of ({2 * x + 0:.4g}, {2 * y + 0:.4g}) pulls the body off its support" in text  # 2 is its area
    drives, added = (
        np.sum([way for side, way in SIDES.items() if side in text.split(begin)[1].split(end)[0]], axis=0)
        for begin, end in ((" drives ", " which "), ("add a load", " that "))
    )
    np.testing.assert_array_equal(added, -drives)
    assert drives @ (x, y) > 0
    body_of(drawn(*(np.array([x, y]) + 2 * added)))


@pytest.mark.parametrize(
    ("case", "words"),
    [
        (block({"top": {"pressure": -1}}), "pulls the body off its support"),
        (block({"right": {"pressure": 1}, "top": {"pressure": 1}}), "nothing holds the body against the translation"),
        (block({"top": {"traction": {"y": -1, "x": 0.1}}}), r"translation along \(1, 0\)"),
        (block({}), "no load presses it"),
        (block({"right": {"traction": {"y": -2}}, "left": {"traction": {"y": 1}}}), "rotation clockwise about"),
        (block({}, {"roof": (["top"], {"kind": "plane", "point": [0, 1], "normal": [0, -1]})},
               loads={"gravity": {"density": 1, "acceleration": [0, -1]}}), r"translation along \(0, -1\)"),
        (block({"left": {"displacement": {"x": 0, "y": 0}}, "top": {"displacement": {"x": 0.1}}}), "different displ"),
    ],
)  # fmt: skip
def test_bodies_that_contact_cannot_hold_are_refused(case, words):
    with pytest.raises(ProblemError, match=words):
        body_of(case)


def test_contact_points_that_see_no_free_motion():
    """A half model free to move down, with a side wall: p = 10 below, ν p/(1-ν) of the pressure on the wall."""
    zones = {
        "base": (["bottom"], PLANE),
        "wall": (["right"], {"kind": "plane", "point": [2, 0], "normal": [-1, 0]}),
    }
    result = solve(block({"top": {"pressure": 10}, "left": {"displacement": {"x": 0}}}, zones))
    on_wall = result.contact.zone == 1
    assert result.certified
    assert result.solution.pressure[~on_wall] == pytest.approx(np.full(13, 10.0), rel=1e-10)
    assert result.solution.pressure[on_wall] == pytest.approx(np.full(on_wall.sum(), 10 * 0.3 / 0.7), rel=1e-10)


@pytest.mark.parametrize("formulation", ["qp3", "complementarity"])
def test_as_many_points_as_free_motions(formulation):
    """One element with three points on three pieces of a polyline: equilibrium determines the pressures."""
    hollow = {"kind": "polyline", "points": [[-1, 1], [0, 0], [1, 0], [2, 1]]}
    edges = rectangle(1, 1, 1, 2)
    result = solve(problem(edges, {"seat": (["bottom"], hollow)}, conditions={"top": {"pressure": 10}}), formulation)
    assert result.footprint.resultant.force == pytest.approx([0, 10], abs=1e-9)
    assert result.residuals.force_balance < 1e-12


@pytest.mark.parametrize("elements", [(6, 6), (5, 7), (10, 14)])
def test_balanced_loads_need_no_symmetric_mesh(elements):
    """Pressure y² around the upper half of a disc is balanced, but not exactly with the weights of an uneven mesh."""
    arc = {"kind": "arc", "center": [0, 1], "radius": 1}
    edges = [
        {**arc, "name": "foot", "angles": [-110, -70], "elements": 8},
        {**arc, "name": "right", "angles": [-70, 0], "elements": 3},
        {**arc, "name": "first", "angles": [0, 90], "elements": elements[0]},
        {**arc, "name": "second", "angles": [90, 180], "elements": elements[1]},
        {**arc, "name": "left", "angles": [180, 250], "elements": 3},
    ]
    load = {"pressure": {"constant": 1, "y": -2, "yy": 1}}
    result = solve(problem(edges, {"z": (["foot"], PLANE)}, conditions={"first": load, "second": load}))
    assert result.certified
    # ∫ (y-1)² sin θ dθ over the upper half: 4/3
    assert result.footprint.resultant.force == pytest.approx([0, 4 / 3], rel=1e-4, abs=1e-9)


@pytest.mark.parametrize("center", [(0, 0), (3.3, 1.7)])
def test_rotating_ring_on_a_pin(center):
    """The centrifugal force about any axis is balanced or held by the pin; the ring turns freely."""
    out, hole = ({"kind": "arc", "center": center, "radius": r} for r in (2, 1))
    body = Problem(
        name="ring",
        material={"young_modulus": 1000, "poisson_ratio": 0.3},
        boundary={
            "outer": [{**out, "name": "rim", "angles": [0, 360], "elements": 16}],
            "holes": [[{**hole, "name": "bore", "angles": [360, 0], "elements": 16}]],
        },
        loads={"centrifugal": {"density": 1, "angular_velocity": 1, "center": center}},
        contact_zones={
            "pin": {"edges": "bore", "surface": {"kind": "circle", "center": center, "radius": 1.01, "body": "outside"}}
        },
    )
    result = solve(body)
    assert result.certified
    assert "rotation" in result.contact.notes[0]
    assert np.ptp(result.solution.pressure) < 1e-3 * result.footprint.peak.pressure


def test_two_zones_that_meet_on_one_surface():
    """A flat foot in two edges, each of them a zone: they share one point where they meet, and nothing else changes."""
    halves = [
        {"name": "a", "start": [0, 0], "end": [1, 0], "elements": 3},
        {"name": "b", "start": [1, 0], "end": [2, 0], "elements": 3},
        *rectangle(2, 1, 6, 4)[1:],
    ]
    conditions = {"top": {"pressure": {"constant": 5, "x": 4}}, "left": {"displacement": {"x": 0}}}
    one = solve(block(conditions))
    two = solve(problem(halves, {"a": (["a"], PLANE), "b": (["b"], PLANE)}, conditions=conditions))
    assert two.certified
    assert two.solution.pressure == pytest.approx(one.solution.pressure, rel=1e-9)


def bent_strip(angle: float) -> np.ndarray:
    """Free displacement of a strip of 50:1 in elements of 1e-6 of its length, clamped on the left, then turned."""
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    edges = rectangle(100.0, 2.0, 12, 2)
    for edge in edges:
        edge |= {key: (turn @ edge[key]).tolist() for key in ("start", "end")}
    plane = {"kind": "plane", "point": (turn @ [0, -1]).tolist(), "normal": turn[:, 1].tolist()}
    held, pressed = {"displacement": {"x": 0, "y": 0}}, {"pressure": 1e-4}
    strip = problem(edges, {"base": (["bottom"], plane)}, conditions={"left": held, "top": pressed})
    short = (0.9 + 1e-6 * np.arange(-4, 5)).tolist()
    strip = strip.with_element_ends({"bottom": [*np.linspace(0, 1, 12)[1:-2], *short]})
    contact = condense(body_of(strip)).contact
    return contact.free_displacement[np.abs(contact.arc_position - 90) <= 4.5e-4]


def test_short_elements_of_a_turned_body_keep_their_digits():
    """Coordinates are rounded to 1e-14, and so a direction between them to 1e-10, which is not the error of u."""
    straight = bent_strip(0.0)
    turned = bent_strip(np.radians(30))
    assert len(straight) == len(turned) == 17
    assert np.abs(straight).min() > 1
    assert np.ptp(turned - straight) < 100 * np.finfo(float).eps


def on_bed(spring, force, **more):
    """A block of 4 x 2 on springs at its bottom, under a flat plate with a force."""
    plate = {"kind": "plane", "point": [0, 2], "normal": [0, -1]}
    tools = {"plate": {"zones": "plate", "force": {"y": -force}}}
    return block({"bottom": {"spring": spring}, **more}, {"plate": (["top"], plate)}, 4.0, 2.0, tools=tools)


def test_a_block_on_springs_under_a_plate_sinks_by_springs_and_compression():
    """p/k + (1-ν²) p h/E; springs across the bottom leave it free to slide along it."""
    result = solve(on_bed({"normal": 50.0}, 40.0))
    np.testing.assert_allclose(result.solution.pressure, 10.0, rtol=1e-11)
    (plate,) = result.to_dict()["tools"]
    np.testing.assert_allclose(plate["displacement"], [0, -(10 / 50 + 0.91 * 10 * 2 / 1000)], rtol=1e-11)
    assert any("translation along (1, 0) moves no contact point" in note for note in result.notes)
    held = [solve(on_bed(spring, 40.0)) for spring in ({"y": 50.0, "x": 1e-6}, {"normal": 50.0, "tangent": 1e-6})]
    for one in held:
        np.testing.assert_allclose(one.solution.pressure, 10.0, rtol=1e-8)  # they hold the body, by hardly a force
        assert not one.notes


def test_stiff_springs_hold_as_a_fixed_edge_does():
    """The difference falls as one over the stiffness."""

    def sunk(condition):
        plate = {"kind": "circle", "center": [2, 12], "radius": 10, "body": "outside"}
        tools = {"plate": {"zones": "plate", "force": {"y": -4.0}}}
        zones = {"plate": (["top"], plate)}
        result = solve(block({"bottom": condition}, zones, 4.0, 2.0, 16, 8, tools=tools, accuracy=None))
        return result.solution.pressure.max(), result.to_dict()["tools"][0]["displacement"][1]

    fixed = np.array(sunk({"fixed": True}))
    one, other = (np.array(sunk({"spring": {"x": k, "y": k}})) - fixed for k in (1e6, 1e7))
    np.testing.assert_allclose(one / other, 10, rtol=0.01)
    assert (abs(other) < 1e-4 * abs(fixed)).all()


@pytest.mark.parametrize("stiffness", [1e-3, 1.0, 100.0, 1e6])
def test_a_ring_on_springs_has_the_pressure_of_lame(stiffness):
    """U = A r + B/r with u = δ at the pin and σ = -k u outside: order four, on any stiffness; the ring may spin."""
    G, nu, inner, outer, interference = 1000 / 2.6, 0.3, 1.0, 2.0, 0.01
    radial = 2 * G * np.array([[1 / (1 - 2 * nu), -1 / inner**2], [1 / (1 - 2 * nu), -1 / outer**2]])
    rows = [[inner, 1 / inner], radial[1] + stiffness * np.array([outer, 1 / outer])]
    pressure = -radial[0] @ np.linalg.solve(rows, [interference, 0])
    errors = []
    for n in (8, 16, 32):
        pin = {"kind": "circle", "center": [0, 0], "radius": inner + interference, "body": "outside"}
        result = solve(Problem.model_validate({
            "name": "ring", "material": {"young_modulus": 1000, "poisson_ratio": nu}, "accuracy": None,
            "boundary": {
                "outer": [{"name": "out", **CIRCLE, "radius": outer, "angles": [0, 360], "elements": n}],
                "holes": [[{"name": "bore", **CIRCLE, "radius": inner, "angles": [360, 0], "elements": n}]],
            },
            "conditions": {"out": {"spring": {"normal": stiffness}}},
            "contact_zones": {"pin": {"edges": "bore", "surface": pin}},
        }))  # fmt: skip
        assert result.certified
        assert any("rotation counterclockwise about (0, 0) moves no contact" in note for note in result.notes)
        errors.append(abs(result.solution.pressure - pressure).max() / pressure)
    assert np.log2(errors[0] / errors[-1]) / 2 > 3.8, errors
