"""The printed list of the ends of many searches."""

from dataclasses import replace

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.multistart import RandomStarts, SearchEnd
from bemcontact.contact.solution import Status
from bemcontact.formulations import qp1


def ends(count: int) -> tuple[SearchEnd, ...]:
    """Local minima at pressures 1, 2, ..., the last after one iteration."""
    solution = qp1.solve(CondensedContact.from_compliance([[2.0]], [-3.0]))
    return tuple(
        SearchEnd(
            solution=replace(solution, status=Status.LOCAL_MINIMUM),
            count=2,
            first_start=i,
            objective=0.5,
            residual=0.25,
            iterations=(i + 1, i + 1),
        )
        for i in range(count)
    )


def test_ends_are_printed_in_short_lines():
    """Eight ends are listed. The number of iterations is printed once if the least and the largest are equal."""
    few = RandomStarts(formulation="qp1", count=4, seed=0, ends=ends(2))
    assert str(few).splitlines()[1:] == [
        "2 x local minimum, objective 5.0e-01, residual 2.5e-01, 1 iteration",
        "2 x local minimum, objective 5.0e-01, residual 2.5e-01, 2 iterations",
    ]
    many = RandomStarts(formulation="qp1", count=22, seed=0, ends=ends(11))
    assert len(str(many).splitlines()) == 10
    assert str(many).splitlines()[-1] == "and 3 more ends, of 6 starts"
    assert repr(many.ends[0]) == f"<SearchEnd: {few.ends[0]}>"
    assert repr(few) == "<RandomStarts of qp1: 0 of 4 random starts (seed 0) end at the contact state, 2 distinct>"
