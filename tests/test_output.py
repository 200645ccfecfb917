"""Files appear whole or not at all."""

import os
from pathlib import Path

import pytest

from bemcontact import output


def test_a_file_appears_when_the_block_ends(tmp_path: Path):
    target = tmp_path / "a.txt"
    with output.whole_file(target) as temporary:
        temporary.write_text("whole", encoding="utf-8")
        assert temporary.parent == tmp_path
        assert not target.exists()
    assert target.read_text(encoding="utf-8") == "whole"
    assert [*tmp_path.iterdir()] == [target]


def test_a_failure_leaves_what_was_there(tmp_path: Path):
    target = tmp_path / "a.txt"
    target.write_text("before", encoding="utf-8")

    def fail_half_way() -> None:
        with output.whole_file(target) as temporary:
            temporary.write_text("half", encoding="utf-8")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail_half_way()
    assert target.read_text(encoding="utf-8") == "before"
    assert [*tmp_path.iterdir()] == [target]


def test_a_link_is_followed(tmp_path: Path):
    target, link = tmp_path / "a.txt", tmp_path / "link.txt"
    target.write_text("before", encoding="utf-8")
    link.symlink_to(target)
    with output.whole_file(link) as temporary:
        temporary.write_text("after", encoding="utf-8")
    assert link.is_symlink()
    assert target.read_text(encoding="utf-8") == "after"


def test_permissions_are_those_of_any_new_file(tmp_path: Path):
    ordinary = tmp_path / "b.txt"
    ordinary.touch()
    with output.whole_file(tmp_path / "a.txt") as temporary:
        temporary.touch()
    assert (tmp_path / "a.txt").stat().st_mode == ordinary.stat().st_mode


def test_a_writable_place_is_left_untouched(tmp_path: Path):
    output.ensure_writable(tmp_path / "a.txt")
    assert [*tmp_path.iterdir()] == []


def test_a_place_that_cannot_be_written_is_refused_with_the_reason(tmp_path: Path):
    with pytest.raises(OSError, match="is a directory"):
        output.ensure_writable(tmp_path)
    with pytest.raises(OSError, match="there is no directory"):
        output.ensure_writable(tmp_path / "none" / "a.txt")
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="not an ordinary file"):
        output.ensure_writable(tmp_path / "pipe")
    with pytest.raises(OSError, match="cannot be written: File name too long"):
        output.ensure_writable(tmp_path / ("a" * 250))
