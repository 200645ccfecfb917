"""A process with the code of one folder: it does what each line of its input asks for, and tells its processor time.

    python speed_of_a_folder.py FOLDER NumPy|numba

A line is a mapping as JSON: `what` is "condense" or "solve", `refine` is the number of parts into which each element of
the stated mesh is cut, and `into` is a file (.npy) for compliance or pressure, or null.
"""

import importlib
import json
import sys
from functools import partial
from pathlib import Path

import numpy as np
from timing import one_turn


def work(folder: Path, code: str) -> None:
    """Do all that is asked for."""
    sys.path.insert(0, str(folder))
    sys.modules["numba"] = importlib.import_module("numba") if code == "numba" else None  # None: as if not installed
    program = importlib.import_module("bemcontact")
    if not Path(program.__file__).is_relative_to(folder):
        raise ImportError(f"bemcontact is that of {program.__file__}, not of {folder}")
    model = program.load(folder / "models" / "cylinder_on_plane.yaml", variant="stated mesh")
    problems = {}
    for line in sys.stdin:
        asked = json.loads(line)
        refine = asked["refine"]
        problem = problems.setdefault(refine, model if refine == 1 else model.refined(refine))
        action = partial(getattr(program, asked["what"]), problem)
        if asked["into"]:
            result = action()
            np.save(asked["into"], result.compliance if asked["what"] == "condense" else result.solution.pressure)
        print(one_turn(action)[0], flush=True)  # here, for a process that waits for a line may lose its caches


if __name__ == "__main__":
    work(Path(sys.argv[1]), sys.argv[2])
