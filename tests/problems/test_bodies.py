"""Several bodies as they are stated: what each mistake is told, and what copies are."""

import math

import numpy as np
import pytest
from messages import assert_states
from several_bodies import HELD, block, circle, elastic, problem, stated

import bemcontact
from bemcontact.errors import ProblemError

SPEC = """\
name: two blocks
materials: {steel: {young_modulus: 1000, poisson_ratio: 0.3}}
bodies:
  up:
    material: steel
    boundary:
      outer:
        - {name: bottom, start: [0, 0], end: [2, 0]}
        - {name: right, end: [2, 1]}
        - {name: top, end: [0, 1]}
        - {name: left}
    conditions: {left: {displacement: {x: 0}}, top: {pressure: 1}}
  low:
    material: {young_modulus: 500, poisson_ratio: 0.3}
    boundary:
      outer:
        - {name: bottom, start: [-1, -1], end: [3, -1]}
        - {name: right, end: [3, 0]}
        - {name: top, end: [-1, 0]}
        - {name: left}
    conditions: {bottom: {displacement: {x: 0, y: 0}}}
contacts:
  face: {between: [up/bottom, low/top]}
"""
BETWEEN = "[up/bottom, low/top]"
COPY = "{copy_of: up, shift: [0, -1], conditions: {bottom: {displacement: {x: 0, y: 0}}}}"


def with_contour(edges: str, condition: str, more: str = "") -> str:
    surface = f"{{kind: deflected_contour, direction: [0, -1], conditions: {{{condition}: {{pressure: 2}}}}}}"
    return SPEC + f"contact_zones:\n  roof:\n    edges: {edges}\n    surface: {surface}\n{more}"


def with_copy(stated: str) -> str:
    return SPEC[: SPEC.index("  low:")] + f"  low: {stated}\ncontacts: {{face: {{between: [up, low]}}}}\n"


MISTAKES = [
    (SPEC.replace(BETWEEN, "up/bottom"), "23:19: contacts.face.between", "two bodies…BODY/EDGE…the text 'up/bottom'"),
    (SPEC.replace(BETWEEN, "[up, low, up]"), "23:19: contacts.face.between", "a list of 3"),
    (SPEC.replace(BETWEEN, "[upp, low]"), "23:20: contacts.face.between[0]", "unknown body 'upp'…did you mean 'up'"),
    (SPEC.replace(BETWEEN, "[up/botom, low]"), "23:20: contacts.face.between[0]", "'up/botom'…'up/bottom'"),
    (SPEC.replace(BETWEEN, "[up, up]"), "23:19: contacts.face.between", "'up' is on both sides"),
    (SPEC.replace(BETWEEN, "[up/top, low]"), "23:20: contacts.face.between[0]", "'up/top' has a condition…remove"),
    (SPEC.replace(BETWEEN, "[[up/bottom, low/left], low/top]"), "23:20: contacts.face.between[0]", "of one body"),
    (SPEC.replace(BETWEEN, "[up/bottom, low/right]"), "23:19: contacts.face.between", "nowhere opposite"),
    (SPEC.replace(BETWEEN, "[up/right, low/left]"), "23:19: contacts.face.between", "nowhere opposite"),
    (SPEC + f"  again: {{between: {BETWEEN}}}\n", "24:20: contacts.again.between", "stated by 'face' already"),
    (SPEC + "  again: {between: [low/top, up/bottom]}\n", "24:20: contacts.again.between", "stated by 'face' already"),
    (SPEC.replace(BETWEEN, f"{BETWEEN}, clearance: 1"), "23:41: contacts.face.clearance", "gap is the clearance"),
    (SPEC.replace(BETWEEN, f"{BETWEEN}, friction: 1"), "23:41: contacts.face.friction", "contact is without friction"),
    (SPEC.replace(BETWEEN, "[up.bottom, low/top]"), "23:19: contacts.face.between", "write 'up/bottom' for"),
    (SPEC.replace(BETWEEN, "[up bottom, low/top]"), "23:20: contacts.face.between[0]", "write 'up/bottom' for 'up bot"),
    (SPEC + "bonded: {glue: {between: [up/right, low/right]}}\n", "24:16: bonded.glue", "such as [roller…mapping"),
    (SPEC.replace("bodies:", "body:"), "3:1: body", "unknown key 'body'; bodies has several bodies by name"),
    (SPEC + "load_cases: {a: {conditions: {top: {pressure: 1}}}}\n", "24:31: load_cases.a.conditions.top",
     "write 'up/top' or 'low/top'"),
    (SPEC + "contact_zones: {z: {edges: low, surface: {kind: plane, point: [0, -1], normal: [0, 1]}}}\n",
     "24:28: contact_zones.z.edges", "'low' is a body; name its edges: low/bottom, low/right"),
    (with_copy(COPY.replace("shift:", "mirror: x, shift:")), "13:22: bodies.low.mirror", "not mirrored; state"),
    (SPEC + "bonded: {glue: [up/top, low/right]}\n", "24:17: bonded.glue[0]", "'up/top' has a condition…be bonded"),
    ("name: two\nbodies: {}\ncontacts: {face: {between: [up, low]}}\n", "2:9: bodies", "bodies is empty; give each"),
    ("name: two\nbodies:\ncontacts: {face: {between: [up, low]}}\n", "2:8: bodies", "expected a mapping…found nothing"),
    (SPEC + "units: {length: mm, pressure: GPa}\n", "24:21: units.pressure", "only length and force; pressures"),
    (SPEC[: SPEC.index("contacts:")], "1:1: contacts", "nothing touches"),
    (SPEC.replace("material: steel", "material: stel"), "5:15: bodies.up.material", "did you mean 'steel'"),
    (SPEC.replace("material: steel", "rotate: 3"), "4:3: bodies.up", "copy_of"),
    (SPEC.replace("  up:", "  up/er:").replace("up/bot", "up/er/bot"), "4:3: bodies.up/er", "must not contain /"),
    (SPEC.replace("{left: {d", "{up/left: {d"), "12:18: bodies.up.conditions.up/left", "write 'left' for 'up/left'"),
    (SPEC.replace("material: {young_modulus: 500, poisson_ratio: 0.3}", "rigid: true"), "13:3: bodies.low", "rigid"),
    (SPEC + "conditions: {up/top: {pressure: 1}}\n", "24:1: conditions", "bodies.NAME.conditions"),
    (SPEC + "tools: {ram: {zones: face, force: {y: 1}}}\n", "24:22: tools.ram.zones", "two elastic bodies"),
    (SPEC + "load_cases: {a: {loads: {gravity: {density: 1, acceleration: [0, -1]}}}}\n", "24:18: load_cases.a.loads",
     "load_cases.a.bodies.NAME"),
    (with_contour("[low/left, up/right]", "low/bottom"), "26:12: contact_zones.roof.edges", "of one body…low, up"),
    (with_contour("low/left", "low/botom"), "27:73: contact_zones.roof.surface.conditions.low/botom", "low/bottom"),
    (with_contour("low/left", "up/right"), "27:73: contact_zones.roof.surface.conditions.up/right",
     "not an edge of 'low'"),
    (with_contour("low/left", "low/right", "bonded: {glue: [up/right, low/right]}\n"),
     "27:14: contact_zones.roof.surface", "'low' is bonded to 'up'"),
    (with_copy(COPY.replace("of: up", "of: upp")), "13:18: bodies.low.copy_of", "unknown body 'upp'"),
    (with_copy(COPY.replace("of: up", "of: low")), "13:18: bodies.low.copy_of", "copy of itself"),
    (with_copy(COPY.replace("shift: [0, -1], ", "")), "13:18: bodies.low.copy_of",
     "'low' lies exactly on 'up'; give shift or rotate"),
    (with_copy("{copy_of: up, shift: [0, -1]}"), "13:18: bodies.low.copy_of",
     "conditions…state those of 'low', or conditions: {}"),
    (with_copy(COPY.replace("of: up", "of: up, material: steel")), "13:8: bodies.low", "remove"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "start", "facts"), MISTAKES)
def test_a_mistake_is_one_sentence_with_its_place(text, start, facts):
    with pytest.raises(bemcontact.SpecError) as caught:
        bemcontact.loads(text, "two.yaml")
    lines = str(caught.value).splitlines()
    assert lines[0].startswith(f"two.yaml:{start}")
    assert_states(lines[0], facts)
    assert len(lines) == 1


def test_what_is_right_is_read():
    assert bemcontact.loads(SPEC).several
    assert bemcontact.loads(with_copy(COPY)).sides_of("face") == ("up", "low")
    free = bemcontact.loads(with_copy("{copy_of: up, shift: [0, -1], conditions: {}}"))
    assert not free.bodies["low"].conditions
    assert bemcontact.loads(bemcontact.dumps(free)) == free


def test_a_rigid_body_that_nothing_touches_is_refused():
    """It would look as if it were in the way of others, and would be nowhere."""
    outline = "{outer: [{name: a, start: [5, 5], end: [6, 5]}, {name: b, end: [5, 6]}, {name: c}]}"
    lone = f"  lone: {{rigid: true, boundary: {outline}}}\n"
    with pytest.raises(bemcontact.SpecError, match="no contact names the rigid body 'lone'"):
        bemcontact.loads(SPEC.replace("contacts:\n", lone + "contacts:\n"))


def test_a_body_inside_another_one_is_refused_unless_it_is_in_a_hole():
    """Their boundaries cross nowhere, so that no later look at the deformed ones would find it."""
    pill = "{name: rim, kind: arc, center: [1, -0.5], radius: 0.2, angles: [0, 360]}"
    text = SPEC.replace("contacts:\n", f"  pill: {{material: steel, boundary: {{outer: [{pill}]}}}}\ncontacts:\n")
    with pytest.raises(bemcontact.SpecError, match="'pill' is drawn inside 'low'"):
        bemcontact.loads(text)
    hole = "      holes: [[{name: bore, kind: arc, center: [1, -0.5], radius: 0.3, angles: [360, 0]}]]\n"
    held = "    conditions: {bottom"
    assert bemcontact.loads(text.replace(held, hole + held)).several


@pytest.mark.parametrize("turn", [30.0, 37.0, 90.0, 217.3])
def test_a_copy_is_turned_about_its_point_and_then_shifted(turn):
    low = {"copy_of": "up", "rotate": turn, "about": [1, 2], "shift": [3, -4], "conditions": HELD}
    spec = problem({"up": elastic(block((0, 2), (0, 1))), "low": low, "base": elastic(block((0, 2), (-1, 0)), HELD)},
                   accuracy=0.01, touch=["up", "base"])  # fmt: skip
    angle = math.radians(turn)
    R = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    for edge in ("bottom", "right", "top", "left"):
        own, its = (spec.edge(f"{body}/{edge}") for body in ("up", "low"))
        at = np.linspace(0, 1, 5)
        assert np.allclose(its.points(at), (own.points(at) - [1, 2]) @ R.T + [1, 2] + [3, -4], atol=1e-14)
        assert np.allclose(its.normals(at), own.normals(at) @ R.T, atol=1e-14)


@pytest.mark.parametrize("turn", [17.3, 33.3, 123.4])
def test_a_turned_circle_stays_a_whole_one(turn):
    """The two angles of an edge need not differ by exactly 360 after the same number is added to both."""
    bodies = {
        "disk": elastic({"outer": [circle("rim", 1, elements=16)]}),
        "other": {"copy_of": "disk", "rotate": turn, "shift": [0, -2], "conditions": {}},
        "base": elastic(block((-2, 2), (-4, -3), (8,) * 4), HELD),
    }
    spec = problem(bodies, one=["disk", "other"], two=["other", "base"])
    meshed = spec.with_element_ends({"other/rim": [i / 10 for i in range(1, 10)]}).with_value("contacts.one.gap", 0.1)
    assert meshed.edge("other/rim").length == pytest.approx(2 * math.pi)


@pytest.mark.parametrize(
    "reference",
    [
        {"kind": "flat_punch", "load": 1, "half_width": 1, "center": [0, 0]},
        {"kind": "shrink_fit", "inner_radius": 1, "outer_radius": 2, "interference": 0.1},
        {"kind": "crack", "half_length": 1, "half_height": 0.1, "compression": 1, "center": [0, 0]},
    ],
)
def test_closed_forms_of_one_elastic_body_are_refused_between_two(reference):
    bodies = {"up": elastic(block((0, 2), (0, 1))), "low": elastic(block((0, 2), (-1, 0)))}
    with pytest.raises(ProblemError) as refused:
        stated(
            name="two", bodies=bodies, accuracy=0.01, contacts={"c": {"between": ["up/bottom", "low/top"]}},
            reference={"form": reference},
        )  # fmt: skip
    assert str(refused.value).startswith("reference.form.kind: ")
    assert "'up' and 'low'" in str(refused.value)
