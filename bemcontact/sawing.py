"""Pressures that go up and down from point to point, as no contact does."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from bemcontact.contact import Array, CondensedContact


def sawing(contact: CondensedContact, pressure: Array) -> float:
    """Largest amplitude of a pressure that saws, over the peak pressure.

    A point is off by its distance from the cubic through the two points before and the two after it, where pressure
    acts on all five. Four points in a row that are off to alternate sides saw by the least of the four distances. A
    smooth pressure has nearly none of it, however it bends.

    Parameters
    ----------
    contact : CondensedContact
    pressure : (n,) at the contact points [p]

    Returns
    -------
    float
        0 where no eight points in a row are under pressure, or none at all.
    """
    amplitudes = [0.0]
    for run in np.unique(contact.run):
        own = np.flatnonzero(contact.run == run)
        own = own[np.argsort(contact.arc_position[own], kind="stable")]
        if len(own) >= 8:
            off = sliding_window_view(_off_cubics(contact.arc_position[own], pressure[own]), 4)
            alternate = (off[:, 1:] * off[:, :-1] < 0).all(axis=1)
            amplitudes.append(float((np.abs(off).min(axis=1) * alternate).max()))
    return max(amplitudes) / peak if (peak := contact.peak(pressure)) > 0 else 0.0


def _off_cubics(arc: Array, pressure: Array) -> Array:
    """Distances (n - 4,) of points from the cubics through their four neighbours; 0 where one of these is open."""
    s, p = sliding_window_view(arc, 5), sliding_window_view(pressure, 5)
    apart = s[:, :, None] - s[:, None, :] + np.eye(5)  # the divided difference of fourth order, by its own weight of p
    weights = 1 / apart.prod(axis=2)
    return np.where((p > 0).all(axis=1), (weights * p).sum(axis=1) / weights[:, 2], 0.0)
