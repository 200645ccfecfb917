"""A third body presses on two bonded ones side by side: equal ones are one, and pressure jumps between unlike ones."""

import numpy as np
import pytest
from several_bodies import block, elastic, polygon, rigid, stated

import bemcontact

DOWN = {"bottom": {"displacement": {"y": 0}}}
SHORTER = 0.001
PLATE = {"kind": "plane", "point": [0, 0], "normal": [0, -1]}


def side_by_side(plates, moduli, heat, elements):
    """Two blocks of ν = 0 that a plate makes shorter, which is one zone, two, or two contacts."""
    each = [block(x, (-6, 0), (elements,) * 4) for x in ((-6, 0), (0, 6))]
    bodies = {name: elastic(outline, DOWN, nu) for name, outline, nu in zip("lr", each, moduli, strict=True)}
    for body in bodies.values():
        body["material"]["poisson_ratio"] = 0.0
    bodies["l"]["loads"] = {"temperature": {"expansion": 1e-5, "change": heat}}
    tops = ["l/top", "r/top"]
    zones = {"one zone": {"c": tops}, "two zones": {"c": tops[:1], "d": tops[1:]}}.get(plates, {})
    spec = {"contact_zones": {name: {"edges": edges, "surface": PLATE} for name, edges in zones.items()}}
    if plates == "a body":
        bodies["plate"] = rigid(block((-8, 8), (0, 2)))
        spec = {"contacts": {name: {"between": [top, "plate/bottom"]} for name, top in zip("cd", tops, strict=True)}}
    tools = {"plate": {"zones": [*next(iter(spec.values()))], "displacement": {"y": -6 * SHORTER}}}
    glue = {"glue": ["l/right", "r/left"]}
    return bemcontact.solve(
        stated(name="side by side", bodies=bodies, bonded=glue, tools=tools, accuracy=0.003, **spec)
    )


@pytest.mark.parametrize("plates", ["one zone", "two zones", "a body"])
@pytest.mark.parametrize(("modulus", "heat"), [(3000.0, 0.0), (1000.0, 50.0), (250.0, -20.0)])
@pytest.mark.parametrize("elements", [5, None])
def test_pressure_jumps_between_unlike_bodies(plates, modulus, heat, elements):
    """P = E (ε + α ΔT) in each, as if they were not bonded: ν = 0, and both get shorter by ε."""
    result = side_by_side(plates, (1000.0, modulus), heat, elements)
    assert result.holds
    left, right = 1000 * (SHORTER + 1e-5 * heat), modulus * SHORTER
    exact = np.where(result.points[:, 0] < 0, left, right)
    np.testing.assert_allclose(result.pressure, exact, rtol=1e-10)
    assert result.peak
    assert result.peak.pressure == pytest.approx(max(left, right), rel=1e-10)
    if plates != "one zone":
        assert result.forces["c"] == pytest.approx((0, -6 * left), abs=1e-10)
        assert result.forces["d"] == pytest.approx((0, -6 * right), abs=1e-10)


RIM = {"outer": [{"name": "rim", "kind": "arc", "center": [0, 8], "radius": 8, "angles": [-140, -40]}, {"name": "top"}]}
CLAMPED = {"bottom": {"fixed": True}}
RAMS = {"rigid": rigid(RIM), "elastic": elastic(RIM, {"top": {"displacement": {"x": 0, "y": -0.05}}}, 2000.0)}


def pressed_block(ram, cut, exchanged=False):
    """A round ram on a block of two halves that are bonded at x = cut; with its top in two parts there; or whole."""
    if cut == "bond":
        halves = {
            "l": elastic(polygon(bottom=(-6, -6), cut=(0.2, -6), top=(0.2, 0), left=(-6, 0)), CLAMPED),
            "r": elastic(polygon(bottom=(0.2, -6), right=(6, -6), top=(6, 0), cut=(0.2, 0)), CLAMPED),
        }
        tops, bonded = {"c": "l/top", "d": "r/top"}, {"glue": ["l/cut", "r/cut"]}
    elif cut == "joint":
        halves = {"w": elastic(polygon(bottom=(-6, -6), right=(6, -6), r=(6, 0), l=(0.2, 0), left=(-6, 0)), CLAMPED)}
        tops, bonded = {"c": "w/l", "d": "w/r"}, {}
    else:
        halves, tops, bonded = {"w": elastic(block((-6, 6), (-6, 0)), CLAMPED)}, {"c": "w/top"}, {}
    pairs = {name: [top, "ram/rim"][:: -1 if exchanged else 1] for name, top in tops.items()}
    tools = {"ram": {"zones": [*pairs], "force": {"y": -20}}} if ram == "rigid" else {}
    contacts = {name: {"between": pair} for name, pair in pairs.items()}
    bodies = {**halves, "ram": RAMS[ram]}
    return stated(name="halves", bodies=bodies, contacts=contacts, bonded=bonded, tools=tools)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ram", "cut", "exchanged"),
    [("rigid", "bond", False), ("rigid", "joint", False), ("elastic", "bond", False), ("elastic", "bond", True)],
)
def test_a_cut_inside_contact_changes_nothing(ram, cut, exchanged):
    """Equal bodies: no pressure is infinite at the cut, and the zones of both sides follow one motion of the ram."""
    whole = bemcontact.solve(pressed_block(ram, ""), accuracy=0.02)
    halves = bemcontact.solve(pressed_block(ram, cut, exchanged), accuracy=0.02)
    assert halves.holds
    assert not halves.accuracy.infinite
    assert whole.peak
    assert halves.peak
    bars = sum(result.accuracy.peak_bar() or 0.0 for result in (whole, halves))
    assert halves.peak.pressure == pytest.approx(whole.peak.pressure, rel=bars)
    both = abs(sum(force[1] for force in halves.forces.values()))
    assert both == pytest.approx(abs(whole.forces["c"][1]), rel=bars)
    lengths = [sum(item.length for item in result.intervals) for result in (whole, halves)]
    assert lengths[1] == pytest.approx(lengths[0], rel=0.02)


@pytest.mark.slow
def test_a_slanted_cut_inside_contact_is_told_by_no_note():
    """Its acute part is no strut that buckles, and its obtuse one has no infinite pressure: the block is one."""
    cut = {
        "l": elastic(polygon(cut=(-6, -3), top=(0.2, 0), left=(-6, 0))),
        "r": elastic(polygon(bottom=(-6, -6), right=(6, -6), top=(6, 0), cut=(0.2, 0), left=(-6, -3)), CLAMPED),
    }
    contacts = {name: {"between": [top, "ram/rim"]} for name, top in (("c", "l/top"), ("d", "r/top"))}
    tools = {"ram": {"zones": ["c", "d"], "force": {"y": -20}}}
    halves = stated(
        name="slanted", bodies={**cut, "ram": RAMS["rigid"]}, contacts=contacts, bonded={"g": ["l/cut", "r/cut"]},
        tools=tools,
    )  # fmt: skip
    result = bemcontact.solve(halves, accuracy=0.02)
    assert result.holds
    assert not result.notes


@pytest.mark.slow
def test_sides_may_be_exchanged_at_a_cut_between_unlike_bodies():
    """Pairs on both sides of the bond have common normals by one share, so that they neither cross nor leave a gap."""
    forces = []
    for exchanged in (False, True):
        problem = pressed_block("elastic", "bond", exchanged).with_value("bodies.r.material.young_modulus", 2000.0)
        result = bemcontact.solve(problem, accuracy=0.03)
        assert result.certified
        forces.append([abs(force[1]) for force in result.forces.values()])
    np.testing.assert_allclose(*forces, rtol=0.005)
