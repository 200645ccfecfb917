"""Formulations compared under load cases: the same answers as case by case, on one mesh."""

from pathlib import Path

import numpy as np
import pytest
from tool_problems import FREE, made

import bemcontact
from bemcontact.analysis.case_comparisons import compare_cases
from bemcontact.errors import ProblemError
from bemcontact.options import ComparisonOptions

V_BLOCK = Path(__file__).parents[2] / "models" / "gallery" / "roller_in_v_block.yaml"


def test_each_case_is_that_of_solve_cases():
    """The direct solutions are those of solve_cases to round-off, and each formulation agrees with them."""
    problem, options = bemcontact.load(V_BLOCK, variant="stated mesh"), ComparisonOptions.of(["qp1", "qp3"])
    stages = list[str]()
    compared = compare_cases(options, problem, lambda stage, _: stages.append(stage))
    alone = bemcontact.solve_cases(problem)
    assert [*compared.levels] == [*compared.answers.results] == [*alone.results]
    for name, result in alone.results.items():
        level = compared.levels[name]
        size = result.contact.scales.pressure
        assert level.answer.solution.pressure == pytest.approx(result.solution.pressure, abs=1e-9 * size)
        assert [item.label for item in level.comparison.contenders] == ["QP1", "QP3"]
        assert level.comparison.agreement is not None
        assert level.comparison.agreement < 1e-9
        assert any(stage.startswith(f"{name}: ") for stage in stages)
    assert compared.certified
    assert compared.holds is None  # no accuracy is asked
    assert np.isfinite(compared.seconds)


def test_a_problem_without_load_cases_is_refused():
    with pytest.raises(ProblemError, match="states no load cases"):
        compare_cases(ComparisonOptions.of(), made(FREE))
