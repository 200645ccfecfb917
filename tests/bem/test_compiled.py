"""Machine code and NumPy set up the same equations; without numba, NumPy is used.

In a fresh tree numba compiles for about 20 s, so that tests of compiled code are slow. Its source is run as Python too.
"""

import dataclasses
import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bodies import MESHES, arc, even, mesh_of, rectangle, segment, solved, system_of, values_of, without_rigid_motion

import bemcontact
from bemcontact import compilation, threads
from bemcontact.adaptivity.mesh_sizes import first_mesh
from bemcontact.bem import system as system_module
from bemcontact.bem.condense import condense, condensed
from bemcontact.bem.discretization import body_of
from bemcontact.bem.rigid_motions import free_rigid_motions
from bemcontact.bem.solution import assemble, residual
from bemcontact.bem.system import BY_NUMBA, WORTH_COMPILING, System, machine_code
from bemcontact.problems.material import Material

MATERIAL = Material(young_modulus=1000, poisson_ratio=0.3)
STRESS = np.array([[3.0, 1.2], [1.2, -2.0]])
STRAIN = (STRESS - 0.3 * np.trace(STRESS) * np.eye(2)) / (2 * MATERIAL.shear_modulus)
"""Plane strain: 2Gε = σ - ν tr(σ) 1."""

GRADED = np.append(0, np.cumsum(1.05 ** np.arange(100.0))) / np.sum(1.05 ** np.arange(100.0))
"""Element ends with lengths from 1 to 125."""
HALF = np.geomspace(1, 1e9, 15)
SHORT = np.append(0, np.cumsum(np.concatenate([HALF, HALF[::-1]]))) / (2 * HALF.sum())
"""Element ends with lengths from 1 to 1e9, short at both ends."""

BODIES = MESHES | {
    "straight": [rectangle(2, 1, even(60), even(30))],
    "curved": [[("c", arc((0, 0), 1, 0, 360), even(150))]],
    "graded": [[("flat", segment((-1, 0), (1, 0)), GRADED), ("arc", arc((0, 0), 1, 0, 180), GRADED)]],
    "two loops": [rectangle(2, 1, even(40), even(20)), [("hole", arc((1, 0.5), 0.3, 360, 0), even(40))]],
    "short elements at corners": [rectangle(2, 1, SHORT, SHORT)],
}

MODELS = Path(__file__).parents[2] / "models"
OF_ONE_BODY = [path for path in sorted(MODELS.rglob("*.yaml")) if "\nbodies:" not in path.read_text(encoding="utf-8")]
OF_SEVERAL_BODIES = [path for path in sorted(MODELS.rglob("*.yaml")) if path not in OF_ONE_BODY]
SHIPPED = [path.relative_to(MODELS).with_suffix("").as_posix() for path in OF_ONE_BODY]


def displacement(points):
    return points @ STRAIN.T


def traction(points, normals):
    return normals @ STRESS


@pytest.fixture
def without_numba(monkeypatch):
    """Let every import of numba fail."""
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.delitem(sys.modules, "bemcontact.bem.compiled", raising=False)
    machine_code.cache_clear()
    yield
    machine_code.cache_clear()


@pytest.fixture
def without_compilation(monkeypatch):
    """The functions that numba compiles run as Python, which takes no seconds at first, but long for many elements."""
    name = "bemcontact.bem.compiled"
    found = importlib.util.find_spec(name)
    module = importlib.util.module_from_spec(found)
    monkeypatch.setattr("numba.njit", lambda function, **_: function)
    found.loader.exec_module(module)
    monkeypatch.setitem(sys.modules, name, module)
    machine_code.cache_clear()
    with np.errstate(divide="ignore", invalid="ignore"):  # at points on an element, whose sums are replaced
        yield
    machine_code.cache_clear()


def of_body(loops, fixed):
    """A body under constant stress, on whose edges in `fixed` displacement is prescribed."""
    mesh = mesh_of(*loops)
    values = values_of(mesh, fixed, displacement, traction)
    return system_of(mesh, MATERIAL, values, free_rigid_motions(mesh, values))


def of_model(name, refine=1):
    """A shipped model on its stated mesh, refined."""
    body = body_of(bemcontact.load(MODELS / f"{name}.yaml", variant="stated mesh").refined(refine))
    return System(
        mesh=body.mesh, material=body.problem.material, points=body.points.unit_pressures[0],
        motions=body.motions[0],
        loadings=body.loadings,
    )  # fmt: skip


def both_ways(system):
    """The system by machine code, and by NumPy."""
    by_code, by_numpy = (dataclasses.replace(system, by_numba=by_numba) for by_numba in (True, False))
    assert by_code.machine_code is not None
    assert by_numpy.machine_code is None
    return by_code, by_numpy


def ensure_the_same(system):
    """Matrix and each right side agree to 1e-13 of the largest entry, for both are right to that."""
    (A, b), (other, d) = map(assemble, both_ways(system))
    assert A.flags.f_contiguous
    assert b.flags.f_contiguous
    assert np.isfinite(other).all()
    assert abs(A - other).max() <= 1e-13 * abs(other).max()
    assert (abs(b - d).max(axis=0) <= 1e-13 * abs(d).max(axis=0)).all()


@pytest.mark.usefixtures("without_compilation")
@pytest.mark.parametrize("axes", ["", "xy"])
@pytest.mark.parametrize("name", [name for name in MESHES if name != "ligament of 0.01"])
def test_the_source_of_the_machine_code_and_numpy_agree(name, axes):
    """What is compiled is right before it is compiled; few elements, as Python runs it."""
    first, *_ = mesh_of(*MESHES[name]).edge_names
    ensure_the_same(of_body(MESHES[name], {first: axes} if axes else {}))


@pytest.mark.slow
@pytest.mark.parametrize("refine", [1, 2])
@pytest.mark.parametrize("name", SHIPPED)
def test_machine_code_and_numpy_agree_on_shipped_models(name, refine):
    """They have contact, supports, symmetry, corners, cracks, several loops, tools and load cases."""
    ensure_the_same(of_model(name, refine))


@pytest.mark.slow
@pytest.mark.parametrize("path", OF_SEVERAL_BODIES, ids=lambda path: path.stem)
def test_machine_code_and_numpy_agree_on_each_of_several_bodies(path):
    """Their mesh is the first of a search: no model of several bodies states one."""
    for part in condensed(first_mesh(bemcontact.load(path))).parts:
        ensure_the_same(part.system)


@pytest.mark.slow
@pytest.mark.parametrize("axes", ["", "x", "y", "xy"])
@pytest.mark.parametrize("name", BODIES)
def test_machine_code_and_numpy_agree(name, axes):
    """Nothing is fixed, or one edge; where two edges with different axes meet, a point may have one equation."""
    first, *_ = mesh_of(*BODIES[name]).edge_names
    ensure_the_same(of_body(BODIES[name], {first: axes} if axes else {}))


@pytest.mark.slow
@pytest.mark.parametrize(
    "fixed", [{"bottom": "xy", "left": "xy"}, {"bottom": "y", "left": "x"}, {"bottom": "xy", "right": "x", "left": "y"}]
)
def test_machine_code_and_numpy_agree_where_fixed_edges_meet(fixed):
    ensure_the_same(of_body(BODIES["straight"], fixed))
    ensure_the_same(of_body(BODIES["plate with a hole"], fixed | {"hole": "xy"}))


@pytest.mark.slow
@pytest.mark.parametrize("size", [16, 32, 64, 128])
def test_blocks_of_all_sizes_agree(size, monkeypatch):
    assert machine_code() is not None
    monkeypatch.setattr(sys.modules["bemcontact.bem.compiled"], "block_size", lambda _: size)
    ensure_the_same(of_body(BODIES["two loops"], {"bottom": "xy"}))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["slit_closure", "gallery/body_between_two_tools", "gallery/flat_punch"])
def test_residual_of_rows_computed_anew_is_that_of_the_matrix(name, monkeypatch):
    monkeypatch.setattr("bemcontact.bem.solution.POINTS_OF_RESIDUAL", 37)
    random = np.random.default_rng(1)
    for system in both_ways(of_model(name)):
        A, b = assemble(system)
        x, weights = random.standard_normal((system.size, 3)), random.standard_normal((b.shape[1], 3))
        expected = b @ weights - A @ x
        assert abs(residual(system, x, weights) - expected).max() <= 1e-13 * abs(expected).max()


@pytest.mark.slow
def test_short_elements_keep_their_digits_by_machine_code():
    """F u = 0 for translations, with the same accuracy in the rows of the shortest elements as elsewhere."""
    for turn in (0.0, 0.5):
        ends, z = SHORT, np.exp(1j * turn)
        x, y = np.array([z.real, z.imag]), np.array([-z.imag, z.real])
        corners = [0 * x, 2 * x, 2 * x + y, y]
        names = ("bottom", "right", "top", "left")
        loop = [(name, segment(corners[k - 4], corners[k - 3]), ends) for k, name in enumerate(names)]
        system = dataclasses.replace(of_body([loop], {}), by_numba=True)
        unknowns = system.unknowns.size
        A = assemble(system)[0][:unknowns, :unknowns]
        for axis in range(2):
            assert abs(A[:, system.unknowns.displacement[:, axis]].sum(axis=1)).max() < 1e-14


def test_machine_code_is_used_where_it_pays(monkeypatch):
    small, large = (of_body([[("c", arc((0, 0), 1, 0, 360), even(n))]], {}) for n in (8, WORTH_COMPILING // 4))
    assert small.machine_code is None
    assert small.notes == ()
    assert large.machine_code is not None
    assert large.notes == (BY_NUMBA,)
    assert dataclasses.replace(large, by_numba=False).machine_code is None
    monkeypatch.setattr(compilation, "numba_is_imported", lambda: True)
    assert dataclasses.replace(small).machine_code is not None


@pytest.mark.slow
@pytest.mark.parametrize("first", ["pass", "import numba"])
def test_a_large_body_changes_no_digit_of_the_next(first):
    """Numba is used for the small one if it was imported before both, and not because the large one needed it."""
    code = f"""
{first}
from bemcontact.bem.system import machine_code
from bemcontact.compilation import numba_is_imported
assert numba_is_imported() or machine_code()
print(numba_is_imported())
"""
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=100)
    assert out.stdout.strip() == str(first != "pass")


@pytest.mark.slow
def test_result_notes_that_machine_code_was_used(monkeypatch):
    problem = bemcontact.load(MODELS / "cylinder_on_plane.yaml", variant="stated mesh")
    assert BY_NUMBA not in condense(body_of(problem)).contact.notes
    monkeypatch.setattr(compilation, "numba_is_imported", lambda: True)
    assert condense(body_of(problem)).contact.notes[-1] == BY_NUMBA


@pytest.mark.usefixtures("without_numba")
def test_numpy_is_used_without_numba():
    wanting = dataclasses.replace(of_model("slit_closure"), by_numba=True)
    assert wanting.machine_code is None
    assert wanting.notes == ()
    for one, other in zip(assemble(wanting), assemble(dataclasses.replace(wanting, by_numba=False)), strict=True):
        assert (one == other).all()


def test_machine_code_that_cannot_be_cached_is_compiled_again(monkeypatch):
    """Numba refuses to cache where it finds no directory to write to."""

    def njit(function, *, cache=False, **_):
        if cache:
            raise RuntimeError("cannot cache function: no locator available")
        return function

    assert machine_code() is not None
    monkeypatch.setattr(sys.modules["numba"], "njit", njit)
    assert compilation.compiled()(displacement) is displacement


@pytest.mark.slow
@pytest.mark.parametrize("fixed", [{}, {"left": "xy"}, {"bottom": "y", "left": "x"}])
def test_constant_stress_is_exact_by_machine_code(fixed, monkeypatch):
    """The patch test, with numba chosen by default."""
    mesh = mesh_of(rectangle(2, 1, GRADED, even(40)))
    monkeypatch.setattr(system_module, "WORTH_COMPILING", mesh.degrees_of_freedom)
    u, t, system = solved(mesh, MATERIAL, values_of(mesh, fixed, displacement, traction))
    assert system.machine_code is not None
    du = u - displacement(mesh.nodes)
    du = without_rigid_motion(mesh, du) if len(system.motions) else du
    dt = t - traction(mesh.nodes[mesh.elements], mesh.normals)
    of_stress = np.sqrt(np.sum(mesh.tributary[..., None] * dt**2) / np.sum(mesh.tributary)) / abs(STRESS).max()
    assert abs(du).max() / abs(displacement(mesh.nodes)).max() < 1e-12
    assert of_stress < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("way", [0, 1])
def test_both_take_as_many_threads_as_the_environment_says(monkeypatch, way):
    """Workers of a study have one processor each."""
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    monkeypatch.setattr(threads, "ThreadPoolExecutor", None)
    assemble(both_ways(of_body(BODIES["two loops"], {}))[way])
