"""Points of contact: element lengths along the boundary."""

import numpy as np
from bodies import arc, even, mesh_of

from bemcontact.bem.contact_points import element_lengths


def test_element_lengths_are_arc_lengths():
    """A circle of 64 elements: the parabola is shorter than the arc by less than (angle)^4/480, relative."""
    mesh = mesh_of([("c", arc((0, 0), 2, 0, 360), even(64))])
    exact = 2 * np.pi / 32
    assert abs(element_lengths(mesh) / exact - 1).max() < (2 * np.pi / 64) ** 4 / 480
