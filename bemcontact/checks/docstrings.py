"""Docstrings that users read in help and schemas, also under ``python -OO``, which removes them."""

import ast
import inspect
import sys
from functools import cache
from itertools import pairwise
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


@cache
def attribute_docstrings(owner: type) -> dict[str, str]:
    """Name of each field of a class or its bases -> the docstring below it; without those whose source is not there."""
    own = _classes(owner.__module__).get(owner.__qualname__)
    found = {name: text for base in reversed(owner.__mro__[1:]) for name, text in attribute_docstrings(base).items()}
    for field, below in pairwise(own.body if own else ()):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
            match below:
                case ast.Expr(ast.Constant(str(text))):
                    found[field.target.id] = inspect.cleandoc(text)
    return found


@cache
def _classes(module: str) -> dict[str, ast.ClassDef]:
    """The classes of a module, not those inside others, as its source states them; none where it is not there."""
    if not module.startswith(__name__.partition(".")[0]):
        return {}
    try:
        source = ast.parse(inspect.getsource(sys.modules[module]))
    except (OSError, TypeError):
        return {}
    return {part.name: part for part in source.body if isinstance(part, ast.ClassDef)}
