"""The largest stresses: Hertz's in closed form, none that random points exceed, none where there is none."""

from pathlib import Path

import numpy as np
import pytest
from indented_blocks import block, indented

import bemcontact
from bemcontact import ProblemError, Result
from bemcontact.analysis.stress_bars import _on_mesh

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


def on_round_support(elements: int, mirrored: bool = False, unit: float = 1.0) -> bemcontact.Problem:
    """A block of 6 by 2 on a circle at three quarters of its length, on a coarse mesh, or its mirror image."""
    corners = [("bottom", 0, 0), ("right", 6, 0), ("top", 6, 2), ("left", 0, 2)]
    circle = {"center": [(1.5 if mirrored else 4.5) * unit, -3 * unit], "radius": 3 * unit, "body": "outside"}
    return bemcontact.Problem(
        name="block", material={"young_modulus": 1000, "poisson_ratio": 0.3}, accuracy=None,
        boundary={"outer": [{"name": n, "start": [x * unit, y * unit], "elements": elements} for n, x, y in corners]},
        conditions={"right" if mirrored else "left": {"displacement": {"x": 0}}, "top": {"pressure": 1}},
        contact_zones={"foot": {"edges": "bottom", "surface": {"kind": "circle", **circle}}},
    )  # fmt: skip


@pytest.mark.parametrize("elements", [6, 8, 12])
def test_mirrored_and_in_other_units(elements: int):
    """A point from which a search begins may be as near to an element that touches as to one that does not."""
    changes = [{}, {"mirrored": True}, {"unit": 1e-3}, {"unit": 1e3}]
    found = [
        bemcontact.solve(on_round_support(elements, **change)).largest_stresses().shear["foot"] for change in changes
    ]
    assert [peak.value for peak in found] == pytest.approx([found[0].value] * 4, rel=1e-6)


def test_finer_mesh_has_the_same_maximum():
    """On it more of the points from which searches begin lie along the hole, and lead to the boundary."""
    size, height = 4.5, 3.4
    hole = {"name": "hole", "kind": "arc", "center": [1.4, 1.8], "radius": 0.4, "angles": [0, -360]}
    corners = [("bottom", 0, 0), ("right", size, 0), ("top", size, height), ("axis", 0, height)]
    circle = {"kind": "circle", "center": [0, -13], "radius": 13, "body": "outside"}
    result = bemcontact.solve(bemcontact.Problem(
        name="plate", material={"young_modulus": 1000, "poisson_ratio": 0}, accuracy=0.02,
        boundary={"outer": [{"name": n, "start": [x, y]} for n, x, y in corners], "holes": [[hole]]},
        conditions={"axis": {"displacement": {"x": 0}}, "top": {"pressure": 2}},
        contact_zones={"foot": {"edges": "bottom", "surface": circle}},
    ))  # fmt: skip
    own = result.largest_stresses().inside
    _, finer = _on_mesh(result.problem.refined(3), result.accuracy.infinite_places)
    assert finer.inside.value == pytest.approx(own.value, rel=own.bar)
