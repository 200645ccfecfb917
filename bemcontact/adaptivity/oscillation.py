"""Oscillation of a computed pressure from point to point, which no real contact pressure shows."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact


def oscillation(contact: CondensedContact, pressure: Array) -> float | None:
    """Largest amplitude of a pressure (n,) that oscillates from point to point, over the peak pressure.

    Five points in a row under pressure have one alternating part ±a, the distance from a cubic, which the fourth
    divided difference measures. If four such parts in a row alternate, the pressure oscillates by the least of them. A
    smooth pressure has almost none, however it bends. None if no eight points in a row are under pressure.
    """
    amplitudes: list[float] = []
    for run in np.unique(contact.run):
        own = contact.points_of_run(run)
        if len(own) >= 8:
            parts = sliding_window_view(_alternating(contact.arc_position[own], pressure[own]), 4)
            pressed = sliding_window_view(pressure[own] > 0, 8).all(axis=1)
            alternates = (parts[:, 1:] * parts[:, :-1] < 0).all(axis=1)
            amplitudes += (np.abs(parts).min(axis=1) * alternates)[pressed].tolist()
    return max(amplitudes) / peak if amplitudes and (peak := contact.peak(pressure)) > 0 else None


def _alternating(arc: Array, pressure: Array) -> Array:
    """Alternating part (n - 4,) of each five points in a row, with the sign of the middle one."""
    s, p = sliding_window_view(arc, 5), sliding_window_view(pressure, 5)
    weights = 1 / (s[:, :, None] - s[:, None, :] + np.eye(5)).prod(axis=2)  # of the divided difference; they alternate
    return (weights * p).sum(axis=1) / np.abs(weights).sum(axis=1)
