"""Other solvers for any quadratic program, each used if it is installed, and a fair way to run them.

    pip install unopy casadi

Every solver starts at the null vector and makes whatever claim it makes; what it found is judged elsewhere, from x.
"""

import ctypes
import importlib
import importlib.util
import multiprocessing
import os
import queue
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from multiprocessing.process import BaseProcess
from multiprocessing.queues import Queue
from types import ModuleType

import numpy as np
from numpy.typing import NDArray
from qp_instance import Instance
from scipy.optimize import minimize

Array = NDArray[np.float64]

ONE_SHOT_RADIUS = 1e10
"""Trust region so wide that Uno hands the whole program to BQPD at once."""


class Claim(Enum):
    """What a solver says of its answer."""

    OPTIMAL = "optimal"
    INFEASIBLE = "infeasible"
    UNBOUNDED = "unbounded"
    NOTHING = "nothing"


@dataclass(frozen=True, kw_only=True, eq=False)
class Answer:
    """What a solver returned.

    Parameters
    ----------
    x : (n,) or None
    claim : Claim
    says : the solver's own words
    """

    x: Array | None
    claim: Claim
    says: str = ""


@dataclass(frozen=True, kw_only=True)
class Peer:
    """A solver by name, the package that it needs, and the function that calls it."""

    name: str
    package: str
    solve: Callable[[Instance], Answer]

    @property
    def installed(self) -> bool:
        """Whether its package can be imported."""
        return importlib.util.find_spec(self.package) is not None


def bqpd(instance: Instance) -> Answer:
    """BQPD (Fletcher), an active-set method with inertia control, through Uno in one subproblem."""
    unopy = importlib.import_module("unopy")
    H, c, A = instance.H, instance.c, instance.A
    (row, column), (i, j) = np.nonzero(np.tril(H)), np.nonzero(A)
    curvature, slope = H[row, column], A[i, j]
    model = unopy.Model(unopy.PROBLEM_QUADRATIC, c.size, instance.bl, instance.bu, unopy.ZERO_BASED_INDEXING)
    model.set_objective(
        unopy.MINIMIZE, lambda x: float(c @ x + x @ H @ x / 2), lambda x, out: np.copyto(out, c + H @ x)
    )
    if len(A):
        model.set_constraints(
            len(A), lambda x, out: np.copyto(out, A @ x), instance.cl, instance.cu,
            slope.size, i, j, lambda x, out: np.copyto(out, slope),
        )  # fmt: skip
    model.set_lagrangian_hessian(
        curvature.size, unopy.LOWER_TRIANGLE, row, column, lambda x, factor, y, out: np.copyto(out, factor * curvature)
    )
    model.set_initial_primal_iterate(np.zeros(c.size))
    solver = unopy.UnoSolver()
    solver.set_preset("filtersqp")
    for option, value in {"QP_solver": "BQPD", "logger": "SILENT", "TR_radius": ONE_SHOT_RADIUS}.items():
        solver.set_option(option, value)
    result = solver.optimize(model)
    says = f"{result.optimization_status.name} {result.solution_status.name}"
    return Answer(x=np.array(result.primal_solution), claim=_read(says, optimal="SUCCESS FEASIBLE_KKT"), says=says)


def ipopt(instance: Instance) -> Answer:
    """IPOPT (Wächter and Biegler), an interior-point method with inertia correction, through CasADi."""
    casadi = importlib.import_module("casadi")
    x = casadi.MX.sym("x", instance.c.size)
    objective = casadi.dot(instance.c, x) + casadi.bilin(_sparse(casadi, instance.H), x, x) / 2
    options = {"print_time": False, "error_on_fail": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}
    rows = casadi.mtimes(_sparse(casadi, instance.A), x)
    solver = casadi.nlpsol("ipopt", "ipopt", {"x": x, "f": objective, "g": rows}, options)
    found = solver(x0=0, lbx=instance.bl, ubx=instance.bu, lbg=instance.cl, ubg=instance.cu)
    says = solver.stats()["return_status"]
    return Answer(x=np.array(found["x"]).ravel(), claim=_read(says, optimal="Solve"), says=says)


def qpoases(instance: Instance) -> Answer:
    """QpOASES (Ferreau and others), a parametric active-set method with flipping bounds, through CasADi."""
    casadi = importlib.import_module("casadi")
    n, m = instance.c.size, len(instance.A)
    shape = {"h": casadi.Sparsity.dense(n, n), "a": casadi.Sparsity.dense(m, n)}
    options = {
        "printLevel": "none", "print_time": False, "error_on_fail": False, "hessian_type": "indef",
        "enableFlippingBounds": True, "nWSR": 100 * (n + m),
    }  # fmt: skip
    solver = casadi.conic("qpoases", "qpoases", shape, options)
    found = solver(
        h=instance.H, g=instance.c, a=instance.A, lba=instance.cl, uba=instance.cu,
        lbx=instance.bl, ubx=instance.bu, x0=0,
    )  # fmt: skip
    stats = solver.stats()
    says = stats["return_status"]
    claim = Claim.OPTIMAL if stats["success"] else _read(says, optimal="Successful return")
    return Answer(x=np.array(found["x"]).ravel(), claim=claim, says=says)


def slsqp(instance: Instance) -> Answer:
    """SLSQP (Kraft), a sequential method with a quasi-Newton Hessian, of SciPy."""
    A, cl, cu = instance.A, instance.cl, instance.cu
    equal, below, above = cl == cu, np.isfinite(cl) & (cl < cu), np.isfinite(cu) & (cl < cu)
    slopes = np.vstack([A[below], -A[above]])
    least = np.append(cl[below], -cu[above])
    kinds = (("eq", A[equal], cl[equal]), ("ineq", slopes, least))
    constraints = [
        {"type": kind, "fun": lambda x, a=a, b=b: a @ x - b, "jac": lambda x, a=a: a} for kind, a, b in kinds if len(a)
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = minimize(
            instance.objective, np.zeros(instance.c.size), jac=instance.gradient, method="SLSQP",
            bounds=list(zip(instance.bl, instance.bu, strict=True)), constraints=constraints,
            options={"maxiter": 1000, "ftol": 1e-12},
        )  # fmt: skip
    says = found.message
    return Answer(x=found.x, claim=Claim.OPTIMAL if found.success else _read(says, optimal="successfully"), says=says)


PEERS = (
    Peer(name="BQPD (Uno)", package="unopy", solve=bqpd),
    Peer(name="qpOASES", package="casadi", solve=qpoases),
    Peer(name="IPOPT", package="casadi", solve=ipopt),
    Peer(name="SLSQP (SciPy)", package="scipy", solve=slsqp),
)


def run(peer: Peer, instance: Instance, limit: float) -> Answer:
    """Call a solver in a process of its own, its output silenced, and stop it at the time limit [s].

    A crash, an exception and a time-out each are an answer without x that claims nothing. Needs a system that forks.
    """
    context = multiprocessing.get_context("fork")
    answers = context.Queue()
    process = context.Process(target=_work, args=(answers, peer, instance), daemon=True)
    process.start()
    answer = Answer(x=None, claim=Claim.NOTHING, says="time limit or crash")
    try:
        answer = _first(answers, process, limit)
    except queue.Empty:
        pass
    finally:
        process.kill()
        process.join()
    return answer


def _first(answers: Queue, process: BaseProcess, limit: float) -> Answer:
    """Wait for the answer until the limit or until the process is dead; queue.Empty if there is none."""
    end = time.perf_counter() + limit
    while process.is_alive() and time.perf_counter() < end:
        try:
            return answers.get(timeout=0.1)
        except queue.Empty:
            continue
    return answers.get(timeout=0.1)


def _work(answers: Queue, peer: Peer, instance: Instance) -> None:
    """Answer as the child of `run`."""
    with silenced():
        try:
            answers.put(peer.solve(instance))
        except Exception as error:
            answers.put(Answer(x=None, claim=Claim.NOTHING, says=f"{type(error).__name__}: {error}"))


@contextmanager
def silenced() -> Iterator[None]:
    """Let nothing appear of what is written to the standard streams, by compiled code too."""
    kept = {stream: os.dup(stream) for stream in (1, 2)}
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in kept:
        os.dup2(nowhere, stream)
    try:
        yield
    finally:
        ctypes.CDLL(None).fflush(None)  # what C has not written yet
        for stream, copy in kept.items():
            os.dup2(copy, stream)
            os.close(copy)
        os.close(nowhere)


def _read(says: str, *, optimal: str) -> Claim:
    """The claim in a solver's own words; `optimal` is what it says when it has one."""
    words = says.lower()
    if "unbounded" in words or "diverging" in words:
        return Claim.UNBOUNDED
    if "infeasib" in words or "incompatible" in words:
        return Claim.INFEASIBLE
    return Claim.OPTIMAL if says.startswith(optimal) else Claim.NOTHING


def _sparse(casadi: ModuleType, matrix: Array) -> object:
    """A matrix of CasADi without the zeros."""
    return casadi.sparsify(casadi.DM(matrix))
