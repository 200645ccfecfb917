"""The cylinder of [SS92] on its stated mesh, with elements cut, for benchmarks of speed."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from unittest.mock import patch

import bemcontact
from bemcontact import compilation
from bemcontact.bem import system

MODEL = Path(__file__).parents[2] / "models" / "cylinder_on_plane.yaml"
MESH = "stated mesh"
"""Variant with 38 elements, N = 152 unknowns and n = 0.29 N contact points."""


def cylinder(refine: int) -> bemcontact.Problem:
    """The stated mesh with each element cut into so many parts."""
    return bemcontact.load(MODEL, variant=MESH).refined(refine)


def codes() -> tuple[str, ...]:
    """Names of what can assemble here."""
    return ("NumPy", "numba") if system.machine_code() else ("NumPy",)


@contextmanager
def assembled_by(code: str) -> Iterator[None]:
    """Assemble with NumPy alone, or with numba as if it were imported already."""
    compiled = system.machine_code() if code == "numba" else None
    with (
        patch.object(system, "machine_code", lambda: compiled),
        patch.object(compilation, "numba_is_imported", lambda: compiled is not None),
    ):
        yield
