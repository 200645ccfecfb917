"""What JSON holds of a contact problem and of a solution, point by point."""

import numpy as np

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.known_motions import KnownMotions
from bemcontact.contact.solution import ContactSolution, LocalSearch, Status, Trace
from bemcontact.serialization import Gappy, Pair, Pairs, Record, Vector


class UnitsRecord(Record):
    """Labels of the units that all numbers are in; nothing is converted. JSON leaves out other labels."""

    length: str = ""
    """Label of the unit of length [L], or empty."""
    force: str = ""
    """Label of the unit of force, or empty; pressure [p] is force over length squared."""


class ScalesRecord(Record):
    """Scales by which residuals and objectives are divided; a tuple in Python."""

    displacement: float
    """Typical displacement U [L]."""
    pressure: float
    """Typical pressure T [p]."""


class ContactRecord(Record):
    """Contact points of a condensed problem; lists go point by point. JSON leaves the matrices to contact.npz."""

    contact_nodes: int
    """Number of contact points."""
    free_rigid_motions: int
    """Number of rigid motions that contact alone holds."""
    motion_names: tuple[str, ...]
    """Name of each free rigid motion."""
    motion_load: Vector
    """Work of the loads in each free motion, for a motion of unit displacement, per thickness [p L]."""
    nodes: Pairs
    """Undeformed place (x, y) [L]."""
    normals: Pairs
    """Unit normal of the rigid surface, into the body; of two elastic bodies the common one, into the first body."""
    zone: list[str]
    """Name of the contact zone."""
    run: list[int]
    """Number of the unbroken piece of boundary."""
    arc_position: Vector
    """Arc length along that piece [L]."""
    tributary_lengths: Vector
    """Length that belongs to the point [L]: Σ length · pressure · normal is the resultant."""
    initial_gap: Vector
    """Distance from the rigid surface, or the other body, along the normal before anything deforms; negative if inside
    [L]."""
    load_factors: dict[str, float]
    """Factor of each load case; empty if there are none."""
    scales: ScalesRecord
    """Typical displacement and pressure, by which residuals and objectives are divided."""


def contact_record(contact: CondensedContact) -> ContactRecord:
    """Describe the contact points of a condensed problem."""
    return ContactRecord(
        contact_nodes=contact.size,
        free_rigid_motions=contact.free_motions,
        motion_names=contact.motion_names,
        motion_load=contact.motion_load,
        nodes=contact.points,
        normals=contact.normals,
        zone=[contact.zone_names[i] for i in contact.zone],
        run=contact.run.tolist(),
        arc_position=contact.arc_position,
        tributary_lengths=contact.weights,
        initial_gap=contact.initial_gap,
        load_factors=dict(zip(contact.cases.names, contact.cases.factors.tolist(), strict=True)),
        scales=ScalesRecord(**contact.scales._asdict()),
    )


class ToolRecord(Record):
    """State of a tool, a rigid surface that moves: its displacement, and the force of the body on it."""

    name: str
    """Name in the problem."""
    point: Pair
    """Point (x, y) about which the tool turns, and about which moments are [L]."""
    displacement: Pair | None
    """Displacement (x, y) of that point [L]; null if it is not known how far the tool moves."""
    rotation: float | None
    """Rotation in radians, counterclockwise; null if it is not known how far the tool turns."""
    force_of_body: Pair
    """Force (x, y) of the body on the tool, per thickness [p L]."""
    moment_of_body: float
    """Moment of that force about the point, counterclockwise, per thickness [p L²]."""
    free: tuple[bool, bool, bool]
    """Whether the tool is free to move along x, along y and to rotate, as it is loaded there."""
    zones: tuple[str, ...]
    """Names of the zones whose surfaces it moves."""


class SolutionRecord(Record):
    """Solution as a formulation reports it, with its gap and tools; lists go contact point by contact point."""

    solver: str
    """Name of the program that solved it."""
    status: Status
    """How the solver ended, which proves nothing of the solution."""
    rigid_amplitudes: Vector
    """Amplitude of each free rigid motion, those of the body first, then those of tools [L]: the displacement along a
    translation; for a rotation, the displacement at a reference distance from its center; `rotations` has its angle.
    Where elastic bodies touch, they are those of one beside the other. They belong to the displacements, also where the
    amount is not known: see `unknown_motions`."""
    rotations: Gappy | None
    """Angle of each free rigid motion, in radians and in the sense of its name, which is counterclockwise for a body or
    a tool that turns alone, so that clockwise is negative; zero in a translation; null where the amount is not known.
    That of a body that touches elastic ones is the mean rotation of its boundary; null for a condensed problem of such
    bodies. Displacements are small in linear elasticity: the angle is the displacement over the distance from the
    center."""
    unknown_motions: tuple[str, ...]
    """Names of the free rigid motions whose amount is not known: contact leaves them open, or only slopes and levers as
    drawn hold them, which move with the body; of a condensed problem the former alone. They have no rotation and no
    error bar, and their amplitudes are one state of many."""
    undetermined: tuple[str, ...]
    """Names of those that contact leaves open; their amplitudes are chosen by a rule."""
    pressure: Vector
    """Normal traction per undeformed length, positive in compression [p]."""
    gap: Vector
    """Initial gap plus normal displacement [L]."""
    normal_displacement: Vector
    """Displacement along the rigid normal, away from the surface, where a loaded tool has moved to [L]."""
    iterations: int
    """Number of iterations as the solver counts them."""
    polished: bool
    """Whether an exact step on the contact set has replaced the solver's own pressures."""
    search: LocalSearch | None
    """Search of a local solver, or null."""
    history: tuple[Trace, ...]
    """Quantities of the solver, iteration by iteration."""
    convexity: float | None
    """Smallest eigenvalue of the scaled Hessian of QP3 on the equilibrium space, or null if it was not computed."""
    tools: list[ToolRecord]
    """Rigid surfaces that are displaced or loaded; empty if all are fixed."""


def solution_record(contact: CondensedContact, solution: ContactSolution, motions: KnownMotions) -> SolutionRecord:
    """Describe a solution of a condensed problem, and what is known of its free motions."""
    return SolutionRecord(
        solver=solution.solver,
        status=solution.status,
        rigid_amplitudes=solution.rigid_amplitudes,
        rotations=motions.rotations,
        unknown_motions=motions.unknown,
        undetermined=solution.undetermined,
        pressure=solution.pressure,
        gap=contact.initial_gap + solution.displacement,
        normal_displacement=solution.displacement,
        iterations=solution.iterations,
        polished=solution.polished,
        search=solution.search,
        history=solution.history,
        convexity=solution.smallest_eigenvalue,
        tools=_tool_records(contact, solution, motions),
    )


def _tool_records(contact: CondensedContact, solution: ContactSolution, motions: KnownMotions) -> list[ToolRecord]:
    """Describe where the tools are in a solution, and with what force the body presses on them."""
    tools = contact.tools
    return [
        ToolRecord(
            name=name,
            point=point,
            displacement=(x, y) if known[0] and known[1] else None,
            rotation=rotation if known[2] else None,
            force_of_body=(fx, fy),
            moment_of_body=moment,
            free=(free[0], free[1], free[2]),
            zones=tuple(contact.zone_names[i] for i in np.unique(contact.zone[moved.any(axis=1)])),
        )
        for name, moved, point, (x, y, rotation), (fx, fy, moment), free, known in zip(
            tools.names,
            np.split(tools.motions, len(tools.names), axis=1) if tools.names else (),
            tools.point.tolist(),
            tools.displacement(solution.rigid_amplitudes).tolist(),
            contact.tool_reactions(solution.pressure).tolist(),
            tools.free.reshape(-1, 3).tolist(),
            motions.tools.tolist(),
            strict=True,
        )
    ]


def units_record(contact: CondensedContact) -> UnitsRecord:
    """Describe the units of a condensed problem."""
    return UnitsRecord(length=contact.units.get("length", ""), force=contact.units.get("force", ""))
