"""Mutated specs through `bemcontact.loads`: any error must be a `SpecError`, soon, and without much memory.

    python tests/benchmarks/spec_mutations.py [COUNT] [SEED] [FOLDER]

Each shipped model is changed at random: in its text (bytes, lines, pieces of other models), in its data (values, keys
and whole branches are replaced, repeated, moved or removed), or both. What raises another error than `SpecError`,
warns, takes more than five seconds of processor time, or lets the process grow beyond 500 MB is printed and kept in
FOLDER.
"""

import copy
import json
import random
import signal
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import yaml

import bemcontact
from bemcontact.spec.yaml_1_2 import to_yaml

MODELS = Path(__file__).parents[2] / "models"
LONGEST = 5.0
"""Seconds of processor time for one spec."""
LARGEST = 500
"""Megabytes of the whole process."""
LARGEST_FLOAT = sys.float_info.max
NUMBERS = (0, -1, 1, 2, 0.5, 1e-300, 1e-30, 1e-12, 1e12, 1e30, 1e100, 1e308, -1e-320, 360, 10**6, 10**400)
SCALARS: tuple[Any, ...] = (
    *NUMBERS, None, True, "", " ", "x", "a.b", "[0]", "=", "\x1b[31m", "\u202e", "\u2028", "\N{GRINNING FACE}", "1e3",
    "1,5", "no", "top", "start", "plane", "arc", "ellipse", "spline", "y" * 5000, [], {}, [0, 0], [[0, 0], [1, 1]],
    {"x": 0}, {"kind": "plane"},
)  # fmt: skip
PIECES = (
    "&a ", "*a", "<<: *a\n", "!!float ", "!!python/name:os.system ", "? ", ": ", "- ", "[", "]", "{", "}", "'", '"',
    "|\n", ">\n", "#", "\t", "\n", "---\n", "...\n", "%YAML 1.1\n", '"\\ud83d"', '"\\x00"', "\x85", "\ufeff",
    "0x1F", ".nan", "-.inf",
)  # fmt: skip
Keys = tuple[Any, ...]


class TooSlowError(Exception):
    """A spec took too long."""


def entries(data: Any, path: Keys = ()) -> Iterator[Keys]:
    """Paths of all values below the top."""
    keyed = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in keyed:
        yield (*path, key)
        yield from entries(value, (*path, key))


def at(data: Any, path: Keys) -> Any:
    """Value at a path."""
    for key in path:
        data = data[key]
    return data


def change_data(data: Any, others: list[Any], rng: random.Random) -> None:
    """Change one value or key of nested data."""
    path = rng.choice([*entries(data)])
    above, key = at(data, path[:-1]), path[-1]
    other = rng.choice(others)
    match rng.randrange(8):
        case 0 | 1 | 2:
            above[key] = copy.deepcopy(rng.choice(SCALARS))
        case 3:
            above[key] = copy.deepcopy(at(other, rng.choice([*entries(other)])))
        case 4:
            del above[key]
        case 5 if isinstance(above, list):
            above.insert(rng.randrange(len(above) + 1), copy.deepcopy(above[key]))
        case 6 if isinstance(above, dict):
            names = [f"{key}x", str(key)[1:], str(rng.choice(SCALARS)), rng.choice([*entries(other)])[-1]]
            above[rng.choice(names)] = above.pop(key)
        case _:
            value = above[key]
            number = isinstance(value, int | float) and not isinstance(value, bool)
            factors = [-1, 1e-9, 1e9, 1 + 1e-9, 2] if number and abs(value) < LARGEST_FLOAT else [-1, 2]
            above[key] = value * rng.choice(factors) if number else rng.choice(NUMBERS)


def change_text(text: str, others: list[str], rng: random.Random) -> str:
    """Change one place of a text."""
    i, j = sorted(rng.randrange(len(text) + 1) for _ in range(2))
    j = min(j, i + rng.choice([1, 3, 10, 100]))
    other = rng.choice(others)
    k = rng.randrange(len(other))
    letter, number = chr(rng.randrange(1, 0x300)), str(rng.choice(NUMBERS))
    put = rng.choice(["", "", rng.choice(PIECES), letter, number, other[k : k + 50], text[i:j] * 2])
    return text[:i] + put + text[j:]


def mutated(texts: list[str], data: list[Any], rng: random.Random) -> str:
    """One model with one to four changes."""
    which = rng.randrange(len(texts))
    text, changes = texts[which], rng.choice([1, 1, 2, 4])
    if rng.random() < 0.7:
        mutant = copy.deepcopy(data[which])
        for _ in range(changes):
            if mutant:
                change_data(mutant, data, rng)
        text = to_yaml(mutant) if rng.random() < 0.2 else json.dumps(mutant, ensure_ascii=rng.random() < 0.5)
        changes = rng.choice([0, 0, 0, 1])
    for _ in range(changes):
        text = change_text(text, texts, rng)
    return text


def outcome(read: Callable[[str], object], text: str) -> str:
    """How reading ends: loaded, refused, or what is wrong."""
    start = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, 4 * LONGEST)
    try:
        read(text)
        ending = "loaded"
    except bemcontact.SpecError as error:
        hidden = any(not (c.isprintable() or c in "\n\u200c\u200d") and c.isascii() for c in str(error))
        ending = "hidden characters in the message" if hidden else "refused"
    except Exception as error:  # each is a mistake of ours
        ending = f"{type(error).__name__}: {str(error)[:100]}"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    took = time.process_time() - start
    return ending if took <= LONGEST else f"slow: {took:.0f} s"


def memory() -> float:
    """Largest memory of the process so far [MB]."""
    from resource import RUSAGE_SELF, getrusage

    return getrusage(RUSAGE_SELF).ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)


def give_up(*_: object) -> None:
    """End a spec that takes too long."""
    raise TooSlowError


def main(count: int = 100_000, seed: int = 0, folder: str = "") -> int:
    """Read mutants and count how they end; the number of those that end badly."""
    signal.signal(signal.SIGPROF, give_up)
    warnings.simplefilter("error")
    rng, endings, bad = random.Random(seed), Counter[str](), 0
    texts = [path.read_text(encoding="utf-8") for path in sorted(MODELS.rglob("*.yaml"))]
    data = [yaml.safe_load(text) for text in texts]
    for number in range(count):
        text = mutated(texts, data, rng)
        before = memory()
        ending = outcome(bemcontact.loads, text)
        if memory() > max(before, LARGEST):
            ending = f"large: {memory():.0f} MB"
        endings[ending] += 1
        if ending not in ("loaded", "refused"):
            bad += 1
            print(f"{number}: {ending}", flush=True)
            if folder:
                Path(folder, f"mutant_{seed}_{number}.yaml").write_text(text, encoding="utf-8", errors="surrogatepass")
        if number % 10_000 == 9_999:
            print(f"{number + 1} read, {endings['refused']} refused, {bad} bad, {memory():.0f} MB", flush=True)
    print(f"{count} mutants: {dict(endings.most_common(20))}; {memory():.0f} MB")
    return bad


if __name__ == "__main__":
    given = [*sys.argv[1:], *("100000", "0", "")[len(sys.argv) - 1 :]]
    sys.exit(min(main(int(given[0]), int(given[1]), given[2]), 1))
