"""Rows of a study: the values, outputs and verdicts of one member."""

from collections.abc import Mapping
from enum import StrEnum
from math import isfinite
from typing import Any

from bemcontact.analysis.result import BEYOND, Result
from bemcontact.frozen import frozen_value
from bemcontact.serialization import Leaf
from bemcontact.studies.outputs import Reading, grows, readings


class MemberStatus(StrEnum):
    """How a member ended, in the words of the table."""

    HOLDS = "holds"
    NOT_ASSESSED = "mesh not assessed"
    NOT_MET = "mesh not met"
    NOT_CERTIFIED = "not certified"
    FAILED = "failed"


@frozen_value
class MemberRow(Leaf):
    """A member of a study."""

    number: int
    """Number of the member, from 0 on; the first axis changes slowest."""
    values: dict[str, Any]
    """Value on each axis, by its name."""
    status: MemberStatus
    """How the member ended: holds, mesh not assessed (no accuracy is asked), mesh not met, not certified, or failed."""
    equations: str
    """What is proved of the solution of the equations, in a few words; empty if the member failed."""
    certified: bool
    """Whether the solution is proved to be the contact state, the only one, and the body penetrates no surface."""
    met: bool | None
    """Whether the mesh is as accurate as was asked; null if errors were not estimated."""
    mesh_error: float | None
    """Largest error bar, relative; null if it is not known."""
    message: str
    """Why the member does not hold, or has no peak, in sentences."""
    outputs: dict[str, Reading]
    """Outputs by name; none if the member failed."""
    stress: str = ""
    """Where stress is infinite; empty if it is finite, or if the largest stresses were not asked for."""
    notes: tuple[str, ...] = ()
    """What error bars of the member do not include, each in a sentence."""

    @property
    def holds(self) -> bool | None:
        """Whether it is certified, and the mesh as accurate as was asked; None if mesh errors are not assessed."""
        return {MemberStatus.HOLDS: True, MemberStatus.NOT_ASSESSED: None}.get(self.status, False)

    def reading(self, column: str) -> Reading:
        """An output; one without a value if the member does not have it."""
        return self.outputs.get(column, Reading(value=None))


def row_of(number: int, values: Mapping[str, Any], result: Result, *, stresses: bool = False) -> MemberRow:
    """The row of a member that was solved; its largest stresses are looked for if they are asked for."""
    accuracy, deepest = result.accuracy, result.penetration
    status = MemberStatus.HOLDS
    if not result.certified:
        status = MemberStatus.NOT_CERTIFIED
    elif result.holds is None:
        status = MemberStatus.NOT_ASSESSED
    elif not result.holds:
        status = MemberStatus.NOT_MET
    known = accuracy.met is not None and isfinite(accuracy.worst)
    return MemberRow(
        number=number,
        values=dict(values),
        status=status,
        equations=result.certificate.heading if deepest is None else str(deepest.kind),
        certified=result.certified,
        met=accuracy.met,
        mesh_error=float(accuracy.worst) if known else None,
        message=in_one_message(_message(status, result), _without_peak(result)),
        stress=_infinite_stress(result) if stresses else "",
        notes=tuple(note for note in result.notes if BEYOND in note) if result.certified else (),
        outputs=readings(result, stresses=stresses),
    )


def in_one_message(*messages: str) -> str:
    """Messages as one; each of them may be empty."""
    *before, last = [message for message in messages if message] or [""]
    return "; ".join([*(message.removesuffix(".") for message in before), last])


def _message(status: MemberStatus, result: Result) -> str:
    """Why a member does not hold."""
    if status is MemberStatus.NOT_CERTIFIED:
        return " ".join(result.words.split())
    if status is not MemberStatus.NOT_MET:
        return ""
    accuracy = result.accuracy
    error = (
        f"the largest error is {100 * accuracy.worst:.2g} %" if isfinite(accuracy.worst) else "an error is not known"
    )
    asked = f"{100 * (accuracy.asked or 0.0):.3g} % is asked"
    if accuracy.met is None:
        error = "errors were not estimated"
    return "; ".join(filter(None, (error, asked, accuracy.reason)))


def _without_peak(result: Result) -> str:
    """Why there is no peak pressure; empty if there is one."""
    if result.accuracy.infinite:
        return f"the peak pressure is infinite in {', '.join(result.accuracy.infinite)}"
    return "" if result.footprint.intervals else "the body touches no surface"


def _infinite_stress(result: Result) -> str:
    """Say if stress is infinite somewhere; empty if it is not."""
    largest = result.largest_stresses()
    if grows(largest):
        return "von Mises stress grows up to an infinite one: it has no largest value"
    infinite = len(largest.singular)
    return "stress is infinite at corners or edges, von_mises is the largest maximum away from them" if infinite else ""


def failed_row(number: int, values: Mapping[str, Any], message: str) -> MemberRow:
    """The row of a member that has no result."""
    return MemberRow(
        number=number,
        values=dict(values),
        status=MemberStatus.FAILED,
        equations="",
        certified=False,
        met=None,
        mesh_error=None,
        message=" ".join(message.split()),
        outputs={},
    )


def row_from(record: Mapping[str, Any], number: int, values: Mapping[str, Any]) -> MemberRow:
    """Read a row back from its JSON, as the member of a number with these values."""
    outputs = {name: Reading(**item) for name, item in record["outputs"].items()}
    kept = {key: record[key] for key in ("equations", "certified", "met", "mesh_error", "message")}
    kept |= {"stress": record.get("stress", ""), "notes": tuple(record.get("notes", ()))}
    return MemberRow(number=number, values=dict(values), status=MemberStatus(record["status"]), outputs=outputs, **kept)
