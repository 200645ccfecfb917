"""Edge names in conditions and contact zones, checked as far as they can be read."""

import pytest

from bemcontact.problem.edge_names import name_complaints
from bemcontact.problem.partial import Written

EDGES = {"outer": [{"name": "top"}, {"name": "side"}]}


def complaints(boundary, conditions=None, zones=None):
    stated = [Written(("conditions",), conditions)]
    found = name_complaints(Written(("boundary",), boundary), stated, Written(("contact_zones",), zones))
    return [str(complaint) for complaint in found]


@pytest.mark.parametrize("boundary", [EDGES, {"outter": [{"nam": "top"}, {"name": "side", "elements": "many"}]}])
def test_unknown_names_are_found_beside_other_mistakes(boundary):
    zones = {"foot": {"edges": ["topp", 3], "surface": None}, "wall": {"edge": "sid"}, "none": 7}
    assert complaints(boundary, {"tip": 1}, zones) == [
        "conditions.tip: unknown edge 'tip'; did you mean 'top'?",
        "contact_zones.foot.edges[0]: unknown edge 'topp'; did you mean 'top'?",
        "contact_zones.wall.edge[0]: unknown edge 'sid'; did you mean 'side'?",
    ]


@pytest.mark.parametrize(
    "boundary", [None, 3, {}, {"outer": 3}, {"outer": [{"elements": 2}, {"name": "top"}]}, {"outer": [{"name": 3}]}]
)
def test_no_name_is_called_unknown_while_one_cannot_be_read(boundary):
    assert complaints(boundary, {"tip": 1}, {"foot": {"edges": "side"}}) == []


def test_what_contradicts_itself_needs_no_boundary():
    zones = {"foot": {"edges": ["side"]}, "wall": {"edges": "side"}}
    assert complaints(None, {"side": 1}, zones) == [
        "contact_zones.wall.edges[0]: edge 'side' is in the contact zone 'foot' already; "
        "an edge can touch one surface only",
        "conditions.side: edge 'side' is in the contact zone 'foot' and can carry no condition; remove one",
    ]
