"""What a small change may hide: errors of opposite sign, such as that of corners and that of all other elements.

Where they nearly cancel on one pair of meshes, a force changes little and its error is not small. Their sizes are
bounded by energies; where the bound says too much, the elements that have most of it are bisected alone, which tells
the parts. Without contact this is done for the displacement, of which no pressure tells the error.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bemcontact.adaptivity.fields import MeshDifference, Solved, most_of, solved
from bemcontact.adaptivity.sizes import apart
from bemcontact.arrays import Array, BoolArray
from bemcontact.problems.problem import Problem

SHARE = 0.8
"""Part of the bound that the elements have which are bisected alone."""
REMAINS = 0.5
"""Part of the changes of opposite sign that may remain as an error."""


def hidden_change(difference: MeshDifference, zone: int) -> float:
    """Change of the force of a zone that the change of the force may hide, over the force; zero without pressure."""
    force = difference.fine.force(difference.pair[1], zone)
    if not force > 0:
        return 0.0
    changes = float(difference.force_errors[zone].sum())
    if difference.partly is not None:
        before, between, after = (item.force(item.answers[difference.number], zone) for item in difference.meshes)
        changes = min(changes, abs(between - before) + abs(after - between))
    return REMAINS * changes / force


def hidden_displacement(difference: MeshDifference) -> float:
    """Change of the largest displacement that its change may hide, over it; zero if it was not told apart."""
    if difference.partly is None or difference.pair[1].pressure.any():
        return 0.0
    before, between, after = (item.answers[difference.number].largest_displacement for item in difference.meshes)
    return REMAINS * (abs(between - before) + abs(after - between)) / after if after > 0 else 0.0


def hiding(difference: MeshDifference, most: float) -> list[Array]:
    """What each element (m,) may change the force of a zone by, of zones where more than `most` of it may be hidden."""
    return [errors for zone, errors in enumerate(difference.force_errors) if hidden_change(difference, zone) > most]


def told_apart(differences: Sequence[MeshDifference], most: float) -> list[MeshDifference]:
    """Solve on a third mesh where more than `most` of a force may be hidden: the elements of most of it bisected.

    Without contact it has those bisected in which most of the energy changes.
    """
    elements = np.zeros(len(differences[0].coarse.mesh.elements), bool)
    for difference in differences:
        for errors in hiding(difference, most):
            elements |= most_of(errors, SHARE)
        if not difference.pair[1].pressure.any():
            elements |= most_of(difference.energy, SHARE)
    if not elements.any():
        return list(differences)
    partly = solved(_partly_cut(differences[0].coarse, elements))
    return [replace(difference, partly=partly) for difference in differences]


def _partly_cut(coarse: Solved, elements: BoolArray) -> Problem:
    """The problem with some elements (m,) of a mesh in two."""
    problem, ends = coarse.body.problem, dict[str, tuple[float, ...]]()
    for number, name in enumerate(coarse.mesh.edge_names):
        places = coarse.mesh.ends_on(name)
        middles = (places[:-1] + places[1:]) / 2
        # edges that follow others have elements of any length, and need not state them
        ends[name] = apart(np.sort(np.append(places[1:-1], middles[elements[coarse.mesh.edge == number]])))
    whole = problem.model_copy(update={"mesh": problem.mesh.model_copy(update={"refine": 1})})
    return whole.with_element_ends(ends)
