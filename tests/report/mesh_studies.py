"""Mesh studies of all kinds that a page and its pictures have to show; each is made once."""

from functools import cache

from bemcontact.analysis import compare as comparing
from bemcontact.analysis.mesh_study import MeshStudy
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.options import ComparisonOptions
from bemcontact.problems import Problem

JUDGED = {"accuracy": 0.01, "mesh": {"adapt": False}}
"""A mesh is taken as it is stated, and its errors are estimated and judged."""


def block(**changes: object) -> Problem:
    """A block on a table under pressure 3, so that 3 is its contact pressure; contact alone keeps it from sinking."""
    corners = {"bottom": ([0, 0], 4), "right": ([40, 0], 2), "top": ([40, 20], 4), "left": ([0, 20], 2)}
    edges = [{"name": name, "start": start, "elements": parts} for name, (start, parts) in corners.items()]
    plane = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    stated = {
        "name": "block <on> a table & more",
        "accuracy": None,
        "units": {"length": "mm", "force": "N"},
        "material": {"young_modulus": 210e3, "poisson_ratio": 0.3},
        "boundary": {"outer": edges},
        "conditions": {"left": {"displacement": {"x": 0}}, "top": {"pressure": 3}},
        "contact_zones": {"foot": {"edges": "bottom", "surface": plane}},
        "reference": {
            "theory": {"kind": "uniform", "pressure": 3},
            "Hertz": {"kind": "hertz", "load": 60, "radius": 0.01, "half": True},
        },
        **JUDGED,
    }
    return Problem(**{**stated, **changes})  # pyright: ignore


def roller(**changes: object) -> Problem:
    """A quarter of a cylinder pressed on a plane, with contact that ends within the zone."""
    arc = {"kind": "arc", "center": [0, 8], "radius": 8}
    edges = [
        {**arc, "name": "under", "angles": [-90, -60], "elements": 8},
        {**arc, "name": "flank", "angles": [-60, 0], "elements": 4},
        {"name": "top", "elements": 3},
        {"name": "axis", "start": [0, 8], "end": [0, 0], "elements": 4},
    ]
    plane = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    stated = {
        "name": "roller",
        "accuracy": None,
        "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
        "boundary": {"outer": edges},
        "conditions": {"top": {"pressure": 30}, "axis": {"displacement": {"x": 0}}},
        "contact_zones": {"foot": {"edges": "under", "surface": plane}},
        **JUDGED,
    }
    return Problem(**{**stated, **changes})  # pyright: ignore


def punch(**changes: object) -> Problem:
    """Half of a block on a rigid punch with an edge at (2, 0), where the pressure is infinite; its force is 30."""
    corners = {"under": [0, 0], "beside": [2, 0], "right": [10, 0], "top": [10, 10], "left": [0, 10]}
    plane = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    stated = {
        "name": "block on a punch",
        "units": {"length": "mm", "force": "N"},
        "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
        "boundary": {"outer": [{"name": name, "start": start} for name, start in corners.items()]},
        "conditions": {"left": {"displacement": {"x": 0}}, "top": {"pressure": 3}},
        "contact_zones": {"foot": {"edges": "under", "surface": plane}},
        "reference": {"printed": {"kind": "values", "source": "a table", "peak": 50.0, "resultant": 30.0}},
    }
    return Problem(**{**stated, **changes})  # pyright: ignore


@cache
def with_infinite_peak() -> MeshStudy:
    """The punch, on a mesh that is found and on a finer one."""
    return comparing.mesh_study(ComparisonOptions.of(), punch(), (1, 2))


@cache
def on_a_coarse_mesh() -> MeshStudy:
    """The roller on its stated mesh, whose error is above the accuracy asked."""
    return comparing.mesh_study(ComparisonOptions.of(["qp3"]), roller())


@cache
def on_one_mesh() -> MeshStudy:
    """The block, with three random starts."""
    return comparing.mesh_study(ComparisonOptions.of(starts=3), block())


@cache
def on_three_meshes() -> MeshStudy:
    """The roller, with two random starts."""
    return comparing.mesh_study(ComparisonOptions.of(starts=2), roller(), (1, 2, 3))


@cache
def of_many_settings() -> MeshStudy:
    """The roller beside Hertz, with weights that are refused, and with which QP2 ends far from the contact state."""
    hertz = {"kind": "hertz", "load": 480, "radius": 8, "half": True}
    plan = ComparisonOptions.of(weights=["tributary", "consistent"], penalties=[1.0, 1e3])
    return comparing.mesh_study(plan, roller(reference={"Hertz": hertz}))


@cache
def without_a_body() -> MeshStudy:
    """Three points, of which two touch; no boundary stands behind them."""
    compliance = [[2.0, 0.5, 0.0], [0.5, 2.0, 0.5], [0.0, 0.5, 2.0]]
    return comparing.mesh_study(ComparisonOptions.of(), CondensedContact.from_compliance(compliance, [-1.0, -0.5, 1.0]))


@cache
def without_contact() -> MeshStudy:
    """Three points, none of which touches."""
    compliance = [[2.0, 0.5, 0.0], [0.5, 2.0, 0.5], [0.0, 0.5, 2.0]]
    return comparing.mesh_study(ComparisonOptions.of(), CondensedContact.from_compliance(compliance, [1.0, 0.5, 1.0]))


@cache
def not_unique() -> MeshStudy:
    """Two points, of which each holds the body without the other: pressures (1, 0), (0, 1) and both together."""
    contact = CondensedContact.from_compliance([[1.0, 2.0], [2.0, 1.0]], [-1.0, -1.0])
    return comparing.mesh_study(ComparisonOptions.of(["qp1", "qp2"]), contact)


ALL = (
    on_one_mesh, on_three_meshes, of_many_settings, without_a_body, without_contact, not_unique, with_infinite_peak,
    on_a_coarse_mesh,
)  # fmt: skip
