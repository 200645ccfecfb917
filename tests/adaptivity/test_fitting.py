"""Meshes fitted to the ends of contact: their accuracy, the elements that stay, and the notes."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from contact_meshes import block, cantilever, cylinder, mirrored, ring, table
from contact_problems import random_contact
from messages import assert_states
from typer.testing import CliRunner

import bemcontact
from bemcontact import cli
from bemcontact.adaptivity import fitting
from bemcontact.adaptivity.fitting import SETTLED, MeshFit, fitted
from bemcontact.analysis import compare as comparing
from bemcontact.assessment.footprint import footprint
from bemcontact.contact.solution import Status
from bemcontact.errors import ProblemError
from bemcontact.formulations import complementarity
from bemcontact.options import ComparisonOptions
from bemcontact.problem import Problem

MODELS = Path(__file__).parents[2] / "models"
HALF_WIDTH, PEAK = 2.7685, 183.335
"""Of the cylinder, by finite elements on four meshes; see the description of the model."""


def fit_of(problem: Problem) -> tuple[Problem, MeshFit]:
    adapted, fit = fitted(problem)
    assert fit is not None
    assert not adapted.mesh.fit_contact_edges
    return adapted, fit


def elements_of(problem: Problem) -> int:
    """Number of elements as stated, before any refinement."""
    return sum(edge.elements for edge in problem.boundary.edges)


def all_ends(problem: Problem) -> dict[str, np.ndarray]:
    return {edge.name: edge.breakpoints() for edge in problem.boundary.edges}


def assert_same_elements(one: Problem, other: Problem, tolerance: float) -> None:
    ends, others = all_ends(one), all_ends(other)
    assert ends.keys() == others.keys()
    for name in ends:
        np.testing.assert_allclose(ends[name], others[name], rtol=0, atol=tolerance, err_msg=name)


def pressure_error(coarse: bemcontact.Result, fine: bemcontact.Result) -> float:
    """Relative L2 difference of two pressures, each a parabola on every element, over arc length."""

    def pressure(result: bemcontact.Result, s: np.ndarray) -> np.ndarray:
        arc, p = result.contact.arc_position, result.solution.pressure
        i = 2 * np.clip(np.searchsorted(arc[::2], s, side="right") - 1, 0, len(arc) // 2 - 1)
        xi = 2 * (s - arc[i]) / (arc[i + 2] - arc[i]) - 1
        return p[i] * xi * (xi - 1) / 2 + p[i + 1] * (1 - xi**2) + p[i + 2] * xi * (xi + 1) / 2

    joints = np.unique(np.concatenate([result.contact.arc_position[::2] for result in (coarse, fine)]))
    xi, weights = np.polynomial.legendre.leggauss(6)
    half = np.diff(joints)[:, None] / 2
    s, w = ((joints[:-1, None] + half) + half * xi).ravel(), (half * weights).ravel()
    difference = pressure(coarse, s) - pressure(fine, s)
    return float(np.sqrt(w @ difference**2 / (w @ pressure(fine, s) ** 2)))


@pytest.fixture(scope="module")
def cylinders() -> dict[int, bemcontact.Result]:
    return {n: bemcontact.solve(cylinder(n), "complementarity") for n in (6, 12, 24, 96)}


def test_pressure_converges_with_order_two(cylinders):
    """Declared: two in L2, against the finest; uniform elements have about one and more than five times the error."""
    error = {n: pressure_error(cylinders[n], cylinders[96]) for n in (6, 12, 24)}
    assert np.log2(error[6] / error[12]) >= 2.0
    assert np.log2(error[12] / error[24]) >= 2.0
    uniform = bemcontact.solve(cylinder(12).with_value("mesh.fit_contact_edges", False), "complementarity")
    assert pressure_error(uniform, cylinders[96]) > 5 * error[12]


def test_end_of_contact_converges_with_order_three(cylinders):
    """Declared: three, against the finest, down to the 1e-5 to which a gap is read; 1e-4 of finite elements at 12."""
    finest = cylinders[96].footprint.intervals[0].end[0]
    error = {n: abs(cylinders[n].footprint.intervals[0].end[0] / finest - 1) for n in (6, 12, 24)}
    assert error[6] <= 2e-4
    assert error[12] <= error[6] / 8
    assert error[24] <= 1e-5
    assert cylinders[12].footprint.intervals[0].end[0] == pytest.approx(HALF_WIDTH, rel=1e-4)


@pytest.mark.parametrize("formulation", ["qp1", "qp2", "qp3", "complementarity"])
def test_the_shipped_cylinder_fitted(cylinders, formulation):
    """With 180 degrees of freedom: half-width to 1e-4, peak to 5e-4 of finite elements, pressure to 5e-4 in L2."""
    model = bemcontact.load("models/cylinder_on_plane.yaml").with_value("mesh.fit_contact_edges", True)
    result = bemcontact.solve(model, formulation)
    assert result.certified
    assert result.degrees_of_freedom <= 180
    assert result.footprint.intervals[0].end[0] == pytest.approx(HALF_WIDTH, rel=1e-4)
    assert result.footprint.peak.pressure == pytest.approx(PEAK, rel=5e-4)
    assert pressure_error(result, cylinders[96]) <= 5e-4


def test_passes_are_reported(cylinders):
    fit = cylinders[12].mesh_fit
    assert fit.settled
    assert 2 <= fit.kept <= 3
    first, last = fit.passes[0].intervals[0].end, fit.passes[fit.kept].intervals[0].end
    (note,) = (note for note in cylinders[12].notes if note.startswith("mesh fitted"))
    before, after = (elements_of(stated) for stated in (cylinder(12), cylinders[12].problem))
    assert_states(note, f"{fit.kept} passes; … {after} elements where {before} were stated; … foot moved from")
    assert_states(note, f"({first[0]:.6g}, {first[1]:.6g}) … ({last[0]:.6g}, {last[1]:.6g})")
    data = json.loads(cylinders[12].to_json())["mesh_fit"]
    assert data["settled"] is True
    assert [item["intervals"][0]["zone"] for item in data["passes"]] == ["foot"] * (fit.kept + 1)
    assert data["passes"][-1]["movement"] <= SETTLED


@pytest.mark.parametrize("load", [1e-2, 1e-3, 1e-4, 1e-5])
def test_hertz_on_a_zone_that_is_much_longer(load):
    """On elements of 0.17 contact is 0.27 or 0.0087 wide, with one point in contact. The mesh is fitted nevertheless.

    b/R = 0.034 at most, where Hertz holds to 0.03 %; the peak suffers a little from the mesh that was stated beside it.
    """
    result = bemcontact.solve(cylinder(24, load=load), "complementarity")
    assert result.certified
    assert result.mesh_fit is not None
    assert result.mesh_fit.settled
    half_width = np.sqrt(4 * 810 * load * 8 * (1 - 0.3**2) / (np.pi * 1000))
    assert result.footprint.intervals[0].end[0] == pytest.approx(half_width, rel=1e-3)
    assert result.footprint.peak.pressure == pytest.approx(2 * 810 * load / (np.pi * half_width), rel=5e-3)


@pytest.mark.parametrize("load", [1e-3, 1e-4])
def test_two_narrow_contacts_settle(load):
    """Half-way steps are for ends that alternate: with such steps, eight passes are too few for narrow contacts."""
    stated = table().with_value("conditions.top.pressure", {"constant": 8 * load, "x": load})
    result = bemcontact.solve(stated, "complementarity")
    assert result.certified
    assert result.mesh_fit.settled


WEDGE = """
name: wedge on its point
material: {young_modulus: 1000, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: right face, start: [0, 0], elements: 6}
    - {name: right, start: [4, 1], elements: 4}
    - {name: top, start: [4, 5], elements: 6}
    - {name: left, start: [-4, 5], elements: 4}
    - {name: left face, start: [-4, 1], elements: 6}
conditions:
  top: {pressure: 2}
  left: {displacement: {x: 0}}
  right: {displacement: {x: 0}}
contact_zones:
  point: {edges: [left face, right face], surface: {kind: plane, point: [0, 0], normal: [0, 1]}}
mesh: {fit_contact_edges: true}
"""


@pytest.mark.parametrize("load", [20.0, 5.0, 0.5, 0.02])
def test_contact_round_a_corner_is_fitted_on_both_sides(load):
    """A wedge has no length: contact grows like the load. Its peak is infinite; the mesh limits the computed one.

    So it does from three points under pressure down to one, a thousandth of it; against the fine mesh of one load.
    """
    finest = bemcontact.solve(bemcontact.loads(WEDGE).refined(4), "complementarity").footprint
    result = bemcontact.solve(bemcontact.loads(WEDGE).with_value("conditions.top.pressure", load), "complementarity")
    assert result.certified
    assert result.mesh_fit.settled
    for which in ("start", "end"):
        end, fine = (getattr(footprint.intervals[0], which)[0] for footprint in (result.footprint, finest))
        assert end / load == pytest.approx(fine / 2, rel=0.05)


TILTED = """
name: block on its lower left corner, its left side in the zone too
material: {young_modulus: 1000, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: bottom, start: [0, 0], elements: 13}
    - {name: right, start: [3.993, 0.235], elements: 2}
    - {name: top, start: [3.875, 2.232], elements: 5}
    - {name: left, start: [-0.118, 1.997], elements: 3}
conditions:
  top: {traction: {y: -0.2325}}
  right: {displacement: {x: 0}}
contact_zones:
  corner: {edges: [left, bottom], surface: {kind: plane, point: [0, 0], normal: [0, 1]}}
mesh: {fit_contact_edges: true}
"""


def test_contact_on_one_side_of_a_corner_is_fitted_to():
    """One point at first. With long elements beyond the corner, the passes would alternate between two states."""
    result = bemcontact.solve(bemcontact.loads(TILTED), "complementarity")
    finest = bemcontact.solve(bemcontact.loads(TILTED).refined(4), "complementarity")
    assert result.certified
    assert result.mesh_fit.settled
    assert result.mesh_fit.kept
    (interval,), (fine,) = result.footprint.intervals, finest.footprint.intervals
    assert interval.start == pytest.approx((0, 0), abs=1e-12)
    assert interval.end[0] == pytest.approx(fine.end[0], rel=5e-3)


@pytest.mark.parametrize("seed", range(8))
def test_fitting_improves_zones_of_any_mesh(seed):
    """Elements of any number and grading, loads down to 1e-7: within 2e-2 of Hertz, and nearer than without a fit.

    Four elements in contact, which are all that a short zone gets, give a peak to less than that.
    """
    rng = np.random.default_rng(seed)
    load, towards = 10 ** rng.uniform(-7, -2), str(rng.choice(["start", "end", "both", "middle"]))
    stated = cylinder(int(rng.integers(5, 30)), load=load)
    stated = stated.with_value("boundary.outer.foot.grading", {"ratio": rng.uniform(1, 10), "towards": towards})
    half_width = np.sqrt(4 * 810 * load * 8 * (1 - 0.3**2) / (np.pi * 1000))
    peak = 2 * 810 * load / (np.pi * half_width)
    fitted, plain = (
        bemcontact.solve(stated.with_value("mesh.fit_contact_edges", fit), "complementarity") for fit in (True, False)
    )
    assert fitted.certified
    error, unfitted = (abs(result.footprint.peak.pressure / peak - 1) for result in (fitted, plain))
    assert error <= min(unfitted, 2e-2)
    assert fitted.footprint.intervals[0].end[0] == pytest.approx(half_width, rel=1e-2)


def test_contact_that_stays_narrower_than_an_element_is_reported(monkeypatch):
    """Without a pass: one point is under pressure, and its neighbors give no more information."""
    monkeypatch.setattr(fitting, "MOST_PASSES", 0)
    _, fit = fit_of(cylinder(24, load=1e-4))
    assert not fit.settled
    assert any("contact in foot is narrower than an element" in note for note in fit.notes)


@pytest.mark.parametrize("make", [lambda: cylinder(12), lambda: cylinder(24, load=0.01), cantilever])
def test_a_fitted_mesh_is_left_as_it_is(make):
    adapted, fit = fit_of(make())
    assert fit.settled
    again, second = fit_of(adapted.with_value("mesh.fit_contact_edges", True))
    assert again == adapted
    assert second.kept == 0
    (note,) = second.notes
    assert "fits the ends of contact already" in note


def test_no_element_is_longer_than_stated_and_other_edges_are_not_touched():
    """Elements beside the zone are the exception: they are halved to at most twice the length of their neighbors."""
    stated = table()
    adapted, _ = fit_of(stated)
    for name in ("left foot", "bridge", "right foot"):
        ends, own = adapted.edge(name).breakpoints(), stated.edge(name).breakpoints()
        assert np.diff(np.interp(ends, own, np.arange(len(own)))).max() <= 1 + 1e-9
    assert adapted.edge("top") == stated.edge("top")
    last = np.diff(adapted.edge("right foot").breakpoints())[-1] * adapted.edge("right foot").length
    beside = np.diff(adapted.edge("right").breakpoints()) * adapted.edge("right").length
    assert beside[0] <= 2 * last * (1 + 1e-9)
    assert len(beside) > stated.edge("right").elements


def test_two_contacts_in_one_zone_of_three_edges():
    """Each of the four ends of contact has its element end."""
    adapted, fit = fit_of(table().refined(2))
    stretches = fit.passes[fit.kept].intervals
    assert [item.zone for item in stretches] == ["feet", "feet"]
    ends = np.vstack([edge.points(edge.breakpoints()) for edge in adapted.boundary.edges])
    for point in (point for item in stretches for point in (item.start, item.end)):
        assert np.hypot(*(ends - point).T).min() <= 0.02  # a twentieth of the contact
    assert len([note for note in fit.notes if note.count("of contact in feet moved") == 4]) == 1
    assert adapted.mesh.refine == 2
    result = bemcontact.solve(table())
    assert result.certified
    assert result.footprint.resultant.force == pytest.approx((0.0, 8 * 2 * 3.0606601717798214), rel=1e-9)


@pytest.mark.parametrize(("length", "stress"), [(1e-3, 1.0), (2.54, 1e6)])
def test_fitted_mesh_does_not_depend_on_units(length, stress):
    one, _ = fit_of(cylinder(12))
    other, _ = fit_of(cylinder(12, length=length, stress=stress))
    assert_same_elements(one, other, 1e-9)


@pytest.mark.parametrize("make", [lambda: cylinder(12), table])
def test_a_mirrored_problem_has_the_mirrored_mesh(make):
    problem, _ = fit_of(make())
    mirror, _ = fit_of(mirrored(make()))
    ends = {name: 1 - places[::-1] for name, places in all_ends(mirror).items()}
    for name, places in all_ends(problem).items():
        np.testing.assert_allclose(ends[name], places, rtol=0, atol=1e-9, err_msg=name)


@pytest.mark.parametrize("edges", ["bottom", "[bottom, right]", "[left, bottom, right]"])
def test_contact_up_to_the_corners_needs_no_fit(edges):
    """The corners of a zone, or of a body in it: the mesh is as stated, and the note gives the reason."""
    stated = block(edges)
    adapted, fit = fit_of(stated)
    assert_same_elements(adapted, stated, 0)
    assert fit.settled
    (note,) = fit.notes
    assert note.startswith("the mesh is as stated: contact ends at no place inside a zone")


def test_contact_that_reaches_the_end_of_its_zone_is_fitted_at_its_other_end():
    adapted, fit = fit_of(cantilever())
    (interval,) = fit.passes[fit.kept].intervals
    assert interval.end == pytest.approx((50, 0))
    ends = 40 + 10 * adapted.edge("tip of lower").breakpoints()
    near = int(np.argmin(abs(ends - interval.start[0])))
    assert abs(ends[near] - interval.start[0]) <= SETTLED * np.diff(ends).min()
    inside = np.diff(ends[near:])
    assert np.all(np.diff(inside) > -1e-12)  # they do not shrink up to the end of the zone
    assert bemcontact.solve(adapted).certified


def test_a_zone_without_contact_stays_as_stated():
    """The paper's printed modulus: no contact at all."""
    stated = cantilever().with_value("material.young_modulus", 2e6)
    adapted, fit = fit_of(stated)
    assert_same_elements(adapted, stated, 0)
    assert fit.passes[0].intervals == ()
    assert fit.notes == ("the mesh is as stated, because nothing touches",)


def test_contact_on_a_closed_zone_does_not_depend_on_its_start():
    """The ends of contact do not depend on the seam: to 1e-4 of the radius."""
    fits = [fit_of(ring(seam)) for seam in (0, 100)]
    assert all(fit.settled and fit.kept for _, fit in fits)
    ends = [fit.passes[fit.kept].intervals[0] for _, fit in fits]
    assert ends[0].start == pytest.approx(ends[1].start, abs=1e-3)
    assert ends[0].end == pytest.approx(ends[1].end, abs=1e-3)
    assert ends[0].start == pytest.approx((-ends[0].end[0], ends[0].end[1]), abs=1e-3)  # the load is symmetric


@pytest.mark.parametrize(("radius", "seam", "elements"), [(9.9994, 346.45, 30), (9.9999, 302.14, 31)])
def test_half_of_a_closed_zone_in_contact_is_certified(radius, seam, elements):
    """The open half has two ends too, each with enough elements: long beside short elements make M indefinite."""
    stated = ring(seam).with_value("contact_zones.pin.surface.radius", radius)
    data = stated.model_dump()
    data["boundary"]["holes"][0][0]["elements"] = elements
    result = bemcontact.solve(Problem(**data), "complementarity")
    assert result.mesh_fit.settled
    assert result.mesh_fit.kept
    assert result.certified


def test_contact_all_round_a_closed_zone_needs_no_fit():
    """A pin that is too thick by a hundredth of its radius stretches the whole ring."""
    adapted, fit = fit_of(ring().with_value("contact_zones.pin.surface.radius", 10.1))
    assert fit.settled
    assert fit.kept == 0
    assert_same_elements(adapted, ring(), 0)


def test_a_zone_of_three_elements_gets_more_elements():
    """Half-width and peak to 2e-3 of finite elements, the three elements differ by 5.5e-3 and 4.8e-3."""
    adapted, fit = fit_of(cylinder(3))
    assert fit.settled
    assert any(f"elements where {elements_of(cylinder(3))} were stated" in note for note in fit.notes)
    result = bemcontact.solve(adapted, "complementarity")
    assert result.footprint.intervals[0].end[0] == pytest.approx(HALF_WIDTH, rel=2e-3)
    assert result.footprint.peak.pressure == pytest.approx(PEAK, rel=2e-3)


def test_contact_that_vanishes_in_a_pass_is_reported(monkeypatch):
    """The second solve is changed to have no contact on the left foot; the third has it again."""
    seen = []

    def blinking(contact, solution):
        seen.append(footprint(contact, solution))
        return replace(seen[-1], intervals=seen[-1].intervals[1:]) if len(seen) == 2 else seen[-1]

    monkeypatch.setattr(fitting, "footprint", blinking)
    _, fit = fit_of(table())
    assert [len(item.intervals) for item in fit.passes[:3]] == [2, 1, 2]
    assert any("changed from 2 to 1 with the mesh of pass 1" in note for note in fit.notes)
    assert fit.passes[1].movement is None  # it asks for a mesh that is divided in another way
    assert fit.kept != 1


def test_a_problem_without_a_contact_state_is_not_fitted(monkeypatch):
    """The solver breaks down at once."""
    broken = lambda contact: replace(complementarity.solve(contact), status=Status.NUMERICAL_FAILURE)  # noqa: E731
    monkeypatch.setattr(fitting, "complementarity", SimpleNamespace(solve=broken))
    stated = cylinder(6)
    adapted, fit = fit_of(stated)
    assert_same_elements(adapted, stated, 0)
    (note,) = fit.notes
    assert_states(note, "could not be fitted … broke down numerically")
    assert not fit.settled


@pytest.mark.parametrize(
    ("ends", "words"),
    [
        ({"sole": [0.5]}, "unknown edge 'sole'"),
        ({"foot": [0.5, 0.5]}, "ends here already"),
        ({"foot": [1.5]}, "between 0 and 1"),
        ({"flank": []}, "too few elements"),
    ],
)
def test_element_ends_are_checked(ends, words):
    with pytest.raises(ProblemError, match=words):
        cylinder(6).with_element_ends(ends)


def test_a_mesh_that_cannot_be_made_is_given_up(monkeypatch):
    """The mesh as stated is kept, and a note gives the reason."""
    monkeypatch.setattr(fitting, "fitted_ends", lambda run, touched: np.array([0.0, 0.4999, 0.5, run.length]))
    adapted, fit = fit_of(ring())
    assert fit.kept == 0
    assert not fit.settled
    assert_states(fit.notes[0], "left as stated … did not settle")
    assert any("the mesh of pass 1 was given up" in note and "turns by" in note for note in fit.notes)
    assert_same_elements(adapted, ring(), 0)


def test_refinement_cuts_the_fitted_elements():
    adapted, _ = fit_of(cylinder(12))
    finer, _ = fit_of(cylinder(12).refined(2))
    np.testing.assert_array_equal(adapted.edge("foot").breakpoints(2), finer.edge("foot").breakpoints(2))
    assert finer.mesh.refine == 2


def test_condense_fits_too_and_notes_it():
    contact = bemcontact.condense(cylinder(6))
    assert contact.notes[0].startswith("mesh fitted to the ends of contact")


def test_a_comparison_fits_once_and_then_refines():
    said = []
    plan = ComparisonOptions.of(["qp3"])
    study = comparing.study(plan, cylinder(6), (1, 2), lambda stage, now: said.append((stage, now)))
    assert study.certified
    assert next(stage for stage, now in said if not now) == "mesh fit"
    assert [stage for stage, _ in said].count("refine 1: mesh fit") == 0
    coarse, fine = study.levels
    assert coarse.answer.mesh_fit is fine.answer.mesh_fit is not None
    np.testing.assert_allclose(fine.answer.contact.points[::4], coarse.answer.contact.points[::2], rtol=0, atol=1e-14)
    assert "mesh fit" in coarse.answer.seconds
    assert "mesh fit" not in fine.answer.seconds
    assert comparing.compare(cylinder(6), "qp3").certified


def test_a_problem_that_does_not_ask_is_not_fitted():
    plain = cylinder(6).with_value("mesh.fit_contact_edges", False)
    assert fitted(plain) == (plain, None)
    assert bemcontact.solve(plain).mesh_fit is None
    assert bemcontact.solve(random_contact(1, 6, 1)).mesh_fit is None


def test_the_option_of_the_command_line_is_the_key_of_the_spec(tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    model = "models/cylinder_on_plane.yaml"
    by_option = CliRunner().invoke(cli.app, ["solve", model, "--fit-edges", "--json", "-"])
    by_key = CliRunner().invoke(cli.app, ["solve", model, "--set", "mesh.fit_contact_edges=true", "--json", "-"])
    assert by_option.exit_code == by_key.exit_code == 0, by_option.stderr
    one, other = json.loads(by_option.stdout), json.loads(by_key.stdout)
    assert one["mesh_fit"] == other["mesh_fit"] is not None
    assert one["pressure"] == other["pressure"]
    answer = CliRunner().invoke(cli.app, ["check", model, "--set", "mesh.fit_contact_edges=true"])
    assert "towards the ends of contact" in answer.stdout


def test_a_peak_that_moves_with_the_fitted_mesh_is_reported():
    """One point under pressure has a peak of its own; the note has the peaks of both meshes."""
    stated = cylinder(24, load=1e-4)
    adapted, fit = fit_of(stated)
    plain = stated.with_value("mesh.fit_contact_edges", False)
    peaks = [bemcontact.solve(one, "complementarity").footprint.peak.pressure for one in (plain, adapted)]
    assert abs(peaks[1] - peaks[0]) > 0.1 * peaks[0]
    start = f"the peak pressure changed from {peaks[0]:.5g} to {peaks[1]:.5g}"
    assert any(note.startswith(start) for note in fit.notes)
    assert not any(note.startswith("the force") for note in fit.notes)  # contact alone carries the load


def test_a_force_that_moves_with_the_fitted_mesh_is_reported():
    """With a spring in place of the load, one point under pressure carries another force."""
    first, last = (fitting._Trial(placed={}, forces={"foot": force}) for force in (1.0, 1.02))
    (note,) = fitting._changed(first, last)
    assert note.startswith("the force on foot changed from 1 to 1.02")


def test_movement_that_a_finer_cut_does_not_reduce_is_reported(monkeypatch):
    """Elements at wrong places do not settle by cutting; the numbers are those before the cut."""
    monkeypatch.setattr(fitting, "MOST_PASSES", 1)
    adapted, fit = fit_of(ring().refined(2))
    facts = f"{elements_of(adapted)} elements where {elements_of(ring())} were stated, before each was cut into 2"
    assert_states(fit.notes[0], facts)
    (still,) = (note for note in fit.notes if note.startswith("the ends of contact still move"))
    assert still.endswith("before each was cut into 2; state more elements in the zone, not a finer cut")


def test_a_fitted_mesh_with_an_oscillating_pressure_is_not_kept():
    """The open node at the tip is no real end of contact: pressures on a mesh fitted to it oscillate by 0.1."""
    crack = load("elliptical_crack_closure")
    for edge, elements, ratio in (("crack", 8, 20), ("ligament", 6, 40)):  # too long beside the tip
        crack = crack.with_value(f"boundary.outer.{edge}.elements", elements)
        crack = crack.with_value(f"boundary.outer.{edge}.grading.ratio", ratio)
    crack = crack.with_value("mesh.fit_contact_edges", True)
    adapted, fit = fit_of(crack)
    assert_same_elements(adapted, crack, 0)
    assert not fit.settled
    assert any(
        note.startswith("the mesh was left as stated: on fitted meshes the pressure oscillates") for note in fit.notes
    )


@pytest.mark.parametrize("variant", ["paper", "paper, finer crack"])
def test_oscillation_is_seen_where_the_stated_mesh_is_too_coarse_to_measure_it(variant):
    """Seven points under pressure: the peak by finite elements is 31.0, and that of fitted meshes 41 and more."""
    stated = load("elliptical_crack_closure").variant(variant)
    result = bemcontact.solve(stated.with_value("mesh.fit_contact_edges", True), "complementarity")
    assert result.mesh_fit.kept == 0
    assert result.footprint.peak.pressure == pytest.approx(31.0, rel=5e-3)


def load(name: str) -> Problem:
    """A shipped problem."""
    (path,) = MODELS.rglob(f"{name}.yaml")
    return bemcontact.load(path)
