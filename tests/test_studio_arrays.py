"""Arrays and keys in texts of the studio: items added and removed, comments of the others kept."""

from __future__ import annotations

import tomllib

import pytest

import dalembert as da
from dalembert.studio.drawing_edits import apply

LINES = """[meshes.plate]
type = "Triangle6"
thickness = 0.01  # m

[meshes.plate.polygon]
size = 0.1
vertices = [[0, 0], [2, 0], [2, 1], [0, 1]]
holes = [
  { center = [0.5, 0.5], radius = 0.1 },  # of the bolt
  # the cable
  { center = [1.5, 0.5], radius = 0.2 }  # may grow
]
"""
INLINE = "plates = 1\nmeshes = { p = { polygon = { holes = [[1, 2], [3, 4]], size = 1 } } }\n"
HOLES = ["meshes", "plate", "polygon", "holes"]
NEW = {"center": [1, 0.2], "radius": 0.05}


def holes(text: str) -> list:
    polygon = next(iter(tomllib.loads(text)["meshes"].values()))["polygon"]
    return polygon.get("holes", [])


def test_an_added_hole_keeps_the_comments_of_the_others() -> None:
    text = apply(LINES, [{"op": "append_item", "keys": HOLES, "value": NEW}])
    assert holes(text) == [*holes(LINES), NEW]
    for comment in ("# of the bolt", "# the cable", "# may grow"):
        (line,) = (line for line in text.splitlines() if comment in line)
        assert "0.05" not in line
    again = apply(text, [{"op": "append_item", "keys": HOLES, "value": NEW}])
    assert holes(again) == [*holes(text), NEW]
    less = apply(again, [{"op": "remove_item", "keys": [*HOLES, 3]}])
    assert less.replace("},\n]", "}\n]") == text


@pytest.mark.parametrize(("index", "lost"), [(0, "# of the bolt"), (1, "# may grow")])
def test_a_removed_hole_takes_its_own_comment_only(index: int, lost: str) -> None:
    text = apply(LINES, [{"op": "remove_item", "keys": [*HOLES, index]}])
    kept = holes(LINES)
    kept.pop(index)
    assert holes(text) == kept
    other = {"# of the bolt": "# may grow", "# may grow": "# of the bolt"}[lost]
    assert lost not in text
    assert other in text


def test_arrays_in_one_line_and_missing_ones() -> None:
    keys = ["meshes", "p", "polygon", "holes"]
    more = apply(INLINE, [{"op": "append_item", "keys": keys, "value": [5, 6]}])
    assert holes(more) == [[1, 2], [3, 4], [5, 6]]
    assert apply(more, [{"op": "remove_item", "keys": [*keys, 2]}]) == INLINE
    empty = apply(
        apply(INLINE, [{"op": "remove_item", "keys": [*keys, 0]}] * 2),
        [{"op": "append_item", "keys": keys, "value": [7, 8]}],
    )
    assert holes(empty) == [[7, 8]]
    without = INLINE.replace("holes = [[1, 2], [3, 4]], ", "")
    assert holes(apply(without, [{"op": "append_item", "keys": keys, "value": [7, 8]}])) == [[7, 8]]


@pytest.mark.parametrize("key", ["type", "area", "modulus"])
def test_a_dropped_key_leaves_the_others(key: str) -> None:
    rows = {"type": "Truss", "area": 1e-4, "modulus": 2e11}
    inline = '[elements]\nab = { type = "Truss", area = 1e-4, modulus = 2e11 }  # first\n'
    table = '[elements.ab]\ntype = "Truss"\narea = 1e-4\nmodulus = 2e11\n# first\n'
    for text in (inline, table):
        less = apply(text, [{"op": "drop", "keys": ["elements", "ab", key]}])
        expected = {name: value for name, value in rows.items() if name != key}
        assert tomllib.loads(less)["elements"]["ab"] == expected
        assert "# first" in less
        assert apply(less, [{"op": "drop", "keys": ["elements", "ab", key]}]) == less


@pytest.mark.parametrize(
    ("operation", "message"),
    [
        ({"op": "append_item", "keys": ["meshes", "plate"], "value": 1}, "is no array"),
        ({"op": "remove_item", "keys": [*HOLES, 7]}, "there is no such item"),
        ({"op": "remove_item", "keys": [*HOLES, True]}, "needs the number"),
        ({"op": "drop", "keys": ["meshes", "plate"]}, "is no key"),
    ],
)
def test_wrong_changes_are_refused(operation: dict, message: str) -> None:
    with pytest.raises(da.ModelError, match=message):
        apply(LINES, [operation])
