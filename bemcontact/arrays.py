"""Types of arrays, and read-only arrays in frozen dataclasses."""

from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]


def freeze_arrays(instance: Any) -> None:
    """Replace the arrays of a frozen dataclass by read-only copies."""
    for item in fields(instance):
        if isinstance(array := getattr(instance, item.name), np.ndarray):
            frozen = array.copy()
            frozen.setflags(write=False)
            object.__setattr__(instance, item.name, frozen)
