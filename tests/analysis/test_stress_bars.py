"""Error bars of the largest stresses: they contain closed forms and the stress on finer meshes."""

from pathlib import Path

import pytest
from indented_blocks import indented

import bemcontact
from bemcontact.analysis.stress_bars import _on_mesh
from bemcontact.contact.stress import StressPeak

MODELS = Path(__file__).parents[2] / "models"


@pytest.mark.slow
def test_bar_contains_hertz():
    """0.3003 p0 (Johnson, section 4.2) but for 0.1 %: the normals of the circle, and the mean stress of the block.

    They change it by 0.03 % at b/R = 0.003, and by up to half of 0.08 % of the peak, the pressure on its bottom.
    """
    result, _, peak = indented(0.003)
    shear = result.largest_stresses().shear["foot"]
    assert 0 < shear.bar < 5e-3
    assert abs(shear.value - 0.3003 * peak) < shear.bar * shear.value + (0.0003 * 0.3 + 0.0008 / 2) * peak


ON_MESHES = [(name, None) for name in ("cylinder_on_plane", "bolt_in_plate", "gallery/rolling_polygon")]
ON_MESHES += [(name, "stated mesh") for name in ("bolt_in_plate", "gallery/rolling_polygon")]
"""Bars of a mesh that is found come from a coarser one, those of a stated mesh from a finer one."""


@pytest.mark.slow
@pytest.mark.parametrize(("name", "variant"), ON_MESHES)
def test_bars_contain_finer_meshes(name: str, variant: str | None):
    """With elements a third as long the largest stresses differ by no more than the error bars."""
    problem = bemcontact.load(MODELS / f"{name}.yaml", **({} if variant is None else {"variant": variant}))
    result = bemcontact.solve(problem.with_value("accuracy", 0.05))
    own = result.largest_stresses()
    finer = _on_mesh(result.problem.refined(3), result.accuracy.infinite_places).largest
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


def test_no_bar_where_errors_are_not_estimated():
    """Without an accuracy nothing is known of the mesh, and nothing is said of the errors of stresses."""
    problem = bemcontact.load(MODELS / "cylinder_on_plane.yaml", variant="stated mesh").with_value("accuracy", None)
    largest = bemcontact.solve(problem).largest_stresses()
    assert (largest.inside.bar, largest.boundary.bar, largest.shear["foot"].bar) == (None, None, None)
