"""What holds bonded nodes together, and bodies that might spin."""

import numpy as np
import pytest
from several_bodies import HELD, block, elastic, problem

from bemcontact.analysis.solve import solve
from bemcontact.bem.body import body_of
from bemcontact.bem.condense import boundary_state, condense
from bemcontact.errors import ProblemError

MIDDLE = np.array([0.3, 2.0])


def disk_between_blocks(modulus, *, bore=False, load=None):
    rim = {"name": "rim", "kind": "arc", "center": MIDDLE.tolist(), "radius": 2, "angles": [80, 440], "elements": 61}
    hole = {"name": "bore", "kind": "arc", "center": [0.6, 2.5], "radius": 0.5, "angles": [360, 0], "elements": 10}
    bodies = {
        "disk": elastic({"outer": [rim], "holes": [[hole]] if bore else []}, {"bore": load} if load else {}, modulus),
        "base": elastic(block((-2, 4), (-3, 0), (40, 6, 40, 6)), HELD),
        "lid": elastic(block((-1, 5), (4, 6), (40, 6, 40, 6)), {"top": {"displacement": {"x": 0, "y": -0.02}}}),
    }
    return problem(bodies, low=["disk", "base"], high=["disk", "lid"])


@pytest.mark.parametrize("bore", [False, True])
@pytest.mark.parametrize("modulus", [10.0, 1000.0, 1e6])
def test_a_disk_that_might_spin_is_in_equilibrium_and_does_not_spin(modulus, bore):
    """Common normals miss its center; traction around the center makes up for it, and has no force."""
    condensation = condense(body_of(disk_between_blocks(modulus, bore=bore)))
    solution = solve(condensation.contact).solution
    state = boundary_state(condensation, solution.pressure, solution.rigid_amplitudes)
    disk = condensation.body.mesh.parts[0]
    arms, length = state.points[disk.elements] - MIDDLE, disk.mesh.tributary
    around, t = np.stack([-arms[..., 1], arms[..., 0]], axis=-1), state.traction[disk.elements]
    total = (length * np.hypot(*np.moveaxis(t, 2, 0))).sum()
    assert np.abs(np.einsum("mk,mki->i", length, t)).max() < 1e-11 * total
    assert abs(np.einsum("mk,mki,mki->", length, t, around)) < 1e-12 * total
    spin = around - np.average(around.reshape(-1, 2), axis=0, weights=length.ravel())
    u = state.displacement[disk.elements]
    assert abs(np.einsum("mk,mki,mki->", length, u, spin)) < 1e-11 * np.einsum("mk,mki->", length, abs(u))


def test_compliance_of_a_disk_that_might_spin_is_as_symmetric_as_that_of_a_held_one():
    """With the weights it is symmetric up to discretization; what holds the spin adds nothing to that."""
    free, held = (
        condense(body_of(disk_between_blocks(1000.0, bore=True, load=load))).contact for load in (None, {"fixed": True})
    )
    errors = []
    for contact in (free, held):
        forces = contact.weights[:, None] * contact.compliance
        errors.append(abs(forces - forces.T).max() / abs(forces).max())
    assert errors[0] < 1.1 * errors[1]


def test_a_couple_on_a_disk_that_might_spin_is_refused():
    """Nothing holds it. A pressure on a bore beside the middle has no force and no couple."""
    body_of(disk_between_blocks(1000.0, bore=True, load={"pressure": 1.0}))
    with pytest.raises(ProblemError, match=r"nothing holds the body 'disk' against the rotation .* about \(0.3, 2\)"):
        body_of(disk_between_blocks(1000.0, bore=True, load={"traction": {"x": {"constant": 0.0, "y": 1.0}}}))
