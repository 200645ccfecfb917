"""The shipped problems are found in a source tree and in an installed package alike."""

import tomllib
from pathlib import Path

import pytest

from bemcontact import SpecError, loads
from bemcontact.analysis import reproduction

ROOT = Path(__file__).parents[2]


def test_the_text_is_that_of_the_file():
    stated = (ROOT / "models" / "cylinder_on_plane.yaml").read_text(encoding="utf-8")
    assert reproduction.shipped_model("cylinder_on_plane") == stated
    assert loads(stated).name == "cylinder on a plane"


def test_an_installed_package_has_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """As a wheel is laid out; what stands beside the package is somebody else's."""
    for folder, text in (("site/bemcontact/models", "own"), ("site/models", "foreign")):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "block.yaml").write_text(text, encoding="utf-8")
    monkeypatch.setattr(reproduction, "files", lambda _: tmp_path / "site" / "bemcontact")
    assert reproduction.shipped_model("block") == "own"


def test_the_wheel_has_the_models_where_they_are_looked_for():
    wheel = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]["build"]["targets"][
        "wheel"
    ]
    assert wheel == {
        "only-include": ["bemcontact", "models"],
        "sources": {"models": f"bemcontact/{reproduction.FOLDER}"},
    }
    assert not (ROOT / "bemcontact" / reproduction.FOLDER).exists()


def test_a_name_that_does_not_exist_is_reported():
    with pytest.raises(SpecError, match=r"models/none\.yaml is not where bemcontact is installed"):
        reproduction.shipped_model("none")
