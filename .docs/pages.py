"""Run the code blocks of the documentation and compare what they print with what the pages show.

``python .docs/pages.py [PAGE ...]`` writes what is printed into the pages, and pictures that a page draws into their
place. All pages are taken if none is named. The tests run the same blocks and compare.

A page is one session in a folder of its own, with the shipped models in ``models/``:

- ``yaml``: the first line ``# NAME.yaml`` says under which name the problem is saved, or ``# added to NAME.yaml`` to
  which file the keys are added. The file must be a valid problem.
- ``python``: runs in one namespace for the page. A block ``text`` right after it shows what it prints.
- ``console``: lines ``$ COMMAND``, each with what it prints. A command that does not end with status 0 is followed by
  ``$ echo $?``.
- ``json``: must parse.
- ``sh`` and ``{code-cell}`` are left to other tests.
- Blocks that are indented or have no language are refused.

Inline code that begins with ``bemcontact`` must be a command with options and problem files that exist. The file may be
left out, and values of options are not checked.

The line ``...`` in an output stands for lines that are left out. A comment ``<!-- uses: PAGE -->`` (from the folder of
this file) saves the problem files of another page first.
"""

import contextlib
import io
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import chdir
from dataclasses import dataclass, field
from decimal import Decimal
from difflib import SequenceMatcher
from pathlib import Path

import yaml
from markdown_it import MarkdownIt
from markdown_it.token import Token
from typer.testing import CliRunner

import bemcontact
from bemcontact import cli

DOCS = Path(__file__).parent
ROOT = DOCS.parent
OTHERS = ("sh", "mermaid")
"""Languages of blocks that are not run here."""
CUT = "..."
"""The line that stands for lines that are left out."""
SETTINGS = {"COLUMNS": "80", "MPLBACKEND": "Agg", "NO_COLOR": "1"}
"""Environment in which each machine prints and draws the same."""
HERE = "~/contact"
"""What the folder in which a page runs is called in outputs."""
NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)")
ROUND_OFF = 1e-9
"""Magnitude below which numbers are not compared."""


def pages() -> list[Path]:
    """List the Markdown files of the repository whose blocks are run."""
    others = [*ROOT.glob("*.md"), *ROOT.glob("models/*.md"), *ROOT.glob("tests/*.md"), *ROOT.glob(".github/*.md")]
    return others + [page for page in sorted(DOCS.rglob("*.md")) if "build" not in page.relative_to(DOCS).parts]


@dataclass
class Output:
    """What a command or a block prints, as a page shows it in its lines `first` to `last`, and as it is."""

    source: str
    first: int
    last: int
    indent: str
    shown: str
    printed: str

    @property
    def agrees(self) -> bool:
        """Whether the page shows what is printed, or shows nothing."""
        return not self.shown.strip() or agrees(self.shown, self.printed)


@dataclass
class Session:
    """A page as it is run in a folder."""

    page: Path
    folder: Path
    names: dict[str, object] = field(default_factory=lambda: {"__name__": "__main__"})
    printed: str | None = None
    """What the last block printed, if it was Python."""

    def run(self) -> Iterator[Output]:
        """Run all blocks; `PageError` names the line of what fails."""
        (self.folder / "models").symlink_to(ROOT / "models")
        parts = tokens(self.page)
        for token in parts:
            used = re.fullmatch(r"<!-- uses: (\S+) -->", token.content.strip())
            if used:
                for other in tokens(DOCS / used[1]):
                    if other.info == "yaml":
                        self.save(other)
            elif token.type == "code_block":
                self.fail(token, "an indented block is not run: put it in a fence with its language")
            elif token.type == "fence":
                yield from self.block(token)
        for token in parts:
            for code in token.children or ():
                if code.type == "code_inline" and code.content.startswith("bemcontact "):
                    self.mention(token, code.content)

    def block(self, token: Token) -> Iterator[Output]:
        """Run one block."""
        printed, self.printed = self.printed, None
        match token.info.strip():
            case "yaml":
                self.save(token)
            case "python":
                self.printed = self.python(token)
            case "text" if printed is not None:
                yield self.output(token, 0, token.content.splitlines(), printed, "the Python block above")
            case "console":
                yield from self.console(token)
            case "json":
                json.loads(token.content)
            case language if language not in OTHERS and not language.startswith("{"):
                self.fail(token, f"a block of {language or 'no language'} here is not run: see {Path(__file__).name}")

    def save(self, token: Token) -> None:
        """Save a problem, or add keys to one, and load it."""
        first = token.content.partition("\n")[0]
        found = re.fullmatch(r"# (added to )?(\S+\.yaml)", first)
        if not found:
            self.fail(token, "the first line of a problem has to be '# NAME.yaml' or '# added to NAME.yaml'")
        path = self.folder / found[2]
        text = added(path.read_text(encoding="utf-8"), token.content) if found[1] else token.content
        path.write_text(text, encoding="utf-8")
        bemcontact.load(path)

    def python(self, token: Token) -> str:
        """Run a block of Python and give what it prints."""
        assert token.map
        code = compile("\n" * (token.map[0] + 1) + token.content, str(self.page), "exec")
        with chdir(self.folder), contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(code, self.names)
        return printed.getvalue()

    def console(self, token: Token) -> Iterator[Output]:
        """Run commands, each followed by what it prints."""
        lines = token.content.splitlines()
        starts = [i for i, line in enumerate(lines) if line.startswith("$ ")]
        if not starts or starts[0] != 0:
            self.fail(token, "the first line of a console has to be '$ COMMAND'")
        status = 0
        for start, stop in zip(starts, [*starts[1:], len(lines)], strict=True):
            begin = start + 1
            while lines[begin - 1].endswith("\\"):
                begin += 1
            command = "\n".join(lines[start:begin])[2:]
            if command == "echo $?":
                printed, status = f"{status}\n", 0
            elif status:
                self.fail(token, f"status {status} before '{command}'; show '$ echo $?' if that is meant:\n{printed}")
            else:
                printed, status = self.command(command)
            yield self.output(token, begin, lines[begin:stop], printed, command)
        if status:
            self.fail(token, f"status {status} at the end; show '$ echo $?' if that is meant:\n{printed}")

    def command(self, command: str) -> tuple[str, int]:
        """Run a command, bemcontact in this process if nothing is piped, and give what it prints and its status."""
        with chdir(self.folder):
            if command.startswith("bemcontact ") and not re.search(r"[|<>;&$`\\*]", command):
                run = CliRunner().invoke(cli.app, shlex.split(command)[1:], catch_exceptions=False)
                return run.output, run.exit_code
            with tempfile.TemporaryDirectory() as programs:
                program = Path(programs) / "bemcontact"
                program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m bemcontact "$@"\n')
                program.chmod(0o755)
                path = os.pathsep.join([programs, str(Path(sys.executable).parent), os.environ["PATH"]])
                modules = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")]))
                run = subprocess.run(
                    ["bash", "-c", command],
                    env={**os.environ, "PATH": path, "PYTHONPATH": modules},
                    stdout=subprocess.PIPE,
                    stderr=subprocess.STDOUT,
                    encoding="utf-8",
                    check=False,
                )
                return run.stdout, run.returncode

    def mention(self, token: Token, command: str) -> None:
        """Check that a command in a sentence or in a table has options that exist, and problem files that are there."""
        missing = [
            word for word in shlex.split(command) if word.endswith(".yaml") and not (self.folder / word).is_file()
        ]
        if missing:
            self.fail(token, f"there is no {missing[0]} for '{command}'")
        printed, status = self.command(f"{command} --help")  # which reads the options before it shows the help
        if status:
            self.fail(token, f"'{command}' is no command:\n{printed}")

    def output(self, token: Token, skipped: int, shown: list[str], printed: str, source: str) -> Output:
        """Put beside each other what a part of a block shows and what is printed."""
        assert token.map
        printed = printed.replace(str(self.folder.resolve()), HERE)
        first = token.map[0] + 1 + skipped
        opening = self.page.read_text(encoding="utf-8").splitlines()[token.map[0]]
        indent = opening[: len(opening) - len(opening.lstrip())]
        return Output(source, first, first + len(shown), indent, "\n".join(shown), printed)

    def fail(self, token: Token, message: str) -> None:
        """Say what is wrong with a block, and at which line."""
        assert token.map
        raise PageError(f"{self.page}:{token.map[0] + 1}: {message}")


class PageError(Exception):
    """A block that cannot be run, or does not do what the page says."""


def tokens(page: Path) -> list[Token]:
    """Give the parts of a page in their order."""
    return MarkdownIt("commonmark").parse(page.read_text(encoding="utf-8"))


def added(text: str, more: str) -> str:
    """Add the keys of one YAML text to another: mappings are joined, anything else is replaced."""

    def join(node: yaml.MappingNode, other: yaml.MappingNode) -> None:
        for key, value in other.value:
            same = [i for i, (name, _) in enumerate(node.value) if name.value == key.value]
            old = node.value[same[0]][1] if same else None
            if isinstance(old, yaml.MappingNode) and isinstance(value, yaml.MappingNode):
                join(old, value)
            elif same:
                node.value[same[0]] = (key, value)
            else:
                node.value.append((key, value))

    node, other = yaml.compose(text), yaml.compose(more)
    assert isinstance(node, yaml.MappingNode)
    assert isinstance(other, yaml.MappingNode)
    join(node, other)
    return yaml.serialize(node, allow_unicode=True)


def agrees(shown: str, printed: str) -> bool:
    """Compare what is shown with what is printed, but for blanks, times, versions and the last digit of numbers."""
    parts = [words(part) for part in re.split(rf"^[ \t]*{re.escape(CUT)}[ \t]*$", shown, flags=re.MULTILINE)]
    rest = words(printed)
    if len(parts) == 1:
        return equal(parts[0], rest)
    head, tail = parts[0], parts[-1]
    if not equal(head, rest[: len(head)]) or not equal(tail, rest[len(rest) - len(tail) :]):
        return False
    rest = rest[len(head) : len(rest) - len(tail)]
    for part in parts[1:-1]:
        places = [i for i in range(len(rest) - len(part) + 1) if equal(part, rest[i : i + len(part)])]
        if not places:
            return False
        rest = rest[places[0] + len(part) :]
    return True


def words(text: str) -> list[str]:
    """Cut a text into words, without what differs from run to run."""
    lines, column = [], None
    for line in text.splitlines():
        header = re.search(r"\bseconds\b", line)
        if header:
            column = header.end()
        elif not line.strip():
            column = None
        elif column is not None:  # a number under the word "seconds"
            line = re.sub(r"[\d.]+$", "#", line[:column]) + line[column:]
        lines.append(line)
    text = re.sub(r"\b[\d.]+(?:e-\d+)? (s|ms|seconds|minutes)\b", r"# \1", "\n".join(lines))
    text = re.sub(r"(bemcontact |\"version\": \")\d+(\.\w+)+", r"\1#", text)
    return re.sub(r"[─━═-]{3,}", "---", text).split()


def equal(words: list[str], others: list[str]) -> bool:
    """Compare two lists of words, numbers within them as numbers."""
    return len(words) == len(others) and all(map(same, words, others))


def same(word: str, other: str) -> bool:
    """Compare two words: numbers up to one unit of the last digit, or both round-off; integers exactly."""
    if word == other:
        return True
    parts, others = NUMBER.split(word), NUMBER.split(other)
    return parts[::2] == others[::2] and all(map(same_number, parts[1::2], others[1::2]))


def same_number(text: str, other: str) -> bool:
    """Compare two numbers as they are printed."""
    if re.fullmatch(r"[-+]?\d+", text) and re.fullmatch(r"[-+]?\d+", other):
        return int(text) == int(other)
    a, b = Decimal(text), Decimal(other)
    unit = min(Decimal(1).scaleb(int(number.as_tuple().exponent)) for number in (a, b))
    size = max(abs(a), abs(b))
    return size < ROUND_OFF or abs(a - b) <= (unit if unit < size else 0) + Decimal("1e-6") * size


def refreshed(shown: str, printed: str) -> str:
    """Give what is printed with the cuts of what was shown: as many lines at the head and tail, the likest between."""
    lines = printed.rstrip("\n").splitlines()
    parts = [part.strip("\n").splitlines() for part in re.split(rf"^{re.escape(CUT)}$", shown, flags=re.MULTILINE)]
    if len(parts) == 1:
        return "\n".join(lines)
    head, tail = len(parts[0]), len(parts[-1])
    kept, middle = [lines[:head]], lines[head : len(lines) - tail]
    for part in parts[1:-1]:
        windows = [middle[i : i + len(part)] for i in range(len(middle) - len(part) + 1)]
        kept.append(max(windows, key=lambda window: SequenceMatcher(None, "\n".join(part), "\n".join(window)).ratio()))
    kept.append(lines[len(lines) - tail :])
    return f"\n{CUT}\n".join("\n".join(part) for part in kept).strip("\n")


def refresh(page: Path) -> None:
    """Run a page, and write what is printed and drawn."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        outputs = list(Session(page, folder).run())
        text = page.read_text(encoding="utf-8")
        lines = text.splitlines()
        for output in reversed(outputs):
            wanted = output.shown.strip() or output.source == "the Python block above"
            if wanted and not (output.shown.strip() and output.agrees):
                new = refreshed(output.shown, output.printed).splitlines()
                lines[output.first : output.last] = [f"{output.indent}{line}".rstrip() for line in new]
                print(f"{os.path.relpath(page)}:{output.first + 1}: {output.source}")
        page.write_text("\n".join(lines) + "\n", encoding="utf-8")
        for target in re.findall(r"!\[[^]]*\]\(([^)\s]+)\)", text):
            drawn, place = folder / Path(target).name, page.parent / target
            if drawn.is_file() and not (place.is_file() and place.read_bytes() == drawn.read_bytes()):
                place.parent.mkdir(exist_ok=True)
                shutil.copy(drawn, place)
                print(f"{os.path.relpath(place)} of {os.path.relpath(page)}")


if __name__ == "__main__":
    os.environ.update(SETTINGS)
    try:
        for named in [Path(name).resolve() for name in sys.argv[1:]] or pages():
            refresh(named)
    except PageError as error:
        sys.exit(str(error))
