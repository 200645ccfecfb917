"""The amplitude of a pressure that oscillates from point to point."""

from dataclasses import replace

import numpy as np
import pytest
from contact_problems import random_contact

from bemcontact.adaptivity.oscillation import oscillation
from bemcontact.contact.condensed_contact import CondensedContact

ARC = np.cumsum(np.random.default_rng(3).uniform(0.2, 2.0, 30))
SMOOTH = np.polynomial.polynomial.polyval(ARC / ARC[-1], [3.0, 1.0, -2.0, 1.5])


def contact_on(arc: np.ndarray) -> CondensedContact:
    return replace(random_contact(1, len(arc), 1), arc_position=arc, run=np.zeros(len(arc), int))


def test_a_cubic_does_not_oscillate():
    """The result is exact on any spacing."""
    assert oscillation(contact_on(ARC), SMOOTH) <= 1e-13


def test_the_edge_of_a_contact_does_not_oscillate():
    """sqrt(1 - x²) on equal points up to its end, where polynomials differ from it to one side only."""
    x = np.linspace(0, 1, 30, endpoint=False)
    assert oscillation(contact_on(x), np.sqrt(1 - x**2)) == 0


def test_amplitude_of_an_alternating_part_is_exact():
    """A cubic and ±a: the divided difference contains only a, on any spacing."""
    p = SMOOTH + 0.05 * (-1.0) ** np.arange(30)
    assert oscillation(contact_on(ARC), p) == pytest.approx(0.05 / p.max(), rel=1e-9)
    order = np.random.default_rng(4).permutation(30)
    assert oscillation(contact_on(ARC[order]), p[order]) == pytest.approx(0.05 / p.max(), rel=1e-9)


def test_few_points_are_not_enough():
    """Eight in a row under pressure are enough."""
    assert oscillation(contact_on(ARC), np.zeros(30)) is None
    assert oscillation(contact_on(ARC), np.where(np.arange(30) % 8, SMOOTH, 0.0)) is None
    assert oscillation(contact_on(ARC), np.where(np.arange(30) % 9, SMOOTH, 0.0)) is not None
    assert oscillation(contact_on(ARC[:7]), SMOOTH[:7]) is None
