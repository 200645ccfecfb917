"""Compilation to machine code by numba (the extra ``fast``)."""

import sys
from collections.abc import Callable
from functools import lru_cache
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., object])


@lru_cache(maxsize=1)
def numba_is_imported() -> bool:
    """Whether numba was imported before the first body of this process: no body changes the digits of the next."""
    return "numba" in sys.modules


def compiled(*, inner: bool = False, reorder: bool = False) -> Callable[[Function], Function]:
    """Compile a function at its first call; machine code is kept for later processes if there is a directory for it.

    Parameters
    ----------
    inner : only compiled functions call it, so that it is compiled in less time
    reorder : terms of a sum may be added in another order, so that several are added at once
    """
    import numba

    njit: Any = numba.njit
    # no option changes a result by more than round-off: no check for division by zero, fused multiply-add
    options = {"nogil": True, "error_model": "numpy", "fastmath": {"contract", "reassoc"} if reorder else {"contract"}}
    if inner:
        options |= {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}

    def decorate(function: Function) -> Function:
        try:
            return njit(function, cache=True, **options)
        except RuntimeError:  # there is no directory to keep the machine code in
            return njit(function, **options)

    return decorate
