from bemcontact.analysis import Result as Result
from bemcontact.analysis import condense as condense
from bemcontact.analysis import solve as solve
from bemcontact.contact import CondensedContact as CondensedContact
from bemcontact.contact import ContactSolution as ContactSolution
from bemcontact.contact import Status as Status
from bemcontact.contact import Weights as Weights
from bemcontact.errors import BemContactError as BemContactError
from bemcontact.errors import NotConvexError as NotConvexError
from bemcontact.errors import ProblemError as ProblemError
from bemcontact.errors import SingularSystemError as SingularSystemError
from bemcontact.errors import SolverError as SolverError
from bemcontact.errors import SpecError as SpecError
from bemcontact.formulations.complementarity import solve_lcp as solve_lcp
from bemcontact.problem.problem import Problem as Problem
from bemcontact.spec import load as load
from bemcontact.spec import loads as loads
from bemcontact.spec import schema as schema

__version__: str
