"""Every file in models/ is a problem with a description and a certified solution that meets its references."""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from bemcontact import cli, spec
from bemcontact.analysis import solve as analysis
from bemcontact.analysis.result import Result
from bemcontact.problems import Problem
from bemcontact.reference import expected, score

FOLDER = Path(__file__).parents[2] / "models"
MODELS = sorted(path.stem for path in FOLDER.glob("*.yaml"))
VARIANTS = [(name, variant) for name in MODELS for variant in spec.load(FOLDER / f"{name}.yaml").variants]
FORMULATIONS = ("qp1", "qp2", "qp3")


STATED = "stated mesh"


@cache
def problem(name: str, variant: str | None = None, refine: int = 1) -> Problem:
    return spec.load(FOLDER / f"{name}.yaml", variant=variant).refined(refine)


@cache
def result(name: str, formulation: str, variant: str | None = None, refine: int = 1) -> Result:
    return analysis.solve(condensed(name, variant, refine), formulation)


@cache
def condensed(name: str, variant: str | None, refine: int) -> analysis.CondensedContact:
    return analysis.condense(problem(name, variant, refine))


def answers(name: str, refine: int) -> list[Result]:
    return [result(name, formulation, STATED, refine) for formulation in FORMULATIONS]


def test_there_are_the_problems_of_the_paper():
    assert {
        "bolt_in_plate",
        "cantilever_curved_surface",
        "cantilever_flat_surface",
        "cylinder_on_plane",
        "elliptical_crack_closure",
        "slit_closure",
    } <= set(MODELS)


@pytest.mark.parametrize("name", MODELS)
def test_solution_is_certified(name: str):
    answer = CliRunner().invoke(cli.app, ["solve", str(FOLDER / f"{name}.yaml"), "--json", "-"])
    assert answer.exit_code == 0, answer.stderr
    assert json.loads(answer.stdout)["certified"] is True


@pytest.mark.parametrize("name", MODELS)
def test_model_is_described_and_short(name: str):
    stated = problem(name)
    assert stated.description
    assert stated.reference
    assert stated.units.stress
    assert len((FOLDER / f"{name}.yaml").read_text(encoding="utf-8").splitlines()) <= 60


@pytest.mark.parametrize(("name", "variant"), VARIANTS)
@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_each_variant_is_certified_by_each_formulation(name: str, variant: str, formulation: str):
    assert result(name, formulation, variant).certified


@pytest.mark.parametrize("refine", [1, pytest.param(4, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", MODELS)
def test_references_are_met_by_each_formulation(name: str, refine: int):
    for answer in answers(name, refine):
        assert answer.certified
        known = expected(problem(name, STATED, refine), answer.contact)
        scores = score(known, answer.contact, answer.footprint, answer.solution.pressure)
        assert [item for item in scores if item.judged and not item.holds] == []
        assert any(item.judged for item in scores)


@pytest.mark.parametrize(
    ("name", "elements"),
    [
        ("cantilever_curved_surface", 30),  # 5 + 10 + 5 + 10
        ("cylinder_on_plane", 24),
        ("elliptical_crack_closure", 14),
        ("bolt_in_plate", 14),
    ],
)
def test_variants_have_the_number_of_elements_of_the_paper(name: str, elements: int):
    assert sum(edge.elements for edge in problem(name, "paper").boundary.edges) == elements


@pytest.mark.parametrize("refine", [1, 4])
def test_cantilever_on_a_curved_surface_carries_half_of_its_load_at_the_far_end(refine: int):
    """[SS92], Fig. 2: 50 ± 0.01 away from the clamp."""
    for answer in answers("cantilever_curved_surface", refine):
        x = answer.contact.points[:, 0]
        away = (x >= 40) & (x <= 95)
        assert abs(answer.solution.pressure[away] - 50).max() < 0.01


@pytest.mark.parametrize("refine", [1, 4])
def test_contact_carries_all_of_the_load(refine: int):
    """Half of 810 under the cylinder, 25 · 3 along the pull of the plate; nothing else holds them."""
    for answer in answers("cylinder_on_plane", refine):
        assert answer.footprint.resultant.force == pytest.approx((0, 405), rel=1e-9, abs=405e-9)
    for answer in answers("bolt_in_plate", refine):
        assert answer.footprint.resultant.force[0] == pytest.approx(-75, rel=1e-9)


def test_open_nodes_at_the_tip_of_the_crack_depend_on_the_mesh():
    """The open part moves to the tip: each mesh has at most its last node open, and a fine mesh has none."""
    last = []
    for refine in (1, 2, 4, 8):
        answer = result("elliptical_crack_closure", "complementarity", "paper", refine)
        x, pressure = answer.contact.points[:, 0], answer.solution.pressure
        assert set(x[pressure <= 0]) <= {x.max()}
        last.append(np.count_nonzero(pressure <= 0))
    assert last[-1] == 0


@pytest.mark.parametrize("refine", [1, 2, 4])
def test_crack_closes_to_its_tip(refine: int):
    """All nodes touch. Closing the upright face is a strain of -1 there, with σ_x = 0: σ_y = -E/(1 - ν²) = -1099.

    On the ligament this is traction in y, on the first node of its first element, to 1 % divided by the refinement.
    """
    for answer in answers("elliptical_crack_closure", refine):
        assert answer.solution.pressure.min() > 0
        (interval,) = answer.footprint.intervals
        assert interval.end == pytest.approx((3, 0), abs=1e-12)
    boundary = analysis.solve(problem("elliptical_crack_closure", STATED, refine)).to_dict()["boundary"]
    first = boundary["edge"].index("ligament")
    assert boundary["points"][first][0] == pytest.approx((3, 0))
    assert boundary["traction"][first][0][1] == pytest.approx(1000 / (1 - 0.3**2), rel=0.01 / refine)


def test_slit_has_no_pressure_from_the_ends_of_the_crack():
    """By the closed forms of an infinite panel the pressure of the crack is larger by about q c/2a = 3.75."""
    crack, slit = (result(name, "qp3", STATED).footprint.peak for name in ("elliptical_crack_closure", "slit_closure"))
    assert crack is not None
    assert slit is not None
    assert crack.pressure - slit.pressure == pytest.approx(3.75, rel=0.2)


@pytest.mark.parametrize(("refine", "within"), [(1, 0.5), (4, 0.0625)])
def test_start_of_contact_of_the_cantilever(refine: int, within: float):
    """Start at 42.395 by finite elements: within one node spacing, and within half of it on the fine mesh."""
    for answer in answers("cantilever_flat_surface", refine):
        (interval,) = answer.footprint.intervals
        assert interval.start[0] == pytest.approx(42.395, abs=within)


def test_cantilever_does_not_touch_with_the_printed_modulus():
    arguments = ["solve", str(FOLDER / "cantilever_flat_surface.yaml"), "--set", "material.young_modulus=2e6"]
    answer = CliRunner().invoke(cli.app, arguments)
    assert answer.exit_code == 0
    assert "Contact nowhere" in " ".join(answer.stdout.split())
    assert "unique solution proved" in " ".join(answer.stdout.split())
    for formulation in FORMULATIONS:
        untouched = result("cantilever_flat_surface", formulation, "printed modulus")
        assert untouched.certified
        assert not untouched.solution.pressure.any()
        # beam theory: q L⁴/8EI = 3.6 · 50⁴ / (8 · 2e6 · 125/12) = 0.135, times 1 - ν² in plane strain, and shear
        assert untouched.solution.displacement.min() == pytest.approx(-0.135 * (1 - 0.29**2), rel=0.03)
