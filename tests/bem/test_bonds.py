"""Bonds that end beside contact, such as a debond or a crack on the common line of two bodies; and held spins."""

from itertools import product
from math import prod

import numpy as np
import pytest
from debonds import ARRANGEMENTS, PRESSURE, halves, outline, squeezed
from several_bodies import HELD, block, elastic, polygon, problem, stated

import bemcontact
from bemcontact.analysis.solve import solve
from bemcontact.bem.condense import boundary_state, condense
from bemcontact.bem.discretization import body_of
from bemcontact.errors import ProblemError


def worst_of(result, exact):
    return float(np.abs(result.solution.pressure / exact - 1).max())


@pytest.mark.slow
@pytest.mark.parametrize("kinds", ARRANGEMENTS)
@pytest.mark.parametrize(
    "seen",
    [{}, {"turn": 0.7}, {"turn": -2.2}, {"mirror": True}, {"scale": 1e-3, "stress": 1e6}, {"n": 1}],
    ids=["as drawn", "turned", "turned on", "mirrored", "in other units", "on few elements"],
)  # fmt: skip
def test_uniform_pressure_on_a_debond_is_exact(kinds, seen):
    """The stress of the whole block: a linear displacement, which elements of any size have."""
    result = bemcontact.solve(halves(kinds, squeezed(seen.get("stress", 1.0)), **seen))
    assert result.certified
    assert result.certificate.kind.value == "unique"
    assert worst_of(result, PRESSURE * seen.get("stress", 1.0)) < 1e-10
    assert not any("behind" in note or "zone" in note for note in result.notes)


@pytest.mark.parametrize("formulation", ["qp1", "qp2", "qp3", "complementarity"])
def test_every_formulation_certifies_a_debond(formulation):
    """Its tip is no contact point: a gap that is zero at any pressure would leave the pressure free."""
    result = bemcontact.solve(halves("cbc", squeezed()), formulation=formulation)
    assert result.certified
    assert worst_of(result, PRESSURE) < 1e-9


def test_a_fluid_around_a_kinked_interface_presses_uniformly_on_the_debond():
    """Hydrostatic pressure strains bodies alike that have the same (1 + ν) (1 - 2 ν) / E: nothing slides or opens."""
    fluid, elements = {"pressure": PRESSURE}, 3
    lower = [("left", (-2, 0), 4), ("bottom", (-2, -2), 8), ("right", (2, -2), 6), ("top", (2, 1), 4)]
    lower += [("wall", (0, 1), elements), ("floor", (0, 0), 4)]
    upper = [("floor", (-2, 0), 4), ("wall", (0, 0), elements), ("top", (0, 1), 4), ("left", (-2, 1), elements)]

    def strained(ratio):
        return (1 + ratio) * (1 - 2 * ratio)

    material = {"young_modulus": 1000.0 * strained(0.1) / strained(0.3), "poisson_ratio": 0.1}
    for bonded, touching in (("floor", "wall"), ("wall", "floor")):
        spec = stated(
            name="step",
            bodies={
                "low": elastic(outline(lower), dict.fromkeys(("left", "bottom", "right", "top"), fluid)),
                "up": {**elastic(outline(upper), {"top": fluid, "left": fluid}), "material": material},
            },
            bonded={"glue": [f"up/{bonded}", f"low/{bonded}"]},
            contacts={"step": {"between": [f"up/{touching}", f"low/{touching}"]}},
            accuracy=None,
        )  # fmt: skip
        result = bemcontact.solve(spec)
        assert result.certified
        assert worst_of(result, PRESSURE) < 1e-10


STEPPED = {
    "a": {"bottom": (-4, -4), "right": (4, -4), "top": (4, 4), "wall": (1, 4), "step": (1, 1), "left": (-4, 1)},
    "b": {"step": (-4, 1), "wall": (1, 1), "top": (1, 4), "left": (-4, 4)},
}
THREE = {
    "a": {"bottom": (-4, -4), "right": (4, -4), "step": (4, 1), "foot": (1, 1), "left": (-4, 1)},
    "b": {"foot": (-4, 1), "wall": (1, 1), "top": (1, 4), "left": (-4, 4)},
    "c": {"step": (1, 1), "right": (4, 1), "top": (4, 4), "wall": (1, 4)},
}
FOUR = {
    "a": {"bottom": (-4, -4), "wall": (1, -4), "step": (1, 1), "left": (-4, 1)},
    "b": {"under": (1, -4), "right": (4, -4), "foot": (4, 1), "wall": (1, 1)},
    "c": {"step": (-4, 1), "beam": (1, 1), "top": (1, 4), "left": (-4, 4)},
    "d": {"foot": (1, 1), "right": (4, 1), "top": (4, 4), "beam": (1, 4)},
}
"""Outlines whose interfaces have a corner, or meet at a place: edges of one name coincide."""
FLOOR = {"floor": {"edges": "a/bottom", "surface": {"kind": "plane", "point": [0, -4], "normal": [0, 1]}}}


@pytest.mark.parametrize("loose", ["", "wall"])
@pytest.mark.parametrize(
    ("outlines", "orders"),
    [
        pytest.param(
            outlines, orders, id=f"{name} {orders}", marks=[pytest.mark.slow] * (count > 2 and prod(orders) < 0)
        )
        for name, outlines, count in (("a corner", STEPPED, 2), ("three bodies", THREE, 3), ("four bodies", FOUR, 3))
        for orders in product((1, -1), repeat=count)
    ],
)
def test_a_fluid_around_a_corner_of_an_interface_presses_uniformly(outlines, orders, loose):
    """Whichever side of each bond is the first, and whether or not one is a contact instead.

    Of three bonds, orders with an even number of exchanges have each pair of orders of two bonds. The others are slow.
    """
    sides = {}
    for body, edges in outlines.items():
        for edge in {"beam", "foot", "step", "wall"} & {*edges}:
            sides.setdefault(edge, []).append(f"{body}/{edge}")
    pairs = {edge: sides[edge][::order] for edge, order in zip(sorted(sides), (*orders, 1), strict=False)}
    fluid = {edge: {"pressure": PRESSURE} for edge in ("top", "left", "right", "under")}
    spec = stated(
        name="corner",
        bodies={
            body: elastic(polygon(**edges), {edge: load for edge, load in fluid.items() if edge in edges})
            for body, edges in outlines.items()
        },
        bonded={edge: pair for edge, pair in pairs.items() if edge != loose},
        contacts={edge: {"between": pair} for edge, pair in pairs.items() if edge == loose},
        contact_zones=FLOOR,
        accuracy=0.01,
    )  # fmt: skip
    result = bemcontact.solve(spec)
    assert result.holds
    assert worst_of(result, PRESSURE) < 1e-10
    places = [[1.0, 0.98], [0.98, 1.02], [1.02, 1.02], [0.0, 0.0], [3.0, 3.0]]
    stress = result.stress(places).components
    np.testing.assert_allclose(stress, np.tile([-PRESSURE, -PRESSURE, 0], (5, 1)), atol=1e-6 * PRESSURE)


@pytest.mark.slow
def test_a_corner_of_an_interface_of_equal_bodies_is_no_place():
    """A roller presses on a block: stress beside the corner of a bonded part is that of one block."""
    outer = {"bottom": (-4, -4), "right": (4, -4), "top": (4, 4), "left": (-4, 4)}
    roller = {"kind": "circle", "center": [2, 12], "radius": 8, "body": "outside"}
    found = []
    for outlines in ({"a": outer}, STEPPED):
        bodies = {body: elastic(polygon(**edges)) for body, edges in outlines.items()}
        bodies["a"]["conditions"] = {"bottom": {"fixed": True}}
        bonds = {edge: [f"a/{edge}", f"b/{edge}"] for edge in ("step", "wall") if "b" in bodies}
        zones = {"rim": {"edges": "a/top", "surface": roller}}
        tools = {"roller": {"zones": "rim", "force": {"y": -20}}}
        result = bemcontact.solve(
            stated(name="step", bodies=bodies, bonded=bonds, contact_zones=zones, tools=tools, accuracy=0.01)
        )
        assert result.holds
        found.append(result.stress([[0.9, 0.9], [1.1, 1.1], [0.9, 1.1], [1.2, 0.5], [0.0, 1.2]]).components)
    assert abs(found[1] - found[0]).max() < 0.01 * abs(found[0]).max()


def mirrored_load(top, bottom):
    """Loads on both blocks that are mirror images in their common line."""
    return {"top": top, "left": {"displacement": {"x": 0}}}, {"bottom": bottom, "left": {"displacement": {"x": 0}}}


def beside_a_half(kinds, slope, n):
    """Largest differences of pressures and gaps of two equal halves from those of one of them on a rigid plane."""
    load = {"pressure": {"constant": PRESSURE, "x": slope}}
    both = bemcontact.solve(halves(kinds, mirrored_load(load, load), n=n))
    one = both.problem.bodies["up"]
    bonded, touching = ([f"i{j}" for j, kind in enumerate(kinds) if kind == its] for its in "bc")
    plane = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    half = bemcontact.solve(
        stated(
            name="half", material=one.material, boundary=one.boundary, accuracy=None,
            conditions={**mirrored_load(load, load)[0], **{name: {"displacement": {"y": 0}} for name in bonded}},
            contact_zones={f"c{name[1:]}": {"edges": name, "surface": plane} for name in touching},
        )
    )  # fmt: skip
    assert both.certified
    assert half.certified
    gaps = both.solution.displacement - 2 * half.solution.displacement
    pressures = both.solution.pressure - half.solution.pressure
    scales = half.solution.pressure.max(), half.contact.scales.displacement
    return [float(np.abs(part).max() / scale) for part, scale in zip((pressures, gaps), scales, strict=True)]


@pytest.mark.slow
@pytest.mark.parametrize("kinds", ARRANGEMENTS)
@pytest.mark.parametrize("slope", [1.0, -4.0])
def test_equal_halves_are_one_of_them_on_a_plane(kinds, slope):
    """A symmetric state has no displacement across the bond, and the debond closes on the plane, open in part or not.

    Forces on the held edge balance up to the slack of the discrete equations, those of the bond exactly. This slack
    falls with the elements; where contact opens beside the tip, it is much larger there than elsewhere.
    """
    coarse, fine = (beside_a_half(kinds, slope, n) for n in (4, 8))
    assert max(coarse) < 5e-3
    assert fine[0] < coarse[0] / 2
    assert fine[1] < max(coarse[1] / 2, 1e-14)


PLATE = 20.0
"""Half of the width and of the height of a plate over half of the length of its crack."""


def crack(load, n):
    """Solve a plate with a crack between two halves, 2 n elements in it, under tractions (x, y) as on its upper side.

    Beyond the tips elements grow as far as they are from them. Returns places from the middle, and gaps and slips over
    those of a plate without ends, 4 σ/E' sqrt(a² - x²).
    """
    grown = [1.0]
    while grown[-1] < PLATE:
        grown.append(grown[-1] + min(1.0, max(1 / n, 0.5 * (grown[-1] - 1))))
    beyond = ((np.array(grown[1:-1]) - 1) / (PLATE - 1)).tolist()
    toward = [1 - at for at in beyond[::-1]]
    x, y = load

    def half(sign):
        line = [("l", -1.0 * PLATE, toward), ("c", -1.0, 2 * n), ("r", 1.0, beyond)]
        rest = [("right", PLATE, 0.0), ("far", PLATE, PLATE), ("left", -PLATE, PLATE)]
        edges = [{"name": name, "start": [sign * at, 0], **_divided(own)} for name, at, own in line]
        edges += [{"name": name, "start": [sign * at, sign * up], "elements": 4} for name, at, up in rest]
        loads = {"far": (x, y), "right": (0.0, x), "left": (0.0, -x)}
        tractions = {name: {"traction": {"x": sign * tx, "y": sign * ty}} for name, (tx, ty) in loads.items()}
        return elastic({"outer": edges}, tractions)

    spec = stated(
        name="crack", bodies={"up": half(1), "low": half(-1)}, accuracy=None,
        bonded={"left": ["up/l", "low/r"], "right": ["up/r", "low/l"]}, contacts={"c": {"between": ["up/c", "low/c"]}},
    )  # fmt: skip
    result = bemcontact.solve(spec)
    assert result.certified
    state, places = result.boundary, result.contact.points[:, 0]
    on = [state.edge == state.edge_names.index(name) for name in ("up/c", "low/c")]
    moved = [
        dict(zip(state.points[own, :, 0].ravel(), state.displacement[own].reshape(-1, 2), strict=True)) for own in on
    ]
    slips = np.array([moved[0][at] - moved[1][min(moved[1], key=lambda other: abs(other - at))] for at in places])
    exact = 4 * np.hypot(*load) / (1000.0 / (1 - 0.3**2)) * np.sqrt(1 - places**2)
    return result, places, (result.contact.initial_gap + result.solution.displacement) / exact, slips[:, 0] / exact


def _divided(at):
    return {"elements": at} if isinstance(at, int) else {"elements": len(at) + 1, "ends_at": at}


def far_from_tips(values, places):
    """Largest difference from one where the tips are farther than an eighth of the crack."""
    return float(np.abs(values[np.abs(places) < 0.75] - 1).max())


def assert_of_order_one(errors):
    """Elements of one length follow the stress s^(-1/2) before the tip with an error like their length."""
    assert errors[-1] < 0.01
    assert errors[1] < errors[0] / 1.7
    assert errors[2] < errors[1] / 1.9


def test_an_open_crack_has_the_opening_of_the_closed_form():
    """2 u = 4 σ/E' sqrt(a² - x²) in a plate without ends (Westergaard); with ends K is larger by sqrt(sec(π a/2W))."""
    errors = []
    for n in (4, 8, 16):
        result, places, opening, _ = crack((0.0, 1.0), n)
        assert not result.solution.pressure.any()
        errors.append(far_from_tips(opening / np.sqrt(1 / np.cos(np.pi / 2 / PLATE)), places))
    assert_of_order_one(errors)


def test_a_closed_crack_slides_as_an_open_one_opens():
    """Frictionless, under pressure σ and shear τ: pressure σ, as without a crack, and slip 4 τ/E' sqrt(a² - x²).

    Ends of the plate change the slip by a part of (a/W)² = 0.25 %.
    """
    errors = []
    for n in (4, 8, 16):
        result, places, _, slip = crack((1.0, -1.0), n)
        assert worst_of(result, 1.0) < 1e-10
        errors.append(far_from_tips(slip * 2**0.5, places))
    assert_of_order_one(errors)


MIDDLE = np.array([0.3, 2.0])


def disk_between_blocks(modulus, *, bore=False, load=None):
    rim = {"name": "rim", "kind": "arc", "center": MIDDLE.tolist(), "radius": 2, "angles": [80, 440], "elements": 61}
    hole = {"name": "bore", "kind": "arc", "center": [0.6, 2.5], "radius": 0.5, "angles": [360, 0], "elements": 10}
    bodies = {
        "disk": elastic({"outer": [rim], "holes": [[hole]] if bore else []}, {"bore": load} if load else {}, modulus),
        "base": elastic(block((-2, 4), (-3, 0), (40, 6, 40, 6)), HELD),
        "lid": elastic(block((-1, 5), (4, 6), (40, 6, 40, 6)), {"top": {"displacement": {"x": 0, "y": -0.02}}}),
    }
    return problem(bodies, low=["disk", "base"], high=["disk", "lid"])


@pytest.mark.parametrize("bore", [False, True])
@pytest.mark.parametrize("modulus", [10.0, 1000.0, 1e6])
def test_a_disk_that_might_spin_is_in_equilibrium_and_does_not_spin(modulus, bore):
    """Common normals miss its center; traction around the center makes up for it, and has no force."""
    condensation = condense(body_of(disk_between_blocks(modulus, bore=bore)))
    solution = solve(condensation.contact).solution
    state = boundary_state(condensation, solution.pressure, solution.rigid_amplitudes)
    disk = condensation.body.mesh.parts[0]
    arms, length = state.points[disk.elements] - MIDDLE, disk.mesh.tributary
    around, t = np.stack([-arms[..., 1], arms[..., 0]], axis=-1), state.traction[disk.elements]
    total = (length * np.hypot(*np.moveaxis(t, 2, 0))).sum()
    assert np.abs(np.einsum("mk,mki->i", length, t)).max() < 1e-11 * total
    assert abs(np.einsum("mk,mki,mki->", length, t, around)) < 1e-12 * total
    spin = around - np.average(around.reshape(-1, 2), axis=0, weights=length.ravel())
    u = state.displacement[disk.elements]
    assert abs(np.einsum("mk,mki,mki->", length, u, spin)) < 1e-11 * np.einsum("mk,mki->", length, abs(u))


def test_compliance_of_a_disk_that_might_spin_is_as_symmetric_as_that_of_a_held_one():
    """With the weights it is symmetric up to discretization; what holds the spin adds nothing to that."""
    free, held = (
        condense(body_of(disk_between_blocks(1000.0, bore=True, load=load))).contact for load in (None, {"fixed": True})
    )
    errors = []
    for contact in (free, held):
        forces = contact.weights[:, None] * contact.compliance
        errors.append(abs(forces - forces.T).max() / abs(forces).max())
    assert errors[0] < 1.1 * errors[1]


def test_a_couple_on_a_disk_that_might_spin_is_refused():
    """Nothing holds it. A pressure on a bore beside the middle has no force and no couple."""
    body_of(disk_between_blocks(1000.0, bore=True, load={"pressure": 1.0}))
    with pytest.raises(ProblemError, match=r"nothing holds the body 'disk' against the rotation .* about \(0.3, 2\)"):
        body_of(disk_between_blocks(1000.0, bore=True, load={"traction": {"x": {"constant": 0.0, "y": 1.0}}}))
