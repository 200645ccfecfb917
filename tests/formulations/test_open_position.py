"""The position that is not determined: a rule chooses it, whatever the units and the path of the solver are."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bemcontact import CondensedContact, Problem, condense, solve
from bemcontact.assessment.certificate import CertificateKind
from bemcontact.formulations.open_position import farthest

NOTE = "not determined: the"


def loose(slopes: list[float], gaps: list[float], length: float = 1.0, stress: float = 1.0) -> CondensedContact:
    """Two pressed points see the first motion only; points beside them see the second with slopes, in which no load is.

    One of them sees it each way round, so that the second motion is bounded.
    """
    slopes, gaps = [1.0, -1.0, *slopes], [2.0, 3.0, *gaps]
    n = 2 + len(slopes)
    R = np.column_stack([np.append([1.0, 1.0], np.zeros(n - 2)), np.append([0.0, 0.0], slopes)])
    return CondensedContact.from_compliance(
        np.eye(n) * length / stress, np.append([0.0, 0.1], gaps) * length, np.full(n, length),
        rigid_motions=R, motion_load=np.array([-1.0, 0.0]) * stress * length,
    )  # fmt: skip


many = st.lists(st.floats(-1, 1), min_size=1, max_size=4)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(
    slopes=many,
    data=st.data(),
    length=st.sampled_from([1e-6, 0.1, 7.0, 1e9]),
    formulation=st.sampled_from(["complementarity", "qp3"]),
)
def test_open_amplitude_is_the_nearest_that_closes_no_gap(
    slopes: list[float], data: st.DataObject, length: float, formulation: str
):
    """By the closed form for one motion: the least squares of R a, cut to the interval that the gaps leave."""
    gaps = data.draw(st.lists(st.floats(-1, 2), min_size=len(slopes), max_size=len(slopes)))
    contact = loose(slopes, gaps, length, 1 / length)
    s, q = np.append([1.0, -1.0], slopes), np.append([2.0, 3.0], gaps)
    seen = abs(s) > 1e-6
    assume((abs(q[~seen]) > 1e-3).all() and (q[~seen] > 0).all())
    low = max(-q[s > 1e-6] / s[s > 1e-6])
    high = min(q[s < -1e-6] / -s[s < -1e-6])
    assume(high - low > 1e-3)
    result = solve(contact, formulation)
    levers = np.abs(s[(s != 0.0)])
    assert result.certified or (levers.min() < 1e-6 and result.certificate.kind is CertificateKind.OPEN)
    assert result.solution.rigid_amplitudes[1] / length == pytest.approx(np.clip(0.0, low, high), abs=1e-8)
    assert any(NOTE in note and "motion 2" in note and "motion 1" not in note for note in result.notes)


def test_amplitude_that_contact_determines_has_no_note():
    """Equal gaps on both sides lock the motion, and a load along it presses on one side."""
    locked = loose([1.0, -1.0], [0.5, -0.5])
    assert not any(NOTE in note for note in solve(locked).notes)
    pushed = CondensedContact.from_compliance(
        locked.compliance, locked.offset, locked.weights, rigid_motions=locked.rigid_motions, motion_load=[-1.0, -0.1]
    )
    assert not any(NOTE in note for note in solve(pushed).notes)


def block_under_ridge(length: float, stress: float) -> Problem:
    """A block on a plane under a loaded tool with flanks at a distance on both sides; its corners are over nodes."""
    corners = np.array([(0, 0), (10, 0), (10, 10), (0, 10)]) * length
    ridge = np.array([(9, 10.5), (8, 10), (2, 10), (1, 10.5)]) * length
    names = ("bottom", "right", "top", "left")
    return Problem.model_validate(
        {
            "name": "block under a ridge",
            "material": {"young_modulus": 1000.0 * stress, "poisson_ratio": 0.3},
            "boundary": {
                "outer": [
                    {"name": name, "start": tuple(start), "elements": 5}
                    for name, start in zip(names, corners.tolist(), strict=True)
                ]
            },
            "contact_zones": {
                "table": {"edges": ["bottom"], "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
                "tool": {"edges": ["top"], "surface": {"kind": "polyline", "points": ridge.tolist()}},
            },
            "tools": {
                "tool": {
                    "zones": "tool",
                    "point": [5 * length, 10 * length],
                    "force": {"y": -30 * stress * length, "moment": 3 * stress * length**2},
                }
            },
        }
    )


@pytest.mark.slow
def test_units_do_not_move_a_body_that_contact_leaves_open():
    """The same block in seven systems of units: the same position, note and verdict."""
    units = [(1, 1), (1e-9, 1e-9), (10, 1), (10, 1e9), (7, 1), (1e9, 1e-9), (3, 1e9)]
    results = [(solve(block_under_ridge(*unit)), unit[0]) for unit in units]
    first = results[0][0].solution.rigid_amplitudes
    for result, length in results:
        assert result.certified
        assert result.solution.rigid_amplitudes / length == pytest.approx(first, rel=1e-8, abs=1e-10)
        assert any(NOTE in note and "translation along (1, 0)" in note for note in result.notes)


@pytest.mark.parametrize("lengths", [(1.0, 1e3), (1.0, 1e-6)])
def test_balance_of_loads_on_tools_has_no_unit(lengths: tuple[float, float]):
    """Moments are compared with forces by the size of the body, not by the unit of length."""
    one, other = (condense(block_under_ridge(length, 1.0)) for length in lengths)
    assert other.net_load == pytest.approx(one.net_load, rel=1e-9)
    assert other.pinned.length / lengths[1] == pytest.approx(one.pinned.length / lengths[0], rel=1e-12)


@pytest.mark.slow
def test_units_do_not_decide_a_sliding_tool_whose_corners_stand_over_nodes():
    """Under a gap, the normals at its corners are those of its flat, so that no pressed point sees the tool slide."""
    found = []
    for length, stress in ((1.0, 1.0), (1e-12, 1e12), (7.3e8, 3e10), (3e-11, 1.0)):
        for gap in (1e-7, 1e-3):
            data = block_under_ridge(length, stress).model_dump()
            c, s = np.cos(0.3), np.sin(0.3)
            turn = np.array([(c, s), (-s, c)])
            ridge = np.array([(9, 10.5), (8, 10 + gap), (2, 10 + gap), (1, 10.5)]) * length
            for edge in data["boundary"]["outer"]:
                edge["start"] = tuple((np.array(edge["start"]) @ turn).tolist())
                edge.pop("end", None)
            table, tool = (data["contact_zones"][name]["surface"] for name in ("table", "tool"))
            table["normal"], tool["points"] = tuple(turn[1].tolist()), (ridge @ turn).tolist()
            force = np.array([0.0, -30.0]) @ turn * stress * length
            data["tools"]["tool"]["point"] = (np.array([5.0, 10.0]) * length @ turn).tolist()
            data["tools"]["tool"]["force"] = {"x": force[0], "y": force[1], "moment": 3 * stress * length**2}
            result = solve(Problem.model_validate(data))
            assert result.certified
            assert any(NOTE in note for note in result.notes)
            found.append(result.solution.pressure / stress)
    for pressure in found[2::2]:
        np.testing.assert_allclose(pressure, found[0], rtol=0, atol=1e-9 * found[0].max())


@settings(max_examples=100)
@given(seed=st.integers(0, 10**6), decades=st.integers(-8, 7))
def test_motion_far_beyond_one_is_found(seed: int, decades: int):
    """A known motion of any size keeps all gaps open up to the end of the step: so does the one that is found."""
    rng = np.random.default_rng(seed)
    rows, known = rng.standard_normal((rng.integers(1, 8), rng.integers(1, 4))), 10.0**decades * rng.standard_normal(4)
    known = known[: rows.shape[1]]
    values = np.zeros(len(rows))
    rates = -(rows @ known) + 10.0**decades * rng.random(len(rows)) * rng.integers(0, 2, len(rows))
    step, moved = farthest(values, rates, rows, 1.0)
    left = values + step * rates + rows @ moved
    assert step == pytest.approx(1.0)
    assert left.min() >= -1e-9 * 10.0**decades
