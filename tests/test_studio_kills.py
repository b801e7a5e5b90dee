"""Servers of the studio that are killed at random moments lose nothing that they have answered."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from studio_kills import Kills
from test_studio_server import FOUR_BAR


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(4))
def test_random_kills_lose_nothing(seed: int, tmp_path: Path) -> None:
    """25 kills of each seed, 100 in all."""
    if not Path("/proc").exists():
        pytest.skip("no list of processes")
    path = tmp_path / "model.toml"
    path.write_text(FOUR_BAR)
    kills = Kills(path, random.Random(seed))
    for _ in range(25):
        kills.kill()
    kills.no_process_remains()
    assert not [file for file in tmp_path.iterdir() if file.name.endswith(".toml") and file != path]
