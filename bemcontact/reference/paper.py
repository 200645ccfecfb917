"""Statements of [SS92] on its five problems; reference values are in the files of the problems.

Pressures are in kN/cm², lengths in cm, as in the paper.
"""

from collections.abc import Mapping
from dataclasses import field
from enum import Enum, auto
from types import MappingProxyType

from bemcontact.frozen import frozen_value
from bemcontact.options import FormulationName


class PaperQuantity(Enum):
    """A quantity that is compared with a statement of the paper."""

    PRESSURE = auto()
    """Smallest and largest pressure, within a range of the coordinate if one is given."""
    PEAK = auto()
    """The largest pressure."""
    CONTACT = auto()
    """Smallest and largest coordinate of contact."""
    OPEN_POINTS = auto()
    """Number of open contact points."""
    LEAST_GAP = auto()
    """The smallest gap."""
    FORCE = auto()
    """Magnitude of the contact force in a direction."""
    DIFFERENCE = auto()
    """Largest difference of an unpolished pressure from the direct solution, over the peak."""


@frozen_value
class PaperStatement:
    """A statement of the paper."""

    what: str
    """Name of the quantity."""
    says: str
    """The paper's statement, in words."""
    quantity: PaperQuantity
    """Quantity that is computed."""
    between: tuple[float, float] | None = None
    """Range of the coordinate, of a pressure."""
    direction: tuple[float, float] = (0.0, 1.0)
    """Direction of a force."""


@frozen_value
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
    statements: tuple[PaperStatement, ...]
    """Statements of the paper."""
    iterations: Mapping[FormulationName, int] = field(default_factory=lambda: MappingProxyType({}))
    """Iterations of QPSOL that the paper prints."""
    differs: tuple[str, ...]
    """Differences between the paper and these results, with the reasons."""


CURVED = PaperProblem(
    model="cantilever_curved_surface",
    figure="Fig. 2",
    variants=MappingProxyType({"paper": "5 along", "paper, doubled": "10 along"}),
    frame=(49.99, 50.01),
    statements=(
        PaperStatement(
            what="pressure from x = 40 to 95", says="50 ± 0.01", quantity=PaperQuantity.PRESSURE, between=(40.0, 95.0)
        ),
        PaperStatement(what="pressure, all along", says="uniform, 50", quantity=PaperQuantity.PRESSURE),
        PaperStatement(
            what="the three formulations apart, over the peak",
            says="nearly identical",
            quantity=PaperQuantity.DIFFERENCE,
        ),
    ),
    iterations=MappingProxyType({FormulationName.QP1: 63, FormulationName.QP2: 47, FormulationName.QP3: 70}),
    differs=(
        "Away from the clamp the results agree with the paper within 0.01, the range of its axis. Of the two readings "
        "of its mesh only the one with ten elements along the beam is that accurate. With five elements the error "
        "from the clamp reaches farther.",
        "Near the clamp p cannot be 50. A clamp that holds u and v carries part of the load, so p has a peak and then "
        "falls towards 0 there. The axis of the paper's figure does not show this. If the clamp held v at one corner "
        "only, p would be 50 everywhere.",
    ),
)

CYLINDER = PaperProblem(
    model="cylinder_on_plane",
    figure="Fig. 3",
    variants=MappingProxyType({"paper": "paper's mesh"}),
    statements=(
        PaperStatement(what="contact", says="good correlation with Hertz", quantity=PaperQuantity.CONTACT),
        PaperStatement(what="largest pressure", says="good correlation with Hertz", quantity=PaperQuantity.PEAK),
        PaperStatement(what="force on the half", says="810/2 = 405, the load", quantity=PaperQuantity.FORCE),
    ),
    differs=(
        "Hertz is not the solution of this problem. His formula needs a contact that is narrow beside the radius, but "
        "here the half-width is a third of the radius. The solution differs from Hertz by some per cent, so it is "
        "compared with finite elements instead.",
        "Only contact holds the cylinder up. The paper used QP1 for it. It could not use QP3, because (35)-(38) need "
        "a body that is held by conditions. Here QP3 has the free motion as an unknown, and its solution is the same.",
    ),
)

CRACK = PaperProblem(
    model="elliptical_crack_closure",
    figure="Fig. 4",
    variants=MappingProxyType({"paper": "paper's mesh", "paper, finer crack": "finer crack"}),
    statements=(
        PaperStatement(what="nodes left open, next to the tip", says="2", quantity=PaperQuantity.OPEN_POINTS),
        PaperStatement(
            what="pressure in the middle",
            says="in the figure only",
            quantity=PaperQuantity.PRESSURE,
            between=(0.0, 0.0),
        ),
        PaperStatement(what="largest pressure", says="the two meshes agree closely", quantity=PaperQuantity.PEAK),
    ),
    differs=(
        "The open nodes at the tip are an effect of the mesh. On the paper's meshes one node is open. It moves to the "
        "tip as the elements there become shorter. No node is open if the elements on both sides are shorter than "
        "half of the tip's radius: the crack closes to its tip. Kikuchi and Oden had open nodes too, but on a mesh "
        "with the same grading.",
        "The closed form of an infinite panel gives a lower pressure, because this panel is not large beside the "
        "crack. It is shown, not judged.",
    ),
)

BOLT = PaperProblem(
    model="bolt_in_plate",
    figure="Fig. 5",
    symbol="θ",
    variants=MappingProxyType({"paper": "paper's mesh", "paper, doubled": "doubled"}),
    statements=(
        PaperStatement(what="contact", says="in the figure only", quantity=PaperQuantity.CONTACT),
        PaperStatement(what="largest pressure", says="the two meshes agree", quantity=PaperQuantity.PEAK),
        PaperStatement(
            what="force along x", says="25 · 3 = 75, the pull", quantity=PaperQuantity.FORCE, direction=(1.0, 0.0)
        ),
    ),
    differs=(
        "The source of the problem was not available, and the text is ambiguous. This is one reading of it: a is half "
        "the length of the plate, h is its height, and the bolt touches the left side of the hole.",
        "The paper's 14 elements are too few above the hole and in the ligament, not in the contact. The error of the "
        "pressure is some per cent. The doubled mesh removes it.",
        "Only contact holds the plate along x, as with the cylinder. QP3 has the same solution here too.",
    ),
)

FLAT = PaperProblem(
    model="cantilever_flat_surface",
    figure="Fig. 6",
    variants=MappingProxyType({"printed modulus": "printed E", "paper": "paper's mesh"}),
    statements=(
        PaperStatement(what="contact", says="from 42.5; ABAQUS 42; beam theory 45.7", quantity=PaperQuantity.CONTACT),
        PaperStatement(what="largest pressure", says="in the figure only", quantity=PaperQuantity.PEAK),
        PaperStatement(what="smallest gap", says="0, there is contact", quantity=PaperQuantity.LEAST_GAP),
    ),
    differs=(
        "The printed E = 2e6 kN/cm² must be a misprint: the beam is so stiff that its tip does not reach the plane, "
        "and nothing touches. The paper's own beam theory, (43), gives 45.7 for E = 2.1e4, and 45.2 for E = 2e4. So E "
        "= 2e4 is used here. The assumed misprint is a factor of 100 in the unit.",
        "With this modulus contact starts where the paper states it, within half of its node spacing. In beam theory, "
        "which neglects shear, contact starts later, as the paper says.",
    ),
)

PROBLEMS = (CURVED, CYLINDER, CRACK, BOLT, FLAT)
"""Problems in the order of the paper."""
