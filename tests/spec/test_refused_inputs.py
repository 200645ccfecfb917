"""The page ``refused_inputs.md``: inputs that are refused, and the sentence that each gets.

``PYTHONPATH=tests/cli python tests/spec/test_refused_inputs.py`` writes the page again.
"""

import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import chdir
from pathlib import Path

import pytest
from command_line import BLOCK
from typer.testing import CliRunner

from bemcontact import cli

PAGE = Path(__file__).with_name("refused_inputs.md")
GOOD = BLOCK.replace("accuracy: null\n", "") + "load_cases:\n  more: {conditions: {top: {pressure: 1}}}\n"
TOP, PLANE = "start: [40, 20], elements: 4", "{kind: plane, point: [0, 0], normal: [0, 1]}"
RIM = "{name: h, kind: arc, center: [20, 10], radius: 5, angles: [360, 0]}"
HOLE = "  holes: [[{{name: h, kind: arc, center: [20, 10], {}, elements: 16}}]]\nconditions:\n"

CHANGES: dict[str, list[tuple[str, str]]] = {
    "YAML": [
        ("units:", "\tunits:"),
        ("name: block on a table", "name: block: on a table"),
        ("conditions:", "conditions: ["),
        ("name: block on a table", "name: *other"),
        ("name: block on a table", "name: !!python/name:os.system x"),
        ("name: block on a table", "name: a\nname: b"),
        ("name: block on a table", 'name: "\\ud83d"'),
        ("name: block on a table", "name: \0"),
        ("name: block on a table", "1: a"),
        ("units:", "a: &a [*a]\nunits:"),
    ],
    "Names and texts": [
        ("name: block on a table", "name: ''"),
        ("name: block on a table", "name: 12"),
        ("name: block on a table", 'name: "\\e[31mred"'),
        ("name: block on a table", 'name: "two\\nlines"'),
        ("name: block on a table", 'name: a\ndescription: "\\u202e"'),
        ("length: mm", 'length: "m\\u2028m"'),
        ("name: top", "name: top.edge"),
        ("name: right", "name: top"),
        ("edges: bottom", "edges: bottm"),
        ("  top: {pressure: 3}", "  tip: {pressure: 3}"),
        ("material:", "materiel:"),
        ("  young_modulus: 210e3\n", "  E: 210e3\n"),
    ],
    "Numbers": [
        ("210e3", "'210e3'"),
        ("210e3", "210 GPA"),
        ("210e3", "210 mm"),
        ("units: {length: mm, force: N}\nmaterial:\n  young_modulus: 210e3", "material:\n  young_modulus: 210 GPa"),
        ("210e3", "210,000"),
        ("210e3", "210_000"),
        ("210e3", "nan"),
        ("210e3", "-1"),
        ("210e3", ".inf"),
        ("210e3", "1e-320"),
        ("210e3", "1e200"),
        ("ratio: 0.3", "ratio: 0.5"),
        ("{pressure: 3}", "{pressure: 1e-300}"),
        ("elements: 4}\n    - {name: right", "elements: 4.5}\n    - {name: right"),
        ("elements: 4}\n    - {name: right", "elements: 100000}\n    - {name: right"),
        (PLANE, "{kind: plane, point: [0, -1e20], normal: [0, 1]}"),
        (PLANE, "{kind: plane, point: [0, 0], normal: [0, 0]}"),
        (PLANE, "{kind: plane, point: [0, 0]}"),
        (PLANE, "{kind: wall}"),
        (PLANE, "{kind: line, point: [0, 0], normal: [0, 1]}"),
        (PLANE, "{kind: plane, point: [0, 0], normal: [0, 1], force: [0, 500]}"),
        ("- {name: top, start: [40, 20], elements: 4}", "- {name: top, kind: circle, center: [20, 20], radius: 20}"),
    ],
    "Geometry": [
        ("start: [40, 20]", "start: [40, 0]"),
        (PLANE, "{kind: plane, point: [0, 0], normal: [0, -1]}"),
        (TOP, f"{TOP}, grading: 3"),
        (TOP, f"{TOP}, grading: {{ratio: 3}}"),
        (TOP, f"{TOP}, grading: {{ratio: 3, towards: [5, 5]}}"),
        (TOP, f"{TOP}, ends_at: [2]"),
        ("conditions:\n", HOLE.format("radius: 10, angles: [360, 0]")),
        ("conditions:\n", HOLE.format("radius: 5, angles: [0, 360]")),
        (
            "conditions:\n",
            "  holes:\n    - [{name: g, kind: arc, center: [18, 10], radius: 3, angles: [360, 0]}]\n"
            "    - [{name: h, kind: arc, center: [22, 10], radius: 3, angles: [360, 0]}]\nconditions:\n",
        ),
    ],
    "Lists, mappings and texts": [
        ("edges: bottom", "edges: bottom, left"),
        ("edges: bottom", "edges: {bottom, left}"),
        ("edges: bottom", "edges: [[bottom]]"),
        ("name: right", "name: [right]"),
        ("units: {length: mm, force: N}", "units: [mm, N]"),
        ("young_modulus: 210e3", "young_modulus: [210e3]"),
        ("poisson_ratio: 0.3", "poisson_ratio: 30 %"),
        ("poisson_ratio: 0.3", "poisson_ratio: 3/10"),
        ("young_modulus: 210e3", "young_modulus:210e3"),
        ("    - {name: bottom, start: [0, 0], elements: 4}", "    - name: bottom, start: [0, 0], elements: 4"),
        (
            "conditions:\n",
            "  holes: [{name: h, kind: arc, center: [20, 10], radius: 5, angles: [360, 0]}]\nconditions:\n",
        ),
        ("  left: {displacement: {x: 0}}\n  top", "  - left: {displacement: {x: 0}}\n  - top"),
        ("left: {displacement: {x: 0}}", "left: fixed"),
        ("left: {displacement: {x: 0}}", "left: {displacement: [0, 0]}"),
        ("left: {displacement: {x: 0}}", "left: {displacement: {x:0}}"),
        ("  top: {pressure: 3}", "  top, right: {pressure: 3}"),
        ("  top: {pressure: 3}", "  [top, right]: {pressure: 3}"),
        ("  foot:\n    edges: bottom\n    surface:", "  edges: bottom\n  surface:"),
        (PLANE, "plane"),
        ("point: [0, 0]", "point: 0, 0"),
        ("load_cases:", "accuracy: 100 %\nload_cases:"),
    ],
    "Fillets, tangents and mirrors": [
        ("    - {name: left", "    - {fillet: 30}\n    - {name: left"),
        ("    - {name: left", "    - {fillet: big}\n    - {name: left"),
        ("    - {name: left", "    - {kind: fillet, radius: 3}\n    - {name: left"),
        ("start: [0, 20], elements: 2}", "start: [0, 20], fillet: 3}"),
        ("start: [0, 20], elements: 2}", "start: [0, 20], chamfer: 3}"),
        ("start: [0, 20], elements: 2}", "start: [0, 20], elements: 2, tangent: both}"),
        ("{name: left, start: [0, 20],", "{name: left, tangent: both,"),
        ("  outer:", "  mirror: {x: 0, y: 0}\n  outer:"),
        ("  outer:", "  mirror: {x: 7}\n  outer:"),
    ],
    "Conditions and loads": [
        ("{pressure: 3}", "{}"),
        ("{pressure: 3}", "{pressure: 3, traction: {y: 1}}"),
        ("{pressure: 3}", "{pressure: -3}"),
        ("  top: {pressure: 3}", "  top: {pressure: 3}\n  bottom: {pressure: 3}"),
        ("more: {conditions: {top: {pressure: 1}}}", "more: {}"),
        ("  top: {pressure: 3}", "  top: {pressure: 3}\n  right: {fixed: false}"),
        ("  top: {pressure: 3}", "  top: {pressure: 3}\n  right: {symmetry: z}"),
        ("  top: {pressure: 3}", "  top: {pressure: 3}\n  right: {symmetry: y}"),
        ("  top: {pressure: 3}", "  top: {pressure: 3}\n  right: {roller: true}"),
        ("  top: {pressure: 3}", "  top: {pressure: 3}\n  right: {spring: 50}"),
        ("  top: {pressure: 3}", "  top: {pressure: 3}\n  right: {spring: {}}"),
        ("  top: {pressure: 3}", "  top: {pressure: 3}\n  right: {spring: {stiffness: 50}}"),
        ("  top: {pressure: 3}", "  top: {pressure: 3}\n  right: {spring: {normal: 0}}"),
        ("{pressure: 3}", "{spring: {normal: 5}, displacement: {y: 0}}"),
        ("  top: {pressure: 3}", "  top: {pressure: 3}\n  right: {spring: {normal: 5 MPa}}"),
        ("{conditions: {top: {pressure: 1}}}", "{conditions: {top: {spring: {normal: 1}}}}"),
        ("conditions:\n", "spring: {bottom: 5}\nconditions:\n"),
        ("{pressure: 3}", "{force: {y: -120, at: 3}}"),
        ("{pressure: 3}", "{force: {y: -120, width: 8, at: [20, 20]}}"),
        ("{pressure: 3}", "{force: {y: -120, at: 3, width: 8}}"),
        ("{pressure: 3}", "{force: {y: -120, at: 8, width: 8}}"),
        ("{pressure: 3}", "{pressure: {along: [[20, 1], [0, 3]]}}"),
    ],
}
"""Kind of a mistake -> what is replaced in the good spec, and by what."""
BODIES = """\
name: two blocks
materials: {steel: {young_modulus: 210e3, poisson_ratio: 0.3}}
bodies:
  up:
    material: steel
    boundary:
      outer:
        - {name: bottom, start: [0, 0], end: [2, 0]}
        - {name: side, end: [2, 1]}
        - {name: top, end: [0, 1]}
        - {name: left}
    conditions: {left: {displacement: {x: 0}}}
  low:
    material: steel
    boundary:
      outer:
        - {name: bottom, start: [-1, -1], end: [3, -1]}
        - {name: side, end: [3, 0]}
        - {name: top, end: [-1, 0]}
        - {name: left}
    conditions: {bottom: {displacement: {x: 0, y: 0}}}
  peg: {copy_of: up, shift: [9, 0], conditions: {bottom: {displacement: {x: 0, y: 0}}}}
contacts:
  face: {between: [up/bottom, low/top]}
load_cases:
  press: {conditions: {up/top: {pressure: 1}}}
"""
"""A spec of several bodies without mistakes."""
CHANGES_OF_BODIES = [
    ("shift: [9, 0], ", ""),
    ("shift: [9, 0]", "rotate: 360"),
    ("shift: [9, 0]", "shift: [1.5, 0.5]"),
    ("shift: [9, 0]", "shift: [0.5, -0.9]"),
    ("[up/bottom, low/top]}", "[up/bottom, low/top]}\n  again: {between: [low, up]}"),
    ("[up/bottom, low/top]}", "[up/bottom, low/top], clearance: 0.1}"),
    ("[up/bottom, low/top]", "[up/bottom, low/left]"),
    ("[up/bottom, low/top]", "[up, lower]"),
    ("contacts:", "units: {length: mm, pressure: GPa}\ncontacts:"),
    ("contacts:", "bonded: {glue: [up/left, low/left]}\ncontacts:"),
    ("contacts:", "conditions: {up/left: {displacement: {x: 0}}}\ncontacts:"),
]
"""What is replaced in the spec of several bodies, and by what."""
TEXTS: list[tuple[str, Callable[[], str | bytes]]] = [
    ("an empty file", lambda: ""),
    ("`- a list`", lambda: "- a list"),
    ("`name: a`, `bodies: {}`", lambda: "name: a\nbodies: {}"),
    ("600 opening brackets", lambda: "[" * 600),
    ("nine aliases of nine aliases of nine …", lambda: "a0: &a0 [x]\n" + "".join(
        f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 10))),
    ("100,000 keys", lambda: "".join(f"k{i}: 1\n" for i in range(100_000))),
    ("1001 keys", lambda: "".join(f"k{i}: 1\n" for i in range(1001))),
    ("a comment of two million characters", lambda: "# " + "x" * 2_000_000),
    ("a file of 50 MB", lambda: "#" * 50_000_000),
    ("a file in Latin-1", lambda: GOOD.replace("table", "Bänk").encode("latin-1")),
    ("a picture", lambda: b"\x89PNG\r\n\x1a\n\0\0"),
]  # fmt: skip
COMMANDS = [
    "check blok.yaml",
    "check dangling.yaml",
    "check loop.yaml",
    "check .",
    "check /dev/zero",
    "check pipe",
    "check good.yaml --set material.young_modulus",
    "check good.yaml --set material..x=1",
    "check good.yaml --set boundary.outer.tip.elements=3",
    "check good.yaml --set material.young_modulus=-1",
    "check good.yaml --variant fine",
    "solve good.yaml --case less",
    "solve good.yaml --json loop.yaml",
    "solve good.yaml --json good.yaml",
    "solve good.yaml --json nowhere/a.json",
    "solve good.yaml --json /dev/null",
    "solve good.yaml --figure a.jpg",
    "solve good.yaml --vtk a.stl",
    "solve good.yaml --case more --vtk a.vtu --figure a.vtu",
    "solve good.yaml --formulation qp2 --penalty -1",
    "solve good.yaml --formulation qp1 --start good.yaml --case more",
    "solve good.yaml --formulation qp1 --start none.json --case more",
    "solve good.yaml --formulation qp1 --start pipe --case more",
    "solve good.yaml --formulation qp1 --start deep.json --case more",
    "solve good.yaml --formulation qp1 --start huge.json --case more",
    "solve good.yaml --formulation qp1 --start short.json --case more",
    "condense good.yaml --out a.txt",
    "compare good.yaml --out loop.yaml",
    "compare good.yaml --out .",
    "compare good.yaml --refine 1,x",
    "compare good.yaml --formulations qp9",
    "compare good.yaml --weights none",
    "path good.yaml --vary nothing.here --to 1",
    "path good.yaml --vary material.young_modulus --to 1 --case more",
    "schema --path --cases",
]


def prepare(folder: Path) -> None:
    """Write the files that the commands name."""
    (folder / "good.yaml").write_text(GOOD, encoding="utf-8")
    (folder / "dangling.yaml").symlink_to("gone.yaml")
    (folder / "loop.yaml").symlink_to("pool.yaml")
    (folder / "pool.yaml").symlink_to("loop.yaml")
    os.mkfifo(folder / "pipe")
    (folder / "deep.json").write_text("[" * 100_000, encoding="utf-8")
    (folder / "huge.json").write_text(f'{{"pressure": [1{"0" * 5000}], "normal_displacement": [1]}}', encoding="utf-8")
    (folder / "short.json").write_text('{"pressure": [1, 2], "normal_displacement": [1]}', encoding="utf-8")


def refusal(arguments: str) -> str:
    """What a command prints on standard error, which is an error of the input."""
    result = CliRunner(env={"COLUMNS": "400"}).invoke(cli.app, arguments.split())
    assert result.exit_code == 2, (arguments, result.output, result.exception)
    assert result.stderr.startswith("error: "), result.stderr
    assert result.stdout == ""
    return result.stderr.removeprefix("error: ").strip()


def cell(text: str) -> str:
    """A text in a cell of a table of Markdown."""
    return text.replace("|", r"\|").replace("\n", "<br>")


def code(text: str) -> str:
    """A snippet in a cell; each of its lines is code."""
    visible = text.replace("\0", "␀").replace("\t", "→")
    return "<br>".join(f"`` {line} ``" for line in visible.rstrip("\n").split("\n"))


def rows_of(changes: list[tuple[str, str]], right: str = GOOD, case: str = "more") -> Iterator[tuple[str, ...]]:
    """Rows of the changes to a right spec: the lines that replace others, and the message that they get."""
    for old, new in changes:
        assert old in right
        wrong = right.replace(old, new, 1)
        Path("a.yaml").write_text(wrong, encoding="utf-8")
        yield *changed_lines(right.split("\n"), wrong.split("\n")), refusal(f"check a.yaml --case {case}")


def changed_lines(good: list[str], wrong: list[str]) -> tuple[str, str]:
    """Numbers of the lines of the good spec that a wrong one replaces, or before which it has more, and its own."""
    same = equal_lines(good, wrong)
    rest = equal_lines(good[same:][::-1], wrong[same:][::-1])
    first, last = same + 1, len(good) - rest
    number = f"before {first}" if last < first else str(first) if first == last else f"{first} to {last}"
    lines = wrong[same : len(wrong) - rest]
    indent = min(len(line) - len(line.lstrip(" ")) for line in lines)
    return number, code("\n".join(line[indent:] for line in lines))


def equal_lines(one: list[str], other: list[str]) -> int:
    """How many lines are equal at the beginning."""
    return next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other)))


def rows_of_texts() -> Iterator[tuple[str, ...]]:
    """Rows of whole files."""
    for title, made in TEXTS:
        content = made()
        Path("a.yaml").write_bytes(content if isinstance(content, bytes) else content.encode())
        yield title, refusal("check a.yaml")


def table(heads: tuple[str, ...], rows: Iterator[tuple[str, ...]]) -> str:
    """A table; its last column has the messages."""
    lines = [" | ".join(["", *others, cell(message), ""]).strip() for *others, message in rows]
    return "\n".join([f"| {' | '.join(heads)} | Message |", "|---" * len(heads) + "|---|", *lines])


def page(folder: Path) -> str:
    """The page, made in a folder."""
    prepare(folder)
    with chdir(folder):
        parts = [
            "# Refused inputs",
            "This page lists mistakes, and the message that a user gets for each. "
            "`PYTHONPATH=tests/cli python tests/spec/test_refused_inputs.py` writes it, and a test compares it.",
            "The first tables change a few lines of this problem file, which has no mistake:",
            f"```yaml\n{GOOD}```",
            "*Line* is the number of the line that is changed, and *Changed to* is what it says then. The message is "
            "what `bemcontact check a.yaml` prints; it begins with file, line and column. "
            "→ stands for a tab and ␀ for the character 0.",
            *(f"## {kind}\n\n{table(('Line', 'Changed to'), rows_of(changes))}" for kind, changes in CHANGES.items()),
            f"## Several bodies\n\nHere `a.yaml` is this file with one change.\n\n```yaml\n{BODIES}```\n\n"
            + table(("Line", "Changed to"), rows_of(CHANGES_OF_BODIES, BODIES, "press")),
            "## Whole files\n\nHere `a.yaml` has another content.\n\n"
            + table(("Content of `a.yaml`",), rows_of_texts()),
            "## Commands\n\nThe file `good.yaml` is the problem above.\n\n"
            + table(("Command",), ((code(f"bemcontact {item}"), refusal(item)) for item in COMMANDS)),
        ]
    return re.sub(re.escape(str(folder.resolve())), "/folder", "\n\n".join(parts)) + "\n"


@pytest.mark.slow
def test_the_page_is_true(tmp_path: Path):
    assert page(tmp_path) == PAGE.read_text(encoding="utf-8")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        PAGE.write_text(page(Path(place)), encoding="utf-8")
    sys.stdout.write(f"{PAGE}\n")
