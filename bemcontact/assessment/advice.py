"""What a person can do about an answer that is not the contact state: advice by status and formulation."""

from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.options import FormulationName

LOCAL = (FormulationName.QP1, FormulationName.QP2)
"""Those that start somewhere and may end in a local minimum."""
DIRECT = "--formulation complementarity"


def advice(solution: ContactSolution) -> str:
    """Say in a sentence what to try, in the words of the command line.

    Parameters
    ----------
    solution : that was found not to be the contact state

    Returns
    -------
    str
    """
    match solution.status:
        case Status.INFEASIBLE:
            return "Check that loads and conditions press the body onto its support, or refine the mesh (--refine 2)."
        case Status.UNBOUNDED:
            return "Take the tributary weights."
        case Status.ITERATION_LIMIT:
            return f"Raise the limit (--max-iterations; {solution.iterations} were done){_or_another(solution)}."
        case _ if solution.formulation == FormulationName.COMPLEMENTARITY:
            return "Refine the mesh (--refine 2), and look in it for very short elements."
        case Status.LOCAL_MINIMUM:
            return f"Try {DIRECT}, or other starts (--starts 20) with the tributary weights."
        case Status.NUMERICAL_FAILURE:
            return f"Try {DIRECT}, and look in the mesh for very short elements."
        case _:
            return f"Try {DIRECT}, a finer mesh (--refine 2), or the tributary weights if these are others."


def _or_another(solution: ContactSolution) -> str:
    """The other way out of a search that is too long."""
    return ", or take another start (--seed 1)" if solution.formulation in LOCAL else ""
