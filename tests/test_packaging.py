"""Dependencies: each is declared, and explained in one line; the citation agrees with the package."""

import ast
import re
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
GROUPS = {"Core": PROJECT["dependencies"], **PROJECT["optional-dependencies"]}
EXPLANATION = (ROOT / ".docs" / "explanation" / "dependencies.md").read_text(encoding="utf-8")

PACKAGE_OF = {"yaml": "pyyaml", "pydantic_core": "pydantic"}
"""Module -> the package that brings it, where the names differ. Each pydantic requires one pydantic_core."""


def names(requirements: list[str]) -> list[str]:
    """Names of packages; an extra that names other extras of ours is none."""
    found = [re.match(r"[\w-]+", requirement)[0] for requirement in requirements]
    return [name for name in found if name != PROJECT["name"]]


@pytest.mark.parametrize("group", GROUPS)
def test_each_dependency_has_one_line_that_states_what_it_is_for(group: str):
    _, _, chapter = EXPLANATION.partition(f"\n## {group}\n")
    lines = re.findall(r"^- `([\w-]+)`: \w.*\.$", chapter.partition("\n## ")[0], flags=re.MULTILINE)
    assert sorted(lines) == sorted(names(GROUPS[group]))


@pytest.mark.slow
def test_each_package_that_is_imported_is_declared():
    declared = names([*GROUPS["Core"], *GROUPS["fast"], *GROUPS["vtk"], *GROUPS["dask"], *GROUPS["parquet"]])
    imported = set()
    for path in (ROOT / "bemcontact").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add(node.module.partition(".")[0])
    foreign = imported - sys.stdlib_module_names - {"bemcontact"}
    assert {PACKAGE_OF.get(module, module) for module in foreign} == set(declared)


def test_the_citation_names_this_version():
    citation = yaml.safe_load((ROOT / ".github" / "CITATION.cff").read_text(encoding="utf-8"))
    assert (citation["title"], citation["version"]) == (PROJECT["name"], PROJECT["version"])
    assert citation["license"] == PROJECT["license"]
