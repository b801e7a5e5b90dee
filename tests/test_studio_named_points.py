"""Named points and frames are deleted, with what refers to them; undo returns the text."""

from __future__ import annotations

import tomllib

import pytest
from studio_desk import Desk
from studio_runs import Studio

import dalembert as da
from dalembert.studio.drawing_edits import apply

TEXT = """format = 1
name = "points"
gravity = [0.0, -9.81]

[ground.points]
O = [0.0, 0.0]  # origin
Q = [0.5, 0.5]

[bodies.crank]
type = "Bar"
length = 0.4
mass = 1.0
points = { P = [0.1, 0.0], PQ = [0.15, 0.0] }

[joints]
A = { type = "Revolute", connect = ["ground.O", "crank.start"] }

[forces.s]  # goes with Q
type = "Spring"
connect = ["ground.Q", "crank.end"]
stiffness = 10.0
free_length = 0.2

[forces.load]
type = "Force"
connect = ["crank.PQ"]
vector = [0.0, 1.0]
"""


def removed(*keys: str) -> str:
    return apply(TEXT, [{"op": "remove point", "keys": list(keys)}])


def test_a_point_goes_with_what_refers_to_it() -> None:
    data, before = tomllib.loads(removed("ground", "points", "Q")), tomllib.loads(TEXT)
    assert data["ground"]["points"] == {"O": [0.0, 0.0]}
    assert "s" not in data["forces"] and "load" in data["forces"]
    assert data["joints"] == before["joints"] and data["bodies"] == before["bodies"]
    assert "# origin" in removed("ground", "points", "Q")
    data = tomllib.loads(removed("bodies", "crank", "points", "P"))
    assert data["bodies"]["crank"]["points"] == {"PQ": [0.15, 0.0]}
    assert data["forces"] == before["forces"]  # "PQ" is another point
    assert "load" not in tomllib.loads(removed("bodies", "crank", "points", "PQ"))["forces"]


@pytest.mark.parametrize(
    "keys", [["bodies", "crank", "length"], ["joints", "A", "points", "P"], ["points", "Q"]]
)
def test_other_keys_are_refused(keys: list[str]) -> None:
    with pytest.raises(da.ModelError, match="no point or frame"):
        removed(*keys)


@pytest.mark.thorough
def test_a_point_is_deleted_in_the_sheet_of_the_model(shared_desk: tuple[Desk, Studio]) -> None:
    visit, _ = shared_desk
    visit.show(TEXT)
    visit.page.click("#tab-model")
    visit.page.locator("[role=treeitem]", has_text="Q").first.click()
    revision = visit.revision
    visit.page.click(".sheet:visible >> text=Delete")
    visit.settle(revision + 1)
    assert visit.text == removed("ground", "points", "Q")
    assert not visit.errors_shown()
    visit.js("document.activeElement?.blur()")
    visit.press("Control+z")
    assert visit.text == TEXT
