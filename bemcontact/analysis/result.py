"""A contact solution, judged: all that is known of it, as numbers, lists and texts."""

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bemcontact.adaptivity.mesh_fit import MeshFit
from bemcontact.assessment.certificate import Certificate
from bemcontact.assessment.footprint import Footprint
from bemcontact.assessment.residual import Residuals
from bemcontact.bem.condense import BoundaryState
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.multistart import RandomStarts
from bemcontact.contact.record import contact_record, solution_record
from bemcontact.contact.solution import ContactSolution
from bemcontact.options import Weights
from bemcontact.problem.problem import Problem
from bemcontact.version import __version__


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Result:
    """A contact solution, judged.

    Parameters
    ----------
    problem : what was asked, with the element ends of a fitted mesh; None if a condensed problem was
    contact : the condensed problem
    solution : what the formulation found
    weights : of the objective
    objective : pᵀJδ with these weights, recomputed [p L²]
    residuals, certificate : the judgement, recomputed from the condensed problem
    footprint : contact intervals, peak, resultant
    boundary : displacement and traction on the whole boundary, or None if no boundary stands behind `contact`
    degrees_of_freedom : two for each node of the mesh, or None likewise
    notes : what a person should know: of the condensation, of the solver, of the mesh
    seconds : spent on each stage
    starts : where the searches from random starts ended, if several were asked for
    mesh_fit : how the mesh was fitted to the ends of contact, if that was asked for
    """

    problem: Problem | None
    contact: CondensedContact
    solution: ContactSolution
    weights: Weights
    objective: float
    residuals: Residuals
    certificate: Certificate
    footprint: Footprint
    boundary: BoundaryState | None
    degrees_of_freedom: int | None
    notes: tuple[str, ...]
    seconds: dict[str, float]
    starts: RandomStarts | None = None
    mesh_fit: MeshFit | None = None

    def __repr__(self) -> str:
        """One line: name, formulation, verdict, peak."""
        peak = "no contact" if self.footprint.peak is None else f"peak pressure {self.footprint.peak.pressure:.6g}"
        verdict = "certified" if self.certified else self.certificate.kind.value
        return f"<Result of {self.contact.name!r} by {self.solution.formulation}: {verdict}, {peak}>"

    @property
    def certified(self) -> bool:
        """Whether this is proved to be the solution, and the only one."""
        return self.certificate.certified

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Which contact points (n,) are in contact, by `CondensedContact.touching`."""
        return self.contact.touching(self.solution.pressure, self.solution.displacement)

    @property
    def equilibrium_slack(self) -> float | None:
        """How far the discrete equations are from equilibrium, relative to the loads; None without a boundary."""
        return None if self.boundary is None else self.boundary.equilibrium_slack

    def to_dict(self) -> dict[str, Any]:
        """Give all of it as numbers, lists and texts, ready for JSON."""
        boundary = self.boundary
        return {
            "name": self.contact.name,
            "version": __version__,
            "formulation": str(self.solution.formulation),
            "certified": self.certified,
            "units": dict(self.contact.units),
            "dof": self.degrees_of_freedom,
            "notes": list(self.notes),
            **contact_record(self.contact),
            **solution_record(self.contact, self.solution),
            **self.footprint.to_dict(),
            "mesh_fit": None if self.mesh_fit is None else self.mesh_fit.to_dict(),
            "weights": self.weights.value,
            "objective": self.objective,
            "starts": None if self.starts is None else self.starts.to_dict(),
            "residuals": {**self.residuals.to_dict(), "equilibrium_slack": self.equilibrium_slack},
            "certificate": self.certificate.to_dict(),
            "boundary": None
            if boundary is None
            else {
                "points": boundary.points.tolist(),
                "displacement": boundary.displacement.tolist(),
                "traction": boundary.traction.tolist(),
                "edge": [boundary.edge_names[i] for i in boundary.edge],
            },
            "seconds": self.seconds,
        }

    def to_json(self, indent: int | None = 2) -> str:
        """Write `to_dict` as JSON; every number in it is finite."""
        return json.dumps(self.to_dict(), indent=indent, allow_nan=False, ensure_ascii=False)
