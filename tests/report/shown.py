"""An object of each kind that a notebook shows; a test makes no other than the one it asks for."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import bemcontact

GALLERY = Path(__file__).parents[2] / "models" / "gallery"
LOAD, MODULUS = "conditions.top.pressure", "material.young_modulus"


def hertz(variant: str | None = None) -> bemcontact.Problem:
    return bemcontact.load(GALLERY / "hertz_small.yaml", variant=variant)


MADE: dict[str, Callable[[], Any]] = {
    "problem": hertz,
    "result": lambda: bemcontact.solve(hertz(), accuracy=0.1),
    "condensed": lambda: bemcontact.solve(shown("result").contact),
    "cases": lambda: bemcontact.solve_cases(bemcontact.load(GALLERY / "roller_in_v_block.yaml"), accuracy=0.1),
    "comparison": lambda: bemcontact.compare(shown("result").contact, ["qp3"]),
    "path": lambda: bemcontact.follow(hertz(), LOAD, to=100.0, start=50.0, accuracy=0.1),
    "study": lambda: bemcontact.study(hertz("stated mesh"), {LOAD: [10.0, 40.0], MODULUS: [1e5, 2e5, 4e5]}),
}


@cache
def shown(name: str) -> Any:
    """The object of a kind, a key of `MADE`; tests leave it as it is."""
    return MADE[name]()
