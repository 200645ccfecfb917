"""Folders that several tests read; each is written once, because drawing its pictures takes longest."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from mesh_studies import of_many_settings, on_one_mesh, on_three_meshes, with_infinite_peak
from results import EACH, SPEC

from bemcontact.report import folder

STUDIES = {
    "block": on_one_mesh,
    "meshes": on_three_meshes,
    "settings": of_many_settings,
    "infinite": with_infinite_peak,
}


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The folder of a result or of a mesh study, by its name in `EACH` or in `STUDIES`; tests leave it as it is."""

    @cache
    def write(name: str) -> Path:
        place = tmp_path_factory.mktemp("written") / name
        if name in EACH:
            folder.save_result(EACH[name](), place, SPEC)
        else:
            folder.save(STUDIES[name](), place, SPEC)
        return place

    return write
