"""A contact problem with a displaced tool, a loaded one, and two load cases, for the tests of the modelling layer."""

from dataclasses import replace

import numpy as np

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.load_cases import LoadCases, Tools


def tool_contact(seed: int = 0, n: int = 20, units: tuple[float, float] = (1.0, 1.0)) -> CondensedContact:
    """A row of points above a stamp that is displaced and a punch that is loaded along y and may tilt.

    M is not in the gauge of the punch. `units` are factors of length and stress.
    """
    L, S = units
    rng = np.random.default_rng(seed)
    A, T = rng.standard_normal((2, n, n))
    x, J = np.linspace(-1, 1, n) * L, rng.uniform(0.05, 0.15, n) * L
    compliance = (A @ A.T / n + 0.05 * np.eye(n) + 0.05 * (T - T.T)) / (J[:, None] / L) * L / S
    stamp = x < 0
    motions = np.zeros((n, 6))
    motions[stamp, 1], motions[stamp, 2] = -1.0, -x[stamp]
    motions[~stamp, 4], motions[~stamp, 5] = -1.0, -(x[~stamp] - 0.5 * L)
    amplitudes = np.zeros((6, 2))
    amplitudes[4, 0], amplitudes[5, 1] = 1.0, 1.0
    free = np.array([False, False, False, False, True, True])
    tools = Tools(
        names=("stamp", "punch"), point=np.array([[0.0, 0.0], [0.5 * L, 0.0]]), motions=motions, amplitudes=amplitudes,
        free=free, position=np.zeros(6), force=np.zeros(6),
    )  # fmt: skip
    position, force = np.zeros((6, 2)), np.zeros((6, 2))
    position[1, 0], force[4, 1] = 0.05 * L, 0.2 * S * L
    cases = LoadCases(
        names=("dead", "live"), displacement=0.1 * rng.standard_normal((n, 2)) * L, motion_load=np.zeros((2, 2)),
        position=position, force=force, factors=np.zeros(2),
    )  # fmt: skip
    plain = CondensedContact.from_compliance(compliance, rng.uniform(0, 0.5, n) * L, J)
    contact = replace(
        plain, points=np.column_stack([x, 0 * x]), arc_position=x + L, rigid_motions=motions @ amplitudes,
        motion_load=np.zeros(2), motion_names=("punch along y", "punch tilts"), tools=tools, cases=cases,
    )  # fmt: skip
    given = np.array([[0, 0.2 * L, 0.03], [0, 0, 0]]), np.array([[0, 0, 0], [0, 0.4 * S * L, 0.02 * S * L**2]])
    return contact.with_factors({"dead": 1.0}).with_tools(
        contact.with_factors({"dead": 1.0}).tools.position + given[0].ravel(), given[1]
    )
