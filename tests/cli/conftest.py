"""A block on a table as a file."""

from pathlib import Path

import pytest
from command_line import BLOCK


@pytest.fixture
def block(tmp_path: Path) -> Path:
    path = tmp_path / "block.yaml"
    path.write_text(BLOCK, encoding="utf-8")
    return path
