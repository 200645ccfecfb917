"""Contact problems and their solutions as numbers, lists and texts, ready for JSON."""

from dataclasses import asdict
from typing import Any

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution


def contact_record(contact: CondensedContact) -> dict[str, Any]:
    """Give what a reader of results needs of a condensed problem; its matrices are what `CondensedContact.save` writes.

    Parameters
    ----------
    contact : CondensedContact

    Returns
    -------
    dict
    """
    return {
        "contact_nodes": contact.size,
        "free_rigid_motions": contact.free_motions,
        "motion_names": list(contact.motion_names),
        "motion_load": contact.motion_load.tolist(),
        "nodes": contact.points.tolist(),
        "normals": contact.normals.tolist(),
        "zone": [contact.zone_names[i] for i in contact.zone],
        "run": contact.run.tolist(),
        "arc_position": contact.arc_position.tolist(),
        "tributary_lengths": contact.weights.tolist(),
        "initial_gap": contact.initial_gap.tolist(),
        "load_factors": dict(zip(contact.cases.names, contact.cases.factors.tolist(), strict=True)),
        "scales": contact.scales._asdict(),
    }


def solution_record(contact: CondensedContact, solution: ContactSolution) -> dict[str, Any]:
    """Give what a formulation found.

    Parameters
    ----------
    contact : CondensedContact
    solution : of it

    Returns
    -------
    dict
    """
    return {
        "solver": solution.solver,
        "status": solution.status.name.lower(),
        "rigid_amplitudes": solution.rigid_amplitudes.tolist(),
        "pressure": solution.pressure.tolist(),
        "gap": (contact.initial_gap + solution.displacement).tolist(),
        "normal_displacement": solution.displacement.tolist(),
        "iterations": solution.iterations,
        "polished": solution.polished,
        "search": None if solution.search is None else asdict(solution.search),
        "history": [
            {"quantity": trace.quantity, "first": trace.first, "values": list(trace.values)}
            for trace in solution.history
        ],
        "convexity": solution.smallest_eigenvalue,
        "tools": _tools_record(contact, solution),
    }


def _tools_record(contact: CondensedContact, solution: ContactSolution) -> list[dict[str, Any]]:
    """Give where the tools are in a solution, and what the body presses on them with."""
    tools = contact.tools
    return [
        {
            "name": name,
            "point": point.tolist(),
            "displacement": displacement[:2].tolist(),
            "rotation": float(displacement[2]),
            "force_of_body": force[:2].tolist(),
            "moment_of_body": float(force[2]),
            "free": free.tolist(),
        }
        for name, point, displacement, force, free in zip(
            tools.names,
            tools.point,
            tools.displacement(solution.rigid_amplitudes),
            contact.tool_reactions(solution.pressure),
            tools.free.reshape(-1, 3),
            strict=True,
        )
    ]
