"""A whole solve against finite elements of scikit-fem at an equal error of the pressure in the L2 norm."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import boundary_elements_pressed as boundary_elements
import finite_elements_pressed as finite_elements
from finite_elements_pressed import Pressed
from pressure_error import Pressure, relative_error
from speed_cylinder import assembled_by, codes
from speed_page import Section, Settings, Table, Target
from timing import Spread, in_turns, one_turn, ratio

import bemcontact
from bemcontact.bem.condense import condensed
from bemcontact.formulations.complementarity import solve as solve_directly

LEVELS = (0.01, 0.003, 0.002, 0.0015)
"""Errors at which times are compared."""
FINEST = 0.04
"""Size of the triangles of the reference."""
FIRST = 0.25
"""Size of the uniform triangles that find the end of contact."""
UNIFORM = (0.5, 0.35, 0.25, 0.18, 0.14, 0.11, 0.085, 0.065, 0.05, 0.04, 0.031, 0.024)
GRADED = (0.7, 0.56, 0.45, 0.36, 0.29, 0.23, 0.18, 0.15, 0.12)
UNIFORM_ELEMENTS = (3, 5, 8, 12, 18, 25, 40, 60, 90, 130)
GRADED_ELEMENTS = (2, 3, 4, 5, 6, 8, 10, 12, 16)
ACCURACIES = (0.05, 0.01, 0.005, 0.002, 0.001)
BEST_ACCURACY = 5e-4
"""Of the solution that is compared with the reference."""

BODIES = {
    "cylinder": (finite_elements.CYLINDER, boundary_elements.cylinder),
    "block": (finite_elements.BLOCK, boundary_elements.block),
}
EQUAL_WORK = ", equal work"
"""What is added to families of which only that is timed which is timed of finite elements."""
PAIRS = {
    "stated, uniform": ("triangles, uniform", "elements, uniform"),
    "stated, uniform, equal work": ("triangles, uniform", f"elements, uniform{EQUAL_WORK}"),
    "stated, end of contact known": ("triangles, graded", "elements, graded"),
    "end of contact found": ("triangles, two passes", "mesh found"),
}
"""What both know beforehand -> names of the meshes of finite elements and of boundary elements."""
SPEED = {0.01: 5.0, 0.002: 15.0}
"""How many times faster than scikit-fem the cylinder should be, by error."""
TURNS, LEAST_TURNS, ENOUGH = 25, 3, 15.0
"""Most and least turns of two meshes that are compared, and the seconds after which those are enough."""
UNKNOWNS = 100
"""With how many unknowns the cylinder should have 1 %."""

TEXT = """\
The pressure is compared over the contact zone in the L2 norm, with the end of contact, as each program reports it:
quadratic on each element. The *cylinder* is that of the paper. The *block* is not in the paper: half-width 10,
height 12, a flat face up to x = 4, a fillet of radius 6 up to 45°, a chamfer from there to its side, E = 1000,
ν = 0.3, pressed by 60.

Finite elements are quadratic triangles of scikit-fem, bisected locally: as small as wanted in the contact zone,
larger with the distance from it. The matrix is factorized by SuperLU of SciPy and condensed to the contact, which
an active set solves. Two ways to recover the pressure are tried (in balance with the nodal forces, and as slope of
a spline through their sum), and the better one counts. *Without smoothing* is the first. Set-up, factorization,
condensation and contact are timed, not the making of the mesh.

Of this program the whole `bemcontact.solve` is timed with its checks, for a problem that is read, by {code}.

- *uniform*: elements of one size wherever contact may be;
- *equal work*: of this program too, set-up, factorization, condensation and contact alone, and no checks. Loads, gaps
  and contact points belong to the set-up of both. Here the making of the mesh does too; it takes 0.1 to 0.2 ms;
- *graded*: the end of contact is known, elements get smaller towards it, and two meet there;
- *two passes*: finite elements on a uniform mesh find the end, and the graded mesh follows;
- *mesh found*: this program searches for its mesh, the search included.

Meshes of both programs that are compared run in turns, up to {turns} times each, so that what slows the machine for a
while slows both. The ratio is the median of those of neighboring turns. The quartiles are in parentheses: half of the
ratios are between them.

Finite elements take the bilinear form of linear elasticity from scikit-fem. Written out by components it is assembled
faster: the uniform mesh that reaches 1 % for the cylinder then takes five sixths of the time.

The reference is the finest graded mesh of finite elements. A mesh that this program finds, with an accuracy of
0.05 %, checks it. A family of meshes has reached an error with the first mesh from which on all finer ones have it.
"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Attempt:
    """A mesh of a family.

    Parameters
    ----------
    family, setting : label
    run : solves on it, once
    judge : number of unknowns of what `run` returned, its error, and that of the pressure as it is
    """

    family: str
    setting: float
    run: Callable[[], object]
    judge: Callable[[object], tuple[int, float, float]]


@dataclass(frozen=True, kw_only=True)
class Point:
    """What a mesh of a family costs: unknowns, CPU seconds, its error, and that of the pressure without smoothing."""

    family: str
    setting: float
    unknowns: int
    seconds: float
    error: float
    plain: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison:
    """Both programs on one body."""

    body: Pressed
    state: Callable[..., bemcontact.Problem]
    reference: Pressure
    end: float
    unknowns: int
    checked: float
    """Difference of the reference from the finest solution of this program."""
    points: list[Point] = field(default_factory=list)
    ratios: dict[tuple[Point, Point], Spread] = field(default_factory=dict)
    """Those of meshes that reach the same error."""

    def error(self, pressure: Pressure) -> float:
        """Relative error in the L2 norm."""
        return relative_error(pressure, self.reference, self.body.rate)

    def attempts(self, quick: bool) -> list[Attempt]:
        """All meshes of all families."""
        some = slice(None, None, 3) if quick else slice(None)
        body, end = self.body, self.end
        few = slice(0, 6 if quick else None)
        listed = [
            self._by_finite_elements("triangles, uniform", size, [body.uniform(size)]) for size in UNIFORM[few][some]
        ]
        for size in GRADED[some]:
            listed.append(self._by_finite_elements("triangles, graded", size, [body.graded(size, end)]))
            first = body.uniform(FIRST)
            second = body.graded(size, float(body.solve(first).ends()[1]))
            listed.append(self._by_finite_elements("triangles, two passes", size, [first, second]))
        for count in UNIFORM_ELEMENTS[few][some]:
            listed.append(self._by_boundary_elements("elements, uniform", count, self.state(count)))
            listed.append(self._by_equal_work(listed[-1], self.state(count)))
        for count in GRADED_ELEMENTS[some]:
            listed.append(self._by_boundary_elements("elements, graded", count, self.state(count, end)))
        anew = self.state(8)
        for accuracy in ACCURACIES[some]:
            listed.append(self._by_boundary_elements("mesh found", accuracy, anew.to_be_meshed(accuracy)))
        return listed

    def _by_finite_elements(self, family: str, size: float, meshes: Sequence) -> Attempt:
        def judge(touch: Any) -> tuple[int, float, float]:
            errors = {name: self.error(item) for name, item in finite_elements.reported(touch).items()}
            return 2 * len(touch.nodes), min(errors.values()), errors["nodal"]

        return Attempt(
            family=family, setting=size, run=lambda: [self.body.solve(mesh) for mesh in meshes][-1], judge=judge
        )

    def _by_boundary_elements(self, family: str, setting: float, problem: bemcontact.Problem) -> Attempt:
        def judge(result: Any) -> tuple[int, float, float]:
            error = self.error(boundary_elements.reported(result))
            return result.degrees_of_freedom, error, error

        return Attempt(family=family, setting=setting, run=lambda: bemcontact.solve(problem), judge=judge)

    def _by_equal_work(self, whole: Attempt, problem: bemcontact.Problem) -> Attempt:
        """The same mesh, of which only the set-up, condensation and contact are timed."""
        return Attempt(
            family=f"{whole.family}{EQUAL_WORK}", setting=whole.setting,
            run=lambda: solve_directly(condensed(problem).contact), judge=lambda _: whole.judge(whole.run()),
        )  # fmt: skip

    def measure(self, quick: bool) -> None:
        """Judge all of them and time them once, and then time those that are compared in turns."""
        attempts = self.attempts(quick)
        judged = [attempt.judge(attempt.run()) for attempt in attempts]
        times = in_turns({i: attempt.run for i, attempt in enumerate(attempts)}, 1 if quick else 3)
        self.points[:] = [
            Point(
                family=item.family,
                setting=item.setting,
                unknowns=n,
                seconds=min(times[i].cpu),
                error=error,
                plain=plain,
            )
            for i, (item, (n, error, plain)) in enumerate(zip(attempts, judged, strict=True))
        ]
        runs = {point: attempt.run for point, attempt in zip(self.points, attempts, strict=True)}
        for theirs, ours in compared(self.points):
            if (theirs, ours) not in self.ratios:
                turns = LEAST_TURNS if quick else TURNS
                self.ratios[theirs, ours] = ratio(*neighboring(runs[theirs], runs[ours], turns))


def neighboring(
    theirs: Callable[[], object], ours: Callable[[], object], turns: int
) -> tuple[list[float], list[float]]:
    """CPU seconds of both in turns; fewer turns, if they take long."""
    begin, taken = time.perf_counter(), (list[float](), list[float]())
    while len(taken[0]) < turns and (len(taken[0]) < LEAST_TURNS or time.perf_counter() - begin < ENOUGH):
        for action, times in zip((theirs, ours), taken, strict=True):
            times.append(one_turn(action)[0])
    return taken


def comparison(name: str, quick: bool) -> Comparison:
    """Solve for the reference, and check it."""
    body, state = BODIES[name]
    end = float(body.solve(body.uniform(FIRST / 2)).ends()[1])
    for size in (3 * FINEST, (2 if quick else 1) * FINEST):
        touch = body.solve(body.graded(size, end))
        end = float(touch.ends()[1])
    reference = finite_elements.reported(touch)["smooth"]
    best = bemcontact.solve(state(8).to_be_meshed(BEST_ACCURACY))
    checked = relative_error(boundary_elements.reported(best), reference, body.rate)
    return Comparison(
        body=body, state=state, reference=reference, end=end, unknowns=2 * len(touch.nodes), checked=checked
    )


def reached(points: Sequence[Point], family: str, level: float, *, plain: bool = False) -> Point | None:
    """The first mesh of a family from which on all finer ones have an error of at most the level; None if none has."""
    found = None
    for point in reversed([point for point in points if point.family == family]):
        if (point.plain if plain else point.error) > level:
            break
        found = point
    return found


def both(
    points: Sequence[Point], pair: tuple[str, str], level: float, *, plain: bool = False
) -> tuple[Point, Point] | None:
    """Meshes of finite elements and of boundary elements at an equal error; None if one did not get there."""
    theirs, ours = (reached(points, family, level, plain=plain) for family in pair)
    return (theirs, ours) if theirs and ours else None


def compared(points: Sequence[Point]) -> Iterator[tuple[Point, Point]]:
    """All meshes of both at an equal error."""
    for plain in (False, True):
        found = (both(points, pair, level, plain=plain) for pair in PAIRS.values() for level in LEVELS)
        yield from filter(None, found)


def words(point: Point | None) -> str:
    """Unknowns and time of a mesh."""
    return f"{point.unknowns}, {1e3 * point.seconds:.0f} ms" if point else "not reached"


def tables(name: str, result: Comparison) -> list[Table]:
    """Equal errors, ratios, and all meshes."""
    points, families = result.points, [*dict.fromkeys(family for pair in PAIRS.values() for family in pair)]
    equal = [[f"{100 * level:g} %", *(words(reached(points, item, level)) for item in families)] for level in LEVELS]
    plain = {f"{title}; without smoothing": pair for title, pair in PAIRS.items()}
    ratios = [[f"{100 * level:g} %"] for level in LEVELS]
    for row, level in zip(ratios, LEVELS, strict=True):
        meshes = [both(points, pair, level, plain=smooth) for smooth in (False, True) for pair in PAIRS.values()]
        row += [result.ratios[pair] if pair else None for pair in meshes]
    every = [
        [it.family, f"{it.setting:g}", it.unknowns, 1e3 * it.seconds, 100 * it.error, 100 * it.plain]
        for it in sorted(points, key=lambda it: families.index(it.family))
    ]
    return [
        Table(
            title=f"{name}: unknowns and CPU time to reach an error",
            columns=dict.fromkeys(["Error", *families], ""),
            rows=equal,
        ),
        Table(
            title=f"{name}: time of finite elements over that of this program, at an equal error",
            columns={"Error": "", **dict.fromkeys([*PAIRS, *plain], ".1f")},
            rows=ratios,
        ),
        Table(
            title=f"{name}: all meshes. The reference has {result.unknowns} unknowns; our own check differs from it by "
            f"{100 * result.checked:.2g} %",
            columns={
                "Mesh": "",
                "Size, elements or accuracy": "",
                "Unknowns": "d",
                "CPU, ms": ".1f",
                "Error, %": ".3f",
                "without smoothing, %": ".3f",
            },
            rows=every,
        ),
    ]


def targets(result: Comparison) -> list[Target]:
    """What was asked of the cylinder."""
    points = result.points
    small = reached(points, "elements, graded", 0.01)
    meshes = {(level, title): both(points, pair, level) for level in SPEED for title, pair in PAIRS.items()}
    asked = [
        Target(
            name=f"cylinder to {100 * level:g} %: times as fast as scikit-fem ({title})",
            asked=SPEED[level], at_least=True, measured=result.ratios[pair] if pair else None,
        )
        for (level, title), pair in meshes.items()
    ]  # fmt: skip
    unknowns = small.unknowns if small else None
    return [Target(name="cylinder to 1 %: unknowns (graded)", asked=UNKNOWNS, measured=unknowns), *asked]


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Compare both programs on both bodies."""
    found: list[Table] = []
    asked: list[Target] = []
    raw, code = {}, codes()[-1]
    for name in BODIES:
        say(f"{name}, reference")
        result = comparison(name, settings.quick)
        say(f"{name}, all meshes")
        with assembled_by(code):
            result.measure(settings.quick)
        found += tables(name, result)
        raw[name] = {"reference": result.unknowns, "checked": result.checked, "end": result.end,
                     "points": [vars(point) for point in result.points],
                     "ratios": [[theirs.family, theirs.setting, ours.family, ours.setting, vars(spread)]
                                for (theirs, ours), spread in result.ratios.items()]}  # fmt: skip
        if name == "cylinder":
            asked = targets(result)
    text = TEXT.format(code=code, turns=TURNS)
    return Section(title="Finite elements at an equal error", text=text, tables=found, targets=asked, raw=raw)
