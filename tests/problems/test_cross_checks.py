"""Cross-checks of edge names in conditions and contact zones, also in a problem with other mistakes."""

import pytest
from messages import assert_each_states

from bemcontact.errors import ProblemError
from bemcontact.problems import Plane, Problem
from bemcontact.problems.cross_checks import edge_name_issues
from bemcontact.problems.key_path import RawValue

EDGES = {"outer": [{"name": "top"}, {"name": "side"}]}


def issues(boundary, conditions=None, zones=None):
    conditions = [RawValue(("conditions",), conditions)]
    all_issues = edge_name_issues(RawValue(("boundary",), boundary), conditions, RawValue(("contact_zones",), zones))
    return [str(issue) for issue in all_issues]


@pytest.mark.parametrize("boundary", [EDGES, {"outter": [{"nam": "top"}, {"name": "side", "elements": "many"}]}])
def test_unknown_names_are_reported_together_with_other_mistakes(boundary):
    zones = {"foot": {"edges": ["topp", 3], "surface": None}, "wall": {"edge": "sid"}, "none": 7}
    facts = [
        "conditions.tip: unknown … 'tip' … 'top'",
        "contact_zones.foot.edges[0]: unknown … 'topp' … 'top'",
        "contact_zones.wall.edge[0]: unknown … 'sid' … 'side'",
    ]
    assert_each_states(issues(boundary, {"tip": 1}, zones), facts)


@pytest.mark.parametrize(
    "boundary", [None, 3, {}, {"outer": 3}, {"outer": [{"elements": 2}, {"name": "top"}]}, {"outer": [{"name": 3}]}]
)
def test_no_name_is_unknown_if_an_edge_name_is_unreadable(boundary):
    assert issues(boundary, {"tip": 1}, {"foot": {"edges": "side"}}) == []


def test_contradictory_names_are_reported_without_a_boundary():
    zones = {"foot": {"edges": ["side", "side"]}, "wall": {"edges": "side"}, "any": {"edges": "all"}}
    facts = [
        "contact_zones.foot.edges[1]: … 'side' … twice",
        "conditions.side: … 'side' … contact zone 'foot' … no condition",
    ]
    assert_each_states(issues(None, {"side": 1}, zones), facts)


def test_an_edge_is_compared_with_a_surface_once_for_all_loads(monkeypatch: pytest.MonkeyPatch):
    """The gap does not depend on loads; the same surface turned round is looked at anew, and refused."""
    stated = Problem.model_validate({
        "name": "roller", "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
        "boundary": {"outer": [
            {"name": "rim", "kind": "arc", "center": [0, 8], "radius": 8, "angles": [-90, 0]},
            {"name": "top"}, {"name": "axis", "start": [0, 8], "end": [0, 0]},
        ]},
        "conditions": {"top": {"pressure": 1}, "axis": {"displacement": {"x": 0}}},
        "contact_zones": {"foot": {"edges": "rim", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
    })  # fmt: skip
    compared, closest = [], Plane.closest
    monkeypatch.setattr(Plane, "closest", lambda *given: compared.append(given) or closest(*given))
    stated.with_value("conditions.top.pressure", 2)
    assert not compared
    with pytest.raises(ProblemError, match="must point from the surface into the body"):
        stated.with_value("contact_zones.foot.surface.normal", [0, -1])
    assert compared
