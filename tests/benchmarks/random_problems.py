"""Random contact problems, each stated in several ways that must have the same answer.

    python tests/benchmarks/random_problems.py [--seed 1] [--count 100] [--kind KIND ...] [--out FOLDER] [--limit 120]

A problem is solved as it is, turned, mirrored, shifted, in other units, as one of several load cases, as the end of a
path, in another order, with edges cut in two, with a quarter of the accuracy, and where this can be with its sides
exchanged, or as a whole instead of its half. What does not hold as it is, is solved in fewer ways. A disagreement is
printed, and its specs are written to the folder:

WRONG      both answers are certified and met, and differ by more than their bars; or forces do not balance
TRACEBACK  another error than those of the package, or a warning
DIFFERS    one is refused, not certified or not met, and another one not; or, turned, mirrored or in other units, values
           differ by more than 1e-5 within their bars
SLOW       more than the limit of seconds for one answer
"""

import argparse
import json
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from random_specs import KINDS, Draw, Spec
from spec_changes import UNITS, Change, cut, exchanged, in_a_case, reordered, turns_freely, whole

import bemcontact
from bemcontact import Problem, Result
from bemcontact.assessment.accuracy import Accuracy
from bemcontact.spec.yaml_1_2 import to_yaml

ROUND_OFF = 1e-5
"""Relative difference of answers to the same problem in other words."""
SCALES = {"peak": (1, 0), "pressure": (1, 0), "force": (1, 1), "length": (0, 1), "displacement": (0, 1)}
"""Powers of stress and length in the unit of a quantity."""
Vector = np.ndarray


class TooSlowError(BaseException):
    """An answer took too long."""


@dataclass(frozen=True, kw_only=True)
class Answer:
    """How a problem ended; values in the units and axes of the problem as drawn."""

    ending: str
    """Answered, refused, TRACEBACK or SLOW."""
    seconds: float
    text: str = ""
    holds: tuple[bool, bool] = (False, False)
    """Whether it is certified, and meets the accuracy asked."""
    bars: dict[tuple[str, str], list[tuple[float, float]]] = field(default_factory=dict)
    """Values with their absolute error bars by quantity and zone, in ascending order; infinite where not known."""
    forces: dict[str, Vector] = field(default_factory=dict)
    """Force of each zone."""
    unbalanced: str = ""

    @property
    def verdict(self) -> str:
        """The ending in short."""
        words = [word for word, true in zip(("certified", "met"), self.holds, strict=True) if not true]
        return self.ending if self.ending != "answered" else " and ".join(f"not {w}" for w in words) or "holds"


def values(accuracy: Accuracy, change: Change) -> dict[tuple[str, str], list[tuple[float, float]]]:
    """Values with their error bars, in the units of the problem as drawn."""
    found: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for bar in accuracy.bars:
        if bar.quantity in SCALES and bar.value is not None:
            p, s = SCALES[bar.quantity]
            value = abs(bar.value) / change.stress**p / change.length**s
            error = np.inf if bar.bar is None else bar.bar * value
            found.setdefault((bar.quantity, bar.zone or ""), []).append((value, error))
    return {key: sorted(items) for key, items in found.items()}


def unbalanced(result: Result) -> str:
    """Which body has forces on its boundary and volume that do not sum to zero; empty if none."""
    problem, state = result.problem, result.boundary
    assert problem is not None
    assert state is not None
    x, t = state.points, state.traction
    slope = np.stack([-1.5 * x[:, 0] + 2 * x[:, 1] - 0.5 * x[:, 2], (x[:, 2] - x[:, 0]) / 2,
                      0.5 * x[:, 0] - 2 * x[:, 1] + 1.5 * x[:, 2]], axis=1)  # fmt: skip
    simpson = np.array([1, 4, 1]) / 3
    owners = np.array([name.rpartition("/")[0] for name in state.edge_names])[state.edge]
    for body in dict.fromkeys(owners):
        own = owners == body
        force = t[own] * (np.hypot(*np.moveaxis(slope[own], 2, 0)) * simpson)[..., None]
        turn = (x[own, :, 0] * slope[own, :, 1] - x[own, :, 1] * slope[own, :, 0]) * simpson / 2
        gravity = (problem.bodies[body].loads if body else problem.loads).gravity
        weight = turn.sum() * gravity.density * np.array(gravity.acceleration) if gravity else np.zeros(2)
        size = np.abs(force).sum() + np.abs(weight).sum()
        rest = force.sum(axis=(0, 1)) + weight
        if np.abs(rest).max() > max(result.accuracy.asked or 0, 1e-2) * size:
            return f"forces on {body or 'the body'} sum to {rest}, of {size:.4g}"
    return ""


def solved(spec: Spec, change: Change, case: str | None, times: float) -> Answer:
    """Solve a spec, or one of its load cases together with the others."""
    problem = Problem(**spec)
    result = bemcontact.solve_cases(problem).results[case] if case else bemcontact.solve(problem)
    back = np.linalg.inv(change.matrix) / change.stress / change.length
    forces = {zone: back @ np.array(force) * times for zone, force in result.forces.items()}
    bars = values(result.accuracy, change)
    for key in bars if times != 1 else ():
        bars[key] = [(v * times, e * times) for v, e in bars[key]] if key[0] == "force" else bars[key]
    met, rest = bool(result.accuracy.met), "" if case else unbalanced(result)
    return Answer(ending="answered", seconds=0, text=result.words, bars=bars, forces=forces, unbalanced=rest,
                  holds=(result.certified, met))  # fmt: skip


def followed(spec: Spec) -> Answer:
    """The end of a path to the whole load."""
    path = bemcontact.follow(Problem(**spec), "load_cases.own", to=1.0, start=0.5)
    zones = path.contact.zone_names
    forces = {zone: np.array(force) for zone, force in zip(zones, path.states[-1].resultant, strict=True)}
    told = values(path.end_accuracy, Change())
    bars = {key: items for key, items in told.items() if key[0] != "displacement"}
    return Answer(ending="answered", seconds=0, text=" ".join(path.notes), bars=bars, forces=forces,
                  holds=(path.certified, bool(path.end_accuracy.met)))  # fmt: skip


def timed(action: Callable[[], Answer], limit: float) -> Answer:
    """Carry out an action; whatever it raises is an answer."""
    begin = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, limit)
    try:
        answer = action()
    except bemcontact.BemContactError as error:
        answer = Answer(ending="refused", seconds=0, text=f"{type(error).__name__}: {error}")
    except TooSlowError:
        answer = Answer(ending="SLOW", seconds=0, text=f"more than {limit:g} s")
    except Exception:  # each is a mistake of ours
        answer = Answer(ending="TRACEBACK", seconds=0, text=traceback.format_exc())
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    return Answer(**{**vars(answer), "seconds": time.process_time() - begin})


def variants(spec: Spec, draw: Draw) -> Iterator[tuple[str, Spec, Callable[[], Answer], bool]]:
    """Names, specs and actions of all statements of a problem, and whether they agree to round-off with the first."""

    def plain(name: str, spec: Spec, change: Change | None = None, case: str | None = None, times: float = 1.0):
        of = change or Change()
        return name, spec, lambda: solved(spec, of, case, times), change is not None

    yield plain("as it is", spec)
    angle = draw.number(1, 359) if turns_freely(spec) else draw.choice([90, 180, 270])
    changes = {f"turned by {angle}": Change(angle=angle), "mirrored": Change(mirror=True)}
    changes["shifted"] = Change(shift=(draw.number(-3e3, 3e3), draw.number(-3e3, 3e3)))
    for name, (length, stress, labels) in UNITS.items():
        changes[name] = Change(length=length, stress=stress, units=labels)
    for name, change in changes.items():
        yield plain(name, change(spec), change)
    if of_case := in_a_case(spec):
        yield plain("load case", of_case, case="own")
        yield "path", of_case, lambda: followed(of_case), False
    yield plain("reordered", reordered(spec))
    if "bonded" not in spec:
        yield plain("cut", cut(spec))
    if "contacts" in spec:
        yield plain("exchanged", exchanged(spec))
    if spec["name"] == "half":
        yield plain("whole", whole(spec), times=0.5)
    yield plain("finer", {**spec, "accuracy": spec.get("accuracy", 0.01) / 4})


def disagreements(one: Answer, other: Answer, name: str, exact: bool) -> Iterator[str]:
    """What differs between the first statement and another one."""
    if other.ending.isupper():
        yield f"{other.ending} {name}: {other.text.strip().splitlines()[-1]}"
        return
    if other.unbalanced:
        yield f"WRONG {name}: {other.unbalanced}"
    if one.ending.isupper():
        return
    if one.verdict != other.verdict and not (name == "finer" and other.verdict == "not met"):
        yield f"DIFFERS {name}: {other.verdict}, as it is: {one.verdict}; {other.text[:300]} | {one.text[:300]}"
    if one.verdict != "holds" or other.verdict != "holds":
        return
    largest = max([*map(np.linalg.norm, one.forces.values()), 1e-300])
    for (quantity, zone), items in one.bars.items():
        others = other.bars.get((quantity, zone), [])
        if name in ("whole", "exchanged", "path") and quantity in ("length", "pressure", "displacement"):
            continue
        if len(items) != len(others):
            yield f"WRONG {name}: {len(others)} values of {quantity} of {zone}, as it is: {len(items)}"
            continue
        for (a, bar), (b, own) in zip(items, others, strict=True):
            if quantity == "force" and max(a, b) < 1e-6 * largest:
                continue
            off = abs(a - b) / max(a, b, 1e-300)
            if abs(a - b) > bar + own + 1e-7 * max(a, b):
                bars = f"bars {bar / max(a, 1e-300):.2e} and {own / max(b, 1e-300):.2e}"
                yield f"WRONG {name}: {quantity} of {zone}: {b:.6g}, as it is: {a:.6g}, off by {off:.2e}, {bars}"
            elif exact and off > ROUND_OFF:
                yield f"DIFFERS {name}: round-off: {quantity} of {zone}: {b:.8g}, as it is: {a:.8g}, off by {off:.1e}"
    for zone, force in {} if name in ("whole", "exchanged") else one.forces.items():
        allowed = sum(e for items in (one.bars, other.bars) for _, e in items.get(("force", zone), ()))
        apart = np.linalg.norm(force - other.forces[zone])
        if apart > allowed + 1e-7 * largest:
            yield f"WRONG {name}: force of {zone}: {other.forces[zone]}, as it is: {force}, allowed {allowed:.3g}"


def judged(kind: str, seed: int, out: Path, limit: float, only: list[str]) -> tuple[Counter[str], float]:
    """Solve all statements of a problem, and print what disagrees."""
    draw = Draw(f"{kind} {seed}")
    spec = json.loads(json.dumps(KINDS[kind](draw)))  # no part of it twice
    first, counts, longest = None, Counter[str](), 0.0
    for name, stated, action, exact in variants(spec, draw):
        if first is not None and only and not any(word in name for word in only):
            continue
        if first is not None and first.verdict != "holds" and not (exact or name == "exchanged"):
            continue
        answer = timed(action, limit)
        longest = max(longest, answer.seconds)
        first = first or answer
        said = [*dict.fromkeys(disagreements(first, answer, name, exact))]
        counts.update(words.split()[0] for words in said)
        for words in said:
            print(f"  {kind} {seed}: {words}", flush=True)
        if said:
            out.mkdir(parents=True, exist_ok=True)
            comment = "".join(f"# {line}\n" for words in said for line in words.splitlines())
            (out / f"{kind}_{seed}.yaml").write_text(comment + to_yaml(spec), encoding="utf-8")
            file = out / f"{kind}_{seed}_{''.join(c if c.isalnum() else '_' for c in name)}.yaml"
            file.write_text(comment + to_yaml(stated), encoding="utf-8")
        if answer.ending == "refused" and name == "as it is":
            print(f"  {kind} {seed}: refused: {answer.text[:400]}", flush=True)
            if "SpecError" in answer.text or "ProblemError" in answer.text:
                counts["refused"] += 1
    assert first is not None
    counts[first.verdict] += first.ending == "answered"
    words = "" if first.verdict in ("holds", "refused") else f": {first.text[:250]}"
    print(f"{kind} {seed}: {first.verdict}{words} ({first.seconds:.1f} s, longest {longest:.1f} s)", flush=True)
    return counts, longest


def give_up(*_: object) -> None:
    """End an answer that takes too long."""
    raise TooSlowError


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1, help="the first one")
    parser.add_argument("--count", type=int, default=100, help="number of problems of all kinds together")
    parser.add_argument("--kind", nargs="+", choices=KINDS, default=[*KINDS], metavar="KIND", help=", ".join(KINDS))
    parser.add_argument("--only", nargs="+", default=[], metavar="WORD", help="variants whose names have one of these")
    folder = Path(tempfile.gettempdir()) / "bemcontact-random"
    parser.add_argument("--out", type=Path, default=folder, metavar="FOLDER", help="of specs, %(default)s by default")
    parser.add_argument("--limit", type=float, default=120, help="seconds of processor time for one answer")
    given = parser.parse_args()
    signal.signal(signal.SIGPROF, give_up)
    warnings.simplefilter("error")
    counts = Counter[str]()
    for number in range(given.count):
        kind, seed = given.kind[number % len(given.kind)], given.seed + number // len(given.kind)
        counts += judged(kind, seed, given.out, given.limit, given.only)[0]
    print(f"{given.count} problems: {dict(counts.most_common())}")
    return int(any(name.isupper() for name in counts))


if __name__ == "__main__":
    sys.exit(main())
