"""The list of formulations and their options."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import Status
from bemcontact.errors import OptionError
from bemcontact.formulations import FORMULATIONS
from bemcontact.options import USES, FormulationName, SolveOptions


def test_every_name_has_a_formulation_and_its_options():
    assert [*FORMULATIONS] == [*USES] == [*FormulationName]


@pytest.mark.parametrize("name", FORMULATIONS)
def test_every_formulation_solves_and_bears_its_name(name):
    """One point with interference 3 and compliance 2: p = 3/2."""
    solution = FORMULATIONS[name](CondensedContact.from_compliance([[2.0]], [-3.0]), SolveOptions.of(name))
    assert solution.formulation == name
    assert solution.status is Status.SOLVED
    np.testing.assert_allclose(solution.pressure, [1.5], rtol=1e-14)


@pytest.mark.parametrize("limit", [0, -1, 2.5, "many", True])
def test_a_limit_of_iterations_that_is_no_whole_number_above_zero_is_refused(limit):
    with pytest.raises(OptionError, match="limit of iterations must be a whole number of at least 1"):
        SolveOptions(max_iterations=limit)


def test_the_repr_of_a_solution_is_one_line():
    solution = FORMULATIONS["qp1"](CondensedContact.from_compliance([[2.0]], [-3.0]), SolveOptions.of("qp1"))
    assert repr(solution) == "<ContactSolution by qp1: solved, 1 contact points>"


def test_options_do_not_change():
    with pytest.raises(FrozenInstanceError):
        SolveOptions().polish = False  # pyright: ignore[reportAttributeAccessIssue]
