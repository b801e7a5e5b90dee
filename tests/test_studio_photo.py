"""A photo under the drawing: scaled by two points, moved, stored by the program."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from studio_desk import Desk
from studio_runs import Studio

PLACED = "[studio.photo.placed.x, studio.photo.placed.y, studio.photo.placed.scale]"


def colour(visit: Desk, x: float, y: float) -> np.ndarray:
    """Mean colour about a place: red, green, blue."""
    visit.frames()
    u, v = visit.place(x, y)
    part = {"x": u - 8, "y": v - 8, "width": 16, "height": 16}
    shown = Image.open(BytesIO(visit.page.screenshot(clip=part))).convert("RGB")
    mean: np.ndarray = np.asarray(shown, dtype=float).mean(axis=(0, 1))
    return mean


@pytest.mark.thorough
def test_a_photo_is_scaled_moved_and_stored(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    visit, _ = desk
    file = tmp_path / "photo.png"
    image = Image.new("RGB", (400, 300), (20, 60, 220))
    image.paste((220, 30, 30), (0, 0, 200, 300))
    image.save(file)
    visit.page.set_input_files(".canvas input[type=file]", str(file))
    visit.until("studio.photo.image !== null", 10)
    x, y, scale = visit.js(PLACED)
    left, right = (x + 103 * scale, y - 151 * scale), (x + 303 * scale, y - 151 * scale)
    for place, sign in ((left, 1), (right, -1)):
        red, _, blue = colour(visit, *place)
        assert sign * (red - blue) > 40
    visit.page.click(".photo >> text=Scale")
    for point in (left, right):
        visit.page.mouse.click(*visit.place(*point))
    visit.page.fill("#ask input", "300 mm")
    visit.page.keyboard.press("Enter")
    visit.until(f"Math.abs(studio.photo.placed.scale - {0.3 / 200}) < 2e-5", 10)
    x, y, scale = visit.js(PLACED)
    assert [x + 103 * scale, y - 151 * scale] == pytest.approx(left, abs=2 * scale)  # it stays
    visit.page.click(".photo >> text=Move")
    start, end = visit.place(0.05, 0.05), visit.place(0.15, 0.0)
    visit.page.mouse.move(*start)
    visit.page.mouse.down()
    visit.page.mouse.move(*end, steps=3)
    visit.page.mouse.up()
    assert visit.js(PLACED)[:2] == pytest.approx([x + 0.1, y - 0.05], abs=3 * scale)
    visit.page.click(".photo >> text=Move")
    moved = visit.js(PLACED)
    visit.until("studio.photo.stored", 10)
    visit.page.reload()
    visit.until("Boolean(window.studio?.photo?.image)", 20)
    assert visit.js(PLACED) == moved
    visit.page.click(".photo >> text=Remove")
    visit.until("studio.photo.placed === null", 5)
    assert not visit.page.is_visible(".photo")
