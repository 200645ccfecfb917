"""Whether error bars are as small as was asked, and where nothing can be promised."""

from dataclasses import replace
from itertools import product
from math import inf, nextafter

import pytest

from bemcontact.assessment.accuracy import Accuracy, ErrorBar, Quantity, together
from bemcontact.errors import ProblemError


def bar(
    quantity: Quantity = "peak", value: float | None = 1.0, error: float | None = 1e-3, zone: str = "z"
) -> ErrorBar:
    return ErrorBar(quantity=quantity, zone=zone, value=value, bar=error)


def test_met_is_all_bars_at_most_the_accuracy():
    assert Accuracy.of(1e-2, 1, [bar(error=1e-2), bar("force", error=1e-5)]).met
    assert not Accuracy.of(1e-2, 1, [bar(error=nextafter(1e-2, 1)), bar("force", error=1e-5)]).met


def test_one_unknown_error_is_not_met():
    judged = Accuracy.of(0.5, 1, [bar(), bar("end", error=None)])
    assert judged.worst == inf
    assert judged.met is False


def test_intensities_are_no_part_of_it():
    judged = Accuracy.of(1e-2, 1, [bar(), bar("intensity", error=0.3)])
    assert judged.met
    assert judged.worst == 1e-3


@pytest.mark.parametrize("empty", [bar(value=None, error=None), bar("force", value=0.0, error=None)])
def test_where_there_is_nothing_to_estimate_nothing_is_promised(empty: ErrorBar):
    """An infinite peak, and the force of a zone without contact."""
    assert not empty.promised
    assert Accuracy.of(1e-2, 1, [empty, bar("displacement")]).met


def test_a_pressure_away_from_infinite_ones_is_promised_without_a_value():
    assert bar("pressure", value=None, error=0.1).promised
    assert not Accuracy.of(1e-2, 1, [bar("pressure", value=None, error=0.1)]).met


def test_nothing_holds_where_errors_are_not_known_but_nothing_was_asked():
    """Not estimated is neither met nor not met; it fails only the one who asked."""
    assert Accuracy(asked=None).met is None
    assert Accuracy(asked=None).holds is None
    assert Accuracy(asked=1e-2, reason="too many unknowns").holds is False


def test_several_judgments_hold_together_only_if_all_do():
    """All triples of the three values: the worst of them, with what is not assessed between."""
    order = [False, None, True]
    for three in product(order, repeat=3):
        assert together(three) is min(three, key=order.index)
    assert together(()) is True


def test_infinite_peaks_that_another_mesh_knows():
    """A single mesh cannot know them: its finite peak gives way, and the verdict follows."""
    infinite = bar(value=None, error=None)
    single = Accuracy.of(1e-2, 1, [bar(error=0.4), bar("force"), bar(error=5e-3, zone="other")])
    judged = single.knowing(Accuracy.of(1e-2, 3, [infinite]))
    assert single.infinite == ()
    assert judged.infinite == ("z",)
    assert not single.met
    assert judged.met
    assert [(item.quantity, item.zone, item.value) for item in judged.bars] == [
        ("peak", "z", None), ("force", "z", 1.0), ("peak", "other", 1.0),
    ]  # fmt: skip


def test_knowing_does_not_judge_what_was_not_estimated():
    assert Accuracy(asked=1e-2).knowing(Accuracy.of(1e-2, 3, [bar(value=None, error=None)])).met is None


def test_one_bar_is_found_by_its_name():
    ends = [ErrorBar(quantity="end", zone="z", interval=i, value=1.0 + i, bar=0.1) for i in range(2)]
    judged = Accuracy.of(0.5, 1, [bar(), bar(zone="other", error=2e-3), bar("pressure"), *ends])
    assert judged.bar_of("peak", "other").bar == 2e-3
    assert judged.bar_of("pressure").quantity == "pressure"
    assert [judged.bar_of("end", interval=i).value for i in range(2)] == [1.0, 2.0]
    for wrong, told in (
        (("peak",), "2 error bars of 'peak'.* there are: peak of 'z', peak of 'other'"),
        (("peak", "foot"), "no error bars of 'peak of foot'.* there are: peak of 'z', .*'other', pressure of 'z', end"),
        (("end", "z", 2), "there are: end of 'z', interval 0, end of 'z', interval 1"),
    ):
        with pytest.raises(ProblemError, match=told):
            judged.bar_of(*wrong)
    with pytest.raises(ProblemError, match="none: no mesh"):
        Accuracy(asked=None, reason="no mesh").bar_of("peak")


def test_an_error_bar_says_to_what_it_is_relative():
    """To the value, and of an end of contact to the length of its interval."""
    assert (
        repr(bar("peak", 100.0, 0.02, "foot"))
        == "<ErrorBar of peak of 'foot': value 100, bar 0.02 relative to the value>"
    )
    end = ErrorBar(quantity="end", zone="foot", interval=1, value=3.0, bar=None, note="it is at a corner")
    assert "interval 1: value 3, bar not known; it is at a corner" in repr(end)
    assert "relative to the length of the interval" in repr(replace(end, bar=0.1))
