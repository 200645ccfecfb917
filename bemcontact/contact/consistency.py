"""What the parts of a condensed contact problem have to fulfil, whoever made them: shapes, ranges and order."""

from collections.abc import Mapping
from operator import attrgetter
from typing import Any

import numpy as np

from bemcontact.arrays import Array, Dimensions, IntArray, read_arrays, real_array, whole_array
from bemcontact.checks.arguments import LONGEST_NAME, label, labels, shown, visible_texts
from bemcontact.errors import ProblemError, hidden_character

UNIT = 1e-9
"""Deviation of the length of a normal from 1 that is round-off; it enters the resultant as a relative error."""


def ensure_arrays(contact: Any) -> None:
    """Read the arrays of a problem; refuse wrong shapes and ranges, and points that are out of order."""
    n, k = contact_shape(contact)
    read_arrays(contact, {"zone": (n,), "run": (n,)}, reader=whole_array)
    needed: dict[str, Dimensions] = {
        "points": (n, 2), "normals": (n, 2), "arc_position": (n,), "compliance": (n, n), "free_displacement": (n,),
        "motion_load": (k,), "initial_gap": (n,), "weights": (n,),
    }  # fmt: skip
    optional: dict[str, Dimensions] = {
        "zone_weights": (len(contact.zone_names), n), "consistent_weights": (n, n), "element_length_weights": (n,),
    }  # fmt: skip
    read_arrays(contact, needed | {key: shape for key, shape in optional.items() if getattr(contact, key) is not None})
    if not (contact.weights > 0).all():
        raise ProblemError(f"weights must be positive; the smallest is {contact.weights.min():.3g}")
    if contact.zone_weights is not None:
        total = np.abs(contact.zone_weights).sum(axis=0)
        if (np.abs(total - contact.weights) > UNIT * contact.weights).any():
            raise ProblemError("the magnitudes of zone_weights must add up to the weights")
    lengths = np.hypot(*contact.normals.T)
    if (wrong := np.abs(lengths - 1.0) > UNIT).any():
        i = int(np.argmax(wrong))
        raise ProblemError(f"normals must be unit vectors; normal {i} has the length {lengths[i]:.9g}; divide by it")
    ensure_independent(contact.rigid_motions)
    _ensure_runs(contact)
    _ensure_held(contact)
    _ensure_arms(contact, k)
    _ensure_order(contact)


def ensure_numbers(contact: Any) -> None:
    """Refuse what the body and its load may be the reason of in arrays that were computed: too large, or dependent."""
    contact_shape(contact)
    read_arrays(contact, dict.fromkeys(("compliance", "free_displacement", "motion_load", "initial_gap")))
    ensure_independent(contact.rigid_motions)


def contact_shape(contact: Any) -> tuple[int, int]:
    """Number n of points and k of free motions, from the free motions (n, k), which are read."""
    read_arrays(contact, {"rigid_motions": (None, None)})
    n, k = contact.rigid_motions.shape
    if not n:
        raise ProblemError("a contact problem needs at least one contact point; found none")
    return n, k


def ensure_independent(rigid_motions: Array) -> None:
    """Refuse motions (n, k) of which a combination moves no contact point."""
    sizes = np.abs(rigid_motions).max(axis=0, initial=0.0)
    if not sizes.all() or (len(sizes) > 1 and np.linalg.matrix_rank(rigid_motions / sizes) < len(sizes)):
        raise ProblemError("rigid_motions needs independent columns: a motion that no point sees holds nothing")


def ensure_labels(contact: Any) -> None:
    """Refuse labels that are no texts, or that a spec could not have."""
    if _are_labels(contact):
        return
    label(contact.name, "name")
    for field, read in (("zone_names", labels), ("notes", visible_texts), ("motion_names", visible_texts)):
        object.__setattr__(contact, field, read(getattr(contact, field), field))
    units = contact.units
    if not isinstance(units, Mapping) or not all(isinstance(text, str) for pair in units.items() for text in pair):
        raise ProblemError(f"units must be a mapping such as {{'length': 'mm'}}; found {shown(units)}")
    labels([text for pair in units.items() for text in pair], "units")
    if len({*contact.zone_names}) < len(contact.zone_names):
        raise ProblemError(f"zone_names must be different from each other; found {', '.join(contact.zone_names)}")


def _are_labels(contact: Any) -> bool:
    """Whether all labels and notes are lines of visible text, as they nearly always are: one search tells."""
    names, units = contact.zone_names, contact.units
    if type(units) is not dict or any(type(part) is not tuple for part in (names, contact.notes, contact.motion_names)):
        return False
    texts = [contact.name, *names, *contact.notes, *contact.motion_names, *units, *units.values()]
    return (
        {*map(type, texts)} == {str}
        and max(map(len, texts)) <= LONGEST_NAME
        and hidden_character("".join(texts)) is None
        and len({*names}) == len(names)
    )


def ensure_parts_fit(contact: Any) -> None:
    """Refuse load cases, tools and pinned motions of another body."""
    n, k = contact.rigid_motions.shape
    if contact.motion_names and len(contact.motion_names) != k:
        raise ProblemError(f"motion_names has {len(contact.motion_names)} names for {k} free motions")
    c, t = len(contact.cases), 3 * len(contact.tools)
    shapes = {
        "cases.displacement": (n, c), "cases.motion_load": (k, c), "cases.position": (t, c), "cases.force": (t, c),
        "tools.motions": (n, t), "tools.amplitudes": (t, k), "pinned.load": (len(contact.pinned.motions), 1 + c),
        "pinned.tools": (t, len(contact.pinned.motions)), "pinned.magnitude": (1 + c,),
    }  # fmt: skip
    for key, shape in shapes.items():
        if (stated := attrgetter(key)(contact).shape) != shape:
            raise ProblemError(f"{key} has shape {stated} where {shape} is needed; n = {n}, k = {k}")


def _ensure_runs(contact: Any) -> None:
    """Refuse numbers of zones and runs that do not exist, and lengths of runs that are not positive."""
    lengths = real_array(contact.run_length, "run_length", (None,), finite=False)
    object.__setattr__(contact, "run_length", lengths)
    if not (lengths > 0).all():  # false for NaN too
        raise ProblemError("run_length must be positive, and infinite for a run that does not close on itself")
    for name, count in (("zone", len(contact.zone_names)), ("run", len(lengths))):
        index: IntArray = getattr(contact, name)
        if index.min() < 0 or index.max() >= count:
            found = f"{index.min()} to {index.max()}"
            raise ProblemError(f"{name} has numbers from {found}; there are {count}, numbered from 0")
    if (contact.arc_position > lengths[contact.run]).any():
        raise ProblemError("arc_position is beyond the end of a run: it is larger than its run_length")


def _ensure_held(contact: Any) -> None:
    """Refuse held ends that are half given: a run has two ends, each with an arc position and a point, or neither."""
    arc, points, runs = contact.held_arc, contact.held_points, len(contact.run_length)
    if arc is None and points is None:
        return
    if arc is None or points is None:
        raise ProblemError("held_arc and held_points belong together; give both or neither")
    arc = real_array(arc, "held_arc", (runs, 2), finite=False)
    points = real_array(points, "held_points", (runs, 2, 2), finite=False)
    object.__setattr__(contact, "held_arc", arc)
    object.__setattr__(contact, "held_points", points)
    if np.isinf(arc).any() or not np.isfinite(points[~np.isnan(arc)]).all():
        raise ProblemError("held_arc and held_points need finite numbers at held ends; held_arc is nan at other ends")


def _ensure_arms(contact: Any, motions: int) -> None:
    """Refuse arms of free motions that are not positive."""
    if contact.motion_arms is None:
        return
    arms = real_array(contact.motion_arms, "motion_arms", (motions,), finite=False)
    object.__setattr__(contact, "motion_arms", arms)
    if not (arms > 0).all():  # false for NaN too
        raise ProblemError("motion_arms must be positive, and infinite for a translation")


def _ensure_order(contact: Any) -> None:
    """Refuse points that are not listed zone by zone, run by run, and by arc position."""
    zone, run, arc = contact.zone, contact.run, contact.arc_position
    same = (zone[1:] == zone[:-1]) & (run[1:] == run[:-1])
    back = (zone[1:] < zone[:-1]) | (same & (arc[1:] < arc[:-1]))
    pieces = list(zip(zone[1:][~same].tolist(), run[1:][~same].tolist(), strict=True))
    if not back.any() and len({*pieces, (int(zone[0]), int(run[0]))}) == len(pieces) + 1:
        return
    i = int(np.argmax(back)) + 1 if back.any() else 0
    where = f"; point {i} goes back to arc_position {arc[i]:g}" if back.any() else ""
    raise ProblemError(
        f"contact points must be listed zone by zone, run by run, with rising arc_position{where}; sort them"
    )
