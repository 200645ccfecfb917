"""Cross-checks of edge names in conditions and contact zones, also in a problem with other mistakes."""

import pytest
from messages import assert_each_states

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
