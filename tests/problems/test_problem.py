"""Problems made in Python: changes of values, and errors that list every issue."""

import copy
import pickle

import numpy as np
import pytest
from messages import assert_each_states, assert_states

import bemcontact
from bemcontact import problems
from bemcontact.errors import ProblemError
from bemcontact.problems import (
    Arc,
    Boundary,
    Condition,
    ContactZone,
    DeflectedContour,
    EdgeForce,
    Field,
    Fillet,
    Line,
    Material,
    Mirror,
    Plane,
    Problem,
    Units,
)
from bemcontact.problems.problem import MeshDensity
from bemcontact.problems.way import AS_DRAWN, Way


def test_a_problem_prints_one_line():
    """Of several bodies all are counted, with the contacts between them."""
    assert str(Problem(**parts())) == repr(Problem(**parts()))
    assert repr(Problem(**parts())).startswith("<Problem 'quarter disk': 3 edges, 1 contact zone; ")
    rollers = bemcontact.load("models/bodies/two_cylinders.yaml")
    assert "2 bodies" in repr(rollers)
    assert "1 contact zone" in repr(rollers)


def parts():
    """Parts of a quarter disk on a plane, as Python objects."""
    return {
        "name": "quarter disk",
        "material": Material(young_modulus=1000, poisson_ratio=0.3),
        "boundary": Boundary(
            outer=[
                Arc(name="arc", center=(0, 8), radius=8, angles=(-90, 0), elements=6),
                Line(name="top", elements=4),
                Line(name="axis", start=(0, 8), elements=5),
            ]
        ),
        "conditions": {"top": Condition(pressure=Field(constant=50))},
        "contact_zones": {"foot": ContactZone(edges=["arc"], surface=Plane(point=(0, 0), normal=(0, 1)))},
    }


def issues(**changes):
    with pytest.raises(ProblemError) as caught:
        Problem(**{**parts(), **changes})
    return [str(issue) for issue in caught.value.issues]


@pytest.mark.parametrize(
    ("key", "value", "kept"),
    [
        ("conditions.top.pressure", 20, ["boundary", "material"]),
        ("material.young_modulus", 2000, ["boundary"]),
        ("boundary.outer.top.elements", 5, ["material"]),
    ],
)
def test_a_change_keeps_the_parts_that_it_does_not_touch(key, value, kept):
    """They are not checked again. The problem is the one whose file has the value."""
    problem = Problem(**parts())
    changed = problem.with_value(key, value)
    assert all(getattr(changed, part) is getattr(problem, part) for part in kept)
    assert changed == bemcontact.loads(bemcontact.dumps(problem), set={key: value})


def test_problem_of_objects_equals_the_problem_of_its_data():
    problem = Problem(**parts())
    assert Problem(**problem.model_dump()) == problem
    assert Problem.model_validate_json(problem.model_dump_json()) == problem


def test_each_part_of_a_problem_file_is_public():
    """The schema defines what a file may have; the page on Python names says that its parts are here."""
    assert [name for name in bemcontact.schema()["$defs"] if not hasattr(problems, name)] == []


def test_a_mirrored_outline_with_a_fillet_and_a_force_may_be_objects():
    """The same problem as of a mapping."""
    line = (
        {"name": "floor", "start": (0, 0), "end": (4, 0)},
        {"name": "side", "end": (4, 2)},
        {"name": "roof", "end": (0, 2)},
    )
    zones = {"foot": {"edges": "floor", "surface": {"kind": "plane", "point": (0, 0), "normal": (0, 1)}}}
    keys = {"name": "block", "material": Material(young_modulus=1000, poisson_ratio=0.3), "contact_zones": zones}
    floor, side, roof = (Line(**edge) for edge in line)
    of_objects = {
        "boundary": Boundary(outer=[floor, side, Fillet(fillet=0.5), roof], mirror=Mirror(x=0)),
        "conditions": {"roof": Condition(force=[EdgeForce(y=-3, width=1)])},
    }
    of_data = {
        "boundary": {"outer": [*line[:2], {"fillet": 0.5}, line[2]], "mirror": {"x": 0}},
        "conditions": {"roof": {"force": {"y": -3, "width": 1}}},
    }
    assert bemcontact.problem(keys | of_objects) == bemcontact.problem(keys | of_data)


def test_edges_are_found_by_name():
    problem = Problem(**parts())
    assert problem.edge("top").start == (8, 8)
    with pytest.raises(ProblemError, match="boundary: unknown edge 'tap'; did you mean 'top'"):
        problem.edge("tap")


@pytest.mark.parametrize(
    ("edge", "axis", "words"),
    [
        ("top", "y", None),
        ("axis", "x", None),
        ("top", "x", "'top' is no straight edge along y, where … its image along x; write symmetry: y"),
        ("axis", "y", "'axis' is no straight edge along x, where … its image along y; write symmetry: x"),
        ("arc", "x", "'arc' is no straight edge along y, where … an edge that slides along y has displacement: {x: 0}"),
    ],
)
def test_a_line_of_symmetry_is_a_straight_edge_across_its_axis(edge, axis, words):
    """A body that goes on as its image along x ends at a line x = const."""
    touching, surface = ("top", (0, 20)) if edge == "arc" else ("arc", (0, 0))
    zone = {
        "edges": [touching],
        "surface": {"kind": "plane", "point": surface, "normal": (0, 1 if edge != "arc" else -1)},
    }
    changes = {"conditions": {edge: {"symmetry": axis}}, "contact_zones": {"foot": zone}}
    if words is None:
        assert Problem(**{**parts(), **changes}).conditions[edge].displacement.given == (axis,)
        return
    (issue,) = issues(**changes)
    assert_states(issue, f"conditions.{edge}.symmetry: {words}")
    of_body = {**parts(), **changes}
    body = {key: of_body.pop(key) for key in ("boundary", "conditions", "material")}
    zones = {"foot": {**zone, "edges": [f"disk/{touching}"]}}
    with pytest.raises(ProblemError) as refused:
        Problem(**{**of_body, "contact_zones": zones, "bodies": {"disk": body}})
    (issue,) = refused.value.issues
    assert_states(str(issue), f"bodies.disk.conditions.{edge}.symmetry: {words}")


def test_unit_of_stress_needs_units_of_force_and_length():
    assert Units(length="cm", force="kN").stress == "kN/cm²"
    assert Units(length="cm").stress == ""


def test_refinements_multiply():
    problem = Problem(**parts()).refined(2).refined(3)
    assert problem.refined(1) is problem
    assert problem.mesh == MeshDensity(refine=6)


@pytest.mark.parametrize(
    ("path", "value", "found"),
    [
        ("material.young_modulus", 2e6, lambda problem: problem.material.young_modulus),
        ("boundary.outer[1].elements", 9, lambda problem: problem.edge("top").elements),
        ("boundary.outer.axis.elements", 9, lambda problem: problem.edge("axis").elements),
        ("units.length", "mm", lambda problem: problem.units.length),
        ("conditions.axis", Condition(pressure=Field(x=1)), lambda problem: problem.conditions["axis"]),
    ],
)
def test_with_value_makes_a_new_problem(path, value, found):
    problem = Problem(**parts())
    assert found(problem.with_value(path, value)) == value
    assert problem == Problem(**parts())


def test_values_of_numpy_are_those_of_python():
    """A loop over an array has them."""
    problem = Problem(**parts())
    for value in (np.int64(7), np.float32(7), np.array(7.0)):
        assert problem.with_value("conditions.top.pressure", value) == problem.with_value("conditions.top.pressure", 7)
    normal = "contact_zones.foot.surface.normal"
    assert problem.with_value(normal, np.array([0, 2])) == problem.with_value(normal, [0, 2])


def test_a_problem_does_not_change_and_says_what_to_do():
    problem = Problem(**parts())
    with pytest.raises(ProblemError, match=r"a Problem does not change; problem\.with_value\('name', 'x'\)"):
        problem.name = "x"
    with pytest.raises(ProblemError, match=r"a Material does not change; problem\.with_value\('….young_modulus', 5\)"):
        problem.material.young_modulus = 5


def test_mappings_of_a_problem_do_not_change():
    """What is put into one would not be checked; copies and pickles are equal to it, and a union is a new mapping."""
    stated = Problem(**parts())
    for change in (
        lambda: stated.conditions.update(top=5),
        lambda: stated.contact_zones.pop("table", None),
        lambda: stated.load_cases.clear(),
    ):
        with pytest.raises(ProblemError, match=r"do not change; problem\.with_value"):
            change()
    for other in (copy.deepcopy(stated), pickle.loads(pickle.dumps(stated)), Problem(**stated.to_dict())):
        assert other == stated
    assert {**stated.conditions, "top": 5} == stated.conditions | {"top": 5}


def test_values_that_must_agree_are_changed_at_once():
    """A Poisson ratio of 0.5 is refused in plane strain, where the body is incompressible, and is right in a sheet."""
    problem = Problem(**parts())
    thin = {"material.state": "plane_stress", "material.poisson_ratio": 0.5}
    with pytest.raises(ProblemError, match="plane strain"):
        problem.with_value("material.poisson_ratio", 0.5)
    assert problem.with_values(thin).material.poisson_ratio == 0.5
    assert problem.with_values({}) == problem
    later = {"mesh": {"refine": 2}, "mesh.refine": 3}  # in their order
    assert problem.with_values(later).mesh.refine == 3
    assert problem.with_values(dict(reversed([*later.items()]))).mesh.refine == 2
    for wrong in ([("mesh.refine", 2)], "mesh.refine=2", None):
        with pytest.raises(ProblemError, match="values by key path are needed"):
            problem.with_values(wrong)  # pyright: ignore[reportArgumentType]


def test_with_value_checks_the_new_problem():
    with pytest.raises(ProblemError, match=r"^material\.poisson_ratio: must be greater than -1 and less than 0\.5"):
        Problem(**parts()).with_value("material.poisson_ratio", 0.7)
    with pytest.raises(ProblemError, match="is not a key path"):
        Problem(**parts()).with_value("a..b", 1)


def test_names_are_checked_in_a_problem_with_invalid_parts():
    boundary = parts()["boundary"].model_dump()
    first, second = issues(boundary=boundary, material={"young_modulus": 1}, conditions={"tip": {"pressure": 1}})
    assert first.startswith("material.poisson_ratio: missing; give the Poisson ratio")
    assert_states(second, "conditions.tip: unknown … 'tip' … 'top'")


def test_geometry_is_checked_in_a_problem_with_invalid_parts():
    boundary = parts()["boundary"].model_dump()
    boundary["outer"][0]["elements"] = 1
    zone = {"edges": "arc", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, -1]}}
    found = issues(boundary=boundary, material={"young_modulus": 1}, contact_zones={"foot": zone})
    assert [line.partition(": ")[0] for line in found] == [
        "material.poisson_ratio",
        "contact_zones.foot.surface",
        "boundary.outer[0].elements",
    ]


def test_value_under_a_misspelled_key_is_checked():
    data = parts()
    data["materiel"] = {"young_modulus": 0, "poison_ratio": 0.7}
    del data["material"]
    with pytest.raises(ProblemError) as caught:
        Problem(**data)
    facts = [
        "materiel: unknown … 'materiel' … 'material'",
        "materiel.young_modulus: … greater than 0, found 0",
        "materiel.poison_ratio: unknown … 'poison_ratio' … 'poisson_ratio'",
        "materiel.poison_ratio: … greater than -1 and less than 0.5, found 0.7",
    ]
    assert_each_states(map(str, caught.value.issues), facts)


def test_edge_that_occurs_twice_in_a_zone_is_refused():
    zone = ContactZone(edges=["arc", "arc"], surface=Plane(point=(0, 0), normal=(0, 1)))
    (issue,) = issues(contact_zones={"foot": zone})
    assert_states(issue, "contact_zones.foot.edges[1]: … 'arc' … twice")


@pytest.mark.parametrize(
    ("surface", "remedy"),
    [
        ({"kind": "plane", "point": [0, 0], "normal": [0, -2]}, "reverse the normal: [0, 2]"),
        ({"kind": "plane", "point": [0, 0], "normal": [1, 0]}, "look at the direction of the surface"),
        (
            {"kind": "circle", "center": [0, -9], "radius": 9, "body": "inside"},
            "the center lies on the side of the body: move it, or is the body outside the circle?",
        ),
        (
            {"kind": "circle", "center": [0, 20], "radius": 20, "body": "outside"},
            "the center lies beyond this edge: move it, or is the body inside the circle?",
        ),
        ({"kind": "polyline", "points": [[1, 0], [-1, 0]]}, "list its points in the opposite order"),
        ({"kind": "spline", "points": [[1, 0], [0, 0], [-1, 0]]}, "list its points in the opposite order"),
    ],
)
def test_surface_that_faces_away_is_refused_with_a_remedy(surface, remedy):
    zone = {"edges": ["arc"], "surface": surface}
    [issue] = issues(contact_zones={"foot": zone})
    assert_states(issue, f"contact_zones.foot.surface: … normal … into … {remedy}")


@pytest.mark.parametrize("data", [None, 3, [], "block"])
def test_data_without_keys_is_refused(data):
    with pytest.raises(ProblemError, match="expected a mapping with the keys name, description"):
        Problem.model_validate(data)


def on_its_contour(**changes):
    surface = {"kind": "deflected_contour", "conditions": {"top": {"pressure": 20}}, "direction": [0, 1], **changes}
    return {"foot": {"edges": ["arc"], "surface": surface}}


def test_problem_with_a_contour_survives_serialization():
    problem = Problem(**{**parts(), "contact_zones": on_its_contour()})
    assert Problem(**problem.model_dump()) == problem
    changed = problem.with_value("contact_zones.foot.surface.conditions.top.pressure", 30)
    surface = changed.contact_zones["foot"].surface
    assert isinstance(surface, DeflectedContour)
    assert surface.conditions["top"].pressure == Field(constant=30)


def test_contour_may_load_edges_of_its_zone():
    assert Problem(**{**parts(), "contact_zones": on_its_contour(conditions={"arc": {"pressure": 1}})})


def test_contour_is_checked_against_the_body():
    (unknown,) = issues(contact_zones=on_its_contour(conditions={"tap": {"pressure": 1}}))
    assert_states(unknown, "contact_zones.foot.surface.conditions.tap: unknown … 'tap' … 'top'")
    (away,) = issues(contact_zones=on_its_contour(direction=[0, -3]))
    assert_states(away, "contact_zones.foot.surface: … normal … at 'arc' … reverse the direction: [0, 3]")


def test_surfaces_are_after_the_motions_of_a_copy():
    """Also where no two bodies touch; the problem itself keeps its surfaces as they are drawn."""
    problem = Problem(**parts())
    (zone,) = problem.zones
    moved = problem.after_motions({zone: Way(0.0, -0.5)})
    assert moved.zones[zone].surface.way == Way(0.0, -0.5)
    assert problem.zones[zone].surface.way == AS_DRAWN
