"""Files that are read: regular ones of limited size; others are refused with a reason."""

import os
from pathlib import Path

import pytest

from bemcontact.errors import SpecError
from bemcontact.files.text import MOST_BYTES, text_of
from bemcontact.plain_text import LINE_BREAKS, hidden_character


def refusal(path: Path | str) -> str:
    with pytest.raises(SpecError) as caught:
        text_of(path)
    assert hidden_character(str(caught.value), LINE_BREAKS) is None
    return str(caught.value)


def test_only_regular_files_are_read(tmp_path: Path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "one").symlink_to("other")
    (tmp_path / "other").symlink_to("one")
    assert "not a regular file" in refusal(tmp_path / "pipe")
    assert "not a regular file" in refusal("/dev/zero")
    assert "directory" in refusal(tmp_path)
    assert "symbolic links" in refusal(tmp_path / "one")
    assert "too long" in refusal("x" * 5000).lower()
    assert "null" in refusal("a\0b")


def test_large_files_are_refused_without_reading_them(tmp_path: Path):
    with open(tmp_path / "large", "wb") as file:
        file.truncate(100 * MOST_BYTES)
    assert "million bytes" in refusal(tmp_path / "large")


def test_only_files_of_similar_names_are_suggested(tmp_path: Path):
    for name in ("roller.yaml", "b.yaml", "notes.txt"):
        (tmp_path / name).touch()
    (tmp_path / "lost.yaml").symlink_to("gone.yaml")
    (tmp_path / "rolle.yaml").mkdir()
    assert "did you mean" in refusal(tmp_path / "rollr.yaml")
    assert "roller.yaml?" in refusal(tmp_path / "roller")
    assert "roller.yaml?" in refusal(tmp_path / "roller.yml")
    assert "did you mean" not in refusal(tmp_path / "a.yaml")
    assert "did you mean" not in refusal(tmp_path / "lose.yaml")
    lost = refusal(tmp_path / "lost.yaml")
    assert "link to gone.yaml, which does not exist" in lost
    assert "did you mean" not in lost
    assert r"a\x1b.yaml" in refusal(tmp_path / "a\x1b.yaml")
