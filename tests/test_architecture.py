"""The rules of the house: who may import whom and where, what every public name owes, where tests stand."""

import ast
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
PACKAGE = TESTS.parent / "bemcontact"

Rule = Callable[[str, ast.Module], Iterator[str]]

FOUNDATION = (
    "cached", "frozen", "errors", "checks", "arrays", "interrupts", "threads", "compilation", "serialization",
    "options", "version", "files", "views",
)  # fmt: skip

ROOMS = {
    "cached": (),
    "frozen": (),
    "errors": ("frozen",),
    "checks": ("errors",),
    "arrays": ("errors", "checks"),
    "interrupts": (),
    "threads": (),
    "compilation": ("errors",),
    "serialization": ("errors", "checks"),
    "options": ("frozen", "errors", "checks"),
    "version": (),
    "views": (),
    "files": ("errors",),
    "problems": ("cached", "frozen", "errors", "checks", "arrays", "options", "views"),
    "spec": ("frozen", "errors", "checks", "arrays", "files", "problems"),
    "contact": (*FOUNDATION,),
    "bem": (*FOUNDATION, "problems", "contact"),
    "formulations.local_solver": ("cached", "frozen", "errors", "checks", "arrays", "threads", "compilation"),
    "formulations": (*FOUNDATION, "contact", "formulations.local_solver"),
    "assessment": (*FOUNDATION, "contact"),
    "adaptivity": (*FOUNDATION, "problems", "contact", "bem", "formulations", "assessment"),
    "parametric": (*FOUNDATION, "contact", "formulations", "assessment"),
    "modelling": (*FOUNDATION, "contact", "formulations", "assessment"),
    "reference": (*FOUNDATION, "problems", "contact", "assessment"),
    "analysis": (
        *FOUNDATION, "problems", "spec", "contact", "bem", "formulations", "assessment", "adaptivity", "parametric",
        "modelling", "reference",
    ),
    "studies": (*FOUNDATION, "problems", "spec", "contact", "bem", "assessment", "adaptivity", "analysis"),
    "report": (
        *FOUNDATION, "problems", "contact", "assessment", "adaptivity", "parametric", "modelling", "reference",
        "analysis", "studies",
    ),
    "runs": (*FOUNDATION, "problems", "analysis", "studies", "report"),
    "cli": (*FOUNDATION, "problems", "spec", "analysis", "studies", "report", "runs"),
    "__main__": ("cli",),
}  # fmt: skip
"""Room -> the rooms that it may import, besides itself. A room stands below all that may import it."""

EXCEPTIONS = {
    ("report.figures", "bem.mesh"): "figures draw elements",
    ("report.figures", "bem.boundary_values"): "figures draw what is prescribed on elements, and how they move",
    ("modelling", "problems.surface_lines"): "a designed gap is written as a rigid surface of a spec",
}
"""(Who imports, what) -> why. There is no other exception to `ROOMS`."""

HOME = {
    "yaml": ("bemcontact.spec",),
    "cvxpy": (
        "bemcontact.formulations.clarabel",
        "bemcontact.formulations.piqp",
        "bemcontact.formulations.qp3",
        "bemcontact.modelling",
    ),
    "clarabel": ("bemcontact.formulations.clarabel",),
    "matplotlib": ("bemcontact.report.figures",),
    "typer": ("bemcontact.cli",),
    "numba": ("bemcontact.compilation",),
    "meshio": ("bemcontact.report.vtk",),
    "jinja2": ("bemcontact.report.page",),
    "rich": (
        "bemcontact.cli.terminal",
        "bemcontact.report.tables",
        "bemcontact.report.text",
        "bemcontact.report.problem_text",
        "bemcontact.report.comparison_text",
        "bemcontact.report.path_text",
        "bemcontact.report.reproduction",
        "bemcontact.report.study_page",
    ),
    "distributed": ("bemcontact.studies.cluster",),
    "pyarrow": ("bemcontact.studies.table",),
}
"""Foreign package -> the only rooms that import it."""

SLOW = {"cvxpy", "clarabel", "matplotlib", "numba", "meshio", "distributed", "pyarrow"}
"""Foreign packages that may be imported where they are used: slow ones, solvers, and those of the optional extras."""

LATE = {
    ("bem.discretization", "bem.deflected_contours"): "only these need equations, and check starts without",
    ("analysis.result", "analysis.stress_of_bodies"): "stress is computed if it is asked for, and solve starts without",
    ("analysis.result", "analysis.stress_bars"): "likewise",
    ("runs.study", "report.folder"): "pictures are drawn at the end, and workers start without",
}
"""(Who imports, what) -> why the import stands where it is used. The command line imports all other rooms so."""

PRINTERS = ("bemcontact.cli",)
"""Who may print."""

DRAWERS = {"utils", "util", "common", "helpers", "helper", "types", "constants", "misc"}


def within(name: str, room: str) -> bool:
    return name == room or name.startswith(room + ".")


def imported(statement: ast.AST) -> Iterator[str]:
    """Full names that an import statement reaches for: module, and module.name for each name taken from it."""
    if isinstance(statement, ast.Import):
        yield from (alias.name for alias in statement.names)
    elif isinstance(statement, ast.ImportFrom) and statement.module:
        yield from (f"{statement.module}.{alias.name}" for alias in statement.names)


@cache
def nodes(tree: ast.Module) -> tuple[ast.AST, ...]:
    """All parts of a module, which one rule after another looks at."""
    return tuple(ast.walk(tree))


def imports(tree: ast.Module) -> Iterator[str]:
    for statement in nodes(tree):
        yield from imported(statement)


def room_of(module: str) -> str:
    """Name of the innermost room in which a module of ours stands; of `bemcontact` itself, nothing."""
    parts = module.split(".")[1:]
    names = (".".join(parts[:n]) for n in range(len(parts), 0, -1))
    return next((name for name in names if name in ROOMS), ".".join(parts[:1]))


def arrows(name: str, tree: ast.Module) -> Iterator[str]:
    """Imports at the top and inside functions alike."""
    here = room_of(name)
    for target in imports(tree):
        if not within(target, "bemcontact") or name == "bemcontact":
            continue
        there = room_of(target)
        excepted = any(
            within(name, f"bemcontact.{start}") and within(target, f"bemcontact.{end}") for start, end in EXCEPTIONS
        )
        if there != here and there not in ROOMS.get(here, ()) and not excepted:
            yield f"{name} imports {target}"


def one_home_for_each_foreign_package(name: str, tree: ast.Module) -> Iterator[str]:
    for target in imports(tree):
        homes = HOME.get(target.split(".")[0])
        if homes and not any(within(name, home) for home in homes):
            yield f"{name} imports {target}, whose home is {' or '.join(homes)}"


def no_type_checking_imports(name: str, tree: ast.Module) -> Iterator[str]:
    for node in nodes(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            hidden = (part for part in ast.walk(node) if isinstance(part, ast.Import | ast.ImportFrom))
            yield from (f"{name}:{part.lineno} hides an import behind TYPE_CHECKING" for part in hidden)


def no_relative_imports(name: str, tree: ast.Module) -> Iterator[str]:
    for node in nodes(tree):
        if isinstance(node, ast.ImportFrom) and node.level:
            yield f"{name}:{node.lineno} imports relatively"


def imports_at_the_top(name: str, tree: ast.Module) -> Iterator[str]:
    for node in nodes(tree):
        if node in tree.body:
            continue
        for target in imported(node):
            # so that `bemcontact --help` answers without the numerical half, and an interrupt of it without a traceback
            may = within(name, "bemcontact.cli") or name == "bemcontact.__main__"
            declared = any(name == f"bemcontact.{start}" and within(target, f"bemcontact.{end}") for start, end in LATE)
            late = target.split(".")[0] in SLOW or declared or (may and within(target, "bemcontact"))
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
    for node in nodes(tree):
        printing = isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"
        if printing and not any(within(name, room) for room in PRINTERS):
            yield f"{name}:{node.lineno} prints"


RULES: tuple[Rule, ...] = (
    arrows,
    one_home_for_each_foreign_package,
    no_type_checking_imports,
    no_relative_imports,
    imports_at_the_top,
    no_drawers,
    public_names_have_docstrings,
    only_the_command_line_prints,
)


def import_graph(modules: dict[str, ast.Module]) -> dict[str, set[str]]:
    """Module -> modules of ours that it imports, at the top or inside functions."""
    return {
        name: {
            target if target in modules else target.rsplit(".", 1)[0]
            for target in imports(tree)
            if within(target, "bemcontact")
        }
        for name, tree in modules.items()
    }


def cycle(graph: dict[str, set[str]]) -> list[str]:
    """Names on a ring of imports, or nothing: modules that import nobody left are taken away until none is."""
    left = {name: targets & graph.keys() for name, targets in graph.items()}
    while free := [name for name, targets in left.items() if not targets]:
        left = {name: targets - set(free) for name, targets in left.items() if name not in free}
    return sorted(left)


@cache
def modules_of_the_package() -> dict[str, ast.Module]:
    """Each module by its name, parsed by the first test that asks for them."""
    modules = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = ("bemcontact", *path.relative_to(PACKAGE).with_suffix("").parts)
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        modules[name] = ast.parse(path.read_text(encoding="utf-8"), filename=str(path))
    return modules


def test_the_whole_package_is_looked_at():
    assert {
        "bemcontact",
        "bemcontact.contact.condensed_contact",
        "bemcontact.bem.kernels",
        "bemcontact.cli",
    } <= modules_of_the_package().keys()


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_the_package_keeps_the_rule(rule: Rule):
    assert [text for name, tree in modules_of_the_package().items() for text in rule(name, tree)] == []


def test_no_ring_of_imports():
    assert cycle(import_graph(modules_of_the_package())) == []


ONE_MEANING = {
    **dict.fromkeys(
        ("check", "compare", "condense", "reproduce", "solve", "study", "schema"),
        "a command is named after what it calls",
    ),
    "program_of": "each local formulation states its program",
    "render": "a page, as HTML",
    "save": "into a file or a folder",
    "sensitivities": "of a problem by key, and of a condensed contact problem by change",
}
"""Name of public functions of several modules -> what all of them do."""


def names_of_several_modules(modules: dict[str, ast.Module]) -> set[str]:
    """Names of classes and of public functions that stand in several modules."""
    places: dict[str, set[str]] = {}
    for module, tree in modules.items():
        for node in tree.body:
            public = isinstance(node, ast.FunctionDef) and not node.name.startswith("_")
            if isinstance(node, ast.ClassDef) or public:
                places.setdefault(node.name, set()).add(module)
    return {name for name, where in places.items() if len(where) > 1}


def test_no_name_means_two_things():
    assert names_of_several_modules(modules_of_the_package()) == ONE_MEANING.keys()


def test_a_name_of_several_modules_is_found():
    sources = {
        "a": "class _E: ...\ndef f(): ...\ndef _g(): ...",
        "b": "class _E: ...\ndef _g(): ...",
        "c": "def f(): ...",
    }
    assert names_of_several_modules({name: ast.parse(text) for name, text in sources.items()}) == {"_E", "f"}


BAD = [
    (arrows, "bemcontact.bem.system", "from bemcontact.formulations import qp3"),
    (arrows, "bemcontact.bem.mesh", "import bemcontact.analysis"),
    (arrows, "bemcontact.formulations.qp3", "def f():\n    from bemcontact.bem.mesh import Mesh"),
    (arrows, "bemcontact.assessment.residual", "from bemcontact.problems.problem import Problem"),
    (arrows, "bemcontact.assessment.residual", "from bemcontact import spec"),
        (arrows, "bemcontact.analysis.solve", "from bemcontact.report.text import result_summary"),
    (arrows, "bemcontact.assessment.footprint", "from bemcontact.reference import expected"),
    (arrows, "bemcontact.formulations.qp3", "import bemcontact.reference.scoring"),
    (arrows, "bemcontact.problems.reference", "from bemcontact.reference.closed_forms import HertzContact"),
    (arrows, "bemcontact.problems.reference", "from bemcontact.contact.condensed_contact import CondensedContact"),
    (arrows, "bemcontact.reference.evaluation", "from bemcontact.analysis import condense"),
    (arrows, "bemcontact.errors", "from bemcontact.contact.solution import Status"),
    (arrows, "bemcontact.options", "from bemcontact.contact.condensed_contact import CondensedContact"),
    (arrows, "bemcontact.formulations.local_solver.phase1", "from bemcontact.contact.solution import Status"),
    (arrows, "bemcontact.contact", "import bemcontact.bem"),
    (arrows, "bemcontact.contact.condensed_contact", "def f():\n    from bemcontact.modelling import contact_model"),
    (arrows, "bemcontact.report.page", "from bemcontact.bem.mesh import Mesh"),
    (one_home_for_each_foreign_package, "bemcontact.problems.problem", "import yaml"),
    (one_home_for_each_foreign_package, "bemcontact.formulations.scaling", "import cvxpy as cp"),
    (one_home_for_each_foreign_package, "bemcontact.analysis", "from matplotlib.figure import Figure"),
    (one_home_for_each_foreign_package, "bemcontact.report.figures", "from rich.table import Table"),
    (one_home_for_each_foreign_package, "bemcontact.bem.kernels", "def f():\n    import numba"),
    (one_home_for_each_foreign_package, "bemcontact.cli", "def f():\n    import meshio"),
    (no_type_checking_imports, "bemcontact.spec", "import typing\nif typing.TYPE_CHECKING:\n    import numpy"),
    (no_relative_imports, "bemcontact.bem.mesh", "from . import kernels"),
    (imports_at_the_top, "bemcontact.bem.mesh", "def f():\n    import numpy"),
    (imports_at_the_top, "bemcontact.spec", "try:\n    import numpy\nexcept ImportError:\n    pass"),
    (imports_at_the_top, "bemcontact.cli", "def f():\n    import numpy"),
    (imports_at_the_top, "bemcontact.contact.solution", "def f():\n    from bemcontact.modelling import contact_model"),
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
    (arrows, "bemcontact.formulations.local_solver.phase1", "from bemcontact.errors import SolverError"),
    (arrows, "bemcontact.reference.scoring", "from bemcontact.assessment.footprint import Footprint"),
    (one_home_for_each_foreign_package, "bemcontact.report.figures", "from matplotlib.figure import Figure"),
    (imports_at_the_top, "bemcontact.formulations.qp3", "def f():\n    import cvxpy as cp"),
    (imports_at_the_top, "bemcontact.cli", "def f():\n    from bemcontact import analysis"),
    (imports_at_the_top, "bemcontact.bem.discretization", "def f():\n    import bemcontact.bem.deflected_contours"),
    (arrows, "bemcontact.report.figures.problem", "from bemcontact.bem.mesh import Mesh"),
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


BESIDE = {
    "benchmarks": "the code that judges in benchmarks",
    "docs": "the pages and the code that makes them",
    "models": "the shipped problems",
}
"""Folder of tests that mirrors no folder of the package -> what it tests."""

WITHOUT_MODULE = {
    "test_architecture.py": "the package as a whole",
    "test_packaging.py": "the wheel",
    "analysis/test_bonds_in_contact.py": "bonds that meet the outline inside a contact, through all rooms",
    "analysis/test_stress_at_bonds.py": "infinite stress at bonds and contacts of bodies, through all rooms",
    "analysis/test_corners_of_bodies.py": "corners of several bodies, through all rooms",
    "analysis/test_several_bodies.py": "several bodies through all rooms, from spec to result",
    "analysis/test_two_bodies.py": "two elastic bodies against closed forms, through all rooms",
    "cli/test_hostile_input.py": "hidden characters, full disks and little memory, through all rooms",
    "problems/test_range.py": "numbers of any size at any place of a problem",
    "spec/test_limits.py": "the limits of a spec, through reading, document and parser",
    "spec/test_refused_inputs.py": "the page of refused inputs",
    "formulations/local_solver/test_contact_programs.py": "QP1 and QP2 by the local solver alone and by formulations",
    "report/test_browser.py": "the pages of a mesh study and of the reproduction in a browser",
}
"""File of tests that is named after no module -> what it tests."""


def module_of(test: Path) -> Path | None:
    """File of the package that a file of tests is named after: a module, a room, or the room in which it stands."""
    name, room = test.stem.removeprefix("test_"), PACKAGE / test.parent
    places = [room / f"{name}.py", room / name / "__init__.py"]
    if name == room.name:
        places.append(room / "__init__.py")
    return next((place for place in places if place.is_file()), None)


def test_each_file_of_tests_is_named_after_what_it_tests():
    tests = [path.relative_to(TESTS) for path in TESTS.rglob("test_*.py")]
    inside = [test for test in tests if test.parts[0] not in BESIDE]
    assert {test.as_posix() for test in inside if not module_of(test)} == WITHOUT_MODULE.keys()


@pytest.mark.parametrize("name", ["bem/test_nothing.py", "cli/test_bem.py", "test_mesh.py", "bem/test_solve.py"])
def test_a_file_of_tests_without_a_module_is_found(name: str):
    assert module_of(Path(name)) is None


@pytest.mark.parametrize("name", ["bem/test_mesh.py", "cli/test_cli.py", "report/test_figures.py", "test_errors.py"])
def test_a_file_of_tests_may_bear_the_name_of_a_module_or_a_room(name: str):
    assert module_of(Path(name)) is not None
