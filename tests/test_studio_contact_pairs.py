"""Contacts of two bodies that are drawn: only pairs of shapes that have a contact."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from studio_scripts import drawn_by

from dalembert.io import load_model_file
from dalembert.studio.drawing_edits import apply
from dalembert.studio.new_models import UNTITLED

BODY = {"type": "Body", "mass": 1.0, "inertia": 0.1}
CORNERS = {
    "square": [[0, 0], [0.5, 0], [1, 0], [1, 1], [0, 1]],
    "dented": [[0, 0], [0.3, 0.4], [1, 0], [1, 1], [0, 1]],
}
BODIES: dict[str, dict[str, Any]] = {
    "bar": {"type": "Bar", "mass": 1.0, "length": 0.4, "position": [3, 0]},
    "rod": {"type": "Bar", "mass": 1.0, "length": 0.4, "position": [5, 0]},
    "mass": {"type": "Particle", "mass": 1.0, "position": [7, 0]},
    **{
        name: BODY | {"points": {f"P{k}": corner for k, corner in enumerate(corners)}}
        for name, corners in CORNERS.items()
    },
}


def test_contacts_of_two_bodies_are_valid_or_refused(tmp_path: Path) -> None:
    refused = set()
    adding = {"op": "add", "section": "bodies"}
    drawn = apply(UNTITLED, [adding | {"name": name, "fields": BODIES[name]} for name in BODIES])
    results = drawn_by("studio_contact_pairs.mjs", tmp_path, json.dumps(BODIES))
    for first, second, result in results:
        if first == second:
            assert result is None
            continue
        if isinstance(result, str):
            assert first in result and "Shift+K" in result and "Shift+Y" in result
            refused.add(frozenset((first, second)))
            continue
        path = tmp_path / "contact.toml"
        path.write_text(apply(drawn, result), encoding="utf-8")
        assert load_model_file(path).model().diagnosis.degrees_of_freedom == 14
    names = [("bar", "rod"), *((x, y) for x in ("bar", "rod") for y in CORNERS), (*CORNERS,)]
    assert refused == {frozenset(pair) for pair in names}


def test_a_plate_with_a_dent_touches_a_floor_with_its_convex_hull(tmp_path: Path) -> None:
    results = drawn_by("studio_contact_pairs.mjs", tmp_path, json.dumps(BODIES))
    operations = next(r for first, second, r in results if (first, second) == ("dented", None))
    shape = operations[0]["fields"]["shape_j"]
    assert [tuple(v) for v in shape["vertices"]] == [(0, 0), (1, 0), (1, 1), (0, 1)]
