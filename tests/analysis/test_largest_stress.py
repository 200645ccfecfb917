"""The largest stresses: Hertz's in closed form, none that random points exceed, none where there is none."""

from pathlib import Path

import numpy as np
import pytest
from indented_blocks import block, indented

import bemcontact
from bemcontact import ProblemError, Result

MODELS = Path(__file__).parents[2] / "models"


@pytest.mark.parametrize(("width", "tolerance"), [(0.003, 2e-3), (0.03, 5e-3)])
def test_largest_shear_below_hertz(width: float, tolerance: float):
    """0.3003 p0 at 0.786 b (Johnson, Contact Mechanics, section 4.2), but for the shear of the circle.

    Shear is 0.1 % lower 3 % of b above and below.
    """
    result, b, peak = indented(width)
    shear = result.largest_stresses().shear["foot"]
    assert shear.value == pytest.approx(0.3003 * peak, rel=tolerance)
    assert shear.depth == pytest.approx(0.786 * b, abs=0.03 * b)
    assert shear.point == pytest.approx((0, -0.786 * b), abs=0.03 * b)
    assert shear.value == pytest.approx(result.stress([shear.point]).max_shear[0], rel=1e-12)


def random_points(result: Result, count: int = 20_000) -> np.ndarray:
    """Points inside, half of them near to contact."""
    nodes, touched = result.boundary.points.reshape(-1, 2), result.contact.points[result.touching]
    rng = np.random.default_rng(5)
    spread = rng.uniform(nodes.min(axis=0), nodes.max(axis=0), (count // 2, 2))
    middle, size = touched.mean(axis=0), np.ptp(touched, axis=0).max()
    points = np.vstack([spread, middle + size * rng.uniform(-1, 1, (count // 2, 2))])
    return points[result._body_stress.field.locate(points).inside]


@pytest.mark.parametrize("name", ["cylinder_on_plane", "gallery/hertz_small", "bolt_in_plate", "gallery/shrink_fit"])
def test_no_point_exceeds_the_largest(name: str):
    """Not by more than the field differs from that of the boundary beside it; the place has the value that is given."""
    result = bemcontact.solve(bemcontact.load(MODELS / f"{name}.yaml"))
    largest = result.largest_stresses()
    most = max(peak.value for peak in (largest.inside, largest.boundary) if peak)
    assert result.stress(random_points(result)).von_mises.max() <= most * (1 + 2e-3)
    for peak in (largest.inside, largest.boundary):
        if peak:
            assert result.stress([peak.point]).von_mises[0] == pytest.approx(peak.value, rel=1e-3)
    assert not len(largest.singular)
    assert largest.boundary.depth == 0


def test_singular_bodies():
    """Below a sharp punch shear grows up to its edge, and so it does at clamped corners: there is no largest stress."""
    punch = bemcontact.solve(bemcontact.load(MODELS / "gallery" / "flat_punch.yaml")).largest_stresses()
    assert punch.shear == {"punch": None}
    assert punch.singular.tolist() == [[5, 0]]
    cantilever = bemcontact.load(MODELS / "cantilever_flat_surface.yaml").with_value("accuracy", 0.1)
    beam = bemcontact.solve(cantilever).largest_stresses()
    assert sorted(beam.singular.tolist()) == [[0, 0], [0, 5]]


def test_no_contact():
    """A body that is held without contact has no stress below it; its largest one is on the boundary."""
    far = {"kind": "plane", "point": [0, 9], "normal": [0, -1]}
    problem = block(
        2.0, [{"name": "top", "start": [2, 0]}], {"lid": {"edges": "top", "surface": far}},
        {"bottom": {"displacement": {"y": 0}}, "side": {"pressure": 3}},
    )  # fmt: skip
    result = bemcontact.solve(problem)
    largest = result.largest_stresses()
    assert largest.shear == {"lid": None}
    assert largest.boundary.value == pytest.approx(3 * np.sqrt(1 - 0.3 + 0.3**2), rel=1e-9)
    with pytest.raises(ProblemError, match="condensed"):
        bemcontact.solve(result.contact).largest_stresses()
