"""Statements of [SS92] on its five problems; what can be a reference stands in the files of the problems.

Pressures are in kN/cm², lengths in cm, as in the paper.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum, auto
from types import MappingProxyType

from bemcontact.options import FormulationName


class Quantity(Enum):
    """A quantity of an answer that stands beside a statement of the paper."""

    PRESSURE = auto()
    """Smallest and largest pressure, within a range of the coordinate if one is given."""
    PEAK = auto()
    """The largest pressure."""
    CONTACT = auto()
    """From where to where there is contact, by the coordinate."""
    OPEN_POINTS = auto()
    """How many contact points are open."""
    LEAST_GAP = auto()
    """The smallest gap."""
    FORCE = auto()
    """Size of the force that contact carries, in a direction."""
    DIFFERENCE = auto()
    """Largest difference of a pressure from the direct solution over its peak, as the solvers left it by themselves."""


@dataclass(frozen=True, kw_only=True)
class Statement:
    """A statement of the paper."""

    what: str
    """The quantity, in words."""
    said: str
    """What the paper says of it."""
    quantity: Quantity
    """What is read off our answers."""
    between: tuple[float, float] | None = None
    """Range of the coordinate, of a pressure."""
    direction: tuple[float, float] = (0.0, 1.0)
    """Direction of a force."""


@dataclass(frozen=True, kw_only=True)
class PaperProblem:
    """A problem of the paper."""

    model: str
    """Name of its file in ``models``."""
    figure: str
    """Figure of the paper."""
    symbol: str = "x"
    """Symbol of the coordinate of the figure, which is that of the references in the file."""
    variants: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    """Variants of the file that are run beside it, with their labels."""
    frame: tuple[float, float] | None = None
    """Least and largest pressure on the axis of the figure, where it is a narrow one."""
    statements: tuple[Statement, ...]
    """Statements of the paper."""
    iterations: Mapping[FormulationName, int] = field(default_factory=lambda: MappingProxyType({}))
    """Iterations of QPSOL that the paper prints."""
    differs: tuple[str, ...]
    """Where the paper and we differ, and why."""


CURVED = PaperProblem(
    model="cantilever_curved_surface",
    figure="Fig. 2",
    variants=MappingProxyType({"paper": "5 along", "paper, doubled": "10 along"}),
    frame=(49.99, 50.01),
    statements=(
        Statement(
            what="pressure from x = 40 to 95", said="50 ± 0.01", quantity=Quantity.PRESSURE, between=(40.0, 95.0)
        ),
        Statement(what="pressure, all along", said="uniform, 50", quantity=Quantity.PRESSURE),
        Statement(
            what="the three formulations apart, over the peak", said="nearly identical", quantity=Quantity.DIFFERENCE
        ),
    ),
    iterations=MappingProxyType({FormulationName.QP1: 63, FormulationName.QP2: 47, FormulationName.QP3: 70}),
    differs=(
        "Away from the clamp the paper is right, within the 0.01 of its axis. Of the two readings of its mesh "
        "only the one with ten elements along is that good; with five the error that the clamp makes reaches "
        "further.",
        "Near the clamp p cannot be 50: a clamp that holds u and v carries some of the load itself, so that p "
        "falls towards 0 there, after a peak. The axis of the paper's figure leaves it out. Were the clamp to "
        "hold v at one corner only, p would be 50 everywhere.",
    ),
)

CYLINDER = PaperProblem(
    model="cylinder_on_plane",
    figure="Fig. 3",
    variants=MappingProxyType({"paper": "paper's mesh"}),
    statements=(
        Statement(what="contact", said="good correlation with Hertz", quantity=Quantity.CONTACT),
        Statement(what="largest pressure", said="good correlation with Hertz", quantity=Quantity.PEAK),
        Statement(what="force on the half", said="810/2 = 405, the load", quantity=Quantity.FORCE),
    ),
    differs=(
        "Hertz is not the solution of this problem: his formula needs a contact that is narrow beside the radius, "
        "and here its half-width is a third of it. So the right answer differs from his by some per cent, and is "
        "held against finite elements instead.",
        "Nothing but contact holds the cylinder up. The paper used QP1 for it, and could not have used QP3, whose "
        "(35)-(38) need a body that conditions hold; here QP3 has the free motion as an unknown, and finds the same.",
    ),
)

CRACK = PaperProblem(
    model="elliptical_crack_closure",
    figure="Fig. 4",
    variants=MappingProxyType({"paper": "paper's mesh", "paper, finer crack": "finer crack"}),
    statements=(
        Statement(what="nodes left open, next to the tip", said="2", quantity=Quantity.OPEN_POINTS),
        Statement(
            what="pressure in the middle", said="in the figure only", quantity=Quantity.PRESSURE, between=(0.0, 0.0)
        ),
        Statement(what="largest pressure", said="the two meshes agree closely", quantity=Quantity.PEAK),
    ),
    differs=(
        "The open nodes at the tip are an effect of the mesh: on the paper's meshes one is open, moving to the tip "
        "as the elements there become shorter, and none is where they are shorter than half of the tip's radius on "
        "both sides. The crack closes to its tip. Kikuchi and Oden had open nodes too, but the paper's mesh was "
        "graded as theirs.",
        "The closed form of an infinite panel lies lower, because this panel is not large beside the crack: it is "
        "shown, not judged.",
    ),
)

BOLT = PaperProblem(
    model="bolt_in_plate",
    figure="Fig. 5",
    symbol="θ",
    variants=MappingProxyType({"paper": "paper's mesh", "paper, doubled": "doubled"}),
    statements=(
        Statement(what="contact", said="in the figure only", quantity=Quantity.CONTACT),
        Statement(what="largest pressure", said="the two meshes agree", quantity=Quantity.PEAK),
        Statement(what="force along x", said="25 · 3 = 75, the pull", quantity=Quantity.FORCE, direction=(1.0, 0.0)),
    ),
    differs=(
        "The source of the problem is not at hand and the text is ambiguous, so that this is one reading of it: a "
        "is half the length of the plate, h its height, and the bolt touches the left side of the hole.",
        "The paper's 14 elements are too few above the hole and in the ligament, not in the contact. Its pressure "
        "is off by some per cent for that, and doubling the mesh mends it.",
        "Contact alone holds the plate along x, as it holds the cylinder, and QP3 finds the same here too.",
    ),
)

FLAT = PaperProblem(
    model="cantilever_flat_surface",
    figure="Fig. 6",
    variants=MappingProxyType({"printed modulus": "printed E", "paper": "paper's mesh"}),
    statements=(
        Statement(what="contact", said="from 42.5; ABAQUS 42; beam theory 45.7", quantity=Quantity.CONTACT),
        Statement(what="largest pressure", said="in the figure only", quantity=Quantity.PEAK),
        Statement(what="smallest gap", said="0, there is contact", quantity=Quantity.LEAST_GAP),
    ),
    differs=(
        "The printed E = 2e6 kN/cm² cannot be meant: the beam is so stiff that its tip does not come down to the "
        "plane, and nothing touches. The paper's own beam theory, (43), gives its 45.7 for E = 2.1e4, and 45.2 "
        "for E = 2e4. So 2e4 is taken here, a slip of 100 in the unit assumed.",
        "With it contact starts where the paper has it, to half of its node spacing. Beam theory, which lays the "
        "beam down flat and knows no shear, starts later, as the paper says itself.",
    ),
)

PROBLEMS = (CURVED, CYLINDER, CRACK, BOLT, FLAT)
"""All of them, in the order of the paper."""
