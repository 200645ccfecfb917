"""Advice: for every status and formulation a sentence whose options the command line has."""

import itertools
import re

import numpy as np
import pytest
import typer.main

from bemcontact import cli
from bemcontact.assessment.certificate import advice
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.options import FormulationName


def ended(status: Status, formulation: str) -> ContactSolution:
    none = np.zeros(1)
    return ContactSolution(
        formulation=formulation,
        solver="any",
        status=status,
        pressure=none,
        displacement=none,
        rigid_amplitudes=np.zeros(0),
        iterations=7,
    )


@pytest.mark.parametrize(("status", "formulation"), [*itertools.product(Status, FormulationName)])
def test_advice_can_be_followed(status: Status, formulation: FormulationName):
    """Its options exist, and it never sends a person to the formulation that was used."""
    words = advice(ended(status, formulation))
    solve = typer.main.get_command(cli.app).commands["solve"]  # pyright: ignore[reportAttributeAccessIssue]
    known = {name for parameter in solve.params for name in parameter.opts}
    assert {*re.findall(r"--[a-z-]+", words)} <= known
    assert f"--formulation {formulation}" not in words
    assert words.endswith(".")


def test_advice_goes_by_the_status():
    assert "Raise the limit (--max-iterations; 7 were done)." in advice(ended(Status.ITERATION_LIMIT, "qp3"))
    assert "another start" in advice(ended(Status.ITERATION_LIMIT, "qp1"))
    assert "support" in advice(ended(Status.INFEASIBLE, "qp1"))
    assert "start" not in advice(ended(Status.NUMERICAL_FAILURE, "qp3"))
