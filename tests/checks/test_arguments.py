"""Every public function and method, with an argument of every wrong kind: an answer, or an error of ours in words."""

import inspect
import warnings
from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from contact_problems import random_contact
from scipy import sparse

import bemcontact
from bemcontact import BemContactError, Change, CondensedContact, QPOptions, Relief, SolveOptions, Start
from bemcontact.adaptivity import adapt
from bemcontact.modelling.gap_design.relief import Profiles
from bemcontact.options import ComparisonOptions

SPEC: dict[str, Any] = {
    "name": "block",
    "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
    "boundary": {
        "outer": [
            {"name": "foot", "start": [0, 0], "elements": 2},
            {"name": "right", "start": [2, 0], "elements": 1},
            {"name": "top", "start": [2, 1], "elements": 1},
            {"name": "left", "start": [0, 1], "elements": 1},
        ]
    },
    "conditions": {"left": {"displacement": {"x": 0}}, "top": {"pressure": 2}},
    "contact_zones": {"floor": {"edges": "foot", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
    "tools": {"table": {"zones": "floor", "point": [0, 0], "displacement": {"y": 0.002}}},
    "variants": {"soft": {"set": {"material.young_modulus": 500}}},
}
WIND = {"load_cases": {"wind": {"conditions": {"right": {"pressure": 1}}}}}
PROBLEM = bemcontact.Problem(**deepcopy(SPEC))
ON_ITS_MESH = PROBLEM.with_value("accuracy", None)
CASES = bemcontact.Problem(**deepcopy({**SPEC, **WIND}))
BODY = bemcontact.condense(CASES)
CONTACT = replace(random_contact(0, 4, 1), name="four points")
PAIR = CondensedContact.from_compliance(np.eye(2), -np.ones(2))
MODEL = bemcontact.model(CONTACT)
PATH = bemcontact.load_path(BODY.with_factors({"wind": 0}), BODY.with_factors({"wind": 1}))
FOLLOWED = bemcontact.follow(ON_ITS_MESH, "conditions.top.pressure", to=1.0)
DESIGN = bemcontact.design_gap(PAIR, Relief(lower=0.0, upper=0.1))
RESULT = bemcontact.solve(CONTACT)
FREE = bemcontact.sensitivities(CONTACT, ["initial_gap[0]"])
SOLVED = bemcontact.solve(PROBLEM, accuracy=None)
OPERATOR = bemcontact.stress_operator(SOLVED, [[1, 0.5]])
P, ONES = RESULT.solution.pressure, np.ones(4)


def parts(contact: CondensedContact) -> dict[str, Any]:
    return {name: getattr(contact, name) for name in inspect.signature(CondensedContact).parameters}


Call = tuple[Callable[..., Any], Mapping[str, Any]]

CALLS: dict[str, Call] = {
    "load": (bemcontact.load, {"path": "no such file.yaml", "set": (), "variant": None}),
    "loads": (bemcontact.loads, {"text": "a: 1", "name": "text", "set": (), "variant": None}),
    "problem": (bemcontact.problem, {"parts": PROBLEM.to_dict()}),
    "problem, parts": (
        lambda **parts: bemcontact.problem({**PROBLEM.to_dict(), **parts}),
        {"name": "a", "accuracy": 0.1, "material": {}, "boundary": {}},
    ),
    "dumps": (bemcontact.dumps, {"problem": PROBLEM}),
    "condense": (bemcontact.condense, {"problem": PROBLEM}),
    "stress_operator": (bemcontact.stress_operator, {"problem": PROBLEM, "points": [[1, 0.5]]}),
    "StressOperator.at": (OPERATOR.at, {"pressure": np.ones(5), "amplitudes": None, "factors": None}),
    "Result.stress": (SOLVED.stress, {"points": [[1, 0.5]]}),
    "Result.displacement": (SOLVED.displacement, {"points": [[1, 0.5]]}),
    "ParameterPath.animate": (FOLLOWED.animate, {"file": "path.mp4"}),
    "solve": (
        bemcontact.solve,
        {
            "problem": CONTACT, "formulation": "qp2", "weights": "tributary", "progress": None, "penalty": 1.0,
            "rows": "stiffness", "equilibrium": "constraint", "start": None, "max_iterations": None, "polish": True,
        },
    ),
    "solve, starts": (bemcontact.solve, {"problem": CONTACT, "formulation": "qp1", "seed": 0, "starts": 2}),
    "solve, qp3": (bemcontact.solve, {"problem": CONTACT, "formulation": "qp3", "max_iterations": 30}),
    "solve, direct": (bemcontact.solve, {"problem": CONTACT, "formulation": "complementarity", "max_iterations": 3}),
    "solve_cases": (bemcontact.solve_cases, {"problem": CASES, "formulation": "complementarity"}),
    "random_starts": (
        bemcontact.random_starts,
        {"problem": CONTACT, "formulation": "qp1", "weights": "tributary", "count": 1, "seed": 0, "progress": None},
    ),
    "compare": (
        bemcontact.compare,
        {
            "problem": CONTACT, "formulations": ("qp2",), "weights": ("tributary",), "penalties": None,
            "progress": None, "starts": 1, "seed": 0,
        },
    ),
    "follow": (bemcontact.follow, {"problem": ON_ITS_MESH, "key": "conditions.top.pressure", "to": 3.0, "start": 1.0}),
    "sensitivities": (bemcontact.sensitivities, {"problem": CONTACT, "changes": None}),
    "sensitivities, change": (
        lambda offset, motion_load: bemcontact.sensitivities(CONTACT, {"a": Change(offset, motion_load)}),
        {"offset": ONES, "motion_load": np.ones(1)},
    ),
    "sensitivities, keys": (lambda key: bemcontact.sensitivities(CONTACT, [key]), {"key": "initial_gap[1]"}),
    "sensitivities, problem": (lambda key: bemcontact.sensitivities(PROBLEM, [key]), {"key": "initial_gap[1]"}),
    "sensitivities, mapping": (
        lambda change: bemcontact.sensitivities(CONTACT, {"a": change}), {"change": (ONES, [0])}
    ),
    "Sensitivities[]": (FREE.__getitem__, {"key": "initial_gap[0]"}),
    "study": (
        bemcontact.study,
        {
            "problem": ON_ITS_MESH, "vary": {"conditions.top.pressure": [1.0]}, "output": ("peak",), "workers": 1,
            "scheduler": None, "accuracy": None, "progress": None,
        },
    ),
    "load_path": (bemcontact.load_path, {"start": CONTACT, "end": CONTACT}),
    "LoadPath.at": (PATH.at, {"t": 0.5}),
    "LoadPath.contact": (PATH.contact, {"t": 0.5}),
    "LoadPath.footprint": (PATH.footprint, {"t": 0.5}),
    "LoadPath.breakpoint": (PATH.breakpoint, {"i": 0}),
    "solve_lcp": (bemcontact.solve_lcp, {"M": np.eye(4), "q": -ONES}),
    "minimize_qp": (
        bemcontact.minimize_qp,
        {
            "H": np.eye(4), "c": ONES, "A": np.ones((1, 4)), "cl": [-1.0], "cu": [1.0], "bl": -ONES, "bu": ONES,
            "x0": 0 * ONES, "options": None, "working_set": np.zeros(5, int),
        },
    ),
    "QPOptions": (
        lambda **options: bemcontact.minimize_qp(np.eye(2), [1, 1], options=QPOptions(**options)),
        {
            "max_iterations": 5, "feasibility_tolerance": 1e-9, "optimality_tolerance": 1e-9, "scale": True,
            "search": 10, "by_numba": None, "log": None,
        },
    ),
    "SolveOptions": (
        SolveOptions,
        {
            "formulation": "qp2", "weights": "tributary", "penalty": 1.0, "rows": "stiffness",
            "equilibrium": "constraint", "start": None, "max_iterations": None, "polish": True,
        },
    ),
    "ComparisonOptions": (
        ComparisonOptions,
        {"formulations": ("qp1", "qp2"), "weights": ("tributary",), "penalties": (1.0,), "starts": 1, "seed": 0},
    ),
    "Start": (
        lambda pressure, displacement, label: bemcontact.solve(
            CONTACT, "qp1", start=Start(pressure=pressure, displacement=displacement, label=label)
        ),
        {"pressure": ONES, "displacement": ONES, "label": "mine"},
    ),
    "model": (bemcontact.model, {"contact": CONTACT}),
    "ContactModel.stress": (MODEL.stress, {"operator": OPERATOR}),
    "ContactModel.resultant": (MODEL.resultant, {"zone": None}),
    "ContactModel.problem": (MODEL.problem, {"extra_objective": None, "extra_constraints": ()}),
    "ContactModel.solve": (
        MODEL.solve, {"extra_objective": None, "extra_constraints": [], "problem": None, "max_iterations": 30}
    ),
    "ContactModel.result": (MODEL.result, {"problem": MODEL.problem()}),
    "design_gap": (
        bemcontact.design_gap,
        {
            "contact": PAIR, "relief": Relief(lower=0.0, upper=0.1), "zone": "none of them", "cases": None,
            "goal": "peak", "progress": None, "stress": None, "von_mises": None,
        },
    ),
    "design_gap, place": (
        lambda zone, arc: Profiles.of(CONTACT, Relief(lower=0.0, upper=0.1), zone, arc),
        {"zone": "contact", "arc": (0.0, 3.0)},
    ),
    "Relief": (
        lambda **bounds: Profiles.of(CONTACT, Relief(**bounds)),
        {
            "lower": 0.0, "upper": 0.1, "slope": 1.0, "curvature": (-1.0, 1.0), "shapes": np.eye(4),
            "coefficients": (0, 1),
        },
    ),
    "Relief, shapes": (
        lambda shape: Profiles.of(CONTACT, Relief(lower=0.0, upper=0.1, shapes=[lambda s: shape])),
        {"shape": 1.0},
    ),
    "GapDesign.surface": (DESIGN.surface, {"kind": "polyline"}),
    "GapDesign.to_yaml": (DESIGN.to_yaml, {"kind": "polyline"}),
    "from_compliance": (
        CondensedContact.from_compliance,
        {
            "compliance": np.eye(4), "offset": -ONES, "weights": ONES, "rigid_motions": ONES, "motion_load": -1.0,
            "name": "mine",
        },
    ),
    "CondensedContact": (CondensedContact, parts(CONTACT)),
    "CondensedContact, body": (CondensedContact, parts(BODY)),
    "with_factors": (BODY.with_factors, {"factors": {"wind": 1.0}}),
    "with_factors, value": (lambda factor: BODY.with_factors({"wind": factor}), {"factor": 1.0}),
    "with_tools": (BODY.with_tools, {"position": np.zeros((1, 3)), "force": None}),
    "stepped": (BODY.stepped, {"factors": np.ones(1), "position": np.zeros(3), "force": np.zeros(3)}),
    "gap": (CONTACT.gap, {"pressure": P, "rigid_amplitudes": np.zeros(1)}),
    "rotations": (BODY.rotations, {"rigid_amplitudes": np.zeros(BODY.free_motions)}),
    "resultants": (CONTACT.resultants, {"pressure": P}),
    "moments": (CONTACT.moments, {"pressure": P}),
    "forces": (CONTACT.forces, {"pressure": P}),
    "tool_reactions": (CONTACT.tool_reactions, {"pressure": P}),
    "in_order": (CONTACT.in_order, {"index": np.arange(4)}),
    "points_of_run": (CONTACT.points_of_run, {"run": 0}),
    "touching": (CONTACT.touching, {"pressure": P, "displacement": ONES}),
    "pressed": (CONTACT.pressed, {"pressure": P, "displacement": ONES}),
    "peak": (CONTACT.peak, {"pressure": P}),
    "weight_matrix": (CONTACT.weight_matrix, {"weights": "tributary"}),
    "CondensedContact.load": (CondensedContact.load, {"path": "no such file.npz"}),
    "Problem": (bemcontact.Problem, SPEC),
    "with_case": (CASES.with_case, {"name": "wind"}),
    "Problem.factors": (CASES.factors, {"case": "wind"}),
    "Problem.with_factors": (CASES.with_factors, {"factors": {"wind": 1.0}}),
    "Problem.with_factors, value": (lambda factor: CASES.with_factors({"wind": factor}), {"factor": 1.0}),
    "tool_action": (PROBLEM.tool_action, {"tool": "table"}),
    "edge": (PROBLEM.edge, {"name": "foot"}),
    "refined": (PROBLEM.refined, {"parts": 1}),
    "variant": (PROBLEM.variant, {"name": "soft"}),
    "with_value": (PROBLEM.with_value, {"path": "material.young_modulus", "value": 2.0}),
    "with_element_ends": (PROBLEM.with_element_ends, {"ends": {"foot": [0.5]}}),
    "with_element_ends, list": (lambda ends: PROBLEM.with_element_ends({"foot": ends}), {"ends": [0.5]}),
}  # fmt: skip


class Unwilling:
    """An object that refuses everything."""

    def __repr__(self) -> str:
        raise ArithmeticError("no text")

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise ArithmeticError("no array")

    def __len__(self) -> int:
        raise ArithmeticError("no length")


VALUES: tuple[Any, ...] = (
    None, "", "x", "\0", b"x", {}, {"a": 1}, {1: "a"}, [], ["a"], [None], [[1.0, 2.0], [3.0]], (), (1, 2, 3), {1.0},
    range(4), True, False, 0, 1, -1, 3, 10**12, 10**400, 10**5000, 0.5, 1e308, 5e-324, float("nan"), float("inf"),
    -float("inf"),
    1j, Fraction(1, 3), Decimal("0.5"), Decimal("sNaN"), np.float64("nan"), np.float32(0.5), np.int8(1), np.bool_(True),
    np.array(0.5), np.array(1), np.array([]), np.zeros((0, 0)), np.zeros(4), np.zeros((4, 4)), np.zeros((2, 3, 4)),
    np.full(4, np.nan), np.full((4, 4), np.inf), np.full(4, 1e300), np.ones(4, bool), np.array(["a"] * 4),
    np.array([1j] * 4), np.array([None] * 4), np.array([Fraction(1, 2)] * 4), np.array([10**400] * 4, object),
    np.array(["2020-01-01"], "datetime64[D]"), np.zeros(4, [("a", float)]), np.ma.masked,
    np.ma.array(np.ones(4), mask=[0, 1, 0, 0]), np.ma.array(np.eye(4), mask=np.eye(4)),
    [np.ma.array([1.0, 2.0], mask=[0, 1])] * 2, np.ma.array(np.ones(4)), np.float32([1, 2, 3, 4]), ["1", "2", "3", "4"],
    sparse.csr_array(np.eye(4)), cp.Variable(4), cp.Variable(4) >= 0, object(), Unwilling(), Ellipsis,
    iter([1.0]), CONTACT, PROBLEM,
)  # fmt: skip


def complaint(name: str, key: str, value: Any) -> str | None:
    """What is wrong with the answer of a public function to a value of an argument; None if nothing is."""
    function, arguments = CALLS[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            function(**{**arguments, key: value})
        except BemContactError as error:
            text = str(error)
            return None if 12 <= len(text) <= 1500 and " " in text else f"a poor text: {text[:300]!r}"
        except Exception as error:
            return f"{type(error).__name__}: {str(error)[:200]}"
    return None


@pytest.mark.slow
@pytest.mark.parametrize("name", CALLS)
def test_each_wrong_kind_of_argument_gets_an_answer_in_words(name: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(adapt, "MOST_UNKNOWNS", 300)  # the search for an error of 5e-324 ends early
    cases = [(key, i) for key in CALLS[name][1] for i in range(len(VALUES))]
    assert {case: text for case in cases if (text := complaint(name, case[0], VALUES[case[1]]))} == {}


def test_all_public_functions_are_called():
    """Each function of the package by name, and each method of what a user makes that takes an argument."""
    functions = {name for name in bemcontact.__all__ if inspect.isfunction(getattr(bemcontact, name))}
    assert functions - {"schema", "dump", "outline"} <= {name.partition(",")[0] for name in CALLS}
    called = {name.partition(",")[0].rpartition(".")[2] for name in CALLS}
    kinds = (CondensedContact, bemcontact.LoadPath, bemcontact.ContactModel, bemcontact.GapDesign)
    for kind in (*kinds, bemcontact.Result, bemcontact.StressOperator):
        methods = {name for name, item in vars(kind).items() if inspect.isfunction(item) and not name.startswith("_")}
        with_arguments = {name for name in methods if len(inspect.signature(getattr(kind, name)).parameters) > 1}
        assert with_arguments - {"save", "notes_at"} <= called, kind
