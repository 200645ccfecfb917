"""Objects draw themselves into axes of matplotlib by the names of their pictures."""

import pytest
from matplotlib import pyplot
from matplotlib.figure import Figure
from shown import LOAD, MODULUS, shown

import bemcontact


def label(axes):
    return axes.get_xlabel(), axes.get_ylabel().partition("\n")[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "options", "labels"),
    [
        ("problem", {}, ("x [mm]", "y [mm]")),
        ("result", {}, ("x [mm]", "y [mm]")),
        ("result", {"what": "pressure"}, (None, "pressure [MPa]")),
        ("result", {"what": "gap", "zone": "foot"}, (None, "gap [mm]")),
        ("result", {"what": "contact", "zone": "foot", "stress": "max_shear"}, ("x [mm]", "y [mm]")),
        ("result", {"what": "deformed"}, ("x [mm]", "y [mm]")),
        ("result", {"what": "stress", "stress": "xx"}, ("x [mm]", "y [mm]")),
        ("condensed", {}, (None, "pressure [MPa]")),
        ("cases", {"zone": "plate"}, (None, "pressure [MPa]")),
        ("comparison", {"zone": "foot"}, ("distance along foot [mm]", "pressure [MPa]")),
        ("path", {}, (LOAD, "peak pressure [MPa]")),
        ("path", {"what": "force"}, (LOAD, None)),
        ("path", {"what": "moment"}, (LOAD, "moment about (0, 0) [N·mm/mm]")),
        ("path", {"what": "ends"}, (LOAD, None)),
        ("study", {"output": "peak", "over": LOAD}, (LOAD, None)),
        ("study", {}, (MODULUS, None)),
    ],
)
def test_an_object_draws_into_the_axes_that_it_is_given(name, options, labels):
    axes = Figure(layout="constrained").add_subplot()
    assert shown(name).plot(axes, **options) is axes
    assert axes.lines or axes.patches or axes.collections
    for found, wanted in zip(label(axes), labels, strict=True):
        assert wanted in (None, found)


@pytest.mark.slow
def test_axes_are_made_where_none_are_given():
    pyplot.switch_backend("agg")
    axes = shown("result").plot()
    assert axes.figure.number in pyplot.get_fignums()
    pyplot.close(axes.figure)


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("result", {"what": "stresses"}, "no picture 'stresses' of this; take one of contact, pressure, gap"),
        ("result", {"zone": "hand"}, "no contact zone 'hand'; take one of foot"),
        ("result", {"colour": 1}, "'contact' has no option 'colour'; it takes zone, stress"),
        ("result", {"what": "deformed", "zone": "foot"}, "no option 'zone'; it takes axes, what"),
        ("result", {"ax": None}, "no option 'ax'; it takes zone, stress, axes, what"),
        ("result", {"axes": "pressure"}, "found 'pressure'; write what='pressure'"),
        ("result", {"stress": "shear"}, "no stress 'shear'; take one of"),
        (
            "result",
            {"axes": "here"},
            r"axes must be axes of matplotlib, or None; found 'here'; \.plot\(\)\.figure\.savefig",
        ),
        ("condensed", {"what": "contact"}, "has no boundary to draw"),
        ("study", {"output": "price"}, "no output 'price'; take one of peak"),
        ("study", {"over": "price"}, "no parameter 'price'; take one of"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_words(name, options, words):
    with pytest.raises(bemcontact.ProblemError, match=words):
        shown(name).plot(**options)
