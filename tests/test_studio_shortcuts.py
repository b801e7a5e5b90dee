"""List of the keys of the studio: complete, as its documentation promises."""

from __future__ import annotations

import re
from pathlib import Path

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
