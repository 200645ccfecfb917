"""Materials: plane stress and plane strain, and what is refused."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from messages import assert_each_states

from bemcontact.errors import ProblemError
from bemcontact.problems import Material


@given(st.floats(1e-6, 1e9), st.floats(-0.99, 0.49))
@example(1.0, -0.5)
def test_plane_stress_is_plane_strain_with_another_ratio_and_modulus(young_modulus, poisson_ratio):
    sheet = Material(young_modulus=young_modulus, poisson_ratio=poisson_ratio, state="plane_stress")
    thick = Material(young_modulus=young_modulus, poisson_ratio=poisson_ratio)
    assert sheet.shear_modulus == thick.shear_modulus
    assert thick.effective_poisson_ratio == poisson_ratio
    # Strain per uniaxial stress, 1/E of the sheet, is (1 - ν'²)/E' of the equivalent thick body with E' = 2G(1 + ν').
    # That is (1 - ν')/(2G), which stays finite where ν = -1/2 makes ν' = -1.
    equivalent = (1 - sheet.effective_poisson_ratio) / (2 * sheet.shear_modulus)
    assert equivalent == pytest.approx(1 / young_modulus, rel=1e-12)


@pytest.mark.parametrize("poisson_ratio", [-1, 0.6, 1, -2])
def test_ratio_beyond_positive_energy_is_refused(poisson_ratio):
    for state in ("plane_strain", "plane_stress"):
        with pytest.raises(ProblemError, match=f"greater than -1 and less than 0.5, found {poisson_ratio:g}"):
            Material(young_modulus=1, poisson_ratio=poisson_ratio, state=state)


def test_incompressible_material_needs_plane_stress():
    assert Material(young_modulus=1, poisson_ratio=0.5, state="plane_stress").effective_poisson_ratio == 0.5 / 1.5
    with pytest.raises(ProblemError, match=r"take 0\.499, or state: plane_stress"):
        Material(young_modulus=1, poisson_ratio=0.5)


def test_all_issues_of_a_material_are_reported_together():
    with pytest.raises(ProblemError) as caught:
        Material(young_modulus=-1, poisson_ratio="0.3")
    facts = [
        "young_modulus: … greater than 0, found -1",
        "poisson_ratio: … a number, found … '0.3'; leave the quotes out",
    ]
    assert_each_states(map(str, caught.value.issues), facts)
