"""Contact problems that stand for all, for the tests of every room."""

from dataclasses import replace

import numpy as np

from bemcontact.contact.condensed_contact import CondensedContact


def random_contact(seed: int, n: int, k: int) -> CondensedContact:
    """Unsymmetric compliance with sym(JM) positive definite, and a load that some p >= 0 carries."""
    rng = np.random.default_rng(seed)
    A, S = rng.standard_normal((2, n, n))
    J = rng.uniform(0.3, 1.5, n)
    R = rng.standard_normal((n, k))
    carried = np.maximum(rng.standard_normal(n), 0.0)
    return CondensedContact.from_compliance(
        (A @ A.T / n + 0.05 * np.eye(n) + 0.1 * (S - S.T)) / J[:, None],
        rng.standard_normal(n),
        J,
        rigid_motions=R,
        motion_load=-(J[:, None] * R).T @ carried,
    )


def in_units(problem: CondensedContact, length: float, stress: float) -> CondensedContact:
    """The same problem in units of length and stress that make its numbers larger by these factors."""
    return replace(
        problem,
        compliance=problem.compliance * length / stress,
        free_displacement=problem.free_displacement * length,
        initial_gap=problem.initial_gap * length,
        weights=problem.weights * length,
        motion_load=problem.motion_load * stress * length,
    )


def resting() -> CondensedContact:
    """A body that only a plane holds, pressed down: one free motion, away from the plane at all points."""
    rng, n = np.random.default_rng(8), 7
    A = rng.standard_normal((n, n))
    return CondensedContact.from_compliance(
        A @ A.T / n + 0.1 * np.eye(n), rng.uniform(0, 1, n), rigid_motions=np.ones(n), motion_load=-n
    )
