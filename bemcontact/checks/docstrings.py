"""Docstrings that users read in help and schemas, also under ``python -OO``, which removes them."""

import ast
import inspect
import sys
from textwrap import dedent
from typing import Any

REMOVED = "The description is not known: Python removed it (-OO), and its source is not there; run Python without -OO."


def docstring(documented: Any) -> str:
    """The docstring of a class, function or property; from its source where Python has removed it."""
    if sys.flags.optimize < 2:
        return inspect.getdoc(documented) or ""
    of_property = getattr(documented, "fget", None) or getattr(documented, "func", None)
    try:
        [stated] = ast.parse(dedent(inspect.getsource(of_property or documented))).body
    except (OSError, TypeError):
        return REMOVED
    return ast.get_docstring(stated) or "" if isinstance(stated, ast.FunctionDef | ast.ClassDef) else ""
