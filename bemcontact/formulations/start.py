"""Where the local solver of QP1 and QP2 starts: the null vector, a given point, one read from a file, random ones."""

import json
import os
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import OptionError, SpecError
from bemcontact.files.text import text_of
from bemcontact.options import SolveOptions, StartName, ensure_whole

SPREAD = 2.0
"""Largest random pressure over T, and size of a random displacement over U."""


@dataclass(frozen=True, kw_only=True, eq=False)
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
        """Refuse what is no pair of equally long vectors of finite numbers; make them read-only."""
        for name in ("pressure", "displacement"):
            try:
                vector = np.array(getattr(self, name), float, ndmin=1)
            except (TypeError, ValueError):
                vector = np.array([np.nan])
            if vector.ndim != 1 or not np.isfinite(vector).all():
                raise OptionError(f"the {name} of a start needs finite numbers, one for each contact point")
            vector.setflags(write=False)
            object.__setattr__(self, name, vector)
        if self.pressure.shape != self.displacement.shape:
            raise OptionError(
                f"a start needs one pressure and one displacement for each contact point; found {self.pressure.size} "
                f"pressures and {self.displacement.size} displacements"
            )


def read_start(path: str | os.PathLike[str]) -> Start:
    """Read a start from a file that `bemcontact solve --json` wrote; `SpecError` says what is wrong with it."""
    name, text = Path(path).name, text_of(path)
    try:
        record = json.loads(text)
    except json.JSONDecodeError as error:
        raise SpecError(
            f"{path}:{error.lineno}:{error.colno}: is no JSON ({error.msg}); name a file of results"
        ) from None
    lists = []
    for key in ("pressure", "normal_displacement"):
        values = record.get(key) if isinstance(record, dict) else None
        if not isinstance(values, list) or not all(type(value) in (int, float) for value in values):
            raise SpecError(
                f"{path}: has no list '{key}' of numbers, one for each contact point; name a file that "
                "`bemcontact solve --json FILE` has written"
            )
        lists.append(values)
    return Start(pressure=np.array(lists[0], float), displacement=np.array(lists[1], float), label=f"file {name}")


def with_start_read(options: SolveOptions) -> SolveOptions:
    """Options with the start in place of the file that holds it."""
    return replace(options, start=read_start(options.start)) if isinstance(options.start, os.PathLike) else options


def start_of(contact: CondensedContact, options: SolveOptions) -> Start | None:
    """The start that options ask for, of several random ones the first; None is the null vector."""
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

    Parameters
    ----------
    contact : CondensedContact
    count : how many, at least 1
    seed : the same seed gives the same starts, in any units, and fewer starts are the first of more

    Returns
    -------
    tuple of Start

    Raises
    ------
    OptionError
        A count below 1, a negative seed, or numbers that are not whole.
    """
    ensure_whole(count, "number of starts", 1)
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
