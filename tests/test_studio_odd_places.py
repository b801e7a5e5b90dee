"""Drawings at places without short coordinates: exact, although pictures have few digits."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from studio_scripts import drawn_by

from dalembert.io import load_model_file
from dalembert.studio.drawing_edits import apply
from dalembert.studio.new_models import UNTITLED


def test_three_parallel_cranks_at_odd_places(tmp_path: Path) -> None:
    """One crank is redundant, so that the loops close only if the bars join exactly."""
    text = UNTITLED
    for operations in drawn_by("studio_odd_places.mjs", tmp_path):
        text = apply(text, operations)
    along, up = (np.array([np.cos(angle), np.sin(angle)]) for angle in (0.377, 1.234))
    first = np.array([0.1234567, 0.0765432])
    data = tomllib.loads(text)
    for name, distance in (("E", 0.0), ("F", 0.4), ("G", 0.7)):
        place = data["joints"][name]["connect"][0]["at"]
        assert place == pytest.approx(first + distance * along, abs=2e-12)
    middle = first + 0.55 * along + 0.3 * up
    assert data["bodies"]["bar5"]["position"] == pytest.approx(middle, abs=2e-12)
    path = tmp_path / "cranks.toml"
    path.write_text(text, encoding="utf-8")
    assert load_model_file(path).model().diagnosis.degrees_of_freedom == 1
