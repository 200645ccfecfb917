"""A problem compared on several meshes, and what its references are worth once it is changed."""

import json

import pytest
from contact_problems import random_contact

import bemcontact
from bemcontact.analysis import compare as comparing
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import OptionError, ProblemError
from bemcontact.options import ComparisonOptions
from bemcontact.problems import Problem


def block(pressure: float = 3.0) -> Problem:
    """A block on a table under uniform pressure: so is its contact pressure; its height is free."""
    corners = {"bottom": [0, 0], "right": [40, 0], "top": [40, 20], "left": [0, 20]}
    return Problem(
        name="block",
        units={"length": "mm", "force": "N"},
        material={"young_modulus": 210e3, "poisson_ratio": 0.3},
        boundary={"outer": [{"name": key, "start": start, "elements": 2} for key, start in corners.items()]},
        conditions={"left": {"displacement": {"x": 0}}, "top": {"pressure": pressure}},
        contact_zones={"foot": {"edges": "bottom", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
        reference={"uniform": {"kind": "uniform", "pressure": 3.0}},
    )  # pyright: ignore


def test_a_uniform_pressure_is_found_on_each_mesh():
    said = []
    options = ComparisonOptions.of(starts=2)
    found = comparing.mesh_study(options, block(), (2, 1), lambda stage, now: said.append((stage, now)))
    assert found.certified
    assert [level.refine for level in found.levels] == [1, 2]
    assert found.finest.refine == 2
    assert found.finest.answer.footprint.peak.pressure == pytest.approx(3.0, rel=1e-9)  # pyright: ignore
    assert all(score.judged and score.holds for level in found.levels for score in level.scores)
    assert found.convergence is not None
    assert found.convergence.quantities[0].values == pytest.approx([3.0, 3.0], rel=1e-9)
    begun = [stage for stage, now in said if not now]
    assert begun[:4] == ["refine 1: mesh", "refine 1: direct", "refine 1: loading cvxpy", "refine 1: QP1"]
    assert ("refine 2: QP1, random starts", "2 of 2") in said


def test_one_mesh_has_no_convergence():
    found = comparing.mesh_study(ComparisonOptions.of(["qp1"]), block())
    assert found.convergence is None
    data = json.loads(found.to_json())
    assert data["convergence"] is None
    assert data["settings"]["formulations"] == ["qp1"]
    assert data["levels"][0]["scores"][0]["reference"] == "uniform"
    assert data["seconds"] > 0
    assert data["versions"]["bemcontact"] == bemcontact.__version__


@pytest.mark.parametrize(
    ("changes", "judged"),
    [
        ((), True),
        (("mesh.refine=2", "name=other"), True),
        (("conditions.top.pressure=4",), False),
        (("material.young_modulus=1",), False),
        (("boundary.outer.top.elements=3",), True),
        (("conditions.top.pressure=4", "reference.uniform.tolerance=0.1"), False),
        (("conditions.top.pressure=4", "reference.uniform.pressure=4"), True),
    ],
)
def test_references_of_a_changed_problem_are_not_judged(changes: tuple[str, ...], judged: bool):
    found = comparing.mesh_study(ComparisonOptions.of(["qp3"]), block(), changes=changes)
    assert {score.judged for score in found.finest.scores} == {judged}
    assert any("was changed (--set)" in item.remark for item in found.finest.expected) is not judged


def test_a_condensed_problem_has_no_mesh_and_no_references():
    contact = random_contact(1, 6, 1)
    found = comparing.mesh_study(ComparisonOptions.of(), contact)
    assert found.problem is None
    assert found.finest.expected == ()
    assert found.to_dict()["levels"][0]["dof"] is None
    with pytest.raises(OptionError, match="no mesh to refine"):
        comparing.mesh_study(ComparisonOptions.of(), contact, (1, 2))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"formulations": ["qp4"]}, "no formulation 'qp4' to compare; take one of qp1, qp2, qp3"),
        ({"formulations": ["complementarity"]}, "is the reference of every comparison"),
        ({"formulations": ["qp1", "qp1"]}, "the formulations must be different from each other"),
        ({"formulations": []}, "and at least one"),
        ({"weights": ["heavy"]}, "no weights 'heavy'"),
        ({"penalties": [0.0]}, "the penalty must be a number from 1e-08"),
        ({"penalties": ["x"]}, "the penalty must be a number from 1e-08"),
        ({"formulations": ["qp1"], "penalties": [2.0]}, "a penalty is an option of qp2"),
        ({"formulations": ["qp3"], "starts": 3}, "random starts are for qp1 and qp2"),
        ({"seed": 3}, "a seed goes with random starts"),
        ({"starts": 0}, "the number of starts must be a whole number of at least 1"),
        ({"starts": 1, "seed": -1}, "the seed must be a whole number"),
    ],
)
def test_mistakes_in_options_are_found_before_any_work(options: dict, words: str):
    with pytest.raises(OptionError, match=words):
        comparing.compare(CondensedContact.from_compliance([[1.0]], [-1.0]), **options)


@pytest.mark.parametrize("refine", [(), (1, 1), (0,), (1.5,)])
def test_mistakes_in_refinements_are_found(refine: tuple):
    with pytest.raises(OptionError, match="refinement"):
        comparing.mesh_study(ComparisonOptions.of(), block(), refine)


def test_a_file_name_is_no_problem():
    with pytest.raises(ProblemError, match=r"bemcontact\.load reads one from a file"):
        comparing.compare("block.yaml")  # pyright: ignore


def test_one_name_means_a_list_of_one():
    found = comparing.compare(random_contact(1, 6, 1), "qp1", "tributary")
    assert [item.label for item in found.contenders] == ["QP1"]
