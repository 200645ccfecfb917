"""A whole direct solve, by stages."""

from collections.abc import Callable
from dataclasses import dataclass, field

from speed_cylinder import MODEL, assembled_by, codes, cylinder
from speed_page import Section, Settings, Table
from timing import Seconds, least, seconds_of

import bemcontact

REFINE = (1, 2, 4, 8, 16)
ROUNDS = 12
STAGES = ("mesh", "solution", "recovery", "assessment")

TEXT = """\
`bemcontact.solve` with the direct solver, for the cylinder of the paper that is read already: its variant `stated
mesh` with each element cut into equal parts, and the problem as it stands, for which a mesh is searched (accuracy
1 %). The stages are those that a result reports: *mesh* is the condensation, with the search for a mesh if there is
one. They are the least wall times of several runs.
"""


@dataclass(kw_only=True, eq=False)
class Solves:
    """Solves of one problem with one code: the results, and how long each took."""

    results: list[bemcontact.Result] = field(default_factory=list)
    runs: list[Seconds] = field(default_factory=list)

    def once_more(self, problem: bemcontact.Problem) -> None:
        """Solve again."""
        self.runs.append(seconds_of(lambda: self.results.append(bemcontact.solve(problem))))

    def stage(self, name: str) -> float:
        """Least wall time of a stage [s]."""
        return min(result.seconds.get(name, 0.0) for result in self.results)


def solves(problem: bemcontact.Problem, rounds: int) -> dict[str, Solves]:
    """Several solves with each code, in turns."""
    done = {code: Solves() for code in codes()}
    for _ in range(rounds):
        for code, its in done.items():
            with assembled_by(code):
                its.once_more(problem)
    return done


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Measure all sizes."""
    rows, raw = [], {}
    problems = {
        f"stated mesh, cut into {refine}": cylinder(refine) for refine in REFINE[: 2 if settings.quick else None]
    }
    problems["mesh found"] = bemcontact.load(MODEL)
    for name, problem in problems.items():
        say(name)
        for code, its in solves(problem, 3 if settings.quick else ROUNDS).items():
            result, taken = its.results[0], least(its.runs)
            stages = {stage: its.stage(stage) for stage in STAGES}
            milliseconds = [1e3 * item for item in (taken.cpu, *stages.values())]
            rows.append([name, result.degrees_of_freedom, len(result.contact.points), code, *milliseconds])
            raw[f"{name}, {code}"] = {**vars(taken), **stages}
    columns = {
        "Mesh": "",
        "N": "d",
        "n": "d",
        "Code": "",
        "CPU, ms": ".1f",
        **{f"{stage}, ms": ".1f" for stage in STAGES},
    }
    return Section(title="A whole solve", text=TEXT, tables=[Table(columns=columns, rows=rows)], raw=raw)
