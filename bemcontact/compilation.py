"""Compilation to machine code by numba (the extra ``fast``)."""

import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from contextvars import ContextVar
from functools import lru_cache
from typing import Any, TypeVar

from bemcontact.errors import BemContactError, escaped

Function = TypeVar("Function", bound=Callable[..., object])
Watch = Callable[[], AbstractContextManager[object]]

_WATCH: ContextVar[Watch | None] = ContextVar("watch", default=None)
"""What is entered while numba compiles for this thread."""


@lru_cache(maxsize=1)
def numba_is_imported() -> bool:
    """Whether numba was imported before the first body of this process: no body changes the digits of the next."""
    return "numba" in sys.modules


@contextmanager
def watched(watch: Watch) -> Iterator[None]:
    """Enter `watch()` while numba compiles in this thread. It compiles nothing where it finds machine code kept."""
    token = _WATCH.set(watch)
    try:
        yield
    finally:
        _WATCH.reset(token)


@lru_cache(maxsize=1)
def _listen() -> None:
    """Let numba report its compilations to what watches: a call of what is compiled costs nothing more."""
    from numba.core import event

    class Compilations(event.Listener):
        """One at a time, for numba locks them; those of inner functions are within that of the outer one."""

        def __init__(self) -> None:
            self.begun: list[ExitStack] = []

        def on_start(self, event: object) -> None:
            watch = None if self.begun else _WATCH.get()
            self.begun.append(ExitStack())
            if watch is not None:
                self.begun[-1].enter_context(watch())

        def on_end(self, event: object) -> None:
            self.begun.pop().close()

    event.register("numba:compile", Compilations())


def _miss_what_is_damaged(cache: Any) -> None:
    """Let numba compile again where it cannot read machine code that is kept, as a file that was cut off.

    `BemContactError` names the folder to delete if the file cannot be replaced.
    """
    load = cache.load_overload

    def load_or_discard(signature: object, context: object) -> object:
        try:
            return load(signature, context)
        except Exception:  # unpickling may raise any
            try:
                cache.flush()
            except OSError as error:
                raise BemContactError(
                    f"{escaped(cache.cache_path)}: machine code that numba keeps here can be neither read nor replaced "
                    f"({error.strerror}); delete this folder"
                ) from error
            return None

    cache.load_overload = load_or_discard


def compiled(*, inner: bool = False, reorder: bool = False) -> Callable[[Function], Function]:
    """Compile a function at its first call; machine code is kept for later processes if there is a directory for it.

    Parameters
    ----------
    inner : only compiled functions call it, so that it is compiled in less time
    reorder : terms of a sum may be added in another order, so that several are added at once
    """
    import numba

    _listen()
    njit: Any = numba.njit
    # no option changes a result by more than round-off: no check for division by zero, fused multiply-add
    options = {"nogil": True, "error_model": "numpy", "fastmath": {"contract", "reassoc"} if reorder else {"contract"}}
    if inner:
        options |= {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}

    def decorate(function: Function) -> Function:
        try:
            dispatcher = njit(function, cache=True, **options)
        except RuntimeError:  # there is no directory to keep the machine code in
            return njit(function, **options)
        if hasattr(dispatcher, "_cache"):  # not with NUMBA_DISABLE_JIT, where it is the function itself
            _miss_what_is_damaged(dispatcher._cache)
        return dispatcher

    return decorate
