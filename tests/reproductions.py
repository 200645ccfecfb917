"""The problems of the paper on their base meshes, carried out once for all tests, and one that fails."""

from dataclasses import replace
from functools import cache

from bemcontact.analysis.reproduction import PaperStudy, Reproduction, reproduce


@cache
def on_base_meshes() -> Reproduction:
    return reproduce((1,))


def problem(model: str) -> PaperStudy:
    """One of them, by the name of its file."""
    return next(item for item in on_base_meshes().problems if item.paper.model == model)


def of_the_cylinder() -> Reproduction:
    """One problem alone."""
    return replace(on_base_meshes(), problems=(problem("cylinder_on_plane"),))


def with_coarse_mesh_judged() -> Reproduction:
    """The paper's own mesh of the bolt, which misses the references, as if it were the base mesh."""
    bolt = problem("bolt_in_plate")
    coarse = replace(bolt, study=next(iter(bolt.variants.values())), variants={})
    return replace(on_base_meshes(), problems=(problem("cylinder_on_plane"), coarse))
