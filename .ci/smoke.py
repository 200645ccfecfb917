"""Try the package as it is installed: run this with the Python of the environment, from the top of the tree."""

import json
import pkgutil
import subprocess
import sys
import tempfile
from importlib import import_module, metadata
from pathlib import Path

import bemcontact
from bemcontact.cli import app

CYLINDER, PUNCH = "models/cylinder_on_plane.yaml", "models/gallery/flat_punch.yaml"


def bemcontact_program(*arguments: str | Path, status: int = 0) -> str:
    """Run the program; its exit status must be the one given. What it prints is returned."""
    program = Path(sys.executable).with_name("bemcontact")
    run = subprocess.run([program, *arguments], check=False, capture_output=True, encoding="utf-8", timeout=300)
    assert run.returncode == status, f"{arguments} ended with {run.returncode}, not {status}\n{run.stdout}{run.stderr}"
    return run.stdout


def no_part_is_missing() -> None:
    """Import every module and every public name of the installed package."""
    assert Path(bemcontact.__file__).is_relative_to(sys.prefix), "this is not the installed package"
    for module in pkgutil.walk_packages(bemcontact.__path__, "bemcontact."):
        import_module(module.name)
    assert all(hasattr(bemcontact, name) for name in bemcontact.__all__)


def commands_answer() -> None:
    """Ask for the version, the help of each command and the schema."""
    assert bemcontact_program("--version") == f"bemcontact {metadata.version('bemcontact')}\n"
    for command in app.registered_commands:
        name = command.callback.__name__
        assert f"bemcontact {name} " in bemcontact_program(name, "--help")
    assert json.loads(bemcontact_program("schema"))["properties"]


def problems_are_solved(folder: Path) -> None:
    """Solve shipped models by two formulations, as a cvxpy model and by machine code, and draw them."""
    for formulation in ("qp3", "complementarity"):
        text = bemcontact_program("solve", CYLINDER, "--formulation", formulation, "--json", "-")
        assert json.loads(text)["certified"]
    files = [folder / name for name in ("contact.png", "contact.svg", "contact.vtu", "fine.npz", "report/report.html")]
    png, svg, vtu, npz, page = files
    bemcontact_program("solve", PUNCH, "--figure", png, "--vtk", vtu)
    bemcontact_program("check", PUNCH, "--figure", svg)
    bemcontact_program("compare", PUNCH, "--out", page.parent)
    bemcontact_program("condense", PUNCH, "--refine", "20", "--out", npz)  # large enough for numba
    assert all(file.stat().st_size for file in files)
    assert bemcontact.model(bemcontact.condense(bemcontact.load(PUNCH))).solve().contact_state


def mistakes_are_refused(folder: Path) -> None:
    """Call what does not exist and solve what is wrong: the exit status is 2."""
    wrong = folder / "wrong.yaml"
    wrong.write_text(Path(CYLINDER).read_text(encoding="utf-8").replace("material:", "materail:"), encoding="utf-8")
    bemcontact_program("solve", wrong, status=2)
    bemcontact_program("solve", CYLINDER, "--formulation", "none", status=2)
    bemcontact_program("none", status=2)


if __name__ == "__main__":
    no_part_is_missing()
    commands_answer()
    with tempfile.TemporaryDirectory() as temporary:
        problems_are_solved(Path(temporary))
        mistakes_are_refused(Path(temporary))
    print("The package works as it is installed here.")
