"""Problems as YAML, objects and mappings: each form states the same problem."""

from pathlib import Path

import numpy as np
import pytest
from pydantic import BaseModel

import bemcontact
from bemcontact.problems import Arc, Boundary, Circle, Condition, Field, Line, Material, Plane, Problem

MODELS = sorted((Path(__file__).parents[2] / "models").rglob("*.yaml"))


@pytest.mark.parametrize(
    "model", [pytest.param(it, id=it.stem, marks=[pytest.mark.slow] * (it.stem == "roller_bearing")) for it in MODELS]
)
def test_a_model_is_the_same_as_objects_mapping_and_text(model):
    problem = bemcontact.load(model)
    stated = problem.to_dict()
    assert bemcontact.problem(stated) == problem
    assert bemcontact.problem(stated).to_dict() == stated
    text = bemcontact.dumps(problem)
    assert bemcontact.loads(text) == problem
    assert bemcontact.dumps(bemcontact.loads(text)) == text


def test_a_problem_is_written_to_a_file(tmp_path):
    problem = bemcontact.load(MODELS[0])
    bemcontact.dump(problem, tmp_path / "copy.yaml")
    assert bemcontact.load(tmp_path / "copy.yaml") == problem
    with pytest.raises(bemcontact.ProblemError, match=r"bemcontact\.problem makes one"):
        bemcontact.dump(problem.to_dict(), tmp_path / "none.yaml")  # pyright: ignore[reportArgumentType]
    assert not (tmp_path / "none.yaml").exists()


def test_an_edge_with_the_name_all_stays_one_edge():
    """Without brackets the word means all edges."""
    data = bemcontact.load(Path(__file__).parents[2] / "models" / "gallery" / "hertz_small.yaml").to_dict()
    text = bemcontact.dumps(bemcontact.problem({key: value for key, value in data.items() if key != "variants"}))
    problem = bemcontact.loads(text.replace("name: rim", "name: all").replace("edges: rim", "edges: [all]"))
    assert problem.contact_zones["foot"].edges == ("all",)
    assert bemcontact.loads(bemcontact.dumps(problem)) == problem
    assert bemcontact.problem(problem.to_dict()) == problem


def test_an_equal_problem_is_so_whatever_was_computed_from_it():
    one, other = (bemcontact.load(MODELS[0]) for _ in range(2))
    bemcontact.condense(one, accuracy=0.1)
    assert one == other
    assert one != other.with_value("name", "another one")
    assert one != "one"


def test_a_problem_is_made_of_objects_arrays_and_mappings():
    """All of them state what the text in YAML does."""
    text = """
    name: roller
    material: {young_modulus: 210e3, poisson_ratio: 0.3}
    boundary:
      outer:
        - {name: rim, kind: arc, center: [0, 10], radius: 10, angles: [-90, 0]}
        - {name: top}
        - {name: axis, start: [0, 10], end: [0, 0]}
    conditions: {axis: {displacement: {x: 0}}, top: {pressure: 20}}
    contact_zones: {rim: {edges: rim, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}}
    """
    corner, radius = np.array([0, 10]), np.int64(10)
    outer = (
        Arc(name="rim", center=(0.0, 10.0), radius=10.0, angles=(-90.0, 0.0)), Line(name="top"),
        Line(name="axis", start=(0.0, 10.0), end=(0.0, 0.0)),
    )  # fmt: skip
    objects = {
        "name": "roller",
        "material": Material(young_modulus=210e3, poisson_ratio=0.3),
        "boundary": Boundary(outer=outer),
        "conditions": {"axis": {"displacement": {"x": 0}}, "top": Condition(pressure=Field(constant=20.0))},
        "contact_zones": {"rim": {"edges": "rim", "surface": Plane(point=(0.0, 0.0), normal=(0.0, 1.0))}},
    }
    mapping = {
        **objects,
        "boundary": {
            "outer": [
                {"name": "rim", "kind": "arc", "center": corner, "radius": radius, "angles": np.array([-90.0, 0.0])},
                {"name": "top"}, {"name": "axis", "start": corner, "end": (0, 0)},
            ]
        },
    }  # fmt: skip
    assert bemcontact.problem(objects) == bemcontact.problem(mapping) == bemcontact.loads(text)


def test_a_mistake_in_a_mapping_has_its_key_path():
    with pytest.raises(bemcontact.ProblemError, match=r"boundary\.outer\[1\]\.radius: "):
        bemcontact.problem({"boundary": {"outer": [{"name": "a"}, {"name": "b", "kind": "arc", "radius": "big"}]}})
    with pytest.raises(bemcontact.ProblemError, match=r"bemcontact\.load reads a file"):
        bemcontact.problem("roller.yaml")  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize("part", [bemcontact.load(MODELS[0]), Circle(center=(0.0, 0.0), radius=1.0, body="inside")])
def test_completion_offers_nothing_of_pydantic_and_every_key(part):
    names = dir(part)
    assert not [name for name in names if hasattr(BaseModel, name) or name.startswith("_") or "pydantic" in name]
    assert {*type(part).model_fields} <= {*names}
    assert all(hasattr(part, name) for name in names)
    assert "to_dict" in names


def test_what_the_package_alone_uses_exists():
    assert all(hasattr(Problem, name) for name in Problem.inside)
