"""The machine code of the local solver, as Python and compiled.

In a fresh tree numba compiles for about 20 s, so that tests of compiled code are slow. Its source is run as Python too.
"""

import importlib.util
import sys
from contextlib import contextmanager
from types import SimpleNamespace

import pytest

from bemcontact import compilation
from bemcontact.formulations.local_solver import minimize
from bemcontact.formulations.local_solver.equilibration import natural_factors, scaled_data

PACKAGE = "bemcontact.formulations.local_solver"
MODULES = "compiled_scaling", "tableau"


AS_PYTHON, COMPILED = "as Python", pytest.param("compiled", marks=pytest.mark.slow)


@contextmanager
def _modules(how, monkeypatch):
    """The modules by name; what they are made of runs as Python, which takes no seconds at first, or is compiled."""
    if how == "compiled":
        yield {name: importlib.import_module(f"{PACKAGE}.{name}") for name in MODULES}
        return
    monkeypatch.setattr(compilation, "compiled", lambda **_: lambda function: function)
    modules = {}
    for name in MODULES:
        found = importlib.util.find_spec(f"{PACKAGE}.{name}")
        modules[name] = importlib.util.module_from_spec(found)
        found.loader.exec_module(modules[name])
        monkeypatch.setitem(sys.modules, f"{PACKAGE}.{name}", modules[name])
    minimize._by_numba.cache_clear()
    yield modules
    minimize._by_numba.cache_clear()


@pytest.fixture(params=[AS_PYTHON, COMPILED])
def machine_code(request, monkeypatch):
    """The modules of machine code by name."""
    with _modules(request.param, monkeypatch) as modules:
        yield modules


@pytest.fixture(params=["NumPy", AS_PYTHON, COMPILED])
def scaling(request, monkeypatch):
    """The functions that scale: `natural_factors` and `scaled_data`."""
    if request.param == "NumPy":
        yield SimpleNamespace(natural_factors=natural_factors, scaled_data=scaled_data)
        return
    with _modules(request.param, monkeypatch) as modules:
        loops = modules["compiled_scaling"]
        yield SimpleNamespace(natural_factors=loops.natural_factors_by_loops, scaled_data=loops.scaled_data_by_loops)
