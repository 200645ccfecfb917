"""Arrays that travel in frozen dataclasses."""

from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]


def freeze_arrays(of: Any) -> None:
    """Make the arrays of a frozen dataclass its own and read-only."""
    for item in fields(of):
        if isinstance(array := getattr(of, item.name), np.ndarray):
            frozen = array.copy()
            frozen.setflags(write=False)
            object.__setattr__(of, item.name, frozen)
