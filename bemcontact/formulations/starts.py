"""Where the local solver starts: a given point, one that is read from a file, or random ones."""

import json
import os
from dataclasses import replace
from math import isfinite
from pathlib import Path

import numpy as np

from bemcontact.arrays import Array, real_array
from bemcontact.checks.arguments import label
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import OptionError, ProblemError, SpecError, escaped
from bemcontact.files.text import text_of
from bemcontact.frozen import frozen
from bemcontact.options import STARTS, SolveOptions, StartName, ensure_whole

RESULTS = "a JSON file that `bemcontact solve --json FILE` has written"
"""What to name where a start is read."""
SPREAD = 2.0
"""Largest random pressure over T, and size of a random displacement over U."""


@frozen
class Start:
    """Where a local solver starts, in the user's units.

    Parameters
    ----------
    pressure : (n,) p [p]
    displacement : (n,) u_n [L]
    label : what reports call it
    """

    pressure: Array
    displacement: Array
    label: str = "given point"

    def __post_init__(self) -> None:
        """Refuse all but two equally long vectors of finite numbers; make them read-only."""
        for name in ("pressure", "displacement"):
            try:
                vector = np.atleast_1d(real_array(getattr(self, name), f"the {name} of a start")).copy()
            except ProblemError as error:
                raise OptionError(f"{error}; give finite numbers, one for each contact point") from None
            if vector.ndim != 1:
                raise OptionError(f"the {name} of a start needs finite numbers, one for each contact point")
            vector.setflags(write=False)
            object.__setattr__(self, name, vector)
        if self.pressure.shape != self.displacement.shape:
            raise OptionError(
                f"a start needs one pressure and one displacement for each contact point; found {self.pressure.size} "
                f"pressures and {self.displacement.size} displacements"
            )
        label(self.label, "the label of a start")


def read_start(path: str | os.PathLike[str]) -> Start:
    """Read a start from a file that `bemcontact solve --json` wrote; `SpecError` says what is wrong with it."""
    if os.fspath(path) == "-":
        raise SpecError(f"-: a start is not read from standard input; name {RESULTS}")
    name, text = escaped(os.fspath(path)), text_of(path, RESULTS)
    try:
        record = json.loads(text, parse_int=float)
    except json.JSONDecodeError as error:
        raise SpecError(f"{name}:{error.lineno}:{error.colno}: is no JSON ({error.msg}); name {RESULTS}") from None
    except RecursionError:
        raise SpecError(f"{name}: has too many nested brackets; name {RESULTS}") from None
    lists = []
    for key in ("pressure", "normal_displacement"):
        values = record.get(key) if isinstance(record, dict) else None
        if not isinstance(values, list) or not all(type(value) is float and isfinite(value) for value in values):
            raise SpecError(f"{name}: has no list '{key}' of numbers, one for each contact point; name {RESULTS}")
        lists.append(np.array(values))
    try:
        return Start(pressure=lists[0], displacement=lists[1], label=f"file {escaped(Path(path).name)}")
    except OptionError as error:
        raise SpecError(f"{name}: {error}") from None


def with_start_read(options: SolveOptions) -> SolveOptions:
    """Options with the start that its file contains."""
    return replace(options, start=read_start(options.start)) if isinstance(options.start, os.PathLike) else options


def start_of(contact: CondensedContact, options: SolveOptions) -> Start | None:
    """The start that options ask for, the first of several random ones; None is the null vector."""
    if options.is_random:
        return draw_starts(contact, 1, options.seed or 0)[0]
    given = with_start_read(options).start
    if given is None or isinstance(given, StartName | os.PathLike):
        return None
    if (size := np.size(given.pressure)) != contact.size:
        raise OptionError(
            f"the start has {size} contact points and the problem {contact.size}; give one pressure and one "
            "displacement for each, in the order of the problem's points"
        )
    return Start(pressure=given.pressure, displacement=given.displacement, label=given.label)


def draw_starts(contact: CondensedContact, count: int, seed: int = 0) -> tuple[Start, ...]:
    """Draw starts: pressures even in [0, 2T], displacements normal with deviation 2U, the body moved likewise.

    The same seed gives the same starts, in any units, and fewer starts are the first of more. `OptionError` for a count
    below 1, a negative seed, or numbers that are not whole.
    """
    ensure_whole(count, STARTS, 1)
    ensure_whole(seed, "seed", 0)
    rng = np.random.default_rng(seed)
    U, T = contact.scales
    motions = contact.rigid_motions / np.abs(contact.rigid_motions).max(axis=0, initial=0.0)
    starts = []
    for number in range(count):
        pressure = rng.uniform(0.0, SPREAD, contact.size)
        displacement = SPREAD * (rng.standard_normal(contact.size) + motions @ rng.standard_normal(motions.shape[1]))
        label = f"random point {number}, seed {seed}"
        starts.append(Start(pressure=pressure * T, displacement=displacement * U, label=label))
    return tuple(starts)
