"""Contact states and their derivatives by a trial of all sets of points: slow, and independent of every method."""

from collections.abc import Iterator
from itertools import chain, combinations

import numpy as np

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.load_cases import Change

LOOSE = 1e-9
"""Of numbers of size one."""


def subsets(points: np.ndarray) -> Iterator[list[int]]:
    return map(list, chain.from_iterable(combinations(points.tolist(), m) for m in range(len(points) + 1)))


def state(contact: CondensedContact) -> tuple[np.ndarray, np.ndarray]:
    """The pressure and gap of a contact problem of few points."""
    nothing = np.array([], int)
    change = Change(contact.offset, contact.motion_load)
    return derivative(contact, change, nothing, np.arange(contact.size))


def derivative(
    contact: CondensedContact, change: Change, strong: np.ndarray, weak: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """δ̇ = 0 on strong points, 0 <= ṗ ⟂ δ̇ >= 0 on weak ones, ṗ = 0 elsewhere, ℓᵀṗ = -load."""
    M, R, ell = contact.compliance, contact.rigid_motions, contact.equilibrium
    n, k = R.shape
    for loaded in subsets(weak):
        A = np.append(strong, loaded).astype(int)
        block = np.block([[M[np.ix_(A, A)], R[A]], [ell[A].T, np.zeros((k, k))]])
        right = -np.append(change.offset[A], change.motion_load)
        x = np.linalg.lstsq(block, right, rcond=None)[0] if len(right) else right
        if not np.allclose(block @ x, right, atol=LOOSE):
            continue
        p = np.zeros(n)
        p[A] = x[: len(A)]
        gap = change.offset + M @ p + R @ x[len(A) :]
        if p[weak].min(initial=0.0) >= -LOOSE and gap[weak].min(initial=0.0) >= -LOOSE:
            return p, gap
    raise AssertionError("no set of points will do")
