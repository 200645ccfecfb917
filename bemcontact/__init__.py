"""Frictionless contact of elastic bodies with rigid surfaces: boundary elements, quadratic programs, a certificate.

>>> import bemcontact
>>> problem = bemcontact.load("models/cylinder_on_plane.yaml")  # doctest: +SKIP
>>> result = bemcontact.solve(problem)  # doctest: +SKIP
>>> result.certified, result.footprint.peak.pressure  # doctest: +SKIP
"""

from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Any

_HOMES = {
    "load": "bemcontact.spec",
    "loads": "bemcontact.spec",
    "schema": "bemcontact.spec",
    "condense": "bemcontact.analysis",
    "solve": "bemcontact.analysis",
    "solve_cases": "bemcontact.load_cases",
    "random_starts": "bemcontact.analysis",
    "compare": "bemcontact.comparing",
    "follow": "bemcontact.responses",
    "sensitivities": "bemcontact.responses",
    "load_path": "bemcontact.parametric.path",
    "LoadPath": "bemcontact.parametric.path",
    "ParameterPath": "bemcontact.parametric.parameter_path",
    "Sensitivities": "bemcontact.parametric.sensitivity",
    "Sensitivity": "bemcontact.parametric.sensitivity",
    "Change": "bemcontact.actions",
    "Comparison": "bemcontact.assessment.comparison",
    "Result": "bemcontact.result",
    "CaseResults": "bemcontact.load_cases",
    "RandomStarts": "bemcontact.ends",
    "Start": "bemcontact.formulations.formulation",
    "Rows": "bemcontact.choices",
    "Equilibrium": "bemcontact.choices",
    "minimize_qp": "bemcontact.formulations.local_solver",
    "QPOptions": "bemcontact.formulations.local_solver",
    "QPResult": "bemcontact.formulations.local_solver",
    "QPStatus": "bemcontact.formulations.local_solver",
    "solve_lcp": "bemcontact.formulations.complementarity",
    "Problem": "bemcontact.problem.problem",
    "CondensedContact": "bemcontact.contact",
    "ContactModel": "bemcontact.modelling.contact_model",
    "design_gap": "bemcontact.modelling.gap_design",
    "Relief": "bemcontact.modelling.relief",
    "GapDesign": "bemcontact.modelling.designed_gap",
    "ContactSolution": "bemcontact.solution",
    "LocalSearch": "bemcontact.solution",
    "Status": "bemcontact.solution",
    "Trace": "bemcontact.solution",
    "Weights": "bemcontact.choices",
    "BemContactError": "bemcontact.errors",
    "SpecError": "bemcontact.errors",
    "ProblemError": "bemcontact.errors",
    "OptionError": "bemcontact.errors",
    "SingularSystemError": "bemcontact.errors",
    "NotConvexError": "bemcontact.errors",
    "SolverError": "bemcontact.errors",
}

__all__ = [*_HOMES]  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used, so that ``bemcontact --help`` needs no numerics."""
    if name == "__version__":
        return _version()
    if name not in _HOMES:
        raise AttributeError(f"module 'bemcontact' has no attribute '{name}'")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def _version() -> str:
    """Version of the installed package; a bare source tree has none."""
    try:
        return version("bemcontact")
    except PackageNotFoundError:
        return "unknown"


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(_HOMES)
