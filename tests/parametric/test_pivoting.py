"""The one-sided derivative of a contact state against exhaustive search and against states a step further."""

import exhaustive
import numpy as np
import pytest
from contact_states import changed, degenerate, random_change, rocker

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.load_cases import Change
from bemcontact.errors import ProblemError
from bemcontact.formulations import complementarity
from bemcontact.formulations.scaling import scale, scaled_change, scaled_point, unscaled
from bemcontact.parametric.pivoting import Tangent, is_monotone


def tangent_of(contact: CondensedContact) -> Tangent:
    scaled, solution = scale(contact), complementarity.solve(contact)
    p, a = scaled_point(contact, solution.pressure, solution.rigid_amplitudes)
    return Tangent.at(scaled, p, scaled.gap(p, a), a, is_monotone(scaled))


def rate_of(contact: CondensedContact, change: Change) -> tuple[np.ndarray, np.ndarray]:
    rate = tangent_of(contact).rate(scaled_change(contact, change))
    return unscaled(contact, rate.pressure, rate.amplitudes)[0], rate.gap * contact.scales.displacement


@pytest.mark.parametrize("seed", range(24))
def test_derivative_is_that_of_exhaustive_search(seed: int):
    """Up to 2⁴ sets of weakly active points are tried; with sym(JM) definite one of them alone has a derivative.

    The numbers are of size 10 and the blocks of condition 1e3 at most: 1e-10 is a thousand times round-off.
    """
    contact, p, _ = degenerate(seed, n=8, k=seed % 3, weak=seed % 5)
    change = random_change(seed, contact)
    strong = np.flatnonzero(p > 0)
    weak = np.arange(len(strong), len(strong) + seed % 5)
    expected = exhaustive.derivative(contact, change, strong, weak)
    np.testing.assert_allclose(rate_of(contact, change), expected, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("seed", range(12))
def test_derivative_is_the_difference_to_a_state_a_step_further(seed: int):
    """States are piecewise linear: a step before the next breakpoint gives the derivative up to 1e-14 / step."""
    contact, _, _ = degenerate(seed, n=9, k=seed % 3, weak=3)
    change, step = random_change(seed, contact), 1e-5
    now, then = (complementarity.solve(item).pressure for item in (contact, changed(contact, change, step)))
    rate = rate_of(contact, change)[0]
    np.testing.assert_allclose(rate, (then - now) / step, atol=1e-8 * np.abs(rate).max())


@pytest.mark.parametrize("size", [1.0, 1e-2, 1e-3])
def test_a_gap_is_closed_if_next_to_no_pressure_closes_it(size: float):
    """Short elements have little compliance: it takes a large pressure to close a small gap there."""
    scaled = scale(CondensedContact.from_compliance(np.diag([1.0, size]), [-1.0, 0.0], [1.0, 1.0]))
    pressure = np.array([1.0, 0.0])
    for part, weak in ((1e-9, False), (1e-11, True)):
        tangent = Tangent.at(scaled, pressure, np.array([0.0, 2 * part * size]), np.zeros(0), True)
        assert tangent.weak.tolist() == [1] * weak


def test_weak_points_join_where_strong_ones_do_not_hold_the_body():
    """All of a unit load on the middle support, the outer ones level with it as it sinks by 0.1.

    Moving the load to the right by dx, statics about the middle loads the right support by dx and takes dx from the
    middle one. The block rises there by 0.1 dx and sinks at the right by as much: on that line it rises by 0.3 dx at
    the left.
    """
    p, gap = rate_of(rocker(0.0, gap=0.1), Change(np.zeros(3), np.array([0.0, -1.0])))
    np.testing.assert_allclose(p, [0, -1, 1], atol=1e-13)
    np.testing.assert_allclose(gap, [0.3, 0, 0], atol=1e-13)


def test_load_that_the_points_in_contact_do_not_carry_is_refused():
    with pytest.raises(ProblemError, match="do not carry the change of the load"):
        rate_of(rocker(0.0), Change(np.zeros(3), np.array([0.0, -1.0])))


def test_body_that_is_not_held_is_refused():
    """More load on the middle support alone leaves it open how the block turns."""
    with pytest.raises(ProblemError, match="do not hold the body"):
        rate_of(rocker(0.0), Change(np.zeros(3), np.array([-1.0, 0.0])))


def indefinite(offset: list[float]) -> CondensedContact:
    """Two points of which each pulls the other down: M has the eigenvalues 3 and -1."""
    return CondensedContact.from_compliance([[1.0, 2.0], [2.0, 1.0]], offset)


def test_state_that_may_go_on_in_two_ways_is_refused():
    """With p = (1, 0) both points touch. As the second gap would open, it may also stay closed under a pressure.

    As it would close, p = (1 - 2 z, z) has the second gap -3 z - t: no z >= 0 keeps it closed.
    """
    contact = indefinite([-1.0, -2.0])
    scaled = scale(contact)
    p, a = scaled_point(contact, np.array([1.0, 0.0]), np.zeros(0))
    tangent = Tangent.at(scaled, p, scaled.gap(p, a), a, is_monotone(scaled))
    assert not tangent.unique
    with pytest.raises(ProblemError, match="more than one way"):
        tangent.rate(Change(np.array([0.0, 1.0]), np.zeros(0)))
    with pytest.raises(ProblemError, match="turns back or ends"):
        tangent.rate(Change(np.array([0.0, -1.0]), np.zeros(0)))
