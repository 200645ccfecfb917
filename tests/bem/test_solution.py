"""The solution of a system satisfies its equations, whether or not a copy of the matrix is kept."""

import platform
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bodies import arc, even, mesh_of, system_of, values_of

from bemcontact.bem import solution
from bemcontact.bem.rigid_motions import RigidMotions
from bemcontact.problems.material import Material


@pytest.mark.parametrize("limit", [0.0, solution.LARGEST_COPY])
def test_refinement_leaves_rounding_only(limit: float, monkeypatch: pytest.MonkeyPatch):
    """Of a matrix that is kept, and of one whose rows are computed anew: A x = b to the rounding of its products."""
    monkeypatch.setattr(solution, "LARGEST_COPY", limit)
    mesh = mesh_of([("hole", arc((0, 0), 1, 360, 0), even(16))])
    values = values_of(mesh, {}, lambda x: 0 * x, lambda x, n: -n * [1, 0])
    none = RigidMotions(coefficients=np.zeros((0, 3)), center=mesh.center, radius=1)
    of_hole = system_of(mesh, Material(young_modulus=1000, poisson_ratio=0.3), values, none)
    A, b = solution.assemble(of_hole)
    x = solution.solve_system(of_hole).combined(np.ones(1))[:, None]
    assert (abs(b - A @ x) <= 4 * len(A) * np.finfo(float).eps * (abs(A) @ abs(x) + abs(b))).all()


FAULTS = """
import resource
import bemcontact
problem = bemcontact.load(MODEL, variant="stated mesh").refined(4)
for _ in range(3):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    bemcontact.condense(problem)
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


@pytest.mark.slow
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="other allocators have other rules")
def test_matrices_take_the_memory_of_those_before():
    """Of 609 unknowns and 178 right sides the arrays have some 2,400 pages, which were new each time."""
    model = Path(__file__).parents[2] / "models" / "cylinder_on_plane.yaml"
    code = FAULTS.replace("MODEL", repr(str(model)))
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert int(printed) < 300
