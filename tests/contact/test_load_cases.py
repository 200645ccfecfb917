"""Changes without a new condensation: load cases and tools enter q = ε + Δ1 and the load linearly."""

from dataclasses import replace
from functools import cache
from random import Random

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from tool_problems import FREE, FREE_CASES, HELD, HELD_CASES, made

from bemcontact.adaptivity.adapt import meshed
from bemcontact.analysis import solve as analysis
from bemcontact.bem import condense
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.load_cases import LoadCases, Pinned, Tools
from bemcontact.errors import ProblemError
from bemcontact.problems import Problem

PROBLEMS = {"held": (HELD, HELD_CASES), "free": (FREE, FREE_CASES)}
names = st.sampled_from([*PROBLEMS])
numbers = st.floats(-10, 10)


@cache
def condensed(name: str) -> CondensedContact:
    stated, cases = PROBLEMS[name]
    return analysis.condense(made(stated, load_cases=cases["load_cases"]))


def factors_of(name: str, values: list[float]) -> dict[str, float]:
    return dict(zip(condensed(name).cases.names, values, strict=False))


factors = st.lists(numbers, min_size=5, max_size=5)


def alike(one: CondensedContact, other: CondensedContact) -> None:
    """The same contact problem, to round-off; factors are 10 at most."""
    U = 10 * max(condensed("held").scales.displacement, condensed("free").scales.displacement)
    assert one.initial_gap == pytest.approx(other.initial_gap, abs=1e-13 * U)
    assert one.free_displacement == pytest.approx(other.free_displacement, abs=1e-13 * U)
    assert one.motion_load == pytest.approx(other.motion_load, rel=1e-12, abs=1e-11)
    assert one.cases.factors == pytest.approx(other.cases.factors, abs=1e-14)
    assert one.tools.position == pytest.approx(other.tools.position, abs=1e-13)
    assert one.tools.force == pytest.approx(other.tools.force, rel=1e-12, abs=1e-11)


@given(names, factors)
def test_factors_are_linear(name: str, values: list[float]):
    """The acting load is the permanent one plus the sum of factor times `changes`."""
    contact, wanted = condensed(name), factors_of(name, values)
    changed, changes = contact.with_factors(wanted), contact.changes
    steps = [(factor, changes[f"load_cases.{case}"]) for case, factor in wanted.items()]
    offset = contact.offset + sum(factor * step.offset for factor, step in steps)
    load = contact.motion_load + sum(factor * step.motion_load for factor, step in steps)
    assert changed.offset == pytest.approx(offset, abs=1e-12 * max(1e-3, abs(offset).max()))
    assert changed.motion_load == pytest.approx(load, rel=1e-11, abs=1e-11)


@given(names, factors, factors)
def test_later_factors_replace_earlier_ones(name: str, before: list[float], after: list[float]):
    contact = condensed(name)
    alike(
        contact.with_factors(factors_of(name, before)).with_factors(factors_of(name, after)),
        contact.with_factors(factors_of(name, after)),
    )


@given(names, factors)
def test_permanent_load_acts_without_factors(name: str, values: list[float]):
    contact = condensed(name)
    alike(contact.with_factors(factors_of(name, values)).with_factors({}), contact)


components = st.lists(st.tuples(numbers, numbers, numbers), min_size=2, max_size=2)


@given(names, components, components)
def test_tools_have_the_given_displacements_and_forces(name: str, position: list, force: list):
    """Given components have the displacement, and free components have the force; the others are zero."""
    contact = condensed(name)
    t = len(contact.tools)
    at, pushed = np.array(position[:t]).ravel(), np.array(force[:t]).ravel()
    changed = contact.with_tools(position[:t], force[:t])
    free = contact.tools.free
    assert changed.tools.position == pytest.approx(np.where(free, 0.0, at), abs=1e-14)
    assert changed.tools.force == pytest.approx(np.where(free, pushed, 0.0), abs=1e-13)
    alike(changed.with_tools(contact.tools.position, contact.tools.force), contact)
    changes, step = contact.changes, np.where(free, pushed - contact.tools.force, at - contact.tools.position)
    known = [(step[i], changes[key]) for i, key in enumerate(contact.tools.keys) if key in changes]
    offset = contact.offset + sum(size * change.offset for size, change in known)
    load = contact.motion_load + sum(size * change.motion_load for size, change in known)
    assert changed.offset == pytest.approx(offset, abs=1e-11)
    assert changed.motion_load == pytest.approx(load, rel=1e-11, abs=1e-10)


@given(factors, components)
def test_factors_and_tools_add_up_in_any_order(values: list[float], position: list):
    """A load case moves tools from their present place."""
    contact, wanted = condensed("held"), factors_of("held", values)
    step = contact.cases.position @ contact.with_factors(wanted).cases.factors
    moved = contact.with_tools(position).with_factors(wanted)
    alike(moved, contact.with_factors(wanted).with_tools(np.array(position).ravel() + step))


def test_empty_changes_have_no_effect():
    contact = condensed("held")
    alike(contact.with_tools(), contact)


def test_keys_are_those_of_the_spec():
    """`Problem.with_value` accepts the keys, with the same effect: a force if the tool is free, else a displacement.

    Rigid surfaces stay where they came to be touched.
    """
    keys = condensed("held").changes
    assert "tools.punch.force.y" in keys
    assert "tools.punch.force.moment" in keys
    assert "tools.table.displacement.rotation" in keys
    assert "tools.punch.displacement.y" not in keys
    problem = made(HELD)
    for key, value in (("tools.punch.force.moment", 3 + 0.5), ("tools.table.displacement.rotation", 0.001 + 0.5)):
        found = meshed(problem).problem
        other = condense.condensed(problem.with_value(key, value).on_contacts_of(found)).contact
        here = analysis.condense(problem)  # load cases share surfaces where they are drawn, so not `keys[key]`
        change = here.changes[key]
        assert other.offset == pytest.approx(here.offset + 0.5 * change.offset, abs=1e-13)
        assert other.motion_load == pytest.approx(here.motion_load + 0.5 * change.motion_load, rel=1e-13)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            lambda contact: contact.with_factors({"snow": 1}),
            "there is no load case 'snow'; there are: wind, heat, settle",
        ),
        (
            lambda contact: contact.with_factors({"wind": np.inf}),
            "factor of 'wind' must be a finite number; found inf",
        ),
        (lambda contact: contact.with_factors({"wind": "1"}), "factor of 'wind' must be a finite number; found '1'"),
        (lambda contact: contact.with_factors([1.0]), r"factors by load case are needed, such as .*; found \[1.0\]"),
        (
            lambda contact: contact.with_tools({"punch": 1}),
            "displacements x, y, rotation of 2 tools must contain real numbers; found .*punch",
        ),
        (lambda contact: contact.with_tools(position=[[0, 0, 0]]), r"tools have 2 x 3 components.* of shape \(1, 3\)"),
        (
            lambda contact: contact.with_tools(position=np.zeros((3, 2))),
            r"tools have 2 x 3 components.* of shape \(3, 2\)",
        ),
        (
            lambda contact: contact.with_tools(force=[[0, np.nan, 0]] * 2),
            "forces x, y, moment on 2 tools has entries that are not",
        ),
    ],
)
def test_changes_that_do_not_fit_are_refused(change, words: str):
    with pytest.raises(ProblemError, match=words):
        change(condensed("held"))


def test_forces_that_nothing_resists_are_refused_after_condensing_too():
    """Both tools are loaded: a change on one of them would move all of them away, and no pressure can balance it."""
    zones = {**FREE["contact_zones"], "punch": {**FREE["contact_zones"]["punch"], "edges": ["head", "top"]}}
    tools = {
        "punch": {"zones": "punch", "force": {"x": 0, "y": -10}},
        "table": {"zones": "table", "force": {"y": 10}},
    }
    cases = {"more": {"tools": {"punch": {"force": {"y": -1}}, "table": {"force": {"y": 1}}}}, "weight": {
        "loads": {"gravity": {"density": 1, "acceleration": [0, -3]}}}}  # fmt: skip
    contact = analysis.condense(made(FREE, loads={}, contact_zones=zones, tools=tools, load_cases=cases))
    assert contact.with_factors({"more": 2}).tools.force.tolist() == [0, -12, 0, 0, 12, 0]
    with pytest.raises(
        ProblemError, match=r"the body, the tool 'punch' and the tool 'table' together .*resultant -5\)"
    ):
        contact.with_tools(force=[[0, -15, 0], [0, 10, 0]])
    with pytest.raises(ProblemError, match=r"nothing holds the tool 'punch' against .*along \(1, 0\).*resultant 2\)"):
        contact.with_tools(force=[[2, -10, 0], [0, 10, 0]])
    with pytest.raises(ProblemError, match=r"together against the translation along \(0, 1\).*resultant -6\)"):
        contact.with_factors({"weight": 1})
    assert {key for key in contact.changes if "rotation" not in key} == {"load_cases.more"}
    balanced = contact.with_factors({"more": 1}).with_tools(force=[[0, -15, 0], [0, 15, 0]])
    assert balanced.motion_load @ balanced.motion_load > 0


def test_none_is_empty():
    assert len(Tools.none(4, 2)) == len(LoadCases.none(4, 2, 0)) == 0
    assert Pinned.none(2, 1).violation(np.ones(3), np.ones(3)) is None


@pytest.mark.parametrize(("turns", "size"), [(True, "(moment 3 N·mm/mm)"), (False, "(resultant 3 N/mm)")])
def test_a_moment_has_its_unit(turns: bool, size: str):
    """Numbers per thickness, as in the tables."""
    pinned = replace(
        Pinned.none(0, 0), motions=("the rotation",), turns=np.array([turns]), load=np.full((1, 1), 3.0),
        tools=np.zeros((0, 1)), magnitude=np.ones(1),
    )  # fmt: skip
    words = pinned.violation(np.ones(1), np.zeros((0, 1)), {"length": "mm", "force": "N"})
    assert size in (words or "")


@pytest.mark.slow
@settings(max_examples=8, deadline=None)
@given(
    st.lists(st.sampled_from([0.1, 0.2, 0.3, 0.7, 1 / 3, 1.1]), min_size=2, max_size=4),
    st.randoms(use_true_random=False),
    st.sampled_from([1.0, 1e-3, 7e9]),
)
@example([0.1, 0.2], None, 1.0)
def test_factors_that_cancel_leave_no_load(parts: list[float], shuffled: Random | None, force: float):
    """Loads on a tool with factors such as 0.1 + 0.2 - 0.3, in any order, are those of the tool without them."""
    values = {**{f"part {i}": part for i, part in enumerate(parts)}, "back": -sum(parts)}
    names = [*values]
    if shuffled is not None:
        shuffled.shuffle(names)
    cases = {name: {"tools": {"press": {"force": {"y": -force}}}} for name in names}
    for own in (0.0, -2.0 * force):
        problem = Problem.model_validate(
            {
                "name": "block under a press",
                "material": {"young_modulus": 1000.0, "poisson_ratio": 0.3},
                "boundary": {"outer": [
                    {"name": name, "start": start, "elements": 2}
                    for name, start in (("bottom", (0, 0)), ("right", (4, 0)), ("top", (4, 2)), ("left", (0, 2)))
                ]},
                "conditions": {"left": {"displacement": {"x": 0}}},
                "contact_zones": {
                    "table": {"edges": "bottom", "surface": {"kind": "plane", "point": (0, 0), "normal": (0, 1)}},
                    "press": {"edges": "top", "surface": {"kind": "plane", "point": (0, 2), "normal": (0, -1)}},
                },
                "tools": {"press": {"zones": "press", "force": {"y": own}}},
                "load_cases": cases,
                "combinations": {"all": {name: values[name] for name in names}},
            }
        )  # fmt: skip
        action = problem.with_case("all").tool_action("press")
        assert action.load == pytest.approx((0.0, own, 0.0), rel=1e-14, abs=0.0)
        contact = analysis.condense(problem.with_value("load_cases", cases))
        for changed in (contact.with_factors(values), contact.with_factors(values).with_factors(values)):
            assert changed.tools.force == pytest.approx(contact.tools.force, rel=1e-13, abs=0.0)
            assert changed.motion_load == pytest.approx(contact.motion_load, rel=1e-13, abs=0.0)
        if own:
            assert analysis.solve(problem.with_case("all")).certificate.certified
        else:
            with pytest.raises(ProblemError, match="no load presses it onto its support"):
                analysis.solve(problem.with_case("all"))
