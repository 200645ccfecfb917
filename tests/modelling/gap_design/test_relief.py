"""The set of profiles: rows are the differences that they are named for, bounds that exclude each other are named."""

from dataclasses import replace

import numpy as np
import pytest

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import ProblemError
from bemcontact.modelling.gap_design.relief import Profiles, Relief

ARC = np.array([0.0, 1.0, 1.5, 3.0, 4.0, 6.0, 0.0, 2.0])
"""Eight points in two zones, six on the first run and two on the second."""


def contact() -> CondensedContact:
    plain = CondensedContact.from_compliance(np.eye(8), np.zeros(8))
    run = np.array([0, 0, 0, 0, 0, 0, 1, 1])
    return replace(
        plain, arc_position=ARC, run=run, zone=run, run_length=np.full(2, np.inf), zone_names=("foot", "toe")
    )


def corners(profiles: Profiles, count: int = 40) -> list[np.ndarray]:
    rng = np.random.default_rng(0)
    return [profiles.shapes @ profiles.extreme(rng.standard_normal(8)) for _ in range(count)]


def test_corners_keep_the_bounds_and_reach_them():
    """By differences over arc length written here again; a corner of the set reaches some of them."""
    relief = Relief(lower=-1.0, upper=(0.5, 1, 1, 1, 1, 0.2), slope=(-0.3, 0.6), curvature=0.4)
    profiles = Profiles.of(contact(), relief, "foot")
    profile = np.array(corners(profiles))
    assert (profile[:, 6:] == 0).all()
    g, s = profile[:, :6], ARC[:6]
    slope = np.diff(g, axis=1) / np.diff(s)
    curvature = np.diff(slope, axis=1) / ((s[2:] - s[:-2]) / 2)
    for values, low, high in ((g, -1, np.array(relief.upper)), (slope, -0.3, 0.6), (curvature, -0.4, 0.4)):
        assert (values >= low - 1e-9).all()
        assert (values <= high + 1e-9).all()
    for values, low, high in ((g, -1, np.array(relief.upper)), (slope, -0.3, 0.6), (curvature, -0.4, 0.4)):
        assert np.isclose(values, low, atol=1e-9).any()
        assert np.isclose(values, high, atol=1e-9).any()


def test_interval_and_shapes():
    """A profile c0 + c1 s on two points of an interval, zero elsewhere; coefficients are the user's."""
    relief = Relief(shapes=[np.ones_like, lambda s: 10 * s], coefficients=((0.0, -1.0), (2.0, 1.0)))
    profiles = Profiles.of(contact(), relief, "foot", (1.5, 3.0))
    assert profiles.points.tolist() == [2, 3]
    lowest = profiles.extreme(np.array([0, 0, 1, 1, 0, 0, 0, 0]))
    np.testing.assert_allclose(lowest / profiles.sizes, [0.0, -1.0], atol=1e-12)
    np.testing.assert_allclose(profiles.shapes @ lowest, [0, 0, -15, -30, 0, 0, 0, 0], atol=1e-9)
    low, high = profiles.value_range
    np.testing.assert_allclose(low, [0, 0, -15, -30, 0, 0, 0, 0], atol=1e-9)
    np.testing.assert_allclose(high, [0, 0, 17, 32, 0, 0, 0, 0], atol=1e-9)
    table = Relief(shapes=np.column_stack([np.ones(2), [15.0, 30.0]]), coefficients=relief.coefficients)
    np.testing.assert_array_equal(Profiles.of(contact(), table, "foot", (1.5, 3.0)).shapes, profiles.shapes)


def test_the_profile_that_is_next_to_none():
    """The least of the largest values between 1 and 2 or from -3 up to -0.5 is 1."""
    profiles = Profiles.of(contact(), Relief(lower=(-3.0, 1.0), upper=(-0.5, 2.0)), "toe")
    result = profiles.shapes @ profiles.nearest_to_none()
    assert np.abs(result).max() == pytest.approx(1, rel=1e-9)


@pytest.mark.parametrize(
    ("relief", "zone", "arc", "words"),
    [
        (Relief(lower=0, upper=1), None, None, "say which zone is to be relieved: foot, toe"),
        (Relief(lower=0, upper=1), "heel", None, "no contact zone 'heel'; there are: foot, toe"),
        (Relief(lower=0, upper=1), "foot", (7, 9), "no contact point between the arc positions 7 and 9"),
        (Relief(), "toe", None, "nothing bounds the profile; give lower and upper values"),
        (Relief(lower=0), "toe", None, "the profile has no bound; give lower and upper values"),
        (Relief(slope=1.0), "toe", None, "the profile has no bound"),
        (Relief(lower=(0, 0, 0), upper=1), "toe", None, r"bounds on values are a number or 2 of them; .* \(3,\)"),
        (Relief(lower=(0, 5), upper=(1, 6), slope=1), "toe", None, "no profile keeps the bounds on values and slope"),
        (Relief(lower=0, upper=1, slope=(2, 3), curvature=9), "foot", None, "bounds on values and slope; widen one"),
        (Relief(shapes=[np.sin], coefficients=(0, 1), lower=1, upper=2), "toe", None, "bounds on values; widen it"),
        (Relief(shapes=np.ones((3, 1)), coefficients=(0, 1)), "toe", None, r"the 2 points .* array \(3, 1\)"),
        (Relief(shapes=[np.zeros_like], coefficients=(0, 1)), "toe", None, "shape 0 is zero on the interval"),
        (Relief(shapes=[np.ones_like]), "toe", None, "nothing bounds the profile"),
    ],
)
def test_relief_that_does_not_fit_the_interval_is_refused(relief, zone, arc, words):
    with pytest.raises(ProblemError, match=words):
        Profiles.of(contact(), relief, zone, arc)


@pytest.mark.parametrize(
    ("bounds", "words"),
    [
        ({"lower": 1, "upper": 0}, "the lower bound on values is above the upper one"),
        ({"lower": "0", "upper": 1}, "bounds on values must contain real numbers; found texts"),
        ({"lower": 0, "upper": np.nan}, "bounds on values has entries that are not finite numbers"),
        ({"lower": (0, 0), "upper": (1, 1, 1)}, r"bounds on values are a number or 3 of them; .* \(2,\)"),
        ({"lower": 0, "upper": 1, "slope": -1.0}, "the bound on slope holds in both directions.* found -1"),
        ({"lower": 0, "upper": 1, "curvature": (2, 1)}, "the lower bound on curvature is above the upper one"),
        ({"lower": 0, "upper": 1, "slope": "steep"}, "the bound on slope, .* must be a finite number; found 'steep'"),
        ({"lower": 0, "upper": 1, "coefficients": (0, 1)}, "coefficients belong to shapes"),
        ({"shapes": [np.ones_like], "coefficients": 3}, "bounds on coefficients are a least and a largest one"),
        ({"shapes": [1.0], "coefficients": (0, 1)}, "shapes must be a list of functions"),
        ({"shapes": [], "coefficients": (0, 1)}, "shapes must be a list of functions"),
        ({"shapes": np.ones(3), "coefficients": (0, 1)}, r"shapes has shape \(3,\)"),
        ({"shapes": np.array([[np.inf]]), "coefficients": (0, 1)}, "shapes has entries that are not finite"),
    ],
)
def test_relief_that_no_interval_could_have_is_refused_when_it_is_made(bounds, words):
    with pytest.raises(ProblemError, match=words):
        Relief(**bounds)


@pytest.mark.parametrize("size", [1e-9, 1e6])
def test_units_do_not_matter(size):
    """Lengths times a factor: the same corners times the factor."""
    bodies = [replace(contact(), arc_position=ARC * factor) for factor in (1.0, size)]
    reliefs = [Relief(lower=-factor, upper=factor, slope=0.5, curvature=0.4 / factor) for factor in (1.0, size)]
    one, other = (Profiles.of(body, relief, "foot") for body, relief in zip(bodies, reliefs, strict=True))
    for profile, same in zip(corners(one, 10), corners(other, 10), strict=True):
        np.testing.assert_allclose(same / size, profile, atol=1e-9)
