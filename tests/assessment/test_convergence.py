"""Observed orders: sequences whose order and limit are known."""

import dataclasses

import pytest

from bemcontact.assessment.convergence import convergence
from bemcontact.assessment.footprint import ContactInterval, Footprint, Peak, Resultant

CARRIES = {"force": (0.0, 1.0), "moment": 0.0, "peak": None}
"""What the intervals carry; it is not compared."""


def print_of(peak: float, *ends: float, zone: str = "foot") -> Footprint:
    """Peak pressure and contact from 0 to each end."""
    intervals = tuple(
        ContactInterval(zone=zone, start=(0.0, 0.0), end=(end, 0.0), start_arc=0.0, end_arc=end, **CARRIES)
        for end in ends
    )
    resultant = Resultant(force=(0.0, 1.0), moment=0.0, line_point=None)
    return Footprint(
        intervals=intervals, peak=Peak(pressure=peak, at=(0.0, 0.0)), resultant=resultant, forces={}, moments={}
    )


@pytest.mark.parametrize("refine", [(1, 2, 4), (1, 2, 3), (2, 3, 7)])
@pytest.mark.parametrize("order", [0.5, 1.5, 2.0, 3.7])
def test_a_power_of_the_element_length_shows_its_order(refine: tuple[int, ...], order: float):
    """Of 10 + 3 hᑫ and 0.2 hᑫ, h = 1/refine: the order is q and the limit 10, for any ratio of meshes."""
    peaks = [10 + 3 * parts**-order for parts in refine]
    result = convergence(refine, [print_of(peak, 5 - peak / 10) for peak in peaks], [0.2 * k**-order for k in refine])
    peak, start, end, asymmetry = result.quantities
    assert peak.orders == (pytest.approx(order, rel=1e-6),)
    assert peak.limit == pytest.approx(10, rel=1e-9)
    assert start.orders == (None,)  # it does not move
    assert end.limit == pytest.approx(4, rel=1e-9)
    assert asymmetry.orders == (pytest.approx(order), pytest.approx(order))
    assert asymmetry.limit == 0.0


def test_values_that_go_to_and_fro_show_no_order():
    result = convergence((1, 2, 4), [print_of(p) for p in (1.0, 3.0, 2.0)], [0.1, 0.1, 0.2])
    assert result.quantities[0].orders == (None,)
    assert result.quantities[0].limit is None
    assert result.quantities[-1].orders == (pytest.approx(0.0), pytest.approx(-1.0))


def test_two_meshes_give_an_order_only_to_values_that_vanish():
    result = convergence((1, 3), [print_of(1.0), print_of(1.1)], [0.9, 0.1])
    assert result.quantities[0].orders == ()
    assert result.quantities[-1].orders == (pytest.approx(2.0),)


def test_contact_that_splits_has_no_ends_to_compare():
    result = convergence((1, 2), [print_of(1.0, 2.0), print_of(1.0, 1.0, 2.0)], [0.2, 0.1])
    assert [item.name for item in result.quantities] == ["peak pressure", "asymmetry of J M"]
    assert "not the same on all meshes" in result.remark


def test_a_symmetric_matrix_shows_no_order():
    assert convergence((1, 2), [print_of(1.0)] * 2, [0.0, 0.0]).quantities[-1].orders == (None,)


def test_positions_on_a_closed_run_are_counted_on():
    """A start at 1 before the seam of a perimeter of 50 and at 0.5 before it: 49, 49.5 and -0.25 are 49.75."""

    def ring(start: float) -> Footprint:
        interval = ContactInterval(
            zone="rim",
            start=(0.0, 0.0),
            end=(1.0, 0.0),
            start_arc=start,
            end_arc=start + 2.0,
            perimeter=50.0,
            **CARRIES,
        )
        return dataclasses.replace(print_of(1.0), intervals=(interval,))

    result = convergence((1, 2, 4), [ring(49.0), ring(49.5), ring(-0.25)], [0.1, 0.1, 0.1])
    assert result.quantities[1].values == pytest.approx([49.0, 49.5, 49.75])
    assert result.quantities[1].limit == pytest.approx(50.0)


def test_a_mesh_without_contact_has_no_peak_to_compare():
    nowhere = dataclasses.replace(print_of(1.0), peak=None, intervals=())
    result = convergence((1, 2, 4), [nowhere, print_of(1.0), print_of(1.1)], [0.4, 0.2, 0.1])
    assert [item.name for item in result.quantities] == ["asymmetry of J M"]
