"""The main job on real problems: the paper's cylinder, invariances, agreement of the formulations."""

import json
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import bemcontact
from bemcontact.formulations import FORMULATIONS as FORMULATIONS_BY_NAME
from bemcontact.options import SolveOptions
from bemcontact.problems import Problem
from bemcontact.report.facts import facts

PEAK, HALF_WIDTH = 183.335, 2.7685
"""The cylinder by finite elements on four meshes, per undeformed length; see the description in the model."""
FORMULATIONS = ("qp1", "qp2", "qp3", "complementarity")

pytestmark = pytest.mark.usefixtures("meshes_found_once")


@pytest.fixture(scope="module")
def cylinder() -> Problem:
    return bemcontact.load("models/cylinder_on_plane.yaml", variant="stated mesh")


def half_width(result: bemcontact.Result) -> float:
    (interval,) = result.footprint.intervals
    return interval.end[0]


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_cylinder_on_a_plane(cylinder, formulation):
    """Peak to 0.1 %, half-width to 0.5 %, resultant 405 on the half to 1e-10, at most 260 degrees of freedom."""
    result = bemcontact.solve(cylinder, formulation)
    assert result.certified
    assert result.degrees_of_freedom <= 260
    assert result.footprint.peak.pressure == pytest.approx(PEAK, rel=1e-3)
    assert half_width(result) == pytest.approx(HALF_WIDTH, rel=5e-3)
    assert result.footprint.resultant.force == pytest.approx([0, 405], abs=405e-10)
    assert result.residuals.complementarity <= 1e-10
    assert result.contact.free_motions == 1


def test_three_times_finer_cylinder(cylinder):
    """Peak to 0.01 %, of which the reference itself is worth half; the slack of equilibrium falls with h² at least."""
    result = bemcontact.solve(cylinder.refined(3))
    assert result.certified
    assert 0 < result.equilibrium_slack < bemcontact.solve(cylinder).equilibrium_slack / 9
    assert result.footprint.peak.pressure == pytest.approx(PEAK, rel=1e-4)


@pytest.mark.parametrize("shift", np.arange(20) / 20)
def test_mesh_shifted_along_the_arc(cylinder, shift):
    """The ends of the short elements moved by parts of one: half-width to 0.5 %, peak to 0.1 %, wherever they fall."""
    step = 6.1 / 12 * shift
    ends = {
        "under": (-90, -73.3 + step),
        "end of contact": (-73.3 + step, -67.2 + step),
        "beyond": (-67.2 + step, -61.6),
    }
    data = cylinder.model_dump()
    for edge in data["boundary"]["outer"]:
        if edge["name"] in ends:
            edge["angles"] = ends[edge["name"]]
    result = bemcontact.solve(Problem(**data), "complementarity")
    assert half_width(result) == pytest.approx(HALF_WIDTH, rel=5e-3)
    assert result.footprint.peak.pressure == pytest.approx(PEAK, rel=1e-3)


def hertz(force: float, radius: float, young_modulus: float, poisson_ratio: float) -> tuple[float, float]:
    """Half-width and peak under a line load (Johnson, Contact Mechanics, § 4.2c)."""
    width = np.sqrt(4 * force * radius * (1 - poisson_ratio**2) / (np.pi * young_modulus))
    return width, 2 * force / (np.pi * width)


def test_hertz_at_a_hundredth_of_the_load(cylinder):
    """Half-width over radius 0.034, where Hertz holds to 0.03 %: 0.2 % on a mesh graded to the end of contact."""
    data = cylinder.model_dump()
    width, peak = hertz(8.1, 8, 1000, 0.3)
    arc = {"kind": "arc", "center": (0, 8), "radius": 8}
    degrees = np.degrees(np.arcsin(np.array([0.85, 1.1, 1.5]) * width / 8)) - 90
    data["boundary"]["outer"] = [
        {**arc, "name": "under", "angles": (-90, degrees[0]), "elements": 6, "grading": {"ratio": 2, "towards": "end"}},
        {**arc, "name": "end of contact", "angles": tuple(degrees[:2]), "elements": 10},
        {**arc, "name": "beyond", "angles": tuple(degrees[1:]), "elements": 4},
        {
            **arc,
            "name": "flank",
            "angles": (degrees[2], 0),
            "elements": 14,
            "grading": {"ratio": 60, "towards": "start"},
        },
        {"name": "top", "elements": 4},
        {"name": "axis", "start": (0, 8), "end": (0, 0), "elements": 14, "grading": {"ratio": 60, "towards": "end"}},
    ]
    data["conditions"]["top"] = {"pressure": 0.50625}
    result = bemcontact.solve(Problem(**data))
    assert result.certified
    assert half_width(result) == pytest.approx(width, rel=2e-3)
    assert result.footprint.peak.pressure == pytest.approx(peak, rel=2e-3)


SPEC = """
name: stepped part
accuracy: null
material: {{young_modulus: {E}, poisson_ratio: 0.29}}
boundary:
  outer:
    - {{name: foot, start: [0, 0], end: [{a}, {b}], elements: 7, grading: {{ratio: 3, towards: both}}}}
    - {{name: right, elements: 4}}
    - {{name: top, start: [{c}, {d}], end: [0, {d}], elements: 7}}
    - {{name: left, elements: 4}}
conditions:
  top: {{pressure: {{constant: {p}, x: {p_x}}}}}
  left: {{displacement: {{x: 0}}}}
contact_zones:
  base:
    edges: foot
    surface: {{kind: circle, center: [{e}, {f}], radius: {g}, body: outside}}
"""


def stepped_part(length: float = 1.0, stress: float = 1.0, mirror: float = 1.0) -> Problem:
    """A block with an inclined foot on a large disc, in any units; free to move up and down."""
    L, s = length, stress
    text = SPEC.format(
        E=2e3 * s, a=4 * L, b=0.1 * L, c=4 * L, d=2 * L, p=3 * s, p_x=0.5 * s / L, e=1 * L, f=-60 * L, g=60 * L
    )
    return bemcontact.loads(text) if mirror == 1 else mirrored(bemcontact.loads(text))


def mirrored(problem: Problem) -> Problem:
    """Reflect at x = 0: edges in reverse order, with ends exchanged."""
    data = problem.model_dump(exclude_none=True)

    def flip(point):
        return (-point[0], point[1])

    edges = [
        {
            **edge.model_dump(exclude_none=True, include={"name", "elements", "grading"}),
            "start": flip(joined.end),
            "end": flip(joined.start),
        }
        for edge, joined in zip(problem.boundary.outer, problem.boundary.edges, strict=True)
    ][::-1]
    data["boundary"]["outer"] = edges
    pressure = data["conditions"]["top"]["pressure"]
    pressure["x"] = -pressure["x"]
    surface = data["contact_zones"]["base"]["surface"]
    surface["center"] = flip(surface["center"])
    return Problem(**data)


def profile(result: bemcontact.Result) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(abs(result.contact.points[:, 0]))
    return result.solution.pressure[order], result.contact.points[order]


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("length", [1e-3, 1, 1e3])
@pytest.mark.parametrize("stress", [1e-6, 1, 1e6])
def test_change_of_units(formulation, length, stress):
    """Lengths by 1e-3 .. 1e3 and stresses by 1e-6 .. 1e6 scale the pressure and nothing else, to 1e-9."""
    reference = bemcontact.solve(stepped_part(), formulation)
    result = bemcontact.solve(stepped_part(length, stress), formulation)
    peak = reference.footprint.peak.pressure
    assert reference.certified
    assert result.certified
    assert abs(result.solution.pressure / stress - reference.solution.pressure).max() < 1e-9 * peak
    assert result.certificate.smallest_eigenvalue == pytest.approx(reference.certificate.smallest_eigenvalue, rel=1e-6)
    gap = result.contact.initial_gap + result.solution.displacement
    expected = reference.contact.initial_gap + reference.solution.displacement
    assert abs(gap / length - expected).max() < 1e-9 * reference.contact.scales.displacement


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(st.floats(-3, 3), st.floats(-6, 6))
def test_any_change_of_units(log_length, log_stress):
    """A change of units changes nothing, also by factors that are no powers of two or ten."""
    length, stress = 10**log_length, 10**log_stress
    reference = bemcontact.solve(stepped_part(), "complementarity")
    result = bemcontact.solve(stepped_part(length, stress), "complementarity")
    peak = reference.footprint.peak.pressure
    assert abs(result.solution.pressure / stress - reference.solution.pressure).max() < 1e-9 * peak


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_mirrored_problem(formulation):
    """The mirror image, whose loop starts elsewhere and runs the other way, has the mirrored answer to 1e-9."""
    reference = bemcontact.solve(stepped_part(), formulation)
    result = bemcontact.solve(stepped_part(mirror=-1), formulation)
    (p, x), (q, y) = profile(reference), profile(result)
    assert abs(p - q).max() < 1e-9 * reference.footprint.peak.pressure
    assert abs(x - y * [-1, 1]).max() < 1e-15
    fx, fy = reference.footprint.resultant.force
    assert result.footprint.resultant.force == pytest.approx([-fx, fy], abs=1e-9 * fy)


def test_renumbered_problem():
    """A loop that starts at another edge gives the same pressures, point by point."""
    reference = stepped_part()
    data = reference.model_dump(exclude_none=True)
    edges = data["boundary"]["outer"]
    data["boundary"]["outer"] = (*edges[2:], *edges[:2])
    a, b = bemcontact.solve(reference), bemcontact.solve(Problem(**data))
    assert abs(a.solution.pressure - b.solution.pressure).max() < 1e-9 * a.footprint.peak.pressure


@pytest.mark.parametrize("refine", [1, 2])
def test_formulations_agree(cylinder, refine):
    """QP1, QP2 and QP3 after their polish and the direct solver to 1e-9 of the peak, free rigid motions or none."""
    held = stepped_part().with_value("conditions.left.displacement.y", 0).refined(refine)
    held = held.with_value("contact_zones.base.surface.center", [1, -59.992])
    for problem in (cylinder.refined(refine), stepped_part().refined(refine), held):
        *programs, direct = (bemcontact.solve(problem, formulation) for formulation in FORMULATIONS)
        assert direct.certificate.certified
        assert direct.penetration is None
        for result in programs:
            assert result.certificate.certified
            difference = abs(result.solution.pressure - direct.solution.pressure).max()
            assert difference < 1e-9 * direct.footprint.peak.pressure


@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
@pytest.mark.parametrize("modulus", [1e3, 2e6, 2e11])
def test_stiffness_of_the_material_does_not_matter(cylinder, formulation, modulus):
    """The load grown with E gives the same pattern: pressures over E to 1e-9 before any polish, in equal iterations."""
    factor = modulus / 1000
    problem = cylinder.with_value("material.young_modulus", modulus).with_value(
        "conditions.top.pressure", 50.625 * factor
    )
    condensed = bemcontact.condense(problem)
    solution = FORMULATIONS_BY_NAME[formulation](condensed, SolveOptions.of(formulation, polish=False))
    reference = bemcontact.solve(cylinder, "complementarity").solution.pressure
    assert abs(solution.pressure / factor - reference).max() < 1e-9 * reference.max()


def test_no_contact_is_an_answer():
    """A clamped block that the load bends away from the plane: p = 0, certified."""
    problem = stepped_part().with_value("conditions.left.displacement.y", 0)
    problem = problem.with_value("conditions.top.pressure", -0.01).with_value(
        "contact_zones.base.surface.center", [1, -61]
    )
    result = bemcontact.solve(problem)
    assert result.certified
    assert result.footprint.peak is None
    assert result.footprint.intervals == ()


STIFF = 1e9
"""Young's modulus over the pressure of the load: a stiff body is rigid up to some 1e-9 of its length."""


def rocking(step: float, at: tuple[float, float], length: float, stress: float, mirror: float) -> Problem:
    """A free, stiff block of 2 x 1 whose right foot stands lower by a step; it is pressed on its head."""
    names = ("left foot", "belly", "right foot", "right", "head", "left")
    places = [(0, 0), (0.5, 0), (1.5, 0), (2, 0), (2, 1), (0, 1)]
    edges = [
        {"name": name, "elements": 2, "start": start, "end": end}
        for name, start, end in zip(names, places, [*places[1:], places[0]], strict=True)
    ]
    for edge in edges:
        for key in ("start", "end"):
            edge[key] = [length * (at[0] + mirror * edge[key][0]), length * (at[1] + edge[key][1])]
        if mirror < 0:
            edge["start"], edge["end"] = edge["end"], edge["start"]
    feet = {
        name: {"edges": name, "surface": {"kind": "plane", "point": [0, length * (at[1] - drop)], "normal": [0, 1]}}
        for name, drop in (("left foot", 0.0), ("right foot", step))
    }
    return Problem(
        name="rocking", accuracy=None, material={"young_modulus": STIFF * stress, "poisson_ratio": 0.3},
        boundary={"outer": edges if mirror > 0 else edges[::-1]}, contact_zones=feet,
        load_cases={"press": {"conditions": {"head": {"pressure": stress}}}}, case="press",
    )  # fmt: skip


@pytest.mark.slow
@settings(max_examples=15)
@given(
    st.floats(1e-6, 1e-2), st.tuples(st.floats(-5, 5), st.floats(-5, 5)), st.floats(-6, 6), st.floats(-6, 6),
    st.sampled_from([1.0, -1.0]), st.floats(0.1, 10),
)  # fmt: skip
def test_a_stiff_block_rocks_by_the_difference_of_height_over_the_distance(
    step, at, log_length, log_stress, mirror, factor
):
    """It stands on the inner end of the left foot, x = 0.5, and on the outer end of the right one, x = 2."""
    result = bemcontact.solve(rocking(step, at, 10**log_length, 10**log_stress, mirror))
    assert result.certified
    turned = result.contact.rotations(result.solution.rigid_amplitudes)
    assert not any("clockwise" in name.split() for name in result.contact.motion_names)
    round_off = 1e3 / STIFF
    assert turned.sum() == pytest.approx(-mirror * step / 1.5, abs=round_off)
    assert not np.signbit(turned[turned == 0]).any()
    words = dict(facts(result.to_dict(), result.problem.units))["Rotation"]
    assert words.startswith("clockwise" if turned.sum() < 0 else "counterclockwise")
    assert "-" not in words.rpartition(":")[2].replace("e-", "")
    assert result.to_dict()["rotations"] == pytest.approx(turned, rel=1e-12)
    loaded = FORMULATIONS_BY_NAME["complementarity"](
        result.contact.with_factors({"press": factor}), SolveOptions.of("complementarity")
    )
    assert result.contact.rotations(loaded.rigid_amplitudes) == pytest.approx(turned, abs=round_off * factor)


def test_saved_problem_gives_the_same(cylinder, tmp_path):
    """Condense, save, load, solve: the same pressure to the last digit, without a boundary."""
    condensed = bemcontact.condense(cylinder)
    condensed.save(tmp_path / "cylinder.npz")
    result = bemcontact.solve(bemcontact.CondensedContact.load(tmp_path / "cylinder.npz"))
    assert (result.solution.pressure == bemcontact.solve(condensed).solution.pressure).all()
    assert result.boundary is None
    assert result.to_dict()["boundary"] is None
    assert result.certified
    assert result.holds is None  # nothing is known of its mesh


def test_holds_says_no_more_than_was_assessed(cylinder):
    """With an accuracy: whether it is met. With none, or condensed: not assessed, which is neither."""
    for accuracy, holds in ((0.5, True), (1e-9, False), (None, None)):
        result = bemcontact.solve(cylinder.with_value("mesh.adapt", False), accuracy=accuracy)
        assert result.certified
        assert result.holds is result.accuracy.met is holds


def test_result_as_numbers(cylinder):
    """What programs read: every key that is promised, numbers finite, lists of one length."""
    data = bemcontact.solve(cylinder, "qp3").to_dict()
    promised = (
        "name formulation status certified units dof contact_nodes free_rigid_motions nodes normals zone pressure gap "
        "normal_displacement resultant intervals peak objective residuals certificate boundary seconds version"
    )
    assert set(promised.split()) <= set(data)
    assert {"penetration", "tension", "complementarity", "equilibrium", "force_balance"} <= set(data["residuals"])
    assert {"kind", "smallest_eigenvalue", "error_bound"} <= set(data["certificate"])
    assert {"points", "displacement", "traction"} <= set(data["boundary"])
    n = data["contact_nodes"]
    assert {len(data[key]) for key in ("nodes", "normals", "zone", "pressure", "gap", "normal_displacement")} == {n}
    w, p = np.array(data["tributary_lengths"]), np.array(data["pressure"])
    assert (w * p) @ np.array(data["normals"]) == pytest.approx(data["resultant"], abs=1e-12 * 405)
    assert data["objective"] == pytest.approx(0, abs=1e-12 * 405 * data["scales"]["displacement"])
    history = data["history"]
    assert [(trace["quantity"], trace["first"]) for trace in history] == [("objective", 0), ("infeasibility", 0)]
    assert {len(trace["values"]) for trace in history} == {data["iterations"] + 1}
    assert json.loads(json.dumps(history, allow_nan=False)) == history


@pytest.mark.parametrize(("formulation", "weights"), [("qp4", "tributary"), ("qp3", "nodal")])
def test_unknown_names_are_refused(cylinder, formulation, weights):
    with pytest.raises(bemcontact.ProblemError, match="take one of"):
        bemcontact.solve(cylinder, formulation, weights)


def test_notes_say_what_the_certificate_does_not(cylinder):
    """A hundredth of the load touches with two points of this mesh; a hundredfold one fills the zone.

    The load of the paper makes a peak of 0.18 times Young's modulus.
    """
    (strains,) = bemcontact.solve(cylinder).notes
    assert "0.18 times Young's modulus" in strains
    assert "linear theory is off" in strains
    (note,) = bemcontact.solve(cylinder.with_value("conditions.top.pressure", 0.5)).notes
    assert "too coarse" in note
    overloaded = bemcontact.solve(cylinder.with_value("conditions.top.pressure", 5000))
    assert any("end of the zone 'foot'" in note for note in overloaded.notes)
    assert overloaded.penetration is not None
    assert "times Young's modulus" in overloaded.penetration.words


def test_results_are_reported_in_a_line(cylinder):
    result = bemcontact.solve(cylinder)
    peak = f"{result.footprint.peak.pressure:.6g}"
    verdicts = "unique solution proved, error not estimated"
    told = f"<Result of 'cylinder on a plane, stated mesh' by complementarity: {verdicts}, peak pressure {peak} kN/cm²>"
    assert repr(result) == told
    condensed = "<CondensedContact 'cylinder on a plane, stated mesh': 45 points in foot; 1 free motions>"
    assert repr(result.contact) == condensed


@pytest.mark.parametrize("task", [bemcontact.solve, bemcontact.condense])
def test_a_file_name_is_no_problem(task):
    with pytest.raises(bemcontact.ProblemError, match=r"found 'models/.*'; bemcontact\.load"):
        task("models/cylinder_on_plane.yaml")


WHEEL = """
name: wheel in a groove
material: {young_modulus: 30e6, poisson_ratio: 0.29}
boundary:
  outer:
    - {name: seat, kind: arc, center: [0, 1], radius: 1, angles: [-150, -30], elements: 60}
    - {name: rest, kind: arc, center: [0, 1], radius: 1, angles: [-30, 210], elements: 30}
loads: {gravity: {density: 2e4, acceleration: [0.1, -1]}}
contact_zones:
  groove:
    edges: seat
    surface: {kind: polyline, points: [[-2, 0.5858], [0, -0.4142], [2, 0.5858]]}
"""


@pytest.mark.slow
@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
def test_wide_gaps_do_not_reduce_the_accuracy_of_pressure(formulation):
    """The wheel laid far into a groove, three free motions, gaps of thousands of scales: the direct solver's answer."""
    problem = bemcontact.loads(WHEEL)
    result, direct = (bemcontact.solve(problem, name) for name in (formulation, "complementarity"))
    assert result.certified
    peak = direct.footprint.peak.pressure
    assert abs(result.solution.pressure - direct.solution.pressure).max() < 1e-9 * peak


@pytest.mark.slow
def test_polish_makes_pressure_off_contact_exactly_zero():
    """A wheel laid far into a groove, three free motions: p is exactly zero off two contacts, and no note is wrong."""
    result, direct = bemcontact.solve(bemcontact.loads(WHEEL), "qp3"), bemcontact.solve(bemcontact.loads(WHEEL))
    assert result.certified
    assert result.solution.polished
    assert len(result.footprint.intervals) == 2
    assert ((result.solution.pressure > 0) == (direct.solution.pressure > 0)).all()
    assert all(note.startswith("pressure acts on only 4 contact points") for note in result.notes)  # of either contact
    # the weight 2e4 π and a tenth of it sideways, on the mesh's own area: 90 parabolas, error below 1e-5
    assert result.footprint.resultant.force == pytest.approx([-2e3 * np.pi, 2e4 * np.pi], rel=1e-5)


@pytest.mark.slow
def test_the_default_imports_no_optimization_package():
    """Each answer but QP3 and models, on a mesh that is found too: cvxpy takes half a second, and nothing needs it."""
    code = """
import sys
import bemcontact
problem = bemcontact.load("models/gallery/three_zones.yaml", variant="stated mesh")
assert bemcontact.solve(problem).certified
bemcontact.sensitivities(problem)
cases = bemcontact.load("models/gallery/roller_in_v_block.yaml", variant="stated mesh")
assert bemcontact.solve_cases(cases).certified
assert bemcontact.solve(bemcontact.load("models/cylinder_on_plane.yaml")).certified
print([name for name in ("cvxpy", "clarabel", "osqp", "scs", "highspy", "quadprog") if name in sys.modules])
"""
    answer = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert answer.stdout == "[]\n"


@pytest.mark.parametrize(("formulation", "solver"), [(None, "primal-dual active set"), ("qp3", "Clarabel")])
def test_the_direct_solver_is_the_default(cylinder, formulation, solver):
    result = bemcontact.solve(cylinder) if formulation is None else bemcontact.solve(cylinder, formulation)
    assert result.solution.solver == solver
    assert result.solution.formulation == (formulation or "complementarity")


def test_an_accuracy_is_asked_for_in_place_of_that_of_the_problem(cylinder):
    """None says nothing about errors; a number finds a mesh, nowhere coarser than the one that the problem states."""
    stated = bemcontact.solve(cylinder)
    assert stated.accuracy.asked is None
    judged = bemcontact.solve(cylinder.with_value("mesh.adapt", False), accuracy="default")
    assert (judged.accuracy.asked, judged.degrees_of_freedom) == (0.01, stated.degrees_of_freedom)
    fine = bemcontact.solve(cylinder, accuracy=0.002)
    assert (fine.accuracy.asked, fine.accuracy.met) == (0.002, True)
    assert fine.degrees_of_freedom > stated.degrees_of_freedom
    assert bemcontact.condense(cylinder, accuracy=0.002).size == fine.contact.size
    with pytest.raises(bemcontact.ProblemError, match=r"a condensed problem has its body, loads and mesh"):
        bemcontact.solve(stated.contact, accuracy=0.01)
    with pytest.raises(bemcontact.ProblemError, match=r"^accuracy: "):
        bemcontact.solve(cylinder, accuracy=2.0)


LEVER = """
name: lever on a stop
material: {young_modulus: 70e3, poisson_ratio: 0.33, state: plane_stress}
boundary:
  outer: [{name: low, start: [0, 0]}, {name: right, start: [60, 0]}, {name: top, start: [60, 12]},
          {name: left, start: [0, 12]}]
conditions: {left: {displacement: {x: 0, y: 0}}, top: {pressure: 0.8}}
contact_zones:
  stop: {edges: low, surface: {kind: circle, center: [50, -8.05], radius: 8, body: outside}}
"""


@pytest.mark.slow
def test_qp3_finds_a_contact_that_is_small_beside_its_zone():
    """Lengths from 60 to 0.001 in one program: no scaling may make what is left of the objectives look small."""
    result = bemcontact.solve(bemcontact.loads(LEVER), "qp3")
    assert result.certified
    assert result.footprint.peak is not None
    force = result.footprint.resultant.force[1]
    assert result.footprint.peak.pressure == pytest.approx(np.sqrt(force * 70e3 / (np.pi * 8)), rel=0.01)  # Hertz


def test_what_the_search_for_a_mesh_solved_is_the_solution_on_it():
    """It is solved no second time; solved anew on the same mesh, it is the same, from another start."""
    problem = bemcontact.load("models/cylinder_on_plane.yaml")
    found = bemcontact.solve(problem)
    assert found.problem is not None
    anew = bemcontact.solve(found.problem, accuracy=None)
    assert anew.contact.points == pytest.approx(found.contact.points, abs=1e-12)
    assert anew.solution.pressure == pytest.approx(found.solution.pressure, rel=1e-9)
    assert anew.solution.iterations > found.solution.iterations
    assert found.certified
    assert anew.certified
