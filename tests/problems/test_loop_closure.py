"""Open loops: each change of a sound loop is undone by what the error says."""

from math import cos, pi, sin

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bemcontact.errors import ProblemError
from bemcontact.problems import Arc, Boundary, Line

RADIUS = 2.5


def corner(turn):
    return RADIUS * cos(2 * pi * turn), RADIUS * sin(2 * pi * turn)


def edge(i, kind, first, last):
    """An edge from corner to corner of a circle: a chord, or an arc by its angles or by its ends."""
    name = f"e{i}"
    if kind == "line":
        return Line(name=name, start=corner(first), end=corner(last), elements=8)
    if kind == "ends":
        return Arc(name=name, center=(0, 0), start=corner(first), end=corner(last), elements=8)
    return Arc(name=name, center=(0, 0), radius=RADIUS, angles=(360 * first, 360 * last), elements=8)


@st.composite
def sound_loops(draw):
    n = draw(st.integers(3, 7))
    return [edge(i, draw(st.sampled_from(("line", "angles", "ends"))), i / n, (i + 1) / n) for i in range(n)]


def exchanged(item):
    """The edge with both ends exchanged."""
    if item.kind == "arc" and item.angles:
        return item.model_copy(update={"angles": item.angles[::-1]})
    return item.model_copy(update={"start": item.end, "end": item.start})


def issues(loop):
    with pytest.raises(ProblemError) as caught:
        Boundary(outer=loop)
    return [(issue.path[1], issue.message) for issue in caught.value.issues]


def values(item, *keys):
    """How a spec has the values of an edge."""
    pairs = {key: getattr(item, key) for key in keys}
    return ", ".join(f"{key}: [{', '.join(f'{x:.12g}' for x in pair)}]" for key, pair in pairs.items())


@settings(max_examples=60, deadline=None)
@given(sound_loops(), st.data())
def test_edges_that_run_the_wrong_way_round_are_named_with_their_right_values(loop, data):
    turned = data.draw(st.sets(st.integers(0, len(loop) - 1), min_size=1, max_size=(len(loop) - 1) // 2))
    found = issues([exchanged(item) if i in turned else item for i, item in enumerate(loop)])
    assert {i for i, _ in found} == turned
    for i, message in found:
        keys = ("angles",) if loop[i].kind == "arc" and loop[i].angles else ("start", "end")
        assert message.endswith(f"'e{i}' runs the wrong way round: give {values(loop[i], *keys)}")


@settings(max_examples=40, deadline=None)
@given(sound_loops(), st.data())
def test_edges_in_another_order_are_listed_in_the_order_that_closes_the_loop(loop, data):
    order = data.draw(st.permutations(range(len(loop))))
    first = order.index(0)
    assume([*order[first:], *order[:first]] != [*range(len(loop))])
    n, start = len(loop), order[0]
    expected = ", ".join(f"'e{(start + k) % n}'" for k in range(n))
    for _, message in issues([loop[i] for i in order]):
        assert f"list the edges in the order {expected}, which closes the loop" in message


def test_another_order_is_no_arc_of_no_length():
    """Exchanged, the arc of the third quarter could join its neighbors only by two equal angles."""
    kinds = ("line", "line", "angles", "angles")
    loop = [edge(i, kind, i / 4, (i + 1) / 4) for i, kind in enumerate(kinds)]
    for _, message in issues([loop[i] for i in (0, 2, 1, 3)]):
        assert "list the edges in the order 'e0', 'e1', 'e2', 'e3', which closes the loop" in message


@settings(max_examples=40, deadline=None)
@given(st.integers(3, 7), st.sampled_from(("radius", "center", "angles")), st.floats(0.1, 0.9), st.data())
def test_the_radius_center_or_angles_that_close_the_loop_are_given(n, key, change, data):
    i = data.draw(st.integers(0, n - 1))
    loop = [edge(k, "angles" if k == i else "line", k / n, (k + 1) / n) for k in range(n)]
    first, last = loop[i].angles
    wrong = {"radius": RADIUS * (1 + change), "center": (change, -change), "angles": (first, last + 30 * change)}[key]
    right = f"{RADIUS:.12g}" if key == "radius" else values(loop[i], key).partition(": ")[2]
    loop[i] = loop[i].model_copy(update={key: wrong})
    found = issues(loop)
    messages = " ".join(message for _, message in found)
    if key != "center":
        assert f"give 'e{i}' {key}: {right}, which closes the loop" in messages
    else:
        assert f"give 'e{i}' center: [" in messages
    if key != "angles":  # both ends are off: one mistake, at the arc
        assert [where for where, _ in found] == [i]


@settings(max_examples=8, deadline=None)
@given(sound_loops(), st.data())
def test_an_arc_on_the_other_side_of_its_center_is_named(loop, data):
    arcs = [i for i, item in enumerate(loop) if item.kind == "arc"]
    assume(arcs)
    i = data.draw(st.sampled_from(arcs))
    change = {"clockwise": True}
    if loop[i].angles:
        first, last = loop[i].angles
        change = {"angles": (first, last - 360)}
    for _, message in issues([*loop[:i], loop[i].model_copy(update=change), *loop[i + 1 :]]):
        assert f"does 'e{i}' run the wrong way round its center?" in message


def test_angles_that_are_more_than_a_full_turn_in_radians_are_not_suspected():
    lines = [Line(name="down", start=(0, 1), end=(0, 0), elements=1), Line(name="along", end=(1, 0), elements=1)]
    arc = Arc(name="arc", center=(0, 0), radius=1, angles=(88, 90), elements=2)
    assert not any("radians" in message for _, message in issues([arc, *lines]))
