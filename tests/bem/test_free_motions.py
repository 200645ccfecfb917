"""Motions of body and tools that no condition prevents: those that contact sees, and their names."""

import tracemalloc

import numpy as np
import pytest
from tool_problems import FREE, HELD, ROLLER, WEDGE, Spec, made

from bemcontact.bem import free_motions
from bemcontact.bem.body import Body
from bemcontact.bem.discretization import body_of
from bemcontact.bem.free_motions import FreeMotions

WIDE = {"table": FREE["contact_zones"]["table"], "press": {
    "edges": ["head", "top"], "surface": FREE["contact_zones"]["punch"]["surface"]}}  # fmt: skip
PRESS = {"zones": "press", "point": [1, 1], "force": {"y": -10, "moment": 0}}
TABLE = {"zones": "table", "point": [1, 0], "force": {"y": 10, "moment": 0}}


def between(**tools) -> Body:
    return body_of(made(FREE, loads={}, contact_zones=WIDE, tools=tools))


def roller(**tools) -> Body:
    return body_of(made(ROLLER, tools=tools))


UP, TURN, SIDE = "translation along (0, 1)", "rotation counterclockwise about", "translation along (1, 0)"


@pytest.mark.parametrize(
    ("body", "seen", "unseen"),
    [
        (body_of(made(HELD)), (f"{UP} of the tool 'punch'", f"{TURN} (1.5, 1) of the tool 'punch'"), ()),
        (
            between(press=PRESS),
            (UP, f"{TURN} (1, 0.5)", f"{UP} of the tool 'press'", f"{TURN} (1, 1) of the tool 'press'"),
            (SIDE,),
        ),
        (
            between(press={"zones": "press", "force": {"x": 0, "y": -10}}),
            (UP, f"{TURN} (1, 0.5)", f"{UP} of the tool 'press'"),
            (SIDE, f"{SIDE} of the tool 'press'"),
        ),
        (
            between(press=PRESS, table=TABLE),
            (
                f"{UP} of the tool 'press'",
                f"{TURN} (1, 1) of the tool 'press'",
                f"{UP} of the tool 'table'",
                f"{TURN} (1, 0) of the tool 'table'",
            ),
            (
                SIDE,
                f"{UP} of the body, the tool 'press' and the tool 'table' together",
                f"{TURN} (1, 0.5) of the body, together with the {TURN} (1, 1) of the tool 'press', together with the "
                f"{TURN} (1, 0) of the tool 'table'",
            ),
        ),
        (
            roller(block={"zones": ["left flank", "right flank"], "force": {"x": 0, "y": 20}}),
            (UP, f"{TURN} (0, 0)", f"{SIDE} of the tool 'block'", f"{UP} of the tool 'block'"),
            (f"{SIDE} of the body and the tool 'block' together",),
        ),
    ],
)
def test_seen_and_unseen_motions_by_hand(body: Body, seen: tuple[str, ...], unseen: tuple[str, ...]):
    """A motion along a plane changes no gap, and neither does a common motion of all that touches."""
    assert body.seen.describe()[-2:] == seen[-2:]
    assert sorted(body.seen.describe()) == sorted(seen)
    assert body.unseen.describe() == unseen


BODIES = {
    "held": body_of(made(HELD)),
    "free": body_of(made(FREE)),
    "groove": body_of(made(WEDGE)),
    "press and table": between(press=PRESS, table=TABLE),
    "block": roller(block={"zones": ["left flank", "right flank"], "force": {"x": 0, "y": 20}}),
    "far point": between(press={"zones": "press", "point": [1e6, 1], "force": {"y": -10, "moment": 10 * (1e6 - 1)}}),
}


@pytest.mark.parametrize("name", BODIES)
def test_seen_motions_are_independent_and_unseen_ones_are_not_seen(name: str):
    body = BODIES[name]
    R, none = body.seen.gap_changes, body.unseen.gap_changes
    values = np.linalg.svd(R, compute_uv=False)
    assert values[-1] > 1e-2 * values[0]  # also where a tool is stated about a point far away
    assert abs(none).max(initial=0.0) < 1e-9
    together = np.vstack([body.seen.coefficients, body.unseen.coefficients])
    free = sum(map(len, body.motions)) + int(body.tools.free.sum())
    assert np.linalg.matrix_rank(together) == len(together) == free


@pytest.mark.parametrize("name", BODIES)
def test_tools_move_only_where_they_are_free(name: str):
    body = BODIES[name]
    for motions in (body.seen, body.unseen):
        assert abs(motions.tools[~body.tools.free]).max(initial=0.0) < 1e-12


@pytest.mark.parametrize("name", BODIES)
def test_change_of_the_gaps_by_a_tool_is_its_rigid_motion(name: str):
    """-n·w with w = (x - θ (Y - Py), y + θ (X - Px)) at contact points of its zones, 0 at others."""
    body = BODIES[name]
    points, zones = body.points, list(body.problem.contact_zones)
    at = body.mesh.nodes[points.node]
    for index, (point, tool) in enumerate(zip(body.tools.point, body.problem.tools.values(), strict=True)):
        x, y = (at - point).T
        own = np.isin(points.zone, [zones.index(zone) for zone in tool.zones])
        columns = body.tools.motions[:, 3 * index : 3 * index + 3]
        n_x, n_y = points.normals.T
        expected = -np.column_stack([n_x, n_y, n_y * x - n_x * y])
        assert columns == pytest.approx(np.where(own[:, None], expected, 0.0), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("name", BODIES)
def test_work_of_forces_is_force_times_displacement_of_the_point(name: str):
    body = BODIES[name]
    on_tools = body.motion_load(body.seen)[:, 0] - body.loadings[0].true_work(body.mesh, body.seen)
    moved = body.seen.tools
    by_hand = sum(np.array(tool.load) @ moved[3 * i : 3 * i + 3] for i, tool in enumerate(body.problem.tools.values()))
    assert on_tools == pytest.approx(by_hand, rel=1e-12, abs=1e-8)  # round-off of a moment of 1e7


def test_work_is_a_force_or_a_moment_in_user_units():
    """Work is a force in a translation, and a moment in a rotation, for any normalization of the motion."""
    motions = FreeMotions(
        coefficients=np.array([[0, 3.0, 0, 0, 3, 0], [0, 0, 0.2, 0, 0, 0.2], [0, 0, 0, 0.6, 0.8, 0]]),
        names=("a",),
        centers=np.array([[0.0, 0], [0, 0]]),
        to_points=np.diag([1, 1, 1 / 5]),
        radius=5.0,
    ).in_user_units()
    force, moment = np.array([7.0, 2.0]), 4.0
    assert motions.of_body(0).work_of(force, moment) == pytest.approx([2, 4, 0])
    assert pytest.approx([2, 4, 0.6 * 7 + 0.8 * 2]) == motions.tools.T @ [7.0, 2.0, 4.0]
    assert [motions.turns(j) for j in range(3)] == [False, True, False]
    assert [motions.who(j) for j in range(3)] == ["the body and the tool 'a' together"] * 2 + ["the tool 'a'"]


@pytest.mark.parametrize("name", BODIES)
def test_arms_turn_amplitudes_into_angles(name: str):
    """Two points r apart move by θ ẑ x r relative to each other, and tools turn by θ; the name has the sense."""
    seen = BODIES[name].seen
    ends = np.array([[0.3, -1.0], [2.3, 3.0]])
    (x, y), (dx, dy) = ends[1] - ends[0], np.diff(seen.of_body(0).displacement(ends), axis=0)[0]
    of_body = (x * dy - y * dx) / (x**2 + y**2)
    for motion, described in enumerate(seen.describe()):
        angles = [of_body[motion], *seen.tools[2::3, motion]]
        sense = 1 if " counterclockwise" in described else -1 if " clockwise" in described else 0
        assert sum(angles) == pytest.approx(sense / seen.arms[motion], rel=1e-12, abs=1e-12)


def hinged(stated: Spec = HELD) -> Body:
    """A punch that turns about a hinge at x = 1.8 and moves up and down with it, but not sideways."""
    punch = {**stated["tools"]["punch"], "point": [1.8, 3], "force": {"moment": 0}}
    return body_of(made(stated, tools={"punch": punch}, loads={}))


def test_hinged_tool_turns_about_its_hinge_only():
    body = hinged()
    assert body.seen.describe() == (f"{TURN} (1.8, 3) of the tool 'punch'",)
    assert body.seen.tools[:2] == pytest.approx(np.zeros((2, 1)))


def test_free_motions_of_many_points_need_no_square_matrix():
    """A square matrix of these points has 72 MB."""
    seen = np.random.default_rng(0).standard_normal((3000, 3))
    tracemalloc.start()
    moving, still = free_motions._split(seen, np.eye(3))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert (moving.shape, still.shape) == ((3, 3), (0, 3))
    assert peak < 1 << 20


def of_three(coefficients: list[float], halves: tuple[float, ...] = (1.0, 2.0, 1.0)) -> FreeMotions:
    """A motion of three bodies about their centers (0, 0), (10, 0) and (20, 0)."""
    return FreeMotions(
        coefficients=np.array([coefficients]),
        names=(),
        centers=np.array([[0.0, 0], [10, 0], [20, 0]]),
        to_points=np.zeros((0, 0)),
        radius=2.0,
        bodies=("the body 'a'", "the body 'b'", "the body 'c'"),
        halves=halves,
    )


@pytest.mark.parametrize(
    ("coefficients", "says"),
    [
        ([0, 1, 0, 0, 1, 0, 0, 0, 0], f"{UP} of the body 'a' and the body 'b' together"),
        ([0, 1, 0, 0, 1, 0, 1, 0, 0],
         f"{UP} of the body 'a' and the body 'b' together, together with the {SIDE} of the body 'c'"),
        ([0, 0, 1, 0, 0, 0, 1, 0, 0], f"{TURN} (0, 0) of the body 'a', together with the {SIDE} of the body 'c'"),
        # a pole at a distance of 5 from the center is far from a body of the size 2, and not from one of the size 4
        ([0, 2.5, 1, 0, 0, 0, 0, 0, 0], f"{UP} with a small counterclockwise turn of the body 'a'"),
        ([0, 0, 0, 0, 2.5, 1, 0, 0, 0], f"{TURN} (5, 0) of the body 'b'"),
    ],
)  # fmt: skip
def test_parts_that_do_not_move_alike_are_described_each(coefficients, says):
    assert of_three(coefficients).describe() == (says,)


def test_a_joint_motion_of_many_bodies_is_not_described_body_by_body():
    motion = of_three([0, 0, 1, 0, 0, 1, 0, 0, -1])
    assert motion.describe()[0].count("together with the") == 2
    many = FreeMotions(
        coefficients=np.tile([0.0, 0, 1], 4)[None], names=(), centers=np.arange(8.0).reshape(4, 2),
        to_points=np.zeros((0, 0)), radius=1.0, bodies=tuple(f"the body '{i}'" for i in range(4)),
    )  # fmt: skip
    (text,) = many.describe()
    assert text.startswith("joint motion of the body '0', the body '1', the body '2' and the body '3' together: that")
    assert text.endswith(f"with the {TURN} (0, 1) of the body '0'")
