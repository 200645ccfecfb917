"""Stress in bodies with volume loads against closed forms, and where points are."""

import numpy as np
import pytest

from bemcontact.bem.loading import permanent_loading
from bemcontact.bem.mesh import build
from bemcontact.bem.outline import Outline
from bemcontact.bem.rigid_motions import free_rigid_motions
from bemcontact.bem.solution import solve_system
from bemcontact.bem.stress_field import StressField, smooth_starts
from bemcontact.bem.system import System
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.problems.conditions import Condition
from bemcontact.problems.problem import Problem

STATES = ["plane_strain", "plane_stress"]
FAR = {"kind": "plane", "point": [0, -99], "normal": [0, 1]}


def problem(loops: dict, state: str = "plane_strain", conditions: dict | None = None, **more) -> Problem:
    """A body that touches nothing: the surface is far away, and edges have conditions in spite of it."""
    made = Problem(
        name="body", material={"young_modulus": 10, "poisson_ratio": 0.3, "state": state}, boundary=loops,
        contact_zones={"foot": {"edges": [loops["outer"][0]["name"]], "surface": FAR}}, **more,
    )  # fmt: skip
    return made.model_copy(
        update={"conditions": {edge: Condition(**item) for edge, item in (conditions or {}).items()}}
    )


def field_of(body: Problem) -> StressField:
    """The solution without contact."""
    mesh = build(body)
    loading = permanent_loading(body, mesh)
    motions = free_rigid_motions(mesh, loading.values)
    system = System(mesh=mesh, material=body.material, points=UnitPressures.none(), motions=motions, loadings=[loading])
    u, t = system.fields(solve_system(system).combined(np.ones(1)), loading)
    outline = Outline(problem=body, mesh=mesh)
    states = u[..., None], t[..., None], [body.loads], np.ones((1, 1))
    return StressField.of(outline, body.material, *states, smooth_starts(outline))


def column() -> dict:
    """A rectangle 2 x 1."""
    ends = {"bottom": [0, 0], "right": [2, 0], "top": [2, 1], "left": [0, 1]}
    return {"outer": [{"name": name, "start": start, "elements": 4} for name, start in ends.items()]}


POINTS = np.array([[1, 0.5], [0.3, 0.9], [2 - 1e-9, 0.4], [1.3, 1e-6], [1.3, 0], [0.7, 1], [0.25, 0], [0, 0], [2, 1]])
"""Inside, nearly on the boundary, on it, at an end of an element, and at corners."""


@pytest.mark.parametrize("state", STATES)
def test_weight(state: str):
    """A block between frictionless walls: σyy = ρg (y - 1), σxx = ν'/(1-ν') σyy, ν' that of plane strain."""
    weight, walls = {"gravity": {"density": 2, "acceleration": [0, -3]}}, {"bottom": "y", "left": "x", "right": "x"}
    held = {edge: {"displacement": {axis: 0}} for edge, axis in walls.items()}
    body = problem(column(), state, held, loads=weight)
    field = field_of(body)
    stress = field.stress(field.locate(POINTS))
    yy, strained = 6 * (POINTS[:, 1] - 1), state == "plane_strain"
    xx = yy * (0.3 / 0.7 if strained else 0.3)
    assert abs(stress[..., 0] - np.array([xx, yy, 0 * yy])).max() < 1e-10
    zz = 0.3 * (xx + yy) if strained else 0 * yy
    assert abs(field.out_of_plane(stress, POINTS)[:, 0] - zz).max() < 1e-10


@pytest.mark.parametrize("state", STATES)
def test_linear_temperature(state: str):
    """Free of stress in the plane; σzz = -E α T in plane strain. Displacement is u_p of `loading` but for a motion."""
    heat = {"expansion": 1e-3, "change": {"constant": 5, "x": 2, "y": -1}}
    body = problem(column(), state, loads={"temperature": heat})
    field = field_of(body)
    at = field.locate(POINTS)
    stress = field.stress(at)
    assert abs(stress).max() < 1e-12
    change = 5 + 2 * POINTS[:, 0] - POINTS[:, 1]
    zz = -10 * 1e-3 * change if state == "plane_strain" else 0 * change
    assert abs(field.out_of_plane(stress, POINTS)[:, 0] - zz).max() < 1e-12
    z = (POINTS[:, 0] - 1) + 1j * (POINTS[:, 1] - 0.5)
    w = 1e-3 * (1.3 if state == "plane_strain" else 1) * (6.5 * z + (2 + 1j) * z * z / 2)
    u = field.displacement(at)[..., 0]
    difference = u[:, 0] + 1j * u[:, 1] - w
    shift, turn = difference[0], (difference[1] - difference[0]) / (z[1] - z[0])
    assert abs(difference - shift - turn * (z - z[0])).max() < 1e-13
    assert abs(turn.real) < 1e-13


@pytest.mark.parametrize("state", STATES)
def test_heated_block_between_rollers(state: str):
    """σxx = σyy = -EαΔT/(1-2ν) in plane strain, and so is σzz; -EαΔT/(1-ν) in plane stress."""
    rollers = {"left": "x", "right": "x", "bottom": "y", "top": "y"}
    body = problem(
        column(), state, loads={"temperature": {"expansion": 1e-3, "change": 7}},
        conditions={edge: {"displacement": {axis: 0}} for edge, axis in rollers.items()},
    )  # fmt: skip
    field = field_of(body)
    stress = field.stress(field.locate(POINTS))
    p = 10 * 7e-3 / (0.4 if state == "plane_strain" else 0.7)
    assert abs(stress[..., 0] - np.array([-p, -p, 0])[:, None]).max() < 1e-11
    assert abs(field.out_of_plane(stress, POINTS) - (-p if state == "plane_strain" else 0)).max() < 1e-11


def circle(name: str, radius: float, angles: list, elements: int, center: tuple = (0, 0)) -> dict:
    return {"name": name, "kind": "arc", "center": center, "radius": radius, "angles": angles, "elements": elements}


@pytest.mark.parametrize("state", STATES)
def test_rotating_ring(state: str):
    """Radial and hoop stress of a rotating ring (Timoshenko and Goodier, art. 32), from edge to edge, with 48 elements.

    σr = (3+ν)/8 ρω² (a² + b² - a²b²/r² - r²), σθ = (3+ν)/8 ρω² (a² + b² + a²b²/r² - (1+3ν)/(3+ν) r²); in plane strain
    with ν/(1-ν) in place of ν.
    """
    loops = {"outer": [circle("out", 2, [0, 360], 48)], "holes": [[circle("in", 1, [360, 0], 48)]]}
    body = problem(loops, state, loads={"centrifugal": {"density": 0.5, "angular_velocity": 2, "center": [0, 0]}})
    field = field_of(body)
    angle = np.linspace(0.01, 0.2, 5)
    r = np.repeat([1, 1 + 1e-6, 1 + 1e-3, 1.1, 1.5, 1.9, 2 - 1e-6, 2], len(angle))
    angle = np.tile(angle, 8)
    points = np.column_stack([r * np.cos(angle), r * np.sin(angle)])
    xx, yy, xy = field.stress(field.locate(points))[..., 0]
    c, s = np.cos(angle), np.sin(angle)
    nu = 0.3 if state == "plane_stress" else 0.3 / 0.7
    k = (3 + nu) / 8 * 0.5 * 4
    radial, hoop = k * (5 - 4 / r**2 - r**2), k * (5 + 4 / r**2 - (1 + 3 * nu) / (3 + nu) * r**2)
    largest = hoop.max()
    assert abs(xx * c * c + yy * s * s + 2 * xy * c * s - radial).max() < 2e-4 * largest
    assert abs(xx * s * s + yy * c * c - 2 * xy * c * s - hoop).max() < 2e-4 * largest


def test_where_points_are():
    """On the curves themselves, at corners, on either side, and far away."""
    flat = {"name": "flat", "start": [-1, 0], "elements": 4}
    hole = circle("hole", 0.2, [360, 0], 6, (0, 0.5))
    body = problem({"outer": [flat, circle("arc", 1, [0, 180], 6)], "holes": [[hole]]})
    mesh = build(body)
    u, t = np.zeros((len(mesh.nodes), 2, 1)), np.zeros((len(mesh.elements), 3, 2, 1))
    outline = Outline(problem=body, mesh=mesh)
    field = StressField.of(outline, body.material, u, t, [], np.zeros((1, 0)), smooth_starts(outline))
    angle = np.linspace(0.05, 3.1, 40)
    rim = np.column_stack([np.cos(angle), np.sin(angle)])
    for on in (rim, [0, 0.5] + 0.2 * rim, np.column_stack([np.linspace(-0.99, 0.99, 17), np.zeros(17)])):
        at = field.locate(on)
        assert not at.inside.any()
        assert not at.outside.any()
    for away in (1e-6, 1e-2, 0.5):
        assert field.locate(rim * (1 + away)).outside.all()
        assert field.locate([0, 0.5] + 0.2 * rim * (1 - away)).outside.all()
    assert field.locate(rim * 50).outside.all()
    for inward in (1e-2, 1e-3):
        assert field.locate(rim * (1 - inward)).inside.all()
        assert field.locate([0, 0.5] + 0.2 * rim * (1 + inward)).inside.all()
    corners = field.locate(np.array([[-1.0, 0], [1, 0]]))
    assert not corners.inside.any()
    assert (corners.node >= 0).all()
    starts = mesh.nodes[np.flatnonzero(~smooth_starts(Outline(problem=body, mesh=mesh)))]
    assert sorted(map(tuple, starts.round(12).tolist())) == [(-1.0, 0.0), (1.0, 0.0)]


def test_edges_under_the_same_conditions_go_on():
    """Two halves of a circle go on in each other, but where a contact zone ends."""
    halves = [circle("lower", 1, [180, 360], 4), circle("upper", 1, [0, 180], 4)]
    zone = {"foot": {"edges": ["lower", "upper"], "surface": FAR}}
    whole = problem({"outer": halves})
    mesh = build(whole)
    assert smooth_starts(Outline(problem=whole, mesh=mesh)).sum() == len(mesh.elements) - 2
    both = Problem(name="disc", material=whole.material, boundary=whole.boundary, contact_zones=zone)
    assert smooth_starts(Outline(problem=both, mesh=mesh)).all()
