"""Stress of results: below Hertz's contact, a punch and line loads, along edges, and what is said of each point."""

from dataclasses import replace
from pathlib import Path

import half_plane
import numpy as np
import pytest
from indented_blocks import NU, E, block, indented

import bemcontact
from bemcontact import Problem, ProblemError

MODELS = Path(__file__).parents[2] / "models"


def points_below(b: float) -> np.ndarray:
    """Two hundred points, some 1e-3 b below the surface and some below the end of contact."""
    x = np.array([0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1, 1.01, 1.05, 1.3, 2])
    depth = np.array([1e-6, 1e-3, 0.003, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5, 0.7, 0.786, 0.9, 1, 1.2, 1.5, 2, 3])
    return b * np.array([[a, -d] for a in x for d in depth])


@pytest.mark.parametrize("width", [0.003, 0.03])
def test_hertz_below_the_surface(width: float):
    """All components within 0.2 % of the peak pressure from 1e-3 b below the surface, within 1 % nearer.

    Nearer, the root of the pressure at the end of contact is seen on its element.

    The half-plane bears the shear of the rigid circle too, on whose normals contact acts: up to 3 % if b/R = 0.03.
    """
    result, b, peak = indented(width)
    points = points_below(b)
    assert len(points) > 200
    stress = result.stress(points)
    assert (stress.kind == "inside").all()
    error = abs(stress.components - half_plane.stress(points, half_plane.hertz(b, peak, curvature=1.0))).max(axis=1)
    assert error.max() < 0.01 * peak
    assert error[points[:, 1] <= -1e-3 * b].max() < 2e-3 * peak


@pytest.mark.parametrize(("width", "tolerance"), [(0.003, 2e-3), (0.03, 5e-3)])
def test_largest_shear_below_hertz(width: float, tolerance: float):
    """0.3003 p0 at 0.786 b (Johnson, Contact Mechanics, section 4.2), but for the shear of the circle."""
    result, b, peak = indented(width)
    depth = np.linspace(0.5, 1.1, 601)
    shear = result.stress(np.column_stack([1e-6 * b + 0 * depth, -depth * b])).in_plane_shear
    assert shear.max() == pytest.approx(0.3003 * peak, rel=tolerance)
    assert depth[shear.argmax()] == pytest.approx(0.786, abs=0.03)


def test_hertz_on_the_surface():
    """Below the contact σxx = σyy = -p, beside it there is none; the pressure of the edge is that of contact."""
    result, b, peak = indented(0.003)
    x = b * np.array([0.1, 0.5, 0.8, 0.95, 1.05, 1.5, 3])
    stress = result.stress(np.column_stack([x, 0 * x]))
    assert (stress.kind == "boundary").all()
    p = peak * np.sqrt(np.maximum(1 - x**2 / b**2, 0))
    assert abs(stress.components[:, :2] + p[:, None]).max() < 3e-3 * peak
    edge = result.boundary_stress()["top"]
    assert edge.peak == pytest.approx(-peak, rel=5e-3)
    assert edge.peak_at == pytest.approx((0, 0), abs=0.05 * b)
    assert edge.pressure.max() == pytest.approx(peak, rel=2e-3)


def test_punch_below_the_surface():
    """The stress of the sharp punch within 1 % of its mean pressure, away from the edge, where stress is infinite."""
    a, size, load = 1.0, 400.0, 20.0
    top = [{"name": "side of it", "start": [size, 0]}, {"name": "face", "start": [a, 0]}]
    plane = {"kind": "plane", "point": [0, 0], "normal": [0, -1]}
    result = bemcontact.solve(
        block(size, top, {"punch": {"edges": "face", "surface": plane}}, {"bottom": {"pressure": load / 2 / size}})
    )
    points = np.array([[x, -y] for x in (0.01, 0.4, 0.8, 1, 1.3, 2) for y in (0.2, 0.5, 1, 2)])
    error = result.stress(points).components - half_plane.stress(points, half_plane.punch(a, load))
    assert abs(error).max() < 0.01 * load / 2 / a
    edge = result.stress([[1, 0], [0.5, 0], [1.5, 0], [0, 0]])
    assert edge.kind.tolist() == ["singular", "boundary", "boundary", "corner"]
    assert np.isnan(edge.components[0]).all()
    assert np.isnan(edge.von_mises[0])
    assert np.isfinite(edge.components[1:]).all()
    along = result.boundary_stress()["face"]
    assert along.peak is None
    assert along.singular.tolist() == [[1, 0]]
    assert np.isnan(along.hoop).sum() == 1


def test_line_loads():
    """Pressure on a narrow strip of a large block, which stands on a plane: within 0.5 %, 1e-3 c below its end too.

    Elements get smaller towards the end of the strip, where the slope of the surface is a logarithm.
    """
    c, size, p = 1.0, 800.0, 5.0
    towards = [{"ratio": ratio, "towards": end} for ratio, end in ((1e6, "end"), (1e3, "start"), (100, "start"))]
    free, pressed = {"name": "free", "start": [size, 0]}, {"name": "pressed", "start": [c, 0]}
    top = [{**free, "elements": 30, "grading": towards[0]}, {**pressed, "elements": 14, "grading": towards[1]}]
    floor = {"kind": "plane", "point": [0, -size], "normal": [0, 1]}
    problem = block(
        size, top, {"floor": {"edges": "bottom", "surface": floor}}, {"pressed": {"pressure": p}}, None,
        counts={"bottom": 6, "side": 6, "axis": 30}, grading={"axis": {"ratio": 1e4, "towards": "start"}},
    )  # fmt: skip
    result = bemcontact.solve(problem)
    points = np.array([[x, -y] for x in (0.02, 0.5, 0.98, 1, 1.02, 1.5, 5) for y in (1e-3, 1e-2, 0.1, 0.5, 1, 3, 20)])
    error = result.stress(points).components - half_plane.stress(points, half_plane.strip(c, p))
    assert abs(error).max() < 5e-3 * p
    assert result.stress([[c, 0]]).kind.tolist() == ["corner"]


def test_hole_under_compression():
    """A plate with a hole, its lower half cut off and on a plane: hoop stress -3 at the side of the hole, 1 on top.

    Kirsch's plate; the square plate of 40 radii differs by the order of (a/W)².
    """
    size = 40.0
    problem = Problem(
        name="plate", material={"young_modulus": E, "poisson_ratio": NU}, accuracy=1e-3,
        boundary={"outer": [{"name": "floor", "start": [1, 0]}, {"name": "side", "start": [size, 0]},
                            {"name": "top", "start": [size, size]}, {"name": "axis", "start": [0, size]},
                            {"name": "hole", "kind": "arc", "center": [0, 0], "radius": 1, "angles": [90, 0]}]},
        conditions={"top": {"pressure": 2}, "axis": {"displacement": {"x": 0}}},
        contact_zones={"foot": {"edges": "floor", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
    )  # fmt: skip
    result = bemcontact.solve(problem)
    hole = result.boundary_stress()["hole"]
    assert hole.peak == pytest.approx(-6, rel=5e-3)
    assert hole.peak_at == pytest.approx((1, 0), abs=0.01)
    assert hole.peak_arc == pytest.approx(np.pi / 2, abs=0.01)
    assert hole.hoop[0, 0] == pytest.approx(2, rel=0.01)
    assert abs(hole.pressure).max() == abs(hole.shear).max() == 0
    assert hole.von_mises.max() == pytest.approx(6 * np.sqrt(1 - NU + NU**2), rel=5e-3)
    assert hole.arc[:, 0] == pytest.approx(np.append(0, hole.arc[:-1, 2]))
    corner = result.stress([[1, 0], [0, 1]])
    assert corner.kind.tolist() == ["corner", "corner"]
    assert corner.components == pytest.approx(np.array([[0, -6, 0], [2, 0, 0]]), abs=0.05)


def test_clamped_corners_are_singular():
    """A clamped edge beside a free one at a right angle: Williams' exponent is 0.29; the other corners are not."""
    result = bemcontact.solve(bemcontact.load(MODELS / "cantilever_flat_surface.yaml", variant="stated mesh"))
    stress = result.stress([[0, 0], [0, 5], [50, 5], [25, 2.5], [0, 2.5], [25, 5]])
    assert stress.kind.tolist() == ["singular", "singular", "corner", "inside", "boundary", "boundary"]
    assert "2 of them singular" in repr(stress)


def test_tip_of_a_slit_is_singular():
    """Contact with the contour of the slit does not take the square root away from the stress at its tip."""
    result = bemcontact.solve(bemcontact.load(MODELS / "slit_closure.yaml"))
    assert result.stress([[3, 0], [0, 10]]).kind.tolist() == ["singular", "corner"]


def test_points_outside_are_refused():
    result, b, _ = indented(0.003)
    with pytest.raises(ProblemError) as error:
        result.stress([[b, -b], [b, 1e-6], [0, 9]])
    for fact in ("points[1]", "(0.003", "1e-06", "'top'", "2 of the 3", "outside"):
        assert fact in str(error.value)
    for wrong in ([0, 0], [[0, 0, 0]], "here", [[np.nan, 0]]):
        with pytest.raises(ProblemError):
            result.displacement(wrong)
    with pytest.raises(ProblemError, match="condensed"):
        bemcontact.solve(result.contact).stress([[b, -b]])


def test_displacement():
    """At nodes it is that of the boundary; below them it is near to it, by the strain over the depth."""
    result, b, peak = indented(0.003)
    state, depth = result.boundary, 1e-3 * b
    own = np.flatnonzero(state.edge == state.edge_names.index("top"))
    nodes, moved = state.points[own, 1], state.displacement[own, 1]
    assert result.displacement(nodes) == pytest.approx(moved, abs=1e-14)
    below = result.displacement(nodes - [0, depth])
    assert abs(below - moved).max() < 2 * peak / E * depth


def test_derived_stresses():
    """Principal stresses are the eigenvalues of the tensor; Tresca's and von Mises's stress follow from them."""
    result, b, _ = indented(0.003)
    stress = result.stress(points_below(b)[::7])
    (xx, yy, xy), zz, none = stress.components.T, stress.zz, 0 * stress.zz
    assert zz == pytest.approx(NU * (xx + yy), rel=1e-12)
    tensor = np.array([[xx, xy, none], [xy, yy, none], [none, none, zz]]).transpose(2, 0, 1)
    one, two, three = np.linalg.eigvalsh(tensor)[:, ::-1].T
    assert stress.principal == pytest.approx(np.column_stack([one, two, three]), abs=1e-12)
    assert stress.max_shear == pytest.approx((one - three) / 2, abs=1e-12)
    mises = np.sqrt(((one - two) ** 2 + (two - three) ** 2 + (three - one) ** 2) / 2)
    assert stress.von_mises == pytest.approx(mises, abs=1e-12)
    assert stress.in_plane_shear == pytest.approx(np.hypot((xx - yy) / 2, xy))


def test_known_infinite_pressures_are_singular():
    """Places where the error bars report an infinite pressure, such as kinks of a surface."""
    result, _, _ = indented(0.003)
    bar = result.accuracy.bar_of("peak", "foot")
    x, y = result.boundary.points[result.boundary.edge_names.index("top") == result.boundary.edge][3, 0].tolist()
    infinite = replace(result.accuracy, bars=(replace(bar, value=None, bar=None, at=(x, y)),))
    assert result.stress([[x, y]]).kind.tolist() == ["boundary"]
    assert replace(result, accuracy=infinite).stress([[x, y]]).kind.tolist() == ["singular"]
