"""What acts on a body, permanent and by load case: it adds up to what a spec without load cases would say."""

import numpy as np
import pytest
from tool_problems import FREE, FREE_BY_HAND, FREE_CASES, HELD, HELD_BY_HAND, HELD_CASES, Spec, made

from bemcontact.bem.body import Body, body_of
from bemcontact.bem.loading import case_loadings, combined, permanent_loading
from bemcontact.bem.mesh import build
from bemcontact.bem.rigid_motions import all_rigid_motions
from bemcontact.errors import ProblemError

PAIRS = [(HELD, HELD_CASES, HELD_BY_HAND), (FREE, FREE_CASES, FREE_BY_HAND)]


def acting(body: Body) -> list[np.ndarray]:
    """All that is known of what acts, as arrays."""
    loading = body.acting
    found = [loading.values.displacement, loading.values.traction, loading.true_force, np.array(loading.true_moment)]
    part = loading.particular
    return [*found, part.displacement, part.traction, part.force, np.array(part.moment), body.forces]


@pytest.mark.parametrize(("spec", "cases", "by_hand"), PAIRS)
def test_combination_acts_as_what_is_written_by_hand(spec: Spec, cases: Spec, by_hand: Spec):
    """Linear: sums of products of the same numbers, to round-off."""
    body, other = body_of(made(spec, **cases, case="all")), body_of(made(spec, **by_hand))
    for found, known in zip(acting(body), acting(other), strict=True):
        assert found == pytest.approx(known, rel=1e-13, abs=1e-13 * max(1e-12, float(np.abs(known).max())))
    assert body.tools.position @ body.factors == pytest.approx(other.tools.position[:, 0], rel=1e-14)
    assert body.motion_load(body.seen) @ body.factors == pytest.approx(other.motion_load(other.seen)[:, 0], abs=1e-12)


def test_a_case_alone_has_nothing_of_what_is_permanent():
    """Displacements that it does not give are 0 where the problem holds the body, and held all the same."""
    problem = made(HELD, **HELD_CASES)
    mesh = build(problem)
    permanent, loadings = permanent_loading(problem, mesh), case_loadings(problem, mesh)
    wind, heat, settle, spin, push = loadings
    for case in loadings:
        assert (case.values.displacement_given == permanent.values.displacement_given).all()
        assert (case.values.traction_unknown == permanent.values.traction_unknown).all()
    assert wind.resultant(mesh) == pytest.approx([1, -2 - 1.5])  # edges of length 1
    assert heat.resultant(mesh) == pytest.approx([0, 0])
    assert spin.resultant(mesh) == pytest.approx([0.5 * 4 * 2 * 1, 0.5 * 4 * 2 * 0.5])  # density, ω², area, centroid
    held = permanent.values.displacement_given
    assert settle.values.displacement[held[:, 1], 1] == pytest.approx(np.full(7, -0.002))
    assert not settle.values.displacement[:, 0].any()
    for case in (wind, heat, spin, push):
        assert not case.values.displacement.any()
    assert not push.values.traction.any()


def test_true_work_is_that_of_the_resultant():
    problem = made(HELD, **HELD_CASES)
    mesh = build(problem)
    motions = all_rigid_motions(mesh)
    for case in case_loadings(problem, mesh):
        assert case.true_work(mesh, motions) == pytest.approx(case.work(mesh, motions), abs=1e-12)  # straight edges


def test_magnitudes_do_not_cancel():
    """What balances is still a load: of a sum with factors 1 and -1 the magnitude is the sum of both."""
    problem = made(HELD, **HELD_CASES)
    mesh = build(problem)
    spin = case_loadings(problem, mesh)[3]
    nothing = combined([spin, spin], [1.0, -1.0])
    assert not nothing.particular.force.any()
    assert nothing.magnitude(mesh) == pytest.approx(2 * spin.magnitude(mesh))


def test_contradiction_at_a_corner_is_told_with_the_load_case():
    """Two edges are held at 0; a load case moves one of them only."""
    conditions = {"left": {"displacement": {"x": 0, "y": 0}}, "top": {"displacement": {"x": 0, "y": 0}}}
    cases = {"settle": {"conditions": {"left": {"displacement": {"y": -0.1}}}}}
    with pytest.raises(ProblemError) as caught:
        body_of(made(HELD, conditions=conditions, load_cases=cases))
    (issue,) = caught.value.issues
    assert issue.path[:4] == ("load_cases", "settle", "conditions", "left")
    assert "prescribe different displacements along y; make them agree" in issue.message
