"""Strains that are not small: the result is withheld, in the same words everywhere; smaller ones are noted."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import bemcontact
from bemcontact.analysis.linear_theory import (
    LARGE,
    LARGE_PART,
    LARGE_ROTATION,
    Judgment,
    RateOfChange,
    contact_strains,
    large_displacements,
    most_strained,
)
from bemcontact.assessment.penetration import Misfit
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.discretization import body_of
from bemcontact.problems import Problem


def affine(gradient: np.ndarray, unit: float = 1.0, share: float = 1.0) -> Judgment:
    """What is found of the displacement A x of a square of 4 x 25 elements, on a share of its boundary."""
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]) * unit
    ends = np.concatenate([a + np.linspace(0, 1, 26)[:-1, None] * (b - a) for a, b in pairwise(corners)])
    after = np.roll(ends, -1, axis=0)
    points = np.stack([ends, (ends + after) / 2, after], axis=1)
    moved = points @ gradient.T + unit
    moved[int(share * 100) :] = 0.0
    state = BoundaryState(
        points=points, displacement=moved, traction=moved, edge=np.zeros(100, int), edge_names=("all",),
        force_balance=0.0, equilibrium_slack=0.0,
    )  # fmt: skip
    return large_displacements(state, RateOfChange.of(state), turns=True, problem=block(1.0))


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize(
    ("shape", "withheld"),
    [(((0, -1), (1, 0)), LARGE_ROTATION), (((1, 0), (0, 1)), LARGE), (((0, 1), (0, 0)), LARGE_ROTATION)],
)
def test_large_rotations_strains_and_shears_are_found_and_translations_are_not(shape, withheld: float, unit: float):
    """The displacement A x changes by |A t| of the length along a side in the direction t: a stretch or a turn."""
    assert affine(np.array(shape) * LARGE * 0.99, unit) == Judgment()
    found = affine(np.array(shape) * LARGE * 1.01, unit)
    (words,) = [found.beyond.words] if found.beyond else [item.words for item in found.noticed]
    assert f"on {50 if shape[1] == (0, 0) else 100} % of the boundary" in words
    for size in (LARGE * 1.01, withheld * 0.99, withheld * 1.01):
        found = affine(np.array(shape) * size, unit)
        assert (found.beyond is not None) is (size > withheld)


def test_a_few_elements_with_large_displacements_do_not_count():
    assert affine(np.eye(2), share=LARGE_PART - 0.01).beyond is None
    assert affine(np.eye(2), share=LARGE_PART + 0.01).beyond is not None


def block(pressure: float, modulus: float = 7.0, size: float = 1.0, **more: object) -> Problem:
    """A block under uniaxial stress: all strains are the pressure over Young's modulus."""
    edges = [{"name": name, "start": [size * x, size * y], "elements": 4} for name, x, y in
             (("bottom", 0, 0), ("right", 2, 0), ("top", 2, 1), ("left", 0, 1))]  # fmt: skip
    return Problem.model_validate(
        {
            "name": "block",
            "material": {"young_modulus": modulus, "poisson_ratio": 0.3, "state": "plane_stress"},
            "boundary": {"outer": edges},
            "conditions": {"left": {"displacement": {"x": 0}}, "top": {"pressure": pressure}},
            "contact_zones": {
                "foot": {"edges": "bottom", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}
            },
            **more,
        }
    )


@pytest.mark.parametrize("state", ["plane_stress", "plane_strain"])
@pytest.mark.parametrize("nu", [-0.9, -0.25, 0.0, 0.3, 0.49])
def test_no_contact_strain_is_larger_than_its_bound(nu: float, state: str):
    """The bound sees the largest pressure and change of displacement alone; strains are those of a crooked load."""
    material = {"young_modulus": 7.0, "poisson_ratio": nu, "state": state}
    load = {"pressure": {"x": 0.6, "constant": 1.0}}
    problem = block(1.0, material=material, conditions={"left": {"fixed": True}, "top": load})
    result = bemcontact.solve(problem)
    assert result.boundary is not None
    pressure = result.solution.pressure
    rate = RateOfChange.of(result.boundary)
    part, gradient = contact_strains(body_of(problem), result.boundary, rate, pressure)[1].max(), rate.gradient.max()
    assert 0.1 < part <= most_strained(problem, pressure.max(), gradient)


@pytest.mark.slow
@settings(max_examples=12)
@given(
    share=st.sampled_from([0.04, 0.06, 0.24, 0.26, 0.9, 5.0]), modulus=st.sampled_from([1e-6, 7.0, 1e9]),
    size=st.sampled_from([1e-3, 1.0, 1e4]),
)  # fmt: skip
def test_strains_are_noted_from_a_twentieth_on_and_judged_from_a_quarter_on(share, modulus, size):
    """In any units, and with the reason in the result."""
    result = bemcontact.solve(block(share * modulus, modulus, size))
    assert result.holds is result.certified is (share < LARGE)
    assert result.certificate.certified
    noted = [note for note in result.notes if "linear theory is off by about" in note]
    assert len(noted) == (0.05 < share < LARGE)
    if share < LARGE:
        assert result.penetration is None
        return
    assert result.penetration is not None
    assert result.penetration.kind is Misfit.NOT_SMALL
    assert result.penetration.depth == pytest.approx(share, rel=1e-6)
    assert f"{share:.2g} times Young's modulus" in result.penetration.words
    assert Misfit.NOT_SMALL in repr(result)


@pytest.mark.parametrize(("nu", "holds"), [(0.4999, True), (0.3, False)])
def test_a_large_pressure_all_round_is_withheld_only_if_it_strains(nu: float, holds: bool):
    """Uniaxial strain e = p (1 + nu) (1 - 2 nu) / (E (1 - nu)) by statics and Hooke's law; here p = E."""
    held = {side: {"displacement": {"x": 0}} for side in ("left", "right")}
    material = {"young_modulus": 7.0, "poisson_ratio": nu}
    result = bemcontact.solve(block(7.0, material=material, conditions={**held, "top": {"pressure": 7.0}}))
    assert result.holds is holds
    assert result.notes == ()


def test_an_infinite_peak_hides_no_strains():
    """A punch with a sharp edge has no peak; under a mean pressure of Young's modulus its middle is strained too."""
    problem = bemcontact.load("models/gallery/flat_punch.yaml")
    for pressure, kind in ((5.0, None), (2e3, Misfit.NOT_SMALL)):
        result = bemcontact.solve(problem.with_value("conditions.far side.pressure", pressure))
        assert (result.penetration and result.penetration.kind) == kind


def test_load_cases_and_paths_are_withheld_too():
    """A path is judged at its ends and breakpoints; between them the pressure is linear, and no peak is larger."""
    cases = {name: {"conditions": {"top": {"pressure": p}}} for name, p in (("light", 0.1), ("heavy", 2.0))}
    found = bemcontact.solve_cases(block(0.05, load_cases=cases))
    assert [item.holds for item in found.results.values()] == [True, False]
    for end, holds in ((1.0, True), (2.0, False)):
        path = bemcontact.follow(block(0.05), "conditions.top.pressure", end)
        assert path.certified is holds
        assert any("linear theory is off" in note for note in path.notes) is holds
        assert (path.penetration is None) is holds
        assert path.penetrates_at == (None if holds else end)


@pytest.mark.slow
def test_a_body_that_a_condition_holds_is_not_told_to_be_held():
    """Young's modulus in other units than the load: the message states it, and asks for no other condition."""
    edges = [{"name": name, "start": start, "elements": 8} for name, start in
             (("bottom", [0, 0]), ("right", [9, 0]), ("top", [9, 1]), ("left", [0, 1]))]  # fmt: skip
    problem = Problem(
        name="beam",
        material={"young_modulus": 210.0, "poisson_ratio": 0.3},
        boundary={"outer": edges},
        conditions={"left": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": 1.0}},
        contact_zones={"foot": {"edges": "bottom", "surface": {"kind": "plane", "point": [0, -40], "normal": [0, 1]}}},
    )
    result = bemcontact.solve(problem)
    assert not result.holds
    words = result.penetration.words if result.penetration else ""
    assert "Units may be mixed" in words
    assert "210" in words
    assert "hold it" not in words


@pytest.mark.parametrize(("rim", "told"), [({"kind": "arc", "center": (0, 5), "radius": 5}, False), ({}, True)])
def test_a_line_of_symmetry_makes_no_corner(rim: dict, told: bool):
    """Half of a squeezed round seal has a corner on its line of symmetry, and the seal has none; a wedge has one."""
    seal = Problem(
        name="seal",
        material={"young_modulus": 5, "poisson_ratio": 0.48},
        boundary={"outer": [
            {"name": "rim", **rim, "start": (0, 0), "end": (5, 5), "elements": 12},
            {"name": "top", "end": (0, 5), "elements": 6},
            {"name": "axis", "end": (0, 0), "elements": 6},
        ]},
        conditions={"axis": {"displacement": {"x": 0}}, "top": {"displacement": {"x": 0, "y": -1.5}}},
        contact_zones={"floor": {"edges": "rim", "surface": {"kind": "plane", "point": (0, 0), "normal": (0, 1)}}},
        accuracy=None,
    )  # pyright: ignore[reportArgumentType] # fmt: skip
    found = bemcontact.solve(seal).penetration
    assert found is not None
    assert found.kind is Misfit.NOT_SMALL
    assert ("sharp corner" in found.words) is told
