"""Do error bars hold? All problems of `adaptive_problems` and all models, at three accuracies.

Truth is what statics and closed forms give, else a run at 2e-4, allowed its own bar. Run by hand, half an hour:

    python tests/benchmarks/error_bars.py [PATTERN ...]

With --stated, on meshes of 4 to 128 equal elements on the longest edge instead: no bar may be smaller than the error,
and it may be unknown. Truth is then a run at 1e-3.
"""

import sys
import time
from collections.abc import Iterator, Sequence
from math import ceil, radians
from pathlib import Path
from statistics import median

from adaptive_problems import Case, problems

import bemcontact
from bemcontact import Problem
from bemcontact.adaptivity.adapt import Meshed, meshed
from bemcontact.assessment.accuracy import ErrorBar

ACCURACIES = 1e-2, 3e-3, 1e-3
TRUTH = 2e-4
STATED = 4, 8, 12, 16, 24, 32, 48, 64, 96, 128
MODELS = Path(bemcontact.__file__).parent.parent / "models"


def every() -> Iterator[tuple[str, Case]]:
    """All problems by name."""
    yield from problems()
    for path in sorted(MODELS.rglob("*.yaml")):
        yield path.stem, (bemcontact.load(path), {})


def errors(found: Meshed, truth: Meshed | None, case: Case) -> Iterator[tuple[ErrorBar, float]]:
    """Error bars with the true errors beyond the error of the truth, relative as the bars are."""
    for number, accuracy in enumerate(found.accuracies):
        reference = () if truth is None else truth.accuracies[number].bars
        lengths = {
            (bar.zone, bar.interval): abs(bar.value - other.value)
            for bar in reference for other in reference
            if bar.quantity == "end" and other.quantity == "start" and bar.value is not None and other.value is not None
            and (bar.zone, bar.interval) == (other.zone, other.interval)
        }  # fmt: skip
        place = 0
        for bar in accuracy.bars:
            place += bar.quantity == "intensity"
            if bar.value is None or bar.bar is None:
                continue
            known = case[1].get((bar.quantity, bar.zone)) if number == 0 else None
            if known is not None:
                yield bar, max(0.0, abs(bar.value - known[0]) / abs(known[0]) - known[1])
                continue
            alike = [
                other for other in reference
                if (other.quantity, other.zone, other.interval, other.mover)
                == (bar.quantity, bar.zone, bar.interval, bar.mover)
                and other.value is not None and other.bar is not None
            ]  # fmt: skip
            if bar.quantity == "intensity":
                alike = alike[:1] if len(alike) == 1 else []
            if not alike or not alike[0].value:
                continue
            scale = lengths.get((bar.zone, bar.interval), abs(bar.value))
            allowed = alike[0].bar * lengths.get((bar.zone, bar.interval), abs(alike[0].value))
            yield bar, max(0.0, abs(bar.value - alike[0].value) - allowed) / scale


def stated(problem: Problem, elements: int) -> Problem:
    """The problem on a mesh of equal elements, with the most on the longest edge, and at least two on each."""
    data = problem.model_dump(exclude={"variants"})
    longest = max(edge.length for edge in problem.boundary.edges)
    specs = (data["boundary"]["outer"], *data["boundary"]["holes"])
    for loop, edges in zip(specs, problem.boundary.loops, strict=True):
        for spec, edge in zip(loop, edges, strict=True):
            least = ceil(abs(getattr(edge.curve, "sweep", 0.0)) / radians(45))
            spec.update(elements=max(2, round(elements * edge.length / longest), least), grading=None, ends_at=())
    return Problem(**{**data, "accuracy": 0.01, "mesh": {"adapt": False}})


def on_stated_meshes(patterns: Sequence[str]) -> None:
    """Print each bar of a stated mesh that is smaller than the error, and how many bars are known and unknown."""
    known = unknown = wrong = 0
    for name, case in every():
        if patterns and not any(pattern in name for pattern in patterns):
            continue
        truth = meshed(case[0].with_value("accuracy", 1e-3))
        for elements in STATED:
            found = meshed(stated(case[0], elements))
            unknown += sum(bar.bar is None for accuracy in found.accuracies for bar in accuracy.bars)
            for bar, error in errors(found, truth, case):
                known += 1
                if bar.bar is not None and error > bar.bar + 1e-9:
                    wrong += 1
                    print(
                        f"{name} {elements}: {bar.quantity} {bar.zone}: error {error:.2e}, bar {bar.bar:.2e}",
                        flush=True,
                    )
    print(f"{known} bars known, {unknown} unknown, {wrong} too small")


def main(patterns: Sequence[str]) -> None:
    """Print a row a problem, and the sums."""
    if "--stated" in patterns:
        on_stated_meshes([pattern for pattern in patterns if pattern != "--stated"])
        return
    rows: dict[float, list[tuple[bool, int, int, float]]] = {accuracy: [] for accuracy in ACCURACIES}
    ratios: dict[float, list[float]] = {accuracy: [] for accuracy in ACCURACIES}
    for name, case in every():
        if patterns and not any(pattern in name for pattern in patterns):
            continue
        try:
            truth = meshed(case[0].with_value("accuracy", TRUTH))
        except bemcontact.BemContactError as error:
            print(f"{name}: {error}")
            continue
        for asked in ACCURACIES:
            begin = time.process_time()
            found = meshed(case[0].with_value("accuracy", asked))
            seconds = time.process_time() - begin
            alone = found.problem.model_copy(update={"accuracy": None})
            begin = time.process_time()
            bemcontact.solve_cases(alone) if alone.case_names else bemcontact.solve(alone)
            one = time.process_time() - begin
            unknowns = found.condensation.body.mesh.degrees_of_freedom
            met, passes = all(item.met for item in found.accuracies), found.accuracies[0].passes
            rows[asked].append((met, passes, unknowns, seconds / one))
            told = [*errors(found, truth, case)]
            ratios[asked] += [bar.bar / error for bar, error in told if bar.bar and error > 1e-12]
            wrong = [(bar, error) for bar, error in told if bar.bar is not None and error > bar.bar + 1e-9]
            print(
                f"{name:32} {asked:g} {'met' if met else 'NOT'} {passes} {unknowns} {seconds / one:.1f} {len(told)}",
                flush=True,
            )
            for bar, error in wrong:
                print(
                    f"    VIOLATION {bar.quantity} {bar.zone} {bar.interval}: error {error:.2e}, bar {bar.bar:.2e}",
                    flush=True,
                )
    for asked, own in rows.items():
        if own:
            print(
                f"{asked:g}: met {sum(row[0] for row in own)} of {len(own)}, passes {median(row[1] for row in own)}, "
                f"unknowns {median(row[2] for row in own)}, cost {median(row[3] for row in own):.1f}, "
                f"bar over error {median(ratios[asked] or [0]):.1f}"
            )


if __name__ == "__main__":
    main(sys.argv[1:])
