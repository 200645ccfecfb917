"""A load path as a function of a parameter: the data of its table, file and figure."""

import csv
import io
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from bemcontact.assessment.footprint import Footprint, footprint
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.parametric.path import LoadPath

BETWEEN = (0.25, 0.5, 0.75)
"""Fractions between two breakpoints at which intervals are evaluated, because their ends are not linear."""
ROUND_OFF = 1e-14
"""Fraction of a parameter that counts as zero."""
RESIDUAL = 1e-10
"""Allowed residual at breakpoints, as in the certificate of a single solution."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PathState:
    """A contact state on the path.

    Parameters
    ----------
    value : of the parameter
    breakpoint : whether a point enters or leaves here, or the path begins or ends
    entered, left : indices of points, as the parameter goes from start to end
    peak : largest pressure [p]
    at : index of the point that bears it, or None without contact
    resultant : by zone, the force of its rigid surface on the body [p L]
    touching : indices of the points that bear a pressure
    footprint : intervals of contact among others
    """

    value: float
    breakpoint: bool
    entered: tuple[int, ...]
    left: tuple[int, ...]
    peak: float
    at: int | None
    resultant: tuple[tuple[float, float], ...]
    touching: tuple[int, ...]
    footprint: Footprint

    def ends(self, zone: str) -> tuple[list[float], list[float]]:
        """Arc positions of the starts and ends of the intervals of a zone [L]."""
        intervals = [item for item in self.footprint.intervals if item.zone == zone]
        return [item.start_arc for item in intervals], [item.end_arc for item in intervals]

    def to_dict(self) -> dict[str, Any]:
        """Give it as numbers and lists, ready for JSON."""
        return {
            "value": self.value,
            "breakpoint": self.breakpoint,
            "entered": list(self.entered),
            "left": list(self.left),
            "peak": self.peak,
            "at": self.at,
            "resultant": [list(force) for force in self.resultant],
            "touching": list(self.touching),
            "intervals": [interval.to_dict() for interval in self.footprint.intervals],
        }


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ParameterPath:
    """A load path between two values of a parameter.

    Parameters
    ----------
    key : of the parameter
    start, end : its values at the ends of the path
    path : LoadPath
    """

    key: str
    start: float
    end: float
    path: LoadPath

    def __repr__(self) -> str:
        """One line: key, values, the path."""
        counts = f"{len(self.path.parameter)} breakpoints, {self.path.pivots} pivots"
        notes = "".join(f"; {note}" for note in self.notes)
        return f"<ParameterPath of {self.key} from {self.start:g} to {self.end:g}: {counts}{notes}>"

    @property
    def contact(self) -> CondensedContact:
        """The contact problem at the start; points, zones and units are those of all."""
        return self.path.start

    @property
    def certified(self) -> bool:
        """Whether the path reaches its end, and each state on it is proved to be the contact state, the only one."""
        return self.path.complete and self.path.unique and self.path.residual <= RESIDUAL

    def value(self, t: float) -> float:
        """The parameter at t of the path; what is round-off of its ends counts as zero."""
        value = (1 - t) * self.start + t * self.end
        return value if abs(value) > ROUND_OFF * max(abs(self.start), abs(self.end)) else 0.0

    @property
    def reaches(self) -> tuple[float, float]:
        """The values of the parameter between which there is a path."""
        return self.value(self.path.begins_at), self.value(self.path.ends_at)

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the path, one sentence each."""
        begin, end = self.reaches
        return self.path.notes_between(f"{begin:.6g}", f"{end:.6g}")

    @cached_property
    def states(self) -> tuple[PathState, ...]:
        """The breakpoints, and three states between each two of them."""
        return tuple(self._states())

    @cached_property
    def breakpoints(self) -> tuple[PathState, ...]:
        """The breakpoints alone."""
        return tuple(state for state in self.states if state.breakpoint)

    def _states(self) -> Iterator[PathState]:
        """States along the path."""
        for i, t in enumerate(self.path.parameter.tolist()):
            yield self._state(t, i)
            if i + 1 < len(self.path.parameter) and (width := self.path.parameter[i + 1] - t) > 0:
                yield from (self._state(float(t + share * width), None) for share in BETWEEN)

    def _state(self, t: float, i: int | None) -> PathState:
        """The state at breakpoint i, or at t."""
        solution = self.path.at(t) if i is None else self.path.breakpoint(i)
        p, contact = solution.pressure, self.path.contact(t)
        return PathState(
            value=self.value(t),
            breakpoint=i is not None,
            entered=() if i is None else self.path.entered[i],
            left=() if i is None else self.path.left[i],
            peak=float(p.max(initial=0.0)),
            at=int(p.argmax()) if p.any() else None,
            resultant=tuple((float(x), float(y)) for x, y in contact.resultants(p)),
            touching=tuple(np.flatnonzero(p > 0).tolist()),
            footprint=footprint(contact, solution),
        )

    def to_dict(self) -> dict[str, Any]:
        """Give it as numbers, lists and texts, ready for JSON."""
        path, contact = self.path, self.contact
        return {
            "name": contact.name,
            "key": self.key,
            "start": self.start,
            "end": self.end,
            "certified": self.certified,
            "reaches": list(self.reaches),
            "unique": path.unique,
            "residual": path.residual,
            "notes": list(self.notes),
            "pivots": path.pivots,
            "units": dict(contact.units),
            "zones": list(contact.zone_names),
            "points": contact.points.tolist(),
            "states": [state.to_dict() for state in self.states],
        }

    def to_json(self) -> str:
        """Write `to_dict` as JSON; every number in it is finite."""
        return json.dumps(self.to_dict(), indent=2, allow_nan=False, ensure_ascii=False)

    def to_csv(self) -> str:
        """Write a line for each state; points and arc positions in a cell have blanks between them."""
        stream = io.StringIO()
        table, zones = csv.writer(stream, lineterminator="\n"), self.contact.zone_names
        parts = ("resultant x", "resultant y", "starts", "ends")
        table.writerow(
            [self.key, "breakpoint", "enter", "leave", "peak", "peak x", "peak y"]
            + [f"{zone} {part}" for zone in zones for part in parts]
            + ["nodes in contact"]
        )
        for state in self.states:
            place = ["", ""] if state.at is None else self.contact.points[state.at].tolist()
            row = [state.value, int(state.breakpoint), _cell(state.entered), _cell(state.left), state.peak, *place]
            for zone, force in zip(zones, state.resultant, strict=True):
                row += [*force, *map(_cell, state.ends(zone))]
            table.writerow([*row, _cell(state.touching)])
        return stream.getvalue()


def _cell(numbers: Sequence[float]) -> str:
    """Numbers in one cell."""
    return " ".join(map(repr, map(_plain, numbers)))


def _plain(number: float) -> float:
    """A number as a Python number, so that it is written plainly."""
    return int(number) if isinstance(number, int | np.integer) else float(number)
