"""Bodies with contacts are mirrored and rotated with their shapes, and move accordingly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from studio_desk import Desk
from studio_runs import Studio

import dalembert as da
from dalembert.io import load_model_file

TEXT = """format = 1
name = "contacts"
gravity = [0.0, -9.81]

[bodies]
block = { mass = 1, inertia = 0.01, position = [0.5, 0.3], angle = 0.2, points.P = [0.1, 0.03] }
ball = { mass = 1, inertia = 0.01, position = [0.72, 0.33], velocity = [-0.5, 0.0] }

[forces.contact]
type = "Contact"
shape_i = { type = "HalfPlane", point = { body = "ground", at = [0, 0.1] }, normal = [-0.1, 1.0] }
law = { type = "HuntCrossley", stiffness = 1e6, damping = 0.5 }

[forces.contact.shape_j]
type = "Polygon"
body = "block"
vertices = [[-0.1, -0.05], [0.1, -0.05], [0.1, 0.02], [-0.02, 0.08]]

[forces.touch]
type = "Contact"
shape_j = { type = "Circle", point = "ball", radius = 0.05 }
law = { type = "HuntCrossley", stiffness = 1e6, damping = 0.5 }

[forces.touch.shape_i]
type = "Capsule"
point_i = "block.P"
point_j = { body = "block", at = [0.0, 0.02] }
radius = 0.02
"""


@pytest.fixture
def desk(shared_desk: tuple[Desk, Studio]) -> tuple[Desk, Studio]:
    return shared_desk


def paths(text: str, folder: Path, name: str) -> np.ndarray:
    """Places of both bodies over time."""
    path = folder / f"{name}.toml"
    path.write_text(text)
    motion = da.solve_dynamics(load_model_file(path).model(), 0.3, step=1e-4)
    return np.array([np.asarray(motion[f"{body}.{c}"]) for body in ("block", "ball") for c in "xy"])


@pytest.mark.thorough
def test_all_is_mirrored(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    visit, _ = desk
    visit.show(TEXT)
    visit.page.locator("#palette button").first.focus()
    visit.page.keyboard.press("Control+a")
    visit.page.click('[aria-label="Select: all tools"]')
    visit.page.click('.flyout [data-tool="mirror"]')
    revision = visit.revision
    visit.click(0.4, 0.2)
    visit.click(0.4, 0.5)
    visit.settle(revision + 1)
    assert visit.errors_shown() == []
    forces = visit.document["forces"]
    assert forces["contact"]["shape_i"]["point"]["at"] == [0.8, 0.1]
    assert forces["contact"]["shape_i"]["normal"] == [0.1, 1.0]
    before, after = paths(TEXT, tmp_path, "before"), paths(visit.text, tmp_path, "after")
    before[[0, 2]] = 0.8 - before[[0, 2]]
    assert np.abs(before - after).max() < 1e-6
    assert np.abs(before[:, -1] - before[:, 0]).min() > 1e-3, "bodies touch and move"
    visit.press("Control+z")
    assert visit.text == TEXT


@pytest.mark.thorough
@pytest.mark.parametrize("key", ["h", "r"])
def test_the_floor_stays_where_only_the_body_is_selected(
    desk: tuple[Desk, Studio], key: str
) -> None:
    visit, _ = desk
    visit.show(TEXT)
    before = visit.document["forces"]
    visit.page.locator("#palette button").first.focus()
    visit.js("studio.drawing.select(['block'])")
    visit.press(key)
    forces = visit.document["forces"]
    assert visit.errors_shown() == []
    assert forces["contact"]["shape_i"] == before["contact"]["shape_i"]
    vertices = [[x, -y] for x, y in before["contact"]["shape_j"]["vertices"]][::-1]
    same = before["contact"]["shape_j"]["vertices"]
    assert forces["contact"]["shape_j"]["vertices"] == (vertices if key == "h" else same)
    at = [0.0, -0.02] if key == "h" else [0.0, 0.02]
    assert forces["touch"]["shape_i"]["point_j"]["at"] == at
    visit.press("Control+z")
    assert visit.text == TEXT


@pytest.mark.thorough
def test_a_plate_touches_the_floor(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.draw("p", (0.3, 0.4), (0.6, 0.4), (0.5, 0.6), (0.3, 0.4))
    visit.draw("C", (0.45, 0.45), (0.45, 0.2))
    (contact,) = visit.document["forces"].values()
    assert [contact[key]["type"] for key in ("shape_i", "shape_j")] == ["HalfPlane", "Polygon"]
    assert visit.errors_shown() == []
