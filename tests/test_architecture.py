"""The rules of the house, read off the syntax tree: who may import whom, where, and what every public name owes."""

import ast
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "bemcontact"

Rule = Callable[[str, ast.Module], Iterator[str]]

ABOVE = (
    "mesh_fit",
    "result",
    "fitting",
    "study",
    "analysis",
    "comparing",
    "responses",
    "reproduction",
    "report",
    "cli",
)
"""Rooms that put both halves of the house together."""

NEVER = {
    "bemcontact.bem": (
        "spec", "solution", "ends", "formulations", "assessment", "modelling", "parametric", "reference", *ABOVE
    ),
    "bemcontact.formulations": (
        "spec", "problem", "bem", "assessment", "modelling", "parametric", "reference", *ABOVE
    ),
    "bemcontact.assessment": (
        "spec", "problem", "bem", "formulations", "modelling", "parametric", "reference", *ABOVE
    ),
    "bemcontact.parametric": ("spec", "problem", "bem", "modelling", "reference", *ABOVE),
    "bemcontact.modelling": ("spec", "bem", "parametric", "reference", *ABOVE),
    "bemcontact.result": ("spec", "fitting", "study", "analysis", "comparing", "report", "cli"),
    "bemcontact.study": ("spec", "bem", "formulations", "analysis", "comparing", "report", "cli"),
    "bemcontact.fitting": ("spec", "result", "study", "analysis", "comparing", "report", "cli"),
    "bemcontact.analysis": ("spec", "study", "comparing", "report", "cli"),
    "bemcontact.comparing": ("spec", "bem", "report", "cli"),
    "bemcontact.responses": ("spec", "bem", "study", "comparing", "report", "cli"),
    "bemcontact.report": (
        "spec", "formulations", "analysis", "comparing", "responses", "reproduction.carrying_out", "cli",
    ),
    "bemcontact.reproduction": ("bem", "report", "cli"),
}  # fmt: skip
"""Room -> rooms of ours that it never imports."""

ONLY = {
    "bemcontact.errors": (),
    "bemcontact.choices": (),
    "bemcontact.output": (),
    "bemcontact.gauge": (),
    "bemcontact.arrays": (),
    "bemcontact.actions": ("bemcontact.arrays",),
    "bemcontact.archive": ("bemcontact.errors", "bemcontact.output"),
    "bemcontact.contact_scales": ("bemcontact.arrays",),
    "bemcontact.stiffness": ("bemcontact.arrays", "bemcontact.contact_scales", "bemcontact.errors"),
    "bemcontact.contact": (
        "bemcontact.actions", "bemcontact.archive", "bemcontact.arrays", "bemcontact.choices",
        "bemcontact.contact_scales", "bemcontact.errors", "bemcontact.gauge", "bemcontact.modelling.contact_model",
        "bemcontact.stiffness",
    ),
    "bemcontact.solution": ("bemcontact.arrays",),
    "bemcontact.ends": ("bemcontact.solution",),
    "bemcontact.mesh_fit": ("bemcontact.assessment.footprint",),
    "bemcontact.parametric": (
        "bemcontact.actions", "bemcontact.arrays", "bemcontact.assessment.footprint", "bemcontact.choices",
        "bemcontact.contact", "bemcontact.errors", "bemcontact.formulations", "bemcontact.parametric",
        "bemcontact.solution",
    ),
    "bemcontact.formulations.local_solver": ("bemcontact.errors", "bemcontact.formulations.local_solver"),
    "bemcontact.problem": ("bemcontact.errors", "bemcontact.problem"),
    "bemcontact.reference": (
        "bemcontact.arrays", "bemcontact.errors", "bemcontact.contact", "bemcontact.problem",
        "bemcontact.assessment.footprint", "bemcontact.reference",
    ),
}  # fmt: skip
"""Room -> the only modules of ours that it imports."""

HOME = {
    "yaml": ("bemcontact.spec", "bemcontact.dialect"),
    "cvxpy": ("bemcontact.formulations.qp3", "bemcontact.modelling"),
    "clarabel": ("bemcontact.formulations.qp3",),
    "matplotlib": ("bemcontact.report.figures",),
    "typer": ("bemcontact.cli",),
    "numba": ("bemcontact.bem.compiled",),
    "meshio": ("bemcontact.report.vtk",),
    "jinja2": ("bemcontact.report.markup",),
    "rich": (
        "bemcontact.terminal",
        "bemcontact.report.tables",
        "bemcontact.report.text",
        "bemcontact.report.cases_text",
        "bemcontact.report.path_text",
        "bemcontact.report.reproduction_text",
    ),
}
"""Foreign package -> the only rooms that import it."""

SLOW = {"cvxpy", "matplotlib", "numba", "meshio"}
"""Foreign packages that may be imported where they are used: slow ones, and those of the optional extras."""

PRINTERS = ("bemcontact.cli", "bemcontact.terminal")
"""Who may print."""

BACKWARDS = {("bemcontact.contact", "bemcontact.modelling.contact_model")}
"""The one import against the stream, in a method: the waist is where a user reaches for a model, and cvxpy is slow."""

DRAWERS = {"utils", "util", "common", "helpers", "helper", "types", "constants", "misc", "tools"}


def within(name: str, room: str) -> bool:
    return name == room or name.startswith(room + ".")


def imported(statement: ast.AST) -> Iterator[str]:
    """Full names that an import statement reaches for: module, and module.name for each name taken from it."""
    if isinstance(statement, ast.Import):
        yield from (alias.name for alias in statement.names)
    elif isinstance(statement, ast.ImportFrom) and statement.module:
        yield from (f"{statement.module}.{alias.name}" for alias in statement.names)


def imports(tree: ast.Module) -> Iterator[str]:
    for statement in ast.walk(tree):
        yield from imported(statement)


def arrows(name: str, tree: ast.Module) -> Iterator[str]:
    for target in imports(tree):
        for room, forbidden in NEVER.items():
            names = ("bemcontact" if other == "bemcontact" else f"bemcontact.{other}" for other in forbidden)
            if within(name, room) and any(within(target, other) for other in names):
                yield f"{name} imports {target}"


def closed_rooms(name: str, tree: ast.Module) -> Iterator[str]:
    for target in imports(tree):
        for room, allowed in ONLY.items():
            ours = within(target, "bemcontact")
            if within(name, room) and ours and not any(within(target, other) for other in allowed):
                yield f"{name} imports {target}"


def one_home_for_each_foreign_package(name: str, tree: ast.Module) -> Iterator[str]:
    for target in imports(tree):
        homes = HOME.get(target.split(".")[0])
        if homes and not any(within(name, home) for home in homes):
            yield f"{name} imports {target}, whose home is {' or '.join(homes)}"


def no_type_checking_imports(name: str, tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if "TYPE_CHECKING" in (getattr(node, "id", ""), getattr(node, "attr", "")):
            yield f"{name}:{node.lineno} hides an import behind TYPE_CHECKING"  # pyright: ignore


def no_relative_imports(name: str, tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level:
            yield f"{name}:{node.lineno} imports relatively"


def imports_at_the_top(name: str, tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if node in tree.body:
            continue
        for target in imported(node):
            # so that `bemcontact --help` answers without the numerical half
            may = name == "bemcontact" or within(name, "bemcontact.cli")
            late = target.split(".")[0] in SLOW or (may and within(target, "bemcontact"))
            late = late or any(name == start and within(target, end) for start, end in BACKWARDS)
            if not late:
                yield f"{name} imports {target} away from the top"


def no_drawers(name: str, tree: ast.Module) -> Iterator[str]:
    if name.rsplit(".", 1)[-1].strip("_") in DRAWERS:
        yield f"{name}: name a module by the noun it serves"


def public_names_have_docstrings(name: str, tree: ast.Module) -> Iterator[str]:
    def look(node: ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef, path: str) -> Iterator[str]:
        if not ast.get_docstring(node):
            yield f"{path} has no docstring"
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            return
        for child in node.body:
            definition = isinstance(child, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
            if definition and not child.name.startswith("_"):
                yield from look(child, f"{path}.{child.name}")

    yield from look(tree, name)


def only_the_command_line_prints(name: str, tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        printing = isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"
        if printing and name not in PRINTERS:
            yield f"{name}:{node.lineno} prints"


RULES: tuple[Rule, ...] = (
    arrows,
    closed_rooms,
    one_home_for_each_foreign_package,
    no_type_checking_imports,
    no_relative_imports,
    imports_at_the_top,
    no_drawers,
    public_names_have_docstrings,
    only_the_command_line_prints,
)


def import_graph(modules: dict[str, ast.Module]) -> dict[str, set[str]]:
    """Module -> modules of ours that it imports, at the top or late, but for the one against the stream."""
    arrows = {
        name: {
            target if target in modules else target.rsplit(".", 1)[0]
            for target in imports(tree)
            if within(target, "bemcontact")
        }
        for name, tree in modules.items()
    }
    return {name: {end for end in ends if (name, end) not in BACKWARDS} for name, ends in arrows.items()}


def cycle(graph: dict[str, set[str]]) -> list[str]:
    """Names on a ring of imports, or nothing: modules that import nobody left are taken away until none is."""
    left = {name: targets & graph.keys() for name, targets in graph.items()}
    while free := [name for name, targets in left.items() if not targets]:
        left = {name: targets - set(free) for name, targets in left.items() if name not in free}
    return sorted(left)


def modules_of_the_package() -> dict[str, ast.Module]:
    modules = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = ("bemcontact", *path.relative_to(PACKAGE).with_suffix("").parts)
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        modules[name] = ast.parse(path.read_text(encoding="utf-8"), filename=str(path))
    return modules


MODULES = modules_of_the_package()


def test_the_whole_package_is_looked_at():
    assert {"bemcontact", "bemcontact.contact", "bemcontact.bem.kernels", "bemcontact.cli"} <= MODULES.keys()


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_the_package_keeps_the_rule(rule: Rule):
    assert [text for name, tree in MODULES.items() for text in rule(name, tree)] == []


def test_no_ring_of_imports():
    assert cycle(import_graph(MODULES)) == []


BAD = [
    (arrows, "bemcontact.bem.system", "from bemcontact.formulations import qp3"),
    (arrows, "bemcontact.bem.mesh", "import bemcontact.analysis"),
    (arrows, "bemcontact.formulations.qp3", "def f():\n    from bemcontact.bem.mesh import Mesh"),
    (arrows, "bemcontact.assessment.residual", "from bemcontact.problem.problem import Problem"),
    (arrows, "bemcontact.assessment.residual", "from bemcontact import spec"),
    (arrows, "bemcontact.bem.condense", "from bemcontact.solution import ContactSolution"),
    (arrows, "bemcontact.report.text", "from bemcontact.analysis import solve"),
    (arrows, "bemcontact.assessment.footprint", "from bemcontact.reference import expected"),
    (arrows, "bemcontact.formulations.qp3", "import bemcontact.reference.scoring"),
    (closed_rooms, "bemcontact.problem.reference", "from bemcontact.reference.closed_forms import HertzContact"),
    (closed_rooms, "bemcontact.problem.reference", "from bemcontact.contact import CondensedContact"),
    (closed_rooms, "bemcontact.reference.evaluation", "from bemcontact.analysis import condense"),
    (closed_rooms, "bemcontact.reference.scoring", "from bemcontact.assessment.certificate import certify"),
    (closed_rooms, "bemcontact.errors", "from bemcontact.solution import Status"),
    (closed_rooms, "bemcontact.choices", "from bemcontact.contact import Array"),
    (closed_rooms, "bemcontact.formulations.local_solver.phase1", "from bemcontact.solution import Status"),
    (closed_rooms, "bemcontact.contact", "import bemcontact.bem"),
    (closed_rooms, "bemcontact.contact", "from bemcontact.solution import Status"),
    (one_home_for_each_foreign_package, "bemcontact.problem.problem", "import yaml"),
    (one_home_for_each_foreign_package, "bemcontact.formulations.scaling", "import cvxpy as cp"),
    (one_home_for_each_foreign_package, "bemcontact.analysis", "from matplotlib.figure import Figure"),
    (one_home_for_each_foreign_package, "bemcontact.report.figures", "from rich.table import Table"),
    (one_home_for_each_foreign_package, "bemcontact.bem.kernels", "def f():\n    import numba"),
    (one_home_for_each_foreign_package, "bemcontact.cli", "def f():\n    import meshio"),
    (no_type_checking_imports, "bemcontact.spec", "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    pass"),
    (no_relative_imports, "bemcontact.bem.mesh", "from . import kernels"),
    (imports_at_the_top, "bemcontact.bem.mesh", "def f():\n    import numpy"),
    (imports_at_the_top, "bemcontact.spec", "try:\n    import numpy\nexcept ImportError:\n    pass"),
    (imports_at_the_top, "bemcontact.cli", "def f():\n    import numpy"),
    (imports_at_the_top, "bemcontact.solution", "def f():\n    from bemcontact.modelling import contact_model"),
    (no_drawers, "bemcontact.bem.utils", ""),
    (no_drawers, "bemcontact.bem._types", ""),
    (public_names_have_docstrings, "bemcontact.bem.mesh", "x = 1"),
    (public_names_have_docstrings, "bemcontact.bem.mesh", "'A mesh.'\nclass Mesh:\n    'All.'\n    def f(self): ..."),
    (only_the_command_line_prints, "bemcontact.bem.mesh", "def f():\n    print(1)"),
]  # fmt: skip


@pytest.mark.parametrize(("rule", "name", "snippet"), BAD)
def test_each_rule_can_be_broken(rule: Rule, name: str, snippet: str):
    assert list(rule(name, ast.parse(snippet)))


GOOD = [
    (arrows, "bemcontact.analysis", "from bemcontact.bem import mesh\nfrom bemcontact.formulations import qp3"),
    (closed_rooms, "bemcontact.formulations.local_solver.phase1", "from bemcontact.errors import SolverError"),
    (closed_rooms, "bemcontact.reference.scoring", "from bemcontact.assessment.footprint import Footprint"),
    (one_home_for_each_foreign_package, "bemcontact.report.figures", "from matplotlib.figure import Figure"),
    (imports_at_the_top, "bemcontact.formulations.qp3", "def f():\n    import cvxpy as cp"),
    (imports_at_the_top, "bemcontact.cli", "def f():\n    from bemcontact import analysis"),
    (imports_at_the_top, "bemcontact.contact", "def f():\n    from bemcontact.modelling import contact_model"),
    (public_names_have_docstrings, "bemcontact.bem.mesh", "'A mesh.'\ndef _f(): ..."),
    (only_the_command_line_prints, "bemcontact.cli", "print(1)"),
]  # fmt: skip


@pytest.mark.parametrize(("rule", "name", "snippet"), GOOD)
def test_no_rule_is_broken_by_what_is_right(rule: Rule, name: str, snippet: str):
    assert list(rule(name, ast.parse(snippet))) == []


def test_a_ring_is_found():
    sources = {
        "bemcontact.a": "from bemcontact.b import f",
        "bemcontact.b": "def f():\n    import bemcontact.c",
        "bemcontact.c": "from bemcontact import a",
        "bemcontact.d": "from bemcontact import a",
        "bemcontact.e": "import numpy",
    }
    graph = import_graph({name: ast.parse(text) for name, text in sources.items()})
    assert cycle(graph) == ["bemcontact.a", "bemcontact.b", "bemcontact.c", "bemcontact.d"]
