"""List of the keys of the studio: complete, as its documentation promises."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from studio_desk import Desk, reset
from studio_runs import Studio
from studio_scripts import drawn_by

DOCS = Path(__file__).parents[1] / "docs/studio.md"


def test_all_keys_of_the_documentation_are_listed(tmp_path: Path) -> None:
    groups = dict(drawn_by("studio_shortcuts.mjs", tmp_path))
    for title, rows in groups.items():
        keys = [key for key, _ in rows if len(key) < 3]
        assert len(keys) == len(set(keys)), title
    assert {"Structures", "Spatial models", "Spatial structures"} <= groups.keys()
    structure = dict(groups["Spatial structures"])
    assert structure["O"] == "Ball joint"
    assert not {"P", "⇧H"} & structure.keys()  # regions and holes are planar
    picture = next(rows for title, rows in groups.items() if title.startswith("Picture"))
    assert sorted(key for key, _ in picture) == [*"123456789"]
    tables = re.findall(
        r"^\| [^|]+ \| ((?:Shift\+)?[A-Z]) \|", DOCS.read_text("utf-8"), re.MULTILINE
    )
    listed = {key for rows in groups.values() for key, _ in rows}
    assert {key.replace("Shift+", "⇧") for key in tables} <= listed


@pytest.mark.thorough
def test_everything_is_selected_in_structures(desk: tuple[Desk, Studio]) -> None:
    visit, studio = desk
    for kind, z in (("structure", ""), ("spaceStructure", ", 0")):
        reset(studio, structure=True, dimension=3 if z else 2)
        visit.until(f"studio.{kind}.possible", 60)
        keyboard = visit.page.keyboard
        visit.page.locator("#canvas").focus()
        keyboard.press("b")
        for place in ("0, 0", "1, 0"):
            keyboard.type(place + z)
            keyboard.press("Enter")
        visit.until("Object.keys(studio.file.document?.elements ?? {}).length === 1", 20)
        visit.settle()
        drawn = visit.text
        keyboard.press("Escape")
        keyboard.press("v")
        keyboard.press("Control+a")
        names = visit.js(f"studio.{kind}.selection.map(({{ name }}) => name).sort()")
        assert names == ["bar1", "n1", "n2"]
        visit.press("Delete")
        assert not visit.document.get("elements") and not visit.document.get("nodes")
        visit.press("Control+z")
        assert visit.text == drawn
