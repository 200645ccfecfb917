"""Contact states made to measure, and bodies on few supports."""

from dataclasses import replace

import numpy as np
from contact_problems import random_contact

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.load_cases import Change, LoadCases, Tools


def degenerate(seed: int, n: int, k: int, weak: int) -> tuple[CondensedContact, np.ndarray, np.ndarray]:
    """A random body in a state with so many points without pressure and gap, and k + 1 or more with pressure.

    The offset and the load are made from the state, so that it is the solution; returned with its pressure and gap.
    """
    rng = np.random.default_rng(seed + 500)
    body = random_contact(seed, n, k)
    p, gap = np.zeros(n), np.zeros(n)
    strong = max((n - weak) // 2, min(k + 1, n - weak))
    p[:strong], gap[strong + weak :] = rng.uniform(0.5, 2, strong), rng.uniform(0.5, 2, n - strong - weak)
    a = rng.standard_normal(k)
    offset = gap - body.compliance @ p - body.rigid_motions @ a
    made = replace(body, initial_gap=offset - body.free_displacement, motion_load=-body.equilibrium.T @ p)
    return made, p, gap


def random_change(seed: int, contact: CondensedContact) -> Change:
    rng = np.random.default_rng(seed + 900)
    return Change(rng.standard_normal(contact.size), rng.standard_normal(contact.free_motions))


def changed(contact: CondensedContact, change: Change, step: float) -> CondensedContact:
    return replace(
        contact,
        initial_gap=contact.initial_gap + step * change.offset,
        motion_load=contact.motion_load + step * change.motion_load,
    )


def without_load(contact: CondensedContact) -> CondensedContact:
    """The same body where all that acts on it are loads, and none of them does."""
    return replace(
        contact,
        free_displacement=0 * contact.free_displacement,
        motion_load=0 * contact.motion_load,
        cases=contact.cases,
    )


def rocker(at: float, load: float = 1.0, gap: float = 0.3) -> CondensedContact:
    """A block on springs of compliance 0.1 at x = -1, 0, 1, the outer ones lower by `gap`; a load at x = `at`."""
    return CondensedContact.from_compliance(
        0.1 * np.eye(3),
        [gap, 0, gap],
        rigid_motions=np.column_stack([np.ones(3), [-1, 0, 1]]),
        motion_load=[-load, -load * at],
    )


def half_plane(n: int, load: float) -> CondensedContact:
    """A parabola pressed by `load` into a half-plane of E/(1-ν²) = 1, by n strips of pressure on [-1, 1]."""
    x = np.linspace(-1, 1, n)
    h = 2 / (n - 1)

    def primitive(s):
        return s * np.log(np.abs(s)) - s

    d = np.abs(x[:, None] - x)
    compliance = -(2 / np.pi) * (primitive(d + h / 2) - primitive(d - h / 2)) + 2 * h
    return CondensedContact.from_compliance(
        compliance, x**2 / 2, np.full(n, h), rigid_motions=np.ones(n), motion_load=[-load]
    )


def between_tools() -> CondensedContact:
    """A random body with a load case, under a tool that is pushed sideways, loaded downwards, and kept from turning."""
    rng, n = np.random.default_rng(11), 9
    body = random_contact(2, n, 0)
    motions = np.column_stack([rng.uniform(-0.3, 0.3, n), np.ones(n), rng.uniform(-1, 1, n)])
    tools = Tools(
        names=("punch",),
        point=np.zeros((1, 2)),
        motions=motions,
        amplitudes=np.array([[0.0], [1.0], [0.0]]),
        free=np.array([False, True, False]),
        position=np.array([0.2, 0.0, 0.1]),
        force=np.array([0.0, -3.0, 0.0]),
    )
    cases = LoadCases(
        names=("wind",),
        displacement=rng.standard_normal((n, 1)),
        motion_load=np.zeros((1, 1)),
        position=np.array([[0.1], [0.0], [0.0]]),
        force=np.array([[0.0], [-0.5], [0.0]]),
        factors=np.zeros(1),
    )
    stated = CondensedContact.from_compliance(
        body.compliance, rng.uniform(0, 1, n), body.weights, rigid_motions=motions[:, [1]], motion_load=[-3.0]
    )
    return replace(stated, initial_gap=stated.initial_gap + motions @ tools.position, tools=tools, cases=cases)
