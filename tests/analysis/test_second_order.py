"""Slender parts that stretch as they bend, or buckle: von Karman's strip and Euler's strut, and bodies that do not."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import bemcontact
from bemcontact.adaptivity.first_sizes import ACROSS, OPPOSED
from bemcontact.analysis.displaced_body import ProbedBody, StiffnessChange
from bemcontact.analysis.linear_theory import LARGE, NOTICED
from bemcontact.analysis.second_order import CHANGED, across
from bemcontact.assessment.penetration import Misfit
from bemcontact.bem.discretization import body_of
from bemcontact.problems import Problem

HELD = {"displacement": {"x": 0, "y": 0}}
SLENDER = 40.0
"""Length over thickness of the strips: shear adds 2.6 (2 h / L)² to a deflection, at most 1 % (Timoshenko)."""


def strip(conditions: dict, *, thick: float = 1.0, length: float = SLENDER, modulus: float = 1e3, **more) -> Problem:
    """A strip along x from 0 to length, with a zone that nothing touches."""
    corners = {"bottom": (0, 0, 60), "right": (1, 0, 3), "top": (1, 1, 27), "foot": (0.55, 1, 6), "rest": (0.45, 1, 27),
               "left": (0, 1, 3)}  # fmt: skip
    edges = [{"name": name, "start": [length * x * thick, y * thick], "elements": n}
             for name, (x, y, n) in corners.items()]  # fmt: skip
    surface = {"kind": "plane", "point": [0, 1e3 * thick], "normal": [0, -1]}
    return Problem.model_validate(
        {
            "name": "strip",
            "material": {"young_modulus": modulus, "poisson_ratio": 0.0, "state": "plane_stress"},
            "boundary": {"outer": edges},
            "conditions": conditions,
            "contact_zones": {"far": {"edges": "foot", "surface": surface}},
            "accuracy": None,
            **more,
        }
    )


def stretch_of_clamped_strip(deflection: float) -> float:
    """EA/(2L) (∫w'²)² / (EI ∫w''²) of the shape 16 (x/L)² (1 - x/L)² of a uniform load; deflection over thickness.

    It is the strain energy of the mean strain ½ ∫w'² / L, in the equation of Ritz for the size of the shape.
    """
    shape = 16 * np.polynomial.Polynomial([0, 0, 1, -2, 1])
    slope, bending = ((shape.deriv(k) ** 2).integ()(1.0) for k in (1, 2))
    return 12 / 2 * deflection**2 * slope**2 / bending


def first_order(shape: np.polynomial.Polynomial) -> float:
    """Mean square of the answer v to the load w'' of the shape w along w, over its energy quotient ∫w'² / ∫w''².

    Four times differentiated v is w'', and it is clamped as w is. The package projects by mean squares, Ritz by energy.
    """
    x = np.polynomial.Polynomial([0, 1])
    v = shape.integ(2) - shape.integ(2)(1.0) * x**2 * (3 - 2 * x) - shape.integ()(1.0) * x**2 * (x - 1)
    energy = (shape.deriv() ** 2).integ()(1.0) / (shape.deriv(2) ** 2).integ()(1.0)
    return -(v * shape).integ()(1.0) / (shape**2).integ()(1.0) / energy


@pytest.mark.parametrize("relative", [0.1, 0.5, 1.0, 2.0])
def test_stretching_of_a_clamped_strip_is_that_of_von_karman(relative: float):
    """The deflection under a uniform load q is q L⁴ / (384 E I) in linear theory."""
    load = relative * 384 * 1e3 / 12 / SLENDER**4
    problem = strip({"left": HELD, "right": HELD, "bottom": {"pressure": load}})
    displacements, forces, _ = ProbedBody(body_of(problem)).change()
    expected = stretch_of_clamped_strip(relative) * first_order(np.polynomial.Polynomial([0, 0, 1, -2, 1]))
    assert displacements.stretch == pytest.approx(expected, rel=0.02 if relative < 1 else 0.06)  # the shape changes
    assert abs(displacements.tension) < 0.01
    assert forces == (0.0, 0.0)  # nothing is in contact
    error = 1 / displacements.displacement - 1
    result = bemcontact.solve(problem)
    assert result.certified is (error < LARGE)
    assert (result.penetration is None) is (error < LARGE)
    assert any("stretched" in note for note in result.notes) is (CHANGED < error < LARGE)


@pytest.mark.parametrize("relative", [0.5, 2.0])
def test_a_strip_with_a_free_end_does_not_stretch(relative: float):
    """Its deflection q L⁴ / (8 E I) may be several times its thickness: the mean strain is zero."""
    load = relative * 8 * 1e3 / 12 / SLENDER**4
    result = bemcontact.solve(strip({"left": HELD, "bottom": {"pressure": load}}))
    assert result.certified
    assert result.notes == ()


STRUTS = {
    "clamped and free": (1 / 4, lambda stress, _: {"traction": {"x": -stress}}),
    "both clamped, by a displacement": (4.0, lambda _, strain: {"displacement": {"x": -strain * SLENDER, "y": 0}}),
    "both clamped, by heat": (4.0, lambda *_: HELD),
}
"""Critical force over π² EI / L² (Timoshenko and Gere 1961), and the condition of the right end."""


def strut(kind: str, part: float, **more) -> Problem:
    """A strut under a part of its critical load; there is no load sideways unless one is given."""
    factor, right = STRUTS[kind]
    strain = part * factor * np.pi**2 / 12 / SLENDER**2
    heat = {"loads": {"temperature": {"expansion": 1e-5, "change": strain / 1e-5}}} if kind.endswith("heat") else {}
    conditions = {"left": HELD, "right": right(1e3 * strain, strain)}
    return strip({**conditions, **more.pop("conditions", {})}, **heat, **more)


@pytest.mark.slow
@pytest.mark.parametrize("kind", STRUTS)
@pytest.mark.parametrize("part", [0.1, 0.3, 0.9, 1.1, 2.5])
def test_buckling_is_that_of_euler(kind: str, part: float):
    problem = strut(kind, part)
    assert ProbedBody(body_of(problem)).critical(0.01) == pytest.approx(part, rel=0.03)
    result = bemcontact.solve(problem)
    assert result.certified is (part < 1)
    told = [note for note in result.notes if "buckles at about" in note]
    assert len(told) == (NOTICED < part < 1)
    if part > 1:
        assert result.penetration is not None
        assert result.penetration.kind is Misfit.NOT_SMALL
        assert "buckles" in result.penetration.words


@pytest.mark.parametrize("kind", STRUTS)
def test_tension_does_not_buckle(kind: str):
    assert ProbedBody(body_of(strut(kind, -3.0))).critical(0.01) < 0.02  # strains are up to 0.006
    assert bemcontact.solve(strut(kind, -3.0)).certified


@pytest.mark.parametrize("part", [-4.0, -1.0, -0.1, 0.1, 0.3, 0.7])
def test_a_strut_with_a_load_sideways_bends_by_more_and_a_tie_by_less(part: float):
    """The lever of the force P at the place x is w(1) - w(x), for the deflection w of a uniform load, with L = 1.

    The deflection v by it, EI v'' = P (w(1) - w), projected onto w, is what the force adds to first order.
    """
    shape = np.polynomial.Polynomial([0, 0, 6, -4, 1])
    lever = (shape(1.0) - shape).integ(2)
    expected = float(-part * np.pi**2 / 4 * (lever * shape).integ()(1.0) / (shape**2).integ()(1.0))
    sideways = {"bottom": {"pressure": 0.5 * 8 * 1e3 / 12 / SLENDER**4}}
    problem = strut("clamped and free", part, conditions=sideways)
    displacements, _, _ = ProbedBody(body_of(problem)).change()
    assert displacements.tension == pytest.approx(expected, rel=0.02)
    assert abs(displacements.stretch) < 0.02
    result = bemcontact.solve(problem)
    off = max(1 + expected, 1 / (1 + expected)) - 1
    assert result.certified is (off < LARGE)
    assert any("linear theory takes displacements too" in note for note in result.notes) is (off < LARGE)


@pytest.mark.slow
@settings(max_examples=5)
@given(
    part=st.sampled_from([0.5, 1.5]), turn=st.sampled_from([0.0, 0.4, 2.0]), size=st.sampled_from([1e-3, 1.0, 1e4]),
    modulus=st.sampled_from([1e-3, 1.0, 1e9]),
)  # fmt: skip
def test_units_and_directions_do_not_matter(part: float, turn: float, size: float, modulus: float):
    """The stress scales with the modulus, all lengths with the size; the strut is turned with its load."""
    data = strut("clamped and free", part).model_dump(exclude_defaults=True)
    c, s = np.cos(turn), np.sin(turn)
    stress = -part * modulus * np.pi**2 / 48 / SLENDER**2
    for edge in data["boundary"]["outer"]:
        x, y = edge["start"]
        edge["start"] = (size * (c * x - s * y), size * (s * x + c * y))
    data["material"]["young_modulus"] = modulus
    data["conditions"] = {"left": HELD, "right": {"traction": {"x": c * stress, "y": s * stress}}}
    plane = {"kind": "plane", "point": (-1e3 * size * s, 1e3 * size * c), "normal": (s, -c)}
    data["contact_zones"]["far"]["surface"] = plane
    problem = Problem.model_validate(data)
    assert ProbedBody(body_of(problem)).critical(0.01 * size) == pytest.approx(part, rel=0.03)
    assert bemcontact.solve(problem).certified is (part < 1)


@pytest.mark.parametrize("relative", [0.2, 1.0])
def test_the_force_of_a_pin_on_a_clamped_strip_grows_by_stretching(relative: float):
    """At a given depth of a pin the force is short of the stretch of the shape 3 x² - 4 x³ of a force in the middle."""
    half = np.polynomial.Polynomial([0, 0, 12, -16])  # from an end to the middle, for x from 0 to 1/2
    slope, bending = (2 * (half.deriv(k) ** 2).integ()(0.5) for k in (1, 2))
    expected = float(12 / 2 * relative**2 * slope**2 / bending)
    surface = {"kind": "circle", "center": [SLENDER / 2, 1 + 5 - relative], "radius": 5, "body": "outside"}
    problem = strip(
        {"left": HELD, "right": HELD}, contact_zones={"pin": {"edges": "foot", "surface": surface}}, mesh={"refine": 2}
    )
    _, forces, _ = ProbedBody(body_of(problem)).change()
    assert forces.stretch == pytest.approx(expected, rel=0.1)
    result = bemcontact.solve(problem)
    assert any("forces too small" in note for note in result.notes) is (CHANGED < expected < LARGE)
    assert (result.penetration is None) is (expected < LARGE)


@pytest.mark.parametrize("part", [0.5, 1.5])
def test_a_strut_between_a_plane_and_a_clamp_buckles_as_one_with_two_clamps(part: float):
    """A plane that is pressed on all of an end holds it from turning, and not from sliding.

    Each half of the strut bends as one that is clamped and free, and the critical force is π² EI / L².
    """
    strain = part * np.pi**2 / 12 / SLENDER**2
    surface = {"kind": "plane", "point": [strain * SLENDER, 0], "normal": [1, 0]}
    problem = strip({"right": HELD}, contact_zones={"end": {"edges": "left", "surface": surface}})
    assert ProbedBody(body_of(problem)).critical(1e-4) == pytest.approx(part, rel=0.03)
    assert (bemcontact.solve(problem).penetration is None) is (part < 1)


@pytest.mark.parametrize(
    "path", [*Path("models").glob("*.yaml"), *Path("models", "gallery").glob("*.yaml")], ids=lambda path: path.stem
)
def test_shipped_problems_have_no_such_note(path: Path):
    """None of them has slender parts that bend by their thickness or are near to buckling, on any mesh."""
    problem = bemcontact.load(path, variant="stated mesh")
    results = bemcontact.solve_cases(problem).results.values() if problem.load_cases else [bemcontact.solve(problem)]
    for result in results:
        told = (*result.notes, result.penetration.words if result.penetration else "")
        words = ("stretched as it bends", "gain levers", "buckles")
        assert not [text for text, word in itertools.product(told, words) if word in text]


def test_change_is_read_from_two_displaced_bodies():
    """X (1 + t) + s x³ = 1, from displacements over themselves of bodies with 1 ± t/2 and 1 + s/2."""
    for tension, stretch in ((0.3, 0.0), (-0.4, 0.2), (5.0, 2.0), (0.0, 0.7)):
        forth, back = ((1 - sign * tension / 2) / (1 + stretch / 2) for sign in (1, -1))
        change = StiffnessChange.of_displacements(forth, back)
        assert change == pytest.approx((tension, stretch))
        x = change.displacement
        assert x * (1 + tension) + stretch * x**3 == pytest.approx(1)
        assert StiffnessChange.of_forces(1 + tension / 2 + stretch / 2, 1 - tension / 2 + stretch / 2) == pytest.approx(
            change
        )
    assert StiffnessChange(tension=-1.5).displacement == np.inf


def test_the_force_of_a_stop_that_a_strip_does_not_reach_is_withheld():
    """Linear theory takes a clamped strip to 1.06 of the gap; it stretches, w + stretch w³ = 0.53, and stays short."""
    gap, reached = 0.5, 0.53
    free = np.roots([stretch_of_clamped_strip(1.0), 0.0, 1.0, -reached])
    assert free.real[abs(free.imag) < 1e-9].max() < gap
    surface = {"kind": "circle", "center": [SLENDER / 2, -gap - 5], "radius": 5, "body": "outside"}
    load = reached * 384 * 1e3 / 12 / SLENDER**4
    edges = {"left": HELD, "right": HELD, **{name: {"pressure": load} for name in ("top", "foot", "rest")}}
    problem = strip(edges, contact_zones={"stop": {"edges": "bottom", "surface": surface}})
    result = bemcontact.solve(problem)
    assert result.footprint.peak is not None
    assert result.penetration is not None
    assert "the force of contact in 'stop' is off" in result.penetration.words


@pytest.mark.parametrize("length", [20.0, 60.0, 100.0])
def test_a_heated_block_that_cannot_move_is_certified(length: float):
    """Its displacement is zero, and so is its error; the pressure is E α T / (1 - 2 ν) all around."""
    corners = {"bottom": (0, 0), "right": (length, 0), "top": (length, 10), "left": (0, 10)}
    planes = {"bottom": ([0, 0], [0, 1]), "right": ([length, 0], [-1, 0]), "top": ([0, 10], [0, -1]),
              "left": ([0, 0], [1, 0])}  # fmt: skip
    problem = Problem.model_validate(
        {
            "name": "confined", "material": {"young_modulus": 210e3, "poisson_ratio": 0.3},
            "boundary": {"outer": [{"name": name, "start": at} for name, at in corners.items()]},
            "loads": {"temperature": {"expansion": 1.2e-5, "change": 100}},
            "contact_zones": {name: {"edges": name, "surface": {"kind": "plane", "point": point, "normal": normal}}
                              for name, (point, normal) in planes.items()},
        }
    )  # fmt: skip
    result = bemcontact.solve(problem)
    assert result.holds, result.words
    assert result.accuracy.bar_of("displacement").value == 0.0
    assert result.solution.pressure.max() == pytest.approx(210e3 * 1.2e-3 / 0.4, rel=1e-6)


@pytest.mark.parametrize(("clearance", "held"), [(0.05, True), (0.3, False)])
def test_a_strip_that_a_slot_keeps_straight_is_not_withheld(clearance: float, held: bool):
    """Beyond its critical load it bends until it touches the slot, which is near or not so near."""
    walls = {
        name: {"edges": list(edges), "surface": {"kind": "plane", "point": [0, y], "normal": [0, -np.sign(y)]}}
        for name, edges, y in (("below", ("bottom",), -clearance), ("above", ("top", "foot", "rest"), 1 + clearance))
    }
    problem = strut("both clamped, by heat", 1.5, contact_zones=walls)
    result = bemcontact.solve(problem)
    assert (result.penetration is None) is held
    assert any("surfaces beside it may hold it" in note for note in result.notes) is held


@pytest.mark.parametrize("name", ["three_zones", "shrink_fit", "closed_crack"])
def test_the_thickness_is_the_distance_to_the_nearest_element_that_faces_an_element(name):
    """As by its definition, element by element; angles that are at their limit but for rounding may count or not."""
    body = body_of(bemcontact.load(Path("models", "gallery", f"{name}.yaml"), variant="stated mesh"))
    mesh, (thickness, facing, _) = body.mesh, across(body)
    at, normals = mesh.nodes[mesh.elements[:, 1]], mesh.normals[:, 1]
    outer = np.full(len(at), True)
    for on in (mesh.facing[bond] for bond in body.problem.bonded):  # the halves are one body
        outer[np.append(np.flatnonzero(on >= 0), on[on >= 0])] = False
    for i in range(len(at)):
        away = at[i] - at
        distance, other = np.hypot(*away.T), outer & outer[i] & (np.arange(len(at)) != i)
        cosine = away @ normals[i] / np.where(distance > 0, distance, 1.0)
        most, least = (
            distance[other & (cosine >= ACROSS + slack) & (normals @ normals[i] < OPPOSED - slack)].min(initial=np.inf)
            for slack in (1e-9, -1e-9)
        )
        assert (1 - 1e-12) * least <= thickness[i] <= (1 + 1e-12) * most
        assert thickness[i] == np.inf or distance[facing[i]] == pytest.approx(thickness[i], rel=1e-12)
