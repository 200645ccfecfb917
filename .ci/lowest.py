"""Print each lower bound of pyproject.toml as a constraint for pip: ``numpy>=2.1`` becomes ``numpy==2.1``."""

import re
import tomllib
from pathlib import Path

project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
for requirement in sum(project["optional-dependencies"].values(), project["dependencies"]):
    if not requirement.startswith(f"{project['name']}["):  # an extra that names other extras
        name, version = re.fullmatch(r"([\w-]+)>=([\d.]+)", requirement).groups()
        print(f"{name}=={version}")
