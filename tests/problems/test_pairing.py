"""Which parts of edges are opposite to each other."""

import numpy as np
import pytest
from several_bodies import HELD, block, circle, elastic, polygon, problem, rigid

from bemcontact.problems import edge_places
from bemcontact.problems.body_surface import BodySurface


def parts(first, second, pair=("up/bottom", "low/top")):
    spec = problem({"up": elastic(first), "low": second}, accuracy=0.01, touch=list(pair))
    return [(part.edge, part.low, part.high) for part in spec.opposite("touch")]


@pytest.mark.parametrize(
    ("x", "low", "high"),
    [((0, 4), 0.0, 1.0), ((1, 3), 0.25, 0.75), ((-1, 5), 0.0, 1.0), ((2, 6), 0.5, 1.0), ((-4, 1), 0.0, 0.25)],
)
def test_parts_end_where_the_other_edge_ends(x, low, high):
    """The first edge is from 0 to 4. Its closest points beyond the ends of the other one would be corners."""
    [(edge, begin, end)] = parts(block((0, 4), (0, 1)), elastic(block(x, (-1, 0))))
    assert (edge, begin, end) == ("up/bottom", pytest.approx(low, abs=1e-9), pytest.approx(high, abs=1e-9))


def test_named_rims_beside_each_other_reach_as_far_as_whole_bodies():
    """Pairs far up the rims, where both cannot touch the block, would be on one part of it."""
    bodies = {
        "r1": elastic({"outer": [{**circle("rim", 2.0), "center": [-3, 2]}]}),
        "r2": elastic({"outer": [{**circle("rim", 2.0), "center": [3, 2]}]}),
        "block": elastic(block((-9, 9), (-4, 0)), HELD, 100.0),
    }
    named, whole = (
        problem(bodies, 0.01, c1=[f"r1{rim}", f"block{top}"], c2=[f"r2{rim}", f"block{top}"])
        for rim, top in (("/rim", "/top"), ("", ""))
    )
    alone = problem({name: bodies[name] for name in ("r1", "block")}, 0.01, c1=["r1/rim", "block/top"])
    for contact in ("c1", "c2"):
        parts_of_both = [[part[:3] for part in stated.opposite(contact)] for stated in (named, whole)]
        assert parts_of_both[0] == parts_of_both[1]
    assert sum(part.high - part.low for part in alone.opposite("c1")) == pytest.approx(1 / 3, abs=1e-6)  # 60 degrees


def test_a_slot_in_the_other_body_leaves_two_parts():
    legs = polygon(
        bottom=(0, -3), right=(4, -3), top=(4, 0), inner=(3, 0), floor=(3, -2), wall=(1, -2), **{"other top": (1, 0)},
        left=(0, 0),
    )  # fmt: skip
    found = parts(block((0, 4), (0, 1)), elastic(legs), ("up/bottom", "low"))
    assert np.allclose([part[1:] for part in found], [(0, 0.25), (0.75, 1)])


@pytest.mark.parametrize("width", [0.05, 1e-5, 1e-7])
@pytest.mark.parametrize(
    "pair", [["w/top", ["d/narrow", "d/wide"]], [["d/narrow", "d/wide"], "w/top"], ["w", "d"], ["d", "w"]]
)
@pytest.mark.parametrize("lift", [0.0, 0.2])
def test_a_foot_is_found_however_narrow_it_is_beside_the_other_edge(width, pair, lift):
    """Of an edge of 70, opposite to feet of 3 and of a width. The pairs of a foot are straight below it."""
    feet = polygon(
        narrow=(-3, lift), one=(width - 3, lift), middle=(width - 3, 0.5), two=(1, 0.5), wide=(1, lift + 0.01),
        three=(4, lift + 0.01), top=(4, 2), four=(-3, 2),
    )  # fmt: skip
    spec = problem({"d": elastic(feet), "w": elastic(block((-40, 30), (-20, 0)))}, accuracy=0.05, c=pair)
    parts = [(part.high - part.low) * spec.edge(part.edge).length for part in spec.opposite("c")]
    assert sorted(parts) == [pytest.approx(width, abs=1e-10), pytest.approx(3, abs=1e-10)]
    onto = spec.zones["c"].surface
    assert isinstance(onto, BodySurface)
    assert abs(onto.approach[1]) == pytest.approx(lift, abs=1e-9)  # of the narrow foot, which is lower


@pytest.mark.parametrize("pair", [["w/top", "d"], ["d", "w/top"]])
def test_each_tooth_of_a_rigid_comb_is_found(pair):
    """Twelve teeth of 0.001 at distances of 0.9, and between them a ceiling."""
    teeth, x = dict[str, tuple[float, float]](), 0.0
    for i in range(12):
        x = 0.9 * i - 5
        teeth |= {f"tooth {i}": (x, 0), f"right {i}": (x + 1e-3, 0)}
        if i < 11:
            teeth |= {f"ceiling {i}": (x + 1e-3, 9), f"left {i}": (x + 0.9, 9)}
    comb = polygon(**teeth, top=(x + 1e-3, 11), side=(-5, 11))
    spec = problem({"d": rigid(comb), "w": elastic(block((-50, 50), (-20, 0)))}, accuracy=0.05, c=pair)
    onto = spec.zones["c"].surface
    assert isinstance(onto, BodySurface)
    under = [part for part in spec.opposite("c") if "tooth" in onto.edges[part.onto].name]
    assert [100 * (part.high - part.low) for part in under] == 12 * [pytest.approx(1e-3, abs=1e-6)]


@pytest.mark.parametrize("pair", [["w/top", "d/under"], ["d/under", "w/top"]])
def test_a_small_disk_is_opposite_to_a_long_edge(pair):
    """A half disk of radius 0.03 on an edge of 70: the pairs are where it is turned by less than 60 degrees."""
    disk = {"outer": [{"name": "under", "kind": "arc", "start": [-0.03, 0.03], "end": [0.03, 0.03],
                       "center": [0, 0.03]}, {"name": "top", "end": [-0.03, 0.03]}]}  # fmt: skip
    spec = problem({"d": elastic(disk), "w": elastic(block((-40, 30), (-40, 0)))}, accuracy=0.05, c=pair)
    (part,) = spec.opposite("c")
    if pair[0] == "d/under":
        assert (part.low, part.high) == (pytest.approx(1 / 6, abs=1e-9), pytest.approx(5 / 6, abs=1e-9))
    else:
        onto = spec.zones["c"].surface
        assert isinstance(onto, BodySurface)
        ends = onto.pairs(spec.edge("w/top").points(np.array([part.low, part.high]))).fraction
        assert np.sort(ends) == pytest.approx([1 / 6, 5 / 6], abs=1e-6)


@pytest.mark.parametrize("start", [0.0, 37.0, -90.0])
def test_all_of_a_circle_is_opposite_to_a_bore_wherever_both_begin(start):
    plate = {**block((-9, 9), (-9, 9)), "holes": [[circle("bore", 5.1, start=120, hole=True)]]}
    found = parts({"outer": [circle("rim", 5, start=start)]}, elastic(plate), ("up/rim", "low/bore"))
    assert sum(high - low for _, low, high in found) == pytest.approx(1.0, abs=1e-9)


def test_a_blunt_corner_of_a_rigid_body_is_within_one_part():
    roof = polygon(left=(1, 0), under=(-2, -0.3), right=(4, -0.3))
    ends = [end for part in parts(block((0, 2), (0.1, 1)), rigid(roof), ("up/bottom", "low")) for end in part[1:]]
    assert min(ends) == 0
    assert max(ends) == 1


@pytest.mark.parametrize("pair", [("up/bottom", "low"), ("low", "up/bottom")])
def test_parts_meet_at_the_normal_of_the_other_side_at_a_corner_across_a_gap(pair):
    """A corner has two normals, so that the common one there is that of the other side: vertical."""
    roof = polygon(left=(1, 0), under=(-2, -0.3), right=(4, -0.3))
    spec = problem({"up": elastic(block((0, 2), (0.1, 1))), "low": elastic(roof)}, accuracy=0.01, touch=list(pair))
    onto = spec.zones["touch"].surface
    assert isinstance(onto, BodySurface)
    places = np.array([[1.0, 0.1]] if pair[0] == "up/bottom" else [[1.0, 0.0]])
    found = onto.pairs(places)
    assert np.allclose(abs(found.normals), [[0, 1]], atol=1e-12)
    assert np.allclose(found.points[:, 0], 1.0, atol=1e-12)
    ends = sorted(end for part in spec.opposite("touch") for end in part[1:3])
    assert len(ends) == 4
    if pair[0] == "up/bottom":
        assert ends[1] == pytest.approx(0.5, abs=1e-9)
        assert ends[2] == pytest.approx(0.5, abs=1e-9)


BELOW = {
    "circle": {"outer": [{"name": "rim", "kind": "arc", "center": [0, -7], "radius": 7, "angles": [0, 360]}]},
    "ellipse": {
        "outer": [{"name": "rim", "kind": "ellipse", "center": [0, -2], "semi_axes": [5, 2], "angles": [0, 360]}]
    },
    "bore": {
        **block((-40, 40), (-40, 40)),
        "holes": [[{"name": "rim", "kind": "arc", "center": [0, 9], "radius": 9, "angles": [0, -360]}]],
    },
}
FIXED = {"displacement": {"x": 0, "y": 0}}
DISK = {"outer": [{"name": "rim", "kind": "arc", "center": [0, 5], "radius": 5, "angles": [0, 360]}]}


def halves(circle, upper, lower):
    return [{**circle, "name": upper, "angles": [0, 180]}, {**circle, "name": lower, "angles": [180, 360]}]


@pytest.mark.parametrize(
    ("below", "modulus"), [*((name, E) for name in ("circle", "bore") for E in (50.0, 1000.0, 1e5)), ("ellipse", 50.0)]
)
def test_pairs_are_the_same_whichever_side_is_first(below, modulus):
    """Each point is the pair of its pair. Both are on their common normal, which is opposite in the other order."""
    up = {"outer": halves(DISK["outer"][0], "top", "rim")}
    low = {"outer": halves(BELOW["circle"]["outer"][0], "rim", "bottom")} if below == "circle" else BELOW[below]
    held = {"bottom": FIXED} if below != "ellipse" else {}  # a circle that may spin has a least part of the normals
    bodies = {"up": elastic(up, {"top": FIXED}, modulus), "low": elastic(low, held)}
    there, back = (
        problem(bodies, accuracy=0.01, touch=pair).zones["touch"].surface
        for pair in (["up/rim", "low/rim"], ["low/rim", "up/rim"])
    )
    assert isinstance(there, BodySurface)
    assert isinstance(back, BodySurface)
    angle = np.linspace(-0.4, 0.4, 33)
    points = np.column_stack([5 * np.sin(angle), 5 - 5 * np.cos(angle)])
    pairs = there.pairs(points)
    again = back.pairs(pairs.points)
    assert np.abs(again.points - points).max() < 1e-11
    assert np.abs(again.normals + pairs.normals).max() < 1e-12
    assert np.abs(points - pairs.points - pairs.gap[:, None] * pairs.normals).max() < 1e-12
    toward = modulus / (modulus + 1000)  # of equal Poisson's ratios, the moduli are those of Hertz
    mean = toward * (np.array([0, 5]) - points) / 5 + (1 - toward) * there.edges[pairs.edge[0]].normals(pairs.fraction)
    assert np.abs(pairs.normals[:, 0] * mean[:, 1] - pairs.normals[:, 1] * mean[:, 0]).max() < 1e-12


def test_edges_that_cannot_come_to_touch_form_no_pairs():
    """Sides that are steeper against each other than 60 degrees need displacements that are not small."""
    bodies = {"up": elastic(DISK), "low": elastic(block((-40, 40), (-9, 0)))}
    (part,) = problem(bodies, accuracy=0.01, touch=["up/rim", "low/top"]).opposite("touch")
    assert (part.low, part.high) == (pytest.approx(7 / 12), pytest.approx(11 / 12))  # 30 degrees below the horizontal


def test_an_edge_without_a_pair_is_looked_at_once(monkeypatch):
    """Beside the end of a narrow edge no place of it is on a common normal, whatever the start on this edge."""
    bodies = {"up": elastic(DISK), "low": elastic(block((-1, 1), (-9, 0)))}
    surface = problem(bodies, accuracy=0.01, touch=["up/rim", "low/top"]).zones["touch"].surface
    assert isinstance(surface, BodySurface)
    searched, search = [], edge_places._on_edge
    monkeypatch.setattr(edge_places, "_on_edge", lambda edge, *at: searched.append(edge.name) or search(edge, *at))
    found = surface.pairs(np.array([[3.0, 1.0]]))
    assert found.corner.all()
    assert searched == ["low/top"]


@pytest.mark.parametrize("pair", [["up/rim", "low/top"], ["low/top", "up/rim"]])
def test_pairs_do_not_jump_where_a_part_ends(pair):
    """A node at the end of a part is beyond it by round-off, and keeps its pair."""
    bodies = {"up": elastic(DISK), "low": elastic(block((-40, 40), (-9, 0)))}
    spec = problem(bodies, accuracy=0.01, touch=pair)
    (part,), surface = spec.opposite("touch"), spec.zones["touch"].surface
    assert isinstance(surface, BodySurface)
    for end, way in ((part.low, -1), (part.high, 1)):
        found = surface.pairs(spec.edge(part.edge).points(end + way * np.array([-1e-9, 1e-9])))
        assert found.corner.tolist() == [False, True]
        assert np.abs(np.diff(found.points, axis=0)).max() < 1e-5


@pytest.mark.parametrize(("modulus", "share"), [(1e3, 0.5), (3e3, 0.25), (1e7, 0.05), (1.0, 0.95)])
def test_disks_that_may_spin_share_their_normals_by_their_moduli(modulus, share):
    """Of either of them at least a twentieth counts, which holds it beside the other one."""
    rims = [{**circle("rim", 2.0), "center": [0, 2]}, {**circle("rim", 3.0), "center": [0, -3]}]
    bodies = {"up": elastic({"outer": rims[:1]}), "low": elastic({"outer": rims[1:]}, modulus=modulus)}
    there, back = (
        problem(bodies, 0.01, c=pair).zones["c"].surface for pair in (["up/rim", "low/rim"], ["low/rim", "up/rim"])
    )
    assert isinstance(there, BodySurface)
    assert isinstance(back, BodySurface)
    assert (there.share, back.share) == pytest.approx((share, 1 - share))


@pytest.mark.parametrize("squeezed", [0.0, 0.05, 0.4])
def test_a_ring_that_is_squeezed_on_the_floor_of_a_groove_may_touch_its_walls(squeezed):
    """The floor is drawn inside the ring; the walls touch it as drawn, however deep that is."""
    groove = polygon(
        bottom=(-6, -6), right=(6, -6), shoulder=(6, 1), wall=(2, 1), floor=(2, squeezed - 2),
        other_wall=(-2, squeezed - 2), other=(-2, 1), left=(-6, 1),
    )  # fmt: skip
    bodies = {"ring": elastic({"outer": [circle("rim", 2.0)]}, modulus=10.0), "groove": elastic(groove, HELD, 1e4)}
    stated = problem(bodies, accuracy=0.01, c=["ring", "groove"])
    surface = stated.zones["c"].surface
    assert isinstance(surface, BodySurface)
    touched = {surface.edges[part.onto].name for part in stated.opposite("c")}
    assert touched == {"groove/floor", "groove/wall", "groove/other_wall"}
