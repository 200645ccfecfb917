"""Permanent loads, load cases and volume loads: sums, closed forms, and resultants on the exact curves."""

import numpy as np
import pytest
from bodies import arc, even, mesh_of, rectangle, solved, values_of, without_rigid_motion
from tool_problems import FREE, FREE_BY_HAND, FREE_CASES, HELD, HELD_BY_HAND, HELD_CASES, Spec, made

import bemcontact
from bemcontact.adaptivity.mesh_sizes import first_mesh
from bemcontact.bem.body import Body
from bemcontact.bem.discretization import body_of
from bemcontact.bem.loading import case_loadings, combined, particular_solution, permanent_loading, true_resultant
from bemcontact.bem.mesh import build
from bemcontact.errors import ProblemError
from bemcontact.problems.conditions import Centrifugal, Gravity, Loads, Temperature
from bemcontact.problems.material import Material
from bemcontact.problems.problem import Problem

PAIRS = [(HELD, HELD_CASES, HELD_BY_HAND), (FREE, FREE_CASES, FREE_BY_HAND)]


def acting(body: Body) -> list[np.ndarray]:
    """All that is known of what acts, as arrays."""
    loading = body.acting
    computed = [loading.values.displacement, loading.values.traction, loading.true_forces, loading.true_moments]
    part = loading.particular
    return [*computed, part.displacement, part.traction, body.forces.sum(axis=-1)]


@pytest.mark.parametrize(("spec", "cases", "by_hand"), PAIRS)
def test_combination_acts_as_the_same_loads_in_one_spec(spec: Spec, cases: Spec, by_hand: Spec):
    """The loads are linear: both are sums of products of the same numbers, to round-off."""
    body, other = body_of(made(spec, **cases, case="all")), body_of(made(spec, **by_hand))
    for computed, known in zip(acting(body), acting(other), strict=True):
        assert computed == pytest.approx(known, rel=1e-13, abs=1e-13 * max(1e-12, float(np.abs(known).max())))
    assert body.tools.position @ body.factors == pytest.approx(other.tools.position[:, 0], rel=1e-14)
    assert body.motion_load(body.seen) @ body.factors == pytest.approx(other.motion_load(other.seen)[:, 0], abs=1e-12)


def test_a_case_alone_does_not_contain_the_permanent_loads():
    """Displacements that it does not give are prescribed as 0 where the problem holds the body."""
    problem = made(HELD, **HELD_CASES)
    mesh = build(problem)
    permanent, loadings = permanent_loading(problem, mesh), case_loadings(problem, mesh)
    wind, heat, settle, spin, push = loadings
    for case in loadings:
        assert (case.values.displacement_given == permanent.values.displacement_given).all()
        assert (case.values.traction_unknown == permanent.values.traction_unknown).all()
    assert wind.true_force == pytest.approx([1, -2 - 1.5])  # edges of length 1
    assert heat.true_force == pytest.approx([0, 0])
    assert spin.true_force == pytest.approx([0.5 * 4 * 2 * 1, 0.5 * 4 * 2 * 0.5])  # density, ω², area, centroid
    held = permanent.values.displacement_given
    assert settle.values.displacement[held[:, 1], 1] == pytest.approx(np.full(7, -0.002))
    assert not settle.values.displacement[:, 0].any()
    for case in (wind, heat, spin, push):
        assert not case.values.displacement.any()
    assert not push.values.traction.any()


def test_magnitudes_do_not_cancel():
    """Loads that balance are still loads: the magnitude of a sum with factors 1 and -1 is the sum of both."""
    problem = made(HELD, **HELD_CASES)
    mesh = build(problem)
    spin = case_loadings(problem, mesh)[3]
    nothing = combined([spin, spin], [1.0, -1.0])
    assert not nothing.true_force.any()
    assert nothing.magnitude(mesh) == pytest.approx(2 * spin.magnitude(mesh))


def test_contradiction_at_a_corner_is_reported_with_the_load_case():
    """Two edges are held at 0; a load case moves one of them only."""
    conditions = {"left": {"displacement": {"x": 0, "y": 0}}, "top": {"displacement": {"x": 0, "y": 0}}}
    cases = {"settle": {"conditions": {"left": {"displacement": {"y": -0.1}}}}}
    with pytest.raises(ProblemError) as caught:
        body_of(made(HELD, conditions=conditions, load_cases=cases))
    (issue,) = caught.value.issues
    assert issue.path[:4] == ("load_cases", "settle", "conditions", "left")
    assert "prescribe different displacements along y; make them agree" in issue.message


STATES = ("plane_strain", "plane_stress")


def nothing(points):
    return 0 * points


def no_traction(points, normals):
    return 0 * points


@pytest.mark.parametrize("state", STATES)
def test_hanging_column(state):
    """Uniaxial stress ρ g y in a column held at its top by just that stress; displacement is quadratic, hence exact.

    u_y = ρ g y²/2 (1 - ν'²)/E' …, written with the plane-strain compliances (1 - ν)/(2G) and -ν/(2G).
    """
    material = Material(young_modulus=1000, poisson_ratio=0.3, state=state)
    nu, G, weight = material.effective_poisson_ratio, material.shear_modulus, 2.0

    def displacement(points):
        x, y = points[:, 0], points[:, 1]
        along, across = weight * (1 - nu) / (2 * G), -weight * nu / (2 * G)
        return np.column_stack([across * x * y, (along * y**2 - across * x**2) / 2])

    def traction(points, normals):
        return np.stack([0 * points[..., 1], weight * points[..., 1] * normals[..., 1]], axis=-1)

    mesh = mesh_of(rectangle(1, 3, even(2), even(4)))
    loads = Loads(gravity=Gravity(density=2, acceleration=(0, -1)))
    u, _, _ = solved(mesh, material, values_of(mesh, {}, displacement, traction), loads)
    difference = without_rigid_motion(mesh, u - displacement(mesh.nodes))
    assert abs(difference).max() < 1e-12 * abs(displacement(mesh.nodes)).max()


@pytest.mark.parametrize("state", STATES)
def test_rotating_disc(state):
    """Solid disc: u_r = ρω²(1-2ν)/(16G(1-ν)) r ((3-2ν) - r²) (Timoshenko and Goodier, § 32), order four."""
    material = Material(young_modulus=1000, poisson_ratio=0.3, state=state)
    nu, G = material.effective_poisson_ratio, material.shear_modulus
    errors = []
    for n in (8, 16, 32):
        mesh = mesh_of([("rim", arc((1, 2), 1, 0, 360), even(n))])
        loads = Loads(centrifugal=Centrifugal(density=3, angular_velocity=2, center=(1, 2)))
        u, _, _ = solved(mesh, material, values_of(mesh, {}, nothing, no_traction), loads)
        exact = 12 * (1 - 2 * nu) / (16 * G * (1 - nu)) * (2 - 2 * nu) * (mesh.nodes - [1, 2])
        errors.append(abs(without_rigid_motion(mesh, u - exact)).max() / abs(exact).max())
    assert np.log2(errors[0] / errors[-1]) / 2 >= 3.8, errors


@pytest.mark.parametrize("state", STATES)
def test_free_body_in_a_linear_temperature_field_has_no_stress(state):
    """A body clamped in the stress-free shape u_p has no traction, and a free body takes that shape."""
    material = Material(young_modulus=1000, poisson_ratio=0.3, state=state)
    loads = Loads(temperature=Temperature(expansion=1e-3, change={"constant": 20, "x": 3, "y": -5}))
    mesh = mesh_of(rectangle(2, 1, even(4), even(2)))
    shape = particular_solution(loads, material, mesh).displacement
    u, _, _ = solved(mesh, material, values_of(mesh, {}, nothing, no_traction), loads)
    assert abs(without_rigid_motion(mesh, u - shape)).max() < 1e-13 * abs(shape).max()
    values = values_of(mesh, {"left": "xy", "top": "x"}, lambda points: shape, no_traction)
    _, t, _ = solved(mesh, material, values, loads)
    assert abs(t).max() < 1e-11 * material.young_modulus * 1e-3 * 20


@pytest.mark.parametrize("state", STATES)
def test_hindered_expansion(state):
    """Between rollers on all sides: σ = -EαΔT/(1-2ν) in plane strain, -EαΔT/(1-ν) in plane stress."""
    material = Material(young_modulus=1000, poisson_ratio=0.3, state=state)
    loads = Loads(temperature=Temperature(expansion=1e-3, change=7))
    mesh = mesh_of(rectangle(2, 1, even(4), even(2)))
    fixed = {"left": "x", "right": "x", "top": "y", "bottom": "y"}
    _, t, _ = solved(mesh, material, values_of(mesh, fixed, nothing, no_traction), loads)
    pressure = 1000 * 7e-3 / ((1 - 0.6) if state == "plane_strain" else (1 - 0.3))
    expected = -pressure * mesh.normals
    assert abs(t - expected).max() < 1e-11 * pressure


@pytest.mark.parametrize("far", [0.0, 1e5])
def test_resultants_of_volume_loads_are_exact(far: float):
    """Rectangle 2 x 1 at (1, -3): gravity acts at its center; centrifugal force is ρω² A (center - axis).

    Moments are about the middle of the body, where its coordinates are small wherever it lies.
    """
    edges = problem_at(np.array([1 + far, -3 - far])).parts[0].edges
    center, axis = np.array([2 + far, -2.5 - far]), (0.5 + far, 1 - far)
    gravity = Loads(gravity=Gravity(density=5, acceleration=(3, -2)))
    force, moment = true_resultant(edges, gravity, center + np.array([0.5, 0]))
    round_off = 1e-14 * (1 + far)
    assert force == pytest.approx([30, -20], rel=round_off)
    assert moment == pytest.approx(-0.5 * -20, rel=10 * round_off)
    turning = Loads(centrifugal=Centrifugal(density=5, angular_velocity=2, center=axis))
    force, moment = true_resultant(edges, turning, center)
    assert force == pytest.approx(20 * 2 * np.array([2 - 0.5, -2.5 - 1]), rel=round_off)
    assert moment == pytest.approx(0, abs=100 * round_off)


def problem_at(corner: np.ndarray) -> Problem:
    """A rectangle 2 x 1 with its lower left corner at a point."""
    (x, y), ends = corner.tolist(), ([0, 0], [2, 0], [2, 1], [0, 1])
    starts = [[x + a, y + b] for a, b in ends]
    plane = {"kind": "plane", "point": [x, y], "normal": [0, 1]}
    return Problem(
        name="rectangle",
        material={"young_modulus": 1, "poisson_ratio": 0},
        boundary={"outer": [{"name": f"e{i}", "start": start, "elements": 2} for i, start in enumerate(starts)]},
        contact_zones={"base": {"edges": ["e0"], "surface": plane}},
    )


BLOCK = """
name: block
material: {young_modulus: 1000, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: bottom, start: [0, 0], end: [10, 0], elements: 10}
    - {name: right, end: [10, 4], elements: 4}
    - {name: top, end: [0, 4], elements: 10}
    - {name: left, elements: 4}
conditions: {bottom: {fixed: true}, top: %s}
contact_zones: {side: {edges: right, surface: {kind: plane, point: [10, 0], normal: [-1, 0]}}}
accuracy: null
"""
DIVIDED = BLOCK.replace(
    "    - {name: top, end: [0, 4], elements: 10}",
    "    - {name: before, end: [8, 4], elements: 2}\n    - {name: top, end: [6, 4], elements: 2}\n"
    "    - {name: after, end: [0, 4], elements: 6}",
)


@pytest.mark.parametrize(
    ("along", "divided"),
    [
        ("{pressure: {along: [[2, 5], [4, 5]]}}", "{pressure: 5}"),
        ("{force: {y: -10, width: 2, at: 3}}", "{force: {y: -10}}"),
        ("{traction: {y: {along: [[2, -10], [4, 0]]}}}", "{traction: {y: {along: [[0, -10], [2, 0]]}}}"),
        ("{traction: {x: {along: [[2, 10], [4, 0]]}}}", "{traction: {x: {constant: -30, x: 5}}}"),
    ],
)
def test_a_load_on_a_part_of_an_edge_is_that_on_an_edge_of_its_own(along, divided):
    """On the same elements all is the same."""
    one, other = (
        bemcontact.solve(bemcontact.loads(text % load)) for text, load in ((BLOCK, along), (DIVIDED, divided))
    )
    assert one.intervals
    np.testing.assert_allclose(one.pressure, other.pressure, atol=1e-9 * one.pressure.max())


@pytest.mark.parametrize("case", [False, True])
def test_the_resultant_of_loads_along_an_edge_is_exact(case):
    """Σ F and Σ x F of a trapezoid and of two forces; also of a load case."""
    load = "{pressure: {along: [[2, 0], [4, 6], [4, 1], [7, 1]]}, force: [{y: -8, width: 1, at: 9}, {y: -5}]}"
    text = BLOCK % load
    if case:
        text = text.replace(f", top: {load}", "") + f"load_cases: {{wind: {{conditions: {{top: {load}}}}}}}\n"
    problem = bemcontact.loads(text).to_be_meshed(0.1)
    body = body_of(first_mesh(problem.with_case("wind") if case else problem))
    x = 10 - np.array([2 + 4 / 3, 5.5, 9, 5])  # the edge runs to the left
    force = np.array([6, 3, 8, 5])
    np.testing.assert_allclose(body.acting.true_force, [0, -force.sum()], atol=1e-12)
    x0 = body.mesh.center[0]
    np.testing.assert_allclose(sum(body.acting.true_moments), -np.sum((x - x0) * force), rtol=1e-12)


def test_a_stated_element_across_a_jump_of_a_load_is_refused():
    text = (BLOCK % "{force: {y: -10, width: 2, at: 3}}").replace(
        "end: [0, 4], elements: 10", "end: [0, 4], elements: 4"
    )
    with pytest.raises(bemcontact.ProblemError, match=r"conditions\.top: .*distance 2 .*add 0\.2 to ends_at"):
        bemcontact.solve(bemcontact.loads(text))
    solved = bemcontact.solve(bemcontact.loads(text.replace("end: [0, 4],", "end: [0, 4], ends_at: [0.2, 0.4],")))
    assert solved.certified
