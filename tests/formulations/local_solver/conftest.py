"""The machine code of the local solver, as Python and compiled.

In a fresh tree numba compiles for about 20 s, so that tests of compiled code are slow. Its source is run as Python too.
"""

import importlib.util
import sys
from contextlib import contextmanager

import pytest

from bemcontact import compilation
from bemcontact.formulations.local_solver import equilibration, minimize

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
def room(request, monkeypatch):
    """The module that scales."""
    if request.param == "NumPy":
        yield equilibration
        return
    with _modules(request.param, monkeypatch) as modules:
        yield modules["compiled_scaling"]
