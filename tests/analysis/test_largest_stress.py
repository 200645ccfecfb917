"""The largest stresses: Hertz's in closed form, none that random points exceed, none where there is none."""

from pathlib import Path

import numpy as np
import pytest
import several_bodies
from indented_blocks import block, indented
from scipy.spatial import KDTree

import bemcontact
from bemcontact import ProblemError, Result
from bemcontact.analysis import largest_stress
from bemcontact.analysis.stress_bars import _on_mesh
from bemcontact.contact.stress import LargestStresses, NoPeak

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


@pytest.mark.slow
@pytest.mark.parametrize("accuracy", [1e-2, 1e-3])
@pytest.mark.parametrize("width", [0.003, 0.03])
def test_largest_shear_below_hertz(width: float, accuracy: float):
    """Hertz's within 0.1 % in value and 0.1 % of b in depth, if the normals of the circle are accounted for.

    Pressure acts along them, and so has a part b/R x/b towards the middle. It changes the depth by 0.7 % at b/R = 0.03,
    and by 0.07 % at b/R = 0.003. The block is 1000 times as large as the contact: the pressure on its bottom is 0.08 %
    of the peak.
    """
    result, b, peak = indented(width, accuracy)
    shear = largest_of(result).shear["foot"]
    value, depth = sheared_hertz(width)
    assert shear.depth == pytest.approx(depth * b, abs=1e-3 * b)
    assert shear.value == pytest.approx(value * peak, rel=1e-3)
    if width == 0.003:
        assert (shear.value / peak, shear.depth / b) == pytest.approx(HERTZ, rel=5e-3)
    assert shear.point == pytest.approx((0, -shear.depth), abs=1e-2 * b)
    assert shear.value == pytest.approx(result.stress([shear.point]).max_shear[0], rel=1e-12)


def largest_of(result: Result) -> LargestStresses:
    """Without error bars, for which they are looked for on another mesh too: `test_stress_bars.py` is about these."""
    return result._stresses.largest


def largest_anew(result: Result) -> LargestStresses:
    """Looked for once more, whatever the result keeps from an earlier question."""
    stresses = result._stresses
    return type(stresses)(bodies=stresses.bodies, pressed=stresses.pressed).largest


def random_points(result: Result, count: int = 20_000) -> np.ndarray:
    """Points inside, half of them near to contact."""
    nodes, touched = result.boundary.points.reshape(-1, 2), result.contact.points[result.touching]
    rng = np.random.default_rng(5)
    spread = rng.uniform(nodes.min(axis=0), nodes.max(axis=0), (count // 2, 2))
    middle, size = touched.mean(axis=0), np.ptp(touched, axis=0).max()
    points = np.vstack([spread, middle + size * rng.uniform(-1, 1, (count // 2, 2))])
    return points[result._stresses.bodies[0].field.locate(points).inside]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cylinder_on_plane", "gallery/hertz_small", "bolt_in_plate", "gallery/shrink_fit"])
def test_no_point_exceeds_the_largest(name: str):
    """Not by more than the field differs from that of the boundary beside it; the place has the value that is given."""
    result = bemcontact.solve(bemcontact.load(MODELS / f"{name}.yaml"))
    largest = largest_of(result)
    most = max(peak.value for peak in (largest.inside, largest.boundary) if peak)
    assert result.stress(random_points(result)).von_mises.max() <= most * (1 + 2e-3)
    for peak in (largest.inside, largest.boundary):
        if peak:
            assert result.stress([peak.point]).von_mises[0] == pytest.approx(peak.value, rel=1e-3)
    assert not len(largest.singular)
    assert largest.boundary.depth == 0


@pytest.mark.slow
def test_singular_bodies():
    """Below a sharp punch shear grows up to its edge, and so it does at clamped corners: there is no largest stress."""
    punch = bemcontact.solve(bemcontact.load(MODELS / "gallery" / "flat_punch.yaml")).largest_stresses()
    assert punch.shear == {"punch": None}
    assert punch.missing["shear below punch"] is NoPeak.TO_INFINITE
    assert punch.singular.tolist() == [[5, 0]]
    cantilever = bemcontact.load(MODELS / "cantilever_flat_surface.yaml").with_value("accuracy", 0.1)
    beam = bemcontact.solve(cantilever).largest_stresses()
    assert sorted(beam.singular.tolist()) == [[0, 0], [0, 5]]


@pytest.mark.slow
def test_beside_a_sharp_stop():
    """At the edge of a rigid stop stress grows like s^-1/2: a maximum within the element there is one of the mesh."""
    corners = {"under": [0, 2], "right": [60, 2], "top": [60, 14], "left": [0, 14]}
    stop = {"below": [50, 0], "right": [60, 0], "over": [60, 2], "left": [50, 2]}
    load = {"force": {"y": -2000, "width": 10, "at": 20}}
    problem = bemcontact.problem(
        {
            "name": "beam",
            "bodies": {
                "beam": {
                    "material": {"young_modulus": 210e3, "poisson_ratio": 0.3},
                    "boundary": {"outer": [{"name": name, "start": at} for name, at in corners.items()]},
                    "conditions": {"left": {"fixed": True}, "top": load},
                },
                "stop": {
                    "rigid": True,
                    "boundary": {"outer": [{"name": name, "start": at} for name, at in stop.items()]},
                },
            },
            "contacts": {"stop": {"between": ["stop/over", "beam/under"]}},
        }
    )
    largest = bemcontact.solve(problem).largest_stresses()
    assert largest.shear == {"stop": None}
    assert largest.missing["shear below stop"] is NoPeak.TO_INFINITE
    assert [50, 2] in largest.singular.round(6).tolist()
    assert largest.inside is None or np.hypot(*np.subtract(largest.inside.point, [50, 2])) > 1


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


def test_no_load():
    """A clamped body that nothing loads or touches has no stress, at the corners of its clamp neither."""
    far = {"kind": "plane", "point": [0, 9], "normal": [0, -1]}
    clamp = {"bottom": {"displacement": {"x": 0, "y": 0}}}
    problem = block(2.0, [{"name": "top", "start": [2, 0]}], {"lid": {"edges": "top", "surface": far}}, clamp)
    largest = bemcontact.solve(problem).largest_stresses()
    assert (largest.shear, largest.inside, largest.boundary, largest.singular.size) == ({"lid": None}, None, None, 0)
    without = dict.fromkeys(("von Mises, inside", "von Mises, on the boundary"), NoPeak.NO_STRESS)
    assert largest.missing == {"shear below lid": NoPeak.NO_CONTACT, **without}


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


@pytest.mark.slow
@pytest.mark.parametrize("elements", [6, 8, 12])
def test_mirrored_and_in_other_units(elements: int):
    """A point from which a search begins may be as near to an element that touches as to one that does not."""
    changes = [{}, {"mirrored": True}, {"unit": 1e-3}, {"unit": 1e3}]
    found = [largest_of(bemcontact.solve(on_round_support(elements, **change))).shear["foot"] for change in changes]
    assert [peak.value for peak in found] == pytest.approx([found[0].value] * 4, rel=1e-6)


@pytest.mark.slow
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
    finer = _on_mesh(result.problem.refined(3), result.accuracy.infinite_places).largest
    assert finer.inside.value == pytest.approx(own.value, rel=own.bar)


def plate(hole: tuple[float, float, float], radius: float, poisson_ratio: float) -> Result:
    """A quarter of a plate 4.5 x 3.4 with a hole (x, y, radius), pressed on a circle."""
    x, y, r = hole
    corners = [("bottom", 0, 0), ("right", 4.5, 0), ("top", 4.5, 3.4), ("axis", 0, 3.4)]
    return bemcontact.solve(bemcontact.Problem(
        name="plate", material={"young_modulus": 1000, "poisson_ratio": poisson_ratio}, accuracy=0.02,
        boundary={
            "outer": [{"name": name, "start": place} for name, *place in corners],
            "holes": [[{"name": "hole", "kind": "arc", "center": [x, y], "radius": r, "angles": [0, -360]}]],
        },
        conditions={"axis": {"displacement": {"x": 0}}, "top": {"pressure": 2}},
        contact_zones={"foot": {"edges": "bottom", "surface": {
            "kind": "circle", "center": [0, -radius], "radius": radius, "body": "outside",
        }}},
    ))  # fmt: skip


def shear_maxima(result: Result, end: float) -> list[float]:
    """Values of the maxima of shear below a contact up to x = `end`, from a grid that is refined around each of them.

    Below is what is nearer to it than 1.41 times the distance from the boundary. Around a maximum shear is lower on
    circles of half the depth and of 0.9 of it.
    """
    points, found = result.boundary.points, list[float]()
    field = result._stresses.bodies[0].field
    rim = points[result.boundary.edge != result.boundary.edge_names.index("axis")]
    fine = np.vstack([rim[:, 0] + t * (rim[:, 2] - rim[:, 0]) for t in np.linspace(0, 1, 33)])  # sides of the polygon
    fine = KDTree(np.vstack([rim.reshape(-1, 2), fine]))

    def shear(places: np.ndarray) -> np.ndarray:
        places = np.column_stack([abs(places[:, 0]), places[:, 1]])
        inside = field.locate(places).inside
        values = np.full(len(places), -np.inf)
        values[inside] = result.stress(places[inside]).max_shear
        return values

    x, y = np.meshgrid(np.linspace(1e-3, 2.2 * end, 45), np.geomspace(0.02 * end, 3 * end, 45), indexing="ij")
    values = shear(np.column_stack([x.ravel(), y.ravel()])).reshape(x.shape)
    padded = np.pad(values, 1, constant_values=-np.inf)
    padded[0] = padded[1]  # mirror image
    around = np.max([padded[i : i + 45, j : j + 45] for i in range(3) for j in range(3) if (i, j) != (1, 1)], axis=0)
    circle = np.exp(2j * np.pi * np.arange(24) / 24).view(float).reshape(-1, 2)
    square = np.stack(np.meshgrid([0, -1, 1], [0, -1, 1]), axis=-1).reshape(-1, 2)
    i, j = np.nonzero(values >= around)
    places, step, live = np.column_stack([x[i, j], y[i, j]]), 0.1 * y[i, j], np.arange(len(i))
    least = 1e-4 * step  # a step away from a maximum, stress is lower by about the square of the step over the depth
    for _ in range(60):
        squares = places[live, None] + step[live, None, None] * square
        best = shear(squares.reshape(-1, 2)).reshape(-1, 9).argmax(axis=1)
        places[live], step[live] = squares[np.arange(len(live)), best], np.where(best, 1, 0.5) * step[live]
        live = live[step[live] > least[live]]
        if not len(live):
            break
    for place in places:
        depth, away = fine.query(place)[0], max(0.0, np.hypot(max(abs(place[0]) - end, 0), place[1]))
        value = shear(place[None])[0]
        if 0.01 * end < depth >= away / 2**0.5 and all(
            shear(place + part * depth * circle).max() < value for part in (0.5, 0.9)
        ):
            found.append(float(value))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hole", "radius", "poisson_ratio"),
    [((1.4, 1.8, 0.4), 13, 0.3), ((1.2, 1.0, 0.6), 30, 0.45), ((0.9, 0.9, 0.3), 60, 0.3), ((1.0, 1.2, 0.7), 6, 0.2)],
)
def test_dense_grid_has_no_larger_maximum(hole: tuple[float, float, float], radius: float, poisson_ratio: float):
    """The largest maximum of shear below the contact is found, also beside its end; or the reason why there is none."""
    result = plate(hole, radius, poisson_ratio)
    largest = largest_of(result)
    (x, _), (end, _) = result.footprint.intervals[0].start, result.footprint.intervals[0].end
    maxima, peak = shear_maxima(result, max(abs(x), abs(end))), largest.shear["foot"]
    if maxima:
        assert peak is not None
        assert peak.value == pytest.approx(max(maxima), rel=1e-4)
    else:
        assert peak is None
        assert largest.missing["shear below foot"] is NoPeak.TO_BOUNDARY


@pytest.mark.slow
def test_each_contact_of_a_roller_has_its_own_largest_shear():
    """Below each is Hertz's, with that of the disk between two forces, within 1 %; a third contact is open.

    The rim is one edge.
    """
    guided = {"displacement": {"x": 0}}
    half = [
        {"name": "rim", "kind": "arc", "center": [0, 10], "radius": 10, "angles": [-90, 90]},
        {"name": "axis"},
    ]
    fixed = {"bottom": {"displacement": {"y": 0}}, "left": guided}
    bodies = {
        "low": several_bodies.elastic(several_bodies.block((0, 20), (-20, 0)), fixed, 2.1e5),
        "roller": several_bodies.elastic({"outer": half}, {"axis": guided}, 2.1e5),
        "high": several_bodies.elastic(
            several_bodies.block((0, 15), (20, 35)), {"top": {"pressure": 10.0}, "left": guided}, 2.1e4
        ),
        "beside": several_bodies.elastic(
            several_bodies.block((10.1, 20.1), (5, 15)), {"right": {"displacement": {"x": 0, "y": 0}}}, 2.1e4
        ),
    }
    contacts = {
        name: ["roller/rim", f"{name}/{edge}"]
        for name, edge in (("low", "top"), ("high", "bottom"), ("beside", "left"))
    }
    result = bemcontact.solve(several_bodies.problem(bodies, 0.03, **contacts))
    largest = result.largest_stresses()
    for zone, modulus in (("low", 2.1e5), ("high", 2.1e4)):
        effective = 1 / (0.91 / 2.1e5 + 0.91 / modulus)
        peak = np.sqrt(2 * 15 * 10.0 * effective / (np.pi * 10))
        tension = 2 * 15 * 10.0 / (np.pi * 10)  # across a disk between two forces
        assert largest.shear[zone].value == pytest.approx(HERTZ[0] * peak + tension / 2, rel=1e-2)
    assert largest.shear["low"].value > 2 * largest.shear["high"].value
    assert largest.shear["beside"] is None
    assert largest.missing["shear below beside"] is NoPeak.NO_CONTACT


def heated_strip() -> Result:
    """A clamped strip of steel and brass, which heat bends onto a round stop: far from its ends stress is uniform."""

    def layer(low: float, young_modulus: float, expansion: float) -> dict:
        corners = [("bottom", 0, low), ("tip", 20, low), ("top", 20, low + 1), ("clamp", 0, low + 1)]
        return {
            "material": {"young_modulus": young_modulus, "poisson_ratio": 0.3},
            "loads": {"temperature": {"expansion": expansion, "change": 100}},
            "boundary": {"outer": [{"name": name, "start": [x, y]} for name, x, y in corners]},
            "conditions": {"clamp": {"fixed": True}},
        }

    stop = {"kind": "circle", "center": [18, -2.02], "radius": 2, "body": "outside"}
    return bemcontact.solve(bemcontact.problem({
        "name": "strip", "accuracy": 0.1,
        "bodies": {"steel": layer(0, 210e3, 12e-6), "brass": layer(1, 100e3, 19e-6)},
        "bonded": {"joint": ["steel/top", "brass/bottom"]},
        "contact_zones": {"stop": {"edges": "steel/bottom", "surface": stop}},
    }))  # fmt: skip


@pytest.mark.slow
def test_searches_that_are_left_out_would_find_nothing_larger(monkeypatch: pytest.MonkeyPatch):
    """Searches from all starts, none of which ends early, find the same maxima to less than an error bar can tell."""
    result, counted = heated_strip(), []

    climb = largest_stress._Search._climb

    def counting(self, points: np.ndarray, step: np.ndarray):
        counted.append(len(points))
        return climb(self, points, step)

    monkeypatch.setattr(largest_stress._Search, "_climb", counting)
    few, searches = largest_anew(result), sum(counted)
    counted.clear()
    for name, value in (("RISE", np.inf), ("AGAIN", 0.0), ("MEET", 0.0), ("GRAZING", 0.0)):
        monkeypatch.setattr(largest_stress, name, value)
    every = largest_anew(result)
    assert searches < sum(counted)
    assert few.inside.value == pytest.approx(every.inside.value, rel=largest_stress.TOLD_APART)
    assert few.shear["stop"].value == pytest.approx(every.shear["stop"].value, rel=largest_stress.TOLD_APART)
    assert few.missing == every.missing


@pytest.mark.slow
def test_no_search_evaluates_a_place_twice(monkeypatch: pytest.MonkeyPatch):
    """Searches evaluate the same places anew only where one comes to those of another."""
    asked, evaluate = [], largest_stress._Search._values
    monkeypatch.setattr(
        largest_stress._Search, "_values", lambda search, points: asked.append(points) or evaluate(search, points)
    )
    monkeypatch.setattr(largest_stress, "SEARCHES", 1)
    climb = largest_stress._Search._climb
    twice = []

    def alone(search, points, step):
        asked.clear()
        ends = climb(search, points, step)
        places = np.concatenate([each for each in asked if len(each)])
        near = KDTree(places).query_pairs(1e-6 * step.min())
        twice.append(len(near) / len(places))
        return ends

    monkeypatch.setattr(largest_stress._Search, "_climb", alone)
    largest_anew(indented(0.03, 1e-2)[0])
    assert max(twice) == 0
