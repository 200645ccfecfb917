"""Quadratic programs to be solved by any solver: read from a folder, or made here with an answer known beforehand."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import StiffnessRows
from bemcontact.formulations import complementarity
from bemcontact.formulations.scaling import scale

Array = NDArray[np.float64]

MODULI = (1e3, 2e6)
"""Young's moduli of the half-planes, in raw units: u_n is about 1e-1, p about 1e2 and 2e5."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Instance:
    """Minimise constant + cᵀx + ½xᵀHx subject to bl <= x <= bu, cl <= A x <= cu.

    Parameters
    ----------
    name, group : labels
    H : (n, n) symmetric
    c, bl, bu : (n,), bounds may be infinite
    A : (m, n)
    cl, cu : (m,), may be infinite
    constant : of the objective
    best : best known objective, or nan
    expected : what a solver should say: "optimal", "infeasible" or "unbounded"
    truth : blocks of the only right x in the order of x, or none if no such thing is known
    unit : typical size of the objective
    """

    name: str
    group: str
    H: Array
    c: Array
    A: Array
    cl: Array
    cu: Array
    bl: Array
    bu: Array
    constant: float = 0.0
    best: float = np.nan
    expected: str = "optimal"
    truth: tuple[Array, ...] = ()
    unit: float = 1.0

    def gradient(self, x: Array) -> Array:
        """H x + c, (n,)."""
        return self.H @ x + self.c

    def objective(self, x: Array) -> float:
        """Constant + cᵀx + ½xᵀHx."""
        return float(self.constant + self.c @ x + x @ self.H @ x / 2)

    @cached_property
    def sizes(self) -> Array:
        """Typical size of each unknown, (n,): the largest entry of its block of the truth, or 1."""
        blocks = self.truth or (np.ones_like(self.c),)
        return np.concatenate([np.full_like(block, np.abs(block).max()) for block in blocks])

    @cached_property
    def dimensionless(self) -> "Instance":
        """The same program in x over `sizes` and the objective over `unit`, each row over its largest entry."""
        D, A = self.sizes, self.A * self.sizes
        rows = np.abs(A).max(axis=1, initial=0.0) if self.truth else np.ones(len(A))
        return replace(
            self, H=D[:, None] * self.H * D / self.unit, c=D * self.c / self.unit, A=A / rows[:, None],
            cl=self.cl / rows, cu=self.cu / rows, bl=self.bl / D, bu=self.bu / D, constant=self.constant / self.unit,
            best=self.best / self.unit, truth=(), unit=1.0,
        )  # fmt: skip


def stated(
    name: str, group: str, H: ArrayLike, c: ArrayLike, rows: tuple = (), bounds: tuple = (0, np.inf), *,
    expected: str = "optimal",
) -> Instance:  # fmt: skip
    """A small instance written down by hand: `rows` is (A, cl, cu), `bounds` (bl, bu) of one value each or of n."""
    n = np.size(c)
    A, cl, cu = rows or (np.zeros((0, n)), np.zeros(0), np.zeros(0))
    bl, bu = (np.broadcast_to(np.asarray(bound, float), n).copy() for bound in bounds)
    return Instance(
        name=name, group=group, H=np.array(H, float), c=np.array(c, float), A=np.array(A, float, ndmin=2),
        cl=np.array(cl, float, ndmin=1), cu=np.array(cu, float, ndmin=1), bl=bl, bu=bu, expected=expected,
    )  # fmt: skip


def read(path: Path) -> Instance | None:
    """One file: H as triplets Hi, Hj, Hv (all of it), A as Ai, Aj, Av; None if it states something else than a QP."""
    with np.load(path, allow_pickle=False) as data:
        if "Hi" not in data:
            return None
        n, m = int(data["n"]), int(data["m"])
        H, A = np.zeros((n, n)), np.zeros((m, n))
        H[data["Hi"], data["Hj"]] = data["Hv"]
        A[data["Ai"], data["Aj"]] = data["Av"]
        return Instance(
            name=str(data["name"]), group=str(data["group"]), H=H, c=data["c"], A=A, cl=data["cl"], cu=data["cu"],
            bl=data["bl"], bu=data["bu"], constant=float(data["const"]), best=float(data["best"]),
            expected=str(data["status"]),
        )  # fmt: skip


def read_folder(folder: Path) -> Iterator[Instance]:
    """Every quadratic program of a folder, by name."""
    paths = sorted(folder.glob("*.npz"))
    if not paths:
        raise SystemExit(f"{folder}: holds no .npz file; give a folder of instances")
    yield from filter(None, map(read, paths))


def status_instances() -> Iterator[Instance]:
    """Programs without a minimizer, of which a proof fits in one line."""
    free, quadrant = (-np.inf, np.inf), (0, np.inf)
    contradiction = ([[1, 1], [1, 1]], [2, -np.inf], [np.inf, 1])
    yield stated("x + y >= 2 and <= 1", "status", np.eye(2), [0, 0], contradiction, quadrant, expected="infeasible")
    yield stated("x <= -1, x >= 0", "status", [[0]], [1], ([[1]], [-np.inf], [-1]), quadrant, expected="infeasible")
    yield stated("a linear ray", "status", np.diag([1, 0]), [0, -1], (), quadrant, expected="unbounded")
    yield stated("saddle of diag(1, -1)", "status", np.diag([1, -1]), [0, 0], (), free, expected="unbounded")
    yield stated("dead point of -xy", "status", [[0, -1], [-1, 0]], [0, 0], (), quadrant, expected="unbounded")


def half_plane(n: int, modulus: float, seed: int) -> CondensedContact:
    """Strips of constant pressure on an elastic half-plane, of random widths, under a random smooth rigid profile.

    u(x) = -2/(πE) Σ p_k ∫ ln|x - s|/L ds with L = 40, ten times the half-length: far enough for M to be positive
    definite on any sum of pressures. The profile is sunk by a tenth, so that there is contact.
    """
    rng = np.random.default_rng(seed)
    edges = np.append(0, np.cumsum(rng.uniform(0.5, 1.5, n)))
    edges = 8 * edges / edges[-1] - 4
    middle, width = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    left, right = (middle[:, None] - end for end in (edges[:-1], edges[1:]))
    compliance = -2 / (np.pi * modulus) * (left * np.log(np.abs(left)) - right * np.log(np.abs(right)) - width)
    compliance += 2 / (np.pi * modulus) * np.log(40) * width
    waves = sum(a * np.cos(k * middle + b) for k, (a, b) in enumerate(rng.uniform(0, [0.05, 6.28], (4, 2))))
    gap = middle**2 / 16 + waves
    return CondensedContact.from_compliance(compliance, gap - gap.min() - 0.1, width)


def without_units(contact: CondensedContact) -> CondensedContact:
    """The same problem of a body held without contact, in dimensionless numbers."""
    scaled = scale(contact)
    return CondensedContact.from_compliance(scaled.compliance, scaled.offset, scaled.weights)


def compliance_rows(contact: CondensedContact) -> StiffnessRows:
    """(12) for a body held without contact, as u_n = M p + Δ1, in the units of the user."""
    return StiffnessRows(np.eye(contact.size), contact.compliance, contact.free_displacement)


def qp1(contact: CondensedContact, rows: StiffnessRows) -> Instance:
    """(27)-(29) over x = (u_n, p): min pᵀJ(ε + u_n), K u_n = B p + r, ε + u_n >= 0, p >= 0."""
    n, J = contact.size, np.diag(contact.weights)
    zero, truth = np.zeros((n, n)), _truth(contact)
    displacement, pressure = (float(np.abs(block).max()) for block in truth)
    return Instance(
        name=f"QP1 n={n}", group="contact", H=np.block([[zero, J], [J, zero]]),
        c=np.append(np.zeros(n), J @ contact.initial_gap), A=np.hstack([rows.K, -rows.B]), cl=rows.r, cu=rows.r,
        bl=np.append(-contact.initial_gap, np.zeros(n)), bu=np.full(2 * n, np.inf), best=0.0, truth=truth,
        unit=displacement * pressure * float(contact.weights.max()),
    )  # fmt: skip


def qp2(contact: CondensedContact, rows: StiffnessRows, penalty: float = 1.0) -> Instance:
    """(30)-(34) over x = (u_n, p): min pᵀJ(ε + u_n) + |K u_n - B p - r|²/μ, ε + u_n >= 0, p >= 0."""
    first = qp1(contact, rows)
    n = contact.size
    return Instance(
        name=f"QP2 n={n}", group="contact", H=first.H + 2 / penalty * first.A.T @ first.A,
        c=first.c - 2 / penalty * first.A.T @ rows.r, A=np.zeros((0, 2 * n)), cl=np.zeros(0), cu=np.zeros(0),
        bl=first.bl, bu=first.bu, constant=float(rows.r @ rows.r) / penalty, best=0.0, truth=first.truth,
        unit=first.unit,
    )  # fmt: skip


def contact_instances(sizes: list[int], seeds: int) -> Iterator[Instance]:
    """QP1 and QP2 of random half-planes: in raw units with compliance rows, and scaled with stiffness rows."""
    for n in sizes:
        for modulus in MODULI:
            for seed in range(seeds):
                contact = half_plane(n, modulus, seed)
                same = without_units(contact)
                for statement in (qp1, qp2):
                    raw = statement(contact, compliance_rows(contact))
                    name = f"{raw.name} E={modulus:g} seed {seed}"
                    yield replace(raw, name=name)
                    yield replace(statement(same, same.stiffness_rows), name=name, group="scaled contact")


def _truth(contact: CondensedContact) -> tuple[Array, Array]:
    """u_n and p by the direct solver, refused unless min(p/T, δ/U) vanishes to 1e-12 and JM > 0 makes them unique."""
    solution = complementarity.solve(contact)
    scales = contact.scales
    gap = contact.gap(solution.pressure, solution.rigid_amplitudes)
    residual = np.abs(np.minimum(solution.pressure / scales.pressure, gap / scales.displacement)).max()
    S = contact.weights[:, None] * contact.compliance
    if not (residual <= 1e-12 and np.linalg.eigvalsh(S + S.T)[0] > 0):
        raise SystemExit(f"{contact.size} contact points: no reference solution (off by {residual:.1e}), or not unique")
    return solution.displacement, solution.pressure
