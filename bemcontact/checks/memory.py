"""The limit of the address space, which a shell sets with ``ulimit -v``.

Beyond it the libraries of linear algebra end the program with a message of their own, so it is checked before.
"""

from functools import cache
from importlib import import_module
from types import ModuleType

LEAST_MEMORY = 1_000_000_000
"""Address space in bytes that the program takes without matrices: mostly libraries, and buffers of threads."""


def ensure_memory(matrices: int = 0) -> None:
    """Raise `MemoryError` if the limit of the address space is too small for the program with matrices, in bytes."""
    resource = _resource()
    if resource is None:
        return
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    needed = LEAST_MEMORY + matrices
    if limit != resource.RLIM_INFINITY and limit < needed:
        found = f"the limit of the address space (ulimit -v) is {limit // 10**6} MB"
        raise MemoryError(f"{found}, and about {needed // 10**6} MB are needed")


@cache
def _resource() -> ModuleType | None:
    """The module that knows the limit; None on Windows, which has none."""
    try:
        return import_module("resource")
    except ImportError:
        return None
