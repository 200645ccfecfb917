"""Unbroken pieces of boundary that may touch, and how each of them is drawn."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.report.figures.page import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, shortened

PIECE_COLOURS = (VERMILION, BLUE, GREEN, PURPLE, ORANGE, SKY)


@dataclass(frozen=True, kw_only=True)
class Piece:
    """An unbroken piece of boundary in one contact zone: its points in order, and how it is drawn."""

    label: str
    order: int
    index: NDArray[np.int64]

    @property
    def colour(self) -> str:
        """Its colour; there are six."""
        return PIECE_COLOURS[self.order % len(PIECE_COLOURS)]

    @property
    def dashes(self) -> str:
        """Its line style: an unbroken line is never drawn over another."""
        return "dashed" if self.order else "solid"


def pieces_of(contact: CondensedContact) -> Iterator[Piece]:
    """List the unbroken pieces of all contact zones, in the order of the contact points."""
    for order, run in enumerate(np.unique(contact.run)):
        index = np.flatnonzero(contact.run == run)
        index = index[np.argsort(contact.arc_position[index], kind="stable")]
        zone = int(contact.zone[index[0]])
        label = shortened(contact.zone_names[zone], 24)
        if len(np.unique(contact.run[contact.zone == zone])) > 1:
            label += f" ({contact.points[index[0], 0]:.3g}, {contact.points[index[0], 1]:.3g}) on"
        yield Piece(label=label, order=order, index=index)
