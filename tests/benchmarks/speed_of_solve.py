"""A whole direct solve, by stages."""

from collections.abc import Callable
from functools import partial

from speed_cylinder import MODEL, assembled_by, codes, cylinder
from speed_page import Section, Settings, Table
from timing import Turns, in_turns, ratio

import bemcontact

REFINE = (1, 2, 4, 8, 16)
ROUNDS = 12
STAGES = ("mesh", "solution", "recovery", "assessment")

TEXT = """\
`bemcontact.solve` with the direct solver, for the cylinder of the paper that is read already: its variant `stated
mesh` with each element cut into equal parts, and the problem as it stands, for which a mesh is searched (accuracy
1 %). The stages are those that a result reports: *mesh* is the condensation, with the search for a mesh if there is
one. They are wall times.
"""


def solves(problem: bemcontact.Problem, rounds: int) -> tuple[dict[str, list[bemcontact.Result]], dict[str, Turns]]:
    """Results of several solves with each code, and their times."""
    results = {code: [] for code in codes()}

    def once_more(code: str) -> None:
        with assembled_by(code):
            results[code].append(bemcontact.solve(problem))

    return results, in_turns({code: partial(once_more, code) for code in results}, rounds)


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Measure all sizes."""
    rows, raw = [], {}
    problems = {
        f"stated mesh, cut into {refine}": cylinder(refine) for refine in REFINE[: 2 if settings.quick else None]
    }
    problems["mesh found"] = bemcontact.load(MODEL)
    for name, problem in problems.items():
        say(name)
        results, turns = solves(problem, 3 if settings.quick else ROUNDS)
        for code, its in results.items():
            cpu, base = turns[code].cpu, turns["NumPy"].cpu
            stages = [min(result.seconds.get(stage, 0.0) for result in its) for stage in STAGES]
            milliseconds = [1e3 * seconds for seconds in (min(cpu), *stages)]
            sizes = [its[0].degrees_of_freedom, len(its[0].contact.points)]
            rows.append([name, *sizes, code, milliseconds[0], ratio(cpu, base), *milliseconds[1:]])
            raw[f"{name}, {code}"] = {**vars(turns[code]), **dict(zip(STAGES, stages, strict=True))}
    columns = {
        "Mesh": "",
        "N": "d",
        "n": "d",
        "Code": "",
        "CPU, ms": ".1f",
        "over NumPy": ".2f",
        **{f"{stage}, ms": ".1f" for stage in STAGES},
    }
    return Section(title="A whole solve", text=TEXT, tables=[Table(columns=columns, rows=rows)], raw=raw)
