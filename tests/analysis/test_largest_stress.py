"""The largest stresses: Hertz's in closed form, none that random points exceed, none where there is none."""

from pathlib import Path

import numpy as np
import pytest
from indented_blocks import block, indented

import bemcontact
from bemcontact import ProblemError, Result
from bemcontact.analysis.stress_bars import _on_mesh
from bemcontact.contact.stress import NoPeak

MODELS = Path(__file__).parents[2] / "models"


HERTZ = (0.30028, 0.78615)
"""Largest shear over the peak pressure, and its depth over the half-width (Johnson, Contact Mechanics, section 4.2)."""


def sheared_hertz(slope: float) -> tuple[float, float]:
    """As `HERTZ`, with a traction along the half-plane of the pressure times `slope` x/b towards the middle.

    On the axis Flamant's stress of both, summed over x = cos θ by the midpoint rule.
    """
    theta, depth = (np.arange(2000) + 0.5) * np.pi / 2000, np.linspace(0.7, 0.9, 2001)[:, None]
    x, weights = np.cos(theta), np.sin(theta) ** 2 * np.pi / 2000
    r4 = (x**2 + depth**2) ** 2
    across = -2 / np.pi * ((x**2 * depth - x**3 * slope * x) / r4) @ weights
    along = -2 / np.pi * ((depth**3 - x * depth**2 * slope * x) / r4) @ weights
    shear = (across - along) / 2
    return float(shear.max()), float(depth[shear.argmax(), 0])


def test_half_plane_with_sheared_contact():
    """Without shear it is Hertz's; the depth is as exact as the steps."""
    assert sheared_hertz(0.0) == pytest.approx(HERTZ, rel=2e-4)


@pytest.mark.parametrize("accuracy", [1e-2, 1e-3])
@pytest.mark.parametrize("width", [0.003, 0.03])
def test_largest_shear_below_hertz(width: float, accuracy: float):
    """Hertz's within 0.1 % in value and 0.1 % of b in depth, if the normals of the circle are accounted for.

    Pressure acts along them, and so has a part b/R x/b towards the middle. It changes the depth by 0.7 % at b/R = 0.03,
    and by 0.07 % at b/R = 0.003. The block is 1000 times as large as the contact: the pressure on its bottom is 0.08 %
    of the peak.
    """
    result, b, peak = indented(width, accuracy)
    shear = result.largest_stresses().shear["foot"]
    value, depth = sheared_hertz(width)
    assert shear.depth == pytest.approx(depth * b, abs=1e-3 * b)
    assert shear.value == pytest.approx(value * peak, rel=1e-3)
    if width == 0.003:
        assert (shear.value / peak, shear.depth / b) == pytest.approx(HERTZ, rel=5e-3)
    assert shear.point == pytest.approx((0, -shear.depth), abs=1e-2 * b)
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
    assert punch.missing["shear below punch"] is NoPeak.TO_INFINITE
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
    assert largest.inside is None
    assert largest.missing == {"shear below lid": NoPeak.NO_CONTACT, "von Mises, inside": NoPeak.TO_BOUNDARY}
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
    _, finer = _on_mesh(result.problem.refined(4), result.accuracy.infinite_places)
    assert finer.inside.value == pytest.approx(own.value, rel=own.bar)
