"""Error bars of the largest stresses: they contain closed forms and the stress on finer meshes."""

from pathlib import Path

import pytest
from indented_blocks import indented

import bemcontact
from bemcontact.analysis.stress_bars import _on_mesh
from bemcontact.contact.stress import StressPeak

MODELS = Path(__file__).parents[2] / "models"


def test_bar_contains_hertz():
    """0.3003 p0 (Johnson, section 4.2) for b/R = 0.003, where the circle's shear changes it by less than 0.1 %."""
    result, _, peak = indented(0.003)
    shear = result.largest_stresses().shear["foot"]
    assert shear.bar is None or abs(shear.value - 0.3003 * peak) < (shear.bar + 1e-3) * shear.value


@pytest.mark.parametrize("variant", [None, "stated mesh"])
@pytest.mark.parametrize(
    "name", ["cylinder_on_plane", "bolt_in_plate", "gallery/hertz_small", "gallery/rolling_polygon"]
)
def test_bars_contain_finer_meshes(name: str, variant: str | None):
    """With elements a quarter as long the largest stresses differ by no more than the error bars."""
    problem = bemcontact.load(MODELS / f"{name}.yaml", **({} if variant is None else {"variant": variant}))
    result = bemcontact.solve(problem.with_value("accuracy", 0.05) if variant else problem)
    own = result.largest_stresses()
    _, finer = _on_mesh(result.problem.refined(4), result.accuracy.infinite_places)
    compared = [*zip(own.shear.values(), finer.shear.values(), strict=True)]
    compared += [(own.inside, finer.inside), (own.boundary, finer.boundary)]
    pairs = [(one, two) for one, two in compared if isinstance(one, StressPeak) and isinstance(two, StressPeak)]
    assert pairs
    for one, two in pairs:
        assert one.bar is not None
        assert abs(one.value - two.value) <= one.bar * one.value


def test_coarse_stress_has_a_large_bar():
    """At the end of a strip under pressure stress jumps: the mesh is coarse there, and the bar says so."""
    result = bemcontact.solve(bemcontact.load(MODELS / "cylinder_on_plane.yaml"))
    largest = result.largest_stresses()
    assert largest.boundary.edge == "top"
    assert largest.boundary.bar > 5 * largest.inside.bar


def test_unknown_bars():
    """No bar is known where errors are not estimated; near an infinite stress none that says nothing is told."""
    problem = bemcontact.load(MODELS / "cylinder_on_plane.yaml", variant="stated mesh").with_value("accuracy", None)
    largest = bemcontact.solve(problem).largest_stresses()
    assert largest.inside.bar is None
    punch = bemcontact.load(MODELS / "gallery" / "eccentric_punch.yaml").with_case("off the middle")
    boundary = bemcontact.solve(punch).largest_stresses().boundary
    assert boundary.bar is None or boundary.bar < 1
