"""Random edits of a drawing: the picture shows the model after each, and undo returns all.

``test_studio_walks.py`` makes 1,000 of more kinds.
"""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from studio_desk import Desk
from studio_runs import Studio
from test_studio_editing import MECHANISM

import dalembert as da
from dalembert.io import load_model_file

KEYS = ("h", "H", "r", "R", "ArrowUp", "ArrowLeft", "Control+d")
"""Mirrored, rotated, moved and copied."""
COUNT = 12
"""Number of edits."""
MOST = 14
"""Bodies beyond which the copies are removed."""
SHOWN = """(() => {
    const { motion } = studio.pictures.page, cursor = { i: 0, f: 0 };
    return Object.fromEntries(motion.points.map(({ name, body, point }) =>
        [name, motion.at(body, point, cursor)]));
})()"""


def check_picture(visit: Desk, path: Path) -> None:
    """The points of the picture are those of the model of the text."""
    assert visit.errors_shown() == []
    path.write_text(visit.text)
    model = load_model_file(path).model()
    start = da.solve_kinematics(model, 1e-3, outputs=2)
    shown = visit.js(SHOWN)
    assert shown
    for name, place in shown.items():
        wanted = [start[f"{name}.{axis}"].values[0] for axis in "xy"]
        assert np.allclose(place, wanted, atol=2e-6), (name, place, wanted)


@pytest.mark.thorough
def test_random_edits_are_shown_and_undone(
    shared_desk: tuple[Desk, Studio], tmp_path: Path
) -> None:
    visit, _ = shared_desk
    visit.show(MECHANISM)
    rng = random.Random(COUNT)
    done = 0
    for _ in range(COUNT):
        bodies = list(visit.document["bodies"])
        visit.js("studio.drawing.rest()")
        if len(bodies) > MOST:
            copies = [name for name in bodies if name not in ("crank", "rod", "block")]
            visit.js(f"studio.drawing.select({copies})")
            key = "Delete"
        else:
            whole = rng.random() < 0.7
            names = bodies if whole else bodies[:3]
            visit.js(f"studio.drawing.select({names})")
            key = rng.choice(KEYS)
        visit.page.locator("#palette button").first.focus()
        visit.press(key)
        done += 1
        check_picture(visit, tmp_path / "edited.toml")
    assert visit.revision - visit.base == done + 1
    for _ in range(done):
        visit.page.keyboard.press("Control+z")
    visit.until(f"studio.file.revision >= {visit.base + 2 * done + 1}", 120)
    assert visit.text == MECHANISM
